//! The contact pressure as a curve with arrows, its peak in numbers, and an axis.

use svg::node::element::Group;

use super::contact_line::ContactLine;
use super::page::{RED, ground, label, shape, short, stroke, width_of};
use super::path::{Path, Point, between, direction, distance, moved, places, thinned};
use crate::io::numbers::ticks;

/// The pressure of each surface as a filled curve, with arrows that push against the body, the largest value in numbers and
/// an axis.
pub(super) fn pressure(contact: &[ContactLine], unit: Option<&str>) -> Option<Group> {
    let mut surfaces: Vec<usize> = contact.iter().map(|line| line.surface).collect();
    surfaces.sort_unstable();
    surfaces.dedup();
    let mut group = Group::new().set("stroke-linejoin", "round");
    let mut some = false;
    for surface in surfaces {
        let lines: Vec<&ContactLine> =
            contact.iter().filter(|line| line.surface == surface).collect();
        if let Some(drawn) = pressure_of(&lines, unit) {
            group = group.add(drawn);
            some = true;
        }
    }
    some.then_some(group)
}

/// Bold letters of this size are as wide as plain ones of the next.
const PEAK_SIZE: f64 = 13.0 / 0.85;

/// How far the axis is from the end of the line.
const AXIS_OFF: f64 = 12.0;

/// How far its words are from the peak.
const PEAK_OFF: f64 = 12.0;

/// How often they are put half of that further away, where they would cover the curve.
const MOST_MOVES: i32 = 40;

fn peak_words(pressure: f64, unit: Option<&str>) -> String {
    let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
    format!("peak {}{unit}", short(pressure))
}

/// The room beside a peak that its words need, if the pressure is drawn sideways.
pub(super) fn room_beside(line: &ContactLine, unit: Option<&str>) -> f64 {
    PEAK_OFF + width_of(&peak_words(line.peak(), unit), PEAK_SIZE)
}

/// The pressure of one surface.
fn pressure_of(contact: &[&ContactLine], unit: Option<&str>) -> Option<Group> {
    let (mut area, mut curve, mut arrows) = (Path::default(), Path::default(), Path::default());
    let highest = contact
        .iter()
        .flat_map(|line| (0..line.pressure.len()).map(move |i| (*line, i)))
        .fold(None, |highest: Option<(&ContactLine, usize)>, (line, i)| match highest {
            Some((other, j)) if other.pressure[j] >= line.pressure[i] => highest,
            _ => Some((line, i)),
        })
        .filter(|(line, i)| line.pressure[*i] > 0.0);
    let (highest, at) = highest?;
    let (peak_base, peak_tip) = (highest.base[at], highest.tip[at]);
    arrow(peak_tip, peak_base, &mut arrows);
    for line in contact {
        for range in line.pressed() {
            let (base, tip) = (&line.base[range.clone()], &line.tip[range]);
            let mut border: Vec<Point> = base.first().into_iter().chain(tip).copied().collect();
            border.extend(base.last());
            let border = thinned(&border);
            area.polygon(border.iter().copied().chain(thinned(base).into_iter().rev()));
            curve.line(border);
            for (i, fraction) in places(base, 22.0) {
                let foot = between(base[i], base[i + 1], fraction);
                if distance(foot, peak_base) > 15.0 {
                    arrow(between(tip[i], tip[i + 1], fraction), foot, &mut arrows);
                }
            }
        }
    }
    let out = direction(peak_base, peak_tip).unwrap_or([0.0, 1.0]);
    let words = peak_words(highest.pressure[at], unit);
    // In a small hole the curve is on both sides of its peak, and the words are wider than the room between: they go on, past
    // the curve.
    let place = |off: f64| {
        let [x, y] = moved(peak_tip, out, off);
        [x, y + 4.0]
    };
    let free = |off: &f64| {
        let ground = ground(&words, place(*off), anchor(out), PEAK_SIZE);
        let mut steps = contact.iter().flat_map(|line| line.pressed_tips());
        !steps.any(|[a, b]| ground.meets(a, b))
    };
    let mut offs = (0..MOST_MOVES).map(|i| PEAK_OFF + f64::from(i) * PEAK_OFF / 2.0);
    let label = label(&words, place(offs.find(free).unwrap_or(PEAK_OFF)), anchor(out), PEAK_SIZE)
        .set("font-weight", "bold")
        .set("fill", RED);
    let group = Group::new()
        .add(shape(area).set("fill", RED).set("fill-opacity", 0.25))
        .add(stroke(curve, RED, 1.5))
        .add(stroke(arrows, RED, 1.3));
    let height = distance(peak_base, peak_tip);
    Some(group.add(axis(highest, at, height)).add(label))
}

/// An axis for the pressure of a surface, at the end of the line with the peak that is further from it; on a closed line,
/// where that is furthest from it.
fn axis(line: &ContactLine, at: usize, height: f64) -> Group {
    let peak = line.base[at];
    let steps = line.base.windows(2).filter_map(|pair| Some((pair, direction(pair[0], pair[1])?)));
    let steps: Vec<(&[Point], Point)> = steps.collect();
    let (first, last) = match (steps.first(), steps.last()) {
        (Some(&first), Some(&last)) => (first, last),
        _ => return Group::new(),
    };
    let further = |a: Point, b: Point| distance(a, peak) > distance(b, peak);
    let (start, end) = (first.0[0], last.0[1]);
    // Where it stands, the direction of the line there, and the direction away from the line.
    let (foot, along, aside) = if distance(start, end) < 1e-6 {
        let (pair, along) =
            steps.iter().fold(first, |a, &b| if further(b.0[0], a.0[0]) { b } else { a });
        (pair[0], along, along)
    } else if further(start, end) {
        let aside = first.1.map(|c| -c);
        (moved(start, aside, AXIS_OFF), first.1, aside)
    } else {
        (moved(end, last.1, AXIS_OFF), last.1, last.1)
    };
    // The body is on the left, on a page whose second axis points down.
    let up = [-along[1], along[0]];
    let mut marks = Path::default();
    marks.line([foot, moved(foot, up, height)]);
    let mut labels = Group::new().set("font-size", 11).set("fill", RED);
    let top = line.pressure[at];
    let mut free = f64::NEG_INFINITY;
    for (value, content) in ticks(0.0, top) {
        let place = moved(foot, up, height * value / top);
        let along = height * value / top;
        // Words need their room: across where the axis is upright, along where it lies.
        let room = if up[1].abs() > 0.5 { 14.0 } else { 8.0 + width_of(&content, 11.0) };
        if along >= free {
            free = along + room;
            marks.line([place, moved(place, aside, 4.0)]);
            let [x, y] = moved(place, aside, 9.0);
            labels = labels.add(label(&content, [x, y + 4.0], anchor(aside), 11.0));
        }
    }
    Group::new().add(stroke(marks, RED, 1.0)).add(labels)
}

/// How a text stands that is put in this direction from its place.
fn anchor(out: Point) -> &'static str {
    match out[0] {
        x if x > 0.5 => "start",
        x if x < -0.5 => "end",
        _ => "middle",
    }
}

/// An arrow, unless it would be all head.
fn arrow(from: Point, to: Point, arrows: &mut Path) {
    if let (true, Some([x, y])) = (distance(from, to) > 8.0, direction(from, to)) {
        let wing = |side: f64| moved(to, [-x - side * 0.5 * y, -y + side * 0.5 * x], 6.0);
        arrows.line([from, to]);
        arrows.line([wing(1.0), to, wing(-1.0)]);
    }
}
