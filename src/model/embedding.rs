//! Checks that the triangles of a mesh cover no point twice, and that its boundary is a boundary: seams that don't quite
//! match look like cracks, and would be solved as such; parts of the body that only a vertex joins are refused.
//!
//! Triangles that are counter-clockwise and share whole edges cover a point as often as their outline winds around it. Where
//! that is twice, some edge of the outline has the body on either side. So it is enough to look at the outline:
//!
//! - no two edges of the outline cross, and on each upright line edges with the body above them and edges with the body below
//!   them take turns (`plane_sweep`);
//! - no vertex of the outline lies on an edge that is not its own, or beside it across a void narrower than
//!   `TOUCHING` times the local edge, and no two vertices are that close across a void.
//!
//! The last is a matter of tolerance. A mesh rounded to six decimals has voids, or overlaps, of 1e-6: 1e-3 of edges of
//! length 1e-3. What is inside the body does not count: a sliver's apex may be as close to its base as it likes. A slot
//! that is meant needs edges along it shorter than 1/`TOUCHING` times its width. The local edge of a vertex is the
//! shortest one of the outline that ends there; of two places that nearly touch the smaller counts.

mod bodies;

use std::collections::BTreeMap;

use nalgebra::Vector2;

use self::bodies::Linked;
use super::mesh::{Mesh, MeshError, TOUCHING, length};
use super::plane_sweep::{Fault, sweep, turn};
use super::tree::{Bounds, Tree};
use crate::model::pairs::Pair;

/// The outline of a mesh, with the trees that find what is near.
struct SearchableOutline<'m> {
    mesh: &'m Mesh,
    /// Start and end of each edge of the outline.
    ends: Vec<[usize; 2]>,
    /// The edges of the outline that begin and end at each vertex.
    at: BTreeMap<usize, Vec<usize>>,
    /// The shortest edge of the outline at each vertex; infinite inside the body.
    shortest: Vec<f64>,
    /// The triangles around each vertex of the outline.
    around: Vec<Vec<usize>>,
}

impl Mesh {
    /// The mesh with these vertices, these triangles (counter-clockwise) and these named boundary parts (edges as pairs
    /// of vertices, in any direction). An edge of the boundary needs no name.
    ///
    /// # Errors
    /// The first fault that makes it no conforming mesh, with the numbers of the vertices and triangles concerned.
    pub fn new(
        vertices: Vec<[f64; 2]>,
        triangles: Vec<[usize; 3]>,
        named: impl IntoIterator<Item = (String, Vec<[usize; 2]>)>,
    ) -> Result<Mesh, MeshError> {
        Mesh::with_pairs(vertices, triangles, named, &[])
    }

    /// The mesh of [`Mesh::new`], in which the boundaries of these pairs may touch, and bodies that are a pair overlap within its
    /// reach.
    ///
    /// # Errors
    /// As [`Mesh::new`]; [`MeshError::Bodies`].
    pub fn with_pairs(
        vertices: Vec<[f64; 2]>,
        triangles: Vec<[usize; 3]>,
        named: impl IntoIterator<Item = (String, Vec<[usize; 2]>)>,
        pairs: &[Pair],
    ) -> Result<Mesh, MeshError> {
        let named: Vec<_> = named.into_iter().collect();
        if pairs.is_empty() {
            let mesh = Mesh::of_edges(vertices, triangles, named, &|_, _| false)?;
            check(&mesh)?;
            return Ok(mesh);
        }
        let linked = Linked::new(vertices.len(), &triangles, &named, pairs);
        let mesh = Mesh::of_edges(vertices, triangles, named, &|a, b| linked.may_meet(a, b))?;
        bodies::check_pairs(&mesh, pairs)?;
        Ok(mesh)
    }
}

/// Checks the whole outline.
///
/// # Errors
/// [`MeshError::Hanging`], [`MeshError::Near`], [`MeshError::Overlapping`], [`MeshError::JoinedAtVertex`].
fn check(mesh: &Mesh) -> Result<(), MeshError> {
    SearchableOutline::new(mesh).check()?;
    check_joints(mesh)
}

