//! Balls: a centre, and how far from it the number may be. The number type of long sums, some times quicker than intervals, whose
//! products take four multiplications and a sort.
//!
//! The centre is a double ([`Ball`]), or a [double-double](super::double_double) ([`PreciseBall`]), with which residuals keep their
//! digits where they cancel. An operation gives a ball that contains the exact results for all numbers of its operands' balls. Let
//! |x - a| <= r and |y - b| <= s. Then
//!
//! ```text
//! |x + y - (a + b)| <= r + s
//! |x y - a b| <= |a| s + r (|b| + s)
//! |x/y - a/b| <= (r + |a/b| s) / (|b| - s)    if s < |b|
//! |x^(1/2) - c| = |x - c^2| / (x^(1/2) + c)
//! ```
//!
//! A radius is such a bound plus that of the rounding of the centre, which [`Centre`] knows, computed in doubles. No radius here
//! takes more than twelve roundings, each of which loses a factor 1 - u at most (u = 2^-53), and eta/2 (eta = 2^-1074) if it
//! underflows; [`up`] and `TINY` give back more. A sum or a product that is zero without underflow stays sharp. What can't be bounded
//! has a centre or a radius that is NaN or infinite.
//!
//! Trusted are IEEE 754 double precision, rounding to nearest, and the exactness of the sum and the product of two doubles as
//! sums of two doubles (Knuth, Dekker).

use std::ops::{Add, Div, Mul, Neg, Sub};

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};

use super::double_double::DoubleDouble;
use super::scalar::{One, Zero};
use super::{Enclosing, Scalar};

/// u, the relative error of a rounded result.
const UNIT: f64 = f64::EPSILON / 2.0;

/// 16 eta
const TINY: f64 = f64::from_bits(16);

/// A bound of the exact value of an expression of nonnegative doubles that takes at most twelve roundings and does not underflow,
/// from its value in doubles.
#[inline]
pub fn up(x: f64) -> f64 {
    x * (1.0 + 8.0 * f64::EPSILON)
}

/// The larger of two bounds; infinite if one is no number.
#[inline]
pub fn larger(a: f64, b: f64) -> f64 {
    if a >= b {
        a
    } else if b >= a {
        b
    } else {
        f64::INFINITY
    }
}

/// The number in the middle of a ball: a sum of two doubles, the first of which is the sum rounded to nearest. Its operations round,
/// and bound what they are off by.
pub trait Centre:
    nalgebra::Scalar + Copy + From<f64> + Into<DoubleDouble> + Neg<Output = Self>
{
    /// The nearest double.
    #[inline]
    fn head(self) -> f64 {
        self.into().head()
    }

    /// The difference from the nearest double.
    #[inline]
    fn tail(self) -> f64 {
        self.into().tail()
    }

    /// A double that its magnitude is not below.
    #[inline]
    fn least(self) -> f64 {
        let (head, tail) = (self.head().abs(), self.tail().abs());
        if tail == 0.0 { head } else { (head - tail).next_down() }
    }

    /// The sum, rounded, and a bound of its error.
    fn rounded_sum(self, other: Self) -> (Self, f64);

    /// The product, rounded, and a bound of its error; 16 eta less will do.
    fn rounded_product(self, other: Self) -> (Self, f64);

    /// The quotient by a number that is not zero, rounded, and a bound of its error; 16 eta less will do.
    fn rounded_quotient(self, other: Self) -> (Self, f64);

    /// A number next to the root of a positive one.
    fn near_root(self) -> Self;
}

impl Centre for f64 {
    #[inline]
    fn rounded_sum(self, other: f64) -> (f64, f64) {
        let sum = self + other;
        (sum, UNIT * sum.abs())
    }

    #[inline]
    fn rounded_product(self, other: f64) -> (f64, f64) {
        let product = self * other;
        (product, UNIT * product.abs())
    }

    #[inline]
    fn rounded_quotient(self, other: f64) -> (f64, f64) {
        let quotient = self / other;
        (quotient, UNIT * quotient.abs())
    }

    #[inline]
    fn near_root(self) -> f64 {
        self.sqrt()
    }
}

/// All real numbers that are at most `radius` from `centre`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MidRad<C> {
    centre: C,
    radius: f64,
}

/// A ball around a double.
pub type Ball = MidRad<f64>;

/// A ball around a double-double.
pub type PreciseBall = MidRad<DoubleDouble>;

impl<C: Centre> MidRad<C> {
    /// The ball that contains this number only.
    #[inline]
    pub fn point(centre: C) -> Self {
        MidRad { centre, radius: 0.0 }
    }

    /// All numbers that are at most `radius` >= 0 from `centre`.
    #[inline]
    pub fn around(centre: C, radius: f64) -> Self {
        MidRad { centre, radius }
    }

