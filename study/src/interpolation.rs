//! Theorem 3.5 with a number, for P1 and u in H^2 (nu = 1/2): the interpolation estimates (22)-(24) with explicit constants
//! (docs/theory.md, 9.6). With eta = u - I u, I u the Lagrange interpolant, K the largest eigenvalue of A (2 mu + 2 \[lambda\]+
//! where it is isotropic), M = A_nnnn (lambda + 2 mu), on a triangle T with the sides a, b, c, the diameter h and an edge E on
//! Gamma_C:
//!
//! (22)  |grad eta|_T <= c_T |u|_{2,T},   c_T^2 = (abc/(4 |T|))^2 - (a^2 + b^2 + c^2)/30 - (|T|^2/5)(a^-2 + b^-2 + c^-2)
//!       |grad eta|_E <= t_T |u|_{2,T},   t_T^2 = (|E|/|T|) (c_T^2 + h c_T)
//! (23)  |eta_n|_E <= (|E|/pi) t_T |u|_{2,T}
//! (24)  |sigma_n(eta)|_E <= (M K)^(1/2) t_T |u|_{2,T}
//!
//! c_T is Kobayashi's upper bound of the constant of P1 interpolation in the seminorms of H^1 and H^2.

use std::f64::consts::PI;

use super::a_priori;
use signorini::contact::Piece;
use signorini::exact::ExactSolution;
use signorini::exact::errors::{Errors, POINTS};
use signorini::kernel::{Material, Scalar, Triangle};
use signorini::model::graded_quadrature::{EdgePoint, Rule};
use signorini::model::material::largest_eigenvalue;
use signorini::model::space::Space;

/// c_T^2 of (22).
pub fn gradient_constant_squared<S: Scalar>(triangle: &Triangle<S>) -> S {
    let [a, b, c] = [0, 1, 2].map(|i| triangle.edge(i)).map(|edge| edge.dot(&edge));
    let area = triangle.double_area() / S::from(2);
    let squared = area * area;
    let inverses = S::from(1) / a + S::from(1) / b + S::from(1) / c;
    a * b * c / (S::from(16) * squared)
        - (a + b + c) / S::from(30)
        - squared / S::from(5) * inverses
}

/// t_T^2 of the trace inequality for an edge of this length, with `c` = c_T.
pub fn trace_constant_squared<S: Scalar>([length, area, diameter]: [S; 3], c: S) -> S {
    length / area * (c * c + diameter * c)
}

/// The constants of (22)-(24) on a mesh, as factors of |u|_{2,T}.
pub struct Interpolation {
    /// The constant of |eta|_a on each triangle.
    energy: Vec<f64>,
    /// On each contact edge: its triangle, and the constants of |sigma_n(eta)|_gamma and of |gamma^(-1/2) eta_n|.
    contact: Vec<(usize, [f64; 2])>,
}

impl Interpolation {
    /// The constants for a body of this material with these edges on Gamma_C.
    pub fn new(space: &Space, contact: &[Piece], material: &Material<f64>) -> Self {
        let both = largest_eigenvalue(material);
        let gradient = |triangle: Triangle<f64>| gradient_constant_squared(&triangle).sqrt();
        let c: Vec<f64> = space.triangles::<3>().map(|(triangle, _)| gradient(triangle)).collect();
        let on_edge = |edge: &Piece| {
            let t = edge.edge().triangle;
            let (mesh, root) = (space.mesh(), edge.gamma.sqrt());
            let sizes = [edge.length, mesh.triangle(t).double_area() / 2.0, mesh.diameter(t)];
            let trace = trace_constant_squared(sizes, c[t]).sqrt();
            let stress = (material.normal_stiffness(edge.normal()) * both).sqrt() * trace;
            (t, [root * stress, edge.length / PI * trace / root])
        };
        Interpolation {
            contact: contact.iter().map(on_edge).collect(),
            energy: c.iter().map(|c| both.sqrt() * c).collect(),
        }
    }

