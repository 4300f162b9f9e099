//! A double with the size of the terms that it was computed from: the number type of long linear formulas, some times quicker
//! than [`Ball`], which bounds each rounding when it happens. Here they are counted, and bounded at the end.
//!
//! With u = 2^-53, eta = 2^-1074 and e_k = (1 + 2 u)^k - 1, a number (a, A) that has gone through k roundings stands for all x
//! with
//!
//! ```text
//! |x - a| <= e_k A,   |a| <= A.
//! ```
//!
//! A double x is (x, |x|), with k = 0. Let (b, B) stand for y, with l roundings. 1 + e_k times 1 + e_l is 1 + e_(k+l), so the
//! sizes
//!
//! ```text
//! |x + y - (a + b)| <= e_max(k, l) (A + B)
//! |x y - a b| <= A e_l B + e_k A B + e_k A e_l B = e_(k+l) A B
//! |x/y - a/b| <= (e_k A + |a/b| e_l B) / (|b| - e_l B) <= e_(k+l) (A/|b|) r / (1 - e_l r)          r = B/|b|
//! |sqrt(x) - sqrt(a)| <= |x - a| / sqrt(a) <= e_k A / sqrt(a)                                   for x >= 0, a > 0
//! ```
//!
//! are A + B, A B, A r / |b| and A / sqrt(a), and each result is rounded once more: by u |m| at most, and by eta/2 for a product
//! or a quotient. The size of a sum loses a factor 1 - u, that of a product (1 - u)^2: (e_k + u) / (1 - u)^2 <= e_k + 2 u (1 +
//! e_k) = e_(k+1). To the size of a product 2^-1022 is added, of which e_1 is 2 eta. The size of a quotient and of a root has the
//! factor 1 + 2^-20 more, which covers its roundings and, as long as r <= 2^22 and k, l <= [`MOST`], 1 / (1 - e_l r); beyond, its
//! size is infinite. The size of a sum or product of doubles is rounded to no less than the double: |a| <= A.
//!
//! A number without a known bound has an infinite size, or one that is NaN.

use std::ops::{Add, Div, Mul, Neg, Sub};

use signorini_kernel::ball::centre_and_radius;
use signorini_kernel::{Ball, Enclosing, Scalar};

/// A number may go through so many roundings.
pub(crate) const MOST: u32 = 224;

/// Covers the roundings in the size of a quotient or a root.
const GROWTH: f64 = 1.0 + 1.0 / (1 << 20) as f64;

/// A divisor may be so many times smaller than the terms that it was computed from.
const CANCELLED: f64 = (1 << 22) as f64;

/// A double and the size of the terms that it was computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounded {
    value: f64,
    size: f64,
}

/// No less than e_k, for k <= [`MOST`]: (1 + 2 u)^k - 1 <= 2 u k (1 + 2 u k).
fn relative(roundings: u32) -> f64 {
    f64::EPSILON * (f64::from(roundings) + 1.0 / 1024.0)
}

impl Rounded {
    /// Nothing is known of it.
    const UNKNOWN: Rounded = Rounded { value: f64::NAN, size: f64::INFINITY };

    /// The numbers of a ball, as if they had gone through so many roundings k: 2 u k <= e_k.
    #[inline]
    pub(crate) fn of_ball(ball: Ball, roundings: u32) -> Rounded {
        let (value, radius) = centre_and_radius(ball);
        let size = value.abs();
        if radius == 0.0 {
            return Rounded { value, size };
        }
        let size = (size + radius / (f64::EPSILON * f64::from(roundings))) * GROWTH;
        Rounded { value, size: size + f64::MIN_POSITIVE }
    }

    /// x - y for the numbers of two balls, after so many roundings, but one at least.
    #[inline]
    pub(crate) fn difference(x: Ball, y: Ball, roundings: u32) -> Rounded {
        match (centre_and_radius(x), centre_and_radius(y)) {
            ((a, 0.0), (b, 0.0)) => Rounded::exactly(a - b),
            _ => Rounded::of_ball(x - y, roundings),
        }
    }

    /// The double.
    #[inline]
    pub(crate) fn value(self) -> f64 {
        self.value
    }

    /// An upper bound of its error, after so many roundings.
    #[inline]
    pub(crate) fn error(self, roundings: u32) -> f64 {
        // Rounded down by less than what `relative` has to spare, but where it underflows.
        relative(roundings) * self.size + f64::MIN_POSITIVE
    }

    /// All that it stands for, after so many roundings.
    pub(crate) fn to_ball(self, roundings: u32) -> Ball {
        Ball::around(self.value, self.error(roundings))
    }
}

impl From<i32> for Rounded {
    #[inline]
    fn from(value: i32) -> Rounded {
        Rounded::exactly(f64::from(value))
    }
}

impl Neg for Rounded {
    type Output = Rounded;

    #[inline]
    fn neg(self) -> Rounded {
        Rounded { value: -self.value, size: self.size }
    }
}

impl Add for Rounded {
    type Output = Rounded;

    #[inline]
    fn add(self, other: Rounded) -> Rounded {
        Rounded { value: self.value + other.value, size: self.size + other.size }
    }
}

impl Sub for Rounded {
    type Output = Rounded;

    #[inline]
    fn sub(self, other: Rounded) -> Rounded {
        Rounded { value: self.value - other.value, size: self.size + other.size }
    }
}

impl Mul for Rounded {
    type Output = Rounded;

    #[inline]
    fn mul(self, other: Rounded) -> Rounded {
        Rounded {
            value: self.value * other.value,
            size: self.size * other.size + f64::MIN_POSITIVE,
        }
    }
}

impl Div for Rounded {
    type Output = Rounded;

