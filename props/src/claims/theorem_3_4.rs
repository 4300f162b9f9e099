//! Theorem 3.4 with every constant explicit, and the paper's own chain (14)-(20), step by step.
//!
//! Norms |v|_a^2 = a(v, v), |s|_g^2 = int gamma s^2; u exact, v^h any discrete function with the Dirichlet data of u^h,
//! e = u - u^h, eta = u - v^h, w = v^h - u^h = e - eta, z = sigma_n(u) + \[P(u^h)\]+/gamma, delta = 1 - kappa. Then
//!
//! ```text
//! (i)    a(e, w) = int z P0(w) + int gamma sigma_n(w) sigma_n(e)
//! (ii)   z (P(u) - P(u^h)) <= -gamma z^2                          at every point, by (5)
//! (iii)  |sigma_n(w)|_g^2 <= kappa |w|_a^2                        (11)
//!
//! |e|_a^2 + |z|_g^2/delta <= (2/delta) [ (1/delta + kappa + 1/2) |eta|_a^2
//!                            + kappa (1/delta + 1/2) |sigma_n(eta)|_g^2 + 1/2 |gamma^(-1/2) P0(eta)|^2 ]
//! ```
//!
//! The predicates speak of the numbers that these integrals are: whatever satisfies the hypotheses satisfies the bound.
//!
//! **Errata.** (17) and (18) as printed lack a factor gamma in int (sigma_n(u) + \[P\]+/gamma) sigma_n(u - v^h): a term
//! of dimension stress^2 length stands beside terms of dimension gamma stress^2 length. As printed both are false at
//! points; with the factor they hold, and the rest of the chain uses them in that form.

use signorini::kernel::{ContactPoint, positive_part};

use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

/// A point of Gamma_C with the exact solution, the discrete one and a test function.
struct Point<S> {
    gamma: S,
    exact: ContactPoint<S>,
    discrete: ContactPoint<S>,
    test: ContactPoint<S>,
}

/// From gamma, g, and (v_n, sigma_n) of u, u^h, v^h.
fn point<S: Ordered>([gamma, gap, u, su, uh, sh, v, sv]: [S; 8]) -> Point<S> {
    let of = |u_n, sigma_n| ContactPoint { u_n, gap, sigma_n, gamma };
    Point { gamma, exact: of(u, su), discrete: of(uh, sh), test: of(v, sv) }
}

impl<S: Ordered> Point<S> {
    /// z = sigma_n(u) + \[P(u^h)\]+/gamma = sigma_n(u) - lambda^h
    fn z(&self) -> S {
        self.exact.sigma_n - self.discrete.pressure()
    }

    /// The same for w = v^h - u^h: v_n, and sigma_n; the gap cancels.
    fn w(&self) -> ContactPoint<S> {
        difference(&self.test, &self.discrete)
    }
}

fn difference<S: Ordered>(a: &ContactPoint<S>, b: &ContactPoint<S>) -> ContactPoint<S> {
    let (u_n, sigma_n) = (a.u_n - b.u_n, a.sigma_n - b.sigma_n);
    ContactPoint { u_n, gap: S::from(0), sigma_n, gamma: a.gamma }
}

fn class<S: Ordered>(point: &Point<S>) -> &'static str {
    if point.discrete.p() > S::from(0) { "pressed" } else { "open" }
}

/// (i): what Green and (8) leave at a point, z w_n - \[P(u^h)\]+ sigma_n(w) - gamma sigma_n(u^h) sigma_n(w), is
/// z P0(w) + gamma sigma_n(w) sigma_n(e). No hypothesis but gamma > 0.
///
/// Sign: (8) contributes -(A part) = + int gamma sigma_n(u^h) sigma_n(w) with a(u^h, w) on the left.
pub fn error_identity_holds_at_a_point<S: Ordered>(v: [S; 8]) -> Verdict {
    let point = point(v);
    given!(point.gamma > S::from(0));
    let (w, z) = (point.w(), point.z());
    let part = positive_part(point.discrete.p());
    let green = point.exact.sigma_n * w.u_n;
    // a(u^h, w) = L(w) + int gamma sigma_n(u^h) sigma_n(w) - int (1/gamma) [P(u^h)]+ P0(w), from (8).
    let method = point.gamma * point.discrete.sigma_n * w.sigma_n
        - part / point.gamma * (w.u_n - point.gamma * w.sigma_n);
    let sigma_e = point.exact.sigma_n - point.discrete.sigma_n;
    ensure!(green - method == z * w.p0() + point.gamma * w.sigma_n * sigma_e);
    Verdict::Holds(class(&point))
}

