//! The limit of gamma0, and the rules by which the integrals of (8) and of errors are computed: what no item of the paper names,
//! but every number rests on.
//!
//! - kappa >= 1 is refused, kappa < 1 is not, and gamma0 = "auto" is kappa = 1/2 (Lemma 3.2 asks for kappa < 1);
//! - the Gauss rules have the moments of the Legendre polynomials: int P_k = 0 for 0 < k < 2 n, and not for k = 2 n;
//! - the integrals over a contact edge scale: from P to 2^k P without any error in doubles;
//! - the errors from an exact solution are their definitions, in each norm;
//! - the a-orthogonal projection of u, which the solver computes for Theorem 9.4, is nearer to u than u^h.

use std::collections::BTreeMap;

use proptest::prelude::*;
use signorini::fem::EdgeRule;
use signorini::fem::quadrature;
use signorini::fem::{Errors, ExactSolution, Problem};
use signorini::kernel::edge_integral::ExactEdge;
use signorini::kernel::element::displacement_gradient;
use signorini::kernel::{EdgeIntegrals, Element, Material, P1, P2, positive_part};
use signorini::nalgebra::{Matrix2, Vector2};
use signorini::solve::{ContactQuadrature, Degree, Gamma0, Method, SolveError, discretize};

use crate::claim::{Claim, Outcome, noticed, text};
use crate::claims::rates;
use crate::numbers::Exact;
use crate::proof::sampler::Random;
use crate::verdict::Verdict;
use crate::{draws, ensure, sharpness};

/// The verdict on gamma0 = `share` times the limit, and kappa where it is taken.
fn kappa_at(degree: Degree, problem: &Problem, gamma0: Gamma0) -> Result<Option<f64>, String> {
    let method = Method { degree, gamma0, ..Method::default() };
    match discretize(problem, &method) {
        Ok(d) => Ok(Some(d.kappa())),
        Err(SolveError::NotCoercive { kappa, .. }) if kappa >= 1.0 => Ok(None),
        Err(other) => Err(other.to_string()),
    }
}

/// kappa >= 1 is refused, less is not; `limit` multiplies the limit that is expected.
fn refusal_on(degree: Degree, problem: &Problem, limit: f64) -> Result<(), String> {
    let method = Method { degree, ..Method::default() };
    let d = discretize(problem, &method).map_err(text)?;
    let most = d.coercivity.limit();
    for share in [1e-6, 0.5, 0.999, 1.0 - 1e-9, 1.0 + 1e-9, 1.001, 1.5, 1.999, 10.0] {
        let found = kappa_at(degree, problem, Gamma0::Value(share * most))?;
        if found.is_some() != (share < limit) {
            return Err(format!("kappa = {share}: taken as {found:?}"));
        }
        if let Some(kappa) = found
            && !((kappa - share).abs() <= 1e-14 * share)
        {
            return Err(format!("kappa = {share} is called {kappa}"));
        }
    }
    match kappa_at(degree, problem, Gamma0::Auto)? {
        Some(kappa) if (kappa - 0.5).abs() <= 1e-15 => Ok(()),
        other => Err(format!("auto: kappa = {other:?}, expected 1/2")),
    }
}

fn refusal(limit: f64) -> Outcome {
    let bodies = sharpness::small_bodies()?;
    for body in &bodies {
        refusal_on(Degree::One, &body.problem, limit).map_err(|e| format!("{}: {e}", body.name))?;
        refusal_on(Degree::Two, &body.problem, limit).map_err(|e| format!("{}: {e}", body.name))?;
    }
    Ok(format!("{} bodies, P1 and P2, kappa from 1e-6 to 10, and auto", bodies.len()))
}

/// kappa of each triangle on Gamma_C by [2.3] of docs/theory.md, C gamma (lambda + 2 mu) |E| / |T|, for a `gamma0` that asks
/// for 1/2.
fn kappa_of_triangles(
    degree: Degree,
    problem: &Problem,
    gamma0: Gamma0,
    trace: f64,
) -> Result<usize, String> {
    let d = discretize(problem, &Method { degree, gamma0, ..Method::default() });
    let d = d.map_err(text)?;
    let mut lengths: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for line in &d.contact {
        lengths.entry(line.edge.triangle).or_insert((line.gamma, 0.0)).1 += line.length;
    }
    for (&t, &(gamma, length)) in &lengths {
        let material = problem.material.of(t);
        let area = problem.mesh.triangle(t).double_area() / 2.0;
        let kappa = trace * gamma * (material.lambda() + 2.0 * material.mu()) * length / area;
        // A dozen roundings.
        if !((kappa - 0.5).abs() <= 1e-14) {
            return Err(format!("triangle {t} has kappa = {kappa}"));
        }
    }
    Ok(lengths.len())
}

