//! The gradient of an expression, by the chain rule along its steps: exact up to rounding, no differences are taken.

use super::{Binary, Expression, Unary, Value};

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
        let mut slots = vec![Dual { value: f64::NAN, slope: [f64::NAN; 2] }; self.slots];
        let gradient = self.run(&mut slots, |value, slots| match value {
            Value::Number(bits) => Dual { value: f64::from_bits(bits), slope: [0.0; 2] },
            Value::X => Dual { value: x, slope: [1.0, 0.0] },
            Value::Y => Dual { value: y, slope: [0.0, 1.0] },
            Value::Unary(f, a) => f.of_dual(slots[a as usize]),
            Value::Binary(f, a, b) => f.of_duals(slots[a as usize], slots[b as usize]),
        });
        gradient.map_or([f64::NAN; 2], |dual| dual.slope)
    }
}

impl Unary {
    fn of_dual(self, a: Dual) -> Dual {
        let value = self.of(a.value);
        let factor = match self {
            Unary::Negate => -1.0,
            Unary::WholePower(0) => 0.0,
            Unary::WholePower(n) => f64::from(n) * Unary::WholePower(n - 1).of(a.value),
            Unary::Sqrt => 0.5 / value,
            Unary::Sin => a.value.cos(),
            Unary::Cos => -a.value.sin(),
            Unary::Exp => value,
            Unary::Abs => 1.0_f64.copysign(a.value),
        };
        Dual { value, slope: a.slope.map(|slope| factor * slope) }
    }
}

impl Binary {
    fn of_duals(self, a: Dual, b: Dual) -> Dual {
        let value = self.of(a.value, b.value);
        // d = factors[0] da + factors[1] db; a factor is not asked for where its operand is constant.
        let constant = |d: Dual| d.slope == [0.0; 2];
        let factors = match self {
            Binary::Add => [1.0, 1.0],
            Binary::Subtract => [1.0, -1.0],
            Binary::Multiply => [b.value, a.value],
            Binary::Divide => [1.0 / b.value, -value / b.value],
            Binary::Power => [b.value * a.value.powf(b.value - 1.0), value * a.value.ln()],
            Binary::Min if a.value < b.value => [1.0, 0.0],
            Binary::Max if a.value > b.value => [1.0, 0.0],
            Binary::Min | Binary::Max => [0.0, 1.0],
        };
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
