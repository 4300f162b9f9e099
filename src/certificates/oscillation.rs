//! Data that a composite stress and an affine displacement can't follow, and what they cost: oscillation terms.
//!
//! The certificate is exact where f is affine, t and u_D are affine on edges and g is affine along Gamma_C. Elsewhere it
//! is a certificate for data f_h, t_h, u_h, g_h near those of the problem, and the bound grows by explicit terms
//! (docs/a-posteriori.md, section 7.4).
//!
//! - **Loads.** f - f_h and t - t_h are orthogonal to affine functions, so rigid motions r may be subtracted:
//!   int_T (f - f_h) . w <= |f - f_h|_T |w - r|_T, and |w - r|_T <= K (h_T / pi) |eps(w)|_T by Payne and Weinberger's
//!   inequality and Korn's, with K^2 = 1 + 2 / beta^2 and the bound of Costabel and Dauge (2015, theorem 2.3) for the
//!   inf-sup constant beta of a domain between two circles of one centre. On an edge, |q|_E^2 <= (|E| / |T|) (|q|^2 + h_T |q|
//!   |grad q|).
//! - **Displacement and gap.** What v lacks on an edge, d(s), is lifted into its triangle, constant along rays from the
//!   opposite vertex but for the factor 1 - l: z = (1 - l) d(s). Its gradient is constant along the rays, and
//!   |z|_a^2 = |T| int sigma(G) : G ds with G(s) = d (x) (-grad l) + d' (x) (grad l_b + s grad l).
//!
//! All integrals above are by quadrature, so a bound that contains one is not rigorous: [`Oscillation::reason`] says so.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::{Matrix2, Vector2};

use super::bubbles;
use super::certificate::{Certificate, Lift, Piece, Role, place};
use super::data::{Data, POINTS, bulge_of, cancellation, demand, is_within, length_and_normal};
use super::parts::{Boundary, ProblemParts};
use crate::kernel::{Ball, Enclosing, Material, Triangle};
use crate::model::material::least_eigenvalue;
use crate::model::mesh::length;
use crate::model::{Condition, Distance, Function, Obstacle, SharedFunction, quadrature};
use crate::quote::quoted;

/// The parts of a problem's data that a certificate leaves out.
#[derive(Clone, Debug)]
pub(super) struct Oscillation {
    /// Why the bound rests on quadrature, if it does.
    pub(crate) reason: Option<String>,
    /// |z|_a of the lifts on the triangles of the mesh where v lacks z.
    pub(crate) lifts: BTreeMap<usize, f64>,
}

impl Oscillation {
    /// `quadratic` tells whether v is, so that it follows data of degree 2.
    pub(crate) fn new(parts: &ProblemParts, quadratic: bool) -> Self {
        let given = given(parts, quadratic);
        let inexact = given.iter().filter_map(|given| {
            let degree = given.degree?;
            let exact = given.functions.iter().all(|f| is_within(f, degree));
            let class = if degree == 2 { "quadratic" } else { "affine" };
            (!exact).then(|| format!("{} is not known to be {class}", given.name))
        });
        let measured = joined(inexact, "; ", |all| {
            format!("{all}: its oscillation is measured by quadrature")
        });
        let class = if quadratic { "affine and quadratic" } else { "affine" };
        let named = on_boundaries(parts.known_at_nodes(quadratic), |all| {
            format!(
                "the problem that is bounded has on {all} a direction and a gap that are {class} between its vertices"
            )
        });
        let cancelled = given.iter().flat_map(|Given { name, functions, vertices, .. }| {
            let places = || vertices.iter().map(|&vertex| parts.mesh.vertices()[vertex]);
            let off = functions.iter().filter_map(move |f| cancellation(f, places()));
            off.map(move |off| {
                format!("{name} is known to within {off:.0e} only, as its terms cancel")
            })
        });
        let cancelled = joined(cancelled, "; ", |all| {
            format!("{all}: the problem that is bounded has what doubles leave")
        });
        let moved = on_boundaries(parts.moved(), |all| {
            format!(
                "nodes that face those of {all} to within a millionth of the longest edge there are taken to do so exactly"
            )
        });
        let rough = on_boundaries(parts.rough(), |all| {
            format!(
                "the problem that is bounded has on {all} a bound of friction that is affine between nodes"
            )
        });
        let reasons = [measured, named, moved, rough, cancelled].into_iter().flatten();
        Oscillation { reason: joined(reasons, "; ", |all| all), lifts: BTreeMap::new() }
    }

