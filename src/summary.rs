//! What the command says on the terminal: the result in five seconds.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use signorini::io::convergence::Study;
use signorini::io::result::Seconds;
use signorini::io::{Case, numbers};
use signorini::solve::{
    ContactQuadrature, GammaReport, NewtonReport, Outline, Settings, Solution, Status,
};

/// Lines of a name and a text.
#[derive(Default)]
struct Lines(String);

impl Lines {
    fn titled(title: &str) -> Self {
        Lines(format!("{title}\n"))
    }

    fn line(&mut self, name: &str, text: impl AsRef<str>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "  {name:<11} {}", text.as_ref());
    }
}

/// Of a solved case.
pub fn solved(case: &Case, s: &Solution, seconds: &Seconds, files: &[PathBuf]) -> String {
    let q = &s.quantities;
    let mut lines = Lines::titled(&case.title);
    lines.line("mesh", sizes(case, s.nodes.len(), s.contact.len(), s.degree));
    lines.line("coercivity", coercivity(&s.gamma));
    lines.line("newton", newton(&s.newton));
    lines.line("", history(&s.newton));
    lines.line(
        "contact",
        format!(
            "force {}, length {}, peak pressure {}",
            short(q.contact_force),
            short(q.contact_length),
            short(q.peak_pressure)
        ),
    );
    for (i, (boundary, reaction)) in q.reactions.iter().enumerate() {
        let name = if i == 0 { "reactions" } else { "" };
        lines.line(name, format!("{boundary}: {}", vector(*reaction)));
    }
    lines.line(
        "energy",
        format!(
            "a(u,u) = {}, L(u) = {}, largest displacement {}",
            short(q.energy),
            short(q.work),
            short(q.max_displacement)
        ),
    );
    lines.line(
        "time",
        format!(
            "read {}, assemble {}, solve {}, write {}",
            time(seconds.read),
            time(seconds.assemble),
            time(seconds.solve),
            time(seconds.write)
        ),
    );
    if let Some(exact) = &case.exact
        && let Ok(errors) = s.errors(&case.problem, &*exact.solution)
    {
        lines.line(
            "errors",
            format!(
                "energy {}, H1 {}, L2 {}, contact pressure {}, normal stress {}",
                short(errors.energy),
                short(errors.h1),
                short(errors.l2),
                short(errors.contact_residual),
                short(errors.normal_stress)
            ),
        );
    }
    lines.line("written", written(files));
    lines.0
}

/// Of a case that was only checked.
pub fn checked(case: &Case, outline: &Outline) -> String {
    let degree = case.method.degree.number();
    let mut lines = Lines::titled(&case.title);
    lines.line("mesh", sizes(case, outline.nodes, outline.contact_edges, degree));
    lines.line("prescribed", format!("{} of the unknowns", outline.prescribed));
    lines.line("coercivity", coercivity(&outline.gamma));
    lines.line(
        "quadrature",
        match case.method.quadrature {
            ContactQuadrature::Exact => "exact: contact edges are cut at the roots of P".to_owned(),
            ContactQuadrature::Gauss(1) => "1 Gauss point on each contact edge".to_owned(),
            ContactQuadrature::Gauss(n) => format!("{n} Gauss points on each contact edge"),
        },
    );
    lines.0
}

/// Of a case on finer and finer meshes.
pub fn studied(case: &Case, studies: &[Study], files: &[PathBuf]) -> String {
    let tables: Vec<String> = studies.iter().map(Study::table).collect();
    format!("{}\n\n{}\nwritten: {}\n", case.title, tables.join("\n"), written(files))
}

/// Of a case that Newton's method could not solve.
pub fn not_converged(file: &Path, settings: &Settings, report: &NewtonReport) -> String {
    format!(
        "{}: no convergence: the relative residual is {:.1e} after {}; expected at most {:e}. Nothing is written.\nresiduals: {}",
        file.display(),
        report.residual,
        count(report.iterations(), "Newton step"),
        settings.tolerance,
        history(report)
    )
}

fn sizes(case: &Case, nodes: usize, contact_edges: usize, degree: usize) -> String {
    let mesh = &case.problem.mesh;
    let h = (0..mesh.triangles().len()).map(|t| mesh.diameter(t)).fold(0.0, f64::max);
    format!(
        "{} P{degree} triangles, {} unknowns, {}, h = {}",
        mesh.triangles().len(),
        2 * nodes,
        count(contact_edges, "contact edge"),
        short(h)
    )
}

fn coercivity(gamma: &GammaReport) -> String {
    let [a, b] = gamma.coercivity.limiting_edge;
    let verdict = if gamma.kappa < 1.0 { "< 1: coercive" } else { ">= 1: no promise" };
    format!(
        "gamma0 = {} (limit {} at the edge {}-{}), kappa = {} {verdict}",
        short(gamma.gamma0),
        short(gamma.coercivity.limit()),
        vector(a),
        vector(b),
        short(gamma.kappa)
    )
}

fn newton(report: &NewtonReport) -> String {
    let verdict = match report.status {
        Status::Converged => "converged",
        Status::ConvergedToRounding => "converged to rounding",
        Status::NotConverged => "not converged",
    };
    format!(
        "{verdict} in {}, {}, relative residual {:.1e}",
        count(report.iterations(), "step"),
        count(report.factorizations, "factorisation"),
        report.residual
    )
}

fn history(report: &NewtonReport) -> String {
    let residuals: Vec<String> = report.residuals.iter().map(|r| format!("{r:.0e}")).collect();
    residuals.join(" ")
}

fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

fn vector([x, y]: [f64; 2]) -> String {
    format!("({}, {})", short(x), short(y))
}

/// Four significant digits.
fn short(x: f64) -> String {
    numbers::short(x, 4)
}

fn time(seconds: f64) -> String {
    if seconds < 1.0 { format!("{:.1} ms", 1e3 * seconds) } else { format!("{seconds:.2} s") }
}

/// folder/{a, b, c}
fn written(files: &[PathBuf]) -> String {
    let folder = files.first().and_then(|file| file.parent()).unwrap_or(Path::new(""));
    let names: Vec<_> =
        files.iter().flat_map(|f| f.file_name()).map(|n| n.to_string_lossy()).collect();
    format!("{}: {}", folder.display(), names.join(", "))
}
