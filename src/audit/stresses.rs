//! The stresses of a certificate and of its dual pairs in doubles: C eps(v) - tau on a triangle as numbers whose squares and
//! products add up to the integrals, each a double and how far off it may be.
//!
//! All that leads to these numbers is linear in displacements and forces. So what the doubles leave out is itself a vector, of
//! which only the length is needed: with a' and b' for the doubles, a'' and b'' for the rest, over the whole body at once,
//!
//! |a| <= |a'| + |a''|,   |a . b - a' . b'| = |a'' . b + a' . b''| <= |a''| |b| + |a'| |b''|.

use std::cell::OnceCell;

use nalgebra::Vector2;

use super::balanced::{Balanced, distance};
use super::certificate::{Certificate, Piece};
use super::rounded::{MOST, Rounded};
use crate::kernel::ball::centre_and_radius;
use crate::kernel::composite::{Affine, Composite, Frame, Loads, Wrench};
use crate::kernel::{Ball, Enclosing, Interval, Material, Squares, Stress, Triangle};

/// Numbers of a checker that have quicker and wider ones beside them, for long linear formulas.
pub trait Staged: Enclosing {
    /// The quicker ones.
    type Quick: Enclosing;

    /// This number among them, as after `OF_RADIUS` roundings.
    fn quick(self) -> Self::Quick;

    /// The difference of two, as after `OF_DIFFERENCE` roundings.
    fn difference(self, other: Self) -> Self::Quick;

    /// A double, and how far from it this number may be.
    fn centred(self) -> (f64, f64);

    /// Returns a double, and how far from it this quicker number may be.
    fn centred_quick(quick: Self::Quick) -> (f64, f64);

    /// The resultant of loads on a triangle.
    fn resultant(loads: &Loads<Self>, triangle: &Triangle<Self>) -> Wrench<Self> {
        loads.resultant(triangle)
    }
}

impl Staged for Ball {
    type Quick = Rounded;

    #[inline]
    fn quick(self) -> Rounded {
        Rounded::of_ball(self, OF_RADIUS)
    }

    #[inline]
    fn difference(self, other: Ball) -> Rounded {
        Rounded::difference(self, other, OF_DIFFERENCE)
    }

    #[inline]
    fn centred(self) -> (f64, f64) {
        centre_and_radius(self)
    }

    #[inline]
    fn centred_quick(quick: Rounded) -> (f64, f64) {
        (quick.value(), quick.error(MOST))
    }

    /// Where all numbers are doubles and there is no body force, to twice the precision of doubles: what forces that balance to
    /// rounding leave is then known by far better than rounding.
    fn resultant(loads: &Loads<Ball>, triangle: &Triangle<Ball>) -> Wrench<Ball> {
        let mut places = [[0.0; 2]; 3];
        let mut forces = [[[0.0; 2]; 2]; 3];
        let mut are_doubles = loads.body == [Vector2::zeros(); 3];
        let mut double = |x: Ball| {
            let (value, radius) = centre_and_radius(x);
            are_doubles &= radius == 0.0;
            value
        };
        for i in 0..3 {
            for c in 0..2 {
                places[i][c] = double(triangle.vertices[i][c]);
                forces[i][0][c] = double(loads.forces[i][0][c]);
                forces[i][1][c] = double(loads.forces[i][1][c]);
            }
        }
        if are_doubles {
            resultant(&places, &forces).about(triangle.vertices[0])
        } else {
            loads.resultant(triangle)
        }
    }
}

