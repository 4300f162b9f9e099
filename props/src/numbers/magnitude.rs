//! How large the terms of a number are: every sum and difference adds the magnitudes of its terms. A formula that is run
//! with these numbers yields the sum of the magnitudes of all products that it would have if it were multiplied out.
//!
//! What a double computation of that formula may be off, to first order, is this sum times the unit roundoff 2^-53 times
//! the number of roundings on the longest way from the data to the result. For a product and a quotient the relative
//! errors add up; with the magnitude of 1/b taken as |b|_sum / b^2, so do the products of magnitudes.

use std::cmp::Ordering;

/// A number with the sum of the magnitudes of its terms.
#[derive(Clone, Copy, Debug)]
pub struct Magnitude {
    value: f64,
    sum: f64,
    /// A coordinate: the difference of two is rounded once, whatever their size.
    coordinate: bool,
}

impl Magnitude {
    /// Of a double that is given.
    pub fn of_double(value: f64) -> Magnitude {
        Magnitude { value, sum: value.abs(), coordinate: false }
    }

    /// Of a coordinate of a vertex.
    pub fn of_coordinate(value: f64) -> Magnitude {
        Magnitude { coordinate: true, ..Magnitude::of_double(value) }
    }

    /// The sum of the magnitudes.
    pub fn sum(self) -> f64 {
        self.sum
    }
}

impl From<i32> for Magnitude {
    fn from(value: i32) -> Magnitude {
        Magnitude::of_double(f64::from(value))
    }
}

impl PartialEq for Magnitude {
    fn eq(&self, other: &Magnitude) -> bool {
        self.sum == other.sum
    }
}

/// By magnitude, so that nothing is negative and \[.\]+ cuts nothing away: |\[a\]+ - \[b\]+| <= |a - b|, so an error of P is
/// an error of \[P\]+ of at most that size, wherever the root of P lies.
impl PartialOrd for Magnitude {
    fn partial_cmp(&self, other: &Magnitude) -> Option<Ordering> {
        self.sum.partial_cmp(&other.sum)
    }
}

super::number! { Magnitude:
    + |a, b| Magnitude { value: a.value + b.value, sum: a.sum + b.sum, coordinate: false };
    - |a, b| match a.coordinate && b.coordinate {
        true => Magnitude::of_double(a.value - b.value),
        false => a + -b,
    };
    * |a, b| Magnitude { value: a.value * b.value, sum: a.sum * b.sum, coordinate: false };
    / |a, b| {
        let sum = a.sum * b.sum / (b.value * b.value);
        Magnitude { value: a.value / b.value, sum, coordinate: false }
    };
    neg |a| Magnitude { value: -a.value, coordinate: false, ..a };
    nonpositive |a| a.sum <= 0.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_add_magnitudes_and_quotients_know_how_well_their_divisor_is_known() {
        let [a, b] = [5.0, 3.0].map(Magnitude::of_double);
        assert_eq!(((a - b) * b).sum(), 24.0);
        assert_eq!((a / (a - b)).sum(), 5.0 * 8.0 / 4.0);
        let [x, y] = [5.0, 3.0].map(Magnitude::of_coordinate);
        assert_eq!((x - y).sum(), 2.0);
        assert_eq!((x - b).sum(), 8.0);
        assert!(-a > b);
    }
}
