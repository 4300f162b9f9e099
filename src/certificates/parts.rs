//! A problem and its discrete solution as certificates see them: what every boundary edge prescribes, and the edges of Gamma_C.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;

use super::certificate::{Role, is_oblique};
use super::contact::{Contact, SAME_PLACE, even_out, overlaps, sides};
use super::data::{Traction, bulge_of, is_within};
use super::errors::CertifyError;
use super::field::Field;
use crate::contact::{Friction, Law as ContactLaw, Pair, Piece};
use crate::kernel::Material;
use crate::model::boundary_normals::SmoothBoundary;
use crate::model::constraints::Constraints;
use crate::model::{
    BoundaryEdge, Condition, Degree, Mesh, Obstacle, Problem, SharedFunction, Space,
};
use crate::quote::{self, quoted};

/// The condition on a boundary edge.
#[derive(Clone, Copy)]
pub(super) enum Boundary<'a> {
    /// The components that are held, and what they are in the middle beyond the mean of the ends.
    Held([bool; 2], [f64; 2]),
    /// The direction that is held alone, and what the displacement along it is in the middle beyond the mean of the ends; the
    /// traction, if there is one, of which the component across the direction acts.
    Supported([f64; 2], f64, Option<Traction<'a>>),
    /// The traction.
    Loaded(Traction<'a>),
    /// Nothing: traction 0.
    Free,
    /// Gamma_C, and which of its edges, by its place in [`ProblemParts::lines`].
    Contact(usize),
}

/// The contacts on an edge, with their sides that lie on the edge: one, or those of pairs.
pub(super) type OnLine = Vec<(usize, usize)>;

/// The parts of a problem that certificates are made from.
pub(super) struct ProblemParts<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) mesh: &'a Mesh,
    /// Gamma_C.
    pub(crate) contact: Vec<Contact>,
    /// The edges that contacts lie on.
    pub(crate) lines: Vec<OnLine>,
    /// The pieces of tied bodies, with their jumps alone.
    pub(crate) tied: Vec<Piece>,
    /// u_D at the vertices.
    pub(crate) prescribed: Vec<[Option<f64>; 2]>,
    /// The vertices that are held along an oblique direction alone, and this: what is prescribed there is along it.
    pub(crate) frames: BTreeMap<usize, [f64; 2]>,
    /// The conditions on boundary edges, by their numbers in the mesh.
    pub(crate) boundary: BTreeMap<usize, Boundary<'a>>,
    /// Where edges without a traction are cut, by their numbers in the certificate.
    pub(crate) cuts: BTreeMap<usize, f64>,
}

impl<'a> ProblemParts<'a> {
    /// `halved` tells whether v is quadratic beside a solution that is.
    ///
    /// # Errors
    /// Conditions that no composite stress can satisfy.
    pub(crate) fn new(
        problem: &'a Problem,
        degree: Degree,
        pieces: &[Piece],
        (displacement, halved): (&[[f64; 2]], bool),
    ) -> Result<Self, CertifyError> {
        let space = Space::new(&problem.mesh, degree);
        let constraints = Constraints::new(problem, &space)?;
        let contact = contacts(problem, pieces, displacement, halved);
        if let Some(point) = problem.points.first() {
            let name = quote::key(&point.name);
            let why = format!("[point.{name}] holds a point, which a true solution does not feel");
            return Err(CertifyError::Unsupported(why));
        }
        let mesh = &problem.mesh;
        let directions = SupportDirections { known: Vec::new(), rounding: constraints.rounding() };
        let mut supports = Conditions { mesh, smooth: None, directions };
        let mut boundary: BTreeMap<usize, Boundary> =
            mesh.outline().iter().map(|&edge| (mesh.number_of(edge), Boundary::Free)).collect();
        for (name, condition) in &problem.conditions {
            // The names were found when the problem was discretised.
            for &edge in mesh.edges_of(name).unwrap_or_default() {
                if let Some(what) = supports.on_edge(name, condition, edge)? {
                    boundary.insert(mesh.number_of(edge), what);
                }
            }
        }
        let lines = lines(mesh, &contact, &mut boundary);
        let vertices = mesh.vertices().len();
        let mut prescribed = constraints.values()[..vertices].to_vec();
        let mut frames = BTreeMap::new();
        for (&vertex, &d) in constraints.frames().range(..vertices) {
            let d = supports.directions.one_like(d);
            if is_oblique(d) {
                frames.insert(vertex, d);
            } else {
                let along = prescribed[vertex][0];
                prescribed[vertex] = d.map(|d| along.filter(|_| d != 0.0).map(|w| d * w));
            }
        }
        let cuts = BTreeMap::new();
        let tied = pieces
            .iter()
            .filter(|piece| matches!(piece.geometry.law, ContactLaw::Sliding | ContactLaw::Bonded));
        let tied = tied.map(Piece::of_jumps).collect();
        let parts = ProblemParts {
            problem,
            mesh,
            contact,
            lines,
            tied,
            prescribed,
            frames,
            boundary,
            cuts,
        };
        parts.check_overlaps()?;
        parts.check_directions()?;
        Ok(parts)
    }

