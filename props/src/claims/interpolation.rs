//! Theorem 3.5 with a number, for P1 and nu = 1/2 (docs/theory.md, 9.6): the interpolation estimates (22)-(24) with the
//! constants of `study::interpolation`, on quadratics over rationals. The bound that follows from them is compared with the errors
//! of the solver in `tests/suite/convergence.rs`.
//!
//! ```text
//! (22)  |grad eta|_T <= c_T |u|_{2,T}               trace  |q|_E^2 <= (|E|/|T|) (|q|_T^2 + h |q|_T |grad q|_T)
//! (23)  |w|_E <= (|E|/pi) |w'|_E, w = 0 at both ends       sigma(v):eps(v) <= (2 mu + 2 [lambda]+) |grad v|^2
//! ```

use num_bigint::BigInt;
use num_rational::BigRational;
use proptest::prelude::*;
use signorini::kernel::{Material, Plane, Triangle, positive_part};
use signorini::nalgebra::{Matrix2, Vector2};
use study::interpolation::{gradient_constant_squared, trace_constant_squared};

use crate::claim::Check;
use crate::draws;
use crate::numbers::Exact;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

/// A triangle with one vertex in the origin, counter-clockwise, and a quadratic form or other numbers.
type Draw = ([i32; 4], [i32; 3]);

fn draws_of() -> impl Strategy<Value = Draw> {
    (prop::array::uniform4(-9_i32..=9), prop::array::uniform3(-9_i32..=9))
}

/// The triangle of a draw; `None` where it is flat.
fn triangle([ax, ay, bx, by]: [Exact; 4]) -> Option<Triangle<Exact>> {
    let (origin, a, b) = (Vector2::zeros(), Vector2::new(ax, ay), Vector2::new(bx, by));
    let turned = a.perp(&b);
    let zero = Exact::from(0);
    let vertices = if turned > zero { [origin, a, b] } else { [origin, b, a] };
    (turned != zero).then_some(Triangle { vertices })
}

/// |grad (q - I q)|_T^2 and |q|_{2,T}^2 over |T| for the quadratic q with this Hessian: q - I q is the sum over the edges e
/// of -H(e, e)/2 times the barycentric coordinates of its ends.
fn interpolation_error<S: Ordered>(triangle: &Triangle<S>, [xx, xy, yy]: [S; 3]) -> [S; 2] {
    let two = S::from(2);
    let form = |e: Vector2<S>| xx * e[0] * e[0] + two * xy * e[0] * e[1] + yy * e[1] * e[1];
    let gradients = triangle.barycentric_gradients();
    // grad (q - I q) is affine: its value at each vertex.
    let at = |vertex: usize| {
        let others = (0..3).filter(|&k| k != vertex).map(|k| {
            // The edge between `vertex` and the other one lies opposite the third.
            let edge = triangle.edge(3 - vertex - k);
            gradients[k] * (-form(edge) / two)
        });
        others.fold(Vector2::zeros(), |sum: Vector2<S>, gradient| sum + gradient)
    };
    let values = [0, 1, 2].map(at);
    // The mean of the product of two affine functions.
    let sum = values.iter().fold(Vector2::zeros(), |sum: Vector2<S>, v| sum + v);
    let squares = values.iter().fold(sum.dot(&sum), |all, v| all + v.dot(v));
    [squares / S::from(12), xx * xx + two * xy * xy + yy * yy]
}

/// (22) for a quadratic, with `factor` times c_T^2.
fn estimate_22(&(vertices, form): &Draw, factor: (i64, i64)) -> Verdict {
    let Some(triangle) = triangle(vertices.map(Exact::from)) else { return Verdict::Vacuous };
    let [error, seminorm] = interpolation_error(&triangle, form.map(Exact::from));
    let constant = Exact::ratio(factor.0, factor.1) * gradient_constant_squared(&triangle);
    ensure!(error <= constant * seminorm);
    Verdict::Holds("always")
}

/// The root of a number that is not negative, rounded down to a multiple of 2^-40.
fn root_below(x: Exact) -> Exact {
    let [scale, squared] = [40, 80].map(|n| BigRational::from_integer(BigInt::from(1) << n));
    let root = (x.value() * squared).to_integer().sqrt();
    Exact::new(BigRational::from_integer(root) / scale)
}

/// The trace inequality for the affine q with these values at the vertices, on the edge opposite vertex 0, with roots of its mixed term
/// that are rounded down; `mixed` = 1, or 0 for the inequality without that term.
fn trace(&(vertices, values): &Draw, mixed: i32) -> Verdict {
    let Some(triangle) = triangle(vertices.map(Exact::from)) else { return Verdict::Vacuous };
    let q = values.map(Exact::from);
    let (zero, one) = (Exact::from(0), Exact::from(1));
    let gradient: Vector2<Exact> = triangle
        .barycentric_gradients()
        .iter()
        .zip(q)
        .fold(Vector2::zeros(), |sum: Vector2<Exact>, (g, q)| sum + g * q);
    let sum = q[0] + q[1] + q[2];
    let mean = (q.iter().fold(sum * sum, |all, &q| all + q * q)) / Exact::from(12);
    let edge = (q[1] * q[1] + q[1] * q[2] + q[2] * q[2]) / Exact::from(3);
    let squares = [0, 1, 2].map(|i| triangle.edge(i).dot(&triangle.edge(i)));
    let diameter = squares.into_iter().fold(zero, |a, b| if a < b { b } else { a });
    ensure!(trace_constant_squared([one, one, one], one) == Exact::from(2));
    if edge <= mean {
        return Verdict::Holds("without the gradient");
    }
    let area = triangle.double_area() / Exact::from(2);
    let square = gradient.dot(&gradient);
    // Both sides over |E| and |grad q|_T^2 = |T| |grad q|^2, so that c = |q|_T/|grad q|_T; roots that are rounded down make the right
    // side smaller.
    let (c, h) = (root_below(mean / square), root_below(diameter));
    let bound = trace_constant_squared([one, area, Exact::from(mixed) * h], c);
    ensure!(edge <= bound * area * square);
    Verdict::Holds("with it")
}

