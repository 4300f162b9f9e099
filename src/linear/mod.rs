//! Matrices: A and its pattern, the order of elimination, the factor, the compliance of contact edges, small dense algebra.

pub(crate) mod cholesky;
pub(crate) mod compliance;
pub(crate) mod dense;
mod entries;
pub mod factor;
pub mod matrix;
mod numeric;
pub mod ordering;
pub mod system;

/// Evaluates an expression with the instructions of the processor at hand: fewer than with those that every one has.
macro_rules! on_this_processor {
    ($expression:expr) => {
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || $expression,
        )
    };
}
pub(crate) use on_this_processor;
