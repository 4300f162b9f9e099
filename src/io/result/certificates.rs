//! How wrong the solution can be, in result.json: of each bound its numbers, or why there is none.

use serde::{Deserialize, Serialize};

use crate::certify::{CertifyError, Continuous};
use crate::solve::{Intervals, enclosure};

/// How wrong the solution can be.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Certificates {
    /// The distance from the exact solution of (8).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub discrete: Option<DiscreteCertificate>,
    /// The distance from the true solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continuous: Option<ContinuousCertificate>,
}

/// The distance of the solution u~ that was computed from the exact solution u^h of (8).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct DiscreteCertificate {
    /// |u~ - u^h|_a is at most this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// The same over |u~|_a.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    /// The norm of gamma^(1/2) (lambda~ - lambda^h) on Gamma_C is at most this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    /// (8) has exactly one solution: kappa, rounded up, is below 1.
    pub unique: bool,
    /// Every step is proved, rounding included.
    pub rigorous: bool,
    /// Why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// What u^h has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intervals: Option<Intervals>,
    /// How far the displacement at each probe can be from that of u^h.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<f64>,
}

impl From<&enclosure::Certificate> for DiscreteCertificate {
    fn from(certificate: &enclosure::Certificate) -> Self {
        match certificate {
            Ok(e) => DiscreteCertificate {
                radius: Some(e.radius),
                // A body at rest has no energy to compare with.
                relative: e.relative.filter(|r| r.is_finite()),
                pressure: Some(e.pressure),
                unique: true,
                rigorous: true,
                reason: None,
                intervals: Some(e.intervals.clone()),
                probes: Vec::new(),
            },
            Err(why) => DiscreteCertificate {
                unique: why.is_unique(),
                reason: Some(why.to_string()),
                ..Default::default()
            },
        }
    }
}

/// The distance of the admissible part v of the solution from the true solution u of (1)-(2).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ContinuousCertificate {
    /// |u - v|_a is at most this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    /// The same over |v|_a.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    /// |u - u^h|_a is at most this, u^h being the solution as it is written, which may go through the obstacle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of_solution: Option<f64>,
    /// The potential energy of u lies between these.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub potential_energy: Option<[f64; 2]>,
    /// The compliance L(u) lies between these.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compliance: Option<[f64; 2]>,
    /// Every step is proved, rounding included.
    pub rigorous: bool,
    /// Why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// How the problem that is bounded differs from the one that is meant: a polygon for a round body, a support against a motion
    /// that is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
}

impl From<&Result<Continuous, CertifyError>> for ContinuousCertificate {
    fn from(result: &Result<Continuous, CertifyError>) -> Self {
        match result {
            Ok(c) => ContinuousCertificate {
                bound: Some(c.bound),
                // A body at rest has no energy to compare with.
                relative: Some(c.relative).filter(|r| r.is_finite()),
                of_solution: Some(c.of_field),
                potential_energy: c.energy,
                compliance: c.compliance,
                rigorous: c.rigorous,
                reason: c.reason.clone(),
                problem: c.problem.clone(),
            },
            Err(error) => {
                ContinuousCertificate { reason: Some(error.to_string()), ..Default::default() }
            }
        }
    }
}
