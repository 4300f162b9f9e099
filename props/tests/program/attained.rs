//! Bounds beside what attains them, or beside their formulas: those of the enclosure and of a certificate are compared with
//! numbers that are as large as they, so that a bound too small by a tenth is noticed.
//!
//! - the radius of the enclosure and the constant of (12), by the eigenvector of A on a body where they are attained up to a
//!   thousandth: without loads and with the obstacle far away, u^h = 0, and the field itself is the error; likewise where kappa is
//!   next to 1 and the radius is a crude one;
//! - the interval of a reaction, where an end of a contact edge is held and the other one is moved;
//! - Korn's factors at nodes, by the formulas of docs/a-posteriori.md, 7.6, from distances of triangles that are found by
//!   going over all pairs of neighbours until nothing changes;
//! - what contact adds to a certificate where its direction turns: the square of the bound less 2 J(v) depends on tau and g alone
//!   (Green's formula), and what g adds to it is known.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

use approx::abs_diff_eq;
use faer::{Mat, Side as Triangle};
use proptest::prelude::*;
use signorini::certificates::proof::{Certificate, Edge, Lift, Proof, Role};
use signorini::certificates::{Rejection, certify};
use signorini::kernel::{Ball, Material, Plane};
use signorini::linear::factor::Factor;
use signorini::linear::system::System;
use signorini::model::Degree;
use signorini::model::constraints::Constraints;
use signorini::model::{
    Condition, Diagonal, Materials, Mesh, Obstacle, Problem, Rectangle, SharedFunction, Side, Space,
};
use signorini::nalgebra::Vector3;
use signorini::proof::enclosure;
use signorini::proof::korn::{Hold, Korn, Term};
use signorini::solve::{Gamma0, Method, Settings, discretize_any, solve, solve_discrete};

use super::enclosure::factor_of;
use super::solved::{Draw as Floor, bodies};
use props::claim::{Outcome, noticed, text};
use props::claims::one_solution::{NARROW_TRAPEZOID, eigenvector, share_of_12};
use props::problems::{cells, diagonals, floor, held, mesh, problem, unloaded};
use props::proof::sampler::Random;
use props::verdict::Verdict;
use props::{draws, ensure, sharpness};

/// The numbers kappa at which radii are compared with errors.
const KAPPAS: [f64; 3] = [0.1, 0.5, 0.9];

/// The radius of the enclosure over the error in the energy norm, with the factor of A times `matrix` at hand; and the square of
/// the error in the norm of A over what (12) says that it is at least.
fn attained(
    mut problem: Problem,
    degree: Degree,
    kappa: f64,
    matrix: f64,
) -> Result<[f64; 2], String> {
    problem.conditions.insert("bottom".to_owned(), floor(1.0));
    let d =
        discretize_any(&problem, &sharpness::at_kappa(&problem, degree, kappa)?).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let factor = Factor::new(&system.matrix).map_err(text)?;
    let u = eigenvector(&d, &system, &factor);
    let of_a = Some(Arc::new(factor_of(&system, matrix).map_err(text)?).into());
    let radius = enclosure::enclose(&system, &u, None, of_a).map_err(text)?.radius;
    let of_12 = share_of_12(&d, &system, &u, kappa);
    Ok([radius / d.strain_energy(&u).sqrt(), of_12])
}

/// Two triangles, the second so soft that next to the field that attains kappa it has no energy.
fn soft_neighbour() -> Result<Problem, String> {
    let vertices = vec![[-3.0, 0.0], [3.0, 0.0], [0.0, 4.0], [4.0, 4.0]];
    let sides = [("bottom", [0, 1]), ("top", [2, 3])];
    let mesh = mesh(vertices, vec![[0, 1, 2], [1, 3, 2]], sides)?;
    let [hard, soft] = [1.0, 1e-10].map(|mu| Material::lame(mu, mu, Plane::Strain));
    let mut problem = unloaded(mesh, hard, [("top", held([0.0; 2]))]);
    problem.material = Materials::in_parts(hard, 2, [(soft, &[1][..])]);
    Ok(problem)
}