    /// The role of the part of edge `e` of the mesh from s to t, in units of it, between these places, as the data say: without
    /// the tractions of tau. Beside it the bulge of the data there, which a v that is `quadratic` follows.
    pub(crate) fn role_on(
        &self,
        e: usize,
        ([s, t], places): ([f64; 2], [[f64; 2]; 2]),
        quadratic: bool,
    ) -> (Role, [f64; 2]) {
        let none = [[0.0; 2]; 2];
        let of_part = |bulge: f64| (t - s) * (t - s) * bulge;
        match self.boundary.get(&e) {
            None => (Role::Inner(none), [0.0; 2]),
            Some(Boundary::Free) => (Role::Loaded(none), [0.0; 2]),
            Some(Boundary::Loaded(traction)) => (traction.affine(places), [0.0; 2]),
            Some(&Boundary::Held(held, bulge)) => (Role::Held(held, none), bulge.map(of_part)),
            Some(&Boundary::Supported(along, bulge, traction)) => {
                let traction = traction.map_or([0.0; 2], |traction| traction.across(along, places));
                (Role::Supported { along, force: [0.0; 2], traction }, [of_part(bulge), 0.0])
            }
            Some(&Boundary::Contact(line)) => {
                let Some((k, i)) = self.contact_at(line, (s + t) / 2.0) else {
                    return (Role::Loaded(none), [0.0; 2]);
                };
                if i > 0 {
                    return (Role::Facing, [0.0; 2]);
                }
                let edge = &self.contact[k];
                let [s, t] = [s, t].map(|x| edge.sides[i].within(x));
                let between = |[p, q]: [f64; 2], bulge: f64| {
                    [s, t].map(|s| (1.0 - s) * p + s * q + 4.0 * s * (1.0 - s) * bulge)
                };
                let gap = between(edge.gap, if quadratic { edge.gap_bulge } else { 0.0 });
                let along = edge.along().map(|[d, e]| {
                    if d == e {
                        return [d, e];
                    }
                    let [x, y] = [0, 1].map(|c| between([d[c], e[c]], 0.0));
                    [0, 1].map(|k| [x[k], y[k]])
                });
                let law = edge.law_between([s, t]);
                let role = Role::Contact { pressure: [0.0; 2], gap, along, law };
                (role, [edge.gap_bulge, edge.offset.1].map(|b| b * (t - s) * (t - s)))
            }
        }
    }

    /// The contact that has place `x` of an edge inside, and its side there.
    pub(crate) fn contact_at(&self, line: usize, x: f64) -> Option<(usize, usize)> {
        self.lines[line].iter().copied().find(|&(k, i)| self.contact[k].sides[i].has(x))
    }

