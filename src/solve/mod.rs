//! The solution of method (8): Newton's method on J_h by the route that costs less, corrections until nothing is left to
//! correct, the verdict, and what the solution says.

pub mod accuracy;
pub mod answers;
pub mod assembled;
pub mod balls;
pub mod body;
mod checked;
pub mod compliance;
pub mod condensed;
mod contact_edges;
pub mod course;
pub mod enclosure;
pub mod evaluated;
pub mod factor;
pub mod intervals;
pub mod iterate;
pub mod ladder;
mod memory;
pub mod newton;
pub mod ordering;
pub mod pressed;
mod relaxation;
pub mod route;
pub mod solution;
pub mod stresses;
pub mod system;
pub mod theorem;
pub mod times;

#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};
use thiserror::Error;

use self::accuracy::Outcome;
pub use self::answers::{ContactBoundary, EnergyBalance};
pub use self::checked::{MOST_GAUSS_POINTS, MOST_ITERATIONS};
pub use self::course::{Course, Phase};
pub use self::enclosure::{Enclosure, Unproved};
use self::evaluated::Evaluated;
pub use self::intervals::Intervals;
pub use self::ladder::{Ladder, LadderError, Level};
pub use self::route::RouteName;
pub use self::solution::{GammaReport, Quantities, Solution};
pub use self::stresses::{Extreme, LargestStresses};
use self::system::System;
pub use self::theorem::Theorem;
use self::times::Stopwatch;
pub use self::times::Times;
use crate::fem::contact_line::{Coercivity, EdgeRule, Gamma};
use crate::fem::held::Play;
use crate::fem::{DataError, Discretization, MeshError, Problem};
use crate::kernel::edge_integral::ExactEdge;
use crate::kernel::{Material, P1, P2};
use crate::quote::{fixed, number};

/// The free choices of method (8). Written as `Method { degree, ..Method::default() }`, for fields may come.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// The polynomial degree of V^h, 1 or 2.
    pub degree: Degree,
    /// gamma0 of (7).
    pub gamma0: Gamma0,
    /// How the contact terms are integrated.
    pub quadrature: ContactQuadrature,
    /// Solve although kappa >= 1, without any promise.
    pub allow_noncoercive: bool,
}

/// The polynomial degree of V^h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Degree {
    /// P1, section 2.2.
    One,
    /// P2, Remark 3.7.
    Two,
}

impl Degree {
    /// 1 or 2.
    pub fn number(self) -> usize {
        match self {
            Degree::One => 1,
            Degree::Two => 2,
        }
    }
}

/// gamma0 of (7), in 1 / stress.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Gamma0 {
    /// Half of the coercivity limit.
    Auto,
    /// This value.
    Value(f64),
    /// On each contact edge its own, such that kappa is this number on each triangle with edges on Gamma_C: one sliver does
    /// not set gamma for the whole line. The same as [`Gamma0::Auto`] for 0.5 where all these triangles are alike.
    Local(f64),
}

/// How the contact terms are integrated along an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactQuadrature {
    /// Cut at the roots of P: no quadrature error.
    Exact,
    /// That many Gauss points on each edge.
    Gauss(usize),
}

/// When Newton's method stops, and what is to be proved. Written as `Settings { tolerance, ..Settings::default() }`, for
/// fields may come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The relative residual to reach.
    pub tolerance: f64,
    /// The most steps.
    pub max_iterations: usize,
    /// The distance from the exact solution of (8), relative and in the energy norm, that is to be proved; infinite where none
    /// is asked for.
    pub proof: f64,
}

impl Default for Method {
    fn default() -> Self {
        Method {
            degree: Degree::One,
            gamma0: Gamma0::Auto,
            quadrature: ContactQuadrature::Exact,
            allow_noncoercive: false,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Settings { tolerance: 1e-10, max_iterations: 200, proof: 1e-6 }
    }
}

/// The verdict on a solution.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The exact solution of (8) is within [`Settings::proof`] of it, rounding included.
    Proved,
    /// That is not proved, for this reason.
    NotProved(String),
}

impl Verdict {
    /// The verdict on a solution with this enclosure, of which a relative radius of `proof` is asked.
    pub fn new(enclosure: &enclosure::Certificate, proof: f64) -> Self {
        match enclosure {
            Ok(e) if e.is_within(proof) => Verdict::Proved,
            Ok(e) => {
                let known = match e.relative {
                    Some(relative) => format!("{relative:.0e} of the energy norm"),
                    None => format!("{:.0e} (energy norm)", e.radius),
                };
                Verdict::NotProved(format!(
                    "the solution of (8) is proved to be within {known}; expected within {proof:e}"
                ))
            }
            Err(why) => Verdict::NotProved(why.to_string()),
        }
    }

