//! The discrete space V^h on a mesh and everything that is integrated over it.

pub mod mesh;
pub mod problem;
pub mod rectangle;

pub use mesh::{BoundaryEdge, Mesh, MeshError};
pub use problem::{BoxedFunction, Condition, Function, Problem};
pub use rectangle::{Diagonal, Rectangle};
