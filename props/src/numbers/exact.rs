//! Exact rational numbers that are `Copy`, as the kernel asks for: a handle into an arena of the current thread.
//!
//! Work in a scope ([`Exact::scope`]): when it ends, the arena is emptied. A handle that is used after its scope panics,
//! so it can't silently mean another number.

use std::cell::RefCell;
use std::cmp::Ordering;
use std::fmt;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;

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

/// numerator / denominator
impl From<(i64, i64)> for Exact {
    fn from((numerator, denominator): (i64, i64)) -> Exact {
        Exact::ratio(numerator, denominator)
    }
}

impl From<i32> for Exact {
    fn from(value: i32) -> Exact {
        Exact::new(BigRational::from_integer(BigInt::from(value)))
    }
}

impl PartialEq for Exact {
    fn eq(&self, other: &Exact) -> bool {
        self.with_both(*other, rational::equal)
    }
}

impl PartialOrd for Exact {
    fn partial_cmp(&self, other: &Exact) -> Option<Ordering> {
        Some(self.with_both(*other, rational::order))
    }
}

super::number! { Exact:
    + |a, b| Exact::new(a.with_both(b, rational::sum));
    - |a, b| Exact::new(a.with_both(b, rational::difference));
    * |a, b| Exact::new(a.with_both(b, rational::product));
    / |a, b| Exact::new(a.with_both(b, rational::quotient));
    neg |a| Exact::new(a.with(|a| -a));
    nonpositive |a| a.with(|a| !a.is_positive());
}

impl fmt::Debug for Exact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.with(|a| write!(f, "{a}"))
    }
}

#[cfg(test)]
mod tests {
    use signorini::kernel::Scalar;

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
    #[should_panic(expected = "outlived its scope")]
    fn a_number_does_not_outlive_its_scope() {
        let late = Exact::scope(|| Exact::from(1));
        let _ = late + Exact::from(1);
    }
}
