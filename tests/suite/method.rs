//! Newton's method on meshes: where plain Newton cycles (docs/theory.md, 4.4), at a kink, and at a tolerance that rounding does not
//! let it reach.

use crate::common::*;
use approx::{abs_diff_eq, assert_abs_diff_eq};
use faer::linalg::solvers::Solve;
use faer::{Col, Mat};
use signorini::contact::Discretization;
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Problem, Rectangle};
use signorini::results::{Status, Verdict};
use signorini::solve::iterate::Evaluated;
use signorini::solve::{
    ContactQuadrature, Gamma0, Method, Settings, discretize, solve, solve_discrete,
};

/// [0, 0.3] x [0, 1] in 6 x 4 cells, lambda = mu = 1, clamped on top, no load, one Gauss point per contact edge, the gap at
/// the middles of the edges -0.2, -0.8, 0.1, -0.3, -0.9, -0.3: plain Newton repeats four contact sets for ever.
fn cycling() -> (Problem, Method) {
    let rectangle = Rectangle { width: 0.3, height: 1.0, nx: 6, ny: 4, diagonal: Diagonal::Right };
    // Nodal values whose means over the edges are those.
    const GAP: [f64; 7] = [0.0, -0.4, -1.2, 1.4, -2.0, 0.2, -0.8];
    let problem = Problem::of(rectangle.mesh().unwrap(), unit_material())
        .with("top", Condition::clamped())
        .with("bottom", Condition::contact(|[x, _]| GAP[(x / 0.05).round() as usize]));
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
            for functional in &edge.p0 {
                for (&node, f) in edge.nodes.iter().zip(functional) {
                    for c in 0..2 {
                        r[node][c] += middle / 2.0 * f[c];
                    }
                }
            }
        }
        r
    };
    let of = |r: &[[f64; 2]], k: usize| r[free[k].0][free[k].1];
    let mut u = vec![[0.0; 2]; nodes];
    let at_zero = affine(&u);
    let images: Vec<Vec<[f64; 2]>> = free
        .iter()
        .map(|&(i, c)| {
            let mut unit = vec![[0.0; 2]; nodes];
            unit[i][c] = 1.0;
            affine(&unit)
        })
        .collect();
    let n = free.len();
    let tangent = Mat::from_fn(n, n, |row, k| of(&images[k], row) - of(&at_zero, row));
    let x = tangent.partial_piv_lu().solve(Col::from_fn(n, |row| -of(&at_zero, row)));
    for (k, &(i, c)) in free.iter().enumerate() {
        u[i][c] = x[k];
    }
    u
}

/// That it is the line search which ends it is a test beside `solve::newton`: the solver does not start here, but from soft
/// springs.
#[test]
fn plain_newton_cycles_where_the_solver_ends() {
    let (problem, method) = cycling();
    let d = discretize(&problem, &method).unwrap();
    assert_abs_diff_eq!(d.kappa(), 0.03, epsilon = 1e-15);
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
        assert!(abs_diff_eq!(*energy, expected, epsilon = 1e-4), "{energies:?}");
    }
    // The solver: at the minimiser.
    let (Evaluated { u, .. }, report, _) = solve_discrete(&d, &Settings::default()).unwrap();
    assert_eq!(report.newton.status, Status::Converged);
    assert_eq!(contact_set(&d, &u), [2, 5]);
    assert!(abs_diff_eq!(d.energy(&u), 0.291087, epsilon = 1e-6), "{}", d.energy(&u));
    assert!(energies.iter().all(|e| *e > d.energy(&u)));
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
fn the_derivative_of_the_positive_part_at_zero_does_not_change_the_solution() {
    // At u = 0 with g = 0 and no contact anywhere every P is zero: Newton starts at the kink.
    let problem = block(unit_square(6).mesh().unwrap()).with_body_force(|_| 0.0, |_| 1.0);
    let (s, _) = solve(&problem, &method(Degree::One, EXACT), &Settings::default()).unwrap();
    assert_eq!(s.newton.status, Status::Converged);
    assert_eq!(s.quantities.contact_length, 0.0);
}

#[test]
fn a_body_that_a_support_moves_as_a_whole_takes_no_step_and_one_that_it_presses_takes_some() {
    let steps = |gap: f64, degree| {
        let top = ["0", "-0.015"].map(|u| Some(expression(u)));
        let cells =
            Rectangle { width: 2.0, height: 1.0, nx: 12, ny: 6, diagonal: Diagonal::Crossed };
        let problem = Problem::of(cells.mesh().unwrap(), unit_material())
            .with("top", Condition::Displacement(top))
            .with("bottom", Condition::contact(move |_| gap));
        let (s, _) = solve(&problem, &method(degree, EXACT), &Settings::default()).unwrap();
        assert_eq!(s.verdict, Verdict::Proved);
        s.newton.iterations()
    };
    for degree in DEGREES {
        assert_eq!(steps(1e9, degree), 0);
        assert!(steps(0.01, degree) >= 1, "control");
    }
}
