//! The files of a run, written whole or not at all.
//!
//! Every file is first written beside its place under a temporary name. Only when all of them are there, and on the disk,
//! do they get their names. A run that fails halfway leaves behind neither files nor new folders, and the files of an
//! earlier run stay as they were.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

/// The files of one run, on their way into one folder.
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    staged: Vec<Staged>,
    /// The folders that did not exist before, innermost first.
    made: Vec<PathBuf>,
}

#[derive(Debug)]
struct Staged {
    temporary: PathBuf,
    path: PathBuf,
}

/// Why a file or folder could not be written.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
pub enum WriteError {
    #[error("cannot make the folder {}: {}", path.display(), reason(error))]
    Folder { path: PathBuf, error: io::Error },
    #[error("cannot write {}: {}", path.display(), reason(error))]
    File { path: PathBuf, error: io::Error },
}

/// The reason in words; the number that the system gives it helps nobody.
fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    match text.split_once(" (os error ") {
        Some((words, _)) => words.to_owned(),
        None => text,
    }
}

impl Output {
    /// Makes the folder, if there is none yet.
    ///
    /// # Errors
    /// [`WriteError::Folder`].
    pub fn new(folder: impl Into<PathBuf>) -> Result<Output, WriteError> {
        let folder = folder.into();
        let missing = |path: &&Path| !path.as_os_str().is_empty() && !path.exists();
        let made = folder.ancestors().take_while(missing).map(Path::to_path_buf).collect();
        let output = Output { folder, staged: Vec::new(), made };
        match fs::create_dir_all(&output.folder) {
            Ok(()) => Ok(output),
            Err(error) => Err(WriteError::Folder { path: output.folder.clone(), error }),
        }
    }

    /// Writes the file `name` to the disk, but not yet under its name.
    ///
    /// # Errors
    /// [`WriteError::File`], with the name that the file was to have.
    pub fn stage(&mut self, name: &str, bytes: &[u8]) -> Result<(), WriteError> {
        let path = self.folder.join(name);
        // Two runs that write to the same folder at the same time must not share a temporary file.
        let temporary = self.folder.join(format!(".{name}.{}.tmp", std::process::id()));
        self.staged.push(Staged { temporary: temporary.clone(), path: path.clone() });
        let write = || {
            if path.is_dir() {
                return Err(io::ErrorKind::IsADirectory.into());
            }
            let mut file = File::create(&temporary)?;
            file.write_all(bytes)?;
            file.sync_all()
        };
        write().map_err(|error| WriteError::File { path: path.clone(), error })
    }

    /// Gives all staged files their names, replacing the files of an earlier run, and returns the paths in the order of
    /// staging.
    ///
    /// # Errors
    /// [`WriteError::File`], should the system refuse to rename.
    pub fn publish(mut self) -> Result<Vec<PathBuf>, WriteError> {
        for Staged { temporary, path } in &self.staged {
            fs::rename(temporary, path)
                .map_err(|error| WriteError::File { path: path.clone(), error })?;
        }
        self.made.clear();
        Ok(self.staged.drain(..).map(|staged| staged.path).collect())
    }
}

/// Tidies up after a run that did not come to [`Output::publish`]. What cannot be removed stays: the failure that led
/// here is the one to report.
impl Drop for Output {
    fn drop(&mut self) {
        for staged in &self.staged {
            let _ = fs::remove_file(&staged.temporary);
        }
        for folder in &self.made {
            let _ = fs::remove_dir(folder);
        }
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

        /// The names of all that is in the folder.
        fn names(&self) -> Vec<String> {
            let entry = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name();
            let mut names: Vec<String> =
                fs::read_dir(&self.0).unwrap().map(|e| entry(e).into_string().unwrap()).collect();
            names.sort();
            names
        }
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn files_appear_together_when_published() {
        let scratch = Scratch::new("together");
        let folder = scratch.0.join("new/case");
        let mut output = Output::new(&folder).unwrap();
        output.stage("a.txt", b"first").unwrap();
        output.stage("b.txt", b"second").unwrap();
        assert!(!folder.join("a.txt").exists());
        let paths = output.publish().unwrap();
        assert_eq!(paths, [folder.join("a.txt"), folder.join("b.txt")]);
        assert_eq!(fs::read(&paths[0]).unwrap(), b"first");
        assert_eq!(fs::read(&paths[1]).unwrap(), b"second");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
    }

    #[test]
    fn a_run_that_stops_leaves_neither_files_nor_folders() {
        let scratch = Scratch::new("stops");
        let mut output = Output::new(scratch.0.join("new/case")).unwrap();
        output.stage("a.txt", b"first").unwrap();
        drop(output);
        assert!(scratch.names().is_empty());
    }

    #[test]
    fn a_file_that_cannot_be_written_leaves_the_earlier_run_untouched() {
        let scratch = Scratch::new("earlier");
        fs::write(scratch.0.join("a.txt"), b"earlier").unwrap();
        fs::create_dir(scratch.0.join("b.txt")).unwrap();
        let mut output = Output::new(&scratch.0).unwrap();
        output.stage("a.txt", b"later").unwrap();
        let error = output.stage("b.txt", b"later").unwrap_err();
        let place = scratch.0.join("b.txt");
        assert_eq!(error.to_string(), format!("cannot write {}: is a directory", place.display()));
        drop(output);
        assert_eq!(scratch.names(), ["a.txt", "b.txt"]);
        assert_eq!(fs::read(scratch.0.join("a.txt")).unwrap(), b"earlier");
    }

    #[test]
    fn a_published_file_replaces_the_one_of_an_earlier_run() {
        let scratch = Scratch::new("replaces");
        for text in ["earlier", "now"] {
            let mut output = Output::new(&scratch.0).unwrap();
            output.stage("a.txt", text.as_bytes()).unwrap();
            output.publish().unwrap();
        }
        assert_eq!(fs::read(scratch.0.join("a.txt")).unwrap(), b"now");
    }

    #[test]
    fn a_folder_below_a_file_is_refused_by_name() {
        let scratch = Scratch::new("below");
        let file = scratch.0.join("file");
        fs::write(&file, b"").unwrap();
        let folder = file.join("case");
        let error = Output::new(&folder).unwrap_err();
        let expected = format!("cannot make the folder {}: Not a directory", folder.display());
        assert_eq!(error.to_string(), expected);
        let error = Output::new(&file).unwrap_err();
        let expected = format!("cannot make the folder {}: File exists", file.display());
        assert_eq!(error.to_string(), expected);
        assert_eq!(scratch.names(), ["file"]);
    }
}
