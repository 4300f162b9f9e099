//! The load steps of a case, solved one after the other: each begins with the slip that the one before has left on its pieces of
//! Gamma_C. The table of them is that of a sweep over the number of the step.

use std::path::Path;
use std::time::Duration;

use super::case::Case;
use super::input::Failure;
use super::outputs::{self, Extra, Series};
use super::run::{self, Earlier};
use super::sweep::{Names, Sweep, clear, of_run};
use crate::certificates::adapt::Stage;

/// The files beside those of each step.
pub(crate) const FILES: &Names = &["steps.csv", "steps.svg", "steps.pvd"];

/// Solves the steps of a `case` and writes the files of step i (from 1) into the folder i of `folder`; those that earlier steps left
/// there go before. `watcher` is told of each step and of each stage of it. After a step without a solution there is none to go on from:
/// the rest is not solved.
///
/// # Errors
/// Files that can't be written. A step that has no solution is none: its entry in [`Sweep::results`] says why.
pub(crate) fn run(
    case: Case,
    folder: &Path,
    extra: Extra,
    watcher: &dyn Fn(usize, Stage),
) -> Result<Sweep, Failure> {
    clear(folder);
    let Case { title, steps, .. } = case;
    let values = (1..=steps.len()).map(|i| vec![i.to_string()]).collect();
    let keys = vec!["step".to_owned()];
    let mut table =
        Sweep { title, keys, values, results: Vec::new(), with_files: true, names: FILES };
    let mut last: Option<Vec<Vec<f64>>> = None;
    let (mut series, earlier) = (Series::default(), Earlier::default());
    for (i, mut case) in steps.into_iter().enumerate() {
        if let Some(slip) = last.take() {
            case.problem.slip = slip;
        }
        let watcher = |stage| watcher(i + 1, stage);
        let (case, mut solved) = match run::solve(case, Some(&earlier), &watcher) {
            Ok(solved) => solved,
            Err(error) => {
                table.results.push(Err(error));
                break;
            }
        };
        if extra.certificate {
            solved.certify(&case);
        }
        let to = of_run(folder, i);
        let written = outputs::write(&to, &case, &solved, Duration::ZERO, extra)?;
        series.add(to, written.scene);
        table.results.push(Ok(written.results));
        last = Some(solved.solution.slip());
    }
    series.draw()?;
    Ok(table)
}
