//! An estimate of the error that proves nothing, to tell how sharp a bound may be.

use super::field::Field;
use super::parts::Parts;
use crate::kernel::Stress;
use crate::kernel::composite::complementary;

/// Zienkiewicz and Zhu's estimate of the error of v: the distance of its stress from the stress that is averaged at the
/// vertices, triangle by triangle of each material.
pub(super) fn averaging_estimate(parts: &Parts, v: &Field) -> f64 {
    let mesh = parts.mesh;
    let place = |t: usize| parts.problem.material.place_of(t);
    let zero = Stress::new([0.0; 3]);
    // At each vertex the sums and weights of the few materials there.
    let mut sums: Vec<Vec<(usize, Stress<f64>, f64)>> = vec![Vec::new(); mesh.vertices().len()];
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let triangle = mesh.triangle(t);
        let (stress, area) = (v.stress(parts, t, &triangle), triangle.double_area());
        for (i, &vertex) in corners.iter().enumerate() {
            let s = stress.at_corner(i);
            let known = sums[vertex].iter_mut().find(|(material, ..)| *material == place(t));
            match known {
                Some((_, sum, weight)) => {
                    *sum = *sum + s * area;
                    *weight += area;
                }
                None => sums[vertex].push((place(t), s * area, area)),
            }
        }
    }
    let mut square = 0.0;
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let triangle = mesh.triangle(t);
        let stress = v.stress(parts, t, &triangle);
        let mut total = zero;
        let mut share = 0.0;
        for (i, &vertex) in corners.iter().enumerate() {
            let known = sums[vertex].iter().find(|(material, ..)| *material == place(t));
            let Some(&(_, sum, weight)) = known else { continue };
            let difference = sum / weight - stress.at_corner(i);
            share += complementary(parts.material(t), difference);
            total = total + difference;
        }
        square += (share + complementary(parts.material(t), total)) * triangle.double_area() / 24.0;
    }
    square.sqrt()
}
