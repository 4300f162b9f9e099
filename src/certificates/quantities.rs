//! Proved quantities of contact: forces, moments and reactions between two numbers, where contact can act, and how
//! high the pressure is at least.
//!
//! From docs/a-posteriori.md, section 7.7. For admissible v and tau let m = (C eps(v) + tau) / 2 and
//!
//! M^2 = |C eps(v) - tau|^2 / 4 + int tau_n (v_n - g),   A = int sigma_n (v_n - g) >= 0,   B = int tau_n (u_n - g) >= 0.
//!
//! Then |sigma(u) - m|^2 + A + B = M^2 \[Q2\]: the mean stress has about half the bound of theorem 7.2. With a bound s of friction
//! A and B have the integrals of s |v_t| + sigma_t v_t and s |u_t| + tau_t u_t, too. From it follow
//!
//! - int_S |sigma_n| <= M^2 / d where g - v_n >= d on S, and int_S (g - u_n) <= M^2 / p where tau_n <= -p on S, and
//!   int_S |u_t| <= M^2 / q where |tau_t| <= s - q ([`Zone`]);
//! - for every w in H^1 the functional R(w) = L(w) - int sigma(u) : eps(w), which is the force of the body on what holds it,
//!   in the mean with w on the boundary, lies within M |w|_a of L(w) - int m : eps(w) \[Q3\].

use std::collections::BTreeMap;

use nalgebra::Vector2;
#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use super::Asked;
use super::balanced::Balanced;
use super::build::{Built, Line, Station};
use super::certificate::{self, Certificate, Role};
use super::contact::Contact;
use super::dual::{ByPair, Dual};
use super::field::Field;
use super::forces::{
    Between, Cover, Evidence, ForceTarget, Forces, Mean, Motion, Ramp, WrongLifting,
};
use super::lifting::Lifter;
use super::parts::{Boundary, ProblemParts};
use super::proof::Proof;
use crate::contact::Law;
use crate::kernel::{Ball, Enclosing};
use crate::linear::dense::least_squares;
use crate::model::Degree;
use crate::results::{ContactBoundary, Solution};

/// The quantities that a certificate proves beside the bound.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ProvedQuantities {
    /// M: the distance of the true stress sigma(u) from m is at most this, in the norm of energy.
    pub mean_stress: f64,
    /// Where contact can hardly act, and where the body can hardly be off the obstacle.
    pub zones: Vec<Zone>,
    /// Forces, moments and reactions between two numbers.
    pub list: Vec<Quantity>,
    /// The evidence for them, beside the certificate.
    pub evidence: Evidence,
    /// The roots of what triangles of the mesh contribute to the width of the intervals by dual pairs; empty where there are
    /// none.
    pub(crate) indicators: Vec<f64>,
}

/// A number of the true solution, between two others.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Quantity {
    /// Which one.
    pub name: Name,
    /// The boundary.
    pub boundary: String,
    /// A weight of the pressure, if there is one.
    pub weight: Option<Ramp>,
    /// The value of the discrete solution.
    pub value: f64,
    /// The interval that contains the value of the true solution, or why nothing is known; the upper end of a peak pressure
    /// is infinite.
    pub interval: Result<[f64; 2], String>,
}

/// Which number of a boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Name {
    /// int |sigma_n| over a contact boundary.
    ContactForce,
    /// A component of the force of an obstacle on the body.
    ContactComponent(usize),
    /// The moment of that force about the origin, counter-clockwise.
    ContactMoment,
    /// sup |sigma_n| over a contact boundary, which has no upper bound that could be proved.
    PeakPressure,
    /// A component of the force of a support on the body.
    Reaction(usize),
    /// The moment of that force about the origin, counter-clockwise.
    ReactionMoment,
}

