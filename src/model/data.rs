//! Errors of a problem that can't be posed on its mesh, and the check of numbers that must be finite.

use thiserror::Error;

use super::function::Function;
use super::material::MaterialError;
use super::mesh::MeshError;
use crate::model::pairs::PairError;
use crate::model::rigid::FreeMotion;
use crate::quote::{key, number, quoted, short};

/// Why a problem can't be posed on its mesh.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
pub enum DataError {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Pair(#[from] PairError),
    #[error("{what} is {value} at ({}, {}); expected a finite number at every point of the mesh", number(*x), number(*y))]
    NotFinite { what: String, value: f64, x: f64, y: f64 },
    #[error(
        "the displacement boundaries {} and {} meet at ({}, {}) and disagree there: {} = {} and {}; expected one value",
        quoted(first, '\''), quoted(second, '\''), number(*x), number(*y), component(*direction), number(values[0]), number(values[1])
    )]
    Disagree {
        first: String,
        second: String,
        x: f64,
        y: f64,
        direction: [f64; 2],
        values: [f64; 2],
    },
    #[error(
        "the body is not held: nothing stops the {}{}; expected a support that stops it, such as displacement = [0, 0] or normal = 0 on a boundary, or loads that press the body against its obstacles (contact can push, not pull){}",
        listed(motions), driven(motions, *drive), of_bodies(motions)
    )]
    RigidMotion { motions: Vec<FreeMotion>, drive: Option<f64> },
    #[error(
        "{what} has a gradient of length {} at ({}, {}); expected a distance there, with a gradient between {least} and {most}: divide the expression by the length of its gradient",
        number(*length), number(*x), number(*y)
    )]
    NoDistance { what: String, length: f64, x: f64, y: f64, least: f64, most: f64 },
    #[error(
        "{what} has no closest point to ({}, {}), its centre; expected a contact line that does not reach there",
        number(*x), number(*y)
    )]
    NoClosestPoint { what: String, x: f64, y: f64 },
    #[error(
        "[obstacle.{}] lies on the other side of the body: from ({}, {}) on the boundary {} its direction ({}, {}) leads into the body; expected a normal towards the body (turn its sign), a circle whose side is where the body is (\"outside\" or \"inside\"), or a distance that is positive there; or a boundary without edges that face away from the obstacle",
        key(obstacle), number(*x), number(*y), quoted(boundary, '\''), number(direction[0]), number(direction[1])
    )]
    WrongSide { obstacle: String, boundary: String, x: f64, y: f64, direction: [f64; 2] },
    #[error(
        "{} holds ({}, {}) by {} inside the obstacle of {}, which must keep it out: no displacement of finite energy does both, and forces would grow as the mesh is refined; expected a support that moves this point no further than to the obstacle, a gap that leaves it room, or a contact boundary that ends before it",
        quoted(support, '\''), number(*x), number(*y), short(*depth), quoted(boundary, '\'')
    )]
    HeldInside { support: String, boundary: String, x: f64, y: f64, depth: f64 },
    #[error(
        "{what} is {value} at ({}, {}); expected a stress that is not negative at every point of the boundary",
        number(*x), number(*y)
    )]
    NegativeFriction { what: String, value: f64, x: f64, y: f64 },
    #[error("{what} has friction and no contact; expected a boundary with contact, or no friction")]
    FrictionWithoutContact { what: String },
    #[error(
        "{what} has friction, and the body is one of revolution: friction there is not computed by this program; expected contact without friction, or a plane body"
    )]
    FrictionInRevolution { what: String },
    #[error("the material is none: {0}")]
    Material(#[from] MaterialError),
    #[error("{what} is {found}; expected {expected}")]
    Value { what: &'static str, found: String, expected: &'static str },
    #[error("no boundary has contact; expected one with contact = {{ gap = ... }}")]
    NoContact,
}

/// The component of the displacement along a direction.
fn component([x, y]: [f64; 2]) -> String {
    match [x, y] {
        [1.0, 0.0] => "u_x".to_owned(),
        [0.0, 1.0] => "u_y".to_owned(),
        _ => format!("u . ({}, {})", number(x), number(y)),
    }
}

/// The number of free motions that a message lists.
const LISTED: usize = 4;

fn listed(motions: &[FreeMotion]) -> String {
    let said = |motion: &FreeMotion| format!("{motion}: {}", motion.remedy());
    let list: Vec<String> = motions.iter().take(LISTED).map(said).collect();
    let more = match motions.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!("; nor {more} more"),
    };
    list.join("; nor the ") + &more
}

/// Other means of holding a body that is one of several, for messages.
fn of_bodies(motions: &[FreeMotion]) -> &'static str {
    if motions.iter().any(FreeMotion::is_of_one_of_several) {
        "; bodies that touch each other are a [[pair]] of boundaries"
    } else {
        ""
    }
}

fn driven(motions: &[FreeMotion], drive: Option<f64>) -> String {
    let (Some(drive), Some(motion)) = (drive, motions.first()) else { return String::new() };
    let what = if motion.about().is_some() { "moment" } else { "force" };
    let drive = format!("{drive:.3e}").parse().unwrap_or(drive);
    format!("; the loads drive it with a {what} of {}", number(drive))
}

/// The value of `function`, which the case calls `what()`, at `x`.
///
/// # Errors
/// [`DataError::NotFinite`].
pub(crate) fn finite(
    function: &dyn Function,
    x: [f64; 2],
    what: impl Fn() -> String,
) -> Result<f64, DataError> {
    checked(function.at(x), x, what)
}

/// Returns `value`, that of `what()` at `x`, if it is finite.
///
/// # Errors
/// [`DataError::NotFinite`].
pub(crate) fn checked(
    value: f64,
    x: [f64; 2],
    what: impl Fn() -> String,
) -> Result<f64, DataError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(DataError::NotFinite { what: what(), value, x: x[0], y: x[1] })
    }
}
