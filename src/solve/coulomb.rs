//! Coulomb's friction: the discrete equations F(u) = 0 with the slip bound mu \[P_n\]+ of the same point. F is no gradient, so no energy
//! leads Newton's method. docs/theory.md, 13.5:
//!
//! 1. two problems with a given slip bound, each the minimum of an energy: first without one (where friction alone holds the body,
//!    with one that is never reached), then with mu times the pressure of the first;
//! 2. Newton's method on F as long as its residual, in the dual norm of A, falls by a tenth in each step;
//! 3. where it does not, the problem with the bound of the step that was not taken, then 2. again;
//! 4. where 40 factorisations do not lead there, problems with the pressure of the one before for a bound, whose fixed point is the
//!    solution, mixed (`Mixing`), with 2. from what they come to;
//! 5. where 160 more do not, Newton's method from soft springs to stiffer ones.
//!
//! The tangent of F is S + B^T D B: S is symmetric positive definite, with the springs of what is pressed and of what sticks, and is
//! factored; D couples the friction of what slides to its pressure. With z = D B d the step is
//! d = S^-1 (-F - B^T z), (I + D B S^-1 B^T) z = -D B S^-1 F, solved by GMRES: as many unknowns as functionals that slide.

use std::sync::Arc;

use faer::Mat;
use faer::linalg::solvers::Solve;
use nalgebra::{DMatrix, DVector};

use super::SolveError;
use super::accuracy::{Pass, Route};
use super::assembled::Assembled;
use super::body::{Derivatives, all_springs, derivatives, supported};
use super::course::Course;
use super::iterate::{Evaluation, Iterate};
use super::newton::Until;
use crate::contact::Law;
use crate::contact::{Discretization, Piece};
use crate::linear::dense::{dot, norm};
use crate::linear::factor::Factor;
use crate::linear::system::{Factored, System};
use crate::model::law::Bound;

/// The share to which the residual must fall for a step to be taken.
const FALLS: f64 = 0.9;

/// Newton's method is left where so many steps leave more than this share of the residual: they cross a kink to and fro.
const SLOW_AFTER: usize = 8;
const SLOW: f64 = 0.1;

/// The shares of a step that are tried, one after the other: evaluations, no factorisations.
const SHARES_OF_A_STEP: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

/// The residual, as a share of |u|_a, that is rounding.
const ROUNDING: f64 = 3e-14;

/// The residual, as a share of |u|_a, that may be rounding: with 12,000 unknowns rounding leaves some 1e-13.
const NEAR_ROUNDING: f64 = 1e-12;

/// After so many factorisations beyond the start pressures are mixed, and after so many more springs are soft at first: of fifty
/// problems of well-shaped bodies three took more than 30, and none more than 63.
const MOST_FACTORIZATIONS: usize = 40;
const MOST_MIXED: usize = 160;

/// Newton's method is tried again where the pressures change by this share of what they did when it was tried last.
const NEARER: f64 = 0.2;

/// The number of steps after which a problem with a given bound is started again with soft springs.
const STEPS_FROM_HERE: usize = 12;

/// The stiffness of springs that continuation begins with, beside those of (8): a soft body in contact is hardly harder to solve than an
/// elastic one.
const SOFTEST: f64 = 1e-16;

/// The first and the least share of the way to the springs of (8), in powers of the stiffness, by which continuation goes on, and the
/// steps that it may take for one.
const FIRST_SHARE: f64 = 0.25;
const LEAST_SHARE: f64 = 1.0 / 4096.0;
const STEPS_OF_A_SHARE: usize = 40;

impl Discretization<'_> {
    /// Returns whether a piece has Coulomb's friction.
    pub(crate) fn has_coulomb(&self) -> bool {
        self.contact.iter().any(|piece| coefficient(piece).is_some())
    }
}

/// mu, where a piece has Coulomb's friction.
pub(crate) fn coefficient(piece: &Piece<impl Sized>) -> Option<f64> {
    match piece.geometry.law {
        Law::Friction(Bound::Coulomb(mu)) => Some(mu),
        _ => None,
    }
}

