//! Adaptivity to a proved target: where the solution is singular the error falls as the square root of the number of
//! unknowns does, which uniform refinement does not reach; the target that is reported as met is met; and what cannot be
//! adapted is refused.

use crate::common::exact::{corner, on_square, on_trapezoid, singular};
use crate::common::*;
use approx::abs_diff_eq;
use signorini::certificates::adapt::AdaptError;
use signorini::certificates::{Adapted, Asked, Target, adapt, adapt_to, certify};
use signorini::io::Case;
use signorini::io::run;
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Condition, Materials, PointSupport, Problem};
use signorini::solve::{Method, Settings, solve};
use study::Ladder;
use study::ladder::fitted_slope;

/// To a mesh of at most so many unknowns, whatever the bound is there.
fn as_fine_as(max_unknowns: usize) -> Target {
    Target { relative: 0.0, max_unknowns }
}

fn adapted(ladder: &Ladder, target: Target) -> (Problem, Adapted) {
    let problem = ladder.problem(0).unwrap();
    adapt(problem, &ladder.method, &ladder.settings, target, &|_| {}).unwrap()
}

/// Unknowns, true error and bound.
struct Point {
    unknowns: f64,
    error: f64,
    bound: f64,
}

/// The slopes of error and bound over the unknowns.
fn slopes(points: &[Point]) -> [f64; 2] {
    let unknowns: Vec<f64> = points.iter().map(|p| p.unknowns).collect();
    [|p: &Point| p.error, |p: &Point| p.bound].map(|of| {
        let values: Vec<f64> = points.iter().map(of).collect();
        fitted_slope(&unknowns, &values)
    })
}

fn on_adapted_meshes(ladder: &Ladder) -> Vec<Point> {
    let on = |most| {
        let (problem, a) = adapted(ladder, as_fine_as(most));
        let v = &a.certified.unwrap().displacement;
        let error = error_of(&problem, &ladder.solution, v);
        let last = a.levels.last().unwrap();
        assert!(
            a.unmet.is_some() && error <= last.bound && last.bound < most_over(ladder) * error,
            "{}",
            last.bound / error
        );
        Point { unknowns: last.unknowns as f64, error, bound: last.bound }
    };
    [500, 2000, 8000].map(on).into()
}

/// How far bounds may be above errors.
fn most_over(ladder: &Ladder) -> f64 {
    if ladder.method.degree == Degree::One { 2.0 } else { 3.0 }
}

fn on_uniform_meshes(ladder: &Ladder) -> Vec<Point> {
    let on = |level| {
        let (_, problem, solution) = ladder.solve(level).unwrap();
        let bound = certify(&problem, &solution).unwrap().bound;
        let v = &solution.displacement;
        let error = error_of(&problem, &ladder.solution, v);
        Point { unknowns: 2.0 * v.len() as f64, error, bound }
    };
    (1..=3).map(on).collect()
}

/// On adapted meshes error and bound fall as for smooth solutions, with the power -p/2 of the unknowns, but for what a fit over a
/// factor of 16 may be off; where uniform ones have less, they have what `uniform` says, and fail the same demand.
fn rates_are_those_of_smooth_solutions(degree: Degree) {
    let expected = -0.45 * degree.number() as f64;
    let of_corner = |omega: f64| {
        let (solution, alpha) = corner(omega);
        (on_trapezoid(&solution, omega, degree, 4), Some(alpha / 2.0))
    };
    // (b) is in H^(5/2): P1 has its full rate on any mesh.
    let uniform = (degree == Degree::Two).then_some(0.75);
    let of_end = (on_square(&singular(1.0 / 3.0), degree, 4), uniform);
    for (ladder, uniform) in [of_corner(0.6), of_end] {
        let [error, bound] = slopes(&on_adapted_meshes(&ladder));
        assert!(error < expected && bound < expected, "{error:.3} {bound:.3}");
        if let Some(uniform) = uniform {
            let [error, bound] = slopes(&on_uniform_meshes(&ladder));
            assert!(error > expected && bound > expected, "control: {error:.3} {bound:.3}");
            assert!(abs_diff_eq!(error, -uniform, epsilon = 0.1), "{error:.3} {uniform:.3}");
        }
    }
}

#[test]
fn error_and_bound_fall_as_for_smooth_solutions_on_adapted_meshes_where_uniform_ones_do_not_reach_it()
 {
    rates_are_those_of_smooth_solutions(Degree::One);
}

#[test]
fn error_and_bound_of_p2_fall_as_for_smooth_solutions_on_adapted_meshes() {
    rates_are_those_of_smooth_solutions(Degree::Two);
}