    /// Puts the oscillation of the data into the pieces of a certificate; `origins` are their triangles in the mesh, of which
    /// they may be quarters.
    pub(crate) fn measure(
        &mut self,
        parts: &ProblemParts,
        data: &Data,
        certificate: &mut Certificate,
        (origins, quartered): (&[usize], bool),
    ) {
        if self.reason.is_none() {
            return;
        }
        // Both halves of an edge of the mesh are numbered from 0 and from its count of edges on.
        let count = parts.mesh.edge_count();
        let whole = |e: usize| if quartered && e < 2 * count { e % count } else { e };
        self.lifts = lifts(parts, certificate.curved.is_some());
        let lift = |(&t, &norm): (&usize, &f64)| Lift { corners: parts.mesh.triangles()[t], norm };
        certificate.lifts = self.lifts.iter().map(lift).collect();
        for (k, &t) in origins.iter().enumerate() {
            let piece = &certificate.pieces[k];
            let oscillation = loads(parts, data, certificate, (piece, &whole), t);
            certificate.pieces[k].oscillation = oscillation;
        }
    }
}

/// The sentence about some parts, one after the other; none if there are none.
fn joined(
    parts: impl Iterator<Item = String>,
    separator: &str,
    sentence: impl FnOnce(String) -> String,
) -> Option<String> {
    let parts: Vec<String> = parts.collect();
    (!parts.is_empty()).then(|| sentence(parts.join(separator)))
}

/// The sentence about some boundaries.
fn on_boundaries(names: BTreeSet<&str>, sentence: impl FnOnce(String) -> String) -> Option<String> {
    joined(names.into_iter().map(|name| quoted(name, '\'')), ", ", sentence)
}

/// Functions that a problem gives.
struct Given {
    name: String,
    functions: Vec<SharedFunction>,
    /// The degree up to which they are in the exact class; `None` where the certificate has values at vertices only.
    degree: Option<u32>,
    /// Where they act.
    vertices: Vec<usize>,
}

/// All that a problem gives, for a v that may be `quadratic`.
fn given(parts: &ProblemParts, quadratic: bool) -> Vec<Given> {
    let (problem, mesh, turning) = (parts.problem, parts.mesh, parts.turning());
    let force = |name: String, force: &[SharedFunction; 2], vertices: Vec<usize>| Given {
        name,
        functions: force.to_vec(),
        degree: Some(1),
        vertices,
    };
    let all = (0..mesh.vertices().len()).collect();
    let mut given = vec![force("the body force".to_owned(), &problem.body_force, all)];
    for part in &problem.surface_forces {
        let corners = part.triangles.iter().flat_map(|&t| mesh.triangles()[t]);
        let name = format!("the body force on '{}'", part.surface);
        given.push(force(name, &part.force, corners.collect()));
    }
    let of_v = Some(if quadratic { 2 } else { 1 });
    for (name, condition) in &problem.conditions {
        let mut add = |what: &str, functions: Vec<SharedFunction>, degree| {
            let edges = mesh.edges_of(name).unwrap_or_default().iter();
            let vertices = edges.flat_map(|&edge| mesh.ends(edge)).collect();
            given.push(Given {
                name: format!("the {what} of {}", quoted(name, '\'')),
                functions,
                degree,
                vertices,
            });
        };
        match condition {
            Condition::Displacement(u) => {
                add("displacement", u.iter().flatten().cloned().collect(), of_v);
            }
            Condition::Mixed { displacement, traction } => {
                let acts = |c: &usize| displacement[*c].is_none();
                let acting = (0..2).filter(acts).map(|c| traction[c].clone()).collect();
                add("traction", acting, Some(1));
                add("displacement", displacement.iter().flatten().cloned().collect(), of_v);
            }
            Condition::Support { normal, tangential } => {
                let functions = [normal, tangential].into_iter().flatten().cloned();
                add("displacement", functions.collect(), of_v);
            }
            Condition::Traction(traction) => add("traction", traction.to_vec(), Some(1)),
            Condition::Pressure(p) => add("pressure", vec![p.clone()], Some(1)),
            Condition::Contact { gap } => {
                let degree = of_v.filter(|_| !turning.contains(name.as_str()));
                add("gap", vec![gap.clone()], degree);
            }
            Condition::Obstacle(_, Obstacle::Plane { point, normal }) => {
                let distance = DistanceToPlane { point: *point, normal: *normal };
                add("distance", vec![Arc::new(distance)], None);
            }
            Condition::Obstacle(_, Obstacle::Distance(distance)) => {
                add("distance", vec![Arc::<dyn Distance>::clone(distance)], None);
            }
            // A gap is the difference of two lengths, or a length.
            Condition::Obstacle(_, Obstacle::Circle { .. } | Obstacle::Path { .. }) => {}
        }
    }
    given
}

