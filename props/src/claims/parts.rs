//! What real parts need beyond the paper: the direction of contact as a field n~ (docs/theory.md, 2.1), several materials, and
//! the recovered pressure (docs/parts.md).
//!
//! At a point |n~ . sigma n|^2 <= (lambda + 2 mu) sigma:eps for all unit n~, n, for with t the normal turned by a right angle
//! and vectors of any length
//!
//! ```text
//! (n~ . sigma n)^2 + (n~ x sigma n)^2 = |n~|^2 |sigma n|^2
//! (lambda + 2 mu) |n|^4 sigma:eps - |n|^2 |sigma n|^2 = 4 mu (lambda + mu) (eps_tt^2 + eps_nt^2)
//! ```
//!
//! On an edge along which n~ turns by an angle with the cosine c, int s^2 <= (2 - c) int |sigma n|^2 for an affine traction.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

use proptest::prelude::Strategy;
use signorini::fem::contact_line::Coercivity;
use signorini::fem::exact::Kind;
use signorini::fem::{
    Condition, Diagonal, Materials, Mesh, Obstacle, Problem, Rectangle, SharedFunction, Side, exact,
};
use signorini::kernel::contact_edge::{coercivity_constant, integral_of_product, turning_factor};
use signorini::kernel::triangle::on_edge;
use signorini::kernel::{ContactEdge, Element, Material, P1, P2, Plane, Stress};
use signorini::nalgebra::{Matrix2, Vector2};
use signorini::solve::solution::ContactValues;
use signorini::solve::{ContactQuadrature, Degree, Method, Settings, Solution, discretize, solve};

use crate::bodies::{Body, Draw, Kernel, bodies, sum};
use crate::claim::{Claim, Outcome, noticed, proved, refuted, text};
use crate::claims::{answers, geometry};
use crate::draws;
use crate::numbers::Exact;
use crate::statement;
use crate::statement::take;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

// The direction of contact, at a point.

fn energy_density<S: Ordered>(stress: Stress<S>, g: Matrix2<S>) -> S {
    let [xx, yy, xy] = stress.components();
    xx * g.m11 + yy * g.m22 + xy * (g.m12 + g.m21)
}

/// The functional n~ . sigma(v) n of one shape function, and sigma_n where n~ = n is a unit vector.
pub fn traction_of_a_shape_is_d_sigma_n<S: Ordered>(
    [gx, gy, vx, vy, nx, ny, dx, dy, lambda, mu]: [S; 10],
) -> Verdict {
    let material = Material::lame(lambda, mu, Plane::Strain);
    let (g, n, d) = (Vector2::new(gx, gy), Vector2::new(nx, ny), Vector2::new(dx, dy));
    let stress = material.stress(Matrix2::new(vx * gx, vx * gy, vy * gx, vy * gy));
    let traction = stress.traction(n);
    let functional = material.traction_of_shape(g, n, d);
    ensure!(functional[0] * vx + functional[1] * vy == traction[0] * dx + traction[1] * dy);
    given!(nx * nx + ny * ny == S::from(1));
    let (along, normal) =
        (material.traction_of_shape(g, n, n), material.normal_stress_of_shape(g, n));
    ensure!(along[0] == normal[0]);
    ensure!(along[1] == normal[1]);
    Verdict::Holds("always")
}

/// d x sigma n, and eps_tt and eps_nt times |n|^2.
fn across_and_strains<S: Ordered>([xx, xy, yx, yy, nx, ny, dx, dy, lambda, mu]: [S; 10]) -> [S; 3] {
    let two = S::from(2);
    let stress = Material::lame(lambda, mu, Plane::Strain).stress(Matrix2::new(xx, xy, yx, yy));
    let traction = stress.traction(Vector2::new(nx, ny));
    let exy = (xy + yx) / two;
    [
        dx * traction[1] - dy * traction[0],
        ny * ny * xx - two * nx * ny * exy + nx * nx * yy,
        nx * ny * (yy - xx) + (nx * nx - ny * ny) * exy,
    ]
}

