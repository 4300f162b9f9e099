//! The constants of Lemma 3.2, (11), (12), (13), (21) and (25) do not depend on the mesh size h, nor, once gamma0 is
//! small, on gamma0: they come from the shape of the triangles (h_T/rho_T <= sigma, rho_T the radius of the inscribed
//! circle), from the material, and from the constants of Korn's inequality and of the continuity of a(., .),
//! alpha |v|_1^2 <= a(v, v) <= M |v|_1^2.
//!
//! ```text
//! |T| = rho_T (|E_0| + |E_1| + |E_2|)/2,  2 h_T <= |E_0| + |E_1| + |E_2|
//! h_T |E|/|T| <= h_T/rho_T <= sigma,      h_T (|E_0| + |E_1| + |E_2|)/|T| = 2 h_T/rho_T <= 2 sigma
//! kappa_T <= 2 sigma c_p (lambda + 2 mu) gamma0                                     (sigma for one contact edge)
//! kappa <= 1/2:  A(v, v) >= alpha/2 |v|_1^2,   |e|_a^2 + |z|_g^2 <= 13 (|eta|_a^2 + |sigma_n(eta)|_g^2 + |gamma^(-1/2) eta_n|^2)
//! ```
//!
//! (22)-(24) are hypotheses here, with constants c_1, c_2, c_3; `interpolation` has them with numbers for P1 and nu = 1/2.

use signorini::kernel::contact_edge::coercivity_constant;
use signorini::kernel::{Material, P1, P2, Plane, Triangle};
use signorini::nalgebra::Vector2;

use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

/// The triangle inequality for the edges of a triangle with one vertex in the origin, whose lengths are given by their
/// squares.
pub fn two_edges_are_as_long_as_the_third<S: Ordered>(
    [bx, by, cx, cy, p, q, r]: [S; 7],
) -> Verdict {
    let zero = S::from(0);
    let triangle =
        Triangle { vertices: [Vector2::zeros(), Vector2::new(bx, by), Vector2::new(cx, cy)] };
    let [a, b, c] = [0, 1, 2].map(|i| triangle.edge(i));
    given!(p >= zero && q >= zero && r >= zero);
    given!(b.dot(&b) == p * p && c.dot(&c) == q * q && a.dot(&a) == r * r);
    let (along, across) = (b.dot(&c), b.perp(&c));
    ensure!(along * along + across * across == p * p * q * q);
    ensure!(p * q >= zero);
    ensure!(along <= p * q);
    ensure!(r * r <= (p + q) * (p + q));
    ensure!(r <= p + q);
    Verdict::Holds("always")
}

fn larger<S: Ordered>(a: S, b: S) -> S {
    if a < b { b } else { a }
}

/// h_T |E|/|T| <= sigma for one edge and 2 sigma for all three together, for a triangle with these lengths of its edges
/// and this radius of its inscribed circle; `factor` multiplies the first bound (1, or a planted smaller one).
fn shape_bound<S: Ordered>([a, b, c, rho, sigma]: [S; 5], factor: S) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(a > zero && b > zero && c > zero && rho > zero);
    given!(a <= b + c && b <= c + a && c <= a + b);
    let diameter = larger(larger(a, b), c);
    given!(diameter <= sigma * rho);
    let perimeter = a + b + c;
    let area = rho * perimeter / two;
    ensure!(two * diameter <= perimeter);
    ensure!(rho * diameter <= area);
    ensure!(diameter * diameter <= sigma * rho * diameter);
    ensure!(diameter * diameter <= factor * sigma * area);
    ensure!(diameter * perimeter <= two * sigma * area);
    Verdict::Holds("always")
}

/// h_T |E|/|T| is at most sigma, and at most 2 sigma for the sum of all edges.
pub fn shape_regularity_bounds_edge_and_diameter_by_the_area<S: Ordered>(v: [S; 5]) -> Verdict {
    shape_bound(v, S::from(1))
}

/// Half of that.
pub fn control_half_the_shape_constant<S: Ordered>(v: [S; 5]) -> Verdict {
    shape_bound(v, S::from(1) / S::from(2))
}

/// kappa_T/gamma0 is at most 2 sigma c_p (lambda + 2 mu) where h_T |contact edges|/|T| <= 2 sigma: nothing of the size of
/// T is left.
pub fn the_constant_of_11_depends_on_shape_and_material_alone<S: Ordered>(
    [diameter, length, area, sigma, lambda, mu]: [S; 6],
) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(mu > zero && lambda + mu > zero && area > zero);
    given!(diameter * length <= two * sigma * area);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let stiffness = lambda + two * mu;
    ensure!(stiffness > zero);
    let acting = material.normal_stiffness(Vector2::<S>::zeros());
    ensure!(acting == stiffness);
    let p1 = coercivity_constant::<P1, S, 3, 2>(acting, diameter, length, area);
    ensure!(p1 * area == stiffness * (diameter * length));
    ensure!(stiffness * (diameter * length) <= two * sigma * stiffness * area);
    ensure!(p1 <= two * sigma * stiffness);
    let p2 = coercivity_constant::<P2, S, 6, 3>(acting, diameter, length, area);
    ensure!(p2 == S::from(3) * p1);
    Verdict::Holds("always")
}

