//! The enclosure of the exact solution of (8) that comes with every solve.

use approx::{abs_diff_eq, assert_abs_diff_eq};
use signorini::kernel::{Material, Plane};
use signorini::linear::system::System;
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Mesh, Problem, Rectangle};
use signorini::proof::enclosure::Enclosure;
use signorini::proof::{Unproved, enclosure};
use signorini::results::{Solution, Verdict};
use signorini::solve::{ContactQuadrature, Gamma0, Method, Settings, check, discretize, solve};

use crate::common::{DEGREES, Random, case, polygon};

/// A block that is clamped on top and pushed by `down` on a floor that rises to one side.
fn block_under(n: usize, down: f64) -> Problem {
    let mesh = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Left };
    Problem::of(mesh.mesh().unwrap(), Material::lame(1.0, 1.0, Plane::Strain))
        .with_body_force(|_| 0.25, move |_| -down)
        .with("top", Condition::clamped())
        .with("bottom", Condition::contact(|[x, _]| x / 4.0))
}

fn block(n: usize) -> Problem {
    block_under(n, 1.0)
}

fn with_degree(degree: Degree) -> Method {
    Method { degree, ..Method::default() }
}

/// Settings that ask for all digits.
fn tight() -> Settings {
    Settings { proof: 1e-14, ..Settings::default() }
}

fn solved(problem: &Problem, degree: Degree) -> Solution {
    solve(problem, &with_degree(degree), &tight()).unwrap().0
}

/// The enclosure around a displacement.
fn around(problem: &Problem, degree: Degree, u: &[[f64; 2]]) -> Result<Enclosure, Unproved> {
    let method = with_degree(degree);
    let d = discretize(problem, &method).unwrap();
    enclosure::enclose(&System::new(&d).unwrap(), u, None, None)
}

/// The energy norm.
fn norm(problem: &Problem, degree: Degree, u: &[[f64; 2]]) -> f64 {
    discretize(problem, &with_degree(degree)).unwrap().strain_energy(u).sqrt()
}

fn difference(a: &[[f64; 2]], b: &[[f64; 2]]) -> Vec<[f64; 2]> {
    a.iter().zip(b).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect()
}

#[test]
fn on_blocks_the_bound_is_less_than_four_times_what_rounding_the_nodes_leaves() {
    let meshes = [4, 8, 16, 32].map(|n| (Degree::One, n)).into_iter();
    for (degree, n) in meshes.chain([4, 8, 16].map(|n| (Degree::Two, n))) {
        let problem = block(n);
        let solution = solved(&problem, degree);
        let bound = solution.enclosure.as_ref().unwrap().radius;
        // A unit of rounding is at most epsilon times the number; half of one is lost.
        let mut random = Random(2013);
        let mut lost = |u: f64| f64::EPSILON / 2.0 * u * random.next();
        let rounding: Vec<_> = solution.displacement.iter().map(|u| u.map(&mut lost)).collect();
        let rounding = norm(&problem, degree, &rounding);
        println!("{degree:?}, n = {n}: rounding {rounding:.2e}, bound {bound:.2e}");
        assert!(bound < 4.0 * rounding, "{n}: {rounding:e} {bound:e}");
        assert!(solution.enclosure.unwrap().relative.unwrap() < 1e-12);
    }
}

/// The energy norm of a known field is the distance of what is moved by it.
#[test]
fn a_perturbed_solution_raises_the_bound_by_the_perturbation_and_no_more_than_its_stiffness() {
    for degree in DEGREES {
        let problem = block(6);
        let solution = solved(&problem, degree);
        let mut u = solution.displacement.clone();
        for (i, (u, x)) in u.iter_mut().zip(&solution.nodes).enumerate() {
            if x[1] != 1.0 {
                u[0] += 1e-7 * (i as f64).sin();
                u[1] += 1e-7 * (3.0 * i as f64).cos();
            }
        }
        let error = norm(&problem, degree, &difference(&u, &solution.displacement));
        let bound = around(&problem, degree, &u).unwrap().radius;
        assert!(error <= bound && bound <= 30.0 * error, "{error:e} {bound:e}");
    }
}

#[test]
fn control_the_solution_for_another_load_is_not_enclosed_closely() {
    let problem = block(6);
    let solution = solved(&block_under(6, 1.0 + 1e-9), Degree::One);
    let bound = around(&problem, Degree::One, &solution.displacement).unwrap().relative.unwrap();
    assert!(bound > 1e-10, "{bound:e}");
    assert!(solution.enclosure.unwrap().relative.unwrap() < 1e-13);
}

