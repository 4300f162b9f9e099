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
mod cells;
mod contact;
mod draw;
mod loads;
mod panel;
pub mod plot;
mod scale;
mod scene;

use svg::Node;
use svg::node::element::{Group, Use};

use super::Case;
use super::files::{NotFinite, check_finite};
use super::result::Results;
use crate::results::Solution;
use body::{BAR, body, colour_bar, definitions, outlines};
use contact::{ContactLine, arrow, obstacle, pressure, tags};
use draw::{
    DARK, GREY, LEGEND_LINE, PageMap, PathData, Point, SAMPLE, clean, fitting, legend, page,
    red_area, short, stroke, text, wrapped,
};
use loads::{FORCE, MOTION};
use scale::Scale;
pub(crate) use scene::Scene;

/// The page around the drawing.
const MARGIN: f64 = 36.0;
const HEADER: f64 = 88.0;
const GAP: f64 = 20.0;

/// The picture of a solved case.
///
/// # Errors
/// A number beyond the range of doubles.
pub fn picture_of(case: &Case, s: &Solution, results: &Results) -> Result<String, NotFinite> {
    Ok(draw(&[Scene::of(case, s, results)])?.concat())
}

/// The pictures of solved cases, on one scale.
///
/// # Errors
/// As [`picture_of`].
pub(crate) fn draw(scenes: &[Scene]) -> Result<Vec<String>, NotFinite> {
    let scale = Scale::of(scenes)?;
    scenes.iter().map(|scene| picture(scene, &scale)).collect()
}

fn picture(scene: &Scene, scale: &Scale) -> Result<String, NotFinite> {
    let deformed = scene.deformed(scale.factor);
    let lines = ContactLine::all(scene, scale);
    let frame = PageMap::around(scale.frame, [MARGIN, HEADER]);
    check_finite("page", [frame.page([0.0; 2]).as_slice(), &[frame.width, frame.height]])?;
    let deformed: Vec<Point> = deformed.into_iter().map(|p| frame.page(p)).collect();
    let lines: Vec<ContactLine> = lines.into_iter().map(|line| line.on(&frame)).collect();
    let on_page = |v: usize| deformed.get(v).copied();
    let drawn = [
        obstacle(&lines),
        loads::drawn_supports(scene, &deformed),
        pressure(&lines),
        loads::arrows(scene, &deformed, true),
        loads::arrows(scene, &deformed, false),
        scene.most_stressed.and_then(on_page).map(loads::cross),
    ];
    let magnified = match scale.factor {
        1.0 => "deformation at true scale".to_owned(),
        factor => format!("deformation and gap × {}", short(factor)),
    };
    let width = frame.width + GAP + BAR;
    let legend_at = [MARGIN, HEADER + frame.height + 30.0];
    let entries = entries(scene, drawn.each_ref().map(Option::is_some), &magnified);
    let (legend, bottom) = legend(entries, legend_at, MARGIN + width);
    let panels_at = bottom + LEGEND_LINE;
    let size = [width + 2.0 * MARGIN, panels_at + panel::height(scene)];

    let [unit, length] = [0, 1].map(|i| scene.units.as_ref().map(|units| &*units[i]));
    let mut document = page(size.map(f64::round), &scene.title)
        .add(definitions(scene, &deformed))
        .add(headline(scene, width));
    if scene.of_revolution {
        document.append(other_half(&frame));
    }
    let half = Group::new().set("id", "half").add(body(scene, &deformed, &scale.colours));
    document.append(half.add(outlines(scene, &deformed, &frame)));
    let bar_at = [MARGIN + frame.width + GAP, HEADER];
    document.append(colour_bar(&scale.colours, unit, bar_at, frame.height));
    drawn.into_iter().flatten().for_each(|group| document.append(group));
    let scale_at = [MARGIN + frame.width, HEADER + frame.height + 10.0];
    document.append(loads::scale_bar(&frame, length, scale_at));
    if scene.contact.len() > 1 {
        document.append(tags(&lines, scene.contact.len()));
    }
    document.append(legend);
    document.append(panel::panels(scene, scale, [MARGIN, panels_at], width));
    check_numbers(&document)?;
    Ok(format!("{document}\n"))
}

