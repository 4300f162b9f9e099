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
//! Hat functions are in the space of P2, too: there s_T is the mean of sigma(u^h) with the same terms, and the moments are to be
//! near those of the affine stress sigma(u^h), which is nearer to the true one than its means are.
//!
//! A triangle whose contact edge holds the end of contact is cut there, so that lambda^h is affine on the edges. For P2 it is
//! quadratic, and the affine pressure with its force and its centroid would be a tension at one end where the centroid
//! is not in the middle third: then it acts on three times the way to the centroid only, and the triangle is cut there
//! ([`Profile`]). Force and moment are those of lambda^h, unless that way is too short to cut a triangle there. Where n~ turns along an edge, tau n is affine along
//! it only if the pressure is constant: then it is the mean of lambda^h.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::{Matrix2, Vector2};

use super::CertifyError;
use super::oscillation::{self, Oscillation, Traction, is_within};
use super::proof::{Certificate, Curved, Cut, Edge, Piece, Role, Shape, exactly};
use crate::fem::constraints::Constraints;
use crate::fem::contact_line::{self, ContactLineEdge};
use crate::fem::mesh::length;
use crate::fem::pieces::{Features, Rule};
use crate::fem::{BoundaryEdge, Condition, Function, Mesh, Problem, SharedFunction, Space};
use crate::kernel::composite::{Affine, Loads, complementary};
use crate::kernel::contact_edge::integral_of_product;
use crate::kernel::edge_integral::{self, ExactEdge, positive_interval};
use crate::kernel::{Enclosing, Material, Stress, Triangle};
use crate::solve::Solution;

/// What a boundary edge prescribes.
#[derive(Clone, Copy)]
pub(super) enum Boundary<'a> {
    /// The components that are held, and the functions that they are, if these may be other than affine.
    Held([bool; 2], [Option<&'a SharedFunction>; 2]),
    /// The traction.
    Loaded(Traction<'a>),
    /// Nothing: traction 0.
    Free,
    /// Gamma_C, and which of its edges.
    Contact(usize),
}

/// A displacement on the mesh: affine on its triangles, or quadratic.
#[derive(Clone)]
pub(super) struct Field {
    /// At the vertices.
    pub vertices: Vec<[f64; 2]>,
    /// What it is in the middle of each edge beyond the mean of the ends.
    pub bulges: Option<Vec<[f64; 2]>>,
}

impl Field {
    /// The field with these values at the vertices, and at the middles of the edges if there are so many.
    pub fn new(mesh: &Mesh, nodal: &[[f64; 2]]) -> Result<Field, CertifyError> {
        let (vertices, nodes) = (mesh.vertices().len(), mesh.vertices().len() + mesh.edge_count());
        if nodal.len() != vertices && nodal.len() != nodes {
            let found = nodal.len();
            return Err(CertifyError::Field { found, vertices, nodes });
        }
        let (ends, middles) = nodal.split_at(vertices);
        let bulges = (!middles.is_empty()).then(|| {
            let mut bulges = vec![[0.0; 2]; middles.len()];
            for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
                for (local, &e) in edges.iter().enumerate() {
                    let [a, b] = [1, 2].map(|k| ends[corners[(local + k) % 3]]);
                    bulges[e] = [0, 1].map(|c| middles[e][c] - (a[c] + b[c]) / 2.0);
                }
            }
            bulges
        });
        Ok(Field { vertices: ends.to_vec(), bulges })
    }

    /// The values at the vertices, and at the middles of the edges if it is quadratic.
    pub fn nodal(&self, mesh: &Mesh) -> Vec<[f64; 2]> {
        let mut nodal = self.vertices.clone();
        if let Some(bulges) = &self.bulges {
            nodal.resize(nodal.len() + bulges.len(), [0.0; 2]);
            for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
                for (local, &e) in edges.iter().enumerate() {
                    let [a, b] = [1, 2].map(|k| self.vertices[corners[(local + k) % 3]]);
                    let middle = [0, 1].map(|c| (a[c] + b[c]) / 2.0 + bulges[e][c]);
                    nodal[self.vertices.len() + e] = middle;
                }
            }
        }
        nodal
    }

    /// C eps of it on triangle `t`.
    fn stress(&self, parts: &Parts, t: usize, triangle: &Triangle<f64>) -> Affine<f64> {
        let mesh = parts.mesh;
        let nodal = mesh.triangles()[t].map(|vertex| self.vertices[vertex].into());
        let bulges = self.bulges.as_ref();
        let bulges = bulges.map(|all| mesh.triangle_edges()[t].map(|e| all[e].into()));
        Affine::of_displacement(triangle, &nodal, bulges.as_ref(), parts.material(t))
    }
}

/// An edge of Gamma_C with what the solution says there.
pub(super) struct Contact {
    pub edge: BoundaryEdge,
    pub boundary: Arc<str>,
    pub length: f64,
    pub normal: Vector2<f64>,
    /// The direction of contact at both ends.
    pub directions: [Vector2<f64>; 2],
    /// g at both ends.
    pub gap: [f64; 2],
    /// What it is in the middle beyond their mean; 0 where it is known to be affine.
    pub gap_bulge: f64,
    /// int lambda^h n~ phi for them.
    moments: [Vector2<f64>; 2],
    /// c_E
    excess: Vector2<f64>,
    pressure: Profile,
    /// Pressure and moments on both halves of the edge.
    on_halves: [(Profile, [Vector2<f64>; 2]); 2],
}

/// tau_n along an edge of Gamma_C: affine, or with a jump at a place between the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Profile {
    /// The place.
    cut: Option<f64>,
    /// Before and after it, each at both ends.
    values: [[f64; 2]; 2],
}

