//! Solutions of A z = b for several functionals b at once, each with a bound of what is left of b in the dual norm of A: the columns of the
//! compliance (docs/theory.md, 13.6). A is assembled in balls. Its products are double-doubles, the sums of the tails doubles; what
//! they are off by has bounds that take a product with |z| (docs/a-posteriori.md, 7.5).

use super::balls::root;
use crate::kernel::DoubleDouble;
use crate::kernel::ball::{PreciseBall, up};
use crate::linear::factor::Factor;
use crate::linear::matrix::LowerTriangle;
use crate::linear::on_this_processor;

/// The number of solves for a column: each takes off as many digits as the factor has.
const MOST_CORRECTIONS: usize = 8;

/// The entries of a functional that are not zero, each with its unknown.
pub(super) type Functional = Vec<(usize, PreciseBall)>;

/// The number of columns that are best solved at once: what they have of a vector is in the caches of the processor.
pub(super) const AT_ONCE: usize = 32;

/// A, with |t|_A* <= the sum of `crude` times |t_i|.
pub(super) struct Enclosed<'a> {
    a: &'a LowerTriangle<PreciseBall>,
    crude: &'a [f64],
    /// Bounds beside |t_i| of what a product with a vector is off by, in the dual norm: of each entry of the vector, and of each of what the
    /// product is subtracted from.
    of_factor: Vec<f64>,
    rounding: f64,
    underflow: f64,
}

impl<'a> Enclosed<'a> {
    pub(super) fn new(a: &'a LowerTriangle<PreciseBall>, crude: &'a [f64]) -> Self {
        let count = crude.len();
        let mut terms = vec![4_usize; count];
        each_entry(a, |i, _, _| terms[i] += 1);
        let most = terms.into_iter().max().unwrap_or(0) as f64;
        // With n terms and u half of f64::EPSILON, the tails' sum is off by 2 (n + 2)^2 u^2 of the magnitudes, and 2 (n + 4)^2 u^2 are to spare
        // for the sums z.
        let rounding = most * most * f64::EPSILON * f64::EPSILON;
        let mut of_factor = vec![0.0; count];
        each_entry(a, |i, j, a| {
            of_factor[j] += crude[i] * (a.radius() + rounding * a.magnitude());
        });
        let safe = |of: f64| of * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        let of_factor = of_factor.into_iter().map(safe).collect();
        let underflow = f64::MIN_POSITIVE * (count as f64 + most * crude.iter().sum::<f64>());
        Enclosed { a, crude, of_factor, rounding, underflow }
    }

    /// Columns z near A^-1 b for functionals b, and bounds of |b - A z|_A*, which are `share` of |b|_A* at most, or as small as they get;
    /// what is no number is no bound.
    pub(super) fn columns(&self, factor: &Factor, all: &[Functional], share: f64) -> Columns {
        let (count, n) = (all.len(), self.crude.len());
        let mut z = Columns { z: vec![DoubleDouble::from(0); n * count], rests: Vec::new() };
        let mut left = Left { heads: vec![0.0; n * count], tails: vec![0.0; n * count] };
        let mut off = vec![0.0; count];
        for (column, functional) in all.iter().enumerate() {
            for &(k, b) in functional {
                let (at, middle) = (k * count + column, b.centre());
                (left.heads[at], left.tails[at]) = (middle.head(), middle.tail());
                off[column] += self.crude[k] * b.radius() * (1.0 + 1e-9) + f64::MIN_POSITIVE;
            }
        }
        let mut size = self.sizes(&left, count);
        z.rests = vec![f64::INFINITY; count];
        let mut goes_on = vec![true; count];
        // Solves, and corrects by the residual as long as that leads on.
        for _ in 0..MOST_CORRECTIONS {
            let mut c = left.heads.clone();
            for c in c.chunks_exact_mut(count) {
                c.iter_mut().zip(&goes_on).filter(|(_, on)| !**on).for_each(|(c, _)| *c = 0.0);
            }
            factor.solve_columns(&mut c, count);
            on_this_processor!(subtract_product(self.a, &c, &mut left, count));
            let mut moved = vec![0.0; count];
            let rows = z.z.chunks_exact_mut(count).zip(c.chunks_exact(count));
            for ((z, c), by) in rows.zip(&self.of_factor) {
                for ((z, c), moved) in z.iter_mut().zip(c).zip(&mut moved) {
                    *z += DoubleDouble::from(*c);
                    *moved += by * (c.abs() + z.head().abs());
                }
            }
            let next_size = self.sizes(&left, count);
            for column in 0..count {
                if goes_on[column] {
                    let more = self.rounding * size[column] + moved[column] * (1.0 + 1e-9);
                    off[column] = up(off[column] + up(more + self.underflow));
                    let next = up(next_size[column] + off[column]);
                    let enough = share * root(z.value(column, &all[column]));
                    goes_on[column] = next < z.rests[column] / 2.0 && !(next <= enough);
                    z.rests[column] = next;
                }
            }
            if !goes_on.contains(&true) {
                break;
            }
            size = next_size;
        }
        z
    }

