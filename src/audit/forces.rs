//! A force between two numbers: the functional R(w) = L(w) - int sigma(u) : eps(w) of a [`Lifting`] w, enclosed.
//!
//! By Green's formula R(w) = -int_{Gamma_D} sigma n . w - int_{Gamma_C} sigma_n w_n: where w is a rigid motion on one
//! boundary, and does no work on the others, it is minus a component of the force or the moment of that boundary on the body.
//! That component or moment lies within M |w|_a of L(w) - int m : eps(w) \[Q3\], and int tau : eps(w) is again a sum over the boundary.
//!
//! On Gamma_D w must be that motion exactly. On Gamma_C it may miss its target phi by omega = phi - w . d, at a price: what
//! is meant is R(w) + int |sigma_n| omega, and with -beta' (g - v_n) - e' w0_n <= omega <= beta (g - v_n) + e w0_n that
//! integral is at most beta A + e R(w0), by \[Q2\] with A <= M^2 - |sigma - m|^2. So w may leave its target where the body is
//! off the obstacle; w0 is 1 on Gamma_C and covers rounding. Between two bodies w . d is that of the jump.
//!
//! Where friction acts, with the bound s, w may miss its target across d, too, by chi: that is worth int s |chi| at most. Where two bodies
//! are tied the jump of w is the motion exactly, for no bound of the traction is known there: w on the first body is made so.

use std::fmt::Display;

use nalgebra::Vector2;

use super::balanced::{Balanced, friction};
use super::certificate::{
    Certificate, Edge, Law, Piece, Role, Shape, Tied, Trace, exactly, is_oblique,
};
use super::checks::{Rejection, length};
use super::dual::{Dual, WrongPair};
use super::proof::Proof;
use crate::kernel::{Ball, Enclosing, Scalar, Triangle};

/// M and G, from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// M^2
    pub square: f64,
    /// M
    pub root: f64,
}

impl Mean {
    /// |C eps(v) - tau| = D is at most (bound^2 - 2 G)^(1/2), and by the triangle inequality at most the lift of section 7.4
    /// more for v with its lift.
    pub fn new<S: Enclosing>(state: &Balanced<S>, proof: &Proof, lift: f64) -> Mean {
        let zero = S::from(0);
        let contact = state.on_contact.iter().fold(zero, |sum, &term| sum + term);
        let bound = S::exactly(proof.bound);
        let whole = bound * bound;
        let square = if lift == 0.0 {
            (whole + contact) / S::from(4)
        } else {
            let apart = (whole - contact).split(|_| zero, |d| d).sqrt() + S::exactly(lift);
            apart * apart / S::from(4) + contact / S::from(2)
        };
        let square = square.split(|_| zero, |s| s);
        Mean { square: square.upper(), root: square.sqrt().upper() }
    }
}

/// The Bernstein coefficients of w . d on an edge, for w with these values at the ends and this bulge in the middle, and d
/// affine.
pub(crate) fn along<S: Enclosing>((w, bulge): Trace<S>, d: [Vector2<S>; 2]) -> [S; 4] {
    let (two, three) = (S::from(2), S::from(3));
    let middle = (w[0] + w[1]) / two + bulge * two;
    [
        w[0].dot(&d[0]),
        (middle.dot(&d[0]) * two + w[0].dot(&d[1])) / three,
        (w[1].dot(&d[0]) + middle.dot(&d[1]) * two) / three,
        w[1].dot(&d[1]),
    ]
}

/// w . d, without a rounding error where d is an axis.
pub(crate) fn component<S: Enclosing>(w: Vector2<S>, d: Vector2<S>) -> S {
    let (zero, one) = (S::from(0), S::from(1));
    match (0..2).find(|&c| d[1 - c] == zero && (d[c] == one || d[c] == -one)) {
        Some(c) if d[c] == one => w[c],
        Some(c) => -w[c],
        None => w.dot(&d),
    }
}

/// The Bernstein coefficients of a function with these values at the ends and this bulge in the middle.
fn elevated<S: Enclosing>([a, b]: [S; 2], bulge: S) -> [S; 4] {
    let (two, three) = (S::from(2), S::from(3));
    let middle = (a + b) / two + bulge * two;
    [a, (a + middle * two) / three, (b + middle * two) / three, b]
}

