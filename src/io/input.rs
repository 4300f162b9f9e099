//! Reading of files: regular ones only, up to a size that can be of use. A pipe would block, and a device such as /dev/zero
//! never ends.

use std::fmt::{self, Display, Formatter};
use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::memory::{self, OutOfMemory};
use crate::model::MeshError;
use crate::quote;

/// The longest case file. A case for people has some thousand bytes.
pub(crate) const MOST_OF_A_CASE: u64 = 16 << 20;

/// The longest mesh file: more nodes than a factorisation in the memory of one machine has room for.
pub(crate) const MOST_OF_A_MESH: u64 = 4 << 30;

/// A position in an input, written to follow the name of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Position {
    /// The file as a whole.
    File,
    /// A line of a text, from 1.
    Line(usize),
    /// A byte of a binary file, from 0.
    Byte(usize),
    /// Not the file, but this setting over it.
    Setting(String),
}

impl Position {
    /// The line in which a byte of a text stands.
    pub(crate) fn line_of(byte: usize, text: &[u8]) -> Position {
        Position::Line(text.iter().take(byte).filter(|&&b| b == b'\n').count() + 1)
    }
}

impl Display for Position {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            Position::File => Ok(()),
            Position::Line(line) => write!(f, ":{line}"),
            Position::Byte(byte) => write!(f, ", byte {byte}"),
            Position::Setting(setting) => write!(f, " with --set {}", quote::cut(setting)),
        }
    }
}

/// The reason why there is no result of an input.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{message}")]
pub struct Failure {
    message: String,
    is_wrong: bool,
}

impl Failure {
    /// The input is wrong.
    pub fn wrong(error: impl Display) -> Failure {
        Failure::new(true, error)
    }

    /// The input may be right, but there is no result of it here: memory or files to open are lacking, or a method fails.
    pub fn failed(error: impl Display) -> Failure {
        Failure::new(false, error)
    }

    /// The one or the other.
    pub fn new(is_wrong: bool, error: impl Display) -> Failure {
        Failure { message: error.to_string(), is_wrong }
    }

    /// Returns whether the input is wrong.
    pub fn is_wrong(&self) -> bool {
        self.is_wrong
    }

    /// Puts words around the message.
    pub fn map(self, words: impl FnOnce(String) -> String) -> Failure {
        Failure { message: words(self.message), ..self }
    }

    /// Names the file that it is about.
    #[must_use]
    pub fn of(self, file: &Path) -> Failure {
        self.map(|message| format!("{}: {message}", quote::path(file)))
    }

    /// Places the error in a file.
    pub(super) fn at(self, file: &Path, position: Position) -> FileError {
        FileError { file: file.to_owned(), position, error: self }
    }
}

impl From<String> for Failure {
    fn from(message: String) -> Failure {
        Failure::wrong(message)
    }
}

impl From<&str> for Failure {
    fn from(message: &str) -> Failure {
        Failure::wrong(message)
    }
}

impl From<OutOfMemory> for Failure {
    fn from(lack: OutOfMemory) -> Failure {
        Failure::failed(lack)
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Failure {
        Failure::new(!matches!(error, MeshError::OutOfMemory(_)), error)
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Failure {
        Failure::new(error.error.is_wrong, error)
    }
}

/// A mistake in a file (a case, a mesh or a field), with its position.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{}{position}: {error}", quote::path(file))]
#[non_exhaustive]
pub struct FileError {
    /// The file.
    pub file: PathBuf,
    /// The position in it.
    pub position: Position,
    /// The error.
    pub error: Failure,
}

/// The bytes of a regular file of at most `most` bytes.
pub(crate) fn read(path: &Path, most: u64) -> Result<Vec<u8>, FileError> {
    bytes_of(path, most).map_err(|error| error.at(path, Position::File))
}

fn bytes_of(path: &Path, most: u64) -> Result<Vec<u8>, Failure> {
    // Before it is opened, for to open a pipe is to wait for its other end.
    regular(&fs::metadata(path).map_err(unreadable)?)?;
    let file = File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    if length > most {
        return Err(too_long(most));
    }
    // At once, where growing would take up to twice as much.
    let mut bytes = Vec::new();
    memory::reserve(&mut bytes, usize::try_from(length).unwrap_or(usize::MAX))?;
    read_into(bytes, file, most)
}

/// All bytes of a stream (standard input, say), at most `most`.
#[cfg(feature = "files")]
pub(super) fn read_from(stream: impl Read, most: u64) -> Result<Vec<u8>, Failure> {
    read_into(Vec::new(), stream, most)
}

fn read_into(mut bytes: Vec<u8>, stream: impl Read, most: u64) -> Result<Vec<u8>, Failure> {
    stream.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > most { Err(too_long(most)) } else { Ok(bytes) }
}

fn too_long(most: u64) -> Failure {
    format!("this has more than {most} bytes; expected at most that many").into()
}

/// Refuses a file that is not regular.
fn regular(metadata: &Metadata) -> Result<(), Failure> {
    match (metadata.is_file(), metadata.is_dir()) {
        (true, _) => Ok(()),
        (_, true) => Err(DIRECTORY.into()),
        _ => Err("this is a pipe, a socket or a device; expected a file".into()),
    }
}

const DIRECTORY: &str = "this is a directory; expected a file";

/// The reason in words, without the system's number.
pub(crate) fn reason(error: &io::Error) -> String {
    if error.kind() == io::ErrorKind::AlreadyExists {
        return "a file of this name is there; choose another folder: --out DIR".to_owned();
    }
    let text = error.to_string();
    text.split(" (os error ").next().unwrap_or_default().to_owned()
}

/// Says why a file can't be read, in words that don't depend on the system where that is possible.
fn unreadable(error: io::Error) -> Failure {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".into(),
        io::ErrorKind::IsADirectory => DIRECTORY.into(),
        io::ErrorKind::PermissionDenied => "there is no permission to read this file".into(),
        io::ErrorKind::OutOfMemory => {
            Failure::failed("there is not enough memory to read this file")
        }
        // ENFILE and EMFILE have no kind.
        _ => Failure::new(!matches!(error.raw_os_error(), Some(23 | 24)), reason(&error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_without_end_is_read_to_the_limit_and_no_further() {
        assert_eq!(read_from(io::repeat(0), 1000), Err(too_long(1000)));
        assert_eq!(read_from(io::repeat(7).take(1000), 1000), Ok(vec![7; 1000]));
    }

    #[cfg(unix)]
    #[test]
    fn too_many_open_files_are_a_lack_and_a_missing_file_is_none() {
        for (number, is_wrong) in [(23, false), (24, false), (2, true), (13, true)] {
            assert_eq!(unreadable(io::Error::from_raw_os_error(number)).is_wrong(), is_wrong);
        }
    }
}
