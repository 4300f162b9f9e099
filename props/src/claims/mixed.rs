//! Section 2.3: lambda^h = -(1/gamma) \[P(u^h)\]+ is a projection, (9) and (10), and method (8) as a mixed method.
//!
//! The set of the multipliers stands as L^2(Gamma_C) in the text that was read; it is the cone of the nonpositive functions in it.

use signorini::kernel::ContactPoint;

use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

fn point<S>([u_n, gap, sigma_n, gamma]: [S; 4]) -> ContactPoint<S> {
    ContactPoint { u_n, gap, sigma_n, gamma }
}

pub(super) fn class<S: Ordered>(point: &ContactPoint<S>) -> &'static str {
    if point.p() > S::from(0) { "pressed" } else { "open" }
}

/// The integrand of (9): (mu - l)(-P/gamma - l).
fn nine<S: Ordered>(point: &ContactPoint<S>, mu: S, l: S) -> S {
    let p = point.u_n - point.gap - point.gamma * point.sigma_n;
    (mu - l) * (-(p / point.gamma) - l)
}

/// The integrand of (10): (mu - l)(u_n - g) + gamma (mu - l)(l - sigma_n).
fn ten<S: Ordered>(point: &ContactPoint<S>, mu: S, l: S) -> S {
    (mu - l) * (point.u_n - point.gap) + point.gamma * (mu - l) * (l - point.sigma_n)
}

/// (9) and (10) at a point for lambda^h, for every mu <= 0, and with equality for mu = 0 and mu = 2 lambda^h.
fn projection<S: Ordered>(
    [u, g, s, gamma, mu]: [S; 5],
    lambda: impl Fn(&ContactPoint<S>) -> S,
) -> Verdict {
    let zero = S::from(0);
    let point = point([u, g, s, gamma]);
    given!(gamma > zero && mu <= zero);
    let l = lambda(&point);
    ensure!(l <= zero);
    ensure!(nine(&point, mu, l) <= zero);
    ensure!(ten(&point, mu, l) >= zero);
    ensure!(nine(&point, zero, l) == zero && nine(&point, l + l, l) == zero);
    Verdict::Holds(class(&point))
}

/// (9) and (10) hold for the kernel's lambda^h.
pub fn contact_pressure_is_the_projection<S: Ordered>(v: [S; 5]) -> Verdict {
    projection(v, ContactPoint::pressure)
}

/// (9) and (10) are the same condition for any multiplier l: (10) is -gamma times (9).
pub fn conditions_9_and_10_are_equivalent<S: Ordered>([u, g, s, gamma, mu, l]: [S; 6]) -> Verdict {
    let zero = S::from(0);
    let point = point([u, g, s, gamma]);
    given!(gamma > zero);
    let (nine, ten) = (nine(&point, mu, l), ten(&point, mu, l));
    ensure!(ten == -(gamma * nine));
    let (nine_holds, ten_holds) = (nine <= zero, ten >= zero);
    ensure!(nine_holds == ten_holds);
    Verdict::Holds(if nine_holds { "both hold" } else { "neither holds" })
}

/// The converse: l <= 0 that satisfies (9) for mu = 0, 2 l and l - 1 is lambda^h.
pub fn condition_9_leaves_only_the_contact_pressure<S: Ordered>(
    [u, g, s, gamma, l]: [S; 5],
) -> Verdict {
    let zero = S::from(0);
    let point = point([u, g, s, gamma]);
    given!(gamma > zero && l <= zero);
    given!(nine(&point, zero, l) <= zero && nine(&point, l + l, l) <= zero);
    given!(nine(&point, l - S::from(1), l) <= zero);
    ensure!(l == point.pressure());
    Verdict::Holds(class(&point))
}

/// The rewriting of (8): integrand of A_gamma's stress term and of the contact term together.
pub fn method_is_its_mixed_form_at_a_point<S: Ordered>([u, g, s, gamma, v, t]: [S; 6]) -> Verdict {
    given!(gamma > S::from(0));
    let here = point([u, g, s, gamma]);
    let l = here.pressure();
    let test = ContactPoint { u_n: v, sigma_n: t, ..here };
    let method = -(gamma * s * t) - l * test.p0();
    ensure!(method == gamma * (l - s) * t - l * v);
    Verdict::Holds(class(&here))
}

/// sigma_n in place of lambda^h: not the projection, for sigma_n(u^h) is not lambda^h.
pub fn control_normal_stress_for_the_multiplier<S: Ordered>(v: [S; 5]) -> Verdict {
    projection(v, |point| point.sigma_n)
}

/// lambda^h without 1/gamma.
pub fn control_multiplier_without_gamma<S: Ordered>(v: [S; 5]) -> Verdict {
    projection(v, |point| point.gamma * point.pressure())
}

