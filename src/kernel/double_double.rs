//! Numbers with twice the precision of a double: an unevaluated sum of two doubles, some 106 bits, in the range of doubles.
//!
//! A residual is a small difference of large forces; in doubles it is known to the rounding of the forces, which for slender
//! bodies is more than the loads themselves. The kernel evaluated over these numbers tells it. The operations are those of
//! Dekker (1971) and Knuth: each is off by a few units of 2^-104 at most, as long as nothing over- or underflows.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Scalar;
use super::ball::Centre;

/// `head + tail`, where the tail is at most half a unit in the last place of the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleDouble {
    head: f64,
    tail: f64,
}

impl DoubleDouble {
    /// The sum of two doubles, exactly.
    #[inline]
    pub fn sum(a: f64, b: f64) -> Self {
        let head = a + b;
        let of_b = head - a;
        DoubleDouble { head, tail: (a - (head - of_b)) + (b - of_b) }
    }

    /// The product of two doubles, exactly unless it over- or underflows.
    #[inline]
    pub fn product(a: f64, b: f64) -> Self {
        let head = a * b;
        let ([a1, a2], [b1, b2]) = (halves(a), halves(b));
        DoubleDouble { head, tail: ((a1 * b1 - head) + a1 * b2 + a2 * b1) + a2 * b2 }
    }

    /// Splits a sum of two parts that may overlap, the larger one first, into head and tail.
    #[inline]
    fn normal(head: f64, tail: f64) -> Self {
        let sum = head + tail;
        DoubleDouble { head: sum, tail: tail - (sum - head) }
    }

    /// The nearest double.
    #[inline]
    pub fn head(self) -> f64 {
        self.head
    }

    /// The difference from the nearest double.
    #[inline]
    pub fn tail(self) -> f64 {
        self.tail
    }
}

/// Splits a into a sum of two doubles of 26 bits each (Veltkamp).
#[inline]
fn halves(a: f64) -> [f64; 2] {
    let c = 134_217_729.0 * a;
    let high = c - (c - a);
    [high, a - high]
}

impl From<f64> for DoubleDouble {
    #[inline]
    fn from(a: f64) -> Self {
        DoubleDouble { head: a, tail: 0.0 }
    }
}

impl From<i32> for DoubleDouble {
    #[inline]
    fn from(a: i32) -> Self {
        DoubleDouble::from(f64::from(a))
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        let (heads, tails) =
            (DoubleDouble::sum(self.head, b.head), DoubleDouble::sum(self.tail, b.tail));
        let first = DoubleDouble::normal(heads.head, heads.tail + tails.head);
        DoubleDouble::normal(first.head, first.tail + tails.tail)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        DoubleDouble { head: -self.head, tail: -self.tail }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        let heads = DoubleDouble::product(self.head, b.head);
        DoubleDouble::normal(heads.head, heads.tail + (self.head * b.tail + self.tail * b.head))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let first = self.head / b.head;
        let rest = self - b * DoubleDouble::from(first);
        let second = rest.head / b.head;
        let rest = rest - b * DoubleDouble::from(second);
        DoubleDouble::normal(first, second) + DoubleDouble::from(rest.head / b.head)
    }
}

crate::entry_of_nalgebra!(DoubleDouble);

/// 2^-103 >= twice the rounding error of a sum beside the magnitudes of its terms' heads (Lemma 7.4 of docs/a-posteriori.md).
pub const SUM: f64 = 9.860_761_315_262_648e-32;

/// 2^-101 >= twice the rounding error of a product beside its magnitude.
pub const PRODUCT: f64 = 4.0 * SUM;

/// 2^-890: the error of a product of less than 2^-900 in magnitude, however it underflows, is less.
pub const UNDERFLOW: f64 = f64::from_bits((1023 - 890) << 52);

/// Sums and products with fewer operations than those of the operators, and with the bounds of Lemma 7.4.
impl Centre for DoubleDouble {
    #[inline]
    fn rounded_sum(self, other: Self) -> (Self, f64) {
        let heads = DoubleDouble::sum(self.head, other.head);
        let sum = DoubleDouble::sum(heads.head, heads.tail + (self.tail + other.tail));
        (sum, SUM * (self.head.abs() + other.head.abs()))
    }

    #[inline]
    fn rounded_product(self, other: Self) -> (Self, f64) {
        let heads = DoubleDouble::product(self.head, other.head);
        let cross = self.head * other.tail + self.tail * other.head;
        let product = DoubleDouble::sum(heads.head, heads.tail + cross);
        let error = if heads.head == 0.0 && (self.head == 0.0 || other.head == 0.0) {
            0.0
        } else {
            PRODUCT * heads.head.abs() + UNDERFLOW
        };
        (product, error)
    }

    /// Any quotient will do: what it is off by is found by multiplying back.
    #[inline]
    fn rounded_quotient(self, other: Self) -> (Self, f64) {
        let first = self.head / other.head;
        let (rest, _) = self.rounded_sum(-other.rounded_product(first.into()).0);
        let quotient = DoubleDouble::sum(first, rest.head / other.head);
        let (product, of_product) = other.rounded_product(quotient);
        let (rest, of_rest) = self.rounded_sum(-product);
        let off = rest.head.abs() + of_product + of_rest;
        (quotient, off / other.least() * (1.0 + 4.0 * f64::EPSILON))
    }

    #[inline]
    fn near_root(self) -> Self {
        let first = self.head.sqrt();
        let (rest, _) = self.rounded_sum(-DoubleDouble::product(first, first));
        DoubleDouble::sum(first, rest.head / (2.0 * first))
    }
}

impl Scalar for DoubleDouble {
    fn split(
        self,
        nonpositive: impl FnOnce(Self) -> Self,
        positive: impl FnOnce(Self) -> Self,
    ) -> Self {
        // The head has the sign of the number, or is zero with it.
        if self.head <= 0.0 { nonpositive(self) } else { positive(self) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nan_stays_nan() {
        let [nan, one] = [f64::NAN, 1.0].map(DoubleDouble::from);
        assert!((nan + one).head().is_nan() && (nan * one).head().is_nan());
        assert!(nan.split(|_| DoubleDouble::from(0), |a| a).head().is_nan());
    }
}