/// The entries of the legend, where these drawings over the body are there.
fn entries<'w>(
    scene: &Scene,
    [obstacle, _, pressure, motions, forces, cross]: [bool; 6],
    magnified: &'w str,
) -> Vec<(Option<Group>, &'w str)> {
    let dashed = |line: Group, dashes: &str| Some(line.set("stroke-dasharray", dashes));
    let has_borders = !scene.interfaces.is_empty();
    let friction = Some(sample(panel::OPEN, 1.6));
    let before = [
        (true, dashed(sample(GREY, 1.2), "6 4"), "undeformed"),
        (scene.of_revolution, dashed(sample(DARK, 1.0), "14 4 3 4"), "axis"),
        (has_borders, Some(sample(DARK, 1.0)), "border of two materials"),
        (obstacle, loads::wall_sample(), "rigid obstacle"),
    ];
    let after = [
        (forces, Some(pointed(FORCE)), "load"),
        (motions, Some(pointed(MOTION)), "prescribed displacement"),
        (cross, Some(loads::cross([15.0, -4.5])), "largest von Mises stress"),
        (pressure, Some(pressed()), "contact pressure"),
        (!pressure, None, "no contact pressure"),
        (panel::has_shear(scene), friction, "size of the friction"),
        (true, None, magnified),
    ];
    let all = before.into_iter().chain(loads::support_entries(scene)).chain(after);
    all.filter(|entry| entry.0).map(|(_, sample, words)| (sample, words)).collect()
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
    let [title, subtitle] = [&scene.title, &scene.subtitle].map(|words| clean(words));
    // Bold letters are wider.
    let large = fitting(&title, 24.0 / 0.8, room) * 0.8;
    let small = fitting(&subtitle, 14.0, room);
    let mut group = Group::new();
    if large < SMALLEST_TITLE {
        // Two smaller lines in the place of a large one.
        let lines = wrapped(&title, SMALLEST_TITLE / 0.8, room, 2);
        for (line, y) in lines.into_iter().zip([28.0, 48.0]) {
            let line = text(line, [MARGIN, y]).set("font-size", SMALLEST_TITLE);
            group.append(line.set("font-weight", "bold"));
        }
    } else {
        group
            .append(text(title, [MARGIN, 44.0]).set("font-size", large).set("font-weight", "bold"));
    }
    group.add(text(subtitle, [MARGIN, 68.0]).set("font-size", small).set("fill", GREY))
}

/// A title is written in two lines rather than with smaller letters.
const SMALLEST_TITLE: f64 = 15.0;

/// The sample of an arrow.
fn pointed(colour: &str) -> Group {
    let mut path = PathData::default();
    arrow(SAMPLE[0], SAMPLE[1], &mut path);
    Group::new().add(stroke(path, colour, 1.6))
}

/// The mirror image of a body of revolution, paler, and the axis between the two.
fn other_half(frame: &PageMap) -> Group {
    let [axis, _] = frame.page([0.0; 2]);
    let mirrored = Use::new()
        .set("href", "#half")
        .set("transform", format!("translate({} 0) scale(-1 1)", draw::rounded(2.0 * axis)))
        .set("opacity", 0.4);
    let mut line = PathData::default();
    line.line([[axis, HEADER - 6.0], [axis, HEADER + frame.height + 6.0]]);
    let line = stroke(line, DARK, 1.0).set("stroke-dasharray", "14 4 3 4");
    Group::new().add(mirrored).add(line)
}

/// The sample of a line.
fn sample(colour: &str, width: f64) -> Group {
    let mut line = PathData::default();
    line.line(SAMPLE);
    Group::new().add(stroke(line, colour, width))
}

/// The sample of the pressure.
fn pressed() -> Group {
    let [below, above] = [5.0, -5.0].map(|off| SAMPLE.map(|[x, y]| [x, y + off]));
    let (mut area, mut curve) = (PathData::default(), PathData::default());
    area.polygon([above[0], above[1], below[1], below[0]]);
    curve.line(below);
    red_area(area, curve)
}

#[cfg(test)]
mod tests {
    use super::body::Colours;
    use super::draw::{distance, short, viridis};
    use super::scene::ContactSurface;
    use super::*;
    use crate::certificates::quantities::{Limit, Zone};
    use crate::model::{Diagonal, Rectangle};
    use crate::results::solution::ContactPoint;
    use svg::node::element::tag::Type;
    use svg::parser::Event;

