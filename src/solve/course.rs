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

use std::cell::RefCell;
use std::sync::Arc;

use crate::contact::discretization::Discretization;
use crate::proof::isolated::Known;

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

/// The bounds of the matrix that a proof with Coulomb's friction leaves for the next one. They are taken where all that they are
/// computed from is the same to the last bit, as where loads alone change.
#[derive(Default)]
pub struct Kept(RefCell<Option<Arc<Known>>>);

/// The start and the observer of a solve.
#[derive(Clone, Copy, Default)]
pub struct Course<'a> {
    kept: Option<&'a Kept>,
    start: Option<&'a [[f64; 2]]>,
    watcher: Option<&'a dyn Fn(Phase)>,
}

impl<'a> Course<'a> {
    /// Starts from a displacement at the nodes of the problem; another number of values is no start.
    #[must_use]
    pub fn from_displacement(self, start: &'a [[f64; 2]]) -> Self {
        Course { start: Some(start), ..self }
    }

    /// Takes from what an earlier solve has left what still holds, and leaves its own there.
    #[must_use]
    pub fn keeping(self, kept: &'a Kept) -> Self {
        Course { kept: Some(kept), ..self }
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

    /// The bounds that an earlier solve has left.
    pub(crate) fn kept(&self) -> Option<Arc<Known>> {
        self.kept?.0.borrow().clone()
    }

    /// Leaves bounds for a later solve.
    pub(crate) fn keep(&self, known: &Arc<Known>) {
        if let Some(kept) = self.kept {
            *kept.0.borrow_mut() = Some(Arc::clone(known));
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Friction;
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Diagonal, Problem, Rectangle};
    use crate::solve::{Method, Settings, solve, solve_along};

    /// A block pressed down by `down` on a floor at the depth `gap`, with this coefficient of friction and this modulus.
    fn block(down: f64, gap: f64, coefficient: f64, young: f64) -> Problem {
        let cells = Rectangle { width: 2.0, height: 1.0, nx: 4, ny: 2, diagonal: Diagonal::Right };
        let material = Material::young_poisson(young, 0.3, Plane::Strain);
        Problem::of(cells.mesh().unwrap(), material)
            .with("top", Condition::displacement(|_| 0.01, move |_| -down))
            .with("bottom", Condition::contact(move |_| gap))
            .with_friction("bottom", Friction::Coulomb(coefficient))
    }

    #[test]
    fn bounds_are_kept_where_loads_alone_change_and_prove_what_new_ones_do() {
        let (method, settings, kept) = (Method::default(), Settings::default(), Kept::default());
        let course = Course::default().keeping(&kept);
        let next = |problem: &Problem| {
            let (found, _) = solve_along(problem, &method, &settings, course).unwrap();
            let (alone, _) = solve(problem, &method, &settings).unwrap();
            assert_eq!(found.enclosure, alone.enclosure);
            course.kept().unwrap()
        };
        let first = next(&block(0.1, 0.0, 0.2, 1.0));
        assert!(Arc::ptr_eq(&first, &next(&block(0.08, 0.0, 0.2, 1.0))), "another load");
        assert!(Arc::ptr_eq(&first, &next(&block(0.08, 0.01, 0.2, 1.0))), "another gap");
        let second = next(&block(0.08, 0.01, 0.3, 1.0));
        assert!(!Arc::ptr_eq(&first, &second), "control: another coefficient");
        let third = next(&block(0.08, 0.01, 0.3, 1.0 + f64::EPSILON));
        assert!(!Arc::ptr_eq(&second, &third), "control: another modulus");
    }
}
