//! The discrete space V^h on a mesh and everything that is integrated over it.

pub mod a_priori;
pub mod ball;
mod build;
pub mod constraints;
pub mod contact_line;
pub mod discretization;
pub mod embedding;
pub mod errors;
pub mod exact;
pub mod held;
pub mod korn;
pub mod loads;
pub mod material;
pub mod materials;
pub mod matrix;
pub mod merge;
pub mod mesh;
pub mod moments;
pub mod obstacle;
pub mod pieces;
pub mod precise;
pub mod problem;
pub mod quadrature;
pub mod rectangle;
pub mod rigid;
pub mod smooth;
pub mod space;
pub mod structured;
pub mod trapezoid;
pub mod tree;
pub mod twofold;

pub use discretization::Discretization;
pub use errors::Errors;
pub use exact::{Exact, ExactSolution};
pub use materials::Materials;
pub use mesh::bisection::Refinement;
pub use mesh::{BoundaryEdge, Mesh, MeshError};
pub use obstacle::{Closest, Distance, Obstacle, Side};
pub use problem::{
    BoxedFunction, Condition, DataError, Function, PointSupport, Problem, SurfaceForce,
};
pub use rectangle::{Diagonal, Rectangle};
pub use rigid::{FreeMotion, Parts};
pub use space::Space;
pub use structured::{Perturbation, Structured};
pub use trapezoid::Trapezoid;
