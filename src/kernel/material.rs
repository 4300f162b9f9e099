//! Linear isotropic elasticity in the plane: sigma = A eps of (1), sigma = lambda tr(eps) I + 2 mu eps.
//!
//! Plane stress has the same form with lambda* = 2 lambda mu / (lambda + 2 mu) in place of lambda, so a [`Material`]
//! holds the coefficient that acts in the plane and remembers which of the two it is. The law itself, and what follows for
//! sigma_n, is written for D dimensions; what only a plane has is not.

use std::ops::{Add, Div, Mul, Sub};

use nalgebra::{Matrix2, SMatrix, SVector};

use super::Scalar;

/// Plane strain (no strain across the plane) or plane stress (no stress across it).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// eps_zz = 0
    Strain,
    /// sigma_zz = 0
    Stress,
}

/// An isotropic material acting in the plane. Both coefficients have the unit of a stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material<S> {
    lambda: S,
    mu: S,
    plane: Plane,
}

/// A symmetric stress tensor in D dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stress<S, const D: usize = 2>(SMatrix<S, D, D>);

impl<S: Scalar> Material<S> {
    /// The material with the three-dimensional Lamé coefficients `lambda` and `mu`.
    pub fn lame(lambda: S, mu: S, plane: Plane) -> Self {
        let two = S::from(2);
        let lambda = match plane {
            Plane::Strain => lambda,
            Plane::Stress => two * lambda * mu / (lambda + two * mu),
        };
        Material { lambda, mu, plane }
    }

    /// The material with Young's modulus `young` and Poisson's ratio `poisson` (which must be neither -1 nor 1/2).
    pub fn young_poisson(young: S, poisson: S, plane: Plane) -> Self {
        let (one, two) = (S::from(1), S::from(2));
        let lambda = young * poisson / ((one + poisson) * (one - two * poisson));
        let mu = young / (two * (one + poisson));
        Material::lame(lambda, mu, plane)
    }

    /// Converts the material to another number type.
    #[cfg(not(kani))]
    pub fn map<T>(&self, f: impl Fn(S) -> T) -> Material<T> {
        Material { lambda: f(self.lambda), mu: f(self.mu), plane: self.plane }
    }

    /// The first Lamé coefficient as it acts in the plane: lambda, in plane stress lambda*.
    pub fn lambda(&self) -> S {
        self.lambda
    }

    /// The shear modulus mu.
    pub fn mu(&self) -> S {
        self.mu
    }

    /// Plane strain or plane stress.
    #[cfg(not(kani))]
    pub fn plane(&self) -> Plane {
        self.plane
    }

    /// lambda + 2 mu in the plane: the constant of sigma_n(v)^2 <= (lambda + 2 mu) sigma(v):eps(v), attained by a strain
    /// along the normal only. In plane stress it is 4 mu (lambda + mu) / (lambda + 2 mu) = E / (1 - nu^2).
    pub fn normal_stiffness(&self) -> S {
        self.lambda + S::from(2) * self.mu
    }

    /// sigma(u) for the displacement gradient `gradient[(i, j)]` = du_i/dx_j.
    pub fn stress<const D: usize>(&self, gradient: SMatrix<S, D, D>) -> Stress<S, D> {
        let g = |i, j| gradient[(i, j)];
        let trace = self.lambda * (1..D).fold(g(0, 0), |sum, i| sum + g(i, i));
        let two_mu = S::from(2) * self.mu;
        Stress(SMatrix::from_fn(|i, j| {
            if i == j { trace + two_mu * g(i, i) } else { self.mu * (g(i, j) + g(j, i)) }
        }))
    }

    /// sigma_zz that goes with a stress in the plane: lambda tr(eps) = nu (sigma_xx + sigma_yy) in plane strain, 0 in
    /// plane stress.
    pub fn stress_zz(&self, stress: Stress<S>) -> S {
        let [xx, yy, _] = stress.components();
        match self.plane {
            Plane::Strain => self.lambda / (S::from(2) * (self.lambda + self.mu)) * (xx + yy),
            Plane::Stress => S::from(0),
        }
    }

