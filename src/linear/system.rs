//! The linear part of (8) as matrices over the free degrees of freedom: A in an order of elimination, the structure of its
//! factor, and B, the values of P0 at the nodes of the pieces of Gamma_C. The tangent A + B^T Psi'' B has the pattern of A, which is
//! joined over the triangles of each piece.

use std::borrow::Cow;
use std::cell::{Cell, OnceCell};
use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;

use super::factor::{Factor, Structure};
use super::ordering::nested_dissection;
use crate::contact::discretization::Discretization;
use crate::contact::{Piece, residual};
use crate::kernel::ball::larger;
use crate::kernel::{DoubleDouble, PreciseBall};
use crate::linear::matrix;
use crate::linear::matrix::{LowerTriangle, Neighbours, Numbering, OutsidePattern};
use crate::model::material::least_eigenvalue;
use crate::solve::SolveError;
use crate::solve::{Course, Phase};

/// The matrices of a discretization.
pub struct System<'d, 'p> {
    /// The discretization.
    pub d: &'d Discretization<'p>,
    /// The free degrees of freedom in the order of elimination.
    pub numbering: Numbering,
    /// A
    pub matrix: LowerTriangle,
    /// The structure of the factor of A and of every tangent.
    pub(crate) structure: Arc<Structure>,
    pub(crate) course: Course<'d>,
    /// The entries of B.
    functionals: Arc<[Entry]>,
    /// The pieces of Gamma_C in double-doubles, once they are needed.
    fine: OnceCell<Vec<Piece<DoubleDouble>>>,
    /// The Newton steps so far.
    steps: Cell<usize>,
}

/// An entry of B.
struct Entry {
    unknown: usize,
    functional: usize,
    value: f64,
}

/// A tangent with its factor.
#[derive(Clone)]
pub struct Factored {
    /// L of A + B^T h B.
    pub(crate) factor: Arc<Factor>,
    /// The blocks of h, one for each piece; none at all for A itself.
    pub(crate) springs: Arc<[DMatrix<f64>]>,
}

impl From<Arc<Factor>> for Factored {
    /// A itself with its factor.
    fn from(factor: Arc<Factor>) -> Self {
        Factored { factor, springs: Arc::new([]) }
    }
}

impl Factored {
    /// Returns whether piece `e` has other springs here than `h`.
    fn differs(&self, e: usize, h: &DMatrix<f64>) -> bool {
        let acts = |h: &&DMatrix<f64>| h.iter().any(|h| *h != 0.0);
        self.springs.get(e).filter(acts) != Some(h).filter(acts)
    }
}

