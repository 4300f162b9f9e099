//! Forces of the true solution between two numbers (docs/a-posteriori.md, 7.7): the identity behind the mean stress, the signs of what
//! contact adds, where contact can act, and the largest value of what is not known; and the checker that evaluates them.

use signorini::certificates::Continuous;
use signorini::certificates::proof::Role;
use signorini::certificates::quantities::Name;
use signorini::kernel::Ball;
use signorini::model::Degree;

use super::solved::{Draw, bodies};
use props::claim::Outcome;
use props::numbers::Exact;
use props::proof::{prove, refute};
use props::verdict::{Ordered, Verdict};
use props::{draws, ensure, given, statement};

/// |s - (q + t) / 2|^2 = |q - t|^2 / 4 + (s - q) (s - t), a component of the stresses sigma(u), C eps(v) and tau.
pub fn the_mean_of_two_stresses_splits<S: Ordered>([s, q, t]: [S; 3]) -> Verdict {
    let two = S::from(2);
    let (m, half) = ((q + t) / two, (q - t) / two);
    ensure!((s - m) * (s - m) == half * half + (s - q) * (s - t));
    Verdict::Holds("always")
}

/// (sigma_n - tau_n) (u_n - v_n) = G - A - B at a point of Gamma_C, and A and B are not negative.
pub fn contact_adds_two_terms_that_are_not_negative<S: Ordered>(
    [u, v, g, s, t]: [S; 5],
) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && s <= zero && s * (u - g) == zero);
    given!(v <= g && t <= zero);
    let (a, b) = (s * (v - g), t * (u - g));
    ensure!((s - t) * (u - v) == t * (v - g) - a - b);
    ensure!(a >= zero && b >= zero);
    Verdict::Holds(if s < zero { "contact" } else { "no force" })
}

/// Where v is off the obstacle by d, the force is at most A / d.
pub fn little_force_where_there_is_a_gap<S: Ordered>([v, g, s, d]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(d > zero && g - v >= d && s <= zero);
    ensure!(-s * d <= s * (v - g));
    Verdict::Holds("always")
}

/// Where tau presses with p, the opening is at most B / p.
pub fn little_opening_where_there_is_pressure<S: Ordered>([u, g, t, p]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(p > zero && t <= -p && u <= g);
    ensure!((g - u) * p <= t * (u - g));
    Verdict::Holds("always")
}

/// x eta + k (M^2 - x^2) is at most k M^2 + eta^2 / (4 k).
pub fn what_is_missed_is_largest_inside<S: Ordered>([x, eta, k, m]: [S; 4]) -> Verdict {
    let four = S::from(4);
    given!(k > S::from(0));
    let value = x * eta + k * (m * m - x * x);
    ensure!(four * k * value <= four * k * k * m * m + eta * eta);
    Verdict::Holds("always")
}

/// Where eta >= 2 k M it is at most M eta for 0 <= x <= M.
pub fn what_is_missed_is_largest_at_the_end<S: Ordered>([x, eta, k, m]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(k >= zero && zero <= x && x <= m && eta >= S::from(2) * k * m);
    ensure!(x * eta + k * (m * m - x * x) <= m * eta);
    Verdict::Holds("always")
}

/// \[7.8\] with a point's products for the integrals: x for C eps(w) - rho, so for |sigma_n| omega.
pub fn a_dual_pair_gives_the_force<S: Ordered>(
    [l, avw, s, q, t, x, r, u, v, g, so]: [S; 11],
) -> Verdict {
    let two = S::from(2);
    let force = l - (avw + (s - q) * x + r * (u - v)) + so;
    let near = l - avw + r * (v - g) + (q - t) * x / two;
    ensure!(force == near - (s - (q + t) / two) * x + r * (g - u) + so);
    Verdict::Holds("always")
}

/// What contact adds to a dual pair's force from above: r (g - u_n) + |sigma_n| omega <= k (A + B) where r <= k |tau_n| and omega
/// <= k (g - v_n).
pub fn contact_adds_to_the_upper_end_at_most_a_and_b<S: Ordered>(
    [u, v, g, s, t, r, omega, k]: [S; 8],
) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && v <= g && s <= zero && t <= zero);
    given!(r <= -k * t && omega <= k * (g - v));
    let (a, b) = (s * (v - g), t * (u - g));
    ensure!(r * (g - u) - s * omega <= k * (a + b));
    Verdict::Holds("always")
}

