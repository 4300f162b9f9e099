//! The assembled route: Newton's method on the displacement itself, the tangent A + B^T Psi'' B factored where Psi'' has changed. This
//! route is the cheaper one where contact edges are many beside the body (strips, graded meshes), and the only one where supports hardly
//! hold the body: the tangent includes the springs of contact.

use std::borrow::Cow;

use nalgebra::DMatrix;

use super::SolveError;
use super::accuracy::{Pass, Route};
use super::body::{
    Body, ContactEnergy, Derivatives, Residual, Step, all_springs, derivatives, does_again,
    no_springs, springs_beside_shear, supported, times,
};
use super::iterate::{Evaluation, Iterate, has_few_digits};
use super::newton::{self, Until};
use crate::held::clearance;
use crate::kernel::DoubleDouble;
use crate::linear::dense::{dot, norm};
use crate::linear::system::{Factored, System};
use crate::model::rigid::Parts;

/// The last factored tangent.
pub(crate) struct Assembled<'a, 'd, 'p> {
    system: &'a System<'d, 'p>,
    /// The size that residuals are relative to.
    reference: f64,
    factored: Option<Factored>,
    /// The norm of the residual where it was used last.
    used_at: f64,
    /// A alone, once it has been factored.
    body: Option<Factored>,
    factorizations: usize,
    precisely: bool,
    first: bool,
}

impl<'a, 'd, 'p> Assembled<'a, 'd, 'p> {
    /// Before anything is factored.
    pub(crate) fn new(system: &'a System<'d, 'p>, reference: f64) -> Self {
        Assembled {
            system,
            reference,
            factored: None,
            used_at: 0.0,
            body: None,
            factorizations: 0,
            precisely: false,
            first: true,
        }
    }

    /// Returns whether the edges that are in contact leave a motion free that contact stops: the tangent is singular then.
    fn is_loose(&self, at: &Derivatives) -> bool {
        let d = self.system.d;
        let Some(slides) = &d.slides else { return false };
        let nodes = d.space.degree().nodes_per_edge();
        let springs = |h: &DMatrix<f64>| {
            let acts = |range: std::ops::Range<usize>| range.into_iter().any(|i| h[(i, i)] != 0.0);
            [acts(0..nodes.min(h.nrows())), acts(nodes.min(h.nrows())..h.nrows())]
        };
        let pressing: Vec<[bool; 2]> = at.hessian.iter().map(springs).collect();
        let parts = Parts::new(d.space.mesh());
        clearance::free_where(d, &parts, &pressing).len() > slides.basis.len()
    }

    fn factor(&mut self, at: &Derivatives, residual: f64) -> Result<&Factored, SolveError> {
        // What needs more than doubles has springs so stiff that a small change of them is not small beside the body.
        let residuals = [if self.precisely { 0.0 } else { self.used_at }, residual];
        self.used_at = residual;
        let factored = match self.factored.take() {
            Some(last) if does_again(&last.springs, &at.hessian, residuals) => last,
            last => {
                let coercive = self.system.d.kappa() < 1.0;
                let mut factored = Err(SolveError::NotPositiveDefinite);
                if !(coercive && self.is_loose(at)) {
                    factored = self.system.factor(last, at.hessian.clone());
                    self.factorizations += 1;
                }
                if coercive && matches!(factored, Err(SolveError::NotPositiveDefinite)) {
                    factored = self
                        .system
                        .factor(None, supported(self.system.d, at.stiffness, &at.hessian));
                    self.factorizations += 1;
                    if matches!(factored, Err(SolveError::NotPositiveDefinite)) {
                        return Err(SolveError::Singular);
                    }
                }
                factored?
            }
        };
        if self.body.is_none() && factored.springs.iter().flatten().all(|h| *h == 0.0) {
            self.body = Some(factored.clone());
        }
        Ok(self.factored.insert(factored))
    }
}

impl Route for Assembled<'_, '_, '_> {
    fn factored(&self) -> Option<Factored> {
        self.body.clone()
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
        self.precisely = at.precisely;
        let soft = self.first;
        self.first = false;
        let d = self.system.d;
        let carried = soft.then(|| at.p_magnitudes.clone());
        let mut body = Full {
            route: self,
            iterate,
            at,
            d: Vec::new(),
            ad: Vec::new(),
            may_carry: soft,
            carried,
            energy: 0.0,
            softness: 0.0,
        };
        let left = newton::minimise(d, &mut body, soft, residuals, until)?;
        let Full { carried, energy, softness, .. } = body;
        if carried.is_some() {
            *at = iterate.evaluate(self.system, at.precisely);
        }
        Ok(Pass { energy, left, softness })
    }

    fn step_for(
        &mut self,
        at: &Evaluation,
        residual: &[f64],
    ) -> Result<Option<Vec<f64>>, SolveError> {
        let terms = derivatives(self.system.d, 1.0, &at.p);
        let mut d: Vec<f64> = residual.iter().map(|r| -r).collect();
        self.factor(&terms, norm(residual))?.factor.solve(&mut d);
        Ok(Some(d))
    }
}

