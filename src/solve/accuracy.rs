//! From a first answer to one that is proved: passes of a route, each from the true residual of the one before, until a pass has
//! nothing left to correct; then the enclosure of the exact solution says how far that is from it. Where it is not near enough,
//! residuals are evaluated in double-doubles, and the passes go on; at last the residual of the proof corrects, in which the forces of
//! stiff springs cancel beyond the digits of a double. docs/theory.md, 5.6.
//!
//! The correction of a pass estimates the error before it. The first pass starts from the lift, so what the second corrects, relative to
//! the displacement, is the share to which a pass takes an error down. So passes end when that share of the last correction is nothing;
//! the verdict is the proof's.

use super::iterate::{Evaluation, Iterate, NOISE};
use super::newton::Until;
use super::{Settings, SolveError};
use crate::contact::discretization::Discretization;
use crate::kernel::DoubleDouble;
use crate::linear::dense::norm;
use crate::linear::system::{Factored, System};
use crate::model::rigid::NEGLIGIBLE;
use crate::proof::enclosure::{Enclosure, Unproved, Verifier};
use crate::proof::intervals::Arithmetic;
use crate::results::Status;

/// A way to improve an iterate.
pub trait Route {
    /// A tangent with its factor that is kept from one pass to the next, if there is one.
    fn factored(&self) -> Option<Factored>;

    /// The number of sparse factorisations so far.
    fn factorizations(&self) -> usize;

    /// Moves `iterate` to where the residual of (8) vanishes, as far as one pass can, and `at`, what the linear part of (8) is
    /// there, with it.
    ///
    /// # Errors
    /// As `newton::minimise`.
    fn pass(
        &mut self,
        iterate: &mut Iterate,
        at: &mut Evaluation,
        residuals: &mut Vec<f64>,
        until: Until,
    ) -> Result<Pass, SolveError>;

    /// Returns Newton's step from `at` for a residual that is known to more digits than forces in doubles have; `None` if the route has
    /// no tangent of all of (8).
    ///
    /// # Errors
    /// As `newton::minimise`.
    fn step_for(&mut self, _: &Evaluation, _: &[f64]) -> Result<Option<Vec<f64>>, SolveError> {
        Ok(None)
    }
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

/// The outcome of refinement.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The displacement.
    pub u: Vec<[f64; 2]>,
    /// A(u, v) - L(v) for every basis function v, of the displacement before it was rounded to doubles.
    pub forces: Vec<[f64; 2]>,
    /// P(u) at the nodes of the contact edges.
    pub p: Vec<DoubleDouble>,
    /// The relative residual of (8) before each Newton step and after the last.
    pub residuals: Vec<f64>,
    /// The relative residual of the displacement, from the definitions.
    pub residual: f64,
    /// Where the exact solution is, or why nothing is proved of it.
    pub enclosure: Result<Enclosure, Unproved>,
    /// |du|_A / |u|_a of the last correction, times the share to which a pass takes an error down where that is known, and that of what
    /// rounding the displacement to doubles takes away: an estimate.
    pub forward_error: f64,
    /// The condition number of the matrix, from below: Rayleigh quotients of what was solved for.
    pub condition: f64,
    /// The number of sparse factorisations.
    pub factorizations: usize,
}

impl Outcome {
    /// Returns whether the exact solution is proved to be as near as asked for.
    pub(crate) fn is_proved(&self, settings: &Settings) -> bool {
        self.enclosure.as_ref().is_ok_and(|e| e.is_within(settings.proof))
    }

    /// The relative radius of the enclosure; infinite without one.
    pub fn radius(&self) -> f64 {
        self.enclosure.as_ref().map_or(f64::INFINITY, Enclosure::in_parts)
    }

    /// Returns whether it is nearer to the exact solution as far as is proved, or else has the smaller residual.
    pub(crate) fn is_better_than(&self, other: &Outcome) -> bool {
        let [a, b] = [self, other].map(|o| (o.radius(), o.residual));
        a.0 < b.0 || (a.0 == b.0 && a.1 < b.1)
    }

