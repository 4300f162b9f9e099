//! Meshes from Gmsh: the formats MSH 4.1 and 2.2, text or binary, of either byte order. Here is 4.1 and what both share;
//! what 2.2 writes otherwise is in `msh2`.
//!
//! A file is a list of sections, `$Name` .. `$EndName`. Four matter here; the others are skipped:
//!
//! | section | what is taken from it |
//! | --- | --- |
//! | `$PhysicalNames` | the names of the physical points, curves and surfaces |
//! | `$Entities` | which point, curve or surface belongs to which physical group |
//! | `$Nodes` | the vertices; those that are no corner of a triangle (the centre of an arc) are left out |
//! | `$Elements` | triangles: the body, by physical surface; lines on physical curves: the boundary parts; physical points |
//!
//! Elements of second order are read as those of first order if their edges are straight, and refused if they are curved.
//!
//! The format is described in the Gmsh reference manual, section "MSH file format". In a binary file an `int` has 4
//! bytes, a `size_t` and a `double` have 8; in a text file all are words between white space. Nothing is allocated because
//! a file announces it, only because it is there.

mod msh2;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use thiserror::Error;

use super::input::{self, InputError, MOST_OF_A_MESH};
use crate::fem::merge::merge;
use crate::fem::{Mesh, MeshError};
use crate::memory::{self, OutOfMemory, bytes_of};
use crate::quote::{self, quoted};

