//! One solve in a process of its own, for its peak memory.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use signorini::solve::ContactQuadrature;

use crate::problem;

/// The argument by which this program calls itself.
pub const FLAG: &str = "--measure";

/// What is run, and by which integrals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// The contact solve, contact integrals exact.
    Contact,
    /// A linear solve and a contact solve with 4 Gauss points, as the other codes do it.
    LikePeers,
    /// The mesh alone.
    Mesh,
    /// The mesh and a linear solve.
    Linear,
    /// The mesh and a contact solve with its proof, to displacements.
    Proved,
}

const TASKS: [Task; 5] = [Task::Contact, Task::LikePeers, Task::Mesh, Task::Linear, Task::Proved];

/// What the child found.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Report {
    /// Of the linear solve: all before the factorisation. 0 if there is none.
    pub assembly: f64,
    /// Of the linear solve: factorisation and substitution.
    pub factor: f64,
    /// Of the contact solve, to displacements.
    pub contact: f64,
    /// Of the proof.
    pub proof: f64,
    /// Newton's method.
    pub steps: usize,
    /// The relative radius that is proved.
    pub radius: Option<f64>,
    /// a(u, u)
    pub energy: f64,
    /// gamma0
    pub gamma0: f64,
    /// The peak resident memory in bytes.
    pub memory: u64,
}

/// Runs `task` with elements of this degree on a body of [`problem::posed`] in a new process.
pub fn start(task: Task, degree: usize, body: &str) -> Report {
    let program = std::env::current_exe().expect("the path of this program");
    let output = Command::new(program)
        .args([FLAG, name(task), &degree.to_string(), body])
        .output()
        .expect("this program runs");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{task:?} {body} P{degree}: {error}");
    serde_json::from_slice(&output.stdout).expect("a report")
}

fn name(task: Task) -> &'static str {
    match task {
        Task::Contact => "contact",
        Task::LikePeers => "like-peers",
        Task::Mesh => "mesh",
        Task::Linear => "linear",
        Task::Proved => "proved",
    }
}

/// Runs what [`start`] asks for and prints the report.
pub fn run(arguments: &[String]) {
    let [task, degree, body] = arguments else {
        panic!("a task, a degree and a body; found {arguments:?}")
    };
    let task = TASKS.into_iter().find(|&t| name(t) == task).expect("a known task");
    if let Some(report) = solve(task, degree.parse().expect("a number"), body) {
        println!("{}", serde_json::to_string(&report).expect("numbers"));
    }
}

fn solve(task: Task, degree: usize, body: &str) -> Option<Report> {
    let problem = problem::posed(body).problem;
    let exact = ContactQuadrature::Exact;
    let (quadrature, linear) = match task {
        Task::Mesh => return None,
        Task::Linear => {
            problem::linear(&problem, degree);
            return None;
        }
        Task::Proved => {
            problem::contact_alone(&problem, &problem::method(degree, exact));
            return None;
        }
        Task::Contact => (exact, None),
        Task::LikePeers => {
            // What happens once per process is over after this, as in the scripts for the other codes: both solves of a small body.
            let (small, gauss) = (problem::block(8), ContactQuadrature::Gauss(4));
            problem::linear(&small, degree);
            problem::contact(&small, &problem::method(degree, gauss));
            (gauss, Some(problem::linear(&problem, degree)))
        }
    };
    let start = Instant::now();
    let (solution, times) = problem::contact(&problem, &problem::method(degree, quadrature));
    let contact = start.elapsed() - times.evaluate - times.certify;
    Some(Report {
        assembly: linear.map_or(0.0, |t| t.assemble.as_secs_f64()),
        factor: linear.map_or(0.0, |t| t.solve.as_secs_f64()),
        contact: contact.as_secs_f64(),
        proof: times.certify.as_secs_f64(),
        steps: solution.newton.iterations(),
        radius: solution.enclosure.as_ref().ok().and_then(|e| e.relative),
        energy: solution.quantities.energy,
        gamma0: solution.gamma.gamma0,
        memory: peak_memory(),
    })
}

/// The instructions of a program with these arguments, as valgrind counts them; `None` without valgrind.
fn counted(program: &Path, arguments: &[&str]) -> Option<f64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(arguments)
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let count = text.lines().find_map(|line| line.split_once("Collected : "))?.1.trim();
    count.parse().ok()
}

/// A run of the command.
pub struct OfCommand {
    instructions: f64,
    pub unknowns: u64,
    pub factorizations: u64,
}

impl OfCommand {
    /// The instructions for each unknown.
    pub fn each(&self) -> f64 {
        self.instructions / self.unknowns as f64
    }
}

/// `signorini solve` of a case in `cases`; `None` without valgrind.
pub fn of_command(case: &str) -> Option<OfCommand> {
    let file = format!("{}/cases/{case}.toml", env!("CARGO_MANIFEST_DIR"));
    let folder = std::env::temp_dir().join(format!("signorini-{case}-{}", std::process::id()));
    let out = folder.to_str()?;
    let program = Path::new(env!("CARGO_BIN_EXE_signorini"));
    let instructions = counted(program, &["solve", &file, "--out", out])?;
    let result = fs::read_to_string(folder.join("result.json")).expect("the case has a result");
    let result: serde_json::Value = serde_json::from_str(&result).expect("JSON");
    fs::remove_dir_all(&folder).expect("the folder made above");
    let number = |key: &str| result.pointer(key).and_then(|n| n.as_u64()).expect("a number");
    let (unknowns, factorizations) = (number("/mesh/dofs"), number("/newton/factorizations"));
    Some(OfCommand { instructions, unknowns, factorizations })
}

/// The instructions of a linear solve, and of the contact solve with its proof; `None` without valgrind.
pub fn instructions(degree: usize, body: &str) -> Option<[f64; 2]> {
    let of = |task| {
        let program = std::env::current_exe().ok()?;
        counted(&program, &[FLAG, name(task), &degree.to_string(), body])
    };
    let mesh = of(Task::Mesh)?;
    Some([of(Task::Linear)? - mesh, of(Task::Proved)? - mesh])
}

/// VmHWM, in bytes.
fn peak_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find(|line| line.starts_with("VmHWM")).expect("VmHWM");
    let kilobytes = line.split_whitespace().nth(1).and_then(|word| word.parse::<u64>().ok());
    1024 * kilobytes.expect("a number")
}
