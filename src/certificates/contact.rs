//! An edge of Gamma_C with what the discrete solution says there, and the pressure of tau on it.
//!
//! Take lambda^h = -(1/gamma) \[P(u^h)\]+. A triangle whose contact edge holds the end of contact is cut there, so that
//! lambda^h is affine on the edges. For P2 it is quadratic, and the affine pressure with its force and its centroid would be
//! a tension at one end where the centroid is not in the middle third: then it acts on three times the way to the centroid
//! only, and the triangle is cut there ([`Profile`]). Where n~ turns along an edge, tau n is affine along it only if the
//! pressure is constant: then it acts on twice the way to the centroid, or on all of the edge where that is nearly all. Beside a quadratic v each half of an edge has a pressure of its own.
//! Whatever the moments of these pressures lack of those of lambda^h, the displacement that tau is built from is one under these
//! (`pressed`).
//!
//! On a pair an edge has several contacts, each with a part of an edge of the other body, and the pressure is one for both: where a
//! side is cut, in the middle of an edge or where contact ends, the other one is.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Vector2;

use super::certificate::{self, turned};
use super::field::Field;
use super::parts::is_curved;
use crate::contact::Law;
use crate::contact::piece::Stretch;
use crate::contact::{EdgeRule, Piece};
use crate::kernel::edge_integral::positive_interval;
use crate::model::law::Bound;
use crate::model::{BoundaryEdge, Degree, Mesh, Problem};

/// An edge of Gamma_C, or two parts of edges that face each other, with what the solution says there.
pub(super) struct Contact {
    pub(crate) edge: BoundaryEdge,
    pub(crate) boundary: Arc<str>,
    /// The parts of edges on which it lies: one, or those of two bodies.
    pub(crate) sides: Vec<Side>,
    /// The length over which pressures are integrated: the mean of those of the sides.
    pub(crate) length: f64,
    pub(crate) normal: Vector2<f64>,
    /// The direction of contact at both ends.
    pub(crate) directions: [Vector2<f64>; 2],
    /// g at both ends.
    pub(crate) gap: [f64; 2],
    /// Its value in the middle less their mean; 0 where it is known to be affine.
    pub(crate) gap_bulge: f64,
    /// The law; of the bound of friction the values at both ends.
    pub(crate) law: Law,
    /// The jump across the direction of contact that glue has: at both ends, and its bulge.
    pub(crate) offset: ([f64; 2], f64),
    /// Where the pressure is affine.
    pub(crate) parts: Vec<Part>,
}

/// A part of an edge.
#[derive(Clone, Copy)]
pub(super) struct Side {
    pub(crate) edge: BoundaryEdge,
    /// Where on the edge the contact begins and ends.
    pub(crate) places: [f64; 2],
    /// The length of the whole edge.
    pub(crate) length: f64,
    /// The part of the edge below which places are the same: one length on all edges of the contact.
    pub(crate) same: f64,
    /// An end of the contact was moved to an end or the middle of the edge, by more than rounding.
    pub(crate) moved: bool,
}

/// A part of a contact, in units of it, with the tractions at its ends: along the direction of contact and across, to the left.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(crate) ends: [f64; 2],
    pub(crate) pressure: [f64; 2],
    pub(crate) shear: [f64; 2],
}

/// Places on a pair that are nearer to the ends or the middle of an edge are these: between nodes that face each other to rounding, or
/// to what a mesh generator leaves, there would be slivers. A part of the longest edge there.
pub(super) const SAME_PLACE: f64 = 1e-6;

/// The most that this is of a shorter edge.
const MOST_OF_AN_EDGE: f64 = 1e-3;

/// The part of an edge below which a contact is a sliver.
const SLIVER: f64 = 0.1;

/// Places that differ by less are the same but for rounding, and so are directions.
const ROUNDING: f64 = 1e-11;

impl Side {
    fn new(mesh: &Mesh, stretch: &Stretch, longest: f64) -> Side {
        let (length, _) = mesh.length_and_normal(stretch.edge);
        let same = (SAME_PLACE * longest / length).min(MOST_OF_AN_EDGE);
        let places = [0, 1].map(|a| near_place(stretch.positions[a], same));
        let moved = (0..2).any(|a| (places[a] - stretch.positions[a]).abs() > ROUNDING);
        Side { edge: stretch.edge, places, length, same, moved }
    }

    /// The place on the edge of place `s` of the contact.
    pub(crate) fn place(&self, s: f64) -> f64 {
        let [from, to] = self.places;
        if s == 1.0 { to } else { near_place(from + s * (to - from), self.same) }
    }

    /// The middle on the edge of the part of the contact between these places: inside of it, however short it is.
    pub(crate) fn middle(&self, ends: [f64; 2]) -> f64 {
        let [s, t] = ends.map(|s| self.place(s));
        (s + t) / 2.0
    }

    /// The place in the contact of place `x` on the edge.
    pub(crate) fn within(&self, x: f64) -> f64 {
        let [from, to] = self.places;
        (x - from) / (to - from)
    }

    /// The weights of a quadratic's Bernstein coefficients on the edge in those along the contact.
    pub(crate) fn blossom(&self) -> [[f64; 3]; 3] {
        let [s, t] = self.places;
        [blossom(s, s), blossom(s, t), blossom(t, t)]
    }

    /// The contact has place `x` of the edge inside.
    pub(crate) fn has(&self, x: f64) -> bool {
        let s = self.within(x);
        0.0 < s && s < 1.0
    }
}

