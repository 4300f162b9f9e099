//! Theorem 3.3: problem (8) has one solution. The proof rests on an inequality between positive parts, on (12) and on
//! the Lipschitz continuity of phi; here these at one point, over every ordered field.

use signorini::kernel::positive_part;

use crate::harness::{any, assume};
use crate::numbers::Whole;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, harnesses};

fn class<S: Ordered>(a: S, b: S) -> &'static str {
    match (a > S::from(0), b > S::from(0)) {
        (true, true) => "both positive",
        (false, false) => "none positive",
        _ => "one positive",
    }
}

/// (\[a\]+ - \[b\]+)(a - b) >= (\[a\]+ - \[b\]+)^2 for a candidate of the positive part.
pub fn monotone<S: Ordered>(a: S, b: S, part: impl Fn(S) -> S) -> Verdict {
    let (d, e) = (part(a) - part(b), a - b);
    ensure!(d * e >= d * d);
    ensure!(d * d >= S::from(0));
    Verdict::Holds(class(a, b))
}

/// The inequality of the proof of Theorem 3.3.
pub fn positive_parts_are_monotone<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    monotone(a, b, positive_part)
}

/// The displayed steps of that inequality, one by one.
pub fn monotonicity_holds_step_by_step<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (p, q) = (positive_part(a), positive_part(b));
    let expanded = a * p + b * q - b * p - a * q;
    let squares = p * p + q * q - S::from(2) * p * q;
    ensure!((p - q) * (a - b) == expanded);
    ensure!(expanded >= squares);
    ensure!(squares == (p - q) * (p - q));
    Verdict::Holds(class(a, b))
}

/// |\[a\]+ - \[b\]+| <= |a - b|, as two inequalities on each side.
pub fn positive_part_is_lipschitz<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (d, e) = (positive_part(a) - positive_part(b), a - b);
    if e >= S::from(0) {
        ensure!(d <= e && -d <= e);
    } else {
        ensure!(d <= -e && -d <= -e);
    }
    Verdict::Holds(class(a, b))
}

/// The structure of both: \[a\]+ - \[b\]+ has the sign of a - b and is no larger. In doubles too, for rounding is monotone.
pub fn difference_of_positive_parts_lies_between_zero_and_the_difference<S: Ordered>(
    [a, b]: [S; 2],
) -> Verdict {
    let (d, e) = (positive_part(a) - positive_part(b), a - b);
    ensure!((d >= S::from(0) && d <= e) || (d <= S::from(0) && d >= e));
    Verdict::Holds(class(a, b))
}

/// The integrand behind the hemicontinuity of B^h: with P(v - t w) = p - t q,
/// |\[p - t q\]+ - \[p - s q\]+| |q| <= |s - t| q^2.
pub fn phi_is_lipschitz_at_a_point<S: Ordered>([p, q, s, t]: [S; 4]) -> Verdict {
    let (a, b) = (p - t * q, p - s * q);
    let step = (positive_part(a) - positive_part(b)) * q;
    let bound = (s - t) * q * q;
    if s >= t {
        ensure!(step <= bound && -step <= bound);
    } else {
        ensure!(step <= -bound && -step <= -bound);
    }
    Verdict::Holds(class(a, b))
}

/// \[.\]+^2 / 2, the density of J_h, lies above its tangents and below the parabola that touches it.
pub fn square_of_the_positive_part_is_convex_and_smooth<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (p, q, e) = (positive_part(a), positive_part(b), b - a);
    let tangent = p * p + S::from(2) * p * e;
    ensure!(q * q >= tangent);
    ensure!(q * q <= tangent + e * e);
    Verdict::Holds(class(a, b))
}

/// |.| for \[.\]+.
pub fn control_absolute_value_is_monotone<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    monotone(a, b, |a| a.split(|a| -a, |a| a))
}

/// Twice \[.\]+: monotone, but not with the square on the right.
pub fn control_twice_the_positive_part<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    monotone(a, b, |a| S::from(2) * positive_part(a))
}

/// The inequality the other way round.
pub fn control_monotonicity_turned<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (d, e) = (positive_part(a) - positive_part(b), a - b);
    ensure!(d * e <= d * d);
    Verdict::Holds(class(a, b))
}

/// Half of the constant in the upper parabola.
pub fn control_half_the_curvature<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (p, q, e) = (positive_part(a), positive_part(b), b - a);
    ensure!(q * q <= p * p + S::from(2) * p * e + e * e / S::from(2));
    Verdict::Holds(class(a, b))
}

