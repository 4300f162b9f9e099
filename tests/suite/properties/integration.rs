//! The limit of gamma0, the functionals of a contact edge, and the rules by which the integrals of (8) and of errors are
//! computed.

use std::collections::BTreeMap;

use approx::abs_diff_eq;
use proptest::array::{uniform2, uniform3, uniform6};
use signorini::contact::contact_line::Coercivity;
use signorini::contact::{Discretization, EdgeRule};
use signorini::exact::{Errors, ExactSolution};
use signorini::kernel::DoubleDouble;
use signorini::kernel::edge_integral::ExactEdge;
use signorini::kernel::element::displacement_gradient;
use signorini::kernel::{EdgeIntegrals, Element, Material, P1, P2, Plane, positive_part};
use signorini::model::Degree;
use signorini::model::{Condition, Materials, Problem, quadrature};
use signorini::nalgebra::{Matrix2, Vector2};
use signorini::solve::{ContactQuadrature, Gamma0, Method, SolveError, discretize};

use super::bodies::small_bodies;
use super::{Outcome, field, for_all, properties, text};
use crate::common::{conditions, constant, unit_square};

/// kappa of a problem, where it is not refused.
fn kappa(degree: Degree, problem: &Problem, gamma0: Gamma0) -> Result<Option<f64>, String> {
    match discretize(problem, &Method { degree, gamma0, ..Method::default() }) {
        Ok(d) => Ok(Some(d.kappa())),
        Err(SolveError::NotCoercive { kappa, .. }) if kappa >= 1.0 => Ok(None),
        Err(other) => Err(other.to_string()),
    }
}

/// kappa from `limit` on is refused, less is taken and called what it is, and gamma0 = "auto" is kappa = 1/2.
fn refusals(limit: f64) -> Outcome {
    for (name, problem) in &small_bodies()? {
        for degree in [Degree::One, Degree::Two] {
            let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
            let most = d.coercivity.limit();
            for share in [1e-6, 0.5, 0.999, 1.0 - 1e-9, 1.0 + 1e-9, 1.001, 1.5, 1.999, 10.0] {
                let found = kappa(degree, problem, Gamma0::Value(share * most))?;
                let told =
                    found.is_none_or(|kappa| abs_diff_eq!(kappa, share, epsilon = 1e-14 * share));
                if found.is_some() != (share < limit) || !told {
                    return Err(format!("{name}: kappa = {share} is taken as {found:?}"));
                }
            }
            match kappa(degree, problem, Gamma0::Auto)? {
                Some(kappa) if abs_diff_eq!(kappa, 0.5, epsilon = 1e-15) => {}
                other => return Err(format!("{name}, auto: kappa = {other:?}")),
            }
        }
    }
    Ok(())
}

/// Each triangle on Gamma_C has kappa = 1/2, C gamma (lambda + 2 mu) |E| / |T| by \[2.3\] of docs/theory.md.
fn kappa_is_one_half(gamma0: Gamma0) -> Outcome {
    for (name, problem) in &small_bodies()? {
        for (degree, trace) in [(Degree::One, 1.0), (Degree::Two, 3.0)] {
            let d = discretize(problem, &Method { degree, gamma0, ..Method::default() });
            let mut lengths: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
            for line in &d.map_err(text)?.contact {
                lengths.entry(line.edge().triangle).or_insert((line.gamma, 0.0)).1 += line.length;
            }
            for (t, (gamma, length)) in lengths {
                let stiffness = problem.material.of(t).lambda() + 2.0 * problem.material.of(t).mu();
                let area = problem.mesh.triangle(t).double_area() / 2.0;
                let kappa = trace * gamma * stiffness * length / area;
                // A dozen roundings.
                if !abs_diff_eq!(kappa, 0.5, epsilon = 1e-14) {
                    return Err(format!("{name}: triangle {t} has kappa = {kappa}"));
                }
            }
        }
    }
    Ok(())
}

