//! False statements for the proof engine: it must refuse every one of them, in builds with and without overflow checks. Some
//! are nearly true, some true of the rationals only, some would be true if the engine forgot a path, an inverse or a carry.

use signorini::kernel::{positive_part, positive_part_slope};

use super::{prove, refute};
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

/// The statements, with the conclusion of each that a rational point refutes, where there is one.
fn all() -> Vec<Statement> {
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
    ]
}

#[test]
fn no_false_statement_is_proved() {
    for statement in all() {
        if let Ok(said) = prove(&statement) {
            panic!("{} is false, and proved: {said}", statement.name);
        }
    }
}

#[test]
fn what_a_rational_point_refutes_is_refuted_by_the_conclusion_that_is_wrong() {
    let mut refuted = 0;
    for statement in all().into_iter().filter(|statement| statement.conclusion.is_some()) {
        let said = refute(&statement);
        assert!(said.is_ok(), "{}: {said:?}", statement.name);
        refuted += 1;
    }
    assert_eq!(refuted, 13);
}

/// True neighbours of some of them: what the engine refuses above is not refused for its form.
#[test]
fn their_true_neighbours_are_proved() {
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
    for statement in [
        statement!(parts_add_up, [a, b], ["all"]),
        statement!(young, [a, b, beta], ["all"]),
        statement!(a_square_is_not_minus_two, [x], ["all"]),
        statement!(a_quotient_is_a_sum, [a, b], ["all"]),
    ] {
        let said = prove(&statement);
        assert!(said.is_ok(), "{}: {said:?}", statement.name);
    }
}
