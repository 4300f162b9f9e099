//! The sparse Cholesky factor H = L L^T of a matrix on the free degrees of freedom in a given order: its structure, by faer,
//! which all matrices with one pattern share and from which the cost of a factorisation follows, and its numbers (`linear::numeric`).

use std::mem::replace;
use std::ops::Range;
use std::sync::Arc;

use faer::MatRef;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SymbolicSupernodalParams;
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

/// The structure of L: its columns in groups with one pattern, the supernodes, numbered as they are eliminated.
pub(crate) struct Structure {
    /// The first column of each supernode, and the number of columns.
    columns: Vec<usize>,
    /// The supernode of each column.
    supernodes: Vec<usize>,
    /// Where the rows below the block of each supernode on the diagonal start, and where the last ones end.
    rows_below: Vec<usize>,
    /// These rows.
    rows: Vec<usize>,
    /// The place of the block of each supernode among the entries of L, and the number of all entries.
    starts: Vec<usize>,
}

/// Up to how many nodes two supernodes are joined in which this share is zero (faer's `relax`): fewer than faer joins, as on strips.
const RELAX: &[(usize, f64)] = &[(2, 0.6), (8, 0.4), (24, 0.1), (usize::MAX, 0.05)];

impl Structure {
    /// The structure of the factor of a matrix with this pattern, by faer from that of its [nodes](Nodes), which has a quarter of
    /// the entries.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub(crate) fn new(matrix: &LowerTriangle) -> Result<Self, SolveError> {
        let nodes = Nodes::of(matrix);
        let n = nodes.count();
        let (starts, rows) = nodes.upper_triangle(matrix);
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
            SymbolicSupernodalParams { relax: Some(RELAX) },
        )
        .map_err(|_| out_of_memory())?;
        Ok(Structure::of_columns(&nodes, &symbolic))
    }

    /// The structure in columns, from that in nodes.
    fn of_columns(nodes: &Nodes, symbolic: &SymbolicSupernodalCholesky<usize>) -> Self {
        let mut structure = Structure {
            columns: vec![0],
            supernodes: Vec::with_capacity(nodes.of.len()),
            rows_below: vec![0],
            rows: Vec::new(),
            starts: vec![0],
        };
        let Structure { columns, supernodes, rows_below, rows, starts } = &mut structure;
        let (mut first, mut entries) = (0, 0);
        for (s, &end) in symbolic.supernode_end().iter().enumerate() {
            let end = nodes.columns[end];
            let below = symbolic.supernode(s).pattern();
            rows.extend(
                below.iter().flat_map(|&node| nodes.columns[node]..nodes.columns[node + 1]),
            );
            let height = end - first + rows.len() - rows_below[s];
            entries += height * (end - first);
            supernodes.resize(end, s);
            columns.push(end);
            rows_below.push(rows.len());
            starts.push(entries);
            first = end;
        }
        structure
    }

    /// The number of unknowns.
    pub(crate) fn size(&self) -> usize {
        self.supernodes.len()
    }

    /// The number of supernodes.
    pub(crate) fn supernodes(&self) -> usize {
        self.columns.len() - 1
    }

    /// The columns of supernode `s`.
    #[inline]
    pub(crate) fn columns(&self, s: usize) -> Range<usize> {
        self.columns[s]..self.columns[s + 1]
    }

    /// The rows of L below the block of supernode `s` on the diagonal, in increasing order.
    #[inline]
    pub(crate) fn rows_below(&self, s: usize) -> &[usize] {
        &self.rows[self.rows_below[s]..self.rows_below[s + 1]]
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
        self.starts[s]
    }

    /// The entries of L that are stored.
    pub(crate) fn stored_entries(&self) -> usize {
        self.starts[self.supernodes()]
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

/// Columns of a matrix that follow each other and have the same rows, each from its diagonal on: those of a node of the mesh.
struct Nodes {
    /// The first column of each node, and the number of columns.
    columns: Vec<usize>,
    /// The node of each column.
    of: Vec<usize>,
}

impl Nodes {
    fn of(matrix: &LowerTriangle) -> Self {
        let n = matrix.starts.len() - 1;
        let rows = |j: usize| &matrix.rows[matrix.starts[j]..matrix.starts[j + 1]];
        let mut nodes = Nodes { columns: Vec::new(), of: Vec::with_capacity(n) };
        for j in 0..n {
            if j == 0 || rows(j - 1)[1..] != *rows(j) {
                nodes.columns.push(j);
            }
            nodes.of.push(nodes.columns.len() - 1);
        }
        nodes.columns.push(n);
        nodes
    }

    fn count(&self) -> usize {
        self.columns.len() - 1
    }

    /// The pattern of the upper triangle of the symmetric matrix, column by column: the transpose of the lower one.
    fn upper_triangle(&self, lower: &LowerTriangle) -> (Vec<usize>, Vec<usize>) {
        // The rows of a node's first column are those of all of its columns.
        let rows = |node: usize| {
            let column = self.columns[node];
            let rows = &lower.rows[lower.starts[column]..lower.starts[column + 1]];
            let mut last = self.count();
            rows.iter()
                .map(|&row| self.of[row])
                .filter(move |&node| replace(&mut last, node) != node)
        };
        let n = self.count();
        let mut starts = vec![0; n + 1];
        (0..n).flat_map(rows).for_each(|row| starts[row + 1] += 1);
        for i in 0..n {
            starts[i + 1] += starts[i];
        }
        let mut upper = vec![0; starts[n]];
        let mut next = starts.clone();
        for node in 0..n {
            for row in rows(node) {
                upper[next[row]] = node;
                next[row] += 1;
            }
        }
        (starts, upper)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// A matrix with 4 on its diagonal and -1 where these pairs of unknowns meet.
    fn matrix(n: usize, pairs: &[[usize; 2]]) -> LowerTriangle {
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in 0..n {
            let below = (column + 1..n).filter(|&row| pairs.contains(&[column, row]));
            rows.extend(std::iter::once(column).chain(below));
            values.resize(rows.len(), -1.0);
            values[starts[column]] = 4.0;
            starts.push(rows.len());
        }
        LowerTriangle { starts: starts.into(), rows: rows.into(), values }
    }

    #[test]
    fn columns_are_one_node_where_they_have_the_same_rows() {
        let pairs = [[0, 1], [0, 3], [1, 3], [2, 3], [2, 4], [3, 4]];
        let nodes = Nodes::of(&matrix(5, &pairs));
        assert_eq!((&nodes.columns[..], &nodes.of[..]), (&[0, 2, 5][..], &[0, 0, 1, 1, 1][..]));
        // Column 0 meets column 1, but not what that one meets.
        let apart = Nodes::of(&matrix(3, &[[0, 1], [1, 2]]));
        assert_eq!(apart.columns, [0, 1, 3], "control");
    }

    #[test]
    fn a_matrix_of_no_mesh_has_its_factor_too() {
        // Column 0 meets row 2 of the last three, which are one node, and rows 1 and 3 not.
        let pairs = [[0, 2], [1, 2], [1, 3], [2, 3]];
        let (sparse, b) = (matrix(4, &pairs), [1.0, -2.0, 3.0, 0.5]);
        let mut x = b;
        Factor::new(&sparse).unwrap().solve(&mut x);
        let off = |pairs: &[[usize; 2]]| {
            let meet = |i, j| pairs.contains(&[i, j]) || pairs.contains(&[j, i]);
            let entry = |i, j| match (i == j, meet(i, j)) {
                (true, _) => 4.0,
                (_, true) => -1.0,
                _ => 0.0,
            };
            let dense = DMatrix::from_fn(4, 4, entry);
            (dense * DVector::from_row_slice(&x) - DVector::from_row_slice(&b)).abs().max()
        };
        assert!(off(&pairs) < 1e-14);
        assert!(off(&pairs[1..]) > 0.1, "control");
    }
}