impl Name {
    /// Its name in result.json.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Name::ContactForce => "contact force",
            Name::ContactComponent(c) => ["contact force x", "contact force y"][c],
            Name::ContactMoment => "contact moment",
            Name::PeakPressure => "peak pressure",
            Name::Reaction(c) => ["reaction x", "reaction y"][c],
            Name::ReactionMoment => "reaction moment",
        }
    }

    fn motion(self, weight: Option<Ramp>) -> Motion {
        match self {
            Name::ContactForce | Name::PeakPressure => Motion::Along(weight),
            Name::ContactComponent(c) | Name::Reaction(c) => Motion::Axis(c),
            Name::ContactMoment | Name::ReactionMoment => Motion::Turn,
        }
    }

    /// The forces on the body are minus R(w). Contact does not pull, unless bodies are tied.
    fn of_functional(self, [low, high]: [f64; 2], pulls: bool) -> [f64; 2] {
        match self {
            Name::ContactForce | Name::PeakPressure if pulls => [low, high],
            Name::ContactForce | Name::PeakPressure => [low.max(0.0), high],
            _ => [-high, -low],
        }
    }
}

/// A stretch of a contact boundary, with what the true solution has there at most.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct Zone {
    /// The boundary.
    pub(crate) boundary: String,
    /// Arc length along the boundary, from the start of its first edge, where the stretch begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// The places of both, in the undeformed body.
    pub ends: [[f64; 2]; 2],
    /// The bounded quantity.
    #[cfg_attr(feature = "files", serde(flatten))]
    pub limit: Limit,
}

/// The quantity that is bounded on a [`Zone`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
pub enum Limit {
    /// The contact force int |sigma_n| is at most this (per unit of thickness).
    #[cfg_attr(feature = "files", serde(rename = "force_at_most"))]
    Force(f64),
    /// The integral of the opening int (g - u_n) is at most this.
    #[cfg_attr(feature = "files", serde(rename = "opening_at_most"))]
    Opening(f64),
    /// The integral of the slip int |u_t| is at most this.
    #[cfg_attr(feature = "files", serde(rename = "slip_at_most"))]
    Slip(f64),
}

/// Parts of the largest gap, and of the largest pressure, from which stretches are made.
const LEVELS: [f64; 3] = [0.5, 0.125, 0.03125];

/// A stretch says something if it has less than this part of the boundary's force, or of the opening that it would have if it
/// were moved by what the boundary's displacement has beyond a rigid motion.
const TELLING: f64 = 0.1;

/// The least lower end of four coefficients: no coefficient is below it.
fn smallest<S: Enclosing>(all: &[S; 4]) -> f64 {
    all.iter().fold(f64::INFINITY, |least, c| least.min(c.lower()))
}

/// Where contact can hardly act, and where the body can hardly be off the obstacle.
pub(super) fn zones<S: Enclosing>(
    certificate: &Certificate,
    state: &Balanced<S>,
    line: &Line,
    mean: Mean,
) -> Vec<Zone> {
    let mut zones = Vec::new();
    for (boundary, name) in line.names.iter().enumerate() {
        let stations: Vec<Station> =
            line.stations.iter().copied().filter(|s| line.of[s.edge] == Some(boundary)).collect();
        let contact = |s: &Station| match certificate.edges[s.edge].role {
            Role::Contact { pressure, law, .. } => (pressure.map(|p| -p), law),
            _ => ([0.0; 2], certificate::Law::Contact),
        };
        let (all, laws): (Vec<_>, Vec<_>) = stations.iter().map(contact).unzip();
        if laws.iter().any(|law| law.is_tied()) {
            continue;
        }
        // By how much friction could bear more: affine less convex, so that the least is at an end.
        let margin = |law: &certificate::Law| match law {
            certificate::Law::Friction { shear, bound } => {
                let at = |k: usize| (bound[k] - shear[k].abs()).next_down();
                at(0).min(at(1))
            }
            _ => 0.0,
        };
        let margins: Vec<f64> = laws.iter().map(margin).collect();
        let gaps: Vec<f64> =
            stations.iter().map(|s| smallest(&certificate.gap(s.edge, state))).collect();
        let pressures: Vec<f64> = all.iter().map(|[p, q]| p.min(*q)).collect();
        let forces = stations.iter().zip(&all).map(|(s, [p, q])| (p + q) / 2.0 * (s.to - s.from));
        let force: f64 = forces.sum();
        let bent = beyond_rigid(certificate, state, &stations);
        let mut add = |sizes: &[f64], limit: fn(f64) -> Limit, telling: &dyn Fn(f64) -> f64| {
            let largest = sizes.iter().copied().fold(0.0, f64::max);
            let mut last = Vec::new();
            for level in LEVELS {
                let runs = runs(&stations, |i| sizes[i] > 0.0 && sizes[i] >= level * largest);
                for &(first, end) in runs.iter().filter(|run| !last.contains(*run)) {
                    let least = sizes[first..end].iter().copied().fold(f64::INFINITY, f64::min);
                    let most = (Ball::point(mean.square) / Ball::point(least)).upper();
                    let (from, to) = (stations[first], stations[end - 1]);
                    if most <= TELLING * telling(to.to - from.from) {
                        let ends = [from.ends[0], to.ends[1]];
                        let (from, to, limit) = (from.from, to.to, limit(most));
                        zones.push(Zone { boundary: name.clone(), from, to, ends, limit });
                    }
                }
                last = runs;
            }
        };
        add(&gaps, Limit::Force, &|_| if force > 0.0 { force } else { f64::INFINITY });
        add(&pressures, Limit::Opening, &|length| length * bent);
        add(&margins, Limit::Slip, &|length| length * bent);
    }
    zones
}

