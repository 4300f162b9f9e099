//! Temporary folders, which one run holds and the next sweeps away if that was killed.

use std::collections::hash_map::RandomState;
use std::fs::{self, File, TryLockError};
use std::hash::{BuildHasher, Hasher};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The number of times that a name or a folder is tried before giving up.
pub const ATTEMPTS: usize = 64;

const PREFIX: &str = ".signorini-";
const SUFFIX: &str = ".tmp";

/// A temporary folder, locked as long as it is in use.
#[derive(Debug)]
pub struct Staging {
    pub path: PathBuf,
    /// The system frees the lock with the process, however that ends. `None` where folders can't be locked.
    _lock: Option<File>,
}

impl Staging {
    /// Makes one in `home` for a run that has `made` these folders.
    ///
    /// # Errors
    /// The system's error; `NotFound` if another run took `home` away.
    pub fn new(home: &Path, made: &[PathBuf]) -> io::Result<Staging> {
        for _ in 0..ATTEMPTS {
            let number = RandomState::new().build_hasher().finish();
            let path = home.join(format!("{PREFIX}{number:016x}{SUFFIX}"));
            let mut live = live();
            match fs::create_dir(&path) {
                Ok(()) => {}
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(error) => return Err(error),
            }
            let lock = match File::open(&path).map(|folder| folder.try_lock().map(|()| folder)) {
                Ok(Ok(folder)) => Some(folder),
                // A sweeper was faster.
                Ok(Err(TryLockError::WouldBlock)) => continue,
                Ok(Err(TryLockError::Error(_))) | Err(_) => None,
            };
            if path.is_dir() {
                live.push(Leftover { staging: path.clone(), made: made.to_vec() });
                return Ok(Staging { path, _lock: lock });
            }
        }
        Err(io::ErrorKind::NotFound.into())
    }
}

/// Removes the temporary folders in `home` that no run holds.
pub fn sweep(home: &Path) {
    let Ok(entries) = fs::read_dir(home) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_ours = name.to_str().is_some_and(|n| n.starts_with(PREFIX) && n.ends_with(SUFFIX));
        if !(is_ours && entry.file_type().is_ok_and(|kind| kind.is_dir())) {
            continue;
        }
        let path = entry.path();
        if let Ok(folder) = File::open(&path)
            && folder.try_lock().is_ok()
        {
            let _ = fs::remove_dir_all(&path);
        }
    }
}

/// The files that a run would leave behind if it ended now.
#[derive(Debug)]
pub struct Leftover {
    pub staging: PathBuf,
    made: Vec<PathBuf>,
}

static LIVE: Mutex<Vec<Leftover>> = Mutex::new(Vec::new());

/// The unfinished files of the runs of this process; nobody else begins or finishes one as long as this is held.
pub fn live() -> MutexGuard<'static, Vec<Leftover>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what the runs of this process have not finished, for a process that is told to end: afterwards it can begin or
/// finish no other, but waits. A set on its way to its place gets there first.
pub fn abandon() {
    let mut live = live();
    for Leftover { staging, made } in live.drain(..) {
        // The run may be adding a file at this moment, and then the folder is not empty.
        for _ in 0..ATTEMPTS {
            if fs::remove_dir_all(&staging).is_ok() || !staging.exists() {
                break;
            }
        }
        for folder in made {
            let _ = fs::remove_dir(folder);
        }
    }
    std::mem::forget(live);
}