/// |n|^2 (d . sigma n)^2 <= |d|^2 (lambda + 2 mu) |n|^4 sigma:eps, d being n~. lambda is the coefficient in the plane: in plane
/// stress lambda*, for which row 9 has lambda* + mu > 0.
pub fn traction_along_any_direction_is_bounded_by_the_energy<S: Ordered>(v: [S; 10]) -> Verdict {
    let (zero, four) = (S::from(0), S::from(4));
    let [xx, xy, yx, yy, nx, ny, dx, dy, lambda, mu] = v;
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let g = Matrix2::new(xx, xy, yx, yy);
    let stress = material.stress(g);
    let traction = stress.traction(Vector2::new(nx, ny));
    let (tx, ty) = (traction[0], traction[1]);
    let [across, tt, nt] = across_and_strains(v);
    let (n, d) = (nx * nx + ny * ny, dx * dx + dy * dy);
    let along = dx * tx + dy * ty;
    let bound = material.normal_stiffness(Vector2::new(nx, ny)) * n * n * energy_density(stress, g);
    let whole = n * (tx * tx + ty * ty);
    ensure!(along * along + across * across == d * (tx * tx + ty * ty));
    ensure!(bound - whole == four * mu * (lambda + mu) * (tt * tt + nt * nt));
    ensure!(mu * (lambda + mu) > zero);
    ensure!(mu * (lambda + mu) * (tt * tt) >= zero);
    ensure!(mu * (lambda + mu) * (nt * nt) >= zero);
    ensure!(whole <= bound);
    ensure!(n >= zero && d >= zero);
    ensure!(across * across >= zero);
    ensure!(n * (across * across) >= zero);
    ensure!(n * (along * along) <= d * whole);
    ensure!(d * whole <= d * bound);
    ensure!(n * (along * along) <= d * bound);
    Verdict::Holds("always")
}

/// mu in place of lambda + 2 mu.
pub fn control_shear_modulus_for_the_stiffness<S: Ordered>(
    [xx, yy, dx, dy, lambda, mu]: [S; 6],
) -> Verdict {
    let zero = S::from(0);
    given!(mu > zero && lambda + mu > zero);
    let g = Matrix2::new(xx, zero, zero, yy);
    let stress = Material::lame(lambda, mu, Plane::Strain).stress(g);
    let traction = stress.traction(Vector2::new(S::from(1), zero));
    let along = dx * traction[0] + dy * traction[1];
    ensure!(along * along <= (dx * dx + dy * dy) * mu * energy_density(stress, g));
    Verdict::Holds("always")
}

// The direction of contact, on an edge.

/// s_0^2 + s_0 s_1 + s_1^2 against |t_0|^2 + t_0.t_1 + |t_1|^2, of which the integrals are thirds: t_0 = (a, b) in the basis
/// (n~_0, n~_0 turned left), t_1 with the components s_1 = t_1 . n~_1 and r across; n~_1 = (c, s).
fn edge_forms<S: Ordered>([a, b, s1, r, c, s]: [S; 6]) -> [S; 2] {
    let (e, f) = (c * s1 - s * r, s * s1 + c * r);
    [a * a + a * s1 + s1 * s1, a * a + b * b + a * e + b * f + e * e + f * f]
}

/// What is squared in the difference.
fn squared<S: Ordered>([a, b, s1, r, c, s]: [S; 6]) -> [S; 3] {
    let (two, four) = (S::from(2), S::from(4));
    let second = (four - c * c) * r - s * (two * a + c * s1);
    [two * b + c * r + s * s1, second, a - s1]
}

/// Lemma 2.1b: (2 - c) of the second is not below the first; the difference is a sum of squares.
pub fn traction_along_a_turning_direction_is_bounded_by_its_factor<S: Ordered>(
    [a, b, s1, r, c, s]: [S; 6],
) -> Verdict {
    let (zero, one, two, four) = (S::from(0), S::from(1), S::from(2), S::from(4));
    given!(c * c + s * s == one);
    given!(c >= zero && c <= one);
    let [along, whole] = edge_forms([a, b, s1, r, c, s]);
    let factor = turning_factor::<P2, S, 6, 3>(c);
    ensure!(factor == two - c);
    let q = four - c * c;
    let [first, second, third] = squared([a, b, s1, r, c, s]);
    let squares = factor * (q * (first * first) + second * second)
        + four * (factor * (one - c)) * (third * third);
    ensure!(four * q * (factor * whole - along) == squares);
    ensure!(factor > zero);
    ensure!(q > zero);
    ensure!(factor * q > zero);
    ensure!(factor * (one - c) >= zero);
    ensure!(factor * q * (first * first) >= zero);
    ensure!(factor * (second * second) >= zero);
    ensure!(factor * (one - c) * (third * third) >= zero);
    ensure!(squares >= zero);
    // Divided by 4 q > 0 it is the bound.
    ensure!(q * (factor * whole - along) >= zero);
    Verdict::Holds("always")
}

/// The factor is attained, at s_0 = s_1 = (2 - c) w: it can't be smaller.
pub fn the_turning_factor_is_attained<S: Ordered>([w, c, s]: [S; 3]) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(c * c + s * s == one);
    given!(c >= zero && c <= one);
    given!(w > S::from(0) || w < S::from(0));
    let a = (two - c) * w;
    let r = s * w;
    let b = -(c * r + s * a) / two;
    let [along, whole] = edge_forms([a, b, a, r, c, s]);
    ensure!(along == S::from(3) * a * a);
    ensure!(along == turning_factor::<P2, S, 6, 3>(c) * whole);
    Verdict::Holds("always")
}

