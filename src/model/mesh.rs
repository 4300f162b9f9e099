//! The triangulation T^h and the parts of its boundary by name.
//!
//! ```text
//!     6 --- 7 --- 8
//!     |   / |   / |      Triangles list their vertices counter-clockwise; edge i of a triangle lies opposite its
//!     | /   | /   |      vertex i; outward normals lie to the right of the counter-clockwise boundary; h_T is the
//!     3 --- 4 --- 5      longest edge of T.
//!     |   / |   / |
//!     | /   | /   |      (2 x 2 cells with the diagonal "right")
//!     0 --- 1 --- 2
//! ```
//!
//! A [`Mesh`] that exists is valid: everything is checked when it is made, and nothing is checked again.

pub mod bisection;
mod edges;
mod error;
pub(crate) mod split;

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, OnceLock};

use super::groups::groups;
use super::tree::{Bounds, Tree};
use crate::kernel::Triangle;
use crate::memory::{self, bytes_of};
use crate::quote;
use edges::{MeshEdge, match_edges, name_boundaries};
pub use error::MeshError;
pub(super) use error::TOUCHING;
use nalgebra::Vector2;

/// A conforming triangulation with named parts of its boundary.
#[derive(Clone, Debug)]
pub struct Mesh {
    vertices: Vec<[f64; 2]>,
    topology: Arc<MeshTopology>,
    /// The boxes of the triangles, made when a point is first looked for.
    boxes: OnceLock<Tree>,
}

/// Which triangles have which vertices and edges, and what they are called.
#[derive(Clone, Debug)]
struct MeshTopology {
    triangles: Vec<[usize; 3]>,
    triangle_edges: Vec<[usize; 3]>,
    edge_count: usize,
    /// The part of the body, connected by edges, that each triangle belongs to.
    parts: Vec<usize>,
    outline: Vec<BoundaryEdge>,
    boundaries: BTreeMap<String, Vec<BoundaryEdge>>,
    /// Named curves that are no boundaries, as one has an edge inside the body, and why.
    faults: BTreeMap<String, MeshError>,
    /// Named curves beside the body, by the ends of their edges.
    curves: BTreeMap<String, Vec<[[f64; 2]; 2]>>,
    surfaces: BTreeMap<String, Vec<usize>>,
    points: BTreeMap<String, Vec<usize>>,
}

/// An edge on the boundary, by the triangle that owns it: edge `local` lies opposite the triangle's vertex `local`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryEdge {
    /// The number of the triangle.
    pub triangle: usize,
    /// 0, 1 or 2.
    pub local: usize,
}

impl BoundaryEdge {
    /// Values at the corners of its triangle as those at its start, at its end and opposite.
    pub(crate) fn ends_first<T: Copy>(self, corners: [T; 3]) -> [T; 3] {
        [1, 2, 0].map(|k| corners[(self.local + k) % 3])
    }
}

impl Mesh {
    /// As [`Mesh::new`], but without the check for overlaps; `may_meet` says which vertices may
    /// be in one place.
    pub(crate) fn of_edges(
        vertices: Vec<[f64; 2]>,
        triangles: Vec<[usize; 3]>,
        named: Vec<(String, Vec<[usize; 2]>)>,
        may_meet: &dyn Fn(usize, usize) -> bool,
    ) -> Result<Mesh, MeshError> {
        if triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        memory::check(bytes_to_make(vertices.len(), triangles.len()))?;
        check_vertices(&vertices, &triangles, may_meet)?;
        check_triangles(&vertices, &triangles)?;
        let (edges, triangle_edges) = match_edges(vertices.len(), &triangles)?;
        let outline: Vec<BoundaryEdge> =
            edges.edges.iter().filter(|e| !e.inner).map(|e| e.owner).collect();
        let (boundaries, faults) = name_boundaries(&edges, &vertices, named)?;
        let topology = MeshTopology {
            parts: connected_by_edges(&triangle_edges, edges.edges.len()),
            triangles,
            triangle_edges,
            edge_count: edges.edges.len(),
            outline,
            boundaries,
            faults,
            curves: BTreeMap::new(),
            surfaces: BTreeMap::new(),
            points: BTreeMap::new(),
        };
        Ok(Mesh { vertices, topology: Arc::new(topology), boxes: OnceLock::new() })
    }