/// The largest length of v at the ends of these edges less the rigid motion that is nearest to it there.
fn beyond_rigid<S: Enclosing>(
    certificate: &Certificate,
    state: &Balanced<S>,
    stations: &[Station],
) -> f64 {
    let middle = |x: S| (x.lower() + x.upper()) / 2.0;
    let ends: Vec<usize> = stations.iter().flat_map(|s| certificate.edges[s.edge].ends).collect();
    let (places, v): (Vec<Vector2<f64>>, Vec<Vector2<f64>>) =
        ends.iter().map(|&p| (state.points[p].map(middle), state.v.points[p].map(middle))).unzip();
    let count = places.len() as f64;
    let centre = places.iter().sum::<Vector2<f64>>() / count;
    let column = |of: fn(Vector2<f64>) -> [f64; 2]| -> Vec<f64> {
        places.iter().flat_map(|&x| of(x - centre)).collect()
    };
    let motions = [|_| [1.0, 0.0], |_| [0.0, 1.0], |x: Vector2<f64>| [-x.y, x.x]].map(column);
    let all: Vec<f64> = v.iter().flat_map(|&v| <[f64; 2]>::from(v)).collect();
    let weights = least_squares(motions.to_vec(), &all);
    let moved =
        |k: usize| motions.iter().zip(&weights).map(|(motion, w)| w * motion[k]).sum::<f64>();
    let left: Vec<f64> = all.iter().enumerate().map(|(k, v)| v - moved(k)).collect();
    left.chunks_exact(2).map(|v| v[0].hypot(v[1])).fold(0.0, f64::max)
}

/// The stretches of stations, from the first to before the last, that have a property and hang together.
fn runs(stations: &[Station], has: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (i, station) in stations.iter().enumerate().filter(|&(i, _)| has(i)) {
        match runs.last_mut() {
            Some((_, end)) if *end == i && station.joined => *end = i + 1,
            _ => runs.push((i, i + 1)),
        }
    }
    runs
}

