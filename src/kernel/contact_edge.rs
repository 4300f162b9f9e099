//! One edge E of Gamma_C with the triangle T that owns it: the functionals P0 and sigma_n, the matrix of
//! -int_E gamma sigma_n(u) sigma_n(v) in A_gamma, and the share of E in the coercivity number kappa.
//!
//! On E, P0(v) = v_n - gamma sigma_n(v) is a polynomial of degree p, so its values at the M = p + 1 nodes of the edge
//! determine it; sigma_n(v) has degree p - 1 <= 1, so its values at the two ends do.

use nalgebra::{Matrix2, Vector2};

use super::triangle::on_edge;
use super::{Element, Material, Scalar, Triangle};

/// The functionals on one contact edge. A functional is a vector per node of the triangle: its value at v is the sum
/// over the nodes j of `functional[j] . v_j`.
#[derive(Clone, Copy, Debug)]
pub struct ContactEdge<S, const N: usize, const M: usize> {
    /// P0 at each node of the edge, in the order of [`Element::edge_nodes`].
    pub p0: [[Vector2<S>; N]; M],
    /// sigma_n at the start and at the end of the edge.
    pub sigma_n: [[Vector2<S>; N]; 2],
}

impl<S: Scalar, const N: usize, const M: usize> ContactEdge<S, N, M> {
    /// The functionals on edge `i` (mod 3) of `triangle`, with the unit outward normal `n` and gamma = gamma0 h_T of (7).
    pub fn new<E: Element<N, M>>(
        triangle: &Triangle<S>,
        i: usize,
        n: Vector2<S>,
        material: &Material<S>,
        gamma: S,
    ) -> Self {
        let barycentric = triangle.barycentric_gradients();
        let sigma_n_at = |s: S| {
            E::gradients(on_edge(i, s), barycentric).map(|g| material.normal_stress_of_shape(g, n))
        };
        // The first two nodes are the start and the end.
        let at_nodes = E::edge_positions().map(sigma_n_at);
        let mut p0 = at_nodes.map(|row| row.map(|v| -(v * gamma)));
        for (row, node) in p0.iter_mut().zip(E::edge_nodes(i)) {
            row[node] += n;
        }
        ContactEdge { p0, sigma_n: [at_nodes[0], at_nodes[1]] }
    }

    /// [`ContactEdge::new`] where the direction of contact is a field n~: P0(v) = n~ . v - gamma s(v), s(v) = n~ . sigma(v)
    /// n, with the unit vectors `directions` at the nodes. s is affine on the edge, from its values at the two ends, in P0 as
    /// in A: this is what J_h and the consistency of (8) need. With n~ = n it is the functional of [`ContactEdge::new`].
    pub fn along<E: Element<N, M>>(
        triangle: &Triangle<S>,
        i: usize,
        n: Vector2<S>,
        directions: &[Vector2<S>; M],
        material: &Material<S>,
        gamma: S,
    ) -> Self {
        let trace = |row: &mut [Vector2<S>; N], a: usize| row[E::edge_nodes(i)[a]] += directions[a];
        let ends = [S::from(0), S::from(1)];
        Self::with_traces::<E>((triangle, i), ends, n, directions, (material, gamma), trace)
    }

    /// [`ContactEdge::along`] on a part of the edge, on which the nodes of a piece lie at `places`: P0 and s are the polynomials of
    /// degree p and 1 on the piece that have the values n~ . v - gamma s(v) at its nodes and n~ . sigma(v) n at its ends.
    pub fn between<E: Element<N, M>>(
        triangle: &Triangle<S>,
        i: usize,
        places: [S; M],
        n: Vector2<S>,
        directions: &[Vector2<S>; M],
        material: &Material<S>,
        gamma: S,
    ) -> Self {
        let trace = |row: &mut [Vector2<S>; N], a: usize| {
            for (entry, shape) in row.iter_mut().zip(E::values(on_edge(i, places[a]))) {
                *entry += directions[a] * shape;
            }
        };
        let ends = [places[0], places[1]];
        Self::with_traces::<E>((triangle, i), ends, n, directions, (material, gamma), trace)
    }