    /// Names parts of the body, as lists of triangles, and points, as lists of vertices. A triangle may have several names; which of
    /// them matters is said by what uses them.
    ///
    /// # Errors
    /// [`MeshError::Beyond`] for a number that no triangle or vertex has.
    pub fn with_names(
        mut self,
        surfaces: BTreeMap<String, Vec<usize>>,
        points: BTreeMap<String, Vec<usize>>,
    ) -> Result<Mesh, MeshError> {
        check_numbers(&surfaces, ["surface", "triangle", "triangles"], self.triangles().len())?;
        check_numbers(&points, ["point", "vertex", "vertices"], self.vertices.len())?;
        let topology = Arc::make_mut(&mut self.topology);
        topology.surfaces = surfaces;
        topology.points = points;
        Ok(self)
    }

    /// Names curves that are no boundaries, and says why.
    #[must_use]
    pub(crate) fn with_faults(mut self, faults: BTreeMap<String, MeshError>) -> Mesh {
        let topology = Arc::make_mut(&mut self.topology);
        topology.boundaries.retain(|name, _| !faults.contains_key(name));
        topology.faults.extend(faults);
        self
    }

    /// Names curves beside the body, by the ends of their edges: a rigid obstacle may be one.
    #[must_use]
    pub(crate) fn with_curves(mut self, curves: BTreeMap<String, Vec<[[f64; 2]; 2]>>) -> Mesh {
        Arc::make_mut(&mut self.topology).curves = curves;
        self
    }

    /// The ends of the edges of a named curve beside the body.
    ///
    /// # Errors
    /// [`MeshError::NoSuchName`], with the names that there are.
    pub(crate) fn curve(&self, name: &str) -> Result<&[[[f64; 2]; 2]], MeshError> {
        named(
            &self.topology.curves,
            name,
            "curve beside the body is named",
            "in Gmsh a Physical Curve that bounds no surface is one",
        )
    }

    /// Names the edges of the boundary whose two ends are places where `holds`.
    ///
    /// # Errors
    /// [`MeshError::NameTaken`] if the mesh has a boundary of this name, [`MeshError::Nowhere`] if there is no such edge.
    pub fn with_boundary(
        mut self,
        name: &str,
        holds: impl Fn([f64; 2]) -> bool,
    ) -> Result<Mesh, MeshError> {
        let topology = &self.topology;
        if topology.boundaries.contains_key(name) || topology.faults.contains_key(name) {
            return Err(MeshError::NameTaken { name: name.to_owned() });
        }
        let is_part = |&edge: &BoundaryEdge| self.places_of_ends(edge).into_iter().all(&holds);
        let edges: Vec<BoundaryEdge> = self.outline().iter().copied().filter(is_part).collect();
        if edges.is_empty() {
            let Bounds { low, high } = Bounds::around(self.vertices.iter().copied());
            return Err(MeshError::Nowhere { low, high });
        }
        Arc::make_mut(&mut self.topology).boundaries.insert(name.to_owned(), edges);
        Ok(self)
    }

    /// The named parts of the body with their triangles, in alphabetical order.
    pub fn surfaces(&self) -> &BTreeMap<String, Vec<usize>> {
        &self.topology.surfaces
    }

    /// The triangles of a named part of the body.
    ///
    /// # Errors
    /// [`MeshError::NoSuchName`], with the names that there are.
    pub fn surface(&self, name: &str) -> Result<&[usize], MeshError> {
        let of_gmsh = "in Gmsh a Physical Surface is one";
        named(&self.topology.surfaces, name, "surface named", of_gmsh)
    }

    /// The vertex of a named point.
    ///
    /// # Errors
    /// [`MeshError::NoSuchName`], with the names that there are; [`MeshError::NotOnePoint`] where several vertices, or none, have
    /// the name.
    pub fn point(&self, name: &str) -> Result<usize, MeshError> {
        let of_gmsh = "in Gmsh a Physical Point is one";
        match named(&self.topology.points, name, "point named", of_gmsh)? {
            &[vertex] => Ok(vertex),
            several => Err(MeshError::NotOnePoint { name: name.to_owned(), count: several.len() }),
        }
    }

