//! picture.svg: the deformed body coloured by the von Mises stress, over its undeformed outline, with the obstacle and the
//! contact pressure.
//!
//! Displacements are drawn at true scale where that can be seen, else stretched (or shrunk) by a round factor s that the
//! legend states, unless that would bend the obstacle. The gap is stretched with them: the obstacle is drawn at x + s g n for each point x of the contact line,
//! so that the body touches it exactly where u_n = g, whatever s is. Where the obstacle is far from the body it is left
//! out. The recovered contact pressure stands on the deformed contact line, on the obstacle's side. Each surface has a scale
//! of its own, with an axis and its largest value, as high as a fixed part of the body; lower where the line is hollow, so
//! that no arrow crosses another. Where two materials meet there is a line.
//!
//! Two runs draw the same picture to the bit, and it stays under 2 MB: a body of more than [`MOST_TRIANGLES`] is drawn by
//! small cells, and lines leave out what nobody can see.

mod cells;
mod path;
mod viridis;

use svg::node::element::{
    ClipPath, Definitions, Group, LinearGradient, Path as PathElement, Rectangle, Stop, Text, Title,
};
use svg::{Document, Node};

use super::data::{DataError, check_finite, check_length, check_points};
use super::numbers::{self, Round, ticks};
use cells::{Cells, area};
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
    /// The triangles by their vertices. A P2 triangle is drawn as four, cut at the midpoints of its edges.
    pub triangles: &'a [[usize; 3]],
    /// The von Mises stress in each.
    pub von_mises: &'a [f64],
    /// The unit of stress, if the case has units.
    pub unit: Option<&'a str>,
    /// The edges between triangles of different materials.
    pub interfaces: &'a [[usize; 2]],
    /// The edges of the whole boundary, from start to end, the body on their left.
    pub outline: &'a [[usize; 2]],
    /// The connected parts of the contact line, each from start to end, the body on its left. Where the pressure jumps
    /// there are two samples at one place.
    pub contact: &'a [Vec<ContactSample>],
    /// For each of these the number of its surface: parts of one surface share a scale.
    pub surfaces: &'a [usize],
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
    /// The recovered pressure, >= 0.
    pub pressure: f64,
}

/// A body of more triangles than this is drawn by cells: one by one they would make the file too large.
pub const MOST_TRIANGLES: usize = 20_000;

/// The side of such a cell.
const CELL: f64 = 2.5;

/// Up to here the mesh itself is worth seeing.
const MOST_VISIBLE_TRIANGLES: usize = 3000;

/// The digits of labels.
const DIGITS: usize = 3;

