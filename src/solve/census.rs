//! How many solutions (8) has, proved, where kappa is not below 1 and the contact functionals are few: an interval search in
//! their space. docs/theory.md, 2.6. With gamma0 beyond its limit (8) may have several solutions, or none; that Newton's method
//! finds nothing says neither.
//!
//! As in 5.1, but for any A that is invertible: u solves (8) if and only if y = P(u) solves
//!
//! F(y) = y - y_lin + G Psi'(y) = 0,  G = B A^-1 B^T.
//!
//! G and y_lin are enclosed by elimination in [balls](crate::fem::ball). Psi' is positively homogeneous: where
//! |y + G Psi'(y)| >= m on the unit sphere of the maximum norm, all solutions have |y| <= |y_lin|/m. That cube is cut into boxes:
//! 0 is not in F(box), or Krawczyk's operator maps the box into itself and there is exactly one solution in it, or the box is
//! halved. For P1 without quadrature error Psi' is monotone in each nodal value, so that its range over a box is known.

use super::balls::{Lines, free, lines};
use super::enclosure::times_matrix;
use super::pressed::Pressed;
use super::system::System;
use crate::fem::ball::Ball;
use crate::fem::contact_line::EdgeRule;
use crate::fem::precise;
use crate::kernel::edge_integral::{EdgeIntegrals, ExactEdge};
use crate::kernel::{Interval, P1};

/// No more unknowns than these: they are eliminated in a full matrix.
const MOST_UNKNOWNS: usize = 200;

/// No more contact functionals than these: boxes are many in a space of more dimensions.
const MOST_FUNCTIONALS: usize = 4;

/// No more boxes than these are looked at.
const MOST_BOXES: usize = 100_000;

/// How many solutions (8) has; `None` where that cannot be told.
pub fn count<E, const N: usize, const M: usize>(system: &System<E, N, M>) -> Option<usize>
where
    E: ExactEdge<f64, N, M>,
{
    let q = M * system.d.contact.len();
    let affine = E::DEGREE == 1 && system.d.rule == EdgeRule::Exact && system.d.slides.is_none();
    if !affine || q > MOST_FUNCTIONALS || system.numbering.count > MOST_UNKNOWNS {
        return None;
    }
    let condensed = Condensed::new(system)?;
    let size = condensed.largest_solution()?;
    condensed.solutions(size)
}

type Cell = Vec<Interval>;

/// F, with the weights |E|/gamma in G's columns.
struct Condensed {
    y_lin: Vec<Interval>,
    g: Vec<Vec<Interval>>,
}

fn interval(ball: Ball) -> Interval {
    Interval::new(ball.lower(), ball.upper())
}

impl Condensed {
    fn new<E, const N: usize, const M: usize>(system: &System<E, N, M>) -> Option<Self>
    where
        E: ExactEdge<f64, N, M>,
    {
        let d = system.d;
        let lines: Lines<N, M> = lines(d);
        let (n, q) = (system.numbering.count, M * lines.len());
        let zero = vec![[Ball::from(0); 2]; d.space.nodes().len()];

        // The columns of A, of B^T, and l.
        let a: Vec<Vec<Ball>> = (0..n)
            .map(|j| {
                let unit: Vec<Ball> = (0..n).map(|i| Ball::from(i32::from(i == j))).collect();
                times_matrix(system, &lines, &Pressed::nowhere(0), &unit)
            })
            .collect();
        let mut right: Vec<Vec<Ball>> = Vec::with_capacity(q + 1);
        for line in &lines {
            for k in 0..M {
                let mut unit = [Ball::from(0); M];
                unit[k] = Ball::from(1);
                let mut forces = zero.clone();
                line.add_contact(&unit, &mut forces);
                right.push(free(system, &forces));
            }
        }
        let b = right.clone();
        let lift: Vec<[Ball; 2]> =
            d.constraints.lift().into_iter().map(|u| u.map(Ball::from)).collect();
        let mut residual = zero;
        precise::add_internal_forces(d, &lift, &mut residual);
        for line in &lines {
            line.add_stresses(&lift, &mut residual);
        }
        for (r, l) in residual.iter_mut().zip(&d.enclosed_load) {
            *r = [l[0] - r[0], l[1] - r[1]];
        }
        right.push(free(system, &residual));

        let solved = eliminate(a, right)?;
        let product = |v: &[Ball], w: &[Ball]| {
            v.iter().zip(w).fold(Ball::from(0), |sum, (&v, &w)| sum + v * w)
        };
        let at_lift: Vec<Ball> =
            d.contact.iter().zip(&lines).flat_map(|(edge, line)| line.p(edge, &lift)).collect();
        let y_lin: Vec<Interval> =
            (0..q).map(|i| interval(at_lift[i] + product(&b[i], &solved[q]))).collect();
        let weight = |j: usize| lines[j / M].numbers.length / lines[j / M].numbers.gamma;
        let entry = |i: usize, j: usize| interval(product(&b[i], &solved[j]) * weight(j));
        let g = (0..q).map(|i| (0..q).map(|j| entry(i, j)).collect()).collect();
        let condensed = Condensed { y_lin, g };
        let all = condensed.g.iter().flatten().chain(&condensed.y_lin);
        let known = all.into_iter().all(|i| i.lo().is_finite() && i.hi().is_finite());
        known.then_some(condensed)
    }

