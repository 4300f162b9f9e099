//! A mesh as another program lists it, nodes and elements with numbers of their own, and the [`Mesh`] that it makes.
//!
//! Mere notation is brought into the notation of this program without a word: a surface whose triangles all run
//! clockwise is turned, nodes that no triangle uses are left out, elements of higher order with straight edges are read by their
//! corners, and an element that is listed once for each of its groups is one. What is decided is said in a remark: quadrangles
//! are split, and a plane z = c is taken for the plane of the body. A group without a name is called by its number.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use nalgebra::Vector2;

use super::input::Failure;
use crate::contact::Pair;
use crate::memory::{self, bytes_of};
use crate::model::merge::merge;
use crate::model::mesh::{ROUNDED, length};
use crate::model::tree::Bounds;
use crate::model::{Mesh, MeshError};
use crate::quote::{number, quoted};

type Result<T> = std::result::Result<T, Failure>;

/// Something for points, curves and surfaces each.
pub(crate) type ByDimension<T> = [T; 3];

/// Nodes, elements, and the names of what the elements lie on.
pub(crate) struct RawMesh {
    pub(crate) nodes: Vec<Node>,
    pub(crate) elements: Elements,
    /// The names of the points, curves and surfaces on which elements lie, by their numbers; one without a name may be left out.
    pub(crate) names: ByDimension<BTreeMap<i32, Vec<String>>>,
    /// The origin of the numbers of nodes and elements, in messages.
    pub(crate) numbers: &'static str,
    /// Decisions so far, in sentences for people.
    pub(crate) remarks: Vec<String>,
}

pub(crate) struct Node {
    pub(crate) tag: usize,
    /// x, y, z.
    pub(crate) place: [f64; 3],
}

/// Elements by their corners.
#[derive(Default)]
pub(crate) struct Elements {
    /// The elements in the order of the file.
    pub(super) all: Vec<Element>,
    on_edges: Vec<NodeOnEdge>,
}

/// An element on an entity: a point, a line, a triangle or a quadrangle.
pub(super) struct Element {
    tag: usize,
    /// The number of its corners.
    corners: usize,
    nodes: [usize; 4],
    entity: i32,
}

impl Element {
    fn nodes(&self) -> &[usize] {
        &self.nodes[..self.corners]
    }

    /// 0 for a point, 1 for a line, 2 for triangles and quadrangles.
    fn dimension(&self) -> usize {
        self.corners.min(3) - 1
    }

    /// The corners of a triangle.
    fn triangle(&self) -> [usize; 3] {
        let [a, b, c, _] = self.nodes;
        [a, b, c]
    }
}

/// A node of an element of higher order between the two ends of an edge.
struct NodeOnEdge {
    element: usize,
    node: usize,
    ends: [usize; 2],
    /// Its distance from the first end, as a share of the edge, if the edge is straight.
    share: f64,
}

/// A kind of element that is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    /// 1 for a point, 2 for a line, 3 for a triangle, 4 for a quadrangle.
    corners: usize,
    /// The polynomial degree of its edges.
    order: usize,
    /// The number of its nodes: corners, then those on its edges one edge after the other, then those inside.
    pub(crate) nodes: usize,
}

/// The kinds of elements by Gmsh's number: corners, order, nodes.
const KINDS: [(i32, [usize; 3]); 20] = [
    (15, [1, 1, 1]),
    (1, [2, 1, 2]),
    (8, [2, 2, 3]),
    (26, [2, 3, 4]),
    (27, [2, 4, 5]),
    (28, [2, 5, 6]),
    (2, [3, 1, 3]),
    (9, [3, 2, 6]),
    (20, [3, 3, 9]),
    (21, [3, 3, 10]),
    (22, [3, 4, 12]),
    (23, [3, 4, 15]),
    (24, [3, 5, 15]),
    (25, [3, 5, 21]),
    (3, [4, 1, 4]),
    (16, [4, 2, 8]),
    (10, [4, 2, 9]),
    (36, [4, 3, 16]),
    (37, [4, 4, 25]),
    (38, [4, 5, 36]),
];

