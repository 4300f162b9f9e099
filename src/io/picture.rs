//! picture.svg: the deformed body coloured by the von Mises stress, over its undeformed outline, with the obstacle and the
//! contact pressure.
//!
//! Displacements are drawn at true scale where that can be seen, else stretched (or shrunk) by a round factor s that the
//! legend states. The gap is stretched with them: the obstacle is drawn at x + s g n for each point x of the contact line,
//! so that the body touches it exactly where u_n = g, whatever s is. Where the obstacle is far from the body it is left
//! out. The contact pressure -lambda^h stands on the deformed contact line, on the obstacle's side, its largest value as
//! high as a fixed part of the body.
//!
//! Two runs draw the same picture to the bit, and it stays under 2 MB: a body of more than [`MOST_TRIANGLES`] is drawn by
//! small cells ([`cells`]), and lines leave out what nobody can see ([`path::thinned`]).

mod cells;
mod numbers;
mod path;
mod viridis;

use svg::node::element::{
    ClipPath, Definitions, Group, LinearGradient, Path as PathElement, Rectangle, Stop, Text, Title,
};
use svg::{Document, Node};

use super::data::{DataError, check_finite, check_length, check_points};
use cells::Cells;
use numbers::{Round, short, ticks};
use path::{Path, Point, between, direction, distance, loops, moved, places, thinned};

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The headline.
    pub title: &'a str,
    /// A line below it.
    pub subtitle: &'a str,
    /// The vertices of the undeformed body.
    pub points: &'a [[f64; 2]],
    /// The displacement of each.
    pub displacement: &'a [[f64; 2]],
    /// The triangles by their vertices.
    pub triangles: &'a [[usize; 3]],
    /// The von Mises stress in each.
    pub von_mises: &'a [f64],
    /// The edges of the whole boundary, from start to end, the body on their left.
    pub outline: &'a [[usize; 2]],
    /// The connected parts of the contact line, each from start to end, the body on its left. Where the pressure jumps
    /// there are two samples at one place.
    pub contact: &'a [Vec<ContactSample>],
}

/// A point of the contact line.
#[derive(Clone, Copy, Debug)]
pub struct ContactSample {
    /// The place in the undeformed body.
    pub position: [f64; 2],
    /// The unit outward normal there.
    pub normal: [f64; 2],
    /// u
    pub displacement: [f64; 2],
    /// The gap g.
    pub gap: f64,
    /// -lambda^h >= 0
    pub pressure: f64,
}

/// A body of more triangles than this is drawn by cells: one by one they would make the file too large.
pub const MOST_TRIANGLES: usize = 20_000;

/// The side of such a cell.
const CELL: f64 = 3.0;

/// Up to here the mesh itself is worth seeing.
const MOST_VISIBLE_TRIANGLES: usize = 5000;

/// Colours of the von Mises stress: more than the eye tells apart.
const LEVELS: usize = 128;

const FONT: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";
const DARK: &str = "#222222";
const GREY: &str = "#666666";
const RED: &str = "#d62728";

/// The page around the drawing.
const MARGIN: f64 = 36.0;
const HEADER: f64 = 88.0;
const FOOTER: f64 = 64.0;
const BAR: f64 = 150.0;

/// The text of the file.
///
/// # Errors
/// Lists of different lengths, vertices that don't exist, numbers that are not finite, no triangle.
pub fn picture(scene: &Scene) -> Result<String, DataError> {
    scene.check()?;
    let stretch = Stretch::of(scene);
    let deformed = scene.deformed(stretch.factor());
    let contact = ContactLine::all(scene, stretch.factor());
    let frame = Frame::around(scene, &deformed, &contact);
    let deformed: Vec<Point> = deformed.into_iter().map(|p| frame.page(p)).collect();
    let contact: Vec<ContactLine> = contact.into_iter().map(|line| line.on(&frame)).collect();
    let colours = Colours::of(scene);

    let (width, height) = (frame.width + 2.0 * MARGIN + BAR, HEADER + frame.height + FOOTER);
    let mut document = Document::new()
        .set("viewBox", (0, 0, width.round(), height.round()))
        .set("width", width.round())
        .set("height", height.round())
        .set("font-family", FONT)
        .set("font-size", 13)
        .set("fill", DARK)
        .add(Title::new(clean(scene.title)))
        .add(definitions(scene, &deformed))
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"))
        .add(headline(scene, width - 2.0 * MARGIN))
        .add(body(scene, &deformed, &colours))
        .add(outlines(scene, &deformed, &frame))
        .add(colour_bar(&colours, &frame));
    let (obstacle, pressure) = (obstacle(&contact), pressure(&contact));
    let legend = legend(&stretch, obstacle.is_some(), scene.peak(), height - 26.0);
    for group in [obstacle, pressure, Some(legend)].into_iter().flatten() {
        document = document.add(group);
    }
    Ok(format!("{document}\n"))
}

