//! Linear elasticity in the plane: sigma = A eps of (1) for any tensor A with the symmetries of section 2.1,
//!
//! sigma_xx = C11 eps_xx + C12 eps_yy + C16 gamma,
//! sigma_yy = C12 eps_xx + C22 eps_yy + C26 gamma,
//! sigma_xy = C16 eps_xx + C26 eps_yy + C66 gamma,   gamma = 2 eps_xy,
//!
//! and, with numbers of its own, the isotropic sigma = lambda tr(eps) I + 2 mu eps.
//!
//! In a body of revolution x is the radius r, y the axis z, and the third stress is the hoop stress: with a hoop strain h
//!
//! sigma = C (eps + a h),   sigma_hh = a . sigma + e h,
//!
//! where C is the law of plane strain, a the factors of its stress across the plane, and e Young's modulus along the hoop. The energy is
//! that of eps + a h, and e h^2.
//!
//! Plane stress has the isotropic form with lambda* = 2 lambda mu / (lambda + 2 mu) in place of lambda, so a [`Material`]
//! holds what acts in the plane and remembers which of the two it is. The isotropic law, and what follows for
//! sigma_n, is written for D dimensions; a tensor is that of a plane, and looks at the first two coordinates only.

use std::ops::{Add, Div, Mul, Sub};

use nalgebra::{Matrix2, SMatrix, SVector};

use super::Scalar;
use super::squares::Squares;
use super::triangle::Triangle;

/// Plane strain (no strain across the plane), plane stress (no stress across it), or the meridian of a body of revolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// eps_zz = 0
    Strain,
    /// sigma_zz = 0
    Stress,
    /// x is the distance r from the axis, y the place z along it; the strain across the plane is the hoop strain.
    Axisymmetric,
}

/// A material acting in the plane. All coefficients have the unit of a stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material<S> {
    law: Law<S>,
    plane: Plane,
}

/// A
#[derive(Clone, Copy, Debug, PartialEq)]
enum Law<S> {
    Isotropic {
        lambda: S,
        mu: S,
    },
    Tensor {
        /// C11, C12, C16, C22, C26, C66
        c: [S; 6],
        /// The factors of sigma_xx, sigma_yy and sigma_xy in sigma_zz.
        across: [S; 3],
        /// Young's modulus across the plane, of a body of revolution; else 0.
        hoop: S,
    },
}

/// A symmetric stress tensor in D dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stress<S, const D: usize = 2>(SMatrix<S, D, D>);

impl<S: Scalar> Material<S> {
    /// The material with the three-dimensional Lamé coefficients `lambda` and `mu`.
    pub fn lame(lambda: S, mu: S, plane: Plane) -> Self {
        let two = S::from(2);
        let lambda = match plane {
            Plane::Strain | Plane::Axisymmetric => lambda,
            Plane::Stress => two * lambda * mu / (lambda + two * mu),
        };
        Material { law: Law::Isotropic { lambda, mu }, plane }
    }

    /// The material with Young's modulus `young` and Poisson's ratio `poisson` (which must be neither -1 nor 1/2).
    pub fn young_poisson(young: S, poisson: S, plane: Plane) -> Self {
        let (one, two) = (S::from(1), S::from(2));
        let lambda = young * poisson / ((one + poisson) * (one - two * poisson));
        let mu = young / (two * (one + poisson));
        Material::lame(lambda, mu, plane)
    }

    /// The material with the law `[C11, C12, C16, C22, C26, C66]` in the plane, and in plane strain with
    /// sigma_zz = `across` . (sigma_xx, sigma_yy, sigma_xy); `None` is plane stress.
    pub fn tensor(c: [S; 6], across: Option<[S; 3]>) -> Self {
        let plane = if across.is_some() { Plane::Strain } else { Plane::Stress };
        let across = across.unwrap_or([S::from(0); 3]);
        Material { law: Law::Tensor { c, across, hoop: S::from(0) }, plane }
    }

