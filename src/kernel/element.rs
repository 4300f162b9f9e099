//! The finite elements of V^h on one triangle: P1 as in section 2.2, P2 as in Remark 3.7, and a(.,.) on them.
//!
//! ```text
//!     2                2            nodes 0, 1, 2 are the vertices,
//!     | \              | \          node 3 + i is the midpoint of edge i
//!     |   \            4   3
//!     |     \          |     \      on edge i the nodes are, in this order:
//!     0 ---- 1         0 - 5 - 1    start i+1, end i+2 (mod 3), and for P2 the midpoint 3+i
//!        P1               P2
//! ```

use nalgebra::{Matrix2, SMatrix, SVector};

use super::material::outer;
use super::{Material, Scalar, Triangle};

/// A Lagrange element with `N` nodes on a triangle, `M` of them on each edge.
pub trait Element<const N: usize, const M: usize> {
    /// The polynomial degree p.
    const DEGREE: usize;

    /// The constant c_p of the trace inequality |w|_E^2 <= c_p (|E|/|T|) |w|_T^2 for polynomials w of degree p - 1:
    /// p (p + 1) / 2. It makes (11) explicit.
    const TRACE_CONSTANT: i32;

    /// The number of points of [`Element::at_stiffness_points`]: the values there determine a polynomial of degree p - 1.
    const POINTS: usize;

    /// The shape functions at the barycentric coordinates `l`.
    fn values<S: Scalar>(l: [S; 3]) -> [S; N];

    /// Their gradients at `l`, given the gradients of the barycentric coordinates.
    fn gradients<S: Scalar, const D: usize>(
        l: [S; 3],
        barycentric: [SVector<S, D>; 3],
    ) -> [SVector<S, D>; N];

    /// The nodes on edge `i` (mod 3): start, end, then the midpoint if there is one.
    fn edge_nodes(i: usize) -> [usize; M];

    /// The shape functions of an edge, in the order of [`Element::edge_nodes`], at `s` in \[0, 1\] from start to end.
    fn edge_values<S: Scalar>(s: S) -> [S; M];

    /// Where on the edge its nodes lie.
    fn edge_positions<S: Scalar>() -> [S; M];

    /// Calls `f` at the points (barycentric coordinates) of a rule with equal weights, given as the last argument, that
    /// add up to 1: exact for a product of two gradients.
    fn at_stiffness_points<S: Scalar>(f: impl FnMut([S; 3], S));
}

/// Piecewise affine.
#[derive(Clone, Copy, Debug)]
pub struct P1;

/// Piecewise quadratic.
#[derive(Clone, Copy, Debug)]
pub struct P2;

impl Element<3, 2> for P1 {
    const DEGREE: usize = 1;
    const TRACE_CONSTANT: i32 = 1;
    const POINTS: usize = 1;

    fn values<S: Scalar>(l: [S; 3]) -> [S; 3] {
        l
    }

    fn gradients<S: Scalar, const D: usize>(
        _: [S; 3],
        barycentric: [SVector<S, D>; 3],
    ) -> [SVector<S, D>; 3] {
        barycentric
    }

    #[inline]
    fn edge_nodes(i: usize) -> [usize; 2] {
        [(i + 1) % 3, (i + 2) % 3]
    }

    fn edge_values<S: Scalar>(s: S) -> [S; 2] {
        [S::from(1) - s, s]
    }

    fn edge_positions<S: Scalar>() -> [S; 2] {
        [S::from(0), S::from(1)]
    }

    fn at_stiffness_points<S: Scalar>(mut f: impl FnMut([S; 3], S)) {
        f([S::from(1) / S::from(3); 3], S::from(1));
    }
}

impl Element<6, 3> for P2 {
    const DEGREE: usize = 2;
    const TRACE_CONSTANT: i32 = 3;
    const POINTS: usize = 3;

    fn values<S: Scalar>(l: [S; 3]) -> [S; 6] {
        let (one, two, four) = (S::from(1), S::from(2), S::from(4));
        let [a, b, c] = l;
        [
            a * (two * a - one),
            b * (two * b - one),
            c * (two * c - one),
            four * b * c,
            four * c * a,
            four * a * b,
        ]
    }

