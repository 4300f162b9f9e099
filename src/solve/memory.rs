//! Memory is asked for before it is taken: what a factorisation needs is known from its structure, and a solve that does not
//! fit says so with the number, where the allocator would end the program.

use super::SolveError;
use crate::memory;

/// That many bytes can be had ([`memory::check`]).
///
/// # Errors
/// [`SolveError::OutOfMemory`].
pub fn ensure(bytes: u64) -> Result<(), SolveError> {
    memory::check(bytes).map_err(|lack| SolveError::OutOfMemory { bytes: lack.needed })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_megabyte_can_be_had_and_an_exabyte_cannot() {
        assert_eq!(ensure(1 << 20), Ok(()));
        assert_eq!(ensure(1 << 60), Err(SolveError::OutOfMemory { bytes: 1 << 60 }));
    }
}