    /// The material of a body of revolution that acts in its meridian as this one does in plane strain, with Young's modulus `hoop`
    /// along the hoops. An isotropic material has it from lambda and mu.
    #[must_use]
    pub fn of_revolution(self, hoop: S) -> Self {
        let law = match self.law {
            Law::Tensor { c, across, .. } => Law::Tensor { c, across, hoop },
            isotropic => isotropic,
        };
        Material { law, plane: Plane::Axisymmetric }
    }

    /// Converts the material to another number type.
    pub fn map<T>(&self, f: impl Fn(S) -> T) -> Material<T> {
        let law = match self.law {
            Law::Isotropic { lambda, mu } => Law::Isotropic { lambda: f(lambda), mu: f(mu) },
            Law::Tensor { c, across, hoop } => {
                Law::Tensor { c: c.map(&f), across: across.map(&f), hoop: f(hoop) }
            }
        };
        Material { law, plane: self.plane }
    }

    /// The material as it acts in the plane, without what is known across it.
    #[must_use]
    pub fn in_plane(&self) -> Self {
        match self.law {
            Law::Isotropic { .. } => Material { plane: Plane::Strain, ..*self },
            Law::Tensor { c, .. } => Material::tensor(c, None),
        }
    }

    /// The material that is turned to the left by the angle with this cosine and sine.
    #[must_use]
    pub fn turned(&self, [cosine, sine]: [S; 2]) -> Self {
        let Law::Tensor { across, hoop, .. } = self.law else { return *self };
        let axes = [[cosine, sine], [-sine, cosine]];
        // Entry (k, l) of a matrix in the axes of the material; and back.
        let inward = |m: Matrix2<S>, [k, l]: [usize; 2]| {
            let row = |i: usize| m[(i, 0)] * axes[l][0] + m[(i, 1)] * axes[l][1];
            axes[k][0] * row(0) + axes[k][1] * row(1)
        };
        let outward = |m: &Matrix2<S>, [i, j]: [usize; 2]| {
            let row = |k: usize| m[(k, 0)] * axes[0][j] + m[(k, 1)] * axes[1][j];
            axes[0][i] * row(0) + axes[1][i] * row(1)
        };
        let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
        let column = |[xx, yy, xy]: [S; 3]| {
            let gradient = Matrix2::new(xx, xy, zero, yy);
            let stress = self.stress(Matrix2::from_fn(|k, l| inward(gradient, [k, l])));
            [[0, 0], [1, 1], [0, 1]].map(|ij| outward(stress.matrix(), ij))
        };
        let [[xx, yx, zx], [_, yy, zy], [_, _, zz]] =
            [[one, zero, zero], [zero, one, zero], [zero, zero, one]].map(column);
        let half = across[2] / two;
        let across = Matrix2::new(across[0], half, half, across[1]);
        let across = [[0, 0], [1, 1], [0, 1]].map(|ij| outward(&across, ij));
        let law = Law::Tensor {
            c: [xx, yx, zx, yy, zy, zz],
            across: [across[0], across[1], two * across[2]],
            hoop,
        };
        Material { law, plane: self.plane }
    }

    /// The material with A times `factor`.
    pub(crate) fn times(&self, factor: S) -> Self {
        let law = match self.law {
            Law::Isotropic { lambda, mu } => {
                Law::Isotropic { lambda: factor * lambda, mu: factor * mu }
            }
            Law::Tensor { c, across, hoop } => {
                Law::Tensor { c: c.map(|c| factor * c), across, hoop: factor * hoop }
            }
        };
        Material { law, plane: self.plane }
    }