    /// A block of n x n cells that comes down on the floor with its left part, and bends up on the right.
    fn block(n: usize) -> Scene {
        let diagonal = Diagonal::Right;
        let mesh = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal }.mesh().unwrap();
        let lift = |x: f64| (x - 0.5).max(0.0).powi(2);
        let moved = |&[x, y]: &Point| [0.05 * (1.0 - y), lift(x) * (1.0 - y)];
        let displacement: Vec<Point> = mesh.vertices().iter().map(moved).collect();
        let mut edges = mesh.edges_of("bottom").unwrap().to_vec();
        edges.sort_by_key(|&edge| mesh.ends(edge)[0]);
        let sample = |v: usize| ContactPoint {
            arc: mesh.vertices()[v][0],
            place: mesh.vertices()[v],
            direction: [0.0, -1.0],
            displacement: displacement[v],
            pressure: (0.5 - mesh.vertices()[v][0]).max(0.0),
            ..ContactPoint::default()
        };
        let part = edges.iter().flat_map(|&e| mesh.ends(e)).map(sample).collect();
        Scene {
            title: "Block".to_owned(),
            subtitle: "linear triangles".to_owned(),
            points: mesh.vertices().to_vec(),
            triangles: mesh.triangles().to_vec(),
            von_mises: (0..mesh.triangles().len()).map(|t| 1.0 + (t % 7) as f64).collect(),
            units: None,
            stretch: None,
            apart: 0.0,
            interfaces: Vec::new(),
            outline: mesh.outline().iter().map(|&edge| mesh.ends(edge)).collect(),
            contact: vec![ContactSurface {
                name: "floor".into(),
                rigid: true,
                rough: false,
                parts: vec![part],
                zones: None,
                reserved: false,
            }],
            supports: Vec::new(),
            loads: Vec::new(),
            most_stressed: None,
            of_revolution: false,
            displacement,
        }
    }

    fn samples(scene: &mut Scene) -> impl Iterator<Item = &mut ContactPoint> {
        scene.contact.iter_mut().flat_map(|surface| surface.parts.iter_mut().flatten())
    }

    /// The block with contact along a part of a circle: from angle to angle, of that radius, with the pressure there.
    fn hole(from: f64, to: f64, radius: f64, pressure: fn(f64) -> f64) -> Scene {
        let sample = |i: i32| {
            let angle = from + (to - from) * f64::from(i) / 24.0;
            let (sin, cos) = angle.sin_cos();
            ContactPoint {
                arc: radius * (angle - from).abs(),
                place: [0.5 + radius * cos, 0.5 + radius * sin],
                direction: [-cos, -sin],
                pressure: pressure(angle),
                ..ContactPoint::default()
            }
        };
        let mut block = block(4);
        block.contact[0].parts = vec![(0..=24).map(sample).collect()];
        block
    }

    fn stretched(factor: f64) -> Scene {
        let mut scene = block(4);
        let scale = |u: &mut Point| *u = u.map(|c| factor * c);
        scene.displacement.iter_mut().for_each(scale);
        samples(&mut scene).for_each(|s| scale(&mut s.displacement));
        scene
    }

    /// All words of a picture. Checks that tags are balanced, no coordinate is NaN, and all words are inside the page.
    fn words(svg: &str) -> Vec<String> {
        let (mut open, mut words) = (Vec::new(), Vec::new());
        let mut page = [0.0; 2];
        for event in svg::read(svg).unwrap() {
            match event {
                Event::Tag(name, Type::End, _) => assert_eq!(open.pop().unwrap(), (name, None)),
                Event::Tag(name, kind, attributes) => {
                    let number = |key: &str| attributes.get(key).and_then(|v| v.parse().ok());
                    if name == "svg" {
                        page = ["width", "height"].map(|key| number(key).unwrap());
                    }
                    let [x, y] = ["x", "y"].map(|key| number(key).unwrap_or(f64::NAN));
                    let part = match attributes.get("text-anchor").map(|anchor| &**anchor) {
                        Some("middle") => 0.5,
                        Some("end") => 1.0,
                        _ => 0.0,
                    };
                    let size = number("font-size").unwrap_or(13.0);
                    if kind == Type::Start {
                        open.push((name, (name == "text").then_some([x, y, part, size])));
                    }
                }
                Event::Text(text) if !text.trim().is_empty() => {
                    let text = text.trim();
                    if let Some([x, y, part, size]) = open.last_mut().and_then(|o| o.1.take()) {
                        let width = 0.55 * size * text.chars().count() as f64;
                        let left = x - part * width;
                        assert!(left > 0.0 && left + width < page[0], "{text}: {left} + {width}");
                        assert!(y > 0.0 && y < page[1], "{text}: {y}");
                    }
                    words.push(text.to_owned());
                }
                Event::Error(error) => panic!("{error}"),
                _ => {}
            }
        }
        assert!(open.is_empty() && !svg.contains("NaN") && !svg.contains("inf"));
        words
    }

    fn drawn(scene: &Scene) -> String {
        draw(std::slice::from_ref(scene)).unwrap().concat()
    }

    fn lines(scene: &Scene) -> Vec<ContactLine> {
        ContactLine::all(scene, &Scale::of(std::slice::from_ref(scene)).unwrap())
    }

    #[test]
    fn words_say_what_one_sees() {
        type Edit = fn(&mut Scene);
        let rows: [(Edit, &[&str], &[&str]); 10] = [
            (
                |_| {},
                &[
                    "Block, linear triangles, von Mises stress, 1, 7, undeformed, rigid obstacle, contact pressure",
                    "deformation at true scale, floor: contact pressure, peak 0.5, arc length along the boundary",
                ],
                &["border of two materials, axis, held, size of the friction"],
            ),
            (
                |s| s.supports = vec![(vec![20, 21], false), (vec![0], true), (vec![4], false)],
                &["held in one direction"],
                &[],
            ),
            (|s| s.of_revolution = true, &["axis, floor: contact pressure"], &[]),
            (
                |s| {
                    s.units = Some(["MPa", "mm"].map(str::to_owned));
                    s.interfaces = vec![[0, 1]];
                },
                &[
                    "peak 0.5 MPa, floor: contact pressure (MPa), 0.2, arc length along the boundary (mm), border of two materials",
                ],
                &["peak 0.5"],
            ),
            (
                |s| {
                    s.contact.push(s.contact[0].clone());
                    s.contact[1].name = "wall".to_owned();
                    s.contact[1].parts[0].iter_mut().for_each(|s| s.pressure *= 1e-3);
                },
                &["peak 0.5, peak 5e-4, wall: contact pressure, A, B"],
                &[],
            ),
            // The part in contact alone is shown where it is small.
            (
                |s| {
                    *s = block(50);
                    samples(s).for_each(|s| s.pressure = (0.1 - (s.arc - 0.4).abs()).max(0.0));
                },
                &["peak 0.1, 0.2, 0.4, 0.6"],
                &["0.8"],
            ),
            (
                |s| {
                    s.contact[0].rough = true;
                    samples(s).for_each(|s| (s.pressure, s.gap, s.shear) = (0.0, 1.0, 0.1));
                },
                &["no contact pressure, no contact"],
                &["peak 0, rigid obstacle, size of the friction"],
            ),
            (|s| s.contact.clear(), &["no contact pressure"], &["no contact"]),
            (
                |s| {
                    s.contact[0].rough = true;
                    samples(s).for_each(|s| s.shear = 0.5 * s.pressure);
                },
                &["size of the friction", "contact pressure"],
                &["floor: contact pressure"],
            ),
            (
                |s| {
                    *s = block(32);
                    s.von_mises[77] = 1000.0;
                    s.stretch = Some(3.7);
                },
                &["max 1000, deformation and gap × 3.7"],
                &["1000"],
            ),
        ];
        for (change, present, absent) in rows {
            let mut scene = block(4);
            change(&mut scene);
            let words = words(&drawn(&scene));
            for (listed, expected) in [(present, true), (absent, false)] {
                for word in listed.iter().flat_map(|list| list.split(", ")) {
                    let found = words.iter().any(|found| found == word);
                    assert_eq!(found, expected, "{word}: {words:?}");
                }
            }
        }
    }

    #[test]
    fn each_contact_boundary_has_its_own_scale_and_arrows_on_a_hollow_line_do_not_meet() {
        let mut scene = block(4);
        scene.contact.push(scene.contact[0].clone());
        scene.contact[1].parts[0].iter_mut().for_each(|s| s.pressure *= 1e-3);
        scene.contact[1].name = "wall".to_owned();
        let drawn = lines(&scene);
        let heights = [0, 1].map(|i| distance(drawn[i].base[0], drawn[i].tip[0]));
        assert!((heights[0] - heights[1]).abs() < 1e-12 && heights[0] > 0.1, "{heights:?}");
        let hollow = hole(1.0, 0.0, 0.05, |_| 1.0);
        for tip in &lines(&hollow)[0].tip {
            assert!(distance(*tip, [0.5, 0.5]) > 0.39 * 0.05, "{tip:?}");
        }
    }

    #[test]
    fn words_stay_on_the_page_however_long_and_wherever_the_contact_is() {
        let mut scenes = [
            hole(3.2, 0.0, 0.06, |angle| 0.5 + 0.5 * angle.sin()),
            hole(0.0, -std::f64::consts::TAU, 0.3, |angle| angle.sin().max(0.0)),
            block(4),
        ];
        let at_left = |(i, s): (usize, &mut ContactPoint)| {
            (s.place, s.direction) = ([0.0, 1.0 - 0.25 * i as f64], [-1.0, 0.0]);
        };
        samples(&mut scenes[2]).enumerate().for_each(at_left);
        for scene in &mut scenes {
            scene.title = "A title that is much longer than any page is wide ".repeat(4);
            scene.contact[0].name = "a boundary with a long name ".repeat(4);
            scene.units =
                Some(["kN/cm^2 and some more words", "an unusual unit"].map(str::to_owned));
            scene.interfaces = vec![[0, 1]];
            words(&drawn(scene));
        }
    }

    #[test]
    fn a_panel_runs_the_way_its_boundary_does() {
        let dot = |arc: f64, to_the_left: bool| -> f64 {
            let mut scene = block(50);
            for sample in samples(&mut scene) {
                sample.pressure = (0.3 - (sample.arc - arc).abs()).max(0.0);
                if to_the_left {
                    sample.place[0] = 1.0 - sample.place[0];
                }
            }
            let svg = drawn(&scene);
            let dot = svg.split("<circle").nth(1).unwrap().split(" cx=\"").nth(1).unwrap();
            dot.split('"').next().unwrap().parse().unwrap()
        };
        // Rounded to hundredths.
        let same = |a: f64, b: f64| (a - b).abs() < 0.02;
        assert!(same(dot(0.4, true), dot(0.6, false)) && !same(dot(0.4, true), dot(0.4, false)));
    }

    #[test]
    fn a_picture_stays_below_two_megabytes_and_is_the_same_twice() {
        for n in [100, 101, 256] {
            let mut scene = block(n);
            // Neighbours as different as can be: nothing to merge.
            for (t, value) in scene.von_mises.iter_mut().enumerate() {
                *value = (t.wrapping_mul(2_654_435_761) % 1000) as f64;
            }
            let svg = drawn(&scene);
            assert!(svg.len() < 2_000_000, "{n}: {}", svg.len());
            words(&svg);
            assert_eq!(svg.contains("clip-path"), n > 100);
            assert!(n > 101 || drawn(&scene) == svg);
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
            let words = words(&drawn(&stretched(factor)));
            assert!(words.iter().any(|word| word == expected), "{factor}: {words:?}");
        }
    }

    #[test]
    fn the_body_touches_the_obstacle_where_u_n_is_the_gap_at_any_magnification() {
        let mut scene = block(4);
        samples(&mut scene).for_each(|s| (s.displacement, s.gap) = ([0.01, -0.03], 0.03));
        for factor in [0.5, 1.0, 5.0] {
            scene.stretch = Some(factor);
            let line = &lines(&scene)[0];
            for (base, wall) in line.base.iter().zip(&line.wall) {
                assert_eq!(Some(base[1]), wall.map(|wall| wall[1]));
            }
        }
    }

    #[test]
    fn colours_are_not_spent_on_rounding_nor_on_a_peak_on_next_to_no_area() {
        for stress in [0.0, 3.0] {
            let mut scene = block(4);
            scene.von_mises.fill(stress);
            scene.von_mises[5] += 1e-15 * stress;
            let svg = drawn(&scene);
            assert_eq!(svg.matches(&viridis(64.0 / 127.0)).count(), 3, "{svg}");
            assert!(words(&svg).contains(&short(stress)));
        }
        // On a coarse mesh one triangle is not next to nothing.
        for (n, top) in [(32, 7.0), (4, 1000.0)] {
            let mut scene = block(n);
            scene.von_mises[7] = 1000.0;
            let colours = Colours::of(&scene);
            assert_eq!((colours.min, colours.top, colours.max), (1.0, top, 1000.0));
        }
    }

    #[test]
    fn pictures_of_a_series_have_one_scale_and_each_by_itself_its_own() {
        let (large, mut small) = (block(4), block(4));
        small.displacement.iter_mut().for_each(|u| *u = u.map(|c| 1e-3 * c));
        small.von_mises.iter_mut().for_each(|value| *value *= 0.1);
        samples(&mut small).for_each(|s| s.pressure *= 0.1);
        let [both, by_itself] = [[&large, &small], [&large, &large]]
            .map(|of| Scale::of(&of.map(Scene::clone)).unwrap());
        assert_eq!(both.factor, by_itself.factor);
        assert_eq!(both.colours.top, by_itself.colours.top);
        assert_eq!(both.colours.min, 0.1 * by_itself.colours.min);
        assert_eq!(both.pressures(&small.contact[0]), by_itself.pressures(&large.contact[0]));
        let series = draw(&[large, small.clone()]).unwrap();
        let said = |svg: &str| words(svg).into_iter().find(|word| word.starts_with("deformation"));
        assert_eq!(said(&series[0]), said(&series[1]));
        assert_ne!(said(&series[1]), said(&drawn(&small)), "the control");
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused_by_name() {
        let not_finite = "is NaN or infinite; expected a finite number";
        let mut scene = block(1);
        scene.displacement[2][1] = f64::NAN;
        let error = draw(&[scene]).unwrap_err().to_string();
        assert_eq!(error, format!("deformed points[2] {not_finite}"));
        let mut scene = block(1);
        samples(&mut scene).for_each(|s| s.pressure = f64::INFINITY);
        let error = draw(&[scene]).unwrap_err().to_string();
        assert!(error.ends_with(not_finite), "{error}");
        let mut far = stretched(1e3);
        for factor in [f64::MAX, 1e307, 1e306, 1e305, 1e304] {
            far.stretch = Some(factor);
            let error = draw(&[far.clone()]).map(|all| all.concat());
            let error = error.unwrap_or_else(|error| error.to_string());
            assert!(error.ends_with(not_finite) || !words(&error).is_empty(), "{factor}");
        }
        far.stretch = Some(1e3);
        assert!(draw(&[far]).is_ok(), "control");
    }

    #[test]
    fn the_strip_says_what_is_bounded_by_how_much_and_with_which_reservation() {
        let zone = |from: f64, to: f64, limit| {
            let boundary = "floor".to_owned();
            Zone { boundary, from, to, ends: [[from, 0.0], [to, 0.0]], limit }
        };
        let said = |zones: Vec<Zone>, reserved: bool| {
            let mut scene = block(4);
            (scene.contact[0].zones, scene.contact[0].reserved) = (Some(zones), reserved);
            words(&drawn(&scene)).join(" | ")
        };
        let zones = || {
            vec![
                zone(0.0, 0.4, Limit::Opening(0.004)),
                zone(0.1, 0.3, Limit::Opening(0.001)),
                // What the plot shows ends with the contact, at 0.5.
                zone(0.4, 0.5, Limit::Force(0.005)),
                zone(0.6, 1.0, Limit::Force(9.0)),
            ]
        };
        let proved = said(zones(), false);
        for words in ["proved:", "mean opening ≤ 0.01", "mean pressure ≤ 0.05", "not known"] {
            assert!(proved.contains(words), "{words}: {proved}");
        }
        let reserved = said(zones(), true);
        assert!(reserved.contains("with a reservation:") && !reserved.contains("proved:"));
        // Control: where nothing is bounded, nothing is said to be.
        let nothing = said(Vec::new(), false);
        assert!(!nothing.contains("proved:") && !nothing.contains("opening"), "{nothing}");
    }

    #[test]
    fn panels_stand_two_in_a_row_and_the_next_ones_below_these() {
        let mut scene = block(4);
        scene.contact = vec![scene.contact[0].clone(); 5];
        let scale = Scale::of(std::slice::from_ref(&scene)).unwrap();
        let drawn = panel::panels(&scene, &scale, [10.0, 20.0], 600.0).to_string();
        let mut circles: Vec<[f64; 2]> = Vec::new();
        for event in svg::read(&drawn).unwrap() {
            if let Event::Tag("circle", Type::Empty, attributes) = event {
                circles.push(["cx", "cy"].map(|key| attributes[key].parse().unwrap()));
            }
        }
        // Before each there is the dot at the peak of the pressure.
        let tags: Vec<[f64; 2]> = circles.into_iter().skip(1).step_by(2).collect();
        let [a, b, c, d, e] = tags[..] else { panic!("a tag for each: {tags:?}") };
        assert!(b[0] > a[0] && a[1] == b[1], "{tags:?}");
        let below = c[1] - a[1];
        assert!(
            below > 100.0 && c == [a[0], a[1] + below] && d == [b[0], b[1] + below],
            "{tags:?}"
        );
        assert_eq!(e, [a[0], a[1] + 2.0 * below]);
        assert_eq!(panel::height(&scene), 3.0 * below);
    }
}
