//! Receipts of SMT solvers: their answers to the failing paths of statements ([`crate::export`]), with a hash of each problem.
//!
//! - `props/receipts/bitwuzla-DATE.tsv`: the statements in doubles, over all finite doubles, by bitwuzla. `unsat` for each of
//!   them decides the statement.
//! - `props/receipts/reals-DATE.tsv`: the paths of the proofs, over the real numbers, by z3 and cvc5: a second opinion on what
//!   the proof engine has certificates for.
//!
//! ```text
//! cargo run -p props -- smt target/smt
//! python3 .ci/smt.py target/smt --receipt props/receipts
//! ```
//!
//! A problem depends on the statement and on what it calls of the kernel. Where one is not that of the newest receipt, the
//! receipt is stale, and a test fails.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use sha2::{Digest, Sha256};

use crate::proof::smt::{in_doubles, of_paths};
use crate::receipt::Table;
use crate::statement::Statement;

/// Which problems a receipt is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// All finite doubles.
    Doubles,
    /// The real numbers.
    Reals,
}

impl Field {
    /// What the names of its receipts begin with.
    fn prefix(self) -> &'static str {
        match self {
            Field::Doubles => "bitwuzla-",
            Field::Reals => "reals-",
        }
    }

    fn problems(self, statement: &Statement) -> Vec<(String, String)> {
        match self {
            Field::Doubles => in_doubles(statement, false),
            Field::Reals => of_paths(statement),
        }
    }

    /// The newest receipt about its problems.
    pub fn receipt(self) -> &'static Receipt {
        static DOUBLES: OnceLock<Receipt> = OnceLock::new();
        static REALS: OnceLock<Receipt> = OnceLock::new();
        let receipt = match self {
            Field::Doubles => &DOUBLES,
            Field::Reals => &REALS,
        };
        receipt.get_or_init(|| Receipt::newest(self.prefix()))
    }
}

/// What the solvers were asked, and what they answered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Receipt {
    /// When.
    pub date: String,
    /// Names and versions.
    pub solvers: Vec<String>,
    /// By the problem: the hash of its text, and the answer of each solver.
    pub answers: BTreeMap<String, (String, Vec<String>)>,
}

impl Receipt {
    /// The newest one of those whose names begin with `prefix`; an empty one where there is none that can be read.
    pub fn newest(prefix: &str) -> Receipt {
        let tables = Table::stored(prefix).unwrap_or_default();
        tables.last().and_then(|table| Receipt::of(table).ok()).unwrap_or_default()
    }

    /// In the head NAME VERSION of each solver; in a row problem, hash, what was expected, an answer of each solver.
    fn of(table: &Table) -> Result<Receipt, String> {
        let Table { date, head, columns, rows } = table;
        if head.is_empty() || columns.len() != 3 + head.len() {
            return Err(format!("{date}: expected {} columns: {columns:?}", 3 + head.len()));
        }
        let answer = |row: &Vec<String>| (row[0].clone(), (row[1].clone(), row[3..].to_vec()));
        let answers = rows.iter().map(answer).collect();
        Ok(Receipt { date: date.clone(), solvers: head.clone(), answers })
    }

    /// The names of the solvers, without versions.
    fn names(&self) -> Vec<&str> {
        self.solvers.iter().map(|solver| solver.split(' ').next().unwrap_or(solver)).collect()
    }

    fn opinion(&self, problems: &[(String, String)]) -> Opinion {
        let mut all = true;
        for (name, problem) in problems {
            let Some((known, answers)) = self.answers.get(name) else {
                return Opinion::Unasked(name.clone());
            };
            if *known != hash(problem) {
                return Opinion::Stale(name.clone());
            }
            if answers.iter().any(|answer| answer == "sat")
                || !answers.iter().any(|answer| answer == "unsat")
            {
                return Opinion::Open(name.clone());
            }
            all &= answers.iter().all(|answer| answer == "unsat");
        }
        let join = if all { " and " } else { " or " };
        Opinion::Holds { by: self.names().join(join), date: self.date.clone() }
    }
}

/// What the newest receipt says of a statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Opinion {
    /// Each failing path is impossible by all of these, or by one of these, and none contradicts; by the receipt of this date.
    Holds {
        /// The solvers.
        by: String,
        /// The date.
        date: String,
    },
    /// This problem has no answer, or the opposite one.
    Open(String),
    /// This problem is not the one that was asked.
    Stale(String),
    /// This problem was never asked.
    Unasked(String),
}

impl Opinion {
    /// In words.
    pub fn said(&self, field: Field) -> String {
        match (self, field) {
            (Opinion::Holds { by, date }, Field::Doubles) => {
                format!("decided for all finite doubles by {by}, receipt {date}")
            }
            (Opinion::Holds { by, date }, Field::Reals) => {
                format!("each failing path impossible by {by} too, receipt {date}")
            }
            (Opinion::Open(problem), _) => format!("no solver has decided {problem}"),
            (Opinion::Stale(problem), _) => format!("no solver was asked since {problem} changed"),
            (Opinion::Unasked(problem), _) => format!("no solver was asked for {problem}"),
        }
    }
}

