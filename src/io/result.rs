//! result.json: the results of a run for programs, in the case's own consistent units.
//!
//! Each number is the shortest decimal that reads back to the same double. A number that does not exist is left out
//! together with its name: `null` never stands in the file, and a NaN or an infinity is an error that names it, where
//! JSON alone would turn it into `null` without a word. Everything but `Seconds` is the same from run to run.
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
use crate::exact::Errors;
use crate::held::solvability::Play;
use crate::model::Mesh;
use crate::proof::Intervals;
use crate::proof::enclosure::{Enclosure, Isolation, Unproved};
use crate::quote;
use crate::results::whole::Times;
use crate::results::{
    ContactBoundary, EnergyBalance, GammaReport, MethodReport, NewtonReport, Quantities,
};

/// The content of result.json, in its order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Results {
    pub(crate) version: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    /// The case file as it was read, with the settings over it; none in an older result.
    pub(crate) case: Option<String>,
    #[serde(default = "first")]
    pub(crate) schema: u32,
    pub(crate) title: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) step: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) verdict: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) missing: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) units: Option<Units>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) thickness: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) materials: Vec<MaterialEcho>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) choices: Option<Choices>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) remarks: Vec<String>,
    pub(crate) mesh: MeshSizes,
    pub(crate) gamma: GammaChoice,
    pub(crate) newton: NewtonHistory,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) method: Option<MethodReport>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) play: Vec<Play>,
    pub(crate) quantities: Quantities,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) contact: Vec<ContactBoundary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) stress: Option<StressPeaks>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) reaction_moments: BTreeMap<String, f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) balance: Option<EnergyBalance>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) probes: Vec<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) certificate: Option<Certificates>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) adapt: Option<Adaptation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) errors: Option<Errors>,
    pub(crate) seconds: Seconds,
}

/// The version of the layout of result.json. 2: an entry for each contact boundary, balance, units, materials, choices. 3: a(u, u) is
/// `a_uu`, beside `elastic_energy`; with `thickness`, forces, moments and energies are those of the whole body.
pub(crate) const SCHEMA: u32 = 3;

