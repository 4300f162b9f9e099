//! result.json: what a program wants to know of a run, in the case's own consistent units.
//!
//! Each number is the shortest decimal that reads back to the same double. A number that does not exist is left out
//! together with its name: `null` never stands in the file, and a NaN or an infinity is an error that names it, where
//! JSON alone would turn it into `null` without a word. Everything but [`Seconds`] is the same from run to run.

mod certificates;

use std::collections::BTreeMap;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::case::{MaterialEcho, Units};
use super::finite::NotFinite;
use crate::certify::adapt::AdaptedLevel;
use crate::fem::Mesh;
use crate::fem::contact_line::Gamma;
use crate::fem::solvability::Play;
use crate::solve::{
    ContactBoundary, ContactQuadrature, EnergyBalance, Gamma0, GammaReport, Method, MethodReport,
    NewtonReport, Quantities, Status, Times,
};
use crate::study::Errors;
pub use certificates::{
    Certificates, CertifiedQuantity, CertifiedZone, ContinuousCertificate, DiscreteCertificate,
};

/// The content of result.json, in its order.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Results {
    /// The version of this program.
    pub version: String,
    /// The case file, as the command was given it; left out by the engine fenicsx.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// The version of this layout: [`SCHEMA`].
    #[serde(default = "first")]
    pub schema: u32,
    /// The title of the case.
    pub title: String,
    /// "proved" or "not proved": whether the exact solution of (8) is within `solver.proof` of the one here; left out by the
    /// engine fenicsx.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<String>,
    /// The reason why it is not proved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Results asked for beside the solution that could not be had, with the reason; left out if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<String>,
    /// The units of the case; left out if it names none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<Units>,
    /// The thickness of the body across the plane, if the case gives it: forces, moments and energies are per unit of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
    /// The materials and the physical surfaces made of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<MaterialEcho>,
    /// The method as the case chose it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choices: Option<Choices>,
    /// Remarks that a reader should know before the numbers are used; left out if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
    /// The discretisation.
    pub mesh: MeshSizes,
    /// Nitsche's parameter.
    pub gamma: GammaChoice,
    /// The iteration.
    pub newton: NewtonHistory,
    /// The route and the accuracy; left out by the engine fenicsx.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method: Option<MethodReport>,
    /// The motions that are still free; left out where supports or what presses hold it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub play: Vec<Play>,
    /// The solution in numbers.
    pub quantities: Quantities,
    /// The force on each contact boundary.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contact: Vec<ContactBoundary>,
    /// The largest stresses; left out by the engine fenicsx.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stress: Option<StressPeaks>,
    /// The moment about the origin of the force of each displacement boundary, counter-clockwise.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub reaction_moments: BTreeMap<String, f64>,
    /// The sources of the energy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub balance: Option<EnergyBalance>,
    /// `[x, y, u_x, u_y]` at the points that the case asks for; left out if it asks for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<[f64; 4]>,
    /// Bounds of the error; left out if nothing is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certificate: Option<Certificates>,
    /// The adaptation of the mesh; left out if there was none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adapt: Option<Adaptation>,
    /// The distances from the exact solution; left out if the case has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub errors: Option<Errors>,
    /// The time of each step.
    pub seconds: Seconds,
}

/// The version of the layout of result.json. 2: an entry for each contact boundary, balance, units, materials, choices.
pub const SCHEMA: u32 = 2;

/// The one without a number.
fn first() -> u32 {
    1
}

/// The method as the case chose it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Choices {
    /// The polynomial degree.
    pub degree: usize,
    /// gamma0 was chosen by the program.
    pub gamma0_auto: bool,
    /// "exact", or the number of Gauss points on each contact edge.
    pub contact_quadrature: String,
    /// kappa >= 1 was allowed.
    pub allow_noncoercive: bool,
}

impl From<&Method> for Choices {
    fn from(method: &Method) -> Self {
        Choices {
            degree: method.degree.number(),
            gamma0_auto: method.gamma0 == Gamma0::Auto,
            contact_quadrature: match method.quadrature {
                ContactQuadrature::Exact => "exact".to_owned(),
                ContactQuadrature::Gauss(points) => points.to_string(),
            },
            allow_noncoercive: method.allow_noncoercive,
        }
    }
}

/// The discretisation.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MeshSizes {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Degrees of freedom: twice the nodes.
    pub dofs: usize,
    /// Edges on Gamma_C.
    pub contact_edges: usize,
    /// The largest h_T.
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
#[non_exhaustive]
pub struct GammaChoice {
    /// gamma0 of (7), or the smallest where each contact edge has its own.
    pub gamma0: f64,
    /// Each contact edge has its own gamma0, for one kappa.
    #[serde(default)]
    pub local: bool,
    /// The gamma0 for which kappa is 1.
    pub limit: f64,
    /// kappa of (11).
    pub kappa: f64,
    /// The ends of the contact edge that sets the limit.
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
#[non_exhaustive]
pub struct StressPeaks {
    /// The largest von Mises stress.
    pub von_mises: StressPeak,
    /// The largest principal stress.
    pub principal_max: StressPeak,
    /// The smallest principal stress.
    pub principal_min: StressPeak,
}

/// A largest or smallest stress.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct StressPeak {
    /// Its value in the unit of stress of the case.
    pub value: f64,
    /// The place in the undeformed body.
    pub at: [f64; 2],
    /// The physical surface that it is in; left out if the mesh names none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
}

