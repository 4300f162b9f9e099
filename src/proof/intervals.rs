//! (8) at a displacement, in balls, and the intervals of the quantities of its solution nearby.

use std::collections::BTreeMap;

#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use super::balls::{Lines, field, length, product, root, strain_energy};
use crate::contact::{Discretization, Piece, residual};
use crate::kernel::ball::{PreciseBall, up};
use crate::kernel::{DoubleDouble, Response};
use crate::linear::system::System;
use crate::proof::rounded_stress;
use crate::proof::rounded_stress::{is_plain, surely_open};

/// An interval `[low, high]`.
pub(crate) type Range = [f64; 2];

/// Intervals that contain the quantities of the exact solution of (8).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct Intervals {
    /// a(u, u)
    #[cfg_attr(feature = "files", serde(rename = "a_uu", alias = "energy"))]
    pub energy: Range,
    /// The largest length of u at a node.
    pub max_displacement: Range,
    /// Intervals of each contact boundary's quantities.
    pub contact: Vec<ContactIntervals>,
    /// The force of each displacement boundary on the body.
    /// Empty where there are more than 64 displacement boundaries.
    pub reactions: BTreeMap<String, [Range; 2]>,
}

impl Intervals {
    pub(super) fn are_finite(&self) -> bool {
        let contact = self.contact.iter().flat_map(|c| [c.force, c.resultant[0], c.resultant[1]]);
        let all = contact.chain(self.reactions.values().copied().flatten());
        let all = all.chain([self.energy, self.max_displacement]);
        all.flatten().all(f64::is_finite)
    }
}

/// Intervals of a contact boundary's quantities.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct ContactIntervals {
    /// Its name.
    pub(crate) boundary: String,
    /// The name of the boundary of the other body, if there is one.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub(crate) partner: Option<String>,
    /// -int lambda^h
    pub force: Range,
    /// int lambda^h n~: the force on the body
    pub resultant: [Range; 2],
}

/// The arithmetic of the stresses of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// Doubles: what they are off by is bounded as a whole.
    Doubles,
    /// Balls, of some 106 bits each.
    Balls,
}

impl Arithmetic {
    /// Adds a(u, v) for every basis function v, off by a functional r with |r(v)| <= b |v|_a for the b that is returned.
    pub(super) fn add_forces(
        self,
        d: &Discretization,
        u: &[[PreciseBall; 2]],
        forces: &mut [[PreciseBall; 2]],
    ) -> f64 {
        match self {
            Arithmetic::Doubles => rounded_stress::add_forces(d, u, forces),
            Arithmetic::Balls => {
                residual::add_internal_forces(&d.space, &d.problem.material, u, forces);
                0.0
            }
        }
    }

    /// a(u, v) for every basis function v, likewise, for a displacement that is next to nothing, where sums in doubles do.
    pub(super) fn small_forces(
        self,
        d: &Discretization,
        u: &[[PreciseBall; 2]],
    ) -> (Vec<[PreciseBall; 2]>, f64) {
        if self == Arithmetic::Doubles {
            return rounded_stress::small_forces(d, u);
        }
        let mut forces = vec![[PreciseBall::from(0); 2]; u.len()];
        let off = self.add_forces(d, u, &mut forces);
        (forces, off)
    }

    /// Adds -int gamma sigma_n(u) sigma_n(v) for every basis function v; returns what the `bound` of the functional by which the forces
    /// are off becomes by that.
    pub(super) fn add_stresses(
        self,
        d: &Discretization,
        lines: &Lines,
        u: &[[PreciseBall; 2]],
        (forces, bound): (&mut [[PreciseBall; 2]], f64),
    ) -> f64 {
        let in_doubles = self == Arithmetic::Doubles;
        let in_balls = d.contact.iter().enumerate();
        let in_balls = in_balls.filter(|(_, piece)| !(in_doubles && is_plain(piece)));
        in_balls.for_each(|(e, _)| lines[e].add_stresses(u, forces));
        if !in_doubles {
            return bound;
        }
        up((bound * bound + rounded_stress::add_contact_stresses(d, u, forces)).sqrt())
    }

    /// |v|_a at most.
    fn energy_norm(self, d: &Discretization, v: &[[PreciseBall; 2]]) -> f64 {
        match self {
            Arithmetic::Doubles => rounded_stress::energy_norm_at_most(d, v),
            Arithmetic::Balls => root(strain_energy(d, v)),
        }
    }
}

