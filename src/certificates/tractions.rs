//! The moments of tau's tractions with the hat functions, from the discrete solution.
//!
//! Let y in V^h be the displacement under the loads and the pressures p of the certificate (`pressed`): a(y, v) = L(v) + int p d . v
//! for all v in V^h. Tested with a hat function phi_a, which is in V^h for P1 and P2, it says that around each vertex a there
//! are moments M_E of tractions, one for each edge E at a, with
//!
//! sum_{E of T at a} M_E = |T| s_T grad phi_a - int_T f phi_a   for the triangles T around a
//!
//! (M_E towards the outside of T, s_T the mean of sigma(y)): going round a, the differences of neighbouring moments are known.
//! The one that is free is chosen such that they are near those of sigma(y), which is affine for P2; where the boundary
//! prescribes a traction, it is known. The affine traction with the moments M_a, M_b is 4 M_a - 2 M_b at a, per unit of the
//! edge's parameter.

use nalgebra::Vector2;

use super::certificate::{Role, turned};
use super::field::Field;
use super::parts::{Boundary, ProblemParts};
use crate::kernel::Triangle;
use crate::kernel::composite::Affine;
use crate::model::mesh::length;

/// s_T on each triangle, and beside it what sigma(y) has beyond its mean.
pub(super) fn stresses(
    parts: &ProblemParts,
    y: &Field,
    triangles: &[Triangle<f64>],
) -> Vec<Affine<f64>> {
    let of_y = |(t, triangle): (usize, &Triangle<f64>)| {
        let sigma = y.stress(parts.mesh, parts.material(t), t, triangle);
        let mean = sigma.mean();
        let beyond = sigma.beyond.map(|_| [0, 1, 2].map(|i| sigma.at_corner(i) - mean));
        Affine { base: mean, beyond }
    };
    triangles.iter().enumerate().map(of_y).collect()
}

/// The moments of the traction on each edge with the hat functions of its ends, towards the outside of the first triangle
/// that has the edge.
pub(super) fn moments(
    parts: &ProblemParts,
    bodies: &[[Vector2<f64>; 3]],
    triangles: &[Triangle<f64>],
    stress: &[Affine<f64>],
) -> Vec<[Vector2<f64>; 2]> {
    let mesh = parts.mesh;
    let (corners, edges) = (mesh.triangles(), mesh.triangle_edges());
    let mut owners = vec![[None; 2]; mesh.edge_count()];
    let mut fans = vec![Vec::new(); mesh.vertices().len()];
    for t in 0..corners.len() {
        for local in 0..3 {
            let owner = &mut owners[edges[t][local]];
            owner[usize::from(owner[0].is_some())] = Some((t, local));
            fans[corners[t][local]].push((t, local));
        }
    }
    // What the mean stress of the neighbours gives, and what the boundary prescribes.
    let mut moments = vec![[Vector2::zeros(); 2]; mesh.edge_count()];
    let mut known = vec![Known::Nothing; mesh.edge_count()];
    for (e, owner) in owners.iter().enumerate() {
        let Some((t, local)) = owner[0] else { continue };
        let normal = triangles[t].scaled_normal(local);
        let ends = [1, 2].map(|k| corners[t][(local + k) % 3]);
        let mean = mean_moments(corners, stress, owner, (ends, normal));
        (known[e], moments[e]) = prescribed(parts, e, ends, mean);
    }
    let averaged = moments.clone();
    let (owners, averaged, known) = (&owners, &averaged, &known);
    let around = Around { corners, edges, owners, averaged, known, triangles, stress, bodies };
    for (a, fan) in fans.iter().enumerate() {
        go_round(a, fan, &around, &mut moments);
    }
    moments
}

/// The moments on an edge of the mean of the stresses on its one or two triangles.
fn mean_moments(
    corners: &[[usize; 3]],
    stress: &[Affine<f64>],
    owner: &[Option<(usize, usize)>; 2],
    (ends, normal): ([usize; 2], Vector2<f64>),
) -> [Vector2<f64>; 2] {
    let sides = owner.iter().flatten().count() as f64;
    let forces = owner.iter().flatten().map(|&(t, _)| stress[t].base.traction(normal));
    let force = forces.fold(Vector2::zeros(), |sum, force| sum + force) / sides;
    let mut moments = [force / 2.0; 2];
    // What comes to the mean, p and q at the ends, has the moments (2 p + q) / 6 and (p + 2 q) / 6.
    for &(t, _) in owner.iter().flatten() {
        let Some(beyond) = &stress[t].beyond else { continue };
        for (corner, beyond) in corners[t].iter().zip(beyond) {
            let Some(k) = ends.iter().position(|end| end == corner) else { continue };
            let sixth = beyond.traction(normal) / (6.0 * sides);
            moments[k] += sixth * 2.0;
            moments[1 - k] += sixth;
        }
    }
    moments
}