    /// The names of points, in alphabetical order.
    pub fn point_names(&self) -> impl Iterator<Item = &str> {
        self.topology.points.keys().map(String::as_str)
    }

    /// Moves the vertices for which `to` says so, and returns how many there were.
    pub(super) fn move_vertices(&mut self, to: impl Fn([f64; 2]) -> Option<[f64; 2]>) -> usize {
        let mut moved = 0;
        for vertex in &mut self.vertices {
            if let Some(place) = to(*vertex) {
                (*vertex, moved) = (place, moved + 1);
            }
        }
        self.boxes = OnceLock::new();
        moved
    }

    /// The vertices.
    pub fn vertices(&self) -> &[[f64; 2]] {
        &self.vertices
    }

    /// The vertices of each triangle, counter-clockwise.
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.topology.triangles
    }

    /// The number of each triangle's edge i, opposite vertex i; the edges of the mesh are counted from 0.
    pub(crate) fn triangle_edges(&self) -> &[[usize; 3]] {
        &self.topology.triangle_edges
    }

    /// The number of edges.
    pub fn edge_count(&self) -> usize {
        self.topology.edge_count
    }

    /// The part of the body that each triangle belongs to: parts are connected by edges, and numbered in the order of their first
    /// triangles.
    pub(crate) fn parts(&self) -> &[usize] {
        &self.topology.parts
    }

    /// The whole boundary, named or not.
    pub fn outline(&self) -> &[BoundaryEdge] {
        &self.topology.outline
    }

    /// The names of the boundary parts, in alphabetical order.
    pub fn boundary_names(&self) -> impl Iterator<Item = &str> {
        self.topology.boundaries.keys().map(String::as_str)
    }

    /// The edges of a named boundary part.
    ///
    /// # Errors
    /// [`MeshError::NoSuchName`], with the names that there are; [`MeshError::InnerEdge`] for a named curve inside the
    /// body, [`MeshError::NoSuchEdge`] for one that no triangle has an edge on.
    pub fn edges_of(&self, boundary: &str) -> Result<&[BoundaryEdge], MeshError> {
        if let Some(fault) = self.topology.faults.get(boundary) {
            return Err(fault.clone());
        }
        let where_from =
            "in Gmsh a Physical Curve is one, in a case file where = \"abs(y) < 1e-9\" makes one";
        named(&self.topology.boundaries, boundary, "boundary named", where_from)
    }

    /// Checks that no edge has two of these names: an edge that has two may be used by one of them.
    ///
    /// # Errors
    /// [`MeshError::NamedTwice`]; as [`Mesh::edges_of`].
    pub(crate) fn check_apart<'n>(
        &self,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Result<(), MeshError> {
        let mut name_of: Vec<Option<&str>> = vec![None; self.edge_count()];
        for name in names {
            for &edge in self.edges_of(name)? {
                if let Some(first) = name_of[self.number_of(edge)].replace(name) {
                    let names = [first, name].map(str::to_owned);
                    return Err(MeshError::NamedTwice { ends: self.places_of_ends(edge), names });
                }
            }
        }
        Ok(())
    }

    /// Triangle `t` with its coordinates.
    pub fn triangle(&self, t: usize) -> Triangle<f64> {
        Triangle { vertices: self.topology.triangles[t].map(|v| self.vertices[v].into()) }
    }

    /// h_T of (7): the diameter of triangle `t`, which is its longest edge.
    pub fn diameter(&self, t: usize) -> f64 {
        diameter(&self.triangle(t))
    }

    /// The vertices at the start and at the end of a boundary edge, the body on its left.
    pub fn ends(&self, edge: BoundaryEdge) -> [usize; 2] {
        let t = self.topology.triangles[edge.triangle];
        [t[(edge.local + 1) % 3], t[(edge.local + 2) % 3]]
    }

    /// The number of a boundary edge among all edges.
    pub(crate) fn number_of(&self, edge: BoundaryEdge) -> usize {
        self.triangle_edges()[edge.triangle][edge.local]
    }

    /// The places of the [`ends`](Mesh::ends) of a boundary edge.
    pub fn places_of_ends(&self, edge: BoundaryEdge) -> [[f64; 2]; 2] {
        self.ends(edge).map(|vertex| self.vertices[vertex])
    }

    /// The length of a boundary edge and its unit outward normal.
    pub fn length_and_normal(&self, edge: BoundaryEdge) -> (f64, Vector2<f64>) {
        let normal = self.triangle(edge.triangle).scaled_normal(edge.local);
        let length = length(normal);
        (length, normal / length)
    }

    /// The amount by which the normals of these boundary edges may be off because the ends are rounded to doubles; 0 for none.
    pub(crate) fn turned_by_rounding(&self, edges: impl IntoIterator<Item = BoundaryEdge>) -> f64 {
        let of = |edge: BoundaryEdge| {
            let ends = self.places_of_ends(edge);
            let far = ends.as_flattened().iter().fold(0.0, |most: f64, c| most.max(c.abs()));
            // A unit in the last place of four coordinates, at two nodes that are compared.
            8.0 * f64::EPSILON * far / self.length_and_normal(edge).0
        };
        edges.into_iter().map(of).fold(0.0, f64::max)
    }

    /// The first triangle that contains the point `x`, with its barycentric coordinates there; `None` outside the body.
    pub fn locate(&self, x: [f64; 2]) -> Option<(usize, [f64; 3])> {
        self.locate_among(x, |_| true)
    }

    /// As [`Mesh::locate`], of the triangles that are `among` those asked for: bodies of a pair may overlap.
    pub(crate) fn locate_among(
        &self,
        x: [f64; 2],
        among: impl Fn(usize) -> bool,
    ) -> Option<(usize, [f64; 3])> {
        let boxes = self.boxes.get_or_init(|| {
            let corners = |t: &[usize; 3]| t.map(|v| self.vertices[v]);
            let boxed = |t: [[f64; 2]; 3]| {
                Bounds::around(t).widened(4.0 * ROUNDED * Bounds::around(t).size())
            };
            Tree::new(self.topology.triangles.iter().map(corners).map(boxed).collect())
        });
        let mut near = boxes.meeting(Bounds::around([x])).into_iter().filter(|&t| among(t));
        let x = Vector2::from(x);
        near.find_map(|t| {
            let triangle = self.triangle(t);
            let gradients = triangle.barycentric_gradients();
            // Each coordinate is measured from a vertex where it is zero: a vertex of the mesh finds itself exactly.
            let l = [0, 1, 2].map(|i| gradients[i].dot(&(x - triangle.vertices[(i + 1) % 3])));
            l.iter().all(|&l| l >= -ROUNDED).then_some((t, l))
        })
    }
}

