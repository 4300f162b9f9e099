//! The mesh that the sections of a file make.

use std::collections::{BTreeMap, HashMap, HashSet};

use nalgebra::Vector2;

use super::{ByDimension, Content, Elements, GmshMistake, KINDS, Middle, Node, Piece};
use crate::fem::merge::merge;
use crate::fem::mesh::length;
use crate::fem::{Mesh, MeshError};
use crate::memory::{self, bytes_of};
use crate::quote;

// Notes on errors of the mesh.
pub(super) const TAGS: &str = "the numbers are tags of the file";

pub(super) const CLOCKWISE: &str =
    "the numbers are tags of the file; in Gmsh, turn the curve loop of the surface round";

pub(super) const NO_TRIANGLE: &str =
    "mesh with gmsh -2, and where curves have a physical group, give the surface one too";

/// Gives the triangles and lines on nodes that lie together the first of these nodes, and leaves out what loses an edge by
/// it. Nodes that no triangle uses, and elements on nodes that are not there, stay as they are.
pub(super) fn merge_nodes(content: &mut Content, share: f64) {
    let Elements { triangles, lines, points, .. } = &mut content.elements;
    let used: HashSet<usize> = triangles.iter().flat_map(|t| t.nodes).collect();
    let kept: Vec<&Node> = content.nodes.iter().filter(|node| used.contains(&node.tag)).collect();
    let places: Vec<[f64; 2]> = kept.iter().map(|node| node.place).collect();
    let merged = merge(&places, &[], share);
    let first: HashMap<usize, usize> = kept
        .iter()
        .zip(&merged.vertex)
        .map(|(node, &vertex)| (node.tag, kept[merged.old_vertex[vertex]].tag))
        .collect();
    let become_first = |tag: &mut usize| *tag = first.get(tag).copied().unwrap_or(*tag);
    triangles.iter_mut().flat_map(|t| &mut t.nodes).for_each(become_first);
    lines.iter_mut().flat_map(|line| &mut line.nodes).for_each(become_first);
    points.iter_mut().flat_map(|point| &mut point.nodes).for_each(become_first);
    triangles.retain(|t| {
        t.nodes[0] != t.nodes[1] && t.nodes[1] != t.nodes[2] && t.nodes[2] != t.nodes[0]
    });
    lines.retain(|line| line.nodes[0] != line.nodes[1]);
}

/// The mesh of the corners of triangles, in the order of the file.
pub(super) fn make_mesh(content: Content) -> std::result::Result<Mesh, GmshMistake> {
    let Content { names, groups, nodes, elements } = content;
    let Elements { points, lines, triangles, middles } = elements;
    // Two maps from tags, which are at most half empty and twice as large for a moment while they grow; the lists.
    let maps = 3 * bytes_of::<[usize; 4]>(nodes.len()).saturating_mul(2);
    memory::check(maps.saturating_add(bytes_of::<[usize; 3]>(triangles.len())))?;
    let mut position = HashMap::new();
    for (i, node) in nodes.iter().enumerate() {
        if position.insert(node.tag, i).is_some() {
            return Err(GmshMistake::NodeTwice { node: node.tag });
        }
    }
    if triangles.is_empty() {
        return Err(GmshMistake::Mesh { error: MeshError::Empty, note: NO_TRIANGLE });
    }
    let find = |element, node| {
        position.get(&node).copied().ok_or(GmshMistake::NoSuchNode { element, node })
    };
    for Middle { element, node, ends: [a, b] } in middles {
        let [a, b, middle] = [find(element, a)?, find(element, b)?, find(element, node)?];
        check_straight(element, node, [a, b, middle].map(|i| nodes[i].place))?;
    }
    let mut used = vec![false; nodes.len()];
    for triangle in &triangles {
        for node in triangle.nodes {
            used[find(triangle.tag, node)?] = true;
        }
    }
    let kept: Vec<&Node> = nodes.iter().zip(&used).filter(|n| *n.1).map(|n| n.0).collect();
    let vertex_of: HashMap<usize, usize> =
        kept.iter().enumerate().map(|(vertex, node)| (node.tag, vertex)).collect();

    let [of_point, of_curve, of_surface] = name_entities(&names, groups)?;
    let [point_names, curve_names, surface_names] = names;
    let mut parts: BTreeMap<String, Vec<[usize; 2]>> =
        curve_names.into_values().map(|name| (name, Vec::new())).collect();
    for Piece { tag, nodes: [a, b], entity } in lines {
        find(tag, a)?;
        find(tag, b)?;
        let Some(name) = name_of(&of_curve, 1, tag, entity)? else { continue };
        let (Some(&first), Some(&second)) = (vertex_of.get(&a), vertex_of.get(&b)) else {
            return Err(GmshMistake::Mesh {
                error: MeshError::NoSuchEdge { boundary: name.clone(), vertices: [a, b] },
                note: TAGS,
            });
        };
        parts.entry(name.clone()).or_default().push([first, second]);
    }
    let mut surfaces: BTreeMap<String, Vec<usize>> =
        surface_names.into_values().map(|name| (name, Vec::new())).collect();
    for (t, &Piece { tag, entity, .. }) in triangles.iter().enumerate() {
        if let Some(name) = name_of(&of_surface, 2, tag, entity)? {
            surfaces.entry(name.clone()).or_default().push(t);
        }
    }
    let mut named_points = BTreeMap::new();
    if !point_names.is_empty() {
        for Piece { tag, nodes: [node], entity } in points {
            let name = name_of(&of_point, 0, tag, entity)?;
            if let (Some(name), Some(&vertex)) = (name, vertex_of.get(&node)) {
                named_points.insert(name.clone(), vertex);
            }
        }
    }

    let corners = triangles.iter().map(|t| t.nodes.map(|node| vertex_of[&node])).collect();
    let mesh = Mesh::new(kept.iter().map(|node| node.place).collect(), corners, parts);
    match mesh {
        Ok(mesh) => Ok(mesh.with_names(surfaces, named_points)),
        Err(error) => {
            let note = if matches!(error, MeshError::Clockwise { .. }) { CLOCKWISE } else { TAGS };
            let error = error.renumbered(|vertex| kept[vertex].tag, |t| triangles[t].tag);
            Err(GmshMistake::Mesh { error, note })
        }
    }
}

