//! The proof engine itself, asked like any other engine: false statements, every one of which it must refuse, in builds with and without overflow checks. Some
//! are nearly true, some true of the rationals only, some would be true if the engine forgot a path, an inverse or a carry.

use signorini::kernel::{positive_part, positive_part_slope};

use crate::claim::{Claim, Engine, Outcome, by, false_statement};
use crate::proof::{Sym, prove};
use crate::statement::Statement;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given, statement};

/// Statements in one line each: hypothesis, abbreviations, and a conclusion that is `refuted` at a rational point, is
/// `undefined` at one, for something is divided by zero, or is wrong where no rational point shows it (`unmet`); and true
/// neighbours of these (`proved`).
macro_rules! falsehoods {
    ($($(#[doc = $doc:literal])+ $how:ident $name:ident[$($x:ident),+]:
        $(given $given:expr;)? $(let $abbreviation:pat = $value:expr;)* => $conclusion:expr;)+) => {
        $($(#[doc = $doc])+
        fn $name<S: Ordered>([$($x),+]: [S; [$(stringify!($x)),+].len()]) -> Verdict {
            $(given!($given);)?
            $(let $abbreviation = $value;)*
            ensure!($conclusion);
            Verdict::Holds("all")
        })+

        /// The statements of the list, each with whether it is true.
        fn listed() -> Vec<(bool, Statement)> {
            vec![$(listed!($how, statement!($name, [$($x),+], ["all"]), $conclusion)),+]
        }
    };
}

/// Whether a statement is true, and how it fails.
macro_rules! listed {
    (proved, $statement:expr, $conclusion:expr) => {
        (true, $statement)
    };
    (refuted, $statement:expr, $conclusion:expr) => {
        (false, $statement.failing(stringify!($conclusion)))
    };
    (undefined, $statement:expr, $conclusion:expr) => {
        (false, $statement.failing("division by zero"))
    };
    (unmet, $statement:expr, $conclusion:expr) => {
        (false, $statement)
    };
}

/// x^4095 as a product of twelve squares and factors.
fn a_power_of_4095<S: Ordered>(x: S) -> S {
    (0..12).fold(S::from(1), |power, _| power * power * x)
}

/// One of two classes is met by nothing.
fn a_square_is_sometimes_negative<S: Ordered>([a]: [S; 1]) -> Verdict {
    ensure!(a * a >= S::from(0));
    Verdict::Holds(if a * a < S::from(0) { "negative" } else { "all" })
}

/// The branches of a case distinction exchanged on one side only.
fn an_absolute_value_with_one_branch_wrong<S: Ordered>([a]: [S; 1]) -> Verdict {
    let size = a.split(|a| a, |a| a);
    ensure!(size * size == a * a);
    ensure!(size >= S::from(0));
    Verdict::Holds("all")
}

/// The first conclusion that fails is not the last one: what comes before must be checked too.
fn a_lemma_that_is_wrong_proves_what_is_right<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    ensure!(a * b <= S::from(0));
    ensure!(a * b * a * b >= S::from(0));
    Verdict::Holds("all")
}

falsehoods! {
    /// The root of a difference is the difference of the roots.
    refuted roots_are_subtracted[p, q, r]:
        given p >= q && q >= S::from(0) && r >= S::from(0) && r * r == p * p - q * q;
        => r <= p - q;
    /// A cubic that is monotone on one side of its vertex.
    refuted a_cubic_is_monotone[a, b]:
        given a <= b;
        let cubic = |x: S| x * x * x - x / S::from(4);
        => cubic(a) <= cubic(b);
    /// A high power that is a small one, if exponents wrap around.
    refuted a_high_power_is_below_a_multiple[x]:
        given x > S::from(2);
        let power = (0..257).fold(S::from(1), |product, _| product * x);
        => power < S::from(2) * x;
    /// A division by what may be zero, undone.
    undefined a_number_is_its_product_with_an_inverse[a, b]: => a / b * b == a;
    /// A second division does not excuse the first one.
    undefined a_division_by_zero_is_followed_by_another[a, b]: => a / b / b * b * b == a;
    /// The positive part of a sum is at least the sum of the parts.
    refuted parts_add_up_to_no_more_than_the_part_of_the_sum[a, b]:
        => positive_part(a) + positive_part(b) <= positive_part(a + b);
    /// \[ab\]+ = \[a\]+ \[b\]+: wrong where both are negative.
    refuted parts_multiply[a, b]: => positive_part(a * b) == positive_part(a) * positive_part(b);
    /// The kink at 0 forgotten: the part of a negative number is 0.
    refuted part_is_no_more_than_the_number_near_zero[a]:
        => positive_part(a) <= a || a * a > S::from(1);
    /// The slope has no kink.
    refuted slope_is_continuous_at_zero[a]:
        given a * a < S::from(1);
        let jump = positive_part_slope(a) - positive_part_slope(-a);
        => jump * jump < S::from(1);
    /// Complementarity alone is compression.
    refuted a_product_of_zero_is_compression[u, sigma]:
        given u <= S::from(0) && u * sigma == S::from(0);
        => sigma <= S::from(0);
    /// Where P is positive, it is so for every gamma.
    refuted contact_does_not_depend_on_gamma[u, sigma, gamma]:
        given gamma > S::from(0) && u - gamma * sigma > S::from(0);
        => u - (gamma + gamma) * sigma > S::from(0);
    /// Young's inequality with the weights of two different betas.
    refuted young_with_two_betas[a, b, beta]:
        given beta > S::from(0);
        let two = S::from(2);
        => a * b <= beta * a * a / two + b * b / (S::from(4) * beta);
    /// The Bregman distance of 1/2 \[.\]+^2 is no distance: it has no symmetry.
    refuted bregman_is_symmetric[a, b]:
        let distance = |a: S, b: S| { let (p, q) = (positive_part(a), positive_part(b)); (q - p) * (q - p) / S::from(2) + p * positive_part(-b) };
        => distance(a, b) == distance(b, a);
    /// 2 has a root in R, although in no draw of rational numbers.
    unmet no_square_is_two[x]: => x * x != S::from(2);
    /// Nor is 3/2 a cube of a rational number.
    unmet no_cube_between_one_and_two_is_three_halves[x]:
        given x > S::from(1) && x < S::from(2);
        => S::from(2) * x * x * x != S::from(3);
    /// Motzkin's polynomial is zero at four points: it is not positive.
    refuted motzkin_is_positive[x, y]:
        let (x2, y2) = (x * x, y * y);
        => x2 * x2 * y2 + x2 * y2 * y2 + S::from(1) > S::from(3) * x2 * y2;
    /// False by less than a millionth, between two roots a millionth apart.
    unmet a_parabola_with_two_close_roots_is_not_negative[x]:
        let (one, million) = (S::from(1), S::from(1_000_000));
        => (x - one) * (million * (x - one) - one) >= S::from(0);
    /// The two largest integers of a conversion: their sum is no negative number.
    refuted a_sum_of_large_integers_wraps_around[x]:
        given x == S::from(i32::MAX);
        let four = S::from(2) * (x + S::from(1));
        => four * four * four * four <= S::from(0);
    /// 1/(1/x) = x asks that x is not zero, whatever else is divided by before.
    undefined inverses_of_inverses_return[x, y]:
        given y > S::from(0);
        let quotient = y / (x / y);
        => quotient * x == y * y;
    /// A denominator that is a square less a square is zero on two lines.
    undefined a_quotient_of_differences_is_a_sum[a, b]:
        given a != b;
        => (a - b) / (a * a - b * b) * (a + b) == S::from(1);
    /// An odd power falls for negative numbers; one that lost its highest bits would not.
    refuted an_odd_power_is_a_square[x]: => a_power_of_4095(x) >= S::from(0);
    /// A hypothesis that is met at one point only, where the conclusion is wrong.
    unmet nothing_lies_on_both_curves[x, y]:
        given x * x + y * y == S::from(25) && x * y == S::from(12) && x > y && y > S::from(0);
        => x < S::from(4);
    /// Nothing is greater than itself by way of two others: what follows from it is worth nothing.
    unmet what_follows_from_a_circle[a, b, c]: given a > b && b > c && c > a; => a == b;
    /// Squares add up to no negative number: a hypothesis that nothing meets.
    unmet what_follows_from_a_negative_sum_of_squares[a, b]:
        given a * a + b * b == S::from(-1);
        => a > b;
    /// A denominator that is zero at one point only.
    undefined a_sum_of_squares_has_an_inverse[a, b]:
        let sum = a * a + b * b;
        => sum * (S::from(1) / sum) == S::from(1);
    /// The wrong denominator is kept from zero.
    undefined a_difference_keeps_the_sum_from_zero[a, b]:
        given a != b && a != S::from(0);
        => (a + b) * (a / (a + b)) == a;
    /// The division is on one side of a case only, and the case is not where it may be made.
    undefined a_case_keeps_a_division_from_zero[a, b]:
        let ratio = if a >= b { a / (a - b) } else { S::from(1) };
        => ratio * ratio >= S::from(0);
    /// A root may be the negative one.
    refuted a_root_is_not_negative[a, r]: given r * r == a && a > S::from(0); => r > S::from(0);
    /// Numbers with the same square are the same.
    refuted squares_tell_signs[a, b]: given a * a == b * b; => a == b;
    /// A case distinction that has no answer where both are equal.
    refuted the_larger_of_two_without_a_tie[a, b]:
        let larger = if a < b { b } else if b < a { a } else { S::from(0) };
        => larger >= a && larger >= b;
    /// An inequality is multiplied by what may be negative.
    refuted an_inequality_times_any_number[a, b, c]: given a <= b; => a * c <= b * c;
    /// An inequality is divided by what may be negative.
    refuted an_inequality_over_any_number[a, b, c]: given c != S::from(0) && a > b * c; => a / c > b;
    /// Reciprocals turn an order whatever the signs.
    refuted reciprocals_turn_the_order[a, b]:
        given a != S::from(0) && b != S::from(0) && a < b;
        => S::from(1) / a > S::from(1) / b;
    /// Squares keep an order whatever the signs.
    refuted squares_keep_the_order[a, b]: given a <= b; => a * a <= b * b;
    /// A factor that may be zero is cancelled.
    refuted a_common_factor_is_cancelled[a, b, c]: given a * b == a * c; => b == c;
    /// Not negative is taken for positive.
    refuted a_product_of_nonnegative_numbers_is_positive[a, b]:
        given a >= S::from(0) && b >= S::from(0) && a + b > S::from(0);
        => a * b > S::from(0);
    /// The smaller of two by the formula of the larger.
    refuted the_smaller_of_two_is_the_second_plus_the_part_of_the_difference[a, b]:
        let smaller = b + positive_part(a - b);
        => smaller <= a && smaller <= b;
    /// The larger of two sums for the sum of the larger ones.
    refuted the_larger_sum_is_the_sum_of_the_larger[a, b, c, d]:
        let larger = |a: S, b: S| b + positive_part(a - b);
        => larger(a + c, b + d) >= larger(a, b) + larger(c, d);
    /// The triangle inequality turned round.
    refuted the_part_of_a_difference_is_at_most_that_of_the_parts[a, b]:
        => positive_part(a - b) <= positive_part(a) - positive_part(b);
    /// A convex function lies below its chord: between the ends, not beyond.
    refuted a_square_lies_below_its_chord_everywhere[a, b, t]:
        let s = S::from(1) - t;
        => (s * a + t * b) * (s * a + t * b) <= s * a * a + t * b * b;
    /// A convex function lies above its tangent, not below.
    refuted a_square_lies_below_its_tangent[a, b]: => a * a <= b * b + S::from(2) * b * (a - b);
    /// The Cauchy-Schwarz inequality is strict only where the vectors are independent.
    refuted cauchy_and_schwarz_are_strict[a, b, c, d]:
        given a * c + b * d > S::from(0);
        let product = a * c + b * d;
        => product * product < (a * a + b * b) * (c * c + d * d);
    /// The root of two is 1.4142, not 7/5.
    unmet what_has_a_square_below_two_is_below_seven_fifths[x]:
        given x * x < S::from(2);
        => S::from(5) * x < S::from(7);
    /// True of the integers.
    refuted no_number_lies_between_zero_and_one[x]: => x <= S::from(0) || x >= S::from(1);
    /// A product of three factors is positive where two of them have one sign and the third is positive: or where it is said of
    /// the wrong two.
    refuted a_product_of_three_is_positive[a, b, c]:
        given a * b > S::from(0) && b * c > S::from(0);
        => a * b * c > S::from(0);
    /// What is small beside a power is still there.
    refuted leading_terms_are_all_there_is[x]:
        given x > S::from(1);
        let power = x * x * x * x * x;
        => (power + x) / power == S::from(1);
    /// A definite form of two variables without the bound of its mixed term.
    refuted a_mixed_term_is_at_most_its_squares[a, b, x, y]:
        given a > S::from(0) && b > S::from(0);
        => a * x * x + b * y * y >= S::from(2) * x * y;
    /// From opposite signs of the values a root between, from the values' product a sign of their sum.
    refuted what_has_a_root_between_has_a_mean_of_zero[p, q]:
        given p < S::from(0) && q > S::from(0);
        let root = p / (p - q);
        => root + root == S::from(1);
    /// The integral of a positive part over an edge is that of the mean.
    refuted the_part_of_a_mean_is_the_mean_of_the_parts[p, q]:
        let two = S::from(2);
        => positive_part((p + q) / two) >= (positive_part(p) + positive_part(q)) / two;
    /// A gap that is forgotten on one side of complementarity.
    refuted complementarity_without_the_gap[u, g, sigma]:
        given u <= g && sigma <= S::from(0) && sigma * (u - g) == S::from(0);
        => sigma * u == S::from(0);
    /// Coercivity with the constant doubled.
    refuted a_difference_keeps_half_of_a_square[a, b, kappa]:
        given kappa >= S::from(0) && kappa < S::from(1) && b * b <= kappa * a * a;
        => a * a - b * b >= (S::from(1) - kappa * kappa) * a * a;
    /// The triangle inequality, turned.
    refuted a_norm_of_a_sum_is_at_least_the_sum[a, b]:
        let size = |x: S| positive_part(x) + positive_part(-x);
        => size(a + b) >= size(a) + size(b);
    /// A quotient of squares is at most that of what is larger above and below.
    refuted a_quotient_grows_with_both[a, b, c, d]:
        given S::from(0) < a && a <= c && S::from(0) < b && b <= d;
        => a / b <= c / d;
    /// The means of three numbers in the wrong order.
    refuted the_geometric_mean_is_the_larger_one[a, b]:
        given a > S::from(0) && b > S::from(0);
        => S::from(4) * a * b >= (a + b) * (a + b);
    /// Two conditions that exclude each other only nearly: a line touches a circle.
    refuted a_tangent_misses_its_circle[x, y]:
        given S::from(3) * x + S::from(4) * y == S::from(5);
        => x * x + y * y > S::from(1);
    /// (5) determines u: where sigma is zero any u below the gap will do.
    refuted a_pressure_determines_the_displacement[u, v, g, sigma, gamma]:
        given gamma > S::from(0) && gamma * sigma == -positive_part(u - g - gamma * sigma) && gamma * sigma == -positive_part(v - g - gamma * sigma);
        => u == v;
    /// The inverse of an inverse of a sum, with a sign lost.
    refuted an_inverse_of_a_difference_is_symmetric[a, b]:
        given a != b;
        => S::from(1) / (a - b) == S::from(1) / (b - a);
    /// A hypothesis that is true at one point only, and a conclusion that is wrong there.
    unmet what_follows_at_a_single_point[x, y]:
        given x * x + y * y <= S::from(2) * (x + y) - S::from(2);
        => x + y < S::from(2);
    /// The slope of the positive part times the number is more than the part.
    refuted slope_times_number_is_below_the_part[a]:
        => positive_part_slope(a) * a < positive_part(a) || a <= S::from(0);
    /// A transitivity with one of three comparisons turned.
    refuted a_circle_of_comparisons_is_an_equality[a, b, c]:
        given a <= b && b <= c && a * c >= S::from(0);
        => a * b + b * c <= b * b + a * c;
    /// The positive part of a sum is at most the sum of the parts.
    proved parts_add_up[a, b]: => positive_part(a) + positive_part(b) >= positive_part(a + b);
    /// Young's inequality.
    proved young[a, b, beta]:
        given beta > S::from(0);
        => a * b <= beta * a * a / S::from(2) + b * b / (S::from(2) * beta);
    /// A number that has no root.
    proved a_square_is_not_minus_two[x]: => x * x != S::from(-2);
    /// Divisions by what the hypothesis keeps from zero.
    proved a_quotient_returns[a, b]:
        given b * b > S::from(0);
        => a / b * b == a && S::from(1) / (S::from(3) * b) * b == S::from(1) / S::from(3);
    /// The same of a difference of squares.
    proved a_quotient_is_a_sum[a, b]:
        given a != b && a != -b;
        => (a - b) / (a * a - b * b) * (a + b) == S::from(1);
    /// An inequality is multiplied by what is positive.
    proved an_inequality_times_a_positive_number[a, b, c]: given a <= b && c > S::from(0); => a * c <= b * c;
    /// Reciprocals of positive numbers turn an order.
    proved reciprocals_turn_the_order_of_positive_numbers[a, b]:
        given a > S::from(0) && a < b;
        => S::from(1) / a > S::from(1) / b;
    /// The smaller of two by its formula.
    proved the_smaller_of_two_is_the_first_less_the_part_of_the_difference[a, b]:
        let smaller = a - positive_part(a - b);
        => smaller <= a && smaller <= b && (smaller == a || smaller == b);
    /// A convex function lies below its chord between the ends.
    proved a_square_lies_below_its_chord_between_the_ends[a, b, t]:
        given t >= S::from(0) && t <= S::from(1);
        let s = S::from(1) - t;
        => (s * a + t * b) * (s * a + t * b) <= s * a * a + t * b * b;
}

/// The false statements, with the conclusion of each that a rational point refutes, where there is one.
fn all() -> Vec<Statement> {
    let mut all: Vec<Statement> = listed()
        .into_iter()
        .filter(|(is_true, _)| !is_true)
        .map(|(_, statement)| statement)
        .collect();
    all.extend([
        statement!(a_square_is_sometimes_negative, [a], ["all", "negative"]),
        statement!(an_absolute_value_with_one_branch_wrong, [a], ["all"])
            .failing("size >= S::from(0)"),
        statement!(a_lemma_that_is_wrong_proves_what_is_right, [a, b], ["all"])
            .failing("a * b <= S::from(0)"),
    ]);
    all
}

/// The true neighbours are proved: what the engine refuses of the others is not refused for its form.
fn neighbours_are_proved() -> Outcome {
    let all: Vec<Statement> = listed()
        .into_iter()
        .filter(|(is_true, _)| *is_true)
        .map(|(_, statement)| statement)
        .collect();
    for statement in &all {
        let difference = |v: &[Sym]| v.get(1).map(|&b| v[0] - b).into_iter().collect();
        // One needs a hint.
        prove(statement)
            .or_else(|_| prove(&statement.with_hints(difference)))
            .map_err(|why| format!("{} is true, and refused: {why}", statement.name))?;
    }
    Ok(format!("{} statements", all.len()))
}

/// The row.
pub fn claim() -> Claim {
    let neighbours = "true_neighbours_of_false_statements_are_proved";
    let neighbours = by(Engine::Proof, neighbours, neighbours_are_proved);
    let mut checks = vec![neighbours.about(&["the proof engine"])];
    checks.extend(all().into_iter().map(false_statement));
    Claim {
        id: "23",
        title: "The proof engine refuses what is false",
        paper: "Nothing: the paper is proved by hand.",
        statement: "Each of 63 false statements is refused, not for its form: true neighbours of them are proved. Where a rational point refutes it, one is found at which the very conclusion fails that is wrong; the others have no rational counterexample (a root of two), or a hypothesis or a class that nothing meets. They are wrong by a sign, a case without a tie, a branch exchanged; an inequality multiplied or divided by what may be negative, a factor cancelled that may be zero, a division by what is zero at a single point or on one side of a case; the larger taken for the smaller, the chord for the tangent; a lemma that is wrong before a conclusion that is right; by a millionth; or they are true of integers and rationals only. Powers of degree 4095 keep their exponents, and of larger ones than 2^16 nothing is proved.",
        numbers: "every ordered field (proof).",
        preconditions: "None.",
        limits: "That the engine refuses these does not say that it refuses all that is false: for this there is the checker of certificates, in this crate and in `reference/check_certificates.py`.",
        single: Some("The row is about this engine."),
        checks,
    }
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