/// For a constant traction (P1) the factor is 1.
pub fn traction_of_p1_needs_no_factor<S: Ordered>([a, b, c, s]: [S; 4]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(c * c + s * s == one);
    given!(c >= zero && c <= one);
    let s1 = a * c + b * s;
    let [along, whole] = edge_forms([a, b, s1, b * c - a * s, c, s]);
    ensure!(whole == S::from(3) * (a * a + b * b));
    ensure!(s1 * s1 + (b * c - a * s) * (b * c - a * s) == a * a + b * b);
    ensure!(s1 * s1 <= a * a + b * b);
    ensure!(a * a <= a * a + b * b);
    ensure!((a - s1) * (a - s1) >= zero);
    ensure!(along <= turning_factor::<P1, S, 3, 2>(c) * whole);
    Verdict::Holds("always")
}

/// The factor 1 where the direction turns.
pub fn control_no_factor_for_a_turning_direction<S: Ordered>(
    [a, b, s1, r, c, s]: [S; 6],
) -> Verdict {
    given!(c * c + s * s == S::from(1));
    given!(c >= S::from(0) && c <= S::from(1));
    let [along, whole] = edge_forms([a, b, s1, r, c, s]);
    ensure!(along <= whole);
    Verdict::Holds("always")
}

// The direction of contact, on bodies.

/// A unit vector by its half angle's tangent: ((1 - t^2), 2 t)/(1 + t^2).
fn unit(t: Exact) -> [Exact; 2] {
    let one = Exact::from(1);
    let norm = one + t * t;
    [(one - t * t) / norm, Exact::from(2) * t / norm]
}

/// Directions at the nodes of a side: its normal, turned by what the drawn field says.
fn directions<const M: usize>(body: &Body, e: usize) -> [[Exact; 2]; M] {
    let ([nx, ny], drawn) = (body.contact[e].n, body.drawn(1));
    std::array::from_fn(|a| {
        let [c, s] = unit(drawn[(3 * e + a) % drawn.len()][0] / Exact::from(8));
        [c * nx - s * ny, s * nx + c * ny]
    })
}

fn along<E: Element<N, M>, const N: usize, const M: usize>(
    body: &Body,
    e: usize,
    directions: &[[Exact; 2]; M],
) -> ContactEdge<Exact, N, M> {
    let side = &body.contact[e];
    let directions = directions.map(Vector2::from);
    let (triangle, gamma) = (body.triangle(side.triangle), body.gamma(side));
    ContactEdge::along::<E>(
        &triangle,
        side.local,
        side.n.into(),
        &directions,
        &body.material,
        gamma,
    )
}

fn applied<const N: usize>(functional: &[Vector2<Exact>; N], v: &[[Exact; 2]; N]) -> Exact {
    sum(functional.iter().zip(v), |(f, v)| f[0] * v[0] + f[1] * v[1])
}

/// P0 and s of the kernel are n~ . v - gamma s and n~ . sigma(v) n, from stress and displacement by their definitions; with
/// n~ = n they are the paper's.
fn functionals_agree<E: Element<N, M>, const N: usize, const M: usize>(body: &Body) -> Verdict {
    for (e, side) in body.contact.iter().enumerate() {
        let v = body.local::<N>(side.triangle, &body.drawn(0));
        let directions = directions::<M>(body, e);
        let edge = along::<E, N, M>(body, e, &directions);
        let triangle = body.triangle(side.triangle);
        let barycentric = triangle.barycentric_gradients();
        let s_at = |a: usize| {
            let gradients = E::gradients(on_edge(side.local, Exact::from(a as i32)), barycentric);
            let d = |i: usize, j: usize| sum(0..N, |k| v[k][i] * gradients[k][j]);
            let gradient = Matrix2::new(d(0, 0), d(0, 1), d(1, 0), d(1, 1));
            let traction = body.material.stress(gradient).traction(side.n.into());
            directions[a][0] * traction[0] + directions[a][1] * traction[1]
        };
        let s = [s_at(0), s_at(1)];
        for a in 0..2 {
            ensure!(applied(&edge.sigma_n[a], &v) == s[a]);
        }
        for (a, (node, at)) in
            E::edge_nodes(side.local).into_iter().zip(E::edge_positions()).enumerate()
        {
            let u_n = directions[a][0] * v[node][0] + directions[a][1] * v[node][1];
            let stress = (Exact::from(1) - at) * s[0] + at * s[1];
            ensure!(applied(&edge.p0[a], &v) == u_n - body.gamma(side) * stress);
        }
        let paper = ContactEdge::<Exact, N, M>::new::<E>(
            &triangle,
            side.local,
            side.n.into(),
            &body.material,
            body.gamma(side),
        );
        let same = along::<E, N, M>(body, e, &[side.n; M]);
        ensure!(paper.p0 == same.p0 && paper.sigma_n == same.sigma_n);
    }
    Verdict::Holds("always")
}

