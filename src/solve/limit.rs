//! The true limit gamma0* of gamma0: A is positive definite on V^h exactly below it, [2.4], and kappa = 1 is a bound of it from
//! below that sees the shapes of the contact triangles only. docs/theory.md, 5.6: with S the rows of the stress functionals,
//! weighted so that S^T S is the matrix of int h_T sigma_n sigma_n, and mu the largest eigenvalue of S A^-1 S^T,
//! gamma0* = gamma0 + 1/mu. It is computed in doubles, by Lanczos' method; nothing is proved with it.

use faer::Mat;

use super::SolveError;
use super::compliance::{Compliance, Reach};
use super::factor::Factor;
use super::memory;
use super::route::{Prediction, RouteName};
use super::system::System;
use crate::fem::Discretization;
use crate::fem::matrix::{self, Neighbours};
use crate::kernel::edge_integral::ExactEdge;

/// gamma0* and the edge that sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TrueLimit {
    /// gamma0*, in 1 / stress.
    pub gamma0: f64,
    /// The contact edge that has the largest share of int h_T sigma_n(v)^2 for the v that attains the maximum, by its ends.
    pub edge: [[f64; 2]; 2],
}

/// Why it is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NoLimit {
    /// The assembled route has no condensed matrix.
    Assembled,
    /// A is singular.
    HeldByContact,
    /// The stiffness matrix has no factor in doubles, or there is no memory for it.
    NoFactor,
}

impl NoLimit {
    /// The reason in words.
    pub fn reason(self) -> &'static str {
        match self {
            NoLimit::Assembled => "the assembled route has no condensed matrix",
            NoLimit::HeldByContact => "the body is held by contact alone",
            NoLimit::NoFactor => "the body has no factor in double precision",
        }
    }
}

/// The limit from the factor of A, whose gamma0 is `gamma0`.
///
/// # Errors
/// [`NoLimit::NoFactor`] for lack of memory.
pub fn true_limit<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    factor: &Factor,
    gamma0: f64,
) -> Result<TrueLimit, NoLimit>
where
    E: ExactEdge<f64, N, M>,
{
    let d = system.d;
    let rows = E::DEGREE;
    let unknowns: Vec<Vec<usize>> = (0..d.contact.len()).map(|e| system.unknowns(e)).collect();
    let reach = Reach::new(&system.structure, &unknowns, rows);
    let q = reach.functionals();
    let bytes = 8 * (reach.stored_entries(&system.structure) + q * q) as u64;
    memory::ensure(bytes).map_err(|_| NoLimit::NoFactor)?;
    let compliance = Compliance::new(factor, &reach, |add| {
        for (position, &e) in reach.order.iter().enumerate() {
            stresses(system, e, |unknown, row, entry| add(unknown, position * rows + row, entry));
        }
    });
    let (mu, vector) = largest_eigenpair(&compliance.g).ok_or(NoLimit::NoFactor)?;
    let share = |position: usize| -> f64 {
        vector[position * rows..(position + 1) * rows].iter().map(|x| x * x).sum()
    };
    let most = (0..reach.order.len()).max_by(|&a, &b| share(a).total_cmp(&share(b)));
    let edge = most.map(|position| d.contact[reach.order[position]].edge);
    let edge = edge.ok_or(NoLimit::NoFactor)?;
    let mesh = d.space.mesh();
    Ok(TrueLimit { gamma0: gamma0 + 1.0 / mu, edge: mesh.ends(edge).map(|v| mesh.vertices()[v]) })
}

/// Bytes for each node that matrices, their structure and the factor take, and more.
const PER_NODE: u64 = 4096;

/// The limit of a discretization that is not being solved: with the factor of the stiffness matrix.
///
/// # Errors
/// Why it is not known.
pub fn of_discretization<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
) -> Result<TrueLimit, NoLimit>
where
    E: ExactEdge<f64, N, M>,
{
    if d.slides.is_some() {
        return Err(NoLimit::HeldByContact);
    }
    let unknown = |_: SolveError| NoLimit::NoFactor;
    memory::ensure(PER_NODE * d.space.nodes().len() as u64).map_err(unknown)?;
    let system = System::new(d).map_err(unknown)?;
    if Prediction::of(&system).1.route() != RouteName::Condensed {
        return Err(NoLimit::Assembled);
    }
    let neighbours = Neighbours::new(d.space.nodes().len(), d.space.elements());
    let stiffness = matrix::assemble_stiffness(d, &system.numbering, &neighbours);
    let factor = Factor::with(&system.structure, &stiffness).map_err(unknown)?;
    true_limit(&system, &factor.map_err(|_| NoLimit::NoFactor)?, 0.0)
}

/// The rows of S of contact edge `e`: calls `f` with the unknown, the row and the entry.
fn stresses<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    e: usize,
    mut f: impl FnMut(usize, usize, f64),
) where
    E: ExactEdge<f64, N, M>,
{
    let edge = &system.d.contact[e];
    let nodes = &system.d.space.elements()[edge.edge.triangle];
    let weight = (edge.gamma / system.d.gamma0 * edge.length).sqrt();
    let [start, end] = &edge.functionals.sigma_n;
    for (j, &node) in nodes.iter().enumerate() {
        // int s^2 = |E| (((s_0 + s_1)/2)^2 + (s_1 - s_0)^2/12)
        let mean = [0, 1].map(|c| weight * (start[j][c] + end[j][c]) / 2.0);
        let slope = [0, 1].map(|c| weight * (end[j][c] - start[j][c]) / 12.0_f64.sqrt());
        for (row, entries) in [mean, slope].into_iter().take(E::DEGREE).enumerate() {
            let entries = system.numbering.in_frame(node, entries);
            for (number, entry) in system.numbering.of[node].iter().zip(entries) {
                if let Some(number) = *number {
                    f(number, row, entry);
                }
            }
        }
    }
}

