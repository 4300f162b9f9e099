//! Sums with products of double-doubles whose factors come again and again, with the bounds of Lemma 7.4 (docs/a-posteriori.md).

use crate::kernel::DoubleDouble;
use crate::kernel::double_double::{PRODUCT, SUM, UNDERFLOW, halves};

/// A factor of several products, its head split once for all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Multiplier {
    number: DoubleDouble,
    halves: [f64; 2],
}

impl From<DoubleDouble> for Multiplier {
    #[inline]
    fn from(number: DoubleDouble) -> Self {
        Multiplier { number, halves: halves(number.head()) }
    }
}

impl Multiplier {
    /// The product of the heads, and what rounding and the tails add to it.
    #[inline]
    fn times(self, other: Self) -> [f64; 2] {
        let (a, b) = (self.number, other.number);
        let head = a.head() * b.head();
        let ([a1, a2], [b1, b2]) = (self.halves, other.halves);
        let tail = ((a1 * b1 - head) + a1 * b2 + a2 * b1) + a2 * b2;
        [head, tail + (a.head() * b.tail() + a.tail() * b.head())]
    }
}

/// x + a b + c d, rounded, and a bound of the error: quicker than the operators, which find the halves of each factor anew.
#[inline]
pub(super) fn rounded_sum_with_products(
    x: DoubleDouble,
    [(a, b), (c, d)]: [(Multiplier, Multiplier); 2],
) -> (DoubleDouble, f64) {
    let [[p, p_tail], [q, q_tail]] = [a.times(b), c.times(d)];
    let products = DoubleDouble::sum(p, q);
    let tail = (p_tail + q_tail) + products.tail();
    let heads = DoubleDouble::sum(x.head(), products.head());
    let sum = DoubleDouble::sum(heads.head(), heads.tail() + (x.tail() + tail));
    let of_products = 2.0 * (PRODUCT * (p.abs() + q.abs()) + UNDERFLOW);
    (sum, SUM * x.head().abs() + of_products)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::PreciseBall;

    #[test]
    fn products_that_are_added_are_those_of_the_operators() {
        let parts = [3.0, -0.7, 1e-9, 12345.678];
        let exact = parts.map(|x| DoubleDouble::sum(x, x * 1e-17 / 3.0));
        let third = DoubleDouble::from(1) / DoubleDouble::from(3);
        let [a, b, c, d] = exact.map(Multiplier::from);
        let (sum, error) = rounded_sum_with_products(third, [(a, b), (c, d)]);
        let [a, b, c, d] = exact.map(PreciseBall::from);
        let off = PreciseBall::around(sum, error) - (PreciseBall::from(third) + a * b + c * d);
        assert!(off.lower() <= 0.0 && off.upper() >= 0.0 && off.magnitude() < 1e-29, "{off:?}");
        assert!(off.head() != 0.0, "control: the sums alone differ, {off:?}");
    }
}
