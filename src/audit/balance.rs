//! Equilibrium made exact. The tractions of a certificate are doubles, so every triangle is out of balance by some
//! rounding errors: a force and a moment. They are carried along the edges of a tree, from the leaves to the root, each
//! edge getting the affine traction that balances the triangle behind it; what all triangles together are out of balance
//! by is taken by three components of traction on Gamma_D, where tractions are free, or of the pressure on Gamma_C, which
//! stays one as long as none changes by more than itself. The additional tractions exist as real numbers, and intervals
//! contain them. Where a motion is left that neither stops, as a round shaft turns in its bearing, the problem meant has a
//! support against it, which takes a force no larger than rounding ([`STOP`]). A pressure between two bodies changes on both: a part
//! hands on what it lacks to parts that need nothing of it (`settled`).

use nalgebra::Vector2;
use thiserror::Error;

use super::certificate::{Certificate, Edge, Law, Owners, Role, exactly, opposite, place};
use crate::kernel::Enclosing;
use crate::kernel::composite::Wrench;

/// Why there is no equilibrium to be had.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Unbalanced {
    /// Loads that nothing takes.
    #[error(
        "nothing balances the loads on the part of the body with triangle {triangle}; expected, for each part that edges join, supports or contact whose forces can"
    )]
    Free {
        /// A triangle of the part.
        triangle: usize,
    },
}

/// A force on an edge that may have any multiple.
#[derive(Clone, Copy)]
struct FreeForce {
    edge: usize,
    profile: Variation,
}

/// The variation of a force along an edge.
#[derive(Clone, Copy)]
enum Variation {
    /// On Gamma_D, or between tied bodies, affine with these values at the ends.
    Affine([[f64; 2]; 2]),
    /// On Gamma_C, the force that is there, at these ends.
    Pressure([bool; 2]),
    /// A support of the root of a part, against one component of its motion.
    Stop(usize),
}

/// Three holds of a part, and how far it reaches.
type Chosen = ([FreeForce; 3], f64);

/// The change of the pressures at both ends of edge `edge` of Gamma_C by equilibrium, in units of themselves.
#[derive(Clone, Copy)]
pub struct Change<S> {
    /// The edge.
    pub edge: usize,
    /// The change at both ends.
    pub factors: [S; 2],
}

/// Tractions in equilibrium, and what that takes beside small additions to those that are given.
pub struct Equilibrium<S> {
    /// tau N on the edges.
    pub forces: Vec<[Vector2<S>; 2]>,
    /// Pressures that change.
    pub changes: Vec<Change<S>>,
    pub(crate) stops: Vec<Stop<S>>,
    /// The force and the moment by which the given tractions and the body force leave each triangle out of balance.
    pub(crate) resultants: Vec<Wrench<S>>,
}

/// A support of triangle `root` against a motion that the conditions leave free: a force along its edge 0, at both ends.
pub(crate) struct Stop<S> {
    pub(crate) root: usize,
    pub(crate) force: [Vector2<S>; 2],
    /// Its force, or its moment over the size of the body, in units of the forces on the boundary.
    pub(crate) share: f64,
}

/// A support against a motion that is free may take this part of the forces on the boundary: what the loads, which do no work on
/// such a motion, do by rounding and by what Newton's method leaves.
const STOP: f64 = 1e-10;

/// The topology of a certificate's triangles: those of each edge, and the tree over those of each part. A part is what an edge
/// that is held in both components, long enough to take any force and moment, is the nearest such to, or a connected part of
/// the body where there is none: the fewer triangles behind an edge, the less rounding is carried over it.
#[derive(Clone)]
pub struct Topology {
    /// The triangles of each edge.
    pub owners: Owners,
    /// The triangles of one part after the other, each from its root on.
    order: Vec<usize>,
    /// The edge towards the root, which has none.
    towards_root: Vec<Option<usize>>,
}

