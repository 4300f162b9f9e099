//! The composite stress element of Johnson and Mercier: the statically admissible stress that certificates are made of.
//!
//! ```text
//!            2
//!            |\           The triangle T is cut at its centroid m into three parts; part i holds edge i, opposite
//!            | \          vertex i. On each part the stress is symmetric and affine, and across the cuts its traction
//!            |  \         is continuous: 15 degrees of freedom, 2 x 6 for the tractions on the edges, which are affine,
//!            | m \        and 3 for the mean stress.
//!            |    \
//!            0 ---- 1
//! ```
//!
//! There is no system to solve. Write N_i = |E_i| n_i, J = 2 |T|, t_j = x_j - m, and G_i = tau N_i for the traction on edge i,
//! per unit of its parameter. **At corner j**, where parts i and k meet along the cut with the tangent t_j, the traction
//! is continuous if tau^i - tau^k = c t_j (x) t_j; then N_k . tau^i N_i - N_i . tau^k N_k = c (t_j . N_i) (t_j . N_k) with
//! t_j . N_i = t_j . N_k = J/3 gives c = 9 (N_k . G_i - N_i . G_k) / J^2, and two tractions determine a symmetric tensor.
//! **At m** three differences c_j t_j (x) t_j add up to zero; the three tensors are independent, so tau is continuous
//! there, and the mean stress determines it.
//!
//! int_T div tau . w = int tau N . w - int tau : eps(w) for affine w has on the left the three constant divergences of the
//! parts, which affine functions tell apart: div tau is minus the load f (constant on each part) exactly when the
//! tractions and f are in equilibrium and the mean stress is the one of `Composite::new`.
//!
//! **A load f that is affine**, with the values m_f + w_a at the vertices, asks for more, quadratic stresses without tractions
//! (`Composite::bent`): E_i (x) E_i l_j l_k has the divergence E_i (l_j - l_k), and on part i, in its own coordinates mu (0 at
//! m),
//!
//! mu_0 ((mu_k - mu_j) (1/2 E_i (x) E_i - 3/4 t_i (x) t_i) + 1/4 (mu_j + mu_k) sym(E_i (x) t_i))
//!
//! has the divergence sum E_a l_a + 3/4 E_i; so these and a load that is constant on each part make up any affine one.

use nalgebra::{Matrix2, Vector2};

use super::{Material, Scalar, Squares, Stress, Triangle};

/// The load of one triangle as a certificate sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loads<S> {
    /// G_i = tau N_i on edge i (opposite vertex i, towards the outside), at its start i+1 and at its end i+2: a force per
    /// unit of the edge's parameter in \[0, 1\].
    pub forces: [[Vector2<S>; 2]; 3],
    /// f at vertex i, affine between them: a force per unit of area.
    pub body: [Vector2<S>; 3],
}

/// A stress on a triangle, affine on each of its three parts, or quadratic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Composite<S> {
    /// On part i, at the corners i+1 and i+2.
    pub corners: [[Stress<S>; 2]; 3],
    /// At the centroid.
    pub centre: Stress<S>,
    /// On part i, in the middles of its edge i and of its cuts to the corners i+1 and i+2: what is beyond the mean of the ends.
    pub(crate) bulges: Option<[[Stress<S>; 3]; 3]>,
}

/// C eps(v) of a displacement v of degree 1 or 2: a stress that is constant on the triangle or affine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine<S> {
    /// The stress of the affine function with the values of v at the vertices.
    pub base: Stress<S>,
    /// The stress added at each vertex; `None` where v is affine.
    pub beyond: Option<[Stress<S>; 3]>,
}

/// The part that does not depend on the loads of a triangle.
pub struct Frame<S> {
    normals: [Vector2<S>; 3],
    edges: [Vector2<S>; 3],
    arms: [Vector2<S>; 3],
    double_area: S,
    /// 1/J
    per_area: S,
}

/// A force and a moment, with the point that the moment is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench<S> {
    /// The force.
    pub force: Vector2<S>,
    /// The moment about `about`, positive counter-clockwise.
    pub moment: S,
    /// The point.
    pub about: Vector2<S>,
}

