//! (e) Friction, smooth: an edge in contact that sticks for x < c and slides for x > c, on the unit square:
//!
//! U = a \[x - c\]+^k,  T = s - b \[c - x\]+^m,  V = (p + lambda U') / (lambda + 2 mu),
//! B = 1 - 3 y^2 + 2 y^3,  C = y - 2 y^2 + y^3,  Y = y (1 - y),
//! u = (U B + T C / mu, -V Y).
//!
//! On y = 0: u_n = 0, sigma_n = -p, the slip u_x = U >= 0, and sigma_xy = T, which is s where the edge slides. So it solves
//! Tresca's problem with the slip bound s if b c^m <= 2 s, and, as sigma_n is -p all along, Coulomb's with the coefficient s / p.

use signorini::exact::{ExactSolution, force_of, truncated_power};
use signorini::kernel::Material;
use signorini::model::graded_quadrature::Features;
use signorini::nalgebra::Matrix2;

/// The solution (e).
#[derive(Clone, Debug, PartialEq)]
pub struct StickSlip {
    /// The material of the body, isotropic.
    pub material: Material<f64>,
    /// Where sticking ends, inside (0, 1).
    pub c: f64,
    /// The exponent of the slip, above 7/2 (or the body force would not be square integrable).
    pub k: f64,
    /// The exponent of the shear below the bound, above 3/2 (likewise).
    pub m: f64,
    /// The amplitude of the slip, positive.
    pub a: f64,
    /// The amplitude of the shear, positive, with b c^m <= 2 s.
    pub b: f64,
    /// The slip bound, a stress.
    pub bound: f64,
    /// The contact pressure, a stress.
    pub pressure: f64,
}

/// The factors of u and their derivatives to the second, along x and along y.
struct Factors {
    /// U, T / mu, V
    along: [[f64; 3]; 3],
    /// B, C, Y
    across: [[f64; 3]; 3],
}

impl StickSlip {
    fn factors(&self, [x, y]: [f64; 2]) -> Factors {
        let (lambda, mu) = (self.material.lambda(), self.material.mu());
        let stiffness = lambda + 2.0 * mu;
        let [u0, u1, u2, u3] = truncated_power::<4>(self.a, self.k, x - self.c);
        // Each derivative of [c - x]+^m changes the sign once more.
        let [t0, t1, t2] = truncated_power::<3>(-self.b, self.m, self.c - x);
        let shear = [(self.bound + t0) / mu, -t1 / mu, t2 / mu];
        let v = [self.pressure + lambda * u1, lambda * u2, lambda * u3].map(|v| v / stiffness);
        let y2 = y * y;
        Factors {
            along: [[u0, u1, u2], shear, v],
            across: [
                [1.0 - 3.0 * y2 + 2.0 * y2 * y, -6.0 * y + 6.0 * y2, -6.0 + 12.0 * y],
                [y - 2.0 * y2 + y2 * y, 1.0 - 4.0 * y + 3.0 * y2, -4.0 + 6.0 * y],
                [y - y2, 1.0 - 2.0 * y, -2.0],
            ],
        }
    }

    /// The derivatives of u of the orders i along x and j along y.
    fn derivative(factors: &Factors, i: usize, j: usize) -> [f64; 2] {
        let product = |k: usize| factors.along[k][i] * factors.across[k][j];
        [product(0) + product(1), -product(2)]
    }
}

impl ExactSolution for StickSlip {
    fn material(&self) -> &Material<f64> {
        &self.material
    }

    fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        Self::derivative(&self.factors(x), 0, 0)
    }

    fn gradient(&self, x: [f64; 2]) -> Matrix2<f64> {
        let factors = self.factors(x);
        let [by_x, by_y] = [Self::derivative(&factors, 1, 0), Self::derivative(&factors, 0, 1)];
        Matrix2::from_columns(&[by_x.into(), by_y.into()])
    }

    fn second_derivatives(&self, x: [f64; 2]) -> Option<[[f64; 3]; 2]> {
        let factors = self.factors(x);
        let [xx, xy, yy] = [(2, 0), (1, 1), (0, 2)].map(|(i, j)| Self::derivative(&factors, i, j));
        Some([0, 1].map(|c| [xx[c], xy[c], yy[c]]))
    }

    fn body_force(&self, x: [f64; 2]) -> Option<[f64; 2]> {
        Some(force_of(&self.material, self.second_derivatives(x)?))
    }

    fn slip_bound(&self) -> Option<f64> {
        Some(self.bound)
    }

    /// u_y has U', whose power is k - 1.
    fn regularity(&self) -> f64 {
        (self.k - 0.5).min(self.m + 0.5)
    }

    fn features(&self) -> Features {
        Features { kink: Some(self.c), singular: None }
    }
}
