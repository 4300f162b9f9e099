//! Other codes on the same problem: the scripts of reference/peers, in turns with our own runs.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

use crate::child::{self, Task};
use crate::problem::{Posed, posed};
use crate::table::{seconds, table, three};

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

const PEERS: [Peer; 5] = [
    peer("DOLFINx MUMPS", SYSTEM, "dolfinx_petsc.py", "mumps"),
    peer("DOLFINx CHOLMOD", SYSTEM, "dolfinx_petsc.py", "cholmod"),
    peer("scikit-fem", OWN, "scikit_fem.py", "cholmod"),
    peer("NGSolve", OWN, "ngsolve_direct.py", "sparsecholesky"),
    peer("GetFEM", SYSTEM, "getfem_mumps.py", "mumps"),
];

/// The line that a script prints.
#[derive(Deserialize)]
struct Line {
    versions: BTreeMap<String, String>,
    seconds: Seconds,
    steps: usize,
    energy: f64,
    memory: f64,
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
    /// Of its elements.
    pub degree: usize,
    assembly: f64,
    factor: f64,
    pub contact: f64,
    /// Ours alone: the proof that follows.
    proof: f64,
    steps: usize,
    energy: f64,
    memory: f64,
}

impl Rival {
    fn take(&mut self, other: Rival) {
        self.assembly = self.assembly.min(other.assembly);
        self.factor = self.factor.min(other.factor);
        self.contact = self.contact.min(other.contact);
        self.proof = self.proof.min(other.proof);
        self.memory = self.memory.min(other.memory);
    }

    fn linear(&self) -> f64 {
        self.assembly + self.factor
    }

    fn proved(&self) -> f64 {
        self.contact + self.proof
    }
}

const OURS: &str = "signorini";

/// Beyond this many seconds for a contact solve, one run is enough.
const SLOW: f64 = 3.0;

/// Up to this many seconds there are [`MORE`] times as many runs: a brief solve is easily disturbed.
const BRIEF: f64 = 0.12;

const MORE: usize = 4;

/// All energies are the same up to this, relative: on the graded square the others get no nearer than 1e-9.
const AGREEMENT: f64 = 1e-8;

/// The codes whose script has P2, too: the first ones.
const QUADRATIC: usize = 2;

/// On a body of [`posed`] our run, and that of each code or why it has none.
pub struct OnBody {
    ours: Rival,
    others: Vec<Result<Rival, String>>,
}

impl OnBody {
    /// The runs that there are, ours first.
    pub fn runs(&self) -> impl Iterator<Item = &Rival> {
        std::iter::once(&self.ours).chain(self.others.iter().flatten())
    }
}

