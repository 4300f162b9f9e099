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

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    const T: Triangle<f64> = Triangle {
        vertices: [Vector2::new(1.0, 1.0), Vector2::new(4.0, 2.0), Vector2::new(2.0, 5.0)],
    };

    #[test]
    fn area_is_positive_counter_clockwise_and_changes_sign_with_the_order() {
        assert_eq!(T.double_area(), 11.0);
        let [a, b, c] = T.vertices;
        assert_eq!(Triangle { vertices: [a, c, b] }.double_area(), -11.0);
    }

    #[test]
    fn outward_normals_add_up_to_zero_and_point_away_from_the_opposite_vertex() {
        let n = [0, 1, 2].map(|i| T.scaled_normal(i));
        assert_eq!(n.iter().sum::<Vector2<f64>>(), Vector2::zeros());
        for (i, n) in n.iter().enumerate() {
            assert!(n.dot(&(T.vertices[(i + 1) % 3] - T.vertices[i])) > 0.0);
        }
    }

    #[test]
    fn barycentric_gradients_are_dual_to_the_vertices() {
        let g = T.barycentric_gradients();
        for (i, g) in g.iter().enumerate() {
            for j in 0..3 {
                let value = g.dot(&(T.vertices[j] - T.vertices[(i + 1) % 3]));
                // Two products of numbers below 1: a few unit roundoffs.
                assert_abs_diff_eq!(value, f64::from(u8::from(i == j)), epsilon = 1e-15);
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