/// Everything that `built` proves of the true solution near `solution`, v being the displacement that is proved with.
pub(super) fn prove(
    parts: &ProblemParts,
    (solution, v): (&Solution, &Field),
    built: &Built,
    (state, proof): (&Balanced<Ball>, &Proof),
    asked: &Asked,
) -> ProvedQuantities {
    let line = built.line(parts);
    let mean = Mean::new(state, proof, built.certificate.lift());
    let zones = zones(&built.certificate, state, &line, mean);
    let forces = Forces::new(&built.certificate, state, &line.of, mean);
    let open = open(parts, v, mean);
    // Those in M^2.
    let contact = state.on_contact.iter().map(|term| term.upper());
    let shares = proof.shares.iter().zip(contact).map(|(share, contact)| (share + contact) / 4.0);
    let shares: Vec<f64> = shares.collect();
    let (names, forces, shares, degree) = (&line.names, &forces, &shares, solution.degree);
    let prover = Prover { parts, built, degree, names, forces, shares, asked };
    let (list, mut evidence, limits) = prover.list(&open);
    let mut list: Vec<Quantity> = list
        .into_iter()
        .map(|(Question { name, boundary, weight }, interval)| {
            let boundary = line.names[boundary].clone();
            let value = match weight {
                Some(weight) => weighted(solution, &boundary, weight),
                None => value(solution, name, &boundary),
            };
            Quantity { name, boundary, weight, value, interval }
        })
        .collect();
    let peaks: Vec<Quantity> =
        list.iter().filter_map(|force| peak(force, &zones, &line, solution)).collect();
    list.extend(peaks);
    list.sort_by(|a, b| (&a.boundary, a.name).cmp(&(&b.boundary, b.name)));
    (evidence.names, evidence.of) = (line.names, line.of);
    let mut indicators = Vec::new();
    if !limits.is_empty() {
        indicators.resize(parts.mesh.triangles().len(), 0.0);
        built.origins.iter().zip(&limits).for_each(|(&t, limit)| indicators[t] += limit);
        indicators.iter_mut().for_each(|square: &mut f64| *square = square.max(0.0).sqrt());
    }
    ProvedQuantities { mean_stress: mean.root, zones, list, evidence, indicators }
}

/// The value of the discrete solution.
fn value(solution: &Solution, name: Name, boundary: &str) -> f64 {
    let (quantities, none) = (&solution.quantities, ContactBoundary::default());
    let contact = solution.boundaries.iter().find(|b| b.boundary == boundary).unwrap_or(&none);
    match name {
        Name::ContactForce => contact.force,
        Name::ContactComponent(c) => contact.resultant[c],
        Name::ContactMoment => contact.moment,
        Name::PeakPressure => contact.peak_pressure,
        Name::Reaction(c) => quantities.reactions.get(boundary).map_or(0.0, |r| r[c]),
        Name::ReactionMoment => quantities.reaction_moments.get(boundary).copied().unwrap_or(0.0),
    }
}

/// int phi |lambda^h| by the trapezoidal rule between the nodes.
fn weighted(solution: &Solution, boundary: &str, weight: Ramp) -> f64 {
    let edges = solution.contact.iter().filter(|edge| &*edge.boundary == boundary);
    let nodes = edges.flat_map(|edge| edge.points.windows(2));
    nodes.fold(0.0, |sum, pair| {
        let at = |k: usize| -pair[k].lambda * weight.at(pair[k].place[weight.axis]);
        sum + (at(0) + at(1)) / 2.0 * (pair[1].arc - pair[0].arc)
    })
}

/// The largest cost of w where it is free, in parts of the boundary's force.
const PRICE: f64 = 0.1;

/// The edges of Gamma_C where v is off the obstacle by half of what it is at most on that boundary, and by so much that
/// little force is possible there: w may be free.
fn open<'a>(parts: &'a ProblemParts, v: &Field, mean: Mean) -> Vec<bool> {
    let gaps: Vec<f64> = parts
        .contact
        .iter()
        .map(|edge| {
            let jump = edge.jump(parts.mesh, v);
            let gap = |k: usize| edge.gap[k] - jump[2 * k].dot(&edge.directions[k]);
            gap(0).min(gap(1))
        })
        .collect();
    let largest = |boundary: &str| {
        let of = parts.contact.iter().zip(&gaps).filter(|(edge, _)| &*edge.boundary == boundary);
        of.fold(0.0, |most: f64, (_, &gap)| most.max(gap))
    };
    let force = |boundary: &str| -> f64 {
        let of = parts.contact.iter().filter(|edge| &*edge.boundary == boundary);
        of.map(|edge| -edge.force()).sum()
    };
    let least = |name: &str| (largest(name) / 2.0).max(mean.square / (PRICE * force(name)));
    let mut known: BTreeMap<&str, f64> = BTreeMap::new();
    let is_open = |(edge, &gap): (&'a Contact, &f64)| {
        let least = *known.entry(&*edge.boundary).or_insert_with(|| least(&edge.boundary));
        !edge.is_tied() && gap > 0.0 && gap >= least
    };
    parts.contact.iter().zip(&gaps).map(is_open).collect()
}

