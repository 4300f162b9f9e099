//! The loops of the residual of method (8),
//!
//! R(u; v) = A(u, v) + int (1/gamma) \[P(u)\]+ P0(v) - L(v),
//!
//! over any numbers, for every basis function v and straight from the definitions: stresses are integrated against strains,
//! no matrix is involved. In doubles they are the solver's ([`Discretization::residual`]); in
//! [double-doubles](crate::kernel::double_double) what is left of forces that cancel is known to the last bit of a double; balls
//! bound the rounding; over rationals `props` compares them with the definitions.

use nalgebra::{Matrix2, Vector2};

use super::contact_face::ContactFace;
use super::discretization::Discretization;
use super::element::with_element;
use super::material::Materials;
use super::space::Space;
use crate::kernel::DoubleDouble;
use crate::kernel::element::displacement_gradient;
use crate::kernel::{Element, Material, Scalar, Stress, Triangle};

/// A stress at a point of the rule on a triangle, and what it is made of.
pub(super) struct StressPoint<'a, S> {
    /// The nodes of the triangle.
    pub nodes: &'a [usize],
    /// The displacement at each node less that at the first: what moves the triangle as a whole would cancel.
    pub nodal: &'a [Vector2<S>],
    /// The gradients of the shape functions.
    pub slopes: &'a [Vector2<S>],
    /// The material, in doubles.
    pub material: &'a Material<f64>,
    /// du_i/dx_j
    pub gradient: Matrix2<S>,
    /// sigma(u)
    pub stress: Stress<S>,
    /// The weight of the point, an area.
    pub weight: S,
}

impl<S: Scalar> StressPoint<'_, S> {
    /// Calls `add` with each node, the force of the stress on it and the gradient of its shape function.
    #[inline]
    pub(crate) fn each_force(&self, mut add: impl FnMut(usize, Vector2<S>, Vector2<S>)) {
        for (&node, &slope) in self.nodes.iter().zip(self.slopes) {
            add(node, self.stress.traction(slope) * self.weight, slope);
        }
    }
}

/// Calls `f` with the stresses of a displacement, given by its `difference` between nodes: the first node's value less the
/// second one's. Triangles that move as a whole are passed over: most of a lift is zero.
#[inline]
pub(super) fn each_stress<S: Scalar + From<f64>>(
    space: &Space,
    materials: &Materials,
    in_numbers: impl Fn(Triangle<f64>) -> Triangle<S>,
    difference: impl Fn(usize, usize) -> Vector2<S>,
    f: impl FnMut(&StressPoint<S>),
) {
    with_element!(space.degree(), E => {
        each_stress_of::<E, _, _, _>(space, materials, in_numbers, difference, f);
    });
}

fn each_stress_of<E, const N: usize, const M: usize, S>(
    space: &Space,
    materials: &Materials,
    in_numbers: impl Fn(Triangle<f64>) -> Triangle<S>,
    difference: impl Fn(usize, usize) -> Vector2<S>,
    mut f: impl FnMut(&StressPoint<S>),
) where
    E: Element<N, M>,
    S: Scalar + From<f64>,
{
    let mut points = Vec::new();
    E::at_stiffness_points(|l: [S; 3], weight| points.push((l, weight)));
    let (one, half) = (<S as From<i32>>::from(1), <S as From<f64>>::from(0.5));
    for (t, (triangle, nodes)) in space.triangles::<N>().enumerate() {
        let nodal = nodes.map(|node| difference(node, nodes[0]));
        if nodal == [Vector2::zeros(); N] {
            continue;
        }
        let material = materials.of(t);
        let law = material.map(<S as From<f64>>::from);
        // As `Triangle::barycentric_gradients` has them, with one division: in most numbers they are dear.
        let triangle = in_numbers(triangle);
        let double_area = triangle.double_area();
        let inverse = one / double_area;
        let barycentric = [0, 1, 2].map(|i| -triangle.scaled_normal(i) * inverse);
        let area = double_area * half;
        for &(l, weight) in &points {
            let slopes = E::gradients(l, barycentric);
            let gradient = displacement_gradient(&nodal, &slopes);
            f(&StressPoint {
                nodes,
                nodal: &nodal,
                slopes: &slopes,
                material,
                gradient,
                stress: law.stress(gradient),
                weight: weight * area,
            });
        }
    }
}

