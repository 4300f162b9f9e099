//! What is reported where the definitions leave a choice, or have a corner:
//!
//! - of all solutions of a body that slides along its obstacle, the one of least norm is given;
//! - the recovered pressure is a mean over the edges at a node on one side of a corner only;
//! - what is given in other units has the same solution, bit for bit where the units are powers of two.

use std::collections::BTreeMap;
use std::sync::Arc;

use signorini::fem::{Condition, Diagonal, Mesh, Problem, Rectangle, SharedFunction};
use signorini::kernel::edge_integral::{ExactEdge, value_at};
use signorini::kernel::{Material, P1, P2, Plane};
use signorini::solve::evaluated::Evaluated;
use signorini::solve::{Degree, Method, Settings, Solution, SolveError, discretize, solve};

use super::assembled::solver::unsolved;
use super::honesty::field;
use crate::claim::{Outcome, noticed, text};
use crate::proof::sampler::Random;
use crate::{draws, sharpness};

fn constant(value: f64) -> SharedFunction {
    Arc::new(move |_: [f64; 2]| value)
}

/// A block of 3 x 2 on its floor, turned by `angle`, pressed down by its weight and more of it to the right.
fn sliding(angle: f64) -> Result<Problem, String> {
    let cells = Rectangle { width: 3.0, height: 2.0, nx: 3, ny: 2, diagonal: Diagonal::Right };
    let mesh = cells.mesh().map_err(text)?;
    let (sin, cos) = angle.sin_cos();
    let turned = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
    let vertices = mesh.vertices().iter().map(|&x| turned(x)).collect();
    let mut named = Vec::new();
    for name in mesh.boundary_names() {
        let edges = mesh.edges_of(name).map_err(text)?.iter().map(|&edge| mesh.ends(edge));
        named.push((name.to_owned(), edges.collect::<Vec<_>>()));
    }
    let mesh = Mesh::new(vertices, mesh.triangles().to_vec(), named).map_err(text)?;
    let pressure = move |[x, y]: [f64; 2]| 1.0 + 0.3 * (cos * x + sin * y);
    let conditions = [
        ("bottom", Condition::Contact { gap: constant(0.01) }),
        ("top", Condition::Pressure(Arc::new(pressure))),
    ];
    Ok(Problem::new(
        mesh,
        Material::lame(1.5, 1.0, Plane::Strain),
        turned([0.0, -0.1]).map(constant),
        conditions.map(|(name, condition)| (name.to_owned(), condition)).into(),
    ))
}

/// The mean of the nodal displacements along the floor, after a shift by `shift`, is zero.
fn least_norm(shift: f64) -> Outcome {
    for angle in [0.0, 0.5, 2.2] {
        let problem = sliding(angle)?;
        for degree in [Degree::One, Degree::Two] {
            let method = Method { degree, ..Method::default() };
            let (solution, _) = solve(&problem, &method, &Settings::default()).map_err(text)?;
            if solution.method.slides != 1 {
                return Err(format!("it slides along {} motions", solution.method.slides));
            }
            let (sin, cos) = f64::sin_cos(angle);
            let along = solution.displacement.iter().map(|[x, y]| cos * x + sin * y + shift);
            let (sum, size) = along.fold((0.0, 0.0), |(s, m): (f64, f64), a| (s + a, m + a.abs()));
            // The directions of the floor are known to a rounding error of the mesh.
            if !(sum.abs() <= 1e-12 * size && size > 0.0) {
                return Err(format!(
                    "turned by {angle}: {sum:e} of {size:e} is left along the floor"
                ));
            }
        }
    }
    Ok("a block at 3 angles, P1 and P2".to_owned())
}

/// Row 18: bodies that slide.
pub fn of_bodies_that_slide_the_solution_of_least_norm_is_given() -> Outcome {
    least_norm(0.0)
}

