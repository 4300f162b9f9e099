//! (4): a <= \[a\]+ and a \[a\]+ = \[a\]+^2, and what else the paper uses of the positive part.

use signorini::kernel::{positive_part, positive_part_slope};

use crate::harness::{any, assume, byte, finite, number};
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given, harnesses};

fn class<S: Ordered>(a: S) -> &'static str {
    if a > S::from(0) {
        "positive"
    } else if a < S::from(0) {
        "negative"
    } else {
        "zero"
    }
}

/// (4) and its companions for a candidate of the positive part.
pub fn facts_4<S: Ordered>(a: S, part: impl Fn(S) -> S) -> Verdict {
    let (zero, p) = (S::from(0), part(a));
    ensure!(a <= p);
    ensure!(a * p == p * p);
    ensure!(p >= zero);
    ensure!(part(p) == p);
    ensure!(p - part(-a) == a);
    ensure!(p == zero || p == a);
    Verdict::Holds(class(a))
}

/// (4) for the kernel's \[.\]+.
pub fn positive_part_satisfies_4<S: Ordered>([a]: [S; 1]) -> Verdict {
    facts_4(a, positive_part)
}

/// \[a\]+ is the point of \[0, oo) nearest to a: by the variational inequality and by the distance.
pub fn positive_part_is_the_projection_on_the_half_line<S: Ordered>([a, m]: [S; 2]) -> Verdict {
    given!(m >= S::from(0));
    let p = positive_part(a);
    ensure!((m - p) * (a - p) <= S::from(0));
    ensure!((a - p) * (a - p) <= (a - m) * (a - m));
    Verdict::Holds(class(a))
}

/// Nothing else is: q >= 0, q >= a and q (q - a) = 0 leave only q = \[a\]+.
pub fn complementarity_leaves_only_the_positive_part<S: Ordered>([a, q]: [S; 2]) -> Verdict {
    given!(q >= S::from(0) && q >= a && q * (q - a) == S::from(0));
    ensure!(q == positive_part(a));
    Verdict::Holds(class(a))
}

/// The slope is 0 or 1, \[a\]+ = slope(a) a, and it is the derivative: exact between two numbers of the same sign.
pub fn slope_is_the_derivative_of_the_positive_part<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (zero, one, slope) = (S::from(0), S::from(1), positive_part_slope(a));
    ensure!(slope == one || (slope == zero && a <= zero));
    ensure!(positive_part(a) == slope * a);
    given!((a > zero && b > zero) || (a <= zero && b <= zero));
    ensure!(positive_part(b) - positive_part(a) == slope * (b - a));
    Verdict::Holds(class(a))
}

/// |a| in place of \[a\]+.
pub fn control_absolute_value_for_the_positive_part<S: Ordered>([a]: [S; 1]) -> Verdict {
    facts_4(a, |a| a.split(|a| -a, |a| a))
}

/// a itself in place of \[a\]+.
pub fn control_no_cut_at_zero<S: Ordered>([a]: [S; 1]) -> Verdict {
    facts_4(a, |a| a)
}

/// \[a\]+ by `>= 0` sign turned: min(a, 0).
pub fn control_negative_part_for_the_positive_part<S: Ordered>([a]: [S; 1]) -> Verdict {
    facts_4(a, |a| a.split(|a| a, |_| S::from(0)))
}

harnesses! {
    /// a <= \[a\]+, \[a\]+ >= 0, idempotent.
    holds positive_part_is_an_upper_bound_for_all_finite_doubles() {
        let a = finite();
        let p = positive_part(a);
        assert!(a <= p && p >= 0.0 && positive_part(p) == p);
    }
    /// The false twin: \[a\]+ > 0.
    fails control_positive_part_is_positive_for_all_finite_doubles([0.0]) {
        let a = finite();
        assert!(positive_part(a) > 0.0);
    }
    /// The structure behind a \[a\]+ = \[a\]+^2: either factor is 0, or the two are the same double, bit for bit.
    holds positive_part_is_zero_or_the_number_itself_for_all_doubles_but_nan() {
        let a = number();
        let p = positive_part(a);
        assert!(p.to_bits() == 0 || p.to_bits() == a.to_bits());
    }
    /// The false twin: always the number itself.
    fails control_positive_part_is_the_number_itself_for_all_doubles_but_nan([-1.0]) {
        let a = number();
        assert!(positive_part(a).to_bits() == a.to_bits());
    }
    /// What is not positive gives +0, -0 too.
    holds positive_part_is_never_minus_zero_for_all_doubles_but_nan() {
        let a = number();
        assert!(positive_part(a).is_sign_positive());
    }
    /// The false twin: by a test for negative.
    fails control_a_test_for_negative_gives_no_minus_zero_for_all_doubles_but_nan([-0.0]) {
        let a = number();
        let part = if a < 0.0 { 0.0 } else { a };
        assert!(part.is_sign_positive());
    }
    /// A NaN must not become "no contact".
    holds nan_stays_nan_for_all_nan() {
        let a: f64 = any();
        assume(a.is_nan());
        assert!(positive_part(a).is_nan() && positive_part_slope(a) == 1.0);
    }
    /// The false twin: `if a > 0 { a } else { 0 }` loses it.
    fails control_nan_stays_nan_by_a_test_for_positive([f64::NAN]) {
        let a: f64 = any();
        assume(a.is_nan());
        let lost = if a > 0.0 { a } else { 0.0 };
        assert!(lost.is_nan());
    }
    /// The slope that Newton uses: 1 exactly where a > 0.
    holds slope_is_one_exactly_where_positive_for_all_doubles_but_nan() {
        let a = number();
        assert!(positive_part_slope(a) == if a > 0.0 { 1.0 } else { 0.0 });
    }
    /// The false twin: 1 at zero too.
    fails control_slope_is_one_for_all_nonnegative_doubles([0.0]) {
        let a = number();
        assert!(positive_part_slope(a) == if a >= 0.0 { 1.0 } else { 0.0 });
    }
    /// a \[a\]+ = \[a\]+^2 as printed.
    holds number_times_positive_part_is_its_square_for_all_i8() {
        let a = byte();
        assert!(a * positive_part(a) == positive_part(a) * positive_part(a));
    }
    /// The false twin: a^2.
    fails control_number_times_positive_part_is_the_square_of_the_number_for_all_i8([-1.0]) {
        let a = byte();
        assert!(a * positive_part(a) == a * a);
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::{Claim, model_checked};

    /// The row of (4).
    pub fn claim() -> Claim {
        Claim {
            id: "1",
            title: "The positive part",
            paper: "",
            limits: "The slope at 0, which is a choice (0).",
            checks: [
                statements! {
                    proved + tested + in_doubles positive_part_satisfies_4[a]: "positive", "negative", "zero"
                        about "(4)";
                    proved + tested positive_part_is_the_projection_on_the_half_line[a, m]
                        : "positive", "negative", "zero";
                    proved + tested complementarity_leaves_only_the_positive_part[a, q]
                        : "positive", "negative", "zero";
                    proved + tested slope_is_the_derivative_of_the_positive_part[a, b]: "positive", "negative", "zero";
                    refuted + refuted_in_doubles control_absolute_value_for_the_positive_part[a]
                        fails "a * p == p * p";
                    refuted control_no_cut_at_zero[a] fails "p - part(-a) == a";
                    refuted control_negative_part_for_the_positive_part[a] fails "p >= zero";
                },
                model_checked(HARNESSES, &["(4)"]),
            ]
            .concat(),
        }
    }
}
