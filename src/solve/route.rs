//! Which route: by the multiplications that each is predicted to take, from the structure of the factor alone.
//!
//! - condensed: one factorisation, X = L^-1 B^T and G = X^T X, and for each Newton step a dense factorisation of as many rows
//!   as there are contact functionals,
//! - assembled: one factorisation for each Newton step.
//!
//! Both give the same numbers. Where A alone has no factor or a bad one although the method is coercive, the assembled route
//! is taken all the same: there contact holds the body.

use std::sync::Arc;

#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use super::accuracy::{self, Outcome};
use super::assembled::Assembled;
use super::compliance::Reach;
use super::condensed::Condensed;
use super::course::Phase;
use super::enclosure::{Unproved, Verifier};
use super::factor::{Factor, Indefinite, Structure};
use super::memory;
use super::system::System;
use super::times::{Stopwatch, Times};
use super::{MethodReport, Settings, SolveError};

/// The routes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize), serde(rename_all = "lowercase"))]
pub enum RouteName {
    /// The body factored once, Newton's method on the contact functionals.
    Condensed,
    /// Newton's method on the displacement, the tangent factored in each step.
    Assembled,
}

/// The Newton steps that a prediction counts on.
const STEPS: f64 = 12.0;

/// Newton steps that are enough for any case where no digits are missing.
const ENOUGH: usize = 30;

/// Multiplications that the assembled route makes beside those of the factorisation, for each stored entry of the factor:
/// assembly, substitutions, small blocks.
const PER_ENTRY: f64 = 12.0;

/// Multiplications of a dense factorisation that cost as much as one of the sparse one: only edges in contact take part,
/// about half of them and so an eighth of the work, and the rest runs at twice the speed or more. Of some thirty strips,
/// beams, squares and graded squares that both routes were timed on, it picks the faster one or one that took 1.1 times as
/// long.
const DENSE: f64 = 16.0;

/// The predicted operations of each route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Multiplications with an addition; those of dense factorisations count less.
    pub condensed: f64,
    /// The same.
    pub assembled: f64,
}

impl Prediction {
    /// For a system of this structure whose contact functionals have this reach.
    pub fn new(structure: &Structure, reach: &Reach) -> Self {
        let factor = structure.operations() + PER_ENTRY * structure.stored_entries() as f64;
        let q = reach.functionals() as f64;
        let dense = q * q * q / 6.0 / DENSE + 4.0 * q * q;
        Prediction {
            condensed: factor + reach.operations(structure) + STEPS * dense,
            assembled: STEPS * factor,
        }
    }

    /// The prediction for a system, with the reach of its contact functionals.
    pub fn of(system: &System) -> (Reach, Prediction) {
        let edges = 0..system.d.contact.len();
        let unknowns: Vec<Vec<usize>> = edges.map(|e| system.unknowns(e)).collect();
        let reach = Reach::new(&system.structure, &unknowns, system.nodes());
        let prediction = Prediction::new(&system.structure, &reach);
        (reach, prediction)
    }

    /// The route that takes less.
    pub fn route(&self) -> RouteName {
        if self.condensed <= self.assembled { RouteName::Condensed } else { RouteName::Assembled }
    }
}

/// Solves the system by the route that is predicted to take less, and by the assembled one where that proves too little: gives
/// what is nearest to the exact solution, as far as is proved.
///
/// # Errors
/// As [`solve_discrete`](super::solve_discrete).
pub fn solve(
    system: &System,
    settings: &Settings,
    times: &mut Times,
) -> Result<Solved, SolveError> {
    let mut watch = Stopwatch::start();
    let outset = Outset::of(system);
    let in_range = system.largest().is_normal() && outset.reference.is_normal();
    if !(in_range && contact_is_in_range(system)) {
        return Err(SolveError::OutOfRange);
    }
    let held = system.d.slides.is_none();
    let condensed = held && outset.prediction.route() == RouteName::Condensed;
    times.judge += watch.lap();
    let mut first = None;
    if condensed {
        match outset.go(RouteName::Condensed, system, settings, times) {
            Ok(done) if is_final(&done.0, settings) => return Ok(done),
            Ok(done) => first = Some(done),
            // Contact may hold what the supports hardly hold.
            Err(SolveError::Singular) => {}
            Err(error) => return Err(error),
        }
    }
    match (first, outset.go(RouteName::Assembled, system, settings, times)) {
        (Some(first), Ok(second)) if second.0.is_better_than(&first.0) => Ok(second),
        (Some(first), _) => Ok(first),
        (None, second) => second,
    }
}

