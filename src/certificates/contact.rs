//! An edge of Gamma_C with what the discrete solution says there, and the pressure of tau on it.
//!
//! Take lambda^h = -(1/gamma) \[P(u^h)\]+. A triangle whose contact edge holds the end of contact is cut there, so that
//! lambda^h is affine on the edges. For P2 it is quadratic, and the affine pressure with its force and its centroid would be
//! a tension at one end where the centroid is not in the middle third: then it acts on three times the way to the centroid
//! only, and the triangle is cut there ([`Profile`]). Where n~ turns along an edge, tau n is affine along it only if the
//! pressure is constant: then it acts on twice the way to the centroid, or on all of the edge where that is nearly all. Beside a quadratic v each half of an edge has a pressure of its own.
//! Whatever the moments of these pressures lack of those of lambda^h, the displacement that tau is built from is one under these
//! (`pressed`).

use std::sync::Arc;

use nalgebra::Vector2;

use super::parts::is_curved;
use crate::contact::{EdgeRule, Piece};
use crate::kernel::edge_integral::positive_interval;
use crate::model::{BoundaryEdge, Degree, Problem};

/// An edge of Gamma_C with what the solution says there.
pub(super) struct Contact {
    pub edge: BoundaryEdge,
    pub boundary: Arc<str>,
    pub length: f64,
    pub normal: Vector2<f64>,
    /// The direction of contact at both ends.
    pub directions: [Vector2<f64>; 2],
    /// g at both ends.
    pub gap: [f64; 2],
    /// Its value in the middle less their mean; 0 where it is known to be affine.
    pub gap_bulge: f64,
    /// The pressure on the edge, or on each of its halves.
    pub pressure: Vec<Profile>,
}

/// tau_n along an edge of Gamma_C: affine, or with a jump at a place between the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Profile {
    /// The place.
    pub cut: Option<f64>,
    /// Before and after it, each at both ends.
    pub values: [[f64; 2]; 2],
}

impl Profile {
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
        match (reach < 1.0, turned) {
            (false, false) => Profile::whole(ends),
            (false, true) => Profile::whole([ends[1], ends[0]]),
            (true, false) => Profile { cut: Some(reach), values: [ends, [0.0; 2]] },
            (true, true) => {
                Profile { cut: Some(1.0 - reach), values: [[0.0; 2], [ends[1], ends[0]]] }
            }
        }
    }
}

impl Contact {
    /// `halved` tells whether each half has a pressure of its own.
    pub fn new(problem: &Problem, edge: &Piece, u: &[[f64; 2]], halved: bool) -> Contact {
        let (geometry, degree, p) = (&edge.geometry, edge.degree, edge.p(u));
        let directions = [0, 1].map(|a| geometry.nodes[a].direction);
        let gap = [0, 1].map(|a| geometry.nodes[a].gap);
        let turns = geometry.turns();
        let curved = problem.conditions.get(&**edge.boundary()).is_some_and(is_curved);
        let gap_bulge = match geometry.nodes.get(2) {
            // The direction in the middle is the mean of those at the ends, a little shorter than 1.
            Some(middle) if turns || curved => {
                let mean = (directions[0] + directions[1]) / 2.0;
                middle.gap * mean.dot(&middle.direction) - (gap[0] + gap[1]) / 2.0
            }
            _ => geometry.bulge,
        };
        // Where P has these values at the nodes.
        let profile = |p: &[f64]| match p {
            &[start, end] if !turns => Profile::of_affine([start, end], edge.gamma),
            _ => {
                let end = match degree.roots(p)[..] {
                    [root] => Some(root),
                    _ => None,
                };
                let moments = with_hats(degree, p).map(|p| -(p / edge.gamma));
                Profile::of_moments(moments, p[0] > 0.0, end, turns)
            }
        };
        let on_half = |start: f64| {
            let at = |s: f64| {
                let shapes = degree.edge_values(start + s / 2.0);
                shapes.iter().zip(&p).map(|(n, p)| n * p).sum::<f64>()
            };
            profile(&degree.edge_positions().into_iter().map(at).collect::<Vec<f64>>())
        };
        Contact {
            edge: edge.edge(),
            boundary: Arc::clone(edge.boundary()),
            length: edge.length,
            normal: edge.normal(),
            directions,
            gap,
            gap_bulge,
            pressure: if halved { vec![on_half(0.0), on_half(0.5)] } else { vec![profile(&p)] },
        }
    }

