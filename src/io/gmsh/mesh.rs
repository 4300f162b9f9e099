//! The mesh that the sections of a file make.

use std::collections::{BTreeMap, HashMap, HashSet};

use nalgebra::Vector2;

use super::{ByDimension, Content, Elements, GmshElement, Groups, Middle, Node};
use crate::fem::merge::merge;
use crate::fem::mesh::length;
use crate::fem::{Mesh, MeshError, Pair};
use crate::io::input::Failure;
use crate::memory::{self, bytes_of};
use crate::quote;

type Result<T> = std::result::Result<T, Failure>;

// Notes on errors of the mesh.
const TAGS: &str = "the numbers are tags of the file";

const CLOCKWISE: &str =
    "the numbers are tags of the file; in Gmsh, turn the curve loop of the surface round";

const NO_TRIANGLE: &str =
    "mesh with gmsh -2, and where curves have a physical group, give the surface one too";

/// Gives the elements on nodes that lie together the first of these nodes, and leaves out what loses an edge by it. Nodes that
/// no triangle uses, and elements on nodes that are not there, stay as they are. The two boundaries of a pair stay apart.
pub(super) fn merge_nodes(content: &mut Content, share: f64, pairs: &[Pair]) {
    let on_sides: Vec<[HashSet<usize>; 2]> = pairs
        .iter()
        .map(|pair| pair.boundaries.each_ref().map(|name| nodes_on(content, name)))
        .collect();
    let by_dimension = &mut content.elements.by_dimension;
    let used: HashSet<usize> = by_dimension[2].iter().flat_map(|t| t.nodes).collect();
    let kept: Vec<&Node> = content.nodes.iter().filter(|node| used.contains(&node.tag)).collect();
    let places: Vec<[f64; 2]> = kept.iter().map(|node| node.place).collect();
    let are_apart = |v: usize, w: usize| {
        let [v, w] = [kept[v].tag, kept[w].tag];
        on_sides.iter().any(|[first, second]| {
            (first.contains(&v) && second.contains(&w))
                || (first.contains(&w) && second.contains(&v))
        })
    };
    let merged = merge(&places, &[], share, are_apart);
    let first: HashMap<usize, usize> = kept
        .iter()
        .zip(&merged.vertex)
        .map(|(node, &vertex)| (node.tag, kept[merged.old_vertex[vertex]].tag))
        .collect();
    let nodes = by_dimension.iter_mut().flatten().flat_map(|element| &mut element.nodes);
    nodes.for_each(|tag| *tag = first.get(tag).copied().unwrap_or(*tag));
    let [_, lines, triangles] = by_dimension;
    lines.retain(|line| line.nodes[0] != line.nodes[1]);
    triangles.retain(|&GmshElement { nodes: [a, b, c], .. }| a != b && b != c && c != a);
}

/// The nodes on the physical curve of this name.
fn nodes_on(content: &Content, name: &str) -> HashSet<usize> {
    let is_named = |physical: &i32| content.names[1].get(physical).is_some_and(|of| of == name);
    let lines = content.elements.by_dimension[1].iter().filter(|line| {
        content.groups[1].get(&line.entity).is_some_and(|groups| groups.iter().any(is_named))
    });
    lines.flat_map(|line| [line.nodes[0], line.nodes[1]]).collect()
}

