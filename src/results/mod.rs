//! The results: displacement, stresses, contact pressure, resultants, energies, each with its interval, and the verdict.

pub mod answers;
pub(crate) mod report;
pub(crate) mod solution;
pub(crate) mod stresses;
pub(crate) mod whole;

pub use answers::{BoundaryFriction, ContactBoundary, EnergyBalance};
pub use report::{MethodReport, NewtonReport, Report, RouteName, Status, Verdict};
pub use solution::{ContactEdge, ContactPoint, GammaReport, Quantities, Solution};

pub use crate::held::solvability::Play;
pub use stresses::{Extreme, LargestStresses};
