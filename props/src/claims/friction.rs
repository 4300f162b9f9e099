//! Friction, which the paper does not have: Tresca's law as one equation, the clip that it is made of, and the inequalities on which
//! existence, uniqueness and error bounds with friction rest. v is the slip, sigma the shear stress, s the slip bound, mu Coulomb's
//! coefficient; the laws and their gap are written out here, clip is the kernel's.

use signorini::kernel::friction::clip;
use signorini::kernel::positive_part;

use crate::harness::{any, assume, byte, finite};
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given, harnesses};

/// |a|
pub fn abs<S: Ordered>(a: S) -> S {
    if a < S::from(0) { -a } else { a }
}

/// Tresca's law: |sigma| <= s, and where there is slip sigma is as large as that and against the slip.
fn tresca<S: Ordered>(v: S, sigma: S, s: S) -> bool {
    let zero = S::from(0);
    abs(sigma) <= s && if v > zero { sigma == -s } else { v == zero || sigma == s }
}

/// Fenchel's gap s |v| + tau v of a slip v and a traction tau: zero exactly where Tresca's law holds, if |tau| <= s; else it may be
/// negative.
fn fenchel_gap<S: Ordered>(v: S, tau: S, s: S) -> S {
    v.split(|v| (s - tau) * -v, |v| (s + tau) * v)
}

/// A shear stress that satisfies Tresca's law at the slip v; each one for some w.
fn shear<S: Ordered>(v: S, w: S, s: S) -> S {
    let zero = S::from(0);
    if v > zero {
        -s
    } else if v < zero {
        s
    } else {
        within(w, s)
    }
}

/// A number of \[-s, s\]; each one for some w.
fn within<S: Ordered>(w: S, s: S) -> S {
    if w > s {
        s
    } else if w < -s {
        -s
    } else {
        w
    }
}

fn class<S: Ordered>(v: S) -> &'static str {
    if v == S::from(0) { "sticks" } else { "slides" }
}

/// Tresca's law if and only if gamma sigma = -clip(v - gamma sigma; bound).
fn equation<S: Ordered>([v, sigma, s, gamma]: [S; 4], bound: S) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero && s >= zero);
    let law = tresca(v, sigma, s);
    let equation = gamma * sigma == -clip(v - gamma * sigma, bound);
    ensure!(law == equation);
    Verdict::Holds(if law { class(v) } else { "neither holds" })
}

/// Proposition 2.1 for Tresca's law, for every gamma > 0.
pub fn tresca_is_one_equation<S: Ordered>(x: [S; 4]) -> Verdict {
    equation(x, x[3] * x[2])
}

/// The bound without gamma.
pub fn control_clip_without_gamma<S: Ordered>(x: [S; 4]) -> Verdict {
    equation(x, x[2])
}

/// Friction along the slip, in place of against it.
pub fn control_friction_along_the_slip<S: Ordered>([v, sigma, s, gamma]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero && s >= zero);
    let (law, p) = (tresca(v, sigma, s), v + gamma * sigma);
    ensure!(law == (gamma * sigma == clip(p, gamma * s)));
    Verdict::Holds("always")
}

/// Coulomb's law with contact, for the bound mu q of friction: n is the normal displacement beyond the gap, p the normal stress.
fn coulomb<S: Ordered>([n, p, v, sigma, mu, gamma]: [S; 6], bound_of: impl Fn(S) -> S) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero && mu >= zero);
    // (2), and Tresca's law with the slip bound mu |p|.
    let law = n <= zero && p <= zero && n * p == zero && tresca(v, sigma, -(mu * p));
    let normal = n - gamma * p;
    let equations = gamma * p == -positive_part(normal)
        && gamma * sigma == -clip(v - gamma * sigma, mu * bound_of(normal));
    ensure!(law == equations);
    Verdict::Holds(match (law, p < zero) {
        (false, _) => "neither holds",
        (true, false) => "open",
        (true, true) => class(v),
    })
}

/// Coulomb's law is two equations, with the bound mu \[P_n\]+ of the same point.
pub fn coulomb_is_two_equations<S: Ordered>(x: [S; 6]) -> Verdict {
    coulomb(x, positive_part)
}

