//! Stresses for what affine body forces and tractions lack (docs/a-posteriori.md, section 7.4).
//!
//! On a triangle let B = sum c_ia l_j l_k l_a E_i (x) E_i over the edges i and the vertices a (i, j, k in turn). It has no
//! traction on the boundary: on edge i, E_i . N_i = 0, on the others l_j l_k = 0. Its divergence is
//!
//! div B = sum c_ia E_i d_ia,   d_ia = l_a (l_j - l_k) + l_j l_k (grad_k - grad_j) l_a,
//!
//! for along E_i l_k grows by 1 and l_j falls by 1. These nine fields are independent, and the quadratic fields that are
//! orthogonal to rigid motions have nine dimensions: for a force f' of that kind there is a B with div B = -f', and
//! int f' . w = int B : eps(w) <= |B|_{C^-1} |w|_a with no constant. Of any other f' the B that leaves least is taken; the rest
//! is orthogonal to rigid motions as f' is.
//!
//! A traction t' on edge i that is the second Legendre polynomial 1 - 6 s (1 - s) times c is that of -6 l_j l_k S + tau, S
//! symmetric with S n = c and tau the composite stress with the traction c on the edge and minus the divergence of the first for
//! a load.
//!
//! Without them the bound of P2 is 1.40 times as large for the smooth solution of `study -- convergence` on 8 x 8 cells, and at
//! most 1.16 times for loads given as expressions in cases.

use nalgebra::Vector2;

use super::sweeps::{factor_positive, substitute};
use crate::kernel::composite::{Composite, Frame, Loads};
use crate::kernel::{Material, Stress, Triangle};
use crate::model::quadrature;

/// The numbers c_ia.
const UNKNOWNS: usize = 9;

/// l_j l_k l_a and d_ia of unknown 3 i + a, at a point.
fn shapes(l: [f64; 3]) -> [(f64, f64); UNKNOWNS] {
    std::array::from_fn(|unknown| {
        let (i, a) = (unknown / 3, unknown % 3);
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let turn = f64::from(u8::from(a == k)) - f64::from(u8::from(a == j));
        let ends = l[j] * l[k];
        (ends * l[a], l[a] * (l[j] - l[k]) + ends * turn)
    })
}

/// Takes -div B off a force that is given by its values at the points of a rule (barycentric coordinates, weight, value), for
/// the B that leaves least, and returns |B|_{C^-1}.
pub(super) fn take_off(
    triangle: &Triangle<f64>,
    material: &Material<f64>,
    force: &mut [([f64; 3], f64, Vector2<f64>)],
) -> f64 {
    if force.is_empty() {
        return 0.0;
    }
    let edges = [0, 1, 2].map(|i| triangle.edge(i));
    // The products of the divergences: exact for their degree, 4.
    let mut matrix = [0.0; UNKNOWNS * UNKNOWNS];
    for (l, weight) in quadrature::triangle(3) {
        let shapes = shapes(l);
        for (m, (_, d)) in shapes.iter().enumerate() {
            for (n, (_, e)) in shapes.iter().enumerate() {
                let along = edges[m / 3].dot(&edges[n / 3]);
                matrix[m * UNKNOWNS + n] += weight * along * d * e;
            }
        }
    }
    let Some(factor) = factor_positive(&mut matrix, UNKNOWNS) else { return 0.0 };
    let area = triangle.double_area() / 2.0;
    let mut c = [0.0; UNKNOWNS];
    for (l, weight, f) in force.iter() {
        for (m, (_, d)) in shapes(*l).into_iter().enumerate() {
            c[m] -= weight / area * d * edges[m / 3].dot(f);
        }
    }
    substitute(&factor, &mut c);
    let mut square = 0.0;
    for (l, weight, f) in force {
        let mut along = [0.0; 3];
        for (m, (value, d)) in shapes(*l).into_iter().enumerate() {
            *f += edges[m / 3] * (c[m] * d);
            along[m / 3] += c[m] * value;
        }
        let stress = [0, 1, 2].map(|i| {
            let [x, y] = edges[i].into();
            Stress::new([x * x, y * y, x * y]) * along[i]
        });
        square += *weight * material.squares().of_stress(stress[0] + stress[1] + stress[2]);
    }
    square.sqrt()
}