/// Triangles that have a vertex in common must be in one part of the body, connected by edges: a point of H^1 holds nothing.
fn check_joints(mesh: &Mesh) -> Result<(), MeshError> {
    let mut part_at: Vec<Option<usize>> = vec![None; mesh.vertices().len()];
    for (corners, &part) in mesh.triangles().iter().zip(mesh.parts()) {
        for &vertex in corners {
            if *part_at[vertex].get_or_insert(part) != part {
                let [x, y] = mesh.vertices()[vertex];
                return Err(MeshError::JoinedAtVertex { vertex, x, y });
            }
        }
    }
    Ok(())
}

impl<'m> SearchableOutline<'m> {
    fn new(mesh: &'m Mesh) -> Self {
        let ends: Vec<[usize; 2]> = mesh.outline().iter().map(|&e| mesh.ends(e)).collect();
        let mut shortest = vec![f64::INFINITY; mesh.vertices().len()];
        for (&edge, ends) in mesh.outline().iter().zip(&ends) {
            let length = mesh.length_and_normal(edge).0;
            ends.iter().for_each(|&v| shortest[v] = shortest[v].min(length));
        }
        let mut at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (e, ends) in ends.iter().enumerate() {
            ends.iter().for_each(|&v| at.entry(v).or_default().push(e));
        }
        let mut around = vec![Vec::new(); mesh.vertices().len()];
        for (t, corners) in mesh.triangles().iter().enumerate() {
            for &vertex in corners.iter().filter(|&&v| shortest[v].is_finite()) {
                around[vertex].push(t);
            }
        }
        SearchableOutline { mesh, ends, at, shortest, around }
    }

    fn place(&self, vertex: usize) -> Vector2<f64> {
        self.mesh.vertices()[vertex].into()
    }

    fn places(&self, e: usize) -> [Vector2<f64>; 2] {
        self.ends[e].map(|v| self.place(v))
    }

    /// Checks each vertex against the edges near it, then the outline as a whole: what nearly touches often crosses too, and is
    /// better called by its name.
    fn check(&self) -> Result<(), MeshError> {
        self.check_near().0?;
        // Adding 0.0 makes -0 and 0 the same place.
        let place = |[x, y]: &[f64; 2]| Vector2::new(x + 0.0, y + 0.0);
        let places: Vec<Vector2<f64>> = self.mesh.vertices().iter().map(place).collect();
        sweep(&places, &self.ends).map_err(|fault| self.named(fault))
    }

    /// Checks each vertex against the edges near it, those no further from it than [`TOUCHING`] times the shortest edge there. Of
    /// several faults that of the first edge counts; where there is one, not all need be found, for of vertices that are near each
    /// other there may be many. Returns also how many pairs of edges have been looked at.
    fn check_near(&self) -> (Result<(), MeshError>, usize) {
        // More pairs for each edge than most meshes have.
        const ENOUGH: usize = 16;
        let around = |e: usize| Bounds::around(self.places(e).map(Into::into));
        let tree = Tree::new((0..self.ends.len()).map(around).collect());
        let mut fault: Option<([usize; 2], MeshError)> = None;
        let mut count = 0;
        for (&vertex, edges) in &self.at {
            let place = self.place(vertex);
            // A little more, to cover rounding.
            let reach = 1.001 * TOUCHING * self.shortest[vertex];
            for e in tree.meeting(Bounds::around([place.into()]).widened(reach)) {
                let is_near = length(closest(self.places(e), place) - place) <= reach;
                if self.ends[e].contains(&vertex) || !is_near {
                    continue;
                }
                for &f in edges.iter().filter(|&&f| self.ends[f][0] == vertex) {
                    count += 1;
                    if fault.as_ref().is_none_or(|(first, _)| [e, f] < *first)
                        && let Err(error) = self.check_vertex(e, f)
                    {
                        fault = Some(([e, f], error));
                    }
                }
            }
            if fault.is_some() && count > ENOUGH * self.ends.len() {
                break;
            }
        }
        (fault.map_or(Ok(()), |(_, error)| Err(error)), count)
    }