impl Profile {
    fn whole(pressure: [f64; 2]) -> Profile {
        Profile { cut: None, values: [pressure; 2] }
    }

    /// lambda^h = -\[P\]+/gamma itself, for P with the values `p` at the ends.
    fn of_affine(p: [f64; 2], gamma: f64) -> Profile {
        let pressure = p.map(|p| -(p.max(0.0) / gamma));
        let [start, end] = positive_interval(p);
        let at = if p[0] > 0.0 { end } else { start };
        let changes = (p[0] > 0.0) != (p[1] > 0.0);
        let inside = NEAR_THE_END < at && at < 1.0 - NEAR_THE_END;
        if changes && inside {
            Profile { cut: Some(at), values: [[pressure[0], 0.0], [0.0, pressure[1]]] }
        } else {
            Profile::whole(pressure)
        }
    }

    /// The pressure with the moments `m` of a lambda^h that is not affine; `starts` tells whether P is positive at the start, `end`
    /// is the place where it changes its sign, if there is one only. Affine up to the end of contact, if the centroid is in
    /// the middle third of that; else up to three times the way to the centroid.
    fn of_moments(m: [f64; 2], starts: bool, end: Option<f64>) -> Profile {
        let force = m[0] + m[1];
        if !(force < 0.0) {
            return Profile::whole([0.0; 2]);
        }
        // Seen from where contact is, or where most of it is.
        let turned = if end.is_some() { !starts } else { m[1] < m[0] };
        let centroid = if turned { m[0] } else { m[1] } / force;
        let end = end.map_or(1.0, |end| if turned { 1.0 - end } else { end });
        let reach = match end.min(3.0 * centroid) {
            x if x <= 1.0 - LEAST_PART => x.max(LEAST_PART),
            // Three halves of the way would be enough.
            _ if 3.0 * centroid < 1.0 => 1.0 - LEAST_PART,
            _ => 1.0,
        };
        let place = (centroid / reach).clamp(1.0 / 3.0, 2.0 / 3.0);
        let mean = force / reach;
        let ends = [mean * (4.0 - 6.0 * place), mean * (6.0 * place - 2.0)].map(|p| p.min(0.0));
        match (reach < 1.0, turned) {
            (false, false) => Profile::whole(ends),
            (false, true) => Profile::whole([ends[1], ends[0]]),
            (true, false) => Profile { cut: Some(reach), values: [ends, [0.0; 2]] },
            (true, true) => {
                Profile { cut: Some(1.0 - reach), values: [[0.0; 2], [ends[1], ends[0]]] }
            }
        }
    }
}

impl Contact {
    fn new<E, const N: usize, const M: usize>(
        problem: &Problem,
        edge: &ContactLineEdge<N, M>,
        u: &[Vector2<f64>; N],
    ) -> Contact
    where
        E: ExactEdge<f64, N, M>,
    {
        let p = edge.p(u);
        // int \[P\]+ N_a; a hat function is N_a and half of that of the middle.
        let nodal = |p: [f64; M]| E::exact(p).gradient;
        let with_hats = |p: [f64; M]| {
            let nodal = nodal(p);
            let middle = nodal.get(2).copied();
            [0, 1].map(|a| middle.map_or(nodal[a], |m| nodal[a] + m / 2.0))
        };
        let positive = with_hats(p);
        let directions = [edge.directions[0], edge.directions[1]];
        let mesh = &problem.mesh;
        // On a part of the edge, `share` of its length, with P and the directions at its nodes.
        let straight = edge.directions.iter().all(|d| *d == edge.normal);
        let normal = mesh.triangle(edge.edge.triangle).scaled_normal(edge.edge.local);
        let moments = |p: [f64; M], directions: [Vector2<f64>; M], share: f64| {
            if straight {
                return with_hats(p).map(|p| normal * -(share * p / edge.gamma));
            }
            let nodal = nodal(p);
            let along = |a: usize, p: f64| directions[a] * -(share * edge.length * p / edge.gamma);
            [0, 1].map(|a| {
                let own = along(a, nodal[a]);
                nodal.get(2).map_or(own, |m| own + along(2, m / 2.0))
            })
        };
        let sigma_n = edge.sigma_n(u);
        let excess = Vector2::from([0, 1].map(|c| {
            let stress = integral_of_product(sigma_n, directions.map(|d| d[c]));
            -(positive[0] * directions[0][c] + positive[1] * directions[1][c]) - edge.gamma * stress
        }));
        let gap = [edge.gap[0], edge.gap[1]];
        let turns = directions[0] != directions[1];
        let condition = problem.conditions.get(&*edge.boundary);
        let gap_bulge = match (condition, edge.directions.get(2), edge.gap.get(2)) {
            // The direction in the middle is the mean of those at the ends, a little shorter than 1.
            (_, Some(d), Some(gap_there)) if turns => {
                let mean = (directions[0] + directions[1]) / 2.0;
                gap_there * mean.dot(d) - (gap[0] + gap[1]) / 2.0
            }
            (Some(Condition::Contact { gap }), ..) if !turns => {
                bulge_of(gap, mesh.ends(edge.edge).map(|vertex| mesh.vertices()[vertex]))
            }
            // The distance to a plane.
            _ => 0.0,
        };
        let profile = |p: [f64; M]| {
            let positive = with_hats(p);
            if turns {
                // The mean: then tau n is affine.
                Profile::whole([-((positive[0] + positive[1]) / edge.gamma); 2])
            } else if E::DEGREE == 1 {
                Profile::of_affine([p[0], p[1]], edge.gamma)
            } else {
                let mut ends = edge_integral::roots::<E, N, M>(p);
                let end = ends.next().filter(|_| ends.next().is_none());
                Profile::of_moments(positive.map(|p| -(p / edge.gamma)), p[0] > 0.0, end)
            }
        };
        let on_halves = [0.0, 0.5].map(|start| {
            let shapes = E::edge_positions().map(|s: f64| E::edge_values(start + s / 2.0));
            let here = shapes.map(|n| n.iter().zip(p).map(|(n, p)| n * p).sum());
            let directions =
                shapes.map(|n| n.iter().zip(&edge.directions).map(|(n, d)| d * *n).sum());
            (profile(here), moments(here, directions, 0.5))
        });
        Contact {
            edge: edge.edge,
            boundary: Arc::clone(&edge.boundary),
            length: edge.length,
            normal: edge.normal,
            directions,
            gap,
            gap_bulge,
            moments: moments(p, edge.directions, 1.0),
            excess,
            pressure: profile(p),
            on_halves,
        }
    }

