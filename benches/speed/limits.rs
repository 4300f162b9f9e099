//! How far the factorisation is from what the machine can do.

use std::time::{Duration, Instant};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::matmul::matmul;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::simplicial::{
    prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch,
};
use faer::{Accum, Mat, Par};
use signorini::linear::factor::Factor;
use signorini::linear::matrix::{LowerTriangle, Neighbours};

use crate::own::{Measured, squares};
use crate::problem::{self, Size};
use crate::table::{table, three, time};

/// The matrix of the body without contact.
fn body(Size { degree, n }: Size) -> LowerTriangle {
    let problem = problem::block(n);
    let d = &problem::without_contact(&problem, degree);
    let neighbours = Neighbours::new(&d.space);
    problem::matrix(d, &neighbours, &problem::dissect(d, &neighbours)).1
}

fn pattern(matrix: &LowerTriangle) -> SymbolicSparseColMatRef<'_, usize> {
    let n = matrix.starts.len() - 1;
    SymbolicSparseColMatRef::new_checked(n, n, &matrix.starts, None, &matrix.rows)
}

/// The operations of a Cholesky factorisation without any that meet a zero: the sum of the squared column counts of L.
fn operations(matrix: &LowerTriangle) -> f64 {
    let lower = pattern(matrix);
    let n = lower.ncols();
    let upper = lower.transpose().to_col_major().expect("memory");
    let entries = matrix.rows.len();
    let mut memory = MemBuffer::new(prefactorize_symbolic_cholesky_scratch::<usize>(n, entries));
    let (mut etree, mut counts) = (vec![0_isize; n], vec![0_usize; n]);
    let stack = MemStack::new(&mut memory);
    prefactorize_symbolic_cholesky(&mut etree, &mut counts, upper.as_ref(), stack);
    counts.iter().map(|&c| (c * c) as f64).sum()
}

/// Operations per second of faer's dense product, one thread.
fn dense_peak() -> f64 {
    const SIZE: usize = 1024;
    let a = Mat::from_fn(SIZE, SIZE, |i, j| (i + 2 * j) as f64 / SIZE as f64);
    let mut c = Mat::zeros(SIZE, SIZE);
    let least = (0..10)
        .map(|_| {
            let start = Instant::now();
            matmul(c.as_mut(), Accum::Replace, a.as_ref(), a.as_ref(), 1.0, Par::Seq);
            start.elapsed()
        })
        .min()
        .unwrap_or_default();
    2.0 * (SIZE as f64).powi(3) / least.as_secs_f64()
}

/// (v)
pub fn table_of_limits(n: usize, repetitions: usize, own: &[Measured]) -> String {
    let peak = dense_peak();
    let rows: Vec<Vec<String>> = [1, 2]
        .map(|degree| Size { degree, n })
        .into_iter()
        .map(|size @ Size { degree, .. }| {
            let matrix = body(size);
            let (least, factor) = least_factor(&matrix, repetitions);
            let rate = operations(&matrix) / least.as_secs_f64();
            let unknowns = size.unknowns() as f64;
            let factor = 8.0 * factor.stored_entries() as f64 / unknowns;
            let memory = squares(own, degree)
                .find(|m| m.unknowns == size.unknowns())
                .map(|m| m.memory / unknowns);
            vec![
                format!("P{}", size.degree),
                three(operations(&matrix) / 1e9),
                time(least),
                three(rate / 1e9),
                format!("{:.0} %", 100.0 * rate / peak),
                format!("{factor:.0}"),
                memory.map_or("not measured".to_owned(), |m| format!("{m:.0}")),
                memory.map_or("not measured".to_owned(), |m| three(m / factor)),
            ]
        })
        .collect();
    let head =
        ["", "10^9 operations", "time", "10^9 / s", "of the peak", "L", "solve", "solve / L"];
    format!(
        "## Distance to the limit

The sparse factorisation at n = {n}, analysis included, against faer's dense product of matrices of order 1024:
{} x 10^9 operations per second on one thread. Operations are the sum of the squared column counts of L; L and the contact solve at its peak
in bytes for each unknown.

{}",
        three(peak / 1e9),
        table(&head, &rows)
    )
}

/// What was measured and not built.
pub const LEFT_OUT: &str = "## Tried, and left out

- Two threads in the sparse factorisation (rayon): n = 128 takes 2.2 times as long, n = 512 1.3 times: supernodes are too small to share.
- faer's minimum degree in place of nested dissection: at n = 256 order, analysis and factorisation take 1.8 times as long.
- No correction where the first pass is accurate enough: 4 to 8 % less time, but forces balance to 1e-12 and not to 1e-15, and
  enclosures are ten times as wide.
- Fused products in the loops of the factor: 2 % fewer instructions of it at n = 256, but of 25 nearly incompressible blocks that fall far
  6 converge, and all without.
- Softer springs once more where the first steps from the start by some pieces are cut short: the graded square takes 47 steps in
  place of 49 of P2, but 17 in place of 12 of P1.
- The stiffness of contact at the start by the energies of the last step in place of two steps of the power method: 2 % fewer instructions on
  the strip of P1, but 2,000 random bodies take 20,797 steps in place of 20,640, and the one that takes most 142 in place of 110.
- Lists of a piece without an allocation for each (smallvec): 2 % fewer instructions on the strip of P1, in no less time.
- AVX-512 in products (`x86-v4` of gemm, nano-gemm and pulp): 4 to 6 % less time at n = 128, none on the strip, and every product is compiled twice.
- Large pages for a factor below four megabytes, too: a first solve of the strip of P1 takes 5 % less time, further ones 2 % more.
";

fn least_factor(matrix: &LowerTriangle, repetitions: usize) -> (Duration, Factor) {
    let mut least = Duration::MAX;
    let mut last = None;
    for _ in 0..repetitions {
        drop(last.take());
        let start = Instant::now();
        last = Some(Factor::new(matrix).expect("a clamped body"));
        least = least.min(start.elapsed());
    }
    (least, last.expect("at least one repetition"))
}
