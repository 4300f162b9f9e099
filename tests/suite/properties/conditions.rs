//! Conditions that the paper does not have, and what is reported of them: pressures, supports at any angle, bodies that
//! contact alone holds; reactions, resultants, moments and energies; the two routes of the solver; sums of two doubles.
//!
//! A body that is turned with all that acts on it has the turned solution. Where its sides are along the axes, a support is a
//! prescribed component and a pressure a traction, which rows 5 and 6 are about: so they are right at every angle.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;

use approx::abs_diff_eq;
use signorini::contact::residual;
use signorini::kernel::DoubleDouble;
use signorini::kernel::{Material, Plane};
use signorini::linear::system::System;
use signorini::model::Degree;
use signorini::model::{Condition, DataError, Diagonal, Mesh, Problem, Rectangle};
use signorini::results::{RouteName, Solution};
use signorini::solve::Times;
use signorini::solve::iterate::Iterate;
use signorini::solve::{
    ContactQuadrature, Method, Settings, SolveError, check, discretize, route, solve,
    solve_discrete,
};

use super::{Outcome, field, for_all, properties, text};
use crate::common::{DEGREES, case, constant, moved_to, turned};

/// A block of 2 x 1, 4 x 2 cells, turned about the origin.
fn block(angle: f64) -> Result<Mesh, String> {
    let cells = Rectangle { width: 2.0, height: 1.0, nx: 4, ny: 2, diagonal: Diagonal::Right };
    let mesh = cells.mesh().map_err(text)?;
    Ok(moved_to(&mesh, |x| turned(angle, x)))
}

/// Pressed down on an obstacle, on a roller at its left side, under a pressure on its right one.
const DOWN: f64 = -0.03;
const ALONG: f64 = 0.01;
const PRESSURE: f64 = 0.2;
const FORCE: [f64; 2] = [0.1, -0.3];

/// The block turned by an angle. `plain`, for angle 0: with components and tractions in place of supports and pressures.
fn problem(angle: f64, plain: bool) -> Result<Problem, String> {
    let [left, top, right] = if plain {
        [
            Condition::Displacement([Some(constant(-ALONG)), None]),
            Condition::displacement(move |_| -ALONG, |_| DOWN),
            Condition::traction(move |_| -PRESSURE, |_| 0.0),
        ]
    } else {
        [
            // The outward normal is -x.
            Condition::Support { normal: Some(constant(ALONG)), tangential: None },
            // It is y, and turned to the left -x.
            Condition::Support { normal: Some(constant(DOWN)), tangential: Some(constant(ALONG)) },
            Condition::pressure(|_| PRESSURE),
        ]
    };
    let contact = Condition::contact(|_| 0.005);
    let conditions = [("left", left), ("top", top), ("right", right), ("bottom", contact)];
    let conditions = conditions.map(|(name, condition)| (name.to_owned(), condition));
    let force = turned(angle, FORCE).map(constant);
    let material = Material::lame(1.5, 1.0, Plane::Stress);
    Ok(Problem::new(block(angle)?, material, force, BTreeMap::from(conditions)))
}

/// What is reported of a solution under each name, with the vectors turned back by an angle.
fn reported(solution: &Solution, angle: f64) -> Vec<(&'static str, Vec<f64>)> {
    let back = |vectors: Vec<[f64; 2]>| -> Vec<f64> {
        vectors.into_iter().flat_map(|v| turned(-angle, v)).collect()
    };
    let q = &solution.quantities;
    let parts = || solution.boundaries.iter();
    let balance = &solution.balance;
    vec![
        ("displacement", back(solution.displacement.clone())),
        ("reactions", back(q.reactions.values().copied().collect())),
        ("moments of reactions", q.reaction_moments.values().copied().collect()),
        ("contact resultant", back(vec![q.contact_resultant])),
        ("resultants", back(parts().map(|part| part.resultant).collect())),
        ("moments of contact", parts().map(|part| part.moment).collect()),
        ("forces of contact", parts().map(|part| part.force).collect()),
        ("lengths of contact", parts().map(|part| part.length).collect()),
        ("stretches", back(parts().flat_map(|p| p.stretches.as_flattened().to_vec()).collect())),
        ("peaks", parts().map(|part| part.peak_pressure).collect()),
        ("places of peaks", back(parts().map(|part| part.peak_at).collect())),
        ("penetrations", parts().map(|part| part.penetration).collect()),
        ("von Mises stresses", solution.von_mises.clone()),
        ("largest strain", vec![solution.largest_strain]),
        ("energies", vec![balance.strain, balance.loads, balance.supports, balance.contact]),
        ("kappa", vec![solution.gamma.kappa]),
    ]
}

