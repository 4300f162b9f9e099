//! Writes docs/convergence.md and its figures: rates on exact solutions, sweeps over gamma0 and lambda/mu, both sides of
//! Theorem 3.4, and two cases from the literature. From the root of the repository:
//!
//! ```text
//! cargo run --release -p study -- document
//! ```

use std::collections::BTreeMap;
use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use signorini::certificates::{Target, adapt, certify};
use signorini::exact::{Corner, Errors, Exact, Kind, Singular, Smooth};
use signorini::io::Case;
use signorini::io::picture::plot::{self, Figure, Panel, Style};
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{
    Condition, Diagonal, Function, Mesh, Perturbation, Problem, Rectangle, SharedFunction, Space,
    Structured, Trapezoid,
};
use signorini::results::Solution;
use signorini::solve::{ContactQuadrature, Gamma0, Method, Settings, SolveError, solve};

use crate::convergence::{self, NORMS, Study};
use crate::ladder::fitted_slope;
use crate::{Ladder, SlipTip, StickSlip, Theorem};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const PERTURBATION: Perturbation = Perturbation { amount: 0.2, seed: 1 };
const DEGREES: [Degree; 2] = [Degree::One, Degree::Two];

/// 8, 16, .. 128 cells a side.
const COARSEST: usize = 8;
const LEVELS: usize = 5;

/// An exact solution on its body.
struct Sample {
    file: &'static str,
    name: String,
    /// What is to be said about its rates.
    remark: &'static str,
    solution: Exact,
    omega: Option<f64>,
}

fn material(lambda: f64) -> Material<f64> {
    Material::lame(lambda, 1.0, Plane::Strain)
}

fn smooth(lambda: f64, k: f64, m: f64, c: f64, gap: &[f64]) -> Exact {
    let (ap, aq) = if k > 3.5 { (16.0, 8.0) } else { (8.0, 4.0) };
    Arc::new(Smooth { material: material(lambda), c, k, m, ap, aq, gap: gap.to_vec() })
}

fn samples() -> Result<Vec<Sample>> {
    let third = 1.0 / 3.0;
    let square = |file, name: &str, remark, solution| Sample {
        file,
        name: name.to_owned(),
        remark,
        solution,
        omega: None,
    };
    let singular =
        |c| -> Exact { Arc::new(Singular { material: material(1.0), c, amplitude: 1.0 }) };
    let mut all = vec![
        square(
            "smooth-32-half",
            "(a) k = 3, m = 2, c = 1/2",
            "P2 has the rate 2 on structured meshes, where the kink x = c lies on edges and u is smooth on each triangle; \
             3/2 is what regularity alone promises.",
            smooth(1.0, 3.0, 2.0, 0.5, &[]),
        ),
        square(
            "smooth-32-third",
            "(a) k = 3, m = 2, c = 1/3",
            "The kink runs through triangles. For P2 the rate comes down to 3/2 from above: on these meshes the smooth part of \
             the error, of order 2, is still the larger one.",
            smooth(1.0, 3.0, 2.0, third, &[]),
        ),
        square(
            "smooth-43-third",
            "(a) k = 4, m = 3, c = 1/3",
            "",
            smooth(1.0, 4.0, 3.0, third, &[]),
        ),
        square(
            "smooth-43-gap",
            "(a) k = 4, m = 3, c = 1/3, gap 0.2 - 0.3 x + 0.5 x²",
            "The method has the interpolant of the gap; the rates are those without a gap.",
            smooth(1.0, 4.0, 3.0, third, &[0.2, -0.3, 0.5]),
        ),
        square("singular-half", "(b) c = 1/2", "", singular(0.5)),
        square(
            "singular-third",
            "(b) c = 1/3",
            "The end of contact lies at 1/3 and 2/3 of its edge by turns, and the norms on the contact line alternate with it: \
             for P2 by a factor that makes rates of 0.5 and 2.5 between neighbours. Two levels apart the rate is 3/2.",
            singular(third),
        ),
    ];
    for (file, omega, of_pi) in
        [("corner-135", 0.75, "3/4"), ("corner-120", 2.0 / 3.0, "2/3"), ("corner-108", 0.6, "3/5")]
    {
        let omega = omega * PI;
        let corner = Corner::new(material(1.0), omega).ok_or("omega out of range")?;
        all.push(Sample {
            file,
            name: format!("(c) omega = {of_pi} pi, alpha = {:.4}", corner.alpha()),
            remark: "No norm is better than promised, and P2 is no better than P1: this is the range 0 < nu < 1/2 of Theorem \
                     3.5, and its rate is sharp. On perturbed meshes the rate on the contact line follows the size of the one \
                     triangle at the corner.",
            solution: Arc::new(corner),
            omega: Some(omega),
        });
    }
    let (material, bound, pressure) = (material(1.0), 0.05, 0.5);
    all.push(square(
        "stick-slip",
        "(e) Tresca's friction, sticks for x < 1/3",
        "Friction with the slip bound 0.05 under a pressure of 0.5; the norms on the contact line are those of the pressure. Theorem 3.5 is about \
         contact without friction; its rate is what the energy norm has.",
        Arc::new(StickSlip { material, c: third, k: 4.0, m: 3.0, a: 16.0, b: 0.2, bound, pressure }),
    ));
    all.push(square(
        "slip-tip",
        "(f) Tresca's friction, slides for x > 1/2",
        "As (e), without loads; the shear stress has a root where sliding ends.",
        Arc::new(SlipTip { material, c: 0.5, amplitude: 0.02, bound, pressure }),
    ));
    Ok(all)
}

