//! `signorini certify` bounds the error of a displacement that any program computed; `signorini audit` verifies a certificate.

use std::path::Path;

use crate::certificates::binding::compare;
use crate::certificates::certify_field;
use crate::io::Failure;
use crate::io::field::read_field;
use crate::io::summary::{self, AuditedCase};
use crate::io::{Case, certificate, outputs};
use crate::quote;
use crate::solve::{Course, solve_along};

use super::arguments::CaseArguments;
use super::progress::Phases;
use super::{Done, READING, folder, read, summarised};

pub(crate) fn certify(
    arguments: &CaseArguments,
    displacement: &Path,
    out: Option<&Path>,
    quiet: bool,
) -> Result<Done, Failure> {
    let phases = Phases::start(quiet, READING);
    let case = read(arguments)?;
    let folder =
        out.map_or_else(|| folder(&arguments.file, None).join("certified"), Path::to_owned);
    if folder.join("result.json").exists() {
        return Err(Failure::wrong(format!(
            "{} has the result.json of a solve, to which this certificate would seem to belong; expected another folder: --out DIR",
            quote::path(&folder)
        )));
    }
    let field = read_field(displacement, &case.problem.mesh, case.method.degree)?;
    let watcher = |phase| phases.enter_solve(phase);
    let course = Course::default().watched_by(&watcher);
    let (solution, _) = solve_along(&case.problem, &case.method, &case.settings, course)
        .map_err(|error| Failure::from(error.of_thickness(case.thickness)).of(&case.file))?;
    phases.enter("certifying");
    let certified = certify_field(&case.problem, &solution, &field)
        .map_err(|e| Failure::failed(format!("{}: {e}", displacement.display())))?;
    let files = outputs::write_certified(&folder, &case, &field, &certified)?;
    drop(phases);
    Ok(summarised(&summary::certified(&case, displacement, &certified, &files), quiet))
}

/// Verifies a certificate from scratch and, if a case is named, that the certificate is of this case.
pub(crate) fn audit(
    path: &Path,
    case: Option<&Path>,
    settings: &[String],
    quiet: bool,
) -> Result<Done, Failure> {
    let case = case.map(|file| {
        let settings = settings.to_vec();
        read(&CaseArguments { file: file.to_owned(), settings })
    });
    let case = case.transpose()?;
    let audit = certificate::audit(path)?;
    let Some(Case { problem, file, title, units, thickness, .. }) = case else {
        return Ok(summarised(&summary::audited(&audit, None), quiet));
    };
    let none_of_it = |difference: String| {
        let [path, file] = [path, &file].map(quote::path);
        Failure::failed(format!("{path}: not a certificate of {file}: {difference}"))
    };
    if audit.header.thickness != thickness {
        let said = |t: Option<f64>| t.map_or("no thickness".to_owned(), |t| format!("{t:?}"));
        let [found, expected] = [audit.header.thickness, thickness].map(said);
        return Err(none_of_it(format!("the body has {found}; the case says {expected}")));
    }
    let reason = compare(problem, &audit.certificate, &audit.forces)
        .map_err(|difference| none_of_it(difference.to_string()))?;
    let case = AuditedCase { file, title, units, reason };
    Ok(summarised(&summary::audited(&audit, Some(&case)), quiet))
}