/// The way to a solution with Coulomb's friction.
pub(crate) struct Coulomb<'a, 'd, 'p> {
    system: &'a System<'d, 'p>,
    /// The size that residuals are relative to.
    reference: f64,
    /// The stiffness of the springs, 1 for those of (8).
    stiffness: f64,
    /// L of A, or, where it has none, with springs of all pieces: residuals are measured by it.
    metric: Option<Arc<Factor>>,
    of_a: Option<Factored>,
    factorizations: usize,
    /// Factorisations of the problems with Tresca's friction at the start.
    at_start: usize,
    first: bool,
}

impl<'a, 'd, 'p> Coulomb<'a, 'd, 'p> {
    /// Before anything is factored.
    pub(crate) fn new(system: &'a System<'d, 'p>, reference: f64) -> Self {
        Coulomb {
            system,
            reference,
            stiffness: 1.0,
            metric: None,
            of_a: None,
            factorizations: 0,
            at_start: 0,
            first: true,
        }
    }

    fn metric(&mut self) -> Result<Arc<Factor>, SolveError> {
        if let Some(metric) = &self.metric {
            return Ok(Arc::clone(metric));
        }
        self.factorizations += 1;
        let d = self.system.d;
        let own = match &d.slides {
            None => Factor::with(&self.system.structure, &self.system.matrix).map(Arc::new),
            Some(_) => Err(SolveError::NotPositiveDefinite),
        };
        let metric = match own {
            Ok(factor) => Arc::clone(&self.of_a.insert(factor.into()).factor),
            Err(SolveError::NotPositiveDefinite) => {
                self.system.factor(None, all_springs(d, 1.0).hessian)?.factor
            }
            Err(error) => return Err(error),
        };
        Ok(Arc::clone(self.metric.insert(metric)))
    }

    /// F where the linear part of the equations is `at`, and the derivatives of the friction and contact terms there.
    fn residual(&self, at: &Evaluation) -> (Vec<f64>, Derivatives) {
        let terms = derivatives(self.system.d, self.stiffness, &at.p);
        let mut r = at.linear.clone();
        self.system.add_forces(&terms.gradient, &mut r);
        (r, terms)
    }

    /// The dual norm of a residual.
    fn dual(&mut self, r: &[f64]) -> Result<f64, SolveError> {
        let metric = self.metric()?;
        let mut x = r.to_vec();
        metric.forward(&mut x);
        Ok(norm(&x))
    }

    /// Newton's step for F.
    fn step(&mut self, r: &[f64], terms: &Derivatives) -> Result<Vec<f64>, SolveError> {
        self.system.enters_step();
        let nodes = self.system.d.space.degree().nodes_per_edge();
        let mut springs = terms.hessian.clone();
        // The functionals whose force depends on the pressure of their piece: piece, first number, and the block of D.
        let mut coupled: Vec<(usize, DMatrix<f64>)> = Vec::new();
        for (piece, h) in self.system.d.contact.iter().zip(&mut springs) {
            if coefficient(piece).is_none() {
                continue;
            }
            let mut block = h.view_mut((nodes, 0), (nodes, nodes));
            if block.iter().any(|entry| *entry != 0.0) {
                coupled.push((piece.functionals().start, block.clone_owned()));
                block.fill(0.0);
            }
        }
        self.factorizations += 1;
        let factored = match self.system.factor(None, springs.clone()) {
            Err(SolveError::NotPositiveDefinite) => {
                self.factorizations += 1;
                self.system.factor(None, supported(self.system.d, 1.0, &springs))?
            }
            factored => factored?,
        };
        let factor = factored.factor;
        let mut d: Vec<f64> = r.iter().map(|r| -r).collect();
        factor.solve(&mut d);
        if coupled.is_empty() {
            return Ok(d);
        }
        let by_pressure = |values: &[f64]| -> Vec<f64> {
            let of = |(start, block): &(usize, DMatrix<f64>)| {
                let product = block * DVector::from_column_slice(&values[*start..start + nodes]);
                product.iter().copied().collect::<Vec<f64>>()
            };
            coupled.iter().flat_map(of).collect()
        };
        // S^-1 B^T z
        let bent = |z: &[f64]| {
            let mut forces = vec![0.0; self.system.functionals()];
            for ((start, _), z) in coupled.iter().zip(z.chunks_exact(nodes)) {
                forces[start + nodes..start + 2 * nodes].copy_from_slice(z);
            }
            let mut x = vec![0.0; r.len()];
            self.system.add_forces(&forces, &mut x);
            factor.solve(&mut x);
            x
        };
        let right = by_pressure(&self.system.values(&d));
        let times = |z: &[f64]| {
            let product = by_pressure(&self.system.values(&bent(z)));
            z.iter().zip(product).map(|(z, p)| z + p).collect::<Vec<f64>>()
        };
        let z = gmres(times, &right);
        for (d, x) in d.iter_mut().zip(bent(&z)) {
            *d -= x;
        }
        Ok(d)
    }

