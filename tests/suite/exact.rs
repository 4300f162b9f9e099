//! The exact solutions, each verified by itself: the gradient is that of the displacement, the stress is in equilibrium
//! with the body force, conditions (2) hold along Gamma_C, the boundary data are what section 10 of docs/theory.md says.
//! Then the integrals that are taken of them.
//!
//! Derivatives are enclosed: a central difference of order 8 with the step d/20, d being the distance to the nearest point
//! where the solution is not smooth, differs from the derivative by less than it differs from the one with twice the step
//! (whose error is 2^8 times larger), plus rounding: some 30 roundoffs of the largest value in the body over the step.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use approx::{abs_diff_eq, assert_relative_eq};

use crate::common::exact::{corner, on_square, on_trapezoid, singular, smooth};
use crate::common::{Random, root};
use signorini::exact::errors::POINTS;
use signorini::exact::{Corner, Patch, Singular, Smooth};
use signorini::exact::{Errors, Exact};
use signorini::io::Case;
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::Space;
use signorini::nalgebra::{Matrix2, Vector2};
use study::{SlipTip, StickSlip};

/// A solution, its name, and its body: the unit square, or the wedge 0 < theta < omega.
struct Sample {
    name: String,
    solution: Exact,
    omega: Option<f64>,
}

fn samples() -> Vec<Sample> {
    let materials = [
        ("lambda = mu = 1", Material::lame(1.0, 1.0, Plane::Strain)),
        ("lambda = 3, mu = 0.7", Material::lame(3.0, 0.7, Plane::Strain)),
        ("lambda = -0.4, mu = 1", Material::lame(-0.4, 1.0, Plane::Strain)),
        ("plane stress", Material::lame(3.0, 0.7, Plane::Stress)),
    ];
    let mut all = Vec::new();
    for (what, material) in materials {
        let mut add = |name: &str, solution: Exact, omega| {
            all.push(Sample { name: format!("{name}, {what}"), solution, omega });
        };
        for (k, m, c, gap) in [
            (3.0, 2.0, 1.0 / 3.0, vec![]),
            (4.0, 3.0, 0.5, vec![]),
            (2.6, 1.7, 0.4, vec![]),
            (4.0, 3.0, 1.0 / 3.0, vec![0.2, -0.3, 0.5, 0.1, 0.7]),
        ] {
            let name = format!("smooth {k} {m} c = {c} gap {gap:?}");
            add(&name, Arc::new(Smooth { material, c, k, m, ap: 8.0, aq: 4.0, gap }), None);
        }
        for c in [0.5, 1.0 / 3.0] {
            add("singular", Arc::new(Singular { material, c, amplitude: 2.0 }), None);
            let (bound, pressure) = (0.05, 0.5);
            let tip = SlipTip { material, c, amplitude: 0.02, bound, pressure };
            add("slip tip", Arc::new(tip), None);
            let smooth =
                StickSlip { material, c, k: 4.0, m: 3.0, a: 16.0, b: 0.2, bound, pressure };
            add("stick slip", Arc::new(smooth), None);
        }
        for omega in [0.75 * PI, 2.0 / 3.0 * PI, 0.6 * PI] {
            let corner = Corner::new(material, omega).unwrap();
            add(&format!("corner {omega}"), Arc::new(corner), Some(omega));
        }
        add("d1", Arc::new(Patch::compression(material, 0.3)), None);
        add("d2", Arc::new(Patch::separation(material, 0.3, 0.1)), None);
        add("d3", Arc::new(Patch::inclined(material, 0.3, 0.2, 0.1)), None);
        add("d4", Arc::new(Patch::grazing(material)), None);
        add("d5", Arc::new(Patch::interference(material, 0.1)), None);
    }
    all
}

/// The distance to the nearest point where the solution is not smooth; y = 0 counts as one, for the fields need not go on
/// below it.
fn clearance(sample: &Sample, [x, y]: [f64; 2]) -> f64 {
    let features = sample.solution.features();
    let to_kink = features.kink.map_or(1.0, |c| (x - c).abs());
    let to_point = features.singular.map_or(1.0, |s| (x - s.point[0]).hypot(y - s.point[1]));
    to_kink.min(to_point).min(y).min(1.0)
}

/// Random points inside the body, away from where the solution is not smooth.
fn points(sample: &Sample, random: &mut Random, count: usize) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    while found.len() < count {
        let [s, t] = [0, 1].map(|_| (random.next() + 1.0) / 2.0);
        let x = match sample.omega {
            Some(omega) => [s + (1.0 - s) * t / omega.tan(), t],
            None => [s, t],
        };
        if clearance(sample, x) > 0.02 {
            found.push(x);
        }
    }
    found
}