/// (11), Lemma 3.2 and (12) in |.|_1, with constants in which h does not occur, nor, for the last two, gamma0: n =
/// |v|_1^2, a = a(v, v), s = |sigma_n(v)|_g^2 <= gamma0 C_h a, C_h <= c, gamma0 <= 1/(2 c); `contact` is the other term
/// of (12), which is not negative by Theorem 3.3.
pub fn lemma_3_2_holds_with_constants_without_h<S: Ordered>(
    [n, a, s, contact, gamma0, limit, c, alpha, most]: [S; 9],
) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(n >= zero && a >= zero && contact >= zero && gamma0 > zero && limit >= zero);
    given!(alpha > zero && alpha * n <= a && a <= most * n);
    given!(s <= gamma0 * limit * a && limit <= c && two * gamma0 * c <= one);
    ensure!(gamma0 * limit * a <= gamma0 * c * a);
    ensure!(s <= gamma0 * c * a);
    ensure!(gamma0 * c * a <= gamma0 * c * (most * n));
    ensure!(s <= gamma0 * c * most * n);
    ensure!(two * gamma0 * c * a <= a);
    ensure!(a - s >= a / two);
    ensure!(a - s >= alpha / two * n);
    ensure!(a - s + contact >= alpha / two * n);
    Verdict::Holds("always")
}

/// (13), squared: from Theorem 3.4 with kappa <= 1/2, in |.|_1, with the constant 13 max(M, 1)/min(alpha, 1). With E^2 =
/// |e|_a^2, H^2 = |eta|_a^2, Z = |z|_g, S = |sigma_n(eta)|_g, R = |gamma^(-1/2) P0(eta)|, D = |gamma^(-1/2) eta_n|, and
/// n, m the squares of |e|_1, |eta|_1.
pub fn estimate_13_holds_with_a_constant_without_h<S: Ordered>(v: [S; 11]) -> Verdict {
    estimate_13(v, S::from(1))
}

/// (13) without the stress of the test function on the right.
pub fn control_estimate_13_without_the_stress<S: Ordered>(v: [S; 11]) -> Verdict {
    estimate_13(v, S::from(0))
}

/// (13), with a factor of |sigma_n(eta)|_g^2 on the right.
fn estimate_13<S: Ordered>(
    [e2, h2, z2, s, r, d, kappa, n, m, alpha, most]: [S; 11],
    of_stress: S,
) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(e2 >= zero && h2 >= zero && z2 >= zero && s >= zero && r >= zero && d >= zero);
    given!(kappa >= zero && two * kappa <= one && r <= d + s);
    given!(alpha * n <= e2 && h2 <= most * m);
    let delta = one - kappa;
    let bracket = |h2: S, s2: S, r2: S| {
        (two + two * kappa * delta + delta) * h2 + kappa * (two + delta) * s2 + delta * r2
    };
    given!(delta * delta * e2 + delta * z2 <= bracket(h2, s * s, r * r));
    let (four, half) = (S::from(4), one / two);
    ensure!(delta >= half && delta <= one);
    ensure!(four * delta * delta >= one);
    ensure!(e2 <= four * delta * delta * e2);
    ensure!(z2 <= two * delta * z2);
    ensure!(two * z2 <= four * delta * z2);
    ensure!(two + two * kappa * delta + delta <= S::from(13) / four);
    ensure!((two + two * kappa * delta + delta) * h2 <= S::from(13) / four * h2);
    ensure!(kappa * (two + delta) <= S::from(5) / four);
    ensure!(kappa * (two + delta) * (s * s) <= S::from(5) / four * (s * s));
    ensure!(r * r <= (d + s) * (d + s));
    ensure!((d + s) * (d + s) <= two * d * d + two * s * s);
    ensure!(delta * (r * r) <= r * r);
    ensure!(e2 + z2 <= S::from(13) * (h2 + of_stress * s * s + d * d));
    ensure!(alpha * n + z2 <= S::from(13) * (most * m + of_stress * s * s + d * d));
    Verdict::Holds("always")
}

