//! The integrals of method (8) and of J_h over one contact edge, for P given by its values at the nodes of the edge.
//!
//! On the edge, parametrised by s in \[0, 1\], P = sum_a p_a N_a(s) with the Lagrange polynomials N_a of degree p. With the
//! weight |E| / gamma outside, (8) needs
//!
//! - energy    1/2 int \[P\]+^2, its share of J_h,
//! - gradient  int \[P\]+ N_a, the derivative of the energy with respect to p_a,
//! - hessian   int_{P > 0} N_a N_b, the derivative that Newton uses,
//! - active    the measure of {P > 0}.
//!
//! **Exact**: the edge is cut at the roots of P, so there is no quadrature error at all: in closed form for P1, whose
//! positive part lives on one interval; with three Gauss points on each of at most two intervals for P2 (degree 4).
//! **Gauss**: the points of a rule on the whole edge, \[.\]+ at each.
//!
//! In a body of revolution the integrals but the measure have the weight r, affine along the edge: one degree more, for which the same
//! cuts and points are exact.

use super::contact_edge::integral_of_product;
use super::{Element, P1, P2, Scalar, positive_part, positive_part_slope};

/// The integrals over s in \[0, 1\]; multiply all but `active` by |E| / gamma, and `active` by |E|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeIntegrals<S, const M: usize> {
    /// 1/2 int \[P\]+^2
    pub energy: S,
    /// int \[P\]+ N_a
    pub gradient: [S; M],
    /// int_{P > 0} N_a N_b
    pub hessian: [[S; M]; M],
    /// the measure of {P > 0}
    pub active: S,
}

impl<S: Scalar, const M: usize> EdgeIntegrals<S, M> {
    const fn of(value: S) -> Self {
        EdgeIntegrals {
            energy: value,
            gradient: [value; M],
            hessian: [[value; M]; M],
            active: value,
        }
    }

    /// Adds a point of a rule: its weight without and with r, the value and slope of \[.\]+ there, and the shape functions.
    fn add(&mut self, [measure, weight]: [S; 2], positive: S, slope: S, shapes: [S; M]) {
        self.active += measure * slope;
        self.energy += weight * positive * positive / S::from(2);
        for a in 0..M {
            self.gradient[a] += weight * positive * shapes[a];
            for b in 0..M {
                self.hessian[a][b] += weight * slope * shapes[a] * shapes[b];
            }
        }
    }
}

/// P at `s` from its nodal values.
pub fn value_at<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(p: [S; M], s: S) -> S {
    let shapes = E::edge_values(s);
    (0..M).fold(S::from(0), |sum, a| sum + p[a] * shapes[a])
}

/// An element whose edge integrals are known exactly in the number type `S`: P1 in every field, P2 in doubles (the
/// roots of a quadratic P need a square root).
pub trait ExactEdge<S, const N: usize, const M: usize>: Element<N, M> {
    /// The integrals without quadrature error; with the weight r where r has these `radii` at the two ends. A NaN in `p` makes
    /// them NaN.
    fn exact_with(p: [S; M], radii: Option<[S; 2]>) -> EdgeIntegrals<S, M>;

    /// The integrals without a weight.
    fn exact(p: [S; M]) -> EdgeIntegrals<S, M> {
        Self::exact_with(p, None)
    }
}

/// The interval of \[0, 1\] on which the affine function with the values `p` at 0 and 1 is positive, as its two ends;
/// \[0, 0\] if there is none.
pub fn positive_interval<S: Scalar>(p: [S; 2]) -> [S; 2] {
    let (zero, one) = (S::from(0), S::from(1));
    let root = || p[0] / (p[0] - p[1]);
    let start = p[0].split(|_| p[1].split(|_| zero, |_| root()), |_| zero);
    let end = p[1].split(|_| p[0].split(|_| zero, |_| root()), |_| one);
    [start, end]
}