impl Scene<'_> {
    fn check(&self) -> Result<(), DataError> {
        if self.triangles.is_empty() {
            return Err(DataError::Empty { name: "triangles".to_owned() });
        }
        let count = self.points.len();
        check_length("displacement", self.displacement.len(), count)?;
        check_length("von_mises", self.von_mises.len(), self.triangles.len())?;
        check_points("triangles", self.triangles.iter().flatten(), count)?;
        check_points("outline", self.outline.iter().flatten(), count)?;
        check_finite("points", self.points.iter().map(<[f64; 2]>::as_slice))?;
        check_finite("displacement", self.displacement.iter().map(<[f64; 2]>::as_slice))?;
        check_finite("von_mises", self.von_mises.chunks(1))?;
        let numbers = |sample: &ContactSample| {
            let ContactSample { position: [x, y], normal: [n, m], displacement: [u, v], .. } =
                *sample;
            [x, y, n, m, u, v, sample.gap, sample.pressure]
        };
        let samples: Vec<[f64; 8]> = self.contact.iter().flatten().map(numbers).collect();
        check_finite("contact", samples.iter().map(<[f64; 8]>::as_slice))
    }

    /// The larger of the body's extents along x and y.
    fn size(&self) -> f64 {
        let [low, high] = bounds(self.points.iter().copied());
        (high[0] - low[0]).max(high[1] - low[1])
    }

    fn deformed(&self, factor: f64) -> Vec<Point> {
        self.points.iter().zip(self.displacement).map(|(&x, &u)| moved(x, u, factor)).collect()
    }

    fn peak(&self) -> f64 {
        self.contact.iter().flatten().map(|sample| sample.pressure).fold(0.0, f64::max)
    }
}

