//! Psi of a discretization, edge by edge in a given order, without the edges that press in no solution.

use super::body::Edges;
use crate::fem::contact_line::ContactLineEdge;
use crate::fem::discretization::Discretization;
use crate::fem::double_double::DoubleDouble;
use crate::kernel::edge_integral::ExactEdge;

/// The contact edges of `d` in `order`.
pub struct ContactEdges<'a, 'p, E, const N: usize, const M: usize> {
    /// The discretization that they belong to.
    pub d: &'a Discretization<'p, E, N, M>,
    /// Their numbers in its list.
    pub order: &'a [usize],
}

impl<E, const N: usize, const M: usize> ContactEdges<'_, '_, E, N, M> {
    fn edge(&self, e: usize) -> &ContactLineEdge<N, M> {
        &self.d.contact[self.order[e]]
    }

    /// |E| / gamma
    fn weight(&self, e: usize) -> f64 {
        self.edge(e).length / self.edge(e).gamma
    }
}

impl<E, const N: usize, const M: usize> Edges<M> for ContactEdges<'_, '_, E, N, M>
where
    E: ExactEdge<f64, N, M>,
{
    fn count(&self) -> usize {
        self.order.len()
    }

    fn derivatives(&self, e: usize, p: [DoubleDouble; M]) -> ([f64; M], [[f64; M]; M]) {
        if self.d.is_idle(self.order[e]) {
            return ([0.0; M], [[0.0; M]; M]);
        }
        let integrals = self.d.rule.integrals::<E, N, M>(p);
        let weight = self.weight(e);
        (
            integrals.gradient.map(|g| weight * g),
            integrals.hessian.map(|row| row.map(|h| weight * h)),
        )
    }

    fn bregman(&self, e: usize, p: [DoubleDouble; M], q: [DoubleDouble; M]) -> f64 {
        if self.d.is_idle(self.order[e]) {
            return 0.0;
        }
        self.weight(e) * self.d.rule.bregman::<E, N, M>(p, q)
    }
}
