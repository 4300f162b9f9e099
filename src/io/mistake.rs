//! Errors in a case, with their places.

use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

use thiserror::Error;

use super::expression::ExpressionError;
use super::gmsh::GmshError;
use super::input::InputError;
use crate::fem::MeshError;
use crate::fem::material::MaterialError;
use crate::quote::{self, quoted};

/// An error in a case file, with its place.
#[derive(Debug, Error)]
#[error("{}{place}: {mistake}", quote::path(file))]
#[non_exhaustive]
pub struct CaseError {
    /// The case file.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// The error.
    pub mistake: Box<CaseMistake>,
}

/// A place in a case. It is shown so that it may follow the name of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line, from 1.
    Line(usize),
    /// Not the file, but this setting over it.
    Setting(String),
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Line(line) => write!(f, ":{line}"),
            Place::Setting(setting) => write!(f, " with --set {}", quote::cut(setting)),
        }
    }
}

/// An error in a case file. `name` is a key as messages show it: `[mesh] rectangle.nx`.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
pub enum CaseMistake {
    #[error("{0}")]
    Input(#[from] InputError),
    #[error("byte {byte} is not UTF-8; expected a text file, saved as UTF-8")]
    NoText { byte: usize },
    #[error("invalid TOML{at}: {said}")]
    Toml { at: String, said: String },
    #[error("unknown key {key}{}; expected {known}", within(place))]
    Unknown { key: String, place: String, known: String },
    #[error("{name} is missing; expected {expected}")]
    Missing { name: String, expected: String },
    #[error("{name} = {found}; expected {expected}")]
    Value { name: String, found: String, expected: String },
    #[error("{name}: found {found}; expected {expected}")]
    Combination { name: String, found: String, expected: String },
    #[error("{name} = {text}: {error}")]
    Expression { name: String, text: String, error: ExpressionError },
    #[error("{name}: {error}")]
    Mesh { name: String, error: MeshError },
    #[error("{name}: {error}")]
    Material { name: String, error: MaterialError },
    #[error("[mesh] gmsh: {0}")]
    Gmsh(GmshError),
    #[error("found no key with a value; expected KEY=VALUE, such as method.gamma0=1e-3")]
    NoSetting,
    #[error(
        "{} is a list, whose entries have no keys; expected all of it: {}=[...]",
        quoted(list, '\''),
        quote::cut(list)
    )]
    InList { list: String },
}

impl CaseError {
    /// Returns whether the case may be right, but the system has not the memory or the files that it takes to read it.
    pub fn is_lack(&self) -> bool {
        match &*self.mistake {
            CaseMistake::Input(error) => error.is_lack(),
            CaseMistake::Mesh { error: MeshError::OutOfMemory(_), .. } => true,
            CaseMistake::Gmsh(error) => error.is_lack(),
            _ => false,
        }
    }
}

fn within(place: &str) -> String {
    if place.is_empty() { String::new() } else { format!(" in {place}") }
}

/// The TOML reader's message, and the words of the file that it is about.
pub(super) fn no_toml(error: &toml::de::Error, text: &str) -> CaseMistake {
    let found = error.span().and_then(|span| text.get(span)).map_or("", str::trim);
    let starts = |m: &str, starts: &[&str]| starts.iter().any(|start| m.starts_with(start));
    let said = match error.message() {
        _ if text.starts_with("$MeshFormat") => {
            "this is a Gmsh mesh; expected a case file, which names it: [mesh] gmsh = \"FILE.msh\"".to_owned()
        }
        _ if starts(text.trim_start(), &["{", "<"]) => {
            "this is a JSON or an XML file; expected a case file in TOML".to_owned()
        }
        _ if found.contains(['\u{201c}', '\u{201d}', '\u{2018}', '\u{2019}']) => {
            "expected straight quotes (\") around a text".to_owned()
        }
        m if m.starts_with("string values must be quoted") && found.contains("//") => {
            "expected a value; a comment begins with #".to_owned()
        }
        m if m.starts_with("string values must be quoted")
            && found.starts_with(|c: char| c.is_ascii_digit() || c == '-') =>
        {
            "expected a number, without a unit ([units] names the units)".to_owned()
        }
        m if m.starts_with("missing comma between array elements") => {
            "expected ',' or ']'; is a list or a text above not closed?".to_owned()
        }
        m if m.starts_with("key with no value") => "expected KEY = VALUE".to_owned(),
        m if m.starts_with("missing escaped value") => {
            "a backslash in \"...\" begins an escape; expected '/' in a path, or the text in '...'".to_owned()
        }
        m if m.starts_with("invalid mantissa") => {
            "expected a digit before the decimal point (0.5, not .5)".to_owned()
        }
        // It says so where there is no value at all, too.
        m if m.starts_with("string values must be quoted") => {
            "expected a value; a text must be in quotes".to_owned()
        }
        m if starts(m, &["invalid float", "unexpected key or value", "unexpected leading zero"]) =>
        {
            "expected a value; an expression must be in quotes (\"0.1 - x\"), a list in brackets, and decimals have a point (0.5, not 0,5)".to_owned()
        }
        m => m.replace('\n', ", "),
    };
    let at = match found {
        "" => String::new(),
        found => format!(" at {}", quoted(found, '\'')),
    };
    CaseMistake::Toml { at, said }
}