#[test]
fn what_is_reported_lies_in_its_interval() {
    for degree in DEGREES {
        let solution = solved(&block(8), degree);
        let enclosure = solution.enclosure.as_ref().unwrap();
        let (of, q) = (&enclosure.intervals, &solution.quantities);
        // The doubles are rounded, the intervals are not wide.
        let inside = |[low, high]: [f64; 2], x: f64, size: f64| {
            let slack = 1e-12 * size;
            assert!(low - slack <= x && x <= high + slack, "{x} in [{low}, {high}]");
            assert!(high - low <= 1e-9 * size, "[{low}, {high}]");
        };
        inside(of.energy, q.energy, q.energy);
        inside(of.max_displacement, q.max_displacement, q.max_displacement);
        inside(of.contact[0].force, q.contact_force, q.contact_force);
        for c in 0..2 {
            inside(of.contact[0].resultant[c], q.contact_resultant[c], q.contact_force);
            inside(of.reactions["top"][c], q.reactions["top"][c], 1.0);
        }
    }
}

#[test]
fn a_body_at_rest_has_next_to_no_radius() {
    let problem = block(4).with_body_force(|_| 0.0, |_| 0.0);
    let solution = solved(&problem, Degree::One);
    let enclosure = solution.enclosure.unwrap();
    // It touches the floor in a point, where the sign of P is known to a hundred bits only.
    assert!(enclosure.radius <= 1e-25 && enclosure.pressure <= 1e-25);
    assert_eq!(enclosure.relative, None);
}

#[test]
fn where_kappa_is_1_nothing_is_claimed() {
    let problem = block(4);
    let limit = check(&problem, &Method::default()).unwrap().gamma.coercivity.limit();
    let method = Method {
        gamma0: Gamma0::Value(1.01 * limit),
        allow_noncoercive: true,
        ..Method::default()
    };
    let (solution, _) = solve(&problem, &method, &tight()).unwrap();
    assert!(matches!(solution.enclosure, Err(Unproved::NotCoercive { kappa }) if kappa >= 1.0));
}

/// A block that only its load presses on the floor, E = 1, nu = 0: u = (0, -p y) whatever the mesh, as (8) is consistent. Its
/// sides are guided, or it may slide along the floor.
fn pressed(n: usize, p: f64, guided: bool) -> Problem {
    let mesh = Rectangle { width: 2.0, height: 1.0, nx: 2 * n, ny: n, diagonal: Diagonal::Crossed };
    let material = Material::young_poisson(1.0, 0.0, Plane::Strain);
    let problem = Problem::of(mesh.mesh().unwrap(), material)
        .with("top", Condition::traction(|_| 0.0, move |_| -p))
        .with("bottom", Condition::contact(|_| 0.0));
    if guided { problem.with("left", Condition::roller()) } else { problem }
}

fn contains([low, high]: [f64; 2], x: f64) -> bool {
    low <= x && x <= high
}

#[test]
fn what_is_exact_of_a_body_that_contact_alone_holds_lies_in_its_intervals() {
    for (n, p, guided) in [(1, 0.25, true), (2, 0.5, false), (5, 0.125, true), (6, 0.25, false)] {
        for degree in DEGREES {
            for quadrature in [ContactQuadrature::Exact, ContactQuadrature::Gauss(4)] {
                let problem = pressed(n, p, guided);
                let method = Method { degree, quadrature, ..Method::default() };
                let (solution, _) = solve(&problem, &method, &tight()).unwrap();
                assert_eq!(solution.method.slides, usize::from(!guided));
                let enclosure = solution.enclosure.unwrap();
                let of = &enclosure.intervals;
                // Areas, lengths and loads are sums of dyadic numbers; u and P are, too.
                assert!(contains(of.energy, 2.0 * p * p), "{of:?}");
                assert!(contains(of.max_displacement, p), "{of:?}");
                assert!(contains(of.contact[0].force, 2.0 * p), "{of:?}");
                assert!(contains(of.contact[0].resultant[1], 2.0 * p), "{of:?}");
                assert!(enclosure.relative.unwrap() < 1e-13);
                assert!(of.contact[0].force[1] - of.contact[0].force[0] < 1e-12);
                for (x, (u, bound)) in
                    solution.nodes.iter().zip(solution.displacement.iter().zip(&enclosure.nodes))
                {
                    let off = u[0].hypot(u[1] + p * x[1]);
                    assert!(off <= *bound && *bound < 1e-9, "{x:?}: {off:e} {bound:e}");
                }
            }
        }
    }
}

