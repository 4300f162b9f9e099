//! docs/speed.svg: time and peak memory against the number of unknowns, both axes logarithmic.

use svg::Document;
use svg::node::element::{Circle, Group, Line, Polyline, Rectangle, Text};

use crate::own::{Measured, squares};
use crate::peers::OnBody;

const WIDTH: f64 = 330.0;
const HEIGHT: f64 = 260.0;
const LEFT: f64 = 70.0;
const TOP: f64 = 40.0;
/// From one panel to the next.
const STRIDE: f64 = WIDTH + 90.0;

struct Curve {
    name: String,
    colour: &'static str,
    dashed: bool,
    points: Vec<(f64, f64)>,
}

struct Panel {
    title: &'static str,
    curves: Vec<Curve>,
    /// Other codes.
    marks: Vec<(f64, f64)>,
    unit: fn(i32) -> String,
}

/// The figure.
pub fn draw(own: &[Measured], rivals: &[OnBody]) -> String {
    let curve = |name: &str, degree: usize, dashed: bool, of: &dyn Fn(&Measured) -> f64| Curve {
        name: format!("{name}, P{degree}"),
        colour: if degree == 1 { "#0072b2" } else { "#d55e00" },
        dashed,
        points: squares(own, degree).map(|m| (m.unknowns as f64, of(m))).collect(),
    };
    let contact = |m: &Measured| m.contact.as_secs_f64();
    let linear = |m: &Measured| m.linear.as_secs_f64();
    let others =
        rivals.iter().flat_map(OnBody::runs).filter(|r| r.degree == 1 && r.name != "signorini");
    let time = Panel {
        title: "time",
        curves: vec![
            curve("contact solve", 1, false, &contact),
            curve("linear solve", 1, true, &linear),
            curve("contact solve", 2, false, &contact),
            curve("linear solve", 2, true, &linear),
        ],
        marks: others.map(|r| (r.unknowns as f64, r.contact)).collect(),
        unit: |k| match k {
            0.. => format!("{} s", 10_i32.pow(k.unsigned_abs())),
            -3..0 => format!("{} ms", 10_i32.pow((k + 3).unsigned_abs())),
            _ => format!("1e{k} s"),
        },
    };
    let memory = Panel {
        title: "peak memory",
        curves: [1, 2].map(|p| curve("contact solve", p, false, &|m: &Measured| m.memory)).into(),
        marks: Vec::new(),
        unit: |k| match k {
            9.. => format!("{} GB", 10_i32.pow((k - 9).unsigned_abs())),
            6..9 => format!("{} MB", 10_i32.pow((k - 6).unsigned_abs())),
            _ => format!("1e{k} B"),
        },
    };
    let background =
        Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white");
    Document::new()
        .set("viewBox", (0, 0, LEFT + STRIDE + WIDTH + 40.0, TOP + HEIGHT + 50.0))
        .set("font-family", "sans-serif")
        .set("font-size", 12)
        .add(background)
        .add(panel(&time, LEFT))
        .add(panel(&memory, LEFT + STRIDE))
        .to_string()
}

/// Powers of ten around the values.
fn decades(values: impl Iterator<Item = f64>) -> (i32, i32) {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    let low = low.log10().floor() as i32;
    (low, (high.log10().ceil() as i32).max(low + 1))
}

fn panel(panel: &Panel, left: f64) -> Group {
    let all = || panel.curves.iter().flat_map(|c| &c.points).chain(&panel.marks);
    let (x0, x1) = decades(all().map(|p| p.0));
    let (y0, y1) = decades(all().map(|p| p.1));
    let share = |v: f64, low: i32, high: i32| (v.log10() - f64::from(low)) / f64::from(high - low);
    let x = |v: f64| left + WIDTH * share(v, x0, x1);
    let y = |v: f64| TOP + HEIGHT * (1.0 - share(v, y0, y1));
    let mut group = Group::new().add(text(panel.title, left, TOP - 14.0, "start"));
    for k in x0..=x1 {
        let at = x(10_f64.powi(k));
        group = group.add(rule(at, TOP, at, TOP + HEIGHT));
        group = group.add(text(&power(k), at, TOP + HEIGHT + 18.0, "middle"));
    }
    for k in y0..=y1 {
        let at = y(10_f64.powi(k));
        group = group.add(rule(left, at, left + WIDTH, at));
        group = group.add(text(&(panel.unit)(k), left - 8.0, at + 4.0, "end"));
    }
    group = group.add(text("unknowns", left + WIDTH, TOP + HEIGHT + 36.0, "end"));
    for &(u, v) in &panel.marks {
        group = group.add(circle(x(u), y(v), "none").set("stroke", "#888888"));
    }
    for curve in &panel.curves {
        let points: Vec<(f64, f64)> = curve.points.iter().map(|&(u, v)| (x(u), y(v))).collect();
        group = group.add(polyline(&points, curve));
        for &(u, v) in &points {
            group = group.add(circle(u, v, curve.colour));
        }
    }
    legend(group, panel, left + 160.0)
}

/// In the lower right corner, where no curve comes.
fn legend(mut group: Group, panel: &Panel, left: f64) -> Group {
    let row = |k: usize| TOP + HEIGHT - 12.0 - 16.0 * k as f64;
    for (k, curve) in panel.curves.iter().rev().enumerate() {
        group = group.add(polyline(&[(left, row(k)), (left + 24.0, row(k))], curve));
        group = group.add(text(&curve.name, left + 32.0, row(k) + 4.0, "start"));
    }
    if !panel.marks.is_empty() {
        let at = row(panel.curves.len());
        group = group.add(circle(left + 12.0, at, "none").set("stroke", "#888888"));
        group = group.add(text("other codes, P1", left + 32.0, at + 4.0, "start"));
    }
    group
}

fn power(k: i32) -> String {
    match k {
        0..6 => 10_i32.pow(k.unsigned_abs()).to_string(),
        _ => format!("{} million", 10_i32.pow((k - 6).max(0).unsigned_abs())),
    }
}

fn text(content: &str, x: f64, y: f64, anchor: &str) -> Text {
    Text::new(content).set("x", short(x)).set("y", short(y)).set("text-anchor", anchor)
}

fn rule(x1: f64, y1: f64, x2: f64, y2: f64) -> Line {
    let ends = [("x1", x1), ("y1", y1), ("x2", x2), ("y2", y2)];
    ends.into_iter()
        .fold(Line::new().set("stroke", "#dddddd"), |line, (name, v)| line.set(name, short(v)))
}

fn circle(x: f64, y: f64, fill: &str) -> Circle {
    Circle::new().set("cx", short(x)).set("cy", short(y)).set("r", 3).set("fill", fill)
}

fn polyline(points: &[(f64, f64)], curve: &Curve) -> Polyline {
    let points: Vec<String> =
        points.iter().map(|&(x, y)| format!("{},{}", short(x), short(y))).collect();
    let line = Polyline::new()
        .set("points", points.join(" "))
        .set("fill", "none")
        .set("stroke", curve.colour)
        .set("stroke-width", 2);
    if curve.dashed { line.set("stroke-dasharray", "5 4") } else { line }
}

/// Two decimals are plenty on the page.
fn short(x: f64) -> f64 {
    (100.0 * x).round() / 100.0
}
