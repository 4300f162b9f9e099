//! Theorem 3.5, Corollary 3.6 and Remark 3.7 on exact solutions: for u in H^s the errors in the energy and in the contact
//! norms are at most C h^min(p, s - 1). Then Theorem 3.4 and Corollary 3.6 themselves, as inequalities between numbers.
//!
//! Rates are slopes fitted over four meshes of P1, 8 to 64 cells a side, and three of P2, gamma0 fixed. What is expected comes from the theory:
//! the degree and the regularity. How wide a band is, and why:
//!
//! - 0.06 on structured meshes: the rate is that of the leading term, and the next ones are still there at h = 1/64. For the
//!   wedge they are 5% of the rate: the corner's second term has an exponent hardly larger than the first.
//! - 0.15 on meshes with vertices moved at random: there the constant in C h^r changes from mesh to mesh. The size of the
//!   triangle at a singular point alone changes by a fifth, and with it the error by up to a fifth: over a factor of 8 in h
//!   that is 0.1 in the slope.
//! - An error may fall faster than the bound: upper ends are given only where the theory says that nothing faster can be
//!   (the energy error of P1 and P2 for a solution that is not in V^h; the corner; P2 on (b) with c on a node).
//!
//! Meshes with fewer than 8 cells a side are too coarse to count. A failure prints all errors.

use std::sync::Arc;

use crate::common::DEGREES;
use crate::common::exact::{
    corner, moved, on_square, on_trapezoid, singular, smooth, smooth_with_gap,
};
use approx::{abs_diff_eq, assert_relative_eq};
use signorini::contact::contact_line::assemble;
use signorini::contact::{Discretization, EdgeRule, Piece, residual};
use signorini::exact::{Errors, Exact};
use signorini::kernel::P2;
use signorini::model::Degree;
use signorini::model::{Problem, Space, loads};
use signorini::nalgebra::Vector2;
use signorini::results::Solution;
use signorini::solve::iterate::Evaluated;
use signorini::solve::{Gamma0, Settings, solve_discrete};
use study::a_priori;
use study::interpolation::{Interpolation, seminorms};
use study::ladder::{fitted_slope, rates};
use study::{Ladder, Theorem};

/// How many meshes: on the finest ones P1 and P2 have the same nodes.
const fn levels(degree: Degree) -> usize {
    match degree {
        Degree::One => 4,
        Degree::Two => 3,
    }
}
const COARSEST: usize = 8;