    /// "proved" or "not proved".
    pub fn name(&self) -> &'static str {
        match self {
            Verdict::Proved => "proved",
            Verdict::NotProved(_) => "not proved",
        }
    }

    /// Why nothing is proved.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Verdict::Proved => None,
            Verdict::NotProved(reason) => Some(reason),
        }
    }
}

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
pub enum Status {
    /// The residual is within the tolerance.
    #[cfg_attr(feature = "files", serde(rename = "converged"))]
    Converged,
    /// The tolerance asks for more than rounding allows.
    #[cfg_attr(feature = "files", serde(rename = "converged to rounding"))]
    ConvergedToRounding,
}

/// How Newton's method went.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonReport {
    /// How it ended.
    pub status: Status,
    /// The residual of (8), as Newton's method saw it, before the first step and after each one: Euclidean norms over the
    /// free degrees of freedom, relative to |L| + |residual of the prescribed data|.
    pub residuals: Vec<f64>,
    /// The relative residual of the solution, evaluated from the definitions.
    pub residual: f64,
    /// How many sparse factorisations it took.
    pub factorizations: usize,
}

impl NewtonReport {
    /// How many steps were taken.
    pub fn iterations(&self) -> usize {
        self.residuals.len().saturating_sub(1)
    }
}

/// By which route the solution was found, and how far it can be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
pub struct MethodReport {
    /// The route.
    pub route: RouteName,
    /// Multiplications with an addition that were predicted for it.
    pub predicted_operations: f64,
    /// The condition number of the matrix, estimated from below.
    pub condition: f64,
    /// The last correction of the displacement in the energy norm, relative to the displacement: an estimate of the error
    /// that rounding and iteration leave; infinite, and left out of result.json, where the steps ended before there was one.
    #[cfg_attr(
        feature = "files",
        serde(default = "no_estimate", skip_serializing_if = "is_no_estimate")
    )]
    pub forward_error: f64,
    /// How many threads worked.
    pub threads: usize,
    /// Independent motions of the body that neither supports nor what presses stops: the solution is one up to these, and the
    /// one of least norm is given. Friction would be needed to know more.
    pub slides: usize,
}

#[cfg(feature = "files")]
fn no_estimate() -> f64 {
    f64::INFINITY
}

#[cfg(feature = "files")]
fn is_no_estimate(error: &f64) -> bool {
    *error == no_estimate()
}

/// How a solution was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Newton's method.
    pub newton: NewtonReport,
    /// The route and the accuracy.
    pub method: MethodReport,
    /// Where the exact solution of (8) is, or why nothing is proved of it.
    pub enclosure: enclosure::Certificate,
    /// The verdict.
    pub verdict: Verdict,
    /// How far a body that contact holds may still move.
    pub plays: Vec<Play>,
}

/// Why there is no solution.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum SolveError {
    #[error(transparent)]
    Data(#[from] DataError),
    #[error(
        "gamma0 = {} gives kappa = {}, and coercivity needs kappa < 1: expected gamma0 below {}, the limit set by the contact edge from ({}, {}) to ({}, {}); lower gamma0, say \"auto\", or set allow_noncoercive = true to go on without any promise",
        number(*gamma0), fixed(*kappa, 4), number(*limit), number(edge[0][0]), number(edge[0][1]), number(edge[1][0]), number(edge[1][1])
    )]
    NotCoercive { gamma0: f64, kappa: f64, limit: f64, edge: [[f64; 2]; 2] },
    #[error(
        "the tangent is not positive definite: gamma0 is beyond the true limit of coercivity, J_h is not convex and a solution need not exist; lower gamma0"
    )]
    NotPositiveDefinite,
    #[error(
        "no convergence: the relative residual is {residual:.1e} after {} Newton step{}, all that max_iterations allows; expected {}\nresiduals: {}",
        residuals.len().saturating_sub(1), if residuals.len() == 2 { "" } else { "s" }, awaited(*residual, *tolerance), history(residuals)
    )]
    NotConverged { residual: f64, residuals: Vec<f64>, tolerance: f64 },
    #[error(
        "the body is too slender, too nearly incompressible or too weakly held for double precision: with a condition number of at least {condition:.0e} {}; a coarser mesh or a shorter body conditions it better",
        known(*forward_error)
    )]
    IllConditioned { condition: f64, forward_error: f64 },
    #[error(
        "the matrix has no Cholesky factor in double precision although the method is coercive: the body is too slender, too nearly incompressible or too weakly held (condition number beyond 1e15); a coarser mesh or a shorter body conditions it better"
    )]
    Singular,
    #[error(
        "the numbers of this case would over- or underflow double precision; expected lengths from 1e-40 to 1e40, moduli from 1e-80 to 1e80, and energies (modulus times squared displacement) from 1e-270 to 1e270: choose other units"
    )]
    OutOfRange,
    #[error("the solution needs {bytes} bytes of memory, more than there are; use a coarser mesh")]
    OutOfMemory { bytes: u64 },
}

