//! The numbers of the sparse Cholesky factor L of H = L L^T in its [structure](super::factor::Structure), supernode by supernode,
//! looking to the left, and the substitutions with it. Small supernodes, most of all in number, are done in tiles of a constant size, some rows by
//! some columns, whose sums stay in the registers of the processor; large ones by faer. faer's own supernodal factorisation calls its
//! packed products for each: on a strip, where a product has a hundred terms, that takes several times as many instructions.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, Scalar, Simd, WithSimd};

use super::factor::Structure;
use crate::linear::cholesky;
use crate::linear::matrix::LowerTriangle;
use crate::solve::SolveError;

/// Multiplications with an addition from which a packed product takes less time than tiles.
const PACKED: usize = 16384;

/// Columns of a supernode from which its block on the diagonal is left to faer.
const WIDE: usize = 32;

/// The numbers in a vector, at most.
const MOST_LANES: usize = 8;

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

/// Runs through columns in steps of 4, and at the end of 2 and 1: loops of a body over so many, a constant, become a few instructions
/// each.
macro_rules! in_columns {
    ($C:ident at $j:ident in ($from:expr, $to:expr) => $body:expr) => {{
        let (mut next, to) = ($from, $to);
        in_columns!(4, $C at $j in (next, to) => $body);
        in_columns!(2, $C at $j in (next, to) => $body);
        in_columns!(1, $C at $j in (next, to) => $body);
    }};
    ($step:literal, $C:ident at $j:ident in ($next:ident, $to:ident) => $body:expr) => {{
        const $C: usize = $step;
        while $next + $C <= $to {
            let $j = $next;
            $body;
            $next += $C;
        }
    }};
}

/// Runs through rows two vectors at a time, and at the end one, and then row by row.
macro_rules! in_rows {
    ($simd:ident, $V:ident at $i:ident in ($from:expr, $to:expr) => $body:expr) => {{
        let (mut next, to) = ($from, $to);
        in_rows!(2, $simd, $V at $i in (next, to) => $body);
        in_rows!(1, $simd, $V at $i in (next, to) => $body);
        let $simd = Scalar::new();
        in_rows!(1, $simd, $V at $i in (next, to) => $body);
    }};
    ($vectors:literal, $simd:ident, $V:ident at $i:ident in ($next:ident, $to:ident) => $body:expr) => {{
        const $V: usize = $vectors;
        let step = $V * lanes($simd);
        while $next + step <= $to {
            let $i = $next;
            $body;
            $next += step;
        }
    }};
}

/// The numbers in a vector.
#[inline(always)]
fn lanes<S: Simd>(_: S) -> usize {
    S::F64_LANES
}

/// V vectors, from a list.
#[inline(always)]
fn load<S: Simd, const V: usize>(_: S, from: &[f64]) -> [S::f64s; V] {
    let (vectors, _) = S::as_simd_f64s(&from[..V * S::F64_LANES]);
    std::array::from_fn(|v| vectors[v])
}

/// Writes vectors into a list.
#[inline(always)]
fn store<S: Simd, const V: usize>(_: S, to: &mut [f64], vectors: [S::f64s; V]) {
    S::as_mut_simd_f64s(&mut to[..V * S::F64_LANES]).0.copy_from_slice(&vectors);
}

/// x <- x + y b
#[inline(always)]
fn add_product<S: Simd, const V: usize>(simd: S, x: &mut [S::f64s; V], y: &[S::f64s; V], b: f64) {
    let b = simd.splat_f64s(b);
    for v in 0..V {
        x[v] = simd.add_f64s(x[v], simd.mul_f64s(y[v], b));
    }
}

struct Factorisation<'a, F> {
    structure: &'a Structure,
    matrix: &'a LowerTriangle,
    values: &'a mut [f64],
    /// Tells whether a supernode is to be computed.
    stale: F,
}

