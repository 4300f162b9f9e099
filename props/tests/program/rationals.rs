//! Rational numbers as the checker of certificates takes numbers that enclose: they are the truth, but for roots.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::ToPrimitive;
use signorini::kernel::Enclosing;

use props::numbers::Exact;

impl Enclosing for Exact {
    fn exactly(value: f64) -> Exact {
        Exact::of_double(value)
    }

    /// Below the root by less than 2^-200 over the denominator; exact for squares of fractions with that denominator.
    fn sqrt(self) -> Exact {
        let value = self.value();
        let (numerator, denominator) = (value.numer(), value.denom());
        let root: BigInt = ((numerator * denominator) << 400_u32).sqrt();
        Exact::new(BigRational::new(root, denominator << 200_u32))
    }

    /// The next double.
    fn upper(self) -> f64 {
        let value = self.value();
        let is_above = |x: f64| BigRational::from_float(x).is_none_or(|x| x >= value);
        let mut x = value.to_f64().unwrap_or(f64::INFINITY);
        while !is_above(x) {
            x = x.next_up();
        }
        while is_above(x.next_down()) {
            x = x.next_down();
        }
        x
    }

    fn lower(self) -> f64 {
        -(-self).upper()
    }
}

#[test]
fn ends_are_the_next_doubles_and_roots_of_squares_are_exact() {
    let third = Exact::ratio(1, 3);
    assert!(Exact::of_double(third.lower()) < third && third < Exact::of_double(third.upper()));
    assert_eq!(third.upper(), third.lower().next_up());
    assert_eq!((Exact::of_double(-0.1).lower(), Exact::of_double(-0.1).upper()), (-0.1, -0.1));
    assert_eq!(Exact::ratio(49, 4).sqrt(), Exact::ratio(7, 2));
    let root = Exact::from(2).sqrt();
    let next = root + Exact::of_double(2.0_f64.powi(-200));
    assert!(root * root < Exact::from(2) && Exact::from(2) < next * next);
}

#[test]
fn shortcuts_are_the_operations_in_lowest_terms() {
    let ratio = |n: i64, d: i64| BigRational::new(n.into(), d.into());
    let numerators = [-12, -5, -4, -1, 0, 1, 2, 3, 6, 8, 1 << 40];
    let numbers = numerators.map(|n| [1, 2, 3, 8, 12].map(|d| ratio(n, d)));
    for (a, b) in numbers
        .as_flattened()
        .iter()
        .flat_map(|a| numbers.as_flattened().iter().map(move |b| (a, b)))
    {
        let parts = |x: BigRational| (x.numer().clone(), x.denom().clone());
        assert_eq!(parts(rational::sum(a, b)), parts(a + b), "{a} + {b}");
        assert_eq!(parts(rational::product(a, b)), parts(a * b), "{a} {b}");
        if *b != ratio(0, 1) {
            assert_eq!(parts(rational::quotient(a, b)), parts(a / b), "{a} / {b}");
        }
    }
}