/// kappa / gamma0 is the largest over the contact triangles, each with its own material: stiff ones are every third, or, as the
/// mistake has it, none.
fn constants_are_own(in_the_check: bool) -> Outcome {
    let (soft, stiff) =
        (Material::lame(1.0, 1.0, Plane::Strain), Material::lame(20.0, 7.0, Plane::Strain));
    let mesh = unit_square(6).mesh().map_err(text)?;
    let count = mesh.triangles().len();
    let every_third: Vec<usize> = (0..count).step_by(3).collect();
    let materials = Materials::in_parts(soft, count, [(stiff, &every_third[..])]);
    let contact = || Condition::contact(|_| 0.0);
    let all =
        conditions([("top", Condition::clamped()), ("bottom", contact()), ("left", contact())]);
    let problem = Problem::new(mesh, materials, [constant(0.0), constant(0.0)], all);
    let mut lengths: BTreeMap<usize, f64> = BTreeMap::new();
    for name in ["bottom", "left"] {
        for &edge in problem.mesh.edges_of(name).map_err(text)? {
            *lengths.entry(edge.triangle).or_default() += problem.mesh.length_and_normal(edge).0;
        }
    }
    for (degree, trace) in [(Degree::One, 1.0), (Degree::Two, 3.0)] {
        let of = |(&t, length): (&usize, &f64)| {
            let m = if in_the_check { *problem.material.of(t) } else { soft };
            let area = problem.mesh.triangle(t).double_area() / 2.0;
            trace * (m.lambda() + 2.0 * m.mu()) * problem.mesh.diameter(t) * length / area
        };
        let expected = lengths.iter().map(of).fold(0.0, f64::max);
        let found = Coercivity::new(&problem, degree).map_err(text)?.constant;
        if !abs_diff_eq!(found / expected, 1.0, epsilon = 1e-14) {
            return Err(format!("C_h = {found}, expected {expected}"));
        }
    }
    Ok(())
}

/// The first 2n moments of a rule on \[0, 1\] with the Legendre polynomials in 2 s - 1 are those of the integral, and the next
/// one is not: the rule is that of Gauss with n points.
fn is_gauss(n: usize, rule: &[(f64, f64)]) -> Outcome {
    let of = |x: f64| DoubleDouble::from(x);
    let mut moments = vec![of(0.0); 2 * n + 1];
    for &(s, weight) in rule {
        let x = of(2.0) * of(s) - of(1.0);
        let (mut before, mut p) = (of(0.0), of(1.0));
        for (k, moment) in moments.iter_mut().enumerate() {
            *moment += of(weight) * p;
            let k = k as f64;
            let next = (of(2.0 * k + 1.0) * x * p - of(k) * before) / of(k + 1.0);
            (before, p) = (p, next);
        }
    }
    // A point is known to a few units, and P_k has slopes up to k^2.
    let slack = 8.0 * f64::EPSILON * (n * n) as f64;
    for (k, moment) in moments.iter().enumerate() {
        let expected = if k == 0 { 1.0 } else { 0.0 };
        if abs_diff_eq!(moment.head(), expected, epsilon = slack) != (k < 2 * n) {
            return Err(format!("n = {n}: moment {k} is {moment:?}"));
        }
    }
    let inside = rule.iter().all(|&(s, weight)| 0.0 < s && s < 1.0 && weight > 0.0);
    if inside && rule.len() == n { Ok(()) } else { Err(format!("n = {n}: {rule:?}")) }
}

/// The rules of 1 to 10 points and of 16, 32 and 64, their weights times `heavier`.
fn gauss_rules(heavier: f64) -> Outcome {
    (1..=10).chain([16, 32, 64]).try_for_each(|n| {
        let rule = quadrature::gauss(n).into_iter().map(|(s, weight)| (s, weight * heavier));
        is_gauss(n, &rule.collect::<Vec<_>>())
    })
}

/// A discretization integrates contact terms by the rule with as many points as are asked for and `more`.
fn asked_for(more: usize) -> Outcome {
    let (_, problem) = small_bodies()?.swap_remove(0);
    let rule = |quadrature| {
        let method = Method { quadrature, ..Method::default() };
        discretize(&problem, &method).map(|d| d.rule).map_err(text)
    };
    if rule(ContactQuadrature::Exact)? != EdgeRule::Exact {
        return Err("not exact".to_owned());
    }
    (1..=10).try_for_each(|n| match rule(ContactQuadrature::Gauss(n))? {
        EdgeRule::Gauss(points) => is_gauss(n + more, &points),
        EdgeRule::Exact => Err(format!("exact for {n} points")),
    })
}

/// The integrals for 2^k P are those for P times 2^k for each factor of P in them, bit for bit: a power of two rounds
/// nothing, and no test of a sign may know of a size.
fn scales<E, const N: usize, const M: usize>(p: [f64; M], k: i32, degree: i32) -> Outcome
where
    E: ExactEdge<f64, N, M>,
{
    let by = |power: i32| 2.0_f64.powi(power * k);
    let (at, scaled): (EdgeIntegrals<f64, M>, _) = (E::exact(p), E::exact(p.map(|v| v * by(1))));
    let same = scaled.energy == at.energy * by(degree)
        && scaled.active == at.active
        && scaled.gradient == at.gradient.map(|g| g * by(1))
        && scaled.hessian == at.hessian;
    if same { Ok(()) } else { Err(format!("P = {p:?}, 2^{k}")) }
}

