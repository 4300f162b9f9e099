//! What the numbers of the computer keep: balls, in which certificates are checked and solutions enclosed, and double-doubles, for
//! the model checker. A member of a ball is a double x with c - r <= x <= c + r, where both sums may be rounded: rounding keeps
//! the order, so every double in the ball is one.
//!
//! That two sums of doubles are the same, or ordered, is more than a SAT solver can show: where it comes to that, numbers are
//! whole. `props/tests/program/balls.rs` draws doubles and compares them with exact numbers.

use signorini::kernel::ball::larger;
use signorini::kernel::{Ball, DoubleDouble, Enclosing, PreciseBall, positive_part};

use crate::harness::{any, assume, bit, within_3};
use crate::harnesses;

/// A ball and one of its numbers, both of whole numbers: sums of them are exact.
fn whole_member() -> (Ball, f64) {
    let (centre, radius, off): (i8, u8, i8) = (any(), any(), any());
    assume(i32::from(off.unsigned_abs()) <= i32::from(radius));
    let (centre, off) = (f64::from(centre), f64::from(off));
    (Ball::around(centre, f64::from(radius)), centre + off)
}

/// The same of numbers within 3.
fn member_within_3() -> (Ball, f64) {
    let (centre, off, radius) = (within_3().0, within_3().0, 2 * bit() + bit());
    assume(off <= radius && -off <= radius);
    (Ball::around(f64::from(centre), f64::from(radius)), f64::from(centre + off))
}

fn contains(ball: Ball, x: f64) -> bool {
    ball.lower() <= x && x <= ball.upper()
}

