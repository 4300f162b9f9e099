//! Exact solutions: uniform stress in blocks whose meshes do not match, 7 cells against 11, is found to rounding.

use std::collections::BTreeSet;

use super::*;
use crate::common::DEGREES;
use approx::abs_diff_eq;

/// Where a point of a mesh goes.
type Map = Box<dyn Fn([f64; 2]) -> [f64; 2]>;

/// What rounding may make of displacements, relative to the largest, in numbers of size 1.
const ROUNDING: f64 = 1e-12;

const POISSON: f64 = 0.3;

/// A turn about the origin.
#[derive(Clone, Copy)]
struct Turn {
    cos: f64,
    sin: f64,
}

impl Turn {
    fn by(degrees: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        // Exactly nothing where there is no turn.
        Turn { cos, sin }
    }

    fn of(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }

    fn back(self, v: [f64; 2]) -> [f64; 2] {
        Turn { sin: -self.sin, ..self }.of(v)
    }
}

/// Two unit blocks, 7 and 11 cells wide, one on top of the other, turned.
fn two_blocks(moduli: [f64; 2], turn: Turn, law: Law) -> Problem {
    let lower = rectangle([0.0, 0.0], [1.0, 1.0]);
    let upper = rectangle([0.0, 1.0], [1.0, 2.0]);
    let [lower, upper]: [Map; 2] =
        [Box::new(move |x| turn.of(lower(x))), Box::new(move |x| turn.of(upper(x)))];
    let block =
        |name, cells, modulus, map| Block { name, cells, material: young(modulus, POISSON), map };
    bodies(
        &[block("lower", [7, 5], moduli[0], &*lower), block("upper", [11, 6], moduli[1], &*upper)],
        &[Pair::new("lower.top", "upper.bottom").with_law(law)],
    )
}

/// The prescribed displacement u . n and the rest free, u . n being the same all along.
fn along_normal(value: f64) -> Condition {
    Condition::Support { normal: Some(Arc::new(move |_: [f64; 2]| value)), tangential: None }
}

/// The uniform compression of 1 along y, as the blocks are before they are turned.
fn compressed(
    moduli: [f64; 2],
    turn: Turn,
    law: Law,
) -> (Problem, impl Fn(usize, [f64; 2]) -> [f64; 2]) {
    let strain = move |i: usize| {
        let factor = (1.0 + POISSON) / moduli[i];
        [POISSON * factor, -(1.0 - POISSON) * factor]
    };
    let exact = move |body: usize, x: [f64; 2]| {
        let [x, y] = turn.back(x);
        let ([ex, ey], [gx, gy]) = (strain(0), strain(1));
        turn.of(if body == 0 { [ex * x, ey * y] } else { [gx * x, ey + gy * (y - 1.0)] })
    };
    let roller = Condition::roller;
    let problem = two_blocks(moduli, turn, law)
        .with("lower.bottom", roller())
        .with("lower.left", roller())
        .with("upper.left", roller());
    (problem, exact)
}

/// How far a solution is from the exact displacement of each body, 0 or 1, relative to the largest.
fn off(
    problem: &Problem,
    u: &[[f64; 2]],
    degree: Degree,
    exact: impl Fn(usize, [f64; 2]) -> [f64; 2],
) -> f64 {
    let space = signorini::model::Space::new(&problem.mesh, degree);
    let mut expected = vec![[0.0; 2]; space.nodes().len()];
    for (t, nodes) in space.elements().enumerate() {
        // The lower body has 7 x 5 cells.
        let body = usize::from(t >= 2 * 7 * 5);
        nodes.iter().for_each(|&node| expected[node] = exact(body, space.nodes()[node]));
    }
    apart(u, &expected) / largest(&expected)
}

#[test]
fn uniform_pressure_is_exact_on_meshes_that_do_not_match() {
    for (moduli, degrees) in
        [([1.0, 1.0], 0.0), ([1.0, 1e6], 0.0), ([1e6, 1.0], 37.0), ([1.0, 1.0], 37.0)]
    {
        let turn = Turn::by(degrees);
        let (problem, exact) = compressed(moduli, turn, Law::Contact);
        let top = exact(1, turn.of([0.0, 2.0]));
        let down = turn.back(top)[1];
        // Held from above: the condensed route; or only by the other body: the assembled one.
        let held = problem.clone().with("upper.top", along_normal(down));
        let pressed = problem.with("upper.top", Condition::pressure(|_| 1.0));
        for degree in DEGREES {
            for problem in [&held, &pressed] {
                let s = proved(problem, &method(degree));
                let error = off(problem, &s.displacement, degree, &exact);
                assert!(error <= ROUNDING, "{moduli:?} turned by {degrees}, {degree:?}: {error:e}");
                let [pair] = &s.boundaries[..] else { panic!("{:?}", s.boundaries) };
                assert_eq!(pair.partner.as_deref(), Some("upper.bottom"));
                let expected = turn.of([0.0, -1.0]);
                let force = apart(&[pair.resultant], &[expected]);
                assert!(force <= 1e-11, "{:?}", pair.resultant);
            }
        }
    }
}

