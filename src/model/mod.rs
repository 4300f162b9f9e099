//! The problem of (1)-(2) as it is meant and meshed: T^h, V^h, the material, the data on Gamma_D and Gamma_N, obstacles, normals.

pub mod boundary_normals;
pub mod constraints;
pub(crate) mod data;
pub(crate) mod element;
mod embedding;
pub(crate) mod function;
pub mod graded_quadrature;
pub(crate) mod groups;
pub(crate) mod law;
pub mod loads;
pub mod material;
pub mod merge;
pub mod mesh;
pub(crate) mod obstacle;
pub(crate) mod pairs;
pub(crate) mod path;
pub(crate) mod plane_sweep;
pub(crate) mod problem;
pub mod quadrature;
pub(crate) mod revolution;
pub(crate) mod rigid;
pub mod space;
pub(crate) mod structured;
pub(crate) mod tree;

pub use data::DataError;
pub use element::Degree;
pub use function::{Function, SharedFunction};
pub use material::Materials;
pub use mesh::bisection::Refinement;
pub use mesh::{BoundaryEdge, Mesh, MeshError};
pub use obstacle::{Closest, Distance, Hand, Obstacle, Side};
pub use path::{Path, PathError};
pub use problem::{Condition, PointSupport, Problem, SurfaceForce};
pub use rigid::{FreeMotion, Parts};
pub use space::Space;
pub use structured::{Diagonal, Perturbation, Rectangle, Structured, Trapezoid};

pub use crate::memory::OutOfMemory;