    /// The places inside an edge where what acts on it changes.
    pub(crate) fn breaks(&self, e: usize) -> Vec<f64> {
        let Some(&Boundary::Contact(line)) = self.boundary.get(&e) else { return Vec::new() };
        let contacts = self.lines[line].iter();
        let of = |&(k, i): &(usize, usize)| {
            let edge = &self.contact[k];
            edge.parts.iter().flat_map(|part| part.ends).map(move |s| edge.sides[i].place(s))
        };
        let mut all: Vec<f64> = contacts.flat_map(of).filter(|&x| 0.0 < x && x < 1.0).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| *a - *b <= SAME_PLACE);
        all
    }

    /// No part of an edge faces two others.
    fn check_overlaps(&self) -> Result<(), CertifyError> {
        for line in &self.lines {
            let of = |&(k, i): &(usize, usize)| (&self.contact[k].sides[i], k);
            let all = line.iter().map(of).collect();
            if let Some(([(_, k), _], _)) = overlaps(all).find(|(_, by)| *by > SAME_PLACE) {
                let boundary = quoted(&self.contact[k].boundary, '\'');
                return Err(CertifyError::Unsupported(format!(
                    "a part of an edge faces two others, on {boundary} or the boundary that it is a pair with"
                )));
            }
        }
        Ok(())
    }

    /// At the ends of an edge that is held along a direction the same one is, or all of the displacement.
    fn check_directions(&self) -> Result<(), CertifyError> {
        for (name, condition) in &self.problem.conditions {
            if !matches!(condition, Condition::Support { .. }) {
                continue;
            }
            for &edge in self.mesh.edges_of(name).unwrap_or_default() {
                let e = self.mesh.number_of(edge);
                let Some(Boundary::Supported(d, ..)) = self.boundary.get(&e) else { continue };
                let is_held = |vertex: usize| match self.frames.get(&vertex) {
                    Some(frame) => frame == d,
                    None => self.prescribed[vertex].iter().all(Option::is_some),
                };
                if !self.mesh.ends(edge).into_iter().all(is_held) {
                    let name = quoted(name, '\'');
                    let why = format!("the direction that the support of {name} holds turns");
                    return Err(CertifyError::Unsupported(why));
                }
            }
        }
        Ok(())
    }

    /// Gives v the bulges of u_D on Gamma_D.
    pub(crate) fn hold_between(&self, bulges: &mut [[f64; 2]]) {
        for (&e, what) in &self.boundary {
            match *what {
                Boundary::Held(held, data) => {
                    (0..2).filter(|&c| held[c]).for_each(|c| bulges[e][c] = data[c]);
                }
                Boundary::Supported(d, data, _) => bulges[e] = held_along(d, data, bulges[e]),
                _ => {}
            }
        }
    }

    /// The direction that is held at a vertex, if one is alone, and the displacement along it.
    pub(crate) fn held_alone(&self, vertex: usize) -> Option<([f64; 2], f64)> {
        match (self.frames.get(&vertex), self.prescribed[vertex]) {
            (Some(&d), [Some(w), _]) => Some((d, w)),
            (None, [Some(w), None]) => Some(([1.0, 0.0], w)),
            (None, [None, Some(w)]) => Some(([0.0, 1.0], w)),
            _ => None,
        }
    }

    /// The largest |w - u_D| for a field w, at the vertices of Gamma_D and in the middles of its edges, in the components that
    /// are held.
    pub(crate) fn missed(&self, w: &Field) -> f64 {
        let along = |d: [f64; 2], u: [f64; 2], given: f64| {
            (u[0] * d[0] + u[1] * d[1] - given).abs() / d[0].hypot(d[1])
        };
        let at_vertex = |(vertex, &w): (usize, &[f64; 2])| {
            if let Some((d, given)) = self.held_alone(vertex) {
                return along(d, w, given);
            }
            let off = |c: usize| self.prescribed[vertex][c].map_or(0.0, |u| (w[c] - u).abs());
            off(0).max(off(1))
        };
        let between = |(&e, what): (&usize, &Boundary)| {
            let bulge = w.bulges.as_ref().map_or([0.0; 2], |bulges| bulges[e]);
            match *what {
                Boundary::Held(held, data) => (0..2)
                    .map(|c| if held[c] { (bulge[c] - data[c]).abs() } else { 0.0 })
                    .fold(0.0, f64::max),
                Boundary::Supported(d, data, _) => along(d, bulge, data),
                _ => 0.0,
            }
        };
        let at_vertices = w.vertices.iter().enumerate().map(at_vertex);
        at_vertices.chain(self.boundary.iter().map(between)).fold(0.0, f64::max)
    }

    /// The motions that v may make at a vertex.
    pub(crate) fn free_at(&self, vertex: usize) -> Free {
        match (self.held_alone(vertex), self.prescribed[vertex]) {
            (Some((d, _)), _) => Free::Along(Vector2::new(-d[1], d[0])),
            (None, [None, None]) => Free::All,
            (None, _) => Free::Nothing,
        }
    }

    /// The contact boundaries whose direction turns along an edge, so that it and the gap are known at vertices only.
    pub(crate) fn turning(&self) -> BTreeSet<&str> {
        let turning = self.contact.iter().filter(|edge| edge.turns());
        turning.map(|edge| &*edge.boundary).collect()
    }

    /// The first boundaries of pairs on which nodes that nearly face each other are taken to do so.
    pub(crate) fn moved(&self) -> BTreeSet<&str> {
        let moved = self.contact.iter().filter(|c| c.sides.iter().any(|side| side.moved));
        moved.map(|contact| &*contact.boundary).collect()
    }

    /// The boundaries whose bound of friction is not known to be affine.
    pub(crate) fn rough(&self) -> BTreeSet<&str> {
        let of_pair = |pair: &'a Pair| Some((&pair.boundaries[0], pair.friction.as_ref()?));
        let all = self.problem.friction.iter().chain(self.problem.pairs.iter().filter_map(of_pair));
        let is_rough = |friction: &Friction| matches!(friction, Friction::Tresca(bound) if !is_within(bound, 1));
        all.filter(|(_, friction)| is_rough(friction)).map(|(name, _)| name.as_str()).collect()
    }

    /// The contact boundaries of which direction and gap are known at the nodes only: those that turn, and those whose obstacle is
    /// neither a plane nor a distance that is affine by its expression, and pairs whose clearance a v that is `quadratic`, or affine,
    /// does not follow.
    pub(crate) fn known_at_nodes(&self, quadratic: bool) -> BTreeSet<&str> {
        let curved = self.problem.conditions.iter().filter(|(_, condition)| is_curved(condition));
        let curved = curved.map(|(name, _)| name.as_str());
        let inexact = |pair: &&Pair| {
            let degree = if quadratic { 2 } else { 1 };
            pair.clearance.as_ref().is_some_and(|clearance| !is_within(clearance, degree))
        };
        let of_pairs = self.problem.pairs.iter().filter(inexact);
        let of_pairs = of_pairs.map(|pair| pair.boundaries[0].as_str());
        self.turning().into_iter().chain(curved).chain(of_pairs).collect()
    }

    /// The material of triangle `t`.
    pub(crate) fn material(&self, t: usize) -> &Material<f64> {
        self.problem.material.of(t)
    }
}

