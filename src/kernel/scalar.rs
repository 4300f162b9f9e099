//! The numbers that the kernel computes with, and the one question that it asks of them: positive or not?
//!
//! There is no order here on purpose. `if a > 0` is unsound for an interval (an undecided sign counts as "no") and loses
//! a NaN; [`Scalar::split`] leaves the decision to the number type, which knows.
//!
//! Vectors and matrices are nalgebra's. Of these the kernel uses what is the same formula in every number type: entries,
//! sums, differences, multiples, and dot products of two or three components. nalgebra's matrix products, traces and longer
//! dot products start from 0 or multiply by 1, which costs an interval its sharpness; the product of a
//! transposed matrix is made of dot products and does not.

use std::ops::Neg;

pub use num_traits::{One, Zero};

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};

/// A number of the kernel: the field operations, small integer constants, and one sign question.
///
/// Doubles, exact rationals, symbols and intervals implement it. The other bounds are what nalgebra asks of the entries of
/// its vectors; [`entry_of_nalgebra!`](crate::entry_of_nalgebra) answers it for a type with the operators. nalgebra also
/// asks for `PartialEq`; the kernel compares nothing.
pub trait Scalar:
    nalgebra::Scalar
    + Copy
    + From<i32>
    + Zero
    + One
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
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

/// Makes a `Copy` type with `+ - * /`, `From<i32>` and `PartialEq` an entry of nalgebra's vectors: the operators that
/// assign, by those that it has, and the numbers 0 and 1.
#[macro_export]
macro_rules! entry_of_nalgebra {
    ($number:ty) => {
        $crate::entry_of_nalgebra!($number, AddAssign add_assign +);
        $crate::entry_of_nalgebra!($number, SubAssign sub_assign -);
        $crate::entry_of_nalgebra!($number, MulAssign mul_assign *);
        $crate::entry_of_nalgebra!($number, DivAssign div_assign /);

        impl $crate::scalar::Zero for $number {
            #[inline]
            fn zero() -> Self {
                <$number>::from(0)
            }

            #[inline]
            fn is_zero(&self) -> bool {
                *self == <$number>::from(0)
            }
        }

        impl $crate::scalar::One for $number {
            #[inline]
            fn one() -> Self {
                <$number>::from(1)
            }
        }
    };
    ($number:ty, $operator:ident $function:ident $sign:tt) => {
        impl std::ops::$operator for $number {
            #[inline]
            fn $function(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
    };
}
