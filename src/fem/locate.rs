//! Which triangle a point lies in, for many points: a tree of boxes around the triangles, in which a point is looked for
//! where it can be. Its size grows like the number of triangles, a search like its logarithm.

use super::mesh::Mesh;

/// For fewer points than this, to go through the triangles is quicker than to make the tree.
const FEW: usize = 8;

/// So many triangles share a box that is not divided further.
const LEAF: usize = 8;

/// Boxes are wider than their triangles by this part of them: [`Mesh::locate`] grants a point less.
const MARGIN: f64 = 1e-9;

/// Of each point what [`Mesh::locate`] says of it: the first triangle that contains it, with its barycentric coordinates.
pub fn locate_all(mesh: &Mesh, points: &[[f64; 2]]) -> Vec<Option<(usize, [f64; 3])>> {
    if points.len() < FEW {
        return points.iter().map(|&x| mesh.locate(x)).collect();
    }
    let tree = Tree::new(mesh);
    points.iter().map(|&x| tree.locate(x)).collect()
}

struct Tree<'m> {
    mesh: &'m Mesh,
    /// The triangles, those of a box side by side.
    order: Vec<usize>,
    boxes: Vec<Bounds>,
}

/// A box around the triangles `order[first..end]`. Unless they are few, its parts are the next box, which holds the first
/// half of them, and the box `second`.
struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
    first: usize,
    end: usize,
    second: Option<usize>,
}

impl<'m> Tree<'m> {
    fn new(mesh: &'m Mesh) -> Self {
        let order: Vec<usize> = (0..mesh.triangles().len()).collect();
        let mut tree = Tree { mesh, boxes: Vec::with_capacity(order.len() / 2 + 1), order };
        tree.divide(0, tree.order.len());
        tree
    }

    /// Makes the box around `order[first..end]` and those in it. Each has half as many triangles: it ends soon.
    fn divide(&mut self, first: usize, end: usize) {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for &t in &self.order[first..end] {
            let margin = MARGIN * self.mesh.diameter(t);
            for vertex in self.mesh.triangle(t).vertices {
                for c in 0..2 {
                    low[c] = low[c].min(vertex[c] - margin);
                    high[c] = high[c].max(vertex[c] + margin);
                }
            }
        }
        let own = self.boxes.len();
        self.boxes.push(Bounds { low, high, first, end, second: None });
        if end - first <= LEAF {
            return;
        }
        let c = usize::from(high[1] - low[1] > high[0] - low[0]);
        let middle = (end - first) / 2;
        let mesh = self.mesh;
        let centre = |&t: &usize| mesh.triangle(t).vertices.iter().map(|v| v[c]).sum::<f64>();
        self.order[first..end]
            .select_nth_unstable_by(middle, |a, b| centre(a).total_cmp(&centre(b)));
        self.divide(first, first + middle);
        self.boxes[own].second = Some(self.boxes.len());
        self.divide(first + middle, end);
    }

    fn locate(&self, x: [f64; 2]) -> Option<(usize, [f64; 3])> {
        let mut found: Option<(usize, [f64; 3])> = None;
        let mut waiting = vec![0];
        while let Some(b) = waiting.pop() {
            let Bounds { low, high, first, end, second } = &self.boxes[b];
            if !(0..2).all(|c| low[c] <= x[c] && x[c] <= high[c]) {
                continue;
            }
            if let Some(second) = second {
                waiting.extend([*second, b + 1]);
                continue;
            }
            for &t in &self.order[*first..*end] {
                if found.is_none_or(|(best, _)| t < best)
                    && let Some(l) = self.mesh.barycentric(t, x)
                {
                    found = Some((t, l));
                }
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::{Diagonal, Rectangle};

    #[test]
    fn every_point_is_found_in_the_triangle_that_a_search_through_all_finds() {
        for diagonal in [Diagonal::Left, Diagonal::Right, Diagonal::Crossed] {
            let body = Rectangle { width: 2.0, height: 1.0, nx: 9, ny: 7, diagonal };
            for mesh in [body.mesh().unwrap(), body.perturbed(0.2, 3).unwrap()] {
                let mut points = mesh.vertices().to_vec();
                let (mut state, mut inside) = (1_u64, 0);
                let mut random = || {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (state >> 11) as f64 / (1_u64 << 53) as f64
                };
                points.extend((0..2000).map(|_| [2.2 * random() - 0.1, 1.2 * random() - 0.1]));
                // On edges, where several triangles contain the point, and a little outside.
                points.extend((0..500).map(|_| [2.0 * random(), 0.0]));
                points.extend((0..500).map(|_| [2.0 * random(), -1e-13]));
                for (found, &x) in locate_all(&mesh, &points).into_iter().zip(&points) {
                    assert_eq!(found, mesh.locate(x), "{x:?}");
                    inside += usize::from(found.is_some());
                }
                assert!(inside > 1000 && inside < points.len());
            }
        }
    }
}
