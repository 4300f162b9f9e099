//! The paths of the proofs as SMT-LIB 2 problems, for solvers that know nothing of the proof engine; and those of the
//! statements that are tested in doubles, over all finite doubles, for a floating-point solver.
//!
//! And the proofs as text, with their certificates, for the checker in `reference/`.
//!
//! One file per failing path. The head of a file says what to expect: `unsat` of a statement that must hold; of a control,
//! `unsat` where this engine has a certificate, `sat` where it has a point, `unknown` where it has neither. A solver that
//! contradicts it is news.

use std::collections::BTreeSet;
use std::io;

use crate::claim::{Engine, Subject};
use crate::claims;
use crate::proof::smt::{in_doubles, of_path, of_paths};
use crate::proof::{Fate, analyse, transcript};
use crate::statement::Statement;

/// Writes every proof as text into `directory`, one file `NAME.proof` each, and answers how many.
///
/// # Errors
/// A statement that is not proved, and whatever keeps the files from being written.
pub fn certificates(directory: &std::path::Path) -> io::Result<usize> {
    std::fs::create_dir_all(directory)?;
    let statements = claims::statements(Engine::Proof);
    for (name, statement) in &statements {
        let text = transcript(statement).map_err(io::Error::other)?;
        std::fs::write(directory.join(format!("{name}.proof")), text)?;
    }
    Ok(statements.len())
}

/// Writes the SMT-LIB problems into `directory` and answers how many.
///
/// # Errors
/// Whatever keeps them from being written.
pub fn export(directory: &std::path::Path) -> io::Result<usize> {
    std::fs::create_dir_all(directory)?;
    let (mut seen, mut count) = (BTreeSet::new(), 0);
    for check in claims::all().iter().flat_map(|claim| &claim.checks) {
        let Subject::Statement(statement) = check.subject else { continue };
        if !seen.insert((check.engine, statement.name)) {
            continue;
        }
        let problems = match (check.engine, check.control) {
            (Engine::Doubles, control) => in_doubles(&statement, control),
            (Engine::Proof, false) => of_paths(&statement),
            (Engine::Proof, true) => of_control(&statement),
            _ => Vec::new(),
        };
        count += problems.len();
        for (name, problem) in problems {
            std::fs::write(directory.join(name), problem)?;
        }
    }
    Ok(count)
}

/// The failing paths of a control, with what this engine finds of each.
fn of_control(statement: &Statement) -> Vec<(String, String)> {
    let analysis = analyse(statement);
    let one = |(i, fate): &(usize, Fate)| {
        let expected = match fate {
            Fate::Impossible(_) => "unsat",
            Fate::Refuted(_) => "sat",
            Fate::Open => "unknown",
        };
        of_path(statement, *i, &analysis.paths[*i], expected)
    };
    analysis.fates.iter().map(one).collect()
}
