//! Our own times: the contact solve over one linear solve, growth, Newton's method, phases.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use signorini::io::run::Solved;
use signorini::io::{Case, outputs};
use signorini::solve::{self, ContactQuadrature, Times};

use crate::child::{self, Task};
use crate::problem::{self, Size};
use crate::table::{bytes, seconds, table, time};

/// A body of [`problem::posed`] with elements of a degree, and minima on it.
pub struct Measured {
    pub degree: usize,
    /// What it is.
    title: String,
    is_square: bool,
    pub unknowns: usize,
    /// One linear elastic solve.
    pub linear: Duration,
    /// The contact solve, to judged displacements.
    pub contact: Duration,
    /// The proof of it.
    proof: Duration,
    /// All of it.
    both: Duration,
    /// The route, Newton steps, factorisations, the relative radius that is proved.
    told: [String; 4],
    /// The instructions of the linear solve, and of the contact solve with its proof.
    instructions: Option<[f64; 2]>,
    /// The peak memory of a contact solve in bytes.
    pub memory: f64,
}

/// Small sizes are run more often: up to so many times,
const MANY: usize = 50;

/// within this time.
const BRIEF: Duration = Duration::from_millis(500);

/// The most unknowns for which instructions are counted: valgrind takes fifty times as long as the solve.
const COUNTED: usize = 40_000;

/// The bodies: squares up to `linear` cells along a side for P1 and `quadratic` for P2, and others.
pub fn bodies(linear: usize, quadratic: usize) -> Vec<(String, usize)> {
    let squares = |degree, most| {
        let sizes = (6..10).map(|k| 1 << k).filter(move |&n| n <= most);
        sizes.map(move |n| (Size { degree, n }.body(), degree))
    };
    let others = ["strip", "beam", "graded", "disk"];
    let others = others.iter().flat_map(|name| [1, 2].map(|degree| ((*name).to_owned(), degree)));
    squares(1, linear).chain(squares(2, quadratic)).chain(others).collect()
}

/// Linear and contact solves in turn, at least `repetitions` of each.
pub fn measure(name: &str, degree: usize, repetitions: usize) -> Measured {
    let problem::Posed { title, problem, .. } = problem::posed(name);
    let method = problem::method(degree, ContactQuadrature::Exact);
    let [mut linear, mut contact, mut proof, mut both] = [Duration::MAX; 4];
    let (mut told, mut unknowns) = ([const { String::new() }; 4], 0);
    let (start, mut runs) = (Instant::now(), 0);
    while runs < repetitions || (runs < MANY && start.elapsed() < BRIEF) {
        runs += 1;
        linear = linear.min(problem::linear(&problem, degree).total());
        let (solution, times) = problem::contact(&problem, &method);
        let solve = times.assemble() + times.solve();
        contact = contact.min(solve);
        proof = proof.min(times.certify);
        both = both.min(solve + times.certify);
        let radius = solution.enclosure.as_ref().ok().and_then(|e| e.relative);
        unknowns = 2 * solution.displacement.len();
        told = [
            format!("{:?}", solution.method.route).to_lowercase(),
            solution.newton.iterations().to_string(),
            solution.newton.factorizations.to_string(),
            radius.map_or("none".to_owned(), |radius| format!("{radius:.0e}")),
        ];
    }
    let is_counted = unknowns <= COUNTED;
    let instructions = if is_counted { child::instructions(degree, name) } else { None };
    let memory = child::start(Task::Contact, degree, name).memory as f64;
    eprintln!("{title}, P{degree}: measured");
    let is_square = name.starts_with("square-");
    Measured {
        degree,
        title,
        is_square,
        unknowns,
        linear,
        contact,
        proof,
        both,
        told,
        instructions,
        memory,
    }
}

/// The squares of a degree, the smallest first.
pub fn squares(own: &[Measured], degree: usize) -> impl Iterator<Item = &Measured> {
    own.iter().filter(move |m| m.is_square && m.degree == degree)
}

