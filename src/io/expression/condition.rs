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

use super::parser::{Parser, Token};
use super::{Expression, ExpressionError};

/// A condition on a place; made by [`str::parse`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlaceCondition {
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

const GOES_ON: &str =
    "an operator (+ - * / ^), a comparison (<, <=, >, >=), \"and\", \"or\" or the end";

impl FromStr for PlaceCondition {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<PlaceCondition, ExpressionError> {
        let mut parser = Parser::new(text)?;
        let (mut alternatives, mut all) = (Vec::new(), Vec::new());
        loop {
            all.extend(comparisons(&mut parser)?);
            match parser.token {
                Token::Name("and") => {}
                Token::Name("or") => alternatives.push(std::mem::take(&mut all)),
                Token::End => break,
                _ => return Err(parser.wrong(GOES_ON)),
            }
            parser.advance()?;
        }
        alternatives.push(all);
        Ok(PlaceCondition { alternatives })
    }
}

/// Reads one or two comparisons that follow each other, as in `0 <= x <= 2`.
fn comparisons(parser: &mut Parser) -> Result<Vec<Comparison>, ExpressionError> {
    let too_many = ExpressionError {
        found: "more than two comparisons".to_owned(),
        ..parser.wrong("\"and\" between them")
    };
    let mut comparisons = Vec::new();
    let mut last = parser.whole()?;
    while let Token::Symbol(relation @ ('<' | '>')) = parser.token {
        let or_equal = parser.is_followed_by('=');
        parser.advance()?;
        if or_equal {
            parser.advance()?;
        }
        let next = parser.whole()?;
        let sides = if relation == '<' { [last, next.clone()] } else { [next.clone(), last] };
        comparisons.push(Comparison { sides, or_equal });
        last = next;
    }
    match comparisons.len() {
        0 => Err(parser.wrong(RELATION)),
        1 | 2 => Ok(comparisons),
        _ => Err(too_many),
    }
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
            ("sqrt(x) <= 1", [0.25, 0.0], [-1.0, 0.0]),
            ("sqrt(x) >= 1", [4.0, 0.0], [-1.0, 0.0]),
            ("2 > x >= 1", [1.0, 0.0], [2.0, 0.0]),
        ] {
            let condition: PlaceCondition = text.parse().unwrap();
            assert!(condition.holds(inside) && !condition.holds(outside), "{text}");
        }
    }
}
