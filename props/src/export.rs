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

/// Writes every proof as text into `directory`, one file `NAME.proof` each, and answers how many.
///
/// # Errors
/// A statement that is not proved, and whatever keeps the files from being written.
pub fn certificates(directory: &std::path::Path) -> io::Result<usize> {
    std::fs::create_dir_all(directory)?;
    let mut seen = BTreeSet::new();
    for check in claims::all().iter().flat_map(|claim| &claim.checks) {
        let (Subject::Statement(statement), Engine::Proof, false) =
            (check.subject, check.engine, check.control)
        else {
            continue;
        };
        if seen.insert(statement.name) {
            let text = transcript(&statement).map_err(io::Error::other)?;
            std::fs::write(directory.join(format!("{}.proof", statement.name)), text)?;
        }
    }
    Ok(seen.len())
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
        if !matches!(check.engine, Engine::Proof | Engine::Doubles)
            || !seen.insert((check.engine, statement.name))
        {
            continue;
        }
        if check.engine == Engine::Doubles {
            for (name, problem) in in_doubles(&statement, check.control) {
                std::fs::write(directory.join(name), problem)?;
                count += 1;
            }
            continue;
        }
        if !check.control {
            for (name, problem) in of_paths(&statement) {
                std::fs::write(directory.join(name), problem)?;
                count += 1;
            }
            continue;
        }
        let analysis = analyse(&statement);
        for (i, fate) in &analysis.fates {
            let expected = match fate {
                Fate::Impossible(_) => "unsat",
                Fate::Refuted(_) => "sat",
                Fate::Open => "unknown",
            };
            let (name, problem) = of_path(&statement, *i, &analysis.paths[*i], expected);
            std::fs::write(directory.join(name), problem)?;
            count += 1;
        }
    }
    Ok(count)
}
