//! Real parts: curved contact lines, obstacles, materials by surface, supports at any angle, answers per boundary. What is
//! expected comes from closed forms, or from the same body described in another way.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

use approx::{assert_abs_diff_eq, assert_relative_eq, relative_eq};
use signorini::fem::{
    Condition, Diagonal, Materials, Mesh, Obstacle, PointSupport, Problem, Rectangle, Side,
};
use signorini::io::{Case, gmsh};
use signorini::kernel::{Material, Plane};
use signorini::nalgebra::Vector2;
use signorini::solve::solution::ContactValues;
use signorini::solve::{Degree, Solution, solve};

use super::common::*;

/// A peak of these meshes, of some twenty edges in contact, beside the closed form.
const PEAK: f64 = 0.02;

/// The solver's tolerance leaves rounding errors, some thousand of them in a sum over the body.
const SOLVED: f64 = 1e-11;

const BOTH: [Degree; 2] = [Degree::One, Degree::Two];

fn solved(problem: &Problem, degree: Degree) -> Solution {
    solve(problem, &method(degree, EXACT), &Default::default()).unwrap().0
}

/// The ring 1 < r < 2.5 by `n` edges around, unevenly spaced if `skew` > 0.
fn ring(n: usize, skew: f64) -> Mesh {
    let layers = n / 5 + 2;
    let angle = |j: usize| {
        let a = 2.0 * PI * j as f64 / n as f64;
        a + skew / n as f64 * (5.0 * a).sin()
    };
    let mut vertices = Vec::new();
    for i in 0..=layers {
        let r = 1.0 + 1.5 * (i as f64 / layers as f64).powf(1.3);
        vertices.extend((0..n).map(|j| [r * angle(j).cos(), r * angle(j).sin()]));
    }
    let id = |i: usize, j: usize| i * n + j % n;
    let mut triangles = Vec::new();
    for i in 0..layers {
        for j in 0..n {
            triangles.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            triangles.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
    }
    let around = |i: usize| (0..n).map(|j| [id(i, j), id(i, j + 1)]).collect::<Vec<_>>();
    let named = [("pin".to_owned(), around(0)), ("rim".to_owned(), around(layers))];
    Mesh::new(vertices, triangles, named).unwrap()
}

fn moved_by(x: f64, y: f64) -> Condition {
    Condition::Displacement([Some(constant(x)), Some(constant(y))])
}

/// The ring on a rigid pin, its rim moved to the right by 0.01; lambda = mu = 1.
fn ring_on_a_pin(mesh: Mesh, contact: Condition) -> Problem {
    Problem::new(
        mesh,
        Material::lame(1.0, 1.0, Plane::Strain),
        [constant(0.0), constant(0.0)],
        conditions([("rim", moved_by(0.01, 0.0)), ("pin", contact)]),
    )
}

fn circle(radius: f64, side: Side) -> Condition {
    Condition::Obstacle("pin".to_owned(), Obstacle::Circle { center: [0.0; 2], radius, side })
}

/// What an independent program with nodal normals found with 192 edges: the peak 0.0302, the force 0.0613.
#[test]
fn the_pressure_of_a_pin_converges_on_even_and_uneven_edges_with_an_obstacle_and_without() {
    for degree in BOTH {
        for skew in [0.0, 2.0] {
            for contact in [circle(1.0, Side::Outside), Condition::Contact { gap: constant(0.0) }] {
                let s = solved(&ring_on_a_pin(ring(96, skew), contact), degree);
                let pin = &s.boundaries[0];
                assert!(
                    relative_eq!(pin.peak_pressure, 0.0302, max_relative = PEAK),
                    "{degree:?} {skew}: {pin:?}"
                );
                assert!((pin.force / 0.0613 - 1.0).abs() < 0.005, "{degree:?} {skew}: {pin:?}");
                assert_abs_diff_eq!(s.balance.imbalance, 0.0, epsilon = SOLVED);
            }
        }
    }
}

/// The same with the facets' normals, which is what a plane per facet gives: u_n jumps at the vertices, and the pressure
/// with it.
#[test]
fn control_with_the_normals_of_the_facets_the_pressure_of_a_pin_does_not_converge() {
    for n in [48, 96] {
        let mesh = ring(n, 0.0);
        // One boundary for each facet: no smooth line goes through them.
        let mut named = vec![("rim".to_owned(), edges(&mesh, "rim"))];
        let mut conditions: BTreeMap<String, Condition> =
            BTreeMap::from([("rim".to_owned(), moved_by(0.01, 0.0))]);
        for (i, [a, b]) in edges(&mesh, "pin").into_iter().enumerate() {
            let [p, q] = [mesh.vertices()[a], mesh.vertices()[b]];
            let length = (q[0] - p[0]).hypot(q[1] - p[1]);
            // The body on the left of the edge.
            let normal = [-(q[1] - p[1]) / length, (q[0] - p[0]) / length];
            let name = format!("facet {i}");
            named.push((name.clone(), vec![[a, b]]));
            let plane = Obstacle::Plane { point: p, normal };
            conditions.insert(name.clone(), Condition::Obstacle(name, plane));
        }
        let mesh = Mesh::new(mesh.vertices().to_vec(), mesh.triangles().to_vec(), named).unwrap();
        let material = Material::lame(1.0, 1.0, Plane::Strain);
        let problem = Problem::new(mesh, material, [constant(0.0), constant(0.0)], conditions);
        let s = solved(&problem, Degree::One);
        assert!(s.quantities.peak_pressure > 1.25 * 0.0302, "{n}: {}", s.quantities.peak_pressure);
    }
}

/// The ends of a boundary's edges, the body on the left.
fn edges(mesh: &Mesh, name: &str) -> Vec<[usize; 2]> {
    mesh.edges_of(name).unwrap().iter().map(|&edge| mesh.ends(edge)).collect()
}

/// A disk of radius 1 pressed on a plane: Hertz, p0 = (F E* / (pi R))^(1/2).
#[test]
fn the_peak_under_a_disk_is_that_of_hertz() {
    let case = Case::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/disk.toml")).unwrap();
    for degree in BOTH {
        let s = solved(&case.problem, degree);
        let floor = &s.boundaries[0];
        let hertz = (floor.force * 1000.0 / (1.0 - 0.09) / PI).sqrt();
        assert_relative_eq!(floor.peak_pressure, hertz, max_relative = PEAK);
        // On a plane floor all forces have one direction.
        assert_relative_eq!(floor.resultant[1], floor.force, max_relative = 1e-9);
    }
}

/// A shaft that fits its bearing with interference d all round: u = -d r / R inside, p = 2 (lambda + mu) d / R.
#[test]
fn a_shaft_pressed_into_a_bearing_has_the_constant_pressure_of_its_closed_form() {
    let n = 64;
    let mut vertices = vec![[0.0, 0.0]];
    let mut triangles = Vec::new();
    let rings = 10;
    for i in 1..=rings {
        let r = i as f64 / f64::from(rings);
        vertices.extend((0..n).map(|j| {
            let a = 2.0 * PI * f64::from(j) / f64::from(n);
            [r * a.cos(), r * a.sin()]
        }));
    }
    let id = |i: i32, j: i32| (1 + (i - 1) * n + j % n) as usize;
    for j in 0..n {
        triangles.push([0, id(1, j), id(1, j + 1)]);
        for i in 1..rings {
            triangles.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            triangles.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
    }
    let rim = (0..n).map(|j| [id(rings, j), id(rings, j + 1)]).collect();
    let mesh = Mesh::new(vertices, triangles, [("rim".to_owned(), rim)]).unwrap();
    let (d, lambda, mu) = (1e-3, 1.5, 1.0);
    let held =
        |vertex, displacement| PointSupport { name: format!("{vertex}"), vertex, displacement };
    for degree in BOTH {
        for gap in [false, true] {
            let contact = if gap {
                Condition::Contact { gap: constant(-d) }
            } else {
                circle(1.0 - d, Side::Inside)
            };
            let mut problem = Problem::new(
                mesh.clone(),
                Material::lame(lambda, mu, Plane::Strain),
                [constant(0.0), constant(0.0)],
                conditions([("rim", contact)]),
            );
            // The centre stays where it is, and the shaft does not turn.
            problem.points.push(held(0, [Some(constant(0.0)), Some(constant(0.0))]));
            problem.points.push(held(id(1, 0), [None, Some(constant(0.0))]));
            let s = solved(&problem, degree);
            let p = 2.0 * (lambda + mu) * d;
            let rim = &s.boundaries[0];
            let least =
                s.contact.iter().flat_map(|e| &e.points).map(|p| p.pressure).fold(1.0, f64::min);
            assert_relative_eq!(rim.peak_pressure, p, max_relative = PEAK);
            assert_relative_eq!(least, p, max_relative = PEAK);
            assert!(rim.resultant[0].hypot(rim.resultant[1]) < 1e-12 * rim.force + 1e-16);
            // Each edge is a chord, whose wave in lambda^h of P2 is not in the recovered pressure.
            let wave = |value: fn(&ContactValues) -> f64| {
                let off = |v: &ContactValues| (value(v) / p - 1.0).abs();
                s.contact.iter().flat_map(|edge| &edge.points).map(off).fold(0.0, f64::max)
            };
            let [of_lambda, of_pressure] = [wave(|v| -v.lambda), wave(|v| v.pressure)];
            if degree == Degree::Two {
                assert!(of_lambda > 10.0 * of_pressure, "{of_lambda:e} {of_pressure:e}");
            }
        }
    }
}

/// A bar of two materials one above the other, in contact along its whole foot: sigma_yy = -p in both, so each shortens by
/// its own (1 + nu) (1 - 2 nu) / ((1 - nu) E) p H, held at its sides in plane strain. u is affine in each part.
#[test]
fn a_bimaterial_bar_is_exact() {
    let mesh = Rectangle { diagonal: Diagonal::Crossed, ..unit_square(8) }.mesh().unwrap();
    let centre = |t: usize| mesh.triangle(t).point([1.0 / 3.0; 3])[1];
    let upper: Vec<usize> = (0..mesh.triangles().len()).filter(|&t| centre(t) > 0.5).collect();
    let soft = Material::lame(1.0, 1.0, Plane::Strain);
    let stiff = Material::lame(20.0, 7.0, Plane::Strain);
    let count = mesh.triangles().len();
    let materials = Materials::in_parts(soft, count, [(stiff, &upper[..])]);
    let push = 0.01;
    let roller = || Condition::Support { normal: Some(constant(0.0)), tangential: None };
    let problem = Problem::new(
        mesh,
        materials,
        [constant(0.0), constant(0.0)],
        conditions([
            ("left", roller()),
            ("right", roller()),
            ("top", Condition::Displacement([None, Some(constant(-push))])),
            ("bottom", Condition::Contact { gap: constant(0.0) }),
        ]),
    );
    // Springs in series: lambda + 2 mu over the height of each.
    let p = push
        / (0.5 / soft.normal_stiffness(Vector2::<f64>::y())
            + 0.5 / stiff.normal_stiffness(Vector2::<f64>::y()));
    for degree in BOTH {
        let s = solved(&problem, degree);
        assert_relative_eq!(s.boundaries[0].force, p, max_relative = SOLVED / 10.0);
        assert_relative_eq!(s.boundaries[0].peak_pressure, p, max_relative = SOLVED / 10.0);
        assert_relative_eq!(s.quantities.energy, p * push, max_relative = SOLVED / 10.0);
        for (x, u) in s.nodes.iter().zip(&s.displacement) {
            let below = x[1].min(0.5) / soft.normal_stiffness(Vector2::<f64>::y());
            let above = (x[1] - 0.5).max(0.0) / stiff.normal_stiffness(Vector2::<f64>::y());
            // What is left of the roundings of displacements of 1e-2.
            assert_abs_diff_eq!(u[..], [0.0, -p * (below + above)][..], epsilon = 1e-15);
        }
    }
}

/// The block on its floor, all turned by an angle: rollers, pressure, obstacle and answers turn with it.
#[test]
fn a_turned_block_on_rollers_gives_the_turned_answer() {
    let solve_at = |angle: f64, degree| {
        let (sin, cos) = angle.sin_cos();
        let turn = move |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
        let flat = skewed_square(6, Diagonal::Right);
        let sides = ["left", "top", "bottom"].map(|name| (name.to_owned(), edges(&flat, name)));
        let vertices = flat.vertices().iter().map(|&x| turn(x)).collect();
        let mesh = Mesh::new(vertices, flat.triangles().to_vec(), sides).unwrap();
        let floor = Obstacle::Plane { point: turn([0.3, -0.01]), normal: turn([0.0, 1.0]) };
        let back = move |x: [f64; 2]| cos * x[0] + sin * x[1];
        let problem = Problem::new(
            mesh,
            Material::lame(1.0, 1.0, Plane::Strain),
            [constant(0.0), constant(0.0)],
            conditions([
                ("left", Condition::Support { normal: Some(constant(0.0)), tangential: None }),
                (
                    "top",
                    Condition::Support {
                        normal: Some(function(move |x| -0.04 - 0.02 * back(x))),
                        tangential: None,
                    },
                ),
                ("bottom", Condition::Obstacle("floor".to_owned(), floor)),
            ]),
        );
        (solved(&problem, degree), turn)
    };
    for degree in BOTH {
        let (flat, _) = solve_at(0.0, degree);
        let (turned, turn) = solve_at(0.7, degree);
        let energies = [&flat, &turned].map(|s| s.quantities.energy);
        assert_relative_eq!(energies[0], energies[1], max_relative = SOLVED);
        for (u, v) in flat.displacement.iter().zip(&turned.displacement) {
            let u = turn(*u);
            // Displacements are below 0.1.
            assert_abs_diff_eq!(u[..], v[..], epsilon = SOLVED / 10.0);
        }
        let (a, b) = (&flat.boundaries[0], &turned.boundaries[0]);
        let force = turn(a.resultant);
        assert_abs_diff_eq!(force[..], b.resultant[..], epsilon = SOLVED * a.force);
        // Places are up to 2 from the origin, edges of both signs cancel.
        assert_abs_diff_eq!(a.moment, b.moment, epsilon = 10.0 * SOLVED * a.force);
        for name in ["left", "top"] {
            let (r, q) = (turn(flat.quantities.reactions[name]), turned.quantities.reactions[name]);
            assert_abs_diff_eq!(r[..], q[..], epsilon = SOLVED);
        }
    }
}

/// Loads, contact and reactions balance per boundary, in force and moment, on a floor and a wall at once.
#[test]
fn floor_and_wall_balance_with_the_reactions_in_force_and_moment() {
    let plane =
        |point, normal| Condition::Obstacle("o".to_owned(), Obstacle::Plane { point, normal });
    for degree in BOTH {
        let problem = Problem::new(
            skewed_square(7, Diagonal::Left),
            Material::lame(1.0, 1.0, Plane::Strain),
            [constant(0.0), constant(0.0)],
            conditions([
                ("top", moved_by(0.0, -0.05)),
                ("bottom", plane([0.0, 0.0], [0.0, 1.0])),
                ("right", plane([1.002, 0.0], [-1.0, 0.0])),
                ("left", Condition::Pressure(function(|[_, y]| 0.02 * (1.0 + y)))),
            ]),
        );
        let s = solved(&problem, degree);
        let names: Vec<&str> = s.boundaries.iter().map(|b| &*b.boundary).collect();
        assert_eq!(names, ["bottom", "right"]);
        let reaction = s.quantities.reactions["top"];
        // The pressure pushes to the right: int 0.02 (1 + y) = 0.03, about the origin -int 0.02 (1 + y) y.
        let mut force = [reaction[0] + 0.03, reaction[1]];
        let mut moment = s.quantities.reaction_moments["top"] - 0.02 * (0.5 + 1.0 / 3.0);
        for b in &s.boundaries {
            assert!(b.force > 1e-3 && b.penetration < 0.1 * 0.05, "{b:?}");
            force = [force[0] + b.resultant[0], force[1] + b.resultant[1]];
            moment += b.moment;
        }
        // Forces of 0.03: the balance of a discrete solution is exact but for rounding.
        assert_abs_diff_eq!(force[..], [0.0; 2][..], epsilon = SOLVED / 100.0);
        assert_abs_diff_eq!(moment, 0.0, epsilon = SOLVED / 100.0);
        assert_eq!(
            s.contact.iter().filter(|e| e.points[0].arc == 0.0).count(),
            2,
            "arc from 0 on each"
        );
    }
}

/// -lambda^h and the recovered pressure have the same integral on each boundary; the peak is not above that of -lambda^h.
#[test]
fn the_recovered_pressure_has_the_force_of_lambda() {
    for degree in BOTH {
        let s = solved(&ring_on_a_pin(ring(40, 2.0), circle(1.0, Side::Outside)), degree);
        let mut total = 0.0;
        for edge in &s.contact {
            for pair in edge.points.windows(2) {
                total += (pair[1].arc - pair[0].arc) * (pair[0].pressure + pair[1].pressure) / 2.0;
            }
        }
        let force = s.boundaries[0].force;
        // Two sums of some hundred terms.
        assert_relative_eq!(total, force, max_relative = 1e-13);
        assert!(s.boundaries[0].peak_pressure <= s.quantities.peak_pressure);
        // The control: nodal values of lambda^h by the same rule have another one.
        let mut of_lambda = 0.0;
        for edge in &s.contact {
            for pair in edge.points.windows(2) {
                of_lambda -= (pair[1].arc - pair[0].arc) * (pair[0].lambda + pair[1].lambda) / 2.0;
            }
        }
        assert!((of_lambda / force - 1.0).abs() > 1e-6, "{of_lambda} {force}");
    }
}

/// Every variant of the format gives the same body and the same answer.
#[test]
fn every_variant_of_the_bracket_gives_the_same_result() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut answers = Vec::new();
    for name in [
        "cases/bracket.msh",
        "tests/meshes/bracket-binary.msh",
        "tests/meshes/bracket-22.msh",
        "tests/meshes/bracket-22-binary.msh",
    ] {
        let file = root.join(name);
        let mesh = gmsh::read(&file, None).unwrap();
        assert_eq!(mesh.surfaces().keys().collect::<Vec<_>>(), ["rubber", "steel"], "{name}");
        let text = std::fs::read_to_string(root.join("cases/bracket.toml")).unwrap();
        let text = text.replace("gmsh = \"bracket.msh\"", &format!("gmsh = \"{name}\""));
        let case = Case::parse(&root.join("case.toml"), &text, &[]).unwrap();
        let s = solved(&case.problem, Degree::One);
        answers.push((s.quantities.energy, s.boundaries[0].resultant, s.boundaries[1].resultant));
    }
    // The files have 16 digits and number their vertices differently.
    let near = |a: f64, b: f64| relative_eq!(a, b, epsilon = 1e-18, max_relative = 1e-9);
    for (energy, floor, wall) in &answers[1..] {
        let (e, f, w) = &answers[0];
        assert!(near(*e, *energy) && near(f[1], floor[1]) && near(w[0], wall[0]), "{answers:?}");
    }
}