/// Why a file gives no mesh, and where.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{}{place}: {mistake}", quote::path(file))]
#[non_exhaustive]
pub struct GmshError {
    /// The mesh file.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What is wrong.
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

/// What is wrong with a mesh file. Nodes, elements, curves and physical groups go by their tags.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
pub enum GmshMistake {
    #[error("{0}")]
    Input(#[from] InputError),
    // Without its words: a case of somebody else may name a file that is none of his business.
    #[error("this is no Gmsh mesh: expected $MeshFormat on its first line")]
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
    /// The file may be right, but there is not enough memory to read it.
    pub fn is_lack_of_memory(&self) -> bool {
        matches!(
            *self.mistake,
            GmshMistake::Input(InputError::OutOfMemory(_))
                | GmshMistake::OutOfMemory(_)
                | GmshMistake::Mesh { error: MeshError::OutOfMemory(_), .. }
        )
    }
}

type Result<T> = std::result::Result<T, GmshError>;

/// The mesh in this file.
///
/// # Errors
/// The first mistake found, with its place and the numbers that the file uses.
pub fn read(file: &Path) -> Result<Mesh> {
    from_bytes(&read_bytes(file)?, file)
}

/// The mesh in this file, its nodes merged that are no further apart than `share` of the body's size.
///
/// # Errors
/// As [`read`].
pub fn read_merged(file: &Path, share: f64) -> Result<Mesh> {
    let bytes = read_bytes(file)?;
    let mut cursor = Cursor { bytes: &bytes, file, at: 0, form: Form::Text };
    let mut content = read_sections(&mut cursor)?;
    merge_nodes(&mut content, share);
    make_mesh(content).map_err(|mistake| cursor.wrong(Place::File, mistake))
}

fn read_bytes(file: &Path) -> Result<Vec<u8>> {
    input::read(file, MOST_OF_A_MESH).map_err(|error| GmshError {
        file: file.to_owned(),
        place: Place::File,
        mistake: Box::new(GmshMistake::Input(error)),
    })
}

/// The mesh in `bytes`, which messages call `file`.
///
/// # Errors
/// As [`read`].
pub fn from_bytes(bytes: &[u8], file: &Path) -> Result<Mesh> {
    let mut cursor = Cursor { bytes, file, at: 0, form: Form::Text };
    // Names and entities: what is kept of one is no more than this many times what the file says of it.
    const MOST_TIMES: u64 = 4;
    let lack = |lack: OutOfMemory| cursor.wrong(Place::File, lack.into());
    memory::check(MOST_TIMES * bytes.len() as u64).map_err(lack)?;
    let content = read_sections(&mut cursor)?;
    make_mesh(content).map_err(|mistake| cursor.wrong(Place::File, mistake))
}

/// Something for points, curves and surfaces each.
type ByDimension<T> = [T; 3];

/// What messages call the entities of a dimension.
const KINDS: ByDimension<&str> = ["point", "curve", "surface"];

/// What the sections say, in the tags of the file.
struct Content {
    /// The names of the physical groups.
    names: ByDimension<BTreeMap<i32, String>>,
    /// The physical groups of each entity.
    groups: ByDimension<BTreeMap<i32, Vec<i32>>>,
    nodes: Vec<Node>,
    elements: Elements,
}

struct Node {
    tag: usize,
    place: [f64; 2],
}

#[derive(Default)]
struct Elements {
    points: Vec<Piece<1>>,
    lines: Vec<Piece<2>>,
    triangles: Vec<Piece<3>>,
    /// The middle nodes of edges of second order, with the element and the ends of the edge.
    middles: Vec<Middle>,
}

/// An element by its corners, on an entity of its dimension.
struct Piece<const N: usize> {
    tag: usize,
    nodes: [usize; N],
    entity: i32,
}

struct Middle {
    element: usize,
    node: usize,
    ends: [usize; 2],
}

impl Elements {
    /// Reads the nodes of the element `tag` of type `number` on `entity`, if it is one of those in use.
    fn read(
        &mut self,
        cursor: &mut Cursor,
        start: usize,
        tag: usize,
        number: i32,
        entity: i32,
        node: impl Fn(&mut Cursor) -> Result<usize>,
    ) -> Result<()> {
        match number {
            POINT => {
                let nodes = [node(cursor)?];
                self.points.push(Piece { tag, nodes, entity });
            }
            LINE | LINE_OF_3 => {
                let nodes = [node(cursor)?, node(cursor)?];
                self.lines.push(Piece { tag, nodes, entity });
                if number == LINE_OF_3 {
                    self.middles.push(Middle { element: tag, node: node(cursor)?, ends: nodes });
                }
            }
            TRIANGLE | TRIANGLE_OF_6 => {
                let nodes = [node(cursor)?, node(cursor)?, node(cursor)?];
                self.triangles.push(Piece { tag, nodes, entity });
                if number == TRIANGLE_OF_6 {
                    let [a, b, c] = nodes;
                    for ends in [[a, b], [b, c], [c, a]] {
                        self.middles.push(Middle { element: tag, node: node(cursor)?, ends });
                    }
                }
            }
            _ => {
                let (kind, expected) = other_kind(number);
                let mistake = GmshMistake::ElementKind { element: tag, kind, number, expected };
                return Err(cursor.wrong_at(start, mistake));
            }
        }
        Ok(())
    }
}

fn read_sections(cursor: &mut Cursor) -> Result<Content> {
    if read_format(cursor)? == Version::Two {
        return msh2::read_sections(cursor);
    }
    let (mut names, mut groups, mut nodes, mut elements) = (None, None, None, None);
    while let Some((start, section)) = cursor.section()? {
        let first = match section {
            "PhysicalNames" => names.replace(read_names(cursor)?).is_none(),
            "Entities" => groups.replace(read_entities(cursor)?).is_none(),
            "Nodes" => nodes.replace(read_nodes(cursor)?).is_none(),
            "Elements" => elements.replace(read_elements(cursor)?).is_none(),
            _ => {
                cursor.skip_to_end_of(section)?;
                true
            }
        };
        if !first {
            let section = section.to_owned();
            return Err(cursor.wrong_at(start, GmshMistake::SectionTwice { section }));
        }
        cursor.end_of(section)?;
    }
    let missing = |section| cursor.wrong(Place::File, GmshMistake::NoSection { section });
    Ok(Content {
        names: names.unwrap_or_default(),
        groups: groups.ok_or_else(|| missing("Entities"))?,
        nodes: nodes.ok_or_else(|| missing("Nodes"))?,
        elements: elements.ok_or_else(|| missing("Elements"))?,
    })
}

/// `$MeshFormat`: version, text or binary, size of a `size_t`; in a binary file then the number 1.
fn read_format(cursor: &mut Cursor) -> Result<Version> {
    let (start, heading) = cursor.line();
    if heading != b"$MeshFormat" {
        return Err(cursor.wrong_at(start, GmshMistake::NotGmsh));
    }
    let (start, version) = cursor.word("the version of the format")?;
    let version = match version {
        b"4.1" => Version::Four,
        b"2.2" => Version::Two,
        _ => {
            let version = shown(version);
            return Err(cursor.wrong_at(start, GmshMistake::Version { version }));
        }
    };
    let binary = cursor.int_within(0..=1, "0 for a text file or 1 for a binary file")?;
    cursor.int_within(8..=8, "8, the size of a number")?;
    if binary == 1 {
        cursor.line();
        let start = cursor.at;
        cursor.form = match cursor.take("the number 1, which shows the order of the bytes")? {
            [1, 0, 0, 0] => Form::LittleEndian,
            [0, 0, 0, 1] => Form::BigEndian,
            other => {
                cursor.form = Form::LittleEndian;
                let found = format!("the bytes {other:?}");
                return Err(cursor.unexpected(start, found, "the number 1 in 4 bytes"));
            }
        };
    }
    cursor.end_of("MeshFormat")?;
    Ok(version)
}

/// Of the format.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    /// 4.1
    Four,
    /// 2.2
    Two,
}

/// `$PhysicalNames`, always text: a count; then dimension, tag and "name" on a line each.
fn read_names(cursor: &mut Cursor) -> Result<ByDimension<BTreeMap<i32, String>>> {
    let mut text = Cursor { form: Form::Text, ..*cursor };
    let count = text.size("the number of physical names")?;
    let mut names = <ByDimension<BTreeMap<i32, String>>>::default();
    for _ in 0..count {
        let dimension = text.int_within(0..=3, "a dimension from 0 to 3")?;
        let tag = text.int("the tag of a physical group")?;
        let (start, line) = text.line();
        let name = std::str::from_utf8(line).ok().map(str::trim);
        let name = name.and_then(|name| name.strip_prefix('"')?.strip_suffix('"'));
        let name = name.ok_or_else(|| {
            text.unexpected(start, shown(line), "the name of a physical group in quotes")
        })?;
        if let (Some(of_dimension), false) = (names.get_mut(dimension as usize), name.is_empty()) {
            of_dimension.insert(tag, name.to_owned());
        }
    }
    cursor.at = text.at;
    Ok(names)
}

/// `$Entities`: the counts of points, curves, surfaces and volumes; then of each the tag, the place (of a point) or the
/// box around it, the physical groups and (except of a point) what bounds it. Returns the groups.
fn read_entities(cursor: &mut Cursor) -> Result<ByDimension<BTreeMap<i32, Vec<i32>>>> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.size("a number of entities")?;
    }
    let mut all = <ByDimension<BTreeMap<i32, Vec<i32>>>>::default();
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let tag = cursor.int("the tag of an entity")?;
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                cursor.double("a coordinate of an entity")?;
            }
            let mut groups = Vec::new();
            for _ in 0..cursor.size("the number of physical groups of an entity")? {
                // A negative tag says that the group runs against the direction of the curve.
                groups.push(cursor.int("the tag of a physical group")?.saturating_abs());
            }
            if dimension > 0 {
                for _ in 0..cursor.size("the number of entities that bound this one")? {
                    cursor.int("the tag of an entity")?;
                }
            }
            if let Some(of_dimension) = all.get_mut(dimension) {
                of_dimension.insert(tag, groups);
            }
        }
    }
    Ok(all)
}

