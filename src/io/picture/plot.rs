//! Figures with logarithmic or plain axes: panels side by side, a legend below them, and triangles that show a slope.
//!
//! Points with a coordinate that is not positive have no place between logarithmic axes and are left out.

use svg::Node;
use svg::node::element::{Circle, Group, Path as PathElement};

use super::draw::{
    Axes, GREY, LEGEND_LINE, PageAxis, PathData, Point, SAMPLE, anchored, dot, legend, page, range,
    stroke, text,
};
use crate::io::files::{NotFinite, check_finite};
use crate::io::numbers::{self, short};

/// Lines over a quantity that panels side by side share.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The headline.
    pub title: String,
    /// The label of the x axis, which all panels share.
    pub x_label: String,
    /// Both axes are logarithmic.
    pub logarithmic: bool,
    /// The panels, from the left.
    pub panels: Vec<Panel>,
    /// The lines by name, for the legend and their looks.
    pub styles: Vec<Style>,
}

/// A panel: a line for each style, in their order.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The quantity drawn over x.
    pub title: String,
    /// The points of each line; an empty one is not drawn.
    pub lines: Vec<Vec<[f64; 2]>>,
    /// Triangles: the number of a line, and the slope to show below it.
    pub slopes: Vec<(usize, f64)>,
}

/// How a line looks.
#[derive(Clone, Debug)]
pub struct Style {
    /// Its name in the legend.
    pub name: String,
    /// Its colour, as SVG writes it.
    pub colour: &'static str,
    /// The line is dashed, its points are hollow.
    pub dashed: bool,
}

/// Colours that the colour-blind tell apart, too.
pub const COLOURS: [&str; 3] = ["#0072b2", "#d55e00", "#009e73"];

/// The drawing area of a panel, and the space around it.
const WIDTH: f64 = 270.0;
const HEIGHT: f64 = 270.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 18.0;
const TOP: f64 = 74.0;
const BELOW: f64 = 48.0;

/// The figure as SVG.
///
/// # Errors
/// A number that is not finite.
pub fn figure(figure: &Figure) -> Result<String, NotFinite> {
    for panel in &figure.panels {
        for (line, style) in panel.lines.iter().zip(&figure.styles) {
            let name = format!("{}: {}", panel.title, style.name);
            check_finite(&name, line.iter().map(<[f64; 2]>::as_slice))?;
        }
    }
    let width = figure.panels.len().max(1) as f64 * (LEFT + WIDTH + RIGHT);
    let sample = |style: &Style| {
        let [[x0, y], [x1, _]] = SAMPLE;
        Group::new().add(line(SAMPLE, style)).add(mark([(x0 + x1) / 2.0, y], style))
    };
    let entries = figure.styles.iter().map(|style| (Some(sample(style)), &*style.name)).collect();
    let (legend, bottom) = legend(entries, [16.0, TOP + HEIGHT + BELOW + 12.0], width);
    let size = [width, bottom + LEGEND_LINE - 4.0].map(f64::round);
    let mut document = page(size, &figure.title)
        .add(anchored("middle", &*figure.title, [width / 2.0, 26.0]).set("font-size", 15));
    for (i, panel) in figure.panels.iter().enumerate() {
        let left = i as f64 * (LEFT + WIDTH + RIGHT) + LEFT;
        document = document.add(draw(panel, figure, left));
    }
    Ok(format!("{}\n", document.add(legend)))
}

fn line(points: impl IntoIterator<Item = Point>, style: &Style) -> PathElement {
    let mut path = PathData::default();
    path.line(points);
    let line = stroke(path, style.colour, 1.6);
    if style.dashed { line.set("stroke-dasharray", "5 3") } else { line }
}

fn mark(at: Point, style: &Style) -> Circle {
    dot(at)
        .set("fill", if style.dashed { "white" } else { style.colour })
        .set("stroke", style.colour)
        .set("stroke-width", 1.2)
}

/// The part of the largest number that a plain y axis shows at least: what changes by less looks as constant as it is.
const LEAST: f64 = 0.02;

/// An axis around these numbers, with some space; no shorter than `least` times the largest of them.
fn plain(numbers: impl Iterator<Item = f64>, least: f64, page: [f64; 2]) -> PageAxis {
    let range = range(numbers);
    let [low, high] = if range[0] <= range[1] { range } else { [0.0, 1.0] };
    let space = if high > low { 0.06 * (high - low) } else { 0.06 * high.abs().max(1.0) };
    let missing = least * low.abs().max(high.abs()) - (high - low);
    let space = space.max(missing / 2.0);
    PageAxis { range: [low - space, high + space], page }
}

