//! Bodies of revolution: exact solutions, Hertz's contact, orders of convergence, the limit of a large radius, bodies at random.
//! docs/theory.md, section 11.

mod anew;
mod answers;
mod half_space;
mod measured;
mod outputs;
mod pairs;
mod random;
mod refused;

use signorini::kernel::{Material, Plane};
use signorini::model::{Condition, Degree, Diagonal, Mesh, Problem, Rectangle};
use signorini::nalgebra::Matrix2;
use signorini::results::Solution;
use signorini::solve::{Settings, solve};

use crate::common::*;

/// Every solve is enclosed this closely, relative and in the energy norm.
const ENCLOSED: f64 = 1e-11;

fn elastic(young: f64, poisson: f64) -> Material<f64> {
    Material::young_poisson(young, poisson, Plane::Axisymmetric)
}

fn solved(problem: &Problem, degree: Degree) -> Solution {
    // The enclosure is made no sharper than it needs.
    let settings = Settings { proof: ENCLOSED, ..Settings::default() };
    let (s, _) = solve(problem, &method(degree, EXACT), &settings).unwrap();
    let enclosure = s.enclosure.as_ref().unwrap();
    assert!(enclosure.relative.is_none_or(|r| r <= ENCLOSED), "{:?}", enclosure.relative);
    s
}

/// The rectangle from r = `inner` to `outer` and from z = 0 to `height`.
fn meridian([inner, outer]: [f64; 2], height: f64, [nx, ny]: [usize; 2], moved: bool) -> Mesh {
    let width = outer - inner;
    let rectangle = Rectangle { width, height, nx, ny, diagonal: Diagonal::Right };
    let mesh =
        if moved { rectangle.perturbed(0.15, 3).unwrap() } else { rectangle.mesh().unwrap() };
    moved_to(&mesh, |[x, y]| [inner + x, y])
}

/// u_z = 0 at a height, u_r free.
fn flat_roller() -> Condition {
    Condition::Displacement([None, Some(constant(0.0))])
}

/// A field with its strains: u, du_i/dx_j and the hoop strain.
type Exact<'a> = &'a dyn Fn([f64; 2]) -> ([f64; 2], Matrix2<f64>, f64);

/// The errors in the energy norm and in L^2, both with the weight r, by a rule of degree 5.
fn errors(problem: &Problem, s: &Solution, exact: Exact) -> [f64; 2] {
    let root = 15.0_f64.sqrt();
    let mut rule = vec![([1.0 / 3.0; 3], 0.225)];
    for sign in [1.0, -1.0] {
        let (a, weight) = ((6.0 - sign * root) / 21.0, (155.0 - sign * root) / 1200.0);
        for i in 0..3 {
            let mut l = [a; 3];
            l[i] = 1.0 - 2.0 * a;
            rule.push((l, weight));
        }
    }
    let mut squares = [0.0; 2];
    for (t, nodes) in s.elements.chunks_exact(s.nodes_per_triangle).enumerate() {
        let (triangle, material) = (problem.mesh.triangle(t), problem.material.of(t));
        let (slopes, area) = (triangle.barycentric_gradients(), triangle.double_area() / 2.0);
        let radii = triangle.vertices.map(|x| x[0]);
        let strains = s.degree.hoop_strain(radii, |j| s.displacement[nodes[j]][0]);
        for &(l, weight) in &rule {
            let x: [f64; 2] = triangle.point(l).into();
            let (u, gradient, hoop) = exact(x);
            let found =
                s.degree.displacement_gradient(l, slopes, |j| s.displacement[nodes[j]].into());
            let (off, hoop) = (found - gradient, s.degree.value_from_points(strains, l) - hoop);
            let (stress, hoop_stress) = material.stress_of_revolution(off, hoop);
            let weight = weight * area * x[0];
            squares[0] += weight * (stress.matrix().dot(&off) + hoop_stress * hoop);
            let at = s.displacement_at(t, l);
            squares[1] += weight * ((at[0] - u[0]).powi(2) + (at[1] - u[1]).powi(2));
        }
    }
    squares.map(f64::sqrt)
}
