//! The sparse Cholesky factor H = L L^T of a matrix on the free degrees of freedom in a given order: its structure, by faer,
//! which all matrices with one pattern share and from which the cost of a factorisation follows, and its numbers (`linear::numeric`).

use std::sync::Arc;

use faer::MatRef;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::simplicial::prefactorize_symbolic_cholesky;
use faer::sparse::linalg::cholesky::supernodal::{
    SymbolicSupernodalCholesky, factorize_supernodal_symbolic_cholesky,
    factorize_supernodal_symbolic_cholesky_scratch,
};

use super::entries::Entries;
use super::numeric;
use crate::linear::matrix::LowerTriangle;
use crate::memory;
use crate::solve::SolveError;

/// The structure of L: its columns in groups with one pattern, the supernodes.
pub(crate) struct Structure {
    symbolic: SymbolicSupernodalCholesky<usize>,
    /// The supernode of each column.
    supernodes: Vec<usize>,
}

impl Structure {
    /// The structure of the factor of a matrix with this pattern.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub(crate) fn new(matrix: &LowerTriangle) -> Result<Self, SolveError> {
        let n = matrix.starts.len() - 1;
        let (starts, rows) = upper_triangle(matrix);
        let upper = SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows);
        let scratch = factorize_supernodal_symbolic_cholesky_scratch::<usize>(n);
        let out_of_memory = || SolveError::OutOfMemory { bytes: scratch.size_bytes() as u64 };
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| out_of_memory())?;
        let mut etree = vec![0_isize; n];
        let mut counts = vec![0_usize; n];
        let etree = prefactorize_symbolic_cholesky(
            &mut etree,
            &mut counts,
            upper,
            MemStack::new(&mut memory),
        );
        let symbolic = factorize_supernodal_symbolic_cholesky(
            upper,
            etree,
            &counts,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .map_err(|_| out_of_memory())?;
        let mut supernodes = vec![0; n];
        for s in 0..symbolic.n_supernodes() {
            supernodes[symbolic.supernode_begin()[s]..symbolic.supernode_end()[s]].fill(s);
        }
        Ok(Structure { symbolic, supernodes })
    }

    /// The number of unknowns.
    pub(crate) fn size(&self) -> usize {
        self.symbolic.nrows()
    }

    /// The number of supernodes. They are numbered as they are eliminated.
    pub(crate) fn supernodes(&self) -> usize {
        self.symbolic.n_supernodes()
    }

    /// The columns of supernode `s`.
    #[inline]
    pub(crate) fn columns(&self, s: usize) -> std::ops::Range<usize> {
        self.symbolic.supernode_begin()[s]..self.symbolic.supernode_end()[s]
    }

    /// The rows of L below the block of supernode `s` on the diagonal, in increasing order.
    #[inline]
    pub(crate) fn rows_below(&self, s: usize) -> &[usize] {
        self.symbolic.supernode(s).pattern()
    }

    /// The supernode of a column.
    #[inline]
    pub(crate) fn supernode_of(&self, column: usize) -> usize {
        self.supernodes[column]
    }

    /// The numbers of rows and of columns of the block of supernode `s`.
    #[inline]
    pub(super) fn shape(&self, s: usize) -> [usize; 2] {
        let columns = self.columns(s).len();
        [columns + self.rows_below(s).len(), columns]
    }

    /// The place of the block of supernode `s` among the entries of L.
    #[inline]
    pub(super) fn start(&self, s: usize) -> usize {
        self.symbolic.col_ptr_for_val()[s]
    }

    /// The entries of L that are stored.
    pub(crate) fn stored_entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Multiplications with an addition of one factorisation: half the sum over the columns of the squares of their lengths.
    pub(crate) fn operations(&self) -> f64 {
        let of = |s: usize| {
            let (columns, below) = (self.columns(s).len(), self.rows_below(s).len());
            (1..=columns).map(|left| ((left + below) as f64).powi(2)).sum::<f64>() / 2.0
        };
        (0..self.supernodes()).map(of).sum()
    }
}

/// The bytes that a solve takes beside its factor, for each unknown (functionals of contact, iterates, residuals, proof):
/// measured, plus a tenth.
const BESIDE: usize = 320;

/// L of H = L L^T.
pub struct Factor {
    pub(crate) structure: Arc<Structure>,
    values: Entries,
}

