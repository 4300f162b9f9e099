//! What holds the body: rigid motions, whether supports and contact stop them, what is left free, and corners held where they cannot be.

pub(crate) mod clearance;
pub(crate) mod corners;
pub(crate) mod grip;
pub(crate) mod holding;
#[doc(hidden)]
pub mod rigid;
#[doc(hidden)]
pub mod solvability;

pub use rigid::{FreeMotion, Parts};
