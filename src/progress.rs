//! What goes on, on standard error if that is a terminal, else nothing.

use std::borrow::Cow;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use signorini::solve::Phase;

/// Shorter work is not worth a word.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar of `count` things, such as "meshes".
pub fn bar(count: usize, things: &str, quiet: bool) -> ProgressBar {
    let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(count as u64) };
    let bar_of = if colour() { "{bar:30.cyan}" } else { "{bar:30}" };
    styled(bar, &format!("  {bar_of} {{pos}} of {{len}} {things}, {{elapsed}}"))
}

fn styled(bar: ProgressBar, template: &str) -> ProgressBar {
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

fn colour() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// The phase of work that has no known length. It is shown once the work takes longer than a second, and removed when this
/// is dropped.
pub struct Phases {
    bar: ProgressBar,
    watch: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Phases {
    /// Shown unless `quiet`.
    pub fn start(quiet: bool) -> Phases {
        let spinner = if colour() { "{spinner:.cyan}" } else { "{spinner}" };
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let bar = styled(bar, &format!("  {spinner} {{msg}}, {{elapsed}}"));
        let watch = (!quiet).then(|| {
            let (stop, stopped) = mpsc::channel();
            let shown = bar.clone();
            let show = move || {
                if stopped.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                    shown.set_draw_target(ProgressDrawTarget::stderr());
                    shown.enable_steady_tick(Duration::from_millis(100));
                }
            };
            (stop, thread::spawn(show))
        });
        Phases { bar, watch }
    }

    /// The phase that begins, such as "certifying".
    pub fn enter(&self, phase: impl Into<Cow<'static, str>>) {
        self.bar.set_message(phase);
    }

    /// A phase inside a solve.
    pub fn enter_solve(&self, phase: Phase) {
        self.enter(match phase {
            Phase::Assemble => "assembling loads, supports and the contact line".into(),
            Phase::Order => "ordering and assembling the matrix".into(),
            Phase::Factor => "factoring".into(),
            Phase::Condense => "condensing the body onto its contact line".into(),
            Phase::Newton { step } => Cow::from(format!("Newton step {step}")),
            Phase::Evaluate => "evaluating stresses and pressures".into(),
            _ => "solving".into(),
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
        self.bar.finish_and_clear();
    }
}
