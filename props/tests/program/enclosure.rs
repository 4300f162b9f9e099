//! The enclosure that every solve reports, in balls and in doubles, beside the exact solution u^h of the discrete problem, or a
//! point that is a thousand times nearer to it (`certified`).

use std::sync::Arc;

use approx::abs_diff_eq;
use signorini::contact::Discretization;
use signorini::kernel::PreciseBall;
use signorini::kernel::{Material, Plane};
use signorini::linear::factor::Factor;
use signorini::linear::matrix::LowerTriangle;
use signorini::linear::system::System;
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Obstacle, Problem, Rectangle, Side};
use signorini::proof::enclosure;
use signorini::proof::enclosure::{Enclosure, Unproved, Verifier};
use signorini::proof::intervals::Arithmetic;
use signorini::proof::korn::Korn;
use signorini::solve::{Gamma0, Method, Settings, SolveError, discretize_any, solve_discrete};

use super::{at_points, certified, pressed, rounding};
use props::claim::{Outcome, noticed, text};
use props::claims::one_solution::{
    BETWEEN, Certifier, Draw, IRRATIONAL, NARROW, P1, P1_BY_POINTS, P2_BY_POINTS, Rule, of_solved,
    on_small_meshes, power, problems, triangle,
};
use props::discrete::{CUT, Nodal, exactly};
use props::elimination::square;
use props::numbers::Exact;
use props::problems::{cells, floor, held, unloaded};
use props::proof::sampler::Random;
use props::verdict::Verdict;
use props::{draws, ensure};
use proptest::prelude::Strategy;

/// What is asked of the enclosures around a point, and planted mistakes.
#[derive(Clone, Copy)]
struct Asked {
    /// The solver's result is moved at random by up to this.
    noise: f64,
    /// Radii are at most 2^-share |u~|_a.
    share: i32,
    /// The radii that are reported are multiplied by this.
    factor: f64,
    /// So is the load that the residual is evaluated with.
    load: f64,
    /// And the matrix whose factor is at hand.
    matrix: f64,
}

/// Around the solver's result.
const RESULT: Asked = Asked { noise: 0.0, share: 40, factor: 1.0, load: 1.0, matrix: 1.0 };

/// Around any point: a perturbation raises the radius at least to what it moves u~ by.
const MOVED: Asked = Asked { noise: 1e-3, share: -40, ..RESULT };

/// With the factor of another matrix: the bound is a large one.
const ANOTHER_FACTOR: Asked = Asked { matrix: 1e3, share: -400, ..MOVED };

/// The field moved at random.
fn moved(u: &[[f64; 2]], by: f64) -> Vec<[f64; 2]> {
    let steps = super::random_field(&mut Random::new(1), u.len());
    u.iter().zip(steps).map(|(u, d)| [0, 1].map(|c| u[c] + by * d[c] / 2.0)).collect()
}

/// The factor of A times a number.
pub fn factor_of(system: &System, times: f64) -> Result<Factor, SolveError> {
    let LowerTriangle { starts, rows, values } = &system.matrix;
    let values = values.iter().map(|a| times * a).collect();
    Factor::new(&LowerTriangle { starts: starts.clone(), rows: rows.clone(), values })
}

/// The solver's result on a drawn problem, certified in exact arithmetic, with the enclosures of the solver, in balls and in doubles:
/// all contain the exact u^h, or a point whose own radius is a thousand times smaller.
fn enclosed(draw: &Draw, rule: Rule, asked: Asked) -> Verdict {
    of_solved(draw, rule, |d, u| around(d, u, draw, asked))
}

