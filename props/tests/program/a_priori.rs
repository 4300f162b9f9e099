//! The bounds of `study::a_priori`, which the solver prints beside its errors on exact solutions: the very functions, over
//! symbols, follow from Theorem 3.4, Corollary 3.6, and Theorems 9.3 and 9.4 of docs/theory.md; and what the solver calls
//! is their square root, with the root of kappa where one belongs.

use proptest::prelude::*;
use signorini::exact::Errors;
use study::a_priori;

use props::claims::theorem_3_4::scaled_sides;
use props::numbers::Exact;
use props::proof::{prove, refute};
use props::verdict::{Ordered, Verdict};
use props::{draws, ensure, given, statement};

/// Theorem 3.4, divided by delta^2, has the right side that the solver prints.
pub fn plain_bound_is_that_of_theorem_3_4<S: Ordered>([e, h, z, s, q, k]: [S; 6]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(k >= zero && k < one);
    let (kappa, delta) = (k * k, one - k * k);
    ensure!(delta > zero);
    let [left, right] = scaled_sides([e, h, z, s, q, k]);
    given!(left <= right);
    let squared = delta * delta;
    ensure!(left / squared <= right / squared);
    ensure!(left / squared == e * e + z * z / delta);
    ensure!(right / squared == a_priori::plain_squared(kappa, [h, s, q]));
    Verdict::Holds("always")
}

/// The terms of the sharp bound are those of Theorem 9.3.
pub fn sharp_bound_is_that_of_theorem_9_3<S: Ordered>([h, s, k]: [S; 3]) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(h >= zero && s >= zero && k >= zero && k < one);
    let kappa = k * k;
    let [b, c] = a_priori::sharp_terms(kappa, k, [h, s]);
    ensure!(b >= (one - two * kappa) * h + k * s && b >= (two * kappa - one) * h + k * s);
    ensure!((b - k * s) * (b - k * s) == (one - two * kappa) * h * ((one - two * kappa) * h));
    ensure!(c == kappa * h * h + k * h * s);
    Verdict::Holds(if two * kappa > one { "kappa above 1/2" } else { "kappa at most 1/2" })
}

/// [9.6] of docs/theory.md from the facts (i), (ii) and (iii) of 9.2, with the letters of
/// [`three_facts_give_the_hypothesis_of_theorem_3_4`]: delta E^2 + Z^2 <= b E + Q Z + c with the solver's b and c, and what
/// Theorem 9.1 starts from is no smaller.
///
/// [`three_facts_give_the_hypothesis_of_theorem_3_4`]: props::claims::theorem_3_4::three_facts_give_the_hypothesis_of_theorem_3_4
pub fn three_facts_give_inequality_9_6<S: Ordered>(
    [e, h, z, s, big, k, c, d, q, r, t]: [S; 11],
) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(e >= zero && h >= zero && s >= zero && k >= zero && k < one);
    let kappa = k * k;
    given!(c <= e * h && -c <= e * h);
    // |w|_a^2 = E^2 - 2 c + H^2, r^2 <= kappa |w|_a^2, t <= k (E + H) S.
    given!(r * r <= kappa * (e * e - two * c + h * h) && t <= k * (e + h) * s);
    given!(d <= -(z * z) && -q <= z * big);
    given!(e * e - c == d - q + r * r + t);
    let [b, constant] = a_priori::sharp_terms(kappa, k, [h, s]);
    ensure!((one - two * kappa) * c <= (b - k * s) * e);
    ensure!((one - kappa) * e * e + z * z <= b * e + big * z + constant);
    ensure!(kappa <= one);
    ensure!((b - k * s) * e <= h * e);
    ensure!(b * e + constant <= e * h + kappa * h * h + k * (e + h) * s);
    Verdict::Holds("always")
}

/// The Cauchy-Schwarz inequality of the proof of [9.5]: (b E + Q Z)^2 <= (b^2/delta + Q^2) (delta E^2 + Z^2).
pub fn the_right_side_of_9_6_is_bounded_by_the_left_one<S: Ordered>(
    [e, z, b, q, delta]: [S; 5],
) -> Verdict {
    given!(delta > S::from(0));
    let linear = b * e + q * z;
    let square = delta * e * e + z * z;
    ensure!(delta * linear * linear <= (b * b + delta * q * q) * square);
    ensure!(linear * linear <= (b * b / delta + q * q) * square);
    Verdict::Holds("always")
}

