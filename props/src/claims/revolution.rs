//! Bodies of revolution (docs/theory.md, 11): the weight r in the trace inequality and in Korn's inequality, and the hoop strain in
//! Hooke's law and in Lemma 3.2. The formulas of the kernel for them: `props/tests/program/revolution.rs`.
//!
//! A function that is affine on a triangle has the values a, b at the ends of the edge and c opposite. Everything is linear in r >= 0:
//! an inequality is one for r = 1 at each of the three corners.

use signorini::kernel::axial::{corner_mass, trace_constant};
use signorini::kernel::edge_integral::edge_mass;
use signorini::kernel::{Material, P1, Plane};
use signorini::nalgebra::{Matrix2, Vector2};

use crate::claim::Claim;
use crate::statement::take;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

/// w . M w for the symmetric matrix of three values.
fn form<S: Ordered>(m: [[S; 3]; 3], [a, b, c]: [S; 3]) -> S {
    let two = S::from(2);
    a * a * m[0][0]
        + b * b * m[1][1]
        + c * c * m[2][2]
        + two * (a * b * m[0][1] + a * c * m[0][2] + b * c * m[1][2])
}

/// int_E r w^2 / |E| and int_T r w^2 / |T|.
fn traces<S: Ordered>([a, b, c, ra, rb, rc]: [S; 6]) -> [S; 2] {
    let n = edge_mass([ra, rb]);
    let two = S::from(2);
    let edge = a * a * n[0][0] + b * b * n[1][1] + two * a * b * n[0][1];
    [edge, form(corner_mass([ra, rb, rc]), [a, b, c])]
}

/// What is squared in the difference for r = 1 at one of the corners.
fn squared<S: Ordered>([a, b, c]: [S; 3]) -> [S; 5] {
    let (two, three, four) = (S::from(2), S::from(3), S::from(4));
    [two * (c + a) + b, two * (c + b) + a, a - b, three * (a + b) + four * c, c]
}

/// Lemma 11.3: int_E r w^2 <= 4 (|E| / |T|) int_T r w^2.
pub fn the_weighted_trace_constant_of_p2_is_at_most_4<S: Ordered>(v: [S; 6]) -> Verdict {
    let (zero, two, three, four) = (S::from(0), S::from(2), S::from(3), S::from(4));
    let [a, b, c, ra, rb, rc] = v;
    given!(ra >= zero && rb >= zero && rc >= zero);
    let [edge, whole] = traces(v);
    let [first, second, between, both, opposite] = squared([a, b, c]);
    let squares = ra * (two * (first * first) + between * between)
        + rb * (two * (second * second) + between * between)
        + rc * (two * (both * both) / three
            + two * (between * between)
            + S::from(40) * (opposite * opposite) / three);
    ensure!(S::from(60) * (four * whole - edge) == squares);
    for square in [first, second, between, both, opposite] {
        ensure!(square * square >= zero);
        for radius in [ra, rb, rc] {
            ensure!(radius * (square * square) >= zero);
        }
    }
    ensure!(edge <= four * whole);
    Verdict::Holds("always")
}

/// Lemma 11.2: int_E r w^2 is r_E / r_c times (|E| / |T|) int_T r w^2 for a constant w, and that is 3/2 at most.
pub fn the_weighted_trace_identity_of_p1<S: Ordered>([w, ra, rb, rc]: [S; 4]) -> Verdict {
    let (zero, two, three) = (S::from(0), S::from(2), S::from(3));
    given!(ra >= zero && rb >= zero && rc >= zero && ra + rb + rc > zero);
    let [edge, whole] = traces([w, w, w, ra, rb, rc]);
    let constant = trace_constant::<P1, S, 3, 2>([ra, rb], rc, |x| x);
    ensure!(edge == constant * whole);
    ensure!(two * edge == w * w * (ra + rb) && three * whole == w * w * (ra + rb + rc));
    ensure!(rc * (w * w) >= zero);
    ensure!(two * edge <= three * whole);
    Verdict::Holds("always")
}

