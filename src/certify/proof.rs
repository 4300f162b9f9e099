//! What proves an error bound, and its evaluation: the checker. It trusts no solver and no linear algebra; it reads
//! numbers, and computes with [`Enclosing`] ones, so that rounding is part of the answer.
//!
//! **Theorem** (docs/theory.md, section 7.3). Let u be the solution of (1)-(2). If v = u_D on Gamma_D and v_n <= g on Gamma_C,
//! and if div tau + f = 0, tau n = t on Gamma_N, tau_t = 0 and tau_n <= 0 on Gamma_C, then
//!
//! |u - v|_a^2 + |sigma(u) - tau|^2_{C^-1} <= |C eps(v) - tau|^2_{C^-1} + 2 int tau_n (v_n - g).
//!
//! A [`Certificate`] holds v by its values at vertices, and tau by its tractions on edges: an edge has one traction, so
//! that tau n is continuous, and on Gamma_C it is a nonpositive multiple of n. What is left is that each triangle is in
//! equilibrium, and there the doubles of a file can't be exact. `certify::balance` therefore adds to the tractions those
//! small ones that make equilibrium exact; they are known as balls, and so is then tau.
//!
//! Contact may also act along a direction d, affine on each edge, in place of n: v . d <= g, and tau n = p d with p <= 0. The
//! theorem holds as it stands, for the solution u of the problem with that d (section 7.2).
//!
//! v is affine on the triangles of the mesh, or quadratic on those of the certificate ([`Curved`]): then it has a vector for each
//! edge, too, the *bulge* by which it is beyond the mean of the edge's ends in the middle. C eps(v) is affine, and v_n - g
//! is known not to be positive where its Bernstein coefficients are not.

use nalgebra::Vector2;
use thiserror::Error;

use super::balance::{self, Tree, Unbalanced};
use crate::kernel::composite::{Affine, Composite, Frame, Loads};
use crate::kernel::contact_edge::integral_of_product;
use crate::kernel::{Ball, Enclosing, Material, Plane, Triangle};

/// v, tau and the problem that they belong to.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// The vertices of the mesh.
    pub vertices: Vec<[f64; 2]>,
    /// Further vertices, numbered after these: each lies on the straight line between two of them.
    pub cuts: Vec<Cut>,
    /// v at the vertices; if it is affine on the triangles of the mesh, at a cut it follows.
    pub displacement: Vec<[f64; 2]>,
    /// What makes v, u_D and g quadratic; `None` where they are affine.
    pub curved: Option<Curved>,
    /// u_D at the vertices of Gamma_D.
    pub prescribed: Vec<[Option<f64>; 2]>,
    /// The triangles.
    pub pieces: Vec<Piece>,
    /// Their edges.
    pub edges: Vec<Edge>,
}

/// v quadratic on the triangles, u_D and g quadratic along edges. A bulge is the value in the middle of an edge less the mean
/// of its ends: 4 s (1 - s) times it is what comes to the affine function.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curved {
    /// v at the cuts.
    pub at_cuts: Vec<[f64; 2]>,
    /// u_D at the cuts on Gamma_D.
    pub prescribed: Vec<[Option<f64>; 2]>,
    /// The bulge of v on each edge.
    pub bulges: Vec<[f64; 2]>,
    /// The bulges of the data on each edge: of u_D on Gamma_D in the components that are held, of g on Gamma_C as the first of two;
    /// all others are 0.
    pub data: Vec<[f64; 2]>,
}

/// The point (1 - at) x_a + at x_b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// a and b.
    pub ends: [usize; 2],
    /// In (0, 1).
    pub at: f64,
}

/// A triangle with what acts in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its vertices, counter-clockwise.
    pub vertices: [usize; 3],
    /// Its edges: edge i lies opposite vertex i.
    pub edges: [usize; 3],
    /// lambda (as it acts in the plane) and mu.
    pub material: [f64; 2],
    /// f at its vertices, affine between them.
    pub body: [[f64; 2]; 3],
    /// What the data of the problem differ from those above: to be added to |C eps(v) - tau|. Zero where nothing does.
    pub oscillation: f64,
}

