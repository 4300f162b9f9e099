//! An edge of Gamma_C with what the discrete solution says there, and the pressure of tau on it.
//!
//! Take lambda^h = -(1/gamma) \[P(u^h)\]+. A triangle whose contact edge holds the end of contact is cut there, so that
//! lambda^h is affine on the edges. For P2 it is quadratic, and the affine pressure with its force and its centroid would be
//! a tension at one end where the centroid is not in the middle third: then it acts on three times the way to the centroid
//! only, and the triangle is cut there ([`Profile`]). Force and moment are those of lambda^h, unless that way is too short to
//! cut a triangle there. Where n~ turns along an edge, tau n is affine along it only if the pressure is constant: then it is
//! the mean of lambda^h.

use std::sync::Arc;

use nalgebra::Vector2;

use crate::fem::{BoundaryEdge, EdgeRule, Piece, Problem};
use crate::kernel::contact_edge::integral_of_product;
use crate::kernel::edge_integral::positive_interval;

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
    /// int lambda^h n~ phi for them.
    pub moments: [Vector2<f64>; 2],
    /// c_E
    pub excess: Vector2<f64>,
    pub pressure: Profile,
    /// Pressure and moments on both halves of the edge.
    pub on_halves: [(Profile, [Vector2<f64>; 2]); 2],
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
    /// is in the middle third of that; else up to three times the way to the centroid.
    fn of_moments(m: [f64; 2], starts: bool, end: Option<f64>) -> Profile {
        let force = m[0] + m[1];
        if !(force < 0.0) {
            return Profile::whole([0.0; 2]);
        }
        // Seen from where contact is, or where most of it is.
        let turned = if end.is_some() { !starts } else { m[1] < m[0] };
        let centroid = if turned { m[0] } else { m[1] } / force;
        let end = end.map_or(1.0, |end| if turned { 1.0 - end } else { end });
        let reach = match end.min(3.0 * centroid) {
            x if x <= 1.0 - LEAST_PART => x.max(LEAST_PART),
            // Three halves of the way would be enough.
            _ if 3.0 * centroid < 1.0 => 1.0 - LEAST_PART,
            _ => 1.0,
        };
        let place = (centroid / reach).clamp(1.0 / 3.0, 2.0 / 3.0);
        let mean = force / reach;
        let ends = [mean * (4.0 - 6.0 * place), mean * (6.0 * place - 2.0)].map(|p| p.min(0.0));
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
    pub fn new(problem: &Problem, edge: &Piece, u: &[[f64; 2]]) -> Contact {
        let (geometry, degree, p) = (&edge.geometry, edge.degree, edge.p(u));
        // int \[P\]+ N_a; a hat function is N_a and half of that of the middle.
        let nodal = |p: &[f64]| EdgeRule::Exact.integrals(degree, p).gradient;
        let with_hats = |p: &[f64]| {
            let nodal = nodal(p);
            let middle = nodal.get(2).copied();
            [0, 1].map(|a| middle.map_or(nodal[a], |m| nodal[a] + m / 2.0))
        };
        let positive = with_hats(&p);
        let all_directions: Vec<Vector2<f64>> = geometry.directions().collect();
        let directions = [all_directions[0], all_directions[1]];
        // On a part of the edge, `share` of its length, with P and the directions at its nodes.
        let BoundaryEdge { triangle, local } = edge.edge();
        let normal = problem.mesh.triangle(triangle).scaled_normal(local);
        let moments = |p: &[f64], directions: &[Vector2<f64>], share: f64| {
            if geometry.along_normal {
                return with_hats(p).map(|p| normal * -(share * p / edge.gamma));
            }
            let nodal = nodal(p);
            let along = |a: usize, p: f64| directions[a] * -(share * edge.length * p / edge.gamma);
            [0, 1].map(|a| {
                let own = along(a, nodal[a]);
                nodal.get(2).map_or(own, |m| own + along(2, m / 2.0))
            })
        };
        let sigma_n = edge.sigma_n(u);
        let excess = Vector2::from([0, 1].map(|c| {
            let stress = integral_of_product(sigma_n, directions.map(|d| d[c]));
            -(positive[0] * directions[0][c] + positive[1] * directions[1][c]) - edge.gamma * stress
        }));
        let gap = [geometry.nodes[0].gap, geometry.nodes[1].gap];
        let turns = geometry.turns();
        let gap_bulge = match geometry.nodes.get(2) {
            // The direction in the middle is the mean of those at the ends, a little shorter than 1.
            Some(middle) if turns => {
                let mean = (directions[0] + directions[1]) / 2.0;
                middle.gap * mean.dot(&middle.direction) - (gap[0] + gap[1]) / 2.0
            }
            _ => geometry.bulge,
        };
        let profile = |p: &[f64]| {
            let positive = with_hats(p);
            if turns {
                // The mean: then tau n is affine.
                Profile::whole([-((positive[0] + positive[1]) / edge.gamma); 2])
            } else if let &[start, end] = p {
                Profile::of_affine([start, end], edge.gamma)
            } else {
                let end = match degree.roots(p)[..] {
                    [root] => Some(root),
                    _ => None,
                };
                Profile::of_moments(positive.map(|p| -(p / edge.gamma)), p[0] > 0.0, end)
            }
        };
        let on_halves = [0.0, 0.5].map(|start| {
            let shapes: Vec<Vec<f64>> = (degree.edge_positions().into_iter())
                .map(|s| degree.edge_values(start + s / 2.0))
                .collect();
            let here = |n: &Vec<f64>| n.iter().zip(&p).map(|(n, p)| n * p).sum::<f64>();
            let here: Vec<f64> = shapes.iter().map(here).collect();
            let direction = |n: &Vec<f64>| n.iter().zip(&all_directions).map(|(n, d)| d * *n).sum();
            let directions: Vec<Vector2<f64>> = shapes.iter().map(direction).collect();
            (profile(&here), moments(&here, &directions, 0.5))
        });
        Contact {
            edge: edge.edge(),
            boundary: Arc::clone(edge.boundary()),
            length: edge.length,
            normal: edge.normal(),
            directions,
            gap,
            gap_bulge,
            moments: moments(&p, &all_directions, 1.0),
            excess,
            pressure: profile(&p),
            on_halves,
        }
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

/// Contact that ends this near an end of its edge, in units of the edge, leaves it whole: the triangles would be slivers.
pub(super) const NEAR_THE_END: f64 = 1e-3;

/// The least part of an edge that is cut off where lambda^h is not affine: a sliver bounds badly, and the force of what is
/// shorter has so little moment that the balance of the triangles may carry it.
pub(super) const LEAST_PART: f64 = 0.15;
