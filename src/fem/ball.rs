//! Balls: all real numbers within a radius of a [double-double](super::double_double), for statements that hold whatever rounding
//! does. An operation gives a ball that contains the exact results for all numbers of its operands' balls. (The balls of the
//! kernel have a double in the middle: quicker, with half of the digits.)
//!
//! The centres carry some 106 bits, so that residuals keep their digits where they cancel; the radii are doubles, rounded up.
//! Trusted are IEEE 754 double precision, rounding to nearest, and the exactness of the sum and the product of two doubles as
//! sums of two doubles (Knuth, Dekker). The bounds of the rounding errors are proved in docs/theory.md, 7.5. What has no bound
//! (an overflow, a quotient by a ball that contains zero) has an infinite radius or is NaN.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::double_double::{DoubleDouble, halves};
use crate::kernel::Scalar;

/// The numbers from `head + tail - radius` to `head + tail + radius`; `head` is `head + tail` rounded to nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreciseBall {
    head: f64,
    tail: f64,
    radius: f64,
}

/// 2^-103 >= twice the rounding error of a sum beside the magnitudes of its terms, 3.1 u^2 with u = 2^-53.
const SUM: f64 = 9.860_761_315_262_648e-32;

/// 2^-101 >= twice the rounding error of a product beside its magnitude, 8.1 u^2.
const PRODUCT: f64 = 4.0 * SUM;

/// The largest error of a product of less than 2^-900 in magnitude is off by at most, however it underflows: 2^-890.
const TINY: f64 = f64::from_bits((1023 - 890) << 52);

/// A sum or product of a few nonnegative doubles, each operation rounded to nearest, is no more than this times that.
pub(crate) fn up(x: f64) -> f64 {
    x * (1.0 + 16.0 * f64::EPSILON)
}

/// The larger of two bounds; infinite if one is no number.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a >= b {
        a
    } else if b >= a {
        b
    } else {
        f64::INFINITY
    }
}

impl PreciseBall {
    const EVERYTHING: PreciseBall = PreciseBall { head: 0.0, tail: 0.0, radius: f64::INFINITY };

    /// The centre alone.
    pub fn centre(self) -> Self {
        PreciseBall { radius: 0.0, ..self }
    }

    /// The double nearest to the centre.
    pub fn head(self) -> f64 {
        self.head
    }

    /// The difference of the centre from the nearest double.
    pub fn tail(self) -> f64 {
        self.tail
    }

    /// The largest distance of the numbers of the ball from its centre.
    pub fn radius(self) -> f64 {
        self.radius
    }

    /// Adds `by` to the radius.
    pub fn widened(self, by: f64) -> Self {
        PreciseBall { radius: up(self.radius + by), ..self }
    }

    /// No number of the ball is larger in magnitude.
    pub fn magnitude(self) -> f64 {
        up(self.head.abs() + self.tail.abs() + self.radius)
    }

    /// No number of the ball is smaller in magnitude.
    pub fn least_magnitude(self) -> f64 {
        let least = self.head.abs() - up(self.tail.abs() + self.radius);
        (least * (1.0 - 16.0 * f64::EPSILON)).max(0.0)
    }

    /// A ball of the kernel that contains it.
    pub fn rounded(self) -> crate::kernel::Ball {
        crate::kernel::Ball::around(self.head, up(self.tail.abs() + self.radius))
    }

    fn slack(self) -> f64 {
        8.0 * f64::EPSILON * (self.head.abs() + self.radius)
    }

    /// No number of the ball is larger.
    pub fn upper(self) -> f64 {
        self.head + (self.tail + self.radius) + self.slack()
    }

    /// No number of the ball is smaller.
    pub fn lower(self) -> f64 {
        self.head + (self.tail - self.radius) - self.slack()
    }

    /// Returns whether it has a bound.
    pub fn is_finite(self) -> bool {
        self.head.is_finite() && self.tail.is_finite() && self.radius.is_finite()
    }

    fn is_zero(self) -> bool {
        self.head == 0.0 && self.radius == 0.0
    }

    fn is_nan(self) -> bool {
        self.head.is_nan() || self.tail.is_nan() || self.radius.is_nan()
    }

