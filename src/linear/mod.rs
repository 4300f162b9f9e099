//! Matrices: A and its pattern, the order of elimination, the factor, the compliance of contact edges, small dense algebra.

pub(crate) mod cholesky;
pub(crate) mod compliance;
pub(crate) mod dense;
pub mod factor;
pub mod matrix;
mod numeric;
pub mod ordering;
pub mod system;
