//! How sharp the limit 1/C_h of gamma0 is: the smallest eigenvalue lambda_min of A v = lambda K v on V^h beside its bound
//! 1 - kappa (Lemma 3.2), and gamma0*, at which it is zero. A is K - gamma0 M_1, M_1 the matrix of
//! int h_T sigma_n(u) sigma_n(v), so lambda_min = 1 - gamma0/gamma0* (docs/theory.md, 2.4).
//!
//! M_1 = S^T S with at most two rows of S for each contact edge. Hence, with the solver's own matrices,
//! 1/gamma0* = mu_max(S K^-1 S^T) and lambda_min = 1/(1 + gamma0 mu_max(S A^-1 S^T)) (docs/theory.md, 2.4). On small bodies these
//! numbers are enclosed by exact counts; on meshes of any size they are the table `docs/figures/sharpness.csv`.

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

use approx::abs_diff_eq;
use faer::{Mat, Side};
use signorini::contact::Discretization;
use signorini::io::Case;
use signorini::kernel::{Material, Plane};
use signorini::linear::factor::Factor;
use signorini::linear::matrix;
use signorini::linear::matrix::{LowerTriangle, Neighbours, Numbering};
use signorini::linear::ordering::nested_dissection;
use signorini::model::Degree;
use signorini::model::{Diagonal, Perturbation, Problem, Rectangle, Structured, Trapezoid};
use signorini::solve::{Method, discretize_any};

use props::claim::{Outcome, noticed, text};
use props::discrete::Discrete;
use props::elimination::{Inertia, combined, inertia};
use props::numbers::Exact;
use props::sharpness::{at_kappa, clamped, moved, trapezoid};

/// A body with its name.
pub struct Specimen {
    /// What it is.
    pub name: String,
    /// Its mesh, material and conditions.
    pub problem: Problem,
}

