//! Integrals over contact edges, P1 and P2: in doubles beside exact integrals between the roots of P, and by points beside the sums
//! over them; the largest P on an edge, and where its sign changes; those of friction by those of contact, its slopes and its
//! energy.

use approx::abs_diff_eq;
use proptest::prelude::*;
use signorini::contact::EdgeRule;
use signorini::kernel::edge_integral::{ExactEdge, gauss, maximum, roots, value_at};
use signorini::kernel::friction::{ExactFriction, clip, clip_bregman, clip_energy, clip_slopes};
use signorini::kernel::{P1, P2, positive_part};
use signorini::model::Degree;

use props::bodies::sum;
use props::claim::Outcome;
use props::claims::friction::abs;
use props::naive::Line;
use props::numbers::Exact;
use props::proof::prove;
use props::verdict::{Ordered, Verdict};
use props::{draws, ensure, given, statement};

/// The planted mistake: the first value on an edge, times a number.
fn moved<const N: usize>(mut p: [f64; N], off: f64) -> [f64; N] {
    p[0] *= off;
    p
}

/// A millionth beside 1.
const OFF: f64 = 1.0 + 1e-6;

/// Where P of degree 1 is positive.
fn class([start, end]: [f64; 2]) -> &'static str {
    match (start > 0.0, end > 0.0) {
        (true, true) => "pressed",
        (false, false) => "open",
        _ => "cut",
    }
}

/// Values at the ends of an edge: multiples of 1/64, or anything.
fn ends() -> impl Strategy<Value = [f64; 2]> {
    let value = || prop_oneof![(-640_i32..=640).prop_map(|k| f64::from(k) / 64.0), -1.0_f64..1.0];
    [value(), value()]
}

/// |double - exact| <= bound
fn near(double: f64, exact: Exact, bound: f64) -> bool {
    double.is_finite() && (Exact::of_double(double) - exact).abs() <= Exact::of_double(bound)
}

/// P1 in doubles against the same function over rationals: within 2^-49 of the largest |p|, twice for the energy.
/// The length `active` and the second derivative depend on the root alone: within 2^-50.
fn p1_in_doubles(p: [f64; 2], off: f64) -> Verdict {
    let (e, exact) = (P1::exact(moved(p, off)), P1::exact(p.map(Exact::of_double)));
    let size = p[0].abs().max(p[1].abs());
    let (unit, root) = (size * 2.0_f64.powi(-49), 2.0_f64.powi(-50));
    ensure!(near(e.energy, exact.energy, size * unit));
    ensure!(near(e.active, exact.active, root));
    for i in 0..2 {
        ensure!(near(e.gradient[i], exact.gradient[i], unit));
        for j in 0..2 {
            ensure!(near(e.hessian[i][j], exact.hessian[i][j], root));
        }
    }
    Verdict::Holds(class(p))
}

/// c (s - r)(s - t) with dyadic roots, so that its nodal values are exact doubles and its integrals rational.
#[derive(Clone, Debug)]
struct Parabola {
    c: f64,
    roots: [f64; 2],
}

impl Parabola {
    fn at(&self, s: f64) -> f64 {
        self.c * (s - self.roots[0]) * (s - self.roots[1])
    }

    fn nodal(&self) -> [f64; 3] {
        [self.at(0.0), self.at(1.0), self.at(0.5)]
    }

    fn line(&self) -> Line<Exact> {
        let [start, end, middle] = self.nodal().map(Exact::of_double);
        Line::quadratic(start, middle, end)
    }

    /// The integral over {P > 0}: \[0, 1\] is cut at the roots.
    fn over(&self, q: &Line<Exact>) -> Exact {
        let mut cuts = vec![0.0, 1.0];
        cuts.extend(self.roots.iter().filter(|&&r| 0.0 < r && r < 1.0));
        cuts.sort_by(f64::total_cmp);
        let positive = cuts.windows(2).filter(|w| self.at((w[0] + w[1]) / 2.0) > 0.0);
        sum(positive, |w| q.integral([w[0], w[1]].map(Exact::of_double)))
    }