#[test]
fn a_perturbed_displacement_that_contact_alone_holds_is_as_far_off_as_its_radius_says() {
    for degree in DEGREES {
        let problem = pressed(3, 0.25, true);
        let solution = solved(&problem, degree);
        let exact: Vec<[f64; 2]> = solution.nodes.iter().map(|x| [0.0, -0.25 * x[1]]).collect();
        let mut u = exact.clone();
        for (i, (u, x)) in u.iter_mut().zip(&solution.nodes).enumerate() {
            let by = 2.0_f64.powi(-24);
            let noise = [(i as f64).sin(), (3.0 * i as f64).cos()];
            *u = [if x[0] == 0.0 { 0.0 } else { by * noise[0] }, u[1] + by * noise[1]];
        }
        let apart = difference(&u, &exact);
        let error = norm(&problem, degree, &apart);
        let enclosure = around(&problem, degree, &u).unwrap();
        let bound = enclosure.radius;
        // Rounding in the error.
        assert!(error <= bound * (1.0 + 1e-9) && bound <= 30.0 * error, "{error:e} {bound:e}");
        for (node, apart) in enclosure.nodes.iter().zip(&apart) {
            assert!(apart[0].hypot(apart[1]) <= *node);
        }
    }
}

#[test]
fn control_where_the_perturbation_may_lift_the_body_off_nothing_is_claimed() {
    let problem = pressed(3, 2.0_f64.powi(-30), true);
    let solution = solved(&problem, Degree::One);
    let by = |i: usize, x: &[f64; 2]| if x[0] == 0.0 { 0.0 } else { 1e-3 * (i as f64).sin() };
    let u: Vec<[f64; 2]> = solution
        .nodes
        .iter()
        .enumerate()
        .map(|(i, x)| [by(i, x), -2.0_f64.powi(-30) * x[1]])
        .collect();
    assert_eq!(around(&problem, Degree::One, &u), Err(Unproved::HeldByContact));
}

/// Between two walls that it does not touch: how near the solution is, is known with one vertex moved in the middle of the body, and whether
/// it touches a wall is known only if the vertex is moved by far less than the gap.
#[test]
fn beside_walls_nothing_is_claimed_of_a_displacement_that_is_further_off_than_they_are() {
    let gap = 2.0_f64.powi(-20);
    let problem = pressed(4, 0.25, false)
        .with("left", Condition::contact(move |_| gap))
        .with("right", Condition::contact(move |_| gap));
    let nodes = solved(&problem, Degree::One).nodes;
    let moved = |by: f64| -> Vec<[f64; 2]> {
        let at = |x: &[f64; 2]| if *x == [1.0, 0.5] { by } else { 0.0 };
        nodes.iter().map(|x| [at(x), -0.25 * x[1]]).collect()
    };
    assert!(nodes.contains(&[1.0, 0.5]));
    let near = around(&problem, Degree::One, &moved(gap * 2.0_f64.powi(-20)));
    assert!(near.as_ref().is_ok_and(|near| near.radius < gap), "{near:?}");
    let far = around(&problem, Degree::One, &moved(1024.0 * gap));
    assert_eq!(far, Err(Unproved::HeldByContact));
    // Walls far away do not matter.
    let free = pressed(4, 0.25, false);
    let far = around(&free, Degree::One, &moved(1024.0 * gap));
    assert!(far.as_ref().is_ok_and(|far| far.radius > gap), "{far:?}");
}

#[test]
fn a_disk_that_a_force_presses_is_enclosed_and_its_contact_force_is_the_load() {
    let case = case("disk_force.toml", &[]);
    let (solution, _) = solve(&case.problem, &case.method, &tight()).unwrap();
    let enclosure = solution.enclosure.unwrap();
    assert!(enclosure.relative.unwrap() < 1e-10, "{:?}", enclosure.relative);
    let [low, high] = enclosure.intervals.contact[0].resultant[1];
    // 8.5 but for the rounding of the vertices that the chord is the sum of edges of.
    assert!(low <= 8.5 + 1e-12 && high >= 8.5 - 1e-12 && high - low < 1e-8, "[{low}, {high}]");
}

#[test]
fn the_cases_whose_supports_hold_them_are_certified() {
    for name in ["block", "gap", "smooth", "singular", "corner", "cantilever", "disk", "pin"] {
        let case = case(&format!("{name}.toml"), &[]);
        let (solution, _) = solve(&case.problem, &case.method, &tight()).unwrap();
        let relative = solution.enclosure.unwrap().relative.unwrap();
        println!("{name}: {relative:.1e}");
        assert!(relative < 1e-9, "{name}: {relative:e}");
    }
}

