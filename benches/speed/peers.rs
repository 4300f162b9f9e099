//! Other codes on the same problem: the scripts of reference/peers, interleaved with our own runs.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

use crate::child::{self, Task};
use crate::problem::{Posed, posed};
use crate::table::{bytes, seconds, table, three};

/// A code with one of its direct solvers.
struct Peer {
    name: &'static str,
    python: &'static str,
    script: &'static str,
    solver: &'static str,
}

const SYSTEM: &str = "/usr/bin/python3";
const OWN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/reference/peers/.venv/bin/python");
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/reference/peers");

const fn peer(
    name: &'static str,
    python: &'static str,
    script: &'static str,
    solver: &'static str,
) -> Peer {
    Peer { name, python, script, solver }
}

const PEERS: [Peer; 6] = [
    peer("DOLFINx, MUMPS", SYSTEM, "dolfinx_petsc.py", "mumps"),
    peer("DOLFINx, CHOLMOD", SYSTEM, "dolfinx_petsc.py", "cholmod"),
    peer("scikit-fem, CHOLMOD", OWN, "scikit_fem.py", "cholmod"),
    peer("scikit-fem, SuperLU", OWN, "scikit_fem.py", "superlu"),
    peer("NGSolve, sparsecholesky", OWN, "ngsolve_direct.py", "sparsecholesky"),
    peer("GetFEM, MUMPS", SYSTEM, "getfem_mumps.py", "mumps"),
];

/// The line that a script prints.
#[derive(Deserialize)]
struct Line {
    versions: BTreeMap<String, String>,
    seconds: Seconds,
    steps: usize,
    energy: f64,
    memory: f64,
    memory_before: f64,
}

#[derive(Deserialize)]
struct Seconds {
    assembly: f64,
    factor: f64,
    contact: f64,
}

/// Minima of one code at one size.
pub struct Rival {
    pub name: &'static str,
    versions: String,
    /// What the body is.
    body: String,
    pub unknowns: usize,
    assembly: f64,
    factor: f64,
    pub contact: f64,
    /// Ours alone: the proof that follows.
    proof: f64,
    steps: usize,
    energy: f64,
    memory: f64,
    /// What the process had before it met a problem of this size.
    memory_before: f64,
    runs: usize,
}

impl Rival {
    fn take(&mut self, other: Rival) {
        self.assembly = self.assembly.min(other.assembly);
        self.factor = self.factor.min(other.factor);
        self.contact = self.contact.min(other.contact);
        self.proof = self.proof.min(other.proof);
        self.memory = self.memory.min(other.memory);
        self.runs += 1;
    }

    fn linear(&self) -> f64 {
        self.assembly + self.factor
    }

    fn proved(&self) -> f64 {
        self.contact + self.proof
    }
}

const OURS: &str = "signorini";

/// Beyond this many seconds for a contact solve, two runs are enough.
const SLOW: f64 = 5.0;

/// All energies are the same up to this, relative.
const AGREEMENT: f64 = 1e-9;