impl<S: Scalar> ExactEdge<S, 3, 2> for P1 {
    /// On its positive interval \[P\]+ is affine: \[p_0\]+ at the start and \[p_1\]+ at the end, and so are the N_a.
    fn exact_with(p: [S; 2], radii: Option<[S; 2]>) -> EdgeIntegrals<S, 2> {
        let [start, end] = positive_interval(p);
        let length = end - start;
        let positive = p.map(positive_part);
        let at_start: [S; 2] = P1::edge_values(start);
        let at_end: [S; 2] = P1::edge_values(end);
        let shapes = [0, 1].map(|a| [at_start[a], at_end[a]]);
        let r = radii.map(|r| [0, 1].map(|k| r[0] * shapes[0][k] + r[1] * shapes[1][k]));
        let product = |f, g| match r {
            None => integral_of_product(f, g),
            Some(r) => weighted_product(r, f, g),
        };
        let integral = |f, g| length * product(f, g);
        EdgeIntegrals {
            energy: integral(positive, positive) / S::from(2),
            gradient: shapes.map(|n| integral(positive, n)),
            hessian: shapes.map(|m| shapes.map(|n| integral(m, n))),
            active: length,
        }
    }
}

/// int r f g over an edge for affine functions in terms of their values at its ends.
pub fn edge_mass<S: Scalar>([a, b]: [S; 2]) -> [[S; 2]; 2] {
    let (three, twelve) = (S::from(3), S::from(12));
    let across = (a + b) / twelve;
    [[(three * a + b) / twelve, across], [across, (a + three * b) / twelve]]
}

/// int_0^1 r f g for three affine functions given by their values at 0 and 1.
pub fn weighted_product<S: Scalar>(r: [S; 2], f: [S; 2], g: [S; 2]) -> S {
    let [[start, across], [_, end]] = edge_mass(r);
    f[0] * (start * g[0] + across * g[1]) + f[1] * (across * g[0] + end * g[1])
}

impl ExactEdge<f64, 6, 3> for P2 {
    /// By the points of Gauss's rule on the pieces where P is positive.
    fn exact_with(p: [f64; 3], radii: Option<[f64; 2]>) -> EdgeIntegrals<f64, 3> {
        let mut sum = EdgeIntegrals::of(0.0);
        let mut cuts = Cuts::new();
        cuts.add_roots::<P2, 6, 3>(p);
        for [start, end] in cuts.pieces() {
            // By the sign of Simpson's sum, which is the integral of P: the value in the middle alone would take
            // (s - 1/2)^2 for zero. A NaN is not <= 0: the piece counts as positive and the integrals become NaN.
            if simpson::<P2, 6, 3>(p, [start, end]) <= 0.0 {
                continue;
            }
            for (s, weight) in gauss3(start, end) {
                // Inside a positive piece P itself is integrated: a rounding error of its sign near the ends of the piece must
                // not cut it again.
                let value = value_at::<P2, f64, 6, 3>(p, s);
                let weights = [weight, times_radius(weight, radii, s)];
                sum.add(weights, value, 1.0, P2::edge_values(s));
            }
        }
        sum
    }
}

/// The integral over \[start, end\] of the quadratic with the values `p` at the nodes, but for the factor (end - start) / 6: what
/// has one sign there has that of the integral.
pub(super) fn simpson<E: Element<N, M>, const N: usize, const M: usize>(
    p: [f64; M],
    [start, end]: [f64; 2],
) -> f64 {
    let [first, middle, last] =
        [start, (start + end) / 2.0, end].map(|s| value_at::<E, f64, N, M>(p, s));
    first + 4.0 * middle + last
}

/// r at `s` from its values at the two ends.
pub fn radius<S: Scalar>(radii: [S; 2], s: S) -> S {
    radii[0] * (S::from(1) - s) + radii[1] * s
}

/// A weight at `s`, times r where r has these `radii` at the two ends.
pub fn times_radius<S: Scalar>(weight: S, radii: Option<[S; 2]>, s: S) -> S {
    radii.map_or(weight, |radii| weight * radius(radii, s))
}

/// The integrals by a rule on the whole edge: `rule` yields points in \[0, 1\] with their weights. With the weight r where r has
/// these `radii` at the two ends.
pub fn gauss<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    p: [S; M],
    radii: Option<[S; 2]>,
    rule: impl IntoIterator<Item = (S, S)>,
) -> EdgeIntegrals<S, M> {
    let value = |(s, weight)| (value_at::<E, S, N, M>(p, s), s, weight);
    gauss_of::<E, S, N, M>(rule.into_iter().map(value), radii)
}

/// The integrals by a rule on the whole edge, from the values of P at its points: each with the point and its weight.
pub fn gauss_of<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    values: impl IntoIterator<Item = (S, S, S)>,
    radii: Option<[S; 2]>,
) -> EdgeIntegrals<S, M> {
    let mut sum = EdgeIntegrals::of(S::from(0));
    for (value, s, weight) in values {
        let (positive, slope) = (positive_part(value), positive_part_slope(value));
        sum.add([weight, times_radius(weight, radii, s)], positive, slope, E::edge_values(s));
    }
    sum
}

