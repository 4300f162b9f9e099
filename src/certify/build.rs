//! A certificate from a discrete solution: v by clipping u^h, tau by equilibrated tractions.
//!
//! Take lambda^h = -(1/gamma) \[P(u^h)\]+ and on each triangle s_T = sigma(u^h) + sum_E C (c_E (x) n) / |T|, with
//! c_E = int_E gamma (lambda^h - sigma_n(u^h)) n~ over its edges on Gamma_C (n~ = n, or the direction of contact). Then (8) for P1 reads int s : eps(v) = L(v) + int
//! lambda^h v_n: Nitsche's terms have gone into the stress. Tested with a hat function phi_a it says that around each
//! vertex a there are moments M_E of tractions, one for each edge E at a, with
//!
//! sum_{E of T at a} M_E = |T| s_T grad phi_a - int_T f phi_a   for the triangles T around a
//!
//! (M_E towards the outside of T): going round a, the differences of neighbouring moments are known. The one that is free
//! is chosen such that they are near those of the mean stress; where the boundary prescribes a traction, it is known. The
//! affine traction with the moments M_a, M_b is 4 M_a - 2 M_b at a, per unit of the edge's parameter.
//!
//! A triangle whose contact edge holds the end of contact is cut there, so that lambda^h is affine on the edges. Where n~
//! turns along an edge, tau n is affine along it only if the pressure is constant: then it is the mean of lambda^h.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix2, Vector2};

use super::CertifyError;
use super::oscillation::{self, Oscillation, Traction, is_within};
use super::proof::{Certificate, Cut, Edge, Piece, Role};
use crate::fem::constraints::Constraints;
use crate::fem::contact_line::ContactLineEdge;
use crate::fem::mesh::length;
use crate::fem::pieces::{Features, Rule};
use crate::fem::{BoundaryEdge, Condition, Function, Mesh, Problem, SharedFunction};
use crate::kernel::composite::complementary;
use crate::kernel::contact_edge::integral_of_product;
use crate::kernel::edge_integral::{ExactEdge, positive_interval};
use crate::kernel::{Material, P1, Stress, Triangle};

/// What a boundary edge prescribes.
#[derive(Clone, Copy)]
pub(super) enum Boundary<'a> {
    /// The components that are held.
    Held([bool; 2]),
    /// The traction.
    Loaded(Traction<'a>),
    /// Nothing: traction 0.
    Free,
    /// Gamma_C, and which of its edges.
    Contact(usize),
}

/// The parts of a problem that certificates are made from.
pub(super) struct Parts<'a> {
    pub problem: &'a Problem,
    pub mesh: &'a Mesh,
    /// Gamma_C with P and sigma_n.
    pub contact: &'a [ContactLineEdge<3, 2>],
    /// u_D at the vertices.
    pub prescribed: &'a [[Option<f64>; 2]],
    /// What boundary edges are, by their numbers in the mesh.
    pub boundary: BTreeMap<usize, Boundary<'a>>,
}