impl Certificate {
    /// The error of L(w) and a(v, w) for each unit of |w|_a, as data oscillate.
    pub(crate) fn loose(&self) -> f64 {
        let square = |piece: &Piece| piece.oscillation * piece.oscillation;
        let oscillation = self.pieces.iter().map(square).sum::<f64>().sqrt();
        // Quadrature is not rounded outwards, either.
        (oscillation + self.lift()) / 2.0
    }

    /// The direction of contact on an edge of Gamma_C, at both ends.
    pub(crate) fn directions<S: Enclosing>(
        &self,
        e: usize,
        points: &[Vector2<S>],
    ) -> [Vector2<S>; 2] {
        if let Role::Contact { along: Some(d), .. } = self.edges[e].role {
            return d.map(exactly);
        }
        let [start, end] = self.edges[e].ends.map(|p| points[p]);
        let edge = end - start;
        let is_zero = |x: S| x.ends() == [0.0; 2];
        // Along an axis it is known exactly.
        let sign = |x: S| S::from(if x.is_positive() { 1 } else { -1 });
        let zero = S::from(0);
        let n = if is_zero(edge[0]) {
            Vector2::new(sign(edge[1]), zero)
        } else if is_zero(edge[1]) {
            Vector2::new(zero, -sign(edge[0]))
        } else {
            Vector2::new(edge[1], -edge[0]) / edge.dot(&edge).sqrt()
        };
        [n; 2]
    }

    /// g - v . d on an edge of Gamma_C: its Bernstein coefficients.
    pub fn gap<S: Enclosing>(&self, e: usize, state: &Balanced<S>) -> [S; 4] {
        let Role::Contact { gap, .. } = self.edges[e].role else { return [S::from(0); 4] };
        let bulge = self.curved.as_ref().map_or(0.0, |curved| curved.data[e][0]);
        let g = elevated(gap.map(S::exactly), S::exactly(bulge));
        let v = along(self.jump(e, &state.v), self.directions(e, &state.points));
        [0, 1, 2, 3].map(|k| g[k] - v[k])
    }
}

/// A displacement w by doubles: at the vertices, and if it is quadratic what it is beyond its mean at the cuts and in the
/// middles of the edges of a certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct Lifting {
    /// At the vertices. At a point that is held along an oblique direction w is the nearest vector that does there what it
    /// should.
    pub vertices: Vec<[f64; 2]>,
    /// At the cuts, and on the edges.
    pub beyond: Option<[Vec<[f64; 2]>; 2]>,
}

/// The values of w on the boundary in question; on all others it does no work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// w . d = phi on Gamma_C along the direction d of contact.
    Along(Option<Ramp>),
    /// A translation by 1.
    Axis(usize),
    /// A rotation about the origin, counter-clockwise.
    Turn,
}

/// A weight along a boundary: 1 where coordinate `axis` is between two numbers, falling to 0 outside, affinely over `width`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// 0 for x, 1 for y.
    pub axis: usize,
    /// Where it is 1.
    pub between: [f64; 2],
    /// Over which it falls.
    pub width: f64,
}

impl Ramp {
    /// The weight at this coordinate.
    pub fn at<S: Enclosing>(&self, x: S) -> S {
        // From its feet, where it is exactly 0.
        let [foot, from, to, end] = self.kinks().map(S::exactly);
        let (zero, one) = (S::from(0), S::from(1));
        let positive = |x: S| x.split(|_| zero, |x| x);
        let least = |a: S, b: S| if a == b { a } else { a - positive(a - b) };
        let (rising, falling) = ((x - foot) / (from - foot), (end - x) / (end - to));
        let inside = least(positive(rising), positive(falling));
        // Of 0 nothing is taken away.
        if inside == zero { zero } else { least(inside, one) }
    }

    /// The coordinates where its slope jumps.
    fn kinks(&self) -> [f64; 4] {
        let [from, to] = self.between;
        [from - self.width, from, to, to + self.width]
    }
}

/// A motion of one boundary; of all contact boundaries where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceTarget {
    /// The boundary's number.
    pub boundary: Option<usize>,
    /// The values of w there.
    pub motion: Motion,
}

impl Motion {
    /// The rigid motion at a place, if it is one.
    pub fn at<S: Scalar>(self, x: Vector2<S>) -> Option<Vector2<S>> {
        match self {
            Motion::Along(_) => None,
            Motion::Axis(c) => {
                let mut axis = Vector2::zeros();
                axis[c] = S::from(1);
                Some(axis)
            }
            Motion::Turn => Some(Vector2::new(-x[1], x[0])),
        }
    }
}

