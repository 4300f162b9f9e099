//! From the values of a text to steps with slots: what nobody asks for is left out, and a slot is free again after the last use of
//! what it keeps.

use super::{Expression, Step, Value};

impl Value {
    fn operands(self) -> impl Iterator<Item = u32> {
        let operands = match self {
            Value::Number(_) | Value::X | Value::Y => [None, None],
            Value::Unary(_, a) => [Some(a), None],
            Value::Binary(_, a, b) => [Some(a), Some(b).filter(|&b| b != a)],
        };
        operands.into_iter().flatten()
    }

    fn with_operands(self, slot: impl Fn(u32) -> u32) -> Value {
        match self {
            Value::Number(_) | Value::X | Value::Y => self,
            Value::Unary(f, a) => Value::Unary(f, slot(a)),
            Value::Binary(f, a, b) => Value::Binary(f, slot(a), slot(b)),
        }
    }
}

/// The expression of the value at `result`; the operands of each stand before it.
pub(super) fn expression(values: &[Value], result: u32) -> Expression {
    let last_use = last_uses(values, result);
    let mut slot_of = vec![0; values.len()];
    let mut free: Vec<u32> = Vec::new();
    let mut slots = 0;
    let mut steps = Vec::new();
    for (place, value) in values.iter().enumerate().filter(|(place, _)| last_use[*place].is_some())
    {
        let slot = free.pop().unwrap_or_else(|| {
            slots += 1;
            slots - 1
        });
        slot_of[place] = slot;
        steps.push(Step { value: value.with_operands(|operand| slot_of[operand as usize]), slot });
        let done = value.operands().filter(|&operand| last_use[operand as usize] == Some(place));
        free.extend(done.map(|operand| slot_of[operand as usize]));
    }
    Expression { steps, slots: slots as usize }
}

/// The place of the last value that `result` needs each value for; its own for the result.
fn last_uses(values: &[Value], result: u32) -> Vec<Option<usize>> {
    let mut last_use = vec![None; values.len()];
    last_use[result as usize] = Some(result as usize);
    for (place, value) in values.iter().enumerate().rev() {
        if last_use[place].is_some() {
            for operand in value.operands() {
                last_use[operand as usize].get_or_insert(place);
            }
        }
    }
    last_use
}

#[cfg(test)]
mod tests {
    use crate::io::Expression;

    fn parse(text: &str) -> Expression {
        text.parse().unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    #[test]
    fn what_stands_twice_is_computed_once_and_what_nobody_asks_for_never() {
        for (text, steps, slots) in [
            ("x + x", 2, 2),
            ("sin(x)*sin(x) + sin(x)", 4, 3),
            ("(x + 1)*(x + 1)", 4, 3),
            ("0 + -0*x", 5, 4),
            ("2*(3 + 4)^2/7", 1, 1),
            ("x^(1 + 1)", 2, 2),
            ("x + 1e-3*x + 1e-3*x + 1e-3*x", 6, 3),
        ] {
            let found = parse(text);
            assert_eq!((found.steps.len(), found.slots), (steps, slots), "{text}: {found:?}");
        }
    }

    #[test]
    fn no_result_is_in_the_slot_of_an_operand_and_every_operand_is_the_one_that_is_meant() {
        let deep: String = (0..150).map(|k| format!("sin({k}*x)*(y - ")).collect();
        let deep = parse(&(deep + "y" + &")".repeat(150)));
        assert!(deep.slots > 100);
        for step in &deep.steps {
            assert!(step.value.operands().all(|operand| operand != step.slot));
        }
        let [x, y] = [0.3, 0.7];
        let expected = (0..150).rev().fold(y, |sum, k| (f64::from(k) * x).sin() * (y - sum));
        assert_eq!(crate::fem::Function::at(&deep, [x, y]), expected);
    }
}
