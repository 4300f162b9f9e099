//! How far the computed displacement u~ is from the exact solution u^h of (8), whatever Newton's method, the factorisation and
//! rounding did: an enclosure of u^h and of what is reported of it. docs/theory.md, 7.5, has the proofs.
//!
//! The problem (8) that is meant has these data: the vertices, the Lame coefficients as they act in the plane, gamma on each
//! contact edge, the gap at the nodes, the prescribed components, the directions of contact where they are not the normal, the
//! points of a Gauss rule, and for the loads the forces that the quadrature has at its points, weight times value: all of them
//! doubles, taken for the real numbers that they are. Lengths, normals, areas, stresses and integrals are the exact ones.
//!
//! 1. kappa < 1, rounded up: (8) has exactly one solution, and A(v, v) >= (1 - kappa) a(v, v).
//! 2. The residual r of (8) at u~ in [balls](crate::fem::ball), and any z that nearly solves A z = r, as the factor at hand
//!    gives it: |r|_A* <= (z.A z)^{1/2} + |r - A z|_A*, where the last residual is again one in balls, and is turned into a
//!    dual norm by [Korn's inequality](crate::fem::korn) at each node, crudely.
//! 3. (C2): with rho = |r|_A*, |u~ - u^h|_a <= rho (1 - kappa)^{-1/2}, |gamma^{1/2}(lambda~ - lambda^h)| <= rho / 2.

use std::collections::BTreeMap;
use std::sync::Arc;

#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::assembled::{Assembled, Tangent};
use super::factor::{Factor, Indefinite};
use super::pressed::Pressed;
use super::system::System;
use crate::fem::Discretization;
use crate::fem::ball::{Ball, larger, up};
use crate::fem::contact_line::ContactLineEdge;
use crate::fem::held;
use crate::fem::korn::Korn;
use crate::fem::moments::moments;
use crate::fem::precise::{self, EdgeNumbers, OnEdge};
use crate::fem::twofold::Twofold;
use crate::kernel::contact_edge::{coercivity_constant, turning_factor};
use crate::kernel::edge_integral::ExactEdge;

/// An interval `[low, high]`.
pub type Range = [f64; 2];

/// Where u^h is, and what is known of it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Enclosure {
    /// kappa of (11), rounded up.
    pub kappa: f64,
    /// |u~ - u^h|_a at most.
    pub radius: f64,
    /// The same over |u~|_a; `None` for a body without strain.
    pub relative: Option<f64>,
    /// The norm of gamma^{1/2} (lambda~ - lambda^h) on Gamma_C at most.
    pub pressure: f64,
    /// The length of u~ - u^h at each node at most.
    pub nodes: Vec<f64>,
    /// What is reported of u^h.
    pub intervals: Intervals,
}

/// Intervals that contain what the exact solution of (8) has.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct Intervals {
    /// a(u, u)
    pub energy: Range,
    /// The largest length of u at a node.
    pub max_displacement: Range,
    /// What each contact boundary carries.
    pub contact: Vec<ContactIntervals>,
    /// The force of each displacement boundary on the body.
    /// Empty where there are more than 64 displacement boundaries.
    pub reactions: BTreeMap<String, [Range; 2]>,
}

impl Intervals {
    pub(super) fn are_finite(&self) -> bool {
        let contact = self.contact.iter().flat_map(|c| [c.force, c.resultant[0], c.resultant[1]]);
        let all = contact.chain(self.reactions.values().copied().flatten());
        let all = all.chain([self.energy, self.max_displacement]);
        all.flatten().all(f64::is_finite)
    }
}

/// Of a contact boundary.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct ContactIntervals {
    /// Its name.
    pub boundary: String,
    /// -int lambda^h
    pub force: Range,
    /// int lambda^h n~
    pub resultant: [Range; 2],
}