/// (8) at u~, or near it.
pub(super) struct EnclosedResidual {
    /// The residual at every basis function.
    pub(crate) residual: Vec<[PreciseBall; 2]>,
    /// With Coulomb's friction: the residual for the middles of the contact forces, which are off by [`EnclosedResidual::spread`].
    pub(crate) for_middles: Option<Vec<[PreciseBall; 2]>>,
    /// u~, or the field near it, with its prescribed components where they should be.
    pub(crate) u: Vec<[PreciseBall; 2]>,
    /// The energy norm of what that is off the displacement that is reported, at most.
    pub(crate) moved: f64,
    /// a(u~, u~)
    pub(crate) energy: PreciseBall,
    /// The residual is off by no more than a functional r with |r(v)| <= this times |v|_a.
    pub(crate) off: f64,
    /// int \[P\]+ N_a / gamma on all pieces, exactly 0 where they surely do not press.
    pressures: Vec<PreciseBall>,
    arithmetic: Arithmetic,
}

impl EnclosedResidual {
    /// None if it over- or underflows double precision.
    pub(crate) fn new(
        system: &System,
        lines: &Lines,
        (u, reported): (&[[f64; 2]], &[[f64; 2]]),
        near: Option<&[[DoubleDouble; 2]]>,
        (load, arithmetic): (&[[PreciseBall; 2]], Arithmetic),
    ) -> Option<Self> {
        let d = system.d;
        let frames = d.constraints.frames();
        let at = |node: usize| match near {
            Some(near) => near[node].map(PreciseBall::from),
            None => u[node].map(PreciseBall::from),
        };
        let component = |_, node: usize, c: usize| match frames.get(&node) {
            Some(&axis) => {
                PreciseBall::point(crate::model::constraints::in_frame(axis, at(node))[c].centre())
            }
            None => at(node)[c],
        };
        let prescribed =
            |node: usize, c: usize| d.constraints.values()[node][c].unwrap_or_default();
        let exact = field(system, component, prescribed);
        let off: Vec<[PreciseBall; 2]> = exact
            .iter()
            .zip(reported)
            .map(|(exact, u)| [0, 1].map(|c| exact[c] - PreciseBall::from(u[c])))
            .collect();
        let mut residual = vec![[PreciseBall::from(0); 2]; u.len()];
        let moved = arithmetic.energy_norm(d, &off);
        let off = arithmetic.add_forces(d, &exact, &mut residual);
        // x^2 = a(u~, u~) is off q = u~ . forces by off x at most, so x <= off + q^(1/2).
        let energy = product(&exact, &residual);
        let energy = energy.widened(up(off * (off + root(energy))));
        let mut pressures = vec![PreciseBall::from(0); system.functionals()];
        let off = arithmetic.add_stresses(d, lines, &exact, (&mut residual, off));
        for (r, &l) in residual.iter_mut().zip(load) {
            *r = [r[0] - l[0], r[1] - l[1]];
        }
        let mut for_middles = d.has_coulomb().then(|| residual.clone());
        let open = match arithmetic {
            Arithmetic::Doubles => surely_open(d, &exact),
            Arithmetic::Balls => vec![false; d.contact.len()],
        };
        for (e, _) in open.iter().enumerate().filter(|(_, is_open)| !**is_open) {
            let line = &lines[e];
            let pressure = line.force(&d.rule, &line.p(&exact));
            line.add_contact(&pressure, &mut residual);
            if let Some(residual) = &mut for_middles {
                let middle = |p: &PreciseBall| PreciseBall::point(p.centre());
                line.add_contact(&pressure.iter().map(middle).collect::<Vec<_>>(), residual);
            }
            pressures[line.functionals()].copy_from_slice(&pressure);
        }
        let all = residual.iter().chain(&exact).flatten();
        let lengths_are_finite = exact.iter().all(|&u| length(u).is_finite());
        if !(lengths_are_finite && all.chain([&energy]).all(|b| b.is_finite())) {
            return None;
        }
        let u = exact;
        Some(EnclosedResidual {
            residual,
            for_middles,
            u,
            moved,
            energy,
            off,
            pressures,
            arithmetic,
        })
    }

    /// The radius of the ball of each functional's force.
    pub(crate) fn spread(&self) -> Vec<f64> {
        self.pressures.iter().map(|force| force.radius()).collect()
    }