/// Another solution.
pub fn a_solution_that_has_slid() -> Outcome {
    noticed(least_norm(1e-6))
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
fn recovered<E, const N: usize, const M: usize>(across: bool) -> Result<usize, String>
where
    E: ExactEdge<f64, N, M>,
{
    let problem = cornered()?;
    let d = discretize::<E, N, M>(&problem, &Method::default()).map_err(text)?;
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
            let nodes = d.space.edge_nodes(line.edge).into_iter().take(M);
            nodes.map(|node| key(d.space.nodes()[node], line.normal.into())).collect()
        })
        .collect();
    for (line, keys) in d.contact.iter().zip(&keys) {
        let p = line.p(&d.space.on_triangle(line.edge.triangle, &u));
        for k in 0..PLACES {
            let s = (f64::from(k) + 0.5) / f64::from(PLACES);
            let pressure = value_at::<E, f64, N, M>(p, s).max(0.0) / line.gamma;
            for (a, key) in keys.iter().enumerate() {
                // Start, end, and for P2 the middle, whose hats are those of half edges.
                let hat = match (M, a) {
                    (2, 0) => 1.0 - s,
                    (2, _) => s,
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
        let order: &[usize] = if M == 2 { &[0, 1] } else { &[0, 2, 1] };
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

fn around_corners(across: bool) -> Outcome {
    let count = recovered::<P1, 3, 2>(across)? + recovered::<P2, 6, 3>(across)?;
    Ok(format!("{count} places on two sides of a corner, P1 and P2"))
}

/// Row 22: each side of a corner has its own mean.
pub fn recovered_pressures_are_means_on_one_side_of_a_corner() -> Outcome {
    around_corners(false)
}

/// Means over both sides.
pub fn means_across_a_corner() -> Outcome {
    noticed(around_corners(true))
}

/// A block that is held on top and pressed on its floor, with a length of 2^`length`, moduli of 2^`modulus` and displacements of
/// 2^`displacement`.
fn in_units(
    degree: Degree,
    plane: Plane,
    [length, modulus, displacement]: [i32; 3],
) -> Result<Solution, String> {
    let [l, e, d] = [length, modulus, displacement].map(|k| 2.0_f64.powi(k));
    let cells =
        Rectangle { width: 3.0 * l, height: 2.0 * l, nx: 3, ny: 2, diagonal: Diagonal::Left };
    let held = Condition::Displacement([0.01, -0.05].map(|u| Some(constant(u * d))));
    let gap = move |[x, _]: [f64; 2]| 0.02 * d - 0.01 * (x / l * d);
    let floor = Condition::Contact { gap: Arc::new(gap) };
    let conditions = [("top", held), ("bottom", floor)];
    let problem = Problem::new(
        cells.mesh().map_err(text)?,
        Material::lame(1.5 * e, e, plane),
        [0.05, -0.1].map(|f| constant(f * (e * d) / l / l)),
        conditions.map(|(name, condition)| (name.to_owned(), condition)).into(),
    );
    let method = Method { degree, ..Method::default() };
    solve(&problem, &method, &Settings::default()).map(|(solution, _)| solution).map_err(text)
}

/// Its displacement and the forces on it in these units.
fn values_in_units(degree: Degree, [length, modulus]: [i32; 2]) -> Result<Vec<f64>, String> {
    let solution = in_units(degree, Plane::Stress, [length, modulus, length])?;
    let (l, e) = (2.0_f64.powi(length), 2.0_f64.powi(modulus));
    let displacement = solution.displacement.as_flattened().iter().map(|u| u / l);
    let force = solution.quantities.contact_force / e / l;
    let stresses = solution.von_mises.iter().map(|s| s / e);
    Ok(displacement.chain([force]).chain(stresses).collect())
}

/// Bit for bit in all units, the forces and displacements in units that are off by `off`.
fn units(off: f64) -> Outcome {
    for degree in [Degree::One, Degree::Two] {
        let plain = values_in_units(degree, [0, 0])?;
        for units in [[-30, 0], [30, 0], [0, -30], [0, 30], [-100, 100], [60, -100], [100, 60]] {
            let other = values_in_units(degree, units)?;
            if let Some((a, b)) = plain.iter().zip(&other).find(|(a, b)| **a != off * **b) {
                return Err(format!("length and modulus 2^{units:?}: {b:e}, not {a:e}"));
            }
        }
    }
    Ok("a block in 8 systems of units, P1 and P2".to_owned())
}

/// Row 18: a solution has the same bits in all units that are powers of two.
pub fn solutions_are_the_same_in_all_units() -> Outcome {
    units(1.0)
}

/// To the last bit.
pub fn units_that_are_off_by_a_rounding() -> Outcome {
    noticed(units(1.0 + f64::EPSILON))
}

/// Whether a solid block under this force and with these moduli, powers of two, is refused because its numbers are no doubles.
fn is_out_of_range(force: i32, modulus: i32) -> Result<bool, String> {
    let [f, e] = [force, modulus].map(|k| 2.0_f64.powi(k));
    let cells = Rectangle { width: 3.0, height: 2.0, nx: 3, ny: 2, diagonal: Diagonal::Left };
    let held = Condition::Displacement([0.0; 2].map(|u| Some(constant(u))));
    let conditions = [("top", held), ("bottom", Condition::Contact { gap: constant(0.0) })];
    let problem = Problem::new(
        cells.mesh().map_err(text)?,
        Material::lame(1.5 * e, e, Plane::Strain),
        [0.05, -0.1].map(|x| constant(x * f)),
        conditions.map(|(name, condition)| (name.to_owned(), condition)).into(),
    );
    match solve(&problem, &Method::default(), &Settings::default()) {
        Ok((solution, _)) if solution.displacement.as_flattened().iter().any(|u| u.is_normal()) => {
            Ok(false)
        }
        Ok(_) => {
            Err(format!("no number of 2^{force} over 2^{modulus} is left, and none is missed"))
        }
        Err(SolveError::OutOfRange) => Ok(true),
        Err(other) => Err(other.to_string()),
    }
}

/// A displacement of some 2^-1200, of 2^1200, and, unless `far`, of 2^-400 and 2^400.
fn range(far: bool) -> Outcome {
    for (force, modulus) in [(-600_i32, 600), (600, -600), (-200, 200), (200, -200)] {
        let expected = far || force.abs() > 500;
        if is_out_of_range(force, modulus)? != expected {
            return Err(format!("a force of 2^{force} on moduli of 2^{modulus}"));
        }
    }
    Ok("forces and moduli of 2^-600 to 2^600".to_owned())
}

/// Row 18: numbers that are no doubles.
pub fn solutions_out_of_range_are_refused() -> Outcome {
    range(false)
}

/// Those that are.
pub fn solutions_in_range_refused() -> Outcome {
    noticed(range(true))
}

/// A random displacement of a block of unequal triangles as a solution.
fn anything<E, const N: usize, const M: usize>(
    problem: &Problem,
    u: impl Fn([f64; 2], [f64; 2]) -> [f64; 2],
) -> Result<Solution, String>
where
    E: ExactEdge<f64, N, M>,
{
    let d = discretize::<E, N, M>(problem, &Method::default()).map_err(text)?;
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
fn nodal_stresses(plain: bool) -> Outcome {
    let problem = unequal()?;
    let solution = anything::<P1, 3, 2>(&problem, |_, drawn| drawn)?;
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
    let solution = anything::<P2, 6, 3>(&problem, |[x, y], _| [x * x + y, x * y])?;
    for (found, [x, y]) in solution.nodal_stresses(&problem).iter().zip(&solution.nodes) {
        let trace = 1.5 * 3.0 * x;
        let expected = [trace + 4.0 * x, trace + 2.0 * x, trace, 1.0 + y];
        if found.iter().zip(expected).any(|(f, e)| !((f - e).abs() <= 1e-12)) {
            return Err(format!("P2, at ({x}, {y}): {found:?}, not {expected:?}"));
        }
    }
    Ok(format!("{} nodes for P1, {} for P2", sums.len(), solution.nodes.len()))
}

/// Row 22: stresses at the nodes.
pub fn nodal_stresses_are_means_by_areas() -> Outcome {
    nodal_stresses(false)
}

/// Plain means.
pub fn plain_means_of_stresses() -> Outcome {
    noticed(nodal_stresses(true))
}

/// At points of triangles a displacement that is moved at the nodes by no more than is said there moves by no more than
/// `displacement_error_at` says, times `share`; and by that much where each node moves as the sign of its shape function has it.
fn errors_at_points(share: f64) -> Outcome {
    let problem = unequal()?;
    let mut count = 0;
    for degree in [1, 2] {
        let of = |u: &dyn Fn([f64; 2], [f64; 2]) -> [f64; 2]| match degree {
            1 => anything::<P1, 3, 2>(&problem, u),
            _ => anything::<P2, 6, 3>(&problem, u),
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

/// Row 10: the error of a displacement at a point.
pub fn errors_at_points_are_those_of_the_nodes() -> Outcome {
    errors_at_points(1.0)
}

/// Half of it.
pub fn half_the_error_at_a_point() -> Outcome {
    noticed(errors_at_points(0.5))
}