    /// The directions, if they are not the normal.
    fn along(&self) -> Option<[[f64; 2]; 2]> {
        (self.directions != [self.normal; 2]).then(|| self.directions.map(<[f64; 2]>::from))
    }

    /// Whether the direction of contact turns along it.
    pub fn turns(&self) -> bool {
        self.directions[0] != self.directions[1]
    }
}

/// What `f` is in the middle of an edge beyond the mean of its ends; 0 where it is known to be affine.
pub(super) fn bulge_of(f: &SharedFunction, ends: [[f64; 2]; 2]) -> f64 {
    let [a, b] = ends;
    let middle = [0, 1].map(|c| (a[c] + b[c]) / 2.0);
    if is_within(f, 1) { 0.0 } else { f.at(middle) - (f.at(a) + f.at(b)) / 2.0 }
}

/// The parts of a problem that certificates are made from.
pub(super) struct Parts<'a> {
    pub problem: &'a Problem,
    pub mesh: &'a Mesh,
    /// Gamma_C.
    pub contact: Vec<Contact>,
    /// u_D at the vertices.
    pub prescribed: Vec<[Option<f64>; 2]>,
    /// What boundary edges are, by their numbers in the mesh.
    pub boundary: BTreeMap<usize, Boundary<'a>>,
}

impl<'a> Parts<'a> {
    /// # Errors
    /// Conditions that no composite stress can satisfy.
    pub fn new<E, const N: usize, const M: usize>(
        problem: &'a Problem,
        solution: &Solution,
    ) -> Result<Self, CertifyError>
    where
        E: ExactEdge<f64, N, M>,
    {
        let space = Space::<E, N, M>::new(&problem.mesh);
        let constraints = Constraints::new(problem, &space)?;
        let contact = contact_line::assemble(problem, &space, solution.gamma.gamma)?;
        let contact = contact.iter().map(|edge| {
            let u = space.on_triangle(edge.edge.triangle, &solution.displacement);
            Contact::new::<E, N, M>(problem, edge, &u)
        });
        let contact: Vec<Contact> = contact.collect();
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
                    Condition::Displacement(functions) => Boundary::Held(
                        [functions[0].is_some(), functions[1].is_some()],
                        functions.each_ref().map(Option::as_ref),
                    ),
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
                        Boundary::Held(held, displacement.each_ref().map(Option::as_ref))
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
                        Boundary::Held(held, [None; 2])
                    }
                    Condition::Traction(traction) => Boundary::Loaded(Traction::Vector(traction)),
                    Condition::Pressure(p) => Boundary::Loaded(Traction::Pressure(p)),
                    Condition::Contact { .. } | Condition::Obstacle(..) => continue,
                };
                let what = match what {
                    Boundary::Held([false, false], _) => Boundary::Free,
                    what => what,
                };
                boundary.insert(number(edge), what);
            }
        }
        for (k, edge) in contact.iter().enumerate() {
            boundary.insert(number(edge.edge), Boundary::Contact(k));
        }
        let prescribed = constraints.values()[..mesh.vertices().len()].to_vec();
        Ok(Parts { problem, mesh, contact, prescribed, boundary })
    }

    /// Gives v the bulges of u_D on Gamma_D.
    fn hold_between(&self, bulges: &mut [[f64; 2]]) {
        for (corners, edges) in self.mesh.triangles().iter().zip(self.mesh.triangle_edges()) {
            for (local, &e) in edges.iter().enumerate() {
                let Some(Boundary::Held(held, _)) = self.boundary.get(&e) else { continue };
                let ends = [1, 2].map(|k| self.mesh.vertices()[corners[(local + k) % 3]]);
                let data = self.prescribed_bulge(e, ends);
                (0..2).filter(|&c| held[c]).for_each(|c| bulges[e][c] = data[c]);
            }
        }
    }

    /// u_D beyond the mean of the ends in the middle of an edge of Gamma_D; 0 where it is known to be affine.
    fn prescribed_bulge(&self, e: usize, ends: [[f64; 2]; 2]) -> [f64; 2] {
        let Some(Boundary::Held(held, functions)) = self.boundary.get(&e) else { return [0.0; 2] };
        [0, 1].map(|c| match functions[c] {
            Some(f) if held[c] => bulge_of(f, ends),
            _ => 0.0,
        })
    }

    /// The contact boundaries whose direction turns along an edge, so that it and the gap are known at vertices only.
    pub fn turning(&self) -> BTreeSet<&str> {
        let turning = self.contact.iter().filter(|edge| edge.turns());
        turning.map(|edge| &*edge.boundary).collect()
    }

    /// What triangle `t` is made of.
    pub fn material(&self, t: usize) -> &Material<f64> {
        self.problem.material.of(t)
    }
}

