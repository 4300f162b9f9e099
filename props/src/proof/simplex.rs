//! A point x >= 0 with A x = b, in exact rational arithmetic: phase one of the simplex method on sparse rows.
//!
//! Not trusted: what it finds is checked.

use std::collections::{BTreeMap, BTreeSet};

use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// A sparse row: column -> entry, none of them zero.
pub(super) type Row = BTreeMap<usize, BigRational>;

/// Dantzig's rule so long, then Bland's, which can't cycle.
const IMPATIENT_AFTER: usize = 200;
const GIVE_UP_AFTER: usize = 3000;

/// row += factor * other
pub(super) fn add_multiple(row: &mut Row, factor: &BigRational, other: &Row) {
    for (&column, entry) in other {
        let sum = row.entry(column).or_insert_with(BigRational::zero);
        *sum = rational::sum(sum, &rational::product(factor, entry));
        if sum.is_zero() {
            row.remove(&column);
        }
    }
}

struct Tableau {
    rows: Vec<Row>,
    right: Vec<BigRational>,
    /// The column that is basic in each row, if it isn't the row's artificial one.
    basis: Vec<Option<usize>>,
}

/// A nonnegative solution of rows x = right, as column -> value; `right` must not be negative.
pub(super) fn solve(rows: Vec<Row>, right: Vec<BigRational>) -> Option<Row> {
    let basis = vec![None; rows.len()];
    let mut tableau = Tableau { rows, right, basis };
    for step in 0..GIVE_UP_AFTER {
        if tableau.feasible() {
            return Some(tableau.solution());
        }
        let column = tableau.entering(step > IMPATIENT_AFTER)?;
        let row = tableau.leaving(column)?;
        tableau.pivot(row, column);
    }
    None
}

impl Tableau {
    fn feasible(&self) -> bool {
        let artificial = |i: &usize| self.basis[*i].is_none();
        (0..self.rows.len()).filter(artificial).all(|i| self.right[i].is_zero())
    }

    /// A column that lessens the sum of the artificial variables.
    fn entering(&self, first: bool) -> Option<usize> {
        let mut gain = Row::new();
        for (row, basis) in self.rows.iter().zip(&self.basis) {
            if basis.is_none() {
                add_multiple(&mut gain, &BigRational::from_integer(1.into()), row);
            }
        }
        let basic: BTreeSet<usize> = self.basis.iter().flatten().copied().collect();
        let mut candidates =
            gain.into_iter().filter(|(column, g)| g.is_positive() && !basic.contains(column));
        if first {
            candidates.next().map(|(column, _)| column)
        } else {
            candidates.max_by(|a, b| a.1.cmp(&b.1).then(b.0.cmp(&a.0))).map(|(column, _)| column)
        }
    }

    fn leaving(&self, column: usize) -> Option<usize> {
        let ratio = |i: usize| {
            let entry = self.rows[i].get(&column)?;
            entry.is_positive().then(|| &self.right[i] / entry)
        };
        (0..self.rows.len())
            .filter_map(|i| ratio(i).map(|r| (i, r)))
            .min_by(|a, b| a.1.cmp(&b.1).then(self.basis[a.0].cmp(&self.basis[b.0])))
            .map(|(i, _)| i)
    }

    fn pivot(&mut self, row: usize, column: usize) {
        let inverse = self.rows[row][&column].recip();
        for entry in self.rows[row].values_mut() {
            *entry *= &inverse;
        }
        self.right[row] *= &inverse;
        let (pivot, right) = (self.rows[row].clone(), self.right[row].clone());
        for i in (0..self.rows.len()).filter(|&i| i != row) {
            if let Some(factor) = self.rows[i].get(&column).map(|entry| -entry) {
                add_multiple(&mut self.rows[i], &factor, &pivot);
                self.right[i] += &factor * &right;
            }
        }
        self.basis[row] = Some(column);
    }

    fn solution(&self) -> Row {
        let values = self.basis.iter().zip(&self.right);
        values.filter(|(_, v)| !v.is_zero()).filter_map(|(b, v)| Some(((*b)?, v.clone()))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proof::polynomial::integer;

    fn row(entries: &[(usize, i64)]) -> Row {
        entries.iter().map(|&(column, entry)| (column, integer(entry))).collect()
    }

    #[test]
    fn a_feasible_system_is_solved() {
        // x + y = 1, x - 2y = 0
        let rows = vec![row(&[(0, 1), (1, 1)]), row(&[(0, 1), (1, -2)])];
        let solution = solve(rows, vec![integer(1), integer(0)]).unwrap();
        assert_eq!(solution[&0], integer(2) / integer(3));
        assert_eq!(solution[&1], integer(1) / integer(3));
    }

    #[test]
    fn an_infeasible_system_is_not() {
        // x + y = 1, x + 2y = 0
        let rows = vec![row(&[(0, 1), (1, 1)]), row(&[(0, 1), (1, 2)])];
        assert_eq!(solve(rows, vec![integer(1), integer(0)]), None);
    }
}
