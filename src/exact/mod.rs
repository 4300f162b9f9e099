//! Exact solutions of (1)-(2) in closed form, on which the method is measured. Why each is one: docs/theory.md, section 10.
//!
//! | solution | body | on Gamma_C | u in H^s for |
//! | --- | --- | --- | --- |
//! | [`Smooth`] | unit square | pressure for x < c, a gap opening for x > c | s < min(k - 1/2, m + 1/2) |
//! | [`Singular`] | unit square | the r^(3/2) singularity where contact ends | s < 5/2 |
//! | [`Corner`] | trapezoid | contact everywhere, pressure r^(alpha - 1) at one end | s < 1 + alpha |
//! | [`Patch`] | any | d1 to d5: u affine, so it lies in V^h | |
//!
//! Gamma_C lies on y = 0 in all of them: n = (0, -1), u_n = -u_y, sigma_n = sigma_yy. sigma_t = 0 means sigma_xy = 0. Those with
//! friction, which no case file asks for, are in the crate `study`.
//! lambda is the coefficient that acts in the plane, so plane stress needs no second set of formulas.

mod corner;
pub mod errors;
mod patch;
mod singular;
mod smooth;

use std::fmt::Debug;
use std::sync::Arc;

pub use corner::Corner;
pub use errors::Errors;
pub use patch::Patch;
pub use singular::{Place, Singular};
pub use smooth::Smooth;

use nalgebra::Matrix2;

use crate::kernel::{Material, Scalar, Stress};
use crate::model::graded_quadrature::Features;
use crate::model::{Condition, Function, SharedFunction};

/// A displacement field that solves (1)-(2), with its data.
pub trait ExactSolution: Debug + Send + Sync {
    /// The material of the body.
    fn material(&self) -> &Material<f64>;

    /// u
    fn displacement(&self, x: [f64; 2]) -> [f64; 2];

    /// du_i/dx_j in row i and column j.
    fn gradient(&self, x: [f64; 2]) -> Matrix2<f64>;

    /// \[u_xx, u_xy, u_yy\] of each component; `None` if u is not in H^2.
    fn second_derivatives(&self, _: [f64; 2]) -> Option<[[f64; 3]; 2]> {
        None
    }

    /// f = -div sigma(u); `None` if there is none anywhere.
    fn body_force(&self, _: [f64; 2]) -> Option<[f64; 2]> {
        None
    }

    /// g, the initial gap on Gamma_C.
    fn gap(&self, _: [f64; 2]) -> f64 {
        0.0
    }

    /// The slip bound of Tresca's friction on Gamma_C; `None` if there is no friction.
    fn slip_bound(&self) -> Option<f64> {
        None
    }

    /// The least upper bound of the s for which u is in H^s.
    fn regularity(&self) -> f64;

    /// Where u is less smooth than elsewhere.
    fn features(&self) -> Features {
        Features::default()
    }

    /// sigma(u)
    fn stress(&self, x: [f64; 2]) -> Stress<f64> {
        self.material().stress(self.gradient(x))
    }
}

/// An exact solution that problems, loads and error measures share.
pub type Exact = Arc<dyn ExactSolution>;

/// The condition that an exact solution prescribes on a part of the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Its displacement, at the nodes.
    Displacement,
    /// Its traction.
    Traction,
    /// The contact conditions with its gap.
    Contact,
}

impl Kind {
    /// The condition, its data taken from the solution.
    pub fn condition(self, solution: &Exact) -> Condition {
        let parts = |part: fn(usize) -> Datum| [0, 1].map(|c| field(solution, part(c)));
        match self {
            Kind::Displacement => Condition::Displacement(parts(Datum::Displacement).map(Some)),
            Kind::Traction => Condition::Traction(parts(Datum::Traction)),
            Kind::Contact => Condition::Contact { gap: field(solution, Datum::Gap) },
        }
    }
}

/// The body force of a solution.
pub fn body_force(solution: &Exact) -> [SharedFunction; 2] {
    [0, 1].map(|c| field(solution, Datum::BodyForce(c)))
}

/// One number of an exact solution as a function of the place.
struct Component {
    solution: Exact,
    part: Datum,
}

#[derive(Clone, Copy)]
enum Datum {
    Displacement(usize),
    BodyForce(usize),
    Traction(usize),
    Gap,
}

fn field(solution: &Exact, part: Datum) -> SharedFunction {
    Arc::new(Component { solution: Arc::clone(solution), part })
}

impl Function for Component {
    /// A traction has no value without a normal.
    fn at(&self, x: [f64; 2]) -> f64 {
        match self.part {
            Datum::Displacement(c) => self.solution.displacement(x)[c],
            Datum::BodyForce(c) => self.solution.body_force(x).unwrap_or_default()[c],
            Datum::Traction(_) => f64::NAN,
            Datum::Gap => self.solution.gap(x),
        }
    }

    fn on_boundary(&self, x: [f64; 2], n: [f64; 2]) -> f64 {
        match self.part {
            Datum::Traction(c) => self.solution.stress(x).traction(n.into())[c],
            _ => self.at(x),
        }
    }

    fn degree(&self) -> Option<u32> {
        match self.part {
            Datum::BodyForce(_) if self.solution.body_force([0.0; 2]).is_none() => Some(0),
            _ => None,
        }
    }

    fn kink(&self) -> Option<f64> {
        self.solution.features().kink
    }
}

/// Kolosov's constant (lambda + 3 mu) / (lambda + mu).
pub fn kolosov<S: Scalar>(material: &Material<S>) -> S {
    let (lambda, mu) = (material.lambda(), material.mu());
    (lambda + S::from(3) * mu) / (lambda + mu)
}

/// f = -(lambda + mu) grad div u - mu Laplace u, or -div (A eps(u)), from \[u_xx, u_xy, u_yy\] of each component.
pub fn force_of(
    material: &Material<f64>,
    [[xx, xy, yy], [vxx, vxy, vyy]]: [[f64; 3]; 2],
) -> [f64; 2] {
    if !material.is_isotropic() {
        let along_x = material.stress(Matrix2::new(xx, xy, vxx, vxy));
        let along_y = material.stress(Matrix2::new(xy, yy, vxy, vyy));
        let divergence = along_x.matrix().column(0) + along_y.matrix().column(1);
        return [-divergence[0], -divergence[1]];
    }
    let mu = material.mu();
    let both = material.lambda() + mu;
    [-both * (xx + vxy) - mu * (xx + yy), -both * (xy + vyy) - mu * (vxx + vyy)]
}

/// amplitude \[t\]+^exponent and its first derivatives with respect to t.
pub fn truncated_power<const K: usize>(amplitude: f64, exponent: f64, t: f64) -> [f64; K] {
    let mut factor = amplitude;
    let mut exponent = exponent;
    [(); K].map(|()| {
        let value = if t > 0.0 { factor * t.powf(exponent) } else { 0.0 };
        factor *= exponent;
        exponent -= 1.0;
        value
    })
}