    /// The number in the middle.
    #[inline]
    pub fn centre(self) -> C {
        self.centre
    }

    /// The double nearest to the centre.
    #[inline]
    pub fn head(self) -> f64 {
        self.centre.head()
    }

    /// The largest distance of its numbers from the centre.
    #[inline]
    pub fn radius(self) -> f64 {
        self.radius
    }

    /// Enlarges the radius by `by`.
    #[inline]
    pub fn widened(self, by: f64) -> Self {
        MidRad { radius: up(self.radius + by), ..self }
    }

    /// The smallest double known to be no smaller than any of its numbers. NaN if there is none to be known.
    #[inline]
    pub fn upper(self) -> f64 {
        let (head, tail) = (self.head(), self.centre.tail());
        let beyond = if tail == 0.0 { self.radius } else { (tail + self.radius).next_up() };
        if beyond == 0.0 { head } else { (head + beyond).next_up() }
    }

    /// The largest double known to be no larger than any of its numbers. NaN if there is none to be known.
    #[inline]
    pub fn lower(self) -> f64 {
        -(-self).upper()
    }

    /// A bound of the magnitudes of its numbers. NaN or infinite if there is none.
    #[inline]
    pub fn magnitude(self) -> f64 {
        up(self.head().abs() + self.radius)
    }

    /// A double that none of its numbers is smaller than in magnitude; 0 of a NaN, which `max` passes over.
    #[inline]
    pub fn least_magnitude(self) -> f64 {
        self.lower().max(-self.upper()).max(0.0)
    }

    /// Returns whether it has a bound.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.head().is_finite() && self.centre.tail().is_finite() && self.radius.is_finite()
    }

    /// A ball around a double that contains it.
    #[inline]
    pub fn rounded(self) -> Ball {
        Ball::around(self.head(), up(self.centre.tail().abs() + self.radius))
    }

    /// A ball that contains all numbers from `lo` to `hi`.
    #[inline]
    pub(crate) fn between(lo: f64, hi: f64) -> Self {
        if lo == hi {
            return Self::from(lo);
        }
        let centre = lo / 2.0 + hi / 2.0;
        let radius = (hi - centre).max(centre - lo).next_up();
        MidRad { centre: C::from(centre), radius }
    }

    /// The square roots of its nonnegative numbers; NaN if it has none.
    #[inline]
    pub fn sqrt(self) -> Self {
        let (lo, hi) = (self.lower(), self.upper());
        let below = if lo > 0.0 { lo.sqrt().next_down() } else { 0.0 };
        let above = if hi == 0.0 { 0.0 } else { hi.sqrt().next_up() };
        let ends = Self::between(below, above);
        if !(below > 0.0) {
            return ends;
        }
        // The root of the centre has more digits, the ends are sharper for a wide ball.
        let root = Self::point(self.centre.near_root());
        let off = (self - root * root).magnitude() / (below + root.least_magnitude());
        let near = root.widened(off + TINY);
        if near.radius < ends.radius { near } else { ends }
    }

    #[inline]
    fn is_zero(self) -> bool {
        self.head() == 0.0 && self.radius == 0.0
    }
}

impl<C: Centre> From<f64> for MidRad<C> {
    #[inline]
    fn from(value: f64) -> Self {
        MidRad::point(C::from(value))
    }
}

impl<C: Centre> From<i32> for MidRad<C> {
    #[inline]
    fn from(value: i32) -> Self {
        MidRad::from(f64::from(value))
    }
}

impl From<DoubleDouble> for PreciseBall {
    #[inline]
    fn from(centre: DoubleDouble) -> Self {
        MidRad::point(centre)
    }
}

impl From<Ball> for PreciseBall {
    #[inline]
    fn from(ball: Ball) -> Self {
        MidRad { centre: ball.centre.into(), radius: ball.radius }
    }
}

impl<C: Centre> Neg for MidRad<C> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        MidRad { centre: -self.centre, radius: self.radius }
    }
}

impl<C: Centre> Add for MidRad<C> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let (centre, error) = self.centre.rounded_sum(other.centre);
        MidRad { centre, radius: up(self.radius + other.radius + error) }
    }
}

impl<C: Centre> Sub for MidRad<C> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<C: Centre> Mul for MidRad<C> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let (centre, error) = self.centre.rounded_product(other.centre);
        if centre.head() == 0.0 && (self.is_zero() || other.is_zero()) {
            return Self::from(0);
        }
        let spread =
            self.head().abs() * other.radius + self.radius * (other.head().abs() + other.radius);
        MidRad { centre, radius: up(spread + error) + TINY }
    }
}

