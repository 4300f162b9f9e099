//! Conditions on the boundary: `[boundary]`, `[obstacle]` and `[point]` of a case file.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::body::{constant, functions, zero};
use super::exact::read_kind;
use super::expression::Expression;
use super::mistake::{CaseError, CaseMistake};
use super::table::{Table, Value};
use crate::fem::exact::Kind;
use crate::fem::{
    Condition, Distance, Exact, Function, Mesh, Obstacle, PointSupport, SharedFunction, Side,
};
use crate::quote::{key as shown, names};

/// A boundary of the case file: where it stands, what messages call it, its name, and what holds there.
pub(super) struct Boundary<'s> {
    value: Value<'s>,
    title: String,
    pub key: &'s str,
    /// Beside \[exact\] only.
    pub kind: Option<Kind>,
    given: Given,
}

/// The condition that a boundary of the case file gives.
enum Given {
    Condition(Condition),
    /// A whole force, spread evenly: a traction, once the length of the boundary is known.
    Force([f64; 2]),
}

pub(super) fn read_boundaries<'s>(
    root: &Table<'s>,
    solution: Option<&Exact>,
) -> Result<Vec<Boundary<'s>>, CaseError> {
    let expected = match solution {
        None => "one boundary with contact, such as [boundary.bottom] contact = { gap = \"0\" }",
        Some(_) => "one boundary with contact, such as bottom = \"contact\"",
    };
    let all = root.required_section("boundary", expected)?;
    let obstacles = read_obstacles(root)?;
    let mut boundaries = Vec::new();
    for key in all.keys() {
        let title = format!("[boundary.{}]", shown(key));
        let (value, kind, given) = match solution {
            None => {
                let value = all.require(key, "a table")?;
                let given = read_given(&value.section(title.clone())?, &obstacles)?;
                (value, None, given)
            }
            Some(solution) => {
                let value = all.require(key, "a kind")?;
                let kind = read_kind(&value)?;
                (value, Some(kind), Given::Condition(kind.condition(solution)))
            }
        };
        boundaries.push(Boundary { value, title, key, kind, given });
    }
    let is_contact = |b: &Boundary| matches!(&b.given, Given::Condition(c) if c.is_contact());
    if !boundaries.iter().any(is_contact) {
        return Err(all.wrong(CaseMistake::Combination {
            name: all.name().to_owned(),
            found: "no contact".to_owned(),
            expected: expected.to_owned(),
        }));
    }
    let used = |name: &str| {
        let with = |b: &Boundary| matches!(&b.given, Given::Condition(Condition::Obstacle(o, _)) if o == name);
        boundaries.iter().any(with)
    };
    match obstacles.iter().find(|(name, _)| !used(name)) {
        None => Ok(boundaries),
        Some((name, (value, _))) => Err(value.mistake(CaseMistake::Combination {
            name: format!("[obstacle.{}]", shown(name)),
            found: "no boundary in contact with it".to_owned(),
            expected: format!(
                "one, such as [boundary.bottom] contact = {{ obstacle = \"{name}\" }}"
            ),
        })),
    }
}

const CONDITIONS: [&str; 7] =
    ["displacement", "traction", "pressure", "normal", "tangential", "contact", "force"];

fn read_given(
    table: &Table,
    obstacles: &BTreeMap<&str, (Value, Obstacle)>,
) -> Result<Given, CaseError> {
    table.only(&CONDITIONS)?;
    match table.get("force") {
        Some(force) if CONDITIONS.iter().filter(|key| table.get(key).is_some()).count() == 1 => {
            Ok(Given::Force(place(&force)?))
        }
        _ => read_condition(table, obstacles).map(Given::Condition),
    }
}

