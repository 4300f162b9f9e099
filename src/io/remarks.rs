//! Remarks beside the numbers of a result: on data that are probably mistaken, and on boundaries that touch nothing.

use super::case::Case;
use super::numbers::short;
use crate::fem::ContactLine;
use crate::fem::contact_line::Gamma;
use crate::fem::tree::Bounds;
use crate::fem::{Degree, Space};
use crate::quote;
use crate::solve::Solution;
use crate::solve::solution::ContactValues;

/// Strains above this are more than small-strain theory is for.
const LARGE_STRAIN: f64 = 0.05;

/// Displacements above this share of the body's size likewise.
const LARGE_DISPLACEMENT: f64 = 0.1;

/// Overlaps below this share of the body's size are rounding: mesh files have nine digits or more.
const NO_OVERLAP: f64 = 1e-9;

/// A triangle whose limit of gamma0 is this many times below the median of the line spoils the line.
const SLIVER: f64 = 8.0;

/// Remarks that a reader should know before the numbers are used.
pub(super) fn remarks(case: &Case, solution: &Solution) -> Vec<String> {
    let mut remarks = Vec::new();
    let coercivity = solution.gamma.coercivity;
    let uniform = matches!(solution.gamma.gamma, Gamma::Uniform(_));
    if uniform && coercivity.constant > SLIVER * coercivity.typical {
        let [[a, b], [c, d]] = coercivity.limiting_edge;
        remarks.push(format!(
            "the triangle at the contact edge from ({}, {}) to ({}, {}) sets gamma0 for the whole line, {:.0} times below what half of its triangles allow; method.kappa = 0.5 lets each edge have its own",
            short(a, 3), short(b, 3), short(c, 3), short(d, 3), coercivity.constant / coercivity.typical
        ));
    }
    let length = length_unit(case);
    let strain = solution.largest_strain;
    if strain > LARGE_STRAIN {
        remarks.push(format!(
            "the largest strain is {} %: strains are taken to be small (below {} %); check load, modulus and units",
            short(100.0 * strain, 3),
            short(100.0 * LARGE_STRAIN, 3)
        ));
    }
    remarks.extend(overlap(case));
    remarks.extend(friction(solution));
    let size = size(case);
    let largest = solution.quantities.max_displacement;
    if largest > LARGE_DISPLACEMENT * size {
        remarks.push(format!(
            "the largest displacement is {}{length}, the body is {}{length} long: displacements are taken to be small; check load, modulus and units",
            short(largest, 3),
            short(size, 3)
        ));
    }
    remarks
}

/// A share of what friction bears at most that acts across open gaps, above which that is said.
const ACROSS_GAPS: f64 = 0.01;

/// Says what a reader may not expect of friction.
fn friction(solution: &Solution) -> Vec<String> {
    let mut remarks = Vec::new();
    for boundary in &solution.boundaries {
        let Some(friction) = &boundary.friction else { continue };
        if friction.across_gaps > ACROSS_GAPS {
            remarks.push(format!(
                "{} % of the friction that {} can bear acts across an open gap: Tresca's slip bound does not depend on the pressure; give a bound that is 0 there, or a coefficient (friction = {{ coulomb = 0.3 }})",
                short(100.0 * friction.across_gaps, 2),
                quote::quoted(&boundary.boundary, '\'')
            ));
        }
    }
    if solution.boundaries.iter().any(|b| b.friction.is_some_and(|friction| friction.slides > 0.0))
    {
        remarks.push(
            "one step: friction is as if the loads grew in proportion, with slip in one direction"
                .to_owned(),
        );
    }
    remarks
}

/// The longer side of the box around the body.
fn size(case: &Case) -> f64 {
    Bounds::around(case.problem.mesh.vertices().iter().copied()).size()
}

/// The name of the obstacle of a contact boundary, if it has one.
fn named_obstacle(case: &Case, boundary: &str) -> Option<String> {
    case.problem.obstacle_of(boundary).map(|name| quote::quoted(name, '\''))
}

/// Says where the body is deepest in its obstacle before it is loaded, if it is.
pub(super) fn overlap(case: &Case) -> Option<String> {
    let space = Space::new(&case.problem.mesh, Degree::One);
    let line = ContactLine::new(&case.problem, &space).ok()?;
    let points =
        line.pieces().flat_map(|piece| piece.nodes.iter().map(move |n| (n.gap, n.place, piece)));
    let least = points.min_by(|a, b| a.0.total_cmp(&b.0));
    let (gap, [x, y], piece) = least.filter(|p| p.0 < -NO_OVERLAP * size(case))?;
    let length = length_unit(case);
    let boundary = &piece.first().boundary;
    let (obstacle, question) = match named_obstacle(case, boundary) {
        Some(obstacle) => {
            (obstacle, ": is it in the right place, and is the body on the right side of it?")
        }
        None => (format!("the obstacle of {}", quote::quoted(boundary, '\'')), ""),
    };
    Some(format!(
        "the body overlaps {obstacle} by {}{length} at ({}, {}) before loading{question}",
        short(-gap, 3),
        short(x, 4),
        short(y, 4)
    ))
}

/// Says where a contact boundary that touches nothing is nearest to its obstacle.
pub(super) fn nearest(case: &Case, solution: &Solution, boundary: &str) -> Option<String> {
    let edges = solution.contact.iter().filter(|edge| &*edge.boundary == boundary);
    let distance = |point: &ContactValues| (point.gap - point.u_n, solution.nodes[point.node]);
    let points = edges.flat_map(|edge| edge.points.iter().map(distance));
    let (gap, [x, y]) = points.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "{} touches nothing: it is nearest to {} at ({}, {}), where a gap of {}{} is left",
        quote::quoted(boundary, '\''),
        named_obstacle(case, boundary).unwrap_or_else(|| "its obstacle".to_owned()),
        short(x, 4),
        short(y, 4),
        short(gap.max(0.0), 3),
        length_unit(case)
    ))
}

fn length_unit(case: &Case) -> String {
    case.units.as_ref().map_or(String::new(), |units| format!(" {}", units.length))
}
