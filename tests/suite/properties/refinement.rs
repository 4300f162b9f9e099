//! The solver's loop of corrections (`solve::accuracy::refine`): what it says of its result, when it ends, in which arithmetic it
//! looks at what is left, and what its routes do on the way (docs/theory.md, 5.6).
//!
//! The loop asks a route for each correction. Here the route is one whose error is known: it goes to within a given distance of
//! the solution, and from pass to pass takes that down by a given factor, or not at all. So what is reported can be compared with
//! what is true.

use approx::abs_diff_eq;
use faer::Side;
use signorini::contact::{Discretization, EdgeRule};
use signorini::kernel::{Material, Plane};
use signorini::linear::system::{Factored, System};
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Problem, Rectangle};
use signorini::proof::enclosure::Verifier;
use signorini::results::{RouteName, Verdict};
use signorini::solve::Times;
use signorini::solve::accuracy::{self, Pass, Route};
use signorini::solve::iterate::{Evaluated, Evaluation, Iterate};
use signorini::solve::newton::Until;
use signorini::solve::route;
use signorini::solve::{Gamma0, Method, Settings, SolveError, discretize, solve_discrete};

use super::bodies::on_bodies;
use super::{Outcome, field, one, properties, text};
use crate::common::{constant, dense, unit_material};

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
    fn factored(&self) -> Option<Factored> {
        None
    }

    fn factorizations(&self) -> usize {
        0
    }

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
            let [start, end] = edge.sigma_n(&field);
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
struct Told {
    /// What it says.
    outcome: accuracy::Outcome,
    residual: f64,
    error: f64,
}

/// The size of the first error, relative to the displacement.
const FIRST: f64 = 0.1;

/// The loop with a route whose error falls as `shares`, until `settings` are met.
fn passes(d: &Discretization, shares: &[f64], settings: &Settings) -> Result<Told, String> {
    let (Evaluated { u, .. }, _, _) = solve_discrete(d, &Settings::default()).map_err(text)?;
    let system = System::new(d).map_err(text)?;
    let target = system.numbering.gather(&u);
    let mut away = d.constraints.lift();
    let mut error = system.numbering.gather(&one(field(u.len()))?);
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
    if !abs_diff_eq!(accuracy::reference(d), forces(d), epsilon = 1e-12 * forces(d)) {
        return Err(format!("reference {}, by definition {}", accuracy::reference(d), forces(d)));
    }
    Ok(Told { residual, error: size(&difference) / size(&outcome.u), outcome })
}

fn told(degree: Degree, problem: &Problem, shares: &[f64]) -> Result<Told, String> {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    passes(&d, shares, &Settings::default())
}

/// The residual that is reported, `scale` times what is reported, is that of (8) by its definition.
fn residual_is_told(scale: f64) -> Outcome {
    on_bodies(|problem, degree| {
        for share in [1.0, 1e-3, 1e-6] {
            let told = told(degree, problem, &[share])?;
            let reported = scale * told.outcome.residual;
            if !abs_diff_eq!(reported, told.residual, epsilon = 1e-6 * told.residual) {
                return Err(format!("{reported:e} reported, {:e} by definition", told.residual));
            }
        }
        Ok(())
    })
}

/// Without a proof the loop ends where the residual of (8) is `factor` times the tolerance or less, and not before.
fn ends(factor: f64) -> Outcome {
    on_bodies(|problem, degree| {
        // By its definition in doubles a residual is known to some 1e-12.
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
            let settings = Settings { tolerance, proof: f64::INFINITY, ..Settings::default() };
            let shares: Vec<f64> = (0..20).map(|k| 0.1_f64.powi(k)).collect();
            let told = passes(&d, &shares, &settings)?;
            told.outcome.status(&settings).map_err(text)?;
            if !(told.residual <= factor * tolerance * (1.0 + 1e-6)) {
                return Err(format!("a residual of {:e}, asked for {tolerance:e}", told.residual));
            }
        }
        Ok(())
    })
}

/// The relative error that is reported is the size of the last correction: `scale` times as much is no less than the error, which
/// falls to less than half from pass to pass, and no more than what the error was before it and is.
fn error_is_told(scale: f64) -> Outcome {
    on_bodies(|problem, degree| {
        let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
        for (fall, tolerance) in [(0.01, 1e-3), (0.1, 1e-6), (0.4, 1e-5)] {
            let settings = Settings { tolerance, proof: f64::INFINITY, ..Settings::default() };
            let shares: Vec<f64> = (0..20).map(|k| f64::powi(fall, k)).collect();
            let Told { outcome, error, .. } = passes(&d, &shares, &settings)?;
            // The correction is relative to the displacement before it, which is up to a fifth smaller.
            let (told, most) = (scale * outcome.forward_error, 1.25 * (1.0 + 1.0 / fall) * error);
            if !(error <= told && told <= most) {
                return Err(format!("{told:e} reported of an error of {error:e}"));
            }
        }
        Ok(())
    })
}