/// (11) with the turned directions: gamma |s(v)|^2 on the contact edges of a triangle against kappa_T a_T(v, v), each edge
/// counted `factor(cosine)` times. Where A is not isotropic, the largest eigenvalue of Q(n) need not be rational.
fn coercive_along<E: Element<N, M>, const N: usize, const M: usize>(body: &Body) -> Verdict {
    let kernel = Kernel::<N, M>::new::<E>(body);
    let v = body.drawn(0);
    for t in 0..body.triangles.len() {
        let (mut left, mut length) = (Exact::from(0), Exact::from(0));
        for (e, side) in body.contact.iter().enumerate().filter(|(_, side)| side.triangle == t) {
            let directions = directions::<M>(body, e);
            let cosine = directions[0][0] * directions[1][0] + directions[0][1] * directions[1][1];
            given!(cosine >= Exact::from(0));
            let edge = along::<E, N, M>(body, e, &directions);
            let local = body.local::<N>(t, &v);
            let s = [0, 1].map(|a| applied(&edge.sigma_n[a], &local));
            left += body.gamma(side) * side.length * integral_of_product(s, s);
            length += turning_factor::<E, Exact, N, M>(cosine) * side.length;
        }
        let area = body.triangle(t).double_area() / Exact::from(2);
        let h = body.diameters[t];
        let stiffness = body.material.normal_stiffness(Vector2::y());
        let constant = coercivity_constant::<E, Exact, N, M>(stiffness, h, length, area);
        ensure!(left <= body.gamma0 * constant * kernel.a_on(t, &v, &v));
    }
    Verdict::Holds("always")
}

fn two_fields() -> impl Strategy<Value = Draw> {
    bodies(2)
}

fn functionals_are_their_definitions() -> Outcome {
    draws::hold(40, two_fields(), &["always"], |draw| {
        Exact::scope(|| functionals_agree::<P1, 3, 2>(&draw.body()))
    })?;
    draws::hold(15, two_fields(), &["always"], |draw| {
        Exact::scope(|| functionals_agree::<P2, 6, 3>(&draw.body()))
    })
}

fn the_bound_11_holds() -> Outcome {
    draws::hold(60, two_fields(), &["always"], |draw| {
        Exact::scope(|| coercive_along::<P1, 3, 2>(&draw.isotropic().body()))
    })?;
    draws::hold(20, two_fields(), &["always"], |draw| {
        Exact::scope(|| coercive_along::<P2, 6, 3>(&draw.isotropic().body()))
    })
}

fn constant(value: f64) -> SharedFunction {
    Arc::new(move |_: [f64; 2]| value)
}

fn prescribed(x: f64, y: f64) -> Condition {
    Condition::Displacement([Some(constant(x)), Some(constant(y))])
}

fn problem<const K: usize>(
    mesh: Mesh,
    material: impl Into<Materials>,
    conditions: [(&str, Condition); K],
) -> Problem {
    let conditions = conditions.map(|(name, condition)| (name.to_owned(), condition));
    Problem::new(mesh, material, [constant(0.0), constant(0.0)], BTreeMap::from(conditions))
}

fn square(n: usize, diagonal: Diagonal) -> Result<Mesh, String> {
    let cells = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal };
    cells.mesh().map_err(text)
}

fn solved(problem: &Problem, degree: Degree) -> Result<Solution, String> {
    let method = Method { degree, quadrature: ContactQuadrature::Exact, ..Method::default() };
    let solved = solve(problem, &method, &Settings::default());
    solved.map(|(solution, _)| solution).map_err(text)
}

/// On a straight line without an obstacle the functionals of the solver are those of the paper, bit for bit.
fn straight_lines_are_the_papers() -> Outcome {
    let mut edges = 0;
    for diagonal in [Diagonal::Right, Diagonal::Left, Diagonal::Crossed] {
        let material = Material::lame(1.7, 0.6, Plane::Strain);
        let contact = Condition::Contact { gap: constant(0.1) };
        let conditions = [("top", prescribed(0.0, -0.2)), ("bottom", contact)];
        let problem = problem(square(7, diagonal)?, material, conditions);
        let (one, two) = (Method { degree: Degree::One, ..Method::default() }, Method::default());
        let d = discretize(&problem, &one).map_err(text)?;
        edges += same_bits::<P1, 3, 2>(&problem, &d.contact)?;
        let two = Method { degree: Degree::Two, ..two };
        let d = discretize(&problem, &two).map_err(text)?;
        edges += same_bits::<P2, 6, 3>(&problem, &d.contact)?;
    }
    Ok(format!("{edges} edges"))
}