/// The evidence for forces that comes beside a certificate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evidence {
    /// The boundaries.
    pub names: Vec<String>,
    /// The boundary of each edge of the certificate, by its place among the names.
    pub of: Vec<Option<usize>>,
    /// w0 of the module's head.
    pub cover: Option<Lifting>,
    /// The displacements with what they are to do.
    pub liftings: Vec<(ForceTarget, Lifting)>,
    /// Dual pairs for contact forces (`signorini_audit::dual`).
    pub pairs: Vec<(ForceTarget, Dual)>,
    /// The intervals that they are said to prove.
    pub between: Option<Between>,
}

/// Intervals of forces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Between {
    /// R(w0); 0 where there is none.
    pub cover: [f64; 2],
    /// Each force, by its lifting.
    pub liftings: Vec<[f64; 2]>,
    /// The force of each dual pair, by that.
    pub pairs: Vec<[f64; 2]>,
}

impl Evidence {
    /// Intersects the intervals of a force by its lifting and by its dual pairs.
    pub fn nearest(
        &self,
        target: ForceTarget,
        by_lifting: [f64; 2],
        pairs: &[[f64; 2]],
    ) -> [f64; 2] {
        let own = self.pairs.iter().zip(pairs).filter(|((other, _), _)| *other == target);
        own.fold(by_lifting, |[low, high], (_, [l, h])| [low.max(*l), high.min(*h)])
    }
}

/// Why w proves nothing of a force.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum WrongLifting {
    #[error(transparent)]
    Length(#[from] Rejection),
    #[error("edge {edge}: w is not what it should be on a part of the boundary that is held")]
    OnSupport { edge: usize },
    #[error(
        "edge {edge}: w along the direction of contact is up to {off} from what it should be, where the body may touch the obstacle"
    )]
    OnContact { edge: usize, off: f64 },
    #[error(
        "edge {edge}: two bodies are tied there, and a force along the direction of contact is not known; expected a force along an axis or a moment"
    )]
    Tied { edge: usize },
    #[error("the force is not a finite number")]
    NotFinite,
}

/// w0 of the module's head: its Bernstein coefficients on the edges of Gamma_C.
pub struct Cover {
    along: Vec<Option<[f64; 4]>>,
    /// Numbers that R(w0) lies between.
    pub between: [f64; 2],
}

/// The cost of omega from below and from above: bounds of it times g - v_n, and R(w0) times those times w0_n; and int s |chi|.
#[derive(Clone, Copy)]
pub(crate) struct Missed {
    pub(crate) open: [f64; 2],
    pub(crate) covered: [Ball; 2],
    dragged: f64,
}

/// A certificate whose triangles are in equilibrium, with what its data and its bound are worth for forces.
pub struct Forces<'a, S> {
    /// The certificate.
    pub certificate: &'a Certificate,
    /// The certificate in equilibrium.
    pub(crate) state: &'a Balanced<S>,
    /// The boundary of each edge.
    pub of: &'a [Option<usize>],
    /// M
    pub(crate) mean: Mean,
    /// The error of L(w) and a(v, w) for each unit of |w|_a, as data oscillate.
    pub(crate) loose: f64,
    unbalanced: Shape<S>,
}

/// int f . w - a(v, w) for w with a component 1 at a point, and for such a bulge on an edge: grad l_i is minus the scaled normal
/// N_i over J = 2 |T|, so of sigma = C eps(v), affine with the values s_i and the sum S, l_i has the work -1/6 S N_i and 4 l_j l_k
/// -1/6 ((S + s_j) N_k + (S + s_k) N_j); of f, with the sum F, J/24 (F + f_i) and J/30 (2 F - f_i).
fn unbalanced<S: Enclosing>(certificate: &Certificate, state: &Balanced<S>) -> Shape<S> {
    let sixth = S::from(1) / S::from(6);
    let mut points = vec![Vector2::zeros(); state.points.len()];
    let mut bulges = vec![Vector2::zeros(); certificate.edges.len()];
    for (piece, triangle) in certificate.pieces.iter().zip(&state.triangles) {
        let sigma = state.v.stress(piece, triangle);
        let is_loaded = piece.body != [[0.0; 2]; 3];
        let normals = [0, 1, 2].map(|i| triangle.scaled_normal(i));
        let stresses = [0, 1, 2].map(|i| sigma.at_corner(i));
        let sum = stresses[0] + stresses[1] + stresses[2];
        let body = piece.body.map(exactly::<S>);
        let loads = body[0] + body[1] + body[2];
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let [of_j, of_k] =
                [(j, k), (k, j)].map(|(j, k)| (sum + stresses[j]).traction(normals[k]));
            let mut force = [sum.traction(normals[i]) * sixth, (of_j + of_k) * sixth];
            if is_loaded {
                let area = triangle.double_area();
                force[0] += (loads + body[i]) * (area / S::from(24));
                force[1] += (loads * S::from(2) - body[i]) * (area / S::from(30));
            }
            points[piece.vertices[i]] += force[0];
            bulges[piece.edges[i]] += force[1];
        }
    }
    Shape { points, bulges: Some(bulges) }
}