/// Why nothing is proved.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum Unproved {
    #[error(
        "the body is held by contact alone, and the edges that are surely pressed hardly hold it"
    )]
    HeldByContact,
    #[error("kappa = {kappa} is not below 1: (8) may have several solutions, or none")]
    NotCoercive { kappa: f64 },
    #[error(
        "displacement boundaries hardly hold a part of the body, or hinges join more than 32 parts"
    )]
    NotHeld,
    #[error("A has no Cholesky factor in the precision of the solve")]
    NoFactor,
    #[error(
        "kappa is 1 or more when its rounding is counted: it over- or underflows double precision, or is next to 1"
    )]
    NoKappa,
    #[error("the bound over- or underflows double precision")]
    OutOfRange,
    #[error("out of memory")]
    OutOfMemory,
}

impl Unproved {
    /// Whether (8) is known to have exactly one solution all the same.
    pub fn is_unique(&self) -> bool {
        !matches!(self, Unproved::HeldByContact | Unproved::NotCoercive { .. } | Unproved::NoKappa)
    }
}

/// a . b
fn dot(a: [Ball; 2], b: [Ball; 2]) -> Ball {
    a[0] * b[0] + a[1] * b[1]
}

/// The square root of what cannot be negative, rounded up; infinite where nothing is known.
fn root(square: Ball) -> f64 {
    let square = square.upper();
    if square.is_nan() { f64::INFINITY } else { up(square.max(0.0).sqrt()) }
}

/// The residual of a correction that is this small a part of the bound needs no further one.
const SMALL: f64 = 1e-2;

/// Corrections of z, at most.
const CORRECTIONS: usize = 12;

/// Which factor of A nearly solves A z = r. Nothing depends on its being right.
pub enum FactorOfA {
    /// One that is there.
    AtHand(Factor),
    /// One to be made in doubles.
    Double,
    /// One to be made in twofold numbers, for bodies that need them.
    Twofold,
}

impl FactorOfA {
    fn of<E, const N: usize, const M: usize>(
        self,
        system: &System<E, N, M>,
        pressed: &Pressed<M>,
    ) -> Result<Tangent, Unproved>
    where
        E: ExactEdge<f64, N, M>,
    {
        let assembled = match self {
            FactorOfA::AtHand(factor) => return Ok(Tangent::Double(factor)),
            FactorOfA::Double => Assembled::new(system, 1.0),
            FactorOfA::Twofold => Assembled::twofold(system, 1.0),
        };
        match assembled.factor_where(pressed.edges()) {
            Ok(factor) => factor.map_err(|Indefinite| Unproved::NoFactor),
            Err(_) => Err(Unproved::OutOfMemory),
        }
    }
}

/// Encloses the solution of (8) around `u`, with the motions that slide still stopped at one component each, by the residual there, or at a field `near` it that is known in twofold numbers:
/// rounding a displacement to doubles moves it little, its forces more.
///
/// # Errors
/// Why nothing can be proved.
pub fn enclose<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    u: &[[f64; 2]],
    near: Option<&[[Twofold; 2]]>,
    factor: FactorOfA,
) -> Result<Enclosure, Unproved>
where
    E: ExactEdge<f64, N, M>,
{
    enclose_with(system, u, near, factor, &system.d.enclosed_load)
}

