//! Receipts of the floating-point solver bitwuzla, `props/receipts/bitwuzla-DATE.tsv`: its answers to the failing paths of
//! the statements in doubles ([`crate::export`]), over all finite doubles, with a hash of each problem. `unsat` for all of
//! them decides the statement.
//!
//! ```text
//! cargo run -p props -- smt target/smt
//! python3 .ci/smt.py target/smt --receipt props/receipts
//! ```
//!
//! A problem depends on the statement and on what it calls of the kernel: where it is another one than that of the newest
//! receipt, the receipt is stale, and a test fails.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use sha2::{Digest, Sha256};

use crate::export::in_doubles;
use crate::receipt::root;
use crate::statement::Statement;

/// The newest receipt.
struct Receipt {
    date: String,
    /// By the problem: the hash of its text, and the answer.
    answers: BTreeMap<String, [String; 2]>,
}

fn receipt() -> &'static Receipt {
    static RECEIPT: OnceLock<Receipt> = OnceLock::new();
    RECEIPT.get_or_init(|| read().expect("props/receipts has a receipt of bitwuzla"))
}

fn read() -> Result<Receipt, String> {
    let directory = root().join("props/receipts");
    let failed = |why: std::io::Error| format!("{}: {why}", directory.display());
    let mut newest: Option<(String, std::path::PathBuf)> = None;
    for entry in std::fs::read_dir(&directory).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if let Some(date) = name.strip_prefix("bitwuzla-").and_then(|n| n.strip_suffix(".tsv")) {
            newest = newest.max(Some((date.to_owned(), path)));
        }
    }
    let (date, path) = newest.ok_or("there is none: see .ci/smt.py")?;
    let text = std::fs::read_to_string(path).map_err(failed)?;
    let mut answers = BTreeMap::new();
    for line in text.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let [problem, hash, _, answer] = line.split('\t').collect::<Vec<_>>()[..] else {
            return Err(format!("{date}: expected four columns: {line}"));
        };
        answers.insert(problem.to_owned(), [hash, answer].map(str::to_owned));
    }
    Ok(Receipt { date, answers })
}

/// What the newest receipt says of a statement in doubles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Opinion {
    /// It holds for all finite doubles, by the receipt of this date.
    Holds(String),
    /// This problem has no answer, or the opposite one.
    Open(String),
    /// This problem is not the one that was asked, or was never asked.
    Stale(String),
}

impl std::fmt::Display for Opinion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Opinion::Holds(date) => {
                write!(f, "decided for all finite doubles by bitwuzla, receipt {date}")
            }
            Opinion::Open(problem) => write!(f, "bitwuzla has not decided {problem}"),
            Opinion::Stale(problem) => {
                write!(f, "bitwuzla was not asked since {problem} changed")
            }
        }
    }
}

/// The opinion about a statement that must hold.
pub fn opinion(statement: &Statement) -> Opinion {
    by(receipt(), &in_doubles(statement, false))
}

fn by(receipt: &Receipt, problems: &[(String, String)]) -> Opinion {
    for (name, problem) in problems {
        match receipt.answers.get(name) {
            Some([known, answer]) if *known == hash(problem) => {
                if answer != "unsat" {
                    return Opinion::Open(name.clone());
                }
            }
            _ => return Opinion::Stale(name.clone()),
        }
    }
    Opinion::Holds(receipt.date.clone())
}

fn hash(problem: &str) -> String {
    let digest = Sha256::digest(problem.as_bytes());
    digest[..8].iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claim::{Engine, Subject};
    use crate::claims;

    #[test]
    fn a_receipt_is_about_the_problems_that_were_asked_and_holds_where_all_are_impossible() {
        let problems = ["a", "b"].map(|name| (name.to_owned(), format!("problem {name}")));
        let answers = |of_b: &str, text_b: &str| Receipt {
            date: "2026-11-21".to_owned(),
            answers: BTreeMap::from([
                ("a".to_owned(), [hash("problem a"), "unsat".to_owned()]),
                ("b".to_owned(), [hash(text_b), of_b.to_owned()]),
            ]),
        };
        let found = |of_b, text_b| by(&answers(of_b, text_b), &problems);
        assert_eq!(found("unsat", "problem b"), Opinion::Holds("2026-11-21".to_owned()));
        assert_eq!(found("unknown", "problem b"), Opinion::Open("b".to_owned()));
        assert_eq!(found("sat", "problem b"), Opinion::Open("b".to_owned()));
        assert_eq!(found("unsat", "problem B"), Opinion::Stale("b".to_owned()));
    }

    #[test]
    fn every_statement_in_doubles_is_decided_over_all_finite_doubles_by_a_receipt_that_is_not_stale()
     {
        let (mut statements, mut problems) = (0, 0);
        for check in claims::all().iter().flat_map(|claim| &claim.checks) {
            if let (Engine::Doubles, Subject::Statement(statement)) = (check.engine, check.subject)
            {
                problems += in_doubles(&statement, check.control).len();
                if !check.control {
                    statements += 1;
                    let opinion = opinion(&statement);
                    let again = "python3 .ci/smt.py DIR --receipt props/receipts, after cargo run -p props -- smt DIR";
                    assert!(
                        matches!(opinion, Opinion::Holds(_)),
                        "{}: {opinion:?}; {again}",
                        statement.name
                    );
                }
            }
        }
        assert!(statements >= 5, "{statements}");
        assert_eq!(problems, receipt().answers.len(), "the receipt has problems that are no more");
    }
}