/// Steps of Lanczos' method: for fewer rows the eigenvalue is that of the matrix itself.
const STEPS: usize = 80;

/// The largest eigenvalue of a positive semidefinite matrix and an eigenvector of length 1; `None` if it is zero.
fn largest_eigenpair(g: &Mat<f64>) -> Option<(f64, Vec<f64>)> {
    let q = g.nrows();
    // A start that no symmetry of the body makes orthogonal to the eigenvector.
    let start = Mat::from_fn(q, 1, |i, _| 1.0 + 0.1 * (i as f64 + 1.0).sin());
    let mut basis: Vec<Mat<f64>> = Vec::new();
    let mut next = start;
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    for _ in 0..STEPS.min(q) {
        let norm = next.norm_l2();
        let largest: f64 = diagonal.iter().fold(0.0, |m: f64, &d: &f64| m.max(d));
        if !(norm > f64::EPSILON * largest) {
            break;
        }
        if !basis.is_empty() {
            beside.push(norm);
        }
        let v = &next * (1.0 / norm);
        let mut w = g * &v;
        diagonal.push((v.transpose() * &w)[(0, 0)]);
        basis.push(v);
        // Against all before, twice: rounding must not bring an eigenvalue back.
        for _ in 0..2 {
            for b in &basis {
                let along = (b.transpose() * &w)[(0, 0)];
                w -= b * along;
            }
        }
        next = w;
    }
    let (mu, coefficients) = largest_of_tridiagonal(&diagonal, &beside)?;
    let vector =
        (0..q).map(|i| basis.iter().zip(&coefficients).map(|(b, c)| b[(i, 0)] * c).sum()).collect();
    (mu > 0.0).then_some((mu, vector))
}

/// Halvings of an interval, after which its ends are neighbours.
const HALVINGS: usize = 60;

/// Steps of inverse iteration with a shift that is the eigenvalue but for rounding; each brings all digits that there are.
const INVERSE_STEPS: usize = 3;

/// The largest eigenvalue of the symmetric matrix T with this diagonal and these entries beside it, and its eigenvector of
/// length 1; `None` if an entry is not finite. The eigenvalue is the infimum of all mu for which mu I - T is positive
/// definite, found by bisection of Gershgorin's interval.
fn largest_of_tridiagonal(diagonal: &[f64], beside: &[f64]) -> Option<(f64, Vec<f64>)> {
    let m = diagonal.len();
    let at = |i: usize| beside.get(i).map_or(0.0, |b| b.abs());
    let around = |i: usize| if i == 0 { at(0) } else { at(i - 1) + at(i) };
    let mut low = diagonal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut high = (0..m).map(|i| diagonal[i] + around(i)).fold(low, f64::max);
    // mu I - T = L D L^T with positive D, or not.
    let pivots = |mu: f64| -> Option<Vec<f64>> {
        let mut pivots = Vec::with_capacity(m);
        for i in 0..m {
            let before = if i == 0 { 0.0 } else { beside[i - 1] * beside[i - 1] / pivots[i - 1] };
            let pivot = mu - diagonal[i] - before;
            if !(pivot > 0.0) {
                return None;
            }
            pivots.push(pivot);
        }
        Some(pivots)
    };
    // Gershgorin's end may be the eigenvalue itself.
    high += f64::EPSILON * (high.abs() + (high - low));
    let mut factor = pivots(high)?;
    for _ in 0..HALVINGS {
        let middle = low / 2.0 + high / 2.0;
        match pivots(middle) {
            Some(pivots) => (high, factor) = (middle, pivots),
            None => low = middle,
        }
    }
    let mut x = vec![1.0; m];
    for _ in 0..INVERSE_STEPS {
        for i in 1..m {
            x[i] += beside[i - 1] / factor[i - 1] * x[i - 1];
        }
        for i in (0..m).rev() {
            let after = if i + 1 < m { beside[i] * x[i + 1] } else { 0.0 };
            x[i] = (x[i] + after) / factor[i];
        }
        let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        x.iter_mut().for_each(|x| *x /= length);
    }
    let own = x.iter().zip(diagonal).map(|(x, d)| d * x * x).sum::<f64>();
    let mixed = x.iter().zip(&x[m.min(1)..]).zip(beside).map(|((x, next), b)| b * x * next);
    Some((own + 2.0 * mixed.sum::<f64>(), x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanczos_finds_the_largest_eigenvalue_of_a_matrix_that_is_known() {
        // 2 on the diagonal, -1 beside: 2 - 2 cos(k pi / (n + 1)).
        for n in [1_usize, 2, 5, 60, 300] {
            let g = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => 2.0,
                1 => -1.0,
                _ => 0.0,
            });
            let angle = n as f64 * std::f64::consts::PI / (n as f64 + 1.0);
            let expected = 2.0 - 2.0 * angle.cos();
            let (mu, vector) = largest_eigenpair(&g).unwrap();
            assert!((mu - expected).abs() <= 2e-3 * expected, "{n}: {mu} {expected}");
            assert!(n > STEPS || (mu - expected).abs() <= 1e-13 * expected);
            let length: f64 = vector.iter().map(|x| x * x).sum();
            assert!((length - 1.0).abs() <= 1e-12);
        }
    }
}