/// The bound mu |P_n|: friction across an open gap.
pub fn control_friction_of_a_pressure_that_pulls<S: Ordered>(x: [S; 6]) -> Verdict {
    coulomb(x, abs)
}

/// The clip is the point of \[-m, m\] nearest to x: by the variational inequality.
pub fn clip_is_the_projection_on_the_bounds<S: Ordered>([x, w, m]: [S; 3]) -> Verdict {
    let zero = S::from(0);
    given!(m >= zero);
    let (q, other) = (clip(x, m), within(w, m));
    ensure!(-m <= q && q <= m);
    ensure!((other - q) * (x - q) <= zero);
    ensure!(clip(-x, m) == -q);
    Verdict::Holds(if q == x { "within" } else { "beyond" })
}

/// (q_a - q_b)^2 <= (q_a - q_b) (a - b): all that the theory of the method uses of \[.\]+.
pub fn clip_is_firmly_nonexpansive<S: Ordered>([a, b, m]: [S; 3]) -> Verdict {
    given!(m >= S::from(0));
    let d = clip(a, m) - clip(b, m);
    ensure!(d * d <= d * (a - b));
    Verdict::Holds(if d == S::from(0) { "the same" } else { "differ" })
}

/// Twice the clip.
pub fn control_twice_the_clip_is_firmly_nonexpansive<S: Ordered>([a, b, m]: [S; 3]) -> Verdict {
    given!(m >= S::from(0));
    let d = S::from(2) * (clip(a, m) - clip(b, m));
    ensure!(d * d <= d * (a - b));
    Verdict::Holds("always")
}

/// |clip(x; m) - clip(x; n)| <= |m - n|
pub fn clip_is_lipschitz_in_its_bound<S: Ordered>([x, m, n]: [S; 3]) -> Verdict {
    given!(m >= S::from(0) && n >= S::from(0));
    let d = clip(x, m) - clip(x, n);
    ensure!(abs(d) <= abs(m - n));
    Verdict::Holds(if d == S::from(0) { "the same" } else { "differ" })
}

/// s |v| + tau v >= 0, and 0 exactly where v and tau satisfy Tresca's law.
pub fn gap_of_friction_is_zero_exactly_where_tresca_holds<S: Ordered>(
    [v, tau, s]: [S; 3],
) -> Verdict {
    let zero = S::from(0);
    given!(abs(tau) <= s);
    let gap = fenchel_gap(v, tau, s);
    ensure!(gap == s * abs(v) + tau * v);
    ensure!(gap >= zero);
    ensure!((gap == zero) == tresca(v, tau, s));
    Verdict::Holds(if gap > zero { "neither holds" } else { class(v) })
}

/// The gap for a traction of any size.
pub fn control_gap_of_friction_for_any_traction<S: Ordered>([v, tau, s]: [S; 3]) -> Verdict {
    given!(s >= S::from(0));
    ensure!(fenchel_gap(v, tau, s) >= S::from(0));
    Verdict::Holds("always")
}

/// What contact gains in monotonicity pays for friction whose bound it moves: d^2 - mu |d| |p| >= -mu^2 p^2 / 4.
pub fn pressure_pays_for_friction<S: Ordered>([d, p, mu]: [S; 3]) -> Verdict {
    given!(mu >= S::from(0));
    let moved = mu * abs(d) * abs(p);
    ensure!(S::from(4) * (d * d - moved) >= -(mu * mu * p * p));
    Verdict::Holds("always")
}

/// Twice as cheaply.
pub fn control_pressure_pays_for_friction_twice<S: Ordered>([d, p, mu]: [S; 3]) -> Verdict {
    given!(mu >= S::from(0));
    let moved = mu * abs(d) * abs(p);
    ensure!(S::from(8) * (d * d - moved) >= -(mu * mu * p * p));
    Verdict::Holds("always")
}

