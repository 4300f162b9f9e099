//! The files of a run, written together.
//!
//! They are first written into a temporary folder of their own inside the output folder, `.signorini-XXXX.tmp` with a random
//! name, and flushed to disk, for a quota or a disk behind a network may refuse them only then. Then, under a lock of the output folder, the last file of an earlier set (result.json) is removed,
//! each new file is renamed into its place, and the new result.json comes last. So the files beside a result.json belong to
//! it, whenever a run is stopped and however many run at a time; where there is none, a run is under way or was stopped.
//!
//! A run that is stopped may leave its temporary folder.

use std::collections::hash_map::RandomState;
use std::fs::{self, File};
use std::hash::{BuildHasher, Hasher};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::thread;

use thiserror::Error;

use super::input::{Failure, reason};
use crate::quote;

/// The files of one run, on their way into one folder.
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    /// The temporary folder, where another program may write, too.
    pub(crate) room: PathBuf,
    names: Vec<String>,
}

/// A number that cannot be written.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{place} is NaN or infinite; expected a finite number")]
pub struct NotFinite {
    /// The name of the number, or of the list and the entry that it stands in.
    pub(crate) place: String,
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

/// The folder that a file is in, or would be in, from the root on.
pub(crate) fn folder_of(file: &Path) -> Option<PathBuf> {
    let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty());
    fs::canonicalize(parent.unwrap_or(Path::new("."))).ok()
}

/// Refuses to write files called `names` into `folder` if one of them is one of the `sources` of the case.
pub fn spare(folder: &Path, names: &[&str], sources: &[PathBuf]) -> Result<(), Failure> {
    // The place of a name in its folder: a link of that name would be replaced, not what it leads to.
    let place = |path: &Path| Some(folder_of(path)?.join(path.file_name()?));
    let sources: Vec<PathBuf> = sources.iter().filter_map(|source| place(source)).collect();
    let is_source = |path: &PathBuf| place(path).is_some_and(|place| sources.contains(&place));
    match names.iter().map(|name| folder.join(name)).find(is_source) {
        Some(path) => Err(Failure::wrong(format!(
            "{} is a file of the case, and the results would replace it; expected another folder: --out DIR",
            quote::path(&path)
        ))),
        None => Ok(()),
    }
}

impl Output {
    /// Makes the folder, if there is none yet, and the temporary one in it.
    pub fn new(folder: impl Into<PathBuf>) -> Result<Output, Failure> {
        let folder = folder.into();
        let number = RandomState::new().build_hasher().finish();
        let room = folder.join(format!(".signorini-{number:016x}.tmp"));
        let made = fs::create_dir_all(&folder).and_then(|()| fs::create_dir(&room));
        made.map_err(|error| {
            let (folder, why) = (quote::path(&folder), reason(&error));
            Failure::failed(format!("cannot make the folder {folder}: {why}"))
        })?;
        Ok(Output { folder, room, names: Vec::new() })
    }

    /// Writes the file `name`, but not yet to its place. The last file of a set is the one that says that the set is whole.
    ///
    /// # Errors
    /// A failure to write it.
    pub fn stage(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
        let file = File::create_new(self.room.join(name));
        let written = file.and_then(|mut file| file.write_all(bytes.as_ref()));
        written.map_err(|error| self.wrong(name, error))?;
        self.adopt(name);
        Ok(())
    }

    /// Stages a file, unless it has a number that cannot be written.
    pub fn stage_made(
        &mut self,
        file: &'static str,
        content: Result<impl AsRef<[u8]>, NotFinite>,
    ) -> Result<(), Failure> {
        match content {
            Ok(content) => self.stage(file, content),
            Err(error) => Err(Failure::failed(format!("{file} cannot be made: {error}"))),
        }
    }

    /// Adds a file to the set that is in the temporary folder.
    pub(crate) fn adopt(&mut self, name: &str) {
        self.names.push(name.to_owned());
    }

    fn wrong(&self, name: &str, error: io::Error) -> Failure {
        let (path, why) = (quote::path(&self.folder.join(name)), reason(&error));
        Failure::failed(format!("cannot write {path}: {why}"))
    }

