//! Newest-vertex bisection: finer meshes where they are wanted, conforming, with angles that stay what they were.
//!
//! ```text
//!          z                   z                    z
//!        /   \               / | \                / | \        A triangle is cut from its newest vertex z to the
//!      /       \    ->     /   |   \     ->     /\  |   \      middle m of the edge opposite; m is then the newest
//!    /           \       /     |     \        /   \ |     \    vertex of both halves. A middle on another edge cuts
//!   a ----------- b     a ---- m ---- b      a ---- m ---- b   the half that has this edge.
//! ```
//!
//! Edges are marked until every triangle with a marked edge has the one opposite its newest vertex marked too: then each
//! triangle is cut into at most four, and neighbours share whole edges. The halves of the halves of a triangle have sides
//! parallel to its own and to one of its medians, so that all descendants of one triangle belong to four classes of
//! similar triangles (Mitchell, ACM Trans. Math. Softw. 15 (1989) 326): no angle is smaller than the smallest of these.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Vector2;

use super::{BoundaryEdge, Mesh, MeshError, length};

/// A mesh made from another by bisection. The vertices of the old one keep their numbers; the newest vertex of each triangle
/// is its first.
#[derive(Clone, Debug)]
pub struct Refinement {
    /// The finer mesh.
    pub mesh: Mesh,
    /// The vertices between which each of the new vertices lies, from the first new one on.
    pub parents: Vec<[usize; 2]>,
    /// The triangle of the old mesh that each triangle is a part of.
    pub origin: Vec<usize>,
}

impl Refinement {
    /// The nodal values on this mesh of a field that has the values `u` at the vertices of the `old` one, and at the middles of
    /// its edges if it is quadratic on its triangles.
    pub(crate) fn prolonged(&self, old: &Mesh, u: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let (ends, middles) = u.split_at(old.vertices.len());
        if middles.is_empty() {
            let between = |&[a, b]: &[usize; 2]| middle(u[a], u[b]);
            return u.iter().copied().chain(self.parents.iter().map(between)).collect();
        }
        let mesh = &self.mesh;
        let vertices = mesh.vertices.len();
        let mut finer = vec![[0.0; 2]; vertices + mesh.edge_count()];
        for (t, &origin) in self.origin.iter().enumerate() {
            let (corners, edges) = (mesh.triangles()[t], mesh.triangle_edges()[t]);
            let whole = old.triangle(origin);
            let (centre, gradients) = (whole.point([1.0 / 3.0; 3]), whole.barycentric_gradients());
            let at_vertices = old.triangles()[origin].map(|vertex| ends[vertex]);
            let at_middles = old.triangle_edges()[origin].map(|e| middles[e]);
            let value = |x: Vector2<f64>| {
                let l = gradients.map(|gradient| 1.0 / 3.0 + gradient.dot(&(x - centre)));
                [0, 1].map(|c| {
                    let of = |i: usize| {
                        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                        at_vertices[i][c] * l[i] * (2.0 * l[i] - 1.0)
                            + at_middles[i][c] * 4.0 * l[j] * l[k]
                    };
                    of(0) + of(1) + of(2)
                })
            };
            let part = mesh.triangle(t);
            for i in 0..3 {
                finer[corners[i]] = value(part.vertices[i]);
                let [a, b] = [1, 2].map(|k| part.vertices[(i + k) % 3]);
                finer[vertices + edges[i]] = value((a + b) / 2.0);
            }
        }
        finer
    }
}

fn middle(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|c| 0.5 * a[c] + 0.5 * b[c])
}

/// The two halves of a triangle whose newest vertex is its first.
fn halves([z, a, b]: [usize; 3], m: usize) -> [[usize; 3]; 2] {
    [[m, z, a], [m, b, z]]
}

/// The edges that are halved.
struct Halved {
    /// The vertex in the middle of each edge, if it is halved.
    middles: Vec<Option<usize>>,
    /// All vertices.
    vertices: Vec<[f64; 2]>,
    /// Between which the new ones lie.
    parents: Vec<[usize; 2]>,
}