/// A norm with its name.
type Norm = (&'static str, fn(&Errors) -> f64);

const ENERGY: Norm = ("energy", |e| e.energy);
const H1: Norm = ("h1", |e| e.h1);
const L2: Norm = ("l2", |e| e.l2);
const CONTACT: Norm = ("contact_residual", |e| e.contact_residual);
const STRESS: Norm = ("normal_stress", |e| e.normal_stress);

/// h and errors on the levels of a ladder, at one gamma0.
fn climb(ladder: Ladder) -> (Vec<f64>, Vec<Errors>) {
    let levels = levels(ladder.method.degree);
    let ladder = ladder.with_one_gamma0(levels).unwrap();
    let solve = |level| ladder.solve(level).unwrap_or_else(|e| panic!("level {level}: {e}")).0;
    (0..levels).map(solve).map(|level| (level.h, level.errors)).unzip()
}

/// The fitted slopes in these norms lie in their bands.
fn rates_are(what: &str, ladder: Ladder, expected: &[(Norm, [f64; 2])]) {
    let (h, errors) = climb(ladder);
    for &((norm, of), [low, high]) in expected {
        let error: Vec<f64> = errors.iter().map(of).collect();
        let slope = fitted_slope(&h, &error);
        assert!(
            low <= slope && slope <= high,
            "{what}, {norm}: slope {slope:.3}, expected {low} to {high}\nh {h:.4?}\nerror {error:?}\nrates {:.3?}",
            rates(&h, &error)
        );
    }
}

/// Around `rate`.
fn about(rate: f64, band: f64) -> [f64; 2] {
    [rate - band, rate + band]
}

/// At least `rate`.
fn least(rate: f64, band: f64) -> [f64; 2] {
    [rate - band, f64::INFINITY]
}

const STRUCTURED: f64 = 0.06;
const MOVED: f64 = 0.15;

#[test]
fn p1_converges_with_rate_1_where_the_solution_is_in_h2() {
    for (what, solution) in
        [("(a) 3 2, c = 1/3", smooth(3.0, 2.0, 1.0 / 3.0)), ("(b) c = 1/3", singular(1.0 / 3.0))]
    {
        let ladder = on_square(&solution, Degree::One, COARSEST);
        let expected = |band| {
            [
                (ENERGY, about(1.0, band)),
                (H1, about(1.0, band)),
                (CONTACT, least(1.0, band)),
                (STRESS, least(1.0, band)),
                // One order more by duality, which needs no more than H2 regularity of the linear problem here.
                (L2, least(2.0, 2.0 * band)),
            ]
        };
        rates_are(&format!("{what} structured"), ladder.clone(), &expected(STRUCTURED));
        rates_are(&format!("{what} moved"), moved(ladder), &expected(MOVED));
    }
}

#[test]
fn p2_converges_with_rate_2_where_the_solution_is_in_h3_piece_by_piece() {
    // With c = 1/2 the line x = c consists of edges, on structured meshes: u is a polynomial in x on both sides.
    let aligned = on_square(&smooth(3.0, 2.0, 0.5), Degree::Two, COARSEST);
    let band = STRUCTURED;
    let expected = [
        (ENERGY, about(2.0, band)),
        (H1, about(2.0, band)),
        (CONTACT, least(2.0, band)),
        (STRESS, least(2.0, band)),
        (L2, least(3.0, 2.0 * band)),
    ];
    rates_are("(a) 3 2, c = 1/2", aligned, &expected);
    let ladder = on_square(&smooth(4.0, 3.0, 1.0 / 3.0), Degree::Two, COARSEST);
    rates_are("(a) 4 3, c = 1/3", ladder.clone(), &expected);
    let band = MOVED;
    let expected = [
        (ENERGY, about(2.0, band)),
        (H1, about(2.0, band)),
        (CONTACT, least(2.0, band)),
        (STRESS, least(2.0, band)),
    ];
    rates_are("(a) 4 3, c = 1/3 moved", moved(ladder), &expected);
}

#[test]
fn p2_converges_with_rate_3_2_at_least_where_the_solution_is_in_h5_2() {
    // (a) 3 2 with the kink inside the triangles: the rate comes down to 3/2 from above, for the smooth part of the error
    // (rate 2) is the larger one until n = 100 or so.
    let kinked = on_square(&smooth(3.0, 2.0, 1.0 / 3.0), Degree::Two, COARSEST);
    for (what, ladder, band) in [("", kinked.clone(), STRUCTURED), (" moved", moved(kinked), MOVED)]
    {
        let between = [1.5 - band, 2.0 + band];
        let expected = [
            (ENERGY, between),
            (H1, between),
            (CONTACT, least(1.5, band)),
            (STRESS, least(1.5, band)),
        ];
        rates_are(&format!("(a) 3 2, c = 1/3{what}"), ladder, &expected);
    }
    // (b) with the end of contact at a node: r^(3/2), nothing better.
    let node = on_square(&singular(0.5), Degree::Two, COARSEST);
    let all = [ENERGY, H1, CONTACT, STRESS].map(|norm| (norm, about(1.5, STRUCTURED)));
    rates_are("(b) c = 1/2", node, &all);
    // With c = 1/3 the end of contact lies at 1/3 and 2/3 of its edge by turns: errors on Gamma_C alternate by a factor, so
    // the slope over 8, 16, 32, 64 is off by a third of the logarithm of this factor to base 2 at most.
    let inside = on_square(&singular(1.0 / 3.0), Degree::Two, COARSEST);
    let expected = [
        (ENERGY, about(1.5, 2.0 * STRUCTURED)),
        (H1, about(1.5, 2.0 * STRUCTURED)),
        (CONTACT, about(1.5, 0.6)),
        (STRESS, about(1.5, 0.3)),
    ];
    rates_are("(b) c = 1/3", inside, &expected);
}

#[test]
fn p1_and_p2_converge_with_rate_alpha_at_a_corner_and_no_faster() {
    for omega in [0.75, 0.6] {
        let (solution, alpha) = corner(omega);
        for degree in DEGREES {
            let ladder = on_trapezoid(&solution, omega, degree, COARSEST);
            let all = |band| [ENERGY, H1, CONTACT, STRESS].map(|norm| (norm, about(alpha, band)));
            let what = format!("(c) omega = {omega} pi, P{}", degree.number());
            rates_are(&what, ladder.clone(), &all(STRUCTURED));
            rates_are(&format!("{what} moved"), moved(ladder), &all(MOVED));
        }
    }
}

/// The solutions and meshes on which Theorem 3.4 is tested, with 4 x 4 cells on level 0.
fn theorem_ladders() -> Vec<(String, Ladder)> {
    let mut all = Vec::new();
    for degree in DEGREES {
        let mut add = |what: &str, ladder: Ladder| {
            let what = format!("{what}, P{}", degree.number());
            all.push((format!("{what}, moved"), moved(ladder.clone())));
            all.push((what, ladder));
        };
        for c in [0.5, 1.0 / 3.0] {
            add(&format!("(a) 3 2, c = {c:.2}"), on_square(&smooth(3.0, 2.0, c), degree, 4));
            add(&format!("(b) c = {c:.2}"), on_square(&singular(c), degree, 4));
        }
        // The discrete gap is the interpolant of this one.
        add("(a) 4 3 with a gap", on_square(&smooth_with_gap(), degree, 4));
        for omega in [0.75, 0.6] {
            let ladder = on_trapezoid(&corner(omega).0, omega, degree, 4);
            add(&format!("(c) omega = {omega:.2} pi"), ladder);
        }
    }
    all
}

/// The same ladder with gamma0 = kappa / C_h on level `level`.
fn at_kappa(ladder: &Ladder, level: usize, kappa: f64) -> Ladder {
    let mut ladder = ladder.clone();
    let limit = ladder.outline(level).unwrap().gamma.coercivity.limit();
    ladder.method.gamma0 = Gamma0::Value(kappa * limit);
    ladder
}

fn theorem(ladder: &Ladder, level: usize) -> Theorem {
    let (_, problem, solution) = ladder.solve(level).unwrap();
    Theorem::new(&problem, &solution, &*ladder.solution).unwrap()
}

#[test]
fn theorem_3_4_and_corollary_3_6_bound_the_errors_on_every_mesh_at_every_kappa() {
    for (what, ladder) in theorem_ladders() {
        for level in 0..2 {
            for kappa in [1e-3, 0.5, 0.99] {
                let t = theorem(&at_kappa(&ladder, level, kappa), level);
                let (left, all) = (t.left(), [t.plain(), t.sharp(), t.projected()]);
                // Both sides are computed to 1e-10.
                let least = left * (1.0 - 1e-9);
                assert!(
                    all.iter().all(|right| *right >= least),
                    "{what}, level {level}, kappa {kappa}: {left:e} against {all:?}"
                );
                assert!(t.sharp() <= t.plain(), "{what}, level {level}, kappa {kappa}");
                let (left, right) = (t.discrete.normal_stress, t.corollary());
                assert!(left <= right * (1.0 + 1e-9), "{what}, kappa {kappa}: {left:e} {right:e}");
                // The projection is the best approximation in the energy norm.
                let best = t.projection.energy * (1.0 - 1e-9);
                assert!(best <= t.interpolant.energy && best <= t.discrete.energy, "{what}");
            }
        }
    }
}

/// The constants of the interpolation estimates on a mesh.
fn constants(problem: &Problem, solution: &Solution, ladder: &Ladder) -> Interpolation {
    let space = Space::new(&problem.mesh, Degree::One);
    let contact = assemble(problem, &space, solution.gamma.gamma).unwrap();
    Interpolation::new(&space, &contact, ladder.solution.material())
}

/// |u|_2
fn seminorm(problem: &Problem, exact: &Exact) -> f64 {
    let all = seminorms(&Space::new(&problem.mesh, Degree::One), &**exact).unwrap();
    all.iter().map(|u| u * u).sum::<f64>().sqrt()
}

#[test]
fn theorem_3_5_bounds_the_error_by_a_number_and_the_second_derivatives() {
    // The bound grows as 1 / (1 - kappa).
    for (what, ladder) in theorem_ladders() {
        let in_h2 = ladder.method.degree == Degree::One && !what.starts_with("(c)");
        // No number is claimed elsewhere.
        let (levels, kappas) = if in_h2 { (3, vec![0.1, 0.5, 0.9]) } else { (1, vec![0.5]) };
        for level in 0..levels {
            for &kappa in &kappas {
                let (level, problem, solution) =
                    at_kappa(&ladder, level, kappa).solve(level).unwrap();
                let left = a_priori::left(level.kappa, &level.errors);
                let ratio = level.proved.map(|proved| proved / left);
                if let Some(proved) = level.proved {
                    // Both are integrals known to 1e-9; the second is a number times |u|_2.
                    let constant = constants(&problem, &solution, &ladder).constant(level.kappa);
                    let uniform = constant * seminorm(&problem, &ladder.solution);
                    assert!(proved <= uniform * (1.0 + 1e-9), "{what}: {proved} {uniform}");
                }
                println!("{what}, kappa {kappa}: {ratio:.2?}");
                assert_eq!(ratio.is_some(), in_h2, "{what}");
                assert!(
                    ratio.is_none_or(|ratio| (1.0..10.0 / (1.0 - kappa)).contains(&ratio)),
                    "{what}: {ratio:?}"
                );
            }
        }
    }
}

#[test]
fn the_number_of_theorem_3_5_is_5_legs_of_the_triangles_and_the_seminorms_are_known() {
    // lambda = mu = 1, right isosceles triangles with legs of 1/4, kappa = 1/2.
    let ladder = at_kappa(&on_square(&singular(0.5), Degree::One, 4), 0, 0.5);
    let (_, problem, solution) = ladder.solve(0).unwrap();
    assert_relative_eq!(
        4.0 * constants(&problem, &solution, &ladder).constant(0.5),
        5.073,
        epsilon = 1e-3
    );
    // Found by another program.
    let (smooth, singular) = (smooth(4.0, 3.0, 1.0 / 3.0), singular(0.5));
    assert_relative_eq!(seminorm(&problem, &smooth), 42.479, epsilon = 1e-3);
    assert_relative_eq!(seminorm(&problem, &singular), 0.98103, epsilon = 1e-5);
}

#[test]
fn control_the_theorem_fails_for_a_solution_that_is_not_the_discrete_one() {
    // The bound is within a factor of 4 of the error at kappa = 1/2: an error ten times larger breaks it.
    for (what, ladder) in theorem_ladders() {
        let ladder = at_kappa(&ladder, 1, 0.5);
        let (_, problem, mut solution) = ladder.solve(1).unwrap();
        for (u, &x) in solution.displacement.iter_mut().zip(&solution.nodes) {
            let exact = ladder.solution.displacement(x);
            *u = [0, 1].map(|c| u[c] + 20.0 * (u[c] - exact[c]));
        }
        let t = Theorem::new(&problem, &solution, &*ladder.solution).unwrap();
        assert!(t.left() > t.projected(), "{what}: {:e} {:e}", t.left(), t.projected());
    }
}

/// The levels on which variants are tried.
const OF_VARIANTS: usize = 3;

/// The H1 errors, on levels from the coarsest one, of a variant of the method for (a) 4 3, c = 1/2, in the norms of the true method;
/// `None` where it has no solution.
fn variant(degree: Degree, modify: impl Fn(&mut Discretization)) -> [Option<f64>; OF_VARIANTS] {
    let ladder = on_square(&smooth(4.0, 3.0, 0.5), degree, COARSEST);
    std::array::from_fn(|level| {
        let problem = ladder.problem(level).unwrap();
        let rule = EdgeRule::Exact;
        let mut d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, rule).unwrap();
        let contact = d.contact.clone();
        modify(&mut d);
        // A variant is none of (8): a proof would be of another problem.
        let settings = Settings { proof: f64::INFINITY, ..ladder.settings };
        let (Evaluated { u, .. }, ..) = solve_discrete(&d, &settings).ok()?;
        Some(Errors::new(&d.space, &contact, &u, &*ladder.solution).h1)
    })
}

