//! The linear part of (8) as matrices over the free degrees of freedom: A in an order of elimination, the structure of its
//! factor, and B, the values of P0 at the nodes of the pieces of Gamma_C. The tangent A + B^T Psi'' B has the pattern of A, which is
//! joined over the triangles of each piece.

use std::cell::Cell;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;

use super::SolveError;
use super::course::{Course, Phase};
use super::factor::{Factor, Structure};
use super::ordering::nested_dissection;
use crate::fem::Piece;
use crate::fem::discretization::Discretization;
use crate::fem::matrix::{self, LowerTriangle, Neighbours, Numbering};
use crate::kernel::ball::larger;

/// The matrices of a discretization.
pub struct System<'d, 'p> {
    /// The discretization.
    pub d: &'d Discretization<'p>,
    /// The free degrees of freedom in the order of elimination.
    pub numbering: Numbering,
    /// A
    pub matrix: LowerTriangle,
    /// The structure of the factor of A and of every tangent.
    pub structure: Arc<Structure>,
    pub(super) course: Course<'d>,
    /// The Newton steps so far.
    steps: Cell<usize>,
}

impl<'d, 'p> System<'d, 'p> {
    /// The system of a discretization.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`], and [`SolveError::OutsidePattern`].
    pub fn new(d: &'d Discretization<'p>) -> Result<Self, SolveError> {
        System::on(d, Course::default())
    }

    /// The system of a discretization whose solve takes this course.
    ///
    /// # Errors
    /// As [`System::new`].
    pub fn on(d: &'d Discretization<'p>, course: Course<'d>) -> Result<Self, SolveError> {
        course.enters(Phase::Order);
        let neighbours = Neighbours::across(&d.space, &d.contact);
        let order = nested_dissection(d.space.nodes(), &neighbours);
        let numbering = Numbering::under(&order, &d.constraints);
        let matrix = matrix::assemble(d, &numbering, &neighbours)?;
        let structure = Arc::new(Structure::new(&matrix)?);
        Ok(System { d, numbering, matrix, structure, course, steps: Cell::new(0) })
    }

    /// The same matrices for a discretization that differs in the laws of its pieces alone.
    pub(super) fn with_other_laws<'e>(
        &self,
        d: &'e Discretization<'p>,
        course: Course<'e>,
    ) -> System<'e, 'p> {
        System {
            d,
            numbering: self.numbering.clone(),
            matrix: self.matrix.clone(),
            structure: Arc::clone(&self.structure),
            course,
            steps: Cell::new(self.steps.get()),
        }
    }

    /// Reports that a Newton step begins.
    pub(super) fn enters_step(&self) {
        self.steps.set(self.steps.get() + 1);
        self.course.enters(Phase::Newton { step: self.steps.get() });
    }

    /// The number of functionals.
    pub fn functionals(&self) -> usize {
        self.d.contact.last().map_or(0, |piece| piece.functionals().end)
    }

    /// The free degrees of freedom on the triangles of piece `e`.
    pub fn unknowns(&self, e: usize) -> Vec<usize> {
        let nodes = self.d.contact[e].nodes.iter();
        nodes.flat_map(|&node| self.numbering.of[node]).flatten().collect()
    }

    /// For each piece the numbers of its functionals and the free degrees of freedom on its triangles.
    pub fn pieces(&self) -> Vec<(Range<usize>, Vec<usize>)> {
        let of = |(e, piece): (usize, &Piece)| (piece.functionals(), self.unknowns(e));
        self.d.contact.iter().enumerate().map(of).collect()
    }

    /// L of A + B^T h B, where `springs` are the blocks of h, one for each piece.
    ///
    /// # Errors
    /// As [`Factor::with`].
    pub(super) fn factor(&self, springs: &[DMatrix<f64>]) -> Result<Arc<Factor>, SolveError> {
        let mut tangent = self.matrix.clone();
        for (piece, h) in self.d.contact.iter().zip(springs) {
            tangent.add_contact_springs(&self.numbering, piece, h)?;
        }
        Factor::with(&self.structure, &tangent).map(Arc::new)
    }

    /// B: calls `f` with the unknown, the number of the functional and the entry.
    pub fn each_functional(&self, mut f: impl FnMut(usize, usize, f64)) {
        for piece in &self.d.contact {
            for (i, functional) in piece.functionals().zip(&piece.p0) {
                for (&node, &entries) in piece.nodes.iter().zip(functional) {
                    let entries = self.numbering.in_frame(node, entries.into());
                    for (number, entry) in self.numbering.of[node].iter().zip(entries) {
                        if let Some(number) = *number {
                            f(number, i, entry);
                        }
                    }
                }
            }
        }
    }

    /// r <- r + B^T w
    pub(super) fn add_forces(&self, w: &[f64], r: &mut [f64]) {
        self.each_functional(|row, i, entry| r[row] += entry * w[i]);
    }

    /// The largest diagonal entry of A, infinite if one is no number. The largest eigenvalue is no smaller.
    pub fn largest(&self) -> f64 {
        self.diagonal().fold(0.0, larger)
    }

    /// The expected A(v, v) of a `v` with these magnitudes and independent components.
    pub(crate) fn energy_of_unrelated(&self, v: &[[f64; 2]]) -> f64 {
        let v = self.numbering.gather(v);
        self.diagonal().zip(v).map(|(a, v)| a * v * v).sum()
    }

    /// The size that errors of `u` are relative to: |u|_a, which is `norm`. A body without loads that is moved as a whole has
    /// no strain but that of rounding: there it is what the norm would be if the components of u knew nothing of each other.
    pub fn size(&self, norm: f64, u: &[[f64; 2]]) -> f64 {
        if self.d.load.as_flattened().iter().any(|&l| l != 0.0) {
            return norm;
        }
        let most = self.energy_of_unrelated(u).sqrt();
        // A strain of this size is that of rounding u.
        if norm > f64::EPSILON * most { norm } else { most }
    }

    fn diagonal(&self) -> impl Iterator<Item = f64> {
        let LowerTriangle { starts, values, .. } = &self.matrix;
        starts[..self.numbering.count].iter().map(|&k| values[k])
    }
}
