//! False statements for the proof engine: it must refuse every one of them, in builds with and without overflow checks. Some
//! are nearly true, some true of the rationals only, some would be true if the engine forgot a path, an inverse or a carry.

use signorini::kernel::{positive_part, positive_part_slope};

use crate::claim::Outcome;
use crate::proof::prove;
use crate::statement::Statement;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given, statement};

/// The positive part of a sum is at least the sum of the parts.
fn parts_add_up_to_no_more_than_the_part_of_the_sum<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    ensure!(positive_part(a) + positive_part(b) <= positive_part(a + b));
    Verdict::Holds("all")
}

/// \[ab\]+ = \[a\]+ \[b\]+: wrong where both are negative.
fn parts_multiply<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    ensure!(positive_part(a * b) == positive_part(a) * positive_part(b));
    Verdict::Holds("all")
}

/// The kink at 0 forgotten: the part of a negative number is 0.
fn part_is_no_more_than_the_number_near_zero<S: Ordered>([a]: [S; 1]) -> Verdict {
    ensure!(positive_part(a) <= a || a * a > S::from(1));
    Verdict::Holds("all")
}

/// The slope has no kink.
fn slope_is_continuous_at_zero<S: Ordered>([a]: [S; 1]) -> Verdict {
    given!(a * a < S::from(1));
    let jump = positive_part_slope(a) - positive_part_slope(-a);
    ensure!(jump * jump < S::from(1));
    Verdict::Holds("near")
}

/// Complementarity alone is compression.
fn a_product_of_zero_is_compression<S: Ordered>([u, sigma]: [S; 2]) -> Verdict {
    given!(u <= S::from(0) && u * sigma == S::from(0));
    ensure!(sigma <= S::from(0));
    Verdict::Holds("all")
}

/// Where P is positive, it is so for every gamma.
fn contact_does_not_depend_on_gamma<S: Ordered>([u, sigma, gamma]: [S; 3]) -> Verdict {
    given!(gamma > S::from(0) && u - gamma * sigma > S::from(0));
    ensure!(u - (gamma + gamma) * sigma > S::from(0));
    Verdict::Holds("all")
}

/// Young's inequality with the weights of two different betas.
fn young_with_two_betas<S: Ordered>([a, b, beta]: [S; 3]) -> Verdict {
    given!(beta > S::from(0));
    let two = S::from(2);
    ensure!(a * b <= beta * a * a / two + b * b / (S::from(4) * beta));
    Verdict::Holds("all")
}

/// The Bregman distance of 1/2 \[.\]+^2 is no distance: it has no symmetry.
fn bregman_is_symmetric<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let distance = |a: S, b: S| {
        let (p, q) = (positive_part(a), positive_part(b));
        (q - p) * (q - p) / S::from(2) + p * positive_part(-b)
    };
    ensure!(distance(a, b) == distance(b, a));
    Verdict::Holds("all")
}

/// 2 has a root in R, although in no draw of rational numbers.
fn no_square_is_two<S: Ordered>([x]: [S; 1]) -> Verdict {
    ensure!(x * x != S::from(2));
    Verdict::Holds("all")
}

/// Nor is 3/2 a cube of a rational number.
fn no_cube_between_one_and_two_is_three_halves<S: Ordered>([x]: [S; 1]) -> Verdict {
    given!(x > S::from(1) && x < S::from(2));
    ensure!(S::from(2) * x * x * x != S::from(3));
    Verdict::Holds("all")
}

/// Motzkin's polynomial is zero at four points: it is not positive.
fn motzkin_is_positive<S: Ordered>([x, y]: [S; 2]) -> Verdict {
    let (x2, y2) = (x * x, y * y);
    ensure!(x2 * x2 * y2 + x2 * y2 * y2 + S::from(1) > S::from(3) * x2 * y2);
    Verdict::Holds("all")
}