fn around(
    d: &Discretization<'_>,
    u: &[[f64; 2]],
    draw: &Draw,
    asked: Asked,
) -> Result<Verdict, &'static str> {
    // Prescribed components too: the enclosure counts what they are off by.
    let u = moved(u, asked.noise);
    let reported = match reported(d, &u, asked, draw) {
        Ok(reported) => reported,
        Err(verdict) => return Ok(verdict),
    };
    let (certifier, found) = (Certifier::new(d), exactly(&u));
    let scale = square(&certifier.k, &certifier.problem.free(&found));
    let radius = |of: &Enclosure| Exact::of_double(of.radius) * Exact::of_double(asked.factor);
    for (of, share) in &reported {
        if !(radius(of) * radius(of) <= power(*share) * power(*share) * scale) {
            return Err("a radius is at most 2^-share |u~|_a");
        }
    }
    let radii: Vec<Exact> = reported.iter().map(|(of, _)| radius(of)).collect();
    let beside = |exact: &[[Exact; 2]], slack: Exact| {
        for (of, _) in &reported {
            let factors = [Exact::of_double(asked.factor), slack * radius(of)];
            let up = draw.turned([0, 1]).map(Exact::from);
            let verdict = within(&certifier, &found, exact, of, factors, up);
            if verdict.fails() {
                return verdict;
            }
        }
        Verdict::Holds("within")
    };
    let of_certificate = certified::Asked { share: asked.share, tenth: None };
    let by_contact = draw.by_contact;
    certified::compared(&certifier, &found, of_certificate, by_contact, &radii, beside)
}

/// The enclosures of the solver, with the binary digits that their radii have less than |u~|_a. None where vertices are moved: on
/// whole cells lengths and normals are doubles, so that both sides speak of the same problem.
fn reported(
    d: &Discretization<'_>,
    u: &[[f64; 2]],
    asked: Asked,
    draw: &Draw,
) -> Result<Vec<(Enclosure, i32)>, Verdict> {
    if draw.moved.is_some() {
        return Ok(Vec::new());
    }
    let system = System::new(d).map_err(|_| Verdict::Fails("there is a system"))?;
    let load: Vec<[PreciseBall; 2]> =
        d.load.iter().map(|l| l.map(|l| PreciseBall::from(l * asked.load))).collect();
    let factor =
        (asked.matrix != 1.0).then(|| factor_of(&system, asked.matrix).map(|l| Arc::new(l).into()));
    let factor = factor.transpose().map_err(|_| Verdict::Fails("there is a factor"))?;
    let mut verifier = Verifier::with_load(&system, factor, &load);
    // Arithmetic in doubles are off by some 1e-13, more where lambda is large.
    let kinds = [(Arithmetic::Balls, asked.share), (Arithmetic::Doubles, asked.share - 10)];
    let one = |(arithmetic, share)| match verifier.enclose(u, None, arithmetic) {
        Ok(enclosure) => Ok((enclosure, share)),
        // No edge may be pressed from end to end.
        Err(Unproved::HeldByContact) if draw.by_contact => Err(Verdict::Vacuous),
        Err(_) => Err(Verdict::Fails("there is an enclosure")),
    };
    kinds.into_iter().map(one).collect()
}

/// u~ is as near to `exact` as the enclosure says, its radii times a factor, where `exact` is u^h up to `slack`.
fn within(
    certifier: &Certifier<'_>,
    found: &[[Exact; 2]],
    exact: &[[Exact; 2]],
    enclosure: &Enclosure,
    [factor, slack]: [Exact; 2],
    up: [Exact; 2],
) -> Verdict {
    let most = |radius: f64| factor * Exact::of_double(radius) + slack;
    let error: Nodal = found.iter().zip(exact).map(|(u, v)| [u[0] - v[0], u[1] - v[1]]).collect();
    ensure!(
        certified::energy(&certifier.problem, &error)
            <= most(enclosure.radius) * most(enclosure.radius)
    );
    // At the nodes from where the prescribed components should be.
    let mut found = found.to_vec();
    certifier.problem.prescribe(&mut found);
    let found = &found[..];
    for ((u, exact), &node) in found.iter().zip(exact).zip(&enclosure.nodes) {
        let off = [u[0] - exact[0], u[1] - exact[1]];
        ensure!(off[0] * off[0] + off[1] * off[1] <= most(node) * most(node));
    }
    if slack == Exact::from(0)
        && let Some(apart) = certified::pressures_apart(&certifier.problem, found, exact)
    {
        ensure!(apart <= most(enclosure.pressure) * most(enclosure.pressure));
    }
    if slack == Exact::from(0) {
        quantities(certifier, exact, enclosure, factor, up)
    } else {
        Verdict::Holds("within")
    }
}

