//! The number types of the engines: exact rationals, and integers for the model checker.

#[cfg(not(kani))]
pub mod exact;
pub mod whole;

#[cfg(not(kani))]
pub use exact::Exact;
pub use whole::Whole;
