//! Merges vertices that are closer than a tolerance.
//!
//! A mesh that was written with few digits, or put together from pieces, has vertices close to each other where one is meant.
//! Vertices no further apart than a given share of the body's size (the longer side of its box, as rounding is a share of the
//! coordinates) become the first of them; so do chains of such vertices.

use super::groups::groups;
use super::tree::{Bounds, Tree};

/// For each vertex the first of those that become one with it: all that are no further apart than `share` of the body's size, but
/// for two that `are_apart`.
pub fn merge(
    vertices: &[[f64; 2]],
    share: f64,
    are_apart: impl Fn(usize, usize) -> bool,
) -> Vec<usize> {
    let distance = share * Bounds::around(vertices.iter().copied()).size();
    let tree = Tree::new(vertices.iter().map(|&v| Bounds::around([v])).collect());
    let mut near = Vec::new();
    for (v, &[x, y]) in vertices.iter().enumerate() {
        for w in tree.meeting(Bounds::around([[x, y]]).widened(distance)) {
            let [p, q] = vertices[w];
            if w > v && (x - p).hypot(y - q) <= distance && !are_apart(v, w) {
                near.push([v, w]);
            }
        }
    }
    let mut first = Vec::new();
    let of_group = |(v, group): (usize, usize)| {
        if group == first.len() {
            first.push(v);
        }
        first[group]
    };
    groups(vertices.len(), near).into_iter().enumerate().map(of_group).collect()
}