/// False by less than a millionth, between two roots a millionth apart.
fn a_parabola_with_two_close_roots_is_not_negative<S: Ordered>([x]: [S; 1]) -> Verdict {
    let (one, million) = (S::from(1), S::from(1_000_000));
    ensure!((x - one) * (million * (x - one) - one) >= S::from(0));
    Verdict::Holds("all")
}

/// The two largest integers of a conversion: their sum is no negative number.
fn a_sum_of_large_integers_wraps_around<S: Ordered>([x]: [S; 1]) -> Verdict {
    given!(x == S::from(i32::MAX));
    let four = S::from(2) * (x + S::from(1));
    ensure!(four * four * four * four <= S::from(0));
    Verdict::Holds("all")
}

/// 1/(1/x) = x asks that x is not zero, whatever else is divided by before.
fn inverses_of_inverses_return<S: Ordered>([x, y]: [S; 2]) -> Verdict {
    given!(y > S::from(0));
    let quotient = y / (x / y);
    ensure!(quotient * x == y * y);
    Verdict::Holds("all")
}

/// A denominator that is a square less a square is zero on two lines.
fn a_quotient_of_differences_is_a_sum<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a != b);
    ensure!((a - b) / (a * a - b * b) * (a + b) == S::from(1));
    Verdict::Holds("all")
}

/// x^4095 as a product of twelve squares and factors.
fn a_power_of_4095<S: Ordered>(x: S) -> S {
    (0..12).fold(S::from(1), |power, _| power * power * x)
}

/// An odd power falls for negative numbers; one that lost its highest bits would not.
fn an_odd_power_is_a_square<S: Ordered>([x]: [S; 1]) -> Verdict {
    ensure!(a_power_of_4095(x) >= S::from(0));
    Verdict::Holds("all")
}

/// A hypothesis that is met at one point only, where the conclusion is wrong.
fn nothing_lies_on_both_curves<S: Ordered>([x, y]: [S; 2]) -> Verdict {
    given!(x * x + y * y == S::from(25) && x * y == S::from(12) && x > y && y > S::from(0));
    ensure!(x < S::from(4));
    Verdict::Holds("all")
}

/// Nothing is greater than itself by way of two others: what follows from it is worth nothing.
fn what_follows_from_a_circle<S: Ordered>([a, b, c]: [S; 3]) -> Verdict {
    given!(a > b && b > c && c > a);
    ensure!(a == b);
    Verdict::Holds("all")
}

/// Squares add up to no negative number: a hypothesis that nothing meets.
fn what_follows_from_a_negative_sum_of_squares<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a * a + b * b == S::from(-1));
    ensure!(a > b);
    Verdict::Holds("all")
}

/// One of two classes is met by nothing.
fn a_square_is_sometimes_negative<S: Ordered>([a]: [S; 1]) -> Verdict {
    ensure!(a * a >= S::from(0));
    Verdict::Holds(if a * a < S::from(0) { "negative" } else { "all" })
}

/// A denominator that is zero at one point only.
fn a_sum_of_squares_has_an_inverse<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let sum = a * a + b * b;
    ensure!(sum * (S::from(1) / sum) == S::from(1));
    Verdict::Holds("all")
}

/// The wrong denominator is kept from zero.
fn a_difference_keeps_the_sum_from_zero<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a != b && a != S::from(0));
    ensure!((a + b) * (a / (a + b)) == a);
    Verdict::Holds("all")
}

/// The division is on one side of a case only, and the case is not where it may be made.
fn a_case_keeps_a_division_from_zero<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let ratio = if a >= b { a / (a - b) } else { S::from(1) };
    ensure!(ratio * ratio >= S::from(0));
    Verdict::Holds("all")
}

/// A root may be the negative one.
fn a_root_is_not_negative<S: Ordered>([a, r]: [S; 2]) -> Verdict {
    given!(r * r == a && a > S::from(0));
    ensure!(r > S::from(0));
    Verdict::Holds("all")
}

