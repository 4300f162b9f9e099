//! Remarks on whether the case is the one that is meant: bodies, materials and elements, overlaps, peaks that no mesh ends.

use std::collections::BTreeSet;

use super::{NO_LENGTH, Words, named_obstacle, obstacle_of, place, size};
use crate::contact::Pair;
use crate::contact::piece::PieceGeometry;
use crate::io::numbers::short;
use crate::kernel::Material;
use crate::model::boundary_normals::{SMOOTH, SmoothBoundary};
use crate::model::groups::groups;
use crate::model::mesh::ROUNDED;
use crate::model::{BoundaryEdge, Degree, Mesh, Problem};
use crate::quote;
use crate::results::{ContactBoundary, Solution};

/// Linear triangles are too stiff from this Poisson's ratio on in plane strain: 1 % at 0.475, 2.4 % at 0.49, 41 % at 0.4995, as
/// measured on a block of 32 x 32 cells.
const LOCKING: f64 = 0.48;

/// The ratio of the stiffness against a change of area to that against shear from which a material counts as nearly
/// incompressible.
const STIFFER: f64 = 10.0;

/// The share of the largest stress below which a stress counts as zero.
const NO_STRESS: f64 = 1e-12;

/// An interior angle of so many degrees more than a right one, or a law as much out of line, makes a peak unbounded.
const A_RIGHT_ANGLE: f64 = 1.0;
const NO_COUPLING: f64 = 1e-9;

/// Says that the mesh has several bodies, and which of them nothing acts on.
pub(super) fn separate_bodies(problem: &Problem, solution: Option<&Solution>) -> Option<String> {
    let mesh = &problem.mesh;
    let parts = mesh.parts();
    let count = parts.iter().max().map_or(0, |last| last + 1);
    let part_of = |name: &str| {
        let edge = mesh.edges_of(name).ok()?.first()?;
        Some(parts[edge.triangle])
    };
    let linked = problem.pairs.iter().filter_map(|pair| {
        let [first, second] = &pair.boundaries;
        Some([part_of(first)?, part_of(second)?])
    });
    let apart: BTreeSet<usize> = groups(count, linked).into_iter().collect();
    if apart.len() < 2 {
        return None;
    }
    let idle = solution.map_or(String::new(), |solution| {
        let mut largest = vec![0.0_f64; count];
        for (&part, &stress) in parts.iter().zip(&solution.von_mises) {
            largest[part] = largest[part].max(stress);
        }
        let most = largest.iter().copied().fold(0.0, f64::max);
        let idle = (0..count).filter(|&part| largest[part] <= NO_STRESS * most);
        let names: Vec<String> = idle.map(|part| boundaries_of(mesh, part)).collect();
        match &names[..] {
            [] => String::new(),
            [one] => format!("; the one with {one} carries nothing"),
            all => format!("; those with {} carry nothing", all.join("; ")),
        }
    });
    Some(format!(
        "the mesh has {} separate bodies: each meets its own rigid obstacles only; those that touch each other are a [[pair]]{idle}",
        apart.len()
    ))
}

/// The boundaries of a part of the body by their names, or where it is.
fn boundaries_of(mesh: &Mesh, part: usize) -> String {
    let is_of_part = |edge: &BoundaryEdge| mesh.parts()[edge.triangle] == part;
    let has_edges =
        |name: &&str| mesh.edges_of(name).is_ok_and(|edges| edges.iter().any(is_of_part));
    let names: Vec<String> =
        mesh.boundary_names().filter(has_edges).map(|name| quote::quoted(name, '\'')).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    match &names[..] {
        [] => "no named boundary".to_owned(),
        names => quote::listed(names, "and"),
    }
}

/// Says that linear triangles are too stiff for a material, if they are.
pub(super) fn locking(problem: &Problem, degree: Degree) -> Option<String> {
    let materials = &problem.material;
    let ratio =
        |material: &Material<f64>| locking_ratio(material).filter(|_| degree == Degree::One);
    let found = materials.distinct().iter().find_map(ratio)?;
    let locks = |triangles: &Vec<usize>| {
        triangles.first().is_some_and(|&t| ratio(materials.of(t)).is_some())
    };
    let surfaces = problem.mesh.surfaces().iter();
    let names = surfaces.filter(|(_, triangles)| locks(triangles)).map(|(name, _)| &**name);
    let of = match materials.only() {
        Some(_) => String::new(),
        None => format!(" of {}", quote::names(names)),
    };
    Some(format!(
        "the material{of} is nearly incompressible ({found}): linear triangles are too stiff then, and forces too large; expected method.degree = 2, or less than {LOCKING}"
    ))
}

/// Poisson's ratio, or that of which the material resists a change of area as much, if linear triangles lock.
fn locking_ratio(material: &Material<f64>) -> Option<String> {
    let [c11, c12, c16, c22, c26, c66] = material.stiffness();
    // The resistance to a change of area beside the least and the most to a shear; of an isotropic material in plane strain
    // 1 / (1 - 2 nu) of both.
    let area = (c11 + 2.0 * c12 + c22) / 4.0;
    let (a, b, c) = ((c11 - 2.0 * c12 + c22) / 4.0, c66, (c16 - c26) / 2.0);
    let [least, most] = [-1.0, 1.0].map(|sign| (a + b) / 2.0 + sign * ((a - b) / 2.0).hypot(c));
    let ratio = area / least;
    // A fibre resists a change of area and a shear alike.
    let locks = ratio * (1.0 + ROUNDED) >= 1.0 / (1.0 - 2.0 * LOCKING) && area > STIFFER * most;
    let poisson = short((1.0 - 1.0 / ratio) / 2.0, 6);
    locks.then(|| match material.is_isotropic() {
        true => format!("Poisson's ratio {poisson} in plane strain"),
        false => format!("as with a Poisson's ratio of {poisson} in plane strain"),
    })
}

