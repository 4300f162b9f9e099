//! A discrete solution: stresses, the contact line, resultants and reactions.

use std::collections::BTreeMap;
use std::sync::Arc;

#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use super::answers::{self, ContactBoundary, EnergyBalance};
use super::whole::of_the_whole;
use super::{MethodReport, NewtonReport, Report, Verdict};
use crate::contact::Piece;
use crate::contact::contact_line::{Coercivity, Gamma};
use crate::contact::discretization::Discretization;
use crate::contact::piece::{PieceNode, Stretch};
use crate::held::solvability::Play;
use crate::kernel::DoubleDouble;
use crate::kernel::Stress;
use crate::kernel::contact::pressure;
use crate::linear::dense::inner;
use crate::model::Degree;
use crate::proof::enclosure::{Enclosure, Unproved};
use crate::proof::intervals::{Intervals, Range};
use crate::solve::iterate::Evaluated;

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
    /// The mean stress on each triangle, with sigma_zz; in a body of revolution the stress in the meridian, with the hoop stress.
    pub stress: Vec<(Stress<f64>, f64)>,
    /// The von Mises stress of the mean stress on each triangle.
    pub von_mises: Vec<f64>,
    /// The edges of Gamma_C, chained along the boundary: those that face obstacles, then of each pair of bodies those of the first side
    /// and those of the second, which have the same numbers at places of their own.
    pub contact: Vec<ContactEdge>,
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
    /// Where that is: the middle of the triangle, in the undeformed body.
    pub largest_strain_at: [f64; 2],
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

/// An edge of Gamma_C: one that faces an obstacle, or a side of a piece between two bodies.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactEdge {
    /// The name of its boundary.
    pub boundary: Arc<str>,
    /// The name of the other boundary of a pair.
    pub partner: Option<Arc<str>>,
    /// The nodes, or the places on the edge of those of the piece, in order along it (for P2 with the midpoint in the middle).
    pub points: Vec<ContactPoint>,
}

/// A point of a contact edge, with the values that its edge has there: sigma_n jumps from edge to edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ContactPoint {
    /// The node, if it is one.
    pub node: Option<usize>,
    /// Arc length along the boundary, or along the pieces of the pair, from the start of its first edge.
    pub arc: f64,
    /// The place in the undeformed body.
    pub place: [f64; 2],
    /// u^h there.
    pub displacement: [f64; 2],
    /// n~, the direction of contact, out of the body.
    pub direction: [f64; 2],
    /// u_n = u . n~, or the jump of that.
    pub u_n: f64,
    /// g
    pub gap: f64,
    /// n~ . sigma(u^h) n, or the mean of it on the two sides that (8) has.
    pub sigma_n: f64,
    /// lambda^h = -(1/gamma) \[P(u^h)\]+
    pub lambda: f64,
    /// The recovered pressure ([`super::answers`]), the one to report.
    pub pressure: f64,
    /// u_t = u . t, or the jump of that, t being n~ turned to the left.
    pub u_t: f64,
    /// The shear stress of friction along t; on both sides of a pair that on the first body.
    pub shear: f64,
}

/// Scalars of a solution, in the units of the case.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct Quantities {
    /// a(u, u), twice the elastic energy.
    #[cfg_attr(feature = "files", serde(rename = "a_uu", alias = "energy"))]
    pub energy: f64,
    /// The elastic energy, a(u, u) / 2; 0 in a result that does not say so.
    #[cfg_attr(feature = "files", serde(default))]
    pub elastic_energy: f64,
    /// L(u)
    pub work: f64,
    /// The largest Euclidean norm of u over the nodes.
    pub max_displacement: f64,
    /// -int lambda^h over all of Gamma_C, pairs of bodies included: a sum of magnitudes, whatever their directions
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

/// The share of all forces below which a contact force is rounding.
const NO_FORCE: f64 = 1e-10;

impl Quantities {
    /// The sum of the magnitudes of the reactions and of the forces on all parts of Gamma_C.
    pub(crate) fn all_forces(&self, boundaries: &[ContactBoundary]) -> f64 {
        let contact: f64 = boundaries.iter().map(|part| part.force.abs()).sum();
        let reactions = self.reactions.values().map(|[x, y]| x.hypot(*y));
        contact.max(self.contact_force.abs()) + reactions.sum::<f64>()
    }

    /// Returns whether one of the parts of Gamma_C carries more than rounding.
    pub(crate) fn presses(&self, part: &ContactBoundary, boundaries: &[ContactBoundary]) -> bool {
        part.force > NO_FORCE * self.all_forces(boundaries)
    }
}

