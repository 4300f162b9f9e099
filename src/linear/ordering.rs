//! The order in which the nodes are eliminated: nested dissection by coordinates.
//!
//! A set of nodes is cut by a line across its longer extent; the nodes on one side of it that have neighbours on the other,
//! on the side where they are fewer, separate the two halves and are eliminated after both.

use crate::linear::matrix::Neighbours;

/// Sets of at most this many nodes are not cut any further.
const LEAF: usize = 8;

/// The order of elimination of nodes at the given places with the given neighbours.
pub fn nested_dissection(places: &[[f64; 2]], neighbours: &Neighbours) -> Vec<usize> {
    let mut order = Vec::with_capacity(places.len());
    let side = vec![Half::Outside; places.len()];
    let mut dissection = Dissection { places, neighbours, side, back: Vec::new() };
    let mut all: Vec<usize> = (0..places.len()).collect();
    dissection.cut(&mut all, &mut order);
    order
}

struct Dissection<'a> {
    places: &'a [[f64; 2]],
    neighbours: &'a Neighbours,
    /// Scratch: where each node lies with regard to the set at hand.
    side: Vec<Half>,
    /// Scratch of [`partition`].
    back: Vec<usize>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Half {
    Outside,
    Lower,
    Upper,
}

impl Dissection<'_> {
    /// Appends the nodes of `set` to `order`. Recurses as deep as the logarithm of their number.
    fn cut(&mut self, set: &mut [usize], order: &mut Vec<usize>) {
        let Some((axis, line)) = self.line(set) else {
            order.extend_from_slice(set);
            return;
        };
        let (places, mut back) = (self.places, std::mem::take(&mut self.back));
        let lower = partition(set, &mut back, |node| places[node][axis] < line);
        self.mark(&set[..lower], Half::Lower);
        self.mark(&set[lower..], Half::Upper);
        let touches = |node: usize, side: Half| {
            self.neighbours.of(node).iter().any(|&other| self.side[other] == side)
        };
        // The lower half without its border, then the border; the border of the upper half, then the rest of it.
        let low = partition(&mut set[..lower], &mut back, |node| !touches(node, Half::Upper));
        let high =
            lower + partition(&mut set[lower..], &mut back, |node| touches(node, Half::Lower));
        self.back = back;
        self.mark(set, Half::Outside);
        let separator = if lower - low <= high - lower { low..lower } else { lower..high };
        let (rest, upper) = set.split_at_mut(separator.end);
        let (lower, separator) = rest.split_at_mut(separator.start);
        self.cut(lower, order);
        self.cut(upper, order);
        order.extend_from_slice(separator);
    }

    fn mark(&mut self, nodes: &[usize], side: Half) {
        for &node in nodes {
            self.side[node] = side;
        }
    }

    /// The axis across which to cut, and where: at the middle node along it, moved so that both halves have nodes.
    fn line(&self, set: &mut [usize]) -> Option<(usize, f64)> {
        if set.len() <= LEAF {
            return None;
        }
        let extent = |axis: usize| {
            let along = set.iter().map(|&node| self.places[node][axis]);
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            (low, high - low)
        };
        let extents = [extent(0), extent(1)];
        let axis = usize::from(extents[1].1 > extents[0].1);
        let (low, extent) = extents[axis];
        if !(extent > 0.0) {
            return None;
        }
        let middle = set.len() / 2;
        let by_place = |a: &usize, b: &usize| {
            self.places[*a][axis].total_cmp(&self.places[*b][axis]).then(a.cmp(b))
        };
        let (_, &mut node, _) = set.select_nth_unstable_by(middle, by_place);
        let line = self.places[node][axis];
        if line > low {
            return Some((axis, line));
        }
        // More than half of the nodes lie at the lower end: cut just above it.
        let above = set.iter().map(|&node| self.places[node][axis]).filter(|&x| x > low);
        Some((axis, above.fold(f64::INFINITY, f64::min)))
    }
}

/// Moves the nodes for which `first` holds to the front, keeping the order within both groups, and counts them. The others are in `back`
/// for a while.
fn partition(set: &mut [usize], back: &mut Vec<usize>, first: impl Fn(usize) -> bool) -> usize {
    back.clear();
    let mut front = 0;
    for place in 0..set.len() {
        let node = set[place];
        if first(node) {
            set[front] = node;
            front += 1;
        } else {
            back.push(node);
        }
    }
    set[front..].copy_from_slice(back);
    front
}
