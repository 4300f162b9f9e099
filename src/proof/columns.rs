//! Solutions of A z = b for several functionals b at once, each with a bound of what is left of b in the dual norm of A: the columns of the
//! compliance (docs/theory.md, 13.6). A is assembled in balls. Its products are double-doubles, the sums of the tails doubles; what
//! they are off by has bounds that take a product with |z| (docs/a-posteriori.md, 7.5).

use std::array::from_fn;

use super::balls::root;
use crate::kernel::DoubleDouble;
use crate::kernel::ball::{PreciseBall, up};
use crate::linear::factor::{Factor, LANES, Lanes};
use crate::linear::matrix::LowerTriangle;
use crate::linear::on_this_processor;

/// The number of solves for a column: each takes off as many digits as the factor has.
const MOST_CORRECTIONS: usize = 8;

/// The entries of a functional that are not zero, each with its unknown.
pub(super) type Functional = Vec<(usize, PreciseBall)>;

/// An unknown of each column.
type Fine = [DoubleDouble; LANES];

/// The value of a functional at a column.
pub(super) fn value(of: &Functional, z: &[Fine], lane: usize) -> PreciseBall {
    of.iter().fold(PreciseBall::from(0), |sum, &(k, b)| sum + b * PreciseBall::point(z[k][lane]))
}

/// A, with |t|_A* <= the sum of `crude` times |t_i|.
pub(super) struct Enclosed<'a> {
    /// The middles of its entries.
    middle: LowerTriangle<PreciseBall>,
    crude: &'a [f64],
    /// Bounds beside |t_i| of what a product with a vector is off by, in the dual norm: of each entry of the vector, and of each of what the
    /// product is subtracted from.
    of_factor: Vec<f64>,
    rounding: f64,
    underflow: f64,
}

impl<'a> Enclosed<'a> {
    pub(super) fn new(a: LowerTriangle<PreciseBall>, crude: &'a [f64]) -> Self {
        let count = crude.len();
        let mut terms = vec![4_usize; count];
        each_entry(&a, |i, _, _| terms[i] += 1);
        let most = terms.into_iter().max().unwrap_or(0) as f64;
        // With n terms and u half of f64::EPSILON, the tails' sum is off by 2 (n + 2)^2 u^2 of the magnitudes, and 2 (n + 4)^2 u^2 are to spare
        // for the sums z.
        let rounding = most * most * f64::EPSILON * f64::EPSILON;
        let mut of_factor = vec![0.0; count];
        each_entry(&a, |i, j, a| {
            of_factor[j] += crude[i] * (a.radius() + rounding * a.magnitude());
        });
        let safe = |of: f64| of * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        let of_factor = of_factor.into_iter().map(safe).collect();
        let underflow = f64::MIN_POSITIVE * (count as f64 + most * crude.iter().sum::<f64>());
        Enclosed { middle: a, crude, of_factor, rounding, underflow }
    }

    /// Columns z near A^-1 b for up to [`LANES`] functionals b, and bounds of |b - A z|_A*, which are `share` of |b|_A* at most, or as small as
    /// they get; what is no number is no bound.
    pub(super) fn columns(
        &self,
        factor: &Factor,
        all: &[Functional],
        share: f64,
    ) -> (Vec<Fine>, Lanes) {
        let mut z = vec![[DoubleDouble::from(0); LANES]; self.crude.len()];
        let mut left = vec![[[0.0; LANES]; 2]; z.len()];
        let mut off = [0.0; LANES];
        for (lane, functional) in all.iter().enumerate() {
            for &(k, b) in functional {
                let middle = b.centre();
                (left[k][0][lane], left[k][1][lane]) = (middle.head(), middle.tail());
                off[lane] += self.crude[k] * b.radius() * (1.0 + 1e-9) + f64::MIN_POSITIVE;
            }
        }
        let mut size = self.sizes(&left);
        let mut rest = [f64::INFINITY; LANES];
        let mut goes_on: [bool; LANES] = from_fn(|lane| lane < all.len());
        // Solves, and corrects by the residual as long as that leads on.
        for _ in 0..MOST_CORRECTIONS {
            let head = |[head, _]: &[Lanes; 2]| -> Lanes {
                from_fn(|lane| if goes_on[lane] { head[lane] } else { 0.0 })
            };
            let mut c: Vec<Lanes> = left.iter().map(head).collect();
            factor.solve_lanes(&mut c);
            on_this_processor!(subtract_product(&self.middle, &c, &mut left));
            let mut moved = [0.0; LANES];
            for ((z, c), &by) in z.iter_mut().zip(&c).zip(&self.of_factor) {
                for lane in 0..LANES {
                    z[lane] = z[lane] + DoubleDouble::sum(c[lane], 0.0);
                    moved[lane] += by * (c[lane].abs() + z[lane].head().abs());
                }
            }
            let next_size = self.sizes(&left);
            let c_is_asked = goes_on;
            for lane in (0..all.len()).filter(|&lane| c_is_asked[lane]) {
                let more = self.rounding * size[lane] + moved[lane] * (1.0 + 1e-9);
                off[lane] = up(off[lane] + up(more + self.underflow));
                let next = up(next_size[lane] + off[lane]);
                let enough = share * root(value(&all[lane], &z, lane));
                goes_on[lane] = next < rest[lane] / 2.0 && !(next <= enough);
                rest[lane] = next;
            }
            if !goes_on.contains(&true) {
                break;
            }
            size = next_size;
        }
        (z, rest)
    }

    /// |t|_A*, at most.
    fn sizes(&self, t: &[[Lanes; 2]]) -> Lanes {
        let mut sizes = [0.0; LANES];
        for ([head, tail], crude) in t.iter().zip(self.crude) {
            for lane in 0..LANES {
                sizes[lane] += crude * (head[lane].abs() + tail[lane].abs());
            }
        }
        let rounding = 1.0 + f64::EPSILON * (t.len() + 16) as f64;
        sizes.map(|size| size * rounding + f64::MIN_POSITIVE * t.len() as f64)
    }
}

/// Calls `f` with the row, the column and the entry of both triangles.
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

/// left <- left - A c, heads and tails.
#[inline(always)]
fn subtract_product(a: &LowerTriangle<PreciseBall>, c: &[Lanes], left: &mut [[Lanes; 2]]) {
    for (j, ends) in a.starts.windows(2).enumerate() {
        let mut own = left[j];
        for k in ends[0]..ends[1] {
            let (i, entry) = (a.rows[k], a.values[k].centre());
            subtract(&mut own, entry, &c[i]);
            if i != j {
                subtract(&mut left[i], entry, &c[j]);
            }
        }
        left[j] = own;
    }
    for [head, tail] in left {
        for lane in 0..LANES {
            let sum = DoubleDouble::sum(head[lane], tail[lane]);
            (head[lane], tail[lane]) = (sum.head(), sum.tail());
        }
    }
}

#[inline(always)]
fn subtract([head, tail]: &mut [Lanes; 2], a: DoubleDouble, c: &Lanes) {
    let (a_head, a_tail) = (a.head(), a.tail());
    for lane in 0..LANES {
        let product = a_head * c[lane];
        let of_product = a_tail.mul_add(c[lane], a_head.mul_add(c[lane], -product));
        let sum = DoubleDouble::sum(head[lane], -product);
        head[lane] = sum.head();
        tail[lane] += sum.tail() - of_product;
    }
}