impl Certificate {
    /// Encloses R(w) of each lifting, in units of the case: verifies all conditions of the theorem, and those of the
    /// liftings.
    ///
    /// # Errors
    /// As [`Certificate::evaluate`]; a dual pair that is none; inside, a lifting that is not what it should be on the boundary.
    pub fn forces<S: Enclosing>(
        &self,
        evidence: &Evidence,
    ) -> Result<Vec<Result<[f64; 2], WrongLifting>>, WrongPair> {
        let state = self.balanced::<S>(self.topology()?)?;
        let proof = self.sum(&state)?;
        let (_, found, pairs) = self.forces_near(&state, &proof, evidence)?;
        let targets = evidence.liftings.iter().map(|(target, _)| *target);
        let nearest = |(target, ends): (ForceTarget, Result<[f64; 2], WrongLifting>)| {
            ends.map(|ends| evidence.nearest(target, ends, &pairs))
        };
        Ok(targets.zip(found).map(nearest).collect())
    }

    /// [`Certificate::forces`] in [balls](Ball), compiled with the checker.
    ///
    /// # Errors
    /// As [`Certificate::forces`].
    pub fn prove_forces(
        &self,
        evidence: &Evidence,
    ) -> Result<Vec<Result<[f64; 2], WrongLifting>>, WrongPair> {
        self.forces::<Ball>(evidence)
    }

    /// Verifies that what is said of forces is what their data give.
    pub(crate) fn check_forces(
        &self,
        state: &Balanced<Ball>,
        proof: &Proof,
        evidence: &Evidence,
    ) -> Result<(), Rejection> {
        let Some(claimed) = &evidence.between else { return Ok(()) };
        let wrong = |force: usize, problem: &dyn Display| {
            Err(Rejection::Force { force, problem: problem.to_string() })
        };
        let (cover, found, pairs) = match self.forces_near(state, proof, evidence) {
            Ok(found) => found,
            Err(WrongPair::Rejected(rejection)) => return Err(rejection),
            Err(error) => return wrong(0, &error),
        };
        length("intervals of forces", claimed.liftings.len(), found.len())?;
        length("intervals of forces", claimed.pairs.len(), pairs.len())?;
        let same = |a: [f64; 2], b: [f64; 2]| a.map(f64::to_bits) == b.map(f64::to_bits);
        let of_cover = (&claimed.cover, Ok(cover.map_or([0.0; 2], |cover| cover.between)));
        let of_pairs = claimed.pairs.iter().zip(pairs.into_iter().map(Ok));
        let all = claimed.liftings.iter().zip(found).chain(of_pairs);
        let all = std::iter::once(of_cover).chain(all);
        for (force, (&claimed, found)) in all.enumerate() {
            match found {
                Ok(found) if same(found, claimed) => {}
                Ok([low, high]) => {
                    let [least, most] = claimed;
                    let problem = format!(
                        "it is said to be between {least} and {most}; its data give {low} and {high}"
                    );
                    return wrong(force, &problem);
                }
                Err(error) => return wrong(force, &error),
            }
        }
        Ok(())
    }

    /// [`forces`] of a certificate in equilibrium, with its proof.
    fn forces_near<S: Enclosing>(
        &self,
        state: &Balanced<S>,
        proof: &Proof,
        evidence: &Evidence,
    ) -> Result<Enclosed, WrongPair> {
        let mean = Mean::new(state, proof, self.lift());
        length("boundaries of edges", evidence.of.len(), self.edges.len())?;
        let forces = Forces::new(self, state, &evidence.of, mean);
        let cover = evidence.cover.as_ref().and_then(|w| forces.cover(w).ok());
        let found = forces.between(&evidence.liftings, cover.as_ref());
        let pairs = evidence.pairs.iter();
        let pairs = pairs.map(|(target, dual)| forces.by_pair(*target, dual, cover.as_ref()));
        let pairs = pairs.map(|found| Ok(found?.between)).collect::<Result<_, WrongPair>>()?;
        Ok((cover, found, pairs))
    }
}