/// v: u with the prescribed values, and pushed out of the obstacle at the vertices of Gamma_C and, if it is quadratic, between
/// them.
pub(super) fn admissible(parts: &Parts, u: &Field) -> Field {
    let mut field = u.clone();
    let v = &mut field.vertices;
    for (v, data) in v.iter_mut().zip(&parts.prescribed) {
        for c in 0..2 {
            if let Some(data) = data[c] {
                v[c] = data;
            }
        }
    }
    let reach = parts.mesh.vertices().iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
    let size = u.vertices.iter().flatten().fold(0.0_f64, |max, u| max.max(u.abs()));
    // At a corner two edges push; the second may push back into the first, so some rounds.
    for _ in 0..8 {
        let mut moved = false;
        for edge in &parts.contact {
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
            if edge.turns() && u.bulges.is_none() {
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
    if let Some(bulges) = &mut field.bulges {
        parts.hold_between(bulges);
        for edge in &parts.contact {
            let BoundaryEdge { triangle, local } = edge.edge;
            let bulge = &mut bulges[parts.mesh.triangle_edges()[triangle][local]];
            let at_ends =
                parts.mesh.ends(edge.edge).map(|vertex| Vector2::from(field.vertices[vertex]));
            push_between(edge, at_ends, bulge, [reach, size]);
        }
    }
    field
}

/// Makes the Bernstein coefficients of v . d - g between the ends of an edge of Gamma_C negative, by the bulge of v. The body
/// reaches as far out as `reach` and v is at most `size`.
fn push_between(
    edge: &Contact,
    v: [Vector2<f64>; 2],
    bulge: &mut [f64; 2],
    [reach, size]: [f64; 2],
) {
    let ([d, e], [g, h]) = (edge.directions, edge.gap);
    let (mean, own) = ((d + e) / 2.0, Vector2::from(*bulge));
    let middle = (v[0] + v[1]) / 2.0 + own * 2.0;
    let between = (g + h) / 2.0 + 2.0 * edge.gap_bulge;
    let tilted = if d[0] != 0.0 && d[1] != 0.0 { size } else { 0.0 };
    let largest = v[0].dot(&d).abs() + v[1].dot(&e).abs() + own.dot(&d).abs() + tilted;
    let scale = largest + g.abs() + h.abs() + edge.gap_bulge.abs();
    let margin = 64.0 * f64::EPSILON * scale * reach / edge.length / NEAR_THE_END;
    let step = if edge.turns() {
        // v . d is a cubic: three times its coefficients.
        let one = 2.0 * (middle.dot(&d) - between) + v[0].dot(&e) - g;
        let other = 2.0 * (middle.dot(&e) - between) + v[1].dot(&d) - h;
        let step = |beyond: f64, along: f64| (beyond + 6.0 * margin) / (4.0 * along);
        step(one, mean.dot(&d)).max(step(other, mean.dot(&e)))
    } else {
        (middle.dot(&d) - between + 2.0 * margin) / (2.0 * d.dot(&d))
    };
    if step > 0.0 {
        *bulge = (own - mean * step).into();
    }
}

/// A certificate with equilibrated tractions, before any improvement.
pub(super) struct Built {
    pub certificate: Certificate,
    /// The triangles of the mesh that its pieces come from.
    pub origins: Vec<usize>,
    /// What the data of the problem leave out.
    pub oscillation: Oscillation,
    /// Its triangles are quarters of those of the mesh.
    quartered: bool,
    divisions: Vec<Division>,
}

/// A triangle that was cut in two, from a place on the edge `base` to the opposite vertex. The edge's second part and the cut
/// are the next two edges of the certificate.
struct Division {
    /// The ends of the edge, and the place between them.
    ends: [usize; 2],
    at: f64,
    /// The edge, whose first part keeps its number.
    base: usize,
    /// The edges from the opposite vertex to both ends.
    sides: [usize; 2],
}

impl Built {
    /// A displacement of the mesh on the pieces: given at the vertices, and at the middles of the edges if it is quadratic.
    pub fn shape<S: Enclosing>(&self, mesh: &Mesh, nodal: &[[f64; 2]]) -> Shape<S> {
        let (ends, middles) = nodal.split_at(mesh.vertices().len());
        let points: Vec<Vector2<S>> = ends.iter().map(|&v| exactly(v)).collect();
        let bulges = (!middles.is_empty()).then(|| {
            let mut bulges = vec![Vector2::zeros(); middles.len()];
            for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
                for (local, &e) in edges.iter().enumerate() {
                    let [a, b] = [1, 2].map(|k| points[corners[(local + k) % 3]]);
                    bulges[e] = exactly::<S>(middles[e]) - (a + b) / S::from(2);
                }
            }
            bulges
        });
        let shape = Shape { points, bulges };
        let shape = if self.quartered { halved(shape, mesh, &mesh_edges(mesh)) } else { shape };
        divided(shape, &self.divisions)
    }
}

/// The ends of the mesh's edges, each as the first triangle that has it sees it.
fn mesh_edges(mesh: &Mesh) -> Vec<[usize; 2]> {
    let mut ends = vec![None; mesh.edge_count()];
    for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
        for local in 0..3 {
            ends[edges[local]].get_or_insert([corners[(local + 1) % 3], corners[(local + 2) % 3]]);
        }
    }
    ends.into_iter().map(Option::unwrap_or_default).collect()
}

/// The same displacement with values in the middles of the mesh's edges, and bulges on their halves and on the edges between
/// middles: each is parallel to an edge and half as long, and the second difference of a quadratic along it is a quarter.
fn halved<S: Enclosing>(mut shape: Shape<S>, mesh: &Mesh, ends: &[[usize; 2]]) -> Shape<S> {
    let vertices = shape.points.len();
    for (e, [a, b]) in ends.iter().enumerate() {
        let mean = (shape.points[*a] + shape.points[*b]) / S::from(2);
        shape.points.push(shape.bulges.as_ref().map_or(mean, |bulges| mean + bulges[e]));
    }
    debug_assert_eq!(shape.points.len(), vertices + ends.len());
    shape.bulges = shape.bulges.map(|bulges| {
        let quarters = bulges.iter().map(|&bulge| bulge / S::from(4));
        let inside = mesh.triangle_edges().iter().flatten().map(|&e| bulges[e] / S::from(4));
        quarters.clone().chain(quarters).chain(inside).collect()
    });
    shape
}

/// The same displacement with values at the cuts, and bulges on their edges: on a part of length s of an edge, s^2 times the bulge
/// b of the whole; on the cut, the second difference of the quadratic along it.
fn divided<S: Enclosing>(mut shape: Shape<S>, divisions: &[Division]) -> Shape<S> {
    for division in divisions {
        let s = S::exactly(division.at);
        let r = S::from(1) - s;
        let [a, b] = division.ends.map(|end| shape.points[end]);
        let mut there = a * r + b * s;
        if let Some(bulges) = &mut shape.bulges {
            let bulge = bulges[division.base];
            let [to_a, to_b] = division.sides.map(|e| bulges[e]);
            there += bulge * (S::from(4) * r * s);
            bulges[division.base] = bulge * (s * s);
            bulges.push(bulge * (r * r));
            bulges.push(to_a * r + to_b * s - bulge * (r * s));
        }
        shape.points.push(there);
    }
    shape
}

/// The certificate of the stress of `u` and of the displacement `v`.
pub(super) fn build(parts: &Parts, u: &Field, v: &Field) -> Built {
    let mesh = parts.mesh;
    let data = oscillation::Data::new(parts.problem);
    let whole: Vec<Triangle<f64>> = (0..mesh.triangles().len()).map(|t| mesh.triangle(t)).collect();
    let stress = stresses(parts, u, &whole);
    let bodies: Vec<[Vector2<f64>; 3]> =
        whole.iter().enumerate().map(|(t, triangle)| data.body_on(t, triangle)).collect();
    let moments = moments(parts, &bodies, &whole, &stress);
    let quadratic = v.bulges.is_some();
    // A stress that is constant on the triangles says nothing of their quarters.
    let quartered = quadratic && u.bulges.is_some();
    let mut built = Built {
        certificate: Certificate {
            vertices: mesh.vertices().to_vec(),
            cuts: Vec::new(),
            displacement: v.vertices.clone(),
            curved: quadratic.then(Curved::default),
            prescribed: parts.prescribed.clone(),
            pieces: Vec::with_capacity(whole.len()),
            edges: Vec::with_capacity(mesh.edge_count()),
        },
        origins: Vec::with_capacity(whole.len()),
        oscillation: Oscillation::new(parts, quadratic),
        quartered,
        divisions: Vec::new(),
    };
    let ends = mesh_edges(mesh);
    if quartered {
        add_halves(parts, &ends, &moments, &mut built);
    } else {
        add_edges(parts, &ends, &moments, &mut built);
    }
    let cut_up = |t: usize| {
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (vertices, edges) = (mesh.triangles()[t], mesh.triangle_edges()[t]);
        vec![(Part { vertices, edges, places: unit }, bodies[t])]
    };
    let all: Vec<Vec<(Part, [Vector2<f64>; 3])>> = if quartered {
        (0..whole.len()).map(|t| quarters(parts, &data, t, &stress[t], &mut built)).collect()
    } else {
        (0..whole.len()).map(cut_up).collect()
    };
    for (t, found) in all.into_iter().enumerate() {
        for (part, body) in found {
            add_part(parts, &data, (t, &stress[t]), (part, body), &mut built);
        }
        built.origins.resize(built.certificate.pieces.len(), t);
    }
    let Built { certificate, origins, oscillation, divisions, .. } = &mut built;
    if let (Some(curved), Some(bulges)) = (&mut certificate.curved, &v.bulges) {
        let vectors = |values: &[[f64; 2]]| values.iter().copied().map(Vector2::from).collect();
        let shape = Shape { points: vectors(&v.vertices), bulges: Some(vectors(bulges)) };
        let shape = if quartered { halved(shape, mesh, &ends) } else { shape };
        let shape = divided::<f64>(shape, divisions);
        curved.at_cuts = shape.points[v.vertices.len()..].iter().map(|&v| v.into()).collect();
        curved.bulges = shape.bulges.iter().flatten().map(|&v| v.into()).collect();
        // v is what is prescribed, in the middles too.
        curved.prescribed = vec![[None; 2]; curved.at_cuts.len()];
        for edge in &certificate.edges {
            let Role::Held(held, _) = edge.role else { continue };
            for cut in edge.ends.iter().filter_map(|end| end.checked_sub(v.vertices.len())) {
                (0..2)
                    .filter(|&c| held[c])
                    .for_each(|c| curved.prescribed[cut][c] = Some(curved.at_cuts[cut][c]));
            }
        }
    }
    oscillation.measure(parts, &data, certificate, (origins, quartered));
    built
}

/// The affine force, per unit of an edge's parameter, that has the moments `m` with the hat functions of the ends.
fn force_of(m: &[Vector2<f64>; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|k| [0, 1].map(|c| 4.0 * m[k][c] - 2.0 * m[1 - k][c]))
}

/// The force on the held components.
fn held_only(held: [bool; 2], force: [[f64; 2]; 2]) -> Role {
    Role::Held(held, force.map(|f| [0, 1].map(|c| if held[c] { f[c] } else { 0.0 })))
}

/// The edges of the mesh.
fn add_edges(parts: &Parts, all: &[[usize; 2]], moments: &[[Vector2<f64>; 2]], built: &mut Built) {
    for (e, (&ends, m)) in all.iter().zip(moments).enumerate() {
        let force = force_of(m);
        let places = ends.map(|vertex| parts.mesh.vertices()[vertex]);
        let mut bulge = [0.0; 2];
        let role = match parts.boundary.get(&e) {
            None => Role::Inner(force),
            Some(Boundary::Held(held, _)) => {
                bulge = parts.prescribed_bulge(e, places);
                held_only(*held, force)
            }
            Some(Boundary::Free) => Role::Loaded([[0.0; 2]; 2]),
            Some(Boundary::Loaded(traction)) => traction.affine(places, force),
            Some(Boundary::Contact(k)) => {
                let edge = &parts.contact[*k];
                bulge[0] = edge.gap_bulge;
                let (pressure, along) = (edge.pressure.values[0], edge.along());
                Role::Contact { pressure, gap: edge.gap, along }
            }
        };
        built.certificate.edges.push(Edge { ends, role });
        if let Some(curved) = &mut built.certificate.curved {
            curved.data.push(bulge);
        }
    }
}

/// The halves of the edges of the mesh, first all first ones, then all second ones; the middles of the edges are the first cuts.
fn add_halves(parts: &Parts, all: &[[usize; 2]], moments: &[[Vector2<f64>; 2]], built: &mut Built) {
    let certificate = &mut built.certificate;
    certificate.cuts = all.iter().map(|&ends| Cut { ends, at: 0.5 }).collect();
    let vertices = certificate.vertices.len();
    let mut data = Vec::with_capacity(2 * all.len());
    for half in 0..2 {
        for (e, (&[a, b], m)) in all.iter().zip(moments).enumerate() {
            let ends = if half == 0 { [a, vertices + e] } else { [vertices + e, b] };
            let places = || ends.map(|p| place(certificate, p));
            // Per unit of the half's parameter it is half of that per unit of the edge's.
            let whole = force_of(m).map(|f| Vector2::from(f) / 2.0);
            let middle = (whole[0] + whole[1]) / 2.0;
            let force = if half == 0 { [whole[0], middle] } else { [middle, whole[1]] };
            let force = force.map(<[f64; 2]>::from);
            let mut bulge = [0.0; 2];
            let role = match parts.boundary.get(&e) {
                None => Role::Inner(force),
                Some(Boundary::Held(held, _)) => {
                    let ends = [a, b].map(|vertex| parts.mesh.vertices()[vertex]);
                    bulge = parts.prescribed_bulge(e, ends).map(|bulge| bulge / 4.0);
                    held_only(*held, force)
                }
                Some(Boundary::Free) => Role::Loaded([[0.0; 2]; 2]),
                Some(Boundary::Loaded(traction)) => {
                    let [start, end] = places();
                    let ends = [start, end].map(<[f64; 2]>::from);
                    let normal = Vector2::new(end.y - start.y, start.x - end.x);
                    traction.affine(ends, force_of(&traction.moments(ends, normal)))
                }
                Some(Boundary::Contact(k)) => {
                    let edge = &parts.contact[*k];
                    bulge[0] = edge.gap_bulge / 4.0;
                    let [g, h] = edge.gap;
                    let middle = (g + h) / 2.0 + edge.gap_bulge;
                    let gap = if half == 0 { [g, middle] } else { [middle, h] };
                    let along = edge.along().map(|[d, e]| {
                        let middle = [0, 1].map(|c| (d[c] + e[c]) / 2.0);
                        if half == 0 { [d, middle] } else { [middle, e] }
                    });
                    Role::Contact { pressure: edge.on_halves[half].0.values[0], gap, along }
                }
            };
            certificate.edges.push(Edge { ends, role });
            data.push(bulge);
        }
    }
    if let Some(curved) = &mut certificate.curved {
        curved.data = data;
    }
}

/// The four triangles of triangle `t` between its corners and the middles of its edges, each with its body force. On an edge
/// between middles tau N is that of sigma(u) and what balances the corner that it cuts off; the triangle in the middle is in
/// equilibrium with the whole.
fn quarters(
    parts: &Parts,
    data: &oscillation::Data,
    t: usize,
    stress: &Affine<f64>,
    built: &mut Built,
) -> Vec<(Part, [Vector2<f64>; 3])> {
    let (corners, edges) = (parts.mesh.triangles()[t], parts.mesh.triangle_edges()[t]);
    let (vertices, count) = (parts.mesh.vertices().len(), parts.mesh.edge_count());
    let certificate = &mut built.certificate;
    let middles = edges.map(|e| vertices + e);
    let inside = [0, 1, 2].map(|i| certificate.edges.len() + i);
    let at_middle = |i: usize| [0, 1, 2].map(|l| if l == i { 0.0 } else { 0.5 });
    let mut found = Vec::with_capacity(4);
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        // As t is numbered: its corner i, and the middles of the edges there.
        let (mut part, mut own, mut places) = (middles, inside, [0, 1, 2].map(at_middle));
        (part[i], part[j], part[k]) = (corners[i], middles[k], middles[j]);
        places[i] = [0, 1, 2].map(|l| if l == i { 1.0 } else { 0.0 });
        (places[j], places[k]) = (at_middle(k), at_middle(j));
        for l in [j, k] {
            let first = certificate.edges[edges[l]].ends.contains(&corners[i]);
            own[l] = if first { edges[l] } else { count + edges[l] };
        }
        let triangle = Triangle { vertices: part.map(|p| place(certificate, p)) };
        let mut forces = [[Vector2::zeros(); 2]; 3];
        for l in [j, k] {
            let ends = [part[(l + 1) % 3], part[(l + 2) % 3]];
            forces[l] = outward(parts, certificate, own[l], ends, triangle.scaled_normal(l));
        }
        forces[i] =
            [places[j], places[k]].map(|l| stress.at(l).traction(triangle.scaled_normal(i)));
        let body = data.body_on(t, &triangle);
        let off = Loads { forces, body }.resultant(&triangle);
        let balance = off.on_edge(triangle.vertices[j], triangle.vertices[k]);
        let force = [0, 1].map(|end| (forces[i][end] - balance[end]).into());
        certificate.edges.push(Edge { ends: [part[j], part[k]], role: Role::Inner(force) });
        if let Some(curved) = &mut certificate.curved {
            curved.data.push([0.0; 2]);
        }
        found.push((Part { vertices: part, edges: own, places }, body));
    }
    let triangle = Triangle { vertices: middles.map(|p| place(certificate, p)) };
    let places = [0, 1, 2].map(at_middle);
    found.push((Part { vertices: middles, edges: inside, places }, data.body_on(t, &triangle)));
    found
}

