//! Checks of a problem whose mesh is the meridian of a body of revolution: x is the distance r from the axis, y the place z
//! along
//! it. On the axis u_r = 0, and there is no condition to give.

use super::data::DataError;
use super::mesh::{Mesh, NO_ANGLE};
use super::problem::{Condition, Problem};
use crate::kernel::Plane;
use crate::quote::{number, quoted};

/// A vertex that is nearer to the axis than this share of the body's size is meant to be on it: files have 1e-17 for 0.
const ON_AXIS: f64 = 1e-9;

/// The name by which the axis holds the nodes on it.
pub(super) const AXIS: &str = "the axis of revolution";

/// Checks the meridian of a body of revolution and the conditions on it; other bodies pass.
///
/// # Errors
/// [`DataError::Value`]: a part of the body that is none of revolution, r < 0, a vertex next to the axis, a condition on the axis, a
/// support that is neither along r nor along z.
pub(crate) fn check(problem: &Problem) -> Result<(), DataError> {
    let planes = || problem.material.distinct().iter().map(|material| material.plane());
    if !planes().any(|plane| plane == Plane::Axisymmetric) {
        return Ok(());
    }
    let wrong = |what, found: String, expected| Err(DataError::Value { what, found, expected });
    if planes().any(|plane| plane != Plane::Axisymmetric) {
        let expected = "one plane for the whole body";
        return wrong("the plane", "axisymmetric for some materials only".to_owned(), expected);
    }
    let (mesh, near) = (&problem.mesh, nearness(&problem.mesh));
    let is_off = |x: &&[f64; 2]| x[0] < 0.0 || (x[0] > 0.0 && x[0] <= near);
    if let Some(x) = mesh.vertices().iter().find(is_off) {
        let [x, y] = x.map(number);
        let expected = "r = 0 on the axis and r > 0 elsewhere: x is the distance from the axis, which is x = 0, and y the place along it";
        return wrong("the body of revolution", format!("a vertex at ({x}, {y})"), expected);
    }
    for (name, condition) in &problem.conditions {
        for &edge in mesh.edges_of(name)? {
            let [[a, _], [b, _]] = mesh.places_of_ends(edge);
            let place = || {
                let [x, y] = mesh.places_of_ends(edge)[0].map(number);
                format!("one on the boundary {}, at ({x}, {y})", quoted(name, '\''))
            };
            if a == 0.0 && b == 0.0 {
                let expected =
                    "none: nothing moves off the axis; leave the boundary out of the case";
                return wrong("the condition on the axis of revolution", place(), expected);
            }
            let normal = mesh.length_and_normal(edge).1;
            let is_oblique = normal.iter().all(|c| c.abs() > NO_ANGLE);
            if is_oblique && matches!(condition, Condition::Support { .. }) {
                let expected =
                    "a support along r or along z (displacement), or contact with an obstacle";
                return wrong("the oblique support of a body of revolution", place(), expected);
            }
        }
    }
    Ok(())
}

/// The distance from the axis below which a vertex is meant to be on it.
fn nearness(mesh: &Mesh) -> f64 {
    let far = mesh.vertices().iter().flatten().fold(0.0, |most: f64, c| most.max(c.abs()));
    ON_AXIS * far
}

impl Mesh {
    /// Moves the vertices that are next to x = 0 onto it, and returns how many there were.
    pub(crate) fn snap_to_axis(&mut self) -> usize {
        let near = nearness(self);
        self.move_vertices(|[x, y]| {
            let moves = x != 0.0 && x.abs() <= near;
            moves.then_some([0.0, y])
        })
    }
}
