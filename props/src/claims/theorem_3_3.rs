//! Theorem 3.3: problem (8) has one solution. The proof rests on an inequality between positive parts, on (12) and on
//! the Lipschitz continuity of phi; here these at one point, over every ordered field.

use signorini::kernel::edge_integral::ExactEdge;
use signorini::kernel::element::stiffness;
use signorini::kernel::{ContactEdge, Material, P1, Plane, Triangle, positive_part};
use signorini::nalgebra::Vector2;

use crate::harness::{assume, byte, finite};
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, harnesses};

fn class<S: Ordered>(a: S, b: S) -> &'static str {
    match (a > S::from(0), b > S::from(0)) {
        (true, true) => "both positive",
        (false, false) => "none positive",
        _ => "one positive",
    }
}

/// (\[a\]+ - \[b\]+)(a - b) >= (\[a\]+ - \[b\]+)^2 for a candidate of the positive part.
pub fn monotone<S: Ordered>(a: S, b: S, part: impl Fn(S) -> S) -> Verdict {
    let (d, e) = (part(a) - part(b), a - b);
    ensure!(d * e >= d * d);
    ensure!(d * d >= S::from(0));
    Verdict::Holds(class(a, b))
}

/// The inequality of the proof of Theorem 3.3.
pub fn positive_parts_are_monotone<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    monotone(a, b, positive_part)
}

/// |\[a\]+ - \[b\]+| <= |a - b|, as two inequalities on each side.
pub fn positive_part_is_lipschitz<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (d, e) = (positive_part(a) - positive_part(b), a - b);
    if e >= S::from(0) {
        ensure!(d <= e && -d <= e);
    } else {
        ensure!(d <= -e && -d <= -e);
    }
    Verdict::Holds(class(a, b))
}

/// The structure of both: \[a\]+ - \[b\]+ has the sign of a - b and is no larger. In doubles too, for rounding is monotone.
pub fn difference_of_positive_parts_lies_between_zero_and_the_difference<S: Ordered>(
    [a, b]: [S; 2],
) -> Verdict {
    let (d, e) = (positive_part(a) - positive_part(b), a - b);
    ensure!((d >= S::from(0) && d <= e) || (d <= S::from(0) && d >= e));
    Verdict::Holds(class(a, b))
}

/// The integrand behind the hemicontinuity of B^h: with P(v - t w) = p - t q,
/// |\[p - t q\]+ - \[p - s q\]+| |q| <= |s - t| q^2.
pub fn phi_is_lipschitz_at_a_point<S: Ordered>([p, q, s, t]: [S; 4]) -> Verdict {
    let (a, b) = (p - t * q, p - s * q);
    let step = (positive_part(a) - positive_part(b)) * q;
    let bound = (s - t) * q * q;
    if s >= t {
        ensure!(step <= bound && -step <= bound);
    } else {
        ensure!(step <= -bound && -step <= -bound);
    }
    Verdict::Holds(class(a, b))
}

/// \[.\]+^2 / 2, the density of J_h, lies above its tangents and below the parabola that touches it.
pub fn square_of_the_positive_part_is_convex_and_smooth<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (p, q, e) = (positive_part(a), positive_part(b), b - a);
    let tangent = p * p + S::from(2) * p * e;
    ensure!(q * q >= tangent);
    ensure!(q * q <= tangent + e * e);
    Verdict::Holds(class(a, b))
}