/// (x - p) . m
struct DistanceToPlane {
    point: [f64; 2],
    normal: [f64; 2],
}

impl Function for DistanceToPlane {
    fn at(&self, x: [f64; 2]) -> f64 {
        let DistanceToPlane { point: p, normal: m } = self;
        (x[0] - p[0]) * m[0] + (x[1] - p[1]) * m[1]
    }

    fn enclosed(&self, x: [f64; 2]) -> Option<Ball> {
        let from = [0, 1].map(|c| Ball::exactly(x[c]) - Ball::exactly(self.point[c]));
        let [along, beside] = [0, 1].map(|c| from[c] * Ball::exactly(self.normal[c]));
        Some(along + beside)
    }
}

/// The constants of a triangle T for a displacement w less a rigid motion r.
struct Constants {
    /// |grad (w - r)| <= K |eps(w)|
    korn: f64,
    /// |w - r| <= K (h_T / pi) |eps(w)|
    poincare: f64,
    diameter: f64,
    area: f64,
}

impl Constants {
    /// |w - r| on an edge of this length is at most this times |eps(w)|: |E| / |T| (|w - r|^2 + h_T |w - r| |grad (w - r)|).
    fn trace(&self, length: f64) -> f64 {
        let Constants { korn, poincare, diameter, area } = self;
        (length / area * (poincare * poincare + diameter * poincare * korn)).sqrt()
    }
}

fn constants(triangle: &Triangle<f64>) -> Constants {
    let lengths = [0, 1, 2].map(|i| length(triangle.edge(i)));
    let perimeter: f64 = lengths.iter().sum();
    let centre = triangle.point(lengths.map(|l| l / perimeter));
    let inner = triangle.double_area() / perimeter;
    let outer = triangle.vertices.iter().map(|x| length(x - centre)).fold(0.0, f64::max);
    let ratio = inner / outer;
    let beta = ratio / (2.0 * (1.0 + (1.0 - ratio * ratio).sqrt())).sqrt();
    let korn = (1.0 + 2.0 / (beta * beta)).sqrt();
    let diameter = lengths.into_iter().fold(0.0, f64::max);
    let poincare = korn * diameter / std::f64::consts::PI;
    Constants { korn, poincare, diameter, area: triangle.double_area() / 2.0 }
}

/// The cost of f and t on one piece of triangle `t`: positive if that is measured. `whole` tells which edge of the mesh an
/// edge of Gamma_N is, or is a part of.
pub(super) fn loads(
    parts: &ProblemParts,
    data: &Data,
    certificate: &Certificate,
    (piece, whole): (&Piece, &dyn Fn(usize) -> usize),
    t: usize,
) -> f64 {
    let triangle = Triangle { vertices: piece.vertices.map(|p| place(certificate, p)) };
    let constants = constants(&triangle);
    // All by the rule of the force that asks for most.
    let curved = data.acting(t).filter(|(_, f, _)| !is_within(f, 1));
    let mut lacking = Vec::new();
    let mut least = 0.0;
    if let Some((_, _, rule)) = curved.max_by_key(|(_, f, _)| demand(f)) {
        least = f64::MIN_POSITIVE;
        let affine = piece.body.map(Vector2::from);
        rule.on_triangle(&triangle, |l, x, weight| {
            let mut difference = -(affine[0] * l[0] + affine[1] * l[1] + affine[2] * l[2]);
            data.acting(t).for_each(|(c, f, _)| difference[c] += f.at(x));
            lacking.push((l, weight, difference));
        });
    }
    // Beside a v that is affine all this hardly counts.
    let mut of_bubbles = if certificate.curved.is_some() {
        bubbles::take_off(&triangle, &piece.material(), &mut lacking)
    } else {
        0.0
    };
    let square: f64 = lacking.iter().map(|(_, weight, f)| weight * f.dot(f)).sum();
    let mut sum = constants.poincare * square.sqrt();
    for (local, e) in piece.edges.into_iter().enumerate() {
        let edge = certificate.edges[e];
        let (Boundary::Loaded(traction) | Boundary::Supported(_, _, Some(traction))) =
            parts.boundary.get(&whole(e)).unwrap_or(&Boundary::Free)
        else {
            continue;
        };
        if traction.is_affine() {
            continue;
        }
        least = f64::MIN_POSITIVE;
        let ends = edge.ends.map(|p| place(certificate, p).into());
        let (length, unit) = length_and_normal(ends);
        let affine = match edge.role {
            Role::Loaded(affine) => affine,
            Role::Pressed(p) => p.map(|p| unit.map(|n| -p * n)),
            Role::Supported { along: d, traction, .. } => traction.map(|q| [-d[1] * q, d[0] * q]),
            _ => continue,
        };
        let (mut square, mut legendre) = (0.0, Vector2::zeros());
        traction.rule().on_edge(ends, [], |point| {
            let t = traction.at(point.x, unit);
            let p = shifted_legendre(2, point.s)[0];
            for c in 0..2 {
                let there = (1.0 - point.s) * affine[0][c] + point.s * affine[1][c];
                let lacking = t[c] - there;
                square += point.weight * length * lacking * lacking;
                legendre[c] += 5.0 * point.weight * lacking * p;
            }
        });
        if certificate.curved.is_some() {
            of_bubbles += bubbles::of_traction(&triangle, &piece.material(), local, legendre);
            // int P_2^2 = 1/5
            square = (square - length / 5.0 * legendre.dot(&legendre)).max(0.0);
        }
        sum += constants.trace(length) * square.sqrt();
    }
    (of_bubbles + sum / least_eigenvalue(&piece.material).sqrt()).max(least)
}