/// Gmsh's numbers of elements that fill a volume, and their names, which are those of meshio but for the hyphens.
const SOLIDS: [(i32, &str); 13] = [
    (4, "4-node tetrahedron"),
    (5, "8-node hexahedron"),
    (6, "6-node prism"),
    (7, "5-node pyramid"),
    (11, "10-node tetrahedron"),
    (12, "27-node hexahedron"),
    (13, "18-node prism"),
    (14, "14-node pyramid"),
    (17, "20-node hexahedron"),
    (18, "15-node prism"),
    (19, "13-node pyramid"),
    (29, "20-node tetrahedron"),
    (30, "35-node tetrahedron"),
];

impl Kind {
    /// The kind of element to which Gmsh gives this number.
    ///
    /// # Errors
    /// A message with the kind of the element and those that are expected.
    pub(crate) fn of_gmsh(number: i32) -> std::result::Result<Kind, String> {
        if let Some((_, [corners, order, nodes])) = KINDS.into_iter().find(|kind| kind.0 == number)
        {
            return Ok(Kind { corners, order, nodes });
        }
        Err(match SOLIDS.into_iter().find(|solid| solid.0 == number) {
            Some((_, name)) => format!(
                "a {name} (type {number}): 3D is not solved; expected a plane mesh of triangles, gmsh -2"
            ),
            None => format!(
                "of a kind that has no use here (type {number}); expected points, lines, triangles and quadrangles"
            ),
        })
    }

    pub(crate) const MOST_NODES: usize = 36;

    /// 0 for a point, 1 for a line, 2 for triangles and quadrangles.
    pub(crate) fn dimension(self) -> usize {
        self.corners.min(3) - 1
    }
}

impl Elements {
    /// Adds the element `tag` with these nodes, as many as its kind has, on `entity`.
    pub(crate) fn add(&mut self, kind: Kind, tag: usize, nodes: &[usize], entity: i32) {
        let Kind { corners, order, .. } = kind;
        let mut own = [0; 4];
        own.iter_mut().zip(&nodes[..corners]).for_each(|(own, node)| *own = *node);
        self.all.push(Element { tag, corners, nodes: own, entity });
        let edges = [0, 0, 1, 3, 4][corners];
        let inner = nodes[corners..].iter().take(edges * (order - 1));
        for (i, &node) in inner.enumerate() {
            let (edge, k) = (i / (order - 1), i % (order - 1));
            let ends = [nodes[edge], nodes[(edge + 1) % corners]];
            let share = (k + 1) as f64 / order as f64;
            self.on_edges.push(NodeOnEdge { element: tag, node, ends, share });
        }
    }

    pub(super) fn of(&self, dimension: usize) -> impl Iterator<Item = &Element> + Clone {
        self.all.iter().filter(move |element| element.dimension() == dimension)
    }

    /// The entities of a dimension on which elements lie, each with the tag of one of them.
    pub(super) fn entities(&self, dimension: usize) -> BTreeMap<i32, usize> {
        self.of(dimension).map(|element| (element.entity, element.tag)).collect()
    }
}

/// A mesh, and the remarks on its making.
#[derive(Debug)]
pub struct Made {
    /// The mesh.
    pub mesh: Mesh,
    /// Sentences for people.
    pub remarks: Vec<String>,
}

/// Cells of one kind: Gmsh's number of it, their nodes cell after cell, and the entity on which each lies.
pub type Block = (i32, Vec<usize>, Vec<i32>);

/// The mesh of nodes and of blocks of cells in memory, with the names of the points, curves and surfaces on which cells lie, by their
/// numbers. The boundaries of these pairs may touch each other.
///
/// # Errors
/// The first mistake found; nodes and cells are counted from 0, the cells block after block.
pub fn of_blocks(
    nodes: Vec<[f64; 3]>,
    blocks: &[Block],
    names: [BTreeMap<i32, Vec<String>>; 3],
    pairs: &[Pair],
) -> Result<Made> {
    let mut elements = Elements::default();
    let mut tag = 0;
    for (number, nodes, entities) in blocks {
        let kind = Kind::of_gmsh(*number)
            .map_err(|found| Failure::wrong(format!("cell {tag} is {found}")))?;
        for (nodes, entity) in nodes.chunks_exact(kind.nodes).zip(entities) {
            elements.add(kind, tag, nodes, *entity);
            tag += 1;
        }
    }
    let nodes = nodes.into_iter().enumerate().map(|(tag, place)| Node { tag, place }).collect();
    let numbers = "points and cells are counted from 0, the cells block after block";
    RawMesh { nodes, elements, names, numbers, remarks: Vec::new() }.made(None, pairs)
}