    /// Returns whether Newton's method took all the steps that it may.
    fn is_out_of_steps(&self, settings: &Settings) -> bool {
        self.residuals.len() > settings.max_iterations
    }

    /// Returns whether no other route would prove more.
    pub(crate) fn is_final(&self, settings: &Settings) -> bool {
        let by_nature = |why: &Unproved| !why.may_be_rounding() || *why == Unproved::HeldByContact;
        let unprovable =
            settings.proof.is_infinite() || self.enclosure.as_ref().is_err_and(by_nature);
        self.is_proved(settings) || (unprovable && self.residual <= settings.tolerance)
    }

    /// The status of the solve.
    ///
    /// # Errors
    /// Where nothing is proved and the residual is above the tolerance: [`SolveError::Singular`] where A has no factor,
    /// [`SolveError::NotConverged`] where the steps ran out though doubles can tell a step, else [`SolveError::IllConditioned`].
    pub fn status(&self, settings: &Settings) -> Result<Status, SolveError> {
        let &Outcome { residual, forward_error, condition, .. } = self;
        if residual <= settings.tolerance {
            Ok(Status::Converged)
        } else if self.is_proved(settings) {
            Ok(Status::ConvergedToRounding)
        } else if self.enclosure == Err(Unproved::NoFactor) {
            Err(SolveError::Singular)
        } else if self.is_out_of_steps(settings) && condition * f64::EPSILON < 1.0 {
            let residuals = self.residuals.clone();
            Err(SolveError::NotConverged { residual, residuals, tolerance: settings.tolerance })
        } else {
            Err(SolveError::IllConditioned { condition, forward_error })
        }
    }
}

/// The largest number of passes. This bounds the time and decides nothing: each pass takes the error down by a factor, or the
/// passes end.
const MOST_PASSES: usize = 12;

/// Passes of `route` from the lift of the prescribed data on, until the enclosure of the exact solution is as small as asked
/// for, or no smaller by better arithmetic.
///
/// # Errors
/// As `newton::minimise`.
pub fn refine(
    system: &System,
    route: &mut dyn Route,
    verifier: &mut Verifier,
    reference: f64,
    settings: &Settings,
) -> Result<Outcome, SolveError> {
    let mut refinement = IterativeRefinement::new(system, reference, settings);
    refinement.pass(route)?;
    // The first pass starts from the lift, so its step says nothing about the error.
    refinement.correction = f64::INFINITY;
    for pass in 1..MOST_PASSES {
        if refinement.is_out_of_steps() {
            break;
        }
        let before = refinement.correction;
        refinement.pass(route)?;
        if pass == 1 && !settings.proof.is_infinite() {
            refinement.contraction = refinement.correction.min(1.0);
        }
        let is_done = refinement.is_done();
        if !is_done && refinement.correction < before / 2.0 && !refinement.is_exhausted() {
            continue;
        }
        if is_done && settings.proof.is_infinite() {
            break;
        }
        if is_done || refinement.at.precisely {
            verifier.use_factor(route.factored());
            let is_near = refinement.verify(verifier);
            if refinement.at.precisely && !is_near {
                refinement.correct(route, verifier);
            }
            if refinement.at.precisely || is_near {
                break;
            }
        }
        // Doubles are not enough.
        refinement.at = refinement.iterate.evaluate(system, true);
        refinement.correction = f64::INFINITY;
    }
    Ok(refinement.outcome(verifier, route.factorizations()))
}

/// An iterate between two passes.
struct IterativeRefinement<'a, 'd, 'p> {
    system: &'a System<'d, 'p>,
    settings: &'a Settings,
    reference: f64,
    iterate: Iterate,
    at: Evaluation,
    residual: TrueResidual,
    /// The relative residual before each Newton step and after the last.
    residuals: Vec<f64>,
    /// The size of the last correction beside the displacement.
    correction: f64,
    /// The share to which a pass takes the error down; 1 as long as that is not known, and where no proof tells whether it is right.
    contraction: f64,
    softness: f64,
    enclosure: Result<Enclosure, Unproved>,
}

