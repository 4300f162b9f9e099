//! Meshes from Gmsh: the formats MSH 4.1 and 2.0 to 2.2, text or binary (little endian).
//!
//! A file is a list of sections, `$Name` .. `$EndName`. These matter here; the others are skipped:
//!
//! | section | what is taken from it |
//! | --- | --- |
//! | `$PhysicalNames` | the names of the physical points, curves and surfaces |
//! | `$Entities`, `$PartitionedEntities` (4.1) | which point, curve or surface belongs to which physical groups |
//! | `$Nodes` | the vertices; those that are no corner of a triangle (the centre of an arc) are left out |
//! | `$Elements` | triangles and quadrangles: the body, by physical surface; lines: the boundary parts; physical points |
//!
//! The format is described in the Gmsh reference manual, section "MSH file format". In a binary file an `int` has 4
//! bytes, a `size_t` and a `double` have 8; in a text file all are words between white space. Memory is allocated for data that
//! are there, never for data that a file announces. How bytes are read is in `cursor`, which mesh they make in `raw_mesh`.

mod cursor;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

use super::input::{self, FileError, MOST_OF_A_MESH};
use super::raw_mesh::{ByDimension, Elements, Kind, Made, Node, RawMesh};
use crate::memory;
use crate::model::pairs::{self, Pair};
use cursor::{Cursor, Version, shown};

type Result<T> = std::result::Result<T, FileError>;

/// The mesh in this file, its nodes merged that are no further apart than a share of the body's size, if one is given. The
/// boundaries of these pairs may touch each other, and are not merged.
///
/// # Errors
/// The first mistake found, with its place and the numbers that the file uses.
pub fn read(file: &Path, share: Option<f64>, pairs: &[Pair]) -> Result<Made> {
    from_bytes(&input::read(file, MOST_OF_A_MESH)?, file, share, pairs)
}

/// The mesh in `bytes`, which messages call `file`; otherwise as [`read`].
///
/// # Errors
/// As [`read`].
pub fn from_bytes(bytes: &[u8], file: &Path, share: Option<f64>, pairs: &[Pair]) -> Result<Made> {
    // The memory kept per name or entity, at most this many times its size in the file.
    const MOST_TIMES: u64 = 4;
    let mut cursor = Cursor { bytes, file, at: 0, version: Version::Four, binary: false };
    memory::check(MOST_TIMES * bytes.len() as u64).map_err(|lack| cursor.in_the_file(lack))?;
    let raw = read_sections(&mut cursor)?;
    raw.made(share, pairs).map_err(|error| cursor.in_the_file(error))
}

/// The mesh in this file, and its bodies' boundaries that touch each other, as pairs: those of two bodies that face each other no further
/// apart than their edges are long.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_with_pairs(file: &Path) -> Result<(Made, Vec<Pair>)> {
    let bytes = input::read(file, MOST_OF_A_MESH)?;
    let mut cursor = Cursor { bytes: &bytes, file, at: 0, version: Version::Four, binary: false };
    let names = read_sections(&mut cursor)?.curve_names();
    let with = |pairs: &[Pair]| from_bytes(&bytes, file, None, pairs);
    // A mesh in which bodies touch is refused without pairs: so all pairs of named curves are tried first, unless there are too
    // many.
    let count = if names.len() <= MOST_NAMES { names.len() } else { 0 };
    let all: Vec<Pair> = (0..count)
        .flat_map(|j| (0..j).map(move |i| (i, j)))
        .map(|(i, j)| Pair::new(&*names[i], &*names[j]))
        .collect();
    let Ok(made) = with(&all) else { return Ok((with(&[])?, Vec::new())) };
    let touching = pairs::touching(&made.mesh, &all);
    Ok((with(&touching)?, touching))
}

/// The largest number of named curves for which pairs are tried.
const MOST_NAMES: usize = 40;

/// The physical groups of each entity.
type Groups = ByDimension<BTreeMap<i32, Vec<i32>>>;

/// The names of the physical groups.
type Names = ByDimension<BTreeMap<i32, String>>;