/// The resultant of forces on the edges of a triangle, about the origin. Of a force that is p at the start a of an edge and q at
/// its end b it is 1/2 (p + q), with the moment 1/6 (a x (2 p + q) + b x (p + 2 q)): so with the sums g of what stands beside the
/// vertices x it is 1/6 of the sums of g and of x x g.
fn resultant(places: &[[f64; 2]; 3], forces: &[[[f64; 2]; 2]; 3]) -> Wrench<Ball> {
    let (mut total, mut moment) = ([Sum::default(); 2], Sum::default());
    for j in 0..3 {
        let ([p, q], [r, s]) = (forces[(j + 2) % 3], forces[(j + 1) % 3]);
        let mut beside = [Sum::default(); 2];
        for c in 0..2 {
            for x in [2.0 * p[c], q[c], r[c], 2.0 * s[c]] {
                beside[c].add(x);
            }
            total[c].add_sum(beside[c]);
        }
        moment.add_multiple(places[j][0], beside[1]);
        moment.add_multiple(-places[j][1], beside[0]);
    }
    let sixth = |sum: Sum| sum.all() / Ball::from(6);
    let [x, y] = total.map(sixth);
    Wrench { force: Vector2::new(x, y), moment: sixth(moment), about: Vector2::zeros() }
}

/// A sum of doubles and of products of them: its rounded value, the sum of all that was rounded off, and that of the sizes of
/// this.
#[derive(Clone, Copy, Default)]
struct Sum {
    value: f64,
    rest: f64,
    size: f64,
}

impl Sum {
    /// By Knuth's transformation what a sum of doubles is rounded by is a double and known.
    #[inline]
    fn add(&mut self, x: f64) {
        let value = self.value + x;
        let part = value - self.value;
        let off = (self.value - (value - part)) + (x - part);
        self.value = value;
        self.add_rest(off);
    }

    #[inline]
    fn add_rest(&mut self, off: f64) {
        self.rest += off;
        self.size += off.abs();
    }

    #[inline]
    fn add_sum(&mut self, other: Sum) {
        self.add(other.value);
        self.rest += other.rest;
        self.size += other.size;
    }

    /// Adds a multiple of a sum. The rounding of a product is a double and known, too, but for an underflow.
    #[inline]
    fn add_multiple(&mut self, factor: f64, other: Sum) {
        let product = factor * other.value;
        self.add(product);
        self.add_rest(off_product(factor, other.value, product));
        self.rest += factor * other.rest;
        self.size += factor.abs() * other.size;
    }

    /// All of it. The rest of less than 100 numbers went through less than 100 roundings; less than 100 underflow.
    fn all(self) -> Ball {
        let error = 100.0 * f64::EPSILON * self.size + f64::MIN_POSITIVE;
        Ball::point(self.value) + Ball::around(self.rest, error)
    }
}

/// x y less the rounded product, by Dekker's transformation: each factor is cut into two doubles of 26 bits, whose products are
/// exact.
#[inline]
fn off_product(x: f64, y: f64, product: f64) -> f64 {
    let cut = |x: f64| {
        let much = 134_217_729.0 * x;
        let high = much - (much - x);
        (high, x - high)
    };
    let ((a, b), (c, d)) = (cut(x), cut(y));
    ((a * c - product) + a * d + b * c) + b * d
}

/// Roundings that stand for the radius of a force, which formulas are linear in: what the radius adds to the error is counted
/// [`MOST`] over this times.
const OF_RADIUS: u32 = 64;

/// Roundings that stand for the radius of a difference of two places or displacements.
const OF_DIFFERENCE: u32 = 4;

/// Three vectors less the first of them, in the quicker numbers: their differences are as sharp as those of doubles.
#[inline]
pub(crate) fn local<S: Staged>([a, b, c]: [Vector2<S>; 3]) -> [Vector2<S::Quick>; 3] {
    let from_a = |v: Vector2<S>| Vector2::new(v[0].difference(a[0]), v[1].difference(a[1]));
    [Vector2::zeros(), from_a(b), from_a(c)]
}

/// The bulges of a displacement in the quicker numbers.
pub(crate) fn bulges<S: Staged>(bulges: [Vector2<S>; 3]) -> [Vector2<S::Quick>; 3] {
    bulges.map(|bulge| bulge.map(|x| x.difference(S::from(0))))
}

/// A vector in the quicker numbers.
#[inline]
fn quick<S: Staged>(v: Vector2<S>) -> Vector2<S::Quick> {
    Vector2::new(v[0].quick(), v[1].quick())
}

