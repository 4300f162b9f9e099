//! Lemma 3.1 at a curved solution that changes from contact to a gap at x = c, without any error: the field is a
//! polynomial on either side of c, so every integral of the discrete equations at the exact u is a rational number.
//!
//! With A(y) = -(y - 3y^3 + 2y^4), B(y) = 1 - 3y^2 + 2y^3, p = 8 \[x - c\]+^3 and q = -4 \[c - x\]+^2 the field
//! u = (A p', B p - A q) has u_n = -p, sigma_n = (lambda + 2 mu) q and no shear on y = 0, n = (0, -1): conditions (2).
//! Body force and tractions follow from (1). P1 and P2.
//! That the solver's own formulas of it, `study::exact::Smooth`, satisfy (1) and (2) is a test (tests/suite/exact.rs).

use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::Strategy;

use crate::Verdict;
use crate::bodies::{Body, Definition, Draw, bodies};
use crate::claim::Outcome;
use crate::draws;
use crate::naive::Line;
use crate::numbers::Exact;
use crate::proof::polynomial::{Exponent, Polynomial, integer};
use crate::{ensure, given};

type Point = [BigRational; 2];

fn constant(value: i64) -> Polynomial {
    Polynomial::constant(integer(value))
}

fn power(base: &Polynomial, exponent: Exponent) -> Polynomial {
    (0..exponent).fold(constant(1), |product, _| &product * base)
}

/// p with x and y replaced.
fn composed(p: &Polynomial, x: &Polynomial, y: &Polynomial) -> Polynomial {
    p.terms().fold(Polynomial::default(), |sum, (monomial, coefficient)| {
        let exponent = |i: usize| monomial.get(i).copied().unwrap_or(0);
        let product = &power(x, exponent(0)) * &power(y, exponent(1));
        &sum + &product.scaled(coefficient)
    })
}

fn factorial(n: Exponent) -> BigRational {
    (1..=i64::from(n)).fold(integer(1), |product, k| product * integer(k))
}

/// Coordinate i of a + s (b - a) + t (c - a), with a variable for each of the points b, c.
fn coordinate(a: &Point, others: &[&Point], i: usize) -> Polynomial {
    others.iter().enumerate().fold(Polynomial::constant(a[i].clone()), |sum, (variable, b)| {
        &sum + &Polynomial::variable(variable).scaled(&(&b[i] - &a[i]))
    })
}

/// The integral over a triangle.
fn over_triangle(p: &Polynomial, [a, b, c]: [&Point; 3]) -> BigRational {
    let [x, y] = [0, 1].map(|i| coordinate(a, &[b, c], i));
    let area = (&b[0] - &a[0]) * (&c[1] - &a[1]) - (&b[1] - &a[1]) * (&c[0] - &a[0]);
    let integral =
        composed(p, &x, &y).terms().fold(BigRational::zero(), |sum, (monomial, coefficient)| {
            let exponent = |i: usize| monomial.get(i).copied().unwrap_or(0);
            let (i, j) = (exponent(0), exponent(1));
            sum + coefficient * factorial(i) * factorial(j) / factorial(i + j + 2)
        });
    integral * area.abs()
}

/// p along the segment from a to b, as a polynomial in s.
fn along(p: &Polynomial, a: &Point, b: &Point) -> Line<Exact> {
    let [x, y] = [0, 1].map(|i| coordinate(a, &[b], i));
    composed(p, &x, &y).terms().fold(Line(vec![Exact::from(0)]), |sum, (monomial, coefficient)| {
        let mut power = vec![Exact::from(0); monomial.first().map_or(0, |&n| usize::from(n))];
        power.push(Exact::new(coefficient.clone()));
        sum.plus(&Line(power))
    })
}

/// Stress and body force of a polynomial field.
struct Smooth {
    u: [Polynomial; 2],
    /// xx, yy, xy
    stress: [Polynomial; 3],
    force: [Polynomial; 2],
}

impl Smooth {
    /// The solution right of c (a gap) or left of it (contact).
    fn new(c: &BigRational, right: bool, [lambda, mu]: &[BigRational; 2]) -> Smooth {
        let (x, y) = (Polynomial::variable(0), Polynomial::variable(1));
        let scaled = |p: Polynomial, k: i64| p.scaled(&integer(k));
        let (y3, y4) = (power(&y, 3), power(&y, 4));
        let a = &(&scaled(y3.clone(), 3) - &y) - &scaled(y4, 2);
        let b = &(&constant(1) - &scaled(power(&y, 2), 3)) + &scaled(y3, 2);
        let d = &x - &Polynomial::constant(c.clone());
        let zero = Polynomial::default();
        let (p, q) =
            if right { (scaled(power(&d, 3), 8), zero) } else { (zero, scaled(power(&d, 2), -4)) };
        let u = [&a * &p.derivative(0), &(&b * &p) - &(&a * &q)];
        let [xx, yy] = [u[0].derivative(0), u[1].derivative(1)];
        let trace = (&xx + &yy).scaled(lambda);
        let two_mu = mu * integer(2);
        let shear = (&u[0].derivative(1) + &u[1].derivative(0)).scaled(mu);
        let stress = [&trace + &xx.scaled(&two_mu), &trace + &yy.scaled(&two_mu), shear];
        let force = [
            -&(&stress[0].derivative(0) + &stress[2].derivative(1)),
            -&(&stress[2].derivative(0) + &stress[1].derivative(1)),
        ];
        Smooth { u, stress, force }
    }
}

