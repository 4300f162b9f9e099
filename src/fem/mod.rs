//! The discrete space V^h on a mesh and everything that is integrated over it.

#[doc(hidden)]
pub mod boundary_normals;
pub(crate) mod clearance;
pub mod constraints;
pub mod contact_line;
#[doc(hidden)]
pub mod data;
#[doc(hidden)]
pub mod dense;
pub mod discretization;
pub mod element;
#[doc(hidden)]
pub mod embedding;
pub mod friction;
mod function;
#[doc(hidden)]
pub mod graded_quadrature;
mod grip;
pub(crate) mod groups;
pub(crate) mod held;
#[doc(hidden)]
pub mod korn;
pub mod law;
pub mod loads;
#[doc(hidden)]
pub mod material;
pub mod matrix;
#[doc(hidden)]
pub mod merge;
pub mod mesh;
#[doc(hidden)]
pub mod moments;
#[doc(hidden)]
pub mod obstacle;
#[doc(hidden)]
pub mod pairs;
mod path;
pub mod piece;
mod plane_sweep;
#[doc(hidden)]
pub mod problem;
#[doc(hidden)]
pub mod quadrature;
#[doc(hidden)]
pub mod residual;
mod revolution;
#[doc(hidden)]
pub mod rigid;
#[doc(hidden)]
pub mod rounded_stress;
#[doc(hidden)]
pub mod solvability;
pub mod space;
pub(crate) mod stress_points;
#[doc(hidden)]
pub mod structured;
#[doc(hidden)]
pub mod tree;

pub use contact_line::ContactLine;
pub use data::DataError;
pub use discretization::Discretization;
pub use element::Degree;
pub use friction::Friction;
pub use function::{Function, SharedFunction};
pub use law::{EdgeRule, Law};
pub use material::Materials;
pub use mesh::bisection::Refinement;
pub use mesh::{BoundaryEdge, Mesh, MeshError};
pub use obstacle::{Closest, Distance, Hand, Obstacle, Side};
pub use pairs::{Pair, PairError, PairPiece, PairSide};
pub use path::{Path, PathError};
pub use piece::Piece;
pub use problem::{Condition, PointSupport, Problem, SurfaceForce};
pub use rigid::{FreeMotion, Parts};
pub use space::Space;
pub use structured::{Diagonal, Perturbation, Rectangle, Structured, Trapezoid};
