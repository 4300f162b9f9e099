//! A contact force between two numbers of second order, by a dual pair (w, rho): w a displacement as in
//! [`forces`](super::forces), rho a stress with div rho = 0, rho n = 0 on Gamma_N and rho n = r n on Gamma_C. Exactly
//!
//! R = R0 - int C^-1 (sigma(u) - m) : (C eps(w) - rho) + int r (g - u_n) + int |sigma_n| omega,   omega = phi - w_n,
//! R0 = L(w) - a(v, w) + int r (v_n - g) + 1/2 int C^-1 (C eps(v) - tau) : (C eps(w) - rho)                          \[Q4\]
//!
//! (docs/theory.md, 7.7). With eta = |C eps(w) - rho|, r >= 0 and omega >= 0 it is at least R0 - M eta. In general the two
//! integrals over Gamma_C are bounded by B and A where r is bounded by multiples of |tau_n| and omega by multiples of g -
//! v_n.
//!
//! The pair is itself a certificate on the same triangles, of the linear problem whose contact edges are held along the
//! direction of contact, an axis, or free.

use super::balanced::Balanced;
use super::certificate::{Certificate, Curved, Edge, Piece, Role, is_oblique};
use super::checks::Rejection;
use super::forces::{Cover, ForceTarget, Forces, WrongLifting, component, ratio, reach};
use crate::kernel::composite::Composite;
use crate::kernel::{Ball, Enclosing, Material, Stress};

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
                    (Role::Contact { .. }, Role::Loaded(t)) => t == [[0.0; 2]; 2],
                    // Along an axis, in which contact acts.
                    (Role::Contact { .. }, Role::Held(held, _)) => {
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

impl<S: Enclosing> Forces<'_, S> {
    /// Encloses the contact force with the weight of its target by a dual pair, whose tractions balance on every triangle to the
    /// rounding of doubles; an end may be infinite.
    ///
    /// # Errors
    /// A pair that is none; one whose w is not what it should be on Gamma_C.
    pub fn by_pair(
        &self,
        target: ForceTarget,
        pair: &Certificate,
        cover: Option<&Cover>,
    ) -> Result<ByPair, WrongPair> {
        let (certificate, state) = (self.certificate, self.state);
        pair.check_fields()?;
        certificate.check_pair(pair, state)?;
        let dual = pair.balanced::<S>(state.topology.clone())?;
        pair.check_balance(&dual)?;
        // int C^-1 (C eps(v) - tau) : (C eps(w) - rho), eta^2 and, where the error of data is to be multiplied with it, |w|_a^2.
        let (mut product, mut eta, mut norm) = (S::from(0), S::from(0), S::from(0));
        let mut shares = Vec::with_capacity(pair.pieces.len());
        for (t, piece) in pair.pieces.iter().enumerate() {
            let (material, double_area) = (piece.material(), dual.triangles[t].double_area());
            let (_, own) = state.stresses(certificate, t);
            let (sigma, apart) = dual.stresses(pair, t);
            product += product_of(&material, &own, &apart, double_area);
            let share = apart.energy(&material, double_area);
            shares.push(share.upper());
            eta += share;
            if self.loose != 0.0 {
                norm += sigma.energy(&material, double_area);
            }
        }
        let (on_contact, most) = self.on_contact(pair, &dual);
        let middle = self.within(&dual.v)
            + certificate.work_of_tractions(&state.forces, &dual.v)
            + product / S::from(2)
            + on_contact;
        let missed = self.all_missed(&dual.v, target, cover)?;
        let point = Ball::point;
        let root = |square: S| point(square.split(|_| S::from(0), |s| s).sqrt().upper());
        let (eta, norm) = (root(eta), root(norm));
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
        let ends = [
            (point(middle.lower()) - point(away(0))).lower(),
            (point(middle.upper()) + point(away(1))).upper(),
        ];
        let between = [
            if ends[0].is_nan() { f64::NEG_INFINITY } else { ends[0] },
            if ends[1].is_nan() { f64::INFINITY } else { ends[1] },
        ];
        Ok(ByPair { between, shares, factors })
    }

    /// int r (v_n - g), and r at least and at most in units of |tau_n|.
    fn on_contact(&self, pair: &Certificate, dual: &Balanced<S>) -> (S, [f64; 2]) {
        let (certificate, state) = (self.certificate, self.state);
        let (mut work, mut most) = (S::from(0), [0.0_f64; 2]);
        for e in self.contact() {
            let Role::Contact { pressure, .. } = certificate.edges[e].role else { continue };
            if matches!(pair.edges[e].role, Role::Loaded(_)) {
                continue;
            }
            let d = certificate.directions(e, &state.points);
            let [start, end] = certificate.edges[e].ends.map(|p| state.points[p]);
            let length = (end - start).dot(&(end - start)).sqrt();
            // |E| r at both ends.
            let r = [0, 1].map(|k| component(dual.in_balance[e][k], d[k]));
            let g = certificate.gap(e, state);
            let (four, three, two) = (S::from(4), S::from(3), S::from(2));
            let at_start = g[0] * four + g[1] * three + g[2] * two + g[3];
            let at_end = g[0] + g[1] * two + g[2] * three + g[3] * four;
            work -= (r[0] * at_start + r[1] * at_end) / S::from(20);
            for k in 0..2 {
                let r = r[k] / length;
                most[0] = most[0].max(ratio(-r.lower(), -pressure[k]));
                most[1] = most[1].max(ratio(r.upper(), -pressure[k]));
            }
        }
        (work, most)
    }
}