impl<F: Fn(usize) -> bool> WithSimd for Factorisation<'_, F> {
    type Output = Result<(), SolveError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
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
                    let values = &left[structure.start(d)..structure.start(d) + of_d * width];
                    let (source, from) = (Block { values, rows: of_d }, width + used[d]);
                    source.subtract_square(
                        simd,
                        (from, inside),
                        &local,
                        (&mut *block, rows),
                        &mut sums,
                    );
                }
                used[d] += inside;
                if let Some(&row) = pattern.get(inside) {
                    let ancestor = structure.supernode_of(row);
                    (next[d], first[ancestor]) = (first[ancestor], d);
                }
                d = following;
            }
            if is_stale {
                cholesky(simd, block, rows, width)?;
            }
            if let Some(&row) = below.first() {
                let parent = structure.supernode_of(row);
                (next[s], first[parent]) = (first[parent], s);
            }
        }
        Ok(())
    }
}

/// Columns of a block of L, one after the other, each with this many rows.
#[derive(Clone, Copy)]
struct Block<'a> {
    values: &'a [f64],
    rows: usize,
}

impl Block<'_> {
    /// The products of its rows in V vectors from `i` on with C of its rows from `j` on: sums over its columns, so few that a
    /// processor keeps them at hand.
    #[inline(always)]
    fn tile<S: Simd, const V: usize, const C: usize>(
        self,
        simd: S,
        [i, j]: [usize; 2],
    ) -> [[S::f64s; V]; C] {
        let mut sums = [[simd.splat_f64s(0.0); V]; C];
        for column in self.values.chunks_exact(self.rows) {
            let (a, b) = (load(simd, &column[i..]), &column[j..j + C]);
            for c in 0..C {
                add_product(simd, &mut sums[c], &a, b[c]);
            }
        }
        sums
    }

    /// Subtracts the lower triangle of the product of its rows `from` on and the transposed first ones of them, `inside` in number,
    /// from a block of so many rows; `local` are the places of the rows there.
    #[inline(always)]
    fn subtract_square(
        self,
        simd: impl Simd,
        (from, inside): (usize, usize),
        local: &[usize],
        (block, rows): (&mut [f64], usize),
        sums: &mut Vec<f64>,
    ) {
        let (height, width) = (local.len(), self.values.len() / self.rows);
        if height * inside * width < PACKED {
            in_columns!(C at j in (0, inside) => {
                in_rows!(simd, V at i in (j, height) => {
                    let products = self.tile::<_, V, C>(simd, [from + i, from + j]);
                    for c in 0..C {
                        let column = &mut block[local[j + c] * rows..][..rows];
                        let mut product = [0.0; 2 * MOST_LANES];
                        store(simd, &mut product, products[c]);
                        let places = &local[i..i + V * lanes(simd)];
                        for r in (j + c).saturating_sub(i)..places.len() {
                            column[places[r]] -= product[r];
                        }
                    }
                });
            });
            return;
        }
        sums.resize((height * inside).max(sums.len()), 0.0);
        let sums = &mut sums[..height * inside];
        let source = MatRef::from_column_major_slice(self.values, self.rows, width);
        let (top, bottom) = source.subrows(from, height).split_at_row(inside);
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

/// The block of a supernode: its lower triangle on the diagonal becomes its Cholesky factor, the rows below are divided by that.
#[inline(always)]
fn cholesky(
    simd: impl Simd,
    block: &mut [f64],
    rows: usize,
    width: usize,
) -> Result<(), SolveError> {
    if width >= WIDE {
        return wide_cholesky(block, rows, width);
    }
    in_columns!(C at k in (0, width) => panel::<_, C>(simd, block, rows, k)?);
    Ok(())
}

/// C columns of L from column `k` on, in a block of so many rows whose columns before are done.
#[inline(always)]
fn panel<S: Simd, const C: usize>(
    simd: S,
    block: &mut [f64],
    rows: usize,
    k: usize,
) -> Result<(), SolveError> {
    let (left, own) = block.split_at_mut(k * rows);
    let left = Block { values: left, rows };
    let mut top = [[0.0; C]; C];
    let mut inverse = [0.0; C];
    for c in 0..C {
        for r in c..C {
            let [[product]] = left.tile::<_, 1, 1>(Scalar::new(), [k + r, k + c]);
            top[c][r] = own[c * rows + k + r] - product;
            for d in 0..c {
                top[c][r] -= top[d][r] * top[d][c];
            }
        }
        // A NaN is not positive.
        if !(top[c][c] > 0.0) {
            return Err(SolveError::NotPositiveDefinite);
        }
        top[c][c] = top[c][c].sqrt();
        inverse[c] = 1.0 / top[c][c];
        top[c][c + 1..].iter_mut().for_each(|entry| *entry *= inverse[c]);
        own[c * rows + k + c..][..C - c].copy_from_slice(&top[c][c..]);
    }
    in_rows!(simd, V at i in (k + C, rows) => {
        let mut x = left.tile::<_, V, C>(simd, [i, k]);
        for c in 0..C {
            let column = &mut own[c * rows + i..];
            let entries = load::<_, V>(simd, column);
            for d in 0..c {
                let done = x[d];
                add_product::<_, V>(simd, &mut x[c], &done, top[d][c]);
            }
            let inverse = simd.splat_f64s(inverse[c]);
            for v in 0..V {
                x[c][v] = simd.mul_f64s(simd.sub_f64s(entries[v], x[c][v]), inverse);
            }
            store(simd, column, x[c]);
        }
    });
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

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Forward { structure, values, x } = self;
        let mut local = Vec::new();
        for s in 0..structure.supernodes() {
            let [rows, width] = structure.shape(s);
            let block = &values[structure.start(s)..][..rows * width];
            let (columns, below) = (structure.columns(s), structure.rows_below(s));
            local.clear();
            local.extend_from_slice(&x[columns.clone()]);
            local.resize(rows, 0.0);
            in_columns!(C at k in (0, width) => {
                let panel = &block[k * rows..(k + C) * rows];
                let mut own = [0.0; C];
                for c in 0..C {
                    own[c] = local[k + c];
                    for d in 0..c {
                        own[c] -= panel[d * rows + k + c] * own[d];
                    }
                    own[c] /= panel[c * rows + k + c];
                }
                local[k..k + C].copy_from_slice(&own);
                in_rows!(simd, V at i in (k + C, rows) => {
                    let mut sums = load::<_, V>(simd, &local[i..]);
                    for c in 0..C {
                        add_product(simd, &mut sums, &load(simd, &panel[c * rows + i..]), -own[c]);
                    }
                    store(simd, &mut local[i..], sums);
                });
            });
            x[columns].copy_from_slice(&local[..width]);
            for (&row, change) in below.iter().zip(&local[width..]) {
                x[row] += change;
            }
        }
    }
}

