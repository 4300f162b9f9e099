//! The positive part \[a\]+ of section 2.2 and the derivative that Newton's method uses for it.
//!
//! Exact in every number type: a sign test and no arithmetic. -0 gives +0. A NaN stays a NaN, for a NaN must not become
//! "no contact". An interval across zero gives \[0, hi\].

use super::Scalar;

/// \[a\]+ = a if a > 0, else 0. A NaN stays a NaN.
pub fn positive_part<S: Scalar>(a: S) -> S {
    a.split(|_| S::from(0), |a| a)
}

/// The derivative of \[a\]+ that Newton's method uses: 1 for a > 0, 0 for a <= 0, and 1 for a NaN (which \[.\]+ itself
/// hands on). At a = 0, where \[.\]+ has a kink, any value in \[0, 1\] would serve: the energy J_h doesn't depend on it.
pub fn positive_part_slope<S: Scalar>(a: S) -> S {
    a.split(|_| S::from(0), |_| S::from(1))
}
