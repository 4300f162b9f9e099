//! The triangles of a mesh in four between the middles of their edges, for the stress beside a quadratic v.

use nalgebra::Vector2;

use super::certificate::{Certificate, Edge, Role, Shape, place, support};
use super::data::{Data, force_of};
use super::divide::SubTriangle;
use super::parts::{Boundary, ProblemParts};
use crate::kernel::composite::{Affine, Loads};
use crate::kernel::{Enclosing, Triangle};
use crate::model::Mesh;
use crate::model::mesh::length;

/// The four triangles of triangle `t` between its corners and the middles of its edges, each with its body force. On an edge
/// between middles tau N is that of sigma(u) and what balances the corner that it cuts off; the triangle in the middle is in
/// equilibrium with the whole.
pub(super) fn quarters(
    parts: &ProblemParts,
    data: &Data,
    t: usize,
    stress: &Affine<f64>,
    certificate: &mut Certificate,
) -> Vec<(SubTriangle, [Vector2<f64>; 3])> {
    let (corners, edges) = (parts.mesh.triangles()[t], parts.mesh.triangle_edges()[t]);
    let (vertices, count) = (parts.mesh.vertices().len(), parts.mesh.edge_count());
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
        found.push((SubTriangle { vertices: part, edges: own, places }, body));
    }
    let triangle = Triangle { vertices: middles.map(|p| place(certificate, p)) };
    let places = [0, 1, 2].map(at_middle);
    found.push((
        SubTriangle { vertices: middles, edges: inside, places },
        data.body_on(t, &triangle),
    ));
    found
}

/// The force on half `e` of an edge towards the outside of a triangle that goes along it between these ends.
fn outward(
    parts: &ProblemParts,
    certificate: &Certificate,
    e: usize,
    ends: [usize; 2],
    normal: Vector2<f64>,
) -> [Vector2<f64>; 2] {
    let (edge, count) = (&certificate.edges[e], parts.mesh.edge_count());
    if let Some(&Boundary::Contact(line)) = parts.boundary.get(&(e % count)) {
        let half = [e / count, e / count + 1].map(|k| k as f64 / 2.0);
        let moments = parts.lines[line].iter().map(|&(k, i)| parts.contact[k].on_part(i, half));
        let sum = moments.fold([Vector2::zeros(); 2], |[a, b], [c, d]| [a + c, b + d]);
        return force_of(&sum).map(Vector2::from);
    }
    match edge.role {
        Role::Inner(force) | Role::Held(_, force) => {
            let [a, b] = force.map(Vector2::from);
            if edge.ends == ends { [a, b] } else { [-b, -a] }
        }
        Role::Supported { along, force, traction } => {
            support(along, force, traction, || length(normal))
        }
        Role::Loaded(traction) => traction.map(|t| Vector2::from(t) * length(normal)),
        Role::Pressed(p) => p.map(|p| normal * -p),
        Role::Contact { .. } | Role::Facing => [Vector2::zeros(); 2],
    }
}

/// Restates a displacement with values in the middles of the mesh's edges, and bulges on their halves and on the edges between
/// middles: each is parallel to an edge and half as long, and the second difference of a quadratic along it is a quarter.
pub(super) fn halved<S: Enclosing>(
    mut shape: Shape<S>,
    mesh: &Mesh,
    ends: &[[usize; 2]],
) -> Shape<S> {
    for (e, [a, b]) in ends.iter().enumerate() {
        let mean = (shape.points[*a] + shape.points[*b]) / S::from(2);
        shape.points.push(shape.bulges.as_ref().map_or(mean, |bulges| mean + bulges[e]));
    }
    shape.bulges = shape.bulges.map(|bulges| {
        let quarters = bulges.iter().map(|&bulge| bulge / S::from(4));
        let inside = mesh.triangle_edges().iter().flatten().map(|&e| bulges[e] / S::from(4));
        quarters.clone().chain(quarters).chain(inside).collect()
    });
    shape
}
