//! The unilateral contact problem (1)-(2) as data: body, material, loads and what holds on each part of the boundary.

use std::collections::BTreeMap;

use super::mesh::Mesh;
use crate::kernel::Material;

/// A function of the place, such as a component of the body force.
pub trait Function: Send + Sync {
    /// The value at `x`; NaN or infinite where the function has none, which the assembly reports as an error.
    fn at(&self, x: [f64; 2]) -> f64;

    /// The value, if it is the same everywhere: it spares the evaluations.
    fn constant(&self) -> Option<f64> {
        None
    }
}

impl<F: Fn([f64; 2]) -> f64 + Send + Sync> Function for F {
    fn at(&self, x: [f64; 2]) -> f64 {
        self(x)
    }
}

/// A [`Function`] that a problem owns.
pub type BoxedFunction = Box<dyn Function>;

/// What holds on a named part of the boundary; on the rest the traction is zero.
pub enum Condition {
    /// Gamma_D: the given components of the displacement; `None` leaves a component free (sliding).
    Displacement([Option<BoxedFunction>; 2]),
    /// Gamma_N: sigma n = the given traction (a stress).
    Traction([BoxedFunction; 2]),
    /// Gamma_C: conditions (2) with the given initial gap (a length along the outward normal).
    Contact {
        /// g
        gap: BoxedFunction,
    },
}

/// A unilateral contact problem on a mesh.
pub struct Problem {
    /// The body.
    pub mesh: Mesh,
    /// What it is made of.
    pub material: Material<f64>,
    /// f, the force per unit of area.
    pub body_force: [BoxedFunction; 2],
    /// What holds on the named parts of the boundary.
    pub conditions: BTreeMap<String, Condition>,
}
