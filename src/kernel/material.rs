//! Linear isotropic elasticity in the plane: sigma = A eps of (1), sigma = lambda tr(eps) I + 2 mu eps.
//!
//! Plane stress has the same form with lambda* = 2 lambda mu / (lambda + 2 mu) in place of lambda, so a [`Material`]
//! holds the coefficient that acts in the plane and remembers which of the two it is.

use super::Scalar;
use super::scalar::dot;

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

/// A symmetric stress tensor in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stress<S> {
    /// sigma_xx
    pub xx: S,
    /// sigma_yy
    pub yy: S,
    /// sigma_xy
    pub xy: S,
}

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

    /// The same material in another number type.
    #[cfg(not(kani))]
    pub(crate) fn map<T>(&self, f: impl Fn(S) -> T) -> Material<T> {
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
    pub(crate) fn plane(&self) -> Plane {
        self.plane
    }

    /// lambda + 2 mu in the plane: the constant of sigma_n(v)^2 <= (lambda + 2 mu) sigma(v):eps(v), attained by a strain
    /// along the normal only. In plane stress it is 4 mu (lambda + mu) / (lambda + 2 mu) = E / (1 - nu^2).
    pub fn normal_stiffness(&self) -> S {
        self.lambda + S::from(2) * self.mu
    }

    /// sigma(u) for the displacement gradient `gradient[i][j]` = du_i/dx_j.
    pub fn stress(&self, gradient: [[S; 2]; 2]) -> Stress<S> {
        let trace = self.lambda * (gradient[0][0] + gradient[1][1]);
        let two_mu = S::from(2) * self.mu;
        Stress {
            xx: trace + two_mu * gradient[0][0],
            yy: trace + two_mu * gradient[1][1],
            xy: self.mu * (gradient[0][1] + gradient[1][0]),
        }
    }

    /// sigma_zz that goes with a stress in the plane: lambda tr(eps) = nu (sigma_xx + sigma_yy) in plane strain, 0 in
    /// plane stress.
    pub fn stress_zz(&self, stress: Stress<S>) -> S {
        match self.plane {
            Plane::Strain => {
                self.lambda * (stress.xx + stress.yy) / (S::from(2) * (self.lambda + self.mu))
            }
            Plane::Stress => S::from(0),
        }
    }

    /// The square of the von Mises stress, sigma_zz included.
    pub fn von_mises_squared(&self, stress: Stress<S>) -> S {
        let Stress { xx, yy, xy } = stress;
        let zz = self.stress_zz(stress);
        let (a, b, c) = (xx - yy, yy - zz, zz - xx);
        (a * a + b * b + c * c) / S::from(2) + S::from(3) * xy * xy
    }

    /// The linear functional sigma_n of one shape function: with v = N (v_x, v_y) and `gradient` = grad N at a point,
    /// sigma_n(v) = s . (v_x, v_y) for the returned s = lambda grad N + 2 mu (grad N . n) n.
    pub fn normal_stress_of_shape(&self, gradient: [S; 2], n: [S; 2]) -> [S; 2] {
        let along = S::from(2) * self.mu * dot(gradient, n);
        [self.lambda * gradient[0] + along * n[0], self.lambda * gradient[1] + along * n[1]]
    }

    /// The same for the traction's component along `d`: d . sigma(v) n = s . (v_x, v_y) for the returned
    /// s = lambda (d . n) grad N + mu ((d . grad N) n + (grad N . n) d). With d = n, n a unit vector, it is that of sigma_n.
    #[cfg(not(kani))]
    pub(crate) fn traction_of_shape(&self, gradient: [S; 2], n: [S; 2], d: [S; 2]) -> [S; 2] {
        let (bulk, on_n, on_d) = (self.lambda * dot(d, n), dot(d, gradient), dot(gradient, n));
        [0, 1].map(|c| bulk * gradient[c] + self.mu * (on_n * n[c] + on_d * d[c]))
    }
}

impl<S: Scalar> Stress<S> {
    /// sigma_n = n . sigma n for the unit normal `n`: negative in compression.
    pub fn normal(&self, n: [S; 2]) -> S {
        dot(self.traction(n), n)
    }

    /// The traction sigma n.
    pub fn traction(&self, n: [S; 2]) -> [S; 2] {
        [self.xx * n[0] + self.xy * n[1], self.xy * n[0] + self.yy * n[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: [f64; 2] = [0.6, -0.8];

    #[test]
    fn lame_and_young_poisson_agree() {
        // lambda = mu = 1 is E = 5/2, nu = 1/4.
        for plane in [Plane::Strain, Plane::Stress] {
            let a = Material::lame(1.0_f64, 1.0, plane);
            let b = Material::young_poisson(2.5, 0.25, plane);
            assert!((a.lambda() - b.lambda()).abs() < 1e-15);
            assert!((a.mu() - b.mu()).abs() < 1e-15);
        }
    }

    #[test]
    fn plane_stress_has_the_modulus_of_a_free_plate() {
        // Uniaxial stress in the plane: sigma_xx = E eps_xx when eps_yy = -nu eps_xx.
        let m = Material::young_poisson(2.5_f64, 0.25, Plane::Stress);
        let s = m.stress([[1.0, 0.0], [0.0, -0.25]]);
        assert!((s.xx - 2.5).abs() < 1e-15 && s.yy.abs() < 1e-15 && s.xy == 0.0);
        assert!((m.normal_stiffness() - 2.5 / (1.0 - 0.0625)).abs() < 1e-15);
        assert_eq!(m.stress_zz(s), 0.0);
        assert!((m.von_mises_squared(s).sqrt() - 2.5).abs() < 1e-15);
    }

    #[test]
    fn plane_strain_keeps_lambda_tr_eps_across_the_plane() {
        let m = Material::lame(3.0_f64, 0.7, Plane::Strain);
        let s = m.stress([[0.2, 0.5], [-0.1, -0.7]]);
        assert!((m.stress_zz(s) - 3.0 * (0.2 - 0.7)).abs() < 1e-15);
    }

    #[test]
    fn a_rotation_gives_no_stress() {
        let s = Material::lame(3.0, 0.7, Plane::Strain).stress([[0.0, -0.3], [0.3, 0.0]]);
        assert_eq!((s.xx, s.yy, s.xy), (0.0, 0.0, 0.0));
    }

    #[test]
    fn sigma_n_of_a_shape_function_is_n_sigma_n() {
        let m = Material::lame(3.0_f64, 0.7, Plane::Strain);
        let g = [0.3, -1.1];
        let s = m.normal_stress_of_shape(g, N);
        for (c, v) in [(0, [[0.3, -1.1], [0.0, 0.0]]), (1, [[0.0, 0.0], [0.3, -1.1]])] {
            assert!((s[c] - m.stress(v).normal(N)).abs() < 1e-15);
        }
    }

    #[test]
    fn normal_stiffness_is_attained_by_a_strain_along_the_normal() {
        let m = Material::lame(3.0_f64, 0.7, Plane::Strain);
        let gradient = [[N[0] * N[0], N[0] * N[1]], [N[1] * N[0], N[1] * N[1]]];
        let s = m.stress(gradient);
        let energy = s.xx * gradient[0][0] + s.yy * gradient[1][1] + 2.0 * s.xy * gradient[0][1];
        let sigma_n = s.normal(N);
        assert!((sigma_n * sigma_n - m.normal_stiffness() * energy).abs() < 1e-12);
    }
}
