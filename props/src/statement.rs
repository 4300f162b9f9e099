//! A statement: a predicate with the names of its unknowns and of its classes, instantiated for every engine.

use crate::Verdict;
use crate::numbers::Exact;
use crate::proof::float::Float;
use crate::proof::symbol::Sym;

/// One predicate, for all engines. Made by the macro [`statement!`](crate::statement!).
#[derive(Clone, Copy)]
pub struct Statement {
    /// The predicate's name, which is a sentence.
    pub name: &'static str,
    /// Its unknowns.
    pub variables: &'static [&'static str],
    /// The classes of data for which it holds, all of which must be reached: at least one, unless it is a control.
    pub classes: &'static [&'static str],
    /// Of a control: the conclusion, as it stands in the predicate, that must fail.
    pub conclusion: Option<&'static str>,
    /// Over symbols.
    pub symbolic: fn(&[Sym]) -> Verdict,
    /// Over exact rationals.
    pub exact: fn(&[Exact]) -> Verdict,
    /// Over doubles.
    pub doubles: fn(&[f64]) -> Verdict,
    /// Over terms for a floating-point solver.
    pub terms: fn(&[Float]) -> Verdict,
    /// Polynomials whose squares the search for certificates shall use.
    pub hints: fn(&[Sym]) -> Vec<Sym>,
    /// Moves random data onto the hypothesis, where it is an equation that draws would never meet.
    pub prepare: fn(&mut [Exact]),
}

impl Statement {
    /// The statement with hints for the search.
    pub fn with_hints(self, hints: fn(&[Sym]) -> Vec<Sym>) -> Statement {
        Statement { hints, ..self }
    }

    /// The statement as a control: this conclusion must fail.
    pub fn failing(self, conclusion: &'static str) -> Statement {
        Statement { conclusion: Some(conclusion), ..self }
    }

    /// The statement with a way to meet its hypothesis.
    pub fn prepared(self, prepare: fn(&mut [Exact])) -> Statement {
        Statement { prepare, ..self }
    }
}

/// The unknowns of a predicate as an array.
pub fn take<S: Copy, const N: usize>(values: &[S]) -> [S; N] {
    values.try_into().expect("as many values as unknowns")
}

/// `statement!(predicate, [names of unknowns], [classes])`, or for a control
/// `statement!(predicate, [names of unknowns], fails "the conclusion that must fail")`.
#[macro_export]
macro_rules! statement {
    ($predicate:ident, [$($variable:ident),* $(,)?], fails $conclusion:literal) => {
        $crate::statement!($predicate, [$($variable),*], []).failing($conclusion)
    };
    ($predicate:ident, [$($variable:ident),* $(,)?], [$($class:literal),* $(,)?]) => {
        $crate::statement::Statement {
            name: stringify!($predicate),
            variables: &[$(stringify!($variable)),*],
            classes: &[$($class),*],
            conclusion: None,
            symbolic: |v| $predicate($crate::statement::take(v)),
            exact: |v| $predicate($crate::statement::take(v)),
            doubles: |v| $predicate($crate::statement::take(v)),
            terms: |v| $predicate($crate::statement::take(v)),
            hints: |_| Vec::new(),
            prepare: |_| {},
        }
    };
}