    fn gradients<S: Scalar, const D: usize>(
        l: [S; 3],
        barycentric: [SVector<S, D>; 3],
    ) -> [SVector<S, D>; 6] {
        let (one, four) = (S::from(1), S::from(4));
        let vertex = |i: usize| barycentric[i] * (four * l[i] - one);
        let middle = |j: usize, k: usize| (barycentric[k] * l[j] + barycentric[j] * l[k]) * four;
        [vertex(0), vertex(1), vertex(2), middle(1, 2), middle(2, 0), middle(0, 1)]
    }

    #[inline]
    fn edge_nodes(i: usize) -> [usize; 3] {
        [(i + 1) % 3, (i + 2) % 3, 3 + i % 3]
    }

    fn edge_values<S: Scalar>(s: S) -> [S; 3] {
        let (one, two, four) = (S::from(1), S::from(2), S::from(4));
        let r = one - s;
        [r * (one - two * s), s * (two * s - one), four * r * s]
    }

    fn edge_positions<S: Scalar>() -> [S; 3] {
        [S::from(0), S::from(1), S::from(1) / S::from(2)]
    }

    fn at_stiffness_points<S: Scalar>(mut f: impl FnMut([S; 3], S)) {
        let (zero, half, third) = (S::from(0), S::from(1) / S::from(2), S::from(1) / S::from(3));
        f([zero, half, half], third);
        f([half, zero, half], third);
        f([half, half, zero], third);
    }
}

/// The displacement gradient du_i/dx_j of a discrete field, from its nodal values and the gradients of its shapes.
pub fn displacement_gradient<S: Scalar, const N: usize, const D: usize>(
    nodal: &[SVector<S, D>; N],
    gradients: &[SVector<S, D>; N],
) -> SMatrix<S, D, D> {
    let mut sum = SMatrix::zeros();
    for (u, g) in nodal.iter().zip(gradients) {
        sum += outer(*u, *g);
    }
    sum
}

/// The element matrix of a(.,.) = int_T sigma(u):eps(v) in blocks: entry (c, d) of block `[i][j]` belongs to v = N_i e_c
/// and u = N_j e_d. Exact.
pub fn stiffness<E, S, const N: usize, const M: usize>(
    triangle: &Triangle<S>,
    material: &Material<S>,
) -> [[Matrix2<S>; N]; N]
where
    E: Element<N, M>,
    S: Scalar,
{
    let barycentric = triangle.barycentric_gradients();
    let area = triangle.double_area() / S::from(2);
    let mut matrix = [[Matrix2::zeros(); N]; N];
    E::at_stiffness_points(|l: [S; 3], weight| {
        let g = E::gradients(l, barycentric);
        let weighted = material.times(weight * area);
        for i in 0..N {
            for j in 0..N {
                matrix[i][j] += weighted.energy_of_shapes(g[i], g[j]);
            }
        }
    });
    matrix
}

#[cfg(test)]
mod tests {
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use nalgebra::Vector2;

    use super::*;
    use crate::Plane;
    use crate::triangle::on_edge;

    const T: Triangle<f64> = Triangle {
        vertices: [Vector2::new(1.0, 1.0), Vector2::new(4.0, 2.0), Vector2::new(2.0, 5.0)],
    };
    const INSIDE: [f64; 3] = [0.2, 0.5, 0.3];

    fn nodes<E: Element<N, M>, const N: usize, const M: usize>() -> [[f64; 3]; N] {
        let mut points = [[0.0; 3]; N];
        for i in 0..3 {
            for (node, s) in E::edge_nodes(i).into_iter().zip(E::edge_positions::<f64>()) {
                points[node] = on_edge(i, s);
            }
        }
        points
    }

    /// Nodality, partition of unity, and the trace on each edge, for one element. Sums of six products below 1.
    fn is_a_lagrange_element<E: Element<N, M>, const N: usize, const M: usize>() {
        for (i, point) in nodes::<E, N, M>().into_iter().enumerate() {
            let values = E::values(point);
            for (j, value) in values.into_iter().enumerate() {
                assert_eq!(value, f64::from(u8::from(i == j)));
            }
        }
        assert_abs_diff_eq!(E::values(INSIDE).iter().sum::<f64>(), 1.0, epsilon = 1e-15);
        for i in 0..3 {
            let values = E::values(on_edge(i, 0.3_f64));
            for (node, value) in E::edge_nodes(i).into_iter().zip(E::edge_values(0.3_f64)) {
                assert_abs_diff_eq!(values[node], value, epsilon = 1e-15);
            }
            let on_the_edge: f64 = E::edge_values(0.3_f64).iter().sum();
            assert_abs_diff_eq!(on_the_edge, 1.0, epsilon = 1e-15);
        }
    }

