//! Newton's method with an exact line search on J_h, for a body of which only the effect of a step on P is known.
//!
//! Let y be the values of P at the nodes of the pieces of Gamma_C, y = B u + d, and Psi(y) = sum over the pieces of
//! (|E| / gamma) 1/2 int \[P\]+^2. Then
//!
//! J_h(u) = 1/2 u^T A u - l^T u + Psi(B u + d).
//!
//! A step d of the body changes y by dy = B d, and J_h along it by
//!
//! J_h(u + t d) - J_h(u) = t DJ d + t^2/2 d^T A d + D(y, y + t dy),
//!
//! where DJ d <= 0 and D is the Bregman distance of Psi: two terms that are never negative against one that is never
//! positive. Nothing cancels, so the search works down to the rounding level. Its derivative in t does not decrease; the
//! search finds where it vanishes, to a hundredth of its value at 0, and Armijo's rule, with a hundredth for its sigma, is asked of
//! what it finds.
//!
//! **The start.** A body that bends, started as if without contact, lets go of about one edge a step. So the springs are soft
//! at first: gamma / s in place of gamma in Psi, with s so small that contact is not much stiffer than the body (what friction bears at
//! most stays the same). When the residual at s is
//! small beside the one that stiffer springs bring, the springs get stiffer by a factor: the contact zone of stiff springs is
//! narrow, and a minimiser is found from near only. At s = 1 this is Newton's method on J_h, from a good start. Going to the
//! body without contact counts as a step where it takes one. A start that is given ([`Course`](super::Course)) needs no soft
//! springs.
//!
//! **The end** is the rounding level of the residual, or of the decrease along a step, or what [`Until`] says.

use super::SolveError;
use super::body::{Body, ContactEnergy, Derivatives, Step, derivatives};
use crate::kernel::DoubleDouble;
use crate::linear::dense::norm;

/// The accuracy, as a share, of auxiliary quantities. The line search ends where the derivative along the step is this small
/// beside the one
/// at its start, and asks for a decrease of this share of what that derivative promises (Armijo's sigma: any below 1/2 will do); the
/// [enclosure](crate::proof::enclosure) corrects a bound no further when what is left to correct is this small a part of it.
pub(crate) const SLIGHT: f64 = 1e-2;

/// The initial stiffness of the contact springs beside that of the body. From 8 to 100 the value matters little; with the final
/// stiffness from the start, seven of 504 random bodies are not solved in 200 steps.
const SOFT: f64 = 20.0;

/// The factor from one stiffness of the springs to the next. With 4 bodies take 6 % more steps than with 5; from 6 on a
/// body that slides off an obstacle takes more than 70, and with 16 some are not solved in 200. A factor that adapts itself between
/// 2 and 8 takes 3 % fewer steps, and 48 where this one takes 42.
const STIFFENING: f64 = 5.0;

/// The most steps with one stiffness: after so many the factor that led there becomes its root, and grows again where fewer are
/// enough. With friction the springs of what sticks let go in strips that are the narrower the stiffer they are, and the line search
/// ends at the next of these. Without this, two of 500 random bodies with Tresca's friction are not solved in 200 steps; with it none
/// takes more than 155.
const MOST_OF_A_STAGE: usize = 4;

/// The factor that is not made smaller.
const LEAST_STIFFENING: f64 = 1.01;

/// The residual, as a share of that with the next stiffness, at which the springs get stiffer. With no such condition one of
/// 2,000 bodies is not solved in 200 steps, and the body that slides off takes 77.
const DONE: f64 = 0.1;

/// The share to which one step of Newton's method takes the residual near a solution, at least.
const NEAR: f64 = 1e-3;

/// When to stop, short of the rounding level.
#[derive(Clone, Copy, Debug)]
pub struct Until {
    /// There are more residuals than this.
    pub(crate) steps: usize,
    /// The relative residual is no larger.
    pub(crate) residual: f64,
    /// The relative residual is no larger, and the last step took it down as near a solution: where springs are stiff a small residual
    /// alone says little of the error.
    pub(crate) near: f64,
}

