//! Materials that are stable: mu > 0 and 3 lambda + 2 mu > 0 for the three-dimensional body, that is E > 0 and
//! -1 < nu < 1/2; tensors in the plane with positive eigenvalues. The kernel's constructors take what they are given, over any
//! numbers; these check it.
//!
//! A body has one, or one for each part of it: a triangle has exactly one.
//!
//! The eigenvalues of A are those of its matrix in Mandel's form, with the root of 2 times 2 eps_xy and sigma_xy.

use nalgebra::{Matrix2, Vector3};
use thiserror::Error;

use crate::kernel::{Ball, Material, Plane, Stress};
use crate::linear::dense::singular_vectors;
use crate::model::rigid::NEGLIGIBLE;

/// Why there is no such material.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum MaterialError {
    #[error("{name} is {value}; expected {expected}")]
    Modulus { name: &'static str, value: f64, expected: &'static str },
    #[error(
        "in the plane lambda is {lambda} and mu is {mu}; expected finite moduli of a stable material: mu > 0 and 3 lambda + 2 mu > 0, that is Young's modulus > 0 and Poisson's ratio above -1 and below 0.5"
    )]
    Unstable { lambda: f64, mu: f64 },
    #[error(
        "the smallest eigenvalue of the stiffness [{}] is {eigenvalue}; expected an elliptic law: a positive one, at least 1e-10 of the largest",
        stiffness.map(|c| c.to_string()).join(", ")
    )]
    NotElliptic { stiffness: [f64; 6], eigenvalue: f64 },
    #[error("the stiffness across the plane is not finite")]
    Across,
}

/// The material of each triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Materials {
    distinct: Vec<Material<f64>>,
    /// The material of each triangle by its place in `distinct`; empty where the whole body is made of the first.
    of_triangle: Vec<usize>,
}

impl From<Material<f64>> for Materials {
    /// One material for the whole body.
    fn from(material: Material<f64>) -> Self {
        Materials { distinct: vec![material], of_triangle: Vec::new() }
    }
}

impl Materials {
    /// The materials of a body of `triangles` triangles: `rest`, and on the triangles of each of `parts` that part's own.
    /// Numbers beyond the last triangle are passed over.
    pub fn in_parts<'a>(
        rest: Material<f64>,
        triangles: usize,
        parts: impl IntoIterator<Item = (Material<f64>, &'a [usize])>,
    ) -> Self {
        let mut materials = Materials { distinct: vec![rest], of_triangle: vec![0; triangles] };
        for (material, members) in parts {
            for &t in members {
                if let Some(of) = materials.of_triangle.get_mut(t) {
                    *of = materials.distinct.len();
                }
            }
            materials.distinct.push(material);
        }
        materials
    }

    /// Returns the material of triangle `t`.
    pub fn of(&self, t: usize) -> &Material<f64> {
        &self.distinct[self.of_triangle.get(t).copied().unwrap_or(0)]
    }

    /// The place of triangle `t`'s material among the materials: two triangles with the same place share theirs.
    pub(crate) fn place_of(&self, t: usize) -> usize {
        self.of_triangle.get(t).copied().unwrap_or(0)
    }

    /// The materials on parts of these triangles: part i is one of triangle `origin[i]`.
    #[must_use]
    pub(crate) fn on_parts(&self, origin: &[usize]) -> Self {
        let one = self.of_triangle.is_empty();
        let of_triangle =
            if one { Vec::new() } else { origin.iter().map(|&t| self.place_of(t)).collect() };
        Materials { distinct: self.distinct.clone(), of_triangle }
    }

    /// Each material once, whether a triangle is made of it or not.
    pub(crate) fn distinct(&self) -> &[Material<f64>] {
        &self.distinct
    }

    /// Returns whether the body is one of revolution, of which the mesh is the meridian.
    pub(crate) fn are_of_revolution(&self) -> bool {
        self.distinct.first().is_some_and(|material| material.plane() == Plane::Axisymmetric)
    }

    /// The one material, if the whole body is made of it.
    pub(crate) fn only(&self) -> Option<&Material<f64>> {
        if self.of_triangle.is_empty() { self.distinct.first() } else { None }
    }
}

/// Moduli along and across the axis of an orthotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthotropic {
    /// Young's modulus along the axis.
    pub e1: f64,
    /// Young's modulus across it, in the plane.
    pub e2: f64,
    /// -eps_2 / eps_1 under a stress along the axis.
    pub nu12: f64,
    /// The shear modulus in the plane.
    pub g12: f64,
    /// From the x axis to that of the material, in degrees, to the left.
    pub angle: f64,
    /// The moduli across the plane, for a law of plane strain; `None` in plane stress.
    pub across: Option<Across>,
}