/// Angles at which no side is along an axis.
const ANGLES: [f64; 4] = [0.4, 2.0, -1.1, 1.5];

fn solved(problem: &Problem, degree: Degree) -> Result<Solution, String> {
    let method = Method { degree, ..Method::default() };
    solve(problem, &method, &Settings::default()).map(|(solution, _)| solution).map_err(text)
}

/// The numbers of two solutions are the same, to what rounding leaves.
fn same(a: &Solution, of_a: f64, b: &Solution, of_b: f64) -> Result<(), String> {
    for ((name, a), (_, b)) in reported(a, of_a).into_iter().zip(reported(b, of_b)) {
        let size = a.iter().map(|a| a.abs()).fold(0.0, f64::max);
        let far = |(a, b): (&f64, &f64)| !abs_diff_eq!(a, b, epsilon = 1e-9 * size);
        if a.len() != b.len() || a.iter().zip(&b).any(far) {
            return Err(format!("{name}: {a:?} and {b:?}"));
        }
    }
    Ok(())
}

/// The problem turned by the angles has the solution turned by `factor` times the angles.
fn turned_solutions(factor: f64) -> Outcome {
    let mut length = 0.0;
    for degree in DEGREES {
        let plain = solved(&problem(0.0, true)?, degree)?;
        same(&plain, 0.0, &solved(&problem(0.0, false)?, degree)?, 0.0)?;
        for angle in ANGLES {
            let of_turned = solved(&problem(angle, false)?, degree)?;
            same(&plain, 0.0, &of_turned, factor * angle)
                .map_err(|why| format!("turned by {angle}: {why}"))?;
        }
        length = plain.quantities.contact_length;
    }
    if !(length > 0.0) {
        return Err("no contact".to_owned());
    }
    Ok(())
}

/// What is reported balances to `within` of its size: forces, moments about the origin, and energies, with `share` of the moment of
/// contact.
fn balanced(problem: &Problem, degree: Degree, within: f64, share: f64) -> Result<(), String> {
    let method = Method { degree, ..Method::default() };
    let d = discretize(problem, &method).map_err(text)?;
    let solution = solved(problem, degree)?;
    let (mut force, mut moment, mut size) = ([0.0; 2], 0.0, 0.0);
    let mut add = |f: [f64; 2], m: f64| {
        force = [force[0] + f[0], force[1] + f[1]];
        moment += m;
        size += f[0].abs() + f[1].abs() + m.abs();
    };
    for (&[x, y], &[fx, fy]) in d.space.nodes().iter().zip(&d.load) {
        add([fx, fy], x * fy - y * fx);
    }
    let q = &solution.quantities;
    for (name, &reaction) in &q.reactions {
        add(reaction, q.reaction_moments[name]);
    }
    for part in &solution.boundaries {
        add(part.resultant, share * part.moment);
    }
    let near = |value: f64| value.abs() <= within * size;
    if !(force.into_iter().all(near) && near(moment)) {
        return Err(format!("force {force:?}, moment {moment:e}, of {size:e}"));
    }
    let b = &solution.balance;
    // By definition: the reactions times the displacements of the supports, the loads times the displacement.
    let work = d.load.as_flattened().iter().zip(solution.displacement.as_flattened());
    let loads: f64 = work.map(|(f, u)| f * u).sum();
    if !(abs_diff_eq!(b.loads, loads, epsilon = 1e-12 * loads.abs())
        && b.imbalance.abs() <= within
        && abs_diff_eq!(b.strain - b.loads - b.supports, b.contact, epsilon = within * b.strain)
        && abs_diff_eq!(b.strain, solution.quantities.energy, epsilon = 1e-12 * b.strain))
    {
        return Err(format!("energies {b:?}, loads {loads:e}"));
    }
    Ok(())
}

