//! What real parts need beyond the paper: the direction of contact as a field n~ (docs/theory.md, 2.1), several materials, and
//! the recovered pressure (docs/parts.md).
//!
//! At a point |n~ . sigma n|^2 <= (lambda + 2 mu) sigma:eps for all unit n~, n, for with t the normal turned by a right angle
//! and vectors of any length
//!
//! ```text
//! (n~ . sigma n)^2 + (n~ x sigma n)^2 = |n~|^2 |sigma n|^2
//! (lambda + 2 mu) |n|^4 sigma:eps - |n|^2 |sigma n|^2 = 4 mu (lambda + mu) (eps_tt^2 + eps_nt^2)
//! ```
//!
//! On an edge along which n~ turns by an angle with the cosine c, int s^2 <= (2 - c) int |sigma n|^2 for an affine traction.

use proptest::prelude::Strategy;
use signorini::kernel::contact_edge::{coercivity_constant, integral_of_product, turning_factor};
use signorini::kernel::triangle::on_edge;
use signorini::kernel::{ContactEdge, Element, Material, P1, P2, Plane, Stress};
use signorini::nalgebra::{Matrix2, Vector2};

use props::bodies::{Body, Definition, Draw, bodies, sum};
use props::claim::Outcome;
use props::draws;
use props::numbers::Exact;
use props::proof::{prove, refute};
use props::statement::take;
use props::verdict::{Ordered, Verdict};
use props::{ensure, given, statement};

// The direction of contact, at a point.

fn energy_density<S: Ordered>(stress: Stress<S>, g: Matrix2<S>) -> S {
    let [xx, yy, xy] = stress.components();
    xx * g.m11 + yy * g.m22 + xy * (g.m12 + g.m21)
}

/// The functional n~ . sigma(v) n of one shape function, and sigma_n where n~ = n is a unit vector.
pub fn traction_of_a_shape_is_d_sigma_n<S: Ordered>(
    [gx, gy, vx, vy, nx, ny, dx, dy, lambda, mu]: [S; 10],
) -> Verdict {
    let material = Material::lame(lambda, mu, Plane::Strain);
    let (g, n, d) = (Vector2::new(gx, gy), Vector2::new(nx, ny), Vector2::new(dx, dy));
    let stress = material.stress(Matrix2::new(vx * gx, vx * gy, vy * gx, vy * gy));
    let traction = stress.traction(n);
    let functional = material.traction_of_shape(g, n, d);
    ensure!(functional[0] * vx + functional[1] * vy == traction[0] * dx + traction[1] * dy);
    given!(nx * nx + ny * ny == S::from(1));
    let (along, normal) =
        (material.traction_of_shape(g, n, n), material.normal_stress_of_shape(g, n));
    ensure!(along[0] == normal[0]);
    ensure!(along[1] == normal[1]);
    Verdict::Holds("always")
}

/// d x sigma n, and eps_tt and eps_nt times |n|^2.
fn across_and_strains<S: Ordered>([xx, xy, yx, yy, nx, ny, dx, dy, lambda, mu]: [S; 10]) -> [S; 3] {
    let two = S::from(2);
    let stress = Material::lame(lambda, mu, Plane::Strain).stress(Matrix2::new(xx, xy, yx, yy));
    let traction = stress.traction(Vector2::new(nx, ny));
    let exy = (xy + yx) / two;
    [
        dx * traction[1] - dy * traction[0],
        ny * ny * xx - two * nx * ny * exy + nx * nx * yy,
        nx * ny * (yy - xx) + (nx * nx - ny * ny) * exy,
    ]
}

