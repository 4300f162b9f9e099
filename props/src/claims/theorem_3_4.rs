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

use super::mixed::class;
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

/// (i): what Green and (8) leave at a point, z w_n - \[P(u^h)\]+ sigma_n(w) - gamma sigma_n(u^h) sigma_n(w), is
/// z P0(w) + gamma sigma_n(w) sigma_n(e), and P0(w) = P(u) - P(u^h) - P0(eta). No hypothesis but gamma > 0.
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
    let eta = difference(&point.exact, &point.test);
    ensure!(w.p0() == point.exact.p() - point.discrete.p() - eta.p0());
    Verdict::Holds(class(&point.discrete))
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
    Verdict::Holds(class(&point.discrete))
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
    Verdict::Holds(class(&point.discrete))
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

/// (15): the terms with u_n, of which the last is dropped; `most` is what u_n may be.
fn step_15<S: Ordered>([gamma, u, su, uh, sh, v]: [S; 6], most: S) -> Verdict {
    let zero = S::from(0);
    given!(gamma > zero && u <= most);
    let point = point([gamma, zero, u, su, uh, sh, v, zero]);
    let over_gamma = positive_part(point.discrete.p()) / gamma;
    let before = su * (v - uh) + over_gamma * v;
    let kept = (su + over_gamma) * (v - u) + su * (u - uh);
    ensure!(before == kept + over_gamma * u);
    ensure!(before <= kept);
    Verdict::Holds(class(&point.discrete))
}

/// (15), because u_n <= 0.
pub fn step_15_holds<S: Ordered>(v: [S; 6]) -> Verdict {
    step_15(v, S::from(0))
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
    Verdict::Holds(class(&point.discrete))
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
    Verdict::Holds(class(&point.discrete))
}

/// Half of the constant of Theorem 3.4.
pub fn control_half_the_constant_of_theorem_3_4<S: Ordered>([e, h, z, s, r, k]: [S; 6]) -> Verdict {
    bound([e, h, z, s, r, k], S::from(1) / S::from(2))
}

/// (15) with u_n <= 1.
pub fn control_step_15_with_penetration<S: Ordered>(v: [S; 6]) -> Verdict {
    step_15(v, S::from(1))
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row;
