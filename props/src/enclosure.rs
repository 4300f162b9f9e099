//! Enclosed integrals: intervals that contain the integral of a function over a segment or a triangle, without any
//! assumption but that its formula says what the function is.
//!
//! A function is run over [`Taylor`] numbers: intervals that contain its value and its Taylor coefficients up to
//! [`ORDER`] at all points of a piece. With the coefficients f_a at the centre of the piece and F_a over all of it,
//!
//! f(x) lies in sum_{|a| <= n} f_a (x - centre)^a + sum_{|a| = n} (F_a - f_a) (x - centre)^a,   n = ORDER,
//!
//! and the integrals of the monomials are known. Where that says nothing, next to a point where f isn't smooth, the range
//! of f over the piece remains. A piece whose share is not known well enough is halved.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::numbers::Interval;
use signorini::kernel::{Enclosing, Scalar};

/// The order of the Taylor polynomials.
pub const ORDER: usize = 4;

/// How many coefficients of two variables there are up to that order.
const LENGTH: usize = (ORDER + 1) * (ORDER + 2) / 2;

/// A piece is halved at most that many times.
const DEEPEST: i32 = 60;

/// The exponents of the coefficients: by their sum, then by the second.
const EXPONENTS: [[usize; 2]; LENGTH] = exponents();

const fn exponents() -> [[usize; 2]; LENGTH] {
    let mut all = [[0; 2]; LENGTH];
    let (mut order, mut second, mut index) = (0, 0, 0);
    while index < LENGTH {
        all[index] = [order - second, second];
        index += 1;
        if second == order {
            order += 1;
            second = 0;
        } else {
            second += 1;
        }
    }
    all
}

/// Where the coefficient with these exponents is.
const fn index([i, j]: [usize; 2]) -> usize {
    (i + j) * (i + j + 1) / 2 + j
}

/// All real numbers.
fn everything() -> Interval {
    Interval::new(f64::NEG_INFINITY, f64::INFINITY)
}

fn is_zero(interval: Interval) -> bool {
    interval == Interval::from(0)
}

fn width(interval: Interval) -> f64 {
    interval.hi() - interval.lo()
}

/// The Taylor coefficients of a function of two variables, each enclosed at all points of a piece at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor([Interval; LENGTH]);

impl Taylor {
    /// A constant.
    pub fn constant(value: Interval) -> Taylor {
        Taylor::affine(value, [Interval::from(0); 2])
    }

    /// A function with these values and slopes, and without any curvature.
    fn affine(value: Interval, slopes: [Interval; 2]) -> Taylor {
        let mut all = [Interval::from(0); LENGTH];
        [all[0], all[1], all[2]] = [value, slopes[0], slopes[1]];
        Taylor(all)
    }

    /// A function of which no more is known than its range.
    pub fn range(values: Interval) -> Taylor {
        let mut all = [everything(); LENGTH];
        all[0] = values;
        Taylor(all)
    }

    /// Its values.
    pub fn value(self) -> Interval {
        self.0[0]
    }

    /// Its first derivatives.
    pub fn gradient(self) -> [Interval; 2] {
        [self.0[1], self.0[2]]
    }

    /// The two variables themselves, at a point.
    pub fn variables(x: [Interval; 2]) -> [Taylor; 2] {
        let (zero, one) = (Interval::from(0), Interval::from(1));
        [Taylor::affine(x[0], [one, zero]), Taylor::affine(x[1], [zero, one])]
    }
}

impl From<i32> for Taylor {
    fn from(value: i32) -> Taylor {
        Taylor::constant(Interval::from(value))
    }
}

impl Add for Taylor {
    type Output = Taylor;

    fn add(self, other: Taylor) -> Taylor {
        Taylor(std::array::from_fn(|a| self.0[a] + other.0[a]))
    }
}

impl Neg for Taylor {
    type Output = Taylor;

    fn neg(self) -> Taylor {
        Taylor(self.0.map(|c| -c))
    }
}

impl Sub for Taylor {
    type Output = Taylor;

    fn sub(self, other: Taylor) -> Taylor {
        self + -other
    }
}

/// Where the product of two coefficients belongs, if that is of no higher order.
fn product_index(a: usize, b: usize) -> Option<usize> {
    let ([i, j], [k, l]) = (EXPONENTS[a], EXPONENTS[b]);
    (i + j + k + l <= ORDER).then(|| index([i + k, j + l]))
}