/// `$Nodes`: the number of blocks, three numbers of no use here; then in each block dimension and tag of an entity,
/// whether the nodes have parameters on it, how many nodes, their tags, and their coordinates and parameters.
fn read_nodes(cursor: &mut Cursor) -> Result<Vec<Node>> {
    const COORDINATE: &str = "a coordinate of a node";
    let blocks = read_block_count(cursor, "nodes")?;
    let mut nodes: Vec<Node> = Vec::new();
    for _ in 0..blocks {
        let dimension = cursor.int_within(0..=3, "a dimension from 0 to 3")?;
        cursor.int("the tag of an entity")?;
        let parametric = cursor.int_within(0..=1, "0 or 1 for nodes without or with parameters")?;
        let count = cursor.size("a number of nodes")?;
        let first = nodes.len();
        cursor.make_room(&mut nodes, count)?;
        for _ in 0..count {
            let tag = cursor.size("the tag of a node")?;
            nodes.push(Node { tag, place: [0.0; 2] });
        }
        for node in &mut nodes[first..] {
            node.place = [cursor.double(COORDINATE)?, cursor.double(COORDINATE)?];
            let start = cursor.here();
            let z = cursor.double(COORDINATE)?;
            if z != 0.0 {
                let node = node.tag;
                return Err(cursor.wrong_at(start, GmshMistake::OutOfPlane { node, z }));
            }
            for _ in 0..parametric * dimension {
                cursor.double("a parameter of a node")?;
            }
        }
    }
    Ok(nodes)
}