/// Newton's unknown u.
struct Full<'r, 'i, 'a, 'd, 'p> {
    route: &'r mut Assembled<'a, 'd, 'p>,
    iterate: &'i mut Iterate,
    at: &'i mut Evaluation,
    /// The step.
    d: Vec<f64>,
    /// A d, as the step's equation has it.
    ad: Vec<f64>,
    /// The residual and P may be carried along with the steps: a pass that corrects follows.
    may_carry: bool,
    /// The magnitudes that P was added up from since residual and P are carried along, before these are evaluated.
    carried: Option<Vec<f64>>,
    /// The largest energy of the steps of this pass, and the largest square of one beside its energy.
    energy: f64,
    softness: f64,
}

impl Full<'_, '_, '_, '_, '_> {
    /// The residual of (8).
    fn gradient(&self, at: &Derivatives) -> Vec<f64> {
        let mut r = self.at.linear.clone();
        self.route.system.add_forces(&at.gradient, &mut r);
        r
    }

    /// How much stiffer contact is than the body, by the power method on A^-1 B^T Psi'' B from the last step on; A is what was factored last.
    fn stiffness(&self, at: &Derivatives) -> Result<f64, SolveError> {
        let Some(Factored { factor, .. }) = &self.route.factored else {
            return Ok(springs_beside_shear(self.route.system.d));
        };
        Ok(newton::largest_eigenvalue(self.d.clone(), |x| {
            let mut force = vec![0.0; x.len()];
            self.route
                .system
                .add_forces(&at.hessian_times(&self.route.system.values(x)), &mut force);
            factor.solve(&mut force);
            force
        }))
    }

    /// Moves what is carried by `t` times a step. `false` if nothing is, or if P has too few digits left somewhere: then nothing is
    /// from there on.
    fn carry(&mut self, t: f64, step: &Step) -> bool {
        let Some(mut sizes) = self.carried.take() else { return false };
        for (linear, ad) in self.at.linear.iter_mut().zip(&self.ad) {
            *linear += t * ad;
        }
        for (p, dy) in self.at.p.iter_mut().zip(&step.dy) {
            *p += DoubleDouble::from(t * dy);
        }
        self.route.system.each_functional(|row, i, b| sizes[i] += (t * b * self.d[row]).abs());
        self.may_carry = !self.at.p.iter().zip(&sizes).any(has_few_digits);
        self.carried = self.may_carry.then_some(sizes);
        self.may_carry
    }
}

impl Body for Full<'_, '_, '_, '_, '_> {
    fn y(&self) -> Cow<'_, [DoubleDouble]> {
        Cow::Borrowed(&self.at.p)
    }

    fn residual(&self, at: &Derivatives) -> Residual {
        let reference = self.route.reference;
        let noise = at.noise(self.route.system, self.at);
        Residual { norm: norm(&self.gradient(at)) / reference, noise: noise / reference }
    }

    /// The body without contact, or, where it does not hold without, on springs of all edges, which pull as well as push.
    fn start(&mut self, edges: &impl ContactEnergy) -> Result<Option<f64>, SolveError> {
        if let Some(p) = self.route.system.course.p(self.route.system.d) {
            let frozen = derivatives(edges, 1.0, &p).pulling(&self.y());
            let step = self.step(&frozen)?;
            self.advance(1.0, &step);
            return Ok(None);
        }
        // Springs that cannot let go act in any case.
        let none = no_springs(edges).pulling(&self.at.p);
        if self.route.system.d.slides.is_none() {
            match self.step(&none) {
                Ok(step) => {
                    self.advance(1.0, &step);
                    let at = derivatives(edges, 1.0, &self.y());
                    return Ok(Some(self.stiffness(&at)?));
                }
                Err(SolveError::Singular) => {}
                Err(error) => return Err(error),
            }
        }
        let springs = springs_beside_shear(self.route.system.d);
        let pulling = all_springs(edges, 1.0 / springs).pulling(&self.at.p);
        let step = self.step(&pulling)?;
        self.advance(1.0, &step);
        Ok(Some(springs))
    }

    fn step(&mut self, at: &Derivatives) -> Result<Step, SolveError> {
        self.route.system.enters_step();
        let gradient = self.gradient(at);
        let mut d: Vec<f64> = gradient.iter().map(|r| -r).collect();
        self.route.factor(at, norm(&gradient))?.factor.solve(&mut d);
        let dy = self.route.system.values(&d);
        let hessian = self.route.factored.as_ref().map_or(&at.hessian[..], |last| &last.springs);
        let slope = dot(&gradient, &d);
        // A d and d^T A d, where (A + B^T Psi'' B) d = -r with the Psi'' that was factored: nothing is lost where A d cancels.
        let forces: Vec<f64> = times(hessian, &dy, |h| -h);
        let curvature = -slope + dot(&forces, &dy);
        let mut ad = gradient;
        ad.iter_mut().for_each(|r| *r = -*r);
        self.route.system.add_forces(&forces, &mut ad);
        (self.d, self.ad) = (d, ad);
        Ok(Step { dy, slope, curvature })
    }

    fn advance(&mut self, t: f64, step: &Step) {
        self.iterate.add(self.route.system, t, &self.d);
        if !self.carry(t, step) {
            *self.at = self.iterate.evaluate(self.route.system, self.route.precisely);
            self.carried = self.may_carry.then(|| vec![0.0; self.at.p.len()]);
        }
        self.energy = self.energy.max(-t * t * step.slope);
        if step.slope < 0.0 {
            let square: f64 = self.d.iter().map(|d| d * d).sum();
            self.softness = self.softness.max(square / -step.slope);
        }
    }
}
