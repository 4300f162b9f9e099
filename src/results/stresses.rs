//! Stresses at the nodes, and the largest von Mises and principal stresses of a solution.
//!
//! The stress at a node is the mean of what the triangles around it have there, weighted by their areas. The largest values
//! take this mean over the triangles of one material at a time: across an interface the stress jumps.

use super::solution::Solution;
use crate::model::{Degree, Problem};

/// sigma_xx, sigma_yy, sigma_zz, sigma_xy; in a body of revolution sigma_rr, sigma_zz, the hoop stress and sigma_rz.
pub(crate) type Components = [f64; 4];

/// The von Mises stress, sigma_zz included.
pub(crate) fn von_mises([xx, yy, zz, xy]: Components) -> f64 {
    let squares = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (squares / 2.0 + 3.0 * xy * xy).sqrt()
}

/// The largest and the smallest principal stress, the stress across the plane included.
fn principal(stress: Components) -> [f64; 2] {
    let [first, second] = principal_in_plane(stress);
    [first.max(stress[2]), second.min(stress[2])]
}

/// The principal stresses in the plane, the larger first.
pub(crate) fn principal_in_plane([xx, yy, _, xy]: Components) -> [f64; 2] {
    let (mean, radius) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    [mean + radius, mean - radius]
}

/// A largest or smallest stress.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Extreme {
    /// In the unit of stress of the case.
    pub value: f64,
    /// The place of the node in the undeformed body.
    pub at: [f64; 2],
    /// A triangle at that node, of the material that the stress belongs to.
    pub triangle: usize,
}

impl Extreme {
    fn or_larger(&mut self, other: Extreme) {
        *self = if other.value > self.value { other } else { *self };
    }

    fn or_smaller(&mut self, other: Extreme) {
        *self = if other.value < self.value { other } else { *self };
    }
}

/// The largest stresses over the nodes, each node taken once for each material around it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LargestStresses {
    /// The largest von Mises stress.
    pub von_mises: Extreme,
    /// The largest principal stress, sigma_zz included: the largest tension.
    pub principal_max: Extreme,
    /// The smallest principal stress, sigma_zz included: the largest compression.
    pub principal_min: Extreme,
    /// The largest and the smallest hoop stress of a body of revolution.
    pub hoop: Option<[Extreme; 2]>,
}

impl Solution {
    /// The stresses at the nodes. `problem` must be the problem that was solved. Where two materials meet, this is a mean
    /// of both sides.
    pub fn nodal_stresses(&self, problem: &Problem) -> Vec<Components> {
        let means = self.nodal_means(problem, |_| true);
        means.into_iter().map(|mean| mean.map_or([0.0; 4], |(stress, _)| stress)).collect()
    }

    /// The largest stresses; `None` if the mesh is empty. `problem` must be the problem that was solved.
    pub fn largest_stresses(&self, problem: &Problem) -> Option<LargestStresses> {
        let mut largest: Option<LargestStresses> = None;
        let of_revolution = problem.material.are_of_revolution();
        for place in 0..problem.material.distinct().len() {
            let means = self.nodal_means(problem, |t| problem.material.place_of(t) == place);
            for (&at, (stress, triangle)) in
                self.nodes.iter().zip(means).filter_map(|(x, mean)| Some((x, mean?)))
            {
                let extreme = |value| Extreme { value, at, triangle };
                let [most, least] = principal(stress);
                let here = LargestStresses {
                    von_mises: extreme(von_mises(stress)),
                    principal_max: extreme(most),
                    principal_min: extreme(least),
                    hoop: of_revolution.then(|| [extreme(stress[2]); 2]),
                };
                let so_far = largest.get_or_insert(here);
                so_far.von_mises.or_larger(here.von_mises);
                so_far.principal_max.or_larger(here.principal_max);
                so_far.principal_min.or_smaller(here.principal_min);
                if let (Some([most, least]), Some([here, _])) = (&mut so_far.hoop, here.hoop) {
                    most.or_larger(here);
                    least.or_smaller(here);
                }
            }
        }
        largest
    }

