//! Bodies of revolution: the meridian is the plane of r and z, areas and lengths count r, and a displacement has a hoop strain.
//!
//! a(u, v) = int r sigma(u):eps(v), eps = (u_r,r ; u_z,z ; u_r,z + u_z,r ; theta(u)). **The hoop strain theta(v) is the projection
//! of v_r / r**: the polynomial of degree p - 1 on each triangle with int r theta q = int v_r q for all q of that degree. So all
//! numbers are rational in the data, and no triangle on the axis is special. docs/theory.md, section 11.
//!
//! A polynomial of degree p - 1 is given by its values at the points of [`Element::at_stiffness_points`], the middle of the
//! triangle for P1 and the midpoints of its edges for P2. Integrals are divided by |T| or |E|, forces are those of a radian.
//! `radii` is r at the corners of a triangle, or at the ends of an edge.

use nalgebra::{Matrix2, Vector2};

use super::edge_integral::edge_mass;
use super::{Element, Material, Scalar, Stress, Triangle};

/// int r f g over a triangle for functions of degree p - 1 in terms of their values at the points: entry (a, b) is that of f at a
/// and g at b. The other entries are 0.
pub fn mass<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    radii: [S; 3],
) -> [[S; 3]; 3] {
    let mut mass = [[S::from(0); 3]; 3];
    if E::POINTS == 1 {
        mass[0][0] = (radii[0] + radii[1] + radii[2]) / S::from(3);
        return mass;
    }
    for a in 0..3 {
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        let others = radii[b] + radii[c];
        mass[a][a] = (radii[a] + others + others) / S::from(15);
        let opposite = radii[a] + radii[b];
        mass[a][b] = (radii[c] + radii[c] - opposite) / S::from(30);
        mass[b][a] = mass[a][b];
    }
    mass
}

/// int v_r q over a triangle, for q that is 1 at a point and 0 at the others: what each node's v_r counts in it, in thirtieths.
/// Entries of points that the element does not have are 0.
pub fn shares<E: Element<N, M>, const N: usize, const M: usize>() -> [[i32; N]; 3] {
    let mut shares = [[0; N]; 3];
    if E::POINTS == 1 {
        shares[0] = [10; N];
        return shares;
    }
    for (a, row) in shares.iter_mut().enumerate() {
        for (k, share) in row.iter_mut().enumerate() {
            *share = match (k < 3, k % 3 == a) {
                (true, true) => -2,
                (true, false) => 1,
                (false, true) => 6,
                (false, false) => 2,
            };
        }
    }
    shares
}

/// int v_r q for the same q, from v_r at the nodes.
pub fn means<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    radial: &[S; N],
) -> [S; 3] {
    shares::<E, N, M>().map(|row| {
        let terms = row.iter().zip(radial).filter(|(share, _)| **share != 0);
        terms.fold(S::from(0), |sum, (&share, &v)| sum + S::from(share) * v) / S::from(30)
    })
}

/// The solution of `mass` theta = `means` at the points of an element.
pub fn projected<S: Scalar>(mass: &[[S; 3]; 3], means: [S; 3], points: usize) -> [S; 3] {
    if points == 1 {
        return [means[0] / mass[0][0], S::from(0), S::from(0)];
    }
    // Cramer's rule: the matrix is symmetric, and its eigenvalues are between 1/20 and 11/50 of the sum of the radii.
    let cofactor = |i: usize, j: usize| {
        let [a, b, c, d] = [(i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3];
        mass[a][c] * mass[b][d] - mass[a][d] * mass[b][c]
    };
    let first = [0, 1, 2].map(|j| cofactor(0, j));
    let determinant = mass[0][0] * first[0] + mass[0][1] * first[1] + mass[0][2] * first[2];
    let (middle, across, last) = (cofactor(1, 1), cofactor(1, 2), cofactor(2, 2));
    let [x, y, z] = means;
    [
        first[0] * x + first[1] * y + first[2] * z,
        first[1] * x + middle * y + across * z,
        first[2] * x + across * y + last * z,
    ]
    .map(|value| value / determinant)
}

/// theta(v) at the points, from v_r at the nodes.
pub fn hoop_strain<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    radii: [S; 3],
    radial: &[S; N],
) -> [S; 3] {
    projected(&mass::<E, S, N, M>(radii), means::<E, S, N, M>(radial), E::POINTS)
}

