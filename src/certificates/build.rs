//! A certificate from a discrete solution: v as it was made admissible, tau by equilibrated tractions (`tractions`), on the
//! triangles of the mesh or on their quarters (`quarters`), cut where contact ends or faces a node of another body (`divide`).

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;

use super::binding::sorted;
use super::certificate::{
    Certificate, Curved, Cut, Edge, Law, Piece, Role, Shape, exactly, is_oblique, place,
};
use super::data::{Data, force_of};
use super::divide::{Division, SubTriangle, cut, divided};
use super::field::{Field, edge_ends};
use super::oscillation::Oscillation;
use super::parts::{Boundary, ProblemParts};
use super::quarters::{halved, quarters};
use super::tractions::{moments, stresses, with_force};
use crate::kernel::composite::Affine;
use crate::kernel::{Enclosing, Triangle};
use crate::model::Mesh;
use crate::model::boundary_normals::SmoothBoundary;
use crate::model::mesh::length;

/// A certificate with equilibrated tractions, before any improvement.
pub(super) struct Built {
    pub(crate) certificate: Certificate,
    /// The triangles of the mesh that its pieces come from.
    pub(crate) origins: Vec<usize>,
    /// The oscillation of the data.
    pub(crate) oscillation: Oscillation,
    /// Its triangles are quarters of those of the mesh.
    quartered: bool,
    pub(crate) divisions: Vec<Division>,
}

/// The boundaries of the problem on the edges of a certificate.
pub(super) struct Line {
    pub(crate) names: Vec<String>,
    /// The boundary of each edge, by its place among the names.
    pub(crate) of: Vec<Option<usize>>,
    /// The edges of Gamma_C, along it.
    pub(crate) stations: Vec<Station>,
}

/// An edge of Gamma_C along its boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Station {
    pub(crate) edge: usize,
    /// Arc length at its ends.
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) ends: [[f64; 2]; 2],
    /// The edge starts where the edge before it ends.
    pub(crate) joined: bool,
}

/// The edges of a certificate along those of a mesh, each with the places where it begins and ends there.
struct Along(BTreeMap<usize, Vec<(usize, [f64; 2])>>);

impl Along {
    fn of(&self, whole: usize) -> &[(usize, [f64; 2])] {
        self.0.get(&whole).map_or(&[], Vec::as_slice)
    }
}

impl Built {
    /// A displacement of the mesh on the pieces: given at the vertices, and at the middles of the edges if it is quadratic.
    pub(crate) fn shape<S: Enclosing>(&self, mesh: &Mesh, nodal: &[[f64; 2]]) -> Shape<S> {
        let (nodal, middles) = nodal.split_at(mesh.vertices().len());
        let points: Vec<Vector2<S>> = nodal.iter().map(|&v| exactly(v)).collect();
        let ends = edge_ends(mesh);
        let beyond = |([a, b], middle): (&[usize; 2], &[f64; 2])| {
            exactly::<S>(*middle) - (points[*a] + points[*b]) / S::from(2)
        };
        let bulges = (!middles.is_empty()).then(|| ends.iter().zip(middles).map(beyond).collect());
        self.on_pieces(Shape { points, bulges }, mesh, &ends)
    }

    /// A displacement of the mesh, whose edges have these ends, on the pieces.
    fn on_pieces<S: Enclosing>(
        &self,
        shape: Shape<S>,
        mesh: &Mesh,
        ends: &[[usize; 2]],
    ) -> Shape<S> {
        let shape = if self.quartered { halved(shape, mesh, ends) } else { shape };
        divided(shape, &self.divisions)
    }

    /// The edges of Gamma_C, by their numbers in `parts`, of the triangles where v can't be shown to be outside the obstacle,
    /// and how far it may be inside.
    pub(crate) fn penetrations(&self, parts: &ProblemParts) -> Vec<(usize, f64)> {
        let by_edge: BTreeMap<usize, f64> = self.certificate.penetrations().into_iter().collect();
        let mut of: BTreeMap<usize, f64> = BTreeMap::new();
        for (piece, &t) in self.certificate.pieces.iter().zip(&self.origins) {
            for by in piece.edges.iter().filter_map(|e| by_edge.get(e)) {
                let most = of.entry(t).or_default();
                *most = most.max(*by);
            }
        }
        let contact = parts.contact.iter().enumerate();
        contact.filter_map(|(k, edge)| Some((k, *of.get(&edge.edge.triangle)?))).collect()
    }

