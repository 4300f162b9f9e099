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

use super::body::{Body, Derivatives, Edges, Step, block};
use crate::fem::double_double::DoubleDouble;

/// Newton's steps on an edge.
const MOST_STEPS: usize = 30;

/// The equation of an edge holds where what is left of it is this small beside how far P has moved.
const SOLVED: f64 = 1e-3;

/// A step is cut to this much of it and no less.
const SHORTEST: f64 = 1e-4;

/// s Psi linearised at where contact would go on each edge by itself, as what the gradient would be at y were it linear.
pub fn relaxed<const M: usize>(
    edges: &impl Edges<M>,
    body: &impl Body<M>,
    w: &[f64],
    s: f64,
) -> Derivatives<M> {
    let mut gradient = Vec::with_capacity(w.len());
    let mut hessian = Vec::with_capacity(edges.count());
    for e in 0..edges.count() {
        let (compliance, y) = (body.compliance(e), block(&body.y(), e).map(DoubleDouble::head));
        let spring = |q: [f64; M]| {
            let (g, h) = edges.derivatives(e, q.map(DoubleDouble::from));
            (g.map(|g| s * g), h.map(|row| row.map(|h| s * h)))
        };
        let q = alone(y, block(w, e), &compliance, spring);
        let (g, h) = spring(q);
        gradient.extend((0..M).map(|a| g[a] + row_times(&h[a], |b| y[b] - q[b])));
        hessian.push(h);
    }
    Derivatives { stiffness: s, gradient, hessian }
}

/// w after `t` times a `step` that was linearised as `at`: with the loads in equilibrium if w was.
pub fn follow<const M: usize>(w: &mut [f64], at: &Derivatives<M>, step: &Step, t: f64) {
    for (e, hessian) in at.hessian.iter().enumerate() {
        let dy: [f64; M] = block(&step.dy, e);
        for a in 0..M {
            let i = e * M + a;
            let linear = at.gradient[i] + row_times(&hessian[a], |b| dy[b]);
            w[i] += t * (linear - w[i]);
        }
    }
}

/// The q of an edge, by Newton's method with steps that are halved until less is left of the equation; where none leaves less it
/// ends, for any q will do.
fn alone<const M: usize>(
    y: [f64; M],
    w: [f64; M],
    compliance: &[[f64; M]; M],
    spring: impl Fn([f64; M]) -> ([f64; M], [[f64; M]; M]),
) -> [f64; M] {
    let left = |q: [f64; M]| -> [f64; M] {
        let (force, _) = spring(q);
        std::array::from_fn(|a| q[a] - y[a] + row_times(&compliance[a], |b| force[b] - w[b]))
    };
    let size = |r: [f64; M]| r.iter().map(|r| r * r).sum::<f64>();
    let (mut q, mut r) = (y, left(y));
    for _ in 0..MOST_STEPS {
        if size(r) <= SOLVED * SOLVED * size(std::array::from_fn(|a| q[a] - y[a])) {
            break;
        }
        let (_, h) = spring(q);
        let matrix = std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                f64::from(u8::from(a == b)) + row_times(&compliance[a], |k| h[k][b])
            })
        });
        let d = solution(matrix, r);
        let shorter = std::iter::successors(Some(1.0), |t| (*t > SHORTEST).then_some(t / 2.0));
        let trials = shorter.map(|t| std::array::from_fn(|a| q[a] - t * d[a]));
        let Some(next) = { trials }.find(|&trial| size(left(trial)) < size(r)) else { break };
        (q, r) = (next, left(next));
    }
    q
}

fn row_times<const M: usize>(row: &[f64; M], x: impl Fn(usize) -> f64) -> f64 {
    (0..M).map(|b| row[b] * x(b)).sum()
}

/// The x with `matrix` x = `right`, by elimination with row pivots; not finite where the matrix is singular.
fn solution<const M: usize>(mut matrix: [[f64; M]; M], mut right: [f64; M]) -> [f64; M] {
    for k in 0..M {
        let larger = |&i: &usize, &j: &usize| matrix[i][k].abs().total_cmp(&matrix[j][k].abs());
        let pivot = (k..M).max_by(larger).unwrap_or(k);
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        for i in k + 1..M {
            let factor = matrix[i][k] / matrix[k][k];
            for j in k..M {
                matrix[i][j] -= factor * matrix[k][j];
            }
            right[i] -= factor * right[k];
        }
    }
    for k in (0..M).rev() {
        let known: f64 = (k + 1..M).map(|j| matrix[k][j] * right[j]).sum();
        right[k] = (right[k] - known) / matrix[k][k];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elimination_solves_what_needs_pivots() {
        let x = solution([[0.0, 2.0, 1.0], [4.0, 1.0, 0.0], [1.0, 0.0, 3.0]], [7.0, 6.0, 10.0]);
        for (found, exact) in x.into_iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - exact).abs() < 1e-14, "{x:?}");
        }
    }

    /// A stiff one-sided spring at each of two nodes: q = y - c (k [q]+ - w).
    #[test]
    fn an_edge_by_itself_ends_where_its_equation_holds() {
        let (stiffness, compliance) = (1e8, [[2.0, 0.5], [0.5, 1.0]]);
        let spring = |q: [f64; 2]| {
            let on = q.map(|q| f64::from(u8::from(q > 0.0)));
            let h = [[stiffness * on[0], 0.0], [0.0, stiffness * on[1]]];
            (q.map(|q| stiffness * q.max(0.0)), h)
        };
        for (y, w) in
            [([1.0, -1.0], [0.0, 0.0]), ([1.0, 1.0], [0.3, -0.1]), ([-1.0, 0.2], [0.1, 0.0])]
        {
            let q = alone(y, w, &compliance, spring);
            let (force, _) = spring(q);
            for a in 0..2 {
                let moved: f64 = (0..2).map(|b| compliance[a][b] * (force[b] - w[b])).sum();
                assert!((q[a] - y[a] + moved).abs() < 1e-2, "{y:?} {w:?}: {q:?}");
            }
        }
    }
}
