//! Method (8) itself: the tangent is the derivative of the residual, the solution is in equilibrium, Newton's method with its
//! line search ends where plain Newton cycles, and the condensed solve is the solution of the full system.

use crate::common::*;
use nalgebra::DVector;
use signorini::fem::EdgeRule;
use signorini::fem::dense::inner;
use signorini::fem::matrix::{self, Neighbours, Numbering};
use signorini::fem::{Condition, Diagonal, Discretization, Problem, Rectangle};
use signorini::io::Case;
use signorini::kernel::{Material, Plane};
use signorini::solve::iterate::Evaluated;
use signorini::solve::{
    ContactQuadrature, Degree, Gamma0, Method, Settings, SolveError, Status, solve, solve_discrete,
};

fn half_the_limit(degree: Degree, problem: &Problem, rule: EdgeRule) -> Discretization<'_> {
    Discretization::new(problem, degree, |c| c.limit() / 2.0, rule).unwrap()
}

fn shifted(u: &[[f64; 2]], t: f64, v: &[[f64; 2]]) -> Vec<[f64; 2]> {
    u.iter().zip(v).map(|(u, v)| [u[0] + t * v[0], u[1] + t * v[1]]).collect()
}

/// The tangent at u applied to v: A v from the assembled matrix, plus B^T H B v edge by edge. `slip` scales H, for the
/// control.
fn tangent(d: &Discretization, u: &[[f64; 2]], v: &[[f64; 2]], slip: f64) -> Vec<[f64; 2]> {
    let nodes = d.space.nodes().len();
    let order: Vec<usize> = (0..nodes).collect();
    let numbering = Numbering::new(&order, &vec![[None; 2]; nodes]);
    let neighbours = Neighbours::new(&d.space);
    let a = matrix::assemble(d, &numbering, &neighbours);
    let x = numbering.gather(v);
    let mut product = vec![0.0; x.len()];
    for column in 0..x.len() {
        for k in a.starts[column]..a.starts[column + 1] {
            let row = a.rows[k];
            product[row] += a.values[k] * x[column];
            if row != column {
                product[column] += a.values[k] * x[row];
            }
        }
    }
    let mut result = vec![[0.0; 2]; nodes];
    numbering.scatter(&product, &mut result);
    for edge in &d.contact {
        let weight = slip * edge.length / edge.gamma;
        let bv = weight * d.rule.integrals(&edge.p(u)).hessian * DVector::from(edge.p0(v));
        edge.add_contact(bv.as_slice(), &mut result);
    }
    result
}

/// Away from kinks the residual is quadratic in u on an edge that stays cut (P1) or smooth (P2), so a central difference
/// with step h is off by O(h^2) there and by rounding eps |R| / h elsewhere: 1e-6 for h = 1e-5. At a kink (an end of an
/// edge changing sign within the step) the residual is still C^1, off by O(h).
fn tangent_error(degree: Degree, rule: EdgeRule, slip: f64) -> f64 {
    let problem = block(skewed_square(4, Diagonal::Crossed));
    let d = half_the_limit(degree, &problem, rule);
    let mut random = Random(5);
    let mut worst: f64 = 0.0;
    for _ in 0..10 {
        let (u, v) = (random.field(d.space.nodes().len()), random.field(d.space.nodes().len()));
        let h = 1e-5;
        let [plus, minus] = [h, -h].map(|h| d.residual(&shifted(&u, h, &v)).values);
        let expected = tangent(&d, &u, &v, slip);
        let scale = expected.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        for i in 0..plus.len() {
            for c in 0..2 {
                let difference = (plus[i][c] - minus[i][c]) / (2.0 * h);
                worst = worst.max((difference - expected[i][c]).abs() / scale);
            }
        }
    }
    worst
}

#[test]
fn the_tangent_is_the_derivative_of_the_residual_for_p1_and_p2() {
    for rule in [EdgeRule::Exact, EdgeRule::gauss(4)] {
        for error in [
            tangent_error(Degree::One, rule.clone(), 1.0),
            tangent_error(Degree::Two, rule.clone(), 1.0),
        ] {
            assert!(error < 1e-6, "{rule:?}: {error:e}");
        }
    }
}

#[test]
fn control_a_tangent_with_a_slightly_wrong_contact_block_is_noticed() {
    assert!(tangent_error(Degree::One, EdgeRule::Exact, 1.001) > 1e-5);
    assert!(tangent_error(Degree::Two, EdgeRule::Exact, 1.001) > 1e-5);
}

