//! The contact boundaries on the body: the pressure as a curve with arrows, the obstacle with its hatching, and a letter for
//! each where there are several.

use svg::Node;
use svg::node::element::{Circle, Group};

use super::draw::{
    DARK, GREY, PageMap, PathData, Point, RED, anchored, between, direction, distance, moved,
    places, red_area, stroke, thinned,
};
use super::scale::Scale;
use super::scene::Scene;
use crate::results::solution::ContactPoint;

/// A connected part of a contact boundary as it is drawn: for each sample the deformed point, the end of its pressure, and
/// the point of the obstacle.
#[derive(Clone, Debug)]
pub(super) struct ContactLine {
    /// The place of its boundary among all.
    pub(super) surface: usize,
    pub(super) base: Vec<Point>,
    pub(super) tip: Vec<Point>,
    pub(super) wall: Vec<Option<Point>>,
    pressure: Vec<f64>,
}

/// The largest pressure of a boundary is drawn as high as this part of the body's size.
const HIGHEST: f64 = 0.15;

/// The longest arrow, in parts of a hollow line's radius: arrows along its normals meet at the centre.
const OF_THE_RADIUS: f64 = 0.6;

/// An obstacle whose magnified gap is more than this part of the body's size is left out.
const FURTHEST: f64 = 0.2;

/// An obstacle along a line that is not straight, which magnifying the gap bends, is left out beyond this part.
pub(super) const FURTHEST_WHERE_BENT: f64 = 0.06;

impl ContactLine {
    /// All parts of the contact boundaries, in the plane.
    pub(super) fn all(scene: &Scene, scale: &Scale) -> Vec<ContactLine> {
        let factor = scale.factor;
        let size = scene.size();
        let base = |s: &ContactPoint| moved(s.place, s.displacement, factor);
        let mut lines = Vec::new();
        for (surface, boundary) in scene.contact.iter().enumerate() {
            let parts: Vec<(&[ContactPoint], Vec<Point>)> = boundary
                .parts
                .iter()
                .map(|samples| (&samples[..], smooth_normals(samples)))
                .collect();
            let mut highest = HIGHEST * size;
            for (samples, normals) in &parts {
                for (pair, n) in samples.windows(2).zip(normals.windows(2)) {
                    let step = moved(base(&pair[1]), base(&pair[0]), -1.0);
                    let turn = moved(n[1], n[0], -1.0);
                    let closing = -(step[0] * turn[0] + step[1] * turn[1]);
                    if closing > 0.0 {
                        let radius = (step[0] * step[0] + step[1] * step[1]) / closing;
                        highest = highest.min(OF_THE_RADIUS * radius);
                    }
                }
            }
            // The height of a unit of pressure.
            let [_, peak] = scale.pressures(boundary);
            let height = if peak > 0.0 { highest / peak } else { 0.0 };
            for (samples, normals) in parts {
                let turns = turns(samples);
                let bent = factor != 1.0 && turns;
                let furthest = size * if bent { FURTHEST_WHERE_BENT } else { FURTHEST };
                // An obstacle with a shape of its own keeps shape and place.
                let factor = if turns && boundary.rigid { 1.0 } else { factor };
                let wall = |(s, &n): (&ContactPoint, &Point)| {
                    let gap = factor * s.gap;
                    (gap.abs() <= furthest).then(|| moved(s.place, n, gap))
                };
                let tip = |(s, &n): (&ContactPoint, &Point)| moved(base(s), n, height * s.pressure);
                let with_normals = || samples.iter().zip(&normals);
                lines.push(ContactLine {
                    surface,
                    base: samples.iter().map(base).collect(),
                    tip: with_normals().map(tip).collect(),
                    wall: with_normals().map(wall).collect(),
                    pressure: samples.iter().map(|s| s.pressure).collect(),
                });
            }
        }
        lines
    }

    /// Moves the points of the line onto the page.
    pub(super) fn on(self, frame: &PageMap) -> ContactLine {
        let all = |points: Vec<Point>| points.into_iter().map(|p| frame.page(p)).collect();
        ContactLine {
            base: all(self.base),
            tip: all(self.tip),
            wall: self.wall.into_iter().map(|p| p.map(|p| frame.page(p))).collect(),
            ..self
        }
    }

    /// The ranges of samples where the pressure is positive, with the sample before and the one after.
    fn pressed(&self) -> Vec<std::ops::RangeInclusive<usize>> {
        let mut ranges = Vec::new();
        let mut start = 0;
        for run in self.pressure.chunk_by(|&a, &b| (a > 0.0) == (b > 0.0)) {
            let end = start + run.len();
            if run.first().is_some_and(|&pressure| pressure > 0.0) {
                ranges.push(start.saturating_sub(1)..=end.min(self.pressure.len() - 1));
            }
            start = end;
        }
        ranges
    }
}

/// The line is no straight one with one direction.
pub(super) fn turns(samples: &[ContactPoint]) -> bool {
    let step = |pair: &[ContactPoint]| direction(pair[0].place, pair[1].place);
    let first = samples.windows(2).find_map(step);
    let differs = |a: Point, b: Point| distance(a, b) > 1e-6;
    samples.windows(2).any(|pair| {
        let along = step(pair).zip(first).is_some_and(|(a, b)| differs(a, b));
        along || differs(pair[0].direction, pair[1].direction)
    })
}