/// What is reported of u^h lies in its intervals, which are made narrower by `factor`.
fn quantities(
    certifier: &Certifier<'_>,
    u: &[[Exact; 2]],
    enclosure: &Enclosure,
    factor: Exact,
    up: [Exact; 2],
) -> Verdict {
    let zero = Exact::from(0);
    let two = Exact::from(2);
    let inside = |[low, high]: [f64; 2], x: Exact| {
        let [low, high] = [low, high].map(Exact::of_double);
        let (middle, half) = ((low + high) / two, (high - low) / two * factor);
        middle - half <= x && x <= middle + half
    };
    let intervals = &enclosure.intervals;
    ensure!(inside(intervals.energy, certified::energy(&certifier.problem, u)));
    let largest = u.iter().map(|u| u[0] * u[0] + u[1] * u[1]);
    let largest = largest.fold(zero, |most, x| if x > most { x } else { most });
    let [low, high] = intervals.max_displacement.map(Exact::of_double);
    ensure!(low * low <= largest && largest <= high * high);
    // One boundary, the lower side, with the normal -`up`; and one that holds.
    let force = certified::contact_force(&certifier.problem, u);
    let [contact] = &intervals.contact[..] else { return Verdict::Fails("one boundary") };
    ensure!(inside(contact.force, force));
    ensure!((0..2).all(|c| inside(contact.resultant[c], force * up[c])));
    let held = certifier.problem.reactions(u).into_iter().zip(certifier.problem.prescribed());
    let reaction = held.fold([zero; 2], |sum, (r, p)| {
        [0, 1].map(|c| if p[c].is_some() { sum[c] + r[c] } else { sum[c] })
    });
    let Some(ranges) = intervals.reactions.values().next() else {
        return Verdict::Fails("a boundary holds");
    };
    ensure!((0..2).all(|c| inside(ranges[c], reaction[c])));
    Verdict::Holds("within")
}

fn hold(asked: Asked) -> Outcome {
    on_small_meshes(|draw, rule| enclosed(draw, rule, asked))
}

/// Such problems of bodies that contact alone holds, on floors that are so many times as steep.
fn problems_by_contact(most: [usize; 2], steeper: f64) -> impl Strategy<Value = Draw> {
    problems(most, BETWEEN).prop_map(move |draw| {
        let gap = [draw.gap[0], steeper * draw.gap[1]];
        Draw { gap, by_contact: true, ..draw }
    })
}

/// Draws of bodies that contact alone holds, around the result and around any point near it. Where an edge is open in part,
/// u^h is rational by Gauss points only.
fn reported_of_what_contact_holds() -> Outcome {
    let mut text = Vec::new();
    for asked in [RESULT, Asked { noise: 1e-4, ..MOVED }] {
        for (cases, rule, most, steeper, classes) in [
            (3, P1, [2, 2], 6.0, &["pressed"][..]),
            (3, P1_BY_POINTS, [2, 2], 12.0, &["pressed", CUT]),
            (2, P2_BY_POINTS, [1, 1], 6.0, &["pressed"]),
        ] {
            text.push(draws::hold(cases, problems_by_contact(most, steeper), classes, |draw| {
                enclosed(draw, rule, asked)
            })?);
        }
    }
    Ok(text.join("; "))
}

/// A third of the radii there.
fn a_third_of_what_contact_holds() -> Outcome {
    let asked = Asked { factor: 1.0 / 3.0, noise: 1e-4, ..MOVED };
    draws::reject(problems_by_contact([2, 2], 6.0), |draw| enclosed(draw, P1, asked))
}

