//! The summary by `signorini check` of a case before it is solved: what holds on each boundary, how long that is, which load acts there,
//! where contact is nearest before loading, and whether supports and contact hold the body.

use super::case::{Case, Measure};
use super::result::{GammaChoice, MeshSizes};
use super::summary::{self, Lines, QuantityFormat};
use crate::contact::ContactLine;
use crate::model::loads::Resultants;
use crate::model::{BoundaryEdge, Condition, Degree, Mesh, Problem, Space, loads};
use crate::quote::{self, quoted};
use crate::solve::{ContactQuadrature, Outline};

/// The largest number of boundaries that are listed; more are counted.
const MOST: usize = 100;

/// The summary of a valid case.
pub(crate) fn checked(case: &Case, outline: &Outline) -> String {
    let mut lines = Lines::default();
    let mesh = MeshSizes::new(&case.problem.mesh, outline.nodes, outline.contact_edges);
    lines.line("mesh", summary::sizes(&mesh));
    boundaries(case, &mut lines);
    lines.line("held", held(outline));
    lines.line("prescribed", format!("{} of the unknowns", outline.prescribed));
    lines.line("coercivity", summary::coercivity(&GammaChoice::from(&outline.gamma)));
    lines.line(
        "quadrature",
        match case.method.quadrature {
            ContactQuadrature::Exact => "exact: contact edges are cut at the roots of P".to_owned(),
            ContactQuadrature::Gauss(1) => "1 Gauss point on each contact edge".to_owned(),
            ContactQuadrature::Gauss(n) => format!("{n} Gauss points on each contact edge"),
        },
    );
    let before = super::remarks::before(&case.problem, case.method.degree, &case.words());
    for remark in case.remarks.iter().cloned().chain(before) {
        lines.line("remark", remark);
    }
    lines.under(&case.title)
}

/// The boundaries of a case that cannot be solved, for one who looks for the reason.
pub(crate) fn listed(case: &Case) -> String {
    let mut lines = Lines::default();
    boundaries(case, &mut lines);
    lines.under(&case.title)
}

fn held(outline: &Outline) -> String {
    let motions = summary::count(outline.free_motions, "rigid motion");
    match (outline.free_motions, outline.slides) {
        (0, _) => "by its supports".to_owned(),
        (_, 0) => format!(
            "by contact: supports leave {motions} free, and the loads press the body against what stops it"
        ),
        (_, slides) => format!(
            "supports leave {motions} free, and contact {slides} of them: one of the solutions will be shown"
        ),
    }
}

fn boundaries(case: &Case, lines: &mut Lines) {
    let (problem, mesh) = (&case.problem, &case.problem.mesh);
    let space = Space::new(mesh, Degree::One);
    let [mut no_load, mut no_gap] = [None, None];
    let loads = loads::resultants(problem, &space).map_err(|error| no_load = Some(error));
    let loads = loads.unwrap_or_default();
    let loads = match problem.material.are_of_revolution() {
        true => loads.of_the_revolution(),
        false => loads.times(case.thickness.unwrap_or(1.0)),
    };
    let contact = ContactLine::new(problem, &space).map_err(|error| no_gap = Some(error)).ok();
    let largest = loads.boundaries.values().chain([&loads.body]).flatten();
    let no_force = 1e-10 * largest.fold(0.0, |most: f64, f| most.max(f.abs()));
    let shown = QuantityFormat { units: case.units.clone(), thickness: case.thickness, no_force };
    let named: Vec<&str> = mesh.boundary_names().collect();
    // Those with a condition first.
    let (used, free): (Vec<&str>, Vec<&str>) = named.iter().partition(|name| {
        problem.conditions.contains_key(**name) || !partners(problem, name).is_empty()
    });
    let said = |name: &str| {
        let said = match problem.conditions.get(name) {
            Some(condition) => of_condition(condition, name, &loads, contact.as_ref(), &shown),
            None => match partners(problem, name) {
                partners if partners.is_empty() => "nothing is prescribed".to_owned(),
                partners => {
                    let gap = gap(name, contact.as_ref(), &shown);
                    format!("contact with {}{gap}", quote::listed(&partners, "and"))
                }
            },
        };
        let edges = mesh.edges_of(name).unwrap_or_default();
        format!("{}: {said}{}", quote::cut(name), length(mesh, edges, &shown))
    };
    let mut text: Vec<String> = used.into_iter().chain(free).take(MOST).map(said).collect();
    if named.len() > MOST {
        text.push(format!("and {} more", named.len() - MOST));
    }
    let rest = unnamed(mesh);
    if !rest.is_empty() {
        let length = length(mesh, &rest, &shown);
        text.push(format!("without a name: nothing is prescribed{length}"));
    }
    for (i, line) in text.into_iter().enumerate() {
        lines.line(if i == 0 { "boundaries" } else { "" }, line);
    }
    for (what, error) in [("loads", no_load), ("gaps", no_gap)] {
        error.into_iter().for_each(|error| lines.line(what, format!("not known: {error}")));
    }
    if loads.body != [0.0; 2] {
        lines.line("body", format!("total load {}", force(loads.body, &shown)));
    }
}