/// The moduli of an orthotropic material across the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Across {
    /// Young's modulus across the plane.
    pub e3: f64,
    /// -eps_3 / eps_1 under a stress along the axis.
    pub nu13: f64,
    /// -eps_3 / eps_2 under a stress across it, in the plane.
    pub nu23: f64,
}

/// Makes a stable orthotropic material.
///
/// # Errors
/// [`MaterialError`]: moduli that are not positive and finite, and ratios for which the law is not elliptic.
pub fn stable_orthotropic(moduli: Orthotropic) -> Result<Material<f64>, MaterialError> {
    let Orthotropic { e1, e2, nu12, g12, angle, across } = moduli;
    let expected = "a positive number";
    let e3 = across.map_or(1.0, |across| across.e3);
    for (name, value) in [("e1", e1), ("e2", e2), ("g12", g12), ("e3", e3)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(MaterialError::Modulus { name, value, expected });
        }
    }
    // The sigma_zz that keeps eps_3 = 0, and the strains in the plane with this sigma_zz.
    let across = across.map(|Across { e3, nu13, nu23 }| [nu13 * (e3 / e1), nu23 * (e3 / e2)]);
    let [along, aside] = across.unwrap_or_default();
    let [xx, xy, yy] = match moduli.across {
        None => [1.0 / e1, -nu12 / e1, 1.0 / e2],
        Some(Across { nu13, nu23, .. }) => {
            let [s13, s23] = [nu13 / e1, nu23 / e2];
            [1.0 / e1 - s13 * along, -nu12 / e1 - s13 * aside, 1.0 / e2 - s23 * aside]
        }
    };
    let determinant = xx * yy - xy * xy;
    let c = [yy / determinant, -xy / determinant, 0.0, xx / determinant, 0.0, g12];
    let material = Material::tensor(c, across.map(|[along, aside]| [along, aside, 0.0]));
    let (sine, cosine) = sine_and_cosine(angle);
    stable(stable(material)?.turned([cosine, sine]))
}

/// The sine and the cosine of an angle in degrees: exact for multiples of 90.
fn sine_and_cosine(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    let (sine, cosine) = (degrees - 90.0 * quarters).to_radians().sin_cos();
    match quarters.rem_euclid(4.0) {
        0.0 => (sine, cosine),
        1.0 => (cosine, -sine),
        2.0 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// The material, if it is stable.
///
/// # Errors
/// [`MaterialError::Unstable`], [`MaterialError::NotElliptic`], [`MaterialError::Across`].
pub fn stable(material: Material<f64>) -> Result<Material<f64>, MaterialError> {
    if !material.is_isotropic() {
        let (stiffness, [eigenvalue, largest]) = (material.stiffness(), eigenvalues(&material));
        let finite = stiffness.iter().all(|c| c.is_finite());
        if !(finite && eigenvalue > 0.0 && eigenvalue >= NEGLIGIBLE * largest) {
            // Rounding leaves a dozen digits of it.
            let eigenvalue = format!("{eigenvalue:.11e}").parse().unwrap_or(eigenvalue);
            return Err(MaterialError::NotElliptic { stiffness, eigenvalue });
        }
        let across = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let zz = across.map(|stress| material.stress_zz(Stress::new(stress)));
        if !zz.iter().all(|zz| zz.is_finite()) {
            return Err(MaterialError::Across);
        }
        return match material.hoop_modulus() {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                let (name, expected) = ("Young's modulus along the hoops", "a positive number");
                Err(MaterialError::Modulus { name, value, expected })
            }
            _ => Ok(material),
        };
    }
    let (lambda, mu) = (material.lambda(), material.mu());
    let bulk = match material.plane() {
        Plane::Strain | Plane::Axisymmetric => 3.0 * lambda + 2.0 * mu,
        // lambda* = 2 lambda mu / (lambda + 2 mu) grows with lambda, and is -mu where 3 lambda = -2 mu.
        Plane::Stress => lambda + mu,
    };
    let finite = lambda.is_finite() && (lambda + 2.0 * mu).is_finite();
    if finite && mu > 0.0 && bulk > 0.0 {
        Ok(material)
    } else {
        Err(MaterialError::Unstable { lambda, mu })
    }
}

/// eps_xx, eps_yy and 2 eps_xy under the stress sigma_xx, sigma_yy, sigma_xy in the plane, by Cramer's rule.
pub(crate) fn strain(material: &Material<f64>, stress: [f64; 3]) -> [f64; 3] {
    let [xx, xy, xz, yy, yz, zz] = material.stiffness();
    let columns = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(Vector3::from);
    let [a, b, c] = columns;
    let stress = Vector3::from(stress);
    let volume = |a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>| a.dot(&b.cross(&c));
    let whole = volume(a, b, c);
    [volume(stress, b, c), volume(a, stress, c), volume(a, b, stress)].map(|part| part / whole)
}

/// The smallest and the largest eigenvalue of A.
pub fn eigenvalues(material: &Material<f64>) -> [f64; 2] {
    if material.is_isotropic() {
        let (mu, bulk) = (material.mu(), material.lambda() + material.mu());
        return [2.0 * mu.min(bulk), 2.0 * mu.max(bulk)];
    }
    let [xx, xy, xz, yy, yz, zz] = material.stiffness();
    let root = 2.0_f64.sqrt();
    let matrix = [[xx, xy, root * xz], [xy, yy, root * yz], [root * xz, root * yz, 2.0 * zz]];
    // Of A/size + 1, which is positive, the singular values are the eigenvalues.
    let size = matrix
        .iter()
        .map(|row| row.iter().map(|c| c.abs()).sum())
        .fold(f64::MIN_POSITIVE, f64::max);
    let entry = |i: usize, j: usize| matrix[i][j] / size + f64::from(u8::from(i == j));
    let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)).to_vec());
    let values = singular_vectors(&rows, 3);
    [&values[2], &values[0]].map(|(value, _)| (value - 1.0) * size)
}