    /// Moves the iterate to the solution whose slip bound is mu times the `pressure` at the nodes of each piece; one that is never reached
    /// where that is infinite.
    fn tresca(
        &mut self,
        iterate: &mut Iterate,
        residuals: &mut Vec<f64>,
        until: Until,
        (pressure, from_here): (&[[f64; 3]], bool),
    ) -> Result<(), SolveError> {
        let bound = |e: usize, mu: f64| pressure[e].map(|p| (mu * p).min(f64::MAX / 1e200));
        let d = self.system.d.with_slip_bounds(bound);
        let here = iterate.rounded();
        let starts = if from_here { &[true, false][..] } else { &[false] };
        for &from_here in starts {
            let course = Course::default();
            let course = if from_here { course.from_displacement(&here) } else { course };
            let system = self.system.with_other_laws(&d, course);
            let mut route = Assembled::new(&system, self.reference);
            let mut other = Iterate::lift(&d);
            let mut at = other.evaluate(&system, false);
            let mut own = Vec::new();
            let steps = if from_here { until.steps.min(STEPS_FROM_HERE) } else { until.steps };
            let passed = route.pass(&mut other, &mut at, &mut own, Until { steps, ..until });
            self.factorizations += route.factorizations();
            let is_done = own.len() <= steps;
            residuals.extend(own);
            if from_here && !(is_done && passed.is_ok()) {
                continue;
            }
            passed?;
            *iterate = other;
            break;
        }
        Ok(())
    }

    /// P_n / gamma at the start, the end and the middle of each piece; negative where it pulls. With this for a slip bound the problem is
    /// that of Coulomb at its solution.
    fn pressures(&self, at: &Evaluation) -> Vec<[f64; 3]> {
        let nodes = self.system.d.space.degree().nodes_per_edge();
        let of = |piece: &Piece| {
            let p = &at.p[piece.functionals()][..nodes];
            std::array::from_fn(|a| p.get(a).map_or(0.0, |p| p.head() / piece.gamma))
        };
        self.system.d.contact.iter().map(of).collect()
    }
}

/// Anderson's mixing of the pressures p that problems with a given bound begin with, for their fixed point: of the last of these the
/// combination, with weights that add up to 1, whose changes nearly cancel.
#[derive(Default)]
struct Mixing {
    /// Pressures that each problem began with, and those that it came to.
    steps: Vec<[Vec<[f64; 3]>; 2]>,
}

/// The number of problems that are remembered.
const REMEMBERED: usize = 6;

impl Mixing {
    /// Remembers a problem: the pressures before and after it. Tells the size of the change.
    fn remember(&mut self, before: Vec<[f64; 3]>, after: Vec<[f64; 3]>) -> f64 {
        if self.steps.len() == REMEMBERED {
            self.steps.remove(0);
        }
        self.steps.push([before, after]);
        self.steps.last().map_or(0.0, |step| norm(&Self::change(step)))
    }

