//! The interface between Newton's method ([`super::newton`]) and the pieces of Gamma_C and the body, whichever way its equations
//! are solved.

use std::borrow::Cow;
use std::ops::Range;

use nalgebra::DMatrix;

use super::SolveError;
use super::iterate::Evaluation;
use crate::contact::discretization::Discretization;
use crate::contact::piece::Stretch;
use crate::kernel::{DoubleDouble, Response};
use crate::linear::dense::norm;
use crate::linear::system::System;

/// The pieces of Gamma_C as Newton's method needs them.
pub(crate) trait ContactEnergy {
    /// The number of them.
    fn count(&self) -> usize;
    /// The numbers of the values of P on piece `e`, among those of all pieces.
    fn values(&self, e: usize) -> Range<usize>;
    /// The gradient and the Hessian of Psi on piece `e`, with springs of this `stiffness`, where P has the values `p`.
    fn derivatives(&self, e: usize, stiffness: f64, p: &[DoubleDouble])
    -> (Vec<f64>, DMatrix<f64>);
    /// Returns whether piece `e` has neither gradient nor Hessian where P has the values `p`, as far as these tell.
    fn is_open(&self, _e: usize, _p: &[DoubleDouble]) -> bool {
        false
    }
    /// The Bregman distance of this Psi on piece `e` from `p` to `q`.
    fn bregman(&self, e: usize, stiffness: f64, p: &[DoubleDouble], q: &[DoubleDouble]) -> f64;
    /// Values of P on piece `e` at which all of its springs act.
    fn closed(&self, e: usize) -> Vec<f64> {
        vec![1.0; self.values(e).len()]
    }
    /// Returns whether piece `e` is without springs somewhere.
    fn lets_go(&self, _e: usize) -> bool {
        true
    }
}

/// Psi of a discretization; pieces that press in no solution have none.
impl ContactEnergy for Discretization<'_> {
    fn count(&self) -> usize {
        self.contact.len()
    }

    fn values(&self, e: usize) -> Range<usize> {
        self.contact[e].functionals()
    }

    fn derivatives(
        &self,
        e: usize,
        stiffness: f64,
        p: &[DoubleDouble],
    ) -> (Vec<f64>, DMatrix<f64>) {
        if self.is_idle(e) {
            return (vec![0.0; p.len()], DMatrix::zeros(p.len(), p.len()));
        }
        let contribution = self.contact[e].softened(&self.rule, stiffness, p);
        (contribution.force, contribution.tangent)
    }

    fn is_open(&self, e: usize, p: &[DoubleDouble]) -> bool {
        self.is_idle(e) || self.contact[e].is_open(p)
    }

    fn bregman(&self, e: usize, stiffness: f64, p: &[DoubleDouble], q: &[DoubleDouble]) -> f64 {
        if self.is_idle(e) { 0.0 } else { self.contact[e].bregman(&self.rule, stiffness, p, q) }
    }

    fn closed(&self, e: usize) -> Vec<f64> {
        self.contact[e].geometry.law.closed(self.contact[e].degree)
    }

    fn lets_go(&self, e: usize) -> bool {
        self.contact[e].responses().all(|(response, _)| response == Response::Unilateral)
    }
}

/// The body with its loads, at an iterate.
pub(crate) trait Body {
    /// y, the values of P at the nodes of each piece, in double-doubles: between the nodes P may be far smaller.
    fn y(&self) -> Cow<'_, [DoubleDouble]>;
    /// The residual of (8) at the iterate, relative, where Psi has the derivatives `at`; and how much of it may be noise.
    fn residual(&self, at: &Derivatives) -> Residual;
    /// Goes to the start. Contact is that much stiffer than the body there: the largest eigenvalue of B^T Psi'' B with regard to
    /// A, roughly. `None` if it is one step from a start that was given.
    ///
    /// # Errors
    /// As [`Body::step`].
    fn start(&mut self, edges: &impl ContactEnergy) -> Result<Option<f64>, SolveError>;
    /// The Newton step from the iterate.
    ///
    /// # Errors
    /// A tangent that is not positive definite, and lack of memory.
    fn step(&mut self, at: &Derivatives) -> Result<Step, SolveError>;
    /// Moves the iterate by `t` times `step`, the last one.
    fn advance(&mut self, t: f64, step: &Step);
}

/// The size of a residual.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Residual {
    /// Its norm, relative to the reference of the problem.
    pub(crate) norm: f64,
    /// A norm that rounding alone may have.
    pub(crate) noise: f64,
}