    fn class(&self) -> &'static str {
        match self.roots.iter().filter(|&&r| 0.0 < r && r < 1.0).count() {
            0 => "no root",
            1 => "one root",
            _ if self.roots[0] == self.roots[1] => "double root",
            _ => "two roots",
        }
    }
}

fn parabolas() -> impl Strategy<Value = Parabola> {
    let root = || (-8_i32..=40).prop_map(|k| f64::from(k) / 32.0);
    let factor = prop::sample::select(&[1.0, -1.0, 3.0, -0.625]);
    (factor, root(), root(), 0_u8..6)
        .prop_map(|(c, r, t, tie)| Parabola { c, roots: [r, if tie == 0 { r } else { t }] })
}

const PARABOLAS: [&str; 4] = ["no root", "one root", "double root", "two roots"];

/// The shape functions of a P2 edge as polynomials.
fn shapes() -> [Line<Exact>; 3] {
    let [zero, one] = [0, 1].map(Exact::from);
    [
        Line::quadratic(one, zero, zero),
        Line::quadratic(zero, zero, one),
        Line::quadratic(zero, one, zero),
    ]
}

/// P2 in doubles against exact integration between the roots: within 2^-44 of max(1, |p|) squared. A double root
/// changes no sign, but its neighbourhood may be counted as positive or not: there `active` and the second
/// derivative are left out.
fn p2_in_doubles(parabola: &Parabola, off: f64) -> Verdict {
    let e = P2::exact(moved(parabola.nodal(), off));
    let (p, shapes) = (parabola.line(), shapes());
    let over = |q: &Line<Exact>| parabola.over(q);
    let bound = 2.0_f64.powi(-44) * 100.0;
    ensure!(near(e.energy, over(&p.by(&p)) / Exact::from(2), bound));
    let class = parabola.class();
    for i in 0..3 {
        ensure!(near(e.gradient[i], over(&p.by(&shapes[i])), bound));
        for j in 0..3 {
            let exact = over(&shapes[i].by(&shapes[j]));
            ensure!(class == "double root" || near(e.hessian[i][j], exact, bound));
        }
    }
    let active = over(&Line(vec![Exact::from(1)]));
    ensure!(class == "double root" || near(e.active, active, bound));
    Verdict::Holds(class)
}

/// The Bregman distance of the energy, 1/2 int [Q]+^2 - 1/2 int [P]+^2 - int [P]+ (Q - P), against exact arithmetic,
/// for P1.
fn bregman_p1([p, q]: [[f64; 2]; 2], off: f64) -> Verdict {
    let exact = |p: [f64; 2]| P1::exact(p.map(Exact::of_double));
    let size = p.iter().chain(&q).fold(0.0, |m: f64, v| m.max(v.abs()));
    let step = [0, 1].map(|a| Exact::of_double(q[a]) - Exact::of_double(p[a]));
    let linear = sum([0, 1], |a| exact(p).gradient[a] * step[a]);
    let distance = EdgeRule::Exact.bregman(Degree::One, None, &moved(p, off), &q);
    let expected = exact(q).energy - exact(p).energy - linear;
    ensure!(near(distance, expected, size * size * 2.0_f64.powi(-46)));
    Verdict::Holds(class(p))
}

/// For P2, by points too.
fn bregman_p2([p, q]: [&Parabola; 2], off: f64) -> Verdict {
    // int over {P > 0} of P R
    let against = |p: &Parabola, r: &Parabola| p.over(&p.line().by(&r.line()));
    let half = Exact::ratio(1, 2);
    let expected = half * (against(q, q) + against(p, p)) - against(p, q);
    let moved = moved(p.nodal(), off);
    let distance = EdgeRule::Exact.bregman(Degree::Two, None, &moved, &q.nodal());
    ensure!(near(distance, expected, 100.0 * 2.0_f64.powi(-44)));
    let rule = [(0.125, 0.25), (0.5, 0.5), (0.75, 0.25)];
    let points = EdgeRule::Gauss(rule.to_vec());
    let by_points = points.bregman(Degree::Two, None, &moved, &q.nodal());
    let expected = sum(rule, |(s, w)| {
        let [p, q] = [p, q].map(|r| r.line().at(Exact::of_double(s)));
        let [a, b] = [p, q].map(positive_part);
        Exact::of_double(w) * (half * (b * b - a * a) - a * (q - p))
    });
    ensure!(near(by_points, expected, 100.0 * 2.0_f64.powi(-48)));
    Verdict::Holds(p.class())
}