/// The version of files without a number.
fn first() -> u32 {
    1
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Choices {
    pub(crate) degree: usize,
    pub(crate) gamma0_auto: bool,
    pub(crate) contact_quadrature: String,
    pub(crate) allow_noncoercive: bool,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct MeshSizes {
    pub(crate) vertices: usize,
    pub(crate) triangles: usize,
    pub(crate) dofs: usize,
    pub(crate) contact_edges: usize,
    pub(crate) h_max: f64,
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
pub(crate) struct GammaChoice {
    pub(crate) gamma0: f64,
    #[serde(default)]
    pub(crate) local: bool,
    pub(crate) limit: f64,
    pub(crate) kappa: f64,
    pub(crate) limiting_edge: [[f64; 2]; 2],
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
pub(crate) struct StressPeaks {
    pub(crate) von_mises: StressPeak,
    pub(crate) principal_max: StressPeak,
    pub(crate) principal_min: StressPeak,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) hoop_max: Option<StressPeak>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) hoop_min: Option<StressPeak>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StressPeak {
    pub(crate) value: f64,
    pub(crate) at: [f64; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) surface: Option<String>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct NewtonHistory {
    pub(crate) iterations: usize,
    #[serde(flatten)]
    pub(crate) report: NewtonReport,
}

impl From<&NewtonReport> for NewtonHistory {
    fn from(report: &NewtonReport) -> Self {
        NewtonHistory { iterations: report.iterations(), report: report.clone() }
    }
}

/// How the mesh was adapted to a target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adaptation {
    pub(crate) target: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) force: Option<String>,
    /// The target is met.
    pub met: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    /// The reason why it is not.
    pub reason: Option<String>,
    /// The level that the results are of.
    pub level: usize,
    /// All levels, the given mesh first.
    pub levels: Vec<AdaptedLevel>,
}

impl Results {
    /// Turns forces, moments and energies per unit of thickness into those of a body of this thickness; intervals outwards, should
    /// a product be rounded. Norms stay what they are, per unit of thickness.
    pub(super) fn of_thickness(&mut self, thickness: f64) {
        let outwards = |[low, high]: [f64; 2], factor: f64| {
            let exact = |x: f64| x == 0.0 || factor == 1.0;
            let low = if exact(low) { low } else { (low * factor).next_down() };
            [low, if exact(high) { high } else { (high * factor).next_up() }]
        };
        let times = Times::thickness(thickness);
        times.quantities(&mut self.quantities);
        times.boundaries(&mut self.contact);
        self.balance.iter_mut().for_each(|balance| times.balance(balance));
        self.reaction_moments.values_mut().for_each(|moment| *moment *= thickness);
        let Some(Certificates { discrete, continuous }) = &mut self.certificate else { return };
        if let Some(of) = discrete.as_mut().and_then(|discrete| discrete.intervals.as_mut()) {
            times.intervals(of, outwards);
        }
        let Some(continuous) = continuous else { return };
        let energies = [&mut continuous.potential_energy, &mut continuous.compliance];
        energies.into_iter().flatten().for_each(|energy| *energy = outwards(*energy, thickness));
        for quantity in continuous.quantities.iter_mut().filter(|q| q.name != PEAK) {
            quantity.value *= thickness;
            if let Some((low, Some(high))) = &mut quantity.interval {
                [*low, *high] = outwards([*low, *high], thickness);
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
    pub(crate) fn falls_short(&self) -> bool {
        self.reason.is_some() || !self.missing.is_empty()
    }

    /// The verdict in one line, with the reasons of all that could not be had; `None` where nothing is said of a proof.
    pub(crate) fn outcome(&self) -> Option<String> {
        let verdict = self.verdict.as_deref()?;
        let verdict = match &self.reason {
            Some(reason) => format!("{}: {reason}", verdict.to_uppercase()),
            None => verdict.to_owned(),
        };
        let missing = self.missing.iter().map(|what| format!("; NO {what}"));
        Some(verdict + &missing.collect::<String>())
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Seconds {
    pub(crate) read: f64,
    pub(crate) assemble: f64,
    pub(crate) solve: f64,
    #[serde(default)]
    pub(crate) certify: f64,
    pub(crate) write: f64,
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
pub(crate) struct Certificates {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) discrete: Option<DiscreteCertificate>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) continuous: Option<ContinuousCertificate>,
}

/// The distance of the solution u~ that was computed from the exact solution u^h of (8).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct DiscreteCertificate {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) radius: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) relative: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) pressure: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) problem: Option<String>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) hardly_strains: bool,
    pub(crate) unique: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) isolated: Option<IsolatedSolution>,
    pub(crate) rigorous: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) intervals: Option<Intervals>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) probes: Vec<f64>,
}

/// With Coulomb's friction: within which distance there is no other solution, relative and in the energy norm, below which coefficient
/// there is none anywhere, for all loads, and the two limits of which that one is the larger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct IsolatedSolution {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) within: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) unique_below: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) limits: Option<[f64; 2]>,
}

impl From<Isolation> for IsolatedSolution {
    fn from(isolation: Isolation) -> Self {
        let below = isolation.limits.into_iter().fold(0.0, f64::max);
        IsolatedSolution {
            within: isolation.relative,
            unique_below: (below > 0.0).then_some(below),
            limits: (below > 0.0).then_some(isolation.limits),
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
    /// The bound of the distance of v from u in the energy norm.
    pub(crate) bound: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) relative: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    /// The value of the solution itself.
    pub(crate) of_solution: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) potential_energy: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) compliance: Option<[f64; 2]>,
    pub(crate) rigorous: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) problem: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) mean_stress: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) quantities: Vec<CertifiedQuantity>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) zones: Vec<Zone>,
}

