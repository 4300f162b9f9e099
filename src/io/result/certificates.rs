//! Bounds of the error in result.json: the numbers of each, or why there is none.

use serde::{Deserialize, Serialize};

use crate::certify::quantities::{Limit, Quantity, Zone};
use crate::certify::{CertifyError, Continuous, Ramp};
use crate::solve::Intervals;
use crate::solve::enclosure::{Enclosure, Unproved};

/// The bounds of the error.
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
    /// The radius over |u~|_a.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    /// The norm of gamma^(1/2) (lambda~ - lambda^h) on Gamma_C is at most this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    /// The equations (8) that are meant: integrals of the loads are those of their quadrature.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
    /// (8) has exactly one solution: kappa, rounded up, is below 1.
    pub unique: bool,
    /// Every step is proved, rounding included.
    pub rigorous: bool,
    /// The reason why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Intervals of the discrete solution's quantities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intervals: Option<Intervals>,
    /// A bound of the distance of the displacement at each probe from that of u^h.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<f64>,
}

impl From<&Result<Enclosure, Unproved>> for DiscreteCertificate {
    fn from(certificate: &Result<Enclosure, Unproved>) -> Self {
        match certificate {
            Ok(e) => DiscreteCertificate {
                radius: Some(e.radius),
                // A body at rest has no energy to compare with.
                relative: e.relative.filter(|r| r.is_finite()),
                pressure: Some(e.pressure),
                problem: Some("the loads as quadrature gives them".to_owned()),
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
    /// The bound over |v|_a.
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
    /// The reason why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The difference between the problem that is bounded and the one that is meant: a polygon for a round body, a support
    /// against a motion that is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
    /// The distance of the true stress from (C eps(v) + tau) / 2 is at most this, in the norm of energy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_stress: Option<f64>,
    /// Forces, moments, reactions and peaks of the true solution.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub quantities: Vec<CertifiedQuantity>,
    /// Stretches where contact can hardly act, or where the body can hardly be off the obstacle.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub zones: Vec<CertifiedZone>,
}

/// A number of the true solution between two others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct CertifiedQuantity {
    /// The quantity: `contact force`, `contact moment`, `reaction x` and so on.
    pub name: String,
    /// The boundary.
    pub boundary: String,
    /// The weight of the pressure, if there is one: it is 1 where the coordinate `along` is between two numbers, and falls to
    /// 0 over a width.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weight: Option<Weight>,
    /// The interval that contains the value of the true solution; a peak pressure has no upper end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<(f64, Option<f64>)>,
    /// The value of the discrete solution.
    pub value: f64,
    /// Every step is proved, rounding included.
    pub rigorous: bool,
    /// The reason why not, or why there is no interval.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// A weight along a contact boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weight {
    /// `x` or `y`.
    pub along: Coordinate,
    /// The range of the coordinate where it is 1.
    pub between: [f64; 2],
    /// The width over which it falls to 0 beyond.
    pub ramp: f64,
}

/// A coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Coordinate {
    /// x
    X,
    /// y
    Y,
}

impl From<Ramp> for Weight {
    fn from(ramp: Ramp) -> Self {
        let along = if ramp.axis == 0 { Coordinate::X } else { Coordinate::Y };
        Weight { along, between: ramp.between, ramp: ramp.width }
    }
}

/// A stretch of a contact boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct CertifiedZone {
    /// The boundary.
    pub boundary: String,
    /// Its start: arc length from the start of the boundary's first edge.
    pub from: f64,
    /// Its end.
    pub to: f64,
    /// The places of both, in the undeformed body.
    pub ends: [[f64; 2]; 2],
    /// The contact force of the true solution there is at most this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_at_most: Option<f64>,
    /// The integral of its opening there is at most this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opening_at_most: Option<f64>,
}

impl From<&Zone> for CertifiedZone {
    fn from(zone: &Zone) -> Self {
        let (force_at_most, opening_at_most) = match zone.limit {
            Limit::Force(most) => (Some(most), None),
            Limit::Opening(most) => (None, Some(most)),
        };
        let Zone { boundary, from, to, ends, .. } = zone.clone();
        CertifiedZone { boundary, from, to, ends, force_at_most, opening_at_most }
    }
}

impl CertifiedQuantity {
    fn new(quantity: &Quantity, certified: &Continuous) -> Self {
        let end = |end: f64| Some(end).filter(|end| end.is_finite());
        let proved = quantity.interval.as_ref();
        CertifiedQuantity {
            name: quantity.name.text().to_owned(),
            boundary: quantity.boundary.clone(),
            weight: quantity.weight.map(Weight::from),
            interval: proved.ok().and_then(|&[low, high]| Some((end(low)?, end(high)))),
            value: quantity.value,
            rigorous: certified.rigorous && proved.is_ok(),
            reason: proved.err().cloned().or_else(|| certified.reason.clone()),
        }
    }
}

impl ContinuousCertificate {
    /// The number of a boundary with this name, of the pressure as it is.
    pub fn quantity(&self, name: &str, boundary: &str) -> Option<&CertifiedQuantity> {
        let is =
            |q: &&CertifiedQuantity| q.name == name && q.boundary == boundary && q.weight.is_none();
        self.quantities.iter().find(is)
    }

    /// The interval of a boundary's contact force.
    pub fn contact_force(&self, boundary: &str) -> Option<[f64; 2]> {
        let (low, high) = self.quantity("contact force", boundary)?.interval?;
        Some([low, high?])
    }
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
                mean_stress: Some(c.quantities.mean_stress),
                quantities: c
                    .quantities
                    .list
                    .iter()
                    .map(|q| CertifiedQuantity::new(q, c))
                    .collect(),
                zones: c.quantities.zones.iter().map(CertifiedZone::from).collect(),
            },
            Err(error) => {
                ContinuousCertificate { reason: Some(error.to_string()), ..Default::default() }
            }
        }
    }
}
