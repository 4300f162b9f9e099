//! From a text to its values: recursive descent, one function for each line of the grammar.

use std::collections::HashMap;
use std::str::FromStr;

use super::{Binary, Expression, ExpressionError, MOST_LEVELS, Unary, Value, steps};
use crate::quote::quoted;

impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Expression, ExpressionError> {
        let mut parser = Parser::new(text)?;
        let result = parser.expression(1)?;
        match parser.token {
            Token::End => Ok(steps::expression(&parser.values, result)),
            _ => Err(parser.wrong("an operator (+ - * / ^) or the end")),
        }
    }
}

/// The functions, in the order in which messages list them.
const FUNCTIONS: [(&str, Function); 7] = [
    ("sqrt", Function::Unary(Unary::Sqrt)),
    ("sin", Function::Unary(Unary::Sin)),
    ("cos", Function::Unary(Unary::Cos)),
    ("exp", Function::Unary(Unary::Exp)),
    ("abs", Function::Unary(Unary::Abs)),
    ("min", Function::Binary(Binary::Min)),
    ("max", Function::Binary(Binary::Max)),
];

#[derive(Clone, Copy)]
enum Function {
    Unary(Unary),
    Binary(Binary),
}

/// Beyond this exponent repeated multiplication gains no time and loses digits: its error grows like the exponent.
const MOST_FACTORS: f64 = 16.0;

/// So many values are found again where they stand a second time; the memory that they take is bounded so.
const MOST_SHARED: usize = 4096;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Token<'t> {
    Number(f64),
    Name(&'t str),
    Symbol(char),
    End,
}

/// Recursive descent, one function for each line of the grammar, each of which returns the place of its value. `level` counts the
/// nesting, from 1.
struct Parser<'t> {
    text: &'t str,
    /// The token under consideration, and the bytes it takes.
    token: Token<'t>,
    start: usize,
    end: usize,
    /// Each after its operands.
    values: Vec<Value>,
    places: HashMap<Value, u32>,
}

impl<'t> Parser<'t> {
    fn new(text: &'t str) -> Result<Self, ExpressionError> {
        let (values, places) = (Vec::new(), HashMap::new());
        let mut parser = Parser { text, token: Token::End, start: 0, end: 0, values, places };
        // Every value has a byte of its own, so that their places are numbers of 32 bits.
        if u32::try_from(text.len()).is_err() {
            return Err(parser.wrong("less than 4 GiB"));
        }
        parser.advance()?;
        Ok(parser)
    }

    fn expression(&mut self, level: usize) -> Result<u32, ExpressionError> {
        let mut sum = self.term(level)?;
        loop {
            let operator = match self.token {
                Token::Symbol('+') => Binary::Add,
                Token::Symbol('-') => Binary::Subtract,
                _ => return Ok(sum),
            };
            self.advance()?;
            let term = self.term(level)?;
            sum = self.binary(operator, sum, term);
        }
    }

    fn term(&mut self, level: usize) -> Result<u32, ExpressionError> {
        let mut product = self.factor(level)?;
        loop {
            let operator = match self.token {
                Token::Symbol('*') => Binary::Multiply,
                Token::Symbol('/') => Binary::Divide,
                _ => return Ok(product),
            };
            self.advance()?;
            let factor = self.factor(level)?;
            product = self.binary(operator, product, factor);
        }
    }

    fn factor(&mut self, level: usize) -> Result<u32, ExpressionError> {
        if level > MOST_LEVELS {
            return Err(self.wrong(&format!("at most {MOST_LEVELS} levels of nesting")));
        }
        match self.token {
            Token::Symbol('+') => {
                self.advance()?;
                self.factor(level + 1)
            }
            Token::Symbol('-') => {
                self.advance()?;
                let factor = self.factor(level + 1)?;
                Ok(self.unary(Unary::Negate, factor))
            }
            _ => self.power(level),
        }
    }

    fn power(&mut self, level: usize) -> Result<u32, ExpressionError> {
        let atom = self.atom(level)?;
        if self.token != Token::Symbol('^') {
            return Ok(atom);
        }
        self.advance()?;
        let exponent = self.factor(level + 1)?;
        Ok(match self.number(exponent) {
            Some(n) if n.trunc() == n && n.abs() <= MOST_FACTORS => {
                self.unary(Unary::WholePower(n as i32), atom)
            }
            _ => self.binary(Binary::Power, atom, exponent),
        })
    }

    fn atom(&mut self, level: usize) -> Result<u32, ExpressionError> {
        let value = match self.token {
            Token::Number(value) => Value::Number(value.to_bits()),
            Token::Name("x") => Value::X,
            Token::Name("y") => Value::Y,
            Token::Name("pi") => Value::Number(std::f64::consts::PI.to_bits()),
            Token::Name(name) => return self.function(name, level),
            Token::Symbol('(') => {
                self.advance()?;
                let inside = self.expression(level + 1)?;
                self.skip(')', "an operator (+ - * / ^) or ')'")?;
                return Ok(inside);
            }
            Token::Symbol(_) | Token::End => return Err(self.no_atom()),
        };
        self.advance()?;
        Ok(self.place(value))
    }