/// `degree` is that of the energy (2).
fn integrals_scale(degree: i32) -> Outcome {
    for_all(2000, (uniform3(-1.0..1.0), -60..=60), |(p, k)| {
        scales::<P1, 3, 2>([p[0], p[1]], k, degree)?;
        scales::<P2, 6, 3>(p, k, degree)
    })
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
fn errors_on(problem: &Problem, sign: f64, inverted: bool) -> Outcome {
    let method = Method { degree: Degree::Two, ..Method::default() };
    let d = discretize(problem, &method).map_err(text)?;
    let data = (uniform2(uniform6(-1.0..1.0)), -100.0..100.0, field(d.space.nodes().len()));
    for_all(1, data, |(coefficients, gap, v)| {
        let exact = Quadratic { material: *problem.material.of(0), coefficients, gap };
        errors_from(&d, &exact, v, sign, inverted)
    })
}

fn errors_from(
    d: &Discretization,
    exact: &Quadratic,
    v: Vec<[f64; 2]>,
    sign: f64,
    inverted: bool,
) -> Outcome {
    let nodes = d.space.nodes();
    let u: Vec<[f64; 2]> = nodes.iter().map(|&x| exact.displacement(x)).collect();
    // Far from the obstacle, or far behind it: P has one sign.
    let v: Vec<[f64; 2]> = v.into_iter().map(|[x, y]| [x, y + sign * 1000.0]).collect();
    let e: Vec<[f64; 2]> = u.iter().zip(&v).map(|(u, v)| [u[0] - v[0], u[1] - v[1]]).collect();
    let found = Errors::new(&d.space, &d.contact, &v, exact);
    let mut expected = Errors { energy: d.strain_energy(&e), ..Errors::default() };
    for (triangle, nodes) in d.space.triangles::<6>() {
        let local = nodes.map(|node| Vector2::from(e[node]));
        let area = triangle.double_area() / 2.0;
        for (l, weight) in quadrature::triangle(5) {
            let shapes: [f64; 6] = <P2 as Element<6, 3>>::values(l);
            let value = |c: usize| (0..6).map(|j| shapes[j] * local[j][c]).sum::<f64>();
            let gradients = <P2 as Element<6, 3>>::gradients(l, triangle.barycentric_gradients());
            let g = displacement_gradient(&local, &gradients);
            let l2 = value(0) * value(0) + value(1) * value(1);
            expected.l2 += area * weight * l2;
            expected.h1 += area * weight * (l2 + g.dot(&g));
        }
    }
    let three = |p: Vec<f64>| [p[0], p[1], p[2]];
    let squared = |[a, b, m]: [f64; 3]| {
        (4.0 * (a * a + b * b) + 16.0 * m * m + 4.0 * m * (a + b) - 2.0 * a * b) / 30.0
    };
    for line in &d.contact {
        let [start, end] = line.sigma_n(&e);
        let gamma = line.gamma;
        let weight = line.length * gamma;
        expected.normal_stress += weight * (start * start + start * end + end * end) / 3.0;
        let share = if inverted { weight } else { line.length / gamma };
        expected.operator += share * squared(three(line.p(&e)).map(|p| p - exact.gap));
        let [start, end] = line.sigma_n(&u);
        let pressed = three(line.p(&v)).map(|p| positive_part(p) / gamma);
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
        if !abs_diff_eq!(found, expected, epsilon = 1e-9 * expected) {
            return Err(format!("{name} is {found:e}, by definition {expected:e}"));
        }
    }
    Ok(())
}

fn errors_by_definition(inverted: bool) -> Outcome {
    for (name, problem) in &small_bodies()? {
        for sign in [1.0, -1.0] {
            errors_on(problem, sign, inverted).map_err(|why| format!("{name}: {why}"))?;
        }
    }
    Ok(())
}

properties! {
    kappa_of_1_or_more_is_refused_and_less_is_taken: refusals(1.0); not refusals(2.0);
    local_gammas_give_each_triangle_the_same_kappa: kappa_is_one_half(Gamma0::Local(0.5));
        not kappa_is_one_half(Gamma0::Auto);
    kappa_is_the_largest_over_triangles_with_their_own_materials: constants_are_own(true);
        not constants_are_own(false);
    gauss_rules_have_the_moments_of_legendre: gauss_rules(1.0);
        not gauss_rules(1.0001), is_gauss(4, &quadrature::gauss(5));
    contact_edges_are_integrated_by_the_rule_that_is_asked_for: asked_for(0); not asked_for(1);
    integrals_over_an_edge_scale_by_powers_of_two_without_error: integrals_scale(2); not integrals_scale(1);
    errors_of_p2_fields_from_quadratic_ones_are_their_definitions: errors_by_definition(false);
        not errors_by_definition(true);
}