/// (ii), from (5) at the exact solution.
pub fn z_times_the_difference_of_p_is_at_most_minus_gamma_z_squared<S: Ordered>(
    [gamma, gap, u, su, uh, sh]: [S; 6],
) -> Verdict {
    let zero = S::from(0);
    let point = point([gamma, gap, u, su, uh, sh, zero, zero]);
    given!(gamma > zero);
    given!(gamma * su == -positive_part(point.exact.p()));
    let (z, p, ph) = (point.z(), point.exact.p(), point.discrete.p());
    let scaled = positive_part(ph) - positive_part(p);
    ensure!(gamma * z == scaled);
    ensure!(scaled * (p - ph) <= -scaled * scaled);
    ensure!(gamma * (z * (p - ph)) <= gamma * (-gamma * z * z));
    ensure!(z * (p - ph) <= -gamma * z * z);
    Verdict::Holds(class(&point))
}

/// P0(w) = P(u) - P(u^h) - P0(eta).
pub fn p0_of_w_splits<S: Ordered>(v: [S; 8]) -> Verdict {
    let point = point(v);
    let eta = difference(&point.exact, &point.test);
    ensure!(point.w().p0() == point.exact.p() - point.discrete.p() - eta.p0());
    Verdict::Holds("always")
}

/// The hypothesis of the combination from the raw facts. With c = a(e, eta), W = |w|_a, r = |s_w|_g,
/// t = int gamma s_w s_eta and kappa = k^2, the bound a(e, w) + |z|^2 <= r^2 + t + Z R becomes one inequality between
/// norms.
pub fn raw_facts_give_the_inequality_between_norms<S: Ordered>(
    [e, h, w, c, s, r, t, k]: [S; 8],
) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(e >= zero && h >= zero && w >= zero && s >= zero && r >= zero);
    given!(k >= zero && k < one);
    given!(c <= e * h && -c <= e * h);
    given!(w * w == e * e - two * c + h * h);
    given!(r <= k * w && t <= r * s);
    ensure!(w <= e + h);
    let [small, sum] = between_norms([e, h, c, s, r, t, k]);
    ensure!(small >= zero);
    ensure!(sum >= zero);
    Verdict::Holds("always")
}

/// What [`raw_facts_give_the_inequality_between_norms`] leaves to say of c, r and t, as two numbers that are not negative:
/// (1 - 2 kappa) c <= E H, and c + r^2 + t <= (1 - 2 kappa) c + kappa (E^2 + H^2) + k (E + H) S.
fn between_norms<S: Ordered>([e, h, c, s, r, t, k]: [S; 7]) -> [S; 2] {
    let (one, two, kappa) = (S::from(1), S::from(2), k * k);
    let bound = (one - two * kappa) * c + kappa * (e * e + h * h) + k * (e + h) * s;
    [e * h - (one - two * kappa) * c, bound - (c + r * r + t)]
}

/// The inequality [9.4] of the theory, right side minus left side:
/// delta E^2 + Z^2 <= E H + kappa H^2 + Z R + k (E + H) S.
fn combined<S: Ordered>([e, h, z, s, r, k]: [S; 6]) -> S {
    let kappa = k * k;
    let right = e * h + kappa * h * h + z * r + k * (e + h) * s;
    right - ((S::from(1) - kappa) * e * e + z * z)
}

/// The hypothesis of [`theorem_3_4_holds_with_its_constant`] from (i), (ii) and (iii): with a(e, w) = E^2 - c, p = int z
/// P0(w) = d - q, d = int z (P(u) - P(u^h)) <= -Z^2, q = int z P0(eta) >= -Z R, and int gamma sigma_n(w) sigma_n(e) =
/// r^2 + t. `sign` is that of Z^2 in (ii).
fn hypothesis<S: Ordered>([e, h, z, s, big, k, c, d, q, r, t]: [S; 11], sign: S) -> Verdict {
    let zero = S::from(0);
    let [small, sum] = between_norms([e, h, c, s, r, t, k]);
    given!(small >= zero && sum >= zero);
    given!(d <= sign * z * z && -q <= z * big);
    given!(e * e - c == d - q + r * r + t);
    ensure!(combined([e, h, z, s, big, k]) >= zero);
    Verdict::Holds("always")
}

/// The combined inequality follows from the three facts.
pub fn three_facts_give_the_hypothesis_of_theorem_3_4<S: Ordered>(v: [S; 11]) -> Verdict {
    hypothesis(v, -S::from(1))
}

/// (ii) without its square.
pub fn control_three_facts_without_the_square_of_z<S: Ordered>(v: [S; 11]) -> Verdict {
    hypothesis(v, S::from(0))
}

/// The four uses of Young's inequality.
pub fn young_steps_hold<S: Ordered>([e, h, z, s, r, k]: [S; 6]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(k >= zero && k < one);
    let (kappa, two) = (k * k, S::from(2));
    let delta = one - kappa;
    let quarter = delta / S::from(4);
    ensure!(e * h <= quarter * e * e + h * h / delta);
    ensure!(k * e * s <= quarter * e * e + kappa * s * s / delta);
    ensure!(k * h * s <= h * h / two + kappa * s * s / two);
    ensure!(z * r <= z * z / two + r * r / two);
    Verdict::Holds("always")
}