/// The integrals with P in place of \[P\]+, where an interface pulls as well as it pushes; with the weight r by Boole's rule, which is
/// exact for it.
pub fn bilateral<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    p: [S; M],
    radii: Option<[S; 2]>,
) -> EdgeIntegrals<S, M> {
    if radii.is_some() {
        let mut sum = EdgeIntegrals::of(S::from(0));
        for (i, weight) in [(0, 7), (1, 32), (2, 12), (3, 32), (4, 7)] {
            let (s, weight) = (S::from(i) / S::from(4), S::from(weight) / S::from(90));
            let (value, weights) =
                (value_at::<E, S, N, M>(p, s), [weight, times_radius(weight, radii, s)]);
            sum.add(weights, value, S::from(1), E::edge_values(s));
        }
        return sum;
    }
    let hessian: [[S; M]; M] =
        std::array::from_fn(|a| std::array::from_fn(|b| mass::<E, S, N, M>(a, b)));
    let gradient: [S; M] = hessian.map(|row| (0..M).fold(S::from(0), |sum, b| sum + row[b] * p[b]));
    let energy = (0..M).fold(S::from(0), |sum, a| sum + gradient[a] * p[a]) / S::from(2);
    EdgeIntegrals { energy, gradient, hessian, active: S::from(1) }
}

/// int N_a N_b over \[0, 1\].
fn mass<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(a: usize, b: usize) -> S {
    let (same, ends) = (a == b, a < 2 && b < 2);
    if E::DEGREE == 1 {
        return S::from(if same { 2 } else { 1 }) / S::from(6);
    }
    let thirtieths = match (same, ends) {
        (true, true) => 4,
        (true, false) => 16,
        (false, true) => -1,
        (false, false) => 2,
    };
    S::from(thirtieths) / S::from(30)
}

/// The Bregman distance of 1/2 \[.\]+^2 from `a` to `b`: 1/2 \[b\]+^2 - 1/2 \[a\]+^2 - \[a\]+ (b - a), written as the sum
/// 1/2 (\[b\]+ - \[a\]+)^2 + \[a\]+ \[-b\]+ of two terms that are never negative, so that nothing cancels. It is the part of
/// the change of J_h along a step that is not linear.
fn bregman<S: Scalar>(a: S, b: S) -> S {
    let (positive_a, positive_b) = (positive_part(a), positive_part(b));
    let d = positive_b - positive_a;
    d * d / S::from(2) + positive_a * positive_part(-b)
}

/// The integral over the edge of the Bregman distance from P to Q, without quadrature error: over the pieces on
/// which neither changes sign; with the weight r where r has these `radii` at the two ends.
pub fn exact_bregman<E: Element<N, M>, const N: usize, const M: usize>(
    p: [f64; M],
    q: [f64; M],
    radii: Option<[f64; 2]>,
) -> f64 {
    let mut cuts = Cuts::new();
    cuts.add_roots::<E, N, M>(p);
    cuts.add_roots::<E, N, M>(q);
    let rule =
        |[start, end]: [f64; 2]| gauss3(start, end).map(|(s, w)| (s, times_radius(w, radii, s)));
    cuts.pieces().map(|piece| gauss_bregman::<E, f64, N, M>(p, q, rule(piece))).sum()
}

/// The integral by a Gauss rule on the whole edge.
pub fn gauss_bregman<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    p: [S; M],
    q: [S; M],
    rule: impl IntoIterator<Item = (S, S)>,
) -> S {
    rule.into_iter().fold(S::from(0), |sum, (s, weight)| {
        let (a, b) = (value_at::<E, S, N, M>(p, s), value_at::<E, S, N, M>(q, s));
        sum + weight * bregman(a, b)
    })
}

/// The largest value of P on the edge: at an end, or at the vertex of the parabola. NaN if one of them is.
pub fn maximum<E: Element<N, M>, const N: usize, const M: usize>(p: [f64; M]) -> f64 {
    let [_, b, c] = monomials::<E, N, M>(p);
    // Without a vertex (c = 0) this is 0 or beyond 1: `max` takes the 0 in place of a NaN.
    let vertex = (-b / (2.0 * c)).max(0.0);
    [0.0, vertex.min(1.0), 1.0]
        .map(|s| value_at::<E, f64, N, M>(p, s))
        .into_iter()
        .fold(f64::NEG_INFINITY, |max, p| if p <= max || max.is_nan() { max } else { p })
}

