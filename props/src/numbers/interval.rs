//! Intervals of doubles that contain the exact result: the number type of enclosures.
//!
//! An operation takes the double result at each end and goes one double further out (`next_down`, `next_up`): the
//! rounded result is within one double of the exact one, so the exact one is inside. A sum or a product that is zero
//! without underflow is exact and stays sharp. What can't be bounded is \[-oo, oo\]: a quotient by an interval that
//! contains zero, an overflow. A NaN makes both ends NaN and stays.

use std::ops::{Add, Div, Mul, Neg, Sub};

use signorini::kernel::{Enclosing, Scalar};

/// All real numbers between two doubles, ends included; an infinite end is no number but no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// The interval from `lo` to `hi`, in either order. NaN if one of them is.
    #[inline]
    pub fn new(lo: f64, hi: f64) -> Interval {
        if lo <= hi {
            Interval { lo, hi }
        } else if hi <= lo {
            Interval { lo: hi, hi: lo }
        } else {
            Interval::NAN
        }
    }

    /// The interval that contains this double only.
    #[inline]
    pub fn point(value: f64) -> Interval {
        Interval::new(value, value)
    }

    const NAN: Interval = Interval { lo: f64::NAN, hi: f64::NAN };
    const EVERYTHING: Interval = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// The lower end.
    #[inline]
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// The upper end.
    #[inline]
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// Returns whether it is the result of a NaN.
    #[inline]
    pub fn is_nan(self) -> bool {
        self.lo.is_nan()
    }

    /// Returns whether `value` lies in it.
    #[inline]
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// The smallest interval that contains both. NaN if one of them is.
    #[inline]
    pub fn hull(self, other: Interval) -> Interval {
        if self.is_nan() || other.is_nan() {
            return Interval::NAN;
        }
        let [lo, _, _, hi] = sorted([self.lo, self.hi, other.lo, other.hi]);
        Interval { lo, hi }
    }

    /// The square roots of its nonnegative numbers; NaN if it has none.
    #[inline]
    pub fn sqrt(self) -> Interval {
        if !(self.hi >= 0.0) {
            return Interval::NAN;
        }
        let lo = if self.lo > 0.0 { self.lo.sqrt().next_down() } else { 0.0 };
        let hi = if self.hi > 0.0 { self.hi.sqrt().next_up() } else { 0.0 };
        Interval { lo, hi }
    }

    /// One double further out at each end that isn't an exact zero.
    #[inline]
    fn outward(lo: f64, hi: f64) -> Interval {
        let lo = if lo == 0.0 { 0.0 } else { lo.next_down() };
        let hi = if hi == 0.0 { 0.0 } else { hi.next_up() };
        Interval { lo, hi }
    }
}

/// Four numbers by size: a product of two intervals lies between the least and the greatest product of ends.
pub fn sorted<T: Copy + PartialOrd>(mut values: [T; 4]) -> [T; 4] {
    for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
        if !(values[i] <= values[j]) {
            values.swap(i, j);
        }
    }
    values
}

/// x y rounded down and up; exact where it is zero without underflow, also for 0 * oo, where oo stands for "no bound".
#[inline]
fn product(x: f64, y: f64) -> Interval {
    if x == 0.0 || y == 0.0 {
        return Interval { lo: 0.0, hi: 0.0 };
    }
    let rounded = x * y;
    Interval { lo: rounded.next_down(), hi: rounded.next_up() }
}

/// x / y rounded down and up, for y != 0; exact where x is zero.
#[inline]
fn quotient(x: f64, y: f64) -> Interval {
    if x == 0.0 {
        return Interval { lo: 0.0, hi: 0.0 };
    }
    if x.is_infinite() && y.is_infinite() {
        return if x.is_sign_negative() != y.is_sign_negative() {
            Interval { lo: f64::NEG_INFINITY, hi: 0.0 }
        } else {
            Interval { lo: 0.0, hi: f64::INFINITY }
        };
    }
    let rounded = x / y;
    Interval { lo: rounded.next_down(), hi: rounded.next_up() }
}

/// The hull of `f` at the four pairs of ends.
#[inline]
fn of_ends(a: Interval, b: Interval, f: fn(f64, f64) -> Interval) -> Interval {
    let at = [f(a.lo, b.lo), f(a.lo, b.hi), f(a.hi, b.lo), f(a.hi, b.hi)];
    let [lo, ..] = sorted(at.map(|i| i.lo));
    let [.., hi] = sorted(at.map(|i| i.hi));
    Interval { lo, hi }
}

impl From<i32> for Interval {
    #[inline]
    fn from(value: i32) -> Interval {
        Interval::point(f64::from(value))
    }
}

impl Add for Interval {
    type Output = Interval;

    #[inline]
    fn add(self, other: Interval) -> Interval {
        Interval::outward(self.lo + other.lo, self.hi + other.hi)
    }
}

impl Neg for Interval {
    type Output = Interval;

    #[inline]
    fn neg(self) -> Interval {
        Interval { lo: -self.hi, hi: -self.lo }
    }
}

impl Sub for Interval {
    type Output = Interval;

    #[inline]
    fn sub(self, other: Interval) -> Interval {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Interval;

    #[inline]
    fn mul(self, other: Interval) -> Interval {
        if self.is_nan() || other.is_nan() {
            return Interval::NAN;
        }
        of_ends(self, other, product)
    }
}

impl Div for Interval {
    type Output = Interval;

    #[inline]
    fn div(self, other: Interval) -> Interval {
        if self.is_nan() || other.is_nan() {
            return Interval::NAN;
        }
        if other.contains(0.0) {
            return Interval::EVERYTHING;
        }
        of_ends(self, other, quotient)
    }
}

signorini::kernel::entry_of_nalgebra!(Interval);

impl Scalar for Interval {
    #[inline]
    fn split(
        self,
        nonpositive: impl FnOnce(Interval) -> Interval,
        positive: impl FnOnce(Interval) -> Interval,
    ) -> Interval {
        if self.hi <= 0.0 {
            nonpositive(self)
        } else if self.lo <= 0.0 {
            let below = nonpositive(Interval { lo: self.lo, hi: 0.0 });
            below.hull(positive(Interval { lo: 0.0, hi: self.hi }))
        } else {
            positive(self)
        }
    }
}

impl Enclosing for Interval {
    #[inline]
    fn exactly(value: f64) -> Interval {
        Interval::point(value)
    }

    #[inline]
    fn sqrt(self) -> Interval {
        Interval::sqrt(self)
    }

    #[inline]
    fn upper(self) -> f64 {
        self.hi()
    }

    #[inline]
    fn lower(self) -> f64 {
        self.lo()
    }
}
