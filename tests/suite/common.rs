//! Problems that the tests share.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use faer::Mat;
use signorini::certificates::Continuous;
use signorini::exact::{Errors, Exact};
use signorini::io::certificate::{self, Header};
use signorini::io::{Case, Expression};
use signorini::kernel::{Material, Plane};
use signorini::linear::matrix::LowerTriangle;
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Mesh, Problem, Rectangle, SharedFunction, Space};
use signorini::solve::{ContactQuadrature, Gamma0, Method};

pub const DEGREES: [Degree; 2] = [Degree::One, Degree::Two];
pub const EXACT: ContactQuadrature = ContactQuadrature::Exact;
pub const GAUSS: ContactQuadrature = ContactQuadrature::Gauss(4);

/// The folder of the project, with its cases and pages.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap().to_owned()
}

pub fn function(f: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static) -> SharedFunction {
    Arc::new(f)
}

pub fn constant(value: f64) -> SharedFunction {
    function(move |_| value)
}

/// A function that knows that it is a polynomial, if it is one.
pub fn expression(text: &str) -> SharedFunction {
    Arc::new(text.parse::<Expression>().unwrap())
}

pub fn conditions<const K: usize>(parts: [(&str, Condition); K]) -> BTreeMap<String, Condition> {
    parts.into_iter().map(|(name, condition)| (name.to_owned(), condition)).collect()
}

/// lambda = mu = 1 in plane strain.
pub fn unit_material() -> Material<f64> {
    Material::lame(1.0, 1.0, Plane::Strain)
}

/// A case from its text, as if it lay in the folder `cases`, with keys set.
pub fn case_of(text: &str, settings: &[&str]) -> Case {
    let file = root().join("cases/in_a_test.toml");
    let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
    Case::parse(&file, text, &settings).unwrap()
}

/// A case of the folder `cases` with keys set.
pub fn case(name: &str, settings: &[&str]) -> Case {
    let file = root().join("cases").join(name);
    case_of(&std::fs::read_to_string(file).unwrap(), settings)
}

/// The files of a certificate.
pub fn encoded(certified: &Continuous) -> (Header, Vec<u8>) {
    let Continuous { certificate, proof, quantities, .. } = certified;
    certificate::encode("in a test", certificate, proof, &quantities.evidence)
}

/// The error of a displacement in the energy norm.
pub fn error_of(problem: &Problem, exact: &Exact, v: &[[f64; 2]]) -> f64 {
    let is_linear = v.len() == problem.mesh.vertices().len();
    let space = Space::new(&problem.mesh, if is_linear { Degree::One } else { Degree::Two });
    // The energy norm knows of no contact.
    Errors::new(&space, &[], v, &**exact).energy
}

/// The mesh with each vertex where `place` has it.
pub fn moved_to(mesh: &Mesh, place: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let vertices = mesh.vertices().iter().map(|&x| place(x)).collect();
    Mesh::new(vertices, mesh.triangles().to_vec(), named_edges(mesh)).unwrap()
}

/// The ends of the edges of each boundary, the body on the left.
pub fn named_edges(mesh: &Mesh) -> BTreeMap<String, Vec<[usize; 2]>> {
    let edges = |name: &str| mesh.edges_of(name).unwrap().iter().map(|&e| mesh.ends(e)).collect();
    mesh.boundary_names().map(|name| (name.to_owned(), edges(name))).collect()
}

/// A vector turned to the left by an angle.
pub fn turned(angle: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [cosine * x - sine * y, sine * x + cosine * y]
}

