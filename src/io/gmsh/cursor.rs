//! Reading from the bytes of a file: words and numbers, text or binary, with the place of what is wrong.

use std::ops::RangeInclusive;
use std::path::Path;
use std::str::FromStr;

use super::Result;
use crate::io::input::{Failure, FileError, Position};
use crate::memory;
use crate::quote::{self, quoted};

/// The version of the format.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Version {
    /// 4.1
    Four,
    /// 2.0, 2.1 and 2.2
    Two,
}

/// A place in the bytes of a file, and what can be read from there on.
pub(super) struct Cursor<'b> {
    pub(super) bytes: &'b [u8],
    pub(super) file: &'b Path,
    pub(super) at: usize,
    pub(super) version: Version,
    /// Numbers are written as bytes.
    pub(super) binary: bool,
}

impl<'b> Cursor<'b> {
    /// The heading of the next section without its $, and where it stands; `None` at the end of the file.
    pub(super) fn section(&mut self) -> Result<Option<(usize, &'b str)>> {
        self.skip_white_space();
        if self.at == self.bytes.len() {
            return Ok(None);
        }
        let (start, line) = self.line();
        match line.strip_prefix(b"$").map(std::str::from_utf8) {
            Some(Ok(section)) => Ok(Some((start, section))),
            _ => Err(self.unexpected(start, &shown(line), "a section such as $Nodes")),
        }
    }

    /// Reads the end of a section.
    pub(super) fn end_of(&mut self, section: &str) -> Result<()> {
        let expected = end_of(section);
        self.skip_white_space();
        if self.at == self.bytes.len() {
            return Err(self.cut_short(&expected));
        }
        let (start, line) = self.line();
        if line.strip_prefix(b"$End") == Some(section.as_bytes()) {
            Ok(())
        } else {
            Err(self.unexpected(start, &shown(line), &expected))
        }
    }

    /// Goes to the end of a section that doesn't matter.
    pub(super) fn skip_to_end_of(&mut self, section: &str) -> Result<()> {
        let end = format!("$End{section}");
        let rest = self.rest();
        match rest.windows(end.len()).position(|w| w == end.as_bytes()) {
            Some(skipped) => {
                self.at += skipped;
                Ok(())
            }
            None => {
                self.at = self.bytes.len();
                Err(self.cut_short(&end_of(section)))
            }
        }
    }

    /// The rest of this line, without the white space around it, and where it starts.
    pub(super) fn line(&mut self) -> (usize, &'b [u8]) {
        let (start, rest) = (self.at, self.rest());
        let length = rest.iter().position(|&b| b == b'\n');
        self.at += length.map_or(rest.len(), |length| length + 1);
        (start, rest[..length.unwrap_or(rest.len())].trim_ascii())
    }

    /// The next word, and where it starts.
    pub(super) fn word(&mut self, expected: &str) -> Result<(usize, &'b [u8])> {
        self.skip_white_space();
        let (start, rest) = (self.at, self.rest());
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        match &rest[..length] {
            [] => Err(self.cut_short(expected)),
            word => Ok((start, word)),
        }
    }

    /// The next word as a number.
    pub(super) fn number<T: FromStr>(&mut self, expected: &str) -> Result<T> {
        let (start, word) = self.word(expected)?;
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| self.unexpected(start, &shown(word), expected))
    }

    /// The next bytes.
    pub(super) fn take<const N: usize>(&mut self, expected: &str) -> Result<[u8; N]> {
        match self.rest().first_chunk() {
            Some(&bytes) => {
                self.at += N;
                Ok(bytes)
            }
            None => {
                self.at = self.bytes.len();
                Err(self.cut_short(expected))
            }
        }
    }

    pub(super) fn int(&mut self, expected: &str) -> Result<i32> {
        if self.binary {
            self.take(expected).map(i32::from_le_bytes)
        } else {
            self.number(expected)
        }
    }

    pub(super) fn int_within(&mut self, range: RangeInclusive<i32>, expected: &str) -> Result<i32> {
        let start = self.here();
        let number = self.int(expected)?;
        if range.contains(&number) {
            Ok(number)
        } else {
            Err(self.unexpected(start, &number.to_string(), expected))
        }
    }

    /// A tag or a count: as bytes 4 or 8.
    pub(super) fn size(&mut self, expected: &str) -> Result<usize> {
        let start = self.here();
        let number = match (self.binary, self.version) {
            (false, _) => return self.number(expected),
            (true, Version::Two) => self.take(expected).map(i32::from_le_bytes)?.into(),
            (true, Version::Four) => i128::from(self.take(expected).map(u64::from_le_bytes)?),
        };
        let unexpected = |_| self.unexpected(start, &number.to_string(), expected);
        usize::try_from(number).map_err(unexpected)
    }

    /// A count on a line of its own, which is text in a binary file, too.
    pub(super) fn count(&mut self, expected: &str) -> Result<usize> {
        let binary = std::mem::replace(&mut self.binary, false);
        let count = self.size(expected);
        self.binary = binary;
        if binary {
            self.line();
        }
        count
    }

    pub(super) fn double(&mut self, expected: &str) -> Result<f64> {
        if self.binary {
            self.take(expected).map(f64::from_le_bytes)
        } else {
            self.number(expected)
        }
    }

    /// Finds the start of the next number.
    pub(super) fn here(&mut self) -> usize {
        if !self.binary {
            self.skip_white_space();
        }
        self.at
    }

    /// As many items as are announced, or as many as the rest of the file can hold if those are fewer.
    pub(super) fn at_most(&self, announced: usize) -> usize {
        // A digit and the space after it.
        const LEAST: usize = 2;
        announced.min(self.rest().len() / LEAST)
    }

    /// Makes room for as many items as are announced and the file can hold.
    pub(super) fn make_room<T>(&self, list: &mut Vec<T>, announced: usize) -> Result<()> {
        memory::reserve(list, self.at_most(announced)).map_err(|lack| self.in_the_file(lack))
    }

    fn skip_white_space(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_ascii_start().len();
    }

    pub(super) fn rest(&self) -> &'b [u8] {
        &self.bytes[self.at..]
    }

    pub(super) fn unexpected(&self, start: usize, found: &str, expected: &str) -> FileError {
        self.wrong_at(start, format!("found {found}, expected {expected}"))
    }

    fn cut_short(&self, expected: &str) -> FileError {
        let said = format!("the file ends, expected {expected}: it is cut short");
        self.wrong_at(self.bytes.len(), said)
    }

    pub(super) fn wrong_at(&self, start: usize, said: String) -> FileError {
        let place = match self.binary {
            false => Position::line_of(start, self.bytes),
            true => Position::Byte(start),
        };
        Failure::from(said).at(self.file, place)
    }

    /// An error that concerns the file as a whole.
    pub(super) fn in_the_file(&self, error: impl Into<Failure>) -> FileError {
        error.into().at(self.file, Position::File)
    }
}

/// The line that ends a section, as messages show it: its name is one of the file.
pub(super) fn end_of(section: &str) -> String {
    format!("$End{}", quote::cut(section))
}

pub(super) fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    match bytes {
        [] => "nothing".to_owned(),
        _ => quoted(&String::from_utf8_lossy(&bytes[..bytes.len().min(MOST)]), '\''),
    }
}