/// Theorem 3.4 from the inequality between norms, E = |e|_a, H = |eta|_a, Z = |z|_g, S = |sigma_n(eta)|_g,
/// R = |gamma^(-1/2) P0(eta)|, by Young's steps; `factor` multiplies the bound (1 in the theorem).
fn bound<S: Ordered>([e, h, z, s, r, k]: [S; 6], factor: S) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(e >= zero && h >= zero && z >= zero && s >= zero && r >= zero);
    given!(k >= zero && k < one);
    let kappa = k * k;
    let delta = one - kappa;
    given!(combined([e, h, z, s, r, k]) >= zero);
    let four = S::from(4);
    ensure!(four * delta * e * h <= delta * delta * e * e + four * h * h);
    ensure!(four * delta * k * e * s <= delta * delta * e * e + four * kappa * s * s);
    ensure!(two * k * h * s <= h * h + kappa * s * s);
    ensure!(two * z * r <= z * z + r * r);
    // Times delta, so that what is left is a sum.
    ensure!(delta > zero);
    ensure!(two * delta * k * h * s <= delta * h * h + delta * kappa * s * s);
    ensure!(two * delta * z * r <= delta * z * z + delta * r * r);
    let right = e * h + kappa * h * h + z * r + k * (e + h) * s;
    ensure!(delta * (delta * e * e + z * z) <= delta * right);
    let [left, bracket] = scaled_sides([e, h, z, s, r, k]);
    ensure!(left <= factor * bracket);
    Verdict::Holds("always")
}

/// Both sides of Theorem 3.4, times delta^2.
pub fn scaled_sides<S: Ordered>([e, h, z, s, r, k]: [S; 6]) -> [S; 2] {
    let (one, two, kappa) = (S::from(1), S::from(2), k * k);
    let delta = one - kappa;
    let bracket =
        (two + two * kappa * delta + delta) * h * h + kappa * (two + delta) * s * s + delta * r * r;
    [delta * delta * e * e + delta * z * z, bracket]
}

/// Theorem 3.4 with its constant.
pub fn theorem_3_4_holds_with_its_constant<S: Ordered>(v: [S; 6]) -> Verdict {
    bound(v, S::from(1))
}

/// Corollary 3.6 with its constant: |sigma_n(e)|_g <= |sigma_n(eta)|_g + sqrt(kappa) (|e|_a + |eta|_a).
pub fn corollary_3_6_holds_with_its_constant<S: Ordered>([x, s, r, w, e, h, k]: [S; 7]) -> Verdict {
    let zero = S::from(0);
    given!(k >= zero && e >= zero && h >= zero);
    given!(x <= s + r && r <= k * w && w <= e + h);
    ensure!(x <= s + k * (e + h));
    Verdict::Holds("always")
}

/// (14): -gamma s_h (s_v - s_h) + (1/gamma)\[P\]+ P0(v - u^h) turned into its last form, using a \[a\]+ = \[a\]+^2. In the
/// paper g = 0.
pub fn step_14_holds<S: Ordered>([gamma, uh, sh, v, sv]: [S; 5]) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero);
    let point = point([gamma, zero, zero, zero, uh, sh, v, sv]);
    let over_gamma = positive_part(point.discrete.p()) / gamma;
    let before = over_gamma * point.w().p0();
    let after = over_gamma * point.test.p0() - gamma * over_gamma * over_gamma;
    ensure!(before == after);
    Verdict::Holds(class(&point))
}

/// (14) whole, as printed: from ellipticity and continuity of a(., .), Green's formula for u and (8) for u^h, with the
/// integrals as numbers: n, m = |e|_1, |eta|_1; a = a(e, e) = b + c with b = a(e, eta) <= C n m, c = a(e, w); a(u, w) =
/// l + i, a(u^h, w) = l + j - p, where i = int sigma_n(u) w_n, j = int gamma sigma_n(u^h) sigma_n(w), and p = int
/// (1/gamma) \[P(u^h)\]+ P0(w) = q - r is the last step, which `step_14_holds` shows at a point.
pub fn estimate_14_holds<S: Ordered>(
    [alpha, big, n, m, b, c, l, i, j, p, q, r]: [S; 12],
) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(alpha > zero && big >= zero && n >= zero && m >= zero);
    given!(alpha * n * n <= b + c && b <= big * n * m);
    given!(c == (l + i) - (l + j - p) && p == q - r);
    let half = alpha / two;
    ensure!(two * alpha * (big * n * m) <= alpha * n * (alpha * n) + big * m * (big * m));
    ensure!(big * n * m <= half * n * n + big * big / (two * alpha) * m * m);
    ensure!(half * n * n <= big * big / (two * alpha) * m * m + i - j + q - r);
    Verdict::Holds("always")
}

