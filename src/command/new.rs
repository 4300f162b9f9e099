//! `signorini new`: the case file to begin with, from a mesh.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::io::files::folder_of;
use crate::io::input::reason;
use crate::io::{Case, Failure, checked, draft, gmsh};
use crate::quote;

use super::progress::Phases;
use super::{Done, complain, summarised};

pub(crate) fn run(mesh: &Path, out: Option<&Path>, quiet: bool) -> Result<Done, Failure> {
    let phases = Phases::start(quiet, "reading the mesh");
    let (made, pairs) = gmsh::read_with_pairs(mesh)?;
    drop(phases);
    let out = out.map_or_else(|| mesh.with_extension("toml"), Path::to_owned);
    let title = mesh.file_stem().unwrap_or_default().to_string_lossy();
    let text = draft::draft(&title, &name_for(mesh, &out), &made.mesh, &pairs);
    write(&out, &text)?;
    // The draft is a guess: mistakes in it are reported, and the file stays.
    let listed = Case::parse(&out, &text, &[]).map(|case| checked::listed(&case));
    let listed = listed.unwrap_or_else(|error| {
        complain(&format!("remark: the file has to be changed before it can be solved: {error}"));
        String::new()
    });
    let out = quote::path(&out);
    let text = format!(
        "{listed}  written      {out}\n  next         signorini check {out}; signorini solve {out}\n"
    );
    Ok(summarised(&text, quiet))
}

/// The mesh as the case file names it: relative to that file's folder where it lies there, else by its whole path.
fn name_for(mesh: &Path, out: &Path) -> PathBuf {
    match mesh.file_name() {
        Some(name) if folder_of(mesh) == folder_of(out) => PathBuf::from(name),
        _ => fs::canonicalize(mesh).unwrap_or_else(|_| mesh.to_owned()),
    }
}

/// Writes a new file, and overwrites none.
fn write(out: &Path, text: &str) -> Result<(), Failure> {
    let failed = |error: std::io::Error| {
        let name = quote::path(out);
        match error.kind() {
            ErrorKind::AlreadyExists => Failure::wrong(format!(
                "{name}: there is such a file; expected another name: --out CASE.toml"
            )),
            _ => Failure::failed(format!("cannot write {name}: {}", reason(&error))),
        }
    };
    let mut file = File::create_new(out).map_err(failed)?;
    file.write_all(text.as_bytes()).and_then(|()| file.sync_all()).map_err(|error| {
        // Remove an incomplete case file.
        let _ = fs::remove_file(out);
        failed(error)
    })
}
