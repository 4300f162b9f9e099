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

use nalgebra::Vector2;

use super::balance::{OnEdges, Stop};
use super::balanced::outward;
use super::certificate::{Certificate, Curved, Edge, Law, Piece, Role, Shape, exactly};
use super::checks::Rejection;
use super::forces::{
    Cover, ForceTarget, Forces, Lifting, WrongLifting, component, energy, ratio, reach,
};
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

/// A dual pair on the triangles of a certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct Dual {
    /// w
    pub w: Lifting,
    /// The roles of the edges in the linear problem, with the tractions of rho.
    pub roles: Vec<Role>,
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

impl Certificate {
    /// The certificate of the linear problem of a dual pair, on the same triangles and without loads. What holds the body holds w
    /// at 0, and contact edges that are held have what w is there.
    fn of_pair<S: Enclosing>(
        &self,
        Dual { w, roles }: &Dual,
        points: &[Vector2<S>],
    ) -> Result<Certificate, WrongPair> {
        if roles.len() != self.edges.len() {
            return Err(WrongPair::Differs { what: "the number of edges", index: roles.len() });
        }
        let is_free = |t: [[f64; 2]; 2]| t == [[0.0; 2]; 2];
        for (e, (own, &role)) in self.edges.iter().zip(roles).enumerate() {
            let right = match (own.role, role) {
                (Role::Inner(_), Role::Inner(_)) => true,
                (Role::Held(held, _), Role::Held(same, _)) => held == same,
                (
                    Role::Supported { along, .. },
                    Role::Supported { along: same, traction: [0.0, 0.0], .. },
                ) => along == same,
                // Of friction and of tied bodies there are none.
                (
                    Role::Loaded(_) | Role::Pressed(_) | Role::Contact { law: Law::Contact, .. },
                    Role::Loaded(t),
                ) => is_free(t),
                // Along an axis, in which contact acts.
                (Role::Contact { law: Law::Contact, .. }, Role::Held(held, _)) => {
                    let [d, end] = self.directions::<S>(e, points);
                    let (zero, one) = (S::from(0), S::from(1));
                    let is = |c: usize| held[c] && !held[1 - c] && component(d, d) == one;
                    d == end && (0..2).any(|c| is(c) && d[1 - c] == zero)
                }
                _ => false,
            };
            if !right {
                return Err(WrongPair::Differs { what: "edge", index: e });
            }
        }
        let at_rest = |data: &[Option<f64>; 2]| data.map(|u| u.map(|_| 0.0));
        let mut prescribed: Vec<_> = self.prescribed.iter().map(at_rest).collect();
        let mut at_cuts = match &self.curved {
            Some(curved) => curved.prescribed.iter().map(at_rest).collect(),
            None => vec![[None; 2]; self.cuts.len()],
        };
        for (edge, role) in self.edges.iter().zip(roles) {
            let (Role::Contact { .. }, Role::Held(held, _)) = (edge.role, *role) else { continue };
            for p in edge.ends {
                let (data, values, k) = match (p.checked_sub(self.vertices.len()), &w.beyond) {
                    (None, _) => (&mut prescribed, &w.vertices, p),
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
        let pair = Certificate {
            vertices: self.vertices.clone(),
            cuts: self.cuts.clone(),
            displacement: w.vertices.clone(),
            curved: w.beyond.clone().map(|[values, bulges]| Curved {
                at_cuts: values,
                prescribed: at_cuts,
                data: vec![[0.0; 2]; bulges.len()],
                bulges,
            }),
            prescribed,
            frames: self.frames.clone(),
            pieces: self.pieces.iter().map(unloaded).collect(),
            edges: edges.map(|(edge, &role)| Edge { ends: edge.ends, role }).collect(),
            ..Certificate::default()
        };
        pair.check_fields()?;
        pair.check_displacement()?;
        Ok(pair)
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
    let precise = |v: Vector2<Ball>| v.map(PreciseBall::from);
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
    let radii = vectors.iter().flatten().map(|x| x.radius());
    (vectors.map(|v| v.map(Ball::centre)), radii.fold(0.0, f64::max))
}

/// The work on a gap of a traction on an edge that is as much as `off` at each of its ends, with 20 times the integrals of the gap with
/// the hat functions of these.
fn work_of(off: Ball, [at_start, at_end]: [Ball; 2]) -> Ball {
    (off * at_start + off * at_end) / Ball::from(20)
}

impl<S: Enclosing> Forces<'_, S> {
    /// Verifies that this is a pair, whose tractions balance on every triangle to the rounding of doubles, and bounds those that
    /// make up for the rest.
    fn pair(&self, pair: &Dual) -> Result<Pair<S>, WrongPair> {
        let state = self.state;
        let pair = self.certificate.of_pair(pair, &state.points)?;
        let points = pair.places::<Ball>();
        let (topology, forces) = (&state.topology, pair.tractions(&points));
        let of_piece = |(t, piece): (usize, &Piece)| {
            let triangle = Triangle { vertices: piece.vertices.map(|p| points[p]) };
            resultant(&triangle, outward(piece.edges, t, topology, &forces))
        };
        let resultants = pair.pieces.iter().enumerate().map(of_piece).collect();
        let on_edges = OnEdges { certificate: &pair, topology, points: &points, forces: &forces };
        let balance = on_edges.close(resultants).map_err(Rejection::from)?;
        pair.check_balance(&forces, |_| Ball::from(0), &balance)?;
        let (forces, off) = balance.forces.into_iter().map(in_doubles).unzip();
        Ok(Pair { w: pair.shape(), forces, off, stops: balance.stops })
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

    /// Encloses the contact force with the weight of its target by a dual pair; an end may be infinite.
    ///
    /// # Errors
    /// A `dual` that is no pair; a w that is not what the target asks for on Gamma_C.
    pub fn by_pair(
        &self,
        target: ForceTarget,
        dual: &Dual,
        cover: Option<&Cover>,
    ) -> Result<ByPair, WrongPair> {
        let (certificate, state, pair) = (self.certificate, self.state, self.pair(dual)?);
        let mut shares = Vec::with_capacity(certificate.pieces.len());
        // int C^-1 (C eps(v) - tau) : (C eps(w) - rho); the squares of |C eps(v) - tau|, of eta, of what is to be added to rho, and
        // of |w|_a, where the error of data is to be multiplied with that.
        let [mut product, mut own, mut eta, mut rest, mut norm] = [Ball::from(0); 5];
        for (t, piece) in certificate.pieces.iter().enumerate() {
            let (triangle, material) = (&state.triangles[t], piece.material());
            let double_area = triangle.double_area();
            let (_, of_tau) = state.stresses(certificate, t);
            own += of_tau.energy(&material, double_area).ball();
            let (apart, beside) = self.apart((t, &Frame::new(triangle)), &pair);
            let affine = (apart.corners, apart.centre);
            product += of_tau.product_with_affine(affine, &material, double_area).ball();
            let share = apart.energy(&material, double_area).ball();
            shares.push(share.centre());
            eta += share;
            rest += beside;
            if self.loose != 0.0 {
                norm += energy(&pair.w, piece, triangle);
            }
        }
        let root = |square: Ball| Ball::point(square.sqrt().upper());
        let [own, eta, rest, norm] = [own, eta, rest, norm].map(root);
        let product = product + Ball::around(0.0, (own * rest).upper());
        let eta = Ball::point((eta + rest).upper());
        let mut middle =
            self.within(&pair.w) + certificate.work_of_tractions(&state.forces, &pair.w);
        // What the corrections of r may add, and r at least and at most in units of |tau_n|.
        let (mut beside, mut most) = (Ball::from(0), [0.0_f64; 2]);
        for e in self.contact() {
            let Role::Contact { pressure, .. } = certificate.edges[e].role else { continue };
            if matches!(dual.roles[e], Role::Loaded(_)) {
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
            beside += work_of(off, [at_start, at_end].map(S::ball));
            for k in 0..2 {
                let r = (r[k].ball() + off) / length;
                most[0] = most[0].max(ratio(-r.lower(), -pressure[k]));
                most[1] = most[1].max(ratio(r.upper(), -pressure[k]));
            }
        }
        let missed = self.all_missed(&pair.w, target, cover)?;
        let point = Ball::point;
        let middle = middle.ball() + beside + product / Ball::from(2);
        let loose = point(2.0 * self.loose) * (norm + eta / Ball::from(2));
        let factors = [0, 1].map(|side| most[side].max(missed.open[side]));
        let away = |side: usize| {
            let k = factors[side];
            if k.is_finite() {
                (reach(eta, point(k), self.mean) + missed.covered[side] + loose).upper()
            } else {
                f64::INFINITY
            }
        };
        let ends = [(middle - point(away(0))).lower(), (middle + point(away(1))).upper()];
        // An end that is NaN is infinite.
        let between = [ends[0].max(f64::NEG_INFINITY), ends[1].min(f64::INFINITY)];
        Ok(ByPair { between, shares, factors })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balance::tests::square;
    use crate::balanced::Balanced;
    use crate::forces::Mean;

    #[test]
    fn doubles_are_off_by_the_largest_radius_of_them() {
        for place in 0..4 {
            let radius = |k: usize| if k == place { 0.25 } else { 0.125 };
            let vectors = [0, 2].map(|k| {
                let x = [k, k + 1].map(|k| Ball::around(k as f64, radius(k)));
                Vector2::from(x)
            });
            let (values, off) = in_doubles(vectors);
            assert_eq!(values.map(<[f64; 2]>::from), [[0.0, 1.0], [2.0, 3.0]]);
            assert_eq!(off, 0.25, "{place}");
        }
    }

    /// A gap that is 3 at the start and 1 at the end has the integrals 7/6 and 5/6 with the hat functions.
    #[test]
    fn what_tractions_are_off_does_work_on_both_ends_of_a_gap() {
        let at_ends = [7.0, 5.0].map(|x| Ball::point(20.0 * x / 6.0));
        let found = work_of(Ball::around(0.0, 0.5), at_ends);
        // Both together are 2, the mean of the gap.
        assert!((found.upper() - 1.0).abs() < 1e-12 && (found.lower() + 1.0).abs() < 1e-12);
    }

    #[test]
    fn with_its_supports_every_triangle_of_a_body_that_is_free_is_in_equilibrium() {
        let small = 2.0_f64.powi(-40);
        // Along x, where contact takes the force and leaves its moment, along y, and a moment of small / 6.
        let along = |start: [f64; 2], end: [f64; 2]| [start, end].map(|f| f.map(|f| f * small));
        for traction in [
            along([1.0, 0.0], [1.0, 0.0]),
            along([0.0, 1.0], [0.0, 1.0]),
            along([0.0, -1.0], [0.0, 1.0]),
        ] {
            let certificate = square(traction, [1.0; 2]);
            let topology = certificate.topology().unwrap();
            let mut state = certificate.balanced::<f64>(topology).unwrap();
            let of = |state: &Balanced<f64>, t: usize| {
                let loads = state.loads(&certificate.pieces[t], t);
                let Wrench { force, moment, .. } =
                    loads.resultant(&state.triangles[t]).about(Vector2::new(0.5, 0.0));
                [force[0], force[1], moment].map(|f| f / small)
            };
            // Forces of 1 are rounded at 2^-53, 2^-13 of `small`.
            let balances = |found: [f64; 3]| found.iter().all(|found| found.abs() < 1e-2);
            for t in 0..2 {
                assert!(balances(of(&state, t)), "{t}: {:?}", of(&state, t));
            }
            // Control: without the supports.
            state.balance.stops.clear();
            assert!(of(&state, 0).iter().any(|f| f.abs() > 0.1), "{:?}", of(&state, 0));
        }
    }

    #[test]
    fn a_support_acts_on_its_own_triangle_as_a_force_on_its_first_edge_does() {
        let certificate = square([[0.0; 2]; 2], [1.0; 2]);
        let state = certificate.balanced::<Ball>(certificate.topology().unwrap()).unwrap();
        let of = [None; 5];
        let forces = Forces::new(&certificate, &state, &of, Mean { square: 0.0, root: 0.0 });
        let force = [[0.5, -1.0], [0.25, 2.0]].map(Vector2::from);
        let with = |root: Option<usize>, on: Option<usize>| {
            let stop = |root| Stop { root, force: force.map(|f| f.map(Ball::point)), share: 0.0 };
            let mut pair = Pair {
                w: Shape { points: vec![Vector2::zeros(); 4], bulges: None },
                forces: vec![[Vector2::zeros(); 2]; 5],
                off: vec![0.0; 5],
                stops: root.map(stop).into_iter().collect(),
            };
            if let Some(edge) = on {
                pair.forces[edge] = force;
            }
            [0, 1].map(|t| {
                let (apart, beside) = forces.apart((t, &Frame::new(&state.triangles[t])), &pair);
                let material = certificate.pieces[t].material();
                (apart.energy(&material, state.triangles[t].double_area()), beside.upper())
            })
        };
        for root in 0..2 {
            let supported = with(Some(root), None);
            let pulled = with(None, Some(certificate.pieces[root].edges[0]));
            for t in 0..2 {
                let ((found, beside), (expected, _)) = (supported[t], pulled[t]);
                assert_eq!(found, expected, "{root}, {t}");
                // What is rounded there, and nothing elsewhere.
                assert_eq!(found.lower() > 0.1, t == root, "{root}, {t}: {found:?}");
                assert_eq!(beside > 0.0, t == root, "{root}, {t}: {beside}");
            }
        }
    }
}
