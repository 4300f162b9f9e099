//! The proof engine itself: what is false is refused, and true neighbours of it are proved. Its trusted part has tests of its
//! own (`proof`); here it is asked like any other engine, by statements that it has not been built for.

use crate::claim::{Check, Claim, Engine, by, false_statement};
use crate::claims::falsehoods;

/// The row.
pub fn claim() -> Claim {
    let mut checks: Vec<Check> = vec![
        by(
            Engine::Proof,
            "true_neighbours_of_false_statements_are_proved",
            falsehoods::neighbours_are_proved,
        )
        .about(&["the proof engine"]),
    ];
    checks.extend(falsehoods::all().into_iter().map(false_statement));
    Claim {
        id: "23",
        title: "The proof engine refuses what is false",
        paper: "Nothing: the paper is proved by hand.",
        statement: "Each of 60 false statements is refused, not for its form: true neighbours of them are proved. Where a rational point refutes it, one is found at which the very conclusion fails that is wrong; the others have no rational counterexample (a root of two), or a hypothesis or a class that nothing meets. They are wrong by a sign, a case without a tie, a branch exchanged; an inequality multiplied or divided by what may be negative, a factor cancelled that may be zero, a division by what is zero at a single point or on one side of a case; the larger taken for the smaller, the chord for the tangent; a lemma that is wrong before a conclusion that is right; by a millionth; or they are true of integers and rationals only. Powers of degree 4095 keep their exponents, and of larger ones than 2^16 nothing is proved.",
        numbers: "every ordered field (proof).",
        preconditions: "None.",
        limits: "That the engine refuses these does not say that it refuses all that is false: for this there is the checker of certificates, in this crate and in `reference/check_certificates.py`.",
        single: Some("The row is about this engine."),
        checks,
    }
}