/// B dropped: the body may lift off where tau presses.
pub fn control_the_upper_end_without_b<S: Ordered>(
    [u, v, g, s, t, r, omega, k]: [S; 8],
) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && v <= g && s <= zero && t <= zero);
    given!(r <= -k * t && omega <= k * (g - v));
    let a = s * (v - g);
    ensure!(r * (g - u) - s * omega <= k * a);
    Verdict::Holds("always")
}

/// r of the wrong sign.
pub fn control_the_traction_turned<S: Ordered>(
    [l, avw, s, q, t, x, r, u, v, g, so]: [S; 11],
) -> Verdict {
    let two = S::from(2);
    let force = l - (avw + (s - q) * x + r * (u - v)) + so;
    let near = l - avw - r * (v - g) + (q - t) * x / two;
    ensure!(force == near - (s - (q + t) / two) * x + r * (g - u) + so);
    Verdict::Holds("always")
}

/// M with an eighth in place of a quarter: the factor 1/2 lost.
pub fn control_an_eighth_of_the_distance<S: Ordered>([s, q, t]: [S; 3]) -> Verdict {
    let m = (q + t) / S::from(2);
    ensure!((s - m) * (s - m) == (q - t) * (q - t) / S::from(8) + (s - q) * (s - t));
    Verdict::Holds("always")
}

/// tau in place of the mean.
pub fn control_tau_in_place_of_the_mean<S: Ordered>([s, q, t]: [S; 3]) -> Verdict {
    let half = (q - t) / S::from(2);
    ensure!((s - t) * (s - t) == half * half + (s - q) * (s - t));
    Verdict::Holds("always")
}

/// B dropped.
pub fn control_without_the_opening_under_tau<S: Ordered>([u, v, g, s, t]: [S; 5]) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && s <= zero && s * (u - g) == zero);
    given!(v <= g && t <= zero);
    ensure!((s - t) * (u - v) == t * (v - g) - s * (v - g));
    Verdict::Holds("always")
}

/// k M^2 alone.
pub fn control_without_the_square_of_eta<S: Ordered>([x, eta, k, m]: [S; 4]) -> Verdict {
    given!(k > S::from(0));
    let value = x * eta + k * (m * m - x * x);
    ensure!(value <= k * m * m);
    Verdict::Holds("always")
}

/// The numbers of balls are around those of rationals, `outside` of them by that much, and by no more than rounding.
fn around(draw: &Draw, degree: Degree, outside: f64) -> Verdict {
    let Ok((_, _, certified)) = draw.certified_with(degree) else {
        return Verdict::Fails("there is a certificate");
    };
    let (certificate, evidence) = (&certified.certificate, &certified.quantities.evidence);
    let (Ok(exact), Ok(found)) = (
        Exact::scope(|| certificate.forces::<Exact>(evidence)),
        certificate.forces::<Ball>(evidence),
    ) else {
        return Verdict::Fails("both accept");
    };
    ensure!(exact.len() == found.len() && !found.is_empty());
    for pair in exact.into_iter().zip(found) {
        let (Ok([a, b]), Ok([low, high])) = pair else {
            return Verdict::Fails("both enclose");
        };
        ensure!(low <= a - outside && high >= b + outside);
        // Where v is the solution M is 0, and in balls the root of a sum of some hundred rounding errors.
        ensure!(a - low <= 1e-6 && high - b <= 1e-6);
    }
    Verdict::Holds(if degree == Degree::One { "P1" } else { "P2" })
}

fn balls_are_around_the_rationals() -> Outcome {
    let one = draws::hold(12, bodies(1), &["P1"], |draw| around(draw, Degree::One, 0.0))?;
    let two = draws::hold(4, bodies(1), &["P2"], |draw| around(draw, Degree::Two, 0.0))?;
    Ok(format!("{one}; {two}"))
}

fn balls_far_around_the_rationals() -> Outcome {
    draws::reject(bodies(1), |draw| around(draw, Degree::One, 1e-5))
}

fn of(certified: &Continuous, name: Name, boundary: &str) -> Option<[f64; 2]> {
    let is = |q: &&_| {
        let q: &signorini::certificates::quantities::Quantity = q;
        q.name == name && q.boundary == boundary
    };
    certified.quantities.list.iter().find(is)?.interval.clone().ok()
}

