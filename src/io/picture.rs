//! picture.svg: the deformed body coloured by the von Mises stress, over its undeformed outline, with the obstacle and the
//! contact pressure; and below it a panel for each contact boundary with its pressure over the arc length.
//!
//! Displacements are drawn at true scale where that can be seen, else magnified (or reduced) by a factor s that the legend
//! states. The gap is magnified with them: the obstacle is drawn at x + s g n for each point x of the contact boundary, so
//! that the body touches it exactly where u_n = g, whatever s is. Where the obstacle is far from the body it is left out.
//! The recovered contact pressure stands on the deformed contact boundary, on the obstacle's side; its numbers are in the
//! panels, so that no word covers the body. Where two materials meet there is a line.
//!
//! Two runs draw the same picture to the bit, and it stays under 2 MB: a body of more than 20,000 triangles is drawn by
//! small cells, and lines leave out what nobody can see.

mod body;
mod case;
mod cells;
mod contact;
mod draw;
mod panel;
pub mod plot;
mod scene;

use svg::node::element::{Group, Rectangle, Title};
use svg::{Document, Node};

use super::finite::{NotFinite, check_finite};
use body::{BAR, Colours, body, colour_bar, definitions, outlines};
use contact::{ContactLine, hatch, obstacle, pressure, tags};
use draw::{DARK, FONT, GREY, PathData, Point, RED, clean, fitting, shape, stroke, text, width_of};
use scene::PageMap;

pub use case::draw;
pub use scene::{ContactSample, ContactSurface, Scene};

/// The page around the drawing.
const MARGIN: f64 = 36.0;
const HEADER: f64 = 88.0;
const GAP: f64 = 20.0;
const LEGEND_LINE: f64 = 24.0;

/// The text of the file.
///
/// # Errors
/// Numbers that are not finite, or not on a page.
pub fn picture(scene: &Scene) -> Result<String, NotFinite> {
    let (factor, magnification) = scene.magnification();
    let deformed = scene.deformed(factor);
    check_finite("deformed points", deformed.iter().map(Point::as_slice))?;
    let lines = ContactLine::all(scene, factor);
    let drawn = scene.points.iter().chain(&deformed).copied();
    let around = lines.iter().flat_map(|line| line.tip.iter().chain(line.wall.iter().flatten()));
    let frame = PageMap::around(drawn.chain(around.copied()), [MARGIN, HEADER]);
    check_finite("page", [frame.page([0.0; 2]).as_slice(), &[frame.width, frame.height]])?;
    let deformed: Vec<Point> = deformed.into_iter().map(|p| frame.page(p)).collect();
    let lines: Vec<ContactLine> = lines.into_iter().map(|line| line.on(&frame)).collect();
    let colours = Colours::of(scene);
    let (pressure, obstacle) = (pressure(&lines), obstacle(&lines));

    let width = frame.width + GAP + BAR;
    let below = HEADER + frame.height;
    let mut legend = Legend::new([MARGIN, below + 30.0], MARGIN + width);
    legend.explain(!scene.interfaces.is_empty(), obstacle.is_some(), pressure.is_some());
    legend.words(&magnification);
    let panels_at = legend.place[1] + LEGEND_LINE;
    let height = panels_at + panel::height(scene);
    let page = [width + 2.0 * MARGIN, height].map(f64::round);

    let unit = scene.units.map(|[stress, _]| stress);
    let bar = colour_bar(&colours, unit, [MARGIN + frame.width + GAP, HEADER], frame.height);
    let mut document = Document::new()
        .set("viewBox", (0, 0, page[0], page[1]))
        .set("width", page[0])
        .set("height", page[1])
        .set("font-family", FONT)
        .set("font-size", 13)
        .set("fill", DARK)
        .add(Title::new(clean(scene.title)))
        .add(definitions(scene, &deformed))
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"))
        .add(headline(scene, width))
        .add(body(scene, &deformed, &colours))
        .add(outlines(scene, &deformed, &frame))
        .add(bar);
    [obstacle, pressure].into_iter().flatten().for_each(|group| document.append(group));
    if scene.contact.len() > 1 {
        let outline: Vec<[Point; 2]> =
            scene.outline.iter().map(|edge| edge.map(|vertex| deformed[vertex])).collect();
        document.append(tags(&lines, scene.contact.len(), &outline, &frame));
    }
    document.append(legend.group);
    document.append(panel::panels(scene, [MARGIN, panels_at], width));
    check_numbers(&document)?;
    Ok(format!("{document}\n"))
}

