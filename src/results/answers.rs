//! Quantities of each part of Gamma_C: resultant, moment, where there is contact, the recovered pressure, penetration; and
//! the balance of energies.
//!
//! For a pair of bodies all quantities are those on the first; the force on the second is the opposite.
//!
//! The force of the obstacle on the body is the functional v -> -int (1/gamma) \[P\]+ I(n~ . v): -G_a n~_a at node a, with
//! G_a = int (1/gamma) \[P\]+ N_a. With v a rigid motion it gives resultant and moment, and these balance loads and reactions
//! to rounding.
//!
//! **The recovered pressure** at a node is the mean of -lambda^h weighted by the node's hat function on the contact line (for
//! P2 on half edges where the line is straight): p_a = int (-lambda^h) phi_a / int phi_a. The hats are not negative and add
//! up to one, so 0 <= p_a <= max(-lambda^h), and sum p_a phi_a has the same integral as -lambda^h on every part of Gamma_C,
//! to rounding. -lambda^h jumps from edge to edge as sigma_n does; the mean takes out the jumps. The mean is of second order
//! where the pressure is smooth and neighbouring edges differ little in length (docs/parts.md has the numbers). At a corner,
//! where the direction of contact jumps, each side has its own value. Between two bodies the hats are those of the edges of the
//! body that has more of them.
//!
//! On a curved line the edge is a chord, off the boundary by delta = s (|E| - s) / 2R at s, and u there is off by delta times
//! the derivative of u along n: a wave along the line with the period of the edges, of order |E|^2, which sigma_n of P2 sees
//! as one of order |E| that is even on each edge and has the mean 0. Means with the hats of whole edges remove such a wave;
//! those of half edges would keep it. So on a curved edge only the ends have a hat, and the value in the middle is the mean of
//! the values there.

use std::collections::{BTreeMap, BTreeSet};

#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use nalgebra::Vector2;

use crate::contact::Law;
use crate::contact::discretization::Discretization;
use crate::contact::piece::Contribution;
use crate::contact::{EdgeRule, Piece};
use crate::kernel::DoubleDouble;
use crate::kernel::edge_integral::radius;
use crate::linear::dense::inner;
use crate::model::Degree;
use crate::model::law::Bound;
use crate::model::mesh::{NO_ANGLE, length};

/// The quantities of one part of Gamma_C, in the units of the case.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize), serde(default))]
#[non_exhaustive]
pub struct ContactBoundary {
    /// Its name.
    pub boundary: String,
    /// The name of the boundary of the other body, if there is one.
    #[cfg_attr(feature = "files", serde(skip_serializing_if = "Option::is_none"))]
    pub partner: Option<String>,
    /// int -lambda^h
    pub force: f64,
    /// The force of the obstacle, or of the other body, on the body.
    pub resultant: [f64; 2],
    /// The moment of that force about the origin, counter-clockwise.
    pub moment: f64,
    /// The measure of {P > 0}.
    pub length: f64,
    /// The ends of each stretch with contact, in the undeformed body, in the direction of the boundary.
    pub stretches: Vec<[[f64; 2]; 2]>,
    /// The largest recovered pressure.
    pub peak_pressure: f64,
    /// Where that is, in the undeformed body; NaN in a result that does not say so.
    #[cfg_attr(feature = "files", serde(default = "unknown_place"))]
    pub peak_at: [f64; 2],
    /// The largest u_n - g: how far the body reaches into the obstacle; negative if it nowhere touches it, NaN in a result
    /// that does not say so.
    #[cfg_attr(feature = "files", serde(default = "unknown"))]
    pub penetration: f64,
    /// Where that is, in the undeformed body; NaN in a result that does not say so.
    #[cfg_attr(feature = "files", serde(default = "unknown_place"))]
    pub penetration_at: [f64; 2],
    /// The largest g - u_n between two bodies; negative where they overlap everywhere.
    #[cfg_attr(feature = "files", serde(skip_serializing_if = "Option::is_none"))]
    pub opening: Option<f64>,
    /// The effect of friction; left out without friction.
    #[cfg_attr(feature = "files", serde(skip_serializing_if = "Option::is_none"))]
    pub friction: Option<BoundaryFriction>,
}

