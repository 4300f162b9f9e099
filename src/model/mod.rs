//! The problem of (1)-(2) as it is meant and meshed: T^h, V^h, the material, the data on Gamma_D and Gamma_N, obstacles, normals.

#[doc(hidden)]
pub mod boundary_normals;
pub mod constraints;
#[doc(hidden)]
pub mod data;
pub mod element;
mod embedding;
pub(crate) mod function;
#[doc(hidden)]
pub mod graded_quadrature;
pub(crate) mod groups;
#[doc(hidden)]
pub mod law;
pub mod loads;
#[doc(hidden)]
pub mod material;
#[doc(hidden)]
pub mod merge;
pub mod mesh;
#[doc(hidden)]
pub mod obstacle;
#[doc(hidden)]
pub mod pairs;
pub(crate) mod path;
pub(crate) mod plane_sweep;
#[doc(hidden)]
pub mod problem;
#[doc(hidden)]
pub mod quadrature;
pub(crate) mod revolution;
#[doc(hidden)]
pub mod rigid;
pub mod space;
#[doc(hidden)]
pub mod structured;
#[doc(hidden)]
pub mod tree;

pub use data::DataError;
pub use element::Degree;
pub use function::{Function, SharedFunction};
pub use material::Materials;
pub use mesh::bisection::Refinement;
pub use mesh::{BoundaryEdge, Mesh, MeshError};
pub use obstacle::{Closest, Distance, Hand, Obstacle, Side};
pub use path::{Path, PathError};
pub use problem::{Condition, PointSupport, Problem, SurfaceForce};
pub use space::Space;
pub use structured::{Diagonal, Perturbation, Rectangle, Structured, Trapezoid};
