//! Bodies on which A alone, or doubles alone, would not do: slender beams, bodies that are moved as a whole, slivers, and those on
//! which Newton's method takes its longest. That both routes of the solver end at the same displacement is a property of
//! `properties::conditions`.

use approx::{abs_diff_eq, assert_abs_diff_eq};
use signorini::io::Case;
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Mesh, Problem, Rectangle, SharedFunction};
use signorini::results::{RouteName, Verdict};
use signorini::solve::{Gamma0, Method, Settings, SolveError, solve};

use crate::common::*;

/// A beam of this length and height 1, clamped on the left, its tip coming down on the floor.
fn beam(length: f64, degree: Degree) -> (Problem, Method) {
    let mesh =
        Rectangle { width: length, height: 1.0, nx: 400, ny: 1, diagonal: Diagonal::Crossed };
    let material = Material::young_poisson(1.0, 0.3, Plane::Strain);
    let problem = Problem::of(mesh.mesh().unwrap(), material)
        .with_body_force(|_| 0.0, |_| -1e-4)
        .with("left", Condition::clamped())
        .with("bottom", Condition::contact(|_| 0.02));
    (problem, method(degree, EXACT))
}

/// Condition numbers beyond this leave doubles nothing.
const BEYOND_DOUBLES: f64 = 1e15;

#[test]
fn slender_beams_are_proved_unless_their_condition_is_beyond_doubles() {
    for degree in DEGREES {
        let mut proved = 0;
        for length in [1e2, 1e3, 1e4] {
            let (problem, method) = beam(length, degree);
            let condition = match solve(&problem, &method, &Settings::default()) {
                Ok((solution, _)) if solution.verdict == Verdict::Proved => {
                    proved += 1;
                    continue;
                }
                Ok((solution, _)) => solution.method.condition,
                Err(SolveError::IllConditioned { condition, .. }) => condition,
                Err(error) => panic!("{length} {degree:?}: {error}"),
            };
            assert!(condition > BEYOND_DOUBLES, "{length} {degree:?}: {condition:e}");
        }
        assert!(proved >= 2, "{degree:?}: {proved} proved");
    }
}

#[test]
fn a_beam_beyond_double_precision_is_refused_with_the_reason() {
    let (mut problem, method) = beam(1e6, Degree::Two);
    problem.conditions.insert("bottom".to_owned(), Condition::contact(|_| 1e30));
    let error = solve(&problem, &method, &Settings::default()).unwrap_err();
    assert!(matches!(error, SolveError::Singular | SolveError::IllConditioned { .. }), "{error}");
}

#[test]
fn a_lift_that_is_the_solution_has_converged() {
    // One cell whose lower side follows the upper one: nothing is left for the free unknowns to do but to move along.
    let material = Material::young_poisson(1.0, 0.0, Plane::Strain);
    let problem = Problem::of(unit_square(1).mesh().unwrap(), material)
        .with("top", Condition::displacement(|_| 0.0, |_| -0.5))
        .with("bottom", Condition::contact(|_| 0.0));
    let (s, _) = solve(&problem, &method(Degree::One, EXACT), &Settings::default()).unwrap();
    // Data of one digit, four unknowns: some hundred roundings.
    approx::assert_abs_diff_eq!(s.quantities.contact_force, 0.5, epsilon = 1e-13);
    assert!(s.newton.residuals.iter().all(|r| r.is_finite()));
}

/// A block without loads whose upper side is moved down by 1/16; the floor is at `gap`.
fn moved_down(n: usize, gap: SharedFunction) -> Problem {
    Problem::of(unit_square(n).mesh().unwrap(), Material::lame(4.0, 1.0, Plane::Strain))
        .with("top", Condition::displacement(|_| 0.0, |_| -0.0625))
        .with("bottom", Condition::Contact { gap })
}

