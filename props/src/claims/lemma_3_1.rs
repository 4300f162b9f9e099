//! From Green's formula to (6), and Lemma 3.1: the exact solution satisfies the discrete equations.
//!
//! On a body with any affine field u the equations (1) hold with f = 0 and the tractions sigma(u) n. With a gap and a
//! stress such that (2) holds on Gamma_C, u is an exact solution, and it lies in V^h: then (8) must hold at u for every
//! v^h that is zero on Gamma_D, without any error. These are the patch tests, in a general form: full contact, an open
//! gap, and touching without force. Solutions outside of V^h are in `curved` and `consistent`.

use signorini::kernel::{ContactPoint, positive_part};

use super::prop_2_1::{conditions_2, touching};
use crate::harness::{assume, within_3, within_7};
use crate::numbers::Whole;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given, harnesses};

fn class<S: Ordered>(sigma: S, u: S, g: S) -> &'static str {
    if sigma < S::from(0) {
        "contact"
    } else if u < g {
        "gap"
    } else {
        "touching without force"
    }
}

/// The steps before (6), at a point: -sigma_n(u) v_n becomes -gamma sigma_n(u) sigma_n(v) + (1/gamma)\[P(u)\]+ P0(v).
fn rearranged<S: Ordered>([u, g, s, gamma, v, t]: [S; 6], theta: S) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero);
    given!(u <= g && s <= zero && s * (u - g) == zero);
    let here = ContactPoint { u_n: u, gap: g, sigma_n: s, gamma };
    let p0 = v - theta * gamma * t;
    ensure!(here.pressure() == s);
    ensure!(-(s * v) == -(gamma * s * t) - s * (v - gamma * t));
    ensure!(-(s * v) == -(gamma * s * t) - here.pressure() * p0);
    Verdict::Holds(class(s, u, g))
}

/// (6) as an identity of integrands.
pub fn green_terms_rearrange_to_6<S: Ordered>(v: [S; 6]) -> Verdict {
    rearranged(v, S::from(1))
}

/// (6) with theta = -1 in the test function.
pub fn control_theta_minus_one_in_6<S: Ordered>(v: [S; 6]) -> Verdict {
    rearranged(v, S::from(-1))
}

/// A point that the obstacle touches, and a test function there.
fn touched() -> [ContactPoint<Whole>; 2] {
    let point = touching(within_3);
    let test = ContactPoint { u_n: within_7(), gap: Whole(0), sigma_n: within_7(), ..point };
    [point, test]
}

/// Whether the contact terms of (8) are -int sigma_n(u) v_n (times gamma): \[P(u)\]+ P(v) - gamma^2 s t = -gamma s v.
fn are_consistent([point, test]: &[ContactPoint<Whole>; 2]) -> bool {
    let s = point.gamma * point.sigma_n;
    positive_part(point.p()) * test.p0() - s * point.gamma * test.sigma_n == -(s * test.u_n)
}

harnesses! {
    /// The contact terms of (8) at an exact solution.
    holds contact_terms_are_consistent_where_2_holds_within_7() {
        let points = touched();
        assume(conditions_2(&points[0]));
        assert!(are_consistent(&points));
    }
    /// The false twin: whatever the point.
    fails control_contact_terms_are_consistent_everywhere_within_7([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]) {
        assert!(are_consistent(&touched()));
    }
}

#[cfg(not(kani))]
pub use row::{consistency, green, inequality_3_at_affine_solutions};

#[cfg(not(kani))]
mod row {
    use proptest::prelude::*;

    use super::*;
    use crate::bodies::{Body, Definition, Draw, Rule, Side, bodies, rotated, sum, whole};
    use crate::claim::{Claim, Outcome, model_checked};
    use crate::claims::consistent::{self, OF_8, Terms, rejected};
    use crate::claims::curved;
    use crate::draws;
    use crate::naive::Tensor;
    use crate::numbers::Exact;

    /// The plain data of an affine exact solution: stresses, rotation, displacement, distance to the obstacle.
    type Patch = ([(i64, i64); 5], [(i64, i64); 2], usize);

    fn patches() -> impl Strategy<Value = Patch> {
        let ratio = draws::ratio;
        (
            [ratio(), ratio(), ratio(), ratio(), ratio()],
            [draws::positive(), draws::positive()],
            0_usize..3,
        )
    }

    /// An affine field with its stress in the frame of the unturned body, and the gap for which it is a solution.
    struct Solution {
        stress: Tensor<Exact>,
        field: Vec<[Exact; 2]>,
    }

    /// The symmetric tensor turned by the angle with this cosine and sine.
    fn along([c, s]: [Exact; 2], [xx, yy, xy]: [Exact; 3]) -> [Exact; 3] {
        let twice = Exact::from(2) * c * s * xy;
        [
            c * c * xx + s * s * yy - twice,
            s * s * xx + c * c * yy + twice,
            c * s * (xx - yy) + (c * c - s * s) * xy,
        ]
    }