/// |z|_a of what the displacement and the gap ask for beyond v, on each triangle of the mesh.
pub(super) fn lifts(parts: &ProblemParts, quadratic: bool) -> BTreeMap<usize, f64> {
    let mesh = parts.mesh;
    let mut lifts = BTreeMap::new();
    let turning = parts.turning();
    for (name, condition) in &parts.problem.conditions {
        for &edge in mesh.edges_of(name).unwrap_or_default() {
            let vertices = mesh.ends(edge);
            let ends = vertices.map(|vertex| mesh.vertices()[vertex]);
            let (_, normal) = mesh.length_and_normal(edge);
            let between = |s: f64, value: [f64; 2]| (1.0 - s) * value[0] + s * value[1];
            let at = |s: f64| [0, 1].map(|c| between(s, [ends[0][c], ends[1][c]]));
            // What v follows: f at the ends and, if it is quadratic, in the middle.
            let lacks = |f: &SharedFunction, s: f64| {
                let bulge = if quadratic { bulge_of(f, ends) } else { 0.0 };
                f.at(at(s)) - between(s, ends.map(|x| f.at(x))) - 4.0 * s * (1.0 - s) * bulge
            };
            let [x, y, left] = [Vector2::x(), Vector2::y(), Vector2::new(-normal.y, normal.x)];
            let given = match condition {
                Condition::Displacement([u, v]) | Condition::Mixed { displacement: [u, v], .. } => {
                    [(x, u.as_ref()), (y, v.as_ref())]
                }
                Condition::Support { normal: along, tangential: across } => {
                    [(normal, along.as_ref()), (left, across.as_ref())]
                }
                Condition::Contact { gap } if !turning.contains(name.as_str()) => {
                    [(normal, Some(gap)), (left, None)]
                }
                _ => continue,
            };
            let is_followed = |f: &SharedFunction| is_within(f, if quadratic { 2 } else { 1 });
            let given = given.into_iter().filter_map(|(d, f)| Some((d, f?)));
            let lacking: Vec<_> = given.filter(|(_, f)| !is_followed(f)).collect();
            if lacking.is_empty() {
                continue;
            }
            let lacking = |s: f64| {
                let all = lacking.iter().map(|&(d, f)| d * lacks(f, s));
                all.sum::<Vector2<f64>>().into()
            };
            let t = edge.triangle;
            *lifts.entry(t).or_insert(0.0) +=
                lift(&mesh.triangle(t), edge.local, lacking, parts.material(t));
        }
    }
    lifts
}

