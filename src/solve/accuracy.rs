//! From a first answer to one that is known to be right: passes of a route, each from the true residual of the one before,
//! until the residual has reached the tolerance and a pass has nothing left to correct; and the verdict.
//!
//! The correction of a pass is the error of what it corrects, but for the error of the correction, which is smaller by the
//! same factor again. Its energy norm |du|_A beside that of u, and that of what the displacement loses when it is rounded to
//! doubles at the end, is the **forward error** that is reported; a small residual
//! alone says nothing where the condition number is large. Residuals are evaluated in doubles as long as these can tell.

use super::iterate::{Evaluation, Iterate};
use super::newton::{self, Until};
use super::system::System;
use super::{Settings, SolveError, Status};
use crate::fem::discretization::Discretization;
use crate::kernel::edge_integral::ExactEdge;

/// A way to better an iterate.
pub trait Route<E, const N: usize, const M: usize> {
    /// Moves `iterate`, where the linear part of (8) is `at`, to where the residual of (8) vanishes, as far as one pass can.
    ///
    /// # Errors
    /// As [`newton::minimise`].
    fn pass(
        &mut self,
        iterate: &mut Iterate,
        at: Evaluation,
        residuals: &mut Vec<f64>,
        until: Until,
    ) -> Result<Pass, SolveError>;
}

/// The size of what a pass has changed.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// |du|_A^2
    pub energy: f64,
    /// The largest |d|^2 / |d|_A^2 of what was solved for
    pub softness: f64,
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The displacement.
    pub u: Vec<[f64; 2]>,
    /// The relative residual of (8) before each Newton step and after the last.
    pub residuals: Vec<f64>,
    /// The relative residual of the displacement, from the definitions.
    pub residual: f64,
    /// |du|_A / |u|_a of the last correction, and the same of what rounding the displacement to doubles takes away.
    pub forward_error: f64,
    /// The condition number of the matrix, from below: Rayleigh quotients of what was solved for.
    pub condition: f64,
}

/// A correction this small, relative, leaves nothing to correct.
const SMALL: f64 = 1e-11;

/// A correction ends where the residual is this share of the tolerance.
const GOOD_ENOUGH: f64 = 1e-2;

/// No more passes than these: each takes the error down by a factor, or there is no point.
const MOST_PASSES: usize = 12;

/// The relative error in the energy norm up to which a displacement is a result at all.
pub const ACCEPTABLE: f64 = 1e-6;

/// Passes of `route` from the lift of the prescribed data on.
///
/// # Errors
/// As [`newton::minimise`].
pub fn refine<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    route: &mut impl Route<E, N, M>,
    reference: f64,
    settings: &Settings,
) -> Result<Outcome, SolveError>
where
    E: ExactEdge<f64, N, M>,
{
    let d = system.d;
    let mut iterate = Iterate::lift(d);
    let mut residuals = Vec::new();
    let mut at = iterate.evaluate(system, false);
    let mut forward_error = f64::INFINITY;
    let mut condition: f64 = 1.0;
    let norm = system.norm();
    let mut residual = f64::INFINITY;
    for pass in 0..MOST_PASSES {
        let precisely = at.precisely;
        // The first pass goes as far as it can; a correction need not better what is good enough.
        let enough = if pass == 0 { 0.0 } else { GOOD_ENOUGH * settings.tolerance };
        let until = Until { steps: settings.max_iterations, residual: enough };
        let change = route.pass(&mut iterate, at, &mut residuals, until)?;
        condition = condition.max(norm * change.softness);
        let before = forward_error;
        at = iterate.evaluate(system, precisely);
        residual = residual_of(system, &at) / reference;
        let size = d.strain_energy(&iterate.rounded()).sqrt();
        let moved = change.energy.sqrt();
        forward_error = if moved == 0.0 { 0.0 } else { moved / size };
        if pass == 0 {
            // The first pass comes from nowhere: what it moved is no error.
            forward_error = f64::INFINITY;
        }
        let out_of_steps =
            residuals.len() > settings.max_iterations && !(residual <= settings.tolerance);
        if out_of_steps || (residual <= settings.tolerance && forward_error <= SMALL) {
            break;
        }
        if pass > 0 && !precisely {
            // Doubles were not enough.
            at = iterate.evaluate(system, true);
        } else if pass > 1 && !(forward_error < before / 2.0) {
            break;
        }
    }
    let u = iterate.rounded();
    let size = d.strain_energy(&u).sqrt();
    let rounding = d.strain_energy(&iterate.remainder()).sqrt();
    if rounding > 0.0 {
        forward_error += rounding / size;
    }
    Ok(Outcome { u, residuals, residual, forward_error, condition })
}

/// The norm of the residual of (8) where its linear part is `at`.
fn residual_of<E, const N: usize, const M: usize>(system: &System<E, N, M>, at: &Evaluation) -> f64
where
    E: ExactEdge<f64, N, M>,
{
    let d = system.d;
    let mut r = at.linear.clone();
    for (e, edge) in d.contact.iter().enumerate() {
        let integrals = d.rule.integrals::<E, N, M>(newton::block(&at.p, e));
        let weight = edge.length / edge.gamma;
        system.functionals(e, |row, a, entry| r[row] += entry * weight * integrals.gradient[a]);
    }
    r.iter().map(|r| r * r).sum::<f64>().sqrt()
}

/// What residuals are relative to: |L| + |residual of the prescribed data| over the free degrees of freedom, or, where these
/// are nothing but rounding, the magnitudes of the forces that cancel there. 1 where there is no force at all.
pub fn reference<E, const N: usize, const M: usize>(d: &Discretization<E, N, M>) -> f64
where
    E: ExactEdge<f64, N, M>,
{
    let residual = d.residual(&d.constraints.lift());
    let prescribed: Vec<[f64; 2]> =
        residual.values.iter().zip(&d.load).map(|(r, l)| [r[0] + l[0], r[1] + l[1]]).collect();
    let forces = d.free_norm(&d.load) + d.free_norm(&prescribed);
    let magnitudes = d.free_norm(&residual.magnitudes);
    if forces > NOISE * f64::EPSILON * magnitudes {
        forces
    } else if magnitudes > 0.0 {
        magnitudes
    } else {
        1.0
    }
}

/// Forces this many unit roundoffs times their magnitudes are noise.
const NOISE: f64 = 4.0;

/// A condition number beyond this leaves Newton's method nothing to go by.
const HOPELESS: f64 = 1e14;

/// The verdict on an outcome.
///
/// # Errors
/// [`SolveError::NotConverged`] where the steps ran out, [`SolveError::IllConditioned`] where doubles cannot represent the
/// answer.
pub fn judge(outcome: &Outcome, settings: &Settings) -> Result<Status, SolveError> {
    let &Outcome { residual, forward_error, condition, .. } = outcome;
    if forward_error <= ACCEPTABLE {
        return Ok(if residual <= settings.tolerance {
            Status::Converged
        } else {
            Status::ConvergedToRounding
        });
    }
    let steps = outcome.residuals.len().saturating_sub(1);
    Err(if steps >= settings.max_iterations && condition < HOPELESS {
        let residuals = outcome.residuals.clone();
        SolveError::NotConverged { residual, residuals, tolerance: settings.tolerance }
    } else {
        SolveError::IllConditioned { condition, forward_error }
    })
}
