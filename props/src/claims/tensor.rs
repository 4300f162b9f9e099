//! Lemma 3.2 and (11) for any tensor A of section 2.1, at a point: its stress, its energies, and the constant of the traction.
//!
//! With w = e : A e for the symmetric part e of d (x) n, and z = e : A eps = d . sigma n, the strain y = w eps - z e has
//!
//! ```text
//! y : A y = w (w sigma:eps - z^2)
//! ```
//!
//! so that z^2 <= w sigma:eps where A is positive (the inequality of Cauchy and Schwarz in A), with equality for eps = e. w is
//! d . Q(n) d with the acoustic tensor Q(n), and A_nnnn for d = n; over unit vectors d it is at most the largest eigenvalue of
//! Q(n).

use signorini::kernel::Material;
use signorini::kernel::contact_edge::traction_stiffness;
use signorini::nalgebra::{Matrix2, Vector2};

use crate::bodies::square;
use crate::claim::Check;
use crate::numbers::Exact;
use crate::statement::take;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

/// eps_xx, eps_yy and 2 eps_xy
pub type Strain<S> = [S; 3];

/// a : A b
pub fn form<S: Ordered>([c11, c12, c16, c22, c26, c66]: [S; 6], a: Strain<S>, b: Strain<S>) -> S {
    a[0] * (c11 * b[0] + c12 * b[1] + c16 * b[2])
        + a[1] * (c12 * b[0] + c22 * b[1] + c26 * b[2])
        + a[2] * (c16 * b[0] + c26 * b[1] + c66 * b[2])
}

/// The symmetric part of d (x) n.
fn strain_along<S: Ordered>(d: [S; 2], n: [S; 2]) -> Strain<S> {
    [d[0] * n[0], d[1] * n[1], d[0] * n[1] + d[1] * n[0]]
}

/// The gradient of a displacement with this strain.
pub fn gradient<S: Ordered>([xx, yy, twice]: Strain<S>) -> Matrix2<S> {
    Matrix2::new(xx, twice, S::from(0), yy)
}

/// The law with these coefficients.
pub fn tensor<S: Ordered>(c: &[S]) -> Material<S> {
    Material::tensor(take(&c[..6]), None)
}

/// (1): sigma = A eps; sigma_zz and the von Mises stress, by what the stress in the plane counts across it.
pub fn stress_is_the_tensor_times_the_strain<S: Ordered>(v: [S; 13]) -> Verdict {
    let (c, [xx, xy, yx, yy]): ([S; 6], [S; 4]) = (take(&v[..6]), take(&v[6..10]));
    let [p, q, r]: [S; 3] = take(&v[10..]);
    let material = Material::tensor(c, Some([p, q, r]));
    ensure!(!material.is_isotropic() && material.stiffness() == c);
    ensure!(material.in_plane().stiffness() == c);
    let strain = [xx, yy, xy + yx];
    let stress = material.stress(Matrix2::new(xx, xy, yx, yy));
    let [sxx, syy, sxy] = stress.components();
    let (zero, one) = (S::from(0), S::from(1));
    ensure!(sxx == form(c, [one, zero, zero], strain));
    ensure!(syy == form(c, [zero, one, zero], strain));
    ensure!(sxy == form(c, [zero, zero, one], strain));
    let zz = material.stress_zz(stress);
    ensure!(zz == p * sxx + q * syy + r * sxy);
    ensure!(material.in_plane().stress_zz(stress) == zero);
    let (a, b, c) = (sxx - syy, syy - zz, zz - sxx);
    let twice = a * a + b * b + c * c + S::from(6) * sxy * sxy;
    ensure!(S::from(2) * material.von_mises_squared(stress) == twice);
    Verdict::Holds("always")
}

