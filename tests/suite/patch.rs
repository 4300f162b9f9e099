//! Patch tests: exact solutions that lie in P1, so method (8) must reproduce them to rounding on any mesh, with P1 and P2,
//! by exact and by Gauss quadrature. Consistency (Lemma 3.1) at its plainest.
//!
//! With lambda, mu and E1 = (lambda + 2 mu) / (4 mu (lambda + mu)), E2 = lambda / (4 mu (lambda + mu)), all on the unit
//! square with the exact displacement prescribed on top, tractions on the sides, contact below:
//! d1 full contact under uniform compression, d2 separation, d3 full contact on a sloping gap, d4 grazing (nothing
//! happens, P = 0 everywhere), d5 an interference fit.

use crate::common::*;
use signorini::fem::{Condition, Diagonal, Problem, SharedFunction};
use signorini::kernel::{Material, Plane};
use signorini::solve::{Degree, Solution, solve};

const MATERIALS: [(f64, f64); 2] = [(1.0, 1.0), (3.0, 0.7)];

struct Patch {
    name: &'static str,
    /// u and its exact values
    u: fn(Constants, [f64; 2]) -> [f64; 2],
    /// the traction on the right side; on the left it is the opposite
    right: fn(Constants) -> [f64; 2],
    gap: fn([f64; 2]) -> f64,
    /// sigma_n on the floor
    sigma_n: fn(Constants) -> f64,
    contact: bool,
}

#[derive(Clone, Copy)]
struct Constants {
    lambda: f64,
    mu: f64,
    e1: f64,
    e2: f64,
}

const P: f64 = 0.3;
const W: f64 = 0.05;
const G0: f64 = 0.1;
const D: f64 = 0.02;

const PATCHES: [Patch; 5] = [
    Patch {
        name: "d1",
        u: |c, [x, y]| [P * c.e2 * x, -P * c.e1 * y],
        right: |_| [0.0, 0.0],
        gap: |_| 0.0,
        sigma_n: |_| -P,
        contact: true,
    },
    Patch {
        name: "d2",
        u: |c, [x, y]| [P * c.e1 * x, -P * c.e2 * y + D],
        right: |_| [P, 0.0],
        gap: |_| 0.0,
        sigma_n: |_| 0.0,
        contact: false,
    },
    Patch {
        name: "d3",
        u: |c, [x, y]| [P * c.e2 * x - W * y, -P * c.e1 * y + W * x - G0],
        right: |_| [0.0, 0.0],
        gap: |[x, _]| G0 - W * x,
        sigma_n: |_| -P,
        contact: true,
    },
    Patch {
        name: "d4",
        u: |_, _| [0.0, 0.0],
        right: |_| [0.0, 0.0],
        gap: |_| 0.0,
        sigma_n: |_| 0.0,
        contact: false,
    },
    Patch {
        name: "d5",
        u: |_, [_, y]| [0.0, D * (1.0 - y)],
        right: |c| [-c.lambda * D, 0.0],
        gap: |_| -D,
        sigma_n: |c| -(c.lambda + 2.0 * c.mu) * D,
        contact: true,
    },
];

fn constants((lambda, mu): (f64, f64)) -> Constants {
    let d = 4.0 * mu * (lambda + mu);
    Constants { lambda, mu, e1: (lambda + 2.0 * mu) / d, e2: lambda / d }
}

fn problem(patch: &Patch, c: Constants, diagonal: Diagonal) -> Problem {
    let u = patch.u;
    let component =
        move |i: usize| -> Option<SharedFunction> { Some(function(move |x| u(c, x)[i])) };
    let side = |sign: f64| Condition::Traction((patch.right)(c).map(|t| constant(sign * t)));
    let gap = patch.gap;
    Problem::new(
        skewed_square(6, diagonal),
        Material::lame(c.lambda, c.mu, Plane::Strain),
        [constant(0.0), constant(0.0)],
        conditions([
            ("top", Condition::Displacement([component(0), component(1)])),
            ("left", side(-1.0)),
            ("right", side(1.0)),
            ("bottom", Condition::Contact { gap: function(gap) }),
        ]),
    )
}

/// The bound of the patch tests: displacements of size 0.1 and stresses of size 1 through some 100 unknowns, each a sum of
/// about ten products; a thousand rounding errors cover it with room for the condition of the matrix.
const BOUND: f64 = 1000.0 * f64::EPSILON;

fn largest_error(patch: &Patch, c: Constants, s: &Solution) -> f64 {
    let mut error: f64 = 0.0;
    for (node, u) in s.nodes.iter().zip(&s.displacement) {
        let exact = (patch.u)(c, *node);
        error = error.max((u[0] - exact[0]).abs()).max((u[1] - exact[1]).abs());
    }
    for point in s.contact.iter().flat_map(|e| &e.points) {
        let sigma_n = (patch.sigma_n)(c);
        error = error.max((point.sigma_n - sigma_n).abs()).max((point.lambda - sigma_n).abs());
    }
    error
}

#[test]
fn patches_are_reproduced_to_rounding_on_skewed_meshes() {
    for patch in &PATCHES {
        for material in MATERIALS {
            let c = constants(material);
            for diagonal in [Diagonal::Left, Diagonal::Right, Diagonal::Crossed] {
                for degree in [Degree::One, Degree::Two] {
                    for quadrature in [EXACT, GAUSS] {
                        let problem = problem(patch, c, diagonal);
                        let method = method(degree, quadrature);
                        let (s, _) = solve(&problem, &method, &Default::default()).unwrap();
                        let here = format!("{} {diagonal:?} {degree:?} {quadrature:?}", patch.name);
                        let error = largest_error(patch, c, &s);
                        assert!(error <= BOUND, "{here}: {error:e}");
                        let length = if patch.contact { 1.0 } else { 0.0 };
                        let covered = s.quantities.contact_length;
                        assert!((covered - length).abs() <= BOUND, "{here}: {covered}");
                    }
                }
            }
        }
    }
}

#[test]
fn control_a_patch_with_the_wrong_modulus_is_not_reproduced() {
    let c = constants(MATERIALS[1]);
    let mut problem = problem(&PATCHES[0], c, Diagonal::Right);
    problem.material = Material::lame(c.lambda, c.mu * 1.001, Plane::Strain).into();
    let (s, _) = solve(&problem, &method(Degree::One, EXACT), &Default::default()).unwrap();
    assert!(largest_error(&PATCHES[0], c, &s) > 1e6 * BOUND);
}

#[test]
fn grazing_without_load_stays_exactly_at_rest() {
    let problem = problem(&PATCHES[3], constants(MATERIALS[0]), Diagonal::Right);
    let (s, _) = solve(&problem, &method(Degree::Two, EXACT), &Default::default()).unwrap();
    assert!(s.displacement.iter().all(|u| *u == [0.0, 0.0]));
    assert_eq!(s.newton.residual, 0.0);
    assert_eq!(s.quantities.contact_force, 0.0);
}
