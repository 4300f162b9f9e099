//! Progress on standard error, if that is a terminal: one line, drawn again and again.

use std::fmt::Display;
use std::io::{IsTerminal, Write, stderr};
use std::time::Instant;

use crate::solve::Phase;

/// To the start of the line, which is emptied.
const CLEAR: &str = "\r\x1b[2K";

/// The line, with the time since the start of the work; dropping the value removes the line. `None` if nothing is shown.
pub(crate) struct Phases(Option<Instant>);

impl Phases {
    /// Shown unless `quiet`, from this phase on.
    pub(crate) fn start(quiet: bool, phase: impl Display) -> Phases {
        let term = std::env::var_os("TERM").unwrap_or_default();
        let is_shown = !quiet && stderr().is_terminal() && !term.is_empty() && term != "dumb";
        let phases = Phases(is_shown.then(Instant::now));
        phases.enter(phase);
        phases
    }

    /// The phase that begins, such as "certifying".
    pub(crate) fn enter(&self, phase: impl Display) {
        if let Some(start) = self.0 {
            show(&format!("{CLEAR}  {} s: {phase} ...", start.elapsed().as_secs()));
        }
    }

    /// A phase inside a solve.
    pub(crate) fn enter_solve(&self, phase: Phase) {
        self.enter(match phase {
            Phase::Assemble => "assembling loads, supports and the contact line".to_owned(),
            Phase::Order => "ordering and assembling the matrix".to_owned(),
            Phase::Factor => "factoring".to_owned(),
            Phase::Condense => "condensing the body onto its contact line".to_owned(),
            Phase::Newton { step } => format!("Newton step {step}"),
            Phase::Evaluate => "evaluating stresses and pressures".to_owned(),
        });
    }
}

impl Drop for Phases {
    fn drop(&mut self) {
        if self.0.is_some() {
            show(CLEAR);
        }
    }
}

/// A line that cannot be shown is no reason to stop.
fn show(line: &str) {
    let mut stderr = stderr().lock();
    let _ = stderr.write_all(line.as_bytes()).and_then(|()| stderr.flush());
}