    /// Sets the gaps of a body so that an affine field is an exact solution. `kind`: 0 contact, 1 gap, 2 touching.
    fn affine_solution(body: &mut Body, (values, distances, kind): &Patch) -> Solution {
        let [sxx, syy, w, dx, dy] = values.map(Exact::from);
        let zero = Exact::from(0);
        let left_too = body.contact.iter().any(|side| rotated_back(side.n, body.turn)[0] < zero);
        let pressed = |s: Exact| if *kind == 0 { -s.abs() } else { zero };
        let stress = [if left_too { pressed(sxx) } else { sxx }, pressed(syy), zero];
        let turn = body.turn;
        // A tensor is that of the turned body.
        let [c, s] = turn;
        let [exx, eyy, exy] = along([c, -s], body.hooke.strain(along(turn, stress)));
        let at = move |x: [Exact; 2]| {
            let [x, y] = rotated_back(x, turn);
            rotated([exx * x + (exy - w) * y + dx, (exy + w) * x + eyy * y + dy], turn)
        };
        let field = body.interpolated(at);
        let open = distances.map(Exact::from);
        let gap = |side: &Side| {
            let [start, end] =
                body.ends(side.triangle, side.local).map(|v| along_n(side, field[v]));
            let away = if *kind == 1 { open } else { [zero; 2] };
            let (start, end) = (start + away[0], end + away[1]);
            [start, end, (start + end) / Exact::from(2)]
        };
        let gaps: Vec<_> = body.contact.iter().map(gap).collect();
        body.contact.iter_mut().zip(gaps).for_each(|(side, gap)| side.gap = gap);
        Solution { stress, field }
    }

    /// v_n
    fn along_n(side: &Side, [x, y]: [Exact; 2]) -> Exact {
        x * side.n[0] + y * side.n[1]
    }

    fn rotated_back(x: [Exact; 2], [c, s]: [Exact; 2]) -> [Exact; 2] {
        rotated(x, [c, -s])
    }

    /// L(v) = int over Gamma_N of (sigma n) . v: exact for v of degree 2 by Simpson's rule. All of the boundary that is
    /// neither contact nor top; the scaled normal is |E| n.
    fn load<const N: usize>(body: &Body, stress: Tensor<Exact>, v: &[[Exact; 2]]) -> Exact {
        sum(&body.free, |&(t, i)| {
            let field = body.field::<N>(t, v);
            let [start, end] = body.ends(t, i).map(|v| body.unturned[v]);
            let (nx, ny) = (end[1] - start[1], start[0] - end[0]);
            let traction = [stress[0] * nx + stress[2] * ny, stress[2] * nx + stress[1] * ny];
            let force = rotated(traction, body.turn);
            whole(&field.normal_trace(i, force))
        })
    }

    /// (3) at an exact affine solution: a(u, w) >= L(w) for the shape functions w of P1, and their opposites, that do not
    /// lead into the obstacle. `outwards` takes those that do.
    fn inequality_3(draw: &Draw, patch: &Patch, outwards: bool) -> Verdict {
        let mut body = draw.body();
        let Solution { stress, field: u } = affine_solution(&mut body, patch);
        let definition = Definition::<3>(&body);
        let zero = Exact::from(0);
        let mut strict = false;
        for v in body.basis::<3>() {
            for w in [v.clone(), v.into_iter().map(|v| v.map(|c| -c)).collect()] {
                let leads_in = body.contact.iter().any(|side| {
                    let mut ends = body.ends(side.triangle, side.local).into_iter();
                    ends.any(|v| along_n(side, w[v]) > zero)
                });
                if leads_in == outwards {
                    let rest = definition.a(&u, &w) - load::<3>(&body, stress, &w);
                    ensure!(rest >= zero);
                    strict |= rest > zero;
                }
            }
        }
        Verdict::Holds(if strict { "strict" } else { "equal" })
    }

    /// (3) on random bodies.
    pub fn inequality_3_at_affine_solutions() -> Outcome {
        let found = draws::hold(60, (bodies(1), patches()), &["strict"], |(draw, patch)| {
            inequality_3(draw, patch, false)
        })?;
        let rejected =
            draws::reject((bodies(1), patches()), |(draw, patch)| inequality_3(draw, patch, true))?;
        Ok(format!("{found}; into the obstacle: {rejected}"))
    }

