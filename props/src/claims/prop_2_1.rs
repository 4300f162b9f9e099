//! Proposition 2.1 and Remark 2.2: conditions (2)(i)-(iii) are one equation, (5) sigma_n = -(1/gamma) \[u_n - g - gamma
//! sigma_n\]+, for every gamma > 0, constant or not.
//!
//! In doubles (5) as written is false (the division rounds) and even the scaled form, s = gamma sigma_n,
//! s = -\[u - s\]+, gives u <= 0 only up to rounding: u = 3.9e-121, s = -8.3e-25 satisfies it. What survives is stated and
//! checked apart. The predicates write (2) out from the paper and take P, lambda^h and the violation from the kernel.

use signorini::kernel::contact::{self, ContactPoint};
use signorini::kernel::positive_part;

use crate::harness::{assume, byte, finite, within_7};
use crate::numbers::Whole;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given, harnesses};

/// (2)(i)-(iii), with a gap.
pub fn conditions_2<S: Ordered>(point: &ContactPoint<S>) -> bool {
    let zero = S::from(0);
    let opening = point.u_n - point.gap;
    opening <= zero && point.sigma_n <= zero && point.sigma_n * opening == zero
}

fn class<S: Ordered>(point: &ContactPoint<S>, holds: bool) -> &'static str {
    if !holds {
        "neither holds"
    } else if point.sigma_n < S::from(0) {
        "contact"
    } else if point.u_n < point.gap {
        "gap"
    } else {
        "touching without force"
    }
}

/// (2) if and only if (5), for a candidate of the right side of (5).
pub fn equivalence<S: Ordered>(
    point: &ContactPoint<S>,
    right_side: impl Fn(&ContactPoint<S>) -> S,
) -> Verdict {
    let equation_5 = point.sigma_n == right_side(point);
    let conditions_2 = conditions_2(point);
    ensure!(conditions_2 == equation_5);
    Verdict::Holds(class(point, conditions_2))
}

fn point<S>([u_n, gap, sigma_n, gamma]: [S; 4]) -> ContactPoint<S> {
    ContactPoint { u_n, gap, sigma_n, gamma }
}

/// The same for every gamma > 0.
fn with_gamma<S: Ordered>(v: [S; 4], right_side: impl Fn(&ContactPoint<S>) -> S) -> Verdict {
    given!(v[3] > S::from(0));
    equivalence(&point(v), right_side)
}

/// Proposition 2.1 with the kernel's lambda^h for the right side.
pub fn conditions_2_are_equation_5<S: Ordered>(v: [S; 4]) -> Verdict {
    with_gamma(v, ContactPoint::pressure)
}

/// The functions of a contact point, written out: P, P0, lambda^h, and that lambda^h <= 0.
pub fn contact_functions_are_their_definitions<S: Ordered>(v: [S; 4]) -> Verdict {
    let (zero, point) = (S::from(0), point(v));
    let [u, g, sigma, gamma] = v;
    given!(gamma > zero);
    ensure!(point.p() == u - g - gamma * sigma);
    ensure!(point.p0() == u - gamma * sigma);
    let (p, pressure) = (u - g - gamma * sigma, point.pressure());
    ensure!(pressure <= zero);
    ensure!(pressure == contact::pressure(p, gamma));
    ensure!(if p > zero { gamma * pressure == -p } else { pressure == zero });
    Verdict::Holds(if p > zero { "pressed" } else { "open" })
}

/// The violation of (2) is zero exactly where (2) holds, and each part is what its name says.
pub fn violation_is_zero_exactly_where_2_holds<S: Ordered>(v: [S; 4]) -> Verdict {
    let (zero, point) = (S::from(0), point(v));
    let opening = point.u_n - point.gap;
    let violation = point.violation();
    ensure!(violation.penetration == if opening > zero { opening } else { zero });
    ensure!(violation.tension == if point.sigma_n > zero { point.sigma_n } else { zero });
    ensure!(violation.product == point.sigma_n * opening);
    let none =
        violation.penetration == zero && violation.tension == zero && violation.product == zero;
    let conditions_2 = conditions_2(&point);
    ensure!(conditions_2 == none);
    Verdict::Holds(class(&point, conditions_2))
}

/// Remark 2.2: gamma may differ from point to point, for (5) with one positive gamma is (5) with any other.
pub fn equation_5_does_not_depend_on_gamma<S: Ordered>(
    [u, g, sigma, gamma, other]: [S; 5],
) -> Verdict {
    given!(gamma > S::from(0) && other > S::from(0));
    let here = point([u, g, sigma, gamma]);
    let there = ContactPoint { gamma: other, ..here };
    let (equation_5, with_the_other_gamma) = (sigma == here.pressure(), sigma == there.pressure());
    ensure!(equation_5 == with_the_other_gamma);
    Verdict::Holds(class(&here, equation_5))
}

