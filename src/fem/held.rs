//! Supports against obstacles. Where a support meets a contact boundary at a vertex and prescribes u . n~ > g there, no displacement
//! of finite energy does both: the trace of one cannot jump. What the method would answer is the penalty of one vertex, which
//! grows as the mesh is refined.

use super::constraints::{Constraints, from_frame};
use super::contact_line::ContactLine;
use super::data::DataError;
use super::mesh::NO_ANGLE;
use super::piece::Stretch;
use super::space::Space;
use super::tree::Bounds;

/// A depth below this share of the body's size is rounding: mesh files have nine digits or more.
const NO_DEPTH: f64 = 1e-9;

/// Checks that no support holds an end of a contact edge inside the obstacle.
///
/// # Errors
/// [`DataError::HeldInside`].
pub(super) fn check(
    constraints: &Constraints,
    space: &Space,
    line: &ContactLine,
) -> Result<(), DataError> {
    let size = Bounds::around(space.mesh().vertices().iter().copied()).size();
    for piece in line.pieces().filter(|piece| piece.stretches.len() == 1) {
        let Stretch { edge, boundary, .. } = piece.first();
        for (node, at) in space.mesh().ends(*edge).into_iter().zip(&piece.nodes) {
            let [x, y]: [f64; 2] = at.direction.into();
            let Some([u, v]) = held_along(constraints, node, [x, y]) else { continue };
            let depth = u * x + v * y - at.gap;
            if depth > NO_DEPTH * size {
                let holds = |(_, held): &(&String, &Vec<super::constraints::Held>)| {
                    held.iter().any(|held| held.node == node)
                };
                let support = constraints.holders().iter().find(holds);
                let [x, y] = space.nodes()[node];
                return Err(DataError::HeldInside {
                    support: support.map_or(String::new(), |(name, _)| name.clone()),
                    boundary: boundary.to_string(),
                    x,
                    y,
                    depth,
                });
            }
        }
    }
    Ok(())
}

/// The part of the displacement of a node that is prescribed, if its component along `direction` is.
fn held_along(constraints: &Constraints, node: usize, direction: [f64; 2]) -> Option<[f64; 2]> {
    let axis = constraints.frames().get(&node).copied().unwrap_or([1.0, 0.0]);
    let values = constraints.values()[node];
    let across = axis[0] * direction[1] - axis[1] * direction[0];
    let along = axis[0] * direction[0] + axis[1] * direction[1];
    // A component that is free must not show along the direction.
    let free =
        [along, across].into_iter().zip(values).any(|(c, v)| v.is_none() && c.abs() > NO_ANGLE);
    (!free).then(|| from_frame(axis, values.map(Option::unwrap_or_default)))
}
