//! What the solver says of its own result: the residual, what is proved of it, and with what rounding stresses come;
//! the von Mises stress and the largest displacement.
//!
//! The solver's loop of corrections (`solve::accuracy::refine`) asks a route for each of them. Here the route is one whose
//! error is known: it goes to within a given distance of the solution, and from pass to pass takes that down by a given factor,
//! or not at all. So what the loop reports can be compared with what is true.

use std::collections::BTreeMap;
use std::sync::Arc;

use signorini::fem::ContactFace;
use signorini::fem::Degree;
use signorini::fem::ball::Ball;
use signorini::fem::element::value_at;
use signorini::fem::matrix::{self, Neighbours};
use signorini::fem::{Condition, Discretization, Problem, SharedFunction};
use signorini::fem::{residual, rounded_stress};
use signorini::kernel::{Material, Plane};
use signorini::solve::accuracy::{self, Pass, Route};
use signorini::solve::enclosure::Verifier;
use signorini::solve::evaluated::Evaluated;
use signorini::solve::factor::Factor;
use signorini::solve::iterate::{Evaluation, Iterate};
use signorini::solve::newton::Until;
use signorini::solve::system::System;
use signorini::solve::{
    ContactBoundary, EnergyBalance, Method, Settings, Solution, SolveError, Verdict, discretize,
    solve_discrete,
};

use super::assembled::solver::unsolved;
use crate::claim::{Outcome, noticed, text};
use crate::proof::sampler::Random;
use crate::{draws, sharpness};

fn constant(value: f64) -> SharedFunction {
    Arc::new(move |_: [f64; 2]| value)
}

/// The small bodies of row 9 under a load and a displacement of their upper side, half of them pressed on their obstacle.
fn loaded_bodies() -> Result<Vec<(String, Problem)>, String> {
    let mut bodies = Vec::new();
    for (i, body) in sharpness::small_bodies()?.into_iter().enumerate() {
        let mut problem = body.problem;
        let down = if i % 2 == 0 { -1.0 } else { 1.0 };
        problem.body_force = [constant(0.3), constant(down)];
        let moved = [Some(constant(0.05)), Some(constant(0.1 * down))];
        let displacement = |name: &str| name == "top" || name == "right";
        let sides: Vec<String> =
            problem.conditions.keys().filter(|name| displacement(name)).cloned().collect();
        let held = BTreeMap::from([(sides[0].clone(), Condition::Displacement(moved))]);
        // One side is moved: two that meet would have to agree.
        problem.conditions.retain(|name, _| !displacement(name));
        problem.conditions.extend(held);
        let gap: SharedFunction = Arc::new(|[x, _]: [f64; 2]| 0.02 + 0.01 * x);
        problem.conditions.insert("bottom".to_owned(), Condition::Contact { gap });
        bodies.push((body.name, problem));
    }
    Ok(bodies)
}

/// Numbers between -1 and 1.
pub(super) fn field(nodes: usize, random: &mut Random) -> Vec<[f64; 2]> {
    (0..nodes).map(|_| [0, 1].map(|_| random.below(2001) as f64 / 1000.0 - 1.0)).collect()
}

/// The squared norm of a functional where no component is prescribed.
fn free_square(d: &Discretization, functional: &[[f64; 2]]) -> f64 {
    let mut sum = 0.0;
    for (node, f) in functional.iter().enumerate() {
        for c in 0..2 {
            if d.constraints.values()[node][c].is_none() {
                sum += f[c] * f[c];
            }
        }
    }
    sum
}

/// What the residual is relative to, by its definition: |L| + |R(lift) + L|.
fn forces(d: &Discretization) -> f64 {
    let lift = d.residual(&d.constraints.lift()).values;
    let sum: Vec<[f64; 2]> =
        lift.iter().zip(&d.load).map(|(r, l)| [r[0] + l[0], r[1] + l[1]]).collect();
    free_square(d, &d.load).sqrt() + free_square(d, &sum).sqrt()
}

/// A route that is `shares[k]` times `error` away from `target` after pass k, and as far as after the last from then on.
struct Known<'s, 'd, 'p> {
    system: &'s System<'d, 'p>,
    /// Over the free degrees of freedom, as the next two.
    target: Vec<f64>,
    error: Vec<f64>,
    shares: Vec<f64>,
    passes: usize,
}