    /// Where the boundaries of the problem are on the edges of the certificate.
    pub(crate) fn line(&self, parts: &ProblemParts) -> Line {
        let (mesh, edges) = (parts.mesh, &self.certificate.edges);
        let along = self.along(mesh);
        let mut line =
            Line { names: Vec::new(), of: vec![None; edges.len()], stations: Vec::new() };
        let of_pairs = parts.problem.pairs.iter().map(|pair| &pair.boundaries[0]);
        for name in parts.problem.conditions.keys().chain(of_pairs) {
            if line.names.contains(name) {
                continue;
            }
            for &edge in mesh.edges_of(name).unwrap_or_default() {
                let whole = mesh.number_of(edge);
                along.of(whole).iter().for_each(|&(e, _)| line.of[e] = Some(line.names.len()));
            }
            line.names.push(name.clone());
        }
        let mut before: Option<(usize, usize)> = None;
        let mut arc = 0.0;
        for contact in &parts.contact {
            let whole = mesh.number_of(contact.edge);
            for &(e, [s, t]) in along.of(whole) {
                let (ends, Some(name)) = (edges[e].ends, line.of[e]) else { continue };
                if !contact.sides[0].has((s + t) / 2.0) {
                    continue;
                }
                if before.is_none_or(|(boundary, _)| boundary != name) {
                    arc = 0.0;
                }
                let joined = before == Some((name, ends[0]));
                let [a, b] = ends.map(|p| place(&self.certificate, p));
                let from = arc;
                arc += length(b - a);
                let ends_at = [a.into(), b.into()];
                line.stations.push(Station { edge: e, from, to: arc, ends: ends_at, joined });
                before = Some((name, ends[1]));
            }
        }
        line
    }

    /// The edges of the certificate along those of the outline.
    fn along(&self, mesh: &Mesh) -> Along {
        let (count, halves) = (mesh.edge_count(), if self.quartered { 2 } else { 1 });
        // A division keeps its edge for the first part and adds the second one and the cut.
        let first = self.certificate.edges.len() - 2 * self.divisions.len();
        let mut seconds: BTreeMap<usize, Vec<(usize, [f64; 3])>> = BTreeMap::new();
        for (i, division) in self.divisions.iter().enumerate() {
            seconds.entry(division.base).or_default().push((first + 2 * i, division.places));
        }
        let on = |whole: usize| {
            let mut all = Vec::with_capacity(halves);
            for half in 0..halves {
                let [from, to] = [half, half + 1].map(|k| k as f64 / halves as f64);
                let e = half * count + whole;
                let seconds = seconds.get(&e).map_or(&[][..], Vec::as_slice);
                // The farthest is cut off first.
                let first = seconds.last().map_or(to, |&(_, places)| places[1]);
                all.push((e, [from, first]));
                all.extend(seconds.iter().rev().map(|&(e, [_, at, to])| (e, [at, to])));
            }
            (whole, all)
        };
        Along(mesh.outline().iter().map(|&edge| on(mesh.number_of(edge))).collect())
    }

    /// Gives the edges of Gamma_C their pressures and data, and to each what faces it.
    fn add_contact(&mut self, parts: &ProblemParts) {
        let along = self.along(parts.mesh);
        let Certificate { edges, curved, facing, .. } = &mut self.certificate;
        for (&whole, what) in &parts.boundary {
            let Boundary::Contact(line) = *what else { continue };
            for &(e, range) in along.of(whole) {
                // What acts on Gamma_C does not depend on the places.
                let (mut role, bulge) =
                    parts.role_on(whole, (range, [[0.0; 2]; 2]), curved.is_some());
                let contact = parts.contact_at(line, (range[0] + range[1]) / 2.0);
                if let (Role::Contact { pressure, law, .. }, Some((k, i))) = (&mut role, contact) {
                    let across;
                    [*pressure, across] = parts.contact[k].tractions_between(i, range);
                    match law {
                        Law::Contact | Law::Sliding => {}
                        Law::Bonded { shear, .. } => *shear = across,
                        Law::Friction { shear, bound } => {
                            let most = bound[0].min(bound[1]);
                            // Tractions that are beyond a varying bound by rounding stay equal to each other: where the direction turns, they
                            // must be.
                            let most = if across[0] == across[1] { [most; 2] } else { *bound };
                            *shear = [0, 1].map(|k| across[k].clamp(-most[k], most[k]));
                        }
                    }
                }
                edges[e].role = role;
                if let Some(curved) = curved {
                    curved.data[e] = bulge;
                }
            }
        }
        for contact in parts.contact.iter().filter(|contact| contact.is_pair()) {
            for part in &contact.parts {
                let there = contact.sides.iter().filter_map(|side| {
                    let x = side.middle(part.ends);
                    let whole = parts.mesh.number_of(side.edge);
                    let inside = |(_, [s, t]): &&(usize, [f64; 2])| *s < x && x < *t;
                    along.of(whole).iter().find(inside).map(|&(e, _)| e)
                });
                if let [first, second] = there.collect::<Vec<usize>>()[..] {
                    facing.insert(first, second);
                    facing.insert(second, first);
                }
            }
        }
    }
}

