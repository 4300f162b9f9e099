//! The number types of the engines: exact rationals, intervals of doubles, magnitudes for the bounds of
//! rounding errors, and integers for the model checker.

#[cfg(not(kani))]
pub mod exact;
pub mod interval;
#[cfg(not(kani))]
pub mod magnitude;
pub mod whole;

#[cfg(not(kani))]
pub use exact::Exact;
pub use interval::Interval;
#[cfg(not(kani))]
pub use magnitude::Magnitude;
pub use whole::Whole;