/// Method (8) on the triangle (0, 0), (3, 0), (0, 4) with contact at y = 0, all but (3, 0) clamped, lambda = mu = 1,
/// h_T = 5: the left side at u = (s, t) there, for both test functions.
pub fn one_triangle<S: Ordered>([s, t]: [S; 2], gamma0: S) -> [S; 2] {
    let (zero, one) = (S::from(0), S::from(1));
    let of = |x, y| Vector2::new(S::from(x), S::from(y));
    let triangle = Triangle { vertices: [of(0, 0), of(3, 0), of(0, 4)] };
    let material = Material::lame(one, one, Plane::Strain);
    let gamma = gamma0 * S::from(5);
    let n = Vector2::new(zero, -one);
    let edge = ContactEdge::<S, 3, 2>::new::<P1>(&triangle, 2, n, &material, gamma);
    let stiffness = stiffness::<P1, S, 3, 2>(&triangle, &material)[1][1];
    let weight = gamma * S::from(3);
    let stress = edge.stress_product(weight, 1, 1);
    let p = edge.p0.map(|row| row[1][0] * s + row[1][1] * t);
    let gradient = P1::exact(p).gradient;
    [0, 1].map(|c| {
        let a = stiffness[(c, 0)] * s + stiffness[(c, 1)] * t;
        let nitsche = stress[(c, 0)] * s + stress[(c, 1)] * t;
        let contact = gradient[0] * edge.p0[0][1][c] + gradient[1] * edge.p0[1][1][c];
        a - nitsche + contact * S::from(3) / gamma
    })
}

/// Beyond the limit, gamma0 = 8/5, the body force (1/2, 0), whose load is (1, 0), has no solution at all.
pub fn beyond_the_limit_there_may_be_no_solution<S: Ordered>(v: [S; 2]) -> Verdict {
    let residual = one_triangle(v, S::from(8) / S::from(5));
    ensure!(!(residual[0] == S::from(1) && residual[1] == S::from(0)));
    Verdict::Holds("no solution here")
}

/// |.| for \[.\]+.
pub fn control_absolute_value_is_monotone<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    monotone(a, b, |a| a.split(|a| -a, |a| a))
}

/// Twice \[.\]+: monotone, but not with the square on the right.
pub fn control_twice_the_positive_part<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    monotone(a, b, |a| S::from(2) * positive_part(a))
}

/// The inequality the other way round.
pub fn control_monotonicity_turned<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (d, e) = (positive_part(a) - positive_part(b), a - b);
    ensure!(d * e <= d * d);
    Verdict::Holds(class(a, b))
}

/// Half of the constant in the upper parabola.
pub fn control_half_the_curvature<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (p, q, e) = (positive_part(a), positive_part(b), b - a);
    ensure!(q * q <= p * p + S::from(2) * p * e + e * e / S::from(2));
    Verdict::Holds(class(a, b))
}

