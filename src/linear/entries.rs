//! Room for the entries of L, which is half the memory of a solve.
//!
//! On pages of four kilobytes, each of which the system hands out and clears when it is first touched, that takes as long as the
//! factorisation itself. A long array asks for pages of two megabytes instead; where there are none (other systems than Linux, or
//! `never` in `/sys/kernel/mm/transparent_hugepage/enabled`), it has the usual ones.

use std::ops::{Deref, DerefMut};

use memmap2::MmapMut;

/// The bytes from which an array asks for large pages.
const LONG: usize = 1 << 22;

/// An array of doubles.
pub(super) enum Entries {
    Short(Vec<f64>),
    Long(MmapMut),
}

impl Entries {
    /// The bytes of so many entries.
    pub(super) fn bytes(count: usize) -> usize {
        size_of::<f64>() * count
    }

    /// So many zeros; `None` if there is no memory for them.
    pub(super) fn zeros(count: usize) -> Option<Self> {
        let bytes = Entries::bytes(count);
        if bytes < LONG {
            return Some(Entries::Short(vec![0.0; count]));
        }
        let map = MmapMut::map_anon(bytes).ok()?;
        // Advice alone: without large pages the array is slower and no less right.
        #[cfg(target_os = "linux")]
        let _ = map.advise(memmap2::Advice::HugePage);
        Some(Entries::Long(map))
    }

    /// A copy; `None` if there is no memory for one.
    pub(super) fn copied(&self) -> Option<Self> {
        let mut copy = Entries::zeros(self.len())?;
        copy.copy_from_slice(self);
        Some(copy)
    }
}

impl Deref for Entries {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        match self {
            Entries::Short(entries) => entries,
            Entries::Long(map) => bytemuck::cast_slice(map),
        }
    }
}

impl DerefMut for Entries {
    fn deref_mut(&mut self) -> &mut [f64] {
        match self {
            Entries::Short(entries) => entries,
            Entries::Long(map) => bytemuck::cast_slice_mut(map),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_and_long_arrays_start_as_zeros_and_their_copies_are_their_own() {
        for (count, long) in [(0, false), (1000, false), (LONG / 8 - 1, false), (LONG / 8, true)] {
            let mut entries = Entries::zeros(count).unwrap();
            assert_eq!(matches!(entries, Entries::Long(_)), long);
            assert!(entries.len() == count && entries.iter().all(|entry| *entry == 0.0));
            entries.fill(2.5);
            assert_eq!(Entries::bytes(count), size_of_val(&entries[..]));
            let copy = entries.copied().unwrap();
            entries.fill(1.0);
            assert!(copy.len() == count && copy.iter().all(|entry| *entry == 2.5));
        }
        assert!(Entries::zeros(usize::MAX / 16).is_none(), "control: more than there is");
    }
}