    #[inline]
    fn div(self, other: Rounded) -> Rounded {
        let ratio = other.size / other.value.abs();
        if !(ratio <= CANCELLED) {
            return Rounded::UNKNOWN;
        }
        let size = self.size / other.value.abs() * ratio * GROWTH;
        Rounded { value: self.value / other.value, size: size + f64::MIN_POSITIVE }
    }
}

signorini_kernel::entry_of_nalgebra!(Rounded);

impl Scalar for Rounded {
    /// The hull of both answers where the sign is open: the first, with a size that reaches to the other.
    fn split(
        self,
        nonpositive: impl FnOnce(Rounded) -> Rounded,
        positive: impl FnOnce(Rounded) -> Rounded,
    ) -> Rounded {
        if self.upper() <= 0.0 {
            nonpositive(self)
        } else if self.lower() <= 0.0 {
            let (a, b) = (nonpositive(self), positive(self));
            let apart = (a.value - b.value).abs() / f64::EPSILON;
            Rounded { value: a.value, size: (a.size.max(b.size) + apart) * GROWTH }
        } else {
            positive(self)
        }
    }
}

impl Enclosing for Rounded {
    #[inline]
    fn exactly(value: f64) -> Rounded {
        Rounded { value, size: value.abs() }
    }

    #[inline]
    fn sqrt(self) -> Rounded {
        if !(self.value > 0.0 && self.size <= CANCELLED * self.value) {
            return Rounded::UNKNOWN;
        }
        let root = self.value.sqrt();
        Rounded { value: root, size: self.size / root * GROWTH }
    }

    fn upper(self) -> f64 {
        self.to_ball(MOST).upper()
    }

    fn lower(self) -> f64 {
        self.to_ball(MOST).lower()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of many sizes, of either sign.
    fn number(k: i32) -> f64 {
        let x = f64::from((7919 * k) % 10007) / 10007.0 - 0.5;
        x * 10.0_f64.powi(k % 7 - 3)
    }

    /// A long expression, with cancellation.
    fn expression<S: Enclosing>(k: i32) -> S {
        let x = |i: i32| S::exactly(number(k + i));
        let product = (x(1) * x(2) - x(3) * x(4)) * (x(5) - x(6)) / (x(7) * x(7) + x(8) * x(8));
        let root = (x(9) * x(9) + S::from(1)).sqrt();
        product * root - (x(1) * x(2) - x(3) * x(4)) * root / (x(10) - x(11)) + S::from(3)
    }

    #[test]
    fn the_error_covers_what_doubles_are_off_by() {
        let mut off = 0;
        for k in 0..2000 {
            let (rounded, ball) = (expression::<Rounded>(k), expression::<Ball>(k));
            let (centre, radius) = centre_and_radius(ball);
            let (value, error) = (rounded.value(), rounded.error(MOST));
            assert!((value - centre).abs() <= error + radius, "{k}: {rounded:?}, {ball:?}");
            assert!(error >= radius / 8.0 && error <= 1e5 * radius, "{k}: {error}, {radius}");
            off += i32::from(value != centre);
            // By exact errors of single operations.
            let (x, y) = (number(k), number(k + 1));
            let [p, q] = [x, y].map(Rounded::exactly);
            let product = p * q;
            assert!(x.mul_add(y, -product.value).abs() <= product.error(1));
            let sum = p + q;
            let back = sum.value - x;
            let rest = (x - (sum.value - back)) + (y - back);
            assert!(rest.abs() <= sum.error(1));
            off += i32::from(rest != 0.0);
            if y != 0.0 {
                let quotient = p / q;
                let rest = quotient.value.mul_add(-y, x);
                assert!((rest / y).abs() <= quotient.error(1));
            }
        }
        // Without an error none of this would hold.
        assert!(off > 1000, "{off}");
    }

    #[test]
    fn a_radius_is_a_part_of_the_error() {
        let ball = Ball::around(3.0, 1e-10);
        for roundings in [1, 4, 32] {
            let error = Rounded::of_ball(ball, roundings).error(roundings);
            assert!((1e-10..1.1e-10).contains(&error), "{error}");
        }
        assert_eq!(Rounded::of_ball(Ball::point(-3.0), 4), Rounded::exactly(-3.0));
        let apart = Rounded::difference(Ball::point(0.3), Ball::point(0.1), 4);
        assert_eq!(apart, Rounded::exactly(0.3 - 0.1));
        let wide = Rounded::difference(ball, Ball::point(3.0), 4);
        assert!(wide.value() == 0.0 && wide.error(4) >= 1e-10);
    }

    #[test]
    fn nothing_is_known_of_what_cancels_in_a_divisor_or_a_root() {
        let x = Rounded::exactly(1.0) - Rounded::exactly(1.0 - f64::EPSILON);
        for unknown in [Rounded::from(1) / x, x.sqrt(), (-x).sqrt(), Rounded::from(1) / (x - x)] {
            assert!(!unknown.error(1).is_finite() && !(unknown.upper() <= 0.0));
            assert!(!((unknown + Rounded::from(1)) * Rounded::from(2)).error(1).is_finite());
        }
        let tiny = Rounded::exactly(1e-200) * Rounded::exactly(1e-200);
        assert!(tiny.lower() < 0.0 && tiny.upper() > 0.0);
    }

    #[test]
    fn an_open_sign_has_both_answers() {
        let near = Rounded::of_ball(Ball::around(0.5, 1.0), MOST);
        let positive = near.split(|_| Rounded::from(0), |x| x);
        assert!(positive.lower() <= 0.0 && positive.upper() >= 1.5);
        let split = |x: i32| Rounded::from(x).split(|_| Rounded::from(0), |x| x);
        assert_eq!([split(-2), split(2)], [Rounded::from(0), Rounded::from(2)]);
    }
}
