//! Method (8) and the functional J_h whose gradient it is: residual, energy and second derivative on random bodies, and
//! the integrals over a cut edge that they rest on.

use signorini::kernel::contact_edge::integral_of_product;
use signorini::kernel::edge_integral::{ExactEdge, positive_interval, value_at};
use signorini::kernel::{P1, positive_part};

use crate::harness::{any, assume, bit};
use crate::numbers::Whole;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given, harnesses};

fn class<S: Ordered>(p: [S; 2]) -> &'static str {
    match p.map(|p| p > S::from(0)) {
        [true, true] => "pressed",
        [false, false] => "open",
        _ => "cut",
    }
}

/// The interval on which P is positive: ends at 0, 1 or the root, and its length is `active`.
pub fn positive_interval_is_where_p_is_positive<S: Ordered>([p0, p1, s]: [S; 3]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(s >= zero && s <= one);
    let [start, end] = positive_interval([p0, p1]);
    ensure!(zero <= start && start <= end && end <= one);
    let value: S = value_at::<P1, S, 3, 2>([p0, p1], s);
    ensure!(value == p0 + s * (p1 - p0));
    if s > start && s < end {
        ensure!(value > zero);
    } else if s < start || s > end {
        ensure!(value <= zero);
    }
    ensure!(P1::exact([p0, p1]).active == end - start);
    Verdict::Holds(class([p0, p1]))
}

/// Edge integrals by their definition: the polynomial is integrated over the piece where P is positive.
pub fn cut_edge_integrals_are_their_definitions<S: Ordered>(p: [S; 2]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    let [a, b] = match p.map(|p| p > zero) {
        [false, false] => [zero, zero],
        [true, true] => [zero, one],
        [true, false] => [zero, p[0] / (p[0] - p[1])],
        [false, true] => [p[0] / (p[0] - p[1]), one],
    };
    let e = P1::exact(p);
    // int_a^b of (1 - s)^i s^j by powers of s
    let m = |k: i32, x: S| (0..k).fold(one, |power, _| power * x) / S::from(k);
    let [m0, m1, m2] = [1, 2, 3].map(|k| m(k, b) - m(k, a));
    let mass = [[m0 - S::from(2) * m1 + m2, m1 - m2], [m1 - m2, m2]];
    for i in 0..2 {
        for j in 0..2 {
            ensure!(e.hessian[i][j] == mass[i][j]);
        }
        ensure!(e.gradient[i] == mass[i][0] * p[0] + mass[i][1] * p[1]);
    }
    ensure!(S::from(2) * e.energy == e.gradient[0] * p[0] + e.gradient[1] * p[1]);
    ensure!(e.active == m0);
    Verdict::Holds(class(p))
}

/// int \[P\]+ q >= 0 for q >= 0.
pub fn cut_edge_integral_keeps_signs<S: Ordered>([p0, p1, q0, q1]: [S; 4]) -> Verdict {
    given!(q0 >= S::from(0) && q1 >= S::from(0));
    let (zero, one) = (S::from(0), S::from(1));
    let [start, end] = positive_interval([p0, p1]);
    ensure!(zero <= start && start <= end && end <= one);
    let [g0, g1] = P1::exact([p0, p1]).gradient;
    ensure!(g0 >= zero && g1 >= zero);
    ensure!(g0 * q0 + g1 * q1 >= zero);
    Verdict::Holds(class([p0, p1]))
}

/// q of any sign.
pub fn control_cut_edge_integral_keeps_any_sign<S: Ordered>([p0, p1, q0, q1]: [S; 4]) -> Verdict {
    given!(q0 >= S::from(0));
    let [g0, g1] = P1::exact([p0, p1]).gradient;
    ensure!(g0 * q0 + g1 * q1 >= S::from(0));
    Verdict::Holds(class([p0, p1]))
}

/// \[.\]+ at the ends, interpolated: an edge that is not cut.
pub fn control_edge_not_cut<S: Ordered>(p: [S; 2]) -> Verdict {
    let q = p.map(positive_part);
    let [g0, g1] = P1::exact(p).gradient;
    ensure!(S::from(2) * (g0 + g1) == q[0] + q[1]);
    Verdict::Holds(class(p))
}

