//! Finds certificates: products of facts and squares up to a degree are columns of a linear program whose rows are the
//! monomials, and multiples of equations are columns without a sign.
//!
//! Not trusted: [`check`](super::certificate::check) has the last word.

use std::collections::{BTreeMap, BTreeSet};

use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use super::certificate::{Certificate, Term};
use super::explorer::{Fact, Sense};
use super::polynomial::{Monomial, Polynomial, product, quotient};
use super::simplex::{self, Row, add_multiple};

/// So many multipliers of equations at most.
const MOST_MULTIPLIERS: usize = 300;
/// So many products at most.
const MOST_PRODUCTS: usize = 1500;

/// A factor of a product: a fact or the square of a polynomial.
enum Factor<'a> {
    Fact(usize, &'a Fact),
    Square(&'a Polynomial),
}

struct Product {
    facts: Vec<usize>,
    squares: Vec<Polynomial>,
    value: Polynomial,
    strict: bool,
}

/// A certificate for the facts of a path with so many variables, if one of the attempts finds it: products of one, two
/// and three facts; with the squares of `hints` or, where there are none, of the derivatives of the facts ("complete the
/// square") and of the variables.
pub fn search(facts: &[Fact], variables: usize, hints: &[Polynomial]) -> Option<Certificate> {
    let squares = if hints.is_empty() { derivatives(facts, variables) } else { hints.to_vec() };
    let plain: Vec<Polynomial> = (0..variables).map(Polynomial::variable).collect();
    let attempts: [(usize, &[Polynomial]); 7] = [
        (1, &[]),
        (2, &[]),
        (2, &squares),
        (2, &plain),
        (3, &[]),
        (3, if hints.is_empty() { &[] } else { &squares }),
        (3, &plain),
    ];
    attempts.into_iter().find_map(|(degree, squares)| attempt(facts, degree, squares))
}

/// The derivatives of the facts that are no constants, each once up to a factor.
fn derivatives(facts: &[Fact], variables: usize) -> Vec<Polynomial> {
    let mut seen = BTreeSet::new();
    for fact in facts {
        for i in 0..variables {
            let derivative = fact.polynomial.derivative(i);
            if derivative.as_constant().is_none() {
                seen.insert(derivative.monic().0);
            }
        }
    }
    seen.into_iter().collect()
}

fn attempt(facts: &[Fact], degree: usize, squares: &[Polynomial]) -> Option<Certificate> {
    let products = products(facts, degree, squares)?;
    let equations: Vec<(usize, &Polynomial)> = facts
        .iter()
        .enumerate()
        .filter(|(_, fact)| fact.sense == Sense::Zero)
        .map(|(i, fact)| (i, &fact.polynomial))
        .collect();
    let multipliers = multipliers(&products, &equations);
    let rows = rows(&products, &equations, &multipliers)?;
    let (weights, free) = weights(rows, &products)?;
    let terms = products
        .iter()
        .enumerate()
        .filter_map(|(k, p)| {
            let weight = weights.get(&k)?.clone();
            Some(Term { weight, facts: p.facts.clone(), squares: p.squares.clone() })
        })
        .collect();
    let multiples = free
        .into_iter()
        .map(|(column, value)| {
            let (monomial, j) = &multipliers[column - products.len()];
            (Polynomial::term(monomial.clone(), value), equations[*j].0)
        })
        .collect();
    Some(Certificate { terms, multiples })
}

/// All products of at most `degree` factors; nothing if there are too many, or one has a power too large.
fn products(facts: &[Fact], degree: usize, squares: &[Polynomial]) -> Option<Vec<Product>> {
    let inequalities = facts.iter().enumerate().filter(|(_, f)| f.sense != Sense::Zero);
    let mut factors: Vec<Factor<'_>> = inequalities.map(|(i, f)| Factor::Fact(i, f)).collect();
    factors.extend(squares.iter().map(Factor::Square));
    let one = Polynomial::constant(BigRational::one());
    let mut all = vec![Product { facts: vec![], squares: vec![], value: one, strict: true }];
    // The products of one factor more than the last ones, each with the first factor that may follow.
    let mut last = vec![(0, 0)];
    for _ in 0..degree {
        let mut longer = Vec::new();
        for &(of, from) in &last {
            for (i, factor) in factors.iter().enumerate().skip(from) {
                longer.push((all.len(), i));
                all.push(all[of].times(factor)?);
                if all.len() > MOST_PRODUCTS {
                    return None;
                }
            }
        }
        last = longer;
    }
    Some(all)
}

impl Product {
    fn times(&self, factor: &Factor<'_>) -> Option<Product> {
        let (mut facts, mut squares) = (self.facts.clone(), self.squares.clone());
        match factor {
            Factor::Fact(i, fact) => {
                facts.push(*i);
                let strict = self.strict && fact.sense == Sense::Positive;
                let value = self.value.times(&fact.polynomial)?;
                Some(Product { facts, squares, value, strict })
            }
            Factor::Square(root) => {
                squares.push((*root).clone());
                let value = self.value.times(root)?.times(root)?;
                Some(Product { facts, squares, value, strict: false })
            }
        }
    }
}

/// Monomials to multiply equations with: those that can cancel a monomial of a product, or of such a multiple.
fn multipliers(products: &[Product], equations: &[(usize, &Polynomial)]) -> Vec<(Monomial, usize)> {
    let mut targets: BTreeSet<Monomial> =
        products.iter().flat_map(|p| p.value.terms().map(|(m, _)| m.clone())).collect();
    let mut found: BTreeSet<(Monomial, usize)> = BTreeSet::new();
    for _ in 0..2 {
        let mut new_targets = BTreeSet::new();
        for (j, (_, equation)) in equations.iter().enumerate() {
            for target in &targets {
                for (monomial, _) in equation.terms() {
                    let Some(multiplier) = quotient(target, monomial) else { continue };
                    if found.len() >= MOST_MULTIPLIERS {
                        return found.into_iter().collect();
                    }
                    let multiple: Option<Vec<Monomial>> =
                        equation.terms().map(|(m, _)| product(m, &multiplier)).collect();
                    if let Some(multiple) = multiple {
                        new_targets.extend(multiple);
                        found.insert((multiplier, j));
                    }
                }
            }
        }
        targets = new_targets;
    }
    found.into_iter().collect()
}

/// One row per monomial; the products are the first columns, the multiples of equations follow. Nothing if a multiple has a
/// power too large.
fn rows(
    products: &[Product],
    equations: &[(usize, &Polynomial)],
    multipliers: &[(Monomial, usize)],
) -> Option<Vec<Row>> {
    let mut rows: BTreeMap<Monomial, Row> = BTreeMap::new();
    for (column, product) in products.iter().enumerate() {
        for (monomial, coefficient) in product.value.terms() {
            rows.entry(monomial.clone()).or_default().insert(column, coefficient.clone());
        }
    }
    for (i, (multiplier, j)) in multipliers.iter().enumerate() {
        for (monomial, coefficient) in equations[*j].1.terms() {
            let row = rows.entry(product(monomial, multiplier)?).or_default();
            row.insert(products.len() + i, coefficient.clone());
        }
    }
    Some(rows.into_values().collect())
}

/// Weights of the products (not negative, the strict ones adding up to 1) and of the other columns that satisfy the
/// rows.
fn weights(mut rows: Vec<Row>, products: &[Product]) -> Option<(Row, Row)> {
    drop_impossible(&mut rows, products.len());
    let possible: BTreeSet<usize> = rows.iter().flat_map(|row| row.keys().copied()).collect();
    let strict = possible.into_iter().filter(|&c| products.get(c).is_some_and(|p| p.strict));
    let norm: Row = strict.map(|column| (column, BigRational::one())).collect();
    let pivots = eliminate_free(&mut rows, products.len());
    let mut right = vec![BigRational::zero(); rows.len()];
    rows.push(norm);
    right.push(BigRational::one());
    let weights = simplex::solve(rows, right)?;
    Some((weights.clone(), free_values(&pivots, weights)))
}

/// A monomial that only products with coefficients of one sign have forbids all these products.
fn drop_impossible(rows: &mut Vec<Row>, products: usize) {
    loop {
        let forbidden: BTreeSet<usize> = rows
            .iter()
            .filter(|row| {
                let positive = row.values().filter(|c| c.is_positive()).count();
                row.keys().all(|&c| c < products) && (positive == 0 || positive == row.len())
            })
            .flat_map(|row| row.keys().copied())
            .collect();
        if forbidden.is_empty() {
            return;
        }
        for row in rows.iter_mut() {
            row.retain(|column, _| !forbidden.contains(column));
        }
        rows.retain(|row| !row.is_empty());
    }
}

/// Gauss elimination of the columns without a sign: the rows used for it, in order, each with its column.
fn eliminate_free(rows: &mut Vec<Row>, products: usize) -> Vec<(usize, Row)> {
    let free: BTreeSet<usize> =
        rows.iter().flat_map(|row| row.range(products..).map(|(&c, _)| c)).collect();
    let mut pivots = Vec::new();
    for column in free {
        let with = (0..rows.len()).filter(|&i| rows[i].contains_key(&column));
        let Some(shortest) = with.min_by_key(|&i| rows[i].len()) else { continue };
        let pivot = rows.swap_remove(shortest);
        let inverse = pivot[&column].recip();
        for row in rows.iter_mut() {
            if let Some(factor) = row.get(&column).map(|entry| -entry * &inverse) {
                add_multiple(row, &factor, &pivot);
            }
        }
        rows.retain(|row| !row.is_empty());
        pivots.push((column, pivot));
    }
    pivots
}

fn free_values(pivots: &[(usize, Row)], mut values: Row) -> Row {
    let mut free = Row::new();
    for (column, row) in pivots.iter().rev() {
        let mut sum = BigRational::zero();
        for (other, entry) in row.iter().filter(|(other, _)| *other != column) {
            if let Some(value) = values.get(other) {
                sum += entry * value;
            }
        }
        let value = -sum / &row[column];
        if !value.is_zero() {
            values.insert(*column, value.clone());
            free.insert(*column, value);
        }
    }
    free
}
