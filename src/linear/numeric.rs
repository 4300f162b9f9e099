//! The numbers of the sparse Cholesky factor L of H = L L^T in its [structure](super::factor::Structure), supernode by supernode,
//! looking to the left, and the substitutions with it. Small supernodes, most of all in number, are done by plain loops, compiled for the
//! instructions that the processor has; large ones by faer. faer's own supernodal factorisation calls its packed products for each:
//! on a strip, where a product has a hundred terms, that takes several times as many instructions.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, NullaryFnOnce};

use super::factor::Structure;
use crate::linear::cholesky;
use crate::linear::matrix::LowerTriangle;
use crate::solve::SolveError;

/// Multiplications with an addition from which a packed product takes less time than loops.
const PACKED: usize = 8192;

/// Columns of a supernode from which its block on the diagonal is left to faer.
const WIDE: usize = 32;

/// No supernode.
const NONE: usize = usize::MAX;

/// The bytes that [`factorise`] takes beside L, about.
pub(super) fn scratch_bytes(structure: &Structure) -> usize {
    let widest = (0..structure.supernodes()).map(|s| {
        let [rows, columns] = structure.shape(s);
        rows * columns
    });
    8 * (structure.size() + 4 * structure.supernodes() + widest.max().unwrap_or(0))
}

/// Writes L into `values`, the blocks of its supernodes one after the other, each column by column; those that are not `stale` are there.
///
/// # Errors
/// [`SolveError::NotPositiveDefinite`] as far as doubles tell, and [`SolveError::OutOfMemory`].
pub(super) fn factorise(
    structure: &Structure,
    matrix: &LowerTriangle,
    values: &mut [f64],
    stale: impl Fn(usize) -> bool,
) -> Result<(), SolveError> {
    Arch::new().dispatch(Factorisation { structure, matrix, values, stale })
}

/// x <- L^-1 x
pub(super) fn forward(structure: &Structure, values: &[f64], x: &mut [f64]) {
    Arch::new().dispatch(Forward { structure, values, x });
}

/// x <- L^-T x
pub(super) fn backward(structure: &Structure, values: &[f64], x: &mut [f64]) {
    Arch::new().dispatch(Backward { structure, values, x });
}

/// x <- H^-1 x for `count` right sides, which take L from memory together: x row by row. On the way forward supernodes where all of them are
/// zero are passed over.
pub(super) fn solve_columns(structure: &Structure, values: &[f64], x: &mut [f64], count: usize) {
    let block = |s: usize| {
        let [rows, width] = structure.shape(s);
        let values = &values[structure.start(s)..][..rows * width];
        let block = MatRef::from_column_major_slice(values, rows, width);
        let (first, end) = (structure.columns(s).start, structure.columns(s).end);
        (block.split_at_row(width), first * count..end * count)
    };
    let mut known = Vec::new();
    for s in 0..structure.supernodes() {
        let ((diagonal, below), own) = block(s);
        if x[own.clone()].iter().all(|x| *x == 0.0) {
            continue;
        }
        let own = &mut x[own];
        let mut own = MatMut::from_row_major_slice_mut(own, diagonal.ncols(), count);
        solve_lower_triangular_in_place(diagonal, own.as_mut(), Par::Seq);
        known.resize((below.nrows() * count).max(known.len()), 0.0);
        let sums = &mut known[..below.nrows() * count];
        let product = MatMut::from_row_major_slice_mut(&mut *sums, below.nrows(), count);
        matmul(product, Accum::Replace, below, own.as_ref(), 1.0, Par::Seq);
        for (sums, &row) in sums.chunks_exact(count).zip(structure.rows_below(s)) {
            let x = &mut x[row * count..][..count];
            x.iter_mut().zip(sums).for_each(|(x, sum)| *x -= sum);
        }
    }
    for s in (0..structure.supernodes()).rev() {
        let ((diagonal, below), own) = block(s);
        known.clear();
        for &row in structure.rows_below(s) {
            known.extend_from_slice(&x[row * count..][..count]);
        }
        let known = MatRef::from_row_major_slice(&known, below.nrows(), count);
        let mut own = MatMut::from_row_major_slice_mut(&mut x[own], diagonal.ncols(), count);
        matmul(own.as_mut(), Accum::Add, below.transpose(), known, -1.0, Par::Seq);
        solve_upper_triangular_in_place(diagonal.transpose(), own, Par::Seq);
    }
}

