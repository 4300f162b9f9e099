//! Friction: what the tangential P_t = v_t - g_t - gamma sigma_t is cut off to, at a point and over one edge.
//!
//! With the bound m (gamma s for Tresca's slip bound s, mu \[P_n\]+ for Coulomb's coefficient mu), the method has
//!
//! - clip(P_t; m), the point of \[-m, m\] nearest to P_t, in place of \[P\]+: the traction is -clip / gamma,
//! - sticking where |P_t| < m, sliding where |P_t| >= m > 0, no friction where m <= 0.
//!
//! Over an edge P and m are given by their nodal values. The edge is cut where m, m - P and m + P change sign; on each section
//! the integrand is P, m, -m or nothing. (\[P + m\]+ - \[P - m\]+ - m would be the same, but for large m nothing of it is left.)

use super::contact_edge::integral_of_product;
use super::edge_integral::{Cuts, gauss3, positive_interval, simpson, value_at};
use super::{Element, P1, P2, Scalar, positive_part};

/// The point of \[-m, m\] nearest to x, for m >= 0. A NaN of x stays a NaN.
pub fn clip<S: Scalar>(x: S, m: S) -> S {
    (m - x).split(|_| m, |_| (m + x).split(|_| -m, |_| x))
}

/// The derivatives of clip(x; \[m\]+) with respect to x and to m that Newton's method uses: (1, 0) where |x| < m, else (0, 1) or
/// (0, -1) where m > 0, else (0, 0).
pub fn clip_slopes<S: Scalar>(x: S, m: S) -> [S; 2] {
    let (zero, one) = (S::from(0), S::from(1));
    let of = |sticks: S, left: S, right: S| {
        m.split(|_| zero, |_| (m - x).split(|_| right, |_| (m + x).split(|_| left, |_| sticks)))
    };
    [of(one, zero, zero), of(zero, -one, one)]
}

/// The integral of the clip from 0 to x, a convex function of x: x^2 / 2 within \[-m, m\], m |x| - m^2 / 2 beyond.
pub fn clip_energy<S: Scalar>(x: S, m: S) -> S {
    let q = clip(x, m);
    q * (x + (x - q)) / S::from(2)
}

/// The Bregman distance of [`clip_energy`] from `a` to `b`, written as (q_b - q_a)^2 / 2 + (q_b - q_a) (b - q_b), q = clip: two terms that
/// are never negative, so that nothing cancels.
pub fn clip_bregman<S: Scalar>(a: S, b: S, m: S) -> S {
    let q = clip(b, m);
    let d = q - clip(a, m);
    d * d / S::from(2) + d * (b - q)
}

/// The integrals over s in \[0, 1\] of F = clip(P; \[m\]+); multiply all but the measures by |E| / gamma, and these by |E|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionIntegrals<S, const M: usize> {
    /// The integral of [`clip_energy`], a potential of F for a given m.
    pub energy: S,
    /// int F N_a
    pub gradient: [S; M],
    /// int N_a N_b where the edge sticks: the derivative with respect to the values of P.
    pub by_p: [[S; M]; M],
    /// int +-N_a N_b where it slides: the derivative with respect to the values of m.
    pub by_bound: [[S; M]; M],
    /// The measure of {|P| < m}.
    pub sticks: S,
    /// The measure of {|P| >= m > 0}.
    pub slides: S,
}

impl<S: Scalar, const M: usize> FrictionIntegrals<S, M> {
    fn zero() -> Self {
        let zero = S::from(0);
        FrictionIntegrals {
            energy: zero,
            gradient: [zero; M],
            by_p: [[zero; M]; M],
            by_bound: [[zero; M]; M],
            sticks: zero,
            slides: zero,
        }
    }

    /// Adds a point of a rule: weight, F, P, the slopes there, and the shape functions.
    fn add(&mut self, weight: S, [f, p]: [S; 2], slopes: [S; 2], shapes: [S; M]) {
        let [by_p, by_bound] = slopes;
        self.energy += weight * f * (p + (p - f)) / S::from(2);
        self.sticks += weight * by_p;
        self.slides += weight * by_bound * by_bound;
        for a in 0..M {
            self.gradient[a] += weight * f * shapes[a];
            for b in 0..M {
                self.by_p[a][b] += weight * by_p * shapes[a] * shapes[b];
                self.by_bound[a][b] += weight * by_bound * shapes[a] * shapes[b];
            }
        }
    }
}

/// An element whose integrals of friction are known exactly in the number type `S`: P1 in every field, P2 in doubles.
pub trait ExactFriction<S, const N: usize, const M: usize>: Element<N, M> {
    /// The integrals without quadrature error, for P and m with these nodal values. A NaN in `p` makes them NaN where m > 0.
    fn exact_friction(p: [S; M], m: [S; M]) -> FrictionIntegrals<S, M>;
}

/// The interval of \[0, 1\] on which the affine function with the values `p` at 0 and 1 is not positive: what
/// [`positive_interval`] leaves; \[0, 0\] if that is all.
fn rest_interval<S: Scalar>(p: [S; 2]) -> [S; 2] {
    let (zero, one) = (S::from(0), S::from(1));
    let root = || p[0] / (p[0] - p[1]);
    let start = p[0].split(|_| zero, |_| p[1].split(|_| root(), |_| zero));
    let end = p[1].split(|_| one, |_| p[0].split(|_| root(), |_| zero));
    [start, end]
}

/// The intersection of two intervals; one without length where they have nothing in common.
fn intersection<S: Scalar>([a, b]: [S; 2], [c, d]: [S; 2]) -> [S; 2] {
    let larger = |x: S, y: S| (y - x).split(|_| x, |_| y);
    let smaller = |x: S, y: S| (y - x).split(|_| y, |_| x);
    let start = larger(a, c);
    [start, larger(start, smaller(b, d))]
}