/// Loads in the quicker numbers.
#[inline]
fn quickly<S: Staged>(loads: &Loads<S>) -> Loads<S::Quick> {
    let [[a, b], [c, d], [e, f]] = loads.forces;
    let [g, h, i] = loads.body;
    Loads {
        forces: [[quick(a), quick(b)], [quick(c), quick(d)], [quick(e), quick(f)]],
        body: [quick(g), quick(h), quick(i)],
    }
}

/// int_T a : C^-1 b is the sum of so many products.
const COUNT: usize = 21;

/// The factors in int_T a : C^-1 b that do not depend on stresses: the law of the material, and for its moduli m the roots of
/// 2 |T| / (576 m), each a double and its error.
struct Law<N> {
    squares: Squares<N>,
    roots: [(f64, f64); 3],
}

impl<N: Enclosing> Law<N> {
    /// `centred` is that of the numbers.
    fn new(material: &Material<N>, double_area: N, centred: impl Fn(N) -> (f64, f64)) -> Self {
        let squares = material.squares();
        let [bulk, shear, other] = squares.pivots();
        let roots = [shear, other, bulk];
        let roots = roots.map(|m| centred((double_area / (m * N::from(576))).sqrt()));
        Law { squares, roots }
    }

    /// Numbers whose products with those of another stress, times 8, 3 and 1 and the squares of the roots, add up to int_T a :
    /// C^-1 b: for affine functions with the values a, b, c on a part, c at the centroid, those of [`Composite::energy`], c, s =
    /// a + b + 2/3 c and a - b. The products of a stress with bulges h, 4 mu_p mu_q h_pq, and one without are those of its
    /// projection on affine functions on each part, which has 3/5 (h_pq + h_pr) - 1/5 h_qr more at p.
    fn of_stress(&self, tau: &Composite<N>) -> [N; COUNT] {
        let two_thirds = N::from(2) / N::from(3);
        let (mut corners, mut centres, mut mean) = (tau.corners, [tau.centre; 3], tau.centre);
        if let Some(bulges) = &tau.bulges {
            let (fifth, third) = (N::from(1) / N::from(5), N::from(1) / N::from(3));
            for (i, [outer, to_j, to_k]) in bulges.iter().copied().enumerate() {
                let more = |near: Stress<N>, far: Stress<N>| (near * N::from(3) - far) * fifth;
                corners[i][0] = corners[i][0] + more(outer + to_j, to_k);
                corners[i][1] = corners[i][1] + more(outer + to_k, to_j);
                let at_centre = more(to_j + to_k, outer);
                centres[i] = centres[i] + at_centre;
                mean = mean + at_centre * third;
            }
        }
        let mut all = [N::from(0); COUNT];
        let mut put = |k: usize, tau: Stress<N>| {
            all[3 * k..3 * k + 3].copy_from_slice(&self.squares.parts(tau));
        };
        put(0, mean);
        for (i, [a, b]) in corners.into_iter().enumerate() {
            put(i + 1, a + b + centres[i] * two_thirds);
            put(i + 4, a - b);
        }
        all
    }
}

/// A triangle with what does not depend on displacements and loads.
struct Ground<N> {
    triangle: Triangle<N>,
    frame: Frame<N>,
    law: Law<N>,
}

impl<N: Enclosing> Ground<N> {
    fn new(piece: &Piece, triangle: &Triangle<N>, centred: impl Fn(N) -> (f64, f64)) -> Self {
        let law = Law::new(&piece.material(), triangle.double_area(), centred);
        Ground { triangle: *triangle, frame: Frame::new(triangle), law }
    }

    /// The numbers of sigma - tau, for tau with these loads.
    fn numbers(
        &self,
        piece: &Piece,
        sigma: &Affine<N>,
        loads: &Loads<N>,
        centred: impl Fn(N) -> (f64, f64),
    ) -> Numbers {
        let all = self.law.of_stress(&distance(piece, &self.frame, sigma, loads));
        Numbers::new(&all, &self.law.roots, centred)
    }