/// The contact solve with its proof over one linear solve.
pub fn ratio_table(own: &[Measured]) -> String {
    let row = |m: &Measured| {
        let [route, steps, factorizations, radius] = m.told.clone();
        let share = m.instructions.map(|[linear, both]| format!("{:.2}", both / linear));
        vec![
            m.title.clone(),
            format!("P{}", m.degree),
            m.unknowns.to_string(),
            route,
            format!("{steps} / {factorizations}"),
            time(m.linear),
            time(m.contact),
            time(m.proof),
            radius,
            format!("**{:.2}**", ratio(m.both, m.linear)),
            share.unwrap_or_default(),
            format!("{:.0}", m.memory / m.unknowns as f64),
        ]
    };
    let head = [
        "body",
        "",
        "unknowns",
        "route",
        "steps / factorisations",
        "linear",
        "contact",
        "proof",
        "radius",
        "ratio",
        "instructions",
        "bytes",
    ];
    let mut text = format!(
        "## The contact solve over one linear elastic solve

The linear solve is of the same body with a free floor: same data, assembly and factorisation. The contact solve ends with a correction from the
residual by the definitions and with the proof of how far its displacements are from the exact ones, at most the relative radius. The ratio is that of
contact with proof over linear; instructions are the same ratio, counted by valgrind without AVX-512 on bodies of up to {COUNTED} unknowns; bytes are
the peak memory for each unknown.

{}
",
        table(&head, &own.iter().map(row).collect::<Vec<_>>())
    );
    for degree in [1, 2] {
        let all: Vec<&Measured> = squares(own, degree).collect();
        let last = &all[all.len().saturating_sub(3)..];
        let fit = |y: &dyn Fn(&Measured) -> f64| {
            let points: Vec<(f64, f64)> = last.iter().map(|m| (m.unknowns as f64, y(m))).collect();
            exponent(&points)
        };
        text += &format!(
            "On the last squares of P{degree}: contact ~ N^{:.2}, linear ~ N^{:.2}, memory ~ N^{:.2} in N unknowns.\n",
            fit(&|m| m.contact.as_secs_f64()),
            fit(&|m| m.linear.as_secs_f64()),
            fit(&|m| m.memory),
        );
    }
    text
}

fn ratio(a: Duration, b: Duration) -> f64 {
    a.as_secs_f64() / b.as_secs_f64()
}

/// The exponent of y in x, by least squares on logarithms.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let (mx, my) = logs.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / count, m.1 + p.1 / count));
    let (above, below) = logs
        .iter()
        .fold((0.0, 0.0), |(a, b), (x, y)| (a + (x - mx) * (y - my), b + (x - mx) * (x - mx)));
    above / below
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// The times of `signorini solve` with reading and writing.
struct Command {
    read: Duration,
    times: Times,
    write: Duration,
}

impl Command {
    fn run(file: &Path, folder: &Path) -> Self {
        let start = Instant::now();
        let case = Case::read(file).expect("a valid case");
        let read = start.elapsed();
        let solved: Solved =
            solve::solve(&case.problem, &case.method, &case.settings).expect("a solution").into();
        let start = Instant::now();
        outputs::write(folder, &case, &solved, read, Default::default())
            .expect("a writable folder");
        Command { read, times: solved.times, write: start.elapsed() }
    }