#[test]
fn a_target_is_met_with_far_fewer_unknowns_than_on_uniform_meshes() {
    let (solution, _) = corner(0.75);
    let ladder = on_trapezoid(&solution, 0.75, Degree::One, 4);
    let target = Target { relative: 0.06, max_unknowns: 1_000_000 };
    let (problem, a) = adapted(&ladder, target);
    let certified = a.certified.unwrap();
    assert!(a.unmet.is_none() && certified.relative <= 0.06);
    let last = a.levels.last().unwrap();
    assert_eq!((last.bound, last.unknowns), (certified.bound, 2 * problem.mesh.vertices().len()));
    assert!(a.levels.iter().rev().skip(1).all(|level| level.relative > 0.06));
    // A uniform mesh with twenty times as many is further away.
    let (_, problem, solution) = ladder.solve(5).unwrap();
    assert!(solution.displacement.len() * 2 > 20 * last.unknowns);
    assert!(certify(&problem, &solution).unwrap().relative > 0.06);
}

#[test]
fn newton_starts_from_the_coarser_solution_and_takes_fewer_steps() {
    let ladder = on_square(&singular(1.0 / 3.0), Degree::One, 4);
    let (problem, a) = adapted(&ladder, as_fine_as(4000));
    let (afresh, _) = solve(&problem, &ladder.method, &ladder.settings).unwrap();
    let last = a.levels.last().unwrap().newton_steps;
    assert!(last < afresh.newton.iterations(), "{last} of {}", afresh.newton.iterations());
    let far = a.solution.displacement.as_flattened().iter().zip(afresh.displacement.as_flattened());
    let far = far.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // Both are solutions to the tolerance of the solver, 1e-10 of the loads.
    assert!(far < 1e-9, "{far:e}");
}

/// A block of two materials, pulled aside, with data of the exact class.
fn two_materials() -> Problem {
    let mesh = unit_square(4).mesh().unwrap();
    let left: Vec<usize> = (0..mesh.triangles().len())
        .filter(|&t| mesh.triangle(t).point([1.0 / 3.0; 3]).x < 0.5)
        .collect();
    let [soft, hard] = [1.0, 10.0].map(|mu| Material::lame(1.0, mu, Plane::Strain));
    let materials = Materials::in_parts(soft, mesh.triangles().len(), [(hard, left.as_slice())]);
    let surfaces = [("left half".to_owned(), left)].into();
    let mesh = mesh.with_names(surfaces, [("foot".to_owned(), vec![0])].into()).unwrap();
    Problem::new(
        mesh,
        materials,
        [expression("0.4"), expression("-1")],
        conditions([
            ("top", Condition::Displacement([Some(expression("0")), Some(expression("0"))])),
            ("left", Condition::Traction([expression("0.3"), expression("0")])),
            ("bottom", Condition::Contact { gap: expression("0.01") }),
        ]),
    )
}

#[test]
fn materials_names_and_boundary_data_stay_where_they_are_and_the_bound_stays_rigorous() {
    let method = Method::default();
    let target = Target { relative: 0.1, max_unknowns: 20_000 };
    let (problem, a) =
        adapt(two_materials(), &method, &Settings::default(), target, &|_| {}).unwrap();
    assert!(a.unmet.is_none() && a.levels.len() > 2, "{:?}", a.levels);
    let certified = a.certified.unwrap();
    assert!(certified.rigorous, "{:?}", certified.reason);
    let mesh = &problem.mesh;
    for t in 0..mesh.triangles().len() {
        let is_left = mesh.triangle(t).point([1.0 / 3.0; 3]).x < 0.5;
        assert_eq!(problem.material.of(t).mu(), if is_left { 10.0 } else { 1.0 });
        assert_eq!(mesh.surface("left half").unwrap().contains(&t), is_left);
    }
    assert_eq!(mesh.vertices()[mesh.point("foot").unwrap()], [0.0; 2]);
    for (name, c, value) in [("top", 1, 1.0), ("left", 0, 0.0), ("bottom", 1, 0.0)] {
        let edges = mesh.edges_of(name).unwrap();
        assert!(
            edges.iter().all(|&e| mesh.ends(e).iter().all(|&v| mesh.vertices()[v][c] == value))
        );
        let length: f64 = edges.iter().map(|&e| mesh.length_and_normal(e).0).sum();
        assert!(abs_diff_eq!(length, 1.0, epsilon = 1e-12), "{name}: {length}");
    }
}

