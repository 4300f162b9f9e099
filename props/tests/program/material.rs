//! What the kernel's laws say beside (1) and (11): stresses across the plane, constants of a bar, moduli, energies and turns of a
//! tensor. Each is proved over every ordered field.

use signorini::kernel::{Material, Plane, Squares, Stress};
use signorini::nalgebra::Matrix2;

use props::claims::tensor::{Strain, form, gradient, tensor};
use props::proof::{prove, refute};
use props::statement::take;
use props::verdict::{Ordered, Verdict};
use props::{ensure, given, statement};

/// Plane strain: sigma_zz = lambda tr(eps), and the von Mises stress with it is (3/2) s:s of the deviator s.
pub fn plane_strain_has_a_stress_across_the_plane<S: Ordered>(
    [lambda, mu, exx, eyy, exy]: [S; 5],
) -> Verdict {
    let (zero, two, three) = (S::from(0), S::from(2), S::from(3));
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let stress = material.stress(Matrix2::new(exx, exy, exy, eyy));
    let zz = material.stress_zz(stress);
    ensure!(zz == lambda * (exx + eyy));
    let [xx, yy, xy] = stress.components();
    let mean = (xx + yy + zz) / three;
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    let deviator = a * a + b * b + c * c + two * xy * xy;
    ensure!(two * material.von_mises_squared(stress) == three * deviator);
    Verdict::Holds("always")
}

/// Plane strain without a stress across the plane.
pub fn control_plane_strain_has_no_stress_across_the_plane<S: Ordered>(
    [lambda, mu, exx, eyy]: [S; 4],
) -> Verdict {
    let zero = S::from(0);
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let zz = material.stress_zz(material.stress(Matrix2::new(exx, zero, zero, eyy)));
    ensure!(zz == zero);
    Verdict::Holds("always")
}

/// Young's modulus and Poisson's ratio: the bar that is pulled along x and free across it.
pub fn young_and_poisson_are_those_of_a_bar<S: Ordered>([young, poisson, e]: [S; 3]) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(young > zero && poisson > -one && two * poisson < one);
    let plate = Material::young_poisson(young, poisson, Plane::Strain);
    let (lambda, mu) = (plate.lambda(), plate.mu());
    // sigma = lambda tr I + 2 mu eps in three dimensions, eps = e diag(1, -nu, -nu)
    let trace = e * (one - two * poisson);
    ensure!(lambda * trace + two * mu * e == young * e);
    ensure!(lambda * trace - two * mu * poisson * e == zero);
    Verdict::Holds("always")
}

/// Lamé's coefficients are a tensor, and that tensor's own.
pub fn lambda_and_mu_are_a_tensor<S: Ordered>([lambda, mu, xx, xy, yx, yy]: [S; 6]) -> Verdict {
    let isotropic = Material::lame(lambda, mu, Plane::Strain);
    let tensor = tensor(&isotropic.stiffness());
    ensure!(isotropic.is_isotropic() && isotropic.in_plane() == isotropic);
    ensure!(tensor.lambda() == lambda && tensor.mu() == mu);
    let gradient = Matrix2::new(xx, xy, yx, yy);
    ensure!(tensor.stress(gradient) == isotropic.stress(gradient));
    Verdict::Holds("always")
}

/// The tensor with these K, M, G and L of [`Squares`]: C = T^T L D L^T T, T from (xx, yy, 2 xy) to (xx + yy, xx - yy, 2 xy).
fn of_squares<S: Ordered>([k, m, g, a, b, c]: [S; 6]) -> [S; 6] {
    let columns = [[1, 1, 0], [1, -1, 0], [0, 0, 1]];
    // L^T T, a row each.
    let rows =
        [[S::from(1), a, b], [S::from(0), S::from(1), c], [S::from(0), S::from(0), S::from(1)]];
    let rows = rows.map(|row| {
        [0, 1, 2]
            .map(|j: usize| (0..3).fold(S::from(0), |s, i| s + row[i] * S::from(columns[i][j])))
    });
    let entry = |i: usize, j: usize| {
        k * rows[0][i] * rows[0][j] + m * rows[1][i] * rows[1][j] + g * rows[2][i] * rows[2][j]
    };
    [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)]
}

/// sigma:eps, and a : C^-1 b for stresses a and b, as sums of squares with these moduli.
pub fn the_energies_of_any_tensor_are_sums_of_squares<S: Ordered>(v: [S; 12]) -> Verdict {
    let ([k, m, g, ..], zero): ([S; 6], _) = (take(&v[..6]), S::from(0));
    given!(k > zero && m > zero && g > zero);
    let c = of_squares(take(&v[..6]));
    let squares = Squares { bulk: k, shear: m, beyond: Some((g, [v[3], v[4], v[5]])) };
    let [a, b]: [Strain<S>; 2] = [take(&v[6..9]), take(&v[9..])];
    let material = Material::tensor(c, None);
    let [s, t] = [a, b].map(|strain| material.stress(gradient(strain)));
    let of_a = squares.parts(s);
    ensure!(of_a[2] == S::from(2) * k * (a[0] + a[1] + v[3] * (a[0] - a[1]) + v[4] * a[2]));
    ensure!(squares.per_moduli(squares.products(s, t)) == S::from(4) * form(c, a, b));
    ensure!(squares.of_stress(s) == form(c, a, a));
    Verdict::Holds("always")
}