/// The largest value on an edge: at an end or at the vertex of the parabola, half way between its roots.
fn maximum_is_found(parabola: &Parabola, off: f64) -> Verdict {
    let middle = (parabola.roots[0] + parabola.roots[1]) / 2.0;
    let inside = if 0.0 < middle && middle < 1.0 { middle } else { 0.0 };
    let largest = [0.0, 1.0, inside].map(|s| parabola.at(s)).into_iter().fold(f64::MIN, f64::max);
    let found = maximum::<P2, 6, 3>(moved(parabola.nodal(), off));
    ensure!(abs_diff_eq!(found, largest, epsilon = 10.0 * 2.0_f64.powi(-48)));
    let ends = [parabola.at(0.0), parabola.at(1.0)];
    ensure!(maximum::<P1, 3, 2>(ends) == ends[0].max(ends[1]));
    Verdict::Holds(parabola.class())
}

/// The places where P changes its sign: its simple roots inside the edge, and no others.
fn sign_changes(parabola: &Parabola, off: f64) -> Verdict {
    let mut expected = parabola.roots.to_vec();
    expected.retain(|&r| 0.0 < r && r < 1.0 && parabola.roots[0] != parabola.roots[1]);
    expected.sort_by(f64::total_cmp);
    let mut found: Vec<f64> = roots::<P2, 6, 3>(moved(parabola.nodal(), off)).collect();
    found.sort_by(f64::total_cmp);
    ensure!(found.len() == expected.len());
    ensure!(found.iter().zip(&expected).all(|(a, b)| abs_diff_eq!(
        a,
        b,
        epsilon = 2.0_f64.powi(-44)
    )));
    let [start, end] = [parabola.at(0.0), parabola.at(1.0)];
    let of_p1: Vec<f64> = roots::<P1, 3, 2>([start, end]).collect();
    ensure!(of_p1.len() == usize::from(start * end < 0.0));
    ensure!(of_p1.iter().all(|s| abs_diff_eq!(
        *s,
        start / (start - end),
        epsilon = 2.0_f64.powi(-50)
    )));
    Verdict::Holds(parabola.class())
}

/// Three values.
fn values() -> impl Strategy<Value = [(i64, i64); 3]> {
    [draws::ratio(), draws::ratio(), draws::ratio()]
}

/// `gauss` over rationals is the sum over the rule's points of \[P\]+ and its companions.
fn sums_over_points(values: &[(i64, i64); 3], off: Exact) -> Verdict {
    let p = values.map(Exact::from);
    let (line, shapes) = (Line::quadratic(p[0], p[2], p[1]), shapes());
    // A rule with positive weights; it need not be a good one, for both sides use it.
    let points =
        [[(1, 8), (1, 4)], [(1, 2), (5, 12)], [(5, 6), (1, 3)]].map(|point| point.map(Exact::from));
    let e = gauss::<P2, Exact, 6, 3>(p, None, points.map(|[s, w]| (s, off * w)));
    let positive = |s| positive_part(line.at(s));
    let slope = |s| Exact::from(i32::from(line.at(s) > Exact::from(0)));
    let of = |f: &dyn Fn(Exact) -> Exact| sum(&points, |&[s, w]| w * f(s));
    ensure!(Exact::from(2) * e.energy == of(&|s| positive(s) * positive(s)));
    ensure!(e.active == of(&slope));
    for i in 0..3 {
        ensure!(e.gradient[i] == of(&|s| positive(s) * shapes[i].at(s)));
        for j in 0..3 {
            let exact = of(&|s| slope(s) * shapes[i].at(s) * shapes[j].at(s));
            ensure!(e.hessian[i][j] == exact);
        }
    }
    let s = Exact::ratio(2, 7);
    ensure!(value_at::<P2, Exact, 6, 3>(p, s) == line.at(s));
    Verdict::Holds("always")
}

