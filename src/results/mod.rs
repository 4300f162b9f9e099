//! The results: displacement, stresses, contact pressure, resultants, energies, each with its interval, and the verdict.

pub mod answers;
pub(crate) mod report;
#[doc(hidden)]
pub mod solution;
pub(crate) mod stresses;
pub(crate) mod whole;

pub use answers::{ContactBoundary, EnergyBalance};
pub use report::{MethodReport, NewtonReport, Report, RouteName, Status, Verdict};
pub use solution::{GammaReport, Quantities, Solution};
pub use stresses::{Extreme, LargestStresses};
