//! The contact pressure as a curve with arrows, its peak in numbers, and an axis.

use svg::node::element::Group;

use super::contact_line::ContactLine;
use super::page::{RED, shape, short, stroke, text, width_of};
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
    let [x, y] = moved(peak_tip, out, 12.0);
    let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
    let label = text(format!("peak {}{unit}", short(highest.pressure[at])), [x, y + 4.0])
        .set("text-anchor", anchor(out))
        .set("font-weight", "bold")
        .set("fill", RED);
    let group = Group::new()
        .add(shape(area).set("fill", RED).set("fill-opacity", 0.25))
        .add(stroke(curve, RED, 1.5))
        .add(stroke(arrows, RED, 1.3));
    let height = distance(peak_base, peak_tip);
    Some(group.add(axis(highest, at, height)).add(label))
}

/// An axis for the pressure of a surface, at the end of the line with the peak that is further from it.
fn axis(line: &ContactLine, at: usize, height: f64) -> Group {
    let last = line.base.len() - 1;
    let [first, end] = [line.base[0], line.base[last]];
    let peak = line.base[at];
    let (foot, inner) = if distance(first, peak) > distance(end, peak) {
        (first, line.base[1.min(last)])
    } else {
        (end, line.base[last.saturating_sub(1)])
    };
    // Away from the line, and up along it.
    let aside = direction(inner, foot).unwrap_or([1.0, 0.0]);
    let out = direction(peak, line.tip[at]).unwrap_or([0.0, 1.0]);
    let turned = [-aside[1], aside[0]];
    let up =
        if turned[0] * out[0] + turned[1] * out[1] < 0.0 { turned.map(|c| -c) } else { turned };
    let foot = moved(foot, aside, 12.0);
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
            labels = labels.add(text(content, [x, y + 4.0]).set("text-anchor", anchor(aside)));
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