/// The quantities of friction on one part of Gamma_C.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct BoundaryFriction {
    /// The sum over its edges of the magnitudes of their shear forces.
    pub(crate) shear: f64,
    /// The measure of where the body sticks, within the bound.
    pub sticks: f64,
    /// The measure of where it slides, at the bound.
    pub slides: f64,
    /// The largest magnitude of the slip at a node: u_t, less that of the load step before.
    pub slip: f64,
    /// Where that is, in the undeformed body.
    pub(crate) slip_at: [f64; 2],
    /// The work of friction on the slip, int lambda_t u_t with the sign turned: what is lost to heat.
    pub dissipated: f64,
    /// The share of the shear force that may act at most which acts where the body does not touch; 0 but for Tresca's law.
    pub across_gaps: f64,
    /// The shear force that may act at most where the body does not touch, and all along.
    #[cfg_attr(feature = "files", serde(skip))]
    pub(crate) most: [f64; 2],
}

#[cfg(feature = "files")]
pub(crate) fn unknown() -> f64 {
    f64::NAN
}

#[cfg(feature = "files")]
fn unknown_place() -> [f64; 2] {
    [f64::NAN; 2]
}

/// a(u, u) = loads + supports + contact, each of the three being forces times the displacement u.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct EnergyBalance {
    /// a(u, u), twice the strain energy.
    pub strain: f64,
    /// L(u)
    pub loads: f64,
    /// The reactions times the prescribed displacements.
    pub supports: f64,
    /// int gamma sigma_n(u)^2 - int (1/gamma) \[P(u)\]+ P0(u), which tends to int lambda u_n.
    pub contact: f64,
    /// (strain - loads - supports - contact) / (the largest of their magnitudes): rounding, if the solution is one.
    pub imbalance: f64,
}

/// The balance of the field `u` with the residual `residual` at all degrees of freedom, and the energy a(u, u).
pub(crate) fn energy_balance(
    d: &Discretization,
    u: &[[f64; 2]],
    p: &[Vec<DoubleDouble>],
    residual: &[[f64; 2]],
    strain: f64,
) -> EnergyBalance {
    let loads = inner(&d.load, u);
    let mut supports = 0.0;
    for held in d.constraints.holders().values().flatten() {
        let ([a, b], [x, y]) = (held.part_of(residual[held.node]), u[held.node]);
        supports += a * x + b * y;
    }
    let mut contact = 0.0;
    for (piece, p) in d.contact.iter().zip(p) {
        contact += piece.squared_stress(u);
        let forces = piece.contribution(&d.rule, p).force;
        for (i, (force, p)) in forces.iter().zip(p).enumerate() {
            contact -= force * (p.head() + piece.gap_of(i));
        }
    }
    let largest = [strain, loads, supports, contact].map(f64::abs).into_iter().fold(0.0, f64::max);
    let difference = strain - loads - supports - contact;
    let imbalance = if largest > 0.0 { difference / largest } else { 0.0 };
    EnergyBalance { strain, loads, supports, contact, imbalance }
}

/// The largest principal strain, in magnitude, of the mean strain on a triangle, and the middle of that triangle.
pub(crate) fn largest_strain(d: &Discretization, u: &[[f64; 2]]) -> (f64, [f64; 2]) {
    let of = |t| {
        let g = d.space.mean_gradient(t, u);
        let hoop = d.space.mean_hoop_strain(t, d.problem.material.of(t), u).abs();
        let radius = ((g.m11 - g.m22) / 2.0).hypot((g.m12 + g.m21) / 2.0);
        (((g.m11 + g.m22) / 2.0).abs() + radius).max(hoop)
    };
    let mesh = d.space.mesh();
    let strains = (0..mesh.triangles().len()).map(|t| (of(t), t));
    let (strain, t) =
        strains.fold((0.0, 0), |most, found| if found.0 > most.0 { found } else { most });
    (strain, mesh.triangle(t).point([1.0 / 3.0; 3]).into())
}

