//! Lemma 3.2 and (11) with the explicit constant kappa = gamma0 h_T c_p (lambda + 2 mu) |E| / |T|: at a point, on an edge.
//!
//! At a point sigma_n^2 <= (lambda + 2 mu) sigma:eps, because the difference is a sum of squares: with t the normal turned
//! by a right angle, and for a normal of any length,
//!
//! ```text
//! (lambda + 2 mu) |n|^4 sigma:eps - (n.sigma n)^2 = 4 mu (lambda + mu) eps_tt^2 + 4 mu (lambda + 2 mu) eps_nt^2
//! ```
//!
//! On an edge the trace inequality |w|_E^2 <= c_p (|E|/|T|) |w|_T^2 for polynomials w of degree p - 1: c_1 = 1, c_2 = 3.

use signorini::kernel::{Element, Material, P1, P2, Plane, Stress};
use signorini::nalgebra::{Matrix2, Vector2};

use crate::harness::any;
use crate::numbers::Whole;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given, harnesses};

/// sigma:eps for the stress that belongs to a displacement gradient.
fn energy_density<S: Ordered>(stress: Stress<S>, g: Matrix2<S>) -> S {
    let [xx, yy, xy] = stress.components();
    xx * g.m11 + yy * g.m22 + xy * (g.m12 + g.m21)
}

fn gradient<S>([xx, xy, yx, yy]: [S; 4]) -> Matrix2<S> {
    Matrix2::new(xx, xy, yx, yy)
}

/// (1): sigma = lambda tr(eps) I + 2 mu eps with eps = (grad u + grad u^T)/2; sigma_n = n.sigma n; traction sigma n;
/// the normal stress of a shape function, for a unit normal.
pub fn stress_is_hookes_law<S: Ordered>([xx, xy, yx, yy, nx, ny, lambda, mu]: [S; 8]) -> Verdict {
    let two = S::from(2);
    let material = Material::lame(lambda, mu, Plane::Strain);
    ensure!(material.lambda() == lambda && material.mu() == mu);
    let stress = material.stress(gradient([xx, xy, yx, yy]));
    let (exx, eyy, exy) = (xx, yy, (xy + yx) / two);
    let [sxx, syy, sxy] = stress.components();
    ensure!(sxx == lambda * (exx + eyy) + two * mu * exx);
    ensure!(syy == lambda * (exx + eyy) + two * mu * eyy);
    ensure!(sxy == two * mu * exy);
    ensure!(*stress.matrix() == Matrix2::new(sxx, sxy, sxy, syy));
    let n = Vector2::new(nx, ny);
    let traction = stress.traction(n);
    ensure!(traction[0] == sxx * nx + sxy * ny);
    ensure!(traction[1] == sxy * nx + syy * ny);
    ensure!(stress.normal(n) == traction[0] * nx + traction[1] * ny);
    Verdict::Holds("always")
}

/// The functional sigma_n of one shape function: its value at v = N (v_x, v_y) is sigma_n of the gradient v x grad N.
pub fn normal_stress_of_a_shape_is_n_sigma_n<S: Ordered>(
    [gx, gy, vx, vy, nx, ny, lambda, mu]: [S; 8],
) -> Verdict {
    given!(nx * nx + ny * ny == S::from(1));
    let material = Material::lame(lambda, mu, Plane::Strain);
    let n = Vector2::new(nx, ny);
    let functional = material.normal_stress_of_shape(Vector2::new(gx, gy), n);
    let stress = material.stress(gradient([vx * gx, vx * gy, vy * gx, vy * gy]));
    ensure!(functional[0] * vx + functional[1] * vy == stress.normal(n));
    Verdict::Holds("always")
}

/// eps_tt and eps_nt, times |n|^2.
fn other_strains<S: Ordered>([xx, xy, yx, yy, nx, ny]: [S; 6]) -> [S; 2] {
    let two = S::from(2);
    let exy = (xy + yx) / two;
    [
        ny * ny * xx - two * nx * ny * exy + nx * nx * yy,
        nx * ny * (yy - xx) + (nx * nx - ny * ny) * exy,
    ]
}

