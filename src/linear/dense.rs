//! Singular values and projections for few columns, as accurate as their data: a part of the body has three rigid motions. faer
//! has both, at seven seconds of compiling (bidiagonal forms, divide and conquer, QR), a twentieth of a release build.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};

use crate::solve::SolveError;

/// The lower triangle of a matrix becomes its Cholesky factor, by faer.
///
/// # Errors
/// [`SolveError::NotPositiveDefinite`], as far as doubles tell, and [`SolveError::OutOfMemory`].
pub(crate) fn cholesky(matrix: MatMut<'_, f64>) -> Result<(), SolveError> {
    let scratch = cholesky_in_place_scratch::<f64>(matrix.nrows(), Par::Seq, Default::default());
    let out_of_memory = SolveError::OutOfMemory { bytes: scratch.size_bytes() as u64 };
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| out_of_memory)?;
    let stack = MemStack::new(&mut memory);
    cholesky_in_place(matrix, Default::default(), Par::Seq, stack, Default::default())
        .map(|_| ())
        .map_err(|_| SolveError::NotPositiveDefinite)
}

/// The lower triangle of a matrix becomes its Cholesky factor, of which the `leading` block is given: the matrix is not read there.
///
/// # Errors
/// As [`cholesky`].
pub(crate) fn extend_cholesky(
    matrix: MatMut<'_, f64>,
    leading: MatRef<'_, f64>,
) -> Result<(), SolveError> {
    let kept = leading.nrows();
    let (mut top, _, mut below, mut rest) = matrix.split_at_mut(kept, kept);
    top.copy_from_triangular_lower(leading);
    if rest.nrows() == 0 {
        return Ok(());
    }
    if kept > 0 {
        solve_lower_triangular_in_place(leading, below.rb_mut().transpose_mut(), Par::Seq);
        triangular::matmul(
            rest.rb_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            below.rb(),
            BlockStructure::Rectangular,
            below.rb().transpose(),
            BlockStructure::Rectangular,
            -1.0,
            Par::Seq,
        );
    }
    cholesky(rest)
}

/// The lower triangle of a symmetric matrix whose leading block of this size is positive definite, and whose Schur complement is
/// negative definite, becomes L of L diag(I, -I) L^T.
///
/// # Errors
/// As [`cholesky`], where a block is not definite.
pub(crate) fn quasidefinite(
    mut matrix: MatMut<'_, f64>,
    positive: usize,
) -> Result<(), SolveError> {
    let (mut leading, _, mut below, mut rest) = matrix.rb_mut().split_at_mut(positive, positive);
    cholesky(leading.rb_mut())?;
    if rest.nrows() == 0 {
        return Ok(());
    }
    solve_lower_triangular_in_place(leading.rb(), below.rb_mut().transpose_mut(), Par::Seq);
    // L L^T of the rest is its negative with the square of what is below added.
    let square = below.rb() * below.rb().transpose();
    for j in 0..rest.ncols() {
        for i in j..rest.nrows() {
            rest[(i, j)] = square[(i, j)] - rest[(i, j)];
        }
    }
    cholesky(rest)
}

/// The sum of the products of two lists.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The Euclidean norm of a list.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// The sum of the products of two fields or functionals.
pub(crate) fn inner(f: &[[f64; 2]], u: &[[f64; 2]]) -> f64 {
    f.iter().zip(u).map(|(f, u)| f[0] * u[0] + f[1] * u[1]).sum()
}

/// The largest number of sweeps over all pairs of columns; six to ten suffice.
const MOST_SWEEPS: usize = 40;