/// The force on half `e` of an edge towards the outside of a triangle that goes along it between these ends.
fn outward(
    parts: &Parts,
    certificate: &Certificate,
    e: usize,
    ends: [usize; 2],
    normal: Vector2<f64>,
) -> [Vector2<f64>; 2] {
    let (edge, count) = (&certificate.edges[e], parts.mesh.edge_count());
    match edge.role {
        Role::Inner(force) | Role::Held(_, force) => {
            let [a, b] = force.map(Vector2::from);
            if edge.ends == ends { [a, b] } else { [-b, -a] }
        }
        Role::Loaded(traction) => traction.map(|t| Vector2::from(t) * length(normal)),
        Role::Pressed(p) => p.map(|p| normal * -p),
        Role::Contact { .. } => match parts.boundary.get(&(e % count)) {
            Some(&Boundary::Contact(k)) => {
                force_of(&parts.contact[k].on_halves[e / count].1).map(Vector2::from)
            }
            _ => [Vector2::zeros(); 2],
        },
    }
}

/// The pressure on edge `e` and the bulge of the gap, where it is one of Gamma_C or the half of one.
fn on_contact(parts: &Parts, quartered: bool, e: usize) -> Option<(Profile, f64)> {
    let count = parts.mesh.edge_count();
    let half = e / count;
    if half > usize::from(quartered) {
        return None;
    }
    let Some(&Boundary::Contact(k)) = parts.boundary.get(&(e % count)) else { return None };
    let edge = &parts.contact[k];
    Some(if quartered {
        (edge.on_halves[half].0, edge.gap_bulge / 4.0)
    } else {
        (edge.pressure, edge.gap_bulge)
    })
}