/// The cases whose loads and supports are told by their files: bodies of two materials, on curves, on two obstacles, without supports.
const CASES: [&str; 7] = ["block", "gap", "cantilever", "disk_force", "wood", "pin", "bracket"];

fn balances(share: f64) -> Outcome {
    for degree in DEGREES {
        for angle in [0.0, 0.4, 2.0] {
            balanced(&problem(angle, false)?, degree, 1e-11, share)?;
        }
        for name in CASES {
            // Newton's method ends at 1e-10, and steel takes digits of what rubber carries.
            balanced(&case(&format!("{name}.toml"), &[]).problem, degree, 1e-8, share)
                .map_err(|why| format!("{name}, {degree:?}: {why}"))?;
        }
    }
    Ok(())
}

/// Whether the block is taken with these components of its upper side prescribed and this force on it, and along how many
/// motions it slides.
fn held(prescribed: [bool; 2], force: [f64; 2]) -> Result<Option<usize>, String> {
    let mut conditions = BTreeMap::from([("bottom".to_owned(), Condition::contact(|_| 0.0))]);
    if prescribed != [false; 2] {
        let given = prescribed.map(|yes| yes.then(|| constant(0.0)));
        conditions.insert("top".to_owned(), Condition::Displacement(given));
    }
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    let problem = Problem::new(block(0.0)?, material, force.map(constant), conditions);
    match check(&problem, &Method::default()) {
        Ok(outline) => Ok(Some(outline.slides)),
        Err(SolveError::Data(DataError::RigidMotion { .. })) => Ok(None),
        Err(other) => Err(other.to_string()),
    }
}

/// What is held and what is not; `without` the load, which presses on the obstacle or does not.
fn bodies_are_held(without: bool) -> Outcome {
    let cases = [
        ([true, true], [0.3, 1.0], Some(0)),
        // Turning and rising are stopped by the upper side, sliding by nothing.
        ([false, true], [0.3, -1.0], None),
        ([false, true], [0.0, -1.0], Some(1)),
        // Sliding is stopped by the upper side; the load decides about rising.
        ([true, false], [0.0, -1.0], Some(0)),
        ([true, false], [0.0, 1.0], None),
        ([false, false], [0.0, -1.0], Some(1)),
        ([false, false], [0.0, 1.0], None),
        ([false, false], [0.1, -1.0], None),
        ([false, false], [0.0, 0.0], None),
        // Held along the upper side only, the block turns about a lower corner where 2 or more pushes it beside a weight of 1:
        // a contact that could pull would hold it, and on the verge nothing does.
        ([true, false], [1.9, -1.0], Some(0)),
        ([true, false], [-1.9, -1.0], Some(0)),
        ([true, false], [2.0, -1.0], None),
        ([true, false], [-2.0, -1.0], None),
        ([true, false], [2.5, -1.0], None),
        ([true, false], [-2.5, -1.0], None),
    ];
    for (prescribed, force, expected) in cases {
        let found = held(prescribed, if without { [0.0; 2] } else { force })?;
        if found != expected {
            return Err(format!("{prescribed:?}, force {force:?}: {found:?}, not {expected:?}"));
        }
    }
    for angle in TURNS {
        for (sides, expected) in [(&["left"][..], false), (&["left", "bottom"], true)] {
            for load in [-1.0, 1.0] {
                if on_rollers(angle, sides, load)? != expected {
                    return Err(format!("on rollers at {sides:?}, by {angle}: not {expected}"));
                }
            }
        }
    }
    Ok(())
}

/// Whether a body is held; other refusals are errors.
fn taken(problem: &Problem) -> Result<bool, String> {
    let method = Method { degree: Degree::Two, ..Method::default() };
    match discretize(problem, &method) {
        Ok(_) => Ok(true),
        Err(SolveError::Data(DataError::RigidMotion { .. })) => Ok(false),
        Err(other) => Err(other.to_string()),
    }
}

/// Angles of a block on rollers.
const TURNS: [f64; 5] = [0.0, 0.4, FRAC_PI_4, 2.0, -FRAC_PI_4];

