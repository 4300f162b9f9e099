//! The table [mesh] of a case file: a rectangle, the trapezoid of an exact solution, or a mesh by Gmsh.

use std::path::{Path, PathBuf};

use super::exact::angle;
use super::gmsh;
use super::mistake::{CaseError, CaseMistake};
use super::table::{Table, Value};
use crate::fem::structured::MOST_CELLS;
use crate::fem::{Diagonal, Mesh, Perturbation, Rectangle, Structured, Trapezoid};

/// A mesh and how it was made.
pub(super) struct Meshed {
    pub mesh: Mesh,
    pub structured: Option<Structured>,
    pub perturbation: Option<Perturbation>,
    pub file: Option<PathBuf>,
}

/// `directory` is the one of the case file.
pub(super) fn read_mesh(table: &Table, directory: &Path) -> Result<Meshed, CaseError> {
    const SHAPES: [&str; 3] = ["rectangle", "trapezoid", "gmsh"];
    table.only(&["rectangle", "trapezoid", "gmsh", "perturb", "merge"])?;
    let perturbation = table.get("perturb").map(|value| read_perturbation(&value)).transpose()?;
    let merge = table.get("merge").map(|value| read_merge(&value)).transpose()?;
    let shapes = SHAPES.map(|key| table.get(key));
    if merge.is_some() && shapes[2].is_none() {
        return Err(table.combination(&[SHAPES[0], SHAPES[1], "merge"], "merge beside gmsh only"));
    }
    let (value, structured) = match shapes {
        [Some(value), None, None] => {
            let rectangle = read_rectangle(&value.table()?)?;
            (value, Structured::Rectangle(rectangle))
        }
        [None, Some(value), None] => {
            let trapezoid = read_trapezoid(&value.table()?)?;
            (value, Structured::Trapezoid(trapezoid))
        }
        [None, None, Some(value)] => {
            if perturbation.is_some() {
                return Err(table.combination(
                    &["gmsh", "perturb"],
                    "perturb beside rectangle or trapezoid only",
                ));
            }
            let name = value.text()?;
            if name.is_empty() {
                return Err(value.wrong("the name of a mesh file"));
            }
            let file = directory.join(name);
            let mesh =
                merge.map_or_else(|| gmsh::read(&file), |share| gmsh::read_merged(&file, share));
            let mesh = mesh.map_err(|error| value.mistake(CaseMistake::Gmsh(error)))?;
            return Ok(Meshed { mesh, structured: None, perturbation: None, file: Some(file) });
        }
        _ => {
            let expected = format!("exactly one of {}", SHAPES.join(", "));
            return Err(table.combination(&SHAPES, &expected));
        }
    };
    let mesh = structured.mesh(perturbation).map_err(|error| {
        let name = value.name().to_owned();
        value.mistake(CaseMistake::Mesh { name, error })
    })?;
    Ok(Meshed { mesh, structured: Some(structured), perturbation, file: None })
}

fn read_trapezoid(table: &Table) -> Result<Trapezoid, CaseError> {
    table.only(&["omega", "n"])?;
    let (omega, _) = angle(table)?;
    let most = MOST_CELLS.isqrt();
    Ok(Trapezoid { omega, n: table.require("n", "a number of cells")?.whole_number(1..=most)? })
}

/// Vertices further apart than this share of the body are not one by mistake.
const MOST_MERGED: f64 = 0.01;

fn read_merge(value: &Value) -> Result<f64, CaseError> {
    let expected = format!("a share of the body's size, above 0 and at most {MOST_MERGED}");
    value.number_that(|share| 0.0 < share && share <= MOST_MERGED, &expected)
}

/// Beyond this share of a cell, triangles may turn over.
const MOST_MOVED: f64 = 0.25;

fn read_perturbation(value: &Value) -> Result<Perturbation, CaseError> {
    let table = value.table()?;
    table.only(&["amount", "seed"])?;
    let expected = format!("a number of cells from 0 to {MOST_MOVED}");
    let amount = table.require("amount", &expected)?;
    let amount = amount.number_that(|a| (0.0..=MOST_MOVED).contains(&a), &expected)?;
    let seed = table.get("seed").map_or(Ok(0), |seed| seed.whole_number(0..=MOST_SEEDS))?;
    Ok(Perturbation { amount, seed: seed as u64 })
}

/// Seeds that every reader of TOML can hold.
const MOST_SEEDS: usize = 1 << 31;

fn read_rectangle(table: &Table) -> Result<Rectangle, CaseError> {
    table.only(&["width", "height", "nx", "ny", "diagonal"])?;
    let length =
        |key| table.require(key, "a length")?.number_that(|x| x > 0.0, "a positive number");
    let cells = |key| table.require(key, "a number of cells")?.whole_number(1..=MOST_CELLS);
    Ok(Rectangle {
        width: length("width")?,
        height: length("height")?,
        nx: cells("nx")?,
        ny: cells("ny")?,
        diagonal: match table.get("diagonal") {
            Some(diagonal) => diagonal.one_of(&[
                ("right", Diagonal::Right),
                ("left", Diagonal::Left),
                ("crossed", Diagonal::Crossed),
            ])?,
            None => Diagonal::Right,
        },
    })
}