fn known(forward_error: f64) -> String {
    if forward_error < 1.0 {
        format!("the displacement is known to a relative error of {forward_error:.0e} only")
    } else {
        "no digit of the displacement is known".to_owned()
    }
}

/// The target that a solve did not reach before it ran out of steps.
fn awaited(residual: f64, tolerance: f64) -> String {
    if residual <= tolerance {
        "a proof of the solution, too".to_owned()
    } else {
        format!("at most {tolerance:e}")
    }
}

/// The residuals from step to step, to one digit.
pub fn history(residuals: &[f64]) -> String {
    residuals.iter().map(|r| format!("{r:.0e}")).collect::<Vec<_>>().join(" ")
}

impl SolveError {
    /// Whether the case is wrong. Otherwise it is right, but there is no solution of it here.
    pub fn is_wrong_case(&self) -> bool {
        match self {
            SolveError::Data(DataError::Mesh(MeshError::OutOfMemory(_))) => false,
            SolveError::Data(_) | SolveError::NotCoercive { .. } => true,
            SolveError::NotPositiveDefinite
            | SolveError::NotConverged { .. }
            | SolveError::IllConditioned { .. }
            | SolveError::Singular
            | SolveError::OutOfRange
            | SolveError::OutOfMemory { .. } => false,
        }
    }
}

/// Solves `problem` by method (8).
///
/// # Errors
/// Data that don't make a problem, kappa >= 1 without leave, a tangent that is not positive definite (only with leave),
/// a tolerance that is not met within the allowed steps, an answer that doubles cannot represent, lack of memory.
pub fn solve(
    problem: &Problem,
    method: &Method,
    settings: &Settings,
) -> Result<(Solution, Times), SolveError> {
    solve_along(problem, method, settings, Course::default())
}

/// Solves from a given start, or with an observer. A start that leads nowhere is left for the usual one.
///
/// # Errors
/// As [`solve`].
pub fn solve_along(
    problem: &Problem,
    method: &Method,
    settings: &Settings,
    course: Course,
) -> Result<(Solution, Times), SolveError> {
    settings.check()?;
    match method.degree {
        Degree::One => solve_with::<P1, 3, 2>(problem, method, settings, course),
        Degree::Two => solve_with::<P2, 6, 3>(problem, method, settings, course),
    }
}

fn solve_with<E, const N: usize, const M: usize>(
    problem: &Problem,
    method: &Method,
    settings: &Settings,
    course: Course,
) -> Result<(Solution, Times), SolveError>
where
    E: ExactEdge<f64, N, M>,
{
    let mut watch = Stopwatch::start();
    course.enters(Phase::Assemble);
    // What the whole solve takes for each vertex of the mesh at least, as measured: on squares, and on strips more.
    let per_vertex = if E::DEGREE == 1 { 2900 } else { 11_800 };
    memory::ensure(per_vertex * problem.mesh.vertices().len() as u64)?;
    let d = discretize::<E, N, M>(problem, method)?;
    let discretize = watch.lap();
    let (evaluated, report, times) =
        match (solve_discrete_along(&d, settings, course), course.afresh()) {
            (Err(_), Some(afresh)) => solve_discrete_along(&d, settings, afresh)?,
            (solved, _) => solved?,
        };
    course.enters(Phase::Evaluate);
    watch.lap();
    let solution = Solution::new(&d, evaluated, report);
    let displacement = solution.quantities.max_displacement;
    if is_out_of_range(stiffest(problem) * displacement * displacement, 1e270) {
        return Err(SolveError::OutOfRange);
    }
    Ok((solution, Times { discretize, evaluate: watch.lap(), ..times }))
}

/// Whether a number is positive and not between 1/far and far.
fn is_out_of_range(x: f64, far: f64) -> bool {
    x > 0.0 && !(1.0 / far..=far).contains(&x)
}

/// The largest lambda + 2 mu.
fn stiffest(problem: &Problem) -> f64 {
    problem.material.distinct().iter().map(Material::normal_stiffness).fold(0.0, f64::max)
}

/// Whether the products of the lengths and moduli of a problem, some of each, are normal doubles, as far as the numbers are
/// lengths and moduli at all.
fn can_be_multiplied(problem: &Problem) -> bool {
    let extent = |c: usize| {
        let coordinates = || problem.mesh.vertices().iter().map(|x| x[c]);
        let low = coordinates().fold(f64::INFINITY, f64::min);
        coordinates().fold(f64::NEG_INFINITY, f64::max) - low
    };
    let modulus = stiffest(problem);
    let can_be_a_modulus = modulus.is_infinite() || !is_out_of_range(modulus, 1e80);
    !is_out_of_range(extent(0).max(extent(1)), 1e40) && can_be_a_modulus
}