/// The element matrix and the functionals of one shape function: sigma(e_d N):eps(e_c M), and d . sigma(e_c N) n.
pub fn shapes_of_any_tensor_are_their_definitions<S: Ordered>(v: [S; 14]) -> Verdict {
    let (c, material): ([S; 6], _) = (take(&v[..6]), tensor(&v));
    let [g, h, n, d]: [[S; 2]; 4] = [0, 1, 2, 3].map(|k| [v[6 + 2 * k], v[7 + 2 * k]]);
    let axes = [[1, 0], [0, 1]].map(|e| e.map(S::from));
    let energy = material.energy_of_shapes(g.into(), h.into());
    let along = material.traction_of_shape(g.into(), n.into(), d.into());
    let normal = material.normal_stress_of_shape(g.into(), n.into());
    for (k, &e) in axes.iter().enumerate() {
        let strain = strain_along(e, g);
        ensure!(along[k] == form(c, strain_along(d, n), strain));
        ensure!(normal[k] == form(c, strain_along(n, n), strain));
        for (l, &f) in axes.iter().enumerate() {
            ensure!(energy[(k, l)] == form(c, strain, strain_along(f, h)));
        }
    }
    Verdict::Holds("always")
}

/// d . Q(n) d is the energy of the strain along d and n; A_nnnn for d = n, and what the kernel takes for one direction.
pub fn the_acoustic_tensor_is_the_energy_of_a_strain_along_two_directions<S: Ordered>(
    v: [S; 10],
) -> Verdict {
    let (c, material): ([S; 6], _) = (take(&v[..6]), tensor(&v));
    let [n, d]: [[S; 2]; 2] = [[v[6], v[7]], [v[8], v[9]]];
    let q = material.acoustic(Vector2::from(n));
    let along = form(c, strain_along(d, n), strain_along(d, n));
    ensure!(q.m12 == q.m21);
    ensure!(d[0] * d[0] * q.m11 + S::from(2) * d[0] * d[1] * q.m12 + d[1] * d[1] * q.m22 == along);
    ensure!(traction_stiffness(&material, n.into(), Some(d.into()), |x| x) == along);
    let normal = form(c, strain_along(n, n), strain_along(n, n));
    ensure!(material.normal_stiffness(Vector2::from(n)) == normal);
    Verdict::Holds("always")
}

/// y : A y and w (w sigma:eps - z^2), w sigma:eps, z^2 for a candidate of w = e : A e with e along d and n.
fn apart<S: Ordered>(v: &[S], [d, n]: [[S; 2]; 2], w: S) -> [S; 4] {
    let material = tensor(v);
    let (eps, e): (Strain<S>, _) = (take(&v[6..9]), strain_along(d, n));
    let energy = |strain: Strain<S>| form(material.stiffness(), strain, strain);
    let traction = material.stress(gradient(eps)).traction(n.into());
    let z = d[0] * traction[0] + d[1] * traction[1];
    let y = [0, 1, 2].map(|k| w * eps[k] - z * e[k]);
    [energy(y), w * (w * energy(eps) - z * z), w * energy(eps), z * z]
}

/// y : A y = w (w sigma:eps - z^2).
pub fn a_strain_has_this_energy_without_its_part_along_two_directions<S: Ordered>(
    v: [S; 13],
) -> Verdict {
    let [n, d] = [[v[9], v[10]], [v[11], v[12]]];
    let w = traction_stiffness(&tensor(&v), n.into(), Some(d.into()), |x| x);
    let [energy, rest, ..] = apart(&v, [d, n], w);
    ensure!(energy == rest);
    Verdict::Holds("always")
}

/// z^2 <= w sigma:eps where that is not negative.
pub fn an_energy_that_is_not_negative_bounds_the_traction<S: Ordered>(
    [w, energy, z]: [S; 3],
) -> Verdict {
    given!(w > S::from(0) && w * (w * energy - z * z) >= S::from(0));
    ensure!(z * z <= w * energy);
    Verdict::Holds("always")
}

/// Both together, for an A that is not negative on y: (d . sigma n)^2 <= d . Q(n) d sigma:eps.
pub fn traction_along_a_direction_is_bounded_by_the_energy_of_any_tensor<S: Ordered>(
    v: [S; 13],
) -> Verdict {
    let [n, d] = [[v[9], v[10]], [v[11], v[12]]];
    let w = traction_stiffness(&tensor(&v), n.into(), Some(d.into()), |x| x);
    let [energy, _, bound, square] = apart(&v, [d, n], w);
    given!(w > S::from(0) && energy >= S::from(0));
    ensure!(square <= bound);
    Verdict::Holds("always")
}

