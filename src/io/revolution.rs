//! Remarks on the numbers of a body of revolution.

use super::case::Case;
use crate::model::{Condition, Obstacle};
use crate::quote::quoted;

/// The remark on a body of revolution: what its numbers are of, what its obstacles are, and what was moved.
pub(super) fn remark(case: &Case) -> Option<String> {
    if !case.problem.material.are_of_revolution() {
        return None;
    }
    let mut text = "a body of revolution about x = 0: forces along y and energies are those of the whole revolution, the first component of a force is that of a radian".to_owned();
    for (name, obstacle) in case.problem.conditions.values().filter_map(obstacle) {
        if let Some(shape) = shape(obstacle) {
            text += &format!("; the obstacle {} is {shape}", quoted(name, '\''));
        }
    }
    match case.snapped {
        0 => {}
        1 => text += "; a vertex next to the axis was moved onto it",
        count => text += &format!("; {count} vertices next to the axis were moved onto it"),
    }
    Some(text)
}

fn obstacle(condition: &Condition) -> Option<(&str, &Obstacle)> {
    match condition {
        Condition::Obstacle(name, obstacle) => Some((name, obstacle)),
        _ => None,
    }
}

/// The surface that an obstacle of the meridian makes all round.
fn shape(obstacle: &Obstacle) -> Option<&'static str> {
    match obstacle {
        Obstacle::Plane { normal: [r, z], .. } => Some(match (*r == 0.0, *z == 0.0) {
            (true, _) => "a plane",
            (_, true) => "a cylinder",
            _ => "a cone",
        }),
        Obstacle::Circle { center: [r, _], .. } => {
            Some(if *r == 0.0 { "a sphere" } else { "a torus" })
        }
        _ => None,
    }
}
