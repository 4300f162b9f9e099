//! Contact at the price of one linear solve: the body is factored once, A = L L^T with the contact layer last, and
//! Newton's method works on the contact functionals alone (`newton`).
//!
//! B touches only the nodes of triangles that own a contact edge. They come last in the order of elimination, so
//! X = L^-1 B^T has nonzero rows only there, and needs only the trailing block of L. Then G = X^T X, the values of P
//! without contact pressure are y0 = X^T L^-1 l + d, and at the end u = L^-T (L^-1 l - X w): one substitution forward, one
//! backward, as in a linear solve.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, Col, Mat, Par};

use super::factor::Factor;
use super::newton::{Edges, Reduced};
use super::ordering::nested_dissection;
use super::times::{Stopwatch, Times};
use super::{NewtonReport, Settings, SolveError, Status};
use crate::fem::discretization::{Discretization, Functional};
use crate::fem::matrix::{self, LowerTriangle, Neighbours, Numbering};
use crate::kernel::edge_integral::ExactEdge;

/// The solution of method (8) at the nodes, how it was found, and how long that took.
///
/// # Errors
/// [`SolveError::NotPositiveDefinite`] when gamma0 is beyond the true limit, and [`SolveError::OutOfMemory`].
pub fn solve<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    system: System,
    settings: &Settings,
) -> Result<(Vec<[f64; 2]>, NewtonReport, Times), SolveError>
where
    E: ExactEdge<f64, N, M>,
{
    let mut times = Times::default();
    let mut watch = Stopwatch::start();
    let body = system.factor()?;
    times.factor = watch.lap();

    let prescribed = d.constraints.lift();
    let mut z: Vec<f64> =
        body.numbering.gather(&d.linear_residual(&prescribed).values).iter().map(|r| -r).collect();
    body.factor.forward(&mut z);
    times.forward = watch.lap();

    let x = body.contact_columns(d);
    let compliance = gram(&x);
    let mut free = transpose_times(&x, &z[body.layer..]);
    for (e, edge) in d.contact.iter().enumerate() {
        let p = edge.p(&d.space.on_triangle(edge.edge.triangle, &prescribed));
        for a in 0..M {
            free[e * M + a] += p[a];
        }
    }
    times.compliance = watch.lap();

    let reference = d.free_norm(&d.load) + d.free_norm(&d.residual_and_load(&prescribed));
    times.judge = watch.lap();

    let edges = ContactEdges { d, body: &body, reference };
    let reduced = Reduced { edges: &edges, compliance: &compliance, free: &free };
    let iterate = reduced.minimise(vec![0.0; free.len()], settings.max_iterations)?;
    times.newton = watch.lap();

    let w = Col::from_fn(iterate.w.len(), |i| iterate.w[i]);
    for (z, xw) in z[body.layer..].iter_mut().zip((&x * w).iter()) {
        *z -= xw;
    }
    body.factor.backward(&mut z);
    let mut u = prescribed;
    body.numbering.scatter(&z, &mut u);
    times.backward = watch.lap();

    let report = judge(d, &d.residual(&u), reference, iterate.residuals, settings);
    times.judge += watch.lap();
    Ok((u, report, times))
}

/// A residual this many unit roundoffs times its magnitudes is what the factorisation leaves.
const ROUNDING: f64 = 32.0;

/// The verdict on a solution from its residual in the full system.
fn judge<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    residual: &Functional,
    reference: f64,
    residuals: Vec<f64>,
    settings: &Settings,
) -> NewtonReport
where
    E: ExactEdge<f64, N, M>,
{
    let relative = |norm: f64| if norm == 0.0 { 0.0 } else { norm / reference };
    let reached = relative(d.free_norm(&residual.values));
    let rounding = relative(ROUNDING * f64::EPSILON * d.free_norm(&residual.magnitudes));
    let status = if reached <= settings.tolerance {
        Status::Converged
    } else if reached <= rounding {
        Status::ConvergedToRounding
    } else {
        Status::NotConverged
    };
    NewtonReport { status, residuals, residual: reached, factorizations: 1 }
}

/// The linear system of the body, the contact layer last.
pub struct System {
    numbering: Numbering,
    matrix: LowerTriangle,
    /// The first degree of freedom of the contact layer.
    layer: usize,
}

impl System {
    /// The matrix of A(.,.) in the order of elimination.
    pub fn new<E, const N: usize, const M: usize>(d: &Discretization<E, N, M>) -> Self
    where
        E: ExactEdge<f64, N, M>,
    {
        let nodes = d.space.nodes();
        let mut last = vec![false; nodes.len()];
        for edge in &d.contact {
            for &node in &d.space.elements()[edge.edge.triangle] {
                last[node] = true;
            }
        }
        let neighbours = Neighbours::new(nodes.len(), d.space.elements());
        let order = nested_dissection(nodes, &neighbours, &last);
        let numbering = Numbering::under(&order, &d.constraints);
        let in_layer = numbering.of.iter().zip(&last).filter(|(_, last)| **last);
        let layer = numbering.count - in_layer.flat_map(|(of, _)| of).flatten().count();
        let matrix = matrix::assemble(d, &numbering, &neighbours);
        System { numbering, matrix, layer }
    }

