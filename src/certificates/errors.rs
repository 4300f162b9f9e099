//! Why there is no certificate.

use super::proof::Rejection;
use crate::memory::OutOfMemory;
use crate::model::DataError;

/// Why there is no certificate.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum CertifyError {
    #[error(transparent)]
    Data(#[from] DataError),
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    #[error("no bound of the distance to the true solution: {0}")]
    Unsupported(String),
    #[error(
        "the displacement has {found} values; expected one at each of the {vertices} vertices, or at these and the middles of edges, {nodes}"
    )]
    Field { found: usize, vertices: usize, nodes: usize },
    #[error("the certificate does not hold: {0}")]
    Rejected(#[from] Rejection),
}