const NO_TRIANGLE: &str =
    "mesh with gmsh -2, and where curves have a physical group, give the surface one too";

const MIXED: &str = "others of its surface run counter-clockwise";

impl RawMesh {
    pub(super) fn curve_names(&self) -> Vec<String> {
        let names: BTreeSet<&String> = self.names[1].values().flatten().collect();
        names.into_iter().cloned().collect()
    }

    /// The mesh of the corners of triangles and quadrangles, its nodes merged that are no further apart than a share of the body's
    /// size, if one is given. The boundaries of these pairs may touch each other, and are not merged.
    ///
    /// # Errors
    /// The first mistake found, with the numbers of nodes and elements that are used here.
    pub(crate) fn made(mut self, share: Option<f64>, pairs: &[Pair]) -> Result<Made> {
        let mut remarks = std::mem::take(&mut self.remarks);
        let cells: usize = self.elements.of(2).map(|element| element.corners - 2).sum();
        // A map from tags, which is at most half empty and twice as large for a moment while it grows; the lists.
        let map = 3 * bytes_of::<[usize; 2]>(self.nodes.len()).saturating_mul(2);
        memory::check(map.saturating_add(bytes_of::<[usize; 13]>(cells)))?;
        if cells == 0 {
            return Err(noted(MeshError::Empty, NO_TRIANGLE));
        }
        self.count_nodes_from_0()?;
        for on_edge in &self.elements.on_edges {
            self.check_straight(on_edge)?;
        }
        remarks.extend(self.plane()?);
        let places: Vec<[f64; 2]> = self.nodes.iter().map(|node| plane_place(node.place)).collect();
        let is_mixed = turn(&mut self.elements, &places);
        let all = std::mem::take(&mut self.elements.all);
        let (quadrangles, others): (Vec<Element>, _) =
            all.into_iter().partition(|e| e.corners == 4);
        self.elements.all = others;
        remarks.extend(said_of_split(quadrangles.len()));
        for Element { tag, nodes, entity, .. } in quadrangles {
            for [a, b, c] in halves(nodes.map(|node| places[node])) {
                let nodes = [nodes[a], nodes[b], nodes[c], 0];
                self.elements.all.push(Element { tag, corners: 3, nodes, entity });
            }
        }
        if let Some(share) = share {
            self.merge_nodes(&places, share, pairs);
        }
        let mut note =
            if is_mixed { format!("{}; {MIXED}", self.numbers) } else { self.numbers.to_owned() };
        // Bodies that touch are refused where a name of their pair is misspelt.
        let curves = self.curve_names();
        let mut boundaries = pairs.iter().flat_map(|pair| &pair.boundaries);
        if let Some(name) = boundaries.find(|name| !curves.contains(name)) {
            note += &format!("; no curve is named {}, as a [[pair]] has it", quoted(name, '\''));
        }
        let mesh = self.mesh(&places, &note, pairs)?;
        Ok(Made { mesh, remarks })
    }

    /// Puts the places of nodes in the list into the elements, instead of their tags.
    fn count_nodes_from_0(&mut self) -> Result<()> {
        let mut position = HashMap::with_capacity(self.nodes.len());
        for (i, Node { tag, .. }) in self.nodes.iter().enumerate() {
            if position.insert(*tag, i).is_some() {
                let said = format!(
                    "there is a second node {tag}; expected a tag of its own for each node"
                );
                return Err(said.into());
            }
        }
        let number = |element: usize, nodes: &mut [usize]| -> Result<()> {
            for node in nodes {
                let said =
                    || format!("element {element} names node {node}, which is not in $Nodes");
                *node = *position.get(node).ok_or_else(said)?;
            }
            Ok(())
        };
        let Elements { all, on_edges } = &mut self.elements;
        all.iter_mut().try_for_each(|e| number(e.tag, &mut e.nodes[..e.corners]))?;
        on_edges.iter_mut().try_for_each(|e| {
            number(e.element, &mut e.ends)?;
            number(e.element, std::slice::from_mut(&mut e.node))
        })
    }

