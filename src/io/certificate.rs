//! The files of a certificate, certificate.json and certificate.bin, read and verified. What they hold: `certify::format`.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::input::{self, InputError};
use crate::certify::Rejection;
use crate::certify::format::{self, Refused};
pub use crate::certify::format::{Audit, Header, decode, encode, hash};
use crate::quote;

/// The names of the files: the claim, and the arrays beside it.
pub const FILES: [&str; 2] = ["certificate.json", "certificate.bin"];

/// The most bytes of a file: some ten million triangles.
const MOST: u64 = 4 << 30;

/// The reason why a certificate is not accepted.
#[derive(Debug, Error)]
pub enum AuditError {
    #[error("{}: {error}", quote::path(path))]
    Read { path: PathBuf, error: InputError },
    #[error("{}: {}", quote::path(path), quote::line(problem))]
    Format { path: PathBuf, problem: String },
    #[error("{}: rejected: {rejection}", quote::path(path))]
    Rejected { path: PathBuf, rejection: Rejection },
}

/// Reads certificate.json and the arrays beside it, and verifies everything anew.
pub fn audit(path: &Path) -> Result<Audit, AuditError> {
    let read = |path: &Path| {
        input::read(path, MOST).map_err(|error| AuditError::Read { path: path.to_owned(), error })
    };
    let arrays = path.with_file_name(FILES[1]);
    let refused = |error| match error {
        Refused::Arrays(problem) => AuditError::Format { path: arrays.clone(), problem },
        Refused::Rejected(rejection) => AuditError::Rejected { path: path.to_owned(), rejection },
        error => AuditError::Format { path: path.to_owned(), problem: error.to_string() },
    };
    let header = format::read_header(&read(path)?).map_err(refused)?;
    format::audit(header, &read(&arrays)?).map_err(refused)
}