/// The inequality at a point for a candidate of its constant and any normal, by the identity above.
fn bounded<S: Ordered>(
    [xx, xy, yx, yy, nx, ny, lambda, mu]: [S; 8],
    constant: impl Fn(&Material<S>) -> S,
) -> Verdict {
    let (zero, two, four) = (S::from(0), S::from(2), S::from(4));
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let g = gradient([xx, xy, yx, yy]);
    let stress = material.stress(g);
    let (sigma_n, squared) = (stress.normal(Vector2::new(nx, ny)), nx * nx + ny * ny);
    let [tt, nt] = other_strains([xx, xy, yx, yy, nx, ny]);
    let left = constant(&material) * squared * squared * energy_density(stress, g);
    let rest = left - sigma_n * sigma_n;
    ensure!(
        rest == four * mu * (lambda + mu) * tt * tt + four * mu * (lambda + two * mu) * nt * nt
    );
    ensure!(mu * (lambda + mu) > zero && mu * (lambda + two * mu) > zero);
    ensure!(mu * (lambda + mu) * (tt * tt) >= zero);
    ensure!(mu * (lambda + two * mu) * (nt * nt) >= zero);
    ensure!(sigma_n * sigma_n <= left);
    Verdict::Holds("always")
}

/// |n|^4 (lambda + 2 mu) sigma:eps >= sigma_n^2 for every n.
pub fn normal_stress_is_bounded_by_the_energy<S: Ordered>(v: [S; 8]) -> Verdict {
    let n = Vector2::new(v[4], v[5]);
    bounded(v, |material| material.normal_stiffness(n))
}

/// A strain along the normal attains it: the constant can't be smaller.
pub fn the_constant_is_attained_by_a_strain_along_the_normal<S: Ordered>(
    [c, nx, ny, lambda, mu]: [S; 5],
) -> Verdict {
    given!(nx * nx + ny * ny == S::from(1));
    let material = Material::lame(lambda, mu, Plane::Strain);
    let g = gradient([c * nx * nx, c * nx * ny, c * nx * ny, c * ny * ny]);
    let stress = material.stress(g);
    let n = Vector2::new(nx, ny);
    let sigma_n = stress.normal(n);
    ensure!(sigma_n * sigma_n == material.normal_stiffness(n) * energy_density(stress, g));
    Verdict::Holds("always")
}

/// Plane stress is plane strain with lambda* = 2 lambda mu / (lambda + 2 mu), for which the inequality holds too: its
/// constant is 4 mu (lambda + mu)/(lambda + 2 mu), and lambda* + mu > 0 if 3 lambda + 2 mu > 0. sigma_zz and the von
/// Mises stress belong to it.
pub fn plane_stress_has_its_own_lambda<S: Ordered>([lambda, mu, xx, yy, xy]: [S; 5]) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(mu > zero && S::from(3) * lambda + two * mu > zero);
    ensure!(lambda + two * mu > zero);
    let material = Material::lame(lambda, mu, Plane::Stress);
    let star = two * lambda * mu / (lambda + two * mu);
    ensure!(material.lambda() == star && material.mu() == mu);
    let constant = material.normal_stiffness(Vector2::<S>::y()) * (lambda + two * mu);
    ensure!(constant == S::from(4) * mu * (lambda + mu));
    ensure!((star + mu) * (lambda + two * mu) == mu * (S::from(3) * lambda + two * mu));
    ensure!((star + mu) * (lambda + two * mu) > zero);
    ensure!(star + mu > zero);
    let stress = Stress::new([xx, yy, xy]);
    ensure!(material.stress_zz(stress) == zero);
    let mises = xx * xx - xx * yy + yy * yy + S::from(3) * xy * xy;
    ensure!(material.von_mises_squared(stress) == mises);
    Verdict::Holds("always")
}