    /// The change of the bound, for which tension counts as none.
    fn change([before, after]: &[Vec<[f64; 3]>; 2]) -> Vec<f64> {
        let pairs = before.as_flattened().iter().zip(after.as_flattened());
        pairs.map(|(b, a)| a.max(0.0) - b.max(0.0)).collect()
    }

    /// The pressures to go on with; `None` before the first problem.
    fn next(&self) -> Option<Vec<[f64; 3]>> {
        let last = self.steps.last()?;
        let change = Self::change(last);
        let others: Vec<&[Vec<[f64; 3]>; 2]> = self.steps.iter().rev().skip(1).collect();
        let differences: Vec<Vec<f64>> = others
            .iter()
            .map(|step| change.iter().zip(Self::change(step)).map(|(c, o)| c - o).collect())
            .collect();
        // Least squares by the normal equations, kept definite by a small multiple of their diagonal.
        let count = differences.len();
        let square = |i: usize| dot(&differences[i], &differences[i]);
        let matrix = Mat::from_fn(count, count, |i, j| {
            let more = if i == j { 1e-10 * square(i) + f64::MIN_POSITIVE } else { 0.0 };
            dot(&differences[i], &differences[j]) + more
        });
        let right = Mat::from_fn(count, 1, |i, _| dot(&differences[i], &change));
        let weights = matrix.partial_piv_lu().solve(&right);
        let weights = (0..count).map(|i| weights[(i, 0)]);
        let mut next = last[1].clone();
        for (weight, other) in weights.zip(&others) {
            for (e, next) in next.iter_mut().enumerate() {
                for a in 0..3 {
                    next[a] -= weight * (last[1][e][a] - other[1][e][a]);
                }
            }
        }
        Some(next)
    }
}

impl Route for Coulomb<'_, '_, '_> {
    fn factored(&self) -> Option<Factored> {
        self.of_a.clone()
    }

    fn factorizations(&self) -> usize {
        self.factorizations
    }

    fn pass(
        &mut self,
        iterate: &mut Iterate,
        at: &mut Evaluation,
        residuals: &mut Vec<f64>,
        until: Until,
    ) -> Result<Pass, SolveError> {
        let system = self.system;
        let precisely = at.precisely;
        let is_first = std::mem::replace(&mut self.first, false);
        if is_first {
            self.begin(iterate, at, residuals, until)?;
        }
        let mut way = Way { is_first, precisely, ..Way::default() };
        let mut rejected = self.newton(iterate, at, residuals, until, &mut way)?;
        let (mut mixing, mut tried) = (Mixing::default(), f64::INFINITY);
        let mut is_continued = false;
        while let Some(next) = rejected {
            // What leads nowhere is not the way to the solution.
            let mut aside = Vec::new();
            let beyond = self.factorizations - self.at_start;
            if beyond < MOST_FACTORIZATIONS {
                self.tresca(iterate, &mut aside, until, (&self.pressures(&next), true))?;
            } else if beyond < MOST_FACTORIZATIONS + MOST_MIXED {
                let before = mixing.next().unwrap_or_else(|| self.pressures(at));
                self.tresca(iterate, &mut aside, until, (&before, true))?;
                *at = iterate.evaluate(system, precisely);
                let change = mixing.remember(before, self.pressures(at));
                if change > NEARER * tried {
                    rejected = Some(next);
                    continue;
                }
                tried = change;
            } else if !std::mem::replace(&mut is_continued, true) {
                self.continued(iterate, until)?;
                // The steps before lead nowhere.
                residuals.clear();
            } else {
                return Err(SolveError::NoFrictionSolution {
                    residual: way.least / self.reference,
                    factorizations: self.factorizations,
                });
            }
            *at = iterate.evaluate(system, precisely);
            let mut trial = Iterate { u: iterate.u.clone() };
            let mut trial_at = trial.evaluate(system, precisely);
            let mut own = Vec::new();
            rejected = self.newton(&mut trial, &mut trial_at, &mut own, until, &mut way)?;
            if rejected.is_none() {
                residuals.extend(own);
            }
            if rejected.is_none() || mixing.steps.is_empty() {
                (*iterate, *at) = (trial, trial_at);
            }
        }
        Ok(Pass {
            energy: if way.taken > 0 { way.moved } else { way.size * way.size },
            left: 0.0,
            softness: way.softness,
        })
    }

    fn step_for(
        &mut self,
        at: &Evaluation,
        residual: &[f64],
    ) -> Result<Option<Vec<f64>>, SolveError> {
        let (_, terms) = self.residual(at);
        self.step(residual, &terms).map(Some)
    }
}

