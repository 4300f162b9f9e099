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

/// An upright rectangle.
pub(super) struct Ground {
    low: Point,
    size: Point,
}

impl Ground {
    /// Some of the step from `a` to `b` lies in it.
    pub(super) fn meets(&self, a: Point, b: Point) -> bool {
        // The part of the step between the sides of both pairs.
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for k in 0..2 {
            let (low, high) = (self.low[k] - a[k], self.low[k] + self.size[k] - a[k]);
            let step = b[k] - a[k];
            if step == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
            } else {
                from = from.max((low / step).min(high / step));
                to = to.min((low / step).max(high / step));
            }
        }
        from <= to
    }
}

/// Where a text lies. `anchor` is the part of it at `place`.
pub(super) fn ground(content: &str, place: Point, anchor: &str, size: f64) -> Ground {
    let width = width_of(content, size);
    let left = match anchor {
        "start" => 0.0,
        "end" => width,
        _ => width / 2.0,
    };
    Ground { low: [place[0] - left, place[1] - 0.85 * size], size: [width, 1.1 * size] }
}

/// A text on a pale ground, so that it can be read over what is drawn below it. `anchor` is the part of it at `place`.
pub(super) fn label(content: &str, place: Point, anchor: &str, size: f64) -> Group {
    let Ground { low: [x, y], size: [width, height] } = ground(content, place, anchor, size);
    let ground = Rectangle::new()
        .set("x", rounded(x))
        .set("y", rounded(y))
        .set("width", rounded(width))
        .set("height", rounded(height))
        .set("rx", 2)
        .set("fill", "white")
        .set("fill-opacity", 0.75);
    Group::new().add(ground).add(text(content, place).set("text-anchor", anchor))
}

/// The width of a text, roughly: no font is at hand, and the reader's may be another.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}