impl Route for Known<'_, '_, '_> {
    fn pass(
        &mut self,
        iterate: &mut Iterate,
        at: &mut Evaluation,
        residuals: &mut Vec<f64>,
        _: Until,
    ) -> Result<Pass, SolveError> {
        let last = self.shares.len() - 1;
        let share = self.shares[self.passes.min(last)];
        let here = self.system.numbering.gather(&iterate.rounded());
        let goal = self.target.iter().zip(&self.error).map(|(u, e)| u + share * e);
        let step: Vec<f64> = goal.zip(&here).map(|(goal, u)| goal - u).collect();
        residuals.push(1.0);
        let d = self.system.d;
        let mut field = vec![[0.0; 2]; d.space.nodes().len()];
        self.system.numbering.scatter(&step, &mut field);
        // A(v, v) = a(v, v) - int gamma sigma_n(v)^2.
        let mut energy = d.strain_energy(&field);
        for edge in &d.contact {
            let [start, end] = edge.sigma_n(|node| field[node]);
            let square = (start * start + start * end + end * end) / 3.0;
            energy -= edge.gamma * edge.length * square;
        }
        self.passes += 1;
        iterate.add(self.system, 1.0, &step);
        *at = iterate.evaluate(self.system, at.precisely);
        Ok(Pass { energy, left: 0.0, softness: 0.0 })
    }
}

/// What the loop says of a route whose error falls as `shares`, and what is true: the relative residual by its definition, and
/// the error in the energy norm, relative to the displacement.
pub(super) struct Told {
    /// What it says.
    pub(super) outcome: accuracy::Outcome,
    residual: f64,
    error: f64,
}

/// The size of the first error, relative to the displacement.
const FIRST: f64 = 0.1;

fn told(degree: Degree, problem: &Problem, shares: &[f64]) -> Result<Told, String> {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    passes(&d, shares, &Settings::default())
}

/// The same on a discretization, until `settings` are met.
pub(super) fn passes(
    d: &Discretization,
    shares: &[f64],
    settings: &Settings,
) -> Result<Told, String> {
    let (Evaluated { u, .. }, _, _) = solve_discrete(d, &Settings::default()).map_err(text)?;
    let system = System::new(d).map_err(text)?;
    let mut random = Random::new(draws::seed());
    let target = system.numbering.gather(&u);
    let mut away = d.constraints.lift();
    let mut error = system.numbering.gather(&field(u.len(), &mut random));
    let size = |field: &[[f64; 2]]| d.strain_energy(field).sqrt();
    let spread = |values: &[f64], lift: &mut [[f64; 2]]| system.numbering.scatter(values, lift);
    let mut only = vec![[0.0; 2]; u.len()];
    spread(&error, &mut only);
    let scale = FIRST * size(&u) / size(&only);
    error.iter_mut().for_each(|e| *e *= scale);
    let mut route = Known { system: &system, target, error, shares: shares.to_vec(), passes: 0 };
    let mut verifier = Verifier::new(&system, None);
    let outcome = accuracy::refine(&system, &mut route, &mut verifier, forces(d), settings);
    let outcome = outcome.map_err(text)?;
    away.copy_from_slice(&outcome.u);
    let difference: Vec<[f64; 2]> =
        away.iter().zip(&u).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect();
    let residual = free_square(d, &d.residual(&outcome.u).values).sqrt() / forces(d);
    if !((accuracy::reference(d) - forces(d)).abs() <= 1e-12 * forces(d)) {
        return Err(format!("reference {}, by definition {}", accuracy::reference(d), forces(d)));
    }
    Ok(Told { residual, error: size(&difference) / size(&outcome.u), outcome })
}

pub(super) fn on_bodies(
    check: impl Fn(&Problem, usize) -> Result<(), String>,
) -> Result<usize, String> {
    let bodies = loaded_bodies()?;
    for (name, problem) in &bodies {
        for degree in [1, 2] {
            check(problem, degree).map_err(|why| format!("{name}, P{degree}: {why}"))?;
        }
    }
    Ok(bodies.len())
}

fn told_of(problem: &Problem, degree: usize, shares: &[f64]) -> Result<Told, String> {
    if degree == 1 {
        told(Degree::One, problem, shares)
    } else {
        told(Degree::Two, problem, shares)
    }
}

