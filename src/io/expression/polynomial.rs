//! Expressions that are polynomials: their degree, and in x alone their coefficients.

use super::{Binary, Expression, Number, Unary};

/// The degree of a polynomial in x and y; `None` of what is none by its form.
#[derive(Clone, Copy)]
struct PolynomialDegree(Option<u32>);

/// The coefficients of 1, x, x^2, ..; `None` of what is no polynomial in x by its form, or has too many.
#[derive(Clone)]
struct Coefficients(Option<Vec<f64>>);

impl Expression {
    /// The degree in x and y, if the expression is a polynomial by its form.
    pub(super) fn polynomial_degree(&self) -> Option<u32> {
        self.evaluate([PolynomialDegree(Some(1)); 2]).0
    }

    /// The coefficients of 1, x, x^2, .., if the expression is a polynomial in x alone.
    pub fn polynomial_in_x(&self) -> Option<Vec<f64>> {
        self.evaluate([Coefficients(Some(vec![0.0, 1.0])), Coefficients(None)]).0
    }
}

impl Number for PolynomialDegree {
    fn from_double(_: f64) -> PolynomialDegree {
        PolynomialDegree(Some(0))
    }

    fn unary(f: Unary, PolynomialDegree(a): PolynomialDegree) -> PolynomialDegree {
        PolynomialDegree(a.and_then(|a| match f {
            Unary::Negate => Some(a),
            Unary::WholePower(n) if n >= 0 => a.checked_mul(n.unsigned_abs()),
            _ if a == 0 => Some(0),
            _ => None,
        }))
    }

    fn binary(
        f: Binary,
        PolynomialDegree(a): PolynomialDegree,
        PolynomialDegree(b): PolynomialDegree,
    ) -> PolynomialDegree {
        PolynomialDegree(a.zip(b).and_then(|(a, b)| match f {
            Binary::Add | Binary::Subtract => Some(a.max(b)),
            Binary::Multiply => a.checked_add(b),
            Binary::Divide if b == 0 => Some(a),
            _ if (a, b) == (0, 0) => Some(0),
            Binary::Divide | Binary::Power | Binary::Min | Binary::Max => None,
        }))
    }
}

/// The longest polynomial that is multiplied out.
const MOST_COEFFICIENTS: usize = 64;

/// The product of two polynomials by their coefficients.
fn product(a: &[f64], b: &[f64]) -> Option<Vec<f64>> {
    if a.len() + b.len() > MOST_COEFFICIENTS {
        return None;
    }
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    Some(product)
}

/// a + sign b
fn sum(a: &[f64], sign: f64, b: &[f64]) -> Vec<f64> {
    let at = |p: &[f64], i: usize| p.get(i).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|i| at(a, i) + sign * at(b, i)).collect()
}

impl Number for Coefficients {
    fn from_double(value: f64) -> Coefficients {
        Coefficients(Some(vec![value]))
    }

    fn unary(f: Unary, Coefficients(a): Coefficients) -> Coefficients {
        Coefficients(a.and_then(|a| match (f, a.as_slice()) {
            (_, &[a]) => Some(vec![f64::unary(f, a)]),
            (Unary::Negate, a) => product(a, &[-1.0]),
            (Unary::WholePower(n), a) if n >= 0 => {
                (0..n).try_fold(vec![1.0], |power, _| product(&power, a))
            }
            _ => None,
        }))
    }

    fn binary(f: Binary, Coefficients(a): Coefficients, Coefficients(b): Coefficients) -> Self {
        Coefficients(a.zip(b).and_then(|(a, b)| match (f, a.as_slice(), b.as_slice()) {
            (_, &[a], &[b]) => Some(vec![f64::binary(f, a, b)]),
            (Binary::Add, a, b) => Some(sum(a, 1.0, b)),
            (Binary::Subtract, a, b) => Some(sum(a, -1.0, b)),
            (Binary::Multiply, a, b) => product(a, b),
            (Binary::Divide, a, &[c]) => Some(a.iter().map(|a| a / c).collect()),
            _ => None,
        }))
    }
}