/// The middle node of a straight edge may be off the middle by this share of the edge's length: coordinates in a text file
/// have 16 digits, and a thousandth of the body may be the length of an edge.
pub(super) const STRAIGHT: f64 = 1e-10;

/// Refuses an edge whose middle node does not lie in its middle.
pub(super) fn check_straight(
    element: usize,
    node: usize,
    [a, b, middle]: [[f64; 2]; 3],
) -> std::result::Result<(), GmshMistake> {
    let [a, b, middle] = [a, b, middle].map(Vector2::from);
    let off = length(middle - (a + b) / 2.0) / length(b - a);
    if off <= STRAIGHT { Ok(()) } else { Err(GmshMistake::Curved { element, node, off }) }
}

/// The name of each entity, if it is in a physical group.
pub(super) type NameOf = BTreeMap<i32, Option<String>>;

/// The name of the entity of this dimension on which an element lies.
pub(super) fn name_of(
    names: &NameOf,
    dimension: usize,
    element: usize,
    entity: i32,
) -> std::result::Result<Option<&String>, GmshMistake> {
    let kind = KINDS[dimension];
    let name = names.get(&entity).ok_or(GmshMistake::NoSuchEntity { element, kind, entity })?;
    Ok(name.as_ref())
}

/// The names of all entities. A group without a name is an error for curves, which are meant as boundaries, and no name for
/// points and surfaces.
pub(super) fn name_entities(
    names: &ByDimension<BTreeMap<i32, String>>,
    groups: ByDimension<BTreeMap<i32, Vec<i32>>>,
) -> std::result::Result<ByDimension<NameOf>, GmshMistake> {
    let mut all = <ByDimension<NameOf>>::default();
    for (dimension, entities) in groups.into_iter().enumerate() {
        for (entity, groups) in entities {
            let mut found = Vec::new();
            for physical in groups {
                match names[dimension].get(&physical) {
                    Some(name) => found.push(name),
                    None if dimension == 1 => {
                        return Err(GmshMistake::Unnamed { physical, curve: entity });
                    }
                    None => {}
                }
            }
            if found.len() > 1 {
                let names = quote::names(found.iter().map(|name| name.as_str()));
                let kind = KINDS[dimension];
                return Err(GmshMistake::SeveralNames { kind, entity, names });
            }
            all[dimension].insert(entity, found.first().map(|name| (*name).clone()));
        }
    }
    Ok(all)
}