/// An axis around these logarithms, with some space.
fn logarithmic(logarithms: impl Iterator<Item = f64>, page: [f64; 2]) -> PageAxis {
    let range = range(logarithms);
    let [low, high] = if range[0] <= range[1] { range } else { [-1.0, 0.0] };
    let space = (0.06 * (high - low)).max(0.05);
    PageAxis { range: [low - space, high + space], page }
}

/// The logarithms and labels of the powers of ten inside; where there are fewer than three, also of twice and five times them.
fn ticks(axis: &PageAxis) -> Vec<(f64, String)> {
    let [low, high] = axis.range;
    let inside = |m: i32, every: i32| -> Vec<(f64, String)> {
        let exponents = (low.floor() as i32..=high.ceil() as i32).filter(|k| k % every == 0);
        let ticks = exponents.map(|k| f64::from(m) * 10_f64.powi(k));
        let inside = ticks.filter(|tick| (low..=high).contains(&tick.log10()));
        inside.map(|tick| (tick.log10(), short(tick, 1))).collect()
    };
    match inside(1, 1).len() {
        0..3 => [1, 2, 5].into_iter().flat_map(|m| inside(m, 1)).collect(),
        // Not more than about eight labels.
        decades => inside(1, decades.div_ceil(8) as i32),
    }
}

fn positive(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    line.iter().copied().filter(|p| p.iter().all(|&c| c > 0.0)).collect()
}

/// The corners of a slope triangle in coordinates of the figure: below the second and third of the points that are
/// smallest in x.
fn triangle(line: &[[f64; 2]], slope: f64) -> Option<[[f64; 2]; 3]> {
    let mut points = positive(line);
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let [_, a, b, ..] = points[..] else { return None };
    let low = 0.55 * a[1].min(b[1] / (b[0] / a[0]).powf(slope));
    Some([[a[0], low], [b[0], low], [b[0], low * (b[0] / a[0]).powf(slope)]])
}

