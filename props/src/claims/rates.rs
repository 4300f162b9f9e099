//! Theorem 3.5, Corollary 3.6 and Remark 3.7: rates of convergence. They are statements about h -> 0, with constants that
//! depend on the unknown solution: they can be observed on exact solutions, not established by running code (the bound of P1 with
//! its number is in `interpolation`).
//!
//! Observed here: the wedge in full contact, whose regularity H^(1 + alpha) makes every norm fall at the rate alpha and no
//! faster (0 < nu < 1/2), and the end of contact, in H^(5/2), where P1 has the rate 1 and P2 the rate 3/2 of Remark 3.7.
//! The whole study is `tests/suite/convergence.rs` and `docs/convergence.md`.

use signorini::exact::Errors;
use signorini::model::Degree;
use study::ladder::fitted_slope;
use study::{Ladder, Theorem};

use super::known::{Known, Sample};
use crate::claim::{Claim, Outcome, noticed, text};

/// Cells a side on the coarsest mesh, and how many meshes.
const COARSEST: usize = 4;
const LEVELS: usize = 4;

/// How far a slope fitted over these meshes may be from the rate: the next term of the error is still there at h = 1/32.
const BAND: f64 = 0.08;

/// A solution for lambda = mu = 1.
fn ladder(known: Known, degree: Degree) -> Result<Ladder, String> {
    let sample = Sample { known, lambda: 1.0, n: COARSEST, moved: None, degree };
    sample.ladder().ok_or_else(|| "there is no such solution".to_owned())
}

/// The wedge of 3 pi/4.
fn wedge(degree: Degree) -> Result<Ladder, String> {
    ladder(Known::Corner(0.75), degree)
}

/// The end of contact at c = 1/2.
fn end_of_contact(degree: Degree) -> Result<Ladder, String> {
    ladder(Known::Singular([0.5, 1.0]), degree)
}

/// Those in H^2, 4 cells a side on the coarsest mesh.
pub(super) fn bodies_in_h2() -> Result<[Ladder; 3], String> {
    let smooth = |[k, m, c]: [f64; 3]| ladder(Known::Smooth([k, m, c, 8.0, 4.0]), Degree::One);
    Ok([end_of_contact(Degree::One)?, smooth([4.0, 3.0, 0.5])?, smooth([3.0, 2.0, 1.0 / 3.0])?])
}

/// The slopes of the energy, contact and normal stress errors.
fn slopes(ladder: Ladder) -> Result<[f64; 3], String> {
    let ladder = ladder.with_one_gamma0(LEVELS).map_err(text)?;
    let mut h = Vec::new();
    let mut errors: Vec<Errors> = Vec::new();
    for level in 0..LEVELS {
        let (level, _, _) = ladder.solve(level).map_err(text)?;
        h.push(level.h);
        errors.push(level.errors);
    }
    let slope =
        |of: fn(&Errors) -> f64| fitted_slope(&h, &errors.iter().map(of).collect::<Vec<_>>());
    Ok([slope(|e| e.energy), slope(|e| e.contact_residual), slope(|e| e.normal_stress)])
}

fn near(what: &str, slope: f64, rate: f64) -> Result<(), String> {
    if (slope - rate).abs() <= BAND {
        Ok(())
    } else {
        Err(format!("{what}: slope {slope:.3}, rate {rate:.3}"))
    }
}

fn wedge_rates_are(offset: f64) -> Outcome {
    let mut seen = Vec::new();
    for degree in [Degree::One, Degree::Two] {
        let ladder = wedge(degree)?;
        let alpha = ladder.solution.regularity() - 1.0;
        for slope in slopes(ladder)? {
            near("wedge", slope, alpha + offset)?;
            seen.push(format!("{slope:.2}"));
        }
    }
    Ok(format!("slopes {}", seen.join(" ")))
}

fn energy_rates() -> Outcome {
    let [p1, ..] = slopes(end_of_contact(Degree::One)?)?;
    let [p2, ..] = slopes(end_of_contact(Degree::Two)?)?;
    near("P1", p1, 1.0)?;
    near("P2", p2, 1.5)?;
    Ok(format!("energy slopes: P1 {p1:.2}, P2 {p2:.2}"))
}

/// Both sides of Theorem 3.4 with its constant, for solutions made by the solver: `scale` multiplies the left side.
pub(super) fn both_sides(scale: f64) -> Outcome {
    let mut least = f64::INFINITY;
    for degree in [Degree::One, Degree::Two] {
        for ladder in [wedge(degree)?, end_of_contact(degree)?] {
            let (_, problem, solution) = ladder.solve(1).map_err(text)?;
            let t = Theorem::new(&problem, &solution, &*ladder.solution).map_err(text)?;
            let (left, right) = (scale * t.left(), t.plain());
            // Both sides are integrals known to 1e-9.
            if !(left <= right * (1.0 + 1e-9)) {
                return Err(format!("left {left:e}, right {right:e}"));
            }
            least = least.min(right / left);
        }
    }
    Ok(format!("right side at least {least:.2} times the left"))
}

/// The energy errors of the a-orthogonal projection, and of what `other` answers with, which must be no smaller.
fn nearest(other: impl Fn(&Theorem) -> f64) -> Outcome {
    let mut least = f64::INFINITY;
    for degree in [Degree::One, Degree::Two] {
        for ladder in [wedge(degree)?, end_of_contact(degree)?] {
            let (_, problem, solution) = ladder.solve(1).map_err(text)?;
            let t = Theorem::new(&problem, &solution, &*ladder.solution).map_err(text)?;
            let (projection, other) = (t.projection.energy, other(&t));
            // Both are integrals known to 1e-9.
            if !(projection <= other * (1.0 + 1e-9)) {
                return Err(format!("projection {projection:e}, other {other:e}"));
            }
            least = least.min(other / projection);
        }
    }
    Ok(format!("the others are farther by a factor of at least {least:.6}"))
}

/// No v^h with the nodal values of u^h on Gamma_D is nearer to u in the energy norm.
pub fn projection_is_the_nearest() -> Outcome {
    nearest(|t| t.discrete.energy.min(t.interpolant.energy))
}

/// The interpolant for the projection: u^h is nearer.
pub fn interpolant_is_as_near() -> Outcome {
    noticed(nearest(|t| t.discrete.energy * t.projection.energy / t.interpolant.energy))
}

/// The row of the rates.
pub fn claim() -> Claim {
    Claim {
        id: "12",
        title: "Rates of convergence",
        paper: "|u - u^h|_1 + |gamma^1/2 (sigma_n(u) + (1/gamma)[P_gamma(u^h)]+)| <= C h^(1/2 + nu) |u|_(3/2 + nu), 0 < nu <= 1/2; the same rate for |gamma^1/2 sigma_n(u - u_h)|; for quadratic elements 0 < nu <= 3/2.",
        limits: "An observed rate is no proof. The rates are those for lambda = mu = 1; at the end of contact, of the energy error only.",
        single: Some("A rate is a limit: it can be observed in floating point only."),
        checks: vec![
            doubles!("the_wedge_converges_at_the_rate_alpha" => wedge_rates_are(0.0)).about(&[
                "Theorem 3.5",
                "(21)",
                "(25)",
            ]),
            doubles!("the_end_of_contact_has_the_rates_1_and_3_2" => energy_rates())
                .about(&["Theorem 3.5", "Remark 3.7"]),
            doubles!("control_the_rate_of_a_smoother_solution" => noticed(wedge_rates_are(0.2))),
        ],
    }
}
