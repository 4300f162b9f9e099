//! The number types of the engines: exact rationals, magnitudes for the bounds of rounding errors, and
//! integers for the model checker.

#[cfg(not(kani))]
pub mod exact;
#[cfg(not(kani))]
pub mod magnitude;
pub mod whole;

#[cfg(not(kani))]
pub use exact::Exact;
#[cfg(not(kani))]
pub use magnitude::Magnitude;
pub use whole::Whole;