    fn dimension(&self) -> usize {
        self.y_lin.len()
    }

    /// y + G Psi'(y) over a box.
    fn homogeneous(&self, y: &[Interval]) -> Vec<Interval> {
        let mut slopes = Vec::with_capacity(y.len());
        for edge in y.chunks_exact(2) {
            // The integrals grow with either nodal value.
            let at = |p: [f64; 2]| integrals(p.map(Interval::point)).gradient;
            let (low, high) = (at([edge[0].lo(), edge[1].lo()]), at([edge[0].hi(), edge[1].hi()]));
            slopes.extend([0, 1].map(|a| low[a].hull(high[a])));
        }
        let row = |(y, row): (&Interval, &Vec<Interval>)| {
            row.iter().zip(&slopes).fold(*y, |sum, (&g, &w)| sum + g * w)
        };
        y.iter().zip(&self.g).map(row).collect()
    }

    /// F over a box.
    fn residual(&self, y: &[Interval]) -> Vec<Interval> {
        self.homogeneous(y).into_iter().zip(&self.y_lin).map(|(f, &lin)| f - lin).collect()
    }

    /// Its derivatives over a box.
    fn derivatives(&self, y: &[Interval]) -> Vec<Vec<Interval>> {
        let hessians: Vec<_> = y.chunks_exact(2).map(|p| integrals([p[0], p[1]]).hessian).collect();
        let q = y.len();
        (0..q)
            .map(|i| {
                (0..q)
                    .map(|j| {
                        let h = &hessians[j / 2];
                        let first = j / 2 * 2;
                        let identity = Interval::from(i32::from(i == j));
                        (0..2).fold(identity, |sum, a| sum + self.g[i][first + a] * h[a][j % 2])
                    })
                    .collect()
            })
            .collect()
    }

    /// A bound of |y| over all solutions.
    fn largest_solution(&self) -> Option<f64> {
        let q = self.dimension();
        let whole = Interval::new(-1.0, 1.0);
        let mut boxes: Vec<Cell> = Vec::new();
        for k in 0..q {
            for side in [-1.0, 1.0] {
                let mut face = vec![whole; q];
                face[k] = Interval::point(side);
                boxes.push(face);
            }
        }
        let mut least = f64::INFINITY;
        let mut looked = 0;
        while let Some(y) = boxes.pop() {
            looked += 1;
            let here = self.homogeneous(&y).into_iter().map(mignitude).fold(0.0, f64::max);
            if here > 0.0 {
                least = least.min(here);
            } else if looked > MOST_BOXES {
                return None;
            } else {
                boxes.extend(halves(&y));
            }
        }
        let most = self.y_lin.iter().fold(0.0, |m: f64, y| m.max(y.lo().abs()).max(y.hi().abs()));
        let size = (most / least) * (1.0 + 4.0 * f64::EPSILON);
        size.is_finite().then_some(size.max(f64::MIN_POSITIVE))
    }

    /// The number of solutions with |y| <= `size`.
    fn solutions(&self, size: f64) -> Option<usize> {
        // Boxes that hold one solution each, and where the solutions are.
        let mut alone: Vec<Cell> = Vec::new();
        let mut found: Vec<Cell> = Vec::new();
        let mut boxes = vec![vec![Interval::new(-size, size); self.dimension()]];
        let mut looked = 0;
        while let Some(y) = boxes.pop() {
            looked += 1;
            if looked > MOST_BOXES {
                return None;
            }
            let excluded = self.residual(&y).into_iter().any(|f| !f.contains(0.0) && !f.is_nan());
            if excluded || alone.iter().any(|alone| inside(&y, alone)) {
                continue;
            }
            let Some((region, solution)) = self.isolated(&y) else {
                boxes.extend(halves(&y));
                continue;
            };
            let known = alone.iter().any(|alone| inside(&solution, alone));
            if !known {
                let apart = |other: &Cell| (0..y.len()).any(|i| disjoint(solution[i], other[i]));
                if !found.iter().all(apart) {
                    return None;
                }
                found.push(solution);
            }
            alone.push(region);
        }
        Some(found.len())
    }