    /// Refuses an edge whose inner nodes do not divide it evenly.
    fn check_straight(
        &self,
        &NodeOnEdge { element, node, ends: [a, b], share }: &NodeOnEdge,
    ) -> Result<()> {
        let place = |node: usize| Vector2::from(plane_place(self.nodes[node].place));
        let expected = place(a) * (1.0 - share) + place(b) * share;
        let off = length(place(node) - expected) / length(place(b) - place(a));
        if off <= STRAIGHT {
            return Ok(());
        }
        let node = self.nodes[node].tag;
        Err(format!(
            "element {element} is curved: node {node} on its edge lies {off:e} of the edge's length beside its place; expected straight edges: mesh finer with element order 1 (Mesh.ElementOrder = 1), the smooth boundary is found from the vertices"
        )
        .into())
    }

    /// Checks that the corners of triangles and quadrangles lie in a plane z = c, which is a remark if c is not 0.
    fn plane(&self) -> Result<Option<String>> {
        let corners = self.elements.of(2).flat_map(Element::nodes);
        let nodes = || corners.clone().map(|&node| &self.nodes[node]);
        let by_z = |a: &&Node, b: &&Node| a.place[2].total_cmp(&b.place[2]);
        let (Some(low), Some(high)) = (nodes().min_by(by_z), nodes().max_by(by_z)) else {
            return Ok(None);
        };
        let [below, above] = [low.place[2], high.place[2]];
        if below == 0.0 && above == 0.0 {
            return Ok(None);
        }
        let size = Bounds::around(nodes().map(|node| plane_place(node.place))).size();
        if above - below <= ROUNDED * size.max(above.abs()) {
            let is_at_zero = above.abs().max(below.abs()) <= ROUNDED * size;
            return Ok((!is_at_zero).then(|| {
                format!(
                    "the mesh lies in the plane z = {}, which is taken for the plane of the body",
                    number(above)
                )
            }));
        }
        Err(format!(
            "node {} has z = {}, node {} has z = {}: 3D is not solved; expected a mesh in a plane z = constant",
            low.tag,
            number(below),
            high.tag,
            number(above)
        )
        .into())
    }

    /// Gives the elements on nodes that lie together the first of these nodes, and leaves out what loses an edge by it. Nodes
    /// that no triangle uses stay as they are, and the two boundaries of a pair stay apart.
    fn merge_nodes(&mut self, places: &[[f64; 2]], share: f64, pairs: &[Pair]) {
        let on_sides: Vec<[BTreeSet<usize>; 2]> = pairs
            .iter()
            .map(|pair| pair.boundaries.each_ref().map(|name| self.nodes_on(name)))
            .collect();
        let kept = used(self.elements.of(2), places.len());
        let of_kept: Vec<[f64; 2]> = kept.iter().map(|&node| places[node]).collect();
        let are_apart = |v: usize, w: usize| {
            let [v, w] = [kept[v], kept[w]];
            on_sides.iter().any(|[first, second]| {
                (first.contains(&v) && second.contains(&w))
                    || (first.contains(&w) && second.contains(&v))
            })
        };
        let merged = merge(&of_kept, share, are_apart);
        let mut first: Vec<usize> = (0..places.len()).collect();
        for (&node, vertex) in kept.iter().zip(merged) {
            first[node] = kept[vertex];
        }
        self.elements.all.iter_mut().for_each(|e| e.nodes = e.nodes.map(|node| first[node]));
        self.elements.all.retain(|element| {
            let nodes = element.nodes();
            (0..nodes.len()).all(|i| !nodes[..i].contains(&nodes[i]))
        });
    }

    /// The nodes on the curves of this name.
    fn nodes_on(&self, name: &str) -> BTreeSet<usize> {
        let is_named =
            |line: &&Element| names_of(&self.names[1], line.entity).iter().any(|of| of == name);
        self.elements.of(1).filter(is_named).flat_map(Element::nodes).copied().collect()
    }

