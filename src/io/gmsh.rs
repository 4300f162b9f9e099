//! Meshes from Gmsh: the formats MSH 4.1 and 2.2, text or binary (little endian).
//!
//! A file is a list of sections, `$Name` .. `$EndName`. Four matter here; the others are skipped:
//!
//! | section | what is taken from it |
//! | --- | --- |
//! | `$PhysicalNames` | the names of the physical points, curves and surfaces |
//! | `$Entities` (4.1) | which point, curve or surface belongs to which physical group |
//! | `$Nodes` | the vertices; those that are no corner of a triangle (the centre of an arc) are left out |
//! | `$Elements` | triangles: the body, by physical surface; lines on physical curves: the boundary parts; physical points |
//!
//! Elements of second order are read as those of first order if their edges are straight, and refused if they are curved.
//!
//! The format is described in the Gmsh reference manual, section "MSH file format". In a binary file an `int` has 4
//! bytes, a `size_t` and a `double` have 8; in a text file all are words between white space. Nothing is allocated because
//! a file announces it, only because it is there. How bytes are read is in `cursor`, which mesh they make in `mesh`.

mod cursor;
mod mesh;

use std::collections::BTreeMap;
use std::path::Path;

use super::input::{self, FileError, MOST_OF_A_MESH};
use crate::fem::{Mesh, Pair};
use crate::memory;
use crate::quote;
use cursor::{Cursor, Version, shown};
use mesh::{make_mesh, merge_nodes};

type Result<T> = std::result::Result<T, FileError>;

/// The mesh in this file, its nodes merged that are no further apart than a share of the body's size, if one is given. The
/// boundaries of these pairs may touch each other, and are not merged.
///
/// # Errors
/// The first mistake found, with its place and the numbers that the file uses.
pub fn read(file: &Path, share: Option<f64>, pairs: &[Pair]) -> Result<Mesh> {
    from_bytes(&input::read(file, MOST_OF_A_MESH)?, file, share, pairs)
}

/// The mesh in `bytes`, which messages call `file`; otherwise as [`read`].
pub fn from_bytes(bytes: &[u8], file: &Path, share: Option<f64>, pairs: &[Pair]) -> Result<Mesh> {
    // Names and entities: what is kept of one is no more than this many times what the file says of it.
    const MOST_TIMES: u64 = 4;
    let mut cursor = Cursor { bytes, file, at: 0, version: Version::Four, binary: false };
    memory::check(MOST_TIMES * bytes.len() as u64).map_err(|lack| cursor.in_the_file(lack))?;
    let mut content = read_sections(&mut cursor)?;
    if let Some(share) = share {
        merge_nodes(&mut content, share, pairs);
    }
    make_mesh(content, pairs).map_err(|error| cursor.in_the_file(error))
}

/// Something for points, curves and surfaces each.
type ByDimension<T> = [T; 3];

/// The physical groups of each entity.
type Groups = ByDimension<BTreeMap<i32, Vec<i32>>>;

/// The content of the sections, in the tags of the file.
struct Content {
    /// The names of the physical groups.
    names: ByDimension<BTreeMap<i32, String>>,
    groups: Groups,
    nodes: Vec<Node>,
    elements: Elements,
}

struct Node {
    tag: usize,
    place: [f64; 2],
}

#[derive(Default)]
struct Elements {
    /// Points, lines and triangles.
    by_dimension: ByDimension<Vec<GmshElement>>,
    /// The middle nodes of edges of second order.
    middles: Vec<Middle>,
}

/// An element on an entity of its dimension, by its corners: one, two or all three of `nodes`.
struct GmshElement {
    tag: usize,
    nodes: [usize; 3],
    entity: i32,
}