/// [9.5] from [9.6]: let l = b E + Q Z, X = (delta E^2 + Z^2)^(1/2), r = (b^2/delta + Q^2)^(1/2), so that l^2 <= r^2 X^2, and
/// w = (r^2 + 4 c)^(1/2). [9.6] is X^2 <= l + c; then X is at most the larger root y = (r + w)/2 of y^2 = r y + c, and [9.5] is
/// X/m <= y/m, m = delta^(1/2).
pub fn inequality_9_6_gives_the_sharp_bound_9_5<S: Ordered>([l, c, x, r, w, m]: [S; 6]) -> Verdict {
    let (zero, two, four) = (S::from(0), S::from(2), S::from(4));
    given!(m > zero && c >= zero && x >= zero && r >= zero && w >= zero);
    given!(w * w == r * r + four * c);
    given!(l * l <= r * x * (r * x) && x * x <= l + c);
    ensure!(r * x >= zero);
    ensure!(l <= r * x);
    ensure!(w >= r);
    let y = (r + w) / two;
    ensure!(y * y == r * y + c);
    ensure!(x <= y);
    ensure!(x / m <= (r + w) / (two * m));
    Verdict::Holds(if c == zero { "c = 0" } else { "c > 0" })
}

/// The root with 2 c in the place of 4 c.
pub fn control_9_5_with_half_the_constant<S: Ordered>([c, x, r, w]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(c >= zero && x >= zero && r >= zero && w >= zero);
    given!(w * w == r * r + S::from(2) * c && x * x <= r * x + c);
    ensure!(x <= (r + w) / S::from(2));
    Verdict::Holds("always")
}

/// (i), (ii) and (iii) for the a-orthogonal projection, a(eta, w) = 0: what Theorem 9.4 starts from.
pub fn three_facts_give_the_hypothesis_of_theorem_9_4<S: Ordered>(
    [w, z, s, big, k, d, q, r, t]: [S; 9],
) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(w >= zero && s >= zero && r >= zero && k >= zero && k < one);
    given!(r <= k * w && t <= r * s);
    given!(d <= -(z * z) && -q <= z * big);
    given!(w * w == d - q + r * r + t);
    ensure!(r * r <= k * w * (k * w));
    ensure!(r * s <= k * w * s);
    ensure!((one - k * k) * w * w + z * z <= k * s * w + big * z);
    Verdict::Holds("always")
}

/// Theorem 9.4: from delta W^2 + Z^2 <= k S W + Q Z and E^2 = W^2 + H^2.
pub fn projected_bound_is_that_of_theorem_9_4<S: Ordered>([w, z, h, s, q, k]: [S; 6]) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(k >= zero && k < one);
    let (kappa, delta) = (k * k, one - k * k);
    ensure!(delta > zero);
    given!(delta * w * w + z * z <= k * s * w + q * z);
    ensure!(two * delta * k * s * w <= delta * delta * w * w + kappa * s * s);
    ensure!(two * k * s * w <= delta * w * w + kappa / delta * s * s);
    ensure!(two * q * z <= q * q + z * z);
    ensure!(delta * w * w + z * z <= kappa / delta * s * s + q * q);
    let sum = w * w + z * z / delta;
    ensure!(delta * sum == delta * w * w + z * z);
    ensure!(sum <= (kappa / delta * s * s + q * q) / delta);
    ensure!(w * w + h * h + z * z / delta <= a_priori::projected_squared(kappa, [h, s, q]));
    Verdict::Holds("always")
}

/// Corollary 3.6 has the right side that the solver prints.
pub fn corollary_bound_is_that_of_corollary_3_6<S: Ordered>(
    [x, s, r, w, e, h, k]: [S; 7],
) -> Verdict {
    let zero = S::from(0);
    given!(k >= zero && k < S::from(1) && e >= zero && h >= zero);
    given!(x <= s + r && r <= k * w && w <= e + h);
    ensure!(x <= a_priori::corollary_bound(k, e, [h, s]));
    Verdict::Holds("always")
}

/// kappa in the place of its root, where x is as large as Corollary 3.6 allows.
pub fn control_kappa_for_its_root_in_corollary_3_6<S: Ordered>([s, e, h, k]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(k >= zero && k < S::from(1) && e >= zero && h >= zero);
    ensure!(s + k * (e + h) <= a_priori::corollary_bound(k * k, e, [h, s]));
    Verdict::Holds("always")
}

/// Plain data: kappa, E, Z, H, S, Q.
type Draw = [f64; 6];

fn numbers() -> impl Strategy<Value = Draw> {
    let size = || prop_oneof![Just(0.0), 1e-3_f64..1e3];
    (0.0_f64..0.99, [size(), size(), size(), size(), size()])
        .prop_map(|(kappa, [e, z, h, s, q])| [kappa, e, z, h, s, q])
}

/// |a - b| <= 64 roundings of b: each of these formulas takes fewer than 30.
fn near(a: Exact, b: Exact) -> bool {
    (a - b).abs() <= b.abs() * Exact::of_double(64.0 * f64::EPSILON / 2.0)
}

