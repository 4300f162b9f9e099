//! The stresses of a certificate and of its dual pairs in doubles: C eps(v) - tau on a triangle as numbers whose squares and
//! products add up to the integrals, and how far off these doubles may be.
//!
//! All that leads to these numbers is linear in displacements and forces. So what the doubles leave out is itself a vector, of
//! which only the length is needed: with a' and b' for the doubles, a'' and b'' for the rest, over the whole body at once,
//!
//! |a| <= |a'| + |a''|,   |a . b - a' . b'| = |a'' . b + a' . b''| <= |a''| |b| + |a'| |b''|.
//!
//! **Sizes.** With u = 2^-53 and e_k = (1 + 2 u)^k - 1, a double a that has gone through k roundings stands for all x with
//!
//! |x - a| <= e_k A,   |a| <= A,
//!
//! A being its size. For b, B and y with l roundings, as 1 + e_k times 1 + e_l is 1 + e_(k+l),
//!
//! ```text
//! |x + y - (a + b)| <= e_max(k, l) (A + B)
//! |x y - a b| <= A e_l B + e_k A B + e_k A e_l B = e_(k+l) A B
//! |x/y - a/b| <= (e_k A + |a/b| e_l B) / (|b| - e_l B) <= e_(k+l) (A/|b|) r / (1 - e_l r)          r = B/|b|
//! |sqrt(x) - sqrt(a)| <= |x - a| / sqrt(a) <= e_k A / sqrt(a)                                   for x >= 0, a > 0
//! ```
//!
//! and one more rounding adds u times the size of the result: (e_k + u) / (1 - u)^2 <= e_(k+1). So sizes are A + B, A B, A r/|b|
//! and A/sqrt(a): the formula itself, of sizes. Larger sizes will do. What has an error d beside its roundings may have d / e_k
//! more size; or, where the result is linear in it, the error d times the size that the result has without roundings per unit.
//!
//! **Of a triangle** let l be the largest size of a component of an edge, J = 2 |T|, kappa the size of J over J, rho = l^2/J. Let
//! no component of a force have a size above F, none of a difference of displacements at the vertices, or of a bulge, one above
//! D, and let Lambda be the largest size of a component of C g for g with components 1. From the formulas of
//! [`composite`](crate::kernel::composite), which name these numbers, the sizes are
//!
//! ```text
//! 1/J                            kappa / J
//! t                              2/3 l
//! c J/3                          12 kappa l F/J                        3 times two products of vectors
//! the first tensor at a corner   kappa (2 + 8 kappa rho) l F/J         of p and q + t (c J/3)
//! c t (x) t                      16 kappa^2 rho l F/J
//! the mean stress                4 kappa l F/J                         12 l F over 3 J
//! the stress at m                (16 kappa + 32 kappa^2 rho) l F/J     3 times the mean, a third of all six
//! C eps(v)                       10 kappa Lambda l D/J                 2 of the vertices, 8 of the bulges
//! ```
//!
//! and those of C eps(v) - tau at corners and m no more than X = 16 kappa (1 + 2 kappa rho) l F/J + 10 kappa Lambda l D/J. With P
//! = (1 + |a|) (1 + |c|) + |b|, a, b and c as in [`squares`](crate::kernel::squares), the `COUNT` numbers have the size 16/3 P X
//! at most, and times the roots 16/3 P X kappa sqrt(J) f s, f^2 being 8, 3 or 1, and s = 1 / sqrt(576 m) for the moduli m. As the
//! f^2 add up to 20 for each modulus, the vector of all errors is no longer than
//!
//! e_k 24 P S kappa sqrt(J) X,   S^2 = sum s^2,   sqrt(J) l/J = sqrt(rho)                                          \[S\]
//!
//! (16/3 sqrt(20) < 23.86; the rest covers that constants and divisors are rounded). For what is off by d beside its roundings
//! it is as long as for kappa = 1 and l itself, without e_k, for X = d, or F = d and D = 0.

use nalgebra::{Matrix2, Vector2};

use super::certificate::Piece;
use crate::kernel::composite::{Affine, Composite, Frame, Loads, Wrench};
use crate::kernel::{Ball, Enclosing, Material, Squares, Stress, Triangle};

/// Numbers of a checker that doubles may stand for.
pub trait Staged: Enclosing {
    /// Long linear formulas are evaluated in doubles first.
    const IN_DOUBLES: bool;

    /// A double, and how far from it this number may be.
    fn centred(self) -> (f64, f64);
}

impl Staged for Ball {
    const IN_DOUBLES: bool = true;

    #[inline]
    fn centred(self) -> (f64, f64) {
        (self.centre(), self.radius())
    }
}

/// No number goes through more roundings.
const MOST: u32 = 6208;

/// No less than e_k for k = [`MOST`]: (1 + 2 u)^k - 1 <= 2 u k (1 + 2 u k).
const ROUNDING: f64 = f64::EPSILON * (MOST as f64 + 1.0 / 1024.0);

/// Roundings that stand for the radius of a ball: 2 u of these is less than e_k. Fewer would make triangles look flat whose
/// vertices are balls, as the middles of edges are.
const OF_RADIUS: u32 = 512;

/// Beside forces and displacements as large as this nothing underflows, where lengths and moduli are within [`SCALES`]. They are
/// taken to be as large, which adds less to a length than is ever seen.
const LEAST: f64 = 1e-100;

/// The areas and moduli that doubles are used for.
const SCALES: std::ops::RangeInclusive<f64> = 1e-24..=1e24;

/// A double in the place of a number, and its size.
#[inline]
fn sized<S: Staged>(x: S) -> (f64, f64) {
    let (value, radius) = x.centred();
    let more = if radius == 0.0 { 0.0 } else { radius / (f64::EPSILON * f64::from(OF_RADIUS)) };
    (value, value.abs() + more)
}

