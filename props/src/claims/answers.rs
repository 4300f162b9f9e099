//! What is reported where the definitions leave a choice, or have a corner:
//!
//! - the recovered pressure is a mean over the edges at a node on one side of a corner only;
//! - at a point of a triangle the error is that of the nodes.

use std::collections::BTreeMap;
use std::sync::Arc;

use signorini::fem::Degree;
use signorini::fem::element::value_at;
use signorini::fem::{Condition, Diagonal, Mesh, Problem, Rectangle, SharedFunction};
use signorini::kernel::{Material, Plane};
use signorini::solve::evaluated::Evaluated;
use signorini::solve::{Method, Solution, discretize};

use super::assembled::solver::unsolved;
use super::honesty::field;
use crate::claim::{Outcome, text};
use crate::proof::sampler::Random;
use crate::{draws, sharpness};

fn constant(value: f64) -> SharedFunction {
    Arc::new(move |_: [f64; 2]| value)
}

/// A square whose lower and right sides are one boundary, on two obstacles.
fn cornered() -> Result<Problem, String> {
    let cells = Rectangle { width: 2.0, height: 2.0, nx: 2, ny: 3, diagonal: Diagonal::Left };
    let mesh = cells.mesh().map_err(text)?;
    let ends = |name: &str| -> Result<Vec<[usize; 2]>, String> {
        Ok(mesh.edges_of(name).map_err(text)?.iter().map(|&edge| mesh.ends(edge)).collect())
    };
    let around = [ends("bottom")?, ends("right")?].concat();
    let named = [("around".to_owned(), around), ("top".to_owned(), ends("top")?)];
    let mesh = Mesh::new(mesh.vertices().to_vec(), mesh.triangles().to_vec(), named);
    let held = Condition::Displacement([0, 1].map(|_| Some(constant(0.0))));
    let touching = Condition::Contact { gap: constant(0.0) };
    let conditions = [("around", touching), ("top", held)];
    Ok(Problem::new(
        mesh.map_err(text)?,
        Material::lame(1.0, 1.0, Plane::Strain),
        [constant(0.0), constant(0.0)],
        conditions.map(|(name, condition)| (name.to_owned(), condition)).into(),
    ))
}

/// Places on an edge, for sums in place of integrals.
const PLACES: i32 = 4000;

/// A place on the contact line in bits, with the side that it is on; by the side, or `across` corners.
type Key = ([u64; 2], [u64; 2]);

