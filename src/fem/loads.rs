//! L(v) = int_Omega f . v + int_{Gamma_N} t . v for every basis function v.

use super::problem::{BoxedFunction, Condition, DataError, Function, Problem, finite};
use super::quadrature;
use super::space::Space;
use crate::kernel::Element;
use crate::kernel::triangle::on_edge;

/// The degree up to which loads that are no polynomials are integrated exactly.
const ENOUGH: u32 = 7;

/// No polynomial gets a rule beyond this degree: by then every digit is right.
const PLENTY: u32 = 24;

/// The degree for which the rule for a load must be exact: that of the load times a shape function of degree `shape`.
fn degree_of(load: &dyn Function, shape: usize) -> usize {
    load.degree().unwrap_or(ENOUGH).min(PLENTY) as usize + shape
}

/// The load is zero everywhere.
fn vanishes(load: &dyn Function) -> bool {
    load.degree() == Some(0) && load.at([0.0, 0.0]) == 0.0
}

/// L at every node and component, prescribed or not.
///
/// # Errors
/// [`DataError::NotFinite`] where a load has no value, and unknown boundary names.
pub fn assemble<E: Element<N, M>, const N: usize, const M: usize>(
    problem: &Problem,
    space: &Space<E, N, M>,
) -> Result<Vec<[f64; 2]>, DataError> {
    let mut load = vec![[0.0; 2]; space.nodes().len()];
    add_body_force(problem, space, &mut load)?;
    for (name, condition) in &problem.conditions {
        if let Condition::Traction(traction) = condition {
            add_traction(name, traction, space, &mut load)?;
        }
    }
    Ok(load)
}

fn add_body_force<E: Element<N, M>, const N: usize, const M: usize>(
    problem: &Problem,
    space: &Space<E, N, M>,
    load: &mut [[f64; 2]],
) -> Result<(), DataError> {
    for (c, f) in problem.body_force.iter().enumerate().filter(|(_, f)| !vanishes(&***f)) {
        // Exact for degree 2n - 2.
        let n = degree_of(&**f, E::DEGREE).div_ceil(2) + 1;
        let rule: Vec<([f64; 3], [f64; N], f64)> = quadrature::triangle(n)
            .into_iter()
            .map(|(l, weight)| (l, E::values(l), weight))
            .collect();
        for (triangle, nodes) in space.triangles() {
            let area = triangle.double_area() / 2.0;
            for (l, shapes, weight) in &rule {
                let x = triangle.point(*l);
                let f = weight * area * finite(&**f, x, || format!("[load] body[{c}]"))?;
                for (&node, shape) in nodes.iter().zip(shapes) {
                    load[node][c] += f * shape;
                }
            }
        }
    }
    Ok(())
}

fn add_traction<E: Element<N, M>, const N: usize, const M: usize>(
    name: &str,
    traction: &[BoxedFunction; 2],
    space: &Space<E, N, M>,
    load: &mut [[f64; 2]],
) -> Result<(), DataError> {
    for (c, t) in traction.iter().enumerate().filter(|(_, t)| !vanishes(&***t)) {
        // Exact for degree 2n - 1.
        let rule = quadrature::gauss(degree_of(&**t, E::DEGREE) / 2 + 1);
        for &edge in space.mesh().edges_of(name)? {
            let (length, _) = space.mesh().length_and_normal(edge);
            let triangle = space.mesh().triangle(edge.triangle);
            for &(s, weight) in &rule {
                let x = triangle.point(on_edge(edge.local, s));
                let what = || format!("[boundary.{name}] traction[{c}]");
                let t = weight * length * finite(&**t, x, what)?;
                let shapes: [f64; M] = E::edge_values(s);
                for (node, shape) in space.edge_nodes(edge).into_iter().zip(shapes) {
                    load[node][c] += t * shape;
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::fem::{Diagonal, Rectangle};
    use crate::kernel::{Material, P2, Plane};

    /// A monomial that says, or hides, that it is one.
    struct Monomial {
        power: i32,
        known: bool,
    }

    impl Function for Monomial {
        fn at(&self, [x, _]: [f64; 2]) -> f64 {
            x.powi(self.power)
        }

        fn degree(&self) -> Option<u32> {
            self.known.then_some(self.power.unsigned_abs())
        }
    }

    /// The total force of x^power on the square of side 2: as a body force in x, as a traction in y.
    fn totals(power: i32, known: bool) -> [f64; 2] {
        let zero = || -> BoxedFunction { Box::new(Monomial { power: 0, known: true }) };
        let load = || -> BoxedFunction { Box::new(Monomial { power, known }) };
        let diagonal = Diagonal::Right;
        let mesh = Rectangle { width: 2.0, height: 2.0, nx: 1, ny: 1, diagonal }.mesh().unwrap();
        let problem = Problem {
            mesh,
            material: Material::lame(1.0, 1.0, Plane::Strain),
            body_force: [load(), Box::new(|_: [f64; 2]| 0.0)],
            conditions: BTreeMap::from([("top".to_owned(), Condition::Traction([zero(), load()]))]),
        };
        let space = Space::<P2, 6, 3>::new(&problem.mesh);
        let load = assemble(&problem, &space).unwrap();
        let sum = |c: usize| load.iter().map(|l| l[c]).sum::<f64>();
        // The traction (1, x^power) on the top adds 2 to the first component.
        [sum(0) - 2.0, sum(1)]
    }

    #[test]
    fn polynomial_loads_are_integrated_exactly_when_they_say_so_and_to_degree_6_anyhow() {
        for power in 0..=20 {
            let line = 2.0_f64.powi(power + 1) / f64::from(power + 1);
            for (total, exact) in totals(power, true).into_iter().zip([2.0 * line, line]) {
                assert!((total - exact).abs() <= 1e-13 * exact, "x^{power}: {total} {exact}");
            }
        }
        for power in 0..=6 {
            let line = 2.0_f64.powi(power + 1) / f64::from(power + 1);
            for (total, exact) in totals(power, false).into_iter().zip([2.0 * line, line]) {
                assert!((total - exact).abs() <= 1e-13 * exact, "x^{power}: {total} {exact}");
            }
        }
    }

    #[test]
    fn control_a_monomial_of_degree_20_needs_its_degree_to_be_known() {
        let exact = 2.0_f64.powi(22) / 21.0;
        assert!((totals(20, false)[0] - exact).abs() > 1e-6 * exact);
    }
}
