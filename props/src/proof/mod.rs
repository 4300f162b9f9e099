//! The proof engine: a predicate is run over symbols along all its paths, and every path that ends in `Fails` is shown
//! to contradict itself by a certificate that a small checker verifies.
//!
//! What holds this way holds over every ordered field, so over the real numbers. Trusted are [`polynomial`], [`symbol`],
//! [`explorer`] and [`certificate::check`]; the search for certificates and for points is not.

pub mod certificate;
pub mod explorer;
pub mod float;
pub mod polynomial;
pub mod rocq;
pub mod sampler;
pub mod search;
mod simplex;
pub mod symbol;
pub mod transcript;

pub use float::Float;
pub use symbol::Sym;
pub use transcript::{transcript, tree};

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::{Arc, Mutex, PoisonError};

use num_rational::BigRational;

use crate::Verdict;
use crate::statement::Statement;
use certificate::Certificate;
use explorer::{Path, explore, polynomials_of, verdict_at};
use sampler::{Random, sample};

/// Draws for a counterexample before and after the search for a certificate, and for a witness.
const QUICK_DRAWS: usize = 40;
const SLOW_DRAWS: usize = 4000;

/// What became of a path that ends in `Fails`.
#[derive(Clone, Debug)]
pub enum Fate {
    /// It contradicts itself.
    Impossible(Certificate),
    /// The predicate fails at this point.
    Refuted(Vec<BigRational>),
    /// Neither was found.
    Open,
}

/// The paths of a statement and what became of those that fail.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// All paths.
    pub paths: Arc<Vec<Path>>,
    /// By number of the path, for those that end in `Fails`.
    pub fates: Vec<(usize, Fate)>,
}

/// What was made once for a key, for all who ask.
pub(crate) type Known<K, T> = Mutex<BTreeMap<K, Arc<T>>>;

pub(crate) fn once<K: Ord, T>(known: &Known<K, T>, key: K, make: impl FnOnce() -> T) -> Arc<T> {
    let kept = || known.lock().unwrap_or_else(PoisonError::into_inner);
    let found = kept().get(&key).cloned();
    found.unwrap_or_else(|| {
        let made = Arc::new(make());
        kept().insert(key, made.clone());
        made
    })
}

/// All paths of a statement: its predicate is a function of its arguments alone, so two of one address have the same.
pub fn paths(statement: &Statement) -> Arc<Vec<Path>> {
    static KNOWN: Known<(usize, usize), Vec<Path>> = Mutex::new(BTreeMap::new());
    let unknowns = statement.variables.len();
    let key = (statement.symbolic as usize, unknowns);
    once(&KNOWN, key, || explore(unknowns, statement.symbolic))
}

/// Explores a statement and decides each path that fails.
pub fn analyse(statement: &Statement) -> Arc<Analysis> {
    static KNOWN: Known<[usize; 3], Analysis> = Mutex::new(BTreeMap::new());
    let unknowns = statement.variables.len();
    let key = [statement.symbolic as usize, statement.hints as usize, unknowns];
    once(&KNOWN, key, || {
        let paths = paths(statement);
        let hints = polynomials_of(unknowns, statement.hints);
        let failing = paths.iter().enumerate().filter(|(_, path)| path.verdict.fails());
        let fates = failing.map(|(i, path)| (i, fate(statement, path, &hints))).collect();
        Analysis { paths, fates }
    })
}

fn fate(statement: &Statement, path: &Path, hints: &[polynomial::Polynomial]) -> Fate {
    let mut random = Random::new(1);
    if let Some(point) = refutation(statement, path, &mut random, QUICK_DRAWS) {
        return Fate::Refuted(point);
    }
    if let Some(certificate) = search::search(&path.facts, path.variables, hints) {
        match certificate::check(&path.facts, &certificate) {
            Ok(()) => return Fate::Impossible(certificate),
            Err(refusal) => panic!("the search found a wrong certificate: {refusal:?}"),
        }
    }
    match refutation(statement, path, &mut random, SLOW_DRAWS) {
        Some(point) => Fate::Refuted(point),
        None => Fate::Open,
    }
}

/// A point on the path at which the predicate, run there, fails.
fn refutation(
    statement: &Statement,
    path: &Path,
    random: &mut Random,
    draws: usize,
) -> Option<Vec<BigRational>> {
    sample(path, random, draws).filter(|point| verdict_at(statement.symbolic, point).fails())
}

