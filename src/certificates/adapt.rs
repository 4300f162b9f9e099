//! Adaptivity to a proved target: solve, bound the distance to the true solution, bisect the triangles that have the largest
//! shares in the square of the bound, and again, until the bound is as small as it is to be.
//!
//! The target may be a contact force in place of the energy norm: then the force is to lie between two numbers that are that
//! near to each other, and the shares are those in the distance of the two (docs/a-posteriori.md, 7.7).
//!
//! A mesh is refined where the fewest triangles have the share [`THETA`] of the whole (Doerfler's marking), by
//! [`newest-vertex bisection`](crate::model::mesh::bisection). Newton's method starts from the coarser solution.
//!
//! Every level has a certificate of its own, for the problem on its own mesh: nothing that is proved rests on the levels
//! before. The body is the polygon of the first mesh: the middle of a straight edge lies on it, but for rounding. Where contact, with an
//! obstacle or of a pair, is taken for round, the middle of an edge is placed on the curve on which gaps are measured: chords of half the
//! length in place of one chord, which would have a gap of its own.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::errors::CertifyError;
use super::quantities::Name;
use super::{Asked, Continuous, certify_with};
use crate::contact::ContactLine;
use crate::contact::piece::PieceGeometry;
use crate::model::boundary_normals::SmoothBoundary;
use crate::model::mesh::bisection::Refinement;
use crate::model::{BoundaryEdge, Condition, Degree, Mesh, Problem, Space};
use crate::quote::quoted;
use crate::results::Solution;
#[cfg(feature = "files")]
use crate::results::answers::unknown;
use crate::solve::{Course, Method, Phase, Settings, SolveError, Times, solve_along};

/// The share of the square of the bound that the marked triangles have. With more, levels are fewer and grow faster.
pub const THETA: f64 = 0.5;

/// After so many levels in a row whose bound is no smaller than one before, finer meshes are not tried, if the bound says
/// something and the meshes are not far smaller than is allowed: a coarse mesh may need more levels to see what it has to.
const NO_BETTER: usize = 3;

/// A mesh with less than this part of the unknowns that are allowed is far smaller.
const FAR_SMALLER: f64 = 0.05;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The bound over the energy norm, or half the width of what a force lies between over its middle, is to be at most this.
    pub relative: f64,
    /// No mesh has more degrees of freedom than this, but for the first.
    pub max_unknowns: usize,
}

/// The result on one mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct AdaptedLevel {
    /// Degrees of freedom: twice the nodes.
    pub unknowns: usize,
    /// Triangles.
    pub(crate) triangles: usize,
    /// The number of Newton steps.
    pub newton_steps: usize,
    /// |u - v|_a is at most this.
    pub bound: f64,
    /// The bound over |v|_a; NaN or infinite of a body at rest, and then left out of files.
    #[cfg_attr(feature = "files", serde(default = "unknown", skip_serializing_if = "is_unknown"))]
    pub relative: f64,
    /// Half the width of what the force lies between over its middle, if a force is the target.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub force: Option<f64>,
}

#[cfg(feature = "files")]
fn is_unknown(x: &f64) -> bool {
    !x.is_finite()
}

/// The level with the smallest bound, with all others.
#[derive(Debug)]
#[non_exhaustive]
pub struct Adapted {
    /// Its solution.
    pub solution: Solution,
    /// The time that the solves took, all levels together.
    pub times: Times,
    /// Its bound, or why there is none.
    pub certified: Result<Continuous, CertifyError>,
    /// The time that the certificates and the meshes took, all levels together.
    pub certifying: Duration,
    /// All levels, from the coarsest on.
    pub levels: Vec<AdaptedLevel>,
    /// The number of the one that is given, from 0.
    pub level: usize,
    /// Why the bound does not meet the target.
    pub unmet: Option<String>,
}

/// The stage of the adaptive loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// A part of a solve.
    Solve(Phase),
    /// The bound, on the level of this number, from 0.
    Certify(usize),
    /// The next mesh.
    Refine,
}