/// The recovered pressure at the nodes of each piece, in the order of the piece's nodes.
pub(crate) fn recovered_pressure(d: &Discretization, p: &[Vec<DoubleDouble>]) -> Vec<Vec<f64>> {
    let groups = groups(d);
    let count = groups.iter().flatten().max().map_or(0, |last| last + 1);
    let (mut work, mut weight) = (vec![0.0; count], vec![0.0; count]);
    for ((edge, p), groups) in d.contact.iter().zip(p).zip(&groups) {
        let is_whole = edge.degree == Degree::One || edge.geometry.curved;
        let hats = if is_whole { Hats::Whole } else { Hats::Halves };
        let of_edge = hat_integrals(edge, p, &d.rule, hats);
        let of_one = hats.integrals(edge.radii);
        for (a, &group) in groups.iter().enumerate() {
            work[group] += edge.weight() * of_edge[a];
            weight[group] += edge.length * of_one[a];
        }
    }
    let mean = |group: usize| work[group] / weight[group];
    let on_edge = |groups: &Vec<usize>| -> Vec<f64> {
        let Some(&[start, end]) = groups.first_chunk() else { return Vec::new() };
        let middle = (mean(start) + mean(end)) / 2.0;
        let value = |&group: &usize| if weight[group] > 0.0 { mean(group) } else { middle };
        groups.iter().map(value).collect()
    };
    let mut recovered: Vec<Vec<f64>> = groups.iter().map(on_edge).collect();
    let all: Vec<(usize, &Piece)> = d.contact.iter().enumerate().collect();
    for pair in all.chunk_by(|(_, a), (_, b)| a.is_of_same_boundary(b)) {
        if pair[0].1.partner().is_some() {
            recover_between(d, p, pair, &mut recovered);
        }
    }
    recovered
}

/// The recovered pressure on the pieces of a pair of bodies, by the hats of whole edges of the body that has more of them: a
/// piece may be far shorter than any edge, and lambda^h jumps from one to the next.
fn recover_between(
    d: &Discretization,
    p: &[Vec<DoubleDouble>],
    pieces: &[(usize, &Piece)],
    recovered: &mut [Vec<f64>],
) {
    let mesh = d.space.mesh();
    let edges = |i: usize| {
        let of = |(_, piece): &(usize, &Piece)| {
            let edge = piece.geometry.stretches[i].edge;
            (edge.triangle, edge.local)
        };
        pieces.iter().map(of).collect::<BTreeSet<(usize, usize)>>().len()
    };
    let side = usize::from(edges(1) > edges(0));
    let mut sums: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for &(e, piece) in pieces {
        let stretch = &piece.geometry.stretches[side];
        let [start, end, _] = hat_integrals(piece, &p[e], &d.rule, Hats::Whole);
        let [first, last, _] = Hats::Whole.integrals(piece.radii);
        let [from, to] = [stretch.positions[0], stretch.positions[1]];
        let later = [from * start + to * end, from * first + to * last];
        let whole = [start + end, first + last];
        let earlier = [0, 1].map(|k| whole[k] - later[k]);
        for (vertex, [work, share]) in mesh.ends(stretch.edge).into_iter().zip([earlier, later]) {
            let sum = sums.entry(vertex).or_default();
            sum[0] += piece.weight() * work;
            sum[1] += piece.length * share;
        }
    }
    let mean = |vertex: usize| sums.get(&vertex).map_or(0.0, |[work, share]| work / share);
    for &(e, piece) in pieces {
        let stretch = &piece.geometry.stretches[side];
        let [start, end] = mesh.ends(stretch.edge).map(mean);
        recovered[e] = stretch.positions.iter().map(|s| (1.0 - s) * start + s * end).collect();
    }
}

/// The hat functions of an edge's nodes.
#[derive(Clone, Copy)]
enum Hats {
    /// A hat for each end.
    Whole,
    /// A hat for each end and for the middle.
    Halves,
}

impl Hats {
    /// Their values at `s`: start, end, middle.
    fn at(self, s: f64) -> [f64; 3] {
        match (self, s <= 0.5) {
            (Hats::Whole, _) => [1.0 - s, s, 0.0],
            (Hats::Halves, true) => [1.0 - 2.0 * s, 0.0, 2.0 * s],
            (Hats::Halves, false) => [0.0, 2.0 * s - 1.0, 2.0 - 2.0 * s],
        }
    }

    /// Their integrals over the edge, as shares of its length; with the weight r where it has these `radii` at the ends.
    fn integrals(self, radii: Option<[f64; 2]>) -> [f64; 3] {
        match (self, radii) {
            (Hats::Whole, None) => [0.5, 0.5, 0.0],
            (Hats::Halves, None) => [0.25, 0.25, 0.5],
            (Hats::Whole, Some([a, b])) => [(2.0 * a + b) / 6.0, (a + 2.0 * b) / 6.0, 0.0],
            (Hats::Halves, Some([a, b])) => {
                [(5.0 * a + b) / 24.0, (a + 5.0 * b) / 24.0, (a + b) / 4.0]
            }
        }
    }
}