#[test]
fn rigid_body_motions_cost_no_energy() {
    let problem = block(skewed_square(5, Diagonal::Left));
    let d = half_the_limit(Degree::Two, &problem, EdgeRule::Exact);
    for motion in [|_: [f64; 2]| [1.0, 0.0], |_| [0.0, 1.0], |[x, y]: [f64; 2]| [-y, x]] {
        let u: Vec<[f64; 2]> = d.space.nodes().iter().map(|&x| motion(x)).collect();
        let forces = d.internal_forces(&u);
        for (force, magnitude) in forces.values.iter().zip(&forces.magnitudes) {
            for c in 0..2 {
                assert!(force[c].abs() <= 8.0 * f64::EPSILON * magnitude[c]);
            }
        }
    }
}

fn example_problems() -> Vec<(&'static str, Problem)> {
    let gap = Problem {
        body_force: [constant(0.0), constant(0.0)],
        conditions: conditions([
            ("top", Condition::Displacement([Some(constant(0.01)), Some(constant(-0.05))])),
            ("bottom", Condition::Contact { gap: function(|[x, _]| 0.2 * (x - 0.3) * (x - 0.3)) }),
            ("right", Condition::Traction([function(|[_, y]| 0.1 * y), constant(0.02)])),
        ]),
        ..block(skewed_square(8, Diagonal::Crossed))
    };
    let sliding = Problem {
        conditions: conditions([
            ("left", Condition::Displacement([Some(constant(0.0)), None])),
            ("top", Condition::Displacement([None, Some(constant(-0.02))])),
            ("bottom", Condition::Contact { gap: constant(0.0) }),
        ]),
        material: Material::young_poisson(3.0, 0.4, Plane::Stress).into(),
        ..block(skewed_square(7, Diagonal::Left))
    };
    vec![("block", block(skewed_square(8, Diagonal::Right))), ("gap", gap), ("sliding", sliding)]
}

/// Loads, contact and reactions balance, in force and in moment about the origin. The loads are taken from L at the
/// rigid body motions, the contact from lambda^h along the line, the reactions from the residual.
fn equilibrium(
    degree: Degree,
    name: &str,
    problem: &Problem,
    rule: EdgeRule,
    contact_factor: f64,
) -> f64 {
    let d = half_the_limit(degree, problem, rule);
    let (Evaluated { u, .. }, report, _) = solve_discrete(&d, &Settings::default()).unwrap();
    assert_eq!(report.newton.status, Status::Converged, "{name}");
    let residual = d.residual(&u).values;
    let motions = [|_: [f64; 2]| [1.0, 0.0], |_| [0.0, 1.0], |[x, y]: [f64; 2]| [-y, x]];
    let mut worst: f64 = 0.0;
    for motion in motions {
        let field: Vec<[f64; 2]> = d.space.nodes().iter().map(|&x| motion(x)).collect();
        let load = inner(&d.load, &field);
        let mut reaction = 0.0;
        for held in d.constraints.holders().values() {
            for held in held {
                let ([a, b], [x, y]) = (held.part_of(residual[held.node]), field[held.node]);
                reaction += a * x + b * y;
            }
        }
        let mut contact = 0.0;
        for edge in &d.contact {
            let gradient = d.rule.integrals(&edge.p(&u)).gradient;
            for (a, node) in d.space.edge_nodes(edge.edge).into_iter().enumerate() {
                let (g, n) = (gradient[a], edge.directions[a]);
                let v_n = field[node][0] * n[0] + field[node][1] * n[1];
                contact -= contact_factor * edge.length / edge.gamma * g * v_n;
            }
        }
        let size = load.abs() + reaction.abs() + contact.abs();
        worst = worst.max((load + reaction + contact).abs() / size.max(0.1));
    }
    worst
}