fn kappas(gamma0: Gamma0) -> Outcome {
    let mut count = 0;
    for body in &sharpness::small_bodies()? {
        let of = |e| format!("{}: {e}", body.name);
        count += kappa_of_triangles(Degree::One, &body.problem, gamma0, 1.0).map_err(of)?;
        count += kappa_of_triangles(Degree::Two, &body.problem, gamma0, 3.0).map_err(of)?;
    }
    Ok(format!("{count} triangles"))
}

/// The moments of a rule on \[0, 1\] with the Legendre polynomials in 2 s - 1, exactly, from the doubles of the rule.
fn moments(rule: &[(f64, f64)], most: usize) -> Vec<Exact> {
    let mut sums = vec![Exact::from(0); most + 1];
    for &(s, w) in rule {
        let (x, w) = (Exact::of_double(2.0 * s - 1.0), Exact::of_double(w));
        let (mut before, mut p) = (Exact::from(0), Exact::from(1));
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += w * p;
            let k = Exact::of_double(k as f64);
            let next = ((k + k + Exact::from(1)) * x * p - k * before) / (k + Exact::from(1));
            (before, p) = (p, next);
        }
    }
    sums
}

/// `rule` with n points has the moments of a Gauss rule with n points.
fn is_gauss(n: usize, rule: &[(f64, f64)]) -> Result<(), String> {
    Exact::scope(|| {
        if rule.len() != n {
            return Err(format!("{} points for {n}", rule.len()));
        }
        let moments = moments(rule, 2 * n);
        // A point is known to a few units, and P_k has slopes up to k^2.
        let slack = Exact::of_double(8.0 * f64::EPSILON * (n * n) as f64);
        for (k, moment) in moments.iter().enumerate() {
            let expected = Exact::from(i32::from(k == 0));
            let near = (*moment - expected).abs() <= slack;
            if near != (k < 2 * n) {
                return Err(format!("n = {n}: moment {k} is {moment:?}"));
            }
        }
        let inside = rule.iter().all(|&(s, w)| 0.0 < s && s < 1.0 && w > 0.0);
        if inside { Ok(()) } else { Err(format!("n = {n}: points and weights {rule:?}")) }
    })
}

fn gauss_rules() -> Outcome {
    for n in 1..=10 {
        is_gauss(n, &quadrature::gauss(n))?;
    }
    Ok("1 to 10 points, moments 0 to 2n".to_owned())
}

/// The rule by which a discretization integrates contact terms is the one that is asked for.
fn rule_is_the_one_asked_for() -> Outcome {
    let bodies = sharpness::small_bodies()?;
    let rule = |quadrature| {
        let method = Method { quadrature, ..Method::default() };
        discretize(&bodies[0].problem, &method).map(|d| d.rule).map_err(text)
    };
    if rule(ContactQuadrature::Exact)? != EdgeRule::Exact {
        return Err("not exact".to_owned());
    }
    for n in 1..=10 {
        match rule(ContactQuadrature::Gauss(n))? {
            EdgeRule::Gauss(points) => is_gauss(n, &points)?,
            EdgeRule::Exact => return Err(format!("exact for {n} points")),
        }
    }
    Ok("exact, and 1 to 10 points".to_owned())
}

/// One point more, and weights one part in ten thousand larger.
fn other_rules() -> Outcome {
    let more = noticed(is_gauss(4, &quadrature::gauss(5)).map(|()| String::new()))?;
    let heavier: Vec<(f64, f64)> =
        quadrature::gauss(4).into_iter().map(|(s, w)| (s, w * 1.0001)).collect();
    let heavier = noticed(is_gauss(4, &heavier).map(|()| String::new()))?;
    Ok(format!("{more}; {heavier}"))
}

/// The integrals for 2^k P are those for P times 2^k for each factor of P in them, bit for bit: a power of two rounds
/// nothing, and no test of a sign may know of a size. `degree` is that of the energy (2).
fn scales<E, const N: usize, const M: usize>(p: [f64; M], k: i32, degree: i32) -> Verdict
where
    E: ExactEdge<f64, N, M>,
{
    let by = |power: i32| 2.0_f64.powi(power * k);
    let (at, scaled): (EdgeIntegrals<f64, M>, _) = (E::exact(p), E::exact(p.map(|v| v * by(1))));
    ensure!(scaled.energy == at.energy * by(degree));
    ensure!(scaled.active == at.active);
    for a in 0..M {
        ensure!(scaled.gradient[a] == at.gradient[a] * by(1));
        for b in 0..M {
            ensure!(scaled.hessian[a][b] == at.hessian[a][b]);
        }
    }
    let class = if at.active <= 0.0 {
        "open"
    } else if at.active < 1.0 {
        "cut"
    } else {
        "pressed"
    };
    Verdict::Holds(class)
}