struct Factorisation<'a, F> {
    structure: &'a Structure,
    matrix: &'a LowerTriangle,
    values: &'a mut [f64],
    /// Tells whether a supernode is to be computed.
    stale: F,
}

impl<F: Fn(usize) -> bool> NullaryFnOnce for Factorisation<'_, F> {
    type Output = Result<(), SolveError>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Factorisation { structure, matrix, values, stale } = self;
        let count = structure.supernodes();
        // The place of each row in the block at hand.
        let mut places = vec![0; structure.size()];
        // For each supernode a list of those on its left that have rows in it, and how many of their rows are used up.
        let (mut first, mut next) = (vec![NONE; count], vec![NONE; count]);
        let mut used = vec![0; count];
        let (mut local, mut sums) = (Vec::new(), Vec::new());
        for s in 0..count {
            let (columns, below) = (structure.columns(s), structure.rows_below(s));
            let [rows, width] = structure.shape(s);
            let (left, rest) = values.split_at_mut(structure.start(s));
            let block = &mut rest[..rows * width];
            let is_stale = stale(s);
            if is_stale {
                for (place, row) in columns.clone().enumerate() {
                    places[row] = place;
                }
                for (place, &row) in below.iter().enumerate() {
                    places[row] = width + place;
                }
                block.fill(0.0);
                for (j, column) in columns.clone().zip(block.chunks_exact_mut(rows)) {
                    for k in matrix.starts[j]..matrix.starts[j + 1] {
                        column[places[matrix.rows[k]]] = matrix.values[k];
                    }
                }
            }
            let mut d = first[s];
            while d != NONE {
                let following = next[d];
                let pattern = &structure.rows_below(d)[used[d]..];
                let inside = pattern.partition_point(|&row| row < columns.end);
                if is_stale {
                    local.clear();
                    local.extend(pattern.iter().map(|&row| places[row]));
                    let [of_d, width] = structure.shape(d);
                    let source = Block {
                        values: &left[structure.start(d)..structure.start(d) + of_d * width],
                        rows: of_d,
                        from: width + used[d],
                    };
                    source.subtract_square(inside, &local, (&mut *block, rows), &mut sums);
                }
                used[d] += inside;
                if let Some(&row) = pattern.get(inside) {
                    let ancestor = structure.supernode_of(row);
                    (next[d], first[ancestor]) = (first[ancestor], d);
                }
                d = following;
            }
            if is_stale {
                cholesky(block, rows, width)?;
            }
            if let Some(&row) = below.first() {
                let parent = structure.supernode_of(row);
                (next[s], first[parent]) = (first[parent], s);
            }
        }
        Ok(())
    }
}

/// The rows of a block of L from one on.
struct Block<'a> {
    values: &'a [f64],
    /// The rows of the whole block.
    rows: usize,
    /// The first of those that count.
    from: usize,
}

impl Block<'_> {
    /// Subtracts the lower triangle of the product of these rows and the transposed first ones of them, `inside` in number, from a
    /// block of so many rows; `local` are the places of the rows there.
    #[inline(always)]
    fn subtract_square(
        &self,
        inside: usize,
        local: &[usize],
        (block, rows): (&mut [f64], usize),
        sums: &mut Vec<f64>,
    ) {
        let (height, width) = (local.len(), self.values.len() / self.rows);
        if height * inside * width < PACKED {
            sums.resize(height.max(sums.len()), 0.0);
            for j in 0..inside {
                let sums = &mut sums[..height - j];
                sums.fill(0.0);
                add_columns(sums, self.values, (self.rows, self.from + j), |_, column| column[0]);
                let (column, places) = (&mut block[local[j] * rows..][..rows], &local[j..]);
                for i in 0..places.len() {
                    column[places[i]] -= sums[i];
                }
            }
            return;
        }
        sums.resize((height * inside).max(sums.len()), 0.0);
        let sums = &mut sums[..height * inside];
        let source = MatRef::from_column_major_slice(self.values, self.rows, width);
        let (top, bottom) = source.subrows(self.from, height).split_at_row(inside);
        let product = MatMut::from_column_major_slice_mut(&mut *sums, height, inside);
        let (square, rest) = product.split_at_row_mut(inside);
        triangular::matmul(
            square,
            BlockStructure::TriangularLower,
            Accum::Replace,
            top,
            BlockStructure::Rectangular,
            top.transpose(),
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        matmul(rest, Accum::Replace, bottom, top.transpose(), 1.0, Par::Seq);
        for (j, sums) in sums.chunks_exact(height).enumerate() {
            let column = &mut block[local[j] * rows..][..rows];
            for i in j..height {
                column[local[i]] -= sums[i];
            }
        }
    }
}