#[test]
fn bodies_that_slide_without_lifting_off_and_glued_ones_are_exact_in_tension() {
    let turn = Turn::by(0.0);
    for (law, moduli) in [(Law::Sliding, [1.0, 5.0]), (Law::Bonded, [1.0, 1.0])] {
        let (problem, exact) = compressed(moduli, turn, law);
        let stretched = move |body: usize, x: [f64; 2]| exact(body, x).map(|c| -c);
        let up = stretched(1, [0.0, 2.0])[1];
        let problem = problem.with("upper.top", along_normal(up));
        for degree in DEGREES {
            let s = proved(&problem, &method(degree));
            let error = off(&problem, &s.displacement, degree, &stretched);
            assert!(error <= ROUNDING, "{law:?} {degree:?}: {error:e}");
            // They pull each other by a stress of 1 over a length of 1, and are proved to.
            let [low, high] = s.enclosure.unwrap().intervals.contact[0].force;
            let is_known = low <= -1.0 + ROUNDING && -1.0 - ROUNDING <= high && high - low <= 1e-7;
            assert!(is_known, "{law:?} {degree:?}: {low} {high}");
        }
        // The control: bodies in contact let go.
        let (loose, _) = compressed(moduli, turn, Law::Contact);
        let s = proved(&loose.with("upper.top", along_normal(up)), &method(Degree::One));
        assert_eq!(s.boundaries[0].force, 0.0);
    }
}

#[test]
fn glued_bodies_are_exact_in_shear() {
    let shear = 0.2;
    for moduli in [[1.0, 1.0], [1.0, 1e3]] {
        let mu = moduli.map(|e| e / (2.0 * (1.0 + POISSON)));
        let exact = move |body: usize, [_, y]: [f64; 2]| {
            let along = [shear * y / mu[0], shear / mu[0] + shear * (y - 1.0) / mu[1]];
            [along[body], 0.0]
        };
        let side = |sign: f64| Condition::traction(|_| 0.0, move |_| sign * shear);
        let top = exact(1, [0.0, 2.0])[0];
        let problem = |law| {
            two_blocks(moduli, Turn::by(0.0), law)
                .with("lower.bottom", Condition::clamped())
                .with("upper.top", Condition::displacement(move |_| top, |_| 0.0))
                .with("lower.left", side(-1.0))
                .with("lower.right", side(1.0))
                .with("upper.left", side(-1.0))
                .with("upper.right", side(1.0))
        };
        for degree in DEGREES {
            let bonded = problem(Law::Bonded);
            let s = proved(&bonded, &method(degree));
            let error = off(&bonded, &s.displacement, degree, exact);
            assert!(error <= ROUNDING, "{moduli:?} {degree:?}: {error:e}");
            // All of the interface is in contact, once.
            for length in [s.quantities.contact_length, s.boundaries[0].length] {
                assert!((length - 1.0).abs() <= 1e-12, "{length}");
            }
            // The force on the lower body, and nothing along the normal.
            let [x, y] = s.boundaries[0].resultant;
            assert!(abs_diff_eq!(x, shear, epsilon = 1e-11) && y.abs() <= 1e-11, "{x} {y}");
        }
        // The control: bodies that slide carry no shear.
        let s = proved(&problem(Law::Sliding), &method(Degree::One));
        assert!(off(&problem(Law::Sliding), &s.displacement, Degree::One, exact) > 1e-2);
    }
}

#[test]
fn control_the_stress_of_the_second_body_with_the_wrong_sign_is_noticed() {
    let turn = Turn::by(0.0);
    let (problem, exact) = compressed([1.0, 1.0], turn, Law::Contact);
    let problem = problem.with("upper.top", along_normal(exact(1, [0.0, 2.0])[1]));
    for degree in DEGREES {
        let right = with_planted(&problem, &method(degree), |d| with_stress(d, |_, _| 1.0));
        assert!(off(&problem, &right.unwrap(), degree, &exact) <= ROUNDING);
        let turned = |_: &Piece, i: usize| if i == 0 { 1.0 } else { -1.0 };
        let wrong = with_planted(&problem, &method(degree), |d| with_stress(d, turned));
        assert!(wrong.is_err() || off(&problem, &wrong.unwrap(), degree, &exact) > 1e-4);
    }
}