    /// Green's formula and (8) at an exact affine solution, for every v that is zero at the top.
    fn consistent<const N: usize>(draw: &Draw, patch: &Patch, spoil: bool) -> Verdict {
        let mut body = draw.body();
        let Solution { stress, field: u } = affine_solution(&mut body, patch);
        if spoil {
            for side in &mut body.contact {
                side.gap = side.gap.map(|g| g - Exact::ratio(1, 3));
            }
        }
        let definition = Definition::<N>(&body);
        // The weights of a rule that is exact for the affine integrand here, so that P2 can take part.
        let half = Exact::ratio(1, 2);
        let gauss = [
            [Exact::from(0), Exact::ratio(1, 6)],
            [half, Exact::ratio(2, 3)],
            [Exact::from(1), Exact::ratio(1, 6)],
        ];
        let rule = if N == 3 { Rule::Exact } else { Rule::Points(&gauss) };
        for v in body.basis::<N>() {
            let work = load::<N>(&body, stress, &v);
            // Green's formula with (1), before (6).
            let green = sum(&body.contact, |side| {
                let (here, test) = (definition.traces(side, &u), definition.traces(side, &v));
                side.length * whole(&here.sigma_n.by(&test.v_n))
            });
            ensure!(definition.a(&u, &v) - green == work);
            ensure!(definition.b(rule, &u, &v) == work);
        }
        Verdict::Holds(CLASSES[patch.2])
    }

    const CLASSES: [&str; 3] = ["contact", "gap", "touching without force"];

    fn patch_test<const N: usize>(cases: u32) -> Outcome {
        draws::hold(cases, (bodies(1), patches()), &CLASSES, |(draw, patch)| {
            consistent::<N>(draw, patch, false)
        })
    }

    /// An obstacle that is nearer than the solution allows.
    fn wrong_gap() -> Outcome {
        draws::reject((bodies(1), patches()), |(draw, patch)| consistent::<3>(draw, patch, true))
    }

    /// The row of (6).
    pub fn green() -> Claim {
        Claim {
            id: "4",
            title: "From Green's formula to Nitsche's",
            paper: "",
            limits: "",
            checks: [
                statements! {
                    proved + tested green_terms_rearrange_to_6[u_n, g, sigma_n, gamma, v_n, tau_n]
                        : "contact", "gap", "touching without force" about "(6)", "Remark 2.3";
                    refuted control_theta_minus_one_in_6[u_n, g, sigma_n, gamma, v_n, tau_n]
                        fails "-(s * v) == -(gamma * s * t) - here.pressure() * p0";
                },
                vec![
                    exact!("green_and_6_hold_at_affine_solutions_for_p1", in consistent, draws 90 => patch_test::<3>(90)).about(&[
                        "(1)",
                        "(6)",
                        "Lemma 3.1",
                    ]),
                    exact!("control_obstacle_too_near", in wrong_gap => wrong_gap()),
                ],
            ]
            .concat(),
        }
    }

    /// The row of Lemma 3.1.
    pub fn consistency() -> Claim {
        Claim {
            id: "8",
            title: "Consistency",
            paper: "",
            limits: "A gap that is not affine; an enclosure of the residuals at solutions that are no polynomials: sums of doubles by quadrature, at most 1e-4 of the largest sum of the terms' sizes.",
            checks: [vec![
                exact!("residual_vanishes_at_affine_solutions_for_p2", in consistent, draws 30 => patch_test::<6>(30)).about(&["Lemma 3.1"]),
                exact!("residual_vanishes_at_a_curved_solution_for_p1", in curved::consistent, draws 8 => curved::residual_vanishes::<3>(8)).about(&["Lemma 3.1"]),
                exact!("residual_vanishes_at_a_curved_solution_for_p2", in curved::consistent, draws 3 => curved::residual_vanishes::<6>(3)).about(&["Lemma 3.1"]),
                doubles!("residual_vanishes_at_solutions_that_are_no_polynomials", in consistent::vanishes, draws 24 => consistent::residual_vanishes()).about(&["Lemma 3.1"]),
                exact!("control_contact_term_left_out", in curved::without_the_contact_term => curved::without_the_contact_term::<3>()),
                exact!("control_contact_term_left_out_for_p2", in curved::without_the_contact_term => curved::without_the_contact_term::<6>()),
                doubles!("control_the_contact_term_or_the_product_of_stresses_left_out", at consistent::vanishes => rejected(&[Terms { contact: 0.0, ..OF_8 }, Terms { stresses: 0.0, ..OF_8 }])),
                doubles!("control_theta_minus_one_in_one_place", at consistent::vanishes => rejected(&[Terms { theta: -1.0, ..OF_8 }])),
                doubles!("control_gamma_doubled_in_one_place", at consistent::vanishes => rejected(&[Terms { contact: 0.5, ..OF_8 }])),
                doubles!("control_wrong_sign_of_sigma_n_in_p", at consistent::vanishes => rejected(&[Terms { sigma_n: -1.0, ..OF_8 }])),
                doubles!("control_an_obstacle_that_is_nearer_by_a_hundredth", at consistent::vanishes => rejected(&[Terms { gap: -0.01, ..OF_8 }])),
                doubles!("control_the_load_of_the_wrong_sign_or_a_hundredth_larger", at consistent::vanishes => rejected(&[Terms { load: -1.0, ..OF_8 }, Terms { load: 1.01, ..OF_8 }])),
                doubles!("control_tension_for_pressure", in consistent::tension_on_the_contact_line => consistent::tension_on_the_contact_line()),
            ], model_checked(HARNESSES, &["Lemma 3.1"])].concat(),
        }
    }
}