fn short(x: f64) -> String {
    numbers::short(x, DIGITS)
}

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
        .add(colour_bar(&colours, scene.unit, &frame));
    let (obstacle, pressure) = (obstacle(&contact), pressure(&contact, scene.unit));
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
        check_points("interfaces", self.interfaces.iter().flatten(), count)?;
        check_length("surfaces", self.surfaces.len(), self.contact.len())?;
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
    /// True scale if the largest displacement is between 1% and 30% of the body: one sees it, and the body keeps its
    /// shape. True scale also if it is mere rounding, or if a stretched gap would bend the obstacle: normals that turn
    /// along the contact line would pull a flat floor out of shape. Otherwise the largest round factor that keeps the
    /// displacement within 10%.
    fn of(scene: &Scene) -> Stretch {
        let largest = scene.displacement.iter().map(|&u| distance(u, [0.0; 2])).fold(0.0, f64::max);
        let part = largest / scene.size();
        let small = !(part > 0.3);
        if (0.01..=0.3).contains(&part) || !(part > 1e-12) || (small && scene.contact_turns()) {
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

impl Scene<'_> {
    /// The contact line has more than one direction.
    fn contact_turns(&self) -> bool {
        self.contact
            .iter()
            .any(|part| part.windows(2).any(|pair| distance(pair[0].normal, pair[1].normal) > 1e-6))
    }
}

/// A part of the contact line as it is drawn: for each sample the deformed point, the end of its pressure, and the point
/// of the obstacle.
struct ContactLine {
    surface: usize,
    base: Vec<Point>,
    tip: Vec<Point>,
    wall: Vec<Option<Point>>,
    pressure: Vec<f64>,
}

/// The largest pressure is drawn as high as this part of the body's size.
const HIGHEST: f64 = 0.15;

/// Of a hollow line's radius, at most so much: arrows along its normals meet at the centre.
const OF_THE_RADIUS: f64 = 0.6;

/// An obstacle further from the undeformed body than this part of the body's size is left out.
const FURTHEST: f64 = 0.2;

impl ContactLine {
    fn all(scene: &Scene, factor: f64) -> Vec<ContactLine> {
        let size = scene.size();
        let mut lines: Vec<(ContactLine, Vec<Point>)> = Vec::with_capacity(scene.contact.len());
        for (samples, &surface) in scene.contact.iter().zip(scene.surfaces) {
            let normals = smooth_normals(samples);
            let base: Vec<Point> =
                samples.iter().map(|s| moved(s.position, s.displacement, factor)).collect();
            let wall = |(s, &n): (&ContactSample, &Point)| {
                let gap = factor * s.gap;
                (gap.abs() <= FURTHEST * size).then(|| moved(s.position, n, gap))
            };
            let line = ContactLine {
                surface,
                tip: base.clone(),
                wall: samples.iter().zip(&normals).map(wall).collect(),
                pressure: samples.iter().map(|s| s.pressure).collect(),
                base,
            };
            lines.push((line, normals));
        }
        let heights: Vec<f64> = lines.iter().map(|(line, _)| height(&lines, line, size)).collect();
        for ((line, normals), height) in lines.iter_mut().zip(heights) {
            for (i, tip) in line.tip.iter_mut().enumerate() {
                *tip = moved(line.base[i], normals[i], height * line.pressure[i]);
            }
        }
        lines.into_iter().map(|(line, _)| line).collect()
    }

    fn peak(&self) -> f64 {
        self.pressure.iter().copied().fold(0.0, f64::max)
    }

    fn on(self, frame: &Frame) -> ContactLine {
        let page = |points: Vec<Point>| points.into_iter().map(|p| frame.page(p)).collect();
        ContactLine {
            surface: self.surface,
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

/// The height of a unit of pressure on the surface of a line.
fn height(lines: &[(ContactLine, Vec<Point>)], line: &ContactLine, size: f64) -> f64 {
    let (mut peak, mut highest) = (0.0_f64, HIGHEST * size);
    for (other, normals) in lines.iter().filter(|(other, _)| other.surface == line.surface) {
        peak = peak.max(other.peak());
        for (base, n) in other.base.windows(2).zip(normals.windows(2)) {
            let step = [base[1][0] - base[0][0], base[1][1] - base[0][1]];
            let turn = [n[1][0] - n[0][0], n[1][1] - n[0][1]];
            let closing = -(step[0] * turn[0] + step[1] * turn[1]);
            if closing > 0.0 {
                let radius = (step[0] * step[0] + step[1] * step[1]) / closing;
                highest = highest.min(OF_THE_RADIUS * radius);
            }
        }
    }
    if peak > 0.0 { highest / peak } else { 0.0 }
}

/// The normals, except that two samples at one place share the mean of theirs: the facets of a curved line would otherwise
/// show as steps. A true corner (more than 45 degrees) stays one.
fn smooth_normals(samples: &[ContactSample]) -> Vec<Point> {
    let mut normals: Vec<Point> = samples.iter().map(|s| s.normal).collect();
    for i in 1..samples.len() {
        let ([a, b], [c, d]) = (normals[i - 1], normals[i]);
        if samples[i - 1].position == samples[i].position && a * c + b * d > 0.7 {
            let length = (a + c).hypot(b + d);
            normals[i - 1] = [(a + c) / length, (b + d) / length];
            normals[i] = normals[i - 1];
        }
    }
    normals
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

/// The range of the von Mises stress, and where the colours end.
struct Colours {
    min: f64,
    top: f64,
    max: f64,
}

/// The part of the body's area that may lie above the colours: at a corner the stress is singular, and its value there
/// tells of the mesh, not of the body.
const ABOVE: f64 = 1.0 / 500.0;

impl Colours {
    /// The colours end below the maximum where most of them would otherwise be spent on next to nothing. A range that is
    /// mere rounding is none.
    fn of(scene: &Scene) -> Colours {
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
    let fitting = |text: &str, size: f64| rounded((size * room / width_of(text, size)).min(size));
    // Bold letters are wider.
    let [large, small] = [fitting(&title, 24.0 / 0.8) * 0.8, fitting(&subtitle, 14.0)];
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
    let mut interfaces = Path::default();
    for &[a, b] in scene.interfaces {
        interfaces.line([deformed[a], deformed[b]]);
    }
    Group::new()
        .set("stroke-linejoin", "round")
        .set("stroke-linecap", "round")
        .add(stroke(interfaces.clone(), "white", 2.4))
        .add(stroke(interfaces, DARK, 1.0))
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

/// The pressure of each surface as a filled curve, with arrows that push against the body, the largest value in numbers and
/// an axis.
fn pressure(contact: &[ContactLine], unit: Option<&str>) -> Option<Group> {
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

fn colour_bar(colours: &Colours, unit: Option<&str>, frame: &Frame) -> Group {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::{Diagonal, Mesh, Rectangle};
    use svg::node::element::tag::Type;
    use svg::parser::Event;

    /// A scene with the data that it borrows.
    struct Sample {
        title: String,
        mesh: Mesh,
        displacement: Vec<[f64; 2]>,
        von_mises: Vec<f64>,
        outline: Vec<[usize; 2]>,
        contact: Vec<Vec<ContactSample>>,
    }

    impl Sample {
        /// A block of n x n cells that comes down on the floor with its left part, and bends up on the right.
        fn block(n: usize) -> Sample {
            let rectangle =
                Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Right };
            let mesh = rectangle.mesh().unwrap();
            let lift = |x: f64| (x - 0.5).max(0.0).powi(2);
            let displacement: Vec<[f64; 2]> = mesh
                .vertices()
                .iter()
                .map(|&[x, y]| [0.05 * (1.0 - y), lift(x) * (1.0 - y)])
                .collect();
            let mut edges = mesh.edges_of("bottom").unwrap().to_vec();
            edges.sort_by_key(|&edge| mesh.ends(edge)[0]);
            let sample = |v: usize| ContactSample {
                position: mesh.vertices()[v],
                normal: [0.0, -1.0],
                displacement: displacement[v],
                gap: 0.0,
                pressure: (0.5 - mesh.vertices()[v][0]).max(0.0),
            };
            Sample {
                title: "Block".to_owned(),
                von_mises: (0..mesh.triangles().len()).map(|t| 1.0 + (t % 7) as f64).collect(),
                outline: mesh.outline().iter().map(|&edge| mesh.ends(edge)).collect(),
                contact: vec![edges.iter().flat_map(|&e| mesh.ends(e)).map(sample).collect()],
                displacement,
                mesh,
            }
        }

        fn scene(&self) -> Scene<'_> {
            Scene {
                title: &self.title,
                subtitle: "gamma0 = 0.1, kappa = 0.4",
                points: self.mesh.vertices(),
                displacement: &self.displacement,
                triangles: self.mesh.triangles(),
                von_mises: &self.von_mises,
                unit: None,
                interfaces: &[],
                outline: &self.outline,
                contact: &self.contact,
                surfaces: &[0, 0][..self.contact.len()],
            }
        }

        fn stretched(factor: f64) -> Sample {
            let mut sample = Sample::block(4);
            let scale = |u: &mut [f64; 2]| *u = u.map(|c| factor * c);
            sample.displacement.iter_mut().for_each(scale);
            sample.contact.iter_mut().flatten().for_each(|s| scale(&mut s.displacement));
            sample
        }
    }

    /// All words of the picture; every element that starts also ends, and no number is none.
    fn words(svg: &str) -> Vec<String> {
        let (mut open, mut words) = (Vec::new(), Vec::new());
        for event in svg::read(svg).unwrap() {
            match event {
                Event::Tag(name, Type::Start, _) => open.push(name.to_owned()),
                Event::Tag(name, Type::End, _) => assert_eq!(open.pop().as_deref(), Some(name)),
                Event::Text(text) => words.push(text.trim().to_owned()),
                Event::Error(error) => panic!("{error}"),
                _ => {}
            }
        }
        assert!(open.is_empty());
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        words.retain(|text| !text.is_empty());
        words
    }

    fn draw(sample: &Sample) -> String {
        picture(&sample.scene()).unwrap()
    }

    #[test]
    fn the_picture_says_what_one_sees() {
        let sample = Sample::block(4);
        let words = words(&draw(&sample));
        for expected in [
            "Block",
            "gamma0 = 0.1, kappa = 0.4",
            "von Mises stress",
            "1",
            "7",
            "peak 0.5",
            "undeformed",
            "rigid obstacle",
            "contact pressure",
            "deformation at true scale",
        ] {
            assert!(words.iter().any(|word| word == expected), "{expected}: {words:?}");
        }
    }

    #[test]
    fn units_stand_on_the_colour_bar_and_at_the_peak_and_interfaces_are_drawn() {
        let sample = Sample::block(4);
        let plain = draw(&sample);
        let edge = [[sample.mesh.triangles()[0][0], sample.mesh.triangles()[0][2]]];
        let scene = Scene { unit: Some("N/mm²"), interfaces: &edge, ..sample.scene() };
        let svg = picture(&scene).unwrap();
        let words = words(&svg);
        for expected in ["N/mm²", "peak 0.5 N/mm²", "0.2", "0.4"] {
            assert!(words.iter().any(|word| word == expected), "{expected}: {words:?}");
        }
        assert!(svg.matches("stroke-width=\"2.4\"").count() == 1 && plain != svg);
    }

    #[test]
    fn each_surface_has_its_own_scale_and_its_own_peak() {
        let mut sample = Sample::block(4);
        let mut small = sample.contact[0].clone();
        small.iter_mut().for_each(|s| s.pressure *= 1e-3);
        sample.contact.push(small);
        let lines = |surfaces: &[usize]| {
            let scene = Scene { surfaces, ..sample.scene() };
            let words = words(&picture(&scene).unwrap());
            let heights = ContactLine::all(&scene, 1.0)
                .iter()
                .map(|line| distance(line.base[0], line.tip[0]))
                .collect::<Vec<_>>();
            (heights, words.into_iter().filter(|w| w.starts_with("peak")).collect::<Vec<_>>())
        };
        let (own, peaks) = lines(&[0, 1]);
        assert!((own[0] - own[1]).abs() < 1e-12 && own[0] > 0.1, "{own:?}");
        assert_eq!(peaks, ["peak 0.5", "peak 0.0005"]);
        let (common, peaks) = lines(&[0, 0]);
        assert!(common[1] < 0.01 * common[0] && peaks == ["peak 0.5"], "{common:?} {peaks:?}");
    }

    #[test]
    fn on_a_hollow_line_the_arrows_end_before_they_meet() {
        let sample = |angle: f64| ContactSample {
            position: [0.05 * angle.cos(), 0.05 * angle.sin()],
            normal: [-angle.cos(), -angle.sin()],
            displacement: [0.0; 2],
            gap: 0.0,
            pressure: 1.0,
        };
        let mut block = Sample::block(4);
        block.contact = vec![(0..=20).rev().map(|i| sample(0.1 * f64::from(i))).collect()];
        let line = &ContactLine::all(&block.scene(), 1.0)[0];
        for tip in &line.tip {
            assert!(tip[0].hypot(tip[1]) > 0.39 * 0.05, "{tip:?}");
        }
    }

    #[test]
    fn a_block_of_two_triangles_is_drawn_where_it_should_be() {
        let svg = draw(&Sample::block(1));
        // The body is 1 x 1 and the pressure below it 0.15 high: of 492 units 427.83 are left for the body.
        for d in [
            "M539.22 549.83L539.22 122 111.39 122 111.39 549.83Z",
            "M560.61 442.87L539.22 122 111.39 122 132.78 549.83Z",
            "M132.78 549.83L560.61 442.87 539.22 122Z",
            "M132.78 549.83L539.22 122 111.39 122Z",
        ] {
            assert!(svg.contains(&format!("<path d=\"{d}\"")), "{d}: {svg}");
        }
    }

    #[test]
    fn markup_in_a_title_is_text() {
        let mut sample = Sample::block(1);
        sample.title = "a < b & \"c\" > 'd'\u{1}\n</svg>".to_owned();
        let svg = draw(&sample);
        assert!(svg.contains("a &lt; b &amp; \"c\" &gt; 'd'  &lt;/svg&gt;"));
        words(&svg);
    }

    #[test]
    fn the_same_scene_gives_the_same_picture() {
        assert_eq!(draw(&Sample::block(16)), draw(&Sample::block(16)));
    }

    #[test]
    fn a_picture_stays_below_two_megabytes() {
        for n in [100, 101, 256] {
            let mut sample = Sample::block(n);
            // Neighbours as different as can be: nothing to merge.
            for (t, value) in sample.von_mises.iter_mut().enumerate() {
                *value = (t.wrapping_mul(2_654_435_761) % 1000) as f64;
            }
            let svg = draw(&sample);
            assert!(svg.len() < 2_000_000, "{n}: {}", svg.len());
            words(&svg);
            assert_eq!(svg.contains("clip-path"), n > 100);
        }
    }

    #[test]
    fn displacements_are_stretched_by_a_round_factor_when_they_are_too_small_or_too_large() {
        // The largest displacement of the block is 0.255 of its size.
        for (factor, expected) in [
            (1.0, "deformation at true scale"),
            (0.04, "deformation at true scale"),
            (0.039, "deformation and gap × 10"),
            (1e-4, "deformation and gap × 2000"),
            (2.0, "deformation and gap × 0.1"),
            (0.0, "deformation at true scale"),
            (1e-13, "deformation at true scale"),
        ] {
            let sample = Sample::stretched(factor);
            assert_eq!(Stretch::of(&sample.scene()).text(), expected, "{factor}");
        }
    }

    #[test]
    fn the_body_touches_the_obstacle_where_u_n_is_the_gap_at_any_stretch() {
        let mut sample = Sample::block(4);
        for s in sample.contact.iter_mut().flatten() {
            (s.displacement, s.gap) = ([0.01, -0.03], 0.03);
        }
        for factor in [0.5, 1.0, 5.0] {
            let line = &ContactLine::all(&sample.scene(), factor)[0];
            for (base, wall) in line.base.iter().zip(&line.wall) {
                assert_eq!(Some(base[1]), wall.map(|wall| wall[1]));
            }
        }
    }

    #[test]
    fn an_obstacle_far_away_is_left_out() {
        let mut sample = Sample::block(4);
        sample.contact[0].iter_mut().for_each(|s| s.gap = 1.0);
        assert!(!words(&draw(&sample)).contains(&"rigid obstacle".to_owned()));
    }

    #[test]
    fn without_pressure_the_legend_says_so() {
        let mut sample = Sample::block(4);
        sample.contact[0].iter_mut().for_each(|s| s.pressure = 0.0);
        let with_zero = words(&draw(&sample));
        sample.contact.clear();
        for words in [with_zero, words(&draw(&sample))] {
            assert!(words.contains(&"no contact pressure".to_owned()));
            assert!(!words.iter().any(|word| word.starts_with("peak")));
        }
    }

    #[test]
    fn a_constant_stress_has_one_colour_even_if_rounding_has_touched_it() {
        for stress in [0.0, 3.0] {
            let mut sample = Sample::block(4);
            sample.von_mises.fill(stress);
            sample.von_mises[5] += 1e-15 * stress;
            let svg = draw(&sample);
            assert_eq!(svg.matches(&viridis::colour(64.0 / 127.0)).count(), 3, "{svg}");
            assert!(words(&svg).contains(&short(stress)));
        }
    }

    #[test]
    fn a_peak_of_stress_on_next_to_no_area_does_not_take_the_colours() {
        let mut sample = Sample::block(32);
        sample.von_mises[77] = 1000.0;
        let colours = Colours::of(&sample.scene());
        assert_eq!((colours.min, colours.top, colours.max), (1.0, 7.0, 1000.0));
        assert!(words(&draw(&sample)).contains(&"max 1000".to_owned()));
        // On a coarse mesh one triangle is not next to nothing.
        let mut sample = Sample::block(4);
        sample.von_mises[7] = 1000.0;
        assert_eq!(Colours::of(&sample.scene()).top, 1000.0);
    }

    #[test]
    fn facets_share_their_normal_and_corners_do_not() {
        let sample = |position, normal| ContactSample {
            position,
            normal,
            displacement: [0.0; 2],
            gap: 0.0,
            pressure: 0.0,
        };
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

    #[test]
    fn data_that_do_not_fit_are_refused_by_name() {
        let refused = |spoil: fn(&mut Sample)| {
            let mut sample = Sample::block(1);
            spoil(&mut sample);
            picture(&sample.scene()).unwrap_err().to_string()
        };
        let not_finite = "is NaN or infinite; expected a finite number";
        assert_eq!(
            refused(|s| s.displacement.truncate(3)),
            "displacement has 3 entries; expected 4"
        );
        assert_eq!(refused(|s| s.von_mises.push(1.0)), "von_mises has 3 entries; expected 2");
        assert_eq!(
            refused(|s| s.outline[0][1] = 9),
            "outline names point 9; expected one of the 4 points"
        );
        assert_eq!(refused(|s| s.von_mises[1] = f64::NAN), format!("von_mises[1] {not_finite}"));
        assert_eq!(
            refused(|s| s.contact[0][1].pressure = f64::INFINITY),
            format!("contact[1] {not_finite}")
        );
        let sample = Sample::block(1);
        let nothing = Scene { triangles: &[], von_mises: &[], ..sample.scene() };
        assert_eq!(
            picture(&nothing).unwrap_err().to_string(),
            "triangles has no entry; expected at least one"
        );
    }
}