    /// An upper bound of int sigma : C^-1 sigma.
    fn energy(&self, piece: &Piece, sigma: &Affine<N>) -> f64 {
        sigma.energy(&piece.material(), self.triangle.double_area()).upper()
    }
}

/// The numbers of a stress on a triangle.
#[derive(Clone, Copy)]
pub(crate) struct Numbers {
    /// Doubles.
    values: [f64; COUNT],
    /// How far from them the numbers may be.
    errors: [f64; COUNT],
}

/// The root of 3.
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// Errors are small if they are no more than this part of the doubles, in the norm of a triangle: they add no more than that to
/// the width of an interval.
pub(crate) const SHARP: f64 = 1e-4;

/// Roots of 8, 3 and 1, rounded.
const FACTORS: [f64; 7] = [2.0 * std::f64::consts::SQRT_2, SQRT_3, SQRT_3, SQRT_3, 1.0, 1.0, 1.0];

/// Covers roundings in an error.
const GROWTH: f64 = 1.0 + 16.0 * f64::EPSILON;

impl Numbers {
    /// Scales the numbers of [`Law::of_stress`], x to e, times the roots of what their squares are to be multiplied with, r to d: x r to
    /// e (r + d) + |x| d and its rounding, where d is that of the root and two roundings, of its factor and by it. What
    /// underflows is in [`TINY`].
    #[inline]
    fn new<N: Copy>(
        all: &[N; COUNT],
        roots: &[(f64, f64); 3],
        centred: impl Fn(N) -> (f64, f64),
    ) -> Numbers {
        let mut numbers = Numbers { values: [0.0; COUNT], errors: [0.0; COUNT] };
        for k in 0..7 {
            let factor = FACTORS[k];
            for c in 0..3 {
                let (value, error) = centred(all[3 * k + c]);
                let (root, of_root) = roots[c];
                let (root, of_root) =
                    (root * factor, of_root * factor + f64::EPSILON * root * factor);
                let product = value * root;
                numbers.values[3 * k + c] = product;
                numbers.errors[3 * k + c] = (error * (root + of_root)
                    + value.abs() * of_root
                    + f64::EPSILON * product.abs())
                    * GROWTH;
            }
        }
        numbers
    }

    fn are_sharp(&self) -> bool {
        dot(&self.errors, &self.errors) <= SHARP * SHARP * dot(&self.values, &self.values)
    }

    /// The product with the doubles of another.
    pub fn dot(&self, other: &Numbers) -> f64 {
        dot(&self.values, &other.values)
    }
}

