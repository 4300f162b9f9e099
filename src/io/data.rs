//! Checks before a file is written: its data fit together, its numbers are finite.

use thiserror::Error;

/// Why data make no file.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum DataError {
    #[error("{name} has {found} entries; expected {expected}")]
    Length { name: String, found: usize, expected: usize },
    #[error("{name} has no entry; expected at least one")]
    Empty { name: String },
    #[error("{name} names point {point}; expected one of the {count} points")]
    NoSuchPoint { name: String, point: usize, count: usize },
    #[error("{place} is NaN or infinite; expected a finite number")]
    NotFinite { place: String },
}

pub(super) fn check_length(name: &str, found: usize, expected: usize) -> Result<(), DataError> {
    if found == expected {
        return Ok(());
    }
    Err(DataError::Length { name: name.to_owned(), found, expected })
}

pub(super) fn check_points<'a>(
    name: &str,
    points: impl IntoIterator<Item = &'a usize>,
    count: usize,
) -> Result<(), DataError> {
    match points.into_iter().find(|&&point| point >= count) {
        None => Ok(()),
        Some(&point) => Err(DataError::NoSuchPoint { name: name.to_owned(), point, count }),
    }
}

/// Each entry of `values` may hold several numbers.
pub(super) fn check_finite<'a>(
    name: &str,
    values: impl IntoIterator<Item = &'a [f64]>,
) -> Result<(), DataError> {
    match values.into_iter().position(|entry| !entry.iter().all(|number| number.is_finite())) {
        None => Ok(()),
        Some(i) => Err(DataError::NotFinite { place: format!("{name}[{i}]") }),
    }
}
