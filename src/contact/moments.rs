//! The contact terms of (8) on one piece, int \[P\]+ N_a over s in \[0, 1\], enclosed in [balls](crate::kernel::ball).
//!
//! The integral is Lipschitz in P: a radius of P gives a radius of the integral. For the centre of P, a polynomial of degree
//! 1 or 2, the edge is cut near its roots, and on each piece either P or nothing is integrated. No cut need be right: where
//! the sign on a piece is not the one that was taken, |P| is bounded, and the piece's length times that bound is added to the
//! radius. A cut that is off by e leaves |P| = O(e) there, and Newton's method in balls makes e some 2^-100.

use super::friction;
use super::law::EdgeRule;
use super::piece::Piece;
use crate::kernel::ball::{PreciseBall, larger};
use crate::kernel::edge_integral::{bilateral, gauss, roots, times_radius, value_at};
use crate::kernel::friction::gauss_friction;
use crate::kernel::{Element, Response};
use crate::model::element::{Degree, with_element};
use crate::model::law::Law;

impl Piece<PreciseBall> {
    /// The force of [`contribution`](Piece::contribution), enclosed.
    pub(crate) fn force(&self, rule: &EdgeRule, p: &[PreciseBall]) -> Vec<PreciseBall> {
        let weight = self.weight();
        let of = |(response, p): (&Response, &[PreciseBall])| match response {
            Response::Unilateral => moments(rule, self.degree, self.radii, p),
            Response::Bilateral => with_element!(self.degree, E => {
                let p = std::array::from_fn(|a| p[a]);
                bilateral::<E, _, _, _>(p, self.radii).gradient.into()
            }),
        };
        let responses = self.geometry.law.responses().iter();
        let mut moments: Vec<PreciseBall> =
            responses.zip(p.chunks(self.degree.nodes_per_edge())).flat_map(of).collect();
        if let Law::Friction(bound) = self.geometry.law {
            moments.extend(friction::enclosed(bound, rule, (self.degree, self.gamma), p));
        }
        moments.into_iter().map(|moment| weight * moment).collect()
    }
}

/// int \[P\]+ N_a for P of this degree with the nodal values `p`, by the rule of the method; with the weight r where it has these
/// `radii` at the ends.
pub fn moments(
    rule: &EdgeRule,
    degree: Degree,
    radii: Radii,
    p: &[PreciseBall],
) -> Vec<PreciseBall> {
    with_element!(degree, E => {
        moments_of::<E, _, _>(degree, rule, radii, std::array::from_fn(|a| p[a])).into()
    })
}

/// r at the ends of an edge, in a body of revolution.
type Radii = Option<[PreciseBall; 2]>;

fn moments_of<E: Element<N, M>, const N: usize, const M: usize>(
    degree: Degree,
    rule: &EdgeRule,
    radii: Radii,
    p: [PreciseBall; M],
) -> [PreciseBall; M] {
    match rule {
        EdgeRule::Gauss(points) => {
            let points = points.iter().map(|&(s, w)| (PreciseBall::from(s), PreciseBall::from(w)));
            gauss::<E, _, _, _>(p, radii, points).gradient
        }
        // Bernstein's coefficients bound P.
        EdgeRule::Exact if degree.bernstein(&p).iter().all(|c| c.upper() <= 0.0) => {
            [PreciseBall::from(0); M]
        }
        EdgeRule::Exact if degree.bernstein(&p).iter().all(|c| c.lower() >= 0.0) => {
            bilateral::<E, _, _, _>(p, radii).gradient
        }
        EdgeRule::Exact => {
            // |N_a| <= 1, and so |int ([P]+ - [Q]+) N_a| <= max |P - Q| <= the sum of the radii.
            let spread = largest(radii) * p.iter().map(|p| p.radius()).sum::<f64>();
            by_pieces::<E, _, _>(degree, radii, p.map(|p| PreciseBall::point(p.centre())))
                .map(|moment| moment.widened(2.0 * spread))
        }
    }
}

