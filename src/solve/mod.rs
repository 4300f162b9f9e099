//! The solution of method (8).
//!
//! 1. Discretize ([`discretize`]): V^h, the data on Gamma_D, L, Gamma_C with gamma; kappa < 1, or the case is refused.
//! 2. Assemble ([`System`]): an order of elimination, the matrix A, the structure of its factor, the rows of P0.
//! 3. Newton's method on J_h with an exact line search ([`newton`]), from soft springs to stiff ones, by the [`route`] that
//!    takes less: the body condensed to its contact edges, or the tangent factored in each step.
//! 4. Refine and verify ([`accuracy::refine`]): corrections from the true residual until the enclosure of the exact solution of
//!    (8) is as narrow as asked for ([`enclosure`]); the other route where the first proves too little.
//! 5. Report ([`solution`]): stresses, contact pressure, resultants, and the verdict, which is the proof.
//!
//! docs/theory.md: 4 has Newton's method, 5 the routes and the refinement, 7.5 the enclosure.

#[doc(hidden)]
pub mod accuracy;
#[doc(hidden)]
pub mod answers;
#[doc(hidden)]
pub mod assembled;
#[doc(hidden)]
pub mod balls;
#[doc(hidden)]
pub mod body;
#[doc(hidden)]
pub mod compliance;
pub mod condensed;
#[doc(hidden)]
pub mod coulomb;
#[doc(hidden)]
pub mod course;
#[doc(hidden)]
pub mod enclosure;
mod error;
#[doc(hidden)]
pub mod factor;
#[doc(hidden)]
pub mod intervals;
mod isolated;
#[doc(hidden)]
pub mod iterate;
mod method;
pub mod newton;
#[doc(hidden)]
pub mod ordering;
#[doc(hidden)]
pub mod pressed;
mod report;
#[doc(hidden)]
pub mod route;
#[doc(hidden)]
pub mod solution;
#[doc(hidden)]
pub mod stresses;
#[doc(hidden)]
pub mod system;
mod times;
mod whole;

use self::accuracy::Outcome;
pub use self::answers::{ContactBoundary, EnergyBalance};
pub use self::course::{Course, Phase};
pub use self::enclosure::{Enclosure, Unproved};
pub use self::error::{SolveError, history};
pub use self::intervals::Intervals;
use self::iterate::Evaluated;
pub use self::method::{
    ContactQuadrature, Gamma0, MOST_GAUSS_POINTS, MOST_ITERATIONS, Method, Settings,
};
pub use self::report::{MethodReport, NewtonReport, Report, RouteName, Status, Verdict};
use self::route::Strategy;
pub use self::solution::{GammaReport, Quantities, Solution};
pub use self::stresses::{Extreme, LargestStresses};
use self::system::System;
use self::times::Stopwatch;
pub use self::times::Times;
pub use crate::fem::Degree;
use crate::fem::contact_line::{Coercivity, Gamma};
use crate::fem::held;
use crate::fem::material::largest_entry;
use crate::fem::{Discretization, EdgeRule, Problem};
use crate::memory;

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
    let mut watch = Stopwatch::start();
    course.enters(Phase::Assemble);
    // What the whole solve takes for each vertex of the mesh at least, as measured: on squares, and on strips more.
    let per_vertex = if method.degree == Degree::One { 2900 } else { 11_800 };
    memory::check(per_vertex * problem.mesh.vertices().len() as u64)?;
    let d = discretize(problem, method)?;
    let discretize = watch.lap();
    let solved = solve_discrete_along(&d, settings, course);
    let (evaluated, report, times) = match course.afresh() {
        Some(afresh) => solved.or_else(|_| solve_discrete_along(&d, settings, afresh))?,
        None => solved?,
    };
    course.enters(Phase::Evaluate);
    watch.lap();
    let solution = Solution::new(&d, evaluated, report);
    let displacement = solution.quantities.max_displacement;
    let size = stiffest(problem) * displacement * displacement;
    if is_out_of_range(size, 1e270) {
        return Err(SolveError::OutOfRange);
    }
    let EnergyBalance { strain, loads, supports, contact, imbalance } = solution.balance;
    let is_rounding =
        [strain, loads, supports, contact].iter().all(|e| e.abs() <= f64::EPSILON * size);
    let unproved = solution.verdict != Verdict::Proved;
    if unproved && !is_rounding && !(imbalance.abs() <= MOST_IMBALANCE) {
        let MethodReport { condition, .. } = solution.method;
        return Err(SolveError::IllConditioned { condition, forward_error: imbalance.abs() });
    }
    Ok((solution, Times { discretize, evaluate: watch.lap(), ..times }))
}

/// Energies that are more out of balance than this are no result.
const MOST_IMBALANCE: f64 = 0.1;

/// Solves a discretization: the displacement with its forces, how it was found, and how long that took.
///
/// # Errors
/// As [`solve`], but for the data.
pub fn solve_discrete(
    d: &Discretization,
    settings: &Settings,
) -> Result<(Evaluated, Report, Times), SolveError> {
    solve_discrete_along(d, settings, Course::default())
}