/// |n|^2 (d . sigma n)^2 <= |d|^2 (lambda + 2 mu) |n|^4 sigma:eps, d being n~. lambda is the coefficient in the plane: in plane
/// stress lambda*, for which row 9 has lambda* + mu > 0.
pub fn traction_along_any_direction_is_bounded_by_the_energy<S: Ordered>(v: [S; 10]) -> Verdict {
    let (zero, four) = (S::from(0), S::from(4));
    let [xx, xy, yx, yy, nx, ny, dx, dy, lambda, mu] = v;
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let g = Matrix2::new(xx, xy, yx, yy);
    let stress = material.stress(g);
    let traction = stress.traction(Vector2::new(nx, ny));
    let (tx, ty) = (traction[0], traction[1]);
    let [across, tt, nt] = across_and_strains(v);
    let (n, d) = (nx * nx + ny * ny, dx * dx + dy * dy);
    let along = dx * tx + dy * ty;
    let bound = material.normal_stiffness(Vector2::new(nx, ny)) * n * n * energy_density(stress, g);
    let whole = n * (tx * tx + ty * ty);
    ensure!(along * along + across * across == d * (tx * tx + ty * ty));
    ensure!(bound - whole == four * mu * (lambda + mu) * (tt * tt + nt * nt));
    ensure!(mu * (lambda + mu) > zero);
    ensure!(mu * (lambda + mu) * (tt * tt) >= zero);
    ensure!(mu * (lambda + mu) * (nt * nt) >= zero);
    ensure!(whole <= bound);
    ensure!(n >= zero && d >= zero);
    ensure!(across * across >= zero);
    ensure!(n * (across * across) >= zero);
    ensure!(n * (along * along) <= d * whole);
    ensure!(d * whole <= d * bound);
    ensure!(n * (along * along) <= d * bound);
    Verdict::Holds("always")
}

/// mu in place of lambda + 2 mu.
pub fn control_shear_modulus_for_the_stiffness<S: Ordered>(
    [xx, yy, dx, dy, lambda, mu]: [S; 6],
) -> Verdict {
    let zero = S::from(0);
    given!(mu > zero && lambda + mu > zero);
    let g = Matrix2::new(xx, zero, zero, yy);
    let stress = Material::lame(lambda, mu, Plane::Strain).stress(g);
    let traction = stress.traction(Vector2::new(S::from(1), zero));
    let along = dx * traction[0] + dy * traction[1];
    ensure!(along * along <= (dx * dx + dy * dy) * mu * energy_density(stress, g));
    Verdict::Holds("always")
}

// The direction of contact, on an edge.

/// s_0^2 + s_0 s_1 + s_1^2 against |t_0|^2 + t_0.t_1 + |t_1|^2, of which the integrals are thirds: t_0 = (a, b) in the basis
/// (n~_0, n~_0 turned left), t_1 with the components s_1 = t_1 . n~_1 and r across; n~_1 = (c, s).
fn edge_forms<S: Ordered>([a, b, s1, r, c, s]: [S; 6]) -> [S; 2] {
    let (e, f) = (c * s1 - s * r, s * s1 + c * r);
    [a * a + a * s1 + s1 * s1, a * a + b * b + a * e + b * f + e * e + f * f]
}

/// What is squared in the difference.
fn squared<S: Ordered>([a, b, s1, r, c, s]: [S; 6]) -> [S; 3] {
    let (two, four) = (S::from(2), S::from(4));
    let second = (four - c * c) * r - s * (two * a + c * s1);
    [two * b + c * r + s * s1, second, a - s1]
}

/// Lemma 2.1b: (2 - c) of the second is not below the first; the difference is a sum of squares.
pub fn traction_along_a_turning_direction_is_bounded_by_its_factor<S: Ordered>(
    [a, b, s1, r, c, s]: [S; 6],
) -> Verdict {
    let (zero, one, two, four) = (S::from(0), S::from(1), S::from(2), S::from(4));
    given!(c * c + s * s == one);
    given!(c >= zero && c <= one);
    let [along, whole] = edge_forms([a, b, s1, r, c, s]);
    let factor = turning_factor::<P2, S, 6, 3>(c);
    ensure!(factor == two - c);
    let q = four - c * c;
    let [first, second, third] = squared([a, b, s1, r, c, s]);
    let squares = factor * (q * (first * first) + second * second)
        + four * (factor * (one - c)) * (third * third);
    ensure!(four * q * (factor * whole - along) == squares);
    ensure!(factor > zero);
    ensure!(q > zero);
    ensure!(factor * q > zero);
    ensure!(factor * (one - c) >= zero);
    ensure!(factor * q * (first * first) >= zero);
    ensure!(factor * (second * second) >= zero);
    ensure!(factor * (one - c) * (third * third) >= zero);
    ensure!(squares >= zero);
    // Divided by 4 q > 0 it is the bound.
    ensure!(q * (factor * whole - along) >= zero);
    Verdict::Holds("always")
}

