//! Errors of a pair of boundaries.

use thiserror::Error;

use crate::quote::{number, quoted, short};

/// Errors of a pair of boundaries. A pair is called by the names of its boundaries.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
pub enum PairError {
    #[error("the pair of {0} with itself; expected two boundaries", quoted(boundary, '\''))]
    Same { boundary: String },
    #[error("{} is given twice; expected each pair once", named(pair))]
    Twice { pair: [String; 2] },
    #[error(
        "the boundary {} has a condition and is in {}; expected one of the two (contact is what the pair says)",
        quoted(boundary, '\''),
        named(pair)
    )]
    Occupied { boundary: String, pair: [String; 2] },
    #[error("the reach of {} is {reach}; expected a positive length", named(pair))]
    Reach { pair: [String; 2], reach: f64 },
    #[error(
        "the reach of {} is {}, and the boundary at {} has a radius of {}: beyond {} a point would face several others; expected a smaller reach",
        named(pair), number(*reach), at(place), short(*radius), short(*most)
    )]
    TooFar { pair: [String; 2], reach: f64, most: f64, radius: f64, place: [f64; 2] },
    #[error(
        "the boundaries of {} share the vertex at {}: there the bodies are one; {SPLIT}",
        named(pair),
        at(place)
    )]
    Shared { pair: [String; 2], place: [f64; 2] },
    #[error(
        "{} of {} has an edge from {} to {} between two triangles: there the bodies are one; {SPLIT}",
        quoted(boundary, '\''), named(pair), at(&ends[0]), at(&ends[1])
    )]
    Inner { boundary: String, pair: [String; 2], ends: [[f64; 2]; 2] },
    #[error(
        "the boundaries of {} face each other nowhere within the reach of {}: they come closest at {} and {}, {} apart; expected outward normals that are opposite there, and a reach above the gap",
        named(pair), short(*reach), near(&places[0]), near(&places[1]), short(*distance)
    )]
    NoPartner { pair: [String; 2], reach: f64, places: [[f64; 2]; 2], distance: f64 },
    #[error(
        "in {} the corner at {} meets the corner at {}: neither faces a side of the other, and contact between them has no direction; expected a corner that is rounded, or a boundary that goes on beside it",
        named(pair), at(&places[0]), at(&places[1])
    )]
    Corners { pair: [String; 2], places: [[f64; 2]; 2] },
}

const SPLIT: &str = "expected a mesh in which each body has vertices of its own (surfaces = [..] in place of boundaries splits the mesh along the curve between two surfaces)";

/// A pair in a message.
pub(crate) fn named([first, second]: &[String; 2]) -> String {
    format!("the pair of {} and {}", quoted(first, '\''), quoted(second, '\''))
}

fn at([x, y]: &[f64; 2]) -> String {
    // Adding 0.0 spares the reader a -0.
    format!("({}, {})", number(x + 0.0), number(y + 0.0))
}

/// A place that is computed, to six digits.
fn near(place: &[f64; 2]) -> String {
    at(&place.map(|x| format!("{x:.5e}").parse().unwrap_or(x)))
}
