//! The bound of the distance from the true solution, and the checker of its certificates (docs/a-posteriori.md, 7.2 and 7.3).
//!
//! At a point, with e, t, s for the strains of v, of C^-1 tau and of u, the theorem is |e - t|^2 = |e - s|^2 + |s - t|^2 + 2 (e -
//! s) : C (s - t), and what contact adds to the integral of the last product is not negative.
//!
//! The checker is given certificates that are made by hand (`by_hand`), which it must evaluate as the definitions say, and wrong
//! ones (`refusals`), which it must refuse; and certificates of solutions (`solved`), which are compared with the same checker
//! over rationals, and with the true errors of solutions that are known.

use signorini::kernel::{Ball, Material, Plane, PreciseBall};
use signorini::model::Degree;
use signorini::nalgebra::Matrix2;

use super::by_hand::{
    CLASSES, balanced, draws_of, duality_gap, evaluated, evaluated_with_supports,
};
use super::refusals::{refusals, refusals_of_supports};
use super::solved::{
    self, above_the_rationals, between_the_vertices, costs, energies_agree, known_to_rounding,
    patches, raised_by_a_perturbation, scaled,
};
use props::claim::{Outcome, noticed};
use props::proof::{prove, refute};
use props::verdict::{Ordered, Verdict};
use props::{draws, ensure, given, statement};

/// The inner product of two strains in C.
fn product<S: Ordered>(material: &Material<S>, a: Matrix2<S>, b: Matrix2<S>) -> S {
    let [xx, yy, xy] = material.stress(a).components();
    xx * b.m11 + yy * b.m22 + xy * (b.m12 + b.m21)
}

/// The square of C e - tau splits, with C s = sigma(u) and C t = tau; given as differences from s.
pub fn the_square_of_the_bound_splits_at_a_point<S: Ordered>(
    [exx, eyy, exy, txx, tyy, txy, lambda, mu]: [S; 8],
) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    // e - s and s - t.
    let (e, t) = (Matrix2::new(exx, exy, exy, eyy), Matrix2::new(txx, txy, txy, tyy));
    let squares = product(&material, e, e) + product(&material, t, t);
    ensure!(product(&material, e + t, e + t) == squares + two * product(&material, e, t));
    ensure!(product(&material, e, e) >= zero);
    Verdict::Holds("always")
}

/// What contact adds: (v_n - u_n)(sigma_n - tau_n) + tau_n (v_n - g) is not negative where u satisfies (2), v_n <= g and
/// tau_n <= 0; and it is sigma_n (v_n - g) where u_n = g.
pub fn what_contact_adds_is_not_negative<S: Ordered>([u, s, v, t, g]: [S; 5]) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && s <= zero && s * (u - g) == zero);
    given!(v <= g && t <= zero);
    let added = (v - u) * (s - t) + t * (v - g);
    ensure!(added == s * (v - g) + t * (u - g));
    ensure!(added >= zero);
    Verdict::Holds(if s < zero { "pressed" } else { "not pressed" })
}

/// Under a tension tau_n.
pub fn control_contact_adds_under_tension<S: Ordered>([u, s, v, t, g]: [S; 5]) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && s <= zero && s * (u - g) == zero && v <= g);
    ensure!((v - u) * (s - t) + t * (v - g) >= zero);
    Verdict::Holds("always")
}

fn the_definitions_are_found() -> Outcome {
    let balls = draws::hold(60, draws_of(false), &CLASSES, |draw| evaluated::<Ball>(draw, 1.0))?;
    let precise =
        draws::hold(40, draws_of(false), &CLASSES, |draw| evaluated::<PreciseBall>(draw, 1.0))?;
    Ok(format!("in balls: {balls}; around double-doubles: {precise}"))
}

fn balls_are_above_the_rationals() -> Outcome {
    let classes = ["contact", "no contact", "an edge is cut"];
    let p1 = draws::hold(20, solved::bodies(2), &classes, |draw| {
        above_the_rationals::<Ball>(draw, Degree::One)
    })?;
    let p2 = draws::hold(10, solved::bodies(2), &classes, |draw| {
        above_the_rationals::<Ball>(draw, Degree::Two)
    })?;
    Ok(format!("P1: {p1}; P2: {p2}"))
}

/// Doubles for balls.
fn doubles_are_below() -> Outcome {
    let below =
        |degree| draws::reject(solved::bodies(2), |d| above_the_rationals::<f64>(d, degree));
    Ok(format!("P1: {}; P2: {}", below(Degree::One)?, below(Degree::Two)?))
}