/// From pass to pass the error is multiplied by this.
const FALLS: [f64; 4] = [0.01, 0.1, 0.4, -1.0];

/// The shares of the first error at which passes stay.
const STAYS: [f64; 3] = [1.0, 1e-3, 1e-9];

/// Whether a result is called proved is decided by its enclosure, or, `by_estimate`, by its last correction: what is called so is
/// enclosed as narrowly as asked for, and its error is within the enclosure. Passes take the error down by the factors of
/// `FALLS`, or stay at a distance: then there is nothing that they correct.
fn proved(by_estimate: bool) -> Outcome {
    let settings = Settings::default();
    let (mut proved, mut other) = (0, 0);
    on_bodies(|problem, degree| {
        let falls = FALLS.map(|fall| (0..20).map(|k| f64::powi(fall, k)).collect());
        let stays = STAYS.map(|share| vec![share]);
        for shares in falls.into_iter().chain(stays) {
            let Told { outcome, error, .. } = told(degree, problem, &shares)?;
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
            *if called_proved { &mut proved } else { &mut other } += 1;
        }
        Ok(())
    })?;
    if proved > 0 && other > 0 { Ok(()) } else { Err("all are called the same".to_owned()) }
}

fn sum_of_magnitudes(v: &[[f64; 2]]) -> f64 {
    v.as_flattened().iter().map(|v| v.abs()).sum()
}

/// gamma0 in units of its limit: contact is that much stiffer than the body.
const SOFT: f64 = 1e-4;

/// From pass to pass the error falls like this.
const FALL: f64 = 0.03;

/// What loads, contact and reactions may be out of balance, beside loads and contact.
const BALANCED: f64 = 1e-10;

/// A tolerance that is met long before the forces balance.
const LOOSE: f64 = 1e-2;

/// The forces that are left over at the end of passes with the errors `shares`, beside loads and contact, by the definitions.
fn left_over(degree: Degree, problem: &Problem, shares: &[f64]) -> Result<f64, String> {
    let plain = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let gamma0 = Gamma0::Value(SOFT * plain.coercivity.limit());
    let method = Method { degree, gamma0, ..Method::default() };
    let d = discretize(problem, &method).map_err(text)?;
    let settings = Settings { tolerance: LOOSE, ..Settings::default() };
    let outcome = passes(&d, shares, &settings)?.outcome;
    let residual = d.residual(&outcome.u).values;
    let held = d.constraints.values();
    let free = residual
        .iter()
        .zip(held)
        .flat_map(|(r, held)| [0, 1].map(|c| if held[c].is_none() { r[c].abs() } else { 0.0 }));
    let mut forces = sum_of_magnitudes(&d.load);
    for edge in &d.contact {
        let p = edge.p(&outcome.u);
        let force = edge.contribution(&EdgeRule::Exact, &p).force;
        forces += force.iter().map(|f| f.abs()).sum::<f64>();
    }
    Ok(free.sum::<f64>() / forces)
}

/// `most` may be left over, and what doubles leave of forces that are 1/`SOFT` times as stiff, `scale` times.
fn balanced(most: f64, scale: f64) -> Outcome {
    let falling: Vec<f64> = (0..20).map(|k| FALL.powi(k)).collect();
    on_bodies(|problem, degree| {
        let left = left_over(degree, problem, &falling)?;
        if left <= most + scale * 64.0 * f64::EPSILON / SOFT {
            Ok(())
        } else {
            Err(format!("{left:e} of the forces is left over"))
        }
    })
}

/// A body without loads whose upper side is moved by `by` in both directions.
fn carried(by: f64) -> Result<Problem, String> {
    let cells = Rectangle { width: 2.0, height: 1.0, nx: 4, ny: 2, diagonal: Diagonal::Right };
    let top = Condition::Displacement([0, 1].map(|_| Some(constant(by))));
    let floor = Condition::contact(|_| 0.0);
    Ok(Problem::of(cells.mesh().map_err(text)?, Material::lame(1.5, 1.0, Plane::Strain))
        .with("top", top)
        .with("bottom", floor))
}