const ENDS: [&str; 3] = ["cut", "open", "pressed"];

/// The integrals of friction over an edge, by those of contact: F = \[P + m\]+ - \[P - m\]+ - m.
fn sections<S: Ordered>(p: [S; 2], m: [S; 2], shift: [S; 2]) -> Verdict {
    let (zero, two, six) = (S::from(0), S::from(2), S::from(6));
    given!(m[0] >= zero && m[1] >= zero);
    let e = P1::exact_friction(p, m);
    let upper = P1::exact([p[0] + shift[0], p[1] + shift[1]]);
    let lower = P1::exact([p[0] - shift[0], p[1] - shift[1]]);
    let mass = |v: [S; 2], i: usize| (two * v[i] + v[1 - i]) / six;
    for i in 0..2 {
        ensure!(e.gradient[i] == upper.gradient[i] - lower.gradient[i] - mass(m, i));
    }
    let (between, half) =
        (mass(m, 0) * p[0] + mass(m, 1) * p[1], mass(m, 0) * m[0] + mass(m, 1) * m[1]);
    ensure!(e.energy == upper.energy - lower.energy - between - half / two);
    // Where P is the bound all along, which of the two derivatives is taken is a choice: the edge slides.
    let is_bound = p[0] == m[0] && p[1] == m[1];
    for i in 0..2 {
        for j in 0..2 {
            ensure!(is_bound || e.by_p[i][j] == upper.hessian[i][j] - lower.hessian[i][j]);
        }
    }
    // The gradient is homogeneous in the data: what both derivatives say of it.
    for (i, gradient) in e.gradient.into_iter().enumerate() {
        let tangent =
            (0..2).fold(zero, |sum, j| sum + e.by_p[i][j] * p[j] + e.by_bound[i][j] * m[j]);
        ensure!(tangent == gradient);
    }
    ensure!(if is_bound { e.sticks == zero } else { e.sticks == upper.active - lower.active });
    ensure!(e.sticks + e.slides <= S::from(1));
    Verdict::Holds(if e.slides == zero {
        "sticks"
    } else if e.sticks == zero {
        "slides"
    } else {
        "cut"
    })
}

/// By sections they are what the definition says, for a bound that is constant along the edge.
fn sections_of_friction_are_their_definition<S: Ordered>([p0, p1, m]: [S; 3]) -> Verdict {
    given!(m > S::from(0));
    sections([p0, p1], [m, m], [m, m])
}

/// For a bound that is affine along the edge.
fn sections_with_an_affine_bound_are_their_definition<S: Ordered>(
    [p0, p1, m0, m1]: [S; 4],
) -> Verdict {
    given!(m0 > S::from(0) && m1 > S::from(0));
    sections([p0, p1], [m0, m1], [m0, m1])
}

/// For a bound that is taken for its value at the start.
fn control_sections_with_the_bound_of_one_end<S: Ordered>([p0, p1, m0, m1]: [S; 4]) -> Verdict {
    given!(m0 > S::from(0) && m1 > S::from(0));
    sections([p0, p1], [m0, m1], [m0, m0])
}

/// An edge that sticks at its start and slides at its end, with a bound that grows.
fn bound_of_one_end() -> Outcome {
    Exact::scope(|| {
        let data = [1, 5, 2, 3].map(Exact::from);
        match control_sections_with_the_bound_of_one_end(data) {
            Verdict::Fails(what) => Ok(format!("rejected: {what}")),
            other => Err(format!("not noticed: {other:?}")),
        }
    })
}