/// Doubles in the place of vectors, and by how much a size may be above the double.
#[inline]
fn doubles<S: Staged, const N: usize>(vectors: [Vector2<S>; N]) -> ([Vector2<f64>; N], f64) {
    let mut more = 0.0;
    let values = vectors.map(|v| {
        v.map(|x| {
            let (value, size) = sized(x);
            more = f64::max(more, size - value.abs());
            value
        })
    });
    (values, more)
}

/// Two vectors less the first in doubles, and by how much a size may be above the double.
#[inline]
fn apart<S: Staged>([a, b, c]: [Vector2<S>; 3]) -> ([Vector2<f64>; 2], f64) {
    let centred = |v: Vector2<S>| (v[0].centred(), v[1].centred());
    let (((ax, 0.0), (ay, 0.0)), ((bx, 0.0), (by, 0.0)), ((cx, 0.0), (cy, 0.0))) =
        (centred(a), centred(b), centred(c))
    else {
        return doubles([b - a, c - a]);
    };
    ([Vector2::new(bx - ax, by - ay), Vector2::new(cx - ax, cy - ay)], 0.0)
}

/// A law in doubles, with what the errors of numbers depend on.
pub(crate) struct RoundedLaw {
    squares: Squares<f64>,
    /// s of the module's head for the moduli of the parts of a stress.
    roots: [f64; 3],
    /// P S
    size: f64,
    /// Lambda
    stress: f64,
    /// The sum of the moduli times P^2.
    energy: f64,
    /// Nothing underflows.
    is_scaled: bool,
}

impl RoundedLaw {
    fn new(material: &Material<f64>) -> RoundedLaw {
        let known = material.map(Ball::point).squares();
        let [bulk, shear, other] = known.pivots();
        let moduli = [shear, other, bulk];
        let roots = moduli.map(|m| sized((Ball::from(1) / (m * Ball::from(576))).sqrt()));
        let [a, b, c] = known.beyond.map_or([0.0; 3], |(_, l)| l.map(|l| sized(l).1));
        let parts = (1.0 + a) * (1.0 + c) + b;
        let double = |x: Ball| sized(x).0;
        let beyond = known.beyond.map(|(other, l)| (double(other), l.map(double)));
        let stress = if material.is_isotropic() {
            2.0 * (material.lambda().abs() + material.mu())
        } else {
            4.0 * material.stiffness().into_iter().fold(0.0, |most: f64, c| most.max(c.abs()))
        };
        RoundedLaw {
            squares: Squares { bulk: double(bulk), shear: double(shear), beyond },
            roots: roots.map(|(root, _)| root),
            size: parts * roots.iter().map(|(_, size)| size * size).sum::<f64>().sqrt(),
            stress,
            energy: parts * parts * moduli.into_iter().map(|m| sized(m).1).sum::<f64>(),
            is_scaled: moduli.into_iter().all(|m| SCALES.contains(&double(m))),
        }
    }
}

/// The laws of materials, of which the last is kept: neighbours mostly have one.
#[derive(Default)]
pub(crate) struct RoundedLaws(Option<(Material<f64>, RoundedLaw)>);

impl RoundedLaws {
    pub fn of(&mut self, material: &Material<f64>) -> &RoundedLaw {
        let last = self.0.take().filter(|(other, _)| other == material);
        &self.0.insert(last.unwrap_or_else(|| (*material, RoundedLaw::new(material)))).1
    }
}

/// int_T a : C^-1 b is the sum of so many products.
const COUNT: usize = 21;

/// Numbers whose products with those of another stress, times 8, 3 and 1 and 2 |T| / (576 m) for the moduli m, add up to int_T
/// a : C^-1 b: for affine functions with the values a, b, c on a part, c at the centroid, those of [`Composite::energy`], c, s =
/// a + b + 2/3 c and a - b. The products of a stress with bulges h, 4 mu_p mu_q h_pq, and one without are those of its
/// projection on affine functions on each part, which has 3/5 (h_pq + h_pr) - 1/5 h_qr more at p.
fn parts<N: Enclosing>(squares: &Squares<N>, tau: &Composite<N>) -> [N; COUNT] {
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
        all[3 * k..3 * k + 3].copy_from_slice(&squares.parts(tau));
    };
    put(0, mean);
    for (i, [a, b]) in corners.into_iter().enumerate() {
        put(i + 1, a + b + centres[i] * two_thirds);
        put(i + 4, a - b);
    }
    all
}

/// A stress with bulges has numbers of at most this times the size: 1 + (3 + 3 + 1) / 5.
const BENT: f64 = 2.5;

/// The root of 3.
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// f of the module's head: roots of 8, 3 and 1, rounded.
const FACTORS: [f64; 7] = [2.0 * std::f64::consts::SQRT_2, SQRT_3, SQRT_3, SQRT_3, 1.0, 1.0, 1.0];

/// A triangle in doubles, from differences of its vertices.
pub(crate) struct Ground<'a> {
    law: &'a RoundedLaw,
    pub triangle: Triangle<f64>,
    double_area: f64,
    /// kappa
    skew: f64,
    /// rho
    ratio: f64,
    /// rho without roundings.
    sharp_ratio: f64,
}

