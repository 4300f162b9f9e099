//! `[[pair]]` of a case file: boundaries that touch each other.

use super::friction;
use super::table::{Spot, Table, Value};
use crate::contact::{Law, Pair};
use crate::io::input::FileError;
use crate::model::Mesh;
use crate::model::mesh::split::split_names;
use crate::quote::{key, quoted};

/// A pair and where the file has it.
pub(super) struct ReadPair<'s> {
    at: Spot<'s>,
    pair: Pair,
    /// The surfaces along whose common curve the mesh is to be split.
    surfaces: Option<[String; 2]>,
}

/// Reads all pairs, before there is a mesh.
pub(super) fn read_pairs<'s>(root: &Table<'s>) -> Result<Vec<ReadPair<'s>>, FileError> {
    let Some(all) = root.get("pair") else { return Ok(Vec::new()) };
    if all.is_table() {
        return Err(all.wrong("a list of tables, each under [[pair]]"));
    }
    all.items()?.into_iter().map(|entry| read_pair(entry.section("[[pair]]".to_owned())?)).collect()
}

fn read_pair(table: Table) -> Result<ReadPair, FileError> {
    table.only(&["boundaries", "surfaces", "clearance", "reach", "law", "friction"])?;
    let sides = ["boundaries", "surfaces"];
    let (boundaries, surfaces) = match table.given(&sides)[..] {
        ["boundaries"] => (names(&table.require("boundaries", "two names")?)?, None),
        ["surfaces"] => {
            let surfaces = names(&table.require("surfaces", "two names")?)?;
            (split_names(&surfaces), Some(surfaces))
        }
        _ => {
            let expected =
                "either boundaries = [\"pin\", \"hole\"] or surfaces = [\"steel\", \"rubber\"]";
            return Err(table.combination(&sides, expected));
        }
    };
    let mut pair = Pair { boundaries, ..Pair::new("", "") };
    if let Some(clearance) = table.get("clearance").filter(|value| value.as_text() != Some("auto"))
    {
        pair.clearance = Some(clearance.function()?);
    }
    pair.reach = table.optional("reach", Value::positive)?;
    let laws = [("contact", Law::Contact), ("sliding", Law::Sliding), ("bonded", Law::Bonded)];
    table.set("law", &mut pair.law, |law| law.one_of(&laws))?;
    if let Some(friction) = table.get("friction").filter(|_| pair.law != Law::Contact) {
        return Err(friction.wrong("no friction, or law = \"contact\""));
    }
    pair.friction = table.optional("friction", friction::read)?;
    Ok(ReadPair { at: table.at, pair, surfaces })
}

/// The names of two things that are not one.
fn names(value: &Value) -> Result<[String; 2], FileError> {
    let expected = "a list of two names";
    let items = value.items()?;
    let [first, second] = &items[..] else { return Err(value.wrong(expected)) };
    let names = [first.text()?.to_owned(), second.text()?.to_owned()];
    if names[0] == names[1] {
        return Err(second.wrong("another name than the first"));
    }
    Ok(names)
}

/// The pairs whose boundaries the mesh has as it is read.
pub(super) fn of_boundaries(pairs: &[ReadPair]) -> Vec<Pair> {
    pairs.iter().filter(|read| read.surfaces.is_none()).map(|read| read.pair.clone()).collect()
}

/// The mesh split between surfaces that are pairs.
pub(super) fn split(mut mesh: Mesh, pairs: &[ReadPair]) -> Result<Mesh, FileError> {
    for ReadPair { at, surfaces, .. } in pairs {
        if let Some(surfaces) = surfaces {
            mesh = mesh.split_between(surfaces).map_err(|error| at.about(error))?;
        }
    }
    Ok(mesh)
}

/// The pairs of a problem on this mesh: their boundaries are there, and have no condition.
pub(super) fn on_mesh(
    root: &Table,
    pairs: Vec<ReadPair>,
    mesh: &Mesh,
    of_revolution: bool,
) -> Result<Vec<Pair>, FileError> {
    let conditions = root.section("boundary")?;
    let mut checked: Vec<Pair> = Vec::new();
    for ReadPair { at, pair, .. } in pairs {
        if of_revolution && pair.friction.is_some() {
            return Err(at.found("friction", friction::NOT_IN_REVOLUTION));
        }
        for name in &pair.boundaries {
            if mesh.edges_of(name).map_err(|error| at.about(error))?.is_empty() {
                let found = format!("no edge on the boundary {}", quoted(name, '\''));
                return Err(at.found(&found, "at least one"));
            }
            let has_condition = |all: &&Table| {
                // A table with nothing but the place of the boundary is no condition.
                let only_place =
                    |value: Value| value.table().is_ok_and(|table| table.keys().eq(["where"]));
                all.get(name).is_some_and(|value| !only_place(value))
            };
            if let Some(conditions) = conditions.as_ref().filter(has_condition) {
                let expected =
                    format!("nothing for {}, whose contact is that of its [[pair]]", key(name));
                return Err(conditions.under_header(name).found("a condition", &expected));
            }
        }
        let is_same = |other: &Pair| {
            let [a, b] = &other.boundaries;
            [a, b] == pair.boundaries.each_ref() || [b, a] == pair.boundaries.each_ref()
        };
        if checked.iter().any(is_same) {
            let [first, second] = pair.boundaries.each_ref().map(|name| quoted(name, '\''));
            let found = format!("{first} and {second} a second time");
            return Err(at.found(&found, "each pair once"));
        }
        checked.push(pair);
    }
    Ok(checked)
}