impl<S: Scalar> Frame<S> {
    /// Computes the frame of a triangle.
    pub fn new(triangle: &Triangle<S>) -> Self {
        let double_area = triangle.double_area();
        Frame {
            normals: [0, 1, 2].map(|i| triangle.scaled_normal(i)),
            edges: [0, 1, 2].map(|i| triangle.edge(i)),
            arms: arms(triangle),
            double_area,
            per_area: S::from(1) / double_area,
        }
    }
}

impl<S: Scalar> Affine<S> {
    /// C eps(v) for v with the values `nodal` at the vertices and, in the middle of edge i, `bulges[i]` beyond the mean of its
    /// ends: v is sum v_i l_i + 4 sum b_i l_j l_k, so that the gradient at vertex i has 4 (b_j (x) grad l_k + b_k (x) grad l_j)
    /// beside that of the first sum (i, j, k in turn).
    pub fn of_displacement(
        triangle: &Triangle<S>,
        nodal: &[Vector2<S>; 3],
        bulges: Option<&[Vector2<S>; 3]>,
        material: &Material<S>,
    ) -> Self {
        // From differences, so that a translation has no gradient in any number type.
        let double_area = triangle.double_area();
        let (u, w) = (triangle.scaled_normal(1), triangle.scaled_normal(2));
        let (a, b) = (nodal[1] - nodal[0], nodal[2] - nodal[0]);
        let gradient = Matrix2::from_fn(|i, j| -((a[i] * u[j] + b[i] * w[j]) / double_area));
        let at_vertex = |bulges: &[Vector2<S>; 3], i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            // grad l is minus the scaled normal over 2 |T|.
            let (toward_j, toward_k) = (triangle.scaled_normal(j), triangle.scaled_normal(k));
            let four = S::from(-4) / double_area;
            let entry = |r, c| bulges[j][r] * toward_k[c] + bulges[k][r] * toward_j[c];
            material.stress(Matrix2::from_fn(|r, c| entry(r, c) * four))
        };
        Affine {
            base: material.stress(gradient),
            beyond: bulges.map(|bulges| [0, 1, 2].map(|i| at_vertex(bulges, i))),
        }
    }

    /// At vertex `i` (mod 3).
    pub fn at_corner(&self, i: usize) -> Stress<S> {
        self.beyond.map_or(self.base, |beyond| self.base + beyond[i % 3])
    }

    /// At the point with the barycentric coordinates `l`.
    pub fn at(&self, l: [S; 3]) -> Stress<S> {
        let at = |[a, b, c]: [Stress<S>; 3]| self.base + (a * l[0] + b * l[1] + c * l[2]);
        self.beyond.map_or(self.base, at)
    }

    /// At the centroid.
    pub fn mean(&self) -> Stress<S> {
        let third = |sum: Stress<S>| self.base + sum / S::from(3);
        self.beyond.map_or(self.base, |[a, b, c]| third(a + b + c))
    }

    /// int_T sigma : C^-1 sigma. The square of an affine function with the values s_i has the integral
    /// |T| / 12 (sum s_i^2 + (sum s_i)^2).
    pub fn energy(&self, material: &Material<S>, double_area: S) -> S {
        if self.beyond.is_none() {
            return material.squares().of_stress(self.base) * double_area / S::from(2);
        }
        let [a, b, c] = [0, 1, 2].map(|i| self.at_corner(i));
        let squares = material.squares();
        let square = |s: Stress<S>| squares.of_stress(s);
        (square(a) + square(b) + square(c) + square(a + b + c)) * double_area / S::from(24)
    }
}

