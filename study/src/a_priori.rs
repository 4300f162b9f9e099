//! Theorem 3.4 as an inequality between numbers. With the norms |v|_a^2 = a(v, v), |s|_gamma^2 = int gamma s^2 and, for a
//! field v^h with the nodal values of u^h on Gamma_D,
//!
//! e = u - u^h,  eta = u - v^h,  z = sigma_n(u) + (1/gamma) \[P(u^h)\]+,  delta = 1 - kappa > 0,
//! E = |e|_a,  Z = |z|_gamma,  H = |eta|_a,  S = |sigma_n(eta)|_gamma,  Q = |gamma^(-1/2) (P(u) - P(v^h))|_{0,Gamma_C},
//!
//! its left side is (E^2 + Z^2/delta)^(1/2), and three right sides are proved in docs/theory.md, section 9: the plain one,
//! the sharpest that follows from the same steps, and one for the a-orthogonal projection of u. All ask for exact contact
//! integrals and loads. The bounds are written once, generic over the number type, for numbers H, S, Q and, where a root of
//! kappa occurs, for that root: what the solver prints is their square root in doubles.

use signorini::exact::Errors;
use signorini::kernel::Scalar;

/// (E^2 + Z^2/delta)^(1/2) from the errors of u^h.
pub fn left(kappa: f64, e: &Errors) -> f64 {
    e.energy.hypot(e.contact_residual / (1.0 - kappa).sqrt())
}

/// Theorem 9.1: the square of the right side for \[H, S, Q\] is
/// (2/delta) ((1/delta + kappa + 1/2) H^2 + kappa (1/delta + 1/2) S^2 + Q^2/2).
pub fn plain_squared<S: Scalar>(kappa: S, [h, s, q]: [S; 3]) -> S {
    let (one, two) = (S::from(1), S::from(2));
    let (delta, half) = (one - kappa, one / two);
    let sum =
        (one / delta + kappa + half) * h * h + kappa * (one / delta + half) * s * s + half * q * q;
    two / delta * sum
}

/// The right side of Theorem 9.1 for the distances of v^h from u.
pub fn plain(kappa: f64, eta: &Errors) -> f64 {
    plain_squared(kappa, of(eta)).sqrt()
}

/// Theorem 9.3: b = |1 - 2 kappa| H + kappa^(1/2) S and c = kappa H^2 + kappa^(1/2) H S, for `root` = kappa^(1/2).
pub fn sharp_terms<S: Scalar>(kappa: S, root: S, [h, s]: [S; 2]) -> [S; 2] {
    let size = (S::from(1) - S::from(2) * kappa).split(|a| -a, |a| a);
    [size * h + root * s, kappa * h * h + root * h * s]
}

/// Theorem 9.3: with r^2 = b^2/delta + Q^2 the right side is (r + (r^2 + 4 c)^(1/2)) / (2 delta^(1/2)).
pub fn sharp(kappa: f64, eta: &Errors) -> f64 {
    let delta = 1.0 - kappa;
    let [h, s, q] = of(eta);
    let [b, c] = sharp_terms(kappa, kappa.sqrt(), [h, s]);
    let r = (b / delta.sqrt()).hypot(q);
    (r + (r * r + 4.0 * c).sqrt()) / (2.0 * delta.sqrt())
}

/// Theorem 9.4: the square of the right side for \[H, S, Q\] is H^2 + (kappa S^2/delta + Q^2) / delta.
pub fn projected_squared<S: Scalar>(kappa: S, [h, s, q]: [S; 3]) -> S {
    let delta = S::from(1) - kappa;
    h * h + (kappa / delta * s * s + q * q) / delta
}

/// The right side of Theorem 9.4, for the v^h with a(u - v^h, w) = 0 for all w in V^h only.
pub fn projected(kappa: f64, eta: &Errors) -> f64 {
    projected_squared(kappa, of(eta)).sqrt()
}

/// The right side of Corollary 9.2 (Corollary 3.6), |sigma_n(e)|_gamma <= S + kappa^(1/2) (E + H), for `root` =
/// kappa^(1/2).
pub fn corollary_bound<S: Scalar>(root: S, e: S, [h, s]: [S; 2]) -> S {
    s + root * (e + h)
}

/// [`corollary_bound`] for the errors of u^h and the distances of v^h from u.
pub fn corollary(kappa: f64, e: &Errors, eta: &Errors) -> f64 {
    corollary_bound(kappa.sqrt(), e.energy, [eta.energy, eta.normal_stress])
}

/// \[H, S, Q\]
fn of(eta: &Errors) -> [f64; 3] {
    [eta.energy, eta.normal_stress, eta.operator]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers E and Z on the boundary of what inequality [9.6] of the theory allows, from the direction (E, Z) = X (cos, sin).
    fn largest(kappa: f64, [h, s, q]: [f64; 3], angle: f64) -> f64 {
        let delta = 1.0 - kappa;
        let (x, y) = (angle.cos() / delta.sqrt(), angle.sin());
        let linear = (x * ((1.0 - 2.0 * kappa).abs() * h + kappa.sqrt() * s) + y * q) / 2.0;
        let constant = kappa * h * h + kappa.sqrt() * h * s;
        (linear + (linear * linear + constant).sqrt()) / delta.sqrt()
    }

    #[test]
    fn the_sharp_bound_is_the_largest_value_that_the_inequality_allows_and_the_plain_one_is_larger()
    {
        for kappa in [0.0, 1e-3, 0.1, 0.5, 0.9, 0.99] {
            for hsq in [[1.0, 0.0, 0.0], [1.0, 2.0, 0.5], [0.1, 1.0, 3.0], [1.0, 1.0, 1.0]] {
                let eta = Errors {
                    energy: hsq[0],
                    normal_stress: hsq[1],
                    operator: hsq[2],
                    ..Errors::default()
                };
                let most = (0..=10_000)
                    .map(|i| {
                        largest(kappa, hsq, f64::from(i) / 10_000.0 * std::f64::consts::FRAC_PI_2)
                    })
                    .fold(0.0, f64::max);
                let (sharp, plain) = (sharp(kappa, &eta), plain(kappa, &eta));
                assert!((sharp - most).abs() <= 1e-6 * sharp, "{kappa} {hsq:?}: {sharp} {most}");
                assert!(sharp <= plain * (1.0 + 1e-15), "{kappa} {hsq:?}: {sharp} {plain}");
                assert!(projected(kappa, &eta) <= plain, "{kappa} {hsq:?}");
            }
        }
    }
}
