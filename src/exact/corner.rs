//! (c) Low regularity: a wedge 0 < theta < omega in full contact along theta = 0 and free along theta = omega, no body force.
//! On the trapezoid (0,0), (1,0), (1,1), (cot omega, 1) with given displacement on x = 1 and y = 1, pi/2 < omega < pi:
//!
//! 2 mu u_x = r^alpha ((k a - b) cos(alpha theta) - alpha a cos((2 - alpha) theta)),
//! 2 mu u_y = r^alpha ((k a + b) sin(alpha theta) - alpha a sin((2 - alpha) theta)),
//!
//! sin(2 alpha omega) + alpha sin(2 omega) = 0 with 1/2 < alpha < 1, a = -1, b = cos(2 alpha omega) + alpha cos(2 omega), k
//! Kolosov's constant. sigma_n = alpha r^(alpha-1) ((alpha + 1) a + b) < 0 on Gamma_C: unbounded, but square integrable.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix2, Vector2};

use super::{ExactSolution, kolosov};
use crate::kernel::Material;
use crate::model::graded_quadrature::{Features, Singularity};

/// The solution (c).
#[derive(Clone, Debug, PartialEq)]
pub struct Corner {
    material: Material<f64>,
    omega: f64,
    alpha: f64,
    b: f64,
}

const A: f64 = -1.0;

/// Along an edge the distance from the corner is at least this power of the parameter.
const LEAST_GRADING: f64 = 8.0;

impl Corner {
    /// The solution for the angle `omega`; `None` if that does not lie between pi/2 and pi.
    pub fn new(material: Material<f64>, omega: f64) -> Option<Self> {
        if !(FRAC_PI_2 < omega && omega < PI) {
            return None;
        }
        let alpha = root(omega);
        let b = -A * ((2.0 * alpha * omega).cos() + alpha * (2.0 * omega).cos());
        Some(Corner { material, omega, alpha, b })
    }

    /// The exponent: u is in H^s for s < 1 + alpha.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }
}

/// The zero of sin(2 alpha omega) + alpha sin(2 omega) in (1/2, 1), by bisection to the last bit: the function is positive
/// at 1/2 and negative at 1, with one sign change between.
fn root(omega: f64) -> f64 {
    let f = |alpha: f64| (2.0 * alpha * omega).sin() + alpha * (2.0 * omega).sin();
    let (mut low, mut high) = (0.5, 1.0);
    loop {
        let middle = (low + high) / 2.0;
        if !(low < middle && middle < high) {
            return middle;
        }
        if f(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// (r, theta) with y >= 0: rounding must not put a point of the contact line below it.
fn polar([x, y]: [f64; 2]) -> (f64, f64) {
    let y = y.max(0.0);
    (x.hypot(y), y.atan2(x))
}

impl ExactSolution for Corner {
    fn material(&self) -> &Material<f64> {
        &self.material
    }

    fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        let (r, theta) = polar(x);
        let (alpha, k) = (self.alpha, kolosov(&self.material));
        let scale = r.powf(alpha) / (2.0 * self.material.mu());
        let ((sin, cos), (sin2, cos2)) =
            ((alpha * theta).sin_cos(), ((2.0 - alpha) * theta).sin_cos());
        [
            scale * ((k * A - self.b) * cos - alpha * A * cos2),
            scale * ((k * A + self.b) * sin - alpha * A * sin2),
        ]
    }

    /// With U = u_x + i u_y, phi' = a alpha z^(alpha-1) and psi' = b alpha z^(alpha-1):
    /// 2 mu dU/dx = k phi' - conj(phi' + conj(z) phi'' + psi'), 2 mu dU/dy = i (k phi' - conj(phi' - conj(z) phi'' - psi')).
    fn gradient(&self, x: [f64; 2]) -> Matrix2<f64> {
        let (r, theta) = polar(x);
        let (alpha, k) = (self.alpha, kolosov(&self.material));
        let scale = alpha * r.powf(alpha - 1.0) / (2.0 * self.material.mu());
        // phi' and psi' have the angle (alpha - 1) theta; z conj(phi'') has the angle (3 - alpha) theta.
        let ((sin, cos), (sin3, cos3)) =
            (((alpha - 1.0) * theta).sin_cos(), ((3.0 - alpha) * theta).sin_cos());
        let phi = [A * cos, A * sin];
        let rest =
            [A * (alpha - 1.0) * cos3 + self.b * cos, A * (alpha - 1.0) * sin3 - self.b * sin];
        let by_x = Vector2::new(k * phi[0] - phi[0] - rest[0], k * phi[1] + phi[1] - rest[1]);
        // i (x + i y) = -y + i x
        let by_y = Vector2::new(-(k * phi[1] + phi[1] + rest[1]), k * phi[0] - phi[0] + rest[0]);
        scale * Matrix2::from_columns(&[by_x, by_y])
    }

    fn regularity(&self) -> f64 {
        1.0 + self.alpha
    }

    fn features(&self) -> Features {
        // With r = t^g, sigma_n^2 dr = r^(2 alpha - 2) dr is a power t^(g (2 alpha - 1) - 1) dt. This g makes it a whole
        // one, and is large enough for the mixed term r^(alpha - 1) dr of an error to be smooth, too.
        let power = 2.0 * self.alpha - 1.0;
        let edge_grading = (LEAST_GRADING * power).ceil() / power;
        Features { kink: None, singular: Some(Singularity { point: [0.0; 2], edge_grading }) }
    }
}