/// An edge, from its start to its end; the triangle on its left has it in this direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Start and end.
    pub ends: [usize; 2],
    /// What it is, with the traction of tau on it.
    pub role: Role,
}

/// What an edge is. A force is tau N, N = |E| n, towards the right: per unit of the edge's parameter, at start and end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// Between two triangles.
    Inner([[f64; 2]; 2]),
    /// Gamma_D for the components that are held; on the others the force is zero.
    Held([bool; 2], [[f64; 2]; 2]),
    /// Gamma_N: the traction t that is given (a stress, not a force).
    Loaded([[f64; 2]; 2]),
    /// Gamma_N: the pressure p that is given, t = -p n.
    Pressed([f64; 2]),
    /// Gamma_C.
    Contact {
        /// tau_n at both ends.
        pressure: [f64; 2],
        /// g at both ends.
        gap: [f64; 2],
        /// The direction d of contact at both ends, affine between them; `None` is the edge's normal.
        along: Option<[[f64; 2]; 2]>,
    },
}

/// What a certificate proves.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Upper bounds of the share of each triangle in the square of the bound, the contact term of its edges included.
    pub shares: Vec<f64>,
    /// An upper bound of |u - v|_a, where no data oscillate outside the class.
    pub bound: f64,
    /// A lower bound of |v|_a.
    pub norm: f64,
    /// J(v) from below and from above.
    pub energy: [f64; 2],
}

/// What a certificate is said to prove.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// As in [`Proof`].
    pub shares: Vec<f64>,
    /// As in [`Proof`].
    pub bound: f64,
}

/// A triangle may be out of balance by this, in units of the forces on it: the tractions and the sums of a dozen terms,
/// rounded.
const IMBALANCE: f64 = 128.0 * f64::EPSILON;

/// Fields whose distance on a triangle is below this part of the bound, shared out equally, differ by rounding.
const NEGLIGIBLE: f64 = 1e-9;

/// Why a certificate proves nothing.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum Rejection {
    #[error("{what} has {found} entries; expected {expected}")]
    Length { what: &'static str, found: usize, expected: usize },
    #[error("{what} {index}: {problem}")]
    Wrong { what: &'static str, index: usize, problem: &'static str },
    #[error("edge {edge} has tau_n = {value} on Gamma_C; expected no tension")]
    Tension { edge: usize, value: f64 },
    #[error(
        "edge {edge}: v_n - g can't be shown to be <= 0 (a Bernstein coefficient is up to {value}, per unit of length where contact is along the normal)"
    )]
    Penetration { edge: usize, value: f64 },
    #[error("point {point}: v_{} = {found}; expected the prescribed {expected}", ["x", "y"][*component])]
    NotPrescribed { point: usize, component: usize, found: f64, expected: f64 },
    #[error(
        "edge {edge}: in the middle v_{} is {found} beyond the mean of the ends; expected the prescribed {expected}",
        ["x", "y"][*component]
    )]
    NotPrescribedBetween { edge: usize, component: usize, found: f64, expected: f64 },
    #[error("triangle {triangle} is not counter-clockwise, or too flat to tell")]
    Orientation { triangle: usize },
    #[error(transparent)]
    Unbalanced(#[from] Unbalanced),
    #[error(
        "triangle {triangle} is not in equilibrium: its tractions and its body force don't balance to rounding"
    )]
    OutOfBalance { triangle: usize },
    #[error("triangle {triangle} claims the share {claimed}; its data give {found}")]
    Share { triangle: usize, claimed: f64, found: f64 },
    #[error("the claimed bound is {claimed}; the data give {found}")]
    Bound { claimed: f64, found: f64 },
    #[error("the bound is not a finite number")]
    NotFinite,
}

/// The vector with these components.
pub(super) fn exactly<S: Enclosing>(components: [f64; 2]) -> Vector2<S> {
    components.map(S::exactly).into()
}

fn wrong(what: &'static str, index: usize, problem: &'static str) -> Rejection {
    Rejection::Wrong { what, index, problem }
}

