//! The sparse Cholesky factor A = L L^T of the matrix on the free degrees of freedom, by faer, in a given order.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::linalg::cholesky::simplicial::prefactorize_symbolic_cholesky;
use faer::sparse::linalg::cholesky::supernodal::{
    SupernodalLltRef, SymbolicSupernodalCholesky, factorize_supernodal_numeric_llt,
    factorize_supernodal_numeric_llt_scratch, factorize_supernodal_symbolic_cholesky,
    factorize_supernodal_symbolic_cholesky_scratch,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, MatMut, Par};

use super::SolveError;
use crate::fem::matrix::LowerTriangle;

/// L of A = L L^T.
pub struct Factor {
    symbolic: SymbolicSupernodalCholesky<usize>,
    values: Vec<f64>,
}

impl Factor {
    /// Factors the matrix, rows and columns in the order that they have.
    ///
    /// # Errors
    /// [`SolveError::NotPositiveDefinite`], and [`SolveError::OutOfMemory`].
    pub fn new(matrix: &LowerTriangle) -> Result<Self, SolveError> {
        let n = matrix.starts.len() - 1;
        let symbolic = analyse(n, matrix)?;
        let parallel = Par::Seq;
        let mut values = zeros(symbolic.len_val())?;
        let scratch = factorize_supernodal_numeric_llt_scratch::<usize, f64>(
            &symbolic,
            parallel,
            Default::default(),
        );
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| SolveError::OutOfMemory)?;
        let pattern =
            SymbolicSparseColMatRef::new_checked(n, n, &matrix.starts, None, &matrix.rows);
        factorize_supernodal_numeric_llt(
            &mut values,
            SparseColMatRef::new(pattern, &matrix.values),
            Default::default(),
            &symbolic,
            parallel,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .map_err(|LltError::NonPositivePivot { .. }| SolveError::NotPositiveDefinite)?;
        Ok(Factor { symbolic, values })
    }

    fn llt(&self) -> SupernodalLltRef<'_, usize, f64> {
        SupernodalLltRef::new(&self.symbolic, &self.values)
    }

    /// The entries of L that are stored.
    pub fn stored_entries(&self) -> usize {
        self.values.len()
    }

    /// x <- L^-1 x
    pub fn forward(&self, x: &mut [f64]) {
        self.with_scratch(x, |llt, x, stack| llt.l_solve_with_conj(Conj::No, x, Par::Seq, stack));
    }

    /// x <- L^-T x
    pub fn backward(&self, x: &mut [f64]) {
        self.with_scratch(x, |llt, x, stack| {
            llt.l_transpose_solve_with_conj(Conj::No, x, Par::Seq, stack);
        });
    }

    fn with_scratch(
        &self,
        x: &mut [f64],
        solve: impl FnOnce(SupernodalLltRef<'_, usize, f64>, MatMut<'_, f64>, &mut MemStack),
    ) {
        let mut memory = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let n = x.len();
        let x = MatMut::from_column_major_slice_mut(x, n, 1);
        solve(self.llt(), x, MemStack::new(&mut memory));
    }

    /// The trailing block of L from row and column `first` on, as a dense lower triangle.
    pub fn trailing_block(&self, first: usize) -> Mat<f64> {
        let llt = self.llt();
        let size = self.symbolic.nrows() - first;
        let mut block = Mat::zeros(size, size);
        for s in (0..self.symbolic.n_supernodes()).rev() {
            let supernode = llt.supernode(s);
            let entries = supernode.val();
            let (start, columns) = (supernode.start(), entries.ncols());
            if start + columns <= first {
                break;
            }
            for j in first.saturating_sub(start)..columns {
                for i in j..columns {
                    block[(start + i - first, start + j - first)] = entries[(i, j)];
                }
                for (i, &row) in supernode.pattern().iter().enumerate() {
                    block[(row - first, start + j - first)] = entries[(columns + i, j)];
                }
            }
        }
        block
    }
}

fn zeros(n: usize) -> Result<Vec<f64>, SolveError> {
    let mut values = Vec::new();
    values.try_reserve_exact(n).map_err(|_| SolveError::OutOfMemory)?;
    values.resize(n, 0.0);
    Ok(values)
}

/// The structure of L from that of A.
fn analyse(
    n: usize,
    matrix: &LowerTriangle,
) -> Result<SymbolicSupernodalCholesky<usize>, SolveError> {
    let (starts, rows) = upper_triangle(n, matrix);
    let upper = SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows);
    let scratch = factorize_supernodal_symbolic_cholesky_scratch::<usize>(n);
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| SolveError::OutOfMemory)?;
    let mut etree = vec![0_isize; n];
    let mut counts = vec![0_usize; n];
    let etree =
        prefactorize_symbolic_cholesky(&mut etree, &mut counts, upper, MemStack::new(&mut memory));
    factorize_supernodal_symbolic_cholesky(
        upper,
        etree,
        &counts,
        MemStack::new(&mut memory),
        Default::default(),
    )
    .map_err(|_| SolveError::OutOfMemory)
}

/// The pattern of the upper triangle, column by column: the transpose of the lower one.
fn upper_triangle(n: usize, lower: &LowerTriangle) -> (Vec<usize>, Vec<usize>) {
    let mut starts = vec![0; n + 1];
    for &row in &lower.rows {
        starts[row + 1] += 1;
    }
    for i in 0..n {
        starts[i + 1] += starts[i];
    }
    let mut rows = vec![0; lower.rows.len()];
    let mut next = starts.clone();
    for column in 0..n {
        for &row in &lower.rows[lower.starts[column]..lower.starts[column + 1]] {
            rows[next[row]] = column;
            next[row] += 1;
        }
    }
    (starts, rows)
}