    /// |t|_A*, at most.
    fn sizes(&self, t: &Left, count: usize) -> Vec<f64> {
        let mut sizes = vec![0.0; count];
        let rows = t.heads.chunks_exact(count).zip(t.tails.chunks_exact(count));
        for ((heads, tails), crude) in rows.zip(self.crude) {
            for ((size, head), tail) in sizes.iter_mut().zip(heads).zip(tails) {
                *size += crude * (head.abs() + tail.abs());
            }
        }
        let n = self.crude.len();
        let rounding = 1.0 + f64::EPSILON * (n + 16) as f64;
        sizes.iter_mut().for_each(|size| *size = *size * rounding + f64::MIN_POSITIVE * n as f64);
        sizes
    }
}

/// Columns, row by row.
pub(super) struct Columns {
    z: Vec<DoubleDouble>,
    /// A bound of what is left of each functional.
    pub(super) rests: Vec<f64>,
}

impl Columns {
    /// The value of a functional at a column.
    pub(super) fn value(&self, column: usize, of: &Functional) -> PreciseBall {
        let count = self.rests.len();
        of.iter().fold(PreciseBall::from(0), |sum, &(k, b)| {
            sum + b * PreciseBall::point(self.z[k * count + column])
        })
    }
}

/// Calls `f` with the row, the column and the entry of both triangles.
#[inline(always)]
fn each_entry(a: &LowerTriangle<PreciseBall>, mut f: impl FnMut(usize, usize, PreciseBall)) {
    for (j, ends) in a.starts.windows(2).enumerate() {
        for k in ends[0]..ends[1] {
            let (i, entry) = (a.rows[k], a.values[k]);
            f(i, j, entry);
            if i != j {
                f(j, i, entry);
            }
        }
    }
}

/// Residuals of functionals, row by row: heads plus tails.
struct Left {
    heads: Vec<f64>,
    tails: Vec<f64>,
}

/// Subtracts A c for `count` columns.
#[inline(always)]
fn subtract_product(a: &LowerTriangle<PreciseBall>, c: &[f64], left: &mut Left, count: usize) {
    let row = |i: usize| i * count..(i + 1) * count;
    let Left { heads, tails } = left;
    each_entry(
        a,
        #[inline(always)]
        |i, j, a| subtract(&mut heads[row(i)], &mut tails[row(i)], a.centre(), &c[row(j)]),
    );
    for (head, tail) in heads.iter_mut().zip(tails) {
        let sum = DoubleDouble::sum(*head, *tail);
        (*head, *tail) = (sum.head(), sum.tail());
    }
}