/// `$Elements`: the number of blocks, three numbers of no use here; then in each block dimension and tag of an entity,
/// the type of the elements, how many there are, and the tag and the nodes of each.
fn read_elements(cursor: &mut Cursor) -> Result<Elements> {
    const NODE: &str = "the tag of a node";
    let blocks = read_block_count(cursor, "elements")?;
    let mut elements = Elements::default();
    for _ in 0..blocks {
        cursor.int_within(0..=3, "a dimension from 0 to 3")?;
        let entity = cursor.int("the tag of an entity")?;
        let number = cursor.int("the type of the elements")?;
        let count = cursor.size("a number of elements")?;
        match number {
            LINE => cursor.make_room(&mut elements.lines, count)?,
            TRIANGLE => cursor.make_room(&mut elements.triangles, count)?,
            _ => {}
        }
        for _ in 0..count {
            let start = cursor.here();
            let tag = cursor.size("the tag of an element")?;
            elements.read(cursor, start, tag, number, entity, |cursor| cursor.size(NODE))?;
        }
    }
    Ok(elements)
}

fn read_block_count(cursor: &mut Cursor, of: &str) -> Result<usize> {
    let blocks = cursor.size(&format!("the number of blocks of {of}"))?;
    for what in ["number", "least tag", "greatest tag"] {
        cursor.size(&format!("the {what} of the {of}"))?;
    }
    Ok(blocks)
}

// The element types in use.
const LINE: i32 = 1;
const TRIANGLE: i32 = 2;
const POINT: i32 = 15;
// Their counterparts of second order.
const LINE_OF_3: i32 = 8;
const TRIANGLE_OF_6: i32 = 9;

/// What another element type is, and what to do about it.
fn other_kind(number: i32) -> (&'static str, &'static str) {
    const ORDER: &str = "2-node lines and 3-node triangles: export with element order 1";
    const TRIANGLES: &str = "3-node triangles: do not recombine the mesh";
    const PLANE: &str = "a plane mesh of 3-node triangles: mesh in two dimensions, gmsh -2";
    match number {
        3 => ("4-node quadrangle", TRIANGLES),
        4 => ("4-node tetrahedron", PLANE),
        5 => ("8-node hexahedron", PLANE),
        6 => ("6-node prism", PLANE),
        7 => ("5-node pyramid", PLANE),
        10 => ("9-node quadrangle", TRIANGLES),
        16 => ("8-node quadrangle", TRIANGLES),
        21 => ("10-node triangle", ORDER),
        26 => ("4-node line", ORDER),
        _ => ("kind of element that has no use here", "2-node lines and 3-node triangles"),
    }
}

// Notes on errors of the mesh.
const TAGS: &str = "the numbers are tags of the file";
const CLOCKWISE: &str =
    "the numbers are tags of the file; in Gmsh, turn the curve loop of the surface round";
const NO_TRIANGLE: &str =
    "mesh with gmsh -2, and where curves have a physical group, give the surface one too";

/// Gives the triangles and lines on nodes that lie together the first of these nodes, and leaves out what loses an edge by
/// it. Nodes that no triangle uses, and elements on nodes that are not there, stay as they are.
fn merge_nodes(content: &mut Content, share: f64) {
    let Elements { triangles, lines, points, .. } = &mut content.elements;
    let used: HashSet<usize> = triangles.iter().flat_map(|t| t.nodes).collect();
    let kept: Vec<&Node> = content.nodes.iter().filter(|node| used.contains(&node.tag)).collect();
    let places: Vec<[f64; 2]> = kept.iter().map(|node| node.place).collect();
    let merged = merge(&places, &[], share);
    let first: HashMap<usize, usize> = kept
        .iter()
        .zip(&merged.vertex)
        .map(|(node, &vertex)| (node.tag, kept[merged.old_vertex[vertex]].tag))
        .collect();
    let become_first = |tag: &mut usize| *tag = first.get(tag).copied().unwrap_or(*tag);
    triangles.iter_mut().flat_map(|t| &mut t.nodes).for_each(become_first);
    lines.iter_mut().flat_map(|line| &mut line.nodes).for_each(become_first);
    points.iter_mut().flat_map(|point| &mut point.nodes).for_each(become_first);
    triangles.retain(|t| {
        t.nodes[0] != t.nodes[1] && t.nodes[1] != t.nodes[2] && t.nodes[2] != t.nodes[0]
    });
    lines.retain(|line| line.nodes[0] != line.nodes[1]);
}