/// The largest weight along an edge.
fn largest(radii: Radii) -> f64 {
    radii.map_or(1.0, |[start, end]| larger(start.upper(), end.upper()))
}

/// int clip(P; \[m\]+) N_a for P and m of this degree with the nodal values `p` and `m`, by the rule of the method.
pub(crate) fn of_friction(
    rule: &EdgeRule,
    degree: Degree,
    p: &[PreciseBall],
    m: &[PreciseBall],
) -> Vec<PreciseBall> {
    with_element!(degree, E => {
        let (p, m) = (std::array::from_fn(|a| p[a]), std::array::from_fn(|a| m[a]));
        friction_of::<E, _, _>(degree, rule, p, m).into()
    })
}

fn friction_of<E: Element<N, M>, const N: usize, const M: usize>(
    degree: Degree,
    rule: &EdgeRule,
    p: [PreciseBall; M],
    m: [PreciseBall; M],
) -> [PreciseBall; M] {
    match rule {
        EdgeRule::Gauss(points) => {
            let points = points.iter().map(|&(s, w)| (PreciseBall::from(s), PreciseBall::from(w)));
            gauss_friction::<E, _, _, _>(p, m, points).gradient
        }
        EdgeRule::Exact => {
            // The clip is Lipschitz in both with the constant 1.
            let spread = p.iter().chain(&m).map(|ball| ball.radius()).sum::<f64>();
            let centres = |v: [PreciseBall; M]| v.map(|ball| PreciseBall::point(ball.centre()));
            by_sections::<E, _, _>(degree, centres(p), centres(m))
                .map(|moment| moment.widened(2.0 * spread))
        }
    }
}

/// The edge is cut near the roots of m, m - P and m + P. On each section P, m, -m or nothing is integrated, which differs from
/// the clip by at most
///
/// - P: \[P - m\]+ + \[-P - m\]+,   m: \[m - P\]+ + \[-m\]+,   -m: \[m + P\]+ + \[-m\]+,   nothing: \[m\]+.
fn by_sections<E: Element<N, M>, const N: usize, const M: usize>(
    degree: Degree,
    p: [PreciseBall; M],
    m: [PreciseBall; M],
) -> [PreciseBall; M] {
    let below: [PreciseBall; M] = std::array::from_fn(|a| m[a] - p[a]);
    let above: [PreciseBall; M] = std::array::from_fn(|a| m[a] + p[a]);
    let parabolas = [m, below, above].map(|values| (Parabola::new(degree, &values), values));
    let mut cuts = vec![PreciseBall::from(0), PreciseBall::from(1)];
    for (parabola, values) in &parabolas {
        let heads = values.map(PreciseBall::head);
        cuts.extend(roots::<E, _, _>(heads).map(|root| parabola.refined(root)));
    }
    cuts.sort_unstable_by(|a, b| a.head().total_cmp(&b.head()));
    let [(bound, _), (below, _), (above, _)] = &parabolas;
    let mut sum = [PreciseBall::from(0); M];
    let mut wrong = 0.0;
    for section in cuts.windows(2) {
        let (a, b) = (section[0], section[1]);
        let length = b - a;
        let points = boole(a, length);
        let mean = |of: &Parabola| -> f64 {
            points.iter().map(|(s, weight)| weight.head() * of.at(*s).head()).sum()
        };
        let over = |of: &Parabola, sign: i32| larger(of.largest(sign, a, b), 0.0);
        let (values, other) = if mean(bound) <= 0.0 {
            (None, over(bound, 1))
        } else if mean(below) <= 0.0 {
            (Some(m), over(below, 1) + over(bound, -1))
        } else if mean(above) <= 0.0 {
            (Some(m.map(|m| -m)), over(above, 1) + over(bound, -1))
        } else {
            (Some(p), over(below, -1) + over(above, -1))
        };
        if let Some(values) = values {
            for (s, weight) in points {
                let value = value_at::<E, _, _, _>(values, s);
                let shapes: [PreciseBall; M] = E::edge_values(s);
                for (sum, shape) in sum.iter_mut().zip(shapes) {
                    *sum += length * weight * value * shape;
                }
            }
        }
        wrong += other * length.magnitude() * (1.0 + 16.0 * f64::EPSILON);
    }
    sum.map(|moment| moment.widened(wrong))
}