/// With the factor of another matrix the radius is by the bounds at the nodes. Their factor (1 - kappa)^(-1/2) is needed: where
/// kappa is nearly 1 and attained, `by` times the radius is not below the error.
fn crude_radius(by: f64) -> Outcome {
    let [radius, of_12] = attained(soft_neighbour()?, Degree::One, 1.0 - 1e-8, 1e6)?;
    if !(by * radius >= 1.0 && of_12 <= 1.01) {
        return Err(format!("{} times the error; (12) is attained up to {of_12}", by * radius));
    }
    Ok(format!("{radius:.0} times the error, where 1 - kappa is 1e-8"))
}

/// Both for P1 and P2: at least 1, up to rounding, and at most 1.01. `by` multiplies the radius, `constant` the constant of (12).
fn radii(by: f64, constant: f64) -> Outcome {
    let mut most: [f64; 2] = [0.0; 2];
    for degree in [Degree::One, Degree::Two] {
        for kappa in KAPPAS {
            let [radius, of_12] =
                attained(sharpness::trapezoid(NARROW_TRAPEZOID)?, degree, kappa, 1.0)?;
            for (k, ratio) in [by * radius, of_12 / constant].into_iter().enumerate() {
                // What rounding leaves of the eigenvector, and of sums of a dozen terms.
                if !(ratio >= 1.0 - 1e-10) {
                    let what = ["the radius over the error", "(12)"][k];
                    return Err(format!("kappa = {kappa}: {what} is {ratio}, expected at least 1"));
                }
                most[k] = most[k].max(ratio);
            }
        }
    }
    if most.iter().any(|&ratio| ratio > 1.01) {
        return Err(format!("not attained: {most:?}"));
    }
    Ok(format!(
        "two triangles, P1 and P2: attained up to {:.1e}, {:.1e}",
        most[0] - 1.0,
        most[1] - 1.0
    ))
}

/// The unit of moduli in which reactions are compared.
const MODULUS: f64 = 1e6;

/// Two cells, of which one end of a contact edge is held; the other belongs to the only triangle that is not soft, which is
/// clamped. With gamma of this size contact is as stiff as that.
fn held_beside_contact() -> Result<Problem, String> {
    let vertices = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]].map(|x| x.map(f64::from));
    let sides = [("floor", [0, 1]), ("left", [3, 0]), ("right", [2, 5])];
    let triangles = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    let mesh = mesh(vertices.to_vec(), triangles, sides)?;
    let still = || held([0.0; 2]);
    let conditions = [("floor", floor(-1.0)), ("left", still()), ("right", still())];
    let [hard, soft] =
        [1.0, 1e-3].map(|mu| Material::lame(mu * MODULUS, mu * MODULUS, Plane::Strain));
    let mut problem = unloaded(mesh, soft, conditions);
    problem.material = Materials::in_parts(soft, 4, [(hard, &[2][..])]);
    Ok(problem)
}

/// Where the end of a contact edge that is not held is moved, the reaction at the other one is moved by at most half the width of
/// its interval, and by a fifth of that at least: what contact adds to it is most of both. Widths are counted `by` times.
fn reactions(by: f64) -> Outcome {
    let problem = held_beside_contact()?;
    let method = Method { gamma0: Gamma0::Value(0.5 / MODULUS), ..Method::default() };
    let d = discretize_any(&problem, &method).map_err(text)?;
    let (solved, ..) = solve_discrete(&d, &Settings::default()).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let reaction = |u: &[[f64; 2]]| -> Result<[f64; 2], String> {
        let enclosure = enclosure::enclose(&system, u, None, None).map_err(text)?;
        let [low, high] = enclosure.intervals.reactions["left"][1];
        Ok([(low + high) / 2.0, (high - low) / 2.0])
    };
    let mut moved = solved.u.clone();
    moved[1][1] += 1e-3;
    let ([here, _], [there, width]) = (reaction(&solved.u)?, reaction(&moved)?);
    let share = (here - there).abs() / width;
    if share > by {
        return Err(format!("{share} of the bound is attained, expected at most {by}"));
    }
    if share < 0.2 {
        return Err(format!("only {share} of the bound is attained"));
    }
    Ok(format!("{share:.2} of the bound is attained"))
}

