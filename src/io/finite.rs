//! Files hold finite numbers only.

use thiserror::Error;

/// A number that cannot be written.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{place} is NaN or infinite; expected a finite number")]
pub struct NotFinite {
    /// The name of the number, or of the list and the entry that it stands in.
    pub place: String,
}

/// Refuses `values` with a number that is not finite; each entry may hold several numbers.
pub(super) fn check_finite<'a>(
    name: &str,
    values: impl IntoIterator<Item = &'a [f64]>,
) -> Result<(), NotFinite> {
    match values.into_iter().position(|entry| !entry.iter().all(|number| number.is_finite())) {
        None => Ok(()),
        Some(i) => Err(NotFinite { place: format!("{name}[{i}]") }),
    }
}
