//! Motions that are too large for a gap and a direction taken at the undeformed place, or that lead a part of the boundary into
//! an obstacle that it is not asked to keep out of.

use std::collections::BTreeSet;

use super::{NO_LENGTH, Words, obstacle_of, place, size};
use crate::model::{Condition, Obstacle, Problem};
use crate::quote;
use crate::results::Solution;
use crate::results::solution::ContactPoint;

/// The allowed difference between the distance from the obstacle and the linearised gap, as a share of the motion.
const MOST_OFF: f64 = 0.1;

/// The depth, beside the motion, at which a vertex is inside an obstacle; and the number of times that it is deeper than what the
/// method lets the contact line itself penetrate.
const INSIDE: f64 = 0.02;
const DEEPER: f64 = 2.0;

/// The distance from an obstacle; `None` where it has none, as at the centre of a circle.
fn distance(obstacle: &Obstacle, x: [f64; 2]) -> Option<f64> {
    obstacle.closest(x, String::new).ok().map(|closest| closest.gap)
}

fn moved(x: [f64; 2], u: [f64; 2]) -> ([f64; 2], f64) {
    ([x[0] + u[0], x[1] + u[1]], u[0].hypot(u[1]))
}

/// Says where the deformed boundary is farther from its obstacle, or deeper in it, than the linearised gap has it.
pub(super) fn off_the_obstacle<'s>(
    problem: &Problem,
    solution: &'s Solution,
    words: &Words,
) -> Vec<String> {
    let mut remarks = Vec::new();
    for edges in solution.contact.chunk_by(|a, b| a.boundary == b.boundary) {
        let name = &*edges[0].boundary;
        let Some(Condition::Obstacle(_, obstacle)) = problem.conditions.get(name) else {
            continue;
        };
        // Vertices only: on a curved edge the gap in the middle is that of a place off the chord.
        let vertices = edges.iter().flat_map(|edge| [edge.points.first(), edge.points.last()]);
        let off = |point: &'s ContactPoint| {
            let (x, motion) = moved(point.place, point.displacement);
            let (found, meant) = (distance(obstacle, x)?, point.gap - point.u_n);
            let (off, counts) = ((found - meant).abs(), point.pressure > 0.0 || found < 0.0);
            (counts && off > MOST_OFF * motion).then_some((off, point, motion, found, meant))
        };
        let worst = vertices.flatten().filter_map(off).reduce(|a, b| if b.0 > a.0 { b } else { a });
        let worst = worst.filter(|worst| worst.0 > NO_LENGTH * size(problem));
        let Some((_, point, motion, found, meant)) = worst else { continue };
        remarks.push(format!(
            "{} at {} moves by {}: its distance from {} is then {}, not {} as the gap at the undeformed place has it. Large motions beside a curved obstacle are not computed: expected a motion for which both differ by less than {} % of it, or a mesh of the body nearer to where it ends",
            quote::quoted(name, '\''),
            place(point.place),
            words.length(motion),
            obstacle_of(problem, name),
            words.length(found),
            words.length(if meant.abs() < NO_LENGTH * motion { 0.0 } else { meant }),
            100.0 * MOST_OFF
        ));
    }
    remarks
}

/// Says which vertices of the boundary beside a contact line end inside its obstacle.
pub(super) fn beside_the_line(
    problem: &Problem,
    solution: &Solution,
    words: &Words,
) -> Vec<String> {
    let mesh = &problem.mesh;
    let mut remarks = Vec::new();
    for part in &solution.boundaries {
        let name = &*part.boundary;
        let Ok(edges) = mesh.edges_of(name) else { continue };
        let on_line: BTreeSet<usize> = edges.iter().flat_map(|&edge| mesh.ends(edge)).collect();
        // The depth of a vertex with the edge that it is seen from, if it was outside before.
        let depth = |node: usize, normal: [f64; 2]| {
            let (x, u) = (solution.nodes[node], solution.displacement[node]);
            let (before, after) = match problem.conditions.get(name)? {
                Condition::Obstacle(_, obstacle) => {
                    (distance(obstacle, x)?, distance(obstacle, moved(x, u).0)?)
                }
                Condition::Contact { gap } => {
                    let gap = gap.at(x);
                    (gap, gap - u[0] * normal[0] - u[1] * normal[1])
                }
                _ => return None,
            };
            let rounding = NO_LENGTH * size(problem);
            let least = rounding.max(INSIDE * u[0].hypot(u[1])).max(DEEPER * part.penetration);
            (before >= -rounding && -after > least).then_some(-after)
        };
        let own: BTreeSet<(usize, usize)> = edges.iter().map(|e| (e.triangle, e.local)).collect();
        let of_obstacle = problem.obstacle_of(name).is_some();
        let mut worst: Option<(f64, usize)> = None;
        for &edge in mesh.outline() {
            let ends = mesh.ends(edge);
            let normal: [f64; 2] = mesh.length_and_normal(edge).1.into();
            // A gap along the normal goes on beside the line, where the boundary does not turn away.
            let beside = ends.iter().any(|node| on_line.contains(node));
            let straight_on = || {
                let mut neighbours = edges.iter().filter(|&&e| {
                    let other = mesh.ends(e);
                    other[0] == ends[1] || other[1] == ends[0]
                });
                neighbours.any(|&e| {
                    let m = mesh.length_and_normal(e).1;
                    m.x * normal[0] + m.y * normal[1] > 0.8
                })
            };
            if own.contains(&(edge.triangle, edge.local))
                || !(of_obstacle || beside && straight_on())
            {
                continue;
            }
            for node in ends.into_iter().filter(|node| !on_line.contains(node)) {
                if let Some(found) = depth(node, normal)
                    && found > worst.map_or(0.0, |worst| worst.0)
                {
                    worst = Some((found, node));
                }
            }
        }
        let Some((depth, node)) = worst else { continue };
        remarks.push(format!(
            "{}, on the boundary beside {}, ends {} inside {}: nothing keeps it out; expected a contact line that reaches as far as contact does, make {} longer",
            place(solution.nodes[node]),
            quote::quoted(name, '\''),
            words.length(depth),
            obstacle_of(problem, name),
            quote::quoted(name, '\'')
        ));
    }
    remarks
}