    /// A box around `y` that Krawczyk's operator maps into itself, and what it is mapped to, where the one solution is.
    fn isolated(&self, y: &[Interval]) -> Option<(Cell, Cell)> {
        let wide = y.iter().map(|y| {
            let by = 0.1 * (y.hi() - y.lo());
            Interval::new(y.lo() - by, y.hi() + by)
        });
        let wide: Cell = wide.collect();
        let mut solution = self.krawczyk(&wide)?;
        if !strictly_inside(&solution, &wide) {
            return None;
        }
        for _ in 0..20 {
            match self.krawczyk(&solution) {
                Some(next) if strictly_inside(&next, &solution) => solution = next,
                _ => break,
            }
        }
        Some((wide, solution))
    }

    fn krawczyk(&self, y: &[Interval]) -> Option<Cell> {
        let q = y.len();
        let middle: Vec<f64> = y.iter().map(|y| y.lo() / 2.0 + y.hi() / 2.0).collect();
        let centre: Cell = middle.iter().map(|&m| Interval::point(m)).collect();
        let derivatives = self.derivatives(y);
        let known = derivatives.iter().flatten().all(|d| d.lo().is_finite() && d.hi().is_finite());
        if !known {
            return None;
        }
        // Of the matrix of the middles, and of the identity, the columns.
        let column = |j: usize| -> Vec<Ball> {
            let middle = |d: Interval| Ball::from(d.lo() / 2.0 + d.hi() / 2.0);
            derivatives.iter().map(|row| middle(row[j])).collect()
        };
        let unit =
            |j: usize| -> Vec<Ball> { (0..q).map(|i| Ball::from(i32::from(i == j))).collect() };
        let columns = (0..q).map(column).collect();
        let identity = (0..q).map(unit).collect();
        let inverse = eliminate(columns, identity)?;
        let c = |i: usize, j: usize| Interval::point(inverse[j][i].head());
        let f = self.residual(&centre);
        let row = |i: usize| {
            let newton = (0..q).fold(centre[i], |sum, j| sum - c(i, j) * f[j]);
            (0..q).fold(newton, |sum, j| {
                let product = (0..q).fold(Interval::from(i32::from(i == j)), |s, k| {
                    s - c(i, k) * derivatives[k][j]
                });
                sum + product * (y[j] - centre[j])
            })
        };
        Some((0..q).map(row).collect())
    }
}

fn integrals(p: [Interval; 2]) -> EdgeIntegrals<Interval, 2> {
    <P1 as ExactEdge<Interval, 3, 2>>::exact(p)
}

/// The least magnitude.
fn mignitude(y: Interval) -> f64 {
    if y.lo() > 0.0 {
        y.lo()
    } else if y.hi() < 0.0 {
        -y.hi()
    } else {
        0.0
    }
}

/// The two halves along the longest side.
fn halves(y: &[Interval]) -> [Cell; 2] {
    let width = |i: usize| y[i].hi() - y[i].lo();
    let longest = (0..y.len()).max_by(|&a, &b| width(a).total_cmp(&width(b))).unwrap_or_default();
    let middle = y[longest].lo() / 2.0 + y[longest].hi() / 2.0;
    let [mut low, mut high] = [y.to_vec(), y.to_vec()];
    low[longest] = Interval::new(y[longest].lo(), middle);
    high[longest] = Interval::new(middle, y[longest].hi());
    [low, high]
}

fn inside(inner: &[Interval], outer: &[Interval]) -> bool {
    inner.iter().zip(outer).all(|(i, o)| o.lo() <= i.lo() && i.hi() <= o.hi())
}

fn strictly_inside(inner: &[Interval], outer: &[Interval]) -> bool {
    inner.iter().zip(outer).all(|(i, o)| o.lo() < i.lo() && i.hi() < o.hi())
}

fn disjoint(a: Interval, b: Interval) -> bool {
    a.hi() < b.lo() || b.hi() < a.lo()
}

/// The solutions of a full system for right sides, all by columns, by Gauss elimination in balls; `None` if no pivot is known
/// not to be zero.
fn eliminate(mut a: Vec<Vec<Ball>>, mut right: Vec<Vec<Ball>>) -> Option<Vec<Vec<Ball>>> {
    let n = a.len();
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|&i, &j| a[k][i].least_magnitude().total_cmp(&a[k][j].least_magnitude()))?;
        if !(a[k][pivot].least_magnitude() > 0.0) {
            return None;
        }
        for column in a.iter_mut().chain(&mut right) {
            column.swap(k, pivot);
        }
        let of_pivot = a[k].clone();
        for column in a[k + 1..].iter_mut().chain(&mut right) {
            let top = column[k] / of_pivot[k];
            column[k] = top;
            for i in k + 1..n {
                column[i] -= of_pivot[i] * top;
            }
        }
    }
    // Now column j of a holds, above its pivot, the unit upper triangle.
    for column in &mut right {
        for k in (0..n).rev() {
            let known = column[k];
            for i in 0..k {
                column[i] -= a[k][i] * known;
            }
        }
    }
    right.iter().flatten().all(|b| b.is_finite()).then_some(right)
}
