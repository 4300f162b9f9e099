//! The files of a certificate, certificate.json and certificate.bin, read and verified. What they hold: `certify::format`.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::input::{self, FileError, InputError, Position};
use crate::certify::Rejection;
use crate::certify::format::{self, Refused};
pub use crate::certify::format::{Audit, Header, decode, encode, hash};
use crate::quote;

/// The names of the files: the claim, and the arrays beside it.
pub const FILES: [&str; 2] = ["certificate.json", "certificate.bin"];

/// The most bytes of a file: some ten million triangles.
const MOST: u64 = 4 << 30;

#[derive(Debug, Error)]
pub enum AuditError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: rejected: {rejection}", quote::path(path))]
    Rejected { path: PathBuf, rejection: Rejection },
}

/// Reads certificate.json and the arrays beside it, and verifies everything anew.
pub fn audit(path: &Path) -> Result<Audit, AuditError> {
    let arrays = path.with_file_name(FILES[1]);
    let wrong = |path: &Path, problem: &str| {
        AuditError::File(InputError::from(quote::line(problem)).at(path, Position::File))
    };
    let refused = |error| match error {
        Refused::Arrays(problem) => wrong(&arrays, &problem),
        Refused::Rejected(rejection) => AuditError::Rejected { path: path.to_owned(), rejection },
        error => wrong(path, &error.to_string()),
    };
    let header = format::read_header(&input::read(path, MOST)?).map_err(refused)?;
    format::audit(header, &input::read(&arrays, MOST)?).map_err(refused)
}
