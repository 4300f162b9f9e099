//! The case that is timed, and the plain linear elastic solve beside it.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use signorini::contact::Discretization;
use signorini::io::{Case, Expression};
use signorini::kernel::{Material, Plane};
use signorini::linear::factor::Factor;
use signorini::linear::matrix;
use signorini::linear::matrix::{LowerTriangle, Neighbours, Numbering};
use signorini::linear::ordering::nested_dissection;
use signorini::model::Degree;
use signorini::model::{
    BoundaryEdge, Condition, Diagonal, Mesh, Problem, Rectangle, SharedFunction,
};
use signorini::results::Solution;
use signorini::solve;
use signorini::solve::{ContactQuadrature, Method, Settings, Times};

/// A size of the case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// 1 or 2.
    pub degree: usize,
    /// Cells along a side.
    pub n: usize,
}

impl Size {
    /// The square as [`posed`] knows it.
    pub fn body(self) -> String {
        format!("square-{}", self.n)
    }

    /// Degrees of freedom, prescribed ones included.
    pub fn unknowns(self) -> usize {
        let nodes = self.degree * self.n + 1;
        2 * nodes * nodes
    }
}

/// The block on the floor: the unit square, clamped at the top, pressed down on the left and lifted on the right.
pub fn block(n: usize) -> Problem {
    let square = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Right };
    body(square.mesh().expect("a valid mesh"), "top", "-4 + 10*x", "0")
}

/// A body of lambda = mu = 1, clamped at one side, over a floor.
fn body(mesh: Mesh, clamped: &str, force: &str, gap: &str) -> Problem {
    let expression = |text: &str| -> SharedFunction {
        Arc::new(text.parse::<Expression>().expect("a valid expression"))
    };
    let zero = || expression("0");
    Problem::new(
        mesh,
        Material::lame(1.0, 1.0, Plane::Strain),
        [zero(), expression(force)],
        BTreeMap::from([
            (clamped.to_owned(), Condition::Displacement([Some(zero()), Some(zero())])),
            ("bottom".to_owned(), Condition::Contact { gap: expression(gap) }),
        ]),
    )
}

fn crossed(width: f64, height: f64, nx: usize, ny: usize) -> Mesh {
    let rectangle = Rectangle { width, height, nx, ny, diagonal: Diagonal::Crossed };
    rectangle.mesh().expect("a valid mesh")
}

fn strip() -> Problem {
    body(crossed(500.0, 1.0, 1000, 2), "top", "-4 + x/50", "0")
}

fn beam() -> Problem {
    body(crossed(20.0, 1.0, 320, 16), "left", "-1e-4", "0.01")
}

/// A square with cells that are graded to the floor by y^3.
fn graded() -> Problem {
    let square = crossed(1.0, 1.0, 96, 96);
    let graded = square.vertices().iter().map(|&[x, y]| [x, y.powi(3)]).collect();
    let sides = square.boundary_names().map(|name| {
        let edges = square.edges_of(name).expect("a name of its own").iter();
        (name.to_owned(), edges.map(|e| ends(&square, e)).collect())
    });
    let graded = Mesh::new(graded, square.triangles().to_vec(), sides);
    body(graded.expect("a valid mesh"), "top", "-4 + 10*x", "0")
}

/// The half disk on a floor of `cases/disk.toml`.
fn disk() -> Problem {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/disk.toml");
    Case::read(&file).expect("a valid case").problem
}

/// A problem in the words of the scripts for other codes (`reference/peers/common.py`).
pub struct Posed {
    /// Its name in tables.
    pub title: String,
    /// The problem.
    pub problem: Problem,
    held: &'static str,
    floor: &'static str,
    prescribed: [f64; 2],
    force: [f64; 2],
    level: f64,
}

/// `square-N`, `strip`, `beam`, `graded` or `disk`.
pub fn posed(name: &str) -> Posed {
    let posed = |title: &str, problem, held, force, level| Posed {
        title: title.to_owned(),
        problem,
        held,
        floor: "bottom",
        prescribed: [0.0; 2],
        force,
        level,
    };
    match name.split_once('-').map_or((name, ""), |parts| parts) {
        ("square", n) => {
            let n: usize = n.parse().expect("a number of cells");
            posed(&format!("square {n}"), block(n), "top", [-4.0, 10.0], 0.0)
        }
        ("strip", _) => posed("strip", strip(), "top", [-4.0, 0.02], 0.0),
        ("beam", _) => posed("beam", beam(), "left", [-1e-4, 0.0], -0.01),
        ("graded", _) => posed("graded", graded(), "top", [-4.0, 10.0], 0.0),
        ("disk", _) => Posed {
            floor: "contact",
            prescribed: [0.0, -0.015],
            ..posed("disk", disk(), "top", [0.0; 2], 0.0)
        },
        _ => panic!("expected square-N, strip, beam, graded or disk; found {name}"),
    }
}