/// Gamma_C, from the pieces of the discrete solution; what has no length on an edge is left to its neighbours.
fn contacts(problem: &Problem, pieces: &[Piece], u: &[[f64; 2]], halved: bool) -> Vec<Contact> {
    let mut contact: Vec<Contact> = Vec::with_capacity(pieces.len());
    let mut left_out = None;
    for of_piece in pieces.iter().zip(sides(&problem.mesh, pieces)) {
        let mut next = Contact::new(problem, of_piece, u, halved);
        let last = contact.last_mut();
        if !next.has_length() {
            last.into_iter().for_each(|last| last.take_over(&mut next, 1));
            left_out = Some(next);
            continue;
        }
        left_out.take().iter_mut().for_each(|before| next.take_over(before, 0));
        last.into_iter().for_each(|last| next.join(&problem.mesh, last));
        contact.push(next);
    }
    even_out(&mut contact);
    contact
}

/// The edges that contacts lie on, which become those of `boundary`.
fn lines(
    mesh: &Mesh,
    contact: &[Contact],
    boundary: &mut BTreeMap<usize, Boundary>,
) -> Vec<OnLine> {
    let mut lines: Vec<OnLine> = Vec::new();
    for (k, edge) in contact.iter().enumerate() {
        for (i, side) in edge.sides.iter().enumerate() {
            let e = mesh.number_of(side.edge);
            let line = match boundary.get(&e) {
                Some(&Boundary::Contact(line)) => line,
                _ => {
                    lines.push(Vec::new());
                    lines.len() - 1
                }
            };
            lines[line].push((k, i));
            boundary.insert(e, Boundary::Contact(line));
        }
    }
    lines
}

/// The conditions of a problem on its edges, with what is known of supports so far.
struct Conditions<'a> {
    mesh: &'a Mesh,
    smooth: Option<SmoothBoundary>,
    directions: SupportDirections,
}