    /// The factors of sigma_xx, sigma_yy and sigma_xy in the stress across the plane, without a hoop strain: nu, nu and 0 where A is
    /// isotropic.
    pub fn across(&self) -> [S; 3] {
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|unit| self.stress_zz(Stress::new(unit.map(S::from))))
    }

    /// Young's modulus along the hoops of a body of revolution whose law is not isotropic.
    pub fn hoop_modulus(&self) -> Option<S> {
        match self.law {
            Law::Tensor { hoop, .. } if self.plane == Plane::Axisymmetric => Some(hoop),
            _ => None,
        }
    }

    /// Returns whether the law is given by lambda and mu.
    pub fn is_isotropic(&self) -> bool {
        matches!(self.law, Law::Isotropic { .. })
    }

    /// C11, C12, C16, C22, C26, C66
    pub fn stiffness(&self) -> [S; 6] {
        match self.law {
            Law::Isotropic { lambda, mu } => {
                let (zero, along) = (S::from(0), lambda + S::from(2) * mu);
                [along, lambda, zero, along, zero, mu]
            }
            Law::Tensor { c, .. } => c,
        }
    }

    /// The first Lamé coefficient as it acts in the plane: lambda, in plane stress lambda*; of a tensor, that of the isotropic
    /// law nearest to it.
    pub fn lambda(&self) -> S {
        match self.law {
            Law::Isotropic { lambda, .. } => lambda,
            Law::Tensor { c: [xx, xy, _, yy, ..], .. } => {
                (xx + yy + xy + xy) / S::from(4) - self.mu()
            }
        }
    }

    /// The shear modulus mu; of a tensor, that of the isotropic law nearest to it.
    pub fn mu(&self) -> S {
        match self.law {
            Law::Isotropic { mu, .. } => mu,
            Law::Tensor { c: [xx, xy, _, yy, _, shear], .. } => {
                (xx + yy - (xy + xy)) / S::from(8) + shear / S::from(2)
            }
        }
    }

    /// Plane strain, plane stress, or a body of revolution.
    pub fn plane(&self) -> Plane {
        self.plane
    }

    /// r at the corners of a triangle of the meridian, if the material is that of a body of revolution: the weight there is r, in the
    /// plane 1.
    pub fn radii<T: Scalar>(&self, triangle: &Triangle<T>) -> Option<[T; 3]> {
        (self.plane == Plane::Axisymmetric).then(|| triangle.vertices.map(|x| x[0]))
    }

    /// A_nnnn for a unit vector n: the constant of sigma_n(v)^2 <= A_nnnn sigma(v):eps(v), attained by a strain along n only.
    /// Where A is isotropic it is lambda + 2 mu in the plane, in plane stress 4 mu (lambda + mu) / (lambda + 2 mu) = E / (1 - nu^2).
    pub fn normal_stiffness<const D: usize>(&self, n: SVector<S, D>) -> S {
        match self.law {
            Law::Isotropic { lambda, mu } => lambda + S::from(2) * mu,
            Law::Tensor { .. } => self.stress_along(n, n).normal(n),
        }
    }

    /// The acoustic tensor Q(n) of a vector n: d . Q(n) d is the constant of (d . sigma(v) n)^2 <= d . Q(n) d sigma(v):eps(v),
    /// so that |sigma(v) n|^2 is at most its largest eigenvalue times sigma(v):eps(v).
    pub fn acoustic<const D: usize>(&self, n: SVector<S, D>) -> SMatrix<S, D, D> {
        self.tractions(n, n)
    }

    /// The tractions on m of sigma(u) for the displacement gradients e_k (x) n, in columns.
    fn tractions<const D: usize>(&self, m: SVector<S, D>, n: SVector<S, D>) -> SMatrix<S, D, D> {
        let axis = |k: usize| SVector::from_fn(|i, _| S::from(i32::from(i == k)));
        let columns: [SVector<S, D>; D] =
            std::array::from_fn(|k| self.stress_along(axis(k), n).traction(m));
        SMatrix::from_fn(|i, k| columns[k][i])
    }

    /// sigma(u) for the displacement gradient d (x) n.
    fn stress_along<const D: usize>(&self, d: SVector<S, D>, n: SVector<S, D>) -> Stress<S, D> {
        self.stress(SMatrix::from_fn(|i, j| d[i] * n[j]))
    }

    /// sigma(u) for the displacement gradient `gradient[(i, j)]` = du_i/dx_j.
    pub fn stress<const D: usize>(&self, gradient: SMatrix<S, D, D>) -> Stress<S, D> {
        let g = |i, j| gradient[(i, j)];
        let (lambda, mu) = match self.law {
            Law::Isotropic { lambda, mu } => (lambda, mu),
            Law::Tensor { c: [xx, xy, xz, yy, yz, zz], .. } => {
                let strain = [g(0, 0), g(1, 1), g(0, 1) + g(1, 0)];
                let row = |[a, b, c]: [S; 3]| a * strain[0] + b * strain[1] + c * strain[2];
                let in_plane = [row([xx, xy, xz]), row([xy, yy, yz]), row([xz, yz, zz])];
                return Stress(SMatrix::from_fn(|i, j| match (i, j) {
                    (0, 0) => in_plane[0],
                    (1, 1) => in_plane[1],
                    (0, 1) | (1, 0) => in_plane[2],
                    _ => S::from(0),
                }));
            }
        };
        let trace = lambda * (1..D).fold(g(0, 0), |sum, i| sum + g(i, i));
        let two_mu = S::from(2) * mu;
        Stress(SMatrix::from_fn(|i, j| {
            if i == j { trace + two_mu * g(i, i) } else { mu * (g(i, j) + g(j, i)) }
        }))
    }

    /// sigma_zz that goes with a stress in the plane: where A is isotropic, lambda tr(eps) = nu (sigma_xx + sigma_yy) in plane
    /// strain, and 0 in plane stress. In a body of revolution, that of a stress without a hoop strain.
    pub fn stress_zz(&self, stress: Stress<S>) -> S {
        let [xx, yy, xy] = stress.components();
        match (self.law, self.plane) {
            (_, Plane::Stress) => S::from(0),
            (Law::Isotropic { lambda, mu }, _) => lambda / (S::from(2) * (lambda + mu)) * (xx + yy),
            (Law::Tensor { across, .. }, _) => across[0] * xx + across[1] * yy + across[2] * xy,
        }
    }

    /// The stress in the meridian of a body of revolution and the hoop stress, for a displacement gradient there and a hoop strain.
    pub fn stress_of_revolution(&self, gradient: Matrix2<S>, hoop: S) -> (Stress<S>, S) {
        match self.law {
            Law::Isotropic { lambda, mu } => {
                let two_mu = S::from(2) * mu;
                let trace = lambda * (gradient.m11 + gradient.m22 + hoop);
                let shear = mu * (gradient.m12 + gradient.m21);
                let [rr, zz] = [gradient.m11, gradient.m22].map(|strain| trace + two_mu * strain);
                (Stress::new([rr, zz, shear]), trace + two_mu * hoop)
            }
            Law::Tensor { across, hoop: young, .. } => {
                let [a, b, c] = across.map(|factor| factor * hoop);
                let stress = self.stress(gradient + Matrix2::new(a, c, S::from(0), b));
                (stress, self.stress_zz(stress) + young * hoop)
            }
        }
    }

    /// The stress in the plane and the one across it: `hoop` is the hoop strain of a body of revolution, and of no use in others.
    pub fn state(&self, gradient: Matrix2<S>, hoop: S) -> (Stress<S>, S) {
        if self.plane == Plane::Axisymmetric {
            return self.stress_of_revolution(gradient, hoop);
        }
        let stress = self.stress(gradient);
        (stress, self.stress_zz(stress))
    }

    /// The energies of a strain and of a stress as sums of squares.
    pub fn squares(&self) -> Squares<S> {
        match self.law {
            Law::Isotropic { lambda, mu } => Squares::isotropic(lambda, mu),
            Law::Tensor { c, .. } => Squares::of_tensor(c),
        }
    }

    /// The square of the von Mises stress, sigma_zz included.
    pub fn von_mises_squared(&self, stress: Stress<S>) -> S {
        stress.von_mises_squared(self.stress_zz(stress))
    }

    /// The linear functional sigma_n of one shape function: with v = N w for a vector w and `gradient` = grad N at a point,
    /// sigma_n(v) = s . w for the returned s = (A:(n (x) n)) grad N, lambda grad N + 2 mu (grad N . n) n where A is isotropic.
    pub fn normal_stress_of_shape<const D: usize>(
        &self,
        gradient: SVector<S, D>,
        n: SVector<S, D>,
    ) -> SVector<S, D> {
        match self.law {
            Law::Isotropic { lambda, mu } => {
                gradient * lambda + n * (S::from(2) * mu * gradient.dot(&n))
            }
            Law::Tensor { .. } => self.stress_along(n, n).traction(gradient),
        }
    }

    /// The functional of the traction's component along `d`: d . sigma(v) n = s . w for the returned s = (A:(d (x) n)) grad N,
    /// lambda (d . n) grad N + mu ((d . grad N) n + (grad N . n) d) where A is isotropic. With d = n, n a unit vector, it is that
    /// of sigma_n.
    pub fn traction_of_shape<const D: usize>(
        &self,
        gradient: SVector<S, D>,
        n: SVector<S, D>,
        d: SVector<S, D>,
    ) -> SVector<S, D> {
        match self.law {
            Law::Isotropic { lambda, mu } => {
                let (bulk, on_n, on_d) = (lambda * d.dot(&n), d.dot(&gradient), gradient.dot(&n));
                gradient * bulk + (n * on_n + d * on_d) * mu
            }
            Law::Tensor { .. } => self.stress_along(d, n).traction(gradient),
        }
    }

    /// sigma(u):eps(v) at a point, where v = N_i e_c has grad N_i = `g_i` and u = N_j e_d has grad N_j = `g_j`, in entry (c, d):
    /// lambda g_i g_j^T + mu g_j g_i^T + mu (g_i . g_j) I where A is isotropic.
    pub fn energy_of_shapes<const D: usize>(
        &self,
        g_i: SVector<S, D>,
        g_j: SVector<S, D>,
    ) -> SMatrix<S, D, D> {
        match self.law {
            Law::Isotropic { lambda, mu } => {
                let mut density = outer(g_i * lambda, g_j) + outer(g_j, g_i * mu);
                let shear = mu * g_i.dot(&g_j);
                for c in 0..D {
                    density[(c, c)] += shear;
                }
                density
            }
            Law::Tensor { .. } => self.tractions(g_i, g_j),
        }
    }
}

