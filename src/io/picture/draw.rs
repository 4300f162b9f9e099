//! Elements of the pictures: colours, letters, SVG paths, and places along a line.

use std::fmt::Write;

use svg::node::element::{Circle, Group, Path as PathElement, Rectangle, Text, Title};
use svg::{Document, Node};

use crate::io::numbers;
use crate::model::tree::Bounds;
use crate::quote;

const FONT: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";
/// The size of letters that are neither a heading nor a note.
const LETTERS: f64 = 13.0;
pub(super) const DARK: &str = "#222222";
pub(super) const GREY: &str = "#666666";
pub(super) const LIGHT: &str = "#dddddd";
pub(super) const RED: &str = "#d62728";

/// A point on the page, y downwards.
pub(super) type Point = [f64; 2];

/// A number as labels have it.
pub(super) fn short(x: f64) -> String {
    numbers::short(x, 3)
}

/// Text that XML allows, on one line.
pub(super) fn clean(text: &str) -> String {
    quote::on_page(text).replace(['\n', '\t'], " ")
}

/// A white page with a title.
pub(super) fn page([width, height]: [f64; 2], title: &str) -> Document {
    Document::new()
        .set("viewBox", (0, 0, width, height))
        .set("width", width)
        .set("height", height)
        .set("font-family", FONT)
        .set("font-size", LETTERS)
        .set("fill", DARK)
        .add(Title::new(clean(title)))
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"))
}

/// A text that starts at a point.
pub(super) fn text(content: impl Into<String>, [x, y]: Point) -> Text {
    Text::new(content).set("x", rounded(x)).set("y", rounded(y))
}

/// A text around a point, or before it: its `anchor` is "middle" or "end".
pub(super) fn anchored(anchor: &str, content: impl Into<String>, at: Point) -> Text {
    text(content, at).set("text-anchor", anchor)
}

pub(super) fn dot([x, y]: Point) -> Circle {
    Circle::new().set("cx", rounded(x)).set("cy", rounded(y)).set("r", 3)
}

/// A rectangle from its left upper corner on.
pub(super) fn rectangle([left, top]: Point, [width, height]: [f64; 2]) -> Rectangle {
    Rectangle::new()
        .set("x", rounded(left))
        .set("y", rounded(top))
        .set("width", rounded(width))
        .set("height", rounded(height))
}

/// Coordinates in hundredths, which keeps the file small and the same everywhere.
pub(super) fn rounded(x: f64) -> f64 {
    (x * 100.0).round() / 100.0 + 0.0
}

/// Appends [`rounded`] coordinates, as `{}` writes them, by whole numbers: in a picture there are many.
fn push_rounded(to: &mut String, x: f64) {
    let hundredths = (x * 100.0).round() as i64;
    let sign = if hundredths < 0 { "-" } else { "" };
    let (whole, part) = (hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100);
    // Writing to a string cannot fail. A page with a number that is not finite is refused.
    let _ = match part {
        _ if !x.is_finite() => write!(to, "{x}"),
        0 => write!(to, "{sign}{whole}"),
        _ if part % 10 == 0 => write!(to, "{sign}{whole}.{}", part / 10),
        _ => write!(to, "{sign}{whole}.{part:02}"),
    };
}

/// The width of a text, roughly: no font is at hand, and the reader's may be another.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}

