//! A path as an SMT-LIB 2 problem: "unsat" says that the path is impossible. For solvers that know nothing of this engine.

use std::fmt::Write;

use super::explorer::{Path, Sense};

/// The facts of `path` as a problem in nonlinear real arithmetic. `names` are those of the unknowns; inverses follow as
/// `inverse_0`, ...
pub fn problem(path: &Path, names: &[&str], head: &str) -> String {
    let mut all: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
    all.extend((names.len()..path.variables).map(|i| format!("inverse_{}", i - names.len())));
    let mut text = format!("{head}(set-logic QF_NRA)\n");
    for name in &all {
        let _ = writeln!(text, "(declare-const {name} Real)");
    }
    for fact in &path.facts {
        let sense = match fact.sense {
            Sense::Positive => ">",
            Sense::Nonnegative => ">=",
            Sense::Zero => "=",
        };
        let _ = writeln!(text, "(assert ({sense} {} 0.0))", fact.polynomial.smt(&all));
    }
    text + "(check-sat)\n"
}