fn perturbations_raise_the_bound() -> Outcome {
    let of = |size, class| {
        draws::hold(40, solved::bodies(3), &[class], |d| raised_by_a_perturbation(d, size, 1.0))
    };
    Ok(format!("{}; {}", of(1e-3, "near")?, of(1.0, "far")?))
}

checks! {
    the_square_of_the_bound_splits_at_a_point => prove(&statement!(the_square_of_the_bound_splits_at_a_point, [exx, eyy, exy, txx, tyy, txy, lambda, mu], ["always"]).with_hints(|v| vec![v[0] + v[1], v[0] - v[1], v[2]]));
    what_contact_adds_is_not_negative => prove(&statement!(what_contact_adds_is_not_negative, [u, s, v, t, g], ["pressed", "not pressed"]));
    control_contact_adds_under_tension => refute(&statement!(control_contact_adds_under_tension, [u, s, v, t, g], fails "(v - u) * (s - t) + t * (v - g) >= zero"));
    the_checker_finds_what_the_definitions_say => the_definitions_are_found();
    control_a_bound_a_millionth_too_small => draws::reject(draws_of(false), |draw| evaluated::<Ball>(draw, 1.0 - 1e-6));
    the_checker_finds_what_the_definitions_say_of_supports => draws::hold(60, draws_of(false), &CLASSES, |draw| evaluated_with_supports(draw, 1.0));
    control_what_is_given_beside_supports_does_no_work => draws::reject(draws_of(false), |draw| evaluated_with_supports(draw, 0.0));
    tractions_out_of_balance_are_balanced_again => draws::hold(60, draws_of(true), &["always"], |draw| balanced(draw, false));
    control_tractions_that_no_balance_takes => draws::reject(draws_of(true), |draw| balanced(draw, true));
    the_square_of_the_bound_less_twice_the_energy_depends_on_tau_alone => draws::hold(60, draws_of(false), &["always"], |draw| duality_gap(draw, false));
    control_the_loads_of_vertices_exchanged => draws::reject(draws_of(false), |draw| duality_gap(draw, true));
    the_checker_refuses_what_the_theorem_does_not_allow => refusals(true);
    control_certificates_as_they_were_made_are_refused => noticed(refusals(false));
    the_checker_refuses_supports_that_the_theorem_does_not_allow => refusals_of_supports(true);
    control_supports_as_they_were_made_are_refused => noticed(refusals_of_supports(false));
    the_checker_in_balls_is_above_the_same_checker_in_rationals => balls_are_above_the_rationals();
    control_doubles_in_place_of_balls => doubles_are_below();
    a_perturbation_raises_the_bound_by_what_it_demands => perturbations_raise_the_bound();
    control_nine_tenths_of_the_bound_of_a_perturbation => draws::reject(solved::bodies(3), |draw| raised_by_a_perturbation(draw, 100.0, 0.9));
    potential_energy_and_compliance_lie_in_their_intervals => draws::hold(40, solved::bodies(2), &["loads only", "a gap", "displacements"], |draw| energies_agree(draw, 1.0));
    control_a_quarter_of_the_interval_of_the_energy => draws::reject(solved::bodies(2), |draw| energies_agree(draw, 0.25));
    data_that_oscillate_cost_what_the_theorem_says => draws::hold(40, solved::bodies(1), &["always"], |draw| costs(draw, 1.0));
    control_data_that_cost_a_tenth_more => draws::reject(solved::bodies(1), |draw| costs(draw, 1.1));
    what_displacements_lack_between_the_vertices_is_in_the_bound => draws::hold(40, solved::bodies(1), &["always"], |draw| between_the_vertices(draw, true));
    control_the_bound_without_what_they_lack => draws::reject(solved::bodies(1), |draw| between_the_vertices(draw, false));
    the_bound_scales_with_data_outside_the_exact_class => draws::hold(40, solved::bodies(1), &["always"], |draw| scaled(draw, 1.0));
    control_the_bound_of_twice_the_load_scaled => draws::reject(solved::bodies(1), |draw| scaled(draw, 2.0));
    a_solution_in_the_space_is_bounded_by_rounding => draws::hold(40, patches(), &["quadratic"], |patch| known_to_rounding(patch, Degree::Two));
    control_quadratic_solutions_beside_an_affine_v => draws::reject(patches(), |patch| known_to_rounding(patch, Degree::One));
}