/// The words of a text in lines that fit into a width at a size; a line that would be the last of `most` is cut.
pub(super) fn wrapped(text: &str, size: f64, width: f64, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width_of(&format!("{line} {word}"), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    let cut = lines.len() > most;
    lines.truncate(most);
    let last = lines.len();
    for (i, line) in lines.iter_mut().enumerate() {
        let room = (width / width_of("m", size)) as usize;
        let is_cut = cut && i + 1 == last || line.chars().count() > room;
        if is_cut {
            let kept: String = line.chars().take(room.saturating_sub(3)).collect();
            *line = kept + "...";
        }
    }
    lines
}

/// The size at which a text fits into a width, at most `size`.
pub(super) fn fitting(text: &str, size: f64, width: f64) -> f64 {
    rounded((size * width / width_of(text, size)).min(size))
}

pub(super) fn shape(path: PathData) -> PathElement {
    PathElement::new().set("d", path.d)
}

pub(super) fn stroke(path: PathData, colour: &str, width: f64) -> PathElement {
    shape(path).set("fill", "none").set("stroke", colour).set("stroke-width", width)
}

/// The pressure: an area, and the curve over it.
pub(super) fn red_area(area: PathData, curve: PathData) -> Group {
    Group::new()
        .add(shape(area).set("fill", RED).set("fill-opacity", 0.25))
        .add(stroke(curve, RED, 1.5))
}

/// The smallest and the largest of some numbers.
pub(super) fn range(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// The value that no more than a `share` of the whole lies above, of parts by their value and their size. The parts are sorted as far as
/// that takes.
pub(super) fn quantile(parts: &mut [(f64, f64)], share: f64) -> Option<f64> {
    let most = share * parts.iter().map(|part| part.1).sum::<f64>();
    let falling = |a: &(f64, f64), b: &(f64, f64)| b.0.total_cmp(&a.0);
    let mut above = 0.0;
    let mut rest = parts;
    while !rest.is_empty() {
        let next = rest.len().min(rest.len() / 32 + 64);
        rest.select_nth_unstable_by(next - 1, falling);
        let (largest, others) = rest.split_at_mut(next);
        largest.sort_unstable_by(falling);
        for (value, size) in largest {
            above += *size;
            if above > most {
                return Some(*value);
            }
        }
        rest = others;
    }
    None
}

/// An axis: the range of its values, which may fall, and the ends of that on the page.
pub(super) struct PageAxis {
    pub(super) range: [f64; 2],
    pub(super) page: [f64; 2],
}

impl PageAxis {
    /// The place of a value on the page; the middle where the range is a single value.
    pub(super) fn at(&self, value: f64) -> f64 {
        let ([low, high], [start, end]) = (self.range, self.page);
        let width = high - low;
        let part = if width.is_normal() { (value - low) / width } else { 0.5 };
        start + part * (end - start)
    }
}

/// The axes of a drawing area.
pub(super) struct Axes {
    pub(super) x: PageAxis,
    pub(super) y: PageAxis,
}

impl Axes {
    pub(super) fn at(&self, [x, y]: Point) -> Point {
        [self.x.at(x), self.y.at(y)]
    }

    /// Lines across the area at the ticks of both axes, with their labels.
    pub(super) fn grid(&self, [x_ticks, y_ticks]: [Vec<(f64, String)>; 2]) -> Group {
        // The room to the right of the area.
        const RIGHT: f64 = 12.0;
        let mut lines = PathData::default();
        let mut labels = Group::new().set("font-size", 11);
        let ([left, right], [bottom, top]) = (self.x.page, self.y.page);
        for (x, content) in x_ticks {
            let x = self.x.at(x);
            lines.line([[x, bottom], [x, top]]);
            let x = x.min(right + RIGHT - width_of(&content, 11.0) / 2.0);
            labels.append(anchored("middle", content, [x, bottom + 16.0]));
        }
        for (y, content) in y_ticks {
            let y = self.y.at(y);
            lines.line([[left, y], [right, y]]);
            labels.append(anchored("end", content, [left - 6.0, y + 4.0]));
        }
        Group::new().add(stroke(lines, LIGHT, 0.8)).add(labels)
    }

    pub(super) fn frame(&self) -> Rectangle {
        let ([left, right], [bottom, top]) = (self.x.page, self.y.page);
        let frame = rectangle([left, top], [right - left, bottom - top]);
        frame.set("fill", "none").set("stroke", GREY)
    }
}

/// The line that a legend shows before the words of an entry, from the start of these words' line on.
pub(super) const SAMPLE: [Point; 2] = [[0.0, -4.5], [30.0, -4.5]];
pub(super) const LEGEND_LINE: f64 = 24.0;

/// The entries of a legend, drawing along [`SAMPLE`] and words, one after the other on as many lines as they need; and where
/// the last of these is.
pub(super) fn legend(
    entries: Vec<(Option<Group>, &str)>,
    [start, top]: Point,
    end: f64,
) -> (Group, f64) {
    let mut group = Group::new();
    let [mut x, mut y] = [start, top];
    for (sample, words) in entries {
        let of_sample = if sample.is_some() { 38.0 } else { 0.0 };
        let width = of_sample + width_of(words, LETTERS);
        if x + width > end && x > start {
            (x, y) = (start, y + LEGEND_LINE);
        }
        if let Some(sample) = sample {
            let place = format!("translate({} {})", rounded(x), rounded(y));
            group.append(sample.set("transform", place));
        }
        group.append(text(words, [x + of_sample, y]));
        x += width + 28.0;
    }
    (group, y)
}

/// The drawing of the body on the page: the map from the plane, and the room that it takes.
pub(super) struct PageMap {
    corner: Point,
    /// The length on the page of a unit of the plane.
    pub(super) scale: f64,
    /// The point at the centre of the drawing.
    centre: Point,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// The room around the drawing, for the letters of the contact boundaries.
const AROUND: f64 = 34.0;

impl PageMap {
    /// Makes the map of a drawing in a box of the plane, its upper left corner on the page at `corner`.
    pub(super) fn around(Bounds { low, high }: Bounds, corner: Point) -> PageMap {
        let extent = [0, 1].map(|c| high[c] - low[c]);
        let room = [800.0, 520.0].map(|most| most - 2.0 * AROUND);
        let scale = (room[0] / extent[0]).min(room[1] / extent[1]);
        let scale = if scale.is_finite() { scale } else { 1.0 };
        PageMap {
            corner,
            scale,
            centre: [0, 1].map(|c| low[c] + extent[c] / 2.0),
            width: (scale * extent[0] + 2.0 * AROUND).clamp(600.0, 800.0),
            height: (scale * extent[1] + 2.0 * AROUND).clamp(260.0, 520.0),
        }
    }

    pub(super) fn page(&self, [x, y]: Point) -> Point {
        [
            self.corner[0] + self.width / 2.0 + self.scale * (x - self.centre[0]),
            self.corner[1] + self.height / 2.0 - self.scale * (y - self.centre[1]),
        ]
    }
}

/// The `d` attribute of a path, in hundredths of the page's unit.
#[derive(Clone, Debug, Default)]
pub(super) struct PathData {
    d: String,
}

impl PathData {
    pub(super) fn is_empty(&self) -> bool {
        self.d.is_empty()
    }

    /// Adds a line through these points.
    pub(super) fn line(&mut self, points: impl IntoIterator<Item = Point>) {
        let mut command = 'M';
        for [x, y] in points {
            self.d.push(command);
            push_rounded(&mut self.d, x);
            self.d.push(' ');
            push_rounded(&mut self.d, y);
            command = if command == 'M' { 'L' } else { ' ' };
        }
    }

    /// Adds a line through these points and back to the first.
    pub(super) fn polygon(&mut self, points: impl IntoIterator<Item = Point>) {
        self.line(points);
        self.d.push('Z');
    }
}

/// The points of a line without those that lie less than half a unit from the one before them; first and last stay.
/// Nobody sees the difference, and the size of the picture no longer depends on the fineness of the mesh.
pub(super) fn thinned(points: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for (i, &p) in points.iter().enumerate() {
        let near = kept.last().is_some_and(|&last| distance(last, p) < 0.5);
        if near && i + 1 < points.len() {
            continue;
        }
        if near && kept.len() > 1 {
            kept.pop();
        }
        kept.push(p);
    }
    kept
}

/// Places along a line, `spacing` apart and as far from either end: the segment and the fraction of it.
pub(super) fn places(points: &[Point], spacing: f64) -> Vec<(usize, f64)> {
    let length: f64 = points.windows(2).map(|w| distance(w[0], w[1])).sum();
    let count = (length / spacing).floor();
    let mut next = (length - (count - 1.0) * spacing) / 2.0;
    let mut start = 0.0;
    let mut places = Vec::new();
    for (i, segment) in points.windows(2).enumerate() {
        let end = start + distance(segment[0], segment[1]);
        while next < end && places.len() < count as usize {
            places.push((i, (next - start) / (end - start)));
            next += spacing;
        }
        start = end;
    }
    places
}

/// The point at a fraction of the way from `a` to `b`.
pub(super) fn between(a: Point, b: Point, fraction: f64) -> Point {
    [a[0] + fraction * (b[0] - a[0]), a[1] + fraction * (b[1] - a[1])]
}

/// `a` + `factor` `d`
pub(super) fn moved(a: Point, d: Point, factor: f64) -> Point {
    [a[0] + factor * d[0], a[1] + factor * d[1]]
}

/// |a - b|
pub(super) fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The direction from `a` to `b`, or nothing if they are the same point.
pub(super) fn direction(a: Point, b: Point) -> Option<Point> {
    let length = distance(a, b);
    (length > 0.0).then(|| [(b[0] - a[0]) / length, (b[1] - a[1]) / length])
}

/// The closed lines that the edges make up, each by its points. An edge goes on where another starts.
pub(super) fn loops(edges: &[[usize; 2]], points: usize) -> Vec<Vec<usize>> {
    let mut from: Vec<Vec<usize>> = vec![Vec::new(); points];
    for &[start, end] in edges.iter().rev() {
        from[start].push(end);
    }
    let mut loops = Vec::new();
    for &[start, _] in edges {
        let mut points = Vec::new();
        let mut at = start;
        while let Some(next) = from[at].pop() {
            points.push(at);
            at = next;
        }
        if !points.is_empty() {
            loops.push(points);
        }
    }
    loops
}

/// The colour map viridis at 0, 1/8, ..., 1: equal steps of the value look like equal steps of the colour, in print and to
/// the colour-blind.
pub(super) const VIRIDIS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];

/// The colour at `t` as SVG has it, linear between the stops; below 0 and above 1 that of the end.
pub(super) fn viridis(t: f64) -> String {
    let place = t.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let below = (place as usize).min(VIRIDIS.len() - 2);
    let part = place - below as f64;
    let mix = |c: usize| {
        let [from, to] = [VIRIDIS[below][c], VIRIDIS[below + 1][c]].map(f64::from);
        (from + part * (to - from)).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_of_paths_are_written_as_other_numbers() {
        for x in [0.0, -0.0, -0.004, 0.005, -0.01, 0.1, -3.1, 12.34, 99.999, -1234.5, 800.0] {
            let mut written = String::new();
            push_rounded(&mut written, x);
            assert_eq!(written, rounded(x).to_string(), "{x}");
        }
        let mut path = PathData::default();
        path.polygon([[1.0, -2.5], [0.004, -0.006], [123.456, -0.001], [0.1, 100.99]]);
        assert_eq!(path.d, "M1 -2.5L0 -0.01 123.46 0 0.1 100.99Z");
    }

    #[test]
    fn places_are_evenly_spaced_and_centred() {
        let line = [[0.0, 0.0], [4.0, 0.0], [4.0, 6.0]];
        assert_eq!(places(&line, 4.0), [(0, 0.75), (1, 0.5)]);
        assert_eq!(places(&line, 11.0), []);
        assert_eq!(places(&line[..1], 1.0), []);
    }

    #[test]
    fn thinning_keeps_the_ends() {
        let line: Vec<Point> = (0..=100).map(|i| [f64::from(i) * 0.1, 0.0]).collect();
        let kept = thinned(&line);
        assert_eq!(kept.len(), 21);
        assert_eq!((kept[0], kept[20]), (line[0], line[100]));
        assert_eq!(thinned(&[]), Vec::<Point>::new());
    }

    #[test]
    fn loops_use_every_edge_once() {
        // A square with a triangular hole that touches it in vertex 0.
        let edges =
            [[0, 1], [1, 2], [2, 3], [3, 0], [0, 5], [5, 4], [4, 0], [6, 7], [7, 8], [8, 6]];
        assert_eq!(loops(&edges, 9), [vec![0, 1, 2, 3, 0, 5, 4], vec![6, 7, 8]]);
    }

    #[test]
    fn the_colour_map_passes_through_its_stops_and_grows_brighter_from_end_to_end() {
        for (t, expected) in
            [(0.0, "#440154"), (1.0 / 16.0, "#461768"), (0.5, "#21918c"), (1.0, "#fde725")]
        {
            assert_eq!(viridis(t), expected);
        }
        assert_eq!([viridis(-1.0), viridis(2.0)], [viridis(0.0), viridis(1.0)]);
        let brightness =
            |[r, g, b]: [u8; 3]| 299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b);
        assert!(VIRIDIS.map(brightness).is_sorted_by(|a, b| a < b));
    }
}