/// The certificate of the stress of `y`, a displacement under the pressures of `parts`, and of the displacement `v`.
pub(super) fn build(parts: &ProblemParts, y: &Field, v: &Field) -> Built {
    let mesh = parts.mesh;
    let data = Data::new(parts.problem);
    let whole: Vec<Triangle<f64>> = (0..mesh.triangles().len()).map(|t| mesh.triangle(t)).collect();
    let stress = stresses(parts, y, &whole);
    let bodies: Vec<[Vector2<f64>; 3]> =
        whole.iter().enumerate().map(|(t, triangle)| data.body_on(t, triangle)).collect();
    let moments = moments(parts, &bodies, &whole, &stress);
    let quadratic = v.bulges.is_some();
    // A stress that is constant on the triangles says nothing of their quarters.
    let quartered = quadratic && y.bulges.is_some();
    let mut built = Built {
        certificate: Certificate {
            vertices: mesh.vertices().to_vec(),
            displacement: v.vertices.clone(),
            curved: quadratic.then(Curved::default),
            prescribed: parts.prescribed.clone(),
            frames: parts.frames.clone(),
            pieces: Vec::with_capacity(whole.len()),
            edges: Vec::with_capacity(mesh.edge_count()),
            ..Certificate::default()
        },
        origins: Vec::with_capacity(whole.len()),
        oscillation: Oscillation::new(parts, quadratic),
        quartered,
        divisions: Vec::new(),
    };
    let ends = edge_ends(mesh);
    add_edges(parts, &ends, &moments, &mut built);
    let parts_of = |t: usize| {
        if quartered {
            return quarters(parts, &data, t, &stress[t], &mut built.certificate);
        }
        let places = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (vertices, edges) = (mesh.triangles()[t], mesh.triangle_edges()[t]);
        vec![(SubTriangle { vertices, edges, places }, bodies[t])]
    };
    let all: Vec<_> = (0..whole.len()).map(parts_of).collect();
    for (t, found) in all.into_iter().enumerate() {
        for (part, body) in found {
            add_part(parts, &data, (t, &stress[t]), (part, body), &mut built);
        }
        built.origins.resize(built.certificate.pieces.len(), t);
    }
    built.add_contact(parts);
    if let Some(bulges) = &v.bulges {
        let vectors = |values: &[[f64; 2]]| values.iter().copied().map(Vector2::from).collect();
        let shape = Shape { points: vectors(&v.vertices), bulges: Some(vectors(bulges)) };
        let shape = built.on_pieces(shape, mesh, &ends);
        add_curved(&shape, &mut built.certificate);
    }
    let Built { certificate, origins, oscillation, .. } = &mut built;
    certificate.polygon = polygon(mesh, certificate);
    oscillation.measure(parts, &data, certificate, (origins, quartered));
    built
}

/// Gives a certificate its v, which is quadratic; it is what is prescribed, at the cuts too.
fn add_curved(v: &Shape<f64>, certificate: &mut Certificate) {
    let Certificate { vertices, curved: Some(curved), edges, frames, .. } = certificate else {
        return;
    };
    curved.at_cuts = v.points[vertices.len()..].iter().map(|&v| v.into()).collect();
    curved.bulges = v.bulges.iter().flatten().map(|&v| v.into()).collect();
    curved.prescribed = vec![[None; 2]; curved.at_cuts.len()];
    for edge in edges {
        for point in edge.ends {
            let Some(cut) = point.checked_sub(vertices.len()) else { continue };
            let there = curved.at_cuts[cut];
            let held = match edge.role {
                Role::Held(held, _) => held,
                Role::Supported { along: d, .. } if is_oblique(d) => {
                    curved.prescribed[cut] = [Some(there[0] * d[0] + there[1] * d[1]), None];
                    frames.insert(point, d);
                    continue;
                }
                Role::Supported { along, .. } => along.map(|d| d != 0.0),
                _ => continue,
            };
            for c in (0..2).filter(|&c| held[c]) {
                curved.prescribed[cut][c] = Some(there[c]);
            }
        }
    }
}

