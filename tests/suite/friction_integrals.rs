//! The integrals of friction over an edge: the exact sections of P1 and P2 beside a fine rule, and the Bregman distance beside the change
//! of energy.

use approx::{abs_diff_eq, assert_abs_diff_eq, assert_relative_eq};
use signorini::kernel::friction::{
    ExactFriction, FrictionIntegrals, clip, clip_bregman, clip_energy, exact_clip_bregman,
    gauss_friction,
};
use signorini::kernel::{P1, P2};

/// A few roundings of numbers of size 1.
const ROUNDING: f64 = 2e-15;

/// 5,000 midpoints on the edge.
fn fine() -> impl Iterator<Item = (f64, f64)> {
    (0..5_000).map(|i| ((f64::from(i) + 0.5) / 5_000.0, 1.0 / 5_000.0))
}

/// Returns whether two sets of integrals are the same to these tolerances, of what is continuous and of what jumps.
fn close<const M: usize>(
    a: &FrictionIntegrals<f64, M>,
    b: &FrictionIntegrals<f64, M>,
    [smooth, jumps]: [f64; 2],
) -> bool {
    let near = |x: f64, y: f64, epsilon: f64| abs_diff_eq!(x, y, epsilon = epsilon);
    let entries = (0..M).all(|i| {
        near(a.gradient[i], b.gradient[i], smooth)
            && (0..M).all(|j| {
                near(a.by_p[i][j], b.by_p[i][j], jumps)
                    && near(a.by_bound[i][j], b.by_bound[i][j], jumps)
            })
    });
    entries
        && near(a.energy, b.energy, smooth)
        && near(a.sticks, b.sticks, jumps)
        && near(a.slides, b.slides, jumps)
}

/// Values of P and m: sticking, sliding both ways, open, cut at one to six places.
fn draws() -> impl Iterator<Item = [[f64; 3]; 2]> {
    let mut x = 0.7_f64;
    let mut next = move || {
        x = (x * 3.9) * (1.0 - x);
        2.0 * x - 1.0
    };
    (0..300).map(move |i| {
        let p = [next(), next(), next()];
        let m = [next(), next(), next()];
        match i % 3 {
            0 => [p, [m[0].abs(); 3]],
            1 => {
                let [a, b] = [m[0].abs(), m[1].abs()];
                [p, [a, b, (a + b) / 2.0]]
            }
            _ => [p, m],
        }
    })
}

/// Errors of the rule: a jump at one of six cuts costs a cell of the fine rule, times 1, a kink there the square of one.
const FINE: [f64; 2] = [1e-6, 1.6e-3];

fn agrees_with_a_fine_rule<E: ExactFriction<f64, N, M>, const N: usize, const M: usize>(
    bound: impl Fn(f64) -> f64,
) -> bool {
    draws().all(|[p, m]| {
        let of = |v: [f64; 3]| std::array::from_fn(|a| v[a]);
        let (p, m): ([f64; M], [f64; M]) = (of(p), of(m));
        let fine = gauss_friction::<E, f64, N, M>(p, m, fine());
        close(&E::exact_friction(p, m.map(&bound)), &fine, FINE)
    })
}

#[test]
fn the_sections_of_p1_and_p2_agree_with_a_fine_rule() {
    assert!(agrees_with_a_fine_rule::<P1, 3, 2>(|m| m));
    assert!(agrees_with_a_fine_rule::<P2, 6, 3>(|m| m));
}

#[test]
fn control_sections_for_a_bound_that_is_a_little_wider_do_not() {
    assert!(!agrees_with_a_fine_rule::<P1, 3, 2>(|m| m + 1e-3));
    assert!(!agrees_with_a_fine_rule::<P2, 6, 3>(|m| m + 1e-3));
}

#[test]
fn nothing_cancels_for_a_large_bound() {
    let p = [0.3, -0.7];
    let sticking = P1::exact_friction(p, [1e300; 2]);
    let mass = |a: usize| [2.0 * p[a] + p[1 - a], 6.0];
    for a in 0..2 {
        let [above, below] = mass(a);
        assert_relative_eq!(sticking.gradient[a], above / below, max_relative = 1e-15);
    }
    // By [P + m]+ - [P - m]+ - m nothing would be left.
    assert_eq!((p[0] + 1e300) - 1e300, 0.0);
    assert_eq!(clip(0.3, 1e300), 0.3);
}

#[test]
fn the_bregman_distance_is_the_nonlinear_part_of_the_change_of_energy() {
    for ([p, m], [q, _]) in draws().zip(draws().skip(7)) {
        let m = m.map(f64::abs);
        let m = [m[0], m[1], (m[0] + m[1]) / 2.0];
        let of = |v| P2::exact_friction(v, m);
        let linear: f64 = (0..3).map(|a| of(p).gradient[a] * (q[a] - p[a])).sum();
        let expected = of(q).energy - of(p).energy - linear;
        let found = exact_clip_bregman::<P2, 6, 3>(p, q, m);
        assert!(found >= 0.0);
        // Energies below 2 are subtracted.
        assert_abs_diff_eq!(found, expected, epsilon = 10.0 * ROUNDING);
    }
}

#[test]
fn the_bregman_distance_keeps_its_digits_where_a_difference_of_energies_has_none() {
    let far = clip_bregman(1.0, 1.0 + 1e-9, 2.0);
    let step = (1.0 + 1e-9) - 1.0;
    assert_relative_eq!(far, step * step / 2.0, max_relative = 1e-15);
    let difference = clip_energy(1.0 + 1e-9, 2.0) - clip_energy(1.0, 2.0) - 1e-9;
    assert!((difference - step * step / 2.0).abs() > step * step);
}

#[test]
fn nan_is_not_no_friction() {
    assert!(clip(f64::NAN, 1.0).is_nan());
    assert!(P1::exact_friction([f64::NAN, 0.0], [1.0, 1.0]).gradient[0].is_nan());
    assert!(P2::exact_friction([0.0, f64::NAN, 0.0], [1.0; 3]).gradient[0].is_nan());
    let gauss = gauss_friction::<P1, f64, 3, 2>([f64::NAN, 0.0], [1.0; 2], [(0.5, 1.0)]);
    assert!(gauss.energy.is_nan());
}
