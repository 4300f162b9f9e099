//! The contact term of (8): pieces of Gamma_C with their direction, gap, gamma and law; kappa; pairs of deformable bodies; and the
//! discretization that holds all of (8).

pub mod contact_line;
pub mod discretization;
pub(crate) mod friction;
mod hoop;
pub(crate) mod law;
pub mod moments;
pub mod piece;
pub mod residual;
pub(crate) mod stress_points;

pub use contact_line::ContactLine;
pub use discretization::Discretization;
pub use law::EdgeRule;
pub use piece::Piece;

pub use crate::model::law::{Bound, Friction, Law};
pub use crate::model::pairs::{Pair, PairError};
