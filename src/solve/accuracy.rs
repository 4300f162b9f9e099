//! From a first answer to one that is known to be right: passes of a route, each from the true residual of the one before,
//! until the residual has reached the tolerance and a pass has nothing left to correct; and the verdict.
//!
//! The correction of a pass is the error of what it corrects, but for the error of the correction, which is smaller by the
//! same factor again. Its energy norm |du|_A beside that of u, and that of what the displacement loses when it is rounded to
//! doubles at the end, is the **forward error** that is reported; a small residual alone says nothing where the condition
//! number is large. Residuals are evaluated in doubles as long as these can tell: where their rounding, carried through the body
//! at its softest, may move it by more than the bound for corrections, a residual that vanishes in doubles is no evidence, for
//! Newton's method drives the rounding to zero with it. And where contact is stiff, next to no energy is a force: a solve goes on
//! until loads, contact and reactions balance. docs/theory.md, 5.7, has the rules.

use super::body::block;
use super::iterate::{Evaluation, Iterate};
use super::newton::Until;
use super::system::System;
use super::{Settings, SolveError, Status};
use crate::fem::discretization::Discretization;
use crate::fem::twofold::Twofold;
use crate::kernel::edge_integral::ExactEdge;

/// A way to better an iterate.
pub trait Route<E, const N: usize, const M: usize> {
    /// Whether residuals are to be evaluated in twofold numbers from the start.
    fn precisely(&self) -> bool {
        false
    }

    /// Moves `iterate` to where the residual of (8) vanishes, as far as one pass can, and `at`, what the linear part of (8) is
    /// there, with it.
    ///
    /// # Errors
    /// As [`super::newton::minimise`].
    fn pass(
        &mut self,
        iterate: &mut Iterate,
        at: &mut Evaluation,
        residuals: &mut Vec<f64>,
        until: Until,
    ) -> Result<Pass, SolveError>;
}

/// The size of what a pass has changed.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// |du|_A^2
    pub energy: f64,
    /// The decrement of the last step if the line search cut it short, else 0: the size of what is still to be changed.
    pub left: f64,
    /// The largest |d|^2 / |d|_A^2 of what was solved for
    pub softness: f64,
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The displacement.
    pub u: Vec<[f64; 2]>,
    /// The same before it was rounded to doubles, where its forces in doubles are noise.
    pub fine: Option<Vec<[Twofold; 2]>>,
    /// A(u, v) - L(v) for every basis function v, of the displacement before it was rounded.
    pub forces: Vec<[f64; 2]>,
    /// P(u) at the nodes of the contact edges.
    pub p: Vec<Twofold>,
    /// The relative residual of (8) before each Newton step and after the last.
    pub residuals: Vec<f64>,
    /// The relative residual of the displacement, from the definitions.
    pub residual: f64,
    /// What loads, contact and reactions may be out of balance, beside loads and contact.
    pub unbalanced: f64,
    /// |du|_A / |u|_a of the last correction.
    pub correction: f64,
    /// The same, and that of what rounding the displacement to doubles takes away.
    pub forward_error: f64,
    /// The condition number of the matrix, from below: Rayleigh quotients of what was solved for.
    pub condition: f64,
}

impl Outcome {
    /// Whether the residual is within the tolerance, the forces are balanced and the last correction is next to nothing.
    pub fn is_right(&self, settings: &Settings) -> bool {
        self.residual <= settings.tolerance && self.correction <= RIGHT && self.unbalanced <= RIGHT
    }

    /// Whether Newton's method took all the steps that it may.
    pub fn is_out_of_steps(&self, settings: &Settings) -> bool {
        self.residuals.len() > settings.max_iterations
    }
}

/// A correction, and forces out of balance, up to this need no better arithmetic.
const RIGHT: f64 = 1e-9;

/// A correction this small, relative, leaves nothing to correct.
const SMALL: f64 = 1e-10;

/// Rounding of the residual calls for twofold numbers where its bound is more than this beside what residuals are relative to,
/// or that of its sums beside the forces on the body,
const BLURRED: f64 = 1e-9;

/// or may move the body by more than this beside its displacement, if all of it adds up.
const MOVED: f64 = 1e-8;

/// What is left of the forces on the body may be this share of them.
const BALANCED: f64 = 1e-10;

/// A correction ends where the residual is this share of the tolerance.
const GOOD_ENOUGH: f64 = 1e-2;

/// No more passes than these: each takes the error down by a factor, or there is no point.
const MOST_PASSES: usize = 12;

/// The relative error in the energy norm up to which a displacement is a result at all.
pub const ACCEPTABLE: f64 = 1e-6;