harnesses! {
    /// Six times the integral of a product of two affine functions, by the mass matrix. It has degree 1 in each value, so
    /// the grid decides for all.
    holds integral_of_a_product_is_the_mass_matrix_on_the_unit_grid() {
        let (six, two) = (Whole(6), Whole(2));
        let [a, b, c, d] = [bit(), bit(), bit(), bit()].map(Whole);
        let integral = integral_of_product([six * a, six * b], [c, d]);
        assert!(integral == two * a * c + a * d + b * c + two * b * d);
    }
    /// The false twin: lumped.
    fails control_integral_of_a_product_is_lumped_on_the_unit_grid([1.0, 0.0, 0.0, 1.0]) {
        let (six, three) = (Whole(6), Whole(3));
        let [a, b, c, d] = [bit(), bit(), bit(), bit()].map(Whole);
        assert!(integral_of_product([six * a, six * b], [c, d]) == three * a * c + three * b * d);
    }
    /// Where P has no root inside, its positive interval is all of the edge or nothing, without a division.
    holds positive_interval_is_everything_or_nothing_without_a_root_for_all_i16() {
        let (a, b): (i16, i16) = (any(), any());
        assume((a > 0 && b > 0) || (a <= 0 && b <= 0));
        let [start, end] = positive_interval([i32::from(a), i32::from(b)].map(Whole));
        assert!(start == Whole(0) && end == Whole(i32::from(a > 0)));
    }
    /// The false twin: a touch counts as pressed.
    fails control_positive_interval_of_a_touching_edge_is_everything_for_all_i16([0.0, 0.0]) {
        let (a, b): (i16, i16) = (any(), any());
        assume((a > 0 && b > 0) || (a <= 0 && b <= 0));
        let [_, end] = positive_interval([i32::from(a), i32::from(b)].map(Whole));
        assert!(end == Whole(i32::from(a >= 0)));
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::bodies::{Body, Definition, Rule, bodies, combined, contact_class};
    use crate::claim::{Claim, Outcome, model_checked};
    use crate::claims::assembled;
    use crate::draws;
    use crate::numbers::Exact;

    /// A rule with positive weights; it need not be a good one, for both sides use it.
    fn points() -> [[Exact; 2]; 3] {
        [[(1, 8), (1, 4)], [(1, 2), (5, 12)], [(5, 6), (1, 3)]].map(|point| point.map(Exact::from))
    }

    /// The residual is the gradient of J_h: J_h lies above its tangent by 1/2 A(d, d) at least and 1/2 A(d, d) + 1/2 int P0(d)^2/gamma
    /// at most. `theta` is that of P0(v) in the residual.
    fn gradient<const N: usize>(body: &Body, rule: Rule<'_>, theta: Exact) -> Verdict {
        let (u, d) = (body.drawn(0), body.drawn(1));
        let (definition, half) = (Definition::<N>(body), Exact::ratio(1, 2));
        let energy = |u: &[[Exact; 2]]| {
            let positive = definition.contact(rule, u, |side| definition.traces(side, u).p);
            half * (definition.big_a(u, u) + positive)
        };
        let along = definition.contact(rule, &u, |side| {
            let traces = definition.traces(side, &d);
            traces.v_n.minus(&traces.sigma_n.times(theta * body.gamma(side)))
        });
        let one = Exact::from(1);
        let moved = combined(one, &u, one, &d);
        let above = energy(&moved) - energy(&u) - definition.big_a(&u, &d) - along;
        let (least, squares) = (half * definition.big_a(&d, &d), definition.squares(rule, &d));
        ensure!(above >= least && above <= least + half * squares);
        Verdict::Holds(contact_class::<N>(body, &u))
    }

    fn gradients() -> Outcome {
        let classes = ["an edge is cut", "open", "pressed"];
        let p1 = draws::hold(60, bodies(2), &classes, |draw| {
            gradient::<3>(&draw.body(), Rule::Exact, Exact::from(1))
        })?;
        let p2 = draws::hold(15, bodies(2), &classes[..1], |draw| {
            gradient::<6>(&draw.body(), Rule::Points(&points()), Exact::from(1))
        })?;
        Ok(format!("P1: {p1}; P2 by points: {p2}"))
    }

    /// theta = -1 and theta = 0 in the test function, which are other methods: no gradients.
    fn other_theta() -> Outcome {
        for theta in [-1, 0] {
            draws::reject(bodies(2), |draw| {
                gradient::<3>(&draw.body(), Rule::Exact, Exact::from(theta))
            })?;
        }
        Ok("theta = -1 and theta = 0 are rejected".to_owned())
    }

    /// The row of (8).
    pub fn claim() -> Claim {
        Claim {
            id: "6",
            title: "The method, and the functional whose gradient it is",
            paper: "",
            limits: "",
            checks: [
                statements! {
                    proved + tested positive_interval_is_where_p_is_positive[p0, p1, s]: "pressed", "open", "cut";
                    proved + tested cut_edge_integrals_are_their_definitions[p0, p1]: "pressed", "open", "cut"
                        about "(8)";
                    proved + tested cut_edge_integral_keeps_signs[p0, p1, q0, q1]: "pressed", "open", "cut";
                    refuted control_cut_edge_integral_keeps_any_sign[p0, p1, q0, q1]
                        fails "g0 * q0 + g1 * q1 >= S::from(0)";
                    refuted control_edge_not_cut[p0, p1] fails "S::from(2) * (g0 + g1) == q[0] + q[1]";
                },
                vec![
                    exact!("the_left_side_is_the_gradient_of_j_h_on_random_bodies", in gradient, draws 75 => gradients()).about(&["(8)"]),
                    doubles!("the_loads_of_the_solver_are_near_their_definition", in compare::loads, draws 28 => assembled::loads_of_the_solver()).about(&["L"]),
                    exact!("control_theta_other_than_1", in other_theta => other_theta()),
                    doubles!("control_loads_of_the_solver_taken_wrong", in assembled::load_taken_wrong => assembled::load_taken_wrong()),
                ],
                model_checked(HARNESSES, &["(8)"]),
            ]
            .concat(),
        }
    }
}