impl Taylor {
    /// The numbers of the coefficients that are not known to be zero.
    fn present(&self) -> impl Iterator<Item = usize> {
        (0..LENGTH).filter(|&a| !is_zero(self.0[a]))
    }
}

impl Mul for Taylor {
    type Output = Taylor;

    fn mul(self, other: Taylor) -> Taylor {
        let mut product = [Interval::from(0); LENGTH];
        for a in self.present() {
            for b in other.present() {
                let Some(ab) = product_index(a, b) else { break };
                product[ab] += self.0[a] * other.0[b];
            }
        }
        Taylor(product)
    }
}

impl Div for Taylor {
    type Output = Taylor;

    /// From other * quotient = self: each coefficient of the quotient, once known, is taken away with all its products.
    fn div(self, other: Taylor) -> Taylor {
        let mut quotient = self.0;
        for a in 0..LENGTH {
            if is_zero(quotient[a]) && !other.0[0].contains(0.0) {
                continue;
            }
            quotient[a] /= other.0[0];
            for b in other.present().filter(|&b| b > 0) {
                let Some(ab) = product_index(a, b) else { break };
                quotient[ab] -= quotient[a] * other.0[b];
            }
        }
        Taylor(quotient)
    }
}

signorini::entry_of_nalgebra!(Taylor);

impl Scalar for Taylor {
    /// Where the sign is decided on all of the piece, the branch; else the hull of the values of both, for the function
    /// may have a kink there.
    fn split(
        self,
        nonpositive: impl FnOnce(Taylor) -> Taylor,
        positive: impl FnOnce(Taylor) -> Taylor,
    ) -> Taylor {
        let value = self.value();
        if value.hi() <= 0.0 {
            nonpositive(self)
        } else if value.lo() <= 0.0 {
            let below = nonpositive(Taylor::range(Interval::new(value.lo(), 0.0)));
            let above = positive(Taylor::range(Interval::new(0.0, value.hi())));
            Taylor::range(below.value().hull(above.value()))
        } else {
            positive(self)
        }
    }
}

impl Enclosing for Taylor {
    fn exactly(value: f64) -> Taylor {
        Taylor::constant(Interval::point(value))
    }

    fn upper(self) -> f64 {
        self.value().hi()
    }

    fn lower(self) -> f64 {
        self.value().lo()
    }

    /// From root * root = self: each coefficient of the root, once known, is taken away with all its products.
    fn sqrt(self) -> Taylor {
        let mut root = self.0;
        root[0] = root[0].sqrt();
        let twice = root[0] + root[0];
        for a in 1..LENGTH {
            root[a] /= twice;
            for b in 1..=a {
                let Some(ab) = product_index(a, b) else { break };
                let product = root[a] * root[b];
                root[ab] -= if a == b { product } else { product + product };
            }
        }
        Taylor(root)
    }
}

/// A segment (P = 2) or a triangle (P = 3) by its corners. A corner carries the values of C affine functions there, such
/// as its coordinates.
pub type Simplex<const P: usize, const C: usize> = [[Interval; C]; P];

fn half(a: Interval, b: Interval) -> Interval {
    (a + b) / Interval::from(2)
}

/// The two halves. The newest corner comes last and the side opposite to it is cut next, so that the angles of triangles
/// don't become ever smaller.
fn halves<const P: usize, const C: usize>(corners: &Simplex<P, C>) -> [Simplex<P, C>; 2] {
    let middle = std::array::from_fn(|c| half(corners[0][c], corners[1][c]));
    [1, 0].map(|replaced| {
        let mut part = *corners;
        part[replaced] = middle;
        part.rotate_left((replaced + 1) % P);
        part
    })
}

/// The affine functions on a simplex in the variables l_1 - 1/P, .., with l the barycentric coordinates: their values at
/// the centre, or those over all of it.
fn affine<const P: usize, const C: usize>(corners: &Simplex<P, C>, centre: bool) -> [Taylor; C] {
    std::array::from_fn(|c| {
        let values = corners.map(|corner| corner[c]);
        let slope = |k: usize| values.get(k).map_or(Interval::from(0), |&v| v - values[0]);
        let [first, rest @ ..] = &values[..] else { return Taylor::from(0) };
        let value = match centre {
            true => rest.iter().fold(*first, |s, &v| s + v) / Interval::from(P as i32),
            false => rest.iter().fold(*first, |hull, &v| hull.hull(v)),
        };
        Taylor::affine(value, [slope(1), slope(2)])
    })
}