/// Existence for every coefficient: with P_n, P_t of some u and c_n, c_t of another one, twice the work of contact and friction on the
/// difference is at least -(c_n^2 + mu^2 c_t^2).
pub fn friction_does_not_drive<S: Ordered>([p, x, c, b, mu]: [S; 5]) -> Verdict {
    let two = S::from(2);
    given!(mu >= S::from(0));
    let q = positive_part(p);
    ensure!(two * q * (p - c) >= q * q - c * c);
    let m = mu * q;
    let work = clip(x, m) * (x - b);
    ensure!(work >= -(m * abs(b)));
    ensure!(-(two * m * abs(b)) >= -(q * q) - mu * mu * b * b);
    Verdict::Holds(if q == S::from(0) { "open" } else { "pressed" })
}

/// The identity of the error bound at a point: gap of (v, tau) - gap of (v, sigma) - gap of (u, tau) = (sigma - tau) (u - v), where u and
/// sigma satisfy Tresca's law.
pub fn gaps_of_friction_are_the_work_of_the_errors<S: Ordered>([u, v, w, t, s]: [S; 5]) -> Verdict {
    given!(s >= S::from(0));
    let (sigma, tau) = (shear(u, w, s), within(t, s));
    let gaps = fenchel_gap(v, tau, s) - fenchel_gap(v, sigma, s) - fenchel_gap(u, tau, s);
    ensure!(gaps == (sigma - tau) * (u - v));
    Verdict::Holds(class(u))
}

/// The same without friction's share of the gap: as if tau v were all of it.
pub fn control_error_bound_without_the_gap_of_friction<S: Ordered>(
    [u, v, w, t, s]: [S; 5],
) -> Verdict {
    given!(s >= S::from(0));
    let (sigma, tau) = (shear(u, w, s), within(t, s));
    let gaps = tau * v - fenchel_gap(v, sigma, s) - fenchel_gap(u, tau, s);
    ensure!(gaps == (sigma - tau) * (u - v));
    Verdict::Holds("always")
}

/// The same for Coulomb's law, with the pressures a of u and b of tau: one more term, mu (b - a) (|u| - |v|), which may have any sign.
pub fn coulomb_has_one_term_without_a_sign<S: Ordered>([u, v, w, t, a, b, mu]: [S; 7]) -> Verdict {
    let zero = S::from(0);
    given!(a >= zero && b >= zero && mu >= zero);
    let (sigma, tau) = (shear(u, w, mu * a), within(t, mu * b));
    let of_tau = mu * b * abs(v) + tau * v;
    let [of_sigma, of_u] = [mu * a * abs(v) + sigma * v, mu * b * abs(u) + tau * u];
    ensure!(of_tau >= zero && of_sigma >= zero && of_u >= zero);
    let rest = mu * (b - a) * (abs(u) - abs(v));
    ensure!(of_tau - of_sigma - of_u + rest == (sigma - tau) * (u - v));
    Verdict::Holds(class(u))
}

/// That term is not negative: there would be a bound for Coulomb's law.
pub fn control_the_term_without_a_sign_has_one<S: Ordered>([u, v, a, b]: [S; 4]) -> Verdict {
    given!(a >= S::from(0) && b >= S::from(0));
    ensure!((b - a) * (abs(u) - abs(v)) >= S::from(0));
    Verdict::Holds("always")
}