/// The sides of the contacts of these pieces. On an edge that faces edges of two lengths a place is the same as its end or its middle within
/// two lengths: of contacts that overlap there by less, the smaller length becomes the larger one, and they end at one place.
pub(super) fn sides(mesh: &Mesh, pieces: &[Piece]) -> Vec<Vec<Side>> {
    let stretches = |k: usize| pieces[k].geometry.stretches.iter();
    let length = |stretch: &Stretch| mesh.length_and_normal(stretch.edge).0;
    let of = |k: usize, longest: f64| -> Vec<Side> {
        stretches(k).map(|stretch| Side::new(mesh, stretch, longest)).collect()
    };
    let mut longest: Vec<f64> =
        (0..pieces.len()).map(|k| stretches(k).map(length).fold(0.0, f64::max)).collect();
    let mut sides: Vec<Vec<Side>> = longest.iter().enumerate().map(|(k, &l)| of(k, l)).collect();
    let mut on_edges: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    for (k, own) in sides.iter().enumerate() {
        for (i, side) in own.iter().enumerate() {
            on_edges.entry(mesh.number_of(side.edge)).or_default().push((k, i));
        }
    }
    loop {
        let mut changes = 0;
        for line in on_edges.values() {
            let all: Vec<(&Side, usize)> = line.iter().map(|&(k, i)| (&sides[k][i], k)).collect();
            let is_one_place = |[(a, k), (b, l)]: [(&Side, usize); 2], by: f64| {
                by > ROUNDING && by <= a.same.max(b.same) && longest[k] != longest[l]
            };
            let unlike: Vec<[usize; 2]> = overlaps(all)
                .filter(|&(two, by)| is_one_place(two, by))
                .map(|(two, _)| two.map(|(_, k)| k))
                .collect();
            changes += unlike.len();
            for [k, l] in unlike {
                let most = longest[k].max(longest[l]);
                for k in [k, l] {
                    longest[k] = most;
                    sides[k] = of(k, most);
                }
            }
        }
        if changes == 0 {
            return sides;
        }
    }
}

/// The neighbours among these sides of contacts on one edge, each with its contact, and by how much of the edge they overlap.
pub(super) fn overlaps(
    mut all: Vec<(&Side, usize)>,
) -> impl Iterator<Item = ([(&Side, usize); 2], f64)> {
    let range = |side: &Side| {
        let [s, t] = side.places;
        [s.min(t), s.max(t)]
    };
    all.sort_by(|(a, _), (b, _)| range(a)[0].total_cmp(&range(b)[0]));
    (1..all.len()).map(move |k| {
        let two = [all[k - 1], all[k]];
        let [[_, before], [start, end]] = two.map(|(side, _)| range(side));
        (two, before.min(end) - start)
    })
}

/// The weights of a quadratic's Bernstein coefficients in its blossom: each argument takes one step of de Casteljau's.
pub(super) fn blossom(s: f64, t: f64) -> [f64; 3] {
    [(1.0 - s) * (1.0 - t), (1.0 - s) * t + s * (1.0 - t), s * t]
}

fn near_place(x: f64, same: f64) -> f64 {
    [0.0, 0.5, 1.0].into_iter().find(|place| (x - place).abs() <= same).unwrap_or(x)
}

/// tau_n along an edge of Gamma_C: affine, or with a jump at a place between the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Profile {
    /// The place.
    pub(crate) cut: Option<f64>,
    /// Before and after it, each at both ends.
    pub(crate) values: [[f64; 2]; 2],
}

impl Profile {
    /// On the part of a contact between these ends.
    fn parts(&self, [from, to]: [f64; 2]) -> Vec<Part> {
        let [first, second] = self.values;
        let part = |ends, pressure| Part { ends, pressure, shear: [0.0; 2] };
        let Some(at) = self.cut else { return vec![part([from, to], first)] };
        let at = from + (to - from) * at;
        vec![part([from, at], first), part([at, to], second)]
    }

    fn whole(pressure: [f64; 2]) -> Profile {
        Profile { cut: None, values: [pressure; 2] }
    }

    /// lambda^h = -\[P\]+/gamma itself, for P with the values `p` at the ends.
    fn of_affine(p: [f64; 2], gamma: f64) -> Profile {
        let pressure = p.map(|p| -(p.max(0.0) / gamma));
        let [start, end] = positive_interval(p);
        let at = if p[0] > 0.0 { end } else { start };
        let changes = (p[0] > 0.0) != (p[1] > 0.0);
        let inside = NEAR_THE_END < at && at < 1.0 - NEAR_THE_END;
        if changes && inside {
            Profile { cut: Some(at), values: [[pressure[0], 0.0], [0.0, pressure[1]]] }
        } else {
            Profile::whole(pressure)
        }
    }

