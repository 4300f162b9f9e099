//! (f) The end of sliding under friction: u = O(r^(3/2)) at (c, 0) beside a uniform pressure and shear, no body force, on the unit
//! square with given displacement on x = 0, x = 1 and y = 1. With z = x - c + i y, phi' = A z^(1/2) and Kolosov's constant k,
//!
//! u_x = s y / mu + (k Re phi - y Im phi') / mu,
//! u_y = -p y / (lambda + 2 mu) - y Re phi' / mu.
//!
//! On y = 0: u_n = 0; for x > c it slides, u_x = (2/3) k A (x - c)^(3/2) / mu, with sigma_xy = s; for x < c it sticks, with
//! sigma_xy = s - (1 + k) A |x - c|^(1/2) >= -s; sigma_n = -p + (1 - k) A \[x - c\]+^(1/2) < 0.

use signorini::exact::{ExactSolution, Place, kolosov};
use signorini::kernel::Material;
use signorini::model::graded_quadrature::{Features, Singularity};
use signorini::nalgebra::Matrix2;

/// The solution (f).
#[derive(Clone, Debug, PartialEq)]
pub struct SlipTip {
    /// The material of the body, isotropic.
    pub material: Material<f64>,
    /// Where sticking ends, inside (0, 1).
    pub c: f64,
    /// A > 0, in stress / length^(1/2), with (1 + k) A c^(1/2) <= 2 s.
    pub amplitude: f64,
    /// The slip bound, a stress.
    pub bound: f64,
    /// The contact pressure where it sticks, a stress.
    pub pressure: f64,
}

impl SlipTip {
    /// With y >= 0: rounding must not put a point of the contact line below it.
    fn place(&self, [x, y]: [f64; 2]) -> Place<f64> {
        Place::new(x - self.c, y.max(0.0))
    }

    /// The strains of the uniform stress: d u_x / dy and d u_y / dy.
    fn uniform(&self) -> [f64; 2] {
        let (lambda, mu) = (self.material.lambda(), self.material.mu());
        [self.bound / mu, -self.pressure / (lambda + 2.0 * mu)]
    }
}

impl ExactSolution for SlipTip {
    fn material(&self) -> &Material<f64> {
        &self.material
    }

    fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        let Place { x, y, cos, sin, .. } = self.place(x);
        let (a, mu, k) = (self.amplitude, self.material.mu(), kolosov(&self.material));
        let [shear, pressed] = self.uniform();
        // z^(3/2) = z z^(1/2)
        let phi = 2.0 / 3.0 * a * (x * cos - y * sin);
        [shear * y + (k * phi - y * a * sin) / mu, pressed * y - y * a * cos / mu]
    }

    /// Without a value at the singular point itself when y > 0 is lost: there y r^(-1/2) counts as 0.
    fn gradient(&self, x: [f64; 2]) -> Matrix2<f64> {
        let Place { over_r, cos, sin, .. } = self.place(x);
        let (a, mu, k) = (self.amplitude, self.material.mu(), kolosov(&self.material));
        let [shear, pressed] = self.uniform();
        // phi' and y phi''.
        let [re, im] = [a * cos, a * sin];
        let [re1, im1] = [a / 2.0 * over_r * cos, -a / 2.0 * over_r * sin];
        Matrix2::new(
            (k * re - im1) / mu,
            shear - ((k + 1.0) * im + re1) / mu,
            -re1 / mu,
            pressed - (re - im1) / mu,
        )
    }

    /// d/dx and d/dy of the entries of the gradient, by phi'' and y phi'''.
    fn second_derivatives(&self, x: [f64; 2]) -> Option<[[f64; 3]; 2]> {
        let Place { x, y, cos, sin, .. } = self.place(x);
        let (mu, k) = (self.material.mu(), kolosov(&self.material));
        let r = x.hypot(y);
        // z^(-1/2) = conj(z^(1/2)) / r, z^(-3/2) = z^(-1/2) conj(z) / r^2.
        let [re, im] = [cos / r, -sin / r];
        let [re3, im3] = [(re * x + im * y) / (r * r), (im * x - re * y) / (r * r)];
        let half = self.amplitude / 2.0;
        let [a, b] = [half * re, half * im];
        let [c, d] = [-half / 2.0 * y * re3, -half / 2.0 * y * im3];
        let of = |entries: [f64; 3]| entries.map(|entry| entry / mu);
        Some([
            of([k * a - d, -(k + 1.0) * b - c, -(k + 2.0) * a + d]),
            of([-c, -a + d, 2.0 * b + c]),
        ])
    }

    fn slip_bound(&self) -> Option<f64> {
        Some(self.bound)
    }

    fn regularity(&self) -> f64 {
        2.5
    }

    fn features(&self) -> Features {
        // With r = t^4, r dr is a power of t.
        Features {
            kink: None,
            singular: Some(Singularity { point: [self.c, 0.0], edge_grading: 4.0 }),
        }
    }
}