/// Adds to `sums` the columns of a block of so many rows from row `from` on, each times its factor.
#[inline(always)]
fn add_columns(
    sums: &mut [f64],
    block: &[f64],
    (rows, from): (usize, usize),
    factor: impl Fn(usize, &[f64]) -> f64,
) {
    let (count, n) = (block.len() / rows, sums.len());
    let mut k = 0;
    while k + 4 <= count {
        let a = &block[k * rows + from..][..n];
        let b = &block[(k + 1) * rows + from..][..n];
        let c = &block[(k + 2) * rows + from..][..n];
        let d = &block[(k + 3) * rows + from..][..n];
        let (p, q, r, s) = (factor(k, a), factor(k + 1, b), factor(k + 2, c), factor(k + 3, d));
        for i in 0..n {
            sums[i] += (p * a[i] + q * b[i]) + (r * c[i] + s * d[i]);
        }
        k += 4;
    }
    while k < count {
        let a = &block[k * rows + from..][..n];
        let p = factor(k, a);
        for i in 0..n {
            sums[i] += p * a[i];
        }
        k += 1;
    }
}

/// The block of a supernode: its lower triangle on the diagonal becomes its Cholesky factor, the rows below are divided by that.
#[inline(always)]
fn cholesky(block: &mut [f64], rows: usize, width: usize) -> Result<(), SolveError> {
    if width >= WIDE {
        return wide_cholesky(block, rows, width);
    }
    for k in 0..width {
        let (before, later) = block.split_at_mut((k + 1) * rows);
        let column = &mut before[k * rows + k..];
        let pivot = column[0];
        // A NaN is not positive.
        if !(pivot > 0.0) {
            return Err(SolveError::NotPositiveDefinite);
        }
        let root = pivot.sqrt();
        let inverse = 1.0 / root;
        column[0] = root;
        column[1..].iter_mut().for_each(|entry| *entry *= inverse);
        for (j, other) in (k + 1..width).zip(later.chunks_exact_mut(rows)) {
            let (own, other) = (&column[j - k..], &mut other[j..]);
            let factor = own[0];
            for i in 0..other.len() {
                other[i] -= factor * own[i];
            }
        }
    }
    Ok(())
}

fn wide_cholesky(block: &mut [f64], rows: usize, width: usize) -> Result<(), SolveError> {
    let block = MatMut::from_column_major_slice_mut(block, rows, width);
    let (mut top, below) = block.split_at_row_mut(width);
    cholesky::factor(top.as_mut())?;
    solve_lower_triangular_in_place(top.as_ref(), below.transpose_mut(), Par::Seq);
    Ok(())
}

struct Forward<'a> {
    structure: &'a Structure,
    values: &'a [f64],
    x: &'a mut [f64],
}

impl NullaryFnOnce for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Forward { structure, values, x } = self;
        let mut sums = Vec::new();
        for s in 0..structure.supernodes() {
            let [rows, width] = structure.shape(s);
            let block = &values[structure.start(s)..structure.start(s) + rows * width];
            let below = structure.rows_below(s);
            let own = &mut x[structure.columns(s)];
            for (k, column) in block.chunks_exact(rows).enumerate() {
                let value = own[k] / column[k];
                own[k] = value;
                for i in k + 1..width {
                    own[i] -= value * column[i];
                }
            }
            sums.resize(below.len().max(sums.len()), 0.0);
            let sums = &mut sums[..below.len()];
            sums.fill(0.0);
            add_columns(sums, block, (rows, width), |k, _| own[k]);
            for i in 0..below.len() {
                x[below[i]] -= sums[i];
            }
        }
    }
}

struct Backward<'a> {
    structure: &'a Structure,
    values: &'a [f64],
    x: &'a mut [f64],
}

