//! result.json: what a program wants to know of a run, in the case's own consistent units.
//!
//! Each number is the shortest decimal that reads back to the same double. A number that does not exist is left out
//! together with its name: `null` never stands in the file, and a NaN or an infinity is an error that names it, where
//! JSON alone would turn it into `null` without a word. Everything but [`Seconds`] is the same from run to run.
//!
//! The meaning of each key is in docs/result.md, which a test compares with what is written.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::case::{MaterialEcho, Units};
use super::files::NotFinite;
use crate::certificates::adapt::AdaptedLevel;
use crate::certificates::quantities::{Limit, Quantity, Zone};
use crate::certificates::{CertifyError, Continuous, Ramp};
use crate::contact::contact_line::Gamma;
use crate::held::solvability::Play;
use crate::model::Mesh;
use crate::proof::Intervals;
use crate::proof::enclosure::{Enclosure, Isolation, Unproved};
use crate::quote;
use crate::results::{
    ContactBoundary, EnergyBalance, GammaReport, MethodReport, Quantities, Status,
};
use crate::study::Errors;

/// The content of result.json, in its order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Results {
    pub version: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    #[serde(default = "first")]
    pub schema: u32,
    pub title: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<Units>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<MaterialEcho>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choices: Option<Choices>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
    pub mesh: MeshSizes,
    pub gamma: GammaChoice,
    pub newton: NewtonHistory,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<MethodReport>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub play: Vec<Play>,
    pub quantities: Quantities,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contact: Vec<ContactBoundary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stress: Option<StressPeaks>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub reaction_moments: BTreeMap<String, f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub balance: Option<EnergyBalance>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certificate: Option<Certificates>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapt: Option<Adaptation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors: Option<Errors>,
    pub seconds: Seconds,
}

/// The version of the layout of result.json. 2: an entry for each contact boundary, balance, units, materials, choices. 3: a(u, u) is
/// `a_uu`, beside `elastic_energy`; with `thickness`, forces, moments and energies are those of the whole body.
pub const SCHEMA: u32 = 3;