/// The factor is attained, at s_0 = s_1 = (2 - c) w: it can't be smaller.
pub fn the_turning_factor_is_attained<S: Ordered>([w, c, s]: [S; 3]) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(c * c + s * s == one);
    given!(c >= zero && c <= one);
    given!(w > S::from(0) || w < S::from(0));
    let a = (two - c) * w;
    let r = s * w;
    let b = -(c * r + s * a) / two;
    let [along, whole] = edge_forms([a, b, a, r, c, s]);
    ensure!(along == S::from(3) * a * a);
    ensure!(along == turning_factor::<P2, S, 6, 3>(c) * whole);
    Verdict::Holds("always")
}

/// For a constant traction (P1) the factor is 1.
pub fn traction_of_p1_needs_no_factor<S: Ordered>([a, b, c, s]: [S; 4]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(c * c + s * s == one);
    given!(c >= zero && c <= one);
    let s1 = a * c + b * s;
    let [along, whole] = edge_forms([a, b, s1, b * c - a * s, c, s]);
    ensure!(whole == S::from(3) * (a * a + b * b));
    ensure!(s1 * s1 + (b * c - a * s) * (b * c - a * s) == a * a + b * b);
    ensure!(s1 * s1 <= a * a + b * b);
    ensure!(a * a <= a * a + b * b);
    ensure!((a - s1) * (a - s1) >= zero);
    ensure!(along <= turning_factor::<P1, S, 3, 2>(c) * whole);
    Verdict::Holds("always")
}

/// The factor 1 where the direction turns.
pub fn control_no_factor_for_a_turning_direction<S: Ordered>(
    [a, b, s1, r, c, s]: [S; 6],
) -> Verdict {
    given!(c * c + s * s == S::from(1));
    given!(c >= S::from(0) && c <= S::from(1));
    let [along, whole] = edge_forms([a, b, s1, r, c, s]);
    ensure!(along <= whole);
    Verdict::Holds("always")
}

// The direction of contact, on bodies.

/// Directions at the nodes of a side: its normal, turned by what the drawn field says.
fn directions<const M: usize>(body: &Body, e: usize) -> [[Exact; 2]; M] {
    let ([nx, ny], drawn) = (body.contact[e].n, body.drawn(1));
    std::array::from_fn(|a| {
        let [c, s] = (drawn[(3 * e + a) % drawn.len()][0] / Exact::from(8)).on_circle();
        [c * nx - s * ny, s * nx + c * ny]
    })
}

fn along<E: Element<N, M>, const N: usize, const M: usize>(
    body: &Body,
    e: usize,
    directions: &[[Exact; 2]; M],
) -> ContactEdge<Exact, N, M> {
    let side = &body.contact[e];
    let directions = directions.map(Vector2::from);
    let (triangle, gamma) = (body.triangle(side.triangle), body.gamma(side));
    ContactEdge::along::<E>(
        &triangle,
        side.local,
        side.n.into(),
        &directions,
        &body.material,
        gamma,
    )
}

fn applied<const N: usize>(functional: &[Vector2<Exact>; N], v: &[[Exact; 2]; N]) -> Exact {
    sum(functional.iter().zip(v), |(f, v)| f[0] * v[0] + f[1] * v[1])
}

