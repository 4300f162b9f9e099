//! The discrete space V^h on a mesh and everything that is integrated over it.

pub mod constraints;
pub mod contact_line;
pub mod discretization;
pub mod loads;
pub mod matrix;
pub mod mesh;
pub mod problem;
pub mod quadrature;
pub mod rectangle;
pub mod space;

pub use discretization::Discretization;
pub use mesh::{BoundaryEdge, Mesh, MeshError};
pub use problem::{BoxedFunction, Condition, DataError, Function, Problem};
pub use rectangle::{Diagonal, Rectangle};
pub use space::Space;
