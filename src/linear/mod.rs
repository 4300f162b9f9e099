//! Matrices: A and its pattern, the order of elimination, the factor, the compliance of contact edges, small dense algebra.

pub(crate) mod cholesky;
pub(crate) mod compliance;
pub(crate) mod dense;
#[doc(hidden)]
pub mod factor;
pub mod matrix;
mod numeric;
#[doc(hidden)]
pub mod ordering;
#[doc(hidden)]
pub mod system;