impl<S: Scalar> Composite<S> {
    /// The stress with these tractions whose divergence is minus the load: `loads.body` where that is constant, else the one
    /// that is constant on each part and has the same moments. That takes tractions and body force in equilibrium.
    pub fn new(frame: &Frame<S>, loads: &Loads<S>) -> Self {
        let Frame { normals, edges, arms, per_area, .. } = frame;
        let per_area = *per_area;
        let three = S::from(3);
        let third = S::from(1) / three;
        // [corner][part i = j + 1, part k = j + 2]
        let at_corner = [0, 1, 2].map(|j| {
            let (i, k) = ((j + 1) % 3, (j + 2) % 3);
            let (p, q) = (loads.forces[i][1], loads.forces[k][0]);
            // c J/3
            let jump = three * per_area * (normals[k].dot(&p) - normals[i].dot(&q));
            let first = from_tractions(p, q + arms[j] * jump, edges[i], edges[k], per_area);
            let c = three * per_area * jump;
            let (x, y) = (arms[j][0], arms[j][1]);
            [first, first - Stress::new([c * x * x, c * y * y, c * x * y])]
        });
        let mean = mean_stress(frame, loads, third);
        let [a, b, c] = at_corner.map(|[first, second]| first + second);
        let centre = mean * three + (a + b + c) * -third;
        let corners = [0, 1, 2].map(|i| [at_corner[(i + 1) % 3][1], at_corner[(i + 2) % 3][0]]);
        Composite { corners, centre, bulges: None }
    }

    /// The stress with the same tractions and the same mean whose divergence is minus the affine `body`: with c_i and b from
    /// w_a = c_k E_k - c_j E_j + b E_a (a, j, k in turn), minus what the module's head has c_i and b times.
    pub fn bent(self, frame: &Frame<S>, body: &[Vector2<S>; 3]) -> Self {
        let Frame { edges, arms, per_area, .. } = frame;
        let part = |numerator: i32, denominator: i32| S::from(numerator) / S::from(denominator);
        let mean = (body[0] + body[1] + body[2]) * part(1, 3);
        let beyond = body.map(|f| f - mean);
        let torque = (0..3).map(|a| beyond[a].perp(&arms[a]));
        let b = torque.fold(S::from(0), |sum, x| sum + x) * *per_area * part(1, 2);
        let c = [0, 1, 2].map(|i| b - beyond[(i + 1) % 3].perp(&edges[(i + 2) % 3]) * *per_area);
        let along = [0, 1, 2].map(|i| symmetric(edges[i], edges[i]));
        let whole = [0, 1, 2].map(|i| along[i] * -c[i]);
        let bulges = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let odd = along[i] * part(1, 2) - symmetric(arms[i], arms[i]) * part(3, 4);
            let even = symmetric(edges[i], arms[i]) * part(1, 4);
            let turning = b * part(1, 4);
            let (near, far) = (part(1, 18), part(1, 36));
            let common = whole[i] * near - even * turning;
            [
                whole[i] * part(1, 4),
                common + odd * turning - whole[j] * far + whole[k] * near,
                common - odd * turning + whole[j] * near - whole[k] * far,
            ]
        });
        let sum = bulges.into_iter().flatten().reduce(|sum, bulge| sum + bulge);
        let centre = sum.map_or(self.centre, |sum| self.centre - sum * part(1, 3));
        Composite { centre, bulges: Some(bulges), ..self }
    }

    /// tau on part i at mu, the coordinates of the centroid and of the corners i + 1 and i + 2.
    pub fn at(&self, i: usize, [m, j, k]: [S; 3]) -> Stress<S> {
        let affine = self.centre * m + self.corners[i][0] * j + self.corners[i][1] * k;
        let Some(bulges) = &self.bulges else { return affine };
        let [outer, to_j, to_k] = bulges[i];
        affine + (outer * (j * k) + to_j * (m * j) + to_k * (m * k)) * S::from(4)
    }

    /// sigma - tau.
    pub fn distance_from(&self, sigma: &Affine<S>) -> Composite<S> {
        let negative = |tau: Stress<S>| tau * S::from(-1);
        let corners = |i: usize| [1, 2].map(|k| sigma.at_corner(i + k) - self.corners[i][k - 1]);
        Composite {
            corners: [0, 1, 2].map(corners),
            centre: sigma.mean() - self.centre,
            bulges: self.bulges.map(|all| all.map(|part| part.map(negative))),
        }
    }

    /// int_T tau : C^-1 tau. For a square form, a^2 + b^2 + c^2 + (a + b + c)^2 is, with s = a + b + 2/3 c,
    /// 3/2 s^2 + 1/2 (a - b)^2 + 4/3 c^2. On a part of the area A with the bulges h, 4 mu_p mu_q h_pq each, there is
    /// 2/15 A sum h_pq (2 a_p + 2 a_q + a_r) and 4/45 A (sum h^2 + (sum h)^2) more.
    pub fn energy(&self, material: &Material<S>, double_area: S) -> S {
        let law = material.squares();
        let squares = |tau: Stress<S>| law.products(tau, tau);
        let mut sum = self.affine_products((self.corners, self.centre), &law);
        for ([a, b], h) in self.corners.iter().zip(self.bulges.iter().flatten()) {
            let whole = *a + *b + self.centre;
            let opposite = [self.centre, *b, *a];
            let (linear, square) = (S::from(16) / S::from(5), S::from(32) / S::from(15));
            let mut squared = squares(h[0] + h[1] + h[2]);
            for (h, opposite) in h.iter().zip(opposite) {
                let along = law.products(*h, whole * S::from(2) - opposite);
                sum = [0, 1].map(|k| sum[k] + linear * along[k]);
                let own = squares(*h);
                squared = [0, 1].map(|k| squared[k] + own[k]);
            }
            sum = [0, 1].map(|k| sum[k] + square * squared[k]);
        }
        law.per_moduli(sum) * double_area / S::from(576)
    }

    /// The products of two stresses without bulges, but for 1/576: the bilinear form of a square form.
    fn affine_products(
        &self,
        (corners, centre): ([[Stress<S>; 2]; 3], Stress<S>),
        law: &Squares<S>,
    ) -> [S; 2] {
        let (three, eight) = (S::from(3), S::from(8));
        let two_thirds = S::from(2) / three;
        let sum = law.products(self.centre, centre).map(|x| eight * x);
        self.corners.into_iter().zip(corners).fold(sum, |sum, ([a, b], [c, d])| {
            let s = law.products(a + b + self.centre * two_thirds, c + d + centre * two_thirds);
            let d = law.products(a - b, c - d);
            [0, 1].map(|k| sum[k] + three * s[k] + d[k])
        })
    }

    /// int_T tau : C^-1 rho, the bilinear form of [`Composite::energy`]; rho has no bulges.
    pub fn product_with_affine(
        &self,
        (corners, centre): ([[Stress<S>; 2]; 3], Stress<S>),
        material: &Material<S>,
        double_area: S,
    ) -> S {
        let law = material.squares();
        let mut sum = self.affine_products((corners, centre), &law);
        // Half of what is linear in the bulges.
        let linear = S::from(8) / S::from(5);
        for ([c, d], h) in corners.iter().zip(self.bulges.iter().flatten()) {
            let whole = (*c + *d + centre) * S::from(2);
            for (h, opposite) in h.iter().zip([centre, *d, *c]) {
                let along = law.products(*h, whole - opposite);
                sum = [0, 1].map(|k| sum[k] + linear * along[k]);
            }
        }
        law.per_moduli(sum) * double_area / S::from(576)
    }
}