/// The residual that is reported, `scale` times what is reported, is that of (8) by its definition.
pub(super) fn residual_is_told(scale: f64) -> Outcome {
    let bodies = on_bodies(|problem, degree| {
        for share in [1.0, 1e-3, 1e-6] {
            let told = told_of(problem, degree, &[share])?;
            let reported = scale * told.outcome.residual;
            if !((reported - told.residual).abs() <= 1e-6 * told.residual) {
                return Err(format!("{reported:e} reported, {:e} by definition", told.residual));
            }
        }
        Ok(())
    })?;
    Ok(format!("{bodies} bodies, P1 and P2, at three distances from the solution"))
}

/// Whether a result is called proved is decided by its enclosure, or, `by_estimate`, by its last correction: what is called so is
/// enclosed as narrowly as asked for, and its error is within the enclosure. Passes take the error down by the factors of
/// `FALLS`, or stay at a distance: then there is nothing that they correct.
pub(super) fn proved(by_estimate: bool) -> Outcome {
    let settings = Settings::default();
    let (proved, other) = (std::cell::Cell::new(0), std::cell::Cell::new(0));
    let bodies = on_bodies(|problem, degree| {
        let falls = FALLS.map(|fall| (0..20).map(|k| f64::powi(fall, k)).collect());
        let stays = STAYS.map(|share| vec![share]);
        for shares in falls.into_iter().chain(stays) {
            let Told { outcome, error, .. } = told_of(problem, degree, &shares)?;
            let called_proved = if by_estimate {
                outcome.forward_error <= settings.proof
            } else {
                Verdict::new(&outcome.enclosure, settings.proof) == Verdict::Proved
            };
            let radius = outcome.radius();
            if called_proved && !(radius <= settings.proof) {
                return Err(format!("proved with an enclosure of {radius:e}"));
            }
            // What doubles leave of the solution that errors are measured from.
            if !(error <= radius + 1e-13) {
                return Err(format!("an error of {error:e} in an enclosure of {radius:e}"));
            }
            let count = if called_proved { &proved } else { &other };
            count.set(count.get() + 1);
        }
        Ok(())
    })?;
    match (proved.get(), other.get()) {
        (0, _) | (_, 0) => Err("all are called the same".to_owned()),
        (proved, other) => {
            Ok(format!("{bodies} bodies, P1 and P2: {proved} proved, {other} not proved"))
        }
    }
}

/// From pass to pass the error is multiplied by this.
const FALLS: [f64; 4] = [0.01, 0.1, 0.4, -1.0];

/// The shares of the first error at which passes stay.
const STAYS: [f64; 3] = [1.0, 1e-3, 1e-9];

/// a(u, v) by stresses in doubles, for a random u that is carried along by `by`, less a(u, v) in balls: its norm dual to |v|_a on
/// the v that are free, beside the bound.
fn rounding_of_stresses(degree: Degree, problem: &Problem, by: f64) -> Result<f64, String> {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let mut random = Random::new(draws::seed());
    let nodes = d.space.nodes().len();
    let [heads, tails] = [0, 1].map(|_| field(nodes, &mut random));
    let small = 2.0_f64.powi(-54);
    let u: Vec<[Ball; 2]> = (0..nodes)
        .map(|i| [0, 1].map(|c| Ball::from(by + heads[i][c]) + Ball::from(small * tails[i][c])))
        .map(|u| u.map(Ball::centre))
        .collect();
    let mut sums = [vec![[Ball::from(0); 2]; nodes], vec![[Ball::from(0); 2]; nodes]];
    let bound = rounded_stress::add_forces(&d, &u, &mut sums[0]);
    residual::add_internal_forces(&d.space, &problem.material, &u, &mut sums[1]);
    let off: Vec<[f64; 2]> =
        (0..nodes).map(|i| [0, 1].map(|c| (sums[0][i][c] - sums[1][i][c]).head())).collect();
    let off = system.numbering.gather(&off);
    let neighbours = Neighbours::new(&d.space);
    let stiffness = matrix::assemble_stiffness(&d, &system.numbering, &neighbours);
    let factor = Factor::new(&stiffness).map_err(text)?;
    let mut half = off;
    factor.forward(&mut half);
    Ok(half.iter().map(|x| x * x).sum::<f64>().sqrt() / bound)
}

