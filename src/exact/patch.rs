//! (d) Patch tests: u is affine, so the discrete solution is u itself, for P1 and P2 on every mesh. Displacement on y = 1,
//! tractions on x = 0 and x = 1, no body force; on y = 0:
//!
//! | | u | g | |
//! | --- | --- | --- | --- |
//! | d1 | (p e2 x, -p e1 y) | 0 | contact under the pressure p |
//! | d2 | (p e1 x, -p e2 y + d) | 0 | lifted by d under the horizontal tension p |
//! | d3 | (p e2 x - w y, -p e1 y + w x - g0) | g0 - w x | contact with an inclined floor |
//! | d4 | 0 | 0 | P = 0 everywhere |
//! | d5 | (0, d (1 - y)) | -d | a floor that is d too high |
//!
//! e1 = (lambda + 2 mu) / (4 mu (lambda + mu)) and e2 = lambda / (4 mu (lambda + mu)): the strains of the uniaxial stress 1.
//! Where A is not isotropic the strains are those of the same stresses, with u_x growing along y by 2 eps_xy; in d5 by as much as
//! leaves no shear stress.

use nalgebra::{Matrix2, Vector2};

use super::ExactSolution;
use crate::kernel::Material;
use crate::model::material::strain;

/// A solution u = `matrix` x + `shift` with the gap g = `gap`\[0\] + `gap`\[1\] x.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    material: Material<f64>,
    matrix: Matrix2<f64>,
    shift: Vector2<f64>,
    gap: [f64; 2],
}

/// The gradient of a displacement with u_y = 0 on y = 0 under the stress sigma_xx, sigma_yy alone.
fn gradient(material: &Material<f64>, [xx, yy]: [f64; 2]) -> Matrix2<f64> {
    if !material.is_isotropic() {
        let [xx, yy, shear] = strain(material, [xx, yy, 0.0]);
        return Matrix2::new(xx, shear, 0.0, yy);
    }
    let (lambda, mu) = (material.lambda(), material.mu());
    let common = 4.0 * mu * (lambda + mu);
    let (e1, e2) = ((lambda + 2.0 * mu) / common, lambda / common);
    Matrix2::new(xx * e1 - yy * e2, 0.0, 0.0, yy * e1 - xx * e2)
}

impl Patch {
    /// d1, for p > 0.
    pub fn compression(material: Material<f64>, p: f64) -> Self {
        Patch::inclined(material, p, 0.0, 0.0)
    }

    /// d2, for d > 0.
    pub fn separation(material: Material<f64>, p: f64, d: f64) -> Self {
        let matrix = gradient(&material, [p, 0.0]);
        Patch { material, matrix, shift: Vector2::new(0.0, d), gap: [0.0; 2] }
    }

    /// d3, for p > 0.
    pub fn inclined(material: Material<f64>, p: f64, w: f64, g0: f64) -> Self {
        let matrix = gradient(&material, [0.0, -p]) + Matrix2::new(0.0, -w, w, 0.0);
        Patch { material, matrix, shift: Vector2::new(0.0, -g0), gap: [g0, -w] }
    }

    /// d4
    pub fn grazing(material: Material<f64>) -> Self {
        Patch { material, matrix: Matrix2::zeros(), shift: Vector2::zeros(), gap: [0.0; 2] }
    }

    /// d5, for d > 0.
    pub fn interference(material: Material<f64>, d: f64) -> Self {
        let [.., of_normal, of_shear] = material.stiffness();
        let shear = if of_normal == 0.0 { 0.0 } else { of_normal * d / of_shear };
        let matrix = Matrix2::new(0.0, shear, 0.0, -d);
        Patch { material, matrix, shift: Vector2::new(0.0, d), gap: [-d, 0.0] }
    }
}

impl ExactSolution for Patch {
    fn material(&self) -> &Material<f64> {
        &self.material
    }

    fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        (self.matrix * Vector2::from(x) + self.shift).into()
    }

    fn gradient(&self, _: [f64; 2]) -> Matrix2<f64> {
        self.matrix
    }

    fn second_derivatives(&self, _: [f64; 2]) -> Option<[[f64; 3]; 2]> {
        Some([[0.0; 3]; 2])
    }

    fn regularity(&self) -> f64 {
        f64::INFINITY
    }

    fn gap(&self, [x, _]: [f64; 2]) -> f64 {
        self.gap[0] + self.gap[1] * x
    }
}
