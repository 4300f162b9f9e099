//! Why there is no solution.

use thiserror::Error;

use crate::linear::matrix::OutsidePattern;
use crate::memory::OutOfMemory;
use crate::model::{DataError, MeshError};
use crate::quote::{fixed, number};

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
        "the body is too slender, too nearly incompressible or too weakly held (as by contact under a load that nearly tips it over) for double precision: with a condition number of at least {condition:.0e} {}; a coarser mesh or a shorter body conditions it better",
        known(*forward_error)
    )]
    IllConditioned { condition: f64, forward_error: f64 },
    #[error(
        "the matrix has no Cholesky factor in double precision although the method is coercive: the body is too slender, too nearly incompressible or too weakly held, as by contact under a load that nearly tips it over (condition number beyond 1e15); a coarser mesh or a shorter body conditions it better"
    )]
    Singular,
    #[error(
        "the numbers of this case would over- or underflow double precision; expected lengths from 1e-40 to 1e40, moduli from 1e-80 to 1e80, and energies (modulus times squared displacement) from 1e-270 to 1e270: choose other units"
    )]
    OutOfRange,
    #[error(
        "no solution with Coulomb's friction was found: the smallest relative residual is {residual:.1e} after {factorizations} factorisations; one exists, for every coefficient (docs/theory.md, 13.4). Try a smaller coefficient, a finer mesh, or friction = {{ tresca = .. }} with the shear stress that you expect"
    )]
    NoFrictionSolution { residual: f64, factorizations: usize },
    #[error(transparent)]
    OutsidePattern(#[from] OutsidePattern),
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

impl From<OutOfMemory> for SolveError {
    fn from(lack: OutOfMemory) -> Self {
        SolveError::OutOfMemory { bytes: lack.needed }
    }
}

/// The target that a solve missed when its steps ran out.
fn awaited(residual: f64, tolerance: f64) -> String {
    if residual <= tolerance {
        "a proof of the solution, too".to_owned()
    } else {
        format!("at most {tolerance:e}")
    }
}

/// The residuals from step to step, to one digit.
fn history(residuals: &[f64]) -> String {
    residuals.iter().map(|r| format!("{r:.0e}")).collect::<Vec<_>>().join(" ")
}

impl SolveError {
    /// The error of a body of this thickness, if that is given, from the one of a unit of thickness.
    #[must_use]
    pub(crate) fn of_thickness(mut self, thickness: Option<f64>) -> Self {
        if let SolveError::Data(DataError::RigidMotion { drive: Some(drive), .. }) = &mut self {
            *drive *= thickness.unwrap_or(1.0);
        }
        self
    }

    /// Returns whether the case is wrong. Otherwise it is right, but there is no solution of it here.
    pub fn is_wrong_case(&self) -> bool {
        match self {
            SolveError::Data(DataError::Mesh(MeshError::OutOfMemory(_))) => false,
            SolveError::Data(_) | SolveError::NotCoercive { .. } => true,
            SolveError::NotPositiveDefinite
            | SolveError::NotConverged { .. }
            | SolveError::IllConditioned { .. }
            | SolveError::Singular
            | SolveError::OutOfRange
            | SolveError::NoFrictionSolution { .. }
            | SolveError::OutsidePattern(_)
            | SolveError::OutOfMemory { .. } => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_machine_or_the_method_lacks_is_no_wrong_case() {
        let lack = OutOfMemory { needed: 1 << 40, available: None };
        let edge = [[0.0; 2], [1.0, 0.0]];
        let residuals = vec![1.0, 0.1];
        for (error, is_wrong) in [
            (SolveError::Data(DataError::NoContact), true),
            (SolveError::Data(DataError::Mesh(MeshError::Empty)), true),
            (SolveError::NotCoercive { gamma0: 1.0, kappa: 2.0, limit: 0.5, edge }, true),
            (SolveError::Data(DataError::Mesh(MeshError::OutOfMemory(lack))), false),
            (SolveError::from(lack), false),
            (SolveError::NotPositiveDefinite, false),
            (SolveError::NotConverged { residual: 0.1, residuals, tolerance: 1e-10 }, false),
            (SolveError::IllConditioned { condition: 1e17, forward_error: 1.0 }, false),
            (SolveError::Singular, false),
            (SolveError::OutOfRange, false),
            (SolveError::NoFrictionSolution { residual: 0.1, factorizations: 3 }, false),
            (SolveError::OutsidePattern(OutsidePattern { row: 1, column: 2 }), false),
        ] {
            assert_eq!(error.is_wrong_case(), is_wrong, "{error}");
        }
    }
}