/// The derivative of f at 0 by the central difference of order 8.
fn difference(f: impl Fn(f64) -> f64, h: f64) -> f64 {
    let pair = |k: f64| f(k * h) - f(-k * h);
    (4.0 / 5.0 * pair(1.0) - pair(2.0) / 5.0 + 4.0 / 105.0 * pair(3.0) - pair(4.0) / 280.0) / h
}

/// The derivative of f, with a bound of the error; `size` is that of the numbers that f is computed from.
fn derivative(f: impl Fn(f64) -> f64, clearance: f64, size: f64) -> (f64, f64) {
    let h = clearance / 20.0;
    let (fine, coarse) = (difference(&f, h), difference(&f, 2.0 * h));
    let largest = (-8..=8).map(|k| f(f64::from(k) * h).abs()).fold(size, f64::max);
    (fine, (fine - coarse).abs() + 30.0 * f64::EPSILON * largest / h)
}

fn along(x: [f64; 2], j: usize, t: f64) -> [f64; 2] {
    if j == 0 { [x[0] + t, x[1]] } else { [x[0], x[1] + t] }
}

#[test]
fn the_gradient_is_that_of_the_displacement() {
    let mut random = Random(1);
    for sample in samples() {
        for x in points(&sample, &mut random, 50) {
            let gradient = sample.solution.gradient(x);
            for i in 0..2 {
                for j in 0..2 {
                    let u = |t: f64| sample.solution.displacement(along(x, j, t))[i];
                    // No displacement of the samples is much larger than 1.
                    let (value, bound) = derivative(u, clearance(&sample, x), 1.0);
                    let off = (gradient[(i, j)] - value).abs();
                    assert!(
                        bound < 1e-6 / clearance(&sample, x),
                        "{} {x:?}: {bound:e}",
                        sample.name
                    );
                    assert!(off <= bound, "{} {x:?}: {off:e}", sample.name);
                }
            }
        }
    }
}

/// The largest part of div sigma + f that the enclosure doesn't explain, over random points: 0 in equilibrium.
fn out_of_balance(sample: &Sample, force_factor: f64) -> f64 {
    let mut random = Random(2);
    let mut worst: f64 = 0.0;
    for x in points(sample, &mut random, 50) {
        let clear = clearance(sample, x);
        let stress = |j: usize, t: f64| sample.solution.stress(along(x, j, t)).components();
        let f = sample.solution.body_force(x).unwrap_or_default();
        let size = stress(0, 0.0).iter().map(|s| s.abs()).sum::<f64>() + 1.0;
        let [xx, yy, xy] = [0, 1, 2];
        let (xx_x, a) = derivative(|t| stress(0, t)[xx], clear, size);
        let (xy_y, b) = derivative(|t| stress(1, t)[xy], clear, size);
        let (xy_x, c) = derivative(|t| stress(0, t)[xy], clear, size);
        let (yy_y, d) = derivative(|t| stress(1, t)[yy], clear, size);
        let sharp = a + b + c + d < 1e-5 * size / clear;
        assert!(sharp, "{} {x:?}: {:e}", sample.name, a + b + c + d);
        let rounding = 1e-13 * (f[0].abs() + f[1].abs());
        worst = worst.max((xx_x + xy_y + force_factor * f[0]).abs() - a - b - rounding);
        worst = worst.max((xy_x + yy_y + force_factor * f[1]).abs() - c - d - rounding);
    }
    worst
}

#[test]
fn stresses_are_in_equilibrium_with_the_body_force() {
    for sample in samples() {
        assert!(out_of_balance(&sample, 1.0) <= 0.0, "{}", sample.name);
    }
}

#[test]
fn control_a_body_force_that_is_off_by_a_millionth_is_out_of_balance() {
    for sample in samples().iter().filter(|s| s.name.starts_with("smooth")) {
        assert!(out_of_balance(sample, 1.0 + 1e-6) > 0.0, "{}", sample.name);
    }
}

/// The normal of Gamma_C.
const N: Vector2<f64> = Vector2::new(0.0, -1.0);