/// (21), squared, from (13), squared, and (22)-(24), which are hypotheses: with r = h^(1/2 + nu) |u|_(3/2 + nu), m = |eta|_1
/// <= c_1 r, d = |gamma^(-1/2) eta_n| <= c_2 r, s = |sigma_n(eta)|_g <= c_3 r; `left` is the left side.
pub fn rate_21_follows_from_13_and_22_to_24<S: Ordered>(v: [S; 9]) -> Verdict {
    rate_21(v, true)
}

/// (21) without (23).
pub fn control_rate_21_without_23<S: Ordered>(v: [S; 9]) -> Verdict {
    rate_21(v, false)
}

/// (21), with (23) or without.
fn rate_21<S: Ordered>([left, m, d, s, r, c1, c2, c3, most]: [S; 9], with_23: bool) -> Verdict {
    let zero = S::from(0);
    given!(m >= zero && d >= zero && s >= zero && most >= zero);
    given!(m <= c1 * r && s <= c3 * r);
    given!(!with_23 || d <= c2 * r);
    given!(left <= S::from(13) * (most * m * m + s * s + d * d));
    ensure!(m * m <= c1 * r * (c1 * r));
    ensure!(d * d <= c2 * r * (c2 * r));
    ensure!(s * s <= c3 * r * (c3 * r));
    ensure!(most * (m * m) <= most * (c1 * r * (c1 * r)));
    ensure!(left <= S::from(13) * (most * c1 * c1 + c2 * c2 + c3 * c3) * (r * r));
    Verdict::Holds("always")
}

/// (25): |sigma_n(e)|_g <= s + k (E + H) with (21) for E, (22) for H and (24) for s.
pub fn rate_25_follows_from_corollary_3_6<S: Ordered>(v: [S; 9]) -> Verdict {
    rate_25(v, true)
}

/// (25) without (24).
pub fn control_rate_25_without_24<S: Ordered>(v: [S; 9]) -> Verdict {
    rate_25(v, false)
}

/// (25), with (24) or without.
fn rate_25<S: Ordered>([x, s, e, h, k, r, c1, c3, c4]: [S; 9], with_24: bool) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(k >= zero && k <= one && e >= zero && h >= zero);
    given!(x <= s + k * (e + h));
    given!(h <= c1 * r && e <= c4 * r);
    given!(!with_24 || s <= c3 * r);
    ensure!(k * (e + h) <= e + h);
    ensure!(x <= (c1 + c3 + c4) * r);
    Verdict::Holds("always")
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::Claim;
    use crate::claims::interpolation;

    /// The row of the constants.
    pub fn claim() -> Claim {
        Claim {
            id: "15",
            title: "The constants do not depend on the mesh",
            paper: "C h_T^(-1/2) for |E|^(1/2)/|T|^(1/2) in the proof of (11).",
            limits: "The constants are not as small as possible.",
            checks: [
                statements! {
                    proved two_edges_are_as_long_as_the_third[bx, by, cx, cy, p, q, r] about "Lemma 3.2", "(11)"
                        hints(|v| vec![v[0] * v[3] - v[1] * v[2]]);
                    proved + tested shape_regularity_bounds_edge_and_diameter_by_the_area[a, b, c, rho, sigma]
                        about "Lemma 3.2", "(11)";
                    proved the_constant_of_11_depends_on_shape_and_material_alone[diameter, length, area, sigma, lambda, mu]
                        about "Lemma 3.2", "(11)";
                    proved lemma_3_2_holds_with_constants_without_h[n, a, s, contact, gamma0, limit, c, alpha, most]
                        about "Lemma 3.2", "(11)", "(12)";
                    proved estimate_13_holds_with_a_constant_without_h[e2, h2, z2, s, r, d, kappa, n, m, alpha, most]
                        about "(13)";
                    proved rate_21_follows_from_13_and_22_to_24[left, m, d, s, r, c1, c2, c3, most]
                        about "Theorem 3.5", "(21)";
                    proved rate_25_follows_from_corollary_3_6[x, s, e, h, k, r, c1, c3, c4]
                        about "Corollary 3.6", "(25)";
                    refuted control_estimate_13_without_the_stress[e2, h2, z2, s, r, d, kappa, n, m, alpha, most]
                        fails "e2 + z2 <= S::from(13) * (h2 + of_stress * s * s + d * d)";
                    refuted control_rate_21_without_23[left, m, d, s, r, c1, c2, c3, most]
                        fails "d * d <= c2 * r * (c2 * r)";
                    refuted control_rate_25_without_24[x, s, e, h, k, r, c1, c3, c4]
                        fails "x <= (c1 + c3 + c4) * r";
                    refuted control_half_the_shape_constant[a, b, c, rho, sigma]
                        fails "diameter * diameter <= factor * sigma * area";
                },
                interpolation::checks(),
            ]
            .concat(),
        }
    }
}
