//! A contact force between two numbers of second order, by a dual pair (w, rho): w a displacement as in
//! [`forces`](super::forces), rho a stress with div rho = 0, rho n = 0 on Gamma_N and rho n = r n on Gamma_C. Exactly
//!
//! R = R0 - int C^-1 (sigma(u) - m) : (C eps(w) - rho) + int r (g - u_n) + int |sigma_n| omega,   omega = phi - w_n,
//! R0 = L(w) - a(v, w) + int r (v_n - g) + 1/2 int C^-1 (C eps(v) - tau) : (C eps(w) - rho)                          \[Q4\]
//!
//! (docs/a-posteriori.md, 7.7). With eta = |C eps(w) - rho|, r >= 0 and omega >= 0 it is at least R0 - M eta. In general the two
//! integrals over Gamma_C are bounded by B and A where r is bounded by multiples of |tau_n| and omega by multiples of g -
//! v_n.
//!
//! The pair is itself a certificate on the same triangles, of the linear problem whose contact edges are held along the
//! direction of contact, an axis, or free.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::balance::{OnEdges, Stop};
use super::balanced::{Balanced, Topology, outward};
use super::certificate::{Certificate, Curved, Edge, Law, Piece, Role, Shape, exactly, is_oblique};
use super::checks::Rejection;
use super::forces::{Cover, ForceTarget, Forces, WrongLifting, component, energy, ratio, reach};
use crate::kernel::composite::{Composite, Frame, Loads, Wrench};
use crate::kernel::{Ball, Enclosing, PreciseBall, Triangle};