impl Halved {
    fn none(mesh: &Mesh) -> Halved {
        let middles = vec![None; mesh.edge_count()];
        Halved { middles, vertices: mesh.vertices.clone(), parents: Vec::new() }
    }

    fn halve(&mut self, mesh: &Mesh, t: usize, local: usize) {
        let middle_of = &mut self.middles[mesh.triangle_edges()[t][local]];
        if middle_of.is_none() {
            let ends = [1, 2].map(|k| mesh.triangles()[t][(local + k) % 3]);
            *middle_of = Some(self.vertices.len());
            self.vertices.push(middle(mesh.vertices[ends[0]], mesh.vertices[ends[1]]));
            self.parents.push(ends);
        }
    }

    /// Until each triangle with a halved edge has the one opposite its newest vertex halved; that ends at the latest when
    /// all edges are.
    fn close(&mut self, mesh: &Mesh, newest: &[usize]) {
        let mut count = None;
        while count != Some(self.parents.len()) {
            count = Some(self.parents.len());
            for (t, edges) in mesh.triangle_edges().iter().enumerate() {
                if edges.iter().any(|&e| self.middles[e].is_some()) {
                    self.halve(mesh, t, newest[t]);
                }
            }
        }
    }
}

impl Mesh {
    /// For each triangle the vertex (0, 1 or 2) opposite its longest edge, which is to be its newest when bisection begins. Of
    /// edges of one length it is the one with the smallest number, so that neighbours agree.
    pub fn opposite_longest(&self) -> Vec<usize> {
        let opposite = |t: usize| {
            let triangle = self.triangle(t);
            let lengths = [0, 1, 2].map(|i| length(triangle.edge(i)));
            let edges = self.triangle_edges()[t];
            let longer = |&i: &usize, &j: &usize| {
                lengths[i].total_cmp(&lengths[j]).then(edges[j].cmp(&edges[i]))
            };
            (0..3).max_by(longer).unwrap_or(0)
        };
        (0..self.triangles().len()).map(opposite).collect()
    }

    /// The mesh with all three edges of the `marked` triangles halved, and whatever else that takes; `newest` is the newest
    /// vertex (0, 1 or 2) of each triangle. Names stay with what they name.
    ///
    /// # Errors
    /// Triangles too small for doubles, lack of memory.
    pub fn bisected(&self, newest: &[usize], marked: &[usize]) -> Result<Refinement, MeshError> {
        self.bisected_along(newest, marked, |_| None)
    }

