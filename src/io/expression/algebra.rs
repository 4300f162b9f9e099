//! The number types over which expressions are evaluated: doubles, doubles with their derivatives, balls, polynomials.

use super::{Binary, Expression, Number, Unary};
use crate::kernel::{Ball, Enclosing, Scalar};
use crate::model::Distance;

impl Number for f64 {
    fn from_double(value: f64) -> f64 {
        value
    }

    fn unary(f: Unary, a: f64) -> f64 {
        match f {
            Unary::Negate => -a,
            Unary::WholePower(n) => whole_power(a, n),
            Unary::Sqrt => a.sqrt(),
            Unary::Sin => a.sin(),
            Unary::Cos => a.cos(),
            Unary::Exp => a.exp(),
            Unary::Abs => a.abs(),
        }
    }

    fn binary(f: Binary, a: f64, b: f64) -> f64 {
        match f {
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

fn whole_power(a: f64, n: i32) -> f64 {
    let product = (0..n.unsigned_abs()).fold(1.0, |product, _| product * a);
    if n < 0 { 1.0 / product } else { product }
}

/// A value with its derivatives along x and y, by the chain rule: exact up to rounding, no differences are taken.
#[derive(Clone, Copy)]
struct Dual {
    value: f64,
    slope: [f64; 2],
}

impl Distance for Expression {
    /// NaN where there is none. At the kink of abs, min or max, that of one side.
    fn gradient(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [x, y] = [(x, [1.0, 0.0]), (y, [0.0, 1.0])].map(|(value, slope)| Dual { value, slope });
        self.evaluate([x, y]).slope
    }
}

impl Expression {
    /// The degree in x and y, if the expression is a polynomial by its form.
    pub(super) fn polynomial_degree(&self) -> Option<u32> {
        self.form().degree
    }

    /// The coefficients of 1, x, x^2, .., if the expression is a polynomial in x alone.
    pub fn polynomial_in_x(&self) -> Option<Vec<f64>> {
        self.form().in_x
    }

    fn form(&self) -> Polynomial {
        let x = Polynomial { degree: Some(1), in_x: Some(vec![0.0, 1.0]) };
        self.evaluate([x, Polynomial { degree: Some(1), in_x: None }])
    }
}

impl Number for Dual {
    fn from_double(value: f64) -> Dual {
        Dual { value, slope: [0.0; 2] }
    }

    fn unary(f: Unary, a: Dual) -> Dual {
        let value = f64::unary(f, a.value);
        let factor = match f {
            Unary::Negate => -1.0,
            Unary::WholePower(0) => 0.0,
            Unary::WholePower(n) => f64::from(n) * f64::unary(Unary::WholePower(n - 1), a.value),
            Unary::Sqrt => 0.5 / value,
            Unary::Sin => a.value.cos(),
            Unary::Cos => -a.value.sin(),
            Unary::Exp => value,
            Unary::Abs => 1.0_f64.copysign(a.value),
        };
        // A factor is not computed where the operand is constant, as it may be infinite there.
        let constant = a.slope == [0.0; 2];
        Dual { value, slope: if constant { a.slope } else { a.slope.map(|slope| factor * slope) } }
    }

    fn binary(f: Binary, a: Dual, b: Dual) -> Dual {
        let value = f64::binary(f, a.value, b.value);
        // d = factors[0] da + factors[1] db
        let factors = match f {
            Binary::Add => [1.0, 1.0],
            Binary::Subtract => [1.0, -1.0],
            Binary::Multiply => [b.value, a.value],
            Binary::Divide => [1.0 / b.value, -value / b.value],
            Binary::Power => [b.value * a.value.powf(b.value - 1.0), value * a.value.ln()],
            Binary::Min if a.value < b.value => [1.0, 0.0],
            Binary::Max if a.value > b.value => [1.0, 0.0],
            Binary::Min | Binary::Max => [0.0, 1.0],
        };
        let constant = |d: Dual| d.slope == [0.0; 2];
        let part =
            |factor: f64, d: Dual, c: usize| if constant(d) { 0.0 } else { factor * d.slope[c] };
        let slope = [0, 1].map(|c| part(factors[0], a, c) + part(factors[1], b, c));
        Dual { value, slope }
    }
}

/// The assumed relative accuracy of the functions of the C library.
const LIBRARY: f64 = 4.0 * f64::EPSILON;

impl Number for Ball {
    fn from_double(value: f64) -> Ball {
        Ball::exactly(value)
    }

    fn unary(f: Unary, a: Ball) -> Ball {
        let one = Ball::from(1);
        let (centre, radius) = middle(a);
        match f {
            Unary::Negate => -a,
            Unary::WholePower(n) => {
                let product = (0..n.unsigned_abs()).fold(one, |product, _| product * a);
                if n < 0 { one / product } else { product }
            }
            Unary::Sqrt => a.sqrt(),
            Unary::Sin => near(centre.sin(), radius),
            Unary::Cos => near(centre.cos(), radius),
            Unary::Exp => near(centre.exp(), radius * (centre + radius).exp()),
            Unary::Abs => a.split(|a| -a, |a| a),
        }
    }

    fn binary(f: Binary, a: Ball, b: Ball) -> Ball {
        let zero = Ball::from(0);
        match f {
            Binary::Add => a + b,
            Binary::Subtract => a - b,
            Binary::Multiply => a * b,
            Binary::Divide => a / b,
            Binary::Min => b + (a - b).split(|d| d, |_| zero),
            Binary::Max => b + (a - b).split(|_| zero, |d| d),
            Binary::Power => {
                let ((base, spread), (exponent, other)) = (middle(a), middle(b));
                let is_known = spread == 0.0 && other == 0.0;
                near(base.powf(exponent), if is_known { 0.0 } else { f64::INFINITY })
            }
        }
    }
}

/// A double in a ball, and how far from it the others may be.
fn middle(ball: Ball) -> (f64, f64) {
    let (low, high) = (ball.lower(), ball.upper());
    if low == high {
        return (low, 0.0);
    }
    let centre = low / 2.0 + high / 2.0;
    (centre, (high - centre).max(centre - low).next_up())
}

/// All numbers at most `spread` away from `value`, the library's result.
fn near(value: f64, spread: f64) -> Ball {
    Ball::around(value, (spread + LIBRARY * value.abs()).next_up() * (1.0 + f64::EPSILON))
}

/// A polynomial by its form: its degree in x and y, and its coefficients if it is one in x alone and has not too many;
/// `None` where it is none.
#[derive(Clone)]
struct Polynomial {
    degree: Option<u32>,
    in_x: Option<Vec<f64>>,
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

fn sum(a: &[f64], sign: f64, b: &[f64]) -> Vec<f64> {
    let at = |p: &[f64], i: usize| p.get(i).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|i| at(a, i) + sign * at(b, i)).collect()
}

impl Number for Polynomial {
    fn from_double(value: f64) -> Polynomial {
        Polynomial { degree: Some(0), in_x: Some(vec![value]) }
    }

    fn unary(f: Unary, a: Polynomial) -> Polynomial {
        let degree = a.degree.and_then(|a| match f {
            Unary::Negate => Some(a),
            Unary::WholePower(n) if n >= 0 => a.checked_mul(n.unsigned_abs()),
            _ => Some(0).filter(|_| a == 0),
        });
        let in_x = a.in_x.and_then(|a| match (f, a.as_slice()) {
            (_, &[a]) => Some(vec![f64::unary(f, a)]),
            (Unary::Negate, a) => product(a, &[-1.0]),
            (Unary::WholePower(n), a) if n >= 0 => {
                (0..n).try_fold(vec![1.0], |power, _| product(&power, a))
            }
            _ => None,
        });
        Polynomial { degree, in_x }
    }

    fn binary(f: Binary, a: Polynomial, b: Polynomial) -> Polynomial {
        let degree = a.degree.zip(b.degree).and_then(|(a, b)| match f {
            Binary::Add | Binary::Subtract => Some(a.max(b)),
            Binary::Multiply => a.checked_add(b),
            Binary::Divide if b == 0 => Some(a),
            _ => Some(0).filter(|_| (a, b) == (0, 0)),
        });
        let in_x = a.in_x.zip(b.in_x).and_then(|(a, b)| match (f, a.as_slice(), b.as_slice()) {
            (_, &[a], &[b]) => Some(vec![f64::binary(f, a, b)]),
            (Binary::Add, a, b) => Some(sum(a, 1.0, b)),
            (Binary::Subtract, a, b) => Some(sum(a, -1.0, b)),
            (Binary::Multiply, a, b) => product(a, b),
            (Binary::Divide, a, &[c]) => Some(a.iter().map(|a| a / c).collect()),
            _ => None,
        });
        Polynomial { degree, in_x }
    }
}
