//! The command `signorini`: reads a case file, solves it, writes the files and says
//! what came out.
//!
//! Exit codes: 0 solved and proved; 1 no result: could not solve, could not write; 2 the case is wrong, and then nothing is
//! written; 3 results that are written, but not proved, or without something else that was asked for. Nobody
//! listening at standard output (`| head`) is no failure, a standard output that is full is one: 1. A signal ends the
//! program as a signal does: 130, 143 or 129 to a shell.

#[cfg(not(kani))]
fn main() -> std::process::ExitCode {
    signorini::command::run()
}

/// The model checker looks at the kernel only.
#[cfg(kani)]
fn main() {}