    /// The pressure with the moments `m` of a lambda^h that is not affine; `starts` tells whether P is positive at the start,
    /// `end` is the place where it changes its sign, if there is one only. Affine up to the end of contact, if the centroid
    /// is in the middle third of that; else up to three times the way to the centroid. If it is to be `constant`, up to twice
    /// that way; or, where that is all of the edge, with another value on each half.
    fn of_moments(m: [f64; 2], starts: bool, end: Option<f64>, constant: bool) -> Profile {
        let force = m[0] + m[1];
        if !(force < 0.0) {
            return Profile::whole([0.0; 2]);
        }
        // Seen from where contact is, or where most of it is.
        let turned = if end.is_some() { !starts } else { m[1] < m[0] };
        let centroid = if turned { m[0] } else { m[1] } / force;
        let end = end.map_or(1.0, |end| if turned { 1.0 - end } else { end });
        let farthest = centroid * if constant { 2.0 } else { 3.0 };
        let reach = match end.min(farthest) {
            x if x <= 1.0 - LEAST_PART => x.max(LEAST_PART),
            // Three halves of the way would be enough.
            _ if farthest < 1.0 && !constant => 1.0 - LEAST_PART,
            _ => 1.0,
        };
        let mean = force / reach;
        if constant && reach == 1.0 {
            // The centroid of the halves' forces is that of all.
            let place = if turned { 1.0 - centroid } else { centroid }.clamp(0.25, 0.75);
            let [p, q] = [mean * (3.0 - 4.0 * place), mean * (4.0 * place - 1.0)];
            return Profile { cut: Some(0.5), values: [[p; 2], [q; 2]] };
        }
        let ends = if constant {
            [mean; 2]
        } else {
            let place = (centroid / reach).clamp(1.0 / 3.0, 2.0 / 3.0);
            [mean * (4.0 - 6.0 * place), mean * (6.0 * place - 2.0)].map(|p| p.min(0.0))
        };
        let ends = if turned { [ends[1], ends[0]] } else { ends };
        match (reach < 1.0, turned) {
            (false, _) => Profile::whole(ends),
            (true, false) => Profile { cut: Some(reach), values: [ends, [0.0; 2]] },
            (true, true) => Profile { cut: Some(1.0 - reach), values: [[0.0; 2], ends] },
        }
    }
}

impl Part {
    fn tractions(&self) -> [[f64; 2]; 2] {
        [self.pressure, self.shear]
    }
}

/// The function with these values at the nodes of an edge, at place `s` of it.
fn value(degree: Degree, nodal: &[f64], s: f64) -> f64 {
    degree.edge_values(s).iter().zip(nodal).map(|(n, p)| n * p).sum()
}

/// The direction of contact at both ends of a piece.
fn directions(piece: &Piece) -> [Vector2<f64>; 2] {
    let geometry = &piece.geometry;
    let mut directions = [0, 1].map(|a| geometry.nodes[a].direction);
    // Of straight sides they differ by rounding.
    if geometry.stretches.len() > 1 && (directions[1] - directions[0]).amax() <= ROUNDING {
        directions = [directions[0]; 2];
    }
    // What a direction is off an axis is rounding; beside one that is exact, v may be prescribed across.
    if geometry.law == Law::Sliding {
        let exact = |x: f64| [0.0, x.signum()].into_iter().find(|y| (x - y).abs() <= ROUNDING);
        directions = directions.map(|d| d.map(|x| exact(x).unwrap_or(x)));
    }
    directions
}

/// The tractions on a part of a contact between tied bodies: of `value`, which is quadratic along it, the affine function with its force
/// and moment.
fn tied([s, t]: [f64; 2], value: impl Fn(f64) -> Vector2<f64>) -> Part {
    let [start, middle, end] = [s, (s + t) / 2.0, t].map(value);
    let beyond = (middle - (start + end) / 2.0) * (2.0 / 3.0);
    let [p, q] = [start + beyond, end + beyond];
    Part { ends: [s, t], pressure: [p.x, q.x], shear: [p.y, q.y] }
}

/// As [`tied`], where the direction turns: constant on each half, with the same force and moment.
fn halves([s, t]: [f64; 2], value: impl Fn(f64) -> Vector2<f64>) -> Vec<Part> {
    let middle = (s + t) / 2.0;
    let [p, q, r] = [s, middle, t].map(|s| value(s).x);
    let part = |ends, pressure| Part { ends, pressure: [pressure; 2], shear: [0.0; 2] };
    vec![
        part([s, middle], (3.0 * p + 4.0 * q - r) / 6.0),
        part([middle, t], (3.0 * r + 4.0 * q - p) / 6.0),
    ]
}

impl Contact {
    /// `halved` tells whether each half of an edge has a pressure of its own.
    pub(crate) fn new(
        problem: &Problem,
        (piece, sides): (&Piece, Vec<Side>),
        u: &[[f64; 2]],
        halved: bool,
    ) -> Contact {
        let geometry = &piece.geometry;
        let directions = directions(piece);
        let gap = [0, 1].map(|a| geometry.nodes[a].gap);
        let curved =
            sides.len() > 1 || problem.conditions.get(&**piece.boundary()).is_some_and(is_curved);
        let gap_bulge = match geometry.nodes.get(2) {
            // The direction in the middle is the mean of those at the ends, a little shorter than 1.
            Some(middle) if directions[0] != directions[1] || curved => {
                let mean = (directions[0] + directions[1]) / 2.0;
                middle.gap * mean.dot(&middle.direction) - (gap[0] + gap[1]) / 2.0
            }
            _ => geometry.bulge,
        };
        let mut contact = Contact {
            edge: piece.edge(),
            boundary: Arc::clone(piece.boundary()),
            sides,
            length: piece.length,
            normal: piece.normal(),
            directions,
            gap,
            gap_bulge,
            law: geometry.law,
            offset: ([0.0; 2], 0.0),
            parts: Vec::new(),
        };
        let (degree, both) = (piece.degree, piece.p(u));
        let (p, across) = both.split_at(geometry.nodes.len());
        contact.parts = contact.parts_of(piece, (p, across), halved);
        if contact.is_pair() {
            contact.join_slivers();
        }
        if geometry.law == Law::Bonded {
            contact.glue(piece);
        }
        if let Law::Friction(Bound::Tresca(_)) = geometry.law {
            contact.drag(|s| -value(degree, across, s) / piece.gamma);
        }
        contact
    }

