//! Balls: a double and how far from it the number may be. The number type of long sums, some times quicker than
//! intervals, whose products take four multiplications and a sort.
//!
//! With u = 2^-53 and eta = 2^-1074, a rounded sum m is within u |m| of the exact one, and a rounded product or quotient within
//! u |m| + eta/2. Let |x - a| <= r and |y - b| <= s. Then
//!
//! ```text
//! |x + y - (a + b)| <= r + s
//! |x y - a b| <= |a| s + r (|b| + s)
//! |x/y - a/b| <= (r + |a/b| s) / (|b| - s)    if s < |b|
//! ```
//!
//! A radius is such a bound plus u |m|, computed in doubles too. No radius here takes more than eight roundings, each of
//! which loses a factor 1 - u at most, and eta/2 if it underflows; `GROWTH` and `TINY` give back more. A sum or a product
//! that is zero without underflow stays sharp. What can't be bounded has the centre NaN, or the radius oo.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Scalar;

/// u, the relative error of a rounded result.
const UNIT: f64 = f64::EPSILON / 2.0;

/// 1 + 16 u
const GROWTH: f64 = 1.0 + 8.0 * f64::EPSILON;

/// 16 eta
const TINY: f64 = f64::from_bits(16);

/// All real numbers that are at most `radius` from `centre`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    centre: f64,
    radius: f64,
}

impl Ball {
    /// The ball that contains this double only.
    #[inline]
    pub fn point(value: f64) -> Ball {
        Ball { centre: value, radius: 0.0 }
    }

    /// All numbers that are at most `radius` >= 0 from `centre`.
    #[inline]
    pub fn around(centre: f64, radius: f64) -> Ball {
        Ball { centre, radius }
    }

    /// The smallest double known to be no smaller than any of its numbers. NaN if there is none to be known.
    #[inline]
    pub fn upper(self) -> f64 {
        let end = self.centre + self.radius;
        if self.radius == 0.0 { end } else { end.next_up() }
    }

    /// The largest double known to be no larger than any of its numbers. NaN if there is none to be known.
    #[inline]
    pub fn lower(self) -> f64 {
        -(-self).upper()
    }

    /// A ball that contains all numbers from `lo` to `hi`.
    #[inline]
    fn between(lo: f64, hi: f64) -> Ball {
        if lo == hi {
            return Ball::point(lo);
        }
        let centre = lo / 2.0 + hi / 2.0;
        Ball { centre, radius: (hi - centre).max(centre - lo).next_up() }
    }

    /// The square roots of its nonnegative numbers; NaN if it has none.
    #[inline]
    pub fn sqrt(self) -> Ball {
        let (lo, hi) = (self.lower(), self.upper());
        let below = if lo > 0.0 { lo.sqrt().next_down() } else { 0.0 };
        let above = if hi == 0.0 { 0.0 } else { hi.sqrt().next_up() };
        Ball::between(below, above)
    }

    #[inline]
    fn is_zero(self) -> bool {
        self.centre == 0.0 && self.radius == 0.0
    }
}

/// The double in the middle of a ball, and how far its numbers may be from that.
#[inline]
pub fn centre_and_radius(ball: Ball) -> (f64, f64) {
    (ball.centre, ball.radius)
}

impl From<i32> for Ball {
    #[inline]
    fn from(value: i32) -> Ball {
        Ball::point(f64::from(value))
    }
}

impl Neg for Ball {
    type Output = Ball;

    #[inline]
    fn neg(self) -> Ball {
        Ball { centre: -self.centre, radius: self.radius }
    }
}

impl Add for Ball {
    type Output = Ball;

    #[inline]
    fn add(self, other: Ball) -> Ball {
        let centre = self.centre + other.centre;
        Ball { centre, radius: (self.radius + other.radius + UNIT * centre.abs()) * GROWTH }
    }
}

impl Sub for Ball {
    type Output = Ball;

    #[inline]
    fn sub(self, other: Ball) -> Ball {
        self + -other
    }
}

impl Mul for Ball {
    type Output = Ball;

    #[inline]
    fn mul(self, other: Ball) -> Ball {
        let centre = self.centre * other.centre;
        if centre == 0.0 && (self.is_zero() || other.is_zero()) {
            return Ball::point(0.0);
        }
        let spread =
            self.centre.abs() * other.radius + self.radius * (other.centre.abs() + other.radius);
        Ball { centre, radius: (spread + UNIT * centre.abs()) * GROWTH + TINY }
    }
}

impl Div for Ball {
    type Output = Ball;

    #[inline]
    fn div(self, other: Ball) -> Ball {
        let distance = other.centre.abs() - other.radius;
        if !(distance > 0.0) {
            return Ball { centre: f64::NAN, radius: f64::INFINITY };
        }
        if self.is_zero() {
            return Ball::point(0.0);
        }
        let centre = self.centre / other.centre;
        let spread = self.radius + (centre.abs() + TINY) * other.radius + TINY;
        Ball { centre, radius: (spread / distance + UNIT * centre.abs()) * GROWTH + TINY }
    }
}

