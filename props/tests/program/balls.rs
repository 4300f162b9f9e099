//! Balls, the numbers in which errors are enclosed: around doubles, in which certificates are checked, and around double-doubles, in
//! which the discrete solution is enclosed. Each operation on members of the operands is one of exact rationals, and must lie in the result.

use proptest::prelude::*;
use signorini::contact::EdgeRule;
use signorini::contact::moments::moments;
use signorini::kernel::DoubleDouble;
use signorini::kernel::PreciseBall;
use signorini::kernel::edge_integral::ExactEdge;
use signorini::kernel::{Ball, Enclosing, P1, positive_part};
use signorini::model::Degree;

use props::claim::Outcome;
use props::numbers::Exact;
use props::verdict::Verdict;
use props::{draws, ensure};

/// Two pairs of doubles and two relative widths.
type Draw = ([f64; 4], [f64; 2]);

fn data() -> impl Strategy<Value = Draw> {
    let size = || prop_oneof![3 => 1e-3_f64..1e3, 3 => -1e3_f64..-1e-3, 1 => Just(0.0)];
    let width = || prop_oneof![2 => Just(0.0), 1 => 1e-12_f64..1e-9, 1 => 1e-3_f64..3.0];
    ([size(), size(), size(), size()], [width(), width()])
}

/// The centre of a ball of twice the precision: its head is a double, and so is what is left.
fn centre(ball: PreciseBall) -> Exact {
    value(ball.centre())
}

/// |x - centre| <= `share` times the radius.
fn covers(ball: PreciseBall, x: Exact, share: f64) -> bool {
    (x - centre(ball)).abs() <= Exact::of_double(ball.radius()) * Exact::of_double(share)
}

/// A number of twice the precision, without a radius.
fn fine(a: f64, b: f64) -> PreciseBall {
    PreciseBall::point((PreciseBall::from(a) + PreciseBall::from(b * 2.0_f64.powi(-54))).centre())
}

/// Both ends of a ball, and its centre.
fn members(ball: PreciseBall) -> [Exact; 3] {
    let (centre, radius) = (centre(ball), Exact::of_double(ball.radius()));
    [centre - radius, centre, centre + radius]
}

/// Twice the precision: `share` of each radius covers what is off.
fn fine_balls(&([a, b, c, d], [r, s]): &Draw, share: f64) -> Verdict {
    let zero = Exact::from(0);
    let (x, y) = (fine(a, b), fine(c, d));
    let (x, y) = (x.widened(r * a.abs()), y.widened(s * c.abs()));
    for ball in [x, y, x * y, x - y] {
        let [low, _, high] = members(ball);
        ensure!(Exact::of_double(ball.lower()) <= low && high <= Exact::of_double(ball.upper()));
        let most = Exact::of_double(ball.magnitude());
        ensure!(low.abs() <= most && high.abs() <= most);
        let least = Exact::of_double(ball.least_magnitude());
        ensure!(least == zero || (low > zero) == (high > zero));
        ensure!(least <= low.abs() && least <= high.abs());
    }
    let divides = y.least_magnitude() > 0.0;
    for u in members(x) {
        ensure!(covers(positive_part(x), positive_part(u), share));
        for v in members(y) {
            ensure!(covers(x + y, u + v, share));
            ensure!(covers(x - y, u - v, share));
            ensure!(covers(x * y, u * v, share));
            ensure!(!divides || covers(x / y, u / v, share));
        }
    }
    if x.lower() > 0.0 {
        let [low, _, high] = members(x.sqrt());
        let [least, _, most] = members(x);
        ensure!(low > zero && low * low <= least && most <= high * high);
    }
    if r == 0.0 && s == 0.0 {
        // Numbers without a radius: results to a hundred bits or so.
        let small = Exact::of_double(2.0_f64.powi(-98));
        let [u, v] = [centre(x).abs(), centre(y).abs()];
        let narrow =
            |ball: PreciseBall, size: Exact| Exact::of_double(ball.radius()) <= small * size;
        ensure!(narrow(x + y, u + v) && narrow(x - y, u + v));
        ensure!(u * v == zero || narrow(x * y, u * v));
        ensure!(!divides || u == zero || narrow(x / y, u / v));
        return Verdict::Holds("numbers");
    }
    Verdict::Holds("wide")
}

/// Balls of twice the precision.
pub fn fine_balls_contain_the_exact_results() -> Outcome {
    draws::hold(1000, data(), &["numbers", "wide"], |draw| fine_balls(draw, 1.0))
}

/// With no radius they do not.
pub fn centres_contain_the_exact_results() -> Outcome {
    draws::reject(data(), |draw| fine_balls(draw, 0.0))
}

/// Numbers that contain both `a` and `b`: what a number across zero answers with `a` below and `b` above.
fn between<S: Enclosing>(a: f64, b: f64) -> S {
    if a == b {
        return S::exactly(a);
    }
    let third = S::from(1) / S::from(3);
    (third + -third).split(|_| S::exactly(a), |_| S::exactly(b))
}