/// The root of a difference is the difference of the roots.
fn roots_are_subtracted<S: Ordered>([p, q, r]: [S; 3]) -> Verdict {
    let zero = S::from(0);
    given!(p >= q && q >= zero && r >= zero && r * r == p * p - q * q);
    ensure!(r <= p - q);
    Verdict::Holds("all")
}

/// Numbers with the same square are the same.
fn squares_tell_signs<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a * a == b * b);
    ensure!(a == b);
    Verdict::Holds("all")
}

/// A case distinction that has no answer where both are equal.
fn the_larger_of_two_without_a_tie<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let larger = if a < b {
        b
    } else if b < a {
        a
    } else {
        S::from(0)
    };
    ensure!(larger >= a && larger >= b);
    Verdict::Holds("all")
}

/// The branches of a case distinction exchanged on one side only.
fn an_absolute_value_with_one_branch_wrong<S: Ordered>([a]: [S; 1]) -> Verdict {
    let size = a.split(|a| a, |a| a);
    ensure!(size * size == a * a);
    ensure!(size >= S::from(0));
    Verdict::Holds("all")
}

/// An inequality is multiplied by what may be negative.
fn an_inequality_times_any_number<S: Ordered>([a, b, c]: [S; 3]) -> Verdict {
    given!(a <= b);
    ensure!(a * c <= b * c);
    Verdict::Holds("all")
}

/// An inequality is divided by what may be negative.
fn an_inequality_over_any_number<S: Ordered>([a, b, c]: [S; 3]) -> Verdict {
    given!(c != S::from(0) && a > b * c);
    ensure!(a / c > b);
    Verdict::Holds("all")
}

/// Reciprocals turn an order whatever the signs.
fn reciprocals_turn_the_order<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a != S::from(0) && b != S::from(0) && a < b);
    ensure!(S::from(1) / a > S::from(1) / b);
    Verdict::Holds("all")
}

/// Squares keep an order whatever the signs.
fn squares_keep_the_order<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a <= b);
    ensure!(a * a <= b * b);
    Verdict::Holds("all")
}

/// A factor that may be zero is cancelled.
fn a_common_factor_is_cancelled<S: Ordered>([a, b, c]: [S; 3]) -> Verdict {
    given!(a * b == a * c);
    ensure!(b == c);
    Verdict::Holds("all")
}

/// Not negative is taken for positive.
fn a_product_of_nonnegative_numbers_is_positive<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a >= S::from(0) && b >= S::from(0) && a + b > S::from(0));
    ensure!(a * b > S::from(0));
    Verdict::Holds("all")
}

/// The smaller of two by the formula of the larger.
fn the_smaller_of_two_is_the_second_plus_the_part_of_the_difference<S: Ordered>(
    [a, b]: [S; 2],
) -> Verdict {
    let smaller = b + positive_part(a - b);
    ensure!(smaller <= a && smaller <= b);
    Verdict::Holds("all")
}

/// The larger of two sums for the sum of the larger ones.
fn the_larger_sum_is_the_sum_of_the_larger<S: Ordered>([a, b, c, d]: [S; 4]) -> Verdict {
    let larger = |a: S, b: S| b + positive_part(a - b);
    ensure!(larger(a + c, b + d) >= larger(a, b) + larger(c, d));
    Verdict::Holds("all")
}

/// The triangle inequality turned round.
fn the_part_of_a_difference_is_at_most_that_of_the_parts<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    ensure!(positive_part(a - b) <= positive_part(a) - positive_part(b));
    Verdict::Holds("all")
}

/// A convex function lies below its chord: between the ends, not beyond.
fn a_square_lies_below_its_chord_everywhere<S: Ordered>([a, b, t]: [S; 3]) -> Verdict {
    let s = S::from(1) - t;
    ensure!((s * a + t * b) * (s * a + t * b) <= s * a * a + t * b * b);
    Verdict::Holds("all")
}

