//! Meshes from Gmsh: the formats MSH 4.1 and 2.2, text or binary (little endian). Here is 4.1 and what both share;
//! what 2.2 writes otherwise is in `msh2`, how bytes are read in `cursor`, and what mesh they make in `made`.
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

mod cursor;
mod error;
mod made;
mod msh2;

use std::collections::BTreeMap;
use std::path::Path;

use super::input::{self, MOST_OF_A_MESH};
use crate::fem::Mesh;
use crate::memory::{self, OutOfMemory};
use cursor::{Cursor, Form, shown};
pub use error::{GmshError, GmshMistake, Place};
use made::{make_mesh, merge_nodes};

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

/// The name of the entities of a dimension in messages.
const KINDS: ByDimension<&str> = ["point", "curve", "surface"];

/// The content of the sections, in the tags of the file.
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
    let version = read_format(cursor)?;
    let (mut names, mut groups, mut nodes, mut elements) = (None, None, None, None);
    while let Some((start, section)) = cursor.section()? {
        let first = match (section, version) {
            ("PhysicalNames", _) => names.replace(read_names(cursor)?).is_none(),
            ("Entities", Version::Four) => groups.replace(read_entities(cursor)?).is_none(),
            ("Nodes", Version::Four) => nodes.replace(read_nodes(cursor)?).is_none(),
            ("Nodes", Version::Two) => nodes.replace(msh2::read_nodes(cursor)?).is_none(),
            ("Elements", Version::Four) => elements.replace(read_elements(cursor)?).is_none(),
            ("Elements", Version::Two) => elements.replace(msh2::read_elements(cursor)?).is_none(),
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
    if version == Version::Four && groups.is_none() {
        return Err(missing("Entities"));
    }
    let nodes = nodes.ok_or_else(|| missing("Nodes"))?;
    let elements = elements.ok_or_else(|| missing("Elements"))?;
    let groups = groups.unwrap_or_else(|| msh2::groups(&elements));
    Ok(Content { names: names.unwrap_or_default(), groups, nodes, elements })
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
        let one: [u8; 4] = cursor.take("the number 1, which shows the order of the bytes")?;
        cursor.form = Form::Binary;
        let (found, expected) = match one {
            [1, 0, 0, 0] => (String::new(), ""),
            [0, 0, 0, 1] => (
                "the bytes of a big-endian machine".to_owned(),
                "little-endian numbers: export the mesh as text (Mesh.Binary = 0)",
            ),
            other => (format!("the bytes {other:?}"), "the number 1 in 4 bytes"),
        };
        if !found.is_empty() {
            return Err(cursor.unexpected(start, found, expected));
        }
    }
    cursor.end_of("MeshFormat")?;
    Ok(version)
}

/// The version of the format.
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

/// The name of an element type that is not read, and its remedy.
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

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

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
            // A text file has 16 digits.
            assert_abs_diff_eq!(a[..], b[..], epsilon = 1e-15);
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
    fn little_endian_files_are_read_and_big_endian_ones_refused() {
        let mesh = parse(&one_triangle(<[u8]>::to_vec)).unwrap();
        assert_eq!(mesh.vertices(), [[0.0, 0.0], [2.0, 0.0], [0.0, 1.5]]);
        assert_eq!(part(&mesh, "floor"), (1, [0.0, -2.0]));
        let big = one_triangle(|bytes| bytes.iter().rev().copied().collect());
        let said = message(&big);
        assert!(
            said.contains("found the bytes of a big-endian machine, expected little-endian"),
            "{said}"
        );
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
