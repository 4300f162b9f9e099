//! The solution of method (8).

/// The free choices of method (8).
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// The polynomial degree of V^h, 1 or 2.
    pub degree: Degree,
    /// gamma0 of (7).
    pub gamma0: Gamma0,
    /// How the contact terms are integrated.
    pub quadrature: ContactQuadrature,
    /// Solve although kappa >= 1, without any promise.
    pub allow_noncoercive: bool,
}

/// The polynomial degree of V^h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Degree {
    /// P1, section 2.2.
    One,
    /// P2, Remark 3.7.
    Two,
}

/// gamma0 of (7), in 1 / stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gamma0 {
    /// Half of the coercivity limit.
    Auto,
    /// This value.
    Value(f64),
}

/// How the contact terms are integrated along an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactQuadrature {
    /// Cut at the roots of P: no quadrature error.
    Exact,
    /// That many Gauss points on each edge.
    Gauss(usize),
}

/// When Newton's method stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The relative residual to reach.
    pub tolerance: f64,
    /// The most steps.
    pub max_iterations: usize,
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
        Settings { tolerance: 1e-10, max_iterations: 50 }
    }
}

pub mod factor;
pub mod ordering;
/// errors
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// x
    #[error("npd")]
    NotPositiveDefinite,
    /// x
    #[error("oom")]
    OutOfMemory,
}