    /// As [`Mesh::bisected`], the middles of edges of the outline where `curve` says, as far as that is beside the edge by less than a
    /// quarter of the triangle's height over it.
    ///
    /// # Errors
    /// As [`Mesh::bisected`].
    pub(crate) fn bisected_along(
        &self,
        newest: &[usize],
        marked: &[usize],
        curve: impl Fn(BoundaryEdge) -> Option<[f64; 2]>,
    ) -> Result<Refinement, MeshError> {
        let mut halved = Halved::none(self);
        marked.iter().for_each(|&t| (0..3).for_each(|local| halved.halve(self, t, local)));
        halved.close(self, newest);
        let Halved { middles, mut vertices, parents } = halved;
        for &edge in self.outline() {
            let middle = middles[self.number_of(edge)];
            let Some((vertex, place)) = middle.zip(curve(edge)) else { continue };
            let beside = Vector2::from(place) - Vector2::from(vertices[vertex]);
            let (edge_length, _) = self.length_and_normal(edge);
            let height = self.triangle(edge.triangle).double_area() / edge_length;
            if 4.0 * length(beside) < height {
                vertices[vertex] = place;
            }
        }
        let mut triangles = Vec::with_capacity(self.triangles().len() + 3 * marked.len());
        let mut origin = Vec::with_capacity(triangles.capacity());
        // Where the parts of each triangle begin.
        let mut first = Vec::with_capacity(self.triangles().len() + 1);
        for (t, corners) in self.triangles().iter().enumerate() {
            first.push(triangles.len());
            let place = |k: usize| (newest[t] + k) % 3;
            let whole = [0, 1, 2].map(|k| corners[place(k)]);
            let [cut, right, left] = [0, 1, 2].map(|k| middles[self.triangle_edges()[t][place(k)]]);
            match cut {
                None => triangles.push(whole),
                Some(m) => {
                    for (half, other) in halves(whole, m).into_iter().zip([left, right]) {
                        match other {
                            None => triangles.push(half),
                            Some(m) => triangles.extend(halves(half, m)),
                        }
                    }
                }
            }
            origin.resize(triangles.len(), t);
        }
        first.push(triangles.len());
        let parts = |members: &Vec<usize>| {
            members.iter().flat_map(|&t| first[t]..first[t + 1]).collect::<Vec<usize>>()
        };
        let surfaces: BTreeMap<String, Vec<usize>> =
            self.surfaces().iter().map(|(name, members)| (name.clone(), parts(members))).collect();
        let named = self.topology.boundaries.iter().map(|(name, edges)| {
            let halved = edges.iter().flat_map(|&edge| {
                let [a, b] = self.ends(edge);
                match middles[self.number_of(edge)] {
                    None => vec![[a, b]],
                    Some(m) => vec![[a, m], [m, b]],
                }
            });
            (name.clone(), halved.collect())
        });
        // Parts cover what their triangles did, so that no check for overlaps is needed.
        let mut mesh = Mesh::of_edges(vertices, triangles, named.collect(), &|_, _| true)?;
        Arc::make_mut(&mut mesh.topology).faults.clone_from(&self.topology.faults);
        let mesh = mesh.with_names(surfaces, self.topology.points.clone())?;
        Ok(Refinement { mesh, parents, origin })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Degree, Diagonal, Rectangle, Space, Trapezoid};

    /// The cosines of a triangle's angles in order, to nine digits: the same for similar triangles.
    fn class(mesh: &Mesh, t: usize) -> [i64; 3] {
        let triangle = mesh.triangle(t);
        let mut cosines = [0, 1, 2].map(|i| {
            let [a, b] = [triangle.edge(i + 1), -triangle.edge(i + 2)];
            (1e9 * a.dot(&b) / (length(a) * length(b))).round() as i64
        });
        cosines.sort_unstable();
        cosines
    }

    /// Refines around a point again and again.
    fn towards(mut mesh: Mesh, [x, y]: [f64; 2], times: usize) -> Mesh {
        let mut newest = mesh.opposite_longest();
        for _ in 0..times {
            let near = |t: &usize| {
                let c = mesh.triangle(*t).point([1.0 / 3.0; 3]);
                (c.x - x).hypot(c.y - y) <= 1.5 * mesh.diameter(*t)
            };
            let marked: Vec<usize> = (0..mesh.triangles().len()).filter(near).collect();
            assert!(!marked.is_empty());
            mesh = mesh.bisected(&newest, &marked).unwrap().mesh;
            newest = vec![0; mesh.triangles().len()];
        }
        mesh
    }

    fn meshes() -> [Mesh; 3] {
        let (nx, ny, diagonal) = (3, 2, Diagonal::Crossed);
        let rectangle = Rectangle { width: 2.0, height: 1.0, nx, ny, diagonal };
        let trapezoid = Trapezoid { omega: 2.2, n: 3 };
        let moved = rectangle.perturbed(0.2, 5).unwrap();
        [rectangle.mesh().unwrap(), trapezoid.mesh().unwrap(), moved]
    }

