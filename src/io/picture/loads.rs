//! Supports and loads of the body: supports as hatching (held altogether) or as a row of rollers (held along one direction), loads and
//! prescribed displacements as arrows, the place of the largest stress, and a bar for the scale.

use svg::Node;
use svg::node::element::{Circle, Group, Path as PathElement};

use super::contact::{arrow, hatched};
use super::draw::{
    DARK, GREY, PageMap, PathData, Point, SAMPLE, anchored, clean, direction, distance, dot, moved,
    places, short, stroke,
};
use super::scene::{Load, Scene};
use crate::io::case::Case;
use crate::io::numbers::round_below;
use crate::model::{BoundaryEdge, Condition, Degree, SharedFunction};
use crate::results::Solution;

/// The colour of forces, and that of prescribed displacements.
pub(super) const FORCE: &str = "#0072b2";
pub(super) const MOTION: &str = "#009e73";

/// The longest arrow on the page, the room between two, and that between rollers.
const LONGEST: f64 = 34.0;
const APART: f64 = 26.0;
const ROLLERS: f64 = 12.0;

/// An arrow of a share below this is none.
const NO_ARROW: f64 = 0.02;

/// The nodes of an edge in order along it.
fn along(case: &Case, s: &Solution, edge: BoundaryEdge) -> Vec<usize> {
    let [a, b] = case.problem.mesh.ends(edge);
    match s.degree {
        Degree::One => vec![a, b],
        Degree::Two => vec![a, s.elements[6 * edge.triangle + 3 + edge.local], b],
    }
}

/// The nodes of a named boundary, edge by edge; none for a name that is no boundary.
fn lines(case: &Case, s: &Solution, name: &str) -> Vec<Vec<usize>> {
    let edges = case.problem.mesh.edges_of(name).unwrap_or_default();
    edges.iter().map(|&edge| along(case, s, edge)).collect()
}

/// The supports of the body, each with whether it holds both components.
pub(super) fn supports(case: &Case, s: &Solution) -> Vec<(Vec<usize>, bool)> {
    let mut supports = Vec::new();
    for (name, condition) in &case.problem.conditions {
        let held = match condition {
            Condition::Displacement(components)
            | Condition::Mixed { displacement: components, .. } => {
                components.each_ref().map(Option::is_some)
            }
            Condition::Support { normal, tangential } => [normal.is_some(), tangential.is_some()],
            _ => [false; 2],
        };
        if held != [false; 2] {
            supports.extend(lines(case, s, name).into_iter().map(|line| (line, held == [true; 2])));
        }
    }
    for point in &case.problem.points {
        let held = point.displacement.each_ref().map(Option::is_some);
        supports.push((vec![point.vertex], held == [true; 2]));
    }
    supports
}

/// The arrows of tractions and pressures, and those of prescribed displacements, each kind beside its largest.
pub(super) fn loads(case: &Case, s: &Solution) -> Vec<Load> {
    let mut loads = Vec::new();
    let mut add = |at: usize, arrow: Point, is_motion: bool| {
        if arrow.iter().all(|c| c.is_finite()) && arrow != [0.0; 2] {
            loads.push(Load { at, arrow, is_motion });
        }
    };
    let value = |f: &Option<SharedFunction>, x: Point| f.as_ref().map_or(0.0, |f| f.at(x));
    for (name, condition) in &case.problem.conditions {
        let edges = case.problem.mesh.edges_of(name).unwrap_or_default();
        for &edge in edges {
            let normal: Point = case.problem.mesh.length_and_normal(edge).1.into();
            for at in along(case, s, edge) {
                let x = s.nodes[at];
                match condition {
                    Condition::Traction(t) => add(at, t.each_ref().map(|t| t.at(x)), false),
                    Condition::Pressure(p) => add(at, normal.map(|n| -p.at(x) * n), false),
                    Condition::Displacement(u) => {
                        add(at, u.each_ref().map(|u| value(u, x)), true);
                    }
                    Condition::Mixed { displacement, traction } => {
                        add(at, displacement.each_ref().map(|u| value(u, x)), true);
                        add(at, traction.each_ref().map(|t| t.at(x)), false);
                    }
                    Condition::Support { normal: u_n, .. } => {
                        add(at, normal.map(|n| value(u_n, x) * n), true);
                    }
                    _ => {}
                }
            }
        }
    }
    for is_motion in [false, true] {
        let of_kind = |load: &&mut Load| load.is_motion == is_motion;
        let size = |load: &Load| distance(load.arrow, [0.0; 2]);
        let most = loads.iter().filter(|l| l.is_motion == is_motion).map(size).fold(0.0, f64::max);
        loads.iter_mut().filter(of_kind).for_each(|load| load.arrow = load.arrow.map(|c| c / most));
    }
    loads
}