/// The norm of a stress without divergence whose traction is the second Legendre polynomial times `c` on edge `i` and 0 on
/// the others.
pub(super) fn of_traction(
    triangle: &Triangle<f64>,
    material: &Material<f64>,
    i: usize,
    c: Vector2<f64>,
) -> f64 {
    let (bubble, tau) = with_traction(triangle, i, c);
    let (part, mut square) = (triangle.double_area() / 6.0, 0.0);
    // A square of degree 4.
    let rule = quadrature::triangle(3);
    for side in 0..3 {
        for (mu, weight) in &rule {
            let mut l = [mu[0] / 3.0; 3];
            l[(side + 1) % 3] += mu[1];
            l[(side + 2) % 3] += mu[2];
            let there = tau.at(side, *mu) + bubble * (l[(i + 1) % 3] * l[(i + 2) % 3]);
            square += weight * part * material.squares().of_stress(there);
        }
    }
    square.sqrt()
}

/// -6 S and tau.
fn with_traction(
    triangle: &Triangle<f64>,
    i: usize,
    c: Vector2<f64>,
) -> (Stress<f64>, Composite<f64>) {
    let scaled = triangle.scaled_normal(i);
    let length = scaled.dot(&scaled).sqrt();
    let n = scaled / length;
    let s = c * n.transpose() + n * c.transpose() - n * n.transpose() * c.dot(&n);
    let bubble = s * -6.0;
    // grad (l_j l_k) is grad l_k at vertex j, grad l_j at k and 0 at i.
    let gradients = triangle.barycentric_gradients();
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    let mut loads = Loads { forces: [[Vector2::zeros(); 2]; 3], body: [Vector2::zeros(); 3] };
    loads.forces[i] = [c * length; 2];
    loads.body[j] = bubble * gradients[k];
    loads.body[k] = bubble * gradients[j];
    let frame = Frame::new(triangle);
    let tau = Composite::new(&frame, &loads).bent(&frame, &loads.body);
    (Stress::new([bubble[(0, 0)], bubble[(1, 1)], bubble[(0, 1)]]), tau)
}

#[cfg(test)]
mod tests {
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use nalgebra::Matrix2;

    use super::*;
    use crate::kernel::Plane;

    const T: Triangle<f64> = Triangle {
        vertices: [Vector2::new(0.3, -0.2), Vector2::new(2.0, 0.1), Vector2::new(0.7, 1.9)],
    };

    fn force(f: impl Fn(Vector2<f64>) -> Vector2<f64>) -> Vec<([f64; 3], f64, Vector2<f64>)> {
        let points = quadrature::triangle(8).into_iter();
        points.map(|(l, w)| (l, w * T.double_area() / 2.0, f(T.point(l)))).collect()
    }

    fn square(force: &[([f64; 3], f64, Vector2<f64>)]) -> f64 {
        force.iter().map(|(_, weight, f)| weight * f.dot(f)).sum()
    }

    /// The force without its part along the affine functions, which 1, x, y make orthonormal by elimination.
    fn less_affine(force: &mut [([f64; 3], f64, Vector2<f64>)]) {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for a in 0..3 {
            let mut values: Vec<f64> = force.iter().map(|(l, ..)| l[a]).collect();
            let product = |u: &[f64], v: &[f64]| -> f64 {
                force.iter().zip(u).zip(v).map(|(((_, w, _), u), v)| w * u * v).sum()
            };
            for b in &basis {
                let along = product(b, &values);
                values.iter_mut().zip(b).for_each(|(v, b)| *v -= along * b);
            }
            let norm = product(&values, &values).sqrt();
            basis.push(values.iter().map(|v| v / norm).collect());
        }
        for b in &basis {
            let along: Vector2<f64> = force.iter().zip(b).map(|((_, w, f), b)| f * (*w * *b)).sum();
            force.iter_mut().zip(b).for_each(|((_, _, f), b)| *f -= along * *b);
        }
    }

    #[test]
    fn quadratic_forces_are_taken_off_whole_and_others_in_part() {
        let material = Material::lame(1.3, 0.7, Plane::Strain);
        let quadratic = |p: Vector2<f64>| Vector2::new(p.x * p.x - p.x * p.y, 0.3 * p.y * p.y);
        let mut f = force(quadratic);
        less_affine(&mut f);
        let before = square(&f);
        let norm = take_off(&T, &material, &mut f);
        // Squares of rounding errors of some hundred terms.
        assert!(square(&f) < 1e-24 * before, "{} {before}", square(&f));
        assert!(norm > 0.0);
        let mut f = force(|p| Vector2::new(p.x.powi(3), 0.0));
        less_affine(&mut f);
        let before = square(&f);
        take_off(&T, &material, &mut f);
        assert!(square(&f) > 1e-6 * before && square(&f) < before);
    }