    /// For each node the mean over the `members` among the triangles around it, and the first of them.
    fn nodal_means(
        &self,
        problem: &Problem,
        members: impl Fn(usize) -> bool,
    ) -> Vec<Option<(Components, usize)>> {
        let mut sums: Vec<Option<(Components, f64, usize)>> = vec![None; self.nodes.len()];
        let elements = self.elements.chunks_exact(self.degree.nodes_per_triangle());
        for (t, nodes) in elements.enumerate().filter(|(t, _)| members(*t)) {
            let (triangle, material) = (problem.mesh.triangle(t), problem.material.of(t));
            let area = triangle.double_area();
            let radii = material.radii(&triangle);
            let corners = if self.degree == Degree::One && radii.is_none() {
                let (stress, zz) = self.stress[t];
                [(stress.components(), zz); 3]
            } else {
                let barycentric = triangle.barycentric_gradients();
                let nodal = |j: usize| self.displacement[nodes[j]].into();
                let hoop = radii.map_or([0.0; 3], |radii| {
                    self.degree.hoop_strain(radii, |j| self.displacement[nodes[j]][0])
                });
                [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|l| {
                    let gradient = self.degree.displacement_gradient(l, barycentric, nodal);
                    let hoop = self.degree.value_from_points(hoop, l);
                    let (stress, zz) = material.state(gradient, hoop);
                    (stress.components(), zz)
                })
            };
            let corners = corners.map(|([xx, yy, xy], zz)| [xx, yy, zz, xy].map(|s| area * s));
            for (j, &node) in nodes.iter().enumerate() {
                // A stress is affine; node 3 + i is in the middle of the edge opposite corner i.
                let stress = match j {
                    0..3 => corners[j],
                    _ => {
                        let [a, b] = [corners[(j + 1) % 3], corners[(j + 2) % 3]];
                        [0, 1, 2, 3].map(|c| f64::midpoint(a[c], b[c]))
                    }
                };
                let (sum, weight, _) = sums[node].get_or_insert(([0.0; 4], 0.0, t));
                sum.iter_mut().zip(stress).for_each(|(sum, s)| *sum += s);
                *weight += area;
            }
        }
        sums.into_iter()
            .map(|sum| sum.map(|(sum, weight, t)| (sum.map(|s| s / weight), t)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn uniaxial_tension_has_itself_for_its_von_mises_stress_and_pure_shear_its_root_of_three() {
        assert_relative_eq!(von_mises([5.0, 0.0, 0.0, 0.0]), 5.0);
        assert_relative_eq!(von_mises([0.0, 0.0, 0.0, 2.0]), 12.0_f64.sqrt());
        assert_eq!(von_mises([3.0, 3.0, 3.0, 0.0]), 0.0);
        assert_eq!(principal_in_plane([0.0, 0.0, 9.0, 2.0]), [2.0, -2.0]);
    }

    #[test]
    fn the_stress_across_the_plane_is_a_principal_one() {
        // Plane strain, u = (a x, b y), lambda = mu = 1: sigma_zz = a + b lies below, between and above the others.
        for (xx, yy, zz, expected) in [
            (5.0, 4.0, 3.0, [5.0, 3.0]),
            (2.0, -4.0, -1.0, [2.0, -4.0]),
            (-5.0, -4.0, -3.0, [-3.0, -5.0]),
        ] {
            assert_eq!(principal([xx, yy, zz, 0.0]), expected);
        }
        // A shear alone has the principal stresses 2 and -2.
        assert_eq!(principal([0.0, 0.0, 9.0, 2.0]), [9.0, -2.0]);
        assert_eq!(principal([0.0, 0.0, -9.0, 2.0]), [2.0, -9.0]);
    }
}
