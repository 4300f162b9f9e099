//! The linear part of (8) at a displacement that is known to more than double precision, evaluated from the definitions in
//! [twofold](crate::fem::twofold) numbers: what is left of forces that cancel is then known to the last bit of a double.

use nalgebra::Vector2;

use super::contact_line::ContactLineEdge;
use super::discretization::Discretization;
use crate::fem::twofold::Twofold;
use crate::kernel::edge_integral::ExactEdge;
use crate::kernel::element::displacement_gradient;
use crate::kernel::{ContactEdge, Triangle};

/// A(u, v) - L(v) for every basis function v, and the values of P(u) at the nodes of each contact edge.
pub fn evaluate<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    u: &[[Twofold; 2]],
) -> (Vec<[f64; 2]>, Vec<f64>)
where
    E: ExactEdge<f64, N, M>,
{
    let zero = Twofold::from(0);
    let mut forces: Vec<[Twofold; 2]> =
        d.load.iter().map(|l| l.map(|l| -Twofold::from(l))).collect();
    for (t, (triangle, nodes)) in d.space.triangles().enumerate() {
        let triangle = exact(triangle);
        let material = d.problem.material.of(t).map(Twofold::from);
        let nodal = d.space.elements()[t].map(|node| Vector2::from(u[node]));
        let barycentric = triangle.barycentric_gradients();
        let area = triangle.double_area() / Twofold::from(2);
        E::at_stiffness_points(|l: [Twofold; 3], weight| {
            let gradients = E::gradients(l, barycentric);
            let stress = material.stress(displacement_gradient(&nodal, &gradients));
            for (&node, g) in nodes.iter().zip(gradients) {
                let force = stress.traction(g);
                for c in 0..2 {
                    forces[node][c] += weight * area * force[c];
                }
            }
        });
    }
    let mut p = Vec::with_capacity(M * d.contact.len());
    for edge in &d.contact {
        let nodes = &d.space.elements()[edge.edge.triangle];
        let nodal = nodes.map(|node| Vector2::from(u[node]));
        let functionals = functionals(d, edge);
        let apply = |functional: &[Vector2<Twofold>; N]| {
            functional.iter().zip(&nodal).fold(zero, |sum, (f, u)| sum + f[0] * u[0] + f[1] * u[1])
        };
        for a in 0..M {
            p.push((apply(&functionals.p0[a]) - Twofold::from(edge.gap[a])).head());
        }
        let [start, end] = [0, 1].map(|a| apply(&functionals.sigma_n[a]));
        let mass = -(Twofold::from(edge.gamma) * Twofold::from(edge.length)) / Twofold::from(6);
        let two = Twofold::from(2);
        let stress = [mass * (two * start + end), mass * (start + two * end)];
        for (functional, factor) in functionals.sigma_n.iter().zip(stress) {
            for (&node, f) in nodes.iter().zip(functional) {
                for c in 0..2 {
                    forces[node][c] += factor * f[c];
                }
            }
        }
    }
    (forces.into_iter().map(|f| f.map(Twofold::head)).collect(), p)
}

fn exact(t: Triangle<f64>) -> Triangle<Twofold> {
    Triangle { vertices: t.vertices.map(|x| x.map(Twofold::from)) }
}

/// P0 and sigma_n on a contact edge.
pub fn functionals<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    edge: &ContactLineEdge<N, M>,
) -> ContactEdge<Twofold, N, M>
where
    E: ExactEdge<f64, N, M>,
{
    let triangle = exact(d.space.mesh().triangle(edge.edge.triangle));
    let n = edge.normal.map(Twofold::from);
    let material = d.problem.material.of(edge.edge.triangle).map(Twofold::from);
    let gamma = Twofold::from(edge.gamma);
    if edge.directions == [edge.normal; M] {
        ContactEdge::new::<E>(&triangle, edge.edge.local, n, &material, gamma)
    } else {
        let along = edge.directions.map(|d| d.map(Twofold::from));
        ContactEdge::along::<E>(&triangle, edge.edge.local, n, &along, &material, gamma)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::fem::contact_line::EdgeRule;
    use crate::fem::{BoxedFunction, Condition, Diagonal, Problem, Rectangle};
    use crate::kernel::{Material, P1, P2, Plane};

    fn block() -> Problem {
        let zero = || -> BoxedFunction { Box::new(|_: [f64; 2]| 0.0) };
        Problem::new(
            Rectangle { width: 3.0, height: 1.0, nx: 3, ny: 2, diagonal: Diagonal::Left }
                .mesh()
                .unwrap(),
            Material::lame(3.0, 0.7, Plane::Strain),
            [zero(), Box::new(|[x, _]: [f64; 2]| x - 1.0)],
            BTreeMap::from([
                ("top".to_owned(), Condition::Displacement([Some(zero()), Some(zero())])),
                (
                    "bottom".to_owned(),
                    Condition::Contact { gap: Box::new(|[x, _]: [f64; 2]| x / 7.0) },
                ),
            ]),
        )
    }

    /// The residual in twofold numbers is the one in doubles, to the rounding of the latter; a change of u far below its
    /// rounding shows in P as it should.
    fn agrees_and_sees_more<E: ExactEdge<f64, N, M>, const N: usize, const M: usize>() {
        let problem = block();
        let d =
            Discretization::<E, N, M>::new(&problem, |c| c.limit() / 2.0, EdgeRule::Exact).unwrap();
        let mut u: Vec<[f64; 2]> = vec![[0.0; 2]; d.space.nodes().len()];
        for (i, u) in u.iter_mut().enumerate() {
            *u = [(i as f64).sin(), (2.0 * i as f64).cos()];
        }
        let mut fine: Vec<[Twofold; 2]> = u.iter().map(|u| u.map(Twofold::from)).collect();
        let (forces, p) = evaluate(&d, &fine);
        let doubles = d.linear_residual(&u);
        for ((a, b), m) in forces.iter().zip(&doubles.values).zip(&doubles.magnitudes) {
            for c in 0..2 {
                assert!((a[c] - b[c]).abs() <= 8.0 * f64::EPSILON * m[c]);
            }
        }
        let shift = 2.0_f64.powi(-90);
        for u in &mut fine {
            u[1] += Twofold::from(shift);
        }
        let (_, moved) = evaluate(&d, &fine);
        // A translation by shift along y changes u_n by -shift and no stress.
        let change: Vec<f64> = p.iter().zip(&moved).map(|(p, moved)| moved - p).collect();
        assert!(change.iter().all(|c| c.abs() <= f64::EPSILON), "{change:?}");
        let at = d.contact[0].edge.triangle;
        let node = d.space.edge_nodes(d.contact[0].edge)[0];
        let exactly = |u: &[[Twofold; 2]]| u[node][1] - Twofold::from(u[node][1].head());
        assert_eq!(exactly(&fine).head(), shift, "{at}");
    }

    #[test]
    fn twofold_residuals_agree_with_those_in_doubles_and_keep_more_of_u() {
        agrees_and_sees_more::<P1, 3, 2>();
        agrees_and_sees_more::<P2, 6, 3>();
    }
}
