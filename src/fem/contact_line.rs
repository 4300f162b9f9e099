//! Gamma_C on the mesh: its edges with their functionals and gamma = gamma0 h_T of (7), the coercivity number kappa, and
//! the integrals of \[P\]+ over an edge by the rule of the method.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::mesh::BoundaryEdge;
use super::problem::{Condition, DataError, Problem, finite};
use super::quadrature;
use super::space::Space;
use crate::kernel::contact_edge::coercivity_constant;
use crate::kernel::edge_integral::{self, ExactEdge};
use crate::kernel::{ContactEdge, EdgeIntegrals, Element};
use crate::quote::key;

/// One edge of Gamma_C.
#[derive(Clone, Debug)]
pub struct ContactLineEdge<const N: usize, const M: usize> {
    /// Where it lies in the mesh.
    pub edge: BoundaryEdge,
    /// |E|
    pub length: f64,
    /// n
    pub normal: Vector2<f64>,
    /// gamma = gamma0 h_T
    pub gamma: f64,
    /// g at the nodes of the edge: on it the gap is their Lagrange interpolant.
    pub gap: [f64; M],
    /// P0 and sigma_n as functionals of the nodal values on the triangle.
    pub functionals: ContactEdge<f64, N, M>,
}

impl<const N: usize, const M: usize> ContactLineEdge<N, M> {
    /// P(u) = P0(u) - g at the nodes of the edge, from the nodal values of u on its triangle.
    pub fn p(&self, u: &[Vector2<f64>; N]) -> [f64; M] {
        std::array::from_fn(|a| apply(&self.functionals.p0[a], u) - self.gap[a])
    }

    /// sigma_n(u) at the start and at the end of the edge.
    pub fn sigma_n(&self, u: &[Vector2<f64>; N]) -> [f64; 2] {
        [0, 1].map(|a| apply(&self.functionals.sigma_n[a], u))
    }
}

/// The value of a functional at the nodal values `u` on its triangle.
pub fn apply<const N: usize>(functional: &[Vector2<f64>; N], u: &[Vector2<f64>; N]) -> f64 {
    functional.iter().zip(u).map(|(f, u)| f.dot(u)).sum()
}

/// C_h with kappa = gamma0 C_h, and the contact edge that sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coercivity {
    /// max_T c_p (lambda + 2 mu) h_T |T's edges on Gamma_C| / |T|
    pub constant: f64,
    /// An edge of the triangle where the maximum is attained, by its two ends.
    pub limiting_edge: [[f64; 2]; 2],
}

impl Coercivity {
    /// The constant of a problem for the element `E`.
    ///
    /// # Errors
    /// [`DataError::NoContact`], and unknown boundary names.
    pub fn new<E: Element<N, M>, const N: usize, const M: usize>(
        problem: &Problem,
    ) -> Result<Self, DataError> {
        let mesh = &problem.mesh;
        let mut contact_length: BTreeMap<usize, f64> = BTreeMap::new();
        let edges = contact_edges(problem)?;
        for (edge, _) in &edges {
            *contact_length.entry(edge.triangle).or_default() += mesh.length_and_normal(*edge).0;
        }
        let mut worst: Option<Coercivity> = None;
        for (edge, _) in edges {
            let t = edge.triangle;
            let area = mesh.triangle(t).double_area() / 2.0;
            let (h, length) = (mesh.diameter(t), contact_length[&t]);
            let constant =
                coercivity_constant::<E, f64, N, M>(problem.material.of(t), h, length, area);
            if worst.is_none_or(|w| constant > w.constant) {
                let limiting_edge = mesh.ends(edge).map(|v| mesh.vertices()[v]);
                worst = Some(Coercivity { constant, limiting_edge });
            }
        }
        worst.ok_or(DataError::NoContact)
    }

    /// The gamma0 at which kappa = 1: below it, J_h is strictly convex.
    pub fn limit(&self) -> f64 {
        1.0 / self.constant
    }
}

