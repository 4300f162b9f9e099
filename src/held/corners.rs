//! Supports against obstacles. Where a support meets a contact boundary at a vertex and prescribes u . n~ > g there, no
//! displacement of finite energy does both, for its trace cannot jump. The method would answer with a force at this vertex that
//! grows as the mesh is refined.

use crate::contact::discretization::Discretization;
use crate::model::constraints::{from_frame, in_frame};
use crate::model::data::DataError;
use crate::model::mesh::NO_ANGLE;
use crate::model::tree::Bounds;

/// The depth, beside the body's size, that is rounding: mesh files have nine digits or more.
const NO_DEPTH: f64 = 1e-9;

/// Checks that no support holds an end of a contact edge inside the obstacle.
///
/// # Errors
/// [`DataError::HeldInside`].
pub(crate) fn check(d: &Discretization) -> Result<(), DataError> {
    let mesh = d.space.mesh();
    let size = Bounds::around(mesh.vertices().iter().copied()).size();
    for piece in d.contact.iter().filter(|piece| piece.sides.len() == 1) {
        for (node, at) in mesh.ends(piece.edge()).into_iter().zip(&piece.geometry.nodes) {
            let [x, y]: [f64; 2] = at.direction.into();
            let Some([u, v]) = held_along(d, node, [x, y]) else { continue };
            let depth = u * x + v * y - at.gap;
            if depth > NO_DEPTH * size {
                let mut holders = d.constraints.holders().iter();
                let support = holders.find(|(_, held)| held.iter().any(|held| held.node == node));
                let [x, y] = d.space.nodes()[node];
                return Err(DataError::HeldInside {
                    support: support.map_or(String::new(), |(name, _)| name.clone()),
                    boundary: piece.boundary().to_string(),
                    x,
                    y,
                    depth,
                });
            }
        }
    }
    Ok(())
}

/// The displacement of a node, as far as supports prescribe it, if they prescribe its component along `direction`.
fn held_along(d: &Discretization, node: usize, direction: [f64; 2]) -> Option<[f64; 2]> {
    let axis = d.constraints.frames().get(&node).copied().unwrap_or([1.0, 0.0]);
    let values = d.constraints.supported(node);
    // A component that is free must not show along the direction.
    let mut components = in_frame(axis, direction).into_iter().zip(values);
    let free = components.any(|(c, v)| v.is_none() && c.abs() > NO_ANGLE);
    (!free).then(|| from_frame(axis, values.map(Option::unwrap_or_default)))
}