    /// The square of the von Mises stress, sigma_zz included.
    pub fn von_mises_squared(&self, stress: Stress<S>) -> S {
        let [xx, yy, xy] = stress.components();
        let zz = self.stress_zz(stress);
        let (a, b, c) = (xx - yy, yy - zz, zz - xx);
        (a * a + b * b + c * c) / S::from(2) + S::from(3) * xy * xy
    }

    /// The linear functional sigma_n of one shape function: with v = N w for a vector w and `gradient` = grad N at a point,
    /// sigma_n(v) = s . w for the returned s = lambda grad N + 2 mu (grad N . n) n.
    pub fn normal_stress_of_shape<const D: usize>(
        &self,
        gradient: SVector<S, D>,
        n: SVector<S, D>,
    ) -> SVector<S, D> {
        gradient * self.lambda + n * (S::from(2) * self.mu * gradient.dot(&n))
    }

    /// The functional of the traction's component along `d`: d . sigma(v) n = s . w for the returned
    /// s = lambda (d . n) grad N + mu ((d . grad N) n + (grad N . n) d). With d = n, n a unit vector, it is that of sigma_n.
    #[cfg(not(kani))]
    pub fn traction_of_shape<const D: usize>(
        &self,
        gradient: SVector<S, D>,
        n: SVector<S, D>,
        d: SVector<S, D>,
    ) -> SVector<S, D> {
        let (bulk, on_n, on_d) = (self.lambda * d.dot(&n), d.dot(&gradient), gradient.dot(&n));
        gradient * bulk + (n * on_n + d * on_d) * self.mu
    }
}

impl<S: Scalar, const D: usize> Stress<S, D> {
    /// The tensor as a matrix.
    pub fn matrix(&self) -> &SMatrix<S, D, D> {
        &self.0
    }

    /// sigma_n = n . sigma n for the unit normal `n`: negative in compression.
    pub fn normal(&self, n: SVector<S, D>) -> S {
        self.traction(n).dot(&n)
    }

    /// The traction sigma n: sigma is symmetric.
    pub fn traction(&self, n: SVector<S, D>) -> SVector<S, D> {
        self.0.tr_mul(&n)
    }
}

impl<S: Scalar, const D: usize> Add for Stress<S, D> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Stress(self.0 + other.0)
    }
}

impl<S: Scalar, const D: usize> Mul<S> for Stress<S, D> {
    type Output = Self;

    fn mul(self, factor: S) -> Self {
        Stress(self.0 * factor)
    }
}

impl<S: Scalar, const D: usize> Sub for Stress<S, D> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Stress(self.0 - other.0)
    }
}

impl<S: Scalar, const D: usize> Div<S> for Stress<S, D> {
    type Output = Self;

    fn div(self, divisor: S) -> Self {
        Stress(self.0 / divisor)
    }
}

impl<S: Scalar> Stress<S> {
    /// The stress in the plane with these components: sigma_xx, sigma_yy, sigma_xy.
    pub fn new([xx, yy, xy]: [S; 3]) -> Self {
        Stress(Matrix2::new(xx, xy, xy, yy))
    }

    /// sigma_xx, sigma_yy, sigma_xy
    pub fn components(&self) -> [S; 3] {
        [self.0[(0, 0)], self.0[(1, 1)], self.0[(0, 1)]]
    }
}

#[cfg(test)]
mod tests {
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use nalgebra::{Matrix3, Vector2, Vector3};

    use super::*;

    const N: Vector2<f64> = Vector2::new(0.6, -0.8);

    /// The error of a handful of operations, relative to the numbers of size 1 to 10 that enter.
    const ROUNDING: f64 = 1e-15;

    #[test]
    fn lame_and_young_poisson_agree() {
        // lambda = mu = 1 is E = 5/2, nu = 1/4.
        for plane in [Plane::Strain, Plane::Stress] {
            let a = Material::lame(1.0_f64, 1.0, plane);
            let b = Material::young_poisson(2.5, 0.25, plane);
            assert_relative_eq!(a.lambda(), b.lambda(), max_relative = ROUNDING);
            assert_relative_eq!(a.mu(), b.mu(), max_relative = ROUNDING);
        }
    }

