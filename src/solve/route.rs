//! The choice of the route, by the predicted number of multiplications, from the structure of the factor alone.
//!
//! - condensed: one factorisation, X = L^-1 B^T and G = X^T X, and for each Newton step a dense factorisation of as many rows
//!   as there are contact functionals,
//! - assembled: one factorisation for each Newton step.
//!
//! Both give the same numbers. Where supports hardly hold the body, so that A has no factor or a bad one although the method is
//! coercive, the assembled route is taken all the same: contact may hold it. Coulomb's friction has no condensed route.

use super::accuracy::{self, Outcome, Route};
use super::assembled::Assembled;
use super::condensed::{Condensed, Shift};
use super::coulomb::Coulomb;
use super::course::Phase;
use super::times::{Stopwatch, Times};
use super::{Settings, SolveError};
use crate::linear::compliance::Reach;
use crate::linear::system::System;
use crate::memory;
use crate::proof::enclosure::Verifier;
use crate::results::report::RouteName;

/// The number of Newton steps that a prediction assumes.
const STEPS: f64 = 12.0;

/// Multiplications of a dense factorisation that cost as much as one of the sparse one: only edges in contact take part,
/// about half of them and so an eighth of the work, and the rest runs at twice the speed or more. Of some thirty strips, beams,
/// squares and graded squares on which both routes were timed, the prediction picks the faster route or one that took 1.1 times
/// as long.
const DENSE: f64 = 16.0;

/// Solves the system by a given route.
///
/// # Errors
/// As [`solve_discrete`](super::solve_discrete).
pub fn by(
    name: RouteName,
    system: &System,
    settings: &Settings,
    times: &mut Times,
) -> Result<Outcome, SolveError> {
    Strategy::new(system)?.solve(name, settings, times)
}

/// The data that both routes share, and the order in which to take them.
pub(crate) struct Strategy<'a, 'd, 'p> {
    system: &'a System<'d, 'p>,
    reach: Reach,
    /// The multiplications with an addition that each route is predicted to take, condensed and assembled; those of dense
    /// factorisations count less.
    predicted: [f64; 2],
    /// The size that residuals are relative to.
    reference: f64,
}

impl<'a, 'd, 'p> Strategy<'a, 'd, 'p> {
    /// The strategy for a system.
    ///
    /// # Errors
    /// [`SolveError::OutOfRange`].
    pub(crate) fn new(system: &'a System<'d, 'p>) -> Result<Self, SolveError> {
        let structure = &system.structure;
        let reach = Reach::new(structure, &system.pieces());
        let factor = structure.operations();
        let q = reach.functionals() as f64;
        let dense = q * q * q / 6.0 / DENSE + 4.0 * q * q;
        let condensed = factor + reach.operations(structure) + STEPS * dense;
        let predicted = [condensed, STEPS * factor];
        let reference = accuracy::reference(system.d);
        let in_range = system.largest().is_normal() && reference.is_normal();
        if !(in_range && contact_is_in_range(system)) {
            return Err(SolveError::OutOfRange);
        }
        Ok(Strategy { system, reach, predicted, reference })
    }

    /// The routes to take, one after the other as long as too little is proved.
    pub(crate) fn routes(&self) -> &'static [RouteName] {
        let [condensed, assembled] = self.predicted;
        let d = self.system.d;
        if !d.has_coulomb() && condensed <= assembled {
            &[RouteName::Condensed, RouteName::Assembled]
        } else {
            &[RouteName::Assembled]
        }
    }

    /// The operations that are predicted for a route.
    pub(crate) fn predicted(&self, name: RouteName) -> f64 {
        self.predicted[name as usize]
    }

    /// Newton's method by a route, refined and verified.
    ///
    /// # Errors
    /// As [`solve_discrete`](super::solve_discrete).
    pub(crate) fn solve(
        &self,
        name: RouteName,
        settings: &Settings,
        times: &mut Times,
    ) -> Result<Outcome, SolveError> {
        let mut watch = Stopwatch::start();
        let mut route: Box<dyn Route + '_> = match name {
            RouteName::Condensed => Box::new(self.condensed(times)?),
            RouteName::Assembled if self.system.d.has_coulomb() => {
                Box::new(Coulomb::new(self.system, self.reference))
            }
            RouteName::Assembled => Box::new(Assembled::new(self.system, self.reference)),
        };
        watch.lap();
        let mut verifier = Verifier::new(self.system, route.factored()).for_proof(settings.proof);
        let outcome =
            accuracy::refine(self.system, &mut *route, &mut verifier, self.reference, settings)?;
        times.newton += watch.lap().saturating_sub(verifier.time);
        times.certify += verifier.time;
        Ok(outcome)
    }

    fn condensed(&self, times: &mut Times) -> Result<Condensed<'_, 'd, 'p>, SolveError> {
        let (system, q) = (self.system, self.reach.functionals());
        let entries = self.reach.stored_entries(&system.structure) + 3 * q * q;
        memory::check(8 * entries as u64)?;
        let mut watch = Stopwatch::start();
        system.course.enters(Phase::Factor);
        let shift = Shift::of(system.d);
        let factored = match shift.factor(system) {
            Err(SolveError::NotPositiveDefinite) if system.d.kappa() < 1.0 => {
                return Err(SolveError::Singular);
            }
            factored => factored?,
        };
        times.factor += watch.lap();
        system.course.enters(Phase::Condense);
        let route = Condensed::new(system, (shift, factored), &self.reach, self.reference)?;
        times.compliance += watch.lap();
        Ok(route)
    }
}

/// Returns whether the matrix entries of the pieces of Gamma_C neither over- nor underflow.
fn contact_is_in_range(system: &System) -> bool {
    system.d.contact.iter().all(|piece| {
        let stresses = piece.sigma_n.iter().flatten();
        let stress = stresses.flat_map(|v| v.iter()).fold(0.0, |m: f64, s| m.max(s.abs()));
        let gamma = piece.gamma;
        let springs = [piece.weight(), gamma * piece.length].iter().all(|x| x.is_normal());
        springs
            && (stress == 0.0 || [stress * stress, gamma * stress].iter().all(|x| x.is_normal()))
    })
}
