//! The table [mesh] of a case file: a rectangle, the trapezoid of an exact solution, or a mesh by Gmsh.

use std::path::{Path, PathBuf};

use super::exact::angle;
use super::table::{Table, Value};
use crate::contact::Pair;
use crate::io::expression::PlaceCondition;
use crate::io::gmsh;
use crate::io::input::FileError;
use crate::io::raw_mesh::Made;
use crate::model::structured::MOST_CELLS;
use crate::model::{Diagonal, Mesh, Perturbation, Rectangle, Structured, Trapezoid};
use crate::quote::quoted;

/// A mesh and how it was made.
pub(super) struct Meshed {
    pub(crate) mesh: Mesh,
    pub(crate) structured: Option<Structured>,
    pub(crate) perturbation: Option<Perturbation>,
    pub(crate) file: Option<PathBuf>,
    /// Decisions made when the file was read, in sentences for people.
    pub(crate) remarks: Vec<String>,
}

impl From<Mesh> for Meshed {
    fn from(mesh: Mesh) -> Meshed {
        Meshed { mesh, structured: None, perturbation: None, file: None, remarks: Vec::new() }
    }
}

/// The mesh that is `given`, or else that of the table, with the boundaries that the case names by their places; `directory` is
/// the one of the case file. Boundaries of `pairs` may touch each other.
pub(super) fn read_mesh(
    root: &Table,
    given: Option<Mesh>,
    directory: &Path,
    pairs: &[Pair],
) -> Result<Meshed, FileError> {
    let meshed = match (given, root.section("mesh")?) {
        (Some(_), Some(table)) => {
            return Err(table.at.found("a mesh beside the one that is given", "one of the two"));
        }
        (Some(mesh), None) => mesh.into(),
        (None, _) => {
            let expected = "rectangle = { .. } or gmsh = \"..\" in it";
            make_mesh(&root.required_section("mesh", expected)?, directory, pairs)?
        }
    };
    Ok(Meshed { mesh: with_places(root, meshed.mesh)?, ..meshed })
}

/// The mesh with the boundaries that have a key `where`.
fn with_places(root: &Table, mut mesh: Mesh) -> Result<Mesh, FileError> {
    let Some(boundaries) = root.section("boundary")? else { return Ok(mesh) };
    for name in boundaries.keys_of_tables() {
        let Some(place) = boundaries.subsection(name)?.get("where") else { continue };
        let text = place.text()?;
        let condition: PlaceCondition = text.parse().map_err(|error| {
            place.at.wrong(format!("{} = {}: {error}", place.at.name, quoted(text, '"')))
        })?;
        let named = mesh.with_boundary(name, |at| condition.holds(at));
        mesh = named.map_err(|error| place.at.about(error))?;
    }
    Ok(mesh)
}

fn make_mesh(table: &Table, directory: &Path, pairs: &[Pair]) -> Result<Meshed, FileError> {
    const SHAPES: [&str; 3] = ["rectangle", "trapezoid", "gmsh"];
    table.only(&["rectangle", "trapezoid", "gmsh", "perturb", "merge"])?;
    let perturbation = table.optional("perturb", read_perturbation)?;
    let merge = table.optional("merge", read_merge)?;
    let shapes = table.given(&SHAPES);
    if merge.is_some() && !shapes.contains(&"gmsh") {
        return Err(table.combination(&[SHAPES[0], SHAPES[1], "merge"], "merge beside gmsh only"));
    }
    let &[shape] = shapes.as_slice() else {
        let expected = format!("exactly one of {}", SHAPES.join(", "));
        return Err(table.combination(&SHAPES, &expected));
    };
    let value = table.require(shape, "a mesh")?;
    if shape == "gmsh" {
        if perturbation.is_some() {
            let expected = "perturb beside rectangle or trapezoid only";
            return Err(table.combination(&["gmsh", "perturb"], expected));
        }
        let name = value.text()?;
        if name.is_empty() {
            return Err(value.wrong("the name of a mesh file"));
        }
        let file = directory.join(name);
        let Made { mesh, remarks } = gmsh::read(&file, merge, pairs).map_err(|error| {
            value.at.wrong(error.error.clone().map(|_| format!("[mesh] gmsh: {error}")))
        })?;
        return Ok(Meshed { file: Some(file), remarks, ..mesh.into() });
    }
    let of = value.table()?;
    let structured = if shape == "rectangle" { read_rectangle(&of)? } else { read_trapezoid(&of)? };
    let mesh = structured.mesh(perturbation).map_err(|error| of.at.about(error))?;
    Ok(Meshed { structured: Some(structured), perturbation, ..mesh.into() })
}

fn read_trapezoid(table: &Table) -> Result<Structured, FileError> {
    table.only(&["omega", "n"])?;
    let (omega, _) = angle(table)?;
    let n = table.require("n", "a number of cells")?.whole_number(1..=MOST_CELLS.isqrt())?;
    Ok(Structured::Trapezoid(Trapezoid { omega, n }))
}

/// The largest share of the body within which vertices may be merged: those further apart are distinct on purpose.
const MOST_MERGED: f64 = 0.01;

fn read_merge(value: &Value) -> Result<f64, FileError> {
    let expected = format!("a share of the body's size, above 0 and at most {MOST_MERGED}");
    value.number_that(|share| 0.0 < share && share <= MOST_MERGED, &expected)
}

/// The largest move of a vertex, in cells: by more, triangles may turn over.
const MOST_MOVED: f64 = 0.25;

fn read_perturbation(value: &Value) -> Result<Perturbation, FileError> {
    let table = value.table()?;
    table.only(&["amount", "seed"])?;
    let expected = format!("a number of cells from 0 to {MOST_MOVED}");
    let amount = table.number_that("amount", |a| (0.0..=MOST_MOVED).contains(&a), &expected)?;
    let seed = table.optional("seed", |seed| seed.whole_number(0..=MOST_SEEDS))?;
    Ok(Perturbation { amount, seed: seed.unwrap_or(0) as u64 })
}

/// Seeds that every reader of TOML can hold.
const MOST_SEEDS: usize = 1 << 31;

fn read_rectangle(table: &Table) -> Result<Structured, FileError> {
    table.only(&["width", "height", "nx", "ny", "diagonal"])?;
    let length = |key| table.require(key, "a length")?.positive();
    let cells = |key| table.require(key, "a number of cells")?.whole_number(1..=MOST_CELLS);
    let [width, height] = [length("width")?, length("height")?];
    let [nx, ny] = [cells("nx")?, cells("ny")?];
    let diagonals =
        [("right", Diagonal::Right), ("left", Diagonal::Left), ("crossed", Diagonal::Crossed)];
    let diagonal = table.optional("diagonal", |value| value.one_of(&diagonals))?;
    let diagonal = diagonal.unwrap_or(Diagonal::Right);
    Ok(Structured::Rectangle(Rectangle { width, height, nx, ny, diagonal }))
}