/// h halves from level to level.
fn last_rate(errors: &[Option<f64>]) -> f64 {
    let [.., Some(a), Some(b)] = errors else { panic!("no solution: {errors:?}") };
    (a / b).log2()
}

fn rebuilt(d: &mut Discretization, gamma: impl Fn(f64, f64) -> f64) {
    let with_gamma = |piece: &Piece| {
        residual::piece_with(d, piece, |side, stretch| {
            let h = d.space.mesh().diameter(stretch.edge.triangle);
            (side.length, side.normal, gamma(d.gamma0, h))
        })
    };
    d.contact = d.contact.iter().map(with_gamma).collect();
}

/// The largest diameter on the coarsest level.
const H0: f64 = std::f64::consts::SQRT_2 / COARSEST as f64;

#[test]
fn the_variant_without_a_change_converges() {
    for (degree, expected) in [(Degree::One, 1.0), (Degree::Two, 2.0)] {
        let rate = last_rate(&variant(degree, |d| rebuilt(d, |gamma0, h| gamma0 * h)));
        assert!(abs_diff_eq!(rate, expected, epsilon = 0.1), "{degree:?}: {rate}");
    }
}

#[test]
fn control_a_fixed_penalty_without_the_consistency_terms_stalls() {
    // sigma_n is left out of P and of A: what remains is a penalty method with the fixed parameter 1/gamma.
    let errors = variant(Degree::One, |d| {
        for edge in &mut d.contact {
            edge.gamma = 1.0;
            let (local, normal) = (edge.edge().local, edge.normal());
            for (functional, node) in edge.p0.iter_mut().zip([1, 2]) {
                *functional = vec![Vector2::zeros(); 3];
                functional[(local + node) % 3] = normal;
            }
            edge.sigma_n = vec![vec![Vector2::zeros(); 3]; 2];
        }
    });
    assert!(last_rate(&errors) < 0.3, "{errors:?}");
}

