//! The page: its margins, colours and letters, and what is put on it.

use svg::node::element::{Group, Path as PathElement, Rectangle, Text};

use super::path::{Path, Point};
use crate::io::numbers;

/// The digits of labels.
const DIGITS: usize = 3;

pub(super) fn short(x: f64) -> String {
    numbers::short(x, DIGITS)
}

pub(super) const FONT: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";
pub(super) const DARK: &str = "#222222";
pub(super) const GREY: &str = "#666666";
pub(super) const RED: &str = "#d62728";

/// The page around the drawing.
pub(super) const MARGIN: f64 = 36.0;
pub(super) const HEADER: f64 = 88.0;
pub(super) const FOOTER: f64 = 64.0;
pub(super) const BAR: f64 = 150.0;

/// Text that XML allows.
pub(super) fn clean(text: &str) -> String {
    let allowed = |c: char| !(c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'));
    text.chars().map(|c| if allowed(c) { c } else { ' ' }).collect()
}

pub(super) fn text(content: impl Into<String>, [x, y]: Point) -> Text {
    Text::new(content).set("x", rounded(x)).set("y", rounded(y))
}

pub(super) fn rounded(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}

pub(super) fn shape(path: Path) -> PathElement {
    PathElement::new().set("d", path.into_d())
}

pub(super) fn stroke(path: Path, colour: &str, width: f64) -> PathElement {
    shape(path).set("fill", "none").set("stroke", colour).set("stroke-width", width)
}

/// A text on a pale ground, so that it can be read over what is drawn below it. `anchor` is the part of it at `place`.
pub(super) fn label(content: &str, place: Point, anchor: &str, size: f64) -> Group {
    let width = width_of(content, size);
    let left = match anchor {
        "start" => 0.0,
        "end" => width,
        _ => width / 2.0,
    };
    let ground = Rectangle::new()
        .set("x", rounded(place[0] - left))
        .set("y", rounded(place[1] - 0.85 * size))
        .set("width", rounded(width))
        .set("height", rounded(1.1 * size))
        .set("rx", 2)
        .set("fill", "white")
        .set("fill-opacity", 0.75);
    Group::new().add(ground).add(text(content, place).set("text-anchor", anchor))
}

/// The width of a text, roughly: no font is at hand, and the reader's may be another.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}
