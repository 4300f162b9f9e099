//! From a text to its instructions: recursive descent, with the operators of sums and products in one table.

use std::str::FromStr;

use super::{
    Binary, Expression, ExpressionError, Instruction, MOST_LEVELS, MOST_OPERATIONS, Unary, constant,
};
use crate::quote::quoted;

impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Expression, ExpressionError> {
        let mut parser = Parser::new(text)?;
        let expression = parser.whole()?;
        match parser.token {
            Token::End => Ok(expression),
            Token::Symbol(',') => {
                Err(parser.wrong("an operator (+ - * / ^) or the end (decimals have a point: 0.5)"))
            }
            _ => Err(parser.wrong("an operator (+ - * / ^) or the end")),
        }
    }
}

/// The functions, in the order in which messages list them.
const FUNCTIONS: [(&str, Instruction); 7] = [
    ("sqrt", Instruction::Unary(Unary::Sqrt)),
    ("sin", Instruction::Unary(Unary::Sin)),
    ("cos", Instruction::Unary(Unary::Cos)),
    ("exp", Instruction::Unary(Unary::Exp)),
    ("abs", Instruction::Unary(Unary::Abs)),
    ("min", Instruction::Binary(Binary::Min)),
    ("max", Instruction::Binary(Binary::Max)),
];

/// The largest exponent of repeated multiplication, whose error grows like the exponent; beyond this size no time is gained.
const MOST_FACTORS: f64 = 16.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'t> {
    Number(f64),
    Name(&'t str),
    Symbol(char),
    End,
}

/// The state of the descent: each function appends the instructions of what it reads. `level` counts the nesting, from 1.
pub(super) struct Parser<'t> {
    text: &'t str,
    /// The token under consideration, and the bytes it takes.
    pub(super) token: Token<'t>,
    start: usize,
    end: usize,
    instructions: Vec<Instruction>,
    /// The number of instructions that are no numbers and no variables.
    operations: usize,
}

impl<'t> Parser<'t> {
    pub(super) fn new(text: &'t str) -> Result<Self, ExpressionError> {
        let (instructions, operations) = (Vec::new(), 0);
        let mut parser =
            Parser { text, token: Token::End, start: 0, end: 0, instructions, operations };
        parser.advance()?;
        Ok(parser)
    }

    /// Reads an expression as far as it goes.
    pub(super) fn whole(&mut self) -> Result<Expression, ExpressionError> {
        self.operations = 0;
        self.expression(1)?;
        Ok(Expression::new(std::mem::take(&mut self.instructions)))
    }

    /// Returns whether the token and this symbol have nothing between them.
    pub(super) fn is_followed_by(&self, symbol: char) -> bool {
        self.text[self.end..].starts_with(symbol)
    }

    fn operation(&mut self, step: Instruction) -> Result<(), ExpressionError> {
        self.operations += 1;
        if self.operations > MOST_OPERATIONS {
            return Err(self.wrong(&format!("at most {MOST_OPERATIONS} operations")));
        }
        self.instructions.push(step);
        Ok(())
    }

    fn expression(&mut self, level: usize) -> Result<(), ExpressionError> {
        self.operands(level, 1)
    }

    /// Operands with operators between them that bind at least so tightly, from the left.
    fn operands(&mut self, level: usize, least: u8) -> Result<(), ExpressionError> {
        const OPERATORS: [(char, Binary, u8); 4] = [
            ('+', Binary::Add, 1),
            ('-', Binary::Subtract, 1),
            ('*', Binary::Multiply, 2),
            ('/', Binary::Divide, 2),
        ];
        self.factor(level)?;
        let binds = |token, o: &&(char, Binary, u8)| token == Token::Symbol(o.0) && o.2 >= least;
        while let Some((_, f, tightness)) = OPERATORS.iter().find(|o| binds(self.token, o)) {
            self.advance()?;
            self.operands(level, tightness + 1)?;
            self.operation(Instruction::Binary(*f))?;
        }
        Ok(())
    }

    /// A power behind its signs.
    fn factor(&mut self, level: usize) -> Result<(), ExpressionError> {
        if level > MOST_LEVELS {
            return Err(self.wrong(&format!("at most {MOST_LEVELS} levels of nesting")));
        }
        let sign = self.token;
        if let Token::Symbol('+' | '-') = sign {
            self.advance()?;
            self.factor(level + 1)?;
            let negate = Instruction::Unary(Unary::Negate);
            return if sign == Token::Symbol('-') { self.operation(negate) } else { Ok(()) };
        }
        self.atom(level)?;
        if self.token != Token::Symbol('^') {
            return Ok(());
        }
        self.advance()?;
        let second = self.instructions.len();
        self.factor(level + 1)?;
        match constant(&self.instructions[second..]) {
            Some(n) if n.trunc() == n && n.abs() <= MOST_FACTORS => {
                self.instructions.truncate(second);
                self.operation(Instruction::Unary(Unary::WholePower(n as i32)))
            }
            _ => self.operation(Instruction::Binary(Binary::Power)),
        }
    }

    fn atom(&mut self, level: usize) -> Result<(), ExpressionError> {
        let step = match self.token {
            Token::Number(value) => Instruction::Number(value),
            Token::Name("x") => Instruction::X,
            Token::Name("y") => Instruction::Y,
            Token::Name("pi") => Instruction::Number(std::f64::consts::PI),
            Token::Name(name) => return self.function(name, level),
            Token::Symbol('(') => {
                self.advance()?;
                self.expression(level + 1)?;
                return self.skip(')', "an operator (+ - * / ^) or ')'");
            }
            Token::Symbol(_) | Token::End => return Err(self.no_atom()),
        };
        self.instructions.push(step);
        self.advance()
    }

    fn function(&mut self, name: &str, level: usize) -> Result<(), ExpressionError> {
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
        self.expression(level + 1)?;
        let (count, is_binary) = match function {
            Instruction::Binary(_) => ("two arguments", true),
            _ => ("one argument", false),
        };
        if is_binary {
            self.skip(',', &format!("an operator (+ - * / ^) or ',': {name} takes {count}"))?;
            self.expression(level + 1)?;
        }
        self.skip(')', &format!("an operator (+ - * / ^) or ')': {name} takes {count}"))?;
        self.operation(*function)
    }

    fn skip(&mut self, symbol: char, expected: &str) -> Result<(), ExpressionError> {
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

    /// Counts the bytes at the start of `rest` that are a number; 1 for a lonely point.
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
        let is_power = self.token == Token::Symbol('*') && self.text[..self.start].ends_with('*');
        let remedy = if is_power { " (a power is x^2)" } else { "" };
        self.wrong(&format!("a number, x, y, pi, a function or '('{remedy}"))
    }

    pub(super) fn wrong(&self, expected: &str) -> ExpressionError {
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

/// Counts the digits at the start of `text`.
fn digits(text: &str) -> usize {
    text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len())
}

fn is_letter(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}
