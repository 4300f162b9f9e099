//! A stiff body is a rigid obstacle, steps of Newton's method are few for all ratios of moduli, and the names of the bodies do not
//! matter.

use approx::assert_abs_diff_eq;

use super::*;
use crate::common::DEGREES;

/// Two unit blocks, the lower one of modulus 1, pressed and tilted from below; the upper one stands still.
fn tilted(cells: [usize; 2], modulus: f64, swapped: bool) -> Problem {
    two_squares(cells, [1.0, modulus].map(|modulus| young(modulus, 0.3)), between(swapped))
        .with("lower.bottom", Condition::displacement(|_| 0.0, |[x, _]| 0.05 + 0.1 * (x - 0.5)))
        .with("upper.top", Condition::clamped())
}

/// The same lower block under a rigid obstacle.
fn rigid(n: usize) -> Problem {
    one_square(n)
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
fn both_sides_of_a_pair_have_the_same_numbers_and_opposite_directions() {
    for degree in DEGREES {
        let s = proved(&tilted([4, 3], 2.0, false), &method(degree));
        let (first, second) = s.contact.split_at(s.pieces.len());
        assert_eq!(first.len(), second.len());
        let (mut opening, mut varies) = (f64::NEG_INFINITY, 0.0_f64);
        for ((a, b), piece) in first.iter().zip(second).zip(&s.pieces) {
            let stress = piece.sigma_n(&s.displacement);
            // The points go along the piece: its stress at the ends is that of the first and of the last.
            let names = [a, b].map(|edge| &*edge.boundary);
            assert_eq!(names, ["lower.top", "upper.bottom"]);
            let (a, b) = (&a.points, &b.points);
            let ends = [a[0].sigma_n, a[a.len() - 1].sigma_n];
            assert_abs_diff_eq!(ends[..], stress[..], epsilon = 1e-14);
            varies = varies.max((stress[1] - stress[0]).abs());
            for (a, b) in a.iter().zip(b) {
                let [d, e] = [a.direction, b.direction];
                assert_eq!(d, e.map(|c| -c));
                let [u, v] = [a.displacement, b.displacement];
                // A dozen roundings of numbers below 1.
                assert_abs_diff_eq!(
                    a.u_n,
                    (u[0] - v[0]) * d[0] + (u[1] - v[1]) * d[1],
                    epsilon = 1e-14
                );
                assert_eq!(
                    (a.u_n, a.gap, a.sigma_n, a.lambda),
                    (b.u_n, b.gap, b.sigma_n, b.lambda)
                );
                let slip = (u[1] - v[1]) * d[0] - (u[0] - v[0]) * d[1];
                assert_abs_diff_eq!(a.u_t, slip, epsilon = 1e-14);
                opening = opening.max(a.gap - a.u_n);
            }
        }
        let told = s.boundaries[0].opening.unwrap();
        // Between the nodes P2 may open further.
        assert!(told >= opening && (degree == Degree::Two || told <= opening + 1e-15));
        // Control: the bodies are apart somewhere, and the stress of P2 is not the same at both ends.
        assert!(opening > 1e-6, "{opening}");
        assert!(degree == Degree::One || varies > 1e-6, "{varies}");
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

/// Of a material whose stress along the interface is more than that across it: glue bears both.
#[test]
fn glue_is_proved_up_to_its_limit_and_not_beyond_straight_and_round() {
    let material = Material::tensor([20.0, 1.0, 0.0, 2.0, 0.0, 3.0], Some([0.0; 3]));
    for bend in [0.0, 0.3] {
        let curve = move |x: f64| bend * x * (1.0 - x);
        let lower = move |[x, t]: [f64; 2]| [x, -1.0 + (1.0 + curve(x)) * t];
        let upper = move |[x, t]: [f64; 2]| [x, curve(x) + (1.0 - curve(x)) * t];
        let block = |name, n, map| Block { name, cells: [n, 2], material, map };
        let problem = bodies(
            &[block("lower", 4, &lower), block("upper", 3, &upper)],
            &[Pair::new("lower.top", "upper.bottom").with_law(Law::Bonded)],
        )
        .with("lower.bottom", Condition::clamped())
        .with("upper.top", Condition::displacement(|_| 0.01, |_| 0.02));
        for degree in DEGREES {
            let verdict = |kappa| {
                let method = Method { allow_noncoercive: true, ..with_kappa(degree, kappa) };
                solve(&problem, &method, &Settings::default()).unwrap().0.verdict
            };
            let [below, beyond] = [1.0 - 1e-6, 1.0 + 1e-6].map(verdict);
            assert_eq!(below.name(), "proved", "{bend} {degree:?}: {below:?}");
            assert_ne!(beyond.name(), "proved", "{bend} {degree:?}");
        }
    }
}
