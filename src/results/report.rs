//! The course of a solve, and its verdict.

#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use crate::held::solvability::Play;
use crate::proof::enclosure::{Enclosure, Unproved};

/// The verdict on a solution.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The exact solution of (8) is within [`Settings::proof`](crate::solve::Settings::proof) of it, rounding included.
    Proved,
    /// No such distance is proved, for this reason.
    NotProved(String),
}

impl Verdict {
    /// The verdict on a solution with this enclosure, of which a relative radius of `proof` is asked.
    pub fn new(enclosure: &Result<Enclosure, Unproved>, proof: f64) -> Self {
        match enclosure {
            Ok(e) if e.is_within(proof) => Verdict::Proved,
            Ok(e) => {
                let known = match e.relative {
                    Some(relative) => format!("{relative:.0e} of the energy norm"),
                    None => format!(
                        "{:.0e} in the energy norm, and its own is not known to be more",
                        e.radius
                    ),
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

/// The routes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize), serde(rename_all = "lowercase"))]
pub enum RouteName {
    /// The body factored once, Newton's method on the contact functionals.
    Condensed,
    /// Newton's method on the displacement, the tangent factored in each step.
    Assembled,
}

/// The ways in which an iteration ends.
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

impl Status {
    /// "converged" or "converged to rounding".
    pub(crate) fn name(self) -> &'static str {
        match self {
            Status::Converged => "converged",
            Status::ConvergedToRounding => "converged to rounding",
        }
    }
}

/// The course of Newton's method.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
pub struct NewtonReport {
    /// The residual of (8), as Newton's method saw it, before the first step and after each one: Euclidean norms over the
    /// free degrees of freedom, relative to |L| + |residual of the prescribed data|.
    pub residuals: Vec<f64>,
    /// The relative residual of the solution, evaluated from the definitions.
    pub residual: f64,
    /// How many sparse factorisations it took.
    pub factorizations: usize,
    /// How the iteration ended.
    pub status: Status,
}

impl NewtonReport {
    /// How many steps were taken.
    pub fn iterations(&self) -> usize {
        self.residuals.len().saturating_sub(1)
    }
}

/// The route by which the solution was found, and how far it can be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
pub struct MethodReport {
    /// The route.
    pub route: RouteName,
    /// Multiplications with an addition that were predicted for it.
    pub predicted_operations: f64,
    /// The condition number of the matrix, estimated from below.
    pub condition: f64,
    /// The last correction of the displacement in the energy norm, relative to the displacement, times the share to which a pass takes an
    /// error down where a proof follows: an estimate of the error that rounding and iteration leave; infinite, and left out of result.json, where the steps ended before there was one.
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
    pub enclosure: Result<Enclosure, Unproved>,
    /// The verdict.
    pub verdict: Verdict,
    /// How far a body that contact holds may still move.
    pub plays: Vec<Play>,
}