/// Newton's method from where `body` is, with soft springs if this is the `first` time. Appends the residual at each
/// iterate to `residuals`, and stops as `until` says or at the rounding level. Returns the decrement of the last step if the
/// line search cut the step short or found no decrease: the step has not been made, and the iterate is as far off as before.
///
/// # Errors
/// As [`Body::step`].
pub(crate) fn minimise(
    edges: &impl ContactEnergy,
    body: &mut impl Body,
    first: bool,
    residuals: &mut Vec<f64>,
    until: Until,
) -> Result<f64, SolveError> {
    let mut stiffness = 1.0;
    if first {
        residuals.push(body.residual(&derivatives(edges, 1.0, &body.y())).norm);
        match body.start(edges)? {
            Some(contact) => stiffness = f64::min(SOFT / contact, 1.0),
            None => residuals.push(body.residual(&derivatives(edges, 1.0, &body.y())).norm),
        }
    }
    let mut at = derivatives(edges, 1.0, &body.y());
    let mut residual = body.residual(&at);
    // A later call makes a step wherever there is a residual, for the size of the step tells how good the first end was.
    let mut may_end = first;
    let mut is_near = false;
    let mut left = 0.0;
    // The stiffness whose minimiser was found last, the factor from it to this one, and the steps that were taken with this one.
    let (mut from, mut factor, mut taken) = (0.0, STIFFENING, 0);
    while residuals.len() <= until.steps {
        let enough = match stiffness < 1.0 {
            true => 0.0,
            false if is_near => until.residual.max(until.near),
            false => until.residual,
        };
        if (may_end && residual.norm <= residual.noise.max(enough)) || residual.norm == 0.0 {
            break;
        }
        let soft = (stiffness < 1.0).then(|| derivatives(edges, stiffness, &body.y()));
        let soft = soft.as_ref().unwrap_or(&at);
        let step = body.step(soft)?;
        let Some(t) = line_search(edges, &body.y(), soft, &step) else { return Ok(-step.slope) };
        body.advance(t, &step);
        let before = residual.norm;
        at = derivatives(edges, 1.0, &body.y());
        residual = body.residual(&at);
        residuals.push(residual.norm);
        left = if t < 1.0 { -step.slope } else { 0.0 };
        may_end = true;
        is_near = t == 1.0 && residual.norm <= NEAR * before;
        let stiffer = f64::min(factor * stiffness, 1.0);
        let residual_at =
            |stiffness: f64| body.residual(&derivatives(edges, stiffness, &body.y())).norm;
        taken += 1;
        // The last stage ends in as many steps as rounding takes.
        let ends = stiffness >= 1.0 && residual.norm <= DONE * before;
        if stiffness < 1.0 && residual_at(stiffness) <= DONE * residual_at(stiffer) {
            if taken < MOST_OF_A_STAGE {
                factor = f64::min(factor * factor, STIFFENING);
            }
            (from, stiffness, taken) = (stiffness, stiffer, 0);
        } else if taken >= MOST_OF_A_STAGE && from > 0.0 && !ends && factor > LEAST_STIFFENING {
            factor = factor.sqrt();
            (stiffness, taken) = (from * factor, 0);
        }
    }
    Ok(left)
}

/// The place along the step where J_h with the Psi that has the derivatives `at` is least; `None` if its decrease is lost in
/// rounding.
fn line_search(
    edges: &impl ContactEnergy,
    y: &[DoubleDouble],
    at: &Derivatives,
    step: &Step,
) -> Option<f64> {
    let stiffness = at.stiffness;
    let put = |e: usize, t: f64, point: &mut Vec<DoubleDouble>| {
        let values = edges.values(e);
        let along = y[values.clone()].iter().zip(&step.dy[values]);
        point.clear();
        point.extend(along.map(|(&p, d)| p + DoubleDouble::from(t * d)));
    };
    // The first and the second derivative of J_h along the step.
    let derivatives = |t: f64| {
        let mut point = Vec::new();
        let mut first = step.slope + t * step.curvature;
        let mut second = step.curvature;
        for e in 0..edges.count() {
            let values = edges.values(e);
            let (d, before) = (&step.dy[values.clone()], &at.gradient[values]);
            put(e, t, &mut point);
            if edges.is_open(e, &point) && before.iter().all(|g| *g == 0.0) {
                continue;
            }
            let (g, h) = edges.derivatives(e, stiffness, &point);
            for a in 0..d.len() {
                first += (g[a] - before[a]) * d[a];
                for b in 0..d.len() {
                    second += h[(a, b)] * d[a] * d[b];
                }
            }
        }
        (first, second)
    };
    let falls = |t: f64| {
        let mut point = Vec::new();
        let mut distance = 0.0;
        for e in 0..edges.count() {
            put(e, t, &mut point);
            distance += edges.bregman(e, stiffness, &y[edges.values(e)], &point);
        }
        t * t / 2.0 * step.curvature + distance <= (SLIGHT - 1.0) * t * step.slope
    };
    let flat = SLIGHT * step.slope.abs();
    let (mut low, mut high, mut t) = (0.0, f64::INFINITY, 1.0);
    for _ in 0..60 {
        let (first, second) = derivatives(t);
        if first.abs() <= flat {
            break;
        }
        if first < 0.0 {
            low = t;
        } else {
            high = t;
        }
        let newton = t - first / second;
        t = if newton > low && newton < high {
            newton
        } else if high.is_finite() {
            (low + high) / 2.0
        } else {
            2.0 * t
        };
    }
    while t > f64::EPSILON {
        if falls(t) {
            return Some(t);
        }
        t /= 2.0;
    }
    None
}

/// An estimate, to within a factor, of the largest eigenvalue of the matrix that `times` multiplies by, positive semidefinite in some
/// scalar product, by the power method from `x` on.
pub(crate) fn largest_eigenvalue(mut x: Vec<f64>, times: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    let mut largest = 0.0;
    for _ in 0..POWER_STEPS {
        let size = norm(&x);
        if !(size > 0.0) {
            return largest;
        }
        x.iter_mut().for_each(|x| *x /= size);
        x = times(&x);
        largest = norm(&x);
    }
    largest
}

/// Steps of the power method. It starts from what the loads do, which is mostly what is soft.
const POWER_STEPS: usize = 2;

#[cfg(test)]
mod tests;