    /// The parts with what P, with the nodal values `p` along the direction of contact and `across`, says of the tractions there.
    fn parts_of(&self, piece: &Piece, (p, across): (&[f64], &[f64]), halved: bool) -> Vec<Part> {
        let (geometry, degree, turns) = (&piece.geometry, piece.degree, self.turns());
        let mut breaks = vec![0.0, 1.0];
        if halved {
            let sides = self.sides.iter().filter(|side| side.has(0.5));
            breaks.extend(sides.map(|side| side.within(0.5)));
            breaks.sort_by(f64::total_cmp);
            breaks.dedup_by(|a, b| *a - *b <= SAME_PLACE);
        }
        let parts = breaks.windows(2).map(|ends| [ends[0], ends[1]]);
        // Where P has these values at the nodes.
        let profile = |p: &[f64]| match p {
            &[start, end] if !turns => Profile::of_affine([start, end], piece.gamma),
            _ => {
                let end = match degree.roots(p)[..] {
                    [root] => Some(root),
                    _ => None,
                };
                let moments = with_hats(degree, p).map(|p| -(p / piece.gamma));
                Profile::of_moments(moments, p[0] > 0.0, end, turns)
            }
        };
        let between = |[from, to]: [f64; 2]| {
            let at = |s: f64| value(degree, p, from + s * (to - from));
            profile(&degree.edge_positions().map(at).collect::<Vec<f64>>())
        };
        let traction = |s: f64| -> Vector2<f64> {
            let shapes = degree.edge_values(s);
            let along = shapes.iter().zip(geometry.directions()).map(|(n, d)| d * *n).sum();
            let lambda = -value(degree, p, s) / piece.gamma;
            if across.is_empty() {
                return Vector2::new(lambda, 0.0);
            }
            along * lambda - turned::<f64>(along) * (value(degree, across, s) / piece.gamma)
        };
        match geometry.law {
            Law::Contact | Law::Friction(_) => {
                parts.flat_map(|ends| between(ends).parts(ends)).collect()
            }
            Law::Sliding if turns => parts.flat_map(|ends| halves(ends, traction)).collect(),
            Law::Sliding | Law::Bonded => parts.map(|ends| tied(ends, traction)).collect(),
        }
    }

    /// Turns into the frame of glue, x and y: its gap is a vector.
    fn glue(&mut self, piece: &Piece) {
        let nodes = &piece.geometry.nodes;
        // What the smooth boundaries of one circle are apart is rounding, and so is what a direction is off an axis.
        let gap = |a: usize| {
            let least = ROUNDING * piece.length;
            (nodes[a].direction * nodes[a].gap).map(|g| if g.abs() <= least { 0.0 } else { g })
        };
        let mean = (gap(0) + gap(1)) / 2.0;
        let bulge = match nodes.get(2) {
            Some(_) if gap(2) == mean => Vector2::zeros(),
            Some(_) => gap(2) - mean,
            None => nodes[0].direction * piece.geometry.bulge,
        };
        self.directions = [Vector2::x(); 2];
        self.gap = [gap(0).x, gap(1).x];
        self.offset = ([gap(0).y, gap(1).y], bulge.y);
        self.gap_bulge = bulge.x;
    }

    /// Gives tied bodies the jump at the start that the contact `before` has at its end, and the direction of that, where this is the same
    /// place: of two nodes that nearly face each other, each has its own, and those of straight sides differ by rounding.
    pub(crate) fn join(&mut self, mesh: &Mesh, before: &Contact) {
        let place = |side: &Side, k: usize| {
            let [a, b] = mesh.ends(side.edge).map(|vertex| Vector2::from(mesh.vertices()[vertex]));
            a + (b - a) * side.places[k]
        };
        let (own, last) = (self.sides[0], before.sides[0]);
        let apart = (place(&own, 0) - place(&last, 1)).amax();
        if self.is_tied() && self.law == before.law && apart <= own.same * own.length {
            let d = before.directions[1];
            // At a corner they are two; on an edge a direction turns by less than a right angle.
            if (self.directions[0] - d).amax() > 2.0 * SAME_PLACE {
                return;
            }
            if !self.turns() && (self.directions[1] - d).amax() <= ROUNDING {
                self.directions[1] = d;
            }
            self.directions[0] = d;
            self.gap[0] = before.gap[1];
            self.offset.0[0] = before.offset.0[1];
        }
    }

    /// Gives the parts the tractions of friction, those of `sticking` up to the bound.
    fn drag(&mut self, sticking: impl Fn(f64) -> f64) {
        let (turns, mut parts) = (self.turns(), std::mem::take(&mut self.parts));
        for part in &mut parts {
            let [s, t] = part.ends;
            let bound = [s, t].map(|s| self.bound_at(s));
            let at = |s: f64| sticking(s).clamp(-self.bound_at(s), self.bound_at(s));
            let [start, middle, end] = [at(s), at((s + t) / 2.0), at(t)];
            let beyond = (middle - (start + end) / 2.0) * (2.0 / 3.0);
            part.shear = if turns {
                [(start + end) / 2.0 + beyond; 2]
                    .map(|q| q.clamp(-bound[0], bound[0]).clamp(-bound[1], bound[1]))
            } else {
                [(start, bound[0]), (end, bound[1])].map(|(q, s)| (q + beyond).clamp(-s, s))
            };
        }
        self.parts = parts;
    }