/// The edges that stand for a part of a curved boundary.
pub(super) fn polygon(mesh: &Mesh, certificate: &Certificate) -> Vec<usize> {
    let smooth = SmoothBoundary::new(mesh);
    let curved = mesh.outline().iter().filter(|&&edge| smooth.at_ends(edge).is_some());
    let curved: BTreeSet<[usize; 2]> = curved.map(|&edge| sorted(mesh.ends(edge))).collect();
    let is_curved = |edge: &Edge| {
        let cut =
            |p: usize| Some(certificate.cuts[p.checked_sub(certificate.vertices.len())?].ends);
        let line = edge.ends.into_iter().find_map(cut).unwrap_or(edge.ends);
        !matches!(edge.role, Role::Inner(_)) && curved.contains(&sorted(line))
    };
    (0..certificate.edges.len()).filter(|&e| is_curved(&certificate.edges[e])).collect()
}

/// The edges of the mesh, or their halves, first all first ones, then all second ones; then the middles of the edges are the first
/// cuts.
fn add_edges(
    parts: &ProblemParts,
    all: &[[usize; 2]],
    moments: &[[Vector2<f64>; 2]],
    Built { certificate, quartered, .. }: &mut Built,
) {
    let vertices = certificate.vertices.len();
    let quadratic = certificate.curved.is_some();
    let halves = if *quartered { &[[0.0, 0.5], [0.5, 1.0]][..] } else { &[[0.0, 1.0]] };
    if *quartered {
        certificate.cuts = all.iter().map(|&ends| Cut { ends, at: 0.5 }).collect();
    }
    for &[s, t] in halves {
        for (e, (&[a, b], m)) in all.iter().zip(moments).enumerate() {
            let ends =
                [if s == 0.0 { a } else { vertices + e }, if t == 1.0 { b } else { vertices + e }];
            let places = ends.map(|p| place(certificate, p).into());
            let (role, bulge) = parts.role_on(e, ([s, t], places), quadratic);
            // Per unit of the part's parameter.
            let [p, q] = force_of(m);
            let at = |x: f64| [0, 1].map(|c| ((1.0 - x) * p[c] + x * q[c]) * (t - s));
            let role = with_force(role, [s, t].map(at));
            certificate.edges.push(Edge { ends, role });
            if let Some(curved) = &mut certificate.curved {
                curved.data.push(bulge);
            }
        }
    }
}

/// Where edge `e` is cut, an edge of the mesh or the half of one: the places where it begins and ends on that of the mesh, and those
/// between them.
fn cuts_of(parts: &ProblemParts, quartered: bool, e: usize) -> ([f64; 2], Vec<f64>) {
    let (count, halves) = (parts.mesh.edge_count(), if quartered { 2 } else { 1 });
    let half = e / count;
    if half >= halves {
        return ([0.0, 1.0], Vec::new());
    }
    let [from, to] = [half, half + 1].map(|k| k as f64 / halves as f64);
    let mut cuts = parts.breaks(e % count);
    cuts.retain(|&at| from < at && at < to);
    cuts.extend(parts.cuts.get(&e).copied());
    ([from, to], cuts)
}

/// A part of triangle `t`, cut where contact ends on one of its edges.
fn add_part(
    parts: &ProblemParts,
    data: &Data,
    (t, stress): (usize, &Affine<f64>),
    (part, body): (SubTriangle, [Vector2<f64>; 3]),
    built: &mut Built,
) {
    let (corners, edges) = (part.vertices, part.edges);
    let mut found = vec![part];
    for e in edges {
        let ([from, mut to], cuts) = cuts_of(parts, built.quartered, e);
        for at in cuts.into_iter().rev() {
            let owner = found.iter().position(|part| part.edges.contains(&e));
            let Some(owner) = owner else { break };
            let part = found.remove(owner);
            let Built { certificate, divisions, .. } = &mut *built;
            found.extend(cut(part, (e, [from, at, to]), stress, (certificate, divisions)));
            to = at;
        }
    }
    let material = parts.material(t).in_plane();
    for SubTriangle { vertices, edges, .. } in found {
        let certificate = &mut built.certificate;
        let own = || {
            let triangle = Triangle { vertices: vertices.map(|p| place(certificate, p)) };
            data.body_on(t, &triangle)
        };
        let body = if vertices == corners { body } else { own() }.map(Into::into);
        certificate.pieces.push(Piece { vertices, edges, material, body, oscillation: 0.0 });
    }
}