/// int_T a : C^-1 b, b without bulges: as [`Composite::energy`] is that of squares.
fn product_of<S: Enclosing>(
    material: &Material<S>,
    a: &Composite<S>,
    b: &Composite<S>,
    double_area: S,
) -> S {
    let (two, three, eight) = (S::from(2), S::from(3), S::from(8));
    let [of_a, of_b] = [a, b].map(|tau| tau.centre * (two / three));
    let squares = material.squares();
    let mut sum = squares.products(a.centre, b.centre).map(|x| eight * x);
    let mut add = |factor: S, a: Stress<S>, b: Stress<S>| {
        let products = squares.products(a, b);
        (0..2).for_each(|k| sum[k] += factor * products[k]);
    };
    for ([p, q], [s, t]) in a.corners.into_iter().zip(b.corners) {
        add(three, p + q + of_a, s + t + of_b);
        add(S::from(1), p - q, s - t);
    }
    for (bulges, [s, t]) in a.bulges.iter().flatten().zip(b.corners) {
        for (&bulge, opposite) in bulges.iter().zip([b.centre, t, s]) {
            add(eight / S::from(5), bulge, (s + t + b.centre) * two - opposite);
        }
    }
    squares.per_moduli(sum) * double_area / S::from(576)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Plane;

    fn composite(k: i32, bulges: bool) -> Composite<f64> {
        let number = |k: i32| f64::from((7919 * k + 11) % 10007) / 5003.5 - 1.0;
        let stress = |i: i32| Stress::new([0, 1, 2].map(|m| number(k + 13 * i + 5 * m)));
        let at = |i: usize, j: usize| stress((3 * i + j) as i32);
        Composite {
            corners: [0, 1, 2].map(|i| [0, 1].map(|j| at(i, j))),
            centre: stress(17),
            bulges: bulges.then(|| [0, 1, 2].map(|i| [0, 1, 2].map(|j| at(i + 4, j)))),
        }
    }

    #[test]
    fn the_product_of_two_stresses_is_that_of_their_energies() {
        let sheared = Material::tensor([9.0, 2.0, -1.0, 4.0, 1.5, 2.0], None);
        for material in [Material::lame(1.3, 0.7, Plane::Strain), sheared] {
            for bent in [false, true] {
                let (a, b) = (composite(2, bent), composite(5, false));
                let energy = |sign: f64| {
                    let both = |a: Stress<f64>, b: Stress<f64>| a + b * sign;
                    let corner = |i: usize| [0, 1].map(|j| both(a.corners[i][j], b.corners[i][j]));
                    let corners = [0, 1, 2].map(corner);
                    let sum = Composite { corners, centre: both(a.centre, b.centre), ..a };
                    sum.energy(&material, 0.6)
                };
                let [plus, minus] = [energy(1.0), energy(-1.0)];
                let found = product_of(&material, &a, &b, 0.6);
                let expected = (plus - minus) / 4.0;
                assert!((found - expected).abs() <= 1e-13 * plus, "{found}, {expected}");
                // Control: a bulge counts.
                let flat = Composite { bulges: None, ..a };
                assert!((product_of(&material, &flat, &b, 0.6) != found) == bent);
            }
        }
    }
}
