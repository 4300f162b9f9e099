//! Lemma 3.1 at a curved solution that changes from contact to a gap at x = c, without any error: the field is a
//! polynomial on either side of c, so every integral of the discrete equations at the exact u is a rational number.
//!
//! With A(y) = -(y - 3y^3 + 2y^4), B(y) = 1 - 3y^2 + 2y^3, p = 8 \[x - c\]+^3 and q = -4 \[c - x\]+^2 the field
//! u = (A p', B p - A q) has u_n = -p, sigma_n = (lambda + 2 mu) q and no shear on y = 0, n = (0, -1): conditions (2).
//! Body force and tractions follow from (1). P1 and P2, whose gradients and P0(v) come from the kernel. The solver has the
//! same solution by other formulas, `fem::exact::Smooth`: its doubles, and the L that it assembles from them, are compared.

use std::sync::Arc;

use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use proptest::prelude::Strategy;
use signorini::fem::exact::{self, Kind};
use signorini::fem::{Degree, Mesh, Problem, Space, loads};
use signorini::kernel::{Element, Material, P1, P2, Plane};

use crate::Verdict;
use crate::bodies::{Body, Draw, Kernel, bodies};
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

/// a + s (b - a), in the variable with this number.
fn between(a: &BigRational, b: &BigRational, variable: usize) -> Polynomial {
    Polynomial::variable(variable).scaled(&(b - a))
}

/// The integral over a triangle.
fn over_triangle(p: &Polynomial, [a, b, c]: [&Point; 3]) -> BigRational {
    let coordinate = |i: usize| {
        let start = Polynomial::constant(a[i].clone());
        &(&start + &between(&a[i], &b[i], 0)) + &between(&a[i], &c[i], 1)
    };
    let area = (&b[0] - &a[0]) * (&c[1] - &a[1]) - (&b[1] - &a[1]) * (&c[0] - &a[0]);
    let reference = composed(p, &coordinate(0), &coordinate(1));
    let integral = reference.terms().fold(BigRational::zero(), |sum, (monomial, coefficient)| {
        let exponent = |i: usize| monomial.get(i).copied().unwrap_or(0);
        let (i, j) = (exponent(0), exponent(1));
        sum + coefficient * factorial(i) * factorial(j) / factorial(i + j + 2)
    });
    integral * area.abs()
}

/// p along the segment from a to b, as a polynomial in s.
fn along(p: &Polynomial, a: &Point, b: &Point) -> Polynomial {
    let coordinate = |i: usize| &Polynomial::constant(a[i].clone()) + &between(&a[i], &b[i], 0);
    composed(p, &coordinate(0), &coordinate(1))
}

