//! Symbols: numbers that stand for a polynomial in the unknowns of a statement. Asking one for its sign forks the path.
//!
//! A run knows for each (monic) polynomial that was asked about which signs are still possible on this path. A question
//! whose answer is implied forks nothing; any other is answered one way now and the other ways in later runs, and the
//! answer is remembered. A division by something that isn't a constant asks whether it is zero: the path on which it is
//! has failed; on the others a new variable stands for the inverse. A path on which a power grows too large has failed too.
//!
//! Trusted: `ask` and the operators decide which paths there are.

use std::cell::{Cell, RefCell};
use std::cmp::Ordering;
use std::collections::BTreeMap;

use num_rational::BigRational;
use num_traits::{Signed, Zero};

use super::polynomial::{Polynomial, integer};
use crate::numbers::number;

/// A set of signs: from the right, a bit for negative, for zero and for positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signs(u8);

impl Signs {
    pub(super) const NEGATIVE: Signs = Signs(0b001);
    pub(super) const ZERO: Signs = Signs(0b010);
    pub(super) const POSITIVE: Signs = Signs(0b100);
    const ALL: Signs = Signs(0b111);
    pub(super) const NONPOSITIVE: Signs = Signs(0b011);
    pub(super) const NONNEGATIVE: Signs = Signs(0b110);

    fn of(value: &BigRational) -> Signs {
        if value.is_zero() {
            Signs::ZERO
        } else if value.is_negative() {
            Signs::NEGATIVE
        } else {
            Signs::POSITIVE
        }
    }

    fn and(self, other: Signs) -> Signs {
        Signs(self.0 & other.0)
    }

    fn not(self) -> Signs {
        Signs(Signs::ALL.0 & !self.0)
    }

    /// The signs of -p for the signs of p.
    fn mirrored(self) -> Signs {
        Signs(self.0.reverse_bits() >> 5)
    }

    /// The relation to zero that says the same of a number; `None` if there is none.
    pub fn relation(self) -> Option<&'static str> {
        match self {
            Signs::NEGATIVE => Some("<"),
            Signs::NONPOSITIVE => Some("<="),
            Signs::ZERO => Some("="),
            Signs::NONNEGATIVE => Some(">="),
            Signs::POSITIVE => Some(">"),
            _ => None,
        }
    }

    /// Its convex parts: "not zero" is two of them.
    fn parts(self) -> Vec<Signs> {
        match self {
            Signs(0b000) => Vec::new(),
            Signs(0b101) => vec![Signs::NEGATIVE, Signs::POSITIVE],
            convex => vec![convex],
        }
    }
}

/// A decision of the current run: which answer, of how many.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    pub(super) answer: usize,
    pub(super) of: usize,
}

/// What a run did, in order: from the steps of all paths their tree can be put together again, without the predicate.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// The sign of a polynomial was asked for; from here on it is one of these.
    Asked(Polynomial, Signs),
    /// The variable with this number stands for the inverse of a polynomial, which is not zero here.
    Inverted(Polynomial, usize),
}

/// One run of a predicate along one path.
#[derive(Default)]
pub(super) struct Run {
    number: u32,
    values: Vec<Polynomial>,
    pub(super) signs: BTreeMap<Polynomial, Signs>,
    /// Monic divisors and the variables that stand for their inverses.
    pub(super) inverses: Vec<(Polynomial, usize)>,
    pub(super) variables: usize,
    pub(super) steps: Vec<Step>,
    pub(super) script: Vec<Choice>,
    next: usize,
    pub(super) failed: Option<&'static str>,
}

/// Why a path fails on which a number is multiplied so often that its power can't be kept: nothing is proved of it.
const TOO_LARGE: &str = "a power beyond 2^16";

thread_local! {
    static RUN: RefCell<Run> = RefCell::new(Run::default());
    /// How many runs were started: each has a number of its own, and 0 belongs to none.
    static STARTED: Cell<u32> = const { Cell::new(0) };
}

/// Starts a run with `variables` unknowns that follows `script` and extends it at new questions.
pub(super) fn start(variables: usize, script: Vec<Choice>) -> Vec<Sym> {
    STARTED.set(STARTED.get() + 1);
    RUN.set(Run { number: STARTED.get(), variables, script, ..Run::default() });
    (0..variables).map(|i| Sym::new(Polynomial::variable(i))).collect()
}

/// Ends the run and hands it over.
pub(super) fn finish() -> Run {
    RUN.take()
}