/// gamma of any sign.
pub fn control_gamma_of_any_sign<S: Ordered>(v: [S; 4]) -> Verdict {
    let point = point(v);
    given!(point.gamma < S::from(0) || point.gamma > S::from(0));
    equivalence(&point, ContactPoint::pressure)
}

/// gamma >= 0: a division by zero.
pub fn control_gamma_may_be_zero<S: Ordered>(v: [S; 4]) -> Verdict {
    let point = point(v);
    given!(point.gamma >= S::from(0));
    equivalence(&point, ContactPoint::pressure)
}

/// (5) without the gap.
pub fn control_gap_forgotten<S: Ordered>(v: [S; 4]) -> Verdict {
    with_gamma(v, |point| contact::pressure(point.p0(), point.gamma))
}

/// (5) with the sign of sigma_n turned inside.
pub fn control_sign_inside_5_turned<S: Ordered>(v: [S; 4]) -> Verdict {
    with_gamma(v, |point| {
        contact::pressure(point.u_n - point.gap + point.gamma * point.sigma_n, point.gamma)
    })
}

/// (5) with |.| for \[.\]+.
pub fn control_absolute_value_in_5<S: Ordered>(v: [S; 4]) -> Verdict {
    with_gamma(v, |point| -(point.p().split(|p| -p, |p| p) / point.gamma))
}

/// (5) without 1/gamma.
pub fn control_gamma_omitted<S: Ordered>(v: [S; 4]) -> Verdict {
    with_gamma(v, |point| contact::pressure(point.p(), S::from(1)))
}

/// The scaled form s = -\[u - s\]+ at u, s = gamma sigma_n; the kernel's P with gamma = 1 and no gap rounds once.
fn scaled_5<S: Ordered>(u: S, s: S) -> bool {
    let point = point([u, S::from(0), s, S::from(1)]);
    s == point.pressure()
}

/// Scaled Proposition 2.1, exactly: for numbers that do not round.
pub fn scaled_conditions_are_the_scaled_equation<S: Ordered>([u, s]: [S; 2]) -> Verdict {
    let zero = S::from(0);
    let conditions_2 = u <= zero && s <= zero && (u == zero || s == zero);
    let equation = scaled_5(u, s);
    ensure!(conditions_2 == equation);
    Verdict::Holds(class(&point([u, zero, s, S::from(1)]), equation))
}

/// (2) implies the scaled (5), in doubles too.
pub fn conditions_2_imply_the_scaled_equation<S: Ordered>([u, s]: [S; 2]) -> Verdict {
    let zero = S::from(0);
    given!(u <= zero && s <= zero && (u == zero || s == zero));
    ensure!(scaled_5(u, s));
    Verdict::Holds(class(&point([u, zero, s, S::from(1)]), true))
}

/// What the scaled (5) implies in doubles: no tension; no penetration where there is no force; and a displacement of at
/// most 2^-52 |s| where there is.
pub fn scaled_equation_implies_2_up_to_rounding<S: Ordered>([u, s]: [S; 2]) -> Verdict {
    let (zero, two_26) = (S::from(0), S::from(1 << 26));
    given!(scaled_5(u, s));
    ensure!(s <= zero);
    if s == zero {
        ensure!(u <= zero);
        return Verdict::Holds("gap");
    }
    let bound = -s * (S::from(1) / two_26 / two_26);
    ensure!(u <= bound && -u <= bound);
    Verdict::Holds(if u == zero { "contact" } else { "contact up to rounding" })
}

/// u_n - g = m gamma, so that the division by gamma leaves nothing.
pub(super) fn touching(within: fn() -> Whole) -> ContactPoint<Whole> {
    let [m, gap, sigma_n, gamma] = [within(), within(), within(), within()];
    assume(gamma > Whole(0));
    ContactPoint { u_n: gap + m * gamma, gap, sigma_n, gamma }
}