impl Topology {
    /// Breadth first, from all held roots at once; edges inside a triangle that was cut, elsewhere than in the middle of an
    /// edge, come before all others.
    pub(crate) fn new(certificate: &Certificate, owners: Owners) -> Topology {
        let count = certificate.pieces.len();
        let mut order = Vec::with_capacity(count);
        // The place of the root among those found.
        let mut part_of = vec![None; count];
        let mut towards_root = vec![None; count];
        let mut next = 0;
        let held = held_roots(certificate, &owners);
        let alone = (0..count).map(|root| vec![root]);
        for roots in std::iter::once(held).chain(alone) {
            for root in roots {
                if part_of[root].is_none() {
                    part_of[root] = Some(order.len());
                    order.push(root);
                }
            }
            while let Some(&t) = order.get(next) {
                next += 1;
                let mut reached = vec![t];
                while let Some(from) = reached.pop() {
                    for e in certificate.pieces[from].edges {
                        // From t everywhere; from a triangle just found only to the rest of a cut one.
                        if from != t && !is_cut(certificate, e) {
                            continue;
                        }
                        let other = owners[e].into_iter().flatten().find(|&owner| owner != from);
                        if let Some(to) = other
                            && part_of[to].is_none()
                        {
                            part_of[to] = part_of[t];
                            towards_root[to] = Some(e);
                            order.push(to);
                            reached.push(to);
                        }
                    }
                }
            }
        }
        order.sort_by_key(|&t| part_of[t]);
        Topology { owners, order, towards_root }
    }

    /// The triangles of each part, from the root on.
    fn parts(&self) -> impl Iterator<Item = &[usize]> {
        self.order.chunk_by(|_, &t| self.towards_root[t].is_some())
    }
}

/// The edge is inside a triangle that was cut: it ends on an edge elsewhere than in its middle, or joins a vertex with a place between
/// two others.
fn is_cut(certificate: &Certificate, e: usize) -> bool {
    let ends = certificate.edges[e].ends;
    let cut = |p: usize| p.checked_sub(certificate.vertices.len()).map(|cut| certificate.cuts[cut]);
    let across = |from: usize, to: usize| {
        cut(from).is_none() && cut(to).is_some_and(|cut| !cut.ends.contains(&from))
    };
    ends.into_iter().filter_map(cut).any(|cut| cut.at != 0.5)
        || across(ends[0], ends[1])
        || across(ends[1], ends[0])
}

/// The triangles at the edges that are held in both components and no shorter than half of the longest: over a short one a
/// moment would be a large force.
fn held_roots(certificate: &Certificate, owners: &[[Option<usize>; 2]]) -> Vec<usize> {
    let length = |edge: &Edge| {
        let [start, end] = edge.ends.map(|p| place(certificate, p));
        (end - start).dot(&(end - start))
    };
    let is_held = |edge: &Edge| matches!(edge.role, Role::Held([true, true], _));
    let held = certificate.edges.iter().zip(owners).filter(|(edge, _)| is_held(edge));
    let longest = held.clone().map(|(edge, _)| length(edge)).fold(0.0, f64::max);
    let long = held.filter(|(edge, _)| length(edge) >= longest / 4.0);
    long.filter_map(|(_, [owner, _])| *owner).collect()
}

/// The edges of a certificate with the forces that it has on them.
pub(crate) struct OnEdges<'a, S> {
    pub(crate) certificate: &'a Certificate,
    pub(crate) topology: &'a Topology,
    pub(crate) points: &'a [Vector2<S>],
    /// tau N at both ends.
    pub(crate) forces: &'a [[Vector2<S>; 2]],
}

