//! Integers as numbers of the kernel, for the model checker: exact, and within its reach where doubles are not.
//!
//! Only for code that divides by nothing, or by a divisor that leaves no remainder; anything else panics, and so does
//! an overflow.

use std::ops::{Add, Div, Mul, Neg, Sub};

use signorini::kernel::Scalar;

/// An integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Whole(
    /// Its value.
    pub i32,
);

impl From<i32> for Whole {
    fn from(value: i32) -> Whole {
        Whole(value)
    }
}

impl Add for Whole {
    type Output = Whole;

    fn add(self, other: Whole) -> Whole {
        Whole(self.0 + other.0)
    }
}

impl Sub for Whole {
    type Output = Whole;

    fn sub(self, other: Whole) -> Whole {
        Whole(self.0 - other.0)
    }
}

impl Mul for Whole {
    type Output = Whole;

    fn mul(self, other: Whole) -> Whole {
        Whole(self.0 * other.0)
    }
}

impl Div for Whole {
    type Output = Whole;

    fn div(self, other: Whole) -> Whole {
        let quotient = self.0 / other.0;
        assert!(quotient * other.0 == self.0);
        Whole(quotient)
    }
}

impl Neg for Whole {
    type Output = Whole;

    fn neg(self) -> Whole {
        Whole(-self.0)
    }
}

signorini::entry_of_nalgebra!(Whole);

impl Scalar for Whole {
    fn split(
        self,
        nonpositive: impl FnOnce(Whole) -> Whole,
        positive: impl FnOnce(Whole) -> Whole,
    ) -> Whole {
        if self.0 <= 0 { nonpositive(self) } else { positive(self) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_divide_without_remainder() {
        assert_eq!(Whole(12) / Whole(-3), Whole(-4));
    }

    #[test]
    #[should_panic(expected = "quotient * other.0 == self.0")]
    fn a_remainder_panics() {
        let _ = Whole(7) / Whole(2);
    }
}
