//! A stiff body is a rigid obstacle, steps of Newton's method are few for all ratios of moduli, and the names of the bodies do not
//! matter.

use super::*;
use crate::common::DEGREES;

/// Two unit blocks, the lower one of modulus 1, pressed and tilted from below; the upper one stands still.
fn tilted(cells: [usize; 2], modulus: f64, swapped: bool) -> Problem {
    let (lower, upper) = (rectangle([0.0, 0.0], [1.0, 1.0]), rectangle([0.0, 1.0], [1.0, 2.0]));
    let block =
        |name, n, modulus, map| Block { name, cells: [n, n], material: young(modulus, 0.3), map };
    let mut sides = ["lower.top", "upper.bottom"];
    if swapped {
        sides.reverse();
    }
    bodies(
        &[block("lower", cells[0], 1.0, &lower), block("upper", cells[1], modulus, &upper)],
        &[Pair::new(sides[0], sides[1])],
    )
    .with("lower.bottom", Condition::displacement(|_| 0.0, |[x, _]| 0.05 + 0.1 * (x - 0.5)))
    .with("upper.top", Condition::clamped())
}

/// The same lower block under a rigid obstacle.
fn rigid(n: usize) -> Problem {
    let lower = rectangle([0.0, 0.0], [1.0, 1.0]);
    let block = Block { name: "lower", cells: [n, n], material: young(1.0, 0.3), map: &lower };
    bodies(&[block], &[])
        .with("lower.bottom", Condition::displacement(|_| 0.0, |[x, _]| 0.05 + 0.1 * (x - 0.5)))
        .with("lower.top", Condition::contact(|_| 0.0))
}

#[test]
fn a_stiff_body_acts_as_a_rigid_obstacle() {
    for degree in DEGREES {
        let obstacle = proved(&rigid(28), &with_kappa(degree, 0.5)).boundaries[0].force;
        let force = |ratio: f64| {
            proved(&tilted([28, 7], ratio, false), &method(degree)).boundaries[0].force
        };
        let off = (force(1e9) - obstacle).abs() / obstacle;
        assert!(off <= 1e-8, "{degree:?}: {off:e}");
        // The control: a body that is not so stiff gives way.
        assert!((force(1e3) - obstacle).abs() / obstacle > 1e-5);
    }
}

#[test]
fn newton_takes_few_steps_for_all_ratios_of_moduli() {
    for ratio in [1e-6, 1.0, 1e3, 1e6, 1e9] {
        for degree in DEGREES {
            let s = proved(&tilted([28, 7], ratio, false), &method(degree));
            let steps = s.newton.iterations();
            println!(
                "{degree:?}, E2/E1 = {ratio:e}: {steps} steps, force {}",
                s.boundaries[0].force
            );
            assert!(steps <= 12, "{degree:?}, E2/E1 = {ratio:e}: {steps} steps");
        }
    }
}

#[test]
fn the_names_of_the_bodies_do_not_matter() {
    for degree in DEGREES {
        for ratio in [1.0, 20.0] {
            let [a, b] = [false, true]
                .map(|swapped| proved(&tilted([7, 11], ratio, swapped), &method(degree)));
            let off = apart(&a.displacement, &b.displacement) / largest(&a.displacement);
            assert!(off <= 1e-13, "{degree:?}: {off:e}");
            let [a, b] = [&a.boundaries[0], &b.boundaries[0]];
            assert_eq!(
                (a.partner.as_deref(), b.partner.as_deref()),
                (Some("upper.bottom"), Some("lower.top"))
            );
            let sum = Vector2::from(a.resultant) + Vector2::from(b.resultant);
            assert!(size(sum) <= 1e-12 * a.force, "{sum}");
        }
    }
}

#[test]
fn control_equal_shares_of_the_stress_lose_the_rigid_limit() {
    // The share of a side is its gamma over that of both; with a half for each, the stiff body's stress counts as much as the soft one's.
    let force =
        |problem: &Problem, halves: bool| {
            let plant =
                |d: &Discretization| {
                    with_stress(d, |piece, i| {
                        if halves { 0.5 * piece.gamma / piece.sides[i].gamma } else { 1.0 }
                    })
                };
            let u = with_planted(problem, &method(Degree::One), plant)?;
            let d = discretize(problem, &method(Degree::One))?;
            let pieces = plant(&d);
            let forces = pieces.iter().map(|p| p.contribution(&d.rule, &p.p(&u)).resultant);
            Ok::<f64, SolveError>(forces.sum())
        };
    let obstacle = proved(&rigid(28), &with_kappa(Degree::One, 0.5)).boundaries[0].force;
    let problem = tilted([28, 7], 1e9, false);
    let off = |force: f64| (force - obstacle).abs() / obstacle;
    assert!(off(force(&problem, false).unwrap()) <= 1e-8);
    assert!(force(&problem, true).map_or(true, |force| off(force) > 1e-6));
}
