//! A proof as text, for checkers that know nothing of this engine: its paths with every question and its answer, and for
//! each path that fails the facts and the certificate that contradict each other.
//!
//! ```text
//! statement a_square_is_not_negative
//! unknowns a
//! path
//! ask < 1 a^2                            the sign of this polynomial was asked for, and is <, <=, =, >= or > 0
//! inverse inverse_0 1 b                  from here on inverse_0 b = 1; b is known not to be zero
//! fails a * a >= S::from(0)              or: holds CLASS, vacuous
//! fact > -1 a^2                          numbered from 0
//! term 2 | 0 0 | 1 a ; 1 b               2 (fact 0)^2 a^2 b^2
//! multiple 1 a | 3                       a times fact 3, which is an equation
//! ```
//!
//! The lines without `fact`, `term` and `multiple` are the tree, whose hash VERIFY.md has. `reference/check_certificates.py` checks that
//! hash, that the questions of all paths are a tree whose answers leave no sign out, that
//! the facts follow from the answers, and that each certificate is one. What it does not check is that the polynomials are
//! those of the predicate: for this the exploration is trusted.

use std::fmt::Write;

use super::certificate::Certificate;
use super::explorer::Path;
use super::symbol::Step;
use super::{Fate, analyse, paths};
use crate::Verdict;
use crate::statement::Statement;

/// The proof of a statement as text.
///
/// # Errors
/// The first path that fails and is not refuted.
pub fn transcript(statement: &Statement) -> Result<String, String> {
    let analysis = analyse(statement);
    let mut fates = analysis.fates.iter();
    written(statement, &analysis.paths, |path, text| match fates.next() {
        Some((_, Fate::Impossible(certificate))) => {
            contradiction(path, certificate, &path.names(statement.variables), text);
            Ok(())
        }
        _ => Err(format!("{}: {:?} is not proved", statement.name, path.verdict)),
    })
}

/// The paths of a proof and those that fail; and its tree, the same text without facts and certificates: what is proved, whoever
/// wrote the certificates.
pub fn tree(statement: &Statement) -> ([usize; 2], String) {
    let paths = paths(statement);
    let failing = paths.iter().filter(|path| path.verdict.fails()).count();
    let text = written(statement, &paths, |_, _| Ok(())).unwrap_or_default();
    ([paths.len(), failing], text)
}

fn written(
    statement: &Statement,
    paths: &[Path],
    mut refute: impl FnMut(&Path, &mut String) -> Result<(), String>,
) -> Result<String, String> {
    let variables = statement.variables.join(" ");
    let mut text = format!("statement {}\nunknowns {variables}\n", statement.name);
    for path in paths {
        steps(path, &path.names(statement.variables), &mut text);
        match path.verdict {
            Verdict::Holds(class) => text += &format!("holds {class}\n"),
            Verdict::Vacuous => text += "vacuous\n",
            Verdict::Fails(conclusion) => {
                text += &format!("fails {}\n", conclusion.replace('\n', " "));
                refute(path, &mut text)?;
            }
        }
    }
    Ok(text)
}

fn steps(path: &Path, names: &[String], text: &mut String) {
    text.push_str("path\n");
    for step in &path.steps {
        let _ = match step {
            Step::Asked(p, signs) => {
                let relation = signs.relation().unwrap_or("?");
                writeln!(text, "ask {relation} {}", p.text(names))
            }
            Step::Inverted(p, variable) => {
                writeln!(text, "inverse {} {}", names[*variable], p.text(names))
            }
        };
    }
}

fn contradiction(path: &Path, certificate: &Certificate, names: &[String], text: &mut String) {
    for fact in &path.facts {
        let (relation, polynomial) = (fact.sense.relation(), fact.polynomial.text(names));
        let _ = writeln!(text, "fact {relation} {polynomial}");
    }
    for term in &certificate.terms {
        let facts: Vec<String> = term.facts.iter().map(usize::to_string).collect();
        let squares: Vec<String> = term.squares.iter().map(|p| p.text(names)).collect();
        let (facts, squares) = (facts.join(" "), squares.join(" ; "));
        let _ = writeln!(text, "term {} | {facts} | {squares}", term.weight);
    }
    for (multiplier, fact) in &certificate.multiples {
        let _ = writeln!(text, "multiple {} | {fact}", multiplier.text(names));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::Ordered;
    use crate::{ensure, given, statement};

    fn a_quotient_of_squares_is_not_negative<S: Ordered>([a, b]: [S; 2]) -> Verdict {
        given!(b > S::from(0));
        ensure!(a * a / b >= S::from(0));
        Verdict::Holds("always")
    }

    fn a_square_is_positive<S: Ordered>([a]: [S; 1]) -> Verdict {
        ensure!(a * a > S::from(0));
        Verdict::Holds("always")
    }

    /// The example that the tests of the other checker tamper with.
    const EXAMPLE: &str = "../reference/tests/quotient.proof";

    #[test]
    fn a_proof_is_printed_as_the_example_of_the_other_checker() {
        let statement = statement!(a_quotient_of_squares_is_not_negative, [a, b], ["always"]);
        let text = transcript(&statement).unwrap();
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(EXAMPLE);
        let stored = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(stored == text, "{} is stale; it is now:\n{text}", path.display());
    }

    #[test]
    fn what_is_not_proved_has_no_transcript() {
        let why = transcript(&statement!(a_square_is_positive, [a], ["always"])).unwrap_err();
        assert!(why.contains("is not proved"), "{why}");
    }

    #[test]
    fn a_tree_is_the_proof_without_facts_and_certificates() {
        let statement = statement!(a_quotient_of_squares_is_not_negative, [a, b], ["always"]);
        let text = transcript(&statement).unwrap();
        let of_tree =
            |line: &&str| !["fact ", "term ", "multiple "].iter().any(|w| line.starts_with(w));
        let lines: String = text.lines().filter(of_tree).map(|line| format!("{line}\n")).collect();
        let ([paths, failing], tree) = tree(&statement);
        assert_eq!(tree, lines);
        assert_eq!(paths, text.matches("path\n").count());
        assert!(failing > 0 && failing == text.matches("\nfails ").count());
    }
}