/// The part of a polygon with x <= c, or x >= c.
fn clipped(polygon: &[Point], c: &BigRational, right: bool) -> Vec<Point> {
    let inside = |p: &Point| if right { p[0] >= *c } else { p[0] <= *c };
    let mut result = Vec::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        if inside(a) {
            result.push(a.clone());
        }
        if inside(a) != inside(b) {
            let s = (c - &a[0]) / (&b[0] - &a[0]);
            result.push([c.clone(), &a[1] + s * (&b[1] - &a[1])]);
        }
    }
    result
}

/// The part of \[0, 1\] where a + s (b - a) lies left or right of c, if any.
fn cut(a: &BigRational, b: &BigRational, c: &BigRational, right: bool) -> Option<[BigRational; 2]> {
    let inside = |x: &BigRational| if right { x >= c } else { x <= c };
    let root = || (c - a) / (b - a);
    match (inside(a), inside(b)) {
        (true, true) => Some([integer(0), integer(1)]),
        (true, false) => Some([integer(0), root()]),
        (false, true) => Some([root(), integer(1)]),
        (false, false) => None,
    }
}

/// The shape functions by the barycentric coordinates, in the order of the nodes.
fn shapes<const N: usize>(l: &[Polynomial; 3]) -> [Polynomial; N] {
    std::array::from_fn(|i| match (N, i) {
        (3, _) => l[i].clone(),
        (_, 0..3) => &l[i] * &(&(&l[i] + &l[i]) - &constant(1)),
        _ => (&l[(i + 1) % 3] * &l[(i + 2) % 3]).scaled(&integer(4)),
    })
}

/// v on a triangle as a polynomial, by the kernel's barycentric gradients.
fn test_function<const N: usize>(body: &Body, t: usize, v: &[[Exact; 2]]) -> [Polynomial; 2] {
    let gradients = body.triangle(t).barycentric_gradients();
    let origin = body.vertices[body.triangles[t][0]];
    let l = [0, 1, 2].map(|i| {
        (0..2).fold(constant(i64::from(i == 0)), |l, c| {
            let offset = &Polynomial::variable(c) - &Polynomial::constant(origin[c].value());
            &l + &offset.scaled(&gradients[i][c].value())
        })
    });
    let (shapes, nodal) = (shapes::<N>(&l), body.local::<N>(t, v));
    [0, 1].map(|component| {
        shapes.iter().zip(nodal).fold(Polynomial::default(), |sum, (shape, v)| {
            &sum + &shape.scaled(&v[component].value())
        })
    })
}

/// lambda and mu of a body that is drawn isotropic.
fn moduli(body: &Body) -> [BigRational; 2] {
    [body.material.lambda(), body.material.mu()].map(Exact::value)
}

/// The exact solution left and right of c.
fn sides(body: &Body, c: &BigRational) -> [(bool, Smooth); 2] {
    let moduli = moduli(body);
    [false, true].map(|right| (right, Smooth::new(c, right, &moduli)))
}

fn corner(body: &Body, vertex: usize) -> Point {
    body.vertices[vertex].map(Exact::value)
}

/// The ends of an edge.
fn ends(body: &Body, t: usize, i: usize) -> [Point; 2] {
    body.ends(t, i).map(|vertex| corner(body, vertex))
}

/// The integral over the body of sigma(u):eps(v), or of f . v.
fn over_body<const N: usize>(
    body: &Body,
    c: &BigRational,
    v: &[[Exact; 2]],
    density: impl Fn(&Smooth, &[Polynomial; 2]) -> Polynomial,
) -> BigRational {
    let mut total = BigRational::zero();
    for (right, exact) in &sides(body, c) {
        for (t, corners) in body.triangles.iter().enumerate() {
            let test = test_function::<N>(body, t, v);
            if test.iter().all(Polynomial::is_zero) {
                continue;
            }
            let density = density(exact, &test);
            let polygon = clipped(&corners.map(|vertex| corner(body, vertex)), c, *right);
            for k in 1..polygon.len().saturating_sub(1) {
                total += over_triangle(&density, [&polygon[0], &polygon[k], &polygon[k + 1]]);
            }
        }
    }
    total
}

/// sigma(u) : eps(v)
fn energy(exact: &Smooth, v: &[Polynomial; 2]) -> Polynomial {
    let strain =
        [v[0].derivative(0), v[1].derivative(1), &v[0].derivative(1) + &v[1].derivative(0)];
    let terms = exact.stress.iter().zip(&strain);
    terms.fold(Polynomial::default(), |sum, (stress, strain)| &sum + &(stress * strain))
}

