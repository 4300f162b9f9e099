//! The discretization of a problem by method (8), and the checks before anything is solved.

use super::error::SolveError;
use super::method::{ContactQuadrature, Gamma0, Method};
use crate::contact::contact_line::{Coercivity, Gamma};
use crate::contact::{Discretization, EdgeRule};
use crate::held::corners;
use crate::model::Problem;
use crate::model::material::largest_entry;
use crate::results::GammaReport;

/// Builds and checks everything that [`solve`](super::solve) needs, short of a matrix.
///
/// # Errors
/// The errors of [`solve`](super::solve) that show before anything is solved.
pub fn check(problem: &Problem, method: &Method) -> Result<Outline, SolveError> {
    Ok(Outline::new(&discretize(problem, method)?))
}

/// The size of a discrete problem and its coercivity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outline {
    /// The number of nodes; each has two degrees of freedom.
    pub(crate) nodes: usize,
    /// How many of the degrees of freedom are prescribed.
    pub(crate) prescribed: usize,
    /// How many edges Gamma_C has.
    pub(crate) contact_edges: usize,
    /// How many rigid motions the supports leave free.
    pub(crate) free_motions: usize,
    /// How many of them contact does not stop either.
    pub slides: usize,
    /// gamma0, kappa and where the limit comes from.
    pub gamma: GammaReport,
}

impl Outline {
    fn new(d: &Discretization) -> Self {
        Outline {
            nodes: d.space.nodes().len(),
            prescribed: d.constraints.values().iter().flatten().flatten().count(),
            contact_edges: d.contact.len(),
            free_motions: d.motions.len(),
            slides: d.slides.as_ref().map_or(0, |slides| slides.basis.len()),
            gamma: GammaReport::new(d),
        }
    }
}

/// Method (8) on the problem's mesh.
///
/// # Errors
/// Data that don't make a problem, supports that hold the body inside its obstacle, and kappa >= 1 without leave.
pub fn discretize<'a>(
    problem: &'a Problem,
    method: &Method,
) -> Result<Discretization<'a>, SolveError> {
    let d = discretize_any(problem, method)?;
    corners::check(&d)?;
    Ok(d)
}

/// As [`discretize`], of a problem that no displacement of finite energy solves, too: (8) has a solution on every mesh.
///
/// # Errors
/// As [`discretize`].
pub fn discretize_any<'a>(
    problem: &'a Problem,
    method: &Method,
) -> Result<Discretization<'a>, SolveError> {
    method.check()?;
    let mut limit = 1.0;
    let gamma = |c: &Coercivity| {
        limit = c.limit();
        match method.gamma0 {
            // The springs between a stiff body and a soft one are those of the soft one.
            Gamma0::Auto if !problem.pairs.is_empty() => Gamma::Local(0.5),
            Gamma0::Auto => Gamma::Uniform(limit / 2.0),
            Gamma0::Value(gamma0) => Gamma::Uniform(gamma0),
            Gamma0::Local(kappa) => Gamma::Local(kappa),
        }
    };
    let rule = match method.quadrature {
        ContactQuadrature::Exact => EdgeRule::Exact,
        ContactQuadrature::Gauss(points) => EdgeRule::gauss(points),
    };
    let d = Discretization::new(problem, method.degree, gamma, rule);
    if !can_be_multiplied(problem) {
        return Err(SolveError::OutOfRange);
    }
    let d = d?;
    if !limit.is_normal() {
        return Err(SolveError::OutOfRange);
    }
    if d.kappa() < 1.0 || method.allow_noncoercive {
        Ok(d)
    } else {
        Err(SolveError::NotCoercive {
            gamma0: d.gamma0,
            kappa: d.kappa(),
            limit: d.coercivity.limit(),
            edge: d.coercivity.limiting_edge,
        })
    }
}

/// Returns whether a number is positive and not between 1/far and far.
pub(super) fn is_out_of_range(x: f64, far: f64) -> bool {
    x > 0.0 && !(1.0 / far..=far).contains(&x)
}

/// The largest entry of a law.
pub(super) fn stiffest(problem: &Problem) -> f64 {
    problem.material.distinct().iter().map(largest_entry).fold(0.0, f64::max)
}

/// Returns whether the products of the lengths and moduli of a problem, some of each, are normal doubles, as far as the numbers
/// are lengths and moduli at all.
fn can_be_multiplied(problem: &Problem) -> bool {
    let extent = |c: usize| {
        let coordinates = || problem.mesh.vertices().iter().map(|x| x[c]);
        let low = coordinates().fold(f64::INFINITY, f64::min);
        coordinates().fold(f64::NEG_INFINITY, f64::max) - low
    };
    let modulus = stiffest(problem);
    let can_be_a_modulus = modulus.is_infinite() || !is_out_of_range(modulus, 1e80);
    !is_out_of_range(extent(0).max(extent(1)), 1e40) && can_be_a_modulus
}
