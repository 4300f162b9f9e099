//! How sharp the limit of gamma0 is, on meshes of any size: the table `docs/figures/sharpness.csv`.

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

use signorini::io::Case;
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Diagonal, Perturbation, Rectangle, Structured, Trapezoid};

use props::claim::{Outcome, noticed, text};
use props::sharpness::{
    DIAMETER, Limits, Specimen, clamped, limits, smallest_eigenvalue, trapezoid,
};

/// How well an eigenvalue is known in doubles.
const TOLERANCE: f64 = 1e-11;

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
            let near = (smallest - affine).abs() <= TOLERANCE;
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
    the_table_of_limits_is_printed_by_the_code_and_within_the_bound => is_printed_and_within(1.0);
    control_the_bound_one_percent_larger => noticed(is_printed_and_within(0.99));
}
