//! Problems put together in code: a body, then what acts on it and what holds it, one after the other. Functions of the
//! place are closures; a [`Function`](super::Function) that knows more of itself goes into the fields.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::function::SharedFunction;
use super::materials::Materials;
use super::mesh::Mesh;
use super::obstacle::Obstacle;
use super::problem::{Condition, Problem};

fn zero() -> SharedFunction {
    Arc::new(|_| 0.0)
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
}

impl Problem {
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
}