impl<S: Enclosing> OnEdges<'_, S> {
    /// Puts every triangle in equilibrium. `resultants` are those of the forces on the triangles, with the loads.
    ///
    /// # Errors
    /// A connected part that neither Gamma_D nor pressures on Gamma_C balance.
    pub(crate) fn close(&self, resultants: Vec<Wrench<S>>) -> Result<Equilibrium<S>, Unbalanced> {
        let mut added = vec![[Vector2::zeros(); 2]; self.certificate.edges.len()];
        let (mut changes, mut stops) = (Vec::new(), Vec::new());
        let mut wrenches = resultants.clone();
        let owners = &self.topology.owners;
        for (part, chosen) in self.settled()?.into_iter().rev() {
            let root = part[0];
            let mut total = wrenches[root];
            for &t in &part[1..] {
                total = total.plus(wrenches[t]);
            }
            for (hold, factor, share) in self.factors(part, chosen, total)? {
                if let Variation::Stop(c) = hold.profile {
                    let wrench = stop(c, factor, total.about);
                    let [start, end] =
                        [1, 2].map(|k| self.points[self.certificate.pieces[root].vertices[k]]);
                    let force = wrench.on_edge(start, end);
                    stops.push(Stop { root, force, share });
                    wrenches[root] = wrenches[root].plus(wrench);
                    continue;
                }
                let force = self.unit(hold).map(|f| f * factor);
                let other = self.certificate.facing.get(&hold.edge).copied();
                // The opposite acts on the other body, which is closed later.
                let there = other.map(|edge| (edge, opposite(force)));
                for (edge, force) in std::iter::once((hold.edge, force)).chain(there) {
                    let Some(owner) = owners[edge][0] else { continue };
                    (0..2).for_each(|k| added[edge][k] += force[k]);
                    let wrench = self.wrench(edge, force);
                    wrenches[owner] = wrenches[owner].plus(wrench);
                }
                let Variation::Pressure(ends) = hold.profile else { continue };
                let [a, b] = ends.map(|end| if end { factor } else { S::from(0) });
                let second =
                    other.filter(|_| self.certificate.edges[hold.edge].role == Role::Facing);
                changes.push(match second {
                    Some(edge) => Change { edge, factors: [b, a] },
                    None => Change { edge: hold.edge, factors: [a, b] },
                });
            }
            for &t in part[1..].iter().rev() {
                let Some(e) = self.topology.towards_root[t] else { continue };
                let [Some(left), Some(right)] = owners[e] else { continue };
                let [start, end] = self.certificate.edges[e].ends.map(|p| self.points[p]);
                let wrench = wrenches[t];
                let force = wrench.on_edge(start, end);
                // The triangle behind the edge gets minus its resultant, the one before it the resultant.
                let (before, force) =
                    if left == t { (right, force.map(|f| -f)) } else { (left, force) };
                (0..2).for_each(|k| added[e][k] += force[k]);
                wrenches[before] = wrenches[before].plus(wrench);
            }
        }
        let both = self.forces.iter().zip(added);
        let forces = both.map(|(given, added)| [0, 1].map(|k| given[k] + added[k])).collect();
        Ok(Equilibrium { forces, changes, stops, resultants })
    }

    /// The parts with three holds each, of which pressures between two bodies are those towards parts before: closed from the last
    /// one on, none is changed by others once it is closed.
    fn settled<'t>(&'t self) -> Result<Vec<(&'t [usize], Chosen)>, Unbalanced> {
        let mut left: Vec<&[usize]> = self.topology.parts().collect();
        let mut settled = Vec::with_capacity(left.len());
        let mut is_settled = vec![false; self.certificate.pieces.len()];
        while let Some(&first) = left.first() {
            let mut settle = |part: &'t [usize], chosen: Chosen, is_settled: &mut Vec<bool>| {
                part.iter().for_each(|&t| is_settled[t] = true);
                settled.push((part, chosen));
            };
            let before = left.len();
            left.retain(|&part| match self.choose(part, false, &is_settled) {
                Some(chosen) => {
                    settle(part, chosen, &mut is_settled);
                    false
                }
                None => true,
            });
            if left.len() < before {
                continue;
            }
            // Where no part can be settled without, as few motions as can be are stopped.
            let with_stops = left.iter().enumerate();
            let with_stops =
                with_stops.filter_map(|(i, part)| Some((i, self.choose(part, true, &is_settled)?)));
            let is_stop = |hold: &&FreeForce| matches!(hold.profile, Variation::Stop(_));
            let fewest =
                with_stops.min_by_key(|(_, (holds, _))| holds.iter().filter(is_stop).count());
            let Some((i, chosen)) = fewest else {
                return Err(Unbalanced::Free { triangle: first[0] });
            };
            settle(left.remove(i), chosen, &mut is_settled);
        }
        Ok(settled)
    }

    /// The factors with which the holds of a part balance `total`, and what a support takes of the forces on the boundary.
    fn factors(
        &self,
        part: &[usize],
        (holds, size): Chosen,
        total: Wrench<S>,
    ) -> Result<[(FreeForce, S, f64); 3], Unbalanced> {
        let free = Unbalanced::Free { triangle: part[0] };
        let pull = self.pull(part);
        let unit = holds.map(|hold| match hold.profile {
            Variation::Stop(c) => stop(c, S::from(1), total.about),
            _ => self.wrench(hold.edge, self.unit(hold)).about(total.about),
        });
        let factors = solve(unit, total);
        let found = [0, 1, 2].map(|k| {
            let share = match holds[k].profile {
                _ if factors[k].size() == 0.0 => 0.0,
                Variation::Stop(2) => factors[k].size() / (pull * size),
                Variation::Stop(_) => factors[k].size() / pull,
                _ => 0.0,
            };
            (holds[k], factors[k], share)
        });
        if found.iter().all(|(_, _, share)| *share <= STOP) { Ok(found) } else { Err(free) }
    }

    /// The sum of the forces on the boundary of a part.
    fn pull(&self, part: &[usize]) -> f64 {
        let edges = part.iter().flat_map(|&t| self.certificate.pieces[t].edges);
        let outer = edges.filter(|&e| self.topology.owners[e][1].is_none());
        outer.flat_map(|e| self.forces[e]).map(|force| force[0].size() + force[1].size()).sum()
    }

    /// The force of a hold at both ends of its edge.
    fn unit(&self, hold: FreeForce) -> [Vector2<S>; 2] {
        match hold.profile {
            Variation::Affine(ends) => ends.map(exactly),
            Variation::Stop(_) => [Vector2::zeros(); 2],
            Variation::Pressure(ends) => {
                let force = self.certificate.push(hold.edge, self.points);
                [0, 1].map(|k| if ends[k] { force[k] } else { Vector2::zeros() })
            }
        }
    }

    /// The wrench of a force on edge `e`, about the middle of that: int (s - 1/2) E x (f + s (g - f)) = E x (g - f) / 12.
    fn wrench(&self, e: usize, [f, g]: [Vector2<S>; 2]) -> Wrench<S> {
        let [start, end] = self.certificate.edges[e].ends.map(|p| self.points[p]);
        Wrench {
            force: (f + g) / S::from(2),
            moment: (end - start).perp(&(g - f)) / S::from(12),
            about: (start + end) / S::from(2),
        }
    }

    /// Quantities that may change on edge `e`: tractions on Gamma_D, and each pressure on Gamma_C by a part of itself. Where
    /// the direction of contact turns it is the same at both ends, and stays so.
    fn candidates(&self, e: usize) -> impl Iterator<Item = FreeForce> {
        let any =
            |d: [f64; 2]| [d, d.map(|d| -d)].map(|start| Variation::Affine([start, d])).to_vec();
        let axes = [[1.0, 0.0], [0.0, 1.0]];
        let edges = &self.certificate.edges;
        let first = match edges[e].role {
            Role::Facing => self.certificate.facing.get(&e).map_or(e, |&first| first),
            _ => e,
        };
        let profiles = match edges[first].role {
            Role::Held(held, _) => (0..2).filter(|&c| held[c]).flat_map(|c| any(axes[c])).collect(),
            Role::Supported { along, .. } => any(along),
            Role::Contact { law: Law::Bonded { .. }, .. } => {
                axes.into_iter().flat_map(any).collect()
            }
            Role::Contact { law: Law::Sliding, along: Some([d, end]), .. } if d == end => any(d),
            Role::Contact { law: Law::Sliding, along: Some([d, end]), .. } => {
                vec![Variation::Affine(if e == first { [d, end] } else { [end, d] })]
            }
            Role::Contact { pressure: [0.0, 0.0], .. } => Vec::new(),
            Role::Contact { along: Some([d, end]), .. } if d != end => {
                vec![Variation::Pressure([true; 2])]
            }
            Role::Contact { .. } => {
                vec![Variation::Pressure([true, false]), Variation::Pressure([false, true])]
            }
            _ => Vec::new(),
        };
        profiles.into_iter().map(move |profile| FreeForce { edge: e, profile })
    }

    /// Three holds of a part whose wrenches are as independent as any: greedily, by what is left after those before. Those of
    /// Gamma_D come first, where any traction is admissible; a motion that neither stops may get a support. Pressures on other parts
    /// are those on settled ones.
    fn choose(&self, part: &[usize], may_stop: bool, is_settled: &[bool]) -> Option<Chosen> {
        let double = |x: Vector2<S>| x.map(|c| (c.lower() + c.upper()) / 2.0);
        let origin = double(self.points[self.certificate.pieces[part[0]].vertices[0]]);
        let mut candidates = Vec::new();
        let mut size = 0.0_f64;
        for &t in part {
            for e in self.certificate.pieces[t].edges {
                if self.topology.owners[e][0] != Some(t) {
                    continue;
                }
                let faced =
                    self.certificate.facing.get(&e).map(|&other| self.topology.owners[other][0]);
                if faced.is_some_and(|owner| owner.is_none_or(|owner| !is_settled[owner])) {
                    continue;
                }
                for hold in self.candidates(e) {
                    let wrench = self.wrench(e, self.unit(hold));
                    let (force, arm) = (double(wrench.force), double(wrench.about) - origin);
                    let moment = (wrench.moment.lower() + wrench.moment.upper()) / 2.0;
                    size = size.max(arm[0].hypot(arm[1]));
                    candidates.push((hold, [force[0], force[1], moment + arm.perp(&force)]));
                }
            }
        }
        let norm = |row: &[f64; 3]| row.iter().map(|x| x * x).sum::<f64>();
        let mut chosen: Vec<(FreeForce, [f64; 3])> = Vec::with_capacity(3);
        let edge = self.certificate.pieces[part[0]].edges[0];
        let stops = [0, 1, 2].map(|c| {
            let row = [0, 1, 2].map(|d| if c == d { 1.0 } else { 0.0 });
            (FreeForce { edge, profile: Variation::Stop(c) }, row)
        });
        for (_, row) in &mut candidates {
            row[2] /= size;
        }
        let (of_contact, of_supports) = candidates
            .into_iter()
            .partition(|(hold, _)| matches!(hold.profile, Variation::Pressure(_)));
        let stops = if may_stop { Vec::from(stops) } else { Vec::new() };
        for candidates in [of_supports, of_contact, stops] {
            let left = |row: &[f64; 3], chosen: &[(FreeForce, [f64; 3])]| {
                chosen.iter().fold(*row, |row, (_, other)| {
                    let along = (0..3).map(|c| row[c] * other[c]).sum::<f64>() / norm(other);
                    [0, 1, 2].map(|c| row[c] - along * other[c])
                })
            };
            // Below this part of the largest, three rows in the plane are dependent up to rounding.
            let least = 1e-16 * candidates.iter().map(|(_, row)| norm(row)).fold(0.0, f64::max);
            while chosen.len() < 3 {
                let rest = candidates.iter().map(|(hold, row)| (*hold, left(row, &chosen)));
                let best = rest.max_by(|a, b| norm(&a.1).total_cmp(&norm(&b.1)));
                let Some(best) = best.filter(|(_, row)| norm(row) > least) else { break };
                chosen.push(best);
            }
        }
        match chosen[..] {
            [(a, _), (b, _), (c, _)] => Some(([a, b, c], size)),
            _ => None,
        }
    }
}