    fn function(&mut self, name: &str, level: usize) -> Result<u32, ExpressionError> {
        let Some((_, function)) = FUNCTIONS.iter().find(|f| f.0 == name) else {
            return Err(if self.text[self.end..].trim_start().starts_with('(') {
                let known = FUNCTIONS.map(|f| f.0).join(", ");
                self.wrong(&format!("one of the functions {known}"))
            } else {
                self.no_atom()
            });
        };
        self.advance()?;
        self.skip('(', &format!("'(' after {name}"))?;
        let first = self.expression(level + 1)?;
        let end = |count| format!("an operator (+ - * / ^) or ')': {name} takes {count}");
        match *function {
            Function::Unary(f) => {
                self.skip(')', &end("one argument"))?;
                Ok(self.unary(f, first))
            }
            Function::Binary(f) => {
                let comma = format!("an operator (+ - * / ^) or ',': {name} takes two arguments");
                self.skip(',', &comma)?;
                let second = self.expression(level + 1)?;
                self.skip(')', &end("two arguments"))?;
                Ok(self.binary(f, first, second))
            }
        }
    }

    fn number(&self, place: u32) -> Option<f64> {
        match self.values[place as usize] {
            Value::Number(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    fn unary(&mut self, f: Unary, a: u32) -> u32 {
        self.place(match self.number(a) {
            Some(a) => Value::Number(f.of(a).to_bits()),
            None => Value::Unary(f, a),
        })
    }

    fn binary(&mut self, f: Binary, a: u32, b: u32) -> u32 {
        self.place(match (self.number(a), self.number(b)) {
            (Some(a), Some(b)) => Value::Number(f.of(a, b).to_bits()),
            _ => Value::Binary(f, a, b),
        })
    }

    /// Where this value stands, for the first time now or since before.
    fn place(&mut self, value: Value) -> u32 {
        if let Some(&place) = self.places.get(&value) {
            return place;
        }
        let place = self.values.len() as u32;
        self.values.push(value);
        if self.places.len() < MOST_SHARED {
            self.places.insert(value, place);
        }
        place
    }

    fn skip(&mut self, symbol: char, expected: &str) -> Result<(), ExpressionError> {
        if self.token == Token::Symbol(symbol) { self.advance() } else { Err(self.wrong(expected)) }
    }

    /// Reads the next token.
    fn advance(&mut self) -> Result<(), ExpressionError> {
        let rest = self.text[self.end..].trim_start();
        self.start = self.text.len() - rest.len();
        let (token, length) = match rest.chars().next() {
            None => (Token::End, 0),
            Some(c) if c.is_ascii_digit() || c == '.' => {
                let length = self.number_length(rest)?;
                self.end = self.start + length;
                match rest[..length].parse::<f64>() {
                    Ok(value) if value.is_finite() => (Token::Number(value), length),
                    Ok(_) => return Err(self.wrong("a number below 1.8e308")),
                    Err(_) => return Err(self.wrong("a number")),
                }
            }
            Some(c) if is_letter(c) => {
                let length = rest.find(|c| !is_letter(c) && !c.is_ascii_digit());
                let length = length.unwrap_or(rest.len());
                (Token::Name(&rest[..length]), length)
            }
            Some(c) => (Token::Symbol(c), c.len_utf8()),
        };
        self.token = token;
        self.end = self.start + length;
        Ok(())
    }

    /// How many bytes at the start of `rest` are a number; 1 for a lonely point.
    fn number_length(&self, rest: &str) -> Result<usize, ExpressionError> {
        let mut length = digits(rest);
        if rest[length..].starts_with('.') {
            length += 1;
            length += digits(&rest[length..]);
        }
        let Some(exponent) = rest[length..].strip_prefix(['e', 'E']) else { return Ok(length) };
        let unsigned = exponent.strip_prefix(['+', '-']);
        if unsigned.is_none() && exponent.starts_with(is_letter) {
            // The start of a name, as in 2exp(x).
            return Ok(length);
        }
        let unsigned = unsigned.unwrap_or(exponent);
        let count = digits(unsigned);
        let start = self.text.len() - unsigned.len();
        if count == 0 {
            let found = unsigned.chars().next().map(String::from);
            return Err(self.wrong_at(start, found.as_deref(), "the digits of the exponent"));
        }
        Ok(start + count - self.start)
    }

    fn no_atom(&self) -> ExpressionError {
        self.wrong("a number, x, y, pi, a function or '('")
    }

    fn wrong(&self, expected: &str) -> ExpressionError {
        let found = &self.text[self.start..self.end];
        self.wrong_at(self.start, Some(found).filter(|f| !f.is_empty()), expected)
    }

    fn wrong_at(&self, start: usize, found: Option<&str>, expected: &str) -> ExpressionError {
        ExpressionError {
            column: self.text[..start].chars().count() + 1,
            found: found.map_or("the end".to_owned(), |found| quoted(found, '\'')),
            expected: expected.to_owned(),
        }
    }
}

/// How many digits stand at the start of `text`.
fn digits(text: &str) -> usize {
    text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len())
}

fn is_letter(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}