impl<S: Scalar> Loads<S> {
    /// The resultant of tractions and body force, about the centroid.
    pub fn resultant(&self, triangle: &Triangle<S>) -> Wrench<S> {
        let arms = arms(triangle);
        let (two, six) = (S::from(2), S::from(6));
        let part = triangle.double_area() / six;
        let (mut force, mut moment) = (Vector2::zeros(), S::from(0));
        for i in 0..3 {
            let (a, b) = (arms[(i + 1) % 3], arms[(i + 2) % 3]);
            let [p, q] = self.forces[i];
            let f = self.body[i] * part;
            force = force + (p + q) / two + f;
            let (at_start, at_end) = (a * two + b, a + b * two);
            moment = moment
                + (at_start.perp(&p) + at_end.perp(&q)) / six
                + arms[i].perp(&f) / S::from(4);
        }
        Wrench { force, moment, about: centroid(triangle) }
    }
}

impl<S: Scalar> Wrench<S> {
    /// Moves the point of reference of the moment.
    pub fn about(self, point: Vector2<S>) -> Self {
        let arm = self.about - point;
        Wrench { moment: self.moment + arm.perp(&self.force), about: point, ..self }
    }

    /// The sum with another wrench, about this one's point.
    pub fn plus(self, other: Wrench<S>) -> Self {
        let other = other.about(self.about);
        Wrench {
            force: self.force + other.force,
            moment: self.moment + other.moment,
            about: self.about,
        }
    }

