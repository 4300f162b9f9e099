//! Numbers that enclose a real one, and what may be concluded from them: the comparisons of the checker of certificates. A
//! conclusion holds for every number that is enclosed; where nothing is known, and of a NaN, nothing is concluded.

use super::{Ball, Scalar};

/// A number that stands for a real one: a double for a quick look, a ball or an interval for a proof, a rational for the
/// truth.
pub trait Enclosing: Scalar {
    /// This double.
    fn exactly(value: f64) -> Self;

    /// The root of what is not negative.
    fn sqrt(self) -> Self;

    /// A double that it doesn't exceed.
    fn upper(self) -> f64;

    /// A double that it is not below.
    fn lower(self) -> f64;

    /// A ball around it.
    #[inline]
    fn ball(self) -> Ball {
        Ball::between(self.lower(), self.upper())
    }

    /// [`Enclosing::lower`] and [`Enclosing::upper`].
    #[inline]
    fn ends(self) -> [f64; 2] {
        [self.lower(), self.upper()]
    }

    /// An upper bound of its magnitude.
    #[inline]
    fn size(self) -> f64 {
        self.upper().max(-self.lower())
    }

    /// Returns whether it is known to be positive.
    #[inline]
    fn is_positive(self) -> bool {
        self.lower() > 0.0
    }

    /// Returns whether it is known to be no more than `most`.
    #[inline]
    fn is_at_most(self, most: f64) -> bool {
        self.upper() <= most
    }
}

impl Enclosing for f64 {
    #[inline]
    fn exactly(value: f64) -> f64 {
        value
    }

    #[inline]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline]
    fn upper(self) -> f64 {
        self
    }

    #[inline]
    fn lower(self) -> f64 {
        self
    }
}
