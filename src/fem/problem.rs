//! The unilateral contact problem (1)-(2) as data: body, material, loads and what holds on each part of the boundary.

use std::collections::BTreeMap;

use thiserror::Error;

use super::mesh::{Mesh, MeshError};
use crate::kernel::Material;
use crate::quote::{number, quoted};

/// A function of the place, such as a component of the body force.
pub trait Function: Send + Sync {
    /// The value at `x`; NaN or infinite where the function has none, which the assembly reports as an error.
    fn at(&self, x: [f64; 2]) -> f64;

    /// The value at `x` on the boundary with the outward normal `n`: a traction may depend on the normal.
    fn on_boundary(&self, x: [f64; 2], _n: [f64; 2]) -> f64 {
        self.at(x)
    }

    /// The degree in x and y, if the function is known to be a polynomial, on the boundary too: it is then integrated
    /// exactly, with no more points than that takes.
    fn degree(&self) -> Option<u32> {
        None
    }

    /// c, if the function is smooth only on either side of the line x = c: its integrals are cut there.
    fn kink(&self) -> Option<f64> {
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

/// Why a problem can't be posed on its mesh.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
pub enum DataError {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error("{what} is {value} at ({}, {}); expected a finite number at every point of the mesh", number(*x), number(*y))]
    NotFinite { what: String, value: f64, x: f64, y: f64 },
    #[error(
        "the displacement boundaries {} and {} meet at ({}, {}) and disagree there: u_{} = {} and {}; expected one value",
        quoted(first, '\''), quoted(second, '\''), number(*x), number(*y), ["x", "y"][*component], number(values[0]), number(values[1])
    )]
    Disagree { first: String, second: String, x: f64, y: f64, component: usize, values: [f64; 2] },
    #[error(
        "no displacement is prescribed that stops the {motion}{part}; expected displacement boundaries that leave no rigid body motion free (contact pushes, it doesn't hold)"
    )]
    RigidMotion { motion: String, part: String },
    #[error("no boundary has contact; expected one with contact = {{ gap = ... }}")]
    NoContact,
}

/// The value of `function`, which the case calls `what()`, at `x`.
///
/// # Errors
/// [`DataError::NotFinite`].
pub fn finite(
    function: &dyn Function,
    x: [f64; 2],
    what: impl Fn() -> String,
) -> Result<f64, DataError> {
    checked(function.at(x), x, what)
}

/// `value`, which is that of `what()` at `x`.
///
/// # Errors
/// [`DataError::NotFinite`].
pub fn checked(value: f64, x: [f64; 2], what: impl Fn() -> String) -> Result<f64, DataError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(DataError::NotFinite { what: what(), value, x: x[0], y: x[1] })
    }
}
