//! The bound of the distance from the true solution, and the checker of its certificates (docs/theory.md, 7.2 and 7.3).
//!
//! At a point, with e, t, s for the strains of v, of C^-1 tau and of u, the theorem is |e - t|^2 = |e - s|^2 + |s - t|^2 + 2 (e -
//! s) : C (s - t), and what contact adds to the integral of the last product is not negative.
//!
//! The checker is given certificates that are made by hand (`by_hand`), which it must evaluate as the definitions say, and wrong
//! ones (`refusals`), which it must refuse; and certificates of solutions (`solved`), which are compared with the same checker
//! over rationals, and with the true errors of solutions that are known.

use signorini::kernel::{Ball, Material, Plane, PreciseBall};
use signorini::nalgebra::Matrix2;
use signorini::solve::Degree;

use self::by_hand::{CLASSES, balanced, draws_of, duality_gap, evaluated, evaluated_with_supports};
use self::refusals::{refusals, refusals_of_supports};
use self::solved::{
    above_the_rationals, above_the_true_error, between_the_vertices, costs, energies_agree,
    known_to_rounding, patches, raised_by_a_perturbation, scaled,
};
use super::known::{self, samples};
use super::{attained, checker};
use crate::claim::{Claim, Outcome, model_checked, noticed};
use crate::verdict::{Ordered, Verdict};
use crate::{draws, ensure, given};

mod by_hand;
pub(super) mod forces;
mod refusals;
pub(super) mod solved;

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