/// How far conditions (2)(i)-(iv) are from holding at (x, 0), relative to the sizes of the numbers that enter, and whether
/// there is pressure and whether there is a gap.
fn contact(solution: &Exact, x: f64) -> (f64, bool, bool) {
    let x = [x, 0.0];
    let gap = solution.gap(x);
    let opening = -solution.displacement(x)[1] - gap;
    let stress = solution.stress(x);
    let sigma_n = stress.normal(N);
    let [xx, yy, xy] = stress.components();
    let size = xx.abs() + yy.abs() + xy.abs() + 1.0;
    let length = gap.abs() + 1.0;
    let worst = (opening / length)
        .max(sigma_n / size)
        .max(sigma_n.abs() * opening.abs() / (size * length))
        .max(friction(solution, x) / size);
    (worst, sigma_n < -1e-9, opening < -1e-9)
}

/// How far Tresca's law is from holding at (x, 0): |sigma_xy| <= s, and s |u_x| = sigma_xy u_x; s is 0 without friction.
fn friction(solution: &Exact, x: [f64; 2]) -> f64 {
    let [.., shear] = solution.stress(x).components();
    let (bound, [slip, _]) = (solution.slip_bound().unwrap_or(0.0), solution.displacement(x));
    let over = shear.abs() - bound;
    if bound == 0.0 { over } else { over.max(bound * slip.abs() - shear * slip) }
}

#[test]
fn conditions_2_hold_along_the_contact_line() {
    for Sample { name, solution, .. } in samples() {
        let (mut pressed, mut open) = (0, 0);
        for i in 1..1000 {
            let (worst, pressure, gap) = contact(&solution, f64::from(i) / 1000.0);
            assert!(worst <= 1e-14, "{name}: {worst:e} at x = {}", f64::from(i) / 1000.0);
            pressed += i32::from(pressure);
            open += i32::from(gap);
        }
        if solution.slip_bound().is_some() {
            let slips = |i: i32| solution.displacement([f64::from(i) / 1000.0, 0.0])[0] > 1e-9;
            let slipping = (1..1000).filter(|&i| slips(i)).count();
            // (e) and (f) have a real change between sticking and sliding.
            assert!(pressed == 999 && (400..750).contains(&slipping), "{name}: {slipping}");
            continue;
        }
        // (a) and (b) have a real change between contact and gap.
        if solution.features().kink.is_some() || name.starts_with("singular") {
            assert!(pressed > 250 && open > 400, "{name}: {pressed} {open}");
        }
        if name.starts_with("corner") {
            assert_eq!(pressed, 999, "{name}");
        }
    }
}

#[test]
fn control_a_tension_amplitude_of_the_wrong_sign_breaks_the_contact_conditions() {
    let tension: Exact = Arc::new(Singular {
        material: Material::lame(1.0, 1.0, Plane::Strain),
        c: 0.5,
        amplitude: -1.0,
    });
    assert!((1..1000).any(|i| contact(&tension, f64::from(i) / 1000.0).0 > 0.1));
}

#[test]
fn control_friction_with_the_wrong_sign_or_over_its_bound_breaks_trescas_law() {
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    let tip = SlipTip { material, c: 0.5, amplitude: 0.02, bound: 0.05, pressure: 0.5 };
    let fails = |tip: SlipTip| {
        let tip: Exact = Arc::new(tip);
        (1..1000).any(|i| contact(&tip, f64::from(i) / 1000.0).0 > 1e-4)
    };
    assert!(!fails(tip.clone()));
    assert!(fails(SlipTip { amplitude: -0.02, ..tip.clone() }));
    assert!(fails(SlipTip { amplitude: 0.06, ..tip }));
}

#[test]
fn boundary_data_are_what_the_theory_says() {
    for Sample { name, solution, omega } in samples() {
        for i in 1..100 {
            let t = f64::from(i) / 100.0;
            if name.starts_with("smooth") {
                let u = solution.displacement([t, 1.0]);
                // A few terms of size 1 cancel.
                let clamped = abs_diff_eq!(u[..], [0.0; 2][..], epsilon = 1e-14);
                assert!(clamped, "{name}: clamped on top");
            }
            if name.starts_with("d1") || name.starts_with("d3") {
                let pull = solution.stress([1.0, t]).traction(Vector2::x());
                // Two terms of size 1 cancel.
                let free = abs_diff_eq!(pull, Vector2::zeros(), epsilon = 1e-15);
                assert!(free, "{name}: free on the right");
            }
            if let Some(omega) = omega {
                // The normal of the ray theta = omega.
                let n = Vector2::new(-omega.sin(), omega.cos());
                let x = [t * omega.cos(), t * omega.sin()];
                let pull = solution.stress(x).traction(n);
                let [xx, yy, _] = solution.stress(x).components();
                let size = xx.abs() + yy.abs();
                // The exponent solves its equation to rounding, which the powers and sines enlarge.
                let free = abs_diff_eq!(pull, Vector2::zeros(), epsilon = 1e-13 * size);
                assert!(free, "{name}: free where it leans");
            }
        }
    }
}