    /// The parts of the edge on which the pressure is affine: from where to where, in units of it, and at both ends the pressure
    /// and the traction.
    fn parts(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2], [Vector2<f64>; 2])> {
        let share = 1.0 / self.pressure.len() as f64;
        self.pressure.iter().enumerate().flat_map(move |(i, profile)| {
            let start = share * i as f64;
            let at = profile.cut.unwrap_or(1.0);
            let parts = [([0.0, at], profile.values[0]), ([at, 1.0], profile.values[1])];
            let parts = parts.into_iter().take(if profile.cut.is_some() { 2 } else { 1 });
            parts.map(move |(ends, pressure)| {
                let ends = ends.map(|s| start + share * s);
                let [d, e] = self.directions;
                let along = [0, 1].map(|k| (d * (1.0 - ends[k]) + e * ends[k]) * pressure[k]);
                (ends, pressure, along)
            })
        })
    }

    /// The parts of the edge that are edges of the certificate.
    pub fn pieces(&self) -> Vec<[f64; 2]> {
        self.parts().map(|(ends, ..)| ends).collect()
    }

    /// int p d phi over the part of the edge between `from` and `to` for these functions phi of degree 2 or less, of the place on
    /// the edge from 0 to 1: Simpson's rule is exact.
    fn moments<const N: usize>(
        &self,
        [from, to]: [f64; 2],
        phi: impl Fn(f64) -> [f64; N],
    ) -> [Vector2<f64>; N] {
        let mut moments = [Vector2::zeros(); N];
        for ([s, t], _, [q, r]) in
            self.parts().filter(|(ends, ..)| ends[0] >= from && ends[1] <= to)
        {
            let weight = self.length * (t - s) / 6.0;
            for (x, q, times) in [(s, q, 1.0), ((s + t) / 2.0, (q + r) / 2.0, 4.0), (t, r, 1.0)] {
                let phi = phi(x);
                (0..N).for_each(|k| moments[k] += q * (phi[k] * times * weight));
            }
        }
        moments
    }

    /// int p d phi for the hat functions of the ends, and for 4 s (1 - s).
    pub fn on_edge(&self) -> [Vector2<f64>; 3] {
        self.moments([0.0, 1.0], |s| [1.0 - s, s, 4.0 * s * (1.0 - s)])
    }

    /// int p d phi over the part of this number for the hat functions of its ends.
    pub fn on_part(&self, number: usize) -> [Vector2<f64>; 2] {
        let count = self.pressure.len() as f64;
        let [from, to] = [number, number + 1].map(|k| k as f64 / count);
        self.moments([from, to], |s| [(to - s) * count, (s - from) * count])
    }

    /// int p, which is not positive, and int p d . r over it for a motion that is affine along the edge.
    pub fn against(&self, ends: [Vector2<f64>; 2]) -> [f64; 2] {
        let [a, b, _] = self.on_edge();
        let force = self.parts().map(|([s, t], [p, q], _)| self.length * (t - s) * (p + q) / 2.0);
        [force.sum(), a.dot(&ends[0]) + b.dot(&ends[1])]
    }

    /// Multiplies the pressure.
    pub fn scale(&mut self, factor: f64) {
        let values = self.pressure.iter_mut().flat_map(|profile| &mut profile.values);
        values.flatten().for_each(|p| *p *= factor);
    }

    /// The directions, if they are not the normal.
    pub fn along(&self) -> Option<[[f64; 2]; 2]> {
        (self.directions != [self.normal; 2]).then(|| self.directions.map(<[f64; 2]>::from))
    }

    /// Tells whether the direction of contact turns along it.
    pub fn turns(&self) -> bool {
        self.directions[0] != self.directions[1]
    }
}

/// int \[P\]+ phi for the hat functions of the ends of an edge, in units of its length.
fn with_hats(degree: Degree, p: &[f64]) -> [f64; 2] {
    let nodal = EdgeRule::Exact.integrals(degree, None, p).gradient;
    // A hat function is N_a and half of that of the middle.
    let middle = nodal.get(2).copied().unwrap_or_default();
    [0, 1].map(|a| nodal[a] + middle / 2.0)
}

/// Contact that ends this near an end of its edge, in units of the edge, leaves it whole: the triangles would be slivers.
pub(super) const NEAR_THE_END: f64 = 1e-3;

/// The least part of an edge that is cut off where lambda^h is not affine: a sliver bounds badly.
pub(super) const LEAST_PART: f64 = 0.15;
