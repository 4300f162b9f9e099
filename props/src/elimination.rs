//! Symmetric matrices of exact rational numbers: how many eigenvalues are positive, zero and negative (Sylvester's law of
//! inertia), and linear systems. The matrix is scaled to whole numbers and eliminated without fractions (Bareiss): after k
//! pivots each entry is a minor of order k + 1, so the divisions leave no rest and the numbers stay short.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use crate::numbers::Exact;

/// A square matrix, row by row.
pub type Matrix = Vec<Vec<Exact>>;

/// How many eigenvalues of a symmetric matrix have which sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inertia {
    /// Positive ones.
    pub positive: usize,
    /// Zeros.
    pub zero: usize,
    /// Negative ones.
    pub negative: usize,
}

/// alpha a + beta b
pub fn combined(alpha: Exact, a: &Matrix, beta: Exact, b: &Matrix) -> Matrix {
    let row = |(a, b): (&Vec<Exact>, &Vec<Exact>)| {
        a.iter().zip(b).map(|(&a, &b)| alpha * a + beta * b).collect()
    };
    a.iter().zip(b).map(row).collect()
}

/// x . y
pub fn dot(x: &[Exact], y: &[Exact]) -> Exact {
    x.iter().zip(y).fold(Exact::from(0), |sum, (&x, &y)| sum + x * y)
}

/// x . matrix x
pub fn square(matrix: &Matrix, x: &[Exact]) -> Exact {
    matrix.iter().zip(x).fold(Exact::from(0), |sum, (row, &x_i)| sum + x_i * dot(row, x))
}

/// The rows times one number that makes all entries whole, and that number.
fn whole(rows: &[Vec<Exact>]) -> (Vec<Vec<BigInt>>, BigInt) {
    let values: Vec<Vec<BigRational>> =
        rows.iter().map(|row| row.iter().map(|x| x.value()).collect()).collect();
    // x.denom() / scale in lowest terms has the factors that the scale lacks on top.
    let scale = values.iter().flatten().fold(BigInt::one(), |scale, x| {
        let lacking = BigRational::new(x.denom().clone(), scale.clone()).numer().clone();
        scale * lacking
    });
    let scaled = |x: &BigRational| x.numer() * (&scale / x.denom());
    (values.iter().map(|row| row.iter().map(scaled).collect()).collect(), scale)
}

/// Eliminates below the pivot `k`; `previous` is the pivot before it. Columns beyond the square are right sides.
fn eliminate(rows: &mut [Vec<BigInt>], k: usize, previous: &BigInt) {
    let (above, below) = rows.split_at_mut(k + 1);
    let pivot = &above[k];
    for row in below {
        let factor = row[k].clone();
        for (entry, p) in row.iter_mut().zip(pivot).skip(k) {
            *entry = (&pivot[k] * &*entry - &factor * p) / previous;
        }
    }
}

/// The inertia of a symmetric matrix.
pub fn inertia(matrix: &Matrix) -> Inertia {
    let (mut rows, _) = whole(matrix);
    let n = rows.len();
    let mut counts = Inertia { positive: 0, zero: 0, negative: 0 };
    let mut previous = BigInt::one();
    for k in 0..n {
        if (k..n).all(|i| rows[i][i].is_zero()) {
            // Row and column j added to row and column i: congruent, with 2 m_ij on the diagonal.
            let pairs = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
            let Some((i, j)) = pairs.into_iter().find(|&(i, j)| !rows[i][j].is_zero()) else {
                counts.zero = n - k;
                return counts;
            };
            for c in 0..n {
                let added = rows[j][c].clone();
                rows[i][c] += added;
            }
            for row in &mut rows {
                let added = row[j].clone();
                row[i] += added;
            }
        }
        let Some(pivot) = (k..n).find(|&i| !rows[i][i].is_zero()) else { continue };
        rows.swap(k, pivot);
        rows.iter_mut().for_each(|row| row.swap(k, pivot));
        match rows[k][k].is_positive() == previous.is_positive() {
            true => counts.positive += 1,
            false => counts.negative += 1,
        }
        eliminate(&mut rows, k, &previous);
        previous = rows[k][k].clone();
    }
    counts
}

