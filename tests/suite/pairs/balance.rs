//! Forces and moments of the two sides cancel, and the stress that is subtracted is at most kappa times the energy.

use approx::assert_abs_diff_eq;
use signorini::contact::Friction;
use signorini::kernel::{Ball, PreciseBall};
use signorini::linear::factor::Factor;
use signorini::linear::matrix;
use signorini::linear::matrix::{Neighbours, Numbering};
use signorini::proof::balls::Lines;
use signorini::proof::korn::{Hold, Term};
use signorini::proof::pressed::Pressed;

use super::*;
use crate::bodies::number_from;
use crate::common::{DEGREES, Random};

/// Two blocks with any cells, moduli and places of inner nodes, held at their far sides; of an inner node the place is moved by up to
/// a fifth of a cell.
fn drawn(seed: u64, law: Law) -> Problem {
    let mut random = Random(seed);
    let [n, m] = [0, 1].map(|_| random.whole(1, 13));
    let [k, l] = [0, 1].map(|_| random.whole(1, 5));
    let (ratio, depth) = (random.decades(-3.0, 3.0), random.between(0.0, 0.2));
    let bend = random.between(-0.1, 0.1);
    let wobble = |x: f64, y: f64| 0.3 * (7.0 * x + 3.0 * y).sin() * x * (1.0 - x) * y * (1.0 - y);
    // The interface is y = bend x (1 - x), and the bodies end at y = -1 and 1.
    let curve = move |x: f64| bend * x * (1.0 - x);
    let lower = move |[x, t]: [f64; 2]| {
        let y = -1.0 + (1.0 + curve(x)) * t;
        [x + wobble(x, t) / n as f64, y]
    };
    let upper = move |[x, t]: [f64; 2]| {
        let y = curve(x) + (1.0 - curve(x)) * t;
        [x + wobble(t, x) / m as f64, y]
    };
    let block =
        |name, cells, modulus, map| Block { name, cells, material: young(modulus, 0.3), map };
    bodies(
        &[block("lower", [n, k], 1.0, &lower), block("upper", [m, l], ratio, &upper)],
        &[Pair::new("lower.top", "upper.bottom").with_law(law)],
    )
    .with("lower.bottom", Condition::clamped())
    .with("upper.top", Condition::displacement(|_| 0.0, move |[x, _]| -0.02 - depth * x))
}

const LAWS: [Law; 3] = [Law::Contact, Law::Sliding, Law::Bonded];

type Motion = fn([f64; 2]) -> [f64; 2];

const MOTIONS: [Motion; 3] = [|_| [1.0, 0.0], |_| [0.0, 1.0], |[x, y]| [-y, x]];

/// Whether a triangle is one of the upper body, whose vertices follow those of the lower one.
fn is_above(mesh: &Mesh, t: usize) -> bool {
    let ends = mesh.edges_of("upper.bottom").unwrap().iter().flat_map(|&edge| mesh.ends(edge));
    let first = ends.min().unwrap();
    mesh.triangles()[t].iter().all(|&v| v >= first)
}

/// What a hold says of a motion of the lower body and one of the upper body.
fn held(hold: &Hold, mesh: &Mesh, motions: [Motion; 2]) -> f64 {
    let middle = |ball: Ball| (ball.lower() + ball.upper()) / 2.0;
    let of = |Term { triangle, at, along }: &Term| {
        let [x, y] = motions[usize::from(is_above(mesh, *triangle))](at.map(middle));
        middle(along[0]) * x + middle(along[1]) * y
    };
    hold.terms.iter().map(of).sum()
}

#[test]
fn what_holds_one_body_to_another_is_the_motion_of_one_less_that_of_the_other() {
    // Glue holds both components, and so does friction where it sticks.
    let rough = Friction::tresca(|_| 1.0);
    let laws = [
        (Law::Contact, None, 1),
        (Law::Sliding, None, 1),
        (Law::Bonded, None, 2),
        (Law::Contact, Some(rough), 2),
    ];
    for (law, friction, components) in laws {
        for (seed, degree) in (1..=3).flat_map(|seed| DEGREES.map(|degree| (seed, degree))) {
            let mut problem = drawn(seed, law);
            problem.pairs[0].friction = friction.clone();
            let d = discretize(&problem, &with_kappa(degree, 0.5)).unwrap();
            // The upper body is moved onto the lower one.
            let mesh = d.space.mesh();
            let mut u = vec![[PreciseBall::from(0); 2]; d.space.nodes().len()];
            for (t, nodes) in d.space.elements().enumerate().filter(|(t, _)| is_above(mesh, *t)) {
                assert!(t > 0, "the lower body comes first");
                nodes.iter().for_each(|&node| u[node][1] = PreciseBall::from(-0.1));
            }
            let lines = Lines::new(&d);
            let holds = Pressed::at(&d, &lines, &u, 0.0).holds(&d, &lines);
            assert_eq!(holds.len(), 2 * components * d.contact.len(), "{seed} {law:?}");
            let rest: Motion = |_| [0.0; 2];
            for hold in &holds {
                let of_lower = MOTIONS.map(|motion| held(hold, mesh, [motion, rest]));
                let of_upper = MOTIONS.map(|motion| held(hold, mesh, [rest, motion]));
                let sums = [0, 1, 2].map(|k| of_lower[k] + of_upper[k]);
                // Sums of a dozen numbers of size 1. The points of a curved interface that face each other are apart along its
                // normal, by less than a hundredth: there a rotation has a jump across.
                let room = [1e-13, 1e-13, if components == 1 { 1e-13 } else { 0.01 }];
                let vanish = sums.iter().zip(room).all(|(sum, room)| sum.abs() <= room);
                assert!(vanish, "{seed} {law:?}: {sums:?}");
                // Along a mean of unit vectors, which turn by a tenth at most.
                assert_abs_diff_eq!(of_lower[0].hypot(of_lower[1]), 1.0, epsilon = 0.01);
                // Control: the sum of both motions is no jump.
                let [x, y] = [0, 1].map(|k| of_lower[k] - of_upper[k]);
                assert!(x.hypot(y) > 1.9, "{x} {y}");
            }
        }
    }
}

