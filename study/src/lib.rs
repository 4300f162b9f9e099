//! Evidence on exact solutions: how far discrete solutions are from them, the bounds of section 3.3 beside the errors, and the
//! rates on finer and finer meshes. The solver does not depend on this crate; its tests and the claims do.

#![cfg(not(kani))]

pub mod a_priori;
pub mod convergence;
pub mod document;
pub mod interpolation;
pub mod ladder;
pub mod theorem;

pub use ladder::{Ladder, LadderError, Level};
pub use theorem::Theorem;