/// The means over a simplex of the monomials up to ORDER in these variables, and bounds of the means of their magnitudes.
struct Monomials {
    means: [Interval; LENGTH],
    magnitudes: [Interval; LENGTH],
}

fn factorial(n: usize) -> Interval {
    (1..=n as i32).fold(Interval::from(1), |product, k| product * Interval::from(k))
}

/// The mean of (l_1 - 1/P)^i (l_2 - 1/P)^j by that of l_1^k l_2^m, which is n! k! m! / (n + k + m)! in n = P - 1 dimensions.
fn mean_of_monomial(corners: usize, [i, j]: [usize; 2]) -> Interval {
    let shift = -(Interval::from(1) / Interval::from(corners as i32));
    let term = |n: usize, k: usize| {
        let binomial = factorial(n) / (factorial(k) * factorial(n - k));
        (k..n).fold(binomial, |product, _| product * shift)
    };
    let mut sum = Interval::from(0);
    for k in 0..=i {
        for m in 0..=j {
            let dirichlet = factorial(corners - 1) * factorial(k) * factorial(m)
                / factorial(corners - 1 + k + m);
            sum += term(i, k) * term(j, m) * dirichlet;
        }
    }
    sum
}

impl Monomials {
    fn new(corners: usize) -> Self {
        Monomials {
            means: EXPONENTS.map(|e| mean_of_monomial(corners, e)),
            // By Schwarz's inequality.
            magnitudes: EXPONENTS.map(|e| mean_of_monomial(corners, e.map(|n| 2 * n)).sqrt()),
        }
    }

    /// The mean of a function with these coefficients at the centre and over the whole simplex.
    fn mean(&self, centre: Taylor, whole: Taylor) -> Interval {
        let mut sum = Interval::from(0);
        for (a, [i, j]) in EXPONENTS.into_iter().enumerate() {
            sum += centre.0[a] * self.means[a];
            if i + j == ORDER {
                let spread = (whole.0[a] - centre.0[a]) * self.magnitudes[a];
                sum += spread * Interval::new(-1.0, 1.0);
            }
        }
        sum
    }
}

/// The means of the components of f over one piece.
fn on_piece<const P: usize, const C: usize, const K: usize>(
    corners: &Simplex<P, C>,
    monomials: &Monomials,
    f: &impl Fn([Taylor; C]) -> [Taylor; K],
) -> [Interval; K] {
    let whole = f(affine(corners, false));
    let smooth = |t: &Taylor| t.0.iter().all(|c| width(*c).is_finite());
    if !whole.iter().any(smooth) {
        return whole.map(Taylor::value);
    }
    let centre = f(affine(corners, true));
    std::array::from_fn(|k| {
        let range = whole[k].value();
        let mean = monomials.mean(centre[k], whole[k]);
        if width(mean) < width(range) { mean } else { range }
    })
}

