//! The unilateral contact problem (1)-(2) as data: body, material, loads and what holds on each part of the boundary.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::function::{Constant, SharedFunction};
use super::material::Materials;
use super::mesh::bisection::Refinement;
use super::mesh::{Mesh, MeshError};
use super::obstacle::Obstacle;
use crate::model::law::Friction;
use crate::model::pairs::Pair;

fn zero() -> SharedFunction {
    Arc::new(|_| 0.0)
}

/// The condition on a named part of the boundary. Parts without a condition have no traction.
#[non_exhaustive]
#[derive(Clone)]
pub enum Condition {
    /// Gamma_D: the given components of the displacement; `None` leaves a component free (sliding).
    Displacement([Option<SharedFunction>; 2]),
    /// Gamma_N: sigma n = the given traction (a stress).
    Traction([SharedFunction; 2]),
    /// Gamma_N: sigma n = -p n for the given pressure p.
    Pressure(SharedFunction),
    /// A displacement in one component and a traction in the other: where the first is `None`, the second acts.
    Mixed {
        /// The given components of the displacement.
        displacement: [Option<SharedFunction>; 2],
        /// The traction.
        traction: [SharedFunction; 2],
    },
    /// u . n and u . t are given, t being n turned to the left; `None` leaves one free. A plane of symmetry, or a roller at
    /// any angle, has u . n = 0.
    Support {
        /// u . n
        normal: Option<SharedFunction>,
        /// u . t
        tangential: Option<SharedFunction>,
    },
    /// Gamma_C: conditions (2) with the given initial gap (a length along the outward normal).
    Contact {
        /// g
        gap: SharedFunction,
    },
    /// Gamma_C: conditions (2) along the way to the closest point of a rigid obstacle, which has this name.
    Obstacle(String, Obstacle),
}

impl Condition {
    /// No displacement.
    pub fn clamped() -> Self {
        Condition::Displacement([Some(zero()), Some(zero())])
    }

    /// The displacement with these components.
    pub fn displacement(
        x: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static,
        y: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Condition::Displacement([Some(Arc::new(x)), Some(Arc::new(y))])
    }

    /// The traction (a stress) with these components.
    pub fn traction(
        x: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static,
        y: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Condition::Traction([Arc::new(x), Arc::new(y)])
    }

    /// The traction -p n with this pressure p.
    pub fn pressure(p: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static) -> Self {
        Condition::Pressure(Arc::new(p))
    }

    /// No displacement along the normal, at any angle: a roller, or a plane of symmetry.
    pub fn roller() -> Self {
        Condition::Support { normal: Some(zero()), tangential: None }
    }

    /// Contact with a rigid obstacle, which messages call by this name.
    pub fn obstacle(name: impl Into<String>, obstacle: Obstacle) -> Self {
        Condition::Obstacle(name.into(), obstacle)
    }

    /// Contact at this initial gap (a length along the outward normal).
    pub fn contact(gap: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static) -> Self {
        Condition::Contact { gap: Arc::new(gap) }
    }

    /// The displacement u . n along the normal, at any angle; free along the boundary.
    pub fn normal(u_n: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static) -> Self {
        Condition::Support { normal: Some(Arc::new(u_n)), tangential: None }
    }

    /// A total force (per unit of thickness), spread evenly over the length of this boundary of the mesh.
    ///
    /// # Errors
    /// As [`Mesh::edges_of`].
    pub fn force(force: [f64; 2], mesh: &Mesh, boundary: &str) -> Result<Self, MeshError> {
        let edges = mesh.edges_of(boundary)?;
        let length: f64 = edges.iter().map(|&edge| mesh.length_and_normal(edge).0).sum();
        Ok(Condition::Traction(
            force.map(|force| Arc::new(Constant(force / length)) as SharedFunction),
        ))
    }

    /// A load is given on this part.
    pub(crate) fn has_load(&self) -> bool {
        matches!(self, Condition::Traction(_) | Condition::Pressure(_) | Condition::Mixed { .. })
    }