harnesses! {
    /// a <= b implies \[a\]+ <= \[b\]+.
    holds positive_part_is_monotone_for_all_finite_doubles() {
        let (a, b) = (finite(), finite());
        assume(a <= b);
        assert!(positive_part(a) <= positive_part(b));
    }
    /// The false twin: strictly.
    fails control_positive_part_is_strictly_monotone_for_all_finite_doubles([-1.0, 0.0]) {
        let (a, b) = (finite(), finite());
        assume(a < b);
        assert!(positive_part(a) < positive_part(b));
    }
    /// The inequality as written, where its products are exact.
    holds inequality_of_theorem_3_3_for_all_i8() {
        assert!(!positive_parts_are_monotone([byte(), byte()]).fails());
    }
    /// The false twin: turned.
    fails control_inequality_of_theorem_3_3_turned_for_all_i8([1.0, -1.0]) {
        assert!(!control_monotonicity_turned([byte(), byte()]).fails());
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::bodies::{Definition, Draw, Rule, bodies, combined, contact_class};
    use crate::claim::{Claim, Outcome, model_checked};
    use crate::claims::one_solution;
    use crate::draws;
    use crate::numbers::Exact;

    /// (12) with its constant, and the Lipschitz constant of phi, on a body with kappa < 1.
    fn monotone_on_bodies<const N: usize>(
        draw: &Draw,
        (n, d): (i64, i64),
        rule: Rule<'_>,
    ) -> Verdict {
        let mut body = draw.body();
        let kappa = Exact::ratio(n, n + d);
        body.gamma0 = kappa / Definition::<N>(&body).coercivity();
        let definition = Definition::<N>(&body);
        let (v, w) = (body.drawn(0), body.drawn(1));
        let one = Exact::from(1);
        let difference = combined(one, &v, -one, &w);
        let left = definition.b(rule, &v, &difference) - definition.b(rule, &w, &difference);
        ensure!(left >= definition.big_a(&difference, &difference));
        ensure!(left >= (one - kappa) * definition.a(&difference, &difference));
        // phi(t) = (B(v - t w), w), at t = 1/3 and s = 4/5.
        let phi = |t: Exact| definition.b(rule, &combined(one, &v, -t, &w), &w);
        let (s, t) = (Exact::ratio(4, 5), Exact::ratio(1, 3));
        let squares = definition.squares(rule, &w);
        let bound = (s - t).abs() * (definition.big_a(&w, &w) + squares);
        ensure!((phi(t) - phi(s)).abs() <= bound);
        Verdict::Holds(contact_class::<N>(&body, &v))
    }

    fn monotone_p1() -> Outcome {
        let classes = ["an edge is cut", "open", "pressed"];
        draws::hold(15, (bodies(2), draws::positive()), &classes, |(draw, kappa)| {
            monotone_on_bodies::<3>(draw, *kappa, Rule::Exact)
        })
    }

    fn monotone_p2() -> Outcome {
        draws::hold(5, (bodies(2), draws::positive()), &["an edge is cut"], |(draw, kappa)| {
            let points = [[(1, 4), (1, 2)], [(3, 4), (1, 2)]].map(|p| p.map(Exact::from));
            monotone_on_bodies::<6>(draw, *kappa, Rule::Points(&points))
        })
    }

    /// The row of Theorem 3.3.
    pub fn claim() -> Claim {
        Claim {
            id: "10",
            title: "One solution",
            paper: "",
            limits: "Meshes of more than 10 free nodes; data before the solver rounds them (gamma, the loads, lambda* of plane stress); P2 without quadrature error; solved bodies that are not isotropic.",
            checks: [
                statements! {
                    proved + tested positive_parts_are_monotone[a, b]
                        : "both positive", "none positive", "one positive" about "Theorem 3.3", "(12)";
                    proved + tested + in_doubles positive_part_is_lipschitz[a, b]
                        : "both positive", "none positive", "one positive" about "Theorem 3.3";
                    proved + tested + in_doubles difference_of_positive_parts_lies_between_zero_and_the_difference[a, b]
                        : "both positive", "none positive", "one positive";
                    proved + tested phi_is_lipschitz_at_a_point[p, q, s, t]
                        : "both positive", "none positive", "one positive" about "Theorem 3.3";
                    proved + tested square_of_the_positive_part_is_convex_and_smooth[a, b]
                        : "both positive", "none positive", "one positive" about "Theorem 3.3";
                    proved + tested beyond_the_limit_there_may_be_no_solution[s, t]: "no solution here";
                    refuted control_absolute_value_is_monotone[a, b] fails "d * e >= d * d";
                    refuted control_twice_the_positive_part[a, b] fails "d * e >= d * d";
                    refuted control_monotonicity_turned[a, b] fails "d * e <= d * d";
                    refuted control_half_the_curvature[a, b]
                        fails "q * q <= p * p + S::from(2) * p * e + e * e / S::from(2)";
                },
                vec![
                    exact!("12_and_the_bound_of_phi_hold_on_random_bodies_for_p1", in monotone_on_bodies, draws 15 => monotone_p1()).about(&["Theorem 3.3", "(12)"]),
                    exact!("12_and_the_bound_of_phi_hold_on_random_bodies_for_p2", in monotone_on_bodies, draws 5 => monotone_p2()).about(&["Theorem 3.3", "(12)"]),
                ],
                one_solution::checks().to_vec(),
                model_checked(HARNESSES, &["Theorem 3.3", "(12)"]),
            ]
            .concat(),
        }
    }
}
