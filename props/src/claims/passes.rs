//! When the solver's loop of corrections ends, in which arithmetic it looks at what is left, and what its routes do on the way
//! (docs/theory.md, 5.7).
//!
//! - where contact is stiff, next to no energy is a force: the loop goes on until loads, contact and reactions balance;
//! - stresses are those of the differences of the displacement from node to node, and of what doubles can't hold of it;
//! - the condition number that is reported is below the true one, and of its size, in any units;
//! - the routes take the same steps.

use std::collections::BTreeMap;
use std::sync::Arc;

use faer::{Mat, Side};
use signorini::fem::Degree;
use signorini::fem::{Condition, Diagonal, EdgeRule, Problem, Rectangle, SharedFunction};
use signorini::kernel::{Material, Plane};
use signorini::solve::iterate::Iterate;
use signorini::solve::route::{self, RouteName};
use signorini::solve::system::System;
use signorini::solve::times::Times;
use signorini::solve::{Gamma0, Method, Settings, discretize};

use super::honesty::{self, field};
use crate::claim::{Outcome, text};
use crate::proof::sampler::Random;
use crate::{draws, sharpness};

fn constant(value: f64) -> SharedFunction {
    Arc::new(move |_: [f64; 2]| value)
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
    let outcome = honesty::passes(&d, shares, &settings)?.outcome;
    let residual = d.residual(&outcome.u).values;
    let held = d.constraints.values();
    let free = residual
        .iter()
        .zip(held)
        .flat_map(|(r, held)| [0, 1].map(|c| if held[c].is_none() { r[c].abs() } else { 0.0 }));
    let mut forces = sum_of_magnitudes(&d.load);
    for edge in &d.contact {
        let p = edge.p(&outcome.u);
        let moments = EdgeRule::Exact.integrals(&p).gradient;
        forces += edge.length / edge.gamma * moments.iter().map(|g| g.abs()).sum::<f64>();
    }
    Ok(free.sum::<f64>() / forces)
}

/// `most` may be left over, and what doubles leave, `scale` times.
pub(super) fn balanced(most: f64, scale: f64) -> Outcome {
    let falling: Vec<f64> = (0..20).map(|k| FALL.powi(k)).collect();
    let largest = std::cell::Cell::new(0.0_f64);
    let bodies = honesty::on_bodies(|problem, degree| {
        let left = |shares: &[f64]| match degree {
            1 => left_over(Degree::One, problem, shares),
            _ => left_over(Degree::Two, problem, shares),
        };
        let by_definition = left(&falling)?;
        largest.set(largest.get().max(by_definition));
        // What doubles leave of forces that are 1/`SOFT` times as stiff.
        if by_definition <= most + scale * 64.0 * f64::EPSILON / SOFT {
            Ok(())
        } else {
            Err(format!("{by_definition:e} of the forces is left over"))
        }
    })?;
    Ok(format!(
        "{bodies} bodies, P1 and P2, a tolerance of {LOOSE}: at most {:.0e} is left over",
        largest.get()
    ))
}

/// Row 19: loads, contact and reactions balance.
pub fn loads_contact_and_reactions_balance() -> Outcome {
    balanced(BALANCED, 1.0)
}

/// A body without loads whose upper side is moved by `by` in both directions.
fn carried(by: f64) -> Result<Problem, String> {
    let cells = Rectangle { width: 2.0, height: 1.0, nx: 4, ny: 2, diagonal: Diagonal::Right };
    let top = Condition::Displacement([0, 1].map(|_| Some(constant(by))));
    let floor = Condition::Contact { gap: constant(0.0) };
    let conditions = [("top", top), ("bottom", floor)];
    Ok(Problem::new(
        cells.mesh().map_err(text)?,
        Material::lame(1.5, 1.0, Plane::Strain),
        [constant(0.0), constant(0.0)],
        conditions.map(|(name, condition)| (name.to_owned(), condition)).into(),
    ))
}