/// The supports on the page, on the deformed body; `None` if nothing holds it.
pub(super) fn drawn_supports(scene: &Scene, deformed: &[Point]) -> Option<Group> {
    let line = |nodes: &[usize]| nodes.iter().map(|&v| deformed[v]).collect::<Vec<Point>>();
    let mut group = Group::new();
    let held = scene.supports.iter().filter(|(nodes, both)| *both && nodes.len() > 1);
    let held = hatched(joined(held.map(|(nodes, _)| line(nodes)).collect()));
    let mut rollers = Vec::new();
    let partly = scene.supports.iter().filter(|(nodes, both)| !both && nodes.len() > 1);
    for points in joined(partly.map(|(nodes, _)| line(nodes)).collect()) {
        for (i, fraction) in places(&points, ROLLERS) {
            let (a, b) = (points[i], points[i + 1]);
            if let Some([x, y]) = direction(a, b) {
                // The body is on the left of the line, on a page whose second axis points down.
                let foot = super::draw::between(a, b, fraction);
                rollers.push(moved(foot, [-y, x], 4.0));
            }
        }
    }
    for (nodes, both) in scene.supports.iter().filter(|(nodes, _)| nodes.len() == 1) {
        group.append(point_support(deformed[nodes[0]], *both));
    }
    rollers.into_iter().for_each(|at| group.append(roller(at)));
    held.into_iter().for_each(|held| group.append(held));
    (!group.get_children()?.is_empty()).then_some(group)
}

fn roller(at: Point) -> Circle {
    dot(at).set("r", 3.2).set("fill", "white").set("stroke", DARK)
}

/// A triangle below a point that is held: full if both components are, else empty.
fn point_support([x, y]: Point, both: bool) -> PathElement {
    let mut triangle = PathData::default();
    triangle.polygon([[x, y], [x - 6.0, y + 10.0], [x + 6.0, y + 10.0]]);
    stroke(triangle, DARK, 1.2).set("fill", if both { DARK } else { "white" })
}

pub(super) fn wall_sample() -> Option<Group> {
    hatched([SAMPLE.map(|[x, y]| [x, y - 3.0]).to_vec()])
}