#[test]
fn a_body_that_is_moved_as_a_whole_to_where_it_touches_is_solved() {
    for degree in DEGREES {
        for n in [1, 2, 3, 5, 8] {
            // The floor is touched along all of the side, in a corner, or not at all.
            for slope in [0.0, 0.0625, -0.03125, 0.5] {
                let start = if slope < 0.0 { 0.0625 - slope } else { 0.0625 };
                let gap = function(move |[x, _]: [f64; 2]| start + slope * x);
                let solved =
                    solve(&moved_down(n, gap), &method(degree, EXACT), &Settings::default());
                let (s, _) = solved.unwrap_or_else(|e| panic!("n = {n}, slope {slope}: {e}"));
                for u in &s.displacement {
                    assert!(
                        u[0].abs() < 1e-15 && abs_diff_eq!(u[1], -0.0625, epsilon = 1e-15),
                        "{u:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn control_where_the_floor_is_reached_earlier_it_is_not_moved_as_a_whole() {
    let problem = moved_down(4, constant(0.0625 - 1e-9));
    let (s, _) = solve(&problem, &method(Degree::One, EXACT), &Settings::default()).unwrap();
    // Pressed together by 1e-9: sigma_n = -(lambda + 2 mu) 1e-9 where the sides do not bulge, 4 mu (lambda + mu) / (lambda + 2
    // mu) times 1e-9 where they are free to.
    assert!((3e-9..6e-9).contains(&s.quantities.contact_force), "{:e}", s.quantities.contact_force);
    assert!(s.enclosure.unwrap().relative.unwrap() < 1e-5);
}

/// The block with one triangle on the floor cut in three, of which the one at the floor is a sliver of this height.
fn with_a_sliver(height: f64) -> Problem {
    let mesh = unit_square(16).mesh().unwrap();
    let at = mesh.edges_of("bottom").unwrap()[8];
    let [a, b] = mesh.ends(at);
    let mut vertices = mesh.vertices().to_vec();
    let inside = vertices.len();
    vertices.push([(vertices[a][0] + vertices[b][0]) / 2.0, height]);
    let mut triangles = mesh.triangles().to_vec();
    let [_, _, c] = [0, 1, 2].map(|i| triangles[at.triangle][(at.local + 1 + i) % 3]);
    assert!(![a, b].contains(&c));
    triangles[at.triangle] = [a, b, inside];
    triangles.extend([[b, c, inside], [c, a, inside]]);
    block(Mesh::new(vertices, triangles, named_edges(&mesh)).unwrap())
}

#[test]
fn a_sliver_spoils_itself_only_where_gamma_is_local() {
    for degree in DEGREES {
        let peak = |problem: &Problem, gamma0| {
            let method = Method { gamma0, ..method(degree, EXACT) };
            solve(problem, &method, &Settings::default()).unwrap().0.quantities.peak_pressure
        };
        let whole = block(unit_square(16).mesh().unwrap());
        let expected = peak(&whole, Gamma0::Auto);
        // All triangles on the floor are alike, so one gamma0 and local ones are the same.
        let same = peak(&whole, Gamma0::local(0.5).unwrap());
        assert_abs_diff_eq!(same, expected, epsilon = 1e-9 * expected);
        let spoilt = with_a_sliver(1e-4);
        let [one, local] = [Gamma0::Auto, Gamma0::Local(0.5)].map(|g| peak(&spoilt, g));
        assert!(
            abs_diff_eq!(local / expected, 1.0, epsilon = 0.01),
            "{degree:?} {local} {expected}"
        );
        assert!(one / expected > 1.1, "the control: {degree:?} {one} {expected}");
    }
}

/// Bodies on which Newton's method takes its longest: two materials of which one is a million times stiffer, stiff springs beside
/// soft triangles, a nearly incompressible body that slides off an obstacle, and a shaft that its bearing alone holds.
#[test]
fn hard_bodies_are_proved_in_a_bounded_number_of_steps() {
    for (name, most) in [("parts234", 40), ("parts344", 40), ("poly370", 50), ("shaft7012", 25)] {
        let case = Case::read(&root().join(format!("tests/newton/{name}.toml"))).unwrap();
        let (solution, _) = solve(&case.problem, &case.method, &Settings::default()).unwrap();
        let (steps, reason) = (solution.newton.iterations(), solution.verdict.reason());
        assert!(steps <= most && reason.is_none(), "{name}: {steps} steps, {reason:?}");
    }
}

#[test]
fn beams_are_condensed_and_long_strips_of_a_few_rows_are_not() {
    // On a beam with twice as many cells a side, the assembled route took 2.1 (P1) and 3.7 (P2) times as long.
    let bodies = [
        ("left", 20.0, [160, 8], RouteName::Condensed),
        ("top", 1.0, [16, 16], RouteName::Condensed),
        ("top", 100.0, [200, 2], RouteName::Assembled),
    ];
    for (held, width, [nx, ny], expected) in bodies {
        for degree in DEGREES {
            let mesh = Rectangle { width, height: 1.0, nx, ny, diagonal: Diagonal::Crossed };
            let material = Material::lame(1.0, 1.0, Plane::Strain);
            let problem = Problem::of(mesh.mesh().unwrap(), material)
                .with(held, Condition::clamped())
                .with("bottom", Condition::contact(|_| 0.0));
            let solved = solve(&problem, &method(degree, EXACT), &Settings::default());
            assert_eq!(solved.unwrap().0.method.route, expected, "{width} {degree:?}");
        }
    }
}
