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
//! product: `2x` is an error. White space may stand between any two symbols. Numbers and pi are the nearest doubles. A whole
//! constant exponent from -16 to 16 means repeated multiplication: x^2 is x*x to the bit, x^-2 is 1/(x*x), x^0 is 1 for every x.
//! Any other power is [`f64::powf`]: 2^0.5 is the square root of 2, and (-8)^(1/3) is NaN. A NaN stays a NaN, in min and max too.
//!
//! An [`Expression`] is a list of instructions in postfix order, evaluated in one loop over any [`Number`]: other than in a
//! recursive walk over a tree, a sum of `MOST_OPERATIONS` terms needs no deeper call stack than a sum of two.
//! `MOST_LEVELS` bounds the nesting.

mod algebra;
mod condition;
mod parser;

#[cfg(feature = "files")]
pub(crate) use condition::PlaceCondition;
use thiserror::Error;

use crate::kernel::{Ball, Enclosing};
use crate::model::Function;

/// The greatest depth to which parentheses, functions, signs and powers may nest.
const MOST_LEVELS: usize = 200;

/// The most operators, signs and functions of an expression.
const MOST_OPERATIONS: usize = 10_000;

/// A function of x and y; made by [`str::parse`].
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// The instructions in postfix order: each operation comes after its operands.
    instructions: Vec<Instruction>,
    /// The degree in x and y, if the expression is a polynomial by its form: asked for on each edge.
    degree: Option<u32>,
}

/// The place and the reason why a text is no expression.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("column {column}: found {found}, expected {expected}")]
pub struct ExpressionError {
    /// The place, in characters from 1.
    pub column: usize,
    /// The text found there.
    pub found: String,
    /// The text expected there.
    pub expected: String,
}

/// A value, or an operation on the last one or two.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Instruction {
    Number(f64),
    X,
    Y,
    Unary(Unary),
    Binary(Binary),
}

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unary {
    Negate,
    /// A power by repeated multiplication.
    WholePower(i32),
    Sqrt,
    Sin,
    Cos,
    Exp,
    Abs,
}

/// An operator, or a function of two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

/// A number type over which expressions can be evaluated: doubles, doubles with derivatives, enclosures, degrees.
pub(crate) trait Number: Clone {
    fn from_double(value: f64) -> Self;
    fn unary(f: Unary, a: Self) -> Self;
    fn binary(f: Binary, a: Self, b: Self) -> Self;
}

/// The number of instructions that are worked off without memory from the heap, which would take longer than they do.
const SHORT: usize = 16;

/// The value of the instructions at (x, y).
fn evaluate<T: Number>(instructions: &[Instruction], at: [T; 2]) -> T {
    let room = || at[0].clone();
    if instructions.len() <= SHORT {
        evaluate_on(&mut std::array::from_fn::<T, SHORT, _>(|_| room()), instructions, at)
    } else {
        evaluate_on(&mut vec![room(); instructions.len()], instructions, at)
    }
}

/// [`evaluate`] with room for as many values as there are instructions. These find as many values as they take.
fn evaluate_on<T: Number>(values: &mut [T], instructions: &[Instruction], [x, y]: [T; 2]) -> T {
    let mut count = 0;
    for instruction in instructions {
        let (value, taken) = match *instruction {
            Instruction::Number(value) => (T::from_double(value), 0),
            Instruction::X => (x.clone(), 0),
            Instruction::Y => (y.clone(), 0),
            Instruction::Unary(f) => (T::unary(f, values[count - 1].clone()), 1),
            Instruction::Binary(f) => {
                let [a, b] = [count - 2, count - 1].map(|place| values[place].clone());
                (T::binary(f, a, b), 2)
            }
        };
        values[count - taken] = value;
        count = count + 1 - taken;
    }
    values[0].clone()
}

/// The value of the instructions, if neither x nor y is among them.
fn constant(instructions: &[Instruction]) -> Option<f64> {
    let varies = instructions.iter().any(|step| matches!(step, Instruction::X | Instruction::Y));
    (!varies).then(|| evaluate(instructions, [f64::NAN; 2]))
}

impl Expression {
    fn new(instructions: Vec<Instruction>) -> Self {
        let expression = Expression { instructions, degree: None };
        Expression { degree: expression.polynomial_degree(), ..expression }
    }

    /// The value at (x, y), over any number type.
    pub(crate) fn evaluate<T: Number>(&self, at: [T; 2]) -> T {
        evaluate(&self.instructions, at)
    }