impl<'a> Parts<'a> {
    /// # Errors
    /// Conditions that no composite stress can satisfy.
    pub fn new(
        problem: &'a Problem,
        contact: &'a [ContactLineEdge<3, 2>],
        constraints: &'a Constraints,
    ) -> Result<Self, CertifyError> {
        let unsupported = |why: String| Err(CertifyError::Unsupported(why));
        if let Some(point) = problem.points.first() {
            return unsupported(format!(
                "[point.{}] holds a point, which a true solution does not feel",
                point.name
            ));
        }
        if !constraints.frames().is_empty() {
            return unsupported("a support holds an oblique direction".to_owned());
        }
        let mesh = &problem.mesh;
        let number = |edge: BoundaryEdge| mesh.triangle_edges()[edge.triangle][edge.local];
        let mut boundary: BTreeMap<usize, Boundary> =
            mesh.outline().iter().map(|&edge| (number(edge), Boundary::Free)).collect();
        for (name, condition) in &problem.conditions {
            // The names were found when the problem was discretised.
            for &edge in mesh.edges_of(name).unwrap_or_default() {
                let what = match condition {
                    Condition::Displacement(functions) => {
                        Boundary::Held([functions[0].is_some(), functions[1].is_some()])
                    }
                    Condition::Mixed { displacement, traction } => {
                        let held = [0, 1].map(|c| displacement[c].is_some());
                        let vanishes = |c: usize| {
                            let t = &traction[c];
                            t.degree() == Some(0) && t.at([0.0; 2]) == 0.0
                        };
                        if !(0..2).all(|c| held[c] || vanishes(c)) {
                            return unsupported(format!(
                                "'{name}' has a traction beside a prescribed component"
                            ));
                        }
                        Boundary::Held(held)
                    }
                    Condition::Support { normal, tangential } => {
                        let affine = |f: &SharedFunction| is_within(f, 1);
                        if ![normal, tangential].into_iter().flatten().all(affine) {
                            return unsupported(format!("the support of '{name}' is not affine"));
                        }
                        let n = mesh.length_and_normal(edge).1;
                        let held = match (normal.is_some(), tangential.is_some()) {
                            (true, true) => [true, true],
                            (along, across) if n[0] == 0.0 => [across, along],
                            (along, across) if n[1] == 0.0 => [along, across],
                            _ => {
                                return unsupported(format!("'{name}' holds an oblique direction"));
                            }
                        };
                        Boundary::Held(held)
                    }
                    Condition::Traction(traction) => Boundary::Loaded(Traction::Vector(traction)),
                    Condition::Pressure(p) => Boundary::Loaded(Traction::Pressure(p)),
                    Condition::Contact { .. } | Condition::Obstacle(..) => continue,
                };
                let what = match what {
                    Boundary::Held([false, false]) => Boundary::Free,
                    what => what,
                };
                boundary.insert(number(edge), what);
            }
        }
        for (k, edge) in contact.iter().enumerate() {
            boundary.insert(number(edge.edge), Boundary::Contact(k));
        }
        Ok(Parts { problem, mesh, contact, prescribed: constraints.values(), boundary })
    }

    /// The contact boundaries whose direction turns along an edge, so that it and the gap are known at vertices only.
    pub fn turning(&self) -> BTreeSet<&str> {
        let turning = self.contact.iter().filter(|edge| turns(edge));
        turning.map(|edge| &*edge.boundary).collect()
    }

    /// What triangle `t` is made of.
    pub fn material(&self, t: usize) -> &Material<f64> {
        self.problem.material.of(t)
    }
}

/// Whether the direction of contact turns along an edge.
pub(super) fn turns(edge: &ContactLineEdge<3, 2>) -> bool {
    edge.directions[0] != edge.directions[1]
}

/// v: u with the prescribed values, and pushed out of the obstacle at the vertices of Gamma_C.
pub(super) fn admissible(parts: &Parts, u: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut v = u.to_vec();
    let hold = |v: &mut Vec<[f64; 2]>| {
        for (v, data) in v.iter_mut().zip(parts.prescribed) {
            for c in 0..2 {
                if let Some(data) = data[c] {
                    v[c] = data;
                }
            }
        }
    };
    hold(&mut v);
    let reach = parts.mesh.vertices().iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
    let size = u.iter().flatten().fold(0.0_f64, |max, u| max.max(u.abs()));
    // At a corner two edges push; the second may push back into the first, so some rounds.
    for _ in 0..8 {
        let mut moved = false;
        for edge in parts.contact {
            let ends = parts.mesh.ends(edge.edge);
            let free = [0, 1].map(|k| {
                let (n, data) = (edge.directions[k], parts.prescribed[ends[k]]);
                Vector2::from([0, 1].map(|c| if data[c].is_none() { n[c] } else { 0.0 }))
            });
            let margin = |k: usize| {
                let n = edge.directions[k];
                // Balls must see it, also on a part of the edge between places as far out as the body reaches.
                let scale = edge.gap[k].abs() + if n[0] != 0.0 && n[1] != 0.0 { size } else { 0.0 };
                64.0 * f64::EPSILON * scale * reach / edge.length / NEAR_THE_END
            };
            for (k, vertex) in ends.into_iter().enumerate() {
                let along = free[k].dot(&edge.directions[k]);
                let beyond = Vector2::from(v[vertex]).dot(&edge.directions[k]) - edge.gap[k];
                let margin = margin(k);
                if beyond > -margin && along > 0.0 && (beyond > 0.0 || margin > 0.0) {
                    let step = (beyond + 2.0 * margin) / along;
                    v[vertex] = (Vector2::from(v[vertex]) - free[k] * step).into();
                    moved = true;
                }
            }
            if turns(edge) {
                // Between the ends it is at most the mean of the products of each with the other's direction.
                let [d, e] = edge.directions;
                let along = free[0].dot(&e) + free[1].dot(&d);
                let at = ends.map(|vertex| Vector2::from(v[vertex]));
                let beyond = at[0].dot(&e) + at[1].dot(&d) - edge.gap[0] - edge.gap[1];
                let margin = margin(0) + margin(1);
                if beyond > -margin && along > 0.0 {
                    let step = (beyond + 2.0 * margin) / along;
                    for k in 0..2 {
                        v[ends[k]] = (at[k] - free[k] * step).into();
                    }
                    moved = true;
                }
            }
        }
        if !moved {
            break;
        }
    }
    v
}