/// The normals, except that two samples at one place share the mean of theirs: the facets of a curved line would otherwise
/// show as steps. A true corner (more than 45 degrees) stays one.
fn smooth_normals(samples: &[ContactPoint]) -> Vec<Point> {
    let mut normals: Vec<Point> = samples.iter().map(|s| s.direction).collect();
    for i in 1..samples.len() {
        let ([a, b], [c, d]) = (normals[i - 1], normals[i]);
        if samples[i - 1].place == samples[i].place && a * c + b * d > 0.7 {
            let length = (a + c).hypot(b + d);
            normals[i - 1] = [(a + c) / length, (b + d) / length];
            normals[i] = normals[i - 1];
        }
    }
    normals
}

/// The pressure as a filled curve, with arrows that push against the body.
pub(super) fn pressure(contact: &[ContactLine]) -> Option<Group> {
    let (mut area, mut curve, mut arrows) =
        (PathData::default(), PathData::default(), PathData::default());
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
                arrow(between(tip[i], tip[i + 1], fraction), foot, &mut arrows);
            }
        }
    }
    (!curve.is_empty()).then(|| {
        red_area(area, curve).set("stroke-linejoin", "round").add(stroke(arrows, RED, 1.3))
    })
}

/// An arrow, unless it would be all head.
pub(super) fn arrow(from: Point, to: Point, arrows: &mut PathData) {
    if let (true, Some([x, y])) = (distance(from, to) > 8.0, direction(from, to)) {
        let wing = |side: f64| moved(to, [-x - side * 0.5 * y, -y + side * 0.5 * x], 6.0);
        arrows.line([from, to]);
        arrows.line([wing(1.0), to, wing(-1.0)]);
    }
}

/// The obstacle's border, hatched on its side.
pub(super) fn obstacle(contact: &[ContactLine]) -> Option<Group> {
    let runs =
        contact.iter().flat_map(|line| line.wall.chunk_by(|a, b| a.is_some() == b.is_some()));
    hatched(runs.map(|run| run.iter().flatten().copied().collect()))
}

/// Lines hatched on their right, unless there is none.
pub(super) fn hatched(lines: impl IntoIterator<Item = Vec<Point>>) -> Option<Group> {
    let (mut border, mut hatching) = (PathData::default(), PathData::default());
    for line in lines.into_iter().map(|line| thinned(&line)).filter(|line| line.len() > 1) {
        hatch(&line, &mut hatching);
        border.line(line);
    }
    (!border.is_empty())
        .then(|| Group::new().add(stroke(hatching, GREY, 0.9)).add(stroke(border, DARK, 1.6)))
}

fn hatch(border: &[Point], hatching: &mut PathData) {
    for (i, fraction) in places(border, 8.0) {
        let (a, b) = (border[i], border[i + 1]);
        if let Some([x, y]) = direction(a, b) {
            // The body is on the left, so the obstacle is on the right.
            let foot = between(a, b, fraction);
            hatching.line([foot, moved(foot, [-y - 0.8 * x, x - 0.8 * y], 10.0)]);
        }
    }
}

/// The letter of a contact boundary: the same at its panel.
fn letter(surface: usize) -> String {
    match u8::try_from(surface) {
        Ok(i @ 0..26) => char::from(b'A' + i).to_string(),
        _ => (surface + 1).to_string(),
    }
}

pub(super) const RADIUS: f64 = 9.0;

pub(super) fn tag(surface: usize, [x, y]: Point) -> Group {
    let circle = Circle::new().set("cx", x.round()).set("cy", y.round()).set("r", RADIUS);
    let letter = anchored("middle", letter(surface), [x.round(), y.round() + 4.0]);
    Group::new()
        .add(circle.set("fill", "white").set("stroke", RED))
        .add(letter.set("font-size", 12).set("fill", RED))
}

/// A letter at each contact boundary, off the highest pressure (or the middle) of its longest part and away from the body.
pub(super) fn tags(contact: &[ContactLine], count: usize) -> Group {
    let mut group = Group::new();
    for surface in 0..count {
        let lines = contact.iter().filter(|line| line.surface == surface);
        let Some(line) = lines.max_by_key(|line| line.base.len()) else { continue };
        let highest =
            (0..line.pressure.len()).max_by(|&i, &j| line.pressure[i].total_cmp(&line.pressure[j]));
        let pressed = highest.filter(|&i| line.pressure[i] > 0.0);
        let i = pressed.unwrap_or(line.base.len() / 2);
        let Some(&base) = line.base.get(i) else { continue };
        // The body is on the left of the line, on a page whose second axis points down.
        let ends = [line.base[i.saturating_sub(1)], line.base[(i + 1).min(line.base.len() - 1)]];
        let [x, y] = direction(ends[0], ends[1]).unwrap_or([1.0, 0.0]);
        let out = direction(base, line.tip[i]).unwrap_or([-y, x]);
        group.append(tag(surface, moved(line.tip[i], out, RADIUS + 6.0)));
    }
    group
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_share_their_normal_and_corners_do_not() {
        let sample =
            |place, direction| ContactPoint { place, direction, ..ContactPoint::default() };
        let line = [
            sample([0.0, 0.0], [0.6, -0.8]),
            sample([0.0, 0.0], [0.8, -0.6]),
            sample([1.0, 0.0], [0.8, -0.6]),
            sample([1.0, 0.0], [0.6, 0.8]),
        ];
        let [a, b, c, d] = smooth_normals(&line).try_into().unwrap();
        assert_eq!(a, b);
        assert!((a[0] + a[1]).abs() < 1e-15 && (a[0].hypot(a[1]) - 1.0).abs() < 1e-15);
        assert_eq!([c, d], [[0.8, -0.6], [0.6, 0.8]]);
    }
}