/// A(u, v) for every basis function, in doubles, of a body that is carried along by `by` and bent by 2^`bits` times a field of
/// whole numbers, next to 2^`bits` times the forces of that field alone.
fn forces_of_differences(degree: Degree, by: f64, bits: i32, share: f64) -> Result<(), String> {
    let size = 2.0_f64.powi(bits);
    let forces = |by: f64, size: f64| -> Result<Vec<[f64; 2]>, String> {
        let problem = carried(by)?;
        let d = discretize(&problem, &Method { degree, ..Method::default() }).map_err(text)?;
        let system = System::new(&d).map_err(text)?;
        let bent = one(field(d.space.nodes().len()))?.into_iter();
        let bent: Vec<[f64; 2]> = bent.map(|v| v.map(|v| size * (1000.0 * v).round())).collect();
        let whole = vec![[by; 2]; bent.len()];
        let mut iterate = Iterate::lift(&d);
        iterate.add(&system, 1.0, &system.numbering.gather(&whole));
        iterate.add(&system, 1.0, &system.numbering.gather(&bent));
        Ok(iterate.evaluate(&system, false).forces)
    };
    let (alone, carried) = (forces(0.0, 1.0)?, forces(by, size)?);
    let largest = alone.as_flattened().iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    let pairs = alone.as_flattened().iter().zip(carried.as_flattened());
    let off = pairs.map(|(a, b)| (a - share * b / size).abs()).fold(0.0, f64::max) / largest;
    // Differences of whole numbers times powers of two are exact; so is all that follows, but for a power of two.
    if off <= 1e-15 {
        Ok(())
    } else {
        Err(format!("carried along by {by:e}, bent by 2^{bits}: forces are off by {off:e}"))
    }
}

/// Powers of two: within doubles beside 2^30, and far below.
const BENDS: [i32; 4] = [0, -10, -20, -60];

fn differences(share: f64) -> Outcome {
    for bits in BENDS {
        for by in [0.0, 1.0, 2.0_f64.powi(30)] {
            forces_of_differences(Degree::One, by, bits, share)?;
            forces_of_differences(Degree::Two, by, bits, share)?;
        }
    }
    Ok(())
}

