//! A panel for each contact boundary: its pressure over the arc length, the peak marked; below it, where there is a
//! certificate, a strip that says what is proved: where the body surely presses, where it is surely nearly open, and where
//! neither is known.
//!
//! A boundary of which only a small part is in contact is shown around that part.

use svg::Node;
use svg::node::element::{Circle, Group, Rectangle};

use super::contact::{RADIUS, tag};
use super::draw::{
    GREY, LIGHT, Path, Point, RED, clean, fitting, rounded, shape, short, stroke, text, thinned,
    width_of,
};
use super::scene::{ContactSample, ContactSurface, ContactZone, Scene};
use crate::io::numbers::ticks;

/// The height of a panel on the page, and the space between two in a row.
const HEIGHT: f64 = 214.0;
const BETWEEN: f64 = 30.0;

/// The drawing area in a panel.
const LEFT: f64 = 58.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 40.0;
const PLOT: f64 = 120.0;

/// The height of the strip below the axis, and its colour where there is hardly a force.
const STRIP: f64 = 5.0;
const OPEN: &str = "#1f77b4";

/// The room above the peak, for its number.
const ABOVE: f64 = 24.0;

/// Panels side by side.
const COLUMNS: usize = 2;

/// The height of all panels.
pub(super) fn height(scene: &Scene) -> f64 {
    HEIGHT * scene.contact.len().div_ceil(COLUMNS) as f64
}

/// The panels, from the point `corner` on and so wide.
pub(super) fn panels(scene: &Scene, corner: Point, width: f64) -> Group {
    let columns = scene.contact.len().clamp(1, COLUMNS);
    let step = (width + BETWEEN) / columns as f64;
    let mut group = Group::new();
    for (i, surface) in scene.contact.iter().enumerate() {
        let [column, row] = [i % columns, i / columns].map(|place| place as f64);
        let corner = [corner[0] + column * step, corner[1] + row * HEIGHT];
        group.append(panel(surface, scene.units, corner, step - BETWEEN));
        if scene.contact.len() > 1 {
            group.append(tag(i, [corner[0] + LEFT - 2.0 * RADIUS, corner[1] + 12.0]));
        }
    }
    group
}

/// From arc length and pressure to the page.
struct Axes {
    left: f64,
    bottom: f64,
    width: f64,
    arc: [f64; 2],
    top: f64,
}

impl Axes {
    fn x(&self, arc: f64) -> f64 {
        let [low, high] = self.arc;
        let part = if high > low { (arc - low) / (high - low) } else { 0.5 };
        self.left + self.width * part
    }

    fn y(&self, pressure: f64) -> f64 {
        self.bottom - (PLOT - ABOVE) * if self.top > 0.0 { pressure / self.top } else { 0.0 }
    }

    fn shows(&self, arc: f64) -> bool {
        (self.arc[0]..=self.arc[1]).contains(&arc)
    }
}

/// The smallest and the largest arc length.
fn range(samples: impl Iterator<Item = f64>) -> [f64; 2] {
    samples.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], s| [l.min(s), h.max(s)])
}

/// The range of the boundary that is shown: all of it, or three times the part in contact where that is shorter.
fn shown(surface: &ContactSurface) -> [f64; 2] {
    let samples = || surface.parts.iter().flatten();
    let [first, last] = range(samples().map(|s| s.arc));
    let [from, to] = range(samples().filter(|s| s.pressure > 0.0).map(|s| s.arc));
    let length = to - from;
    if 3.0 * length < last - first && length > 0.0 {
        [(from - length).max(first), (to + length).min(last)]
    } else {
        [first, last]
    }
}

fn panel(surface: &ContactSurface, units: Option<[&str; 2]>, [x, y]: Point, width: f64) -> Group {
    let peak = surface.peak();
    let axes = Axes {
        left: x + LEFT,
        bottom: y + TOP + PLOT,
        width: width - LEFT - RIGHT,
        arc: shown(surface),
        top: peak.map_or(0.0, |peak| peak.pressure),
    };
    let [stress, length] = [0, 1].map(|i| units.map_or(String::new(), |units| units[i].to_owned()));
    let in_brackets =
        |unit: &str| if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    let title = clean(&format!("{}: contact pressure{}", surface.name, in_brackets(&stress)));
    let room = axes.width;
    let title = text(&title, [axes.left, y + 16.0])
        .set("font-size", fitting(&title, 14.0 / 0.9, room) * 0.9)
        .set("font-weight", "bold");
    let caption = format!("arc length along the boundary{}", in_brackets(&length));
    let caption = text(caption, [axes.left + axes.width / 2.0, axes.bottom + 36.0])
        .set("text-anchor", "middle")
        .set("font-size", 12);
    let frame = Rectangle::new()
        .set("x", rounded(axes.left))
        .set("y", rounded(axes.bottom - PLOT))
        .set("width", rounded(axes.width))
        .set("height", PLOT)
        .set("fill", "none")
        .set("stroke", GREY);
    let mut group = Group::new().add(title).add(caption).add(grid(&axes));
    if let Some(zones) = &surface.zones {
        group = group.add(strip(zones, &axes));
    }
    match peak {
        Some(peak) => {
            group = group.add(curve(surface, &axes)).add(frame).add(mark(peak, &stress, &axes))
        }
        None => {
            let words =
                text("no contact", [axes.left + axes.width / 2.0, axes.bottom - PLOT / 2.0]);
            group = group.add(words.set("text-anchor", "middle").set("fill", GREY)).add(frame);
        }
    }
    group
}