/// Small bodies for exact arithmetic; the third one's vertices are moved to multiples of 1/32.
///
/// # Errors
/// A mesh that is none.
pub fn small_bodies() -> Result<Vec<Specimen>, String> {
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

/// How well an eigenvalue is known in doubles.
const TOLERANCE: f64 = 1e-11;

/// A length that stands in gamma = gamma0 h_T, of an edge's triangle (its diameter h_T) or of the edge.
type Size = fn(diameter: f64, length: f64) -> f64;

/// h_T
const DIAMETER: Size = |diameter, _| diameter;

/// The free components in an order of elimination, with the pattern of the matrices.
struct Order {
    numbering: Numbering,
    neighbours: Neighbours,
}

impl Order {
    fn new(d: &Discretization) -> Self {
        let neighbours = Neighbours::new(&d.space);
        let order = nested_dissection(d.space.nodes(), &neighbours);
        Order { numbering: Numbering::under(&order, &d.constraints), neighbours }
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
fn largest(matrix: &LowerTriangle, rows: &[Vec<f64>]) -> Result<f64, String> {
    let factor = Factor::new(matrix).map_err(text)?;
    let mut columns = rows.to_vec();
    columns.iter_mut().for_each(|column| factor.forward(column));
    let size = columns.first().map_or(0, Vec::len);
    let halves = Mat::from_fn(size, columns.len(), |i, k| columns[k][i]);
    let gram = halves.transpose() * &halves;
    let eigenvalues = gram.self_adjoint_eigenvalues(Side::Lower).map_err(|e| format!("{e:?}"))?;
    eigenvalues.last().copied().ok_or_else(|| "no contact".to_owned())
}

/// The limits of gamma0 on a mesh.
#[derive(Clone, Copy, Debug)]
struct Limits {
    /// 1/C_h, where kappa = 1.
    proved: f64,
    /// gamma0*, where A ceases to be positive definite.
    sharp: f64,
}

impl Limits {
    /// gamma0* C_h: 1 says that the bound is sharp.
    fn ratio(&self) -> f64 {
        self.sharp / self.proved
    }

    /// 1 - gamma0/gamma0* for gamma0 = kappa/C_h.
    fn smallest_eigenvalue(&self, kappa: f64) -> f64 {
        1.0 - kappa / self.ratio()
    }
}

/// 1/C_h and gamma0* = 1/mu_max(S K^-1 S^T).
fn limits(problem: &Problem, degree: Degree, size: Size) -> Result<Limits, String> {
    let method = Method { degree, ..Method::default() };
    let d = discretize_any(problem, &method).map_err(text)?;
    let order = Order::new(&d);
    let k = matrix::assemble_stiffness(&d, &order.numbering, &order.neighbours).map_err(text)?;
    let mu = largest(&k, &order.stress_rows(&d, size))?;
    Ok(Limits { proved: d.coercivity.limit(), sharp: 1.0 / mu })
}

/// lambda_min = 1/(1 + gamma0 mu_max(S A^-1 S^T)) with the solver's matrix A.
fn smallest_eigenvalue(problem: &Problem, degree: Degree, kappa: f64) -> Result<f64, String> {
    let d = discretize_any(problem, &at_kappa(problem, degree, kappa)?).map_err(text)?;
    let order = Order::new(&d);
    let a = matrix::assemble(&d, &order.numbering, &order.neighbours).map_err(text)?;
    let mu = largest(&a, &order.stress_rows(&d, DIAMETER))?;
    Ok(1.0 / (1.0 + d.gamma0 * mu))
}

/// Whether `smallest` is lambda_min of (A, K) with kappa = 1/2, up to the tolerance, by counting the eigenvalues of
/// A - l K = (1 - l) K - S for l on either side (Sylvester); the same counts for 1/(1 - l) times gamma0 say that A ceases
/// to be positive definite at gamma0*. And whether 1 - `share` kappa bounds it from below.
fn is_smallest(
    problem: &Problem,
    degree: Degree,
    smallest: f64,
    share: (i64, i64),
) -> Result<(), String> {
    let method = at_kappa(problem, degree, 0.5)?;
    let d = discretize_any(problem, &method).map_err(|error| error.to_string())?;
    Exact::scope(|| {
        let discrete = Discrete::new(&d);
        let (k, s) = (discrete.stiffness(), discrete.stresses());
        let one = Exact::from(1);
        let below = |l: Exact| inertia(&combined(one - l, &k, -one, &s));
        let [low, high] = [-TOLERANCE, TOLERANCE].map(|e| Exact::of_double(smallest + e));
        let bound = one - Exact::ratio(share.0, share.1) * super::certified::kappa(&discrete);
        if below(bound).negative > 0 {
            return Err(format!("an eigenvalue lies below 1 - {share:?} kappa"));
        }
        let Inertia { zero, negative, .. } = below(low);
        if zero + negative > 0 {
            return Err(format!("an eigenvalue lies below {smallest}"));
        }
        if below(high).negative == 0 {
            return Err(format!("no eigenvalue lies below {smallest} + {TOLERANCE}"));
        }
        Ok(())
    })
}

fn sharp_on(specimen: &Specimen, degree: Degree) -> Result<String, String> {
    let Specimen { name, problem } = specimen;
    let smallest = smallest_eigenvalue(problem, degree, 0.5)?;
    is_smallest(problem, degree, smallest, (1, 1))
        .map_err(|why| format!("{name}, P{}: {why}", degree.number()))?;
    let ratio = limits(problem, degree, DIAMETER)?.ratio();
    Ok(format!("{name} P{} {ratio:.3}", degree.number()))
}

/// lambda_min by the solver's matrices in doubles, enclosed by exact counts.
fn smallest_eigenvalues() -> Outcome {
    let mut text = Vec::new();
    for specimen in small_bodies()? {
        text.push(sharp_on(&specimen, Degree::One)?);
        text.push(sharp_on(&specimen, Degree::Two)?);
    }
    Ok(format!("gamma0* C_h: {}", text.join(", ")))
}

/// 1 - 0.99 kappa for 1 - kappa, on the two triangles that nearly attain it.
fn more_than_1_minus_kappa() -> Outcome {
    let problem = trapezoid(0.01)?;
    let smallest = smallest_eigenvalue(&problem, Degree::One, 0.5)?;
    noticed(is_smallest(&problem, Degree::One, smallest, (99, 100)).map(|()| String::new()))
}

/// |E| for h_T in the rows of S.
fn length_for_the_diameter() -> Outcome {
    let mut text = Vec::new();
    for Specimen { name, problem } in small_bodies()? {
        let limits = limits(&problem, Degree::One, |_, length| length)?;
        let smallest = limits.smallest_eigenvalue(0.5);
        // There the contact edge is the longest one.
        if name != "crossed cell" && !name.contains("triangles") {
            let result = is_smallest(&problem, Degree::One, smallest, (1, 1));
            text.push(format!("{name}: {}", noticed(result.map(|()| String::new()))?));
        }
    }
    Ok(text.join("; "))
}

/// The material with lambda and mu = 1.
fn material(lambda: f64, plane: Plane) -> Material<f64> {
    Material::lame(lambda, 1.0, plane)
}

/// Cells of a rectangle, `n` along each side.
fn rectangle(width: f64, n: usize, diagonal: Diagonal) -> Rectangle {
    Rectangle { width, height: 1.0, nx: n, ny: n, diagonal }
}

/// The bodies of the table.
fn specimens() -> Result<Vec<Specimen>, String> {
    let mut all = Vec::new();
    let mut add = |name: &str, problem| all.push(Specimen { name: name.to_owned(), problem });
    let strain = || material(1.0, Plane::Strain);
    let body = |structured: Structured, perturbation, material, sides: &[&str]| {
        let mesh = structured.mesh(perturbation).map_err(text)?;
        Ok::<_, String>(clamped(mesh, material, sides))
    };
    let rectangle_of = |width, n, diagonal| Structured::Rectangle(rectangle(width, n, diagonal));
    for n in [2, 16] {
        let square = rectangle_of(1.0, n, Diagonal::Right);
        add(&format!("square, n = {n}"), body(square, None, strain(), &["top"])?);
    }
    for n in [4, 16] {
        let square = rectangle_of(1.0, n, Diagonal::Crossed);
        add(&format!("square, crossed, n = {n}"), body(square, None, strain(), &["top"])?);
    }
    let square = rectangle_of(1.0, 8, Diagonal::Right);
    for amount in [0.2, 0.35] {
        let moved = Some(Perturbation { amount, seed: 1 });
        let name = format!("square, n = 8, vertices moved by up to {amount}");
        add(&name, body(square, moved, strain(), &["top"])?);
    }
    add("cells 4:1, n = 8", body(rectangle_of(4.0, 8, Diagonal::Right), None, strain(), &["top"])?);
    for lambda in [0.0, 100.0] {
        let name = format!("square, n = 8, lambda = {lambda}");
        add(&name, body(square, None, material(lambda, Plane::Strain), &["top"])?);
    }
    for lambda in [1.0, 100.0] {
        let name = format!("square, n = 8, plane stress, lambda = {lambda}");
        add(&name, body(square, None, material(lambda, Plane::Stress), &["top"])?);
    }
    for n in [8, 16] {
        let wedge = Structured::Trapezoid(Trapezoid { omega: 0.75 * PI, n });
        let name = format!("wedge of 3 pi/4, n = {n}");
        add(&name, body(wedge, None, strain(), &["right", "top"])?);
    }
    for e in [0.1, 0.01] {
        add(&format!("two triangles, e = {e}"), trapezoid(e)?);
    }
    let disk = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/disk.toml");
    add("cases/disk.toml, a Gmsh mesh", Case::read(&disk).map_err(text)?.problem);
    Ok(all)
}

/// The values of kappa in the table.
const KAPPAS: [f64; 2] = [0.5, 0.9];

/// A row of the table.
struct Row {
    /// The body.
    name: String,
    degree: Degree,
    /// 1/C_h and gamma0*.
    limits: Limits,
    /// kappa with lambda_min.
    eigenvalues: [(f64, f64); 2],
}

impl Row {
    fn new(specimen: &Specimen, degree: Degree) -> Result<Row, String> {
        let Specimen { name, problem } = specimen;
        let limits = limits(problem, degree, DIAMETER)?;
        let mut eigenvalues = KAPPAS.map(|kappa| (kappa, 0.0));
        for (kappa, smallest) in &mut eigenvalues {
            *smallest = smallest_eigenvalue(problem, degree, *kappa)?;
        }
        Ok(Row { name: name.clone(), degree, limits, eigenvalues })
    }
}

/// All rows.
fn rows() -> Result<Vec<Row>, String> {
    let mut rows = Vec::new();
    for specimen in specimens()? {
        rows.push(Row::new(&specimen, Degree::One)?);
        rows.push(Row::new(&specimen, Degree::Two)?);
    }
    Ok(rows)
}

/// The file `docs/figures/sharpness.csv`.
fn table(rows: &[Row]) -> String {
    let mut text = "body,triangles,1/C_h,gamma0*,gamma0* C_h".to_owned();
    for kappa in KAPPAS {
        let _ = write!(text, ",\"lambda_min, 1 - kappa = {:.1}\"", 1.0 - kappa);
    }
    text += "\n";
    for row in rows {
        let Limits { proved, sharp } = row.limits;
        let [half, most] = row.eigenvalues.map(|(_, smallest)| smallest);
        let _ = writeln!(
            text,
            "\"{}\",P{},{},{},{:.3},{half:.3},{most:.3}",
            row.name,
            row.degree.number(),
            digits(proved),
            digits(sharp),
            row.limits.ratio()
        );
    }
    text
}

/// Four significant digits.
fn digits(x: f64) -> String {
    let places = (3.0 - x.abs().log10().floor()).max(0.0) as usize;
    format!("{x:.places$}")
}

/// The table: as the code prints it, and within the bound, of which `share` times kappa is taken off.
fn is_printed_and_within(share: f64) -> Outcome {
    let rows = rows()?;
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/figures/sharpness.csv");
    let stored = std::fs::read_to_string(page).map_err(|error| error.to_string())?;
    let printed = table(&rows);
    if stored != printed {
        return Err(format!("{page} is stale; expected\n{printed}"));
    }
    for row in &rows {
        for (kappa, smallest) in row.eigenvalues {
            let affine = row.limits.smallest_eigenvalue(kappa);
            let near = abs_diff_eq!(smallest, affine, epsilon = TOLERANCE);
            if !(near && smallest >= 1.0 - share * kappa - TOLERANCE) {
                return Err(format!("{}: {smallest}, {affine}, kappa = {kappa}", row.name));
            }
        }
    }
    let ratios = rows.iter().map(|row| row.limits.ratio());
    let (low, high) =
        ratios.fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
    Ok(format!("{} rows, gamma0* C_h from {low:.4} to {high:.4}", rows.len()))
}

checks! {
    the_smallest_eigenvalue_of_the_solver_is_enclosed_by_exact_counts => smallest_eigenvalues();
    control_1_minus_kappa_one_percent_larger => more_than_1_minus_kappa();
    control_length_for_the_diameter => length_for_the_diameter();
    the_table_of_limits_is_printed_by_the_code_and_within_the_bound => is_printed_and_within(1.0);
    control_the_bound_one_percent_larger => noticed(is_printed_and_within(0.99));
}
