//! Merges vertices that are closer than a tolerance.
//!
//! A mesh that was written with few digits, or put together from pieces, has vertices close to each other where one is meant.
//! Vertices no further apart than a given share of the body's size (the longer side of its box, as rounding is a share of the
//! coordinates) become the first of them; so do chains of such vertices. Triangles that lose an edge are left out.

use super::groups::groups;
use super::tree::{Bounds, Tree};

/// Vertices and triangles after merging.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// The vertices that are left.
    pub(crate) vertices: Vec<[f64; 2]>,
    /// The triangles that are left, in the new numbers.
    pub(crate) triangles: Vec<[usize; 3]>,
    /// The new number of each old vertex.
    pub vertex: Vec<usize>,
    /// The old number of each vertex that is left.
    pub(crate) old_vertex: Vec<usize>,
    /// The old number of each triangle that is left.
    pub old_triangle: Vec<usize>,
}

/// Merges the vertices that are no further apart than `share` of the body's size, but for two that `are_apart`. Each index must be
/// that of a vertex.
pub fn merge(
    vertices: &[[f64; 2]],
    triangles: &[[usize; 3]],
    share: f64,
    are_apart: impl Fn(usize, usize) -> bool,
) -> Merged {
    let distance = share * Bounds::around(vertices.iter().copied()).size();
    let tree = Tree::new(vertices.iter().map(|&v| Bounds::around([v])).collect());
    let mut near = Vec::new();
    for (v, &[x, y]) in vertices.iter().enumerate() {
        tree.meeting(Bounds::around([[x, y]]).widened(distance), |w| {
            let [p, q] = vertices[w];
            if w > v && (x - p).hypot(y - q) <= distance && !are_apart(v, w) {
                near.push([v, w]);
            }
        });
    }
    let vertex = groups(vertices.len(), near);
    let mut old_vertex = Vec::new();
    for (v, &group) in vertex.iter().enumerate() {
        if group == old_vertex.len() {
            old_vertex.push(v);
        }
    }
    let merged = triangles.iter().map(|t| t.map(|v| vertex[v])).enumerate();
    let (old_triangle, triangles) =
        merged.filter(|(_, [a, b, c])| a != b && b != c && c != a).unzip();
    let vertices = old_vertex.iter().map(|&v| vertices[v]).collect();
    Merged { vertices, triangles, vertex, old_vertex, old_triangle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Mesh, MeshError};

    #[test]
    fn a_seam_rounded_to_six_decimals_is_closed_and_nothing_else_changes() {
        let third = 1.0 / 3.0;
        let vertices =
            vec![[0.0, 0.0], [third, 0.0], [0.0, 1.0], [0.333333, 1e-7], [1.0, 1.0], [-0.0, 1.0]];
        let triangles = vec![[0, 1, 2], [3, 4, 5]];
        let torn = Mesh::new(vertices.clone(), triangles.clone(), []);
        assert!(matches!(torn, Err(MeshError::Duplicate { .. })));
        let merged = merge(&vertices, &triangles, 1e-6, |_, _| false);
        assert_eq!(merged.vertices, [[0.0, 0.0], [third, 0.0], [0.0, 1.0], [1.0, 1.0]]);
        assert_eq!(merged.triangles, [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(merged.vertex, [0, 1, 2, 1, 3, 2]);
        assert_eq!(merged.old_vertex, [0, 1, 2, 4]);
        assert!(Mesh::new(merged.vertices, merged.triangles, []).is_ok());
        let coinciding = merge(&vertices, &triangles, 1e-8, |_, _| false);
        assert_eq!(coinciding.vertices.len(), 5);
        let apart = merge(&vertices, &triangles, 1e-6, |v, w| [v, w] == [1, 3]);
        assert_eq!(apart.vertex, [0, 1, 2, 3, 4, 2]);
    }

    #[test]
    fn triangles_that_lose_an_edge_are_left_out() {
        let vertices = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1e-9, 1.0]];
        let merged = merge(&vertices, &[[0, 1, 2], [2, 1, 3]], 1e-6, |_, _| false);
        assert_eq!(merged.triangles, [[0, 1, 2]]);
        assert_eq!(merged.old_triangle, [0]);
    }
}