/// The same for a given load: L(v) for every basis function.
///
/// # Errors
/// As [`enclose`].
pub fn enclose_with<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    u: &[[f64; 2]],
    near: Option<&[[Twofold; 2]]>,
    factor: FactorOfA,
    load: &[[Ball; 2]],
) -> Result<Enclosure, Unproved>
where
    E: ExactEdge<f64, N, M>,
{
    let d = system.d;
    let lines = lines(d);
    let kappa = kappa(d, &lines);
    if !(kappa < 1.0) {
        let unknown = d.kappa() < 1.0 || !kappa.is_finite();
        return Err(if unknown { Unproved::NoKappa } else { Unproved::NotCoercive { kappa } });
    }
    let coercivity = (1.0 - kappa) * (1.0 - 4.0 * f64::EPSILON);
    let slides = d.slides.as_deref().unwrap_or_default();
    let mut reported = u.to_vec();
    held::least_norm(&mut reported, slides);
    let at = Evaluation::new(system, &lines, (u, &reported), near, load)?;
    // What holds the body, and what is not proved if that does not.
    let (pressed, loose) = match d.slides {
        None => (Pressed::nowhere(lines.len()), Unproved::NotHeld),
        Some(_) => (Pressed::at(d, &lines, &at.u), Unproved::HeldByContact),
    };
    let holds = pressed.holds(d, &lines);
    let korn = Korn::new(&d.space, &d.problem.material, &d.constraints, &holds);
    let korn = korn.ok_or(loose)?;
    let r = free(system, &at.residual);
    let crude = crude_norms(system, &korn, coercivity);
    let rho = if r.iter().all(|&r| r == Ball::from(0)) {
        0.0
    } else {
        let negligible = SMALL * at.moved * coercivity.sqrt();
        dual_norm(system, &lines, &pressed, &factor.of(system, &pressed)?, &r, &crude, negligible)
    };
    if !pressed.stay(rho) {
        return Err(Unproved::HeldByContact);
    }
    let exact = up(rho / coercivity.sqrt());
    let radius = up(exact + at.moved);
    if !radius.is_finite() {
        return Err(Unproved::OutOfRange);
    }
    let size = at.energy.upper().max(0.0).sqrt();
    let nodes: Vec<f64> = korn.nodes.iter().map(|n| up(n * exact)).collect();
    let (exactly, mut nodes) = less_slides(at.u.clone(), nodes, slides);
    for (node, (exactly, reported)) in nodes.iter_mut().zip(exactly.iter().zip(&reported)) {
        let off = [0, 1].map(|c| exactly[c] - Ball::from(reported[c]));
        *node = up(*node + root(dot(off, off)));
    }
    let pressure = if holds.is_empty() { rho / 2.0 } else { rho };
    let intervals = at.intervals(d, &lines, (&exactly, &nodes), [rho, pressure], exact);
    if !intervals.are_finite() {
        return Err(Unproved::OutOfRange);
    }
    Ok(Enclosure {
        kappa,
        radius,
        relative: (size > 0.0).then(|| radius / size),
        pressure,
        nodes,
        intervals,
    })
}

/// u less its part along the motions that slide, as [`held::least_norm`] takes it out, and the bounds at the nodes that this has
/// for a u within the bounds `nodes`.
pub fn less_slides(
    mut u: Vec<[Ball; 2]>,
    mut nodes: Vec<f64>,
    slides: &[Vec<[f64; 2]>],
) -> (Vec<[Ball; 2]>, Vec<f64>) {
    for slide in slides {
        let slide: Vec<[Ball; 2]> = slide.iter().map(|s| s.map(Ball::from)).collect();
        let lengths: Vec<f64> = slide.iter().map(|&s| root(dot(s, s))).collect();
        let along = product(&slide, &u);
        let off = nodes.iter().zip(&lengths).map(|(node, s)| node * s).sum::<f64>();
        let off = off * (1.0 + f64::EPSILON * (nodes.len() + 16) as f64);
        for ((u, node), (s, length)) in u.iter_mut().zip(&mut nodes).zip(slide.iter().zip(lengths))
        {
            *u = [0, 1].map(|c| u[c] - along * s[c]);
            *node = up(*node + off * length);
        }
    }
    (u, nodes)
}

/// The contact edges in balls.
pub type Lines<'d, const N: usize, const M: usize> = Vec<OnEdge<'d, Ball, N, M>>;

/// Those of a discretization.
pub fn lines<'d, E, const N: usize, const M: usize>(
    d: &'d Discretization<E, N, M>,
) -> Lines<'d, N, M>
where
    E: ExactEdge<f64, N, M>,
{
    d.contact.iter().map(|edge| OnEdge::new(d, edge, numbers(d, edge))).collect()
}