/// The certificate with equilibrated tractions, before any improvement; the triangles of the mesh that its pieces come
/// from; and what the data of the problem leave out.
pub(super) fn build(
    parts: &Parts,
    u: &[[f64; 2]],
    v: Vec<[f64; 2]>,
) -> (Certificate, Vec<usize>, Oscillation) {
    let mesh = parts.mesh;
    let data = oscillation::Data::new(parts.problem);
    let whole: Vec<Triangle<f64>> = (0..mesh.triangles().len()).map(|t| mesh.triangle(t)).collect();
    let stress = stresses(parts, u, &whole);
    let bodies: Vec<[Vector2<f64>; 3]> =
        whole.iter().enumerate().map(|(t, triangle)| data.body_on(t, triangle)).collect();
    let moments = moments(parts, &bodies, u, &whole, &stress);
    let mut oscillation = Oscillation::new(parts);
    let mut certificate = Certificate {
        vertices: mesh.vertices().to_vec(),
        cuts: Vec::new(),
        displacement: v,
        prescribed: parts.prescribed.to_vec(),
        pieces: Vec::with_capacity(whole.len()),
        edges: Vec::with_capacity(mesh.edge_count()),
    };
    // The edges of the mesh, each as the first triangle that has it sees it.
    let mut ends = vec![None; mesh.edge_count()];
    for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
        for local in 0..3 {
            ends[edges[local]].get_or_insert([corners[(local + 1) % 3], corners[(local + 2) % 3]]);
        }
    }
    for (e, (ends, m)) in ends.into_iter().zip(&moments).enumerate() {
        let force = [0, 1].map(|k| [0, 1].map(|c| 4.0 * m[k][c] - 2.0 * m[1 - k][c]));
        let ends = ends.unwrap_or_default();
        let role = match parts.boundary.get(&e) {
            None => Role::Inner(force),
            Some(Boundary::Held(held)) => {
                Role::Held(*held, force.map(|f| [0, 1].map(|c| if held[c] { f[c] } else { 0.0 })))
            }
            Some(Boundary::Free) => Role::Loaded([[0.0; 2]; 2]),
            Some(Boundary::Loaded(traction)) => {
                traction.affine(ends.map(|vertex| mesh.vertices()[vertex]), force)
            }
            Some(Boundary::Contact(k)) => {
                let edge = &parts.contact[*k];
                let p = edge.p(&nodal(u, mesh.triangles()[edge.edge.triangle]));
                let along = (edge.directions != [edge.normal; 2])
                    .then(|| edge.directions.map(<[f64; 2]>::from));
                let pressure = if turns(edge) {
                    // The mean: then tau n is affine.
                    let [a, b] = P1::exact(p).gradient;
                    [-((a + b) / edge.gamma); 2]
                } else {
                    p.map(|p| -(p.max(0.0) / edge.gamma))
                };
                Role::Contact { pressure, gap: edge.gap, along }
            }
        };
        certificate.edges.push(Edge { ends, role });
    }
    let mut origins = Vec::with_capacity(whole.len());
    for t in 0..whole.len() {
        add_triangle(parts, &data, (t, bodies[t]), u, &stress, &mut certificate);
        origins.resize(certificate.pieces.len(), t);
    }
    oscillation.measure(parts, &data, &mut certificate, &origins);
    (certificate, origins, oscillation)
}

/// Contact that ends this near an end of its edge, in units of the edge, leaves it whole: the triangles would be slivers.
const NEAR_THE_END: f64 = 1e-3;

