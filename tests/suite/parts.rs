//! Real parts: curved contact lines, obstacles, materials by surface, supports at any angle, answers per boundary. What is
//! expected comes from closed forms, or from the same body described in another way.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use approx::{abs_diff_eq, assert_abs_diff_eq, assert_relative_eq, relative_eq};
use signorini::io::{Case, gmsh};
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{
    Condition, Diagonal, Materials, Mesh, Obstacle, PointSupport, Problem, Rectangle, Side,
};
use signorini::nalgebra::Vector2;
use signorini::results::ContactPoint;
use signorini::results::Solution;
use signorini::solve::solve;

use super::common::*;

/// A peak of these meshes, of some twenty edges in contact, beside the closed form.
const PEAK: f64 = 0.02;

/// The solver's tolerance leaves rounding errors, some thousand of them in a sum over the body.
const SOLVED: f64 = 1e-11;

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
    Condition::displacement(move |_| x, move |_| y)
}

/// The ring on a rigid pin, its rim moved to the right by 0.01; lambda = mu = 1.
fn ring_on_a_pin(mesh: Mesh, contact: Condition) -> Problem {
    Problem::of(mesh, unit_material()).with("rim", moved_by(0.01, 0.0)).with("pin", contact)
}

fn circle(radius: f64, side: Side) -> Condition {
    Condition::Obstacle("pin".to_owned(), Obstacle::Circle { center: [0.0; 2], radius, side })
}

/// What an independent program with nodal normals found with 192 edges: the peak 0.0302, the force 0.0613.
#[test]
fn the_pressure_of_a_pin_converges_on_even_and_uneven_edges_with_an_obstacle_and_without() {
    for degree in DEGREES {
        for skew in [0.0, 2.0] {
            for contact in [circle(1.0, Side::Outside), Condition::contact(|_| 0.0)] {
                let s = solved(&ring_on_a_pin(ring(96, skew), contact), degree);
                let pin = &s.boundaries[0];
                assert!(
                    relative_eq!(pin.peak_pressure, 0.0302, max_relative = PEAK),
                    "{degree:?} {skew}: {pin:?}"
                );
                assert!(
                    abs_diff_eq!(pin.force / 0.0613, 1.0, epsilon = 0.005),
                    "{degree:?} {skew}: {pin:?}"
                );
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
        let edges = named_edges(&mesh);
        let mut named = vec![("rim".to_owned(), edges["rim"].clone())];
        let mut conditions: BTreeMap<String, Condition> =
            BTreeMap::from([("rim".to_owned(), moved_by(0.01, 0.0))]);
        for (i, &[a, b]) in edges["pin"].iter().enumerate() {
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

/// A shaft that fits its bearing with interference d all round: u = -d r / R inside, p = 2 (lambda + mu) d / R.
#[test]
fn a_shaft_pressed_into_a_bearing_has_the_constant_pressure_of_its_closed_form() {
    let mesh = polygon(64, 10);
    let (d, lambda, mu) = (1e-3, 1.5, 1.0);
    let held =
        |vertex, displacement| PointSupport { name: format!("{vertex}"), vertex, displacement };
    for degree in DEGREES {
        for gap in [false, true] {
            let contact =
                if gap { Condition::contact(move |_| -d) } else { circle(1.0 - d, Side::Inside) };
            let mut problem = Problem::of(mesh.clone(), Material::lame(lambda, mu, Plane::Strain))
                .with("rim", contact);
            // The centre stays where it is, and the shaft does not turn.
            problem.points.push(held(0, [Some(constant(0.0)), Some(constant(0.0))]));
            problem.points.push(held(1, [None, Some(constant(0.0))]));
            let s = solved(&problem, degree);
            let p = 2.0 * (lambda + mu) * d;
            let rim = &s.boundaries[0];
            let least =
                s.contact.iter().flat_map(|e| &e.points).map(|p| p.pressure).fold(1.0, f64::min);
            assert_relative_eq!(rim.peak_pressure, p, max_relative = PEAK);
            assert_relative_eq!(least, p, max_relative = PEAK);
            assert!(rim.resultant[0].hypot(rim.resultant[1]) < 1e-12 * rim.force + 1e-16);
            // Each edge is a chord, whose wave in lambda^h of P2 is not in the recovered pressure.
            let wave = |value: fn(&ContactPoint) -> f64| {
                let off = |v: &ContactPoint| (value(v) / p - 1.0).abs();
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
    let roller = || Condition::roller();
    let problem = Problem::of(mesh, materials)
        .with("left", roller())
        .with("right", roller())
        .with("top", Condition::Displacement([None, Some(constant(-push))]))
        .with("bottom", Condition::contact(|_| 0.0));
    // Springs in series: lambda + 2 mu over the height of each.
    let p = push
        / (0.5 / soft.normal_stiffness(Vector2::<f64>::y())
            + 0.5 / stiff.normal_stiffness(Vector2::<f64>::y()));
    for degree in DEGREES {
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

/// Every variant of the format gives the same body and the same answer.
#[test]
fn every_variant_of_the_bracket_gives_the_same_result() {
    let root = root();
    let mut answers = Vec::new();
    for name in [
        "cases/bracket.msh",
        "tests/meshes/bracket-binary.msh",
        "tests/meshes/bracket-22.msh",
        "tests/meshes/bracket-22-binary.msh",
    ] {
        let file = root.join(name);
        let mesh = gmsh::read(&file, None, &[]).unwrap().mesh;
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