    /// The error that a fault of the outline is.
    fn named(&self, fault: Fault) -> MeshError {
        match fault {
            Fault::Crossing([e, f]) => {
                let triangles = [e, f].map(|e| self.mesh.outline()[e].triangle);
                let [x, y] = crossing(self.places(e), self.places(f));
                MeshError::Overlapping { triangles, x, y }
            }
            Fault::Covered { edge, below } => {
                // What lies just outside an edge that nothing crosses is the same all along.
                let [a, b] = self.places(edge);
                let middle = a / 2.0 + b / 2.0;
                let own = self.mesh.outline()[edge].triangle;
                let covers = |&t: &usize| t != own && self.is_in(t, middle, |turn| turn >= 0.0);
                let other = (0..self.mesh.triangles().len()).find(covers);
                let below = below.map(|e| self.mesh.outline()[e].triangle);
                let [x, y] = middle.into();
                let triangles = [own, other.or(below).unwrap_or(own)];
                MeshError::Overlapping { triangles, x, y }
            }
        }
    }

    /// The first vertex of edge `f` against edge `e`.
    fn check_vertex(&self, e: usize, f: usize) -> Result<(), MeshError> {
        let (edge, ends) = (self.mesh.outline()[e], self.ends[e]);
        let whole = self.mesh.length_and_normal(edge).0;
        let vertex = self.ends[f][0];
        if ends.contains(&vertex) {
            return Ok(());
        }
        let p = self.place(vertex);
        let [a, b] = ends.map(|v| self.place(v));
        for (end, place) in ends.into_iter().zip([a, b]) {
            let distance = length(p - place);
            let local = self.shortest[end].min(self.shortest[vertex]);
            if distance <= TOUCHING * local {
                return self.across_a_void(end, vertex, distance, local);
            }
        }
        let direction = (b - a) / whole;
        let (along, outside) = ((p - a).dot(&direction), (p - a).perp(&direction));
        let touching = TOUCHING * whole.min(self.shortest[vertex]);
        if !(0.0 < along && along < whole) || outside > touching {
            return Ok(());
        }
        let own = self.mesh.triangles()[edge.triangle].contains(&vertex);
        let on_it = outside.abs() <= f64::EPSILON * 8.0 * (p.x.abs() + p.y.abs());
        if !own && (outside >= 0.0 || on_it || self.inside(edge.triangle, p)) {
            let [x, y] = p.into();
            return Err(if outside >= -touching {
                let (triangle, off) = (edge.triangle, outside.abs());
                MeshError::Hanging { vertex, x, y, edge: ends, triangle, off }
            } else {
                let triangles = [edge.triangle, self.mesh.outline()[f].triangle];
                MeshError::Overlapping { triangles, x, y }
            });
        }
        Ok(())
    }

    /// Two vertices that are close to each other must have the body between them.
    fn across_a_void(
        &self,
        from: usize,
        to: usize,
        distance: f64,
        local: f64,
    ) -> Result<(), MeshError> {
        let place = |v: usize| self.place(v);
        let p = place(to);
        for &t in &self.around[from] {
            let corners = self.mesh.triangles()[t];
            let joined = corners.contains(&to);
            let own = corners.iter().position(|&v| v == from).unwrap_or(0);
            let [next, last] = [1, 2].map(|k| place(corners[(own + k) % 3]));
            let between = turn(place(from), next, p) > 0.0 && turn(place(from), p, last) > 0.0;
            if joined || (between && !self.inside(t, p)) {
                return Ok(());
            }
        }
        let size = Bounds::around(self.mesh.vertices().iter().copied()).size();
        let places = [place(from), p].map(Into::into);
        let merge = 10.0_f64.powf((distance / size).log10().floor() + 1.0);
        Err(MeshError::Near { vertices: [from, to], places, distance, local, merge })
    }

    /// `p` lies inside triangle `t`.
    fn inside(&self, t: usize, p: Vector2<f64>) -> bool {
        self.is_in(t, p, |turn| turn > 0.0)
    }

    /// `p` lies on the side of each edge of triangle `t` that `is_within` says of its turn from that edge.
    fn is_in(&self, t: usize, p: Vector2<f64>, is_within: impl Fn(f64) -> bool) -> bool {
        let corners = self.mesh.triangles()[t].map(|v| self.place(v));
        (0..3).all(|i| is_within(turn(corners[i], corners[(i + 1) % 3], p)))
    }
}

/// The place where two segments cross.
fn crossing([a, b]: [Vector2<f64>; 2], [c, d]: [Vector2<f64>; 2]) -> [f64; 2] {
    let (s, t) = (turn(c, d, a), turn(c, d, b));
    (a + (b - a) * (s / (s - t))).into()
}

