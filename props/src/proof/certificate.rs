//! Why a path is impossible: a sum of products that must be positive and yet is zero.
//!
//! A certificate is the identity
//!
//! ```text
//! sum_k c_k (product of facts > 0 or >= 0, and of squares)_k  +  sum_j q_j e_j  =  0
//! ```
//!
//! with weights c_k >= 0, facts e_j = 0, and c_k > 0 for at least one product of strict facts only (the empty product is
//! 1 > 0). Everything on the left is >= 0, one term is > 0, and the sum is zero: nothing satisfies the facts.
//!
//! Trusted: [`check`]. Where a certificate comes from does not matter.

use num_rational::BigRational;
use num_traits::{Signed, Zero};

use super::explorer::{Fact, Sense};
use super::polynomial::Polynomial;

/// weight * product of facts * product of squares
#[derive(Clone, Debug)]
pub struct Term {
    /// c_k
    pub weight: BigRational,
    /// The facts, by number.
    pub facts: Vec<usize>,
    /// What is squared.
    pub squares: Vec<Polynomial>,
}

/// The contradiction in the facts of a path.
#[derive(Clone, Debug, Default)]
pub struct Certificate {
    /// The products.
    pub terms: Vec<Term>,
    /// The multiples q_j of facts e_j = 0, by number.
    pub multiples: Vec<(Polynomial, usize)>,
}

/// Why a certificate proves nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It names a fact that the path doesn't have.
    NoSuchFact,
    /// A weight is negative.
    NegativeWeight,
    /// A product contains an equation.
    NotAnInequality,
    /// A multiple of something that isn't an equation: its sign is unknown.
    NotAnEquation,
    /// No product is strictly positive.
    NothingStrict,
    /// A product has a power that its exponents can't hold.
    PowerTooLarge,
    /// The sum is not zero.
    DoesNotCancel,
}

/// Accepts a certificate that shows that no point satisfies all `facts`.
///
/// # Errors
/// Why it doesn't show that.
pub fn check(facts: &[Fact], certificate: &Certificate) -> Result<(), Refusal> {
    let mut sum = Polynomial::default();
    let mut strict = false;
    for term in &certificate.terms {
        if term.weight.is_negative() {
            return Err(Refusal::NegativeWeight);
        }
        let mut product = Polynomial::constant(term.weight.clone());
        let mut positive = !term.weight.is_zero() && term.squares.is_empty();
        for &number in &term.facts {
            let fact = facts.get(number).ok_or(Refusal::NoSuchFact)?;
            if fact.sense == Sense::Zero {
                return Err(Refusal::NotAnInequality);
            }
            positive &= fact.sense == Sense::Positive;
            product = product.times(&fact.polynomial).ok_or(Refusal::PowerTooLarge)?;
        }
        for square in &term.squares {
            let once = product.times(square);
            product = once.and_then(|p| p.times(square)).ok_or(Refusal::PowerTooLarge)?;
        }
        strict |= positive;
        sum = &sum + &product;
    }
    for (multiplier, number) in &certificate.multiples {
        let fact = facts.get(*number).ok_or(Refusal::NoSuchFact)?;
        if fact.sense != Sense::Zero {
            return Err(Refusal::NotAnEquation);
        }
        let multiple = multiplier.times(&fact.polynomial).ok_or(Refusal::PowerTooLarge)?;
        sum = &sum + &multiple;
    }
    match (strict, sum.is_zero()) {
        (false, _) => Err(Refusal::NothingStrict),
        (true, false) => Err(Refusal::DoesNotCancel),
        (true, true) => Ok(()),
    }
}