impl Posed {
    /// The file that the scripts read.
    pub fn json(&self, degree: usize) -> String {
        let mesh = &self.problem.mesh;
        let edges = |name: &str| -> Vec<[usize; 2]> {
            let edges = mesh.edges_of(name).expect("a boundary of the body").iter();
            edges.map(|e| ends(mesh, e)).collect()
        };
        let material = self.problem.material.of(0);
        let (lambda, mu) = (material.lambda(), material.mu());
        serde_json::json!({
            "vertices": mesh.vertices(), "triangles": mesh.triangles(), "held": edges(self.held),
            "floor": edges(self.floor), "prescribed": self.prescribed, "force": self.force,
            "level": self.level, "lambda": lambda, "mu": mu, "degree": degree,
        })
        .to_string()
    }

    /// Degrees of freedom, prescribed ones included.
    pub fn unknowns(&self, degree: usize) -> usize {
        let mesh = &self.problem.mesh;
        let middles = if degree == 1 { 0 } else { mesh.edge_count() };
        2 * (mesh.vertices().len() + middles)
    }
}

fn ends(mesh: &Mesh, e: &BoundaryEdge) -> [usize; 2] {
    [0, 1].map(|k| mesh.triangles()[e.triangle][(e.local + 1 + k) % 3])
}

/// Method (8) with gamma0 at half the coercivity limit.
pub fn method(degree: usize, quadrature: ContactQuadrature) -> Method {
    let degree = if degree == 1 { Degree::One } else { Degree::Two };
    Method { degree, quadrature, ..Method::default() }
}

/// The whole contact solve, from the mesh to stresses and resultants.
pub fn contact(problem: &Problem, method: &Method) -> (Solution, Times) {
    let (solution, times) =
        solve::solve(problem, method, &Settings::default()).expect("the block has a solution");
    (solution, times)
}

/// The contact solve with its proof, from the mesh to displacements.
pub fn contact_alone(problem: &Problem, method: &Method) {
    let d = solve::discretize(problem, method).expect("a valid problem");
    let solved = solve::solve_discrete(&d, &Settings::default());
    std::hint::black_box(solved.expect("the body has a solution"));
}

/// How long a linear solve took.
#[derive(Clone, Copy, Debug)]
pub struct LinearTimes {
    /// Nodes, constraints, loads, order of elimination, matrix.
    pub assemble: Duration,
    /// Factorisation and substitution.
    pub solve: Duration,
}

impl LinearTimes {
    /// All of it.
    pub fn total(&self) -> Duration {
        self.assemble + self.solve
    }
}

/// One linear elastic solve of the same body with a free floor: same mesh, data, assembly and factorisation.
pub fn linear(problem: &Problem, degree: usize) -> LinearTimes {
    let start = Instant::now();
    let d = without_contact(problem, degree);
    let neighbours = Neighbours::new(&d.space);
    let (numbering, matrix) = matrix(&d, &neighbours, &dissect(&d, &neighbours));
    let assemble = start.elapsed();
    let start = Instant::now();
    let factor = Factor::new(&matrix).expect("a clamped body");
    // What is prescribed is zero, so that the loads are the right-hand side.
    let mut x = numbering.gather(&d.load);
    factor.forward(&mut x);
    factor.backward(&mut x);
    let mut u = d.constraints.lift();
    numbering.scatter(&x, &mut u);
    std::hint::black_box(&u);
    LinearTimes { assemble, solve: start.elapsed() }
}

/// The discretization of the body with a free floor.
pub fn without_contact(problem: &Problem, degree: usize) -> Discretization<'_> {
    let method = method(degree, ContactQuadrature::Exact);
    let mut d = solve::discretize(problem, &method).expect("a valid problem");
    d.contact.clear();
    d
}

/// The nodes in the order of nested dissection, without a contact layer.
pub fn dissect(d: &Discretization, neighbours: &Neighbours) -> Vec<usize> {
    let nodes = d.space.nodes();
    nested_dissection(nodes, neighbours)
}

/// The matrix with the nodes in this order.
pub fn matrix(
    d: &Discretization,
    neighbours: &Neighbours,
    order: &[usize],
) -> (Numbering, LowerTriangle) {
    let numbering = Numbering::under(order, &d.constraints);
    let matrix = matrix::assemble(d, &numbering, neighbours).expect("the pattern is that of d");
    (numbering, matrix)
}