/// The edges of all contact boundaries with the names of these, each boundary in chains along the boundary.
fn contact_edges(problem: &Problem) -> Result<Vec<(BoundaryEdge, &str)>, DataError> {
    let mut edges = Vec::new();
    for (name, condition) in &problem.conditions {
        if let Condition::Contact { .. } = condition {
            let chained = chains(problem, problem.mesh.edges_of(name)?);
            edges.extend(chained.into_iter().map(|edge| (edge, name.as_str())));
        }
    }
    if edges.is_empty() { Err(DataError::NoContact) } else { Ok(edges) }
}

/// The same edges, each followed by the one that starts where it ends, if there is one.
fn chains(problem: &Problem, edges: &[BoundaryEdge]) -> Vec<BoundaryEdge> {
    let ends = |edge: BoundaryEdge| problem.mesh.ends(edge);
    let mut from: BTreeMap<usize, BoundaryEdge> = edges.iter().map(|&e| (ends(e)[0], e)).collect();
    let targets: Vec<usize> = edges.iter().map(|&e| ends(e)[1]).collect();
    // First the chains that have a beginning, then the closed ones.
    let mut starts: Vec<usize> = from.keys().copied().collect();
    let is_target: std::collections::BTreeSet<usize> = targets.into_iter().collect();
    starts.sort_by_key(|start| is_target.contains(start));
    let mut chained = Vec::with_capacity(edges.len());
    for start in starts {
        let mut next = from.remove(&start);
        while let Some(edge) = next {
            chained.push(edge);
            next = from.remove(&ends(edge)[1]);
        }
    }
    chained
}

/// All edges of Gamma_C, with gamma = `gamma0` h_T.
///
/// # Errors
/// [`DataError::NoContact`], a gap that is not finite, and unknown boundary names.
pub fn assemble<E: Element<N, M>, const N: usize, const M: usize>(
    problem: &Problem,
    space: &Space<E, N, M>,
    gamma0: f64,
) -> Result<Vec<ContactLineEdge<N, M>>, DataError> {
    let mesh = space.mesh();
    let mut line = Vec::new();
    for (edge, name) in contact_edges(problem)? {
        let Some(Condition::Contact { gap }) = problem.conditions.get(name) else { continue };
        let (length, normal) = mesh.length_and_normal(edge);
        let gamma = gamma0 * mesh.diameter(edge.triangle);
        let mut values = [0.0; M];
        for (value, node) in values.iter_mut().zip(space.edge_nodes(edge)) {
            let what = || format!("[boundary.{}] contact.gap", key(name));
            *value = finite(&**gap, space.nodes()[node], what)?;
        }
        let triangle = mesh.triangle(edge.triangle);
        let material = problem.material.of(edge.triangle);
        let functionals = ContactEdge::new::<E>(&triangle, edge.local, normal, material, gamma);
        line.push(ContactLineEdge { edge, length, normal, gamma, gap: values, functionals });
    }
    Ok(line)
}

/// How \[P\]+ is integrated over an edge.
#[derive(Clone, Debug, PartialEq)]
pub enum EdgeRule {
    /// Cut at the roots of P: no quadrature error.
    Exact,
    /// The points of a Gauss rule on \[0, 1\].
    Gauss(Vec<(f64, f64)>),
}

impl EdgeRule {
    /// The Gauss rule with `n` points.
    pub fn gauss(n: usize) -> Self {
        EdgeRule::Gauss(quadrature::gauss(n))
    }

    /// The integrals of (8) and J_h over an edge, for P with the nodal values `p`.
    pub fn integrals<E, const N: usize, const M: usize>(&self, p: [f64; M]) -> EdgeIntegrals<f64, M>
    where
        E: ExactEdge<f64, N, M>,
    {
        match self {
            EdgeRule::Exact => E::exact(p),
            EdgeRule::Gauss(rule) => edge_integral::gauss::<E, f64, N, M>(p, rule.iter().copied()),
        }
    }

    /// The integral of the Bregman distance of 1/2 \[.\]+^2 from P to Q.
    pub fn bregman<E, const N: usize, const M: usize>(&self, p: [f64; M], q: [f64; M]) -> f64
    where
        E: ExactEdge<f64, N, M>,
    {
        match self {
            EdgeRule::Exact => edge_integral::exact_bregman::<E, N, M>(p, q),
            EdgeRule::Gauss(rule) => {
                edge_integral::gauss_bregman::<E, f64, N, M>(p, q, rule.iter().copied())
            }
        }
    }
}
