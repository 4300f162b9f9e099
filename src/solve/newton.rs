//! Newton's method with a line search on J_h, in the space of the contact functionals.
//!
//! Let A = L L^T be the matrix of A(.,.), B the contact functionals (the values of P0 at the nodes of each contact edge),
//! y = B u + d the values of P, and Psi(y) = sum over the edges of (|E| / gamma) 1/2 int \[P\]+^2. Then
//!
//! J_h(u) = 1/2 u^T A u - l^T u + Psi(B u + d)
//!
//! is stationary where A u + B^T w = l with w = Psi'(y). Every iterate of Newton's method on J_h has the form
//! u = A^-1 (l - B^T w), so w stands for u, and with G = B A^-1 B^T and y0 = B A^-1 l + d
//!
//! - y = y0 - G w, and the residual of (8) is B^T (Psi'(y) - w),
//! - the Newton step solves w + dw = Psi'(y) + H dy with dy = -G dw, where H = Psi''(y) = R R^T is block diagonal; with
//!   s = w - Psi'(y) this is dw = R t - s, (I + R^T G R) t = R^T G s: symmetric, with no eigenvalue below 1,
//! - along the step J_h changes by t DJ + t^2/2 dw^T G dw + D(y, y + t dy), where DJ = -s . dy <= 0 and D is the Bregman
//!   distance of Psi: two terms that are never negative against one that is never positive. Nothing cancels, so the line
//!   search works down to the rounding level. Armijo's rule reads: both together at most (1 - sigma) t |DJ|.

use faer::linalg::solvers::Solve;
use faer::{Col, Mat, Side};

use super::SolveError;

/// What Newton's method needs to know of one contact edge.
pub trait Edges<const M: usize> {
    /// How many there are.
    fn count(&self) -> usize;
    /// The gradient and the Hessian of Psi on edge `e`, where P has the nodal values `p`.
    fn derivatives(&self, e: usize, p: [f64; M]) -> ([f64; M], [[f64; M]; M]);
    /// The Bregman distance of Psi on edge `e` from `p` to `q`.
    fn bregman(&self, e: usize, p: [f64; M], q: [f64; M]) -> f64;
    /// The norm of B^T s relative to the reference of the problem.
    fn residual_norm(&self, s: &[f64]) -> f64;
    /// The same of |B|^T |s|: an upper bound that knows no cancellation.
    fn magnitude_norm(&self, s: &[f64]) -> f64;
}

/// The reduced problem.
pub struct Reduced<'a, T, const M: usize> {
    /// Psi
    pub edges: &'a T,
    /// G = B A^-1 B^T
    pub compliance: &'a Mat<f64>,
    /// y0, the values of P without contact pressure
    pub free: &'a [f64],
}

/// Where Newton's method ended.
#[derive(Clone, Debug)]
pub struct Iterate {
    /// w, the nodal values of the contact pressure's functional
    pub w: Vec<f64>,
    /// The relative residual before the first step and after each one.
    pub residuals: Vec<f64>,
}

/// Armijo's sigma.
const SUFFICIENT: f64 = 1e-4;

/// A residual this many unit roundoffs times its magnitudes is noise.
const NOISE: f64 = 4.0;

