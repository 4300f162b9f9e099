//! Conditions on the boundary: `[boundary]`, `[obstacle]` and `[point]` of a case file.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::body::constant;
use super::exact::read_kind;
use super::table::{Spot, Table, Value};
use crate::fem::{
    BoundaryEdge, Condition, Hand, Mesh, Obstacle, Path, PointSupport, SharedFunction, Side,
};
use crate::io::input::FileError;
use crate::quote::{listed, names};
use crate::study::Exact;
use crate::study::exact::Kind;

type Obstacles<'s> = BTreeMap<&'s str, (Spot<'s>, Obstacle)>;

/// The conditions on the boundaries of the mesh and, beside \[exact\], the kind of each.
type Boundaries = (BTreeMap<String, Condition>, BTreeMap<String, Kind>);

/// What a boundary's length makes an area with.
#[derive(Clone, Copy)]
pub(super) enum Depth {
    /// The thickness of a plane body, 1 if it is not given.
    Of(f64),
    /// The circle that each point of a body of revolution goes round.
    Revolution,
}

/// The area of a boundary of a body of revolution.
fn area_of_revolution(mesh: &Mesh, edges: &[BoundaryEdge]) -> f64 {
    let of = |&edge: &BoundaryEdge| {
        let [[a, _], [b, _]] = mesh.places_of_ends(edge);
        mesh.length_and_normal(edge).0 * std::f64::consts::PI * (a + b)
    };
    edges.iter().map(of).sum()
}

/// Reads the conditions on the boundaries. A whole force acts on the area of its boundary. `has_pairs`: contact
/// is between boundaries of the mesh, and need not be with an obstacle.
pub(super) fn read_boundaries(
    root: &Table,
    solution: Option<&Exact>,
    mesh: &Mesh,
    depth: Depth,
    has_pairs: bool,
) -> Result<Boundaries, FileError> {
    let expected = match solution {
        None => {
            "one boundary with contact, such as [boundary.bottom] contact = { gap = \"0\" }, or a [[pair]] of boundaries"
        }
        Some(_) => "one boundary with contact, such as bottom = \"contact\"",
    };
    let obstacles = read_obstacles(root)?;
    let all = match root.section("boundary")? {
        None if has_pairs && obstacles.is_empty() => return Ok(Boundaries::default()),
        _ => root.required_section("boundary", expected)?,
    };
    let (mut conditions, mut kinds) = (BTreeMap::new(), BTreeMap::new());
    for key in all.keys() {
        let at = all.under_header(key);
        let edges = mesh.edges_of(key).map_err(|error| at.mesh(error))?;
        if edges.is_empty() {
            return Err(at.found("no edge in this mesh", "at least one"));
        }
        let condition = match solution {
            None => {
                let area = match depth {
                    Depth::Of(thickness) => {
                        let lengths = edges.iter().map(|&e| mesh.length_and_normal(e).0);
                        lengths.sum::<f64>() * thickness
                    }
                    Depth::Revolution => area_of_revolution(mesh, edges),
                };
                read_condition(&all.subsection(key)?, &obstacles, (area, depth))?
            }
            Some(solution) => {
                let kind = read_kind(&all.require(key, "a kind")?)?;
                kinds.insert(key.to_owned(), kind);
                kind.condition(solution)
            }
        };
        conditions.insert(key.to_owned(), condition);
    }
    if !has_pairs && !conditions.values().any(Condition::is_contact) {
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
fn read_condition(
    table: &Table,
    obstacles: &Obstacles,
    (area, depth): (f64, Depth),
) -> Result<Condition, FileError> {
    table.only(&CONDITIONS)?;
    let value = |key| table.require(key, "a value");
    Ok(match table.given(&CONDITIONS)[..] {
        ["force"] => {
            let (force, whole) = (value("force")?, value("force")?.vector()?);
            if matches!(depth, Depth::Revolution) && whole[0] != 0.0 {
                return Err(force.wrong(
                    "[0, Fz] on a body of revolution, whose radial forces cancel all round: traction and pressure have them",
                ));
            }
            Condition::Traction(whole.map(|force| constant(force / area)))
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
    contact.only(&["gap", "obstacle"])?;
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
    const SHAPES: [&str; 4] = ["plane", "circle", "points", "distance"];
    table.only(&["plane", "circle", "points", "radius", "side", "distance"])?;
    let &[shape] = table.given(&SHAPES).as_slice() else {
        return Err(table.combination(&SHAPES, &format!("either {}", listed(&SHAPES, "or"))));
    };
    if shape == "points" {
        return read_path(table);
    }
    if let [beside, ..] = table.given(&["radius", "side"])[..] {
        return Err(table.combination(&[shape, beside], &format!("{beside} beside points only")));
    }
    let shape = table.require(shape, "a shape")?;
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

/// A line through points, its corners rounded.
fn read_path(table: &Table) -> Result<Obstacle, FileError> {
    let value = table.require("points", "a list of points")?;
    let points = value.items()?.iter().map(Value::vector).collect::<Result<Vec<_>, _>>()?;
    let not_negative = |radius: &Value| radius.number_that(|r| r >= 0.0, "a radius, or 0");
    let radii = table.optional("radius", |radius| match radius.items() {
        Ok(each) => each.iter().map(not_negative).collect(),
        Err(_) => Ok(vec![not_negative(radius)?]),
    })?;
    let path = Path::new(&points, &radii.unwrap_or_default());
    let path = path.map_err(|error| value.at.wrong(format!("{}: {error}", value.at.name)))?;
    Ok(Obstacle::Path { path: Arc::new(path), body: read_side(table)? })
}

/// Where the body is beside a line.
fn read_side(table: &Table) -> Result<Hand, FileError> {
    let side = table
        .require("side", "\"left\" or \"right\": where the body is, walking along the line")?;
    side.one_of(&[("left", Hand::Left), ("right", Hand::Right)])
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