/// A convex function lies above its tangent, not below.
fn a_square_lies_below_its_tangent<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    ensure!(a * a <= b * b + S::from(2) * b * (a - b));
    Verdict::Holds("all")
}

/// The Cauchy-Schwarz inequality is strict only where the vectors are independent.
fn cauchy_and_schwarz_are_strict<S: Ordered>([a, b, c, d]: [S; 4]) -> Verdict {
    given!(a * c + b * d > S::from(0));
    let product = a * c + b * d;
    ensure!(product * product < (a * a + b * b) * (c * c + d * d));
    Verdict::Holds("all")
}

/// The root of two is 1.4142, not 7/5.
fn what_has_a_square_below_two_is_below_seven_fifths<S: Ordered>([x]: [S; 1]) -> Verdict {
    given!(x * x < S::from(2));
    ensure!(S::from(5) * x < S::from(7));
    Verdict::Holds("all")
}

/// True of the integers.
fn no_number_lies_between_zero_and_one<S: Ordered>([x]: [S; 1]) -> Verdict {
    ensure!(x <= S::from(0) || x >= S::from(1));
    Verdict::Holds("all")
}

/// A product of three factors is positive where two of them have one sign and the third is positive: or where it is said of
/// the wrong two.
fn a_product_of_three_is_positive<S: Ordered>([a, b, c]: [S; 3]) -> Verdict {
    given!(a * b > S::from(0) && b * c > S::from(0));
    ensure!(a * b * c > S::from(0));
    Verdict::Holds("all")
}

/// The first conclusion that fails is not the last one: what comes before must be checked too.
fn a_lemma_that_is_wrong_proves_what_is_right<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    ensure!(a * b <= S::from(0));
    ensure!(a * b * a * b >= S::from(0));
    Verdict::Holds("all")
}

/// What is small beside a power is still there.
fn leading_terms_are_all_there_is<S: Ordered>([x]: [S; 1]) -> Verdict {
    given!(x > S::from(1));
    let power = x * x * x * x * x;
    ensure!((power + x) / power == S::from(1));
    Verdict::Holds("all")
}

/// A definite form of two variables without the bound of its mixed term.
fn a_mixed_term_is_at_most_its_squares<S: Ordered>([a, b, x, y]: [S; 4]) -> Verdict {
    given!(a > S::from(0) && b > S::from(0));
    ensure!(a * x * x + b * y * y >= S::from(2) * x * y);
    Verdict::Holds("all")
}

/// From opposite signs of the values a root between, from the values' product a sign of their sum.
fn what_has_a_root_between_has_a_mean_of_zero<S: Ordered>([p, q]: [S; 2]) -> Verdict {
    given!(p < S::from(0) && q > S::from(0));
    let root = p / (p - q);
    ensure!(root + root == S::from(1));
    Verdict::Holds("all")
}

/// The integral of a positive part over an edge is that of the mean.
fn the_part_of_a_mean_is_the_mean_of_the_parts<S: Ordered>([p, q]: [S; 2]) -> Verdict {
    let two = S::from(2);
    ensure!(positive_part((p + q) / two) >= (positive_part(p) + positive_part(q)) / two);
    Verdict::Holds("all")
}

/// A gap that is forgotten on one side of complementarity.
fn complementarity_without_the_gap<S: Ordered>([u, g, sigma]: [S; 3]) -> Verdict {
    given!(u <= g && sigma <= S::from(0) && sigma * (u - g) == S::from(0));
    ensure!(sigma * u == S::from(0));
    Verdict::Holds("all")
}

/// Coercivity with the constant doubled.
fn a_difference_keeps_half_of_a_square<S: Ordered>([a, b, kappa]: [S; 3]) -> Verdict {
    given!(kappa >= S::from(0) && kappa < S::from(1) && b * b <= kappa * a * a);
    ensure!(a * a - b * b >= (S::from(1) - kappa * kappa) * a * a);
    Verdict::Holds("all")
}

