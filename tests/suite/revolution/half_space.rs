//! A rigid indenter on a half space, on the block r <= 2 a, z <= 2 a with the exact displacement on its far sides: no part of the
//! error is that of a body that ends. The displacement is that of a pressure on r < a as an integral over sources at the complex depths
//! z + i a t with the weight w(t):
//!
//! u_r = F / (4 pi mu) Re int w (z r / R^3 - (1 - 2 nu) r / (R (R + zeta))) dt,   zeta = z + i a t,   R = (r^2 + zeta^2)^(1/2)
//! u_z = F / (4 pi mu) Re int w (z zeta / R^3 + 2 (1 - nu) / R) dt

use std::f64::consts::{PI, TAU};

use approx::assert_abs_diff_eq;
use signorini::model::quadrature::gauss;
use signorini::model::{Condition, Degree, Mesh, Problem};
use signorini::results::Solution;

use super::*;

const POISSON: f64 = 0.3;

type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn over(a: Complex, b: Complex) -> Complex {
    let size = b[0] * b[0] + b[1] * b[1];
    times(a, [b[0] / size, -b[1] / size])
}

/// The root with a positive real part.
fn root(a: Complex) -> Complex {
    let size = a[0].hypot(a[1]);
    [((size + a[0]) / 2.0).sqrt(), ((size - a[0]) / 2.0).sqrt().copysign(a[1])]
}

/// The displacement for a = 1 and F = 1; E = 1.
fn displacement([r, z]: [f64; 2], rule: &[(f64, f64)], weight: fn(f64) -> f64) -> [f64; 2] {
    let mu = 1.0 / (2.0 * (1.0 + POISSON));
    let mut sum = [0.0; 2];
    for &(t, w) in rule {
        let zeta = [z, t];
        let square = times(zeta, zeta);
        let distance = root([r * r + square[0], square[1]]);
        let cube = times(times(distance, distance), distance);
        let below = times(distance, [distance[0] + zeta[0], distance[1] + zeta[1]]);
        let bulge = over([z * r, 0.0], cube)[0];
        let radial = bulge - (1.0 - 2.0 * POISSON) * over([r, 0.0], below)[0];
        let axial = over([z * zeta[0], z * zeta[1]], cube)[0];
        let axial = axial + 2.0 * (1.0 - POISSON) * over([1.0, 0.0], distance)[0];
        // The integrand is even in t.
        let w = 2.0 * w * weight(t);
        sum = [sum[0] + w * radial, sum[1] + w * axial];
    }
    sum.map(|u| u / (4.0 * PI * mu))
}

/// That of Hertz's pressure.
pub(super) fn hertz_displacement(at: [f64; 2]) -> [f64; 2] {
    displacement(at, &gauss(60), |t| 3.0 * (1.0 - t * t) / 4.0)
}

/// The block with n cells along a, the indenter below it, which reaches `depth` deep into it at r = 0; contact where r < `reach`.
fn indented(
    n: usize,
    degree: Degree,
    (force, weight): (f64, fn(f64) -> f64),
    gap: fn(f64) -> f64,
    reach: f64,
) -> Solution {
    let whole = meridian([0.0, 2.0], 2.0, [2 * n, 2 * n], false);
    let mut named = named_edges(&whole);
    let pressed = |ends: &[usize; 2]| ends.iter().all(|&v| whole.vertices()[v][0] <= reach + 1e-9);
    let (below, _): (Vec<_>, Vec<_>) = named["bottom"].iter().copied().partition(pressed);
    named.insert("bottom".to_owned(), below);
    let mesh = Mesh::new(whole.vertices().to_vec(), whole.triangles().to_vec(), named).unwrap();
    let rule = gauss(60);
    let far = || {
        let (x, y) = (rule.clone(), rule.clone());
        Condition::displacement(
            move |at| force * displacement(at, &x, weight)[0],
            move |at| force * displacement(at, &y, weight)[1],
        )
    };
    let problem = Problem::of(mesh, elastic(1.0, POISSON))
        .with("top", far())
        .with("right", far())
        .with("bottom", Condition::contact(move |[r, _]| gap(r)));
    solved(&problem, degree)
}

