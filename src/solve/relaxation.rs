//! Where contact would go on each edge by itself: the point at which the next step of Newton's method is linearised.
//!
//! At an iterate with the forces of contact w, P has the values y, and Psi'(y) need not be w. If the other edges kept their
//! forces, and edge e alone changed its, P would go there to the q with
//!
//! q - y + C (Psi'(q) - w) = 0,
//!
//! C being the compliance of the body at the nodes of the edge: an equation in as many unknowns as the edge has nodes, monotone
//! because C and Psi'' are positive semidefinite. Contact is stiff and narrow, the body is neither: nearly all of what makes (8)
//! nonlinear is in these equations, and it costs next to nothing to solve them one by one. The step from y linearised at q,
//!
//! Psi'(y + dy) = Psi'(q) + Psi''(q) (y + dy - q),
//!
//! sees the contact zone as it will be and not as it was: springs can be stiffened by a factor of eight in one step. It is theory
//! 4.6.

use faer::linalg::solvers::Solve;
use faer::{Col, Mat};
use nalgebra::{DMatrix, DVector};

use super::body::{Body, ContactEnergy, Derivatives, Step, block};
use crate::fem::double_double::DoubleDouble;

/// Newton's steps on an edge.
const MOST_STEPS: usize = 30;

/// The equation of an edge holds where what is left of it is this small beside how far P has moved.
const SOLVED: f64 = 1e-3;

/// A step is cut to this much of it and no less.
const SHORTEST: f64 = 1e-4;

/// s Psi linearised at where contact would go on each edge by itself, as what the gradient would be at y were it linear.
pub fn relaxed(edges: &impl ContactEnergy, body: &impl Body, w: &[f64], s: f64) -> Derivatives {
    let nodes = edges.nodes();
    let mut gradient = Vec::with_capacity(w.len());
    let mut hessian = Vec::with_capacity(edges.count());
    for e in 0..edges.count() {
        let compliance = body.compliance(e);
        let y = vector(block(&body.y(), e, nodes).iter().map(|y| y.head()));
        let spring = |q: &DVector<f64>| {
            let q: Vec<DoubleDouble> = q.iter().map(|&q| q.into()).collect();
            let (g, h) = edges.derivatives(e, &q);
            (s * vector(g), s * h)
        };
        let q = alone(&y, &vector(block(w, e, nodes).iter().copied()), &compliance, spring);
        let (g, h) = spring(&q);
        gradient.extend((g + &h * (y - q)).iter());
        hessian.push(h);
    }
    Derivatives { stiffness: s, gradient, hessian }
}

fn vector(values: impl IntoIterator<Item = f64>) -> DVector<f64> {
    DVector::from_vec(values.into_iter().collect())
}

/// w after `t` times a `step` that was linearised as `at`: with the loads in equilibrium if w was.
pub fn follow(w: &mut [f64], at: &Derivatives, step: &Step, t: f64) {
    for (e, hessian) in at.hessian.iter().enumerate() {
        let nodes = hessian.nrows();
        let change = hessian * vector(block(&step.dy, e, nodes).iter().copied());
        for a in 0..nodes {
            let i = e * nodes + a;
            w[i] += t * (at.gradient[i] + change[a] - w[i]);
        }
    }
}

/// The q of an edge, by Newton's method with steps that are halved until less is left of the equation; where none leaves less it
/// ends, for any q will do.
fn alone(
    y: &DVector<f64>,
    w: &DVector<f64>,
    compliance: &DMatrix<f64>,
    spring: impl Fn(&DVector<f64>) -> (DVector<f64>, DMatrix<f64>),
) -> DVector<f64> {
    let left = |q: &DVector<f64>| q - y + compliance * (spring(q).0 - w);
    let (mut q, mut r) = (y.clone(), left(y));
    for _ in 0..MOST_STEPS {
        if square(&r) <= SOLVED * SOLVED * square(&(&q - y)) {
            break;
        }
        let matrix = DMatrix::identity(y.len(), y.len()) + compliance * spring(&q).1;
        let d = solution(&matrix, &r);
        let shorter = std::iter::successors(Some(1.0), |t| (*t > SHORTEST).then_some(t / 2.0));
        let mut trials = shorter.map(|t| &q - t * &d);
        let Some(next) = trials.find(|trial| square(&left(trial)) < square(&r)) else { break };
        (r, q) = (left(&next), next);
    }
    q
}

fn square(v: &DVector<f64>) -> f64 {
    v.dot(v)
}

/// The x with `matrix` x = `right`; not finite where the matrix is singular.
fn solution(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let matrix = Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)]);
    let x = matrix.partial_piv_lu().solve(Col::from_fn(right.len(), |i| right[i]));
    vector(x.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stiff one-sided spring at each of two nodes: q = y - c (k [q]+ - w).
    #[test]
    fn an_edge_by_itself_ends_where_its_equation_holds() {
        let stiffness = 1e8;
        let compliance = DMatrix::from_row_slice(2, 2, &[2.0, 0.5, 0.5, 1.0]);
        let spring = |q: &DVector<f64>| {
            let on = q.map(|q| f64::from(u8::from(q > 0.0)));
            (q.map(|q| stiffness * q.max(0.0)), stiffness * DMatrix::from_diagonal(&on))
        };
        for (y, w) in
            [([1.0, -1.0], [0.0, 0.0]), ([1.0, 1.0], [0.3, -0.1]), ([-1.0, 0.2], [0.1, 0.0])]
        {
            let (y, w) = (vector(y), vector(w));
            let q = alone(&y, &w, &compliance, spring);
            let left = &q - &y + &compliance * (spring(&q).0 - w);
            assert!(left.amax() < 1e-2, "{y}: {q}");
        }
    }
}