impl Sample {
    fn ladder(&self, degree: Degree, perturbed: bool, n: usize) -> Ladder {
        let (body, sides) = match self.omega {
            Some(omega) => (
                Structured::Trapezoid(Trapezoid { omega, n }),
                [Kind::Traction, Kind::Displacement, Kind::Displacement],
            ),
            None => (
                Structured::Rectangle(Rectangle {
                    width: 1.0,
                    height: 1.0,
                    nx: n,
                    ny: n,
                    diagonal: Diagonal::Right,
                }),
                match (self.solution.body_force([0.5; 2]), self.solution.slip_bound()) {
                    (Some(_), None) => [Kind::Traction, Kind::Traction, Kind::Displacement],
                    _ => [Kind::Displacement; 3],
                },
            ),
        };
        let names = ["left", "right", "top", "bottom"].map(str::to_owned);
        let kinds = [sides[0], sides[1], sides[2], Kind::Contact];
        Ladder {
            solution: Arc::clone(&self.solution),
            kinds: BTreeMap::from_iter(names.into_iter().zip(kinds)),
            body,
            perturbation: perturbed.then_some(PERTURBATION),
            method: Method { degree, ..Method::default() },
            // Small gamma0 takes many Newton steps.
            settings: Settings { max_iterations: 500, ..Settings::default() },
        }
    }
}

/// The same ladder with kappa on level 0.
fn at_kappa(mut ladder: Ladder, kappa: f64) -> Result<Ladder> {
    let limit = ladder.outline(0)?.gamma.coercivity.limit();
    ladder.method.gamma0 = Gamma0::Value(kappa * limit);
    Ok(ladder)
}

