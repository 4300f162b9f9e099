//! Pairs of bodies of revolution on meshes that do not match.

use std::f64::consts::PI;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use signorini::contact::Pair;
use signorini::model::{Condition, Materials, Mesh, Problem};
use signorini::results::ContactEdge;

use super::half_space::{before_the_cut, contact_radius, hertz_displacement};
use super::*;

/// Two rectangles in one mesh, the names of the second with a mark; `first` and `second` may touch.
fn both(first: &Mesh, second: &Mesh, [a, b]: [&str; 2]) -> Mesh {
    let count = first.vertices().len();
    let vertices = [first.vertices(), second.vertices()].concat();
    let moved = second.triangles().iter().map(|t| t.map(|v| v + count));
    let triangles = first.triangles().iter().copied().chain(moved).collect();
    let mut named = named_edges(first);
    for (name, edges) in named_edges(second) {
        let edges = edges.into_iter().map(|e| e.map(|v| v + count)).collect();
        named.insert(format!("{name} 2"), edges);
    }
    let pair = Pair::new(a, b);
    Mesh::with_pairs(vertices, triangles, named, &[pair]).unwrap()
}

fn materials(first: &Mesh, second: &Mesh, [soft, stiff]: [f64; 2]) -> Materials {
    let (n, m) = (first.triangles().len(), second.triangles().len());
    let second: Vec<usize> = (n..n + m).collect();
    Materials::in_parts(elastic(soft, 0.3), n + m, [(elastic(stiff, 0.3), &second[..])])
}

/// A cylinder on another, 7 edges beside 11, pressed from above; the upper one is held by contact alone.
#[test]
fn a_stack_of_two_cylinders_is_exact() {
    for degree in DEGREES {
        let lower = meridian([0.0, 1.0], 1.0, [7, 5], false);
        let upper = moved_to(&meridian([0.0, 1.0], 1.0, [11, 6], false), |[r, z]| [r, z + 1.0]);
        let mesh = both(&lower, &upper, ["top", "bottom 2"]);
        let problem = Problem::of(mesh, materials(&lower, &upper, [1.0, 1.0]))
            .with("bottom", flat_roller())
            .with("top 2", Condition::pressure(|_| 0.01))
            .with_pair(Pair::new("top", "bottom 2"));
        let s = solved(&problem, degree);
        for (&[r, z], u) in s.nodes.iter().zip(&s.displacement) {
            assert_abs_diff_eq!(u[..], [0.003 * r, -0.01 * z][..], epsilon = 1e-12);
        }
        assert_relative_eq!(s.quantities.contact_force, 0.01 * PI, max_relative = 1e-12);
        for point in s.contact.iter().flat_map(|edge| &edge.points) {
            assert_relative_eq!(-point.lambda, 0.01, max_relative = 1e-12);
            assert_relative_eq!(point.pressure, 0.01, max_relative = 1e-12);
        }
    }
}

/// A hub of the radii 1 and 2 shrunk on a solid shaft, plane strain at both ends, 7 m edges beside 11 m: p over that of Lame's formulas, and
/// over that for plates.
pub(super) fn shrink_fit(degree: Degree, m: usize, cells: usize) -> [f64; 2] {
    const INTERFERENCE: f64 = 0.01;
    let shaft = meridian([0.0, 1.0], 1.0, [7 * m, 7 * m], false);
    let hub = meridian([1.0, 2.0], 1.0, [cells, 11 * m], false);
    let mesh = both(&shaft, &hub, ["right", "left 2"]);
    let mut problem = Problem::of(mesh, materials(&shaft, &hub, [1.0, 2.0]));
    for name in ["top", "bottom", "top 2", "bottom 2"] {
        problem = problem.with(name, flat_roller());
    }
    let problem = problem.with_pair(Pair::new("right", "left 2").with_clearance(|_| -INTERFERENCE));
    let found = solved(&problem, degree).quantities.contact_force / (2.0 * PI);
    let of = |young: f64| (young / (1.0 - 0.09), 0.3 / 0.7);
    let ((inner, nu), (outer, _)) = (of(1.0), of(2.0));
    let compliance = (1.0 - nu) / inner + (5.0 / 3.0 + nu) / outer;
    let of_plates = (1.0 - 0.3) + (5.0 / 3.0 + 0.3) / 2.0;
    [compliance, of_plates].map(|compliance| found * compliance / INTERFERENCE)
}