/// Finite data may be drawn beyond the range of doubles, as where displacements are magnified.
fn check_numbers(node: &dyn Node) -> Result<(), NotFinite> {
    for (name, value) in node.get_attributes().into_iter().flatten() {
        if value.contains("NaN") || value.contains("inf") {
            return Err(NotFinite { place: format!("{name} of <{}>", node.get_name()) });
        }
    }
    node.get_children().into_iter().flatten().try_for_each(|child| check_numbers(&**child))
}

fn headline(scene: &Scene, room: f64) -> Group {
    let (title, subtitle) = (clean(scene.title), clean(scene.subtitle));
    // Bold letters are wider.
    let large = fitting(&title, 24.0 / 0.8, room) * 0.8;
    let small = fitting(&subtitle, 14.0, room);
    Group::new()
        .add(text(title, [MARGIN, 44.0]).set("font-size", large).set("font-weight", "bold"))
        .add(text(subtitle, [MARGIN, 68.0]).set("font-size", small).set("fill", GREY))
}

/// The legend: entries one after the other, on as many lines as they need.
struct Legend {
    group: Group,
    /// The place of the next entry, and the start and the end of a line.
    place: Point,
    line: [f64; 2],
}

impl Legend {
    fn new(place: Point, end: f64) -> Legend {
        Legend { group: Group::new(), place, line: [place[0], end] }
    }

    fn explain(&mut self, interfaces: bool, obstacle: bool, pressure: bool) {
        self.entry("undeformed", |line, _| {
            Group::new().add(stroke(line, GREY, 1.2).set("stroke-dasharray", "6 4"))
        });
        if interfaces {
            self.entry("border of two materials", |line, _| {
                Group::new().add(stroke(line, DARK, 1.0))
            });
        }
        if obstacle {
            self.entry("rigid obstacle", |line, ends| {
                let mut hatching = PathData::default();
                hatch(&ends.map(|[x, y]| [x, y - 3.0]), &mut hatching);
                Group::new()
                    .set("transform", "translate(0 -3)")
                    .add(stroke(hatching, GREY, 0.9))
                    .add(stroke(line, DARK, 1.6))
            });
        }
        if pressure {
            self.entry("contact pressure", |line, [[x0, y0], [x1, y1]]| {
                let mut area = PathData::default();
                area.polygon([[x0, y0 - 5.0], [x1, y1 - 5.0], [x1, y1 + 5.0], [x0, y0 + 5.0]]);
                Group::new()
                    .add(shape(area).set("fill", RED).set("fill-opacity", 0.25))
                    .add(stroke(line, RED, 1.5).set("transform", "translate(0 5)"))
            });
        } else {
            self.words("no contact pressure");
        }
    }

    /// Words, and before them their mark: drawn with a short line, of which the ends are given too.
    fn entry(&mut self, words: &str, mark: impl FnOnce(PathData, [Point; 2]) -> Group) {
        self.make_room(38.0 + width_of(words, 13.0));
        let [x, y] = self.place;
        let ends = [[x, y - 4.5], [x + 30.0, y - 4.5]];
        let mut line = PathData::default();
        line.line(ends);
        self.group.append(mark(line, ends));
        self.place[0] += 38.0;
        self.words(words);
    }

    fn words(&mut self, words: &str) {
        let width = width_of(words, 13.0);
        self.make_room(width);
        self.group.append(text(words, self.place));
        self.place[0] += width + 28.0;
    }

    /// Goes on to the next line where this one has less room than that.
    fn make_room(&mut self, width: f64) {
        if self.place[0] + width > self.line[1] && self.place[0] > self.line[0] {
            self.place = [self.line[0], self.place[1] + LEGEND_LINE];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::draw::{distance, short, viridis};
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
        contact: Vec<ContactSurface>,
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
                arc: mesh.vertices()[v][0],
                position: mesh.vertices()[v],
                normal: [0.0, -1.0],
                displacement: displacement[v],
                gap: 0.0,
                pressure: (0.5 - mesh.vertices()[v][0]).max(0.0),
            };
            let part = edges.iter().flat_map(|&e| mesh.ends(e)).map(sample).collect();
            Sample {
                title: "Block".to_owned(),
                von_mises: (0..mesh.triangles().len()).map(|t| 1.0 + (t % 7) as f64).collect(),
                outline: mesh.outline().iter().map(|&edge| mesh.ends(edge)).collect(),
                contact: vec![ContactSurface {
                    name: "floor".to_owned(),
                    parts: vec![part],
                    zones: None,
                }],
                displacement,
                mesh,
            }
        }

