//! Evidence on exact solutions: how far a solution is from one, the bounds of section 3.3 beside it, and the rates on finer and
//! finer meshes. Nothing that solves depends on it.

pub mod a_priori;
pub mod errors;
pub mod exact;
pub mod interpolation;
pub mod ladder;
pub mod theorem;

pub use errors::Errors;
pub use exact::{Exact, ExactSolution};
pub use ladder::{Ladder, LadderError, Level};
pub use theorem::Theorem;