    /// The functionals with s at the `ends` of the piece; `trace` adds n~ . v at a node of the piece.
    fn with_traces<E: Element<N, M>>(
        (triangle, i): (&Triangle<S>, usize),
        ends: [S; 2],
        n: Vector2<S>,
        directions: &[Vector2<S>; M],
        (material, gamma): (&Material<S>, S),
        trace: impl Fn(&mut [Vector2<S>; N], usize),
    ) -> Self {
        let barycentric = triangle.barycentric_gradients();
        let at_end = |a: usize| {
            let gradients = E::gradients(on_edge(i, ends[a]), barycentric);
            gradients.map(|g| material.traction_of_shape(g, n, directions[a]))
        };
        let sigma_n = [at_end(0), at_end(1)];
        let mut p0 = E::edge_positions().map(|s| {
            std::array::from_fn(|j| {
                let [start, end] = [sigma_n[0][j], sigma_n[1][j]];
                -((start * (S::from(1) - s) + end * s) * gamma)
            })
        });
        for (a, row) in p0.iter_mut().enumerate() {
            trace(row, a);
        }
        ContactEdge { p0, sigma_n }
    }

    /// int_E gamma sigma_n(u) sigma_n(v) for v = N_i e_c, u = N_j e_d in entry (c, d), with `weight` = gamma |E|. Exact.
    pub fn stress_product(&self, weight: S, i: usize, j: usize) -> Matrix2<S> {
        let [start, end] = &self.sigma_n;
        Matrix2::from_fn(|c, d| {
            weight * integral_of_product([start[i][c], end[i][c]], [start[j][d], end[j][d]])
        })
    }
}

/// int_0^1 f g for two affine functions given by their values at 0 and 1.
pub fn integral_of_product<S: Scalar>(f: [S; 2], g: [S; 2]) -> S {
    let two = S::from(2);
    (f[0] * (two * g[0] + g[1]) + f[1] * (g[0] + two * g[1])) / S::from(6)
}

/// The amount by which the length of an edge counts more in kappa where the direction of contact turns along it, for `cosine` =
/// n~ . n~' at its two ends: 1 for P1, whose stress is constant on the triangle, and 2 - cosine for P2. Then
/// int_E s(v)^2 is at most the factor times int_E |sigma(v) n|^2 (docs/theory.md, Lemma 2.1b; the factor is attained).
pub fn turning_factor<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(cosine: S) -> S {
    if E::DEGREE == 1 { S::from(1) } else { S::from(2) - cosine }
}

/// [`turning_factor`] where both components of the stress count, that along the direction of contact and that across:
/// int_E |s(v)|^2 is at most the factor times int_E |sigma(v) n|^2, and the factor x + (x^2 - 1)^(1/2), x = (4 - cosine) / 3, of P2 is
/// attained (docs/theory.md, 13.2).
pub fn turning_factor_of_both<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    cosine: S,
    root: impl Fn(S) -> S,
) -> S {
    if E::DEGREE == 1 {
        return S::from(1);
    }
    let x = (S::from(4) - cosine) / S::from(3);
    x + root((x * x - S::from(1)).split(|_| S::from(0), |square| square))
}

/// The constant c of (n~ . sigma(v) n)^2 <= c sigma(v):eps(v) along an edge with the unit normal n: for one direction of contact d,
/// d . Q(n) d with the acoustic tensor Q(n), which is A_nnnn for d = n; for directions that turn (`None`) the largest eigenvalue of
/// Q(n), which serves |sigma(v) n|^2. lambda + 2 mu, which does for all unit vectors d, where A is isotropic.
pub fn traction_stiffness<S: Scalar>(
    material: &Material<S>,
    n: Vector2<S>,
    direction: Option<Vector2<S>>,
    root: impl Fn(S) -> S,
) -> S {
    if material.is_isotropic() {
        return material.normal_stiffness(n);
    }
    let q = material.acoustic(n);
    match direction {
        Some(d) => d[0] * (q.m11 * d[0] + (q.m12 + q.m21) * d[1]) + d[1] * q.m22 * d[1],
        None => {
            let two = S::from(2);
            let (half, shear) = ((q.m11 - q.m22) / two, (q.m12 + q.m21) / two);
            let square = (half * half + shear * shear).split(|_| S::from(0), |x| x);
            (q.m11 + q.m22) / two + root(square)
        }
    }
}

/// The share of an edge on Gamma_C in kappa_T / gamma0 of its triangle: c_p A_nnnn h_T |E| / |T|, so that with the sum kappa_T of
/// its edges |gamma^{1/2} sigma_n(v)|^2 on them is at most kappa_T a_T(v, v), the explicit form of (11). `stiffness` is A_nnnn,
/// lambda + 2 mu where A is isotropic; for other components of sigma n it is the largest eigenvalue of the acoustic tensor.
pub fn coercivity_constant<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    stiffness: S,
    diameter: S,
    contact_length: S,
    area: S,
) -> S {
    S::from(E::TRACE_CONSTANT) * stiffness * diameter * contact_length / area
}
