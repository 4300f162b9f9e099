//! The engine past one machine: hands a case to the reference in FEniCSx (`reference/fenicsx`), which runs under MPI.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{env, fs, io};

use signorini::io::result::Results;
use thiserror::Error;

/// Why the other engine gave no result.
#[derive(Debug, Error)]
pub enum EngineError {
    #[error(
        "the engine fenicsx is not here: no folder fenicsx on PYTHONPATH nor in {}; take the folder reference/ of the sources and put it on PYTHONPATH",
        looked_in.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ")
    )]
    NoPackage { looked_in: Vec<PathBuf> },
    #[error(
        "the engine fenicsx needs DOLFINx, and neither python3 nor /usr/bin/python3 can import it: install it (Debian, Ubuntu: apt-get install python3-dolfinx)"
    )]
    NoDolfinx,
    #[error("cannot start {program}: {error}")]
    NotStarted { program: String, error: io::Error },
    #[error("{message}")]
    Failed { code: Option<i32>, message: String },
    #[error("{}: {error}", path.display())]
    NoResult { path: PathBuf, error: io::Error },
}

impl EngineError {
    /// The engine refused the case, as this program would have.
    pub fn is_wrong_case(&self) -> bool {
        matches!(self, EngineError::Failed { code: Some(2), .. })
    }
}

/// Solves `case` on `ranks` processes; the engine writes result.json and a file for ParaView into `folder`.
pub fn fenicsx(
    case: &Path,
    folder: &Path,
    ranks: u16,
) -> Result<(Results, Vec<PathBuf>), EngineError> {
    let path = python_path()?;
    let python = python()?;
    let output = run(Command::new(python)
        .args(["-m", "fenicsx", "--ranks", &ranks.to_string(), "--out"])
        .args([folder, case])
        .env("PYTHONPATH", path))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let said = said.trim();
        let message = said.strip_prefix("error: ").unwrap_or(said).to_owned();
        return Err(EngineError::Failed { code: output.status.code(), message });
    }
    let file = folder.join("result.json");
    let read = || serde_json::from_slice(&fs::read(&file)?).map_err(io::Error::from);
    let results = read().map_err(|error| EngineError::NoResult { path: file.clone(), error })?;
    Ok((results, vec![file, folder.join("solution.xdmf")]))
}

fn run(command: &mut Command) -> Result<Output, EngineError> {
    let program = command.get_program().to_string_lossy().into_owned();
    command.output().map_err(|error| EngineError::NotStarted { program, error })
}

/// PYTHONPATH with the package on it: as it is, or with `reference/` of the sources, here or where this program was built.
fn python_path() -> Result<std::ffi::OsString, EngineError> {
    let given: Vec<PathBuf> =
        env::var_os("PYTHONPATH").map_or(Vec::new(), |path| env::split_paths(&path).collect());
    let own = [PathBuf::from("reference"), Path::new(env!("CARGO_MANIFEST_DIR")).join("reference")];
    let has_package = |folder: &&PathBuf| folder.join("fenicsx/__main__.py").is_file();
    let Some(found) = given.iter().chain(&own).find(has_package) else {
        return Err(EngineError::NoPackage { looked_in: own.into() });
    };
    let found = std::path::absolute(found).unwrap_or_else(|_| found.clone());
    let all = std::iter::once(found).chain(given);
    env::join_paths(all).map_err(|error| EngineError::NotStarted {
        program: "python3".to_owned(),
        error: io::Error::other(error),
    })
}

/// A Python that has DOLFINx: the one on PATH, or the system's.
fn python() -> Result<&'static str, EngineError> {
    ["python3", "/usr/bin/python3"]
        .into_iter()
        .find(|python| {
            let import = Command::new(python).args(["-c", "import dolfinx"]).output();
            import.is_ok_and(|output| output.status.success())
        })
        .ok_or(EngineError::NoDolfinx)
}