/// The derivatives of Psi at y.
pub(crate) struct Derivatives {
    /// The stiffness of its springs, 1 for those of (8).
    pub(crate) stiffness: f64,
    /// Nodal values of the gradient.
    pub(crate) gradient: Vec<f64>,
    /// The Hessian, piece by piece.
    pub(crate) hessian: Vec<DMatrix<f64>>,
}

/// A step d.
pub(crate) struct Step {
    /// B d
    pub(crate) dy: Vec<f64>,
    /// DJ d <= 0
    pub(crate) slope: f64,
    /// d^T A d
    pub(crate) curvature: f64,
}

/// The derivatives of Psi at `y`, with springs of this `stiffness`.
pub(crate) fn derivatives(
    edges: &impl ContactEnergy,
    stiffness: f64,
    y: &[impl Copy + Into<DoubleDouble>],
) -> Derivatives {
    let mut gradient = Vec::with_capacity(y.len());
    let mut hessian = Vec::with_capacity(edges.count());
    let y: Vec<DoubleDouble> = y.iter().map(|&p| p.into()).collect();
    for e in 0..edges.count() {
        let p = &y[edges.values(e)];
        if edges.is_open(e, p) {
            gradient.resize(gradient.len() + p.len(), 0.0);
            hessian.push(DMatrix::zeros(p.len(), p.len()));
            continue;
        }
        let (g, h) = edges.derivatives(e, stiffness, p);
        gradient.extend(g);
        hessian.push(h);
    }
    Derivatives { stiffness, gradient, hessian }
}

/// The derivatives where all springs act.
pub(crate) fn all_springs(edges: &impl ContactEnergy, stiffness: f64) -> Derivatives {
    let closed: Vec<f64> = (0..edges.count()).flat_map(|e| edges.closed(e)).collect();
    derivatives(edges, stiffness, &closed)
}

/// How much stiffer than the body in shear, the sum of |E| / (gamma mu), the springs of all pieces are: what is known where the body has
/// no compliance, because nothing else holds it.
pub(super) fn springs_beside_shear(d: &Discretization) -> f64 {
    let mu = |stretch: &Stretch| d.problem.material.of(stretch.edge.triangle).mu();
    let stiffer = d.contact.iter().map(|piece| {
        let softest = piece.geometry.stretches.iter().map(mu).fold(f64::INFINITY, f64::min);
        piece.length / (piece.gamma * softest)
    });
    stiffer.sum::<f64>().max(1.0)
}

/// The share of the springs of all pieces that is added to a tangent which has no factor: the pieces that are in contact at an
/// iterate need not hold the body that those of the solution hold. The step goes downhill all the same. The share is far below
/// 1, to leave the way to the other pieces open, and far above the rounding of the tangent; 1e-3 does as well, and 0 leaves
/// bodies unsolved.
const SUPPORT: f64 = 1e-6;

/// A Hessian with a little of the springs of all pieces, of this `stiffness`.
pub(super) fn supported(
    edges: &impl ContactEnergy,
    stiffness: f64,
    hessian: &[DMatrix<f64>],
) -> Vec<DMatrix<f64>> {
    let all = all_springs(edges, stiffness);
    hessian.iter().zip(&all.hessian).map(|(h, all)| h + SUPPORT * all).collect()
}

/// The derivatives where no spring acts but those that cannot let go.
pub(crate) fn no_springs(edges: &impl ContactEnergy) -> Derivatives {
    let of = |e: usize| {
        let closed: Vec<DoubleDouble> = edges.closed(e).into_iter().map(Into::into).collect();
        match edges.lets_go(e) {
            true => DMatrix::zeros(closed.len(), closed.len()),
            false => edges.derivatives(e, 1.0, &closed).1,
        }
    };
    let hessian: Vec<DMatrix<f64>> = (0..edges.count()).map(of).collect();
    let gradient = vec![0.0; hessian.iter().map(DMatrix::nrows).sum()];
    Derivatives { stiffness: 1.0, gradient, hessian }
}

impl Derivatives {
    /// The blocks of the Hessian, each with the numbers of its values.
    pub(super) fn blocks(&self) -> impl Iterator<Item = (Range<usize>, &DMatrix<f64>)> {
        blocks(&self.hessian)
    }

    /// The product of the Hessian with nodal values.
    pub(super) fn hessian_times(&self, v: &[f64]) -> Vec<f64> {
        times(&self.hessian, v, |h| h)
    }