/// The opinion about a statement that must hold, if there is anything to ask: a path that fails.
pub fn opinion(statement: &Statement, field: Field) -> Option<Opinion> {
    let problems = field.problems(statement);
    (!problems.is_empty()).then(|| field.receipt().opinion(&problems))
}

/// The hash by which a receipt knows a text.
pub fn hash(problem: &str) -> String {
    let digest = Sha256::digest(problem.as_bytes());
    digest[..8].iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::claim::{Engine, Subject};
    use crate::claims;

    const AGAIN: &str =
        "cargo run -p props -- smt DIR, then python3 .ci/smt.py DIR --receipt props/receipts";

    fn parsed(date: &str, text: &str) -> Result<Receipt, String> {
        Receipt::of(&Table::parse(date, text)?)
    }

    #[test]
    fn a_receipt_is_about_the_problems_that_were_asked_and_holds_where_all_are_impossible() {
        let problems = ["a", "b"].map(|name| (name.to_owned(), format!("problem {name}")));
        let found = |of_b: &str, text_b: &str| {
            let line = |name: &str, text: &str, answers: &str| {
                format!("{name}\t{}\tunsat\t{answers}\n", hash(text))
            };
            let text = "# z3 5.4\n# cvc5 1.4\nproblem\thash\texpected\tz3\tcvc5\n".to_owned()
                + &line("a", "problem a", "unsat\tunsat")
                + &line("b", text_b, of_b);
            parsed("2026-11-21", &text).expect("a receipt").opinion(&problems)
        };
        let holds = |by: &str| Opinion::Holds { by: by.to_owned(), date: "2026-11-21".to_owned() };
        assert_eq!(found("unsat\tunsat", "problem b"), holds("z3 and cvc5"));
        assert_eq!(found("unknown\tunsat", "problem b"), holds("z3 or cvc5"));
        assert_eq!(found("unknown\tunknown", "problem b"), Opinion::Open("b".to_owned()));
        assert_eq!(found("unsat\tsat", "problem b"), Opinion::Open("b".to_owned()));
        assert_eq!(found("unsat\tunsat", "problem B"), Opinion::Stale("b".to_owned()));
        let asked = parsed("", "# z3 5\nproblem\thash\texpected\tz3\n")
            .expect("a receipt")
            .opinion(&problems);
        assert_eq!(asked, Opinion::Unasked("a".to_owned()));
        assert!(parsed("", "# z3 5\nproblem\thash\texpected\tz3\na\tb\tunsat\n").is_err());
        assert!(parsed("", "problem\thash\texpected\na\tb\tunsat\n").is_err());
    }

    #[test]
    fn every_statement_in_doubles_is_decided_over_all_finite_doubles_by_a_receipt_that_is_not_stale()
     {
        let statements = claims::statements(Engine::Doubles);
        assert!(statements.len() >= 5, "{}", statements.len());
        for statement in statements.values() {
            let opinion = opinion(statement, Field::Doubles);
            let holds = matches!(opinion, Some(Opinion::Holds { .. }));
            assert!(holds, "{}: {opinion:?}; {AGAIN}", statement.name);
        }
    }

    #[test]
    fn no_solver_contradicts_a_proof_and_no_receipt_of_one_is_stale() {
        let (mut asked, mut confirmed) = (0, 0);
        for statement in claims::statements(Engine::Proof).values() {
            let Some(opinion) = opinion(statement, Field::Reals) else { continue };
            asked += 1;
            match opinion {
                Opinion::Holds { .. } => confirmed += 1,
                // A new statement: its row says that no solver was asked.
                Opinion::Unasked(_) => {}
                other => panic!("{}: {other:?}; {AGAIN}", statement.name),
            }
        }
        assert!(10 * confirmed >= 9 * asked, "{confirmed} of {asked}; {AGAIN}");
    }

    #[test]
    fn receipts_are_about_problems_that_exist() {
        for (field, engine) in [(Field::Doubles, Engine::Doubles), (Field::Reals, Engine::Proof)] {
            let claims = claims::all();
            let mut known = BTreeSet::new();
            for check in claims.iter().flat_map(|claim| &claim.checks) {
                if let (Subject::Statement(statement), true) =
                    (check.subject, check.engine == engine)
                {
                    known.extend(field.problems(&statement).into_iter().map(|(name, _)| name));
                }
            }
            for name in field.receipt().answers.keys() {
                assert!(known.contains(name), "{name} is no more; {AGAIN}");
            }
            assert!(!field.receipt().solvers.is_empty());
        }
    }
}
