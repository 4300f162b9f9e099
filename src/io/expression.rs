//! Expressions in x and y, as they stand in a case file: `-4 + 10*x`, `0.2*(x - 0.3)^2`.
//!
//! ```text
//! expression = term { ("+" | "-") term }
//! term       = factor { ("*" | "/") factor }
//! factor     = ("+" | "-") factor | power
//! power      = atom [ "^" factor ]
//! atom       = number | "x" | "y" | "pi" | "(" expression ")"
//!            | ("sqrt" | "sin" | "cos" | "exp" | "abs") "(" expression ")"
//!            | ("min" | "max") "(" expression "," expression ")"
//! number     = digits ["." [digits]] [exponent] | "." digits [exponent]
//! exponent   = ("e" | "E") ["+" | "-"] digits
//! ```
//!
//! So ^ is right-associative and binds tighter than a sign: -x^2 = -(x^2), 2^3^2 = 2^9, 2^-1 = 1/2. There is no implicit
//! product: `2x` is an error. White space may stand between any two symbols. A whole constant exponent from -16 to 16
//! means repeated multiplication: x^2 is x*x to the bit, x^-2 is 1/(x*x), x^0 is 1 for every x. Any other power is
//! [`f64::powf`]: 2^0.5 is the square root of 2, and (-8)^(1/3) is NaN. A NaN stays a NaN, in min and max too.
//!
//! An [`Expression`] is a flat list of steps, not a tree: evaluation is a loop over them, a sum of a hundred thousand terms is no
//! deeper than a sum of two, and [`MOST_LEVELS`] bounds what does nest. What stands in a text twice is computed once.

mod blocks;
mod gradient;
mod parser;
mod polynomial;
mod steps;

use thiserror::Error;

use crate::fem::Function;

/// How deep parentheses, functions, signs and powers may nest.
pub const MOST_LEVELS: usize = 200;

/// A function of x and y; made by [`str::parse`].
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// The last one gives the value.
    steps: Vec<Step>,
    /// How many values are kept at the same time.
    slots: usize,
}

/// Where and why a text is no expression.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("column {column}: found {found}, expected {expected}")]
pub struct ExpressionError {
    /// The place, in characters from 1.
    pub column: usize,
    /// What stands there.
    pub found: String,
    /// What could stand there.
    pub expected: String,
}

/// One step: a value, and the slot that keeps it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Step {
    value: Value,
    slot: u32,
}

/// A value, by the slots of its operands (while a text is read, by their places among all values).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Value {
    /// The bits of a double: 0 and -0 are two numbers.
    Number(u64),
    X,
    Y,
    Unary(Unary, u32),
    Binary(Binary, u32, u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Unary {
    Negate,
    WholePower(i32),
    Sqrt,
    Sin,
    Cos,
    Exp,
    Abs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

impl Unary {
    fn of(self, a: f64) -> f64 {
        match self {
            Unary::Negate => -a,
            Unary::WholePower(n) => whole_power(a, n),
            Unary::Sqrt => a.sqrt(),
            Unary::Sin => a.sin(),
            Unary::Cos => a.cos(),
            Unary::Exp => a.exp(),
            Unary::Abs => a.abs(),
        }
    }
}

impl Binary {
    fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Binary::Add => a + b,
            Binary::Subtract => a - b,
            Binary::Multiply => a * b,
            Binary::Divide => a / b,
            Binary::Power => a.powf(b),
            // Not f64::min and f64::max: those drop a NaN.
            Binary::Min if a < b || a.is_nan() => a,
            Binary::Max if a > b || a.is_nan() => a,
            Binary::Min | Binary::Max => b,
        }
    }
}

/// a^n by repeated multiplication.
fn whole_power(a: f64, n: i32) -> f64 {
    let product = (0..n.unsigned_abs()).fold(1.0, |product, _| product * a);
    if n < 0 { 1.0 / product } else { product }
}

