//! H = L D L^T in [twofold](crate::fem::twofold) numbers, L with ones on its diagonal, D diagonal: row by row, each row of L
//! from a triangular system with the rows before it, whose pattern is read off the elimination tree (Davis, *Direct methods
//! for sparse linear systems*, 4.7).

use super::factor::{Indefinite, upper_triangle};
use crate::fem::matrix::LowerTriangle;
use crate::fem::twofold::Twofold;

/// L and D, L column by column without its diagonal.
pub struct TwofoldFactor {
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<Twofold>,
    diagonal: Vec<Twofold>,
}

/// Which entries L has.
struct Tree {
    /// The first row below the diagonal of each column.
    parents: Vec<Option<usize>>,
    /// Where each column starts, and where the last one ends.
    starts: Vec<usize>,
}

impl Tree {
    /// The structure of a matrix whose upper triangle has these entries, column by column.
    fn new(starts: &[usize], rows: &[usize]) -> Self {
        let n = starts.len() - 1;
        let mut tree = Tree { parents: vec![None; n], starts: vec![0; n + 1] };
        let mut seen: Vec<usize> = (0..n).collect();
        for k in 0..n {
            seen[k] = k;
            for &row in &rows[starts[k]..starts[k + 1]] {
                let mut column = row;
                while seen[column] != k {
                    tree.starts[column + 1] += 1;
                    seen[column] = k;
                    column = *tree.parents[column].get_or_insert(k);
                }
            }
        }
        for k in 0..n {
            tree.starts[k + 1] += tree.starts[k];
        }
        tree
    }
}

impl TwofoldFactor {
    /// The factor of a matrix.
    ///
    /// # Errors
    /// [`Indefinite`] if a pivot is not positive.
    pub fn new(matrix: &LowerTriangle<Twofold>) -> Result<Self, Indefinite> {
        let zero = Twofold::from(0);
        let (upper, columns, places) = upper_triangle(matrix);
        let n = upper.len() - 1;
        let Tree { parents, starts } = Tree::new(&upper, &columns);
        let mut rows = vec![0; starts[n]];
        let mut values = vec![zero; starts[n]];
        let mut diagonal = vec![zero; n];
        let mut ends = starts.clone();
        let mut seen: Vec<usize> = (0..n).collect();
        // The row at work, dense; its columns in the order in which the tree reaches them, each path the wrong way round.
        let mut row = vec![zero; n];
        let mut reached = Vec::new();
        let mut path = Vec::new();
        for k in 0..n {
            seen[k] = k;
            for p in upper[k]..upper[k + 1] {
                let mut column = columns[p];
                row[column] = matrix.values[places[p]];
                while seen[column] != k {
                    path.push(column);
                    seen[column] = k;
                    let Some(parent) = parents[column] else { break };
                    column = parent;
                }
                reached.extend(path.drain(..).rev());
            }
            let mut pivot = std::mem::replace(&mut row[k], zero);
            // The last path found comes first: a path ends where one before it passes.
            for column in reached.drain(..).rev() {
                let entry = std::mem::replace(&mut row[column], zero);
                for p in starts[column]..ends[column] {
                    row[rows[p]] -= values[p] * entry;
                }
                let l = entry / diagonal[column];
                pivot -= l * entry;
                (rows[ends[column]], values[ends[column]]) = (k, l);
                ends[column] += 1;
            }
            if !(pivot.head() > 0.0) {
                return Err(Indefinite);
            }
            diagonal[k] = pivot;
        }
        Ok(TwofoldFactor { starts, rows, values, diagonal })
    }

    /// x <- H^-1 x, rounded to doubles at the end.
    pub fn solve(&self, x: &mut [f64]) {
        let mut y: Vec<Twofold> = x.iter().map(|&x| x.into()).collect();
        for k in 0..y.len() {
            for p in self.starts[k]..self.starts[k + 1] {
                y[self.rows[p]] = y[self.rows[p]] - self.values[p] * y[k];
            }
        }
        for k in (0..y.len()).rev() {
            y[k] /= self.diagonal[k];
            for p in self.starts[k]..self.starts[k + 1] {
                y[k] = y[k] - self.values[p] * y[self.rows[p]];
            }
        }
        x.iter_mut().zip(y).for_each(|(x, y)| *x = y.head());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lower triangle of a dense matrix, entries of zero left out.
    fn sparse(dense: &[Vec<f64>]) -> LowerTriangle<Twofold> {
        let n = dense.len();
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in 0..n {
            for row in column..n {
                if row == column || dense[row][column] != 0.0 {
                    rows.push(row);
                    values.push(Twofold::from(dense[row][column]));
                }
            }
            starts.push(rows.len());
        }
        LowerTriangle { starts, rows, values }
    }

    /// K K^T + e with K the second differences: a condition number of n^8 / e or so.
    fn ill_conditioned(n: usize, e: f64) -> Vec<Vec<f64>> {
        let k = |i: usize, j: usize| match i.abs_diff(j) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        };
        let entry =
            |i, j| (0..n).map(|l| k(i, l) * k(l, j)).sum::<f64>() + if i == j { e } else { 0.0 };
        (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
    }

    #[test]
    fn solutions_are_right_where_the_condition_number_is_beyond_doubles() {
        // Powers of two: e is in the matrix exactly.
        let (n, e) = (40, 2.0_f64.powi(-49));
        let dense = ill_conditioned(n, e);
        let factor = TwofoldFactor::new(&sparse(&dense)).unwrap();
        let x: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
        let mut y: Vec<f64> = Vec::new();
        for row in &dense {
            let sum = row
                .iter()
                .zip(&x)
                .fold(Twofold::from(0), |sum, (&a, &x)| sum + Twofold::product(a, x));
            y.push(sum.head());
        }
        factor.solve(&mut y);
        // The right-hand side is rounded: the condition number of K K^T, about 4e5, is left of it.
        for (y, x) in y.iter().zip(&x) {
            assert!((y - x).abs() < 1e-9, "{y} {x}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_definite_has_no_factor() {
        assert!(TwofoldFactor::new(&sparse(&[vec![1.0, 2.0], vec![2.0, 4.0]])).is_err());
        assert!(TwofoldFactor::new(&sparse(&[vec![1.0, 2.0], vec![2.0, 4.000001]])).is_ok());
        assert!(TwofoldFactor::new(&sparse(&[vec![f64::NAN]])).is_err());
    }
}