impl Run {
    /// Whether the sign of `p` is in `yes` on this path.
    fn ask(&mut self, p: &Polynomial, yes: Signs) -> bool {
        if self.failed.is_some() {
            return false;
        }
        if let Some(value) = p.as_constant() {
            return Signs::of(&value).and(yes) != Signs(0);
        }
        let (monic, lead) = p.monic();
        let yes = if lead.is_negative() { yes.mirrored() } else { yes };
        let known = self.signs.get(&monic).copied().unwrap_or(Signs::ALL);
        let mut answers: Vec<(bool, Signs)> = Vec::new();
        answers.extend(known.and(yes).parts().into_iter().map(|part| (true, part)));
        answers.extend(known.and(yes.not()).parts().into_iter().map(|part| (false, part)));
        if answers.len() == 1 {
            return answers[0].0;
        }
        let (answer, part) = answers[self.choose(answers.len())];
        self.steps.push(Step::Asked(monic.clone(), part));
        self.signs.insert(monic, part);
        answer
    }

    fn choose(&mut self, of: usize) -> usize {
        if self.next == self.script.len() {
            self.script.push(Choice { answer: 0, of });
        }
        let choice = self.script[self.next];
        assert_eq!(choice.of, of, "a predicate must be a function of its arguments");
        self.next += 1;
        choice.answer
    }

    /// 1 / divisor, or nothing on the path where it is zero. A path that has failed gets no further inverses: a fact
    /// x m = 1 that it is given after m = 0 would contradict it, and excuse the division by zero.
    fn inverse(&mut self, divisor: &Polynomial) -> Option<Polynomial> {
        if self.failed.is_some() {
            return None;
        }
        if let Some(value) = divisor.as_constant() {
            return (!value.is_zero()).then(|| Polynomial::constant(value.recip()));
        }
        if self.ask(divisor, Signs::ZERO) {
            return None;
        }
        let (monic, lead) = divisor.monic();
        let known =
            self.inverses.iter().find(|(of, _)| *of == monic).map(|&(_, variable)| variable);
        let variable = known.unwrap_or_else(|| self.new_inverse(&monic));
        Some(Polynomial::variable(variable).scaled(&lead.recip()))
    }

    /// A new variable x with m x = 1 and the sign of m, which is known here.
    fn new_inverse(&mut self, monic: &Polynomial) -> usize {
        let variable = self.variables;
        self.variables += 1;
        self.inverses.push((monic.clone(), variable));
        self.steps.push(Step::Inverted(monic.clone(), variable));
        let x = Polynomial::variable(variable);
        let one = Polynomial::constant(integer(1));
        // x is new, so no power grows.
        if let Some(product) = monic.times(&x) {
            self.signs.insert((&product - &one).monic().0, Signs::ZERO);
        }
        if let Some(&sign) = self.signs.get(monic) {
            self.signs.insert(x, sign);
        }
        variable
    }

    fn value(&self, symbol: Sym) -> &Polynomial {
        assert_eq!(symbol.run, self.number, "a symbol outlived its run");
        &self.values[symbol.index as usize]
    }

    /// Keeps a value; where there is none, the path fails.
    fn keep_or_fail(&mut self, value: Result<Polynomial, &'static str>) -> Sym {
        let value = value.unwrap_or_else(|why| {
            self.failed.get_or_insert(why);
            Polynomial::default()
        });
        self.keep(value)
    }

    fn keep(&mut self, value: Polynomial) -> Sym {
        self.values.push(value);
        let index = u32::try_from(self.values.len() - 1).expect("fewer than 2^32 symbols");
        Sym { run: self.number, index }
    }
}

/// A polynomial in the unknowns of the current run.
#[derive(Clone, Copy, Debug)]
pub struct Sym {
    run: u32,
    index: u32,
}

impl Sym {
    /// The symbol with this value.
    pub fn new(value: Polynomial) -> Sym {
        RUN.with_borrow_mut(|run| run.keep(value))
    }

    /// Its value.
    pub fn polynomial(self) -> Polynomial {
        RUN.with_borrow(|run| run.value(self).clone())
    }

    fn ask(self, other: Sym, yes: Signs) -> bool {
        RUN.with_borrow_mut(|run| {
            let difference = run.value(self) - run.value(other);
            run.ask(&difference, yes)
        })
    }

    fn combined(self, other: Sym, work: impl Fn(&Polynomial, &Polynomial) -> Polynomial) -> Sym {
        RUN.with_borrow_mut(|run| {
            let value = work(run.value(self), run.value(other));
            run.keep(value)
        })
    }
}

impl From<i32> for Sym {
    fn from(value: i32) -> Sym {
        Sym::new(Polynomial::constant(integer(i64::from(value))))
    }
}

