//! The proof of a solve: (8) in balls, the enclosure of its solution, Korn's inequality with a constant, theorem 7 for Coulomb.

pub mod balls;
mod columns;
pub mod enclosure;
pub mod intervals;
pub(crate) mod isolated;
pub mod korn;
pub mod pressed;
mod products;
pub mod rounded_stress;

pub use enclosure::{Enclosure, Unproved};
pub use intervals::Intervals;
