//! What the other rows rest on in floating point: balls, and intervals in which the checker of certificates is run too, contain
//! the exact results.

use crate::numbers::Interval;
use crate::numbers::interval::sorted;
use signorini::kernel::{Ball, Enclosing, positive_part};

use crate::harness::{any, assume};
use crate::harnesses;

harnesses! {
    /// The step outwards.
    holds neighbours_enclose_for_all_finite_doubles() {
        let x: f64 = any();
        assume(x.is_finite());
        assert!(x.next_down() < x && x < x.next_up());
    }
    /// The false twin: a step outwards is finite.
    fails control_neighbours_are_finite_for_all_finite_doubles([f64::MAX]) {
        let x: f64 = any();
        assume(x.is_finite());
        assert!(x.next_up().is_finite());
    }
    /// Inclusion: \[x\]+ lies in the positive part of any interval that contains x.
    holds positive_part_of_an_interval_contains_those_of_its_numbers_for_all_finite_doubles() {
        let (lo, x, hi): (f64, f64, f64) = (any(), any(), any());
        assume(lo <= x && x <= hi && lo.is_finite() && hi.is_finite());
        assert!(positive_part(Interval::new(lo, hi)).contains(positive_part(x)));
    }
    /// The false twin: the middle branch forgotten, as `if a > 0` would.
    fails control_undecided_sign_counts_as_negative_for_all_finite_doubles([-1.0, 1.0, 1.0]) {
        let (lo, x, hi): (f64, f64, f64) = (any(), any(), any());
        assume(lo <= x && x <= hi && lo.is_finite() && hi.is_finite());
        let cut = if lo > 0.0 { Interval::new(lo, hi) } else { Interval::new(0.0, 0.0) };
        assert!(cut.contains(positive_part(x)));
    }
    /// The corner rule of the product.
    holds product_lies_between_the_products_of_ends_for_integers_within_16() {
        let [a, x, b, c, y, d] = [any(), any(), any(), any(), any(), any()].map(|v: i8| i32::from(v));
        assume(-16 <= a && a <= x && x <= b && b <= 16);
        assume(-16 <= c && c <= y && y <= d && d <= 16);
        let [least, .., greatest] = sorted([a * c, a * d, b * c, b * d]);
        assert!(least <= x * y && x * y <= greatest);
    }
    /// The false twin: the products of equal ends only.
    fails control_product_lies_between_the_products_of_equal_ends_for_integers_within_16([0.0, 1.0, 1.0, -1.0, -1.0, 0.0]) {
        let [a, x, b, c, y, d] = [any(), any(), any(), any(), any(), any()].map(|v: i8| i32::from(v));
        assume(-16 <= a && a <= x && x <= b && b <= 16);
        assume(-16 <= c && c <= y && y <= d && d <= 16);
        let [least, .., greatest] = sorted([a * c, a * c, b * d, b * d]);
        assert!(least <= x * y && x * y <= greatest);
    }
    /// A product is rounded outwards: the rounded one, which need not be exact, is strictly inside. At given numbers, for
    /// two products of doubles are more than a solver can compare; the exact engine has the others.
    holds products_of_intervals_are_rounded_outwards_at_seven_pairs() {
        for k in 1..8 {
            let (x, y) = (f64::from(k) / 10.0, f64::from(2 * k - 9) / 3.0);
            let product = Interval::point(x) * Interval::point(y);
            assert!(product.lo() < x * y && x * y < product.hi());
        }
    }
    /// The false twin: rounded to nearest.
    fails control_products_of_intervals_are_rounded_to_nearest_at_seven_pairs([]) {
        for k in 1..8 {
            let (x, y) = (f64::from(k) / 10.0, f64::from(2 * k - 9) / 3.0);
            let product = Interval::point(x) * Interval::point(y);
            assert!(product.lo() == x * y || x * y == product.hi());
        }
    }
    /// Four numbers are sorted, and are the same numbers: their sum and their sum of squares are.
    holds four_numbers_are_sorted_for_all_i8() {
        let v = [any(), any(), any(), any()].map(|v: i8| i32::from(v));
        let [a, b, c, d] = sorted(v);
        assert!(a <= b && b <= c && c <= d);
        assert!(a + b + c + d == v[0] + v[1] + v[2] + v[3]);
    }
    /// The false twin: strictly.
    fails control_four_numbers_are_sorted_strictly_for_all_i8([0.0; 4]) {
        let v = [any(), any(), any(), any()].map(|v: i8| i32::from(v));
        let [a, b, c, d] = sorted(v);
        assert!(a < b && b < c && c < d);
    }
    /// Each quotient adds its rounding: 1/9/5/11/17 in balls has 1/8415, and so the double nearest to that.
    holds four_quotients_of_balls_keep_their_roundings() {
        let quotient = [9, 5, 11, 17].into_iter().fold(Ball::from(1), |q, d| q / Ball::from(d));
        let nearest = 1.0 / 8415.0;
        assert!(quotient.lower() <= nearest && nearest <= quotient.upper());
    }
    /// The false twin: the same quotients of doubles.
    fails control_four_quotients_of_doubles_are_the_nearest([]) {
        let quotient = Ball::exactly(1.0 / 9.0 / 5.0 / 11.0 / 17.0);
        let nearest = 1.0 / 8415.0;
        assert!(quotient.lower() <= nearest && nearest <= quotient.upper());
    }
    /// Radii are rounded upwards: to 1 the radius 2^-54 is added eight times.
    holds radii_are_not_lost_in_eight_sums() within 10 {
        let small = Ball::around(0.0, f64::EPSILON / 4.0);
        let sum = (0..8).fold(Ball::around(0.0, 1.0), |sum, _| sum + small);
        assert!(sum.upper() >= 1.0 + 2.0 * f64::EPSILON);
    }
    /// The false twin: radii rounded to nearest.
    fails control_radii_are_rounded_to_nearest_in_eight_sums([]) within 10 {
        let sum = (0..8).fold(1.0, |sum: f64, _| sum + f64::EPSILON / 4.0);
        assert!(sum >= 1.0 + 2.0 * f64::EPSILON);
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::{Claim, model_checked};
    use crate::claims::balls;

    /// The row of the floating-point foundations.
    pub fn claim() -> Claim {
        let mut checks = vec![
            doubles!("double_doubles_keep_a_hundred_bits" => balls::double_doubles_keep_a_hundred_bits()).about(&["floating point"]),
            doubles!("operations_of_balls_contain_the_exact_results" => balls::balls_contain_the_exact_results()).about(&["floating point"]),
            doubles!("chains_of_balls_contain_the_exact_results" => balls::chains_of_balls_contain_the_exact_results()),
            doubles!("control_chains_of_doubles_are_exact" => balls::chains_of_doubles_are_exact()),
            doubles!("operations_of_balls_of_twice_the_precision_contain_the_exact_results" => balls::fine_balls_contain_the_exact_results()).about(&["floating point"]),
            doubles!("moments_of_balls_contain_those_of_their_numbers" => balls::moments_of_balls_contain_those_of_their_numbers()),
            doubles!("control_moments_of_balls_within_a_twentieth_of_them" => balls::moments_of_balls_within_a_twentieth_of_them()),
            doubles!("control_doubles_for_balls" => balls::doubles_contain_the_exact_results()),
            doubles!("control_centres_for_balls_of_twice_the_precision" => balls::centres_contain_the_exact_results()),
            doubles!("control_double_doubles_keep_120_bits" => balls::double_doubles_keep_120_bits()),
        ];
        checks.extend(HARNESSES.iter().copied().map(model_checked));
        Claim {
            id: "13",
            title: "What the above rests on in floating point",
            paper: "Nothing: the paper computes in R.",
            statement: "For the balls (and intervals) in which certificates are checked and the discrete solution is enclosed (a double, or a number of twice the precision, with a radius): the results of members of the operands, and chains of three, lie in the results, which for numbers without a radius are known to 1e-14, or to 2^-98. Sums and products of two doubles as double-doubles are exact, and +, -, *, / of these are off by at most 2^-100 of what goes in. The factor L D L^T in them solves a system with Pascal's matrix of order 24 plus the identity, whose solution doubles do not know to 1e-9, to that, and a matrix with a negative entry on its diagonal has none. The contact terms of P1 over an edge in balls contain those of each of their numbers.",
            numbers: "doubles against exact rational arithmetic, drawn.",
            preconditions: "The processor rounds +, -, *, / and sqrt to nearest, as IEEE 754 says.",
            limits: "The enclosure of a rounded operation is tested, not proved, over all doubles: no solver at hand decides it.",
            single: Some(
                "Rounding is a fact about doubles alone; exact rationals are the other side of each comparison. What the model checker has said of the harnesses is listed with each.",
            ),
            checks,
        }
    }
}