/// (15): the terms with u_n, of which the last is dropped because u_n <= 0.
pub fn step_15_holds<S: Ordered>([gamma, u, su, uh, sh, v]: [S; 6]) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero && u <= zero);
    let point = point([gamma, zero, u, su, uh, sh, v, zero]);
    let over_gamma = positive_part(point.discrete.p()) / gamma;
    let before = su * (v - uh) + over_gamma * v;
    let kept = (su + over_gamma) * (v - u) + su * (u - uh);
    ensure!(before == kept + over_gamma * u);
    ensure!(before <= kept);
    Verdict::Holds(class(&point))
}

/// (16): Young's inequality with weights gamma and beta.
pub fn step_16_holds<S: Ordered>([z, d, gamma, beta]: [S; 4]) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(gamma > zero && beta > zero);
    ensure!(two * (gamma * z) * (beta * d) <= gamma * z * (gamma * z) + beta * d * (beta * d));
    ensure!(z * d <= gamma * z * z / (two * beta) + beta * d * d / (two * gamma));
    Verdict::Holds("always")
}

/// (17): T + gamma z^2 <= factor z sigma_n(u - v) + gamma sigma_n(u - u^h) sigma_n(v - u^h), with the factor gamma or,
/// as printed, 1. T is the sum of the four integrands of (15).
fn step_17<S: Ordered>([gamma, u, su, uh, sh, sv]: [S; 6], factor: S) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero && u <= zero && su <= zero && u * su == zero);
    let point = point([gamma, zero, u, su, uh, sh, zero, sv]);
    let (part, z) = (positive_part(point.discrete.p()), point.z());
    let t = su * (u - uh) - gamma * sh * (sv - sh) - part * sv - part * part / gamma;
    ensure!(t + gamma * z * z <= factor * z * (su - sv) + gamma * (su - sh) * (sv - sh));
    Verdict::Holds(class(&point))
}

/// (17) with the factor gamma that is missing in print.
pub fn step_17_holds_with_the_factor_gamma<S: Ordered>(v: [S; 6]) -> Verdict {
    step_17(v, v[0])
}

/// (17) as printed.
pub fn control_step_17_as_printed<S: Ordered>(v: [S; 6]) -> Verdict {
    step_17(v, S::from(1))
}

/// (18): factor z d <= gamma z^2 / (2 beta) + beta gamma d^2 / 2.
fn step_18<S: Ordered>([z, d, gamma, beta]: [S; 4], factor: S) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(gamma > zero && beta > zero);
    ensure!(factor * z * d <= gamma * z * z / (two * beta) + beta * gamma * d * d / two);
    Verdict::Holds("always")
}

/// (18) with the factor gamma that is missing in print.
pub fn step_18_holds_with_the_factor_gamma<S: Ordered>(v: [S; 4]) -> Verdict {
    step_18(v, v[2])
}

/// (18) as printed.
pub fn control_step_18_as_printed<S: Ordered>(v: [S; 4]) -> Verdict {
    step_18(v, S::from(1))
}

/// (19) with its constants: with a = |s_e|_g, s = |s_eta|_g, r = |s_w|_g, W = |w|_a: a r <= (3/2) kappa W^2 + s^2/2,
/// W^2 <= 2 (E^2 + H^2).
pub fn step_19_holds_with_its_constants<S: Ordered>([a, s, r, w, e, h, k]: [S; 7]) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(a >= zero && s >= zero && r >= zero && w >= zero && e >= zero && h >= zero);
    given!(k >= zero && r <= k * w && a <= s + r && w <= e + h);
    let (kappa, three) = (k * k, S::from(3));
    ensure!(a * r <= (s + r) * r);
    ensure!((s + r) * r <= (s + k * w) * (k * w));
    ensure!(two * s * k * w <= s * s + kappa * w * w);
    ensure!(two * a * r <= three * kappa * w * w + s * s);
    ensure!(w * w <= (e + h) * (e + h));
    ensure!((e + h) * (e + h) <= two * (e * e + h * h));
    Verdict::Holds("always")
}

/// (20) and the last estimate, from (17), (18), (19) with any C: sums of inequalities.
pub fn step_20_is_the_sum_of_17_18_and_19<S: Ordered>(
    [t, z, first, second, s, e, h, c, beta]: [S; 9],
) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(beta > zero);
    given!(t + z <= first + second);
    given!(first <= z / (two * beta) + beta / two * s);
    given!(second <= c * (e + h + s));
    let left = t + (one - one / (two * beta)) * z;
    ensure!(left <= c * (e + h) + (c + beta / two) * s);
    Verdict::Holds("always")
}

