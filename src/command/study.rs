//! `signorini convergence`: a case with an exact solution on finer and finer meshes.

use std::path::Path;

use signorini::io::Failure;
use signorini::io::convergence;
use signorini::io::files::spare;
use signorini::io::summary;
use signorini::model::Degree;

use super::arguments::{CaseArguments, StudyOptions};
use super::progress::Phases;
use super::{Done, folder, read, summarised};

const UNMEASURED: &str = "[exact]: near its singular point the exact solution is beyond the range of doubles, so its errors cannot be measured; expected a corner with an angle that is not so near to pi, such as omega = 2.7";

pub fn run(
    arguments: &CaseArguments,
    options: &StudyOptions,
    out: Option<&Path>,
    quiet: bool,
) -> Result<Done, Failure> {
    let case = read(arguments)?;
    let folder = folder(&arguments.file, out);
    spare(&folder, &convergence::FILES, &case.sources)?;
    let degree = |d: &u8| if *d == 1 { Degree::One } else { Degree::Two };
    let degrees = or_none(options.degree.iter().map(degree).collect());
    let perturbed = or_none(options.mesh.iter().map(|mesh| mesh == "perturbed").collect());
    let levels = usize::from(options.levels);
    let count = degrees.len() * perturbed.len() * levels;
    let phases = Phases::start(quiet);
    let mut done = 0;
    let mut enter = |more| {
        done += more;
        phases.enter(format!("{done} of {count} meshes"));
    };
    enter(0);
    let mut studies = Vec::new();
    for degree in &degrees {
        for perturbed in &perturbed {
            let study = convergence::ladder(&case, *degree, *perturbed)
                .and_then(|ladder| convergence::climb(ladder, levels, || enter(1)))
                .map_err(|failure| failure.of(&case.file))?;
            if !study.levels.iter().all(|level| level.errors.is_finite()) {
                return Err(Failure::failed(UNMEASURED).of(&case.file));
            }
            studies.push(study);
        }
    }
    drop(phases);
    let files = convergence::write(&folder, &case.title, &studies)?;
    Ok(summarised(&summary::studied(&case, &studies, &files), quiet))
}

/// The wanted ones, or one that the case decides.
fn or_none<T>(wanted: Vec<T>) -> Vec<Option<T>> {
    if wanted.is_empty() { vec![None] } else { wanted.into_iter().map(Some).collect() }
}