    /// The affine force per unit of parameter, at both ends of the edge from `start` to `end`, that amounts to this wrench:
    /// a constant, and (2 s - 1) times a multiple of the edge's normal N, whose moment about the middle is |E|^2 / 6 times
    /// the multiple, clockwise.
    pub fn on_edge(self, start: Vector2<S>, end: Vector2<S>) -> [Vector2<S>; 2] {
        let wrench = self.about((start + end) / S::from(2));
        let edge = end - start;
        let normal = Vector2::new(edge[1], -edge[0]);
        let slope = normal * -(S::from(6) * wrench.moment / edge.dot(&edge));
        [wrench.force - slope, wrench.force + slope]
    }
}

/// The symmetric part of a (x) b.
fn symmetric<S: Scalar>(a: Vector2<S>, b: Vector2<S>) -> Stress<S> {
    let xy = (a[0] * b[1] + a[1] * b[0]) / S::from(2);
    Stress::new([a[0] * b[0], a[1] * b[1], xy])
}

fn centroid<S: Scalar>(triangle: &Triangle<S>) -> Vector2<S> {
    let third = S::from(1) / S::from(3);
    triangle.point([third; 3])
}

/// x_j - m, from differences of vertices: ((x_j - x_i) + (x_j - x_k)) / 3.
fn arms<S: Scalar>(triangle: &Triangle<S>) -> [Vector2<S>; 3] {
    let third = S::from(1) / S::from(3);
    [0, 1, 2].map(|j| (triangle.edge(j + 1) - triangle.edge(j + 2)) * third)
}

/// The symmetric tensor with the tractions p on N_i and q on N_k, k = i + 1: (q (x) E_i - p (x) E_k) / J.
fn from_tractions<S: Scalar>(
    p: Vector2<S>,
    q: Vector2<S>,
    e_i: Vector2<S>,
    e_k: Vector2<S>,
    per_area: S,
) -> Stress<S> {
    let entry = |r: usize, c: usize| q[r] * e_i[c] - p[r] * e_k[c];
    let half = per_area / S::from(2);
    let xy = (entry(0, 1) + entry(1, 0)) * half;
    Stress::new([entry(0, 0) * per_area, entry(1, 1) * per_area, xy])
}

/// (1/|T|) of the integrals of G (x) (x - m) over the edges and of f (x) (x - m): 1/(3J) of the sum.
fn mean_stress<S: Scalar>(frame: &Frame<S>, loads: &Loads<S>, third: S) -> Stress<S> {
    let Frame { arms, double_area, per_area, .. } = frame;
    let (quarter, factor) = (*double_area / S::from(4), *per_area * third);
    let mut sum = Matrix2::<S>::zeros();
    for i in 0..3 {
        let (a, b) = (arms[(i + 1) % 3], arms[(i + 2) % 3]);
        let (at_start, at_end) = (a + a + b, a + b + b);
        let [p, q] = loads.forces[i];
        let f = loads.body[i] * quarter;
        for r in 0..2 {
            for c in 0..2 {
                let edge = p[r] * at_start[c] + q[r] * at_end[c];
                sum[(r, c)] = sum[(r, c)] + edge + f[r] * arms[i][c];
            }
        }
    }
    let xy = (sum[(0, 1)] + sum[(1, 0)]) * (factor / S::from(2));
    Stress::new([sum[(0, 0)] * factor, sum[(1, 1)] * factor, xy])
}

#[cfg(test)]
mod tests {
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    use super::*;
    use crate::Plane;

    const T: Triangle<f64> = Triangle {
        vertices: [Vector2::new(0.3, -0.2), Vector2::new(2.0, 0.1), Vector2::new(0.7, 1.9)],
    };