fn solve_discrete_along<'d>(
    d: &'d Discretization,
    settings: &Settings,
    course: Course<'d>,
) -> Result<(Evaluated, Report, Times), SolveError> {
    let mut times = Times::default();
    let mut watch = Stopwatch::start();
    let system = System::on(d, course)?;
    times.matrix = watch.lap();
    let strategy = Strategy::new(&system)?;
    times.judge = watch.lap();
    let mut best: Result<(RouteName, Outcome), _> = Err(SolveError::Singular);
    for &name in strategy.routes() {
        let found = strategy.solve(name, settings, &mut times).map(|outcome| (name, outcome));
        best = match (best, found) {
            (Ok(first), Ok(second)) if second.1.is_better_than(&first.1) => Ok(second),
            (Ok(first), _) => Ok(first),
            (Err(_), second) => second,
        };
        let is_final = match &best {
            Ok((_, outcome)) => outcome.is_final(settings),
            // Contact may hold what the supports hardly hold: the next route knows it.
            Err(error) => *error != SolveError::Singular,
        };
        if is_final {
            break;
        }
    }
    let (route, outcome) = best?;
    let verdict = Verdict::new(&outcome.enclosure, settings.proof);
    let newton = NewtonReport {
        status: outcome.status(settings)?,
        residuals: outcome.residuals,
        residual: outcome.residual,
        factorizations: outcome.factorizations,
    };
    let mut evaluated = Evaluated::with(d, outcome.u, outcome.forces, &outcome.p);
    let plays = evaluated.settle(d);
    let method = MethodReport {
        route,
        predicted_operations: strategy.predicted(route),
        condition: outcome.condition,
        forward_error: outcome.forward_error,
        threads: 1,
        slides: plays.len(),
    };
    let enclosure = outcome.enclosure;
    Ok((evaluated, Report { newton, method, enclosure, verdict, plays }, times))
}

/// Builds and checks everything that [`solve`] needs, short of a matrix.
///
/// # Errors
/// As [`solve`], as far as they show before anything is solved.
pub fn check(problem: &Problem, method: &Method) -> Result<Outline, SolveError> {
    Ok(Outline::new(&discretize(problem, method)?))
}

/// The size of a discrete problem and its coercivity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outline {
    /// The number of nodes; each has two degrees of freedom.
    pub nodes: usize,
    /// How many of the degrees of freedom are prescribed.
    pub prescribed: usize,
    /// How many edges Gamma_C has.
    pub contact_edges: usize,
    /// How many rigid motions the supports leave free.
    pub free_motions: usize,
    /// How many of them contact does not stop either.
    pub slides: usize,
    /// gamma0, kappa and where the limit comes from.
    pub gamma: GammaReport,
}

impl Outline {
    fn new(d: &Discretization) -> Self {
        Outline {
            nodes: d.space.nodes().len(),
            prescribed: d.constraints.values().iter().flatten().flatten().count(),
            contact_edges: d.contact.len(),
            free_motions: d.motions.len(),
            slides: d.slides.as_ref().map_or(0, |slides| slides.basis.len()),
            gamma: GammaReport::new(d),
        }
    }
}

/// Method (8) on the problem's mesh.
///
/// # Errors
/// Data that don't make a problem, supports that hold the body inside its obstacle, and kappa >= 1 without leave.
pub fn discretize<'a>(
    problem: &'a Problem,
    method: &Method,
) -> Result<Discretization<'a>, SolveError> {
    let d = discretize_any(problem, method)?;
    held::check(&d)?;
    Ok(d)
}

/// As [`discretize`], of a problem that no displacement of finite energy solves, too: (8) has a solution on every mesh.
///
/// # Errors
/// As [`discretize`].
#[doc(hidden)]
pub fn discretize_any<'a>(
    problem: &'a Problem,
    method: &Method,
) -> Result<Discretization<'a>, SolveError> {
    method.check()?;
    let mut limit = 1.0;
    let gamma = |c: &Coercivity| {
        limit = c.limit();
        match method.gamma0 {
            // The springs between a stiff body and a soft one are those of the soft one.
            Gamma0::Auto if !problem.pairs.is_empty() => Gamma::Local(0.5),
            Gamma0::Auto => Gamma::Uniform(limit / 2.0),
            Gamma0::Value(gamma0) => Gamma::Uniform(gamma0),
            Gamma0::Local(kappa) => Gamma::Local(kappa),
        }
    };
    let rule = match method.quadrature {
        ContactQuadrature::Exact => EdgeRule::Exact,
        ContactQuadrature::Gauss(points) => EdgeRule::gauss(points),
    };
    let d = Discretization::new(problem, method.degree, gamma, rule);
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

/// Returns whether a number is positive and not between 1/far and far.
fn is_out_of_range(x: f64, far: f64) -> bool {
    x > 0.0 && !(1.0 / far..=far).contains(&x)
}

/// The largest entry of a law.
fn stiffest(problem: &Problem) -> f64 {
    problem.material.distinct().iter().map(largest_entry).fold(0.0, f64::max)
}

/// Returns whether the products of the lengths and moduli of a problem, some of each, are normal doubles, as far as the numbers
/// are lengths and moduli at all.
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