/// The value at the barycentric coordinates `l` of the function of degree p - 1 with these values at the points.
pub fn value_at<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    at_points: [S; 3],
    l: [S; 3],
) -> S {
    if E::POINTS == 1 {
        return at_points[0];
    }
    // 1 at the midpoint of edge a, 0 at those of the others: 1 - 2 l_a.
    let (one, two) = (S::from(1), S::from(2));
    (0..3).fold(S::from(0), |sum, a| sum + at_points[a] * (one - two * l[a]))
}

/// The element matrix of a(.,.) = int r sigma(u):eps(v) of a radian, in blocks as those of [`stiffness`](super::element::stiffness).
/// Exact.
pub fn stiffness<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    triangle: &Triangle<S>,
    radii: [S; 3],
    material: &Material<S>,
) -> [[Matrix2<S>; N]; N] {
    let barycentric = triangle.barycentric_gradients();
    let area = triangle.double_area() / S::from(2);
    let (zero, thirty) = (S::from(0), S::from(30));
    let mass = mass::<E, S, N, M>(radii);
    let shares = shares::<E, N, M>();
    let mut slopes = [[Vector2::zeros(); N]; 3];
    let mut points = slopes.iter_mut();
    E::at_stiffness_points(|l: [S; 3], _| {
        if let Some(slopes) = points.next() {
            *slopes = E::gradients(l, barycentric);
        }
    });
    let mut matrix = [[Matrix2::zeros(); N]; N];
    for j in 0..N {
        for d in 0..2 {
            let hoop = if d == 0 {
                let means = shares.map(|row| S::from(row[j]) / thirty);
                projected(&mass, means, E::POINTS)
            } else {
                [zero; 3]
            };
            let at = |a: usize| {
                let slope = slopes[a][j];
                let gradient = Matrix2::from_fn(|i, k| if i == d { slope[k] } else { zero });
                material.stress_of_revolution(gradient, hoop[a])
            };
            let mut states = [at(0); 3];
            (1..E::POINTS).for_each(|a| states[a] = at(a));
            for b in 0..E::POINTS {
                let weighted = weighted(&mass, &states, b, E::POINTS);
                for i in 0..N {
                    let mut force = weighted.traction(slopes[b][i]);
                    force[0] += states[b].1 * S::from(shares[b][i]) / thirty;
                    for c in 0..2 {
                        matrix[i][j][(c, d)] += area * force[c];
                    }
                }
            }
        }
    }
    matrix
}

/// The stress in the meridian at point `b` that stands for r times the stress: tested with a strain of degree p - 1 at the points, the
/// sum is int r sigma:eps.
pub fn weighted<S: Scalar>(
    mass: &[[S; 3]; 3],
    states: &[(Stress<S>, S); 3],
    b: usize,
    points: usize,
) -> Stress<S> {
    (1..points).fold(states[0].0 * mass[0][b], |sum, a| sum + states[a].0 * mass[a][b])
}

/// The sharp constant R |T| / |E| of int_E r w^2 <= R int_T r w^2 for w of degree p - 1, with r at the two ends of E and at the
/// corner opposite: r_E / r_c for P1, with the means of r on the edge and the triangle; for P2 a root of a quadratic, at most 4 and 3
/// where r is constant.
pub fn trace_constant<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    [a, b]: [S; 2],
    c: S,
    root: impl Fn(S) -> S,
) -> S {
    let two = S::from(2);
    if E::DEGREE == 1 {
        return (a + b) / two * S::from(3) / (a + b + c);
    }
    let [[n_aa, n_ab], [_, n_bb]] = edge_mass([a, b]);
    let m = corner_mass([a, b, c]);
    let s = |i: usize, j: usize| m[i][j] - m[i][2] * m[j][2] / m[2][2];
    let (s_aa, s_ab, s_bb) = (s(0, 0), s(0, 1), s(1, 1));
    let of_s = s_aa * s_bb - s_ab * s_ab;
    let of_n = n_aa * n_bb - n_ab * n_ab;
    let mixed = n_aa * s_bb + n_bb * s_aa - two * n_ab * s_ab;
    let square = (mixed * mixed - S::from(4) * of_s * of_n).split(|_| S::from(0), |x| x);
    (mixed + root(square)) / (two * of_s)
}

