//! Problems that the tests share.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::collections::BTreeMap;

use signorini::fem::{BoxedFunction, Condition, Diagonal, Mesh, Problem, Rectangle};
use signorini::kernel::{Material, Plane};
use signorini::solve::{ContactQuadrature, Degree, Gamma0, Method};

pub const EXACT: ContactQuadrature = ContactQuadrature::Exact;
pub const GAUSS: ContactQuadrature = ContactQuadrature::Gauss(4);

pub fn function(f: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static) -> BoxedFunction {
    Box::new(f)
}

pub fn constant(value: f64) -> BoxedFunction {
    function(move |_| value)
}

pub fn clamped() -> Condition {
    Condition::Displacement([Some(constant(0.0)), Some(constant(0.0))])
}

pub fn conditions<const K: usize>(parts: [(&str, Condition); K]) -> BTreeMap<String, Condition> {
    parts.into_iter().map(|(name, condition)| (name.to_owned(), condition)).collect()
}

pub fn unit_square(n: usize) -> Rectangle {
    Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Right }
}

/// The unit square with its inner vertices moved by up to a quarter of a cell.
pub fn skewed_square(n: usize, diagonal: Diagonal) -> Mesh {
    Rectangle { diagonal, ..unit_square(n) }.perturbed(0.25, 7).unwrap()
}

/// A block with lambda = mu = 1 on a rigid floor, clamped on top; the body force lifts its right part off.
pub fn block(mesh: Mesh) -> Problem {
    Problem {
        mesh,
        material: Material::lame(1.0, 1.0, Plane::Strain),
        body_force: [constant(0.0), function(|[x, _]| -4.0 + 10.0 * x)],
        conditions: conditions([
            ("top", clamped()),
            ("bottom", Condition::Contact { gap: constant(0.0) }),
        ]),
    }
}

pub fn method(degree: Degree, quadrature: ContactQuadrature) -> Method {
    Method { degree, gamma0: Gamma0::Auto, quadrature, allow_noncoercive: false }
}

/// Numbers in [-1, 1), the same in each run.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn field(&mut self, nodes: usize) -> Vec<[f64; 2]> {
        (0..nodes).map(|_| [self.next(), self.next()]).collect()
    }
}
