//! The stress of a displacement at the points of the rule on each triangle, in any numbers, and its force on each node: what the
//! integrals a(u, v) of (8) are made of.

use nalgebra::{Matrix2, Vector2};

use crate::kernel::axial;
use crate::kernel::element::displacement_gradient;
use crate::kernel::{Element, Material, Scalar, Stress, Triangle};
use crate::model::element::with_element;
use crate::model::material::Materials;
use crate::model::space::Space;

/// The nodal values of a displacement, by differences, which keep their digits where a body moves far and strains little.
pub(crate) trait Nodal<S> {
    /// The value at a node less that at another.
    fn difference(&self, node: usize, from: usize) -> Vector2<S>;

    /// The first component at a node: of a body of revolution the radial one, which no rigid motion has.
    fn radial(&self, node: usize) -> S;

    /// All values are zero.
    fn is_zero(&self) -> bool;
}

impl<S: Scalar> Nodal<S> for [[S; 2]] {
    #[inline]
    fn difference(&self, node: usize, from: usize) -> Vector2<S> {
        Vector2::from(self[node]) - Vector2::from(self[from])
    }

    fn radial(&self, node: usize) -> S {
        self[node][0]
    }

    fn is_zero(&self) -> bool {
        self.as_flattened().iter().all(|&u| u == S::from(0))
    }
}

/// A stress at a point of the rule on a triangle, and its ingredients.
pub(super) struct StressPoint<'a, S> {
    /// The nodes of the triangle.
    pub(crate) nodes: &'a [usize],
    /// The displacement at each node less that at the first: what moves the triangle as a whole would cancel.
    pub(crate) nodal: &'a [Vector2<S>],
    /// The gradients of the shape functions.
    pub(crate) slopes: &'a [Vector2<S>],
    /// The material, in doubles.
    pub(crate) material: &'a Material<f64>,
    /// du_i/dx_j
    pub(crate) gradient: Matrix2<S>,
    /// sigma(u); in a body of revolution what stands for r sigma(u) at the point: [`axial::weighted`].
    pub(crate) stress: Stress<S>,
    /// The weight of the point, an area.
    pub(crate) weight: S,
    /// The hoop stress of a body of revolution.
    pub(crate) hoop: Option<Hoop<'a, S>>,
}

/// A hoop stress at a point.
pub(super) struct Hoop<'a, S> {
    /// sigma_hh(u)
    pub(crate) stress: S,
    /// The integral of v_r that it is tested with, as the share of each node in thirtieths of the area.
    pub(crate) shares: &'a [i32],
    /// A thirtieth of the area.
    pub(crate) thirtieth: S,
    /// u_r at each node.
    pub(crate) radial: &'a [S],
    /// The largest r of the triangle.
    pub(crate) most: f64,
}

impl<S: Scalar> Hoop<'_, S> {
    /// The work of the stress on the displacement.
    pub(crate) fn work(&self) -> S {
        let nodes = self.shares.iter().zip(self.radial);
        let mean = nodes.fold(S::from(0), |sum, (&share, &u)| sum + S::from(share) * u);
        self.stress * mean * self.thirtieth
    }
}

impl<S: Scalar> StressPoint<'_, S> {
    /// Calls `add` with each node, the force of the stress on it and the gradient of its shape function.
    #[inline]
    pub(crate) fn each_force(&self, mut add: impl FnMut(usize, Vector2<S>, Vector2<S>)) {
        for (k, (&node, &slope)) in self.nodes.iter().zip(self.slopes).enumerate() {
            let mut force = self.stress.traction(slope) * self.weight;
            if let Some(hoop) = &self.hoop {
                force[0] += hoop.stress * hoop.thirtieth * S::from(hoop.shares[k]);
            }
            add(node, force, slope);
        }
    }
}

/// Calls `f` with the stresses of a displacement on the triangles with nodes that are `taken`. Triangles that move as a whole (in a body
/// of revolution: along its axis) are skipped, for most of a lift is zero.
#[inline]
pub(super) fn each_stress<S: Scalar + From<f64>>(
    space: &Space,
    materials: &Materials,
    (taken, in_numbers): (impl Fn(&[usize]) -> bool, impl Fn(Triangle<f64>) -> Triangle<S>),
    u: &(impl Nodal<S> + ?Sized),
    f: impl FnMut(&StressPoint<S>),
) {
    with_element!(space.degree(), E => {
        each_stress_of::<E, _, _, _>(space, materials, (taken, in_numbers), u, f);
    });
}

fn each_stress_of<E, const N: usize, const M: usize, S>(
    space: &Space,
    materials: &Materials,
    (taken, in_numbers): (impl Fn(&[usize]) -> bool, impl Fn(Triangle<f64>) -> Triangle<S>),
    u: &(impl Nodal<S> + ?Sized),
    mut f: impl FnMut(&StressPoint<S>),
) where
    E: Element<N, M>,
    S: Scalar + From<f64>,
{
    let mut points = Vec::new();
    E::at_stiffness_points(|l: [S; 3], weight| points.push((l, weight)));
    let (one, half) = (<S as From<i32>>::from(1), <S as From<f64>>::from(0.5));
    let (zero, thirty) = (<S as From<i32>>::from(0), <S as From<i32>>::from(30));
    let shares = axial::shares::<E, N, M>();
    for (t, (doubles, nodes)) in space.triangles::<N>().enumerate() {
        if !taken(nodes) {
            continue;
        }
        let nodal = nodes.map(|node| u.difference(node, nodes[0]));
        let material = materials.of(t);
        let radii = material.radii(&doubles);
        let moves = nodal != [Vector2::zeros(); N];
        if !moves && (radii.is_none() || nodes.iter().all(|&node| u.radial(node) == zero)) {
            continue;
        }
        let law = material.map(<S as From<f64>>::from);
        // As in `Triangle::barycentric_gradients`, with one division, which is expensive in most number types.
        let triangle = in_numbers(doubles);
        let double_area = triangle.double_area();
        let inverse = one / double_area;
        let barycentric = [0, 1, 2].map(|i| -triangle.scaled_normal(i) * inverse);
        let area = double_area * half;
        let Some(radii) = radii else {
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
                    hoop: None,
                });
            }
            continue;
        };
        let radial = nodes.map(|node| u.radial(node));
        let mass = axial::mass::<E, S, N, M>(radii.map(<S as From<f64>>::from));
        let means = axial::means::<E, S, N, M>(&radial);
        let strains = axial::projected(&mass, means, E::POINTS);
        let mut slopes = [[Vector2::zeros(); N]; 3];
        let mut gradients = [Matrix2::zeros(); 3];
        let mut states = [(Stress::new([zero; 3]), zero); 3];
        for (a, &(l, _)) in points.iter().enumerate() {
            slopes[a] = E::gradients(l, barycentric);
            gradients[a] = displacement_gradient(&nodal, &slopes[a]);
            states[a] = law.stress_of_revolution(gradients[a], strains[a]);
        }
        for b in 0..E::POINTS {
            f(&StressPoint {
                nodes,
                nodal: &nodal,
                slopes: &slopes[b],
                material,
                gradient: gradients[b],
                stress: axial::weighted(&mass, &states, b, E::POINTS),
                weight: area,
                hoop: Some(Hoop {
                    stress: states[b].1,
                    shares: &shares[b],
                    thirtieth: area / thirty,
                    radial: &radial,
                    most: radii.into_iter().fold(0.0, f64::max),
                }),
            });
        }
    }
}
