//! Expressions that are polynomials: their degree, and in x alone their coefficients.

use super::{Binary, Expression, Unary, Value};

impl Expression {
    /// The degree in x and y, if the expression is a polynomial by its form.
    pub(super) fn polynomial_degree(&self) -> Option<u32> {
        *self.run(&mut vec![None; self.slots], |value, slots: &[Option<u32>]| match value {
            Value::Number(_) => Some(0),
            Value::X | Value::Y => Some(1),
            Value::Unary(f, a) => f.degree(slots[a as usize]?),
            Value::Binary(f, a, b) => f.degree(slots[a as usize]?, slots[b as usize]?),
        })?
    }

    /// The coefficients of 1, x, x^2, .., if the expression is a polynomial in x alone.
    pub fn polynomial_in_x(&self) -> Option<Vec<f64>> {
        self.run(&mut vec![None; self.slots], |value, slots: &[Option<Vec<f64>>]| match value {
            Value::Number(bits) => Some(vec![f64::from_bits(bits)]),
            Value::X => Some(vec![0.0, 1.0]),
            Value::Y => None,
            Value::Unary(f, a) => f.of_polynomial(slots[a as usize].as_ref()?),
            Value::Binary(f, a, b) => {
                f.of_polynomials(slots[a as usize].as_ref()?, slots[b as usize].as_ref()?)
            }
        })?
        .clone()
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
