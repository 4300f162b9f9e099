//! The engine past one machine: hands a case to the reference in FEniCSx (`reference/fenicsx`), which runs under MPI.
//!
//! The engine is the package that this program was told to run, or the package beside the program. Python, PETSc and DOLFINx
//! all read files of the folder in which they are started (modules, `.petscrc`, `dolfinx_jit_options.json`): so they are
//! started in a fresh folder, where they also write, with absolute paths, and Python does not look for modules there. Their
//! files are then published as this program's own files are.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::{env, fs, io};

use crate::io::Failure;
use crate::io::files;
use crate::io::input::{self, MOST_OF_A_CASE, reason};
use crate::io::outputs::FILES;
use crate::io::result::Results;
use crate::quote;

const NO_DOLFINX: &str = "the engine fenicsx needs DOLFINx and Python 3.11 or later, and neither python3 nor /usr/bin/python3 can import it: install it (Debian, Ubuntu: apt-get install python3-dolfinx)";

fn not_started(program: &Path, error: &io::Error) -> Failure {
    Failure::failed(format!("cannot start {}: {}", quote::path(program), reason(error)))
}

/// Solves `case` on `ranks` processes, with the package in `reference` if that is given; result.json and a file for
/// ParaView are written into `folder`.
pub(crate) fn fenicsx(
    case: &Path,
    folder: &Path,
    ranks: u16,
    reference: Option<&Path>,
) -> Result<(Results, Vec<PathBuf>), Failure> {
    input::read(case, MOST_OF_A_CASE)?;
    files::spare(folder, &FILES, &[case.to_owned()])?;
    let path = python_path(reference)?;
    let python = python()?;
    let not_started = |error| not_started(&python, &error);
    let mut output = files::Output::new(folder)?;
    let room = std::path::absolute(&output.room).map_err(not_started)?;
    let full = std::path::absolute(case).map_err(not_started)?;
    let ended = safe(&python)
        .args(["-m", "fenicsx", "--ranks", &ranks.to_string(), "--out"])
        .args([&room, &full])
        .env("PYTHONPATH", path)
        .current_dir(&room)
        .output()
        .map_err(not_started)?;
    if !ended.status.success() {
        return Err(failed(&ended, case, &full));
    }
    let results = fs::read(room.join("result.json"))
        .and_then(|bytes| Ok(serde_json::from_slice(&bytes)?))
        .map_err(|error| {
            Failure::failed(format!(
                "the engine fenicsx wrote no result.json that can be read: {error}"
            ))
        })?;
    for name in ["solution.xdmf", "solution.h5", "result.json"] {
        output.adopt(name);
    }
    let mut files = output.publish(&FILES)?;
    files.retain(|file| !file.ends_with("solution.h5"));
    Ok((results, files))
}

/// The engine's message, with the case named as the caller named it.
fn failed(ended: &Output, case: &Path, full: &Path) -> Failure {
    const MOST: usize = 4000;
    let said = String::from_utf8_lossy(&ended.stderr);
    let said = said.trim().replace(&*full.to_string_lossy(), &case.to_string_lossy());
    let said = said.strip_prefix("error: ").unwrap_or(&said);
    // The end of a long message has the reason.
    let cut = said.char_indices().rev().nth(MOST).map_or(0, |(at, c)| at + c.len_utf8());
    let message = match &said[cut..] {
        "" => format!("the engine fenicsx ended with {}", ended.status),
        said => said.to_owned(),
    };
    // The engine refused the case, as this program would have.
    Failure::new(ended.status.code() == Some(2), message)
}

/// A Python that does not look for modules in the folder where it is started.
fn safe(python: &Path) -> Command {
    let mut command = Command::new(python);
    // The variable is for the processes of Python that MPI starts.
    command.arg("-P").env("PYTHONSAFEPATH", "1").stdin(Stdio::null());
    command
}

/// PYTHONPATH with the package in front. Entries that are not paths from the root are left out: they would be folders of
/// wherever Python is started.
fn python_path(reference: Option<&Path>) -> Result<OsString, Failure> {
    let looked_in = match reference {
        Some(folder) => vec![folder.to_owned()],
        None => beside_this_program(),
    };
    let has_package = |folder: &&PathBuf| folder.join("fenicsx/__main__.py").is_file();
    let Some(found) = looked_in.iter().find(has_package) else {
        let looked_in: Vec<String> = looked_in.iter().map(|folder| quote::path(folder)).collect();
        return Err(Failure::failed(format!(
            "the engine fenicsx is not here: no folder fenicsx in {}; take the folder reference/ of the sources and name it: --reference DIR",
            looked_in.join(", ")
        )));
    };
    let not_started = |error| not_started(Path::new("python3"), &error);
    let found = std::path::absolute(found).map_err(not_started)?;
    let given = absolute_paths("PYTHONPATH");
    env::join_paths(std::iter::once(found).chain(given))
        .map_err(|error| not_started(io::Error::other(error)))
}

/// reference/ in the folder of this program, and in that of the sources if this program was built there.
fn beside_this_program() -> Vec<PathBuf> {
    let Ok(program) = env::current_exe().and_then(fs::canonicalize) else { return Vec::new() };
    let Some(folder) = program.parent() else { return Vec::new() };
    let sources = folder.parent().filter(|target| target.ends_with("target"));
    let sources = sources.and_then(Path::parent);
    [Some(folder), sources].into_iter().flatten().map(|f| f.join("reference")).collect()
}

/// The entries of a list of folders in the environment that are paths from the root.
fn absolute_paths(variable: &str) -> Vec<PathBuf> {
    let list = env::var_os(variable).unwrap_or_default();
    env::split_paths(&list).filter(|path| path.is_absolute()).collect()
}

/// A Python that has DOLFINx: the one on PATH, or the system's.
fn python() -> Result<PathBuf, Failure> {
    let on_path = absolute_paths("PATH").into_iter().map(|folder| folder.join("python3"));
    on_path
        .filter(|python| python.is_file())
        .take(1)
        .chain([PathBuf::from("/usr/bin/python3")])
        .find(|python| {
            let path = env::join_paths(absolute_paths("PYTHONPATH")).unwrap_or_default();
            // PETSc reads .petscrc of the folder where it starts: not of this one.
            let home = python.parent().unwrap_or(Path::new("/"));
            let import = safe(python)
                .args(["-c", "import dolfinx"])
                .env("PYTHONPATH", path)
                .current_dir(home)
                .output();
            import.is_ok_and(|output| output.status.success())
        })
        .ok_or_else(|| Failure::failed(NO_DOLFINX))
}