harnesses! {
    /// a <= b implies \[a\]+ <= \[b\]+.
    holds positive_part_is_monotone_for_all_finite_doubles() {
        let (a, b): (f64, f64) = (any(), any());
        assume(a.is_finite() && b.is_finite() && a <= b);
        assert!(positive_part(a) <= positive_part(b));
    }
    /// The false twin: strictly.
    fails control_positive_part_is_strictly_monotone_for_all_finite_doubles() {
        let (a, b): (f64, f64) = (any(), any());
        assume(a.is_finite() && b.is_finite() && a < b);
        assert!(positive_part(a) < positive_part(b));
    }
    /// Lipschitz with ordered inputs: two subtractions compared.
    holds positive_part_is_lipschitz_for_all_ordered_finite_doubles() {
        let (a, b): (f64, f64) = (any(), any());
        assume(a.is_finite() && b.is_finite() && a <= b);
        assert!(positive_part(b) - positive_part(a) <= b - a);
    }
    /// The false twin: equality.
    fails control_positive_part_keeps_distances_for_all_ordered_finite_doubles() {
        let (a, b): (f64, f64) = (any(), any());
        assume(a.is_finite() && b.is_finite() && a <= b);
        assert!(positive_part(b) - positive_part(a) == b - a);
    }
    /// The sign form: with d = \[a\]+ - \[b\]+ and e = a - b it gives d e >= d^2 and |d| <= |e|; that rounding is monotone is
    /// the one step left outside.
    holds inequality_of_theorem_3_3_in_sign_form_for_all_i16() {
        let (a, b): (i16, i16) = (any(), any());
        let v = [i32::from(a), i32::from(b)].map(Whole);
        assert!(!difference_of_positive_parts_lies_between_zero_and_the_difference(v).fails());
    }
    /// The false twin: with |.|.
    fails control_sign_form_with_absolute_values_for_all_i16() {
        let (a, b): (i16, i16) = (any(), any());
        let (a, b) = (i32::from(a), i32::from(b));
        let (d, e) = (a.abs() - b.abs(), a - b);
        assert!((d >= 0 && d <= e) || (d <= 0 && d >= e));
    }
    /// The same in doubles.
    holds inequality_of_theorem_3_3_in_sign_form_for_all_finite_doubles() {
        let (a, b): (f64, f64) = (any(), any());
        assume(a.is_finite() && b.is_finite());
        let (d, e) = (positive_part(a) - positive_part(b), a - b);
        assert!((d >= 0.0 && d <= e) || (d <= 0.0 && d >= e));
    }
    /// The false twin: d is no smaller than e where it is positive.
    fails control_sign_form_turned_for_all_finite_doubles() {
        let (a, b): (f64, f64) = (any(), any());
        assume(a.is_finite() && b.is_finite());
        let (d, e) = (positive_part(a) - positive_part(b), a - b);
        assert!(d >= e || d <= 0.0);
    }
    /// The inequality as written, where its products are exact.
    holds inequality_of_theorem_3_3_for_all_i8() {
        let (a, b): (i8, i8) = (any(), any());
        let v = [i32::from(a), i32::from(b)].map(Whole);
        assert!(!positive_parts_are_monotone(v).fails());
    }
    /// The false twin: turned.
    fails control_inequality_of_theorem_3_3_turned_for_all_i8() {
        let (a, b): (i8, i8) = (any(), any());
        let v = [i32::from(a), i32::from(b)].map(Whole);
        assert!(!control_monotonicity_turned(v).fails());
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::{Claim, in_doubles, model_checked, proved, refuted, tested};
    use crate::statement;

    /// The row of Theorem 3.3.
    pub fn claim() -> Claim {
        let monotone = statement!(
            positive_parts_are_monotone,
            [a, b],
            ["both positive", "none positive", "one positive"]
        );
        let steps = statement!(
            monotonicity_holds_step_by_step,
            [a, b],
            ["both positive", "none positive", "one positive"]
        );
        let lipschitz = statement!(
            positive_part_is_lipschitz,
            [a, b],
            ["both positive", "none positive", "one positive"]
        );
        let between = statement!(
            difference_of_positive_parts_lies_between_zero_and_the_difference,
            [a, b],
            ["both positive", "none positive", "one positive"]
        );
        let phi = statement!(
            phi_is_lipschitz_at_a_point,
            [p, q, s, t],
            ["both positive", "none positive", "one positive"]
        );
        let convex = statement!(
            square_of_the_positive_part_is_convex_and_smooth,
            [a, b],
            ["both positive", "none positive", "one positive"]
        );
        let all = [monotone, steps, lipschitz, between, phi, convex];
        let mut checks: Vec<_> = all.into_iter().map(proved).collect();
        checks.extend(all.into_iter().map(tested));
        checks.extend([
            in_doubles(lipschitz),
            in_doubles(between),
            refuted(statement!(control_absolute_value_is_monotone, [a, b], [])),
            refuted(statement!(control_twice_the_positive_part, [a, b], [])),
            refuted(statement!(control_monotonicity_turned, [a, b], [])),
            refuted(statement!(control_half_the_curvature, [a, b], [])),
        ]);
        checks.extend(HARNESSES.iter().copied().map(model_checked));
        Claim {
            id: "10",
            items: &["Theorem 3.3", "(12)"],
            title: "One solution",
            paper: "Suppose that gamma0 is sufficiently small. Then the problem (8) admits one unique solution u^h in V^h. In the proof: ([a]+ - [b]+)(a - b) >= ([a]+ - [b]+)^2 >= 0 and |[a]+ - [b]+| <= |a - b|, for all a, b; (12); phi is Lipschitz.",
            statement: "Both inequalities as printed, and the steps of the first one by one; the integrand of phi is Lipschitz with the paper's constant; [.]+^2 lies between its tangent and the parabola above it, so J_h is convex and C^1.",
            numbers: "every ordered field (proof); rationals; the Lipschitz bound and the sign form in all finite doubles.",
            kernel: &["positive_part::positive_part"],
            preconditions: "None at a point.",
            limits: "That a monotone, hemicontinuous, coercive operator is one-to-one (the corollary of Brezis that the paper cites) is not checked.",
            single: None,
            checks,
        }
    }
}
