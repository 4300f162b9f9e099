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

use super::Scalar;

/// A triangle with its vertices counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle<S> {
    /// The corners.
    pub vertices: [[S; 2]; 3],
}

impl<S: Scalar> Triangle<S> {
    /// Edge `i` (mod 3) as the vector from vertex i+1 to vertex i+2.
    pub fn edge(&self, i: usize) -> [S; 2] {
        let [a, b] = [self.vertices[(i + 1) % 3], self.vertices[(i + 2) % 3]];
        [b[0] - a[0], b[1] - a[1]]
    }

    /// 2 |T|: positive for counter-clockwise vertices.
    pub fn double_area(&self) -> S {
        let ([a, b], [c, d]) = (self.edge(2), self.edge(1));
        b * c - a * d
    }

    /// |E_i| n: the outward normal of edge `i` (mod 3), as long as the edge.
    pub fn scaled_normal(&self, i: usize) -> [S; 2] {
        let [x, y] = self.edge(i);
        [y, -x]
    }

    /// The gradients of the three barycentric coordinates: grad l_i = -|E_i| n_i / (2 |T|).
    pub fn barycentric_gradients(&self) -> [[S; 2]; 3] {
        let double_area = self.double_area();
        [0, 1, 2].map(|i| self.scaled_normal(i).map(|c| -c / double_area))
    }

    /// The point with barycentric coordinates `l`.
    pub fn point(&self, l: [S; 3]) -> [S; 2] {
        let [a, b, c] = self.vertices;
        [0, 1].map(|i| l[0] * a[i] + l[1] * b[i] + l[2] * c[i])
    }
}

/// The barycentric coordinates of the point at `s` in \[0, 1\] of edge `i` (mod 3), from vertex i+1 to vertex i+2.
pub fn on_edge<S: Scalar>(i: usize, s: S) -> [S; 3] {
    let mut l = [S::from(0); 3];
    l[(i + 1) % 3] = S::from(1) - s;
    l[(i + 2) % 3] = s;
    l
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: Triangle<f64> = Triangle { vertices: [[1.0, 1.0], [4.0, 2.0], [2.0, 5.0]] };

    #[test]
    fn area_is_positive_counter_clockwise_and_changes_sign_with_the_order() {
        assert_eq!(T.double_area(), 11.0);
        let [a, b, c] = T.vertices;
        assert_eq!(Triangle { vertices: [a, c, b] }.double_area(), -11.0);
    }

    #[test]
    fn outward_normals_add_up_to_zero_and_point_away_from_the_opposite_vertex() {
        let n = [0, 1, 2].map(|i| T.scaled_normal(i));
        assert_eq!([n[0][0] + n[1][0] + n[2][0], n[0][1] + n[1][1] + n[2][1]], [0.0; 2]);
        for (i, n) in n.iter().enumerate() {
            let (from, to) = (T.vertices[i], T.vertices[(i + 1) % 3]);
            assert!(n[0] * (to[0] - from[0]) + n[1] * (to[1] - from[1]) > 0.0);
        }
    }

    #[test]
    fn barycentric_gradients_are_dual_to_the_vertices() {
        let g = T.barycentric_gradients();
        for (i, g) in g.iter().enumerate() {
            for j in 0..3 {
                let d = [0, 1].map(|c| T.vertices[j][c] - T.vertices[(i + 1) % 3][c]);
                let value = g[0] * d[0] + g[1] * d[1];
                assert!((value - f64::from(u8::from(i == j))).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn an_edge_runs_from_its_start_to_its_end() {
        for i in 0..3 {
            assert_eq!(T.point(on_edge(i, 0.0)), T.vertices[(i + 1) % 3]);
            assert_eq!(T.point(on_edge(i, 1.0)), T.vertices[(i + 2) % 3]);
        }
    }
}
