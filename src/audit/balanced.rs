//! A certificate whose triangles are in equilibrium: its conditions are verified, and its tractions are those of the file and the
//! small ones of `audit::balance`.

use nalgebra::Vector2;

use super::balance::{Change, Closed, OnEdges, SpanningTree, Unbalanced};
use super::certificate::{
    Certificate, Edge, Law, Owners, Piece, Role, Shape, exactly, opposite, support, turned,
};
use super::checks::{Rejection, VARIES, wrong};
use super::forces::along;
use super::on_contact::{OnContact, OnEdge, along_directions, along_the_normal};
use crate::kernel::composite::{Affine, Composite, Frame, Loads, Wrench};
use crate::kernel::{Ball, Enclosing, Triangle};

/// The topology of a certificate's triangles.
#[derive(Clone)]
pub struct Topology {
    /// The triangles of each edge.
    pub owners: Owners,
    pub(crate) tree: SpanningTree,
}

/// An upper bound of 2 int s |x| + q x over an edge, for x with these Bernstein coefficients times its length: |x| is at most the function
/// with the absolute values of them.
pub(super) fn friction<S: Enclosing>(across: [S; 4], shear: [f64; 2], bound: [f64; 2]) -> S {
    let mut sum = S::from(0);
    for (i, slip) in across.into_iter().enumerate() {
        let size = S::exactly(slip.upper().max(-slip.lower()));
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
    pub triangles: Vec<Triangle<S>>,
    pub v: Shape<S>,
    pub topology: Topology,
    /// tau N on the edges as the certificate has it.
    pub forces: Vec<[Vector2<S>; 2]>,
    /// The force and the moment about its centroid by which these and the body force leave each triangle out of balance.
    pub(crate) resultants: Vec<Wrench<S>>,
    /// tau N on the edges in equilibrium.
    pub(crate) in_balance: Vec<[Vector2<S>; 2]>,
    /// Corrections that equilibrium needs beside tractions.
    pub(crate) closed: Closed<S>,
    /// 2 int tau_n (v_n - g) over the edges of each triangle.
    pub on_contact: Vec<S>,
}

impl Certificate {
    /// The topology of triangles and edges.
    pub fn topology(&self) -> Result<Topology, Rejection> {
        self.check_shape()?;
        let owners = self.owners()?;
        Ok(Topology { tree: SpanningTree::new(self, &owners), owners })
    }

    /// Checks all other conditions and puts the triangles in equilibrium.
    pub fn balanced<S: Enclosing>(&self, topology: Topology) -> Result<Balanced<S>, Rejection> {
        let points: Vec<Vector2<S>> = self.places();
        let triangles = self.triangles(&points)?;
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
        let mut forces: Vec<_> = (0..self.edges.len()).map(|e| self.force(e, &points)).collect();
        self.face(&mut forces);
        let (resultants, in_balance) = (Vec::new(), Vec::new());
        let closed = Closed { added: Vec::new(), changes: Vec::new(), stops: Vec::new() };
        let mut state = Balanced {
            points,
            triangles,
            v,
            topology,
            forces,
            resultants,
            in_balance,
            closed,
            on_contact,
        };
        state.close(self)?;
        for &Change { edge, factors } in &state.closed.changes {
            let Role::Contact { pressure, .. } = self.edges[edge].role else { continue };
            // p (1 + factor) is no tension.
            if let Some(k) = (0..2).find(|&k| !(-factors[k]).is_at_most(1.0)) {
                return Err(Rejection::Tension { edge, value: pressure[k] });
            }
            let added = [0, 1].map(|k| S::exactly(pressure[k]) * factors[k]);
            let contact = self.on_contact(edge, &state.v, &state.points, added)?;
            if let Some(owner) = state.topology.owners[edge][0] {
                state.on_contact[owner] += contact.term;
            }
        }
        Ok(state)
    }

    /// tau N at both ends of edge `e`, as the certificate has it; of the second body of a pair see `face`.
    pub(super) fn force<S: Enclosing>(&self, e: usize, points: &[Vector2<S>]) -> [Vector2<S>; 2] {
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
            Role::Contact { .. } => self.traction(e, points),
        }
    }

    /// The forces on the second bodies of pairs.
    fn face<S: Enclosing>(&self, forces: &mut [[Vector2<S>; 2]]) {
        for (&e, &other) in &self.facing {
            if self.edges[e].role == Role::Facing {
                forces[e] = opposite(forces[other]);
            }
        }
    }

    /// |E| d at both ends of edge `e` of Gamma_C.
    fn units<S: Enclosing>(&self, e: usize, points: &[Vector2<S>]) -> [Vector2<S>; 2] {
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

    /// tau N at both ends of edge `e` of Gamma_C.
    fn traction<S: Enclosing>(&self, e: usize, points: &[Vector2<S>]) -> [Vector2<S>; 2] {
        let push = self.push(e, points);
        match self.edges[e].role {
            Role::Contact { law, .. } if law.shear() != [0.0; 2] => {
                let units = self.units(e, points);
                let drag = |k: usize| turned(units[k]) * S::exactly(law.shear()[k]);
                [0, 1].map(|k| push[k] + drag(k))
            }
            _ => push,
        }
    }

    /// |E| w . e on edge `e` of Gamma_C, e being d turned to the left, of a displacement with this jump: its Bernstein coefficients.
    pub(super) fn across<S: Enclosing>(
        &self,
        e: usize,
        (w, bulge): ([Vector2<S>; 2], Option<Vector2<S>>),
        points: &[Vector2<S>],
    ) -> [S; 4] {
        let bulge = bulge.unwrap_or_else(Vector2::zeros);
        along(w, bulge, self.units(e, points).map(turned))
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
        let data = self.curved.as_ref().map(|curved| curved.data[e][0]);
        let shape = OnEdge { v, gap, bulges: bulge.zip(data) };
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

    fn triangles<S: Enclosing>(
        &self,
        points: &[Vector2<S>],
    ) -> Result<Vec<Triangle<S>>, Rejection> {
        let triangle = |(t, piece): (usize, &Piece)| {
            let triangle = Triangle { vertices: piece.vertices.map(|p| points[p]) };
            if triangle.double_area().is_positive() {
                Ok(triangle)
            } else {
                Err(Rejection::Orientation { triangle: t })
            }
        };
        self.pieces.iter().enumerate().map(triangle).collect()
    }
}

impl<S: Enclosing> Balanced<S> {
    /// The forces on the triangles from those on the edges, put in equilibrium.
    fn close(&mut self, certificate: &Certificate) -> Result<(), Unbalanced> {
        let count = certificate.pieces.len();
        let mut wrenches = Vec::with_capacity(count);
        for t in 0..count {
            let loads = self.loads_as_given(certificate, t);
            wrenches.push(loads.resultant(&self.triangles[t]));
        }
        self.resultants = wrenches.clone();
        let Balanced { points, topology: Topology { owners, tree }, forces, .. } = self;
        let on_edges = OnEdges { certificate, owners, points, forces: &|e| forces[e] };
        self.closed = on_edges.close(tree, &mut wrenches)?;
        let sum = |(given, added): (&[Vector2<S>; 2], &[Vector2<S>; 2])| {
            [given[0] + added[0], given[1] + added[1]]
        };
        self.in_balance = self.forces.iter().zip(&self.closed.added).map(sum).collect();
        Ok(())
    }

    /// The forces on triangle `t` towards its outside, and its body force.
    pub(crate) fn loads_as_given(&self, certificate: &Certificate, t: usize) -> Loads<S> {
        let piece = &certificate.pieces[t];
        let forces = outward(piece.edges, t, &self.topology, &self.forces);
        Loads { forces, body: piece.body.map(exactly) }
    }

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
        let forces = outward(piece.edges, t, &self.topology, &self.in_balance);
        let mut loads = Loads { forces, body: piece.body.map(exactly) };
        for stop in self.closed.stops.iter().filter(|stop| stop.root == t) {
            (0..2).for_each(|k| loads.forces[0][k] += stop.force[k]);
        }
        loads
    }
}

/// The forces on the edges of triangle `t` towards its outside.
pub(crate) fn outward<S: Enclosing>(
    edges: [usize; 3],
    t: usize,
    topology: &Topology,
    forces: &[[Vector2<S>; 2]],
) -> [[Vector2<S>; 2]; 3] {
    edges.map(|e| {
        let [a, b] = forces[e];
        if topology.owners[e][0] == Some(t) { [a, b] } else { [-b, -a] }
    })
}

impl Balanced<f64> {
    /// Gives the edges of the certificate the tractions that balance.
    pub fn give(&self, certificate: &mut Certificate) {
        for (e, now) in self.in_balance.iter().enumerate() {
            let units = certificate.units(e, &self.points);
            match &mut certificate.edges[e].role {
                Role::Inner(force) | Role::Held(_, force) => *force = now.map(Into::into),
                Role::Supported { along, force, .. } => {
                    let d = Vector2::from(*along);
                    *force = now.map(|f| f.dot(&d) / d.dot(&d));
                }
                Role::Contact { pressure, law, .. } if law.is_tied() => {
                    // Where the direction turns it is one, and so is the work on both ends.
                    let work = [0, 1].map(|k| now[k].dot(&units[k]));
                    let square = [0, 1].map(|k| units[k].dot(&units[k]));
                    if units[0] != units[1] {
                        *pressure = [(work[0] + work[1]) / (square[0] + square[1]); 2];
                        continue;
                    }
                    for k in 0..2 {
                        let unit = units[k];
                        pressure[k] = work[k] / square[k];
                        if let Law::Bonded { shear, .. } = law {
                            shear[k] = now[k].dot(&turned(unit)) / unit.dot(&unit);
                        }
                    }
                }
                Role::Loaded(_) | Role::Pressed(_) | Role::Contact { .. } | Role::Facing => {}
            }
        }
        for &Change { edge, factors } in &self.closed.changes {
            if let Role::Contact { pressure, .. } = &mut certificate.edges[edge].role {
                (0..2).for_each(|k| pressure[k] = (pressure[k] * (1.0 + factors[k])).min(0.0));
            }
        }
    }

    /// Takes over the forces that the certificate has now on edges between triangles and of Gamma_D.
    pub fn rebalance(&mut self, certificate: &Certificate) -> Result<(), Unbalanced> {
        for (e, (force, edge)) in self.forces.iter_mut().zip(&certificate.edges).enumerate() {
            let is_given = match edge.role {
                Role::Contact { law, .. } => !law.is_tied(),
                role => matches!(role, Role::Loaded(_) | Role::Pressed(_) | Role::Facing),
            };
            if !is_given {
                *force = certificate.force(e, &self.points);
            }
        }
        for &Change { edge, factors } in &self.closed.changes {
            (0..2).for_each(|k| self.forces[edge][k] *= 1.0 + factors[k]);
        }
        certificate.face(&mut self.forces);
        self.close(certificate)
    }
}
