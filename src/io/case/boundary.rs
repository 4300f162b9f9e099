//! Conditions on the boundary: `[boundary]`, `[obstacle]` and `[point]` of a case file.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::body::constant;
use super::exact::read_kind;
use super::table::{Spot, Table, Value};
use crate::contact::Pair;
use crate::exact::{Exact, Kind};
use crate::io::input::FileError;
use crate::model::{
    BoundaryEdge, Condition, Hand, Mesh, Obstacle, Path, PathError, PointSupport, SharedFunction,
    Side,
};
use crate::quote::{listed, names, quoted};

type Obstacles<'s> = BTreeMap<&'s str, (Spot<'s>, Obstacle)>;

/// The conditions on the boundaries of the mesh and, beside \[exact\], the kind of each.
type Boundaries = (BTreeMap<String, Condition>, BTreeMap<String, Kind>);

/// The factor that makes an area of a boundary's length.
#[derive(Clone, Copy)]
pub(super) enum Depth {
    /// The thickness of a plane body, 1 if it is not given.
    Of(f64),
    /// The circle that each point of a body of revolution goes round.
    Revolution,
}

fn area_of_revolution(mesh: &Mesh, edges: &[BoundaryEdge]) -> f64 {
    let of = |&edge: &BoundaryEdge| {
        let [[a, _], [b, _]] = mesh.places_of_ends(edge);
        mesh.length_and_normal(edge).0 * std::f64::consts::PI * (a + b)
    };
    edges.iter().map(of).sum()
}

/// Reads the conditions on the boundaries. A whole force acts on the area of its boundary. Boundaries of `pairs` have no condition.
pub(super) fn read_boundaries(
    root: &Table,
    solution: Option<&Exact>,
    mesh: &Mesh,
    depth: Depth,
    pairs: &[Pair],
) -> Result<Boundaries, FileError> {
    let expected = match solution {
        None => {
            "one boundary with contact, such as [boundary.bottom] contact = { gap = \"0\" }, or a [[pair]] of boundaries"
        }
        Some(_) => "one boundary with contact, such as bottom = \"contact\"",
    };
    let obstacles = read_obstacles(root, mesh)?;
    let all = match root.section("boundary")? {
        None if !pairs.is_empty() && obstacles.is_empty() => return Ok(Boundaries::default()),
        _ => root.required_section("boundary", expected)?,
    };
    let (mut conditions, mut kinds) = (BTreeMap::new(), BTreeMap::new());
    let is_of_pair =
        |key: &&str| pairs.iter().any(|pair| pair.boundaries.iter().any(|of| of == key));
    for key in all.keys().filter(|key| !is_of_pair(key)) {
        let at = all.under_header(key);
        let edges = mesh.edges_of(key).map_err(|error| at.about(error))?;
        if edges.is_empty() {
            return Err(at.found("no edge in this mesh", "at least one"));
        }
        let condition = match solution {
            None => {
                let force = |value: &Value| {
                    let whole = value.vector()?;
                    match depth {
                        Depth::Of(thickness) => {
                            let per_thickness = whole.map(|force| force / thickness);
                            let force = Condition::force(per_thickness, mesh, key);
                            force.map_err(|error| at.about(error))
                        }
                        Depth::Revolution if whole[0] != 0.0 => Err(value.wrong(
                            "[0, Fz] on a body of revolution, whose radial forces cancel all round: traction and pressure have them",
                        )),
                        Depth::Revolution => {
                            let area = area_of_revolution(mesh, edges);
                            Ok(Condition::Traction(whole.map(|force| constant(force / area))))
                        }
                    }
                };
                read_condition(&all.subsection(key)?, &obstacles, force)?
            }
            Some(solution) => {
                let kind = read_kind(&all.require(key, "a kind")?)?;
                kinds.insert(key.to_owned(), kind);
                kind.condition(solution)
            }
        };
        conditions.insert(key.to_owned(), condition);
    }
    mesh.check_apart(conditions.keys().map(String::as_str)).map_err(|error| all.at.about(error))?;
    if pairs.is_empty() && !conditions.values().any(Condition::is_contact) {
        return Err(all.at.found("no contact", expected));
    }
    let is_used = |name: &str| {
        conditions.values().any(|c| matches!(c, Condition::Obstacle(o, _) if o == name))
    };
    match obstacles.iter().find(|(name, _)| !is_used(name)) {
        None => Ok((conditions, kinds)),
        Some((name, (at, _))) => {
            let expected = format!(
                "one, such as [boundary.bottom] contact = {{ obstacle = {} }}",
                quoted(name, '"')
            );
            Err(at.found("no boundary in contact with it", &expected))
        }
    }
}

const CONDITIONS: [&str; 7] =
    ["displacement", "traction", "pressure", "normal", "tangential", "contact", "force"];

/// The condition on a boundary on which a whole force is what `force` says.
fn read_condition(
    table: &Table,
    obstacles: &Obstacles,
    force: impl Fn(&Value) -> Result<Condition, FileError>,
) -> Result<Condition, FileError> {
    table.only(&[&CONDITIONS[..], &["where"]].concat())?;
    let value = |key| table.require(key, "a value");
    Ok(match table.given(&CONDITIONS)[..] {
        ["force"] => force(&value("force")?)?,
        ["displacement"] => Condition::Displacement(components(&value("displacement")?)?),
        ["traction"] => Condition::Traction(value("traction")?.functions()?),
        ["displacement", "traction"] => {
            let traction = value("traction")?;
            read_mixed(table, &traction, traction.functions()?)?
        }
        ["displacement", "force"] => {
            let of_force = value("force")?;
            match force(&of_force)? {
                Condition::Traction(traction) => read_mixed(table, &of_force, traction)?,
                other => other,
            }
        }
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

/// A displacement in one component, and in the other a traction or a force, which is `given` and must be 0 in the first.
fn read_mixed(
    table: &Table,
    given: &Value,
    traction: [SharedFunction; 2],
) -> Result<Condition, FileError> {
    let displacement = components(&table.require("displacement", "a list")?)?;
    for c in 0..2 {
        let acts = traction[c].degree() != Some(0) || traction[c].at([0.0; 2]) != 0.0;
        if displacement[c].is_some() && acts {
            return Err(given.pair()?[c].wrong(&format!(
                "0: the displacement is given in this component, so its traction is the reaction ({})",
                table.at.name
            )));
        }
    }
    Ok(Condition::Mixed { displacement, traction })
}

fn read_contact(value: &Value, obstacles: &Obstacles) -> Result<Condition, FileError> {
    let expected = "a table, such as { gap = \"0\" } or { obstacle = \"floor\" }";
    let contact = value.table_such_as(expected)?;
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

fn read_obstacles<'s>(root: &Table<'s>, mesh: &Mesh) -> Result<Obstacles<'s>, FileError> {
    let mut obstacles = BTreeMap::new();
    let Some(all) = root.section("obstacle")? else { return Ok(obstacles) };
    for key in all.keys() {
        let obstacle = read_obstacle(&all.subsection(key)?, mesh)?;
        obstacles.insert(key, (all.under_header(key), obstacle));
    }
    Ok(obstacles)
}

fn read_obstacle(table: &Table, mesh: &Mesh) -> Result<Obstacle, FileError> {
    const SHAPES: [&str; 5] = ["plane", "circle", "points", "curve", "distance"];
    table.only(&["plane", "circle", "points", "curve", "radius", "side", "distance"])?;
    let &[shape] = table.given(&SHAPES).as_slice() else {
        return Err(table.combination(&SHAPES, &format!("either {}", listed(&SHAPES, "or"))));
    };
    if shape == "points" {
        return read_path(table);
    }
    if table.get("radius").is_some() {
        return Err(table.combination(&[shape, "radius"], "radius beside points only"));
    }
    if shape == "curve" {
        return read_curve(table, mesh);
    }
    if table.get("side").is_some() {
        return Err(table.combination(&[shape, "side"], "side beside points and curve only"));
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
    beside(table, &value, Path::new(&points, &radii.unwrap_or_default()))
}

/// A named curve of the mesh that bounds no body.
fn read_curve(table: &Table, mesh: &Mesh) -> Result<Obstacle, FileError> {
    let value = table.require("curve", "the name of a curve")?;
    let edges = mesh.curve(value.text()?).map_err(|error| value.at.about(error))?;
    beside(table, &value, Path::through(edges))
}

/// The line that `value` says, with the body on the side that `table` says.
fn beside(
    table: &Table,
    value: &Value,
    path: Result<Path, PathError>,
) -> Result<Obstacle, FileError> {
    let path = path.map_err(|error| value.at.about(error.to_string()))?;
    let expected = "\"left\" or \"right\": where the body is, walking along the line";
    let side = table.require("side", expected)?;
    let body = side.one_of(&[("left", Hand::Left), ("right", Hand::Right)])?;
    Ok(Obstacle::Path { path: Arc::new(path), body })
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
        let vertex = mesh.point(key).map_err(|error| table.at.about(error))?;
        points.push(PointSupport { name: key.to_owned(), vertex, displacement });
    }
    Ok(points)
}
