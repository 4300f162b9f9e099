//! Which triangles are one part, and where parts are hinged.

use std::collections::{BTreeMap, BTreeSet};

use super::Hinge;
use crate::fem::mesh::Mesh;

/// The number of the part of each triangle: triangles with an edge in common are in one part.
pub(super) fn connected_by_edges(mesh: &Mesh) -> Vec<usize> {
    fn root(parent: &mut [usize], mut t: usize) -> usize {
        while parent[t] != t {
            parent[t] = parent[parent[t]];
            t = parent[t];
        }
        t
    }
    let triangles = mesh.triangles().len();
    let mut parent: Vec<usize> = (0..triangles).collect();
    let mut first: Vec<Option<usize>> = vec![None; mesh.edge_count()];
    for (t, edges) in mesh.triangle_edges().iter().enumerate() {
        for &edge in edges {
            let other = *first[edge].get_or_insert(t);
            let (a, b) = (root(&mut parent, other), root(&mut parent, t));
            parent[a.max(b)] = a.min(b);
        }
    }
    // A root is the first triangle of its part, so it is numbered before the others ask for its number.
    let mut part = vec![0; triangles];
    let mut count = 0;
    for t in 0..triangles {
        let r = root(&mut parent, t);
        if r == t {
            part[t] = count;
            count += 1;
        } else {
            part[t] = part[r];
        }
    }
    part
}

pub(super) fn hinges(mesh: &Mesh, part_of: &[usize]) -> Vec<Hinge> {
    let mut first: Vec<Option<usize>> = vec![None; mesh.vertices().len()];
    let mut shared: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for (corners, &part) in mesh.triangles().iter().zip(part_of) {
        for &vertex in corners {
            let known = *first[vertex].get_or_insert(part);
            if known != part {
                shared.entry(vertex).or_default().extend([known, part]);
            }
        }
    }
    shared
        .into_iter()
        .map(|(vertex, parts)| Hinge { vertex, parts: parts.into_iter().collect() })
        .collect()
}
