//! Friction: `contact.friction` of a `[boundary.NAME]`, `friction` of a `[[pair]]`.

use std::collections::BTreeMap;

use super::table::{Table, Value};
use crate::contact::Friction;
use crate::io::input::FileError;

/// The expectation in place of friction in a body of revolution.
pub(super) const NOT_IN_REVOLUTION: &str =
    "no friction in a body of revolution, where it is not computed by this program";

/// Reads the friction of each boundary that has some.
pub(super) fn read_friction(
    root: &Table,
    of_revolution: bool,
) -> Result<BTreeMap<String, Friction>, FileError> {
    let mut all = BTreeMap::new();
    let Some(boundaries) = root.section("boundary")? else { return Ok(all) };
    for key in boundaries.keys_of_tables() {
        let boundary = boundaries.subsection(key)?;
        let Some(contact) = boundary.get("contact").filter(Value::is_table) else { continue };
        let contact = contact.table()?;
        if let Some(friction) = contact.get("friction").filter(|_| of_revolution) {
            return Err(friction.wrong(NOT_IN_REVOLUTION));
        }
        if let Some(friction) = contact.optional("friction", read)? {
            all.insert(key.to_owned(), friction);
        }
    }
    Ok(all)
}

pub(super) fn read(value: &Value) -> Result<Friction, FileError> {
    let table = value.table_such_as("a table, such as { coulomb = 0.3 } or { tresca = \"5\" }")?;
    let laws = ["tresca", "coulomb"];
    table.only(&laws)?;
    let expected = "either tresca or coulomb";
    let [law] = table.given(&laws)[..] else { return Err(table.combination(&laws, expected)) };
    let given = table.require(law, expected)?;
    if law == "coulomb" {
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