fn same_bits<E: Element<N, M>, const N: usize, const M: usize>(
    problem: &Problem,
    line: &[signorini::fem::ContactFace],
) -> Result<usize, String> {
    for edge in line {
        let triangle = problem.mesh.triangle(edge.edge.triangle);
        let material = problem.material.of(edge.edge.triangle);
        let (n, gamma) = (edge.normal, edge.gamma);
        let paper =
            ContactEdge::<f64, N, M>::new::<E>(&triangle, edge.edge.local, n, material, gamma);
        let bits = |rows: Vec<&[Vector2<f64>]>| -> Vec<u64> {
            let all = rows.into_iter().flatten();
            all.flat_map(|f| [f[0].to_bits(), f[1].to_bits()]).collect()
        };
        let rows = paper.p0.iter().chain(&paper.sigma_n).map(|row| &row[..]).collect();
        let mut found = edge.functionals.p0();
        found.extend(edge.functionals.sigma_n());
        if bits(rows) != bits(found) {
            return Err(format!("the edge {:?}", edge.edge));
        }
    }
    Ok(line.len())
}

/// The ring 1 < r < 2.5 with `n` edges around, its rim moved by 0.01 against a pin that fits: the peak pressure. With
/// `facets`, each edge on the pin has its own normal: the pin is as many planes.
fn peak_of_a_ring(n: usize, facets: bool) -> Result<f64, String> {
    let layers = n / 5 + 2;
    let at = |i: usize, j: usize| {
        let (sin, cos) = (2.0 * PI * j as f64 / n as f64).sin_cos();
        let r = 1.0 + 1.5 * (i as f64 / layers as f64).powf(1.3);
        [r * cos, r * sin]
    };
    let id = |i: usize, j: usize| i * n + j % n;
    let vertices = (0..=layers).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| at(i, j));
    let cells = (0..layers).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let around = |i: usize| (0..n).map(|j| [id(i, j), id(i, j + 1)]).collect::<Vec<_>>();
    let mut named = vec![("rim".to_owned(), around(layers))];
    let mut conditions = BTreeMap::from([("rim".to_owned(), prescribed(0.01, 0.0))]);
    if facets {
        for (j, edge) in around(0).into_iter().enumerate() {
            let [p, q] = [at(0, j), at(0, j + 1)];
            let normal = [p[0] + q[0], p[1] + q[1]];
            let length = normal[0].hypot(normal[1]);
            let plane = Obstacle::Plane { point: p, normal: normal.map(|c| c / length) };
            named.push((format!("facet {j}"), vec![edge]));
            conditions.insert(format!("facet {j}"), Condition::Obstacle("pin".to_owned(), plane));
        }
    } else {
        let pin = Obstacle::Circle { center: [0.0; 2], radius: 1.0, side: Side::Outside };
        named.push(("pin".to_owned(), around(0)));
        conditions.insert("pin".to_owned(), Condition::Obstacle("pin".to_owned(), pin));
    }
    let mesh = Mesh::new(vertices.collect(), triangles, named).map_err(text)?;
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    let problem = Problem::new(mesh, material, [constant(0.0), constant(0.0)], conditions);
    let solution = solved(&problem, Degree::One)?;
    Ok(solution.boundaries.iter().map(|b| b.peak_pressure).fold(0.0, f64::max))
}

/// What an independent program with normals at the nodes tends to.
const PEAK: f64 = 0.0302;

/// The error of the peak on two meshes: it falls by a factor of two or more.
fn error_of_the_peak_falls(facets: bool) -> Outcome {
    let error = |n| peak_of_a_ring(n, facets).map(|peak| (peak / PEAK - 1.0).abs());
    let errors = [error(24)?, error(48)?];
    if errors[1] <= 0.6 * errors[0] {
        Ok(format!("{:.4} and {:.4} with 24 and 48 edges", errors[0], errors[1]))
    } else {
        Err(format!("the error is {:.4} with 24 edges, {:.4} with 48", errors[0], errors[1]))
    }
}