/// int_0^1 \[P\]+ phi_a of the first component by the rule of the method, with the weight of the piece.
fn hat_integrals(piece: &Piece, fine: &[DoubleDouble], rule: &EdgeRule, hats: Hats) -> [f64; 3] {
    let mut sums = [0.0; 3];
    let (degree, fine) = (piece.degree, &fine[..piece.degree.nodes_per_edge()]);
    let response = piece.geometry.law.responses()[0];
    let p: Vec<f64> = fine.iter().map(|p| p.head()).collect();
    let mut add = |s: f64, weight: f64| {
        let value = match rule {
            EdgeRule::Exact => degree.value_at(&p, s),
            EdgeRule::Gauss(_) => degree.value_at(fine, s.into()).head(),
        };
        let value = response.q(value);
        let weight = piece.radii.map_or(weight, |radii| weight * radius(radii, s));
        let hats = hats.at(s);
        (0..3).for_each(|a| sums[a] += weight * value * hats[a]);
    };
    match rule {
        EdgeRule::Gauss(points) => points.iter().for_each(|&(s, weight)| add(s, weight)),
        EdgeRule::Exact => {
            let mut cuts = degree.roots(&p);
            cuts.extend([0.0, 0.5, 1.0]);
            cuts.sort_unstable_by(f64::total_cmp);
            for pair in cuts.windows(2) {
                let [low, high] = [pair[0], pair[1]];
                // Exact for the cubic that is left on each piece, with the weight r for one degree more.
                let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
                if piece.radii.is_some() {
                    let offset = 0.6_f64.sqrt() * half;
                    add(middle - offset, half * (5.0 / 9.0));
                    add(middle, half * (8.0 / 9.0));
                    add(middle + offset, half * (5.0 / 9.0));
                    continue;
                }
                let offset = half / 3.0_f64.sqrt();
                add(middle - offset, half);
                add(middle + offset, half);
            }
        }
    }
    sums
}

/// The numbers of the values at the nodes of each edge that faces an obstacle: neighbours on one boundary share that of their common
/// node unless the direction of contact jumps there.
fn groups(d: &Discretization) -> Vec<Vec<usize>> {
    let mut of_end: BTreeMap<(usize, &str), Vec<Group>> = BTreeMap::new();
    let mut count = 0;
    let mut groups = Vec::with_capacity(d.contact.len());
    for edge in &d.contact {
        if edge.partner().is_some() {
            groups.push(Vec::new());
            continue;
        }
        let nodes: Vec<usize> = d.space.edge_nodes(edge.edge()).collect();
        let group = |a: usize| {
            let known = of_end.entry((nodes[a], &**edge.boundary())).or_default();
            let direction = edge.geometry.nodes[a].direction;
            match known.iter().find(|(other, _)| same(*other, direction)) {
                Some(&(_, group)) => group,
                None => {
                    known.push((direction, count));
                    count += 1;
                    count - 1
                }
            }
        };
        groups.push((0..nodes.len()).map(group).collect());
    }
    groups
}

/// A direction of contact at a node, and the number of the value there.
type Group = (Vector2<f64>, usize);

/// Directions that differ by rounding only.
fn same(a: Vector2<f64>, b: Vector2<f64>) -> bool {
    length(a - b) <= NO_ANGLE
}

/// The quantities of each part of Gamma_C, in alphabetical order.
pub(crate) fn contact_boundaries(
    d: &Discretization,
    u: &[[f64; 2]],
    p: &[Vec<DoubleDouble>],
    recovered: &[Vec<f64>],
) -> Vec<ContactBoundary> {
    let mut all: Vec<ContactBoundary> = Vec::new();
    let mut end_of_last = None;
    for ((edge, p), recovered) in d.contact.iter().zip(p).zip(recovered) {
        let partner = edge.partner().map(|name| name.to_string());
        let is_same =
            |of: &ContactBoundary| of.boundary == **edge.boundary() && of.partner == partner;
        if !all.last().is_some_and(is_same) {
            end_of_last = None;
            all.push(ContactBoundary::empty(edge.boundary(), partner));
        }
        if let Some(boundary) = all.last_mut() {
            boundary.add(d, u, edge, p, recovered, &mut end_of_last);
        }
    }
    all
}

/// The name of a contact boundary, and that of a pair of boundaries.
pub(crate) fn label(boundary: &str, partner: Option<&str>) -> String {
    match partner {
        None => boundary.to_owned(),
        Some(partner) => format!("{boundary} on {partner}"),
    }
}

impl ContactBoundary {
    /// Its name, and that of the other body's boundary if there is one.
    pub(crate) fn label(&self) -> String {
        label(&self.boundary, self.partner.as_deref())
    }

    /// There are certificates of contact with a rigid obstacle without friction, if the body is not one of revolution.
    pub(crate) fn may_be_certified(&self) -> bool {
        self.partner.is_none() && self.friction.is_none()
    }