#[test]
fn a_shrink_fit_has_lames_pressure() {
    // The hub's strain is not linear in r: P1 needs many cells along it.
    for (degree, cells, tolerance) in [(Degree::One, 40, 3e-4), (Degree::Two, 20, 1e-6)] {
        let [found, as_plates] = shrink_fit(degree, 1, cells);
        assert_abs_diff_eq!(found, 1.0, epsilon = tolerance);
        // The control.
        assert!((as_plates - 1.0).abs() > 0.05);
    }
}

/// What was found over what Hertz says: the force with a = 1, and peak pressure and a by the force that was found; and the force over that of
/// the stiffer one alone.
pub(super) struct OfHertz {
    pub(super) force: f64,
    pub(super) peak: f64,
    pub(super) radius: f64,
    alone: f64,
}

/// Two paraboloids of the radii 1000 and 2000, E as 1 to 3, pressed together with a = 1: each on the block r <= 2, |z| <= 2 with the exact
/// displacement of its half space on the far sides.
pub(super) fn two_spheres(degree: Degree, [n, m]: [usize; 2]) -> OfHertz {
    const RADII: [f64; 2] = [1000.0, 2000.0];
    const YOUNG: [f64; 2] = [1.0, 3.0];
    let curvature = 1.0 / RADII[0] + 1.0 / RADII[1];
    let reduced = 1.0 / (0.91 / YOUNG[0] + 0.91 / YOUNG[1]);
    let (force, depth) = (4.0 * reduced * curvature / 3.0, curvature);
    // The side with the far boundaries is curved less and less.
    let block = |cells: usize, side: f64, radius: f64| {
        let flat = meridian([0.0, 2.0], 2.0, [2 * cells, 2 * cells], false);
        moved_to(&flat, move |[r, z]| {
            let z = if side < 0.0 { z - 2.0 } else { z };
            [r, z + side * (1.0 - z.abs() / 2.0) * r * r / (2.0 * radius)]
        })
    };
    let (lower, upper) = (block(n, -1.0, RADII[0]), block(m, 1.0, RADII[1]));
    let mesh = both(&lower, &upper, ["top", "bottom 2"]);
    let far = |side: f64, young: f64, radius: f64| {
        let at = move |[r, z]: [f64; 2]| {
            // Where the point of the half space is that was moved.
            let bulge = r * r / (2.0 * radius);
            let z = (z.abs() - bulge) / (1.0 - bulge / 2.0);
            let [radial, axial] = hertz_displacement([r, z]);
            let scale = force / young;
            [scale * radial, side * scale * axial - if side > 0.0 { depth } else { 0.0 }]
        };
        Condition::displacement(move |x| at(x)[0], move |x| at(x)[1])
    };
    let problem = Problem::of(mesh, materials(&lower, &upper, YOUNG))
        .with("bottom", far(-1.0, YOUNG[0], RADII[0]))
        .with("right", far(-1.0, YOUNG[0], RADII[0]))
        .with("top 2", far(1.0, YOUNG[1], RADII[1]))
        .with("right 2", far(1.0, YOUNG[1], RADII[1]))
        .with_pair(Pair::new("top", "bottom 2"));
    let s = solved(&problem, degree);
    let found = s.quantities.contact_force;
    let a = (3.0 * found / (4.0 * reduced * curvature)).cbrt();
    let of_piece = |piece: &ContactEdge| -> Vec<(f64, f64)> {
        let values = piece.points.iter().map(|p| [p.lambda, p.u_n - p.gap, p.sigma_n]);
        piece.points.iter().map(|p| p.place[0]).zip(before_the_cut(values)).collect()
    };
    let highest = s.contact.iter().flat_map(|edge| &edge.points).map(|p| p.pressure);
    let first = s.contact.iter().filter(|edge| &*edge.boundary == "top");
    OfHertz {
        force: found / force,
        peak: highest.fold(0.0, f64::max) / (2.0 * reduced * curvature * a / PI),
        radius: contact_radius(first.map(of_piece), found) / a,
        alone: found / (4.0 * YOUNG[1] / 0.91 * curvature / 3.0),
    }
}

#[test]
fn two_spheres_press_each_other_as_hertz_says() {
    for (degree, cells, of_peak, of_radius) in
        [(Degree::One, [12, 14], 0.015, 5e-3), (Degree::Two, [6, 7], 5e-3, 5e-3)]
    {
        let found = two_spheres(degree, cells);
        assert_abs_diff_eq!(found.force, 1.0, epsilon = 0.01);
        assert_abs_diff_eq!(found.peak, 1.0, epsilon = of_peak);
        assert_abs_diff_eq!(found.radius, 1.0, epsilon = of_radius);
        // The control.
        assert!((found.alone - 1.0).abs() > 0.1);
    }
}