crate::entry_of_nalgebra!(Ball);

impl Scalar for Ball {
    #[inline]
    fn split(
        self,
        nonpositive: impl FnOnce(Ball) -> Ball,
        positive: impl FnOnce(Ball) -> Ball,
    ) -> Ball {
        let (lo, hi) = (self.lower(), self.upper());
        if hi <= 0.0 {
            nonpositive(self)
        } else if lo <= 0.0 {
            let (below, above) =
                (nonpositive(Ball::between(lo, 0.0)), positive(Ball::between(0.0, hi)));
            Ball::between(below.lower().min(above.lower()), below.upper().max(above.upper()))
        } else {
            positive(self)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers for which sums, products and their ends are exact in doubles: multiples of 1/16 up to 8.
    fn multiple(k: i32) -> f64 {
        f64::from(k % 128) / 16.0
    }

    fn contains(ball: Ball, value: f64) -> bool {
        ball.lower() <= value && value <= ball.upper()
    }

    /// The ends of the exact results, over pairs of balls.
    #[test]
    fn results_contain_those_of_all_members() {
        for k in 0..400 {
            let (a, r) = (multiple(37 * k - 64), multiple(k % 7));
            let (b, s) = (multiple(101 * k - 50), multiple(k % 5));
            let (x, y) = (Ball::around(a, r), Ball::around(b, s));
            for (u, v) in [(a - r, b - s), (a - r, b + s), (a + r, b - s), (a + r, b + s), (a, b)] {
                assert!(contains(x + y, u + v) && contains(x - y, u - v) && contains(x * y, u * v));
                if b.abs() > s {
                    // The quotient rounded outwards once more.
                    let ratio = u / v;
                    assert!(
                        (x / y).lower() <= ratio.next_up() && ratio.next_down() <= (x / y).upper()
                    );
                } else {
                    assert!((x / y).upper().is_nan());
                }
                if u >= 0.0 {
                    assert!(contains(x.sqrt(), u.sqrt()));
                }
            }
        }
    }

    /// The error of a rounded sum and product is known exactly, by Knuth's and Dekker's transformations.
    #[test]
    fn the_radius_covers_the_rounding() {
        let mut x = 0.7_f64;
        let mut inexact = 0;
        for k in 0..2000 {
            x = (3.9 * x * (1.0 - x)).abs();
            let y = (x * 7.3 + f64::from(k)).sin() * 10.0_f64.powi(k % 60 - 30);
            let (p, q) = (Ball::point(x), Ball::point(y));
            let product = p * q;
            let error = x.mul_add(y, -product.centre);
            assert!(
                error.abs() <= product.radius
                    && product.radius <= 64.0 * UNIT * product.centre.abs()
            );
            let sum = p + q;
            let back = sum.centre - x;
            let error = (x - (sum.centre - back)) + (y - back);
            assert!(error.abs() <= sum.radius);
            inexact += i32::from(error != 0.0);
            let root = p.sqrt();
            assert!(root.lower().powi(2) <= x && x <= root.upper().powi(2));
        }
        // Without the term u |m| both radii would be zero.
        assert!(inexact > 1000);
    }

    #[test]
    fn zero_stays_sharp_and_an_underflow_does_not() {
        let zero = Ball::from(0);
        assert_eq!(Ball::around(3.0, 1.0) * zero, zero);
        assert_eq!(zero / Ball::around(3.0, 1.0), zero);
        assert_eq!(Ball::point(0.1) - Ball::point(0.1), zero);
        let tiny = Ball::point(1e-200) * Ball::point(1e-200);
        assert!(tiny.lower() < 0.0 && tiny.upper() > 0.0);
    }

    #[test]
    fn what_has_no_bound_passes_no_comparison() {
        let unbounded = Ball::from(1) / Ball::around(0.5, 1.0);
        for x in
            [unbounded, unbounded * Ball::from(2), unbounded + Ball::from(1), Ball::from(-1).sqrt()]
        {
            assert!(!(x.upper() <= 0.0) && !(x.lower() > 0.0) && !x.upper().is_finite());
        }
        assert!(!(Ball::point(f64::MAX) + Ball::point(f64::MAX)).upper().is_finite());
    }

    #[test]
    fn a_ball_across_zero_gets_both_answers() {
        let positive_part = |x: Ball| x.split(|_| Ball::from(0), |x| x);
        assert_eq!(positive_part(Ball::around(-2.0, 1.0)), Ball::from(0));
        assert_eq!(positive_part(Ball::around(3.0, 1.0)), Ball::around(3.0, 1.0));
        let across = positive_part(Ball::around(0.5, 1.0));
        assert!(contains(across, 0.0) && contains(across, 1.5) && across.upper() < 1.5 + 1e-12);
    }
}