impl<'a> Ground<'a> {
    /// `None` where the triangle is too flat for doubles, or too large or small.
    pub fn new<S: Staged>(law: &'a RoundedLaw, triangle: &Triangle<S>) -> Option<Self> {
        if !S::IN_DOUBLES {
            return None;
        }
        let ([b, c], more) = apart(triangle.vertices);
        let triangle = Triangle { vertices: [Vector2::zeros(), b, c] };
        let double_area = triangle.double_area();
        let [p, q] = [b, c].map(|edge| edge.map(|x| x.abs() + more));
        let skew = (p[0] * q[1] + p[1] * q[0]) / double_area;
        let ratio = (p + q).max() * (p + q).max() / double_area;
        let edges = [b, c, c - b].map(|edge| edge.amax());
        let largest = edges.into_iter().fold(0.0, f64::max);
        let largest = largest + 2.0 * f64::EPSILON * f64::from(OF_RADIUS) * more;
        let sharp_ratio = largest * largest / double_area;
        let is_known = law.is_scaled && SCALES.contains(&double_area) && skew <= FLAT;
        is_known.then_some(Ground { law, triangle, double_area, skew, ratio, sharp_ratio })
    }

    /// The length \[S\] for e_k X = 1 and kappa = 1.
    fn length(&self, tau: &Composite<f64>) -> f64 {
        let bent = if tau.bulges.is_some() { BENT } else { 1.0 };
        24.0 * bent * self.law.size * self.double_area.sqrt()
    }

    /// X of the module's head for F = 1 and D = 0, and for F = 0 and Lambda D = 1.
    fn sizes(&self) -> [f64; 2] {
        let (skew, ratio) = (self.skew, self.ratio);
        let per_area = (ratio / self.double_area).sqrt();
        [16.0 * skew * (1.0 + 2.0 * skew * ratio) * per_area, 10.0 * skew * per_area]
    }

    /// The numbers of C eps(v) - tau for v with these values at the vertices and these bulges, and tau with these forces, which
    /// may be off by `off`; `None` where their error is large beside them and beside a `typical` length of numbers, so that balls
    /// are worth their time.
    pub fn numbers<S: Staged>(
        &self,
        frame: &Frame<f64>,
        material: &Material<f64>,
        (nodal, bulges): ([Vector2<S>; 3], Option<[Vector2<S>; 3]>),
        (forces, off): ([[Vector2<f64>; 2]; 3], f64),
        typical: f64,
    ) -> Option<Numbers> {
        let (nodal, bulges, largest) = displacements((nodal, bulges));
        let sigma = Affine::of_displacement(&self.triangle, &nodal, bulges.as_ref(), material);
        let tau = Composite::new(frame, &Loads { forces, body: [Vector2::zeros(); 3] });
        let force = forces.as_flattened().iter().map(Vector2::amax).fold(0.0, f64::max);
        let [per_force, per_stress] = self.sizes();
        let size = per_force * (force + LEAST) + per_stress * (self.law.stress * largest + LEAST);
        let off = of_forces(self.law, self.sharp_ratio, off + LEAST);
        self.scaled(&tau.distance_from(&sigma), size, off, typical)
    }

    /// The numbers of a stress of which no component has more than this size, with what they are off by beside its roundings.
    fn scaled(&self, tau: &Composite<f64>, size: f64, off: f64, typical: f64) -> Option<Numbers> {
        let mut values = parts(&self.law.squares, tau);
        let root = self.double_area.sqrt();
        for (part, factor) in values.as_chunks_mut::<3>().0.iter_mut().zip(FACTORS) {
            for (value, of_modulus) in part.iter_mut().zip(self.law.roots) {
                *value *= root * of_modulus * factor;
            }
        }
        let rounding = self.length(tau) * (self.skew * ROUNDING * size);
        let numbers = Numbers { square: dot(&values, &values), values, error: rounding + off };
        let is_sharp = rounding <= off.max(SHARP * numbers.square.sqrt().max(typical));
        is_sharp.then_some(numbers)
    }

    /// int_T eps(w) : C eps(w); `None` where its error is large beside it and beside a `typical` one. -J grad w has components of
    /// the size 2 D l, with bulges 10 D l, three of these 30 D l; a square of such a g is at most 4 P^2 g^2 times the sum of the
    /// moduli, and the division by 24 J has kappa.
    pub fn energy<S: Staged>(
        &self,
        w: ([Vector2<S>; 3], Option<[Vector2<S>; 3]>),
        typical: f64,
    ) -> Option<Ball> {
        let (nodal, bulges, largest) = displacements(w);
        let normals = [0, 1, 2].map(|i| self.triangle.scaled_normal(i));
        let energy = strain_energy(&self.law.squares, (&nodal, bulges), &normals)
            / (self.double_area * 24.0);
        // 12 (2)^2 and 3 (10)^2 + (30)^2, times 4 and over 24; the rest covers that constants are rounded.
        let squares = if bulges.is_none() { 8.5 } else { 201.0 };
        let largest = largest + LEAST;
        let size = squares * self.law.energy * self.skew * self.ratio * largest * largest;
        let error = ROUNDING * size;
        (error <= SHARP * energy.max(typical) + TINY).then_some(Ball::around(energy, error))
    }
}

/// The length of what numbers have more by forces that are off.
fn of_forces(law: &RoundedLaw, ratio: f64, off: f64) -> f64 {
    24.0 * law.size * 16.0 * (1.0 + 2.0 * ratio) * ratio.sqrt() * off
}

/// A triangle is too flat for doubles where the size of its area is larger beside it.
const FLAT: f64 = (1 << 20) as f64;

/// Values at the vertices less the first, bulges, and D.
#[expect(clippy::type_complexity, reason = "as they come, with a number")]
fn displacements<S: Staged>(
    (nodal, bulges): ([Vector2<S>; 3], Option<[Vector2<S>; 3]>),
) -> ([Vector2<f64>; 3], Option<[Vector2<f64>; 3]>, f64) {
    let ([b, c], more) = apart(nodal);
    let mut largest = b.amax().max(c.amax()) + more;
    let bulges = bulges.map(|bulges| {
        let (bulges, more) = doubles(bulges);
        let most = bulges.iter().map(Vector2::amax).fold(0.0, f64::max);
        largest = largest.max(most + more);
        bulges
    });
    ([Vector2::zeros(), b, c], bulges, largest)
}

