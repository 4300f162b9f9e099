//! What goes in and out: case files, Gmsh meshes, VTU, SVG, JSON.

pub mod body;
mod boundaries;
pub mod case;
pub mod convergence;
pub mod csv;
pub mod data;
mod exact;
pub mod expression;
pub mod files;
pub mod gmsh;
pub mod numbers;
pub mod outputs;
pub mod picture;
pub mod plot;
mod quote;
pub mod result;
mod table;
pub mod vtu;

use std::io;

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