impl Expression {
    /// What `of` makes of each step from what it made of the operands, in slots that begin as `slots`; the last of it.
    fn run<'s, T>(&self, slots: &'s mut [T], of: impl Fn(Value, &[T]) -> T) -> Option<&'s T> {
        for step in &self.steps {
            slots[step.slot as usize] = of(step.value, slots);
        }
        slots.get(self.steps.last()?.slot as usize)
    }

    fn value(&self, x: [f64; 2], slots: &mut [f64]) -> f64 {
        let of = |value, slots: &[f64]| match value {
            Value::Number(bits) => f64::from_bits(bits),
            Value::X => x[0],
            Value::Y => x[1],
            Value::Unary(f, a) => f.of(slots[a as usize]),
            Value::Binary(f, a, b) => f.of(slots[a as usize], slots[b as usize]),
        };
        self.run(slots, of).copied().unwrap_or(f64::NAN)
    }

    /// The value, if the expression is nothing but a number.
    pub fn constant(&self) -> Option<f64> {
        match self.steps.as_slice() {
            [Step { value: Value::Number(bits), .. }] => Some(f64::from_bits(*bits)),
            _ => None,
        }
    }
}

impl Function for Expression {
    fn at(&self, x: [f64; 2]) -> f64 {
        const FEW: usize = 16;
        if self.slots <= FEW {
            self.value(x, &mut [0.0; FEW])
        } else {
            self.value(x, &mut vec![0.0; self.slots])
        }
    }

    fn at_all(&self, places: &[[f64; 2]]) -> Vec<f64> {
        self.values(places)
    }

    fn degree(&self) -> Option<u32> {
        self.polynomial_degree()
    }
}