/// The points and weights of Boole's rule on a stretch that starts at `a`, exact to degree 5.
fn boole(a: PreciseBall, length: PreciseBall) -> [(PreciseBall, PreciseBall); 5] {
    [(0, 7), (1, 32), (2, 12), (3, 32), (4, 7)].map(|(i, weight)| {
        let s = a + length * PreciseBall::from(i) / PreciseBall::from(4);
        (s, PreciseBall::from(weight) / PreciseBall::from(90))
    })
}

/// P = c_0 + c_1 s + c_2 s^2
struct Parabola([PreciseBall; 3]);

impl Parabola {
    fn new(degree: Degree, p: &[PreciseBall]) -> Self {
        let [zero, two, three, four] = [0, 2, 3, 4].map(PreciseBall::from);
        Parabola(match degree {
            Degree::One => [p[0], p[1] - p[0], zero],
            Degree::Two => {
                let (start, end, middle) = (p[0], p[1], p[2]);
                let slope = four * middle - three * start - end;
                [start, slope, two * (start + end) - four * middle]
            }
        })
    }

    fn at(&self, s: PreciseBall) -> PreciseBall {
        self.0[0] + s * (self.0[1] + s * self.0[2])
    }

    fn slope(&self, s: PreciseBall) -> PreciseBall {
        self.0[1] + PreciseBall::from(2) * s * self.0[2]
    }

    /// One step of Newton's method from a root, if it ends on the edge.
    fn refined(&self, root: f64) -> PreciseBall {
        let at = PreciseBall::from(root);
        let step = PreciseBall::point((self.at(at) / self.slope(at)).centre());
        let better = PreciseBall::point((at - step).centre());
        let inside = better.is_finite() && better.lower() > 0.0 && better.upper() < 1.0;
        if inside { better } else { at }
    }

    /// The largest value of `sign` P on \[a, b\], or more: at an end; or below the tangent at a point near the vertex, and, where
    /// the parabola may open upwards, what its curvature adds to that.
    fn largest(&self, sign: i32, a: PreciseBall, b: PreciseBall) -> f64 {
        let sign = PreciseBall::from(sign);
        let ends = larger((sign * self.at(a)).upper(), (sign * self.at(b)).upper());
        let slopes = [a, b].map(|s| sign * self.slope(s));
        let monotone =
            slopes.iter().all(|s| s.lower() >= 0.0) || slopes.iter().all(|s| s.upper() <= 0.0);
        let curvature = sign * self.0[2];
        if monotone || curvature.lower() >= 0.0 {
            return ends;
        }
        // A parabola whose curvature is zero to rounding has no vertex: any point will do.
        let vertex = -self.0[1].head() / (2.0 * self.0[2].head());
        let vertex = if vertex.is_nan() { a.head() } else { vertex };
        let near = PreciseBall::from(vertex.clamp(a.head(), b.head()));
        let (slope, length) = (PreciseBall::from((sign * self.slope(near)).magnitude()), b - a);
        let bend = PreciseBall::from(larger(curvature.upper(), 0.0)) * length * length;
        let tangent = sign * self.at(near) + slope * length + bend;
        // A point outside [a, b] by a rounding error is still at most |b - a| away, up to this error.
        let slack = slope.magnitude() * 4.0 * f64::EPSILON;
        larger(ends, tangent.upper() + slack)
    }
}