/// The known ones of the moments on edge `e`, and all of them, with as much of `mean` as the known ones leave.
fn prescribed(
    parts: &ProblemParts,
    e: usize,
    ends: [usize; 2],
    mean: [Vector2<f64>; 2],
) -> (Known, [Vector2<f64>; 2]) {
    let places = ends.map(|vertex| parts.mesh.vertices()[vertex]);
    let zero = [Vector2::zeros(); 2];
    match parts.boundary.get(&e) {
        None => (Known::Nothing, mean),
        Some(Boundary::Held(held, _)) => {
            let Some(c) = (0..2).find(|&c| !held[c]) else { return (Known::Nothing, mean) };
            let across = [Vector2::x(), Vector2::y()][c];
            (Known::Along(across), mean.map(|m| m - across * m[c]))
        }
        Some(&Boundary::Supported(d, _, traction)) => {
            let across = turned(Vector2::from(d));
            let given = traction.map(|traction| traction.moments(places));
            let given = given.unwrap_or_default();
            (Known::Along(across), [0, 1].map(|k| with_along(across, given[k], mean[k])))
        }
        Some(Boundary::Free) => (Known::All, zero),
        Some(Boundary::Loaded(traction)) => (Known::All, traction.moments(places)),
        Some(&Boundary::Contact(line)) => {
            let on_line = parts.lines[line].iter().map(|&(k, i)| parts.contact[k].on_edge(i));
            (Known::All, on_line.fold(zero, |[p, q], [a, b, _]| [p + a, q + b]))
        }
    }
}

/// The known moments on an edge: all, or their components along a unit vector.
#[derive(Clone, Copy)]
enum Known {
    Nothing,
    Along(Vector2<f64>),
    All,
}

impl Known {
    fn directions(self) -> [Option<Vector2<f64>>; 2] {
        match self {
            Known::Nothing => [None; 2],
            Known::Along(k) => [Some(k), None],
            Known::All => [Some(Vector2::x()), Some(Vector2::y())],
        }
    }
}

/// The vector that is `given` along k and `other` across it.
fn with_along(k: Vector2<f64>, given: Vector2<f64>, other: Vector2<f64>) -> Vector2<f64> {
    let across = turned(k);
    k * k.dot(&given) + across * across.dot(&other)
}

/// Vectors with a sine below this are parallel.
const PARALLEL: f64 = 1e-6;

/// The vector that has the given products with the first two of these that are not parallel, and as much of `otherwise` as
/// they leave.
fn combined(
    mut demands: impl Iterator<Item = (Vector2<f64>, f64)>,
    otherwise: impl FnOnce() -> Vector2<f64>,
) -> Vector2<f64> {
    let Some((l, other)) = demands.next() else { return otherwise() };
    match demands.find(|(k, _)| l.perp(k).abs() > PARALLEL) {
        Some((k, value)) => (turned(l) * value - turned(k) * other) / l.perp(&k),
        None => with_along(l, l * other, otherwise()),
    }
}

/// int f phi over a triangle, f affine with these values at its vertices, phi the hat function of vertex `l`:
/// |T| / 12 (f_0 + f_1 + f_2 + f_l).
pub(super) fn load(body: &[Vector2<f64>; 3], triangle: &Triangle<f64>, l: usize) -> Vector2<f64> {
    (body[0] + body[1] + body[2] + body[l]) * (triangle.double_area() / 24.0)
}

/// The data of the triangles around a vertex.
struct Around<'a> {
    corners: &'a [[usize; 3]],
    edges: &'a [[usize; 3]],
    owners: &'a [[Option<(usize, usize)>; 2]],
    averaged: &'a [[Vector2<f64>; 2]],
    known: &'a [Known],
    triangles: &'a [Triangle<f64>],
    stress: &'a [Affine<f64>],
    /// The body force at the vertices, affine between them.
    bodies: &'a [[Vector2<f64>; 3]],
}