fn read_condition(
    table: &Table,
    obstacles: &BTreeMap<&str, (Value, Obstacle)>,
) -> Result<Condition, CaseError> {
    match CONDITIONS.map(|key| table.get(key)) {
        [Some(displacement), None, None, None, None, None, None] => {
            Ok(Condition::Displacement(components(&displacement)?))
        }
        [Some(displacement), Some(traction), None, None, None, None, None] => {
            read_mixed(table, &displacement, &traction)
        }
        [None, Some(traction), None, None, None, None, None] => {
            Ok(Condition::Traction(functions(&traction)?))
        }
        [None, None, Some(pressure), None, None, None, None] => {
            Ok(Condition::Pressure(pressure.function()?))
        }
        [None, None, None, normal, tangential, None, None]
            if normal.is_some() || tangential.is_some() =>
        {
            let function = |value: Option<Value>| value.map(|v| v.function()).transpose();
            let (normal, tangential) = (function(normal)?, function(tangential)?);
            Ok(Condition::Support { normal, tangential })
        }
        [None, None, None, None, None, Some(contact), None] => read_contact(&contact, obstacles),
        _ => Err(table.combination(
            &CONDITIONS,
            "either displacement, traction, pressure, normal, tangential, contact or force",
        )),
    }
}

fn components(value: &Value) -> Result<[Option<SharedFunction>; 2], CaseError> {
    let [x, y] = value.pair()?;
    Ok([component(&x)?, component(&y)?])
}

/// A component of a displacement, `None` if it is free.
fn component(value: &Value) -> Result<Option<SharedFunction>, CaseError> {
    let is_word = |text: &str| text.len() > 2 && text.bytes().all(|b| b.is_ascii_alphabetic());
    match value.as_text() {
        Some("free") => Ok(None),
        Some(text) if is_word(text) => Err(value.wrong("an expression, or \"free\"")),
        _ => value.function().map(Some),
    }
}

/// A displacement in one component, a traction in the other: what is given in the first must be 0 in the second.
fn read_mixed(
    table: &Table,
    displacement: &Value,
    traction: &Value,
) -> Result<Condition, CaseError> {
    let displacement = components(displacement)?;
    let of_traction = traction.pair()?;
    let traction = functions(traction)?;
    for c in 0..2 {
        let acts = traction[c].degree() != Some(0) || traction[c].at([0.0; 2]) != 0.0;
        if displacement[c].is_some() && acts {
            return Err(of_traction[c].wrong(&format!(
                "0: the displacement is given in this component, so its traction is the reaction ({})",
                table.name()
            )));
        }
    }
    Ok(Condition::Mixed { displacement, traction })
}

fn read_contact(
    value: &Value,
    obstacles: &BTreeMap<&str, (Value, Obstacle)>,
) -> Result<Condition, CaseError> {
    if !value.is_table() {
        return Err(value.wrong("a table, such as { gap = \"0\" } or { obstacle = \"floor\" }"));
    }
    let contact = value.table()?;
    contact.only(&["gap", "obstacle"])?;
    match (contact.get("gap"), contact.get("obstacle")) {
        (Some(_), Some(_)) => {
            Err(contact.combination(&["gap", "obstacle"], "a gap along the normal, or an obstacle"))
        }
        (gap, None) => {
            let gap = gap.map_or(Ok(zero()), |gap| gap.function())?;
            Ok(Condition::Contact { gap })
        }
        (None, Some(name)) => match obstacles.get(name.text()?) {
            Some((_, obstacle)) => {
                Ok(Condition::Obstacle(name.text()?.to_owned(), obstacle.clone()))
            }
            None => {
                let known = names(obstacles.keys().copied());
                let known = if known.is_empty() { "none".to_owned() } else { known };
                Err(name.wrong(&format!("the name of an [obstacle.NAME]; there are: {known}")))
            }
        },
    }
}

fn read_obstacles<'s>(
    root: &Table<'s>,
) -> Result<BTreeMap<&'s str, (Value<'s>, Obstacle)>, CaseError> {
    let mut obstacles = BTreeMap::new();
    let Some(all) = root.section("obstacle")? else { return Ok(obstacles) };
    for key in all.keys() {
        let value = all.require(key, "a table")?;
        let table = value.section(format!("[obstacle.{}]", shown(key)))?;
        let obstacle = read_obstacle(&table)?;
        obstacles.insert(key, (value, obstacle));
    }
    Ok(obstacles)
}

