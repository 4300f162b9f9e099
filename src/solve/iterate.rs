//! An iterate: a displacement with P and the residual of (8), evaluated in doubles as long as these suffice, else in
//! [double-doubles](crate::kernel::double_double). The displacement itself has more digits than a double: rounding that of a
//! slender body changes its forces by more than its loads. In doubles, too, stresses come from differences from node to node,
//! which keep the digits that rounding would lose. The final displacement is rounded; its forces are those before rounding
//! where rounding would blur them.

use nalgebra::Vector2;

use crate::contact::discretization::{Discretization, Functional};
use crate::contact::stress_points::Nodal;
use crate::contact::{EdgeRule, residual};
use crate::held::solvability::{Play, Slides};
use crate::kernel::DoubleDouble;
use crate::linear::dense::norm;
use crate::linear::system::System;

/// The residual, in units of roundoff times its magnitudes, at which Newton's method ends. With 0 one body in five goes on to
/// the last allowed step; 4000 does as well, but the passes have more to correct.
pub(super) const NOISE: f64 = 4.0;

/// The size of P, in roundings of its terms (some four digits), below which P is evaluated in double-doubles.
const FEW_DIGITS: f64 = 1e4;

/// Returns whether P presses with a value that is small beside the magnitudes it was added up from.
pub(super) fn has_few_digits((p, size): (&DoubleDouble, &f64)) -> bool {
    p.head() > 0.0 && p.head() < FEW_DIGITS * f64::EPSILON * size
}

/// The rounding in doubles that all nodes may have together at which forces are not evaluated in double-doubles, in roundings of all
/// forces: on squares of quadratic elements they have as many.
const FEW_ROUNDINGS: f64 = 1e4;

/// Tells at which nodes forces are added up from magnitudes so large that their rounding is too much. A triangle with such a node is
/// evaluated in double-doubles as a whole: what its stress is rounded by then adds up to nothing over its nodes.
fn blurred(forces: &[[f64; 2]], magnitudes: &[[f64; 2]]) -> Vec<bool> {
    let forces = forces.as_flattened();
    let most = FEW_ROUNDINGS * norm(forces) / (forces.len() as f64).sqrt();
    magnitudes.iter().map(|m| !m.iter().all(|m| *m <= most)).collect()
}

/// A displacement.
pub struct Iterate {
    pub(super) u: Vec<[DoubleDouble; 2]>,
}

/// The linear part of (8) at a displacement.
pub struct Evaluation {
    /// A(u, v) - L(v) for every basis function v.
    pub forces: Vec<[f64; 2]>,
    /// Its values for every free degree of freedom.
    pub(crate) linear: Vec<f64>,
    /// P(u) at the nodes of the contact edges; negative on those that press in no solution.
    pub(crate) p: Vec<DoubleDouble>,
    /// The magnitudes that these were added up from.
    pub(crate) p_magnitudes: Vec<f64>,
    /// a(u, u)
    pub(crate) energy: f64,
    /// A norm that rounding alone may give the residual.
    pub(crate) noise: f64,
    /// In double-doubles.
    pub precisely: bool,
}

/// A displacement in double-doubles.
struct Parts<'a> {
    heads: &'a [[f64; 2]],
    tails: &'a [[f64; 2]],
}

impl Nodal<f64> for Parts<'_> {
    #[inline]
    fn difference(&self, node: usize, from: usize) -> Vector2<f64> {
        self.heads.difference(node, from) + self.tails.difference(node, from)
    }

    fn radial(&self, node: usize) -> f64 {
        self.heads.radial(node)
    }

    fn is_zero(&self) -> bool {
        self.heads.is_zero() && self.tails.is_zero()
    }
}

impl Iterate {
    /// The lift of the prescribed data.
    pub fn lift(d: &Discretization) -> Self {
        Iterate { u: d.constraints.lift().into_iter().map(|u| u.map(DoubleDouble::from)).collect() }
    }

    /// In doubles.
    pub fn rounded(&self) -> Vec<[f64; 2]> {
        self.u.iter().map(|u| u.map(DoubleDouble::head)).collect()
    }

    /// The part that rounding to doubles leaves out.
    pub(crate) fn remainder(&self) -> Vec<[f64; 2]> {
        self.u.iter().map(|u| u.map(DoubleDouble::tail)).collect()
    }

    /// Adds `t` times a step over the free degrees of freedom.
    pub fn add(&mut self, system: &System, t: f64, step: &[f64]) {
        let mut field = vec![[0.0; 2]; self.u.len()];
        system.numbering.scatter(step, &mut field);
        for (u, step) in self.u.iter_mut().flatten().zip(field.as_flattened()) {
            *u += DoubleDouble::from(t * step);
        }
    }