/// A force along x, along y, or a moment of this size.
fn stop<S: Enclosing>(c: usize, size: S, about: Vector2<S>) -> Wrench<S> {
    let [x, y, moment] = [0, 1, 2].map(|k| if k == c { size } else { S::from(0) });
    Wrench { force: Vector2::new(x, y), moment, about }
}

/// The factors with which three wrenches about one point add up to minus `total`, by Cramer's rule.
fn solve<S: Enclosing>(unit: [Wrench<S>; 3], total: Wrench<S>) -> [S; 3] {
    let column = |w: Wrench<S>| [w.force[0], w.force[1], w.moment];
    let (columns, right) = (unit.map(column), column(total).map(|x| -x));
    let determinant = |[a, b, c]: [[S; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1])
            + c[0] * (a[1] * b[2] - a[2] * b[1])
    };
    let whole = determinant(columns);
    [0, 1, 2].map(|k| {
        let mut with = columns;
        with[k] = right;
        determinant(with) / whole
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::certificate::tests::piece;
    use crate::checks::Rejection;

    /// A square of two triangles under a pressure all round, on its left side that of contact, which holds it along x alone: where its
    /// direction turns it has one size. On the side below, of the first triangle, acts a further traction. In units of length and stress.
    pub(crate) fn square(traction: [[f64; 2]; 2], [size, stress]: [f64; 2]) -> Certificate {
        let edge = |start, end, role| Edge { ends: [start, end], role };
        let below = traction.map(|[x, y]| [x * stress, (1.0 + y) * stress]);
        let along = Some([[-1.0, 0.0], [-1.0, 2.0_f64.powi(-60)]]);
        let law = Law::default();
        let contact = Role::Contact { pressure: [-stress; 2], gap: [0.0; 2], along, law };
        Certificate {
            vertices: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
                .map(|x| x.map(|c| size * c))
                .into(),
            displacement: vec![[0.0; 2]; 4],
            prescribed: vec![[None; 2]; 4],
            pieces: vec![piece([0, 1, 2], [0, 1, 2], stress), piece([0, 2, 3], [3, 4, 1], stress)],
            edges: vec![
                edge(1, 2, Role::Pressed([stress; 2])),
                edge(2, 0, Role::Inner([[size * stress, -size * stress]; 2])),
                edge(0, 1, Role::Loaded(below)),
                edge(2, 3, Role::Pressed([stress; 2])),
                edge(3, 0, contact),
            ],
            ..Certificate::default()
        }
    }

    #[test]
    fn what_stops_a_motion_takes_the_same_share_of_the_forces_in_all_units() {
        let small = 2.0_f64.powi(-34);
        // Along y a force of small beside eight of 1; and a moment of small / 6, at the arm of half a side that contact has.
        let (push, turn) = ([[0.0, small]; 2], [[0.0, -small], [0.0, small]]);
        for (traction, share) in [(push, small / 8.0), (turn, small / 24.0)] {
            for size in [1.0, 1024.0, 2.0_f64.powi(-10)] {
                for stress in [1.0, 2.0_f64.powi(30)] {
                    let found = square(traction, [size, stress]).prove().unwrap().stop;
                    // The small traction itself counts among the forces, and what rounding leaves is 1e-15 of them.
                    assert!(
                        (found / share - 1.0).abs() <= 1e-2,
                        "{found} {share}: {size} {stress}"
                    );
                    // Controls: a thousand times as much is a load, and none takes none.
                    let loaded = traction.map(|t| t.map(|t| 1e3 * t));
                    let loaded = square(loaded, [size, stress]).prove();
                    assert!(matches!(loaded, Err(Rejection::Unbalanced(_))), "{loaded:?}");
                    let free = square([[0.0; 2]; 2], [size, stress]).prove().unwrap().stop;
                    assert!(free <= 1e-14, "{free}");
                }
            }
        }
    }
}