    /// The product of the magnitudes of the entries of the Hessian with nodal values.
    fn magnitudes_times(&self, v: &[f64]) -> Vec<f64> {
        times(&self.hessian, v, f64::abs)
    }

    /// A norm that rounding alone may give the residual of (8) where its linear part is `at`, with the rounding of P through the springs.
    pub(super) fn noise(&self, system: &System, at: &Evaluation) -> f64 {
        let forces = self.magnitudes_times(&at.p_magnitudes);
        let mut contact = vec![0.0; at.linear.len()];
        system.each_functional(|row, i, entry| contact[row] += entry.abs() * forces[i]);
        at.noise + f64::EPSILON * norm(&contact)
    }

    /// The derivatives at y of springs with this Hessian that pull as well as push.
    pub(crate) fn pulling(self, y: &[DoubleDouble]) -> Self {
        let heads: Vec<f64> = y.iter().map(|y| y.head()).collect();
        Derivatives { gradient: self.hessian_times(&heads), ..self }
    }
}

/// The change of an entry of Psi'', beside the largest of its piece, up to which a tangent is not factored anew. Near the solution
/// only the edges where contact ends change, by ever less.
const SAME: f64 = 1e-4;

/// The share to which the residual must fall from one step with a tangent to the next, or it is factored anew all the same.
const FALLS: f64 = 0.1;

/// Returns whether a tangent with the `old` Psi'' does for a step where Psi'' is the `new` one: `residuals` are the norms of those
/// where it was used last and here.
pub(super) fn does_again(old: &[DMatrix<f64>], new: &[DMatrix<f64>], residuals: [f64; 2]) -> bool {
    let size = |h: &DMatrix<f64>| h.iter().fold(0.0, |most: f64, h| most.max(h.abs()));
    let is_near = |(old, new): (&DMatrix<f64>, &DMatrix<f64>)| {
        let most = SAME * size(old);
        old.iter().zip(new).all(|(a, b)| (a - b).abs() <= most)
    };
    let [before, now] = residuals;
    old == new || (now <= FALLS * before && old.iter().zip(new).all(is_near))
}

/// The product of blocks along a diagonal, of each entry what `of` it is, with a vector.
pub(super) fn times(diagonal: &[DMatrix<f64>], v: &[f64], of: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut product = Vec::with_capacity(v.len());
    for (values, h) in blocks(diagonal) {
        let v = &v[values];
        let row = |a: usize| v.iter().enumerate().map(|(b, v)| of(h[(a, b)]) * v).sum::<f64>();
        product.extend((0..v.len()).map(row));
    }
    product
}

/// Blocks that follow each other along a diagonal, each with the numbers of its rows.
pub(super) fn blocks(
    diagonal: &[DMatrix<f64>],
) -> impl Iterator<Item = (Range<usize>, &DMatrix<f64>)> {
    let mut end = 0;
    diagonal.iter().map(move |h| {
        let start = end;
        end += h.nrows();
        (start..end, h)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tangent_is_kept_where_springs_hardly_change_and_the_residual_falls() {
        let springs = |factor: f64| vec![DMatrix::identity(2, 2), DMatrix::identity(3, 3) * factor];
        let (old, near, far) = (springs(1.0), springs(1.0 + SAME / 2.0), springs(1.0 + 2.0 * SAME));
        let [falls, stays] = [[1.0, FALLS / 2.0], [1.0, 2.0 * FALLS]];
        assert!(does_again(&old, &near, falls));
        assert!(!does_again(&old, &near, stays), "the residual stays");
        assert!(!does_again(&old, &far, falls), "a piece has changed");
        // The same tangent would be factored again to the same numbers.
        assert!(does_again(&old, &old, stays));
        assert!(
            !does_again(&old, &near, [f64::NAN; 2]) && !does_again(&old, &springs(f64::NAN), falls)
        );
    }

    #[test]
    fn magnitudes_of_products_do_not_cancel() {
        let spring = DMatrix::from_row_slice(2, 2, &[2.0, -2.0, -2.0, 2.0]);
        let at = Derivatives { stiffness: 1.0, gradient: vec![0.0; 2], hessian: vec![spring] };
        assert_eq!(at.hessian_times(&[3.0, 3.0]), [0.0, 0.0]);
        assert_eq!(at.magnitudes_times(&[3.0, 3.0]), [12.0, 12.0]);
    }
}
