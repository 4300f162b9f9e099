//! A case solved as it asks to be: on its own mesh, or on meshes that are adapted to a target.

use std::time::Instant;

use super::case::Case;
use super::input::Failure;
use super::result::Adaptation;
use crate::certificates::adapt::{AdaptError, Stage};
use crate::certificates::{CertifyError, Continuous, adapt, certify_with};
use crate::results::Solution;
use crate::solve::{Course, Kept, SolveError, Times, solve_along};

/// A case that is solved.
#[derive(Debug)]
pub struct Solved {
    /// The solution, on the mesh that the case has now.
    pub solution: Solution,
    /// The time that it took.
    pub times: Times,
    /// The bound of the distance to the true solution, where the mesh was adapted to it or it was asked for.
    pub certified: Option<Result<Continuous, CertifyError>>,
    /// The adaptation of the mesh to it, if it was adapted.
    pub adaptation: Option<Adaptation>,
}

impl From<(Solution, Times)> for Solved {
    fn from((solution, times): (Solution, Times)) -> Self {
        Solved { solution, times, certified: None, adaptation: None }
    }
}

impl Solved {
    /// Certifies the solution, unless that has been done.
    pub fn certify(&mut self, case: &Case) {
        if self.certified.is_none() {
            let start = Instant::now();
            self.certified = Some(certify_with(&case.problem, &self.solution, &case.asked));
            self.times.certify += start.elapsed();
        }
    }
}

impl From<SolveError> for Failure {
    fn from(error: SolveError) -> Failure {
        Failure::new(error.is_wrong_case(), error)
    }
}

impl From<AdaptError> for Failure {
    fn from(error: AdaptError) -> Failure {
        Failure::new(error.is_wrong_case(), format!("[adapt]: {error}"))
    }
}

/// The data that a run leaves for the next one.
#[derive(Default)]
pub struct Earlier {
    /// Where the next one starts.
    pub(crate) start: Option<Solution>,
    /// Bounds that still hold if loads and gaps alone are others.
    pub(crate) kept: Kept,
}

impl Earlier {
    fn leads<'a>(&'a self, course: Course<'a>) -> Course<'a> {
        let course = course.keeping(&self.kept);
        self.start.as_ref().map_or(course, |start| course.from_displacement(&start.displacement))
    }
}

/// Solves `case`, with what an `earlier` run has left if the mesh stays as it is; an adapted mesh takes the place of its own.
/// `watcher` is told of each stage.
pub fn solve(
    mut case: Case,
    earlier: Option<&Earlier>,
    watcher: &dyn Fn(Stage),
) -> Result<(Case, Solved), Failure> {
    if !case.steps.is_empty() {
        return Err(Failure::wrong(
            "found [[step]], load steps that follow each other; expected a case without, or the command 'signorini solve'",
        ));
    }
    let Some((target, force)) = case.adapt.clone() else {
        let of_solve = |phase| watcher(Stage::Solve(phase));
        let course = Course::default().watched_by(&of_solve);
        let course = earlier.map_or(course, |earlier| earlier.leads(course));
        let solved = solve_along(&case.problem, &case.method, &case.settings, course)
            .map_err(|error| error.of_thickness(case.thickness))?;
        let mut solved = Solved::from(solved);
        if case.asks_for_certificate() {
            watcher(Stage::Certify(0));
            solved.certify(&case);
        }
        return Ok((case, solved));
    };
    let goal = (target, force.as_deref());
    let how = (&case.method, &case.settings);
    let thickness = case.thickness;
    let (problem, adapted) = adapt::adapt_to(case.problem, how, goal, &case.asked, watcher)
        .map_err(|error| match error {
            AdaptError::Solve { level, error } => {
                AdaptError::Solve { level, error: error.of_thickness(thickness) }
            }
            other => other,
        })?;
    case.problem = problem;
    let adaptation = Adaptation {
        target: target.relative,
        force,
        met: adapted.unmet.is_none(),
        reason: adapted.unmet,
        level: adapted.level,
        levels: adapted.levels,
    };
    let (solution, mut times) = (adapted.solution, adapted.times);
    times.certify += adapted.certifying;
    let certified = Some(adapted.certified);
    Ok((case, Solved { solution, times, certified, adaptation: Some(adaptation) }))
}