    pub(super) fn empty(boundary: &str, partner: Option<String>) -> Self {
        ContactBoundary {
            boundary: boundary.to_owned(),
            opening: partner.is_some().then_some(f64::NEG_INFINITY),
            partner,
            peak_pressure: f64::NEG_INFINITY,
            penetration: f64::NEG_INFINITY,
            ..ContactBoundary::default()
        }
    }

    /// Adds what friction does on an edge with nodes at these places.
    fn add_friction(
        &mut self,
        (edge, bound): (&Piece, Bound),
        contact: &Contribution,
        u: &[[f64; 2]],
        places: &[[f64; 2]],
    ) {
        let friction = self.friction.get_or_insert_default();
        let [sticks, slides] = contact.friction;
        friction.sticks += sticks;
        friction.slides += slides;
        let forces = edge.across(&contact.force);
        friction.shear += forces.iter().sum::<f64>().abs();
        let jumps = edge.jumps(u);
        let since = edge.across(&jumps).iter().zip(&edge.geometry.nodes);
        let slips = since.map(|(jump, node)| jump - node.slip);
        for ((slip, force), &place) in slips.zip(forces).zip(places) {
            friction.dissipated += force * slip;
            if slip.abs() > friction.slip {
                (friction.slip, friction.slip_at) = (slip.abs(), place);
            }
        }
        let bound = bound.mean(contact.resultant / edge.length);
        friction.most[1] += bound * edge.length;
        if matches!(edge.geometry.law, Law::Friction(Bound::Tresca(_))) {
            friction.most[0] += bound * (edge.length - contact.active).max(0.0);
        }
        let [open, all] = friction.most;
        friction.across_gaps = if all > 0.0 { open / all } else { 0.0 };
    }

    /// Adds a piece; `open` is the place up to which a stretch of contact has come.
    fn add(
        &mut self,
        d: &Discretization,
        u: &[[f64; 2]],
        edge: &Piece,
        p: &[DoubleDouble],
        recovered: &[f64],
        open: &mut Option<[f64; 2]>,
    ) {
        let nodes = &edge.geometry.nodes;
        let place = |a: usize| edge.geometry.first().place(d.space.mesh(), a);
        let places: Vec<[f64; 2]> = (0..nodes.len()).map(place).collect();
        let contact = edge.contribution(&d.rule, p);
        if let Law::Friction(bound) = edge.geometry.law {
            self.add_friction((edge, bound), &contact, u, &places);
        }
        for (i, size) in contact.force.iter().enumerate() {
            let [x, y] = places[i % nodes.len()];
            let force = edge.direction_of(i).map(|c| -size * c);
            self.force += if i < nodes.len() { *size } else { 0.0 };
            self.resultant = [self.resultant[0] + force[0], self.resultant[1] + force[1]];
            self.moment += x * force[1] - y * force[0];
        }
        let jumps = edge.jumps(u).into_iter().zip(nodes);
        let overlaps: Vec<f64> = jumps.map(|(jump, node)| jump - node.gap).collect();
        for (&recovered, &place) in recovered.iter().zip(&places) {
            if recovered > self.peak_pressure {
                (self.peak_pressure, self.peak_at) = (recovered, place);
            }
        }
        self.length += contact.active;
        let (start, end) = (places[0], places[1]);
        let place_at = |s: f64| [0, 1].map(|c| (1.0 - s) * start[c] + s * end[c]);
        for s in [0.0, 1.0].into_iter().chain(edge.degree.vertex(&overlaps)) {
            let depth = edge.degree.value_at(&overlaps, s);
            self.opening = self.opening.map(|opening| opening.max(-depth));
            if depth > self.penetration {
                (self.penetration, self.penetration_at) = (depth, place_at(s));
            }
        }
        let p: Vec<f64> = p[..nodes.len()].iter().map(|p| p.head()).collect();
        let mut cuts = edge.degree.roots(&p);
        cuts.extend([0.0, 1.0]);
        cuts.sort_unstable_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            if !(edge.degree.value_at(&p, (pair[0] + pair[1]) / 2.0) > 0.0) {
                continue;
            }
            let [from, to] = [place_at(pair[0]), place_at(pair[1])];
            match self.stretches.last_mut() {
                Some(last) if pair[0] == 0.0 && *open == Some(start) => last[1] = to,
                _ => self.stretches.push([from, to]),
            }
            *open = (pair[1] == 1.0).then_some(end);
        }
    }
}
