//! Points on a path: counterexamples for paths that fail, witnesses for classes.
//!
//! Not trusted: a point counts only after the predicate itself was run there.

use num_rational::BigRational;
use num_traits::Zero;

use super::explorer::{Path, Sense};
use super::polynomial::{Polynomial, integer};

/// A small generator of random numbers (splitmix64): the same draws everywhere, every time.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The generator with this seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `bound`.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.bits() % bound as u64) as usize
    }

    /// 0, 1, -1 and the sides of the right triangles 3, 4, 5 with hypotenuse 1: rational points of the unit circle.
    fn on_circle(&mut self) -> BigRational {
        const FIFTHS: [i64; 7] = [0, 5, -5, 3, -3, 4, -4];
        integer(FIFTHS[self.below(7)]) / integer(5)
    }

    /// A small rational number: mostly integers and halves, often zero.
    pub fn rational(&mut self) -> BigRational {
        const DENOMINATORS: [i64; 8] = [1, 1, 1, 1, 2, 2, 5, 10];
        if self.below(6) == 0 {
            return BigRational::zero();
        }
        let denominator = DENOMINATORS[self.below(8)];
        let numerator = if self.below(12) == 0 { 40 } else { self.below(11) as i64 - 5 };
        integer(numerator) / integer(denominator)
    }
}

/// A point that satisfies all facts of a path, if one of `tries` draws finds it. Equations are solved in turn for a
/// variable in which they are linear; one that is linear in none is tried with points of the unit circle. The values are those of
/// the unknowns, without the inverses.
pub fn sample(path: &Path, random: &mut Random, tries: usize) -> Option<Vec<BigRational>> {
    let mut point = (0..tries).find_map(|_| draw(path, random))?;
    point.truncate(path.variables - path.inverses.len());
    Some(point)
}

fn draw(path: &Path, random: &mut Random) -> Option<Vec<BigRational>> {
    let mut values: Vec<Option<BigRational>> = vec![None; path.variables];
    for fact in path.facts.iter().filter(|f| f.sense == Sense::Zero) {
        satisfy(&fact.polynomial, &mut values, random)?;
    }
    let mut point: Vec<BigRational> = Vec::new();
    for value in values {
        let tie = !point.is_empty() && random.below(8) == 0;
        let free = if tie { point[random.below(point.len())].clone() } else { random.rational() };
        point.push(value.unwrap_or(free));
    }
    path.facts.iter().all(|fact| fact.holds_at(&point)).then_some(point)
}

/// Gives values to the variables of an equation that have none yet, so that it holds.
fn satisfy(
    equation: &Polynomial,
    values: &mut [Option<BigRational>],
    random: &mut Random,
) -> Option<()> {
    let mut rest = equation.clone();
    for (i, value) in values.iter().enumerate() {
        if let Some(value) = value {
            rest = rest.substituted(i, value);
        }
    }
    let open = rest.variables();
    let linear: Vec<usize> =
        open.iter().copied().filter(|&i| rest.derivative(i).derivative(i).is_zero()).collect();
    if linear.is_empty() {
        for i in open {
            let value = random.on_circle();
            rest = rest.substituted(i, &value);
            values[i] = Some(value);
        }
        return rest.is_zero().then_some(());
    }
    let unknown = linear[random.below(linear.len())];
    for &i in open.iter().filter(|&&i| i != unknown) {
        let value = random.rational();
        rest = rest.substituted(i, &value);
        values[i] = Some(value);
    }
    let slope = rest.derivative(unknown).as_constant()?;
    let start = rest.substituted(unknown, &BigRational::zero()).as_constant()?;
    if slope.is_zero() {
        return None;
    }
    values[unknown] = Some(-start / slope);
    Some(())
}