/// Solves a discretization: the displacement with its forces, how it was found, and how long that took.
///
/// # Errors
/// As [`solve`], but for the data.
pub fn solve_discrete<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    settings: &Settings,
) -> Result<(Evaluated<M>, Report, Times), SolveError>
where
    E: ExactEdge<f64, N, M>,
{
    solve_discrete_along(d, settings, Course::default())
}

fn solve_discrete_along<'d, E, const N: usize, const M: usize>(
    d: &'d Discretization<E, N, M>,
    settings: &Settings,
    course: Course<'d>,
) -> Result<(Evaluated<M>, Report, Times), SolveError>
where
    E: ExactEdge<f64, N, M>,
{
    let mut times = Times::default();
    let mut watch = Stopwatch::start();
    let system = System::on(d, course)?;
    times.matrix = watch.lap();
    let found = route::solve(&system, settings, &mut times);
    let (outcome, method, factorizations) = found?;
    let status = outcome.status(settings)?;
    let Outcome { u, forces, p, residuals, residual, enclosure, .. } = outcome;
    let mut evaluated = Evaluated::with(d, u, forces, &p);
    let newton = NewtonReport { status, residuals, residual, factorizations };
    let verdict = Verdict::new(&enclosure, settings.proof);
    let plays = evaluated.settle(d);
    let method = MethodReport { slides: plays.len(), ..method };
    Ok((evaluated, Report { newton, method, enclosure, verdict, plays }, times))
}

/// Builds and checks everything that [`solve`] needs, short of a matrix.
///
/// # Errors
/// As [`solve`], as far as they show before anything is solved.
pub fn check(problem: &Problem, method: &Method) -> Result<Outline, SolveError> {
    match method.degree {
        Degree::One => outline::<P1, 3, 2>(problem, method),
        Degree::Two => outline::<P2, 6, 3>(problem, method),
    }
}

fn outline<E, const N: usize, const M: usize>(
    problem: &Problem,
    method: &Method,
) -> Result<Outline, SolveError>
where
    E: ExactEdge<f64, N, M>,
{
    Ok(Outline::new(&discretize::<E, N, M>(problem, method)?))
}

/// The size of a discrete problem and its coercivity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outline {
    /// How many nodes there are; each has two degrees of freedom.
    pub nodes: usize,
    /// How many of the degrees of freedom are prescribed.
    pub prescribed: usize,
    /// How many edges Gamma_C has.
    pub contact_edges: usize,
    /// gamma0, kappa and where the limit comes from.
    pub gamma: GammaReport,
}

impl Outline {
    fn new<E, const N: usize, const M: usize>(d: &Discretization<E, N, M>) -> Self
    where
        E: ExactEdge<f64, N, M>,
    {
        Outline {
            nodes: d.space.nodes().len(),
            prescribed: d.constraints.values().iter().flatten().flatten().count(),
            contact_edges: d.contact.len(),
            gamma: GammaReport::new(d),
        }
    }
}

/// Method (8) on the problem's mesh.
///
/// # Errors
/// Data that don't make a problem, and kappa >= 1 without leave.
pub fn discretize<'a, E, const N: usize, const M: usize>(
    problem: &'a Problem,
    method: &Method,
) -> Result<Discretization<'a, E, N, M>, SolveError>
where
    E: ExactEdge<f64, N, M>,
{
    method.check()?;
    let mut limit = 1.0;
    let gamma = |c: &Coercivity| {
        limit = c.limit();
        match method.gamma0 {
            Gamma0::Auto => Gamma::Uniform(limit / 2.0),
            Gamma0::Value(gamma0) => Gamma::Uniform(gamma0),
            Gamma0::Local(kappa) => Gamma::Local(kappa),
        }
    };
    let rule = match method.quadrature {
        ContactQuadrature::Exact => EdgeRule::Exact,
        ContactQuadrature::Gauss(points) => EdgeRule::gauss(points),
    };
    let d = Discretization::new(problem, gamma, rule);
    if !can_be_multiplied(problem) {
        return Err(SolveError::OutOfRange);
    }
    let d = d?;
    if !limit.is_normal() {
        return Err(SolveError::OutOfRange);
    }
    if d.kappa() < 1.0 || method.allow_noncoercive {
        Ok(d)
    } else {
        Err(SolveError::NotCoercive {
            gamma0: d.gamma0,
            kappa: d.kappa(),
            limit: d.coercivity.limit(),
            edge: d.coercivity.limiting_edge,
        })
    }
}