fn read_obstacle(table: &Table) -> Result<Obstacle, CaseError> {
    const SHAPES: [&str; 3] = ["plane", "circle", "distance"];
    let shape = table.exactly_one(&SHAPES)?;
    if table.get("plane").is_some() {
        let plane = shape.table()?;
        plane.only(&["point", "normal"])?;
        let point = place(&plane.require("point", "a point of the plane")?)?;
        let value = plane.require("normal", "the normal towards the body")?;
        let [x, y] = place(&value)?;
        let length = x.hypot(y);
        return if length > 0.0 && length.is_finite() {
            Ok(Obstacle::Plane { point, normal: [x / length, y / length] })
        } else {
            Err(value.wrong_as(format!("{:?}", [x, y]), "a vector that is not zero"))
        };
    }
    if table.get("circle").is_some() {
        let circle = shape.table()?;
        circle.only(&["center", "radius", "side"])?;
        let side = [("outside", Side::Outside), ("inside", Side::Inside)];
        return Ok(Obstacle::Circle {
            center: place(&circle.require("center", "a point")?)?,
            radius: circle
                .require("radius", "a length")?
                .number_that(|r| r > 0.0, "a positive number")?,
            side: circle
                .require("side", "\"outside\" or \"inside\": where the body is")?
                .one_of(&side)?,
        });
    }
    Ok(Obstacle::Distance(Arc::new(FromExpression(shape.expression()?))))
}

fn place(value: &Value) -> Result<[f64; 2], CaseError> {
    let [x, y] = value.pair()?;
    Ok([x.number()?, y.number()?])
}

/// A signed distance by its expression.
struct FromExpression(Expression);

impl Function for FromExpression {
    fn at(&self, x: [f64; 2]) -> f64 {
        self.0.at(x)
    }
}

impl Distance for FromExpression {
    fn gradient(&self, x: [f64; 2]) -> [f64; 2] {
        self.0.gradient(x)
    }
}

/// The conditions on the boundaries of the mesh. A whole force is divided by the area that it acts on: the length of its
/// boundary times the thickness, which is 1 if it is not given.
pub(super) fn on_the_mesh(
    mesh: &Mesh,
    boundaries: Vec<Boundary>,
    thickness: Option<f64>,
) -> Result<BTreeMap<String, Condition>, CaseError> {
    let mut conditions = BTreeMap::new();
    for Boundary { value, title: name, key, given, .. } in boundaries {
        match mesh.edges_of(key) {
            Err(error) => return Err(value.mistake(CaseMistake::Mesh { name, error })),
            Ok([]) => {
                return Err(value.mistake(CaseMistake::Combination {
                    name,
                    found: "no edge in this mesh".to_owned(),
                    expected: "at least one".to_owned(),
                }));
            }
            Ok(edges) => {
                let condition = match given {
                    Given::Condition(condition) => condition,
                    Given::Force(force) => {
                        let length: f64 = edges.iter().map(|&e| mesh.length_and_normal(e).0).sum();
                        let area = length * thickness.unwrap_or(1.0);
                        Condition::Traction(force.map(|f| constant(f / area)))
                    }
                };
                conditions.insert(key.to_owned(), condition);
            }
        }
    }
    Ok(conditions)
}

/// `[point.NAME] displacement = [..]` on the mesh.
pub(super) fn read_points(root: &Table, mesh: &Mesh) -> Result<Vec<PointSupport>, CaseError> {
    let Some(all) = root.section("point")? else { return Ok(Vec::new()) };
    let mut points = Vec::new();
    for key in all.keys() {
        let value = all.require(key, "a table")?;
        let name = format!("[point.{}]", shown(key));
        let table = value.section(name.clone())?;
        table.only(&["displacement"])?;
        let displacement = table.require("displacement", "such as [\"0\", \"free\"]")?;
        let displacement = components(&displacement)?;
        let vertex =
            mesh.point(key).map_err(|error| value.mistake(CaseMistake::Mesh { name, error }))?;
        points.push(PointSupport { name: key.to_owned(), vertex, displacement });
    }
    Ok(points)
}
