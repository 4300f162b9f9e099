//! Receipts of other programs' answers: of the floating-point solver bitwuzla to the failing paths of the statements in doubles
//! ([`crate::export`]), over all finite doubles, and of Rocq ([`crate::paper`]).
//!
//! ```text
//! cargo run -p props -- smt target/smt
//! python3 .ci/smt.py target/smt --receipt props/receipts
//! ```
//!
//! A problem depends on the statement and on what it calls of the kernel. Where one is not that of the newest receipt, the
//! receipt is stale, and a test fails.

use std::sync::OnceLock;

use crate::proof::float::in_doubles;
use crate::receipt::{Table, hash};
use crate::statement::Statement;

/// The programs that were asked, and in a row of each problem its name, the hash of its text, what was expected, and the answer of
/// each program.
pub type Receipt = Table;

impl Receipt {
    /// The newest one of those whose names begin with `prefix`; an empty one where there is none that can be read.
    pub fn of_solvers(prefix: &str) -> Receipt {
        Table::newest(prefix).and_then(Receipt::complete).unwrap_or_default()
    }

    fn complete(self) -> Result<Receipt, String> {
        let Table { date, head, columns, .. } = &self;
        if head.is_empty() || columns.len() != 3 + head.len() {
            return Err(format!("{date}: expected {} columns: {columns:?}", 3 + head.len()));
        }
        Ok(self)
    }

    /// The row of a problem: hash, what was expected, answers.
    pub fn answers(&self, name: &str) -> Option<&[String]> {
        self.rows.iter().find(|row| row[0] == name).map(|row| &row[1..])
    }

    /// How many problems of which this was expected have this answer.
    pub fn count(&self, expected: &str, answer: &str) -> usize {
        let is = |row: &&Vec<String>| row[2] == expected && row[3..].iter().all(|a| a == answer);
        self.rows.iter().filter(is).count()
    }

    /// Whether each of these problems is impossible.
    ///
    /// # Errors
    /// The first one that was not asked, is another one now, or has another answer.
    fn excludes(&self, problems: &[(String, String)]) -> Result<(), String> {
        for (name, problem) in problems {
            let known = self.answers(name).ok_or(format!("{name} was not asked"))?;
            if known[0] != hash(problem) {
                return Err(format!("{name} has changed since"));
            }
            if known[2..].iter().any(|answer| answer != "unsat") {
                return Err(format!("{name}: {}", known[2..].join(", ")));
            }
        }
        Ok(())
    }
}

/// The newest receipt of bitwuzla.
pub fn in_all_doubles() -> &'static Receipt {
    static RECEIPT: OnceLock<Receipt> = OnceLock::new();
    RECEIPT.get_or_init(|| Receipt::of_solvers("bitwuzla-"))
}

/// Whether bitwuzla has decided a statement for all finite doubles, by the newest receipt.
///
/// # Errors
/// The path that it has not decided.
pub fn decided(statement: &Statement) -> Result<(), String> {
    let problems = in_doubles(statement, false);
    if problems.is_empty() {
        return Err("no path fails: nothing was asked".to_owned());
    }
    in_all_doubles().excludes(&problems)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::claim::Engine;
    use crate::claims;

    const AGAIN: &str =
        "cargo run -p props -- smt DIR, then python3 .ci/smt.py DIR --receipt props/receipts";

    #[test]
    fn a_receipt_is_about_the_problems_that_were_asked_and_holds_where_all_are_impossible() {
        let parsed = |text: &str| Table::parse("2026-11-21", text)?.complete();
        let found = |answer: &str, text: &str| {
            let row = format!("a\t{}\tunsat\t{answer}\n", hash(text));
            let text = format!("# bitwuzla 0.9\nproblem\thash\texpected\tbitwuzla\n{row}");
            let problem = ("a".to_owned(), "problem a".to_owned());
            parsed(&text).and_then(|receipt| receipt.excludes(&[problem]))
        };
        assert_eq!(found("unsat", "problem a"), Ok(()));
        assert_eq!(found("unknown", "problem a"), Err("a: unknown".to_owned()));
        assert_eq!(found("unsat", "problem A"), Err("a has changed since".to_owned()));
        assert!(parsed("# z3 5\nproblem\thash\texpected\tz3\na\tb\tunsat\n").is_err());
        assert!(parsed("problem\thash\texpected\na\tb\tunsat\n").is_err());
    }

    #[test]
    fn every_statement_in_doubles_is_decided_over_all_finite_doubles_and_a_control_is_not() {
        let statements = claims::statements(Engine::Doubles);
        assert!(statements.len() >= 5, "{}", statements.len());
        for (name, statement) in &statements {
            assert_eq!(decided(statement), Ok(()), "{name}; {AGAIN}");
        }
        assert!(in_all_doubles().count("unknown", "sat") > 0);
    }

    #[test]
    fn the_receipt_is_about_problems_that_exist() {
        let statements = claims::asked(Engine::Doubles).into_values();
        let problems = statements.flat_map(|(statement, _)| in_doubles(&statement, false));
        let known: BTreeSet<String> = problems.map(|(name, _)| name).collect();
        for row in &in_all_doubles().rows {
            assert!(known.contains(&row[0]), "{} is no more; {AGAIN}", row[0]);
        }
    }
}
