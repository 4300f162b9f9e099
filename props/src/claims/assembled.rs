//! Rows 5 and 6 for the solver itself: the discretization that `signorini solve` builds, its matrix, its load, its residual
//! and the numbers that it reports, against the definitions of method (8) over rationals.
//!
//! Random small problems in doubles: two to eight triangles, turned, stretched and sheared, vertices moved and numbered at
//! random, contact on one or two sides (one triangle may own two contact edges), displacements that slide or not, loads and
//! gaps of degree <= 2, tractions with a share of the normal. Every double of the data is a rational number; the definitions
//! (`naive`, `Definition`) are evaluated on these numbers without error, and each number of the solver must be as near to its
//! definition as its own roundings allow: |double - exact| <= c 2^-53 m. Here m is the sum of the magnitudes of the terms of the
//! definition (`Magnitude`: the definition once more, with differences that add), and c is the number of roundings on the longest
//! way from the data to the number, counted by hand for P2 and listed in `roundings`. This is the usual bound to first order,
//! with the terms of the definition in the place of the solver's, which are about as large. A bound that no draw comes near to is
//! no test: the largest ratios of error and bound are reported, and those of `BOUNDS` must exceed `SHARP`.
//!
//! Square roots are given data: the solver's h_T, |E| and n are first compared with the exact squares and normals
//! (`roots`), then both sides use them.

use crate::claim::Outcome;
use crate::draws;

mod compare;
mod definition;
mod draw;
mod given;
mod roots;
pub mod solver;

use compare::{Shares, compared, loops};
use definition::Mistake;
use draw::{Contact, problems};
pub use roots::{
    first_edge_for_the_longest, gamma_by_the_diameter, gamma_by_the_edge, square_roots,
};

/// Some number under each of these names must use up this share of its bound. (One number that is a sum of many terms of
/// either sign, such as J_h, is better than its bound by chance.)
const SHARP: f64 = 1.0 / 1000.0;
const BOUNDS: [&str; 5] = ["A(., .)", "A(u, v) - L(v)", "L(v)", "P(u)", "residual"];

/// A kind of problem, how many to draw, and the class that one of them must be of.
type Kind = (Contact, bool, u32, Option<&'static str>);

const P1_KINDS: [Kind; 6] = [
    (Contact::Any, false, 4, None),
    (Contact::Any, true, 4, None),
    (Contact::Cut, false, 4, Some("an edge is cut")),
    (Contact::Cut, true, 4, Some("an edge is cut")),
    (Contact::Open, false, 2, Some("open")),
    (Contact::Pressed, true, 2, Some("pressed")),
];

const P2_KINDS: [Kind; 5] = [
    (Contact::Any, false, 1, None),
    (Contact::Any, true, 1, None),
    (Contact::Cut, true, 3, Some("an edge is cut")),
    (Contact::Open, false, 1, Some("open")),
    (Contact::Pressed, true, 1, Some("pressed")),
];

fn all_of<const N: usize>(kinds: &[Kind]) -> Outcome {
    let shares = Shares::default();
    let mut found = Vec::new();
    for &(contact, two_sides, cases, class) in kinds {
        let problems = problems(contact, two_sides);
        found.push(draws::hold(cases, problems, class.as_slice(), |draw| {
            // The matrices do not know of the contact.
            compared::<N>(draw, Mistake::None, class.is_none(), &shares)
        })?);
    }
    let shares = shares.into_inner();
    let listed: Vec<String> = shares.iter().map(|(name, s)| format!("{name} {s:.4}")).collect();
    let found = format!("{}; error/bound at most: {}", found.join("; "), listed.join(", "));
    match BOUNDS.iter().find(|name| shares[*name] < SHARP) {
        None => Ok(found),
        Some(name) => Err(format!("no draw comes near to the bound of {name}: {found}")),
    }
}

/// P1: every number of the solver is near its definition.
pub fn p1() -> Outcome {
    all_of::<3>(&P1_KINDS)
}

/// P2 likewise.
pub fn p2() -> Outcome {
    all_of::<6>(&P2_KINDS)
}

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

fn rejected(mistake: Mistake) -> Outcome {
    draws::reject(problems(Contact::Any, true), |draw| {
        compared::<3>(draw, mistake, false, &Shares::default())
    })
}

/// h_T taken wrong: the contact edge, the shortest edge, another triangle.
pub fn diameter_taken_wrong() -> Outcome {
    all_rejected(&[
        Mistake::EdgeLengthForDiameter,
        Mistake::ShortestEdgeForDiameter,
        Mistake::DiameterOfAnotherTriangle,
    ])
}

fn all_rejected(mistakes: &[Mistake]) -> Outcome {
    let each = mistakes.iter().map(|&mistake| Ok(format!("{mistake:?} {}", rejected(mistake)?)));
    each.collect::<Result<Vec<String>, String>>().map(|all| all.join("; "))
}

/// gamma inverted, one contact edge of a triangle with two forgotten, plane strain for plane stress.
pub fn form_taken_wrong() -> Outcome {
    all_rejected(&[
        Mistake::GammaInverted,
        Mistake::ContactEdgeForgotten,
        Mistake::PlaneStrainForStress,
    ])
}

/// theta = -1 and theta = 0, the sign of the gap.
pub fn contact_taken_wrong() -> Outcome {
    all_rejected(&[Mistake::Theta(-1), Mistake::Theta(0), Mistake::GapWithTheWrongSign])
}

/// A traction on another side, the sign of the load, the sign of the reactions.
pub fn load_taken_wrong() -> Outcome {
    all_rejected(&[
        Mistake::TractionOnAnotherSide,
        Mistake::LoadWithTheWrongSign,
        Mistake::ReactionWithTheWrongSign,
    ])
}
