//! A certificate whose triangles are in equilibrium: its conditions are verified, and its tractions are those of the file and the
//! small ones of `audit::balance`.

use nalgebra::Vector2;

use super::balance::{self, Tree, Unbalanced};
use super::certificate::{Certificate, Owner, Piece, Role, Shape, exactly, support};
use super::checks::{Rejection, wrong};
use super::on_contact::{OnEdge, along_directions, along_the_normal};
use crate::kernel::composite::{Affine, Composite, Frame, Loads};
use crate::kernel::{Enclosing, Triangle};

/// How the triangles of a certificate hang together.
pub struct Topology {
    /// The triangles of each edge.
    pub owners: Vec<[Option<Owner>; 2]>,
    tree: Tree,
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
    /// tau N on the edges of each triangle towards its outside, in equilibrium.
    pub outward: Vec<[[Vector2<S>; 2]; 3]>,
    /// 2 int tau_n (v_n - g) over the edges of each triangle.
    pub on_contact: Vec<S>,
}

impl Certificate {
    /// How triangles and edges hang together.
    pub fn topology(&self) -> Result<Topology, Rejection> {
        self.check_shape()?;
        let owners = self.owners()?;
        Ok(Topology { tree: Tree::new(self, &owners), owners })
    }

    /// Checks all other conditions and puts the triangles in equilibrium.
    pub fn balanced<S: Enclosing>(&self, topology: Topology) -> Result<Balanced<S>, Rejection> {
        let points: Vec<Vector2<S>> = self.places();
        let v = self.shape();
        let triangles = self.triangles(&points)?;
        self.check_displacement()?;
        let mut forces = Vec::with_capacity(self.edges.len());
        let mut on_contact = vec![S::from(0); self.pieces.len()];
        for (e, edge) in self.edges.iter().enumerate() {
            let [start, end] = edge.ends.map(|vertex| points[vertex]);
            let along = end - start;
            let normal = Vector2::new(along[1], -along[0]);
            let length = || along.dot(&along).sqrt();
            forces.push(match edge.role {
                Role::Inner(force) | Role::Held(_, force) => force.map(exactly),
                Role::Supported { along, force, traction } => {
                    support(along, force, traction, length)
                }
                Role::Loaded(traction) if traction == [[0.0; 2]; 2] => [Vector2::zeros(); 2],
                Role::Loaded(traction) => {
                    let length = length();
                    traction.map(|t| exactly(t) * length)
                }
                Role::Pressed(p) => p.map(|p| -(normal * S::exactly(p))),
                Role::Contact { pressure, gap, along } => {
                    if let Some(&value) = pressure.iter().find(|p| !p.is_at_most(0.0)) {
                        return Err(Rejection::Tension { edge: e, value });
                    }
                    let shape = OnEdge {
                        v: edge.ends.map(|vertex| v.points[vertex]),
                        gap,
                        bulges: self
                            .curved
                            .as_ref()
                            .map(|curved| (exactly(curved.bulges[e]), curved.data[e][0])),
                    };
                    let contact = match along {
                        None => along_the_normal(&shape, normal, pressure, length),
                        Some([a, b]) if a != b && pressure[0] != pressure[1] => {
                            return Err(wrong(
                                "edge",
                                e,
                                "a pressure that varies along a direction that turns",
                            ));
                        }
                        Some(along) => {
                            along_directions(&shape, along.map(exactly), pressure, length())
                        }
                    };
                    if let Some(value) = contact.beyond.into_iter().find(|b| !b.is_at_most(0.0)) {
                        return Err(Rejection::Penetration { edge: e, value: value.upper() });
                    }
                    if let Some(owner) = topology.owners[e][0] {
                        on_contact[owner.piece] += contact.term;
                    }
                    contact.force
                }
            });
        }
        let mut state =
            Balanced { points, triangles, v, topology, forces, outward: Vec::new(), on_contact };
        state.close(self)?;
        Ok(state)
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
        self.outward.clear();
        let mut wrenches = Vec::with_capacity(count);
        for t in 0..count {
            let loads = self.loads_as_given(certificate, t);
            wrenches.push(loads.resultant(&self.triangles[t]));
            self.outward.push(loads.forces);
        }
        let Balanced { points, topology: Topology { owners, tree }, outward, .. } = self;
        balance::close(certificate, tree, owners, points, &mut wrenches, outward)
    }

    /// The forces on triangle `t` towards its outside, and its body force.
    pub fn loads_as_given(&self, certificate: &Certificate, t: usize) -> Loads<S> {
        let piece = &certificate.pieces[t];
        let outward = piece.edges.map(|e| {
            let [a, b] = self.forces[e];
            match self.topology.owners[e][0] {
                Some(owner) if owner.piece == t => [a, b],
                _ => [-b, -a],
            }
        });
        Loads { forces: outward, body: piece.body.map(exactly) }
    }

    /// C eps(v) and C eps(v) - tau on triangle `t`.
    pub fn stresses(&self, certificate: &Certificate, t: usize) -> (Affine<S>, Composite<S>) {
        let piece = &certificate.pieces[t];
        if !piece.is_bent() {
            return self.without_bending(certificate, t);
        }
        let (frame, loads) = self.loads(piece, t);
        let sigma = self.v.stress(piece, &self.triangles[t]);
        let tau = Composite::new(&frame, &loads).bent(&frame, &loads.body);
        (sigma, tau.distance_from(&sigma))
    }

    /// The same without what a load that is not constant bends tau by.
    pub fn without_bending(
        &self,
        certificate: &Certificate,
        t: usize,
    ) -> (Affine<S>, Composite<S>) {
        let piece = &certificate.pieces[t];
        let (frame, loads) = self.loads(piece, t);
        let sigma = self.v.stress(piece, &self.triangles[t]);
        (sigma, Composite::new(&frame, &loads).distance_from(&sigma))
    }

    fn loads(&self, piece: &Piece, t: usize) -> (Frame<S>, Loads<S>) {
        let loads = Loads { forces: self.outward[t], body: piece.body.map(exactly) };
        (Frame::new(&self.triangles[t]), loads)
    }
}

impl Balanced<f64> {
    /// Gives the edges of the certificate the tractions that balance.
    pub fn give(&self, certificate: &mut Certificate) {
        for (edge, owner) in certificate.edges.iter_mut().zip(&self.topology.owners) {
            let Some(Owner { piece, local }) = owner[0] else { continue };
            let outward = self.outward[piece][local];
            match &mut edge.role {
                Role::Inner(force) | Role::Held(_, force) => *force = outward.map(Into::into),
                Role::Supported { along, force, .. } => {
                    let d = Vector2::from(*along);
                    *force = outward.map(|f| f.dot(&d) / d.dot(&d));
                }
                Role::Loaded(_) | Role::Pressed(_) | Role::Contact { .. } => {}
            }
        }
    }

    /// The same with the forces that the certificate has now on edges between triangles and of Gamma_D.
    pub fn rebalance(&mut self, certificate: &Certificate) -> Result<(), Unbalanced> {
        for (force, edge) in self.forces.iter_mut().zip(&certificate.edges) {
            match edge.role {
                Role::Inner(now) | Role::Held(_, now) => *force = now.map(Into::into),
                Role::Supported { along, force: now, traction } => {
                    let [start, end] = edge.ends.map(|p| self.points[p]);
                    let edge = end - start;
                    *force = support(along, now, traction, || edge.x.hypot(edge.y));
                }
                Role::Loaded(_) | Role::Pressed(_) | Role::Contact { .. } => {}
            }
        }
        self.close(certificate)
    }
}
