//! The displacement y in V^h under the loads and the pressures p of a certificate: a(y, v) = L(v) + int p d . v for all v in V^h
//! that vanish where the body is held.
//!
//! Tractions that are in equilibrium on every triangle follow from y around each vertex alone (`tractions`), whatever p is. The
//! discrete solution u^h is not such a displacement: (8) has the moments of lambda^h, by the rule that it was integrated with,
//! and Nitsche's terms; p is lambda^h but where that is not affine along an edge or its direction turns. y - u^h has the least
//! energy of all that make up for the difference, and costs one factor of the body without contact. Carried from triangle to
//! triangle, the difference would cost more the finer the mesh is.
//!
//! Where contact alone stops a motion, y is one up to that, and exists only if p balances the loads: each edge's pressure is
//! multiplied by 1 + sum c_k m_k, m_k the mean of d . r_k on the edge with the weight p for the motions r_k. Where bodies slide and do not
//! open along a direction that turns, sum c_k m_k is added to it, with the weight 1.

use nalgebra::Vector2;

use super::contact::{Contact, Side};
use super::data::Data;
use super::errors::CertifyError;
use super::lifting::factored;
use super::parts::{Boundary, ProblemParts};
use super::tractions::load;
use crate::contact::residual::add_internal_forces;
use crate::linear::dense::{dot, inner, singular_vectors};
use crate::model::constraints::Constraints;
use crate::model::rigid::{FreeMotion, Parts, pins};
use crate::model::{BoundaryEdge, Degree, Space};

/// No pressure changes by more than this part of itself: it stays one.
const MOST: f64 = 0.5;

/// A motion along which the direction of contact has less than this part of what it has along others is one that nothing stops.
const STOPPED: f64 = 1e-8;

/// y at the nodes, from u^h, `near`, which has what is prescribed. Where contact alone holds the body, the pressures of `parts`
/// are balanced first.
///
/// # Errors
/// A body without a factor, and lack of memory.
pub(super) fn displacement(
    parts: &mut ProblemParts,
    degree: Degree,
    near: &[[f64; 2]],
) -> Result<Vec<[f64; 2]>, CertifyError> {
    let space = Space::new(parts.mesh, degree);
    let constraints = Constraints::new(parts.problem, &space)?;
    let (bodies, motions) = constraints.free_motions(&space);
    let mut forces = loads(parts, &space);
    let fields: Vec<_> = motions.iter().map(|motion| motion.field(&bodies, &space)).collect();
    let driven: Vec<f64> = fields.iter().map(|field| inner(&forces, field)).collect();
    balance(parts, (&bodies, &motions), &driven);
    for edge in &parts.contact {
        for (i, side) in edge.sides.iter().enumerate() {
            add_on_edge(&space, side.edge, edge.on_edge(i), &mut forces);
        }
    }
    let mut prescribed = constraints.values().to_vec();
    let is_free = |node: usize, c: usize| {
        constraints.values()[node][c].is_none() && !constraints.frames().contains_key(&node)
    };
    for (node, c) in pins(&fields, is_free) {
        prescribed[node][c] = Some(0.0);
    }
    let (materials, frames) = (&parts.problem.material, constraints.frames().clone());
    let factored = factored(&space, materials, &prescribed, frames, &[]);
    let (numbering, factor) = factored.map_err(|error| {
        CertifyError::Unsupported(format!("no displacement under the contact pressures: {error}"))
    })?;
    let mut y = near.to_vec();
    // The second time for what the first one has rounded.
    for _ in 0..2 {
        let mut internal = vec![[0.0; 2]; y.len()];
        add_internal_forces(&space, materials, &y, &mut internal);
        let left: Vec<[f64; 2]> =
            forces.iter().zip(internal).map(|(f, i)| [f[0] - i[0], f[1] - i[1]]).collect();
        let mut x = numbering.gather(&left);
        factor.solve(&mut x);
        let mut moved = vec![[0.0; 2]; y.len()];
        numbering.scatter(&x, &mut moved);
        let all = y.as_flattened_mut().iter_mut().zip(moved.as_flattened());
        all.for_each(|(y, moved)| *y += moved);
    }
    Ok(y)
}