/// The mesh of the corners of triangles, in the order of the file.
pub(super) fn make_mesh(content: Content, pairs: &[Pair]) -> Result<Mesh> {
    let Content { names, groups, nodes, elements: Elements { by_dimension, middles } } = content;
    let [points, lines, triangles] = by_dimension;
    // Two maps from tags, which are at most half empty and twice as large for a moment while they grow; the lists.
    let maps = 3 * bytes_of::<[usize; 4]>(nodes.len()).saturating_mul(2);
    memory::check(maps.saturating_add(bytes_of::<[usize; 3]>(triangles.len())))?;
    let mut position = HashMap::new();
    for (i, Node { tag, .. }) in nodes.iter().enumerate() {
        if position.insert(*tag, i).is_some() {
            let said =
                format!("there is a second node {tag}; expected a tag of its own for each node");
            return Err(said.into());
        }
    }
    if triangles.is_empty() {
        return Err(noted(MeshError::Empty, NO_TRIANGLE));
    }
    let find = |element: usize, node: usize| -> Result<usize> {
        let said = || format!("element {element} names node {node}, which is not in $Nodes");
        Ok(*position.get(&node).ok_or_else(said)?)
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

    let entities = name_entities(&names, groups)?;
    let mut parts: BTreeMap<String, Vec<[usize; 2]>> = empty(&names[1]);
    for line in lines {
        let [a, b, _] = line.nodes;
        find(line.tag, a)?;
        find(line.tag, b)?;
        let Some(name) = name_under(&entities, 1, &line)? else { continue };
        let (Some(&first), Some(&second)) = (vertex_of.get(&a), vertex_of.get(&b)) else {
            let error = MeshError::NoSuchEdge { boundary: name.clone(), vertices: [a, b] };
            return Err(noted(error, TAGS));
        };
        parts.entry(name.clone()).or_default().push([first, second]);
    }
    let mut surfaces: BTreeMap<String, Vec<usize>> = empty(&names[2]);
    for (t, triangle) in triangles.iter().enumerate() {
        if let Some(name) = name_under(&entities, 2, triangle)? {
            surfaces.entry(name.clone()).or_default().push(t);
        }
    }
    let mut named_points = BTreeMap::new();
    for point in points.iter().filter(|_| !names[0].is_empty()) {
        let name = name_under(&entities, 0, point)?;
        if let (Some(name), Some(&vertex)) = (name, vertex_of.get(&point.nodes[0])) {
            named_points.insert(name.clone(), vertex);
        }
    }

    let corners = triangles.iter().map(|t| t.nodes.map(|node| vertex_of[&node])).collect();
    let places = kept.iter().map(|node| node.place).collect();
    let mesh = Mesh::with_pairs(places, corners, parts, pairs);
    match mesh {
        Ok(mesh) => Ok(mesh.with_names(surfaces, named_points)),
        Err(error) => {
            let note = if matches!(error, MeshError::Clockwise { .. }) { CLOCKWISE } else { TAGS };
            let error = error.renumbered(|vertex| kept[vertex].tag, |t| triangles[t].tag);
            Err(noted(error, note))
        }
    }
}

fn noted(error: MeshError, note: &str) -> Failure {
    Failure::from(error).map(|problem| format!("{problem} ({note})"))
}

/// An empty list for each name.
fn empty<T>(names: &BTreeMap<i32, String>) -> BTreeMap<String, Vec<T>> {
    names.values().map(|name| (name.clone(), Vec::new())).collect()
}

/// The middle node of a straight edge may be off the middle by this share of the edge's length: coordinates in a text file
/// have 16 digits, and a thousandth of the body may be the length of an edge.
const STRAIGHT: f64 = 1e-10;

/// Refuses an edge whose middle node does not lie in its middle.
fn check_straight(element: usize, node: usize, places: [[f64; 2]; 3]) -> Result<()> {
    let [a, b, middle] = places.map(Vector2::from);
    let off = length(middle - (a + b) / 2.0) / length(b - a);
    if off <= STRAIGHT {
        return Ok(());
    }
    let said = format!(
        "element {element} is curved: the middle node {node} of its edge lies {off:e} of the edge's length off the middle; expected straight edges: mesh finer with element order 1 (Mesh.ElementOrder = 1), the smooth boundary is found from the vertices"
    );
    Err(said.into())
}

/// The name of the entities of a dimension in messages.
const KINDS: ByDimension<&str> = ["point", "curve", "surface"];

/// The name of each entity, if it is in a physical group.
type Entities = ByDimension<BTreeMap<i32, Option<String>>>;

/// The name of the entity of this dimension on which an element lies.
fn name_under<'e>(
    entities: &'e Entities,
    dimension: usize,
    &GmshElement { tag, entity, .. }: &GmshElement,
) -> Result<Option<&'e String>> {
    let name = entities[dimension].get(&entity).ok_or_else(|| {
        let kind = KINDS[dimension];
        format!("element {tag} lies on {kind} {entity}, which is not in $Entities")
    })?;
    Ok(name.as_ref())
}

/// The names of all entities. A group without a name is an error for curves, which are meant as boundaries, and no name for
/// points and surfaces.
fn name_entities(names: &ByDimension<BTreeMap<i32, String>>, groups: Groups) -> Result<Entities> {
    let mut all = Entities::default();
    for (dimension, entities) in groups.into_iter().enumerate() {
        for (entity, groups) in entities {
            let unnamed = groups.iter().find(|&group| !names[dimension].contains_key(group));
            if let (1, Some(physical)) = (dimension, unnamed) {
                let said = format!(
                    "physical curve {physical} has no name; expected one, as in Physical Curve(\"floor\", {physical}) = {{{entity}}};"
                );
                return Err(said.into());
            }
            let found: Vec<&String> =
                groups.iter().filter_map(|group| names[dimension].get(group)).collect();
            if found.len() > 1 {
                let (kind, names) =
                    (KINDS[dimension], quote::names(found.iter().map(|name| name.as_str())));
                let said = format!(
                    "{kind} {entity} belongs to the physical {kind}s {names}; expected it in one of them only"
                );
                return Err(said.into());
            }
            all[dimension].insert(entity, found.first().map(|&name| name.clone()));
        }
    }
    Ok(all)
}
