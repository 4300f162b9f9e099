//! What is computed from a displacement, for any displacement: von Mises stresses, strains, penetration, stretches of contact,
//! energies, magnitudes, recovered pressures, stresses at nodes.

use std::collections::BTreeMap;

use approx::{abs_diff_eq, relative_eq};
use signorini::contact::{Discretization, Piece};
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Mesh, Problem, Rectangle};
use signorini::results::{ContactBoundary, EnergyBalance, Solution};
use signorini::solve::{Method, discretize};
use study::unsolved;

use super::bodies::on_bodies;
use super::{Outcome, field, for_all, properties, text};
use crate::common::{moved_to, unit_material};

/// The von Mises stress of a mean stress by its principal stresses, sigma_zz from Hooke's law; `plane` may be a mistake.
fn von_mises(material: &Material<f64>, plane: Plane, [xx, yy, xy]: [f64; 3]) -> f64 {
    let (middle, radius) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    let nu = material.lambda() / (2.0 * (material.lambda() + material.mu()));
    let zz = if plane == Plane::Strain { nu * (xx + yy) } else { 0.0 };
    let principal = [middle + radius, middle - radius, zz];
    let [a, b, c] = [0, 1, 2].map(|i| principal[i] - principal[(i + 1) % 3]);
    ((a * a + b * b + c * c) / 2.0).sqrt()
}

/// What is reported of a random displacement; `plane` as above.
fn stresses_on(degree: Degree, problem: &Problem, plane: Option<Plane>) -> Result<(), String> {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    for_all(4, field(d.space.nodes().len()), |u| stresses_of(&d, u, plane))
}