/// A body on a round obstacle, so that directions of contact turn along each edge: the kappa that the enclosure proves is that
/// of the method, times `scale`, rounded up, and its bounds at the nodes are Korn's factors times the radius.
fn proved_kappa(scale: f64) -> Outcome {
    let mut turning: f64 = 0.0;
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    for radius in [1.0, 3.0, 20.0] {
        let cells = Rectangle { width: 2.0, height: 1.0, nx: 3, ny: 2, diagonal: Diagonal::Left };
        let center = [0.7, -0.05 - radius];
        let round = Obstacle::Circle { center, radius, side: Side::Outside };
        let round = Condition::Obstacle("round".into(), round);
        let conditions = [("top", held([0.0, -0.1])), ("bottom", round)];
        let problem = unloaded(cells.mesh().map_err(text)?, material, conditions);
        for gamma0 in [Gamma0::Auto, Gamma0::Local(0.5)] {
            turning = turning.max(proved_kappa_on(Degree::One, &problem, gamma0, scale)?);
            turning = turning.max(proved_kappa_on(Degree::Two, &problem, gamma0, scale)?);
        }
    }
    // At a corner a triangle may have two edges on Gamma_C.
    for diagonal in [Diagonal::Left, Diagonal::Right] {
        let mesh = cells([2, 1], diagonal).mesh().map_err(text)?;
        let conditions =
            [("top", held([0.1, -0.1])), ("bottom", floor(0.0)), ("right", floor(0.0))];
        let problem = unloaded(mesh, material, conditions);
        proved_kappa_on(Degree::One, &problem, Gamma0::Auto, scale)?;
        proved_kappa_on(Degree::Two, &problem, Gamma0::Auto, scale)?;
    }
    Ok(format!("3 obstacles and two corners, P1 and P2; directions turn by up to {turning:.2}"))
}

fn proved_kappa_on(
    degree: Degree,
    problem: &Problem,
    gamma0: Gamma0,
    scale: f64,
) -> Result<f64, String> {
    let d = discretize_any(problem, &Method { degree, gamma0, ..Method::default() });
    let d = d.map_err(text)?;
    let (solved, ..) = solve_discrete(&d, &Settings::default()).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let enclosure = enclosure::enclose(&system, &solved.u, None, None);
    let enclosure = enclosure.map_err(text)?;
    let korn = Korn::new(&d.space, &problem.material, &d.constraints, &[]).ok_or("not held")?;
    for (bound, factor) in enclosure.nodes.iter().zip(korn.nodes) {
        // What is prescribed is a double: rounding moves nothing, and all of the radius is that of the residual, each rounded up.
        let expected = factor * enclosure.radius;
        if !abs_diff_eq!(*bound, expected, epsilon = 1e-14 * expected) {
            return Err(format!("a bound of {bound:e} at a node, by Korn {expected:e}"));
        }
    }
    let (proved, kappa) = (scale * enclosure.kappa, d.kappa());
    // Some dozen roundings of doubles on the one side.
    if !abs_diff_eq!(proved, kappa, epsilon = 1e-14 * kappa) {
        return Err(format!("kappa = {kappa}, and {proved} is proved"));
    }
    let turns = d.contact.iter().map(|piece| {
        let [start, end] = [0, 1].map(|a| piece.geometry.nodes[a].direction);
        (start - end).map(f64::abs).max()
    });
    Ok(turns.fold(0.0, f64::max))
}

/// In full contact, where u^h is rational and each of the bounds is looked at.
fn rejected(asked: Asked) -> Outcome {
    let mut text = Vec::new();
    for (rule, most) in [(P1, [2, 1]), (P2_BY_POINTS, [1, 1])] {
        let drawn = problems(most, NARROW);
        text.push(draws::reject(drawn, |draw| enclosed(draw, rule, asked))?);
    }
    Ok(text.join("; "))
}