impl Solution {
    /// Evaluates all reported quantities of a displacement.
    pub fn new(d: &Discretization, evaluated: Evaluated, report: Report) -> Self {
        let stress = mean_stresses(d, &evaluated.u);
        let of_revolution = d.problem.material.are_of_revolution();
        let mut quantities = quantities(d, &evaluated);
        let Evaluated { u, p, residual } = evaluated;
        let recovered = answers::recovered_pressure(d, &p);
        let (largest_strain, largest_strain_at) = answers::largest_strain(d, &u);
        let balance = answers::energy_balance(d, &u, &p, &residual, quantities.energy);
        let mut boundaries = answers::contact_boundaries(d, &u, &p, &recovered);
        if let Ok(enclosure) = &report.enclosure {
            put_between(&enclosure.intervals, &mut quantities, &mut boundaries);
        }
        let solution = Solution {
            degree: d.space.degree(),
            nodes: d.space.nodes().to_vec(),
            elements: d.space.connectivity().to_vec(),
            nodes_per_triangle: d.space.degree().nodes_per_triangle(),
            von_mises: stress.iter().map(|(s, zz)| s.von_mises_squared(*zz).sqrt()).collect(),
            stress,
            contact: contact_edges(d, &u, &p, &recovered),
            boundaries,
            largest_strain,
            largest_strain_at,
            balance,
            pieces: d.contact.clone(),
            gamma: GammaReport::new(d),
            newton: report.newton,
            method: report.method,
            plays: report.plays,
            enclosure: report.enclosure,
            verdict: report.verdict,
            quantities,
            displacement: u,
        };
        if of_revolution { of_the_whole(solution) } else { solution }
    }

    /// The jumps across the direction of contact at the nodes of each piece of Gamma_C with friction: where the friction of a next load
    /// step begins (`Problem::slip`).
    pub fn slip(&self) -> Vec<Vec<f64>> {
        let of = |piece: &Piece| piece.across(&piece.jumps(&self.displacement)).to_vec();
        self.pieces.iter().map(of).collect()
    }

