//! Our own times: the contact solve over one linear solve, growth, Newton's method, phases.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use signorini::io::run::Solved;
use signorini::io::{Case, outputs};
use signorini::solve::{self, ContactQuadrature, Times};

use crate::child::{self, Task};
use crate::problem::{self, LinearTimes, Size};
use crate::table::{bytes, seconds, table, three, time};

/// Minima at one size.
pub struct Measured {
    pub size: Size,
    /// One linear elastic solve.
    pub linear: LinearTimes,
    /// The same, judged as the contact solve is.
    pub judged: Duration,
    /// The contact solve, to judged displacements.
    pub contact: Duration,
    /// The proof of it.
    pub proof: Duration,
    /// Of the contact solve: Newton's method.
    pub newton: Duration,
    pub steps: usize,
    /// The peak memory of a contact solve in bytes.
    pub memory: f64,
}

impl Measured {
    pub fn linear_total(&self) -> Duration {
        self.linear.assemble + self.linear.solve
    }
}

/// Small sizes are run more often: up to so many times,
const MANY: usize = 50;

/// within this time.
const BRIEF: Duration = Duration::from_millis(500);

/// Linear and contact solves in turn, at least `repetitions` of each.
pub fn measure(size: Size, repetitions: usize) -> Measured {
    let problem = problem::block(size.n);
    let method = problem::method(size.degree, ContactQuadrature::Exact);
    let mut linear: Option<LinearTimes> = None;
    let [mut contact, mut proof, mut newton, mut judged] = [Duration::MAX; 4];
    let mut steps = 0;
    let (start, mut runs) = (Instant::now(), 0);
    while runs < repetitions || (runs < MANY && start.elapsed() < BRIEF) {
        runs += 1;
        let run = problem::linear(&problem, size.degree);
        if linear.is_none_or(|best| run.assemble + run.solve < best.assemble + best.solve) {
            linear = Some(run);
        }
        judged = judged.min(problem::linear_judged(&problem, size.degree));
        let (solution, times) = problem::contact(&problem, &method);
        contact = contact.min(times.assemble() + times.solve());
        proof = proof.min(times.certify);
        newton = newton.min(times.newton);
        steps = solution.newton.iterations();
    }
    let linear = linear.expect("at least one repetition");
    let memory = child::start(Task::Contact, size.degree, &size.body()).memory as f64;
    eprintln!("P{} n = {}: measured", size.degree, size.n);
    Measured { size, linear, judged, contact, proof, newton, steps, memory }
}

fn ratio(a: Duration, b: Duration) -> f64 {
    a.as_secs_f64() / b.as_secs_f64()
}

fn name(size: Size) -> [String; 3] {
    [format!("P{}", size.degree), size.n.to_string(), size.unknowns().to_string()]
}

/// (i)
pub fn ratio_table(own: &[Measured]) -> String {
    let rows: Vec<Vec<String>> = own
        .iter()
        .map(|m| {
            let mut row = name(m.size).to_vec();
            row.extend([
                time(m.linear.assemble),
                time(m.linear.solve),
                time(m.judged),
                time(m.contact),
                time(m.proof),
                m.steps.to_string(),
                bold(m.contact, m.linear_total()),
                bold(m.contact + m.proof, m.linear_total()),
                bold(m.contact, m.judged),
            ]);
            row
        })
        .collect();
    let head = [
        "",
        "n",
        "unknowns",
        "assembly",
        "factor and solve",
        "the same, judged",
        "contact solve",
        "proof",
        "Newton steps",
        "contact / linear",
        "contact with proof / linear",
        "contact / linear judged",
    ];
    format!(
        "## The contact solve over one linear elastic solve

The linear solve is of the same body with a free floor: same mesh, data, assembly and factorisation, ordered by the same
nested dissection without a contact layer.

The contact solve ends with a correction from the residual by the definitions: its size is the forward error that is reported.
It costs two substitutions and a residual, and another residual says how good it is. A linear solve that is judged in the same
way, by the same functions, stands beside the bare one: the last ratio is what contact alone costs. `signorini solve` always
proves its solution, too (\"The proof\" below): the ratio before the last is the whole of it.

{}",
        table(&head, &rows)
    )
}

fn bold(a: Duration, b: Duration) -> String {
    format!("**{:.2}**", ratio(a, b))
}

/// The bodies of [`bodies`], as [`problem::posed`] knows them.
const BODIES: [(&str, &[usize]); 7] = [
    ("square-64", &[1, 2]),
    ("square-128", &[1, 2]),
    ("square-256", &[1]),
    ("strip", &[1, 2]),
    ("beam", &[1, 2]),
    ("graded", &[1, 2]),
    ("disk", &[1, 2]),
];

/// The contact solve with its proof over one linear solve, on squares up to `most` cells along a side and on other bodies.
pub fn bodies(most: usize, repetitions: usize) -> String {
    let small = |name: &str| {
        let n = name.split_once('-').map_or("", |parts| parts.1);
        n.parse().is_ok_and(|n: usize| n <= most) || n.is_empty()
    };
    let all = BODIES.iter().filter(|(name, _)| small(name));
    let all = all.flat_map(|&(name, degrees)| degrees.iter().map(move |&degree| (name, degree)));
    let rows: Vec<Vec<String>> =
        all.map(|(name, degree)| on_body(name, degree, repetitions)).collect();
    let head = [
        "body",
        "",
        "unknowns",
        "route",
        "Newton steps",
        "factorisations",
        "linear solve",
        "contact solve",
        "proof",
        "proved: relative radius",
        "contact with proof / linear",
        "10^6 instructions of both",
        "their ratio",
    ];
    format!(
        "## Bodies

A strip has many contact edges for its size, a beam bends; a graded square; the half disk of `cases/disk.toml`. The assembled route
factors a matrix for each set of contact edges that Newton's method meets. Instructions are counted by valgrind, on a processor that it has (without
AVX-512).
`cargo bench --bench speed -- --bodies` prints this table alone.

{}",
        table(&head, &rows)
    )
}