/// P0 and s of the kernel are n~ . v - gamma s and n~ . sigma(v) n, from stress and displacement by their definitions; with
/// n~ = n they are the paper's.
fn functionals_agree<E: Element<N, M>, const N: usize, const M: usize>(body: &Body) -> Verdict {
    for (e, side) in body.contact.iter().enumerate() {
        let v = body.local::<N>(side.triangle, &body.drawn(0));
        let directions = directions::<M>(body, e);
        let edge = along::<E, N, M>(body, e, &directions);
        let triangle = body.triangle(side.triangle);
        let barycentric = triangle.barycentric_gradients();
        let s_at = |a: usize| {
            let gradients = E::gradients(on_edge(side.local, Exact::from(a as i32)), barycentric);
            let d = |i: usize, j: usize| sum(0..N, |k| v[k][i] * gradients[k][j]);
            let gradient = Matrix2::new(d(0, 0), d(0, 1), d(1, 0), d(1, 1));
            let traction = body.material.stress(gradient).traction(side.n.into());
            directions[a][0] * traction[0] + directions[a][1] * traction[1]
        };
        let s = [s_at(0), s_at(1)];
        for a in 0..2 {
            ensure!(applied(&edge.sigma_n[a], &v) == s[a]);
        }
        for (a, (node, at)) in
            E::edge_nodes(side.local).into_iter().zip(E::edge_positions()).enumerate()
        {
            let u_n = directions[a][0] * v[node][0] + directions[a][1] * v[node][1];
            let stress = (Exact::from(1) - at) * s[0] + at * s[1];
            ensure!(applied(&edge.p0[a], &v) == u_n - body.gamma(side) * stress);
        }
        let paper = ContactEdge::<Exact, N, M>::new::<E>(
            &triangle,
            side.local,
            side.n.into(),
            &body.material,
            body.gamma(side),
        );
        let same = along::<E, N, M>(body, e, &[side.n; M]);
        ensure!(paper.p0 == same.p0 && paper.sigma_n == same.sigma_n);
    }
    Verdict::Holds("always")
}

/// (11) with the turned directions: gamma |s(v)|^2 on the contact edges of a triangle against kappa_T a_T(v, v), each edge
/// counted `factor(cosine)` times. Where A is not isotropic, the largest eigenvalue of Q(n) need not be rational.
fn coercive_along<E: Element<N, M>, const N: usize, const M: usize>(body: &Body) -> Verdict {
    let definition = Definition::<N>(body);
    let v = body.drawn(0);
    for t in 0..body.triangles.len() {
        let (mut left, mut length) = (Exact::from(0), Exact::from(0));
        for (e, side) in body.contact.iter().enumerate().filter(|(_, side)| side.triangle == t) {
            let directions = directions::<M>(body, e);
            let cosine = directions[0][0] * directions[1][0] + directions[0][1] * directions[1][1];
            given!(cosine >= Exact::from(0));
            let edge = along::<E, N, M>(body, e, &directions);
            let local = body.local::<N>(t, &v);
            let s = [0, 1].map(|a| applied(&edge.sigma_n[a], &local));
            left += body.gamma(side) * side.length * integral_of_product(s, s);
            length += turning_factor::<E, Exact, N, M>(cosine) * side.length;
        }
        let area = body.triangle(t).double_area() / Exact::from(2);
        let h = body.diameters[t];
        let stiffness = body.material.normal_stiffness(Vector2::y());
        let constant = coercivity_constant::<E, Exact, N, M>(stiffness, h, length, area);
        ensure!(left <= body.gamma0 * constant * definition.a_on(t, &v, &v));
    }
    Verdict::Holds("always")
}

fn two_fields() -> impl Strategy<Value = Draw> {
    bodies(2)
}

fn functionals_are_their_definitions() -> Outcome {
    draws::hold(40, two_fields(), &["always"], |draw| functionals_agree::<P1, 3, 2>(&draw.body()))?;
    draws::hold(15, two_fields(), &["always"], |draw| functionals_agree::<P2, 6, 3>(&draw.body()))
}

fn the_bound_11_holds() -> Outcome {
    draws::hold(60, two_fields(), &["always"], |draw| {
        coercive_along::<P1, 3, 2>(&draw.isotropic().body())
    })?;
    draws::hold(20, two_fields(), &["always"], |draw| {
        coercive_along::<P2, 6, 3>(&draw.isotropic().body())
    })
}

// Materials.

