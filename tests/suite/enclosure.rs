//! The enclosure of the exact solution of (8) that comes with every solve.

use std::collections::BTreeMap;
use std::path::Path;

use signorini::fem::{Condition, Diagonal, Problem, Rectangle};
use signorini::io::Case;
use signorini::kernel::{Material, Plane};
use signorini::solve::enclosure::{self, Enclosure};
use signorini::solve::system::System;
use signorini::solve::{
    ContactQuadrature, Degree, Gamma0, Method, Settings, Solution, Unproved, Verdict, check,
    discretize, solve,
};

use crate::assembled::Assembled;
use crate::common::{clamped, constant, function};

const FORCE: [f64; 2] = [0.25, -1.0];

/// A block that is clamped on top and pushed on a floor that rises to one side.
fn block(n: usize) -> Problem {
    let mesh = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Left };
    Problem::new(
        mesh.mesh().unwrap(),
        Material::lame(1.0, 1.0, Plane::Strain),
        FORCE.map(constant),
        BTreeMap::from([
            ("top".to_owned(), clamped()),
            ("bottom".to_owned(), Condition::Contact { gap: function(|[x, _]| x / 4.0) }),
        ]),
    )
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
fn around(problem: &Problem, degree: Degree, u: &[[f64; 2]]) -> Enclosure {
    let method = with_degree(degree);
    let d = discretize(problem, &method).unwrap();
    enclosure::enclose(&System::new(&d).unwrap(), u, None, None).unwrap()
}

/// The true error over |u|_a, by the independent solver in double-double arithmetic.
fn true_error(problem: &Problem, degree: Degree, solution: &Solution, u: &[[f64; 2]]) -> f64 {
    let again = Assembled::new(problem, degree, solution.gamma.gamma0, FORCE, None);
    let answer = again.solve(Some(&solution.displacement)).unwrap();
    again.error(&answer, u)
}

#[test]
fn on_blocks_the_bound_is_less_than_three_times_the_error_that_rounding_leaves() {
    let meshes = [4, 8, 16, 32].map(|n| (Degree::One, n)).into_iter();
    for (degree, n) in meshes.chain([4, 8, 16].map(|n| (Degree::Two, n))) {
        let problem = block(n);
        let solution = solved(&problem, degree);
        let bound = solution.enclosure.as_ref().unwrap().relative.unwrap();
        let error = true_error(&problem, degree, &solution, &solution.displacement);
        println!("{degree:?}, n = {n}: error {error:.2e}, bound {bound:.2e}");
        // The independent solver has loads and gamma that are rounded elsewhere.
        let data = 2.0 * f64::EPSILON;
        assert!(error <= bound + data && bound < 3.0 * error, "{n}: {error:e} {bound:e}");
        assert!(bound < 1e-12);
    }
}

#[test]
fn a_perturbed_solution_raises_the_bound_by_the_perturbation_and_no_more_than_its_stiffness() {
    for degree in [Degree::One, Degree::Two] {
        let problem = block(6);
        let solution = solved(&problem, degree);
        let mut u = solution.displacement.clone();
        let top = |x: &[f64; 2]| x[1] == 1.0;
        for (i, (u, x)) in u.iter_mut().zip(&solution.nodes).enumerate() {
            if !top(x) {
                u[0] += 1e-7 * (i as f64).sin();
                u[1] += 1e-7 * (3.0 * i as f64).cos();
            }
        }
        let error = true_error(&problem, degree, &solution, &u);
        let bound = around(&problem, degree, &u).relative.unwrap();
        assert!(error <= bound && bound <= 30.0 * error, "{error:e} {bound:e}");
    }
}

#[test]
fn control_the_solution_for_another_load_is_not_enclosed_closely() {
    let problem = block(6);
    let mut other = block(6);
    other.body_force = [constant(0.25), constant(-1.0 - 1e-9)];
    let solution = solved(&other, Degree::One);
    let bound = around(&problem, Degree::One, &solution.displacement).relative.unwrap();
    assert!(bound > 1e-10, "{bound:e}");
    assert!(solution.enclosure.unwrap().relative.unwrap() < 1e-13);
}

