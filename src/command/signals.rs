//! SIGINT, SIGTERM and SIGHUP: what is half written is removed and the engine's processes are told, then the signal does
//! what it does to every program. A signal that this process was started to ignore (`nohup`) stays ignored.

#[cfg(unix)]
pub use unix::{give_way, run, watch};

#[cfg(not(unix))]
pub use elsewhere::{give_way, run, watch};

#[cfg(unix)]
mod unix {
    use std::io;
    use std::os::unix::process::CommandExt;
    use std::process::{Command, Output};
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
    use std::thread;
    use std::time::{Duration, Instant};

    use rustix::process::{Pid, Signal, kill_process_group};
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::flag;
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;
    use signorini::io::files;

    /// The leader of the process group that works for this program.
    static WORKER: Mutex<Option<Pid>> = Mutex::new(None);

    /// A signal has come, and ends this program.
    static ENDING: AtomicBool = AtomicBool::new(false);

    /// Waits for the end where a signal ends this program: nothing that fails because of it is worth a word.
    pub fn give_way() {
        while ENDING.load(Ordering::SeqCst) {
            thread::park();
        }
    }

    fn worker() -> MutexGuard<'static, Option<Pid>> {
        WORKER.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The time that the processes of the engine have to end.
    const PATIENCE: Duration = Duration::from_secs(5);

    /// Watches for signals from now on. Where that is not possible, they do what they do without.
    pub fn watch() {
        let ignored = ignored();
        let watched = [SIGINT, SIGTERM, SIGHUP].into_iter();
        let watched: Vec<i32> = watched.filter(|signal| !ignored.contains(signal)).collect();
        // A file that grows beyond what the process may write (`ulimit -f`) is an error of the write then.
        let _ = flag::register(SIGXFSZ, Arc::default());
        // In the thread: where there is none to be had, the signals do what they do without.
        let watch = move || {
            let Ok(mut signals) = Signals::new(watched) else { return };
            if let Some(signal) = signals.forever().next() {
                ENDING.store(true, Ordering::SeqCst);
                stop_worker();
                files::abandon();
                // It does not return; if it did, the code would say the same.
                let _ = emulate_default_handler(signal);
                std::process::exit(128 + signal);
            }
        };
        let _ = thread::Builder::new().spawn(watch);
    }

    /// The signals that this process was started to ignore; where the system does not tell, SIGHUP could be one.
    fn ignored() -> Vec<i32> {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        match mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()) {
            Some(mask) => (1..=64).filter(|signal| mask >> (signal - 1) & 1 == 1).collect(),
            None => vec![SIGHUP],
        }
    }

    fn stop_worker() {
        let Some(group) = *worker() else { return };
        let start = Instant::now();
        let _ = kill_process_group(group, Signal::TERM);
        // The main thread waits for them, and says so when they have ended.
        while worker().is_some() {
            if start.elapsed() > PATIENCE {
                let _ = kill_process_group(group, Signal::KILL);
                return;
            }
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Runs a program for this one, in a process group of its own.
    pub fn run(command: &mut Command) -> io::Result<Output> {
        // Under the lock, so that no signal comes between the start and the note of it.
        let mut leader = worker();
        let child = command.process_group(0).spawn()?;
        *leader = Some(Pid::from_child(&child));
        drop(leader);
        let output = child.wait_with_output();
        *worker() = None;
        output
    }
}

#[cfg(not(unix))]
mod elsewhere {
    use std::io;
    use std::process::{Command, Output};

    pub fn watch() {}

    pub fn give_way() {}

    pub fn run(command: &mut Command) -> io::Result<Output> {
        command.spawn()?.wait_with_output()
    }
}