/// Whether a turned block is taken that has rollers at these sides; a load drives it along the left one.
fn on_rollers(angle: f64, sides: &[&str], load: f64) -> Result<bool, String> {
    let roller = || Condition::roller();
    let conditions = sides.iter().map(|side| ((*side).to_owned(), roller()));
    let floor = ("right".to_owned(), Condition::contact(|_| 1.0));
    let force = turned(angle, [0.0, load]).map(constant);
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    taken(&Problem::new(block(angle)?, material, force, conditions.chain([floor]).collect()))
}

/// The three routes end at the same displacement; `share` of the others'.
fn routes(
    degree: Degree,
    angle: f64,
    quadrature: ContactQuadrature,
    share: f64,
) -> Result<f64, String> {
    let problem = problem(angle, false)?;
    let method = Method { degree, quadrature, ..Method::default() };
    let d = discretize(&problem, &method).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let by = |name| route::by(name, &system, &Settings::default(), &mut Times::default());
    let a = by(RouteName::Condensed).map_err(text)?.u;
    let size = a.as_flattened().iter().map(|u| u.abs()).fold(0.0, f64::max);
    let b = by(RouteName::Assembled).map_err(text)?.u;
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    let far = pairs.map(|(a, b)| (a - share * b).abs()).fold(0.0, f64::max) / size;
    if far <= 1e-10 { Ok(far) } else { Err(format!("they differ by {far:e}")) }
}

fn routes_agree(share: f64) -> Outcome {
    let mut far: f64 = 0.0;
    let exact = ContactQuadrature::Exact;
    for (angle, rule) in [(0.0, exact), (0.4, exact), (0.4, ContactQuadrature::Gauss(3))] {
        far = far.max(routes(Degree::One, angle, rule, share)?);
        far = far.max(routes(Degree::Two, angle, rule, share)?);
    }
    Ok(())
}

/// The forces of a translation that no double is, without loads, vanish, and P is what it moves along the direction of contact,
/// less the gap; the first node moves further by `more`.
fn translation(degree: Degree, more: f64) -> Result<(), String> {
    let mut problem = problem(0.4, false)?;
    problem.body_force = [constant(0.0), constant(0.0)];
    problem.conditions.remove("right");
    let method = Method { degree, ..Method::default() };
    let d = discretize(&problem, &method).map_err(text)?;
    let third = DoubleDouble::from(1) / DoubleDouble::from(3);
    let mut u = vec![[third, third * third]; d.space.nodes().len()];
    u[0][0] += DoubleDouble::from(more);
    let (forces, p) = residual::evaluate(&d, &u, (|_| true, &vec![[0.0; 2]; u.len()]));
    let largest = forces.as_flattened().iter().map(|f| f.abs()).fold(0.0, f64::max);
    if !(largest <= 2.0_f64.powi(-90)) {
        return Err(format!("a force of {largest:e}, none was expected"));
    }
    for (i, p) in p.iter().map(|p| p.head()).enumerate() {
        let (edge, a) = (&d.contact[i / (degree.number() + 1)], i % (degree.number() + 1));
        let node = edge.geometry.nodes[a];
        let expected = node.direction[0] / 3.0 + node.direction[1] / 9.0 - node.gap;
        if !abs_diff_eq!(p, expected, epsilon = 1e-15) {
            return Err(format!("P is {p}, expected {expected}"));
        }
    }
    Ok(())
}

/// A(u, .) - L and P at a field of doubles: in double-doubles as in doubles, to `digits` of the magnitudes.
fn precise_as_in_doubles(degree: Degree, digits: f64) -> Result<(), String> {
    let problem = problem(0.4, false)?;
    let method = Method { degree, ..Method::default() };
    let d = discretize(&problem, &method).map_err(text)?;
    for_all(3, field(d.space.nodes().len()), |u| {
        let exact: Vec<[DoubleDouble; 2]> = u.iter().map(|u| u.map(DoubleDouble::from)).collect();
        let (forces, p) = residual::evaluate(&d, &exact, (|_| true, &vec![[0.0; 2]; u.len()]));
        let doubles = d.linear_residual(&u);
        for (node, force) in forces.iter().enumerate() {
            for c in 0..2 {
                let far = (force[c] - doubles.values[node][c]).abs();
                if !(far <= digits * doubles.magnitudes[node][c]) {
                    return Err(format!("a force at node {node} is off by {far:e}"));
                }
            }
        }
        let in_doubles = d.contact.iter().flat_map(|edge| edge.p(&u));
        for (p, expected) in p.iter().map(|p| p.head()).zip(in_doubles) {
            // Some hundred roundings of numbers up to 1.
            if !abs_diff_eq!(p, expected, epsilon = 1e-12) {
                return Err(format!("P is {p}, in doubles {expected}"));
            }
        }
        Ok(())
    })
}