/// The entries of B, piece by piece.
fn entries(d: &Discretization, numbering: &Numbering) -> Arc<[Entry]> {
    let mut entries = Vec::new();
    for piece in &d.contact {
        for (functional, row) in piece.functionals().zip(&piece.p0) {
            for (&node, &values) in piece.nodes.iter().zip(row) {
                let values = numbering.in_frame(node, values.into());
                for (number, value) in numbering.of[node].iter().zip(values) {
                    let entry = |unknown| Entry { unknown, functional, value };
                    entries.extend(number.map(entry));
                }
            }
        }
    }
    entries.into()
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
        let functionals = entries(d, &numbering);
        Ok(System {
            d,
            numbering,
            matrix,
            structure,
            course,
            functionals,
            fine: OnceCell::new(),
            steps: Cell::new(0),
        })
    }

    /// Shares the matrices with a discretization that differs in the laws of its pieces alone.
    pub(crate) fn with_other_laws<'e>(
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
            functionals: Arc::clone(&self.functionals),
            fine: OnceCell::new(),
            steps: Cell::new(self.steps.get()),
        }
    }

    /// Reports that a Newton step begins.
    pub(crate) fn enters_step(&self) {
        self.steps.set(self.steps.get() + 1);
        self.course.enters(Phase::Newton { step: self.steps.get() });
    }

    /// P(u) at the nodes of each piece, in double-doubles.
    pub(crate) fn fine_p(&self, u: &[[DoubleDouble; 2]]) -> Vec<DoubleDouble> {
        let pieces = || self.d.contact.iter().map(|e| residual::exact_piece(self.d, e)).collect();
        self.fine.get_or_init(pieces).iter().flat_map(|piece| piece.p(u)).collect()
    }

    /// The number of functionals.
    pub(crate) fn functionals(&self) -> usize {
        self.d.contact.last().map_or(0, |piece| piece.functionals().end)
    }

    /// The free degrees of freedom on the triangles of piece `e`.
    pub(crate) fn unknowns(&self, e: usize) -> Vec<usize> {
        let nodes = self.d.contact[e].nodes.iter();
        nodes.flat_map(|&node| self.numbering.of[node]).flatten().collect()
    }

    /// For each piece the numbers of its functionals and the free degrees of freedom on its triangles.
    pub(crate) fn pieces(&self) -> Vec<(Range<usize>, Vec<usize>)> {
        let of = |(e, piece): (usize, &Piece)| (piece.functionals(), self.unknowns(e));
        self.d.contact.iter().enumerate().map(of).collect()
    }

    /// A + B^T h B, where `springs` are the blocks of h, one for each piece, with its factor. Of the `last` one all columns of L stay that
    /// no other springs reach.
    ///
    /// # Errors
    /// As [`Factor::with`].
    pub(crate) fn factor(
        &self,
        last: Option<Factored>,
        springs: Vec<DMatrix<f64>>,
    ) -> Result<Factored, SolveError> {
        let Some(last) = last else {
            let tangent = self.tangent(&springs)?;
            let factor = Factor::with(&self.structure, &tangent)?;
            return Ok(Factored { factor: Arc::new(factor), springs: springs.into() });
        };
        let changed: Vec<usize> =
            (0..springs.len()).filter(|&e| last.differs(e, &springs[e])).collect();
        if changed.is_empty() {
            return Ok(last);
        }
        let unknowns = changed.into_iter().flat_map(|e| self.unknowns(e));
        let tangent = self.tangent(&springs)?;
        let factor = last.factor.changed(&tangent, unknowns)?;
        Ok(Factored { factor, springs: springs.into() })
    }

    /// A + B^T h B
    fn tangent(&self, springs: &[DMatrix<f64>]) -> Result<Cow<'_, LowerTriangle>, OutsidePattern> {
        let mut tangent = Cow::Borrowed(&self.matrix);
        for (piece, h) in self.d.contact.iter().zip(springs) {
            if h.iter().any(|h| *h != 0.0) {
                tangent.to_mut().add_contact_springs(&self.numbering, piece, h)?;
            }
        }
        Ok(tangent)
    }

    /// A + B^T h B in balls, from the pieces in balls.
    pub(crate) fn tangent_in_balls<'e>(
        &self,
        pieces: impl Iterator<Item = &'e Piece<PreciseBall>>,
        springs: &[DMatrix<PreciseBall>],
    ) -> Result<LowerTriangle<PreciseBall>, OutsidePattern> {
        let mut tangent = self.matrix.zero_in();
        let body = (&self.d.space, &self.d.problem.material);
        tangent.add_stiffness_of(body, &self.numbering, residual::exactly)?;
        for (piece, h) in pieces.zip(springs) {
            tangent.add_contact_stress(&self.numbering, piece)?;
            tangent.add_contact_springs(&self.numbering, piece, h)?;
        }
        Ok(tangent)
    }

    /// B: calls `f` with the unknown, the number of the functional and the entry.
    pub(crate) fn each_functional(&self, mut f: impl FnMut(usize, usize, f64)) {
        for &Entry { unknown, functional, value } in &*self.functionals {
            f(unknown, functional, value);
        }
    }

    /// B x
    pub(crate) fn values(&self, x: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.functionals()];
        self.each_functional(|row, i, entry| values[i] += entry * x[row]);
        values
    }

    /// r <- r + B^T w
    pub(crate) fn add_forces(&self, w: &[f64], r: &mut [f64]) {
        self.each_functional(|row, i, entry| r[row] += entry * w[i]);
    }

    /// The largest diagonal entry of A, infinite if one is no number. The largest eigenvalue is no smaller.
    pub(crate) fn largest(&self) -> f64 {
        self.diagonal().fold(0.0, larger)
    }

    /// The expected A(v, v) of a `v` with these magnitudes and independent components.
    pub(crate) fn energy_of_unrelated(&self, v: &[[f64; 2]]) -> f64 {
        let v = self.numbering.gather(v);
        self.diagonal().zip(v).map(|(a, v)| a * v * v).sum()
    }

    /// The size that corrections of `u` are measured by while it is refined: |u|_a, which is `norm`. A body without loads that is
    /// moved as a whole has no strain but that of rounding, which no correction betters: there the size is what the norm would
    /// be for independent components of this size. What is proved is not relative to this norm.
    pub(crate) fn size(&self, norm: f64, u: &[[f64; 2]]) -> f64 {
        if self.d.load.as_flattened().iter().any(|&l| l != 0.0) {
            return norm;
        }
        let most = self.energy_of_unrelated(u).sqrt();
        // A smaller strain may be that of rounding u.
        if norm > f64::EPSILON * most { norm } else { most }
    }

    /// The energy norm that the body would have at least with a strain of the size of `u` over the longest side of its box, or of
    /// 1 where that is smaller.
    pub(crate) fn norm_if_strained(&self, u: &[[f64; 2]]) -> f64 {
        let mesh = self.d.space.mesh();
        let ends = |c: usize| {
            let at = mesh.vertices().iter().map(|x| x[c]);
            at.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
        };
        let side = [0, 1].map(ends).into_iter().fold(0.0, |most: f64, [a, b]| most.max(b - a));
        let most = u.iter().fold(0.0, |most: f64, u| most.max(u[0].hypot(u[1])));
        let materials = &self.d.problem.material;
        let least: Vec<f64> = materials.distinct().iter().map(least_eigenvalue).collect();
        let energy_of_unit = |t: usize| {
            let triangle = mesh.triangle(t);
            // In a body of revolution integrals have the weight r.
            let radii = materials.of(t).radii(&triangle);
            let radius = radii.map_or(1.0, |r| r.iter().sum::<f64>() / 3.0);
            radius * triangle.double_area() / 2.0 * least[materials.place_of(t)]
        };
        let square: f64 = (0..mesh.triangles().len()).map(energy_of_unit).sum();
        (most / side).min(1.0) * square.sqrt()
    }

    fn diagonal(&self) -> impl Iterator<Item = f64> {
        let LowerTriangle { starts, values, .. } = &self.matrix;
        starts[..self.numbering.count].iter().map(|&k| values[k])
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::contact::EdgeRule;
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Degree, Mesh, Problem};

    /// A body between r = 1 and r = 2, as long as 3, with a body force.
    fn with_system<T>(plane: Plane, load: f64, f: impl FnOnce(&System) -> T) -> T {
        let vertices = vec![[1.0, 0.0], [2.0, 0.0], [2.0, 3.0], [1.0, 3.0]];
        let named = [("bottom", [0, 1]), ("top", [2, 3])];
        let named = named.map(|(name, edge)| (name.to_owned(), vec![edge]));
        let mesh = Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]], named).unwrap();
        let problem = Problem::of(mesh, Material::lame(1.0, 1.0, plane))
            .with("top", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.0))
            .with_body_force(|_| 0.0, move |_| load);
        let rule = EdgeRule::Exact;
        let d = Discretization::new(&problem, Degree::One, |c| c.limit() / 2.0, rule).unwrap();
        f(&System::new(&d).unwrap())
    }

    #[test]
    fn the_size_of_a_displacement_is_its_norm_unless_no_load_acts_and_all_of_that_is_rounding() {
        let moved = [[0.0, 0.3]; 4];
        let [at_rest, loaded] = [0.0, 1.0].map(|load| {
            with_system(Plane::Strain, load, |system| {
                [0.25, 1e-3, 1e-30].map(|norm| system.size(norm, &moved))
            })
        });
        assert_eq!(loaded, [0.25, 1e-3, 1e-30]);
        assert_eq!(at_rest[..2], [0.25, 1e-3]);
        assert!(at_rest[2] > 1e-3, "{at_rest:?}");
    }

    #[test]
    fn the_norm_if_strained_is_that_of_a_shear_of_the_size_of_the_displacement_over_the_longest_side()
     {
        // v = (0, k r) has no hoop strain and the strain k / 2 across, so |eps|^2 = k^2 / 2 and sigma:eps = mu k^2. Of r the integral over
        // the body is 9/2, of 1 it is 3.
        for (plane, weight) in [(Plane::Axisymmetric, 4.5), (Plane::Strain, 3.0)] {
            for (moved, strain) in [(0.03, 0.01), (6.0, 1.0)] {
                let k = strain * 2.0_f64.sqrt();
                let energy = k * k * weight;
                let found =
                    with_system(plane, 0.0, |system| system.norm_if_strained(&[[0.0, moved]; 4]));
                assert_relative_eq!(found, energy.sqrt(), max_relative = 1e-14);
            }
        }
    }
}