impl Certificate {
    /// The most factors in one product.
    pub fn factors(&self) -> usize {
        self.terms.iter().map(|t| t.facts.len() + t.squares.len()).max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proof::polynomial::integer;

    impl Certificate {
        /// Adds weight * product of facts and squares.
        fn with(mut self, weight: i64, facts: &[usize], squares: &[Polynomial]) -> Certificate {
            let term =
                Term { weight: integer(weight), facts: facts.to_vec(), squares: squares.to_vec() };
            self.terms.push(term);
            self
        }
    }

    fn x() -> Polynomial {
        Polynomial::variable(0)
    }

    fn fact(polynomial: Polynomial, sense: Sense) -> Fact {
        Fact { polynomial, sense }
    }

    /// 0: x > 0, 1: -x >= 0, 2: -x > 0, 3: x^2 = 0, 4: -x^2 >= 0
    fn facts() -> Vec<Fact> {
        let square = &x() * &x();
        vec![
            fact(x(), Sense::Positive),
            fact(-&x(), Sense::Nonnegative),
            fact(-&x(), Sense::Positive),
            fact(square.clone(), Sense::Zero),
            fact(-&square, Sense::Nonnegative),
        ]
    }

    #[test]
    fn a_product_with_a_power_too_large_is_refused_and_not_searched() {
        let high = Polynomial::term(vec![40_000], integer(1));
        let positive = [fact(high.clone(), Sense::Positive), fact(-&x(), Sense::Positive)];
        let too_large = Err(Refusal::PowerTooLarge);
        for certificate in [
            Certificate::default().with(1, &[0, 0], &[]),
            Certificate::default().with(1, &[], std::slice::from_ref(&high)),
        ] {
            assert_eq!(check(&positive, &certificate), too_large);
        }
        let zero = [fact(high.clone(), Sense::Zero), fact(high.clone(), Sense::Positive)];
        let multiple = Certificate { terms: vec![], multiples: vec![(high, 0)] };
        assert_eq!(check(&zero, &multiple), too_large);
        assert!(crate::proof::search::search(&positive, 1, &[]).is_none());
    }

    fn verdict(certificate: &Certificate) -> Result<(), Refusal> {
        check(&facts(), certificate)
    }

    #[test]
    fn right_certificates_are_accepted() {
        let linear = Certificate::default().with(1, &[0], &[]).with(1, &[1], &[]);
        assert_eq!(verdict(&linear), Ok(()));
        let product = Certificate::default().with(1, &[0, 0], &[]).with(1, &[0, 1], &[]);
        assert_eq!(verdict(&product), Ok(()));
        let mut multiple = Certificate::default().with(1, &[0, 0], &[]);
        multiple.multiples.push((Polynomial::constant(integer(-1)), 3));
        assert_eq!(verdict(&multiple), Ok(()));
        // -x > 0, x^2 >= 0: (-x)(-x) - x^2 is not it, but 1 [x]^2 with the strict product (-x)(-x) and 2 (-x^2) is.
        let square = Certificate::default().with(1, &[2, 2], &[]).with(1, &[], &[x()]);
        assert_eq!(verdict(&square.with(2, &[4], &[])), Ok(()));
    }

    #[test]
    fn factors_are_facts_and_squares_of_the_longest_product() {
        let c = Certificate::default().with(1, &[0], &[]).with(1, &[2, 2], &[x()]);
        assert_eq!(c.factors(), 3);
    }

    #[test]
    fn what_proves_nothing_is_refused_for_its_reason() {
        let of = |weight, facts: &[usize], squares: &[Polynomial]| {
            Certificate::default().with(weight, facts, squares)
        };
        let multiple = |mut certificate: Certificate, by: Polynomial, fact| {
            certificate.multiples.push((by, fact));
            certificate
        };
        let minus_one = || Polynomial::constant(integer(-1));
        let square = &[x()];
        for (certificate, reason) in [
            (of(2, &[0], &[]).with(1, &[1], &[]), Refusal::DoesNotCancel),
            (of(1, &[], square).with(1, &[4], &[]), Refusal::NothingStrict),
            (Certificate::default(), Refusal::NothingStrict),
            // A square is not strict even beside a strict fact: x [x]^2 - x [x]^2 with 0: x > 0 and 1: -x >= 0.
            (of(1, &[0], square).with(1, &[1], square), Refusal::NothingStrict),
            // One weak fact in a product.
            (of(1, &[0, 1], &[]).with(1, &[], square), Refusal::NothingStrict),
            (of(0, &[0], &[]), Refusal::NothingStrict),
            (of(1, &[0], &[]).with(-1, &[0], &[]), Refusal::NegativeWeight),
            (multiple(of(1, &[0], &[]), minus_one(), 0), Refusal::NotAnEquation),
            (of(1, &[0, 0], &[]).with(1, &[3], &[]), Refusal::NotAnInequality),
            (of(1, &[9], &[]), Refusal::NoSuchFact),
            (multiple(of(1, &[], square), x(), 9), Refusal::NoSuchFact),
        ] {
            assert_eq!(verdict(&certificate), Err(reason), "{certificate:?}");
        }
    }
}
