//! All paths of a predicate: it is run again and again, each time along the next path, until every answer was tried.
//!
//! Trusted, with `symbol`: what isn't explored isn't proved.

use num_rational::BigRational;
use num_traits::{Signed, Zero};

use super::polynomial::Polynomial;
use super::symbol::{self, Choice, Run, Signs, Step, Sym};
use crate::Verdict;

/// A predicate over symbols.
pub type Predicate = fn(&[Sym]) -> Verdict;

/// What a path knows about a polynomial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// > 0
    Positive,
    /// >= 0
    Nonnegative,
    /// = 0
    Zero,
}

/// A fact of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// The polynomial it is about.
    pub polynomial: Polynomial,
    /// What is known about it.
    pub sense: Sense,
}

impl Sense {
    /// The relation to zero that says the same.
    pub fn relation(self) -> &'static str {
        match self {
            Sense::Positive => ">",
            Sense::Nonnegative => ">=",
            Sense::Zero => "=",
        }
    }
}

impl Fact {
    fn new(polynomial: &Polynomial, signs: Signs) -> Fact {
        let (negated, sense) = match signs {
            Signs::POSITIVE => (false, Sense::Positive),
            Signs::NONNEGATIVE => (false, Sense::Nonnegative),
            Signs::NEGATIVE => (true, Sense::Positive),
            Signs::NONPOSITIVE => (true, Sense::Nonnegative),
            Signs::ZERO => (false, Sense::Zero),
            other => unreachable!("{other:?} is not convex"),
        };
        Fact { polynomial: if negated { -polynomial } else { polynomial.clone() }, sense }
    }

    /// Whether it is true at a point.
    pub fn holds_at(&self, point: &[BigRational]) -> bool {
        let value = self.polynomial.at(point);
        match self.sense {
            Sense::Positive => value.is_positive(),
            Sense::Nonnegative => !value.is_negative(),
            Sense::Zero => value.is_zero(),
        }
    }
}

/// One path of a predicate.
#[derive(Clone, Debug)]
pub struct Path {
    /// What is known on it.
    pub facts: Vec<Fact>,
    /// Where it ends.
    pub verdict: Verdict,
    /// Divisors, and the variables that stand for their inverses, in the order in which they appeared.
    pub inverses: Vec<(Polynomial, usize)>,
    /// The unknowns of the predicate and the inverses together.
    pub variables: usize,
    /// How it was reached.
    pub steps: Vec<Step>,
}

impl Path {
    /// The names of its variables: those of the unknowns, and `inverse_0`, ... of the inverses.
    pub fn names(&self, unknowns: &[&str]) -> Vec<String> {
        let inverses = (unknowns.len()..self.variables).map(|i| i - unknowns.len());
        let unknowns = unknowns.iter().map(|name| (*name).to_owned());
        unknowns.chain(inverses.map(|i| format!("inverse_{i}"))).collect()
    }
}

/// More paths than this are a mistake in the predicate.
const MOST_PATHS: usize = 50_000;

/// All paths of a predicate of so many unknowns.
pub fn explore(unknowns: usize, predicate: Predicate) -> Vec<Path> {
    let mut paths = Vec::new();
    let mut script = Vec::new();
    loop {
        let (run, path) = follow(unknowns, predicate, script);
        paths.push(path);
        assert!(paths.len() < MOST_PATHS, "more than {MOST_PATHS} paths");
        match next(run.script) {
            Some(following) => script = following,
            None => return paths,
        }
    }
}

fn follow(unknowns: usize, predicate: Predicate, script: Vec<Choice>) -> (Run, Path) {
    let variables = symbol::start(unknowns, script);
    let verdict = predicate(&variables);
    let mut run = symbol::finish();
    let path = Path {
        facts: run.signs.iter().map(|(p, &signs)| Fact::new(p, signs)).collect(),
        verdict: run.failed.map_or(verdict, Verdict::Fails),
        inverses: std::mem::take(&mut run.inverses),
        variables: run.variables,
        steps: std::mem::take(&mut run.steps),
    };
    (run, path)
}

/// The script of the next path: the last answer that has a successor is replaced by it.
fn next(mut script: Vec<Choice>) -> Option<Vec<Choice>> {
    while let Some(last) = script.pop() {
        if last.answer + 1 < last.of {
            script.push(Choice { answer: last.answer + 1, ..last });
            return Some(script);
        }
    }
    None
}

/// The verdict of a predicate at a point: symbols that are constants, so nothing forks.
pub fn verdict_at(predicate: Predicate, point: &[BigRational]) -> Verdict {
    symbol::start(0, Vec::new());
    let constants: Vec<Sym> =
        point.iter().map(|value| Sym::new(Polynomial::constant(value.clone()))).collect();
    let verdict = predicate(&constants);
    let run = symbol::finish();
    assert!(run.script.is_empty(), "a question about constants has one answer");
    run.failed.map_or(verdict, Verdict::Fails)
}

/// The polynomials that a function of the unknowns answers with.
pub fn polynomials_of(unknowns: usize, of: fn(&[Sym]) -> Vec<Sym>) -> Vec<Polynomial> {
    let variables = symbol::start(unknowns, Vec::new());
    let result = of(&variables).into_iter().map(Sym::polynomial).collect();
    symbol::finish();
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answers_of_a_function_of_the_unknowns_are_polynomials_in_them() {
        let (x, y) = (Polynomial::variable(0), Polynomial::variable(1));
        assert_eq!(polynomials_of(2, |v| vec![v[0] * v[1], v[0] - v[1]]), [&x * &y, &x - &y]);
    }
}