    /// The bound of friction at place `s` of the contact.
    fn bound_at(&self, s: f64) -> f64 {
        match self.law {
            Law::Friction(Bound::Tresca([p, q])) => ((1.0 - s) * p + s * q).max(0.0),
            _ => 0.0,
        }
    }

    /// The length of part `j`.
    fn length_of(&self, j: usize) -> f64 {
        let [s, t] = self.parts[j].ends;
        self.length * (t - s)
    }

    /// Returns whether only a small part of one of the two edges faces the other.
    pub(crate) fn is_sliver(&self) -> bool {
        self.sides.iter().any(|side| (side.places[1] - side.places[0]).abs() < SLIVER)
    }

    /// Returns whether the contact is pressed from end to end.
    pub(crate) fn is_pressed(&self) -> bool {
        self.parts.iter().all(|part| part.pressure.iter().all(|&p| p < 0.0))
    }

    /// The least pressure, and by how much friction could bear more where it is least.
    pub(crate) fn least_tractions(&self) -> [f64; 2] {
        let ends = || self.parts.iter().flat_map(|part| [0, 1].map(|k| (part, k)));
        let pressure = ends().map(|(part, k)| -part.pressure[k]).fold(f64::INFINITY, f64::min);
        let margin = ends().map(|(part, k)| self.bound_at(part.ends[k]) - part.shear[k].abs());
        [pressure, margin.fold(f64::INFINITY, f64::min)]
    }

    /// Tractions act across the direction of contact up to a bound.
    pub(crate) fn has_friction(&self) -> bool {
        matches!(self.law, Law::Friction(_))
    }

    /// Two bodies that may not open.
    pub(crate) fn is_tied(&self) -> bool {
        matches!(self.law, Law::Sliding | Law::Bonded)
    }

    /// The law on the part of the contact between two places of it, without tractions across; the bulge of the offset beside it.
    pub(crate) fn law_between(&self, [s, t]: [f64; 2]) -> certificate::Law {
        let ([p, q], bulge) = self.offset;
        let offset = [s, t].map(|s| (1.0 - s) * p + s * q + 4.0 * s * (1.0 - s) * bulge);
        let shear = [0.0; 2];
        match self.law {
            Law::Contact => certificate::Law::Contact,
            Law::Sliding => certificate::Law::Sliding,
            Law::Bonded => certificate::Law::Bonded { shear, offset },
            Law::Friction(_) => {
                certificate::Law::Friction { shear, bound: [s, t].map(|s| self.bound_at(s)) }
            }
        }
    }

    /// On each side it is longer than what is taken for one place.
    pub(crate) fn has_length(&self) -> bool {
        self.sides.iter().all(|side| (side.places[1] - side.places[0]).abs() > side.same)
    }

    /// Takes over what another contact, which is left out, has of the same edges: one that is behind this one (`end` is 1) or before it
    /// (0).
    pub(crate) fn take_over(&mut self, other: &mut Contact, end: usize) {
        for (own, side) in self.sides.iter_mut().zip(&mut other.sides) {
            let by = (side.places[end] - own.places[end]).abs();
            // Both ends of what is left out are as near as that.
            if own.edge == side.edge && by <= 2.0 * own.same.max(side.same) {
                let middle = own.within(0.5);
                own.moved |= by > ROUNDING;
                own.places[end] = side.places[end];
                side.places[1 - end] = side.places[end];
                // Parts that meet in the middle of the edge still do.
                let ends = self.parts.iter_mut().flat_map(|part| &mut part.ends);
                ends.filter(|s| **s == middle).for_each(|s| *s = own.within(0.5));
            }
        }
    }