fn rates(text: &mut String, figures: &Path, samples: &[Sample]) -> Result<()> {
    text.push_str(
        "## Rates\n\n\
         From 8 to 128 cells a side, slopes fitted over the last four meshes, `gamma0` fixed at half the limit. *Promised* is the \
         rate of Theorem 3.5, Corollary 3.6 and Remark 3.7, min(p, s - 1) for u in H^s, for all columns but L2. It is an upper \
         bound of the error: a norm may fall faster, and where contact changes smoothly the two norms on the contact line do, by \
         half an order. *Perturbed*: vertices moved at random by up to a fifth of a cell, a new mesh on every level; \
         its largest h_T shrinks by a little less than half from level to level, which adds up to 0.05 to their slopes, and the \
         constant in C h^r is a different one on each.\n\n\
         | solution | | mesh | promised | energy | H1 | contact pressure | normal stress | L2 | Newton steps |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    let mut below = String::new();
    for sample in samples {
        let mut studies: Vec<Study> = Vec::new();
        for degree in DEGREES {
            for perturbed in [false, true] {
                eprintln!("{}, P{}, perturbed: {perturbed}", sample.name, degree.number());
                let ladder = sample.ladder(degree, perturbed, COARSEST);
                studies.push(convergence::climb(ladder, LEVELS)?);
            }
        }
        for study in &studies {
            let slope =
                |i: usize| study.slope(NORMS[i].1).map_or("-".to_owned(), |s| format!("{s:.2}"));
            let steps: Vec<String> =
                study.levels.iter().map(|l| l.newton_steps.to_string()).collect();
            writeln!(
                text,
                "| {} | P{} | {} | {:.2} | {} | {} | {} | {} | {} | {} |",
                sample.name,
                study.degree.number(),
                if study.perturbed { "perturbed" } else { "structured" },
                study.promised,
                slope(0),
                slope(1),
                slope(3),
                slope(4),
                slope(2),
                steps.join(" ")
            )?;
        }
        fs::write(figures.join(format!("{}.csv", sample.file)), convergence::csv(&studies))?;
        let drawn = plot::figure(&convergence::plot(&sample.name, &studies))?;
        fs::write(figures.join(format!("{}.svg", sample.file)), drawn)?;
        let file = sample.file;
        writeln!(below, "\n### {}\n\n![errors over h](figures/{file}.svg)\n", sample.name)?;
        writeln!(below, "All numbers: [{file}.csv](figures/{file}.csv). {}", sample.remark)?;
    }
    text.push_str(&below);
    Ok(())
}

/// A panel of a sweep: its title, and what it shows.
type Norm = (&'static str, fn(&Errors) -> f64);

/// A line of a sweep.
struct Sweep {
    name: String,
    degree: Degree,
    colour: &'static str,
    points: Vec<(f64, Errors, usize)>,
}

fn sweep_figure(title: &str, x_label: &str, norms: &[Norm], sweeps: &[Sweep]) -> Figure {
    Figure {
        title: title.to_owned(),
        x_label: x_label.to_owned(),
        logarithmic: true,
        panels: norms
            .iter()
            .map(|(name, of)| Panel {
                title: (*name).to_owned(),
                lines: sweeps
                    .iter()
                    .map(|sweep| sweep.points.iter().map(|(x, e, _)| [*x, of(e)]).collect())
                    .collect(),
                slopes: Vec::new(),
            })
            .collect(),
        styles: sweeps
            .iter()
            .map(|s| Style {
                name: s.name.clone(),
                colour: s.colour,
                dashed: s.degree == Degree::Two,
            })
            .collect(),
    }
}

const KAPPAS: [f64; 8] = [1e-4, 1e-3, 0.01, 0.1, 0.25, 0.5, 0.75, 0.95];

fn gamma_sweep(text: &mut String, figures: &Path, samples: &[Sample]) -> Result<()> {
    text.push_str(
        "\n## gamma0 from 1e-4 to 0.95 of the limit\n\n\
         32 cells a side, structured. Over four orders of magnitude of gamma0 the H1 error changes by a few percent where the \
         pressure is bounded, and by about a fifth at the corner, where it is not: there a larger gamma0 is better. Newton's method takes more steps as gamma0 falls, because contact becomes stiffer. That is why the default is half the limit: it is as accurate as any other value, takes few steps, and is a factor of 2 away from the limit. The norms on the contact line have the weight \
         gamma^(1/2) and scale with it.\n\n",
    );
    text.push_str("| solution | | | ");
    KAPPAS.iter().try_for_each(|kappa| write!(text, "kappa = {kappa} | "))?;
    text.push_str(&format!("\n|{}\n", " --- |".repeat(3 + KAPPAS.len())));
    let mut sweeps = Vec::new();
    for sample in samples
        .iter()
        .filter(|s| ["smooth-43-third", "singular-half", "corner-135"].contains(&s.file))
    {
        for degree in DEGREES {
            let mut points = Vec::new();
            for kappa in KAPPAS {
                let ladder = at_kappa(sample.ladder(degree, false, 32), kappa)?;
                let level = ladder.solve(0)?.0;
                points.push((kappa, level.errors, level.newton_steps));
            }
            let errors: Vec<String> =
                points.iter().map(|(_, e, _)| format!("{:.3e}", e.h1)).collect();
            let steps: Vec<String> = points.iter().map(|(_, _, n)| n.to_string()).collect();
            let p = degree.number();
            writeln!(text, "| {} | P{p} | H1 | {} |", sample.name, errors.join(" | "))?;
            writeln!(text, "| | | Newton steps | {} |", steps.join(" | "))?;
            let name = sample.name.split(',').next().unwrap_or_default();
            let name = format!("{name}, P{p}");
            let colour = match sample.file {
                "smooth-43-third" => plot::COLOURS[0],
                "singular-half" => plot::COLOURS[2],
                _ => plot::COLOURS[1],
            };
            sweeps.push(Sweep { name, degree, colour, points });
        }
    }
    let norms: [Norm; 2] = [
        ("H1 norm of u − uʰ", |e| e.h1),
        ("contact pressure: ‖√γ (σₙ(u) − λʰ)‖", |e| e.contact_residual),
    ];
    let drawn = plot::figure(&sweep_figure("gamma0 below its limit", "kappa", &norms, &sweeps))?;
    fs::write(figures.join("gamma0.svg"), drawn)?;
    text.push_str("\n![errors over kappa](figures/gamma0.svg)\n");
    Ok(())
}

const LAMBDAS: [f64; 6] = [0.0, 1.0, 10.0, 100.0, 1e3, 1e4];

fn locking(text: &mut String, figures: &Path) -> Result<()> {
    text.push_str(
        "\n## lambda/mu from 0 to 1e4\n\n\
         Solution (a) with k = 4, m = 3, c = 1/3, whose displacement doesn't depend on lambda. H1 errors on 32 cells a side and the \
         slope over 8, 16, 32, 64. **P1 locks**: at 1e4 its error is eight times that at 1 and hardly falls on these meshes. P2 locks less: its error also grows about nine times, but it falls at a rate above 1. The finite element locks with and without contact. The limit of gamma0 is proportional to 1/(lambda + 2 mu): a gamma0 chosen from Young's modulus would exceed it, while one that keeps kappa = 1/2, as here, becomes small beside 1/mu, and Newton's method takes \
         more steps, as it does for small kappa above.\n\n\
         | lambda/mu | P1 H1 | P1 slope | P2 H1 | P2 slope | Newton steps P1, P2 |\n| --- | --- | --- | --- | --- | --- |\n",
    );
    let mut sweeps: Vec<Sweep> = DEGREES
        .map(|degree| Sweep {
            name: format!("P{}", degree.number()),
            degree,
            colour: if degree == Degree::One { plot::COLOURS[0] } else { plot::COLOURS[1] },
            points: Vec::new(),
        })
        .into();
    for lambda in LAMBDAS {
        let mut cells = Vec::new();
        let mut steps = Vec::new();
        for sweep in &mut sweeps {
            let sample = Sample {
                file: "",
                name: String::new(),
                remark: "",
                solution: smooth(lambda, 4.0, 3.0, 1.0 / 3.0, &[]),
                omega: None,
            };
            let ladder = sample.ladder(sweep.degree, false, 8);
            let study = convergence::climb(ladder, 4)?;
            let level = &study.levels[2];
            cells.push(format!(
                "{:.3e} | {:.2}",
                level.errors.h1,
                fitted_slope(&study.sizes(), &study.error(|e| e.h1))
            ));
            steps.push(level.newton_steps.to_string());
            sweep.points.push((lambda.max(0.1), level.errors, level.newton_steps));
        }
        writeln!(text, "| {lambda} | {} | {} |", cells.join(" | "), steps.join(", "))?;
    }
    let norms: [Norm; 1] = [("H1 norm of u − uʰ, n = 32", |e| e.h1)];
    let drawn =
        plot::figure(&sweep_figure("Locking", "lambda/mu (0 drawn at 0.1)", &norms, &sweeps))?;
    fs::write(figures.join("locking.svg"), drawn)?;
    text.push_str("\n![errors over lambda/mu](figures/locking.svg)\n");
    Ok(())
}

fn theorem(text: &mut String, samples: &[Sample]) -> Result<()> {
    text.push_str(
        "\n## Theorem 3.4 with its constant\n\n\
         The right side of the error estimate divided by its left side, on 8 and 32 cells a side; 1 would mean equality. \
         [9.1], [9.5] and [9.7] are the three forms proved in [theory.md](theory.md#9-theorem-34-with-explicit-constants): the first \
         two with v^h the Lagrange interpolant, the third with the a-orthogonal projection. The last column does the same for Corollary 3.6 at kappa = 1/2; where contact changes smoothly, the normal stress converges faster than the corollary says. Each entry: n = 8 / n = 32, structured meshes.\n\n\
         | solution | | [9.1], kappa = 0.1 | 0.5 | 0.9 | [9.5], 0.1 | 0.5 | 0.9 | [9.7], 0.1 | 0.5 | 0.9 | Cor. 3.6 |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    let mut extremes = [[f64::INFINITY, 0.0_f64]; 3];
    let mut count = 0;
    // The theorem is about contact without friction.
    for sample in samples.iter().filter(|sample| sample.solution.slip_bound().is_none()) {
        for degree in DEGREES {
            let mut rows = [[0.0; 2]; 10];
            for (k, kappa) in [0.1, 0.5, 0.9].into_iter().enumerate() {
                for (i, n) in [8, 32].into_iter().enumerate() {
                    for perturbed in [false, true] {
                        let ladder = at_kappa(sample.ladder(degree, perturbed, n), kappa)?;
                        let (_, problem, solution) = ladder.solve(0)?;
                        let t = Theorem::new(&problem, &solution, &*ladder.solution)?;
                        let all =
                            [t.plain(), t.sharp(), t.projected()].map(|right| right / t.left());
                        count += 1;
                        for (form, ratio) in all.into_iter().enumerate() {
                            extremes[form][0] = extremes[form][0].min(ratio);
                            extremes[form][1] = extremes[form][1].max(ratio);
                            if !perturbed {
                                rows[3 * form + k][i] = ratio;
                            }
                        }
                        if !perturbed && k == 1 {
                            rows[9][i] = t.corollary() / t.discrete.normal_stress;
                        }
                    }
                }
            }
            let cells: Vec<String> = rows.iter().map(|[a, b]| format!("{a:.2} / {b:.2}")).collect();
            writeln!(text, "| {} | P{} | {} |", sample.name, degree.number(), cells.join(" | "))?;
        }
    }
    let [plain, sharp, projected] = extremes.map(|[low, high]| format!("{low:.2} to {high:.2}"));
    writeln!(
        text,
        "\nOver all {count} combinations, perturbed meshes included, the ratio is {plain} for [9.1], {sharp} for [9.5] and \
         {projected} for [9.7]: never below 1, as proved."
    )?;
    Ok(())
}

/// The page with each table that stands directly above a figure `NAME.svg` moved into the file NAME.csv beside that figure.
fn tables_beside_figures(text: &str, figures: &Path) -> Result<String> {
    let paragraphs: Vec<&str> = text.split("\n\n").collect();
    let mut page = Vec::new();
    for (i, paragraph) in paragraphs.iter().enumerate() {
        let below = paragraphs.get(i + 1).and_then(|next| next.split_once("](figures/"));
        let figure = below.and_then(|(_, link)| link.split_once(".svg)"));
        match figure.filter(|_| paragraph.starts_with('|')) {
            Some((name, _)) => {
                fs::write(figures.join(format!("{name}.csv")), csv_of_table(paragraph))?;
                page.push(format!("All numbers: [{name}.csv](figures/{name}.csv)."));
            }
            None => page.push((*paragraph).to_owned()),
        }
    }
    Ok(page.join("\n\n"))
}

/// A table of Markdown in CSV, with a row for each of the lines that `<br>` makes in its cells.
fn csv_of_table(table: &str) -> String {
    let mut text = String::new();
    for row in table.lines().filter(|row| !row.starts_with("| ---")) {
        let row = row.trim();
        let row = row.strip_prefix('|').unwrap_or(row);
        let row = row.strip_suffix('|').unwrap_or(row);
        let cells: Vec<Vec<&str>> =
            row.split('|').map(|cell| cell.trim().split("<br>").collect()).collect();
        for line in 0..cells.iter().map(Vec::len).max().unwrap_or(0) {
            let entries = cells.iter().filter_map(|cell| cell.get(line).or(cell.first()));
            let quoted = entries.map(|entry| match entry.contains(',') {
                true => format!("\"{entry}\""),
                false => (*entry).to_owned(),
            });
            text += &(quoted.collect::<Vec<String>>().join(",") + "\n");
        }
    }
    text
}

/// The mesh with all lengths multiplied by `factor`.
fn scaled(mesh: &Mesh, factor: f64) -> Result<Mesh> {
    let names: Vec<String> = mesh.boundary_names().map(str::to_owned).collect();
    let mut named = Vec::new();
    for name in names {
        let edges = mesh.edges_of(&name)?.iter().map(|&edge| mesh.ends(edge)).collect();
        named.push((name, edges));
    }
    let vertices = mesh.vertices().iter().map(|x| x.map(|c| factor * c)).collect();
    Ok(Mesh::new(vertices, mesh.triangles().to_vec(), named)?)
}

/// The right half of a block on a parabolic floor; the left side is the line of symmetry.
fn hertz_block(n: usize) -> Result<Problem> {
    let rectangle = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Right };
    let constant = |value| -> SharedFunction { Arc::new(Constant(value)) };
    let conditions = [
        ("left", Condition::Displacement([Some(constant(0.0)), None])),
        ("top", Condition::Displacement([None, Some(constant(-0.015))])),
        ("bottom", Condition::Contact { gap: Arc::new(|[x, _]: [f64; 2]| x * x / 2.0) }),
    ];
    Ok(Problem::new(
        rectangle.mesh()?,
        Material::young_poisson(1000.0, 0.3, Plane::Strain),
        [constant(0.0), constant(0.0)],
        conditions.map(|(name, condition)| (name.to_owned(), condition)).into(),
    ))
}

struct Constant(f64);

impl Function for Constant {
    fn at(&self, _: [f64; 2]) -> f64 {
        self.0
    }
}

fn literature(text: &mut String) -> Result<()> {
    let case = Case::read(Path::new("cases/disk.toml"))?;
    text.push_str(
        "\n## Hertz\n\n\
         Plane strain, E = 1000, nu = 0.3, a floor with the curvature of a circle of radius R = 1. Hertz: for the force F, the half \
         width of contact is a = 2 (F R / (pi E*))^(1/2), the largest pressure p0 = 2 F / (pi a), with E* = E / (1 - nu²). F is \
         the computed one. *Block*: half of the block (-1, 1) x (0, 1), its gap x²/2, pushed down by 0.015 at the top. *Disk*: \
         `cases/disk.toml`, the half disk of a Gmsh mesh.\n\n\
         | | | F | half width | Hertz | | peak pressure | Hertz | |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for (name, problem, parts) in [
        ("block, n = 32", &hertz_block(32)?, 2.0),
        ("block, n = 64", &hertz_block(64)?, 2.0),
        ("block, n = 128", &hertz_block(128)?, 2.0),
        ("disk, edges of 0.01", &case.problem, 1.0),
    ] {
        for degree in DEGREES {
            let method = Method { degree, ..Method::default() };
            let (solution, _) = solve(problem, &method, &Settings::default())?;
            let q = &solution.quantities;
            let modulus = 1000.0 / (1.0 - 0.3 * 0.3);
            let (force, half) = (parts * q.contact_force, parts * q.contact_length / 2.0);
            let a = 2.0 * (force / (PI * modulus)).sqrt();
            let p0 = 2.0 * force / (PI * a);
            let percent = |x: f64, y: f64| format!("{:+.1} %", 100.0 * (x / y - 1.0));
            writeln!(
                text,
                "| {name} | P{} | {force:.4} | {half:.4} | {a:.4} | {} | {:.2} | {p0:.2} | {} |",
                degree.number(),
                percent(half, a),
                q.peak_pressure,
                percent(q.peak_pressure, p0)
            )?;
        }
    }
    text.push_str(
        "\nHertz' theory takes the body for a half space, which explains the difference that remains on the finest block and on the disk. The largest pressure here is that of -lambda^h, which oscillates a little along a curved line; the recovered pressure does not ([parts.md](parts.md)).\n\n\
         ## The disk of Chouly, Hild and Renard (2015)\n\n\
         Math. Comp. 84 (2015) 1089-1112 varies gamma0 on a disk with R = 20 cm, E = 25 MPa, nu = 0.25 under a body force of \
         20 MN/m³: gamma0 = 1/(100 E), 1/E, 100/E. The published curves were not available and are not quoted; the numbers below are our own, on the lower half of such a disk (the mesh of `cases/disk.toml`, its flat side clamped). The limit \
         of gamma0 depends only on the shapes of the triangles and on lambda + 2 mu = 30 MPa.\n\n\
         | | gamma0 | kappa | verdict | solved anyway |\n| --- | --- | --- | --- | --- |\n",
    );
    const YOUNG: f64 = 25.0;
    let mesh = scaled(&case.problem.mesh, 0.2)?;
    let zero = || -> SharedFunction { Arc::new(Constant(0.0)) };
    let disk = Problem::new(
        mesh,
        Material::young_poisson(YOUNG, 0.25, Plane::Strain),
        [zero(), Arc::new(Constant(-20.0))],
        BTreeMap::from([
            ("top".to_owned(), Condition::Displacement([Some(zero()), Some(zero())])),
            (
                "contact".to_owned(),
                Condition::Contact { gap: Arc::new(|[_, y]: [f64; 2]| y / (1.0 - 5.0 * y)) },
            ),
        ]),
    );
    for degree in DEGREES {
        for (name, gamma0) in
            [("1/(100 E)", 0.01 / YOUNG), ("1/E", 1.0 / YOUNG), ("100/E", 100.0 / YOUNG)]
        {
            let quadrature = ContactQuadrature::Exact;
            let method = Method {
                degree,
                gamma0: Gamma0::Value(gamma0),
                quadrature,
                allow_noncoercive: true,
            };
            let kappa = signorini::solve::check(&disk, &method)?.gamma.kappa;
            let outcome = match solve(&disk, &method, &Settings::default()) {
                Ok((solution, _)) => format!(
                    "{} Newton steps, force {:.4} MN/m, peak pressure {:.3} MPa",
                    solution.newton.iterations(),
                    solution.quantities.contact_force,
                    solution.quantities.peak_pressure
                ),
                Err(SolveError::NotConverged { .. }) => {
                    "Newton's method does not converge".to_owned()
                }
                Err(SolveError::NotPositiveDefinite) => {
                    "A(.,.) is not positive definite: no solution need exist".to_owned()
                }
                Err(error) => return Err(error.into()),
            };
            let verdict = if kappa < 1.0 { "coercive" } else { "refused: kappa >= 1" };
            writeln!(
                text,
                "| P{} | {name} | {kappa:.3} | {verdict} | {outcome} |",
                degree.number()
            )?;
        }
    }
    text.push_str(
        "\nOnly the smallest of the three values is below the limit of the symmetric method (theta = 1), for P1 and for P2. The others are also beyond the true limit: the factorisation finds that A(.,.) is indefinite.\n",
    );
    Ok(())
}

/// An adapted mesh, or a uniform one: unknowns, the true error, its bound.
type Measured = (usize, f64, f64);

/// Uniform meshes of 4 to 128 cells a side, and what one run of adaptivity makes of the coarsest up to so many unknowns.
const UNIFORM: usize = 6;
const ADAPTED: [usize; 6] = [100, 400, 1600, 6400, 25_600, 102_400];

fn energy_error(
    problem: &Problem,
    solution: &Solution,
    v: &[[f64; 2]],
    exact: &Exact,
) -> Result<f64> {
    let space = Space::new(&problem.mesh, Degree::One);
    Ok(Errors::new(&space, &solution.pieces, v, &**exact).energy)
}

fn adapted(ladder: &Ladder, max_unknowns: usize) -> Result<(Measured, usize)> {
    let target = Target { relative: 0.0, max_unknowns };
    let (method, settings) = (&ladder.method, &ladder.settings);
    let (problem, adapted) = adapt(ladder.problem(0)?, method, settings, target, &|_| {})?;
    let certified = adapted.certified?;
    let v = &certified.certificate.displacement;
    let error = energy_error(&problem, &adapted.solution, v, &ladder.solution)?;
    Ok(((2 * v.len(), error, certified.bound), adapted.levels.len()))
}

fn uniform(ladder: &Ladder, level: usize) -> Result<Measured> {
    let (_, problem, solution) = ladder.solve(level)?;
    let certified = certify(&problem, &solution)?;
    let v = &certified.certificate.displacement;
    let error = energy_error(&problem, &solution, v, &ladder.solution)?;
    Ok((2 * v.len(), error, certified.bound))
}

fn adaptivity(text: &mut String, figures: &Path, samples: &[Sample]) -> Result<()> {
    text.push_str(
        "\n## Meshes adapted to a proved bound\n\n\
         `[adapt]` bisects the triangles with the largest shares in the certificate's bound ([certificates.md](certificates.md)), \
         here from 4 cells a side on, P1. N unknowns on a uniform mesh are h ~ N^(-1/2): the slope of the error over N is \
         -1/2 at best, and -alpha/2 at the corner (c), where u is only in H^s for s < 1 + alpha. On adapted meshes it is \
         -1/2 again. (b) is in H^2, which is all that P1 needs, so it has its full rate on uniform meshes, too. *Error* is the true error in the energy norm, *bound* the certified one, which is computed without knowing the solution. Slopes over the last four rows.\n\n\
         | solution | mesh | unknowns | error | bound | bound / error | slope of the error | of the bound |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    let mut lines: [Vec<Vec<[f64; 2]>>; 2] = Default::default();
    let mut styles = Vec::new();
    for sample in samples.iter().filter(|s| ["singular-third", "corner-135"].contains(&s.file)) {
        eprintln!("{}, adapted", sample.name);
        let ladder = sample.ladder(Degree::One, false, 4);
        let uniform: Vec<Measured> =
            (0..UNIFORM).map(|level| uniform(&ladder, level)).collect::<Result<_>>()?;
        let runs: Vec<(Measured, usize)> =
            ADAPTED.into_iter().map(|most| adapted(&ladder, most)).collect::<Result<_>>()?;
        let levels: Vec<String> = runs.iter().map(|(_, levels)| levels.to_string()).collect();
        let adapted: Vec<Measured> = runs.into_iter().map(|(measured, _)| measured).collect();
        let name = sample.name.split(',').next().unwrap_or_default();
        for (mesh, measured, dashed) in [("uniform", uniform, true), ("adapted", adapted, false)] {
            let unknowns: Vec<f64> = measured.iter().map(|m| m.0 as f64).collect();
            let last = measured.len() - 4;
            let slope = |of: fn(&Measured) -> f64| {
                let values: Vec<f64> = measured.iter().map(of).collect();
                fitted_slope(&unknowns[last..], &values[last..])
            };
            let list = |of: fn(&Measured) -> String| -> String {
                measured.iter().map(of).collect::<Vec<_>>().join("<br>")
            };
            writeln!(
                text,
                "| {} | {} | {} | {} | {} | {} | {:.2} | {:.2} |",
                sample.name,
                if dashed {
                    mesh.to_owned()
                } else {
                    format!("{mesh}, levels {}", levels.join(" "))
                },
                list(|m| m.0.to_string()),
                list(|m| format!("{:.3e}", m.1)),
                list(|m| format!("{:.3e}", m.2)),
                list(|m| format!("{:.2}", m.2 / m.1)),
                slope(|m| m.1),
                slope(|m| m.2)
            )?;
            let point = |of: fn(&Measured) -> f64| {
                measured.iter().map(|m| [m.0 as f64, of(m)]).collect::<Vec<_>>()
            };
            lines[0].push(point(|m| m.1));
            lines[1].push(point(|m| m.2));
            styles.push(Style {
                name: format!("{name}, {mesh}"),
                colour: if sample.file == "corner-135" {
                    plot::COLOURS[1]
                } else {
                    plot::COLOURS[0]
                },
                dashed,
            });
        }
    }
    let titles = ["energy norm of u − v", "its certified bound"];
    let panels = titles.into_iter().zip(lines);
    let panels = panels
        .map(|(title, lines)| Panel { title: title.to_owned(), lines, slopes: Vec::new() })
        .collect();
    let title = "Adapted meshes".to_owned();
    let drawn = Figure { title, x_label: "unknowns".to_owned(), logarithmic: true, panels, styles };
    fs::write(figures.join("adapted.svg"), plot::figure(&drawn)?)?;
    text.push_str("\n![error and bound over the unknowns](figures/adapted.svg)\n");
    Ok(())
}

/// Writes the page and its figures into docs/ of the working directory.
///
/// # Errors
/// A solution that is not found, or a file that can't be written.
pub fn write() -> Result<()> {
    let figures = Path::new("docs/figures");
    fs::create_dir_all(figures)?;
    let samples = samples()?;
    let mut text = String::from(
        "# Convergence\n\n\
         The paper proves rates without numerical experiments. Here are experiments on the exact solutions of \
         [theory.md](theory.md#10-exact-solutions), lambda = mu = 1 unless it says otherwise. This page and its figures are written by\n\n\
         ```\ncargo run --release -p study -- document\n```\n\n\
         and one case is studied by, for example,\n\n\
         ```\ncargo run --release -p study -- convergence cases/smooth.toml --levels 5 --degree 1,2 --mesh structured,perturbed\n```\n\n\
         For P1 with exact contact integrals, u in H^2 and kappa < 1 the command prints a column *proved*: a bound of \
         (energy^2 + contact_residual^2 / (1 - kappa))^(1/2) by Theorem 3.5 with its number ([theory.md](theory.md), 9.6), and \
         how many times the error that is. It rests on Kobayashi's constant as quoted, takes the load as exact, and is a double \
         from quadrature, not rounded outwards.\n\n",
    );
    rates(&mut text, figures, &samples)?;
    adaptivity(&mut text, figures, &samples)?;
    eprintln!("gamma0");
    gamma_sweep(&mut text, figures, &samples)?;
    eprintln!("lambda/mu");
    locking(&mut text, figures)?;
    eprintln!("Theorem 3.4");
    theorem(&mut text, &samples)?;
    eprintln!("Hertz and the disk");
    literature(&mut text)?;
    fs::write("docs/convergence.md", tables_beside_figures(&text, figures)?)?;
    Ok(())
}