/// 1, the constant of the plane.
pub fn control_the_trace_identity_of_the_plane<S: Ordered>([w, ra, rb, rc]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(ra >= zero && rb >= zero && rc >= zero);
    let [edge, whole] = traces([w, w, w, ra, rb, rc]);
    ensure!(edge <= whole);
    Verdict::Holds("always")
}

/// Lemma 11.3: a c with c S - N that has a diagonal and a determinant that are not negative is a trace constant.
pub fn a_number_with_a_determinant_that_is_not_negative_is_a_trace_constant<S: Ordered>(
    [a, b, c, ra, rb, rc, constant]: [S; 7],
) -> Verdict {
    let zero = S::from(0);
    given!(ra > zero && rb > zero && rc > zero);
    let (n, m) = (edge_mass([ra, rb]), corner_mass([ra, rb, rc]));
    let entry = |i: usize, j: usize| constant * (m[i][j] - m[i][2] * m[j][2] / m[2][2]) - n[i][j];
    let (aa, ab, bb) = (entry(0, 0), entry(0, 1), entry(1, 1));
    given!(aa >= zero && bb >= zero && aa * bb >= ab * ab && constant >= zero);
    let [edge, whole] = traces([a, b, c, ra, rb, rc]);
    ensure!(edge <= constant * whole);
    Verdict::Holds("always")
}

/// 3, the constant of the plane.
pub fn control_the_trace_constant_of_the_plane<S: Ordered>(v: [S; 6]) -> Verdict {
    let zero = S::from(0);
    let [_, _, _, ra, rb, rc] = v;
    given!(ra >= zero && rb >= zero && rc >= zero);
    let [edge, whole] = traces(v);
    ensure!(edge <= S::from(3) * whole);
    Verdict::Holds("always")
}

/// 4 is attained where the corner opposite is on the axis: w = (1, 1, -3/2).
pub fn the_weighted_trace_constant_is_attained<S: Ordered>([r, w]: [S; 2]) -> Verdict {
    let (two, three) = (S::from(2), S::from(3));
    let [edge, whole] = traces([two * w, two * w, -(three * w), r, r, S::from(0)]);
    ensure!(edge == S::from(4) * whole);
    Verdict::Holds("always")
}

/// sigma:eps with the hoop stress is the energy of eps + a h in the plane, and e h^2: isotropic, with the numbers of plane strain.
pub fn the_energy_of_revolution_is_that_of_plane_strain_and_of_the_hoop<S: Ordered>(
    [xx, yy, xy, hoop, lambda, mu]: [S; 6],
) -> Verdict {
    let (zero, two, three) = (S::from(0), S::from(2), S::from(3));
    given!(mu > zero && three * lambda + two * mu > zero);
    let energy = energy(&Material::lame(lambda, mu, Plane::Axisymmetric), [xx, yy, xy, hoop]);
    // nu = lambda / (2 (lambda + mu)), e = mu (3 lambda + 2 mu) / (lambda + mu), both times 2 (lambda + mu).
    let scale = two * (lambda + mu);
    ensure!(three * scale == two * (three * lambda + two * mu) + two * mu);
    ensure!(scale > zero);
    let (x, y) = (scale * xx + lambda * hoop, scale * yy + lambda * hoop);
    let plane =
        lambda * (x + y) * (x + y) + two * mu * (x * x + y * y + two * scale * scale * xy * xy);
    let along = two * mu * (three * lambda + two * mu) * scale * hoop * hoop;
    ensure!(scale * scale * energy == plane + along);
    Verdict::Holds("always")
}

/// sigma:eps for these strains and the hoop strain.
fn energy<S: Ordered>(material: &Material<S>, [xx, yy, xy, hoop]: [S; 4]) -> S {
    let (stress, along) = material.stress_of_revolution(Matrix2::new(xx, xy, xy, yy), hoop);
    let [sxx, syy, sxy] = stress.components();
    sxx * xx + syy * yy + S::from(2) * sxy * xy + along * hoop
}