fn read_sections(cursor: &mut Cursor) -> Result<RawMesh> {
    read_format(cursor)?;
    let version = cursor.version;
    let (mut names, mut remarks) = (None, Vec::new());
    let (mut groups, mut parts, mut nodes, mut elements) = (None, None, None, None);
    while let Some((start, section)) = cursor.section()? {
        let is_second = match (section, version) {
            ("PhysicalNames", _) => names.replace(read_names(cursor)?).is_some(),
            ("Entities", Version::Four) => {
                groups.replace(read_entities(cursor, false)?.groups).is_some()
            }
            ("PartitionedEntities", Version::Four) => {
                parts.replace(read_entities(cursor, true)?).is_some()
            }
            ("Nodes", Version::Four) => nodes.replace(read_nodes(cursor)?).is_some(),
            ("Nodes" | "ParametricNodes", Version::Two) => {
                let is_parametric = section == "ParametricNodes";
                nodes.replace(read_nodes_of_2(cursor, is_parametric)?).is_some()
            }
            ("Elements", Version::Four) => elements.replace(read_elements(cursor)?).is_some(),
            ("Elements", Version::Two) => {
                let (all, of_each, remark) = read_elements_of_2(cursor)?;
                groups = Some(of_each);
                remarks.extend(remark);
                elements.replace(all).is_some()
            }
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
            "there is no section ${section}; expected MSH 4.1 or 2.2 with $Nodes and $Elements"
        ))
    };
    let nodes = nodes.ok_or_else(|| missing("Nodes"))?;
    let elements: Elements = elements.ok_or_else(|| missing("Elements"))?;
    if let Some(parts) = parts {
        check_parts(cursor, &parts, &elements)?;
        for (all, of_parts) in groups.get_or_insert_default().iter_mut().zip(parts.groups) {
            all.extend(of_parts);
        }
    }
    if let Some(groups) = &groups {
        check_entities(cursor, groups, &elements)?;
    }
    if groups.is_none() && names.is_some() {
        // Gmsh, too, reads such files without groups.
        remarks.push("the mesh file has names of groups, but no $Entities that say what belongs to them: where = \"abs(y) < 1e-9\" names a boundary".to_owned());
    }
    let names = named(&names.unwrap_or_default(), groups.unwrap_or_default());
    Ok(RawMesh { nodes, elements, names, numbers: "the numbers are tags of the file", remarks })
}

/// The command by which Gmsh brings a file of any other version into this one; it needs no geometry.
const CONVERT: &str = "gmsh OLD.msh -save -format msh41 -o NEW.msh converts it";