/// Triangle `t`, cut in two where contact ends on one of its edges.
fn add_triangle(
    parts: &Parts,
    data: &oscillation::Data,
    (t, whole): (usize, [Vector2<f64>; 3]),
    u: &[[f64; 2]],
    stress: &[Stress<f64>],
    certificate: &mut Certificate,
) {
    let (corners, edges) = (parts.mesh.triangles()[t], parts.mesh.triangle_edges()[t]);
    let material = [parts.material(t).lambda(), parts.material(t).mu()];
    let add = |vertices: [usize; 3], edges: [usize; 3], certificate: &mut Certificate| {
        let own = || {
            let triangle = Triangle { vertices: vertices.map(|p| place(certificate, p)) };
            data.body_on(t, &triangle)
        };
        let body = if vertices == corners { whole } else { own() }.map(Into::into);
        certificate.pieces.push(Piece { vertices, edges, material, body, oscillation: 0.0 });
    };
    let cut = (0..3).find_map(|local| {
        let Some(&Boundary::Contact(k)) = parts.boundary.get(&edges[local]) else { return None };
        let edge = &parts.contact[k];
        let p = edge.p(&nodal(u, corners));
        let [start, end] = positive_interval(p);
        let at = if p[0] > 0.0 { end } else { start };
        let changes = (p[0] > 0.0) != (p[1] > 0.0);
        let inside = NEAR_THE_END < at && at < 1.0 - NEAR_THE_END;
        (changes && inside && !turns(edge)).then_some((local, at))
    });
    let Some((local, at)) = cut else {
        add(corners, edges, certificate);
        return;
    };
    let [a, b, c] = [0, 1, 2].map(|k| corners[(local + k) % 3]);
    let [opposite, next, last] = [0, 1, 2].map(|k| edges[(local + k) % 3]);
    let middle = certificate.vertices.len() + certificate.cuts.len();
    certificate.cuts.push(Cut { ends: [b, c], at });
    let whole = certificate.edges[opposite];
    let Role::Contact { pressure, gap, along } = whole.role else { return };
    let inside = gap[0] + at * (gap[1] - gap[0]);
    // The first half keeps the number of the edge.
    certificate.edges[opposite] = Edge {
        ends: [b, middle],
        role: Role::Contact { pressure: [pressure[0], 0.0], gap: [gap[0], inside], along },
    };
    let second = certificate.edges.len();
    certificate.edges.push(Edge {
        ends: [middle, c],
        role: Role::Contact { pressure: [0.0, pressure[1]], gap: [inside, gap[1]], along },
    });
    let [from, to] = [middle, a].map(|p| place(certificate, p));
    let normal = Vector2::new(to.y - from.y, from.x - to.x);
    let force = stress[t].traction(normal).into();
    certificate.edges.push(Edge { ends: [middle, a], role: Role::Inner([force; 2]) });
    add([a, b, middle], [opposite, second + 1, last], certificate);
    add([a, middle, c], [second, next, second + 1], certificate);
}

/// Where point `p` of a certificate lies.
pub(super) fn place(certificate: &Certificate, p: usize) -> Vector2<f64> {
    at_point(&certificate.vertices, &certificate.cuts, p)
}

/// The value at point `p` of what has these values at the vertices and is affine between them.
pub(super) fn at_point(values: &[[f64; 2]], cuts: &[Cut], p: usize) -> Vector2<f64> {
    match values.get(p) {
        Some(&value) => value.into(),
        None => {
            let cut = cuts[p - values.len()];
            let [a, b] = cut.ends.map(|end| Vector2::from(values[end]));
            a + (b - a) * cut.at
        }
    }
}

/// The values of `u` at the vertices of a triangle.
fn nodal(u: &[[f64; 2]], corners: [usize; 3]) -> [Vector2<f64>; 3] {
    corners.map(|vertex| u[vertex].into())
}

