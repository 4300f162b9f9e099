//! Materials that are stable: mu > 0 and 3 lambda + 2 mu > 0 for the three-dimensional body, that is E > 0 and
//! -1 < nu < 1/2. The kernel's constructors take what they are given, over any numbers; these check it.

use thiserror::Error;

use crate::kernel::{Material, Plane};

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
}

/// Makes a stable material of Lame's coefficients, as [`Material::lame`].
///
/// # Errors
/// [`MaterialError`]: moduli that are not finite, mu <= 0, 3 lambda + 2 mu <= 0.
pub fn stable_lame(lambda: f64, mu: f64, plane: Plane) -> Result<Material<f64>, MaterialError> {
    let expected = "a positive number";
    if !(mu > 0.0 && mu.is_finite()) {
        return Err(MaterialError::Modulus { name: "the shear modulus mu", value: mu, expected });
    }
    if !(3.0 * lambda + 2.0 * mu > 0.0 && lambda.is_finite()) {
        let (name, expected) = ("the first Lame coefficient lambda", "a number above -2/3 mu");
        return Err(MaterialError::Modulus { name, value: lambda, expected });
    }
    stable(Material::lame(lambda, mu, plane))
}

/// Makes a stable material of Young's modulus and Poisson's ratio, as [`Material::young_poisson`].
///
/// # Errors
/// [`MaterialError`]: a modulus that is not positive and finite, a ratio that is not between -1 and 1/2.
pub fn stable_young_poisson(
    young: f64,
    poisson: f64,
    plane: Plane,
) -> Result<Material<f64>, MaterialError> {
    if !(young > 0.0 && young.is_finite()) {
        let (name, expected) = ("Young's modulus", "a positive number");
        return Err(MaterialError::Modulus { name, value: young, expected });
    }
    if !(-1.0 < poisson && poisson < 0.5) {
        let (name, expected) = ("Poisson's ratio", "a number above -1 and below 0.5");
        return Err(MaterialError::Modulus { name, value: poisson, expected });
    }
    stable(Material::young_poisson(young, poisson, plane))
}

/// The material, if it is stable.
///
/// # Errors
/// [`MaterialError::Unstable`].
pub fn stable(material: Material<f64>) -> Result<Material<f64>, MaterialError> {
    let (lambda, mu) = (material.lambda(), material.mu());
    let bulk = match material.plane() {
        Plane::Strain => 3.0 * lambda + 2.0 * mu,
        // lambda* = 2 lambda mu / (lambda + 2 mu) grows with lambda, and is -mu where 3 lambda = -2 mu.
        Plane::Stress => lambda + mu,
    };
    let finite = lambda.is_finite() && material.normal_stiffness().is_finite();
    if finite && mu > 0.0 && bulk > 0.0 {
        Ok(material)
    } else {
        Err(MaterialError::Unstable { lambda, mu })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_that_are_stable_are_made_and_the_others_refused_with_the_reason() {
        for plane in [Plane::Strain, Plane::Stress] {
            assert!(stable_lame(-0.6, 1.0, plane).is_ok());
            assert!(stable_young_poisson(1e-150, 0.4999999, plane).is_ok());
            let said = |m: Result<Material<f64>, MaterialError>| m.unwrap_err().to_string();
            for (found, expected) in [
                (
                    said(stable_lame(1.0, 0.0, plane)),
                    "the shear modulus mu is 0; expected a positive number",
                ),
                (
                    said(stable_lame(-0.7, 1.0, plane)),
                    "the first Lame coefficient lambda is -0.7; expected a number above -2/3 mu",
                ),
                (
                    said(stable_young_poisson(f64::NAN, 0.3, plane)),
                    "Young's modulus is NaN; expected a positive number",
                ),
                (
                    said(stable_young_poisson(1.0, 0.5, plane)),
                    "Poisson's ratio is 0.5; expected a number above -1 and below 0.5",
                ),
            ] {
                assert_eq!(found, expected);
            }
            for material in [
                Material::lame(-0.7, 1.0, plane),
                Material::lame(1.0, -1.0, plane),
                Material::lame(f64::NAN, 1.0, plane),
            ] {
                assert!(stable(material).is_err(), "{material:?}");
            }
        }
        let incompressible = Material::young_poisson(1.0, 0.5, Plane::Strain);
        assert!(stable(incompressible).is_err());
    }
}
