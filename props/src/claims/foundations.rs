//! What the other rows rest on in floating point: intervals contain the exact result, and the kernel's functions, run
//! over intervals, contain their values.

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
    use proptest::prelude::*;
    use signorini::kernel::edge_integral::ExactEdge;
    use signorini::kernel::{P1, positive_part_slope};

    use crate::claim::{Claim, Outcome, model_checked};
    use crate::claims::balls;
    use crate::numbers::Exact;
    use crate::verdict::Verdict;
    use crate::{draws, ensure, given};

    use super::*;

    /// Whether the exact number lies in the interval; an infinite end is no bound.
    fn encloses(interval: Interval, value: Exact) -> bool {
        let (lo, hi) = (interval.lo(), interval.hi());
        (lo == f64::NEG_INFINITY || (lo.is_finite() && Exact::of_double(lo) <= value))
            && (hi == f64::INFINITY || (hi.is_finite() && value <= Exact::of_double(hi)))
    }

    /// Two intervals and a place inside each. Some have no bound on one side, or on both.
    type Pair = ([Interval; 2], [f64; 2]);

    fn pairs() -> impl Strategy<Value = Pair> {
        let bounded = prop::array::uniform4(prop::bool::weighted(0.9));
        (draws::doubles(4), bounded, [0.0_f64..=1.0, 0.0_f64..=1.0]).prop_map(|(v, b, places)| {
            let least = |i: usize| if b[i] { v[i] } else { f64::NEG_INFINITY };
            let greatest = |i: usize| if b[i] { v[i] } else { f64::INFINITY };
            ([0, 2].map(|i| Interval::new(least(i), greatest(i + 1))), places)
        })
    }

    /// The finite ends of an interval, and a number between them.
    fn members(x: Interval, place: f64) -> impl Iterator<Item = f64> + Clone {
        let (lo, hi) = (x.lo().max(f64::MIN), x.hi().min(f64::MAX));
        let inside = (lo * (1.0 - place) + hi * place).clamp(lo, hi);
        [x.lo(), x.hi(), inside].into_iter().filter(|a| a.is_finite())
    }

    /// The exact results of the operations at members of two intervals lie in the results of the intervals.
    fn operations(
        &([x, y], places): &Pair,
        add: impl Fn(Interval, Interval) -> Interval,
    ) -> Verdict {
        for (a, b) in members(x, places[0]).flat_map(|a| members(y, places[1]).map(move |b| (a, b)))
        {
            ensure!(x.contains(a) && y.contains(b));
            let (a, b) = (Exact::of_double(a), Exact::of_double(b));
            ensure!(encloses(add(x, y), a + b));
            ensure!(encloses(x - y, a - b));
            ensure!(encloses(x * y, a * b));
            ensure!(encloses(-x, -a));
            if b != Exact::from(0) {
                ensure!(encloses(x / y, a / b));
            }
            if a >= Exact::from(0) {
                let (low, high) = (x.sqrt().lo(), x.sqrt().hi());
                ensure!(low >= 0.0 && square(low) <= a);
                ensure!(high == f64::INFINITY || square(high) >= a);
            }
        }
        let bounded = [x.lo(), x.hi(), y.lo(), y.hi()].iter().all(|end| end.is_finite());
        Verdict::Holds(match (bounded, x.contains(0.0), y.contains(0.0)) {
            (false, ..) => "unbounded",
            (true, true, true) => "both across zero",
            (true, false, false) => "neither across zero",
            _ => "one across zero",
        })
    }

    fn square(x: f64) -> Exact {
        Exact::of_double(x) * Exact::of_double(x)
    }

    /// How wide the results are: of two numbers at most two doubles, and not at all where the result is zero without
    /// underflow; hull and positive part are exact, and a root is bounded by the roots of the ends.
    fn widths(&([x, y], _): &Pair) -> Verdict {
        let narrow = |i: Interval| i.lo().next_up().next_up() >= i.hi();
        for (a, b) in members(x, 0.0).flat_map(|a| members(y, 0.0).map(move |b| (a, b))) {
            let (p, q) = (Interval::point(a), Interval::point(b));
            ensure!(p.lo() == a && p.hi() == a);
            ensure!([p + q, p - q, p * q].into_iter().all(narrow));
            ensure!(a + b != 0.0 || p + q == Interval::point(0.0));
            ensure!((a != 0.0 && b != 0.0) || p * q == Interval::point(0.0));
            ensure!(b == 0.0 || narrow(p / q) && (a != 0.0 || p / q == Interval::point(0.0)));
            ensure!((p / q == Interval::new(f64::NEG_INFINITY, f64::INFINITY)) == (b == 0.0));
            if a > 0.0 && b > 0.0 {
                let [up, beyond] = [a, b].map(|end| Interval::new(end, f64::INFINITY));
                let (least, greatest) = ((a / b).next_down(), (a / b).next_up());
                let below_zero = -f64::from_bits(1);
                ensure!(up / q == Interval::new(least, f64::INFINITY));
                ensure!(p / beyond == Interval::new(below_zero, greatest));
                ensure!(up / beyond == Interval::new(below_zero, f64::INFINITY));
                ensure!(-up / beyond == -(up / beyond) && up / -beyond == -(up / beyond));
                ensure!(-up / -beyond == up / beyond);
            }
        }
        let zero = Interval::point(0.0);
        ensure!(x * zero == zero && zero * x == zero && (x.contains(0.0) || zero / x == zero));
        ensure!(x.hull(y) == Interval::new(x.lo().min(y.lo()), x.hi().max(y.hi())));
        ensure!(positive_part(x) == Interval::new(x.lo().max(0.0), x.hi().max(0.0)));
        let root = x.sqrt();
        ensure!(root.is_nan() == (x.hi() < 0.0));
        given!(!root.is_nan());
        if x.lo() > 0.0 {
            ensure!(root.lo().next_up() == x.lo().sqrt());
        } else {
            ensure!(root.lo() == 0.0);
        }
        ensure!(root.hi() == if x.hi() == 0.0 { 0.0 } else { x.hi().sqrt().next_up() });
        Verdict::Holds(if x.lo() > 0.0 { "positive" } else { "not positive" })
    }

    /// A NaN makes both ends NaN, whatever it meets, and nothing else does.
    fn nan_stays(&([x, y], _): &Pair) -> Verdict {
        let nan = Interval::new(f64::NAN, x.lo());
        let is_nan = |i: Interval| i.is_nan() && i.lo().is_nan() && i.hi().is_nan();
        ensure!(is_nan(nan) && is_nan(Interval::new(x.lo(), f64::NAN)));
        ensure!([nan + x, x + nan, nan - x, x - nan, nan * x, x * nan].into_iter().all(is_nan));
        ensure!([nan / x, x / nan, nan.hull(x), x.hull(nan)].into_iter().all(is_nan));
        ensure!([-nan, nan.sqrt(), positive_part(nan)].into_iter().all(is_nan));
        ensure!(!nan.contains(x.lo()) && !x.contains(f64::NAN));
        ensure!(![x, x + y, x - y, x * y, x / y, -x, x.hull(y)].into_iter().any(Interval::is_nan));
        Verdict::Holds(if x.contains(0.0) { "across zero" } else { "not across zero" })
    }

    fn enclosures() -> Outcome {
        let classes = ["both across zero", "neither across zero", "one across zero", "unbounded"];
        draws::hold(1500, pairs(), &classes, |pair| operations(pair, |x, y| x + y))
    }

    fn sharpness() -> Outcome {
        draws::hold(1500, pairs(), &["positive", "not positive"], widths)
    }

    fn nans() -> Outcome {
        draws::hold(500, pairs(), &["across zero", "not across zero"], nan_stays)
    }

    /// The sum rounded to nearest, without the step outwards.
    fn no_step_outwards() -> Outcome {
        draws::reject(pairs(), |pair| {
            operations(pair, |x, y| Interval::new(x.lo() + y.lo(), x.hi() + y.hi()))
        })
    }

    /// The integrals over a cut edge, run over intervals, contain the exact ones for the numbers inside; and for points
    /// away from a touch the result is narrow.
    fn edges() -> Outcome {
        let data = ([-2.0_f64..2.0, -2.0_f64..2.0], [0.0_f64..0.1, 0.0_f64..0.1], prop::bool::ANY);
        draws::hold(1500, data, &["points", "wide"], |&(p, widths, wide)| {
            let widths = if wide { widths } else { [0.0; 2] };
            let around = [0, 1].map(|i| Interval::new(p[i] - widths[i], p[i] + widths[i]));
            let e = P1::exact(around);
            Exact::scope(|| {
                let exact = P1::exact(p.map(Exact::of_double));
                ensure!(encloses(e.energy, exact.energy) && encloses(e.active, exact.active));
                for i in 0..2 {
                    ensure!(encloses(e.gradient[i], exact.gradient[i]));
                    for j in 0..2 {
                        ensure!(encloses(e.hessian[i][j], exact.hessian[i][j]));
                    }
                }
                given!(wide || (p[0] - p[1]).abs() > 0.01);
                ensure!(wide || e.energy.hi() - e.energy.lo() < 1e-12);
                Verdict::Holds(if wide { "wide" } else { "points" })
            })
        })
    }

    /// Branches on an interval (`split`): [X]+ and its slope contain those of the numbers in X, 0 included.
    fn branches(&([x, _], places): &Pair, slope: impl Fn(Interval) -> Interval) -> Verdict {
        let zero = Some(0.0).filter(|&zero| x.contains(zero));
        for a in members(x, places[0]).chain(zero) {
            ensure!(slope(x).contains(positive_part_slope(a)));
            ensure!(positive_part(x).contains(positive_part(a)));
        }
        Verdict::Holds(match (x.lo(), x.hi()) {
            (lo, _) if lo > 0.0 => "positive",
            (0.0, hi) if hi > 0.0 => "from zero",
            (_, hi) if hi > 0.0 => "across zero",
            _ => "not positive",
        })
    }

    /// Intervals of which many begin at zero.
    fn intervals() -> impl Strategy<Value = Pair> {
        (pairs(), 0_u8..4).prop_map(|(([x, y], places), kind)| {
            let from_zero = if x.hi() > 0.0 { Interval::new(0.0, x.hi()) } else { x };
            ([if kind == 0 { from_zero } else { x }, y], places)
        })
    }

    const BRANCHES: [&str; 4] = ["positive", "from zero", "across zero", "not positive"];

    fn slopes() -> Outcome {
        draws::hold(2000, intervals(), &BRANCHES, |pair| branches(pair, positive_part_slope))
    }

    /// An interval [0, hi] counts as positive.
    fn slopes_by_the_upper_end() -> Outcome {
        draws::reject(intervals(), |pair| {
            branches(
                pair,
                |x| {
                    if x.lo() >= 0.0 { Interval::from(1) } else { positive_part_slope(x) }
                },
            )
        })
    }

    /// The row of the floating-point foundations.
    pub fn claim() -> Claim {
        let mut checks = vec![
            doubles!("operations_of_intervals_contain_the_exact_results" => enclosures())
                .about(&["floating point"]),
            doubles!("results_of_intervals_are_as_narrow_as_stated" => sharpness())
                .about(&["floating point"]),
            doubles!("a_nan_makes_an_interval_nan_and_nothing_else_does" => nans()),
            doubles!("edge_integrals_over_intervals_contain_the_exact_ones" => edges())
                .about(&["floating point"]),
            doubles!("slopes_of_intervals_contain_those_of_their_numbers" => slopes()),
            doubles!("double_doubles_keep_a_hundred_bits" => balls::double_doubles_keep_a_hundred_bits()),
            doubles!("operations_of_balls_contain_the_exact_results" => balls::balls_contain_the_exact_results()),
            doubles!("chains_of_balls_contain_the_exact_results" => balls::chains_of_balls_contain_the_exact_results()),
            doubles!("control_chains_of_doubles_are_exact" => balls::chains_of_doubles_are_exact()),
            doubles!("operations_of_balls_of_twice_the_precision_contain_the_exact_results" => balls::fine_balls_contain_the_exact_results()),
            doubles!("moments_of_balls_contain_those_of_their_numbers" => balls::moments_of_balls_contain_those_of_their_numbers()),
            doubles!("control_moments_of_balls_within_a_twentieth_of_them" => balls::moments_of_balls_within_a_twentieth_of_them()),
            doubles!("control_doubles_for_balls" => balls::doubles_contain_the_exact_results()),
            doubles!("control_centres_for_balls_of_twice_the_precision" => balls::centres_contain_the_exact_results()),
            doubles!("control_double_doubles_keep_120_bits" => balls::double_doubles_keep_120_bits()),
            doubles!("control_slope_by_the_sign_of_the_upper_end" => slopes_by_the_upper_end()),
            doubles!("control_rounding_to_nearest_does_not_enclose" => no_step_outwards()),
        ];
        checks.extend(HARNESSES.iter().copied().map(model_checked));
        Claim {
            id: "13",
            title: "What the above rests on in floating point",
            paper: "Nothing: the paper computes in R.",
            statement: "For intervals X, Y of doubles and numbers x in X, y in Y: x + y, x - y, x y, x / y (y not 0) and sqrt(x) lie in X + Y, X - Y, X Y, X / Y and sqrt(X). [X]+ is [[lo]+, [hi]+], sharp across zero, and the slope of [X]+ contains that at each number, for X = [0, hi] that at 0. Of two numbers the result is at most two doubles wide, and exact where it is zero without underflow; an end may be infinite (no bound); a NaN makes both ends NaN. The integrals over a cut P1 edge, by the same source line over intervals, contain the exact ones. The same for the balls in which certificates are checked and the discrete solution is enclosed (a double, or a number of twice the precision, with a radius): the results of members of the operands, and chains of three, lie in the results, which for numbers without a radius are known to 1e-14, or to 2^-98. Sums and products of two doubles as double-doubles are exact, and +, -, *, / of these are off by at most 2^-100 of what goes in. The factor L D L^T in them solves a system with Pascal's matrix of order 24 plus the identity, whose solution doubles do not know to 1e-9, to that, and a matrix with a negative entry on its diagonal has none. The contact terms of P1 over an edge in balls contain those of each of their numbers.",
            numbers: "doubles against exact rational arithmetic, drawn from all finite doubles with subnormals, overflow and ties.",
            preconditions: "The processor rounds +, -, *, / and sqrt to nearest, as IEEE 754 says.",
            limits: "The enclosure of a rounded operation is tested, not proved, over all doubles: no solver at hand decides it.",
            single: Some(
                "Rounding is a fact about doubles alone; exact rationals are the other side of each comparison. What the model checker has said of the harnesses is listed with each.",
            ),
            checks,
        }
    }
}