/// Proves a statement: every failing path is impossible, and each of its classes is reached at some point.
///
/// # Errors
/// A counterexample, the paths left open, the class that no point was found for, or that it names no class: such a
/// statement would pass where its hypothesis is never met.
pub fn prove(statement: &Statement) -> Result<String, String> {
    if statement.classes.is_empty() {
        return Err("it names no class of data for which it holds: it may be vacuous".to_owned());
    }
    let analysis = analyse(statement);
    let mut open = Vec::new();
    let (mut terms, mut factors) = (0, 0);
    for (i, fate) in &analysis.fates {
        match fate {
            Fate::Refuted(point) => {
                let verdict = verdict_at(statement.symbolic, point);
                return Err(format!("{verdict:?} at {}", place(statement, point)));
            }
            Fate::Open => open.push(format!("path {i}: {:?}", analysis.paths[*i].verdict)),
            Fate::Impossible(certificate) => {
                terms = terms.max(certificate.terms.len() + certificate.multiples.len());
                factors = factors.max(certificate.factors());
            }
        }
    }
    if !open.is_empty() {
        return Err(format!("no certificate and no counterexample for {}", open.join("; ")));
    }
    reach_classes(statement, &analysis.paths)?;
    let (all, failing) = (analysis.paths.len(), analysis.fates.len());
    let largest = match failing {
        0 => "by identities and signs alone".to_owned(),
        _ => format!("largest certificate {terms} terms of {factors} factors"),
    };
    Ok(format!("{all} paths, {failing} of them refuted; {largest}"))
}

/// Refutes a statement that is a control: the conclusion that it names fails at a point that was found on one of its paths.
///
/// # Errors
/// That it names no conclusion, or that there is no such point.
pub fn refute(statement: &Statement) -> Result<String, String> {
    let Some(conclusion) = statement.conclusion else {
        return Err("a control names the conclusion that must fail".to_owned());
    };
    let mut random = Random::new(1);
    let paths = paths(statement);
    let mut found = |tries| {
        let mut named = paths.iter().filter(|path| path.verdict == Verdict::Fails(conclusion));
        named.find_map(|path| refutation(statement, path, &mut random, tries))
    };
    match found(QUICK_DRAWS).or_else(|| found(SLOW_DRAWS)) {
        Some(point) => Ok(format!("rejected at {}: {conclusion}", place(statement, &point))),
        None => Err(format!("'{conclusion}' does not fail")),
    }
}

fn place(statement: &Statement, point: &[BigRational]) -> String {
    let mut text = String::new();
    for (name, value) in statement.variables.iter().zip(point) {
        let comma = if text.is_empty() { "" } else { ", " };
        let _ = write!(text, "{comma}{name} = {value}");
    }
    text
}