/// Newton's iteration.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[non_exhaustive]
pub struct NewtonHistory {
    /// Steps taken.
    pub iterations: usize,
    /// The relative residual before the first step and after each, as the iteration saw it.
    pub residuals: Vec<f64>,
    /// The relative residual of the solution, evaluated from the definitions.
    pub residual: f64,
    /// Matrices factored.
    pub factorizations: usize,
    /// The verdict.
    pub status: Status,
}

impl From<&NewtonReport> for NewtonHistory {
    fn from(newton: &NewtonReport) -> Self {
        NewtonHistory {
            iterations: newton.iterations(),
            residuals: newton.residuals.clone(),
            residual: newton.residual,
            factorizations: newton.factorizations,
            status: newton.status,
        }
    }
}

/// The adaptation of the mesh to a target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adaptation {
    /// The bound over the energy norm, or half the width of what the force lies between over its middle, was to be at most this.
    pub target: f64,
    /// The boundary whose contact force it is about, if it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<String>,
    /// It was met.
    pub met: bool,
    /// The reason why it is not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The mesh of these results, by its number in `levels`, from 0.
    pub level: usize,
    /// All meshes, from the coarsest on.
    pub levels: Vec<AdaptedLevel>,
}

/// A contact force below this share of all forces is rounding.
const NO_FORCE: f64 = 1e-10;

impl Results {
    /// The sum of the magnitudes of contact forces and reactions.
    pub(crate) fn all_forces(&self) -> f64 {
        let contact: f64 = self.contact.iter().map(|part| part.force.abs()).sum();
        let reactions = self.quantities.reactions.values().map(|[x, y]| x.hypot(*y));
        contact.max(self.quantities.contact_force.abs()) + reactions.sum::<f64>()
    }

    /// Returns whether a boundary carries more than rounding.
    pub(crate) fn is_in_contact(&self, part: &ContactBoundary) -> bool {
        part.force > NO_FORCE * self.all_forces()
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
    /// The verdict, in words.
    pub fn verdict(&self) -> &'static str {
        match self.status {
            Status::Converged => "converged",
            Status::ConvergedToRounding => "converged to rounding",
        }
    }
}

/// The time of each step.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Seconds {
    /// Reading and meshing.
    pub read: f64,
    /// Assembling.
    pub assemble: f64,
    /// Factoring and iterating.
    pub solve: f64,
    /// Proving how wrong the result can be.
    #[serde(default)]
    pub certify: f64,
    /// Writing the other files; 0 where none was written.
    pub write: f64,
}

impl Seconds {
    /// The timings of a solve that took `times` after `read`, before files are written.
    pub fn new(read: Duration, times: &Times) -> Self {
        Seconds {
            read: read.as_secs_f64(),
            assemble: times.assemble().as_secs_f64(),
            solve: times.solve().as_secs_f64(),
            certify: times.certify.as_secs_f64(),
            write: 0.0,
        }
    }
}

/// The text of the file.
///
/// # Errors
/// [`NotFinite`], with the path of the number.
pub fn result_json(results: &Results) -> Result<String, NotFinite> {
    let value_and_text = serde_json::to_value(results)
        .and_then(|value| Ok((value, serde_json::to_string_pretty(results)?)));
    let (value, text) = value_and_text.map_err(|error| NotFinite { place: error.to_string() })?;
    if let Some(place) = null_in(&value, "") {
        return Err(NotFinite { place });
    }
    Ok(text + "\n")
}

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
            let is_peak = members.get("name").is_some_and(|name| name == "peak pressure");
            let member = if is_peak && name == "interval" { &member[0] } else { member };
            let dot = if place.is_empty() { "" } else { "." };
            null_in(member, &format!("{place}{dot}{name}"))
        }),
        _ => None,
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
        let refused = |spoil: fn(&mut Results)| {
            let mut results = sample();
            spoil(&mut results);
            result_json(&results).unwrap_err().to_string()
        };
        let expected =
            |place: &str| format!("{place} is NaN or infinite; expected a finite number");
        assert_eq!(refused(|r| r.gamma.kappa = f64::NAN), expected("gamma.kappa"));
        assert_eq!(
            refused(|r| r.gamma.limiting_edge[1][0] = f64::INFINITY),
            expected("gamma.limiting_edge[1][0]")
        );
        assert_eq!(refused(|r| r.newton.residuals[2] = f64::NAN), expected("newton.residuals[2]"));
        assert_eq!(
            refused(|r| {
                r.quantities.reactions.insert("left".to_owned(), [0.0, f64::NEG_INFINITY]);
            }),
            expected("quantities.reactions.left[1]")
        );
        assert_eq!(refused(|r| r.seconds.write = f64::NAN), expected("seconds.write"));
    }
}
