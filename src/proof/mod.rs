//! The proof of a solve: (8) in balls, the enclosure of its solution, Korn's inequality with a constant, theorem 7 for Coulomb.

#[doc(hidden)]
pub mod balls;
#[doc(hidden)]
pub mod enclosure;
#[doc(hidden)]
pub mod intervals;
pub(crate) mod isolated;
#[doc(hidden)]
pub mod korn;
#[doc(hidden)]
pub mod pressed;
mod products;
#[doc(hidden)]
pub mod rounded_stress;

pub use enclosure::{Enclosure, Unproved};
pub use intervals::Intervals;