    /// The linear part of (8) here, in double-doubles if `precisely`.
    pub fn evaluate(&self, system: &System, precisely: bool) -> Evaluation {
        let d = system.d;
        // Pieces that press in no solution: the body is moved away from them in the end.
        let idle = |mut p: Vec<DoubleDouble>| {
            for (_, piece) in d.contact.iter().enumerate().filter(|(e, _)| d.is_idle(*e)) {
                for p in &mut p[piece.functionals()] {
                    *p = if p.head() > 0.0 { -*p } else { *p };
                }
            }
            p
        };
        let (heads, tails) = (self.rounded(), self.remainder());
        let u = Parts { heads: &heads, tails: &tails };
        let Functional { values: forces, magnitudes, energy } = d.linear_residual_by(&u);
        if precisely {
            let is_blurred = blurred(&forces, &magnitudes);
            let taken = |nodes: &[usize]| nodes.iter().any(|&node| is_blurred[node]);
            let others = d.internal_forces_of(|nodes| !taken(nodes), &u);
            let (forces, p) = residual::evaluate(d, &self.u, (taken, &others.values));
            let p = idle(p);
            // The forces of contact are added to these in doubles, and the loads are doubles.
            let rounded = d.free_norm(&forces).max(d.free_norm(&d.load));
            let noise = NOISE * f64::EPSILON * (rounded + d.free_norm(&others.magnitudes));
            let p_magnitudes = p.iter().map(|p| p.head().abs()).collect();
            let linear = system.numbering.gather(&forces);
            return Evaluation { forces, linear, p, p_magnitudes, energy, noise, precisely };
        }
        let mut p = Vec::with_capacity(system.functionals());
        let mut p_magnitudes = Vec::with_capacity(system.functionals());
        for piece in &d.contact {
            let with_tails = piece.each_p(&heads).zip(piece.each_p0(&tails));
            p.extend(with_tails.map(|(p, of_tail)| DoubleDouble::from(p + of_tail)));
            p_magnitudes.extend(piece.p0_magnitudes(&heads));
        }
        // gamma times the pressure is small beside displacement and gap, and has few digits in doubles.
        let is_fine =
            matches!(d.rule, EdgeRule::Gauss(_)) || p.iter().zip(&p_magnitudes).any(has_few_digits);
        if is_fine {
            p = system.fine_p(&self.u);
            p_magnitudes = p.iter().map(|p| p.tail().abs()).collect();
        }
        let p = idle(p);
        let noise = NOISE * f64::EPSILON * d.free_norm(&magnitudes);
        let linear = system.numbering.gather(&forces);
        Evaluation { forces, linear, p, p_magnitudes, energy, noise, precisely }
    }
}

/// The displacement that a solve ends with, P on Gamma_C, and the residual of (8) at all degrees of freedom; at the prescribed
/// ones the residual is the reaction.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Evaluated {
    /// Nodal values.
    pub u: Vec<[f64; 2]>,
    /// P(u) at the nodes of each contact edge.
    pub(crate) p: Vec<Vec<DoubleDouble>>,
    /// R(u; v) for every basis function v.
    pub(crate) residual: Vec<[f64; 2]>,
}

impl Evaluated {
    /// Evaluates a displacement in doubles.
    pub fn new(d: &Discretization, u: Vec<[f64; 2]>) -> Self {
        let p = d.contact.iter().flat_map(|edge| edge.p(&u));
        let p: Vec<DoubleDouble> = p.map(DoubleDouble::from).collect();
        let forces = d.linear_residual(&u).values;
        Evaluated::with(d, u, forces, &p)
    }

    /// Evaluates a displacement whose `forces`, A(u, v) - L(v) for every basis function v, and whose P at the nodes of the
    /// contact edges are known.
    pub(crate) fn with(
        d: &Discretization,
        u: Vec<[f64; 2]>,
        forces: Vec<[f64; 2]>,
        p: &[DoubleDouble],
    ) -> Self {
        let p: Vec<Vec<DoubleDouble>> =
            d.contact.iter().map(|piece| p[piece.functionals()].to_vec()).collect();
        let mut residual = forces;
        for (piece, p) in d.contact.iter().zip(&p) {
            piece.add_contact(&piece.contribution(&d.rule, p).force, &mut residual);
        }
        Evaluated { u, p, residual }
    }

    /// Goes to the solution of least norm, where contact holds the body and there are several: neither the forces nor P where it
    /// presses change by it. Gives how far the body may move from there.
    pub(crate) fn settle(&mut self, d: &Discretization) -> Vec<Play> {
        let p: Vec<DoubleDouble> = self.p.iter().flatten().copied().collect();
        let Some(slides) = Slides::around(d, &self.u, Some(&p)) else { return Vec::new() };
        if slides.basis.is_empty() {
            return Vec::new();
        }
        slides.least_norm(&mut self.u);
        for (edge, p) in d.contact.iter().zip(&mut self.p) {
            if edge.contribution(&d.rule, p).active == 0.0 {
                let open = edge.along(&edge.p(&self.u)).to_vec();
                p.iter_mut().zip(open).for_each(|(p, open)| *p = open.min(0.0).into());
            }
        }
        slides.plays(&self.u)
    }
}