/// 24 J times int eps(w) : C eps(w) on a triangle with these scaled normals, J = 2 |T|: from -J grad w at the vertices, which is
/// the sum of w_i (x) N_i and of 4 (b_j (x) N_k + b_k (x) N_j).
pub(crate) fn strain_energy<S: Enclosing>(
    squares: &Squares<S>,
    ([a, b, c], bulges): (&[Vector2<S>; 3], Option<[Vector2<S>; 3]>),
    normals: &[Vector2<S>; 3],
) -> S {
    // From differences, so that a translation has no gradient in any number type.
    let (b, c) = (b - a, c - a);
    let product =
        |v: Vector2<S>, n: Vector2<S>| [v[0] * n[0], v[0] * n[1], v[1] * n[0], v[1] * n[1]];
    let plus = |p: [S; 4], q: [S; 4]| [0, 1, 2, 3].map(|i| p[i] + q[i]);
    let square = |[xx, xy, yx, yy]: [S; 4]| squares.of_gradient(Matrix2::new(xx, xy, yx, yy));
    let base = plus(product(b, normals[1]), product(c, normals[2]));
    let Some(bulges) = bulges else { return square(base) * S::from(12) };
    let four = S::from(4);
    let at = [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let of_bulges = plus(product(bulges[j], normals[k]), product(bulges[k], normals[j]));
        plus(base, of_bulges.map(|x| x * four))
    });
    let sum = plus(plus(at[0], at[1]), at[2]);
    at.into_iter().fold(square(sum), |total, gradient| total + square(gradient))
}

/// The resultant of forces on the edges of a triangle. Where these are doubles, to twice the precision of doubles, but for what
/// is not known of the vertices: what forces that balance to rounding leave is then known by far better than rounding.
pub(crate) fn resultant(
    triangle: &Triangle<Ball>,
    forces: [[Vector2<Ball>; 2]; 3],
) -> Wrench<Ball> {
    let places = triangle.vertices.map(|v| [0, 1].map(|c| v[c].centred()));
    let known = forces.map(|ends| ends.map(|f| [0, 1].map(|c| f[c].centred())));
    if known.as_flattened().as_flattened().iter().all(|&(_, radius)| radius == 0.0) {
        let known = known.map(|ends| ends.map(|f| f.map(|(value, _)| value)));
        of_doubles(&places, &known).about(triangle.vertices[0])
    } else {
        Loads { forces, body: [Vector2::zeros(); 3] }.resultant(triangle)
    }
}

/// The resultant of forces on the edges of a triangle whose vertices are as far from doubles as these say, about the origin. Of a
/// force that is p at the start a of an edge and q at its end b it is 1/2 (p + q), with the moment 1/6 (a x (2 p + q) + b x (p + 2
/// q)): so with the sums g of what stands beside the vertices x it is 1/6 of the sums of g and of x x g.
fn of_doubles(places: &[[(f64, f64); 2]; 3], forces: &[[[f64; 2]; 2]; 3]) -> Wrench<Ball> {
    let (mut total, mut moment) = ([CompensatedSum::default(); 2], CompensatedSum::default());
    let mut off = 0.0;
    for j in 0..3 {
        let ([p, q], [r, s]) = (forces[(j + 2) % 3], forces[(j + 1) % 3]);
        let mut beside = [CompensatedSum::default(); 2];
        for c in 0..2 {
            for x in [2.0 * p[c], q[c], r[c], 2.0 * s[c]] {
                beside[c].add(x);
            }
            total[c].add_sum(beside[c]);
        }
        let [(x, of_x), (y, of_y)] = places[j];
        moment.add_multiple(x, beside[1]);
        moment.add_multiple(-y, beside[0]);
        off += of_x * beside[1].most() + of_y * beside[0].most();
    }
    let six = Ball::from(6);
    let force = Vector2::from(total.map(|sum| sum.all() / six));
    // Covers the roundings in what is off.
    let off = Ball::around(0.0, 2.0 * off);
    Wrench { force, moment: (moment.all() + off) / six, about: Vector2::zeros() }
}

/// A sum of doubles and of products of them: its rounded value, the sum of all that was rounded off, and that of the sizes of
/// this.
#[derive(Clone, Copy, Default)]
struct CompensatedSum {
    value: f64,
    rest: f64,
    size: f64,
}

impl CompensatedSum {
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
    fn add_sum(&mut self, other: CompensatedSum) {
        self.add(other.value);
        self.rest += other.rest;
        self.size += other.size;
    }

    /// Adds a multiple of a sum. The rounding of a product is a double and known, too, but for an underflow.
    #[inline]
    fn add_multiple(&mut self, factor: f64, other: CompensatedSum) {
        let product = factor * other.value;
        self.add(product);
        self.add_rest(off_product(factor, other.value, product));
        self.rest += factor * other.rest;
        self.size += factor.abs() * other.size;
    }