/// Length and normal of a contact edge as its vertices have them, and its gamma.
fn numbers<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    edge: &ContactLineEdge<N, M>,
) -> EdgeNumbers<Ball>
where
    E: ExactEdge<f64, N, M>,
{
    let triangle = precise::exactly::<Ball>(d.space.mesh().triangle(edge.edge.triangle));
    let normal: [Ball; 2] = triangle.scaled_normal(edge.edge.local).into();
    let length = dot(normal, normal).sqrt();
    let normal = normal.map(|c| c / length).into();
    EdgeNumbers { normal, gamma: Ball::from(edge.gamma), length }
}

/// kappa of Theorem 2.3, rounded up. The directions of contact are doubles, unit vectors to a rounding error only.
fn kappa<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    lines: &[OnEdge<Ball, N, M>],
) -> f64
where
    E: ExactEdge<f64, N, M>,
{
    let mut lengths: BTreeMap<usize, (Ball, Ball)> = BTreeMap::new();
    for (edge, line) in d.contact.iter().zip(lines) {
        let factor = if edge.directions == [edge.normal; M] {
            Ball::from(1)
        } else {
            let along: [[Ball; 2]; M] = edge.directions.map(|n| n.map(Ball::from).into());
            let off = along.map(|n| (dot(n, n) - Ball::from(1)).magnitude());
            let off = Ball::from(8.0 * off.into_iter().fold(0.0, larger));
            let turning = turning_factor::<E, Ball, N, M>(dot(along[0], along[1]));
            turning * (Ball::from(1) + off) + off
        };
        let entry =
            lengths.entry(edge.edge.triangle).or_insert((Ball::from(0), line.numbers.gamma));
        entry.0 += factor * line.numbers.length;
    }
    let of = |(&t, &(length, gamma)): (&usize, &(Ball, Ball))| {
        let area = precise::exactly::<Ball>(d.space.mesh().triangle(t)).double_area();
        let material = d.problem.material.of(t).map(Ball::from);
        let area = area / Ball::from(2);
        coercivity_constant::<E, Ball, N, M>(&material, gamma, length, area).upper()
    };
    lengths.iter().map(of).fold(0.0, larger)
}

/// The components of a functional at the free unknowns, in the frames of their nodes.
pub(super) fn free<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    forces: &[[Ball; 2]],
) -> Vec<Ball>
where
    E: ExactEdge<f64, N, M>,
{
    let frames = system.d.constraints.frames();
    let mut all = vec![Ball::from(0); system.numbering.count];
    for (node, numbers) in system.numbering.of.iter().enumerate() {
        let force = match frames.get(&node) {
            Some(&axis) => axes(axis).map(|axis| dot(axis, forces[node])),
            None => forces[node],
        };
        for (number, force) in numbers.iter().zip(force) {
            if let Some(number) = *number {
                all[number] = force;
            }
        }
    }
    all
}

/// A direction and the one across, to the left.
fn axes(axis: [f64; 2]) -> [[Ball; 2]; 2] {
    [[axis[0], axis[1]], [-axis[1], axis[0]]].map(|axis| axis.map(Ball::from))
}

/// The field with these components, `known` at the free ones and the prescribed ones as `prescribed` has them.
fn field<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    known: impl Fn(usize, usize, usize) -> Ball,
    prescribed: impl Fn(usize, usize) -> f64,
) -> Vec<[Ball; 2]>
where
    E: ExactEdge<f64, N, M>,
{
    let frames = system.d.constraints.frames();
    let at = |(node, numbers): (usize, &[Option<usize>; 2])| {
        let parts = [0, 1].map(|c| match numbers[c] {
            Some(number) => known(number, node, c),
            None => Ball::from(prescribed(node, c)),
        });
        match frames.get(&node) {
            None => parts,
            Some(&axis) => {
                let [along, across] = axes(axis);
                [0, 1].map(|c| parts[0] * along[c] + parts[1] * across[c])
            }
        }
    };
    system.numbering.of.iter().enumerate().map(at).collect()
}