    /// The mesh of the triangles, in their order.
    fn mesh(self, places: &[[f64; 2]], note: &str, pairs: &[Pair]) -> Result<Mesh> {
        let RawMesh { nodes, elements, names, .. } = self;
        let (triangles, other_entities) = once(elements.of(2).collect(), &names[2]);
        let kept = used(triangles.iter().copied(), nodes.len());
        let mut vertex_of = vec![None; nodes.len()];
        kept.iter().enumerate().for_each(|(vertex, &node)| vertex_of[node] = Some(vertex));

        let mut parts: BTreeMap<String, Vec<[usize; 2]>> = empty(&names[1]);
        let mut faults = BTreeMap::new();
        let mut curves: BTreeMap<String, Vec<[[f64; 2]; 2]>> = BTreeMap::new();
        for &Element { nodes: [start, end, ..], entity, .. } in elements.of(1) {
            for name in names_of(&names[1], entity) {
                if let [Some(a), Some(b)] = [vertex_of[start], vertex_of[end]] {
                    parts.entry(name.clone()).or_default().push([a, b]);
                } else {
                    let ends = [places[start], places[end]];
                    curves.entry(name.clone()).or_default().push(ends);
                    let fault = MeshError::NoSuchEdge { boundary: name.clone(), ends };
                    faults.entry(name.clone()).or_insert(fault);
                }
            }
        }
        let mut surfaces: BTreeMap<String, Vec<usize>> = empty(&names[2]);
        let own = triangles.iter().enumerate().map(|(t, triangle)| (t, triangle.entity));
        for (t, entity) in own.chain(other_entities) {
            for name in names_of(&names[2], entity) {
                surfaces.entry(name.clone()).or_default().push(t);
            }
        }
        surfaces.values_mut().for_each(|members| {
            members.sort_unstable();
            members.dedup();
        });
        let mut named_points: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for point in elements.of(0) {
            for name in names_of(&names[0], point.entity) {
                let of_name = named_points.entry(name.clone()).or_default();
                of_name.extend(vertex_of[point.nodes[0]].filter(|v| !of_name.contains(v)));
            }
        }
        let corners =
            triangles.iter().map(|t| t.triangle().map(|node| vertex_of[node].unwrap_or_default()));
        let of_kept = kept.iter().map(|&node| places[node]).collect();
        Mesh::with_pairs(of_kept, corners.collect(), parts, pairs)
            .and_then(|mesh| mesh.with_names(surfaces, named_points))
            .map(|mesh| mesh.with_faults(faults).with_curves(curves))
            .map_err(|error| {
                let of_vertex = |vertex: usize| nodes[kept[vertex]].tag;
                noted(error.renumbered(of_vertex, |t| triangles[t].tag), note)
            })
    }
}

/// The nodes that are corners of triangles, in order.
fn used<'e>(triangles: impl Iterator<Item = &'e Element>, nodes: usize) -> Vec<usize> {
    let mut is_used = vec![false; nodes];
    triangles.flat_map(Element::nodes).for_each(|&node| is_used[node] = true);
    (0..nodes).filter(|&node| is_used[node]).collect()
}

fn plane_place([x, y, _]: [f64; 3]) -> [f64; 2] {
    [x, y]
}

fn names_of(names: &BTreeMap<i32, Vec<String>>, entity: i32) -> &[String] {
    names.get(&entity).map_or(&[], Vec::as_slice)
}

/// An empty list for each name.
fn empty<T>(names: &BTreeMap<i32, Vec<String>>) -> BTreeMap<String, Vec<T>> {
    names.values().flatten().map(|name| (name.clone(), Vec::new())).collect()
}

fn noted(error: MeshError, note: &str) -> Failure {
    Failure::from(error).map(|problem| format!("{problem} ({note})"))
}

/// The deviation of inner nodes, as a share of an edge's length, up to which the edge is straight: coordinates in a text file
/// have 16 digits, and an edge may be a thousandth of the body long.
const STRAIGHT: f64 = 1e-10;

/// Twice the area of a polygon, positive if it runs counter-clockwise; 0 where it is nothing beside the polygon's size.
fn turning(places: &[[f64; 2]]) -> f64 {
    let from = |i: usize| Vector2::from(places[i % places.len()]) - Vector2::from(places[0]);
    let area: f64 = (1..places.len()).map(|i| from(i).perp(&from(i + 1))).sum();
    let size = Bounds::around(places.iter().copied()).size();
    if area.abs() > ROUNDED * size * size { area } else { 0.0 }
}