/// A node between the two ends of an edge of an element.
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
    ) -> Result<()> {
        const NODE: &str = "the tag of a node";
        let (dimension, order) = dimension_and_order(number).map_err(|[kind, expected]| {
            let said = format!("element {tag} is a {kind} (type {number}); expected {expected}");
            cursor.wrong_at(start, said)
        })?;
        let mut nodes = [0; 3];
        for node in &mut nodes[..=dimension] {
            *node = cursor.size(NODE)?;
        }
        self.by_dimension[dimension].push(GmshElement { tag, nodes, entity });
        let edges = if order == 2 { [0, 1, 3][dimension] } else { 0 };
        for edge in 0..edges {
            let ends = [nodes[edge], nodes[(edge + 1) % 3]];
            self.middles.push(Middle { element: tag, node: cursor.size(NODE)?, ends });
        }
        Ok(())
    }

    /// The groups of a file in which each is an entity of its own; 0 is no group.
    fn groups(&self) -> Groups {
        let of = |element: &GmshElement| {
            (element.entity, Vec::from_iter(Some(element.entity).filter(|&e| e != 0)))
        };
        self.by_dimension.each_ref().map(|elements| elements.iter().map(of).collect())
    }
}

/// The dimension and the order of an element type in use; of another its name, and the remedy.
fn dimension_and_order(number: i32) -> std::result::Result<(usize, usize), [&'static str; 2]> {
    const ORDER: &str = "2-node lines and 3-node triangles: export with element order 1";
    const TRIANGLES: &str = "3-node triangles: do not recombine the mesh";
    const PLANE: &str = "a plane mesh of 3-node triangles: mesh in two dimensions, gmsh -2";
    Err(match number {
        15 => return Ok((0, 1)),
        1 => return Ok((1, 1)),
        2 => return Ok((2, 1)),
        8 => return Ok((1, 2)),
        9 => return Ok((2, 2)),
        3 => ["4-node quadrangle", TRIANGLES],
        4 => ["4-node tetrahedron", PLANE],
        5 => ["8-node hexahedron", PLANE],
        6 => ["6-node prism", PLANE],
        7 => ["5-node pyramid", PLANE],
        10 => ["9-node quadrangle", TRIANGLES],
        16 => ["8-node quadrangle", TRIANGLES],
        21 => ["10-node triangle", ORDER],
        26 => ["4-node line", ORDER],
        _ => ["kind of element that has no use here", "2-node lines and 3-node triangles"],
    })
}

fn read_sections(cursor: &mut Cursor) -> Result<Content> {
    read_format(cursor)?;
    let version = cursor.version;
    let (mut names, mut groups, mut nodes, mut elements) = (None, None, None, None);
    while let Some((start, section)) = cursor.section()? {
        let is_second = match (section, version) {
            ("PhysicalNames", _) => names.replace(read_names(cursor)?).is_some(),
            ("Entities", Version::Four) => groups.replace(read_entities(cursor)?).is_some(),
            ("Nodes", Version::Four) => nodes.replace(read_nodes(cursor)?).is_some(),
            ("Nodes", Version::Two) => nodes.replace(read_nodes_of_2(cursor)?).is_some(),
            ("Elements", Version::Four) => elements.replace(read_elements(cursor)?).is_some(),
            ("Elements", Version::Two) => elements.replace(read_elements_of_2(cursor)?).is_some(),
            _ => {
                cursor.skip_to_end_of(section)?;
                false
            }
        };
        if is_second {
            let said = format!("there is a second section ${section}; expected one");
            return Err(cursor.wrong_at(start, said));
        }
        cursor.end_of(section)?;
    }
    let missing = |section| {
        cursor.in_the_file(format!(
            "there is no section ${section}; expected MSH 4.1 with $Entities, $Nodes and $Elements"
        ))
    };
    if version == Version::Four && groups.is_none() {
        return Err(missing("Entities"));
    }
    let nodes = nodes.ok_or_else(|| missing("Nodes"))?;
    let elements: Elements = elements.ok_or_else(|| missing("Elements"))?;
    let groups = groups.unwrap_or_else(|| elements.groups());
    Ok(Content { names: names.unwrap_or_default(), groups, nodes, elements })
}