/// (23) on the unit edge for w = s (1 - s) (a + b s + c s^2), with `pi` a rational number below pi^2.
fn estimate_23(&(_, coefficients): &Draw, pi: (i64, i64)) -> Verdict {
    let [a, b, c] = coefficients.map(Exact::from);
    // The coefficients of w = a s + (b - a) s^2 + (c - b) s^3 - c s^4.
    let w = [Exact::from(0), a, b - a, c - b, -c];
    let integral = |of: &[Exact]| {
        let mut sum = Exact::from(0);
        for (i, &x) in of.iter().enumerate() {
            for (j, &y) in of.iter().enumerate() {
                sum += x * y / Exact::from((i + j + 1) as i32);
            }
        }
        sum
    };
    let slope: Vec<Exact> = (1..5).map(|i| w[i] * Exact::from(i as i32)).collect();
    ensure!(Exact::ratio(pi.0, pi.1) * integral(&w) <= integral(&slope));
    Verdict::Holds("always")
}

/// sigma(v):eps(v) <= (2 mu + 2 \[lambda\]+) |grad v|^2 at a point; `factor` multiplies the right side.
fn energy_bound<S: Ordered>([a, b, c, d, lambda, mu]: [S; 6], factor: S) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(mu > zero);
    let stress = Material::lame(lambda, mu, Plane::Strain).stress(Matrix2::new(a, b, c, d));
    let [xx, yy, xy] = stress.components();
    let energy = xx * a + yy * d + xy * (b + c);
    let part = positive_part(lambda);
    let gradient = a * a + b * b + c * c + d * d;
    let trace = (a + d) * (a + d);
    ensure!(trace + (a - d) * (a - d) == two * (a * a + d * d));
    ensure!(trace >= zero && trace <= two * gradient);
    ensure!(part >= zero && part - lambda >= zero);
    ensure!((part - lambda) * trace >= zero);
    ensure!(part * (two * gradient - trace) >= zero);
    ensure!(mu * ((b - c) * (b - c)) >= zero);
    ensure!(energy <= factor * (two * mu + two * part) * gradient);
    Verdict::Holds("always")
}

/// The energy density is at most (2 mu + 2 \[lambda\]+) times the square of the gradient.
pub fn energy_is_at_most_a_multiple_of_the_gradient<S: Ordered>(v: [S; 6]) -> Verdict {
    energy_bound(v, S::from(1))
}

/// Half of that.
pub fn control_half_the_multiple_of_the_gradient<S: Ordered>(v: [S; 6]) -> Verdict {
    energy_bound(v, S::from(1) / S::from(2))
}

/// The checks of Theorem 3.5 with its number.
pub fn checks() -> Vec<Check> {
    [
        statements! {
            proved + tested energy_is_at_most_a_multiple_of_the_gradient[a, b, c, d, lambda, mu] about "(22)-(24)", "a(., .)";
            refuted control_half_the_multiple_of_the_gradient[a, b, c, d, lambda, mu]
                fails "energy <= factor * (two * mu + two * part) * gradient";
        },
        vec![
            exact!("estimate_22_holds_for_quadratics", in estimate_22, draws 1000 => {
            draws::hold(1000, draws_of(), &["always"], |draw| estimate_22(draw, (1, 1)))
        }).about(&["(22)-(24)"]),
            // Quadratics come nearer than four fifths of the constant.
        exact!("control_four_fifths_of_the_constant_of_22", at estimate_22 => {
            draws::reject(draws_of(), |draw| estimate_22(draw, (16, 25)))
        }),
            exact!("the_trace_inequality_holds_for_affine_functions", in trace, draws 400 => {
            draws::hold(400, draws_of(), &["without the gradient", "with it"], |draw| trace(draw, 1))
        }).about(&["(22)-(24)"]),
            exact!("control_the_trace_without_the_gradient", at trace => {
            draws::reject(draws_of(), |draw| trace(draw, 0))
        }),
            // pi^2 > 9.8696
        exact!("estimate_23_holds_for_polynomials", in estimate_23, draws 400 => {
            draws::hold(400, draws_of(), &["always"], |draw| estimate_23(draw, (98_696, 10_000)))
        }).about(&["(22)-(24)"]),
            // s (1 - s) has the quotient 10.
        exact!("control_a_larger_number_for_pi", at estimate_23 => {
            draws::reject(draws_of(), |draw| estimate_23(draw, (101, 10)))
        }),
        ],
    ]
    .concat()
}