/// w0, and what forces lie between by liftings and by dual pairs.
type Enclosed = (Option<Cover>, Vec<Result<[f64; 2], WrongLifting>>, Vec<[f64; 2]>);

impl<'a, S: Enclosing> Forces<'a, S> {
    /// With M.
    pub fn new(
        certificate: &'a Certificate,
        state: &'a Balanced<S>,
        of: &'a [Option<usize>],
        mean: Mean,
    ) -> Self {
        let (loose, unbalanced) = (certificate.loose(), unbalanced(certificate, state));
        Forces { certificate, state, of, mean, loose, unbalanced }
    }

    /// int f . w - a(v, w)
    pub(crate) fn within(&self, w: &Shape<S>) -> S {
        let sum = |forces: &[Vector2<S>], w: &[Vector2<S>]| {
            forces.iter().zip(w).fold(S::from(0), |sum, (f, w)| sum + f.dot(w))
        };
        let at_points = sum(&self.unbalanced.points, &w.points);
        match (&self.unbalanced.bulges, &w.bulges) {
            (Some(own), Some(of_w)) => at_points + sum(own, of_w),
            _ => at_points,
        }
    }

    /// The displacement of a lifting on the triangles of the certificate, verified on Gamma_D.
    fn shape(&self, w: &Lifting, target: ForceTarget) -> Result<Shape<S>, WrongLifting> {
        self.check_supports(w, target)?;
        let certificate = self.certificate;
        let vertices = certificate.vertices.len();
        let mut points: Vec<Vector2<S>> = w.vertices.iter().map(|&w| exactly(w)).collect();
        let frames = &certificate.frames;
        for (e, edge) in certificate.edges.iter().enumerate() {
            let Role::Supported { along: d, .. } = edge.role else { continue };
            for p in edge.ends.into_iter().flat_map(|p| self.bases(p)) {
                if frames.get(&p) != Some(&d) {
                    continue;
                }
                let (value, d) = (self.motion(e, p, target), exactly::<S>(d));
                points[p] = points[p] - d * ((points[p] - value).dot(&d) / d.dot(&d));
            }
        }
        points = certificate.with_cuts(points, &w.vertices, |p| !frames.contains_key(&p));
        let mut bulges = None;
        if let Some([at_cuts, beyond]) = &w.beyond {
            for (point, &beyond) in points[vertices..].iter_mut().zip(at_cuts) {
                *point += exactly::<S>(beyond);
            }
            bulges = Some(beyond.iter().map(|&bulge| exactly(bulge)).collect());
        }
        let mut shape = Shape { points, bulges };
        self.tie(&mut shape, target)?;
        Ok(shape)
    }

    /// Gives w on the first of two tied bodies what it is on the second one and, where the target is meant, the motion: where w is
    /// prescribed, that must be what it was.
    fn tie(&self, w: &mut Shape<S>, target: ForceTarget) -> Result<(), WrongLifting> {
        let certificate = self.certificate;
        let (zero, one) = (S::from(0), S::from(1));
        for Tied { edge, other, law, d, .. } in certificate.tied() {
            // w0 is 0 between tied bodies.
            let is_meant = target.boundary.is_some() && self.is_meant(edge, target);
            // What the jump is beyond the motion, and the part of it along d where there is none.
            let (mut beyond, mut gap) = ([Vector2::zeros(); 2], [zero; 2]);
            for (k, p) in certificate.edges[edge].ends.into_iter().enumerate() {
                let motion = target.motion.at(self.state.points[p]).filter(|_| is_meant);
                let jump = match motion {
                    _ if !is_meant => [zero; 2],
                    Some(motion) if law.is_bonded() => motion.into(),
                    Some(motion) => [component(motion, exactly(d[k])), zero],
                    None if !law.is_bonded() && target.motion == Motion::Along(None) => [one, zero],
                    None => return Err(WrongLifting::Tied { edge }),
                };
                let (own, there) = (w.points[p], w.points[certificate.edges[other].ends[1 - k]]);
                let given = certificate.is_given(p);
                let tied = law.tie((own, given), there, d[k], jump);
                let same = |c: usize| tied[c].ends() == own[c].ends();
                if (0..2).any(|c| given[c] && !same(c)) {
                    return Err(WrongLifting::OnSupport { edge });
                }
                w.points[p] = tied;
                beyond[k] = tied - there - motion.unwrap_or_else(Vector2::zeros);
                gap[k] = if motion.is_some() { zero } else { jump[0] };
            }
            // Where d turns, the jump of an affine w has a bulge, too.
            if d[0] != d[1] {
                w.bulges.get_or_insert_with(|| vec![Vector2::zeros(); certificate.edges.len()]);
            }
            if let Some(bulges) = &mut w.bulges {
                let own = [bulges[edge], bulges[other]];
                bulges[edge] = law.tie_between(own, beyond, d, (gap, [zero; 2]));
            }
        }
        Ok(())
    }