/// The trace inequality on an edge with the ends b, c of the triangle with the values a, b, c of an affine w:
/// |w|_E^2 = |E| (b^2 + b c + c^2)/3, |w|_T^2 = |T| (a^2 + b^2 + c^2 + a b + b c + c a)/6.
fn trace_inequality<S: Ordered>([a, b, c]: [S; 3], constant: S) -> Verdict {
    let edge = (b * b + b * c + c * c) / S::from(3);
    let triangle = (a * a + b * b + c * c + a * b + b * c + c * a) / S::from(6);
    ensure!(edge <= constant * triangle);
    Verdict::Holds("always")
}

/// c_2 = 3 for P2, whose stress is affine; c_1 = 1 for P1, whose stress is constant.
pub fn trace_inequality_holds_with_the_constants_of_p1_and_p2<S: Ordered>(
    [a, b, c]: [S; 3],
) -> Verdict {
    let constant = trace_inequality([a, a, a], S::from(<P1 as Element<3, 2>>::TRACE_CONSTANT));
    ensure!(!constant.fails());
    trace_inequality([a, b, c], S::from(<P2 as Element<6, 3>>::TRACE_CONSTANT))
}

/// w = 1 on the edge and -1 at the opposite vertex attains it: 3 can't be smaller.
pub fn the_trace_constant_of_p2_is_attained<S: Ordered>([b]: [S; 1]) -> Verdict {
    given!(b > S::from(0) || b < S::from(0));
    let c = S::from(<P2 as Element<6, 3>>::TRACE_CONSTANT);
    let triangle = (S::from(3) * b * b - b * b) / S::from(6);
    ensure!(b * b == c * triangle);
    Verdict::Holds("always")
}

/// Coercivity from (11), as in the proof: a - s >= (1 - kappa) a if s <= kappa a.
pub fn the_trace_bound_gives_coercivity<S: Ordered>([a, s, kappa]: [S; 3]) -> Verdict {
    given!(s <= kappa * a);
    ensure!(a - s >= (S::from(1) - kappa) * a);
    Verdict::Holds("always")
}

/// lambda + mu in place of lambda + 2 mu.
pub fn control_lambda_plus_mu_for_the_stiffness<S: Ordered>(
    [xx, xy, yx, yy, lambda, mu]: [S; 6],
) -> Verdict {
    let zero = S::from(0);
    given!(mu > zero && lambda + mu > zero);
    let g = gradient([xx, xy, yx, yy]);
    let stress = Material::lame(lambda, mu, Plane::Strain).stress(g);
    let [_, yy, _] = stress.components();
    ensure!(yy * yy <= (lambda + mu) * energy_density(stress, g));
    Verdict::Holds("always")
}

/// c_2 = 2 in place of 3.
pub fn control_smaller_trace_constant<S: Ordered>(v: [S; 3]) -> Verdict {
    trace_inequality(v, S::from(2))
}

/// -1, 0 or 1
fn unit() -> Whole {
    Whole(i32::from(any::<bool>()) - i32::from(any::<bool>()))
}

/// sigma_n^2, A_nnnn and sigma:eps of a gradient with entries -1, 0 and 1, across the first axis or the second.
fn normal_stress() -> [Whole; 3] {
    let (zero, one) = (Whole(0), Whole(1));
    let material = Material::lame(Whole(i32::from(any::<bool>())), one, Plane::Strain);
    let n = if any() { Vector2::new(zero, -one) } else { Vector2::new(one, zero) };
    let g = Matrix2::new(unit(), unit(), unit(), unit());
    let stress = material.stress(g);
    let normal = stress.normal(n);
    [normal * normal, material.normal_stiffness(n), energy_density(stress, g)]
}

harnesses! {
    /// What (11) and coercivity rest on: sigma_n(v)^2 <= A_nnnn sigma(v):eps(v), by the kernel's law.
    holds normal_stress_is_bounded_by_the_energy_for_gradients_within_1() {
        let [square, stiffness, energy] = normal_stress();
        assert!(square <= stiffness * energy);
    }
    /// The false twin: half of the constant. The gradient e_n (x) e_n attains it.
    fails control_normal_stress_with_half_the_constant_for_gradients_within_1([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]) {
        let [square, stiffness, energy] = normal_stress();
        assert!(Whole(2) * square <= stiffness * energy);
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row;