/// The mesh of the corners of triangles, in the order of the file.
fn make_mesh(content: Content) -> std::result::Result<Mesh, GmshMistake> {
    let Content { names, groups, nodes, elements } = content;
    let Elements { points, lines, triangles, middles } = elements;
    // Two maps from tags, which are at most half empty and twice as large for a moment while they grow; the lists.
    let maps = 3 * bytes_of::<[usize; 4]>(nodes.len()).saturating_mul(2);
    memory::check(maps.saturating_add(bytes_of::<[usize; 3]>(triangles.len())))?;
    let mut position = HashMap::new();
    for (i, node) in nodes.iter().enumerate() {
        if position.insert(node.tag, i).is_some() {
            return Err(GmshMistake::NodeTwice { node: node.tag });
        }
    }
    if triangles.is_empty() {
        return Err(GmshMistake::Mesh { error: MeshError::Empty, note: NO_TRIANGLE });
    }
    let find = |element, node| {
        position.get(&node).copied().ok_or(GmshMistake::NoSuchNode { element, node })
    };
    for Middle { element, node, ends: [a, b] } in middles {
        let [a, b, middle] = [find(element, a)?, find(element, b)?, find(element, node)?];
        check_straight(element, node, [a, b, middle].map(|i| nodes[i].place))?;
    }
    let mut used = vec![false; nodes.len()];
    for triangle in &triangles {
        for node in triangle.nodes {
            used[find(triangle.tag, node)?] = true;
        }
    }
    let kept: Vec<&Node> = nodes.iter().zip(&used).filter(|n| *n.1).map(|n| n.0).collect();
    let vertex_of: HashMap<usize, usize> =
        kept.iter().enumerate().map(|(vertex, node)| (node.tag, vertex)).collect();

    let [of_point, of_curve, of_surface] = name_entities(&names, groups)?;
    let [point_names, curve_names, surface_names] = names;
    let mut parts: BTreeMap<String, Vec<[usize; 2]>> =
        curve_names.into_values().map(|name| (name, Vec::new())).collect();
    for Piece { tag, nodes: [a, b], entity } in lines {
        find(tag, a)?;
        find(tag, b)?;
        let Some(name) = name_of(&of_curve, 1, tag, entity)? else { continue };
        let (Some(&first), Some(&second)) = (vertex_of.get(&a), vertex_of.get(&b)) else {
            return Err(GmshMistake::Mesh {
                error: MeshError::NoSuchEdge { boundary: name.clone(), vertices: [a, b] },
                note: TAGS,
            });
        };
        parts.entry(name.clone()).or_default().push([first, second]);
    }
    let mut surfaces: BTreeMap<String, Vec<usize>> =
        surface_names.into_values().map(|name| (name, Vec::new())).collect();
    for (t, &Piece { tag, entity, .. }) in triangles.iter().enumerate() {
        if let Some(name) = name_of(&of_surface, 2, tag, entity)? {
            surfaces.entry(name.clone()).or_default().push(t);
        }
    }
    let mut named_points = BTreeMap::new();
    if !point_names.is_empty() {
        for Piece { tag, nodes: [node], entity } in points {
            let name = name_of(&of_point, 0, tag, entity)?;
            if let (Some(name), Some(&vertex)) = (name, vertex_of.get(&node)) {
                named_points.insert(name.clone(), vertex);
            }
        }
    }

    let corners = triangles.iter().map(|t| t.nodes.map(|node| vertex_of[&node])).collect();
    let mesh = Mesh::new(kept.iter().map(|node| node.place).collect(), corners, parts);
    match mesh {
        Ok(mesh) => Ok(mesh.with_names(surfaces, named_points)),
        Err(error) => {
            let note = if matches!(error, MeshError::Clockwise { .. }) { CLOCKWISE } else { TAGS };
            let error = error.renumbered(|vertex| kept[vertex].tag, |t| triangles[t].tag);
            Err(GmshMistake::Mesh { error, note })
        }
    }
}

/// The middle node of a straight edge may be off the middle by this share of the edge's length: coordinates in a text file
/// have 16 digits, and a thousandth of the body may be the length of an edge.
const STRAIGHT: f64 = 1e-10;

/// Refuses an edge whose middle node does not lie in its middle.
fn check_straight(
    element: usize,
    node: usize,
    [a, b, middle]: [[f64; 2]; 3],
) -> std::result::Result<(), GmshMistake> {
    let off = [0, 1].map(|c| middle[c] - (a[c] + b[c]) / 2.0);
    let off = off[0].hypot(off[1]) / (b[0] - a[0]).hypot(b[1] - a[1]);
    if off <= STRAIGHT { Ok(()) } else { Err(GmshMistake::Curved { element, node, off }) }
}

/// The name of each entity, if it is in a physical group.
type NameOf = BTreeMap<i32, Option<String>>;

/// The name of the entity of this dimension on which an element lies.
fn name_of(
    names: &NameOf,
    dimension: usize,
    element: usize,
    entity: i32,
) -> std::result::Result<Option<&String>, GmshMistake> {
    let kind = KINDS[dimension];
    let name = names.get(&entity).ok_or(GmshMistake::NoSuchEntity { element, kind, entity })?;
    Ok(name.as_ref())
}

