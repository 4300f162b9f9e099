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

use super::triangle::on_edge;
use super::{Element, Material, Scalar, Stress, Triangle};

/// int r f g over a triangle for functions of degree p - 1 in terms of their values at the points: entry (a, b) is that of f at a
/// and g at b. The other entries are 0.
pub fn mass<E, S, const N: usize, const M: usize>(radii: [S; 3]) -> [[S; 3]; 3]
where
    E: Element<N, M>,
    S: Scalar,
{
    let mut mass = [[S::from(0); 3]; 3];
    if E::POINTS == 1 {
        mass[0][0] = sum(radii) / S::from(3);
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
pub fn shares<E, const N: usize, const M: usize>() -> [[i32; N]; 3]
where
    E: Element<N, M>,
{
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
pub fn means<E, S, const N: usize, const M: usize>(radial: &[S; N]) -> [S; 3]
where
    E: Element<N, M>,
    S: Scalar,
{
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
pub fn hoop_strain<E, S, const N: usize, const M: usize>(radii: [S; 3], radial: &[S; N]) -> [S; 3]
where
    E: Element<N, M>,
    S: Scalar,
{
    projected(&mass::<E, S, N, M>(radii), means::<E, S, N, M>(radial), E::POINTS)
}

/// The value at the barycentric coordinates `l` of the function of degree p - 1 with these values at the points.
pub fn value_at<E, S, const N: usize, const M: usize>(at_points: [S; 3], l: [S; 3]) -> S
where
    E: Element<N, M>,
    S: Scalar,
{
    if E::POINTS == 1 {
        return at_points[0];
    }
    // 1 at the midpoint of edge a, 0 at those of the others: 1 - 2 l_a.
    let (one, two) = (S::from(1), S::from(2));
    (0..3).fold(S::from(0), |sum, a| sum + at_points[a] * (one - two * l[a]))
}

/// The element matrix of a(.,.) = int r sigma(u):eps(v) of a radian, in blocks as those of [`stiffness`](super::element::stiffness).
/// Exact.
pub fn stiffness<E, S, const N: usize, const M: usize>(
    triangle: &Triangle<S>,
    radii: [S; 3],
    material: &Material<S>,
) -> [[Matrix2<S>; N]; N]
where
    E: Element<N, M>,
    S: Scalar,
{
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

/// int r f g over an edge for affine functions in terms of their values at its ends.
pub fn edge_mass<S: Scalar>([a, b]: [S; 2]) -> [[S; 2]; 2] {
    let (three, twelve) = (S::from(3), S::from(12));
    let across = (a + b) / twelve;
    [[(three * a + b) / twelve, across], [across, (a + three * b) / twelve]]
}

/// The sharp constant R |T| / |E| of int_E r w^2 <= R int_T r w^2 for w of degree p - 1, with r at the two ends of E and at the
/// corner opposite: r_E / r_c for P1, with the means of r on the edge and the triangle; for P2 a root of a quadratic, at most 4 and 3
/// where r is constant.
pub fn trace_constant<E, S, const N: usize, const M: usize>(
    [a, b]: [S; 2],
    c: S,
    root: impl Fn(S) -> S,
) -> S
where
    E: Element<N, M>,
    S: Scalar,
{
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
pub fn turning_factor<E, S, const N: usize, const M: usize>(
    [a, b]: [S; 2],
    cosine: S,
    root: impl Fn(S) -> S,
) -> S
where
    E: Element<N, M>,
    S: Scalar,
{
    let (one, three) = (S::from(1), S::from(3));
    if E::DEGREE == 1 {
        return one;
    }
    let rho = (a + b) / root((three * a + b) * (a + three * b));
    one + (one - cosine) * rho / (one - rho)
}

/// The amount by which an edge counts more in kappa where both components of the traction act, whatever the angle:
/// (1 + rho) / (1 - rho). With the values at the ends multiplied by the roots of the diagonal of [`edge_mass`] the integral is between 1 - rho and 1 + rho times the sum of their squares.
pub fn turning_factor_of_both<E, S, const N: usize, const M: usize>(
    [a, b]: [S; 2],
    root: impl Fn(S) -> S,
) -> S
where
    E: Element<N, M>,
    S: Scalar,
{
    let (one, three) = (S::from(1), S::from(3));
    if E::DEGREE == 1 {
        return one;
    }
    let rho = (a + b) / root((three * a + b) * (a + three * b));
    (one + rho) / (one - rho)
}

fn sum<S: Scalar>([a, b, c]: [S; 3]) -> S {
    a + b + c
}

/// The hoop strain in the functional of the stress s(v) = n~ . sigma(v) n on an edge of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct HoopStress<S, const N: usize> {
    /// The part of each node's v_r in s at the two ends of a piece of the edge.
    pub at_ends: [[S; N]; 2],
    /// The sums of these: s of the displacement e_r, which is no rigid motion.
    pub ring: [S; 2],
}

impl<S: Scalar, const N: usize> HoopStress<S, N> {
    /// At the `places` of the ends on edge `i` (mod 3) of a triangle with these `radii`, with the unit outward normal `n` and the
    /// directions n~ at the ends.
    pub fn new<E: Element<N, M>, const M: usize>(
        radii: [S; 3],
        (i, places): (usize, [S; 2]),
        n: Vector2<S>,
        directions: [Vector2<S>; 2],
        material: &Material<S>,
    ) -> Self {
        let mass = mass::<E, S, N, M>(radii);
        let shares = shares::<E, N, M>();
        let (stress, _) = material.stress_of_revolution(Matrix2::zeros(), S::from(1));
        let traction = directions.map(|d| stress.traction(n).dot(&d));
        let at_ends = |means: [S; 3]| {
            let theta = projected(&mass, means, E::POINTS);
            [0, 1].map(|a| traction[a] * value_at::<E, S, N, M>(theta, on_edge(i, places[a])))
        };
        let of_node = |j: usize| at_ends(shares.map(|row| S::from(row[j]) / S::from(30)));
        let nodes: [[S; 2]; N] = std::array::from_fn(of_node);
        let ring = at_ends(shares.map(|row| S::from(row.iter().sum::<i32>()) / S::from(30)));
        HoopStress { at_ends: [0, 1].map(|a| std::array::from_fn(|j| nodes[j][a])), ring }
    }
}

#[cfg(test)]
mod tests {
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use nalgebra::{Matrix2, Matrix3};

    use super::*;
    use crate::element::displacement_gradient;
    use crate::{P1, P2, Plane};

    /// Triangles in r >= 0: off the axis, with a corner and with an edge on it.
    const TRIANGLES: [Triangle<f64>; 4] = [
        Triangle {
            vertices: [Vector2::new(1.0, 1.0), Vector2::new(4.0, 2.0), Vector2::new(2.0, 5.0)],
        },
        Triangle {
            vertices: [Vector2::new(0.0, 1.0), Vector2::new(4.0, 2.0), Vector2::new(2.0, 5.0)],
        },
        Triangle {
            vertices: [Vector2::new(0.0, 1.0), Vector2::new(3.0, 2.0), Vector2::new(0.0, 5.0)],
        },
        Triangle {
            vertices: [Vector2::new(7.0, 0.0), Vector2::new(7.5, 0.1), Vector2::new(7.1, 0.3)],
        },
    ];

    fn radii(t: &Triangle<f64>) -> [f64; 3] {
        t.vertices.map(|x| x[0])
    }

    /// A rule that is exact to degree 5 (Radon), with weights that add up to 1: r, two strains and more than a test needs.
    fn fine() -> Vec<([f64; 3], f64)> {
        let root = 15.0_f64.sqrt();
        let mut rule = vec![([1.0 / 3.0; 3], 0.225)];
        for sign in [1.0, -1.0] {
            let (a, weight) = ((6.0 - sign * root) / 21.0, (155.0 - sign * root) / 1200.0);
            for i in 0..3 {
                let mut l = [a; 3];
                l[i] = 1.0 - 2.0 * a;
                rule.push((l, weight));
            }
        }
        rule
    }

    fn integral(f: impl Fn([f64; 3]) -> f64) -> f64 {
        fine().into_iter().map(|(l, weight)| weight * f(l)).sum()
    }

    fn affine<E: Element<N, M>, const N: usize, const M: usize>(a: usize, l: [f64; 3]) -> f64 {
        let mut at = [0.0; 3];
        at[a] = 1.0;
        value_at::<E, f64, N, M>(at, l)
    }

    /// The masses and the shares are the integrals that they stand for.
    fn are_integrals<E: Element<N, M>, const N: usize, const M: usize>() {
        for t in &TRIANGLES {
            let mass = mass::<E, f64, N, M>(radii(t));
            for a in 0..E::POINTS {
                for b in 0..E::POINTS {
                    let of = |l| t.point(l)[0] * affine::<E, N, M>(a, l) * affine::<E, N, M>(b, l);
                    // Some ten roundings of numbers up to 10.
                    assert_abs_diff_eq!(mass[a][b], integral(of), epsilon = 1e-14);
                }
                for k in 0..N {
                    let of = |l| affine::<E, N, M>(a, l) * E::values(l)[k];
                    let share = f64::from(shares::<E, N, M>()[a][k]) / 30.0;
                    assert_abs_diff_eq!(share, integral(of), epsilon = 1e-15);
                }
            }
        }
    }

    #[test]
    fn masses_and_shares_are_the_integrals_that_they_stand_for() {
        are_integrals::<P1, 3, 2>();
        are_integrals::<P2, 6, 3>();
    }

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

    fn field<const N: usize>() -> [Vector2<f64>; N] {
        std::array::from_fn(|j| Vector2::new(0.3 + 0.7 * j as f64, -0.2 + 0.1 * (j * j) as f64))
    }

    /// The element matrix against int r sigma:eps by the fine rule, which the control misses without the hoop strain.
    fn stiffness_is_the_energy<E: Element<N, M>, const N: usize, const M: usize>(
        material: &Material<f64>,
    ) {
        for t in &TRIANGLES {
            let u = field::<N>();
            let k = stiffness::<E, f64, N, M>(t, radii(t), material);
            let mut found = 0.0;
            for i in 0..N {
                for j in 0..N {
                    assert_abs_diff_eq!(k[i][j], k[j][i].transpose(), epsilon = 1e-11);
                    found += u[i].dot(&(k[i][j] * u[j]));
                }
            }
            let theta = hoop_strain::<E, f64, N, M>(radii(t), &u.map(|u| u[0]));
            let area = t.double_area() / 2.0;
            let energy = |with: f64| {
                let density = |l| {
                    let slopes = E::gradients(l, t.barycentric_gradients());
                    let gradient: Matrix2<f64> = displacement_gradient(&u, &slopes);
                    let theta = with * value_at::<E, f64, N, M>(theta, l);
                    let (stress, hoop) = material.stress_of_revolution(gradient, theta);
                    t.point(l)[0] * (stress.matrix().dot(&gradient) + hoop * theta)
                };
                area * integral(density)
            };
            // Up to 144 products, among which a part of u cancels.
            assert_relative_eq!(found, energy(1.0), max_relative = 1e-11);
            assert!((found - energy(0.0)).abs() > 1e-3 * found);
        }
    }

    #[test]
    fn stiffness_is_the_energy_with_the_weight_and_the_hoop_strain() {
        let orthotropic = Material::tensor([12.0, 3.0, 0.5, 5.0, -0.2, 4.0], Some([0.2, 0.3, 0.1]));
        for material in
            [Material::lame(3.0, 0.7, Plane::Axisymmetric), orthotropic.of_revolution(6.0)]
        {
            stiffness_is_the_energy::<P1, 3, 2>(&material);
            stiffness_is_the_energy::<P2, 6, 3>(&material);
        }
    }

    #[test]
    fn the_law_of_revolution_is_hookes_in_three_dimensions() {
        let gradient = Matrix2::new(0.2, 0.5, -0.1, -0.7);
        let m = Material::lame(3.0_f64, 0.7, Plane::Axisymmetric);
        let (stress, hoop) = m.stress_of_revolution(gradient, 0.4);
        let space = m.stress(Matrix3::new(0.2, 0.5, 0.0, -0.1, -0.7, 0.0, 0.0, 0.0, 0.4));
        // A handful of operations on numbers below 3.
        assert_abs_diff_eq!(
            space.matrix().fixed_view::<2, 2>(0, 0).into_owned(),
            *stress.matrix(),
            epsilon = 1e-15
        );
        assert_abs_diff_eq!(space.matrix().m33, hoop, epsilon = 1e-15);
        // As a tensor: sigma = C (eps + a h), sigma_hh = a . sigma + e h with a = nu, e = Young's modulus.
        let (nu, young) = (3.0 / 7.4, 0.7 * (9.0 + 1.4) / 3.7);
        let tensor = Material::tensor([4.4, 3.0, 0.0, 4.4, 0.0, 0.7], Some([nu, nu, 0.0]));
        let (same, same_hoop) = tensor.of_revolution(young).stress_of_revolution(gradient, 0.4);
        assert_abs_diff_eq!(*same.matrix(), *stress.matrix(), epsilon = 1e-14);
        assert_abs_diff_eq!(same_hoop, hoop, epsilon = 1e-14);
        // The deviator is 2 mu times that of the strain, whose entries are 0.2, -0.7, 0.4 and 0.2.
        let squares = (0.9_f64.powi(2) + 1.1_f64.powi(2) + 0.2_f64.powi(2)) / 2.0 + 3.0 * 0.04;
        let mises = stress.von_mises_squared(hoop).sqrt();
        assert_relative_eq!(mises, 1.4 * squares.sqrt(), max_relative = 1e-14);
    }

    /// c int r w^2 over the triangle less int_E r w^2 for the w that is the worst at the corner opposite, as a form of its values at the
    /// two ends: its diagonal and its determinant.
    fn slack(radii: [f64; 3], c: f64) -> [f64; 3] {
        let m = corner_mass(radii);
        let n = edge_mass([radii[0], radii[1]]);
        let entry = |i: usize, j: usize| c * (m[i][j] - m[i][2] * m[j][2] / m[2][2]) - n[i][j];
        [entry(0, 0), entry(1, 1), entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(1, 0)]
    }

    #[test]
    fn the_trace_constant_is_attained_and_at_most_4() {
        let sharp = |ends, c| trace_constant::<P2, f64, 6, 3>(ends, c, f64::sqrt);
        for t in &TRIANGLES {
            let [a, b, c] = radii(t);
            for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
                let c2 = sharp([a, b], c);
                let [first, second, determinant] = slack([a, b, c], c2);
                let size = (1.0 + a + b).powi(2);
                assert!(first >= -1e-14 * size && second >= -1e-14 * size);
                assert_abs_diff_eq!(determinant, 0.0, epsilon = 1e-14 * size);
                // A smaller constant is wrong, unless E is on the axis.
                assert!(a + b == 0.0 || slack([a, b, c], 0.99 * c2)[2] < -1e-5);
                assert!(sharp([a, b], c) <= 4.0 + 1e-14);
            }
        }
        assert_relative_eq!(sharp([2.0, 2.0], 2.0), 3.0, max_relative = 1e-14);
        assert_relative_eq!(sharp([1.0, 1.0], 0.0), 4.0, max_relative = 1e-14);
        assert_eq!(sharp([0.0, 0.0], 1.0), 0.0);
        // P1: |E| / |T| alone is wrong by the factor 3/2 where the corner opposite is on the axis.
        assert_eq!(trace_constant::<P1, f64, 3, 2>([1.0, 1.0], 0.0, f64::sqrt), 1.5);
        assert_eq!(trace_constant::<P1, f64, 3, 2>([1.0, 1.0], 1.0, f64::sqrt), 1.0);
    }

    #[test]
    fn the_factor_of_turning_is_attained_and_that_of_the_plane_is_too_small_at_the_axis() {
        for ends in [[0.0, 1.0], [1.0, 3.0], [2.0, 2.0]] {
            for cosine in [1.0, 0.9, 0.5] {
                // The largest eigenvalue of N (N^-1 o C), C = ((1, cosine), (cosine, 1)).
                let [[aa, ab], [_, bb]] = edge_mass(ends);
                let determinant: f64 = aa * bb - ab * ab;
                let n = Matrix2::new(aa, ab, ab, bb);
                let across = -cosine * ab;
                let product = n * Matrix2::new(bb, across, across, aa) / determinant;
                let half = (product.m11 + product.m22) / 2.0;
                let of_product = product.m11 * product.m22 - product.m12 * product.m21;
                let largest = half + (half * half - of_product).max(0.0).sqrt();
                let factor = turning_factor::<P2, f64, 6, 3>(ends, cosine, f64::sqrt);
                // The root of a difference that is 0 where the direction does not turn.
                assert_relative_eq!(factor, largest, max_relative = 1e-7);
                let planes = 2.0 - cosine;
                assert_eq!(factor > planes + 1e-12, cosine < 1.0 && ends[0] != ends[1]);
            }
        }
        assert_eq!(turning_factor::<P1, f64, 3, 2>([0.0, 1.0], 0.5, f64::sqrt), 1.0);
    }

    /// s(v) with the hoop strain, from the stress at the two ends.
    fn hoop_in_the_traction<E: Element<N, M>, const N: usize, const M: usize>() {
        let material = Material::lame(3.0, 0.7, Plane::Axisymmetric);
        let (n, directions) =
            (Vector2::new(0.6, 0.8), [Vector2::new(1.0, 0.0), Vector2::new(0.8, 0.6)]);
        for t in &TRIANGLES {
            let hoop =
                HoopStress::new::<E, M>(radii(t), (1, [0.25, 1.0]), n, directions, &material);
            let radial = field::<N>().map(|u| u[0]);
            let theta = hoop_strain::<E, f64, N, M>(radii(t), &radial);
            for (a, place) in [0.25, 1.0].into_iter().enumerate() {
                let theta = value_at::<E, f64, N, M>(theta, on_edge(1, place));
                // lambda theta n~ . n
                let expected = 3.0 * theta * directions[a].dot(&n);
                let found: f64 = (0..N).map(|j| hoop.at_ends[a][j] * radial[j]).sum();
                assert_relative_eq!(found, expected, max_relative = 1e-12);
                let ring: f64 = hoop.at_ends[a].iter().sum();
                assert_relative_eq!(hoop.ring[a], ring, max_relative = 1e-12);
            }
        }
    }

    #[test]
    fn the_hoop_strain_is_in_the_traction() {
        hoop_in_the_traction::<P1, 3, 2>();
        hoop_in_the_traction::<P2, 6, 3>();
    }
}