/// A body that three demands hold, and its material.
#[derive(Clone, Debug)]
struct Held {
    cells: [usize; 2],
    moved: u64,
    material: Material<f64>,
    /// An angle, and the seed of the holds.
    turned: f64,
    seed: u64,
}

fn held_bodies() -> impl Strategy<Value = Held> {
    let isotropic = (-0.4_f64..5.0, 0.5_f64..2.0)
        .prop_map(|(lambda, mu)| Material::lame(lambda, mu, Plane::Strain));
    let tensor = draws::tensors().prop_map(|c| Material::tensor(c, None));
    let material = prop_oneof![isotropic, tensor];
    (1..=5_usize, 1..=2_usize, any::<u64>(), material, 0.0_f64..TAU, any::<u64>()).prop_map(
        |(nx, ny, moved, material, turned, seed)| Held {
            cells: [nx, ny],
            moved,
            material,
            turned,
            seed,
        },
    )
}

/// 2 mu' of a material: the least eigenvalue of A on strains (xx, yy, sqrt(2) xy).
fn least(material: &Material<f64>) -> f64 {
    let [a, p, q, b, r, c] = material.stiffness();
    let root = 2.0_f64.sqrt();
    let rows = [[a, p, root * q], [p, b, root * r], [root * q, root * r, 2.0 * c]];
    let matrix = Mat::from_fn(3, 3, |i, j| rows[i][j]);
    matrix.self_adjoint_eigenvalues(Triangle::Lower).map_or(0.0, |values| values[0])
}

/// The largest distance of two vertices.
fn diameter(vertices: [[f64; 2]; 3]) -> f64 {
    let far = |i: usize, j: usize| {
        (vertices[i][0] - vertices[j][0]).hypot(vertices[i][1] - vertices[j][1])
    };
    far(0, 1).max(far(1, 2)).max(far(2, 0))
}

