//! A problem with an exact solution on finer and finer meshes, and the rates at which the errors fall.

use std::collections::BTreeMap;

use thiserror::Error;

use signorini::contact::Friction;
use signorini::exact::{Errors, Exact, Kind, body_force};
use signorini::model::{Degree, Mesh, MeshError, Perturbation, Problem, Space, Structured};
use signorini::results::Solution;
use signorini::solve::{
    ContactQuadrature, Gamma0, Method, Outline, Settings, SolveError, check, solve,
};

use crate::interpolation;

/// A family of meshes with all that is solved on them: level l has 2^l times as many cells along each axis as `body`.
#[derive(Clone, Debug)]
pub struct Ladder {
    /// The solution.
    pub solution: Exact,
    /// The condition on each boundary.
    pub kinds: BTreeMap<String, Kind>,
    /// The coarsest mesh.
    pub body: Structured,
    /// The displacement of the vertices; the seed of level l is the given one plus l.
    pub perturbation: Option<Perturbation>,
    /// By which variant of method (8).
    pub method: Method,
    /// The accuracy.
    pub settings: Settings,
}

/// Why a level has no result.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LadderError {
    /// Its mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Its solve.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

/// The result on one mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Level {
    /// The largest h_T.
    pub h: f64,
    /// Degrees of freedom: twice the nodes.
    pub unknowns: usize,
    /// The errors.
    pub errors: Errors,
    /// The number of Newton steps.
    pub newton_steps: usize,
    /// gamma0 of (7).
    pub gamma0: f64,
    /// kappa = gamma0 C_h.
    pub kappa: f64,
    /// The bound of [`a_priori::left`](crate::a_priori::left) by Theorem 3.5 with its number; for P1 with exact
    /// contact integrals, u in H^2 and kappa < 1.
    pub proved: Option<f64>,
}

/// The problem that `solution` solves on a mesh of its body.
pub fn problem(solution: &Exact, mesh: Mesh, kinds: &BTreeMap<String, Kind>) -> Problem {
    let conditions = kinds.iter().map(|(name, kind)| (name.clone(), kind.condition(solution)));
    let (material, force) = (*solution.material(), body_force(solution));
    let mut problem = Problem::new(mesh, material, force, conditions.collect());
    if let Some(bound) = solution.slip_bound() {
        for (name, _) in kinds.iter().filter(|(_, kind)| **kind == Kind::Contact) {
            problem = problem.with_friction(name, Friction::tresca(move |_| bound));
        }
    }
    problem
}

impl Ladder {
    /// The problem of a level.
    ///
    /// # Errors
    /// A mesh with too many cells, or with triangles that the perturbation turned over.
    pub fn problem(&self, level: usize) -> Result<Problem, MeshError> {
        let factor = u32::try_from(level).ok().and_then(|level| 1_usize.checked_shl(level));
        let moved = self
            .perturbation
            .map(|p| Perturbation { seed: p.seed.wrapping_add(level as u64), ..p });
        let mesh = self.body.refined(factor.unwrap_or(usize::MAX)).mesh(moved)?;
        Ok(problem(&self.solution, mesh, &self.kinds))
    }

    /// The size of a level's discrete problem, and its coercivity.
    ///
    /// # Errors
    /// The reason why it is no problem.
    pub fn outline(&self, level: usize) -> Result<Outline, LadderError> {
        let method = Method { allow_noncoercive: true, ..self.method.clone() };
        Ok(check(&self.problem(level)?, &method)?)
    }

    /// Fixes one gamma0 for the first `levels` levels: where it is "auto", half the smallest of their limits.
    /// The theory compares meshes at fixed gamma0, and the norms on Gamma_C are proportional to its square root.
    ///
    /// # Errors
    /// As [`Ladder::outline`].
    pub fn with_one_gamma0(mut self, levels: usize) -> Result<Self, LadderError> {
        if self.method.gamma0 == Gamma0::Auto {
            let mut limit = f64::INFINITY;
            for level in 0..levels {
                limit = limit.min(self.outline(level)?.gamma.coercivity.limit());
            }
            self.method.gamma0 = Gamma0::Value(limit / 2.0);
        }
        Ok(self)
    }

    /// Solves a level; also returns the problem and its discrete solution.
    ///
    /// # Errors
    /// No mesh, or no solution.
    pub fn solve(&self, level: usize) -> Result<(Level, Problem, Solution), LadderError> {
        let problem = self.problem(level)?;
        let (solution, _) = solve(&problem, &self.method, &self.settings)?;
        let newton = &solution.newton;
        let errors = Errors::of(&solution, &problem, &*self.solution);
        let mesh = &problem.mesh;
        let level = Level {
            h: (0..mesh.triangles().len()).map(|t| mesh.diameter(t)).fold(0.0, f64::max),
            unknowns: 2 * solution.nodes.len(),
            errors,
            newton_steps: newton.iterations(),
            gamma0: solution.gamma.gamma0,
            kappa: solution.gamma.kappa,
            proved: self.bound(&problem, &solution),
        };
        Ok((level, problem, solution))
    }
}

impl Ladder {
    /// [`interpolation::bound`] for the solution of `problem`, where it holds: without friction.
    fn bound(&self, problem: &Problem, solution: &Solution) -> Option<f64> {
        if self.method.degree != Degree::One
            || self.method.quadrature != ContactQuadrature::Exact
            || self.solution.slip_bound().is_some()
        {
            return None;
        }
        let space = Space::new(&problem.mesh, Degree::One);
        interpolation::bound(&space, &solution.pieces, &*self.solution, solution.gamma.kappa)
    }

    /// The rate that Theorem 3.5 and Remark 3.7 promise for the energy and contact norms: min(p, s - 1) for u in H^s.
    pub fn promised_rate(&self) -> f64 {
        (self.method.degree.number() as f64).min(self.solution.regularity() - 1.0)
    }
}

/// The rates between neighbours, log(error ratio) / log(h ratio). A rate between two zeros is NaN.
pub fn rates(h: &[f64], error: &[f64]) -> Vec<f64> {
    let pairs = h.windows(2).zip(error.windows(2));
    pairs.map(|(h, e)| (e[0] / e[1]).ln() / (h[0] / h[1]).ln()).collect()
}

/// The slope of the straight line through the points (log h, log error), by least squares.
pub fn fitted_slope(h: &[f64], error: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> = h.iter().zip(error).map(|(h, e)| (h.ln(), e.ln())).collect();
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let variance: f64 = points.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
    covariance / variance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_h_has_its_exponent_as_rate_and_slope() {
        let h = [0.5, 0.3, 0.1, 0.02];
        let error = h.map(|h: f64| 3.0 * h.powf(1.5));
        for rate in rates(&h, &error) {
            assert!((rate - 1.5).abs() < 1e-14);
        }
        assert!((fitted_slope(&h, &error) - 1.5).abs() < 1e-14);
    }
}
