//! Evaluates the proof of an error bound: the checker. It trusts no solver and no linear algebra; it reads
//! numbers, and computes with [`Enclosing`] ones, so that rounding is part of the answer.
//!
//! **Theorem** (docs/a-posteriori.md, section 7.3). Let u be the solution of (1)-(2). If v = u_D on Gamma_D and v_n <= g on Gamma_C,
//! and if div tau + f = 0, tau n = t on Gamma_N, tau_t = 0 and tau_n <= 0 on Gamma_C, then
//!
//! |u - v|_a^2 + |sigma(u) - tau|^2_{C^-1} <= |C eps(v) - tau|^2_{C^-1} + 2 int tau_n (v_n - g).
//!
//! A [`Certificate`] holds v by its values at vertices, and tau by its tractions on edges: an edge has one traction, so
//! that tau n is continuous, and on Gamma_C it is a nonpositive multiple of n. What is left is that each triangle is in
//! equilibrium, and there the doubles of a file can't be exact. `audit::balance` therefore adds to the tractions those
//! small ones that make equilibrium exact; they are known as balls, and so is then tau.
//!
//! Gamma_D may hold a direction d alone: v . d is prescribed, and tau n = p d + q e with a given q, e across d (section 7.2).
//!
//! Contact may also act along a direction d, affine on each edge, in place of n: v . d <= g, and tau n = p d with p <= 0. The
//! theorem holds as it stands, for the solution u of the problem with that d (section 7.2).
//!
//! Between two bodies v . d is that of the jump, v on an edge less v on the edge that faces this one, and tau N is there minus that on
//! this edge: one pressure for both (section 12.6).
//!
//! v is affine on the triangles of the mesh, or quadratic on those of the certificate ([`Curved`]): then it has a vector for each
//! edge, too, the *bulge* by which it is beyond the mean of the edge's ends in the middle. C eps(v) is affine, and v_n - g
//! is known not to be positive where its Bernstein coefficients are not.

pub use super::balance::Unbalanced;
pub use super::certificate::{
    Certificate, Curved, Cut, Edge, Law, Lift, Piece, Reservations, Role,
};
pub use super::checks::{Prescribed, Rejection};

use nalgebra::Vector2;

use super::balance::Equilibrium;
use super::balanced::Balanced;
use super::certificate::{Shape, exactly, place};
use super::checks::length;
use super::forces::Evidence;
use crate::kernel::composite::{Composite, Wrench};
use crate::kernel::{Ball, Enclosing};

/// The bound that a certificate proves.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Upper bounds of the share of each triangle in the square of the bound, the contact term of its edges included.
    pub shares: Vec<f64>,
    /// An upper bound of |u - v|_a where there are no lifts; [`Certificate::with_lifts`] adds them.
    pub bound: f64,
    /// A lower bound of |v|_a.
    pub norm: f64,
    /// J(v) from below and from above.
    pub energy: [f64; 2],
    /// The most that a support takes against a motion which neither supports nor contact stop, in units of the forces on the
    /// boundary; 0 where there is none, else a rounding error.
    pub stop: f64,
}

/// The bound that a certificate is said to prove.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The shares of the triangles, as in [`Proof`].
    pub shares: Vec<f64>,
    /// |u - v|_a is at most this, with the lifts.
    pub bound: f64,
    /// Forces of the true solution, each between two numbers, with what proves them.
    pub forces: Evidence,
}

/// A triangle may be out of balance by this, in units of the forces on it: the tractions and the sums of a dozen terms,
/// rounded.
const IMBALANCE: f64 = 128.0 * f64::EPSILON;

impl Certificate {
    /// The difference between the problem that `proof` bounds and the one that is meant, if there is one: its body, and supports
    /// that it has more.
    pub fn problem(&self, proof: &Proof) -> Option<String> {
        let body =
            (!self.polygon.is_empty()).then(|| "the polygon of the mesh as its body".to_owned());
        let support = (proof.stop > 0.0).then(|| {
            format!(
                "a support against a motion that nothing else stops, which takes {:.0e} of the forces on the boundary or less",
                proof.stop
            )
        });
        let differences: Vec<String> = body.into_iter().chain(support).collect();
        (!differences.is_empty()).then(|| differences.join(" and "))
    }

    /// Verifies every condition of the theorem and evaluates its right side.
    ///
    /// # Errors
    /// The first condition that does not hold, or can't be decided in `S`.
    pub fn evaluate<S: Enclosing>(&self) -> Result<Proof, Rejection> {
        let state = self.balanced::<S>(self.topology()?)?;
        self.sum(&state)
    }

    /// [`Certificate::evaluate`] in [balls](Ball), compiled with the checker.
    ///
    /// # Errors
    /// As [`Certificate::evaluate`].
    pub fn prove(&self) -> Result<Proof, Rejection> {
        self.evaluate::<Ball>()
    }

    /// [`Certificate::evaluate`] in [balls](Ball), and more than a proof needs: that the certificate is as it was
    /// made. Its tractions balance on every triangle to the rounding of doubles, its shares are the very numbers that
    /// its data give, the bound is no smaller, and forces lie between what they are said to.
    ///
    /// # Errors
    /// As [`Certificate::evaluate`]; a triangle that is out of balance; a claim that does not follow.
    pub fn audit(&self, claim: &Claim) -> Result<Proof, Rejection> {
        let state = self.balanced::<Ball>(self.topology()?)?;
        let double_area = |t: usize| state.triangles[t].double_area();
        self.check_balance(&state.forces, double_area, &state.balance)?;
        let proof = self.sum(&state)?;
        length("claimed shares", claim.shares.len(), proof.shares.len())?;
        let same = |a: f64, b: f64| a.to_bits() == b.to_bits();
        for (triangle, (&claimed, &found)) in claim.shares.iter().zip(&proof.shares).enumerate() {
            if !same(claimed, found) {
                return Err(Rejection::Share { triangle, claimed, found });
            }
        }
        let bound = self.with_lifts(proof.bound);
        if !bound.is_at_most(claim.bound) {
            return Err(Rejection::Bound { claimed: claim.bound, found: bound });
        }
        self.check_forces(&state, &proof, &claim.forces)?;
        Ok(proof)
    }