#[test]
fn values_agree_with_those_computed_elsewhere() {
    let close = |found: [f64; 2], expected: [f64; 2]| {
        for c in 0..2 {
            // The expected values have 16 digits.
            assert_relative_eq!(found[c], expected[c], epsilon = 1e-15, max_relative = 1e-15);
        }
    };
    let a = smooth(3.0, 2.0, 1.0 / 3.0);
    let x = [0.9, 0.6];
    close(a.displacement(x), [-1.627648, 0.5124077037037035]);
    let force = a.body_force(x).unwrap();
    close(force.map(|f| f / 64.0), [35.9616 / 64.0, -42.66773333333332 / 64.0]);
    close([a.gradient(x).m12 / 8.0, 0.0], [3.945813333333333 / 8.0, 0.0]);
    let b = singular(0.5);
    close(b.displacement([0.3, 0.2]), [-0.010758100618927, -0.020352237281760832]);
    close([b.gradient([0.3, 0.2]).m12, 0.0], [-0.2395003853032351, 0.0]);
    let (c, alpha) = corner(0.75);
    close(c.displacement(x), [-0.3889076234771358, -0.2516567736790981]);
    close([alpha, 0.0], [0.544_483_736_782_464, 0.0]);
    for (omega, alpha) in [(2.0 / 3.0, 0.6157310594907832), (0.6, 0.7177993084070473)] {
        close([corner(omega).1, 0.0], [alpha, 0.0]);
    }
}

/// The ladders whose integrals are tested, with the level that has 8 x 8 cells.
fn ladders(degree: Degree) -> Vec<study::Ladder> {
    vec![
        on_square(&smooth(3.0, 2.0, 1.0 / 3.0), degree, 8),
        on_square(&smooth(4.0, 3.0, 0.5), degree, 8),
        on_square(&singular(0.5), degree, 8),
        on_square(&singular(1.0 / 3.0), degree, 8),
        on_trapezoid(&corner(0.75).0, 0.75, degree, 8),
        on_trapezoid(&corner(0.6).0, 0.6, degree, 8),
    ]
}

/// The five errors by two rules, as the largest relative difference.
fn difference_of_rules(ladder: &study::Ladder, points: [usize; 2]) -> f64 {
    let (_, problem, solution) = ladder.solve(0).unwrap();
    let space = Space::new(&problem.mesh, Degree::Two);
    let [a, b] = points.map(|points| {
        let u = &solution.displacement;
        Errors::with_points(&space, &solution.pieces, u, &*ladder.solution, points)
    });
    let pairs = [
        (a.energy, b.energy),
        (a.h1, b.h1),
        (a.l2, b.l2),
        (a.contact_residual, b.contact_residual),
        (a.normal_stress, b.normal_stress),
    ];
    pairs.into_iter().map(|(a, b)| (a - b).abs() / b).fold(0.0, f64::max)
}

#[test]
fn the_second_derivatives_are_those_of_the_gradient() {
    let mut random = Random(3);
    for sample in samples() {
        for x in points(&sample, &mut random, 20) {
            let Some(second) = sample.solution.second_derivatives(x) else {
                assert!(sample.solution.regularity() <= 2.0, "{}", sample.name);
                continue;
            };
            for i in 0..2 {
                for (j, k, value) in
                    [(0, 0, second[i][0]), (0, 1, second[i][1]), (1, 1, second[i][2])]
                {
                    let slope = |t: f64| sample.solution.gradient(along(x, k, t))[(i, j)];
                    let (expected, bound) = derivative(slope, clearance(&sample, x), 10.0);
                    assert!(
                        abs_diff_eq!(value, expected, epsilon = bound),
                        "{}: {value} {expected}",
                        sample.name
                    );
                }
            }
        }
    }
}

#[test]
fn half_as_many_points_do_not_move_the_errors_and_twice_as_many_even_less() {
    for ladder in ladders(Degree::Two) {
        let half = difference_of_rules(&ladder, [POINTS / 2, POINTS]);
        let twice = difference_of_rules(&ladder, [POINTS, 2 * POINTS]);
        println!("{:?}: {half:.1e} {twice:.1e}", ladder.solution);
        assert!(half < 1e-4 && twice < 1e-10, "{:?}: {half:e} {twice:e}", ladder.solution);
    }
}

