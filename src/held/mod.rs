//! Supports and contact that hold the body: rigid motions, whether these are stopped, which of them are left free, and corners held where they
//! cannot be.

pub(crate) mod clearance;
pub(crate) mod corners;
pub(crate) mod grip;
pub(crate) mod holding;
pub(crate) mod solvability;