/// (9) gives (10) for one fixed mu: the integrands of (10) on two edges, those of (9) with -1/gamma.
pub fn control_9_gives_10_for_one_multiplier_on_two_edges<S: Ordered>(
    [first, second, gamma, other]: [S; 4],
) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero && other > zero);
    given!(-first / gamma - second / other <= zero);
    ensure!(first + second >= zero);
    Verdict::Holds("always")
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::bodies::{Body, Definition, Rule, Side, bodies, contact_class, sum};
    use crate::claim::{Claim, Outcome, noticed};
    use crate::claims::theorem_3_3::one_triangle;
    use crate::draws;
    use crate::naive::Line;
    use crate::numbers::Exact;

    /// An integrand on a side, from its number and lambda^h there.
    type Integrand<'a> = &'a dyn Fn(&Side, usize, &Line<Exact>) -> Line<Exact>;

    /// -P/gamma
    fn scaled(body: &Body, side: &Side, p: &Line<Exact>) -> Line<Exact> {
        p.times(-(Exact::from(1) / body.gamma(side)))
    }

    /// The pieces of a side on which lambda^h is a polynomial, with that polynomial.
    fn multiplier(body: &Body, side: &Side, p: &Line<Exact>) -> Vec<([Exact; 2], Line<Exact>)> {
        let pressed = scaled(body, side, p);
        let none = Line(vec![Exact::from(0)]);
        p.pieces()
            .into_iter()
            .map(|(piece, positive)| (piece, if positive { pressed.clone() } else { none.clone() }))
            .collect()
    }

    /// mu <= 0, affine on a side.
    fn cone(body: &Body, e: usize) -> Line<Exact> {
        let [a, b] = body.drawn(2)[e];
        Line::affine(-a.abs(), -b.abs())
    }

    /// The mixed form of (8) and (9), (10) integrated over Gamma_C, at any u: P1 without quadrature error.
    fn mixed(body: &Body, sign: Exact) -> Verdict {
        let (u, v) = (body.drawn(0), body.drawn(1));
        let definition = Definition::<3>(body);
        let over = |f: Integrand<'_>| {
            sum(body.contact.iter().enumerate(), |(e, side)| {
                let pieces = multiplier(body, side, &definition.traces(side, &u).p);
                sum(pieces, |(piece, l)| side.length * f(side, e, &l).integral(piece))
            })
        };
        let projected = |side: &Side| scaled(body, side, &definition.traces(side, &u).p);
        let contact = over(&|side, _, l| {
            let (here, test) = (definition.traces(side, &u), definition.traces(side, &v));
            let stabilised = l.minus(&here.sigma_n).by(&test.sigma_n).times(body.gamma(side));
            stabilised.plus(&l.by(&test.v_n).times(-sign))
        });
        ensure!(definition.b(Rule::Exact, &u, &v) == definition.a(&u, &v) + contact);
        let nine = over(&|side, e, l| cone(body, e).minus(l).by(&projected(side).minus(l)));
        ensure!(nine <= Exact::from(0));
        let ten = over(&|side, e, l| {
            let here = definition.traces(side, &u);
            let [start, end, _] = side.gap;
            let opening = here.v_n.minus(&Line::affine(start, end));
            let inner = opening.plus(&l.minus(&here.sigma_n).times(body.gamma(side)));
            cone(body, e).minus(l).by(&inner)
        });
        ensure!(ten >= Exact::from(0));
        let equality = over(&|side, _, l| l.by(&projected(side).minus(l)));
        ensure!(equality == Exact::from(0));
        Verdict::Holds(contact_class::<3>(body, &u))
    }

    /// The same equality by points, for P1 and P2: lambda^h at each point.
    fn mixed_by_points<const N: usize>(body: &Body) -> Verdict {
        let (u, v) = (body.drawn(0), body.drawn(1));
        let definition = Definition::<N>(body);
        let rule =
            [[(1, 4), (1, 3)], [(3, 5), (1, 2)], [(1, 1), (1, 6)]].map(|p| p.map(Exact::from));
        let contact = sum(&body.contact, |side| {
            let (here, test) = (definition.traces(side, &u), definition.traces(side, &v));
            let gamma = body.gamma(side);
            side.length
                * sum(&rule, |&[s, w]| {
                    let p = here.p.at(s);
                    let l = if p > Exact::from(0) { -(p / gamma) } else { Exact::from(0) };
                    // The part of A_gamma that cancels is integrated exactly on both sides.
                    w * (gamma * l * test.sigma_n.at(s) - l * test.v_n.at(s))
                })
        });
        ensure!(definition.b(Rule::Points(&rule), &u, &v) == definition.big_a(&u, &v) + contact);
        Verdict::Holds(contact_class::<N>(body, &u))
    }

    fn mixed_p1() -> Outcome {
        let classes = ["an edge is cut", "open", "pressed"];
        draws::hold(60, bodies(3), &classes, |draw| mixed(&draw.body(), Exact::from(1)))
    }

    fn mixed_p2() -> Outcome {
        draws::hold(20, bodies(2), &["an edge is cut"], |draw| mixed_by_points::<6>(&draw.body()))
    }

    fn sign_of_the_multiplier() -> Outcome {
        draws::reject(bodies(3), |draw| mixed(&draw.body(), Exact::from(-1)))
    }

    /// The remark before (9): the triangle of row 10 with gamma0 = 1/15, half of the limit, in full contact. u^h = (-1, t) at the
    /// free vertex is the solution of (8) for the load that (8) has there, which is that of the mixed form with lambda^h; and
    /// lambda^h differs from sigma_n(u^h).
    fn stress_beside_multiplier(t: Exact) -> Outcome {
        let ratio = Exact::ratio;
        let (s, gamma) = (ratio(-1, 1), ratio(1, 3));
        // Hooke: eps_xx = s/3, sigma_n = lambda eps_xx with lambda = 1.
        let sigma_n = s * ratio(1, 3);
        let [fixed, free] =
            [ratio(0, 1), -t].map(|u_n| point([u_n, ratio(0, 1), sigma_n, gamma]).pressure());
        if fixed >= ratio(0, 1) || free >= ratio(0, 1) {
            return Err(format!("open: {fixed:?}, {free:?}"));
        }
        let stabilised = gamma * (ratio(3, 2) * (fixed + free) - ratio(3, 1) * sigma_n);
        let mixed = [
            ratio(2, 1) * s + stabilised * ratio(1, 3),
            ratio(2, 3) * t + ratio(1, 2) * fixed + free,
        ];
        let load = one_triangle([s, t], ratio(1, 15));
        match (load == mixed, free != sigma_n) {
            (true, true) => Ok(format!("sigma_n = {sigma_n:?}, lambda^h = {free:?} at the vertex")),
            (true, false) => Err(format!("both are {sigma_n:?}")),
            (false, _) => Err(format!("(8) has the load {load:?}, its mixed form {mixed:?}")),
        }
    }

    /// The row of section 2.3.
    pub fn claim() -> Claim {
        Claim {
            id: "7",
            title: "The contact pressure as a projection, and the mixed form",
            paper: "",
            limits: "That the solver reports this lambda^h is tested (`props/tests/program/assembled.rs`).",
            checks: [
                statements! {
                    proved + tested contact_pressure_is_the_projection[u_n, g, sigma_n, gamma, mu]: "pressed", "open"
                        about "(9)", "(10)";
                    proved + tested conditions_9_and_10_are_equivalent[u_n, g, sigma_n, gamma, mu, l]
                        : "both hold", "neither holds" about "(10)";
                    proved + tested condition_9_leaves_only_the_contact_pressure[u_n, g, sigma_n, gamma, l]
                        : "pressed", "open" about "(9)";
                    proved + tested method_is_its_mixed_form_at_a_point[u, g, s, gamma, v, t]: "pressed", "open"
                        about "the mixed problem";
                    refuted control_normal_stress_for_the_multiplier[u_n, g, sigma_n, gamma, mu]
                        fails "nine(&point, zero, l) == zero && nine(&point, l + l, l) == zero";
                    refuted control_9_gives_10_for_one_multiplier_on_two_edges[first, second, gamma, other]
                        fails "first + second >= zero";
                    refuted control_multiplier_without_gamma[u_n, g, sigma_n, gamma, mu]
                        fails "nine(&point, zero, l) == zero && nine(&point, l + l, l) == zero";
                },
                vec![
                    exact!("mixed_form_9_and_10_hold_on_random_bodies_for_p1", in mixed, draws 60 => mixed_p1()).about(&["(9)", "(10)", "the mixed problem"]),
                    exact!("sigma_n_of_a_discrete_solution_is_not_its_multiplier", in stress_beside_multiplier => Exact::scope(|| stress_beside_multiplier(Exact::ratio(1, 18)))).about(&["the mixed problem"]),
                    // The vertex on the floor.
                    exact!("control_sigma_n_is_the_multiplier_without_penetration", at stress_beside_multiplier => noticed(Exact::scope(|| stress_beside_multiplier(Exact::from(0))))),
                    exact!("mixed_form_by_points_holds_on_random_bodies_for_p2", in mixed_by_points, draws 20 => mixed_p2()).about(&["the mixed problem"]),
                    exact!("control_sign_of_the_multiplier_turned", in sign_of_the_multiplier => sign_of_the_multiplier()),
                ],
            ]
            .concat(),
        }
    }
}