/// int r f g over a triangle for affine functions in terms of their values at its corners.
pub fn corner_mass<S: Scalar>(radii: [S; 3]) -> [[S; 3]; 3] {
    let sixty = S::from(60);
    let entry = |i: usize, j: usize| {
        let weight = |k: usize| match (i == j, k == i || k == j) {
            (true, true) => 6,
            (true, false) | (false, true) => 2,
            (false, false) => 1,
        };
        (0..3).fold(S::from(0), |sum, k| sum + S::from(weight(k)) * radii[k]) / sixty
    };
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

/// The amount by which an edge counts more in kappa where the direction of contact turns along it, with r at its ends and `cosine` =
/// n~ . n~' there: 1 for P1, and 1 + (1 - cosine) rho / (1 - rho) for P2, rho = (a + b) / ((3 a + b) (a + 3 b))^{1/2}. That is the
/// 2 - cosine of [`turning_factor`](super::contact_edge::turning_factor) where r is constant; the factor is attained.
pub fn turning_factor<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    radii: [S; 2],
    cosine: S,
    root: impl Fn(S) -> S,
) -> S {
    let one = S::from(1);
    if E::DEGREE == 1 {
        return one;
    }
    let rho = coupling(radii, root);
    one + (one - cosine) * rho / (one - rho)
}

/// rho: the entry of [`edge_mass`] off the diagonal beside the root of the product of the other two.
fn coupling<S: Scalar>([a, b]: [S; 2], root: impl Fn(S) -> S) -> S {
    let three = S::from(3);
    (a + b) / root((three * a + b) * (a + three * b))
}

/// The amount by which an edge counts more in kappa where both components of the traction act, whatever the angle:
/// (1 + rho) / (1 - rho). With the values at the ends multiplied by the roots of the diagonal of [`edge_mass`] the integral is between 1 - rho and 1 + rho times the sum of their squares.
pub fn turning_factor_of_both<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    radii: [S; 2],
    root: impl Fn(S) -> S,
) -> S {
    let one = S::from(1);
    if E::DEGREE == 1 {
        return one;
    }
    let rho = coupling(radii, root);
    (one + rho) / (one - rho)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::P2;

    #[test]
    fn a_traction_of_both_components_counts_by_the_factor_at_most_whatever_the_angle() {
        for [a, b] in [[1.0, 1.0], [1.0, 2.0], [0.0, 1.0], [3.0, 0.5]] {
            let factor = turning_factor_of_both::<P2, f64, 6, 3>([a, b], f64::sqrt);
            let n = edge_mass([a, b]);
            let square =
                |[p, q]: [f64; 2]| p * p * n[0][0] + q * q * n[1][1] + 2.0 * p * q * n[0][1];
            let mut most = 0.0_f64;
            for (angle, k) in (0..=24).flat_map(|i| (1..40).map(move |k| (i, k))) {
                let (sine, cosine) = (f64::from(angle) * std::f64::consts::PI / 24.0).sin_cos();
                // tau is (1, 0) at the start and q (1, 0) at the end, and turned there.
                let q = -f64::from(k) / 10.0;
                let turned = square([1.0, cosine * q]) + n[1][1] * (sine * q) * (sine * q);
                most = most.max(turned / square([1.0, q]));
            }
            assert!(most <= factor * (1.0 + 1e-14), "{most} {factor}");
            // It is attained, by opposite directions and the right q, to what the steps of q leave.
            assert!(most >= 0.97 * factor, "{most} {factor}");
        }
    }
}