/// The edges of Gamma_C that are not pressed from end to end, but for so many next to those that are; where `beyond` is
/// negative, so many of these, too.
fn off_contact(parts: &ProblemParts, beyond: i32) -> Vec<bool> {
    let mut open: Vec<bool> = parts.contact.iter().map(|edge| !edge.is_pressed()).collect();
    let ends: Vec<[usize; 2]> =
        parts.contact.iter().map(|edge| parts.mesh.ends(edge.edge)).collect();
    let grows = beyond < 0;
    for _ in 0..beyond.unsigned_abs() {
        let before = open.clone();
        for k in (1..open.len()).filter(|&k| ends[k - 1][1] == ends[k][0]) {
            if before[k - 1] != before[k] {
                let changed = if before[k] == grows { k - 1 } else { k };
                open[changed] = grows;
            }
        }
    }
    open
}

/// The edges of Gamma_C that are free, and the displacements of least energy with these.
type Freed<'a> = (Vec<bool>, Lifter<'a>);

/// Displacements of least energy, with the edges of Gamma_C where they are free: so many beyond the last one that is pressed
/// from end to end, or before it.
struct Lifters<'a> {
    parts: &'a ProblemParts<'a>,
    degree: Degree,
    names: &'a [String],
    made: BTreeMap<i32, Option<Freed<'a>>>,
}

impl<'a> Lifters<'a> {
    fn at(&mut self, beyond: i32) -> Option<&Freed<'a>> {
        let (parts, names) = (self.parts, self.names);
        let made = self.made.entry(beyond).or_insert_with(|| {
            let open = off_contact(parts, beyond);
            let lifter = Lifter::new(parts, self.degree, names, &open).ok()?;
            Some((open, lifter))
        });
        made.as_ref()
    }

    /// A dual pair whose w is what it is to be, and whose rho has a traction, so many edges beyond the last one that is pressed
    /// from end to end, with what it proves.
    fn pair(
        &mut self,
        [of_w, of_rho]: [i32; 2],
        target: ForceTarget,
        built: &Built,
        (forces, cover): (&Forces<Ball>, Option<&Cover>),
    ) -> Option<Tried> {
        let w = self.at(of_w)?.1.field(target).ok()?;
        let (open, lifter) = self.at(of_rho)?;
        let pair = lifter.pair((target, &w), built, open).ok()?;
        let found = forces.by_pair(target, &pair, cover).ok()?;
        Some(Tried { found, pair })
    }
}

/// A dual pair with what it proves.
struct Tried {
    found: ByPair,
    pair: Dual,
}

/// The evidence without what proves nothing, and with what is `found` of the rest.
fn proving(
    mut evidence: Evidence,
    cover: Option<&Cover>,
    found: &[Result<[f64; 2], WrongLifting>],
    pairs: Vec<[f64; 2]>,
) -> Evidence {
    let mut proved = found.iter().map(Result::is_ok);
    evidence.liftings.retain(|_| proved.next() == Some(true));
    evidence.cover = evidence.cover.filter(|_| cover.is_some());
    let cover = cover.map_or([0.0; 2], |cover| cover.between);
    let liftings = found.iter().flatten().copied().collect();
    evidence.between = Some(Between { cover, liftings, pairs });
    evidence
}

/// The share of each triangle in the distance of one end from the middle, k M^2 + eta^2 / (4 k) with the k >= eta / (2 M) that makes
/// it that distance; `shares` are those in M^2. The upper end counts k M^2 alone: its eta comes from where w and rho end, not from
/// the triangles.
fn limits_of(found: &ByPair, side: usize, shares: &[f64]) -> Vec<f64> {
    let [of_mean, of_pair] = [shares, &found.shares].map(|all| all.iter().sum::<f64>());
    let k = found.factors[side].max((of_pair / of_mean).sqrt() / 2.0);
    let per_pair = if side == 0 { 1.0 / (4.0 * k) } else { 0.0 };
    let all = shares.iter().zip(&found.shares);
    all.map(|(mean, pair)| k * mean + pair * per_pair).collect()
}