impl<C: Centre> Div for MidRad<C> {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let distance = other.centre.least() - other.radius;
        if !(distance > 0.0) {
            return MidRad { centre: C::from(f64::NAN), radius: f64::INFINITY };
        }
        if self.is_zero() {
            return self;
        }
        let (centre, error) = self.centre.rounded_quotient(other.centre);
        let spread = self.radius + (centre.head().abs() + error + TINY) * other.radius + TINY;
        MidRad { centre, radius: up(spread / distance + error) + TINY }
    }
}

crate::entry_of_nalgebra!(Ball);
crate::entry_of_nalgebra!(PreciseBall);

impl<C: Centre> Scalar for MidRad<C>
where
    Self: Zero + One + ClosedAddAssign + ClosedSubAssign + ClosedMulAssign + ClosedDivAssign,
{
    #[inline]
    fn split(
        self,
        nonpositive: impl FnOnce(Self) -> Self,
        positive: impl FnOnce(Self) -> Self,
    ) -> Self {
        let (lo, hi) = (self.lower(), self.upper());
        if hi <= 0.0 {
            nonpositive(self)
        } else if lo <= 0.0 {
            let (below, above) =
                (nonpositive(Self::between(lo, 0.0)), positive(Self::between(0.0, hi)));
            Self::between(below.lower().min(above.lower()), below.upper().max(above.upper()))
        } else {
            positive(self)
        }
    }
}

impl<C: Centre> Enclosing for MidRad<C>
where
    Self: Scalar,
{
    #[inline]
    fn exactly(value: f64) -> Self {
        MidRad::point(C::from(value))
    }

    #[inline]
    fn sqrt(self) -> Self {
        MidRad::sqrt(self)
    }

    #[inline]
    fn upper(self) -> f64 {
        MidRad::upper(self)
    }

    #[inline]
    fn lower(self) -> f64 {
        MidRad::lower(self)
    }

    #[inline]
    fn ball(self) -> Ball {
        self.rounded()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_magnitude_of_a_double_double_is_below_its_own() {
        let small = 2.0_f64.powi(-60);
        for (head, tail) in [(1.0, -small), (1.0, small), (-1.0, small), (-3.0, -small)] {
            let x = DoubleDouble::from(head) + DoubleDouble::from(tail);
            assert_eq!((Centre::head(x), Centre::tail(x)), (head, tail));
            let least = Centre::least(x);
            assert!(least < head.abs() && least >= head.abs() * (1.0 - 2.0 * f64::EPSILON));
        }
        // Control: a double has its own magnitude.
        assert_eq!(Centre::least(DoubleDouble::from(-3.0)), 3.0);
    }

    fn around<C: Centre>(centre: f64, radius: f64) -> MidRad<C> {
        MidRad::around(C::from(centre), radius)
    }

    fn zeros_stay_sharp<C: Centre>() {
        let zero = MidRad::<C>::from(0);
        assert_eq!(around::<C>(3.0, 1.0) * zero, zero);
        assert_eq!(zero / around::<C>(3.0, 1.0), zero);
        let tiny = MidRad::<C>::from(1e-200) * MidRad::from(1e-200);
        assert!(tiny.lower() < 0.0 && tiny.upper() > 0.0);
    }

    #[test]
    fn zero_stays_sharp_and_an_underflow_does_not() {
        zeros_stay_sharp::<f64>();
        zeros_stay_sharp::<DoubleDouble>();
        assert_eq!(Ball::from(0.1) - Ball::from(0.1), Ball::from(0));
    }

    fn nothing_is_concluded_without_a_bound<C: Centre>() {
        let unbounded = MidRad::<C>::from(1) / around(0.5, 1.0);
        let (two, one) = (MidRad::from(2), MidRad::from(1));
        for x in [unbounded, unbounded * two, unbounded + one, (-one).sqrt()] {
            assert!(!(x.upper() <= 0.0) && !(x.lower() > 0.0) && !x.is_finite());
        }
        let largest = MidRad::<C>::from(f64::MAX);
        assert!(!(largest + largest).is_finite() && !(largest * largest).is_finite());
    }

    #[test]
    fn what_has_no_bound_passes_no_comparison() {
        nothing_is_concluded_without_a_bound::<f64>();
        nothing_is_concluded_without_a_bound::<DoubleDouble>();
    }

    #[test]
    fn a_root_has_the_digits_of_its_centre() {
        let two = PreciseBall::from(2);
        let root = two.sqrt();
        assert!(root.radius() < 1e-30 && (root * root - two).magnitude() < 1e-29, "{root:?}");
        assert!(Ball::from(2).sqrt().radius() > 1e-17, "control: a double has half of them");
    }
}