/// A(u, v) for every basis function, in doubles, of a body that is carried along by `by` and bent by 2^`bits` times a field of
/// whole numbers, next to 2^`bits` times the forces of that field alone.
fn forces_of_differences(degree: Degree, by: f64, bits: i32, share: f64) -> Result<(), String> {
    let size = 2.0_f64.powi(bits);
    let forces = |by: f64, size: f64| -> Result<Vec<[f64; 2]>, String> {
        let problem = carried(by)?;
        let d = discretize(&problem, &Method { degree, ..Method::default() }).map_err(text)?;
        let system = System::new(&d).map_err(text)?;
        let mut random = Random::new(draws::seed());
        let bent = field(d.space.nodes().len(), &mut random).into_iter();
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

pub(super) fn differences(share: f64) -> Outcome {
    for bits in BENDS {
        for by in [0.0, 1.0, 2.0_f64.powi(30)] {
            forces_of_differences(Degree::One, by, bits, share)?;
            forces_of_differences(Degree::Two, by, bits, share)?;
        }
    }
    Ok(format!("P1 and P2, bent by 2^{BENDS:?}, carried along by up to 2^30"))
}

/// A beam on a wall, `cells` times as long as high, that its load bends down onto an obstacle.
fn beam(cells: usize) -> Result<Problem, String> {
    let length = cells as f64;
    let shape =
        Rectangle { width: length, height: 1.0, nx: cells, ny: 1, diagonal: Diagonal::Right };
    let wall = Condition::Displacement([0, 1].map(|_| Some(constant(0.0))));
    // Under its own weight f it would bend by f L^4 / (8 E/12), E/(1 - nu^2) = 8/3: a hundredth of that is free, for one row of
    // P1 triangles is far stiffer than a beam.
    let weight = 1e-3 / length.powi(3);
    let floor = Condition::Contact { gap: constant(weight * length.powi(4) * 4.5 / 8.0 / 100.0) };
    let conditions = BTreeMap::from([("left".to_owned(), wall), ("bottom".to_owned(), floor)]);
    Ok(Problem::new(
        shape.mesh().map_err(text)?,
        Material::lame(1.0, 1.0, Plane::Strain),
        [constant(0.0), constant(-weight)],
        conditions,
    ))
}

/// P at the nodes of the contact edges of a loaded block that is carried along by `by`, downwards onto a floor that is as far
/// away, and pressed by 2^-7: all of them doubles, and P loses `by` / 2^-7 in sums of doubles.
fn pressed(degree: Degree, by: f64) -> Result<Vec<Vec<f64>>, String> {
    let mut problem = carried(by)?;
    problem.body_force = [constant(0.0), constant(-0.01)];
    let down = [0.0, -(by + 2.0_f64.powi(-7))].map(|u| Some(constant(u)));
    problem.conditions.insert("top".to_owned(), Condition::Displacement(down));
    problem.conditions.insert("bottom".to_owned(), Condition::Contact { gap: constant(by) });
    let d = discretize(&problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    [RouteName::Condensed, RouteName::Assembled]
        .into_iter()
        .map(|name| {
            let done = route::by(name, &system, &Settings::default(), &mut Times::default());
            done.map(|done| done.0.p.iter().map(|p| p.head()).collect()).map_err(text)
        })
        .collect()
}

/// `most` apart, relative to the largest P.
pub(super) fn carried_blocks(most: f64) -> Outcome {
    let mut farthest = 0.0_f64;
    for degree in [1, 2] {
        let of = |by| if degree == 1 { pressed(Degree::One, by) } else { pressed(Degree::Two, by) };
        let at_rest = of(0.0)?;
        let largest = at_rest[1].iter().fold(0.0, |m: f64, p| m.max(p.abs()));
        for bits in [10, 20, 30] {
            for (name, p) in ["condensed", "assembled"].iter().zip(of(2.0_f64.powi(bits))?) {
                let pairs = p.iter().zip(&at_rest[1]);
                let off = pairs.map(|(p, q)| (p - q).abs()).fold(0.0, f64::max) / largest;
                if !(off <= most) {
                    return Err(format!("{name}, carried by 2^{bits}: P is off by {off:e}"));
                }
                farthest = farthest.max(off);
            }
        }
    }
    Ok(format!("carried by 2^10 to 2^30, both routes, P1 and P2: P is off by {farthest:.0e}"))
}

/// The residuals of a route at each step.
fn history(system: &System, name: RouteName) -> Result<Vec<f64>, String> {
    let done = route::by(name, system, &Settings::default(), &mut Times::default());
    Ok(done.map_err(text)?.0.residuals)
}

/// A residual this small is near the end, where rounding takes part.
const END: f64 = 1e-7;

/// The condensed route knows the compliance of the body at its edges, by which steps are linearised: it may take this many steps
/// more than the assembled one, which knows a part of it, and mostly takes fewer.
pub(super) const MORE: isize = 2;

/// The condensed route needs no more than `more` steps more than the assembled one; no pass begins far from where the one before
/// has ended; and none goes on for more than two steps after the end. Gives the steps of both.
fn same_steps(degree: Degree, problem: &Problem, more: isize) -> Result<usize, String> {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let assembled = history(&system, RouteName::Assembled)?;
    let condensed = history(&system, RouteName::Condensed)?;
    let before = |h: &[f64]| h.iter().take_while(|r| **r > END).count();
    let [many, few] = [&assembled, &condensed].map(|h| before(h));
    if few as isize > many as isize + more {
        return Err(format!("{few} steps of the condensed route, {many} of the assembled one"));
    }
    let rises = |h: &[f64]| h.iter().skip_while(|r| **r > END).any(|r| *r > END);
    if let Some(h) = [&assembled, &condensed].into_iter().find(|h| rises(h)) {
        return Err(format!("{h:?}: a pass begins far from where the one before has ended"));
    }
    let after = |h: &[f64]| h.iter().rev().take_while(|r| **r <= END).count();
    let long = [&assembled, &condensed].into_iter().find(|h| after(h) > MOST_AFTER);
    if let Some(long) = long {
        return Err(format!("{long:?} goes on after the end"));
    }
    Ok(few + many)
}

/// The step that gets there, the one of the pass after it, and what these leave.
const MOST_AFTER: usize = 4;

pub(super) fn steps(more: isize) -> Outcome {
    let count = std::cell::Cell::new(0);
    let bodies = honesty::on_bodies(|problem, degree| {
        let taken = match degree {
            1 => same_steps(Degree::One, problem, more),
            _ => same_steps(Degree::Two, problem, more),
        };
        count.set(count.get() + taken?);
        Ok(())
    })?;
    Ok(format!("{bodies} bodies, P1 and P2, {} steps", count.get()))
}

/// The condition number by the eigenvalues of the dense matrix, and those that the routes report, of the body with its moduli
/// and loads times 2^`bits`.
fn conditions(degree: Degree, mut problem: Problem, bits: i32) -> Result<(f64, [f64; 2]), String> {
    let by = 2.0_f64.powi(bits);
    problem.material = Material::lame(by, by, Plane::Strain).into();
    problem.body_force = [constant(0.3 * by), constant(-by)];
    let d = discretize(&problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let columns = sharpness::dense(&system.matrix);
    let matrix = Mat::from_fn(columns.len(), columns.len(), |i, j| columns[j][i]);
    let all = matrix.self_adjoint_eigenvalues(Side::Lower).map_err(|e| format!("{e:?}"))?;
    let reported = |name| {
        let done = route::by(name, &system, &Settings::default(), &mut Times::default());
        done.map(|done| done.0.condition).map_err(text)
    };
    let routes = [reported(RouteName::Condensed)?, reported(RouteName::Assembled)?];
    Ok((all[all.len() - 1] / all[0], routes))
}

/// The condition number that is reported, times `scale`, is at least 1 and no larger than the true one, in any units the same.
pub(super) fn condition_is_told(scale: f64) -> Outcome {
    let mut least = f64::INFINITY;
    for cells in [2, 6, 12] {
        let of = |bits| conditions(Degree::One, beam(cells)?, bits);
        let (truth, plain) = of(0)?;
        for bits in [-30, 30] {
            let (_, other) = of(bits)?;
            if other != plain {
                return Err(format!("{plain:?}, and {other:?} with moduli times 2^{bits}"));
            }
        }
        for reported in plain {
            let share = scale * reported / truth;
            if !(reported >= 1.0 && share <= 1.0 + 1e-9) {
                return Err(format!("{reported:e} for {truth:e}"));
            }
            least = least.min(share);
        }
    }
    Ok(format!("3 beams in 3 units, at least {least:.0e} of the true one"))
}