/// Contact that ends this near an end of its edge, in units of the edge, leaves it whole: the triangles would be slivers.
const NEAR_THE_END: f64 = 1e-3;

/// The least part of an edge that is cut off where lambda^h is not affine: a sliver bounds badly, and the force of what is
/// shorter has so little moment that the balance of the triangles may carry it.
const LEAST_PART: f64 = 0.15;

/// A triangle of the mesh or a part of it.
struct Part {
    vertices: [usize; 3],
    edges: [usize; 3],
    /// The barycentric coordinates of its vertices in the triangle of the mesh.
    places: [[f64; 3]; 3],
}

/// A part of triangle `t`, cut where contact ends on one of its edges.
fn add_part(
    parts: &Parts,
    data: &oscillation::Data,
    (t, stress): (usize, &Affine<f64>),
    (part, body): (Part, [Vector2<f64>; 3]),
    built: &mut Built,
) {
    let (corners, edges) = (part.vertices, part.edges);
    let mut found = vec![part];
    for e in edges {
        let Some((profile, gap_bulge)) = on_contact(parts, built.quartered, e) else { continue };
        let Profile { cut: Some(at), values } = profile else { continue };
        let Some(owner) = found.iter().position(|part| part.edges.contains(&e)) else { continue };
        let part = found.remove(owner);
        found.extend(cut(part, (e, at, values), gap_bulge, stress, built));
    }
    let material = [parts.material(t).lambda(), parts.material(t).mu()];
    for Part { vertices, edges, .. } in found {
        let certificate = &mut built.certificate;
        let own = || {
            let triangle = Triangle { vertices: vertices.map(|p| place(certificate, p)) };
            data.body_on(t, &triangle)
        };
        let body = if vertices == corners { body } else { own() }.map(Into::into);
        certificate.pieces.push(Piece { vertices, edges, material, body, oscillation: 0.0 });
    }
}