    /// Gives what parts have that are no longer than one place on one of the edges to their neighbours.
    fn join_slivers(&mut self) {
        let sides = &self.sides;
        let is_sliver = |[s, t]: [f64; 2]| {
            sides.iter().any(|side| (side.place(t) - side.place(s)).abs() <= side.same)
        };
        let mut joined: Vec<Part> = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            match joined.last_mut() {
                Some(last) if is_sliver(part.ends) => last.ends[1] = part.ends[1],
                Some(last) if is_sliver(last.ends) => {
                    *last = Part { ends: [last.ends[0], part.ends[1]], ..*part };
                }
                _ => joined.push(*part),
            }
        }
        self.parts = joined;
    }

    /// Returns whether contact is between two bodies.
    pub(crate) fn is_pair(&self) -> bool {
        self.sides.len() > 1
    }

    /// 1 for the first body, -1 for the second.
    pub(crate) fn sign(side: usize) -> f64 {
        if side == 0 { 1.0 } else { -1.0 }
    }

    /// The tractions along the direction of contact and across at both ends of the part of an edge of side `i` between two places, per
    /// length of the edge of the first side.
    pub(crate) fn tractions_between(&self, i: usize, places: [f64; 2]) -> [[f64; 2]; 2] {
        let side = &self.sides[i];
        let middle = side.within((places[0] + places[1]) / 2.0);
        let inside = |part: &&Part| part.ends[0] < middle && middle < part.ends[1];
        let Some(&Part { ends, pressure, shear }) = self.parts.iter().find(inside) else {
            return [[0.0; 2]; 2];
        };
        let [from, to] = ends.map(|s| side.place(s));
        let [start, end] = self.sides[0].places;
        let ratio =
            if self.is_pair() { self.length / (self.sides[0].length * (end - start)) } else { 1.0 };
        [pressure, shear].map(|[p, q]| {
            places.map(|x| {
                let s = (x - from) / (to - from);
                // The ends of a part are known to rounding.
                let p = if s.abs() <= SAME_PLACE {
                    p
                } else if (s - 1.0).abs() <= SAME_PLACE || p == q {
                    q
                } else {
                    p + s * (q - p)
                };
                p * ratio
            })
        })
    }

    /// int (p d + q e) phi, with the sign of the side, over the part of its edge between `from` and `to` for these functions phi of degree 2
    /// or less, of the place on the edge from 0 to 1: Simpson's rule is exact.
    fn moments<const N: usize>(
        &self,
        i: usize,
        [from, to]: [f64; 2],
        phi: impl Fn(f64) -> [f64; N],
        tractions: fn(&Part) -> [[f64; 2]; 2],
    ) -> [Vector2<f64>; N] {
        let (mut moments, side) = ([Vector2::zeros(); N], &self.sides[i]);
        let [d, e] = self.directions;
        for part in &self.parts {
            let ([s, t], [pressure, shear]) = (part.ends, tractions(part));
            let middle = side.middle(part.ends);
            if !(from < middle && middle < to) {
                continue;
            }
            let [q, r] = [(s, 0), (t, 1)].map(|(s, k)| {
                let d = d * (1.0 - s) + e * s;
                d * pressure[k] + turned(d) * shear[k]
            });
            let weight = Contact::sign(i) * self.length * (t - s) / 6.0;
            for (x, q, times) in [(s, q, 1.0), ((s + t) / 2.0, (q + r) / 2.0, 4.0), (t, r, 1.0)] {
                let phi = phi(side.place(x));
                (0..N).for_each(|k| moments[k] += q * (phi[k] * times * weight));
            }
        }
        moments
    }

    /// int (p d + q e) phi for the hat functions of the ends of a side's edge, and for 4 s (1 - s).
    pub(crate) fn on_edge(&self, i: usize) -> [Vector2<f64>; 3] {
        self.moments(i, [0.0, 1.0], |s| [1.0 - s, s, 4.0 * s * (1.0 - s)], Part::tractions)
    }

    /// int (p d + q e) phi over the part of a side's edge between two places for the hat functions of its ends.
    pub(crate) fn on_part(&self, i: usize, [from, to]: [f64; 2]) -> [Vector2<f64>; 2] {
        let hats = |s: f64| [(to - s) / (to - from), (s - from) / (to - from)];
        self.moments(i, [from, to], hats, Part::tractions)
    }

    /// The force int p, which is not positive; where bodies slide along a direction that turns, of the pressure 1, and none where tied
    /// bodies have the force and the moment of the discrete solution.
    pub(crate) fn force(&self) -> f64 {
        if self.is_tied() {
            return if self.turns() { -self.length } else { 0.0 };
        }
        let force = |part: &Part| {
            let ([s, t], [p, q]) = (part.ends, part.pressure);
            self.length * (t - s) * (p + q) / 2.0
        };
        self.parts.iter().map(force).sum()
    }

    /// int p d . r, p as in [`Contact::force`], and int (p d + q e) . r over side `i` for a motion that is affine along its edge.
    pub(crate) fn against(&self, i: usize, ends: [Vector2<f64>; 2]) -> [f64; 2] {
        let hats = |s: f64| [1.0 - s, s];
        let of_force: fn(&Part) -> [[f64; 2]; 2] = match self.is_tied() {
            true => |_| [[-1.0; 2], [0.0; 2]],
            false => |part| [part.pressure, [0.0; 2]],
        };
        [of_force, Part::tractions].map(|tractions| {
            let [a, b] = self.moments(i, [0.0, 1.0], hats, tractions);
            a.dot(&ends[0]) + b.dot(&ends[1])
        })
    }

    /// Gives the contact more of what [`Contact::force`] is of, `times` as much: where it may open by `most` of it or less.
    pub(crate) fn add(&mut self, times: f64, most: f64) {
        let tied = self.is_tied();
        for p in self.parts.iter_mut().flat_map(|part| &mut part.pressure) {
            *p = if tied { *p - times } else { *p * (1.0 + times.clamp(-most, most)) };
        }
    }

    /// The Bernstein coefficients along the contact of a field on side `i`.
    pub(crate) fn along_side(&self, mesh: &Mesh, i: usize, field: &Field) -> [Vector2<f64>; 3] {
        let side = &self.sides[i];
        let [a, b] = mesh.ends(side.edge).map(|vertex| Vector2::from(field.vertices[vertex]));
        let number = mesh.number_of(side.edge);
        let bulge = field.bulges.as_ref().map_or(Vector2::zeros(), |all| all[number].into());
        let middle = (a + b) / 2.0 + bulge * 2.0;
        side.blossom().map(|[p, q, r]| a * p + middle * q + b * r)
    }

    /// The coefficients of a field along the contact, on a pair less those on the other body.
    pub(crate) fn jump(&self, mesh: &Mesh, field: &Field) -> [Vector2<f64>; 3] {
        let sides = (0..self.sides.len())
            .map(|i| self.along_side(mesh, i, field).map(|value| value * Contact::sign(i)));
        sides.fold([Vector2::zeros(); 3], |[a, b, c], [d, e, f]| [a + d, b + e, c + f])
    }

    /// The directions, if they are not the normal.
    pub(crate) fn along(&self) -> Option<[[f64; 2]; 2]> {
        (self.is_pair() || self.directions != [self.normal; 2])
            .then(|| self.directions.map(<[f64; 2]>::from))
    }

    /// Tells whether the direction of contact turns along it.
    pub(crate) fn turns(&self) -> bool {
        self.directions[0] != self.directions[1]
    }
}