/// A strain along d and n attains it: the constant can't be smaller.
pub fn the_constant_of_any_tensor_is_attained<S: Ordered>(v: [S; 11]) -> Verdict {
    let material = tensor(&v);
    let [n, d, [c, _]] = [[v[6], v[7]], [v[8], v[9]], [v[10], v[10]]];
    let eps = strain_along(d, n).map(|e| c * e);
    let traction = material.stress(gradient(eps)).traction(n.into());
    let z = d[0] * traction[0] + d[1] * traction[1];
    let w = traction_stiffness(&material, n.into(), Some(d.into()), |x| x);
    ensure!(z * z == w * form(material.stiffness(), eps, eps));
    Verdict::Holds("always")
}

/// n = e_x, for which Q(n) is any symmetric matrix: C11 and C66, C16.
fn with_acoustic<S: Ordered>([c11, c16, c66]: [S; 3]) -> Material<S> {
    let zero = S::from(0);
    Material::tensor([c11, zero, c16, zero, zero, c66], None)
}

/// r |d|^2 - (d . Q d - tr Q/2 |d|^2) is not negative, because their squares differ by that of this number.
fn across<S: Ordered>([c11, c16, c66, dx, dy]: [S; 5]) -> S {
    let two = S::from(2);
    (c11 - c66) / two * (two * dx * dy) - c16 * (dx * dx - dy * dy)
}

/// What the kernel takes where the direction turns, c = tr Q/2 + r, with the root r of the number that it takes the root of: the square
/// of half the difference of Q's diagonal and of its shear. Nothing where r is not that root.
fn largest_eigenvalue<S: Ordered>(material: &Material<S>, r: S) -> Option<S> {
    let taken = |root: &dyn Fn(S) -> S| traction_stiffness(material, Vector2::x(), None, root);
    let (mean, half_sum) = (taken(&|_| S::from(0)), taken(&|square| square));
    (r >= S::from(0) && r * r == half_sum - mean).then(|| taken(&|_| r))
}

/// d . Q d <= c |d|^2: c is the largest eigenvalue of Q.
pub fn no_direction_has_more_than_the_largest_eigenvalue<S: Ordered>(
    [c11, c16, c66, dx, dy, r]: [S; 6],
) -> Verdict {
    let (two, zero) = (S::from(2), S::from(0));
    let half = (c11 - c66) / two;
    given!(r >= zero && r * r == half * half + c16 * c16);
    let material = with_acoustic([c11, c16, c66]);
    let q = material.acoustic(Vector2::<S>::x());
    ensure!(q == Matrix2::new(c11, c16, c16, c66));
    let largest = largest_eigenvalue(&material, r);
    ensure!(largest.is_some());
    let largest = largest.unwrap_or(zero);
    ensure!(largest == (c11 + c66) / two + r);
    let square = dx * dx + dy * dy;
    let part = half * (dx * dx - dy * dy) + c16 * (two * dx * dy);
    let other = across([c11, c16, c66, dx, dy]);
    ensure!(part * part + other * other == r * r * (square * square));
    ensure!(square >= zero);
    ensure!(r * square >= zero);
    ensure!(other * other >= zero);
    ensure!(part <= r * square);
    let of_d = c11 * dx * dx + two * c16 * dx * dy + c66 * dy * dy;
    ensure!(of_d <= largest * square);
    Verdict::Holds("always")
}

/// |sigma n|^2 <= c sigma:eps, from d = sigma n in the two before: t = |d|^2 has t^2 <= d . Q d sigma:eps and d . Q d <= c t. Q and c are
/// the kernel's.
pub fn the_whole_traction_is_bounded_by_the_largest_eigenvalue<S: Ordered>(
    [c11, c16, c66, dx, dy, energy, r]: [S; 7],
) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(energy >= zero);
    let material = with_acoustic([c11, c16, c66]);
    let Some(c) = largest_eigenvalue(&material, r) else { return Verdict::Vacuous };
    given!(c >= zero);
    let q = material.acoustic(Vector2::<S>::x());
    let of_d = dx * dx * q.m11 + two * dx * dy * q.m12 + dy * dy * q.m22;
    let t = dx * dx + dy * dy;
    given!(t * t <= of_d * energy);
    given!(of_d <= c * t);
    ensure!(of_d * energy <= c * t * energy);
    ensure!(t <= c * energy);
    Verdict::Holds("always")
}