/// Both halves of a part whose edge `base` is cut at a place, with the pressures before and after it.
fn cut(
    part: Part,
    (base, at, pressures): (usize, f64, [[f64; 2]; 2]),
    gap_bulge: f64,
    stress: &Affine<f64>,
    built: &mut Built,
) -> Vec<Part> {
    let certificate = &mut built.certificate;
    let local = part.edges.iter().position(|&e| e == base).unwrap_or_default();
    let [a, b, c] = [0, 1, 2].map(|k| part.vertices[(local + k) % 3]);
    let [at_a, at_b, at_c] = [0, 1, 2].map(|k| part.places[(local + k) % 3]);
    let [next, last] = [1, 2].map(|k| part.edges[(local + k) % 3]);
    let Role::Contact { gap, along, .. } = certificate.edges[base].role else { return vec![part] };
    let middle = certificate.vertices.len() + certificate.cuts.len();
    let (whole, at) = on_whole(certificate, [b, c], at);
    certificate.cuts.push(whole);
    let gap_bulge = if certificate.curved.is_some() { gap_bulge } else { 0.0 };
    let inside = gap[0] + at * (gap[1] - gap[0]) + 4.0 * at * (1.0 - at) * gap_bulge;
    let [first, second] = pressures;
    // The first half keeps the number of the edge.
    certificate.edges[base] = Edge {
        ends: [b, middle],
        role: Role::Contact { pressure: first, gap: [gap[0], inside], along },
    };
    let other = certificate.edges.len();
    certificate.edges.push(Edge {
        ends: [middle, c],
        role: Role::Contact { pressure: second, gap: [inside, gap[1]], along },
    });
    let [from, to] = [middle, a].map(|p| place(certificate, p));
    let normal = Vector2::new(to.y - from.y, from.x - to.x);
    let at_middle = [0, 1, 2].map(|i| at_b[i] + at * (at_c[i] - at_b[i]));
    let force = [at_middle, at_a].map(|l| stress.at(l).traction(normal).into());
    certificate.edges.push(Edge { ends: [middle, a], role: Role::Inner(force) });
    if let Some(curved) = &mut certificate.curved {
        curved.data[base] = [gap_bulge * at * at, 0.0];
        curved.data.push([gap_bulge * (1.0 - at) * (1.0 - at), 0.0]);
        curved.data.push([0.0; 2]);
    }
    built.divisions.push(Division { ends: [b, c], at, base, sides: [last, next] });
    vec![
        Part {
            vertices: [a, b, middle],
            edges: [base, other + 1, last],
            places: [at_a, at_b, at_middle],
        },
        Part {
            vertices: [a, middle, c],
            edges: [other, next, other + 1],
            places: [at_a, at_middle, at_c],
        },
    ]
}