harnesses! {
    /// The clip is x, m or -m, bit for bit, and within the bounds.
    holds clip_is_the_number_or_a_bound_for_all_finite_doubles() {
        let (x, m) = (finite(), finite());
        assume(m >= 0.0);
        let q = clip(x, m);
        assert!(-m <= q && q <= m && (q == x || (q == m && x >= m) || (q == -m && x <= -m)));
    }
    /// The false twin: always the number.
    fails control_clip_is_the_number_for_all_finite_doubles([2.0, 1.0]) {
        let (x, m) = (finite(), finite());
        assume(m >= 0.0);
        assert!(clip(x, m) == x);
    }
    /// A NaN must not become "no friction".
    holds clip_of_nan_is_nan_for_all_bounds() {
        let m: f64 = any();
        assume(m.is_finite() && m >= 0.0);
        assert!(clip(f64::NAN, m).is_nan());
    }
    /// The false twin: by `f64::clamp`'s order of questions it would be a bound.
    fails control_clip_of_nan_by_tests_for_within([1.0]) {
        let m: f64 = any();
        assume(m.is_finite() && m >= 0.0);
        let x = f64::NAN;
        let q = if x < m && x > -m { x } else { m };
        assert!(q.is_nan());
    }
    /// Where the products are exact: firmly nonexpansive.
    holds clip_is_firmly_nonexpansive_for_all_i8() {
        assert!(!clip_is_firmly_nonexpansive([byte(), byte(), byte()]).fails());
    }
    /// The false twin: twice the clip.
    fails control_twice_the_clip_is_firmly_nonexpansive_for_all_i8([1.0, 0.0, 1.0]) {
        assert!(!control_twice_the_clip_is_firmly_nonexpansive([byte(), byte(), byte()]).fails());
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::{Claim, model_checked};
    use crate::numbers::Exact;

    /// The row of friction.
    pub fn claim() -> Claim {
        Claim {
            id: "27",
            title: "Friction",
            paper: "Nothing: it has sigma_t = 0 on Gamma_C.",
            limits: "Integrals, which are tested (`props/tests/program/edges.rs`, the kernel); existence and uniqueness, on paper (`docs/theory.md`, 13).",
            checks: [
                statements! {
                    proved + tested tresca_is_one_equation[v, sigma, s, gamma]: "sticks", "slides", "neither holds";
                    proved + tested coulomb_is_two_equations[n, p, v, sigma, mu, gamma]
                        : "open", "sticks", "slides", "neither holds" prepared(on_coulombs_law);
                    proved + tested clip_is_the_projection_on_the_bounds[x, w, m]: "within", "beyond";
                    proved + tested clip_is_firmly_nonexpansive[a, b, m]: "the same", "differ";
                    proved + tested clip_is_lipschitz_in_its_bound[x, m, n]: "the same", "differ";
                    proved + tested gap_of_friction_is_zero_exactly_where_tresca_holds[v, tau, s]
                        : "sticks", "slides", "neither holds";
                    proved + tested pressure_pays_for_friction[d, p, mu]
                        hints(|v| { let (two, m) = (v[0] + v[0], v[2] * v[1]); vec![two - m, two + m] });
                    proved + tested friction_does_not_drive[p, x, c, b, mu]: "open", "pressed"
                        hints(|v| { let m = v[4] * v[3]; vec![v[0] - v[2], v[0] - m, v[0] + m] });
                    proved + tested gaps_of_friction_are_the_work_of_the_errors[u, v, w, t, s]: "sticks", "slides";
                    proved + tested coulomb_has_one_term_without_a_sign[u, v, w, t, a, b, mu]: "sticks", "slides";
                    refuted control_clip_without_gamma[v, sigma, s, gamma] fails "law == equation";
                    refuted control_friction_along_the_slip[v, sigma, s, gamma]
                        fails "law == (gamma * sigma == clip(p, gamma * s))";
                    refuted control_friction_of_a_pressure_that_pulls[n, p, v, sigma, mu, gamma]
                        fails "law == equations";
                    refuted control_twice_the_clip_is_firmly_nonexpansive[a, b, m] fails "d * d <= d * (a - b)";
                    refuted control_gap_of_friction_for_any_traction[v, tau, s]
                        fails "fenchel_gap(v, tau, s) >= S::from(0)";
                    refuted control_pressure_pays_for_friction_twice[d, p, mu]
                        fails "S::from(8) * (d * d - moved) >= -(mu * mu * p * p)";
                    refuted control_error_bound_without_the_gap_of_friction[u, v, w, t, s]
                        fails "gaps == (sigma - tau) * (u - v)";
                    refuted control_the_term_without_a_sign_has_one[u, v, a, b]
                        fails "(b - a) * (abs(u) - abs(v)) >= S::from(0)";
                },
                model_checked(HARNESSES, &[]),
            ]
            .concat(),
        }
    }

    /// Moves half of the draws onto Coulomb's law, which they would hardly meet: n p = 0, and the shear stress as it must be.
    fn on_coulombs_law(values: &mut [Exact]) {
        let zero = Exact::from(0);
        let [n, p, v, sigma, mu, _] = values else { return };
        if *n > *sigma {
            return;
        }
        *n = if *p < zero { zero } else { *n };
        *p = if *n < zero { zero } else { *p };
        *sigma = shear(*v, *sigma, -(*mu * *p));
    }
}
