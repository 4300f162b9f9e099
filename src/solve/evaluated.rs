//! The displacement that a solve ends with, and what the definitions say of it: P on Gamma_C and the residual of (8) at all
//! degrees of freedom, prescribed ones included, where it is the reaction. Forces are differences of stiffnesses times nodal
//! values: where rounding the displacement to doubles would blur them, they are those of the displacement before rounding.

use crate::fem::discretization::Discretization;
use crate::fem::double_double::DoubleDouble;
use crate::fem::solvability::{Play, Slides};

/// A displacement with its forces.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Evaluated {
    /// Nodal values.
    pub u: Vec<[f64; 2]>,
    /// P(u) at the nodes of each contact edge.
    pub p: Vec<Vec<DoubleDouble>>,
    /// R(u; v) for every basis function v.
    pub residual: Vec<[f64; 2]>,
}

impl Evaluated {
    /// Evaluates a displacement in doubles.
    pub fn new(d: &Discretization, u: Vec<[f64; 2]>) -> Self {
        let p = d.contact.iter().flat_map(|edge| edge.p(&u));
        let p: Vec<DoubleDouble> = p.map(DoubleDouble::from).collect();
        let forces = d.linear_residual(&u).values;
        Evaluated::with(d, u, forces, &p)
    }

    /// Evaluates a displacement whose `forces`, A(u, v) - L(v) for every basis function v, and whose P at the nodes of the
    /// contact edges are known.
    pub fn with(
        d: &Discretization,
        u: Vec<[f64; 2]>,
        forces: Vec<[f64; 2]>,
        p: &[DoubleDouble],
    ) -> Self {
        let p: Vec<Vec<DoubleDouble>> =
            p.chunks_exact(d.space.degree().nodes_per_edge()).map(<[_]>::to_vec).collect();
        let mut residual = forces;
        for (edge, p) in d.contact.iter().zip(&p) {
            let weight = edge.length / edge.gamma;
            let pressure = d.rule.integrals(p).gradient.into_iter().map(|g| weight * g);
            edge.add_contact(&pressure.collect::<Vec<f64>>(), &mut residual);
        }
        Evaluated { u, p, residual }
    }

    /// Goes to the solution of least norm, where contact holds the body and there are several: neither the forces nor P where it
    /// presses change by it. Gives how far the body may move from there.
    pub fn settle(&mut self, d: &Discretization) -> Vec<Play> {
        let Some(slides) = Slides::around(d, &self.u) else { return Vec::new() };
        if slides.count() == 0 {
            return Vec::new();
        }
        slides.least_norm(&mut self.u);
        for (edge, p) in d.contact.iter().zip(&mut self.p) {
            if d.rule.integrals(p).active == 0.0 {
                *p = edge.p(&self.u).into_iter().map(|p| p.min(0.0).into()).collect();
            }
        }
        slides.plays(&self.u)
    }
}