/// Nodal values of P, and the power of two.
fn scalings() -> impl Strategy<Value = ([f64; 3], i32)> {
    (prop::array::uniform3(-1.0_f64..1.0), -60_i32..=60)
}

fn integrals_scale() -> Outcome {
    let classes = ["open", "cut", "pressed"];
    let p1 = draws::hold(2000, scalings(), &classes, |&([a, b, _], k)| {
        scales::<P1, 3, 2>([a, b], k, 2)
    })?;
    let p2 = draws::hold(2000, scalings(), &classes, |&(p, k)| scales::<P2, 6, 3>(p, k, 2))?;
    Ok(format!("P1: {p1}; P2: {p2}"))
}

/// A displacement of degree 2: coefficients of 1, x, y, x^2, xy, y^2 for each component. P2 has it exactly.
#[derive(Debug)]
struct Quadratic {
    material: Material<f64>,
    coefficients: [[f64; 6]; 2],
    gap: f64,
}

impl ExactSolution for Quadratic {
    fn material(&self) -> &Material<f64> {
        &self.material
    }

    fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.coefficients
            .map(|c| c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y)
    }

    fn gradient(&self, [x, y]: [f64; 2]) -> Matrix2<f64> {
        let slopes = self
            .coefficients
            .map(|c| [c[1] + 2.0 * c[3] * x + c[4] * y, c[2] + c[4] * x + 2.0 * c[5] * y]);
        Matrix2::from_fn(|i, j| slopes[i][j])
    }

    fn regularity(&self) -> f64 {
        f64::INFINITY
    }

    fn gap(&self, _: [f64; 2]) -> f64 {
        self.gap
    }
}

/// The squares of the errors of a P2 field from a quadratic one by their definitions, from the nodal values of the
/// difference: int_0^1 of products of polynomials by their end and middle values. `inverted` takes gamma for 1/gamma.
fn errors_on(problem: &Problem, sign: f64, inverted: bool) -> Result<(), String> {
    let method = Method { degree: Degree::Two, ..Method::default() };
    let d = discretize(problem, &method).map_err(text)?;
    let mut random = Random::new(draws::seed());
    let mut number = || random.below(2001) as f64 / 1000.0 - 1.0;
    let exact = Quadratic {
        material: *problem.material.of(0),
        coefficients: [0, 1].map(|_| std::array::from_fn(|_| number())),
        gap: 100.0 * number(),
    };
    let nodes = d.space.nodes();
    let u: Vec<[f64; 2]> = nodes.iter().map(|&x| exact.displacement(x)).collect();
    // Far from the obstacle, or far behind it: P has one sign.
    let v: Vec<[f64; 2]> = nodes.iter().map(|_| [number(), number() + sign * 1000.0]).collect();
    let e: Vec<[f64; 2]> = u.iter().zip(&v).map(|(u, v)| [u[0] - v[0], u[1] - v[1]]).collect();
    let found = Errors::new(&d.space, &d.contact, &v, &exact);
    let mut expected = Errors { energy: d.strain_energy(&e), ..Errors::default() };
    for (triangle, nodes) in d.space.triangles::<6>() {
        let local = nodes.map(|node| Vector2::from(e[node]));
        let area = triangle.double_area() / 2.0;
        for (l, weight) in quadrature::triangle(5) {
            let shapes: [f64; 6] = <P2 as Element<6, 3>>::values(l);
            let value = |c: usize| (0..6).map(|j| shapes[j] * local[j][c]).sum::<f64>();
            let gradients = <P2 as Element<6, 3>>::gradients(l, triangle.barycentric_gradients());
            let g = displacement_gradient(&local, &gradients);
            let slope = g.dot(&g);
            let l2 = value(0) * value(0) + value(1) * value(1);
            expected.l2 += area * weight * l2;
            expected.h1 += area * weight * (l2 + slope);
        }
    }
    let three = |p: Vec<f64>| [p[0], p[1], p[2]];
    let squared = |[a, b, m]: [f64; 3]| {
        (4.0 * (a * a + b * b) + 16.0 * m * m + 4.0 * m * (a + b) - 2.0 * a * b) / 30.0
    };
    for line in &d.contact {
        let [start, end] = line.sigma_n(|node| e[node]);
        let gamma = line.gamma;
        let weight = line.length * gamma;
        expected.normal_stress += weight * (start * start + start * end + end * end) / 3.0;
        let share = if inverted { weight } else { line.length / gamma };
        expected.operator += share * squared(three(line.p(&e)).map(|p| p - exact.gap));
        let [start, end] = line.sigma_n(|node| u[node]);
        let p = three(line.p(&v));
        let pressed = p.map(|p| positive_part(p) / gamma);
        let z = [start + pressed[0], end + pressed[1], (start + end) / 2.0 + pressed[2]];
        expected.contact_residual += weight * squared(z);
    }
    for (name, found, expected) in [
        ("energy", found.energy, expected.energy),
        ("H1", found.h1, expected.h1),
        ("L2", found.l2, expected.l2),
        ("contact residual", found.contact_residual, expected.contact_residual),
        ("normal stress", found.normal_stress, expected.normal_stress),
        ("operator", found.operator, expected.operator),
    ] {
        let expected = expected.sqrt();
        // The stress is small beside what cancels in it: the displacement is some 1000, the gradients some 1e4.
        if !((found - expected).abs() <= 1e-9 * expected) {
            return Err(format!("{name} is {found:e}, by definition {expected:e}"));
        }
    }
    Ok(())
}