/// A(v, .), and what the springs where it is `pressed` do, at the free unknowns for the field with the components `z`.
pub(super) fn times_matrix<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    lines: &Lines<N, M>,
    pressed: &Pressed<M>,
    z: &[Ball],
) -> Vec<Ball>
where
    E: ExactEdge<f64, N, M>,
{
    let v = field(system, |number, _, _| z[number], |_, _| 0.0);
    let mut forces = vec![[Ball::from(0); 2]; v.len()];
    precise::add_internal_forces(system.d, &v, &mut forces);
    for line in lines {
        line.add_stresses(&v, &mut forces);
    }
    pressed.add_springs(lines, &v, &mut forces);
    free(system, &forces)
}

/// |t|_A* <= sum of these times |t_i|: k_i (1 - kappa)^{-1/2} with the factor k_i of the node of unknown i.
fn crude_norms<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    korn: &Korn,
    coercivity: f64,
) -> Vec<f64>
where
    E: ExactEdge<f64, N, M>,
{
    let mut crude = vec![0.0; system.numbering.count];
    for (numbers, factor) in system.numbering.of.iter().zip(&korn.nodes) {
        for number in numbers.iter().flatten() {
            crude[*number] = up(factor / coercivity.sqrt());
        }
    }
    crude
}

/// |r|_A* at most, where |t|_A* <= sum of `crude`_i |t_i| for every t. What is `negligible` need not be known better.
fn dual_norm<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    lines: &Lines<N, M>,
    pressed: &Pressed<M>,
    factor: &Tangent,
    r: &[Ball],
    crude: &[f64],
    negligible: f64,
) -> f64
where
    E: ExactEdge<f64, N, M>,
{
    let mut z = vec![Ball::from(0); r.len()];
    let mut left = r.to_vec();
    let mut best = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let mut correction: Vec<f64> = left.iter().map(|t| t.head()).collect();
        factor.solve(&mut correction);
        for (z, c) in z.iter_mut().zip(&correction) {
            *z = (*z + Ball::from(*c)).centre();
        }
        let az = times_matrix(system, lines, pressed, &z);
        let square = z.iter().zip(&az).fold(Ball::from(0), |sum, (&z, &az)| sum + z * az);
        let energy = root(square);
        left = r.iter().zip(&az).map(|(&r, &az)| r - az).collect();
        let rest = weighted(&left, crude);
        let bound = up(energy + rest);
        if !(rest > (SMALL * energy).max(negligible)) {
            return bound.min(best);
        }
        let stuck = !(bound < best / 2.0);
        best = bound.min(best);
        if stuck {
            break;
        }
    }
    best
}

/// The sum of the magnitudes, each times its weight, at most.
fn weighted(v: &[Ball], weights: &[f64]) -> f64 {
    let sum: f64 = v.iter().zip(weights).map(|(v, weight)| v.magnitude() * weight).sum();
    // As many roundings as terms; a product may underflow.
    let underflown = f64::MIN_POSITIVE * v.len() as f64;
    sum * (1.0 + f64::EPSILON * (v.len() + 16) as f64) + underflown
}

/// (8) at u~, or near it.
struct Evaluation {
    /// The residual at every basis function.
    residual: Vec<[Ball; 2]>,
    /// u~, or the field near it, with its prescribed components where they should be.
    u: Vec<[Ball; 2]>,
    /// The energy norm of what that is off the displacement that is reported, at most.
    moved: f64,
    /// a(u~, u~)
    energy: Ball,
    /// int \[P\]+ N_a / gamma on each contact edge.
    pressures: Vec<Vec<Ball>>,
}

