//! Both sides of Theorem 3.4 for a computed solution: v^h is the Lagrange interpolant of u, or the a-orthogonal projection
//! of u, that is the v^h with the prescribed values and
//!
//! a(v^h, w) = a(u, w) = L(w) + int_{Gamma_C} sigma_n(u) w_n for all w in V^h.

use signorini::contact::Discretization;
use signorini::contact::contact_line::Gamma;
use signorini::exact::{Errors, ExactSolution, errors};
use signorini::linear::factor::Factor;
use signorini::linear::matrix;
use signorini::linear::matrix::{Neighbours, Numbering};
use signorini::linear::ordering::nested_dissection;
use signorini::model::Problem;
use signorini::model::graded_quadrature::Rule;
use signorini::results::Solution;
use signorini::solve::{ContactQuadrature, Gamma0, Method, SolveError, discretize};

use crate::a_priori;

/// The two sides and their ingredients.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Theorem {
    /// kappa = gamma0 C_h < 1.
    pub kappa: f64,
    /// The errors of u^h.
    pub discrete: Errors,
    /// Those of the Lagrange interpolant.
    pub interpolant: Errors,
    /// Those of the a-orthogonal projection.
    pub projection: Errors,
}

impl Theorem {
    /// Evaluates both sides for `solution`, the solution of `problem`, whose exact solution is `exact`.
    ///
    /// # Errors
    /// As [`solve`](signorini::solve::solve).
    pub fn new(
        problem: &Problem,
        solution: &Solution,
        exact: &dyn ExactSolution,
    ) -> Result<Self, SolveError> {
        let method = Method {
            degree: solution.degree,
            gamma0: match solution.gamma.gamma {
                Gamma::Uniform(gamma0) => Gamma0::Value(gamma0),
                Gamma::Local(kappa) => Gamma0::Local(kappa),
            },
            quadrature: ContactQuadrature::Exact,
            allow_noncoercive: true,
        };
        let d = discretize(problem, &method)?;
        let of = |v: &[[f64; 2]]| Errors::new(&d.space, &d.contact, v, exact);
        Ok(Theorem {
            kappa: d.kappa(),
            discrete: of(&solution.displacement),
            interpolant: of(&interpolant(&d, exact)),
            projection: of(&projection(&d, exact)?),
        })
    }

    /// The left side.
    pub fn left(&self) -> f64 {
        a_priori::left(self.kappa, &self.discrete)
    }

    /// The right side of Theorem 9.1 for the interpolant.
    pub fn plain(&self) -> f64 {
        a_priori::plain(self.kappa, &self.interpolant)
    }

    /// The right side of Theorem 9.3 for the interpolant.
    pub fn sharp(&self) -> f64 {
        a_priori::sharp(self.kappa, &self.interpolant)
    }

    /// The right side of Theorem 9.4 for the projection.
    pub fn projected(&self) -> f64 {
        a_priori::projected(self.kappa, &self.projection)
    }

    /// The right side of Corollary 3.6, the smaller of the two.
    pub fn corollary(&self) -> f64 {
        let of = |eta| a_priori::corollary(self.kappa, &self.discrete, eta);
        of(&self.interpolant).min(of(&self.projection))
    }
}

fn interpolant(d: &Discretization, exact: &dyn ExactSolution) -> Vec<[f64; 2]> {
    d.space.nodes().iter().map(|&x| exact.displacement(x)).collect()
}

/// The a-orthogonal projection: one linear solve with the matrix of a(.,.).
fn projection(d: &Discretization, exact: &dyn ExactSolution) -> Result<Vec<[f64; 2]>, SolveError> {
    let mut v = d.constraints.lift();
    // L(w) + int sigma_n(u) w_n - a(lift, w)
    let mut force = d.load.clone();
    for (force, inner) in force.iter_mut().zip(d.internal_forces(&v).values) {
        *force = [force[0] - inner[0], force[1] - inner[1]];
    }
    let rule = Rule::new(exact.features(), errors::POINTS);
    for edge in &d.contact {
        let ends = d.space.mesh().places_of_ends(edge.edge());
        let (nodes, normal) = (d.space.edge_nodes(edge.edge()).collect::<Vec<_>>(), edge.normal());
        rule.on_edge(ends, [], |point| {
            let sigma_n = exact.stress(point.x).normal(normal);
            let shapes = d.space.degree().edge_values(point.s);
            for (&node, shape) in nodes.iter().zip(shapes) {
                for c in 0..2 {
                    let weight = point.weight * edge.length * shape;
                    force[node][c] += weight * sigma_n * normal[c];
                }
            }
        });
    }
    let neighbours = Neighbours::new(&d.space);
    let order = nested_dissection(d.space.nodes(), &neighbours);
    let numbering = Numbering::under(&order, &d.constraints);
    let matrix =
        matrix::assemble_stiffness(d, &numbering, &neighbours).map_err(SolveError::from)?;
    let factor = Factor::new(&matrix)?;
    let mut x = numbering.gather(&force);
    factor.forward(&mut x);
    factor.backward(&mut x);
    numbering.scatter(&x, &mut v);
    Ok(v)
}
