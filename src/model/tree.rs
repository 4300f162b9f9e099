//! Boxes in the plane, sorted into a binary tree, which finds those that meet a given box.

/// An axis-parallel box: its least and its greatest coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    /// The least coordinates.
    pub(crate) low: [f64; 2],
    /// The greatest coordinates.
    pub(crate) high: [f64; 2],
}

impl Bounds {
    /// Around these points.
    pub(crate) fn around(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let nothing = Bounds { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        points.into_iter().fold(nothing, |all, p| all.with(Bounds { low: p, high: p }))
    }

    /// Widens the box by `margin` on each side.
    #[must_use]
    pub(crate) fn widened(self, margin: f64) -> Self {
        Bounds { low: self.low.map(|c| c - margin), high: self.high.map(|c| c + margin) }
    }

    /// Around both.
    pub(crate) fn with(self, other: Bounds) -> Self {
        let both =
            |f: fn(f64, f64) -> f64, a: [f64; 2], b: [f64; 2]| [f(a[0], b[0]), f(a[1], b[1])];
        Bounds {
            low: both(f64::min, self.low, other.low),
            high: both(f64::max, self.high, other.high),
        }
    }

    fn meets(self, other: Bounds) -> bool {
        (0..2).all(|c| self.low[c] <= other.high[c] && other.low[c] <= self.high[c])
    }

    /// The longest side.
    pub(crate) fn size(self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1])
    }
}

/// The tree over a list of boxes. A node covers a range of `items`; its children halve the range.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    items: Vec<usize>,
    boxes: Vec<Bounds>,
    nodes: Vec<Bounds>,
}

/// Ranges of this many items are not halved.
const LEAF: usize = 4;

impl Tree {
    /// Over `boxes`, which are known by their numbers from here on.
    pub(crate) fn new(boxes: Vec<Bounds>) -> Self {
        let mut items: Vec<usize> = (0..boxes.len()).collect();
        let mut nodes = Vec::new();
        build(&mut items, &boxes, 0, &mut nodes);
        Tree { items, boxes, nodes }
    }

    /// The numbers of the boxes that meet `bounds`, in order.
    pub(crate) fn meeting(&self, bounds: Bounds) -> Vec<usize> {
        let mut found = Vec::new();
        let mut waiting = vec![(0, 0, self.items.len())];
        while let Some((node, start, end)) = waiting.pop() {
            if start == end || !self.nodes[node].meets(bounds) {
                continue;
            }
            if end - start <= LEAF {
                let items = self.items[start..end].iter();
                found.extend(items.filter(|&&i| self.boxes[i].meets(bounds)));
            } else {
                let middle = start.midpoint(end);
                waiting.extend([(2 * node + 2, middle, end), (2 * node + 1, start, middle)]);
            }
        }
        found.sort_unstable();
        found
    }
}

/// Sorts `items` along the longer side of what they fill, half by half, and notes the bounds of each range at its node.
fn build(items: &mut [usize], boxes: &[Bounds], node: usize, nodes: &mut Vec<Bounds>) {
    let all = items.iter().map(|&i| boxes[i]).reduce(Bounds::with);
    let Some(all) = all else { return };
    if nodes.len() <= node {
        nodes.resize(node + 1, all);
    }
    nodes[node] = all;
    if items.len() > LEAF {
        let c = usize::from(all.high[1] - all.low[1] > all.high[0] - all.low[0]);
        let middle = items.len() / 2;
        let centre = |i: usize| boxes[i].low[c] / 2.0 + boxes[i].high[c] / 2.0;
        items.select_nth_unstable_by(middle, |&a, &b| centre(a).total_cmp(&centre(b)));
        let (first, second) = items.split_at_mut(middle);
        build(first, boxes, 2 * node + 1, nodes);
        build(second, boxes, 2 * node + 2, nodes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_finds_what_a_look_at_every_box_finds() {
        let mut seed = 7_u64;
        let mut random = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 40) as f64 / (1_u64 << 24) as f64
        };
        for count in [0, 1, 4, 5, 300] {
            let boxes: Vec<Bounds> = (0..count)
                .map(|_| {
                    let corner = [random(), random()];
                    Bounds::around([corner, [corner[0] + 0.1 * random(), corner[1]]])
                })
                .collect();
            let tree = Tree::new(boxes.clone());
            for _ in 0..50 {
                let asked = Bounds::around([[random(), random()], [random(), random()]]);
                let expected: Vec<usize> = (0..count).filter(|&i| boxes[i].meets(asked)).collect();
                assert_eq!(tree.meeting(asked), expected);
            }
        }
    }
}