/// Why a dual pair proves nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum WrongPair {
    #[error(transparent)]
    Rejected(#[from] Rejection),
    #[error(transparent)]
    Lifting(#[from] WrongLifting),
    #[error("{what} {index} of the dual pair is not that of the certificate, without its data")]
    Differs { what: &'static str, index: usize },
}

impl Certificate {
    /// A dual pair on the same triangles: `w` at the vertices and, where v is quadratic, at the cuts and by its bulges; and
    /// the roles of the edges with the tractions of rho. What holds the body holds w at 0, and contact edges that are held
    /// have what w is there.
    pub fn with_dual(
        &self,
        w: Vec<[f64; 2]>,
        beyond: Option<[Vec<[f64; 2]>; 2]>,
        roles: Vec<Role>,
    ) -> Certificate {
        let at_rest = |data: &[Option<f64>; 2]| data.map(|u| u.map(|_| 0.0));
        let mut prescribed: Vec<_> = self.prescribed.iter().map(at_rest).collect();
        let mut at_cuts = match &self.curved {
            Some(curved) => curved.prescribed.iter().map(at_rest).collect(),
            None => vec![[None; 2]; self.cuts.len()],
        };
        for (edge, role) in self.edges.iter().zip(&roles) {
            let (Role::Contact { .. }, Role::Held(held, _)) = (edge.role, *role) else { continue };
            for p in edge.ends {
                let (data, values, k) = match (p.checked_sub(self.vertices.len()), &beyond) {
                    (None, _) => (&mut prescribed, &w, p),
                    (Some(cut), Some([values, _])) => (&mut at_cuts, values, cut),
                    (Some(_), None) => continue,
                };
                let (Some(data), Some(value)) = (data.get_mut(k), values.get(k)) else { continue };
                for c in (0..2).filter(|&c| held[c]) {
                    data[c].get_or_insert(value[c]);
                }
            }
        }
        let unloaded = |&piece: &Piece| Piece { body: [[0.0; 2]; 3], oscillation: 0.0, ..piece };
        let edges = self.edges.iter().zip(roles);
        let edges: Vec<Edge> = edges.map(|(edge, role)| Edge { ends: edge.ends, role }).collect();
        Certificate {
            vertices: self.vertices.clone(),
            cuts: self.cuts.clone(),
            displacement: w,
            curved: beyond.map(|[values, bulges]| Curved {
                at_cuts: values,
                prescribed: at_cuts,
                data: vec![[0.0; 2]; bulges.len()],
                bulges,
            }),
            prescribed,
            frames: self.frames.clone(),
            pieces: self.pieces.iter().map(unloaded).collect(),
            edges,
            lifts: Vec::new(),
            polygon: self.polygon.clone(),
            facing: BTreeMap::new(),
        }
    }
}

/// A contact force by a dual pair.
#[derive(Clone, Debug, PartialEq)]
pub struct ByPair {
    /// The numbers that it lies between.
    pub between: [f64; 2],
    /// The shares of the triangles in eta^2.
    pub shares: Vec<f64>,
    /// k of either end: by so much r and omega are bounded, in units of |tau_n| and g - v_n.
    pub factors: [f64; 2],
}

impl ByPair {
    /// Gives the share of each triangle in the distance of one end from the middle, k M^2 + eta^2 / (4 k) with the k >= eta / (2
    /// M) that makes it that distance; `shares` are those in M^2. The upper end counts k M^2 alone: its eta comes from where w
    /// and rho end, not from the triangles.
    pub fn limits(&self, side: usize, shares: &[f64]) -> Vec<f64> {
        let [of_mean, of_pair] = [shares, &self.shares].map(|all| all.iter().sum::<f64>());
        let k = self.factors[side].max((of_pair / of_mean).sqrt() / 2.0);
        let per_pair = if side == 0 { 1.0 / (4.0 * k) } else { 0.0 };
        let all = shares.iter().zip(&self.shares);
        all.map(|(mean, pair)| k * mean + pair * per_pair).collect()
    }
}

impl Certificate {
    /// The pair has the triangles of the certificate, no loads, and w = 0 on Gamma_D.
    fn check_pair<S: Enclosing>(
        &self,
        pair: &Certificate,
        state: &Balanced<S>,
    ) -> Result<(), WrongPair> {
        let (zero, one) = (S::from(0), S::from(1));
        let differs = |what, index| Err(WrongPair::Differs { what, index });
        let same_points = (&pair.vertices, &pair.cuts, &pair.frames)
            == (&self.vertices, &self.cuts, &self.frames);
        if !same_points || !pair.lifts.is_empty() {
            return differs("a point", 0);
        }
        if pair.pieces.len() != self.pieces.len() || pair.edges.len() != self.edges.len() {
            return differs("the number of triangles or edges", pair.pieces.len());
        }
        for (t, (own, other)) in self.pieces.iter().zip(&pair.pieces).enumerate() {
            let same = (own.vertices, own.edges, own.material)
                == (other.vertices, other.edges, other.material);
            if !same || other.body != [[0.0; 2]; 3] || other.oscillation != 0.0 {
                return differs("triangle", t);
            }
        }
        for (e, (own, other)) in self.edges.iter().zip(&pair.edges).enumerate() {
            let is_zero = |p: usize, c: usize| pair.at_own(p).is_none_or(|(w, _)| w[c] == 0.0);
            let straight =
                |c: usize| pair.curved.as_ref().is_none_or(|curved| curved.bulges[e][c] == 0.0);
            let at_rest = |held: [bool; 2]| {
                let still = |c: usize| straight(c) && other.ends.iter().all(|&p| is_zero(p, c));
                (0..2).all(|c| !held[c] || still(c))
            };
            let right = own.ends == other.ends
                && match (own.role, other.role) {
                    (Role::Inner(_), Role::Inner(_)) => true,
                    (Role::Held(held, _), Role::Held(same, _)) => held == same && at_rest(held),
                    (
                        Role::Supported { along, .. },
                        Role::Supported { along: same, traction, .. },
                    ) => {
                        let framed = |p: &usize| match (pair.frames.get(p), pair.at_own(*p)) {
                            (Some(_), Some((_, [w, _]))) => w == Some(0.0),
                            _ => at_rest([true; 2]),
                        };
                        let data = pair.curved.as_ref().is_none_or(|c| c.data[e] == [0.0; 2]);
                        along == same
                            && traction == [0.0; 2]
                            && if is_oblique(along) {
                                data && other.ends.iter().all(framed)
                            } else {
                                at_rest(along.map(|d| d != 0.0))
                            }
                    }
                    (Role::Loaded(_) | Role::Pressed(_), Role::Loaded(t)) => t == [[0.0; 2]; 2],
                    // Of friction and of tied bodies there are none.
                    (Role::Contact { law: Law::Contact, .. }, Role::Loaded(t)) => {
                        t == [[0.0; 2]; 2]
                    }
                    // Along an axis, in which contact acts.
                    (Role::Contact { law: Law::Contact, .. }, Role::Held(held, _)) => {
                        let [d, end] = self.directions::<S>(e, &state.points);
                        let is = |c: usize| held[c] && !held[1 - c] && component(d, d) == one;
                        d == end && (0..2).any(|c| is(c) && d[1 - c] == zero)
                    }
                    _ => false,
                };
            if !right {
                return differs("edge", e);
            }
        }
        Ok(())
    }
}

/// A dual pair whose triangles are in equilibrium with the tractions of rho, which are known up to rounding.
struct Pair<S> {
    w: Shape<S>,
    /// rho N at both ends of each edge.
    forces: Vec<[Vector2<f64>; 2]>,
    /// How far a component of it may be off on each edge.
    off: Vec<f64>,
    stops: Vec<Stop<Ball>>,
}

/// The resultant of tractions on the edges of a triangle, to twice the precision of doubles: what tractions that balance to
/// rounding leave is then known by far better than rounding.
fn resultant(triangle: &Triangle<Ball>, forces: [[Vector2<Ball>; 2]; 3]) -> Wrench<Ball> {
    let precise = |v: Vector2<Ball>| v.map(|x| PreciseBall::around(x.centre().into(), x.radius()));
    let triangle = Triangle { vertices: triangle.vertices.map(precise) };
    let loads = Loads { forces: forces.map(|ends| ends.map(precise)), body: [Vector2::zeros(); 3] };
    let wrench = loads.resultant(&triangle).about(triangle.vertices[0]);
    let rounded = |v: Vector2<PreciseBall>| v.map(PreciseBall::rounded);
    Wrench {
        force: rounded(wrench.force),
        moment: wrench.moment.rounded(),
        about: rounded(wrench.about),
    }
}

/// Vectors in doubles, and how far a component may be from them.
fn in_doubles(vectors: [Vector2<Ball>; 2]) -> ([Vector2<f64>; 2], f64) {
    let mut off = 0.0_f64;
    let values = vectors.map(|v| {
        v.map(|x| {
            let (value, radius) = (x.centre(), x.radius());
            off = off.max(radius);
            value
        })
    });
    (values, off)
}

/// A dual pair with its sums over the triangles.
struct Summed<S> {
    pair: Pair<S>,
    /// int C^-1 (C eps(v) - tau) : (C eps(w) - rho)
    product: Ball,
    /// An upper bound of eta.
    eta: f64,
    /// An upper bound of |w|_a^2, where the error of data is to be multiplied with it.
    norm: Ball,
    /// The shares of the triangles in eta^2.
    shares: Vec<f64>,
}

impl<S: Enclosing> Forces<'_, S> {
    /// Encloses the contact force with the weight of its target by each of some dual pairs; an end may be infinite.
    ///
    /// # Errors
    /// A pair that is none; one whose w is not what it should be on Gamma_C.
    pub fn by_pairs(
        &self,
        pairs: &[(ForceTarget, Certificate)],
        cover: Option<&Cover>,
    ) -> Result<Vec<ByPair>, WrongPair> {
        let sums = self.sums(pairs)?;
        let all = pairs.iter().zip(sums);
        all.map(|((target, pair), sums)| self.by_sums(pair, *target, sums, cover)).collect()
    }

    /// Verifies that this is a pair, whose tractions balance on every triangle to the rounding of doubles, and bounds those that
    /// make up for the rest.
    fn pair(&self, pair: &Certificate) -> Result<Pair<S>, WrongPair> {
        let (certificate, state) = (self.certificate, self.state);
        pair.check_fields()?;
        certificate.check_pair(pair, state)?;
        pair.check_displacement()?;
        let on_edge = |edge: &Edge| match edge.role {
            Role::Inner(force) | Role::Held(_, force) => force.map(exactly),
            Role::Supported { along, force, .. } => {
                force.map(|p| exactly::<Ball>(along) * Ball::point(p))
            }
            Role::Loaded(_) | Role::Pressed(_) | Role::Contact { .. } | Role::Facing => {
                [Vector2::zeros(); 2]
            }
        };
        let forces: Vec<[Vector2<Ball>; 2]> = pair.edges.iter().map(on_edge).collect();
        let points = pair.places::<Ball>();
        let Topology { owners, tree } = &state.topology;
        let of_piece = |(t, piece): (usize, &Piece)| {
            let triangle = Triangle { vertices: piece.vertices.map(|p| points[p]) };
            resultant(&triangle, outward(piece.edges, t, &state.topology, &forces))
        };
        let resultants: Vec<Wrench<Ball>> = pair.pieces.iter().enumerate().map(of_piece).collect();
        let given = |e: usize| forces[e];
        let on_edges = OnEdges { certificate: pair, owners, points: &points, forces: &given };
        let closed = on_edges.close(tree, &mut resultants.clone()).map_err(Rejection::from)?;
        pair.check_balance((&forces, &resultants), |_| Ball::from(0), &closed)?;
        let in_balance = forces
            .iter()
            .zip(&closed.added)
            .map(|(given, added)| in_doubles([given[0] + added[0], given[1] + added[1]]));
        let (forces, off) = in_balance.unzip();
        Ok(Pair { w: pair.shape(), forces, off, stops: closed.stops })
    }

    /// C eps(w) - rho on triangle `t` for the tractions in doubles, and the energy at most of what is to be added to those.
    fn apart(&self, (t, frame): (usize, &Frame<S>), pair: &Pair<S>) -> (Composite<S>, Ball) {
        let (state, piece) = (self.state, &self.certificate.pieces[t]);
        let triangle = &state.triangles[t];
        let mut forces = outward(piece.edges, t, &state.topology, &pair.forces);
        let mut off = piece.edges.iter().map(|&e| pair.off[e]).fold(0.0, f64::max);
        for stop in pair.stops.iter().filter(|stop| stop.root == t) {
            let (more, beside) = in_doubles(stop.force);
            (0..2).for_each(|k| forces[0][k] += more[k]);
            off += beside + f64::EPSILON * forces[0].iter().map(Vector2::amax).sum::<f64>();
        }
        let forces = forces.map(|ends| ends.map(|force| exactly(force.into())));
        let loads = Loads { forces, body: [Vector2::zeros(); 3] };
        let apart = Composite::new(frame, &loads).distance_from(&pair.w.stress(piece, triangle));
        let triangle = Triangle { vertices: triangle.vertices.map(|v| v.map(S::ball)) };
        let loads = Loads {
            forces: [[Vector2::repeat(Ball::around(0.0, off)); 2]; 3],
            body: [Vector2::zeros(); 3],
        };
        let beside = Composite::new(&Frame::new(&triangle), &loads);
        (apart, beside.energy(&piece.material(), triangle.double_area()))
    }

    /// Verifies that these are pairs and sums over the triangles.
    fn sums(&self, pairs: &[(ForceTarget, Certificate)]) -> Result<Vec<Summed<S>>, WrongPair> {
        if pairs.is_empty() {
            return Ok(Vec::new());
        }
        let (state, pieces) = (self.state, &self.certificate.pieces);
        let start = |(_, pair): &(ForceTarget, Certificate)| {
            let (zero, shares) = (Ball::from(0), Vec::with_capacity(pieces.len()));
            Ok((self.pair(pair)?, [zero; 4], shares))
        };
        let mut sums = pairs.iter().map(start).collect::<Result<Vec<_>, WrongPair>>()?;
        let mut of_mean = Ball::from(0);
        for (t, piece) in pieces.iter().enumerate() {
            let (triangle, material) = (&state.triangles[t], piece.material());
            let (double_area, frame) = (triangle.double_area(), Frame::new(triangle));
            let (_, own) = state.stresses(self.certificate, t);
            of_mean += own.energy(&material, double_area).ball();
            for (pair, [product, square, beside, norm], shares) in &mut sums {
                let (apart, rest) = self.apart((t, &frame), pair);
                let affine = (apart.corners, apart.centre);
                *product += own.product_with_affine(affine, &material, double_area).ball();
                let share = apart.energy(&material, double_area).ball();
                shares.push(share.centre());
                *square += share;
                *beside += rest;
                if self.loose != 0.0 {
                    *norm += energy(&pair.w, piece, triangle);
                }
            }
        }
        let root = |square: Ball| Ball::point(square.sqrt().upper());
        let summed = |(pair, [product, square, beside, norm], shares): (_, [Ball; 4], _)| {
            let [own, eta, beside] = [of_mean, square, beside].map(root);
            let product = product + Ball::around(0.0, (own * beside).upper());
            Summed { pair, product, eta: (eta + beside).upper(), norm, shares }
        };
        Ok(sums.into_iter().map(summed).collect())
    }

    fn by_sums(
        &self,
        roles: &Certificate,
        target: ForceTarget,
        sums: Summed<S>,
        cover: Option<&Cover>,
    ) -> Result<ByPair, WrongPair> {
        let (certificate, state) = (self.certificate, self.state);
        let Summed { pair, product, eta, norm, shares } = sums;
        let mut middle =
            self.within(&pair.w) + certificate.work_of_tractions(&state.forces, &pair.w);
        // What the corrections of r may add, and r at least and at most in units of |tau_n|.
        let (mut beside, mut most) = (Ball::from(0), [0.0_f64; 2]);
        for e in self.contact() {
            let Role::Contact { pressure, .. } = certificate.edges[e].role else { continue };
            if matches!(roles.edges[e].role, Role::Loaded(_)) {
                continue;
            }
            let d = certificate.directions(e, &state.points);
            let [start, end] = certificate.edges[e].ends.map(|p| state.points[p]);
            let length = (end - start).dot(&(end - start)).sqrt().ball();
            // |E| r at both ends.
            let r = [0, 1].map(|k| component(exactly(pair.forces[e][k].into()), d[k]));
            let g = certificate.gap(e, state);
            let (four, three, two) = (S::from(4), S::from(3), S::from(2));
            let at_start = g[0] * four + g[1] * three + g[2] * two + g[3];
            let at_end = g[0] + g[1] * two + g[2] * three + g[3] * four;
            middle -= (r[0] * at_start + r[1] * at_end) / S::from(20);
            let off = Ball::around(0.0, pair.off[e]);
            beside += (off * at_start.ball() + off * at_end.ball()) / Ball::from(20);
            for k in 0..2 {
                let r = (r[k].ball() + off) / length;
                most[0] = most[0].max(ratio(-r.lower(), -pressure[k]));
                most[1] = most[1].max(ratio(r.upper(), -pressure[k]));
            }
        }
        let missed = self.all_missed(&pair.w, target, cover)?;
        let point = Ball::point;
        let middle = middle.ball() + beside + product / Ball::from(2);
        let (eta, norm) = (point(eta), point(norm.sqrt().upper()));
        let force = point(cover.map_or(0.0, Cover::force));
        let loose = point(2.0 * self.loose) * (norm + eta / Ball::from(2));
        let factors = [0, 1].map(|side| most[side].max(missed.open[side]));
        let away = |side: usize| {
            let k = factors[side];
            let covered = point(missed.covered[side]) * force;
            if k.is_finite() {
                (reach(eta, point(k), self.mean) + covered + loose).upper()
            } else {
                f64::INFINITY
            }
        };
        let ends = [(middle - point(away(0))).lower(), (middle + point(away(1))).upper()];
        let between = [
            if ends[0].is_nan() { f64::NEG_INFINITY } else { ends[0] },
            if ends[1].is_nan() { f64::INFINITY } else { ends[1] },
        ];
        Ok(ByPair { between, shares, factors })
    }
}