/// What floor, top and load do to the body adds up to 0, and a finer mesh does not contradict a coarse one. With `factor`
/// times the load.
fn balanced(draw: &Draw, factor: f64) -> Verdict {
    let (Ok((_, _, coarse)), Ok((_, _, fine))) = (draw.certified_on(1), draw.certified_on(2))
    else {
        return Verdict::Fails("there are certificates");
    };
    let area = draw.cells.map(|n| n as f64).iter().product::<f64>();
    let middle = draw.cells[0] as f64 / 2.0;
    let load = factor * area * (draw.load[1] + draw.slope[1] * middle);
    for certified in [&coarse, &fine] {
        let (Some(floor), Some(top)) = (
            of(certified, Name::ContactComponent(1), "bottom"),
            of(certified, Name::Reaction(1), "top"),
        ) else {
            return Verdict::Fails("forces have intervals");
        };
        ensure!(floor[0] + top[0] + load <= 1e-12 && floor[1] + top[1] + load >= -1e-12);
    }
    for quantity in &coarse.quantities.list {
        let Some(other) = of(&fine, quantity.name, &quantity.boundary) else {
            return Verdict::Fails("both have the same quantities");
        };
        let Ok([low, high]) = quantity.interval else {
            return Verdict::Fails("forces have intervals");
        };
        ensure!(low <= other[1] && other[0] <= high);
    }
    let pressed =
        coarse.certificate.edges.iter().any(
            |edge| matches!(edge.role, Role::Contact { pressure, .. } if pressure != [0.0; 2]),
        );
    Verdict::Holds(if pressed { "contact" } else { "no contact" })
}

fn forces_agree() -> Outcome {
    draws::hold(30, bodies(2), &["contact", "no contact"], |draw| balanced(draw, 1.0))
}

fn forces_of_another_load() -> Outcome {
    draws::reject(bodies(2), |draw| balanced(draw, 4.0))
}

checks! {
    the_mean_of_two_stresses_splits => prove(&statement!(the_mean_of_two_stresses_splits, [s, q, t], ["always"]));
    contact_adds_two_terms_that_are_not_negative => prove(&statement!(contact_adds_two_terms_that_are_not_negative, [u_n, v_n, g, sigma_n, tau_n], ["contact", "no force"]));
    little_force_where_there_is_a_gap => prove(&statement!(little_force_where_there_is_a_gap, [v_n, g, sigma_n, d], ["always"]));
    little_opening_where_there_is_pressure => prove(&statement!(little_opening_where_there_is_pressure, [u_n, g, tau_n, p], ["always"]));
    what_is_missed_is_largest_inside => prove(&statement!(what_is_missed_is_largest_inside, [x, eta, k, m], ["always"]));
    what_is_missed_is_largest_at_the_end => prove(&statement!(what_is_missed_is_largest_at_the_end, [x, eta, k, m], ["always"]));
    a_dual_pair_gives_the_force => prove(&statement!(a_dual_pair_gives_the_force, [l, a_v_w, s, q, t, x, r, u_n, v_n, g, s_o], ["always"]));
    contact_adds_to_the_upper_end_at_most_a_and_b => prove(&statement!(contact_adds_to_the_upper_end_at_most_a_and_b, [u_n, v_n, g, sigma_n, tau_n, r, omega, k], ["always"]));
    control_the_traction_turned => refute(&statement!(control_the_traction_turned, [l, a_v_w, s, q, t, x, r, u_n, v_n, g, s_o], fails "force == near - (s - (q + t) / two) * x + r * (g - u) + so"));
    control_an_eighth_of_the_distance => refute(&statement!(control_an_eighth_of_the_distance, [s, q, t], fails "(s - m) * (s - m) == (q - t) * (q - t) / S::from(8) + (s - q) * (s - t)"));
    control_tau_in_place_of_the_mean => refute(&statement!(control_tau_in_place_of_the_mean, [s, q, t], fails "(s - t) * (s - t) == half * half + (s - q) * (s - t)"));
    control_without_the_opening_under_tau => refute(&statement!(control_without_the_opening_under_tau, [u_n, v_n, g, sigma_n, tau_n], fails "(s - t) * (u - v) == t * (v - g) - s * (v - g)"));
    control_the_upper_end_without_b => refute(&statement!(control_the_upper_end_without_b, [u_n, v_n, g, sigma_n, tau_n, r, omega, k], fails "r * (g - u) - s * omega <= k * a"));
    control_without_the_square_of_eta => refute(&statement!(control_without_the_square_of_eta, [x, eta, k, m], fails "value <= k * m * m"));
    forces_in_balls_are_around_those_in_rationals => balls_are_around_the_rationals();
    control_forces_far_outside => balls_far_around_the_rationals();
    forces_balance_and_meet_those_of_a_finer_mesh => forces_agree();
    control_forces_beside_four_times_the_load => forces_of_another_load();
}