impl<'a, 'd, 'p> IterativeRefinement<'a, 'd, 'p> {
    fn new(system: &'a System<'d, 'p>, reference: f64, settings: &'a Settings) -> Self {
        let iterate = Iterate::lift(system.d);
        let at = iterate.evaluate(system, false);
        IterativeRefinement {
            system,
            settings,
            reference,
            residual: TrueResidual::UNKNOWN,
            iterate,
            at,
            residuals: Vec::new(),
            correction: f64::INFINITY,
            contraction: 1.0,
            softness: 0.0,
            enclosure: Err(Unproved::NotReached),
        }
    }

    fn is_out_of_steps(&self) -> bool {
        self.residuals.len() > self.settings.max_iterations
            && !(self.residual.norm <= self.settings.tolerance)
    }

    /// Returns whether nothing is left to correct in the numbers at hand: of the residual, of the imbalance of the forces on the
    /// body, in parts of them, and of the displacement, relative.
    fn is_done(&self) -> bool {
        self.residual.norm <= self.settings.tolerance
            && self.residual.unbalanced <= NEGLIGIBLE
            && self.is_corrected()
    }

    /// Returns whether the error after the last pass is nothing beside the displacement, as far as its correction tells.
    fn is_corrected(&self) -> bool {
        self.contraction * self.correction <= NEGLIGIBLE
    }

    /// Returns whether another pass in doubles would find nothing to correct: rounding may be all that is left of the residual.
    fn is_exhausted(&self) -> bool {
        let is_noise = self.residual.norm <= self.at.noise / self.reference;
        !self.at.precisely && self.is_corrected() && is_noise
    }

    fn pass(&mut self, route: &mut dyn Route) -> Result<(), SolveError> {
        let size = self.system.size(self.at.energy.sqrt(), &self.iterate.rounded());
        let Settings { max_iterations: steps, tolerance: near, .. } = *self.settings;
        // The first pass goes to near a solution; corrections stop at what is good enough.
        let residual = if self.residuals.is_empty() { 0.0 } else { near };
        let until = Until { steps, residual, near };
        let pass = route.pass(&mut self.iterate, &mut self.at, &mut self.residuals, until)?;
        // The earlier proof is of another displacement.
        self.enclosure = Err(Unproved::NotReached);
        self.softness = self.softness.max(pass.softness);
        let moved = pass.energy.max(pass.left).sqrt();
        self.correction = if moved == 0.0 { 0.0 } else { moved / size };
        self.residual = TrueResidual::new(self.system, &self.at, self.reference);
        Ok(())
    }

    /// Encloses the exact solution, in balls where doubles prove too little, and returns whether a better iterate would tell no
    /// more.
    fn verify(&mut self, verifier: &mut Verifier) -> bool {
        let (u, near) = (self.iterate.rounded(), &self.iterate.u);
        self.enclosure = Err(Unproved::NotReached);
        for arithmetic in [Arithmetic::Doubles, Arithmetic::Balls] {
            let found = verifier.enclose(&u, Some(near), arithmetic);
            let is_near = match &found {
                Ok(e) => e.is_within(self.settings.proof),
                Err(why) => !why.may_be_rounding(),
            };
            if found.is_ok() || self.enclosure.is_err() {
                self.enclosure = found;
            }
            if is_near && verifier.unbalanced <= 10.0 * NEGLIGIBLE * self.residual.forces {
                return true;
            }
        }
        false
    }