impl NullaryFnOnce for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Backward { structure, values, x } = self;
        let mut known = Vec::new();
        for s in (0..structure.supernodes()).rev() {
            let [rows, width] = structure.shape(s);
            let block = &values[structure.start(s)..structure.start(s) + rows * width];
            known.clear();
            known.extend(structure.rows_below(s).iter().map(|&row| x[row]));
            let own = &mut x[structure.columns(s)];
            for (k, column) in block.chunks_exact(rows).enumerate().rev() {
                let inside = product(&column[k + 1..width], &own[k + 1..]);
                own[k] = (own[k] - (inside + product(&column[width..], &known))) / column[k];
            }
        }
    }
}

/// The sum of the products of two lists, in eight sums that a processor adds at once.
#[inline(always)]
fn product(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let n = a.len();
    let b = &b[..n];
    let mut sums = [0.0; LANES];
    let whole = n - n % LANES;
    for start in (0..whole).step_by(LANES) {
        let (a, b) = (&a[start..start + LANES], &b[start..start + LANES]);
        for i in 0..LANES {
            sums[i] += a[i] * b[i];
        }
    }
    let mut sum = 0.0;
    for i in whole..n {
        sum += a[i] * b[i];
    }
    if whole > 0 {
        for i in 0..LANES {
            sum += sums[i];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use approx::assert_abs_diff_eq;
    use nalgebra::DMatrix;

    use super::*;
    use crate::contact::{Discretization, EdgeRule};
    use crate::kernel::{Material, Plane};
    use crate::linear::dense::norm;
    use crate::linear::factor::Factor;
    use crate::linear::system::{Factored, System};
    use crate::model::{Condition, Degree, Diagonal, Problem, Rectangle};

    fn with_system(degree: Degree, n: usize, f: impl FnOnce(&System)) {
        let square = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Right };
        let problem = Problem::of(square.mesh().unwrap(), Material::lame(1.0, 1.0, Plane::Strain))
            .with("top", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.0));
        let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact);
        f(&System::new(&d.unwrap()).unwrap());
    }

    /// A x
    fn times(matrix: &LowerTriangle, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        for j in 0..x.len() {
            for k in matrix.starts[j]..matrix.starts[j + 1] {
                let (i, entry) = (matrix.rows[k], matrix.values[k]);
                product[i] += entry * x[j];
                if i != j {
                    product[j] += entry * x[i];
                }
            }
        }
        product
    }

    /// L x, and L^T x, by the blocks of L.
    fn times_factor(factor: &Factor, x: &[f64], transposed: bool) -> Vec<f64> {
        let structure = &factor.structure;
        let mut product = vec![0.0; x.len()];
        for s in 0..structure.supernodes() {
            let block = factor.block(s);
            let rows = structure.columns(s).chain(structure.rows_below(s).iter().copied());
            for (i, row) in rows.enumerate() {
                for (k, column) in structure.columns(s).enumerate().take(i + 1) {
                    let (to, from) = if transposed { (column, row) } else { (row, column) };
                    product[to] += block[(i, k)] * x[from];
                }
            }
        }
        product
    }

    fn is_the_factor(system: &System, matrix: &LowerTriangle) -> bool {
        let factor = Factor::with(&system.structure, &system.matrix).unwrap();
        let x: Vec<f64> = (0..system.numbering.count).map(|i| (1.7 * i as f64).cos()).collect();
        let (product, lower) = (times(matrix, &x), times_factor(&factor, &x, true));
        let by_factor = times_factor(&factor, &lower, false);
        let off: Vec<f64> = product.iter().zip(&by_factor).map(|(a, b)| a - b).collect();
        let [mut back, mut there] = [lower, times_factor(&factor, &x, false)];
        factor.backward(&mut back);
        factor.forward(&mut there);
        // The substitutions lose what the condition of L takes, some 1e2.
        for (x, (back, there)) in x.iter().zip(back.iter().zip(&there)) {
            assert_abs_diff_eq!(x, back, epsilon = 1e-11);
            assert_abs_diff_eq!(x, there, epsilon = 1e-11);
        }
        norm(&off) <= 1e-13 * norm(&product)
    }

    #[test]
    fn l_times_its_transpose_is_the_matrix_where_supernodes_are_small_and_where_they_are_large() {
        for (degree, n) in [(Degree::One, 5), (Degree::One, 48), (Degree::Two, 24)] {
            with_system(degree, n, |system| {
                let structure = &system.structure;
                let widest = (0..structure.supernodes()).map(|s| structure.columns(s).len()).max();
                assert_eq!(widest >= Some(WIDE), n > 5, "both ways of a block");
                assert!(is_the_factor(system, &system.matrix));
                let mut other = system.matrix.clone();
                other.values[0] *= 1.0 + 1e-6;
                assert!(!is_the_factor(system, &other), "control");
            });
        }
    }

    #[test]
    fn columns_that_are_solved_together_are_those_that_are_solved_one_by_one() {
        for (degree, n) in [(Degree::One, 5), (Degree::One, 48), (Degree::Two, 24)] {
            with_system(degree, n, |system| {
                let factor = Factor::with(&system.structure, &system.matrix).unwrap();
                let (n, count) = (system.numbering.count, 3);
                // The second one has a single force, far up in the elimination tree.
                let of = |i: usize| [(1.7 * i as f64).cos(), f64::from(u8::from(i == n - 1)), 1.0];
                let mut together: Vec<f64> = (0..n).flat_map(of).collect();
                factor.solve_columns(&mut together, count);
                for k in 0..count {
                    let mut alone: Vec<f64> = (0..n).map(|i| of(i)[k]).collect();
                    factor.solve(&mut alone);
                    let off = |column: usize| -> f64 {
                        let pairs = alone.iter().zip(together[column..].iter().step_by(count));
                        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
                    };
                    let size = alone.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                    assert!(off(k) <= 1e-11 * size);
                    assert!(off((k + 1) % count) > 1e-2 * size, "control");
                }
            });
        }
    }

    #[test]
    fn where_some_columns_change_the_factor_is_to_the_last_bit_what_a_new_one_is() {
        for (degree, n) in [(Degree::One, 5), (Degree::One, 48), (Degree::Two, 24)] {
            with_system(degree, n, |system| {
                let values = |factor: &Factor| {
                    let blocks = (0..system.structure.supernodes()).map(|s| factor.block(s));
                    let entries = |block: faer::MatRef<f64>| {
                        let columns = (0..block.ncols()).map(|k| block.col(k).iter().copied());
                        columns.flatten().collect::<Vec<f64>>()
                    };
                    blocks.flat_map(entries).collect::<Vec<f64>>()
                };
                let before = Arc::new(Factor::with(&system.structure, &system.matrix).unwrap());
                let (mut other, changed) = (system.matrix.clone(), [3, system.numbering.count / 2]);
                changed.iter().for_each(|&j| other.values[other.starts[j]] *= 1.5);
                let anew = values(&Factor::with(&system.structure, &other).unwrap());
                let after = |columns: &[usize]| {
                    let factor = Arc::clone(&before).changed(&other, columns.iter().copied());
                    values(&factor.unwrap())
                };
                assert_eq!(after(&changed), anew);
                assert_ne!(after(&changed[..1]), anew, "control");
                assert_ne!(values(&before), anew, "the factor before is kept by who has it");
            });
        }
    }

    #[test]
    fn a_tangent_after_another_has_to_the_last_bit_the_factor_that_it_has_by_itself() {
        with_system(Degree::Two, 24, |system| {
            let springs = |stiff: &dyn Fn(usize) -> bool| {
                let pieces = 0..system.d.contact.len();
                let of = |e: usize| DMatrix::identity(3, 3) * if stiff(e) { 2.0 } else { 0.0 };
                pieces.map(of).collect::<Vec<DMatrix<f64>>>()
            };
            let (old, new) = (springs(&|e| e < 9), springs(&|e| e < 11));
            let solved = |last: Option<Factored>, springs: Vec<DMatrix<f64>>| {
                let mut x = vec![1.0; system.numbering.count];
                system.factor(last, springs).unwrap().factor.solve(&mut x);
                x
            };
            let before = system.factor(None, old.clone()).unwrap();
            let (own, kept) = (solved(None, new.clone()), solved(Some(before.clone()), old));
            assert_eq!(solved(Some(before), new), own);
            assert_ne!(kept, own, "control");
        });
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factor() {
        for n in [5, 48] {
            with_system(Degree::One, n, |system| {
                for entry in [-1.0, f64::NAN] {
                    let mut other = system.matrix.clone();
                    other.values[system.matrix.starts[system.numbering.count - 1]] = entry;
                    let factor = Factor::with(&system.structure, &other);
                    assert_eq!(factor.err(), Some(SolveError::NotPositiveDefinite));
                }
            });
        }
    }
}
