//! What the other rows rest on in floating point: balls contain the exact results.

use signorini::kernel::{Ball, Enclosing};

use crate::harnesses;

harnesses! {
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
        checks.extend(model_checked(HARNESSES));
        Claim {
            id: "13",
            title: "What the above rests on in floating point",
            paper: "Nothing: the paper computes in R.",
            statement: "For the balls in which certificates are checked and the discrete solution is enclosed (a double, or a number of twice the precision, with a radius): the results of members of the operands, and chains of three, lie in the results, which for numbers without a radius are known to 1e-14, or to 2^-98. Sums and products of two doubles as double-doubles are exact, and +, -, *, / of these are off by at most 2^-100 of what goes in. The factor L D L^T in them solves a system with Pascal's matrix of order 24 plus the identity, whose solution doubles do not know to 1e-9, to that, and a matrix with a negative entry on its diagonal has none. The contact terms of P1 over an edge in balls contain those of each of their numbers.",
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