/// rho ends at most this many edges before the last one that is pressed from end to end.
const FARTHEST: i32 = 64;

/// The best dual pairs for the ends of a force, each with the ends that it is best for. For the lower end w and rho end with the
/// last edge that is pressed from end to end. For the upper one rho ends where the pressure is not small, 1, 2, 4 ... edges
/// before, as long as that helps, and w where the body is off the obstacle, a quarter as far beyond.
fn best_pairs(mut pair: impl FnMut([i32; 2]) -> Option<Tried>) -> Vec<(Tried, Vec<usize>)> {
    let Some(lowest) = pair([0, 0]) else { return Vec::new() };
    let mut highest: Option<Tried> = None;
    let mut before = 1;
    while before <= FARTHEST {
        let Some(tried) = pair([(before / 4).max(1), -before]) else { break };
        let end = |tried: &Tried, side: usize| tried.found.between[side];
        if highest.as_ref().is_some_and(|best| end(&tried, 1) >= end(best, 1)) {
            break;
        }
        highest = Some(tried);
        before *= 2;
    }
    match highest {
        Some(highest) if highest.found.between[1] < lowest.found.between[1] => {
            vec![(lowest, vec![0]), (highest, vec![1])]
        }
        _ => vec![(lowest, vec![0, 1])],
    }
}

/// The peak is at least the mean over all of a boundary, or over what is left of it without a stretch that has little force.
fn peak(force: &Quantity, zones: &[Zone], line: &Line, solution: &Solution) -> Option<Quantity> {
    let (Name::ContactForce, None, Ok([low, _])) = (force.name, force.weight, &force.interval)
    else {
        return None;
    };
    let boundary = force.boundary.clone();
    let point = Ball::point;
    let stations =
        line.stations.iter().filter(|s| line.of[s.edge].is_some_and(|b| line.names[b] == boundary));
    // Arc lengths are doubles near the true ones.
    let length = stations.fold(0.0, |sum, s| sum + (s.to - s.from)) * (1.0 + 1e-12);
    let mut least = (point(*low) / point(length)).lower();
    for zone in zones.iter().filter(|zone| zone.boundary == boundary) {
        if let Limit::Force(most) = zone.limit {
            let left = length - (zone.to - zone.from) * (1.0 - 1e-12);
            if left > 0.0 {
                least = least.max(((point(*low) - point(most)) / point(left)).lower());
            }
        }
    }
    let name = Name::PeakPressure;
    let interval = Ok([least.max(0.0), f64::INFINITY]);
    let value = value(solution, name, &boundary);
    Some(Quantity { name, boundary, weight: None, value, interval })
}

/// A number of a boundary that is asked for.
#[derive(Clone, Copy)]
struct Question {
    name: Name,
    boundary: usize,
    weight: Option<Ramp>,
}

/// A number of a boundary between two others, or why not.
type Found = (Question, Result<[f64; 2], String>);

/// How contact acts on a boundary.
#[derive(Clone, Copy, Default)]
struct Acts {
    /// The axis along which it acts, with its sign: then the force says all of its components.
    axis: Option<(usize, f64)>,
    /// Bodies that are tied pull, too.
    pulls: bool,
}

/// Proves forces, moments and reactions.
struct Prover<'a> {
    parts: &'a ProblemParts<'a>,
    built: &'a Built,
    degree: Degree,
    names: &'a [String],
    forces: &'a Forces<'a, Ball>,
    /// The shares of the triangles in M^2.
    shares: &'a [f64],
    asked: &'a Asked,
}

