//! Memory, checked before allocation. An allocation that fails ends a Rust program, and a system that has promised too much
//! kills the program without a word: so memory that grows with the input is predicted, and refused in time.

use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// The error that more memory is needed than there is.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "this needs {needed} bytes of memory, more than {}",
    available.map_or("the system gives this program".to_owned(), |most| format!("the {most} bytes that are available"))
)]
pub struct OutOfMemory {
    /// The bytes needed.
    pub(crate) needed: u64,
    /// The bytes available, if the system tells.
    pub(crate) available: Option<u64>,
}

/// The number of bytes that need no check.
const LITTLE: u64 = 1 << 20;

/// Checks that so many bytes, beside those already taken, can be had now.
///
/// # Errors
/// [`OutOfMemory`] if the limit of the process (`ulimit -v`), the system or the control group does not allow so many bytes.
pub(crate) fn check(bytes: u64) -> Result<(), OutOfMemory> {
    if bytes < LITTLE {
        return Ok(());
    }
    let available = available();
    let granted = || {
        let Ok(bytes) = usize::try_from(bytes) else { return false };
        // Reserved, not touched: it costs no memory, and the limits of the process are asked.
        Vec::<u8>::new().try_reserve_exact(bytes).is_ok()
    };
    if available.is_some_and(|available| available < bytes) || !granted() {
        let available = available.filter(|&available| available < bytes);
        return Err(OutOfMemory { needed: bytes, available });
    }
    Ok(())
}

/// Makes room for `count` more items.
///
/// # Errors
/// As [`check`].
pub(crate) fn reserve<T>(list: &mut Vec<T>, count: usize) -> Result<(), OutOfMemory> {
    let needed = bytes_of::<T>(list.len().saturating_add(count));
    check(needed)?;
    list.try_reserve(count).map_err(|_| OutOfMemory { needed, available: None })
}

/// The bytes that `count` items of type `T` take in a list; no less than the largest number if that is larger.
pub(crate) fn bytes_of<T>(count: usize) -> u64 {
    (count as u64).saturating_mul(size_of::<T>() as u64)
}

/// The bytes that the system can still give, as far as Linux tells.
fn available() -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let kilobytes = |name| -> Option<u64> {
        let line = text.lines().find_map(|line: &str| line.strip_prefix(name))?;
        line.trim().strip_suffix(" kB")?.parse().ok()
    };
    let free = kilobytes("MemAvailable:")?.saturating_add(kilobytes("SwapFree:").unwrap_or(0));
    Some(group_limit().into_iter().fold(free.saturating_mul(1024), u64::min))
}

/// Memory that the control groups (version 2) of this process still allow.
fn group_limit() -> Option<u64> {
    let own = fs::read_to_string("/proc/self/cgroup").ok()?;
    let own = own.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let root = Path::new("/sys/fs/cgroup");
    let group: PathBuf = root.join(own.trim());
    group.ancestors().take_while(|group| group.starts_with(root)).filter_map(left_in).min()
}

fn left_in(group: &Path) -> Option<u64> {
    let number = |name: &str| fs::read_to_string(group.join(name)).ok()?.trim().parse::<u64>().ok();
    let statistics = fs::read_to_string(group.join("memory.stat")).unwrap_or_default();
    // Pages of files that nobody uses are given back when asked for.
    let idle = statistics.lines().find_map(|line| line.strip_prefix("inactive_file "));
    let idle: u64 = idle.and_then(|idle| idle.trim().parse().ok()).unwrap_or(0);
    // No limit is the word "max", no number.
    let most = number("memory.max")?;
    Some(most.saturating_sub(number("memory.current")?.saturating_sub(idle)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_with_the_number_of_bytes() {
        for bytes in [1 << 50, u64::MAX] {
            let said = check(bytes).unwrap_err().to_string();
            let start = format!("this needs {bytes} bytes of memory, more than the ");
            assert!(said.starts_with(&start), "{said}");
        }
        for bytes in [0, 1000, 8 << 20] {
            assert_eq!(check(bytes), Ok(()), "control");
        }
        assert_eq!([3, usize::MAX].map(bytes_of::<[f64; 2]>), [48, u64::MAX]);
    }
}
