//! A panel for each contact boundary: its pressure over the arc length, the peak marked, and the shear stress of friction; below it, where there is a
//! certificate, a strip that says what is bounded and by what: the opening where the body presses, in the mean over a stretch,
//! the pressure where it is off the obstacle, and neither elsewhere.
//!
//! A boundary of which only a small part is in contact is shown around that part.

use svg::Node;
use svg::node::element::Group;

use super::contact::{RADIUS, tag};
use super::draw::{
    Axes, GREY, LIGHT, PageAxis, PathData, Point, RED, anchored, clean, dot, fitting, range,
    rectangle, red_area, short, stroke, text, thinned, width_of,
};
use super::scale::Scale;
use super::scene::{ContactSurface, Scene};
use crate::certificates::quantities::{Limit, Zone};
use crate::io::numbers::{self, ticks};
use crate::results::solution::ContactPoint;

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
pub(super) const OPEN: &str = "#1f77b4";

/// The room above the peak, for its number.
const ABOVE: f64 = 24.0;

/// Panels side by side.
const COLUMNS: usize = 2;

pub(super) fn height(scene: &Scene) -> f64 {
    HEIGHT * scene.contact.len().div_ceil(COLUMNS) as f64
}

pub(super) fn panels(scene: &Scene, scale: &Scale, corner: Point, width: f64) -> Group {
    let columns = scene.contact.len().clamp(1, COLUMNS);
    let step = (width + BETWEEN) / columns as f64;
    let mut group = Group::new();
    for (i, surface) in scene.contact.iter().enumerate() {
        let [column, row] = [i % columns, i / columns].map(|place| place as f64);
        let corner = [corner[0] + column * step, corner[1] + row * HEIGHT];
        let [top, _] = scale.pressures(surface);
        group.append(panel((surface, top), &scene.units, corner, step - BETWEEN));
        if scene.contact.len() > 1 {
            group.append(tag(i, [corner[0] + LEFT - 2.0 * RADIUS, corner[1] + 12.0]));
        }
    }
    group
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

/// Returns whether the boundary runs to the left: then its panel does, too, so that both are seen the same way round.
fn runs_left(surface: &ContactSurface) -> bool {
    let [first, last] = shown(surface);
    let mut samples = surface.parts.iter().flatten().filter(|s| (first..=last).contains(&s.arc));
    let start = samples.next().map(|s| s.place);
    let end = samples.next_back().map(|s| s.place);
    let (Some([x, y]), Some([to_x, to_y])) = (start, end) else { return false };
    x - to_x > (y - to_y).abs()
}

/// Returns whether a panel has the line of the shear stress.
pub(super) fn has_shear(scene: &Scene) -> bool {
    scene.contact.iter().any(|surface| surface.rough && surface.peak().is_some())
}

/// The panel of a boundary, whose plot ends at the pressure `top`.
fn panel(
    (surface, top): (&ContactSurface, f64),
    units: &Option<[String; 2]>,
    [x, y]: Point,
    width: f64,
) -> Group {
    let peak = surface.peak();
    let (left, bottom, width) = (x + LEFT, y + TOP + PLOT, width - LEFT - RIGHT);
    let [first, last] = shown(surface);
    let axes = Axes {
        x: PageAxis {
            range: if runs_left(surface) { [last, first] } else { [first, last] },
            page: [left, left + width],
        },
        y: PageAxis { range: [0.0, top * (PLOT / (PLOT - ABOVE))], page: [bottom, bottom - PLOT] },
    };
    let pressures = if top > 0.0 { ticks(0.0, top) } else { Vec::new() };
    let grid = axes.grid([ticks(first, last), pressures]);
    let in_brackets = |i: usize| units.as_ref().map_or(String::new(), |u| format!(" ({})", u[i]));
    let what = if surface.rough { "contact pressure, friction (blue)" } else { "contact pressure" };
    let title = clean(&format!("{}: {what}{}", surface.name, in_brackets(0)));
    let title = text(&title, [left, y + 16.0])
        .set("font-size", fitting(&title, 14.0 / 0.9, width) * 0.9)
        .set("font-weight", "bold");
    let caption = format!("arc length along the boundary{}", in_brackets(1));
    let caption = anchored("middle", caption, [left + width / 2.0, bottom + 36.0]);
    let mut group = Group::new().add(title).add(caption.set("font-size", 12)).add(grid);
    if let Some(zones) = &surface.zones {
        let units = units.as_ref().map_or(["", ""], |[stress, length]| [stress, length]);
        group = group.add(strip((zones, surface.reserved), units, &axes));
    }
    match peak {
        Some(peak) => {
            let stress = units.as_ref().map_or("", |[stress, _]| stress);
            group = group.add(curve(surface, &axes));
            if surface.rough {
                group = group.add(shear(surface, &axes));
            }
            group = group.add(axes.frame()).add(mark(peak, stress, &axes));
        }
        None => {
            let at = [left + width / 2.0, bottom - PLOT / 2.0];
            group =
                group.add(anchored("middle", "no contact", at).set("fill", GREY)).add(axes.frame());
        }
    }
    group
}

/// Draws the zones as a strip, with the bounds that its colours stand for: of each kind the largest of those that are seen.
fn strip((zones, reserved): (&[Zone], bool), [stress, length]: [&str; 2], axes: &Axes) -> Group {
    let ([left, right], [bottom, _]) = (axes.x.page, axes.y.page);
    let [low, high] = range(axes.x.range.into_iter());
    let bar = |ends: [f64; 2], fill: &str| {
        let [from, to] = range(ends.into_iter().map(|arc| axes.x.at(arc.clamp(low, high))));
        rectangle([from, bottom + 1.0], [to - from, STRIP]).set("fill", fill)
    };
    let mut group = Group::new().add(bar([low, high], LIGHT));
    let mut most = [None::<f64>; 2];
    for zone in zones.iter().filter(|zone| zone.from < high && zone.to > low) {
        let (kind, integral) = match zone.limit {
            Limit::Opening(integral) => (0, integral),
            Limit::Force(integral) => (1, integral),
            // The strip is about contact.
            Limit::Slip(_) => continue,
        };
        let mean = integral / (zone.to - zone.from);
        most[kind] = Some(most[kind].map_or(mean, |most| most.max(mean)));
        group.append(bar([zone.from, zone.to], [RED, OPEN][kind]));
    }
    let bound = |kind: usize, what: &str, unit: &str| {
        let words = |mean: f64| format!("mean {what} ≤ {} {unit}", numbers::above(mean, 2));
        most[kind].map(|mean| (words(mean).trim_end().to_owned(), [RED, OPEN][kind]))
    };
    let head = if reserved { "with a reservation:" } else { "proved:" };
    let bounds = [bound(0, "opening", length), bound(1, "pressure", stress)];
    let head = bounds.iter().any(Option::is_some).then(|| (head.to_owned(), GREY));
    let words: Vec<(String, &str)> = (head.into_iter().chain(bounds.into_iter().flatten()))
        .chain([("not known".to_owned(), GREY)])
        .collect();
    let all = words.iter().map(|(words, _)| words.as_str()).collect::<Vec<_>>().join("  ");
    let size = fitting(&all, 11.0, right - left);
    let mut left = left;
    for (words, fill) in words {
        let place = [left, bottom + 50.0];
        left += width_of(&words, size) + 1.3 * size;
        group.append(text(&words, place).set("font-size", size).set("fill", fill));
    }
    group
}

/// The points of a part that are seen, with a stress at each, on the page.
fn seen(part: &[ContactPoint], axes: &Axes, stress: fn(&ContactPoint) -> f64) -> Vec<Point> {
    let ([first, last], highest) = (range(axes.x.range.into_iter()), axes.y.range[1]);
    let shown = part.iter().filter(|s| (first..=last).contains(&s.arc));
    let points: Vec<Point> = shown.map(|s| axes.at([s.arc, stress(s).min(highest)])).collect();
    thinned(&points)
}

fn curve(surface: &ContactSurface, axes: &Axes) -> Group {
    let (mut area, mut line) = (PathData::default(), PathData::default());
    for part in &surface.parts {
        let points = seen(part, axes, |s| s.pressure);
        if let [first, .., last] = points[..] {
            let ends = [last, first].map(|p| [p[0], axes.y.page[0]]);
            area.polygon(points.iter().copied().chain(ends));
            line.line(points);
        }
    }
    red_area(area, line).set("stroke-linejoin", "round")
}

/// Draws the sizes of the shear stress as a line.
fn shear(surface: &ContactSurface, axes: &Axes) -> Group {
    let mut line = PathData::default();
    surface.parts.iter().for_each(|part| line.line(seen(part, axes, |s| s.shear)));
    Group::new().add(stroke(line, OPEN, 1.6).set("stroke-linejoin", "round"))
}

/// A dot at the peak, and its value above it.
fn mark(peak: &ContactPoint, stress: &str, axes: &Axes) -> Group {
    let capped = peak.pressure > axes.y.range[1];
    let [x, y] = axes.at([peak.arc, peak.pressure.min(axes.y.range[1])]);
    let beyond = if capped { ", beyond the plot" } else { "" };
    let words = format!("peak {} {stress}", short(peak.pressure));
    let words = format!("{}{beyond}", words.trim_end());
    let words = words.trim_end();
    let half = width_of(words, 13.0 / 0.85) / 2.0;
    let [left, right] = axes.x.page;
    let (left, right) = (left + half + 3.0, right - half - 3.0);
    let y_of_words = if capped { y + 16.0 } else { y - 8.0 };
    let place = [x.max(left.min(right)).min(right.max(left)), y_of_words];
    let words = anchored("middle", words, place).set("font-weight", "bold");
    Group::new().set("fill", RED).add(dot([x, y])).add(words)
}