/// The last estimate of the proof, as printed: (16) and (20) put into (15). n, m, s, z, d are squares of norms, i is the
/// integral in (15), t is T; and what is left of it for beta_1 = beta_2 = 2 and gamma0 <= alpha/(4 C). `share` of the
/// 1/(2 beta_2) of (20) is used (1).
fn last_estimate<S: Ordered>(
    [alpha, big, gamma0, n, m, z, s, d, i, t, b1, b2]: [S; 12],
    share: S,
) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(alpha > zero && big >= zero && gamma0 > zero && b1 > zero && b2 > zero);
    let (first, second) = (big * big / (two * alpha), big * gamma0);
    given!(alpha / two * n <= first * m + i + t);
    given!(i <= z / (two * b1) + b1 / two * d);
    given!(t + (one - one / (two * b2)) * z <= second * n + second * m + (big + b2 / two) * s);
    let left = (alpha / two - second) * n + (one - one / (two * b1) - share / (two * b2)) * z;
    ensure!(left <= (first + second) * m + b1 / two * d + (big + b2 / two) * s);
    Verdict::Holds("always")
}

/// The estimate after (20).
pub fn the_last_estimate_follows_from_15_16_and_20<S: Ordered>(v: [S; 12]) -> Verdict {
    last_estimate(v, S::from(1))
}

/// The same without 1/(2 beta_2) on the left.
pub fn control_last_estimate_without_beta_2<S: Ordered>(v: [S; 12]) -> Verdict {
    last_estimate(v, S::from(0))
}

/// "To conclude": with beta_1 = beta_2 = 2 and gamma0 <= alpha/(4 C) the factors on the left are at least alpha/4 and 1/2.
pub fn the_last_estimate_bounds_both_errors<S: Ordered>(
    [alpha, big, gamma0, n, z, right]: [S; 6],
) -> Verdict {
    let (zero, one, two, four) = (S::from(0), S::from(1), S::from(2), S::from(4));
    given!(alpha > zero && n >= zero && z >= zero && four * big * gamma0 <= alpha);
    let factor = one - one / (two * two) - one / (two * two);
    given!((alpha / two - big * gamma0) * n + factor * z <= right);
    ensure!(big * gamma0 * n <= alpha / four * n);
    ensure!(alpha / four * n + z / two <= right);
    Verdict::Holds("always")
}

/// (ii) without (5) at the exact solution.
pub fn control_z_inequality_without_5<S: Ordered>([gamma, gap, u, su, uh, sh]: [S; 6]) -> Verdict {
    let zero = S::from(0);
    let point = point([gamma, gap, u, su, uh, sh, zero, zero]);
    given!(gamma > zero);
    let z = point.z();
    ensure!(z * (point.exact.p() - point.discrete.p()) <= -gamma * z * z);
    Verdict::Holds(class(&point))
}

/// Half of the constant of Theorem 3.4.
pub fn control_half_the_constant_of_theorem_3_4<S: Ordered>([e, h, z, s, r, k]: [S; 6]) -> Verdict {
    bound([e, h, z, s, r, k], S::from(1) / S::from(2))
}