/// The lower left and the upper right corner of the box around some points.
fn bounds(points: impl IntoIterator<Item = Point>) -> [Point; 2] {
    let empty = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points.into_iter().fold(empty, |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}

/// By how much the displacements are stretched.
struct Stretch(Option<Round>);

impl Stretch {
    /// True scale if the largest displacement is between 2% and 30% of the body: one sees it, and the body keeps its
    /// shape. True scale also if it is mere rounding. Otherwise the largest round factor that keeps it within 10%.
    fn of(scene: &Scene) -> Stretch {
        let largest = scene.displacement.iter().map(|&u| distance(u, [0.0; 2])).fold(0.0, f64::max);
        let part = largest / scene.size();
        if (0.02..=0.3).contains(&part) || !(part > 1e-12 && part.is_finite()) {
            Stretch(None)
        } else {
            Stretch(Some(Round::below(0.1 / part)))
        }
    }

    fn factor(&self) -> f64 {
        self.0.map_or(1.0, |round| round.times(1))
    }

    fn text(&self) -> String {
        match self.0 {
            None => "deformation at true scale".to_owned(),
            Some(round) => format!("deformation and gap × {}", round.text(1)),
        }
    }
}

/// A part of the contact line as it is drawn: for each sample the deformed point, the end of its pressure, and the point
/// of the obstacle.
struct ContactLine {
    base: Vec<Point>,
    tip: Vec<Point>,
    wall: Vec<Option<Point>>,
    pressure: Vec<f64>,
}

/// The largest pressure is drawn as high as this part of the body's size.
const HIGHEST: f64 = 0.15;

/// An obstacle further from the undeformed body than this part of the body's size is left out.
const FURTHEST: f64 = 0.2;

impl ContactLine {
    fn all(scene: &Scene, factor: f64) -> Vec<ContactLine> {
        let (size, peak) = (scene.size(), scene.peak());
        let line = |samples: &Vec<ContactSample>| {
            let base = |s: &ContactSample| moved(s.position, s.displacement, factor);
            let height = |s: &ContactSample| {
                if s.pressure > 0.0 { HIGHEST * size * (s.pressure / peak) } else { 0.0 }
            };
            let wall = |s: &ContactSample| {
                let gap = factor * s.gap;
                (gap.abs() <= FURTHEST * size).then(|| moved(s.position, s.normal, gap))
            };
            ContactLine {
                base: samples.iter().map(base).collect(),
                tip: samples.iter().map(|s| moved(base(s), s.normal, height(s))).collect(),
                wall: samples.iter().map(wall).collect(),
                pressure: samples.iter().map(|s| s.pressure).collect(),
            }
        };
        scene.contact.iter().map(line).collect()
    }

    fn on(self, frame: &Frame) -> ContactLine {
        let page = |points: Vec<Point>| points.into_iter().map(|p| frame.page(p)).collect();
        ContactLine {
            base: page(self.base),
            tip: page(self.tip),
            wall: self.wall.into_iter().map(|p| p.map(|p| frame.page(p))).collect(),
            pressure: self.pressure,
        }
    }

    /// Where the pressure is positive, with the sample before and the one after.
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

/// From the plane to the page.
struct Frame {
    scale: f64,
    /// What is at the centre of the drawing.
    centre: Point,
    /// The size of the drawing on the page.
    width: f64,
    height: f64,
}

impl Frame {
    /// Around all that is drawn, with space for the words at the highest pressure.
    fn around(scene: &Scene, deformed: &[Point], contact: &[ContactLine]) -> Frame {
        let lines = contact
            .iter()
            .flat_map(|line| line.tip.iter().copied().chain(line.wall.iter().flatten().copied()));
        let [low, high] = bounds(scene.points.iter().chain(deformed).copied().chain(lines));
        let sideways = scene.contact.iter().flatten().any(|s| s.normal[0].abs() > 0.5);
        let space = [if sideways { 2.0 * 80.0 } else { 2.0 * 20.0 }, 2.0 * 34.0];
        let extent = [0, 1].map(|c| high[c] - low[c]);
        let room = [800.0 - space[0], 560.0 - space[1]];
        let scale = (room[0] / extent[0]).min(room[1] / extent[1]);
        let scale = if scale.is_finite() { scale } else { 1.0 };
        Frame {
            scale,
            centre: [0, 1].map(|c| low[c] + extent[c] / 2.0),
            width: (scale * extent[0] + space[0]).clamp(600.0, 800.0),
            height: (scale * extent[1] + space[1]).clamp(260.0, 560.0),
        }
    }

    fn page(&self, [x, y]: Point) -> Point {
        [
            MARGIN + self.width / 2.0 + self.scale * (x - self.centre[0]),
            HEADER + self.height / 2.0 - self.scale * (y - self.centre[1]),
        ]
    }
}

/// The range of the von Mises stress.
struct Colours {
    min: f64,
    max: f64,
}

impl Colours {
    /// A range that is mere rounding is none.
    fn of(scene: &Scene) -> Colours {
        let values = || scene.von_mises.iter().copied();
        let (min, max) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        if max - min > 1e-9 * max { Colours { min, max } } else { Colours { min: max, max } }
    }

    fn position(&self, value: f64) -> f64 {
        if self.max > self.min { (value - self.min) / (self.max - self.min) } else { 0.5 }
    }

    fn level(&self, value: f64) -> usize {
        (self.position(value) * LEVELS as f64).min((LEVELS - 1) as f64) as usize
    }

    fn colour(level: usize) -> String {
        viridis::colour(level as f64 / (LEVELS - 1) as f64)
    }
}

/// Text that XML allows.
fn clean(text: &str) -> String {
    let allowed = |c: char| !(c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'));
    text.chars().map(|c| if allowed(c) { c } else { ' ' }).collect()
}

fn text(content: impl Into<String>, [x, y]: Point) -> Text {
    Text::new(content).set("x", rounded(x)).set("y", rounded(y))
}

fn rounded(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}

fn shape(path: Path) -> PathElement {
    PathElement::new().set("d", path.into_d())
}

fn stroke(path: Path, colour: &str, width: f64) -> PathElement {
    shape(path).set("fill", "none").set("stroke", colour).set("stroke-width", width)
}

/// The width of a text, roughly: no font is at hand, and the reader's may be another.
fn width_of(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}

fn outline_path(scene: &Scene, points: &[Point]) -> Path {
    let mut path = Path::default();
    for vertices in loops(scene.outline, points.len()) {
        let line: Vec<Point> = vertices.into_iter().map(|v| points[v]).collect();
        path.polygon(thinned(&line));
    }
    path
}

/// The colours of the bar, and the shape of the body that the cells are cut along.
fn definitions(scene: &Scene, deformed: &[Point]) -> Definitions {
    let mut gradient = LinearGradient::new()
        .set("id", "von-mises")
        .set("x1", 0)
        .set("y1", 1)
        .set("x2", 0)
        .set("y2", 0);
    let last = viridis::STOPS.len() - 1;
    for i in 0..=last {
        let place = i as f64 / last as f64;
        gradient = gradient
            .add(Stop::new().set("offset", place).set("stop-color", viridis::colour(place)));
    }
    let definitions = Definitions::new().add(gradient);
    if scene.triangles.len() <= MOST_TRIANGLES {
        return definitions;
    }
    definitions.add(ClipPath::new().set("id", "body").add(shape(outline_path(scene, deformed))))
}

fn headline(scene: &Scene, room: f64) -> Group {
    let (title, subtitle) = (clean(scene.title), clean(scene.subtitle));
    let fitting = |text: &str, size: f64| (size * room / width_of(text, size)).min(size).round();
    let [large, small] = [fitting(&title, 24.0), fitting(&subtitle, 14.0)];
    Group::new()
        .add(text(title, [MARGIN, 44.0]).set("font-size", large).set("font-weight", "bold"))
        .add(text(subtitle, [MARGIN, 68.0]).set("font-size", small).set("fill", GREY))
}

/// The triangles, or cells instead of them, one path for each colour. A stroke of the same colour closes the hairlines
/// between neighbours.
fn body(scene: &Scene, deformed: &[Point], colours: &Colours) -> Group {
    let triangles: Vec<[Point; 3]> =
        scene.triangles.iter().map(|vertices| vertices.map(|v| deformed[v])).collect();
    let mut levels = vec![Path::default(); LEVELS];
    let by_cells = triangles.len() > MOST_TRIANGLES;
    if by_cells {
        let cells = Cells::new(CELL, &triangles, scene.von_mises);
        for (level, corners) in cells.rectangles(|value| colours.level(value)) {
            levels[level].polygon(corners);
        }
    } else {
        for (&corners, &value) in triangles.iter().zip(scene.von_mises) {
            levels[colours.level(value)].polygon(corners);
        }
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
        let mut mesh = Path::default();
        triangles.into_iter().for_each(|corners| mesh.polygon(corners));
        group = group.add(stroke(mesh, "white", 0.5).set("stroke-opacity", 0.35));
    }
    group
}

fn outlines(scene: &Scene, deformed: &[Point], frame: &Frame) -> Group {
    let before: Vec<Point> = scene.points.iter().map(|&p| frame.page(p)).collect();
    Group::new()
        .set("stroke-linejoin", "round")
        .add(stroke(outline_path(scene, deformed), DARK, 1.2))
        .add(stroke(outline_path(scene, &before), GREY, 1.2).set("stroke-dasharray", "6 4"))
}

/// The obstacle's border, hatched on its side.
fn obstacle(contact: &[ContactLine]) -> Option<Group> {
    let (mut border, mut hatching) = (Path::default(), Path::default());
    for line in contact {
        for run in line.wall.chunk_by(|a, b| a.is_some() == b.is_some()) {
            let run: Vec<Point> = run.iter().flatten().copied().collect();
            let run = thinned(&run);
            if run.len() > 1 {
                hatch(&run, &mut hatching);
                border.line(run);
            }
        }
    }
    (!border.is_empty())
        .then(|| Group::new().add(stroke(hatching, GREY, 0.9)).add(stroke(border, DARK, 1.6)))
}

fn hatch(border: &[Point], hatching: &mut Path) {
    for (i, fraction) in places(border, 8.0) {
        let (a, b) = (border[i], border[i + 1]);
        if let Some([x, y]) = direction(a, b) {
            // The body is on the left, so the obstacle is on the right.
            let foot = between(a, b, fraction);
            hatching.line([foot, moved(foot, [-y - 0.8 * x, x - 0.8 * y], 10.0)]);
        }
    }
}

/// The pressure as a filled curve, with arrows that push against the body and the largest value in numbers.
fn pressure(contact: &[ContactLine]) -> Option<Group> {
    let (mut area, mut curve, mut arrows) = (Path::default(), Path::default(), Path::default());
    let highest = contact
        .iter()
        .flat_map(|line| (0..line.pressure.len()).map(move |i| (line, i)))
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
    let anchor = match out[0] {
        x if x > 0.5 => "start",
        x if x < -0.5 => "end",
        _ => "middle",
    };
    let [x, y] = moved(peak_tip, out, 12.0);
    let label = text(format!("peak {}", short(highest.pressure[at])), [x, y + 4.0])
        .set("text-anchor", anchor)
        .set("font-weight", "bold")
        .set("fill", RED)
        .set("stroke", "white")
        .set("stroke-width", 3)
        .set("paint-order", "stroke");
    Some(
        Group::new()
            .set("stroke-linejoin", "round")
            .add(shape(area).set("fill", RED).set("fill-opacity", 0.25))
            .add(stroke(curve, RED, 1.5))
            .add(stroke(arrows, RED, 1.3))
            .add(label),
    )
}

/// An arrow, unless it would be all head.
fn arrow(from: Point, to: Point, arrows: &mut Path) {
    if let (true, Some([x, y])) = (distance(from, to) > 8.0, direction(from, to)) {
        let wing = |side: f64| moved(to, [-x - side * 0.5 * y, -y + side * 0.5 * x], 6.0);
        arrows.line([from, to]);
        arrows.line([wing(1.0), to, wing(-1.0)]);
    }
}

fn colour_bar(colours: &Colours, frame: &Frame) -> Group {
    let (left, top) = (MARGIN + frame.width + 20.0, HEADER + 30.0);
    let height = frame.height - 40.0;
    let bar = Rectangle::new()
        .set("x", rounded(left))
        .set("y", rounded(top))
        .set("width", 18)
        .set("height", rounded(height));
    let heading = text("von Mises stress", [left, HEADER + 12.0]);
    let label = |at: f64, content: String| text(content, [left + 28.0, at + 4.5]);
    let group = Group::new().add(heading);
    if colours.max <= colours.min {
        let fill = Colours::colour(colours.level(colours.max));
        return group.add(bar.set("fill", fill)).add(label(top + height / 2.0, short(colours.max)));
    }
    let at = |value: f64| top + height * (1.0 - colours.position(value));
    let mut marks = Path::default();
    let mut labels = Group::new();
    for value in [colours.min, colours.max] {
        marks.line([[left + 18.0, at(value)], [left + 25.0, at(value)]]);
        labels = labels.add(label(at(value), short(value)).set("font-weight", "bold"));
    }
    for (value, content) in ticks(colours.min, colours.max) {
        let y = at(value);
        if (y - top).min(top + height - y) >= 16.0 {
            marks.line([[left + 18.0, y], [left + 23.0, y]]);
            labels = labels.add(label(y, content));
        }
    }
    group.add(bar.set("fill", "url(#von-mises)")).add(stroke(marks, DARK, 1.0)).add(labels)
}

fn legend(stretch: &Stretch, with_obstacle: bool, peak: f64, y: f64) -> Group {
    let mut legend = Legend { group: Group::new(), place: [MARGIN, y] };
    legend.entry("undeformed", |line, _| {
        Group::new().add(stroke(line, GREY, 1.2).set("stroke-dasharray", "6 4"))
    });
    if with_obstacle {
        legend.entry("rigid obstacle", |line, ends| {
            let mut hatching = Path::default();
            hatch(&ends.map(|[x, y]| [x, y - 3.0]), &mut hatching);
            Group::new()
                .set("transform", "translate(0 -3)")
                .add(stroke(hatching, GREY, 0.9))
                .add(stroke(line, DARK, 1.6))
        });
    }
    if peak > 0.0 {
        legend.entry("contact pressure", |line, [[x0, y0], [x1, y1]]| {
            let mut area = Path::default();
            area.polygon([[x0, y0 - 5.0], [x1, y1 - 5.0], [x1, y1 + 5.0], [x0, y0 + 5.0]]);
            Group::new()
                .add(shape(area).set("fill", RED).set("fill-opacity", 0.25))
                .add(stroke(line, RED, 1.5).set("transform", "translate(0 5)"))
        });
    } else {
        legend.words("no contact pressure");
    }
    legend.words(&stretch.text());
    legend.group
}

/// Entries of the legend, one after the other.
struct Legend {
    group: Group,
    /// Of the next entry.
    place: Point,
}

impl Legend {
    /// What it means in words, and the mark: drawn with a short line, of which the ends are given too.
    fn entry(&mut self, words: &str, mark: impl FnOnce(Path, [Point; 2]) -> Group) {
        let [x, y] = self.place;
        let ends = [[x, y - 4.5], [x + 30.0, y - 4.5]];
        let mut line = Path::default();
        line.line(ends);
        self.group.append(mark(line, ends));
        self.place[0] += 38.0;
        self.words(words);
    }

    fn words(&mut self, words: &str) {
        self.group.append(text(words, self.place));
        self.place[0] += width_of(words, 13.0) + 28.0;
    }
}