impl Around<'_> {
    /// The triangle at the other side of edge `e`.
    fn beyond(&self, t: usize, e: usize) -> Option<usize> {
        self.owners[e].into_iter().flatten().map(|(other, _)| other).find(|&other| other != t)
    }

    fn load(&self, t: usize, l: usize) -> Vector2<f64> {
        load(&self.bodies[t], &self.triangles[t], l)
    }

    /// Edge `e` as the place of its moment at vertex `a`, and 1 if its moments point outside `t`, else -1.
    fn moment(&self, a: usize, t: usize, e: usize) -> (usize, f64) {
        match self.owners[e][0] {
            Some((first, local)) => {
                let start = self.corners[first][(local + 1) % 3];
                (usize::from(start != a), if first == t { 1.0 } else { -1.0 })
            }
            None => (0, 1.0),
        }
    }
}

/// The moments at the edges around vertex `a`, whose triangles are `fan`: one or more chains, or a ring.
fn go_round(a: usize, fan: &[(usize, usize)], around: &Around, moments: &mut [[Vector2<f64>; 2]]) {
    let mut left: Vec<(usize, usize)> = fan.to_vec();
    while !left.is_empty() {
        // A chain starts at a triangle with no neighbour clockwise; without one, anywhere.
        let start = left
            .iter()
            .position(|&(t, l)| around.beyond(t, around.edges[t][(l + 2) % 3]).is_none())
            .unwrap_or(0);
        let mut chain = vec![left.swap_remove(start)];
        while let Some(&(t, l)) = chain.last() {
            let Some(next) = around.beyond(t, around.edges[t][(l + 1) % 3]) else { break };
            let Some(place) = left.iter().position(|&(t, _)| t == next) else { break };
            chain.push(left.swap_remove(place));
        }
        // X_i on the edge after triangle i, counter-clockwise, and X_0 on the one before the first.
        let (first, l) = chain[0];
        let mut edges = vec![around.edges[first][(l + 2) % 3]];
        let mut sum = Vector2::zeros();
        let mut sums = vec![sum];
        // Signs: X points counter-clockwise, out of the triangle before the edge.
        let mut signs = Vec::new();
        let (k, sign) = around.moment(a, first, edges[0]);
        signs.push((k, -sign));
        for &(t, l) in &chain {
            let normal = around.triangles[t].scaled_normal(l);
            sum = sum - around.stress[t].base.traction(normal) / 2.0 - around.load(t, l);
            let e = around.edges[t][(l + 1) % 3];
            edges.push(e);
            sums.push(sum);
            signs.push(around.moment(a, t, e));
        }
        let last = edges.len() - 1;
        // Of a ring the last edge is the first one.
        let count = if edges[0] == edges[last] { last } else { last + 1 };
        // What the moment on edge i, near its target or equal to it, says of X_0.
        let offset_at = |i: usize| around.averaged[edges[i]][signs[i].0] * signs[i].1 - sums[i];
        let demands = [0, last].into_iter().flat_map(|i| {
            let along = around.known[edges[i]].directions();
            along.map(move |along| along.map(|k| (k, k.dot(&offset_at(i)))))
        });
        let offset = combined(demands.flatten(), || {
            let (mut weighted, mut weights) = (Vector2::zeros(), 0.0);
            for (i, &e) in edges.iter().enumerate().take(count) {
                let normal = match around.owners[e][0] {
                    Some((t, local)) => around.triangles[t].scaled_normal(local),
                    None => Vector2::x(),
                };
                let weight = 1.0 / length(normal);
                weighted += offset_at(i) * weight;
                weights += weight;
            }
            weighted / weights
        });
        for i in 0..count {
            let moment = &mut moments[edges[i]][signs[i].0];
            let free = (offset + sums[i]) * signs[i].1;
            *moment = match around.known[edges[i]] {
                Known::Nothing => free,
                Known::Along(k) => with_along(k, *moment, free),
                Known::All => continue,
            };
        }
    }
}

/// The role with what it holds of a force.
pub(super) fn with_force(role: Role, force: [[f64; 2]; 2]) -> Role {
    match role {
        Role::Inner(_) => Role::Inner(force),
        Role::Held(held, _) => {
            Role::Held(held, force.map(|f| [0, 1].map(|c| if held[c] { f[c] } else { 0.0 })))
        }
        Role::Supported { along: d, traction, .. } => {
            let squared = d[0] * d[0] + d[1] * d[1];
            let force = force.map(|f| (f[0] * d[0] + f[1] * d[1]) / squared);
            Role::Supported { along: d, force, traction }
        }
        Role::Loaded(_) | Role::Pressed(_) | Role::Contact { .. } | Role::Facing => role,
    }
}