/// The problems of the files in `cases/`.
fn cases() -> Vec<(String, Problem)> {
    let files = std::fs::read_dir("cases").unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = files.filter(|f| f.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    assert!(files.len() >= 4);
    files.into_iter().map(|f| (f.display().to_string(), Case::read(&f).unwrap().problem)).collect()
}

#[test]
fn loads_contact_and_reactions_balance_in_force_and_moment() {
    let examples = example_problems().into_iter().map(|(name, p)| (name.to_owned(), p));
    for (name, problem) in examples.chain(cases()) {
        let name = &name;
        for rule in [EdgeRule::Exact, EdgeRule::gauss(4)] {
            let p1 = equilibrium(Degree::One, name, &problem, rule.clone(), 1.0);
            let p2 = equilibrium(Degree::Two, name, &problem, rule, 1.0);
            // Steel is 2e4 times as stiff as rubber, and takes so much of the digits of what rubber carries.
            // And a body that contact alone holds has no support to take what rounding leaves.
            let more = match name {
                name if name.contains("bracket") => 100.0,
                name if name.contains("disk_force") || name.contains("wood") => 10.0,
                // Solved to the tolerance, 1e-10, and no further.
                name if name.contains("pin") => 1000.0,
                _ => 1.0,
            };
            assert!(p1 < more * 1e-12 && p2 < more * 1e-11, "{name}: {p1:e} {p2:e}");
        }
    }
}

#[test]
fn control_a_contact_force_that_is_a_little_off_breaks_the_balance() {
    for (name, problem) in example_problems() {
        assert!(equilibrium(Degree::One, name, &problem, EdgeRule::Exact, 1.0 + 1e-6) > 1e-9);
    }
}

#[test]
fn results_are_the_same_to_the_bit_from_run_to_run() {
    for (_, problem) in example_problems() {
        for degree in [Degree::One, Degree::Two] {
            let run = || solve(&problem, &method(degree, EXACT), &Settings::default()).unwrap().0;
            let (a, b) = (run(), run());
            assert_eq!(a.displacement, b.displacement);
            assert_eq!(a.newton, b.newton);
            assert_eq!(a.quantities, b.quantities);
        }
    }
}

/// [0, 0.3] x [0, 1] in 6 x 4 cells, lambda = mu = 1, clamped on top, no load, one Gauss point per contact edge, the gap at
/// the middles of the edges -0.2, -0.8, 0.1, -0.3, -0.9, -0.3: plain Newton repeats four contact sets for ever.
fn cycling() -> (Problem, Method) {
    let rectangle = Rectangle { width: 0.3, height: 1.0, nx: 6, ny: 4, diagonal: Diagonal::Right };
    // Nodal values whose means over the edges are those.
    const GAP: [f64; 7] = [0.0, -0.4, -1.2, 1.4, -2.0, 0.2, -0.8];
    let problem = Problem {
        mesh: rectangle.mesh().unwrap(),
        body_force: [constant(0.0), constant(0.0)],
        conditions: conditions([
            ("top", clamped()),
            (
                "bottom",
                Condition::Contact { gap: function(|[x, _]| GAP[(x / 0.05).round() as usize]) },
            ),
        ]),
        ..block(unit_square(1).mesh().unwrap())
    };
    let method = Method {
        degree: Degree::One,
        gamma0: Gamma0::Value(0.0049029033784546),
        quadrature: ContactQuadrature::Gauss(1),
        allow_noncoercive: false,
    };
    (problem, method)
}

/// The edges in contact, counted from 1.
fn contact_set(d: &Discretization, u: &[[f64; 2]]) -> Vec<usize> {
    let in_contact = d.contact.iter().enumerate().filter(|(_, edge)| {
        let p = edge.p(u);
        p[0] + p[1] > 0.0
    });
    in_contact.map(|(e, _)| e + 1).collect()
}

/// The solution of the linear problem in which exactly the edges of `set` are in contact: an iterate of plain Newton.
fn newton_iterate(d: &Discretization, set: &[usize]) -> Vec<[f64; 2]> {
    let nodes = d.space.nodes().len();
    let free: Vec<(usize, usize)> = (0..nodes)
        .flat_map(|i| [(i, 0), (i, 1)])
        .filter(|&(i, c)| d.constraints.values()[i][c].is_none())
        .collect();
    // With exactly the edges of `set` closed the residual is affine in u; its differences are the columns of the tangent.
    let affine = |u: &[[f64; 2]]| {
        let mut r = d.linear_residual(u).values;
        for &e in set {
            let edge = &d.contact[e - 1];
            let p = edge.p(u);
            let middle = edge.length / edge.gamma * (p[0] + p[1]) / 2.0;
            for functional in edge.functionals.p0() {
                for (&node, f) in edge.nodes.iter().zip(functional) {
                    for c in 0..2 {
                        r[node][c] += middle / 2.0 * f[c];
                    }
                }
            }
        }
        r
    };
    let zero = vec![[0.0; 2]; nodes];
    let at_zero = affine(&zero);
    let n = free.len();
    let mut system = vec![vec![0.0; n + 1]; n];
    for (column, &(i, c)) in free.iter().enumerate() {
        let mut unit = zero.clone();
        unit[i][c] = 1.0;
        let image = affine(&unit);
        for (row, &(j, k)) in free.iter().enumerate() {
            system[row][column] = image[j][k] - at_zero[j][k];
        }
    }
    for (row, &(j, k)) in free.iter().enumerate() {
        system[row][n] = -at_zero[j][k];
    }
    let mut u = zero;
    for (&(i, c), x) in free.iter().zip(gauss_elimination(system)) {
        u[i][c] = x;
    }
    u
}

fn gauss_elimination(mut a: Vec<Vec<f64>>) -> Vec<f64> {
    let n = a.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        a.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            for j in k..=n {
                let eliminated = factor * a[k][j];
                a[i][j] -= eliminated;
            }
        }
    }
    let mut x = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| a[i][j] * x[j]).sum();
        x[i] = (a[i][n] - known) / a[i][i];
    }
    x
}

