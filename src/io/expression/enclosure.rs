//! Expressions over balls: what doubles make of an expression whose terms cancel is off by more than it seems.

use super::{Binary, Number, Unary};
use crate::kernel::{Ball, Enclosing, Scalar};

/// The functions of the C library are taken to be this accurate, in units of their values.
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

/// All numbers at most `spread` from what the library says is `value`.
fn near(value: f64, spread: f64) -> Ball {
    Ball::around(value, (spread + LIBRARY * value.abs()).next_up() * (1.0 + f64::EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Expression;

    fn enclosed(text: &str, x: [f64; 2]) -> [f64; 2] {
        let value = text.parse::<Expression>().unwrap().evaluate(x.map(Ball::exactly));
        [value.lower(), value.upper()]
    }

    #[test]
    fn values_lie_inside_and_cancellation_is_seen() {
        for (text, value, width) in [
            ("10*x - 4", -1.0, 1e-14),
            ("((10*x + 1e18) - 1e18) - 4", -1.0, 2000.0),
            ("x^3*y^-2 - sqrt(x)*abs(-y)", 0.3_f64.powi(3) * 4.0 - 0.3_f64.sqrt() * 0.5, 1e-14),
            ("sin(x)*cos(y) + exp(x)", 0.3_f64.sin() * 0.5_f64.cos() + 0.3_f64.exp(), 1e-14),
            ("min(x, y) + 2*max(x, 1 - y)", 1.3, 1e-14),
            ("2^0.5*x/y", std::f64::consts::SQRT_2 * 0.6, 1e-14),
        ] {
            let [low, high] = enclosed(text, [0.3, 0.5]);
            assert!(low <= value + 1e-15 && value - 1e-15 <= high, "{text}: {low} {high}");
            assert!(high - low <= width, "{text}: {low} {high}");
        }
        let [low, high] = enclosed("((10*x + 1e18) - 1e18) - 4", [0.3, 0.5]);
        assert!(high - low > 100.0, "what doubles lose is in the width: {low} {high}");
        // What has no bound is not taken for known.
        assert!(!(enclosed("x^y", [0.3, 0.5])[0] > 1.0));
        let [low, high] = enclosed("(x - x*(1 + y))^0.5", [0.3, 0.5]);
        assert!(!(low > 0.0 || high < 1.0), "{low} {high}");
    }
}
