//! The tables [method], [solver] and [adapt] of a case file: how it is solved.

use super::mistake::CaseError;
use super::table::{Table, Value};
use crate::certify::Target;
use crate::fem::rectangle::MOST_CELLS;
use crate::solve::{
    ContactQuadrature, Degree, Gamma0, MOST_GAUSS_POINTS, MOST_ITERATIONS, Method, Settings,
};

pub(super) fn read_method(table: Option<Table>) -> Result<Method, CaseError> {
    let mut method = Method::default();
    let Some(table) = table else { return Ok(method) };
    table.only(&["degree", "gamma0", "kappa", "contact_quadrature", "allow_noncoercive"])?;
    if let Some(degree) = table.get("degree") {
        method.degree = match degree.whole_number(1..=2).map_err(|_| degree.wrong("1 or 2"))? {
            1 => Degree::One,
            _ => Degree::Two,
        };
    }
    if let Some(gamma0) = table.get("gamma0") {
        method.gamma0 = match gamma0.as_text() {
            Some("auto") => Gamma0::Auto,
            Some(_) => return Err(gamma0.wrong("a positive number or \"auto\"")),
            None => {
                Gamma0::Value(gamma0.number_that(|g| g > 0.0, "a positive number or \"auto\"")?)
            }
        };
    }
    if let Some(kappa) = table.get("kappa") {
        if table.get("gamma0").is_some() {
            return Err(kappa.wrong("gamma0 or kappa, not both"));
        }
        method.gamma0 = Gamma0::Local(kappa.number_that(|k| k > 0.0, "a positive number")?);
    }
    if let Some(quadrature) = table.get("contact_quadrature") {
        method.quadrature = read_quadrature(&quadrature)?;
    }
    if let Some(allow) = table.get("allow_noncoercive") {
        method.allow_noncoercive = allow.flag()?;
    }
    Ok(method)
}

fn read_quadrature(value: &Value) -> Result<ContactQuadrature, CaseError> {
    if value.as_text() == Some("exact") {
        return Ok(ContactQuadrature::Exact);
    }
    if !value.is_table() {
        return Err(value.wrong("\"exact\" or { gauss = points per edge }"));
    }
    let table = value.table()?;
    table.only(&["gauss"])?;
    let points = table.require("gauss", "a number of points per edge")?;
    Ok(ContactQuadrature::Gauss(points.whole_number(1..=MOST_GAUSS_POINTS)?))
}

pub(super) fn read_settings(table: Option<Table>) -> Result<Settings, CaseError> {
    let mut settings = Settings::default();
    let Some(table) = table else { return Ok(settings) };
    table.only(&["tolerance", "max_iterations", "proof"])?;
    for (key, setting) in [("tolerance", &mut settings.tolerance), ("proof", &mut settings.proof)] {
        if let Some(value) = table.get(key) {
            *setting = value.number_that(|x| 0.0 < x && x < 1.0, "a number above 0 and below 1")?;
        }
    }
    if let Some(most) = table.get("max_iterations") {
        settings.max_iterations = most.whole_number(1..=MOST_ITERATIONS)?;
    }
    Ok(settings)
}

/// Meshes are refined up to so many unknowns where the case says nothing.
pub(super) const MOST_UNKNOWNS: usize = 500_000;

pub(super) fn read_target(table: &Table) -> Result<Target, CaseError> {
    table.only(&["target", "max_unknowns"])?;
    let expected = "a share of the energy norm above 0 % and below 100 %, such as \"1 %\"";
    let target = table.require("target", expected)?;
    let percent = target.as_text().and_then(|text| text.strip_suffix('%'));
    let percent = percent.and_then(|number| number.trim().parse::<f64>().ok());
    let relative = percent.map(|percent| percent / 100.0).filter(|&r| 0.0 < r && r < 1.0);
    let most = 2 * MOST_CELLS;
    let unknowns =
        table.get("max_unknowns").map(|value| value.whole_number(1..=most)).transpose()?;
    Ok(Target {
        relative: relative.ok_or_else(|| target.wrong(expected))?,
        max_unknowns: unknowns.unwrap_or(MOST_UNKNOWNS),
    })
}
