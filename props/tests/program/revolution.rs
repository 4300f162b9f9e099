//! Formulas for bodies of revolution (docs/theory.md, 11) that are the program's own: integrals over a cut edge, the hoop strain of P2,
//! directions that turn, and the constants of [7.2'] (docs/a-posteriori.md) on a piece that touches the axis.

use signorini::kernel::axial::{hoop_strain, mass, turning_factor};
use signorini::kernel::edge_integral::{ExactEdge, edge_mass, weighted_product};
use signorini::kernel::{P1, P2};

use props::draws::hold_exactly;
use props::proof::{prove, refute};
use props::verdict::{Ordered, Verdict};
use props::{ensure, given, statement};

/// int r theta q = int v_r q: the hoop strain of P2 by its equations, and of a stretch v_r = k r on every triangle.
fn the_hoop_strain_is_the_projection_and_a_stretch_has_its_own<S: Ordered>(
    [k, a, b, c, u, v]: [S; 6],
) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(a >= zero && b >= zero && c >= zero && a + b + c > zero);
    let radii = [a, b, c];
    let middles = [(b + c) / two, (c + a) / two, (a + b) / two];
    let stretch = [a, b, c, middles[0], middles[1], middles[2]].map(|r| k * r);
    for theta in hoop_strain::<P2, S, 6, 3>(radii, &stretch) {
        ensure!(theta == k);
    }
    ensure!(hoop_strain::<P1, S, 3, 2>(radii, &[k * a, k * b, k * c])[0] == k);
    let field = [u, v, u + v, u - v, two * u, two * v];
    let theta = hoop_strain::<P2, S, 6, 3>(radii, &field);
    let m = mass::<P2, S, 6, 3>(radii);
    let means = signorini::kernel::axial::means::<P2, S, 6, 3>(&field);
    for row in 0..3 {
        let product = (0..3).fold(zero, |sum, j| sum + m[row][j] * theta[j]);
        ensure!(product == means[row]);
    }
    Verdict::Holds("always")
}

/// The integrals over a cut edge: P is positive on [0, tau], and the gradient of the energy is homogeneous.
fn weighted_integrals_of_a_cut_edge_are_those_of_the_positive_part<S: Ordered>(
    [p, q, r, s]: [S; 4],
) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(p > zero && q < zero && r >= zero && s >= zero);
    let tau = p / (p - q);
    let end = r + (s - r) * tau;
    let e = P1::exact_with([p, q], Some([r, s]));
    ensure!(e.active == tau);
    ensure!(two * e.energy == tau * weighted_product([r, end], [p, zero], [p, zero]));
    ensure!(e.gradient[0] * p + e.gradient[1] * q == two * e.energy);
    for (row, gradient) in e.hessian.into_iter().zip(e.gradient) {
        ensure!(row[0] * p + row[1] * q == gradient);
    }
    Verdict::Holds("always")
}

/// For r = 0 at one end and 1 at the other, q(s)^2 is at most 18 int r q^2 at both ends for affine q: [7.2'] on a piece that touches
/// the axis.
fn the_square_of_an_affine_function_is_at_most_18_times_its_weighted_integral<S: Ordered>(
    [a, b]: [S; 2],
) -> Verdict {
    let (zero, two, three) = (S::from(0), S::from(2), S::from(3));
    let integral = weighted_product([zero, S::from(1)], [a, b], [a, b]);
    let eighteen = S::from(18) * integral;
    let (at_axis, away) = (a + three * b, three * a + S::from(3) * b);
    ensure!(two * (eighteen - a * a) == at_axis * at_axis);
    ensure!(at_axis * at_axis >= zero);
    ensure!(a * a <= eighteen);
    ensure!(two * (eighteen - b * b) * three == away * away + S::from(12) * b * b);
    ensure!(away * away >= zero && b * b >= zero);
    ensure!(b * b <= eighteen);
    Verdict::Holds("always")
}

