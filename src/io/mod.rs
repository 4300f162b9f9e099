//! What goes in and out: case files, Gmsh meshes, VTU, SVG, JSON.

#[cfg(feature = "files")]
pub mod case;
#[cfg(feature = "files")]
pub mod convergence;
pub mod csv;
pub mod data;
#[cfg(feature = "files")]
mod exact;
pub mod expression;
pub mod files;
pub mod gmsh;
pub mod numbers;
#[cfg(feature = "files")]
pub mod outputs;
#[cfg(feature = "files")]
pub mod picture;
#[cfg(feature = "files")]
pub mod plot;
#[cfg_attr(not(feature = "files"), allow(dead_code, reason = "lists are for case files alone"))]
mod quote;
#[cfg(feature = "files")]
pub mod result;
#[cfg(feature = "files")]
mod setting;
#[cfg(feature = "files")]
pub mod sweep;
#[cfg(feature = "files")]
mod table;
pub mod vtu;

use std::io;

#[cfg(feature = "files")]
pub use case::{Case, CaseError};
pub use expression::{Expression, ExpressionError};
pub use gmsh::GmshError;

/// Why a file can't be read, in words that don't depend on the system where that is possible.
fn why_unreadable(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        io::ErrorKind::IsADirectory => "this is a directory; expected a file".to_owned(),
        io::ErrorKind::PermissionDenied => "there is no permission to read this file".to_owned(),
        _ => error.to_string(),
    }
}
