//! A claim: an item of the paper, what is said about it here, and the checks that say so. Tests, ledger and audit walk
//! over the same claims, so no name in `VERIFY.md` can go stale.

use std::any::Any;
use std::panic::{self, AssertUnwindSafe};

use crate::draws;
use crate::harness::Harness;
use crate::proof;
use crate::receipt;
use crate::statement::Statement;

/// What a check answers: a line of evidence, or what went wrong.
pub type Outcome = Result<String, String>;

/// By which means a check looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Engine {
    /// All paths over symbols; failing ones refuted by checked certificates.
    Proof,
    /// Random data, exact rationals, no tolerance.
    Exact,
    /// Random data over all finite doubles, or doubles against exact rationals with a stated bound.
    Doubles,
    /// A harness for the model checker Kani, run here on random draws.
    Harness,
}

impl Engine {
    /// Its name. What a harness is by itself: the model checker is behind it where a receipt says so
    /// ([`Check::engine_name`]).
    pub fn name(self) -> &'static str {
        match self {
            Engine::Proof => "proof",
            Engine::Exact => "exact",
            Engine::Doubles => "doubles",
            Engine::Harness => "draws",
        }
    }
}

/// What a check runs.
#[derive(Clone, Copy)]
pub enum Subject {
    /// A statement, by the check's engine.
    Statement(Statement),
    /// A function of its own, and where it says what is compared.
    Function(fn() -> Outcome, Stated),
    /// A harness.
    Harness(Harness),
}

/// Where a check by a function of its own is to be read.
#[derive(Clone, Copy, Debug)]
pub enum Stated {
    /// The function that states what is compared, or that plants the mistake of a control: its name, after the name of its module
    /// and `::` where that is not the module of the row.
    In(&'static str),
    /// The same of a control whose mistake stands in the line of the row's list.
    At(&'static str),
}

impl Stated {
    /// The function, with its module.
    pub fn by(self) -> &'static str {
        match self {
            Stated::In(function) | Stated::At(function) => function,
        }
    }
}

/// One piece of evidence.
#[derive(Clone, Copy)]
pub struct Check {
    /// A sentence that is true when the check passes (underscores for blanks).
    pub name: &'static str,
    /// By which means.
    pub engine: Engine,
    /// A negative control: a planted mistake that must be rejected.
    pub control: bool,
    /// The items of the paper that it is about: names of [`crate::items`].
    pub items: &'static [&'static str],
    /// What is run.
    pub subject: Subject,
    /// How many draws a function of its own makes at least, if it is said.
    pub draws: u32,
}

impl Check {
    /// The check as evidence for these items of the paper.
    pub fn about(self, items: &'static [&'static str]) -> Check {
        Check { items, ..self }
    }

    /// Its engine in the ledger: that of a harness is the model checker where the newest receipt says so; where it has few values,
    /// all of them are run; else random draws.
    pub fn engine_name(&self) -> &'static str {
        match self.subject {
            Subject::Harness(harness) if receipt::is_verified(&harness) => "Kani",
            Subject::Harness(harness) if receipt::is_decided(&harness) => "all cases",
            _ => self.engine.name(),
        }
    }

    /// Runs it. One that panics has failed, a control too: where a polynomial that a claim writes down has a power that can't be
    /// kept, nothing is proved.
    ///
    /// # Errors
    /// What was found instead.
    pub fn run(&self) -> Outcome {
        let run = AssertUnwindSafe(|| draws::named(self.name, || self.run_here()));
        panic::catch_unwind(run).unwrap_or_else(|why| Err(format!("it panicked: {}", said(&*why))))
    }

    fn run_here(&self) -> Outcome {
        match (self.subject, self.engine, self.control) {
            (Subject::Function(run, _), _, _) => run(),
            (Subject::Harness(harness), _, _) => harness.run(),
            (Subject::Statement(s), Engine::Proof, false) => proof::prove(&s),
            (Subject::Statement(s), Engine::Proof, true) => proof::refute(&s),
            (Subject::Statement(s), Engine::Exact, false) => draws::hold_exactly(&s),
            (Subject::Statement(s), Engine::Doubles, false) => draws::hold_in_doubles(&s),
            (Subject::Statement(s), Engine::Doubles, true) => draws::reject_in_doubles(&s),
            (Subject::Statement(_), _, _) => Err("this engine has no such check".to_owned()),
        }
    }
}

/// What a panic said.
pub(crate) fn said(why: &(dyn Any + Send)) -> String {
    let text = why.downcast_ref::<&str>().map(|s| (*s).to_owned());
    text.or_else(|| why.downcast_ref::<String>().cloned()).unwrap_or_default()
}

/// Proved over every ordered field.
pub fn proved(statement: Statement) -> Check {
    of_statement(statement, Engine::Proof, false)
}

/// Tested over exact rationals.
pub fn tested(statement: Statement) -> Check {
    of_statement(statement, Engine::Exact, false)
}

/// Tested over all finite doubles.
pub fn in_doubles(statement: Statement) -> Check {
    of_statement(statement, Engine::Doubles, false)
}

/// A planted mistake, refuted by an exact counterexample.
pub fn refuted(statement: Statement) -> Check {
    of_statement(statement, Engine::Proof, true)
}

/// A statement that is false in doubles, refuted by a draw.
pub fn refuted_in_doubles(statement: Statement) -> Check {
    of_statement(statement, Engine::Doubles, true)
}

fn of_statement(statement: Statement, engine: Engine, control: bool) -> Check {
    Check {
        name: statement.name,
        engine,
        control,
        items: &[],
        subject: Subject::Statement(statement),
        draws: 0,
    }
}