/// The entries of the legend for the kinds of supports, each with whether the picture has one.
pub(super) fn support_entries(scene: &Scene) -> [(bool, Option<Group>, &'static str); 4] {
    let has = |point: bool, both: bool| {
        scene.supports.iter().any(|s| (s.0.len() == 1) == point && s.1 == both)
    };
    let triangle = |both| Some(Group::new().add(point_support([15.0, -10.0], both)));
    let rollers = Group::new().add(roller([9.0, -4.5])).add(roller([21.0, -4.5]));
    [
        (has(false, true), wall_sample(), "held"),
        (has(false, false), Some(rollers), "held in one direction"),
        (has(true, true), triangle(true), "point, held"),
        (has(true, false), triangle(false), "point, held in one direction"),
    ]
}

/// Lines that go on where another one ends, in one.
fn joined(lines: Vec<Vec<Point>>) -> Vec<Vec<Point>> {
    let mut joined: Vec<Vec<Point>> = Vec::new();
    for line in lines {
        if let Some(before) = joined.iter_mut().find(|other| other.last() == line.first()) {
            before.extend(line.into_iter().skip(1));
        } else if let Some(after) = joined.iter_mut().find(|other| line.last() == other.first()) {
            after.splice(0..1, line);
        } else {
            joined.push(line);
        }
    }
    joined
}

/// The arrows of one kind, some way apart; `None` if there are none.
pub(super) fn arrows(scene: &Scene, deformed: &[Point], is_motion: bool) -> Option<Group> {
    let mut path = PathData::default();
    let mut feet: Vec<Point> = Vec::new();
    for load in scene.loads.iter().filter(|load| load.is_motion == is_motion) {
        let foot = deformed[load.at];
        let share = distance(load.arrow, [0.0; 2]);
        if share < NO_ARROW || feet.iter().any(|&other| distance(other, foot) < APART) {
            continue;
        }
        feet.push(foot);
        // The page's second axis points down. A force ends at the body, a displacement starts there.
        let step = [load.arrow[0], -load.arrow[1]];
        let far = moved(foot, step, if is_motion { LONGEST } else { -LONGEST });
        let (from, to) = if is_motion { (foot, far) } else { (far, foot) };
        arrow(from, to, &mut path);
    }
    let colour = if is_motion { MOTION } else { FORCE };
    (!path.is_empty()).then(|| Group::new().add(stroke(path, colour, 1.6)))
}

/// A cross at a point of the page.
pub(super) fn cross(at: Point) -> Group {
    let mut path = PathData::default();
    for side in [-1.0, 1.0] {
        path.line([moved(at, [side, 1.0], -5.0), moved(at, [side, 1.0], 5.0)]);
    }
    Group::new().add(stroke(path.clone(), "white", 4.0)).add(stroke(path, DARK, 1.6))
}

/// A bar of a round length of the undeformed body, its right end at a point of the page.
pub(super) fn scale_bar(frame: &PageMap, unit: Option<&str>, [right, y]: Point) -> Group {
    let length = round_below(110.0 / frame.scale);
    let left = right - length * frame.scale;
    let mut path = PathData::default();
    path.line([[left, y - 4.0], [left, y + 4.0]]);
    path.line([[left, y], [right, y]]);
    path.line([[right, y - 4.0], [right, y + 4.0]]);
    let words = clean(&format!("{} {}", short(length), unit.unwrap_or_default()));
    let label = anchored("end", words.trim_end(), [left - 6.0, y + 4.0]);
    Group::new().add(stroke(path, GREY, 1.2)).add(label.set("fill", GREY).set("font-size", 12))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::solve::solve;

    #[test]
    fn arrows_point_as_loads_and_displacements_do_beside_the_largest_of_their_kind() {
        let text = r#"
mesh.rectangle = { width = 2, height = 1, nx = 2, ny = 1 }
material = { lambda = 1, mu = 1 }
boundary.right.pressure = "0.2"
boundary.top.traction = ["0.1", "-0.4"]
boundary.left.displacement = ["0.03", "0.01 - 0.01*y"]
boundary.bottom.contact = { gap = "0" }
"#;
        let case = Case::parse(Path::new("in_a_test.toml"), text, &[]).unwrap();
        let (s, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        let loads = loads(&case, &s);
        // Of the traction, the longest force, and of (0.03, 0.01), the longest displacement.
        let (force, motion) = (0.17_f64.sqrt(), 0.001_f64.sqrt());
        let mut seen = [0; 3];
        for load in &loads {
            let [x, y] = s.nodes[load.at];
            let (kind, expected) = match load.is_motion {
                true => (0, [0.03 / motion, (0.01 - 0.01 * y) / motion]),
                false if x == 2.0 && load.arrow[0] < 0.0 => (1, [-0.2 / force, 0.0]),
                false => (2, [0.1 / force, -0.4 / force]),
            };
            assert!(distance(load.arrow, expected) < 1e-14, "{load:?}, expected {expected:?}");
            assert!(x == [0.0, 2.0, x][kind] && (kind < 2 || y == 1.0), "{load:?}");
            seen[kind] += 1;
        }
        assert!(seen.iter().all(|&count| count > 1), "{seen:?}");
    }
}