/// Draws the proved zones as a strip, with the words for its colours.
fn strip(zones: &[ContactZone], axes: &Axes) -> Group {
    let bar = |[from, to]: [f64; 2], fill: &str| {
        let [low, high] = axes.arc;
        let [from, to] = [from, to].map(|arc| axes.x(arc.clamp(low, high)));
        Rectangle::new()
            .set("x", rounded(from))
            .set("y", rounded(axes.bottom + 1.0))
            .set("width", rounded(to - from))
            .set("height", STRIP)
            .set("fill", fill)
    };
    let mut group = Group::new().add(bar(axes.arc, LIGHT));
    for zone in zones {
        group.append(bar(zone.arc, if zone.pressed { RED } else { OPEN }));
    }
    let words = [("proved: pressed", RED), ("nearly open", OPEN), ("not known", GREY)];
    let mut left = axes.left;
    for (words, fill) in words {
        let place = [left, axes.bottom + 50.0];
        group.append(text(words, place).set("font-size", 11).set("fill", fill));
        left += width_of(words, 11.0) + 14.0;
    }
    group
}

/// Lines at round numbers, and these.
fn grid(axes: &Axes) -> Group {
    let mut lines = Path::default();
    let mut labels = Group::new().set("font-size", 11);
    for (arc, content) in ticks(axes.arc[0], axes.arc[1]) {
        let x = axes.x(arc);
        lines.line([[x, axes.bottom], [x, axes.bottom - PLOT]]);
        let half = width_of(&content, 11.0) / 2.0;
        let x = x.min(axes.left + axes.width + RIGHT - half);
        labels.append(text(content, [x, axes.bottom + 16.0]).set("text-anchor", "middle"));
    }
    for (pressure, content) in ticks(0.0, axes.top).into_iter().filter(|_| axes.top > 0.0) {
        let y = axes.y(pressure);
        lines.line([[axes.left, y], [axes.left + axes.width, y]]);
        labels.append(text(content, [axes.left - 6.0, y + 4.0]).set("text-anchor", "end"));
    }
    Group::new().add(stroke(lines, LIGHT, 0.8)).add(labels)
}

fn curve(surface: &ContactSurface, axes: &Axes) -> Group {
    let (mut area, mut line) = (Path::default(), Path::default());
    for part in &surface.parts {
        let points: Vec<Point> = part
            .iter()
            .filter(|s| axes.shows(s.arc))
            .map(|s| [axes.x(s.arc), axes.y(s.pressure)])
            .collect();
        if let [first, .., last] = points[..] {
            let points = thinned(&points);
            let ends = [[last[0], axes.bottom], [first[0], axes.bottom]];
            area.polygon(points.iter().copied().chain(ends));
            line.line(points);
        }
    }
    Group::new()
        .add(shape(area).set("fill", RED).set("fill-opacity", 0.25))
        .add(stroke(line, RED, 1.5).set("stroke-linejoin", "round"))
}

/// A dot at the peak, and its value above it.
fn mark(peak: &ContactSample, stress: &str, axes: &Axes) -> Group {
    let [x, y] = [axes.x(peak.arc), axes.y(peak.pressure)];
    let words = format!("peak {} {stress}", short(peak.pressure));
    let words = words.trim_end();
    let half = width_of(words, 13.0 / 0.85) / 2.0;
    let (left, right) = (axes.left + half + 3.0, axes.left + axes.width - half - 3.0);
    let place = [x.max(left.min(right)).min(right.max(left)), y - 8.0];
    let words = text(words, place).set("text-anchor", "middle").set("font-weight", "bold");
    let dot = Circle::new().set("cx", rounded(x)).set("cy", rounded(y)).set("r", 3);
    Group::new().set("fill", RED).add(dot).add(words)
}