    /// The edges of Gamma_C but those of tied bodies.
    pub(crate) fn contact(&self) -> impl Iterator<Item = usize> {
        let edges = self.certificate.edges.iter().enumerate();
        let opens = |edge: &Edge| matches!(edge.role, Role::Contact { law, .. } if !law.is_tied());
        edges.filter(move |(_, edge)| opens(edge)).map(|(e, _)| e)
    }

    /// int s |chi| from above, chi being what w misses across the direction of contact on an edge with friction.
    fn dragged(&self, e: usize, w: &Shape<S>, target: ForceTarget) -> S {
        let certificate = self.certificate;
        let Role::Contact { law: Law::Friction { bound, .. }, .. } = certificate.edges[e].role
        else {
            return S::from(0);
        };
        let ([a, b], bulge) = certificate.jump(e, w);
        let [r, s] = certificate.edges[e].ends.map(|p| self.motion(e, p, target));
        let across = certificate.across(e, ([r - a, s - b], -bulge), &self.state.points);
        friction(across, [0.0; 2], bound) / S::from(2)
    }

    /// The vertices that a point lies between, or it itself.
    fn bases(&self, p: usize) -> [usize; 2] {
        match p.checked_sub(self.certificate.vertices.len()) {
            None => [p; 2],
            Some(cut) => self.certificate.cuts[cut].ends,
        }
    }

    /// Tells whether the motion is asked for on an edge.
    fn is_meant(&self, e: usize, target: ForceTarget) -> bool {
        target.boundary.is_none_or(|boundary| self.of[e] == Some(boundary))
    }

    /// The rigid motion at point `p` of edge `e`, where one is asked for: the value of w there if the edge is one of Gamma_D.
    fn motion(&self, e: usize, p: usize, target: ForceTarget) -> Vector2<S> {
        let motion = target.motion.at(self.state.points[p]).filter(|_| self.is_meant(e, target));
        motion.unwrap_or_else(Vector2::zeros)
    }

    /// Verifies w on Gamma_D, and that it has a value for each vertex and, if it is quadratic, for each cut and each edge.
    fn check_supports(&self, w: &Lifting, target: ForceTarget) -> Result<(), WrongLifting> {
        let certificate = self.certificate;
        length("w", w.vertices.len(), certificate.vertices.len())?;
        if let Some([at_cuts, beyond]) = &w.beyond {
            length("w", at_cuts.len(), certificate.cuts.len())?;
            length("w", beyond.len(), certificate.edges.len())?;
        }
        for (edge, Edge { ends, role }) in certificate.edges.iter().enumerate() {
            let (held, oblique) = match *role {
                Role::Held(held, _) => (held, None),
                Role::Supported { along: d, .. } if is_oblique(d) => ([true; 2], Some(d)),
                Role::Supported { along: d, .. } => (d.map(|d| d != 0.0), None),
                _ => continue,
            };
            for p in ends.iter().flat_map(|&p| self.bases(p)) {
                let framed = certificate.frames.get(&p);
                let expected = self.motion(edge, p, target).map(S::ends);
                let right = match (framed, oblique) {
                    (Some(frame), Some(d)) => *frame == d,
                    (Some(_), None) => false,
                    (None, _) => (0..2).all(|c| !held[c] || expected[c] == [w.vertices[p][c]; 2]),
                };
                if !right {
                    return Err(WrongLifting::OnSupport { edge });
                }
            }
            let Some([at_cuts, bulges]) = &w.beyond else { continue };
            let is_zero = |x: [f64; 2]| (0..2).all(|c| !held[c] || x[c] == 0.0);
            let cuts = ends.iter().filter_map(|p| p.checked_sub(certificate.vertices.len()));
            if !is_zero(bulges[edge]) || !cuts.into_iter().all(|cut| is_zero(at_cuts[cut])) {
                return Err(WrongLifting::OnSupport { edge });
            }
        }
        Ok(())
    }

