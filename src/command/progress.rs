//! Progress on standard error, if that is a terminal: one line, drawn again and again.

use std::io::{IsTerminal, Write, stderr};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use signorini::solve::Phase;

/// Shorter work is not worth a word.
const PATIENCE: Duration = Duration::from_secs(1);

/// The time between two drawings.
const TICK: Duration = Duration::from_millis(100);

/// Frames of the spinner.
const SPINNER: [char; 10] = ['⠋', '⠙', '⠹', '⠸', '⠼', '⠴', '⠦', '⠧', '⠇', '⠏'];

/// To the start of the line, which is emptied.
const CLEAR: &str = "\r\x1b[2K";

/// The line: it is shown once the work takes longer than a second, and removed when this is dropped.
pub struct Phases(Option<(Sender<String>, JoinHandle<()>)>);

impl Phases {
    /// Shown unless `quiet`.
    pub fn start(quiet: bool) -> Phases {
        let term = std::env::var_os("TERM").unwrap_or_default();
        if quiet || !stderr().is_terminal() || term.is_empty() || term == "dumb" {
            return Phases(None);
        }
        let (phases, entered) = mpsc::channel();
        // Where there is no thread to be had, nothing is shown.
        let thread = thread::Builder::new().spawn(move || draw(&entered)).ok();
        Phases(thread.map(|thread| (phases, thread)))
    }

    /// The phase that begins, such as "certifying".
    pub fn enter(&self, phase: impl Into<String>) {
        if let Some((phases, _)) = &self.0 {
            // A thread that is gone shows nothing.
            let _ = phases.send(phase.into());
        }
    }

    /// A phase inside a solve.
    pub fn enter_solve(&self, phase: Phase) {
        self.enter(match phase {
            Phase::Assemble => "assembling loads, supports and the contact line".into(),
            Phase::Order => "ordering and assembling the matrix".into(),
            Phase::Factor => "factoring".into(),
            Phase::Condense => "condensing the body onto its contact line".into(),
            Phase::Newton { step } => format!("Newton step {step}"),
            Phase::Evaluate => "evaluating stresses and pressures".into(),
            _ => "solving".to_owned(),
        });
    }
}

impl Drop for Phases {
    fn drop(&mut self) {
        if let Some((phases, thread)) = self.0.take() {
            drop(phases);
            // It cannot have panicked; if it did, there is nothing to show, which is what is wanted here.
            let _ = thread.join();
        }
    }
}

/// Draws the phase that was entered last until no more can come.
fn draw(entered: &Receiver<String>) {
    let begin = Instant::now();
    let mut phase = String::new();
    let mut frames = SPINNER.iter().cycle();
    let (mut at, mut shown) = (begin + PATIENCE, false);
    loop {
        match entered.recv_timeout(at.saturating_duration_since(Instant::now())) {
            Ok(next) => phase = next,
            Err(RecvTimeoutError::Timeout) => {
                let spinner = frames.next().unwrap_or(&' ');
                show(&format!("{CLEAR}  {spinner} {phase}, {} s", begin.elapsed().as_secs()));
                (at, shown) = (Instant::now() + TICK, true);
            }
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    if shown {
        show(CLEAR);
    }
}

/// A line that cannot be shown is no reason to stop.
fn show(line: &str) {
    let mut stderr = stderr().lock();
    let _ = stderr.write_all(line.as_bytes()).and_then(|()| stderr.flush());
}