/// The point of a segment that is closest to `x`.
fn closest([a, b]: [Vector2<f64>; 2], x: Vector2<f64>) -> Vector2<f64> {
    let along = b - a;
    a + along * ((x - a).dot(&along) / along.dot(&along)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Diagonal, Rectangle};

    /// A rectangle of nx x ny cells from `low` to `high`, its corners moved by `map`.
    fn grid(
        [nx, ny]: [usize; 2],
        low: [f64; 2],
        high: [f64; 2],
        map: impl Fn([f64; 2]) -> [f64; 2],
    ) -> (Vec<[f64; 2]>, Vec<[usize; 3]>) {
        let cells = Rectangle { width: 1.0, height: 1.0, nx, ny, diagonal: Diagonal::Right };
        let mesh = cells.mesh().unwrap();
        let place = |x: &[f64; 2]| map([0, 1].map(|c| low[c] + (high[c] - low[c]) * x[c]));
        (mesh.vertices().iter().map(place).collect(), mesh.triangles().to_vec())
    }

    type Pieces<'a> = &'a [(Vec<[f64; 2]>, Vec<[usize; 3]>)];

    /// Meshes side by side in one, nothing joined.
    fn together(pieces: Pieces) -> Result<Mesh, MeshError> {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for (v, t) in pieces {
            let first = vertices.len();
            triangles.extend(t.iter().map(|t| t.map(|i| i + first)));
            vertices.extend_from_slice(v);
        }
        Mesh::new(vertices, triangles, [])
    }

    fn is_near(result: &Result<Mesh, MeshError>) -> bool {
        matches!(result, Err(MeshError::Near { .. }))
    }

    fn is_hanging(result: &Result<Mesh, MeshError>) -> bool {
        matches!(result, Err(MeshError::Hanging { .. }))
    }

    fn overlaps(result: &Result<Mesh, MeshError>) -> bool {
        matches!(result, Err(MeshError::Overlapping { .. }))
    }

    fn rounded(x: [f64; 2]) -> [f64; 2] {
        x.map(|c| (c * 1e6).round() / 1e6)
    }

    fn turned([x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = 0.6_f64.sin_cos();
        [cos * x - sin * y, sin * x + cos * y]
    }

    #[test]
    fn seams_that_are_rounded_to_six_decimals_are_found() {
        for n in [3, 7, 30, 300] {
            // The seam has n edges; how many cells lie behind it is the same to it.
            let cells = [n.min(30), n];
            let left = grid(cells, [0.0, 0.0], [1.0, 1.0], turned);
            let same = grid(cells, [1.0, 0.0], [2.0, 1.0], |x| rounded(turned(x)));
            let finer = grid([2, 2 * n + 1], [1.0, 0.0], [2.0, 1.0], |x| rounded(turned(x)));
            assert!(is_near(&together(&[left.clone(), same])), "{n}");
            let finer = together(&[left, finer]);
            assert!(is_near(&finer) || is_hanging(&finer), "{n}: {finer:?}");
        }
    }

    #[test]
    fn slots_that_are_meant_slivers_thin_strips_and_fine_meshes_beside_coarse_ones_are_no_seams() {
        let left = grid([2, 4], [0.0, 0.0], [1.0, 1.0], |x| x);
        let slot = |width: f64, n| grid([2, n], [1.0 + width, 0.0], [2.0, 1.0], |x| x);
        assert!(together(&[left.clone(), slot(3e-4, 4)]).is_ok());
        assert!(is_near(&together(&[left.clone(), slot(2e-4, 4)])));
        assert!(together(&[left.clone(), slot(2e-6, 1000)]).is_ok(), "the finer edges count");
        for slenderness in [1e3, 1e5, 1e7, 1e9] {
            for map in [|x| x, turned] {
                let strip = grid([10, 1], [0.0, 0.0], [1.0, 1.0 / slenderness], map);
                assert!(together(&[strip]).is_ok(), "{slenderness:e}");
            }
        }
        // Two slivers on one long edge, their apexes close together.
        let v = vec![[0.0, 0.0], [1.0, 0.0], [0.5, 1e-5], [0.5, -1e-5]];
        assert!(Mesh::new(v, vec![[0, 1, 2], [1, 0, 3]], []).is_ok());
        // Rows of cells over eleven decades.
        let graded = |[x, y]: [f64; 2]| [x, 10.0_f64.powf(11.0 * (y - 1.0))];
        assert!(together(&[grid([1, 12], [0.0, 0.0], [1.0, 1.0], graded)]).is_ok());
    }

    #[test]
    fn a_body_inside_the_hole_of_another_is_taken_and_bodies_joined_at_a_corner_are_not() {
        let (v, t) = grid([3, 3], [0.0, 0.0], [3.0, 3.0], |x| x);
        let holed: Vec<[usize; 3]> =
            t.into_iter().enumerate().filter(|(i, _)| i / 2 != 4).map(|(_, t)| t).collect();
        let inside = grid([1, 1], [1.2, 1.2], [1.8, 1.8], |x| x);
        assert!(together(&[(v.clone(), holed.clone()), inside]).is_ok());
        let inside = grid([1, 1], [1.2, 1.2], [2.2, 1.8], |x| x);
        assert!(overlaps(&together(&[(v, holed), inside])));
        // The same vertex, one sector inside the other.
        let v = vec![[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [1.0, 0.5], [0.5, 1.0]];
        assert!(overlaps(&Mesh::new(v, vec![[0, 1, 2], [0, 3, 4]], [])));
        let v = vec![[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [-1.0, -0.5], [-0.5, -1.0]];
        let joined = Mesh::new(v, vec![[0, 1, 2], [0, 3, 4]], []);
        assert!(matches!(joined, Err(MeshError::JoinedAtVertex { vertex: 0, .. })));
    }

    #[test]
    fn a_part_that_meets_itself_in_a_vertex_is_taken() {
        // Two cells that meet in (2, 2), connected by edges around it.
        let (v, t) = grid([4, 4], [0.0, 0.0], [4.0, 4.0], |x| x);
        let removed = |i: usize| [6, 9].contains(&(i / 2));
        let t = t.into_iter().enumerate().filter(|(i, _)| !removed(*i)).map(|(_, t)| t).collect();
        assert!(together(&[(v, t)]).is_ok());
    }

    #[test]
    fn slender_triangles_at_any_angle_have_few_neighbours() {
        // Boxes around long edges at an angle meet all others; few edges are near a vertex.
        let slender = |n| grid([1, n], [0.0, 0.0], [1.0, 1.0], turned);
        // Teeth of a comb: long triangles on a bar.
        let comb = |n: usize| {
            let (mut v, mut t) = grid([2 * n, 1], [0.0, -1e-3], [1.0, 0.0], turned);
            for k in 0..n {
                let [a, b] = [2 * n + 1 + 2 * k, 2 * n + 2 + 2 * k];
                t.push([a, b, v.len()]);
                v.push(turned([(2.0 * k as f64 + 0.5) / (2 * n) as f64, 1.0]));
            }
            (v, t)
        };
        for (vertices, triangles) in [slender(500), comb(200)] {
            let mesh = Mesh::new(vertices, triangles, []).unwrap();
            let outline = SearchableOutline::new(&mesh);
            let ((_, found), edges) = (outline.check_near(), outline.ends.len());
            assert!(found < 8 * edges, "{found} pairs of {edges} edges");
        }
    }

    #[test]
    fn a_strip_wound_onto_itself_is_found() {
        // A ramp of n cells around the origin; beyond a full turn it lies on its own beginning.
        let ramp = |n: usize| {
            grid([n, 1], [0.0, 1.0], [n as f64, 2.0], |[s, r]| {
                let angle = -s * std::f64::consts::TAU / 23.7;
                [(r + 0.02 * s) * angle.cos(), (r + 0.02 * s) * angle.sin()]
            })
        };
        let clockwise = |(v, t): (Vec<[f64; 2]>, Vec<[usize; 3]>)| {
            (v, t.into_iter().map(|[a, b, c]| [a, c, b]).collect::<Vec<_>>())
        };
        let upright = |n| {
            let (v, t) = ramp(n);
            let mesh = together(&[(v.clone(), t.clone())]);
            if matches!(mesh, Err(MeshError::Clockwise { .. })) {
                together(&[clockwise((v, t))])
            } else {
                mesh
            }
        };
        assert!(upright(20).is_ok());
        assert!(upright(23).is_ok());
        for n in [25, 30, 47, 60] {
            assert!(overlaps(&upright(n)), "{n}");
        }
    }
}
