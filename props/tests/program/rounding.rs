//! With what rounding stresses come, on loaded bodies with random displacements.

use std::collections::BTreeMap;
use std::sync::Arc;

use signorini::contact::residual;
use signorini::kernel::PreciseBall;
use signorini::linear::factor::Factor;
use signorini::linear::matrix;
use signorini::linear::matrix::Neighbours;
use signorini::linear::system::System;
use signorini::model::{Condition, Degree, Problem, SharedFunction};
use signorini::proof::balls::Lines;
use signorini::proof::rounded_stress;
use signorini::solve::{Method, discretize_any};

use props::claim::{Outcome, text};
use props::draws;
use props::problems::{constant, held};
use props::proof::sampler::Random;

/// The small bodies of row 9 under a load and a displacement of their upper side, half of them pressed on their obstacle.
fn loaded_bodies() -> Result<Vec<(String, Problem)>, String> {
    let mut bodies = Vec::new();
    for (i, body) in super::sharpness::small_bodies()?.into_iter().enumerate() {
        let mut problem = body.problem;
        let down = if i % 2 == 0 { -1.0 } else { 1.0 };
        problem.body_force = [constant(0.3), constant(down)];
        let displacement = |name: &str| name == "top" || name == "right";
        let sides: Vec<String> =
            problem.conditions.keys().filter(|name| displacement(name)).cloned().collect();
        let moved = BTreeMap::from([(sides[0].clone(), held([0.05, 0.1 * down]))]);
        // One side is moved: two that meet would have to agree.
        problem.conditions.retain(|name, _| !displacement(name));
        problem.conditions.extend(moved);
        let gap: SharedFunction = Arc::new(|[x, _]: [f64; 2]| 0.02 + 0.01 * x);
        problem.conditions.insert("bottom".to_owned(), Condition::Contact { gap });
        bodies.push((body.name, problem));
    }
    Ok(bodies)
}

/// A(u, v) by stresses in doubles, for a random u that is carried along by `by`, less A(u, v) in balls: its norm dual to |v|_a on
/// the v that are free, beside the bound, and the same of a(u, v); or what sums in doubles are off by, beside their radius, if that is a larger share.
fn rounding_of_stresses(degree: Degree, problem: &Problem, by: f64) -> Result<f64, String> {
    let d = discretize_any(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let mut random = Random::new(draws::seed());
    let nodes = d.space.nodes().len();
    let [heads, tails] = [0, 1].map(|_| super::random_field(&mut random, nodes));
    let small = 2.0_f64.powi(-54);
    let u: Vec<[PreciseBall; 2]> = (0..nodes)
        .map(|i| {
            [0, 1].map(|c| {
                PreciseBall::from(by + heads[i][c]) + PreciseBall::from(small * tails[i][c])
            })
        })
        .map(|u| u.map(|u| PreciseBall::point(u.centre())))
        .collect();
    let mut sums = [vec![[PreciseBall::from(0); 2]; nodes], vec![[PreciseBall::from(0); 2]; nodes]];
    let bound = rounded_stress::add_forces(&d, &u, &mut sums[0]);
    let (in_doubles, _) = rounded_stress::small_forces(&d, &u);
    let pairs = in_doubles.as_flattened().iter().zip(sums[0].as_flattened());
    let of_sums = pairs.map(|(&sum, &exact)| {
        (PreciseBall::point(sum.centre()) - exact).magnitude() / sum.radius()
    });
    let of_sums = of_sums.fold(0.0, f64::max);
    residual::add_internal_forces(&d.space, &problem.material, &u, &mut sums[1]);
    let neighbours = Neighbours::new(&d.space);
    let stiffness = matrix::assemble_stiffness(&d, &system.numbering, &neighbours).map_err(text)?;
    let factor = Factor::new(&stiffness).map_err(text)?;
    let share = |sums: &[Vec<[PreciseBall; 2]>; 2], bound: f64| {
        let off: Vec<[f64; 2]> =
            (0..nodes).map(|i| [0, 1].map(|c| (sums[0][i][c] - sums[1][i][c]).head())).collect();
        let mut half = system.numbering.gather(&off);
        factor.forward(&mut half);
        half.iter().map(|x| x * x).sum::<f64>().sqrt() / bound
    };
    let of_body = share(&sums, bound);
    let more = rounded_stress::add_contact_stresses(&d, &u, &mut sums[0]);
    let lines = Lines::new(&d);
    let plain = (0..d.contact.len()).filter(|&e| rounded_stress::is_plain(&d.contact[e]));
    plain.for_each(|e| lines[e].add_stresses(&u, &mut sums[1]));
    Ok(of_body.max(share(&sums, (bound * bound + more).sqrt())).max(of_sums))
}

/// The rounding of stresses is at most `scale` times its bound.
pub fn stresses_are_off(scale: f64) -> Outcome {
    let bodies = loaded_bodies()?;
    let mut most = 0.0_f64;
    for (name, problem) in &bodies {
        for degree in [Degree::One, Degree::Two] {
            for by in [0.0, 1.0, 1e6] {
                let share = rounding_of_stresses(degree, problem, by)?;
                most = most.max(share);
                if !(share <= scale) {
                    let what = format!("{name}, {degree:?}, carried by {by}");
                    return Err(format!("{what}: off by {share:e} of the bound"));
                }
            }
        }
    }
    Ok(format!("{} bodies, P1 and P2: off by at most {most:.0e} of the bound", bodies.len()))
}
