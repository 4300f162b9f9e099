//! Sums, products and quotients of rational numbers, as num-rational has them, but without a greatest common divisor where the
//! denominators are powers of 2, as those of doubles and of whole numbers: there a shift brings to lowest terms. Elsewhere the
//! divisors are as small as can be (Knuth, 4.5.1).

use std::cmp::Ordering;

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// k where a number is 2^k.
fn exponent(number: &BigInt) -> Option<u64> {
    number.trailing_zeros().filter(|zeros| zeros + 1 == number.bits() && number.is_positive())
}

/// numerator / 2^exponent
fn dyadic(numerator: BigInt, exponent: u64) -> BigRational {
    let zeros = numerator.trailing_zeros().map_or(exponent, |zeros| zeros.min(exponent));
    let numerator = if zeros == 0 { numerator } else { numerator >> zeros };
    BigRational::new_raw(numerator, BigInt::one() << (exponent - zeros))
}

/// The greatest common divisor, by words where both numbers, or what one leaves of the other, fit into two of them.
fn common(a: &BigInt, b: &BigInt) -> BigInt {
    let (large, small) = if a.bits() > b.bits() { (a, b) } else { (b, a) };
    if small.is_zero() {
        return large.abs();
    }
    let rest = if large.bits() > small.bits() { large % small } else { large.clone() };
    match (rest.magnitude().to_u128(), small.magnitude().to_u128()) {
        (Some(rest), Some(small)) => rest.gcd(&small).into(),
        _ => rest.gcd(small),
    }
}

/// a + b
pub fn sum(a: &BigRational, b: &BigRational) -> BigRational {
    match (exponent(a.denom()), exponent(b.denom())) {
        (Some(p), Some(q)) if p == q => dyadic(a.numer() + b.numer(), p),
        (Some(p), Some(q)) if p < q => dyadic((a.numer() << (q - p)) + b.numer(), q),
        (Some(p), Some(q)) => dyadic(a.numer() + (b.numer() << (p - q)), p),
        _ => {
            let both = common(a.denom(), b.denom());
            let (p, q) = (a.denom() / &both, b.denom() / &both);
            let sum = a.numer() * &q + b.numer() * &p;
            let shared = common(&sum, &both);
            BigRational::new_raw(sum / &shared, p * (b.denom() / shared))
        }
    }
}

/// a - b
pub fn difference(a: &BigRational, b: &BigRational) -> BigRational {
    sum(a, &-b)
}

/// a b
pub fn product(a: &BigRational, b: &BigRational) -> BigRational {
    match (exponent(a.denom()), exponent(b.denom())) {
        (Some(p), Some(q)) => dyadic(a.numer() * b.numer(), p + q),
        _ => {
            let (p, q) = (common(a.numer(), b.denom()), common(b.numer(), a.denom()));
            let numerator = a.numer() / &p * (b.numer() / &q);
            BigRational::new_raw(numerator, a.denom() / q * (b.denom() / p))
        }
    }
}

/// a / b
pub fn quotient(a: &BigRational, b: &BigRational) -> BigRational {
    product(a, &b.recip())
}

/// a = b
pub fn equal(a: &BigRational, b: &BigRational) -> bool {
    a == b
}

/// a < b, a = b or a > b
pub fn order(a: &BigRational, b: &BigRational) -> Ordering {
    a.cmp(b)
}
