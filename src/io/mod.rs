//! Input and output: case files, Gmsh meshes, VTU, SVG, JSON.

#[cfg(feature = "files")]
pub mod case;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod certificate;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod checked;
mod csv;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod draft;
pub mod expression;
#[doc(hidden)]
pub mod field;
mod fields;
#[doc(hidden)]
pub mod files;
#[doc(hidden)]
pub mod gmsh;
pub(crate) mod input;
#[cfg(feature = "files")]
mod numbers;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod outputs;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod picture;
#[doc(hidden)]
pub mod raw_mesh;
#[cfg(feature = "files")]
mod remarks;
#[cfg(feature = "files")]
mod report;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod result;
#[cfg(feature = "files")]
mod revolution;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod run;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod steps;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod summary;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod sweep;
mod vtu;

#[cfg(feature = "files")]
pub use case::Case;
pub use expression::{Expression, ExpressionError};
pub use input::{Failure, FileError};
