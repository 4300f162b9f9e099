//! Gamma_D: which degrees of freedom are prescribed, with what values, and whether they hold the body.
//!
//! Where boundaries meet at a node, displacement wins; two displacements that meet must agree. Prescribed values are
//! interpolated at the nodes.

use std::collections::BTreeMap;

use super::mesh::Mesh;
use super::problem::{Condition, DataError, Problem, finite};
use super::space::Space;
use crate::kernel::Element;
use crate::quote::key;

/// The prescribed components of the displacement.
#[derive(Clone, Debug)]
pub struct Constraints {
    values: Vec<[Option<f64>; 2]>,
    holders: BTreeMap<String, Vec<(usize, usize)>>,
}

/// Two prescribed values that differ by no more than this share of the largest one agree: expressions that mean the same
/// may differ by their rounding errors.
const AGREEMENT: f64 = 1e-12;

impl Constraints {
    /// The constraints of a problem.
    ///
    /// # Errors
    /// A value that is not finite, two that disagree, or a rigid body motion that stays free.
    pub fn new<E: Element<N, M>, const N: usize, const M: usize>(
        problem: &Problem,
        space: &Space<E, N, M>,
    ) -> Result<Self, DataError> {
        let mut demands: BTreeMap<(usize, usize), Vec<(&str, f64)>> = BTreeMap::new();
        for (name, condition) in &problem.conditions {
            let Condition::Displacement(functions) = condition else { continue };
            for &edge in space.mesh().edges_of(name)? {
                for node in space.edge_nodes(edge) {
                    for (c, function) in functions.iter().enumerate() {
                        let Some(function) = function else { continue };
                        let demand = demands.entry((node, c)).or_default();
                        if demand.last().is_none_or(|(last, _)| last != name) {
                            let what = || format!("[boundary.{}] displacement[{c}]", key(name));
                            let value = finite(&**function, space.nodes()[node], what)?;
                            demand.push((name, value));
                        }
                    }
                }
            }
        }
        let largest = demands.values().flatten().fold(0.0, |max: f64, (_, v)| max.max(v.abs()));
        let mut values = vec![[None; 2]; space.nodes().len()];
        let mut holders: BTreeMap<String, Vec<(usize, usize)>> = BTreeMap::new();
        for ((node, component), demand) in demands {
            let (first, value) = demand[0];
            for &(second, other) in &demand[1..] {
                if !((other - value).abs() <= AGREEMENT * largest) {
                    let [x, y] = space.nodes()[node];
                    let (first, second) = (first.to_owned(), second.to_owned());
                    let values = [value, other];
                    return Err(DataError::Disagree { first, second, x, y, component, values });
                }
            }
            values[node][component] = Some(value);
            holders.entry(first.to_owned()).or_default().push((node, component));
        }
        let constraints = Constraints { values, holders };
        constraints.check_rigid_motions(space)?;
        Ok(constraints)
    }

    /// The prescribed components at each node.
    pub fn values(&self) -> &[[Option<f64>; 2]] {
        &self.values
    }

    /// The prescribed data as a field, zero where nothing is prescribed.
    pub fn lift(&self) -> Vec<[f64; 2]> {
        self.values.iter().map(|v| v.map(Option::unwrap_or_default)).collect()
    }

    /// The (node, component) pairs that each displacement boundary holds; a pair that two boundaries prescribe counts for
    /// the one that is first in alphabetical order.
    pub fn holders(&self) -> &BTreeMap<String, Vec<(usize, usize)>> {
        &self.holders
    }

