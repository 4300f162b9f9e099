//! The values of an expression at many places, to the bit those at each: a step is a loop over a block of places, and a long
//! expression in x alone, or in y alone, is evaluated once for all places that have it in common.

use std::collections::HashMap;

use super::{Binary, Expression, Step, Value};

/// So many places at a time: long enough to forget what it takes to choose the operation, short enough for the first cache.
const BLOCK: usize = 128;

/// From so many steps on it pays to look for places with the same x.
const LONG: usize = 64;

impl Expression {
    /// The values at these places.
    pub(super) fn values(&self, places: &[[f64; 2]]) -> Vec<f64> {
        let has = |variable: Value| self.steps.iter().any(|step| step.value == variable);
        let only = match (has(Value::X), has(Value::Y)) {
            _ if self.steps.len() < LONG => None,
            (true, false) => Some(0),
            (false, true) => Some(1),
            _ => None,
        };
        let Some(c) = only else { return self.in_blocks(places) };
        let (mut known, mut distinct) = (HashMap::new(), Vec::new());
        let of = |place: &[f64; 2]| {
            *known.entry(place[c].to_bits()).or_insert_with(|| {
                distinct.push(*place);
                distinct.len() - 1
            })
        };
        let which: Vec<usize> = places.iter().map(of).collect();
        let values = self.in_blocks(&distinct);
        which.into_iter().map(|i| values[i]).collect()
    }

    fn in_blocks(&self, places: &[[f64; 2]]) -> Vec<f64> {
        let mut slots = vec![vec![0.0; BLOCK.min(places.len())]; self.slots];
        let mut values = Vec::with_capacity(places.len());
        for places in places.chunks(BLOCK) {
            for &Step { value, slot } in &self.steps {
                // No operand is in the slot of the result.
                let mut result = std::mem::take(&mut slots[slot as usize]);
                value.at_all(places, &slots, &mut result);
                slots[slot as usize] = result;
            }
            let last = self.steps.last().map_or(&[][..], |step| &slots[step.slot as usize]);
            values.extend_from_slice(&last[..places.len()]);
        }
        values
    }
}

impl Value {
    /// The value at all `places`, from those of the operands.
    fn at_all(self, places: &[[f64; 2]], slots: &[Vec<f64>], result: &mut [f64]) {
        match self {
            Value::Number(bits) => result.fill(f64::from_bits(bits)),
            Value::X => result.iter_mut().zip(places).for_each(|(r, x)| *r = x[0]),
            Value::Y => result.iter_mut().zip(places).for_each(|(r, x)| *r = x[1]),
            Value::Unary(f, a) => {
                result.iter_mut().zip(&slots[a as usize]).for_each(|(r, &a)| *r = f.of(a));
            }
            Value::Binary(f, a, b) => f.of_all(&slots[a as usize], &slots[b as usize], result),
        }
    }
}

impl Binary {
    /// The quick ones each have a loop of their own, which runs over several places at a time.
    fn of_all(self, a: &[f64], b: &[f64], result: &mut [f64]) {
        fn each(a: &[f64], b: &[f64], result: &mut [f64], f: impl Fn(f64, f64) -> f64) {
            result.iter_mut().zip(a).zip(b).for_each(|((r, &a), &b)| *r = f(a, b));
        }
        match self {
            Binary::Add => each(a, b, result, |a, b| Binary::Add.of(a, b)),
            Binary::Subtract => each(a, b, result, |a, b| Binary::Subtract.of(a, b)),
            Binary::Multiply => each(a, b, result, |a, b| Binary::Multiply.of(a, b)),
            Binary::Divide => each(a, b, result, |a, b| Binary::Divide.of(a, b)),
            _ => each(a, b, result, |a, b| self.of(a, b)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::Function;

    #[test]
    fn values_at_many_places_are_those_at_each_to_the_bit() {
        let places: Vec<[f64; 2]> = (0..3 * BLOCK + 17)
            .map(|i| [f64::from(i as u32 % 99) * 0.37 - 18.0, 1.0 / f64::from(i as u32)])
            .collect();
        for text in [
            "7",
            "y",
            "-4 + 10*x - x/y",
            "sin(x)*cos(y) + sin(x) - exp(-x)/sqrt(x)",
            "min(x, y)^2 + max(abs(x), 1/y)^-3 - (x*y)^0.5",
            "x^y + 0*x - 0*x",
            &("x".to_owned() + &" + sin(x)*exp(x)".repeat(LONG)),
            &("y".to_owned() + &" - y/3".repeat(LONG)),
            &("x/y".to_owned() + &" - y/3".repeat(LONG)),
        ] {
            let expression: Expression = text.parse().unwrap();
            let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();
            let one_by_one = places.iter().map(|&x| expression.at(x)).collect();
            assert_eq!(bits(expression.at_all(&places)), bits(one_by_one), "{text}");
        }
        assert!(Expression::from(1.0).at_all(&[]).is_empty());
    }
}
