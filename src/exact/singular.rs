//! (b) The end of contact: u = O(r^(3/2)) at (c, 0), no body force, on the unit square with given displacement on
//! x = 0, x = 1 and y = 1. With z = x - c + i y = r e^(i theta), 0 <= theta <= pi, and Kolosov's constant k,
//!
//! 2 mu u_x = am (-(k - 1)/3 r^(3/2) sin(3 theta/2) - y r^(1/2) cos(theta/2)),
//! 2 mu u_y = am ( (k + 1)/3 r^(3/2) cos(3 theta/2) + y r^(1/2) sin(theta/2)).
//!
//! Contact with sigma_n = -am r^(1/2) for x < c; a gap that opens as r^(3/2) for x > c.
//!
//! The formulas need square roots only, so that they can be run over any number that is [`Enclosing`]: over doubles here,
//! over enclosures in `props`.

use nalgebra::Matrix2;

use super::{ExactSolution, kolosov};
use crate::kernel::{Enclosing, Material};
use crate::model::graded_quadrature::{Features, Singularity};

/// The solution (b).
#[derive(Clone, Debug, PartialEq)]
pub struct Singular<S = f64> {
    /// The material of the body.
    pub material: Material<S>,
    /// Where contact ends, inside (0, 1).
    pub c: S,
    /// am > 0, in stress / length^(1/2).
    pub amplitude: S,
}

/// A place with y >= 0, seen from the singular point, and z^(1/2) there.
#[derive(Clone, Copy, Debug)]
pub struct Place<S> {
    /// x - c
    pub x: S,
    /// y
    pub y: S,
    /// y / r = sin theta; 0 where r is.
    pub over_r: S,
    /// r^(1/2) cos(theta/2)
    pub cos: S,
    /// r^(1/2) sin(theta/2)
    pub sin: S,
}

impl<S: Enclosing> Place<S> {
    /// Without the angle and without cancellation: of the two half-angle formulas the one that adds is taken, the other
    /// factor follows from their product y/2.
    pub fn new(x: S, y: S) -> Self {
        let (zero, two) = (S::from(0), S::from(2));
        let r = (x * x + y * y).sqrt();
        let larger = |x: S| ((r + x) / two).sqrt();
        let smaller = |larger: S| larger.split(|_| zero, |larger| y / (two * larger));
        // Either may stand for the other: where the sign of x is undecided, the second is taken.
        let [cos, sin] = if x.is_at_most(0.0) {
            let sin = larger(-x);
            [smaller(sin), sin]
        } else {
            let cos = larger(x);
            [cos, smaller(cos)]
        };
        Place { x, y, over_r: r.split(|_| zero, |r| y / r), cos, sin }
    }
}

impl<S: Enclosing> Singular<S> {
    /// u
    pub(crate) fn displacement_at(&self, place: &Place<S>) -> [S; 2] {
        let &Place { x, y, cos, sin, .. } = place;
        // z^(3/2) = z z^(1/2)
        let [cos3, sin3] = [x * cos - y * sin, x * sin + y * cos];
        let (one, three) = (S::from(1), S::from(3));
        let k = kolosov(&self.material);
        let scale = self.amplitude / (S::from(2) * self.material.mu());
        [
            scale * (-((k - one) / three * sin3) - y * cos),
            scale * ((k + one) / three * cos3 + y * sin),
        ]
    }

    /// du_i/dx_j. Without a value at the singular point itself when y > 0 is lost: there y r^(-1/2) counts as 0.
    fn gradient_at(&self, place: &Place<S>) -> Matrix2<S> {
        let &Place { over_r, cos, sin, .. } = place;
        let (one, two) = (S::from(1), S::from(2));
        let am = self.amplitude;
        // Phi = i am z^(1/2) and y Phi'.
        let (re, im) = (-(am * sin), am * cos);
        let (re1, im1) = (am / two * over_r * sin, am / two * over_r * cos);
        let k = kolosov(&self.material);
        let (less, more) = ((k - one) / two, (k + one) / two);
        Matrix2::new(less * re - im1, -(more * im) - re1, more * im - re1, less * re + im1)
            / (two * self.material.mu())
    }
}

impl Singular {
    /// With y >= 0: rounding must not put a point of the contact line below it.
    fn place(&self, [x, y]: [f64; 2]) -> Place<f64> {
        Place::new(x - self.c, y.max(0.0))
    }
}

impl ExactSolution for Singular {
    fn material(&self) -> &Material<f64> {
        &self.material
    }

    fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        self.displacement_at(&self.place(x))
    }

    fn gradient(&self, x: [f64; 2]) -> Matrix2<f64> {
        self.gradient_at(&self.place(x))
    }

    /// From Phi' = i am z^(-1/2)/2 and y Phi'' = -i am y z^(-3/2)/4: d/dx and d/dy of the entries of the gradient.
    fn second_derivatives(&self, x: [f64; 2]) -> Option<[[f64; 3]; 2]> {
        let Place { x, y, cos, sin, .. } = self.place(x);
        let r = x.hypot(y);
        // z^(-1/2) = conj(z^(1/2))/r, z^(-3/2) = z^(-1/2) conj(z)/r^2.
        let [re, im] = [cos / r, -sin / r];
        let [re3, im3] = [(re * x + im * y) / (r * r), (im * x - re * y) / (r * r)];
        let am = self.amplitude;
        let [p, q] = [-am / 2.0 * im, am / 2.0 * re];
        let [s, t] = [am / 4.0 * y * im3, -am / 4.0 * y * re3];
        let k = kolosov(&self.material);
        let (less, more) = ((k - 1.0) / 2.0, (k + 1.0) / 2.0);
        let of = |entries: [f64; 3]| entries.map(|entry| entry / (2.0 * self.material.mu()));
        Some([
            of([less * p - t, -more * q - s, t - (more + 1.0) * p]),
            of([more * q - s, less * p + t, (1.0 - less) * q + s]),
        ])
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