/// A check by a function of its own; where its name begins with `control_`, a negative control.
pub fn by(engine: Engine, name: &'static str, stated: Stated, run: fn() -> Outcome) -> Check {
    let control = name.starts_with("control_");
    Check { name, engine, control, items: &[], subject: Subject::Function(run, stated), draws: 0 }
}

/// A check by this engine, as [`exact!`] has it.
macro_rules! by {
    ($engine:ident, $name:literal, in $function:path $(, draws $draws:literal)? => $run:expr) => {
        $crate::claim::Check {
            draws: 0 $(+ $draws)?,
            ..by!(@ $engine, $name, $crate::claim::Stated::In(stringify!($function)), $run)
        }
    };
    ($engine:ident, $name:literal, at $function:path => $run:expr) => {
        by!(@ $engine, $name, $crate::claim::Stated::At(stringify!($function)), $run)
    };
    (@ $engine:ident, $name:literal, $stated:expr, $run:expr) => {
        $crate::claim::by($crate::claim::Engine::$engine, $name, $stated, || $run)
    };
}

/// `exact!("name", in FUNCTION => outcome)`: a check in exact numbers, on one line of a row's list. FUNCTION says what is
/// compared; `at` for `in` says that the mistake of a control stands in the line itself; `draws N` behind it, how many there are.
macro_rules! exact {
    ($($check:tt)+) => {
        by!(Exact, $($check)+)
    };
}

/// `doubles!("name", in FUNCTION => outcome)`: a check in doubles.
macro_rules! doubles {
    ($($check:tt)+) => {
        by!(Doubles, $($check)+)
    };
}

/// `statements! { WAYS NAME[UNKNOWNS]: CLASSES fails CONCLUSION about ITEMS hints(HINTS) prepared(PREPARE); .. }`: statements with
/// the checks that each of them is, such as `proved + tested`, as a table. One without classes and without a conclusion that
/// must fail holds always.
macro_rules! statements {
    (@of $name:ident $unknowns:tt) => {
        $crate::statement!($name, $unknowns, ["always"])
    };
    (@of $name:ident $unknowns:tt $(: $($class:literal),+)? fails $conclusion:literal) => {
        $crate::statement!($name, $unknowns, fails $conclusion)
    };
    (@of $name:ident $unknowns:tt : $($class:literal),+) => {
        $crate::statement!($name, $unknowns, [$($class),+])
    };
    ($($way:ident $(+ $other:ident)* $name:ident $unknowns:tt $(: $($class:literal),+)? $(fails $conclusion:literal)?
        $(about $($item:literal),+)? $(hints($hints:expr))? $(prepared($prepare:expr))?;)+) => {{
        let mut checks: Vec<$crate::claim::Check> = Vec::new();
        $(
            let statement = statements!(@of $name $unknowns $(: $($class),+)? $(fails $conclusion)?)
                $(.with_hints($hints))?
                $(.prepared($prepare))?;
            let items = &[$($($item),+)?];
            checks.push($crate::claim::$way(statement).about(items));
            $(checks.push($crate::claim::$other(statement).about(items));)*
        )+
        checks
    }};
}

/// Harnesses, as evidence for these items or, if they are the false twins of some, as controls.
pub fn model_checked(harnesses: &[Harness], items: &'static [&'static str]) -> Vec<Check> {
    let one = |&harness: &Harness| Check {
        name: harness.name,
        engine: Engine::Harness,
        control: harness.counterexample.is_some(),
        items,
        subject: Subject::Harness(harness),
        draws: 0,
    };
    harnesses.iter().map(one).collect()
}

/// The words of an error that a check did not expect.
pub fn text(error: impl ToString) -> String {
    error.to_string()
}

/// The outcome of a control that runs a check with a planted mistake: that must not pass.
///
/// # Errors
/// What the check said where it passed.
pub fn noticed(outcome: Outcome) -> Outcome {
    match outcome {
        Err(why) => Ok(format!("rejected: {why}")),
        Ok(said) => Err(format!("not noticed: {said}")),
    }
}

/// How [`Claim::paper`] begins in a row about something that the paper does not have.
const NOT_IN_THE_PAPER: &str = "Nothing: ";

impl Claim {
    /// Whether it is about the paper.
    pub fn is_about_the_paper(&self) -> bool {
        !self.paper.starts_with(NOT_IN_THE_PAPER)
    }
}

/// One row of the ledger.
pub struct Claim {
    /// Its number in the ledger.
    pub id: &'static str,
    /// A title.
    pub title: &'static str,
    /// The paper's words, where no item has them.
    pub paper: &'static str,
    /// What this does not establish, where no item says so; and why evidence of fewer than two engines is all there is, where that
    /// is so.
    pub limits: &'static str,
    /// The evidence.
    pub checks: Vec<Check>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proof::polynomial::Polynomial;

    const HERE: Stated = Stated::In("too_large_a_power");

    /// x^(2^16), as a claim may write it down.
    fn too_large_a_power() -> Outcome {
        let x = Polynomial::variable(0);
        let power = (0..16).fold(x, |power, _| &power * &power);
        Ok(format!("{} terms", power.terms().count()))
    }

    #[test]
    fn a_check_that_panics_has_failed_and_a_control_is_not_passed_by_it() {
        let check = by(Engine::Exact, "too_large_a_power", HERE, too_large_a_power);
        let why = check.run().unwrap_err();
        assert!(why.contains("it panicked") && why.contains("exponents below 2^16"), "{why}");
        let control = by(Engine::Exact, "control_too_large_a_power", HERE, too_large_a_power);
        assert!(control.control && control.run().is_err());
    }
}