/// A positive tensor on the horizontal edge, n = e_y, with another constant than A_nnnn.
fn bounded_by<S: Ordered>(v: [S; 9], constant: impl Fn(&Material<S>) -> S) -> Verdict {
    let zero = S::from(0);
    let c = square(take(&v[..6]));
    let (material, eps): (_, Strain<S>) = (Material::tensor(c, None), take(&v[6..]));
    given!(v[0] > zero && v[2] > zero && v[5] > zero);
    let [_, yy, _] = material.stress(gradient(eps)).components();
    ensure!(yy * yy <= constant(&material) * form(c, eps, eps));
    Verdict::Holds("always")
}

/// lambda + 2 mu of the isotropic law nearest to A for A_nnnn.
pub fn control_lambda_plus_two_mu_of_the_nearest_law<S: Ordered>(v: [S; 9]) -> Verdict {
    bounded_by(v, |material| material.lambda() + S::from(2) * material.mu())
}

/// The smaller eigenvalue of Q(n) for the largest: half its trace.
pub fn control_half_the_trace_of_the_acoustic_tensor<S: Ordered>(v: [S; 9]) -> Verdict {
    bounded_by(v, |material| {
        let q = material.acoustic(Vector2::<S>::y());
        (q.m11 + q.m22) / S::from(2)
    })
}

/// A rational root: half the difference and the shear are the legs of a right-angled triangle.
fn with_a_root(v: &mut [Exact]) {
    let (p, q, two) = (v[0], v[1], Exact::from(2));
    v[0] = v[2] + two * (p * p - q * q);
    v[1] = two * p * q;
    v[5] = p * p + q * q;
}

/// The same with the root behind an energy that is large enough.
fn with_a_root_at_the_end(v: &mut [Exact]) {
    let mut six = [v[0], v[1], v[2], v[3], v[4], v[6]];
    with_a_root(&mut six);
    v[2] = v[2].abs();
    six[2] = v[2];
    with_a_root(&mut six);
    (v[0], v[1], v[6]) = (six[0], six[1], six[5]);
    v[5] = v[5].abs() * Exact::from(100);
}

/// The checks of row 9 about tensors.
pub fn checks() -> Vec<Check> {
    statements! {
        proved + tested stress_is_the_tensor_times_the_strain[c11, c12, c16, c22, c26, c66, xx, xy, yx, yy, p, q, r]
            about "(1)";
        proved + tested shapes_of_any_tensor_are_their_definitions[c11, c12, c16, c22, c26, c66, gx, gy, hx, hy, nx, ny, dx, dy];
        proved + tested the_acoustic_tensor_is_the_energy_of_a_strain_along_two_directions[c11, c12, c16, c22, c26, c66, nx, ny, dx, dy];
        tested traction_along_a_direction_is_bounded_by_the_energy_of_any_tensor[c11, c12, c16, c22, c26, c66, xx, yy, xy, nx, ny, dx, dy];
        proved + tested a_strain_has_this_energy_without_its_part_along_two_directions[c11, c12, c16, c22, c26, c66, xx, yy, xy, nx, ny, dx, dy]
            about "Lemma 3.2", "(11)";
        proved + tested an_energy_that_is_not_negative_bounds_the_traction[w, energy, z] about "Lemma 3.2", "(11)";
        proved + tested the_constant_of_any_tensor_is_attained[c11, c12, c16, c22, c26, c66, nx, ny, dx, dy, c]
            about "Lemma 3.2", "(11)";
        proved + tested no_direction_has_more_than_the_largest_eigenvalue[c11, c16, c66, dx, dy, r]
            hints(|v| vec![v[3], v[4], across(take(&v[..5]))]) prepared(with_a_root);
        proved + tested the_whole_traction_is_bounded_by_the_largest_eigenvalue[c11, c16, c66, dx, dy, energy, r]
            prepared(with_a_root_at_the_end);
        refuted control_lambda_plus_two_mu_of_the_nearest_law[l11, l21, l22, l31, l32, l33, xx, yy, xy]
            fails "yy * yy <= constant(&material) * form(c, eps, eps)";
        refuted control_half_the_trace_of_the_acoustic_tensor[l11, l21, l22, l31, l32, l33, xx, yy, xy]
            fails "yy * yy <= constant(&material) * form(c, eps, eps)";
    }
}