/// A regular polygon in the unit circle, cut into `rings` rings around its centre, vertex 0; its boundary is the `rim`.
pub fn polygon(corners: usize, rings: usize) -> Mesh {
    let mut vertices = vec![[0.0, 0.0]];
    for i in 1..=rings {
        let r = i as f64 / rings as f64;
        let angle = |j: usize| std::f64::consts::TAU * j as f64 / corners as f64;
        vertices.extend((0..corners).map(|j| turned(angle(j), [r, 0.0])));
    }
    let id = |i: usize, j: usize| 1 + (i - 1) * corners + j % corners;
    let mut triangles = Vec::new();
    for j in 0..corners {
        triangles.push([0, id(1, j), id(1, j + 1)]);
        for i in 1..rings {
            triangles.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            triangles.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
    }
    let rim = (0..corners).map(|j| [id(rings, j), id(rings, j + 1)]).collect();
    Mesh::new(vertices, triangles, [("rim".to_owned(), rim)]).unwrap()
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
    Problem::of(mesh, unit_material())
        .with_body_force(|_| 0.0, |[x, _]| -4.0 + 10.0 * x)
        .with("top", Condition::clamped())
        .with("bottom", Condition::contact(|_| 0.0))
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

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() + 1.0) / 2.0
    }

    /// 10^x with x between `low` and `high`.
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        10.0_f64.powf(self.between(low, high))
    }

    /// From `low` to `high`, both of them included.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        low + self.below(high - low + 1)
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn pick<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())].clone()
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

    use signorini::exact::Exact;
    use signorini::exact::{Corner, Kind, Singular, Smooth};
    use signorini::model::{Degree, Perturbation, Structured, Trapezoid};
    use signorini::solve::Settings;
    use study::{Ladder, SlipTip, StickSlip};

    use super::{EXACT, method, unit_material, unit_square};

    /// (a) with the exponents (3, 2) or (4, 3).
    pub fn smooth(k: f64, m: f64, c: f64) -> Exact {
        on_a_floor(k, m, c, Vec::new())
    }

    fn on_a_floor(k: f64, m: f64, c: f64, gap: Vec<f64>) -> Exact {
        let (ap, aq) = if k > 3.5 { (16.0, 8.0) } else { (8.0, 4.0) };
        Arc::new(Smooth { material: unit_material(), c, k, m, ap, aq, gap })
    }

    /// (a) with the exponents (4, 3) on a floor that is not flat.
    pub fn smooth_with_gap() -> Exact {
        on_a_floor(4.0, 3.0, 1.0 / 3.0, vec![0.2, -0.3, 0.5])
    }

    /// (e), which slides for x > 1/3.
    pub fn stick_slip() -> Exact {
        let material = unit_material();
        let (c, bound, pressure) = (1.0 / 3.0, 0.05, 0.5);
        Arc::new(StickSlip { material, c, k: 4.0, m: 3.0, a: 16.0, b: 0.2, bound, pressure })
    }

    /// (f), which slides for x > 1/2.
    pub fn slip_tip() -> Exact {
        let (c, bound, pressure) = (0.5, 0.05, 0.5);
        Arc::new(SlipTip { material: unit_material(), c, amplitude: 0.02, bound, pressure })
    }

    /// (e) or (f) on the unit square, n x n cells on level 0.
    pub fn with_friction(solution: &Exact, degree: Degree, n: usize) -> Ladder {
        let sides = [Kind::Displacement; 3];
        ladder(solution, Structured::Rectangle(unit_square(n)), sides, degree)
    }

    pub fn singular(c: f64) -> Exact {
        Arc::new(Singular { material: unit_material(), c, amplitude: 1.0 })
    }

    /// (c) with its exponent alpha; `omega` in units of pi.
    pub fn corner(omega: f64) -> (Exact, f64) {
        let corner = Corner::new(unit_material(), omega * PI).unwrap();
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
            method: method(degree, EXACT),
            settings: Settings::default(),
        }
    }

    /// (a) or (b) on the unit square, n x n cells on level 0.
    pub fn on_square(solution: &Exact, degree: Degree, n: usize) -> Ladder {
        let sides = match solution.body_force([0.5; 2]) {
            Some(_) => [Kind::Traction, Kind::Traction, Kind::Displacement],
            None => [Kind::Displacement; 3],
        };
        ladder(solution, Structured::Rectangle(unit_square(n)), sides, degree)
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

/// All entries of a symmetric matrix.
pub fn dense(lower: &LowerTriangle) -> Mat<f64> {
    let n = lower.starts.len() - 1;
    let mut all = Mat::zeros(n, n);
    for column in 0..n {
        for at in lower.starts[column]..lower.starts[column + 1] {
            let row = lower.rows[at];
            all[(row, column)] = lower.values[at];
            all[(column, row)] = lower.values[at];
        }
    }
    all
}