/// `$MeshFormat`: version, text or binary, size of a `size_t`; in a binary file then the number 1.
fn read_format(cursor: &mut Cursor) -> Result<()> {
    let (start, heading) = cursor.line();
    if heading != b"$MeshFormat" {
        // Without its words: a case of somebody else may name a file that is none of his business.
        let said = "this is no Gmsh mesh: expected $MeshFormat on its first line; gmsh -2 PART.geo makes PART.msh from a geometry";
        return Err(cursor.wrong_at(start, said.to_owned()));
    }
    let (start, version) = cursor.word("the version of the format")?;
    cursor.version = match version {
        b"4.1" => Version::Four,
        b"2.2" => Version::Two,
        _ => {
            let version = shown(version);
            let said = format!(
                "the version of the format is {version}; expected '4.1' or '2.2': export the mesh with gmsh -format msh41"
            );
            return Err(cursor.wrong_at(start, said));
        }
    };
    let binary = cursor.int_within(0..=1, "0 for a text file or 1 for a binary file")?;
    cursor.int_within(8..=8, "8, the size of a number")?;
    if binary == 1 {
        cursor.line();
        let start = cursor.at;
        let one: [u8; 4] = cursor.take("the number 1, which shows the order of the bytes")?;
        cursor.binary = true;
        let (found, expected) = match one {
            [0, 0, 0, 1] => (
                "the bytes of a big-endian machine".to_owned(),
                "little-endian numbers: export the mesh as text (Mesh.Binary = 0)",
            ),
            other => (format!("the bytes {other:?}"), "the number 1 in 4 bytes"),
        };
        if one != [1, 0, 0, 0] {
            return Err(cursor.unexpected(start, &found, expected));
        }
    }
    cursor.end_of("MeshFormat")
}

/// `$PhysicalNames`, always text: a count; then dimension, tag and "name" on a line each.
fn read_names(cursor: &mut Cursor) -> Result<ByDimension<BTreeMap<i32, String>>> {
    let mut text = Cursor { binary: false, ..*cursor };
    let count = text.size("the number of physical names")?;
    let mut names = <ByDimension<BTreeMap<i32, String>>>::default();
    for _ in 0..count {
        let dimension = text.int_within(0..=3, "a dimension from 0 to 3")?;
        let tag = text.int("the tag of a physical group")?;
        let (start, line) = text.line();
        let name = std::str::from_utf8(line).ok().map(str::trim);
        let name = name.and_then(|name| name.strip_prefix('"')?.strip_suffix('"'));
        let name = name.ok_or_else(|| {
            text.unexpected(start, &shown(line), "the name of a physical group in quotes")
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
fn read_entities(cursor: &mut Cursor) -> Result<Groups> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.size("a number of entities")?;
    }
    let mut all = Groups::default();
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
            node.place = read_place(cursor, node.tag)?;
            for _ in 0..parametric * dimension {
                cursor.double("a parameter of a node")?;
            }
        }
    }
    Ok(nodes)
}

fn read_block_count(cursor: &mut Cursor, of: &str) -> Result<usize> {
    let blocks = cursor.size(&format!("the number of blocks of {of}"))?;
    for what in ["number", "least tag", "greatest tag"] {
        cursor.size(&format!("the {what} of the {of}"))?;
    }
    Ok(blocks)
}

/// The coordinates x, y, z of a node, of which z must be 0.
fn read_place(cursor: &mut Cursor, node: usize) -> Result<[f64; 2]> {
    const COORDINATE: &str = "a coordinate of a node";
    let place = [cursor.double(COORDINATE)?, cursor.double(COORDINATE)?];
    let start = cursor.here();
    let z = cursor.double(COORDINATE)?;
    if z == 0.0 {
        return Ok(place);
    }
    let z = quote::number(z);
    let said = format!("node {node} has z = {z}; expected a mesh in the plane z = 0");
    Err(cursor.wrong_at(start, said))
}