/// A lower bound c of the smallest eigenvalue of A, as near as rounding allows; 0 or less if the law is not elliptic. In a body
/// of revolution A is the law in three dimensions.
pub fn least_eigenvalue(material: &Material<f64>) -> f64 {
    let in_plane = least_in_plane(material);
    if material.plane() != Plane::Axisymmetric {
        return in_plane;
    }
    if material.is_isotropic() {
        let (lambda, mu) = (Ball::point(material.lambda()), Ball::point(material.mu()));
        return (Ball::from(2) * mu)
            .lower()
            .min((Ball::from(3) * lambda + Ball::from(2) * mu).lower());
    }
    // sigma:eps = A(eps + a h):(eps + a h) + e h^2, at least c (|eps| - |a| |h|)^2 + e h^2: a form of two numbers, whose smaller
    // eigenvalue is above its determinant over its trace.
    let young = material.hoop_modulus().unwrap_or_default();
    let [a, b, c] = material.across().map(|factor| factor * factor);
    let trace = in_plane * (1.0 + a + b + c / 2.0) + young;
    (in_plane * young / trace) * (1.0 - 16.0 * f64::EPSILON)
}

/// [`least_eigenvalue`] of the law in the plane.
fn least_in_plane(material: &Material<f64>) -> f64 {
    if material.is_isotropic() {
        let mu = Ball::point(material.mu());
        return 2.0 * mu.lower().min((mu + Ball::point(material.lambda())).lower());
    }
    let least = eigenvalues(material)[0];
    let is_less = |least: &f64| {
        let [xx, xy, xz, yy, yz, zz] = material.stiffness().map(Ball::point);
        let (whole, half) = (Ball::point(*least), Ball::point(least / 2.0));
        let rest = Material::tensor([xx - whole, xy, xz, yy - whole, yz, zz - half], None);
        rest.squares().pivots().iter().all(|pivot| pivot.lower() > 0.0)
    };
    let candidates = [1e-12, 1e-8, 1e-4, 0.5].map(|less| least * (1.0 - less));
    candidates.into_iter().find(is_less).unwrap_or(0.0)
}

/// The largest eigenvalue of A, to rounding.
pub fn largest_eigenvalue(material: &Material<f64>) -> f64 {
    eigenvalues(material)[1]
}