/// The triangle inequality, turned.
fn a_norm_of_a_sum_is_at_least_the_sum<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let size = |x: S| positive_part(x) + positive_part(-x);
    ensure!(size(a + b) >= size(a) + size(b));
    Verdict::Holds("all")
}

/// A quotient of squares is at most that of what is larger above and below.
fn a_quotient_grows_with_both<S: Ordered>([a, b, c, d]: [S; 4]) -> Verdict {
    given!(S::from(0) < a && a <= c && S::from(0) < b && b <= d);
    ensure!(a / b <= c / d);
    Verdict::Holds("all")
}

/// The means of three numbers in the wrong order.
fn the_geometric_mean_is_the_larger_one<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a > S::from(0) && b > S::from(0));
    ensure!(S::from(4) * a * b >= (a + b) * (a + b));
    Verdict::Holds("all")
}

/// Two conditions that exclude each other only nearly: a line touches a circle.
fn a_tangent_misses_its_circle<S: Ordered>([x, y]: [S; 2]) -> Verdict {
    given!(S::from(3) * x + S::from(4) * y == S::from(5));
    ensure!(x * x + y * y > S::from(1));
    Verdict::Holds("all")
}

/// (5) determines u: where sigma is zero any u below the gap will do.
fn a_pressure_determines_the_displacement<S: Ordered>([u, v, g, sigma, gamma]: [S; 5]) -> Verdict {
    given!(gamma > S::from(0));
    given!(gamma * sigma == -positive_part(u - g - gamma * sigma));
    given!(gamma * sigma == -positive_part(v - g - gamma * sigma));
    ensure!(u == v);
    Verdict::Holds("all")
}

/// A cubic that is monotone on one side of its vertex.
fn a_cubic_is_monotone<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    let cubic = |x: S| x * x * x - x / S::from(4);
    given!(a <= b);
    ensure!(cubic(a) <= cubic(b));
    Verdict::Holds("all")
}

/// The inverse of an inverse of a sum, with a sign lost.
fn an_inverse_of_a_difference_is_symmetric<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a != b);
    ensure!(S::from(1) / (a - b) == S::from(1) / (b - a));
    Verdict::Holds("all")
}

/// A hypothesis that is true at one point only, and a conclusion that is wrong there.
fn what_follows_at_a_single_point<S: Ordered>([x, y]: [S; 2]) -> Verdict {
    given!(x * x + y * y <= S::from(2) * (x + y) - S::from(2));
    ensure!(x + y < S::from(2));
    Verdict::Holds("all")
}

/// The slope of the positive part times the number is more than the part.
fn slope_times_number_is_below_the_part<S: Ordered>([a]: [S; 1]) -> Verdict {
    ensure!(positive_part_slope(a) * a < positive_part(a) || a <= S::from(0));
    Verdict::Holds("all")
}

/// A transitivity with one of three comparisons turned.
fn a_circle_of_comparisons_is_an_equality<S: Ordered>([a, b, c]: [S; 3]) -> Verdict {
    given!(a <= b && b <= c && a * c >= S::from(0));
    ensure!(a * b + b * c <= b * b + a * c);
    Verdict::Holds("all")
}