impl PartialEq for Sym {
    fn eq(&self, other: &Sym) -> bool {
        self.ask(*other, Signs::ZERO)
    }
}

impl PartialOrd for Sym {
    fn partial_cmp(&self, other: &Sym) -> Option<Ordering> {
        Some(if self < other {
            Ordering::Less
        } else if self > other {
            Ordering::Greater
        } else {
            Ordering::Equal
        })
    }

    fn lt(&self, other: &Sym) -> bool {
        self.ask(*other, Signs::NEGATIVE)
    }

    fn le(&self, other: &Sym) -> bool {
        self.ask(*other, Signs::NONPOSITIVE)
    }

    fn gt(&self, other: &Sym) -> bool {
        self.ask(*other, Signs::POSITIVE)
    }

    fn ge(&self, other: &Sym) -> bool {
        self.ask(*other, Signs::NONNEGATIVE)
    }
}

number! { Sym:
    + |a, b| a.combined(b, |a, b| a + b);
    - |a, b| a.combined(b, |a, b| a - b);
    * |a, b| RUN.with_borrow_mut(|run| {
        let product = run.value(a).times(run.value(b)).ok_or(TOO_LARGE);
        run.keep_or_fail(product)
    });
    / |a, b| RUN.with_borrow_mut(|run| {
        let (a, b) = (run.value(a).clone(), run.value(b).clone());
        let quotient = match run.inverse(&b) {
            Some(inverse) => a.times(&inverse).ok_or(TOO_LARGE),
            None => Err("division by zero"),
        };
        run.keep_or_fail(quotient)
    });
    neg |a| Sym::from(0) - a;
    nonpositive |a| a <= Sym::from(0);
}

#[cfg(test)]
mod tests {
    use signorini::kernel::Scalar;

    use super::*;

    #[test]
    fn signs_mirror_and_fall_into_convex_parts() {
        assert_eq!(Signs::NONPOSITIVE.mirrored(), Signs::NONNEGATIVE);
        assert_eq!(Signs::NEGATIVE.mirrored(), Signs::POSITIVE);
        assert_eq!(Signs::ZERO.mirrored(), Signs::ZERO);
        assert_eq!(Signs::ZERO.not().parts(), [Signs::NEGATIVE, Signs::POSITIVE]);
        assert_eq!(Signs::NONPOSITIVE.parts(), [Signs::NONPOSITIVE]);
    }

    #[test]
    fn operations_of_symbols_are_those_of_their_polynomials() {
        let v = start(2, Vec::new());
        let (x, y) = (Polynomial::variable(0), Polynomial::variable(1));
        let half = integer(1) / integer(2);
        let cases = [
            (v[0] + v[1], &x + &y),
            (v[0] - v[1], &x - &y),
            (v[0] * v[1], &x * &y),
            (-v[0], -&x),
            (v[0] / Sym::from(2), x.scaled(&half)),
            (Sym::from(-3), Polynomial::constant(integer(-3))),
        ];
        for (symbol, polynomial) in cases {
            assert_eq!(symbol.polynomial(), polynomial);
        }
        finish();
    }

    #[test]
    fn constants_are_in_the_order_of_the_integers() {
        start(0, Vec::new());
        for (a, b) in [(-1, 1), (1, -1), (2, 2), (0, 3), (0, -3)] {
            let (m, n) = (Sym::from(a), Sym::from(b));
            assert_eq!(m.partial_cmp(&n), a.partial_cmp(&b));
            let answers = [m < n, m <= n, m == n, m >= n, m > n];
            assert_eq!(answers, [a < b, a <= b, a == b, a >= b, a > b]);
        }
        assert!(finish().script.is_empty());
    }

    #[test]
    fn only_positive_constants_go_the_positive_way() {
        start(0, Vec::new());
        for (value, expected) in [(-1, 10), (0, 10), (1, 20)] {
            let way = Sym::from(value).split(|_| Sym::from(10), |_| Sym::from(20));
            assert_eq!(way.polynomial(), Polynomial::constant(integer(expected)));
        }
        finish();
    }

    #[test]
    #[should_panic(expected = "a symbol outlived its run")]
    fn a_symbol_does_not_outlive_its_run() {
        let late = start(1, Vec::new())[0];
        finish();
        let _ = late + Sym::from(1);
    }

    #[test]
    #[should_panic(expected = "a symbol outlived its run")]
    fn a_symbol_does_not_live_on_in_the_next_run() {
        let late = start(1, Vec::new())[0];
        let _ = late + start(1, Vec::new())[0];
    }
}
