//! What goes in and out: case files, Gmsh meshes, VTU, SVG, JSON.

pub mod expression;
mod quote;

pub use expression::{Expression, ExpressionError};
