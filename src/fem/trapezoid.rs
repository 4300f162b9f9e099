//! Structured meshes of the trapezoid (0,0), (1,0), (1,1), (cot omega, 1), whose angle at the origin is omega: the unit
//! square in n x n cells, diagonals right, under the map (s, t) -> (s + (1 - s) t cot omega, t). Its sides keep the
//! names left (slanted), right, bottom and top.

use super::mesh::{Mesh, MeshError};
use super::rectangle::{Diagonal, Rectangle};

/// A trapezoid cut into `n` x `n` cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    /// The angle at the origin, between pi/2 and pi.
    pub omega: f64,
    /// Cells along each side.
    pub n: usize,
}

impl Trapezoid {
    /// The mesh.
    ///
    /// # Errors
    /// As [`Rectangle::mesh`]; for angles outside (0, pi) triangles turn over.
    pub fn mesh(&self) -> Result<Mesh, MeshError> {
        self.perturbed(0.0, 0)
    }

    /// The mesh with the vertices of the square moved as in [`Rectangle::perturbed`] before they are mapped.
    ///
    /// # Errors
    /// As [`Rectangle::perturbed`].
    pub fn perturbed(&self, amount: f64, seed: u64) -> Result<Mesh, MeshError> {
        let (nx, ny) = (self.n, self.n);
        let square = Rectangle { width: 1.0, height: 1.0, nx, ny, diagonal: Diagonal::Right };
        let tan = self.omega.tan();
        square.mapped(amount, seed, |[s, t]| [s + (1.0 - s) * t / tan, t])
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_abs_diff_eq;
    use nalgebra::Vector2;

    use super::*;

    #[test]
    fn the_left_side_leans_by_omega_and_the_others_stay() {
        let omega = 3.0 * PI / 4.0;
        for amount in [0.0, 0.2] {
            let mesh = Trapezoid { omega, n: 4 }.perturbed(amount, 3).unwrap();
            for &edge in mesh.edges_of("left").unwrap() {
                let n = mesh.length_and_normal(edge).1;
                // The outward normal of the ray theta = omega is (-sin omega, cos omega).
                let expected = Vector2::new(-omega.sin(), omega.cos());
                // Moved vertices lie on the ray to rounding, half of an edge of 1/8 apart.
                assert_abs_diff_eq!(n, expected, epsilon = 1e-13);
            }
            for (side, normal) in
                [("right", [1.0, 0.0]), ("bottom", [0.0, -1.0]), ("top", [0.0, 1.0])]
            {
                for &edge in mesh.edges_of(side).unwrap() {
                    assert_eq!(mesh.length_and_normal(edge).1, Vector2::from(normal));
                }
            }
        }
    }
}