/// The row.
pub fn claim() -> Claim {
    Claim {
        id: "24",
        title: "The bound of the distance from the true solution, and its checker",
        paper: "Nothing: the estimates of the paper have unknown constants.",
        statement: "|u - v|_a^2 + |sigma(u) - tau|^2 <= |C eps(v) - tau|^2 + 2 int tau_n (v_n - g), in the norm of C^-1, for v that is admissible and tau in equilibrium with the loads, without shear and tension on Gamma_C (docs/theory.md, 7.2): at a point the squares split, and what contact adds to the integral of their product is not negative. The checker of certificates, on certificates of random v, affine or quadratic on the triangles, and affine tau that are made by hand of dyadic numbers: the square of its bound, |v|_a and J(v) are the integrals of their definitions, never below, to 1e-10; with data that oscillate, each triangle's share has its term; the square of the bound less 2 J(v) is the same for every v, where loads are affine on each triangle, too; tractions that are out of balance by what the checker may add are balanced again; where the direction of contact turns, the same for certificates of the solver's, and what a larger gap adds is its work. It refuses what the theorem does not allow, for its own reason, in 22 ways for a v that is affine and 31 for one that is quadratic, among them a tension, a penetration of 1e-6 or between the ends of an edge or its three nodes, where a test at the nodes sees none, a prescribed value or bulge missed by a rounding error, a body that nothing holds; of bodies that are held along oblique directions alone, with tractions across, the same integrals, and 17 more ways, among them a support that is turned at one end and a value along it that v misses by 1e-12; and the audit refuses a claim that is smaller by one double, another share, and a traction that is off by 1e-9. What it concludes from balls, a sign, an order, an end, and nothing from a NaN, are harnesses of the model checker, on the functions that it calls. The checker over balls of doubles is never below the same source over exact rationals, P1 and P2, with body forces that are constant or affine, and the potential energy encloses it; what balls lose on a triangle is bounded by its shape: forces known to r make stresses known to 48 h^3 r / (2 |T|)^2. The intervals of J(u) on a coarse and on a fine mesh meet, and so do those of the compliance, which is given where loads alone act. What loads and bent displacements cost on a triangle is its definition, with Korn's constant; what displacements lack between the vertices is in the bound, and data outside the exact class, scaled, scale it. A field that is moved raises the bound at least by what moves it. A quadratic displacement that is the solution, with its affine stress, is certified with a bound of rounding errors by P2. On 60 exact solutions with drawn parameters, (a), (b) and (c) of docs/theory.md, 10, P1 and P2, the true error is never above the bound. That 1,000 tampered certificates are rejected: tests/suite/certify.rs.",
        numbers: "every ordered field at a point (proof); balls against rationals, in which a root is rounded to 2^-200; doubles for the true errors.",
        preconditions: "The data are those of the certificate: the checker does not see the problem that it was made for; `signorini audit --case` compares them with it (tests/suite/audit.rs). Green's formula.",
        limits: "Pieces that are cut, and how a certificate is made of a problem (`certify::build`, `sweeps`, `oscillation`), are looked at through their results only: a mistake there makes the bound of another problem, or a larger one. 60 solutions are samples; true errors are by quadrature. Trusted: the checker, balls, IEEE 754.",
        single: None,
        checks: [
            statements! {
                proved the_square_of_the_bound_splits_at_a_point[exx, eyy, exy, txx, tyy, txy, lambda, mu]
                    about "the error bound" hints(|v| vec![v[0] + v[1], v[0] - v[1], v[2]]);
                proved + tested what_contact_adds_is_not_negative[u, s, v, t, g]: "pressed", "not pressed"
                    about "the error bound";
                refuted control_contact_adds_under_tension[u, s, v, t, g]
                    fails "(v - u) * (s - t) + t * (v - g) >= zero";
            },
            vec![
                exact!("the_checker_finds_what_the_definitions_say" => the_definitions_are_found()).about(&["the error bound"]),
                exact!("control_a_bound_a_millionth_too_small" => draws::reject(draws_of(false), |draw| evaluated::<Ball>(draw, 1.0 - 1e-6))),
                exact!("the_checker_finds_what_the_definitions_say_of_supports" => draws::hold(60, draws_of(false), &CLASSES, |draw| evaluated_with_supports(draw, 1.0))),
                exact!("control_what_is_given_beside_supports_does_no_work" => draws::reject(draws_of(false), |draw| evaluated_with_supports(draw, 0.0))),
                doubles!("tractions_out_of_balance_are_balanced_again" => draws::hold(60, draws_of(true), &["always"], |draw| balanced(draw, false))),
                doubles!("control_tractions_that_no_balance_takes" => draws::reject(draws_of(true), |draw| balanced(draw, true))),
                doubles!("the_square_of_the_bound_less_twice_the_energy_depends_on_tau_alone" => draws::hold(60, draws_of(false), &["always"], |draw| duality_gap(draw, false))),
                doubles!("control_the_loads_of_vertices_exchanged" => draws::reject(draws_of(false), |draw| duality_gap(draw, true))),
                doubles!("the_checker_refuses_what_the_theorem_does_not_allow" => refusals(true)).about(&["the error bound"]),
                doubles!("control_certificates_as_they_were_made_are_refused" => noticed(refusals(false))),
                doubles!("the_checker_refuses_supports_that_the_theorem_does_not_allow" => refusals_of_supports(true)),
                doubles!("control_supports_as_they_were_made_are_refused" => noticed(refusals_of_supports(false))),
                exact!("the_checker_in_balls_is_above_the_same_checker_in_rationals" => balls_are_above_the_rationals()).about(&["the error bound"]),
                exact!("control_doubles_in_place_of_balls" => doubles_are_below()),
                doubles!("a_perturbation_raises_the_bound_by_what_it_demands" => perturbations_raise_the_bound()),
                doubles!("control_nine_tenths_of_the_bound_of_a_perturbation" => draws::reject(solved::bodies(3), |draw| raised_by_a_perturbation(draw, 100.0, 0.9))),
                doubles!("potential_energy_and_compliance_lie_in_their_intervals" => draws::hold(40, solved::bodies(2), &["loads only", "a gap", "displacements"], |draw| energies_agree(draw, 1.0))).about(&["the error bound"]),
                doubles!("control_a_quarter_of_the_interval_of_the_energy" => draws::reject(solved::bodies(2), |draw| energies_agree(draw, 0.25))),
                doubles!("data_that_oscillate_cost_what_the_theorem_says" => draws::hold(40, solved::bodies(1), &["always"], |draw| costs(draw, 1.0))),
                doubles!("control_data_that_cost_a_tenth_more" => draws::reject(solved::bodies(1), |draw| costs(draw, 1.1))),
                doubles!("what_displacements_lack_between_the_vertices_is_in_the_bound" => draws::hold(40, solved::bodies(1), &["always"], |draw| between_the_vertices(draw, true))),
                doubles!("control_the_bound_without_what_they_lack" => draws::reject(solved::bodies(1), |draw| between_the_vertices(draw, false))),
                doubles!("the_bound_scales_with_data_outside_the_exact_class" => draws::hold(40, solved::bodies(1), &["always"], |draw| scaled(draw, 1.0))),
                doubles!("control_the_bound_of_twice_the_load_scaled" => draws::reject(solved::bodies(1), |draw| scaled(draw, 2.0))),
                doubles!("a_solution_in_the_space_is_bounded_by_rounding" => draws::hold(40, patches(), &["quadratic"], |patch| known_to_rounding(patch, Degree::Two))),
                doubles!("control_quadratic_solutions_beside_an_affine_v" => draws::reject(patches(), |patch| known_to_rounding(patch, Degree::One))),
                doubles!("the_bound_is_above_the_true_error_of_drawn_solutions" => draws::hold(60, samples(), &known::CLASSES, |sample| above_the_true_error(sample, 1.0))).about(&["the error bound"]),
                doubles!("control_half_the_bound" => draws::reject(samples(), |sample| above_the_true_error(sample, 0.5))),
            ],
            attained::of_certificates().to_vec(),
            model_checked(checker::HARNESSES),
        ]
        .concat(),
    }
}