#[test]
fn what_has_no_certificate_is_refused_with_the_reason() {
    let refused = |problem: Problem, method: &Method| {
        let target = Target { relative: 0.1, max_unknowns: 1000 };
        let (_, adapted) = adapt(problem, method, &Settings::default(), target, &|_| {}).unwrap();
        assert!(adapted.certified.is_err() && adapted.levels.is_empty());
        adapted.unmet.unwrap()
    };
    let mut pointed = two_materials();
    let displacement = [Some(constant(0.0)), None];
    pointed.points.push(PointSupport { name: "foot".to_owned(), vertex: 0, displacement });
    let error = refused(pointed, &Method::default());
    assert!(error.contains("[point.foot] holds a point"), "{error}");
    // A floor that bends, with the gap along its normals.
    let bend = |[x, y]: [f64; 2]| [x, y - 0.1 * (1.0 - y) * x * (1.0 - x)];
    let bent = Problem::of(moved_to(&unit_square(8).mesh().unwrap(), bend), unit_material())
        .with_body_force(|_| 0.0, |_| -1.0)
        .with("top", Condition::clamped())
        .with("bottom", Condition::contact(|_| 0.0));
    let target = Target { relative: 0.1, max_unknowns: 1000 };
    let error = adapt(bent, &Method::default(), &Settings::default(), target, &|_| {}).err();
    assert_eq!(error, Some(AdaptError::Curved { boundary: "bottom".to_owned() }));
}

#[test]
fn a_body_at_rest_has_no_energy_to_compare_with() {
    let problem = Problem::of(unit_square(4).mesh().unwrap(), unit_material())
        .with("top", Condition::clamped())
        .with("bottom", Condition::contact(|_| 0.1));
    let target = Target { relative: 0.1, max_unknowns: 1000 };
    let (_, adapted) =
        adapt(problem, &Method::default(), &Settings::default(), target, &|_| {}).unwrap();
    assert_eq!(adapted.unmet.unwrap(), "the body is at rest, its energy is 0");
    assert_eq!(adapted.solution.quantities.energy, 0.0);
}

#[test]
fn a_force_where_no_contact_is_ends_the_refinement_at_once() {
    let problem = Problem::of(unit_square(4).mesh().unwrap(), unit_material())
        .with("top", Condition::displacement(|_| 0.0, |_| -0.1))
        .with("bottom", Condition::contact(|_| 0.0));
    let how = (&Method::default(), &Settings::default());
    let target = Target { relative: 0.9, max_unknowns: 1000 };
    let unmet = |boundary| {
        let goal = (target, Some(boundary));
        adapt_to(problem.clone(), how, goal, &Asked::default(), &|_| {}).unwrap().1.unmet
    };
    assert_eq!(unmet("left").unwrap(), "there is no contact on 'left'");
    assert_eq!(unmet("bottom"), None, "control");
}

fn of_the_file(settings: &[&str]) -> Case {
    case("corner.toml", settings)
}

#[test]
fn a_case_with_a_target_is_solved_on_the_adapted_mesh() {
    let small = ["method.degree=1", "mesh.trapezoid.n=4"];
    let case = of_the_file(&[&small[..], &["adapt.target=\"15 %\""]].concat());
    let (case, solved) = run::solve(case, None, &|_| {}).unwrap();
    let adaptation = solved.adaptation.unwrap();
    assert!(adaptation.met && adaptation.levels.len() > 3);
    assert_eq!(solved.solution.nodes, case.problem.mesh.vertices());
    let last = adaptation.levels.last().unwrap();
    assert_eq!(last.unknowns, 2 * solved.solution.nodes.len());
    assert!(last.relative <= 0.15);
    // Without a target the mesh stays.
    let (case, solved) = run::solve(of_the_file(&small), None, &|_| {}).unwrap();
    assert!(solved.certified.is_none() && case.problem.mesh.triangles().len() == 32);
    // Too few unknowns: no error, but said.
    let few = ["adapt.target=\"1 %\"", "adapt.max_unknowns=100"];
    let (_, solved) = run::solve(of_the_file(&[&small[..], &few].concat()), None, &|_| {}).unwrap();
    let adaptation = solved.adaptation.unwrap();
    assert!(!adaptation.met && adaptation.levels.iter().all(|l| l.unknowns <= 100));
}

#[test]
fn a_level_without_a_solution_says_which() {
    let few = ["method.degree=1", "solver.max_iterations=1", "adapt.target=\"1 %\""];
    let error = run::solve(of_the_file(&few), None, &|_| {}).err().unwrap();
    assert!(error.to_string().starts_with("[adapt]: level 0: no convergence"), "{error}");
}

