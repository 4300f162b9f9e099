//! How far a displacement is from the solution of (1)-(2): an upper bound of |u - v|_a without an unknown constant.
//!
//! | module | what it does |
//! | --- | --- |
//! | [`proof`] | the certificate, and the checker that evaluates it |
//! | [`balance`] | tractions in exact equilibrium |
//! | [`build`] | v and tau from the discrete solution |
//! | [`sweeps`] | a better tau |
//! | [`oscillation`] | data outside the exact class |

mod balance;
mod build;
mod oscillation;
pub mod proof;
mod sweeps;

pub use self::proof::{Certificate, Proof, Rejection};
use crate::fem::constraints::Constraints;
use crate::fem::contact_line;
use crate::fem::{DataError, Problem, Space};
use crate::kernel::{Interval, P1};
use crate::solve::Solution;

/// How often the stress is improved around every vertex.
pub const SWEEPS: usize = 3;

/// A bound of the distance from the true solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Continuous {
    /// |u - v|_a is at most this.
    pub bound: f64,
    /// The bound over |v|_a.
    pub relative: f64,
    /// Whether every step is proved, rounding included.
    pub rigorous: bool,
    /// Why it is not rigorous.
    pub reason: Option<String>,
    /// The square root of each triangle's share in the square of the bound.
    pub indicators: Vec<f64>,
    /// J(u) lies between these; `None` where the data are outside the exact class.
    pub energy: Option<[f64; 2]>,
    /// What proves it.
    pub certificate: Certificate,
}

/// Certifies the P1 `solution` of `problem`.
///
/// # Errors
/// Data that don't make the problem; a solution that no certificate can be made for, with the reason.
pub fn certify(problem: &Problem, solution: &Solution) -> Result<Continuous, CertifyError> {
    certify_field(problem, solution, &solution.displacement)
}

/// Certifies any displacement `field` of `problem`, given at the vertices of the mesh: it is clipped into the admissible
/// set, and the stress comes from our own P1 `solution`.
///
/// # Errors
/// As [`certify`].
pub fn certify_field(
    problem: &Problem,
    solution: &Solution,
    field: &[[f64; 2]],
) -> Result<Continuous, CertifyError> {
    if solution.degree != 1 {
        return Err(CertifyError::Degree);
    }
    let space = Space::<P1, 3, 2>::new(&problem.mesh);
    let constraints = Constraints::new(problem, &space)?;
    let contact = contact_line::assemble(problem, &space, solution.gamma.gamma0)?;
    let parts = build::Parts::new(problem, &contact, constraints.values());
    let v = build::admissible(&parts, field);
    let (mut certificate, oscillation) = build::build(&parts, &solution.displacement, v);
    certificate.improve(SWEEPS)?;
    let proof = certificate.evaluate::<Interval>()?;
    let bound = (Interval::point(proof.bound) + Interval::point(oscillation.lift)).hi();
    let relative = (Interval::point(bound) / Interval::point(proof.norm)).hi();
    let energy = oscillation.reason.is_none().then(|| {
        let b = Interval::point(proof.bound);
        let below = Interval::point(proof.energy[0]) - b * b / Interval::from(2);
        [below.lo(), proof.energy[1]]
    });
    Ok(Continuous {
        bound,
        relative,
        rigorous: oscillation.reason.is_none(),
        reason: oscillation.reason,
        indicators: proof.shares.iter().map(|s| s.max(0.0).sqrt()).collect(),
        energy,
        certificate,
    })
}

/// Why there is no certificate.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
pub enum CertifyError {
    #[error(transparent)]
    Data(#[from] DataError),
    #[error("certificates are made for degree 1; a composite stress for degree 2 is not built")]
    Degree,
    #[error("the certificate does not hold: {0}")]
    Rejected(#[from] Rejection),
}