/// Why there is no level that meets the target, nor one that is as fine as allowed.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum AdaptError {
    #[error("level {level}: {error}")]
    Solve { level: usize, error: SolveError },
    #[error("no mesh can be adapted to a proved target: {0}")]
    Certify(#[from] CertifyError),
    #[error(
        "no mesh can be adapted: {} is curved and has a gap along its normal, and bisection keeps the straight edges of the mesh; expected a straight boundary, or an [obstacle]",
        quoted(boundary, '\'')
    )]
    Curved { boundary: String },
}

impl AdaptError {
    /// Tells whether the case is wrong. Otherwise it is right, but there is no result of it here.
    pub fn is_wrong_case(&self) -> bool {
        match self {
            AdaptError::Solve { error, .. } => error.is_wrong_case(),
            AdaptError::Certify(error) => {
                matches!(error, CertifyError::Data(_) | CertifyError::Unsupported(_))
            }
            AdaptError::Curved { .. } => true,
        }
    }
}

/// Solves `problem` on meshes that are refined until the bound meets the `target` or falls no more, and gives the problem on the
/// mesh with the smallest bound; `watcher` is told what goes on. A failure on a finer mesh than the first ends the refinement.
///
/// # Errors
/// A first level without a solution.
pub fn adapt(
    problem: Problem,
    method: &Method,
    settings: &Settings,
    target: Target,
    watcher: &dyn Fn(Stage),
) -> Result<(Problem, Adapted), AdaptError> {
    adapt_to(problem, (method, settings), (target, None), &Asked::default(), watcher)
}

/// [`adapt`], where the target may be the contact force of a boundary; `asked` is what the certificates prove beside it.
///
/// # Errors
/// As [`adapt`].
pub fn adapt_to(
    mut problem: Problem,
    (method, settings): (&Method, &Settings),
    (target, force): (Target, Option<&str>),
    asked: &Asked,
    watcher: &dyn Fn(Stage),
) -> Result<(Problem, Adapted), AdaptError> {
    check_straight(&problem)?;
    let mut asked = asked.clone();
    asked.forces.extend(force.map(|boundary| (boundary.to_owned(), None)));
    let of_solve = |phase| watcher(Stage::Solve(phase));
    let mut newest = problem.mesh.opposite_longest();
    let mut start: Option<Vec<[f64; 2]>> = None;
    let (mut levels, mut times, mut certifying) = (Vec::new(), Times::default(), Duration::ZERO);
    let mut before: Option<Best> = None;
    let (best, unmet) = loop {
        let level = levels.len();
        let course = Course::default().watched_by(&of_solve);
        let course = start.as_deref().map_or(course, |start| course.from_displacement(start));
        let solution = match (solve_along(&problem, method, settings, course), before.take()) {
            (Ok((solution, took)), best) => {
                (before, times) = (best, times.plus(&took));
                solution
            }
            (Err(error), None) => return Err(AdaptError::Solve { level, error }),
            (Err(error), Some(best)) => break (best, Some(without_solution(level, &error))),
        };
        watcher(Stage::Certify(level));
        let certified = timed(&mut certifying, || certify_with(&problem, &solution, &asked));
        let certified = match certified {
            Ok(certified) => certified,
            Err(error) => {
                let unmet = Some(format!("level {level} has no certificate: {error}"));
                let this = || Best::new(problem, solution, Err(error), level, force);
                break (before.unwrap_or_else(this), unmet);
            }
        };
        levels.push(AdaptedLevel::new(&problem, &solution, &certified, force));
        watcher(Stage::Refine);
        let (_, reached) = off(&certified, force);
        let is_met = reached <= target.relative;
        let finer = || if is_met { Err(None) } else { finer(&problem, &newest, &certified, force) };
        let finer = timed(&mut certifying, finer);
        start = finer.iter().map(|f| f.prolonged(&problem.mesh, &solution.displacement)).next();
        let this = Best::new(problem.clone(), solution, Ok(certified), level, force);
        let best = match before.take() {
            Some(best) if !is_met && best.off <= this.off => best,
            _ => this,
        };
        let finer = match finer {
            Ok(finer) => finer,
            Err(unmet) => break (best, unmet),
        };
        let counts = [&problem.mesh, &finer.mesh].map(|mesh| unknowns(mesh, method.degree));
        if let Some(unmet) = best.why_last(level, counts, target, force) {
            break (best, Some(unmet));
        }
        newest = vec![0; finer.mesh.triangles().len()];
        problem = problem.refined(finer);
        before = Some(best);
    };
    let Best { problem, solution, certified, level, .. } = best;
    Ok((problem, Adapted { solution, times, certified, certifying, levels, level, unmet }))
}