#[test]
fn what_is_reported_lies_in_its_interval() {
    for degree in [Degree::One, Degree::Two] {
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
    let mut problem = block(4);
    problem.body_force = [constant(0.0), constant(0.0)];
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
    let pressed = Condition::Traction([constant(0.0), constant(-p)]);
    let floor = Condition::Contact { gap: constant(0.0) };
    let mut conditions =
        BTreeMap::from([("top".to_owned(), pressed), ("bottom".to_owned(), floor)]);
    if guided {
        let free = Condition::Mixed {
            displacement: [Some(constant(0.0)), None],
            traction: [constant(0.0), constant(0.0)],
        };
        conditions.insert("left".to_owned(), free);
    }
    let material = Material::young_poisson(1.0, 0.0, Plane::Strain);
    Problem::new(mesh.mesh().unwrap(), material, [constant(0.0), constant(0.0)], conditions)
}

fn contains([low, high]: [f64; 2], x: f64) -> bool {
    low <= x && x <= high
}

#[test]
fn what_is_exact_of_a_body_that_contact_alone_holds_lies_in_its_intervals() {
    for (n, p, guided) in [(1, 0.25, true), (2, 0.5, false), (5, 0.125, true), (6, 0.25, false)] {
        for degree in [Degree::One, Degree::Two] {
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
    for degree in [Degree::One, Degree::Two] {
        let problem = pressed(3, 0.25, true);
        let solution = solved(&problem, degree);
        let mut u: Vec<[f64; 2]> = solution.nodes.iter().map(|x| [0.0, -0.25 * x[1]]).collect();
        for (i, (u, x)) in u.iter_mut().zip(&solution.nodes).enumerate() {
            let by = 2.0_f64.powi(-24);
            let noise = [(i as f64).sin(), (3.0 * i as f64).cos()];
            *u = [if x[0] == 0.0 { 0.0 } else { by * noise[0] }, u[1] + by * noise[1]];
        }
        let apart: Vec<[f64; 2]> =
            u.iter().zip(&solution.nodes).map(|(u, x)| [u[0], u[1] + 0.25 * x[1]]).collect();
        let d = discretize(&problem, &with_degree(degree)).unwrap();
        let error = d.strain_energy(&apart).sqrt();
        let enclosure = around(&problem, degree, &u);
        let bound = enclosure.radius;
        println!("{degree:?}: {error:.2e} {bound:.2e}");
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
    let d = discretize(&problem, &Method::default()).unwrap();
    let enclosure = enclosure::enclose(&System::new(&d).unwrap(), &u, None, None);
    assert_eq!(enclosure, Err(Unproved::HeldByContact));
}

#[test]
fn a_disk_that_a_force_presses_is_enclosed_and_its_contact_force_is_the_load() {
    let case = case("disk_force", &[]);
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
        let case = case(name, &[]);
        let (solution, _) = solve(&case.problem, &case.method, &tight()).unwrap();
        let relative = solution.enclosure.unwrap().relative.unwrap();
        println!("{name}: {relative:.1e}");
        assert!(relative < 1e-9, "{name}: {relative:e}");
    }
}

fn case(name: &str, settings: &[&str]) -> Case {
    let file = format!("cases/{name}.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
    Case::parse(Path::new(&file), &text, &settings).unwrap()
}

#[test]
fn a_body_that_lifts_off_its_floor_beside_a_wall_that_it_may_slide_to_is_enclosed() {
    let mesh = Rectangle { width: 4.0, height: 1.0, nx: 16, ny: 4, diagonal: Diagonal::Crossed };
    let force = function(|[x, _]| if x < 3.0 { -2.0 } else { 1.0 });
    let problem = Problem {
        body_force: [constant(0.0), force],
        ..Problem::of(mesh.mesh().unwrap(), Material::lame(100.0, 100.0, Plane::Strain))
            .with("bottom", Condition::Contact { gap: constant(0.0) })
            .with("right", Condition::Contact { gap: constant(0.1) })
    };
    for degree in [Degree::One, Degree::Two] {
        let method = Method { degree, ..Method::default() };
        let (solution, _) = solve(&problem, &method, &Settings::default()).unwrap();
        let [floor, wall] = &solution.boundaries[..] else { panic!("two boundaries") };
        assert!(floor.length > 0.0 && floor.length < 4.0, "it lifts off: {}", floor.length);
        assert!(wall.force == 0.0 && solution.plays.len() == 1, "{:?}", solution.plays);
        assert_eq!(solution.verdict, Verdict::Proved);
    }
}