/// A number of the true solution between two others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CertifiedQuantity {
    pub(crate) name: String,
    pub(crate) boundary: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) weight: Option<Weight>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) interval: Option<(f64, Option<f64>)>,
    pub(crate) value: f64,
    pub(crate) rigorous: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Weight {
    pub(crate) along: String,
    pub(crate) between: [f64; 2],
    pub(crate) ramp: f64,
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
    pub(crate) fn quantity(&self, name: &str, boundary: &str) -> Option<&CertifiedQuantity> {
        let is =
            |q: &&CertifiedQuantity| q.name == name && q.boundary == boundary && q.weight.is_none();
        self.quantities.iter().find(is)
    }

    pub(crate) fn contact_force(&self, boundary: &str) -> Option<[f64; 2]> {
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
pub(super) mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// All that a result may have, each number another one.
    const EVERYTHING: &str = r#"{
        "version": "0.1.0", "schema": 3, "title": "everything", "verdict": "proved",
        "units": { "length": "cm", "force": "kN" }, "thickness": 1.5,
        "materials": [{ "surfaces": [], "young": 210.5, "poisson": 0.31, "plane": "strain" }],
        "mesh": { "vertices": 101, "triangles": 103, "dofs": 202, "contact_edges": 107, "h_max": 0.109 },
        "gamma": { "gamma0": 0.0111, "limit": 0.113, "kappa": 0.127, "limiting_edge": [[1.31, 1.37], [1.39, 1.49]] },
        "newton": {
            "iterations": 11, "residuals": [0.3, 2e-12], "residual": 2e-12, "factorizations": 13, "status": "converged"
        },
        "method": {
            "route": "condensed", "predicted_operations": 17.0, "condition": 1900.0, "forward_error": 3e-13, "threads": 2, "slides": 1
        },
        "play": [{ "along": [0.6, 0.8], "least": -0.151, "most": 0.157 }],
        "quantities": {
            "a_uu": 16.3, "elastic_energy": 8.15, "work": 16.7, "max_displacement": 0.173, "contact_force": 179.0,
            "contact_resultant": [18.1, 191.0], "contact_length": 19.3, "peak_pressure": 19.7, "reactions": { "top": [19.9, -211.0] }
        },
        "contact": [{
            "boundary": "floor", "force": 22.3, "resultant": [22.7, 22.9], "moment": 23.3, "length": 2.39,
            "stretches": [[[2.41, 2.51], [2.57, 2.63]]], "peak_pressure": 26.9, "peak_at": [2.71, 2.77],
            "penetration": 0.0281, "penetration_at": [2.83, 2.93], "opening": 0.0307,
            "friction": {
                "shear": 31.1, "sticks": 3.13, "slides": 3.17, "slip": 0.0331, "slip_at": [3.37, 3.47], "dissipated": 34.9, "across_gaps": 0.0353
            }
        }],
        "stress": {
            "von_mises": { "value": 359.0, "at": [3.67, 3.73] }, "principal_max": { "value": 37.9, "at": [3.83, 3.89] },
            "principal_min": { "value": -39.7, "at": [4.01, 4.09] }, "hoop_max": { "value": 41.9, "at": [4.21, 4.31] },
            "hoop_min": { "value": -43.3, "at": [4.39, 4.43] }
        },
        "reaction_moments": { "top": 449.0 },
        "balance": { "strain": 45.7, "loads": 46.1, "supports": 46.3, "contact": 46.7, "imbalance": 4.7e-6 },
        "probes": [[4.79, 4.87, 0.0491, 0.0499]],
        "certificate": {
            "discrete": {
                "radius": 5.03e-9, "relative": 5.09e-11, "pressure": 5.21e-9, "unique": true, "rigorous": true,
                "intervals": {
                    "a_uu": [16.2, 16.4], "max_displacement": [0.172, 0.174],
                    "contact": [{ "boundary": "floor", "force": [22.2, 22.4], "resultant": [[22.6, 22.8], [22.85, 22.95]] }],
                    "reactions": { "top": [[19.8, 20.1], [-212.0, -210.0]] }
                }
            },
            "continuous": {
                "bound": 0.523, "relative": 0.0541, "of_solution": 0.2615, "potential_energy": [-54.7, -55.7],
                "compliance": [56.3, 56.9], "rigorous": true, "mean_stress": 5.71,
                "quantities": [
                    { "name": "contact force", "boundary": "floor", "interval": [21.01, 23.99], "value": 22.3, "rigorous": true },
                    { "name": "peak pressure", "boundary": "floor", "interval": [25.1, null], "value": 26.9, "rigorous": true }
                ],
                "zones": [
                    { "boundary": "floor", "from": 0.577, "to": 0.587, "ends": [[5.93, 5.99], [6.01, 6.07]], "force_at_most": 0.613 },
                    { "boundary": "floor", "from": 0.617, "to": 0.619, "ends": [[6.31, 6.41], [6.43, 6.47]], "opening_at_most": 0.0653 }
                ]
            }
        },
        "adapt": {
            "target": 0.0659, "met": true, "level": 1, "levels": [
                { "unknowns": 661, "triangles": 673, "newton_steps": 12, "bound": 0.677, "relative": 0.0683 },
                { "unknowns": 691, "triangles": 701, "newton_steps": 14, "bound": 0.709, "relative": 0.0541 }
            ]
        },
        "errors": { "energy": 7.19, "h1": 7.27, "l2": 7.33, "contact_residual": 7.39, "normal_stress": 7.43 },
        "seconds": { "read": 0.0751, "assemble": 0.0757, "solve": 7.61, "certify": 0.0769, "write": 0.0 }
    }"#;

    pub(crate) fn everything() -> Results {
        serde_json::from_str(EVERYTHING).unwrap()
    }

    /// The numbers of a value by their paths.
    fn numbers(value: &Value, path: &str, found: &mut BTreeMap<String, f64>) {
        match value {
            Value::Number(number) => {
                found.insert(path.to_owned(), number.as_f64().unwrap());
            }
            Value::Array(items) => {
                (0..).zip(items).for_each(|(i, item)| numbers(item, &format!("{path}.{i}"), found));
            }
            Value::Object(members) => {
                members
                    .iter()
                    .for_each(|(key, member)| numbers(member, &format!("{path}.{key}"), found));
            }
            _ => {}
        }
    }

    #[test]
    fn a_thickness_multiplies_forces_moments_and_energies_and_nothing_else() {
        let all = |results: &Results| {
            let mut found = BTreeMap::new();
            numbers(&serde_json::to_value(results).unwrap(), "", &mut found);
            found
        };
        let mut results = everything();
        let before = all(&results);
        results.of_thickness(4.0);
        let after = all(&results);
        let is_of_the_body = |path: &str| {
            let starts = |starts: &[&str]| starts.iter().any(|start| path.starts_with(start));
            let of_contact =
                ["force", "resultant", "moment", "friction.shear", "friction.dissipated"];
            let of_quantities = [
                ".quantities.a_uu",
                ".quantities.elastic_energy",
                ".quantities.work",
                ".quantities.contact_force",
                ".quantities.contact_resultant",
                ".quantities.reactions",
            ];
            let of_certificate = [
                ".certificate.discrete.intervals.a_uu",
                ".certificate.discrete.intervals.contact",
                ".certificate.discrete.intervals.reactions",
                ".certificate.continuous.potential_energy",
                ".certificate.continuous.compliance",
                ".certificate.continuous.quantities.0",
            ];
            of_contact.iter().any(|what| path.starts_with(&format!(".contact.0.{what}")))
                || starts(&of_quantities)
                || starts(&of_certificate)
                || starts(&[".reaction_moments", ".balance"]) && !path.ends_with("imbalance")
                || path.ends_with("force_at_most")
        };
        assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
        for (path, number) in &before {
            let expected = if is_of_the_body(path) { 4.0 * number } else { *number };
            // Ends of intervals are rounded outwards.
            assert_relative_eq!(after[path], expected, max_relative = f64::EPSILON);
        }
        assert!(before.keys().filter(|path| is_of_the_body(path)).count() > 30);
    }

    #[test]
    fn a_weight_is_along_its_own_axis() {
        for (axis, along) in ["x", "y"].into_iter().enumerate() {
            let weight = Weight::from(Ramp { axis, between: [2.0, 3.0], width: 0.5 });
            let expected = Weight { along: along.to_owned(), between: [2.0, 3.0], ramp: 0.5 };
            assert_eq!(weight, expected);
        }
    }

    #[test]
    fn the_size_of_a_mesh_is_its_largest_diameter() {
        let vertices = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [3.0, 4.0]];
        let mesh = Mesh::new(vertices, vec![[0, 1, 2], [1, 3, 2]], []).unwrap();
        let sizes = MeshSizes::new(&mesh, 9, 2);
        assert_relative_eq!(sizes.h_max, 20.0_f64.sqrt());
    }

    #[test]
    fn places_that_a_result_does_not_say_are_not_made_up() {
        let mut value = serde_json::to_value(everything()).unwrap();
        let part = value["contact"][0].as_object_mut().unwrap();
        for key in ["peak_at", "penetration", "penetration_at"] {
            assert!(part.remove(key).is_some(), "{key}");
        }
        let results: Results = serde_json::from_value(value).unwrap();
        let part = &results.contact[0];
        let unknown = [part.peak_at, part.penetration_at, [part.penetration; 2]];
        assert!(unknown.as_flattened().iter().all(|number| number.is_nan()));
        let said = |results: &Results| crate::io::summary::solved(results, &[], true);
        let is_there = |said: String| ["kN/cm^2 at (2.71", "penetration"].map(|w| said.contains(w));
        assert_eq!(
            [is_there(said(&results)), is_there(said(&everything()))],
            [[false; 2], [true; 2]]
        );
    }

    #[test]
    fn a_nan_or_an_infinity_is_refused_by_its_path() {
        type Spoil = fn(&mut Results);
        let spoils: [(Spoil, &str); 5] = [
            (|r| r.gamma.kappa = f64::NAN, "gamma.kappa"),
            (|r| r.gamma.limiting_edge[1][0] = f64::INFINITY, "gamma.limiting_edge[1][0]"),
            (|r| r.newton.report.residuals[1] = f64::NAN, "newton.residuals[1]"),
            (
                |r| {
                    r.quantities.reactions.insert("left".to_owned(), [0.0, f64::NEG_INFINITY]);
                },
                "quantities.reactions.left[1]",
            ),
            (|r| r.seconds.write = f64::NAN, "seconds.write"),
        ];
        for (spoil, place) in spoils {
            let mut results = everything();
            spoil(&mut results);
            let place = place.to_owned();
            assert_eq!(result_json(&results), Err(NotFinite { place }));
        }
        assert!(result_json(&everything()).is_ok(), "control");
    }
}