    #[test]
    fn the_force_of_a_stress_has_the_norm_of_that_stress() {
        let (lambda, mu) = (1.3, 0.7);
        let c = [0.3, -0.7, 0.2, 0.9, -0.4, 0.5, -0.6, 0.8, 0.1];
        let slopes = T.barycentric_gradients();
        // B and div B, term by term.
        let of = |l: [f64; 3]| {
            let mut sum = (Matrix2::zeros(), Vector2::zeros());
            for (i, a) in (0..9).map(|n| (n / 3, n % 3)) {
                let (j, k, edge) = ((i + 1) % 3, (i + 2) % 3, T.edge(i));
                sum.0 += edge * edge.transpose() * (c[3 * i + a] * l[j] * l[k] * l[a]);
                let slope = slopes[j] * (l[k] * l[a]) + slopes[k] * (l[j] * l[a]);
                let slope = slope + slopes[a] * (l[j] * l[k]);
                sum.1 += edge * (c[3 * i + a] * slope.dot(&edge));
            }
            sum
        };
        let (mut force, mut square) = (Vec::new(), 0.0);
        for (l, weight) in quadrature::triangle(8) {
            let (weight, (b, divergence)) = (weight * T.double_area() / 2.0, of(l));
            force.push((l, weight, -divergence));
            let trace = b.trace();
            let density = b.dot(&b) - lambda / (2.0 * (lambda + mu)) * trace * trace;
            square += weight * density / (2.0 * mu);
        }
        let found = take_off(&T, &Material::lame(lambda, mu, Plane::Strain), &mut force);
        // A system of nine equations.
        assert_relative_eq!(found, square.sqrt(), max_relative = 1e-10);
    }

    #[test]
    fn a_traction_of_degree_2_has_a_stress_without_divergence() {
        let c = Vector2::new(0.7, -0.4);
        for i in 0..3 {
            let (bubble, tau) = with_traction(&T, i, c);
            let length = crate::model::mesh::length(T.scaled_normal(i));
            for side in 0..3 {
                for s in [0.0, 0.2, 0.7] {
                    let mut l = [0.0; 3];
                    (l[(side + 1) % 3], l[(side + 2) % 3]) = (1.0 - s, s);
                    let there = tau.at(side, [0.0, 1.0 - s, s])
                        + bubble * (l[(i + 1) % 3] * l[(i + 2) % 3]);
                    let legendre = 1.0 - 6.0 * s * (1.0 - s);
                    let expected = if side == i { c * (length * legendre) } else { 0.0 * c };
                    let found = there.traction(T.scaled_normal(side));
                    // A dozen operations on numbers below 10.
                    assert_abs_diff_eq!(found, expected, epsilon = 1e-13);
                }
            }
            // Its work with a field is that of its traction: for w = (x y, y^2), whose strain is affine.
            let strain = |p: Vector2<f64>| [p.y, 2.0 * p.y, p.x / 2.0];
            let mut inside = 0.0;
            for side in 0..3 {
                for (mu, weight) in quadrature::triangle(4) {
                    let mut l = [mu[0] / 3.0; 3];
                    l[(side + 1) % 3] += mu[1];
                    l[(side + 2) % 3] += mu[2];
                    let there = tau.at(side, mu) + bubble * (l[(i + 1) % 3] * l[(i + 2) % 3]);
                    let ([xx, yy, xy], e) = (there.components(), strain(T.point(l)));
                    let density = xx * e[0] + yy * e[1] + 2.0 * xy * e[2];
                    inside += weight * T.double_area() / 6.0 * density;
                }
            }
            let on_edge: f64 = quadrature::gauss(4)
                .into_iter()
                .map(|(s, weight)| {
                    let x = T.point(crate::kernel::triangle::on_edge(i, s));
                    let legendre = 1.0 - 6.0 * s * (1.0 - s);
                    weight * length * legendre * c.dot(&Vector2::new(x.x * x.y, x.y * x.y))
                })
                .sum();
            assert_abs_diff_eq!(inside, on_edge, epsilon = 1e-13);
            assert!(on_edge.abs() > 1e-2);
        }
    }
}