        /// The block with contact along a part of a circle: from angle to angle, of that radius, with the pressure there.
        fn hole(from: f64, to: f64, radius: f64, pressure: fn(f64) -> f64) -> Sample {
            let sample = |i: i32| {
                let angle = from + (to - from) * f64::from(i) / 24.0;
                let (sin, cos) = angle.sin_cos();
                ContactSample {
                    arc: radius * (angle - from).abs(),
                    position: [0.5 + radius * cos, 0.5 + radius * sin],
                    normal: [-cos, -sin],
                    displacement: [0.0; 2],
                    gap: 0.0,
                    pressure: pressure(angle),
                }
            };
            let mut block = Sample::block(4);
            block.contact[0].parts = vec![(0..=24).map(sample).collect()];
            block
        }

        fn scene(&self) -> Scene<'_> {
            Scene {
                title: &self.title,
                subtitle: "linear triangles",
                points: self.mesh.vertices(),
                displacement: &self.displacement,
                triangles: self.mesh.triangles(),
                von_mises: &self.von_mises,
                units: None,
                stretch: None,
                interfaces: &[],
                outline: &self.outline,
                contact: &self.contact,
            }
        }

        fn samples(&mut self) -> impl Iterator<Item = &mut ContactSample> {
            self.contact.iter_mut().flat_map(|surface| surface.parts.iter_mut().flatten())
        }

        fn stretched(factor: f64) -> Sample {
            let mut sample = Sample::block(4);
            let scale = |u: &mut [f64; 2]| *u = u.map(|c| factor * c);
            sample.displacement.iter_mut().for_each(scale);
            sample.samples().for_each(|s| scale(&mut s.displacement));
            sample
        }
    }

    /// All words of a picture. Every element that starts also ends, no number is none, and all words are on the page.
    fn words(svg: &str) -> Vec<String> {
        let (mut open, mut words, mut page, mut at) = (Vec::new(), Vec::new(), [0.0; 2], None);
        for event in svg::read(svg).unwrap() {
            match event {
                Event::Tag(name, Type::End, _) => {
                    assert_eq!(open.pop().as_deref(), Some(name));
                    at = None;
                }
                Event::Tag(name, kind, attributes) => {
                    let number = |key: &str| attributes.get(key).and_then(|v| v.parse().ok());
                    if name == "svg" {
                        page = ["width", "height"].map(|key| number(key).unwrap());
                    }
                    if name == "text" {
                        let anchor = attributes.get("text-anchor").map_or("start", |v| v);
                        let size = number("font-size").unwrap_or(13.0);
                        at = Some((
                            ["x", "y"].map(|key| number(key).unwrap()),
                            anchor.to_owned(),
                            size,
                        ));
                    }
                    if kind == Type::Start {
                        open.push(name.to_owned());
                    }
                }
                Event::Text(text) if !text.trim().is_empty() => {
                    let text = text.trim().to_owned();
                    if let Some(([x, y], anchor, size)) = &at {
                        let width = 0.55 * size * text.chars().count() as f64;
                        let left = match &**anchor {
                            "middle" => x - width / 2.0,
                            "end" => x - width,
                            _ => *x,
                        };
                        let right: f64 = left + width;
                        assert!(left > 0.0 && right < page[0], "{text}: {left} to {right}");
                        assert!(*y > 0.0 && *y < page[1], "{text}: {y}");
                    }
                    words.push(text);
                }
                Event::Error(error) => panic!("{error}"),
                _ => {}
            }
        }
        assert!(open.is_empty() && !svg.contains("NaN") && !svg.contains("inf"));
        words
    }

    fn drawn(sample: &Sample) -> String {
        picture(&sample.scene()).unwrap()
    }

    fn has(words: &[String], expected: &[&str]) {
        for expected in expected {
            assert!(words.iter().any(|word| word == expected), "{expected}: {words:?}");
        }
    }

    #[test]
    fn the_picture_says_what_one_sees() {
        let words = words(&drawn(&Sample::block(4)));
        has(&words, &["Block", "linear triangles", "von Mises stress", "1", "7", "undeformed"]);
        has(&words, &["rigid obstacle", "contact pressure", "deformation at true scale"]);
        has(&words, &["floor: contact pressure", "peak 0.5", "arc length along the boundary"]);
    }

    #[test]
    fn units_stand_at_what_they_belong_to_and_interfaces_are_in_the_legend() {
        let sample = Sample::block(4);
        let edge = [[sample.mesh.triangles()[0][0], sample.mesh.triangles()[0][2]]];
        let scene = Scene { units: Some(["MPa", "mm"]), interfaces: &edge, ..sample.scene() };
        let svg = picture(&scene).unwrap();
        let words = words(&svg);
        has(
            &words,
            &["MPa, triangle means", "peak 0.5 MPa", "floor: contact pressure (MPa)", "0.2", "0.4"],
        );
        has(&words, &["arc length along the boundary (mm)", "border of two materials"]);
        assert_eq!(svg.matches("stroke-width=\"2.4\"").count(), 1);
    }

    #[test]
    fn each_contact_boundary_has_its_own_scale_its_own_panel_and_its_letter() {
        let mut sample = Sample::block(4);
        let mut small = sample.contact[0].clone();
        small.name = "wall".to_owned();
        small.parts[0].iter_mut().for_each(|s| s.pressure *= 1e-3);
        sample.contact.push(small);
        let heights: Vec<f64> = ContactLine::all(&sample.scene(), 1.0)
            .iter()
            .map(|line| distance(line.base[0], line.tip[0]))
            .collect();
        assert!((heights[0] - heights[1]).abs() < 1e-12 && heights[0] > 0.1, "{heights:?}");
        let words = words(&drawn(&sample));
        has(&words, &["peak 0.5", "peak 5e-4", "wall: contact pressure"]);
        assert_eq!(words.iter().filter(|word| *word == "A" || *word == "B").count(), 4);
    }

    #[test]
    fn on_a_hollow_line_the_arrows_end_before_they_meet() {
        let block = Sample::hole(1.0, 0.0, 0.05, |_| 1.0);
        for tip in &ContactLine::all(&block.scene(), 1.0)[0].tip {
            assert!(distance(*tip, [0.5, 0.5]) > 0.39 * 0.05, "{tip:?}");
        }
    }

    #[test]
    fn words_stay_on_the_page_however_long_and_wherever_the_contact_is() {
        let mut samples = vec![
            Sample::hole(3.2, 0.0, 0.06, |angle| 0.5 + 0.5 * angle.sin()),
            Sample::hole(0.0, -std::f64::consts::TAU, 0.3, |angle| angle.sin().max(0.0)),
            Sample::block(4),
        ];
        let at_left = |(i, s): (usize, &mut ContactSample)| {
            (s.position, s.normal) = ([0.0, 1.0 - 0.25 * i as f64], [-1.0, 0.0]);
        };
        samples[2].samples().enumerate().for_each(at_left);
        for sample in &mut samples {
            sample.title = "A title that is much longer than any page is wide ".repeat(4);
            sample.contact[0].name = "a boundary with a long name ".repeat(4);
            let units = Some(["kN/cm^2 and some more words", "an uncommon unit"]);
            let scene =
                Scene { units, interfaces: &[[0, 1]], stretch: Some(3.7), ..sample.scene() };
            has(&words(&picture(&scene).unwrap()), &["deformation and gap × 3.7"]);
        }
    }

    #[test]
    fn a_panel_shows_the_part_in_contact_and_marks_the_peak_at_its_place() {
        let mut sample = Sample::block(50);
        sample.samples().for_each(|s| s.pressure = (0.1 - (s.arc - 0.4).abs()).max(0.0));
        let svg = drawn(&sample);
        has(&words(&svg), &["peak 0.1", "0.2", "0.4", "0.6"]);
        assert!(!words(&svg).iter().any(|word| word == "0.8"));
        let dot = svg.split("<circle").nth(1).unwrap().split(" cx=\"").nth(1).unwrap();
        let x: f64 = dot.split('"').next().unwrap().parse().unwrap();
        let tick = svg.split("0.4\n</text>").next().unwrap().rsplit(" x=\"").next().unwrap();
        let tick: f64 = tick.split('"').next().unwrap().parse().unwrap();
        assert!((x - tick).abs() < 0.02, "{x} {tick}");
    }

    #[test]
    fn markup_in_a_title_is_text() {
        let mut sample = Sample::block(1);
        sample.title = "a < b & \"c\" > 'd'\u{1}\n</svg>".to_owned();
        let svg = drawn(&sample);
        assert!(svg.contains("a &lt; b &amp; \"c\" &gt; 'd'  &lt;/svg&gt;"));
        words(&svg);
    }

    #[test]
    fn a_picture_stays_below_two_megabytes_and_is_the_same_twice() {
        for n in [100, 101, 256] {
            let mut sample = Sample::block(n);
            // Neighbours as different as can be: nothing to merge.
            for (t, value) in sample.von_mises.iter_mut().enumerate() {
                *value = (t.wrapping_mul(2_654_435_761) % 1000) as f64;
            }
            let svg = drawn(&sample);
            assert!(svg.len() < 2_000_000, "{n}: {}", svg.len());
            words(&svg);
            assert_eq!(svg.contains("clip-path"), n > 100);
            assert!(n > 101 || drawn(&sample) == svg);
        }
    }

    #[test]
    fn displacements_are_magnified_by_a_round_factor_when_they_are_too_small_or_too_large() {
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
            let mut sample = Sample::stretched(factor);
            assert_eq!(sample.scene().magnification().1, expected, "{factor}");
            // The same where the contact boundary is curved.
            sample.samples().for_each(|s| s.position[1] = 0.1 * s.position[0].powi(2));
            assert_eq!(sample.scene().magnification().1, expected, "{factor}");
        }
    }

    #[test]
    fn the_body_touches_the_obstacle_where_u_n_is_the_gap_at_any_magnification() {
        let mut sample = Sample::block(4);
        sample.samples().for_each(|s| (s.displacement, s.gap) = ([0.01, -0.03], 0.03));
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
        sample.samples().for_each(|s| s.gap = 1.0);
        assert!(!words(&drawn(&sample)).contains(&"rigid obstacle".to_owned()));
    }

    #[test]
    fn without_pressure_legend_and_panel_say_so() {
        let mut sample = Sample::block(4);
        sample.samples().for_each(|s| s.pressure = 0.0);
        let with_zero = words(&drawn(&sample));
        has(&with_zero, &["no contact pressure", "no contact"]);
        assert!(!with_zero.iter().any(|word| word.starts_with("peak")));
        sample.contact.clear();
        has(&words(&drawn(&sample)), &["no contact pressure"]);
    }

    #[test]
    fn a_constant_stress_has_one_colour_even_if_rounding_has_touched_it() {
        for stress in [0.0, 3.0] {
            let mut sample = Sample::block(4);
            sample.von_mises.fill(stress);
            sample.von_mises[5] += 1e-15 * stress;
            let svg = drawn(&sample);
            assert_eq!(svg.matches(&viridis(64.0 / 127.0)).count(), 3, "{svg}");
            assert!(words(&svg).contains(&short(stress)));
        }
    }

    #[test]
    fn a_peak_of_stress_on_next_to_no_area_does_not_take_the_colours() {
        let mut sample = Sample::block(32);
        sample.von_mises[77] = 1000.0;
        let colours = Colours::of(&sample.scene());
        assert_eq!((colours.min, colours.top, colours.max), (1.0, 7.0, 1000.0));
        has(&words(&drawn(&sample)), &["max 1000"]);
        // On a coarse mesh one triangle is not next to nothing.
        let mut sample = Sample::block(4);
        sample.von_mises[7] = 1000.0;
        assert_eq!(Colours::of(&sample.scene()).top, 1000.0);
    }

    #[test]
    fn no_number_that_is_none_gets_into_a_picture() {
        let line = |to: f64| {
            let mut path = PathData::default();
            path.line([[0.0, 0.0], [to, 1.0]]);
            Document::new().add(Group::new().add(stroke(path, RED, 1.0))).add(text("NaN", [1.0; 2]))
        };
        assert_eq!(check_numbers(&line(2.0)), Ok(()));
        for to in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let place = "d of <path>".to_owned();
            assert_eq!(check_numbers(&line(to)), Err(NotFinite { place }));
            let place = "x of <text>".to_owned();
            let document = Document::new().add(text("words", [to, 1.0]));
            assert_eq!(check_numbers(&document), Err(NotFinite { place }));
        }
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused_by_name() {
        let not_finite = "is NaN or infinite; expected a finite number";
        let mut sample = Sample::block(1);
        sample.displacement[2][1] = f64::NAN;
        let error = picture(&sample.scene()).unwrap_err().to_string();
        assert_eq!(error, format!("deformed points[2] {not_finite}"));
        let mut sample = Sample::block(1);
        sample.samples().for_each(|s| s.pressure = f64::INFINITY);
        let error = picture(&sample.scene()).unwrap_err().to_string();
        assert!(error.ends_with(not_finite), "{error}");
        let far = Sample::stretched(1e3);
        let stretched = |factor: f64| picture(&Scene { stretch: Some(factor), ..far.scene() });
        for factor in [f64::MAX, 1e307, 1e306, 1e305, 1e304] {
            let error = stretched(factor).unwrap_or_else(|error| error.to_string());
            assert!(error.ends_with(not_finite) || !words(&error).is_empty(), "{factor}");
        }
        let error = stretched(f64::MAX).unwrap_err().to_string();
        assert!(error.starts_with("deformed points[") && error.ends_with(not_finite), "{error}");
        assert!(stretched(1e3).is_ok(), "control");
    }
}
