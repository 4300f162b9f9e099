//! The edges of a mesh, found from its triangles, and the parts of the boundary that they make.

use std::collections::{BTreeMap, BTreeSet};

use super::{BoundaryEdge, MeshError};

/// Half of an edge: an edge as one of its triangles sees it, and the next edge that starts its list at the same vertex.
pub(super) struct MeshEdge {
    pub(super) vertices: [usize; 2],
    pub(super) owner: BoundaryEdge,
    pub(super) inner: bool,
    pub(super) next: Option<usize>,
}

/// All edges. Each is in the list of the end where fewer triangles meet: the hub of a fan would have a long list.
pub(super) struct MeshEdges {
    pub(super) edges: Vec<MeshEdge>,
    pub(super) first: Vec<Option<usize>>,
    triangles_at: Vec<u32>,
}

impl MeshEdges {
    /// The end whose list has the edge, if it is in one.
    fn lister(&self, a: usize, b: usize) -> Option<usize> {
        let at = |v: usize| self.triangles_at.get(v).map(|&count| (count, v));
        Some(at(a)?.min(at(b)?).1)
    }

    pub(super) fn find(&self, a: usize, b: usize) -> Option<usize> {
        let mut edge = *self.first.get(self.lister(a, b)?)?;
        while let Some(e) = edge {
            let [p, q] = self.edges[e].vertices;
            if [p, q] == [a, b] || [q, p] == [a, b] {
                return Some(e);
            }
            edge = self.edges[e].next;
        }
        None
    }
}

pub(super) fn match_edges(
    vertex_count: usize,
    triangles: &[[usize; 3]],
) -> Result<(MeshEdges, Vec<[usize; 3]>), MeshError> {
    let mut all = MeshEdges {
        edges: Vec::with_capacity(triangles.len() * 3 / 2 + vertex_count),
        first: vec![None; vertex_count],
        triangles_at: vec![0; vertex_count],
    };
    for &vertex in triangles.as_flattened() {
        all.triangles_at[vertex] += 1;
    }
    let mut triangle_edges = vec![[0; 3]; triangles.len()];
    for (triangle, corners) in triangles.iter().enumerate() {
        for local in 0..3 {
            let [a, b] = [corners[(local + 1) % 3], corners[(local + 2) % 3]];
            let edge = match all.find(a, b) {
                Some(e) => {
                    let known = &mut all.edges[e];
                    if known.inner || known.vertices == [a, b] {
                        let triangles = [known.owner.triangle, triangle];
                        return Err(MeshError::Overlap { triangles, vertices: [a, b] });
                    }
                    known.inner = true;
                    e
                }
                None => {
                    let lister = all.lister(a, b).unwrap_or(a);
                    let first = &mut all.first[lister];
                    all.edges.push(MeshEdge {
                        vertices: [a, b],
                        owner: BoundaryEdge { triangle, local },
                        inner: false,
                        next: first.replace(all.edges.len()),
                    });
                    all.edges.len() - 1
                }
            };
            triangle_edges[triangle][local] = edge;
        }
    }
    Ok((all, triangle_edges))
}

/// The boundary parts by name, and the named curves that are no boundaries, with the reason.
pub(super) type Named = (BTreeMap<String, Vec<BoundaryEdge>>, BTreeMap<String, MeshError>);

pub(super) fn name_boundaries(
    edges: &MeshEdges,
    places: &[[f64; 2]],
    named: Vec<(String, Vec<[usize; 2]>)>,
) -> Result<Named, MeshError> {
    let mut boundaries: BTreeMap<String, Vec<BoundaryEdge>> = BTreeMap::new();
    let mut faults = BTreeMap::new();
    for (name, pairs) in named {
        let of_name = boundaries.entry(name.clone()).or_default();
        let mut seen = BTreeSet::new();
        for [a, b] in pairs {
            if let Some(&number) = [a, b].iter().find(|&&vertex| vertex >= places.len()) {
                let (of, count) = (["boundary", "vertex", "vertices"], places.len());
                return Err(MeshError::Beyond { of, name, number, count });
            }
            let (boundary, ends) = (name.clone(), [places[a], places[b]]);
            let fault = match edges.find(a, b) {
                Some(e) if !edges.edges[e].inner => {
                    // An edge that is listed twice is one.
                    if seen.insert(e) {
                        of_name.push(edges.edges[e].owner);
                    }
                    continue;
                }
                Some(_) => MeshError::InnerEdge { boundary, ends },
                None => MeshError::NoSuchEdge { boundary, ends },
            };
            faults.entry(name.clone()).or_insert(fault);
        }
    }
    boundaries.retain(|name, _| !faults.contains_key(name));
    Ok((boundaries, faults))
}
