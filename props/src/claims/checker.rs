//! What the checker of certificates concludes from balls (`kernel::enclosing`), for the model checker: signs, orders and ends.
//! A member of a ball is a double x with c - r <= x <= c + r, where both sums may be rounded: rounding keeps the order, so
//! every double in the ball is one.
//!
//! That two sums of doubles are the same, or ordered, is more than a SAT solver can show: where it comes to that, numbers are
//! whole. Roots are left to row 13, which has exact squares.

#![allow(
    clippy::manual_range_contains,
    reason = "the text of a harness is what its receipt is about"
)]

use signorini::kernel::{Ball, Enclosing, positive_part};

use crate::harness::{any, assume};
use crate::harnesses;

/// A ball and one of its numbers, both of whole numbers: sums of them are exact.
fn whole_member() -> (Ball, f64) {
    let (centre, radius, off): (i8, u8, i8) = (any(), any(), any());
    assume(i32::from(off.unsigned_abs()) <= i32::from(radius));
    let (centre, off) = (f64::from(centre), f64::from(off));
    (Ball::around(centre, f64::from(radius)), centre + off)
}

fn bit() -> i32 {
    i32::from(any::<bool>())
}

/// The same of numbers within 1.
fn small_member() -> (Ball, f64) {
    let within_1 = || bit() - bit();
    let (centre, off, radius) = (within_1(), within_1(), bit());
    assume(off <= radius && -off <= radius);
    (Ball::around(f64::from(centre), f64::from(radius)), f64::from(centre + off))
}

/// The same of numbers within 3.
fn member_within_3() -> (Ball, f64) {
    let within_3 = || (2 * bit() + bit()) * (1 - 2 * bit());
    let (centre, off, radius) = (within_3(), within_3(), 2 * bit() + bit());
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
        assume(a == 1.0 && c == 1.0 && r >= 0.0 && r <= 0.5);
        assume(most < f64::INFINITY);
        let quotient = Ball::exactly(a) / Ball::around(c, r);
        assert!(!quotient.is_positive() && !quotient.is_at_most(most));
    }
    /// Inclusion, for whole numbers, whose sums are exact.
    holds sums_of_balls_contain_the_sums_of_their_numbers_within_1() {
        let ((a, x), (b, y)) = (small_member(), small_member());
        assert!(contains(a + b, x + y));
    }
    /// The false twin: the second radius forgotten.
    fails control_sums_of_balls_forget_a_radius_within_1([0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0]) {
        let ((a, x), (_, y)) = (small_member(), small_member());
        assert!(contains(a + Ball::from(0), x + y));
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
    /// A product is rounded outwards. At given numbers: two products of doubles are more than a solver can compare.
    holds products_of_balls_are_rounded_outwards_at_seven_pairs() {
        for k in 1..8 {
            let (x, y) = (f64::from(k) / 10.0, f64::from(2 * k - 9) / 3.0);
            let product = Ball::exactly(x) * Ball::exactly(y);
            assert!(product.lower() < x * y && x * y < product.upper());
        }
    }
    /// The false twin: rounded to nearest.
    fails control_products_of_balls_are_rounded_to_nearest_at_seven_pairs([]) {
        for k in 1..8 {
            let (x, y) = (f64::from(k) / 10.0, f64::from(2 * k - 9) / 3.0);
            let product = Ball::exactly(x) * Ball::exactly(y);
            assert!(product.lower() == x * y || x * y == product.upper());
        }
    }
}