impl Prover<'_> {
    /// Forces, moments and reactions of all boundaries, with what triangles contribute to the width of those by dual pairs; w
    /// is free on the `open` edges of Gamma_C.
    fn list(&self, open: &[bool]) -> (Vec<Found>, Evidence, Vec<f64>) {
        let (questions, acts): (Vec<_>, Vec<_>) =
            (0..self.names.len()).map(|boundary| self.questions(boundary)).unzip();
        let questions = questions.concat();
        let lifter = match Lifter::new(self.parts, self.degree, self.names, open) {
            Ok(lifter) => lifter,
            Err(error) => {
                let why = |question| (question, Err(error.clone()));
                return (questions.into_iter().map(why).collect(), Evidence::default(), Vec::new());
            }
        };
        let (mut evidence, places) = self.liftings(&lifter, &questions);
        let cover = evidence.cover.as_ref().and_then(|w| self.forces.cover(w).ok());
        let between = self.forces.between(&evidence.liftings, cover.as_ref());
        let (by_pairs, limits) = self.dual_pairs(&mut evidence, &between, cover.as_ref());
        let nearest = |k: usize| {
            let ends = between[k].clone().map_err(|error| error.to_string())?;
            Ok(evidence.nearest(evidence.liftings[k].0, ends, &by_pairs))
        };
        let found = questions.into_iter().zip(places).flat_map(|(question, place)| {
            answers(question, acts[question.boundary], place.and_then(nearest))
        });
        let found = found.collect();
        (found, proving(evidence, cover.as_ref(), &between, by_pairs), limits)
    }

    /// The numbers of a boundary that are asked for, and how contact acts there.
    fn questions(&self, boundary: usize) -> (Vec<Question>, Acts) {
        let (parts, name) = (self.parts, &self.names[boundary]);
        let edges = parts.mesh.edges_of(name).unwrap_or_default();
        let what = || edges.iter().filter_map(|&e| parts.boundary.get(&parts.mesh.number_of(e)));
        // Of a pair, those of the first body.
        let lines = what().filter_map(|what| match what {
            Boundary::Contact(line) => Some(&parts.lines[*line]),
            _ => None,
        });
        let contacts = lines.flatten().filter(|&&(_, side)| side == 0);
        let contacts: Vec<&Contact> = contacts.map(|&(k, _)| &parts.contact[k]).collect();
        let mut acts = Acts { axis: None, pulls: contacts.iter().any(|contact| contact.is_tied()) };
        let mut pairs = parts.problem.pairs.iter().filter(|pair| pair.boundaries.contains(name));
        if pairs.clone().count() > 1 && pairs.any(|pair| pair.boundaries[0] != *name) {
            // The jump of w is that of the first bodies, and this one is a first and a second body.
            return (Vec::new(), acts);
        }
        let ask = |name, weight| Question { name, boundary, weight };
        let mut questions = Vec::new();
        let mut along = contacts.iter().map(|contact| contact.directions);
        if let Some([d, _]) = along.next() {
            let is_glued = contacts.iter().any(|contact| contact.law == Law::Bonded);
            let acts_across = is_glued || contacts.iter().any(|contact| contact.has_friction());
            let constant = !acts_across && along.all(|other| other == [d, d]);
            acts.axis = (0..2).find(|&c| constant && d[1 - c] == 0.0).map(|c| (c, d[c]));
            // Glue has no direction.
            questions.extend((!is_glued).then(|| ask(Name::ContactForce, None)));
            let own = self.asked.forces.iter().filter(|(of, ramp)| of == name && ramp.is_some());
            questions.extend(own.map(|&(_, ramp)| ask(Name::ContactForce, ramp)));
            if acts.axis.is_none() {
                questions.extend([0, 1].map(|c| ask(Name::ContactComponent(c), None)));
            }
            questions.push(ask(Name::ContactMoment, None));
        } else if what().any(|what| matches!(what, Boundary::Held(..) | Boundary::Supported(..))) {
            questions.extend([0, 1].map(|c| ask(Name::Reaction(c), None)));
            questions.push(ask(Name::ReactionMoment, None));
        }
        (questions, acts)
    }

    /// The displacements w, w0 among them, and for each question the place of its own, or why there is none.
    fn liftings(
        &self,
        lifter: &Lifter,
        questions: &[Question],
    ) -> (Evidence, Vec<Result<usize, String>>) {
        let lifting = |target| lifter.lifting(target, self.built, self.forces.of);
        let all = ForceTarget { boundary: None, motion: Motion::Along(None) };
        let mut evidence = Evidence { cover: lifting(all).ok(), ..Evidence::default() };
        let places = questions.iter().map(|&Question { name, boundary, weight }| {
            let target = ForceTarget { boundary: Some(boundary), motion: name.motion(weight) };
            evidence.liftings.push((target, lifting(target)?));
            Ok(evidence.liftings.len() - 1)
        });
        let places = places.collect();
        (evidence, places)
    }

    /// Adds dual pairs to the evidence where they say more than the liftings, which prove what forces are `between`; returns
    /// what they prove, and what triangles contribute to its width.
    fn dual_pairs(
        &self,
        evidence: &mut Evidence,
        between: &[Result<[f64; 2], WrongLifting>],
        cover: Option<&Cover>,
    ) -> (Vec<[f64; 2]>, Vec<f64>) {
        let (mut by_pairs, mut limits) = (Vec::new(), Vec::new());
        let (parts, degree, names) = (self.parts, self.degree, self.names);
        let mut lifters = Lifters { parts, degree, names, made: BTreeMap::new() };
        for (&(target, _), first) in evidence.liftings.iter().zip(between) {
            let Ok(first) = first else { continue };
            if !self.is_to_second_order(target) {
                continue;
            }
            let goal = (self.forces, cover);
            let pair = |splits| lifters.pair(splits, target, self.built, goal);
            for (Tried { found, pair }, mut sides) in best_pairs(pair) {
                let [low, high] = found.between;
                sides.retain(|side| if *side == 0 { low > first[0] } else { high < first[1] });
                for &side in &sides {
                    limits.resize(self.shares.len(), 0.0);
                    let more = limits_of(&found, side, self.shares);
                    limits.iter_mut().zip(more).for_each(|(limit, more)| *limit += more);
                }
                if !sides.is_empty() {
                    evidence.pairs.push((target, pair));
                    by_pairs.push(found.between);
                }
            }
        }
        (by_pairs, limits)
    }

    fn is_to_second_order(&self, target: ForceTarget) -> bool {
        let Motion::Along(weight) = target.motion else { return false };
        self.asked.forces.iter().any(|(of, ramp)| {
            *ramp == weight && target.boundary.is_some_and(|boundary| self.names[boundary] == *of)
        })
    }
}