/// The progress of Newton's method.
#[derive(Default)]
struct Way {
    /// The way is the first one, which comes from afar.
    is_first: bool,
    precisely: bool,
    /// The steps that are taken, their largest change of the residual, and the softest of them.
    taken: usize,
    moved: f64,
    softness: f64,
    /// The dual norm of the residual where it ends, and the least norm of one.
    size: f64,
    least: f64,
}

impl<'d, 'p> Coulomb<'_, 'd, 'p> {
    /// Goes to the displacement from which the first pass starts: the one that is given, or Tresca's with what presses without
    /// friction.
    fn begin(
        &mut self,
        iterate: &mut Iterate,
        at: &mut Evaluation,
        residuals: &mut Vec<f64>,
        until: Until,
    ) -> Result<(), SolveError> {
        let (system, precisely) = (self.system, at.precisely);
        let slides = system.d.slides.is_some();
        if let Some(given) = system.course.displacement(system.d) {
            // With the prescribed components as they are.
            let free = system.d.constraints.values().iter().map(|held| held.map(|c| c.is_none()));
            for ((u, free), given) in iterate.u.iter_mut().zip(free).zip(given) {
                for c in (0..2).filter(|&c| free[c]) {
                    u[c] = given[c].into();
                }
            }
        } else {
            let start = if slides { f64::INFINITY } else { 0.0 };
            let pieces = system.d.contact.len();
            self.tresca(iterate, residuals, until, (&vec![[start; 3]; pieces], false))?;
            *at = iterate.evaluate(system, precisely);
            let pressures = self.pressures(at);
            // A body that the bounds of this start do not hold is left where friction glued it.
            let held = self.tresca(iterate, residuals, until, (&pressures, true));
            if !slides {
                held?;
            }
        }
        *at = iterate.evaluate(system, precisely);
        self.at_start = self.factorizations;
        Ok(())
    }

    /// Takes Newton's steps for F as long as they lead on; returns the evaluation at the end of one that does not.
    fn newton(
        &mut self,
        iterate: &mut Iterate,
        at: &mut Evaluation,
        residuals: &mut Vec<f64>,
        until: Until,
        way: &mut Way,
    ) -> Result<Option<Evaluation>, SolveError> {
        let system = self.system;
        let (mut r, mut terms) = self.residual(at);
        way.size = self.dual(&r)?;
        let first = norm(&r);
        way.least = if way.least > 0.0 { way.least.min(first) } else { first };
        residuals.push(first / self.reference);
        let mut halved = true;
        let mut sizes = vec![way.size];
        loop {
            let scale = system.size(at.energy.sqrt(), &iterate.rounded());
            let is_rounding = way.size <= ROUNDING * scale || norm(&r) <= terms.noise(system, at);
            if (is_rounding && (way.is_first || way.taken > 0)) || sizes.len() > until.steps {
                return Ok(None);
            }
            let slow =
                sizes.len() > SLOW_AFTER && way.size > SLOW * sizes[sizes.len() - 1 - SLOW_AFTER];
            if slow && way.is_first {
                return Ok(Some(iterate.evaluate(system, way.precisely)));
            }
            let d = self.step(&r, &terms)?;
            let is_near = way.size <= NEAR_ROUNDING * scale || !way.is_first;
            let mut rejected = None;
            for t in SHARES_OF_A_STEP {
                let mut trial = Iterate { u: iterate.u.clone() };
                trial.add(system, t, &d);
                let next = trial.evaluate(system, way.precisely);
                let (next_r, next_terms) = self.residual(&next);
                let next_size = self.dual(&next_r)?;
                let falls = next_size <= (1.0 - (1.0 - FALLS) * t) * way.size;
                if falls || (is_near && next_size <= way.size) {
                    let square = dot(&d, &d);
                    halved = next_size <= way.size / 2.0;
                    way.moved = way.moved.max(way.size * way.size);
                    way.softness = way.softness.max(square / (way.size * way.size));
                    *iterate = trial;
                    *at = next;
                    (r, terms, way.size) = (next_r, next_terms, next_size);
                    way.least = way.least.min(norm(&r));
                    residuals.push(norm(&r) / self.reference);
                    way.taken += 1;
                    sizes.push(way.size);
                    rejected = None;
                    break;
                }
                rejected.get_or_insert(next);
                if is_near {
                    break;
                }
            }
            match rejected {
                None if is_near && !halved => return Ok(None),
                None => {}
                Some(_) if is_near => return Ok(None),
                rejected => return Ok(rejected),
            }
        }
    }

    /// Moves the iterate to a solution by continuation from soft springs to those of (8), or as near as that leads: what friction bears
    /// at most is the same share of the pressure.
    fn continued(&mut self, iterate: &mut Iterate, until: Until) -> Result<(), SolveError> {
        let system = self.system;
        *iterate = Iterate::lift(system.d);
        if system.d.slides.is_some() {
            let glue = vec![[f64::INFINITY; 3]; system.d.contact.len()];
            self.tresca(iterate, &mut Vec::new(), until, (&glue, false))?;
        }
        let few = Until { steps: STEPS_OF_A_SHARE, ..until };
        let (mut done, mut by) = (0.0, FIRST_SHARE);
        while done < 1.0 && by >= LEAST_SHARE {
            let next = f64::min(done + by, 1.0);
            self.stiffness = SOFTEST.powf(1.0 - next);
            let mut trial = Iterate { u: iterate.u.clone() };
            let mut at = trial.evaluate(system, false);
            let mut way = Way { is_first: true, ..Way::default() };
            let mut residuals = Vec::new();
            let left = self.newton(&mut trial, &mut at, &mut residuals, few, &mut way)?;
            if left.is_none() && residuals.len() <= few.steps {
                (*iterate, done, by) = (trial, next, 1.5 * by);
            } else {
                by /= 2.0;
            }
        }
        self.stiffness = 1.0;
        Ok(())
    }
}

