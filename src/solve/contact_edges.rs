//! Psi of a discretization, edge by edge in a given order, without the edges that press in no solution.

use nalgebra::DMatrix;

use super::body::Edges;
use crate::fem::ContactFace;
use crate::fem::discretization::Discretization;
use crate::fem::double_double::DoubleDouble;

/// The contact edges of `d` in `order`.
pub struct ContactEdges<'a, 'p> {
    /// The discretization that they belong to.
    pub d: &'a Discretization<'p>,
    /// Their numbers in its list.
    pub order: &'a [usize],
}

impl ContactEdges<'_, '_> {
    fn edge(&self, e: usize) -> &ContactFace {
        &self.d.contact[self.order[e]]
    }

    /// |E| / gamma
    fn weight(&self, e: usize) -> f64 {
        self.edge(e).length / self.edge(e).gamma
    }
}

impl Edges for ContactEdges<'_, '_> {
    fn count(&self) -> usize {
        self.order.len()
    }

    fn nodes(&self) -> usize {
        self.d.space.degree().nodes_per_edge()
    }

    fn derivatives(&self, e: usize, p: &[DoubleDouble]) -> (Vec<f64>, DMatrix<f64>) {
        if self.d.is_idle(self.order[e]) {
            return (vec![0.0; p.len()], DMatrix::zeros(p.len(), p.len()));
        }
        let integrals = self.d.rule.integrals(p);
        let weight = self.weight(e);
        (integrals.gradient.iter().map(|g| weight * g).collect(), weight * integrals.hessian)
    }

    fn bregman(&self, e: usize, p: &[DoubleDouble], q: &[DoubleDouble]) -> f64 {
        if self.d.is_idle(self.order[e]) {
            return 0.0;
        }
        self.weight(e) * self.d.rule.bregman(p, q)
    }
}