/// A share below this may be rounding, some thousand roundings of doubles: a triangle with less area beside h_T^2 is flat, as its
/// gradients would have lost all but a few digits; a point this far outside a triangle, in units of its heights, still belongs to
/// it; prescribed values that differ by less, beside the largest, agree, as expressions that mean the same may differ; so do
/// the constants of equal edges; a place this near to the end of a piece of quadrature is its end;
/// and contact that leaves less of the displacement without it leaves nothing that can be seen.
pub(crate) const ROUNDED: f64 = 1e-12;

/// An angle, in radians, that counts as zero: a hundred thousand rounding errors of a facet a thousandth of the body long.
/// Two directions that are held are independent, a boundary bends and a motion leaves an obstacle by more only.
pub(crate) const NO_ANGLE: f64 = 1e-8;

/// |v|, computed without overflow and underflow.
pub(crate) fn length(v: Vector2<f64>) -> f64 {
    v.x.hypot(v.y)
}

/// The number of the part of each triangle: triangles with an edge in common are in one part.
fn connected_by_edges(triangle_edges: &[[usize; 3]], edge_count: usize) -> Vec<usize> {
    let mut first = vec![None; edge_count];
    let edges = triangle_edges.iter().enumerate();
    let pairs = edges.flat_map(|(t, edges)| edges.map(|e| [*first[e].get_or_insert(t), t]));
    groups(triangle_edges.len(), pairs)
}

fn diameter(triangle: &Triangle<f64>) -> f64 {
    [0, 1, 2].map(|i| length(triangle.edge(i))).into_iter().fold(0.0, f64::max)
}