/// A witness for each class, by running the predicate there.
fn reach_classes(statement: &Statement, paths: &[Path]) -> Result<(), String> {
    for path in paths {
        if let Verdict::Holds(class) = path.verdict
            && !statement.classes.contains(&class)
        {
            return Err(format!("the class '{class}' is not listed"));
        }
    }
    let mut random = Random::new(2);
    for class in statement.classes {
        let of_class: Vec<&Path> =
            paths.iter().filter(|p| p.verdict == Verdict::Holds(class)).collect();
        let mut reached = |tries| {
            let points = of_class.iter().filter_map(|path| sample(path, &mut random, tries));
            let mut verdicts = points.map(|point| verdict_at(statement.symbolic, &point));
            verdicts.any(|verdict| verdict == Verdict::Holds(class))
        };
        if !(reached(20) || reached(SLOW_DRAWS)) {
            return Err(format!("no point of the class '{class}' was found"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claim::Engine;
    use crate::numbers::Exact;
    use crate::verdict::Ordered;
    use crate::{claims, ensure, given, statement};

    /// All statements of which this engine is asked, controls included.
    fn statements() -> impl Iterator<Item = Statement> {
        claims::asked(Engine::Proof).into_values().map(|(statement, _)| statement)
    }

    /// The point with the values of the inverse variables, or nothing where a divisor is zero.
    fn with_inverses(path: &Path, point: &[BigRational]) -> Option<Vec<BigRational>> {
        let mut point = point.to_vec();
        for (divisor, _) in &path.inverses {
            let value = divisor.at(&point);
            if value == BigRational::from_integer(0.into()) {
                return None;
            }
            point.push(value.recip());
        }
        Some(point)
    }

    /// A path on which a divisor is zero stops before it has an inverse for it, so there `with_inverses` is enough too.
    fn lies_on(path: &Path, point: &[BigRational]) -> bool {
        with_inverses(path, point)
            .is_some_and(|point| path.facts.iter().all(|fact| fact.holds_at(&point)))
    }

    /// The verdict by the arithmetic of the exact engine, which knows nothing of symbols. It panics at a division by zero.
    fn over_rationals(statement: &Statement, point: &[BigRational]) -> Verdict {
        Exact::scope(|| {
            let point: Vec<Exact> = point.iter().cloned().map(Exact::new).collect();
            (statement.exact)(&point)
        })
    }

    #[test]
    fn every_random_point_lies_on_exactly_one_path_and_has_its_verdict() {
        let mut random = Random::new(7);
        for statement in statements() {
            let paths = paths(&statement);
            let unknowns = statement.variables.len();
            // Each point is compared with all paths, of which some statements have hundreds.
            for _ in 0..(400 / paths.len()).clamp(5, 40) {
                let point: Vec<BigRational> = (0..unknowns).map(|_| random.rational()).collect();
                let on: Vec<&Path> = paths.iter().filter(|path| lies_on(path, &point)).collect();
                assert_eq!(on.len(), 1, "{} at {}", statement.name, place(&statement, &point));
                let verdict = verdict_at(statement.symbolic, &point);
                assert_eq!(on[0].verdict, verdict, "{}", statement.name);
                if verdict != Verdict::Fails("division by zero") {
                    assert_eq!(verdict, over_rationals(&statement, &point), "{}", statement.name);
                }
            }
        }
    }

    #[test]
    fn points_drawn_on_a_path_have_its_verdict() {
        let mut random = Random::new(8);
        for statement in statements() {
            let paths = paths(&statement);
            for path in paths.iter().step_by(paths.len() / 12 + 1) {
                if let Some(point) = sample(path, &mut random, 20) {
                    assert_eq!(path.verdict, verdict_at(statement.symbolic, &point));
                }
            }
        }
    }

    fn a_square_is_positive<S: Ordered>([a]: [S; 1]) -> Verdict {
        ensure!(a * a > S::from(0));
        Verdict::Holds("all")
    }

    fn a_square_is_not_negative<S: Ordered>([a]: [S; 1]) -> Verdict {
        ensure!(a * a >= S::from(0));
        Verdict::Holds("all")
    }

    #[expect(clippy::double_comparisons, clippy::eq_op, reason = "the comparisons are under test")]
    fn a_comparison_has_one_answer<S: Ordered>([a, b]: [S; 2]) -> Verdict {
        let answers = [a < b, a == b, a > b].map(u8::from);
        ensure!(answers.iter().sum::<u8>() == 1);
        ensure!((a <= b) == (a < b || a == b));
        ensure!((a >= b) != (a < b));
        ensure!((b > a) == (a < b));
        ensure!((a != b) == (a < b || b < a));
        ensure!(a.partial_cmp(&b) == (b - b).partial_cmp(&(b - a)));
        Verdict::Holds("all")
    }

    #[test]
    fn true_statements_are_proved_and_false_ones_refuted() {
        assert!(prove(&statement!(a_square_is_not_negative, [a], ["all"])).is_ok());
        let why = prove(&statement!(a_square_is_positive, [a], ["all"])).unwrap_err();
        assert!(why.ends_with("at a = 0"), "{why}");
        let right = statement!(a_square_is_not_negative, [a], fails "a * a >= S::from(0)");
        assert_eq!(refute(&right), Err("'a * a >= S::from(0)' does not fail".to_owned()));
        assert!(prove(&statement!(a_comparison_has_one_answer, [a, b], ["all"])).is_ok());
    }

    #[test]
    fn a_class_that_is_not_listed_or_that_nothing_reaches_is_an_error() {
        let why = prove(&statement!(a_square_is_not_negative, [a], ["all", "never"])).unwrap_err();
        assert!(why.contains("'never'"), "{why}");
        let why = prove(&statement!(a_square_is_not_negative, [a], ["other"])).unwrap_err();
        assert!(why.contains("not listed"), "{why}");
    }

    #[test]
    fn a_statement_without_a_class_is_not_proved() {
        let why = prove(&statement!(a_square_is_not_negative, [a], [])).unwrap_err();
        assert!(why.contains("names no class"), "{why}");
    }

    fn two_conclusions<S: Ordered>([a]: [S; 1]) -> Verdict {
        given!(a > S::from(1));
        ensure!(a < S::from(3));
        ensure!(a < S::from(2));
        Verdict::Holds("all")
    }

    #[test]
    fn a_control_is_refuted_by_the_conclusion_that_it_names() {
        let named = statement!(a_square_is_positive, [a], fails "a * a > S::from(0)");
        assert_eq!(refute(&named), Ok("rejected at a = 0: a * a > S::from(0)".to_owned()));
        let other = statement!(a_square_is_positive, [a], fails "a > S::from(0)");
        assert!(refute(&other).unwrap_err().contains("'a > S::from(0)' does not fail"));
        let nameless = statement!(a_square_is_positive, [a], []);
        assert!(refute(&nameless).unwrap_err().contains("names the conclusion"));
        let second = statement!(two_conclusions, [a], fails "a < S::from(2)");
        assert!(refute(&second).unwrap().ends_with("a < S::from(2)"));
        let never = statement!(two_conclusions, [a], fails "a > S::from(1)");
        assert!(refute(&never).is_err());
    }
}
