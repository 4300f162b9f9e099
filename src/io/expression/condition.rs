//! Conditions on a place, as `where` of a boundary has them: `abs(y) < 1e-9`, `0 <= x <= 2 and y > 1`.
//!
//! ```text
//! condition   = conjunction { "or" conjunction }
//! conjunction = comparison { "and" comparison }
//! comparison  = expression relation expression [ relation expression ]
//! relation    = "<" | "<=" | ">" | ">="
//! ```
//!
//! There is no "=": coordinates that are meant to be equal may differ by rounding. A comparison with a NaN does not hold.

use std::str::FromStr;

use super::{Expression, ExpressionError};
use crate::quote::quoted;

/// A condition on a place; made by [`str::parse`].
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceCondition {
    /// One of these lists must hold, and of that list each comparison.
    alternatives: Vec<Vec<Comparison>>,
}

#[derive(Clone, Debug, PartialEq)]
struct Comparison {
    sides: [Expression; 2],
    or_equal: bool,
}

impl PlaceCondition {
    /// Returns whether it holds at (x, y).
    pub(crate) fn holds(&self, at: [f64; 2]) -> bool {
        self.alternatives.iter().any(|all| all.iter().all(|comparison| comparison.holds(at)))
    }
}

impl Comparison {
    fn holds(&self, at: [f64; 2]) -> bool {
        let [low, high] = self.sides.each_ref().map(|side| side.evaluate(at));
        if self.or_equal { low <= high } else { low < high }
    }
}

const RELATION: &str = "a comparison: <, <=, > or >=, such as abs(y) < 1e-9";

impl FromStr for PlaceCondition {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<PlaceCondition, ExpressionError> {
        let mut alternatives = Vec::new();
        for alternative in split(text, 0, "or") {
            let mut all = Vec::new();
            for (start, part) in split(alternative.1, alternative.0, "and") {
                all.extend(comparisons(text, start, part)?);
            }
            alternatives.push(all);
        }
        Ok(PlaceCondition { alternatives })
    }
}

/// The parts of a text between a word, each with the byte where it starts in the whole.
fn split<'t>(text: &'t str, from: usize, word: &str) -> Vec<(usize, &'t str)> {
    let mut parts = Vec::new();
    let mut start = 0;
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    for (at, _) in text.match_indices(word) {
        let after = at + word.len();
        if !text[..at].ends_with(is_letter) && !text[after..].starts_with(is_letter) && at >= start
        {
            parts.push((from + start, &text[start..at]));
            start = after;
        }
    }
    parts.push((from + start, &text[start..]));
    parts
}

/// The one or two comparisons of a part of `text` that starts at this byte.
fn comparisons(text: &str, start: usize, part: &str) -> Result<Vec<Comparison>, ExpressionError> {
    let column = |byte: usize| text[..byte].chars().count() + 1;
    let wrong = |byte: usize, found: &str, expected: &str| ExpressionError {
        column: column(byte),
        found: found.to_owned(),
        expected: expected.to_owned(),
    };
    let mut sides: Vec<Expression> = Vec::new();
    let mut relations = Vec::new();
    let mut rest = (start, part);
    loop {
        let end = rest.1.find(['<', '>', '=']).unwrap_or(rest.1.len());
        let (side, after) = rest.1.split_at(end);
        let side = side.parse().map_err(|error: ExpressionError| ExpressionError {
            column: column(rest.0) + error.column - 1,
            ..error
        })?;
        sides.push(side);
        let relation = &after[..after.len() - after.trim_start_matches(['<', '>', '=', '!']).len()];
        match relation {
            "" => break,
            "<" | "<=" | ">" | ">=" => relations.push(relation),
            other => return Err(wrong(rest.0 + end, &quoted(other, '\''), RELATION)),
        }
        rest = (rest.0 + end + relation.len(), &after[relation.len()..]);
    }
    if relations.is_empty() {
        return Err(wrong(start + part.len(), "the end", RELATION));
    }
    if relations.len() > 2 {
        return Err(wrong(start, "more than two comparisons", "\"and\" between them"));
    }
    let comparison = |(pair, relation): (&[Expression], &&str)| {
        let [first, second] = [&pair[0], &pair[1]].map(Expression::clone);
        let sides = if relation.starts_with('<') { [first, second] } else { [second, first] };
        Comparison { sides, or_equal: relation.ends_with('=') }
    };
    Ok(sides.windows(2).zip(&relations).map(comparison).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_hold_where_they_say() {
        for (text, inside, outside) in [
            ("abs(y) < 1e-9", [0.5, 0.0], [0.5, 0.1]),
            ("y<=0", [3.0, 0.0], [3.0, 1e-300]),
            ("0 <= x < 2 and y > 1", [0.0, 1.5], [2.0, 1.5]),
            ("x < 0 or x > 1 and y > 1", [-1.0, 0.0], [2.0, 0.5]),
            ("sqrt(x) < 1", [0.25, 0.0], [-1.0, 0.0]),
            ("2 > x >= 1", [1.0, 0.0], [2.0, 0.0]),
        ] {
            let condition: PlaceCondition = text.parse().unwrap();
            assert!(condition.holds(inside) && !condition.holds(outside), "{text}");
        }
    }
}
