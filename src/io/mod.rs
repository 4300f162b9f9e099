//! Input and output: case files, Gmsh meshes, VTU, SVG, JSON.

#[cfg(feature = "files")]
pub mod body;
#[cfg(feature = "files")]
mod boundaries;
#[cfg(feature = "files")]
pub mod case;
#[cfg(feature = "files")]
pub mod certificate;
#[cfg(feature = "files")]
pub mod convergence;
pub mod csv;
pub mod data;
#[cfg(feature = "files")]
mod exact;
pub mod expression;
#[cfg(feature = "files")]
pub mod field;
pub mod fields;
pub mod files;
pub mod gmsh;
pub mod input;
#[cfg(feature = "files")]
mod meshed;
#[cfg(feature = "files")]
mod method;
#[cfg(feature = "files")]
mod mistake;
pub mod numbers;
#[cfg(feature = "files")]
pub mod outputs;
#[cfg(feature = "files")]
pub mod picture;
#[cfg(feature = "files")]
pub mod plot;
#[cfg(feature = "files")]
pub mod report;
#[cfg(feature = "files")]
pub mod result;
#[cfg(feature = "files")]
pub mod run;
#[cfg(feature = "files")]
mod setting;
#[cfg(feature = "files")]
mod source;
#[cfg(feature = "files")]
pub mod summary;
#[cfg(feature = "files")]
pub mod sweep;
#[cfg(feature = "files")]
mod table;
pub mod vtu;

#[cfg(feature = "files")]
pub use case::{Case, CaseError};
pub use expression::{Expression, ExpressionError};
pub use gmsh::GmshError;