fn errors_by_definition(inverted: bool) -> Outcome {
    let bodies = sharpness::small_bodies()?;
    for body in &bodies {
        for sign in [1.0, -1.0] {
            errors_on(&body.problem, sign, inverted).map_err(|e| format!("{}: {e}", body.name))?;
        }
    }
    Ok(format!("{} bodies, open and pressed", bodies.len()))
}

/// The row.
pub fn claim() -> Claim {
    let checks = vec![
        doubles!("kappa_of_1_or_more_is_refused_and_less_is_taken" => refusal(1.0)),
        doubles!("local_gammas_give_each_triangle_the_same_kappa" => kappas(Gamma0::Local(0.5))),
        doubles!("control_one_gamma0_for_all_triangles" => noticed(kappas(Gamma0::Auto))),
        exact!("gauss_rules_have_the_moments_of_legendre" => gauss_rules()),
        exact!("contact_edges_are_integrated_by_the_rule_that_is_asked_for" => rule_is_the_one_asked_for()),
        doubles!("integrals_over_an_edge_scale_by_powers_of_two_without_error" => integrals_scale()),
        doubles!("errors_of_p2_fields_from_quadratic_ones_are_their_definitions" => errors_by_definition(false)),
        doubles!("control_operator_error_with_gamma" => noticed(errors_by_definition(true))),
        doubles!("the_projection_is_nearer_than_the_discrete_solution_and_the_interpolant" => rates::projection_is_the_nearest()),
        doubles!("control_kappa_below_2_is_taken" => noticed(refusal(2.0))),
        exact!("control_another_rule_for_that_of_gauss" => other_rules()),
        doubles!("control_energy_of_degree_1" => draws::reject(scalings(), |&(p, k)| scales::<P2, 6, 3>(p, k, 1))),
        doubles!("control_the_interpolant_is_as_near_as_the_projection" => rates::interpolant_is_as_near()),
    ];
    Claim {
        id: "18",
        items: &["the solver"],
        title: "The limit of gamma0, and the rules by which (8) and its errors are integrated",
        paper: "gamma0 sufficiently small; the rest is not in the paper.",
        statement: "On nine small bodies, P1 and P2: gamma0 with kappa >= 1 is refused (from 1 + 1e-9 on), with kappa < 1 taken (up to 1 - 1e-9), and gamma0 = auto is kappa = 1/2. A local gamma gives each triangle on Gamma_C the kappa that is asked for. The Gauss rules with n <= 10 points have the moments 0 with the Legendre polynomials of degree 1 to 2n - 1, to a few units of roundoff, and not with that of degree 2n; contact edges are integrated by the one that is asked for. The integrals of [P]+ over an edge, P1 and P2, for 2^k P, |k| <= 60, are those for P times the power of two, bit for bit. The errors in all six norms of random P2 fields from quadratic ones, on nine bodies, open and pressed, are those of their definitions. The a-orthogonal projection of the exact solution is nearer to it in the energy norm than u^h and than the interpolant.",
        numbers: "doubles; the moments from the doubles of the rules over rationals.",
        kernel: &[
            "fem::quadrature::gauss",
            "fem::contact_face::EdgeRule::gauss",
            "fem::errors::with_points",
            "edge_integral::ExactEdge::exact",
        ],
        preconditions: "The processor rounds as in row 13; no underflow where P is scaled.",
        limits: "The bodies, the two exact solutions of row 12, and random data.",
        single: None,
        checks,
    }
}