/// An upper bound of all |C_ij|.
pub(crate) fn largest_entry(material: &Material<f64>) -> f64 {
    if material.is_isotropic() {
        return material.lambda().abs() + 2.0 * material.mu();
    }
    let in_plane = material.stiffness().into_iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    let Some(young) = material.hoop_modulus() else { return in_plane };
    let (stress, hoop) = material.stress_of_revolution(Matrix2::zeros(), 1.0);
    let of_hoop = stress.components().into_iter().chain([hoop, young]);
    of_hoop.fold(in_plane, |most: f64, c| most.max(c.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stiffness of a law of revolution on strains (rr, zz, hoop, rz by the root of 2), by its stresses.
    fn matrix_of(material: &Material<f64>) -> Vec<Vec<f64>> {
        let half = 0.5_f64.sqrt();
        let row = |k: usize| {
            let unit = |i: usize| f64::from(u8::from(i == k));
            let gradient = Matrix2::new(unit(0), 2.0 * half * unit(3), 0.0, unit(1));
            let (stress, hoop) = material.stress_of_revolution(gradient, unit(2));
            let [xx, yy, xy] = stress.components();
            vec![xx, yy, hoop, xy / half]
        };
        (0..4).map(row).collect()
    }

    /// A law is positive, so that the singular values of its matrix are its eigenvalues.
    fn least_of(material: &Material<f64>) -> f64 {
        singular_vectors(&matrix_of(material), 4)[3].0
    }

    #[test]
    fn the_least_eigenvalue_of_revolution_is_below_that_of_each_law_however_its_hoops_are_coupled()
    {
        let plane = [[3.0, 1.0, 0.0, 3.0, 0.0, 1.0], [5.0, 1.5, 0.3, 2.0, -0.2, 0.7]];
        let coupled =
            [[0.0; 3], [0.25, 0.25, 0.0], [1.5, -0.5, 0.0], [-2.0, 1.0, 0.75], [3.0, 3.0, 1.0]];
        let mut too_large = 0;
        for (c, across) in plane.into_iter().flat_map(|c| coupled.map(|across| (c, across))) {
            for young in [0.01, 1.0, 2.5, 40.0] {
                let material = Material::tensor(c, Some(across)).of_revolution(young);
                let (found, least) = (least_eigenvalue(&material), least_of(&material));
                // The form of two numbers has a smaller eigenvalue within a factor of 2 of its determinant over its trace.
                let [a, b, h] = across.map(|a| a * a);
                let form = [least_in_plane(&material), young, 1.0 + a + b + h / 2.0];
                let [trace, determinant] = [form[0] * form[2] + form[1], form[0] * form[1]];
                let smaller =
                    2.0 * determinant / (trace + (trace * trace - 4.0 * determinant).sqrt());
                assert!(found <= least * (1.0 + 1e-12), "{found} {least}: {material:?}");
                assert!((0.5..=1.0).contains(&(found / smaller)), "{found} {smaller}");
                // Control: without what couples the hoops.
                too_large += usize::from(determinant / (form[0] + form[1]) > least);
            }
        }
        assert!(too_large > 5, "control: {too_large}");
    }

    #[test]
    fn the_least_eigenvalue_of_a_body_of_revolution_is_that_of_the_law_in_three_dimensions() {
        let of = |lambda, plane| least_eigenvalue(&Material::lame(lambda, 1.0, plane));
        // min(2 mu, 3 lambda + 2 mu), in plane strain min(2 mu, 2 (lambda + mu)).
        for (found, expected) in [
            (of(-0.5, Plane::Axisymmetric), 0.5),
            (of(-0.5, Plane::Strain), 1.0),
            (of(3.0, Plane::Axisymmetric), 2.0),
        ] {
            assert!((found / expected - 1.0).abs() <= 1e-14, "{found}, {expected}");
        }
        // As a tensor, from below and within a factor of 2.
        let (lambda, mu) = (1.0, 1.0);
        let (nu, young) = (0.25, 2.5);
        let c = [lambda + 2.0 * mu, lambda, 0.0, lambda + 2.0 * mu, 0.0, mu];
        let tensor = Material::tensor(c, Some([nu, nu, 0.0])).of_revolution(young);
        let least = least_eigenvalue(&tensor);
        assert!((1.0..=2.0).contains(&least), "{least}");
    }

    #[test]
    fn the_axes_of_a_material_are_at_its_angle_whatever_that_is() {
        for k in -33..=33 {
            let degrees = 22.5 * f64::from(k) + 1.0;
            let (sine, cosine) = sine_and_cosine(degrees);
            let (expected_sine, expected_cosine) = degrees.to_radians().sin_cos();
            // The angle in radians, at most 13, is rounded at 2^-50, and more than one degree from every quarter turn.
            assert!((sine - expected_sine).abs() <= 1e-14, "{degrees}: {sine}");
            assert!((cosine - expected_cosine).abs() <= 1e-14, "{degrees}: {cosine}");
        }
        let of_quarters = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
        for k in -9..=9_i32 {
            let expected = of_quarters[k.rem_euclid(4) as usize];
            assert_eq!(sine_and_cosine(90.0 * f64::from(k)), expected, "{k}");
        }
        // Control: doubles themselves are not exact there.
        assert_ne!(180.0_f64.to_radians().sin(), 0.0);
    }
}