/// The reason that there is no finer level; the residuals of the steps are on further lines of the error.
fn without_solution(level: usize, error: &SolveError) -> String {
    let error = error.to_string();
    format!("level {level} has no solution: {}", error.lines().next().unwrap_or_default())
}

/// Adds the time that this takes.
fn timed<T>(sum: &mut Duration, what: impl FnOnce() -> T) -> T {
    let begin = std::time::Instant::now();
    let found = what();
    *sum += begin.elapsed();
    found
}

/// The number that is to be small, and the one that the target compares.
fn off(certified: &Continuous, force: Option<&str>) -> (f64, f64) {
    let within = force.map(|boundary| within(certified, boundary));
    within.map_or((certified.bound, certified.relative), |within| (within, within))
}

impl AdaptedLevel {
    fn new(
        problem: &Problem,
        solution: &Solution,
        certified: &Continuous,
        force: Option<&str>,
    ) -> AdaptedLevel {
        let within = force.map(|boundary| within(certified, boundary));
        AdaptedLevel {
            unknowns: unknowns(&problem.mesh, solution.degree),
            triangles: problem.mesh.triangles().len(),
            newton_steps: solution.newton.iterations(),
            bound: certified.bound,
            relative: certified.relative,
            force: within.filter(|within| within.is_finite()),
        }
    }
}

/// The level with what is to be small at its smallest so far, with its problem.
struct Best {
    problem: Problem,
    solution: Solution,
    certified: Result<Continuous, CertifyError>,
    level: usize,
    off: f64,
    /// The number that the target is compared with.
    reached: f64,
}

impl Best {
    fn new(
        problem: Problem,
        solution: Solution,
        certified: Result<Continuous, CertifyError>,
        level: usize,
        force: Option<&str>,
    ) -> Best {
        let unknown = (f64::INFINITY, f64::INFINITY);
        let (off, reached) = certified.as_ref().map_or(unknown, |certified| off(certified, force));
        Best { problem, solution, certified, level, off, reached }
    }

    /// The reason that this level is the last, `next` being the unknowns of the mesh that would follow.
    fn why_last(
        &self,
        level: usize,
        [unknowns, next]: [usize; 2],
        target: Target,
        force: Option<&str>,
    ) -> Option<String> {
        let is_small = (unknowns as f64) < FAR_SMALLER * target.max_unknowns as f64;
        if level >= self.level + NO_BETTER && self.reached <= 1.0 && !is_small {
            let what = force.map_or("the bound", |_| "what the force lies between");
            return Some(format!("{what} has not come nearer for {NO_BETTER} levels"));
        }
        let reason = "the next mesh has more unknowns than adapt.max_unknowns allows";
        (next > target.max_unknowns).then(|| reason.to_owned())
    }
}

/// The mesh of `problem`, refined where the bound, or what the force lies between, has its largest shares; or why there is none.
fn finer(
    problem: &Problem,
    newest: &[usize],
    certified: &Continuous,
    force: Option<&str>,
) -> Result<Refinement, Option<String>> {
    if let Some(Err(reason)) = force.map(|boundary| force_of(certified, boundary)) {
        return Err(Some(reason));
    }
    // There is no share of an energy that is 0.
    if !certified.relative.is_finite() {
        return Err(Some("the body is at rest, its energy is 0".to_owned()));
    }
    let round: BTreeMap<[usize; 2], [f64; 2]> = round_contact(problem)
        .into_iter()
        .map(|(edge, middle)| ([edge.triangle, edge.local], middle))
        .collect();
    let round = |edge: BoundaryEdge| round.get(&[edge.triangle, edge.local]).copied();
    let marked = marked(shares(certified, force));
    let finer = problem.mesh.bisected_along(newest, &marked, round);
    finer.map_err(|error| Some(error.to_string()))
}

