//! A certificate whose triangles are in equilibrium: its conditions are verified, and its tractions are those of the file and the
//! small ones of `audit::balance`.

use nalgebra::Vector2;

use super::balance::OnEdges;
pub use super::balance::{Change, Equilibrium, Topology, Unbalanced};
use super::certificate::{
    Certificate, Edge, Law, Piece, Role, Shape, Trace, exactly, opposite, support, turned,
};
use super::checks::{Rejection, VARIES, wrong};
use super::forces::along;
use super::on_contact::{OnContact, OnEdge, along_directions, along_the_normal};
use crate::kernel::composite::{Affine, Composite, Frame, Loads};
use crate::kernel::{Ball, Enclosing, Triangle};

/// An upper bound of 2 int s |x| + q x over an edge, for x with these Bernstein coefficients times its length: |x| is at most the function
/// with the absolute values of them.
pub(super) fn friction<S: Enclosing>(across: [S; 4], shear: [f64; 2], bound: [f64; 2]) -> S {
    let mut sum = S::from(0);
    for (i, slip) in across.into_iter().enumerate() {
        let size = S::exactly(slip.size());
        for (k, weight) in [4 - i as i32, 1 + i as i32].into_iter().enumerate() {
            let both = size * S::exactly(bound[k]) + slip * S::exactly(shear[k]);
            sum += both * S::from(weight);
        }
    }
    sum / S::from(10)
}

/// A certificate whose triangles are in equilibrium, in the numbers `S`.
pub struct Balanced<S> {
    /// Vertices and cuts.
    pub points: Vec<Vector2<S>>,
    /// The triangles.
    pub triangles: Vec<Triangle<S>>,
    /// v
    pub v: Shape<S>,
    /// How triangles and edges hang together.
    pub topology: Topology,
    /// tau N on the edges as the certificate has it.
    pub forces: Vec<[Vector2<S>; 2]>,
    /// tau N in equilibrium, and what that takes.
    pub balance: Equilibrium<S>,
    /// 2 int tau_n (v_n - g) over the edges of each triangle.
    pub on_contact: Vec<S>,
}

impl Certificate {
    /// The topology of triangles and edges.
    pub fn topology(&self) -> Result<Topology, Rejection> {
        self.check_shape()?;
        Ok(Topology::new(self, self.owners()?))
    }

    /// Checks all other conditions and puts the triangles in equilibrium.
    pub fn balanced<S: Enclosing>(&self, topology: Topology) -> Result<Balanced<S>, Rejection> {
        let points: Vec<Vector2<S>> = self.places();
        let triangle = |(t, piece): (usize, &Piece)| {
            let triangle = Triangle { vertices: piece.vertices.map(|p| points[p]) };
            let is_triangle = triangle.double_area().is_positive();
            if is_triangle { Ok(triangle) } else { Err(Rejection::Orientation { triangle: t }) }
        };
        let triangles: Vec<_> =
            self.pieces.iter().enumerate().map(triangle).collect::<Result<_, _>>()?;
        let v = self.shape();
        self.check_displacement()?;
        let mut on_contact = vec![S::from(0); self.pieces.len()];
        for (e, edge) in self.edges.iter().enumerate() {
            let Role::Contact { pressure, law, .. } = edge.role else { continue };
            if law.is_tied() {
                continue;
            }
            if let Some(&value) = pressure.iter().find(|p| !p.is_at_most(0.0)) {
                return Err(Rejection::Tension { edge: e, value });
            }
            let contact = self.on_contact(e, &v, &points, pressure.map(S::exactly))?;
            if let Some(value) = contact.beyond.into_iter().find(|b| !b.is_at_most(0.0)) {
                return Err(Rejection::Penetration { edge: e, value: value.upper() });
            }
            if let Some(owner) = topology.owners[e][0] {
                on_contact[owner] += contact.term;
                if let Law::Friction { shear, bound } = law {
                    let slip = self.across(e, self.jump(e, &v), &points);
                    on_contact[owner] += friction(slip, shear, bound);
                }
            }
        }
        let forces = self.tractions(&points);
        let balance = self.equilibrium((&points, &triangles), &topology, &forces)?;
        for &Change { edge, factors } in &balance.changes {
            let Role::Contact { pressure, .. } = self.edges[edge].role else { continue };
            // p (1 + factor) is no tension.
            if let Some(k) = (0..2).find(|&k| !(-factors[k]).is_at_most(1.0)) {
                return Err(Rejection::Tension { edge, value: pressure[k] });
            }
            let added = [0, 1].map(|k| S::exactly(pressure[k]) * factors[k]);
            let contact = self.on_contact(edge, &v, &points, added)?;
            if let Some(owner) = topology.owners[edge][0] {
                on_contact[owner] += contact.term;
            }
        }
        Ok(Balanced { points, triangles, v, topology, forces, balance, on_contact })
    }

