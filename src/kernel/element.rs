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
pub fn stiffness<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    triangle: &Triangle<S>,
    material: &Material<S>,
) -> [[Matrix2<S>; N]; N] {
    let barycentric = triangle.barycentric_gradients();
    let area = triangle.double_area() / S::from(2);
    let mut matrix = [[Matrix2::zeros(); N]; N];
    E::at_stiffness_points(|l: [S; 3], weight| {
        let g = E::gradients(l, barycentric);
        let weighted = material.times(weight * area);
        for i in 0..N {
            for j in 0..=i {
                matrix[i][j] += weighted.energy_of_shapes(g[i], g[j]);
            }
        }
    });
    for i in 0..N {
        for j in 0..i {
            matrix[j][i] = matrix[i][j].transpose();
        }
    }
    matrix
}
