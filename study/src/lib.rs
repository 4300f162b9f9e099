//! Evidence on exact solutions: how far discrete solutions are from them, the bounds of section 3.3 beside the errors, and the
//! rates on finer and finer meshes. Solutions with friction are here, the others in [`signorini::exact`]. The solver does not depend on this crate; its tests and the claims do.

#![cfg(not(kani))]

pub mod a_priori;
pub mod convergence;
pub mod document;
pub mod interpolation;
pub mod ladder;
mod slip_tip;
mod stick_slip;
pub mod theorem;
mod unsolved;

pub use ladder::{Ladder, LadderError, Level, problem};
pub use slip_tip::SlipTip;
pub use stick_slip::StickSlip;
pub use theorem::Theorem;
pub use unsolved::unsolved;