    /// u^h at the point with the barycentric coordinates `l` of triangle `t`, as [`Mesh::locate`] finds them.
    ///
    /// [`Mesh::locate`]: crate::model::Mesh::locate
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

/// Moves numbers that are outside their proved intervals by their own rounding, as the energy of a body that hardly strains is,
/// to the nearer ends.
fn put_between(
    proved: &Intervals,
    quantities: &mut Quantities,
    boundaries: &mut [ContactBoundary],
) {
    let put = |value: &mut f64, [low, high]: Range| *value = value.max(low).min(high);
    put(&mut quantities.energy, proved.energy);
    put(&mut quantities.max_displacement, proved.max_displacement);
    for (name, reaction) in &mut quantities.reactions {
        let intervals = proved.reactions.get(name).into_iter().flatten();
        reaction.iter_mut().zip(intervals).for_each(|(r, &range)| put(r, range));
    }
    for part in boundaries {
        let own = proved
            .contact
            .iter()
            .find(|of| of.boundary == part.boundary && of.partner == part.partner);
        let Some(of) = own else { continue };
        put(&mut part.force, of.force);
        part.resultant.iter_mut().zip(of.resultant).for_each(|(r, range)| put(r, range));
    }
}

impl GammaReport {
    /// Reports gamma, kappa and the limit of a discretization.
    pub(crate) fn new(d: &Discretization) -> Self {
        let (kappa, coercivity) = (d.kappa(), d.coercivity);
        GammaReport { gamma: d.gamma, gamma0: d.gamma0, kappa, coercivity }
    }
}

/// The mean of sigma(u) on each triangle, and that of the stress across the plane.
fn mean_stresses(d: &Discretization, u: &[[f64; 2]]) -> Vec<(Stress<f64>, f64)> {
    let stress = |t| {
        let material = d.problem.material.of(t);
        material.state(d.space.mean_gradient(t, u), d.space.mean_hoop_strain(t, material, u))
    };
    (0..d.space.mesh().triangles().len()).map(stress).collect()
}

/// The edges of Gamma_C, line by line; of a line between two bodies the first side and then the second.
fn contact_edges(
    d: &Discretization,
    u: &[[f64; 2]],
    p: &[Vec<DoubleDouble>],
    recovered: &[Vec<f64>],
) -> Vec<ContactEdge> {
    let mut edges = Vec::with_capacity(d.contact.len());
    let pieces: Vec<_> = d.contact.iter().zip(p.iter().zip(recovered)).collect();
    for line in pieces.chunk_by(|(piece, _), (next, _)| piece.is_of_same_boundary(next)) {
        for side in 0..line[0].0.geometry.stretches.len() {
            let mut start = 0.0;
            for &(piece, (p, recovered)) in line {
                edges.push(contact_edge(d, u, (piece, side), (p, recovered), start));
                start += piece.length;
            }
        }
    }
    edges
}

fn contact_edge(
    d: &Discretization,
    u: &[[f64; 2]],
    (piece, side): (&Piece, usize),
    (p, recovered): (&[DoubleDouble], &[f64]),
    start: f64,
) -> ContactEdge {
    let (degree, stretches) = (d.space.degree(), &piece.geometry.stretches);
    let (sigma_n, jumps) = (piece.sigma_n(u), piece.jumps(u));
    let response = piece.geometry.law.responses()[0];
    let displacement = |stretch: &Stretch, a: usize| {
        [0, 1].map(|c| {
            let values: Vec<f64> =
                d.space.edge_nodes(stretch.edge).map(|node| u[node][c]).collect();
            degree.value_at(&values, stretch.positions[a])
        })
    };
    let value = |(a, s): (usize, f64)| {
        let PieceNode { direction, gap, .. } = piece.geometry.nodes[a];
        let node = match &stretches[..] {
            [only] => d.space.edge_nodes(only.edge).nth(a),
            _ => None,
        };
        let each = stretches.iter().map(|stretch| displacement(stretch, a));
        let [x, y] = each.reduce(|u, v| [u[0] - v[0], u[1] - v[1]]).unwrap_or_default();
        let own = &stretches[side];
        ContactPoint {
            node,
            arc: start + s * piece.length,
            place: node.map_or_else(|| own.place(d.space.mesh(), a), |node| d.space.nodes()[node]),
            displacement: displacement(own, a),
            direction: if side == 0 { direction } else { -direction }.into(),
            u_n: jumps[a],
            gap,
            sigma_n: (1.0 - s) * sigma_n[0] + s * sigma_n[1],
            lambda: -(response.q(p[a].head()) / piece.gamma) + 0.0,
            pressure: recovered[a],
            u_t: y * direction[0] - x * direction[1],
            shear: piece.shear_at(p, a) + 0.0,
        }
    };
    let mut points: Vec<ContactPoint> = degree.edge_positions().enumerate().map(value).collect();
    points.sort_by(|a, b| a.arc.total_cmp(&b.arc));
    let name = |k: usize| stretches.get(k).map(|stretch| Arc::clone(&stretch.boundary));
    ContactEdge { boundary: Arc::clone(&stretches[side].boundary), partner: name(1 - side), points }
}

fn quantities(d: &Discretization, Evaluated { u, p, residual }: &Evaluated) -> Quantities {
    let energy = d.strain_energy(u);
    let mut q = Quantities {
        energy,
        elastic_energy: energy / 2.0,
        work: inner(&d.load, u),
        max_displacement: u.iter().fold(0.0, |max, v| f64::max(max, v[0].hypot(v[1]))),
        ..Quantities::default()
    };
    for (edge, p) in d.contact.iter().zip(p) {
        let contact = edge.contribution(&d.rule, p);
        q.contact_force += contact.resultant;
        for (i, force) in contact.force.iter().enumerate().filter(|_| edge.partner().is_none()) {
            let n = edge.direction_of(i);
            for c in 0..2 {
                q.contact_resultant[c] -= force * n[c];
            }
        }
        q.contact_length += contact.active;
        let along = &p[..edge.degree.nodes_per_edge()];
        let heads: Vec<f64> = along.iter().map(|p| p.head()).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proof::intervals::ContactIntervals;

    #[test]
    fn each_pair_of_a_boundary_in_two_pairs_has_its_own_interval() {
        let partners = [None, Some("left"), Some("right")];
        let boundary = |(k, partner): (usize, Option<&str>)| ContactBoundary {
            force: k as f64,
            resultant: [-(k as f64); 2],
            ..ContactBoundary::empty("pin", partner.map(str::to_owned))
        };
        let mut parts: Vec<_> = partners.into_iter().enumerate().map(boundary).collect();
        let before = parts.clone();
        let interval = |(k, partner): (usize, Option<&str>)| {
            let (low, high) = (k as f64 + 0.25, k as f64 + 0.5);
            ContactIntervals {
                boundary: "pin".to_owned(),
                partner: partner.map(str::to_owned),
                force: [low, high],
                resultant: [[-high, -low]; 2],
            }
        };
        let proved = |partners: &[Option<&str>]| Intervals {
            energy: [0.0; 2],
            max_displacement: [0.0; 2],
            contact: partners.iter().copied().enumerate().map(interval).collect(),
            reactions: BTreeMap::new(),
        };
        let mut quantities = Quantities::default();
        put_between(&proved(&partners), &mut quantities, &mut parts);
        for (k, part) in parts.iter().enumerate() {
            let at = k as f64 + 0.25;
            assert_eq!((part.force, part.resultant), (at, [-at; 2]), "{k}");
        }
        // The control: that of another partner is none of its own.
        let mut parts = before.clone();
        put_between(&proved(&[Some("other")]), &mut quantities, &mut parts);
        assert_eq!(parts, before);
    }
}