impl Certificate {
    /// Verifies every condition of the theorem and evaluates its right side.
    ///
    /// # Errors
    /// The first condition that does not hold, or can't be decided in `S`.
    pub fn evaluate<S: Enclosing>(&self) -> Result<Proof, Rejection> {
        let state = self.balanced::<S>(self.topology()?)?;
        self.sum(&state)
    }

    /// The same as [`Certificate::evaluate`] in [balls](Ball), and more than a proof needs: that the certificate is as it was
    /// made. Its tractions balance on every triangle to the rounding of doubles, its shares are the very numbers that
    /// its data give, and the bound is no smaller.
    ///
    /// # Errors
    /// As [`Certificate::evaluate`]; a triangle that is out of balance; a claim that does not follow.
    pub fn audit(&self, claim: &Claim) -> Result<Proof, Rejection> {
        let state = self.balanced::<Ball>(self.topology()?)?;
        for (t, piece) in self.pieces.iter().enumerate() {
            let loads = state.loads_as_given(self, t);
            let triangle = &state.triangles[t];
            let size = |x: Ball| x.lower().abs().max(x.upper().abs());
            let reach = (0..3)
                .flat_map(|i| <[Ball; 2]>::from(triangle.edge(i)))
                .map(size)
                .fold(0.0, f64::max);
            let area = size(triangle.double_area());
            let forces: f64 = loads.forces.iter().flatten().flatten().copied().map(size).sum();
            let body: f64 = piece.body.iter().flatten().map(|f| f.abs()).sum();
            let allowed = IMBALANCE * (forces + area * body);
            let resultant = loads.resultant(triangle);
            // Places of cuts are not doubles: what their balls leave open may be balance.
            let near = |x: &Ball, most: f64| x.lower() <= most && x.upper() >= -most;
            if !(resultant.force.iter().all(|f| near(f, allowed))
                && near(&resultant.moment, allowed * reach))
            {
                return Err(Rejection::OutOfBalance { triangle: t });
            }
        }
        let proof = self.sum(&state)?;
        if claim.shares.len() != proof.shares.len() {
            let (found, expected) = (claim.shares.len(), proof.shares.len());
            return Err(Rejection::Length { what: "claimed shares", found, expected });
        }
        let same = |a: f64, b: f64| a.to_bits() == b.to_bits();
        for (triangle, (&claimed, &found)) in claim.shares.iter().zip(&proof.shares).enumerate() {
            if !same(claimed, found) {
                return Err(Rejection::Share { triangle, claimed, found });
            }
        }
        if !proof.bound.is_at_most(claim.bound) {
            return Err(Rejection::Bound { claimed: claim.bound, found: proof.bound });
        }
        Ok(proof)
    }

    /// How triangles and edges hang together.
    pub(super) fn topology(&self) -> Result<Topology, Rejection> {
        self.check_shape()?;
        let owners = self.owners()?;
        Ok(Topology { tree: Tree::new(self, &owners), owners })
    }