const REDUCED: f64 = 1.0 / (1.0 - POISSON * POISSON);

/// R = 20, a = 1: F = 4 E* a^3 / (3 R), and the depth is a^2 / R.
pub(super) fn hertz(n: usize, degree: Degree) -> Solution {
    let force = 4.0 * REDUCED / (3.0 * 20.0);
    let weight = |t: f64| 3.0 * (1.0 - t * t) / 4.0;
    indented(n, degree, (force, weight), |r| (r * r / 2.0 - 1.0) / 20.0, 2.0)
}

fn force_of(s: &Solution) -> f64 {
    s.quantities.contact_force
}

/// Force, peak of the recovered pressure and -lambda^h at the node on the axis, over Hertz's.
pub(super) fn beside_hertz(n: usize, degree: Degree) -> [f64; 3] {
    let force = 4.0 * REDUCED / (3.0 * 20.0);
    let peak = 2.0 * REDUCED / (PI * 20.0);
    let s = hertz(n, degree);
    let points = s.contact.iter().flat_map(|edge| &edge.points);
    let on_axis = points.filter(|p| p.place[0] == 0.0).map(|p| -p.lambda);
    let on_axis = on_axis.fold(0.0, f64::max);
    [force_of(&s) / force, s.boundaries[0].peak_pressure / peak, on_axis / peak]
}

#[test]
fn a_paraboloid_presses_as_hertz_says() {
    for (n, degree, tolerance, of_peak) in
        [(16, Degree::One, 3e-3, 0.02), (8, Degree::Two, 3e-4, 0.02)]
    {
        let [force, peak, _] = beside_hertz(n, degree);
        assert_abs_diff_eq!(force, 1.0, epsilon = tolerance);
        // Not at the node on the axis alone, where a pressure has no weight: the recovered one is a mean.
        assert_abs_diff_eq!(peak, 1.0, epsilon = of_peak);
    }
}

/// The control: by the formula for a line contact, F = pi E* a^2 / (4 R) a unit of length, nothing fits.
#[test]
fn control_hertz_of_a_cylinder_is_not_that_of_a_sphere() {
    let s = hertz(8, Degree::One);
    assert!((force_of(&s) / (PI * REDUCED / (4.0 * 20.0)) - 1.0).abs() > 0.3);
}

#[test]
fn a_flat_punch_presses_by_twice_its_radius_and_depth() {
    // Of first order: the pressure is infinite at the edge.
    assert_abs_diff_eq!(flat_punch(16, Degree::Two), 1.0, epsilon = 7e-3);
}

/// The force over 2 a E* times the depth.
pub(super) fn flat_punch(n: usize, degree: Degree) -> f64 {
    let force = 2.0 * REDUCED * 0.05;
    force_of(&indented(n, degree, (force, |_| 0.5), |_| -0.05, 1.0)) / force
}

/// P / gamma at the nodes of an edge, of lambda^h, u_n - g and sigma_n there: also where that is negative, and lambda^h is 0.
pub(super) fn before_the_cut(values: impl Iterator<Item = [f64; 3]> + Clone) -> Vec<f64> {
    let gamma = values.clone().find(|[lambda, ..]| *lambda < 0.0);
    let gamma = gamma.map(|[lambda, over, normal]| over / (normal - lambda));
    let at = |[_, over, normal]: [f64; 3]| gamma.map_or(0.0, |gamma| over / gamma - normal);
    values.map(at).collect()
}

/// The integral over the edges of r f(r, pressure), of the pressure's values at the nodes of each edge, (r, value).
fn over_edges(edges: impl Iterator<Item = Vec<(f64, f64)>>, f: impl Fn(f64, f64) -> f64) -> f64 {
    let rule = gauss(4);
    let mut integral = 0.0;
    for edge in edges {
        let (from, to) = (edge[0].0, edge[edge.len() - 1].0);
        for &(s, weight) in &rule {
            // The values at 0, (1/2,) 1.
            let pressure = match edge[..] {
                [(_, p), (_, q)] => p * (1.0 - s) + q * s,
                [(_, p), (_, m), (_, q)] => {
                    p * (1.0 - s) * (1.0 - 2.0 * s)
                        + 4.0 * m * s * (1.0 - s)
                        + q * s * (2.0 * s - 1.0)
                }
                _ => panic!("{} nodes on an edge", edge.len()),
            };
            let r = from + (to - from) * s;
            integral += weight * (to - from).abs() * r * f(r, pressure.max(0.0));
        }
    }
    integral
}