    /// No less than its size, but for a rounding.
    fn most(self) -> f64 {
        self.value.abs() + self.size
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

/// The numbers of a stress on a triangle.
#[derive(Clone, Copy)]
pub(crate) struct Numbers {
    /// Doubles.
    values: [f64; COUNT],
    /// The sum of their squares.
    square: f64,
    /// The length of what they leave out.
    error: f64,
}

/// Errors are small if they are no more than this part of the doubles, in the norm of a triangle, or of what is typical of the
/// triangles before it: they add no more than that to the width of an interval.
const SHARP: f64 = 1e-4;

impl Numbers {
    /// Computes the numbers of a stress that is given in the numbers of the checker.
    pub fn new<S: Staged>(
        law: &RoundedLaw,
        piece: &Piece,
        triangle: &Triangle<S>,
        tau: &Composite<S>,
    ) -> Numbers {
        let in_doubles = || {
            let ground = Ground::new(law, triangle)?;
            let (mut size, mut off) = (0.0_f64, 0.0_f64);
            let mut double = |x: S| {
                let (value, error) = x.centred();
                size = size.max(value.abs());
                off = off.max(error);
                value
            };
            let mut stress = |s: Stress<S>| Stress::new(s.components().map(&mut double));
            let near = Composite {
                corners: tau.corners.map(|ends| ends.map(&mut stress)),
                centre: stress(tau.centre),
                bulges: tau.bulges.map(|all| all.map(|part| part.map(&mut stress))),
            };
            ground.scaled(&near, size + LEAST, ground.length(&near) * (off + LEAST), 0.0)
        };
        in_doubles().unwrap_or_else(|| Numbers::slowly(law, piece, triangle, tau, 0.0))
    }

    /// From the numbers of the checker, for tau with forces that may be off: exactly, kappa is 1, and rounded it is l that
    /// the areas of balls leave.
    pub fn slowly<S: Staged>(
        law: &RoundedLaw,
        piece: &Piece,
        triangle: &Triangle<S>,
        tau: &Composite<S>,
        off: f64,
    ) -> Numbers {
        let (squares, double_area) = (piece.material().squares(), triangle.double_area());
        let [bulk, shear, other] = squares.pivots();
        let roots = [shear, other, bulk];
        let roots = roots.map(|m| (double_area / (m * S::from(576))).sqrt().centred());
        let (mut values, mut square) = ([0.0; COUNT], 0.0);
        for (k, number) in parts(&squares, tau).into_iter().enumerate() {
            let (value, error) = number.centred();
            let (root, of_root) = roots[k % 3];
            let factor = FACTORS[k / 3];
            // x to e, times the root r to d: x r to e (r + d) + |x| d, and the roundings of it and of its factor.
            let (root, of_root) = (root * factor, of_root * factor + f64::EPSILON * root * factor);
            values[k] = value * root;
            let error =
                error * (root + of_root) + value.abs() * of_root + f64::EPSILON * values[k].abs();
            square += error * error;
        }
        let size = |x: S| x.upper().max(-x.lower());
        let edges = [0, 1, 2].map(|i| triangle.edge(i).map(size).max());
        let largest = edges.into_iter().fold(0.0, f64::max);
        let ratio = largest * largest / double_area.lower();
        let more = if off == 0.0 { 0.0 } else { of_forces(law, ratio, off) };
        let error = square.sqrt() * GROWTH + more;
        Numbers { square: dot(&values, &values), values, error }
    }

    /// The product with the doubles of another.
    pub fn dot(&self, other: &Numbers) -> f64 {
        dot(&self.values, &other.values)
    }
}

/// Covers roundings in the sum of squares of errors.
const GROWTH: f64 = 1.0 + 64.0 * f64::EPSILON;

/// A sum of products, off by no more than 24 u times the sum of their sizes, and what underflows.
fn dot(a: &[f64; COUNT], b: &[f64; COUNT]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

/// 24 u, and more.
const OF_DOT: f64 = 16.0 * f64::EPSILON;

/// In the squares of numbers, of their errors and in the sums of these no more than this underflows; in one of products no more
/// than `OF_DOT` times this, so that what the lengths have more by it covers both.
const TINY: f64 = 1e-300;

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
        self.values += upper(numbers.square);
        self.errors += upper(numbers.error * numbers.error);
        numbers.square
    }

    fn roots(self) -> [Ball; 2] {
        [self.values, self.errors].map(|square| Ball::point(square.sqrt().upper()))
    }

    /// The length that the doubles of one of so many triangles would have if all had the same; 0 of none.
    pub fn typical(self, count: usize) -> f64 {
        if count == 0 { 0.0 } else { (self.values.upper() / count as f64).sqrt() }
    }

    /// An upper bound of the length of the numbers.
    pub fn length(self) -> f64 {
        let [values, errors] = self.roots();
        (values + errors).upper()
    }

    /// Bounds the distance of the product of the numbers from the sum of those of the doubles, triangle by triangle.
    pub fn error_of_product(self, other: Lengths) -> f64 {
        let ([a, a_rest], [b, b_rest]) = (self.roots(), other.roots());
        let of_doubles = a * b * Ball::point(OF_DOT);
        (a_rest * (b + b_rest) + a * b_rest + of_doubles).upper()
    }
}

#[cfg(test)]
mod tests {
    use std::ops::{Add, Div, Mul, Neg, Sub};

    use super::*;
    use crate::kernel::{Plane, Scalar};

    fn laws() -> [Material<f64>; 3] {
        let tensor = Material::tensor([12.0, 3.0, 2.0, 5.0, -1.0, 4.0], None);
        let sheared = Material::tensor([9.0, 2.0, -1.0, 4.0, 1.5, 2.0], None);
        [Material::lame(1.3, 0.7, Plane::Strain), tensor, sheared]
    }

    /// Numbers between -1 and 1.
    fn number(k: i32) -> f64 {
        f64::from((7919 * k + 11) % 10007) / 5003.5 - 1.0
    }

    /// A triangle of many shapes: turned, and flatter by each step.
    fn triangle(k: i32) -> Triangle<f64> {
        let (angle, height) = (f64::from(k), 0.5_f64.powi(k % 9));
        let (along, across) = ([angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]);
        let at = |x: f64, y: f64| {
            Vector2::from([0, 1].map(|c| 7.0 + x * along[c] + height * y * across[c]))
        };
        Triangle { vertices: [at(0.0, 0.0), at(1.0, 0.1), at(number(k), 1.0)] }
    }

