//! The body: its triangles in the colours of their stress, its outline before and after, the lines between materials.

use svg::node::element::{ClipPath, Definitions, Group, LinearGradient, Stop};

use super::cells::Cells;
use super::colours::{Colours, LEVELS};
use super::frame::Frame;
use super::page::{DARK, GREY, shape, stroke};
use super::path::{Path, Point, loops, thinned};
use super::scene::Scene;
use super::viridis;

/// A body of more triangles than this is drawn by cells: one by one they would make the file too large.
pub const MOST_TRIANGLES: usize = 20_000;

/// The side of such a cell.
const CELL: f64 = 2.5;

/// Up to here the mesh itself is worth seeing.
const MOST_VISIBLE_TRIANGLES: usize = 3000;

fn outline_path(scene: &Scene, points: &[Point]) -> Path {
    let mut path = Path::default();
    for vertices in loops(scene.outline, points.len()) {
        let line: Vec<Point> = vertices.into_iter().map(|v| points[v]).collect();
        path.polygon(thinned(&line));
    }
    path
}

/// The colours of the bar, and the shape of the body that the cells are cut along.
pub(super) fn definitions(scene: &Scene, deformed: &[Point]) -> Definitions {
    let mut gradient = LinearGradient::new()
        .set("id", "von-mises")
        .set("x1", 0)
        .set("y1", 1)
        .set("x2", 0)
        .set("y2", 0);
    let last = viridis::STOPS.len() - 1;
    for i in 0..=last {
        let place = i as f64 / last as f64;
        gradient = gradient
            .add(Stop::new().set("offset", place).set("stop-color", viridis::colour(place)));
    }
    let definitions = Definitions::new().add(gradient);
    if scene.triangles.len() <= MOST_TRIANGLES {
        return definitions;
    }
    definitions.add(ClipPath::new().set("id", "body").add(shape(outline_path(scene, deformed))))
}

/// The triangles, or cells instead of them, one path for each colour. A stroke of the same colour closes the hairlines
/// between neighbours.
pub(super) fn body(scene: &Scene, deformed: &[Point], colours: &Colours) -> Group {
    let triangles: Vec<[Point; 3]> =
        scene.triangles.iter().map(|vertices| vertices.map(|v| deformed[v])).collect();
    let mut levels = vec![Path::default(); LEVELS];
    let by_cells = triangles.len() > MOST_TRIANGLES;
    if by_cells {
        let cells = Cells::new(CELL, &triangles, scene.von_mises);
        for (level, corners) in cells.rectangles(|value| colours.level(value)) {
            levels[level].polygon(corners);
        }
    } else {
        for (&corners, &value) in triangles.iter().zip(scene.von_mises) {
            levels[colours.level(value)].polygon(corners);
        }
    }
    let mut group = Group::new().set("stroke-width", 0.7).set("stroke-linejoin", "round");
    if by_cells {
        group = group.set("clip-path", "url(#body)");
    }
    for (level, path) in levels.into_iter().enumerate().filter(|(_, path)| !path.is_empty()) {
        let colour = Colours::colour(level);
        group = group.add(shape(path).set("fill", colour.clone()).set("stroke", colour));
    }
    if triangles.len() <= MOST_VISIBLE_TRIANGLES {
        let mut mesh = Path::default();
        triangles.into_iter().for_each(|corners| mesh.polygon(corners));
        group = group.add(stroke(mesh, "white", 0.5).set("stroke-opacity", 0.35));
    }
    group
}

pub(super) fn outlines(scene: &Scene, deformed: &[Point], frame: &Frame) -> Group {
    let before: Vec<Point> = scene.points.iter().map(|&p| frame.page(p)).collect();
    let mut interfaces = Path::default();
    for &[a, b] in scene.interfaces {
        interfaces.line([deformed[a], deformed[b]]);
    }
    Group::new()
        .set("stroke-linejoin", "round")
        .set("stroke-linecap", "round")
        .add(stroke(interfaces.clone(), "white", 2.4))
        .add(stroke(interfaces, DARK, 1.0))
        .add(stroke(outline_path(scene, deformed), DARK, 1.2))
        .add(stroke(outline_path(scene, &before), GREY, 1.2).set("stroke-dasharray", "6 4"))
}
