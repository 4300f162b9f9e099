//! Small bodies whose coercivity is looked at, and gamma0 by kappa. How sharp the limit 1/C_h of gamma0 is:
//! `props/tests/program/sharpness.rs`.

use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Diagonal, Mesh, Problem};
use signorini::solve::{Gamma0, Method};

use crate::claim::text;
use crate::problems::{self, cells, floor, held, mapped, unloaded};

/// What went wrong, in words.
type Result<T> = std::result::Result<T, String>;

/// The body clamped on the named sides, in contact at the bottom.
pub fn clamped(mesh: Mesh, material: Material<f64>, sides: &[&str]) -> Problem {
    let mut problem = unloaded(mesh, material, [("bottom", floor(0.0))]);
    problem.conditions.extend(sides.iter().map(|&side| (side.to_owned(), held([0.0; 2]))));
    problem
}

/// The material with lambda and mu = 1.
fn material(lambda: f64, plane: Plane) -> Material<f64> {
    Material::lame(lambda, 1.0, plane)
}

/// The trapezoid (-3, 0), (3, 0), (0, 4), (e, 4), which attains the limit as e goes to 0.
pub fn trapezoid(e: f64) -> Result<Problem> {
    let vertices = vec![[-3.0, 0.0], [3.0, 0.0], [0.0, 4.0], [e, 4.0]];
    let sides = [("bottom", [0, 1]), ("top", [2, 3])];
    let mesh = problems::mesh(vertices, vec![[0, 1, 2], [1, 3, 2]], sides)?;
    Ok(clamped(mesh, material(1.0, Plane::Strain), &["top"]))
}

/// Unit cells whose vertices are moved at random by up to 0.2, to multiples of 1/32: areas stay short fractions.
///
/// # Errors
/// A mesh that is none.
pub fn moved(size: [usize; 2], seed: u64) -> Result<Mesh> {
    let mesh = cells(size, Diagonal::Right).perturbed(0.2, seed).map_err(text)?;
    mapped(&mesh, |x| x.map(|c| (32.0 * c).round() / 32.0))
}

/// The method with this kappa, also beyond 1.
pub fn at_kappa(problem: &Problem, degree: Degree, kappa: f64) -> Result<Method> {
    let method = Method { degree, ..Method::default() };
    let outline = signorini::solve::check(problem, &method).map_err(text)?;
    let gamma0 = Gamma0::Value(kappa * outline.gamma.coercivity.limit());
    Ok(Method { gamma0, allow_noncoercive: true, ..method })
}