    fn parts(&self) -> [(&'static str, Duration); 10] {
        let t = &self.times;
        [
            ("reading the case, making the mesh", self.read),
            ("nodes, constraints, loads, contact edges", t.discretize),
            ("order of elimination, matrix", t.matrix),
            ("factorisation, analysis included", t.factor),
            ("contact functionals: X, G", t.compliance),
            ("Newton's method", t.newton),
            ("residual in the full system", t.judge),
            ("enclosure of the exact solution", t.certify),
            ("stresses, pressure, resultants", t.evaluate),
            ("writing the files", self.write),
        ]
    }
}

/// (iv)
pub fn phases(n: usize, repetitions: usize) -> String {
    let folder = std::env::temp_dir().join(format!("signorini-speed-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a writable folder for temporary files");
    let columns = [1, 2].map(|degree| {
        let file = folder.join("block.toml");
        fs::write(&file, case_file(degree, n)).expect("a writable folder");
        let runs: Vec<Command> =
            (0..repetitions).map(|_| Command::run(&file, &folder.join("out"))).collect();
        let parts = runs[0].parts().map(|part| part.0);
        let least = |k: usize| runs.iter().map(|r| r.parts()[k].1).min().unwrap_or_default();
        std::array::from_fn::<_, 10, _>(|k| (parts[k], least(k)))
    });
    fs::remove_dir_all(&folder).expect("the folder made above");
    let totals = columns.each_ref().map(|c| c.iter().map(|part| part.1).sum::<Duration>());
    let rows: Vec<Vec<String>> = (0..10)
        .map(|k| {
            let mut row = vec![columns[0][k].0.to_owned()];
            for (column, total) in columns.iter().zip(totals) {
                row.extend([time(column[k].1), percent(ratio(column[k].1, total))]);
            }
            row
        })
        .collect();
    format!(
        "## Where the time goes

`signorini solve` at n = {n}, the least of {repetitions} runs for each phase.

{}",
        table(&["phase", "P1", "share", "P2", "share"], &rows)
    )
}

fn case_file(degree: usize, n: usize) -> String {
    format!(
        "[mesh]
rectangle = {{ width = 1, height = 1, nx = {n}, ny = {n} }}
[material]
lambda = 1
mu = 1
[load]
body = [\"0\", \"-4 + 10*x\"]
[boundary.top]
displacement = [\"0\", \"0\"]
[boundary.bottom]
contact = {{ gap = \"0\" }}
[method]
degree = {degree}
"
    )
}

/// Pairs of bodies, each with one body on a rigid obstacle of about as many unknowns.
const PAIRS: [[&str; 2]; 2] = [["cylinders", "disk"], ["pin_lug", "pin"]];

/// The whole command on two bodies beside one, as valgrind counts its instructions, and a sentence on `others`.
pub fn two_bodies(others: &str) -> String {
    let row = |[two, one]: [&str; 2]| {
        let [two, one] = [two, one].map(|name| (name, child::of_command(name)));
        let told = |name: &str, of: &Option<child::OfCommand>| match of {
            Some(of) => format!("`{name}`: {}, {}", of.unknowns, of.factorizations),
            None => format!("`{name}`: no valgrind"),
        };
        let share = match (&two.1, &one.1) {
            (Some(two), Some(one)) => format!("**{:.2}**", two.each() / one.each()),
            _ => String::new(),
        };
        vec![told(two.0, &two.1), told(one.0, &one.1), share]
    };
    format!(
        "## Two bodies

Instructions for each unknown of the whole command, with proof and files, beside one body on a rigid obstacle (of the cases: unknowns,
factorisations). A body that the other one alone holds is factored on a few springs of contact.

{}
{others}
",
        table(&["two bodies", "one", "ratio"], &PAIRS.map(row))
    )
}

/// What stands in place of [`large`].
pub const NOT_LARGE: &str = "## Large

A square of P2 with n = 1118, one run of `-- --huge` on 2026-11-28: 10,008,338 unknowns, 73 s and 4.4 s for the proof of 4e-12, 9
Newton steps, 18.4 GB.
";

/// One run each in a process of its own.
pub fn large(sizes: &[Size]) -> String {
    let rows: Vec<Vec<String>> = sizes
        .iter()
        .map(|&size| {
            let report = child::start(Task::Contact, size.degree, &size.body());
            let unknowns = size.unknowns() as f64;
            vec![
                format!("P{}", size.degree),
                size.n.to_string(),
                size.unknowns().to_string(),
                seconds(report.contact),
                seconds(report.proof),
                report.radius.map_or("none".to_owned(), |radius| format!("{radius:.0e}")),
                report.steps.to_string(),
                bytes(report.memory as f64),
                format!("{:.0}", report.memory as f64 / unknowns),
            ]
        })
        .collect();
    let head = [
        "",
        "n",
        "unknowns",
        "contact solve",
        "proof",
        "relative radius proved",
        "Newton steps",
        "peak memory",
        "bytes per unknown",
    ];
    format!("## Large\n\nSquares, one run each.\n\n{}", table(&head, &rows))
}