/// a by a^2 = 5/2 of the mean of r^2 with the pressure -lambda^h, for which no end of contact has to be found.
pub(super) fn contact_radius(edges: impl Iterator<Item = Vec<(f64, f64)>>, force: f64) -> f64 {
    (2.5 * TAU * over_edges(edges, |r, pressure| r * r * pressure) / force).sqrt()
}

/// The pressure before the cut at the nodes of each edge, with their radii.
fn pressures(s: &Solution) -> impl Iterator<Item = Vec<(f64, f64)>> {
    s.contact.iter().map(|edge| {
        let values = edge.points.iter().map(|p| [p.lambda, p.u_n - p.gap, p.sigma_n]);
        let radii = edge.points.iter().map(|p| p.place[0]);
        radii.zip(before_the_cut(values)).collect()
    })
}

/// The L^2 norm with the weight r of [P]+ / gamma less Hertz's pressure p0 (1 - r^2)^(1/2), over that of Hertz's.
pub(super) fn off_hertz(n: usize, degree: Degree) -> f64 {
    let peak = 2.0 * REDUCED / (PI * 20.0);
    let s = hertz(n, degree);
    let square = over_edges(pressures(&s), |r, pressure| {
        (pressure - peak * (1.0 - r * r).max(0.0).sqrt()).powi(2)
    });
    // The integral of r (1 - r^2) is 1/4.
    square.sqrt() / (peak / 2.0)
}

#[test]
fn the_pressure_converges_in_the_mean_with_order_one() {
    for (sizes, degree) in [([8, 16], Degree::One), ([4, 8], Degree::Two)] {
        let [coarse, fine] = sizes.map(|n| off_hertz(n, degree));
        // The root at the end of contact leaves an order next to 1 to both degrees.
        assert!((0.7..1.2).contains(&(coarse / fine).log2()), "{coarse:e} {fine:e}");
    }
}

/// The ball between two plates of cases/sphere.toml, by its force: peak pressure, contact radius and approach as Hertz and Tatara say.
#[test]
fn a_ball_between_plates_has_hertzs_pressure_and_tataras_approach() {
    const RADIUS: f64 = 10.0;
    let reduced = 210_000.0 / (1.0 - 0.09);
    for (degree, of_peak, of_radius, of_approach) in [(1, 0.01, 0.01, 6e-3), (2, 3e-3, 3e-3, 3e-3)]
    {
        let case = case("sphere.toml", &[&format!("method.degree={degree}")]);
        let settings = Settings { proof: ENCLOSED, ..case.settings };
        let (s, _) = solve(&case.problem, &case.method, &settings).unwrap();
        let enclosed = s.enclosure.as_ref().unwrap().relative.unwrap();
        assert!(enclosed <= ENCLOSED, "{enclosed:e}");
        let force = force_of(&s);
        let a = (3.0 * force * RADIUS / (4.0 * reduced)).cbrt();
        let peak = 3.0 * force / (2.0 * PI * a * a);
        assert_abs_diff_eq!(s.boundaries[0].peak_pressure / peak, 1.0, epsilon = of_peak);
        let found = contact_radius(pressures(&s), force);
        assert_abs_diff_eq!(found / a, 1.0, epsilon = of_radius);
        let far = a * a + 4.0 * RADIUS * RADIUS;
        let f = 2.0 * 1.3 * RADIUS * RADIUS / far.powf(1.5) + 0.91 / far.sqrt();
        let approach = a * a / RADIUS - force * f / (PI * 210_000.0);
        assert_abs_diff_eq!(0.024_545 / approach, 1.0, epsilon = of_approach);
        // Without the other side of the ball the approach is off by more: the control.
        assert!((0.024_545 / (a * a / RADIUS) - 1.0).abs() > 0.012);
    }
}