/// The singular values of the matrix with these rows of `n` entries, the largest first, each with its right singular vector, by
/// Jacobi's rotations of the columns (Hestenes): a rotation makes two of them orthogonal, and where all are, their lengths are
/// the values. Small ones keep their digits beside large ones. There are as many as columns, zeros among them.
pub(crate) fn singular_vectors(rows: &[Vec<f64>], n: usize) -> Vec<(f64, Vec<f64>)> {
    let mut columns: Vec<Vec<f64>> =
        (0..n).map(|j| rows.iter().map(|row| row[j]).collect()).collect();
    let unit = |j: usize| (0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
    let mut vectors: Vec<Vec<f64>> = (0..n).map(unit).collect();
    for _ in 0..MOST_SWEEPS {
        let mut orthogonal = true;
        for (p, q) in (0..n).flat_map(|q| (0..q).map(move |p| (p, q))) {
            let [pp, qq, pq] = [(p, p), (q, q), (p, q)].map(|(i, j)| dot(&columns[i], &columns[j]));
            if !(pq.abs() > f64::EPSILON * (pp.sqrt() * qq.sqrt())) {
                continue;
            }
            orthogonal = false;
            // The smaller root of t^2 + 2 zeta t - 1 = 0 is the tangent of the angle.
            let zeta = (qq - pp) / (2.0 * pq);
            let t = 1.0_f64.copysign(zeta) / (zeta.abs() + zeta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            for matrix in [&mut columns, &mut vectors] {
                let (before, from_q) = matrix.split_at_mut(q);
                rotate(&mut before[p], &mut from_q[0], c, c * t);
            }
        }
        if orthogonal {
            break;
        }
    }
    let values = columns.iter().map(|column| norm(column));
    let mut pairs: Vec<(f64, Vec<f64>)> = values.zip(vectors).collect();
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    pairs
}

/// (p, q) <- (c p - s q, s p + c q)
fn rotate(p: &mut [f64], q: &mut [f64], c: f64, s: f64) {
    for (p, q) in p.iter_mut().zip(q) {
        (*p, *q) = (c * *p - s * *q, s * *p + c * *q);
    }
}

/// The weights of independent columns whose combination is nearest to `target`, by the modified method of Gram and Schmidt
/// with the target as one more column (Bjorck 1967: as stable as Householder's reflections). Not finite if a column is zero.
pub(crate) fn least_squares(mut columns: Vec<Vec<f64>>, target: &[f64]) -> Vec<f64> {
    let n = columns.len();
    columns.push(target.to_vec());
    // r[k][j]: what column j has of the k-th direction, in units of its length; in the end that of the target.
    let mut r = vec![vec![0.0; n + 1]; n];
    for k in 0..n {
        let (direction, later) =
            columns[k..].split_first_mut().map_or((&[][..], &mut [][..]), |(d, l)| (&**d, l));
        let squared = dot(direction, direction);
        for (j, other) in later.iter_mut().enumerate() {
            let share = dot(direction, other) / squared;
            r[k][k + 1 + j] = share;
            for (o, d) in other.iter_mut().zip(direction) {
                *o -= share * d;
            }
        }
    }
    let mut weights = vec![0.0; n];
    for k in (0..n).rev() {
        weights[k] = r[k][n] - (k + 1..n).map(|j| r[k][j] * weights[j]).sum::<f64>();
    }
    weights
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;
    use faer::Mat;

    use super::*;

    /// The Cholesky factor of a matrix of this size, or `None`: by extension if one of the `leading` block is given.
    fn factor(n: usize, leading: Option<&Mat<f64>>) -> Option<Mat<f64>> {
        let sum = |i: usize, j: usize| 1.0 / (1.0 + i as f64 + j as f64);
        let mut matrix =
            Mat::from_fn(n, n, |i, j| sum(i, j) + f64::from(u8::from(i == j)) * (1.0 + i as f64));
        match leading {
            Some(leading) => extend_cholesky(matrix.as_mut(), leading.as_ref()).ok()?,
            None => cholesky(matrix.as_mut()).ok()?,
        }
        Some(matrix)
    }

    /// The largest difference of the lower triangles.
    fn off(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
        let entries = (0..a.ncols()).flat_map(|j| (j..a.nrows()).map(move |i| (i, j)));
        entries.fold(0.0, |most: f64, at| most.max((a[at] - b[at]).abs()))
    }

    #[test]
    fn a_factor_that_is_extended_is_that_of_the_whole_matrix() {
        let n = 90;
        let whole = factor(n, None).unwrap();
        for kept in [0, 1, 40, n] {
            let leading = factor(kept, None).unwrap();
            let extended = factor(n, Some(&leading)).unwrap();
            assert_abs_diff_eq!(off(&whole, &extended), 0.0, epsilon = 1e-13);
        }
        let wrong = factor(40, None).unwrap() * 2.0;
        assert!(factor(n, Some(&wrong)).is_none_or(|wrong| off(&whole, &wrong) > 1e-3));
        // What is left must be positive definite.
        assert!(factor(n, Some(&(factor(40, None).unwrap() * 1e-3))).is_none());
    }

    /// U S V^T of m rows with Householder reflections as U and V.
    fn with_singular_values(values: &[f64], m: usize) -> Vec<Vec<f64>> {
        let reflection = |n: usize| {
            let v: Vec<f64> = (0..n).map(|i| 1.0 + (i as f64 * 1.7).sin()).collect();
            let squared = dot(&v, &v);
            move |i: usize, j: usize| f64::from(u8::from(i == j)) - 2.0 * v[i] * v[j] / squared
        };
        let (u, v) = (reflection(m), reflection(values.len()));
        let entry = |i, j| (0..values.len()).map(|k| u(i, k) * values[k] * v(j, k)).sum();
        (0..m).map(|i| (0..values.len()).map(|j| entry(i, j)).collect()).collect()
    }

    #[test]
    fn singular_values_are_found_beside_larger_ones_and_zeros_as_zeros() {
        let values = [3e3, 2.0, 2.0, 1e-6, 0.0];
        let rows = with_singular_values(&values, 40);
        let found = singular_vectors(&rows, values.len());
        for ((value, vector), expected) in found.iter().zip(values) {
            // Rounding of the columns, which are as large as the largest value.
            assert_abs_diff_eq!(*value, expected, epsilon = 1e-11);
            assert_abs_diff_eq!(dot(vector, vector), 1.0, epsilon = 1e-14);
            let image: Vec<f64> = rows.iter().map(|row| dot(row, vector)).collect();
            assert_abs_diff_eq!(norm(&image), expected, epsilon = 1e-11);
        }
    }

    #[test]
    fn one_row_stops_one_motion_and_leaves_the_others() {
        let found = singular_vectors(&[vec![3.0, 0.0, 4.0]], 3);
        let values: Vec<f64> = found.iter().map(|(value, _)| *value).collect();
        // Sums of two products.
        assert_abs_diff_eq!(values[..], [5.0, 0.0, 0.0], epsilon = 1e-15);
        assert_abs_diff_eq!(found[0].1[0].abs(), 0.6, epsilon = 1e-15);
    }

    #[test]
    fn what_is_left_by_least_squares_is_orthogonal_to_the_columns() {
        let columns = vec![vec![1.0, 1.0, 1.0, 1.0], vec![0.0, 1.0, 2.0, 3.0 + 1e-3]];
        let target = [1.0, -2.0, 0.5, 4.0];
        let weights = least_squares(columns.clone(), &target);
        let left = |weights: &[f64]| -> Vec<f64> {
            (0..4)
                .map(|i| target[i] - weights[0] * columns[0][i] - weights[1] * columns[1][i])
                .collect()
        };
        for column in &columns {
            assert_abs_diff_eq!(dot(column, &left(&weights)), 0.0, epsilon = 1e-13);
            let other = [weights[0], weights[1] * (1.0 + 1e-6)];
            assert!(dot(column, &left(&other)).abs() > 1e-7, "control");
        }
    }

    /// L of a matrix of order 5 whose leading block of order 3 is positive definite, and what is left of it by elimination `sign` times so.
    fn factored(sign: f64) -> Result<(Mat<f64>, Mat<f64>), SolveError> {
        let below =
            Mat::from_fn(5, 5, |i, j| if i < j { 0.0 } else { 1.0 + (3 * i + 7 * j) as f64 % 4.0 });
        let signs = Mat::from_fn(5, 5, |i, j| match i {
            _ if i != j => 0.0,
            0..3 => 1.0,
            _ => sign,
        });
        let matrix = &below * signs * below.transpose();
        let mut factor = matrix.clone();
        quasidefinite(factor.as_mut(), 3)?;
        Ok((factor, below))
    }

    #[test]
    fn a_quasidefinite_matrix_has_the_cholesky_factor_of_its_signs_and_no_other_has() {
        let (factor, below) = factored(-1.0).unwrap();
        for j in 0..5 {
            for i in j..5 {
                assert_abs_diff_eq!(factor[(i, j)], below[(i, j)], epsilon = 1e-13);
            }
        }
        assert_eq!(factored(1.0).err(), Some(SolveError::NotPositiveDefinite), "control");
    }
}