/// The names of all entities. A group without a name is an error for curves, which are meant as boundaries, and no name for
/// points and surfaces.
fn name_entities(
    names: &ByDimension<BTreeMap<i32, String>>,
    groups: ByDimension<BTreeMap<i32, Vec<i32>>>,
) -> std::result::Result<ByDimension<NameOf>, GmshMistake> {
    let mut all = <ByDimension<NameOf>>::default();
    for (dimension, entities) in groups.into_iter().enumerate() {
        for (entity, groups) in entities {
            let mut found = Vec::new();
            for physical in groups {
                match names[dimension].get(&physical) {
                    Some(name) => found.push(name),
                    None if dimension == 1 => {
                        return Err(GmshMistake::Unnamed { physical, curve: entity });
                    }
                    None => {}
                }
            }
            if found.len() > 1 {
                let names: Vec<String> = found.iter().map(|name| quoted(name, '\'')).collect();
                let (kind, names) = (KINDS[dimension], names.join(" and "));
                return Err(GmshMistake::SeveralNames { kind, entity, names });
            }
            all[dimension].insert(entity, found.first().map(|name| (*name).clone()));
        }
    }
    Ok(all)
}

/// How numbers are written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    Text,
    LittleEndian,
    BigEndian,
}

/// A place in the bytes of a file, and what can be read from there on.
struct Cursor<'b> {
    bytes: &'b [u8],
    file: &'b Path,
    at: usize,
    form: Form,
}

impl<'b> Cursor<'b> {
    /// The heading of the next section without its $, and where it stands; `None` at the end of the file.
    fn section(&mut self) -> Result<Option<(usize, &'b str)>> {
        self.skip_white_space();
        if self.at == self.bytes.len() {
            return Ok(None);
        }
        let (start, line) = self.line();
        match line.strip_prefix(b"$").map(std::str::from_utf8) {
            Some(Ok(section)) => Ok(Some((start, section))),
            _ => Err(self.unexpected(start, shown(line), "a section such as $Nodes")),
        }
    }

    /// Reads the end of a section.
    fn end_of(&mut self, section: &str) -> Result<()> {
        let expected = end_of(section);
        self.skip_white_space();
        if self.at == self.bytes.len() {
            return Err(self.cut_short(&expected));
        }
        let (start, line) = self.line();
        if line.strip_prefix(b"$End") == Some(section.as_bytes()) {
            Ok(())
        } else {
            Err(self.unexpected(start, shown(line), &expected))
        }
    }

    /// Goes to the end of a section that doesn't matter.
    fn skip_to_end_of(&mut self, section: &str) -> Result<()> {
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

    /// What is left of this line, without the white space around it, and where it starts.
    fn line(&mut self) -> (usize, &'b [u8]) {
        let (start, rest) = (self.at, self.rest());
        let length = rest.iter().position(|&b| b == b'\n');
        self.at += length.map_or(rest.len(), |length| length + 1);
        (start, rest[..length.unwrap_or(rest.len())].trim_ascii())
    }

    /// The next word, and where it starts.
    fn word(&mut self, expected: &str) -> Result<(usize, &'b [u8])> {
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
    fn number<T: FromStr>(&mut self, expected: &str) -> Result<T> {
        let (start, word) = self.word(expected)?;
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| self.unexpected(start, shown(word), expected))
    }

    /// The next bytes, lowest first.
    fn take<const N: usize>(&mut self, expected: &str) -> Result<[u8; N]> {
        match self.rest().first_chunk() {
            Some(&bytes) => {
                self.at += N;
                Ok(self.lowest_first(bytes))
            }
            None => {
                self.at = self.bytes.len();
                Err(self.cut_short(expected))
            }
        }
    }

    fn lowest_first<const N: usize>(&self, mut bytes: [u8; N]) -> [u8; N] {
        if self.form == Form::BigEndian {
            bytes.reverse();
        }
        bytes
    }

    fn int(&mut self, expected: &str) -> Result<i32> {
        match self.form {
            Form::Text => self.number(expected),
            _ => self.take(expected).map(i32::from_le_bytes),
        }
    }

    fn int_within(&mut self, range: RangeInclusive<i32>, expected: &str) -> Result<i32> {
        let start = self.here();
        let number = self.int(expected)?;
        if range.contains(&number) {
            Ok(number)
        } else {
            Err(self.unexpected(start, number.to_string(), expected))
        }
    }

    fn size(&mut self, expected: &str) -> Result<usize> {
        match self.form {
            Form::Text => self.number(expected),
            _ => {
                let start = self.at;
                let number = u64::from_le_bytes(self.take(expected)?);
                usize::try_from(number)
                    .map_err(|_| self.unexpected(start, number.to_string(), expected))
            }
        }
    }

    fn double(&mut self, expected: &str) -> Result<f64> {
        match self.form {
            Form::Text => self.number(expected),
            _ => self.take(expected).map(f64::from_le_bytes),
        }
    }

    /// Where the next number starts.
    fn here(&mut self) -> usize {
        if self.form == Form::Text {
            self.skip_white_space();
        }
        self.at
    }

    /// Makes room for as many items as are announced, or as many as the rest of the file can hold if those are fewer.
    fn make_room<T>(&self, list: &mut Vec<T>, announced: usize) -> Result<()> {
        // A digit and the space after it.
        const LEAST: usize = 2;
        memory::reserve(list, announced.min(self.rest().len() / LEAST))
            .map_err(|lack| self.wrong(Place::File, lack.into()))
    }

    fn skip_white_space(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_ascii_start().len();
    }

    fn rest(&self) -> &'b [u8] {
        &self.bytes[self.at..]
    }