/// The results of members are in the results.
fn balls<S: Enclosing>(&([a, b, c, d], [r, s]): &Draw) -> Verdict {
    let ends = |a: f64, r: f64| [a - r * a.abs(), a + r * a.abs()];
    let ([al, ah], [cl, ch]) = (ends(a, r), ends(c, s));
    let (x, y): (S, S) = (between(al, ah), between(cl, ch));
    let z = S::exactly(b) * S::exactly(d);
    let contains = |found: S, exact: Exact| {
        Exact::of_double(found.lower()) <= exact && exact <= Exact::of_double(found.upper())
    };
    let [b, d] = [b, d].map(Exact::of_double);
    let divides = y.lower() > 0.0 || y.upper() < 0.0;
    for u in [al, ah].map(Exact::of_double) {
        ensure!(contains(x, u) && contains(-x, -u));
        ensure!(contains(positive_part(x), positive_part(u)));
        for v in [cl, ch].map(Exact::of_double) {
            ensure!(contains(x + y, u + v) && contains(x - y, u - v));
            ensure!(contains(x * y, u * v) && contains(z, b * d));
            ensure!(contains((x + y) * z - x * y, (u + v) * (b * d) - u * v));
            ensure!(!divides || contains(x / y, u / v));
            ensure!(!divides || contains((x * z) / y + x, u * (b * d) / v + u));
        }
        if x.lower() >= 0.0 {
            let [low, high] = [x.sqrt().lower(), x.sqrt().upper()].map(Exact::of_double);
            ensure!(low >= Exact::from(0) && low * low <= u && u <= high * high);
        }
    }
    if r == 0.0 && s == 0.0 {
        let narrow = |found: S, size: f64| found.upper() - found.lower() <= 1e-14 * size;
        ensure!(narrow(x + y, a.abs() + c.abs()) && narrow(x * y, (a * c).abs()));
        return Verdict::Holds("numbers");
    }
    Verdict::Holds("wide")
}

/// The products of members are within the radius of the centre, as far as both are asked for.
fn centres(&([a, _, c, _], [r, s]): &Draw) -> Verdict {
    let [r, s] = [r * a.abs(), s * c.abs()];
    let product = Ball::around(a, r) * Ball::around(c, s);
    let [a, c, r, s, centre, radius] =
        [a, c, r, s, product.centre(), product.radius()].map(Exact::of_double);
    for u in [a - r, a, a + r] {
        for v in [c - s, c, c + s] {
            ensure!(centre - radius <= u * v && u * v <= centre + radius);
        }
    }
    Verdict::Holds("within")
}

/// Balls of either precision.
pub fn balls_contain_the_exact_results() -> Outcome {
    let classes = ["numbers", "wide"];
    let single = draws::hold(1500, data(), &classes, balls::<Ball>)?;
    draws::hold(200, data(), &["within"], centres)?;
    let precise = draws::hold(500, data(), &classes, balls::<PreciseBall>)?;
    Ok(format!("around doubles: {single}; around double-doubles: {precise}"))
}

/// Doubles do not.
pub fn doubles_contain_the_exact_results() -> Outcome {
    draws::reject(data(), balls::<f64>)
}

/// A dividend, twelve divisors, and radii that are small beside the first, which is near 1.
type Chain = (f64, [u8; 12], f64, [f64; 16]);

fn chains() -> impl Strategy<Value = Chain> {
    let small = 0.0..f64::EPSILON / 2.0;
    (0.1_f64..10.0, prop::array::uniform12(3_u8..100), 1.0_f64..1.5, prop::array::uniform16(small))
}

/// Roundings add up: of twelve quotients in the centre, of sixteen sums in the radius. What one double outwards hides of a
/// single operation it does not hide of a chain.
fn chain<S: Enclosing>(&(start, divisors, radius, radii): &Chain, around: fn(f64) -> S) -> Verdict {
    let (mut found, mut exact) = (S::exactly(start), Exact::of_double(start));
    for divisor in divisors.map(i32::from) {
        found /= S::from(divisor);
        exact /= Exact::from(divisor);
    }
    let inside = |found: &S, exact: Exact| {
        Exact::of_double(found.lower()) <= exact && exact <= Exact::of_double(found.upper())
    };
    ensure!(inside(&found, exact));
    let (mut sum, mut end) = (around(radius), Exact::of_double(radius));
    for radius in radii {
        sum += around(radius);
        end += Exact::of_double(radius);
    }
    ensure!(inside(&sum, end) && inside(&sum, -end));
    Verdict::Holds("always")
}

/// Chains of balls.
pub fn chains_of_balls_contain_the_exact_results() -> Outcome {
    draws::hold(300, chains(), &["always"], |data| chain(data, |r| Ball::around(0.0, r)))
}