/// The boundaries that make pairs with this one.
fn partners<'p>(problem: &'p Problem, name: &str) -> Vec<&'p str> {
    let partner = |[first, second]: &'p [String; 2]| match (first == name, second == name) {
        (true, _) => Some(&**second),
        (_, true) => Some(&**first),
        _ => None,
    };
    problem.pairs.iter().filter_map(|pair| partner(&pair.boundaries)).collect()
}

/// The edges of the boundary that have no name.
fn unnamed(mesh: &Mesh) -> Vec<BoundaryEdge> {
    let mut is_named = vec![false; mesh.edge_count()];
    let all = mesh.boundary_names().flat_map(|name| mesh.edges_of(name).unwrap_or_default());
    all.for_each(|&edge| is_named[mesh.number_of(edge)] = true);
    mesh.outline().iter().copied().filter(|&edge| !is_named[mesh.number_of(edge)]).collect()
}

fn length(mesh: &Mesh, edges: &[BoundaryEdge], shown: &QuantityFormat) -> String {
    let length = edges.iter().map(|&edge| mesh.length_and_normal(edge).0).sum();
    format!(", length {}", shown.number(length, Measure::Length))
}

fn force(force: [f64; 2], shown: &QuantityFormat) -> String {
    shown.with_unit(shown.components(force), Measure::Force)
}

/// The condition in words, with its load or its gap.
fn of_condition(
    condition: &Condition,
    name: &str,
    loads: &Resultants,
    contact: Option<&ContactLine>,
    shown: &QuantityFormat,
) -> String {
    let load = || {
        let total = loads.boundaries.get(name).copied().unwrap_or_default();
        format!("total load {}", force(total, shown))
    };
    let components = |held: [bool; 2]| match held {
        [true, true] => "displacement",
        [true, false] => "displacement along x",
        [false, true] => "displacement along y",
        [false, false] => "nothing",
    };
    match condition {
        Condition::Displacement(u) => {
            format!("{} prescribed", components(u.each_ref().map(Option::is_some)))
        }
        Condition::Mixed { displacement, .. } => {
            let held = components(displacement.each_ref().map(Option::is_some));
            format!("{held} prescribed, traction, {}", load())
        }
        Condition::Support { normal, tangential } => {
            let held = match (normal, tangential) {
                (Some(_), Some(_)) => "displacement along normal and tangent",
                (Some(_), None) => "displacement along the normal",
                (None, _) => "displacement along the tangent",
            };
            format!("{held} prescribed")
        }
        Condition::Traction(_) => format!("traction, {}", load()),
        Condition::Pressure(_) => format!("pressure, {}", load()),
        Condition::Contact { .. } => format!("contact{}", gap(name, contact, shown)),
        Condition::Obstacle(obstacle, _) => {
            format!("contact with {}{}", quoted(obstacle, '\''), gap(name, contact, shown))
        }
    }
}

/// The least and the largest initial gap of a contact boundary, and where the least is.
fn gap(name: &str, contact: Option<&ContactLine>, shown: &QuantityFormat) -> String {
    let pieces = contact.into_iter().flat_map(ContactLine::pieces);
    let own = pieces.filter(|piece| piece.stretches.iter().any(|side| &*side.boundary == name));
    let gaps: Vec<(f64, [f64; 2])> =
        own.flat_map(|piece| piece.nodes.iter().map(|node| (node.gap, node.place))).collect();
    let least = gaps.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let largest = gaps.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(&(least, at)), Some(&(largest, _))) = (least, largest) else { return String::new() };
    let [least, largest] = [least, largest].map(|gap| shown.number(gap, Measure::Length));
    if least == largest {
        return format!(", initial gap {least}");
    }
    format!(", initial gap from {least} at {} to {largest}", summary::vector(at))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn a_gap_that_has_no_value_is_named_and_control_one_that_has_is_not() {
        let said = |gap: &str| {
            let text = format!(
                "mesh.rectangle = {{ width = 1, height = 1, nx = 2, ny = 2 }}\nmaterial = {{ lambda = 1, mu = 1 }}\nboundary.bottom.contact = {{ gap = \"{gap}\" }}"
            );
            listed(&Case::parse(Path::new("in_a_test.toml"), &text, &[]).unwrap())
        };
        assert!(
            said("sqrt(-1 - x)").contains("gaps         not known: "),
            "{}",
            said("sqrt(-1 - x)")
        );
        assert!(!said("x").contains("not known"));
    }
}