fn by_pieces<E: Element<N, M>, const N: usize, const M: usize>(
    degree: Degree,
    radii: Radii,
    p: [PreciseBall; M],
) -> [PreciseBall; M] {
    let parabola = Parabola::new(degree, &p);
    let mut cuts = vec![PreciseBall::from(0), PreciseBall::from(1)];
    let heads = p.map(PreciseBall::head);
    cuts.extend(roots::<E, _, _>(heads).map(|root| parabola.refined(root)));
    cuts.sort_unstable_by(|a, b| a.head().total_cmp(&b.head()));
    let mut sum = [PreciseBall::from(0); M];
    let mut wrong = 0.0;
    for piece in cuts.windows(2) {
        let (a, b) = (piece[0], piece[1]);
        let length = b - a;
        let points = boole(a, length).map(|(s, weight)| (s, weight, parabola.at(s)));
        let mean: f64 = points.iter().map(|(_, weight, p)| weight.head() * p.head()).sum();
        let positive = !(mean <= 0.0);
        if positive {
            for (s, weight, _) in points {
                let value = value_at::<E, _, _, _>(p, s);
                let shapes: [PreciseBall; M] = E::edge_values(s);
                let weight = times_radius(weight, radii, s);
                for (sum, shape) in sum.iter_mut().zip(shapes) {
                    *sum += length * weight * value * shape;
                }
            }
        }
        let other = parabola.largest(if positive { -1 } else { 1 }, a, b);
        let other = larger(other, 0.0) * largest(radii);
        wrong += other * length.magnitude() * (1.0 + 8.0 * f64::EPSILON);
    }
    sum.map(|moment| moment.widened(wrong))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::edge_integral::ExactEdge;
    use crate::kernel::{P1, P2};

    fn values() -> Vec<[f64; 3]> {
        let mut all = vec![
            [0.25, 0.25, 0.0],
            [1.0, 1.0, 1e-9],
            [1.0, 1.0, -1e-17],
            [0.0; 3],
            [1.0, -1.0, 0.0],
            [-0.25, -0.25, 0.0],
            [1e-300, -1e-300, 1e-300],
            // The same value three times, which no ball knows to be a parabola without curvature.
            [0.1; 3],
            [-0.1; 3],
        ];
        let mut x = 0.7_f64;
        for _ in 0..400 {
            let mut next = || {
                x = (x * 3.9) * (1.0 - x);
                x - 0.5
            };
            all.push([next(), next(), next()]);
        }
        all
    }

    /// The doubles of the kernel lie in the enclosure, to their own rounding, and the enclosure is narrow.
    fn encloses<E: ExactEdge<f64, N, M>, const N: usize, const M: usize>(degree: Degree) {
        for p in values() {
            let p: [f64; M] = std::array::from_fn(|a| p[a]);
            let exact = E::exact(p).gradient;
            let enclosed = moments(&EdgeRule::Exact, degree, None, &p.map(PreciseBall::from));
            let size = p.iter().fold(0.0, |m: f64, p| m.max(p.abs()));
            for (exact, ball) in exact.into_iter().zip(enclosed) {
                let off = (ball - PreciseBall::from(exact)).magnitude();
                // Next to a double root the formula for the roots has half the digits, in doubles.
                assert!(off <= 1e-14 * size + 1e-260, "{p:?}: {exact:e} {ball:?}");
                // There it may miss both roots, and P between them, which is rounding.
                let double_root = p[0] == p[1] && (p[M - 1] / p[0]).abs() < 1e-8;
                let width = if double_root { 1e-15 } else { 1e-26 };
                assert!(ball.radius() <= width * size + 1e-260, "{p:?}: {ball:?}");
            }
        }
    }

    #[test]
    fn with_the_weight_of_revolution_too_and_without_it_the_kernel_is_outside() {
        let radii = [0.0, 1.5];
        for p in values().into_iter().skip(9) {
            let exact = P2::exact_with(p, Some(radii)).gradient;
            let [with, without] = [Some(radii.map(PreciseBall::from)), None].map(|radii| {
                moments(&EdgeRule::Exact, Degree::Two, radii, &p.map(PreciseBall::from))
            });
            for (exact, ball) in exact.into_iter().zip(with) {
                assert!((ball - PreciseBall::from(exact)).magnitude() <= 1e-14);
                assert!(ball.radius() <= 1e-26);
            }
            let off = (without[0] - PreciseBall::from(exact[0])).magnitude();
            assert!(off > 1e-6 || exact == [0.0; 3], "{p:?}");
        }
    }

    #[test]
    fn what_the_kernel_integrates_is_enclosed_to_a_hundred_bits() {
        encloses::<P1, _, _>(Degree::One);
        encloses::<P2, _, _>(Degree::Two);
    }

    #[test]
    fn what_sticks_between_two_roots_that_doubles_do_not_tell_apart_is_enclosed() {
        // m = 1 and m - P = d - (2 s - 1)^2: P is below the bound on a stretch as long as the root of d.
        let d = 1e-17_f64;
        let m = [PreciseBall::from(1); 3];
        let below = [-1.0, -1.0, d].map(PreciseBall::from);
        let p: Vec<PreciseBall> = m.iter().zip(below).map(|(&m, below)| m - below).collect();
        let moments = of_friction(&EdgeRule::Exact, Degree::Two, &p, &m);
        let sum = moments.into_iter().fold(PreciseBall::from(0), |sum, moment| sum + moment);
        // The integral of m less that of [m - P]+.
        let less = PreciseBall::from(2.0 / 3.0 * d * d.sqrt());
        let off = sum - (PreciseBall::from(1) - less);
        assert!(off.lower() <= 0.0 && off.upper() >= 0.0 && sum.radius() <= 1e-15, "{sum:?}");
        // The control: its centre is not the integral, to the digits that it has.
        assert!(off.head().abs() > 1e-27, "{off:?}");
    }

    #[test]
    fn what_is_missed_between_two_roots_counts_with_its_radius() {
        // P = (1 + d) (2 s - 1)^2 - d is below zero on a stretch as long as the root of d, where doubles see no root.
        let (d, r) = (1e-17_f64, 1e12);
        let p = [1.0, 1.0, -d].map(PreciseBall::from);
        let radii = Some([PreciseBall::from(r); 2]);
        let moments = moments(&EdgeRule::Exact, Degree::Two, radii, &p);
        let sum = moments.into_iter().fold(PreciseBall::from(0), |sum, moment| sum + moment);
        let third = PreciseBall::from(1) / PreciseBall::from(3);
        let whole = third - PreciseBall::from(2) * third * PreciseBall::from(d);
        let off = sum - PreciseBall::from(r) * whole;
        // The integral of [-P]+, to its first digits.
        let missed = r * 2.0 / 3.0 * d * d.sqrt();
        assert!(off.lower() <= 0.999 * missed && off.upper() >= 1.001 * missed, "{off:?}");
        // The control: the centre is farther off than the rounding of the rest.
        assert!(off.head().abs() < missed / 2.0 && missed > 1e-15, "{off:?}");
    }

    #[test]
    fn the_largest_of_a_parabola_is_no_value_less_and_hardly_more() {
        for p in values() {
            let parabola = Parabola::new(Degree::Two, &p.map(PreciseBall::from));
            let size = p.iter().fold(1e-200, |m: f64, p| m.max(p.abs()));
            for (sign, a, b) in [(1, 0.0, 1.0), (-1, 0.0, 1.0), (1, 0.25, 0.75), (-1, 0.5, 1.0)] {
                let at = |k: i32| {
                    f64::from(sign)
                        * parabola.at((a + (b - a) * f64::from(k) / 256.0).into()).head()
                };
                let most = (0..=256).map(at).fold(f64::NEG_INFINITY, f64::max);
                let found = parabola.largest(sign, a.into(), b.into());
                assert!(most <= found + 1e-15 * size, "{p:?}: {found} is below {most}");
                assert!(found <= most + 1e-3 * size, "{p:?}: {found} is far above {most}");
            }
        }
    }

    #[test]
    fn control_a_wrong_cut_costs_width() {
        // Positive on the left of 1/2, cut at 0.6: the part between is integrated with the wrong sign, and counted.
        let parabola = Parabola::new(Degree::One, &[0.5, -0.5].map(PreciseBall::from));
        let cut = PreciseBall::from(0.6);
        assert!(parabola.largest(-1, PreciseBall::from(0), cut) >= cut.lower() - 0.5);
        assert!(parabola.largest(1, cut, PreciseBall::from(1)) <= 0.0);
    }
}