/// Chains of doubles do not contain them.
pub fn chains_of_doubles_are_exact() -> Outcome {
    draws::reject(chains(), |data| chain(data, |r| r))
}

/// int \[P\]+ N_a for P of P1 in balls contains that of each of their numbers, cut at its own root; `share` of each radius
/// covers what is off.
fn moments_of(draw: &Draw, share: f64) -> Verdict {
    let &([a, b, ..], [r, s]) = draw;
    let p = [PreciseBall::from(a).widened(r * a.abs()), PreciseBall::from(b).widened(s * b.abs())];
    let found = moments(&EdgeRule::Exact, Degree::One, None, &p);
    Exact::scope(|| {
        for start in members(p[0]) {
            for end in members(p[1]) {
                let exact = <P1 as ExactEdge<Exact, 3, 2>>::exact([start, end]).gradient;
                for (found, exact) in found.iter().zip(exact) {
                    ensure!(covers(*found, exact, share));
                }
            }
        }
        Verdict::Holds(match (r > 0.0 || s > 0.0, (a > 0.0) != (b > 0.0)) {
            (true, true) => "balls, cut",
            (true, false) => "balls, not cut",
            (false, _) => "points",
        })
    })
}

/// The contact terms in balls.
pub fn moments_of_balls_contain_those_of_their_numbers() -> Outcome {
    let classes = ["balls, cut", "balls, not cut", "points"];
    draws::hold(300, data(), &classes, |draw| moments_of(draw, 1.0))
}

/// A twentieth of their radii.
pub fn moments_of_balls_within_a_twentieth_of_them() -> Outcome {
    draws::reject(data(), |draw| moments_of(draw, 0.05))
}

/// The number that it stands for.
fn value(a: DoubleDouble) -> Exact {
    Exact::of_double(a.head()) + Exact::of_double(a.tail())
}

/// The four operations are exact to 2^`bits` of what they are made of.
fn double_double(&[a, b, c, d]: &[f64; 4], bits: i32) -> Verdict {
    let small = 2.0_f64.powi(-54);
    let (x, y) = (DoubleDouble::sum(a, b * small), DoubleDouble::sum(c, d * small));
    let [exact_x, exact_y] = [x, y].map(value);
    ensure!(exact_x == Exact::of_double(a) + Exact::of_double(b * small));
    let product = DoubleDouble::product(a, c);
    ensure!(value(product) == Exact::of_double(a) * Exact::of_double(c));
    let unit = Exact::of_double(2.0_f64.powi(bits));
    let near = |found: DoubleDouble, exact: Exact, size: Exact| {
        (value(found) - exact).abs() <= unit * size
    };
    let sizes = [exact_x, exact_y].map(Exact::abs);
    ensure!(near(x + y, exact_x + exact_y, sizes[0] + sizes[1]));
    ensure!(near(x - y, exact_x - exact_y, sizes[0] + sizes[1]));
    ensure!(near(x * y, exact_x * exact_y, sizes[0] * sizes[1]));
    ensure!(near(x / y, exact_x / exact_y, sizes[0] / sizes[1]));
    Verdict::Holds(if (a > 0.0) == (c > 0.0) { "one sign" } else { "two signs" })
}

fn double_doubles() -> impl Strategy<Value = [f64; 4]> {
    let size = || prop_oneof![1e-3_f64..1e3, -1e3_f64..-1e-3];
    [size(), size(), size(), size()]
}

/// Numbers of twice the precision keep 100 bits.
pub fn double_doubles_keep_a_hundred_bits() -> Outcome {
    draws::hold(500, double_doubles(), &["one sign", "two signs"], |draw| double_double(draw, -100))
}

/// To 120 bits they are not exact.
pub fn double_doubles_keep_120_bits() -> Outcome {
    draws::reject(double_doubles(), |draw| double_double(draw, -120))
}

checks! {
    double_doubles_keep_a_hundred_bits => double_doubles_keep_a_hundred_bits();
    operations_of_balls_contain_the_exact_results => balls_contain_the_exact_results();
    chains_of_balls_contain_the_exact_results => chains_of_balls_contain_the_exact_results();
    control_chains_of_doubles_are_exact => chains_of_doubles_are_exact();
    operations_of_balls_of_twice_the_precision_contain_the_exact_results => fine_balls_contain_the_exact_results();
    moments_of_balls_contain_those_of_their_numbers => moments_of_balls_contain_those_of_their_numbers();
    control_moments_of_balls_within_a_twentieth_of_them => moments_of_balls_within_a_twentieth_of_them();
    control_doubles_for_balls => doubles_contain_the_exact_results();
    control_centres_for_balls_of_twice_the_precision => centres_contain_the_exact_results();
    control_double_doubles_keep_120_bits => double_doubles_keep_120_bits();
}