    /// Bounds of the distances H, S and Q of the interpolant from u (the other distances are left at 0), from |u|_{2,T} on
    /// each triangle and |gamma^(-1/2) (g - g_h)| on each contact edge.
    pub fn distances(&self, seminorms: &[f64], gaps: &[f64]) -> Errors {
        let energy = self.energy.iter().zip(seminorms).map(|(c, u)| (c * u).powi(2)).sum::<f64>();
        let (mut normal_stress, mut operator) = (0.0, 0.0);
        for (&(t, [stress, displacement]), gap) in self.contact.iter().zip(gaps) {
            normal_stress += (stress * seminorms[t]).powi(2);
            operator += ((stress + displacement) * seminorms[t] + gap).powi(2);
        }
        let [energy, normal_stress, operator] = [energy, normal_stress, operator].map(f64::sqrt);
        Errors { energy, normal_stress, operator, ..Errors::default() }
    }

    /// The number C of Theorem 9.5, in (stress length^2)^(1/2): (|e|_a^2 + |z|_gamma^2/delta)^(1/2) <= C |u|_{2,Omega} for
    /// every u in H^2, where the gap is affine along each contact edge.
    pub fn constant(&self, kappa: f64) -> f64 {
        let energy = self.energy.iter().copied().fold(0.0, f64::max);
        // A triangle can have two edges on Gamma_C.
        let mut squares = vec![[0.0; 2]; self.energy.len()];
        for &(t, [stress, displacement]) in &self.contact {
            squares[t][0] += stress * stress;
            squares[t][1] += (stress + displacement).powi(2);
        }
        let largest = |i: usize| squares.iter().map(|s| s[i]).fold(0.0, f64::max).sqrt();
        let (normal_stress, operator) = (largest(0), largest(1));
        a_priori::sharp(kappa, &Errors { energy, normal_stress, operator, ..Errors::default() })
    }
}

/// Theorem 9.5 for one solution u: a bound of (|e|_a^2 + |z|_gamma^2/delta)^(1/2) for the P1 solution with exact contact
/// integrals and loads; `None` where u is not in H^2, or unless 0 <= kappa < 1.
pub fn bound(
    space: &Space,
    contact: &[Piece],
    exact: &dyn ExactSolution,
    kappa: f64,
) -> Option<f64> {
    let seminorms = seminorms(space, exact)?;
    let rule = Rule::new(exact.features(), POINTS);
    let gap = |edge: &Piece| {
        let ends = space.mesh().places_of_ends(edge.edge());
        let [start, end] = [0, 1].map(|a| edge.geometry.nodes[a].gap);
        let mut square = 0.0;
        rule.on_edge(ends, [], |EdgePoint { s, x, weight }| {
            let difference = exact.gap(x) - ((1.0 - s) * start + s * end);
            square += weight * edge.length / edge.gamma * difference * difference;
        });
        square.sqrt()
    };
    let gaps: Vec<f64> = contact.iter().map(gap).collect();
    let constants = Interpolation::new(space, contact, exact.material());
    (0.0..1.0)
        .contains(&kappa)
        .then(|| a_priori::sharp(kappa, &constants.distances(&seminorms, &gaps)))
}

/// |u|_{2,T} on each triangle, |u|_{2,T}^2 = the integral of the sum of all (d_j d_k u_i)^2; `None` where u is not in H^2.
pub fn seminorms(space: &Space, exact: &dyn ExactSolution) -> Option<Vec<f64>> {
    let rule = Rule::new(exact.features(), POINTS);
    let on_triangle = |(triangle, _)| {
        let mut square = Some(0.0);
        rule.on_triangle(&triangle, |_, x, weight| {
            let density = exact.second_derivatives(x).map(|components| {
                components.iter().map(|[xx, xy, yy]| xx * xx + 2.0 * xy * xy + yy * yy).sum::<f64>()
            });
            square = square.zip(density).map(|(sum, density)| sum + weight * density);
        });
        square.map(f64::sqrt)
    };
    space.triangles::<3>().map(on_triangle).collect()
}