impl Evaluation {
    fn new<E, const N: usize, const M: usize>(
        system: &System<E, N, M>,
        lines: &[OnEdge<Ball, N, M>],
        (u, reported): (&[[f64; 2]], &[[f64; 2]]),
        near: Option<&[[Twofold; 2]]>,
        load: &[[Ball; 2]],
    ) -> Result<Self, Unproved>
    where
        E: ExactEdge<f64, N, M>,
    {
        let d = system.d;
        let frames = d.constraints.frames();
        let at = |node: usize| match near {
            Some(near) => near[node].map(Ball::from),
            None => u[node].map(Ball::from),
        };
        let component = |_, node: usize, c: usize| match frames.get(&node) {
            Some(&axis) => crate::fem::constraints::in_frame(axis, at(node))[c].centre(),
            None => at(node)[c],
        };
        let prescribed =
            |node: usize, c: usize| d.constraints.values()[node][c].unwrap_or_default();
        let exact = field(system, component, prescribed);
        let off: Vec<[Ball; 2]> = exact
            .iter()
            .zip(reported)
            .map(|(exact, u)| [0, 1].map(|c| exact[c] - Ball::from(u[c])))
            .collect();
        let moved = root(strain_energy(d, &off));

        let mut residual = vec![[Ball::from(0); 2]; u.len()];
        precise::add_internal_forces(d, &exact, &mut residual);
        let energy = product(&exact, &residual);
        let mut pressures = Vec::with_capacity(lines.len());
        for (edge, line) in d.contact.iter().zip(lines) {
            line.add_stresses(&exact, &mut residual);
            let weight = line.numbers.length / line.numbers.gamma;
            let moments = moments::<E, N, M>(&d.rule, line.p(edge, &exact));
            let pressure = moments.map(|moment| weight * moment);
            line.add_contact(&pressure, &mut residual);
            pressures.push(pressure.to_vec());
        }
        for (r, &l) in residual.iter_mut().zip(load) {
            *r = [r[0] - l[0], r[1] - l[1]];
        }
        let all = residual.iter().chain(&exact).flatten();
        let squares = exact.iter().map(|&u| dot(u, u)).chain([energy]);
        if !(all.into_iter().all(|b| b.is_finite()) && squares.into_iter().all(Ball::is_finite)) {
            return Err(Unproved::OutOfRange);
        }
        Ok(Evaluation { residual, u: exact, moved, energy, pressures })
    }

    /// What is reported, with |u~ - u^h|_A <= `rho`, |u~ - u^h|_a <= `radius`, the norm of gamma^{1/2} (lambda~ - lambda^h) at most
    /// `pressure`, and displacements at the nodes with their bounds.
    fn intervals<E, const N: usize, const M: usize>(
        &self,
        d: &Discretization<E, N, M>,
        lines: &[OnEdge<Ball, N, M>],
        (u, nodes): (&[[Ball; 2]], &[f64]),
        [rho, pressure]: [f64; 2],
        radius: f64,
    ) -> Intervals
    where
        E: ExactEdge<f64, N, M>,
    {
        // |u^h|_a is within the radius of |u~|_a.
        let low = self.energy.lower().max(0.0).sqrt() * (1.0 - 2.0 * f64::EPSILON);
        let low = ((low - radius) * (1.0 - 2.0 * f64::EPSILON)).max(0.0);
        let high = up(root(self.energy) + radius);
        let energy = [low * low * (1.0 - 2.0 * f64::EPSILON), up(high * high)];

        let lengths = u.iter().map(|&u| dot(u, u));
        let mut max_displacement = [0.0_f64; 2];
        for (square, by) in lengths.zip(nodes) {
            let low = square.lower().max(0.0).sqrt() * (1.0 - 2.0 * f64::EPSILON);
            let high = root(square);
            let low = (low - by) * (1.0 - 2.0 * f64::EPSILON);
            max_displacement =
                [max_displacement[0].max(low), max_displacement[1].max(up(high + by))];
        }

        let mut contact: Vec<(Arc<str>, [Ball; 3], Ball)> = Vec::new();
        for ((edge, line), pressure) in d.contact.iter().zip(lines).zip(&self.pressures) {
            let along: [[Ball; 2]; M] = if edge.directions == [edge.normal; M] {
                [line.numbers.normal.into(); M]
            } else {
                edge.directions.map(|n| n.map(Ball::from).into())
            };
            let zero = Ball::from(0);
            let of: [Ball; 3] = pressure
                .iter()
                .zip(along)
                .fold([zero; 3], |sum, (&p, n)| [sum[0] + p, sum[1] - p * n[0], sum[2] - p * n[1]]);
            let weight = line.numbers.length / line.numbers.gamma;
            match contact.iter_mut().find(|(name, ..)| *name == edge.boundary) {
                Some((_, sum, weights)) => {
                    *sum = [0, 1, 2].map(|i| sum[i] + of[i]);
                    *weights += weight;
                }
                None => contact.push((Arc::clone(&edge.boundary), of, weight)),
            }
        }
        let contact = contact
            .into_iter()
            .map(|(boundary, sums, weight)| {
                // |int mu n~_c| <= (int 1/gamma)^{1/2} |gamma^{1/2} mu|
                let off = up(root(weight) * pressure);
                let [force, x, y] = sums.map(|sum| range(sum.widened(off)));
                // lambda^h <= 0
                let force = [force[0].max(0.0), force[1]];
                ContactIntervals { boundary: boundary.to_string(), force, resultant: [x, y] }
            })
            .collect();
        let reactions = self.reactions(d, lines, [rho, pressure]);
        Intervals { energy, max_displacement, contact, reactions }
    }