/// The places inside (0, 1) where P changes its sign, in no particular order.
pub fn roots<E: Element<N, M>, const N: usize, const M: usize>(
    p: [f64; M],
) -> impl Iterator<Item = f64> {
    let mut cuts = Cuts::new();
    cuts.add_roots::<E, N, M>(p);
    (2..cuts.len).map(move |i| cuts.at[i])
}

/// a + b s + c s^2 from the values at 0, 1/2 and 1.
fn monomials<E: Element<N, M>, const N: usize, const M: usize>(p: [f64; M]) -> [f64; 3] {
    let [start, middle, end] = [0.0, 0.5, 1.0].map(|s| value_at::<E, f64, N, M>(p, s));
    if E::DEGREE == 1 {
        [start, end - start, 0.0]
    } else {
        [start, 4.0 * middle - 3.0 * start - end, 2.0 * (start + end) - 4.0 * middle]
    }
}

/// \[0, 1\] cut at the places where up to four polynomials of degree <= 2 may change sign.
pub(super) struct Cuts {
    at: [f64; 10],
    len: usize,
}

impl Cuts {
    pub(super) fn new() -> Self {
        let mut at = [0.0; 10];
        at[1] = 1.0;
        Cuts { at, len: 2 }
    }

    /// Adds the roots of P inside (0, 1), by the formula that doesn't cancel. A double root changes no sign and is left
    /// out; that the two roots near it are inexact is harmless, for the integrals of \[P\]+ are C^1 in the roots.
    pub(super) fn add_roots<E: Element<N, M>, const N: usize, const M: usize>(
        &mut self,
        p: [f64; M],
    ) {
        let [a, b, c] = monomials::<E, N, M>(p);
        let discriminant = b * b - 4.0 * a * c;
        if discriminant > 0.0 {
            let q = -0.5 * (b + discriminant.sqrt().copysign(b));
            for root in [q / c, a / q] {
                if 0.0 < root && root < 1.0 {
                    self.at[self.len] = root;
                    self.len += 1;
                }
            }
        }
    }

    pub(super) fn pieces(&mut self) -> impl Iterator<Item = [f64; 2]> {
        let cuts = &mut self.at[..self.len];
        cuts.sort_unstable_by(f64::total_cmp);
        cuts.windows(2).map(|w| [w[0], w[1]])
    }
}

/// The Gauss rule with three points on \[start, end\]: exact for polynomials of degree 5.
pub(super) fn gauss3(start: f64, end: f64) -> [(f64, f64); 3] {
    let (middle, half) = ((start + end) / 2.0, (end - start) / 2.0);
    let offset = 0.6_f64.sqrt() * half;
    [
        (middle - offset, half * (5.0 / 9.0)),
        (middle, half * (8.0 / 9.0)),
        (middle + offset, half * (5.0 / 9.0)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_is_not_no_contact() {
        assert!(P1::exact([f64::NAN, -1.0]).energy.is_nan());
        assert!(P1::exact([-1.0, f64::NAN]).energy.is_nan());
        assert!(P2::exact([-1.0, f64::NAN, -1.0]).energy.is_nan());
        assert!(gauss::<P1, f64, 3, 2>([f64::NAN, -1.0], None, [(0.5, 1.0)]).energy.is_nan());
        assert!(maximum::<P1, 3, 2>([f64::NAN, -1.0]).is_nan());
        assert!(maximum::<P1, 3, 2>([-1.0, f64::NAN]).is_nan());
    }

    /// Boole's rule and the matrix without a weight; r that is constant is none.
    #[test]
    fn what_pulls_as_well_is_the_same_with_the_weight_1() {
        for p in [[1.0, -2.0, 0.3], [-1.0, 3.0, 0.5], [0.0, 0.0, 1.0]] {
            let (flat, ring) = (
                bilateral::<P2, f64, 6, 3>(p, None),
                bilateral::<P2, f64, 6, 3>(p, Some([1.0; 2])),
            );
            let near = |a: f64, b: f64| (a - b).abs() < 1e-15;
            assert!(near(flat.energy, ring.energy) && near(flat.active, ring.active));
            for a in 0..3 {
                assert!(near(flat.gradient[a], ring.gradient[a]));
                assert!((0..3).all(|b| near(flat.hessian[a][b], ring.hessian[a][b])));
            }
        }
    }
}
