//! Files that are read: regular ones only, and no more of them than can be of use. A pipe would be waited for, a device such
//! as /dev/zero never ends.

use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::Path;

use thiserror::Error;

use crate::memory::{self, OutOfMemory};

/// The longest case file. A case for people has some thousand bytes.
pub const MOST_OF_A_CASE: u64 = 16 << 20;

/// The longest mesh file: more nodes than a factorisation in the memory of one machine has room for.
pub const MOST_OF_A_MESH: u64 = 4 << 30;

/// Why a file or a stream is not read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum InputError {
    #[error("{0}")]
    Unreadable(String),
    #[error("this is {0}; expected a file")]
    NotAFile(&'static str),
    #[error("this has more than {most} bytes; expected at most that many")]
    TooLong { most: u64 },
    #[error("{0}")]
    OutOfMemory(#[from] OutOfMemory),
    #[error("{0}")]
    Lack(String),
}

impl InputError {
    /// Returns whether the file may be right, but the system has not what it takes to read it: memory, or files to open.
    pub fn is_lack(&self) -> bool {
        matches!(self, InputError::OutOfMemory(_) | InputError::Lack(_))
    }
}

/// The bytes of a regular file of at most `most` bytes.
///
/// # Errors
/// As the variants of [`InputError`] say.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, InputError> {
    // Before it is opened, for to open a pipe is to wait for its other end.
    regular(&fs::metadata(path).map_err(unreadable)?)?;
    let file = File::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    regular(&metadata)?;
    if metadata.len() > most {
        return Err(InputError::TooLong { most });
    }
    memory::check(metadata.len())?;
    let mut bytes = Vec::new();
    // Exactly, where growing would take up to twice as much; what the file announces is not more than it has now.
    if let Ok(length) = usize::try_from(metadata.len())
        && bytes.try_reserve_exact(length + 1).is_err()
    {
        return Err(OutOfMemory { needed: metadata.len(), available: None }.into());
    }
    read_into(bytes, file, most)
}

/// All bytes of a stream (standard input, say), at most `most`.
///
/// # Errors
/// As [`read`].
pub fn read_from(stream: impl Read, most: u64) -> Result<Vec<u8>, InputError> {
    read_into(Vec::new(), stream, most)
}

fn read_into(mut bytes: Vec<u8>, stream: impl Read, most: u64) -> Result<Vec<u8>, InputError> {
    stream.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > most { Err(InputError::TooLong { most }) } else { Ok(bytes) }
}

/// Refuses what is no regular file.
///
/// # Errors
/// [`InputError::NotAFile`].
pub fn regular(metadata: &Metadata) -> Result<(), InputError> {
    if metadata.is_file() { Ok(()) } else { Err(InputError::NotAFile(kind(metadata))) }
}

fn kind(metadata: &Metadata) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = metadata.file_type();
        if kind.is_fifo() {
            return "a pipe";
        }
        if kind.is_socket() {
            return "a socket";
        }
        if kind.is_char_device() || kind.is_block_device() {
            return "a device";
        }
    }
    if metadata.is_dir() { "a directory" } else { "no regular file" }
}

/// Why a file can't be read, in words that don't depend on the system where that is possible.
fn unreadable(error: io::Error) -> InputError {
    // ENFILE and EMFILE, which have no kind.
    if matches!(error.raw_os_error(), Some(23 | 24)) && cfg!(unix) {
        return InputError::Lack(super::files::reason(&error));
    }
    InputError::Unreadable(match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        io::ErrorKind::IsADirectory => return InputError::NotAFile("a directory"),
        io::ErrorKind::PermissionDenied => "there is no permission to read this file".to_owned(),
        io::ErrorKind::OutOfMemory => {
            return InputError::Lack("there is not enough memory to read this file".to_owned());
        }
        _ => super::files::reason(&error),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_without_end_is_read_to_the_limit_and_no_further() {
        assert_eq!(read_from(io::repeat(0), 1000), Err(InputError::TooLong { most: 1000 }));
        assert_eq!(read_from(io::repeat(7).take(1000), 1000), Ok(vec![7; 1000]));
    }

    #[cfg(unix)]
    #[test]
    fn too_many_open_files_are_a_lack_and_a_missing_file_is_none() {
        for (number, is_lack) in [(23, true), (24, true), (2, false), (13, false)] {
            assert_eq!(unreadable(io::Error::from_raw_os_error(number)).is_lack(), is_lack);
        }
    }

    #[test]
    fn a_directory_is_no_file() {
        let error = read(&std::env::temp_dir(), 1).unwrap_err();
        assert_eq!(error.to_string(), "this is a directory; expected a file");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_no_file() {
        let error = read(Path::new("/dev/zero"), MOST_OF_A_MESH).unwrap_err();
        assert_eq!(error.to_string(), "this is a device; expected a file");
    }
}
