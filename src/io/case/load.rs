//! The table \[load\] of a case file: forces in the body, on all of it and on physical surfaces one by one.

use std::sync::Arc;

use super::material::on_surface;
use super::table::{Table, Value};
use crate::fem::{Mesh, SharedFunction, SurfaceForce};
use crate::io::expression::Expression;
use crate::io::input::FileError;
use crate::study::{Exact, exact};

/// The force on the whole body, and those on its surfaces; an exact solution has its own.
pub(super) fn read_loads(
    root: &Table,
    solution: Option<&Exact>,
    mesh: &Mesh,
) -> Result<([SharedFunction; 2], Vec<SurfaceForce>), FileError> {
    let none = || [constant(0.0), constant(0.0)];
    let Some(table) = root.section("load")? else {
        return Ok((solution.map_or_else(none, exact::body_force), Vec::new()));
    };
    if solution.is_some() {
        let expected = "one of the two: an exact solution supplies its own";
        return Err(table.at.found("loads beside [exact]", expected));
    }
    let surfaces = table.keys_of_tables();
    table.only(&[&["body"], surfaces.as_slice()].concat())?;
    let mut forces = Vec::new();
    for key in surfaces {
        let one = table.subsection(key)?;
        one.only(&["body"])?;
        let force = one.require("body", "a list of two: one for x, one for y")?.functions()?;
        let triangles = on_surface(mesh, &one.at, key)?.to_vec();
        forces.push(SurfaceForce { surface: key.to_owned(), triangles, force });
    }
    Ok((table.optional("body", Value::functions)?.unwrap_or_else(none), forces))
}

/// A function that is the same everywhere.
pub(super) fn constant(value: f64) -> SharedFunction {
    Arc::new(Expression::from(value))
}