/// The bytes that making a mesh takes beside its vertices and triangles: its edges, of which there are at most three to a
/// triangle and in a list that grows up to twice that, what is kept of them, and the parts that they join.
pub(super) fn bytes_to_make(vertices: usize, triangles: usize) -> u64 {
    let per_vertex = bytes_of::<[usize; 4]>(vertices);
    let edges = (triangles.saturating_mul(3) / 2).saturating_add(vertices);
    let per_edge = bytes_of::<(MeshEdge, Option<usize>)>(edges);
    [per_vertex, bytes_of::<[usize; 5]>(triangles), per_edge]
        .into_iter()
        .fold(0, u64::saturating_add)
}

fn check_vertices(
    vertices: &[[f64; 2]],
    triangles: &[[usize; 3]],
    may_meet: &dyn Fn(usize, usize) -> bool,
) -> Result<(), MeshError> {
    for (vertex, &[x, y]) in vertices.iter().enumerate() {
        if !(x.is_finite() && y.is_finite()) {
            return Err(MeshError::NotFinite { vertex, x, y });
        }
    }
    let mut used = vec![false; vertices.len()];
    for (triangle, corners) in triangles.iter().enumerate() {
        for &vertex in corners {
            match used.get_mut(vertex) {
                Some(used) => *used = true,
                None => {
                    let count = vertices.len();
                    return Err(MeshError::NoSuchVertex { triangle, vertex, count });
                }
            }
        }
    }
    // Adding 0.0 makes -0 and 0 the same place.
    let place = |v: usize| vertices[v].map(|c| (c + 0.0).to_bits());
    let mut last_at = HashMap::with_capacity(vertices.len());
    let mut earlier = vec![None; vertices.len()];
    for b in 0..vertices.len() {
        earlier[b] = last_at.insert(place(b), b);
        let mut together = earlier[b];
        while let Some(a) = together {
            if !may_meet(a, b) {
                let [x, y] = vertices[b].map(|c| c + 0.0);
                return Err(MeshError::Duplicate { vertices: [a, b], x, y });
            }
            together = earlier[a];
        }
    }
    match used.iter().position(|&used| !used) {
        Some(vertex) => {
            let [x, y] = vertices[vertex];
            Err(MeshError::Unused { vertex, x, y })
        }
        None => Ok(()),
    }
}

fn check_triangles(vertices: &[[f64; 2]], triangles: &[[usize; 3]]) -> Result<(), MeshError> {
    for (triangle, &corners) in triangles.iter().enumerate() {
        let t = Triangle { vertices: corners.map(|v| vertices[v].into()) };
        let (area, diameter) = (t.double_area() / 2.0, diameter(&t));
        let flat = ROUNDED * diameter * diameter;
        if area < -flat {
            return Err(MeshError::Clockwise { triangle, vertices: corners, area });
        }
        if !(area > flat) {
            // Adding 0.0 spares the reader an area of -0.
            return Err(MeshError::Flat {
                triangle,
                vertices: corners,
                area: area + 0.0,
                diameter,
            });
        }
    }
    Ok(())
}

fn check_numbers(
    named: &BTreeMap<String, Vec<usize>>,
    [kind, member, members]: [&'static str; 3],
    count: usize,
) -> Result<(), MeshError> {
    let mut all = named.iter().flat_map(|(name, numbers)| numbers.iter().map(move |&n| (name, n)));
    match all.find(|(_, number)| *number >= count) {
        None => Ok(()),
        Some((name, number)) => {
            let of = [kind, member, members];
            Err(MeshError::Beyond { of, name: name.clone(), number, count })
        }
    }
}

/// The entry of a name; `kind` and how Gmsh makes one are for the message about a name that is not there.
fn named<'m, T>(
    all: &'m BTreeMap<String, Vec<T>>,
    name: &str,
    kind: &'static str,
    made: &str,
) -> Result<&'m [T], MeshError> {
    all.get(name).map(Vec::as_slice).ok_or_else(|| {
        let known = match all.is_empty() {
            true => format!("none ({made})"),
            false => quote::names(all.keys().map(String::as_str)),
        };
        MeshError::NoSuchName { kind, name: name.to_owned(), known }
    })
}
