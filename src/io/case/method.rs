//! The tables [method], [solver], [adapt] and [certify] of a case file: how to solve, and what to prove.

use std::collections::BTreeMap;

use super::table::{Table, Value};
use crate::certificates::{Asked, Ramp, Target};
use crate::contact::Pair;
use crate::io::input::FileError;
use crate::model::structured::MOST_CELLS;
use crate::model::{Condition, Degree};
use crate::solve::{
    ContactQuadrature, Gamma0, MOST_GAUSS_POINTS, MOST_ITERATIONS, Method, Settings,
};

/// `method` has the defaults.
pub(super) fn read_method(table: &Table, mut method: Method) -> Result<Method, FileError> {
    table.only(&["degree", "gamma0", "kappa", "contact_quadrature", "allow_noncoercive"])?;
    table.set("degree", &mut method.degree, |degree| {
        match degree.whole_number(1..=2).map_err(|_| degree.wrong("1 or 2"))? {
            1 => Ok(Degree::One),
            _ => Ok(Degree::Two),
        }
    })?;
    table.set("gamma0", &mut method.gamma0, |gamma0| {
        let expected = "a positive number or \"auto\"";
        match gamma0.as_text() {
            Some("auto") => Ok(Gamma0::Auto),
            Some(_) => Err(gamma0.wrong(expected)),
            None => Ok(Gamma0::Value(gamma0.number_that(|g| g > 0.0, expected)?)),
        }
    })?;
    table.set("kappa", &mut method.gamma0, |kappa| match table.get("gamma0") {
        Some(_) => Err(kappa.wrong("gamma0 or kappa, not both")),
        None => Ok(Gamma0::Local(kappa.positive()?)),
    })?;
    table.set("contact_quadrature", &mut method.quadrature, read_quadrature)?;
    table.set("allow_noncoercive", &mut method.allow_noncoercive, Value::flag)?;
    Ok(method)
}

fn read_quadrature(value: &Value) -> Result<ContactQuadrature, FileError> {
    if value.as_text() == Some("exact") {
        return Ok(ContactQuadrature::Exact);
    }
    let table = value.table_such_as("\"exact\" or { gauss = points per edge }")?;
    table.only(&["gauss"])?;
    let points = table.require("gauss", "a number of points per edge")?;
    points.whole_number(1..=MOST_GAUSS_POINTS).map(ContactQuadrature::Gauss)
}

pub(super) fn read_settings(table: &Table) -> Result<Settings, FileError> {
    let mut settings = Settings::default();
    table.only(&["tolerance", "max_iterations", "proof"])?;
    let share = |x: &Value| x.number_that(|x| 0.0 < x && x < 1.0, "a number above 0 and below 1");
    table.set("tolerance", &mut settings.tolerance, share)?;
    table.set("proof", &mut settings.proof, share)?;
    let most = |most: &Value| most.whole_number(1..=MOST_ITERATIONS);
    table.set("max_iterations", &mut settings.max_iterations, most)?;
    Ok(settings)
}

/// The default limit of unknowns up to which meshes are refined.
pub(super) const MOST_UNKNOWNS: usize = 500_000;

type Conditions = BTreeMap<String, Condition>;

/// Refuses a name that is not one of a contact boundary; `value` is where it stands.
fn contact_boundary(
    name: &str,
    value: &Value,
    conditions: &Conditions,
) -> Result<String, FileError> {
    match conditions.get(name) {
        Some(condition) if condition.is_contact() => Ok(name.to_owned()),
        _ => Err(value.wrong("the name of a contact boundary with an obstacle or a gap")),
    }
}

/// Reads a target, and the boundary whose contact force it is about, if it is about one.
pub(super) fn read_target(
    table: &Table,
    conditions: &Conditions,
    pairs: &[Pair],
) -> Result<(Target, Option<String>), FileError> {
    table.only(&["target", "max_unknowns"])?;
    let expected = "a share above 0 % and below 100 %, such as \"1 %\", of the energy norm, or { force = \"bottom\", within = \"1 %\" }";
    let mut target = table.require("target", expected)?;
    let mut force = None;
    if target.is_table() {
        let of_force = target.table()?;
        of_force.only(&["force", "within"])?;
        let boundary = of_force.require("force", "the name of a contact boundary")?;
        let name = boundary.text()?;
        force = Some(if pairs.iter().any(|pair| pair.boundaries[0] == name) {
            name.to_owned()
        } else {
            contact_boundary(name, &boundary, conditions)?
        });
        target = of_force.require("within", "a share of the force, such as \"1 %\"")?;
    }
    let percent = target.as_text().and_then(|text| text.strip_suffix('%'));
    let percent = percent.and_then(|number| number.trim().parse::<f64>().ok());
    let relative = percent.map(|percent| percent / 100.0).filter(|&r| 0.0 < r && r < 1.0);
    let mut max_unknowns = MOST_UNKNOWNS;
    table.set("max_unknowns", &mut max_unknowns, |most| most.whole_number(1..=2 * MOST_CELLS))?;
    let relative = relative.ok_or_else(|| target.wrong(expected))?;
    Ok((Target { relative, max_unknowns }, force))
}

/// The forces in the list `quantities` of \[certify\]: `force NAME`, or `force NAME x 0 0.25 ramp 0.1` for a weight along x or
/// y that is 1 between two numbers and falls to 0 over a width.
pub(super) fn read_quantities(table: &Table, conditions: &Conditions) -> Result<Asked, FileError> {
    table.only(&["quantities"])?;
    let expected = "\"force NAME\" or \"force NAME x 0 0.25 ramp 0.1\": a contact boundary, and where along x or y its pressure counts";
    let list = table.require("quantities", &format!("a list of {expected}"))?;
    let of = |value: &Value| {
        let words = value.text()?.strip_prefix("force ").map(str::trim);
        let (name, weight) = words.and_then(force).ok_or_else(|| value.wrong(expected))?;
        Ok((contact_boundary(name, value, conditions)?, weight))
    };
    Ok(Asked { forces: list.items()?.iter().map(of).collect::<Result<_, _>>()? })
}

/// A name, and behind it a weight if there is one.
fn force(words: &str) -> Option<(&str, Option<Ramp>)> {
    let Some((rest, width)) = words.rsplit_once(" ramp ") else { return Some((words, None)) };
    let mut parts = rest.rsplitn(4, ' ');
    let [to, from, axis, name] = [(); 4].map(|()| parts.next());
    let number = |word: &str| word.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let axis = ["x", "y"].iter().position(|other| Some(*other) == axis)?;
    let (between, width) = ([number(from?)?, number(to?)?], number(width)?);
    let is_weight = between[0] <= between[1] && width > 0.0;
    is_weight.then_some((name?, Some(Ramp { axis, between, width })))
}