    /// The tractions balance on every triangle to the rounding of doubles, before what equilibrium takes: the forces on the edges.
    pub(crate) fn check_balance<S: Enclosing>(
        &self,
        forces: &[[Vector2<S>; 2]],
        double_area: impl Fn(usize) -> S,
        balance: &Equilibrium<S>,
    ) -> Result<(), Rejection> {
        // The sum of the forces' sizes, and the largest component of the edge.
        let on_edge = |(edge, forces): (&Edge, &[Vector2<S>; 2])| {
            let [start, end] = edge.ends.map(|p| place(self, p));
            let forces: f64 = forces.iter().flatten().map(|force| force.size()).sum();
            (forces, (end - start).amax())
        };
        let edges: Vec<(f64, f64)> = self.edges.iter().zip(forces).map(on_edge).collect();
        for (t, piece) in self.pieces.iter().enumerate() {
            let of_edges = piece.edges.map(|e| edges[e]);
            let forces: f64 = of_edges.iter().map(|(forces, _)| forces).sum();
            let reach = of_edges.iter().map(|&(_, reach)| reach).fold(0.0, f64::max);
            let body: f64 = piece.body.iter().flatten().map(|f| f.abs()).sum();
            let loads = if body == 0.0 { 0.0 } else { body * double_area(t).size() };
            let allowed = IMBALANCE * (forces + loads);
            let Wrench { force, moment, .. } = &balance.resultants[t];
            // Places of cuts are not doubles: what their balls leave open may be balance.
            let near = |x: &S, most: f64| x.lower() <= most && x.upper() >= -most;
            // What a support against a free motion takes is not on the edges.
            let is_stopped = balance.stops.iter().any(|stop| stop.root == t);
            let balances = force.iter().all(|f| near(f, allowed)) && near(moment, allowed * reach);
            if !(is_stopped || balances) {
                return Err(Rejection::OutOfBalance { triangle: t });
            }
        }
        Ok(())
    }

    /// The share of triangle `t` in the right side, C eps(v) being that far from tau.
    pub fn share<S: Enclosing>(&self, state: &Balanced<S>, t: usize, apart: &Composite<S>) -> S {
        let piece = &self.pieces[t];
        let distance = apart.energy(&piece.material(), state.triangles[t].double_area());
        let distance = if piece.oscillation == 0.0 {
            distance
        } else {
            // A sum of squares is not negative, whatever an interval around it says.
            let distance = distance.split(|_| S::from(0), |d| d);
            let root = distance.sqrt() + S::exactly(piece.oscillation);
            root * root
        };
        distance + state.on_contact[t]
    }

    /// The work of the tractions that are given on a displacement; `forces` are tau N on the edges.
    pub(crate) fn work_of_tractions<S: Enclosing>(
        &self,
        forces: &[[Vector2<S>; 2]],
        v: &Shape<S>,
    ) -> S {
        let mut work = S::from(0);
        for (e, edge) in self.edges.iter().enumerate() {
            let given = match edge.role {
                Role::Loaded(_) | Role::Pressed(_) => forces[e],
                // What is given is across the direction that is held.
                Role::Supported { along, force, traction } if traction != [0.0; 2] => {
                    let d = exactly::<S>(along);
                    [0, 1].map(|k| forces[e][k] - d * S::exactly(force[k]))
                }
                _ => continue,
            };
            work += v.work_of(given, edge.ends, e);
        }
        work
    }

    /// The right side of the theorem.
    pub fn sum<S: Enclosing>(&self, state: &Balanced<S>) -> Result<Proof, Rejection> {
        let Balanced { triangles, v, forces, .. } = state;
        let zero = S::from(0);
        let (mut square, mut norm, mut energy) = (zero, zero, zero);
        let mut shares = Vec::with_capacity(self.pieces.len());
        for (t, piece) in self.pieces.iter().enumerate() {
            let material = piece.material();
            let double_area = triangles[t].double_area();
            let (sigma, distance) = state.stresses(self, t);
            let share = self.share(state, t, &distance);
            shares.push(share.upper());
            square += share;
            let internal = sigma.energy(&material, double_area);
            norm += internal;
            let work = v.work(piece);
            energy = energy + internal / S::from(2) - work * double_area / S::from(24);
        }
        energy -= self.work_of_tractions(forces, v);
        let bound = square.split(|_| zero, |s| s).sqrt().upper();
        let norm = norm.split(|_| zero, |n| n).sqrt().lower();
        let energy = [energy.lower(), energy.upper()];
        let stop = state.balance.stops.iter().map(|stop| stop.share).fold(0.0, f64::max);
        let proof = Proof { shares, bound, norm, energy, stop };
        if proof.bound.is_finite() && norm.is_finite() && proof.energy.iter().all(|e| e.is_finite())
        {
            Ok(proof)
        } else {
            Err(Rejection::NotFinite)
        }
    }
}