/// The one without a number.
fn first() -> u32 {
    1
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Choices {
    pub degree: usize,
    pub gamma0_auto: bool,
    pub contact_quadrature: String,
    pub allow_noncoercive: bool,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MeshSizes {
    pub vertices: usize,
    pub triangles: usize,
    pub dofs: usize,
    pub contact_edges: usize,
    pub h_max: f64,
}

impl MeshSizes {
    pub(super) fn new(mesh: &Mesh, nodes: usize, contact_edges: usize) -> Self {
        let (vertices, triangles) = (mesh.vertices().len(), mesh.triangles().len());
        let h_max = (0..triangles).map(|t| mesh.diameter(t)).fold(0.0, f64::max);
        MeshSizes { vertices, triangles, dofs: 2 * nodes, contact_edges, h_max }
    }
}

/// Nitsche's parameter and how far it is from the limit of coercivity.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GammaChoice {
    pub gamma0: f64,
    #[serde(default)]
    pub local: bool,
    pub limit: f64,
    pub kappa: f64,
    pub limiting_edge: [[f64; 2]; 2],
}

impl From<&GammaReport> for GammaChoice {
    fn from(gamma: &GammaReport) -> Self {
        GammaChoice {
            gamma0: gamma.gamma0,
            local: matches!(gamma.gamma, Gamma::Local(_)),
            limit: gamma.coercivity.limit(),
            kappa: gamma.kappa,
            limiting_edge: gamma.coercivity.limiting_edge,
        }
    }
}

/// The largest stresses, each node taken once for each material around it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressPeaks {
    pub von_mises: StressPeak,
    pub principal_max: StressPeak,
    pub principal_min: StressPeak,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hoop_max: Option<StressPeak>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hoop_min: Option<StressPeak>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressPeak {
    pub value: f64,
    pub at: [f64; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NewtonHistory {
    pub iterations: usize,
    pub residuals: Vec<f64>,
    pub residual: f64,
    pub factorizations: usize,
    pub status: Status,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adaptation {
    pub target: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<String>,
    pub met: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    pub level: usize,
    pub levels: Vec<AdaptedLevel>,
}

impl Results {
    /// Turns forces, moments and energies per unit of thickness into those of a body of this thickness; intervals outwards, should
    /// a product be rounded. Norms stay what they are, per unit of thickness.
    pub(super) fn of_thickness(&mut self, thickness: f64) {
        let times = |x: &mut f64| *x *= thickness;
        let outwards = |[low, high]: &mut [f64; 2]| {
            let exact = |x: f64| x == 0.0 || thickness == 1.0;
            *low = if exact(*low) { *low } else { (*low * thickness).next_down() };
            *high = if exact(*high) { *high } else { (*high * thickness).next_up() };
        };
        let q = &mut self.quantities;
        [&mut q.energy, &mut q.elastic_energy, &mut q.work, &mut q.contact_force]
            .into_iter()
            .chain(&mut q.contact_resultant)
            .chain(q.reactions.values_mut().flatten())
            .chain(self.reaction_moments.values_mut())
            .for_each(times);
        for part in &mut self.contact {
            let [x, y] = &mut part.resultant;
            [&mut part.force, &mut part.moment, x, y].into_iter().for_each(times);
            let friction = part.friction.iter_mut();
            friction.for_each(|of| [&mut of.shear, &mut of.dissipated].into_iter().for_each(times));
        }
        if let Some(b) = &mut self.balance {
            let all = [&mut b.strain, &mut b.loads, &mut b.supports, &mut b.contact];
            all.into_iter().for_each(times);
        }
        let Some(Certificates { discrete, continuous }) = &mut self.certificate else { return };
        if let Some(of) = discrete.as_mut().and_then(|discrete| discrete.intervals.as_mut()) {
            outwards(&mut of.energy);
            for part in &mut of.contact {
                outwards(&mut part.force);
                part.resultant.iter_mut().for_each(outwards);
            }
            of.reactions.values_mut().flatten().for_each(outwards);
        }
        let Some(continuous) = continuous else { return };
        let energies = [&mut continuous.potential_energy, &mut continuous.compliance];
        energies.into_iter().flatten().for_each(outwards);
        for quantity in continuous.quantities.iter_mut().filter(|q| q.name != PEAK) {
            quantity.value *= thickness;
            if let Some((low, Some(high))) = &mut quantity.interval {
                let mut ends = [*low, *high];
                outwards(&mut ends);
                [*low, *high] = ends;
            }
        }
        for zone in &mut continuous.zones {
            if let Limit::Force(most) = &mut zone.limit {
                *most = (*most * thickness).next_up();
            }
        }
    }

    /// Returns whether a boundary carries more than rounding.
    pub(crate) fn is_in_contact(&self, part: &ContactBoundary) -> bool {
        self.quantities.presses(part, &self.contact)
    }

    /// Returns whether the solution is not proved, or something else that was asked for could not be had.
    pub fn falls_short(&self) -> bool {
        self.reason.is_some() || !self.missing.is_empty()
    }

    /// The verdict in one line, with the reasons of all that could not be had; `None` where nothing is said of a proof.
    pub fn outcome(&self) -> Option<String> {
        let verdict = self.verdict.as_deref()?;
        let verdict = match &self.reason {
            Some(reason) => format!("{}: {reason}", verdict.to_uppercase()),
            None => verdict.to_owned(),
        };
        let missing = self.missing.iter().map(|what| format!("; NO {what}"));
        Some(verdict + &missing.collect::<String>())
    }
}

impl NewtonHistory {
    pub fn verdict(&self) -> &'static str {
        match self.status {
            Status::Converged => "converged",
            Status::ConvergedToRounding => "converged to rounding",
        }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Seconds {
    pub read: f64,
    pub assemble: f64,
    pub solve: f64,
    #[serde(default)]
    pub certify: f64,
    pub write: f64,
}

/// The text of the file; an error has the path of the number.
pub fn result_json(results: &Results) -> Result<String, NotFinite> {
    let value_and_text = serde_json::to_value(results)
        .and_then(|value| Ok((value, serde_json::to_string_pretty(results)?)));
    let (value, text) = value_and_text.map_err(|error| NotFinite { place: error.to_string() })?;
    if let Some(place) = null_in(&value, "") {
        return Err(NotFinite { place });
    }
    Ok(quote::in_json(&text) + "\n")
}

/// The name of the only quantity that is no force and no moment.
const PEAK: &str = "peak pressure";

/// The path of a `null`, which is what serde_json makes of a NaN or an infinity: else only the upper end of a peak pressure
/// becomes one here.
fn null_in(value: &Value, place: &str) -> Option<String> {
    match value {
        Value::Null => Some(place.to_owned()),
        Value::Array(items) => {
            let mut items = items.iter().enumerate();
            items.find_map(|(i, item)| null_in(item, &format!("{place}[{i}]")))
        }
        Value::Object(members) => members.iter().find_map(|(name, member)| {
            let is_peak = members.get("name").is_some_and(|name| name == PEAK);
            let member = if is_peak && name == "interval" { &member[0] } else { member };
            let dot = if place.is_empty() { "" } else { "." };
            null_in(member, &format!("{place}{dot}{name}"))
        }),
        _ => None,
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Certificates {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discrete: Option<DiscreteCertificate>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub continuous: Option<ContinuousCertificate>,
}

/// The distance of the solution u~ that was computed from the exact solution u^h of (8).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiscreteCertificate {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub hardly_strains: bool,
    pub unique: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub isolated: Option<IsolatedSolution>,
    pub rigorous: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intervals: Option<Intervals>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<f64>,
}

/// With Coulomb's friction: within which distance there is no other solution, relative and in the energy norm, and below which coefficient
/// there is none anywhere, for all loads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct IsolatedSolution {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unique_below: Option<f64>,
}

impl From<Isolation> for IsolatedSolution {
    fn from(isolation: Isolation) -> Self {
        let below = isolation.limits.into_iter().fold(0.0, f64::max);
        IsolatedSolution {
            within: isolation.relative,
            unique_below: (below > 0.0).then_some(below),
        }
    }
}

impl From<&Result<Enclosure, Unproved>> for DiscreteCertificate {
    fn from(certificate: &Result<Enclosure, Unproved>) -> Self {
        match certificate {
            Ok(e) => DiscreteCertificate {
                radius: Some(e.radius),
                // A body at rest has no energy to compare with.
                relative: e.relative.filter(|r| r.is_finite()),
                hardly_strains: e.hardly_strains,
                pressure: Some(e.pressure),
                problem: Some("the loads as quadrature gives them".to_owned()),
                unique: e.isolation.is_none_or(|isolation| isolation.everywhere),
                isolated: e.isolation.map(IsolatedSolution::from),
                rigorous: true,
                intervals: Some(e.intervals.clone()),
                ..Default::default()
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
pub struct ContinuousCertificate {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of_solution: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub potential_energy: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compliance: Option<[f64; 2]>,
    pub rigorous: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_stress: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub quantities: Vec<CertifiedQuantity>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub zones: Vec<Zone>,
}

/// A number of the true solution between two others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CertifiedQuantity {
    pub name: String,
    pub boundary: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weight: Option<Weight>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval: Option<(f64, Option<f64>)>,
    pub value: f64,
    pub rigorous: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weight {
    pub along: String,
    pub between: [f64; 2],
    pub ramp: f64,
}

impl From<Ramp> for Weight {
    fn from(ramp: Ramp) -> Self {
        let along = ["x", "y"][ramp.axis].to_owned();
        Weight { along, between: ramp.between, ramp: ramp.width }
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
                zones: c.quantities.zones.clone(),
            },
            Err(error) => {
                ContinuousCertificate { reason: Some(error.to_string()), ..Default::default() }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file that has what every one has.
    const SAMPLE: &str = r#"{
        "version": "0.1.0", "schema": 2, "title": "A \"block\" <&> null",
        "mesh": { "vertices": 4, "triangles": 2, "dofs": 8, "contact_edges": 1, "h_max": 1.5 },
        "gamma": { "gamma0": 0.1, "limit": 0.3, "kappa": 0.3, "limiting_edge": [[0, 0], [1, 0]] },
        "newton": {
            "iterations": 2, "residuals": [1.0, 0.001, 2.5e-17], "residual": 3e-17,
            "factorizations": 1, "status": "converged to rounding"
        },
        "quantities": {
            "energy": 1.0, "work": 0.0, "max_displacement": 0.5, "contact_force": 2.0, "contact_resultant": [0.0, 2.0],
            "contact_length": 1.0, "peak_pressure": 2.0, "reactions": { "top": [0.0, 2.0] }
        },
        "seconds": { "read": 0.25, "assemble": 0.5, "solve": 1.0, "certify": 1.5, "write": 2.0 }
    }"#;

    fn sample() -> Results {
        serde_json::from_str(SAMPLE).unwrap()
    }

    #[test]
    fn what_is_known_is_written_and_what_is_not_is_left_out() {
        let mut results = sample();
        results.probes = vec![[0.5, 0.0, 0.25, -1.0], [1.0, 0.0, 0.0, 0.0]];
        results.errors = Some(Errors { normal_stress: 0.125, ..Errors::default() });
        results.quantities.reactions.clear();
        let text = result_json(&results).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["probes"][0][3], -1.0);
        assert_eq!(value["errors"]["normal_stress"], 0.125);
        assert_eq!(value["errors"].as_object().unwrap().len(), 5);
        assert!(text.contains("\"reactions\": {}\n"));
        let text = result_json(&sample()).unwrap();
        assert!(!text.contains("probes") && !text.contains("errors"));
    }

    #[test]
    fn numbers_are_the_shortest_that_read_back() {
        let numbers = [-0.0, f64::from_bits(1), f64::MAX, 0.1 + 0.2, 1e23];
        let mut results = sample();
        results.newton.residuals = numbers.to_vec();
        let text = result_json(&results).unwrap();
        let (_, rest) = text.split_once("\"residuals\": [").unwrap();
        let (list, _) = rest.split_once(']').unwrap();
        let written: Vec<String> = list.split(',').map(|n| n.trim().replace("e+", "e")).collect();
        assert_eq!(written, numbers.map(|number| format!("{number:?}")));
    }

    #[test]
    fn a_nan_or_an_infinity_is_refused_by_its_path() {
        type Spoil = fn(&mut Results);
        let spoils: [(Spoil, &str); 5] = [
            (|r| r.gamma.kappa = f64::NAN, "gamma.kappa"),
            (|r| r.gamma.limiting_edge[1][0] = f64::INFINITY, "gamma.limiting_edge[1][0]"),
            (|r| r.newton.residuals[2] = f64::NAN, "newton.residuals[2]"),
            (
                |r| {
                    r.quantities.reactions.insert("left".to_owned(), [0.0, f64::NEG_INFINITY]);
                },
                "quantities.reactions.left[1]",
            ),
            (|r| r.seconds.write = f64::NAN, "seconds.write"),
        ];
        for (spoil, place) in spoils {
            let mut results = sample();
            spoil(&mut results);
            let place = place.to_owned();
            assert_eq!(result_json(&results), Err(NotFinite { place }));
        }
    }
}