/// That it is the line search which ends it is a property of `properties::newton`: the solver does not start here, but from soft
/// springs.
#[test]
fn plain_newton_cycles_where_the_solver_ends() {
    let (problem, method) = cycling();
    let d: Discretization = signorini::solve::discretize(&problem, &method).unwrap();
    assert!((d.kappa() - 0.03).abs() < 1e-15);
    let mut set = vec![5];
    let mut visited = Vec::new();
    let mut energies = Vec::new();
    for _ in 0..8 {
        let u = newton_iterate(&d, &set);
        energies.push(d.energy(&u));
        set = contact_set(&d, &u);
        visited.push(set.clone());
    }
    let cycle: [&[usize]; 4] = [&[1, 2, 5], &[2], &[2, 5, 6], &[5]];
    for (step, set) in visited.iter().enumerate() {
        assert_eq!(set, cycle[step % 4], "{visited:?}");
    }
    for (energy, expected) in energies.iter().zip([4.4519, 0.81341, 7.5760, 0.90384]) {
        assert!((energy - expected).abs() < 1e-4, "{energies:?}");
    }
    // The solver: at the minimiser.
    let (Evaluated { u, .. }, report, _) = solve_discrete(&d, &Settings::default()).unwrap();
    assert_eq!(report.newton.status, Status::Converged);
    assert_eq!(contact_set(&d, &u), [2, 5]);
    assert!((d.energy(&u) - 0.291087).abs() < 1e-6, "{}", d.energy(&u));
    assert!(energies.iter().all(|e| *e > d.energy(&u)));
}

#[test]
fn kappa_at_or_beyond_1_is_refused_with_the_limit_and_its_edge() {
    let problem = block(unit_square(4).mesh().unwrap());
    let mut method = Method { gamma0: Gamma0::Value(0.2), ..method(Degree::One, EXACT) };
    let error = solve(&problem, &method, &Settings::default()).unwrap_err();
    let SolveError::NotCoercive { kappa, limit, edge, .. } = error else { panic!("{error}") };
    assert!((kappa - 1.2 * 2.0_f64.sqrt()).abs() < 1e-14);
    assert!((limit - 1.0 / (6.0 * 2.0_f64.sqrt())).abs() < 1e-15);
    assert_eq!(edge, [[0.0, 0.0], [0.25, 0.0]]);
    method.allow_noncoercive = true;
    method.gamma0 = Gamma0::Value(1.05 * limit);
    let (s, _) = solve(&problem, &method, &Settings::default()).unwrap();
    assert_eq!(s.newton.status, Status::Converged, "below the true limit it still works");
    method.gamma0 = Gamma0::Value(10.0 * limit);
    let error = solve(&problem, &method, &Settings::default()).unwrap_err();
    assert_eq!(error, SolveError::NotPositiveDefinite);
}

#[test]
fn a_tolerance_below_rounding_ends_in_converged_to_rounding() {
    let problem = block(unit_square(16).mesh().unwrap());
    let settings = Settings::new(1e-18, 50).unwrap();
    let (s, _) = solve(&problem, &method(Degree::Two, EXACT), &settings).unwrap();
    assert_eq!(s.newton.status, Status::ConvergedToRounding);
    assert!(s.newton.residual < 1e-11);
}

#[test]
fn too_few_iterations_are_no_solution() {
    let problem = block(unit_square(16).mesh().unwrap());
    let settings = Settings::new(1e-10, 2).unwrap();
    let error = solve(&problem, &method(Degree::One, EXACT), &settings).unwrap_err();
    let SolveError::NotConverged { residuals, .. } = &error else { panic!("{error}") };
    assert_eq!(residuals.len(), 3);
    assert!(error.to_string().contains("max_iterations"));
}

#[test]
fn the_derivative_of_the_positive_part_at_zero_does_not_change_the_solution() {
    // At u = 0 with g = 0 and no contact anywhere every P is zero: Newton starts at the kink.
    let mut problem = block(unit_square(6).mesh().unwrap());
    problem.body_force = [constant(0.0), constant(1.0)];
    let (s, _) = solve(&problem, &method(Degree::One, EXACT), &Settings::default()).unwrap();
    assert_eq!(s.newton.status, Status::Converged);
    assert_eq!(s.quantities.contact_length, 0.0);
}
