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
//! An [`Expression`] is a flat postfix program, not a tree: evaluation is a loop over its steps, a sum of a hundred
//! thousand terms is no deeper than a sum of two, and [`MOST_LEVELS`] bounds what does nest.

mod gradient;
mod parser;

use thiserror::Error;

use crate::fem::Function;

/// How deep parentheses, functions, signs and powers may nest.
pub const MOST_LEVELS: usize = 200;

/// A function of x and y; made by [`str::parse`].
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    program: Vec<Step>,
    /// How many values wait at the same time.
    depth: usize,
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

/// One step of a program: push a value, or replace the last one or two values by one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Number(f64),
    X,
    Y,
    Unary(Unary),
    Binary(Binary),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Unary {
    Negate,
    WholePower(i32),
    Sqrt,
    Sin,
    Cos,
    Exp,
    Abs,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

/// The functions, in the order in which messages list them.
const FUNCTIONS: [(&str, Step); 7] = [
    ("sqrt", Step::Unary(Unary::Sqrt)),
    ("sin", Step::Unary(Unary::Sin)),
    ("cos", Step::Unary(Unary::Cos)),
    ("exp", Step::Unary(Unary::Exp)),
    ("abs", Step::Unary(Unary::Abs)),
    ("min", Step::Binary(Binary::Min)),
    ("max", Step::Binary(Binary::Max)),
];

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

/// Beyond this exponent repeated multiplication gains no time and loses digits: its error grows like the exponent.
const MOST_FACTORS: f64 = 16.0;

/// a^n by repeated multiplication.
fn whole_power(a: f64, n: i32) -> f64 {
    let product = (0..n.unsigned_abs()).fold(1.0, |product, _| product * a);
    if n < 0 { 1.0 / product } else { product }
}

impl Expression {
    fn run(&self, [x, y]: [f64; 2], stack: &mut [f64]) -> f64 {
        let mut top = 0;
        for &step in &self.program {
            match step {
                Step::Unary(f) => stack[top - 1] = f.of(stack[top - 1]),
                Step::Binary(f) => {
                    top -= 1;
                    stack[top - 1] = f.of(stack[top - 1], stack[top]);
                }
                Step::Number(_) | Step::X | Step::Y => {
                    stack[top] = match step {
                        Step::Number(c) => c,
                        Step::X => x,
                        _ => y,
                    };
                    top += 1;
                }
            }
        }
        stack[0]
    }

    fn push(&mut self, step: Step) {
        // The last steps of a postfix program are its last operands, if they are numbers.
        let step = match (step, self.program.as_slice()) {
            (Step::Unary(f), [.., Step::Number(a)]) => {
                let value = f.of(*a);
                self.program.pop();
                Step::Number(value)
            }
            (Step::Binary(f), [.., Step::Number(a), Step::Number(b)]) => {
                let value = f.of(*a, *b);
                self.program.truncate(self.program.len() - 2);
                Step::Number(value)
            }
            _ => step,
        };
        self.program.push(step);
    }
}

impl Expression {
    /// The value, if the program is nothing but a number.
    pub fn constant(&self) -> Option<f64> {
        match self.program.as_slice() {
            [Step::Number(c)] => Some(*c),
            _ => None,
        }
    }
}

impl Expression {
    /// The coefficients of 1, x, x^2, .., if the expression is a polynomial in x alone.
    pub fn polynomial_in_x(&self) -> Option<Vec<f64>> {
        let mut stack: Vec<Vec<f64>> = Vec::new();
        for &step in &self.program {
            let result = match step {
                Step::Number(c) => vec![c],
                Step::X => vec![0.0, 1.0],
                Step::Y => return None,
                Step::Unary(f) => f.of_polynomial(&stack.pop()?)?,
                Step::Binary(f) => {
                    let b = stack.pop()?;
                    f.of_polynomials(&stack.pop()?, &b)?
                }
            };
            stack.push(result);
        }
        stack.pop()
    }
}

/// The product of two polynomials by their coefficients.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// The longest polynomial that is multiplied out.
const MOST_COEFFICIENTS: usize = 64;

impl Unary {
    fn of_polynomial(self, a: &[f64]) -> Option<Vec<f64>> {
        match self {
            Unary::Negate => Some(product(a, &[-1.0])),
            Unary::WholePower(n) if n >= 0 => {
                (0..n).try_fold(vec![1.0], |power, _| Binary::Multiply.of_polynomials(&power, a))
            }
            _ => None,
        }
    }
}

impl Binary {
    fn of_polynomials(self, a: &[f64], b: &[f64]) -> Option<Vec<f64>> {
        let sum = |sign: f64| {
            let at = |p: &[f64], i: usize| p.get(i).copied().unwrap_or(0.0);
            Some((0..a.len().max(b.len())).map(|i| at(a, i) + sign * at(b, i)).collect())
        };
        match (self, b) {
            (Binary::Add, _) => sum(1.0),
            (Binary::Subtract, _) => sum(-1.0),
            (Binary::Multiply, _) if a.len() + b.len() <= MOST_COEFFICIENTS => Some(product(a, b)),
            (Binary::Divide, [c]) => Some(a.iter().map(|a| a / c).collect()),
            _ => None,
        }
    }
}

impl Function for Expression {
    fn at(&self, x: [f64; 2]) -> f64 {
        const FEW: usize = 16;
        if self.depth <= FEW {
            self.run(x, &mut [0.0; FEW])
        } else {
            self.run(x, &mut vec![0.0; self.depth])
        }
    }

    fn degree(&self) -> Option<u32> {
        let mut stack: Vec<Option<u32>> = Vec::with_capacity(self.depth);
        for &step in &self.program {
            let degree = match step {
                Step::Number(_) => Some(0),
                Step::X | Step::Y => Some(1),
                Step::Unary(f) => f.degree(stack.pop()??),
                Step::Binary(f) => {
                    let b = stack.pop()??;
                    f.degree(stack.pop()??, b)
                }
            };
            stack.push(degree);
        }
        stack.pop()?
    }
}

impl Unary {
    /// The degree of the result for an operand of degree `a`.
    fn degree(self, a: u32) -> Option<u32> {
        match self {
            Unary::Negate => Some(a),
            Unary::WholePower(n) => a.checked_mul(u32::try_from(n).ok()?),
            Unary::Sqrt | Unary::Sin | Unary::Cos | Unary::Exp | Unary::Abs => None,
        }
    }
}

impl Binary {
    /// The degree of the result for operands of degrees `a` and `b`.
    fn degree(self, a: u32, b: u32) -> Option<u32> {
        match self {
            Binary::Add | Binary::Subtract => Some(a.max(b)),
            Binary::Multiply => a.checked_add(b),
            Binary::Divide if b == 0 => Some(a),
            Binary::Divide | Binary::Power | Binary::Min | Binary::Max => None,
        }
    }
}

impl From<f64> for Expression {
    fn from(value: f64) -> Expression {
        Expression { program: vec![Step::Number(value)], depth: 1 }
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
            Ok(e) => format!("no error, but {:?}", e.program),
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
        assert_eq!(sum.depth, 2);
    }

    #[test]
    fn deep_expressions_are_evaluated_as_flat_ones() {
        let deep = "x+(".repeat(150) + "y" + &")".repeat(150);
        assert_eq!(parse(&deep).at([2.0, 1.0]), 301.0);
        assert!(parse(&deep).depth > 16);
    }

    #[test]
    fn long_tokens_are_shortened_in_messages() {
        let e = message(&"z".repeat(1 << 20));
        assert!(e.starts_with("column 1: found 'zzz") && e.len() < 200, "{e}");
    }
}
