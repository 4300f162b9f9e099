//! Progress on standard error, if that is a terminal: one line, drawn again and again.

use std::cell::Cell;
use std::io::{IsTerminal, Write, stderr};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use signorini::solve::Phase;

/// Shorter work is not worth a word.
const PATIENCE: Duration = Duration::from_secs(1);

/// Between two drawings.
const TICK: Duration = Duration::from_millis(100);

/// Frames of the spinner.
const SPINNER: [char; 10] = ['⠋', '⠙', '⠹', '⠸', '⠼', '⠴', '⠦', '⠧', '⠇', '⠏'];

/// To the start of the line, which is emptied.
const CLEAR: &str = "\r\x1b[2K";

/// The phase of work that has no known length. It is shown once the work takes longer than a second, and removed when this
/// is dropped.
pub struct Phases {
    phase: Arc<Mutex<String>>,
    watch: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Phases {
    /// Shown unless `quiet`.
    pub fn start(quiet: bool) -> Phases {
        let phase = Arc::new(Mutex::new(String::new()));
        let start = || {
            let (stop, stopped) = mpsc::channel();
            let shown = Arc::clone(&phase);
            let draw = move || {
                let (begin, colours) = (Instant::now(), colours());
                let mut wait = PATIENCE;
                let mut frames = SPINNER.iter().cycle();
                while stopped.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
                    let spinner = frames.next().unwrap_or(&' ');
                    let [before, after] = if colours { ["\x1b[36m", "\x1b[0m"] } else { ["", ""] };
                    let phase = shown.lock().unwrap_or_else(PoisonError::into_inner).clone();
                    let seconds = begin.elapsed().as_secs();
                    show(&format!("{CLEAR}  {before}{spinner}{after} {phase}, {seconds} s"));
                    wait = TICK;
                }
                if wait == TICK {
                    show(CLEAR);
                }
            };
            // Where there is no thread to be had, nothing is shown.
            Some((stop, thread::Builder::new().spawn(draw).ok()?))
        };
        let watch = if !quiet && is_shown() { start() } else { None };
        Phases { phase, watch }
    }

    /// The phase that begins, such as "certifying".
    pub fn enter(&self, phase: impl Into<String>) {
        *self.phase.lock().unwrap_or_else(PoisonError::into_inner) = phase.into();
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
        if let Some((stop, thread)) = self.watch.take() {
            drop(stop);
            // It cannot have panicked; if it did, there is nothing to show, which is what is wanted here.
            let _ = thread.join();
        }
    }
}

/// Progress in things, such as "meshes", of which there are `count`.
pub struct Count {
    phases: Phases,
    done: Cell<usize>,
    count: usize,
    things: &'static str,
}

impl Count {
    /// Shown unless `quiet`.
    pub fn start(count: usize, things: &'static str, quiet: bool) -> Count {
        let counted = Count { phases: Phases::start(quiet), done: Cell::new(0), count, things };
        counted.say();
        counted
    }

    /// One more is done.
    pub fn one_more(&self) {
        self.done.set(self.done.get() + 1);
        self.say();
    }

    fn say(&self) {
        self.phases.enter(format!("{} of {} {}", self.done.get(), self.count, self.things));
    }
}

/// A line that cannot be shown is no reason to stop.
fn show(line: &str) {
    let mut stderr = stderr().lock();
    let _ = stderr.write_all(line.as_bytes()).and_then(|()| stderr.flush());
}

fn is_shown() -> bool {
    stderr().is_terminal()
        && std::env::var_os("TERM").is_some_and(|term| !term.is_empty() && term != "dumb")
}

fn colours() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}