/// The row on the direction of contact.
pub fn direction() -> Claim {
    let checks = vec![
        proved(
            statement!(
                traction_of_a_shape_is_d_sigma_n,
                [gx, gy, vx, vy, nx, ny, dx, dy, lambda, mu],
                ["always"]
            )
            .prepared(unit_normal_at_4),
        ),
        proved(
            statement!(
                traction_along_any_direction_is_bounded_by_the_energy,
                [xx, xy, yx, yy, nx, ny, dx, dy, lambda, mu],
                ["always"]
            )
            .with_hints(|v| across_and_strains(take(v)).to_vec()),
        ),
        proved(
            statement!(
                traction_along_a_turning_direction_is_bounded_by_its_factor,
                [a, b, s1, r, c, s],
                ["always"]
            )
            .with_hints(|v| squared(take(v)).to_vec())
            .prepared(unit_at_4),
        ),
        proved(
            statement!(the_turning_factor_is_attained, [a, c, s], ["always"]).prepared(unit_at_1),
        ),
        proved(
            statement!(traction_of_p1_needs_no_factor, [a, b, c, s], ["always"])
                .with_hints(|v| {
                    let [a, b, c, s] = take(v);
                    vec![a - (a * c + b * s), b * c - a * s]
                })
                .prepared(unit_at_2),
        ),
        exact!("functionals_along_directions_are_their_definitions_and_with_n_the_papers" => functionals_are_their_definitions()),
        exact!("bound_11_holds_along_turning_directions" => the_bound_11_holds()),
        doubles!("on_straight_lines_the_solver_has_the_papers_functionals_bit_for_bit" => straight_lines_are_the_papers()),
        doubles!("the_peak_pressure_of_a_ring_on_a_pin_converges" => error_of_the_peak_falls(false)),
        doubles!("gaps_and_directions_of_obstacles_are_their_definitions" => geometry::obstacles_are_their_definitions()),
        doubles!("the_smooth_boundary_of_a_circle_is_the_circle" => geometry::smooth_boundaries_are_exact_on_circles()),
        doubles!("middles_of_smooth_boundaries_have_the_normals_of_their_curves" => geometry::middles_of_smooth_boundaries_have_the_normals_of_their_curves()),
        doubles!("control_normals_of_facets_for_those_of_the_curves" => geometry::normals_of_facets_for_those_of_the_curves()),
        doubles!("control_directions_away_from_the_obstacle" => geometry::directions_away_from_the_obstacle()),
        doubles!("control_middles_of_facets_for_those_of_the_curves" => geometry::middles_of_facets_for_those_of_the_curves()),
        doubles!("control_normals_of_the_facets_on_a_circle" => noticed(error_of_the_peak_falls(true))),
        refuted(statement!(
            control_shear_modulus_for_the_stiffness,
            [xx, yy, dx, dy, lambda, mu],
            fails "along * along <= (dx * dx + dy * dy) * mu * energy_density(stress, g)"
        )),
        refuted(
            statement!(
                control_no_factor_for_a_turning_direction,
                [a, b, s1, r, c, s],
                fails "along <= whole"
            )
            .prepared(unit_at_4),
        ),
    ];
    Claim {
        id: "20",
        items: &["(11)", "Lemma 3.2"],
        title: "The direction of contact as a field",
        paper: "Gamma_C is a straight segment in the paper, and its normal constant.",
        statement: "With unit vectors n~ at the nodes of Gamma_C in place of n, and s(v) = n~ . sigma(v) n in place of sigma_n (docs/theory.md, 2.1): |n~ . sigma n|^2 <= (lambda + 2 mu) sigma:eps for vectors of any length, scaled, with lambda as it acts in the plane: lambda* in plane stress, for which row 9 proves lambda* + mu > 0. On an edge along which n~ turns by an angle with the cosine c >= 0, int s^2 <= (2 - c) int |sigma n|^2 for an affine traction (P2), a factor that is attained, and 1 for a constant one (P1); so (11) holds with an edge counted 2 - c times. The kernel's functionals are n~ . v - gamma s(v) and s(v) by their definitions; with n~ = n they are the paper's over rationals, and in the solver on straight lines bit for bit. Gap and direction of a plane, of a circle from outside and inside, and of a distance by its values lead to a point of the obstacle, and grow and stay one step back; a distance whose gradient is off by more than a tenth is refused. On a circle with unequal facets the normals and the middles of the curves are those of the circle. The peak pressure of a ring on a pin tends to that of an independent program; with the normals of the facets its error does not fall.",
        numbers: "every ordered field (proof); random bodies over rationals; doubles.",
        kernel: &[
            "contact_edge::ContactEdge::along",
            "contact_edge::turning_factor",
            "material::Material::traction_of_shape",
            "fem::obstacle::Obstacle::closest",
            "fem::boundary_normals::SmoothBoundary::along",
        ],
        preconditions: "mu > 0 and lambda + mu > 0 with lambda as it acts in the plane. n~ turns by no more than a right angle along an edge: by less than 40 degrees where the line is smooth, by definition.",
        limits: "Convergence is measured on one body and two meshes here, on four meshes and four bodies in tests/suite/peaks.rs. The pressure's error is not bounded by theory: the paper's estimates are for straight lines.",
        single: None,
        checks,
    }
}

fn put_unit(v: &mut [Exact], at: usize) {
    // A tangent between 0 and 1: a cosine that is not negative.
    let t = v[at];
    let t = if t < Exact::from(0) { -t } else { t };
    let t = if t > Exact::from(1) { Exact::from(1) / t } else { t };
    [v[at], v[at + 1]] = unit(t);
}

fn unit_normal_at_4(v: &mut [Exact]) {
    put_unit(v, 4);
}

fn unit_at_4(v: &mut [Exact]) {
    put_unit(v, 4);
}

fn unit_at_2(v: &mut [Exact]) {
    put_unit(v, 2);
}

fn unit_at_1(v: &mut [Exact]) {
    put_unit(v, 1);
}

// Materials.

