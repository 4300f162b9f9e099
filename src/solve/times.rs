//! The times of the parts of a solve.

use std::time::{Duration, Instant};

/// The time that the parts of a solve took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Times {
    /// Nodes, constraints, loads, contact edges.
    pub discretize: Duration,
    /// Order of elimination and matrix.
    pub matrix: Duration,
    /// Sparse Cholesky factorisation.
    pub factor: Duration,
    /// The contact functionals: X, G, y0.
    pub compliance: Duration,
    /// Newton's method, with the substitutions and residuals of all passes.
    pub newton: Duration,
    /// The residual of the solution in the full system, and its reference.
    pub judge: Duration,
    /// Enclosing the exact solution of (8).
    pub certify: Duration,
    /// Stresses, contact pressure, resultants.
    pub evaluate: Duration,
}

impl Times {
    /// Adds the times of two solves.
    #[must_use]
    pub(crate) fn plus(&self, other: &Times) -> Times {
        Times {
            discretize: self.discretize + other.discretize,
            matrix: self.matrix + other.matrix,
            factor: self.factor + other.factor,
            compliance: self.compliance + other.compliance,
            newton: self.newton + other.newton,
            judge: self.judge + other.judge,
            certify: self.certify + other.certify,
            evaluate: self.evaluate + other.evaluate,
        }
    }

    /// All that comes before the factorisation.
    pub fn assemble(&self) -> Duration {
        self.discretize + self.matrix
    }

    /// From the factorisation to a solution that has been judged.
    pub fn solve(&self) -> Duration {
        self.factor + self.compliance + self.newton + self.judge
    }
}

/// Measures the time since its last use.
pub(crate) struct Stopwatch(Instant);

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Stopwatch(Instant::now())
    }

    pub(crate) fn lap(&mut self) -> Duration {
        let now = Instant::now();
        let lap = now - self.0;
        self.0 = now;
        lap
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_but_those_after_the_solution_counts_once_in_the_two_sums() {
        // Powers of two: a sum tells its terms.
        let [discretize, matrix, factor, compliance, newton, judge, certify, evaluate] =
            [1, 2, 4, 8, 16, 32, 64, 128].map(Duration::from_secs);
        let times =
            Times { discretize, matrix, factor, compliance, newton, judge, certify, evaluate };
        assert_eq!(times.assemble().as_secs(), 1 + 2);
        assert_eq!(times.solve().as_secs(), 4 + 8 + 16 + 32);
        let twice = times.plus(&times);
        assert_eq!((twice.assemble(), twice.solve()), (times.assemble() * 2, times.solve() * 2));
        assert_eq!((twice.certify, twice.evaluate), (certify * 2, evaluate * 2));
    }
}