#[test]
fn control_errors_by_a_rule_that_ignores_where_the_solution_is_not_smooth_do_move() {
    /// A solution that hides its features.
    #[derive(Debug)]
    struct Hidden(Exact);
    impl signorini::exact::ExactSolution for Hidden {
        fn material(&self) -> &Material<f64> {
            self.0.material()
        }
        fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
            self.0.displacement(x)
        }
        fn gradient(&self, x: [f64; 2]) -> Matrix2<f64> {
            self.0.gradient(x)
        }
        fn regularity(&self) -> f64 {
            self.0.regularity()
        }
        fn body_force(&self, x: [f64; 2]) -> Option<[f64; 2]> {
            self.0.body_force(x)
        }
    }
    for mut ladder in ladders(Degree::Two).into_iter().skip(2) {
        ladder.solution = Arc::new(Hidden(Arc::clone(&ladder.solution)));
        let half = difference_of_rules(&ladder, [POINTS / 2, POINTS]);
        assert!(half > 1e-4, "{:?}: {half:e}", ladder.solution);
    }
}

#[test]
fn a_parameter_is_refused_at_its_limit_and_taken_beside_it() {
    let (above_zero, inside) = ("a number above 0", "a number above 0 and below 1");
    let angle = "an angle between pi/2 and pi";
    // What of [exact] stands in place of that of the case, with the key X.
    let patch = |keys: &str| format!("solution = \"patch\"\n{keys}\n");
    let smooth = |key: &str| {
        let keys = [("c", "0.5"), ("k", "4"), ("m", "3"), ("ap", "16"), ("aq", "8")];
        let value =
            |(k, value): (&str, &str)| format!("{k} = {}\n", if k == key { "X" } else { value });
        format!("solution = \"smooth\"\n{}", keys.map(value).concat())
    };
    for (exact, key, limit, beside, expected) in [
        (smooth("c"), "c", 0.0, 1e-3, inside),
        (smooth("c"), "c", 1.0, 0.999, inside),
        (smooth("k"), "k", 2.5, 2.501, "a number above 2.5"),
        (smooth("m"), "m", 1.5, 1.501, "a number above 1.5"),
        (smooth("ap"), "ap", 0.0, 1e-3, above_zero),
        (smooth("aq"), "aq", 0.0, 1e-3, above_zero),
        ("solution = \"singular\"\nc = X\namplitude = 1\n".to_owned(), "c", 0.0, 1e-3, inside),
        ("solution = \"singular\"\nc = X\namplitude = 1\n".to_owned(), "c", 1.0, 0.999, inside),
        (
            "solution = \"singular\"\nc = 0.5\namplitude = X\n".to_owned(),
            "amplitude",
            0.0,
            1e-3,
            above_zero,
        ),
        (
            "solution = \"corner\"\nomega = X\n".to_owned(),
            "omega",
            PI / 2.0,
            PI / 2.0 + 1e-3,
            angle,
        ),
        ("solution = \"corner\"\nomega = X\n".to_owned(), "omega", PI, PI - 1e-3, angle),
        (patch("which = \"d1\"\np = X"), "p", 0.0, 1e-3, above_zero),
        (patch("which = \"d2\"\np = 1\nd = X"), "d", 0.0, 1e-3, above_zero),
        (patch("which = \"d3\"\np = X\nw = 0.1\ng0 = 0"), "p", 0.0, 1e-3, above_zero),
        (patch("which = \"d5\"\nd = X"), "d", 0.0, 1e-3, above_zero),
    ] {
        let said = |value: f64| {
            let text = fs::read_to_string(root().join("cases/smooth.toml")).unwrap();
            let (start, rest) = text.split_once("[exact]\n").unwrap();
            let (_, end) = rest.split_once("\n[boundary]").unwrap();
            let exact = exact.replace('X', &format!("{value:?}"));
            let text = format!("{start}[exact]\n{exact}\n[boundary]{end}");
            let case = Case::parse(Path::new("case"), &text, &[]);
            case.err().map_or(String::new(), |error| error.error.to_string())
        };
        let refusal = format!("[exact] {key} = ");
        let found = said(limit);
        assert!(
            found.starts_with(&refusal) && found.ends_with(&format!("; expected {expected}")),
            "{found}"
        );
        // The mesh of the case may be none for the solution, but the parameter is one.
        let found = said(beside);
        assert!(!found.contains(&refusal), "{exact}: {found}");
    }
}