/// One piece for each edge of the first body, whatever nodes the second one has there: its side is the edge of that body where the piece
/// starts, and what is beyond it.
fn unmerged(d: &Discretization) -> Vec<Piece> {
    let whole = with_geometry(d, |geometry| {
        let [own, other] = [0, 1].map(|i| geometry.stretches[i].positions.clone());
        let slope = (other[1] - other[0]) / (own[1] - own[0]);
        for (a, s) in d.space.degree().edge_positions().enumerate() {
            geometry.stretches[0].positions[a] = s;
            geometry.stretches[1].positions[a] = other[0] + (s - own[0]) * slope;
        }
    });
    let mut known = BTreeSet::new();
    let is_first = |piece: &Piece| {
        let edge = piece.geometry.stretches[0].edge;
        known.insert((edge.triangle, edge.local))
    };
    let mut firsts = whole;
    firsts.retain(is_first);
    let mut start = 0;
    for piece in &mut firsts {
        piece.start = start;
        start = piece.functionals().end;
    }
    firsts
}

#[test]
fn control_pieces_that_do_not_end_at_the_nodes_of_the_second_body_are_noticed() {
    let turn = Turn::by(0.0);
    let (problem, exact) = compressed([1.0, 1.0], turn, Law::Contact);
    let problem = problem.with("upper.top", along_normal(exact(1, [0.0, 2.0])[1]));
    for degree in DEGREES {
        let right = with_planted(&problem, &method(degree), |d| d.contact.clone()).unwrap();
        assert!(off(&problem, &right, degree, &exact) <= ROUNDING);
        let wrong = with_planted(&problem, &method(degree), unmerged);
        assert!(wrong.is_err() || off(&problem, &wrong.unwrap(), degree, &exact) > 1e-4);
    }
}

#[test]
fn pieces_that_are_short_do_not_disturb_the_others() {
    let lower = rectangle([0.0, 0.0], [1.0, 1.0]);
    let force = |share: f64, degree: Degree| {
        // The inner nodes of the upper body are off those of the lower one by this share of a cell.
        let upper = move |[x, t]: [f64; 2]| {
            let inner = x > 0.0 && x < 1.0;
            [if inner { x + share / 8.0 } else { x }, 1.0 + t]
        };
        let block = |name, map| Block { name, cells: [8, 8], material: young(1.0, POISSON), map };
        let problem = bodies(
            &[block("lower", &lower), block("upper", &upper)],
            &[Pair::new("lower.top", "upper.bottom")],
        )
        .with("lower.bottom", Condition::displacement(|_| 0.0, |[x, _]| 0.05 + 0.1 * (x - 0.5)))
        .with("upper.top", Condition::clamped());
        proved(&problem, &method(degree)).boundaries[0].force
    };
    for degree in DEGREES {
        let matching = force(0.0, degree);
        for share in [0.3, 0.1, 1e-2, 1e-4, 1e-6, 1e-9] {
            let off = (force(share, degree) / matching - 1.0).abs();
            println!("{degree:?}, nodes off by {share:e}: force off by {off:e}");
            // Moving nodes by a cell's share moves the discrete force by about its own error, 2 % with these cells.
            assert!(off <= 0.02 * share.max(1e-3) / 0.1, "{degree:?} {share:e}: {off:e}");
        }
    }
}

#[test]
fn three_blocks_carry_one_force_through_the_middle_one() {
    let maps = [0.0, 1.0, 2.0].map(|y| rectangle([0.0, y], [1.0, y + 1.0]));
    let block = |name, cells, map| Block { name, cells, material: young(1.0, POISSON), map };
    for tilt in [0.0, 0.02] {
        let problem = bodies(
            &[
                block("lower", [7, 4], &maps[0]),
                block("middle", [11, 4], &maps[1]),
                block("upper", [9, 4], &maps[2]),
            ],
            &[Pair::new("lower.top", "middle.bottom"), Pair::new("upper.bottom", "middle.top")],
        )
        .with("lower.bottom", Condition::clamped())
        .with("upper.top", Condition::displacement(|_| 0.0, move |[x, _]| -0.05 - tilt * x))
        .with("middle.left", Condition::roller());
        for degree in DEGREES {
            let s = proved(&problem, &method(degree));
            let force = |k: usize| Vector2::from(s.boundaries[k].resultant);
            // Down on the lower body, up on the upper one: what the middle one feels of both is nothing, but for the roller.
            let unbalanced = (force(0) + force(1))[1].abs() / s.boundaries[0].force;
            assert!(unbalanced <= 1e-12, "{degree:?}: {unbalanced:e}");
            assert!(s.boundaries[0].force > 0.01);
            assert!(s.newton.iterations() <= 12, "{} steps", s.newton.iterations());
        }
    }
}