impl From<f64> for Expression {
    fn from(value: f64) -> Expression {
        let value = Value::Number(value.to_bits());
        Expression { steps: vec![Step { value, slot: 0 }], slots: 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Expression {
        text.parse().unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    fn message(text: &str) -> String {
        match text.parse::<Expression>() {
            Ok(e) => format!("no error, but {:?}", e.steps),
            Err(e) => e.to_string(),
        }
    }

    #[test]
    fn tricky_expressions_have_the_value_of_the_mathematics() {
        // At x = 3, y = 5; every value is exact in doubles.
        for (text, value) in [
            ("x", 3.0),
            ("(x)", 3.0),
            ("((((y))))", 5.0),
            ("-x^2", -9.0),
            ("(-x)^2", 9.0),
            ("-2^2", -4.0),
            ("2^3^2", 512.0),
            ("(2^3)^2", 64.0),
            ("2^-1", 0.5),
            ("2^-x", 0.125),
            ("2^-1^2", 0.5),
            ("-2^-2", -0.25),
            ("x^-2", 1.0 / 9.0),
            ("x^0", 1.0),
            ("x^x", 27.0),
            ("2*-3", -6.0),
            ("2/-x", 2.0 / -3.0),
            ("x--y", 8.0),
            ("x+-y", -2.0),
            ("x-+y", -2.0),
            ("--x", 3.0),
            ("+-+x", -3.0),
            ("x - y - 1", -3.0),
            ("x - (y - 1)", -1.0),
            ("1/3*3", 1.0),
            ("12/2/3", 2.0),
            ("2*x^2*y", 90.0),
            ("1e-3*x", 1e-3 * 3.0),
            ("1E3", 1000.0),
            (".5e+1", 5.0),
            (".5", 0.5),
            ("2.", 2.0),
            ("2.e1", 20.0),
            ("007", 7.0),
            (" \t x\n+ y ", 8.0),
            ("2^0.5", std::f64::consts::SQRT_2),
            ("x^17", 129_140_163.0),
            ("pi", std::f64::consts::PI),
            ("sqrt(x*x)", 3.0),
            ("sin(0) + cos(0) + exp(0)", 2.0),
            ("sin(x)", 3.0_f64.sin()),
            ("sin (x)^2", 3.0_f64.sin() * 3.0_f64.sin()),
            ("-abs(-x)", -3.0),
            ("min(x, y) - max(x, y)", -2.0),
            ("max(min(x, 4), min(y, 4))", 4.0),
            ("max(-x, -y)^2", 9.0),
            ("-4 + 10*x", 26.0),
            ("0.25*(x - 1)^2", 1.0),
            ("y/(1 - y)", -1.25),
        ] {
            assert_eq!(parse(text).at([3.0, 5.0]), value, "{text}");
        }
    }

    #[test]
    fn square_is_the_product_to_the_bit() {
        for x in [0.1, -1.0 / 3.0, 1e200, 5e-324, -0.0] {
            assert_eq!(parse("x^2").at([x, 0.0]).to_bits(), (x * x).to_bits());
        }
    }

    #[test]
    fn powers_and_roots_outside_the_real_numbers_are_nan() {
        for text in ["(-8)^(1/3)", "sqrt(-1)", "0/0", "min(0/0, 1)", "max(1, 0/0)", "max(x, 1)"] {
            assert!(parse(text).at([f64::NAN, 0.0]).is_nan(), "{text}");
        }
        assert_eq!(parse("1/0").at([0.0; 2]), f64::INFINITY);
    }

    #[test]
    fn constants_are_recognised() {
        for (text, value) in [
            ("0", Some(0.0)),
            ("-2*(3 + 4)^2/7", Some(-14.0)),
            ("max(1, 2) - sqrt(4)", Some(0.0)),
            ("x - x", None),
            ("0*y", None),
        ] {
            assert_eq!(parse(text).constant(), value, "{text}");
        }
    }

    #[test]
    fn polynomials_in_x_are_multiplied_out() {
        for (text, coefficients) in [
            ("3", Some(vec![3.0])),
            ("1 - 2*x + x^2/4", Some(vec![1.0, -2.0, 0.25])),
            ("-(x - 1)^3", Some(vec![1.0, -3.0, 3.0, -1.0])),
            ("(x + 1)*(x - 1)", Some(vec![-1.0, 0.0, 1.0])),
            ("y", None),
            ("1/x", None),
            ("sin(x)", None),
            ("x^0.5", None),
            ("(x^16)^16", None),
        ] {
            assert_eq!(parse(text).polynomial_in_x(), coefficients, "{text}");
        }
    }

    #[test]
    fn polynomials_know_their_degree() {
        for (text, degree) in [
            ("7", Some(0)),
            ("x/2 - 3", Some(1)),
            ("-(x + y^2)*(x*y - 1)^3 + 5", Some(8)),
            ("x^2*x^0", Some(2)),
            ("x/y", None),
            ("x^-1", None),
            ("x^0.5", None),
            ("sin(x)", None),
            ("1 + abs(x)", None),
            ("min(x, y)", None),
            ("(((((x^16)^16)^16)^16)^16)^16*(((((x^16)^16)^16)^16)^16)^16^16", None),
        ] {
            assert_eq!(parse(text).degree(), degree, "{text}");
        }
    }

    #[test]
    fn mistakes_are_named_with_their_column() {
        let atom = "expected a number, x, y, pi, a function or '('";
        let end = "expected an operator (+ - * / ^) or the end";
        for (text, expected) in [
            ("", format!("column 1: found the end, {atom}")),
            ("  ", format!("column 3: found the end, {atom}")),
            ("(", format!("column 2: found the end, {atom}")),
            (")", format!("column 1: found ')', {atom}")),
            ("()", format!("column 2: found ')', {atom}")),
            ("4 +", format!("column 4: found the end, {atom}")),
            ("x^", format!("column 3: found the end, {atom}")),
            ("2 * z", format!("column 5: found 'z', {atom}")),
            ("nan", format!("column 1: found 'nan', {atom}")),
            ("-inf", format!("column 2: found 'inf', {atom}")),
            ("x1", format!("column 1: found 'x1', {atom}")),
            ("X", format!("column 1: found 'X', {atom}")),
            ("x**2", format!("column 3: found '*', {atom}")),
            ("π", format!("column 1: found 'π', {atom}")),
            ("x + ½", format!("column 5: found '½', {atom}")),
            ("x·y", format!("column 2: found '·', {end}")),
            ("2x", format!("column 2: found 'x', {end}")),
            ("x y", format!("column 3: found 'y', {end}")),
            ("2(x)", format!("column 2: found '(', {end}")),
            ("x)", format!("column 2: found ')', {end}")),
            ("x, y", format!("column 2: found ',', {end}")),
            ("1.2.3", format!("column 4: found '.3', {end}")),
            ("1..2", format!("column 3: found '.2', {end}")),
            ("2exp(x)", format!("column 2: found 'exp', {end}")),
            ("x = 1", format!("column 3: found '=', {end}")),
            ("x\u{0}", format!("column 2: found '\\0', {end}")),
            ("(x", "column 3: found the end, expected an operator (+ - * / ^) or ')'".into()),
            ("(x, y)", "column 3: found ',', expected an operator (+ - * / ^) or ')'".into()),
            (".", "column 1: found '.', expected a number".into()),
            ("1e", "column 3: found the end, expected the digits of the exponent".into()),
            ("é+1e+", "column 1: found 'é', expected a number, x, y, pi, a function or '('".into()),
            ("1e-x", "column 4: found 'x', expected the digits of the exponent".into()),
            ("1e999", "column 1: found '1e999', expected a number below 1.8e308".into()),
            ("sin", "column 4: found the end, expected '(' after sin".into()),
            ("sin x", "column 5: found 'x', expected '(' after sin".into()),
            (
                "sin(x,y)",
                "column 6: found ',', expected an operator (+ - * / ^) or ')': sin takes one argument"
                    .into(),
            ),
            (
                "max(x)",
                "column 6: found ')', expected an operator (+ - * / ^) or ',': max takes two arguments"
                    .into(),
            ),
            (
                "min(x,y,1)",
                "column 8: found ',', expected an operator (+ - * / ^) or ')': min takes two arguments"
                    .into(),
            ),
            (
                "1 + tan(x)",
                "column 5: found 'tan', expected one of the functions sqrt, sin, cos, exp, abs, min, max"
                    .into(),
            ),
        ] {
            assert_eq!(message(text), expected, "{text}");
        }
    }

    #[test]
    fn nesting_has_a_limit_and_long_sums_have_none() {
        let nested = |open: &str, n: usize, close: &str| open.repeat(n) + "x" + &close.repeat(n);
        for (open, close) in
            [("(", ")"), ("-", ""), ("sin(", ")"), ("2^", ""), ("1+2*3^min(x,", ")")]
        {
            // A power and a function are two levels.
            let most = if open.contains('^') && close == ")" { 99 } else { MOST_LEVELS - 1 };
            assert!(nested(open, most, close).parse::<Expression>().is_ok(), "{open}");
            let e = message(&nested(open, 1 << 20, close));
            assert!(e.ends_with("expected at most 200 levels of nesting"), "{e}");
        }
        assert_eq!(
            message(&"(".repeat(1 << 20)),
            "column 201: found '(', expected at most 200 levels of nesting"
        );
        let sum = parse(&("x".to_owned() + &"+y".repeat(100_000)));
        assert_eq!(sum.at([1.0, 2.0]), 200_001.0);
        assert_eq!(sum.slots, 3);
    }

    #[test]
    fn deep_expressions_are_evaluated_as_flat_ones() {
        let deep: String = (0..150).map(|k| format!("{k}*x+(")).collect();
        let deep = parse(&(deep + "y" + &")".repeat(150)));
        assert_eq!(deep.at([2.0, 1.0]), 22351.0);
        assert!(deep.slots > 16);
    }

    #[test]
    fn long_tokens_are_shortened_in_messages() {
        let e = message(&"z".repeat(1 << 20));
        assert!(e.starts_with("column 1: found 'zzz") && e.len() < 200, "{e}");
    }
}
