//! Rows 5 and 6 for the solver itself: the loops of the discretization that `signorini solve` builds, its load and gamma, against
//! the definitions of method (8) over rationals.
//!
//! Random small problems in doubles: two to eight triangles, turned, stretched and sheared, vertices moved and numbered at
//! random, contact on one or two sides (one triangle may own two contact edges), displacements that slide or not, loads and
//! gaps of degree <= 2, tractions with a share of the normal. Every double of the data is a rational number; the definitions
//! (`naive`, `Definition`) are evaluated on these numbers without error. Every other number of the solver is compared with them in
//! `props/tests/program/assembled.rs`, within the roundings that are counted in `compare`.

use crate::claim::Outcome;
use crate::draws;

pub(crate) mod compare;
pub(crate) mod definition;
pub(crate) mod draw;
pub(crate) mod given;
pub(crate) mod roots;

use compare::{loads, loops};
use definition::Mistake;
use draw::{Contact, problems};
pub use roots::{gamma_by_the_diameter, gamma_by_the_edge};

/// A kind of problem, how many to draw, and the class that one of them must be of.
pub(crate) type Kind = (Contact, bool, u32, Option<&'static str>);

pub(crate) const P1_KINDS: [Kind; 6] = [
    (Contact::Any, false, 4, None),
    (Contact::Any, true, 4, None),
    (Contact::Cut, false, 4, Some("an edge is cut")),
    (Contact::Cut, true, 4, Some("an edge is cut")),
    (Contact::Open, false, 2, Some("open")),
    (Contact::Pressed, true, 2, Some("pressed")),
];

pub(crate) const P2_KINDS: [Kind; 5] = [
    (Contact::Any, false, 1, None),
    (Contact::Any, true, 1, None),
    (Contact::Cut, true, 3, Some("an edge is cut")),
    (Contact::Open, false, 1, Some("open")),
    (Contact::Pressed, true, 1, Some("pressed")),
];

/// The loops of the solver over rationals are the definitions, to the last digit: P1 and P2.
pub fn loops_over_rationals() -> Outcome {
    Ok(format!("{}; {}", loops_of::<3>(&P1_KINDS, 2)?, loops_of::<6>(&P2_KINDS, 1)?))
}

/// Compares the loops with the definitions on `share` times as many draws of each kind as it has.
fn loops_of<const N: usize>(kinds: &[Kind], share: u32) -> Outcome {
    let one = |&(contact, two_sides, cases, ref class): &Kind| {
        let problems = problems(contact, two_sides);
        draws::hold(share * cases, problems, class.as_slice(), |draw| {
            loops::<N>(draw, Mistake::None)
        })
    };
    Ok(kinds.iter().map(one).collect::<Result<Vec<_>, String>>()?.join("; "))
}

/// Compares the loops with definitions that have a mistake.
pub fn loops_beside_other_definitions() -> Outcome {
    let mistakes = [
        Mistake::GammaInverted,
        Mistake::EdgeLengthForDiameter,
        Mistake::LameExchanged,
        Mistake::Theta(-1),
        Mistake::Theta(0),
        Mistake::GapWithTheWrongSign,
    ];
    let rejected = |mistake| {
        let problems = problems(Contact::Any, true);
        let said = draws::reject(problems, |draw| loops::<3>(draw, mistake))?;
        Ok(format!("{mistake:?} {said}"))
    };
    mistakes.map(rejected).into_iter().collect::<Result<Vec<_>, String>>().map(|all| all.join("; "))
}

/// L(v) of the solver, P1 and P2.
pub fn loads_of_the_solver() -> Outcome {
    let p1 = draws::hold(20, problems(Contact::Any, false), &["near"], |draw| {
        loads::<3>(draw, Mistake::None)
    })?;
    let p2 = draws::hold(8, problems(Contact::Any, true), &["near"], |draw| {
        loads::<6>(draw, Mistake::None)
    })?;
    Ok(format!("P1: {p1}; P2: {p2}"))
}

/// A traction on another side, the sign of the load.
pub fn load_taken_wrong() -> Outcome {
    let rejected = |mistake| {
        draws::reject(problems(Contact::Any, true), move |draw| loads::<3>(draw, mistake))
    };
    rejected(Mistake::TractionOnAnotherSide)?;
    rejected(Mistake::LoadWithTheWrongSign)
}
