//! Memory is asked for before it is taken: what a factorisation needs is known from its structure, and a solve that does not
//! fit says so with the number, where the allocator would end the program.

use super::SolveError;

/// That many bytes can be had.
///
/// # Errors
/// [`SolveError::OutOfMemory`] if the allocator refuses them, or if the system says that less is available (Linux:
/// `MemAvailable` of /proc/meminfo; elsewhere the allocator alone is asked).
pub fn ensure(bytes: u64) -> Result<(), SolveError> {
    let refused = || SolveError::OutOfMemory { bytes };
    if available().is_some_and(|available| bytes > available) {
        return Err(refused());
    }
    let mut probe: Vec<u8> = Vec::new();
    let length = usize::try_from(bytes).map_err(|_| refused())?;
    probe.try_reserve_exact(length).map_err(|_| refused())
}

/// The bytes that the system can still hand out without swapping.
fn available() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
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