impl<T: Edges<M>, const M: usize> Reduced<'_, T, M> {
    /// Newton's method from `w`. A step costs little beside the factorisation, so it goes on to the rounding level, unless
    /// `max_iterations` come first.
    ///
    /// # Errors
    /// [`SolveError::NotPositiveDefinite`] if the tangent isn't; with a positive definite A that takes a NaN.
    pub fn minimise(&self, mut w: Vec<f64>, max_iterations: usize) -> Result<Iterate, SolveError> {
        let mut residuals: Vec<f64> = Vec::new();
        loop {
            let y = self.values_of_p(&w);
            let point = self.evaluate(&y, &w);
            let residual = self.edges.residual_norm(&point.s);
            let stalled = residual <= point.noise
                && residuals.last().is_some_and(|&last| residual >= last / 2.0);
            residuals.push(residual);
            let done = residual <= point.noise / NOISE || stalled;
            if done || residuals.len() > max_iterations || !residual.is_finite() {
                return Ok(Iterate { w, residuals });
            }
            let dw = self.step(&point)?;
            let dy: Vec<f64> = self.times_compliance(&dw).into_iter().map(|v| -v).collect();
            let Some(t) = self.line_search(&y, &point.s, &dw, &dy) else {
                return Ok(Iterate { w, residuals });
            };
            for (w, dw) in w.iter_mut().zip(&dw) {
                *w += t * dw;
            }
        }
    }

    /// y = y0 - G w
    fn values_of_p(&self, w: &[f64]) -> Vec<f64> {
        self.free.iter().zip(self.times_compliance(w)).map(|(y0, gw)| y0 - gw).collect()
    }

    fn times_compliance(&self, v: &[f64]) -> Vec<f64> {
        let v = Col::from_fn(v.len(), |i| v[i]);
        let product = self.compliance * v;
        product.iter().copied().collect()
    }

    fn evaluate(&self, y: &[f64], w: &[f64]) -> Point<M> {
        let mut s = w.to_vec();
        let mut roots = Vec::new();
        let mut magnitudes = vec![0.0; w.len()];
        for e in 0..self.edges.count() {
            let at = e * M;
            let (gradient, hessian) = self.edges.derivatives(e, block(y, e));
            for a in 0..M {
                s[at + a] -= gradient[a];
                let spread: f64 = (0..M)
                    .map(|b| hessian[a][b].abs() * (y[at + b].abs() + self.free[at + b].abs()))
                    .sum();
                magnitudes[at + a] = w[at + a].abs() + gradient[a].abs() + spread;
            }
            roots.extend(root(hessian).into_iter().map(|column| (e, column)));
        }
        let noise = NOISE * f64::EPSILON * self.edges.magnitude_norm(&magnitudes);
        Point { s, roots, noise }
    }

    /// dw = R t - s with (I + R^T G R) t = R^T G s.
    fn step(&self, point: &Point<M>) -> Result<Vec<f64>, SolveError> {
        let columns = &point.roots;
        let gs = self.times_compliance(&point.s);
        let system = Mat::from_fn(columns.len(), columns.len(), |i, j| {
            if i < j {
                return 0.0;
            }
            let ((e, r), (f, q)) = (columns[i], columns[j]);
            let mut sum = f64::from(u8::from(i == j));
            for a in 0..M {
                for b in 0..M {
                    sum += r[a] * self.compliance[(e * M + a, f * M + b)] * q[b];
                }
            }
            sum
        });
        let right = Col::from_fn(columns.len(), |i| dot(columns[i].1, block(&gs, columns[i].0)));
        let llt = system.llt(Side::Lower).map_err(|_| SolveError::NotPositiveDefinite)?;
        let t = llt.solve(right);
        let mut dw: Vec<f64> = point.s.iter().map(|s| -s).collect();
        for (i, (e, column)) in columns.iter().enumerate() {
            for a in 0..M {
                dw[e * M + a] += column[a] * t[i];
            }
        }
        Ok(dw)
    }

    /// The first of 1, 1/2, 1/4, ... with a sufficient decrease of J_h; `None` if the decrease is lost in rounding.
    fn line_search(&self, y: &[f64], s: &[f64], dw: &[f64], dy: &[f64]) -> Option<f64> {
        let slope: f64 = -s.iter().zip(dy).map(|(s, dy)| s * dy).sum::<f64>();
        let curvature: f64 = -dw.iter().zip(dy).map(|(dw, dy)| dw * dy).sum::<f64>();
        let mut t = 1.0;
        while t > f64::EPSILON {
            let distance: f64 = (0..self.edges.count())
                .map(|e| {
                    let (p, d): ([f64; M], [f64; M]) = (block(y, e), block(dy, e));
                    self.edges.bregman(e, p, std::array::from_fn(|a| p[a] + t * d[a]))
                })
                .sum();
            if t * t / 2.0 * curvature + distance <= (SUFFICIENT - 1.0) * t * slope {
                return Some(t);
            }
            t /= 2.0;
        }
        None
    }
}

/// What is known at an iterate: s = w - Psi'(y), the columns of R with their edges, and the noise in the residual.
struct Point<const M: usize> {
    s: Vec<f64>,
    roots: Vec<(usize, [f64; M])>,
    noise: f64,
}

fn block<const M: usize>(v: &[f64], e: usize) -> [f64; M] {
    std::array::from_fn(|a| v[e * M + a])
}

fn dot<const M: usize>(a: [f64; M], b: [f64; M]) -> f64 {
    (0..M).map(|i| a[i] * b[i]).sum()
}

/// A pivot this small beside its diagonal entry belongs to a singular matrix.
const SINGULAR: f64 = 1e-14;

/// The columns of R with H = R R^T for a positive semidefinite H, by Cholesky; those of zero pivots are left out.
fn root<const M: usize>(mut h: [[f64; M]; M]) -> Vec<[f64; M]> {
    let diagonal: [f64; M] = std::array::from_fn(|a| h[a][a]);
    let mut columns = Vec::with_capacity(M);
    for k in 0..M {
        if h[k][k] <= SINGULAR * diagonal[k] {
            continue;
        }
        let pivot = h[k][k].sqrt();
        let mut column = [0.0; M];
        for i in k..M {
            column[i] = h[i][k] / pivot;
        }
        for i in k..M {
            for j in k..M {
                h[i][j] -= column[i] * column[j];
            }
        }
        columns.push(column);
    }
    columns
}
