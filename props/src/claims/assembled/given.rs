//! The doubles of a problem read as other numbers, without error.

use crate::numbers::{Exact, Magnitude};
use crate::verdict::Ordered;

/// A number that a double can be read as.
pub(crate) trait Given: Ordered {
    /// The value of a double.
    fn given(value: f64) -> Self;

    /// The same of a coordinate of a vertex.
    fn coordinate(value: f64) -> Self {
        Self::given(value)
    }
}

impl Given for Exact {
    fn given(value: f64) -> Exact {
        Exact::of_double(value)
    }
}

impl Given for Magnitude {
    fn given(value: f64) -> Magnitude {
        Magnitude::of_double(value)
    }

    fn coordinate(value: f64) -> Magnitude {
        Magnitude::of_coordinate(value)
    }
}

pub(crate) fn read<S: Given>(field: &[[f64; 2]]) -> Vec<[S; 2]> {
    field.iter().map(|v| v.map(S::given)).collect()
}
