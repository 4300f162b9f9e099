//! How far a discrete field is from an exact solution u, in the norms of section 3.3. For v^h and e = u - v^h:
//!
//! energy = a(e, e)^(1/2),  h1 = |e|_{1,Omega} (the full norm),  l2 = |e|_{0,Omega},
//! contact_residual = |gamma^(1/2) (sigma_n(u) + (1/gamma) \[P(v^h)\]+)|_{0,Gamma_C},
//! normal_stress = |gamma^(1/2) sigma_n(e)|_{0,Gamma_C},
//! operator = |gamma^(-1/2) (P(u) - P(v^h))|_{0,Gamma_C}, which only the bound of Theorem 3.4 needs.
//!
//! P(u) has the given gap, P(v^h) its interpolant, as method (8) does. Triangles and edges are cut where u is less smooth,
//! edges also at the roots of P(v^h).

use nalgebra::Vector2;
#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use super::ExactSolution;
use crate::contact::Piece;
use crate::kernel::element::displacement_gradient;
use crate::kernel::{ContactPoint, Element, positive_part};
use crate::model::Problem;
use crate::model::element::with_element;
use crate::model::graded_quadrature::Rule;
use crate::model::space::Space;
use crate::results::Solution;

/// Points in each direction. u is a polynomial of degree at most 7 on each piece for the smooth solutions with whole
/// exponents (exact from 8 points on); for the singular ones the rule converges geometrically away from the singular point
/// and is graded at it. Twice as many points change the errors by less than 1e-10 of themselves, half as many by less than
/// 1e-4 (tests/suite/exact.rs).
pub const POINTS: usize = 10;

/// The distances, each a norm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
pub struct Errors {
    /// a(e, e)^(1/2)
    pub energy: f64,
    /// |e|_{1,Omega}
    pub h1: f64,
    /// |e|_{0,Omega}
    pub l2: f64,
    /// |gamma^(1/2) (sigma_n(u) + (1/gamma) \[P(v^h)\]+)| on Gamma_C
    pub contact_residual: f64,
    /// |gamma^(1/2) sigma_n(e)| on Gamma_C
    pub normal_stress: f64,
    /// |gamma^(-1/2) (P(u) - P(v^h))| on Gamma_C
    #[cfg_attr(feature = "files", serde(skip))]
    pub operator: f64,
}

impl Errors {
    /// The distances of the field with the nodal values `v` from `exact`, with [`POINTS`] points.
    pub fn new(
        space: &Space,
        contact: &[Piece],
        v: &[[f64; 2]],
        exact: &dyn ExactSolution,
    ) -> Self {
        Errors::with_points(space, contact, v, exact, POINTS)
    }

    /// The distances of a solution from an exact solution of `problem`, which is the one that it solves.
    pub fn of(solution: &Solution, problem: &Problem, exact: &dyn ExactSolution) -> Self {
        let space = Space::new(&problem.mesh, solution.degree);
        Errors::new(&space, &solution.pieces, &solution.displacement, exact)
    }

    /// [`Errors::new`] with `points` quadrature points in each direction.
    pub fn with_points(
        space: &Space,
        contact: &[Piece],
        v: &[[f64; 2]],
        exact: &dyn ExactSolution,
        points: usize,
    ) -> Self {
        let rule = Rule::new(exact.features(), points);
        let mut squares = Errors::default();
        with_element!(space.degree(), E => {
            add_triangles::<E, _, _>(&mut squares, space, &rule, v, exact);
        });
        for edge in contact {
            let ends = space.mesh().places_of_ends(edge.edge());
            squares.add_edge(&rule, edge, ends, v, exact);
        }
        // The full norm of H1: so far there is only the seminorm.
        squares.h1 += squares.l2;
        Errors {
            energy: squares.energy.sqrt(),
            h1: squares.h1.sqrt(),
            l2: squares.l2.sqrt(),
            contact_residual: squares.contact_residual.sqrt(),
            normal_stress: squares.normal_stress.sqrt(),
            operator: squares.operator.sqrt(),
        }
    }

    /// Returns whether all are finite: the square of a solution that is hardly integrable is not, in doubles.
    pub fn is_finite(&self) -> bool {
        let all = [self.energy, self.h1, self.l2, self.contact_residual, self.normal_stress];
        all.iter().all(|error| error.is_finite())
    }

    fn add_edge(
        &mut self,
        rule: &Rule,
        edge: &Piece,
        ends: [[f64; 2]; 2],
        v: &[[f64; 2]],
        exact: &dyn ExactSolution,
    ) {
        let (n, gamma, degree) = (edge.normal(), edge.gamma, edge.degree);
        let p = edge.p(v);
        let stress = edge.sigma_n(v);
        rule.on_edge(ends, degree.roots(&p), |point| {
            let (s, x) = (point.s, point.x);
            let exact = ContactPoint {
                u_n: Vector2::from(exact.displacement(x)).dot(&n),
                gap: exact.gap(x),
                sigma_n: exact.stress(x).normal(n),
                gamma,
            };
            let p = degree.value_at(&p, s);
            let residual = exact.sigma_n + positive_part(p) / gamma;
            let stress = exact.sigma_n - ((1.0 - s) * stress[0] + s * stress[1]);
            let weight = point.weight * edge.length;
            self.contact_residual += weight * gamma * residual * residual;
            self.normal_stress += weight * gamma * stress * stress;
            self.operator += weight / gamma * (exact.p() - p) * (exact.p() - p);
        });
    }
}

/// Adds the squares of the errors in the body.
fn add_triangles<E: Element<N, M>, const N: usize, const M: usize>(
    squares: &mut Errors,
    space: &Space,
    rule: &Rule,
    v: &[[f64; 2]],
    exact: &dyn ExactSolution,
) {
    for (triangle, nodes) in space.triangles::<N>() {
        let nodal = nodes.map(|node| Vector2::from(v[node]));
        let barycentric = triangle.barycentric_gradients();
        rule.on_triangle(&triangle, |l, x, weight| {
            let shapes = E::values(l);
            let value: Vector2<f64> = shapes.iter().zip(&nodal).map(|(n, v)| *n * v).sum();
            let e = Vector2::from(exact.displacement(x)) - value;
            let d =
                exact.gradient(x) - displacement_gradient(&nodal, &E::gradients(l, barycentric));
            let [xx, yy, xy] = exact.material().stress(d).components();
            squares.energy += weight * (xx * d.m11 + yy * d.m22 + xy * (d.m12 + d.m21));
            // Row by row.
            squares.h1 += weight * d.transpose().iter().map(|d| d * d).sum::<f64>();
            squares.l2 += weight * e.dot(&e);
        });
    }
}