/// Every code on every body of [`posed`], ours first.
pub fn measure(bodies: &[&str], repetitions: usize) -> Vec<Rival> {
    let folder = std::env::temp_dir().join(format!("signorini-peers-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a writable folder for temporary files");
    let write = |body: &str| {
        let file = folder.join(format!("{body}.json"));
        fs::write(&file, posed(body).json()).expect("a writable folder");
        file
    };
    let small = write("square-8");
    let on = |&body: &&str| on_body(body, [small.clone(), write(body)], repetitions);
    let rivals = bodies.iter().flat_map(on).collect();
    fs::remove_dir_all(&folder).expect("the folder made above");
    rivals
}

fn on_body(body: &str, files: [PathBuf; 2], repetitions: usize) -> Vec<Rival> {
    let about = posed(body);
    let (ours, gamma0) = run_ours(body, &about);
    let mut rivals = vec![ours];
    rivals.extend(PEERS.iter().map(|peer| run(peer, &about, &files, gamma0)));
    for _ in 1..repetitions {
        rivals[0].take(run_ours(body, &about).0);
        for (peer, rival) in PEERS.iter().zip(&mut rivals[1..]) {
            if rival.contact <= SLOW || rival.runs < 2 {
                rival.take(run(peer, &about, &files, gamma0));
            }
        }
    }
    for rival in &rivals[1..] {
        let difference = (rival.energy / rivals[0].energy - 1.0).abs();
        assert!(
            difference <= AGREEMENT,
            "{body}: {} finds a(u, u) = {}, {OURS} {}; expected the same to {AGREEMENT:e}",
            rival.name,
            rival.energy,
            rivals[0].energy
        );
    }
    eprintln!("other codes, {body}: measured");
    rivals
}

/// Our run, and its gamma0.
fn run_ours(body: &str, about: &Posed) -> (Rival, f64) {
    let report = child::start(Task::LikePeers, 1, body);
    let rival = Rival {
        name: OURS,
        versions: env!("CARGO_PKG_VERSION").to_owned(),
        body: about.title.clone(),
        unknowns: about.unknowns(),
        assembly: report.assembly,
        factor: report.factor,
        contact: report.contact,
        proof: report.proof,
        steps: report.steps,
        energy: report.energy,
        memory: report.memory as f64,
        memory_before: 0.0,
        runs: 1,
    };
    (rival, report.gamma0)
}

fn run(peer: &Peer, about: &Posed, files: &[PathBuf; 2], gamma0: f64) -> Rival {
    let output = Command::new(peer.python)
        .arg(Path::new(FOLDER).join(peer.script))
        .args(files)
        .args([gamma0.to_string(), peer.solver.to_owned()])
        .envs([("OMP_NUM_THREADS", "1"), ("OPENBLAS_NUM_THREADS", "1")])
        .output();
    let text = match output {
        Ok(output) if output.status.success() => output.stdout,
        Ok(output) => missing(peer, &String::from_utf8_lossy(&output.stderr)),
        Err(error) => missing(peer, &format!("{}: {error}", peer.python)),
    };
    let text = String::from_utf8_lossy(&text);
    let line = text.lines().rev().find(|line| line.starts_with('{')).unwrap_or_default();
    let line: Line = serde_json::from_str(line).unwrap_or_else(|e| missing(peer, &e.to_string()));
    let versions: Vec<String> = line.versions.iter().map(|(k, v)| format!("{k} {v}")).collect();
    Rival {
        name: peer.name,
        versions: versions.join(", "),
        body: about.title.clone(),
        unknowns: about.unknowns(),
        assembly: line.seconds.assembly,
        factor: line.seconds.factor,
        contact: line.seconds.contact,
        proof: 0.0,
        steps: line.steps,
        energy: line.energy,
        memory: line.memory,
        memory_before: line.memory_before,
        runs: 1,
    }
}

fn missing(peer: &Peer, why: &str) -> ! {
    eprintln!(
        "{} did not run ({} {}); reference/peers/setup.sh installs what it needs.\n{why}",
        peer.name, peer.python, peer.script
    );
    std::process::exit(1);
}

/// (ii)
pub fn tables(rivals: &[Rival]) -> String {
    let mut text = "## Other codes

The same mesh, method (P1, 4 Gauss points per contact edge), gamma0 and single thread; the scripts are in
`reference/peers/`. The others start from 0 and stop at a relative residual of 1e-10, with every part that is constant
assembled once and the analysis of the pattern kept where the code can keep it; ours starts from the linear solution, goes on to
the rounding level and proves its solution. Ratios are over ours with the proof. All energies a(u, u) agree to 1e-9. The memory
of the others is that of the whole process and, in brackets, what their process took before it met this problem. The fastest and
leanest of the others are the ones to compare with.
"
    .to_owned();
    for ours in rivals.iter().filter(|r| r.name == OURS) {
        let alike: Vec<&Rival> = rivals.iter().filter(|r| r.body == ours.body).collect();
        text += &format!(
            "\n### {}, {} unknowns\n\n{}",
            ours.body,
            ours.unknowns,
            table_of(ours, &alike)
        );
        let others = || alike.iter().filter(|r| r.name != OURS);
        let least =
            |of: &dyn Fn(&Rival) -> f64| others().map(|r| of(r)).fold(f64::INFINITY, f64::min);
        text += &format!(
            "\nFastest of the others over ours: contact solve **{:.1}** with our proof, {:.1} without; linear solve **{:.2}**, factor and solve alone {:.2}; leanest over ours in memory: {:.2}.\n",
            least(&|r| r.contact) / ours.proved(),
            least(&|r| r.contact) / ours.contact,
            least(&|r| r.linear()) / ours.linear(),
            least(&|r| r.factor) / ours.factor,
            least(&|r| r.memory) / ours.memory,
        );
    }
    text += "\nVersions:\n\n";
    let first = rivals.first().map_or("", |r| &r.body);
    for rival in rivals.iter().filter(|r| r.body == first) {
        text += &format!("- {}: {}\n", rival.name, rival.versions);
    }
    text
}

fn table_of(ours: &Rival, rivals: &[&Rival]) -> String {
    let over = |a: f64, b: f64| format!("{} ({})", seconds(a), three(a / b));
    let rows: Vec<Vec<String>> = rivals
        .iter()
        .map(|r| {
            let before = if r.name == OURS {
                String::new()
            } else {
                format!(" ({})", bytes(r.memory_before))
            };
            let name = if r.name == OURS { "signorini, with the proof" } else { r.name };
            vec![
                name.to_owned(),
                seconds(r.assembly),
                over(r.factor, ours.factor),
                over(r.linear(), ours.linear()),
                over(r.proved(), ours.proved()),
                three(r.proved() / r.linear()),
                r.steps.to_string(),
                format!("{}{before}", bytes(r.memory)),
                r.runs.to_string(),
            ]
        })
        .collect();
    let head = [
        "code",
        "assembly",
        "factor and solve (over ours)",
        "linear solve (over ours)",
        "contact solve (over ours)",
        "contact / linear",
        "Newton steps",
        "peak memory",
        "runs",
    ];
    table(&head, &rows)
}