/// k of [7.3] at each node, for a root r: c_T + S_T^{1/2} + R_0.
fn by_the_lemma(mesh: &Mesh, space: &Space, material: &Material<f64>, holds: &[Hold]) -> Vec<f64> {
    let of = |t: usize| mesh.triangles()[t].map(|v| mesh.vertices()[v]);
    let count = mesh.triangles().len();
    let stiffness = least(material) / 2.0;
    let squares: Vec<f64> = (0..count)
        .map(|t| {
            let (h, [a, b, c]) = (diameter(of(t)), of(t));
            let area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0;
            match space.degree() {
                Degree::One => h * h / (2.0 * stiffness * area),
                Degree::Two => {
                    6.0 * h * h / (stiffness * area) * (1.0 + 3.0 * h * h / area).powi(2)
                }
            }
        })
        .collect();
    let range = |c: usize| {
        let values = mesh.vertices().iter().map(|x| x[c]);
        let (low, high) =
            (values.clone().fold(f64::MAX, f64::min), values.fold(f64::MIN, f64::max));
        high - low
    };
    let size = range(0).hypot(range(1));
    let root = holds[0].terms[0].triangle;
    let mut along = vec![f64::INFINITY; count];
    along[root] = 0.0;
    // As many rounds as a path has steps at most.
    for _ in 0..count {
        for t in 0..count {
            for other in 0..count {
                let common: Vec<usize> = mesh.triangles()[t]
                    .into_iter()
                    .filter(|v| mesh.triangles()[other].contains(v))
                    .collect();
                if let [a, b] = common[..] {
                    let [a, b] = [a, b].map(|v| mesh.vertices()[v]);
                    let w = 1.0 + 2.0 * size / (a[0] - b[0]).hypot(a[1] - b[1]);
                    let there = along[t] + 2.0 * w * w * (squares[t] + squares[other]);
                    along[other] = along[other].min(there);
                }
            }
        }
    }
    let up_to = |t: usize| squares[t].sqrt() + along[t].sqrt();
    let origin = of(root)[0];
    let number = |ball: Ball| (ball.lower() + ball.upper()) / 2.0;
    let (mut rows, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for (k, hold) in holds.iter().enumerate() {
        right[k] = hold.most;
        for &Term { triangle, at, along } in &hold.terms {
            let [x, y] = [0, 1].map(|c| number(at[c]) - origin[c]);
            let [p, q] = along.map(number);
            rows[k] = [rows[k][0] + p, rows[k][1] + q, rows[k][2] + (q * x - p * y) / size];
            right[k] += p.hypot(q) * up_to(triangle);
        }
    }
    // Cramer's rule: the columns of the inverse are products of two rows.
    let [first, second, third] = rows.map(Vector3::from);
    let columns = [second.cross(&third), third.cross(&first), first.cross(&second)];
    let determinant = first.dot(&columns[0]).abs();
    let motion = [0, 1, 2]
        .map(|i| (0..3).map(|k| columns[k][i].abs() * right[k]).sum::<f64>() / determinant);
    let of_root = motion[0].hypot(motion[1]) + motion[2];
    let mut nodes = vec![f64::INFINITY; space.nodes().len()];
    for (t, members) in space.elements().enumerate() {
        for &node in members {
            nodes[node] = nodes[node].min(up_to(t) + of_root);
        }
    }
    nodes
}

/// Korn's factors, `by` times them, are those of the lemma, up to the two factors 1.001 that cover rounding.
fn factors(draw: &Held, degree: Degree, by: f64) -> Verdict {
    let [nx, ny] = draw.cells;
    let (width, height) = (2.0 * nx as f64, ny as f64);
    let cells = Rectangle { width, height, nx, ny, diagonal: Diagonal::Left };
    let Ok(mesh) = cells.perturbed(0.2, draw.moved) else { return Verdict::Fails("a mesh") };
    let problem = unloaded(mesh, draw.material, [("bottom", floor(0.0))]);
    let (mesh, space) = (&problem.mesh, Space::new(&problem.mesh, degree));
    let Ok(constraints) = Constraints::new(&problem, &space) else {
        return Verdict::Fails("there are no constraints");
    };
    let mut random = Random::new(draw.seed);
    let unit = [draw.turned.cos(), draw.turned.sin()];
    let first = random.below(mesh.triangles().len());
    let last = (first + mesh.triangles().len() / 2) % mesh.triangles().len();
    let at = |t: usize, i: usize| mesh.vertices()[mesh.triangles()[t][i]];
    let (x, y) = (at(first, 0), at(last, 1));
    let apart = [y[0] - x[0], y[1] - x[1]];
    let far = apart[0].hypot(apart[1]);
    if far < 0.5 {
        return Verdict::Vacuous;
    }
    // Both components at one vertex, and at another what turns around it.
    let across = [-apart[1] / far, apart[0] / far];
    let demands = [(first, x, unit), (first, x, [-unit[1], unit[0]]), (last, y, across)];
    let holds: Vec<Hold> = demands
        .into_iter()
        .map(|(triangle, at, d)| Hold {
            terms: vec![Term { triangle, at: at.map(Ball::point), along: d.map(Ball::point) }],
            most: super::share(&mut random),
        })
        .collect();
    let Some(korn) = Korn::new(&space, &problem.material, &constraints, &holds) else {
        return Verdict::Fails("there are factors");
    };
    let expected = by_the_lemma(mesh, &space, &draw.material, &holds);
    for (found, expected) in korn.nodes.iter().zip(expected) {
        ensure!(by * found >= expected * (1.0 - 1e-9));
        ensure!(by * found <= expected * 1.0025);
    }
    Verdict::Holds(if draw.material.is_isotropic() { "isotropic" } else { "tensor" })
}

fn korns_factors() -> Outcome {
    let classes = ["isotropic", "tensor"];
    let first = draws::hold(100, held_bodies(), &classes, |draw| factors(draw, Degree::One, 1.0))?;
    let second = draws::hold(100, held_bodies(), &classes, |draw| factors(draw, Degree::Two, 1.0))?;
    Ok(format!("P1: {first}; P2: {second}"))
}

/// A body that is pushed down on a round obstacle, and what its certificate is changed by.
#[derive(Clone, Debug)]
struct Pushed {
    cells: [usize; 2],
    diagonal: Diagonal,
    lambda: f64,
    radius: f64,
    /// Where the obstacle's top is, and by how much the body is pushed.
    top: [f64; 2],
    push: [f64; 2],
    load: [f64; 2],
    seed: u64,
}

fn pushed_bodies() -> impl Strategy<Value = Pushed> {
    let lambda = prop::sample::select(&[0.0, 1.0, 4.0]);
    let place = ([0.2_f64..0.8, -0.1_f64..0.0], [-0.05_f64..0.05, -0.5_f64..-0.2]);
    let load = [-0.1_f64..0.1, -0.2_f64..0.1];
    let cells = (1..=3_usize, 1..=2_usize);
    (cells, diagonals(), lambda, 3.0_f64..20.0, place, load, any::<u64>()).prop_map(
        |((nx, ny), diagonal, lambda, radius, (top, push), load, seed)| Pushed {
            cells: [nx, ny],
            diagonal,
            lambda,
            radius,
            top,
            push,
            load,
            seed,
        },
    )
}

impl Pushed {
    fn certificate(&self, degree: Degree) -> Result<Certificate, String> {
        let cells = cells(self.cells, self.diagonal);
        let center = [self.top[0] * cells.width, self.top[1] - self.radius];
        let round = Obstacle::Circle { center, radius: self.radius, side: Side::Outside };
        let value =
            |value: f64| -> SharedFunction { Arc::new(signorini::io::Expression::from(value)) };
        let conditions = [
            ("top", Condition::Displacement(self.push.map(|u| Some(value(u))))),
            ("bottom", Condition::Obstacle("round".into(), round)),
        ];
        let (mesh, material) =
            (cells.mesh().map_err(text)?, Material::lame(self.lambda, 1.0, Plane::Strain));
        let problem = problem(mesh, material, self.load.map(value), conditions);
        let method = Method { degree, ..Method::default() };
        let (solution, _) = solve(&problem, &method, &Settings::default()).map_err(text)?;
        Ok(certify(&problem, &solution).map_err(text)?.certificate)
    }
}

/// The place of a vertex, or of a cut, which is numbered after these.
fn place(certificate: &Certificate, k: usize) -> [f64; 2] {
    let vertices = &certificate.vertices;
    vertices.get(k).copied().unwrap_or_else(|| {
        let cut = certificate.cuts[k - vertices.len()];
        let [a, b] = cut.ends.map(|end| vertices[end]);
        [0, 1].map(|c| a[c] + cut.at * (b[c] - a[c]))
    })
}

/// The direction of contact at both ends of an edge, if it is on Gamma_C.
fn directions(certificate: &Certificate, edge: &Edge) -> Option<[[f64; 2]; 2]> {
    let Role::Contact { along, .. } = edge.role else { return None };
    Some(along.unwrap_or_else(|| {
        let [p, q] = edge.ends.map(|k| place(certificate, k));
        let [x, y] = [q[1] - p[1], p[0] - q[0]];
        [[x, y].map(|c| c / x.hypot(y)); 2]
    }))
}

/// The same certificate with a v that is moved at random where nothing is prescribed: away from the obstacle on Gamma_C.
fn with_another_v(certificate: &Certificate, random: &mut Random, size: f64) -> Certificate {
    let mut away: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for edge in &certificate.edges {
        if let Some(d) = directions(certificate, edge) {
            away.extend(edge.ends.into_iter().zip(d));
        }
    }
    let mut other = certificate.clone();
    let mut step = |d: Option<&[f64; 2]>| {
        let [s, t] = [0, 1].map(|_| size * super::share(random));
        d.map_or([2.0 * s - size, 2.0 * t - size], |d| d.map(|c| -s * c))
    };
    let free = |held: &[Option<f64>; 2]| held.iter().all(Option::is_none);
    for (k, v) in other.displacement.iter_mut().enumerate() {
        if free(&certificate.prescribed[k]) && !certificate.frames.contains_key(&k) {
            let by = step(away.get(&k));
            *v = [v[0] + by[0], v[1] + by[1]];
        }
    }
    if let Some(curved) = &mut other.curved {
        let first = certificate.vertices.len();
        for (i, v) in curved.at_cuts.iter_mut().enumerate() {
            if free(&curved.prescribed[i]) {
                let by = step(away.get(&(first + i)));
                *v = [v[0] + by[0], v[1] + by[1]];
            }
        }
        for (bulge, edge) in curved.bulges.iter_mut().zip(&certificate.edges) {
            if !matches!(edge.role, Role::Held(..) | Role::Supported { .. }) {
                let by = step(directions(certificate, edge).map(|[d, _]| d).as_ref());
                *bulge = [bulge[0] + by[0], bulge[1] + by[1]];
            }
        }
    }
    other
}

/// What is left of a square of the bound by rounding: as in `bounds`, the checker carries imbalances along.
const CLOSE: f64 = 1e-9;

/// Twice J(v), times `share`.
fn twice_the_energy(proof: &Proof, share: f64) -> f64 {
    share * (proof.energy[0] + proof.energy[1])
}

/// The square of the bound less 2 J(v), times `share`, is the same for another v.
fn independent_of_v(draw: &Pushed, degree: Degree, share: f64) -> Verdict {
    let Ok(certificate) = draw.certificate(degree) else {
        return Verdict::Fails("there is a certificate");
    };
    if certificate.pieces.iter().any(|piece| piece.oscillation != 0.0) {
        return Verdict::Fails("loads are of the exact class");
    }
    let mut random = Random::new(draw.seed);
    let other = with_another_v(&certificate, &mut random, 0.1);
    let (Ok(one), Ok(two)) = (certificate.evaluate::<Ball>(), other.evaluate::<Ball>()) else {
        return Verdict::Fails("both are accepted");
    };
    let left = |proof: &Proof| proof.bound * proof.bound - twice_the_energy(proof, share);
    let size = one.bound * one.bound + two.bound * two.bound + two.energy[1].abs();
    ensure!(abs_diff_eq!(left(&one), left(&two), epsilon = CLOSE * size));
    Verdict::Holds(class(&certificate))
}

/// A gap that is larger adds 2 int |tau_n| times that to the square of the bound; `share` of it is expected.
fn raised_by_the_gap(draw: &Pushed, degree: Degree, share_of: f64) -> Verdict {
    let Ok(certificate) = draw.certificate(degree) else {
        return Verdict::Fails("there is a certificate");
    };
    let (mut other, mut random) = (certificate.clone(), Random::new(draw.seed));
    let mut expected = 0.0;
    for (e, edge) in other.edges.iter_mut().enumerate() {
        let Role::Contact { pressure: [p, q], gap, .. } = &mut edge.role else { continue };
        let [a, b] = edge.ends.map(|k| place(&certificate, k));
        let [first, last, between] = [0, 1, 2].map(|_| super::share(&mut random));
        *gap = [gap[0] + first, gap[1] + last];
        let mut integral = (2.0 * *p * first + *p * last + *q * first + 2.0 * *q * last) / 6.0;
        if let Some(curved) = &mut other.curved {
            curved.data[e][0] += between;
            integral += (*p + *q) * between / 3.0;
        }
        expected -= 2.0 * (a[0] - b[0]).hypot(a[1] - b[1]) * integral;
    }
    let (Ok(one), Ok(two)) = (certificate.evaluate::<Ball>(), other.evaluate::<Ball>()) else {
        return Verdict::Fails("both are accepted");
    };
    let [before, after] = [one.bound * one.bound, two.bound * two.bound];
    ensure!(abs_diff_eq!(after - before, share_of * expected, epsilon = CLOSE * (before + after)));
    Verdict::Holds(class(&certificate))
}

/// Whether there is pressure where the direction of contact turns.
fn class(certificate: &Certificate) -> &'static str {
    let turns = certificate.edges.iter().any(|edge| match edge.role {
        Role::Contact { pressure, along: Some([d, e]), .. } => d != e && pressure != [0.0; 2],
        _ => false,
    });
    if turns { "pressed where the direction turns" } else { "not pressed there" }
}