/// The rounding of stresses is at most `scale` times its bound.
pub(super) fn stresses_are_off(scale: f64) -> Outcome {
    let most = std::cell::Cell::new(0.0_f64);
    let bodies = on_bodies(|problem, degree| {
        for by in [0.0, 1.0, 1e6] {
            let share = match degree {
                1 => rounding_of_stresses(Degree::One, problem, by)?,
                _ => rounding_of_stresses(Degree::Two, problem, by)?,
            };
            most.set(most.get().max(share));
            if !(share <= scale) {
                return Err(format!("carried by {by}: off by {share:e} of the bound"));
            }
        }
        Ok(())
    })?;
    Ok(format!("{bodies} bodies, P1 and P2: off by at most {:.0e} of the bound", most.get()))
}

/// The von Mises stress of a mean stress by its principal stresses, sigma_zz from Hooke's law; `plane` may be a mistake.
fn von_mises(material: &Material<f64>, plane: Plane, [xx, yy, xy]: [f64; 3]) -> f64 {
    let (middle, radius) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    let nu = material.lambda() / (2.0 * (material.lambda() + material.mu()));
    let zz = if plane == Plane::Strain { nu * (xx + yy) } else { 0.0 };
    let principal = [middle + radius, middle - radius, zz];
    let [a, b, c] = [0, 1, 2].map(|i| principal[i] - principal[(i + 1) % 3]);
    ((a * a + b * b + c * c) / 2.0).sqrt()
}

fn stresses_on(degree: Degree, problem: &Problem, plane: Option<Plane>) -> Result<(), String> {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let mut random = Random::new(draws::seed());
    let u = field(d.space.nodes().len(), &mut random);
    let solution = Solution::new(&d, Evaluated::new(&d, u.clone()), unsolved());
    let near = |found: f64, expected: f64| (found - expected).abs() <= 1e-13 * expected;
    for (t, (stress, zz)) in solution.stress.iter().enumerate() {
        let material = problem.material.of(t);
        // Plane stress has no stress across the plane, plane strain has one.
        let own = if *zz == 0.0 { Plane::Stress } else { Plane::Strain };
        let plane = plane.unwrap_or(own);
        let expected = von_mises(material, plane, stress.components());
        if !near(solution.von_mises[t], expected) {
            return Err(format!("von Mises {:e}, expected {expected:e}", solution.von_mises[t]));
        }
    }
    let strain = (0..solution.stress.len()).map(|t| mean_strain(&d, t, &u)).fold(0.0, f64::max);
    if !((solution.largest_strain - strain).abs() <= 1e-12 * strain) {
        return Err(format!("largest strain {}, expected {strain}", solution.largest_strain));
    }
    let points = solution.contact.iter().flat_map(|edge| &edge.points);
    let deepest = points.map(|point| point.u_n - point.gap).fold(f64::NEG_INFINITY, f64::max);
    let told = solution.boundaries.iter().map(|part| part.penetration);
    let told = told.fold(f64::NEG_INFINITY, f64::max);
    // Affine between the nodes, for P1.
    if !(told >= deepest && (degree == Degree::Two || told == deepest)) {
        return Err(format!("a penetration of {told:e}, at the nodes {deepest:e}"));
    }
    for part in &solution.boundaries {
        // The recovered pressure has the integral of -lambda^h, by its hat functions.
        let edges = solution.contact.iter().filter(|edge| *edge.boundary == *part.boundary);
        let force: f64 = edges
            .map(|edge| {
                let p: Vec<f64> = edge.points.iter().map(|point| point.pressure).collect();
                let length = edge.points[p.len() - 1].arc - edge.points[0].arc;
                let mean = p.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).sum::<f64>();
                length * mean / (p.len() - 1) as f64
            })
            .sum();
        if !((force - part.force).abs() <= 1e-12 * part.force) {
            return Err(format!("a recovered force of {force:e}, a force of {:e}", part.force));
        }
    }
    for part in &solution.boundaries {
        // Where P > 0, counted at 1000 places of each edge: of two roots each costs one of them.
        let lines = d.contact.iter().filter(|line| *line.boundary == *part.boundary);
        let [counted, whole] = lines.fold([0.0; 2], |[counted, whole], line| {
            let p = line.p(&u);
            let places = (0..1000).map(|k| (f64::from(k) + 0.5) / 1000.0);
            let pressed = places.filter(|&s| value_at(&p, s) > 0.0).count();
            [counted + line.length * pressed as f64 / 1000.0, whole + line.length]
        });
        if !((counted - part.length).abs() <= 2e-3 * whole) {
            return Err(format!("a contact length of {}, counted {counted}", part.length));
        }
    }
    // Pressed on all edges, too, where a stretch goes on from one to the next.
    let down: Vec<[f64; 2]> = u.iter().map(|[x, y]| [*x, y - 1e3]).collect();
    for u in [&u, &down] {
        let solution = Solution::new(&d, Evaluated::new(&d, u.clone()), unsolved());
        for part in &solution.boundaries {
            stretches_are_those_of_contact(&d, u, &solution, part)?;
        }
    }
    let EnergyBalance { strain, loads, supports, contact, imbalance, .. } = solution.balance;
    let largest = [strain, loads, supports, contact].map(f64::abs).into_iter().fold(0.0, f64::max);
    let expected = (strain - loads - supports - contact) / largest;
    if !((imbalance - expected).abs() <= 1e-13) {
        return Err(format!("energies out of balance by {imbalance:e}, expected {expected:e}"));
    }
    let squares = u.iter().map(|[x, y]| x * x + y * y);
    let expected = squares.fold(0.0, f64::max).sqrt();
    let found = solution.quantities.max_displacement;
    if near(found, expected) { Ok(()) } else { Err(format!("{found}, expected {expected}")) }
}