/// `$Elements`: the number of blocks, three numbers of no use here; then in each block dimension and tag of an entity,
/// the type of the elements, how many there are, and the tag and the nodes of each.
fn read_elements(cursor: &mut Cursor) -> Result<Elements> {
    let blocks = read_block_count(cursor, "elements")?;
    let mut elements = Elements::default();
    for _ in 0..blocks {
        cursor.int_within(0..=3, "a dimension from 0 to 3")?;
        let entity = cursor.int("the tag of an entity")?;
        let number = cursor.int("the type of the elements")?;
        let count = cursor.size("a number of elements")?;
        if let Ok((dimension, 1)) = dimension_and_order(number) {
            cursor.make_room(&mut elements.by_dimension[dimension], count)?;
        }
        for _ in 0..count {
            let start = cursor.here();
            let tag = cursor.size("the tag of an element")?;
            elements.read(cursor, start, tag, number, entity)?;
        }
    }
    Ok(elements)
}

/// `$Nodes` of MSH 2.2: a count, then tag, x, y, z of each node.
fn read_nodes_of_2(cursor: &mut Cursor) -> Result<Vec<Node>> {
    let mut nodes = Vec::new();
    for _ in 0..cursor.count("the number of nodes")? {
        let tag = cursor.size("the tag of a node")?;
        nodes.push(Node { tag, place: read_place(cursor, tag)? });
    }
    Ok(nodes)
}

/// `$Elements` of MSH 2.2: a count, then of each element, in a text file: tag, type, the number of its labels, the labels (the
/// first is the physical group, 0 for none, the second the entity), the nodes. In a binary file elements of one type follow
/// each other: type, how many, the number of labels, and of each tag, labels, nodes. There are no entities: each physical
/// group is one, and an element of two groups appears once for each.
fn read_elements_of_2(cursor: &mut Cursor) -> Result<Elements> {
    const LABELS: &str = "the number of labels";
    let mut elements = Elements::default();
    let mut left = cursor.count("the number of elements")?;
    while left > 0 {
        let (together, shared) = if !cursor.binary {
            (1, None)
        } else {
            let number = cursor.int("the type of the elements")?;
            let start = cursor.here();
            let together = cursor.size("how many elements of this type follow")?;
            if !(1..=left).contains(&together) {
                let expected = format!("a number of elements from 1 to {left}");
                return Err(cursor.unexpected(start, &together.to_string(), &expected));
            }
            (together, Some((number, cursor.size(LABELS)?)))
        };
        for _ in 0..together {
            let start = cursor.here();
            let tag = cursor.size("the tag of an element")?;
            let (number, labels) = match shared {
                Some(shared) => shared,
                None => (cursor.int("the type of the element")?, cursor.size(LABELS)?),
            };
            let mut group = 0;
            for label in 0..labels {
                let value = cursor.int("a label of an element")?;
                if label == 0 {
                    // A negative number says that the group runs against the direction of the curve.
                    group = value.saturating_abs();
                }
            }
            elements.read(cursor, start, tag, number, group)?;
        }
        left -= together;
    }
    Ok(elements)
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    const TEXT: &[u8] = include_bytes!("../../tests/meshes/square-ascii.msh");
    const BINARY: &[u8] = include_bytes!("../../tests/meshes/square-binary.msh");
    const ALL: &[u8] = include_bytes!("../../tests/meshes/square-all.msh");

    fn parse(bytes: &[u8]) -> Result<Mesh> {
        from_bytes(bytes, Path::new("x.msh"), None, &[])
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
    fn what_does_not_matter_is_passed_over() {
        // Unused nodes, points, unnamed curves and parameters; line ends of other systems; sections.
        let text = String::from_utf8(TEXT.to_vec()).unwrap().replace('\n', "\r\n");
        let more = b"$Comments\n$Nodes is\n\xff not a section here\n$EndComments\n";
        for bytes in [ALL, text.as_bytes(), &[BINARY, more].concat()] {
            check(&parse(bytes).unwrap());
        }
    }

    #[test]
    fn big_endian_files_are_refused_with_the_remedy() {
        let start = b"$MeshFormat\n4.1 1 8\n".len();
        let mut bytes = BINARY.to_vec();
        bytes[start..start + 4].reverse();
        let said = message(&bytes);
        let expected = "found the bytes of a big-endian machine, expected little-endian numbers: export the mesh as text";
        assert!(said.contains(expected), "{said}");
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
}
