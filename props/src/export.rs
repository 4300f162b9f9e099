//! The statements that are tested in doubles as SMT-LIB 2 problems, over all finite doubles, for the floating-point solver
//! bitwuzla; and the proofs as text, with their certificates, for the checker in `reference/`.
//!
//! One problem per failing path. The head of a file says what to expect: `unsat` of a statement that must hold; of a control
//! `unknown`: one of its problems is `sat`.

use std::io;

use crate::claim::Engine;
use crate::claims;
use crate::proof::float::in_doubles;
use crate::proof::transcript;

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
    let mut count = 0;
    for (statement, control) in claims::asked(Engine::Doubles).into_values() {
        for (name, problem) in in_doubles(&statement, control) {
            std::fs::write(directory.join(name), problem)?;
            count += 1;
        }
    }
    Ok(count)
}
