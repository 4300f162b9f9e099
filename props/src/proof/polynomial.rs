//! Polynomials in several variables with exact rational coefficients.
//!
//! Trusted: the checker of certificates rests on this arithmetic.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Write;
use std::ops::{Add, Mul, Neg, Sub};

use num_rational::BigRational;
use num_traits::{One, Zero};

/// An exponent. The sum of two is checked: one that wrapped around would make x^257 = x, in builds without overflow checks.
pub type Exponent = u16;

/// The exponents of the variables, without trailing zeros.
pub type Monomial = Vec<Exponent>;

/// A polynomial: its monomials with their coefficients, none of which is zero. Equal maps are equal polynomials.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Polynomial(BTreeMap<Monomial, BigRational>);

impl Polynomial {
    /// A constant.
    pub fn constant(value: BigRational) -> Polynomial {
        Polynomial::term(Vec::new(), value)
    }

    /// The variable with this number.
    pub fn variable(index: usize) -> Polynomial {
        let mut monomial = vec![0; index];
        monomial.push(1);
        Polynomial::term(monomial, BigRational::one())
    }

    /// coefficient * monomial
    pub fn term(monomial: Monomial, coefficient: BigRational) -> Polynomial {
        let mut sum = Polynomial::default();
        sum.add_term(monomial, coefficient);
        sum
    }

    fn add_term(&mut self, monomial: Monomial, coefficient: BigRational) {
        if coefficient.is_zero() {
            return;
        }
        match self.0.entry(monomial) {
            Entry::Vacant(entry) => {
                entry.insert(coefficient);
            }
            Entry::Occupied(mut entry) => {
                *entry.get_mut() = rational::sum(entry.get(), &coefficient);
                if entry.get().is_zero() {
                    entry.remove();
                }
            }
        }
    }

    /// Whether it is the zero polynomial.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Its value, if it has no variables.
    pub fn as_constant(&self) -> Option<BigRational> {
        match self.0.len() {
            0 => Some(BigRational::zero()),
            1 => self.0.get(&Vec::new()).cloned(),
            _ => None,
        }
    }

    /// Its monomials with their coefficients.
    pub fn terms(&self) -> impl Iterator<Item = (&Monomial, &BigRational)> {
        self.0.iter()
    }

    /// The numbers of its variables.
    pub fn variables(&self) -> Vec<usize> {
        let longest = self.0.keys().map(Vec::len).max().unwrap_or(0);
        (0..longest).filter(|&i| self.0.keys().any(|m| m.get(i).is_some_and(|&e| e > 0))).collect()
    }

    /// The polynomial divided by its leading coefficient, and that coefficient. Not for zero.
    pub fn monic(&self) -> (Polynomial, BigRational) {
        let lead = self.0.values().next_back().expect("not the zero polynomial").clone();
        (self.scaled(&lead.recip()), lead)
    }

    /// factor * self
    pub fn scaled(&self, factor: &BigRational) -> Polynomial {
        if factor.is_zero() {
            return Polynomial::default();
        }
        Polynomial(self.0.iter().map(|(m, c)| (m.clone(), rational::product(c, factor))).collect())
    }

    /// The product; `None` where an exponent would be beyond the largest [`Exponent`].
    pub fn times(&self, other: &Polynomial) -> Option<Polynomial> {
        let mut sum = Polynomial::default();
        for (m, c) in &self.0 {
            for (n, d) in &other.0 {
                sum.add_term(product(m, n)?, rational::product(c, d));
            }
        }
        Some(sum)
    }

    /// The derivative with respect to a variable.
    pub fn derivative(&self, variable: usize) -> Polynomial {
        let mut sum = Polynomial::default();
        for (monomial, coefficient) in &self.0 {
            if let Some(&exponent) = monomial.get(variable).filter(|&&e| e > 0) {
                let mut lower = monomial.clone();
                lower[variable] -= 1;
                trim(&mut lower);
                sum.add_term(lower, coefficient * integer(i64::from(exponent)));
            }
        }
        sum
    }