/// A bar of two materials held at its sides: the stress along it is the pressure in both, and each part has no shear.
pub fn a_bar_of_two_materials_has_one_pressure<S: Ordered>(
    [p, lambda, mu, other, nu]: [S; 5],
) -> Verdict {
    let zero = S::from(0);
    given!(mu > zero && lambda + mu > zero && nu > zero && other + nu > zero);
    let stress_in = |material: Material<S>| {
        let strain = -p / material.normal_stiffness(Vector2::<S>::y());
        material.stress(Matrix2::new(zero, zero, zero, strain)).components()
    };
    ensure!(lambda + S::from(2) * mu > zero && other + S::from(2) * nu > zero);
    let (first, second) =
        (Material::lame(lambda, mu, Plane::Strain), Material::lame(other, nu, Plane::Strain));
    ensure!(first.plane() == second.plane());
    let [_, below, shear] = stress_in(first);
    let [_, above, other_shear] = stress_in(second);
    ensure!(below == -p && above == -p);
    ensure!(shear == zero && other_shear == zero);
    Verdict::Holds("always")
}

fn soft() -> Material<f64> {
    Material::lame(1.0, 1.0, Plane::Strain)
}

fn stiff() -> Material<f64> {
    Material::lame(20.0, 7.0, Plane::Strain)
}

/// kappa / gamma0 is the largest over the contact triangles, each with its own material: stiff ones are every third.
fn constants_are_own(with_one: bool) -> Outcome {
    let mesh = square(6, Diagonal::Right)?;
    let count = mesh.triangles().len();
    let every_third: Vec<usize> = (0..count).filter(|t| t % 3 == 0).collect();
    let materials = Materials::in_parts(soft(), count, [(stiff(), &every_third[..])]);
    let contact = || Condition::Contact { gap: constant(0.0) };
    let problem = problem(
        mesh,
        materials,
        [("top", prescribed(0.0, 0.0)), ("bottom", contact()), ("left", contact())],
    );
    let mut lengths: BTreeMap<usize, f64> = BTreeMap::new();
    for name in ["bottom", "left"] {
        for &edge in problem.mesh.edges_of(name).map_err(text)? {
            *lengths.entry(edge.triangle).or_default() += problem.mesh.length_and_normal(edge).0;
        }
    }
    let largest = |c: f64| {
        let of = |(&t, length): (&usize, &f64)| {
            let m = if with_one { soft() } else { *problem.material.of(t) };
            let area = problem.mesh.triangle(t).double_area() / 2.0;
            c * (m.lambda() + 2.0 * m.mu()) * problem.mesh.diameter(t) * length / area
        };
        lengths.iter().map(of).fold(0.0, f64::max)
    };
    let found = [
        Coercivity::new(&problem, Degree::One).map_err(text)?.constant,
        Coercivity::new(&problem, Degree::Two).map_err(text)?.constant,
    ];
    for (found, expected) in found.into_iter().zip([largest(1.0), largest(3.0)]) {
        if !((found / expected - 1.0).abs() < 1e-14) {
            return Err(format!("C_h = {found}, expected {expected}"));
        }
    }
    Ok(format!("{} contact triangles, P1 and P2", lengths.len()))
}

/// The row on materials.
pub fn materials() -> Claim {
    Claim {
        id: "21",
        items: &[],
        title: "Several materials",
        paper: "Not in the paper: one material, A constant.",
        statement: "Each triangle has one material. kappa_T has that of its triangle, and kappa is the largest. Where two materials meet, fields that are affine on either side with one traction across are discrete solutions.",
        numbers: "every ordered field (proof) for the stresses; doubles.",
        kernel: &[
            "contact_edge::coercivity_constant",
            "material::Material::stress",
            "material::Material::plane",
        ],
        preconditions: "The interface consists of edges.",
        limits: "Two materials on one mesh; that a bar of two has its closed form at all nodes is a test (tests/suite/parts.rs). The bound (11) of row 9 is by triangles, so it covers bodies of several.",
        single: None,
        checks: vec![
            proved(statement!(
                a_bar_of_two_materials_has_one_pressure,
                [p, lambda, mu, other, nu],
                ["always"]
            )),
            doubles!("kappa_is_the_largest_over_triangles_with_their_own_materials" => constants_are_own(false)),
            doubles!("control_one_material_for_kappa" => noticed(constants_are_own(true))),
        ],
    }
}

// The recovered pressure.

/// The hat functions of a half edge add up to one and are not negative: so the nodal means have the integral of what they
/// are means of, and lie within its bounds. With weights w and values v >= 0 of two points at s and t.
pub fn means_by_hats_keep_integral_and_bounds<S: Ordered>([s, t, v, w, m]: [S; 5]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(s >= zero && s <= one && t >= zero && t <= one);
    given!(v >= zero && w >= zero && v <= m && w <= m);
    let works = [(one - s) * v + (one - t) * w, s * v + t * w];
    let weights = [(one - s) + (one - t), s + t];
    ensure!(works[0] + works[1] == v + w);
    ensure!((one - s) * v >= zero && (one - t) * w >= zero && s * v >= zero && t * w >= zero);
    ensure!((one - s) * (m - v) >= zero && (one - t) * (m - w) >= zero);
    ensure!(s * (m - v) >= zero && t * (m - w) >= zero);
    for (work, weight) in works.into_iter().zip(weights) {
        ensure!(work >= zero);
        ensure!(work <= m * weight);
    }
    Verdict::Holds("always")
}