/// A sum of products, off by no more than 24 u times the sum of their sizes, and what underflows.
fn dot(a: &[f64; COUNT], b: &[f64; COUNT]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

/// 24 u, and more.
const OF_DOT: f64 = 16.0 * f64::EPSILON;

/// In the squares of numbers, of their errors and in the sums of these no more than this underflows; in one of products no more
/// than `OF_DOT` times this, so that what the lengths have more by it covers both.
pub(crate) const TINY: f64 = 1e-300;

/// The squares of the lengths of doubles and of their errors, over the triangles: upper bounds.
#[derive(Clone, Copy)]
pub(crate) struct Lengths {
    values: Ball,
    errors: Ball,
}

impl Lengths {
    pub fn new() -> Lengths {
        Lengths { values: Ball::from(0), errors: Ball::from(0) }
    }

    /// Adds a triangle; returns the square of its doubles.
    pub fn add(&mut self, numbers: &Numbers) -> f64 {
        let upper = |x: f64| Ball::point(x * (1.0 + 2.0 * OF_DOT) + TINY);
        let [values, errors] = [&numbers.values, &numbers.errors].map(|x| dot(x, x));
        self.values += upper(values);
        self.errors += upper(errors);
        values
    }

    fn roots(self) -> [Interval; 2] {
        [self.values, self.errors].map(|square| Interval::point(square.sqrt().upper()))
    }

    /// An upper bound of the length of the numbers.
    pub fn length(self) -> f64 {
        let [values, errors] = self.roots();
        (values + errors).hi()
    }

    /// How far the product of the numbers may be from the sum of those of the doubles, triangle by triangle.
    pub fn error_of_product(self, other: Lengths) -> f64 {
        let ([a, a_rest], [b, b_rest]) = (self.roots(), other.roots());
        let of_doubles = a * b * Interval::point(OF_DOT);
        (a_rest * (b + b_rest) + a * b_rest + of_doubles).hi()
    }
}

/// The numbers of a stress on a triangle that is at hand in the numbers of the checker.
pub(crate) fn numbers<S: Staged>(
    piece: &Piece,
    triangle: &Triangle<S>,
    tau: &Composite<S>,
) -> Numbers {
    let quick = |s: Stress<S>| Stress::new(s.components().map(S::quick));
    let [[a, b], [c, d], [e, f]] = tau.corners;
    let near = Composite {
        corners: [[quick(a), quick(b)], [quick(c), quick(d)], [quick(e), quick(f)]],
        centre: quick(tau.centre),
        bulges: tau.bulges.map(|all| all.map(|part| part.map(quick))),
    };
    let local = Triangle::<S::Quick> { vertices: local(triangle.vertices) };
    let law = Law::new(&piece.material(), local.double_area(), S::centred_quick);
    let numbers = Numbers::new(&law.of_stress(&near), &law.roots, S::centred_quick);
    if numbers.are_sharp() {
        return numbers;
    }
    let law = Law::new(&piece.material(), triangle.double_area(), S::centred);
    Numbers::new(&law.of_stress(tau), &law.roots, S::centred)
}

/// A triangle in the quicker numbers and, where it is asked for, in the others.
pub(crate) struct Place<'a, S: Staged> {
    t: usize,
    quick: Ground<S::Quick>,
    triangle: &'a Triangle<S>,
    slow: OnceCell<Ground<S>>,
}

impl<'a, S: Staged> Place<'a, S> {
    pub fn new(piece: &Piece, t: usize, triangle: &'a Triangle<S>) -> Self {
        let local = Triangle { vertices: local(triangle.vertices) };
        let quick = Ground::new(piece, &local, S::centred_quick);
        Place { t, quick, triangle, slow: OnceCell::new() }
    }

    /// Returns the numbers of C eps(v) - tau of a certificate in equilibrium and, if it is asked for, an upper bound of |v|_a^2:
    /// in the quicker numbers or, where these are not sharp, in the others.
    pub fn stresses(
        &self,
        certificate: &Certificate,
        state: &Balanced<S>,
        with_energy: bool,
    ) -> (Numbers, f64) {
        let piece = &certificate.pieces[self.t];
        let loads = state.loads(piece, self.t);
        let v = local(piece.vertices.map(|p| state.v.points[p]));
        let bulges = state.v.bulges_of(piece).map(bulges);
        let triangle = &self.quick.triangle;
        let sigma = Affine::of_displacement(triangle, &v, bulges.as_ref(), &piece.material());
        let numbers = self.quick.numbers(piece, &sigma, &quickly(&loads), S::centred_quick);
        if numbers.are_sharp() {
            let energy = if with_energy { self.quick.energy(piece, &sigma) } else { 0.0 };
            return (numbers, energy);
        }
        let slow = self.slow.get_or_init(|| Ground::new(piece, self.triangle, S::centred));
        let sigma = state.v.stress(piece, self.triangle);
        (slow.numbers(piece, &sigma, &loads, S::centred), slow.energy(piece, &sigma))
    }
}

#[cfg(test)]
mod tests {
    use std::ops::{Add, Div, Mul, Neg, Sub};

    use super::*;
    use crate::forces::strain_energy;
    use crate::kernel::{Plane, Scalar};

    const T: Triangle<f64> = Triangle {
        vertices: [Vector2::new(0.3, -0.2), Vector2::new(2.0, 0.1), Vector2::new(0.7, 1.9)],
    };

