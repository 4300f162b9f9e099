//! Integers as numbers of the kernel, for the model checker: exact, and within its reach where doubles are not.
//!
//! Only for code that divides by nothing, or by a divisor that leaves no remainder; anything else panics, and so does
//! an overflow.

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

super::number! { Whole:
    + |a, b| Whole(a.0 + b.0);
    - |a, b| Whole(a.0 - b.0);
    * |a, b| Whole(a.0 * b.0);
    / |a, b| {
        let quotient = a.0 / b.0;
        assert!(quotient * b.0 == a.0);
        Whole(quotient)
    };
    neg |a| Whole(-a.0);
    nonpositive |a| a.0 <= 0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_divide_without_remainder() {
        assert_eq!(Whole(12) / Whole(-3), Whole(-4));
    }

    #[test]
    #[should_panic(expected = "quotient * b.0 == a.0")]
    fn a_remainder_panics() {
        let _ = Whole(7) / Whole(2);
    }
}