/// The stretches of contact, by the arc lengths of their ends: P > 0 inside and not outside, none begins where another ends, and
/// together they are as long as the contact.
fn stretches_are_those_of_contact(
    d: &Discretization,
    u: &[[f64; 2]],
    solution: &Solution,
    part: &ContactBoundary,
) -> Result<(), String> {
    let edges = || {
        let all = d.contact.iter().zip(&solution.contact);
        all.filter(|(line, _)| *line.boundary == *part.boundary)
    };
    let ends =
        |line: &ContactFace| d.space.mesh().ends(line.edge).map(|v| d.space.mesh().vertices()[v]);
    let far = |[a, b]: [f64; 2], [x, y]: [f64; 2]| (a - x).hypot(b - y);
    // Of a place on an edge: where its distances from the ends add up to the length.
    let arc = |x: [f64; 2]| {
        let on = edges().find(|(line, _)| {
            let [a, b] = ends(line);
            far(a, x) + far(x, b) <= (1.0 + 1e-12) * line.length
        });
        on.map(|(line, told)| told.points[0].arc + far(ends(line)[0], x))
            .ok_or(format!("a stretch ends at {x:?}, off the boundary"))
    };
    let mut stretches = Vec::new();
    for &[from, to] in &part.stretches {
        stretches.push([arc(from)?, arc(to)?]);
    }
    let whole: f64 = edges().map(|(line, _)| line.length).sum();
    let together: f64 = stretches.iter().map(|[from, to]| to - from).sum();
    let apart = stretches.windows(2).all(|pair| pair[1][0] > pair[0][1] + 1e-12 * whole);
    if !((together - part.length).abs() <= 1e-12 * whole && apart) {
        return Err(format!("stretches {stretches:?}, {} long", part.length));
    }
    for (line, told) in edges() {
        let p = line.p(u);
        for s in (0..100).map(|k| (f64::from(k) + 0.5) / 100.0) {
            let place = told.points[0].arc + s * line.length;
            let inside = stretches.iter().any(|&[from, to]| from <= place && place <= to);
            let pressed = value_at(&p, s);
            let size = p.iter().map(|p| p.abs()).fold(0.0, f64::max);
            if inside != (pressed > 0.0) && pressed.abs() > 1e-9 * size {
                return Err(format!("P = {pressed:e} at arc length {place}, of {stretches:?}"));
            }
        }
    }
    Ok(())
}

pub(super) fn stresses(plane: Option<Plane>) -> Outcome {
    let bodies = on_bodies(|problem, degree| {
        if degree == 1 {
            stresses_on(Degree::One, problem, plane)
        } else {
            stresses_on(Degree::Two, problem, plane)
        }
    })?;
    Ok(format!("{bodies} bodies, P1 and P2"))
}

