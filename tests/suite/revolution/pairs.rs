//! Pairs of bodies of revolution on meshes that do not match.

use std::f64::consts::PI;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use signorini::fem::{Condition, Materials, Mesh, Pair, Problem};

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
    }
}

/// A hub of the radii 1 and 2 shrunk on a solid shaft, plane strain at both ends: p by Lame's formulas.
#[test]
fn a_shrink_fit_has_lames_pressure() {
    const INTERFERENCE: f64 = 0.01;
    for (degree, tolerance) in [(Degree::One, 4e-3), (Degree::Two, 2e-5)] {
        let shaft = meridian([0.0, 1.0], 1.0, [7, 7], false);
        let hub = meridian([1.0, 2.0], 1.0, [9, 11], false);
        let mesh = both(&shaft, &hub, ["right", "left 2"]);
        let mut problem = Problem::of(mesh, materials(&shaft, &hub, [1.0, 2.0]));
        for name in ["top", "bottom", "top 2", "bottom 2"] {
            problem = problem.with(name, flat_roller());
        }
        let problem =
            problem.with_pair(Pair::new("right", "left 2").with_clearance(|_| -INTERFERENCE));
        let s = solved(&problem, degree);
        let of = |young: f64| (young / (1.0 - 0.09), 0.3 / 0.7);
        let ((inner, nu), (outer, _)) = (of(1.0), of(2.0));
        let compliance = (1.0 - nu) / inner + (5.0 / 3.0 + nu) / outer;
        let found = s.quantities.contact_force / (2.0 * PI);
        assert_abs_diff_eq!(found * compliance / INTERFERENCE, 1.0, epsilon = tolerance);
        // The control: as plates the two are not pressed alike.
        assert!(
            (found * ((1.0 - 0.3) + (5.0 / 3.0 + 0.3) / 2.0) / INTERFERENCE - 1.0).abs() > 0.05
        );
    }
}
