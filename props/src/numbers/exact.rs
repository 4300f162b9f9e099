//! Exact rational numbers that are `Copy`, as the kernel asks for: a handle into an arena of the current thread.
//!
//! Work in a scope ([`Exact::scope`]): when it ends, the arena is emptied. A handle that is used after its scope panics,
//! so it can't silently mean another number.

use std::cell::RefCell;
use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use signorini::kernel::{Enclosing, Scalar};

struct Arena {
    scope: u32,
    numbers: Vec<BigRational>,
}

thread_local! {
    static ARENA: RefCell<Arena> = const { RefCell::new(Arena { scope: 0, numbers: Vec::new() }) };
}

/// An exact rational number.
#[derive(Clone, Copy)]
pub struct Exact {
    scope: u32,
    index: u32,
}

impl Exact {
    /// Runs `work` in a scope of its own; no `Exact` outlives it, and scopes do not nest.
    pub fn scope<T>(work: impl FnOnce() -> T) -> T {
        Exact::clear();
        let result = work();
        Exact::clear();
        result
    }

    fn clear() {
        ARENA.with_borrow_mut(|arena| {
            arena.scope += 1;
            arena.numbers.clear();
        });
    }

    /// The number with this value.
    pub fn new(value: BigRational) -> Exact {
        ARENA.with_borrow_mut(|arena| {
            arena.numbers.push(value);
            let index = u32::try_from(arena.numbers.len() - 1).expect("fewer than 2^32 numbers");
            Exact { scope: arena.scope, index }
        })
    }

    /// numerator / denominator
    pub fn ratio(numerator: i64, denominator: i64) -> Exact {
        Exact::new(BigRational::new(BigInt::from(numerator), BigInt::from(denominator)))
    }

    /// The value of a finite double, exactly.
    pub fn of_double(value: f64) -> Exact {
        Exact::new(BigRational::from_float(value).expect("a finite double"))
    }

    /// Its value.
    pub fn value(self) -> BigRational {
        self.with(BigRational::clone)
    }

    /// ((1 - t^2), 2 t)/(1 + t^2): a unit vector by the tangent of its half angle.
    pub fn on_circle(self) -> [Exact; 2] {
        let one = Exact::from(1);
        let norm = one + self * self;
        [(one - self * self) / norm, Exact::from(2) * self / norm]
    }

    /// |self|
    pub fn abs(self) -> Exact {
        Exact::new(self.with(BigRational::abs))
    }

    fn with<T>(self, work: impl FnOnce(&BigRational) -> T) -> T {
        ARENA.with_borrow(|arena| {
            assert_eq!(self.scope, arena.scope, "an exact number outlived its scope");
            work(&arena.numbers[self.index as usize])
        })
    }

    fn with_both<T>(self, other: Exact, work: impl FnOnce(&BigRational, &BigRational) -> T) -> T {
        self.with(|a| other.with(|b| work(a, b)))
    }
}

/// The value of a finite double, exactly.
impl From<f64> for Exact {
    fn from(value: f64) -> Exact {
        Exact::of_double(value)
    }
}

impl From<i32> for Exact {
    fn from(value: i32) -> Exact {
        Exact::new(BigRational::from_integer(BigInt::from(value)))
    }
}

macro_rules! operator {
    ($operator:ident, $function:ident, $work:expr) => {
        impl $operator for Exact {
            type Output = Exact;

            fn $function(self, other: Exact) -> Exact {
                Exact::new(self.with_both(other, $work))
            }
        }
    };
}

operator!(Add, add, |a, b| a + b);
operator!(Sub, sub, |a, b| a - b);
operator!(Mul, mul, |a, b| a * b);
operator!(Div, div, |a, b| a / b);

impl Neg for Exact {
    type Output = Exact;

    fn neg(self) -> Exact {
        Exact::new(self.with(|a| -a))
    }
}

impl PartialEq for Exact {
    fn eq(&self, other: &Exact) -> bool {
        self.with_both(*other, |a, b| a == b)
    }
}

impl PartialOrd for Exact {
    fn partial_cmp(&self, other: &Exact) -> Option<Ordering> {
        Some(self.with_both(*other, Ord::cmp))
    }
}

signorini::entry_of_nalgebra!(Exact);

impl Scalar for Exact {
    fn split(
        self,
        nonpositive: impl FnOnce(Exact) -> Exact,
        positive: impl FnOnce(Exact) -> Exact,
    ) -> Exact {
        if self.with(|a| a.is_negative() || a.is_zero()) {
            nonpositive(self)
        } else {
            positive(self)
        }
    }
}

/// For the checker of certificates: the truth, but for roots.
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

impl fmt::Debug for Exact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.with(|a| write!(f, "{a}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenth_plus_two_tenths_is_three_tenths() {
        assert_eq!(Exact::ratio(1, 10) + Exact::ratio(2, 10), Exact::ratio(3, 10));
        assert!(Exact::of_double(0.1) + Exact::of_double(0.2) > Exact::of_double(0.3));
    }

    #[test]
    fn order_and_split_know_the_sign() {
        assert!(Exact::ratio(-1, 3) < Exact::from(0));
        for (value, expected) in [(-1, 10), (0, 10), (1, 20)] {
            let answer = Exact::from(value).split(|_| Exact::from(10), |_| Exact::from(20));
            assert_eq!(answer, Exact::from(expected));
        }
        assert_eq!((-Exact::ratio(7, 2)).abs(), Exact::of_double(3.5));
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
    #[should_panic(expected = "outlived its scope")]
    fn a_number_does_not_outlive_its_scope() {
        let late = Exact::scope(|| Exact::from(1));
        let _ = late + Exact::from(1);
    }
}