/// The recovered pressures of a random displacement by their definition: the means of -lambda^h by the hats at each place, over
/// the edges there with the same normal.
fn recovered(degree: Degree, across: bool) -> Result<usize, String> {
    let problem = cornered()?;
    let d = discretize(&problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let mut random = Random::new(draws::seed());
    let u = field(d.space.nodes().len(), &mut random);
    let solution = Solution::new(&d, Evaluated::new(&d, u.clone()), unsolved());
    let key = |place: [f64; 2], normal: [f64; 2]| -> Key {
        let side = if across { [0.0; 2] } else { normal };
        (place.map(f64::to_bits), side.map(|n| n.round().to_bits()))
    };
    let mut means: BTreeMap<Key, [f64; 2]> = BTreeMap::new();
    let keys: Vec<Vec<Key>> = d
        .contact
        .iter()
        .map(|line| {
            let nodes = d.space.edge_nodes(line.edge).into_iter();
            nodes.map(|node| key(d.space.nodes()[node], line.normal.into())).collect()
        })
        .collect();
    for (line, keys) in d.contact.iter().zip(&keys) {
        let p = line.p(&u);
        for k in 0..PLACES {
            let s = (f64::from(k) + 0.5) / f64::from(PLACES);
            let pressure = value_at(&p, s).max(0.0) / line.gamma;
            for (a, key) in keys.iter().enumerate() {
                // Start, end, and for P2 the middle, whose hats are those of half edges.
                let hat = match (degree, a) {
                    (Degree::One, 0) => 1.0 - s,
                    (Degree::One, _) => s,
                    (_, 0) => (1.0 - 2.0 * s).max(0.0),
                    (_, 1) => (2.0 * s - 1.0).max(0.0),
                    _ => 1.0 - (2.0 * s - 1.0).abs(),
                };
                let [work, weight] = means.entry(*key).or_default();
                *work += line.length * hat * pressure;
                *weight += line.length * hat;
            }
        }
    }
    let largest = means.values().map(|[work, weight]| work / weight).fold(0.0, f64::max);
    let mut count = 0;
    for (edge, keys) in solution.contact.iter().zip(&keys) {
        // The points are in the order along the edge: start, middle, end.
        let order: &[usize] = if degree == Degree::One { &[0, 1] } else { &[0, 2, 1] };
        for (point, &a) in edge.points.iter().zip(order) {
            let [work, weight] = means[&keys[a]];
            // Sums over places: 1/PLACES^2, and 1/PLACES where P is cut.
            if !((point.pressure - work / weight).abs() <= 1e-3 * largest) {
                return Err(format!(
                    "{} is reported, the mean is {}",
                    point.pressure,
                    work / weight
                ));
            }
            count += 1;
        }
    }
    Ok(count)
}

pub(super) fn around_corners(across: bool) -> Outcome {
    let count = recovered(Degree::One, across)? + recovered(Degree::Two, across)?;
    Ok(format!("{count} places on two sides of a corner, P1 and P2"))
}

/// A random displacement of a block of unequal triangles as a solution.
fn anything(
    degree: Degree,
    problem: &Problem,
    u: impl Fn([f64; 2], [f64; 2]) -> [f64; 2],
) -> Result<Solution, String> {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let mut random = Random::new(draws::seed());
    let drawn = field(d.space.nodes().len(), &mut random);
    let values = d.space.nodes().iter().zip(drawn).map(|(&x, v)| u(x, v)).collect();
    Ok(Solution::new(&d, Evaluated::new(&d, values), unsolved()))
}

fn unequal() -> Result<Problem, String> {
    let mesh = sharpness::moved([3, 2], 5)?;
    let held = Condition::Displacement([0, 1].map(|_| Some(constant(0.0))));
    let floor = Condition::Contact { gap: constant(0.0) };
    let conditions = [("top", held), ("bottom", floor)];
    Ok(Problem::new(
        mesh,
        Material::lame(1.5, 1.0, Plane::Strain),
        [constant(0.0), constant(0.0)],
        conditions.map(|(name, condition)| (name.to_owned(), condition)).into(),
    ))
}

/// The stresses at the nodes: for P1 the means of those of the triangles around a node by their areas, or `plain` ones; for P2
/// those of a quadratic displacement, which has the same on all triangles.
pub(super) fn nodal_stresses(plain: bool) -> Outcome {
    let problem = unequal()?;
    let solution = anything(Degree::One, &problem, |_, drawn| drawn)?;
    let mut sums = vec![([0.0; 4], 0.0); solution.nodes.len()];
    for (t, (nodes, (stress, zz))) in solution.elements.chunks(3).zip(&solution.stress).enumerate()
    {
        let weight = if plain { 1.0 } else { problem.mesh.triangle(t).double_area() };
        let [xx, yy, xy] = stress.components();
        for &node in nodes {
            let (sum, weights) = &mut sums[node];
            for (sum, s) in sum.iter_mut().zip([xx, yy, *zz, xy]) {
                *sum += weight * s;
            }
            *weights += weight;
        }
    }
    let found = solution.nodal_stresses(&problem);
    let largest = found.as_flattened().iter().fold(0.0, |m: f64, s| m.max(s.abs()));
    for (found, (sum, weight)) in found.iter().zip(&sums) {
        for (found, sum) in found.iter().zip(sum) {
            if !((found - sum / weight).abs() <= 1e-13 * largest) {
                return Err(format!("P1: {found}, not {}", sum / weight));
            }
        }
    }
    // u = (x^2 + y, x y): eps = (2 x, x, (1 + y)/2), sigma = 1.5 tr eps + 2 eps, sigma_zz = 1.5 tr eps.
    let solution = anything(Degree::Two, &problem, |[x, y], _| [x * x + y, x * y])?;
    for (found, [x, y]) in solution.nodal_stresses(&problem).iter().zip(&solution.nodes) {
        let trace = 1.5 * 3.0 * x;
        let expected = [trace + 4.0 * x, trace + 2.0 * x, trace, 1.0 + y];
        if found.iter().zip(expected).any(|(f, e)| !((f - e).abs() <= 1e-12)) {
            return Err(format!("P2, at ({x}, {y}): {found:?}, not {expected:?}"));
        }
    }
    Ok(format!("{} nodes for P1, {} for P2", sums.len(), solution.nodes.len()))
}

/// At points of triangles a displacement that is moved at the nodes by no more than is said there moves by no more than
/// `displacement_error_at` says, times `share`; and by that much where each node moves as the sign of its shape function has it.
pub(super) fn errors_at_points(share: f64) -> Outcome {
    let problem = unequal()?;
    let mut count = 0;
    for degree in [1, 2] {
        let of = |u: &dyn Fn([f64; 2], [f64; 2]) -> [f64; 2]| match degree {
            1 => anything(Degree::One, &problem, u),
            _ => anything(Degree::Two, &problem, u),
        };
        let solution = of(&|_, drawn| drawn)?;
        // The nodes by their places.
        let most = |[x, y]: [f64; 2]| 1e-3 * (1.0 + x * x + y);
        let nodes: Vec<f64> = solution.nodes.iter().map(|&x| most(x)).collect();
        for l in [[0.2, 0.3, 0.5], [0.7, 0.1, 0.2], [0.05, 0.9, 0.05]] {
            for t in 0..problem.mesh.triangles().len() {
                let told = share * solution.displacement_error_at(&nodes, t, l);
                let mut moved = solution.clone();
                let own = &solution.elements[t * solution.nodes_per_triangle..];
                for &node in &own[..solution.nodes_per_triangle] {
                    let mut bump = solution.clone();
                    bump.displacement.iter_mut().for_each(|u| *u = [0.0; 2]);
                    bump.displacement[node][0] = 1.0;
                    let shape = bump.displacement_at(t, l)[0];
                    moved.displacement[node][0] += nodes[node] * shape.signum();
                }
                let by = moved.displacement_at(t, l)[0] - solution.displacement_at(t, l)[0];
                if !(by <= told && told <= by + 1e-12) {
                    return Err(format!("P{degree}, triangle {t}: moved by {by:e}, told {told:e}"));
                }
                count += 1;
            }
        }
    }
    Ok(format!("{count} points, P1 and P2"))
}
