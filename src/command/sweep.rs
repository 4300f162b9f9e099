//! `signorini sweep`: a case for each combination of values of some of its keys.

use std::path::Path;
use std::time::{Duration, Instant};

use crate::io::Failure;
use crate::io::files::spare;
use crate::io::result::Results;
use crate::io::sweep::{self, Extent, ParameterAxis, Sweep};

use super::progress::Phases;
use super::{Done, FAILED, SHORT, WRONG, folder, read_text, summarised};

/// The time between two writings of the table of a sweep.
const BETWEEN_TABLES: Duration = Duration::from_secs(1);

pub(crate) fn run(
    file: &Path,
    axes: &[ParameterAxis],
    extent: Extent,
    out: Option<&Path>,
    quiet: bool,
) -> Result<Done, Failure> {
    let runs = sweep::count(axes)?;
    let folder = folder(file, out);
    let (file, text) = read_text(file)?;
    spare(&folder, sweep::FILES, std::slice::from_ref(&file))?;
    let phases = Phases::start(quiet, format!("0 of {runs} runs"));
    // A stopped sweep leaves the table of its solved runs.
    let mut written = Instant::now();
    let done = |sweep: &Sweep| {
        let count = sweep.results.len();
        phases.enter(format!("{count} of {runs} runs"));
        let some = sweep.results.iter().any(Result::is_ok);
        if some && count < runs && written.elapsed() >= BETWEEN_TABLES {
            sweep.write(&folder)?;
            written = Instant::now();
        }
        Ok(())
    };
    let sweep = sweep::run(&file, &text, axes, &folder, extent, done)?;
    drop(phases);
    if sweep.results.iter().all(|run| code(run) == WRONG)
        && let Some(Err(failure)) = sweep.results.first()
    {
        return Err(failure.clone().of(&file));
    }
    ended(&sweep, &folder, quiet)
}

/// Writes the table, and returns how its runs ended.
pub(super) fn ended(sweep: &Sweep, folder: &Path, quiet: bool) -> Result<Done, Failure> {
    let written = sweep.write(folder)?;
    let all_in = |allowed: &[u8]| sweep.results.iter().all(|run| allowed.contains(&code(run)));
    let code = if all_in(&[0]) {
        0
    } else if all_in(&[0, SHORT]) {
        SHORT
    } else {
        FAILED
    };
    Ok(Done { code, ..summarised(&sweep.summary(&written), quiet) })
}

/// The exit code of a run with these results.
fn code(results: &Result<Results, Failure>) -> u8 {
    match results {
        Ok(results) if results.falls_short() => SHORT,
        Ok(_) => 0,
        Err(failure) => super::code(failure),
    }
}
