//! L(v) = int_Omega f . v + int_{Gamma_N} t . v for every basis function v.

use super::problem::{BoxedFunction, Condition, DataError, Problem, finite};
use super::quadrature;
use super::space::Space;
use crate::kernel::Element;
use crate::kernel::triangle::on_edge;

/// Points along each direction of the rules for loads. Five make them exact for polynomials of degree 8 on a triangle and
/// 9 on an edge: a load of degree 6 times a quadratic shape function.
const POINTS: usize = 5;

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

/// Neither component of a load acts anywhere.
fn vanishes(load: &[BoxedFunction; 2]) -> bool {
    load.iter().all(|f| f.constant() == Some(0.0))
}

fn add_body_force<E: Element<N, M>, const N: usize, const M: usize>(
    problem: &Problem,
    space: &Space<E, N, M>,
    load: &mut [[f64; 2]],
) -> Result<(), DataError> {
    if vanishes(&problem.body_force) {
        return Ok(());
    }
    let rule: Vec<([f64; 3], [f64; N], f64)> = quadrature::triangle(POINTS)
        .into_iter()
        .map(|(l, weight)| (l, E::values(l), weight))
        .collect();
    for (triangle, nodes) in space.triangles() {
        let area = triangle.double_area() / 2.0;
        for (l, shapes, weight) in &rule {
            let x = triangle.point(*l);
            for (c, f) in problem.body_force.iter().enumerate() {
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
    let rule = quadrature::gauss(POINTS);
    for &edge in space.mesh().edges_of(name)? {
        let (length, _) = space.mesh().length_and_normal(edge);
        let triangle = space.mesh().triangle(edge.triangle);
        for &(s, weight) in &rule {
            let x = triangle.point(on_edge(edge.local, s));
            let shapes: [f64; M] = E::edge_values(s);
            for (c, t) in traction.iter().enumerate() {
                let what = || format!("[boundary.{name}] traction[{c}]");
                let t = weight * length * finite(&**t, x, what)?;
                for (node, shape) in space.edge_nodes(edge).into_iter().zip(shapes) {
                    load[node][c] += t * shape;
                }
            }
        }
    }
    Ok(())
}