/// The height of the nodes of the upper cells that are not flat.
const HIGH: f64 = 0.1;

/// A(u, .) - L of a block whose cells are flat at the floor, by the arithmetic in which the solver corrects, is off the one in
/// double-doubles by `most` of all forces; those of cells that are not flat are the ones in doubles, bit by bit.
fn forces_of_flat_cells(degree: Degree, precisely: bool, most: f64) -> Result<(), String> {
    let mut problem = problem(0.0, true)?;
    let cells = Rectangle { width: 2.0, height: 1.0, nx: 4, ny: 4, diagonal: Diagonal::Crossed };
    let flat = moved_to(&cells.mesh().map_err(text)?, |[x, y]| [x, y.powi(9)]);
    problem.mesh = flat;
    let method = Method { degree, ..Method::default() };
    let d = discretize(&problem, &method).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let (solved, _, _) = solve_discrete(&d, &Settings::default()).map_err(text)?;
    let mut iterate = Iterate::lift(&d);
    let lift = iterate.rounded().into_iter().flatten();
    let mut step: Vec<[f64; 2]> = solved.u.clone();
    step.as_flattened_mut().iter_mut().zip(lift).for_each(|(u, lift)| *u -= lift);
    iterate.add(&system, 1.0, &system.numbering.gather(&step));
    let u: Vec<[DoubleDouble; 2]> =
        iterate.rounded().into_iter().map(|u| u.map(DoubleDouble::from)).collect();
    let [found, doubles] = [precisely, false].map(|how| iterate.evaluate(&system, how).forces);
    let (exact, _) = residual::evaluate(&d, &u, (|_| true, &vec![[0.0; 2]; u.len()]));
    let norm = |f: &[[f64; 2]]| f.as_flattened().iter().map(|f| f * f).sum::<f64>().sqrt();
    let apart: Vec<[f64; 2]> =
        found.iter().zip(&exact).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect();
    let off = norm(&apart) / norm(&exact);
    if !(off <= most) {
        return Err(format!("forces are off by {off:e}"));
    }
    let all = found.iter().zip(&doubles).zip(d.space.nodes());
    let high: Vec<_> = all.filter(|(_, x)| x[1] > HIGH).map(|(forces, _)| forces).collect();
    let are_in_doubles = high.iter().all(|(found, doubles)| found == doubles);
    let same =
        doubles.iter().zip(&exact).zip(d.space.nodes()).all(|((a, b), x)| a == b || x[1] <= HIGH);
    if are_in_doubles && !same { Ok(()) } else { Err("cells that are not flat".to_owned()) }
}

properties! {
    turned_problems_have_turned_solutions: turned_solutions(1.0); not turned_solutions(-1.0);
    forces_moments_and_energies_balance: balances(1.0); not balances(-1.0);
    bodies_that_can_move_are_refused: bodies_are_held(false); not bodies_are_held(true);
    the_routes_end_at_the_same_displacement: routes_agree(1.0); not routes_agree(1.0 + 1e-6);
    forces_of_a_translation_vanish_in_double_doubles:
        translation(Degree::One, 0.0), translation(Degree::Two, 0.0);
        not translation(Degree::Two, 1e-20);
    the_residual_in_double_doubles_is_that_in_doubles:
        precise_as_in_doubles(Degree::One, 1e-15), precise_as_in_doubles(Degree::Two, 1e-15);
        not precise_as_in_doubles(Degree::Two, 1e-18);
    forces_that_doubles_blur_are_in_double_doubles_and_others_are_not:
        forces_of_flat_cells(Degree::One, true, 1e-13), forces_of_flat_cells(Degree::Two, true, 1e-13);
        not forces_of_flat_cells(Degree::One, false, 1e-13);
}
