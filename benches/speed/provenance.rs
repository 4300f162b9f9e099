//! On what and by what the numbers were made.

use std::fs;
use std::process::Command;
use std::time::Instant;

/// What other processes do meanwhile: processor time of the machine, and that of this process and its children, in ticks.
pub struct Others {
    start: [f64; 2],
    since: Instant,
}

impl Others {
    pub fn start() -> Self {
        Others { start: ticks(), since: Instant::now() }
    }

    /// The processor time of other processes since the start, in parts of one core.
    pub fn share(&self) -> f64 {
        let [all, own] = ticks();
        // Linux counts hundredths of a second for programs.
        let other = ((all - self.start[0]) - (own - self.start[1])) / 100.0;
        other.max(0.0) / self.since.elapsed().as_secs_f64()
    }
}

fn ticks() -> [f64; 2] {
    let number = |word: &str| word.parse::<f64>().unwrap_or(0.0);
    // user, nice, system; idle and waiting for disks; interrupts.
    let all: Vec<f64> = read("/proc/stat").split_whitespace().skip(1).take(7).map(number).collect();
    let all = all.iter().sum::<f64>() - all.iter().skip(3).take(2).sum::<f64>();
    // Behind the name in brackets; the 14th to 17th word of the line.
    let own = read("/proc/self/stat");
    let own = own.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(4);
    [all, own.map(number).sum()]
}

/// Up to this share of one core the machine is called idle: the system itself takes some of it.
const IDLE: f64 = 0.05;

/// The head of docs/speed.md; `others` is the share of [`Others`].
pub fn head(arguments: &[String], others: f64) -> String {
    let tail =
        if arguments.is_empty() { String::new() } else { format!(" -- {}", arguments.join(" ")) };
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    format!(
        "# Speed

Written by `cargo bench --bench speed{tail}` on {date}, at commit {commit}.

- {cpu}, {cores} cores, one thread in every code; other processes took {others:.1} % of one core: the machine was {idle}.
- signorini {version}, faer {faer}, {rustc}.
- Square n: the unit square in n x n cells cut by diagonals, lambda = mu = 1 (plane strain), body force (0, -4 + 10 x), the top clamped, contact
  below, gamma0 at half the coercivity limit. Graded: square 96, crossed, with the heights y^3. Strip: 500 : 1, 1000 x 2 crossed cells, force -4 + x/50.
  Beam: 20 : 1, 320 x 16 crossed cells, clamped at the left, a floor 0.01 below. Disk: the half disk of `cases/disk.toml`.
- Times are minima of runs that take turns, from the mesh in memory to displacements (of a contact solve: with their residual in the full system); memory
  is the peak of a process that does nothing else.

![Time and memory against unknowns](speed.svg)
",
        date = output("date", &["-u", "+%F"]),
        commit = output("git", &["describe", "--always", "--dirty"]),
        cpu = cpu(),
        others = 100.0 * others,
        idle = if others <= IDLE { "idle" } else { "not idle" },
        version = env!("CARGO_PKG_VERSION"),
        faer = locked("faer"),
        rustc = output("rustc", &["--version"]),
    )
}

fn output(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).output();
    output.map_or("unknown".to_owned(), |o| String::from_utf8_lossy(&o.stdout).trim().to_owned())
}

fn read(file: &str) -> String {
    fs::read_to_string(file).unwrap_or_default()
}

fn cpu() -> String {
    let info = read("/proc/cpuinfo");
    let model = info.lines().find(|line| line.starts_with("model name"));
    let model = model.and_then(|line| line.split_once(": "));
    model.map_or("unknown", |(_, name)| name).to_owned()
}

/// The version of a dependency in Cargo.lock.
fn locked(name: &str) -> String {
    let lock = read(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.lock"));
    let start = format!("name = \"{name}\"\nversion = \"");
    let version = lock.split_once(&start).and_then(|(_, rest)| rest.split('"').next());
    version.unwrap_or("unknown").to_owned()
}