    /// Corrects by the residual of the proof: forces of stiff springs cancel in it to more digits than doubles have. Goes on as long as
    /// the residual falls; a correction that does not lead on is taken back.
    fn correct(&mut self, route: &mut dyn Route, verifier: &mut Verifier) {
        for _ in 0..MOST_PASSES {
            let residual = std::mem::take(&mut verifier.residual);
            if residual.is_empty() {
                return;
            }
            let Ok(Some(step)) = route.step_for(&self.at, &residual) else { return };
            let before = Iterate { u: self.iterate.u.clone() };
            let enclosure = self.enclosure.clone();
            self.iterate.add(self.system, 1.0, &step);
            self.at = self.iterate.evaluate(self.system, true);
            let is_near = self.verify(verifier);
            let falls = norm(&verifier.residual) <= norm(&residual) / 2.0;
            if !(is_near || (falls && !verifier.residual.is_empty())) {
                self.at = before.evaluate(self.system, true);
                (self.iterate, self.enclosure) = (before, enclosure);
                return;
            }
            self.residual = TrueResidual::new(self.system, &self.at, self.reference);
            if is_near {
                return;
            }
        }
    }

    fn outcome(mut self, verifier: &mut Verifier, factorizations: usize) -> Outcome {
        if self.enclosure == Err(Unproved::NotReached) {
            self.verify(verifier);
        }
        let IterativeRefinement { system, iterate, enclosure, .. } = self;
        let u = iterate.rounded();
        let size = system.size(self.at.energy.sqrt(), &u);
        let rounding = system.energy_of_unrelated(&iterate.remainder()).sqrt();
        let rounding = if rounding > 0.0 { rounding / size } else { 0.0 };
        Outcome {
            u,
            forces: self.at.forces,
            p: self.at.p,
            residuals: self.residuals,
            residual: self.residual.norm,
            enclosure,
            forward_error: self.contraction * self.correction + rounding,
            condition: (system.largest() * self.softness).max(1.0),
            factorizations,
        }
    }
}

/// The residual of (8) at an iterate.
struct TrueResidual {
    /// Its norm, relative to the reference.
    norm: f64,
    /// The sum of its magnitudes beside the forces on the body: what loads, contact and reactions may be out of balance.
    unbalanced: f64,
    /// The forces on the body: loads and contact, or, where there are none, reactions, which may balance each other node by node.
    forces: f64,
}

impl TrueResidual {
    /// Before the first pass.
    const UNKNOWN: TrueResidual =
        TrueResidual { norm: f64::INFINITY, unbalanced: f64::INFINITY, forces: f64::INFINITY };

    fn new(system: &System, at: &Evaluation, reference: f64) -> Self {
        let d = system.d;
        let mut r = at.linear.clone();
        let one = |v: &[f64]| v.iter().map(|v| v.abs()).sum::<f64>();
        let mut forces = one(d.load.as_flattened());
        let mut contact = Vec::with_capacity(at.p.len());
        for piece in &d.contact {
            contact.extend(piece.contribution(&d.rule, &at.p[piece.functionals()]).force);
        }
        forces += one(&contact);
        system.add_forces(&contact, &mut r);
        if forces == 0.0 {
            // Only rounding is left where a body moves as a whole.
            forces = one(at.forces.as_flattened()).max(f64::EPSILON * reference);
        }
        let unbalanced = if forces > 0.0 { one(&r) / forces } else { 0.0 };
        TrueResidual { norm: norm(&r) / reference, unbalanced, forces }
    }
}

