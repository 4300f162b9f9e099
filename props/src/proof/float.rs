//! Doubles as terms of SMT-LIB 2 (`QF_FP`): a predicate run over them becomes problems for a floating-point solver.
//!
//! Nothing is simplified and nothing is decided here: every comparison forks the path, and each path that ends in
//! `Fails` is a problem that must be unsatisfiable over all finite doubles.

use std::cell::RefCell;
use std::cmp::Ordering;
use std::fmt::Write;

use crate::Verdict;
use crate::numbers::number;
use crate::statement::Statement;

#[derive(Default)]
struct Run {
    number: u32,
    terms: Vec<String>,
    /// What was asked on this path, and the answer.
    answers: Vec<(String, bool)>,
    script: Vec<bool>,
    next: usize,
}

thread_local! {
    static RUN: RefCell<Run> = RefCell::new(Run::default());
}

/// A double as a term.
#[derive(Clone, Copy, Debug)]
pub struct Float {
    run: u32,
    index: usize,
}

impl Run {
    fn keep(&mut self, term: String) -> Float {
        self.terms.push(term);
        Float { run: self.number, index: self.terms.len() - 1 }
    }

    fn term(&self, float: Float) -> &str {
        assert_eq!(float.run, self.number, "a term outlived its run");
        &self.terms[float.index]
    }

    fn ask(&mut self, question: String) -> bool {
        if let Some((_, answer)) = self.answers.iter().find(|(asked, _)| *asked == question) {
            return *answer;
        }
        if self.next == self.script.len() {
            self.script.push(true);
        }
        let answer = self.script[self.next];
        self.next += 1;
        self.answers.push((question, answer));
        answer
    }
}

fn applied(operator: &str, operands: &[Float]) -> Float {
    RUN.with_borrow_mut(|run| {
        let mut term = format!("({operator}");
        for &operand in operands {
            let _ = write!(term, " {}", run.term(operand));
        }
        run.keep(term + ")")
    })
}

impl Float {
    fn asked(self, relation: &str, other: Float) -> bool {
        RUN.with_borrow_mut(|run| {
            let question = format!("({relation} {} {})", run.term(self), run.term(other));
            run.ask(question)
        })
    }
}

impl From<i32> for Float {
    fn from(value: i32) -> Float {
        let size = value.unsigned_abs();
        let number = if value < 0 { format!("(- {size}.0)") } else { format!("{size}.0") };
        RUN.with_borrow_mut(|run| run.keep(format!("((_ to_fp 11 53) RNE {number})")))
    }
}

impl PartialEq for Float {
    fn eq(&self, other: &Float) -> bool {
        self.asked("fp.eq", *other)
    }
}

impl PartialOrd for Float {
    fn partial_cmp(&self, other: &Float) -> Option<Ordering> {
        if self == other {
            Some(Ordering::Equal)
        } else if self < other {
            Some(Ordering::Less)
        } else if self > other {
            Some(Ordering::Greater)
        } else {
            None
        }
    }

    fn lt(&self, other: &Float) -> bool {
        self.asked("fp.lt", *other)
    }

    fn le(&self, other: &Float) -> bool {
        self.asked("fp.leq", *other)
    }

    fn gt(&self, other: &Float) -> bool {
        self.asked("fp.gt", *other)
    }

    fn ge(&self, other: &Float) -> bool {
        self.asked("fp.geq", *other)
    }
}

number! { Float:
    + |a, b| applied("fp.add RNE", &[a, b]);
    - |a, b| applied("fp.sub RNE", &[a, b]);
    * |a, b| applied("fp.mul RNE", &[a, b]);
    / |a, b| applied("fp.div RNE", &[a, b]);
    neg |a| applied("fp.neg", &[a]);
    nonpositive |a| a <= Float::from(0);
}

/// The failing paths of a statement: the names of their files, and the problems. That of a statement that must hold is impossible; of
/// a control one is not.
pub fn in_doubles(statement: &Statement, control: bool) -> Vec<(String, String)> {
    let (name, expected) = (statement.name, if control { "unknown" } else { "unsat" });
    let problems = problems(statement.variables, statement.terms).into_iter().enumerate();
    let with_names = |(i, problem): (usize, String)| {
        let head = format!("; {name}, in doubles, path {i}\n; expected: {expected}\n");
        (format!("{name}.double.{i}.smt2"), head + &problem)
    };
    problems.map(with_names).collect()
}

/// The problems of all paths of a predicate that end in `Fails`, for finite unknowns with these names.
pub fn problems(names: &[&str], predicate: fn(&[Float]) -> Verdict) -> Vec<String> {
    let mut problems = Vec::new();
    let mut script = Vec::new();
    loop {
        let (run, verdict) = follow(names, predicate, script);
        if verdict.fails() {
            problems.push(problem(names, &run.answers));
        }
        script = run.script;
        while script.last() == Some(&false) {
            script.pop();
        }
        match script.last_mut() {
            Some(last) => *last = false,
            None => return problems,
        }
    }
}

fn follow(names: &[&str], predicate: fn(&[Float]) -> Verdict, script: Vec<bool>) -> (Run, Verdict) {
    let unknowns: Vec<Float> = RUN.with_borrow_mut(|run| {
        *run = Run { number: run.number + 1, script, ..Run::default() };
        names.iter().map(|name| run.keep((*name).to_owned())).collect()
    });
    let verdict = predicate(&unknowns);
    let run = RUN.with_borrow_mut(|run| {
        let number = run.number + 1;
        std::mem::replace(run, Run { number, ..Run::default() })
    });
    (run, verdict)
}

fn problem(names: &[&str], answers: &[(String, bool)]) -> String {
    let mut text = "(set-logic QF_FP)\n".to_owned();
    for name in names {
        let _ = writeln!(text, "(declare-const {name} Float64)");
        let _ = writeln!(text, "(assert (not (or (fp.isNaN {name}) (fp.isInfinite {name}))))");
    }
    for (question, answer) in answers {
        let fact = if *answer { question.clone() } else { format!("(not {question})") };
        let _ = writeln!(text, "(assert {fact})");
    }
    text + "(check-sat)\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::Ordered;
    use crate::{ensure, given, statement::take};

    fn negatives_have_no_positive_part<S: Ordered>([a]: [S; 1]) -> Verdict {
        given!(a < S::from(-1));
        ensure!(signorini::kernel::positive_part(a) * a == S::from(0));
        Verdict::Holds("")
    }

    #[test]
    fn every_failing_path_becomes_a_problem() {
        let found = problems(&["a"], |v| negatives_have_no_positive_part(take(v)));
        let constant = |text: &str| format!("((_ to_fp 11 53) RNE {text})");
        let (zero, minus_one) = (constant("0.0"), constant("(- 1.0)"));
        let head = format!(
            "(set-logic QF_FP)\n(declare-const a Float64)\n\
             (assert (not (or (fp.isNaN a) (fp.isInfinite a))))\n(assert (fp.lt a {minus_one}))\n"
        );
        let first = format!(
            "(assert (fp.leq a {zero}))\n(assert (not (fp.eq (fp.mul RNE {zero} a) {zero})))\n(check-sat)\n"
        );
        let second = format!(
            "(assert (not (fp.leq a {zero})))\n(assert (not (fp.eq (fp.mul RNE a a) {zero})))\n(check-sat)\n"
        );
        assert_eq!(found, [head.clone() + &first, head + &second]);
    }
}