/// matrix^-1 right, if the symmetric matrix is positive definite: each pivot is positive.
pub fn solve_definite(matrix: &Matrix, right: &[Exact]) -> Option<Vec<Exact>> {
    let (mut rows, scale) = whole(matrix);
    let (sides, side_scale) = whole(&[right.to_vec()]);
    for (row, side) in rows.iter_mut().zip(&sides[0]) {
        row.push(side.clone());
    }
    let n = rows.len();
    let mut previous = BigInt::one();
    for k in 0..n {
        if !rows[k][k].is_positive() {
            return None;
        }
        eliminate(&mut rows, k, &previous);
        previous = rows[k][k].clone();
    }
    // By Cramer's rule the determinant times the solution is whole.
    let mut solution = vec![BigInt::zero(); n];
    for i in (0..n).rev() {
        let known = (i + 1..n).fold(BigInt::zero(), |sum, j| sum + &rows[i][j] * &solution[j]);
        solution[i] = (&previous * &rows[i][n] - known) / &rows[i][i];
    }
    let denominator = previous * side_scale;
    let back = |x: BigInt| Exact::new(BigRational::new(x * &scale, denominator.clone()));
    Some(solution.into_iter().map(back).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: &[&[i64]]) -> Matrix {
        rows.iter().map(|row| row.iter().map(|&x| Exact::ratio(x, 6)).collect()).collect()
    }

    fn counts(rows: &[&[i64]]) -> [usize; 3] {
        let Inertia { positive, zero, negative } = inertia(&matrix(rows));
        [positive, zero, negative]
    }

    #[test]
    fn inertia_counts_signs_with_zeros_on_the_diagonal_too() {
        Exact::scope(|| {
            assert_eq!(counts(&[&[2, 1], &[1, 2]]), [2, 0, 0]);
            assert_eq!(counts(&[&[1, 2], &[2, 1]]), [1, 0, 1]);
            assert_eq!(counts(&[&[1, 1], &[1, 1]]), [1, 1, 0]);
            assert_eq!(counts(&[&[0, 1], &[1, 0]]), [1, 0, 1]);
            assert_eq!(counts(&[&[0, 0], &[0, 0]]), [0, 2, 0]);
            assert_eq!(counts(&[&[0, 0, 3], &[0, -5, 0], &[3, 0, 0]]), [1, 0, 2]);
            // Eigenvectors (1, 1, 1, 1), (1, -1, 1, -1), (1, 1, -1, -1), (1, -1, -1, 1): -2, -6, 8, 0.
            let turned: &[&[i64]] =
                &[&[0, 3, -4, -1], &[3, 0, -1, -4], &[-4, -1, 0, 3], &[-1, -4, 3, 0]];
            assert_eq!(counts(turned), [1, 1, 2]);
        });
    }

    #[test]
    fn solutions_solve_and_an_indefinite_matrix_is_refused() {
        Exact::scope(|| {
            let a = matrix(&[&[4, 1, 0], &[1, 3, -1], &[0, -1, 2]]);
            let x = [Exact::ratio(1, 7), Exact::ratio(-2, 3), Exact::from(5)];
            let right: Vec<Exact> = a.iter().map(|row| dot(row, &x)).collect();
            assert_eq!(solve_definite(&a, &right), Some(x.to_vec()));
            assert_eq!(square(&a, &x), dot(&x, &right));
            for refused in [&[&[1_i64, 2][..], &[2, 1]], &[&[1, 1], &[1, 1]]] {
                assert_eq!(solve_definite(&matrix(refused), &right[..2]), None);
            }
        });
    }
}