/// A square of 4 x 4 cells that rolls off its floor: 40 unknowns.
fn on_a_finer_mesh() -> Outcome {
    let draw = Draw {
        cells: [4, 4],
        diagonal: Diagonal::Right,
        moved: None,
        lambda: 1.0,
        plane: Plane::Strain,
        load: [0.25, -0.125],
        gap: [-0.25, 0.125],
        push: 0.0,
        kappa: 10,
        by_contact: false,
    };
    Exact::scope(|| match enclosed(&draw, P1, RESULT) {
        Verdict::Holds(IRRATIONAL) => Ok(format!("40 unknowns: {IRRATIONAL}")),
        other => Err(format!("{other:?}")),
    })
}

/// On a triangle beyond the limit the enclosure is refused.
fn refused_beyond_the_limit() -> Outcome {
    let problem = triangle()?;
    for (gamma0, unique) in [(1.6, false), (1.0 / 15.0, true)] {
        let gamma0 = Gamma0::Value(gamma0);
        let method = Method { gamma0, allow_noncoercive: true, ..Method::default() };
        let d = discretize_any(&problem, &method).map_err(text)?;
        let system = System::new(&d).map_err(text)?;
        let enclosure = enclosure::enclose(&system, &d.constraints.lift(), None, None);
        let refused = matches!(enclosure, Err(Unproved::NotCoercive { .. }));
        if refused == unique {
            return Err(format!("gamma0 = {gamma0:?}: the enclosure is {enclosure:?}"));
        }
    }
    Ok("gamma0 = 8/5: refused; gamma0 = 1/15: accepted".to_owned())
}

checks! {
    the_enclosure_that_is_reported_contains_the_solution_around_the_result => hold(RESULT);
    the_enclosure_of_what_contact_alone_holds_contains_the_solution => reported_of_what_contact_holds();
    control_a_third_of_the_radius_where_contact_holds => a_third_of_what_contact_holds();
    stresses_in_doubles_are_off_by_no_more_than_their_bound => rounding::stresses_are_off(1.0);
    control_a_bound_of_rounding_that_is_too_small => noticed(rounding::stresses_are_off(1e-3));
    the_enclosure_contains_the_solution_whatever_the_factor => hold(ANOTHER_FACTOR);
    errors_at_points_are_those_of_the_nodes => at_points::errors_at_points(1.0);
    control_half_the_error_at_a_point => noticed(at_points::errors_at_points(0.5));
    edges_that_are_taken_for_pressed_stay_so => pressed::stays(1.0);
    control_edges_stay_pressed_on_a_larger_ball => noticed(pressed::stays(1.01));
    pressed_edges_hold_their_ends => pressed::holds(1.0);
    control_pressed_edges_hold_their_ends_by_a_hundredth_less => noticed(pressed::holds(0.99));
    springs_of_pressed_edges_are_those_of_p0 => pressed::springs(1.0);
    control_springs_of_pressed_edges_are_stiffer => noticed(pressed::springs(1.0 + 1e-9));
    all_that_is_within_the_clearance_is_a_solution => pressed::room(1.0 - 1e-9);
    control_what_is_beyond_the_clearance_is_a_solution => noticed(pressed::room(1.01));
    kappa_and_bounds_at_nodes_are_proved_where_directions_turn => proved_kappa(1.0);
    control_a_kappa_that_is_a_millionth_smaller => noticed(proved_kappa(1.0 - 1e-6));
    the_enclosure_that_is_reported_contains_the_solution_around_any_point => hold(MOVED);
    control_a_third_of_the_radius_that_is_reported => rejected(Asked { factor: 1.0 / 3.0, ..MOVED });
    control_a_residual_from_a_wrong_load => rejected(Asked { load: 1.0 + 1e-6, ..RESULT });
    one_solution_is_enclosed_on_a_finer_mesh => on_a_finer_mesh();
    control_a_moved_result_for_the_solvers => rejected(Asked { noise: 1e-9, ..RESULT });
    the_enclosure_is_refused_beyond_the_limit => refused_beyond_the_limit();
}
