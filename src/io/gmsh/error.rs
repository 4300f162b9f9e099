//! Errors in a mesh file, with their places.

use std::fmt;
use std::path::PathBuf;

use thiserror::Error;

use crate::fem::MeshError;
use crate::io::input::InputError;
use crate::memory::OutOfMemory;
use crate::quote;

/// Why a file gives no mesh, and where.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{}{place}: {mistake}", quote::path(file))]
#[non_exhaustive]
pub struct GmshError {
    /// The mesh file.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// The error.
    pub mistake: Box<GmshMistake>,
}

/// A place in a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, from 1.
    Line(usize),
    /// A byte of a binary file, from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Line(line) => write!(f, ":{line}"),
            Place::Byte(byte) => write!(f, ", byte {byte}"),
        }
    }
}

/// An error in a mesh file. Nodes, elements, curves and physical groups go by their tags.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum GmshMistake {
    #[error("{0}")]
    Input(#[from] InputError),
    // Without its words: a case of somebody else may name a file that is none of his business.
    #[error(
        "this is no Gmsh mesh: expected $MeshFormat on its first line; gmsh -2 PART.geo makes PART.msh from a geometry"
    )]
    NotGmsh,
    #[error(
        "the version of the format is {version}; expected '4.1' or '2.2': export the mesh with gmsh -format msh41"
    )]
    Version { version: String },
    #[error("found {found}, expected {expected}")]
    Unexpected { found: String, expected: String },
    #[error("the file ends, expected {expected}: it is cut short")]
    CutShort { expected: String },
    #[error(
        "there is no section ${section}; expected MSH 4.1 with $Entities, $Nodes and $Elements"
    )]
    NoSection { section: &'static str },
    #[error("there is a second section ${section}; expected one")]
    SectionTwice { section: String },
    #[error("there is a second node {node}; expected a tag of its own for each node")]
    NodeTwice { node: usize },
    #[error("node {node} has z = {}; expected a mesh in the plane z = 0", quote::number(*z))]
    OutOfPlane { node: usize, z: f64 },
    #[error("element {element} is a {kind} (type {number}); expected {expected}")]
    ElementKind { element: usize, kind: &'static str, number: i32, expected: &'static str },
    #[error("element {element} names node {node}, which is not in $Nodes")]
    NoSuchNode { element: usize, node: usize },
    #[error("element {element} lies on {kind} {entity}, which is not in $Entities")]
    NoSuchEntity { element: usize, kind: &'static str, entity: i32 },
    #[error(
        "physical curve {physical} has no name; expected one, as in Physical Curve(\"floor\", {physical}) = {{{curve}}};"
    )]
    Unnamed { physical: i32, curve: i32 },
    #[error(
        "{kind} {entity} belongs to the physical {kind}s {names}; expected it in one of them only"
    )]
    SeveralNames { kind: &'static str, entity: i32, names: String },
    #[error(
        "element {element} is curved: the middle node {node} of its edge lies {off:e} of the edge's length off the middle; expected straight edges: mesh finer with element order 1 (Mesh.ElementOrder = 1), the smooth boundary is found from the vertices"
    )]
    Curved { element: usize, node: usize, off: f64 },
    #[error("{0}")]
    OutOfMemory(#[from] OutOfMemory),
    #[error("{error} ({note})")]
    Mesh { error: MeshError, note: &'static str },
}

impl GmshError {
    /// Returns whether the file may be right, but the system has not the memory or the files that it takes to read it.
    pub fn is_lack(&self) -> bool {
        match &*self.mistake {
            GmshMistake::Input(error) => error.is_lack(),
            GmshMistake::OutOfMemory(_)
            | GmshMistake::Mesh { error: MeshError::OutOfMemory(_), .. } => true,
            _ => false,
        }
    }
}