/// The statements, with the conclusion of each that a rational point refutes, where there is one.
pub fn all() -> Vec<Statement> {
    vec![
        statement!(parts_add_up_to_no_more_than_the_part_of_the_sum, [a, b], ["all"])
            .failing("positive_part(a) + positive_part(b) <= positive_part(a + b)"),
        statement!(parts_multiply, [a, b], ["all"])
            .failing("positive_part(a * b) == positive_part(a) * positive_part(b)"),
        statement!(part_is_no_more_than_the_number_near_zero, [a], ["all"])
            .failing("positive_part(a) <= a || a * a > S::from(1)"),
        statement!(slope_is_continuous_at_zero, [a], ["near"]).failing("jump * jump < S::from(1)"),
        statement!(a_product_of_zero_is_compression, [u, sigma], ["all"])
            .failing("sigma <= S::from(0)"),
        statement!(contact_does_not_depend_on_gamma, [u, sigma, gamma], ["all"])
            .failing("u - (gamma + gamma) * sigma > S::from(0)"),
        statement!(young_with_two_betas, [a, b, beta], ["all"])
            .failing("a * b <= beta * a * a / two + b * b / (S::from(4) * beta)"),
        statement!(bregman_is_symmetric, [a, b], ["all"])
            .failing("distance(a, b) == distance(b, a)"),
        statement!(no_square_is_two, [x], ["all"]),
        statement!(no_cube_between_one_and_two_is_three_halves, [x], ["all"]),
        statement!(motzkin_is_positive, [x, y], ["all"])
            .failing("x2 * x2 * y2 + x2 * y2 * y2 + S::from(1) > S::from(3) * x2 * y2"),
        statement!(a_parabola_with_two_close_roots_is_not_negative, [x], ["all"]),
        statement!(a_sum_of_large_integers_wraps_around, [x], ["all"])
            .failing("four * four * four * four <= S::from(0)"),
        statement!(inverses_of_inverses_return, [x, y], ["all"]).failing("division by zero"),
        statement!(a_quotient_of_differences_is_a_sum, [a, b], ["all"]).failing("division by zero"),
        statement!(an_odd_power_is_a_square, [x], ["all"])
            .failing("a_power_of_4095(x) >= S::from(0)"),
        statement!(nothing_lies_on_both_curves, [x, y], ["all"]),
        statement!(what_follows_from_a_circle, [a, b, c], ["all"]),
        statement!(what_follows_from_a_negative_sum_of_squares, [a, b], ["all"]),
        statement!(a_square_is_sometimes_negative, [a], ["all", "negative"]),
        statement!(a_sum_of_squares_has_an_inverse, [a, b], ["all"]).failing("division by zero"),
        statement!(a_difference_keeps_the_sum_from_zero, [a, b], ["all"])
            .failing("division by zero"),
        statement!(a_case_keeps_a_division_from_zero, [a, b], ["all"]).failing("division by zero"),
        statement!(a_root_is_not_negative, [a, r], ["all"]).failing("r > S::from(0)"),
        statement!(roots_are_subtracted, [p, q, r], ["all"]).failing("r <= p - q"),
        statement!(squares_tell_signs, [a, b], ["all"]).failing("a == b"),
        statement!(the_larger_of_two_without_a_tie, [a, b], ["all"])
            .failing("larger >= a && larger >= b"),
        statement!(an_absolute_value_with_one_branch_wrong, [a], ["all"])
            .failing("size >= S::from(0)"),
        statement!(an_inequality_times_any_number, [a, b, c], ["all"]).failing("a * c <= b * c"),
        statement!(an_inequality_over_any_number, [a, b, c], ["all"]).failing("a / c > b"),
        statement!(reciprocals_turn_the_order, [a, b], ["all"])
            .failing("S::from(1) / a > S::from(1) / b"),
        statement!(squares_keep_the_order, [a, b], ["all"]).failing("a * a <= b * b"),
        statement!(a_common_factor_is_cancelled, [a, b, c], ["all"]).failing("b == c"),
        statement!(a_product_of_nonnegative_numbers_is_positive, [a, b], ["all"])
            .failing("a * b > S::from(0)"),
        statement!(
            the_smaller_of_two_is_the_second_plus_the_part_of_the_difference,
            [a, b],
            ["all"]
        )
        .failing("smaller <= a && smaller <= b"),
        statement!(the_larger_sum_is_the_sum_of_the_larger, [a, b, c, d], ["all"])
            .failing("larger(a + c, b + d) >= larger(a, b) + larger(c, d)"),
        statement!(the_part_of_a_difference_is_at_most_that_of_the_parts, [a, b], ["all"])
            .failing("positive_part(a - b) <= positive_part(a) - positive_part(b)"),
        statement!(a_square_lies_below_its_chord_everywhere, [a, b, t], ["all"])
            .failing("(s * a + t * b) * (s * a + t * b) <= s * a * a + t * b * b"),
        statement!(a_square_lies_below_its_tangent, [a, b], ["all"])
            .failing("a * a <= b * b + S::from(2) * b * (a - b)"),
        statement!(cauchy_and_schwarz_are_strict, [a, b, c, d], ["all"])
            .failing("product * product < (a * a + b * b) * (c * c + d * d)"),
        statement!(what_has_a_square_below_two_is_below_seven_fifths, [x], ["all"]),
        statement!(no_number_lies_between_zero_and_one, [x], ["all"])
            .failing("x <= S::from(0) || x >= S::from(1)"),
        statement!(a_product_of_three_is_positive, [a, b, c], ["all"])
            .failing("a * b * c > S::from(0)"),
        statement!(a_lemma_that_is_wrong_proves_what_is_right, [a, b], ["all"])
            .failing("a * b <= S::from(0)"),
        statement!(leading_terms_are_all_there_is, [x], ["all"])
            .failing("(power + x) / power == S::from(1)"),
        statement!(a_mixed_term_is_at_most_its_squares, [a, b, x, y], ["all"])
            .failing("a * x * x + b * y * y >= S::from(2) * x * y"),
        statement!(what_has_a_root_between_has_a_mean_of_zero, [p, q], ["all"])
            .failing("root + root == S::from(1)"),
        statement!(the_part_of_a_mean_is_the_mean_of_the_parts, [p, q], ["all"])
            .failing("positive_part((p + q) / two) >= (positive_part(p) + positive_part(q)) / two"),
        statement!(complementarity_without_the_gap, [u, g, sigma], ["all"])
            .failing("sigma * u == S::from(0)"),
        statement!(a_difference_keeps_half_of_a_square, [a, b, kappa], ["all"])
            .failing("a * a - b * b >= (S::from(1) - kappa * kappa) * a * a"),
        statement!(a_norm_of_a_sum_is_at_least_the_sum, [a, b], ["all"])
            .failing("size(a + b) >= size(a) + size(b)"),
        statement!(a_quotient_grows_with_both, [a, b, c, d], ["all"]).failing("a / b <= c / d"),
        statement!(the_geometric_mean_is_the_larger_one, [a, b], ["all"])
            .failing("S::from(4) * a * b >= (a + b) * (a + b)"),
        statement!(a_tangent_misses_its_circle, [x, y], ["all"])
            .failing("x * x + y * y > S::from(1)"),
        statement!(a_pressure_determines_the_displacement, [u, v, g, sigma, gamma], ["all"])
            .failing("u == v"),
        statement!(a_cubic_is_monotone, [a, b], ["all"]).failing("cubic(a) <= cubic(b)"),
        statement!(an_inverse_of_a_difference_is_symmetric, [a, b], ["all"])
            .failing("S::from(1) / (a - b) == S::from(1) / (b - a)"),
        statement!(what_follows_at_a_single_point, [x, y], ["all"]),
        statement!(slope_times_number_is_below_the_part, [a], ["all"])
            .failing("positive_part_slope(a) * a < positive_part(a) || a <= S::from(0)"),
        statement!(a_circle_of_comparisons_is_an_equality, [a, b, c], ["all"])
            .failing("a * b + b * c <= b * b + a * c"),
    ]
}