#[test]
fn control_gamma_without_h_or_over_h_loses_coercivity_on_fine_meshes() {
    // gamma as on the coarsest mesh: kappa is 1/2 there and doubles from mesh to mesh, or is multiplied by four.
    let [first, _, third] = variant(Degree::One, |d| rebuilt(d, |gamma0, _| gamma0 * H0));
    assert!(first.is_some() && third.is_none(), "{third:?}");
    let errors = variant(Degree::One, |d| rebuilt(d, |gamma0, h| gamma0 * H0 * H0 / h));
    assert!(errors[0].is_some() && errors[1..].iter().all(Option::is_none), "{errors:?}");
}

#[test]
fn control_the_contact_term_with_the_wrong_sign_gives_no_solution_or_a_wrong_one() {
    let right = variant(Degree::One, |_| {});
    // gamma < 0 in the weight of [P]+ P0 and in A; P keeps its gamma.
    let wrong = variant(Degree::One, |d| {
        d.contact.iter_mut().for_each(|edge| edge.gamma = -edge.gamma);
    });
    for (right, wrong) in right.iter().zip(&wrong) {
        assert!(wrong.is_none_or(|wrong| wrong > 5.0 * right.unwrap()), "{right:?} {wrong:?}");
    }
}

#[test]
fn control_a_stress_with_the_wrong_sign_in_p_costs_p2_its_rate() {
    // P = u_n + gamma sigma_n: the exact solution no longer satisfies the discrete equation.
    let errors = variant(Degree::Two, |d| {
        for edge in &mut d.contact {
            let opposite = signorini::kernel::ContactEdge::new::<P2>(
                &d.space.mesh().triangle(edge.edge().triangle),
                edge.edge().local,
                edge.normal(),
                d.problem.material.of(0),
                -edge.gamma,
            );
            edge.p0 = opposite.p0.map(|row| row.to_vec()).to_vec();
        }
    });
    assert!(last_rate(&errors) < 1.3, "{errors:?}");
}

#[test]
fn control_a_load_by_one_point_costs_p2_its_rate() {
    let errors = variant(Degree::Two, |d| {
        d.load = loads::assemble_with(d.problem, &d.space, |_| 1).unwrap();
    });
    assert!(last_rate(&errors) < 1.5, "{errors:?}");
}

#[test]
fn control_bilateral_contact_does_not_converge_to_the_unilateral_solution() {
    // [P]+ becomes P: the obstacle is raised so far that P > 0 everywhere, and what this adds, the known force
    // int (1/gamma) RAISED P0(v), is taken off again.
    const RAISED: f64 = 100.0;
    let errors = variant(Degree::One, |d| {
        for edge in &mut d.contact {
            let geometry = Arc::make_mut(&mut edge.geometry);
            geometry.nodes.iter_mut().for_each(|node| node.gap -= RAISED);
            let force = edge.length / edge.gamma * RAISED / 2.0;
            for functional in &edge.p0 {
                for (&node, f) in edge.nodes.iter().zip(functional) {
                    for c in 0..2 {
                        d.load[node][c] += force * f[c];
                    }
                }
            }
        }
    });
    assert!(last_rate(&errors).abs() < 0.2 && errors[2].unwrap() > 0.1, "{errors:?}");
}
