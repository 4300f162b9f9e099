//! What the other rows rest on in floating point: intervals contain the exact result, and the kernel's functions, run
//! over intervals, contain their values.

use signorini::kernel::interval::sorted;
use signorini::kernel::{Interval, positive_part};

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
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use proptest::prelude::*;
    use signorini::kernel::P1;
    use signorini::kernel::edge_integral::ExactEdge;

    use crate::claim::{Claim, Engine, Outcome, by, control, model_checked};
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

    /// Two intervals, as their ends in any order, and a place inside each.
    type Pair = (Vec<f64>, [f64; 2]);

    fn pairs() -> impl Strategy<Value = Pair> {
        (draws::doubles(4), [0.0_f64..=1.0, 0.0_f64..=1.0])
    }

    fn inside(lo: f64, hi: f64, place: f64) -> f64 {
        let x = lo + place * (hi - lo);
        if x >= lo && x <= hi { x } else { lo }
    }

    /// The exact results of the four operations at points of two intervals lie in the results of the intervals.
    fn operations((ends, places): &Pair, add: impl Fn(Interval, Interval) -> Interval) -> Verdict {
        let [x, y] = [(0, 1), (2, 3)].map(|(i, j)| Interval::new(ends[i], ends[j]));
        let at = [
            (x.lo(), y.lo()),
            (x.lo(), y.hi()),
            (x.hi(), y.lo()),
            (x.hi(), y.hi()),
            (inside(x.lo(), x.hi(), places[0]), inside(y.lo(), y.hi(), places[1])),
        ];
        Exact::scope(|| {
            for (a, b) in at {
                let (a, b) = (Exact::of_double(a), Exact::of_double(b));
                ensure!(encloses(add(x, y), a + b));
                ensure!(encloses(x - y, a - b));
                ensure!(encloses(x * y, a * b));
                ensure!(encloses(-x, -a));
                ensure!(encloses(x.hull(y), a) && encloses(x.hull(y), b));
                if b != Exact::from(0) {
                    ensure!(encloses(x / y, a / b));
                }
            }
            ensure!(positive_part(x) == Interval::new(x.lo().max(0.0), x.hi().max(0.0)));
            let root = x.sqrt();
            if x.lo() >= 0.0 {
                let [low, high] = [root.lo(), root.hi()].map(Exact::of_double);
                ensure!(low >= Exact::from(0));
                ensure!(low * low <= Exact::of_double(x.lo()));
                ensure!(high * high >= Exact::of_double(x.hi()));
            }
            Verdict::Holds(match (x.contains(0.0), y.contains(0.0)) {
                (true, true) => "both across zero",
                (false, false) => "neither across zero",
                _ => "one across zero",
            })
        })
    }

    fn enclosures() -> Outcome {
        let classes = ["both across zero", "neither across zero", "one across zero"];
        draws::hold(5000, pairs(), &classes, |pair| operations(pair, |x, y| x + y))
    }

    /// The sum rounded to nearest, without the step outwards.
    fn no_step_outwards() -> Outcome {
        draws::reject(5000, pairs(), |pair| {
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

    /// The row of the floating-point foundations.
    pub fn claim() -> Claim {
        let mut checks = vec![
            by(Engine::Doubles, "operations_of_intervals_contain_the_exact_results", enclosures),
            by(Engine::Doubles, "edge_integrals_over_intervals_contain_the_exact_ones", edges),
            control(
                Engine::Doubles,
                "control_rounding_to_nearest_does_not_enclose",
                no_step_outwards,
            ),
        ];
        checks.extend(HARNESSES.iter().copied().map(model_checked));
        Claim {
            id: "13",
            items: &["floating point"],
            title: "What the above rests on in floating point",
            paper: "Nothing: the paper computes in R.",
            statement: "For intervals X, Y of doubles and numbers x in X, y in Y: x + y, x - y, x y, x / y (y not 0) and sqrt(x) lie in X + Y, X - Y, X Y, X / Y and sqrt(X). [X]+ is [[lo]+, [hi]+], sharp across zero. The integrals over a cut P1 edge, by the same source line over intervals, contain the exact ones.",
            numbers: "doubles against exact rational arithmetic, over all finite doubles with subnormals, overflow and ties.",
            kernel: &[
                "interval::Interval::new",
                "interval::Interval::point",
                "interval::Interval::lo",
                "interval::Interval::hi",
                "interval::Interval::is_nan",
                "interval::Interval::contains",
                "interval::Interval::hull",
                "interval::Interval::sqrt",
                "interval::sorted",
            ],
            preconditions: "The processor rounds +, -, *, / and sqrt to nearest, as IEEE 754 says.",
            limits: "The enclosure of a rounded operation is tested, not proved, over all doubles: no solver at hand decides it.",
            single: Some(
                "Rounding is a fact about doubles alone; exact rationals are the other side of each comparison. The harnesses for the model checker have no receipt yet.",
            ),
            checks,
        }
    }
}
