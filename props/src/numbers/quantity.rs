//! Numbers with a dimension: a formula is checked for its dimensions by running it on them.
//!
//! A dimension is stress^(i/2) length^(j/2), in halves because |v|_a is the square root of a work (per thickness:
//! stress length^2). Sums and comparisons of different dimensions are remembered until [`Quantity::check`] reports them;
//! the number 0 has every dimension, the other integers have none.

use std::cell::Cell;
use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use signorini::kernel::Scalar;

use super::Exact;

/// Twice the exponents of stress and length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension(i8, i8);

impl Dimension {
    /// Of a ratio.
    pub const NUMBER: Dimension = Dimension(0, 0);
    /// Of a displacement.
    pub const LENGTH: Dimension = Dimension(0, 2);
    /// Of sigma_n.
    pub const STRESS: Dimension = Dimension(2, 0);
    /// Of gamma.
    pub const GAMMA: Dimension = Dimension(-2, 2);
    /// Of a(v, v).
    pub const WORK: Dimension = Dimension(2, 4);
    /// Of |v|_a, |s|_g.
    pub const NORM: Dimension = Dimension(1, 2);

    /// Of a product.
    fn times(self, other: Dimension) -> Dimension {
        Dimension(self.0 + other.0, self.1 + other.1)
    }

    /// Of a quotient.
    fn per(self, other: Dimension) -> Dimension {
        Dimension(self.0 - other.0, self.1 - other.1)
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "stress^({}/2) length^({}/2)", self.0, self.1)
    }
}

thread_local! {
    static MISMATCH: Cell<Option<[Dimension; 2]>> = const { Cell::new(None) };
}

/// An exact number with its dimension, which only a 0 may leave open.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    value: Exact,
    dimension: Option<Dimension>,
}

impl Quantity {
    /// A number of this dimension.
    pub fn new(value: Exact, dimension: Dimension) -> Quantity {
        Quantity { value, dimension: Some(dimension) }
    }

    /// The result of `work`.
    ///
    /// # Errors
    /// The first two dimensions that were added or compared and differ.
    pub fn check<T>(work: impl FnOnce() -> T) -> Result<T, [Dimension; 2]> {
        MISMATCH.set(None);
        let result = work();
        MISMATCH.take().map_or(Ok(result), Err)
    }

    /// The dimension of both, as a sum or a comparison needs it.
    fn common(self, other: Quantity) -> Option<Dimension> {
        if let (Some(a), Some(b)) = (self.dimension, other.dimension)
            && a != b
            && MISMATCH.get().is_none()
        {
            MISMATCH.set(Some([a, b]));
        }
        self.dimension.or(other.dimension)
    }
}

impl From<i32> for Quantity {
    fn from(value: i32) -> Quantity {
        let dimension = (value != 0).then_some(Dimension::NUMBER);
        Quantity { value: Exact::from(value), dimension }
    }
}

impl Add for Quantity {
    type Output = Quantity;

    fn add(self, other: Quantity) -> Quantity {
        Quantity { value: self.value + other.value, dimension: self.common(other) }
    }
}

impl Sub for Quantity {
    type Output = Quantity;

    fn sub(self, other: Quantity) -> Quantity {
        Quantity { value: self.value - other.value, dimension: self.common(other) }
    }
}

impl Mul for Quantity {
    type Output = Quantity;

    fn mul(self, other: Quantity) -> Quantity {
        let dimension = self.dimension.zip(other.dimension).map(|(a, b)| a.times(b));
        Quantity { value: self.value * other.value, dimension }
    }
}

impl Div for Quantity {
    type Output = Quantity;

    fn div(self, other: Quantity) -> Quantity {
        let dimension = self.dimension.zip(other.dimension).map(|(a, b)| a.per(b));
        Quantity { value: self.value / other.value, dimension }
    }
}

impl Neg for Quantity {
    type Output = Quantity;

    fn neg(self) -> Quantity {
        Quantity { value: -self.value, ..self }
    }
}

impl PartialEq for Quantity {
    fn eq(&self, other: &Quantity) -> bool {
        self.common(*other);
        self.value == other.value
    }
}

impl PartialOrd for Quantity {
    fn partial_cmp(&self, other: &Quantity) -> Option<Ordering> {
        self.common(*other);
        self.value.partial_cmp(&other.value)
    }
}

signorini::entry_of_nalgebra!(Quantity);

impl Scalar for Quantity {
    fn split(
        self,
        nonpositive: impl FnOnce(Quantity) -> Quantity,
        positive: impl FnOnce(Quantity) -> Quantity,
    ) -> Quantity {
        if self.value <= Exact::from(0) { nonpositive(self) } else { positive(self) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: i32, dimension: Dimension) -> Quantity {
        Quantity::new(Exact::from(value), dimension)
    }

    fn differ<T>(work: impl FnOnce() -> T) -> bool {
        Quantity::check(work).is_err()
    }

    #[test]
    fn sums_and_comparisons_need_one_dimension() {
        Exact::scope(|| {
            let (u, s) = (of(2, Dimension::LENGTH), of(3, Dimension::STRESS));
            assert!(differ(|| u + s) && differ(|| u - s) && differ(|| u == s) && differ(|| u < s));
            assert!(!differ(|| u + u) && !differ(|| u <= u));
            let one = Quantity::from(1);
            assert!(differ(|| u + one) && !differ(|| u + Quantity::from(0)));
        });
    }

    #[test]
    fn products_and_quotients_have_their_dimension() {
        Exact::scope(|| {
            let (u, s) = (of(2, Dimension::LENGTH), of(3, Dimension::STRESS));
            let (gamma, norm) = (of(5, Dimension::GAMMA), of(7, Dimension::NORM));
            assert!(!differ(|| u - gamma * s) && !differ(|| u / s == gamma));
            assert!(!differ(|| norm * norm == s * u * u) && !differ(|| u / u == Quantity::from(1)));
            assert!(!differ(|| norm * norm - of(1, Dimension::WORK)));
            assert!(differ(|| u - gamma / s) && differ(|| norm == s * u));
        });
    }

    #[test]
    fn the_sign_decides_a_split_and_the_first_mismatch_is_reported() {
        Exact::scope(|| {
            for (value, expected) in [(-1, 10), (0, 10), (1, 20)] {
                let part = of(value, Dimension::LENGTH).split(|_| 10.into(), |_| 20.into());
                assert!(part == Quantity::from(expected));
            }
            let (u, s) = (of(2, Dimension::LENGTH), of(3, Dimension::STRESS));
            let twice = Quantity::check(|| (u + s, s + u * u));
            assert!(twice.is_err_and(|found| found == [Dimension::LENGTH, Dimension::STRESS]));
        });
    }
}