/// |z|_a of the lift of d from edge `local`, d zero at its ends. With the Legendre polynomials P_k on \[0, 1\], d' has the
/// coefficients (2k + 1) int d' P_k = -(2k + 1) int d P_k'.
fn lift(
    triangle: &Triangle<f64>,
    local: usize,
    d: impl Fn(f64) -> [f64; 2],
    material: &Material<f64>,
) -> f64 {
    let points = quadrature::gauss(POINTS);
    let values: Vec<[f64; 2]> = points.iter().map(|&(s, _)| d(s)).collect();
    let mut slopes = vec![[0.0; 2]; POINTS];
    for k in 1..POINTS {
        let legendre: Vec<[f64; 2]> = points.iter().map(|&(s, _)| shifted_legendre(k, s)).collect();
        for c in 0..2 {
            let mut moment = 0.0;
            for ((value, p), (_, weight)) in values.iter().zip(&legendre).zip(&points) {
                moment -= weight * value[c] * p[1];
            }
            for (slope, p) in slopes.iter_mut().zip(&legendre) {
                slope[c] += (2 * k + 1) as f64 * moment * p[0];
            }
        }
    }
    let gradients = triangle.barycentric_gradients();
    let (opposite, end) = (gradients[local], gradients[(local + 2) % 3]);
    let mut square = 0.0;
    for (((s, weight), value), slope) in points.iter().zip(&values).zip(&slopes) {
        let along = end + opposite * *s;
        let g = Matrix2::from_fn(|i, j| slope[i] * along[j] - value[i] * opposite[j]);
        let [xx, yy, xy] = material.stress(g).components();
        square += weight * (xx * g.m11 + yy * g.m22 + xy * (g.m12 + g.m21));
    }
    (square * triangle.double_area() / 2.0).sqrt()
}

/// The Legendre polynomial of degree k on \[0, 1\] and its derivative.
fn shifted_legendre(k: usize, s: f64) -> [f64; 2] {
    let x = 2.0 * s - 1.0;
    let (mut before, mut p) = ([0.0, 0.0], [1.0, 0.0]);
    for j in 1..=k {
        let j = j as f64;
        let value = ((2.0 * j - 1.0) * x * p[0] - (j - 1.0) * before[0]) / j;
        let slope = ((2.0 * j - 1.0) * (p[0] + x * p[1]) - (j - 1.0) * before[1]) / j;
        (before, p) = (p, [value, slope]);
    }
    [p[0], 2.0 * p[1]]
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::kernel::Plane;

    #[test]
    fn constants_of_the_equilateral_triangle_are_those_of_an_angle_of_fifteen_degrees() {
        let vertices = [[0.0, 0.0], [2.0, 0.0], [1.0, 3.0_f64.sqrt()]].map(Vector2::from);
        let found = constants(&Triangle { vertices });
        // The inner circle is half as large as the outer one, the sine of 30 degrees: beta = sin 15 degrees.
        let beta = (6.0_f64.sqrt() - 2.0_f64.sqrt()) / 4.0;
        let korn = (2.0 / (beta * beta) + 1.0).sqrt();
        assert_relative_eq!(found.korn, korn, max_relative = 1e-14);
        assert_relative_eq!(
            found.poincare,
            2.0 * korn / std::f64::consts::PI,
            max_relative = 1e-14
        );
        assert_relative_eq!(found.diameter, 2.0, max_relative = 1e-14);
        // |E| / |T| = 2 / 3^(1/2), and both terms.
        let square = korn * korn * 4.0 * (1.0 / std::f64::consts::PI + 1.0) / std::f64::consts::PI;
        let trace = (2.0 / 3.0_f64.sqrt() * square).sqrt();
        assert_relative_eq!(found.trace(2.0), trace, max_relative = 1e-14);
    }

    #[test]
    fn a_lift_has_the_energy_of_its_displacement() {
        let vertices = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
        let (triangle, material) = (Triangle { vertices }, Material::lame(0.0, 1.0, Plane::Strain));
        // d = (s (1 - s), 0) on the edge from (1, 0) to (0, 1), s = y there: lifted along (1 - s) and s.
        let found = lift(&triangle, 0, |s| [s * (1.0 - s), 0.0], &material);
        let n = 400;
        let mut square = 0.0;
        // By differences of z(x, y) = (x + y) d(y / (x + y)), the function of degree 1 with these values on the edge.
        let z = |x: f64, y: f64| if x + y > 0.0 { x * y / (x + y) } else { 0.0 };
        for (i, j) in (0..n).flat_map(|i| (0..n - i).map(move |j| (i, j))) {
            let [x, y] = [i, j].map(|k| (f64::from(k) + 1.0 / 3.0) / f64::from(n));
            let step = 1e-6;
            let zx = (z(x + step, y) - z(x - step, y)) / (2.0 * step);
            let zy = (z(x, y + step) - z(x, y - step)) / (2.0 * step);
            let weight = if i + j == n - 1 { 0.5 } else { 1.0 } / f64::from(n * n);
            // sigma : eps = 2 eps : eps = 2 zx^2 + zy^2 for lambda = 0, mu = 1.
            square += weight * (2.0 * zx * zx + zy * zy);
        }
        // The rule has an error of some h.
        assert_relative_eq!(found, square.sqrt(), max_relative = 1e-2);
    }
}