    fn laws() -> [Material<f64>; 2] {
        let tensor = Material::tensor([12.0, 3.0, 2.0, 5.0, -1.0, 4.0], None);
        [Material::lame(1.3, 0.7, Plane::Strain), tensor]
    }

    fn piece(material: Material<f64>, body: [[f64; 2]; 3]) -> Piece {
        Piece { vertices: [0, 1, 2], edges: [0, 1, 2], material, body, oscillation: 0.0 }
    }

    fn stress(k: i32) -> Stress<f64> {
        Stress::new([1, 5, 7].map(|m| f64::from((m * k * k + 3 * k) % 11) - 5.0))
    }

    fn composite(k: i32, bulges: bool) -> Composite<f64> {
        let at = |i: usize, j: usize| stress(k + 3 * i as i32 + j as i32);
        Composite {
            corners: [0, 1, 2].map(|i| [0, 1].map(|j| at(i, j))),
            centre: stress(k + 17),
            bulges: bulges.then(|| [0, 1, 2].map(|i| [0, 1, 2].map(|j| at(i + 4, j)))),
        }
    }

    /// Doubles, as if they were exact.
    fn numbers_of(material: &Material<f64>, tau: &Composite<f64>) -> Numbers {
        let law = Law::new(material, 0.6, |x| (x, 0.0));
        Numbers::new(&law.of_stress(tau), &law.roots, |x| (x, 0.0))
    }

    #[test]
    fn products_of_numbers_are_those_of_the_stresses() {
        for material in laws() {
            for bent in [false, true] {
                let (a, b) = (composite(2, bent), composite(5, false));
                let sum = |sign: f64| Composite {
                    corners: [0, 1, 2]
                        .map(|i| [0, 1].map(|j| a.corners[i][j] + b.corners[i][j] * sign)),
                    centre: a.centre + b.centre * sign,
                    bulges: a.bulges,
                };
                let [plus, minus] = [1.0, -1.0].map(|sign| sum(sign).energy(&material, 0.6));
                let found = numbers_of(&material, &a).dot(&numbers_of(&material, &b));
                let expected = (plus - minus) / 4.0;
                assert!((found - expected).abs() <= 1e-13 * plus, "{found}, {expected}");
                let own = numbers_of(&material, &b);
                let energy = b.energy(&material, 0.6);
                assert!((own.dot(&own) - energy).abs() <= 1e-13 * energy);
                // Control: a bulge counts.
                let flat = numbers_of(&material, &Composite { bulges: None, ..a });
                assert!((flat.dot(&own) != found) == bent);
            }
        }
    }

    /// The errors of products of numbers with known parts, and with what these leave out.
    #[test]
    fn lengths_bound_what_doubles_leave_out() {
        let part = |k: i32, size: f64| {
            let numbers =
                |size: f64| std::array::from_fn(|i| size * f64::from((k + 5 * i as i32) % 7 - 3));
            (numbers(1.0), numbers(size))
        };
        let ((a, a_rest), (b, b_rest)) = (part(1, 0.25), part(3, -0.125));
        let whole = |values: [f64; COUNT], rest: [f64; COUNT]| -> [f64; COUNT] {
            std::array::from_fn(|i| values[i] + rest[i])
        };
        let lengths = |values: [f64; COUNT], rest: [f64; COUNT]| {
            let mut lengths = Lengths::new();
            lengths.add(&Numbers { values, errors: rest.map(f64::abs) });
            lengths
        };
        let (of_a, of_b) = (lengths(a, a_rest), lengths(b, b_rest));
        let (all_a, all_b) = (whole(a, a_rest), whole(b, b_rest));
        assert!(of_a.length() >= dot(&all_a, &all_a).sqrt());
        let off = (dot(&all_a, &all_b) - dot(&a, &b)).abs();
        assert!(off > 0.0 && of_a.error_of_product(of_b) >= off);
        // Where the rest is along the numbers, no less would do.
        let twice = lengths(a, a);
        assert!((twice.length() - 2.0 * dot(&a, &a).sqrt()).abs() < 1e-12);
        assert!((twice.error_of_product(twice) - 3.0 * dot(&a, &a)).abs() < 1e-10);
    }