/// The largest principal strain, in magnitude, of the mean strain on triangle t, from the boundary: the mean of grad u is
/// the integral of u n^T over the boundary, by Simpson's rule on each edge, by the area.
fn mean_strain(d: &Discretization, t: usize, u: &[[f64; 2]]) -> f64 {
    let corners = d.problem.mesh.triangles()[t].map(|v| d.problem.mesh.vertices()[v]);
    let nodes = d.space.nodes_of(t);
    let [a, b, c] = corners;
    let double_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let mut gradient = [[0.0; 2]; 2];
    for i in 0..3 {
        let (start, end) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
        let normal = [end[1] - start[1], start[0] - end[0]];
        let [from, to] = [u[nodes[(i + 1) % 3]], u[nodes[(i + 2) % 3]]];
        for k in 0..2 {
            let mean = if d.space.degree() == Degree::Two {
                (from[k] + 4.0 * u[nodes[3 + i]][k] + to[k]) / 6.0
            } else {
                (from[k] + to[k]) / 2.0
            };
            for j in 0..2 {
                gradient[k][j] += mean * normal[j] / (double_area / 2.0);
            }
        }
    }
    let [[xx, xy], [yx, yy]] = gradient;
    let (middle, shear) = ((xx + yy) / 2.0, (xy + yx) / 2.0);
    middle.abs() + ((xx - yy) / 2.0).hypot(shear)
}

/// Plane strain without the stress across the plane.
pub fn von_mises_without_sigma_zz() -> Outcome {
    noticed(stresses(Some(Plane::Stress)))
}

/// The magnitudes that come with a functional, times `scale`: those of a(u, .) are at least sum_j |a(N_j, N_i)| |u_j|, and at
/// most `COARSE` times that; and each part that is added, loads, stress product and contact, adds at least its size.
fn magnitudes_on(degree: Degree, problem: &Problem, scale: f64) -> Result<f64, String> {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let nodes = d.space.nodes().len();
    let mut random = Random::new(draws::seed());
    let u = field(nodes, &mut random);
    // Of all basis functions, one by one: of a sum of them the magnitudes are no larger than these.
    let mut least = vec![[0.0; 2]; nodes];
    let mut one_by_one = vec![[0.0; 2]; nodes];
    for j in 0..nodes {
        for c in 0..2 {
            let mut bump = vec![[0.0; 2]; nodes];
            bump[j][c] = u[j][c];
            let column = d.internal_forces(&bump);
            for node in 0..nodes {
                for k in 0..2 {
                    least[node][k] += column.values[node][k].abs();
                    one_by_one[node][k] += column.magnitudes[node][k];
                }
            }
        }
    }
    let [inner, linear, whole] = [d.internal_forces(&u), d.linear_residual(&u), d.residual(&u)];
    let mut most: f64 = 0.0;
    for node in 0..nodes {
        for c in 0..2 {
            let sizes = [&inner, &linear, &whole].map(|f| scale * f.magnitudes[node][c]);
            let values = [&inner, &linear, &whole].map(|f| f.values[node][c]);
            let room = 1.0 + 1e-12;
            let ratio = scale * one_by_one[node][c] / least[node][c];
            most = most.max(ratio);
            // Differences of sums that are rounded, each to a roundoff of itself.
            let added = |from: usize, to: usize| {
                let rounding = 8.0 * f64::EPSILON * sizes[to];
                (values[to] - values[from]).abs() <= (sizes[to] - sizes[from]) * room + rounding
            };
            let whole =
                sizes[0] >= scale * values[0].abs() && sizes[0] <= one_by_one[node][c] * room;
            if !(ratio * room >= 1.0 && ratio <= COARSE && whole && added(0, 1) && added(1, 2)) {
                return Err(format!("node {node}: {sizes:?} for {values:?}, a(u, .) {ratio:.2}"));
            }
        }
    }
    Ok(most)
}

/// Products of norms are no larger than this many times the products that were added up.
const COARSE: f64 = 60.0;

pub(super) fn magnitudes(scale: f64) -> Outcome {
    let most = std::cell::Cell::new(0.0_f64);
    let bodies = on_bodies(|problem, degree| {
        let found = if degree == 1 {
            magnitudes_on(Degree::One, problem, scale)
        } else {
            magnitudes_on(Degree::Two, problem, scale)
        };
        most.set(most.get().max(found?));
        Ok(())
    })?;
    Ok(format!("{bodies} bodies, P1 and P2; of a(u, .) at most {:.1} times its terms", most.get()))
}