fn draw(panel: &Panel, figure: &Figure, left: f64) -> Group {
    let is_log = figure.logarithmic;
    let drawn = |line: &Vec<[f64; 2]>| if is_log { positive(line) } else { line.clone() };
    let lines: Vec<Vec<[f64; 2]>> = panel.lines.iter().map(drawn).collect();
    let triangles: Vec<(f64, [[f64; 2]; 3])> = panel
        .slopes
        .iter()
        .filter_map(|&(line, slope)| Some((slope, triangle(panel.lines.get(line)?, slope)?)))
        .collect();
    let corners = triangles.iter().flat_map(|(_, corners)| corners);
    let all = || lines.iter().flatten().chain(corners.clone());
    let scaled = |p: Point| if is_log { p.map(f64::log10) } else { p };
    let range = |c: usize, page| {
        let numbers = all().map(|&p| scaled(p)[c]);
        let least = [0.0, LEAST][c];
        if is_log { logarithmic(numbers, page) } else { plain(numbers, least, page) }
    };
    let axes = Axes { x: range(0, [left, left + WIDTH]), y: range(1, [TOP + HEIGHT, TOP]) };
    let page = |p: Point| axes.at(scaled(p));
    let ticks = |axis: &PageAxis| match is_log {
        true => ticks(axis),
        false => numbers::ticks(axis.range[0], axis.range[1]),
    };
    // No half step between the numbers of steps.
    let whole = !is_log && all().all(|p| p[0].fract() == 0.0);
    let mut x_ticks = ticks(&axes.x);
    x_ticks.retain(|(x, _)| !whole || x.fract() == 0.0);
    let middle = left + WIDTH / 2.0;
    let mut group = Group::new()
        .add(anchored("middle", &*panel.title, [middle, TOP - 12.0]))
        .add(axes.grid([x_ticks, ticks(&axes.y)]))
        .add(axes.frame())
        .add(anchored("middle", &*figure.x_label, [middle, TOP + HEIGHT + 34.0]));
    for (slope, corners) in triangles {
        let [_, b, c] = corners.map(page);
        let mut triangle = PathData::default();
        triangle.polygon(corners.map(page));
        group.append(stroke(triangle, GREY, 1.0));
        let beside = text(short(slope, 3), [b[0] + 4.0, (b[1] + c[1]) / 2.0 + 4.0]);
        group.append(beside.set("font-size", 11).set("fill", GREY));
    }
    for (points, style) in lines.iter().zip(&figure.styles) {
        group.append(line(points.iter().map(|&p| page(p)), style));
        points.iter().for_each(|&p| group.append(mark(page(p), style)));
    }
    group
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(points: Vec<[f64; 2]>) -> Figure {
        Figure {
            title: "A < B".to_owned(),
            x_label: "h".to_owned(),
            logarithmic: true,
            panels: vec![Panel {
                title: "energy".to_owned(),
                lines: vec![points],
                slopes: vec![(0, 1.5)],
            }],
            styles: vec![Style { name: "P1".to_owned(), colour: COLOURS[0], dashed: false }],
        }
    }

    #[test]
    fn every_point_that_is_positive_has_its_mark_and_a_nan_is_refused() {
        // One mark more in the legend.
        for (first, marks) in [(1e-3, 4), (0.0, 3)] {
            let text = figure(&sample(vec![[0.1, first], [0.2, 3e-3], [0.4, 8e-3]])).unwrap();
            assert_eq!(text.matches("<circle").count(), marks);
            assert_eq!(text.contains("\n1.5\n"), marks == 4);
            assert!(text.contains("A &lt; B"));
        }
        for points in [vec![[0.1, 0.0]], vec![]] {
            assert!(figure(&sample(points)).is_ok());
        }
        let error = figure(&sample(vec![[0.1, f64::NAN]])).unwrap_err().to_string();
        assert_eq!(error, "energy: P1[0] is NaN or infinite; expected a finite number");
    }

    #[test]
    fn between_plain_axes_zero_and_negative_numbers_have_their_place() {
        let plain =
            Figure { logarithmic: false, ..sample(vec![[-0.2, 0.0], [-0.1, 2.0], [0.0, 3.0]]) };
        let text = figure(&plain).unwrap();
        // One mark more in the legend.
        assert_eq!(text.matches("<circle").count(), 4);
        assert!(text.contains("\n-0.1\n") && text.contains("\n2\n"), "{text}");
    }

    #[test]
    fn numbers_that_hardly_change_lie_beside_each_other_and_those_of_steps_are_whole() {
        // Ordinates of the marks of a line.
        let drawn = |points: Vec<[f64; 2]>| {
            let text = figure(&Figure { logarithmic: false, ..sample(points) }).unwrap();
            let y = |mark: &str| mark.split("cy=\"").nth(1)?.split('"').next()?.parse::<f64>().ok();
            let y: Vec<f64> = text.split("<circle").skip(1).filter_map(y).collect();
            ((y[0] - y[1]).abs(), text)
        };
        let (hardly, text) = drawn(vec![[1.0, 941.111], [2.0, 941.114]]);
        assert!(hardly < 1.0 && text.contains("\n2\n") && !text.contains("\n1.5\n"), "{text}");
        let (much, text) = drawn(vec![[1.0, 941.0], [2.5, 1000.0]]);
        assert!(much > 100.0 && text.contains("\n1.5\n"), "control: {text}");
    }

    #[test]
    fn entries_of_the_legend_do_not_run_into_each_other() {
        let mut sample = sample(vec![[0.1, 1e-3]]);
        sample.styles[0].name = "a name of some forty letters, or a few more".to_owned();
        sample.styles.push(sample.styles[0].clone());
        let text = figure(&sample).unwrap();
        let mut places = text.split(sample.styles[0].name.as_str()).map(|before| {
            before.rsplit(" y=\"").next().and_then(|y| y.split('"').next()?.parse::<f64>().ok())
        });
        let (first, second) = (places.next().flatten().unwrap(), places.next().flatten().unwrap());
        assert_eq!(second - first, LEGEND_LINE);
    }

    #[test]
    fn a_slope_triangle_lies_below_its_line() {
        let line = [[0.1, 1.0], [0.2, 2.0], [0.4, 4.0]];
        let [a, b, c] = triangle(&line, 1.0).unwrap();
        assert_eq!([a[0], b[0], c[0]], [0.2, 0.4, 0.4]);
        assert!(a[1] < 2.0 && c[1] < 4.0 && (c[1] / a[1] - 2.0).abs() < 1e-15);
    }
}