/// The slopes that Newton's method uses: one of them at most is not zero, and with them clip(x; \[m\]+) is homogeneous.
fn slopes_of_the_clip_add_up_to_it<S: Ordered>([x, m]: [S; 2]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    let [by_x, by_m] = clip_slopes(x, m);
    ensure!(by_x + abs(by_m) <= one && by_x >= zero);
    ensure!(clip(x, positive_part(m)) == by_x * x + by_m * m);
    Verdict::Holds(if by_x == one {
        "sticks"
    } else if by_m == zero {
        "open"
    } else {
        "slides"
    })
}

/// The energy is convex with the clip for its derivative: its Bregman distance is not negative, and is what the kernel computes.
fn bregman_distance_of_friction_is_its_definition<S: Ordered>([a, b, m]: [S; 3]) -> Verdict {
    let zero = S::from(0);
    given!(m >= zero);
    let distance = clip_bregman(a, b, m);
    ensure!(distance == clip_energy(b, m) - clip_energy(a, m) - clip(a, m) * (b - a));
    ensure!(distance >= zero);
    Verdict::Holds(if distance == zero { "none" } else { "some" })
}

checks! {
    slopes_of_the_clip_add_up_to_it => prove(&statement!(slopes_of_the_clip_add_up_to_it, [x, m], ["sticks", "slides", "open"]));
    bregman_distance_of_friction_is_its_definition => prove(&statement!(bregman_distance_of_friction_is_its_definition, [a, b, m], ["none", "some"]));
    sections_of_friction_are_their_definition => draws::hold_exactly(&statement!(sections_of_friction_are_their_definition, [p0, p1, m], ["sticks", "slides", "cut"]));
    sections_with_an_affine_bound_are_their_definition => draws::hold_exactly(&statement!(sections_with_an_affine_bound_are_their_definition, [p0, p1, m0, m1], ["sticks", "slides", "cut"]));
    control_sections_with_the_bound_of_one_end => bound_of_one_end();
    sums_over_points_are_their_definitions => draws::hold(500, values(), &["always"], |v| sums_over_points(v, Exact::from(1)));
    control_weights_of_points_that_are_off => draws::reject(values(), |v| sums_over_points(v, Exact::of_double(OFF)));
    cut_p1_edges_in_doubles_are_near_the_exact_integrals => draws::hold(4000, ends(), &ENDS, |&p| p1_in_doubles(p, 1.0));
    control_p1_edges_that_are_off => draws::reject(ends(), |&p| p1_in_doubles(p, OFF));
    cut_p2_edges_in_doubles_are_near_the_exact_integrals => draws::hold(2000, parabolas(), &PARABOLAS, |p| p2_in_doubles(p, 1.0));
    control_p2_edges_that_are_off => draws::reject(parabolas(), |p| p2_in_doubles(p, OFF));
    bregman_distances_of_p1_are_near_the_exact_ones => draws::hold(2000, [ends(), ends()], &ENDS, |&both| bregman_p1(both, 1.0));
    control_bregman_distances_of_p1_that_are_off => draws::reject([ends(), ends()], |&both| bregman_p1(both, OFF));
    bregman_distances_of_p2_are_near_the_exact_ones => draws::hold(2000, [parabolas(), parabolas()], &PARABOLAS, |[p, q]| bregman_p2([p, q], 1.0));
    control_bregman_distances_of_p2_that_are_off => draws::reject([parabolas(), parabolas()], |[p, q]| bregman_p2([p, q], OFF));
    the_maximum_on_an_edge_is_at_an_end_or_at_the_vertex => draws::hold(2000, parabolas(), &PARABOLAS, |p| maximum_is_found(p, 1.0));
    control_a_maximum_that_is_off => draws::reject(parabolas(), |p| maximum_is_found(p, OFF));
    signs_change_at_the_simple_roots_inside_an_edge => draws::hold(2000, parabolas(), &PARABOLAS, |p| sign_changes(p, 1.0));
    control_roots_that_are_off => draws::reject(parabolas(), |p| sign_changes(p, OFF));
}
