//! The section \[exact\] of a case file: a built-in exact solution, which supplies loads, boundary data and gap.
//! Their parameters: docs/case.md, which a test compares with what is read here.
//!
//! The solutions themselves: [`exact`](crate::exact).

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use super::table::{Table, Value};
use crate::exact::{Corner, Exact, Kind, Patch, Singular, Smooth};
use crate::io::input::FileError;
use crate::kernel::Material;

/// Reads the parameters of a solution, beside the key that names it.
type Read = fn(&Table, Material<f64>) -> Result<Exact, FileError>;

/// The solution that the section describes.
pub(crate) fn read_exact(table: &Table, material: Material<f64>) -> Result<Exact, FileError> {
    let solutions: [(&str, Read); 4] = [
        ("smooth", read_smooth),
        ("singular", read_singular),
        ("corner", read_corner),
        ("patch", |table, material| Ok(Arc::new(read_patch(table, material)?))),
    ];
    let solution = table.require("solution", "the name of an exact solution")?;
    solution.one_of(&solutions)?(table, material)
}

fn read_smooth(table: &Table, material: Material<f64>) -> Result<Exact, FileError> {
    table.only(&["solution", "c", "k", "m", "ap", "aq", "gap"])?;
    Ok(Arc::new(Smooth {
        material,
        c: inside(table, "c")?,
        k: above(table, "k", 2.5)?,
        m: above(table, "m", 1.5)?,
        ap: above(table, "ap", 0.0)?,
        aq: above(table, "aq", 0.0)?,
        gap: coefficients(table.get("gap"))?,
    }))
}

fn read_singular(table: &Table, material: Material<f64>) -> Result<Exact, FileError> {
    table.only(&["solution", "c", "amplitude"])?;
    let amplitude = above(table, "amplitude", 0.0)?;
    Ok(Arc::new(Singular { material, c: inside(table, "c")?, amplitude }))
}

fn read_corner(table: &Table, material: Material<f64>) -> Result<Exact, FileError> {
    table.only(&["solution", "omega"])?;
    let (omega, value) = angle(table)?;
    Ok(Arc::new(Corner::new(material, omega).ok_or_else(|| value.wrong(ANGLE))?))
}

const ANGLE: &str = "an angle between pi/2 and pi";

/// omega, and where it stands.
pub(crate) fn angle<'s>(table: &Table<'s>) -> Result<(f64, Value<'s>), FileError> {
    let value = table.require("omega", ANGLE)?;
    Ok((value.number_that(|omega| FRAC_PI_2 < omega && omega < PI, ANGLE)?, value))
}

fn read_patch(table: &Table, material: Material<f64>) -> Result<Patch, FileError> {
    let tests = [
        ("d1", &["p"][..]),
        ("d2", &["p", "d"]),
        ("d3", &["p", "w", "g0"]),
        ("d4", &[]),
        ("d5", &["d"]),
    ];
    let which = table.require("which", "d1, d2, d3, d4 or d5 in quotes")?;
    let keys = which.one_of(&tests)?;
    table.only(&[&["solution", "which"], keys].concat())?;
    let number = |key| table.require(key, "a number")?.number();
    Ok(match which.text()? {
        "d1" => Patch::compression(material, above(table, "p", 0.0)?),
        "d2" => Patch::separation(material, number("p")?, above(table, "d", 0.0)?),
        "d3" => Patch::inclined(material, above(table, "p", 0.0)?, number("w")?, number("g0")?),
        "d4" => Patch::grazing(material),
        _ => Patch::interference(material, above(table, "d", 0.0)?),
    })
}

fn above(table: &Table, key: &str, least: f64) -> Result<f64, FileError> {
    table.number_that(key, |value| value > least, &format!("a number above {least}"))
}

/// A place on the contact line (0, 1).
fn inside(table: &Table, key: &str) -> Result<f64, FileError> {
    table.number_that(key, |c| 0.0 < c && c < 1.0, "a number above 0 and below 1")
}

/// The gap function of a smooth solution: the solution needs its derivatives, so it is a polynomial.
fn coefficients(gap: Option<Value>) -> Result<Vec<f64>, FileError> {
    let Some(gap) = gap else { return Ok(Vec::new()) };
    let expression = gap.expression()?;
    expression.polynomial_in_x().ok_or_else(|| gap.wrong("a polynomial in x"))
}

/// Reads the condition on a boundary: beside \[exact\], \[boundary\] has a kind for each.
pub(crate) fn read_kind(value: &Value) -> Result<Kind, FileError> {
    value.one_of(&[
        ("displacement", Kind::Displacement),
        ("traction", Kind::Traction),
        ("contact", Kind::Contact),
    ])
}