/// a . b
fn dot(a: &[Polynomial; 2], b: &[Polynomial; 2]) -> Polynomial {
    &(&a[0] * &b[0]) + &(&a[1] * &b[1])
}

/// L(v): the body force, and the tractions on all sides but the contact line and the top.
fn load<const N: usize>(body: &Body, c: &BigRational, v: &[[Exact; 2]]) -> BigRational {
    let mut total = over_body::<N>(body, c, v, |exact, v| dot(&exact.force, v));
    for (right, exact) in &sides(body, c) {
        for &(t, i) in &body.free {
            let [a, b] = ends(body, t, i);
            let Some([start, end]) = cut(&a[0], &b[0], c, *right) else { continue };
            let (nx, ny) = (&b[1] - &a[1], &a[0] - &b[0]);
            let [xx, yy, xy] = &exact.stress;
            let traction = [&xx.scaled(&nx) + &xy.scaled(&ny), &xy.scaled(&nx) + &yy.scaled(&ny)];
            let work = dot(&traction, &test_function::<N>(body, t, v));
            total += along(&work, &a, &b).integral([start, end].map(Exact::new)).value();
        }
    }
    total
}

/// The contact terms of (8) at the exact u; `weight` times int (1/gamma) \[P(u)\]+ P0(v) in them.
fn contact<const N: usize>(
    body: &Body,
    c: &BigRational,
    v: &[[Exact; 2]],
    weight: i32,
) -> BigRational {
    let definition = Definition::<N>(body);
    let mut total = BigRational::zero();
    for (right, exact) in &sides(body, c) {
        for side in &body.contact {
            let [a, b] = ends(body, side.triangle, side.local);
            let Some([start, end]) = cut(&a[0], &b[0], c, *right) else { continue };
            let [start, end] = [start, end].map(Exact::new);
            let gamma = body.gamma(side);
            let (u_n, sigma_n) = (along(&-&exact.u[1], &a, &b), along(&exact.stress[1], &a, &b));
            let traces = definition.traces(side, v);
            let p = u_n.minus(&sigma_n.times(gamma));
            let mut density = sigma_n.by(&traces.sigma_n).times(-gamma);
            if p.at((start + end) / Exact::from(2)) > Exact::from(0) {
                density = density.plus(&p.by(&traces.p0).times(Exact::from(weight) / gamma));
            }
            total += (density.integral([start, end]) * side.length).value();
        }
    }
    total
}

/// The left side of the discrete equations at the exact u minus L(v), for a v that is zero at the top.
fn residual<const N: usize>(
    body: &Body,
    c: &BigRational,
    v: &[[Exact; 2]],
    weight: i32,
) -> BigRational {
    over_body::<N>(body, c, v, energy) - load::<N>(body, c, v) + contact::<N>(body, c, v, weight)
}

/// The field is a solution: (2) holds on y = 0 on either side of c, as polynomials or at the ends.
fn satisfies_2(c: &BigRational, moduli: &[BigRational; 2]) -> bool {
    [false, true].into_iter().all(|right| {
        let exact = Smooth::new(c, right, moduli);
        let floor = |p: &Polynomial| p.substituted(1, &BigRational::zero());
        let (u_n, sigma_n) = (floor(&-&exact.u[1]), floor(&exact.stress[1]));
        let away = c + integer(if right { 1 } else { -1 });
        floor(&exact.stress[2]).is_zero()
            && (&u_n * &sigma_n).is_zero()
            && if right { u_n.at(&[away]).is_negative() } else { sigma_n.at(&[away]).is_negative() }
    })
}

fn consistent<const N: usize>(draw: &Draw, (n, d): (i64, i64), weight: i32) -> Verdict {
    let body = draw.upright().body();
    let c = integer(n) / integer(n + d);
    ensure!(satisfies_2(&c, &moduli(&body)));
    let cut_edge = body.contact.iter().any(|side| {
        let [a, b] = ends(&body, side.triangle, side.local);
        (a[0] < c) != (b[0] < c)
    });
    given!(cut_edge);
    for v in body.basis::<N>() {
        ensure!(residual::<N>(&body, &c, &v, weight).is_zero());
    }
    Verdict::Holds("an edge with contact and gap")
}

fn curved_bodies() -> impl Strategy<Value = (Draw, (i64, i64))> {
    (bodies(1).prop_map(|draw| draw.isotropic()), draws::positive())
}

/// The residual vanishes at the curved solution, for P1 (N = 3) or P2.
pub fn residual_vanishes<const N: usize>(cases: u32) -> Outcome {
    let classes = ["an edge with contact and gap"];
    draws::hold(cases, curved_bodies(), &classes, |(draw, c)| consistent::<N>(draw, *c, 1))
}

/// Without the contact term: the penalty-free method is not consistent.
pub fn without_the_contact_term<const N: usize>() -> Outcome {
    draws::reject(curved_bodies(), |(draw, c)| consistent::<N>(draw, *c, 0))
}
