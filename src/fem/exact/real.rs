//! The numbers in which an exact solution can be written that needs square roots: doubles, and numbers that enclose them.

use crate::kernel::{Interval, Scalar};

/// A [`Scalar`] with a square root.
pub trait Real: Scalar {
    /// The square root.
    fn sqrt(self) -> Self;

    /// One of two ways to write the same smooth function: the first rounds better where `self <= 0`, the second where
    /// `self > 0`. Unlike the answers of [`Scalar::split`] either may stand for the other, so that a number whose sign is
    /// undecided takes the second.
    fn by_sign<T>(self, nonpositive: impl FnOnce(Self) -> T, positive: impl FnOnce(Self) -> T)
    -> T;
}

impl Real for f64 {
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    fn by_sign<T>(self, nonpositive: impl FnOnce(f64) -> T, positive: impl FnOnce(f64) -> T) -> T {
        if self <= 0.0 { nonpositive(self) } else { positive(self) }
    }
}

impl Real for Interval {
    fn sqrt(self) -> Interval {
        Interval::sqrt(self)
    }

    fn by_sign<T>(
        self,
        nonpositive: impl FnOnce(Interval) -> T,
        positive: impl FnOnce(Interval) -> T,
    ) -> T {
        if self.hi() <= 0.0 { nonpositive(self) } else { positive(self) }
    }
}