    /// A ball that contains both.
    fn hull(self, other: PreciseBall) -> PreciseBall {
        if self.is_nan() || other.is_nan() {
            return PreciseBall { head: f64::NAN, ..self };
        }
        let (low, high) = (self.lower().min(other.lower()), self.upper().max(other.upper()));
        let middle = low / 2.0 + high / 2.0;
        let radius = (high - middle).max(middle - low);
        PreciseBall {
            head: middle,
            tail: 0.0,
            radius: up(radius + f64::EPSILON * middle.abs() + TINY),
        }
    }

    /// The square roots of positive numbers.
    pub fn sqrt(self) -> PreciseBall {
        if !(self.least_magnitude() > 0.0 && self.head > 0.0) {
            return if self.is_zero() { self } else { PreciseBall::EVERYTHING };
        }
        let first = self.head.sqrt();
        let rest = self - PreciseBall::from(first) * PreciseBall::from(first);
        let root = PreciseBall::from(DoubleDouble::sum(first, rest.head / (2.0 * first)));
        // |x^(1/2) - s| = |x - s^2| / (x^(1/2) + s)
        let off = (self - root * root).magnitude() / root.least_magnitude();
        root.widened(up(off + TINY))
    }
}

/// A double-double that is a factor of several products, its head split once for all of them.
#[derive(Clone, Copy, Debug)]
pub struct Multiplier {
    head: f64,
    tail: f64,
    halves: [f64; 2],
}

impl From<DoubleDouble> for Multiplier {
    #[inline]
    fn from(a: DoubleDouble) -> Self {
        Multiplier { head: a.head(), tail: a.tail(), halves: halves(a.head()) }
    }
}

impl Multiplier {
    /// The product of the heads, and what rounding and the tails add to it.
    #[inline]
    fn times(self, b: Self) -> [f64; 2] {
        let head = self.head * b.head;
        let ([a1, a2], [b1, b2]) = (self.halves, b.halves);
        let tail = ((a1 * b1 - head) + a1 * b2 + a2 * b1) + a2 * b2;
        [head, tail + (self.head * b.tail + self.tail * b.head)]
    }
}

impl PreciseBall {
    /// Adds a b + c d. Quicker than the operators, which find the halves of each factor anew.
    #[inline]
    pub(crate) fn add_products(&mut self, [(a, b), (c, d)]: [(Multiplier, Multiplier); 2]) {
        let [[p, p_tail], [q, q_tail]] = [a.times(b), c.times(d)];
        let products = DoubleDouble::sum(p, q);
        let tail = (p_tail + q_tail) + products.tail();
        let heads = DoubleDouble::sum(self.head, products.head());
        let sum = DoubleDouble::sum(heads.head(), heads.tail() + (self.tail + tail));
        let size = 2.0 * (PRODUCT * (p.abs() + q.abs()) + TINY);
        let radius = up(self.radius + (SUM * self.head.abs() + size));
        *self = PreciseBall { head: sum.head(), tail: sum.tail(), radius };
    }
}

impl From<f64> for PreciseBall {
    fn from(a: f64) -> Self {
        PreciseBall { head: a, tail: 0.0, radius: 0.0 }
    }
}

impl From<crate::kernel::Ball> for PreciseBall {
    fn from(a: crate::kernel::Ball) -> Self {
        let (low, high) = (a.lower(), a.upper());
        let middle = low / 2.0 + high / 2.0;
        PreciseBall { head: middle, tail: 0.0, radius: up((high - middle).max(middle - low)) }
    }
}

impl From<DoubleDouble> for PreciseBall {
    fn from(a: DoubleDouble) -> Self {
        PreciseBall { head: a.head(), tail: a.tail(), radius: 0.0 }
    }
}

impl From<i32> for PreciseBall {
    fn from(a: i32) -> Self {
        PreciseBall::from(f64::from(a))
    }
}

impl Add for PreciseBall {
    type Output = Self;

    #[inline]
    fn add(self, b: Self) -> Self {
        let heads = DoubleDouble::sum(self.head, b.head);
        let sum = DoubleDouble::sum(heads.head(), heads.tail() + (self.tail + b.tail));
        let size = self.head.abs() + b.head.abs();
        let radius = up(self.radius + b.radius + SUM * size);
        PreciseBall { head: sum.head(), tail: sum.tail(), radius }
    }
}