    #[test]
    fn plane_stress_has_the_modulus_of_a_free_plate() {
        // Uniaxial stress in the plane: sigma_xx = E eps_xx when eps_yy = -nu eps_xx.
        let m = Material::young_poisson(2.5_f64, 0.25, Plane::Stress);
        let s = m.stress(Matrix2::new(1.0, 0.0, 0.0, -0.25));
        assert_abs_diff_eq!(s.matrix(), &Matrix2::new(2.5, 0.0, 0.0, 0.0), epsilon = ROUNDING);
        assert_relative_eq!(m.normal_stiffness(), 2.5 / (1.0 - 0.0625), max_relative = ROUNDING);
        assert_eq!(m.stress_zz(s), 0.0);
        assert_relative_eq!(m.von_mises_squared(s).sqrt(), 2.5, max_relative = ROUNDING);
    }

    #[test]
    fn plane_strain_keeps_lambda_tr_eps_across_the_plane() {
        let m = Material::lame(3.0_f64, 0.7, Plane::Strain);
        let s = m.stress(Matrix2::new(0.2, 0.5, -0.1, -0.7));
        assert_relative_eq!(m.stress_zz(s), 3.0 * (0.2 - 0.7), max_relative = ROUNDING);
    }

    #[test]
    fn the_stress_across_the_plane_is_finite_where_lambda_times_a_stress_is_not() {
        let m = Material::lame(1e150_f64, 1e200, Plane::Strain);
        let s = Stress::new([3e200, -1e200, 0.0]);
        assert!((m.lambda() * 2e200).is_infinite());
        assert_relative_eq!(m.stress_zz(s), 1e150, max_relative = ROUNDING);
    }

    #[test]
    fn plane_strain_is_the_law_in_three_dimensions_without_strain_across_the_plane() {
        let m = Material::lame(3.0_f64, 0.7, Plane::Strain);
        let in_plane = m.stress(Matrix2::new(0.2, 0.5, -0.1, -0.7));
        let s = m.stress(Matrix3::new(0.2, 0.5, 0.0, -0.1, -0.7, 0.0, 0.0, 0.0, 0.0));
        // The sum of three diagonal entries ends in one more that is 0.
        assert_eq!(s.matrix().fixed_view::<2, 2>(0, 0), *in_plane.matrix());
        assert_relative_eq!(s.matrix().m33, m.stress_zz(in_plane), max_relative = ROUNDING);
        assert_eq!(s.traction(Vector3::new(0.6, -0.8, 0.0)).xy(), in_plane.traction(N));
    }

    #[test]
    fn a_rotation_gives_no_stress() {
        let s = Material::lame(3.0, 0.7, Plane::Strain).stress(Matrix2::new(0.0, -0.3, 0.3, 0.0));
        assert_eq!(s, Stress::new([0.0; 3]));
    }

    #[test]
    fn sigma_n_of_a_shape_function_is_n_sigma_n() {
        let m = Material::lame(3.0_f64, 0.7, Plane::Strain);
        let s = m.normal_stress_of_shape(Vector2::new(0.3, -1.1), N);
        for (c, v) in
            [(0, Matrix2::new(0.3, -1.1, 0.0, 0.0)), (1, Matrix2::new(0.0, 0.0, 0.3, -1.1))]
        {
            assert_abs_diff_eq!(s[c], m.stress(v).normal(N), epsilon = ROUNDING);
        }
    }

    #[test]
    fn normal_stiffness_is_attained_by_a_strain_along_the_normal() {
        let m = Material::lame(3.0_f64, 0.7, Plane::Strain);
        let gradient = N * N.transpose();
        let s = m.stress(gradient);
        let energy = s.matrix().dot(&gradient);
        let sigma_n = s.normal(N);
        let attained = m.normal_stiffness() * energy;
        // A dozen operations on numbers of one sign each.
        assert_relative_eq!(sigma_n * sigma_n, attained, max_relative = 10.0 * ROUNDING);
    }
}
