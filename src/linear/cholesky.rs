//! Cholesky factors of dense matrices.

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
pub(crate) fn factor(matrix: MatMut<'_, f64>) -> Result<(), SolveError> {
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
/// As [`factor`].
pub(crate) fn extend(matrix: MatMut<'_, f64>, leading: MatRef<'_, f64>) -> Result<(), SolveError> {
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
    factor(rest)
}

/// The lower triangle of a symmetric matrix whose leading block of this size is positive definite, and whose Schur complement is
/// negative definite, becomes L of L diag(I, -I) L^T.
///
/// # Errors
/// As [`factor`], where a block is not definite.
pub(crate) fn quasidefinite(
    mut matrix: MatMut<'_, f64>,
    positive: usize,
) -> Result<(), SolveError> {
    let (mut leading, _, mut below, mut rest) = matrix.rb_mut().split_at_mut(positive, positive);
    factor(leading.rb_mut())?;
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
    factor(rest)
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;
    use faer::Mat;

    use super::*;

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

    /// The Cholesky factor of a matrix of this size, or `None`: by extension if one of the `leading` block is given.
    fn factor_of(n: usize, leading: Option<&Mat<f64>>) -> Option<Mat<f64>> {
        let sum = |i: usize, j: usize| 1.0 / (1.0 + i as f64 + j as f64);
        let mut matrix =
            Mat::from_fn(n, n, |i, j| sum(i, j) + f64::from(u8::from(i == j)) * (1.0 + i as f64));
        match leading {
            Some(leading) => extend(matrix.as_mut(), leading.as_ref()).ok()?,
            None => factor(matrix.as_mut()).ok()?,
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
        let whole = factor_of(n, None).unwrap();
        for kept in [0, 1, 40, n] {
            let leading = factor_of(kept, None).unwrap();
            let extended = factor_of(n, Some(&leading)).unwrap();
            assert_abs_diff_eq!(off(&whole, &extended), 0.0, epsilon = 1e-13);
        }
        let wrong = factor_of(40, None).unwrap() * 2.0;
        assert!(factor_of(n, Some(&wrong)).is_none_or(|wrong| off(&whole, &wrong) > 1e-3));
        // What is left must be positive definite.
        assert!(factor_of(n, Some(&(factor_of(40, None).unwrap() * 1e-3))).is_none());
    }
}