/// L(v) for every basis function, of the loads as the certificate has them.
fn loads(parts: &ProblemParts, space: &Space) -> Vec<[f64; 2]> {
    let (mesh, data) = (parts.mesh, Data::new(parts.problem));
    let mut forces = vec![[0.0; 2]; space.nodes().len()];
    for (t, nodes) in space.elements().enumerate() {
        let triangle = mesh.triangle(t);
        let body = data.body_on(t, &triangle);
        for (l, &node) in nodes[..3].iter().enumerate() {
            add(&mut forces[node], load(&body, &triangle, l));
        }
        for (l, &middle) in nodes[3..].iter().enumerate() {
            // int f 4 l_j l_k = |T| / 15 (f_i + 2 f_j + 2 f_k); half of it is taken from the hat functions of j and k.
            let [j, k] = [(l + 1) % 3, (l + 2) % 3];
            let force = (body[l] + body[j] * 2.0 + body[k] * 2.0) * (triangle.double_area() / 30.0);
            add(&mut forces[middle], force);
            [j, k].into_iter().for_each(|l| add(&mut forces[nodes[l]], force / -2.0));
        }
    }
    for &edge in mesh.outline() {
        let e = mesh.number_of(edge);
        let traction = match parts.boundary.get(&e) {
            Some(Boundary::Loaded(traction) | Boundary::Supported(_, _, Some(traction))) => {
                traction
            }
            _ => continue,
        };
        let [a, b] = traction.moments(mesh.places_of_ends(edge));
        // Of an affine traction.
        add_on_edge(space, edge, [a, b, (a + b) * (2.0 / 3.0)], &mut forces);
    }
    forces
}

/// Adds what has these moments with the hat functions of an edge's ends and with 4 s (1 - s).
fn add_on_edge(
    space: &Space,
    edge: BoundaryEdge,
    [a, b, bubble]: [Vector2<f64>; 3],
    forces: &mut [[f64; 2]],
) {
    let moments = match space.degree() {
        Degree::One => vec![a, b],
        Degree::Two => vec![a - bubble / 2.0, b - bubble / 2.0, bubble],
    };
    for (node, moment) in space.edge_nodes(edge).zip(moments) {
        add(&mut forces[node], moment);
    }
}

fn add(sum: &mut [f64; 2], force: Vector2<f64>) {
    (0..2).for_each(|c| sum[c] += force[c]);
}

/// Multiplies the pressures so that their work on the motions makes up for what the loads do.
fn balance(parts: &mut ProblemParts, (bodies, motions): (&Parts, &[FreeMotion]), driven: &[f64]) {
    let mesh = parts.mesh;
    // The force of each edge, and its mean work on each motion; what is not scaled with it comes off what is missing.
    let mut missing = driven.to_vec();
    let mut against = |edge: &Contact| -> (f64, Vec<f64>) {
        let force = -edge.force();
        let mean = |(motion, missing): (&FreeMotion, &mut f64)| {
            let on_side = |(i, side): (usize, &Side)| {
                if bodies.of_triangle()[side.edge.triangle] != motion.part {
                    return [0.0; 2];
                }
                let ends = mesh.ends(side.edge).map(|vertex| mesh.vertices()[vertex]);
                edge.against(i, ends.map(|x| motion.at(x).into()))
            };
            let both = edge.sides.iter().enumerate().map(on_side);
            let [push, all] = both.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
            *missing += all;
            if force > 0.0 { -push / force } else { 0.0 }
        };
        (force, motions.iter().zip(&mut missing).map(mean).collect())
    };
    let edges: Vec<(f64, Vec<f64>)> = parts.contact.iter().map(&mut against).collect();
    // sum force (c . mean) mean = missing
    let rows: Vec<Vec<f64>> = (edges.iter())
        .map(|(force, means)| means.iter().map(|mean| force.sqrt() * mean).collect())
        .collect();
    let values = singular_vectors(&rows, motions.len());
    let largest = values.first().map_or(0.0, |(value, _)| *value);
    let mut factors = vec![0.0; motions.len()];
    for (value, vector) in values.iter().filter(|(value, _)| *value > STOPPED * largest) {
        let along = dot(vector, &missing) / (value * value);
        factors.iter_mut().zip(vector).for_each(|(factor, v)| *factor += along * v);
    }
    for (edge, (_, means)) in parts.contact.iter_mut().zip(&edges) {
        edge.add(dot(means, &factors), MOST);
    }
}