    #[test]
    fn p1_and_p2_are_lagrange_elements() {
        is_a_lagrange_element::<P1, 3, 2>();
        is_a_lagrange_element::<P2, 6, 3>();
    }

    /// Gradients against central differences, which are exact (to rounding) for polynomials of degree 2.
    fn gradients_are_derivatives<E: Element<N, M>, const N: usize, const M: usize>() {
        let barycentric = T.barycentric_gradients();
        let gradients = E::gradients(INSIDE, barycentric);
        for c in 0..2 {
            let shifted = |h: f64| E::values([0, 1, 2].map(|i| INSIDE[i] + h * barycentric[i][c]));
            let (plus, minus) = (shifted(0.5), shifted(-0.5));
            for j in 0..N {
                // Values up to 10: some ten roundings.
                assert_abs_diff_eq!(gradients[j][c], plus[j] - minus[j], epsilon = 1e-14);
            }
        }
    }

    #[test]
    fn gradients_are_the_derivatives_of_the_values() {
        gradients_are_derivatives::<P1, 3, 2>();
        gradients_are_derivatives::<P2, 6, 3>();
    }

    #[test]
    fn a_triangle_in_space_has_the_gradients_of_its_plane() {
        let barycentric = T.barycentric_gradients();
        let in_space = P2::gradients(INSIDE, barycentric.map(|g| g.push(0.0)));
        for (g, flat) in in_space.iter().zip(P2::gradients(INSIDE, barycentric)) {
            assert_eq!(*g, flat.push(0.0));
        }
    }

    /// The element matrix is symmetric and its kernel contains the three rigid body motions.
    fn stiffness_is_sound<E: Element<N, M>, const N: usize, const M: usize>() {
        let material = Material::lame(3.0, 0.7, Plane::Strain);
        let k = stiffness::<E, f64, N, M>(&T, &material);
        for i in 0..N {
            for j in 0..N {
                // Entries up to 10.
                assert_abs_diff_eq!(k[i][j], k[j][i].transpose(), epsilon = 1e-14);
            }
        }
        let points = nodes::<E, N, M>().map(|l| T.point(l));
        let motions = [
            points.map(|_| Vector2::new(1.0, 0.0)),
            points.map(|_| Vector2::new(0.0, 1.0)),
            points.map(|x| Vector2::new(-x.y, x.x)),
        ];
        for motion in motions {
            for row in &k {
                let force: Vector2<f64> = row.iter().zip(motion).map(|(k, u)| k * u).sum();
                // Twelve products of entries and places, each below 50.
                assert_abs_diff_eq!(force, Vector2::zeros(), epsilon = 1e-13);
            }
        }
    }

    #[test]
    fn stiffness_is_symmetric_and_blind_to_rigid_body_motions() {
        stiffness_is_sound::<P1, 3, 2>();
        stiffness_is_sound::<P2, 6, 3>();
    }

    #[test]
    fn stiffness_of_a_quadratic_field_is_its_energy() {
        // u = (x^2, x y): grad u = [[2x, 0], [y, x]], sigma:eps = 2 mu eps:eps + lambda tr^2, degree 2: the midpoint
        // rule of the edges is exact for it.
        let material = Material::lame(3.0, 0.7, Plane::Strain);
        let k = stiffness::<P2, f64, 6, 3>(&T, &material);
        let u = nodes::<P2, 6, 3>().map(|l| {
            let x = T.point(l);
            x * x.x
        });
        let mut energy = 0.0;
        for i in 0..6 {
            for j in 0..6 {
                energy += u[i].dot(&(k[i][j] * u[j]));
            }
        }
        let expected: f64 = (0..3)
            .map(|i| {
                let [x, y] = T.point(on_edge(i, 0.5)).into();
                let density = 3.0 * (3.0 * x) * (3.0 * x)
                    + 2.0 * 0.7 * (4.0 * x * x + x * x + 2.0 * (y / 2.0) * (y / 2.0));
                density * 5.5 / 3.0
            })
            .sum();
        // 144 products, among which the rigid part of u cancels.
        assert_relative_eq!(energy, expected, max_relative = 1e-12);
    }
}