/// The integral of a polynomial in s.
fn over_interval(p: &Polynomial, [start, end]: [&BigRational; 2]) -> BigRational {
    p.terms().fold(BigRational::zero(), |sum, (monomial, coefficient)| {
        let exponent = monomial.first().copied().unwrap_or(0);
        let at = |s: &BigRational| (0..=exponent).fold(integer(1), |product, _| product * s);
        sum + coefficient * (at(end) - at(start)) / integer(i64::from(exponent) + 1)
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
    fn new(c: &BigRational, right: bool, [lambda, mu]: [&BigRational; 2]) -> Smooth {
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
fn moduli(body: &Body) -> [Exact; 2] {
    [body.material.lambda(), body.material.mu()]
}

/// The exact solution left and right of c.
fn sides(body: &Body, c: &BigRational) -> [(bool, Smooth); 2] {
    let [lambda, mu] = moduli(body).map(|x| x.value());
    [false, true].map(|right| (right, Smooth::new(c, right, [&lambda, &mu])))
}

fn corner(body: &Body, vertex: usize) -> Point {
    body.vertices[vertex].map(|x| x.value())
}

/// The ends of an edge.
fn ends(body: &Body, t: usize, i: usize) -> [Point; 2] {
    [1, 2].map(|k| corner(body, body.triangles[t][(i + k) % 3]))
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
            total += over_interval(&along(&work, &a, &b), [&start, &end]);
        }
    }
    total
}

/// The polynomial in s with these values at 0 and 1, and at 1/2 if there are three.
fn line(values: &[Exact]) -> Polynomial {
    let line = match *values {
        [start, end] => Line::affine(start, end),
        [start, end, middle] => Line::quadratic(start, middle, end),
        _ => Line(Vec::new()),
    };
    let terms = line.0.iter().zip(0 as Exponent..);
    terms.fold(Polynomial::default(), |sum, (c, n)| {
        &sum + &power(&Polynomial::variable(0), n).scaled(&c.value())
    })
}

/// The contact terms of (8) at the exact u; `weight` times int (1/gamma) \[P(u)\]+ P0(v) in them.
fn contact<E: Element<N, M>, const N: usize, const M: usize>(
    body: &Body,
    c: &BigRational,
    v: &[[Exact; 2]],
    weight: i64,
) -> BigRational {
    let kernel = Kernel::<N, M>::new::<E>(body);
    let mut total = BigRational::zero();
    for (right, exact) in &sides(body, c) {
        for (e, side) in body.contact.iter().enumerate() {
            let [a, b] = ends(body, side.triangle, side.local);
            let Some([start, end]) = cut(&a[0], &b[0], c, *right) else { continue };
            let (gamma, length) = (body.gamma(side).value(), side.length.value());
            let (u_n, sigma_n) = (along(&-&exact.u[1], &a, &b), along(&exact.stress[1], &a, &b));
            let (p0, stress) = (line(&kernel.p0(e, v)), line(&kernel.sigma_n(e, v)));
            let p = &u_n - &sigma_n.scaled(&gamma);
            let middle = (&start + &end) / integer(2);
            let mut density = -&(&sigma_n * &stress).scaled(&gamma);
            if p.at(&[middle]).is_positive() {
                density = &density + &(&p * &p0).scaled(&(integer(weight) / &gamma));
            }
            total += over_interval(&density, [&start, &end]) * length;
        }
    }
    total
}

/// The left side of the discrete equations at the exact u minus L(v), for a v that is zero at the top.
fn residual<E: Element<N, M>, const N: usize, const M: usize>(
    body: &Body,
    c: &BigRational,
    v: &[[Exact; 2]],
    weight: i64,
) -> BigRational {
    over_body::<N>(body, c, v, energy) - load::<N>(body, c, v)
        + contact::<E, N, M>(body, c, v, weight)
}

/// The field is a solution: (2) holds on y = 0 on either side of c, as polynomials or at the ends.
fn satisfies_2(c: &BigRational, moduli: [&BigRational; 2]) -> bool {
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

fn consistent<E: Element<N, M>, const N: usize, const M: usize>(
    draw: &Draw,
    (n, d): (i64, i64),
    weight: i64,
) -> Verdict {
    Exact::scope(|| {
        let body = draw.upright().body();
        let c = integer(n) / integer(n + d);
        let [lambda, mu] = moduli(&body).map(|x| x.value());
        ensure!(satisfies_2(&c, [&lambda, &mu]));
        let cut_edge = body.contact.iter().any(|side| {
            let [a, b] = ends(&body, side.triangle, side.local);
            (a[0] < c) != (b[0] < c)
        });
        given!(cut_edge);
        for v in body.basis::<N>() {
            ensure!(residual::<E, N, M>(&body, &c, &v, weight).is_zero());
        }
        Verdict::Holds("an edge with contact and gap")
    })
}

const CLASSES: [&str; 1] = ["an edge with contact and gap"];

fn data() -> impl Strategy<Value = (Draw, (i64, i64))> {
    (bodies(1).prop_map(|draw| draw.isotropic()), draws::positive())
}

/// The residual vanishes at the curved solution.
pub fn residual_vanishes() -> Outcome {
    draws::hold(8, data(), &CLASSES, |(draw, c)| consistent::<P1, 3, 2>(draw, *c, 1))
}

/// The same for P2.
pub fn residual_vanishes_for_p2() -> Outcome {
    draws::hold(3, data(), &CLASSES, |(draw, c)| consistent::<P2, 6, 3>(draw, *c, 1))
}

/// Without the contact term: the penalty-free method is not consistent.
pub fn without_the_contact_term() -> Outcome {
    draws::reject(data(), |(draw, c)| consistent::<P1, 3, 2>(draw, *c, 0))
}

/// The same for P2.
pub fn without_the_contact_term_for_p2() -> Outcome {
    draws::reject(data(), |(draw, c)| consistent::<P2, 6, 3>(draw, *c, 0))
}

/// How far doubles may be from the exact values, relative to the sum of the magnitudes of what is added up.
const ROUNDING: f64 = 1e-12;

/// The force jumps at x = c: places this near to it are left out, for they may lie on the other side in doubles.
const JUMP: f64 = 1e-9;

fn double(x: &BigRational) -> f64 {
    x.to_f64().unwrap_or(f64::NAN)
}

/// Whether `found` is the value of the polynomial at a point, up to rounding.
fn is_value(found: f64, p: &Polynomial, x: &[BigRational]) -> bool {
    let size = p.terms().fold(0.0, |sum, (monomial, coefficient)| {
        let factors = monomial.iter().zip(x).map(|(&n, x)| double(x).powi(n.into()));
        sum + (double(coefficient) * factors.product::<f64>()).abs()
    });
    (found - double(&p.at(x))).abs() <= ROUNDING * size
}

/// The body as the solver has it: contact on its bottom, tractions on its sides.
fn problem(body: &Body, solution: &exact::Exact) -> Option<Problem> {
    let vertices = body.vertices.iter().map(|x| x.map(|x| double(&x.value()))).collect();
    let pair = |t: usize, i: usize| [1, 2].map(|k| body.triangles[t][(i + k) % 3]);
    let named = [
        ("bottom".to_owned(), body.contact.iter().map(|s| pair(s.triangle, s.local)).collect()),
        ("sides".to_owned(), body.free.iter().map(|&(t, i)| pair(t, i)).collect()),
    ];
    let mesh = Mesh::new(vertices, body.triangles.clone(), named).ok()?;
    let kinds = [("bottom".to_owned(), Kind::Contact), ("sides".to_owned(), Kind::Traction)];
    Some(exact::problem(solution, mesh, &kinds.into()))
}

/// The load that the solver assembles, times `factor`, is L(v) at a v.
fn load_agrees<const N: usize>(
    body: &Body,
    problem: &Problem,
    c: &BigRational,
    factor: f64,
) -> bool {
    let drawn = body.drawn(0);
    // Any function of the place will do, if both sides take it at their nodes.
    let test =
        |[x, y]: [Exact; 2]| [drawn[0][0] + drawn[1][0] * x, drawn[0][1] + drawn[1][1] * x * y];
    let d = [0, 1].map(|i| drawn[i].map(|x| double(&x.value())));
    let in_doubles = |[x, y]: [f64; 2]| [d[0][0] + d[1][0] * x, d[0][1] + d[1][1] * x * y];
    let space = Space::new(&problem.mesh, if N == 3 { Degree::One } else { Degree::Two });
    let Ok(load) = loads::assemble(problem, &space) else { return false };
    let products = load.iter().zip(space.nodes()).flat_map(|(l, &x)| {
        let v = in_doubles(x);
        [l[0] * v[0], l[1] * v[1]]
    });
    let (sum, size) = products.fold((0.0, 0.0), |(sum, size), p: f64| (sum + p, size + p.abs()));
    let exact = self::load::<N>(body, c, &body.interpolated(test));
    (factor * sum - double(&exact)).abs() <= ROUNDING * size
}

/// The solver's form of the solution on a body, with c.
fn in_doubles(body: &Body, c: &BigRational) -> exact::Exact {
    let [lambda, mu] = moduli(body).map(|x| double(&x.value()));
    let material = Material::lame(lambda, mu, Plane::Strain);
    let (k, m, ap, aq) = (3.0, 2.0, 8.0, 4.0);
    Arc::new(exact::Smooth { material, c: double(c), k, m, ap, aq, gap: Vec::new() })
}

/// The middle of a triangle in doubles.
fn middle(body: &Body, corners: [usize; 3]) -> [f64; 2] {
    [0, 1].map(|i| corners.iter().map(|&v| double(&corner(body, v)[i])).sum::<f64>() / 3.0)
}

/// Displacement, stress and force of the solver in the middle of each triangle against the polynomials; `factor` times
/// the force.
fn formulas_agree(draw: &Draw, (n, d): (i64, i64), factor: f64) -> Verdict {
    Exact::scope(|| {
        let body = draw.upright().body();
        let c = integer(n) / integer(n + d);
        let (solution, [left, right]) = (in_doubles(&body, &c), sides(&body, &c));
        let (mut seen_left, mut seen_right) = (false, false);
        for &corners in &body.triangles {
            let x = middle(&body, corners);
            let at = x.map(|x| BigRational::from_float(x).expect("a finite double"));
            let from_c = double(&(&at[0] - &c));
            if from_c.abs() < JUMP {
                continue;
            }
            let exact = if from_c > 0.0 { &right.1 } else { &left.1 };
            let (u, s) = (solution.displacement(x), solution.stress(x));
            let f = solution.body_force(x).unwrap_or_default().map(|f| factor * f);
            ensure!((0..2).all(|i| is_value(u[i], &exact.u[i], &at)));
            ensure!((0..2).all(|i| is_value(f[i], &exact.force[i], &at)));
            let stress = s.components();
            ensure!((0..3).all(|i| is_value(stress[i], &exact.stress[i], &at)));
            seen_left |= from_c < 0.0;
            seen_right |= from_c > 0.0;
        }
        given!(seen_left || seen_right);
        Verdict::Holds(match (seen_left, seen_right) {
            (true, true) => "over contact and gap",
            (true, false) => "over the contact",
            _ => "over the gap",
        })
    })
}

/// The load that the solver assembles from it; `factor` times that.
fn loads_agree(draw: &Draw, (n, d): (i64, i64), factor: f64) -> Verdict {
    Exact::scope(|| {
        let body = draw.upright().body();
        let c = integer(n) / integer(n + d);
        let Some(problem) = problem(&body, &in_doubles(&body, &c)) else {
            return Verdict::Fails("the body is a mesh");
        };
        ensure!(load_agrees::<3>(&body, &problem, &c, factor));
        ensure!(load_agrees::<6>(&body, &problem, &c, factor));
        Verdict::Holds("P1 and P2")
    })
}

/// The solver's formulas of this solution are the polynomials.
pub fn solver_has_the_same_solution() -> Outcome {
    let classes = ["over contact and gap", "over the contact", "over the gap"];
    draws::hold(60, data(), &classes, |(draw, c)| formulas_agree(draw, *c, 1.0))
}

/// The L that the solver assembles is that of the polynomials.
pub fn solver_has_the_same_load() -> Outcome {
    draws::hold(8, data(), &["P1 and P2"], |(draw, c)| loads_agree(draw, *c, 1.0))
}

/// A body force that is off by a millionth is not that of the solution.
pub fn body_force_off_by_a_millionth() -> Outcome {
    draws::reject(data(), |(draw, c)| formulas_agree(draw, *c, 1.0 + 1e-6))
}

/// Nor is such a load.
pub fn load_off_by_a_millionth() -> Outcome {
    draws::reject(data(), |(draw, c)| loads_agree(draw, *c, 1.0 + 1e-6))
}
