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
pub fn gauss_friction<E, S, const N: usize, const M: usize>(
    p: [S; M],
    m: [S; M],
    rule: impl IntoIterator<Item = (S, S)>,
) -> FrictionIntegrals<S, M>
where
    E: Element<N, M>,
    S: Scalar,
{
    let mut sum = FrictionIntegrals::zero();
    for (s, weight) in rule {
        let [p, m] = [p, m].map(|v| value_at::<E, S, N, M>(v, s));
        sum.add(weight, [clip(p, positive_part(m)), p], clip_slopes(p, m), E::edge_values(s));
    }
    sum
}

/// The integral over the edge of the [Bregman distance](clip_bregman) from P to Q for the bound m >= 0, without quadrature error:
/// over the sections on which neither meets the bound.
pub fn exact_clip_bregman<E, const N: usize, const M: usize>(
    p: [f64; M],
    q: [f64; M],
    m: [f64; M],
) -> f64
where
    E: Element<N, M>,
{
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
pub fn gauss_clip_bregman<E, S, const N: usize, const M: usize>(
    p: [S; M],
    q: [S; M],
    m: [S; M],
    rule: impl IntoIterator<Item = (S, S)>,
) -> S
where
    E: Element<N, M>,
    S: Scalar,
{
    rule.into_iter().fold(S::from(0), |sum, (s, weight)| {
        let [a, b, m] = [p, q, m].map(|v| value_at::<E, S, N, M>(v, s));
        sum + weight * clip_bregman(a, b, m)
    })
}

#[cfg(test)]
mod tests {
    use approx::{abs_diff_eq, assert_abs_diff_eq, assert_relative_eq};

    use super::*;

    /// A few roundings of numbers of size 1.
    const ROUNDING: f64 = 2e-15;

    /// 20,000 midpoints on the edge.
    fn fine() -> impl Iterator<Item = (f64, f64)> {
        (0..20_000).map(|i| ((f64::from(i) + 0.5) / 20_000.0, 1.0 / 20_000.0))
    }

    /// Returns whether two sets of integrals are the same to these tolerances, of what is continuous and of what jumps.
    fn close<const M: usize>(
        a: &FrictionIntegrals<f64, M>,
        b: &FrictionIntegrals<f64, M>,
        [smooth, jumps]: [f64; 2],
    ) -> bool {
        let near = |x: f64, y: f64, epsilon: f64| abs_diff_eq!(x, y, epsilon = epsilon);
        let entries = (0..M).all(|i| {
            near(a.gradient[i], b.gradient[i], smooth)
                && (0..M).all(|j| {
                    near(a.by_p[i][j], b.by_p[i][j], jumps)
                        && near(a.by_bound[i][j], b.by_bound[i][j], jumps)
                })
        });
        entries
            && near(a.energy, b.energy, smooth)
            && near(a.sticks, b.sticks, jumps)
            && near(a.slides, b.slides, jumps)
    }

    /// Values of P and m: sticking, sliding both ways, open, cut at one to six places.
    fn draws() -> impl Iterator<Item = [[f64; 3]; 2]> {
        let mut x = 0.7_f64;
        let mut next = move || {
            x = (x * 3.9) * (1.0 - x);
            2.0 * x - 1.0
        };
        (0..300).map(move |i| {
            let p = [next(), next(), next()];
            let m = [next(), next(), next()];
            match i % 3 {
                0 => [p, [m[0].abs(); 3]],
                1 => {
                    let [a, b] = [m[0].abs(), m[1].abs()];
                    [p, [a, b, (a + b) / 2.0]]
                }
                _ => [p, m],
            }
        })
    }

    /// Errors of the rule: a jump at one of six cuts costs a cell of the fine rule, times 1, a kink there the square of one.
    const FINE: [f64; 2] = [1e-7, 4e-4];

    fn agrees_with_a_fine_rule<E: ExactFriction<f64, N, M>, const N: usize, const M: usize>(
        bound: impl Fn(f64) -> f64,
    ) -> bool {
        draws().all(|[p, m]| {
            let of = |v: [f64; 3]| std::array::from_fn(|a| v[a]);
            let (p, m): ([f64; M], [f64; M]) = (of(p), of(m));
            let fine = gauss_friction::<E, f64, N, M>(p, m, fine());
            close(&E::exact_friction(p, m.map(&bound)), &fine, FINE)
        })
    }

    #[test]
    fn the_sections_of_p1_and_p2_agree_with_a_fine_rule() {
        assert!(agrees_with_a_fine_rule::<P1, 3, 2>(|m| m));
        assert!(agrees_with_a_fine_rule::<P2, 6, 3>(|m| m));
    }

    #[test]
    fn control_sections_for_a_bound_that_is_a_little_wider_do_not() {
        assert!(!agrees_with_a_fine_rule::<P1, 3, 2>(|m| m + 1e-3));
        assert!(!agrees_with_a_fine_rule::<P2, 6, 3>(|m| m + 1e-3));
    }

    #[test]
    fn nothing_cancels_for_a_large_bound() {
        let p = [0.3, -0.7];
        let sticking = P1::exact_friction(p, [1e300; 2]);
        let mass = |a: usize| [2.0 * p[a] + p[1 - a], 6.0];
        for a in 0..2 {
            let [above, below] = mass(a);
            assert_relative_eq!(sticking.gradient[a], above / below, max_relative = 1e-15);
        }
        // By [P + m]+ - [P - m]+ - m nothing would be left.
        assert_eq!((p[0] + 1e300) - 1e300, 0.0);
        assert_eq!(clip(0.3, 1e300), 0.3);
    }

    #[test]
    fn the_bregman_distance_is_the_nonlinear_part_of_the_change_of_energy() {
        for ([p, m], [q, _]) in draws().zip(draws().skip(7)) {
            let m = m.map(f64::abs);
            let m = [m[0], m[1], (m[0] + m[1]) / 2.0];
            let of = |v| P2::exact_friction(v, m);
            let linear: f64 = (0..3).map(|a| of(p).gradient[a] * (q[a] - p[a])).sum();
            let expected = of(q).energy - of(p).energy - linear;
            let found = exact_clip_bregman::<P2, 6, 3>(p, q, m);
            assert!(found >= 0.0);
            // Energies below 2 are subtracted.
            assert_abs_diff_eq!(found, expected, epsilon = 10.0 * ROUNDING);
        }
    }

    #[test]
    fn the_bregman_distance_keeps_its_digits_where_a_difference_of_energies_has_none() {
        let far = clip_bregman(1.0, 1.0 + 1e-9, 2.0);
        let step = (1.0 + 1e-9) - 1.0;
        assert_relative_eq!(far, step * step / 2.0, max_relative = 1e-15);
        let difference = clip_energy(1.0 + 1e-9, 2.0) - clip_energy(1.0, 2.0) - 1e-9;
        assert!((difference - step * step / 2.0).abs() > step * step);
    }

    #[test]
    fn nan_is_not_no_friction() {
        assert!(clip(f64::NAN, 1.0).is_nan());
        assert!(P1::exact_friction([f64::NAN, 0.0], [1.0, 1.0]).gradient[0].is_nan());
        assert!(P2::exact_friction([0.0, f64::NAN, 0.0], [1.0; 3]).gradient[0].is_nan());
        let gauss = gauss_friction::<P1, f64, 3, 2>([f64::NAN, 0.0], [1.0; 2], [(0.5, 1.0)]);
        assert!(gauss.energy.is_nan());
    }
}
