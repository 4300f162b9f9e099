//! The course of a solve: the start of Newton's method, and the observer of its progress.
//!
//! A start is a displacement: that of the load step before, or that of a coarser mesh between its vertices. The start says only
//! where on the contact edges P is positive. With H = Psi'' there, the first step solves the problem whose springs
//! of contact are these and no others,
//!
//! A u + B^T H y = l, y = B u + d,
//!
//! which is the solution where contact stays as it was, for Psi'(y) = Psi''(y) y. Any start leads to the same solution: (8) has
//! exactly one, and the verdict is as strict.

use crate::contact::discretization::Discretization;

/// A phase of a solve, as it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Phase {
    /// Nodes, constraints, loads, contact edges.
    Assemble,
    /// The order of elimination, the structure of the factor, the matrix.
    Order,
    /// Sparse Cholesky factorisation of the body.
    Factor,
    /// The compliance of the body at the contact edges.
    Condense,
    /// A step of Newton's method; the first is 1.
    Newton {
        /// Its number.
        step: usize,
    },
    /// Stresses, contact pressure, resultants.
    Evaluate,
}

/// The start and the observer of a solve.
#[derive(Clone, Copy, Default)]
pub struct Course<'a> {
    start: Option<&'a [[f64; 2]]>,
    watcher: Option<&'a dyn Fn(Phase)>,
}

impl<'a> Course<'a> {
    /// Starts from a displacement at the nodes of the problem; another number of values is no start.
    #[must_use]
    pub fn from_displacement(self, start: &'a [[f64; 2]]) -> Self {
        Course { start: Some(start), ..self }
    }

    /// Calls `watcher` as each phase begins.
    #[must_use]
    pub fn watched_by(self, watcher: &'a dyn Fn(Phase)) -> Self {
        Course { watcher: Some(watcher), ..self }
    }

    /// Drops the start, if there is one.
    pub(super) fn afresh(self) -> Option<Self> {
        self.start.map(|_| Course { start: None, ..self })
    }

    pub(crate) fn enters(&self, phase: Phase) {
        if let Some(watcher) = self.watcher {
            watcher(phase);
        }
    }

    /// The start, where it fits.
    pub(super) fn displacement(&self, d: &Discretization) -> Option<&'a [[f64; 2]]> {
        self.start.filter(|u| u.len() == d.space.nodes().len())
    }

    /// P of the start at the nodes of the contact edges.
    pub(super) fn p(&self, d: &Discretization) -> Option<Vec<f64>> {
        let u = self.displacement(d)?;
        Some(d.contact.iter().flat_map(|edge| edge.p(u)).collect())
    }
}
