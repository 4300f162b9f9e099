//! The unilateral contact problem (1)-(2) as data: body, material, loads and what holds on each part of the boundary.

use std::collections::BTreeMap;

use thiserror::Error;

use super::material::MaterialError;
use super::materials::Materials;
use super::mesh::bisection::Refinement;
use super::mesh::{Mesh, MeshError};
use super::obstacle::Obstacle;
use super::rigid::FreeMotion;
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
    /// Gamma_N: sigma n = -p n for the given pressure p.
    Pressure(BoxedFunction),
    /// A displacement in one component and a traction in the other: where the first is `None`, the second acts.
    Mixed {
        /// The given components of the displacement.
        displacement: [Option<BoxedFunction>; 2],
        /// The traction.
        traction: [BoxedFunction; 2],
    },
    /// u . n and u . t are given, t being n turned to the left; `None` leaves one free. A plane of symmetry, or a roller at
    /// any angle, has u . n = 0.
    Support {
        /// u . n
        normal: Option<BoxedFunction>,
        /// u . t
        tangential: Option<BoxedFunction>,
    },
    /// Gamma_C: conditions (2) with the given initial gap (a length along the outward normal).
    Contact {
        /// g
        gap: BoxedFunction,
    },
    /// Gamma_C: conditions (2) along the way to the closest point of a rigid obstacle, which has this name.
    Obstacle(String, Obstacle),
}

impl Condition {
    /// This is a part of Gamma_C.
    pub fn is_contact(&self) -> bool {
        matches!(self, Condition::Contact { .. } | Condition::Obstacle(..))
    }
}

/// A force per unit of area on a part of the body, beside [`Problem::body_force`].
pub struct SurfaceForce {
    /// The part's name.
    pub surface: String,
    /// Its triangles.
    pub triangles: Vec<usize>,
    /// f there.
    pub force: [BoxedFunction; 2],
}

/// A support in one point.
pub struct PointSupport {
    /// The point's name.
    pub name: String,
    /// The vertex of the mesh.
    pub vertex: usize,
    /// The given components of its displacement; `None` leaves a component free.
    pub displacement: [Option<BoxedFunction>; 2],
}

/// A unilateral contact problem on a mesh.
pub struct Problem {
    /// The body.
    pub mesh: Mesh,
    /// What it is made of.
    pub material: Materials,
    /// f, the force per unit of area.
    pub body_force: [BoxedFunction; 2],
    /// Forces on parts of the body beside it.
    pub surface_forces: Vec<SurfaceForce>,
    /// What holds on the named parts of the boundary.
    pub conditions: BTreeMap<String, Condition>,
    /// Supports in single points.
    pub points: Vec<PointSupport>,
}

impl Problem {
    /// A body with its loads and boundary conditions, without forces on parts of it and without supports in points.
    pub fn new(
        mesh: Mesh,
        material: impl Into<Materials>,
        body_force: [BoxedFunction; 2],
        conditions: BTreeMap<String, Condition>,
    ) -> Self {
        Problem {
            mesh,
            material: material.into(),
            body_force,
            surface_forces: Vec::new(),
            conditions,
            points: Vec::new(),
        }
    }

    /// The same problem on a refinement of its mesh. What holds on boundaries and in points, and which forces act where, has
    /// the same names and places.
    #[must_use]
    pub fn refined(mut self, Refinement { mesh, origin, .. }: Refinement) -> Self {
        self.material = self.material.on_parts(&origin);
        for force in &mut self.surface_forces {
            // Triangles are numbered in the order of those that they are parts of.
            let parts = |&t: &usize| {
                origin.partition_point(|&o| o < t)..origin.partition_point(|&o| o <= t)
            };
            force.triangles = force.triangles.iter().flat_map(parts).collect();
        }
        self.mesh = mesh;
        self
    }
}

/// Why a problem can't be posed on its mesh.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
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
        "the displacement boundaries {} and {} meet at ({}, {}) and disagree there: u . ({}, {}) = {} and {}; expected one value",
        quoted(first, '\''), quoted(second, '\''), number(*x), number(*y), number(direction[0]), number(direction[1]), number(values[0]), number(values[1])
    )]
    DisagreeAlong {
        first: String,
        second: String,
        x: f64,
        y: f64,
        direction: [f64; 2],
        values: [f64; 2],
    },
    #[error(
        "no displacement is prescribed that stops the {}; expected displacement boundaries that leave no rigid body motion free, or loads that press the body against its obstacles (contact pushes, it doesn't hold)",
        listed(motions)
    )]
    RigidMotion { motions: Vec<FreeMotion> },
    #[error(
        "{what} has a gradient of length {} at ({}, {}); expected a distance there, with a gradient between {least} and {most}",
        number(*length), number(*x), number(*y)
    )]
    NoDistance { what: String, length: f64, x: f64, y: f64, least: f64, most: f64 },
    #[error("the material is none: {0}")]
    Material(#[from] MaterialError),
    #[error("{what} is {found}; expected {expected}")]
    Value { what: &'static str, found: String, expected: &'static str },
    #[error("no boundary has contact; expected one with contact = {{ gap = ... }}")]
    NoContact,
}

/// So many free motions are told one by one.
const TOLD: usize = 4;

fn listed(motions: &[FreeMotion]) -> String {
    let told: Vec<String> = motions.iter().take(TOLD).map(FreeMotion::to_string).collect();
    let more = match motions.len().saturating_sub(TOLD) {
        0 => String::new(),
        more => format!("; nor {more} more"),
    };
    told.join("; nor the ") + &more
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