/// The numbers of a boundary that the interval of a functional says: of a force along an axis all components, too.
fn answers(question: Question, acts: Acts, interval: Result<[f64; 2], String>) -> Vec<Found> {
    let interval = interval.map(|ends| question.name.of_functional(ends, acts.pulls));
    let mut found = Vec::new();
    if let (Name::ContactForce, None, Some((axis, sign))) =
        (question.name, question.weight, acts.axis)
    {
        for c in 0..2 {
            let along = |[low, high]: [f64; 2]| match (c == axis, sign > 0.0) {
                (true, true) => [-high, -low],
                (true, false) => [low, high],
                (false, _) => [0.0; 2],
            };
            let component = Question { name: Name::ContactComponent(c), ..question };
            found.push((component, interval.clone().map(along)));
        }
    }
    found.push((question, interval));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_force_is_never_negative_and_other_forces_are_minus_the_functional() {
        for (name, expected) in [
            (Name::ContactForce, [0.0, 2.0]),
            (Name::PeakPressure, [0.0, 2.0]),
            (Name::ContactComponent(1), [-2.0, 1.0]),
            (Name::ContactMoment, [-2.0, 1.0]),
            (Name::Reaction(0), [-2.0, 1.0]),
        ] {
            assert_eq!(name.of_functional([-1.0, 2.0], false), expected, "{name:?}");
        }
        assert_eq!(Name::ContactForce.of_functional([1.0, 2.0], false), [1.0, 2.0]);
        assert_eq!(Name::ContactForce.of_functional([-1.0, 2.0], true), [-1.0, 2.0]);
    }

    #[test]
    fn a_gap_is_no_less_than_the_lower_end_of_each_coefficient() {
        let third = Ball::from(1) / Ball::from(3);
        let all = |k: usize| [0, 1, 2, 3].map(|i| if i == k { third } else { Ball::from(1) });
        for k in 0..4 {
            let found = smallest(&all(k));
            assert!(found == third.lower() && found < third.upper(), "{k}: {found}");
        }
    }
}
