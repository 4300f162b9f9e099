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

mod body;
mod cells;
mod colours;
mod contact_line;
mod frame;
mod legend;
mod obstacle;
mod page;
mod path;
mod pressure;
mod scene;
mod stretch;
mod viridis;

use svg::Document;
use svg::node::element::{Group, Rectangle, Title};

use super::data::DataError;
use body::{body, definitions, outlines};
use colours::{Colours, colour_bar};
use contact_line::ContactLine;
use frame::Frame;
use legend::legend;
use obstacle::obstacle;
use page::{BAR, DARK, FONT, FOOTER, GREY, HEADER, MARGIN, clean, rounded, text, width_of};
use path::Point;
use pressure::pressure;
use stretch::Stretch;

pub use body::MOST_TRIANGLES;
pub use scene::{ContactSample, Scene};

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
    let contact: Vec<ContactLine> =
        contact.into_iter().map(|line| line.on(|p| frame.page(p))).collect();
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

fn headline(scene: &Scene, room: f64) -> Group {
    let (title, subtitle) = (clean(scene.title), clean(scene.subtitle));
    let fitting = |text: &str, size: f64| rounded((size * room / width_of(text, size)).min(size));
    // Bold letters are wider.
    let [large, small] = [fitting(&title, 24.0 / 0.8) * 0.8, fitting(&subtitle, 14.0)];
    Group::new()
        .add(text(title, [MARGIN, 44.0]).set("font-size", large).set("font-weight", "bold"))
        .add(text(subtitle, [MARGIN, 68.0]).set("font-size", small).set("fill", GREY))
}

#[cfg(test)]
mod tests {
    use super::page::short;
    use super::path::distance;
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
        assert_eq!(peaks, ["peak 0.5", "peak 5e-4"]);
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
    fn nothing_is_stretched_where_the_contact_line_is_curved() {
        let mut sample = Sample::stretched(1e-3);
        assert_ne!(Stretch::of(&sample.scene()).factor(), 1.0);
        sample.contact[0].iter_mut().for_each(|s| s.position[1] = 0.1 * s.position[0].powi(2));
        assert_eq!(Stretch::of(&sample.scene()).factor(), 1.0);
    }

    #[test]
    fn the_words_at_a_peak_beside_the_body_are_on_the_page() {
        let mut sample = Sample::block(4);
        let at_left = |(i, s): (usize, &mut ContactSample)| {
            (s.position, s.normal) = ([0.0, 1.0 - 0.25 * i as f64], [-1.0, 0.0]);
        };
        sample.contact[0].iter_mut().enumerate().for_each(at_left);
        let scene = Scene { unit: Some("N/mm²"), ..sample.scene() };
        let svg = picture(&scene).unwrap();
        let peak = svg.split("<text").find(|text| text.contains("peak 0.5 N/mm²")).unwrap();
        assert!(peak.contains("text-anchor=\"end\""), "{peak}");
        let place = peak.split(" x=\"").nth(1).unwrap().split('"').next().unwrap();
        let place: f64 = place.parse().unwrap();
        assert!(place >= width_of("peak 0.5 N/mm²", 13.0 / 0.85), "{place}");
    }

    #[test]
    fn the_axis_of_a_closed_line_stands_opposite_its_peak() {
        let mut block = Sample::block(4);
        let on_hole = |i: i32| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(-i) / 24.0).sin_cos();
            ContactSample {
                position: [0.5 + 0.3 * cos, 0.5 + 0.3 * sin],
                normal: [-cos, -sin],
                displacement: [0.0; 2],
                gap: 0.0,
                pressure: sin.max(0.0),
            }
        };
        block.contact = vec![(0..=24).map(on_hole).collect()];
        let svg = draw(&block);
        // The y of the first text after some words.
        let height = |words: &str| -> f64 {
            let text = svg.split(words).nth(1).unwrap().split("<text").nth(1).unwrap();
            text.split(" y=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
        };
        let (zero, peak) =
            (height("fill=\"#d62728\" font-size=\"11\""), height("font-weight=\"bold\">\n<rect"));
        assert!(zero > peak + 50.0, "{zero} {peak}");
    }

    #[test]
    fn the_words_at_a_peak_in_a_small_hole_do_not_cover_the_curve() {
        let mut block = Sample::block(4);
        // Half of a hole, its lower part, pressed all along.
        let on_hole = |i: i32| {
            let (sin, cos) = (std::f64::consts::PI * f64::from(i) / 24.0).sin_cos();
            ContactSample {
                position: [0.5 + 0.06 * cos, 0.5 - 0.06 * sin],
                normal: [-cos, sin],
                displacement: [0.0; 2],
                gap: 0.0,
                pressure: 0.5 + 0.5 * sin,
            }
        };
        block.contact = vec![(0..=24).map(on_hole).collect()];
        let svg = draw(&block);
        let curve = svg.split("stroke-width=\"1.5\"").next().unwrap();
        let curve = curve.rsplit("<path").next().unwrap().split(" d=\"").nth(1);
        let numbers = curve.unwrap().split('"').next().unwrap();
        let numbers: Vec<f64> = numbers
            .split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'))
            .filter_map(|number| number.parse().ok())
            .collect();
        let peak = svg.split("font-weight=\"bold\">\n<rect").last().unwrap();
        let [x, y, width, height] = ["x", "y", "width", "height"].map(|name| -> f64 {
            let value = peak.split(&format!(" {name}=\"")).nth(1).unwrap();
            value.split('"').next().unwrap().parse().unwrap()
        });
        assert!(numbers.len() > 20 && width > 40.0, "{numbers:?} {width}");
        for place in numbers.chunks_exact(2) {
            let inside =
                (x..=x + width).contains(&place[0]) && (y..=y + height).contains(&place[1]);
            assert!(!inside, "{place:?} in {:?}", [x, y, width, height]);
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