    /// The error of some dozen operations on numbers of size 1 to 10, divided by 2 |T| = 3.3.
    const ROUNDING: f64 = 1e-13;

    /// A rule on a triangle that is exact for polynomials of degree 4: barycentric points with weights that add up to 1.
    fn rule() -> Vec<([f64; 3], f64)> {
        let of = |sign: f64| {
            let root = 10_f64.sqrt();
            let a = (8.0 - root + sign * (38.0 - 44.0 * 0.4_f64.sqrt()).sqrt()) / 18.0;
            let weight = (620.0 + sign * (213_125.0 - 53_320.0 * root).sqrt()) / 3720.0;
            let at = |i: usize| ([0, 1, 2].map(|j| if i == j { 1.0 - 2.0 * a } else { a }), weight);
            [0, 1, 2].map(at)
        };
        [of(1.0), of(-1.0)].concat()
    }

    /// Tractions in equilibrium with f: any on two edges, and on the third what balances.
    fn balanced() -> Loads<f64> {
        let forces = [[[0.3, -1.0], [0.7, 0.2]], [[-0.4, 0.9], [1.1, -0.6]], [[0.0; 2]; 2]];
        let body = [[0.5, -0.25], [0.1, 0.3], [-0.7, 0.2]];
        let mut loads = Loads {
            forces: forces.map(|ends| ends.map(Vector2::from)),
            body: body.map(Vector2::from),
        };
        let force = loads.resultant(&T).on_edge(T.vertices[0], T.vertices[1]);
        loads.forces[2] = force.map(|f| -f);
        loads
    }

    fn of(loads: &Loads<f64>) -> Composite<f64> {
        Composite::new(&Frame::new(&T), loads)
    }

    fn bent(loads: &Loads<f64>) -> Composite<f64> {
        of(loads).bent(&Frame::new(&T), &loads.body)
    }

    const UNLOADED: Loads<f64> =
        Loads { forces: [[Vector2::new(0.0, 0.0); 2]; 3], body: [Vector2::new(0.0, 0.0); 3] };

    #[test]
    fn the_energy_of_a_bent_stress_is_its_integral() {
        let material = Material::lame(1.3, 0.7, Plane::Strain);
        let tau = bent(&balanced());
        let part = T.double_area() / 6.0;
        let mut integral = 0.0;
        for i in 0..3 {
            for (mu, weight) in rule() {
                integral += weight * part * material.squares().of_stress(tau.at(i, mu));
            }
        }
        let energy = tau.energy(&material, T.double_area());
        assert_relative_eq!(energy, integral, max_relative = ROUNDING);
        let flat = Composite { bulges: None, ..tau }.energy(&material, T.double_area());
        assert!((flat - integral).abs() > 1e-3 * integral);
    }

    #[test]
    fn the_product_is_the_bilinear_form_of_the_energy() {
        let tensor = Material::tensor([12.0, 3.0, 2.0, 5.0, -1.0, 4.0], None);
        for material in [Material::lame(1.3, 0.7, Plane::Strain), tensor] {
            for a in [of(&balanced()), bent(&balanced())] {
                let b = of(&Loads { body: UNLOADED.body, ..balanced() });
                let plus = |sign: f64| Composite {
                    corners: [0, 1, 2]
                        .map(|i| [0, 1].map(|j| a.corners[i][j] + b.corners[i][j] * sign)),
                    centre: a.centre + b.centre * sign,
                    bulges: a.bulges,
                };
                let energy = |tau: &Composite<f64>| tau.energy(&material, T.double_area());
                let expected = (energy(&plus(1.0)) - energy(&plus(-1.0))) / 4.0;
                let product = |a: &Composite<f64>| {
                    a.product_with_affine((b.corners, b.centre), &material, T.double_area())
                };
                let scale = (energy(&a) * energy(&b)).sqrt();
                assert_abs_diff_eq!(product(&a), expected, epsilon = 10.0 * ROUNDING * scale);
                // Control: a bulge counts.
                let flat = Composite { bulges: None, ..a };
                assert_eq!((product(&flat) - expected).abs() > 1e-6 * scale, a.bulges.is_some());
            }
        }
    }
}