const PRESSED: [&str; 1] = ["pressed where the direction turns"];

fn turning(check: impl Fn(&Pushed, Degree) -> Verdict) -> Outcome {
    let first = draws::hold(40, pushed_bodies(), &PRESSED, |draw| check(draw, Degree::One))?;
    let second = draws::hold(40, pushed_bodies(), &PRESSED, |draw| check(draw, Degree::Two))?;
    Ok(format!("P1: {first}; P2: {second}"))
}

/// A certificate with a triangle, or with a lift, `times` times is refused: neither may count for two.
fn counted_once(draw: &Floor, times: usize) -> Verdict {
    let Ok((_, _, certified)) = draw.certified_with(Degree::One) else {
        return Verdict::Fails("there is a certificate");
    };
    let (mut triangles, mut lifts) = (certified.certificate.clone(), certified.certificate);
    let first = triangles.pieces[0];
    triangles.pieces.extend(vec![first; times - 1]);
    lifts.lifts = vec![Lift { corners: [0, 1, 2], norm: 1.0 }; times];
    for certificate in [triangles, lifts] {
        ensure!(matches!(certificate.evaluate::<Ball>(), Err(Rejection::Wrong { .. })));
    }
    Verdict::Holds("always")
}

checks! {
    the_radius_and_the_constant_of_12_are_attained => radii(1.0, 1.0);
    control_a_radius_a_fiftieth_too_small => noticed(radii(0.98, 1.0));
    control_the_constant_of_12_a_fiftieth_too_large => noticed(radii(1.0, 1.02));
    a_radius_by_bounds_at_nodes_is_no_smaller_than_the_error_next_to_the_limit => crude_radius(1.0);
    control_such_a_radius_times_1_less_kappa => noticed(crude_radius(1e-8));
    contact_moves_reactions_by_no_more_than_is_said => reactions(1.0);
    control_a_fifth_of_what_moves_reactions => noticed(reactions(0.2));
    korns_factors_are_those_of_the_lemma => korns_factors();
    control_korns_factors_a_tenth_too_small => draws::reject(held_bodies(), |draw| factors(draw, Degree::Two, 0.9));
    less_twice_the_energy_the_bound_forgets_v_where_directions_turn => turning(|draw, degree| independent_of_v(draw, degree, 1.0));
    control_less_2_2_times_the_energy => draws::reject(pushed_bodies(), |draw| independent_of_v(draw, Degree::Two, 1.1));
    a_larger_gap_costs_its_work_where_directions_turn => turning(|draw, degree| raised_by_the_gap(draw, degree, 1.0));
    control_a_larger_gap_costs_a_tenth_more => draws::reject(pushed_bodies(), |draw| raised_by_the_gap(draw, Degree::Two, 1.1));
    a_triangle_or_a_lift_counts_once => draws::hold(10, bodies(2), &["always"], |draw| counted_once(draw, 2));
    control_a_triangle_and_a_lift_that_are_there_once => draws::reject(bodies(2), |draw| counted_once(draw, 1));
}