/// Solves M x = b by GMRES, M being the matrix that `times` multiplies by, until the residual is some 1e-12 of b or no longer
/// falls.
fn gmres(times: impl Fn(&[f64]) -> Vec<f64>, b: &[f64]) -> Vec<f64> {
    let size = norm(b);
    if !(size > 0.0) {
        return vec![0.0; b.len()];
    }
    let most = b.len().min(200);
    let mut basis: Vec<Vec<f64>> = vec![b.iter().map(|b| b / size).collect()];
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<[f64; 2]> = Vec::new();
    let mut right = vec![size];
    for k in 0..most {
        let mut w = times(&basis[k]);
        let mut column = Vec::with_capacity(k + 2);
        for v in &basis {
            let along = dot(v, &w);
            w.iter_mut().zip(v).for_each(|(w, v)| *w -= along * v);
            column.push(along);
        }
        let rest = norm(&w);
        column.push(rest);
        for (j, &[c, s]) in rotations.iter().enumerate() {
            let (a, b) = (column[j], column[j + 1]);
            (column[j], column[j + 1]) = (c * a + s * b, c * b - s * a);
        }
        let length = column[k].hypot(column[k + 1]);
        let rotation =
            if length > 0.0 { [column[k] / length, column[k + 1] / length] } else { [1.0, 0.0] };
        let [c, s] = rotation;
        rotations.push(rotation);
        (column[k], column[k + 1]) = (length, 0.0);
        let last = right[k];
        right[k] = c * last;
        right.push(-s * last);
        columns.push(column);
        let is_done = right[k + 1].abs() <= 1e-12 * size || !(rest > f64::EPSILON * size);
        if is_done || k + 1 == most {
            break;
        }
        basis.push(w.iter().map(|w| w / rest).collect());
    }
    let count = columns.len();
    let mut y = vec![0.0; count];
    for i in (0..count).rev() {
        let sum: f64 = (i + 1..count).map(|j| columns[j][i] * y[j]).sum();
        y[i] = if columns[i][i] == 0.0 { 0.0 } else { (right[i] - sum) / columns[i][i] };
    }
    let mut x = vec![0.0; b.len()];
    for (v, y) in basis.iter().zip(&y) {
        x.iter_mut().zip(v).for_each(|(x, v)| *x += y * v);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Friction, law::EdgeRule};
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Degree, Diagonal, Problem, Rectangle};

    /// A block on a rough floor, pressed and dragged by its top, that sticks in parts and slides in parts.
    fn block() -> Problem {
        let mesh = Rectangle { width: 1.0, height: 1.0, nx: 6, ny: 6, diagonal: Diagonal::Crossed };
        Problem::of(mesh.mesh().unwrap(), Material::lame(1.0, 1.0, Plane::Strain))
            .with("top", Condition::displacement(|[x, _]| 0.02 + 0.01 * x, |_| -0.05))
            .with("bottom", Condition::contact(|_| 0.0))
            .with_friction("bottom", Friction::Coulomb(0.2))
    }

    #[test]
    fn one_piece_with_coulombs_friction_is_enough_for_its_route() {
        let mesh = Rectangle { width: 1.0, height: 1.0, nx: 2, ny: 2, diagonal: Diagonal::Right };
        let mesh = mesh.mesh().unwrap();
        let of = |laws: [Option<Friction>; 2]| {
            let mut problem = Problem::of(mesh.clone(), Material::lame(1.0, 1.0, Plane::Strain))
                .with("top", Condition::clamped());
            for (name, law) in ["bottom", "right"].into_iter().zip(laws) {
                problem = problem.with(name, Condition::contact(|_| 0.0));
                problem = law.into_iter().fold(problem, |p, law| p.with_friction(name, law));
            }
            let d =
                Discretization::new(&problem, Degree::One, |c| c.limit() / 2.0, EdgeRule::Exact);
            d.unwrap().has_coulomb()
        };
        let (coulomb, tresca) =
            (|| Some(Friction::Coulomb(0.2)), || Some(Friction::tresca(|_| 0.1)));
        assert!(of([coulomb(), coulomb()]) && of([coulomb(), tresca()]) && of([None, coulomb()]));
        // The control.
        assert!(!of([tresca(), tresca()]) && !of([None, tresca()]) && !of([None, None]));
    }

    #[test]
    fn continuation_alone_leads_to_a_solution_which_is_that_with_its_pressure_for_a_bound() {
        let problem = block();
        for degree in [Degree::One, Degree::Two] {
            let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact);
            let d = d.unwrap();
            let system = System::new(&d).unwrap();
            let mut route = Coulomb::new(&system, 1.0);
            let mut size = |stiffness: f64, iterate: &Iterate| {
                route.stiffness = stiffness;
                let (r, _) = route.residual(&iterate.evaluate(&system, false));
                route.dual(&r).unwrap()
            };
            let mut other = Coulomb::new(&system, 1.0);
            let mut iterate = Iterate::lift(&d);
            let first = size(1.0, &iterate);
            let until = Until { steps: 200, residual: 0.0, near: 0.0 };
            other.continued(&mut iterate, until).unwrap();
            // The control: for softer springs this is no solution.
            let [last, soft] = [1.0, 0.5].map(|stiffness| size(stiffness, &iterate));
            assert!(last <= 1e-9 * first && soft >= 1e-3 * first, "{last:e} {soft:e} {first:e}");
            let pressures = other.pressures(&iterate.evaluate(&system, false));
            for (times, is_there) in [(1.0, true), (0.5, false)] {
                let bound: Vec<_> = pressures.iter().map(|p| p.map(|p| times * p)).collect();
                let mut again = Iterate::lift(&d);
                other.tresca(&mut again, &mut Vec::new(), until, (&bound, false)).unwrap();
                let off = size(1.0, &again) / first;
                assert_eq!(off <= 1e-6, is_there, "{times}: {off:e}");
                assert!(off <= 1e-6 || off >= 1e-3, "{times}: {off:e}");
            }
        }
    }

    #[test]
    fn a_step_takes_off_the_residual_and_without_the_share_of_the_pressure_it_does_not() {
        let problem = block();
        for degree in [Degree::One, Degree::Two] {
            let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact);
            let d = d.unwrap();
            let system = System::new(&d).unwrap();
            let mut route = Coulomb::new(&system, 1.0);
            let mut iterate = Iterate::lift(&d);
            let until = Until { steps: 200, residual: 0.0, near: 0.0 };
            let bounds = vec![[0.05; 3]; d.contact.len()];
            route.tresca(&mut iterate, &mut Vec::new(), until, (&bounds, false)).unwrap();
            let (r, terms) = route.residual(&iterate.evaluate(&system, false));
            let nodes = degree.nodes_per_edge();
            let mut hessian = terms.hessian.clone();
            for block in &mut hessian {
                block.view_mut((nodes, 0), (nodes, nodes)).fill(0.0);
            }
            assert!(hessian != terms.hessian, "nothing slides");
            let uncoupled = Derivatives { stiffness: 1.0, gradient: Vec::new(), hessian };
            // Of a piecewise smooth function, r(u + t d) is (1 - t) r up to the square of t.
            let t = 1e-5;
            let mut off = |terms: &Derivatives| {
                let step = route.step(&r, terms).unwrap();
                let mut moved = Iterate { u: iterate.u.clone() };
                moved.add(&system, t, &step);
                let (next, _) = route.residual(&moved.evaluate(&system, false));
                let rest = next.iter().zip(&r).map(|(next, r)| next - (1.0 - t) * r);
                norm(&rest.collect::<Vec<f64>>()) / (t * norm(&r))
            };
            let [coupled, uncoupled] = [off(&terms), off(&uncoupled)];
            assert!(coupled < 1e-3 && uncoupled > 1e-2, "{degree:?}: {coupled:e} {uncoupled:e}");
        }
    }

    #[test]
    fn mixing_finds_the_fixed_point_of_an_affine_map() {
        let map = |[a, b, _]: [f64; 3]| [1.0 + 0.5 * a - 0.4 * b, 2.0 + 0.3 * a + 0.2 * b, 0.0];
        // a = 1 + a / 2 - 2 b / 5, b = 2 + 3 a / 10 + b / 5
        let fixed = [0.0, 2.5, 0.0];
        let mut mixing = Mixing::default();
        for before in [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 3.0, 0.0]] {
            mixing.remember(vec![before], vec![map(before)]);
        }
        // The diagonal is larger by 1e-10.
        let found = mixing.next().unwrap()[0];
        assert!((0..3).all(|a| (found[a] - fixed[a]).abs() < 1e-8), "{found:?}");
        // The control: the last one alone is not near.
        let last = map([1.0, 3.0, 0.0]);
        assert!((0..3).any(|a| (last[a] - fixed[a]).abs() > 0.1));
    }

    #[test]
    fn gmres_solves_what_is_not_symmetric_and_a_wrong_product_does_not() {
        let a = [[2.0, -1.0, 0.5], [0.0, 1.0, 3.0], [1.0, 0.0, 1.0]];
        let product = |a: [[f64; 3]; 3], x: &[f64]| -> Vec<f64> {
            a.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
        };
        let b = [1.0, -2.0, 0.25];
        let left = |x: &[f64]| -> f64 {
            product(a, x).iter().zip(b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max)
        };
        assert!(left(&gmres(|x| product(a, x), &b)) < 1e-14);
        let mut transposed = a;
        (transposed[0][1], transposed[1][0]) = (a[1][0], a[0][1]);
        assert!(left(&gmres(|x| product(transposed, x), &b)) > 1e-2);
        assert_eq!(gmres(|x| product(a, x), &[0.0; 3]), [0.0; 3]);
    }
}