/// Subtracts a c: sums of heads and products are exact, those of the rest are rounded.
#[inline(always)]
fn subtract(heads: &mut [f64], tails: &mut [f64], a: DoubleDouble, c: &[f64]) {
    let (a_head, a_tail) = (a.head(), a.tail());
    for ((head, tail), c) in heads.iter_mut().zip(tails).zip(c) {
        let product = a_head * c;
        let of_product = a_tail.mul_add(*c, a_head.mul_add(*c, -product));
        let sum = DoubleDouble::sum(*head, -product);
        *head = sum.head();
        *tail += sum.tail() - of_product;
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::contact::{Discretization, EdgeRule, residual};
    use crate::kernel::{Material, Plane};
    use crate::linear::system::System;
    use crate::model::{Condition, Degree, Diagonal, Problem, Rectangle};
    use crate::proof::balls::{Lines, field, free};

    fn with_system(degree: Degree, f: impl FnOnce(&System, &Lines)) {
        let square = Rectangle { width: 1.0, height: 1.0, nx: 4, ny: 3, diagonal: Diagonal::Right };
        let problem = Problem::of(square.mesh().unwrap(), Material::lame(1.0, 1.0, Plane::Strain))
            .with("top", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.0));
        let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact);
        let d = d.unwrap();
        f(&System::new(&d).unwrap(), &Lines::new(&d));
    }

    /// Springs, of which no two on a piece are alike.
    fn springs(lines: &Lines, times: f64) -> Vec<DMatrix<PreciseBall>> {
        let entry = |i: usize, j: usize| PreciseBall::from(times / (1 + i + j) as f64);
        let of = |count: usize| DMatrix::from_fn(count, count, entry);
        lines.iter().map(|piece| of(piece.p0.len())).collect()
    }

    fn times(a: &LowerTriangle<PreciseBall>, z: &[PreciseBall]) -> Vec<PreciseBall> {
        let mut product = vec![PreciseBall::from(0); z.len()];
        each_entry(a, |i, j, a| product[i] += a * z[j]);
        product
    }

    #[test]
    fn the_matrix_in_balls_is_that_of_the_form_with_its_springs() {
        for degree in [Degree::One, Degree::Two] {
            with_system(degree, |system, lines| {
                let number = |i: usize| PreciseBall::from((1.7 * i as f64).sin());
                let z: Vec<PreciseBall> = (0..system.numbering.count).map(number).collect();
                let v = field(system, |number, _, _| z[number], |_, _| 0.0);
                let mut forces = vec![[PreciseBall::from(0); 2]; v.len()];
                let (space, material) = (&system.d.space, &system.d.problem.material);
                residual::add_internal_forces(space, material, &v, &mut forces);
                for (piece, h) in lines.iter().zip(springs(lines, 2.0)) {
                    piece.add_stresses(&v, &mut forces);
                    let p0 = piece.p0(&v);
                    let row = |i: usize| {
                        p0.iter()
                            .enumerate()
                            .fold(PreciseBall::from(0), |sum, (j, &p)| sum + h[(i, j)] * p)
                    };
                    piece.add_contact(&(0..p0.len()).map(row).collect::<Vec<_>>(), &mut forces);
                }
                let by_form = free(system, &forces);
                let differ = |stiff: f64| {
                    let a = system.tangent_in_balls(lines.iter(), &springs(lines, stiff)).unwrap();
                    let pairs = times(&a, &z).into_iter().zip(&by_form);
                    let off = pairs.map(|(a, &b)| (a - b).least_magnitude());
                    off.fold(0.0, f64::max)
                };
                assert_eq!(differ(2.0), 0.0);
                assert!(differ(2.0 + 1e-12) > 1e-16, "control");
            });
        }
    }

    #[test]
    fn the_size_of_what_is_left_is_that_of_its_heads_and_tails() {
        with_system(Degree::One, |system, lines| {
            let n = system.numbering.count;
            let a = system.tangent_in_balls(lines.iter(), &springs(lines, 0.0)).unwrap();
            let crude: Vec<f64> = (0..n).map(|i| 1.0 + (i % 7) as f64).collect();
            let of = Enclosed::new(&a, &crude);
            let number = |k: usize| (1.7 * k as f64).sin();
            let numbers: Vec<f64> = (0..2 * n).map(number).collect();
            let zero = vec![0.0; 2 * n];
            for (heads, tails) in [(numbers.clone(), zero.clone()), (zero, numbers)] {
                let found = of.sizes(&Left { heads, tails }, 2);
                for (column, found) in found.into_iter().enumerate() {
                    let size = |i: usize| crude[i] * number(2 * i + column).abs();
                    let expected: f64 = (0..n).map(size).sum();
                    assert!(found >= expected && found < (1.0 + 1e-12) * expected);
                }
            }
        });
    }

    #[test]
    fn what_is_left_of_a_functional_is_no_more_for_any_matrix_in_the_balls_and_is_attained() {
        with_system(Degree::Two, |system, lines| {
            let n = system.numbering.count;
            let factor = Factor::with(&system.structure, &system.matrix).unwrap();
            let mut a = system.tangent_in_balls(lines.iter(), &springs(lines, 0.0)).unwrap();
            let exact = a.clone();
            let crude: Vec<f64> = (0..n).map(|i| 1.0 + (i % 7) as f64).collect();
            let one = PreciseBall::from(1);
            let all: Vec<Functional> =
                vec![vec![(n / 3, one)], vec![(0, one), (n - 1, one / PreciseBall::from(3))]];
            let left = |a: &LowerTriangle<PreciseBall>, z: &Columns, column: usize| -> f64 {
                let at = |k: usize| PreciseBall::point(z.z[k * all.len() + column]);
                let mut left = times(a, &(0..n).map(at).collect::<Vec<_>>());
                all[column].iter().for_each(|&(k, b)| left[k] -= b);
                left.iter().zip(&crude).map(|(t, c)| c * t.least_magnitude()).sum()
            };
            // Corrected as far as that leads on.
            let z = Enclosed::new(&a, &crude).columns(&factor, &all, 0.0);
            for column in 0..all.len() {
                let (left, rest) = (left(&exact, &z, column), z.rests[column]);
                assert!(left <= rest && rest < 1e-20, "{left} {rest}");
            }
            let by = |a: PreciseBall| 1e-6 * a.head().abs();
            a.values.iter_mut().for_each(|a| *a = a.widened(by(*a)));
            let z = Enclosed::new(&a, &crude).columns(&factor, &all, 1.0);
            for column in 0..all.len() {
                // All that the entries of a matrix can be off adds up.
                let farthest = |share: f64| {
                    let mut other = exact.clone();
                    for (j, ends) in exact.starts.windows(2).enumerate() {
                        for k in ends[0]..ends[1] {
                            let sign = |k: usize| z.z[k * all.len() + column].head().signum();
                            let off = share * sign(exact.rows[k]) * sign(j) * by(exact.values[k]);
                            other.values[k] += PreciseBall::from(off);
                        }
                    }
                    left(&other, &z, column)
                };
                let rest = z.rests[column];
                assert!(farthest(0.99) <= rest, "{} {rest}", farthest(0.99));
                assert!(farthest(2.1) > rest, "control: {} {rest}", farthest(2.1));
            }
        });
    }
}