/// Every code on bodies of [`posed`] with elements of a degree.
pub fn measure(bodies: &[(&str, usize)], repetitions: usize) -> Vec<OnBody> {
    let folder = std::env::temp_dir().join(format!("signorini-peers-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a writable folder for temporary files");
    let write = |body: &str, degree: usize| {
        let file = folder.join(format!("{body}-{degree}.json"));
        fs::write(&file, posed(body).json(degree)).expect("a writable folder");
        file
    };
    let on = |&(body, degree): &(&str, usize)| {
        on_body(body, degree, [write("square-8", degree), write(body, degree)], repetitions)
    };
    let all = bodies.iter().map(on).collect();
    fs::remove_dir_all(&folder).expect("the folder made above");
    all
}

fn on_body(body: &str, degree: usize, files: [PathBuf; 2], repetitions: usize) -> OnBody {
    let about = posed(body);
    let (mut ours, gamma0) = run_ours(body, degree, &about);
    let peers = if degree == 1 { &PEERS[..] } else { &PEERS[..QUADRATIC] };
    let energy = ours.energy;
    let again = |peer| {
        let run = run(peer, degree, &about, &files, gamma0)?;
        let difference = (run.energy / energy - 1.0).abs();
        // A NaN is no agreement.
        if !(difference <= AGREEMENT) {
            let theirs = run.energy;
            return Err(format!("a(u, u) = {theirs}, and {energy} by {OURS}"));
        }
        Ok(run)
    };
    let mut others: Vec<Result<Rival, String>> = peers.iter().map(again).collect();
    let turns = |contact: f64| match (contact <= BRIEF, contact <= SLOW) {
        (true, _) => MORE * repetitions,
        (_, true) => repetitions,
        _ => 1,
    };
    for turn in 1..turns(ours.proved()) {
        for (peer, rival) in peers.iter().zip(&mut others) {
            if let Ok(rival) = rival
                && turn < turns(rival.contact)
                && let Ok(run) = again(peer)
            {
                rival.take(run);
            }
        }
        ours.take(run_ours(body, degree, &about).0);
    }
    for (peer, rival) in peers.iter().zip(&others) {
        if let Err(why) = rival {
            eprintln!("{}, {body} P{degree}: {why}", peer.name);
        }
    }
    eprintln!("other codes, {body} P{degree}: measured");
    OnBody { ours, others }
}

/// Our run, and its gamma0.
fn run_ours(body: &str, degree: usize, about: &Posed) -> (Rival, f64) {
    let report = child::start(Task::LikePeers, degree, body);
    let rival = Rival {
        name: OURS,
        versions: env!("CARGO_PKG_VERSION").to_owned(),
        body: about.title.clone(),
        unknowns: about.unknowns(degree),
        degree,
        assembly: report.assembly,
        factor: report.factor,
        contact: report.contact,
        proof: report.proof,
        steps: report.steps,
        energy: report.energy,
        memory: report.memory as f64,
    };
    (rival, report.gamma0)
}

fn run(
    peer: &Peer,
    degree: usize,
    about: &Posed,
    files: &[PathBuf; 2],
    gamma0: f64,
) -> Result<Rival, String> {
    let output = Command::new(peer.python)
        .arg(Path::new(FOLDER).join(peer.script))
        .args(files)
        .args([gamma0.to_string(), peer.solver.to_owned()])
        .envs([("OMP_NUM_THREADS", "1"), ("OPENBLAS_NUM_THREADS", "1")])
        .output()
        .map_err(|error| format!("{}: {error}", peer.python))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let last = text.trim().lines().last().unwrap_or("it failed without a word");
        return Err(format!("{last} (reference/peers/setup.sh installs what it needs)"));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let line = text.lines().rev().find(|line| line.starts_with('{')).unwrap_or_default();
    let line: Line = serde_json::from_str(line).map_err(|error| error.to_string())?;
    let versions: Vec<String> = line.versions.iter().map(|(k, v)| format!("{k} {v}")).collect();
    Ok(Rival {
        name: peer.name,
        versions: versions.join(", "),
        body: about.title.clone(),
        unknowns: about.unknowns(degree),
        degree,
        assembly: line.seconds.assembly,
        factor: line.seconds.factor,
        contact: line.seconds.contact,
        proof: 0.0,
        steps: line.steps,
        energy: line.energy,
        memory: line.memory,
    })
}

/// (ii)
pub fn tables(all: &[OnBody]) -> String {
    let mut head = vec!["body", "", "ours"];
    head.extend(PEERS.iter().map(|peer| peer.name));
    head.extend(["contact", "unproved", "linear", "memory"]);
    let row = |on: &OnBody| {
        let ours = &on.ours;
        let mut row = vec![
            ours.body.clone(),
            format!("P{}", ours.degree),
            format!("{} ({})", seconds(ours.proved()), ours.steps),
        ];
        let cell = |k: usize| match on.others.get(k) {
            None => String::new(),
            Some(Err(_)) => "no result".to_owned(),
            Some(Ok(r)) => format!("{} ({})", seconds(r.contact), r.steps),
        };
        row.extend((0..PEERS.len()).map(cell));
        let least = |of: &dyn Fn(&Rival) -> f64| {
            on.others.iter().flatten().map(of).fold(f64::INFINITY, f64::min)
        };
        let over = |a: f64, b: f64| {
            if a.is_finite() { three(a / b) } else { "no result".to_owned() }
        };
        row.extend([
            format!("**{}**", over(least(&|r| r.contact), ours.proved())),
            over(least(&|r| r.contact), ours.contact),
            over(least(&Rival::linear), ours.linear()),
            over(least(&|r| r.memory), ours.memory),
        ]);
        row
    };
    let rows: Vec<Vec<String>> = all.iter().map(row).collect();
    let mut text = format!(
        "## Other codes

The same mesh, method (4 Gauss points per contact edge), gamma0 and single thread; the scripts are in `reference/peers/`. Their clocks start with the
space and the compiled forms ready, ours with the mesh. The others start from 0 and stop at a relative residual of 1e-7; what is constant is assembled
once, and the analysis of the pattern kept where the code can. Ours goes on to the rounding level. Times of the contact solve, ours with its proof, and
Newton steps in brackets; the last columns are the least of the others over ours. Energies a(u, u) agree to 1e-8.

{}
Versions: ",
        table(&head, &rows)
    );
    // Codes share some of their parts.
    let versions: BTreeSet<&str> =
        all.iter().flat_map(OnBody::runs).flat_map(|rival| rival.versions.split(", ")).collect();
    text += &versions.into_iter().collect::<Vec<_>>().join(", ");
    text + ".\n"
}

/// The seconds of two blocks on meshes that do not match, as `reference/getfem_pair.py --time` prints them.
#[derive(Deserialize)]
struct Blocks {
    unknowns: usize,
    getfem: f64,
    signorini: f64,
}

/// GetFEM beside this program on two bodies.
pub fn two_bodies() -> String {
    let output = Command::new("/usr/bin/python3")
        .args(["reference/getfem_pair.py", "--time", env!("CARGO_BIN_EXE_signorini")])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .envs([("OMP_NUM_THREADS", "1"), ("OPENBLAS_NUM_THREADS", "1")])
        .output();
    let of = output.ok().and_then(|output| serde_json::from_slice::<Blocks>(&output.stdout).ok());
    match of {
        Some(Blocks { unknowns, getfem, signorini }) => format!(
            "Two blocks whose meshes do not match, P2, {unknowns} unknowns (`reference/getfem_pair.py --time`): GetFEM's brick with multipliers\ntakes {:.1} times as long as this program with its proof.",
            getfem / signorini
        ),
        None => "GetFEM beside it: it or Gmsh is not there.".to_owned(),
    }
}
