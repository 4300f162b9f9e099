//! A certificate from a discrete solution: v as it was made admissible, tau by equilibrated tractions (`tractions`), on the
//! triangles of the mesh or on their quarters (`quarters`), cut where contact ends (`divide`).

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;

use super::certificate::{
    Certificate, Curved, Cut, Edge, Piece, Role, Shape, exactly, is_oblique, place,
};
use super::contact::Profile;
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
    pub certificate: Certificate,
    /// The triangles of the mesh that its pieces come from.
    pub origins: Vec<usize>,
    /// The oscillation of the data.
    pub oscillation: Oscillation,
    /// Its triangles are quarters of those of the mesh.
    quartered: bool,
    pub divisions: Vec<Division>,
}

impl Built {
    /// A displacement of the mesh on the pieces: given at the vertices, and at the middles of the edges if it is quadratic.
    pub fn shape<S: Enclosing>(&self, mesh: &Mesh, nodal: &[[f64; 2]]) -> Shape<S> {
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
    pub fn penetrations(&self, parts: &ProblemParts) -> Vec<(usize, f64)> {
        let found = self.certificate.penetrations();
        if found.is_empty() {
            return Vec::new();
        }
        let mut of: BTreeMap<usize, f64> = BTreeMap::new();
        let by_edge: BTreeMap<usize, f64> = found.into_iter().collect();
        for (piece, &t) in self.certificate.pieces.iter().zip(&self.origins) {
            for by in piece.edges.iter().filter_map(|e| by_edge.get(e)) {
                let most = of.entry(t).or_default();
                *most = most.max(*by);
            }
        }
        let contact = parts.contact.iter().enumerate();
        contact.filter_map(|(k, edge)| Some((k, *of.get(&edge.edge.triangle)?))).collect()
    }
}

/// The boundaries of the problem on the edges of a certificate.
pub(super) struct Line {
    pub names: Vec<String>,
    /// The boundary of each edge, by its place among the names.
    pub of: Vec<Option<usize>>,
    /// The edges of Gamma_C, along it.
    pub stations: Vec<Station>,
}

/// An edge of Gamma_C along its boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Station {
    pub edge: usize,
    /// Arc length at its ends.
    pub from: f64,
    pub to: f64,
    pub ends: [[f64; 2]; 2],
    /// It starts where the one before it ends.
    pub joined: bool,
}