/// The exact smooth solution (theory.md, 10) on n x n cells, contact below.
fn smooth(n: usize, degree: Degree) -> Result<(Solution, exact::Exact), String> {
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    let (k, m, ap, aq) = (4.0, 3.0, 16.0, 8.0);
    let solution: exact::Exact =
        std::sync::Arc::new(exact::Smooth { material, c: 0.8, k, m, ap, aq, gap: Vec::new() });
    let kinds = [
        ("bottom", Kind::Contact),
        ("left", Kind::Traction),
        ("right", Kind::Traction),
        ("top", Kind::Displacement),
    ];
    let kinds = kinds.map(|(name, kind)| (name.to_owned(), kind));
    let problem = exact::problem(&solution, square(n, Diagonal::Right)?, &kinds.into());
    Ok((solved(&problem, degree)?, solution))
}

/// The largest error at the nodes away from the ends of the line of `value`, on n cells.
fn error_of(
    value: impl Fn(&ContactValues) -> f64,
    n: usize,
    degree: Degree,
) -> Result<f64, String> {
    let (s, solution) = smooth(n, degree)?;
    let mut largest = 0.0_f64;
    for point in s.contact.iter().flat_map(|edge| &edge.points) {
        let x = s.nodes[point.node];
        if x[0] > 0.15 && x[0] < 0.85 {
            let [_, yy, _] = solution.stress(x).components();
            largest = largest.max((value(point) + yy.min(0.0)).abs());
        }
    }
    Ok(largest)
}

/// The order between 24 and 48 cells.
fn order_of(value: impl Fn(&ContactValues) -> f64 + Copy, degree: Degree) -> Result<f64, String> {
    Ok((error_of(value, 24, degree)? / error_of(value, 48, degree)?).log2())
}

/// At least so much.
const SECOND: f64 = 1.7;

fn recovered_order() -> Outcome {
    let mut orders = Vec::new();
    for degree in [Degree::One, Degree::Two] {
        let order = order_of(|p| p.pressure, degree)?;
        if !(order > SECOND) {
            return Err(format!("order {order:.2} for {degree:?}"));
        }
        orders.push(format!("{order:.2}"));
    }
    Ok(format!("orders {} for P1 and P2", orders.join(" and ")))
}

/// -lambda^h at the nodes for P1, which jumps from edge to edge.
fn order_of_lambda() -> Outcome {
    let order = order_of(|p| -p.lambda, Degree::One)?;
    noticed(if order > SECOND {
        Ok(format!("order {order:.2}"))
    } else {
        Err(format!("order {order:.2}"))
    })
}

/// The row on the recovered pressure.
pub fn recovered() -> Claim {
    Claim {
        id: "22",
        items: &[],
        title: "The recovered pressure",
        paper: "Not in the paper, whose pressure is lambda^h.",
        statement: "The nodal contact pressure is the mean of -lambda^h weighted by the node's hat function on the line (for P2 on half edges where the line is straight). The hats are not negative and add up to one, so it is between 0 and the largest -lambda^h, and its integral over a boundary is that of -lambda^h: the same force (tests/suite/parts.rs). Away from the ends of the line it is of second order on equal edges where the pressure is smooth, measured between 24 and 48 edges; -lambda^h at the nodes is not for P1. At a corner each side has its own mean. Stresses at the nodes are the means by areas of what the triangles around have there.",
        numbers: "every ordered field (proof) for means by hats; doubles.",
        kernel: &["contact::ContactPoint::pressure"],
        preconditions: "At the ends of a line the hat is one-sided, and the order one.",
        limits: "One exact solution. On unequal edges the order is lower: tests/suite/parts.rs has uneven rings.",
        single: None,
        checks: vec![
            proved(statement!(means_by_hats_keep_integral_and_bounds, [s, t, v, w, m], ["always"])),
            doubles!("nodal_stresses_are_means_by_areas" => answers::nodal_stresses(false)),
            doubles!("control_plain_means_of_stresses" => noticed(answers::nodal_stresses(true))),
            doubles!("recovered_pressures_are_means_on_one_side_of_a_corner" => answers::around_corners(false)),
            doubles!("control_means_across_a_corner" => noticed(answers::around_corners(true))),
            doubles!("recovered_pressure_is_of_second_order" => recovered_order()),
            doubles!("control_order_of_nodal_lambda" => order_of_lambda()),
        ],
    }
}