/// Returns whether no other route would prove more.
fn is_final(done: &Outcome, settings: &Settings) -> bool {
    // With enough steps Newton's method ends: if it did not, digits were missing.
    let stopped = settings.max_iterations < ENOUGH && done.is_out_of_steps(settings);
    let by_nature = |why: &Unproved| !why.may_be_rounding() || *why == Unproved::HeldByContact;
    let unprovable = settings.proof.is_infinite() || done.enclosure.as_ref().is_err_and(by_nature);
    done.is_proved(settings) || stopped || (unprovable && done.residual <= settings.tolerance)
}

/// Returns whether what the matrix is made of on the contact edges neither over- nor underflows.
fn contact_is_in_range(system: &System) -> bool {
    system.d.contact.iter().all(|edge| {
        let stresses = edge.functionals.sigma_n().into_iter().flatten();
        let stress = stresses.flat_map(|v| v.iter()).fold(0.0, |m: f64, s| m.max(s.abs()));
        let (gamma, length) = (edge.gamma, edge.length);
        let springs = [length / gamma, gamma * length].iter().all(|x| x.is_normal());
        springs
            && (stress == 0.0 || [stress * stress, gamma * stress].iter().all(|x| x.is_normal()))
    })
}

/// Solves the system by a given route.
///
/// # Errors
/// As [`solve_discrete`](super::solve_discrete).
pub fn by(
    name: RouteName,
    system: &System,
    settings: &Settings,
    times: &mut Times,
) -> Result<Solved, SolveError> {
    Outset::of(system).go(name, system, settings, times)
}

/// The result of a route: the outcome, how it was found, and the factorisations.
pub type Solved = (Outcome, MethodReport, usize);

/// The data of a system before a route is taken.
struct Outset {
    reach: Reach,
    prediction: Prediction,
    /// The size that residuals are relative to.
    reference: f64,
}

impl Outset {
    fn of(system: &System) -> Self {
        let (reach, prediction) = Prediction::of(system);
        Outset { reach, prediction, reference: accuracy::reference(system.d) }
    }

    fn go(
        &self,
        name: RouteName,
        system: &System,
        settings: &Settings,
        times: &mut Times,
    ) -> Result<Solved, SolveError> {
        let mut watch = Stopwatch::start();
        let Outset { reach, prediction, reference } = self;
        let proving;
        let (outcome, predicted_operations, factorizations) = match name {
            RouteName::Condensed => {
                let q = reach.functionals();
                memory::ensure(8 * (reach.stored_entries(&system.structure) + 3 * q * q) as u64)?;
                system.enters(Phase::Factor);
                let factor = match Factor::with(&system.structure, &system.matrix)? {
                    Ok(factor) => Arc::new(factor),
                    Err(Indefinite) if system.d.kappa() < 1.0 => return Err(SolveError::Singular),
                    Err(Indefinite) => return Err(SolveError::NotPositiveDefinite),
                };
                times.factor += watch.lap();
                system.enters(Phase::Condense);
                let mut route = Condensed::new(system, &factor, reach, *reference);
                times.compliance += watch.lap();
                let mut verifier = Verifier::new(system, Some(Arc::clone(&factor)));
                let outcome =
                    accuracy::refine(system, &mut route, &mut verifier, *reference, settings)?;
                proving = verifier.time();
                (outcome, prediction.condensed, 1)
            }
            RouteName::Assembled => {
                let mut route = Assembled::new(system, *reference);
                let mut verifier = Verifier::new(system, None);
                let outcome =
                    accuracy::refine(system, &mut route, &mut verifier, *reference, settings)?;
                proving = verifier.time();
                (outcome, prediction.assembled, route.factorizations())
            }
        };
        times.newton += watch.lap().saturating_sub(proving);
        times.certify += proving;
        let Outcome { condition, forward_error, .. } = outcome;
        let report = MethodReport {
            route: name,
            predicted_operations,
            condition,
            forward_error,
            threads: 1,
            slides: 0,
        };
        Ok((outcome, report, factorizations))
    }
}