/// (15) without u_n <= 0.
pub fn control_step_15_with_penetration<S: Ordered>([gamma, u, su, uh, sh, v]: [S; 6]) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero);
    let point = point([gamma, zero, u, su, uh, sh, v, zero]);
    let over_gamma = positive_part(point.discrete.p()) / gamma;
    ensure!(su * (v - uh) + over_gamma * v <= (su + over_gamma) * (v - u) + su * (u - uh));
    Verdict::Holds(class(&point))
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::{Claim, Engine, Outcome, by, control, proved, refuted, tested};
    use crate::claims::rates;
    use crate::draws;
    use crate::numbers::{Dimension, Exact, Quantity};
    use crate::statement;

    const NUMBER: Dimension = Dimension::NUMBER;
    const LENGTH: Dimension = Dimension::LENGTH;
    const STRESS: Dimension = Dimension::STRESS;
    const GAMMA: Dimension = Dimension::GAMMA;
    const WORK: Dimension = Dimension::WORK;
    const NORM: Dimension = Dimension::NORM;

    /// Runs a step on numbers with these dimensions: it fails where different ones are added or compared.
    fn with_dimensions<const N: usize>(
        values: &[(i64, i64)],
        prepare: fn(&mut [Exact]),
        dimensions: [Dimension; N],
        step: fn([Quantity; N]) -> Verdict,
    ) -> Verdict {
        Exact::scope(|| {
            let mut values: Vec<Exact> = values.iter().map(|&(n, d)| Exact::ratio(n, d)).collect();
            prepare(&mut values);
            let data = std::array::from_fn(|i| Quantity::new(values[i], dimensions[i]));
            match Quantity::check(|| step(data)) {
                Err(_) => Verdict::Fails("one dimension on both sides"),
                // An inequality that does not hold is not the point here.
                Ok(Verdict::Fails(_)) => Verdict::Vacuous,
                Ok(verdict) => verdict,
            }
        })
    }

    /// All draws of a step, and that each of its classes is hit.
    fn has_one_dimension<const N: usize>(
        dimensions: [Dimension; N],
        classes: &[&'static str],
        prepare: fn(&mut [Exact]),
        step: fn([Quantity; N]) -> Verdict,
    ) -> Result<(), String> {
        draws::hold(200, draws::ratios(N), classes, |values| {
            with_dimensions(values, prepare, dimensions, step)
        })
        .map(|_| ())
    }

    /// (14)-(20), and what leads to the constant: every sum and every comparison in them is one of equal dimensions.
    fn dimensions() -> Outcome {
        let branches = ["pressed", "open"];
        let point = [GAMMA, LENGTH, LENGTH, STRESS, LENGTH, STRESS, LENGTH, STRESS];
        has_one_dimension(point, &branches, |_| {}, error_identity_holds_at_a_point)?;
        has_one_dimension(
            [GAMMA, LENGTH, LENGTH, STRESS, LENGTH, STRESS],
            &branches,
            onto_contact,
            z_times_the_difference_of_p_is_at_most_minus_gamma_z_squared,
        )?;
        has_one_dimension(point, &["always"], |_| {}, p0_of_w_splits)?;
        let raw = [NORM, NORM, NORM, WORK, NORM, NORM, WORK, NUMBER];
        has_one_dimension(
            raw,
            &["always"],
            onto_raw_facts,
            raw_facts_give_the_inequality_between_norms,
        )?;
        let norms = [NORM, NORM, NORM, NORM, NORM, NUMBER];
        has_one_dimension(norms, &["always"], onto_bound, young_steps_hold)?;
        has_one_dimension(norms, &["always"], onto_bound, theorem_3_4_holds_with_its_constant)?;
        let of_14 = [GAMMA, LENGTH, STRESS, LENGTH, STRESS];
        has_one_dimension(of_14, &branches, |_| {}, step_14_holds)?;
        let of_15 = [GAMMA, LENGTH, STRESS, LENGTH, STRESS, LENGTH];
        has_one_dimension(of_15, &branches, |_| {}, step_15_holds)?;
        has_one_dimension([STRESS, LENGTH, GAMMA, NUMBER], &["always"], |_| {}, step_16_holds)?;
        has_one_dimension(OF_17, &branches, onto_17, step_17_holds_with_the_factor_gamma)?;
        has_one_dimension(OF_18, &["always"], |_| {}, step_18_holds_with_the_factor_gamma)?;
        let of_19 = [NORM, NORM, NORM, NORM, NORM, NORM, NUMBER];
        has_one_dimension(of_19, &["always"], onto_19, step_19_holds_with_its_constants)?;
        let of_20 = [WORK, WORK, WORK, WORK, WORK, WORK, WORK, NUMBER, NUMBER];
        has_one_dimension(of_20, &["always"], onto_20, step_20_is_the_sum_of_17_18_and_19)?;
        Ok("stress and length: the same on both sides of every sum and comparison".to_owned())
    }

    const OF_17: [Dimension; 6] = [GAMMA, LENGTH, STRESS, LENGTH, STRESS, STRESS];
    const OF_18: [Dimension; 4] = [STRESS, STRESS, GAMMA, NUMBER];

    /// (17) and (18) as printed, without the factor gamma.
    fn printed_dimensions() -> Outcome {
        draws::reject(200, draws::ratios(6), |values| {
            with_dimensions(values, onto_17, OF_17, control_step_17_as_printed)
        })?;
        draws::reject(200, draws::ratios(4), |values| {
            with_dimensions(values, |_| {}, OF_18, control_step_18_as_printed)
        })
    }

    /// r = k W, a = s + r, W = e + h.
    fn onto_19(v: &mut [Exact]) {
        for value in v.iter_mut() {
            *value = value.abs();
        }
        v[3] = v[4] + v[5];
        v[2] = v[6] * v[3];
        v[0] = v[1] + v[2];
    }

    /// The three hypotheses, with equality.
    fn onto_20(v: &mut [Exact]) {
        let two = Exact::from(2);
        v[8] = v[8].abs() + Exact::from(1);
        v[2] = v[1] / (two * v[8]) + v[8] / two * v[4];
        v[3] = v[7] * (v[5] + v[6] + v[4]);
        v[0] = v[2] + v[3] - v[1];
    }

    /// The exact points that refute (17) and (18) as printed; with the factor gamma both hold there.
    fn errata_points() -> Outcome {
        Exact::scope(|| {
            let of = |v: &[i64]| -> Vec<Exact> { v.iter().map(|&n| Exact::ratio(n, 4)).collect() };
            let array = |v: &[i64]| -> [Exact; 6] { of(v).try_into().expect("six numbers") };
            let v = array(&[8, 0, -4, 0, 0, 0]);
            if !control_step_17_as_printed(v).fails()
                || step_17_holds_with_the_factor_gamma(v).fails()
            {
                return Err("(17) at gamma = 2, sigma_n(u) = -1".to_owned());
            }
            let v: [Exact; 4] = of(&[4, 4, 1, 4]).try_into().expect("four numbers");
            if !control_step_18_as_printed(v).fails()
                || step_18_holds_with_the_factor_gamma(v).fails()
            {
                return Err("(18) at z = 1, d = 1, gamma = 1/4, beta = 1".to_owned());
            }
            Ok("(17): gamma = 2, sigma_n(u) = -1, the rest 0: 2 <= 1 as printed, 2 <= 2 corrected; \
                (18): z = d = beta = 1, gamma = 1/4: 1 <= 1/4 as printed, 1/4 <= 1/4 corrected"
                .to_owned())
        })
    }

    /// (5) at the exact solution: u <= 0 where sigma = 0, u = g where sigma < 0.
    fn onto_contact(v: &mut [Exact]) {
        let zero = Exact::from(0);
        let gap = v[1];
        if v[2] > gap {
            v[2] = gap;
            v[3] = -v[3].abs();
        } else {
            v[3] = zero;
        }
    }

    fn onto_17(v: &mut [Exact]) {
        let zero = Exact::from(0);
        v[1] = -v[1].abs();
        v[2] = -v[2].abs();
        if v[3] > zero {
            v[1] = zero;
        } else {
            v[2] = zero;
        }
    }

    /// W on its equation: collinear e and eta, c = e h, W = |e - h|, and r, t within their bounds.
    fn onto_raw_facts(v: &mut [Exact]) {
        let one = Exact::from(1);
        for i in [0, 1, 4] {
            v[i] = v[i].abs();
        }
        v[7] = v[7].abs() / (one + v[7].abs());
        let sign = if v[3] > Exact::from(0) { one } else { -one };
        v[3] = sign * v[0] * v[1];
        v[2] = (v[0] - sign * v[1]).abs();
        v[5] = v[7] * v[2] / (one + v[5].abs());
        v[6] = v[5] * v[4] - v[6].abs();
    }

    fn onto_bound(v: &mut [Exact]) {
        let (one, two) = (Exact::from(1), Exact::from(2));
        for value in v.iter_mut() {
            *value = value.abs();
        }
        v[5] /= one + v[5];
        // Small enough on the left: E and Z from H, S and R.
        v[0] = v[1].min(v[0]);
        v[2] = v[4].min(v[2]) / two;
    }

    trait Min {
        fn min(self, other: Self) -> Self;
    }

    impl Min for Exact {
        fn min(self, other: Exact) -> Exact {
            if self <= other { self } else { other }
        }
    }

    /// The row of Theorem 3.4.
    pub fn claim() -> Claim {
        let identity = statement!(
            error_identity_holds_at_a_point,
            [gamma, g, u, su, uh, sh, v, sv],
            ["pressed", "open"]
        );
        let z = statement!(
            z_times_the_difference_of_p_is_at_most_minus_gamma_z_squared,
            [gamma, g, u, su, uh, sh],
            ["pressed", "open"]
        )
        .prepared(onto_contact);
        let split = statement!(p0_of_w_splits, [gamma, g, u, su, uh, sh, v, sv], ["always"]);
        let raw = statement!(
            raw_facts_give_the_inequality_between_norms,
            [e, h, w, c, s, r, t, k],
            ["always"]
        )
        .prepared(onto_raw_facts);
        let young = statement!(young_steps_hold, [e, h, z, s, r, k], ["always"]);
        let theorem =
            statement!(theorem_3_4_holds_with_its_constant, [e, h, z, s, r, k], ["always"])
                .prepared(onto_bound);
        let corollary =
            statement!(corollary_3_6_holds_with_its_constant, [x, s, r, w, e, h, k], ["always"]);
        let s14 = statement!(step_14_holds, [gamma, uh, sh, v, sv], ["pressed", "open"]);
        let s15 = statement!(step_15_holds, [gamma, u, su, uh, sh, v], ["pressed", "open"]);
        let s16 = statement!(step_16_holds, [z, d, gamma, beta], ["always"])
            .with_hints(|v| vec![v[2] * v[0] - v[3] * v[1]]);
        let s17 = statement!(
            step_17_holds_with_the_factor_gamma,
            [gamma, u, su, uh, sh, sv],
            ["pressed", "open"]
        )
        .prepared(onto_17);
        let s18 = statement!(step_18_holds_with_the_factor_gamma, [z, d, gamma, beta], ["always"]);
        let s19 = statement!(step_19_holds_with_its_constants, [a, s, r, w, e, h, k], ["always"]);
        let s20 = statement!(
            step_20_is_the_sum_of_17_18_and_19,
            [t, z, first, second, s, e, h, c, beta],
            ["always"]
        );
        let facts = statement!(
            three_facts_give_the_hypothesis_of_theorem_3_4,
            [e, h, z, s, big, k, c, d, q, r, t],
            ["always"]
        );
        let fourteen =
            statement!(estimate_14_holds, [alpha, big, n, m, b, c, l, i, j, p, q, r], ["always"])
                .with_hints(|v| vec![v[0] * v[2] - v[1] * v[3]]);
        let last = statement!(
            the_last_estimate_follows_from_15_16_and_20,
            [alpha, big, gamma0, n, m, z, s, d, i, t, b1, b2],
            ["always"]
        );
        let end = statement!(
            the_last_estimate_bounds_both_errors,
            [alpha, big, gamma0, n, z, right],
            ["always"]
        );
        let all = [identity, z, split, raw, young, theorem, corollary, s14, s15, s16, s17, s18];
        let mut checks: Vec<_> = all.into_iter().map(proved).collect();
        checks.extend([facts, fourteen, s19, s20, last, end].map(proved));
        checks.extend([identity, z, split, raw, theorem, s14, s15, s16, s17, s18].map(tested));
        checks.extend([
            by(Engine::Exact, "every_step_has_one_dimension", dimensions),
            control(
                Engine::Exact,
                "control_17_and_18_as_printed_have_two_dimensions",
                printed_dimensions,
            ),
            control(Engine::Exact, "control_17_and_18_as_printed_at_exact_points", errata_points),
            by(
                Engine::Doubles,
                "the_bound_holds_for_the_errors_of_the_solver",
                rates::theorem_on_computed_errors,
            ),
            control(
                Engine::Doubles,
                "control_errors_a_hundred_times_as_large",
                rates::theorem_on_errors_blown_up,
            ),
            refuted(statement!(control_step_17_as_printed, [gamma, u, su, uh, sh, sv], fails "t + gamma * z * z <= factor * z * (su - sv) + gamma * (su - sh) * (sv - sh)")),
            refuted(statement!(control_step_18_as_printed, [z, d, gamma, beta], fails "factor * z * d <= gamma * z * z / (two * beta) + beta * gamma * d * d / two")),
            refuted(
                statement!(control_z_inequality_without_5, [gamma, g, u, su, uh, sh], fails "z * (point.exact.p() - point.discrete.p()) <= -gamma * z * z"),
            ),
            refuted(
                statement!(control_half_the_constant_of_theorem_3_4, [e, h, z, s, r, k], fails "left <= factor * bracket"),
            ),
            refuted(
                statement!(control_step_15_with_penetration, [gamma, u, su, uh, sh, v], fails "su * (v - uh) + over_gamma * v <= (su + over_gamma) * (v - u) + su * (u - uh)"),
            ),
        ]);
        Claim {
            id: "11",
            items: &[
                "Theorem 3.4",
                "(13)",
                "(14)",
                "(15)",
                "(16)",
                "(17)",
                "(18)",
                "(19)",
                "(20)",
                "Corollary 3.6",
            ],
            title: "The abstract error estimate, with its constant",
            paper: "The solution u^h satisfies |u - u^h|_1 + |gamma^1/2 (sigma_n(u) + [P(u^h)]+/gamma)| <= C inf over v^h of (|u - v^h|_1 + |gamma^-1/2 (u_n - v_n^h)| + |gamma^1/2 sigma_n(u - v^h)|), gamma0 sufficiently small.",
            statement: "With kappa < 1 and delta = 1 - kappa: |u - u^h|_a^2 + |z|_g^2 / delta <= (2/delta) [(1/delta + kappa + 1/2) |eta|_a^2 + kappa (1/delta + 1/2) |sigma_n(eta)|_g^2 + 1/2 |gamma^-1/2 P0(eta)|^2]. The identity for a(e, w), the pointwise inequality for z, Young's steps and the combination are proved one by one; so are (14) whole, (15), (16), (17) and (18) with the missing factor gamma, (19) with constants, (20), and the last estimate of the proof with what it says for beta_1 = beta_2 = 2. The steps are linked: what the raw facts leave is, by one function, the hypothesis of the three facts' combination, and what that concludes is the hypothesis of the theorem. Run on numbers with dimensions, every sum and comparison in these steps is one of equal dimensions; in (17) and (18) as printed it is not.",
            numbers: "every ordered field (proof); rationals; doubles for the errors that the solver makes on exact solutions. Square roots enter as data: k with kappa = k^2, norms with their squares.",
            kernel: &[
                "contact::ContactPoint::p",
                "contact::ContactPoint::p0",
                "contact::ContactPoint::pressure",
            ],
            preconditions: "gamma > 0, 0 <= kappa < 1; (5) at the exact solution; (8) for the discrete one; the Cauchy-Schwarz inequalities and (11) of the norms.",
            limits: "The integrals are numbers here: that they exist, Green's formula and the Cauchy-Schwarz inequality are hypotheses. The computed errors are those of two solutions on one mesh each; `cargo test --test suite convergence` has many more. C in the paper's (13) is in other norms; Korn's constant is not computed (row 15 has (13) with it as a number).",
            single: None,
            checks,
        }
    }
}