    #[test]
    fn meshes_refined_towards_a_point_keep_their_area_their_names_and_their_smallest_angle() {
        for coarse in meshes() {
            let area = |mesh: &Mesh| -> f64 {
                (0..mesh.triangles().len()).map(|t| mesh.triangle(t).double_area()).sum()
            };
            let largest_cosine =
                |mesh: &Mesh| (0..mesh.triangles().len()).map(|t| class(mesh, t)[2]).max().unwrap();
            // The first two generations have all classes.
            let all = |mesh: Mesh| {
                let (newest, every) =
                    (mesh.opposite_longest(), (0..mesh.triangles().len()).collect::<Vec<_>>());
                let once = mesh.bisected(&newest, &every).unwrap().mesh;
                let every: Vec<usize> = (0..once.triangles().len()).collect();
                once.bisected(&vec![0; every.len()], &every).unwrap().mesh
            };
            let bound = largest_cosine(&all(coarse.clone()));
            let side = |mesh: &Mesh| -> f64 {
                let bottom = mesh.edges_of("bottom").unwrap();
                bottom.iter().map(|&edge| mesh.length_and_normal(edge).0).sum()
            };
            let fine = towards(coarse.clone(), [1.0, 0.0], 12);
            assert!((area(&fine) / area(&coarse) - 1.0).abs() < 1e-12);
            assert!((side(&fine) / side(&coarse) - 1.0).abs() < 1e-12);
            assert!(fine.edges_of("bottom").unwrap().len() > 12);
            let smallest = (0..fine.triangles().len()).map(|t| fine.diameter(t));
            let smallest = smallest.fold(f64::INFINITY, f64::min);
            assert!(smallest < 1e-3, "{smallest}");
            assert!(fine.triangles().len() < 4000, "{}", fine.triangles().len());
            // A cosine of the list is rounded to 1e-9.
            assert!(largest_cosine(&fine) <= bound + 2);
        }
    }

    #[test]
    fn surfaces_points_inner_curves_and_affine_fields_are_kept() {
        let square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let named = [("floor", vec![[1, 0]]), ("seam", vec![[0, 2]])]
            .map(|(name, edges)| (name.to_owned(), edges));
        let coarse = Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]], named).unwrap();
        let surfaces = BTreeMap::from([("upper".to_owned(), vec![1])]);
        let points = BTreeMap::from([("corner".to_owned(), vec![2])]);
        let coarse = coarse.with_names(surfaces, points).unwrap();
        let affine = |[x, y]: [f64; 2]| [1.0 + 2.0 * x - y, x + 0.5 * y];
        let newest = coarse.opposite_longest();
        let fine = coarse.bisected(&newest, &[1]).unwrap();
        let u: Vec<[f64; 2]> = coarse.vertices().iter().map(|&x| affine(x)).collect();
        let expected: Vec<[f64; 2]> = fine.mesh.vertices().iter().map(|&x| affine(x)).collect();
        assert_eq!(fine.prolonged(&coarse, &u), expected, "binary fractions, so exactly");
        let quadratic = |[x, y]: [f64; 2]| [x * x - x * y, 1.0 + y * y - 2.0 * x];
        let nodes = |mesh: &Mesh| Space::new(mesh, Degree::Two).nodes().to_vec();
        let u: Vec<[f64; 2]> = nodes(&coarse).into_iter().map(quadratic).collect();
        let found = fine.prolonged(&coarse, &u);
        for (found, x) in found.iter().zip(nodes(&fine.mesh)) {
            let expected = quadratic(x);
            // A dozen operations on numbers below 4.
            assert!((0..2).all(|c| (found[c] - expected[c]).abs() < 1e-14), "{x:?}: {found:?}");
        }
        assert_eq!(found.len(), nodes(&fine.mesh).len());
        let upper: f64 = fine
            .mesh
            .surface("upper")
            .unwrap()
            .iter()
            .map(|&t| {
                assert_eq!(fine.origin[t], 1);
                fine.mesh.triangle(t).double_area()
            })
            .sum();
        assert_eq!(upper, 1.0);
        assert_eq!(fine.mesh.point("corner"), Ok(2));
        assert!(matches!(fine.mesh.edges_of("seam"), Err(MeshError::InnerEdge { .. })));
        assert_eq!(fine.mesh.triangles().len(), 6);
        assert_eq!(fine.mesh.edges_of("floor").unwrap().len(), 1, "its triangle is only halved");
    }
}