    /// In each connected part of the body the prescribed components must stop both translations and the rotation: the
    /// rows (1, 0, -y) and (0, 1, x) of the prescribed components have rank 3.
    fn check_rigid_motions<E: Element<N, M>, const N: usize, const M: usize>(
        &self,
        space: &Space<E, N, M>,
    ) -> Result<(), DataError> {
        let mesh = space.mesh();
        let part_of = connected_parts(mesh);
        let count = part_of.iter().max().map_or(0, |last| last + 1);
        let mut part_of_node = vec![0; space.nodes().len()];
        for (nodes, corners) in space.elements().iter().zip(mesh.triangles()) {
            for &node in nodes {
                part_of_node[node] = part_of[corners[0]];
            }
        }
        let size = mesh.vertices().iter().flatten().fold(0.0, |max: f64, c| max.max(c.abs()));
        let mut stopped = vec![Stopped::default(); count];
        let mut place = vec![[0.0; 2]; count];
        for (node, values) in self.values.iter().enumerate() {
            let part = part_of_node[node];
            place[part] = space.nodes()[node];
            let [x, y] = space.nodes()[node].map(|c| c / size);
            for (value, row) in values.iter().zip([[1.0, 0.0, -y], [0.0, 1.0, x]]) {
                if value.is_some() {
                    stopped[part].add(row);
                }
            }
        }
        for (stopped, [x, y]) in stopped.iter().zip(place) {
            if let Some(motion) = stopped.free_motion(size) {
                let part = if count == 1 {
                    String::new()
                } else {
                    format!(" of the part of the body at ({x}, {y})")
                };
                return Err(DataError::RigidMotion { motion, part });
            }
        }
        Ok(())
    }
}

/// An orthonormal basis of the rows that constrain a rigid motion (a_x, a_y, rotation).
#[derive(Clone, Debug, Default)]
struct Stopped {
    basis: Vec<[f64; 3]>,
}

/// A row of norm >= 1 whose part across the known rows is this small adds nothing to them.
const DEPENDENT: f64 = 1e-10;

impl Stopped {
    fn add(&mut self, mut row: [f64; 3]) {
        if self.basis.len() < 3 {
            for b in &self.basis {
                let along = dot3(row, *b);
                row = [0, 1, 2].map(|i| row[i] - along * b[i]);
            }
            let norm = dot3(row, row).sqrt();
            if norm > DEPENDENT {
                self.basis.push(row.map(|c| c / norm));
            }
        }
    }

    /// A motion that no row stops, in words; coordinates were divided by `size`.
    fn free_motion(&self, size: f64) -> Option<String> {
        let [ax, ay, rotation] = match self.basis[..] {
            [] => [1.0, 0.0, 0.0],
            [a] => {
                // Any motion across one row will do: the translation across it.
                [-a[1], a[0], 0.0]
            }
            [a, b] => {
                [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
            }
            _ => return None,
        };
        let short = |c: f64| (c * 1e6).round() / 1e6 + 0.0;
        Some(if rotation.abs() <= DEPENDENT {
            let norm = ax.hypot(ay);
            format!("translation along ({}, {})", short(ax / norm), short(ay / norm))
        } else {
            let (x, y) = (-ay / rotation * size, ax / rotation * size);
            format!("rotation about ({}, {})", short(x), short(y))
        })
    }
}

fn dot3(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The number of the connected part to which each vertex belongs.
fn connected_parts(mesh: &Mesh) -> Vec<usize> {
    fn root(parent: &mut [usize], mut v: usize) -> usize {
        while parent[v] != v {
            parent[v] = parent[parent[v]];
            v = parent[v];
        }
        v
    }
    let mut parent: Vec<usize> = (0..mesh.vertices().len()).collect();
    for &[a, b, c] in mesh.triangles() {
        for (a, b) in [(a, b), (b, c)] {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b)] = a.min(b);
        }
    }
    // A root is the smallest vertex of its part, so it is numbered before the others ask for its number.
    let mut part = vec![0; parent.len()];
    let mut count = 0;
    for v in 0..parent.len() {
        let r = root(&mut parent, v);
        if r == v {
            part[v] = count;
            count += 1;
        } else {
            part[v] = part[r];
        }
    }
    part
}