    /// Encloses the reported quantities, with |u~ - u^h|_A <= `rho`, |u~ - u^h|_a <= `radius`, the norm of gamma^{1/2}
    /// (lambda~ - lambda^h) at most `pressure`, and displacements at the nodes with their bounds.
    pub(crate) fn intervals(
        &self,
        d: &Discretization,
        lines: &Lines,
        (u, nodes): (&[[PreciseBall; 2]], &[f64]),
        [rho, pressure]: [f64; 2],
        radius: f64,
    ) -> Intervals {
        // |u^h|_a is within the radius of |u~|_a.
        let low = self.energy.lower().max(0.0).sqrt() * (1.0 - 2.0 * f64::EPSILON);
        let low = ((low - radius) * (1.0 - 2.0 * f64::EPSILON)).max(0.0);
        let high = up(root(self.energy) + radius);
        let energy = [low * low * (1.0 - 2.0 * f64::EPSILON), up(high * high)];

        let mut max_displacement = [0.0_f64; 2];
        for (u, by) in u.iter().zip(nodes) {
            let high = up(length(*u) + by);
            max_displacement[1] = max_displacement[1].max(high);
            // A length below what the largest is at least makes no difference.
            if high > max_displacement[0] {
                let [a, b] = u.map(PreciseBall::least_magnitude);
                let low = (a * a + b * b).sqrt() * (1.0 - 16.0 * f64::EPSILON);
                let low = (low - by) * (1.0 - 2.0 * f64::EPSILON);
                max_displacement[0] = max_displacement[0].max(low);
            }
        }

        let mut contact: Vec<(&Piece, [PreciseBall; 3], f64)> = Vec::new();
        for (e, piece) in d.contact.iter().enumerate() {
            let zero = PreciseBall::from(0);
            let pressure = &self.pressures[piece.functionals()];
            let along = piece.along(pressure).len();
            let mut of = [zero; 3];
            for (i, &p) in pressure.iter().enumerate().filter(|(_, p)| **p != zero) {
                let n = lines[e].direction_of(i);
                let force = if i < along { of[0] + p } else { of[0] };
                of = [force, of[1] - p * n[0], of[2] - p * n[1]];
            }
            let weight = piece.whole_weight();
            match contact.iter_mut().find(|(first, ..)| first.is_of_same_boundary(piece)) {
                Some((_, sum, weights)) => {
                    *sum = [0, 1, 2].map(|i| sum[i] + of[i]);
                    *weights += weight;
                }
                None => contact.push((piece, of, weight)),
            }
        }
        let contact = contact
            .into_iter()
            .map(|(piece, sums, weight)| {
                // |int mu n~_c| <= (int 1/gamma)^{1/2} |gamma^{1/2} mu|
                // A sum of positive doubles, with few roundings each.
                let weight = PreciseBall::from(weight * (1.0 + 1e-9));
                let off = up(root(weight) * pressure);
                let [force, x, y] = sums.map(|sum| range(sum.widened(off)));
                // Without tension lambda^h <= 0.
                let pushes = piece.responses().all(|(r, _)| r == Response::Unilateral);
                let force = if pushes { [force[0].max(0.0), force[1]] } else { force };
                ContactIntervals {
                    boundary: piece.boundary().to_string(),
                    partner: piece.partner().map(|name| name.to_string()),
                    force,
                    resultant: [x, y],
                }
            })
            .collect();
        let reactions = self.reactions(d, lines, [rho, pressure]);
        Intervals { energy, max_displacement, contact, reactions }
    }

    /// The residual at the held directions, and how far that of u^h can be from it.
    fn reactions(
        &self,
        d: &Discretization,
        lines: &Lines,
        [rho, pressure]: [f64; 2],
    ) -> BTreeMap<String, [Range; 2]> {
        let zero = PreciseBall::from(0);
        let mut test = vec![[zero; 2]; self.u.len()];
        let of = |(boundary, held): (&String, &Vec<crate::model::constraints::Held>)| {
            let ranges = [0, 1].map(|c| {
                // The reaction is the residual at this field.
                let mut reaction = zero;
                for held in held.iter().filter(|held| held.direction[c] != 0.0) {
                    let direction = PreciseBall::from(held.direction[c]);
                    for k in 0..2 {
                        let part = direction * PreciseBall::from(held.dual[k]);
                        test[held.node][k] += part;
                        reaction += part * self.residual[held.node][k];
                    }
                }
                let by_body = self.arithmetic.energy_norm(d, &test);
                let pieces = d.contact.iter().enumerate();
                let by_contact = pieces.fold(PreciseBall::from(0), |sum, (e, piece)| {
                    let is_still = |node: &usize| test[*node].iter().all(|c| c.magnitude() == 0.0);
                    if piece.nodes.iter().all(is_still) {
                        return sum;
                    }
                    let line = &lines[e];
                    let most = line.each_p0(&test).fold(0.0, |sum, p| up(sum + p.magnitude()));
                    sum + line.whole_weight() * PreciseBall::from(most) * PreciseBall::from(most)
                });
                let by_contact = root(by_contact);
                held.iter().for_each(|held| test[held.node] = [zero; 2]);
                range(reaction.widened(up((rho + self.off) * by_body + pressure * by_contact)))
            });
            (boundary.clone(), ranges)
        };
        let holders = d.constraints.holders();
        if holders.len() > MOST_REACTIONS {
            return BTreeMap::new();
        }
        holders.iter().map(of).collect()
    }
}

