//! The figure of Theorem 7.2 in docs/theory.md, drawn from three points of a plane for which the theorem holds.

use std::fs;
use std::path::Path;

/// C eps(v), tau and sigma(u).
const V: [f64; 2] = [90.0, 240.0];
const TAU: [f64; 2] = [370.0, 240.0];
const SIGMA: [f64; 2] = [166.0, 106.0];

/// int tau_n (v_n - g) over Gamma_C.
const WORK: f64 = 7500.0;

fn distance([a, b]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    (a - x).hypot(b - y)
}

/// (C eps(v) + tau) / 2
fn mean() -> [f64; 2] {
    [0, 1].map(|c| (V[c] + TAU[c]) / 2.0)
}

/// M^2 = |C eps(v) - tau|^2 / 4 + the work
fn radius() -> f64 {
    (distance(V, TAU).powi(2) / 4.0 + WORK).sqrt()
}

const KNOWN: &str = "#0072b2";
const UNKNOWN: &str = "#d55e00";
const GREY: &str = "#666666";

fn line([a, b]: [f64; 2], [x, y]: [f64; 2], style: &str) -> String {
    format!("<path d=\"M{a} {b}L{x} {y}\" fill=\"none\" {style}/>\n")
}

fn circle([x, y]: [f64; 2], r: f64, style: &str) -> String {
    format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r:.1}\" {style}/>\n")
}

fn text([x, y]: [f64; 2], colour: &str, words: &str) -> String {
    format!("<text x=\"{x}\" y=\"{y}\" fill=\"{colour}\">{words}</text>\n")
}

fn figure() -> String {
    let m = mean();
    let mut figure = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"40 55 740 370\" font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\" font-size=\"15\">\n<rect x=\"40\" y=\"55\" width=\"100%\" height=\"100%\" fill=\"white\"/>\n".to_owned();
    figure += &circle(m, radius(), "fill=\"#f4f4f4\" stroke=\"#222222\"");
    let thales = format!("fill=\"none\" stroke=\"{GREY}\" stroke-dasharray=\"2 4\"");
    figure += &circle(m, distance(V, TAU) / 2.0, &thales);
    figure += &line(V, TAU, &format!("stroke=\"{KNOWN}\" stroke-width=\"2\""));
    let bounded = format!("stroke=\"{UNKNOWN}\" stroke-width=\"2\" stroke-dasharray=\"7 4\"");
    figure += &(line(V, SIGMA, &bounded) + &line(SIGMA, TAU, &bounded));
    figure += &line(m, SIGMA, &format!("stroke=\"{GREY}\""));
    for (point, colour) in [(V, KNOWN), (TAU, KNOWN), (m, KNOWN), (SIGMA, UNKNOWN)] {
        figure += &circle(point, 4.5, &format!("fill=\"{colour}\""));
    }
    for (place, colour, words) in [
        ([98.0, 260.0], KNOWN, "Cε(v)"),
        ([346.0, 260.0], KNOWN, "τ"),
        ([226.0, 262.0], KNOWN, "m"),
        ([178.0, 101.0], UNKNOWN, "σ(u)"),
        ([206.0, 172.0], GREY, "≤ M"),
        ([448.0, 90.0], KNOWN, "known: Cε(v) and τ, their distance"),
        ([448.0, 112.0], KNOWN, "and their mean m = (Cε(v) + τ) / 2"),
        ([448.0, 148.0], UNKNOWN, "unknown: σ(u); bounded: its distances"),
        ([448.0, 170.0], UNKNOWN, "|u − v| from Cε(v) and |σ(u) − τ| from τ"),
        ([448.0, 206.0], GREY, "no contact: a right angle at σ(u),"),
        ([448.0, 228.0], GREY, "which lies on the dotted sphere"),
        ([448.0, 264.0], "#222222", "contact: σ(u) lies in the ball around m,"),
        ([448.0, 286.0], "#222222", "M² = A/4 + B/2, where"),
        ([448.0, 308.0], "#222222", "A = |Cε(v) − τ|² ≥ 0,"),
        ([448.0, 330.0], "#222222", "B = 2 ∫ τₙ (vₙ − g) ≥ 0"),
    ] {
        figure += &text(place, colour, words);
    }
    figure + "</svg>\n"
}

#[test]
fn the_figure_of_theorem_7_2_is_of_points_for_which_it_holds_and_is_the_one_on_the_page() {
    let [to_v, to_tau, apart] = [distance(SIGMA, V), distance(SIGMA, TAU), distance(V, TAU)];
    let bound = apart.powi(2) + 2.0 * WORK;
    assert!(to_v.powi(2) + to_tau.powi(2) <= bound && distance(SIGMA, mean()) <= radius());
    // With the point on the page the bound without contact is too small.
    assert!(to_v.powi(2) + to_tau.powi(2) > apart.powi(2));
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/figures/hypercircle.svg");
    let drawn = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hypercircle.svg");
    fs::write(&drawn, figure()).unwrap();
    let same = fs::read_to_string(&page).is_ok_and(|text| text == figure());
    assert!(same, "copy {} to {}", drawn.display(), page.display());
}