    /// Checks all other conditions and puts the triangles in equilibrium.
    pub(super) fn balanced<S: Enclosing>(
        &self,
        topology: Topology,
    ) -> Result<Balanced<S>, Rejection> {
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

    /// The root of the right side of the theorem with the strain of another displacement w; what contact adds stays that of v.
    /// `distances` are upper bounds of |v - w|_a on the triangles. Where that is the rounding of their data, the root of the
    /// share grows by it at most, by the triangle inequality, since what contact adds is not negative.
    pub(super) fn bound_at<S: Enclosing>(
        &self,
        state: Balanced<S>,
        proof: &Proof,
        (field, distances): (Shape<S>, &[f64]),
    ) -> f64 {
        let state = Balanced { v: field, ..state };
        let zero = S::from(0);
        let negligible = NEGLIGIBLE * proof.bound / (self.pieces.len() as f64).sqrt();
        let mut sum = zero;
        for (t, (&share, &distance)) in proof.shares.iter().zip(distances).enumerate() {
            sum += if distance <= negligible {
                let root = S::exactly(share).split(|_| zero, |s| s).sqrt() + S::exactly(distance);
                root * root
            } else {
                let (_, apart) = state.stresses(self, t);
                self.share(&state, t, &apart)
            };
        }
        sum.split(|_| zero, |sum| sum).sqrt().upper()
    }

    /// What triangle `t` has of the right side, C eps(v) being that far from tau.
    fn share<S: Enclosing>(&self, state: &Balanced<S>, t: usize, apart: &Composite<S>) -> S {
        let piece = &self.pieces[t];
        let distance = apart.energy(&piece.material(), state.triangles[t].double_area());
        let distance = if piece.oscillation == 0.0 {
            distance
        } else {
            // A sum of squares is not negative, whatever an interval around it says.
            let distance = distance.split(|_| S::from(0), |d| d);
            let root = distance.sqrt() + S::exactly(piece.oscillation);
            root * root
        };
        distance + state.on_contact[t]
    }

    /// The right side of the theorem.
    pub(super) fn sum<S: Enclosing>(&self, state: &Balanced<S>) -> Result<Proof, Rejection> {
        let Balanced { triangles, v, forces, .. } = state;
        let zero = S::from(0);
        let (mut square, mut norm, mut energy) = (zero, zero, zero);
        let mut shares = Vec::with_capacity(self.pieces.len());
        for (t, piece) in self.pieces.iter().enumerate() {
            let material = piece.material();
            let double_area = triangles[t].double_area();
            let nodal = piece.vertices.map(|vertex| v.points[vertex]);
            let (sigma, distance) = state.stresses(self, t);
            let share = self.share(state, t, &distance);
            shares.push(share.upper());
            square += share;
            let internal = sigma.energy(&material, double_area);
            norm += internal;
            // int_T l_i v = |T| / 12 (v_0 + v_1 + v_2 + v_i)
            let total = nodal[0] + nodal[1] + nodal[2];
            let mut work = zero;
            for i in 0..3 {
                work += exactly::<S>(piece.body[i]).dot(&(total + nodal[i]));
            }
            if let Some(bulges) = v.bulges_of(piece) {
                // int_T 4 l_j l_k l_i = |T| / 15, and twice that for l_j and l_k in place of l_i.
                let body = piece.body.map(exactly::<S>);
                let sum = body[0] + body[1] + body[2];
                let fifteenth = S::from(24) / S::from(30);
                for i in 0..3 {
                    work += (sum * S::from(2) - body[i]).dot(&bulges[i]) * fifteenth;
                }
            }
            energy = energy + internal / S::from(2) - work * double_area / S::from(24);
        }
        for (e, edge) in self.edges.iter().enumerate() {
            if let Role::Loaded(_) | Role::Pressed(_) = edge.role {
                let [a, b] = edge.ends.map(|vertex| v.points[vertex]);
                for c in 0..2 {
                    let force = [forces[e][0][c], forces[e][1][c]];
                    energy -= integral_of_product(force, [a[c], b[c]]);
                }
                if let Some(bulges) = &v.bulges {
                    energy -= (forces[e][0] + forces[e][1]).dot(&bulges[e]) / S::from(3);
                }
            }
        }
        let bound = square.split(|_| zero, |s| s).sqrt().upper();
        let norm = norm.split(|_| zero, |n| n).sqrt().lower();
        let proof = Proof { shares, bound, norm, energy: [energy.lower(), energy.upper()] };
        if proof.bound.is_finite() && norm.is_finite() && proof.energy.iter().all(|e| e.is_finite())
        {
            Ok(proof)
        } else {
            Err(Rejection::NotFinite)
        }
    }

    /// The indices name things that exist, and the numbers are finite.
    fn check_shape(&self) -> Result<(), Rejection> {
        let (vertices, points) = (self.vertices.len(), self.vertices.len() + self.cuts.len());
        for (what, found) in
            [("displacement", self.displacement.len()), ("prescribed", self.prescribed.len())]
        {
            if found != vertices {
                return Err(Rejection::Length { what, found, expected: vertices });
            }
        }
        if self.pieces.is_empty() {
            return Err(Rejection::Length { what: "triangles", found: 0, expected: 1 });
        }
        let finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
        for (i, (x, v)) in self.vertices.iter().zip(&self.displacement).enumerate() {
            if !(finite(x) && finite(v)) {
                return Err(wrong("vertex", i, "a number is not finite"));
            }
        }
        if let Some(Curved { at_cuts, prescribed, bulges, data }) = &self.curved {
            if prescribed.len() != self.cuts.len() {
                let (found, expected) = (prescribed.len(), self.cuts.len());
                return Err(Rejection::Length { what: "prescribed at cuts", found, expected });
            }
            for (what, values, expected) in [
                ("v at cuts", at_cuts, self.cuts.len()),
                ("bulges", bulges, self.edges.len()),
                ("bulges of data", data, self.edges.len()),
            ] {
                if values.len() != expected {
                    return Err(Rejection::Length { what, found: values.len(), expected });
                }
                if let Some(i) = values.iter().position(|x| !finite(x)) {
                    return Err(wrong(what, i, "a number is not finite"));
                }
            }
        }
        for (i, cut) in self.cuts.iter().enumerate() {
            if !(0.0 < cut.at && cut.at < 1.0 && cut.ends.iter().all(|&end| end < vertices)) {
                return Err(wrong("cut", i, "expected a place between two vertices"));
            }
        }
        for (i, piece) in self.pieces.iter().enumerate() {
            if !(piece.vertices.iter().all(|&p| p < points)
                && piece.edges.iter().all(|&e| e < self.edges.len()))
            {
                return Err(wrong("triangle", i, "a vertex or an edge does not exist"));
            }
            let [lambda, mu] = piece.material;
            let body = finite(piece.body.as_flattened());
            if !(body
                && lambda.is_finite()
                && mu.is_finite()
                && mu > 0.0
                && (lambda + mu).next_down() > 0.0)
            {
                return Err(wrong(
                    "triangle",
                    i,
                    "expected mu > 0, lambda + mu > 0 and a finite body force",
                ));
            }
            if !(piece.oscillation >= 0.0 && piece.oscillation.is_finite()) {
                return Err(wrong("triangle", i, "expected an oscillation that is not negative"));
            }
        }
        for (i, edge) in self.edges.iter().enumerate() {
            let numbers = match edge.role {
                Role::Inner(f) | Role::Held(_, f) | Role::Loaded(f) => finite(f.as_flattened()),
                Role::Pressed(p) => finite(&p),
                Role::Contact { pressure, gap, along } => {
                    finite(&pressure)
                        && finite(&gap)
                        && along.is_none_or(|d| finite(d.as_flattened()))
                }
            };
            if !(numbers && edge.ends.iter().all(|&p| p < points) && edge.ends[0] != edge.ends[1]) {
                return Err(wrong("edge", i, "expected two different vertices and finite numbers"));
            }
        }
        Ok(())
    }

    /// Values at the vertices, and at the cuts between them. Between equal numbers lies the same number: so the normal of an
    /// edge along an axis is known exactly.
    fn values<S: Enclosing>(&self, at: &[[f64; 2]]) -> Vec<Vector2<S>> {
        let mut all: Vec<Vector2<S>> = at.iter().map(|&x| exactly(x)).collect();
        for cut in &self.cuts {
            let ([a, b], s) = (cut.ends.map(|end| at[end]), S::exactly(cut.at));
            let between = [0, 1].map(|c| {
                let [a, b] = [a[c], b[c]];
                let mean = || S::exactly(a) * (S::from(1) - s) + S::exactly(b) * s;
                if a == b { S::exactly(a) } else { mean() }
            });
            all.push(between.into());
        }
        all
    }

    /// Vertices and cuts.
    pub(super) fn places<S: Enclosing>(&self) -> Vec<Vector2<S>> {
        self.values(&self.vertices)
    }

    /// v.
    pub(super) fn shape<S: Enclosing>(&self) -> Shape<S> {
        let Some(curved) = &self.curved else {
            return Shape { points: self.values(&self.displacement), bulges: None };
        };
        let all = |values: &[[f64; 2]]| values.iter().copied().map(exactly).collect::<Vec<_>>();
        let mut points = all(&self.displacement);
        points.extend(all(&curved.at_cuts));
        Shape { points, bulges: Some(all(&curved.bulges)) }
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

    /// v = u_D at both ends of the edges of Gamma_D, nothing is prescribed elsewhere, and there is no force in a direction
    /// that is not held.
    fn check_displacement(&self) -> Result<(), Rejection> {
        let (v_at_cuts, at_cuts) = self
            .curved
            .as_ref()
            .map_or((&[][..], &[][..]), |curved| (&curved.at_cuts[..], &curved.prescribed[..]));
        let prescribed = || self.prescribed.iter().chain(at_cuts);
        let known: Vec<([f64; 2], [Option<f64>; 2])> =
            self.displacement.iter().chain(v_at_cuts).copied().zip(prescribed().copied()).collect();
        let mut held_at = vec![[false; 2]; known.len()];
        for edge in &self.edges {
            let Role::Held(held, _) = edge.role else { continue };
            for point in edge.ends {
                if let Some(at) = held_at.get_mut(point) {
                    *at = [0, 1].map(|c| at[c] || held[c]);
                }
            }
        }
        for (point, (data, held)) in prescribed().zip(held_at).enumerate() {
            if (0..2).any(|c| data[c].is_some() && !held[c]) {
                return Err(wrong("point", point, "a prescribed value off Gamma_D"));
            }
        }
        for (e, edge) in self.edges.iter().enumerate() {
            let Role::Held(held, force) = edge.role else { continue };
            for component in 0..2 {
                if !held[component] {
                    if force[0][component] != 0.0 || force[1][component] != 0.0 {
                        return Err(wrong("edge", e, "a force where nothing is held"));
                    }
                    continue;
                }
                for point in edge.ends {
                    let Some((v, data)) = known.get(point) else {
                        return Err(wrong("edge", e, "an end without a prescribed value"));
                    };
                    let found = v[component];
                    match data[component] {
                        Some(expected) if expected == found => {}
                        Some(expected) => {
                            return Err(Rejection::NotPrescribed {
                                point,
                                component,
                                found,
                                expected,
                            });
                        }
                        None => return Err(wrong("edge", e, "an end without a prescribed value")),
                    }
                }
            }
        }
        self.curved.as_ref().map_or(Ok(()), |curved| self.check_between(curved))
    }

    /// v = u_D between the ends of the edges of Gamma_D, and there are bulges of data where there are such data only.
    fn check_between(&self, curved: &Curved) -> Result<(), Rejection> {
        for (e, edge) in self.edges.iter().enumerate() {
            let (bulge, data) = (curved.bulges[e], curved.data[e]);
            let held = match edge.role {
                Role::Held(held, _) => held,
                Role::Contact { .. } => [data[0] != 0.0, false],
                Role::Inner(_) | Role::Loaded(_) | Role::Pressed(_) => [false; 2],
            };
            let is_held = matches!(edge.role, Role::Held(..));
            for component in 0..2 {
                let (found, expected) = (bulge[component], data[component]);
                if !held[component] && expected != 0.0 {
                    return Err(wrong("edge", e, "a bulge of data where there are none"));
                }
                if is_held && held[component] && found != expected {
                    return Err(Rejection::NotPrescribedBetween {
                        edge: e,
                        component,
                        found,
                        expected,
                    });
                }
            }
        }
        Ok(())
    }

    /// The triangles of each edge, the one on its left first: inner edges have two, the others one.
    fn owners(&self) -> Result<Vec<[Option<Owner>; 2]>, Rejection> {
        let mut owners = vec![[None; 2]; self.edges.len()];
        for (t, piece) in self.pieces.iter().enumerate() {
            for local in 0..3 {
                let e = piece.edges[local];
                let seen = [piece.vertices[(local + 1) % 3], piece.vertices[(local + 2) % 3]];
                let [a, b] = self.edges[e].ends;
                let side = if seen == [a, b] {
                    0
                } else if seen == [b, a] {
                    1
                } else {
                    return Err(wrong("triangle", t, "one of its edges joins other vertices"));
                };
                if owners[e][side].replace(Owner { piece: t, local }).is_some() {
                    return Err(wrong("edge", e, "two triangles on the same side"));
                }
            }
        }
        for (e, (owner, edge)) in owners.iter().zip(&self.edges).enumerate() {
            let inner = matches!(edge.role, Role::Inner(_));
            if owner[0].is_none() || owner[1].is_some() != inner {
                return Err(wrong(
                    "edge",
                    e,
                    "expected two triangles at an inner edge, one on the left at others",
                ));
            }
        }
        Ok(owners)
    }
}

/// v and g on an edge of Gamma_C.
struct OnEdge<S> {
    /// v at both ends.
    v: [Vector2<S>; 2],
    /// g at both ends.
    gap: [f64; 2],
    /// The bulges of both; `None` where they are affine.
    bulges: Option<(Vector2<S>, f64)>,
}

/// An edge of Gamma_C.
struct OnContact<S> {
    /// tau N at both ends.
    force: [Vector2<S>; 2],
    /// What v_n - g is at most, the Bernstein coefficients of it or of a multiple: none may be positive.
    beyond: [S; 4],
    /// 2 int tau_n (v_n - g)
    term: S,
}

/// Contact along the normal. All is in units of the length, which is needed only where there is a gap.
fn along_the_normal<S: Enclosing>(
    shape: &OnEdge<S>,
    normal: Vector2<S>,
    pressure: [f64; 2],
    length: impl Fn() -> S,
) -> OnContact<S> {
    let less_gap = |beyond: S, gap: f64| {
        if gap == 0.0 { beyond } else { beyond - length() * S::exactly(gap) }
    };
    let [a, b] = [0, 1].map(|k| less_gap(shape.v[k].dot(&normal), shape.gap[k]));
    let bulge = shape.bulges.map(|(v, gap)| less_gap(v.dot(&normal), gap));
    let [p, q] = pressure.map(S::exactly);
    // 4 s (1 - s) has the Bernstein coefficients 0, 2, 0 and, times p (1 - s) + q s, the integral (p + q) / 3.
    let integral = integral_of_product([p, q], [a, b]);
    let integral = bulge.map_or(integral, |bulge| integral + (p + q) * bulge / S::from(3));
    let middle = bulge.map_or(a, |bulge| (a + b) / S::from(2) + S::from(2) * bulge);
    OnContact {
        force: [p, q].map(|p| normal * p),
        beyond: [a, middle, middle, b],
        term: S::from(2) * integral,
    }
}

/// Contact along a direction d that is affine between the ends, with tau N = |E| p d: either d or p is constant. The mean of the
/// Bernstein coefficients of v . d - g is its integral; it is at most their largest.
fn along_directions<S: Enclosing>(
    shape: &OnEdge<S>,
    d: [Vector2<S>; 2],
    pressure: [f64; 2],
    length: S,
) -> OnContact<S> {
    let (v, [g, h]) = (shape.v, shape.gap.map(S::exactly));
    let (two, three) = (S::from(2), S::from(3));
    let first = v[0].dot(&d[0]) - g;
    let last = v[1].dot(&d[1]) - h;
    let [p, q] = pressure.map(S::exactly);
    let constant = pressure[0] == pressure[1];
    let (beyond, integral) = if let Some((bulge, gap)) = shape.bulges {
        let gap = S::exactly(gap);
        // v and g have the middle coefficients (v_0 + v_1) / 2 + 2 b; v . d is a cubic, of which two are the thirds of these.
        let (middle, between) = ((v[0] + v[1]) / two + bulge * two, (g + h) / two + gap * two);
        let one = (middle.dot(&d[0]) - between) * two + v[0].dot(&d[1]) - g;
        let other = (middle.dot(&d[1]) - between) * two + v[1].dot(&d[0]) - h;
        let integral = if constant {
            p * (three * first + one + other + three * last) / S::from(12)
        } else {
            let beyond = bulge.dot(&d[0]) - gap;
            integral_of_product([p, q], [first, last]) + (p + q) * beyond / three
        };
        ([first, one, other, last], integral)
    } else {
        let middle = v[0].dot(&d[1]) + v[1].dot(&d[0]) - g - h;
        let integral = if constant {
            p * (two * first + middle + two * last) / S::from(6)
        } else {
            integral_of_product([p, q], [first, last])
        };
        ([first, middle, middle, last], integral)
    };
    OnContact {
        force: [d[0] * (length * p), d[1] * (length * q)],
        beyond,
        term: two * length * integral,
    }
}

/// How the triangles of a certificate hang together.
pub(super) struct Topology {
    /// The triangles of each edge.
    pub owners: Vec<[Option<Owner>; 2]>,
    tree: Tree,
}

/// A displacement on the triangles of a certificate.
#[derive(Clone)]
pub(super) struct Shape<S> {
    /// At vertices and cuts.
    pub points: Vec<Vector2<S>>,
    /// The bulge on each edge, if it is quadratic.
    pub bulges: Option<Vec<Vector2<S>>>,
}

impl<S: Enclosing> Shape<S> {
    fn bulges_of(&self, piece: &Piece) -> Option<[Vector2<S>; 3]> {
        self.bulges.as_ref().map(|bulges| piece.edges.map(|e| bulges[e]))
    }

    /// C eps of it on a triangle.
    pub fn stress(&self, piece: &Piece, triangle: &Triangle<S>) -> Affine<S> {
        let nodal = piece.vertices.map(|vertex| self.points[vertex]);
        let bulges = self.bulges_of(piece);
        Affine::of_displacement(triangle, &nodal, bulges.as_ref(), &piece.material())
    }
}

/// A certificate whose triangles are in equilibrium, in the numbers `S`.
pub(super) struct Balanced<S> {
    /// Vertices and cuts.
    pub points: Vec<Vector2<S>>,
    pub triangles: Vec<Triangle<S>>,
    v: Shape<S>,
    pub topology: Topology,
    /// tau N on the edges as the certificate has it.
    forces: Vec<[Vector2<S>; 2]>,
    /// tau N on the edges of each triangle towards its outside, in equilibrium.
    outward: Vec<[[Vector2<S>; 2]; 3]>,
    /// 2 int tau_n (v_n - g) over the edges of each triangle.
    on_contact: Vec<S>,
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
    fn loads_as_given(&self, certificate: &Certificate, t: usize) -> Loads<S> {
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
    fn stresses(&self, certificate: &Certificate, t: usize) -> (Affine<S>, Composite<S>) {
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
            if let Role::Inner(force) | Role::Held(_, force) = &mut edge.role {
                *force = self.outward[piece][local].map(Into::into);
            }
        }
    }

    /// The same with the forces that the certificate has now on inner and held edges.
    pub fn rebalance(&mut self, certificate: &Certificate) -> Result<(), Unbalanced> {
        for (force, edge) in self.forces.iter_mut().zip(&certificate.edges) {
            if let Role::Inner(now) | Role::Held(_, now) = edge.role {
                *force = now.map(Into::into);
            }
        }
        self.close(certificate)
    }
}

/// A triangle at an edge, by the place of the edge in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Owner {
    /// The triangle.
    pub piece: usize,
    /// Which of its edges this is.
    pub local: usize,
}

impl Piece {
    /// f is not constant.
    fn is_bent(&self) -> bool {
        self.body.iter().any(|&f| f != self.body[0])
    }

    /// The material. lambda is the one that acts in the plane, so plane strain is the formula to use.
    pub fn material<S: Enclosing>(&self) -> Material<S> {
        let [lambda, mu] = self.material;
        Material::lame(S::exactly(lambda), S::exactly(mu), Plane::Strain)
    }
}
