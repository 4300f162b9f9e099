//! From a text to a program: recursive descent, one function for each line of the grammar.

use std::str::FromStr;

use super::{
    Binary, Expression, ExpressionError, FUNCTIONS, MOST_FACTORS, MOST_LEVELS, Step, Unary,
};
use crate::quote::quoted;

impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Expression, ExpressionError> {
        let mut parser = Parser::new(text)?;
        parser.expression(1)?;
        match parser.token {
            Token::End => Ok(parser.done),
            _ => Err(parser.wrong("an operator (+ - * / ^) or the end")),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'t> {
    Number(f64),
    Name(&'t str),
    Symbol(char),
    End,
}

/// Recursive descent, one function for each line of the grammar. `level` counts the nesting and `waiting` the values that
/// wait for their operator: both are 1 deep at the start.
pub(super) struct Parser<'t> {
    pub(super) text: &'t str,
    /// The token under consideration, and the bytes it takes.
    pub(super) token: Token<'t>,
    pub(super) start: usize,
    pub(super) end: usize,
    pub(super) waiting: usize,
    pub(super) done: Expression,
}

impl<'t> Parser<'t> {
    pub(super) fn new(text: &'t str) -> Result<Self, ExpressionError> {
        let done = Expression { program: Vec::new(), depth: 0 };
        let mut parser = Parser { text, token: Token::End, start: 0, end: 0, waiting: 0, done };
        parser.advance()?;
        Ok(parser)
    }

    pub(super) fn expression(&mut self, level: usize) -> Result<(), ExpressionError> {
        self.term(level)?;
        loop {
            let operator = match self.token {
                Token::Symbol('+') => Binary::Add,
                Token::Symbol('-') => Binary::Subtract,
                _ => return Ok(()),
            };
            self.advance()?;
            self.term(level)?;
            self.emit(Step::Binary(operator));
        }
    }

    pub(super) fn term(&mut self, level: usize) -> Result<(), ExpressionError> {
        self.factor(level)?;
        loop {
            let operator = match self.token {
                Token::Symbol('*') => Binary::Multiply,
                Token::Symbol('/') => Binary::Divide,
                _ => return Ok(()),
            };
            self.advance()?;
            self.factor(level)?;
            self.emit(Step::Binary(operator));
        }
    }

    pub(super) fn factor(&mut self, level: usize) -> Result<(), ExpressionError> {
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
                self.factor(level + 1)?;
                self.emit(Step::Unary(Unary::Negate));
                Ok(())
            }
            _ => self.power(level),
        }
    }

    pub(super) fn power(&mut self, level: usize) -> Result<(), ExpressionError> {
        self.atom(level)?;
        if self.token == Token::Symbol('^') {
            self.advance()?;
            self.factor(level + 1)?;
            match self.done.program.last() {
                Some(&Step::Number(n)) if n.trunc() == n && n.abs() <= MOST_FACTORS => {
                    self.done.program.pop();
                    self.waiting -= 1;
                    self.emit(Step::Unary(Unary::WholePower(n as i32)));
                }
                _ => self.emit(Step::Binary(Binary::Power)),
            }
        }
        Ok(())
    }

    pub(super) fn atom(&mut self, level: usize) -> Result<(), ExpressionError> {
        let value = match self.token {
            Token::Number(value) => Step::Number(value),
            Token::Name("x") => Step::X,
            Token::Name("y") => Step::Y,
            Token::Name("pi") => Step::Number(std::f64::consts::PI),
            Token::Name(name) => return self.function(name, level),
            Token::Symbol('(') => {
                self.advance()?;
                self.expression(level + 1)?;
                return self.skip(')', "an operator (+ - * / ^) or ')'");
            }
            Token::Symbol(_) | Token::End => return Err(self.no_atom()),
        };
        self.emit(value);
        self.advance()
    }

    pub(super) fn function(&mut self, name: &str, level: usize) -> Result<(), ExpressionError> {
        let Some((_, step)) = FUNCTIONS.iter().find(|f| f.0 == name) else {
            return Err(if self.text[self.end..].trim_start().starts_with('(') {
                let known = FUNCTIONS.map(|f| f.0).join(", ");
                self.wrong(&format!("one of the functions {known}"))
            } else {
                self.no_atom()
            });
        };
        self.advance()?;
        self.skip('(', &format!("'(' after {name}"))?;
        self.expression(level + 1)?;
        if matches!(step, Step::Binary(_)) {
            self.skip(',', &format!("an operator (+ - * / ^) or ',': {name} takes two arguments"))?;
            self.expression(level + 1)?;
        }
        let count = if matches!(step, Step::Binary(_)) { "two arguments" } else { "one argument" };
        self.skip(')', &format!("an operator (+ - * / ^) or ')': {name} takes {count}"))?;
        self.emit(*step);
        Ok(())
    }

    pub(super) fn emit(&mut self, step: Step) {
        match step {
            Step::Number(_) | Step::X | Step::Y => self.waiting += 1,
            Step::Unary(_) => {}
            Step::Binary(_) => self.waiting -= 1,
        }
        self.done.depth = self.done.depth.max(self.waiting);
        self.done.push(step);
    }

    pub(super) fn skip(&mut self, symbol: char, expected: &str) -> Result<(), ExpressionError> {
        if self.token == Token::Symbol(symbol) { self.advance() } else { Err(self.wrong(expected)) }
    }

    /// Reads the next token.
    pub(super) fn advance(&mut self) -> Result<(), ExpressionError> {
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
    pub(super) fn number_length(&self, rest: &str) -> Result<usize, ExpressionError> {
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

    pub(super) fn no_atom(&self) -> ExpressionError {
        self.wrong("a number, x, y, pi, a function or '('")
    }

    pub(super) fn wrong(&self, expected: &str) -> ExpressionError {
        let found = &self.text[self.start..self.end];
        self.wrong_at(self.start, Some(found).filter(|f| !f.is_empty()), expected)
    }

    pub(super) fn wrong_at(
        &self,
        start: usize,
        found: Option<&str>,
        expected: &str,
    ) -> ExpressionError {
        ExpressionError {
            column: self.text[..start].chars().count() + 1,
            found: found.map_or("the end".to_owned(), |found| quoted(found, '\'')),
            expected: expected.to_owned(),
        }
    }
}

/// How many digits stand at the start of `text`.
pub(super) fn digits(text: &str) -> usize {
    text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len())
}

pub(super) fn is_letter(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}
