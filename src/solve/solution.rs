//! A discrete solution: stresses, the contact line, resultants and reactions.

use std::collections::BTreeMap;
use std::sync::Arc;

#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use super::answers::{self, ContactBoundary, EnergyBalance};
use super::enclosure::{Enclosure, Unproved};
use super::iterate::Evaluated;
use super::{MethodReport, NewtonReport, Report, Verdict};
use crate::fem::contact_line::{Coercivity, Gamma};
use crate::fem::dense::inner;
use crate::fem::discretization::Discretization;
use crate::fem::piece::PieceNode;
use crate::fem::solvability::Play;
use crate::fem::{Degree, Piece};
use crate::kernel::DoubleDouble;
use crate::kernel::Stress;
use crate::kernel::contact::pressure;

/// The solution of method (8), independent of the element that it was computed with.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solution {
    /// The polynomial degree.
    pub degree: Degree,
    /// The places of the nodes: the vertices of the mesh first.
    pub nodes: Vec<[f64; 2]>,
    /// The nodes of the triangles, `nodes_per_triangle` for each, in the order of [`Element`](crate::kernel::Element).
    pub elements: Vec<usize>,
    /// 3 or 6.
    pub nodes_per_triangle: usize,
    /// u^h at the nodes.
    pub displacement: Vec<[f64; 2]>,
    /// The mean stress on each triangle, with sigma_zz.
    pub stress: Vec<(Stress<f64>, f64)>,
    /// The von Mises stress of the mean stress on each triangle.
    pub von_mises: Vec<f64>,
    /// The edges of Gamma_C, chained along the boundary.
    pub contact: Vec<ContactEdgeValues>,
    /// The pieces of Gamma_C with what method (8) has on them.
    pub pieces: Vec<Piece>,
    /// gamma0, kappa and where the limit comes from.
    pub gamma: GammaReport,
    /// How Newton's method went.
    pub newton: NewtonReport,
    /// By which route, and how accurately.
    pub method: MethodReport,
    /// How far the body may still move where contact holds it: the motions that neither supports nor what presses stops.
    pub plays: Vec<Play>,
    /// Where the exact solution of (8) is, or why nothing is proved of it.
    pub enclosure: Result<Enclosure, Unproved>,
    /// *Proved* if the distance from it is proved to be as small as asked for.
    pub verdict: Verdict,
    /// Energies, forces, lengths.
    pub quantities: Quantities,
    /// The quantities of each part of Gamma_C.
    pub boundaries: Vec<ContactBoundary>,
    /// Where the energy comes from.
    pub balance: EnergyBalance,
    /// The largest principal strain, in magnitude, of the mean strain on a triangle.
    pub largest_strain: f64,
}

/// gamma0 and the coercivity number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GammaReport {
    /// gamma along Gamma_C.
    pub gamma: Gamma,
    /// gamma0 of (7), or the smallest where each triangle has its own, in 1 / stress.
    pub gamma0: f64,
    /// kappa = gamma0 C_h.
    pub kappa: f64,
    /// C_h and the edge that sets it.
    pub coercivity: Coercivity,
}

/// One edge of Gamma_C: its nodes and the values there, in order along the edge.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactEdgeValues {
    /// The triangle that owns the edge.
    pub triangle: usize,
    /// The name of its boundary.
    pub boundary: Arc<str>,
    /// The unit outward normal n.
    pub normal: [f64; 2],
    /// The nodes in order along the edge (for P2 with the midpoint in the middle).
    pub points: Vec<ContactValues>,
}

/// The values at a node of a contact edge, as its edge has them: sigma_n jumps from edge to edge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactValues {
    /// The node.
    pub node: usize,
    /// n~, the direction of contact.
    pub direction: [f64; 2],
    /// Arc length along the boundary from the start of its first edge.
    pub arc: f64,
    /// u_n = u . n~
    pub u_n: f64,
    /// g
    pub gap: f64,
    /// n~ . sigma(u^h) n
    pub sigma_n: f64,
    /// lambda^h = -(1/gamma) \[P(u^h)\]+
    pub lambda: f64,
    /// The recovered pressure ([`super::answers`]), the one to report.
    pub pressure: f64,
    /// u_t = u . t, t being n~ turned to the left.
    pub u_t: f64,
    /// The shear stress of friction along t.
    pub shear: f64,
}

