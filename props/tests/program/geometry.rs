//! Where contact acts and what the solver proves with: obstacles, the smooth boundary behind facets, the limit of gamma0 that
//! is printed, Korn's constants of the enclosure, and the factor in numbers of twice the precision.

use std::sync::Arc;

use approx::abs_diff_eq;
use proptest::prelude::*;
use signorini::kernel::{Material, Plane};
use signorini::linear::factor::Factor;
use signorini::linear::matrix;
use signorini::linear::matrix::Neighbours;
use signorini::linear::system::System;
use signorini::model::Degree;
use signorini::model::boundary_normals::SmoothBoundary;
use signorini::model::{Diagonal, Distance, Function, Mesh, Obstacle, Problem, Rectangle, Side};
use signorini::nalgebra::Vector2;
use signorini::proof::korn::Korn;
use signorini::solve::{Method, discretize_any};

use props::claim::{Outcome, noticed, text};
use props::problems::mesh;
use props::verdict::Verdict;
use props::{draws, ensure, sharpness};

/// `factor` times the distance from a circle, whose gradient has the length `factor`.
struct Round {
    center: [f64; 2],
    radius: f64,
    factor: f64,
}

impl Function for Round {
    fn at(&self, x: [f64; 2]) -> f64 {
        self.factor * ((x[0] - self.center[0]).hypot(x[1] - self.center[1]) - self.radius)
    }
}

impl Distance for Round {
    fn gradient(&self, x: [f64; 2]) -> [f64; 2] {
        let [p, q] = [x[0] - self.center[0], x[1] - self.center[1]];
        [p, q].map(|c| self.factor * c / p.hypot(q))
    }
}

/// Centre, radius, the place of the body by its distance from the centre and its angle, and a factor.
type Seen = ([f64; 2], f64, f64, f64, f64);

/// Gap and direction of each kind of obstacle: x + g n~ lies on it, |n~| = 1, and one step back along n~ the gap is larger by as
/// much; `turn` is the sign of n~.
fn obstacle(&(center, radius, away, angle, factor): &Seen, turn: f64) -> Verdict {
    let unit = [angle.cos(), angle.sin()];
    let x = [0, 1].map(|c| center[c] + away * unit[c]);
    let round = |factor: f64| Obstacle::Distance(Arc::new(Round { center, radius, factor }));
    let side = if away > radius { Side::Outside } else { Side::Inside };
    let plane = Obstacle::Plane { point: center, normal: unit };
    let circle = Obstacle::Circle { center, radius, side };
    let size = 1.0 + away + radius + center[0].abs() + center[1].abs();
    let near = |a: f64, b: f64| abs_diff_eq!(a, b, epsilon = 1e-13 * size);
    let from_centre = |x: [f64; 2]| (x[0] - center[0]).hypot(x[1] - center[1]);
    for (kind, obstacle) in [plane, circle, round(factor)].into_iter().enumerate() {
        let Ok(seen) = obstacle.closest(x, String::new) else {
            return Verdict::Fails("the body sees the obstacle");
        };
        let n = [turn * seen.direction[0], turn * seen.direction[1]];
        ensure!(near(n[0].hypot(n[1]), 1.0));
        let on = [0, 1].map(|c| x[c] + seen.gap * n[c]);
        if kind == 0 {
            ensure!(near((on[0] - center[0]) * unit[0] + (on[1] - center[1]) * unit[1], 0.0));
        } else {
            ensure!(near(from_centre(on), radius));
        }
        let step = 0.25 * (away - radius).abs().min(away);
        let back = [0, 1].map(|c| x[c] - step * n[c]);
        let Ok(behind) = obstacle.closest(back, String::new) else {
            return Verdict::Fails("the body sees the obstacle one step back");
        };
        ensure!(near(behind.gap, seen.gap + step));
    }
    for off in [1.0 - 1.2 * MOST_OFF, 1.0 + 1.2 * MOST_OFF, 0.5, 2.0] {
        ensure!(round(off).closest(x, String::new).is_err());
    }
    ensure!(Obstacle::Circle { center, radius, side }.closest(center, String::new).is_err());
    Verdict::Holds(if side == Side::Outside { "outside" } else { "inside" })
}

/// What the length of the gradient of an obstacle's distance may be off by, at most.
const MOST_OFF: f64 = 0.1;

fn places() -> impl Strategy<Value = Seen> {
    let factor = 1.0 - 0.9 * MOST_OFF..1.0 + 0.9 * MOST_OFF;
    ([-2.0_f64..2.0, -2.0_f64..2.0], 0.5_f64..3.0, 0.2_f64..1.8, 0.0_f64..6.25, factor).prop_map(
        |(center, radius, share, angle, factor)| {
            let share = if abs_diff_eq!(share, 1.0, epsilon = 0.05) { 1.2 } else { share };
            (center, radius, share * radius, angle, factor)
        },
    )
}

