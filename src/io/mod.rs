//! Input and output: case files, Gmsh meshes, VTU, SVG, JSON.

#[cfg(feature = "files")]
pub(crate) mod case;
#[cfg(feature = "files")]
pub mod certificate;
#[cfg(feature = "cli")]
pub(crate) mod checked;
mod csv;
#[cfg(feature = "cli")]
pub(crate) mod draft;
pub(crate) mod expression;
#[cfg(feature = "cli")]
pub(crate) mod field;
mod fields;
pub(crate) mod files;
pub mod gmsh;
pub(crate) mod input;
#[cfg(feature = "files")]
mod numbers;
#[cfg(feature = "files")]
pub mod outputs;
#[cfg(feature = "files")]
pub mod picture;
pub mod raw_mesh;
#[cfg(feature = "files")]
mod remarks;
#[cfg(feature = "files")]
mod report;
#[cfg(feature = "files")]
pub mod result;
#[cfg(feature = "files")]
mod revolution;
#[cfg(feature = "files")]
pub mod run;
#[cfg(feature = "cli")]
pub(crate) mod steps;
#[cfg(feature = "files")]
pub mod summary;
#[cfg(feature = "cli")]
pub(crate) mod sweep;
mod vtu;

#[cfg(feature = "files")]
pub use case::Case;
pub use expression::{Expression, ExpressionError};
pub use files::{NotFinite, Output, spare};
pub use input::{Failure, FileError};

pub use crate::quote::lines as printable;