/// Scalars of a solution, in the units of the case.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct Quantities {
    /// a(u, u)
    pub energy: f64,
    /// L(u)
    pub work: f64,
    /// The largest Euclidean norm of u over the nodes.
    pub max_displacement: f64,
    /// -int lambda^h over all of Gamma_C: a sum of magnitudes, whatever their directions
    pub contact_force: f64,
    /// int lambda^h n~: the force of all obstacles on the body
    pub contact_resultant: [f64; 2],
    /// The measure of {P > 0}.
    pub contact_length: f64,
    /// max -lambda^h over Gamma_C
    pub peak_pressure: f64,
    /// The force of each displacement boundary on the body.
    pub reactions: BTreeMap<String, [f64; 2]>,
    /// The moment of each of these about the origin, counter-clockwise.
    #[cfg_attr(feature = "files", serde(skip))]
    pub reaction_moments: BTreeMap<String, f64>,
}

impl Solution {
    /// Evaluates all reported quantities of a displacement.
    pub fn new(d: &Discretization, evaluated: Evaluated, report: Report) -> Self {
        let stress = mean_stresses(d, &evaluated.u);
        let quantities = quantities(d, &evaluated);
        let Evaluated { u, p, residual } = evaluated;
        let recovered = answers::recovered_pressure(d, &p);
        let with_material =
            || stress.iter().enumerate().map(|(t, &s)| (d.problem.material.of(t), s));
        Solution {
            degree: d.space.degree(),
            nodes: d.space.nodes().to_vec(),
            elements: d.space.connectivity().to_vec(),
            nodes_per_triangle: d.space.degree().nodes_per_triangle(),
            von_mises: with_material().map(|(m, s)| m.von_mises_squared(s).sqrt()).collect(),
            stress: with_material().map(|(m, s)| (s, m.stress_zz(s))).collect(),
            contact: contact_values(d, &u, &p, &recovered),
            boundaries: answers::contact_boundaries(d, &u, &p, &recovered),
            largest_strain: answers::largest_strain(d, &u),
            balance: answers::energy_balance(d, &u, &p, &residual, quantities.energy),
            pieces: d.contact.clone(),
            gamma: GammaReport::new(d),
            newton: report.newton,
            method: report.method,
            plays: report.plays,
            enclosure: report.enclosure,
            verdict: report.verdict,
            quantities,
            displacement: u,
        }
    }

    /// u^h at the point with the barycentric coordinates `l` of triangle `t`, as [`Mesh::locate`] finds them.
    ///
    /// [`Mesh::locate`]: crate::fem::Mesh::locate
    pub fn displacement_at(&self, t: usize, l: [f64; 3]) -> [f64; 2] {
        let shapes = self.degree.values(l);
        let nodes = &self.elements[t * self.nodes_per_triangle..][..self.nodes_per_triangle];
        [0, 1].map(|c| nodes.iter().zip(&shapes).map(|(&j, n)| n * self.displacement[j][c]).sum())
    }

    /// How far the displacement at that point can be off where it is off by `nodes` at most at the nodes.
    pub fn displacement_error_at(&self, nodes: &[f64], t: usize, l: [f64; 3]) -> f64 {
        let shapes = self.degree.values(l);
        let members = &self.elements[t * self.nodes_per_triangle..][..self.nodes_per_triangle];
        let sum: f64 = members.iter().zip(shapes).map(|(&j, n)| n.abs() * nodes[j]).sum();
        // The sum, the shape functions and the displacement there are rounded.
        let size: f64 = members.iter().fold(0.0, |size: f64, &j| {
            size.max(self.displacement[j][0].abs()).max(self.displacement[j][1].abs())
        });
        sum * (1.0 + 1e-14) + 1e-14 * size
    }
}

