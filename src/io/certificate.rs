//! The files of a certificate, certificate.json and certificate.bin, read and verified. What they hold: `certificates::format`.

use std::path::Path;

use super::input;
use super::input::Failure;
pub use crate::certificates::encode;
use crate::certificates::format;
use crate::certificates::format::Refused;
pub use crate::certificates::format::{Audit, Header, decode, hash};
use crate::memory;
use crate::quote;

/// The names of the files: the claim, and the arrays beside it.
pub const FILES: [&str; 2] = ["certificate.json", "certificate.bin"];

/// The most bytes of a file: some ten million triangles.
const MOST: u64 = 4 << 30;

/// The bytes of memory that a byte of certificate.bin takes while it is verified, beside itself: up to 6 as measured.
const MEMORY_PER_BYTE: u64 = 7;

/// Reads certificate.json and the arrays beside it, and verifies everything anew.
pub fn audit(path: &Path) -> Result<Audit, Failure> {
    let arrays = path.with_file_name(FILES[1]);
    let refused = |error: Refused| {
        let (file, problem) = match error {
            Refused::Arrays(problem) => (&*arrays, quote::line(&problem)),
            Refused::Rejected(rejection) => (path, format!("rejected: {rejection}")),
            error => (path, quote::line(&error.to_string())),
        };
        Failure::failed(problem).of(file)
    };
    let read = |file: &Path| input::read(file, MOST).map_err(Failure::failed);
    let header = format::read_header(&read(path)?).map_err(refused)?;
    let bytes = read(&arrays)?;
    let needed = MEMORY_PER_BYTE.saturating_mul(bytes.len() as u64);
    memory::check(needed).map_err(|lack| Failure::failed(lack).of(&arrays))?;
    format::audit(header, &bytes).map_err(refused)
}