/// Adds a(u, v) for every basis function v.
pub fn add_internal_forces<S: Scalar + From<f64>>(
    space: &Space,
    materials: &Materials,
    u: &[[S; 2]],
    forces: &mut [[S; 2]],
) {
    let difference = |node: usize, from: usize| Vector2::from(u[node]) - Vector2::from(u[from]);
    each_stress(space, materials, exactly, difference, |point| {
        point.each_force(|node, force, _| {
            forces[node][0] += force[0];
            forces[node][1] += force[1];
        });
    });
}

/// A(u, v) - L(v) for every basis function v, with these contact edges.
pub fn linear_residual<S: Scalar + From<f64>>(
    d: &Discretization,
    edges: &[ContactFace<S>],
    u: &[[S; 2]],
) -> Vec<[S; 2]> {
    let minus = |l: f64| -<S as From<f64>>::from(l);
    let mut forces: Vec<[S; 2]> = d.load.iter().map(|l| l.map(minus)).collect();
    add_internal_forces(&d.space, &d.problem.material, u, &mut forces);
    edges.iter().for_each(|edge| edge.add_stresses(u, &mut forces));
    forces
}

/// A(u, v) - L(v) for every basis function v, and the values of P(u) at the nodes of each contact edge, by double-doubles.
pub fn evaluate(d: &Discretization, u: &[[DoubleDouble; 2]]) -> (Vec<[f64; 2]>, Vec<DoubleDouble>) {
    let edges: Vec<ContactFace<DoubleDouble>> = d.contact.iter().map(|e| on_edge(d, e)).collect();
    let forces = linear_residual(d, &edges, u);
    let p = edges.iter().flat_map(|edge| edge.p(u)).collect();
    (forces.into_iter().map(|f| f.map(DoubleDouble::head)).collect(), p)
}

/// The values of P(u) at the nodes of each contact edge, by double-doubles.
pub fn p(d: &Discretization, u: &[[DoubleDouble; 2]]) -> impl Iterator<Item = DoubleDouble> {
    d.contact.iter().flat_map(move |edge| on_edge(d, edge).p(u))
}

/// A contact edge with the doubles that it has, in other numbers.
pub fn on_edge<S: Scalar + From<f64>>(d: &Discretization, edge: &ContactFace) -> ContactFace<S> {
    let exact = <S as From<f64>>::from;
    with_numbers(d, edge, (exact(edge.length), edge.normal.map(exact), exact(edge.gamma)))
}

/// A contact edge with this length, normal and gamma.
pub fn with_numbers<S: Scalar + From<f64>>(
    d: &Discretization,
    edge: &ContactFace,
    numbers: (S, Vector2<S>, S),
) -> ContactFace<S> {
    let t = edge.edge.triangle;
    let triangle = exactly(d.space.mesh().triangle(t));
    let material = d.problem.material.of(t).map(<S as From<f64>>::from);
    edge.in_numbers((&triangle, &material), numbers)
}

/// A triangle of doubles in other numbers, moved so that its first vertex is the origin: far from there sides lose digits.
pub fn exactly<S: Scalar + From<f64>>(t: Triangle<f64>) -> Triangle<S> {
    let first = t.vertices[0];
    let moved = |x: f64, from: f64| {
        let difference = DoubleDouble::sum(x, -from);
        S::from(difference.head()) + S::from(difference.tail())
    };
    Triangle { vertices: t.vertices.map(|x| x.zip_map(&first, moved)) }
}
