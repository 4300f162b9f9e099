//! What goes in and out: case files, Gmsh meshes, VTU, SVG, JSON.

pub mod case;
pub mod convergence;
pub mod csv;
pub mod data;
mod exact;
pub mod expression;
pub mod files;
pub mod gmsh;
pub mod input;
pub mod numbers;
pub mod outputs;
pub mod picture;
pub mod plot;
pub mod result;
mod table;
pub mod vtu;

pub use case::{Case, CaseError};
pub use expression::{Expression, ExpressionError};
pub use gmsh::GmshError;