/// Encloses the mean of each component of f over a simplex: f gets the affine functions that the corners carry. A piece is
/// halved until its share in each mean is known to `tolerance`.
pub fn mean<const P: usize, const C: usize, const K: usize>(
    corners: Simplex<P, C>,
    tolerance: f64,
    f: impl Fn([Taylor; C]) -> [Taylor; K],
) -> [Interval; K] {
    let monomials = Monomials::new(P);
    let mut sums = [Interval::from(0); K];
    let mut pieces = vec![(corners, 0)];
    while let Some((corners, depth)) = pieces.pop() {
        let share = 0.5_f64.powi(depth);
        let found = on_piece(&corners, &monomials, &f);
        let known = found.iter().all(|&mean| share * width(mean) <= tolerance);
        if known || depth == DEEPEST {
            for (sum, mean) in sums.iter_mut().zip(found) {
                *sum += Interval::point(share) * mean;
            }
        } else {
            pieces.extend(halves(&corners).map(|part| (part, depth + 1)));
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini::kernel::positive_part;

    fn point(x: f64) -> Interval {
        Interval::point(x)
    }

    /// The unit triangle with its coordinates, the unit segment with its.
    fn triangle() -> Simplex<3, 2> {
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|x| x.map(point))
    }

    fn segment() -> Simplex<2, 1> {
        [[point(0.0)], [point(1.0)]]
    }

    fn encloses(found: Interval, exact: f64, narrow: f64) {
        assert!(found.contains(exact) && width(found) <= narrow, "{found:?} {exact}");
    }

    #[test]
    fn known_integrals_over_the_triangle_are_enclosed_and_others_are_not() {
        // With u = x + y the mean over the triangle is 2 int_0^1 f(u) u du.
        let one = Taylor::from(1);
        let found = mean(triangle(), 1e-9, |[x, y]| {
            let u = x + y;
            [one / (one + u), (one + u).sqrt(), u.sqrt(), x * x * y]
        });
        let root = |u: f64| 2.0 * ((1.0 + u).powf(2.5) / 2.5 - (1.0 + u).powf(1.5) / 1.5);
        encloses(found[0], 2.0 * (1.0 - 2.0_f64.ln()), 1e-6);
        encloses(found[1], root(1.0) - root(0.0), 1e-6);
        encloses(found[2], 0.8, 1e-6);
        encloses(found[3], 1.0 / 30.0, 1e-6);
        assert!(!found[2].contains(0.8 + 1e-6) && !found[2].contains(0.8 - 1e-6));
    }

    #[test]
    fn known_integrals_over_the_segment_are_enclosed_with_a_root_and_with_a_kink() {
        let third = Taylor::from(1) / Taylor::from(3);
        let found = mean(segment(), 1e-10, |[x]| [x.sqrt(), positive_part(x - third), x * x]);
        encloses(found[0], 2.0 / 3.0, 1e-7);
        encloses(found[1], 2.0 / 9.0, 1e-7);
        encloses(found[2], 1.0 / 3.0, 1e-9);
    }

    #[test]
    fn control_a_kink_that_counts_as_smooth_gives_a_wrong_integral() {
        let third = Taylor::from(1) / Taylor::from(3);
        let smooth = |x: Taylor| if x.is_at_most(0.0) { Taylor::from(0) } else { x };
        let [found] = mean(segment(), 1e-10, |[x]| [smooth(x - third)]);
        assert!(!found.contains(2.0 / 9.0), "{found:?}");
    }

    #[test]
    fn control_without_the_spread_of_the_last_coefficients_the_exact_value_is_outside() {
        let f = |[x]: [Taylor; 1]| (Taylor::from(1) + x).sqrt();
        let centre = f(affine(&segment(), true));
        let exact = 2.0 / 3.0 * (2.0_f64.powf(1.5) - 1.0);
        let monomials = Monomials::new(2);
        assert!(!monomials.mean(centre, centre).contains(exact));
        assert!(monomials.mean(centre, f(affine(&segment(), false))).contains(exact));
    }

    #[test]
    fn taylor_coefficients_are_those_of_the_function() {
        // x^2 y / (x + y) at (1, 1): the derivatives with respect to x and y are 3/4 and 1/4.
        let [x, y] = Taylor::variables([point(1.0), point(1.0)]);
        let f = x * x * y / (x + y);
        encloses(f.value(), 0.5, 1e-14);
        let [by_x, by_y] = f.gradient();
        encloses(by_x, 0.75, 1e-14);
        encloses(by_y, 0.25, 1e-14);
        // The coefficients of sqrt(1 + t) are 1, 1/2, -1/8, 1/16, -5/128.
        let [x, _] = Taylor::variables([point(1.0), point(0.0)]);
        let root = x.sqrt();
        for (n, c) in [1.0, 0.5, -0.125, 0.0625, -0.0390625].into_iter().enumerate() {
            encloses(root.0[index([n, 0])], c, 1e-14);
        }
    }

    #[test]
    fn means_of_monomials_are_known_and_bounded() {
        let (two, three) = (Monomials::new(2), Monomials::new(3));
        encloses(two.means[index([2, 0])], 1.0 / 12.0, 1e-14);
        encloses(three.means[index([1, 0])], 0.0, 1e-14);
        encloses(three.means[index([2, 0])], 1.0 / 18.0, 1e-14);
        encloses(three.means[index([1, 1])], -1.0 / 36.0, 1e-14);
        encloses(two.magnitudes[index([1, 0])], (1.0_f64 / 12.0).sqrt(), 1e-13);
    }
}