/// Proposition 11.1 at a point: another hoop strain costs what its difference does with the hoop stress, and lambda + 2 mu times its square,
/// which is what is left where the difference is orthogonal to the stress.
pub fn another_hoop_strain_costs_the_square_of_the_difference<S: Ordered>(
    [xx, yy, xy, theta, hoop, lambda, mu]: [S; 7],
) -> Verdict {
    let two = S::from(2);
    let material = Material::lame(lambda, mu, Plane::Axisymmetric);
    let (_, along) = material.stress_of_revolution(Matrix2::new(xx, xy, xy, yy), theta);
    let difference = hoop - theta;
    ensure!(
        energy(&material, [xx, yy, xy, hoop])
            == energy(&material, [xx, yy, xy, theta])
                + two * along * difference
                + (lambda + two * mu) * difference * difference
    );
    Verdict::Holds("always")
}

/// Korn's inequality on a triangle (docs/theory.md, 11.5): sigma:eps >= 2 m |eps|^2 for m = min(mu, (3 lambda + 2 mu) / 2).
pub fn the_least_energy_of_a_strain_is_that_of_three_dimensions<S: Ordered>(
    [xx, yy, xy, hoop, lambda, mu, m]: [S; 7],
) -> Verdict {
    let (zero, two, three) = (S::from(0), S::from(2), S::from(3));
    let bulk = three * lambda + two * mu - two * m;
    given!(m <= mu && bulk >= zero);
    let material = Material::lame(lambda, mu, Plane::Axisymmetric);
    let size = xx * xx + yy * yy + two * xy * xy + hoop * hoop;
    let found = energy(&material, [xx, yy, xy, hoop]);
    let (p, q, r, trace) = (xx - yy, yy - hoop, hoop - xx, xx + yy + hoop);
    // Three times the deviator: the squares of the differences, and six times that of the shear.
    let deviator = p * p + q * q + r * r + S::from(6) * xy * xy;
    ensure!(three * (found - two * m * size) == two * (mu - m) * deviator + bulk * (trace * trace));
    ensure!(deviator >= zero && trace * trace >= zero && mu - m >= zero);
    ensure!((mu - m) * deviator >= zero && bulk * (trace * trace) >= zero);
    ensure!(found >= two * m * size);
    Verdict::Holds("always")
}

/// With m = min(mu, lambda + mu), the number of plane strain.
pub fn control_the_least_energy_of_plane_strain<S: Ordered>(
    [xx, yy, hoop, lambda, mu]: [S; 5],
) -> Verdict {
    let (zero, two, three) = (S::from(0), S::from(2), S::from(3));
    given!(mu > zero && three * lambda + two * mu > zero && lambda <= zero);
    let material = Material::lame(lambda, mu, Plane::Axisymmetric);
    let size = xx * xx + yy * yy + hoop * hoop;
    ensure!(energy(&material, [xx, yy, zero, hoop]) >= two * (lambda + mu) * size);
    Verdict::Holds("always")
}

/// What is squared there.
fn squared_with_a_hoop_strain<S: Ordered>(
    [xx, yy, xy, hoop, dx, dy, lambda, mu]: [S; 8],
) -> [S; 6] {
    let material = Material::lame(lambda, mu, Plane::Axisymmetric);
    let (stress, _) = material.stress_of_revolution(Matrix2::new(xx, xy, xy, yy), hoop);
    let [sxx, _, sxy] = stress.components();
    [yy + hoop, yy - hoop, xy, dx, dy, dx * sxy - dy * sxx]
}