/// obstacles.
pub fn obstacles_are_their_definitions() -> Outcome {
    draws::hold(500, places(), &["outside", "inside"], |draw| obstacle(draw, 1.0))
}

/// Directions away from the obstacle.
pub fn directions_away_from_the_obstacle() -> Outcome {
    draws::reject(places(), |draw| obstacle(draw, -1.0))
}

/// On a circle with unequal facets of up to 35 degrees, or on an arc of it between two corners, the normals at the vertices and
/// the middles of the curves are those of the circle; `facets`: with the facet's middle in place of the curve's.
fn circle(angles: &[f64], facets: bool) -> Verdict {
    on_circle(angles, None, facets)
        .and_then(|()| on_circle(angles, Some(1.5), facets))
        .map_or_else(Verdict::Fails, |()| Verdict::Holds("always"))
}

/// On the whole circle, or on an arc that spans this angle.
fn on_circle(angles: &[f64], arc: Option<f64>, facets: bool) -> Result<(), &'static str> {
    let mut at = vec![0.0];
    let total: f64 = angles.iter().sum();
    for a in angles {
        at.push(at[at.len() - 1] + a / total * arc.unwrap_or(std::f64::consts::TAU));
    }
    if arc.is_none() {
        at.pop();
    }
    let mut vertices = vec![[0.0, 0.0]];
    vertices.extend(at.iter().map(|a| [2.0 * a.cos(), 2.0 * a.sin()]));
    let n = at.len();
    let triangles = (0..angles.len()).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
    let mesh = Mesh::new(vertices, triangles, []).map_err(|_| "a mesh")?;
    let smooth = SmoothBoundary::new(&mesh);
    for &edge in mesh.outline().iter().filter(|edge| !mesh.ends(**edge).contains(&0)) {
        let points = smooth.along(&mesh, edge).ok_or("a curve")?;
        for (k, point) in points.into_iter().enumerate() {
            let [p, q] = if facets && k == 2 {
                let [a, b] = mesh.ends(edge).map(|v| mesh.vertices()[v]);
                [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]
            } else {
                point.place
            };
            if !abs_diff_eq!(p.hypot(q), 2.0, epsilon = 1e-13) {
                return Err("the middle is on the circle");
            }
            if !((point.normal[0] - p / 2.0).hypot(point.normal[1] - q / 2.0) <= 1e-12) {
                return Err("the normal is that of the circle");
            }
        }
    }
    Ok(())
}

fn facets() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.5_f64..1.0, 20..40)
}

/// the smooth boundary.
pub fn smooth_boundaries_are_exact_on_circles() -> Outcome {
    draws::hold(50, facets(), &["always"], |angles| circle(angles, false))
}

/// The middles of the facets.
pub fn middles_of_facets_for_those_of_the_curves() -> Outcome {
    draws::reject(facets(), |angles| circle(angles, true))
}

/// On an ellipse, where an edge has another bend at each end: the cubic with the tangents at the ends, as fast as to go through
/// the middle that is given, has the normal that is given there; `facets`: with the facet's normal in place of it.
fn ellipse(angles: &[f64], facets: bool) -> Verdict {
    let n = angles.len();
    let total: f64 = angles.iter().sum();
    let (mut vertices, mut sum) = (vec![[0.0, 0.0]], 0.0);
    for a in angles {
        vertices.push([2.0 * f64::cos(sum), 1.6 * f64::sin(sum)]);
        sum += a / total * std::f64::consts::TAU;
    }
    let triangles = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
    let Ok(mesh) = Mesh::new(vertices, triangles, []) else { return Verdict::Fails("a mesh") };
    let smooth = SmoothBoundary::new(&mesh);
    for &edge in mesh.outline() {
        let Some([start, end, middle]) = smooth.along(&mesh, edge) else {
            return Verdict::Fails("a curve");
        };
        let tangent = |normal: Vector2<f64>| Vector2::new(-normal.y, normal.x);
        let (t, s) = (tangent(start.normal), tangent(end.normal));
        let [a, b, m] = [start, end, middle].map(|point| Vector2::from(point.place));
        let (chord, bulge) = (b - a, m - (a + b) / 2.0);
        let speed = 8.0 * bulge.dot(&(t - s)) / (t - s).dot(&(t - s));
        let along = chord * 1.5 - (t + s) * (speed / 4.0);
        let (_, facet) = mesh.length_and_normal(edge);
        let normal = if facets { facet } else { middle.normal };
        ensure!(normal.dot(&along).abs() <= 1e-10 * along.dot(&along).sqrt());
        ensure!(abs_diff_eq!(normal.dot(&normal), 1.0, epsilon = 1e-14));
    }
    Verdict::Holds("always")
}