#[test]
fn a_body_that_lifts_off_its_floor_beside_a_wall_that_it_may_slide_to_is_enclosed() {
    let mesh = Rectangle { width: 4.0, height: 1.0, nx: 16, ny: 4, diagonal: Diagonal::Crossed };
    let problem = Problem::of(mesh.mesh().unwrap(), Material::lame(100.0, 100.0, Plane::Strain))
        .with_body_force(|_| 0.0, |[x, _]| if x < 3.0 { -2.0 } else { 1.0 })
        .with("bottom", Condition::contact(|_| 0.0))
        .with("right", Condition::contact(|_| 0.1));
    for degree in DEGREES {
        let method = Method { degree, ..Method::default() };
        let (solution, _) = solve(&problem, &method, &Settings::default()).unwrap();
        let [floor, wall] = &solution.boundaries[..] else { panic!("two boundaries") };
        assert!(floor.length > 0.0 && floor.length < 4.0, "it lifts off: {}", floor.length);
        assert!(wall.force == 0.0 && solution.plays.len() == 1, "{:?}", solution.plays);
        assert_eq!(solution.verdict, Verdict::Proved);
    }
}

/// A block that is moved by `by` and turned by as much, off its floor.
fn moved(by: f64) -> (signorini::io::Case, Solution) {
    let text = format!(
        "mesh.rectangle = {{ width = 1, height = 1, nx = 3, ny = 3 }}\nmaterial = {{ young = 1, poisson = 0.3 }}\nboundary.top.displacement = [\"0\", \"{by:e} + {by:e}*x\"]\nboundary.bottom.contact = {{}}\nmethod.degree = 2\n"
    );
    let case = crate::common::case_of(&text, &[]);
    let solution = solve(&case.problem, &case.method, &case.settings).unwrap().0;
    (case, solution)
}

#[test]
fn the_relative_radius_is_relative_to_the_energy_norm_or_the_body_hardly_strains() {
    for by in [1e-3, 1.0, 1e3, 1e6, 1e9] {
        let (_, solution) = moved(by);
        let enclosure = solution.enclosure.clone().unwrap();
        let [low, high] = enclosure.intervals.energy;
        let energy = solution.quantities.energy;
        assert!(low <= energy && energy <= high, "{by}: {low} {energy} {high}");
        match enclosure.relative {
            // |u|_a is that of rounding.
            Some(relative) => {
                let by_norm = enclosure.radius / energy.sqrt();
                assert!(
                    abs_diff_eq!(relative / by_norm, 1.0, epsilon = 0.5) || relative > 0.1,
                    "{relative}"
                );
            }
            // Of 1e6 on what is known of the strain is less than its rounding: nothing is proved.
            None => assert_eq!(enclosure.hardly_strains, by < 1e6, "{by}: {high}"),
        }
        // Beside what it would be if the body strained, the radius is small.
        assert_eq!(solution.verdict == Verdict::Proved, by < 1e6, "{by}");
    }
    // Control: a body that strains has a norm.
    // So does one that is carried far, and by far less than it would if it strained by as much as that.
    let carried = Condition::displacement(|_| 1.0, |[x, _]| 1e-3 * x);
    for problem in [block(4), block(4).with("top", carried)] {
        let solution = solved(&problem, Degree::One);
        let enclosure = solution.enclosure.unwrap();
        let norm = solution.quantities.energy.sqrt();
        let relative = enclosure.relative.unwrap();
        assert_abs_diff_eq!(relative * norm / enclosure.radius, 1.0, epsilon = 1e-9);
    }
}

/// A disk whose rim is of so many boundaries that are held, and one of contact.
#[test]
fn reactions_are_enclosed_for_up_to_64_boundaries() {
    for (count, enclosed) in [(64, 64), (65, 0)] {
        let disk = polygon(count + 1, 1);
        let rim = disk.edges_of("rim").unwrap().iter().enumerate();
        let named: Vec<_> = rim.map(|(k, &edge)| (format!("{k}"), vec![disk.ends(edge)])).collect();
        let mesh = Mesh::new(disk.vertices().to_vec(), disk.triangles().to_vec(), named).unwrap();
        let problem = Problem::of(mesh, Material::lame(1.0, 1.0, Plane::Strain))
            .with_body_force(|_| 0.1, |_| 0.2)
            .with("0", Condition::contact(|_| 1.0));
        let problem = (1..=count).fold(problem, |p, k| p.with(k.to_string(), Condition::clamped()));
        let solution = solved(&problem, Degree::Two);
        let found = solution.enclosure.as_ref().unwrap();
        assert_eq!(solution.quantities.reactions.len(), count);
        assert_eq!(found.intervals.reactions.len(), enclosed);
    }
}