/// Makes the tractions of pairs continuous where contacts meet inside of an edge: with a jump there, the narrow triangles beside the cut
/// have many times as much stress. The shorter of the two parts keeps more of what it has, since it can bear less of a slope; on slivers
/// between them tractions are constant.
pub(super) fn even_out(contacts: &mut [Contact]) {
    let mut order = places_of_parts(contacts);
    let mut first = 0;
    while first + 1 < order.len() {
        let mut last = first + 1;
        while last + 1 < order.len() && contacts[order[last].0].is_sliver() {
            last += 1;
        }
        let run = &order[first..=last];
        first = last;
        if !run.windows(2).all(|two| meet(&contacts[two[0].0], &contacts[two[1].0])) {
            continue;
        }
        if fall_off(contacts, run) {
            // Of the parts behind the run there are as many as before.
            let left = order.len() - first;
            order = places_of_parts(contacts);
            first = order.len() - left;
            continue;
        }
        let at = |(k, j): (usize, usize), end: usize| {
            let part = &contacts[k].parts[j];
            (contacts[k].length_of(j), [part.pressure[end], part.shear[end]])
        };
        let ((before, p), (after, q)) = (at(run[0], 1), at(run[run.len() - 1], 0));
        if (p[0] == 0.0 || q[0] == 0.0) && !contacts[run[0].0].is_tied() {
            continue;
        }
        let [pressure, shear] = [0, 1].map(|c| (p[c] * after + q[c] * before) / (before + after));
        // But for the outer ends of the run.
        let ends = run.iter().flat_map(|&at| [(at, 0), (at, 1)]);
        for ((k, j), end) in ends.skip(1).take(2 * run.len() - 2) {
            let bound = match contacts[k].is_tied() {
                true => f64::INFINITY,
                false => contacts[k].bound_at(contacts[k].parts[j].ends[end]),
            };
            let part = &mut contacts[k].parts[j];
            (part.pressure[end], part.shear[end]) = (pressure, shear.clamp(-bound, bound));
        }
    }
}

/// The contacts and their parts, in turn.
fn places_of_parts(contacts: &[Contact]) -> Vec<(usize, usize)> {
    let parts = |(k, contact): (usize, &Contact)| (0..contact.parts.len()).map(move |j| (k, j));
    contacts.iter().enumerate().flat_map(parts).collect()
}

/// Where contact ends on the last part of a run or before it, or on the first one or behind it, makes the pressure of all of them one affine
/// function, with their force and with the pressure at the other end: it falls off on a part that is not much shorter than its neighbour.
/// On a narrow triangle a pressure that varies by p costs p^2 times the height over the width. Returns whether it did so.
fn fall_off(contacts: &mut [Contact], run: &[(usize, usize)]) -> bool {
    let pressure = |(k, j): (usize, usize)| contacts[k].parts.get(j).map(|part| part.pressure);
    let is_open = |at: (usize, usize)| pressure(at) == Some([0.0; 2]);
    // The part without pressure that contact may reach into: behind one that is pressed, or as it is.
    let open = |at: (usize, usize), next: Option<usize>| match next.map(|j| (at.0, j)) {
        _ if is_open(at) => Some(None),
        Some(next) if is_open(next) => Some(Some(next.1)),
        _ => None,
    };
    let (first, last) = (run[0], run[run.len() - 1]);
    let mut order = run.to_vec();
    let (next, outer, inner) =
        match (open(first, first.1.checked_sub(1)), open(last, last.1.checked_add(1))) {
            (None, Some(next)) => (next, 0, 1),
            (Some(next), None) => (next, 1, 0),
            _ => return false,
        };
    if outer == 1 {
        order.reverse();
    }
    let lengths: Vec<f64> = order.iter().map(|&at| contacts[at.0].length_of(at.1)).collect();
    let part = |(k, j): (usize, usize)| &contacts[k].parts[j];
    let forces = order.iter().zip(&lengths).map(|(&at, length)| {
        let [p, q] = part(at).pressure;
        length * (p + q) / 2.0
    });
    let most = part(order[0]).pressure[outer];
    let reach = 2.0 * forces.sum::<f64>() / most;
    let (k, j) = order[order.len() - 1];
    let before: f64 = lengths[..order.len() - 1].iter().sum();
    let room = lengths[order.len() - 1] + next.map_or(0.0, |next| contacts[k].length_of(next));
    let tail = (reach - before).min((1.0 - LEAST_PART) * room);
    if contacts[k].law != Law::Contact || !(tail >= LEAST_PART * room) {
        return false;
    }
    let mut left = before + tail;
    let at = |left: f64| most * left / (before + tail);
    for (&(k, j), length) in order.iter().zip(lengths).take(order.len() - 1) {
        let pressure = &mut contacts[k].parts[j].pressure;
        pressure[outer] = at(left);
        left -= length;
        pressure[inner] = at(left);
    }
    let whole = contacts[k].length;
    let parts = &mut contacts[k].parts;
    let start = parts[j].ends[outer];
    let end = if outer == 0 { start + tail / whole } else { start - tail / whole };
    match next {
        Some(next) => parts[next].ends[outer] = end,
        // The rest of the part stays open.
        None => {
            let mut rest = parts[j];
            rest.ends[outer] = end;
            parts.insert(if outer == 0 { j + 1 } else { j }, rest);
        }
    }
    let own = &mut parts[if next.is_none() && outer == 1 { j + 1 } else { j }];
    own.ends[inner] = end;
    (own.pressure[outer], own.pressure[inner]) = (at(tail), 0.0);
    true
}

