//! How sharp the limit 1/C_h of gamma0 is: the smallest eigenvalue lambda_min of A v = lambda K v on V^h beside its bound
//! 1 - kappa (Lemma 3.2), and gamma0*, at which it is zero. A is K - gamma0 M_1, M_1 the matrix of
//! int h_T sigma_n(u) sigma_n(v), so lambda_min = 1 - gamma0/gamma0* (docs/theory.md, 2.4).
//!
//! M_1 = S^T S with at most two rows of S for each contact edge. Hence, with the solver's own matrices,
//! 1/gamma0* = mu_max(S K^-1 S^T) and lambda_min = 1/(1 + gamma0 mu_max(S A^-1 S^T)) (docs/theory.md, 2.4).

use std::f64::consts::PI;

use faer::{Mat, Side};
use signorini::contact::Discretization;
use signorini::kernel::{Material, Plane};
use signorini::linear::factor::Factor;
use signorini::linear::matrix;
use signorini::linear::matrix::{LowerTriangle, Neighbours, Numbering};
use signorini::linear::ordering::nested_dissection;
use signorini::model::Degree;
use signorini::model::{Diagonal, Mesh, Problem, Rectangle, Trapezoid};
use signorini::solve::{Gamma0, Method, discretize_any};

use crate::claim::text;
use crate::problems::{self, cells, floor, held, mapped, unloaded};

/// What went wrong, in words.
type Result<T> = std::result::Result<T, String>;

/// A body with its name.
pub struct Specimen {
    /// What it is.
    pub name: String,
    /// Its mesh, material and conditions.
    pub problem: Problem,
}

/// The body clamped on the named sides, in contact at the bottom.
pub fn clamped(mesh: Mesh, material: Material<f64>, sides: &[&str]) -> Problem {
    let mut problem = unloaded(mesh, material, [("bottom", floor(0.0))]);
    problem.conditions.extend(sides.iter().map(|&side| (side.to_owned(), held([0.0; 2]))));
    problem
}

/// The material with lambda and mu = 1.
fn material(lambda: f64, plane: Plane) -> Material<f64> {
    Material::lame(lambda, 1.0, plane)
}

/// The trapezoid (-3, 0), (3, 0), (0, 4), (e, 4), which attains the limit as e goes to 0.
pub fn trapezoid(e: f64) -> Result<Problem> {
    let vertices = vec![[-3.0, 0.0], [3.0, 0.0], [0.0, 4.0], [e, 4.0]];
    let sides = [("bottom", [0, 1]), ("top", [2, 3])];
    let mesh = problems::mesh(vertices, vec![[0, 1, 2], [1, 3, 2]], sides)?;
    Ok(clamped(mesh, material(1.0, Plane::Strain), &["top"]))
}

/// Small bodies for exact arithmetic; the third one's vertices are moved to multiples of 1/32.
///
/// # Errors
/// A mesh that is none.
pub fn small_bodies() -> Result<Vec<Specimen>> {
    let strain = || material(1.0, Plane::Strain);
    let grid = |width, nx, diagonal| {
        let cells = Rectangle { width, height: 1.0, nx, ny: 1, diagonal };
        cells.mesh().map_err(text)
    };
    let wedge = Trapezoid { omega: 0.75 * PI, n: 1 }.mesh().map_err(text)?;
    let all = [
        ("square", clamped(grid(1.0, 1, Diagonal::Right)?, strain(), &["top"])),
        ("two cells", clamped(grid(2.0, 2, Diagonal::Right)?, strain(), &["top"])),
        ("two cells, moved", clamped(moved([2, 1], 1)?, strain(), &["top"])),
        ("crossed cell", clamped(grid(1.0, 1, Diagonal::Crossed)?, strain(), &["top"])),
        ("cell 4:1", clamped(grid(4.0, 1, Diagonal::Right)?, strain(), &["top"])),
        (
            "plane stress, lambda = 3",
            clamped(grid(1.0, 1, Diagonal::Left)?, material(3.0, Plane::Stress), &["top"]),
        ),
        ("wedge", clamped(wedge, strain(), &["right", "top"])),
        ("two triangles, e = 0.1", trapezoid(0.1)?),
        ("two triangles, e = 0.01", trapezoid(0.01)?),
    ];
    Ok(all.map(|(name, problem)| Specimen { name: name.to_owned(), problem }).into())
}

/// Unit cells whose vertices are moved at random by up to 0.2, to multiples of 1/32: areas stay short fractions.
///
/// # Errors
/// A mesh that is none.
pub fn moved(size: [usize; 2], seed: u64) -> Result<Mesh> {
    let mesh = cells(size, Diagonal::Right).perturbed(0.2, seed).map_err(text)?;
    mapped(&mesh, |x| x.map(|c| (32.0 * c).round() / 32.0))
}