fn on_body(name: &str, degree: usize, repetitions: usize) -> Vec<String> {
    let problem::Posed { title, problem, .. } = problem::posed(name);
    let method = problem::method(degree, ContactQuadrature::Exact);
    let [mut linear, mut contact, mut proof, mut both] = [Duration::MAX; 4];
    let mut told = [const { String::new() }; 5];
    let (start, mut runs) = (Instant::now(), 0);
    while runs < repetitions || (runs < MANY && start.elapsed() < BRIEF) {
        runs += 1;
        let run = problem::linear(&problem, degree);
        linear = linear.min(run.assemble + run.solve);
        let (solution, times) = problem::contact(&problem, &method);
        let solve = times.assemble() + times.solve();
        contact = contact.min(solve);
        proof = proof.min(times.certify);
        both = both.min(solve + times.certify);
        let radius = solution.enclosure.as_ref().ok().and_then(|e| e.relative);
        told = [
            (2 * solution.displacement.len()).to_string(),
            format!("{:?}", solution.method.route).to_lowercase(),
            solution.newton.iterations().to_string(),
            solution.newton.factorizations.to_string(),
            radius.map_or("none".to_owned(), |radius| format!("{radius:.0e}")),
        ];
    }
    let [unknowns, route, steps, factorizations, radius] = told;
    let (counts, share) = match child::instructions(degree, name) {
        Some([linear, both]) => {
            let counts = format!("{} and {}", three(linear / 1e6), three(both / 1e6));
            (counts, format!("**{:.2}**", both / linear))
        }
        None => ("no valgrind".to_owned(), String::new()),
    };
    eprintln!("{name} P{degree}: measured");
    let mut row = vec![title, format!("P{degree}"), unknowns, route, steps, factorizations];
    row.extend([time(linear), time(contact), time(proof), radius, bold(both, linear)]);
    row.extend([counts, share]);
    row
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

/// (iii)
pub fn growth_table(own: &[Measured]) -> String {
    let rows: Vec<Vec<String>> = own
        .iter()
        .map(|m| {
            let unknowns = m.size.unknowns() as f64;
            let mut row = name(m.size).to_vec();
            row.extend([
                three(unknowns / m.contact.as_secs_f64() / 1e3),
                bytes(m.memory),
                format!("{:.0}", m.memory / unknowns),
            ]);
            row
        })
        .collect();
    let head =
        ["", "n", "unknowns", "thousand unknowns per second", "peak memory", "bytes per unknown"];
    let mut text = format!("## Growth\n\n{}\n", table(&head, &rows));
    for degree in [1, 2] {
        let last: Vec<&Measured> = own.iter().filter(|m| m.size.degree == degree).collect();
        let last = &last[last.len().saturating_sub(3)..];
        let fit = |y: &dyn Fn(&Measured) -> f64| {
            let points: Vec<(f64, f64)> =
                last.iter().map(|m| (m.size.unknowns() as f64, y(m))).collect();
            exponent(&points)
        };
        text += &format!(
            "P{degree}, n = {} to {}: contact solve ~ N^{:.2}, linear solve ~ N^{:.2}, memory ~ N^{:.2} in N unknowns.\n",
            last[0].size.n,
            last[last.len() - 1].size.n,
            fit(&|m| m.contact.as_secs_f64()),
            fit(&|m| m.linear_total().as_secs_f64()),
            fit(&|m| m.memory),
        );
    }
    text
}

/// Newton's method against n.
pub fn newton_table(own: &[Measured]) -> String {
    let rows: Vec<Vec<String>> = own
        .iter()
        .map(|m| {
            let mut row = name(m.size).to_vec();
            let share = ratio(m.newton, m.contact);
            let step = m.newton / u32::try_from(m.steps.max(1)).unwrap_or(u32::MAX);
            row.extend([m.steps.to_string(), time(step), percent(share)]);
            row
        })
        .collect();
    let head = ["", "n", "unknowns", "steps", "one step", "all steps, of the contact solve"];
    format!(
        "## Newton's method

All passes of the route, with the residuals and substitutions of the corrections between them; contact integrals exact.

{}",
        table(&head, &rows)
    )
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

/// What stands in place of [`large`].
pub const NOT_LARGE: &str = "## Large\n\nNot measured in this run: `--large` does.\n";

/// One run each in a process of its own.
pub fn large(sizes: &[Size]) -> String {
    let rows: Vec<Vec<String>> = sizes
        .iter()
        .map(|&size| {
            let report = child::start(Task::Contact, size.degree, &size.body());
            let unknowns = size.unknowns() as f64;
            let mut row = name(size).to_vec();
            row.extend([
                seconds(report.contact),
                seconds(report.proof),
                report.steps.to_string(),
                format!("{:.0e}", report.residual),
                bytes(report.memory as f64),
                format!("{:.0}", report.memory as f64 / unknowns),
            ]);
            row
        })
        .collect();
    let head = [
        "",
        "n",
        "unknowns",
        "contact solve",
        "proof",
        "Newton steps",
        "residual",
        "peak memory",
        "bytes per unknown",
    ];
    format!("## Large\n\nOne run each.\n\n{}", table(&head, &rows))
}