impl GammaReport {
    /// Reports gamma, kappa and the limit of a discretization.
    pub fn new(d: &Discretization) -> Self {
        let (kappa, coercivity) = (d.kappa(), d.coercivity);
        GammaReport { gamma: d.gamma, gamma0: d.gamma0, kappa, coercivity }
    }
}

/// The mean of sigma(u) on each triangle.
fn mean_stresses(d: &Discretization, u: &[[f64; 2]]) -> Vec<Stress<f64>> {
    let stress = |t| d.problem.material.of(t).stress(d.space.mean_gradient(t, u));
    (0..d.space.mesh().triangles().len()).map(stress).collect()
}

fn contact_values(
    d: &Discretization,
    u: &[[f64; 2]],
    p: &[Vec<DoubleDouble>],
    recovered: &[Vec<f64>],
) -> Vec<ContactEdgeValues> {
    let mut start = 0.0;
    let mut line = Vec::with_capacity(d.contact.len());
    for ((edge, p), recovered) in d.contact.iter().zip(p).zip(recovered) {
        if line.last().is_none_or(|last: &ContactEdgeValues| last.boundary != *edge.boundary()) {
            start = 0.0;
        }
        let triangle = edge.edge().triangle;
        let sigma_n = edge.sigma_n(u);
        let nodes = d.space.edge_nodes(edge.edge());
        let positions = d.space.degree().edge_positions();
        let mut points: Vec<ContactValues> = (0..nodes.len())
            .map(|a| {
                let [x, y] = u[nodes[a]];
                let PieceNode { direction, gap, .. } = edge.geometry.nodes[a];
                ContactValues {
                    node: nodes[a],
                    direction: direction.into(),
                    arc: start + positions[a] * edge.length,
                    u_n: x * direction[0] + y * direction[1],
                    gap,
                    sigma_n: (1.0 - positions[a]) * sigma_n[0] + positions[a] * sigma_n[1],
                    lambda: pressure(p[a].head(), edge.gamma) + 0.0,
                    pressure: recovered[a],
                    u_t: y * direction[0] - x * direction[1],
                    shear: edge.shear_at(p, a) + 0.0,
                }
            })
            .collect();
        points.sort_by(|a, b| a.arc.total_cmp(&b.arc));
        let (boundary, normal) = (Arc::clone(edge.boundary()), edge.normal().into());
        line.push(ContactEdgeValues { triangle, boundary, normal, points });
        start += edge.length;
    }
    line
}

fn quantities(d: &Discretization, Evaluated { u, p, residual }: &Evaluated) -> Quantities {
    let mut q = Quantities {
        energy: d.strain_energy(u),
        work: inner(&d.load, u),
        max_displacement: u.iter().fold(0.0, |max, v| f64::max(max, v[0].hypot(v[1]))),
        contact_force: 0.0,
        contact_resultant: [0.0; 2],
        contact_length: 0.0,
        peak_pressure: 0.0,
        reactions: BTreeMap::new(),
        reaction_moments: BTreeMap::new(),
    };
    for (edge, p) in d.contact.iter().zip(p) {
        let contact = edge.contribution(&d.rule, p);
        q.contact_force += contact.resultant;
        for (i, force) in contact.force.iter().enumerate() {
            let n = edge.direction_of(i);
            for c in 0..2 {
                q.contact_resultant[c] -= force * n[c];
            }
        }
        q.contact_length += contact.active;
        let heads: Vec<f64> = p.iter().map(|p| p.head()).collect();
        let peak = -pressure(edge.degree.maximum(&heads), edge.gamma);
        q.peak_pressure = q.peak_pressure.max(peak);
    }
    for (boundary, held) in d.constraints.holders() {
        let reaction = q.reactions.entry(boundary.clone()).or_default();
        let moment = q.reaction_moments.entry(boundary.clone()).or_default();
        for held in held {
            let part = held.part_of(residual[held.node]);
            let [x, y] = d.space.nodes()[held.node];
            *reaction = [reaction[0] + part[0], reaction[1] + part[1]];
            *moment += x * part[1] - y * part[0];
        }
    }
    q
}