    fn factor(self) -> Result<Body, SolveError> {
        let factor = Factor::new(&self.matrix)?;
        Ok(Body { numbering: self.numbering, factor, layer: self.layer })
    }
}

/// The factored body.
struct Body {
    numbering: Numbering,
    factor: Factor,
    layer: usize,
}

impl Body {
    /// The rows of B as columns over the contact layer: calls `f` with the row of the layer, the column and the entry.
    fn functionals<E, const N: usize, const M: usize>(
        &self,
        d: &Discretization<E, N, M>,
        mut f: impl FnMut(usize, usize, f64),
    ) where
        E: ExactEdge<f64, N, M>,
    {
        for (e, edge) in d.contact.iter().enumerate() {
            let nodes = &d.space.elements()[edge.edge.triangle];
            for (a, functional) in edge.functionals.p0.iter().enumerate() {
                for (&node, &entries) in nodes.iter().zip(functional) {
                    let entries = self.numbering.in_frame(node, entries.into());
                    for (number, entry) in self.numbering.of[node].iter().zip(entries) {
                        if let Some(number) = number {
                            f(number - self.layer, e * M + a, entry);
                        }
                    }
                }
            }
        }
    }

    /// X = L^-1 B^T on the contact layer.
    fn contact_columns<E, const N: usize, const M: usize>(
        &self,
        d: &Discretization<E, N, M>,
    ) -> Mat<f64>
    where
        E: ExactEdge<f64, N, M>,
    {
        let mut x = Mat::zeros(self.numbering.count - self.layer, M * d.contact.len());
        self.functionals(d, |row, column, entry| x[(row, column)] += entry);
        let trailing = self.factor.trailing_block(self.layer);
        solve_lower_triangular_in_place(trailing.as_ref(), x.as_mut(), Par::Seq);
        x
    }
}

/// X^T X
fn gram(x: &Mat<f64>) -> Mat<f64> {
    let mut g = Mat::zeros(x.ncols(), x.ncols());
    matmul(
        g.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        x.transpose(),
        BlockStructure::Rectangular,
        x.as_ref(),
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
    for j in 0..g.ncols() {
        for i in 0..j {
            g[(i, j)] = g[(j, i)];
        }
    }
    g
}

fn transpose_times(x: &Mat<f64>, v: &[f64]) -> Vec<f64> {
    let product = x.transpose() * Col::from_fn(v.len(), |i| v[i]);
    product.iter().copied().collect()
}

/// Psi of the discretization, edge by edge, and the norms of B^T s.
struct ContactEdges<'a, 'b, E, const N: usize, const M: usize> {
    d: &'a Discretization<'b, E, N, M>,
    body: &'a Body,
    reference: f64,
}

impl<E: ExactEdge<f64, N, M>, const N: usize, const M: usize> ContactEdges<'_, '_, E, N, M> {
    /// |E| / gamma
    fn weight(&self, e: usize) -> f64 {
        let edge = &self.d.contact[e];
        edge.length / edge.gamma
    }

    fn norm(&self, s: &[f64], of: impl Fn(f64) -> f64) -> f64 {
        let mut sum = vec![0.0; self.body.numbering.count - self.body.layer];
        self.body.functionals(self.d, |row, column, entry| sum[row] += of(entry) * s[column]);
        let norm = sum.iter().map(|r| r * r).sum::<f64>().sqrt();
        if norm == 0.0 { 0.0 } else { norm / self.reference }
    }
}

impl<E, const N: usize, const M: usize> Edges<M> for ContactEdges<'_, '_, E, N, M>
where
    E: ExactEdge<f64, N, M>,
{
    fn count(&self) -> usize {
        self.d.contact.len()
    }

    fn derivatives(&self, e: usize, p: [f64; M]) -> ([f64; M], [[f64; M]; M]) {
        let integrals = self.d.rule.integrals::<E, N, M>(p);
        let weight = self.weight(e);
        (
            integrals.gradient.map(|g| weight * g),
            integrals.hessian.map(|row| row.map(|h| weight * h)),
        )
    }

    fn bregman(&self, e: usize, p: [f64; M], q: [f64; M]) -> f64 {
        self.weight(e) * self.d.rule.bregman::<E, N, M>(p, q)
    }

    fn residual_norm(&self, s: &[f64]) -> f64 {
        self.norm(s, |entry| entry)
    }

    fn magnitude_norm(&self, s: &[f64]) -> f64 {
        self.norm(s, f64::abs)
    }
}