/// Edges of some thousandths of the body, by which a margin that is known to the rounding of coordinates only is divided: the
/// bound stopped falling, rose, or was no number.
#[test]
fn the_best_level_is_kept_and_no_level_is_lost() {
    let circle = "[mesh]\nrectangle = { width = 1.0, height = 1.0, nx = 8, ny = 8 }\n[material]\nlambda = 1.0\nmu = 1.0\n[boundary.top]\ndisplacement = [\"0\", \"-0.03\"]\n[obstacle.c]\ncircle = { center = [0.4, -1.0], radius = 1.0, side = \"outside\" }\n[boundary.bottom]\ncontact = { obstacle = \"c\" }\n";
    let wedge = "[mesh]\ntrapezoid = { omega = 2.2, n = 4 }\n[material]\nlambda = 1.0\nmu = 1.0\n[boundary.left]\nnormal = \"0.01-0.01*y\"\n[boundary.top]\ndisplacement = [\"free\", \"-0.05\"]\n[boundary.bottom]\ncontact = { gap = \"0.01+0.03*x\" }\n";
    for text in [circle, wedge] {
        let settings = ["method.degree=2", "adapt.target=\"0.01 %\"", "adapt.max_unknowns=6000"];
        let (_, solved) = run::solve(case_of(text, &settings), None, &|_| {}).unwrap();
        let adaptation = solved.adaptation.unwrap();
        let bounds: Vec<f64> = adaptation.levels.iter().map(|level| level.bound).collect();
        let best = bounds.iter().copied().fold(f64::INFINITY, f64::min);
        assert_eq!(bounds[adaptation.level], best, "{bounds:?}");
        assert_eq!(solved.certified.unwrap().unwrap().bound, best);
        assert!(!adaptation.met && bounds.len() > 5, "{:?}: {bounds:?}", adaptation.reason);
        // It is the last here: nothing spoils it.
        assert_eq!(adaptation.level + 1, bounds.len(), "{bounds:?}");
    }
}

#[test]
fn a_bound_that_says_nothing_yet_does_not_end_the_refinement() {
    // Bounds of 385, 274, 178 %, then three that are larger.
    let text = r#"
mesh.rectangle = { width = 20, height = 1, nx = 2, ny = 1 }
method.degree = 2
material = { lambda = 1, mu = 1 }
load.body = ["0", "-0.01"]
boundary.left.displacement = ["-0.02*y", "-1"]
boundary.bottom.contact = { gap = "1" }
"#;
    let settings = ["adapt.target=\"90 %\"", "adapt.max_unknowns=20000"];
    let (_, solved) = run::solve(case_of(text, &settings), None, &|_| {}).unwrap();
    let adapt = solved.adaptation.unwrap();
    assert!(adapt.met, "{:?}: {:?}", adapt.reason, adapt.levels);
    let bounds: Vec<f64> = adapt.levels.iter().map(|level| level.relative).collect();
    let no_better = |four: &[f64]| four[0] > 1.0 && four[1..].iter().all(|bound| *bound > four[0]);
    assert!(bounds.windows(4).any(no_better), "{bounds:?}");
    // Where no finer mesh is allowed than the first with a larger bound, the one before it is given.
    let all = &adapt.levels;
    let worse = (1..all.len()).find(|&k| all[k].bound > all[k - 1].bound).unwrap();
    let most = format!("adapt.max_unknowns={}", all[worse].unknowns);
    let (_, solved) =
        run::solve(case_of(text, &["adapt.target=\"90 %\"", &most]), None, &|_| {}).unwrap();
    let few = solved.adaptation.unwrap();
    assert_eq!((few.levels.len(), few.level), (worse + 1, worse - 1), "{:?}", few.levels);
    assert_eq!(2 * solved.solution.nodes.len(), few.levels[few.level].unknowns);
    assert_eq!(solved.certified.unwrap().unwrap().bound, few.levels[few.level].bound);
}

/// Chords of half the length in place of one chord would have a gap of their own: with middles on the chords the bound grows.
#[test]
fn a_pin_in_a_hole_keeps_its_curve_on_finer_meshes_and_its_bound_falls_at_each_level() {
    let case = case("pin.toml", &[]);
    let Case { problem, method, settings, .. } = &case;
    let target = Target { relative: 0.008, max_unknowns: 20_000 };
    let (_, adapted) = adapt(problem.clone(), method, settings, target, &|_| {}).unwrap();
    let bounds: Vec<f64> = adapted.levels.iter().map(|level| level.relative).collect();
    assert!(adapted.unmet.is_none() && bounds.len() > 1, "{bounds:?}");
    assert!(bounds.is_sorted_by(|a, b| b < a), "{bounds:?}");
    let newest = problem.mesh.opposite_longest();
    let on_hole = problem.mesh.edges_of("hole").unwrap().iter().map(|edge| edge.triangle);
    let chords = problem.mesh.bisected(&newest, &on_hole.collect::<Vec<_>>()).unwrap();
    let chords = problem.clone().refined(chords);
    let (solution, _) = solve(&chords, method, settings).unwrap();
    let control = certify(&chords, &solution).unwrap();
    assert!(control.relative > bounds[0], "control: {} {bounds:?}", control.relative);
}