/// s_T on each triangle.
fn stresses(parts: &Parts, u: &[[f64; 2]], triangles: &[Triangle<f64>]) -> Vec<Stress<f64>> {
    let mesh = parts.mesh;
    let nodal = |t: usize| nodal(u, mesh.triangles()[t]);
    let mut stress: Vec<Stress<f64>> = triangles
        .iter()
        .enumerate()
        .map(|(t, triangle)| {
            parts.material(t).stress(super::proof::displacement_gradient(triangle, &nodal(t)))
        })
        .collect();
    for edge in parts.contact {
        let (t, n) = (edge.edge.triangle, edge.normal);
        let nodal = nodal(t);
        let pressure = P1::exact(edge.p(&nodal)).gradient;
        let sigma_n = edge.sigma_n(&nodal);
        let d = edge.directions;
        let excess = Vector2::from([0, 1].map(|c| {
            let stress = integral_of_product(sigma_n, [d[0][c], d[1][c]]);
            -(pressure[0] * d[0][c] + pressure[1] * d[1][c]) - edge.gamma * stress
        }));
        let factor = edge.length / (triangles[t].double_area() / 2.0);
        let strain = Matrix2::from_fn(|i, j| factor * excess[i] * n[j]);
        stress[t] = stress[t] + parts.material(t).stress(strain);
    }
    stress
}

/// The moments of the traction on each edge with the hat functions of its ends, towards the outside of the first triangle
/// that has the edge.
fn moments(
    parts: &Parts,
    bodies: &[[Vector2<f64>; 3]],
    u: &[[f64; 2]],
    triangles: &[Triangle<f64>],
    stress: &[Stress<f64>],
) -> Vec<[Vector2<f64>; 2]> {
    let mesh = parts.mesh;
    let (corners, edges) = (mesh.triangles(), mesh.triangle_edges());
    let mut owners = vec![[None; 2]; mesh.edge_count()];
    let mut fans = vec![Vec::new(); mesh.vertices().len()];
    for t in 0..corners.len() {
        for local in 0..3 {
            let [first, second] = &mut owners[edges[t][local]];
            if first.is_none() {
                *first = Some((t, local))
            } else {
                *second = Some((t, local))
            }
            fans[corners[t][local]].push((t, local));
        }
    }
    // What the mean stress of the neighbours gives, and what the boundary prescribes.
    let mut moments = vec![[Vector2::zeros(); 2]; mesh.edge_count()];
    let mut known = vec![[false; 2]; mesh.edge_count()];
    for (e, owner) in owners.iter().enumerate() {
        let [Some((t, local)), second] = *owner else { continue };
        let normal = triangles[t].scaled_normal(local);
        let here = stress[t].traction(normal);
        let force = match second {
            Some((other, _)) => (here + stress[other].traction(normal)) / 2.0,
            None => here,
        };
        moments[e] = [force / 2.0; 2];
        match parts.boundary.get(&e) {
            None => {}
            Some(Boundary::Held(held)) => {
                for c in (0..2).filter(|&c| !held[c]) {
                    known[e][c] = true;
                    moments[e].iter_mut().for_each(|m| m[c] = 0.0);
                }
            }
            Some(Boundary::Free) => {
                known[e] = [true; 2];
                moments[e] = [Vector2::zeros(); 2];
            }
            Some(Boundary::Loaded(traction)) => {
                known[e] = [true; 2];
                let ends = [1, 2].map(|k| mesh.vertices()[corners[t][(local + k) % 3]]);
                moments[e] = traction.moments(ends, normal);
            }
            Some(Boundary::Contact(k)) => {
                known[e] = [true; 2];
                let edge = &parts.contact[*k];
                let positive = P1::exact(edge.p(&nodal(u, corners[t]))).gradient;
                moments[e] = if edge.directions == [edge.normal; 2] {
                    positive.map(|p| normal * -(p / edge.gamma))
                } else {
                    [0, 1].map(|k| edge.directions[k] * -(edge.length * positive[k] / edge.gamma))
                };
            }
        }
    }
    let averaged = moments.clone();
    for (a, fan) in fans.iter().enumerate() {
        go_round(
            a,
            fan,
            &Around {
                corners,
                edges,
                owners: &owners,
                averaged: &averaged,
                known: &known,
                triangles,
                stress,
                bodies,
            },
            &mut moments,
        );
    }
    moments
}

/// What the triangles around a vertex have.
struct Around<'a> {
    corners: &'a [[usize; 3]],
    edges: &'a [[usize; 3]],
    owners: &'a [[Option<(usize, usize)>; 2]],
    averaged: &'a [[Vector2<f64>; 2]],
    known: &'a [[bool; 2]],
    triangles: &'a [Triangle<f64>],
    stress: &'a [Stress<f64>],
    /// The body force at the vertices, affine between them.
    bodies: &'a [[Vector2<f64>; 3]],
}

