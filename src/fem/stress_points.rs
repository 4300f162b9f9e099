//! The stress of a displacement at the points of the rule on each triangle, in any numbers, and its force on each node: what the
//! integrals a(u, v) of (8) are made of.

use nalgebra::{Matrix2, Vector2};

use super::element::with_element;
use super::material::Materials;
use super::space::Space;
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