    /// The polynomial with `value` in place of a variable.
    pub fn substituted(&self, variable: usize, value: &BigRational) -> Polynomial {
        let mut sum = Polynomial::default();
        for (monomial, coefficient) in &self.0 {
            let mut rest = monomial.clone();
            let mut coefficient = coefficient.clone();
            if let Some(exponent) = rest.get_mut(variable) {
                coefficient *= power(value, *exponent);
                *exponent = 0;
            }
            trim(&mut rest);
            sum.add_term(rest, coefficient);
        }
        sum
    }

    /// Its value at a point.
    pub fn at(&self, point: &[BigRational]) -> BigRational {
        let value = |monomial: &Monomial| {
            let powers = monomial.iter().zip(point).map(|(&e, x)| power(x, e));
            powers.fold(BigRational::one(), |product, p| product * p)
        };
        self.0.iter().map(|(m, c)| c * value(m)).fold(BigRational::zero(), |sum, t| sum + t)
    }

    /// As a sum of terms such as `3/2 a^2 b`; `0` for zero.
    pub fn text(&self, names: &[String]) -> String {
        let term = |(monomial, coefficient): (&Monomial, &BigRational)| {
            let mut text = coefficient.to_string();
            for (name, exponent) in names.iter().zip(monomial).filter(|&(_, &e)| e > 0) {
                let _ = match exponent {
                    1 => write!(text, " {name}"),
                    _ => write!(text, " {name}^{exponent}"),
                };
            }
            text
        };
        let terms: Vec<String> = self.0.iter().map(term).collect();
        if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") }
    }
}

/// An integer as a rational number.
pub fn integer(value: i64) -> BigRational {
    BigRational::from_integer(value.into())
}

fn power(base: &BigRational, exponent: Exponent) -> BigRational {
    (0..exponent).fold(BigRational::one(), |product, _| product * base)
}

fn trim(monomial: &mut Monomial) {
    while monomial.last() == Some(&0) {
        monomial.pop();
    }
}

/// The product of two monomials; `None` where an exponent would be beyond the largest [`Exponent`].
pub fn product(a: &Monomial, b: &Monomial) -> Option<Monomial> {
    let exponent = |m: &Monomial, i: usize| m.get(i).copied().unwrap_or(0);
    let sum = |i| exponent(a, i).checked_add(exponent(b, i));
    (0..a.len().max(b.len())).map(sum).collect()
}

/// a / b, if b divides a.
pub fn quotient(a: &Monomial, b: &Monomial) -> Option<Monomial> {
    if b.len() > a.len() {
        return None;
    }
    let mut result = a.clone();
    for (exponent, &divisor) in result.iter_mut().zip(b) {
        *exponent = exponent.checked_sub(divisor)?;
    }
    trim(&mut result);
    Some(result)
}

impl Add for &Polynomial {
    type Output = Polynomial;