impl Neg for PreciseBall {
    type Output = Self;

    fn neg(self) -> Self {
        PreciseBall { head: -self.head, tail: -self.tail, radius: self.radius }
    }
}

impl Sub for PreciseBall {
    type Output = Self;

    #[inline]
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for PreciseBall {
    type Output = Self;

    #[inline]
    fn mul(self, b: Self) -> Self {
        if self.is_zero() || b.is_zero() {
            return if self.is_nan() || b.is_nan() {
                PreciseBall::EVERYTHING
            } else {
                PreciseBall::from(0.0)
            };
        }
        let heads = DoubleDouble::product(self.head, b.head);
        let cross = self.head * b.tail + self.tail * b.head;
        let product = DoubleDouble::sum(heads.head(), heads.tail() + cross);
        let spread = self.head.abs() * b.radius + b.head.abs() * self.radius;
        let size = PRODUCT * heads.head().abs() + TINY;
        let radius = up(spread + self.radius * b.radius + size);
        PreciseBall { head: product.head(), tail: product.tail(), radius }
    }
}

impl Div for PreciseBall {
    type Output = Self;

    /// Any quotient of the centres will do: what it is off by is found by multiplying back.
    fn div(self, b: Self) -> Self {
        let least = b.least_magnitude();
        if !(least > 0.0) {
            return PreciseBall::EVERYTHING;
        }
        if self.is_zero() {
            return self;
        }
        let first = self.head / b.head;
        let rest = self - b * PreciseBall::from(first);
        let quotient = PreciseBall::from(DoubleDouble::sum(first, rest.head / b.head));
        let off = (self - b * quotient).magnitude() / least;
        quotient.widened(up(off + TINY))
    }
}

crate::entry_of_nalgebra!(PreciseBall);

impl Scalar for PreciseBall {
    fn split(
        self,
        nonpositive: impl FnOnce(Self) -> Self,
        positive: impl FnOnce(Self) -> Self,
    ) -> Self {
        if self.is_nan() {
            positive(self)
        } else if self.is_zero() {
            nonpositive(self)
        } else if self.least_magnitude() > 0.0 {
            if self.head > 0.0 { positive(self) } else { nonpositive(self) }
        } else {
            nonpositive(self).hull(positive(self))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::positive_part;

    fn third() -> PreciseBall {
        PreciseBall::from(1) / PreciseBall::from(3)
    }

    #[test]
    fn what_overflows_has_no_bound_and_what_underflows_is_enclosed() {
        assert!(!(PreciseBall::from(1) / PreciseBall::from(0)).is_finite());
        assert!(!(PreciseBall::from(1e300) * PreciseBall::from(1e300)).is_finite());
        let tiny = PreciseBall::from(1e-200) * PreciseBall::from(1e-200);
        assert!(tiny.lower() <= 0.0 && tiny.upper() >= 0.0, "{tiny:?}");
    }

    #[test]
    fn products_that_are_added_are_those_of_the_operators() {
        let parts = [3.0, -0.7, 1e-9, 12345.678];
        let exact = parts.map(|x| DoubleDouble::sum(x, x * 1e-17 / 3.0));
        let [a, b, c, d] = exact.map(Multiplier::from);
        let mut sum = third();
        sum.add_products([(a, b), (c, d)]);
        let [a, b, c, d] = exact.map(PreciseBall::from);
        let off = sum - (third() + a * b + c * d);
        assert!(off.lower() <= 0.0 && off.upper() >= 0.0 && off.magnitude() < 1e-29, "{off:?}");
        assert!(off.centre().head() != 0.0, "control: the centres alone differ, {off:?}");
    }

    #[test]
    fn zero_stays_sharp_and_an_undecided_sign_gets_both_answers() {
        assert!((PreciseBall::from(0) * third()).is_zero());
        let undecided = PreciseBall::from(0).widened(1e-3);
        let positive = positive_part(undecided);
        assert!(positive.lower() <= 0.0 && positive.upper() >= 1e-3);
        assert_eq!(positive_part(-third()), PreciseBall::from(0));
        assert_eq!(positive_part(third()), third());
    }
}
