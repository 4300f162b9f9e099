//! (a) A smooth solution with a change from contact to a gap at x = c, on the unit square:
//!
//! p = ap \[x - c\]+^k,  q = -aq \[c - x\]+^m,  pi = p - g,  B = 1 - 3 y^2 + 2 y^3,  A = -y B,
//! u = (A pi', B pi - A q).
//!
//! u = 0 on y = 1; tractions on x = 0 and x = 1. On y = 0: u_n - g = -p, sigma_n = (lambda + 2 mu) q, sigma_xy = 0; for any
//! tensor eps_yy = q is the only strain there, so that sigma_n = C22 q and sigma_xy = C26 q: it solves (2) if C26 = 0.

use nalgebra::Matrix2;

use super::{ExactSolution, force_of, truncated_power};
use crate::kernel::Material;
use crate::model::graded_quadrature::Features;

/// The solution (a).
#[derive(Clone, Debug, PartialEq)]
pub struct Smooth {
    /// The material of the body: isotropic, or a tensor with C26 = 0.
    pub material: Material<f64>,
    /// Where contact ends, inside (0, 1).
    pub c: f64,
    /// The exponent of the gap that opens, above 5/2 (or the body force would not be square integrable).
    pub k: f64,
    /// The exponent of the pressure, above 3/2 (likewise).
    pub m: f64,
    /// The amplitude of the gap that opens, positive.
    pub ap: f64,
    /// The amplitude of the pressure, positive.
    pub aq: f64,
    /// The gap function g(x) = gap\[0\] + gap\[1\] x + gap\[2\] x^2 + ..
    pub gap: Vec<f64>,
}

/// The factors of u and their derivatives: pi to the third, q, A and B to the second.
struct Factors {
    pi: [f64; 4],
    q: [f64; 3],
    a: [f64; 3],
    b: [f64; 3],
}

impl Smooth {
    fn factors(&self, [x, y]: [f64; 2]) -> Factors {
        let p = truncated_power::<4>(self.ap, self.k, x - self.c);
        // Each derivative of [c - x]+^m changes the sign once more.
        let [q0, q1, q2] = truncated_power::<3>(-self.aq, self.m, self.c - x);
        let y2 = y * y;
        let y3 = y2 * y;
        Factors {
            pi: std::array::from_fn(|j| p[j] - polynomial_derivative(&self.gap, j, x)),
            q: [q0, -q1, q2],
            a: [
                -(y - 3.0 * y3 + 2.0 * y2 * y2),
                -(1.0 - 9.0 * y2 + 8.0 * y3),
                18.0 * y - 24.0 * y2,
            ],
            b: [1.0 - 3.0 * y2 + 2.0 * y3, -6.0 * y + 6.0 * y2, -6.0 + 12.0 * y],
        }
    }

    /// \[u_xx, u_xy, u_yy\] of each component.
    fn hessians(&self, x: [f64; 2]) -> [[f64; 3]; 2] {
        let Factors { pi, q, a, b } = self.factors(x);
        [
            [a[0] * pi[3], a[1] * pi[2], a[2] * pi[1]],
            [b[0] * pi[2] - a[0] * q[2], b[1] * pi[1] - a[1] * q[1], b[2] * pi[0] - a[2] * q[0]],
        ]
    }
}

/// The derivative of order `j` of the polynomial with these coefficients, by Horner's rule.
fn polynomial_derivative(coefficients: &[f64], j: usize, x: f64) -> f64 {
    let falling = |i: usize| (i - j + 1..=i).map(|k| k as f64).product::<f64>();
    (j..coefficients.len()).rev().fold(0.0, |sum, i| sum * x + falling(i) * coefficients[i])
}

impl ExactSolution for Smooth {
    fn material(&self) -> &Material<f64> {
        &self.material
    }

    fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        let Factors { pi, q, a, b } = self.factors(x);
        [a[0] * pi[1], b[0] * pi[0] - a[0] * q[0]]
    }

    fn gradient(&self, x: [f64; 2]) -> Matrix2<f64> {
        let Factors { pi, q, a, b } = self.factors(x);
        Matrix2::new(
            a[0] * pi[2],
            a[1] * pi[1],
            b[0] * pi[1] - a[0] * q[1],
            b[1] * pi[0] - a[1] * q[0],
        )
    }

    fn second_derivatives(&self, x: [f64; 2]) -> Option<[[f64; 3]; 2]> {
        Some(self.hessians(x))
    }

    fn body_force(&self, x: [f64; 2]) -> Option<[f64; 2]> {
        Some(force_of(&self.material, self.hessians(x)))
    }

    fn gap(&self, [x, _]: [f64; 2]) -> f64 {
        polynomial_derivative(&self.gap, 0, x)
    }

    fn regularity(&self) -> f64 {
        (self.k - 0.5).min(self.m + 0.5)
    }

    fn features(&self) -> Features {
        Features { kink: Some(self.c), singular: None }
    }
}
