//! Singular values and projections for few columns, as accurate as their data: a part of the body has three rigid motions. faer
//! has both, in 48 lines less, for 6 of the 121 seconds that a release build compiles this crate for (bidiagonal forms, divide and
//! conquer, QR) and 2 % of the program.

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

    use super::*;

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
}