impl Built {
    /// Where the boundaries of the problem are on the edges of the certificate.
    pub fn line(&self, parts: &ProblemParts) -> Line {
        let (mesh, edges) = (parts.mesh, &self.certificate.edges);
        let count = mesh.edge_count();
        // A division keeps its edge for the first part and adds the second one and the cut.
        let first = edges.len() - 2 * self.divisions.len();
        let second: BTreeMap<usize, usize> =
            self.divisions.iter().enumerate().map(|(i, d)| (d.base, first + 2 * i)).collect();
        let halves = if self.quartered { 2 } else { 1 };
        let on = |whole: usize| {
            let halves = (0..halves).map(move |half| half * count + whole);
            halves.flat_map(|e| std::iter::once(e).chain(second.get(&e).copied()))
        };
        let mut line =
            Line { names: Vec::new(), of: vec![None; edges.len()], stations: Vec::new() };
        for name in parts.problem.conditions.keys() {
            for &edge in mesh.edges_of(name).unwrap_or_default() {
                let whole = mesh.triangle_edges()[edge.triangle][edge.local];
                on(whole).for_each(|e| line.of[e] = Some(line.names.len()));
            }
            line.names.push(name.clone());
        }
        let mut before: Option<(usize, usize)> = None;
        let mut arc = 0.0;
        for contact in &parts.contact {
            let whole = mesh.triangle_edges()[contact.edge.triangle][contact.edge.local];
            for e in on(whole) {
                let (ends, Some(name)) = (edges[e].ends, line.of[e]) else { continue };
                if before.is_none_or(|(boundary, _)| boundary != name) {
                    arc = 0.0;
                }
                let joined = before == Some((name, ends[0]));
                let [a, b] = ends.map(|p| place(&self.certificate, p));
                let from = arc;
                arc += length(b - a);
                line.stations.push(Station {
                    edge: e,
                    from,
                    to: arc,
                    ends: [a.into(), b.into()],
                    joined,
                });
                before = Some((name, ends[1]));
            }
        }
        line
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
            cuts: Vec::new(),
            displacement: v.vertices.clone(),
            curved: quadratic.then(Curved::default),
            prescribed: parts.prescribed.clone(),
            frames: parts.frames.clone(),
            pieces: Vec::with_capacity(whole.len()),
            edges: Vec::with_capacity(mesh.edge_count()),
            lifts: Vec::new(),
            polygon: Vec::new(),
        },
        origins: Vec::with_capacity(whole.len()),
        oscillation: Oscillation::new(parts, quadratic),
        quartered,
        divisions: Vec::new(),
    };
    let ends = edge_ends(mesh);
    add_edges(parts, &ends, &moments, &mut built);
    let cut_up = |t: usize| {
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (vertices, edges) = (mesh.triangles()[t], mesh.triangle_edges()[t]);
        vec![(SubTriangle { vertices, edges, places: unit }, bodies[t])]
    };
    let all: Vec<Vec<(SubTriangle, [Vector2<f64>; 3])>> = if quartered {
        (0..whole.len())
            .map(|t| quarters(parts, &data, t, &stress[t], &mut built.certificate))
            .collect()
    } else {
        (0..whole.len()).map(cut_up).collect()
    };
    for (t, found) in all.into_iter().enumerate() {
        for (part, body) in found {
            add_part(parts, &data, (t, &stress[t]), (part, body), &mut built);
        }
        built.origins.resize(built.certificate.pieces.len(), t);
    }
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
    let sorted = |[a, b]: [usize; 2]| if a < b { [a, b] } else { [b, a] };
    let curved: BTreeSet<[usize; 2]> = curved.map(|&edge| sorted(mesh.ends(edge))).collect();
    let is_curved = |edge: &Edge| {
        let cut =
            |p: usize| Some(certificate.cuts[p.checked_sub(certificate.vertices.len())?].ends);
        let line = edge.ends.into_iter().find_map(cut).unwrap_or(edge.ends);
        !matches!(edge.role, Role::Inner(_)) && curved.contains(&sorted(line))
    };
    certificate
        .edges
        .iter()
        .enumerate()
        .filter(|(_, edge)| is_curved(edge))
        .map(|(e, _)| e)
        .collect()
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
    for (half, &[s, t]) in halves.iter().enumerate() {
        for (e, (&[a, b], m)) in all.iter().zip(moments).enumerate() {
            let ends =
                [if s == 0.0 { a } else { vertices + e }, if t == 1.0 { b } else { vertices + e }];
            let places = ends.map(|p| place(certificate, p).into());
            let (role, bulge) = parts.role_on(e, ([s, t], places), quadratic);
            // Per unit of the part's parameter.
            let [p, q] = force_of(m);
            let at = |x: f64| [0, 1].map(|c| ((1.0 - x) * p[c] + x * q[c]) * (t - s));
            let mut role = with_force(role, [s, t].map(at));
            if let (Role::Contact { pressure, .. }, Some(&Boundary::Contact(k))) =
                (&mut role, parts.boundary.get(&e))
            {
                let edge = &parts.contact[k];
                *pressure = edge.pressure[half].values[0];
            }
            certificate.edges.push(Edge { ends, role });
            if let Some(curved) = &mut certificate.curved {
                curved.data.push(bulge);
            }
        }
    }
}

/// The pressure on edge `e` and the bulge of the gap, where it is one of Gamma_C or the half of one.
fn on_contact(parts: &ProblemParts, quartered: bool, e: usize) -> Option<(Profile, f64)> {
    let count = parts.mesh.edge_count();
    let half = e / count;
    if half > usize::from(quartered) {
        return None;
    }
    let Some(&Boundary::Contact(k)) = parts.boundary.get(&(e % count)) else { return None };
    let edge = &parts.contact[k];
    Some((edge.pressure[half], edge.gap_bulge / if quartered { 4.0 } else { 1.0 }))
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
        let (at, values, gap_bulge) = match on_contact(parts, built.quartered, e) {
            Some((Profile { cut: Some(at), values }, gap_bulge)) => (at, values, gap_bulge),
            Some(_) => continue,
            None => match parts.cuts.get(&e) {
                Some(&at) => (at, [[0.0; 2]; 2], 0.0),
                None => continue,
            },
        };
        let Some(owner) = found.iter().position(|part| part.edges.contains(&e)) else { continue };
        let part = found.remove(owner);
        let Built { certificate, divisions, .. } = &mut *built;
        found.extend(cut(part, (e, at, values), gap_bulge, stress, (certificate, divisions)));
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
