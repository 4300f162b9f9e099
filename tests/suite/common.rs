//! Problems that the tests share.

use std::collections::BTreeMap;
use std::sync::Arc;

use signorini::fem::{Condition, Diagonal, Mesh, Problem, Rectangle, SharedFunction};
use signorini::kernel::{Material, Plane};
use signorini::solve::{ContactQuadrature, Degree, Gamma0, Method};

pub const EXACT: ContactQuadrature = ContactQuadrature::Exact;
pub const GAUSS: ContactQuadrature = ContactQuadrature::Gauss(4);

pub fn function(f: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static) -> SharedFunction {
    Arc::new(f)
}

pub fn constant(value: f64) -> SharedFunction {
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
    Problem::new(
        mesh,
        Material::lame(1.0, 1.0, Plane::Strain),
        [constant(0.0), function(|[x, _]| -4.0 + 10.0 * x)],
        conditions([("top", clamped()), ("bottom", Condition::Contact { gap: constant(0.0) })]),
    )
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

    /// Below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.next() + 1.0) / 2.0 * n as f64) as usize
    }

    pub fn field(&mut self, nodes: usize) -> Vec<[f64; 2]> {
        (0..nodes).map(|_| [self.next(), self.next()]).collect()
    }
}

/// The plain solutions of docs/theory.md, section 10, each with the mesh of its body in one cell.
pub mod exact {
    use std::collections::BTreeMap;
    use std::f64::consts::PI;
    use std::sync::Arc;

    use signorini::fem::{Diagonal, Perturbation, Rectangle, Structured, Trapezoid};
    use signorini::kernel::{Material, Plane};
    use signorini::solve::{ContactQuadrature, Degree, Gamma0, Method, Settings};
    use signorini::study::Exact;
    use signorini::study::Ladder;
    use signorini::study::exact::{Corner, Kind, Singular, Smooth};

    pub fn material() -> Material<f64> {
        Material::lame(1.0, 1.0, Plane::Strain)
    }

    /// (a) with the exponents (3, 2) or (4, 3).
    pub fn smooth(k: f64, m: f64, c: f64) -> Exact {
        let (ap, aq) = if k > 3.5 { (16.0, 8.0) } else { (8.0, 4.0) };
        Arc::new(Smooth { material: material(), c, k, m, ap, aq, gap: Vec::new() })
    }

    /// (a) with the exponents (4, 3) on a floor that is not flat.
    pub fn smooth_with_gap() -> Exact {
        let gap = vec![0.2, -0.3, 0.5];
        Arc::new(Smooth {
            material: material(),
            c: 1.0 / 3.0,
            k: 4.0,
            m: 3.0,
            ap: 16.0,
            aq: 8.0,
            gap,
        })
    }

    pub fn singular(c: f64) -> Exact {
        Arc::new(Singular { material: material(), c, amplitude: 1.0 })
    }

    /// (c) with its exponent alpha; `omega` in units of pi.
    pub fn corner(omega: f64) -> (Exact, f64) {
        let corner = Corner::new(material(), omega * PI).unwrap();
        let alpha = corner.alpha();
        (Arc::new(corner), alpha)
    }

    /// The ladder of a solution whose body has the kinds left, right and top; contact below, half the coercivity limit.
    fn ladder(
        solution: &Exact,
        body: Structured,
        [left, right, top]: [Kind; 3],
        degree: Degree,
    ) -> Ladder {
        let kinds = [("bottom", Kind::Contact), ("left", left), ("right", right), ("top", top)];
        Ladder {
            solution: Arc::clone(solution),
            kinds: BTreeMap::from(kinds.map(|(name, kind)| (name.to_owned(), kind))),
            body,
            perturbation: None,
            method: Method {
                degree,
                gamma0: Gamma0::Auto,
                quadrature: ContactQuadrature::Exact,
                allow_noncoercive: false,
            },
            settings: Settings::default(),
        }
    }

    /// (a) or (b) on the unit square, n x n cells on level 0.
    pub fn on_square(solution: &Exact, degree: Degree, n: usize) -> Ladder {
        let square = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Right };
        let sides = match solution.body_force([0.5; 2]) {
            Some(_) => [Kind::Traction, Kind::Traction, Kind::Displacement],
            None => [Kind::Displacement; 3],
        };
        ladder(solution, Structured::Rectangle(square), sides, degree)
    }

    /// (c) on its trapezoid.
    pub fn on_trapezoid(solution: &Exact, omega: f64, degree: Degree, n: usize) -> Ladder {
        let body = Structured::Trapezoid(Trapezoid { omega: omega * PI, n });
        let sides = [Kind::Traction, Kind::Displacement, Kind::Displacement];
        ladder(solution, body, sides, degree)
    }

    pub fn moved(ladder: Ladder) -> Ladder {
        Ladder { perturbation: Some(Perturbation { amount: 0.2, seed: 1 }), ..ladder }
    }
}
