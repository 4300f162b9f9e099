//! The body: its triangles in the colours of their von Mises stress with the bar of these, its outline before and after, the
//! lines between materials.

use svg::node::element::{ClipPath, Definitions, Group, LinearGradient, Stop};

use super::cells::{area, rectangles};
use super::draw::{
    DARK, GREY, PageAxis, PageMap, PathData, Point, VIRIDIS, clean, fitting, loops, quantile,
    rectangle, shape, short, stroke, text, thinned, viridis,
};
use super::scene::Scene;
use crate::io::numbers::ticks;

/// The most triangles that are drawn one by one: more would make the file too large, and are drawn by cells.
const MOST_TRIANGLES: usize = 20_000;

/// The side of such a cell.
const CELL: f64 = 2.5;

/// The most triangles of which the mesh itself is worth seeing.
const MOST_VISIBLE_TRIANGLES: usize = 3000;

fn outline_path(scene: &Scene, points: &[Point]) -> PathData {
    let mut path = PathData::default();
    for vertices in loops(&scene.outline, points.len()) {
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
    let last = VIRIDIS.len() - 1;
    for i in 0..=last {
        let place = i as f64 / last as f64;
        gradient = gradient.add(Stop::new().set("offset", place).set("stop-color", viridis(place)));
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
    let mut levels = vec![PathData::default(); LEVELS];
    let by_cells = triangles.len() > MOST_TRIANGLES;
    let of: Vec<usize> = scene.von_mises.iter().map(|&value| colours.level(value)).collect();
    if by_cells {
        for (level, corners) in rectangles(CELL, &triangles, &of) {
            levels[level].polygon(corners);
        }
    } else {
        triangles.iter().zip(of).for_each(|(&corners, level)| levels[level].polygon(corners));
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
        let mut mesh = PathData::default();
        triangles.into_iter().for_each(|corners| mesh.polygon(corners));
        group = group.add(stroke(mesh, "white", 0.5).set("stroke-opacity", 0.35));
    }
    group
}

pub(super) fn outlines(scene: &Scene, deformed: &[Point], frame: &PageMap) -> Group {
    let before: Vec<Point> = scene.points.iter().map(|&p| frame.page(p)).collect();
    let mut interfaces = PathData::default();
    for &[a, b] in &scene.interfaces {
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

/// Colours of the von Mises stress: more than the eye tells apart.
pub(super) const LEVELS: usize = 128;

/// The range of the von Mises stress, and where the colours end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Colours {
    pub(super) min: f64,
    pub(super) top: f64,
    pub(super) max: f64,
}

/// The part of the body's area that may lie above the colours: at a corner the stress is singular, and its value there
/// tells of the mesh, not of the body.
const ABOVE: f64 = 1.0 / 500.0;

impl Colours {
    /// The colours end below the maximum where most of them would otherwise be spent on next to nothing. A range that is
    /// mere rounding is none.
    pub(super) fn of(scene: &Scene) -> Colours {
        let mut parts: Vec<(f64, f64)> = scene
            .triangles
            .iter()
            .zip(&scene.von_mises)
            .map(|(vertices, &value)| (value, area(&vertices.map(|v| scene.points[v])).abs()))
            .collect();
        let values = scene.von_mises.iter().copied();
        let [min, max] = [values.clone().reduce(f64::min), values.reduce(f64::max)];
        let [min, max] = [min, max].map(|end| end.unwrap_or(0.0));
        let quantile = quantile(&mut parts, ABOVE).unwrap_or(0.0);
        if max - min <= 1e-9 * max {
            Colours { min: max, top: max, max }
        } else if quantile > min && max > 1.5 * quantile {
            Colours { min, top: quantile, max }
        } else {
            Colours { min, top: max, max }
        }
    }

    /// The colours of two pictures together.
    pub(super) fn with(self, other: Colours) -> Colours {
        Colours {
            min: self.min.min(other.min),
            top: self.top.max(other.top),
            max: self.max.max(other.max),
        }
    }

    pub(super) fn level(&self, value: f64) -> usize {
        let levels = PageAxis { range: [self.min, self.top], page: [0.0, LEVELS as f64] };
        levels.at(value).min((LEVELS - 1) as f64) as usize
    }

    pub(super) fn colour(level: usize) -> String {
        viridis(level as f64 / (LEVELS - 1) as f64)
    }
}

/// The room beside the drawing for the bar.
pub(super) const BAR: f64 = 150.0;

/// The bar of the colours, beside the drawing: `corner` is the upper left one of its room.
pub(super) fn colour_bar(
    colours: &Colours,
    unit: Option<&str>,
    [left, top]: Point,
    height: f64,
) -> Group {
    let capped = colours.top < colours.max;
    let label = |at: f64, content: String| {
        let size = fitting(&content, 13.0, BAR - 28.0);
        text(content, [left + 28.0, at + 4.5]).set("font-size", size)
    };
    // The summary has the largest of nodal means, which can lie above and below these.
    let means = match unit {
        Some(unit) => format!("{}, triangle means", clean(unit)),
        None => "triangle means".to_owned(),
    };
    let size = fitting(&means, 13.0, BAR);
    let group = Group::new()
        .add(text("von Mises stress", [left, top - 4.0]))
        .add(text(means, [left, top + 12.0]).set("fill", GREY).set("font-size", size));
    let bottom = top + height - 10.0;
    let top = top + if capped { 48.0 } else { 30.0 };
    let height = bottom - top;
    let bar = rectangle([left, top], [18.0, height]);
    if colours.top <= colours.min {
        let fill = Colours::colour(colours.level(colours.max));
        return group.add(bar.set("fill", fill)).add(label(top + height / 2.0, short(colours.max)));
    }
    let axis = PageAxis { range: [colours.min, colours.top], page: [bottom, top] };
    let at = |value| axis.at(value);
    let mut marks = PathData::default();
    let mut labels = Group::new();
    for value in [colours.min, colours.top] {
        marks.line([[left + 18.0, at(value)], [left + 25.0, at(value)]]);
        labels = labels.add(label(at(value), short(value)).set("font-weight", "bold"));
    }
    for (value, content) in ticks(colours.min, colours.top) {
        let y = at(value);
        if (y - top).min(top + height - y) >= 16.0 {
            marks.line([[left + 18.0, y], [left + 23.0, y]]);
            labels = labels.add(label(y, content));
        }
    }
    if capped {
        let mut peak = PathData::default();
        peak.polygon([[left, top + 0.5], [left + 9.0, top - 16.0], [left + 18.0, top + 0.5]]);
        labels = labels
            .add(shape(peak).set("fill", Colours::colour(LEVELS - 1)))
            .add(label(top - 16.0, format!("max {}", short(colours.max))));
    }
    group.add(bar.set("fill", "url(#von-mises)")).add(stroke(marks, DARK, 1.0)).add(labels)
}