    /// tau N on the edges, as the certificate has it.
    pub fn tractions<S: Enclosing>(&self, points: &[Vector2<S>]) -> Vec<[Vector2<S>; 2]> {
        let mut forces: Vec<_> = (0..self.edges.len()).map(|e| self.force(e, points)).collect();
        self.face(&mut forces);
        forces
    }

    /// Gives the edges of second bodies the opposite of what acts on those of first ones.
    pub fn face<S: Enclosing>(&self, forces: &mut [[Vector2<S>; 2]]) {
        for (&e, &other) in &self.facing {
            if self.edges[e].role == Role::Facing {
                forces[e] = opposite(forces[other]);
            }
        }
    }

    /// Puts the triangles in equilibrium, from these forces on the edges.
    ///
    /// # Errors
    /// A part of the body whose loads nothing balances.
    pub fn equilibrium<S: Enclosing>(
        &self,
        (points, triangles): (&[Vector2<S>], &[Triangle<S>]),
        topology: &Topology,
        forces: &[[Vector2<S>; 2]],
    ) -> Result<Equilibrium<S>, Unbalanced> {
        let resultant = |(t, piece): (usize, &Piece)| {
            loads(piece, t, topology, forces).resultant(&triangles[t])
        };
        let resultants = self.pieces.iter().enumerate().map(resultant).collect();
        OnEdges { certificate: self, topology, points, forces }.close(resultants)
    }

    /// tau N at both ends of edge `e`; on the second body of a pair see `tractions`.
    fn force<S: Enclosing>(&self, e: usize, points: &[Vector2<S>]) -> [Vector2<S>; 2] {
        let edge = &self.edges[e];
        let [start, end] = edge.ends.map(|p| points[p]);
        let along = end - start;
        let length = || along.dot(&along).sqrt();
        match edge.role {
            Role::Inner(force) | Role::Held(_, force) => force.map(exactly),
            Role::Supported { along, force, traction } => support(along, force, traction, length),
            Role::Loaded([[0.0, 0.0], [0.0, 0.0]]) | Role::Facing => [Vector2::zeros(); 2],
            Role::Loaded(traction) => {
                let length = length();
                traction.map(|t| exactly(t) * length)
            }
            Role::Pressed(p) => {
                let normal = Vector2::new(along[1], -along[0]);
                p.map(|p| -(normal * S::exactly(p)))
            }
            Role::Contact { law, .. } => {
                let (push, shear) = (self.push(e, points), law.shear());
                if shear == [0.0; 2] {
                    return push;
                }
                let units = self.units(e, points);
                [0, 1].map(|k| push[k] + turned(units[k]) * S::exactly(shear[k]))
            }
        }
    }

    /// |E| d at both ends of edge `e` of Gamma_C.
    pub fn units<S: Enclosing>(&self, e: usize, points: &[Vector2<S>]) -> [Vector2<S>; 2] {
        let span = self.span(self.edges[e].ends, points);
        match self.edges[e].role {
            Role::Contact { along: Some(d), .. } => {
                let length = span.dot(&span).sqrt();
                d.map(|d| exactly::<S>(d) * length)
            }
            _ => [Vector2::new(span[1], -span[0]); 2],
        }
    }

    /// |E| p d at both ends of edge `e` of Gamma_C, or of the one that faces it.
    pub(super) fn push<S: Enclosing>(&self, e: usize, points: &[Vector2<S>]) -> [Vector2<S>; 2] {
        match (self.edges[e].role, self.facing.get(&e)) {
            (Role::Contact { pressure, .. }, _) => {
                let units = self.units(e, points);
                [0, 1].map(|k| units[k] * S::exactly(pressure[k]))
            }
            (Role::Facing, Some(&first)) if self.edges[first].role != Role::Facing => {
                opposite(self.push(first, points))
            }
            _ => [Vector2::zeros(); 2],
        }
    }

    /// |E| w . e on edge `e` of Gamma_C, e being d turned to the left, of a displacement with this jump: its Bernstein coefficients.
    pub(super) fn across<S: Enclosing>(
        &self,
        e: usize,
        jump: Trace<S>,
        points: &[Vector2<S>],
    ) -> [S; 4] {
        along(jump, self.units(e, points).map(turned))
    }