harnesses! {
    /// s = 0 and u <= 0, or s < 0 and u vanishes beside s.
    holds scaled_equation_is_gap_or_contact_for_all_finite_doubles() {
        let (u, s) = (finite(), finite());
        assume(s == -positive_part(u - s));
        assert!((s == 0.0 && u <= 0.0) || (s < 0.0 && u - s == -s));
    }
    /// The false twin: u <= 0 as over R, which is false in doubles.
    fails control_scaled_equation_implies_no_penetration_for_all_finite_doubles([3.9e-121, -8.3e-25]) {
        let (u, s) = (finite(), finite());
        assume(s == -positive_part(u - s));
        assert!(u <= 0.0);
    }
    /// The converse, without rounding.
    holds conditions_2_imply_the_scaled_equation_for_all_finite_doubles() {
        let (u, s) = (finite(), finite());
        assume(u <= 0.0 && s <= 0.0 && (u == 0.0 || s == 0.0));
        assert!(s == -positive_part(u - s));
    }
    /// The false twin: without (iii).
    fails control_signs_alone_imply_the_scaled_equation_for_all_finite_doubles([-1.0, -1.0]) {
        let (u, s) = (finite(), finite());
        assume(u <= 0.0 && s <= 0.0);
        assert!(s == -positive_part(u - s));
    }
    /// (2) if and only if gamma sigma = -\[P\]+, with the kernel's P, gap and gamma.
    holds conditions_2_are_equation_5_times_gamma_for_all_i8_and_positive_i8_gamma() {
        let point = point([byte(), byte(), byte(), byte()]);
        assume(point.gamma > Whole(0));
        let equation = point.gamma * point.sigma_n == -positive_part(point.p());
        assert!(conditions_2(&point) == equation);
    }
    /// The false twin: P without the gap.
    fails control_conditions_2_are_equation_5_without_gap_for_all_i8([1.0, 1.0, 0.0, 1.0]) {
        let point = point([byte(), byte(), byte(), byte()]);
        assume(point.gamma > Whole(0));
        let equation = point.gamma * point.sigma_n == -positive_part(point.p0());
        assert!(conditions_2(&point) == equation);
    }
    /// Proposition 2.1 as printed, with the division, by the kernel's lambda^h.
    holds conditions_2_are_equation_5_as_printed_within_7() {
        let point = touching(within_7);
        assert!(conditions_2(&point) == (point.sigma_n == point.pressure()));
    }
    /// The false twin: without 1/gamma.
    fails control_conditions_2_are_equation_5_without_the_division_within_7([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0]) {
        let point = touching(within_7);
        assert!(conditions_2(&point) == (point.sigma_n == -positive_part(point.p())));
    }
}

#[cfg(not(kani))]
pub use row::{claim, remark_2_2};

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::{Claim, Outcome, model_checked};
    use crate::draws;

    /// (5) as written, in doubles: contact with a force that does not survive the division.
    fn as_written() -> Outcome {
        draws::reject(draws::doubles(4), |v| {
            given!(v[3] > 1e-3 && v[3] < 1e3 && v[2].abs() > 1e-3 && v[2].abs() < 1e3);
            conditions_2_are_equation_5([v[1], v[1], v[2], v[3]])
        })
    }

    /// The row of Proposition 2.1.
    pub fn claim() -> Claim {
        Claim {
            id: "2",
            title: "Contact as one equation",
            paper: "",
            limits: "",
            checks: [
                statements! {
                    proved + tested conditions_2_are_equation_5[u_n, g, sigma_n, gamma]
                        : "contact", "gap", "touching without force", "neither holds"
                        about "(2)", "Proposition 2.1", "(5)", "Remark 2.2";
                    proved + tested contact_functions_are_their_definitions[u_n, g, sigma_n, gamma]: "pressed", "open"
                        about "(5)", "P_gamma, A_gamma";
                    proved + tested violation_is_zero_exactly_where_2_holds[u_n, g, sigma_n, gamma]
                        : "contact", "gap", "touching without force", "neither holds" about "(2)";
                    proved scaled_conditions_are_the_scaled_equation[u, s]
                        : "contact", "gap", "touching without force", "neither holds";
                    refuted_in_doubles scaled_conditions_are_the_scaled_equation[u, s] fails "conditions_2 == equation";
                    in_doubles conditions_2_imply_the_scaled_equation[u, s]
                        : "contact", "gap", "touching without force" about "(5)";
                    in_doubles scaled_equation_implies_2_up_to_rounding[u, s]
                        : "gap", "contact", "contact up to rounding" about "(5)";
                    refuted control_gap_forgotten[u_n, g, sigma_n, gamma] fails "conditions_2 == equation_5";
                    refuted control_sign_inside_5_turned[u_n, g, sigma_n, gamma] fails "conditions_2 == equation_5";
                    refuted control_absolute_value_in_5[u_n, g, sigma_n, gamma] fails "conditions_2 == equation_5";
                    refuted control_gamma_omitted[u_n, g, sigma_n, gamma] fails "conditions_2 == equation_5";
                },
                vec![
                    doubles!("control_equation_5_as_written_in_doubles", in as_written => as_written()),
                ],
                model_checked(HARNESSES, &["Proposition 2.1", "(5)"]),
            ]
            .concat(),
        }
    }

    /// The row of Remark 2.2.
    pub fn remark_2_2() -> Claim {
        Claim {
            id: "3",
            title: "gamma may be a function",
            paper: "",
            limits: "",
            checks: statements! {
                proved + tested equation_5_does_not_depend_on_gamma[u_n, g, sigma_n, gamma, other]
                    : "contact", "gap", "touching without force", "neither holds" about "Remark 2.2";
                refuted control_gamma_of_any_sign[u_n, g, sigma_n, gamma] fails "conditions_2 == equation_5";
                refuted control_gamma_may_be_zero[u_n, g, sigma_n, gamma] fails "division by zero";
            },
        }
    }
}