    fn forces(k: i32) -> [[Vector2<f64>; 2]; 3] {
        let force = |i: i32| Vector2::new(number(k + i), number(k + i + 50));
        [0, 2, 4].map(|i| [force(i), force(i + 1)])
    }

    fn vectors(k: i32) -> [Vector2<f64>; 3] {
        [0, 1, 2].map(|i| Vector2::new(number(k + 3 * i), number(k + 3 * i + 7)))
    }

    fn composite(k: i32, bulges: bool) -> Composite<f64> {
        let stress = |i: i32| Stress::new([0, 1, 2].map(|m| number(k + 13 * i + 5 * m)));
        let at = |i: usize, j: usize| stress((3 * i + j) as i32);
        Composite {
            corners: [0, 1, 2].map(|i| [0, 1].map(|j| at(i, j))),
            centre: stress(17),
            bulges: bulges.then(|| [0, 1, 2].map(|i| [0, 1, 2].map(|j| at(i + 4, j)))),
        }
    }

    fn piece(material: Material<f64>) -> Piece {
        let body = [[0.0; 2]; 3];
        Piece { vertices: [0, 1, 2], edges: [0, 1, 2], material, body, oscillation: 0.0 }
    }

    fn balls(triangle: &Triangle<f64>) -> Triangle<Ball> {
        Triangle { vertices: triangle.vertices.map(exact) }
    }

    fn exact<S: Enclosing>(v: Vector2<f64>) -> Vector2<S> {
        v.map(S::exactly)
    }

    #[test]
    fn products_of_numbers_are_those_of_the_stresses() {
        let t = triangle(1);
        for material in laws() {
            let law = RoundedLaw::new(&material);
            let ground = Ground::new(&law, &balls(&t)).unwrap();
            let of = |tau: &Composite<f64>| ground.scaled(tau, 1.0, 1.0, 0.0).unwrap();
            for bent in [false, true] {
                let (a, b) = (composite(2, bent), composite(5, false));
                let sum = |sign: f64| Composite {
                    corners: [0, 1, 2]
                        .map(|i| [0, 1].map(|j| a.corners[i][j] + b.corners[i][j] * sign)),
                    centre: a.centre + b.centre * sign,
                    bulges: a.bulges,
                };
                let energy = |tau: &Composite<f64>| tau.energy(&material, t.double_area());
                let [plus, minus] = [1.0, -1.0].map(|sign| energy(&sum(sign)));
                let found = of(&a).dot(&of(&b));
                let expected = (plus - minus) / 4.0;
                assert!((found - expected).abs() <= 1e-13 * plus, "{found}, {expected}");
                assert!((of(&b).square - energy(&b)).abs() <= 1e-13 * energy(&b));
                // Control: a bulge counts.
                let flat = of(&Composite { bulges: None, ..a });
                assert!((flat.dot(&of(&b)) != found) == bent);
            }
        }
    }

