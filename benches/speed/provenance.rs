//! On what and by what the numbers were made.

use std::fs;
use std::process::Command;

/// The head of docs/speed.md.
pub fn head(arguments: &[String]) -> String {
    let tail =
        if arguments.is_empty() { String::new() } else { format!(" -- {}", arguments.join(" ")) };
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    format!(
        "# Speed

Written by `cargo bench --bench speed{tail}` on {date}, at commit {commit}.

- Machine: {cpu}, {cores} cores, load average at the start {load}. One thread in every code.
- signorini {version}, faer {faer}, {rustc}.
- The case: the unit square in n x n cells cut by diagonals from the lower left to the upper right, lambda = mu = 1
  (plane strain), body force (0, -4 + 10 x), the top clamped, contact below, gamma0 at half the coercivity limit.
- Times are minima of runs that take turns. Ratios within this page are its claims; the times belong to this machine.
- Memory is the peak resident memory of a process that does nothing else.
- Clocks start with the mesh in memory and stop at the displacements (of the contact solve: with their residual in
  the full system). The proof of how far these are from the exact solution is a phase of its own.

![Time and memory against unknowns](speed.svg)
",
        date = output("date", &["-u", "+%F"]),
        commit = output("git", &["describe", "--always", "--dirty"]),
        cpu = cpu(),
        load = read("/proc/loadavg").split_whitespace().next().unwrap_or("unknown"),
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
