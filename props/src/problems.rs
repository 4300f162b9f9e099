//! Problems as checks build them: meshes with named sides, data that are numbers, one material.

use std::sync::Arc;

use proptest::prelude::*;
use signorini::kernel::Material;
use signorini::model::{Condition, Diagonal, Mesh, Problem, Rectangle, SharedFunction};

use crate::claim::text;

/// A function with this value everywhere, which says nothing of its degree.
pub fn constant(value: f64) -> SharedFunction {
    Arc::new(move |_: [f64; 2]| value)
}

/// A side that is moved by this.
pub fn held(u: [f64; 2]) -> Condition {
    Condition::Displacement(u.map(|u| Some(constant(u))))
}

/// A side at this distance from its obstacle.
pub fn floor(gap: f64) -> Condition {
    Condition::Contact { gap: constant(gap) }
}

/// A body of one material with these conditions.
pub fn problem<const N: usize>(
    mesh: Mesh,
    material: Material<f64>,
    body_force: [SharedFunction; 2],
    conditions: [(&str, Condition); N],
) -> Problem {
    let conditions = conditions.map(|(name, condition)| (name.to_owned(), condition));
    Problem::new(mesh, material, body_force, conditions.into())
}

/// The same without a body force.
pub fn unloaded<const N: usize>(
    mesh: Mesh,
    material: Material<f64>,
    conditions: [(&str, Condition); N],
) -> Problem {
    problem(mesh, material, [0.0; 2].map(constant), conditions)
}

/// A mesh with sides of one edge each.
pub fn mesh<const N: usize>(
    vertices: Vec<[f64; 2]>,
    triangles: Vec<[usize; 3]>,
    sides: [(&str, [usize; 2]); N],
) -> Result<Mesh, String> {
    let sides = sides.map(|(name, edge)| (name.to_owned(), vec![edge]));
    Mesh::new(vertices, triangles, sides).map_err(text)
}

/// Cells of size 1.
pub fn cells([nx, ny]: [usize; 2], diagonal: Diagonal) -> Rectangle {
    Rectangle { width: nx as f64, height: ny as f64, nx, ny, diagonal }
}

/// The mesh with its vertices elsewhere.
pub fn mapped(mesh: &Mesh, map: impl Fn([f64; 2]) -> [f64; 2]) -> Result<Mesh, String> {
    let mut named = Vec::new();
    for name in mesh.boundary_names() {
        let edges = mesh.edges_of(name).map_err(text)?.iter().map(|&edge| mesh.ends(edge));
        named.push((name.to_owned(), edges.collect::<Vec<_>>()));
    }
    let vertices = mesh.vertices().iter().map(|&x| map(x)).collect();
    Mesh::new(vertices, mesh.triangles().to_vec(), named).map_err(text)
}

/// How cells are cut into triangles.
pub fn diagonals() -> impl Strategy<Value = Diagonal> {
    prop::sample::select(&[Diagonal::Left, Diagonal::Right, Diagonal::Crossed])
}