harnesses! {
    /// The sign of an area.
    holds balls_known_to_be_positive_have_positive_numbers_for_all_finite_doubles() {
        let (c, r, x): (f64, f64, f64) = (any(), any(), any());
        assume(c.is_finite() && r >= 0.0 && c - r <= x && x <= c + r);
        assert!(!Ball::around(c, r).is_positive() || x > 0.0);
    }
    /// The false twin: the sign of the centre.
    fails control_balls_with_a_positive_centre_have_positive_numbers_for_all_finite_doubles([1.0, 2.0, -1.0]) {
        let (c, r, x): (f64, f64, f64) = (any(), any(), any());
        assume(c.is_finite() && r >= 0.0 && c - r <= x && x <= c + r);
        assert!(!(c > 0.0) || x > 0.0);
    }
    /// The order of v_n - g and 0, and of a bound and what is claimed of it.
    holds balls_known_to_be_at_most_a_number_have_no_larger_one_for_all_i8() {
        let (ball, x) = whole_member();
        let most = f64::from(any::<i8>());
        assert!(!ball.is_at_most(most) || x <= most);
    }
    /// The false twin: less than it.
    fails control_balls_known_to_be_at_most_a_number_have_smaller_ones_for_all_i8([1.0, 0.0, 0.0, 1.0]) {
        let (ball, x) = whole_member();
        let most = f64::from(any::<i8>());
        assert!(!ball.is_at_most(most) || x < most);
    }
    /// A NaN, or a radius without end: no conclusion.
    holds nothing_is_known_of_balls_without_a_centre_or_an_end_for_all_doubles() {
        let (c, r, most): (f64, f64, f64) = (any(), any(), any());
        assume(c.is_nan() || r.is_nan() || r == f64::INFINITY);
        assume(!(c.is_infinite() && r == f64::INFINITY));
        assume(most < f64::INFINITY);
        let ball = Ball::around(c, r);
        assert!(!ball.is_positive() && !ball.is_at_most(most));
    }
    /// The false twin: not even that it is at most infinite.
    fails control_nothing_is_known_of_balls_without_an_end_for_all_doubles([0.0, f64::INFINITY]) {
        let (c, most): (f64, f64) = (any(), any());
        assume(!c.is_infinite());
        let ball = Ball::around(c, f64::INFINITY);
        assert!(!ball.is_positive() && !ball.is_at_most(most));
    }
    /// Ends are rounded outwards: beyond the sums, which are exact.
    holds ends_of_a_ball_lie_beyond_the_sums_for_all_i8() {
        let (c, r) = (f64::from(any::<i8>()), f64::from(any::<u8>()));
        assume(r > 0.0);
        let ball = Ball::around(c, r);
        assert!(ball.lower() < c - r && c + r < ball.upper());
    }
    /// The false twin: where there is no radius, too.
    fails control_ends_of_a_point_lie_beyond_it_for_all_i8([1.0, 0.0]) {
        let (c, r) = (f64::from(any::<i8>()), f64::from(any::<u8>()));
        let ball = Ball::around(c, r);
        assert!(ball.lower() < c - r && c + r < ball.upper());
    }
    /// A divisor that may be zero: the quotient has no end.
    holds quotients_by_balls_with_zero_have_no_end_for_all_finite_doubles() {
        let (a, c, r, most): (f64, f64, f64, f64) = (any(), any(), any(), any());
        assume(a.is_finite() && c.is_finite() && r >= c.abs());
        assume(most < f64::INFINITY);
        let quotient = Ball::exactly(a) / Ball::around(c, r);
        assert!(!quotient.is_positive() && !quotient.is_at_most(most));
    }
    /// The false twin: whatever the divisor.
    fails control_quotients_by_balls_have_no_end_for_all_finite_doubles([1.0, 1.0, 0.5, 9.0]) {
        let (a, c, r, most): (f64, f64, f64, f64) = (any(), any(), any(), any());
        assume(a == 1.0 && c == 1.0 && (0.0..=0.5).contains(&r));
        assume(most < f64::INFINITY);
        let quotient = Ball::exactly(a) / Ball::around(c, r);
        assert!(!quotient.is_positive() && !quotient.is_at_most(most));
    }
    /// Inclusion: the positive part of a ball across zero has both answers.
    holds positive_part_of_a_ball_contains_those_of_its_numbers_within_3() {
        let (ball, x) = member_within_3();
        assert!(contains(positive_part(ball), positive_part(x)));
    }
    /// The false twin: the sign of the centre decides. The ball around -1 with the radius 2 has the number 1.
    fails control_the_centre_decides_the_positive_part_within_3([0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]) {
        let (ball, x) = member_within_3();
        let centre = (ball.lower() + ball.upper()) / 2.0;
        let part = if centre <= 0.0 { Ball::from(0) } else { ball };
        assert!(contains(part, positive_part(x)));
    }
    /// A bound of the magnitudes, and a double that none is below.
    holds magnitudes_of_balls_are_bounded_for_all_i8() {
        let (c, r) = (f64::from(any::<i8>()), f64::from(any::<u8>()));
        let ball = Ball::around(c, r);
        assert!(ball.magnitude() >= c.abs() + r && ball.least_magnitude() <= (c.abs() - r).max(0.0));
    }
    /// The false twin: of the centre.
    fails control_magnitudes_of_balls_are_those_of_the_centre_for_all_i8([1.0, 1.0]) {
        let (c, r) = (f64::from(any::<i8>()), f64::from(any::<u8>()));
        assert!(Ball::around(c, r).magnitude() <= (c.abs()) * 1.5);
    }
    /// A sum of two doubles is exact: what head loses is in tail.
    holds double_doubles_keep_what_a_sum_loses_for_all_i8() {
        let (a, b) = (f64::from(any::<i8>()), f64::from(any::<i8>()) * (f64::EPSILON / 4.0));
        let sum = DoubleDouble::sum(a, b);
        assert!(sum.head() == a + b && (sum.head() - a) + sum.tail() == b);
        let turned = DoubleDouble::sum(b, a);
        assert!(turned.head() == a + b && (turned.head() - a) + turned.tail() == b);
    }
    /// The false twin: nothing is lost.
    fails control_doubles_keep_what_a_sum_loses_for_all_i8([1.0, 1.0]) {
        let (a, b) = (f64::from(any::<i8>()), f64::from(any::<i8>()) * (f64::EPSILON / 4.0));
        assert!((a + b) - a == b);
    }
    /// The larger of two bounds is no bound where one is no number.
    holds larger_of_two_bounds_is_not_below_either_for_all_doubles() {
        let (a, b): (f64, f64) = (any(), any());
        let most = larger(a, b);
        assert!(if a.is_nan() || b.is_nan() { most == f64::INFINITY } else { most >= a && most >= b });
    }
    /// The false twin: by `max`, which takes the other one.
    fails control_maximum_is_no_number_where_one_is_none_for_all_doubles([f64::NAN, 0.0]) {
        let (a, b): (f64, f64) = (any(), any());
        let most = a.max(b);
        assert!(if a.is_nan() || b.is_nan() { most == f64::INFINITY } else { most >= a && most >= b });
    }
    /// Widening adds to the radius; a ball around the nearest double has what the tail leaves.
    holds widened_and_rounded_balls_have_what_they_had_for_all_i8() {
        let (c, r, by) = (f64::from(any::<i8>()), f64::from(any::<u8>()), f64::from(any::<u8>()));
        assert!(Ball::around(c, r).widened(by).radius() >= r + by);
        let number = DoubleDouble::sum(1.0, f64::from(any::<i8>()) * (f64::EPSILON / 256.0));
        assert!(PreciseBall::point(number).rounded().radius() >= number.tail().abs());
    }
    /// The false twin: the larger of the two radii.
    fails control_widening_takes_the_larger_radius_for_all_i8([0.0, 1.0, 1.0]) {
        let (c, r, by) = (f64::from(any::<i8>()), f64::from(any::<u8>()), f64::from(any::<u8>()));
        assert!(Ball::around(c, r).widened(by).radius() <= 1.5 * r.max(by));
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::{Claim, model_checked};

    /// The row of the numbers of the computer.
    pub fn claim() -> Claim {
        Claim {
            id: "13",
            title: "What the computer's numbers keep",
            paper: "Nothing: it computes in R.",
            limits: "That rounded operations enclose is drawn against rationals (`props/tests/program/balls.rs`), not proved over all doubles. One engine: rounding is a fact about doubles alone.",
            checks: model_checked(HARNESSES, &[]),
        }
    }
}
