//! Lemma 3.1 at solutions that are no polynomials: smooth ones, the end of contact, u = O(r^(3/2)), and a corner where the
//! pressure is unbounded, u = O(r^alpha). The residual of the discrete equations at the exact u,
//!
//! int sigma(u):eps(v) - L(v) - int_C gamma sigma_n(u) sigma_n(v) + int_C (1/gamma) \[P(u)\]+ P0(v),
//!
//! is computed for every basis function v of P1 and of P2 that is zero on Gamma_D, by rules that are graded towards the
//! singular point, with the solver's functionals on contact edges. That the formulas of these solutions satisfy (1) and (2)
//! is a test (tests/suite/exact.rs).

use signorini::contact::Discretization;
use signorini::exact::ExactSolution;
use signorini::exact::errors::POINTS;
use signorini::kernel::{ContactPoint, Element, P1, P2, positive_part};
use signorini::model::graded_quadrature::Rule;
use signorini::model::{Condition, Degree};
use signorini::nalgebra::Vector2;
use signorini::solve::discretize_any;

use super::known::{CLASSES, Sample, samples};
use crate::claim::Outcome;
use crate::verdict::Verdict;
use crate::{draws, ensure, given};

/// The largest residual beside the largest sum of the magnitudes of its terms: it is 1e-14 at the end of contact, and at most 1e-5
/// where powers that are not whole end at a line, which the rules don't see.
const SMALL: f64 = 1e-4;

/// The factors of the terms; with a planted mistake one of them is another number than in (8).
#[derive(Clone, Copy)]
pub struct Terms {
    /// Of L(v).
    pub load: f64,
    /// Of int gamma sigma_n(u) sigma_n(v).
    pub stresses: f64,
    /// Of int (1/gamma) \[P(u)\]+ P0(v).
    pub contact: f64,
    /// theta in P0(v).
    pub theta: f64,
    /// Of sigma_n(u) in P(u).
    pub sigma_n: f64,
    /// The gap.
    pub gap: f64,
}

/// Those of (8).
pub const OF_8: Terms =
    Terms { load: 1.0, stresses: 1.0, contact: 1.0, theta: 1.0, sigma_n: 1.0, gap: 0.0 };

/// A functional at every basis function, with the sums of the magnitudes of its terms.
struct Sums {
    values: Vec<[f64; 2]>,
    sizes: Vec<[f64; 2]>,
}

impl Sums {
    fn add(&mut self, node: usize, c: usize, term: f64) {
        self.values[node][c] += term;
        self.sizes[node][c] += term.abs();
    }

    /// a(u, v) - L(v)
    fn add_forces<E: Element<N, M>, const N: usize, const M: usize>(
        &mut self,
        d: &Discretization<'_>,
        rule: &Rule,
        solution: &dyn ExactSolution,
        terms: Terms,
    ) {
        for (triangle, nodes) in d.space.triangles::<N>() {
            let barycentric = triangle.barycentric_gradients();
            rule.on_triangle(&triangle, |l, x, weight| {
                let [xx, yy, xy] = solution.stress(x).components();
                let f = solution.body_force(x).unwrap_or_default();
                let shapes = E::values(l).into_iter().zip(E::gradients(l, barycentric));
                for (&node, (shape, g)) in nodes.iter().zip(shapes) {
                    for (c, internal) in
                        [xx * g.x + xy * g.y, xy * g.x + yy * g.y].into_iter().enumerate()
                    {
                        self.add(node, c, weight * internal);
                        self.add(node, c, -terms.load * weight * f[c] * shape);
                    }
                }
            });
        }
        let mesh = d.space.mesh();
        let loaded = d
            .problem
            .conditions
            .iter()
            .filter(|(_, condition)| matches!(condition, Condition::Traction(_)));
        for &edge in loaded.flat_map(|(name, _)| mesh.edges_of(name).unwrap_or_default()) {
            let (length, n) = mesh.length_and_normal(edge);
            rule.on_edge(mesh.ends(edge).map(|v| mesh.vertices()[v]), [], |point| {
                let t = solution.stress(point.x).traction(n);
                let shapes: [f64; M] = E::edge_values(point.s);
                for (node, shape) in d.space.edge_nodes(edge).zip(shapes) {
                    for c in 0..2 {
                        self.add(node, c, -terms.load * point.weight * length * t[c] * shape);
                    }
                }
            });
        }
    }

