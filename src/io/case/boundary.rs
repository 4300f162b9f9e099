//! Conditions on the boundary: `[boundary]`, `[obstacle]` and `[point]` of a case file.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::body::constant;
use super::exact::read_kind;
use super::table::{Spot, Table, Value};
use crate::fem::{Condition, Mesh, Obstacle, PointSupport, SharedFunction, Side};
use crate::io::input::FileError;
use crate::quote::names;
use crate::study::Exact;
use crate::study::exact::Kind;

type Obstacles<'s> = BTreeMap<&'s str, (Spot<'s>, Obstacle)>;

/// The conditions on the boundaries of the mesh and, beside \[exact\], the kind of each.
type Boundaries = (BTreeMap<String, Condition>, BTreeMap<String, Kind>);

/// Reads the conditions on the boundaries. A whole force acts on the length of its boundary times the thickness, which is 1 if
/// it is not given.
pub(super) fn read_boundaries(
    root: &Table,
    solution: Option<&Exact>,
    mesh: &Mesh,
    thickness: Option<f64>,
) -> Result<Boundaries, FileError> {
    let expected = match solution {
        None => "one boundary with contact, such as [boundary.bottom] contact = { gap = \"0\" }",
        Some(_) => "one boundary with contact, such as bottom = \"contact\"",
    };
    let all = root.required_section("boundary", expected)?;
    let obstacles = read_obstacles(root)?;
    let (mut conditions, mut kinds) = (BTreeMap::new(), BTreeMap::new());
    for key in all.keys() {
        let at = all.under_header(key);
        let edges = mesh.edges_of(key).map_err(|error| at.mesh(error))?;
        if edges.is_empty() {
            return Err(at.found("no edge in this mesh", "at least one"));
        }
        let condition = match solution {
            None => {
                let length: f64 = edges.iter().map(|&e| mesh.length_and_normal(e).0).sum();
                let area = length * thickness.unwrap_or(1.0);
                read_condition(&all.subsection(key)?, &obstacles, area)?
            }
            Some(solution) => {
                let kind = read_kind(&all.require(key, "a kind")?)?;
                kinds.insert(key.to_owned(), kind);
                kind.condition(solution)
            }
        };
        conditions.insert(key.to_owned(), condition);
    }
    if !conditions.values().any(Condition::is_contact) {
        return Err(all.at.found("no contact", expected));
    }
    let is_used = |name: &str| {
        conditions.values().any(|c| matches!(c, Condition::Obstacle(o, _) if o == name))
    };
    match obstacles.iter().find(|(name, _)| !is_used(name)) {
        None => Ok((conditions, kinds)),
        Some((name, (at, _))) => {
            let expected =
                format!("one, such as [boundary.bottom] contact = {{ obstacle = \"{name}\" }}");
            Err(at.found("no boundary in contact with it", &expected))
        }
    }
}

const CONDITIONS: [&str; 7] =
    ["displacement", "traction", "pressure", "normal", "tangential", "contact", "force"];

/// The condition on a boundary that has this area.
fn read_condition(table: &Table, obstacles: &Obstacles, area: f64) -> Result<Condition, FileError> {
    table.only(&CONDITIONS)?;
    let value = |key| table.require(key, "a value");
    Ok(match table.given(&CONDITIONS)[..] {
        ["force"] => {
            Condition::Traction(value("force")?.vector()?.map(|force| constant(force / area)))
        }
        ["displacement"] => Condition::Displacement(components(&value("displacement")?)?),
        ["traction"] => Condition::Traction(value("traction")?.functions()?),
        ["displacement", "traction"] => read_mixed(table)?,
        ["pressure"] => Condition::Pressure(value("pressure")?.function()?),
        ["normal"] | ["tangential"] | ["normal", "tangential"] => Condition::Support {
            normal: table.optional("normal", Value::function)?,
            tangential: table.optional("tangential", Value::function)?,
        },
        ["contact"] => read_contact(&value("contact")?, obstacles)?,
        _ => {
            let expected =
                "either displacement, traction, pressure, normal, tangential, contact or force";
            return Err(table.combination(&CONDITIONS, expected));
        }
    })
}

fn components(value: &Value) -> Result<[Option<SharedFunction>; 2], FileError> {
    let [x, y] = value.pair()?;
    Ok([component(&x)?, component(&y)?])
}

/// A component of a displacement, `None` if it is free.
fn component(value: &Value) -> Result<Option<SharedFunction>, FileError> {
    let is_word = |text: &str| text.len() > 2 && text.bytes().all(|b| b.is_ascii_alphabetic());
    match value.as_text() {
        Some("free") => Ok(None),
        Some(text) if is_word(text) => Err(value.wrong("an expression, or \"free\"")),
        _ => value.function().map(Some),
    }
}

/// A displacement in one component, a traction in the other: what is given in the first must be 0 in the second.
fn read_mixed(table: &Table) -> Result<Condition, FileError> {
    let [displacement, traction] = ["displacement", "traction"].map(|k| table.require(k, "a list"));
    let (displacement, of_traction) = (components(&displacement?)?, traction?);
    let traction = of_traction.functions()?;
    for c in 0..2 {
        let acts = traction[c].degree() != Some(0) || traction[c].at([0.0; 2]) != 0.0;
        if displacement[c].is_some() && acts {
            return Err(of_traction.pair()?[c].wrong(&format!(
                "0: the displacement is given in this component, so its traction is the reaction ({})",
                table.at.name
            )));
        }
    }
    Ok(Condition::Mixed { displacement, traction })
}

fn read_contact(value: &Value, obstacles: &Obstacles) -> Result<Condition, FileError> {
    if !value.is_table() {
        return Err(value.wrong("a table, such as { gap = \"0\" } or { obstacle = \"floor\" }"));
    }
    let contact = value.table()?;
    contact.only(&["gap", "obstacle", "friction"])?;
    let Some(obstacle) = contact.get("obstacle") else {
        let gap = contact.optional("gap", Value::function)?;
        return Ok(Condition::Contact { gap: gap.unwrap_or_else(|| constant(0.0)) });
    };
    if contact.get("gap").is_some() {
        let expected = "a gap along the normal, or an obstacle";
        return Err(contact.combination(&["gap", "obstacle"], expected));
    }
    let name = obstacle.text()?;
    let (_, found) = obstacles.get(name).ok_or_else(|| {
        let known = names(obstacles.keys().copied());
        let known = if known.is_empty() { "none" } else { &known };
        obstacle.wrong(&format!("the name of an [obstacle.NAME]; there are: {known}"))
    })?;
    Ok(Condition::Obstacle(name.to_owned(), found.clone()))
}

fn read_obstacles<'s>(root: &Table<'s>) -> Result<Obstacles<'s>, FileError> {
    let mut obstacles = BTreeMap::new();
    let Some(all) = root.section("obstacle")? else { return Ok(obstacles) };
    for key in all.keys() {
        let obstacle = read_obstacle(&all.subsection(key)?)?;
        obstacles.insert(key, (all.under_header(key), obstacle));
    }
    Ok(obstacles)
}

