//! Balls: a double and how far from it the number may be. The number type of long sums, some times quicker than
//! [`Interval`](super::Interval), which goes through four products and a sort.
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
//! which loses a factor 1 - u at most, and eta/2 if it underflows; [`GROWTH`] and [`TINY`] give back more. A sum or a product
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
    pub fn point(value: f64) -> Ball {
        Ball { centre: value, radius: 0.0 }
    }

    /// The smallest double known to be no smaller than any of its numbers. NaN if there is none to be known.
    pub fn upper(self) -> f64 {
        let end = self.centre + self.radius;
        if self.radius == 0.0 { end } else { end.next_up() }
    }

    /// The largest double known to be no larger than any of its numbers. NaN if there is none to be known.
    pub fn lower(self) -> f64 {
        -(-self).upper()
    }

    /// A ball that contains all numbers from `lo` to `hi`.
    fn between(lo: f64, hi: f64) -> Ball {
        if lo == hi {
            return Ball::point(lo);
        }
        let centre = lo / 2.0 + hi / 2.0;
        Ball { centre, radius: (hi - centre).max(centre - lo).next_up() }
    }

    /// The square roots of its nonnegative numbers; NaN if it has none.
    pub fn sqrt(self) -> Ball {
        let (lo, hi) = (self.lower(), self.upper());
        let below = if lo > 0.0 { lo.sqrt().next_down() } else { 0.0 };
        let above = if hi == 0.0 { 0.0 } else { hi.sqrt().next_up() };
        Ball::between(below, above)
    }

    fn is_zero(self) -> bool {
        self.centre == 0.0 && self.radius == 0.0
    }
}

impl From<i32> for Ball {
    fn from(value: i32) -> Ball {
        Ball::point(f64::from(value))
    }
}

impl Neg for Ball {
    type Output = Ball;

    fn neg(self) -> Ball {
        Ball { centre: -self.centre, radius: self.radius }
    }
}

impl Add for Ball {
    type Output = Ball;

    fn add(self, other: Ball) -> Ball {
        let centre = self.centre + other.centre;
        Ball { centre, radius: (self.radius + other.radius + UNIT * centre.abs()) * GROWTH }
    }
}

impl Sub for Ball {
    type Output = Ball;

    fn sub(self, other: Ball) -> Ball {
        self + -other
    }
}

impl Mul for Ball {
    type Output = Ball;

    fn mul(self, other: Ball) -> Ball {
        let centre = self.centre * other.centre;
        if centre == 0.0 && (self.is_zero() || other.is_zero()) {
            return Ball::point(0.0);
        }
        let spread = self.centre.abs() * other.radius
            + self.radius * (other.centre.abs() + other.radius);
        Ball { centre, radius: (spread + UNIT * centre.abs()) * GROWTH + TINY }
    }
}

impl Div for Ball {
    type Output = Ball;

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
    fn split(
        self,
        nonpositive: impl FnOnce(Ball) -> Ball,
        positive: impl FnOnce(Ball) -> Ball,
    ) -> Ball {
        let (lo, hi) = (self.lower(), self.upper());
        if hi <= 0.0 {
            nonpositive(self)
        } else if lo <= 0.0 {
            let (below, above) = (nonpositive(Ball::between(lo, 0.0)), positive(Ball::between(0.0, hi)));
            Ball::between(below.lower().min(above.lower()), below.upper().max(above.upper()))
        } else {
            positive(self)
        }
    }
}