/// A place on an edge between two vertices, or on a half of one, as a place on the whole; and the place that this is on the
/// half, exactly.
fn on_whole(certificate: &Certificate, ends: [usize; 2], at: f64) -> (Cut, f64) {
    let half =
        |p: usize| p.checked_sub(certificate.vertices.len()).map(|cut| certificate.cuts[cut]);
    match ends.map(half) {
        [None, Some(Cut { ends, .. })] => (Cut { ends, at: at / 2.0 }, at),
        [Some(Cut { ends, .. }), _] => {
            let on_whole = 0.5 + at / 2.0;
            (Cut { ends, at: on_whole }, 2.0 * on_whole - 1.0)
        }
        [None, None] => (Cut { ends, at }, at),
    }
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

/// s_T on each triangle, and beside it what sigma(u) has beyond its mean.
fn stresses(parts: &Parts, u: &Field, triangles: &[Triangle<f64>]) -> Vec<Affine<f64>> {
    let of_u = |(t, triangle): (usize, &Triangle<f64>)| {
        let sigma = u.stress(parts, t, triangle);
        let mean = sigma.mean();
        let beyond = sigma.beyond.map(|_| [0, 1, 2].map(|i| sigma.at_corner(i) - mean));
        Affine { base: mean, beyond }
    };
    let mut stress: Vec<Affine<f64>> = triangles.iter().enumerate().map(of_u).collect();
    for edge in &parts.contact {
        let (t, n) = (edge.edge.triangle, edge.normal);
        let factor = edge.length / (triangles[t].double_area() / 2.0);
        let strain = Matrix2::from_fn(|i, j| factor * edge.excess[i] * n[j]);
        stress[t].base = stress[t].base + parts.material(t).stress(strain);
    }
    stress
}

/// The moments of the traction on each edge with the hat functions of its ends, towards the outside of the first triangle
/// that has the edge.
fn moments(
    parts: &Parts,
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
        let here = stress[t].base.traction(normal);
        let force = match second {
            Some((other, _)) => (here + stress[other].base.traction(normal)) / 2.0,
            None => here,
        };
        moments[e] = [force / 2.0; 2];
        // What comes to the mean, p and q at the ends, has the moments (2 p + q) / 6 and (p + 2 q) / 6.
        let ends = [1, 2].map(|k| corners[t][(local + k) % 3]);
        let sides = if second.is_some() { 2.0 } else { 1.0 };
        for (other, _) in owner.iter().flatten() {
            let Some(beyond) = &stress[*other].beyond else { continue };
            for (corner, beyond) in corners[*other].iter().zip(beyond) {
                let Some(k) = ends.iter().position(|end| end == corner) else { continue };
                let sixth = beyond.traction(normal) / (6.0 * sides);
                moments[e][k] += sixth * 2.0;
                moments[e][1 - k] += sixth;
            }
        }
        match parts.boundary.get(&e) {
            None => {}
            Some(Boundary::Held(held, _)) => {
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
                moments[e] = parts.contact[*k].moments;
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
    stress: &'a [Affine<f64>],
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
            sum = sum - around.stress[t].base.traction(normal) / 2.0 - around.load(t, l);
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
pub(super) fn averaging_estimate(parts: &Parts, v: &Field) -> f64 {
    let mesh = parts.mesh;
    let place = |t: usize| parts.problem.material.place_of(t);
    let zero = Stress::new([0.0; 3]);
    // At each vertex the sums and weights of the few materials there.
    let mut sums: Vec<Vec<(usize, Stress<f64>, f64)>> = vec![Vec::new(); mesh.vertices().len()];
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let triangle = mesh.triangle(t);
        let (stress, area) = (v.stress(parts, t, &triangle), triangle.double_area());
        for (i, &vertex) in corners.iter().enumerate() {
            let s = stress.at_corner(i);
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
        let stress = v.stress(parts, t, &triangle);
        let mut total = zero;
        let mut share = 0.0;
        for (i, &vertex) in corners.iter().enumerate() {
            let known = sums[vertex].iter().find(|(material, ..)| *material == place(t));
            let Some(&(_, sum, weight)) = known else { continue };
            let difference = sum / weight - stress.at_corner(i);
            share += complementary(parts.material(t), difference);
            total = total + difference;
        }
        square += (share + complementary(parts.material(t), total)) * triangle.double_area() / 24.0;
    }
    square.sqrt()
}
