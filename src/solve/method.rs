//! The choices that method (8) leaves open, and the accuracy that is asked for. Values that a case file could not have are
//! refused here, too.

use crate::model::{DataError, Degree};

/// The largest number of Gauss points: more gain nothing, as the integrand has a kink where contact ends.
pub const MOST_GAUSS_POINTS: usize = 64;

/// The largest number of Newton steps that a case may allow: few are needed, or the method does not converge.
pub const MOST_ITERATIONS: usize = 1_000_000;

/// The free choices of method (8). Written as `Method { degree, ..Method::default() }`, for fields may come.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// The polynomial degree of V^h, 1 or 2.
    pub degree: Degree,
    /// gamma0 of (7).
    pub gamma0: Gamma0,
    /// The quadrature of the contact terms.
    pub quadrature: ContactQuadrature,
    /// Solve although kappa >= 1, without any promise.
    pub allow_noncoercive: bool,
}

/// gamma0 of (7), in 1 / stress.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Gamma0 {
    /// Half of the coercivity limit; with pairs of bodies on each contact edge half its own, as [`Gamma0::Local`] for 0.5.
    Auto,
    /// This value.
    Value(f64),
    /// On each contact edge its own, such that kappa is this number on each triangle with edges on Gamma_C: one sliver does
    /// not set gamma for the whole line. The same as [`Gamma0::Auto`] for 0.5 where all these triangles are alike.
    Local(f64),
}

/// The quadrature of the contact terms along an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactQuadrature {
    /// Cut at the roots of P: no quadrature error.
    Exact,
    /// A Gauss rule with so many points on each edge.
    Gauss(usize),
}

/// When Newton's method stops, and what is to be proved. Written as `Settings { tolerance, ..Settings::default() }`, for
/// fields may come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The relative residual to reach.
    pub tolerance: f64,
    /// The most steps.
    pub max_iterations: usize,
    /// The distance from the exact solution of (8), relative and in the energy norm, that is to be proved; infinite where none
    /// is asked for.
    pub proof: f64,
}

impl Default for Method {
    fn default() -> Self {
        Method {
            degree: Degree::One,
            gamma0: Gamma0::Auto,
            quadrature: ContactQuadrature::Exact,
            allow_noncoercive: false,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Settings { tolerance: 1e-10, max_iterations: 200, proof: 1e-6 }
    }
}

fn refused(what: &'static str, found: impl ToString, expected: &'static str) -> DataError {
    DataError::Value { what, found: found.to_string(), expected }
}

impl Gamma0 {
    /// Uses a fixed gamma0 > 0.
    ///
    /// # Errors
    /// [`DataError::Value`].
    pub fn value(gamma0: f64) -> Result<Self, DataError> {
        Gamma0::Value(gamma0).checked()
    }

    /// On each contact edge the gamma0 for which kappa is this positive number on its own triangle.
    ///
    /// # Errors
    /// [`DataError::Value`].
    pub fn local(kappa: f64) -> Result<Self, DataError> {
        Gamma0::Local(kappa).checked()
    }

    fn checked(self) -> Result<Self, DataError> {
        match self {
            Gamma0::Value(x) | Gamma0::Local(x) if x > 0.0 && x.is_finite() => Ok(self),
            Gamma0::Value(gamma0) => Err(refused("gamma0", gamma0, "a positive number")),
            Gamma0::Local(kappa) => Err(refused("kappa", kappa, "a positive number")),
            Gamma0::Auto => Ok(self),
        }
    }
}

impl ContactQuadrature {
    /// The Gauss rule with so many points on each edge, from 1 to [`MOST_GAUSS_POINTS`].
    ///
    /// # Errors
    /// [`DataError::Value`].
    pub fn gauss(points: usize) -> Result<Self, DataError> {
        ContactQuadrature::Gauss(points).checked()
    }

    fn checked(self) -> Result<Self, DataError> {
        match self {
            ContactQuadrature::Gauss(points) if !(1..=MOST_GAUSS_POINTS).contains(&points) => {
                Err(refused("the number of Gauss points on an edge", points, "one from 1 to 64"))
            }
            _ => Ok(self),
        }
    }
}

impl Method {
    /// Checks that every parameter is in its allowed range.
    pub(crate) fn check(&self) -> Result<(), DataError> {
        self.gamma0.checked()?;
        self.quadrature.checked().map(|_| ())
    }
}

impl Settings {
    /// To this relative residual, above 0 and below 1, in at most that many steps, from 1 to [`MOST_ITERATIONS`].
    ///
    /// # Errors
    /// [`DataError::Value`].
    pub fn new(tolerance: f64, max_iterations: usize) -> Result<Self, DataError> {
        let settings = Settings { tolerance, max_iterations, ..Settings::default() };
        settings.check().map(|()| settings)
    }

    /// Checks that every setting is in its allowed range.
    pub(crate) fn check(&self) -> Result<(), DataError> {
        for (what, share) in [("proof", self.proof), ("the tolerance", self.tolerance)] {
            if !(share > 0.0 && share < 1.0) {
                return Err(refused(what, share, "a number above 0 and below 1"));
            }
        }
        if !(1..=MOST_ITERATIONS).contains(&self.max_iterations) {
            let what = "the most steps (max_iterations)";
            return Err(refused(what, self.max_iterations, "one from 1 to 1000000"));
        }
        Ok(())
    }
}