impl<S: Scalar> ExactFriction<S, 3, 2> for P1 {
    fn exact_friction(p: [S; 2], m: [S; 2]) -> FrictionIntegrals<S, 2> {
        let pair = |f: fn(S, S) -> S| [f(m[0], p[0]), f(m[1], p[1])];
        let (below, above) = (pair(|m, p| m - p), pair(|m, p| m + p));
        let closed = positive_interval(m);
        let (zero, one) = (S::from(0), S::from(1));
        let sticks = intersection(positive_interval(below), positive_interval(above));
        let right = intersection(rest_interval(below), closed);
        let left = intersection(rest_interval(above), closed);
        let sections = [
            (sticks, p, [one, zero]),
            (right, m, [zero, one]),
            (left, m.map(|m| -m), [zero, -one]),
        ];
        let mut sum = FrictionIntegrals::zero();
        for ([start, end], f, [by_p, by_bound]) in sections {
            let at = |v: [S; 2]| [start, end].map(|s| value_at::<P1, S, 3, 2>(v, s));
            let (f, p, length) = (at(f), at(p), end - start);
            let (first, last): ([S; 2], [S; 2]) = (P1::edge_values(start), P1::edge_values(end));
            let shapes = [[first[0], last[0]], [first[1], last[1]]];
            let integral = |f, g| length * integral_of_product(f, g);
            let twice = [p[0] + (p[0] - f[0]), p[1] + (p[1] - f[1])];
            sum.energy += integral(f, twice) / S::from(2);
            sum.sticks += by_p * length;
            sum.slides += by_bound * by_bound * length;
            for a in 0..2 {
                sum.gradient[a] += integral(f, shapes[a]);
                for b in 0..2 {
                    let product = integral(shapes[a], shapes[b]);
                    sum.by_p[a][b] += by_p * product;
                    sum.by_bound[a][b] += by_bound * product;
                }
            }
        }
        sum
    }
}

impl ExactFriction<f64, 6, 3> for P2 {
    fn exact_friction(p: [f64; 3], m: [f64; 3]) -> FrictionIntegrals<f64, 3> {
        let (below, above) = bounds_and(p, m);
        let mut cuts = Cuts::new();
        for polynomial in [m, below, above] {
            cuts.add_roots::<P2, 6, 3>(polynomial);
        }
        let mut sum = FrictionIntegrals::zero();
        for piece in cuts.pieces() {
            let sum_of = |v: [f64; 3]| simpson::<P2, 6, 3>(v, piece);
            if sum_of(m) <= 0.0 {
                continue;
            }
            // A NaN of P is not <= 0: the section counts as sticking, and the integrals become NaN.
            let (f, slopes) = if sum_of(below) <= 0.0 {
                (m, [0.0, 1.0])
            } else if sum_of(above) <= 0.0 {
                (m.map(|m| -m), [0.0, -1.0])
            } else {
                (p, [1.0, 0.0])
            };
            for (s, weight) in gauss3(piece[0], piece[1]) {
                // Inside a section its own polynomial is integrated: a rounding error near its ends must not cut it again.
                let values = [f, p].map(|v| value_at::<P2, f64, 6, 3>(v, s));
                sum.add(weight, values, slopes, P2::edge_values(s));
            }
        }
        sum
    }
}

/// The nodal values of m - P and m + P.
fn bounds_and<const M: usize>(p: [f64; M], m: [f64; M]) -> ([f64; M], [f64; M]) {
    (std::array::from_fn(|a| m[a] - p[a]), std::array::from_fn(|a| m[a] + p[a]))
}

/// The integrals by a rule on the whole edge: `rule` yields points in \[0, 1\] with their weights.
pub fn gauss_friction<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    p: [S; M],
    m: [S; M],
    rule: impl IntoIterator<Item = (S, S)>,
) -> FrictionIntegrals<S, M> {
    let mut sum = FrictionIntegrals::zero();
    for (s, weight) in rule {
        let [p, m] = [p, m].map(|v| value_at::<E, S, N, M>(v, s));
        sum.add(weight, [clip(p, positive_part(m)), p], clip_slopes(p, m), E::edge_values(s));
    }
    sum
}

/// The integral over the edge of the [Bregman distance](clip_bregman) from P to Q for the bound m >= 0, without quadrature error:
/// over the sections on which neither meets the bound.
pub fn exact_clip_bregman<E: Element<N, M>, const N: usize, const M: usize>(
    p: [f64; M],
    q: [f64; M],
    m: [f64; M],
) -> f64 {
    let mut cuts = Cuts::new();
    for v in [p, q] {
        let (below, above) = bounds_and(v, m);
        cuts.add_roots::<E, N, M>(below);
        cuts.add_roots::<E, N, M>(above);
    }
    cuts.pieces()
        .map(|[start, end]| gauss_clip_bregman::<E, f64, N, M>(p, q, m, gauss3(start, end)))
        .sum()
}

/// The integral by a Gauss rule on the whole edge.
pub fn gauss_clip_bregman<E: Element<N, M>, S: Scalar, const N: usize, const M: usize>(
    p: [S; M],
    q: [S; M],
    m: [S; M],
    rule: impl IntoIterator<Item = (S, S)>,
) -> S {
    rule.into_iter().fold(S::from(0), |sum, (s, weight)| {
        let [a, b, m] = [p, q, m].map(|v| value_at::<E, S, N, M>(v, s));
        sum + weight * clip_bregman(a, b, m)
    })
}