impl Factor {
    /// The factor of a matrix.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if it is not positive definite, as far as doubles tell, and [`SolveError::OutOfMemory`].
    pub fn new(matrix: &LowerTriangle) -> Result<Self, SolveError> {
        let structure = Arc::new(Structure::new(matrix)?);
        Factor::with(&structure, matrix).map_err(|error| match error {
            SolveError::NotPositiveDefinite => SolveError::Singular,
            other => other,
        })
    }

    /// The factor of a matrix with the pattern that `structure` is the structure of.
    ///
    /// # Errors
    /// [`SolveError::NotPositiveDefinite`], as far as doubles tell, and [`SolveError::OutOfMemory`].
    pub(crate) fn with(
        structure: &Arc<Structure>,
        matrix: &LowerTriangle,
    ) -> Result<Self, SolveError> {
        let scratch = numeric::scratch_bytes(structure);
        let entries = structure.stored_entries();
        let bytes = (Entries::bytes(entries) + scratch + BESIDE * structure.size()) as u64;
        memory::check(bytes)?;
        let mut values = Entries::zeros(entries).ok_or(SolveError::OutOfMemory { bytes })?;
        numeric::factorise(structure, matrix, &mut values, |_| true)?;
        Ok(Factor { structure: Arc::clone(structure), values })
    }

    /// The factor of a matrix that differs from the one of this factor in the columns of these `unknowns` alone, to the last bit what
    /// [`Factor::with`] gives: a supernode depends on those below it in the elimination tree alone. Nothing is copied if no one else
    /// has this factor.
    ///
    /// # Errors
    /// As [`Factor::with`].
    pub(crate) fn changed(
        self: Arc<Self>,
        matrix: &LowerTriangle,
        unknowns: impl Iterator<Item = usize>,
    ) -> Result<Arc<Self>, SolveError> {
        let structure = Arc::clone(&self.structure);
        let mut stale = vec![false; structure.supernodes()];
        unknowns.for_each(|unknown| stale[structure.supernode_of(unknown)] = true);
        for s in 0..stale.len() {
            if let (true, Some(&row)) = (stale[s], structure.rows_below(s).first()) {
                stale[structure.supernode_of(row)] = true;
            }
        }
        let bytes = Entries::bytes(structure.stored_entries()) as u64;
        memory::check(bytes)?;
        let mut values = match Arc::try_unwrap(self) {
            Ok(own) => own.values,
            Err(shared) => shared.values.copied().ok_or(SolveError::OutOfMemory { bytes })?,
        };
        numeric::factorise(&structure, matrix, &mut values, |s| stale[s])?;
        Ok(Arc::new(Factor { structure, values }))
    }

    /// Its entries that are stored.
    pub fn stored_entries(&self) -> usize {
        self.structure.stored_entries()
    }

    /// The columns of supernode `s`: first the lower triangle on the diagonal, below it the rows of
    /// [`Structure::rows_below`].
    pub(crate) fn block(&self, s: usize) -> MatRef<'_, f64> {
        let [rows, columns] = self.structure.shape(s);
        let values = &self.values[self.structure.start(s)..][..rows * columns];
        MatRef::from_column_major_slice(values, rows, columns)
    }

    /// x <- H^-1 x
    pub fn solve(&self, x: &mut [f64]) {
        self.forward(x);
        self.backward(x);
    }

    /// x <- H^-1 x for `count` right sides, x row by row.
    pub(crate) fn solve_columns(&self, x: &mut [f64], count: usize) {
        numeric::solve_columns(&self.structure, &self.values, x, count);
    }

    /// x <- L^-1 x
    pub fn forward(&self, x: &mut [f64]) {
        numeric::forward(&self.structure, &self.values, x);
    }

    /// x <- L^-T x
    pub fn backward(&self, x: &mut [f64]) {
        numeric::backward(&self.structure, &self.values, x);
    }
}

/// The pattern of the upper triangle of a symmetric matrix, column by column: the transpose of the lower one.
fn upper_triangle(lower: &LowerTriangle) -> (Vec<usize>, Vec<usize>) {
    let n = lower.starts.len() - 1;
    let mut starts = vec![0; n + 1];
    for &row in lower.rows.iter() {
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