    fn unexpected(&self, start: usize, found: String, expected: &str) -> GmshError {
        let expected = expected.to_owned();
        self.wrong_at(start, GmshMistake::Unexpected { found, expected })
    }

    fn cut_short(&self, expected: &str) -> GmshError {
        self.wrong_at(self.bytes.len(), GmshMistake::CutShort { expected: expected.to_owned() })
    }

    fn wrong_at(&self, start: usize, mistake: GmshMistake) -> GmshError {
        let place = match self.form {
            Form::Text => {
                Place::Line(self.bytes[..start].iter().filter(|&&b| b == b'\n').count() + 1)
            }
            _ => Place::Byte(start),
        };
        self.wrong(place, mistake)
    }

    fn wrong(&self, place: Place, mistake: GmshMistake) -> GmshError {
        GmshError { file: self.file.to_owned(), place, mistake: Box::new(mistake) }
    }
}

/// The line that ends a section, as messages show it: its name is one of the file.
fn end_of(section: &str) -> String {
    format!("$End{}", quote::cut(section))
}

fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    match bytes {
        [] => "nothing".to_owned(),
        _ => quoted(&String::from_utf8_lossy(&bytes[..bytes.len().min(MOST)]), '\''),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &[u8] = include_bytes!("../../tests/meshes/square-ascii.msh");
    const BINARY: &[u8] = include_bytes!("../../tests/meshes/square-binary.msh");
    const ALL: &[u8] = include_bytes!("../../tests/meshes/square-all.msh");

    fn parse(bytes: &[u8]) -> Result<Mesh> {
        from_bytes(bytes, Path::new("x.msh"))
    }

    fn message(bytes: &[u8]) -> String {
        parse(bytes).err().map_or("no error".to_owned(), |e| e.to_string())
    }

    /// The number of edges, and the integral of the outward normal.
    fn part(mesh: &Mesh, name: &str) -> (usize, [f64; 2]) {
        let edges = mesh.edges_of(name).unwrap();
        let mut sum = [0.0; 2];
        for &edge in edges {
            let (length, n) = mesh.length_and_normal(edge);
            sum = [sum[0] + length * n[0], sum[1] + length * n[1]];
        }
        (edges.len(), sum.map(|c| (c * 1e9).round() / 1e9 + 0.0))
    }

    fn check(mesh: &Mesh) {
        assert_eq!(mesh.vertices().len(), 12, "the centre of the arc is left out");
        assert_eq!(mesh.triangles().len(), 13);
        assert_eq!(mesh.boundary_names().collect::<Vec<_>>(), ["right", "the floor", "top"]);
        assert_eq!(part(mesh, "the floor"), (2, [0.0, -1.0]));
        assert_eq!(part(mesh, "right"), (2, [1.0, 0.0]));
        assert_eq!(part(mesh, "top"), (3, [0.0, 1.0]), "a group that runs against its curve");
    }

    #[test]
    fn text_and_binary_give_the_same_mesh() {
        let (text, binary) = (parse(TEXT).unwrap(), parse(BINARY).unwrap());
        check(&text);
        assert_eq!(text.triangles(), binary.triangles());
        assert_eq!(text.outline(), binary.outline());
        for (a, b) in text.vertices().iter().zip(binary.vertices()) {
            assert!((a[0] - b[0]).abs() < 1e-15 && (a[1] - b[1]).abs() < 1e-15);
        }
    }

    #[test]
    fn unused_nodes_points_unnamed_curves_and_parameters_are_passed_over() {
        check(&parse(ALL).unwrap());
    }

    #[test]
    fn line_ends_of_other_systems_are_read() {
        let text = String::from_utf8(TEXT.to_vec()).unwrap();
        check(&parse(text.replace('\n', "\r\n").as_bytes()).unwrap());
    }

    #[test]
    fn sections_that_do_not_matter_are_skipped() {
        let mut bytes = BINARY.to_vec();
        bytes.extend(b"$Comments\n$Nodes is\n\xff not a section here\n$EndComments\n");
        check(&parse(&bytes).unwrap());
    }

    /// A binary file of one triangle with a floor, its numbers written by `bytes` from those of lowest bytes first.
    fn one_triangle(bytes: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
        let ints = |n: &[i32]| n.iter().flat_map(|n| bytes(&n.to_le_bytes())).collect::<Vec<_>>();
        let sizes = |n: &[u64]| n.iter().flat_map(|n| bytes(&n.to_le_bytes())).collect::<Vec<_>>();
        let doubles =
            |n: &[f64]| n.iter().flat_map(|n| bytes(&n.to_le_bytes())).collect::<Vec<_>>();
        [
            b"$MeshFormat\n4.1 1 8\n".to_vec(),
            ints(&[1]),
            b"\n$EndMeshFormat\n$PhysicalNames\n1\n1 7 \"floor\"\n$EndPhysicalNames\n$Entities\n"
                .to_vec(),
            sizes(&[0, 1, 1, 0]),
            ints(&[4]),
            doubles(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]),
            sizes(&[1]),
            ints(&[7]),
            sizes(&[0]),
            ints(&[1]),
            doubles(&[0.0, 0.0, 0.0, 2.0, 1.5, 0.0]),
            sizes(&[0]),
            sizes(&[0]),
            b"\n$EndEntities\n$Nodes\n".to_vec(),
            sizes(&[1, 3, 10, 30]),
            ints(&[2, 1, 0]),
            sizes(&[3, 10, 20, 30]),
            doubles(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.5, 0.0]),
            b"\n$EndNodes\n$Elements\n".to_vec(),
            sizes(&[2, 2, 1, 2]),
            ints(&[1, 4, 1]),
            sizes(&[1, 1, 10, 20]),
            ints(&[2, 1, 2]),
            sizes(&[1, 2, 10, 20, 30]),
            b"\n$EndElements\n".to_vec(),
        ]
        .concat()
    }

    #[test]
    fn both_orders_of_bytes_give_the_same_mesh() {
        for bytes in [<[u8]>::to_vec, |b: &[u8]| b.iter().rev().copied().collect::<Vec<u8>>()] {
            let mesh = parse(&one_triangle(bytes)).unwrap();
            assert_eq!(mesh.vertices(), [[0.0, 0.0], [2.0, 0.0], [0.0, 1.5]]);
            assert_eq!(part(&mesh, "floor"), (1, [0.0, -2.0]));
        }
    }

    #[test]
    fn counts_that_the_file_cannot_hold_allocate_nothing() {
        let huge = String::from_utf8(TEXT.to_vec()).unwrap();
        for (count, wrong) in [
            ("\n13 12 1 12", "\n18446744073709551615 12 1 12"),
            ("\n2 1 0 2\n", "\n2 1 0 18446744073709551615\n"),
            ("\n2 1 2 8\n", "\n2 1 2 18446744073709551615\n"),
            ("\n7 7 2 0\n", "\n7 18446744073709551615 2 0\n"),
            ("\n4\n1 1 ", "\n18446744073709551615\n1 1 "),
        ] {
            assert!(huge.contains(count));
            let e = message(huge.replace(count, wrong).as_bytes());
            assert!(e.contains("expected"), "{e}");
        }
    }

    #[test]
    fn every_cut_of_a_file_is_an_error() {
        for file in [TEXT, BINARY] {
            for length in 0..file.len() - 1 {
                assert!(parse(&file[..length]).is_err(), "cut at {length}");
            }
        }
    }

    #[test]
    fn no_single_wrong_byte_is_a_panic() {
        for file in [TEXT, BINARY] {
            for at in 0..file.len() {
                for byte in [0, b' ', b'$', b'9', 0x80, 0xff] {
                    let mut bytes = file.to_vec();
                    bytes[at] = byte;
                    let _ = parse(&bytes);
                }
            }
        }
    }
}