/// The largest number of displacement boundaries whose reactions are enclosed: each takes a pass over the body.
const MOST_REACTIONS: usize = 64;

fn range(ball: PreciseBall) -> Range {
    [ball.lower(), ball.upper()]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::contact::EdgeRule;
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Degree, Diagonal, Mesh, Problem, Rectangle};

    #[test]
    fn the_energy_in_doubles_is_within_what_is_said_of_its_rounding_and_not_without_that() {
        let mesh = Rectangle { width: 1.0, height: 1.0, nx: 4, ny: 4, diagonal: Diagonal::Crossed };
        let problem = Problem::of(mesh.mesh().unwrap(), Material::lame(1.3, 0.7, Plane::Strain))
            .with("top", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.0));
        let rule = EdgeRule::Exact;
        let d = Discretization::new(&problem, Degree::Two, |c| c.limit() / 2.0, rule).unwrap();
        let (system, lines) = (System::new(&d).unwrap(), Lines::new(&d));
        let load = vec![[PreciseBall::from(0); 2]; d.space.nodes().len()];
        for k in 0..20 {
            let wave = |[x, y]: [f64; 2]| {
                let (x, y) = (x - 0.3 * f64::from(k), y + 0.1 * f64::from(k));
                [(1.0 - y) * (3.0 * x + y).sin(), 1e-3 * (x - 2.0 * y).cos()]
            };
            let u: Vec<[f64; 2]> = d.space.nodes().iter().map(|x| wave(*x)).collect();
            let [found, exact] = [Arithmetic::Doubles, Arithmetic::Balls].map(|arithmetic| {
                let load = (&load[..], arithmetic);
                let at = EnclosedResidual::new(&system, &lines, (&u, &u), None, load).unwrap();
                (at.energy, at.off)
            });
            let far = |of: PreciseBall| (of - exact.0).magnitude();
            assert!(exact.1 == 0.0 && exact.0.radius() < 1e-25);
            assert!(far(PreciseBall::point(found.0.centre())) <= found.0.radius());
            // Control: it is off by more than the balls of the products are wide.
            assert!(far(PreciseBall::point(found.0.centre())) > 1e-20);
        }
    }

    /// A ring on a floor, from 0.1 to 1.1 off its axis, of so many cells along both sides.
    pub(crate) fn ring(count: usize, top: Condition) -> Problem {
        let (nx, ny, diagonal) = (count, count, Diagonal::Right);
        let mesh = Rectangle { width: 1.0, height: 1.0, nx, ny, diagonal }.mesh().unwrap();
        let named = ["top", "bottom"].map(|name| {
            let ends = mesh.edges_of(name).unwrap().iter().map(|&edge| mesh.ends(edge));
            (name.to_owned(), ends.collect())
        });
        let ring = mesh.vertices().iter().map(|[x, y]| [x + 0.1, *y]).collect();
        let ring = Mesh::new(ring, mesh.triangles().to_vec(), BTreeMap::from(named)).unwrap();
        Problem::of(ring, Material::lame(1.3, 0.7, Plane::Axisymmetric))
            .with("top", top)
            .with("bottom", Condition::contact(|_| 0.0))
    }

    /// Widens a ring as a whole, so that hoops alone are strained.
    #[test]
    fn the_energy_of_hoops_in_doubles_is_within_what_is_said_of_its_rounding() {
        let problem = ring(4, Condition::roller());
        let (mut widest, load) = (0.0_f64, vec![[PreciseBall::from(0); 2]; 81]);
        for degree in [Degree::One, Degree::Two] {
            let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact);
            let d = d.unwrap();
            let (system, lines) = (System::new(&d).unwrap(), Lines::new(&d));
            let load = &load[..d.space.nodes().len()];
            for k in 1..20 {
                let u = vec![[0.1 * f64::from(k), 0.0]; load.len()];
                let [found, exact] = [Arithmetic::Doubles, Arithmetic::Balls].map(|arithmetic| {
                    let of = (load, arithmetic);
                    EnclosedResidual::new(&system, &lines, (&u, &u), None, of).unwrap().energy
                });
                let far = (PreciseBall::point(found.centre()) - exact).magnitude();
                assert!(far <= found.radius(), "{degree:?} {k}: {far:e} {:e}", found.radius());
                widest = widest.max(far / found.radius());
            }
        }
        println!("at most {widest} of what is said");
    }
}
