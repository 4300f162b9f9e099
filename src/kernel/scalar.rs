//! The numbers that the kernel computes with, and the one question that it asks of them: positive or not?
//!
//! There is no order here on purpose. `if a > 0` is unsound for an interval (an undecided sign counts as "no") and loses
//! a NaN; [`Scalar::split`] leaves the decision to the number type, which knows.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of the kernel: the field operations, small integer constants, and one sign question.
///
/// Doubles, exact rationals, symbols and intervals implement it.
pub trait Scalar:
    Copy
    + From<i32>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// `nonpositive(self)` if `self <= 0`, else `positive(self)`. A NaN, not being `<= 0`, goes to `positive`, so that it
    /// survives; -0 goes to `nonpositive`. A number whose sign is undecided (an interval across zero) is cut at zero and
    /// gets the hull of both answers.
    fn split(
        self,
        nonpositive: impl FnOnce(Self) -> Self,
        positive: impl FnOnce(Self) -> Self,
    ) -> Self;
}

impl Scalar for f64 {
    fn split(self, nonpositive: impl FnOnce(f64) -> f64, positive: impl FnOnce(f64) -> f64) -> f64 {
        if self <= 0.0 { nonpositive(self) } else { positive(self) }
    }
}

/// a . b
pub fn dot<S: Scalar>(a: [S; 2], b: [S; 2]) -> S {
    a[0] * b[0] + a[1] * b[1]
}