    #[test]
    fn the_resultant_to_twice_the_precision_is_that_of_balls_and_sharper() {
        let ball = |x: f64| Ball::point(x);
        let triangle = Triangle { vertices: T.vertices.map(|x| x.map(ball)) };
        let mut loads = Loads {
            forces: [[[0.3, -1.0], [0.7, 0.2]], [[-0.4, 0.9], [1.1, -0.6]], [[0.0; 2]; 2]]
                .map(|ends| ends.map(Vector2::from)),
            body: [Vector2::zeros(); 3],
        };
        // On the third edge what balances, but for rounding.
        loads.forces[2] =
            loads.resultant(&T).on_edge(T.vertices[0], T.vertices[1]).map(|force| -force);
        let given = Loads {
            forces: loads.forces.map(|ends| ends.map(|f| f.map(ball))),
            body: [Vector2::zeros(); 3],
        };
        let sharp = Ball::resultant(&given, &triangle);
        let wide = given.resultant(&triangle).about(sharp.about);
        let pairs = [
            (sharp.force[0], wide.force[0]),
            (sharp.force[1], wide.force[1]),
            (sharp.moment, wide.moment),
        ];
        for (sharp, wide) in pairs {
            let ((a, r), (b, s)) = (centre_and_radius(sharp), centre_and_radius(wide));
            assert!((a - b).abs() <= r + s && r <= 1e-28 && s >= 1e-17, "{sharp:?}, {wide:?}");
        }
        // A body force, and a force that is not a double, are left to balls.
        let body = Loads { body: [Vector2::new(ball(1.0), ball(0.0)); 3], ..given };
        assert_eq!(Ball::resultant(&body, &triangle), body.resultant(&triangle));
        let mut wide = given;
        wide.forces[1][0][1] = Ball::around(0.9, 1e-3);
        assert_eq!(Ball::resultant(&wide, &triangle), wide.resultant(&triangle));
    }

    /// Numbers in balls are within the errors of those in the quicker numbers, also where one is not a double.
    #[test]
    fn quicker_numbers_are_near_those_in_balls() {
        for material in laws() {
            let piece = piece(material, [[0.5, -0.25], [0.1, 0.3], [-0.7, 0.2]]);
            let mut loads = Loads {
                forces: [[[0.3, -1.0], [0.7, 0.2]], [[-0.4, 0.9], [1.1, -0.6]], [[0.2, 0.1]; 2]]
                    .map(|ends| ends.map(|f| Vector2::from(f).map(Ball::point))),
                body: piece.body.map(|f| Vector2::from(f).map(Ball::point)),
            };
            loads.forces[0][1][0] = Ball::around(0.7, 1e-9);
            let triangle = Triangle { vertices: T.vertices.map(|x| x.map(Ball::point)) };
            let nodal =
                [[0.1, 0.2], [0.35, -0.1], [0.2, 0.45]].map(|v| Vector2::from(v).map(Ball::point));
            let bulges = [[0.01, 0.02], [-0.03, 0.01], [0.0, 0.02]];
            let bulges = bulges.map(|v| Vector2::from(v).map(Ball::point));
            let slow = Ground::new(&piece, &triangle, Ball::centred);
            let sigma =
                Affine::of_displacement(&triangle, &nodal, Some(&bulges), &piece.material());
            let balls = slow.numbers(&piece, &sigma, &loads, Ball::centred);
            let near = Triangle { vertices: local(triangle.vertices) };
            let fast = Ground::new(&piece, &near, Ball::centred_quick);
            let bulges = super::bulges(bulges);
            let sigma =
                Affine::of_displacement(&near, &local(nodal), Some(&bulges), &piece.material());
            let quick = fast.numbers(&piece, &sigma, &quickly(&loads), Ball::centred_quick);
            let mut wider = 0.0;
            for k in 0..COUNT {
                let apart = (quick.values[k] - balls.values[k]).abs();
                assert!(apart <= quick.errors[k] + balls.errors[k]);
                wider = f64::max(wider, quick.errors[k] / balls.errors[k]);
            }
            assert!(quick.are_sharp() && (1.0..512.0).contains(&wider), "{wider}");
        }
    }