/// Turns the elements of each surface on which all run clockwise. Returns whether there is one on which some do.
fn turn(elements: &mut Elements, places: &[[f64; 2]]) -> bool {
    // For each surface whether some run clockwise and whether some run the other way.
    let mut found: HashMap<i32, [bool; 2]> = HashMap::new();
    for element in elements.of(2) {
        let corners = element.nodes.map(|node| places[node]);
        let area = turning(&corners[..element.corners]);
        let [clockwise, other] = found.entry(element.entity).or_default();
        *clockwise |= area < 0.0;
        *other |= area > 0.0;
    }
    for element in elements.all.iter_mut().filter(|element| element.corners > 2) {
        if found.get(&element.entity) == Some(&[true, false]) {
            element.nodes.swap(1, element.corners - 1);
        }
    }
    found.values().any(|found| *found == [true, true])
}

/// The relative difference from which a diagonal is the shorter one: those of a rectangle differ by rounding.
const SHORTER: f64 = 1e-6;

/// The corners of the two triangles into which a quadrangle is split along its shorter diagonal, or along the one that lies inside.
fn halves(places: [[f64; 2]; 4]) -> [[usize; 3]; 2] {
    let diagonals = [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]];
    let is_inside = |halves: [[usize; 3]; 2]| {
        halves.iter().all(|half| turning(&half.map(|corner| places[corner])) > 0.0)
    };
    let between = |a: usize, b: usize| length(Vector2::from(places[b]) - Vector2::from(places[a]));
    let is_second_shorter = between(1, 3) < (1.0 - SHORTER) * between(0, 2);
    match diagonals.map(is_inside) {
        [true, false] => diagonals[0],
        [false, true] => diagonals[1],
        _ => diagonals[usize::from(is_second_shorter)],
    }
}

fn said_of_split(quadrangles: usize) -> Option<String> {
    let [are_split, their] = match quadrangles {
        0 => return None,
        1 => ["quadrangle of the mesh is split into two triangles", "its"],
        _ => ["quadrangles of the mesh are split into two triangles each", "their"],
    };
    Some(format!("{quadrangles} {are_split}, along {their} shorter diagonal"))
}

/// The triangles, each once even if listed for each of several groups, with the further entities of each. A triangle that is
/// listed twice for one group stays double, and is refused as an overlap.
fn once<'e>(
    triangles: Vec<&'e Element>,
    names: &BTreeMap<i32, Vec<String>>,
) -> (Vec<&'e Element>, Vec<(usize, i32)>) {
    if triangles.iter().all(|t| t.entity == triangles[0].entity) {
        return (triangles, Vec::new());
    }
    let sorted = |(t, triangle): (usize, &&Element)| {
        let mut nodes = triangle.triangle();
        nodes.sort_unstable();
        (nodes, t)
    };
    let mut order: Vec<([usize; 3], usize)> = triangles.iter().enumerate().map(sorted).collect();
    order.sort_unstable();
    // The first triangle that each is the same as.
    let mut first: Vec<usize> = (0..triangles.len()).collect();
    for same in order.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        let mut others: Vec<i32> = vec![triangles[same[0].1].entity];
        for &(_, t) in &same[1..] {
            let entity = triangles[t].entity;
            let names_of_this = names_of(names, entity);
            let is_apart = |&other: &i32| {
                let shared = names_of(names, other).iter().any(|name| names_of_this.contains(name));
                other != entity && !shared
            };
            if others.iter().all(is_apart) {
                others.push(entity);
                first[t] = same[0].1;
            }
        }
    }
    let mut number = vec![0; triangles.len()];
    let (mut kept, mut others) = (Vec::with_capacity(triangles.len()), Vec::new());
    for (t, triangle) in triangles.into_iter().enumerate() {
        if first[t] == t {
            number[t] = kept.len();
            kept.push(triangle);
        } else {
            others.push((number[first[t]], triangle.entity));
        }
    }
    (kept, others)
}
