//! The gradient of an expression, by the chain rule along its steps: exact up to rounding, no differences are taken.

use super::{Binary, Expression, Number, Unary};

/// A value with its derivatives along x and y.
#[derive(Clone, Copy)]
struct Dual {
    value: f64,
    slope: [f64; 2],
}

impl Expression {
    /// The derivatives along x and y at this place; NaN where there is none. At the kink of abs, min or max, that of one
    /// side.
    pub fn gradient(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [x, y] = [(x, [1.0, 0.0]), (y, [0.0, 1.0])].map(|(value, slope)| Dual { value, slope });
        self.evaluate([x, y]).slope
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
        // A factor is not asked for where the operand is constant: it may be infinite there.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::Function;

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
}