/// The interval of a boundary's contact force, or why it is not known.
fn force_of(certified: &Continuous, boundary: &str) -> Result<[f64; 2], String> {
    let mut all = certified.quantities.list.iter();
    let force =
        all.find(|q| q.name == Name::ContactForce && q.boundary == boundary && q.weight.is_none());
    let none = || format!("there is no contact on {}", quoted(boundary, '\''));
    force.ok_or_else(none)?.interval.clone()
}

/// Half the width of that over its middle.
fn within(certified: &Continuous, boundary: &str) -> f64 {
    force_of(certified, boundary).map_or(f64::INFINITY, |[low, high]| (high - low) / (low + high))
}

/// The roots of what the triangles share in the bound, or in the width of what a force lies between.
fn shares<'a>(certified: &'a Continuous, force: Option<&str>) -> &'a [f64] {
    let (own, dual) = (&certified.indicators, &certified.quantities.indicators);
    if force.is_some() && dual.len() == own.len() { dual } else { own }
}

/// Degrees of freedom on a mesh.
fn unknowns(mesh: &Mesh, degree: Degree) -> usize {
    let middles = match degree {
        Degree::One => 0,
        Degree::Two => mesh.edge_count(),
    };
    2 * (mesh.vertices().len() + middles)
}

/// Where contact acts along normals with a gap of its own, these are those of straight edges.
fn check_straight(problem: &Problem) -> Result<(), AdaptError> {
    let space = Space::new(&problem.mesh, Degree::One);
    let line = ContactLine::new(problem, &space).map_err(CertifyError::Data)?;
    let along_its_normal = |name: &str| {
        let condition = problem.conditions.get(name);
        matches!(condition, Some(Condition::Contact { .. }))
    };
    let boundary = |piece: &PieceGeometry| piece.first().boundary.to_string();
    match line.pieces().find(|p| !p.along_normal && along_its_normal(&boundary(p))) {
        Some(piece) => Err(AdaptError::Curved { boundary: boundary(piece) }),
        None => Ok(()),
    }
}

/// The edges of contact, with obstacles and of pairs, that are taken for round, each with the middle of the curve on which gaps are measured: there its
/// middle is placed when it is halved. The body of each level is the polygon of its mesh.
pub(super) fn round_contact(problem: &Problem) -> Vec<(BoundaryEdge, [f64; 2])> {
    let mesh = &problem.mesh;
    let smooth = SmoothBoundary::new(mesh);
    let obstacles = problem.conditions.iter().filter(|(_, condition)| condition.is_contact());
    let of_pairs = problem.pairs.iter().flat_map(|pair| &pair.boundaries);
    let names: BTreeSet<&String> = obstacles.map(|(name, _)| name).chain(of_pairs).collect();
    let edges = names.into_iter().flat_map(|name| mesh.edges_of(name).unwrap_or_default());
    let middle = |&edge: &BoundaryEdge| {
        let [.., middle] = smooth.along(mesh, edge)?;
        Some((edge, middle.place))
    };
    edges.filter_map(middle).collect()
}

/// The fewest triangles whose shares make up [`THETA`] of the whole; `indicators` are the roots of the shares. Where all
/// shares are 0, all triangles.
pub fn marked(indicators: &[f64]) -> Vec<usize> {
    let share = |&t: &usize| indicators[t] * indicators[t];
    let mut order: Vec<usize> = (0..indicators.len()).collect();
    order.sort_by(|a, b| indicators[*b].total_cmp(&indicators[*a]));
    let whole: f64 = order.iter().map(share).sum();
    let mut sum = 0.0;
    let last = order.iter().position(|t| {
        sum += share(t);
        sum >= THETA * whole && whole > 0.0
    });
    order.truncate(last.map_or(order.len(), |last| last + 1));
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_triangles_with_half_of_the_whole_are_marked() {
        assert_eq!(marked(&[1.0, 3.0, 2.0, 2.0]), [1], "9 of 18");
        assert_eq!(marked(&[1.0, 2.0, 2.0, 2.0]), [1, 2], "8 of 13");
        assert_eq!(marked(&[0.0, 0.0]), [0, 1]);
    }
}