/// The pieces of `line` without those between two bodies, which may overlap on purpose.
pub(super) fn to_obstacles<'l>(
    line: &[&'l PieceGeometry],
) -> impl Iterator<Item = &'l PieceGeometry> {
    line.iter().copied().filter(|piece| piece.stretches.len() == 1)
}

/// Says where the body is deepest in its obstacle before it is loaded, if it is.
pub(super) fn overlap(problem: &Problem, line: &[&PieceGeometry], words: &Words) -> Option<String> {
    let points = to_obstacles(line)
        .flat_map(|piece| piece.nodes.iter().map(move |n| (n.gap, n.place, piece)));
    let least = points.min_by(|a, b| a.0.total_cmp(&b.0));
    let (gap, deepest, piece) = least.filter(|p| p.0 < -NO_LENGTH * size(problem))?;
    let question = match named_obstacle(problem, &piece.first().boundary) {
        Some(_) => ": is it in the right place, and is the body on the right side of it?",
        None => "",
    };
    Some(format!(
        "the body overlaps {} by {} at {} before loading{question}",
        obstacle_of(problem, &piece.first().boundary),
        words.length(-gap),
        place(deepest)
    ))
}

/// Two bodies that overlap before loading by more than this share of their least radius or width strain by as much.
const LARGE_OVERLAP: f64 = 0.01;

/// Says which bodies of pairs overlap by more before loading than small strains are for, and where most.
pub(super) fn interference(problem: &Problem, solution: &Solution, words: &Words) -> Vec<String> {
    let smooth = SmoothBoundary::new(&problem.mesh);
    let of_pair = |pair: &Pair| {
        let [first, second] = &pair.boundaries;
        let own = solution.contact.iter().filter(|edge| {
            *edge.boundary == **first && edge.partner.as_ref().is_some_and(|p| **p == **second)
        });
        let points = own.flat_map(|edge| &edge.points);
        let deepest = points.min_by(|a, b| a.gap.total_cmp(&b.gap))?;
        let share = -deepest.gap / pair.scale(&problem.mesh, &smooth).ok()?;
        let [first, second] = pair.boundaries.each_ref().map(|name| quote::quoted(name, '\''));
        (share > LARGE_OVERLAP).then(|| {
            format!(
                "the bodies of {first} and {second} overlap by {} at {} before loading, {} % of their least radius or width: strains are taken to be small",
                words.length(-deepest.gap),
                place(deepest.place),
                short(100.0 * share, 2)
            )
        })
    };
    problem.pairs.iter().filter_map(of_pair).collect()
}

/// Says which peaks of the pressure lie where theory has no bound for it: at the end of a contact boundary, or at a corner of it,
/// where the angle of the body is more than a right one (mirrored at the contact, the body has a notch there); at a right one,
/// where the material is out of line with the boundary.
pub(super) fn unbounded_peaks(
    problem: &Problem,
    solution: &Solution,
    words: &Words,
) -> Vec<String> {
    let mesh = &problem.mesh;
    let of = |part: &ContactBoundary| {
        let edges = mesh.edges_of(&part.boundary).ok().filter(|_| part.force > 0.0)?;
        let at = |v: usize| solution.nodes[v] == part.peak_at;
        let vertex = edges.iter().flat_map(|&edge| mesh.ends(edge)).find(|&v| at(v))?;
        let before = mesh.outline().iter().copied().find(|&e| mesh.ends(e)[1] == vertex)?;
        let after = mesh.outline().iter().copied().find(|&e| mesh.ends(e)[0] == vertex)?;
        let [n, m] = [before, after].map(|edge| mesh.length_and_normal(edge).1);
        let bend = n.perp(&m).atan2(n.dot(&m)).to_degrees();
        let ends = !(edges.contains(&before) && edges.contains(&after));
        let is_corner = bend.abs() > SMOOTH;
        if !(ends || is_corner) {
            return None;
        }
        let edge = if edges.contains(&before) { before } else { after };
        let obtuse = bend < 90.0 - A_RIGHT_ANGLE;
        let oblique = bend < 90.0 + A_RIGHT_ANGLE && is_out_of_line(problem, edge);
        (obtuse || oblique).then(|| {
                    format!(
                "the peak pressure of {}, {}, is at {} {}, where {}: it grows as the mesh is refined; take the force instead, or round the corner off",
                quote::quoted(&part.boundary, '\''),
                words.stress(part.peak_pressure),
                if ends { "the end of the contact boundary," } else { "a corner of it," },
                place(part.peak_at),
                if obtuse { "theory has no bound for it" } else { "a material at an angle need have no bound for it" }
            )
        })
    };
    solution.boundaries.iter().filter_map(of).collect()
}

/// Returns whether the law couples strains along the edge with shear: the mirror image of the body would be of another material.
fn is_out_of_line(problem: &Problem, edge: BoundaryEdge) -> bool {
    let material = problem.material.of(edge.triangle);
    if material.is_isotropic() {
        return false;
    }
    let [x, y]: [f64; 2] = problem.mesh.length_and_normal(edge).1.into();
    let [c11, _, c16, c22, c26, _] = material.turned([x, -y]).stiffness();
    c16.abs().max(c26.abs()) > NO_COUPLING * c11.abs().max(c22.abs())
}