fn read_obstacle(table: &Table) -> Result<Obstacle, FileError> {
    let shape = table.exactly_one(&["plane", "circle", "distance"])?;
    if table.get("distance").is_some() {
        return Ok(Obstacle::Distance(Arc::new(shape.expression()?)));
    }
    let shape = shape.table()?;
    if table.get("circle").is_some() {
        shape.only(&["center", "radius", "side"])?;
        let center = shape.require("center", "a point")?.vector()?;
        let radius = shape.require("radius", "a length")?.positive()?;
        let side = shape.require("side", "\"outside\" or \"inside\": where the body is")?;
        let side = side.one_of(&[("outside", Side::Outside), ("inside", Side::Inside)])?;
        return Ok(Obstacle::Circle { center, radius, side });
    }
    shape.only(&["point", "normal"])?;
    let point = shape.require("point", "a point of the plane")?.vector()?;
    let normal = shape.require("normal", "the normal towards the body")?;
    let [x, y] = normal.vector()?;
    let length = x.hypot(y);
    if length > 0.0 && length.is_finite() {
        Ok(Obstacle::Plane { point, normal: [x / length, y / length] })
    } else {
        Err(normal.wrong_as(&format!("{:?}", [x, y]), "a vector that is not zero"))
    }
}

/// `[point.NAME] displacement = [..]` on the mesh.
pub(super) fn read_points(root: &Table, mesh: &Mesh) -> Result<Vec<PointSupport>, FileError> {
    let Some(all) = root.section("point")? else { return Ok(Vec::new()) };
    let mut points = Vec::new();
    for key in all.keys() {
        let table = all.subsection(key)?;
        table.only(&["displacement"])?;
        let displacement = table.require("displacement", "such as [\"0\", \"free\"]")?;
        let displacement = components(&displacement)?;
        let vertex = mesh.point(key).map_err(|error| table.at.mesh(error))?;
        points.push(PointSupport { name: key.to_owned(), vertex, displacement });
    }
    Ok(points)
}