fn parts_add_up<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    ensure!(positive_part(a) + positive_part(b) >= positive_part(a + b));
    Verdict::Holds("all")
}

fn young<S: Ordered>([a, b, beta]: [S; 3]) -> Verdict {
    given!(beta > S::from(0));
    ensure!(a * b <= beta * a * a / S::from(2) + b * b / (S::from(2) * beta));
    Verdict::Holds("all")
}

fn a_square_is_not_minus_two<S: Ordered>([x]: [S; 1]) -> Verdict {
    ensure!(x * x != S::from(-2));
    Verdict::Holds("all")
}

fn a_quotient_is_a_sum<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a != b && a != -b);
    ensure!((a - b) / (a * a - b * b) * (a + b) == S::from(1));
    Verdict::Holds("all")
}

fn an_inequality_times_a_positive_number<S: Ordered>([a, b, c]: [S; 3]) -> Verdict {
    given!(a <= b && c > S::from(0));
    ensure!(a * c <= b * c);
    Verdict::Holds("all")
}

fn reciprocals_turn_the_order_of_positive_numbers<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    given!(a > S::from(0) && a < b);
    ensure!(S::from(1) / a > S::from(1) / b);
    Verdict::Holds("all")
}

fn the_smaller_of_two_is_the_first_less_the_part_of_the_difference<S: Ordered>(
    [a, b]: [S; 2],
) -> Verdict {
    let smaller = a - positive_part(a - b);
    ensure!(smaller <= a && smaller <= b && (smaller == a || smaller == b));
    Verdict::Holds("all")
}

