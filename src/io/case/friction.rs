//! Friction on contact boundaries: `contact.friction` of a `[boundary.NAME]`.

use std::collections::BTreeMap;

use super::table::{Table, Value};
use crate::fem::Friction;
use crate::io::input::FileError;

/// Reads the friction of each boundary that has some.
pub(super) fn read_friction(root: &Table) -> Result<BTreeMap<String, Friction>, FileError> {
    let mut all = BTreeMap::new();
    let Some(boundaries) = root.section("boundary")? else { return Ok(all) };
    for key in boundaries.keys_of_tables() {
        let boundary = boundaries.subsection(key)?;
        let Some(contact) = boundary.get("contact").filter(Value::is_table) else { continue };
        if let Some(friction) = contact.table()?.optional("friction", read)? {
            all.insert(key.to_owned(), friction);
        }
    }
    Ok(all)
}

fn read(value: &Value) -> Result<Friction, FileError> {
    if !value.is_table() {
        return Err(value.wrong("a table, such as { coulomb = 0.3 } or { tresca = \"5\" }"));
    }
    let table = value.table()?;
    let given = table.exactly_one(&["tresca", "coulomb"])?;
    if table.get("coulomb").is_some() {
        let is_coefficient = |mu: f64| mu >= 0.0 && mu.is_finite();
        let expected = "a coefficient, a number that is not negative";
        return given.number_that(is_coefficient, expected).map(Friction::Coulomb);
    }
    let bound = given.function()?;
    // Any other expression is looked at along the boundary.
    if bound.degree() == Some(0) && bound.at([0.0; 2]) < 0.0 {
        return Err(given.wrong("a stress that is not negative"));
    }
    Ok(Friction::Tresca(bound))
}