fn stresses_of(d: &Discretization, u: Vec<[f64; 2]>, plane: Option<Plane>) -> Outcome {
    let (degree, problem) = (d.space.degree(), d.problem);
    let solution = unsolved(d, u.clone());
    // Some ten roundings.
    let near = |found: f64, expected: f64| relative_eq!(found, expected, max_relative = 1e-13);
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
    let strain = (0..solution.stress.len()).map(|t| mean_strain(d, t, &u)).fold(0.0, f64::max);
    if !abs_diff_eq!(solution.largest_strain, strain, epsilon = 1e-12 * strain) {
        return Err(format!("largest strain {}, expected {strain}", solution.largest_strain));
    }
    for part in &solution.boundaries {
        let edges = solution.contact.iter().filter(|edge| *edge.boundary == *part.boundary);
        // At the nodes of each edge, and for P2 at 1000 places of the parabola through these.
        let depths = edges.flat_map(|edge| {
            let at_nodes = edge.points.iter().map(|point| (point.u_n - point.gap, point.place));
            let mut depths: Vec<(f64, [f64; 2])> = at_nodes.collect();
            if let [start, middle, end] = depths[..] {
                depths.extend((1..1000).map(|k| f64::from(k) / 1000.0).map(|s| {
                    let depth = degree.value_at(&[start.0, end.0, middle.0], s);
                    (depth, [0, 1].map(|c| (1.0 - s) * start.1[c] + s * end.1[c]))
                }));
            }
            depths
        });
        let none = (f64::NEG_INFINITY, [0.0; 2]);
        let deepest = depths.fold(none, |most, found| if found.0 > most.0 { found } else { most });
        let told = (part.penetration, part.penetration_at);
        // The places of P2 are 1/1000 apart, and a parabola is flat at its vertex.
        let size = deepest.0.abs().max(1e-300);
        if told.0 < deepest.0 || told.0 > deepest.0 + 1e-5 * size && degree == Degree::Two {
            return Err(format!("a penetration of {told:?}, by its places {deepest:?}"));
        }
        if degree == Degree::One && told != deepest {
            return Err(format!("a penetration of {told:?}, at the nodes {deepest:?}"));
        }
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
        if !abs_diff_eq!(force, part.force, epsilon = 1e-12 * part.force) {
            return Err(format!("a recovered force of {force:e}, a force of {:e}", part.force));
        }
    }
    for part in &solution.boundaries {
        // Where P > 0, counted at 1000 places of each edge: of two roots each costs one of them.
        let lines = d.contact.iter().filter(|line| **line.boundary() == *part.boundary);
        let [counted, whole] = lines.fold([0.0; 2], |[counted, whole], line| {
            let p = line.p(&u);
            let places = (0..1000).map(|k| (f64::from(k) + 0.5) / 1000.0);
            let pressed = places.filter(|&s| line.degree.value_at(&p, s) > 0.0).count();
            [counted + line.length * pressed as f64 / 1000.0, whole + line.length]
        });
        if !abs_diff_eq!(counted, part.length, epsilon = 2e-3 * whole) {
            return Err(format!("a contact length of {}, counted {counted}", part.length));
        }
    }
    // Pressed on all edges, too, where a stretch goes on from one to the next.
    let down: Vec<[f64; 2]> = u.iter().map(|[x, y]| [*x, y - 1e3]).collect();
    for u in [&u, &down] {
        let solution = unsolved(d, u.clone());
        for part in &solution.boundaries {
            stretches_are_those_of_contact(d, u, &solution, part)?;
        }
    }
    let EnergyBalance { strain, loads, supports, contact, imbalance, .. } = solution.balance;
    let largest = [strain, loads, supports, contact].map(f64::abs).into_iter().fold(0.0, f64::max);
    let expected = (strain - loads - supports - contact) / largest;
    if !abs_diff_eq!(imbalance, expected, epsilon = 1e-13) {
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
        all.filter(|(line, _)| **line.boundary() == *part.boundary)
    };
    let ends =
        |line: &Piece| d.space.mesh().ends(line.edge()).map(|v| d.space.mesh().vertices()[v]);
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
    if !(abs_diff_eq!(together, part.length, epsilon = 1e-12 * whole) && apart) {
        return Err(format!("stretches {stretches:?}, {} long", part.length));
    }
    for (line, told) in edges() {
        let p = line.p(u);
        for s in (0..100).map(|k| (f64::from(k) + 0.5) / 100.0) {
            let place = told.points[0].arc + s * line.length;
            let inside = stretches.iter().any(|&[from, to]| from <= place && place <= to);
            let pressed = line.degree.value_at(&p, s);
            let size = p.iter().map(|p| p.abs()).fold(0.0, f64::max);
            if inside != (pressed > 0.0) && pressed.abs() > 1e-9 * size {
                return Err(format!("P = {pressed:e} at arc length {place}, of {stretches:?}"));
            }
        }
    }
    Ok(())
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

fn stresses(plane: Option<Plane>) -> Outcome {
    on_bodies(|problem, degree| stresses_on(degree, problem, plane))
}

/// Products of norms are no larger than this many times the products that were added up.
const COARSE: f64 = 60.0;

/// The magnitudes that come with a functional, times `scale`: those of a(u, .) are at least sum_j |a(N_j, N_i)| |u_j|, and at
/// most `COARSE` times that; and each part that is added, loads, stress product and contact, adds at least its size.
fn magnitudes_on(degree: Degree, problem: &Problem, scale: f64) -> Outcome {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let nodes = d.space.nodes().len();
    for_all(1, field(nodes), |u| magnitudes_of(&d, &u, scale))
}

fn magnitudes_of(d: &Discretization, u: &[[f64; 2]], scale: f64) -> Outcome {
    let nodes = u.len();
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
    let [inner, linear, whole] = [d.internal_forces(u), d.linear_residual(u), d.residual(u)];
    for node in 0..nodes {
        for c in 0..2 {
            let sizes = [&inner, &linear, &whole].map(|f| scale * f.magnitudes[node][c]);
            let values = [&inner, &linear, &whole].map(|f| f.values[node][c]);
            let room = 1.0 + 1e-12;
            let ratio = scale * one_by_one[node][c] / least[node][c];
            // Differences of sums that are rounded, each to a roundoff of itself.
            let added = |from: usize, to: usize| {
                let rounding = 8.0 * f64::EPSILON * sizes[to];
                abs_diff_eq!(
                    values[to],
                    values[from],
                    epsilon = (sizes[to] - sizes[from]) * room + rounding
                )
            };
            let whole =
                sizes[0] >= scale * values[0].abs() && sizes[0] <= one_by_one[node][c] * room;
            if !(ratio * room >= 1.0 && ratio <= COARSE && whole && added(0, 1) && added(1, 2)) {
                return Err(format!("node {node}: {sizes:?} for {values:?}, a(u, .) {ratio:.2}"));
            }
        }
    }
    Ok(())
}

fn magnitudes(scale: f64) -> Outcome {
    on_bodies(|problem, degree| magnitudes_on(degree, problem, scale))
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
    let touching = Condition::contact(|_| 0.0);
    Ok(Problem::of(mesh.map_err(text)?, unit_material())
        .with("around", touching)
        .with("top", Condition::clamped()))
}

/// Places on an edge, for sums in place of integrals.
const PLACES: i32 = 4000;

/// A place on the contact line in bits, with the side that it is on; by the side, or `across` corners.
type Key = ([u64; 2], [u64; 2]);

/// The recovered pressures of a random displacement by their definition: the means of -lambda^h by the hats at each place, over
/// the edges there with the same normal.
fn recovered(degree: Degree, across: bool) -> Outcome {
    let problem = cornered()?;
    let d = discretize(&problem, &Method { degree, ..Method::default() }).map_err(text)?;
    for_all(1, field(d.space.nodes().len()), |u| recovered_from(&d, u, across))
}

fn recovered_from(d: &Discretization, u: Vec<[f64; 2]>, across: bool) -> Outcome {
    let degree = d.space.degree();
    let solution = unsolved(d, u.clone());
    let key = |place: [f64; 2], normal: [f64; 2]| -> Key {
        let side = if across { [0.0; 2] } else { normal };
        (place.map(f64::to_bits), side.map(|n| n.round().to_bits()))
    };
    let mut means: BTreeMap<Key, [f64; 2]> = BTreeMap::new();
    let keys: Vec<Vec<Key>> = d
        .contact
        .iter()
        .map(|line| {
            let nodes = d.space.edge_nodes(line.edge());
            nodes.map(|node| key(d.space.nodes()[node], line.normal().into())).collect()
        })
        .collect();
    for (line, keys) in d.contact.iter().zip(&keys) {
        let p = line.p(&u);
        for k in 0..PLACES {
            let s = (f64::from(k) + 0.5) / f64::from(PLACES);
            let pressure = line.degree.value_at(&p, s).max(0.0) / line.gamma;
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
    for (edge, keys) in solution.contact.iter().zip(&keys) {
        // The points are in the order along the edge: start, middle, end.
        let order: &[usize] = if degree == Degree::One { &[0, 1] } else { &[0, 2, 1] };
        for (point, &a) in edge.points.iter().zip(order) {
            let [work, weight] = means[&keys[a]];
            // Sums over places: 1/PLACES^2, and 1/PLACES where P is cut.
            if !abs_diff_eq!(point.pressure, work / weight, epsilon = 1e-3 * largest) {
                return Err(format!(
                    "{} is reported, the mean is {}",
                    point.pressure,
                    work / weight
                ));
            }
        }
    }
    Ok(())
}

/// A displacement as a solution.
fn anything(
    degree: Degree,
    problem: &Problem,
    u: impl Fn(usize, [f64; 2]) -> [f64; 2],
) -> Result<Solution, String> {
    let d = discretize(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let values = d.space.nodes().iter().enumerate().map(|(node, &x)| u(node, x)).collect();
    Ok(unsolved(&d, values))
}

fn unequal() -> Result<Problem, String> {
    let cells = Rectangle { width: 3.0, height: 2.0, nx: 3, ny: 2, diagonal: Diagonal::Right };
    let floor = Condition::contact(|_| 0.0);
    Ok(Problem::of(cells.perturbed(0.2, 5).map_err(text)?, Material::lame(1.5, 1.0, Plane::Strain))
        .with("top", Condition::clamped())
        .with("bottom", floor))
}

/// The stresses at the nodes: for P1 the means of those of the triangles around a node by their areas, or `plain` ones; for P2
/// those of a quadratic displacement, which has the same on all triangles.
fn nodal_stresses(plain: bool) -> Outcome {
    let problem = unequal()?;
    for_all(3, field(problem.mesh.vertices().len()), |u| means_by_areas(&problem, &u, plain))?;
    // u = (x^2 + y, x y): eps = (2 x, x, (1 + y)/2), sigma = 1.5 tr eps + 2 eps, sigma_zz = 1.5 tr eps.
    let solution = anything(Degree::Two, &problem, |_, [x, y]| [x * x + y, x * y])?;
    for (found, [x, y]) in solution.nodal_stresses(&problem).iter().zip(&solution.nodes) {
        let trace = 1.5 * 3.0 * x;
        let expected = [trace + 4.0 * x, trace + 2.0 * x, trace, 1.0 + y];
        if !abs_diff_eq!(found[..], expected[..], epsilon = 1e-12) {
            return Err(format!("P2, at ({x}, {y}): {found:?}, not {expected:?}"));
        }
    }
    Ok(())
}

fn means_by_areas(problem: &Problem, u: &[[f64; 2]], plain: bool) -> Outcome {
    let solution = anything(Degree::One, problem, |node, _| u[node])?;
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
    let found = solution.nodal_stresses(problem);
    let largest = found.as_flattened().iter().fold(0.0, |m: f64, s| m.max(s.abs()));
    for (found, (sum, weight)) in found.iter().zip(&sums) {
        for (found, sum) in found.iter().zip(sum) {
            if !abs_diff_eq!(*found, sum / weight, epsilon = 1e-13 * largest) {
                return Err(format!("P1: {found}, not {}", sum / weight));
            }
        }
    }
    Ok(())
}

/// Where the displacement is off at one node, it is off at a place in a triangle by no more than is said, times `share`: shape functions of
/// P2 are negative in part.
fn between_nodes(share: f64) -> Outcome {
    let problem = unequal()?;
    for degree in [Degree::One, Degree::Two] {
        let nodes = anything(degree, &problem, |_, x| x)?.nodes.len();
        let place = (0..problem.mesh.triangles().len(), 0.0..1.0, 0.0..1.0);
        for_all(200, (place, 0..nodes), |((t, a, b), node)| {
            let l = [a * b, a * (1.0 - b), 1.0 - a];
            let at = |off: f64| -> Result<f64, String> {
                let of = |n: usize, [x, _]: [f64; 2]| [if n == node { x + off } else { x }, 0.0];
                Ok(anything(degree, &problem, of)?.displacement_at(t, l)[0])
            };
            let mut errors = vec![0.0; nodes];
            errors[node] = 0.1;
            let solution = anything(degree, &problem, |_, x| x)?;
            let told = share * solution.displacement_error_at(&errors, t, l);
            let off = (at(0.1)? - at(0.0)?).abs();
            // Rounding of a displacement of 3 in a difference.
            if off <= told + 1e-14 {
                Ok(())
            } else {
                Err(format!("off by {off:e}, {told:e} was told"))
            }
        })?;
    }
    Ok(())
}

/// The largest strain of a ring that is widened by 0.1 all through is its hoop strain: 0.1 over the mean radius of the innermost triangle,
/// where `least` is that of the inner boundary.
fn widened(least: f64) -> Outcome {
    let cells = Rectangle { width: 1.0, height: 1.0, nx: 4, ny: 2, diagonal: Diagonal::Right };
    let ring = moved_to(&cells.mesh().map_err(text)?, |[x, y]| [x + 1.0, y]);
    let problem = Problem::of(ring, Material::lame(1.5, 1.0, Plane::Axisymmetric))
        .with("top", Condition::clamped())
        .with("bottom", Condition::contact(|_| 0.0));
    let solution = anything(Degree::One, &problem, |_, _| [0.1, 0.0])?;
    let expected = 0.1 / (least + 0.25 / 3.0);
    if relative_eq!(solution.largest_strain, expected, max_relative = 1e-13) {
        Ok(())
    } else {
        Err(format!("{}, expected {expected}", solution.largest_strain))
    }
}

properties! {
    displacements_between_nodes_are_off_by_no_more_than_is_said: between_nodes(1.0); not between_nodes(0.5);
    the_hoop_strain_may_be_the_largest: widened(1.0); not widened(1.01);
    von_mises_stresses_and_the_largest_displacement_are_their_definitions: stresses(None);
        not stresses(Some(Plane::Stress));
    magnitudes_of_a_residual_are_those_of_its_terms: magnitudes(1.0); not magnitudes(0.01);
    recovered_pressures_are_means_on_one_side_of_a_corner: recovered(Degree::One, false), recovered(Degree::Two, false);
        not recovered(Degree::One, true), recovered(Degree::Two, true);
    nodal_stresses_are_means_by_areas: nodal_stresses(false); not nodal_stresses(true);
}