    /// The contact terms.
    fn add_contact(
        &mut self,
        d: &Discretization<'_>,
        rule: &Rule,
        solution: &dyn ExactSolution,
        terms: Terms,
    ) {
        for face in &d.contact {
            let (n, gamma) = (face.normal(), face.gamma);
            let mesh = d.space.mesh();
            let ends = mesh.ends(face.edge()).map(|v| mesh.vertices()[v]);
            rule.on_edge(ends, [], |point| {
                let sigma_n = solution.stress(point.x).normal(n);
                let here = ContactPoint {
                    u_n: Vector2::from(solution.displacement(point.x)).dot(&n),
                    gap: terms.gap,
                    sigma_n: terms.sigma_n * sigma_n,
                    gamma,
                };
                let weight = point.weight * face.length;
                let pressure = positive_part(here.p()) / gamma;
                for (j, &node) in face.nodes.iter().enumerate() {
                    for c in 0..2 {
                        let along = |degree: Degree, rows: &[Vec<Vector2<f64>>]| {
                            let values: Vec<f64> = rows.iter().map(|row| row[j][c]).collect();
                            degree.value_at(&values, point.s)
                        };
                        let of_v = along(Degree::One, &face.sigma_n);
                        let p0 = along(face.degree, &face.p0) + (1.0 - terms.theta) * gamma * of_v;
                        self.add(node, c, -terms.stresses * weight * gamma * sigma_n * of_v);
                        self.add(node, c, terms.contact * weight * pressure * p0);
                    }
                }
            });
        }
    }
}

/// Every residual is small beside its terms.
fn vanishes(sample: &Sample, terms: Terms) -> Verdict {
    let Some((solution, problem)) = sample.problem() else { return Verdict::Vacuous };
    // Next to alpha = 1/2 the nearest points of a rule on an edge are, in doubles, the singular point itself.
    given!(solution.features().singular.is_none_or(|point| point.edge_grading < 80.0));
    let Ok(d) = discretize_any(&problem, &sample.method()) else { return Verdict::Vacuous };
    let rule = Rule::new(solution.features(), POINTS);
    let zero = || vec![[0.0; 2]; d.space.nodes().len()];
    let mut sums = Sums { values: zero(), sizes: zero() };
    match sample.degree {
        Degree::One => sums.add_forces::<P1, 3, 2>(&d, &rule, &*solution, terms),
        Degree::Two => sums.add_forces::<P2, 6, 3>(&d, &rule, &*solution, terms),
    }
    sums.add_contact(&d, &rule, &*solution, terms);
    let most = sums.sizes.as_flattened().iter().fold(0.0, |most: f64, &size| most.max(size));
    for (node, prescribed) in d.constraints.values().iter().enumerate() {
        for c in (0..2).filter(|&c| prescribed[c].is_none()) {
            ensure!(sums.values[node][c].abs() <= SMALL * most);
        }
    }
    Verdict::Holds(sample.class())
}

/// The residual is zero at the exact solution.
pub fn residual_vanishes() -> Outcome {
    draws::hold(24, samples(), &CLASSES, |sample| vanishes(sample, OF_8))
}

/// The control: with each of these factors the residual is not zero.
pub fn rejected(mistakes: &[Terms]) -> Outcome {
    let one = |&terms| draws::reject(samples(), |sample| vanishes(sample, terms));
    mistakes.iter().map(one).collect::<Result<Vec<_>, String>>().map(|all| all.join("; "))
}

/// A field with (1) but without (2): a tension where there is pressure.
pub fn tension_on_the_contact_line() -> Outcome {
    draws::reject(samples(), |sample| {
        sample.under_tension().map_or(Verdict::Vacuous, |sample| vanishes(&sample, OF_8))
    })
}
