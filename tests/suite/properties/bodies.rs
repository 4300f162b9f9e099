//! Bodies that the properties are about: nine small ones, without and with loads.

use std::f64::consts::PI;

use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Mesh, Problem, Rectangle, Trapezoid};

use super::{Outcome, text};
use crate::common::{conditions, constant, function};

/// A body that is held on the named sides and in contact below.
fn held(mesh: Mesh, lambda: f64, plane: Plane, sides: &[&str]) -> Problem {
    let mut all = conditions([("bottom", Condition::contact(|_| 0.0))]);
    all.extend(sides.iter().map(|&side| (side.to_owned(), Condition::clamped())));
    let nothing = [constant(0.0), constant(0.0)];
    Problem::new(mesh, Material::lame(lambda, 1.0, plane), nothing, all)
}

/// Bodies of a few triangles of all shapes, by name, without loads.
pub fn small_bodies() -> Result<Vec<(&'static str, Problem)>, String> {
    let cells = |nx, diagonal| Rectangle { width: nx as f64, height: 1.0, nx, ny: 1, diagonal };
    let grid = |nx, diagonal| cells(nx, diagonal).mesh().map_err(text);
    let moved = cells(2, Diagonal::Right).perturbed(0.2, 1).map_err(text)?;
    let flat = Rectangle { width: 4.0, ..cells(1, Diagonal::Right) }.mesh().map_err(text)?;
    let wedge = Trapezoid { omega: 0.75 * PI, n: 1 }.mesh().map_err(text)?;
    let two_triangles = |e: f64| {
        let vertices = vec![[-3.0, 0.0], [3.0, 0.0], [0.0, 4.0], [e, 4.0]];
        let named = [("bottom", [0, 1]), ("top", [2, 3])];
        let named = named.map(|(name, edge)| (name.to_owned(), vec![edge]));
        Mesh::new(vertices, vec![[0, 1, 2], [1, 3, 2]], named).map_err(text)
    };
    let on_top = |mesh| held(mesh, 1.0, Plane::Strain, &["top"]);
    Ok(vec![
        ("square", on_top(grid(1, Diagonal::Right)?)),
        ("two cells", on_top(grid(2, Diagonal::Right)?)),
        ("two cells, moved", on_top(moved)),
        ("crossed cell", on_top(grid(1, Diagonal::Crossed)?)),
        ("cell 4:1", on_top(flat)),
        ("plane stress", held(grid(1, Diagonal::Left)?, 3.0, Plane::Stress, &["top"])),
        ("wedge", held(wedge, 1.0, Plane::Strain, &["right", "top"])),
        ("two triangles, e = 0.1", on_top(two_triangles(0.1)?)),
        ("two triangles, e = 0.01", on_top(two_triangles(0.01)?)),
    ])
}

/// The same under a load and a displacement of one side, half of them pressed on their obstacle.
pub fn loaded_bodies() -> Result<Vec<(&'static str, Problem)>, String> {
    let mut bodies = small_bodies()?;
    for (i, (_, problem)) in bodies.iter_mut().enumerate() {
        let down = if i % 2 == 0 { -1.0 } else { 1.0 };
        problem.body_force = [constant(0.3), constant(down)];
        // One side is moved: two that meet would have to agree.
        let side = if problem.conditions.remove("right").is_some() { "right" } else { "top" };
        // The right side ends on the bottom, and no further down than its obstacle.
        let by = if side == "right" { 0.02 } else { 0.1 };
        let moved = Condition::Displacement([0.05, by * down].map(|u| Some(constant(u))));
        problem.conditions.remove("top");
        let gap = function(|[x, _]| 0.02 + 0.01 * x);
        let all = [(side, moved), ("bottom", Condition::Contact { gap })];
        problem.conditions.extend(conditions(all));
    }
    Ok(bodies)
}

/// What holds of each loaded body, P1 and P2.
pub fn on_bodies(mut check: impl FnMut(&Problem, Degree) -> Outcome) -> Outcome {
    for (name, problem) in &loaded_bodies()? {
        for degree in [Degree::One, Degree::Two] {
            check(problem, degree).map_err(|why| format!("{name}, {degree:?}: {why}"))?;
        }
    }
    Ok(())
}