/// `$MeshFormat`: version, text or binary, size of a `size_t`; in a binary file then the number 1. What stands before the section,
/// such as a comment, is skipped.
fn read_format(cursor: &mut Cursor) -> Result<()> {
    let is_one_of_old = |heading: &[u8]| matches!(heading, b"$NOD" | b"$PARA" | b"$ELM");
    loop {
        let (start, line) = cursor.line();
        let section = line.strip_prefix(b"$").and_then(|name| std::str::from_utf8(name).ok());
        match section {
            Some("MeshFormat") => break,
            Some(_) if is_one_of_old(line) => {
                let said = format!("this is MSH 1; expected MSH 4.1 or 2.2: {CONVERT}");
                return Err(cursor.wrong_at(start, said));
            }
            Some(name) if cursor.skip_to_end_of(name).is_ok() => {
                cursor.line();
            }
            None if !cursor.rest().is_empty() => {}
            _ => {
                // Quote no words of the file: somebody else's case may name a private file.
                let said = "this is no Gmsh mesh: expected a section $MeshFormat; gmsh -2 PART.geo makes PART.msh from a geometry";
                return Err(cursor.wrong_at(0, said.to_owned()));
            }
        }
    }
    let (start, version) = cursor.word("the version of the format")?;
    let number = std::str::from_utf8(version).ok().and_then(|word| word.parse::<f64>().ok());
    cursor.version = match number {
        Some(4.1) => Version::Four,
        // The lines of the three are the same.
        Some(2.0 | 2.1 | 2.2) => Version::Two,
        _ => {
            let version = shown(version);
            let said =
                format!("the version of the format is {version}; expected 4.1 or 2.2: {CONVERT}");
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
fn read_names(cursor: &mut Cursor) -> Result<Names> {
    let mut text = Cursor { binary: false, ..*cursor };
    let count = text.size("the number of physical names")?;
    let mut names = Names::default();
    for _ in 0..count {
        let dimension = text.int_within(0..=3, "a dimension from 0 to 3")?;
        let tag = text.int("the tag of a physical group")?;
        let (start, line) = text.line();
        // Names in another encoding are read as far as possible: they matter only if the case uses them.
        let name = String::from_utf8_lossy(line);
        let name = name.strip_prefix('"').and_then(|name| name.strip_suffix('"'));
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

/// The names of all entities. A group without a name is called by its number, unless that is the name of another group.
fn named(names: &Names, groups: Groups) -> ByDimension<BTreeMap<i32, Vec<String>>> {
    let mut dimension = 0..;
    groups.map(|entities| {
        let names = &names[dimension.next().unwrap_or(0)];
        let taken: BTreeSet<&str> = names.values().map(String::as_str).collect();
        let name = |group: &i32| {
            let number = || Some(group.to_string()).filter(|number| !taken.contains(&**number));
            names.get(group).cloned().or_else(number)
        };
        let of_entity = |(entity, groups): (i32, Vec<i32>)| {
            let names: BTreeSet<String> = groups.iter().filter_map(name).collect();
            (entity, names.into_iter().collect())
        };
        entities.into_iter().map(of_entity).collect()
    })
}

/// The kinds of entities, in messages.
const KINDS: ByDimension<&str> = ["point", "curve", "surface"];

/// The largest number of groups of an entity, whose elements are kept once for each group.
const MOST_GROUPS: usize = 100;

/// Refuses elements on entities that are not in the list, and entities in too many groups.
fn check_entities(cursor: &Cursor, groups: &Groups, elements: &Elements) -> Result<()> {
    for (dimension, known) in groups.iter().enumerate() {
        if let Some((entity, of)) = known.iter().find(|(_, groups)| groups.len() > MOST_GROUPS) {
            let (kind, count) = (KINDS[dimension], of.len());
            let said = format!(
                "{kind} {entity} belongs to {count} physical {kind}s; expected at most {MOST_GROUPS}"
            );
            return Err(cursor.in_the_file(said));
        }
        let mut entities = elements.entities(dimension).into_iter();
        if let Some((entity, tag)) = entities.find(|(entity, _)| !known.contains_key(entity)) {
            let kind = KINDS[dimension];
            let said = format!("element {tag} lies on {kind} {entity}, which is not in $Entities");
            return Err(cursor.in_the_file(said));
        }
    }
    Ok(())
}

/// The entities of a mesh.
#[derive(Default)]
struct Entities {
    groups: Groups,
    /// How many partitions there are, if it is a mesh in partitions.
    partitions: usize,
    /// The surfaces in each of them.
    surfaces: BTreeMap<i32, Vec<i32>>,
}

/// `$Entities`: the counts of points, curves, surfaces and volumes; then of each the tag, the place (of a point) or the
/// box around it, the physical groups and (except of a point) what bounds it. `$PartitionedEntities` begins with the number of
/// partitions and the ghost entities, and has dimension and tag of the parent and the partitions behind each tag.
fn read_entities(cursor: &mut Cursor, in_partitions: bool) -> Result<Entities> {
    let mut all = Entities::default();
    if in_partitions {
        all.partitions = cursor.size("the number of partitions")?;
        for _ in 0..cursor.size("the number of ghost entities")? {
            cursor.int("the tag of a ghost entity")?;
            cursor.int("the partition of a ghost entity")?;
        }
    }
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.size("a number of entities")?;
    }
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let tag = cursor.int("the tag of an entity")?;
            if in_partitions {
                cursor.int("the dimension of the parent of an entity")?;
                cursor.int("the tag of the parent of an entity")?;
                for _ in 0..cursor.size("the number of partitions of an entity")? {
                    let partition = cursor.int("the tag of a partition")?;
                    if dimension == 2 {
                        all.surfaces.entry(partition).or_default().push(tag);
                    }
                }
            }
            let groups = read_groups(cursor, dimension)?;
            if let Some(of_dimension) = all.groups.get_mut(dimension) {
                of_dimension.insert(tag, groups);
            }
        }
    }
    Ok(all)
}

/// Reads the last part of an entity, and returns its groups.
fn read_groups(cursor: &mut Cursor, dimension: usize) -> Result<Vec<i32>> {
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
    Ok(groups)
}

/// Refuses a file that holds some of the partitions only.
fn check_parts(cursor: &Cursor, parts: &Entities, elements: &Elements) -> Result<()> {
    let used = elements.entities(2);
    let is_there = |surfaces: &Vec<i32>| surfaces.iter().any(|surface| used.contains_key(surface));
    let found = parts.surfaces.values().filter(|surfaces| is_there(surfaces)).count();
    let count = parts.partitions;
    if found >= count {
        return Ok(());
    }
    Err(cursor.in_the_file(format!(
        "the file has triangles of {found} of the {count} partitions of the mesh; expected all of them in one file (Mesh.PartitionSplitMeshFiles = 0)"
    )))
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
            nodes.push(Node { tag, place: [0.0; 3] });
        }
        for node in &mut nodes[first..] {
            node.place = read_place(cursor)?;
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

/// The coordinates x, y, z of a node.
fn read_place(cursor: &mut Cursor) -> Result<[f64; 3]> {
    let mut place = [0.0; 3];
    for coordinate in &mut place {
        *coordinate = cursor.double("a coordinate of a node")?;
    }
    Ok(place)
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
        for i in 0..count {
            let start = cursor.here();
            let tag = cursor.size("the tag of an element")?;
            let kind = kind(cursor, start, tag, number)?;
            if i == 0 {
                cursor.make_room(&mut elements.all, count)?;
            }
            read_element(cursor, kind, tag, entity, &mut elements)?;
        }
    }
    Ok(elements)
}

/// The kind of the element `tag`, whose type has this number.
fn kind(cursor: &Cursor, start: usize, tag: usize, number: i32) -> Result<Kind> {
    Kind::of_gmsh(number)
        .map_err(|found| cursor.wrong_at(start, format!("element {tag} is {found}")))
}

/// Reads the nodes of the element `tag` on `entity`.
fn read_element(
    cursor: &mut Cursor,
    kind: Kind,
    tag: usize,
    entity: i32,
    elements: &mut Elements,
) -> Result<()> {
    let mut nodes = [0; Kind::MOST_NODES];
    for node in &mut nodes[..kind.nodes] {
        *node = cursor.size("the tag of a node")?;
    }
    elements.add(kind, tag, &nodes[..kind.nodes], entity);
    Ok(())
}

/// `$Nodes` of MSH 2: a count, then tag, x, y, z of each node; in `$ParametricNodes` then dimension and tag of an entity, and the
/// parameters on it.
fn read_nodes_of_2(cursor: &mut Cursor, is_parametric: bool) -> Result<Vec<Node>> {
    let mut nodes = Vec::new();
    for _ in 0..cursor.count("the number of nodes")? {
        let tag = cursor.size("the tag of a node")?;
        nodes.push(Node { tag, place: read_place(cursor)? });
        if is_parametric {
            let dimension = cursor.int_within(0..=3, "a dimension from 0 to 3")?;
            cursor.int("the tag of an entity")?;
            // A node in a volume has none.
            for _ in 0..dimension % 3 {
                cursor.double("a parameter of a node")?;
            }
        }
    }
    Ok(nodes)
}

/// `$Elements` of MSH 2: a count, then of each element, in a text file: tag, type, the number of its labels, the labels (the
/// first is the physical group, 0 for none, the second the entity), the nodes. In a binary file elements of one type follow
/// each other: type, how many, the number of labels, and of each tag, labels, nodes. An element of two groups appears once for each.
/// The third label, if there is one, is the number of partitions, and those follow. Returns the elements on entities of their own for
/// each pair of labels, the groups of those, and a remark where the file may be a part of a mesh.
fn read_elements_of_2(cursor: &mut Cursor) -> Result<(Elements, Groups, Option<String>)> {
    const LABELS: &str = "the number of labels";
    let (mut elements, mut groups) = (Elements::default(), Groups::default());
    let mut partitions = BTreeSet::new();
    let mut entities: HashMap<[i32; 2], i32> = HashMap::new();
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
            let mut first = [0; 4];
            for label in 0..labels {
                let value = cursor.int("a label of an element")?;
                if let Some(of_first) = first.get_mut(label) {
                    // A negative number says that the group runs against the direction of the curve.
                    *of_first = value.saturating_abs();
                }
            }
            let kind = kind(cursor, start, tag, number)?;
            let [group, entity, _, partition] = first;
            let pair = [group, entity];
            if partition > 0 && kind.dimension() == 2 {
                partitions.insert(partition);
            }
            let count = entities.len() as i32;
            let entity = *entities.entry(pair).or_insert(count);
            let of_entity = groups[kind.dimension()].entry(entity);
            of_entity.or_insert_with(|| Vec::from_iter(Some(group).filter(|&group| group != 0)));
            read_element(cursor, kind, tag, entity, &mut elements)?;
        }
        left -= together;
    }
    let remark = part_of_a_mesh(&partitions).map_err(|said| cursor.in_the_file(said))?;
    Ok((elements, groups, remark))
}

/// Says that triangles of one partition may be a part of the mesh: files by partition do not say how many there are.
///
/// # Errors
/// The partitions that are missing.
fn part_of_a_mesh(partitions: &BTreeSet<i32>) -> std::result::Result<Option<String>, String> {
    let most = partitions.last().copied().unwrap_or(0);
    match (1..most).find(|partition| !partitions.contains(partition)) {
        Some(missing) => Err(format!(
            "the file has triangles of partition {most} of the mesh, and none of partition {missing}; expected all of them in one file (Mesh.PartitionSplitMeshFiles = 0)"
        )),
        None if most == 1 => Ok(Some("all triangles are in partition 1: where a mesh is split into a file for each of its partitions, this one is a part of it".to_owned())),
        None => Ok(None),
    }
}
