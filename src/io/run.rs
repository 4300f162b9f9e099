//! A case solved as it asks to be: on its own mesh, or on meshes that are adapted to a target.

use thiserror::Error;

use super::case::Case;
use super::outputs::Certified;
use super::result::Adaptation;
use crate::certify::adapt::{self, AdaptError, Stage};
use crate::solve::{Course, Solution, SolveError, Times, solve_along};

/// A solved case.
#[derive(Debug)]
#[non_exhaustive]
pub struct Solved {
    /// The solution, on the mesh that the case has now.
    pub solution: Solution,
    /// The time that it took.
    pub times: Times,
    /// The bound of the distance to the true solution, where the mesh was adapted to it.
    pub certified: Option<Certified>,
}

/// Why a case is not solved.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum RunError {
    /// On its own mesh.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// On adapted meshes.
    #[error("[adapt]: {0}")]
    Adapt(#[from] AdaptError),
}

impl RunError {
    /// Returns whether the case is wrong. Otherwise it is right, but there is no solution of it here.
    pub fn is_wrong_case(&self) -> bool {
        match self {
            RunError::Solve(error) => error.is_wrong_case(),
            RunError::Adapt(error) => error.is_wrong_case(),
        }
    }
}

/// Solves `case`, from the `start` if there is one and the mesh stays as it is; an adapted mesh takes the place of its own. `watcher`
/// is told what goes on.
///
/// # Errors
/// Those of [`solve_along`], and of [`adapt::adapt`].
pub fn solve(
    mut case: Case,
    start: Option<&Solution>,
    watcher: &dyn Fn(Stage),
) -> Result<(Case, Solved), RunError> {
    let Some(target) = case.adapt else {
        let of_solve = |phase| watcher(Stage::Solve(phase));
        let course = Course::default().watched_by(&of_solve);
        let course = start.map_or(course, |start| course.from(start));
        let (solution, times) = solve_along(&case.problem, &case.method, &case.settings, course)?;
        return Ok((case, Solved { solution, times, certified: None }));
    };
    let goal = (target, case.adapt_force.as_deref());
    let how = (&case.method, &case.settings);
    let (problem, adapted) = adapt::adapt_to(case.problem, how, goal, &case.asked, watcher)?;
    case.problem = problem;
    let certified = Certified {
        result: adapted.certified,
        time: adapted.certifying,
        adaptation: Some(Adaptation {
            target: target.relative,
            force: case.adapt_force.clone(),
            met: adapted.unmet.is_none(),
            reason: adapted.unmet,
            level: adapted.level,
            levels: adapted.levels,
        }),
    };
    let (solution, times) = (adapted.solution, adapted.times);
    Ok((case, Solved { solution, times, certified: Some(certified) }))
}
