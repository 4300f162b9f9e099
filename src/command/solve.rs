//! `signorini solve`: by this program, or by the reference implementation in FEniCSx.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::certificates::adapt::Stage;
use crate::io::files::spare;
use crate::io::outputs::{self, Extra};
use crate::io::result::{Results, result_json};
use crate::io::{Case, Failure, input, run, steps, summary};
use crate::quote;

use super::arguments::{CaseArguments, Engine, SolveOptions};
use super::progress::Phases;
use super::{
    Done, READING, SHORT, complain, engine, folder, is_standard_input, read, summarised, sweep,
};

pub(crate) fn run(
    case: &CaseArguments,
    options: &SolveOptions,
    quiet: bool,
    verbose: bool,
) -> Result<Done, Failure> {
    if let (Engine::Fenicsx, Some(_)) = (options.engine, &options.within) {
        return Err(Failure::wrong(
            "--within: the engine fenicsx refines no mesh; expected the engine signorini",
        ));
    }
    let within = options.within.iter().map(|within| within.setting.clone());
    let settings = case.settings.iter().cloned().chain(within).collect();
    let case = &CaseArguments { file: case.file.clone(), settings };
    let (results, files) = match (options.engine, options.ranks) {
        (Engine::Fenicsx, _) => solve_by_fenicsx(case, options, quiet)?,
        (Engine::Signorini, None) => {
            let phases = Phases::start(quiet, READING);
            let (start, read) = (Instant::now(), read(case)?);
            let folder = folder(&case.file, options.out.as_deref());
            if !read.steps.is_empty() {
                return step_by_step(read, &folder, options, (phases, quiet));
            }
            solve((read, start.elapsed()), &folder, options, (phases, quiet))?
        }
        (Engine::Signorini, Some(ranks)) => {
            return Err(Failure::wrong(format!(
                "--ranks {ranks}: this program solves in one process; expected --engine fenicsx beside it"
            )));
        }
    };
    let done = if options.json {
        let text = result_json(&results)
            .map_err(|error| Failure::failed(format!("result.json cannot be made: {error}")))?;
        Done { text, code: 0 }
    } else {
        summarised(&summary::solved(&results, &files, verbose), quiet)
    };
    Ok(if results.falls_short() { Done { code: SHORT, ..done } } else { done })
}

fn step_by_step(
    case: Case,
    folder: &Path,
    options: &SolveOptions,
    (phases, quiet): (Phases, bool),
) -> Result<Done, Failure> {
    if options.json {
        return Err(Failure::wrong(
            "--json: the case has [[step]], whose results are files of their own; expected a case without, or the folder of each step",
        ));
    }
    spare(folder, steps::FILES, &case.sources)?;
    let (count, file) = (case.steps.len(), case.file.clone());
    let extra = Extra { certificate: options.certificate, report: options.report };
    let watcher = |step, stage| match stage {
        Stage::Solve(phase) => phases.enter_solve(phase),
        _ => phases.enter(format!("step {step} of {count}")),
    };
    let table = steps::run(case, folder, extra, &watcher)?;
    drop(phases);
    if let [Err(failure)] = &table.results[..] {
        return Err(failure.clone().of(&file));
    }
    sweep::ended(&table, folder, quiet)
}

type Written = (Results, Vec<PathBuf>);

fn solve(
    (case, read): (Case, Duration),
    folder: &Path,
    options: &SolveOptions,
    (phases, quiet): (Phases, bool),
) -> Result<Written, Failure> {
    let extra = Extra { certificate: options.certificate, report: options.report };
    let with_files = !options.json || options.out.is_some();
    if with_files {
        spare(folder, &outputs::FILES, &case.sources)?;
    }
    let file = case.file.clone();
    let watcher = |stage| match stage {
        Stage::Solve(phase) => phases.enter_solve(phase),
        Stage::Certify(0) => phases.enter("certifying"),
        Stage::Certify(level) => phases.enter(format!("certifying level {level}")),
        _ => phases.enter("refining the mesh"),
    };
    let (case, mut solved) =
        run::solve(case, None, &watcher).map_err(|failure| failure.of(&file))?;
    if extra.certificate && solved.certified.is_none() {
        phases.enter("certifying");
        solved.certify(&case);
    }
    if !with_files {
        let results = outputs::results(&case, &solved, read, extra)?;
        return Ok((results, Vec::new()));
    }
    phases.enter("writing the files");
    let remark = remark_of_another_case(folder, &case.file);
    let outputs::Written { files, results, .. } =
        outputs::write(folder, &case, &solved, read, extra)?;
    drop(phases);
    if let (Some(remark), false) = (remark, quiet) {
        complain(&remark);
    }
    Ok((results, files))
}

/// Says that the results in `folder` are those of another case than `file`, if they are: two cases of one name write into one
/// folder.
fn remark_of_another_case(folder: &Path, file: &Path) -> Option<String> {
    let bytes = input::read(&folder.join("result.json"), input::MOST_OF_A_CASE).ok()?;
    let earlier: Results = serde_json::from_slice(&bytes).ok()?;
    let earlier = PathBuf::from(earlier.case?);
    let whole = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    (whole(&earlier) != whole(file)).then(|| {
        format!(
            "remark: the results of {} in {} are replaced by those of {}; --out DIR keeps them apart",
            quote::path(&earlier),
            quote::path(folder),
            quote::path(file)
        )
    })
}

fn solve_by_fenicsx(
    CaseArguments { file, settings }: &CaseArguments,
    options: &SolveOptions,
    quiet: bool,
) -> Result<Written, Failure> {
    if let Some(setting) = settings.first() {
        return Err(Failure::wrong(format!(
            "--set {setting}: the engine fenicsx reads the case file itself; write the key into a case file"
        )));
    }
    if is_standard_input(file) {
        return Err(Failure::wrong(
            "-: the engine fenicsx reads the case file itself; expected its name",
        ));
    }
    let _phases = Phases::start(quiet, "solving by the engine fenicsx");
    let folder = folder(file, options.out.as_deref());
    let (ranks, reference) = (options.ranks.unwrap_or(1), options.reference.as_deref());
    engine::fenicsx(file, &folder, ranks, reference)
}