    /// The value, if the expression has neither x nor y.
    pub fn constant(&self) -> Option<f64> {
        constant(&self.instructions)
    }
}

impl Function for Expression {
    fn at(&self, x: [f64; 2]) -> f64 {
        self.evaluate(x)
    }

    fn degree(&self) -> Option<u32> {
        self.degree
    }

    fn enclosed(&self, x: [f64; 2]) -> Option<Ball> {
        Some(self.evaluate(x.map(Ball::exactly)))
    }
}

impl From<f64> for Expression {
    fn from(value: f64) -> Expression {
        Expression::new(vec![Instruction::Number(value)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Ball, Enclosing};
    use crate::model::Distance;

    fn parse(text: &str) -> Expression {
        text.parse().unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    fn message(text: &str) -> String {
        match text.parse::<Expression>() {
            Ok(e) => format!("no error, but {:?}", e.instructions),
            Err(e) => e.to_string(),
        }
    }

    #[test]
    fn tricky_expressions_have_the_value_of_the_mathematics() {
        // At x = 3, y = 5; every value is exact in doubles.
        for (text, value) in [
            ("((((y))))", 5.0),
            ("-x^2", -9.0),
            ("(-x)^2", 9.0),
            ("2^3^2", 512.0),
            ("(2^3)^2", 64.0),
            ("2^-x", 0.125),
            ("2^-1^2", 0.5),
            ("-2^-2", -0.25),
            ("x^-2", 1.0 / 9.0),
            ("x^x", 27.0),
            ("2*-3", -6.0),
            ("x--y", 8.0),
            ("x+-y", -2.0),
            ("+-+x", -3.0),
            ("x - y - 1", -3.0),
            ("x - (y - 1)", -1.0),
            ("12/2/3", 2.0),
            ("1e-3*x", 1e-3 * 3.0),
            (".5e+1", 5.0),
            ("2.", 2.0),
            ("2.e1", 20.0),
            (" \t x\n+ y ", 8.0),
            ("2^0.5", std::f64::consts::SQRT_2),
            ("x^17", 129_140_163.0),
            ("pi", std::f64::consts::PI),
            ("sqrt(x*x)", 3.0),
            ("sin(0) + cos(0) + exp(0)", 2.0),
            ("sin (x)^2", 3.0_f64.sin() * 3.0_f64.sin()),
            ("-abs(-x)", -3.0),
            ("min(x, y) - max(x, y)", -2.0),
            ("max(min(x, 4), min(y, 4))", 4.0),
            ("max(-x, -y)^2", 9.0),
        ] {
            assert_eq!(parse(text).at([3.0, 5.0]), value, "{text}");
        }
    }

    #[test]
    fn functions_of_a_ball_contain_those_of_its_numbers_and_of_a_smaller_one_do_not() {
        for text in [
            "-x",
            "x^3",
            "x^-2",
            "sqrt(x)",
            "sin(x)",
            "cos(x)",
            "exp(x)",
            "exp(-3*x)",
            "abs(x - 1)",
            "x/(1 + x)",
            "min(x, 2 - x)",
            "max(x, 2 - x)",
            "2 - x*x",
        ] {
            let function = parse(text);
            for (centre, radius) in [(1.0, 0.25), (1.5, 1e-3), (0.75, 0.25)] {
                let contains_all = |of: f64| {
                    let ball = function.evaluate([Ball::around(centre, of), Ball::from(0)]);
                    (-4..=4).all(|k| {
                        let value = function.at([centre + radius * f64::from(k) / 4.0, 0.0]);
                        ball.lower() <= value && value <= ball.upper()
                    })
                };
                assert!(contains_all(radius), "{text} at {centre} within {radius}");
                assert!(!contains_all(radius / 1000.0), "control: {text} at {centre}");
            }
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
    fn constants_and_polynomials_are_recognised() {
        let huge = "(((((x^16)^16)^16)^16)^16)^16*(((((x^16)^16)^16)^16)^16)^16^16";
        for (text, constant, degree, in_x) in [
            ("-2*(3 + 4)^2/7", Some(-14.0), Some(0), Some(vec![-14.0])),
            ("max(1, 2) - sqrt(4)", Some(0.0), Some(0), Some(vec![0.0])),
            ("x - x", None, Some(1), Some(vec![0.0, 0.0])),
            ("0*y", None, Some(1), None),
            ("1 - 2*x + x^2/4", None, Some(2), Some(vec![1.0, -2.0, 0.25])),
            ("-(x - 1)^3", None, Some(3), Some(vec![1.0, -3.0, 3.0, -1.0])),
            ("-(x + y^2)*(x*y - 1)^3 + 5", None, Some(8), None),
            ("x^2*x^0", None, Some(2), Some(vec![0.0, 0.0, 1.0])),
            ("(x^16)^16", None, Some(256), None),
            (huge, None, None, None),
            ("x/y", None, None, None),
            ("x^0.5", None, None, None),
            ("1 + abs(x)", None, None, None),
            ("min(x, y)", None, None, None),
        ] {
            let found = parse(text);
            assert_eq!(found.constant(), constant, "{text}");
            assert_eq!(found.degree(), degree, "{text}");
            assert_eq!(found.polynomial_in_x(), in_x, "{text}");
        }
    }

    #[test]
    fn mistakes_are_named_with_their_column() {
        let atom = "expected a number, x, y, pi, a function or '('";
        let end = "expected an operator (+ - * / ^) or the end";
        for (text, expected) in [
            ("", format!("column 1: found the end, {atom}")),
            ("()", format!("column 2: found ')', {atom}")),
            ("-inf", format!("column 2: found 'inf', {atom}")),
            ("x**2", format!("column 3: found '*', {atom} (a power is x^2)")),
            ("π", format!("column 1: found 'π', {atom}")),
            ("x·y", format!("column 2: found '·', {end}")),
            ("x y", format!("column 3: found 'y', {end}")),
            ("x, y", format!("column 2: found ',', {end} (decimals have a point: 0.5)")),
            ("1..2", format!("column 3: found '.2', {end}")),
            ("2exp(x)", format!("column 2: found 'exp', {end}")),
            ("(x", "column 3: found the end, expected an operator (+ - * / ^) or ')'".into()),
            ("1e", "column 3: found the end, expected the digits of the exponent".into()),
            ("1e999", "column 1: found '1e999', expected a number below 1.8e308".into()),
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
        ] {
            assert_eq!(message(text), expected, "{text}");
        }
    }

    #[test]
    fn nesting_and_operations_have_limits() {
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
        let long = message(&"z".repeat(1 << 20));
        assert!(long.starts_with("column 1: found 'zzz") && long.len() < 200, "{long}");
        assert_eq!(
            message(&"(".repeat(1 << 20)),
            "column 201: found '(', expected at most 200 levels of nesting"
        );
        let sum = |terms: usize| "x".to_owned() + &"+y".repeat(terms);
        assert_eq!(parse(&sum(MOST_OPERATIONS)).at([1.0, 2.0]), 20_001.0);
        assert_eq!(
            message(&sum(MOST_OPERATIONS + 1)),
            "column 20004: found the end, expected at most 10000 operations"
        );
    }

    #[test]
    fn gradients_are_the_limits_of_differences() {
        for text in [
            "3*x - 2*y + 1",
            "x^3*y^-2",
            "sqrt((x - 3)^2 + y^2) - 2",
            "sin(x)*cos(y)/exp(x*y)",
            "abs(y - x)",
            "min(x, y^2) + max(x, 2)",
            "x^y",
            "2^(x/3)",
            "x/(1 + y^2)",
            "(2 - y)/(x*x - y)",
            "1/(x - 3*y)",
            "(x + y)^1.5",
            "-x^2",
        ] {
            let expression: Expression = text.parse().unwrap();
            let p = [1.3, 0.7];
            let h = 1e-6;
            let found = expression.gradient(p);
            for c in 0..2 {
                let mut ends = [p, p];
                ends[0][c] -= h;
                ends[1][c] += h;
                let [a, b] = ends.map(|x| expression.at(x));
                assert!((found[c] - (b - a) / (2.0 * h)).abs() < 1e-8, "{text}: {found:?}");
            }
        }
    }

    #[test]
    fn a_constant_exponent_asks_for_no_logarithm() {
        let expression: Expression = "x^1.5".parse().unwrap();
        assert_eq!(expression.gradient([0.0, 0.0]), [0.0, 0.0]);
    }

    #[test]
    fn what_doubles_lose_is_in_the_width_and_what_has_no_bound_is_not_taken_for_known() {
        let width = |text: &str| {
            let ball = parse(text).evaluate([0.3, 0.5].map(Ball::exactly));
            ball.upper() - ball.lower()
        };
        assert!(width("10*x - 4") < 1e-14 && width("2^0.5*x/y") < 1e-14);
        assert!((100.0..2000.0).contains(&width("((10*x + 1e18) - 1e18) - 4")));
        assert!(!(width("(x - x*(1 + y))^0.5") < 1.0));
    }
}