/// What the solver calls, squared, against the same functions over rationals; `root` answers the root of kappa that the
/// corollary is given in the comparison.
fn called(&[kappa, e, z, h, s, q]: &Draw, spoil: impl Fn(Exact) -> Exact) -> Verdict {
    let of_u = Errors { energy: e, contact_residual: z, ..Errors::default() };
    let eta = Errors { energy: h, normal_stress: s, operator: q, ..Errors::default() };
    Exact::scope(|| {
        let [left, plain, sharp, projected, corollary] = [
            a_priori::left(kappa, &of_u),
            a_priori::plain(kappa, &eta),
            a_priori::sharp(kappa, &eta),
            a_priori::projected(kappa, &eta),
            a_priori::corollary(kappa, &of_u, &eta),
        ]
        .map(Exact::of_double);
        let [k, e, z, h, s, q] = [kappa, e, z, h, s, q].map(Exact::of_double);
        let delta = Exact::from(1) - k;
        ensure!(near(left * left, e * e + z * z / delta));
        ensure!(near(plain * plain, a_priori::plain_squared(k, [h, s, q])));
        ensure!(near(projected * projected, a_priori::projected_squared(k, [h, s, q])));
        // Corollary: its root of kappa is (bound - S)/(E + H), known to the roundings of the bound.
        let sum = e + h;
        let slack = corollary * Exact::of_double(64.0 * f64::EPSILON / 2.0);
        let [low, high] = [corollary - s - slack, corollary - s + slack];
        let square = spoil(k) * sum * sum;
        ensure!(high >= Exact::from(0) && high * high >= square);
        ensure!(low <= Exact::from(0) || low * low <= square);
        // Sharp: y = delta^(1/2) x is a root of y^2 = r y + c: (delta x^2 - c)^2 = r^2 delta x^2, where the root of kappa in
        // b and c is taken from the double, rounded once.
        let root = Exact::of_double(kappa.sqrt());
        let [b, c] = a_priori::sharp_terms(k, root, [h, s]);
        let (square, r) = (delta * sharp * sharp, b * b / delta + q * q);
        let slack = Exact::of_double(512.0 * f64::EPSILON) * (square + c) * (square + c + r);
        let difference = (square - c) * (square - c) - r * square;
        ensure!(difference.abs() <= slack);
        ensure!(square + slack >= c);
        Verdict::Holds("always")
    })
}

checks! {
    plain_bound_is_that_of_theorem_3_4 => prove(&statement!(plain_bound_is_that_of_theorem_3_4, [e, h, z, s, q, k], ["always"]));
    sharp_bound_is_that_of_theorem_9_3 => prove(&statement!(sharp_bound_is_that_of_theorem_9_3, [h, s, k], ["kappa above 1/2", "kappa at most 1/2"]));
    projected_bound_is_that_of_theorem_9_4 => prove(&statement!(projected_bound_is_that_of_theorem_9_4, [w, z, h, s, q, k], ["always"]));
    corollary_bound_is_that_of_corollary_3_6 => prove(&statement!(corollary_bound_is_that_of_corollary_3_6, [x, s, r, w, e, h, k], ["always"]));
    three_facts_give_inequality_9_6 => prove(&statement!(three_facts_give_inequality_9_6, [e, h, z, s, big, k, c, d, q, r, t], ["always"]));
    three_facts_give_the_hypothesis_of_theorem_9_4 => prove(&statement!(three_facts_give_the_hypothesis_of_theorem_9_4, [w, z, s, big, k, d, q, r, t], ["always"]));
    the_right_side_of_9_6_is_bounded_by_the_left_one => prove(&statement!(the_right_side_of_9_6_is_bounded_by_the_left_one, [e, z, b, q, delta], ["always"]).with_hints(|v| vec![v[2] * v[1] - v[3] * v[4] * v[0]]));
    inequality_9_6_gives_the_sharp_bound_9_5 => prove(&statement!(inequality_9_6_gives_the_sharp_bound_9_5, [l, c, x, r, w, m], ["c = 0", "c > 0"]));
    control_kappa_for_its_root_in_corollary_3_6 => refute(&statement!(control_kappa_for_its_root_in_corollary_3_6, [s, e, h, k], fails "s + k * (e + h) <= a_priori::corollary_bound(k * k, e, [h, s])"));
    control_9_5_with_half_the_constant => refute(&statement!(control_9_5_with_half_the_constant, [c, x, r, w], fails "x <= (r + w) / S::from(2)"));
    the_bounds_that_the_solver_calls_are_roots_of_these => draws::hold(400, numbers(), &["always"], |draw| called(draw, |kappa| kappa));
    control_kappa_for_its_root_in_doubles => draws::reject(numbers(), |draw| called(draw, |kappa| kappa * kappa));
}
