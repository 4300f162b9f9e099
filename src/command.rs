//! The tasks of the command line, what they share, and how each ends.

mod arguments;
mod certify;
mod engine;
mod new;
mod progress;
mod solve;
mod sweep;

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::io::Failure;
use crate::io::input::reason;
use crate::io::sweep::Extent;
use crate::io::{Case, checked};
use crate::model::DataError;
use crate::solve::SolveError;
use crate::{quote, solve as library};
use clap::CommandFactory;

use self::arguments::{Arguments, CaseArguments, Task};
use self::progress::Phases;

/// The case is wrong.
const WRONG: u8 = 2;
/// The case is right, but there is no result.
const FAILED: u8 = 1;
/// There are results, but they are not proved, or something else that was asked for is missing.
const SHORT: u8 = 3;

/// Text for standard output, and the exit code.
struct Done {
    text: String,
    code: u8,
}

/// A summary, unless nothing is to be printed.
fn summarised(text: &str, quiet: bool) -> Done {
    Done { text: if quiet { String::new() } else { quote::lines(text) }, code: 0 }
}

/// Runs the command on the arguments of the program; its exit code.
pub fn run() -> ExitCode {
    let Arguments { task, quiet, verbose } = match Arguments::read() {
        Ok(arguments) => arguments,
        Err(error) if error.use_stderr() => error.exit(),
        // What was asked for: help, or the version.
        Err(text) => return ended(heard(text.print()).map(|()| 0)),
    };
    let done = match &task {
        Task::Solve { case, options } => solve::run(case, options, quiet, verbose),
        Task::Audit { certificate, case, settings } => {
            certify::audit(certificate, case.as_deref(), settings, quiet)
        }
        Task::Certify { case, displacement, out } => {
            certify::certify(case, displacement, out.as_deref(), quiet)
        }
        Task::Check { case } => check(case, quiet),
        Task::New { mesh, out } => new::run(mesh, out.as_deref(), quiet),
        Task::Sweep { case, axes, files, jobs, out } => {
            let extent = Extent { files: *files, jobs: usize::from(*jobs) };
            sweep::run(case, axes, extent, out.as_deref(), quiet)
        }
        Task::Completions { shell } => Ok(completions(*shell)),
    };
    ended(done.and_then(|Done { text, code }| say(&text).map(|()| code)))
}

/// The exit code, after the message of a failure.
fn ended(said: Result<u8, Failure>) -> ExitCode {
    match said {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            complain(&format!("error: {failure}"));
            ExitCode::from(code(&failure))
        }
    }
}

fn code(failure: &Failure) -> u8 {
    if failure.is_wrong() { WRONG } else { FAILED }
}

/// Writes a text to standard output.
fn say(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    heard(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// A closed pipe is no failure: the files are written in any case.
fn heard(written: io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::failed(format!("cannot write to standard output: {}", reason(&error))))
        }
        _ => Ok(()),
    }
}

/// Writes a text to standard error. Where there is none, the exit code stands alone.
fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "{}", quote::lines(text));
}

const STANDARD_INPUT: &str = "standard input";

/// The phase in which a case is read.
const READING: &str = "reading the case and its mesh";

fn is_standard_input(file: &Path) -> bool {
    file == Path::new("-")
}

fn read(CaseArguments { file, settings }: &CaseArguments) -> Result<Case, Failure> {
    let (file, text) = read_text(file)?;
    Ok(Case::parse(&file, &text, settings)?)
}

/// The text of a case, and the name of its file in messages.
fn read_text(file: &Path) -> Result<(PathBuf, String), Failure> {
    let (name, text) = if is_standard_input(file) {
        let name = Path::new(STANDARD_INPUT);
        (name, Case::text_from(io::stdin(), name))
    } else {
        (file, Case::text(file))
    };
    Ok((name.to_owned(), text?))
}

/// The folder given by `--out`, or out/ and the name of the case.
fn folder(file: &Path, out: Option<&Path>) -> PathBuf {
    match out {
        Some(folder) => folder.to_owned(),
        None if is_standard_input(file) => PathBuf::from("out/stdin"),
        None => {
            // "...toml" without its ending would be "..", the folder above.
            let stem = file.file_stem().filter(|s| !matches!(s.to_str(), Some("." | "..")));
            Path::new("out").join(stem.or(file.file_name()).unwrap_or_default())
        }
    }
}

fn check(arguments: &CaseArguments, quiet: bool) -> Result<Done, Failure> {
    let phases = Phases::start(quiet, READING);
    let case = read(arguments)?;
    phases.enter("checking loads, supports and the contact line");
    let outline = library::check(&case.problem, &case.method);
    drop(phases);
    match outline {
        Ok(outline) => Ok(summarised(&checked::checked(&case, &outline), quiet)),
        Err(error) => {
            if matches!(error, SolveError::Data(DataError::RigidMotion { .. })) && !quiet {
                // What is held and what is not shows in the list.
                say(&quote::lines(&checked::listed(&case)))?;
            }
            let error = error.of_thickness(case.thickness);
            Err(Failure::from(error).of(&case.file))
        }
    }
}

fn completions(shell: clap_complete::Shell) -> Done {
    let mut bytes = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "signorini", &mut bytes);
    Done { text: String::from_utf8_lossy(&bytes).into_owned(), code: 0 }
}