    fn add(self, other: &Polynomial) -> Polynomial {
        let mut sum = self.clone();
        for (m, c) in &other.0 {
            sum.add_term(m.clone(), c.clone());
        }
        sum
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;

    fn neg(self) -> Polynomial {
        self.scaled(&integer(-1))
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;

    fn sub(self, other: &Polynomial) -> Polynomial {
        let mut difference = self.clone();
        for (m, c) in &other.0 {
            difference.add_term(m.clone(), -c);
        }
        difference
    }
}

/// For polynomials that a claim writes down: their powers are small. The engine, which meets any, asks for
/// [`times`](Polynomial::times).
impl Mul for &Polynomial {
    type Output = Polynomial;

    /// # Panics
    /// Where an exponent would be beyond the largest [`Exponent`]: a check in which that happens has failed.
    fn mul(self, other: &Polynomial) -> Polynomial {
        self.times(other).expect("exponents below 2^16")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn x() -> Polynomial {
        Polynomial::variable(0)
    }

    fn y() -> Polynomial {
        Polynomial::variable(1)
    }

    /// (2x - 3y)(x + y) + 5
    fn example() -> Polynomial {
        let two_x = x().scaled(&integer(2));
        let three_y = y().scaled(&integer(3));
        &(&(&two_x - &three_y) * &(&x() + &y())) + &Polynomial::constant(integer(5))
    }

    #[test]
    fn products_are_distributed_and_like_terms_collected() {
        let terms: Vec<(Monomial, BigRational)> =
            example().terms().map(|(m, c)| (m.clone(), c.clone())).collect();
        let expected = [(vec![], 5), (vec![0, 2], -3), (vec![1, 1], -1), (vec![2], 2)];
        assert_eq!(terms, expected.map(|(m, c)| (m, integer(c))));
    }

    #[test]
    fn a_difference_with_itself_is_zero() {
        assert!((&example() - &example()).is_zero());
        assert!((&example() + &-&example()).is_zero());
        assert!((&example() * &Polynomial::default()).is_zero());
        assert_eq!(Polynomial::default().as_constant(), Some(integer(0)));
    }

    #[test]
    fn values_agree_with_substitution_one_variable_at_a_time() {
        let at = [integer(7), integer(-2)];
        let value = example().at(&at);
        assert_eq!(value, integer((14 + 6) * 5 + 5));
        let by_steps = example().substituted(0, &at[0]).substituted(1, &at[1]);
        assert_eq!(by_steps.as_constant(), Some(value));
    }

    #[test]
    fn the_derivative_of_a_product_is_known() {
        // d/dx = 4x - y, d/dy = -x - 6y
        let dx = &x().scaled(&integer(4)) - &y();
        let dy = &-&x() - &y().scaled(&integer(6));
        assert_eq!(example().derivative(0), dx);
        assert_eq!(example().derivative(1), dy);
    }

    #[test]
    fn monic_divides_by_the_leading_coefficient() {
        let (monic, lead) = example().scaled(&integer(-3)).monic();
        assert_eq!(monic.scaled(&lead), example().scaled(&integer(-3)));
        assert_eq!(monic.monic().1, integer(1));
    }

    #[test]
    fn variables_are_those_that_occur() {
        assert_eq!(example().variables(), [0, 1]);
        assert_eq!((&y() * &y()).variables(), [1]);
    }

    #[test]
    fn quotients_exist_only_where_the_divisor_divides() {
        assert_eq!(quotient(&vec![2, 1], &vec![1, 1]), Some(vec![1]));
        assert_eq!(quotient(&vec![2], &vec![0, 1]), None);
        assert_eq!(quotient(&vec![1, 1], &vec![2]), None);
    }

    #[test]
    fn a_power_beyond_255_is_not_a_smaller_one() {
        let power = (0..257).fold(Polynomial::constant(integer(1)), |product, _| &product * &x());
        assert_eq!(power, Polynomial::term(vec![257], integer(1)));
        assert_ne!(power, x());
    }

    #[test]
    fn an_exponent_too_large_has_no_product() {
        let most = vec![Exponent::MAX];
        assert_eq!(product(&most, &vec![0, 1]), Some(vec![Exponent::MAX, 1]));
        assert_eq!(product(&most, &vec![1]), None);
        let power = Polynomial::term(most, integer(1));
        assert_eq!(power.times(&x()), None);
        assert_eq!(power.times(&y()), Some(Polynomial::term(vec![Exponent::MAX, 1], integer(1))));
    }

    #[test]
    fn text_has_one_term_per_monomial() {
        let p = &x().scaled(&(integer(-1) / integer(2))) + &(&(&x() * &y()) * &y());
        let names = ["a".to_owned(), "b".to_owned()];
        assert_eq!((&p + &Polynomial::constant(integer(3))).text(&names), "3 + -1/2 a + 1 a b^2");
        assert_eq!(Polynomial::default().text(&names), "0");
    }
}