/// P at the nodes of the contact edges of a loaded block that is carried along by `by`, downwards onto a floor that is as far
/// away, and pressed by 2^-7: all of them doubles, and P loses `by` / 2^-7 in sums of doubles.
fn pressed(degree: Degree, by: f64) -> Result<Vec<Vec<f64>>, String> {
    let mut problem = carried(by)?;
    problem.body_force = [constant(0.0), constant(-0.01)];
    let down = [0.0, -(by + 2.0_f64.powi(-7))].map(|u| Some(constant(u)));
    problem.conditions.insert("top".to_owned(), Condition::Displacement(down));
    problem.conditions.insert("bottom".to_owned(), Condition::contact(move |_| by));
    let d = discretize(&problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    [RouteName::Condensed, RouteName::Assembled]
        .into_iter()
        .map(|name| {
            let done = route::by(name, &system, &Settings::default(), &mut Times::default());
            done.map(|done| done.p.iter().map(|p| p.head()).collect()).map_err(text)
        })
        .collect()
}

/// `most` apart, relative to the largest P.
fn carried_blocks(most: f64) -> Outcome {
    for degree in [Degree::One, Degree::Two] {
        let at_rest = pressed(degree, 0.0)?.swap_remove(1);
        let largest = at_rest.iter().fold(0.0, |m: f64, p| m.max(p.abs()));
        for bits in [10, 20, 30] {
            for (route, p) in pressed(degree, 2.0_f64.powi(bits))?.iter().enumerate() {
                let pairs = p.iter().zip(&at_rest);
                let off = pairs.map(|(p, q)| (p - q).abs()).fold(0.0, f64::max) / largest;
                if !(off <= most) {
                    return Err(format!("route {route}, carried by 2^{bits}: P is off by {off:e}"));
                }
            }
        }
    }
    Ok(())
}

/// The residuals of a route at each step.
fn history(system: &System, name: RouteName) -> Result<Vec<f64>, String> {
    let done = route::by(name, system, &Settings::default(), &mut Times::default());
    Ok(done.map_err(text)?.residuals)
}

/// A residual this small is near the end, where rounding takes part.
const END: f64 = 1e-7;

/// The condensed route knows the compliance of the body at its edges, by which steps are linearised: it may take this many steps
/// more than the assembled one, which knows a part of it, and mostly takes fewer.
const MORE: isize = 2;

/// The step that gets there, the one of the pass after it, and what these leave.
const MOST_AFTER: usize = 4;

/// The condensed route needs no more than `more` steps more than the assembled one; no pass begins far from where the one before
/// has ended; and none goes on for long after the end.
fn steps(more: isize) -> Outcome {
    on_bodies(|problem, degree| {
        let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
        let system = System::new(&d).map_err(text)?;
        let assembled = history(&system, RouteName::Assembled)?;
        let condensed = history(&system, RouteName::Condensed)?;
        let before = |h: &[f64]| h.iter().take_while(|r| **r > END).count();
        let [many, few] = [&assembled, &condensed].map(|h| before(h));
        if few as isize > many as isize + more {
            return Err(format!("{few} steps of the condensed route, {many} of the assembled one"));
        }
        for h in [assembled, condensed] {
            if h.iter().skip_while(|r| **r > END).any(|r| *r > END) {
                return Err(format!("{h:?}: a pass begins far from where one has ended"));
            }
            if h.iter().rev().take_while(|r| **r <= END).count() > MOST_AFTER {
                return Err(format!("{h:?} goes on after the end"));
            }
        }
        Ok(())
    })
}

/// A beam on a wall, `cells` times as long as high, that its load bends down onto an obstacle.
fn beam(cells: usize) -> Result<Problem, String> {
    let length = cells as f64;
    let shape =
        Rectangle { width: length, height: 1.0, nx: cells, ny: 1, diagonal: Diagonal::Right };
    // Under its own weight f it would bend by f L^4 / (8 E/12), E/(1 - nu^2) = 8/3: a hundredth of that is free, for one row of
    // P1 triangles is far stiffer than a beam.
    let weight = 1e-3 / length.powi(3);
    let floor = Condition::contact(move |_| weight * length.powi(4) * 4.5 / 8.0 / 100.0);
    Ok(Problem::of(shape.mesh().map_err(text)?, unit_material())
        .with_body_force(|_| 0.0, move |_| -weight)
        .with("left", Condition::clamped())
        .with("bottom", floor))
}

/// The condition number by the eigenvalues of the dense matrix, and those that the routes report, of the body with its moduli
/// and loads times 2^`bits`.
fn conditions_of(mut problem: Problem, bits: i32) -> Result<(f64, [f64; 2]), String> {
    let by = 2.0_f64.powi(bits);
    problem.material = Material::lame(by, by, Plane::Strain).into();
    problem.body_force = [constant(0.3 * by), constant(-by)];
    let method = Method { degree: Degree::One, ..Method::default() };
    let d = discretize(&problem, &method).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let matrix = dense(&system.matrix);
    let all = matrix.self_adjoint_eigenvalues(Side::Lower).map_err(|e| format!("{e:?}"))?;
    let reported = |name| {
        let done = route::by(name, &system, &Settings::default(), &mut Times::default());
        done.map(|done| done.condition).map_err(text)
    };
    let routes = [reported(RouteName::Condensed)?, reported(RouteName::Assembled)?];
    Ok((all[all.len() - 1] / all[0], routes))
}

/// The condition number that is reported, times `scale`, is at least 1 and no larger than the true one, in any units the same.
fn condition_is_told(scale: f64) -> Outcome {
    for cells in [2, 6, 12] {
        let (truth, plain) = conditions_of(beam(cells)?, 0)?;
        for bits in [-30, 30] {
            let (_, other) = conditions_of(beam(cells)?, bits)?;
            if other != plain {
                return Err(format!("{plain:?}, and {other:?} with moduli times 2^{bits}"));
            }
        }
        for reported in plain {
            if !(reported >= 1.0 && scale * reported <= (1.0 + 1e-9) * truth) {
                return Err(format!("{reported:e} for {truth:e}"));
            }
        }
    }
    Ok(())
}

properties! {
    the_residual_of_the_verdict_is_that_of_8_relative_to_the_forces: residual_is_told(1.0);
        not residual_is_told(0.9);
    the_error_that_is_reported_is_the_last_correction: error_is_told(1.0); not error_is_told(1e-6);
    a_solve_without_a_proof_ends_at_its_tolerance: ends(1.0); not ends(1e-16);
    nothing_is_proved_that_is_further_away_than_asked_for: proved(false); not proved(true);
    loads_contact_and_reactions_balance: balanced(BALANCED, 1.0); not balanced(0.0, 0.0);
    stresses_are_those_of_differences_between_nodes: differences(1.0); not differences(1.0 + 16.0 * f64::EPSILON);
    what_doubles_blur_is_evaluated_in_double_doubles: carried_blocks(1e-9); not carried_blocks(1e-18);
    the_routes_take_the_same_steps_or_fewer: steps(MORE); not steps(-4);
    the_condition_number_is_told_from_below: condition_is_told(1.0); not condition_is_told(100.0);
}
