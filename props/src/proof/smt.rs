//! The paths of a statement as SMT-LIB 2 problems: "unsat" says that the path is impossible. For solvers that know nothing of
//! this engine.

use std::fmt::Write;

use super::explorer::{Path, explore};
use super::float::problems;
use crate::statement::Statement;

/// The facts of `path` as a problem in nonlinear real arithmetic. `names` are those of the unknowns.
pub(super) fn problem(path: &Path, names: &[&str], head: &str) -> String {
    let all = path.names(names);
    let mut text = format!("{head}(set-logic QF_NRA)\n");
    for name in &all {
        let _ = writeln!(text, "(declare-const {name} Real)");
    }
    for fact in &path.facts {
        let (relation, polynomial) = (fact.sense.relation(), fact.polynomial.smt(&all));
        let _ = writeln!(text, "(assert ({relation} {polynomial} 0.0))");
    }
    text + "(check-sat)\n"
}

/// One path: the name of its file, and the problem.
pub fn of_path(statement: &Statement, i: usize, path: &Path, expected: &str) -> (String, String) {
    let head = format!("; {}, path {i}\n; expected: {expected}\n", statement.name);
    let problem = problem(path, statement.variables, &head);
    (format!("{}.{i}.smt2", statement.name), problem)
}

/// The failing paths of a statement that must hold: the names of their files, and the problems, all of which must be
/// impossible.
pub fn of_paths(statement: &Statement) -> Vec<(String, String)> {
    let paths = explore(statement.variables.len(), statement.symbolic);
    let failing = paths.iter().enumerate().filter(|(_, path)| path.verdict.fails());
    failing.map(|(i, path)| of_path(statement, i, path, "unsat")).collect()
}

/// The failing paths of a statement in doubles: the names of their files, and the problems.
pub fn in_doubles(statement: &Statement, control: bool) -> Vec<(String, String)> {
    let (name, expected) = (statement.name, if control { "unknown" } else { "unsat" });
    let problems = problems(statement.variables, statement.terms).into_iter().enumerate();
    let with_names = |(i, problem): (usize, String)| {
        let head = format!("; {name}, in doubles, path {i}\n; expected: {expected}\n");
        (format!("{name}.double.{i}.smt2"), head + &problem)
    };
    problems.map(with_names).collect()
}