    /// Encloses L(w) - int m : eps(w) + int |sigma_n| omega.
    fn enclose(&self, w: &Shape<S>, missed: Missed) -> [f64; 2] {
        let (certificate, state) = (self.certificate, self.state);
        // Half of int f . w is in int tau : eps(w) / 2, as is half of the work of all tractions.
        let mut middle = self.within(w) / S::from(2);
        middle += certificate.work_of_tractions(&state.forces, w);
        for (e, edge) in certificate.edges.iter().enumerate() {
            if state.topology.owners[e][1].is_none() {
                middle -= w.work_of(state.balance.forces[e], edge.ends, e) / S::from(2);
            }
        }
        let triangles = certificate.pieces.iter().zip(&state.triangles);
        let square = triangles
            .fold(Ball::from(0), |sum, (piece, triangle)| sum + energy(w, piece, triangle));
        let point = Ball::point;
        let norm = point(square.sqrt().upper());
        let loose = point(self.loose) * norm;
        let away = |side: usize| {
            let opened = reach(norm, point(missed.open[side]), self.mean);
            (opened + missed.covered[side] + point(missed.dragged) + loose).upper()
        };
        let below = point(middle.lower()) - point(away(0));
        let above = point(middle.upper()) + point(away(1));
        [below.lower(), above.upper()]
    }

    /// phi - w . d on an edge of Gamma_C: what its Bernstein coefficients are at least and at most.
    fn missed(&self, e: usize, w: &Shape<S>, target: ForceTarget) -> [[f64; 2]; 4] {
        let certificate = self.certificate;
        let ends = certificate.edges[e].ends;
        let d = certificate.directions(e, &self.state.points);
        let ([a, b], bulge) = certificate.jump(e, w);
        if !self.is_meant(e, target) {
            return along(([-a, -b], -bulge), d).map(S::ends);
        }
        let places = ends.map(|p| self.state.points[p]);
        if let (Some(r), Some(s)) = (target.motion.at(places[0]), target.motion.at(places[1])) {
            return along(([r - a, s - b], -bulge), d).map(S::ends);
        }
        let one = S::from(1);
        let constant = d[0] == d[1];
        // Where d is constant, omega at the ends and its bulge: 0 stays 0.
        let missed = |phi: [S; 2]| {
            if constant {
                let [a, b, bulge] = [a, b, bulge].map(|w| component(w, d[0]));
                elevated([phi[0] - a, phi[1] - b], -bulge)
            } else {
                let (phi, w) = (elevated(phi, S::from(0)), along(([a, b], bulge), d));
                [0, 1, 2, 3].map(|k| phi[k] - w[k])
            }
        };
        let Motion::Along(Some(ramp)) = target.motion else {
            return missed([one; 2]).map(S::ends);
        };
        let [p, q] = places.map(|x| x[ramp.axis]);
        let phi = [p, q].map(|x| ramp.at(x));
        // Between its kinks the ramp is affine: what it is beyond the chord is largest and least at these, or 0 at the ends.
        let mut beyond = [0.0_f64; 2];
        for kink in ramp.kinks() {
            let (x, inside) =
                (S::exactly(kink), (p.lower().min(q.lower()), p.upper().max(q.upper())));
            if inside.0 < kink && kink < inside.1 {
                let s = (x - p) / (q - p);
                let [low, high] = (ramp.at(x) - (phi[0] + (phi[1] - phi[0]) * s)).ends();
                beyond = [beyond[0].min(low), beyond[1].max(high)];
                // Too short to tell: a weight is between 0 and 1.
                if !(low.is_finite() && high.is_finite()) {
                    beyond = [-1.0, 1.0];
                }
            }
        }
        if beyond == [0.0; 2] {
            return missed(phi).map(S::ends);
        }
        missed(phi).map(|omega| {
            let [low, high] = omega.ends().map(Ball::point);
            [(low + Ball::point(beyond[0])).lower(), (high + Ball::point(beyond[1])).upper()]
        })
    }

    /// int s |chi| over all of Gamma_C, from above.
    fn all_dragged(&self, w: &Shape<S>, target: ForceTarget) -> f64 {
        let zero = S::from(0);
        self.contact().fold(zero, |sum, e| sum + self.dragged(e, w, target)).upper().max(0.0)
    }