/// the smooth boundary where bends differ.
pub fn middles_of_smooth_boundaries_have_the_normals_of_their_curves() -> Outcome {
    draws::hold(50, facets(), &["always"], |angles| ellipse(angles, false))
}

/// The normals of the facets.
pub fn normals_of_facets_for_those_of_the_curves() -> Outcome {
    draws::reject(facets(), |angles| ellipse(angles, true))
}

/// |v(x)| at each node is at most its constant times |v|_a: the largest such v by the inverse of the stiffness matrix. The
/// constants are divided by `by`.
fn korn_on(degree: Degree, problem: &Problem, by: f64) -> Result<f64, String> {
    let method = Method { degree, ..Method::default() };
    let d = discretize_any(problem, &method).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let neighbours = Neighbours::new(&d.space);
    let stiffness = matrix::assemble_stiffness(&d, &system.numbering, &neighbours).map_err(text)?;
    let factor = Factor::new(&stiffness).map_err(text)?;
    let korn = Korn::new(&d.space, &problem.material, &d.constraints, &[]).ok_or("not held")?;
    let mut least = f64::INFINITY;
    for (numbers, constant) in system.numbering.of.iter().zip(&korn.nodes) {
        for number in numbers.iter().flatten() {
            let mut unit = vec![0.0; system.numbering.count];
            unit[*number] = 1.0;
            factor.forward(&mut unit);
            let largest = unit.iter().map(|x| x * x).sum::<f64>().sqrt();
            let ratio = constant / by / largest;
            if !(ratio >= 1.0 - 1e-9) {
                return Err(format!(
                    "a node moves by {largest}, at most {} is said",
                    constant / by
                ));
            }
            least = least.min(ratio);
        }
    }
    Ok(least)
}

pub fn korn(by: f64) -> Outcome {
    let strain = || Material::lame(1.0, 1.0, Plane::Strain);
    let mut bodies: Vec<Problem> =
        super::sharpness::small_bodies()?.into_iter().map(|body| body.problem).collect();
    let beam = Rectangle { width: 24.0, height: 1.0, nx: 24, ny: 1, diagonal: Diagonal::Right };
    bodies.push(sharpness::clamped(beam.mesh().map_err(text)?, strain(), &["left"]));
    let sides = [("top", [1, 2]), ("bottom", [0, 1])];
    let tall = mesh(vec![[0.0, 0.0], [0.3, 4.0], [-0.3, 4.0]], vec![[0, 1, 2]], sides)?;
    bodies.push(sharpness::clamped(tall, strain(), &["top"]));
    // Far from its support a slender body moves much further than one of its triangles lets it, and so does a soft one.
    let long = Rectangle { width: 512.0, height: 1.0, nx: 512, ny: 1, diagonal: Diagonal::Right };
    bodies.push(sharpness::clamped(long.mesh().map_err(text)?, strain(), &["left"]));
    let soft = Rectangle { width: 2.0, height: 1.0, nx: 2, ny: 1, diagonal: Diagonal::Right };
    let soft = soft.mesh().map_err(text)?;
    bodies.push(sharpness::clamped(soft, Material::lame(1e-8, 1e-8, Plane::Strain), &["left"]));
    let mut least = f64::INFINITY;
    for problem in &bodies {
        least = least.min(korn_on(Degree::One, problem, by)?);
        least = least.min(korn_on(Degree::Two, problem, by)?);
    }
    Ok(format!("{} bodies, P1 and P2; at least {least:.2} times what is attained", bodies.len()))
}

checks! {
    gaps_and_directions_of_obstacles_are_their_definitions => obstacles_are_their_definitions();
    the_smooth_boundary_of_a_circle_is_the_circle => smooth_boundaries_are_exact_on_circles();
    middles_of_smooth_boundaries_have_the_normals_of_their_curves => middles_of_smooth_boundaries_have_the_normals_of_their_curves();
    control_normals_of_facets_for_those_of_the_curves => normals_of_facets_for_those_of_the_curves();
    control_directions_away_from_the_obstacle => directions_away_from_the_obstacle();
    control_middles_of_facets_for_those_of_the_curves => middles_of_facets_for_those_of_the_curves();
    nodes_move_no_further_than_korns_constants_say => korn(1.0);
    control_korns_constants_a_twentieth_as_large => noticed(korn(20.0));
}