struct Backward<'a> {
    structure: &'a Structure,
    values: &'a [f64],
    x: &'a mut [f64],
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Backward { structure, values, x } = self;
        let mut local = Vec::new();
        for s in (0..structure.supernodes()).rev() {
            let [rows, width] = structure.shape(s);
            let block = &values[structure.start(s)..][..rows * width];
            local.clear();
            local.extend_from_slice(&x[structure.columns(s)]);
            local.extend(structure.rows_below(s).iter().map(|&row| x[row]));
            in_columns!(C at done in (0, width) => {
                let k = width - C - done;
                let panel = &block[k * rows..(k + C) * rows];
                let mut own = [0.0; C];
                in_rows!(simd, V at i in (k + C, rows) => {
                    let known = load::<_, V>(simd, &local[i..]);
                    for c in 0..C {
                        let column = load::<_, V>(simd, &panel[c * rows + i..]);
                        let mut products = simd.splat_f64s(0.0);
                        for v in 0..V {
                            products = simd.add_f64s(products, simd.mul_f64s(column[v], known[v]));
                        }
                        own[c] += simd.reduce_sum_f64s(products);
                    }
                });
                for c in (0..C).rev() {
                    own[c] = local[k + c] - own[c];
                    for d in c + 1..C {
                        own[c] -= panel[c * rows + k + d] * own[d];
                    }
                    own[c] /= panel[c * rows + k + c];
                }
                local[k..k + C].copy_from_slice(&own);
            });
            x[structure.columns(s)].copy_from_slice(&local[..width]);
        }
    }
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
