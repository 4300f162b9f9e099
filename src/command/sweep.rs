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
    spare(&folder, &sweep::FILES, std::slice::from_ref(&file))?;
    let phases = Phases::start(quiet);
    let enter = |done| phases.enter(format!("{done} of {runs} runs"));
    enter(0);
    // A stopped sweep leaves the table of its solved runs.
    let mut written = Instant::now();
    let done = |sweep: &Sweep| {
        enter(sweep.results.len());
        let some = sweep.results.iter().any(Result::is_ok);
        if some && sweep.results.len() < runs && written.elapsed() >= BETWEEN_TABLES {
            sweep.write(&folder)?;
            written = Instant::now();
        }
        Ok(())
    };
    let sweep = sweep::run(&file, &text, axes, &folder, extent, done)?;
    drop(phases);
    let codes: Vec<u8> = sweep.results.iter().map(code).collect();
    if codes.iter().all(|code| *code == WRONG)
        && let Some(Err(failure)) = sweep.results.first()
    {
        return Err(failure.clone().of(&file));
    }
    ended(&sweep, &folder, quiet)
}

/// Writes the table, and returns how its runs ended.
pub(super) fn ended(sweep: &Sweep, folder: &Path, quiet: bool) -> Result<Done, Failure> {
    let codes: Vec<u8> = sweep.results.iter().map(code).collect();
    let written = sweep.write(folder)?;
    let all_in = |allowed: &[u8]| codes.iter().all(|code| allowed.contains(code));
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