/// The same for quadratic functions and 72: q = c + d s + e s^2, int s q^2 = c^2/2 + 2 c d/3 + (d^2 + 2 c e)/4 + 2 d e/5 + e^2/6.
fn the_square_of_a_quadratic_function_is_at_most_72_times_its_weighted_integral<S: Ordered>(
    [c, d, e]: [S; 3],
) -> Verdict {
    let number = |n: i32| S::from(n);
    let zero = number(0);
    let integral = c * c / number(2)
        + number(2) * c * d / number(3)
        + (d * d + number(2) * c * e) / number(4)
        + number(2) * d * e / number(5)
        + e * e / number(6);
    let bound = number(72) * integral;
    let near = number(35) * c + number(24) * d + number(18) * e;
    let rest = number(3) * d + number(4) * e;
    ensure!(number(35) * (bound - c * c) == near * near + number(6) * (rest * rest));
    ensure!(near * near >= zero && rest * rest >= zero);
    ensure!(c * c <= bound);
    let end = c + d + e;
    let far = number(35) * c + number(23) * d + number(17) * e;
    let left = number(11) * d + number(13) * e;
    ensure!(
        number(385) * (bound - end * end)
            == number(11) * (far * far) + number(6) * (left * left) + number(42) * (e * e)
    );
    ensure!(far * far >= zero && left * left >= zero && e * e >= zero);
    ensure!(end * end <= bound);
    Verdict::Holds("always")
}

/// 4, the constant of the plane.
fn control_the_square_by_the_constant_of_the_plane<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let integral = weighted_product([S::from(0), S::from(1)], [a, b], [a, b]);
    ensure!(a * a <= S::from(4) * integral);
    Verdict::Holds("always")
}

/// Lemma 11.4, for directions (1, 0) and (1 - t^2, 2 t) / (1 + t^2) and radii with 3 a + b = u^2, a + 3 b = v^2.
fn a_turning_direction_counts_by_the_factor_with_the_weight<S: Ordered>(
    [ax, ay, bx, by, t, u, v]: [S; 7],
) -> Verdict {
    let (zero, one, two, three) = (S::from(0), S::from(1), S::from(2), S::from(3));
    given!(u > zero && v > zero && three * u * u >= v * v && three * v * v >= u * u);
    let eight = S::from(8);
    let radii = [(three * u * u - v * v) / eight, (three * v * v - u * u) / eight];
    let (cosine, sine) = ((one - t * t) / (one + t * t), two * t / (one + t * t));
    let n = edge_mass(radii);
    let square = |p: S, q: S| p * p * n[0][0] + q * q * n[1][1] + two * p * q * n[0][1];
    let factor = turning_factor::<P2, S, 6, 3>(radii, cosine, |_| u * v);
    ensure!(square(ax, cosine * bx + sine * by) <= factor * (square(ax, bx) + square(ay, by)));
    Verdict::Holds("always")
}

/// 2 - cosine, the factor of the plane, on an edge with an end on the axis and opposite directions.
fn control_the_turning_factor_of_the_plane<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let (two, three) = (S::from(2), S::from(3));
    let n = edge_mass([S::from(0), S::from(1)]);
    let square = |p: S, q: S| p * p * n[0][0] + q * q * n[1][1] + two * p * q * n[0][1];
    ensure!(square(a, -b) <= three * square(a, b));
    Verdict::Holds("always")
}

checks! {
    a_turning_direction_counts_by_the_factor_with_the_weight => hold_exactly(&statement!(a_turning_direction_counts_by_the_factor_with_the_weight, [ax, ay, bx, by, t, u, v], ["always"]));
    control_the_turning_factor_of_the_plane => refute(&statement!(control_the_turning_factor_of_the_plane, [a, b], fails "square(a, -b) <= three * square(a, b)"));
    the_hoop_strain_is_the_projection_and_a_stretch_has_its_own => hold_exactly(&statement!(the_hoop_strain_is_the_projection_and_a_stretch_has_its_own, [k, a, b, c, u, v], ["always"]));
    weighted_integrals_of_a_cut_edge_are_those_of_the_positive_part => prove(&statement!(weighted_integrals_of_a_cut_edge_are_those_of_the_positive_part, [p, q, r, s], ["always"]));
    the_square_of_an_affine_function_is_at_most_18_times_its_weighted_integral => prove(&statement!(the_square_of_an_affine_function_is_at_most_18_times_its_weighted_integral, [a, b], ["always"]));
    the_square_of_a_quadratic_function_is_at_most_72_times_its_weighted_integral => prove(&statement!(the_square_of_a_quadratic_function_is_at_most_72_times_its_weighted_integral, [c, d, e], ["always"]));
    control_the_square_by_the_constant_of_the_plane => refute(&statement!(control_the_square_by_the_constant_of_the_plane, [a, b], fails "a * a <= S::from(4) * integral"));
}