/// Passes of `route` from the lift of the prescribed data on.
///
/// # Errors
/// As [`super::newton::minimise`].
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
    let mut at = iterate.evaluate(system, route.precisely());
    // The first pass goes as far as it can. It comes from nowhere: what it moves is no error.
    let mut until = Until { steps: settings.max_iterations, residual: 0.0 };
    let Pass { left, mut softness, .. } =
        route.pass(&mut iterate, &mut at, &mut residuals, until)?;
    let good_enough = GOOD_ENOUGH * settings.tolerance;
    let mut correction = f64::INFINITY;
    let mut cut = left > 0.0;
    let mut residual = Residual::new(system, &at, reference);
    for _ in 1..MOST_PASSES {
        if residuals.len() > settings.max_iterations && !(residual.norm <= settings.tolerance) {
            break;
        }
        let size = size_of(system, &at, &iterate);
        if !at.precisely && is_blurred(system, &at, softness, size, reference, residual.forces) {
            at = iterate.evaluate(system, true);
        }
        // A correction need not better what is good enough.
        until.residual = if cut { 0.0 } else { good_enough };
        let change = route.pass(&mut iterate, &mut at, &mut residuals, until)?;
        softness = softness.max(change.softness);
        cut = change.left > 0.0;
        let before = correction;
        let moved = change.energy.max(change.left).sqrt();
        correction = if moved == 0.0 { 0.0 } else { moved / size };
        residual = Residual::new(system, &at, reference);
        if residual.norm <= settings.tolerance
            && residual.unbalanced <= BALANCED
            && correction <= SMALL
        {
            break;
        }
        if cut || correction < before / 2.0 {
            continue;
        }
        if at.precisely {
            break;
        }
        // Doubles are not enough.
        at = iterate.evaluate(system, true);
        residual = Residual::new(system, &at, reference);
        correction = f64::INFINITY;
    }
    let u = iterate.rounded();
    let rounding = system.energy_of_unrelated(&iterate.remainder()).sqrt();
    let rounding = if rounding > 0.0 { rounding / size_of(system, &at, &iterate) } else { 0.0 };
    let forward_error = correction + rounding;
    let condition = (system.largest() * softness).max(1.0);
    let Residual { norm: residual, unbalanced, .. } = residual;
    let Evaluation { forces, p, precisely, .. } = at;
    let fine = precisely.then(|| iterate.into_twofold());
    Ok(Outcome {
        u,
        fine,
        forces,
        p,
        residuals,
        residual,
        unbalanced,
        correction,
        forward_error,
        condition,
    })
}

/// |u|_a, which errors are relative to. A body without loads that is moved as a whole has no strain but that of rounding: there
/// it is what it would be if the components of u knew nothing of each other.
fn size_of<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    at: &Evaluation,
    iterate: &Iterate,
) -> f64
where
    E: ExactEdge<f64, N, M>,
{
    let size = at.energy.sqrt();
    if system.d.load.as_flattened().iter().any(|&l| l != 0.0) {
        return size;
    }
    let most = system.energy_of_unrelated(&iterate.rounded()).sqrt();
    if size > STRAIN_OF_ROUNDING * most { size } else { most }
}

/// A strain this small beside the displacement is that of rounding.
const STRAIN_OF_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The residual of (8) at an iterate.
struct Residual {
    /// Its norm, relative to the reference.
    norm: f64,
    /// The sum of its magnitudes beside the forces on the body: what loads, contact and reactions may be out of balance.
    unbalanced: f64,
    /// The forces on the body: loads and contact, or, where there are none, reactions, which may balance each other node by node.
    forces: f64,
}

impl Residual {
    fn new<E, const N: usize, const M: usize>(
        system: &System<E, N, M>,
        at: &Evaluation,
        reference: f64,
    ) -> Self
    where
        E: ExactEdge<f64, N, M>,
    {
        let d = system.d;
        let mut r = at.linear.clone();
        let one = |v: &[f64]| v.iter().map(|v| v.abs()).sum::<f64>();
        let mut forces = one(d.load.as_flattened());
        for (e, edge) in d.contact.iter().enumerate() {
            let integrals = d.rule.integrals::<E, N, M>(block::<Twofold, M>(&at.p, e));
            let weight = edge.length / edge.gamma;
            forces += weight * one(&integrals.gradient);
            system.functionals(e, |row, a, entry| {
                r[row] += entry * weight * integrals.gradient[a];
            });
        }
        if forces == 0.0 {
            forces = one(at.forces.as_flattened());
        }
        let unbalanced = if forces > 0.0 { one(&r) / forces } else { 0.0 };
        Residual { norm: norm(&r) / reference, unbalanced, forces }
    }
}

/// Whether rounding alone may give the residual `at` a displacement of this `size` a norm that tells too little.
fn is_blurred<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    at: &Evaluation,
    softness: f64,
    size: f64,
    reference: f64,
    forces: f64,
) -> bool
where
    E: ExactEdge<f64, N, M>,
{
    let d = system.d;
    let mut contact = vec![0.0; at.linear.len()];
    for (e, edge) in d.contact.iter().enumerate() {
        let integrals = d.rule.integrals::<E, N, M>(block::<Twofold, M>(&at.p, e));
        let magnitudes: [f64; M] = block(&at.p_magnitudes, e);
        let weight = edge.length / edge.gamma;
        system.functionals(e, |row, a, entry| {
            let h = integrals.hessian[a].iter().zip(magnitudes);
            contact[row] += (entry * weight).abs() * h.map(|(h, p)| h.abs() * p).sum::<f64>();
        });
    }
    let noise = at.noise + f64::EPSILON * norm(&contact);
    let sum = at.noise_of_sums + f64::EPSILON * contact.iter().sum::<f64>();
    noise * softness.sqrt() > MOVED * size || noise > BLURRED * reference || sum > BLURRED * forces
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
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
    Err(if outcome.is_out_of_steps(settings) && condition < HOPELESS {
        let residuals = outcome.residuals.clone();
        SolveError::NotConverged { residual, residuals, tolerance: settings.tolerance }
    } else {
        SolveError::IllConditioned { condition, forward_error }
    })
}