    /// The edges of Gamma_C on which v can't be shown to be outside the obstacle, each with how far it may be inside.
    pub fn penetrations(&self) -> Vec<(usize, f64)> {
        let (v, points): (Shape<Ball>, Vec<Vector2<Ball>>) = (self.shape(), self.places());
        let inside = |(e, edge): (usize, &Edge)| {
            let Role::Contact { along, law, .. } = edge.role else { return None };
            if law.is_tied() {
                return None;
            }
            let contact = self.on_contact(e, &v, &points, [Ball::from(0); 2]).ok()?;
            let most = contact.beyond.into_iter().map(Ball::upper).fold(0.0, f64::max);
            let span = self.span(edge.ends, &points);
            let unit = if along.is_none() { span.dot(&span).sqrt().lower() } else { 1.0 };
            (most > 0.0).then_some((e, most / unit))
        };
        self.edges.iter().enumerate().filter_map(inside).collect()
    }

    /// Returns what a pressure on edge `e` of Gamma_C does, and v there.
    fn on_contact<S: Enclosing>(
        &self,
        e: usize,
        v: &Shape<S>,
        points: &[Vector2<S>],
        pressure: [S; 2],
    ) -> Result<OnContact<S>, Rejection> {
        let edge = &self.edges[e];
        let Role::Contact { pressure: given, gap, along, law } = edge.role else {
            return Err(wrong("edge", e, "expected one of Gamma_C"));
        };
        let (v, bulge) = self.jump(e, v);
        let bulges = self.curved.as_ref().map(|curved| (bulge, curved.data[e][0]));
        let shape = OnEdge { v, gap, bulges };
        let span = self.span(edge.ends, points);
        let length = || span.dot(&span).sqrt();
        match along {
            None => {
                let normal = Vector2::new(span[1], -span[0]);
                Ok(along_the_normal(&shape, normal, pressure, length))
            }
            Some([a, b]) if a != b && [given, law.shear()].iter().any(|[p, q]| p != q) => {
                Err(wrong("edge", e, VARIES))
            }
            Some([a, b]) => {
                let directions = ([a, b].map(exactly), a != b);
                Ok(along_directions(&shape, directions, pressure, length()))
            }
        }
    }

    /// From one end to the other: between places on one line from vertex to vertex, the part that it is of that line, which is as
    /// sharp for a short part as for a long one.
    fn span<S: Enclosing>(&self, ends: [usize; 2], points: &[Vector2<S>]) -> Vector2<S> {
        let cut = |p: usize| p.checked_sub(self.vertices.len()).map(|cut| self.cuts[cut]);
        let [start, end] = ends;
        if let Some(line) = cut(start).or(cut(end)) {
            let at = |p: usize| match cut(p) {
                Some(cut) if cut.ends == line.ends => Some(S::exactly(cut.at)),
                Some(_) => None,
                None => line.ends.iter().position(|&end| end == p).map(|k| S::from(k as i32)),
            };
            if let (Some(s), Some(t)) = (at(start), at(end)) {
                return (points[line.ends[1]] - points[line.ends[0]]) * (t - s);
            }
        }
        points[end] - points[start]
    }
}

impl<S: Enclosing> Balanced<S> {
    /// C eps(v) and C eps(v) - tau on triangle `t`.
    pub fn stresses(&self, certificate: &Certificate, t: usize) -> (Affine<S>, Composite<S>) {
        let (piece, triangle) = (&certificate.pieces[t], &self.triangles[t]);
        let sigma = self.v.stress(piece, triangle);
        let (frame, loads) = (Frame::new(triangle), self.loads(piece, t));
        let tau = Composite::new(&frame, &loads);
        let tau = if piece.is_bent() { tau.bent(&frame, &loads.body) } else { tau };
        let apart = tau.distance_from(&sigma);
        (sigma, apart)
    }

    /// The forces on triangle `t` towards its outside, in equilibrium, and its body force.
    pub fn loads(&self, piece: &Piece, t: usize) -> Loads<S> {
        let mut loads = loads(piece, t, &self.topology, &self.balance.forces);
        for stop in self.balance.stops.iter().filter(|stop| stop.root == t) {
            (0..2).for_each(|k| loads.forces[0][k] += stop.force[k]);
        }
        loads
    }
}

/// The forces on triangle `t` towards its outside, by those on the edges, and its body force.
fn loads<S: Enclosing>(
    piece: &Piece,
    t: usize,
    topology: &Topology,
    forces: &[[Vector2<S>; 2]],
) -> Loads<S> {
    let forces = outward(piece.edges, t, topology, forces);
    Loads { forces, body: piece.body.map(exactly) }
}

/// The forces on the edges of triangle `t` towards its outside.
pub(crate) fn outward<S: Enclosing>(
    edges: [usize; 3],
    t: usize,
    topology: &Topology,
    forces: &[[Vector2<S>; 2]],
) -> [[Vector2<S>; 2]; 3] {
    edges.map(|e| {
        let is_left = topology.owners[e][0] == Some(t);
        if is_left { forces[e] } else { opposite(forces[e]) }
    })
}