fn a_square_lies_below_its_chord_between_the_ends<S: Ordered>([a, b, t]: [S; 3]) -> Verdict {
    let s = S::from(1) - t;
    given!(s >= S::from(0) && t >= S::from(0));
    ensure!((s * a + t * b) * (s * a + t * b) <= s * a * a + t * b * b);
    Verdict::Holds("all")
}

/// True neighbours of some of them: what the engine refuses above is not refused for its form.
fn neighbours() -> Vec<Statement> {
    vec![
        statement!(parts_add_up, [a, b], ["all"]),
        statement!(young, [a, b, beta], ["all"]),
        statement!(a_square_is_not_minus_two, [x], ["all"]),
        statement!(a_quotient_is_a_sum, [a, b], ["all"]),
        statement!(an_inequality_times_a_positive_number, [a, b, c], ["all"]),
        statement!(reciprocals_turn_the_order_of_positive_numbers, [a, b], ["all"]),
        statement!(
            the_smaller_of_two_is_the_first_less_the_part_of_the_difference,
            [a, b],
            ["all"]
        ),
        statement!(a_square_lies_below_its_chord_between_the_ends, [a, b, t], ["all"])
            .with_hints(|v| vec![v[0] - v[1]]),
    ]
}

/// The neighbours are proved.
///
/// # Errors
/// One that is not.
pub fn neighbours_are_proved() -> Outcome {
    let all = neighbours();
    for statement in &all {
        prove(statement)
            .map_err(|why| format!("{} is true, and refused: {why}", statement.name))?;
    }
    Ok(format!("{} statements", all.len()))
}

/// A power whose exponent no number of its width holds is refused, in every build, be it false or true what is said of it.
#[test]
fn nothing_is_proved_of_a_power_beyond_all_exponents() {
    fn power<S: Ordered>(x: S) -> S {
        (0..16).fold(x, |power, _| power * power)
    }
    fn a_huge_power_is_one<S: Ordered>([x]: [S; 1]) -> Verdict {
        ensure!(power(x) == S::from(1));
        Verdict::Holds("all")
    }
    fn a_huge_power_is_itself<S: Ordered>([x]: [S; 1]) -> Verdict {
        ensure!(power(x) == power(x));
        Verdict::Holds("all")
    }
    let of = |statement: &Statement| prove(statement).expect_err("a refusal");
    let why = of(&statement!(a_huge_power_is_one, [x], ["all"]));
    assert!(why.contains("power(x) == S::from(1)"), "{why}");
    let why = of(&statement!(a_huge_power_is_itself, [x], ["all"]));
    assert!(why.contains("path 0: Fails(\"a power beyond 2^16\")"), "{why}");
}
