//! A displacement on its way to the solution, and what the definitions say of it: in doubles as long as these tell enough,
//! in [double-doubles](crate::fem::double_double) where rounding would blur it. It is known to more than double precision
//! itself: rounding the displacement of a slender body to doubles changes its forces by more than its loads. In doubles, too,
//! stresses are those of its differences from node to node, which keep what rounding it would lose.

use nalgebra::Vector2;

use super::system::System;
use crate::fem::contact_line::{ContactLineEdge, EdgeRule, apply};
use crate::fem::discretization::{Discretization, Functional};
use crate::fem::double_double::DoubleDouble;
use crate::fem::precise;
use crate::kernel::edge_integral::ExactEdge;

/// A residual this many unit roundoffs times its magnitudes is noise.
const NOISE: f64 = 4.0;

/// A displacement.
pub struct Iterate {
    u: Vec<[DoubleDouble; 2]>,
}

/// The linear part of (8) at a displacement.
pub struct Evaluation {
    /// A(u, v) - L(v) for every basis function v.
    pub forces: Vec<[f64; 2]>,
    /// Its values for every free degree of freedom.
    pub linear: Vec<f64>,
    /// P(u) at the nodes of the contact edges; negative on those that press in no solution.
    pub p: Vec<DoubleDouble>,
    /// The magnitudes that these were added up from.
    pub p_magnitudes: Vec<f64>,
    /// a(u, u)
    pub energy: f64,
    /// A norm that rounding alone may give the residual.
    pub noise: f64,
    /// A bound of the rounding in the forces.
    pub noise_of_sums: f64,
    /// In double-doubles.
    pub precisely: bool,
}

impl Iterate {
    /// The lift of the prescribed data.
    pub fn lift<E, const N: usize, const M: usize>(d: &Discretization<E, N, M>) -> Self
    where
        E: ExactEdge<f64, N, M>,
    {
        Iterate { u: d.constraints.lift().into_iter().map(|u| u.map(DoubleDouble::from)).collect() }
    }

    /// In doubles.
    pub fn rounded(&self) -> Vec<[f64; 2]> {
        self.u.iter().map(|u| u.map(DoubleDouble::head)).collect()
    }

    /// As it is.
    pub fn as_double_doubles(&self) -> &[[DoubleDouble; 2]] {
        &self.u
    }

    /// The part that rounding to doubles leaves out.
    pub fn remainder(&self) -> Vec<[f64; 2]> {
        self.u.iter().map(|u| u.map(DoubleDouble::tail)).collect()
    }

    /// Adds `t` times a step over the free degrees of freedom.
    pub fn add<E, const N: usize, const M: usize>(
        &mut self,
        system: &System<E, N, M>,
        t: f64,
        step: &[f64],
    ) {
        let mut field = vec![[0.0; 2]; self.u.len()];
        system.numbering.scatter(step, &mut field);
        for (u, step) in self.u.iter_mut().flatten().zip(field.as_flattened()) {
            *u += DoubleDouble::from(t * step);
        }
    }

    /// The linear part of (8) here, in double-doubles if `precisely`.
    pub fn evaluate<E, const N: usize, const M: usize>(
        &self,
        system: &System<E, N, M>,
        precisely: bool,
    ) -> Evaluation
    where
        E: ExactEdge<f64, N, M>,
    {
        let d = system.d;
        // Edges that press in no solution: the body is moved away from them in the end.
        let idle = |(i, p): (usize, DoubleDouble)| {
            if d.is_idle(i / M) && p.head() > 0.0 { -p } else { p }
        };
        if precisely {
            let (forces, p) = precise::evaluate(d, &self.u);
            let p: Vec<DoubleDouble> = p.into_iter().enumerate().map(idle).collect();
            // The forces of contact are added to these in doubles, and the loads are doubles.
            let noise = NOISE * f64::EPSILON * d.free_norm(&forces).max(d.free_norm(&d.load));
            let p_magnitudes = p.iter().map(|p| p.head().abs()).collect();
            let linear = system.numbering.gather(&forces);
            let energy = d.strain_energy(&self.rounded());
            let noise_of_sums = 0.0;
            return Evaluation {
                forces,
                linear,
                p,
                p_magnitudes,
                energy,
                noise,
                noise_of_sums,
                precisely,
            };
        }
        let head = |node: usize| Vector2::from(self.u[node].map(DoubleDouble::head));
        let tail = |node: usize| Vector2::from(self.u[node].map(DoubleDouble::tail));
        let Functional { values: forces, magnitudes, energy } = d
            .linear_residual_by(|node, from| (head(node) - head(from)) + (tail(node) - tail(from)));
        let nodes = |edge: &ContactLineEdge<N, M>| d.space.elements()[edge.edge.triangle];
        let p = |edge: &ContactLineEdge<N, M>| {
            let p = edge.p(&nodes(edge).map(head));
            let of_tail = edge.functionals.p0.map(|f| apply(&f, &nodes(edge).map(tail)));
            std::array::from_fn::<_, M, _>(|a| p[a] + of_tail[a])
        };
        let by_points = matches!(d.rule, EdgeRule::Gauss(_));
        let p: Vec<DoubleDouble> = if by_points {
            precise::p(d, &self.u).enumerate().map(idle).collect()
        } else {
            d.contact.iter().flat_map(p).map(DoubleDouble::from).enumerate().map(idle).collect()
        };
        let magnitude = |functional: &[Vector2<f64>; N], nodal: &[Vector2<f64>; N]| {
            let pairs = functional.iter().flatten().zip(nodal.iter().flatten());
            pairs.map(|(f, u)| (f * u).abs()).sum::<f64>()
        };
        let p_magnitudes = if by_points {
            p.iter().map(|p| p.tail().abs()).collect()
        } else {
            d.contact
                .iter()
                .flat_map(|edge| {
                    let nodal = nodes(edge).map(head);
                    edge.functionals.p0.map(|functional| magnitude(&functional, &nodal))
                })
                .collect()
        };
        let noise = NOISE * f64::EPSILON * d.free_norm(&magnitudes);
        let noise_of_sums = NOISE * f64::EPSILON * magnitudes.as_flattened().iter().sum::<f64>();
        let linear = system.numbering.gather(&forces);
        Evaluation { forces, linear, p, p_magnitudes, energy, noise, noise_of_sums, precisely }
    }
}