/// A bar of two materials held at its sides: the stress along it is the pressure in both, and each part has no shear.
pub fn a_bar_of_two_materials_has_one_pressure<S: Ordered>(
    [p, lambda, mu, other, nu]: [S; 5],
) -> Verdict {
    let zero = S::from(0);
    given!(mu > zero && lambda + mu > zero && nu > zero && other + nu > zero);
    let stress_in = |material: Material<S>| {
        let strain = -p / material.normal_stiffness(Vector2::<S>::y());
        material.stress(Matrix2::new(zero, zero, zero, strain)).components()
    };
    ensure!(lambda + S::from(2) * mu > zero && other + S::from(2) * nu > zero);
    let (first, second) =
        (Material::lame(lambda, mu, Plane::Strain), Material::lame(other, nu, Plane::Strain));
    ensure!(first.plane() == second.plane());
    let [_, below, shear] = stress_in(first);
    let [_, above, other_shear] = stress_in(second);
    ensure!(below == -p && above == -p);
    ensure!(shear == zero && other_shear == zero);
    Verdict::Holds("always")
}

// The recovered pressure.

/// The hat functions of a half edge add up to one and are not negative: so the nodal means have the integral of what they
/// are means of, and lie within its bounds. With weights w and values v >= 0 of two points at s and t.
pub fn means_by_hats_keep_integral_and_bounds<S: Ordered>([s, t, v, w, m]: [S; 5]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(s >= zero && s <= one && t >= zero && t <= one);
    given!(v >= zero && w >= zero && v <= m && w <= m);
    let works = [(one - s) * v + (one - t) * w, s * v + t * w];
    let weights = [(one - s) + (one - t), s + t];
    ensure!(works[0] + works[1] == v + w);
    ensure!((one - s) * v >= zero && (one - t) * w >= zero && s * v >= zero && t * w >= zero);
    ensure!((one - s) * (m - v) >= zero && (one - t) * (m - w) >= zero);
    ensure!(s * (m - v) >= zero && t * (m - w) >= zero);
    for (work, weight) in works.into_iter().zip(weights) {
        ensure!(work >= zero);
        ensure!(work <= m * weight);
    }
    Verdict::Holds("always")
}

checks! {
    traction_of_a_shape_is_d_sigma_n => prove(&statement!(traction_of_a_shape_is_d_sigma_n, [gx, gy, vx, vy, nx, ny, dx, dy, lambda, mu], ["always"]));
    traction_along_any_direction_is_bounded_by_the_energy => prove(&statement!(traction_along_any_direction_is_bounded_by_the_energy, [xx, xy, yx, yy, nx, ny, dx, dy, lambda, mu], ["always"]).with_hints(|v| across_and_strains(take(v)).to_vec()));
    traction_along_a_turning_direction_is_bounded_by_its_factor => prove(&statement!(traction_along_a_turning_direction_is_bounded_by_its_factor, [a, b, s1, r, c, s], ["always"]).with_hints(|v| squared(take(v)).to_vec()));
    the_turning_factor_is_attained => prove(&statement!(the_turning_factor_is_attained, [a, c, s], ["always"]));
    traction_of_p1_needs_no_factor => prove(&statement!(traction_of_p1_needs_no_factor, [a, b, c, s], ["always"]).with_hints(|v| { let [a, b, c, s] = take(v); vec![a - (a * c + b * s), b * c - a * s] }));
    a_bar_of_two_materials_has_one_pressure => prove(&statement!(a_bar_of_two_materials_has_one_pressure, [p, lambda, mu, other, nu], ["always"]));
    means_by_hats_keep_integral_and_bounds => prove(&statement!(means_by_hats_keep_integral_and_bounds, [s, t, v, w, m], ["always"]));
    control_shear_modulus_for_the_stiffness => refute(&statement!(control_shear_modulus_for_the_stiffness, [xx, yy, dx, dy, lambda, mu], fails "along * along <= (dx * dx + dy * dy) * mu * energy_density(stress, g)"));
    control_no_factor_for_a_turning_direction => refute(&statement!(control_no_factor_for_a_turning_direction, [a, b, s1, r, c, s], fails "along <= whole"));
    functionals_along_directions_are_their_definitions_and_with_n_the_papers => functionals_are_their_definitions();
    bound_11_holds_along_turning_directions => the_bound_11_holds();
}