/// The moduli that the kernel finds are those that the tensor is made of, so that all are positive where A is elliptic.
pub fn the_moduli_of_a_tensor_are_found<S: Ordered>(v: [S; 6]) -> Verdict {
    let ([k, m, g, a, b, c], zero) = (v, S::from(0));
    given!(k > zero && m > zero && g > zero);
    let found = Material::tensor(of_squares(v), None).squares();
    ensure!(found.pivots() == [k, m, g]);
    ensure!(found.beyond == Some((g, [a, b, c])));
    Verdict::Holds("always")
}

/// A symmetric tensor that is turned by the angle with this cosine and sine.
fn turned<S: Ordered>([cos, sin]: [S; 2], [xx, yy, xy]: [S; 3]) -> [S; 3] {
    let twice = S::from(2) * cos * sin * xy;
    [
        cos * cos * xx + sin * sin * yy - twice,
        sin * sin * xx + cos * cos * yy + twice,
        cos * sin * (xx - yy) + (cos * cos - sin * sin) * xy,
    ]
}

/// A body that is turned: the turned strain has the turned stress.
pub fn a_tensor_that_is_turned_has_the_stress_of_before<S: Ordered>(v: [S; 11]) -> Verdict {
    let (c, [xx, yy, xy]): ([S; 6], [S; 3]) = (take(&v[..6]), take(&v[6..9]));
    let (two, by): (_, [S; 2]) = (S::from(2), take(&v[9..]));
    given!(by[0] * by[0] + by[1] * by[1] == S::from(1));
    let material = Material::tensor(c, None);
    let stress = material.stress(gradient([xx, yy, two * xy]));
    let [txx, tyy, txy] = turned(by, [xx, yy, xy]);
    let found = material.turned(by).stress(gradient([txx, tyy, two * txy]));
    ensure!(found == Stress::new(turned(by, stress.components())));
    Verdict::Holds("always")
}

/// The strain that is turned the other way.
pub fn control_a_strain_that_is_turned_the_other_way<S: Ordered>(v: [S; 8]) -> Verdict {
    let (c, [cos, sin]): ([S; 6], [S; 2]) = (take(&v[..6]), take(&v[6..]));
    let (zero, one) = (S::from(0), S::from(1));
    given!(cos * cos + sin * sin == one);
    let material = Material::tensor(c, None);
    let stress = material.stress(gradient([one, zero, zero]));
    let [xx, yy, xy] = turned([cos, -sin], [one, zero, zero]);
    let found = material.turned([cos, sin]).stress(gradient([xx, yy, S::from(2) * xy]));
    ensure!(found == Stress::new(turned([cos, sin], stress.components())));
    Verdict::Holds("always")
}

/// And so has the stress across the plane.
pub fn a_tensor_that_is_turned_has_the_stress_across_the_plane_of_before<S: Ordered>(
    [p, q, r, xx, yy, xy, cos, sin]: [S; 8],
) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(cos * cos + sin * sin == one);
    let material = Material::tensor([one, zero, zero, one, zero, one], Some([p, q, r]));
    let after = Stress::new(turned([cos, sin], [xx, yy, xy]));
    let found = material.turned([cos, sin]).stress_zz(after);
    ensure!(found == material.stress_zz(Stress::new([xx, yy, xy])));
    Verdict::Holds("always")
}

checks! {
    plane_strain_has_a_stress_across_the_plane => prove(&statement!(plane_strain_has_a_stress_across_the_plane, [lambda, mu, exx, eyy, exy], ["always"]));
    control_plane_strain_has_no_stress_across_the_plane => refute(&statement!(control_plane_strain_has_no_stress_across_the_plane, [lambda, mu, exx, eyy], fails "zz == zero"));
    young_and_poisson_are_those_of_a_bar => prove(&statement!(young_and_poisson_are_those_of_a_bar, [young, poisson, e], ["always"]));
    lambda_and_mu_are_a_tensor => prove(&statement!(lambda_and_mu_are_a_tensor, [lambda, mu, xx, xy, yx, yy], ["always"]));
    the_energies_of_any_tensor_are_sums_of_squares => prove(&statement!(the_energies_of_any_tensor_are_sums_of_squares, [k, m, g, a, b, c, exx, eyy, exy, fxx, fyy, fxy], ["always"]));
    the_moduli_of_a_tensor_are_found => prove(&statement!(the_moduli_of_a_tensor_are_found, [k, m, g, a, b, c], ["always"]));
    a_tensor_that_is_turned_has_the_stress_of_before => prove(&statement!(a_tensor_that_is_turned_has_the_stress_of_before, [c11, c12, c16, c22, c26, c66, xx, yy, xy, cos, sin], ["always"]));
    control_a_strain_that_is_turned_the_other_way => refute(&statement!(control_a_strain_that_is_turned_the_other_way, [c11, c12, c16, c22, c26, c66, cos, sin], fails "found == Stress::new(turned([cos, sin], stress.components()))"));
    a_tensor_that_is_turned_has_the_stress_across_the_plane_of_before => prove(&statement!(a_tensor_that_is_turned_has_the_stress_across_the_plane_of_before, [p, q, r, xx, yy, xy, cos, sin], ["always"]));
}
