//! (b) The end of contact: u = O(r^(3/2)) at (c, 0), no body force, on the unit square with given displacement on
//! x = 0, x = 1 and y = 1. With z = x - c + i y = r e^(i theta), 0 <= theta <= pi, and Kolosov's constant k,
//!
//! 2 mu u_x = am (-(k - 1)/3 r^(3/2) sin(3 theta/2) - y r^(1/2) cos(theta/2)),
//! 2 mu u_y = am ( (k + 1)/3 r^(3/2) cos(3 theta/2) + y r^(1/2) sin(theta/2)).
//!
//! Contact with sigma_n = -am r^(1/2) for x < c; a gap that opens as r^(3/2) for x > c.

use super::{ExactSolution, kolosov};
use crate::fem::pieces::{Features, Singularity};
use crate::kernel::Material;

/// The solution (b).
#[derive(Clone, Debug, PartialEq)]
pub struct Singular {
    /// What the body is made of.
    pub material: Material<f64>,
    /// Where contact ends, inside (0, 1).
    pub c: f64,
    /// am > 0, in stress / length^(1/2).
    pub amplitude: f64,
}

/// (r, r^(1/2) cos(theta/2), r^(1/2) sin(theta/2)) without the angle and without cancellation. Of the two half-angle
/// formulas the one that adds is taken, the other factor follows from their product |y|/2.
fn root(x: f64, y: f64) -> [f64; 3] {
    let r = x.hypot(y);
    let larger = ((r + x.abs()) / 2.0).sqrt();
    let smaller = if larger > 0.0 { y / (2.0 * larger) } else { 0.0 };
    if x >= 0.0 { [r, larger, smaller] } else { [r, smaller, larger] }
}

impl Singular {
    /// (x - c, y) with y >= 0: rounding must not put a point of the contact line below it.
    fn local(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x - self.c, y.max(0.0)]
    }
}

impl ExactSolution for Singular {
    fn material(&self) -> &Material<f64> {
        &self.material
    }

    fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.local(x);
        let [_, cos, sin] = root(x, y);
        // z^(3/2) = z z^(1/2)
        let [cos3, sin3] = [x * cos - y * sin, x * sin + y * cos];
        let k = kolosov(&self.material);
        let scale = self.amplitude / (2.0 * self.material.mu());
        [scale * (-(k - 1.0) / 3.0 * sin3 - y * cos), scale * ((k + 1.0) / 3.0 * cos3 + y * sin)]
    }

    /// Without a value at the singular point itself when y > 0 is lost: there y r^(-1/2) counts as 0.
    fn gradient(&self, x: [f64; 2]) -> [[f64; 2]; 2] {
        let [x, y] = self.local(x);
        let [r, cos, sin] = root(x, y);
        let over_r = if r > 0.0 { y / r } else { 0.0 };
        let am = self.amplitude;
        // Phi = i am z^(1/2) and y Phi'.
        let (re, im) = (-am * sin, am * cos);
        let (re1, im1) = (am / 2.0 * over_r * sin, am / 2.0 * over_r * cos);
        let k = kolosov(&self.material);
        let (less, more) = ((k - 1.0) / 2.0, (k + 1.0) / 2.0);
        [[less * re - im1, -more * im - re1], [more * im - re1, less * re + im1]]
            .map(|row| row.map(|d| d / (2.0 * self.material.mu())))
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
