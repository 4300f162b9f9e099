//! Bodies that no support holds, or not enough of them: contact does, because the loads press. The answers are known from
//! equilibrium, and from the same bodies on supports that happen to carry nothing.

use approx::assert_abs_diff_eq;
use signorini::fem::{Condition, DataError, Mesh, Problem};
use signorini::kernel::{Material, Plane};
use signorini::solve::{Degree, RouteName, Settings, Solution, SolveError, solve};

use crate::common::*;

/// What a load of 0.1 may be off in the sum of contact forces: the last step of Newton's method leaves rounding errors only,
/// times the condition of these small systems.
const SOLVED: f64 = 1e-12;

const DEGREES: [Degree; 2] = [Degree::One, Degree::Two];

fn contact(gap: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static) -> Condition {
    Condition::Contact { gap: function(gap) }
}

fn block_under(mesh: Mesh, [fx, fy]: [f64; 2], parts: Vec<(&'static str, Condition)>) -> Problem {
    let conditions = parts.into_iter().map(|(name, c)| (name.to_owned(), c)).collect();
    let material = Material::young_poisson(1.0, 0.3, Plane::Strain);
    Problem::new(mesh, material, [constant(fx), constant(fy)], conditions)
}

fn solved(problem: &Problem, degree: Degree) -> Solution {
    let (s, _) = solve(problem, &method(degree, EXACT), &Settings::default()).unwrap();
    assert_eq!(s.method.route, RouteName::Assembled);
    assert!(s.newton.residual <= 1e-10 && s.method.forward_error <= 1e-10);
    assert!(s.newton.iterations() <= 25);
    s
}

#[test]
fn a_block_on_a_floor_carries_its_weight_and_stays_where_it_is() {
    for degree in DEGREES {
        let mesh = skewed_square(6, signorini::fem::Diagonal::Crossed);
        let s = solved(&block_under(mesh, [0.0, -0.1], vec![("bottom", contact(|_| 0.0))]), degree);
        assert_abs_diff_eq!(s.quantities.contact_force, 0.1, epsilon = SOLVED);
        assert_eq!(s.method.slides, 1, "it may slide along the floor");
        let mean: f64 = s.displacement.iter().map(|u| u[0]).sum();
        // The one of least norm of all solutions: a sum of some hundred displacements.
        assert_abs_diff_eq!(mean, 0.0, epsilon = 100.0 * SOLVED);
    }
}

#[test]
fn a_block_in_a_corner_leans_on_floor_and_wall() {
    for degree in DEGREES {
        let parts = vec![("bottom", contact(|_| 0.0)), ("left", contact(|_| 0.001))];
        let s = solved(&block_under(unit_square(8).mesh().unwrap(), [-0.02, -0.1], parts), degree);
        let resultant = s.quantities.contact_resultant;
        assert_abs_diff_eq!(resultant[..], [0.02, 0.1][..], epsilon = SOLVED);
        assert_eq!(s.method.slides, 0);
    }
}

#[test]
fn a_block_on_a_round_floor_touches_it_in_the_middle() {
    for degree in DEGREES {
        let gap = |[x, _]: [f64; 2]| 0.2 * (x - 0.5) * (x - 0.5);
        let whole = block_under(
            unit_square(8).mesh().unwrap(),
            [0.0, -0.1],
            vec![("bottom", contact(gap))],
        );
        let whole = solved(&whole, degree);
        assert!(whole.quantities.contact_length < 0.9);
        let resultant = whole.quantities.contact_resultant;
        assert_abs_diff_eq!(resultant[..], [0.0, 0.1][..], epsilon = SOLVED);
    }
}

#[test]
fn loads_that_do_not_press_are_refused_with_the_motion() {
    let floor = || vec![("bottom", contact(|_| 0.0))];
    let refused = |force: [f64; 2], parts| {
        let problem = block_under(unit_square(4).mesh().unwrap(), force, parts);
        let error = solve(&problem, &method(Degree::One, EXACT), &Settings::default()).unwrap_err();
        assert!(matches!(error, SolveError::Data(DataError::RigidMotion { .. })), "{error}");
    };
    refused([0.0, 0.1], floor());
    refused([0.0, 0.0], floor());
    refused([0.01, -0.1], floor());
    refused([0.02, -0.1], vec![("bottom", contact(|_| 0.0)), ("left", contact(|_| 0.0))]);
}

#[test]
fn a_block_on_the_verge_of_tipping_is_refused_and_one_short_of_it_is_solved() {
    // The floor reaches under its left half only: the weight acts above the end of the floor when it is uniform.
    let tipping = |slope: f64| {
        let mesh = signorini::fem::Rectangle { nx: 8, ny: 4, ..unit_square(8) }.mesh().unwrap();
        let mut problem = block_under(mesh, [0.0, 0.0], vec![("left", contact(|_| 0.0))]);
        // Pressed against the wall on its left by a horizontal force that grows or falls with the height.
        problem.body_force = [function(move |[_, y]| -1.0 - slope * (y - 0.5)), constant(0.0)];
        solve(&problem, &method(Degree::One, EXACT), &Settings::default())
    };
    // The resultant acts at y = 1/2 + slope / 12: at the upper end of the wall for slope = 6.
    assert!(tipping(5.9).is_ok());
    assert!(tipping(6.0).is_err());
    assert!(tipping(6.1).is_err());
    assert!(tipping(-6.1).is_err());
}