    /// The number of roundings that a number has gone through, the most that the rules of [`Rounded`] count.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Counted(u32);

    impl Counted {
        fn rounded(self) -> Counted {
            Counted(self.0 + 1)
        }
    }

    impl From<i32> for Counted {
        fn from(_: i32) -> Counted {
            Counted(0)
        }
    }

    impl Neg for Counted {
        type Output = Counted;

        fn neg(self) -> Counted {
            self
        }
    }

    macro_rules! counted {
        ($operator:ident $function:ident, $a:ident $b:ident $count:expr) => {
            impl $operator for Counted {
                type Output = Counted;

                fn $function(self, other: Counted) -> Counted {
                    let ($a, $b) = (self.0, other.0);
                    Counted($count).rounded()
                }
            }
        };
    }
    counted!(Add add, a b a.max(b));
    counted!(Sub sub, a b a.max(b));
    counted!(Mul mul, a b [a, b].iter().sum::<u32>());
    counted!(Div div, a b [a, b].iter().sum::<u32>());

    crate::kernel::entry_of_nalgebra!(Counted);

    impl Scalar for Counted {
        fn split(
            self,
            nonpositive: impl FnOnce(Counted) -> Counted,
            positive: impl FnOnce(Counted) -> Counted,
        ) -> Counted {
            Counted(nonpositive(self).0.max(positive(self).0))
        }
    }

    impl Enclosing for Counted {
        fn exactly(_: f64) -> Counted {
            Counted(0)
        }

        fn sqrt(self) -> Counted {
            self.rounded()
        }

        fn upper(self) -> f64 {
            f64::from(self.0)
        }

        fn lower(self) -> f64 {
            f64::from(self.0)
        }
    }

    /// The most roundings in numbers that are made of forces with `of_force` to begin with.
    fn most_roundings(of_force: u32) -> u32 {
        let mut most = 0;
        let mut see = |count: Counted| {
            most = most.max(count.0);
            (0.0, 0.0)
        };
        let vector = |k: u32| Vector2::new(Counted(k), Counted(k));
        let apart = [vector(0), vector(OF_DIFFERENCE), vector(OF_DIFFERENCE)];
        let triangle = Triangle { vertices: apart };
        for material in laws() {
            for body in [[[0.0; 2]; 3], [[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]] {
                for bulges in [None, Some([vector(OF_DIFFERENCE); 3])] {
                    let piece = piece(material, body);
                    let law = piece.material();
                    let loads =
                        Loads { forces: [[vector(of_force); 2]; 3], body: [vector(of_force); 3] };
                    let mut counts = Vec::new();
                    let ground = Ground {
                        triangle,
                        frame: Frame::new(&triangle),
                        law: Law::new(&law, triangle.double_area(), |count| (count.upper(), 0.0)),
                    };
                    counts.extend(ground.law.roots.map(|(count, _)| Counted(count as u32)));
                    let sigma = Affine::of_displacement(&triangle, &apart, bulges.as_ref(), &law);
                    let stress = distance(&piece, &ground.frame, &sigma, &loads);
                    counts.extend(ground.law.of_stress(&stress));
                    counts.push(sigma.energy(&law, triangle.double_area()));
                    let normals = [0, 1, 2].map(|i| triangle.scaled_normal(i));
                    let energy = strain_energy(&piece, (&apart, bulges), &normals);
                    counts.push(energy / (triangle.double_area() * Counted(0)));
                    for count in counts {
                        see(count);
                    }
                }
            }
        }
        most
    }

    #[test]
    fn no_number_goes_through_more_roundings_than_are_counted() {
        let found = most_roundings(OF_RADIUS);
        assert!(found <= MOST && found > MOST / 2, "{found}");
        // Control: each factor counts.
        assert!(most_roundings(2 * OF_RADIUS) > found);
    }
}
