//! The solution of method (8).
//!
//! 1. Discretize ([`discretize`]): V^h, the data on Gamma_D, L, Gamma_C with gamma; kappa < 1, or the case is refused.
//! 2. Assemble ([`System`]): an order of elimination, the matrix A, the structure of its factor, the rows of P0.
//! 3. Newton's method on J_h with an exact line search ([`newton`]), from soft springs to stiff ones, by the [`route`] that
//!    takes less: the body condensed to its contact edges, or the tangent factored in each step.
//! 4. Refine and verify ([`accuracy::refine`]): corrections from the true residual until the enclosure of the exact solution of
//!    (8) is as narrow as asked for ([`crate::proof::enclosure`]); the other route where the first proves too little.
//! 5. Report ([`crate::results`]): stresses, contact pressure, resultants, and the verdict, which is the proof.
//!
//! docs/theory.md: 4 has Newton's method, 5 the routes and the refinement; docs/a-posteriori.md, 7.5, has the enclosure.

pub mod accuracy;
pub mod assembled;
pub(crate) mod body;
pub mod condensed;
pub(crate) mod coulomb;
mod course;
mod error;
pub mod iterate;
mod method;
pub mod newton;
pub mod route;
mod setup;
pub(crate) mod times;

pub use self::course::{Course, Kept, Phase};
pub use self::error::SolveError;
pub use self::method::{
    ContactQuadrature, Gamma0, MOST_GAUSS_POINTS, MOST_ITERATIONS, Method, Settings,
};
pub use self::setup::{Outline, check, discretize, discretize_any};
pub use self::times::Times;

use self::accuracy::Outcome;
use self::iterate::Evaluated;
use self::route::Strategy;
use self::setup::{is_out_of_range, stiffest};
use self::times::Stopwatch;
use crate::contact::Discretization;
use crate::linear::system::System;
use crate::memory;
use crate::model::{Degree, Problem};
use crate::results::{
    EnergyBalance, MethodReport, NewtonReport, Report, RouteName, Solution, Verdict,
};

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

/// The relative imbalance of energies above which there is no result.
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
            // Contact may hold what the supports hardly hold, and the next route includes contact.
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
