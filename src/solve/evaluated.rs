//! The displacement that a solve ends with, and what the definitions say of it: P on Gamma_C and the residual of (8) at all
//! degrees of freedom, prescribed ones included, where it is the reaction. Forces are differences of stiffnesses times nodal
//! values: where rounding the displacement to doubles would blur them, they are those of the displacement before rounding.

use super::body::block;
use crate::fem::discretization::Discretization;
use crate::fem::double_double::DoubleDouble;
use crate::fem::held::{Play, Slides};
use crate::kernel::edge_integral::ExactEdge;

/// A displacement with its forces.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Evaluated<const M: usize> {
    /// Nodal values.
    pub u: Vec<[f64; 2]>,
    /// P(u) at the nodes of each contact edge.
    pub p: Vec<[DoubleDouble; M]>,
    /// R(u; v) for every basis function v.
    pub residual: Vec<[f64; 2]>,
}

impl<const M: usize> Evaluated<M> {
    /// Evaluates a displacement in doubles.
    pub fn new<E, const N: usize>(d: &Discretization<E, N, M>, u: Vec<[f64; 2]>) -> Self
    where
        E: ExactEdge<f64, N, M>,
    {
        let on_edge = |t: usize| d.space.on_triangle(t, &u);
        let p = d.contact.iter().flat_map(|edge| edge.p(&on_edge(edge.edge.triangle)));
        let p: Vec<DoubleDouble> = p.map(DoubleDouble::from).collect();
        let forces = d.linear_residual(&u).values;
        Evaluated::with(d, u, forces, &p)
    }

    /// Evaluates a displacement whose `forces`, A(u, v) - L(v) for every basis function v, and whose P at the nodes of the
    /// contact edges are known.
    pub fn with<E, const N: usize>(
        d: &Discretization<E, N, M>,
        u: Vec<[f64; 2]>,
        forces: Vec<[f64; 2]>,
        p: &[DoubleDouble],
    ) -> Self
    where
        E: ExactEdge<f64, N, M>,
    {
        let p: Vec<[DoubleDouble; M]> = (0..d.contact.len()).map(|e| block(p, e)).collect();
        let mut residual = forces;
        for (edge, &p) in d.contact.iter().zip(&p) {
            let pressure = d.rule.integrals::<E, N, M>(p).gradient;
            for (g, functional) in pressure.iter().zip(&edge.functionals.p0) {
                let nodes = &d.space.elements()[edge.edge.triangle];
                for (&node, f) in nodes.iter().zip(functional) {
                    for c in 0..2 {
                        residual[node][c] += edge.length / edge.gamma * g * f[c];
                    }
                }
            }
        }
        Evaluated { u, p, residual }
    }

    /// Goes to the solution of least norm, where contact holds the body and there are several: neither the forces nor P where it
    /// presses change by it. Gives how far the body may move from there.
    pub fn settle<E, const N: usize>(&mut self, d: &Discretization<E, N, M>) -> Vec<Play>
    where
        E: ExactEdge<f64, N, M>,
    {
        let Some(slides) = Slides::around(d, &self.u) else { return Vec::new() };
        if slides.count() == 0 {
            return Vec::new();
        }
        slides.least_norm(&mut self.u);
        for (edge, p) in d.contact.iter().zip(&mut self.p) {
            if d.rule.integrals::<E, N, M>(*p).active == 0.0 {
                let there = edge.p(&d.space.on_triangle(edge.edge.triangle, &self.u));
                *p = there.map(|p| p.min(0.0).into());
            }
        }
        slides.plays(&self.u)
    }
}