    /// The residual at the held directions, and how far that of u^h can be from it.
    fn reactions<E, const N: usize, const M: usize>(
        &self,
        d: &Discretization<E, N, M>,
        lines: &[OnEdge<Ball, N, M>],
        [rho, pressure]: [f64; 2],
    ) -> BTreeMap<String, [Range; 2]>
    where
        E: ExactEdge<f64, N, M>,
    {
        let of = |(boundary, held): (&String, &Vec<crate::fem::constraints::Held>)| {
            let ranges = [0, 1].map(|c| {
                // The reaction is the residual at this field.
                let mut test = vec![[Ball::from(0); 2]; self.u.len()];
                for held in held {
                    let direction = Ball::from(held.direction[c]);
                    for k in 0..2 {
                        let dual = Ball::from(held.dual[k]);
                        test[held.node][k] += direction * dual;
                    }
                }
                let reaction = product(&test, &self.residual);
                let by_body = root(strain_energy(d, &test));
                let by_contact = lines.iter().fold(Ball::from(0), |sum, line| {
                    let most = line.p0(&test).iter().fold(0.0, |sum, p| up(sum + p.magnitude()));
                    let weight = line.numbers.length / line.numbers.gamma;
                    sum + weight * Ball::from(most) * Ball::from(most)
                });
                let by_contact = root(by_contact);
                range(reaction.widened(up(rho * by_body + pressure * by_contact)))
            });
            (boundary.clone(), ranges)
        };
        let holders = d.constraints.holders();
        if holders.len() > MOST_REACTIONS {
            return BTreeMap::new();
        }
        holders.iter().map(of).collect()
    }
}

/// Each reaction takes a pass over the body: with more displacement boundaries than these none is enclosed.
const MOST_REACTIONS: usize = 64;

fn range(ball: Ball) -> Range {
    [ball.lower(), ball.upper()]
}

/// The sum of the products of two fields or functionals.
fn product(f: &[[Ball; 2]], u: &[[Ball; 2]]) -> Ball {
    f.iter().zip(u).fold(Ball::from(0), |sum, (&f, &u)| sum + dot(f, u))
}

/// a(v, v)
fn strain_energy<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    v: &[[Ball; 2]],
) -> Ball
where
    E: ExactEdge<f64, N, M>,
{
    if v.iter().flatten().all(|&v| v == Ball::from(0)) {
        return Ball::from(0);
    }
    let mut forces = vec![[Ball::from(0); 2]; v.len()];
    precise::add_internal_forces(d, v, &mut forces);
    product(v, &forces)
}

/// An enclosure, or why there is none.
pub type Certificate = Result<Enclosure, Unproved>;