impl Around<'_> {
    /// The triangle at the other side of edge `e`.
    fn beyond(&self, t: usize, e: usize) -> Option<usize> {
        self.owners[e].into_iter().flatten().map(|(other, _)| other).find(|&other| other != t)
    }

    /// int f phi over triangle `t`, phi the hat function of its vertex `l`: |T| / 12 (f_0 + f_1 + f_2 + f_l).
    fn load(&self, t: usize, l: usize) -> Vector2<f64> {
        let body = &self.bodies[t];
        (body[0] + body[1] + body[2] + body[l]) * (self.triangles[t].double_area() / 24.0)
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
            sum = sum - around.stress[t].traction(normal) / 2.0 - around.load(t, l);
            let e = around.edges[t][(l + 1) % 3];
            edges.push(e);
            sums.push(sum);
            signs.push(around.moment(a, t, e));
        }
        let last = edges.len() - 1;
        let ring = edges[0] == edges[last];
        for c in 0..2 {
            let target = |i: usize| signs[i].1 * around.averaged[edges[i]][signs[i].0][c];
            let offset = if around.known[edges[0]][c] {
                target(0)
            } else if around.known[edges[last]][c] {
                target(last) - sums[last][c]
            } else {
                let count = if ring { last } else { last + 1 };
                let (mut weighted, mut weights) = (0.0, 0.0);
                for i in 0..count {
                    let normal = match around.owners[edges[i]][0] {
                        Some((t, local)) => around.triangles[t].scaled_normal(local),
                        None => Vector2::x(),
                    };
                    let weight = 1.0 / length(normal);
                    weighted += weight * (target(i) - sums[i][c]);
                    weights += weight;
                }
                weighted / weights
            };
            for i in 0..=last {
                let done = around.known[edges[i]][c] || (ring && i == last);
                if !done {
                    moments[edges[i]][signs[i].0][c] = signs[i].1 * (offset + sums[i][c]);
                }
            }
        }
    }
}

/// A rule for a function of the place.
pub(super) fn rule(function: &dyn Function) -> Rule {
    // n points are exact for the square of a polynomial of degree n - 1.
    let known = function.degree().and_then(|degree| usize::try_from(degree).ok());
    let points = known.map_or(oscillation::POINTS, |degree| oscillation::POINTS.min(degree + 1));
    Rule::new(Features { kink: function.kink(), singular: None }, points)
}

/// Zienkiewicz and Zhu's estimate of the error of v: the distance of its stress from the stress that is averaged at the
/// vertices, triangle by triangle of each material.
pub(super) fn averaging_estimate(parts: &Parts, v: &[[f64; 2]]) -> f64 {
    let mesh = parts.mesh;
    let place = |t: usize| parts.problem.material.place_of(t);
    let zero = Stress::new([0.0; 3]);
    // At each vertex the sums and weights of the few materials there.
    let mut sums: Vec<Vec<(usize, Stress<f64>, f64)>> = vec![Vec::new(); mesh.vertices().len()];
    let stress_of = |t: usize, triangle: &Triangle<f64>| {
        let nodal = nodal(v, mesh.triangles()[t]);
        parts.material(t).stress(super::proof::displacement_gradient(triangle, &nodal))
    };
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let triangle = mesh.triangle(t);
        let (s, area) = (stress_of(t, &triangle), triangle.double_area());
        for &vertex in corners {
            let known = sums[vertex].iter_mut().find(|(material, ..)| *material == place(t));
            match known {
                Some((_, sum, weight)) => {
                    *sum = *sum + s * area;
                    *weight += area;
                }
                None => sums[vertex].push((place(t), s * area, area)),
            }
        }
    }
    let mut square = 0.0;
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let triangle = mesh.triangle(t);
        let s = stress_of(t, &triangle);
        let mut total = zero;
        let mut share = 0.0;
        for &vertex in corners {
            let known = sums[vertex].iter().find(|(material, ..)| *material == place(t));
            let Some(&(_, sum, weight)) = known else { continue };
            let difference = sum / weight - s;
            share += complementary(parts.material(t), difference);
            total = total + difference;
        }
        square += (share + complementary(parts.material(t), total)) * triangle.double_area() / 24.0;
    }
    square.sqrt()
}
