//! A triangle T: area, barycentric coordinates, edges and their outward normals.
//!
//! ```text
//!            2
//!            | \          vertices counter-clockwise;
//!    edge 1  |   \  edge 0     edge i lies opposite vertex i
//!            |     \      and runs from vertex i+1 to vertex i+2 (mod 3)
//!            0 ----- 1
//!             edge 2
//! ```

use nalgebra::Vector2;

use super::Scalar;

/// A triangle with its vertices counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle<S> {
    /// The corners.
    pub vertices: [Vector2<S>; 3],
}

impl<S: Scalar> Triangle<S> {
    /// Edge `i` (mod 3) as the vector from vertex i+1 to vertex i+2.
    pub fn edge(&self, i: usize) -> Vector2<S> {
        self.vertices[(i + 2) % 3] - self.vertices[(i + 1) % 3]
    }

    /// 2 |T|: positive for counter-clockwise vertices.
    pub fn double_area(&self) -> S {
        self.edge(1).perp(&self.edge(2))
    }

    /// |E_i| n: the outward normal of edge `i` (mod 3), as long as the edge.
    pub fn scaled_normal(&self, i: usize) -> Vector2<S> {
        let edge = self.edge(i);
        Vector2::new(edge[1], -edge[0])
    }

    /// The gradients of the three barycentric coordinates: grad l_i = -|E_i| n_i / (2 |T|).
    pub fn barycentric_gradients(&self) -> [Vector2<S>; 3] {
        let double_area = self.double_area();
        [0, 1, 2].map(|i| -self.scaled_normal(i) / double_area)
    }

    /// The point with barycentric coordinates `l`.
    pub fn point(&self, l: [S; 3]) -> Vector2<S> {
        let [a, b, c] = self.vertices;
        a * l[0] + b * l[1] + c * l[2]
    }
}

/// The barycentric coordinates of the point at `s` in \[0, 1\] of edge `i` (mod 3), from vertex i+1 to vertex i+2.
pub fn on_edge<S: Scalar>(i: usize, s: S) -> [S; 3] {
    let mut l = [S::from(0); 3];
    l[(i + 1) % 3] = S::from(1) - s;
    l[(i + 2) % 3] = s;
    l
}