    /// The errors of products of numbers with known parts, and with what these leave out.
    #[test]
    fn lengths_bound_what_doubles_leave_out() {
        let part = |k: i32, size: f64| -> [f64; COUNT] {
            std::array::from_fn(|i| size * f64::from((k + 5 * i as i32) % 7 - 3))
        };
        let [(a, a_rest), (b, b_rest)] =
            [(1, 0.25), (3, -0.125)].map(|(k, size)| (part(k, 1.0), part(k, size)));
        let whole = |values: [f64; COUNT], rest: [f64; COUNT]| -> [f64; COUNT] {
            std::array::from_fn(|i| values[i] + rest[i])
        };
        let lengths = |values: [f64; COUNT], rest: [f64; COUNT]| {
            let mut lengths = Lengths::new();
            let (square, error) = (dot(&values, &values), dot(&rest, &rest).sqrt());
            lengths.add(&Numbers { values, square, error });
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

    /// The numbers of C eps(w) - rho from balls, with forces that are off.
    fn in_balls(
        law: &RoundedLaw,
        material: Material<f64>,
        t: &Triangle<Ball>,
        w: ([Vector2<f64>; 3], Option<[Vector2<f64>; 3]>),
        forces: [[Vector2<f64>; 2]; 3],
    ) -> Numbers {
        let (nodal, bulges) = (w.0.map(exact), w.1.map(|bulges| bulges.map(exact)));
        let sigma =
            Affine::of_displacement(t, &nodal, bulges.as_ref(), &piece(material).material());
        let forces = forces.map(|ends| ends.map(exact));
        let loads = Loads { forces, body: [Vector2::zeros(); 3] };
        let tau = Composite::new(&Frame::new(t), &loads).distance_from(&sigma);
        Numbers::slowly(law, &piece(material), t, &tau, 0.0)
    }

    fn distance(a: &Numbers, b: &Numbers) -> f64 {
        let apart: [f64; COUNT] = std::array::from_fn(|k| a.values[k] - b.values[k]);
        dot(&apart, &apart).sqrt()
    }

    #[test]
    fn doubles_are_as_near_to_balls_as_their_error_says() {
        let (mut sharp, mut closest) = (0, 0.0_f64);
        for k in 0..300 {
            let material = laws()[k as usize % 3];
            let law = RoundedLaw::new(&material);
            let t = balls(&triangle(k));
            let w = (vectors(k), (k % 2 == 0).then(|| vectors(k + 5)));
            let Some(ground) = Ground::new(&law, &t) else { continue };
            let frame = Frame::new(&ground.triangle);
            let in_balls_of_w = (w.0.map(exact::<Ball>), w.1.map(|bulges| bulges.map(exact)));
            let find =
                |forces, off| ground.numbers(&frame, &material, in_balls_of_w, (forces, off), 0.0);
            let Some(found) = find(forces(k), 0.0) else { continue };
            let known = in_balls(&law, material, &t, w, forces(k));
            assert!(distance(&found, &known) <= found.error + known.error, "{k}");
            assert!(found.error <= SHARP * found.square.sqrt() && known.error < found.error);
            closest = closest.max(distance(&found, &known) / found.error);
            sharp += 1;
            // Forces that are off by some: the numbers are, by no more than is said, and not by far less.
            let moved = forces(k).map(|ends| ends.map(|f| f.map(|x| x + 1e-3 * x.signum())));
            let off = distance(&found, &in_balls(&law, material, &t, w, moved));
            let said = find(forces(k), 1e-3 * 1.000_001).unwrap().error;
            assert!(off <= said, "{k}: {off} of {said}");
        }
        assert!(sharp > 200 && closest < 1.0, "{sharp}, {closest}");
    }

    #[test]
    fn energies_in_doubles_are_those_of_balls() {
        for k in 0..100 {
            let material = laws()[k as usize % 3];
            let (law, t) = (RoundedLaw::new(&material), balls(&triangle(k)));
            let w: (_, Option<[Vector2<Ball>; 3]>) =
                (vectors(k).map(exact), (k % 2 == 0).then(|| vectors(k + 5).map(exact)));
            let normals = [0, 1, 2].map(|i| t.scaled_normal(i));
            let squares = piece(material).material().squares();
            let known =
                strain_energy(&squares, (&w.0, w.1), &normals) / (t.double_area() * Ball::from(24));
            let Some(found) = Ground::new(&law, &t).and_then(|ground| ground.energy(w, 0.0)) else {
                continue;
            };
            assert!(found.lower() <= known.lower() && known.upper() <= found.upper(), "{k}");
        }
    }

    #[test]
    fn a_radius_is_a_part_of_the_size() {
        let around = |v: Vector2<f64>| v.map(|x| Ball::around(x, 1e-13));
        let (law, t) = (RoundedLaw::new(&laws()[0]), triangle(3));
        let near = Triangle { vertices: t.vertices.map(around) };
        let [wide, known] = [near, balls(&t)].map(|t| Ground::new(&law, &t).unwrap());
        assert!(wide.skew > 10.0 * known.skew && wide.ratio > 10.0 * known.ratio);
        let largest = |w: [Vector2<Ball>; 3]| displacements((w, None)).2;
        // Two radii, over the roundings that stand for them.
        let more = largest(vectors(1).map(around)) - largest(vectors(1).map(exact));
        let expected = 2e-13 / (f64::EPSILON * f64::from(OF_RADIUS));
        assert!((more / expected - 1.0).abs() < 1e-2, "{more}, {expected}");
    }

    #[test]
    fn what_is_too_flat_or_too_large_for_doubles_is_left_to_balls() {
        let flat = |height: f64| {
            let vertices = [[0.0, 0.0], [1.0, 1.0], [0.5, 0.5 + height]];
            balls(&Triangle { vertices: vertices.map(Vector2::from) })
        };
        let law = RoundedLaw::new(&laws()[0]);
        assert!(Ground::new(&law, &flat(1e-4)).is_some());
        assert!(Ground::new(&law, &flat(1e-9)).is_none());
        let large = Triangle { vertices: triangle(1).vertices.map(|v| exact(v * 1e20)) };
        assert!(Ground::<'_>::new::<Ball>(&law, &large).is_none());
        let soft = RoundedLaw::new(&Material::lame(1e-30, 1e-30, Plane::Strain));
        assert!(Ground::new(&soft, &balls(&triangle(1))).is_none());
    }

    /// A double with its size and the number of its roundings, by the rules of the module's head.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Rounded {
        value: f64,
        size: f64,
        count: u32,
    }

    impl From<i32> for Rounded {
        fn from(value: i32) -> Rounded {
            Rounded::exactly(f64::from(value))
        }
    }

    impl Neg for Rounded {
        type Output = Rounded;

        fn neg(self) -> Rounded {
            Rounded { value: -self.value, ..self }
        }
    }

    macro_rules! term {
        ($operator:ident $function:ident, $a:ident $b:ident $value:expr, $size:expr, $count:expr) => {
            impl $operator for Rounded {
                type Output = Rounded;

                fn $function(self, other: Rounded) -> Rounded {
                    let ($a, $b) = (self, other);
                    Rounded { value: $value, size: $size, count: $count + 1 }
                }
            }
        };
    }
    term!(Add add, a b a.value + b.value, a.size + b.size, a.count.max(b.count));
    term!(Sub sub, a b a.value - b.value, a.size + b.size, a.count.max(b.count));
    term!(Mul mul, a b a.value * b.value, a.size * b.size, [a.count, b.count].iter().sum::<u32>());
    term!(Div div, a b a.value / b.value, a.size * b.size / (b.value * b.value),
        [a.count, b.count].iter().sum::<u32>());

    crate::kernel::entry_of_nalgebra!(Rounded);

    impl Scalar for Rounded {
        fn split(
            self,
            _: impl FnOnce(Rounded) -> Rounded,
            positive: impl FnOnce(Rounded) -> Rounded,
        ) -> Rounded {
            positive(self)
        }
    }

    impl Enclosing for Rounded {
        fn exactly(value: f64) -> Rounded {
            Rounded { value, size: value.abs(), count: 0 }
        }

        fn sqrt(self) -> Rounded {
            let root = self.value.sqrt();
            Rounded { value: root, size: self.size / root, count: self.count + 1 }
        }

        fn upper(self) -> f64 {
            self.value
        }

        fn lower(self) -> f64 {
            self.value
        }
    }

    /// The sizes, and the most roundings, of all numbers of C eps(w) - rho and of the energy of w, over what is said of them.
    fn sizes(k: i32, material: Material<f64>, bulges: bool) -> ([f64; 2], u32) {
        let law = RoundedLaw::new(&material);
        let ground = Ground::new(&law, &balls(&triangle(k))).unwrap();
        let given = |x: f64| Rounded { count: OF_RADIUS, ..Rounded::exactly(x) };
        let t = Triangle { vertices: ground.triangle.vertices.map(|v| v.map(given)) };
        let mut nodal = vectors(k).map(|v| v.map(given));
        nodal[0] = Vector2::zeros();
        let bulges = bulges.then(|| vectors(k + 5).map(|v| v.map(given)));
        let of =
            |term: Material<Rounded>| Affine::of_displacement(&t, &nodal, bulges.as_ref(), &term);
        let sigma = of(piece(material).material());
        let forces = forces(k).map(|ends| ends.map(|f| f.map(Rounded::exactly)));
        let loads = Loads { forces, body: [Vector2::zeros(); 3] };
        let tau = Composite::new(&Frame::new(&t), &loads).distance_from(&sigma);
        let square = |l: f64| Rounded { count: OF_RADIUS, ..Rounded::exactly(l) };
        let squares = Squares {
            bulk: given(law.squares.bulk),
            shear: given(law.squares.shear),
            beyond: law.squares.beyond.map(|(other, l)| (given(other), l.map(square))),
        };
        let (mut length, mut count) = (0.0, 0);
        let root = t.double_area().sqrt();
        for (k, number) in parts(&squares, &tau).into_iter().enumerate() {
            let factor = Rounded { count: 1, ..Rounded::exactly(FACTORS[k / 3]) };
            let number = number * (root * given(law.roots[k % 3]) * factor);
            length += number.size * number.size;
            count = count.max(number.count);
        }
        let largest =
            |of: &[Vector2<Rounded>]| of.iter().flatten().map(|x| x.size).fold(0.0, f64::max);
        let force = largest(forces.as_flattened());
        let moved = largest(&nodal).max(bulges.map_or(0.0, |bulges| largest(&bulges)));
        let [per_force, per_stress] = ground.sizes();
        let said = per_force * force + per_stress * law.stress * moved;
        let flat = composite(1, false);
        let normals = [0, 1, 2].map(|i| t.scaled_normal(i));
        let energy = strain_energy(&squares, (&nodal, bulges), &normals)
            / (t.double_area() * Rounded::from(24));
        let squares = if bulges.is_none() { 8.5 } else { 201.0 };
        let of_energy = squares * law.energy * ground.skew * ground.ratio * moved * moved;
        let ratios =
            [length.sqrt() / (ground.length(&flat) * ground.skew * said), energy.size / of_energy];
        (ratios, count.max(energy.count))
    }

    #[test]
    fn sizes_and_roundings_are_no_more_than_is_said() {
        let (mut most, mut count) = ([0.0_f64; 2], 0);
        for k in 0..300 {
            for material in laws() {
                for bulges in [false, true] {
                    let (found, roundings) = sizes(k, material, bulges);
                    (0..2).for_each(|i| most[i] = most[i].max(found[i]));
                    count = count.max(roundings);
                }
            }
        }
        assert!(most.iter().all(|ratio| (0.01..1.0).contains(ratio)), "{most:?}");
        assert!(count <= MOST && count > MOST - 32, "{count}");
    }

    #[test]
    fn the_resultant_to_twice_the_precision_is_that_of_balls_and_sharper() {
        let ball = |x: f64| Ball::point(x);
        let (t, triangle) = (triangle(1), balls(&triangle(1)));
        let mut loads = Loads {
            forces: [[[0.3, -1.0], [0.7, 0.2]], [[-0.4, 0.9], [1.1, -0.6]], [[0.0; 2]; 2]]
                .map(|ends| ends.map(Vector2::from)),
            body: [Vector2::zeros(); 3],
        };
        // On the third edge what balances, but for rounding.
        loads.forces[2] =
            loads.resultant(&t).on_edge(t.vertices[0], t.vertices[1]).map(|force| -force);
        let given = Loads {
            forces: loads.forces.map(|ends| ends.map(|f| f.map(ball))),
            body: [Vector2::zeros(); 3],
        };
        let sharp = resultant(&triangle, given.forces);
        let wide = given.resultant(&triangle).about(sharp.about);
        let pairs = [
            (sharp.force[0], wide.force[0]),
            (sharp.force[1], wide.force[1]),
            (sharp.moment, wide.moment),
        ];
        for (sharp, wide) in pairs {
            let ((a, r), (b, s)) = (sharp.centred(), wide.centred());
            assert!((a - b).abs() <= r + s && r <= 1e-28 && s >= 1e-17, "{sharp:?}, {wide:?}");
        }
        // Vertices that are anywhere near: the moments about the same point are as near.
        let near = Triangle { vertices: t.vertices.map(|v| v.map(|x| Ball::around(x, 1e-13))) };
        let beside = resultant(&near, given.forces).about(sharp.about);
        let ((a, r), (b, s)) = (sharp.moment.centred(), beside.moment.centred());
        assert!((a - b).abs() <= r + s && s > 1e-13, "{sharp:?}, {beside:?}");
        let moved = t.vertices.map(|v| Vector2::new(ball(v[0] + 9e-14), ball(v[1] - 9e-14)));
        let moved = [moved[0], balls(&t).vertices[1], moved[2]];
        let moved = resultant(&Triangle { vertices: moved }, given.forces).about(sharp.about);
        let (c, q) = moved.moment.centred();
        assert!((c - a).abs() > 1e-14 && (c - b).abs() + q <= s, "{moved:?}, {beside:?}");
        // A force that is not a double is left to balls.
        let mut wide = given;
        wide.forces[1][0][1] = Ball::around(0.9, 1e-3);
        assert_eq!(resultant(&triangle, wide.forces), wide.resultant(&triangle));
    }
}
