//! Sums with products of a double and a double-double, with the bounds of Lemma 7.4 (docs/a-posteriori.md).

use crate::kernel::DoubleDouble;
use crate::kernel::double_double::{PRODUCT, SUM, UNDERFLOW};

/// The product of the heads, and what rounding and the tail add to it: fused, as processors have it.
#[inline(always)]
fn times(a: f64, b: DoubleDouble) -> [f64; 2] {
    let head = a * b.head();
    [head, a.mul_add(b.tail(), a.mul_add(b.head(), -head))]
}

/// x + a b + c d, rounded, and a bound of the error: quicker than the operators.
#[inline(always)]
pub(super) fn rounded_sum_with_products(
    x: DoubleDouble,
    [(a, b), (c, d)]: [(f64, DoubleDouble); 2],
) -> (DoubleDouble, f64) {
    let [[p, p_tail], [q, q_tail]] = [times(a, b), times(c, d)];
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
        let third = DoubleDouble::from(1) / DoubleDouble::from(3);
        let mut differ = 0;
        for k in 1..20 {
            let [a, b, c, d] = [1.1, 2.3, 3.7, 4.9].map(|x| (x * f64::from(k)).sin());
            let [b, d] = [b, 1e3 * d].map(|x| DoubleDouble::sum(x, x * 1e-17 / 3.0));
            let (sum, error) = rounded_sum_with_products(third, [(a, b), (c, d)]);
            let ([a, c], [b, d]) = ([a, c].map(PreciseBall::from), [b, d].map(PreciseBall::from));
            let off = PreciseBall::around(sum, error) - (PreciseBall::from(third) + a * b + c * d);
            assert!(off.lower() <= 0.0 && off.upper() >= 0.0 && off.magnitude() < 1e-26, "{off:?}");
            differ += usize::from(off.head() != 0.0);
        }
        assert!(differ > 5, "control: the sums alone differ, {differ}");
    }
}