/// A length that stands in gamma = gamma0 h_T, of an edge's triangle (its diameter h_T) or of the edge.
pub type Size = fn(diameter: f64, length: f64) -> f64;

/// h_T
pub const DIAMETER: Size = |diameter, _| diameter;

/// The free components in an order of elimination, with the pattern of the matrices.
struct Order {
    numbering: Numbering,
    neighbours: Neighbours,
}

impl Order {
    fn new(d: &Discretization) -> Self {
        let neighbours = Neighbours::new(&d.space);
        let order = nested_dissection(d.space.nodes(), &neighbours);
        Order { numbering: Numbering::new(&order, d.constraints.values()), neighbours }
    }

    /// The rows of S: for an affine w on an edge int w^2 = |E| (mean^2 + (difference of the end values)^2/12).
    fn stress_rows(&self, d: &Discretization, size: Size) -> Vec<Vec<f64>> {
        let mut rows = Vec::new();
        for edge in &d.contact {
            let h = size(d.space.mesh().diameter(edge.edge().triangle), edge.length);
            let weight = (h * edge.length).sqrt();
            for [start, end] in [[0.5, 0.5], [-1.0, 1.0].map(|c| c / 12.0_f64.sqrt())] {
                let mut row = vec![0.0; self.numbering.count];
                let (at_start, at_end) = (&edge.sigma_n[0], &edge.sigma_n[1]);
                for (k, &node) in edge.nodes.iter().enumerate() {
                    for (c, number) in self.numbering.of[node].iter().enumerate() {
                        if let Some(number) = *number {
                            row[number] = weight * (start * at_start[k][c] + end * at_end[k][c]);
                        }
                    }
                }
                rows.push(row);
            }
        }
        rows
    }
}

/// The largest eigenvalue of S matrix^-1 S^T.
fn largest(matrix: &LowerTriangle, rows: &[Vec<f64>]) -> Result<f64> {
    let factor = Factor::new(matrix).map_err(text)?;
    let mut columns = rows.to_vec();
    columns.iter_mut().for_each(|column| factor.forward(column));
    let product = |i: usize, j: usize| -> f64 {
        columns[i].iter().zip(&columns[j]).map(|(x, y)| x * y).sum()
    };
    let gram =
        Mat::from_fn(rows.len(), rows.len(), |i, j| if j <= i { product(i, j) } else { 0.0 });
    let eigenvalues = gram.self_adjoint_eigenvalues(Side::Lower).map_err(|e| format!("{e:?}"))?;
    eigenvalues.last().copied().ok_or_else(|| "no contact".to_owned())
}

/// The limits of gamma0 on a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// 1/C_h, where kappa = 1.
    pub proved: f64,
    /// gamma0*, where A ceases to be positive definite.
    pub sharp: f64,
}

impl Limits {
    /// gamma0* C_h: 1 says that the bound is sharp.
    pub fn ratio(&self) -> f64 {
        self.sharp / self.proved
    }

    /// 1 - gamma0/gamma0* for gamma0 = kappa/C_h.
    pub fn smallest_eigenvalue(&self, kappa: f64) -> f64 {
        1.0 - kappa / self.ratio()
    }
}

/// The method with this kappa, also beyond 1.
pub fn at_kappa(problem: &Problem, degree: Degree, kappa: f64) -> Result<Method> {
    let method = Method { degree, ..Method::default() };
    let outline = signorini::solve::check(problem, &method).map_err(text)?;
    let gamma0 = Gamma0::Value(kappa * outline.gamma.coercivity.limit());
    Ok(Method { gamma0, allow_noncoercive: true, ..method })
}

/// 1/C_h and gamma0* = 1/mu_max(S K^-1 S^T).
///
/// # Errors
/// A problem that is none.
pub fn limits(problem: &Problem, degree: Degree, size: Size) -> Result<Limits> {
    let method = Method { degree, ..Method::default() };
    let d = discretize_any(problem, &method).map_err(text)?;
    let order = Order::new(&d);
    let k = matrix::assemble_stiffness(&d, &order.numbering, &order.neighbours).map_err(text)?;
    let mu = largest(&k, &order.stress_rows(&d, size))?;
    Ok(Limits { proved: d.coercivity.limit(), sharp: 1.0 / mu })
}

/// lambda_min = 1/(1 + gamma0 mu_max(S A^-1 S^T)) with the solver's matrix A.
///
/// # Errors
/// A problem that is none, and A that is not positive definite.
pub fn smallest_eigenvalue(problem: &Problem, degree: Degree, kappa: f64) -> Result<f64> {
    let d = discretize_any(problem, &at_kappa(problem, degree, kappa)?).map_err(text)?;
    let order = Order::new(&d);
    let a = matrix::assemble(&d, &order.numbering, &order.neighbours).map_err(text)?;
    let mu = largest(&a, &order.stress_rows(&d, DIAMETER))?;
    Ok(1.0 / (1.0 + d.gamma0 * mu))
}