    /// By what phi - w . d is bounded on Gamma_C.
    pub(crate) fn all_missed(
        &self,
        w: &Shape<S>,
        target: ForceTarget,
        cover: Option<&Cover>,
    ) -> Result<Missed, WrongLifting> {
        let (mut open, mut covered) = ([0.0_f64; 2], [0.0_f64; 2]);
        // R(w0) from above.
        let force = cover.map_or(0.0, |cover| cover.between[1]);
        for edge in self.contact() {
            let off = self.missed(edge, w, target);
            if off == [[0.0; 2]; 4] {
                continue;
            }
            let gap = self.certificate.gap(edge, self.state).map(|g| g.lower());
            let w0 = cover.and_then(|cover| cover.along[edge]);
            let largest = |sizes: [f64; 4], side: usize| {
                let sizes = sizes
                    .into_iter()
                    .zip(off)
                    .map(|(size, off)| ratio(if side == 0 { -off[0] } else { off[1] }, size));
                sizes.fold(0.0, f64::max)
            };
            for side in 0..2 {
                let by_gap = largest(gap, side);
                let by_cover = w0.map_or(f64::INFINITY, |w0| largest(w0, side));
                // What is cheaper.
                let costs = [by_gap * self.mean.square, by_cover * force];
                if by_gap.is_finite() && !(by_cover.is_finite() && costs[1] <= costs[0]) {
                    open[side] = open[side].max(by_gap);
                } else if by_cover.is_finite() {
                    covered[side] = covered[side].max(by_cover);
                } else {
                    let off = off.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
                    return Err(WrongLifting::OnContact { edge, off });
                }
            }
        }
        let covered = covered.map(|most| Ball::point(most) * Ball::point(force));
        Ok(Missed { open, covered, dragged: self.all_dragged(w, target) })
    }

    /// w0 of the module's head, from a lifting that is 1 along contact where it can be.
    pub fn cover(&self, w: &Lifting) -> Result<Cover, WrongLifting> {
        let target = ForceTarget { boundary: None, motion: Motion::Along(None) };
        // On Gamma_D a motion along contact is 0.
        let shape = self.shape(w, target)?;
        let mut along_all = vec![None; self.certificate.edges.len()];
        for e in self.contact() {
            let d = self.certificate.directions(e, &self.state.points);
            let w = along(self.certificate.jump(e, &shape), d).map(S::lower);
            along_all[e] = w.iter().all(|&w| w >= 0.0).then_some(w);
            if along_all[e].is_none() {
                return Err(WrongLifting::OnContact { edge: e, off: 1.0 });
            }
        }
        let dragged = self.all_dragged(&shape, target);
        let missed = Missed { open: [0.0; 2], covered: [Ball::from(0); 2], dragged };
        let between = self.enclose(&shape, missed);
        Ok(Cover { along: along_all, between })
    }

    /// The forces of some liftings, each between two numbers.
    pub fn between(
        &self,
        liftings: &[(ForceTarget, Lifting)],
        cover: Option<&Cover>,
    ) -> Vec<Result<[f64; 2], WrongLifting>> {
        let between = |(target, w): &(ForceTarget, Lifting)| {
            let shape = self.shape(w, *target)?;
            let missed = self.all_missed(&shape, *target, cover)?;
            let ends = self.enclose(&shape, missed);
            let is_finite = ends.iter().all(|end| end.is_finite());
            if is_finite { Ok(ends) } else { Err(WrongLifting::NotFinite) }
        };
        liftings.iter().map(between).collect()
    }
}

/// int eps(w) : C eps(w) on a triangle.
pub(crate) fn energy<S: Enclosing>(w: &Shape<S>, piece: &Piece, triangle: &Triangle<S>) -> Ball {
    w.stress(piece, triangle).energy(&piece.material(), triangle.double_area()).ball()
}

/// The largest ratio of a to b, not below 0: infinite where b is 0 and a is not.
pub(crate) fn ratio(a: f64, b: f64) -> f64 {
    let ratio = (Ball::point(a) / Ball::point(b)).upper();
    match a {
        a if a <= 0.0 => 0.0,
        _ if b > 0.0 && ratio.is_finite() => ratio,
        _ => f64::INFINITY,
    }
}

/// The largest value of x eta + k (M^2 - x^2) for 0 <= x <= M: k M^2 + eta^2 / (4 k) where that is taken inside, M eta at the
/// end.
pub(crate) fn reach(eta: Ball, k: Ball, mean: Mean) -> Ball {
    let root = Ball::point(mean.root);
    let two = Ball::from(2);
    if eta.lower() >= (two * k * root).upper() {
        return root * eta;
    }
    k * Ball::point(mean.square) + eta * eta / (two * two * k)
}