/// Returns whether a contact ends inside of an edge where the other begins, and tractions may be affine on both.
fn meet(one: &Contact, other: &Contact) -> bool {
    let inside = |(a, b): (&Side, &Side)| {
        a.edge == b.edge && (a.places[1] - b.places[0]).abs() <= a.same.max(b.same)
    };
    let same = std::ptr::eq(one, other) || one.sides.iter().zip(&other.sides).any(inside);
    one.is_pair() && other.is_pair() && same && !one.turns() && !other.turns()
}

/// int \[P\]+ phi for the hat functions of the ends of an edge, in units of its length.
fn with_hats(degree: Degree, p: &[f64]) -> [f64; 2] {
    let nodal = EdgeRule::Exact.integrals(degree, None, p).gradient;
    // A hat function is N_a and half of that of the middle.
    let middle = nodal.get(2).copied().unwrap_or_default();
    [0, 1].map(|a| nodal[a] + middle / 2.0)
}

/// Contact that ends this near an end of its edge, in units of the edge, leaves it whole: the triangles would be slivers.
const NEAR_THE_END: f64 = 1e-3;

/// The least part of an edge that is cut off where lambda^h is not affine: a sliver bounds badly.
const LEAST_PART: f64 = 0.15;

#[cfg(test)]
mod tests {
    use super::*;

    /// Contact on an edge with the places from 0 to 1, where 1e-3 is one place.
    fn contact(parts: Vec<Part>) -> Contact {
        let edge = BoundaryEdge { triangle: 0, local: 0 };
        Contact {
            edge,
            boundary: "short".into(),
            // Beside an edge that is a thousand times as long.
            sides: vec![Side { edge, places: [0.0, 1.0], length: 1.0, same: 1e-3, moved: false }],
            length: 1.0,
            normal: Vector2::y(),
            directions: [Vector2::y(); 2],
            gap: [0.0; 2],
            gap_bulge: 0.0,
            law: Law::Contact,
            offset: ([0.0; 2], 0.0),
            parts,
        }
    }

    fn part(ends: [f64; 2], pressure: [f64; 2]) -> Part {
        Part { ends, pressure, shear: [0.0; 2] }
    }

    #[test]
    fn a_part_that_is_no_longer_than_one_place_has_what_its_neighbour_has() {
        let joined = |ends: [f64; 4]| {
            let pressures = [[-1.0, -2.0], [-3.0, -4.0], [-5.0, -6.0]];
            let of = |k: usize| part([ends[k], ends[k + 1]], pressures[k]);
            let mut contact = contact((0..3).map(of).collect());
            contact.join_slivers();
            contact.parts.iter().map(|part| (part.ends, part.pressure)).collect::<Vec<_>>()
        };
        let (first, last) = ([-1.0, -2.0], [-5.0, -6.0]);
        // The first one, one between, the last one.
        let found = joined([0.0, 1e-4, 0.5, 1.0]);
        assert_eq!(found, [([0.0, 0.5], [-3.0, -4.0]), ([0.5, 1.0], last)]);
        let found = joined([0.0, 0.5, 0.5001, 1.0]);
        assert_eq!(found, [([0.0, 0.5001], first), ([0.5001, 1.0], last)]);
        let found = joined([0.0, 0.5, 0.9999, 1.0]);
        assert_eq!(found, [([0.0, 0.5], first), ([0.5, 1.0], [-3.0, -4.0])]);
        // Control: parts that are longer.
        assert_eq!(joined([0.0, 0.3, 0.302, 1.0]).len(), 3);
    }

    #[test]
    fn a_pressure_that_ends_near_the_middle_of_an_edge_ends_there_and_pulls_nowhere() {
        let contact =
            |at: f64| contact(vec![part([0.0, at], [-1.0, 0.0]), part([at, 1.0], [0.0; 2])]);
        for at in [0.4995, 0.5, 0.5005] {
            assert_eq!(contact(at).tractions_between(0, [0.0, 0.5])[0], [-1.0, 0.0]);
            assert_eq!(contact(at).tractions_between(0, [0.5, 1.0])[0], [0.0; 2]);
        }
        // Control: elsewhere places are what they are.
        assert_eq!(contact(0.4).tractions_between(0, [0.0, 0.2])[0], [-1.0, -0.5]);
    }

    #[test]
    fn a_pressure_without_friction_falls_off_to_where_contact_ends_and_others_stay() {
        let fallen = |law: Law| {
            let of = |ends, pressure| part(ends, pressure);
            let parts = vec![of([0.0, 0.5], [-2.0, -1.0]), of([0.5, 1.0], [0.0; 2])];
            let mut contacts = [Contact { law, ..contact(parts) }];
            let changed = fall_off(&mut contacts, &[(0, 0)]);
            (changed, contacts[0].parts.iter().map(|part| part.pressure).collect::<Vec<_>>())
        };
        let (changed, pressures) = fallen(Law::Contact);
        // With the same force, and 0 where it ends.
        assert!(changed && pressures[0][0] == -2.0 && pressures != fallen(Law::Bonded).1);
        for law in [Law::Friction(Bound::Tresca([1.0; 2])), Law::Bonded] {
            assert_eq!(fallen(law), (false, vec![[-2.0, -1.0], [0.0; 2]]));
        }
    }
}