/// Lemma 3.2 with a hoop strain, at a point, for n = (1, 0): (d . sigma n)^2 <= |d|^2 (lambda + 2 mu) sigma:eps.
pub fn the_hoop_strain_does_not_enter_the_constant_of_the_traction<S: Ordered>(
    [xx, yy, xy, hoop, dx, dy, lambda, mu]: [S; 8],
) -> Verdict {
    let (zero, two, three, four) = (S::from(0), S::from(2), S::from(3), S::from(4));
    given!(mu > zero && three * lambda + two * mu > zero);
    let material = Material::lame(lambda, mu, Plane::Axisymmetric);
    let (stress, _) = material.stress_of_revolution(Matrix2::new(xx, xy, xy, yy), hoop);
    let [sxx, _, sxy] = stress.components();
    let energy = energy(&material, [xx, yy, xy, hoop]);
    let stiffness = material.normal_stiffness(Vector2::new(S::from(1), zero));
    let whole = sxx * sxx + sxy * sxy;
    let (sum, difference) = (yy + hoop, yy - hoop);
    // (lambda + 2 mu) sigma:eps - |sigma n|^2 in squares: of the strains across n, and of the shear.
    ensure!(
        stiffness * energy - whole
            == mu * (three * lambda + two * mu) * (sum * sum)
                + mu * stiffness * (difference * difference)
                + four * mu * (lambda + mu) * (xy * xy)
    );
    ensure!(lambda + mu > zero && stiffness > zero);
    ensure!(mu * (three * lambda + two * mu) * (sum * sum) >= zero);
    ensure!(mu * stiffness * (difference * difference) >= zero);
    ensure!(mu * (lambda + mu) * (xy * xy) >= zero);
    ensure!(whole <= stiffness * energy);
    let (along, across) = (dx * sxx + dy * sxy, dx * sxy - dy * sxx);
    let length = dx * dx + dy * dy;
    ensure!(along * along + across * across == length * whole);
    ensure!(across * across >= zero);
    ensure!(length >= zero);
    ensure!(length * whole <= length * (stiffness * energy));
    ensure!(along * along <= length * (stiffness * energy));
    Verdict::Holds("always")
}

/// The traction without its hoop strain.
pub fn control_the_traction_without_the_hoop_strain<S: Ordered>(
    [xx, yy, hoop, lambda, mu]: [S; 5],
) -> Verdict {
    let (zero, two, three) = (S::from(0), S::from(2), S::from(3));
    given!(mu > zero && three * lambda + two * mu > zero);
    let material = Material::lame(lambda, mu, Plane::Axisymmetric);
    let energy = energy(&material, [xx, yy, zero, hoop]);
    let [without, _, _] = material.stress(Matrix2::new(xx, zero, zero, yy)).components();
    ensure!(without * without <= (lambda + two * mu) * energy);
    Verdict::Holds("always")
}

/// The row.
pub fn claim() -> Claim {
    Claim {
        id: "18",
        title: "Bodies of revolution",
        paper: "Nothing: its integrals have the weight 1, here it is r.",
        limits: "Isotropic laws, and so n = (1, 0); the sharp constant of P2, a root, is drawn by its determinant.",
        checks: statements! {
            proved the_weighted_trace_constant_of_p2_is_at_most_4[a, b, c, ra, rb, rc]
                hints(|v| { let [a, b, c, ..] = take::<_, 6>(v); squared([a, b, c]).to_vec() });
            proved the_weighted_trace_constant_is_attained[r, w];
            proved the_weighted_trace_identity_of_p1[w, ra, rb, rc];
            tested a_number_with_a_determinant_that_is_not_negative_is_a_trace_constant[a, b, c, ra, rb, rc, constant];
            proved another_hoop_strain_costs_the_square_of_the_difference[xx, yy, xy, theta, hoop, lambda, mu];
            proved the_least_energy_of_a_strain_is_that_of_three_dimensions[xx, yy, xy, hoop, lambda, mu, m];
            refuted control_the_trace_identity_of_the_plane[w, ra, rb, rc] fails "edge <= whole";
            refuted control_the_least_energy_of_plane_strain[xx, yy, hoop, lambda, mu]
                fails "energy(&material, [xx, yy, zero, hoop]) >= two * (lambda + mu) * size";
            proved the_energy_of_revolution_is_that_of_plane_strain_and_of_the_hoop[xx, yy, xy, hoop, lambda, mu];
            proved the_hoop_strain_does_not_enter_the_constant_of_the_traction[xx, yy, xy, hoop, dx, dy, lambda, mu]
                hints(|v| squared_with_a_hoop_strain(take(v)).to_vec());
            refuted control_the_trace_constant_of_the_plane[a, b, c, ra, rb, rc] fails "edge <= S::from(3) * whole";
            refuted control_the_traction_without_the_hoop_strain[xx, yy, hoop, lambda, mu]
                fails "without * without <= (lambda + two * mu) * energy";
        },
    }
}
