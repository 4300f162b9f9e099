//! Input and output: case files, Gmsh meshes, VTU, SVG, JSON.

#[cfg(feature = "files")]
#[doc(hidden)]
pub mod body;
#[cfg(feature = "files")]
mod boundaries;
#[cfg(feature = "files")]
pub mod case;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod certificate;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod convergence;
#[doc(hidden)]
pub mod csv;
#[doc(hidden)]
pub mod data;
#[cfg(feature = "files")]
mod exact;
pub mod expression;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod field;
#[doc(hidden)]
pub mod fields;
#[doc(hidden)]
pub mod files;
#[doc(hidden)]
pub mod gmsh;
#[doc(hidden)]
pub mod input;
#[cfg(feature = "files")]
mod meshed;
#[cfg(feature = "files")]
mod method;
#[doc(hidden)]
pub mod numbers;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod outputs;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod picture;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod plot;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod report;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod result;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod run;
#[cfg(feature = "files")]
mod source;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod summary;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod sweep;
#[cfg(feature = "files")]
mod table;
#[doc(hidden)]
pub mod vtu;

#[cfg(feature = "files")]
pub use case::Case;
pub use expression::{Expression, ExpressionError};
pub use input::{FileError, InputError};
