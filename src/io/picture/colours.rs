//! The colours of the von Mises stress, and their bar.

use svg::node::element::{Group, Rectangle};

use super::cells::area;
use super::frame::Frame;
use super::page::{DARK, GREY, HEADER, MARGIN, clean, rounded, shape, short, stroke, text};
use super::path::Path;
use super::scene::Scene;
use super::viridis;
use crate::io::numbers::ticks;

/// Colours of the von Mises stress: more than the eye tells apart.
pub(super) const LEVELS: usize = 128;

/// The range of the von Mises stress, and where the colours end.
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
            .zip(scene.von_mises)
            .map(|(vertices, &value)| (value, area(&vertices.map(|v| scene.points[v])).abs()))
            .collect();
        parts.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        let whole: f64 = parts.iter().map(|part| part.1).sum();
        let mut above = 0.0;
        let quantile = parts.iter().find(|part| {
            above += part.1;
            above > ABOVE * whole
        });
        let [min, quantile, max] =
            [parts.last(), quantile, parts.first()].map(|part| part.map_or(0.0, |part| part.0));
        if max - min <= 1e-9 * max {
            Colours { min: max, top: max, max }
        } else if quantile > min && max > 1.5 * quantile {
            Colours { min, top: quantile, max }
        } else {
            Colours { min, top: max, max }
        }
    }

    fn position(&self, value: f64) -> f64 {
        if self.top > self.min { (value - self.min) / (self.top - self.min) } else { 0.5 }
    }

    pub(super) fn level(&self, value: f64) -> usize {
        (self.position(value) * LEVELS as f64).min((LEVELS - 1) as f64) as usize
    }

    pub(super) fn colour(level: usize) -> String {
        viridis::colour(level as f64 / (LEVELS - 1) as f64)
    }
}

pub(super) fn colour_bar(colours: &Colours, unit: Option<&str>, frame: &Frame) -> Group {
    let capped = colours.top < colours.max;
    let left = MARGIN + frame.width + 20.0;
    let top = HEADER + if capped { 48.0 } else { 30.0 };
    let height = HEADER + frame.height - 10.0 - top;
    let bar = Rectangle::new()
        .set("x", rounded(left))
        .set("y", rounded(top))
        .set("width", 18)
        .set("height", rounded(height));
    let line = if unit.is_some() { -4.0 } else { 12.0 };
    let heading = Group::new().add(text("von Mises stress", [left, HEADER + line]));
    let heading = match unit {
        Some(unit) => heading.add(text(clean(unit), [left, HEADER + 12.0]).set("fill", GREY)),
        None => heading,
    };
    let label = |at: f64, content: String| text(content, [left + 28.0, at + 4.5]);
    let group = Group::new().add(heading);
    if colours.top <= colours.min {
        let fill = Colours::colour(colours.level(colours.max));
        return group.add(bar.set("fill", fill)).add(label(top + height / 2.0, short(colours.max)));
    }
    let at = |value: f64| top + height * (1.0 - colours.position(value));
    let mut marks = Path::default();
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
        let mut peak = Path::default();
        peak.polygon([[left, top + 0.5], [left + 9.0, top - 16.0], [left + 18.0, top + 0.5]]);
        labels = labels
            .add(shape(peak).set("fill", Colours::colour(LEVELS - 1)))
            .add(label(top - 16.0, format!("max {}", short(colours.max))));
    }
    group.add(bar.set("fill", "url(#von-mises)")).add(stroke(marks, DARK, 1.0)).add(labels)
}