#[test]
fn rigid_motions_of_both_bodies_have_no_jump_so_forces_and_moments_cancel() {
    for seed in 1..=20 {
        let problem = drawn(seed, LAWS[seed as usize % 3]);
        for degree in DEGREES {
            let d = discretize(&problem, &with_kappa(degree, 0.5)).unwrap();
            let mut noticed = false;
            for motion in MOTIONS {
                let field: Vec<[f64; 2]> = d.space.nodes().iter().map(|&x| motion(x)).collect();
                for piece in &d.contact {
                    let along = degree.nodes_per_edge();
                    let p0 = piece.p0(&field);
                    // Differences of numbers of size 1, with stresses times gamma that cancel.
                    assert!(
                        p0[..along].iter().all(|p| p.abs() <= 1e-13),
                        "{seed} {degree:?} {p0:?}"
                    );
                    // The control: one body that moves alone.
                    let alone: Vec<[f64; 2]> = d
                        .space
                        .nodes()
                        .iter()
                        .enumerate()
                        .map(|(node, &x)| {
                            if piece.nodes[piece.sides[0].entries.clone()].contains(&node) {
                                motion(x)
                            } else {
                                [0.0; 2]
                            }
                        })
                        .collect();
                    noticed |= piece.p0(&alone)[..along].iter().any(|p| p.abs() > 1e-3);
                }
            }
            assert!(noticed);
        }
    }
}

#[test]
fn loads_reactions_and_the_force_of_the_other_body_balance_on_each_body() {
    for seed in 1..=12 {
        let problem = drawn(seed, LAWS[seed as usize % 3]);
        for degree in DEGREES {
            let s = proved(&problem, &with_kappa(degree, 0.5));
            let pair = &s.boundaries[0];
            let force = Vector2::from(pair.resultant);
            let reaction = |name: &str| Vector2::from(s.quantities.reactions[name]);
            let moment = |name: &str| s.quantities.reaction_moments[name];
            // The rounding of some hundred forces.
            let most = 1e-13 * size(force);
            let lower = size(reaction("lower.bottom") + force);
            let upper = size(reaction("upper.top") - force);
            let turning = [moment("lower.bottom") + pair.moment, moment("upper.top") - pair.moment];
            assert!(lower <= most && upper <= most, "{seed} {degree:?}: {lower:e} {upper:e}");
            let law = LAWS[seed as usize % 3];
            if law != Law::Bonded {
                let off = turning.map(f64::abs).into_iter().fold(0.0, f64::max);
                assert!(off <= most, "{seed} {degree:?}: {turning:?}");
            }
        }
    }
}

/// Whether `share` a(v, v) is larger than the squared stress that A subtracts, for all v: by the factor of the difference.
fn is_above_the_stress(share: f64, d: &Discretization) -> bool {
    let neighbours = Neighbours::across(&d.space, &d.contact);
    let order: Vec<usize> = (0..d.space.nodes().len()).collect();
    let numbering = Numbering::under(&order, &d.constraints);
    let stiffness = matrix::assemble_stiffness(d, &numbering, &neighbours).unwrap();
    let mut difference = matrix::assemble(d, &numbering, &neighbours).unwrap();
    assert_eq!(stiffness.rows, difference.rows);
    for (entry, k) in difference.values.iter_mut().zip(&stiffness.values) {
        *entry += (share - 1.0) * k;
    }
    Factor::new(&difference).is_ok()
}

#[test]
fn the_stress_that_is_subtracted_is_at_most_kappa_times_the_energy() {
    let mut above_half = 0;
    for seed in 1..=number_from("SIGNORINI_PAIRS", 8) {
        for (law, degree) in LAWS.into_iter().zip([Degree::One, Degree::Two, Degree::Two]) {
            let problem = drawn(seed, law);
            let free = Method { allow_noncoercive: true, ..with_kappa(degree, 1.0) };
            let mut d = discretize(&problem, &free).unwrap();
            assert_abs_diff_eq!(d.kappa(), 1.0, epsilon = 1e-12);
            assert!(is_above_the_stress(1.0 + 1e-9, &d), "{seed} {law:?} {degree:?}");
            above_half += usize::from(!is_above_the_stress(0.5, &d));
            // The control: each piece counted twice.
            let again: Vec<Piece> = d.contact.clone();
            d.contact.extend(again);
            assert!(!is_above_the_stress(1.0 + 1e-9, &d), "{seed} {law:?} {degree:?}");
        }
    }
    println!("more than half of the energy: {above_half}");
    assert!(above_half > 0);
}