    /// Gives all staged files their places, and returns the paths in the order of staging. The files of an earlier run that have
    /// these names go, and those called `stale`, which a reader could take for files of this one.
    ///
    /// # Errors
    /// A failure, should the disk refuse a file: then nothing has changed; or the system to rename one: then the last file of the set
    /// is not there.
    pub fn publish(self, stale: &[&str]) -> Result<Vec<PathBuf>, Failure> {
        self.flush()?;
        let Some((last, others)) = self.names.split_last() else { return Ok(Vec::new()) };
        let place = |name: &str| self.folder.join(name);
        let remove = |name: &str| match fs::remove_file(place(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound && !place(name).is_dir() => {
                Err(self.wrong(name, error))
            }
            _ => Ok(()),
        };
        let rename = |name: &String| {
            fs::rename(self.room.join(name), place(name)).map_err(|error| self.wrong(name, error))
        };
        // To the end of this function; a system without locks takes its chance.
        let _lock = File::open(&self.folder).and_then(|folder| folder.lock().map(|()| folder));
        remove(last)?;
        let is_stale = |name: &&&str| !self.names.iter().any(|staged| staged == **name);
        stale.iter().filter(is_stale).try_for_each(|name| remove(name))?;
        others.iter().try_for_each(rename)?;
        rename(last)?;
        Ok(self.names.iter().map(|name| place(name)).collect())
    }

    /// Hands all files to the disk, each in a thread of its own: it is a matter of waiting.
    fn flush(&self) -> Result<(), Failure> {
        let flush = |name| File::options().append(true).open(self.room.join(name))?.sync_all();
        let lost = |_| Err(io::Error::other("writing stopped"));
        thread::scope(|scope| {
            let start = |name| thread::Builder::new().spawn_scoped(scope, move || flush(name));
            let threads: Vec<_> = self.names.iter().map(|name| (name, start(name))).collect();
            threads.into_iter().try_for_each(|(name, thread)| {
                let flushed = thread.and_then(|thread| thread.join().unwrap_or_else(lost));
                flushed.map_err(|error| self.wrong(name, error))
            })
        })
    }
}

/// Removes the temporary folder. What cannot be removed stays: the failure that led here is the one to report.
impl Drop for Output {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.room);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fresh folder for one test, removed at its end.
    struct Scratch(PathBuf);

    impl Scratch {
        fn new(test: &str) -> Scratch {
            let path =
                std::env::temp_dir().join(format!("signorini-{}-{test}", std::process::id()));
            fs::create_dir_all(&path).unwrap();
            Scratch(path)
        }
    }

    /// The names of all that is in a folder.
    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    /// A set of three files that say which run they are of.
    fn run(folder: &Path, stamp: &str) -> Result<Vec<PathBuf>, Failure> {
        let mut output = Output::new(folder)?;
        for name in SET {
            output.stage(name, stamp)?;
        }
        output.publish(&[])
    }

    const SET: [&str; 3] = ["a.txt", "b.txt", "result.json"];

    #[test]
    fn a_file_that_cannot_be_written_leaves_the_earlier_run_untouched() {
        let scratch = Scratch::new("earlier");
        fs::write(scratch.0.join("a.txt"), b"earlier").unwrap();
        let mut output = Output::new(&scratch.0).unwrap();
        output.stage("a.txt", "later").unwrap();
        let error = output.stage("none/b.txt", "later").unwrap_err();
        let place = scratch.0.join("none/b.txt");
        let said = format!("cannot write {}: No such file or directory", place.display());
        assert_eq!(error.to_string(), said);
        drop(output);
        assert_eq!(names(&scratch.0), ["a.txt"]);
        assert_eq!(fs::read(scratch.0.join("a.txt")).unwrap(), b"earlier");
    }

    #[test]
    fn a_set_that_cannot_be_renamed_has_no_result_json() {
        let scratch = Scratch::new("refused");
        run(&scratch.0, "earlier").unwrap();
        let mut output = Output::new(&scratch.0).unwrap();
        for name in ["c.txt", "result.json"] {
            output.stage(name, "later").unwrap();
        }
        // Since it was staged, somebody has put a folder in its place.
        fs::create_dir_all(scratch.0.join("c.txt/full")).unwrap();
        let error = output.publish(&[]).unwrap_err().to_string();
        assert!(error.ends_with("c.txt: Is a directory"), "{error}");
        assert_eq!(names(&scratch.0), ["a.txt", "b.txt", "c.txt"]);
    }

    #[test]
    fn sets_of_several_runs_at_a_time_are_never_mixed() {
        let scratch = Scratch::new("races");
        let folder = scratch.0.join("case");
        let stamps = |folder: &Path| SET.map(|name| fs::read_to_string(folder.join(name)).ok());
        let mut whole = 0;
        std::thread::scope(|scope| {
            let writer = |k: usize| {
                let folder = &folder;
                move || (0..20).for_each(|i| drop(run(folder, &format!("{k} {i}")).unwrap()))
            };
            let writers: Vec<_> = (0..4).map(|k| scope.spawn(writer(k))).collect();
            while !writers.iter().all(|writer| writer.is_finished()) {
                let before = fs::read_to_string(folder.join("result.json")).ok();
                let [a, b, after] = stamps(&folder);
                // A reader who finds the same result.json before and after has read one set.
                if before.is_some() && before == after {
                    assert_eq!([&a, &b], [&before, &before]);
                    whole += 1;
                }
            }
        });
        let [a, b, marker] = stamps(&folder);
        assert!(marker.is_some() && a == marker && b == marker, "{a:?} {b:?} {marker:?}");
        assert!(whole > 0);
        assert_eq!(
            (names(&scratch.0), names(&folder)),
            (vec!["case".to_owned()], SET.map(str::to_owned).to_vec())
        );
    }
}