/// a b^T
pub(crate) fn outer<S: Scalar, const D: usize>(
    a: SVector<S, D>,
    b: SVector<S, D>,
) -> SMatrix<S, D, D> {
    SMatrix::from_fn(|i, j| a[i] * b[j])
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

/// An operator that acts on the matrix.
macro_rules! of_matrices {
    ($operator:ident $function:ident $other:ty, $b:ident => $value:expr) => {
        impl<S: Scalar, const D: usize> $operator<$other> for Stress<S, D> {
            type Output = Self;

            fn $function(self, $b: $other) -> Self {
                Stress($operator::$function(self.0, $value))
            }
        }
    };
}
of_matrices!(Add add Self, other => other.0);
of_matrices!(Sub sub Self, other => other.0);
of_matrices!(Mul mul S, factor => factor);
of_matrices!(Div div S, divisor => divisor);

impl<S: Scalar> Stress<S> {
    /// The stress in the plane with these components: sigma_xx, sigma_yy, sigma_xy.
    pub fn new([xx, yy, xy]: [S; 3]) -> Self {
        Stress(Matrix2::new(xx, xy, xy, yy))
    }

    /// sigma_xx, sigma_yy, sigma_xy
    pub fn components(&self) -> [S; 3] {
        [self.0[(0, 0)], self.0[(1, 1)], self.0[(0, 1)]]
    }

    /// The square of the von Mises stress with the stress `zz` across the plane.
    pub fn von_mises_squared(&self, zz: S) -> S {
        let [xx, yy, xy] = self.components();
        let (a, b, c) = (xx - yy, yy - zz, zz - xx);
        (a * a + b * b + c * c) / S::from(2) + S::from(3) * xy * xy
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// The error of a handful of operations, relative to the numbers of size 1 to 10 that enter.
    const ROUNDING: f64 = 1e-15;

    #[test]
    fn the_stress_across_the_plane_is_finite_where_lambda_times_a_stress_is_not() {
        let m = Material::lame(1e150_f64, 1e200, Plane::Strain);
        let s = Stress::new([3e200, -1e200, 0.0]);
        assert!((m.lambda() * 2e200).is_infinite());
        assert_relative_eq!(m.stress_zz(s), 1e150, max_relative = ROUNDING);
    }
}