impl<'a> Conditions<'a> {
    /// The condition of the boundary `name` on an edge; none of contact.
    fn on_edge(
        &mut self,
        name: &str,
        condition: &'a Condition,
        edge: BoundaryEdge,
    ) -> Result<Option<Boundary<'a>>, CertifyError> {
        let ends = self.mesh.ends(edge).map(|vertex| self.mesh.vertices()[vertex]);
        let bulge = |f: &Option<SharedFunction>| f.as_ref().map_or(0.0, |f| bulge_of(f, ends));
        let what = match condition {
            Condition::Displacement(functions) => {
                Boundary::Held(is_some(functions), functions.each_ref().map(bulge))
            }
            Condition::Mixed { displacement, traction } => {
                let bulges = displacement.each_ref().map(bulge);
                let beside = |c: usize| Some(Traction::Component(c, &traction[c]));
                match is_some(displacement) {
                    [false, false] => Boundary::Loaded(Traction::Vector(traction)),
                    [true, false] if !vanishes(&traction[1]) => {
                        Boundary::Supported([1.0, 0.0], bulges[0], beside(1))
                    }
                    [false, true] if !vanishes(&traction[0]) => {
                        Boundary::Supported([0.0, 1.0], bulges[1], beside(0))
                    }
                    held => Boundary::Held(held, bulges),
                }
            }
            Condition::Support { normal, tangential } => {
                self.support(name, [normal.as_ref(), tangential.as_ref()], edge)?
            }
            Condition::Traction(traction) => Boundary::Loaded(Traction::Vector(traction)),
            Condition::Pressure(p) => Boundary::Loaded(Traction::Pressure(p)),
            Condition::Contact { .. } | Condition::Obstacle(..) => return Ok(None),
        };
        Ok(Some(match what {
            Boundary::Held([false, false], _) => Boundary::Free,
            what => what,
        }))
    }

    /// The condition of a support on an edge, along its normal and along its tangent.
    fn support(
        &mut self,
        name: &str,
        [normal, tangential]: [Option<&SharedFunction>; 2],
        edge: BoundaryEdge,
    ) -> Result<Boundary<'a>, CertifyError> {
        let mesh = self.mesh;
        let ends = mesh.ends(edge).map(|vertex| mesh.vertices()[vertex]);
        let smooth = self.smooth.get_or_insert_with(|| SmoothBoundary::new(mesh));
        let is_curved = smooth.at_ends(edge).is_some();
        let refused = |why: &str| {
            let name = quoted(name, '\'');
            Err(CertifyError::Unsupported(format!("{name} is curved, and {why}")))
        };
        if is_curved && ![normal, tangential].into_iter().flatten().all(vanishes) {
            return refused("what its support prescribes turns with it");
        }
        let n = <[f64; 2]>::from(mesh.length_and_normal(edge).1);
        let t = [-n[1], n[0]];
        let (f, d) = match (normal, tangential) {
            (Some(along), Some(across)) => {
                let [along, across] = [along, across].map(|f| bulge_of(f, ends));
                let both = [0, 1].map(|c| n[c] * along + t[c] * across);
                return Ok(Boundary::Held([true; 2], both));
            }
            (None, None) => return Ok(Boundary::Free),
            (Some(f), None) => (f, n),
            (None, Some(f)) => (f, t),
        };
        if is_curved {
            return refused("the direction that its support holds turns");
        }
        let d = self.directions.one_like(d);
        let bulge = bulge_of(f, ends);
        Ok(if is_oblique(d) {
            Boundary::Supported(d, bulge, None)
        } else {
            Boundary::Held(d.map(|d| d != 0.0), d.map(|d| d * bulge))
        })
    }
}

/// The motions that a vertex may make.
#[derive(Clone, Copy)]
pub(super) enum Free {
    All,
    /// Along a vector near a unit one.
    Along(Vector2<f64>),
    Nothing,
}

/// The directions of supports, of which those that differ by the rounding of vertices are one: an axis, if one of them is.
struct SupportDirections {
    known: Vec<[f64; 2]>,
    rounding: f64,
}

impl SupportDirections {
    fn one_like(&mut self, d: [f64; 2]) -> [f64; 2] {
        let rounding = self.rounding.max(4.0 * f64::EPSILON);
        if let Some(c) = d.iter().position(|x| x.abs() <= rounding) {
            let mut axis = [0.0; 2];
            axis[1 - c] = d[1 - c].signum();
            return axis;
        }
        let near = |other: &&[f64; 2]| (0..2).all(|c| (other[c] - d[c]).abs() <= rounding);
        let found = self.known.iter().find(near).copied();
        found.unwrap_or_else(|| {
            self.known.push(d);
            d
        })
    }
}

/// The vector nearest to v with v . d = w; along an axis it has that component.
pub(super) fn held_along(d: [f64; 2], w: f64, v: [f64; 2]) -> [f64; 2] {
    let beyond = (v[0] * d[0] + v[1] * d[1] - w) / (d[0] * d[0] + d[1] * d[1]);
    [0, 1].map(|c| if d[1 - c] == 0.0 { d[c] * w } else { v[c] - beyond * d[c] })
}

/// Which components are given.
fn is_some(functions: &[Option<SharedFunction>; 2]) -> [bool; 2] {
    functions.each_ref().map(Option::is_some)
}

/// Returns whether an obstacle's distance is not known to be affine.
pub(super) fn is_curved(condition: &Condition) -> bool {
    match condition {
        Condition::Obstacle(_, Obstacle::Plane { .. }) => false,
        Condition::Obstacle(_, Obstacle::Distance(distance)) => {
            distance.degree().is_none_or(|degree| degree > 1)
        }
        Condition::Obstacle(..) => true,
        _ => false,
    }
}

/// The function is 0, and known to be.
fn vanishes(f: &SharedFunction) -> bool {
    f.degree() == Some(0) && f.at([0.0; 2]) == 0.0
}