    /// This is a part of Gamma_C.
    pub(crate) fn is_contact(&self) -> bool {
        matches!(self, Condition::Contact { .. } | Condition::Obstacle(..))
    }
}

/// A force per unit of area on a part of the body, beside [`Problem::body_force`].
#[derive(Clone)]
pub struct SurfaceForce {
    /// The part's name.
    pub surface: String,
    /// Its triangles.
    pub triangles: Vec<usize>,
    /// f there.
    pub force: [SharedFunction; 2],
}

/// A support in one point.
#[derive(Clone)]
pub struct PointSupport {
    /// The point's name.
    pub name: String,
    /// The vertex of the mesh.
    pub vertex: usize,
    /// The given components of its displacement; `None` leaves a component free.
    pub displacement: [Option<SharedFunction>; 2],
}

/// A unilateral contact problem on a mesh.
#[derive(Clone)]
pub struct Problem {
    /// The body.
    pub mesh: Mesh,
    /// The materials.
    pub material: Materials,
    /// f, the force per unit of area.
    pub body_force: [SharedFunction; 2],
    /// Forces on parts of the body beside it.
    pub surface_forces: Vec<SurfaceForce>,
    /// The conditions on the named parts of the boundary.
    pub conditions: BTreeMap<String, Condition>,
    /// Friction on contact boundaries; where there is none, the obstacle is smooth.
    pub friction: BTreeMap<String, Friction>,
    /// Supports in single points.
    pub points: Vec<PointSupport>,
    /// Boundaries that may touch each other.
    pub pairs: Vec<Pair>,
    /// The jumps across the direction of contact at which friction begins, at the nodes of each piece of Gamma_C: those of the load
    /// step before (`Solution::slip`); empty where there is none, and on pieces without friction.
    pub slip: Vec<Vec<f64>>,
}

impl Problem {
    /// A body with its loads and boundary conditions, without forces on parts of it, supports in points and pairs of boundaries.
    pub fn new(
        mesh: Mesh,
        material: impl Into<Materials>,
        body_force: [SharedFunction; 2],
        conditions: BTreeMap<String, Condition>,
    ) -> Self {
        Problem {
            mesh,
            material: material.into(),
            body_force,
            surface_forces: Vec::new(),
            conditions,
            friction: BTreeMap::new(),
            points: Vec::new(),
            pairs: Vec::new(),
            slip: Vec::new(),
        }
    }

    /// A body on which nothing acts yet.
    pub fn of(mesh: Mesh, material: impl Into<Materials>) -> Self {
        Problem::new(mesh, material, [zero(), zero()], BTreeMap::new())
    }

    /// Sets the force per unit of area.
    pub fn with_body_force(
        self,
        x: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static,
        y: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Problem { body_force: [Arc::new(x), Arc::new(y)], ..self }
    }

    /// Sets the condition on a named part of the boundary, in place of an earlier one.
    pub fn with(mut self, boundary: impl Into<String>, condition: Condition) -> Self {
        self.conditions.insert(boundary.into(), condition);
        self
    }

    /// Sets the friction on a contact boundary, in place of an earlier one.
    #[must_use]
    pub fn with_friction(mut self, boundary: impl Into<String>, friction: Friction) -> Self {
        self.friction.insert(boundary.into(), friction);
        self
    }

    /// Adds two boundaries that may touch each other; neither has a condition.
    #[must_use]
    pub fn with_pair(mut self, pair: Pair) -> Self {
        self.pairs.push(pair);
        self
    }

    /// The name of the obstacle that the boundary of this name may touch, if it has one.
    pub(crate) fn obstacle_of(&self, boundary: &str) -> Option<&str> {
        match self.conditions.get(boundary) {
            Some(Condition::Obstacle(name, _)) => Some(name),
            _ => None,
        }
    }

    /// Restates the problem on a refinement of its mesh. What holds on boundaries and in points, and which forces act where, has
    /// the same names and places.
    #[must_use]
    pub fn refined(mut self, Refinement { mesh, origin, .. }: Refinement) -> Self {
        self.material = self.material.on_parts(&origin);
        self.slip = Vec::new();
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