/// The size that residuals are relative to: |L| + |residual of the prescribed data| over the free degrees of freedom, or,
/// where these are nothing but rounding, the magnitudes of the forces that cancel there. 1 where there is no force at all.
pub fn reference(d: &Discretization) -> f64 {
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::contact::EdgeRule;
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Degree, Diagonal, Problem, Rectangle};
    use crate::proof::Intervals;

    fn outcome(radius: Option<f64>, residual: f64) -> Outcome {
        let intervals = Intervals {
            energy: [0.0; 2],
            max_displacement: [0.0; 2],
            contact: Vec::new(),
            reactions: BTreeMap::new(),
        };
        let enclosure = radius.map(|radius| Enclosure {
            kappa: 0.5,
            radius,
            relative: Some(radius),
            hardly_strains: false,
            if_strained: 1.0,
            pressure: radius,
            nodes: Vec::new(),
            intervals,
            isolation: None,
        });
        Outcome {
            u: Vec::new(),
            forces: Vec::new(),
            p: Vec::new(),
            residuals: Vec::new(),
            residual,
            enclosure: enclosure.ok_or(Unproved::NotReached),
            forward_error: 0.0,
            condition: 1.0,
            factorizations: 1,
        }
    }

    #[test]
    fn of_two_solutions_the_one_with_the_smaller_radius_is_better_and_then_that_with_the_smaller_residual()
     {
        let ordered = [
            outcome(Some(1e-12), 1.0),
            outcome(Some(1e-9), 1e-12),
            outcome(Some(1e-9), 1e-6),
            outcome(None, 1e-15),
            outcome(None, 1e-3),
        ];
        for (i, first) in ordered.iter().enumerate() {
            for (j, second) in ordered.iter().enumerate() {
                assert_eq!(first.is_better_than(second), i < j, "{i} {j}");
            }
        }
    }

    #[test]
    fn a_solve_ends_by_what_is_known_of_it() {
        let settings = Settings { tolerance: 1e-10, max_iterations: 3, proof: 1e-6 };
        let status = |radius, residual, steps: usize, condition| {
            // A residual before the first step and one after each.
            let residuals = vec![1.0; steps + 1];
            Outcome { residuals, condition, ..outcome(radius, residual) }.status(&settings)
        };
        assert_eq!(status(None, 1e-10, 1, 1.0), Ok(Status::Converged));
        assert_eq!(status(Some(1e-6), 1e-9, 1, 1e17), Ok(Status::ConvergedToRounding));
        let is_out_of_steps = |end| matches!(end, Err(SolveError::NotConverged { residuals, .. }) if residuals.len() == 4);
        let is_rounding = |end| matches!(end, Err(SolveError::IllConditioned { .. }));
        assert!(is_out_of_steps(status(None, 1e-9, 3, 1e3)));
        assert!(is_out_of_steps(status(Some(1e-5), 1e-9, 3, 1e3)));
        assert!(is_rounding(status(None, 1e-9, 3, 1e17)));
        assert!(is_rounding(status(None, 1e-9, 2, 1e3)));
        let singular = Outcome { enclosure: Err(Unproved::NoFactor), ..outcome(None, 1.0) };
        assert_eq!(singular.status(&settings), Err(SolveError::Singular));
    }

    /// Where it ends there are thirds, which doubles round, and it moves nothing.
    struct Thirds;

    impl Route for Thirds {
        fn factored(&self) -> Option<Factored> {
            None
        }

        fn factorizations(&self) -> usize {
            0
        }

        fn pass(
            &mut self,
            iterate: &mut Iterate,
            _: &mut Evaluation,
            residuals: &mut Vec<f64>,
            _: Until,
        ) -> Result<Pass, SolveError> {
            let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
            iterate.u.iter_mut().for_each(|u| *u = [third; 2]);
            residuals.push(0.0);
            Ok(Pass { energy: 0.0, left: 0.0, softness: 1.0 })
        }
    }

    #[test]
    fn the_rounding_of_the_displacement_is_part_of_its_error() {
        let cell = Rectangle { width: 1.0, height: 1.0, nx: 1, ny: 1, diagonal: Diagonal::Right };
        let problem = Problem::of(cell.mesh().unwrap(), Material::lame(1.0, 1.0, Plane::Strain))
            .with("top", Condition::displacement(|_| 0.0, |_| -0.1))
            .with("bottom", Condition::contact(|_| 0.0));
        let gamma =
            |coercivity: &crate::contact::contact_line::Coercivity| coercivity.limit() / 2.0;
        let d = Discretization::new(&problem, Degree::One, gamma, EdgeRule::Exact).unwrap();
        let system = System::new(&d).unwrap();
        let mut verifier = Verifier::new(&system, None);
        let settings = Settings::default();
        let of = refine(&system, &mut Thirds, &mut verifier, reference(&d), &settings).unwrap();
        // Of a third doubles lack 2e-17.
        assert!((1e-17..1e-15).contains(&of.forward_error), "{:e}", of.forward_error);
    }
}
