//! The edges of an outline, met by a line that sweeps over the plane: whether two cross, and whether body lies over body.
//!
//! The sweep line stands upright and goes from left to right. It keeps the edges that it meets in their order from below, the
//! *column*; that order changes at the ends of edges only, as long as none cross, and two that cross are next to each other in
//! the column before they do (Shamos and Hoey, *Geometric intersection problems*, 1976). The body lies on the left of each edge:
//! from below, edges with the body above them and edges with the body below them must take turns, or some of it is covered twice.
//! Time is proportional to N log N for N edges, but for moving those of the column up and down in its list.

use nalgebra::Vector2;

/// Faults of an outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// Two edges cross.
    Crossing([usize; 2]),
    /// At the left end of the edge, the body lies on the wrong side of the edge below it.
    Covered { edge: usize, below: Option<usize> },
}

/// Sweeps over the edges with these places of vertices, each from start to end with the body on its left, until there is a fault.
pub(super) fn sweep(places: &[Vector2<f64>], ends: &[[usize; 2]]) -> Result<(), Fault> {
    let mut sweep = Sweep::new(places, ends);
    (0..sweep.vertices.len()).try_for_each(|rank| sweep.pass(rank))
}

/// Twice the area of the triangle a b c, positive if it is counter-clockwise; 0 where rounding could change the sign.
pub(super) fn turn(a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>) -> f64 {
    // The two products of `perp`, each on its own for the sake of the bound.
    let (to_b, to_c) = (b - a, c - a);
    let (left, right) = (to_b.x * to_c.y, to_b.y * to_c.x);
    // Four times the bound of Shewchuk's filter.
    let rounding = 8.0 * f64::EPSILON * (left.abs() + right.abs());
    if (left - right).abs() <= rounding { 0.0 } else { left - right }
}

/// Returns whether the inner parts of two segments cross.
pub(super) fn cross([a, b]: [Vector2<f64>; 2], [c, d]: [Vector2<f64>; 2]) -> bool {
    let opposite = |s: f64, t: f64| (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0);
    opposite(turn(a, b, c), turn(a, b, d)) && opposite(turn(c, d, a), turn(c, d, b))
}

struct Sweep<'a> {
    places: &'a [Vector2<f64>],
    ends: &'a [[usize; 2]],
    /// The vertices of the outline in the order in which the line meets them; of those above each other the lower one first.
    vertices: Vec<usize>,
    /// Both ends of each edge by their ranks in that order, the lower rank first.
    ranks: Vec<[usize; 2]>,
    /// The edges at each vertex, by ranks.
    at: Vec<Vec<usize>>,
    /// The edges that the line meets, from below.
    column: Vec<usize>,
}

impl<'a> Sweep<'a> {
    fn new(places: &'a [Vector2<f64>], ends: &'a [[usize; 2]]) -> Self {
        let place = |v: usize| places[v];
        let mut vertices = ends.as_flattened().to_vec();
        vertices.sort_unstable_by(|&v, &w| {
            let ([a, b], [c, d]): ([f64; 2], [f64; 2]) = (place(v).into(), place(w).into());
            a.total_cmp(&c).then(b.total_cmp(&d)).then(v.cmp(&w))
        });
        vertices.dedup();
        let mut rank = vec![0; places.len()];
        vertices.iter().enumerate().for_each(|(r, &v)| rank[v] = r);
        let mut at = vec![Vec::new(); vertices.len()];
        let mut ranks = Vec::with_capacity(ends.len());
        for (e, of_edge) in ends.iter().enumerate() {
            let mut pair = of_edge.map(|v| rank[v]);
            pair.iter().for_each(|&r| at[r].push(e));
            pair.sort_unstable();
            ranks.push(pair);
        }
        Sweep { places, ends, vertices, ranks, at, column: Vec::new() }
    }

    fn place(&self, rank: usize) -> Vector2<f64> {
        self.places[self.vertices[rank]]
    }

    /// The side of an edge on which `p` lies: above (positive), below (negative), or on it.
    fn side(&self, e: usize, p: Vector2<f64>) -> f64 {
        let [left, right] = self.ranks[e].map(|r| self.place(r));
        turn(left, right, p)
    }

    fn is_body_above(&self, e: usize) -> bool {
        self.ends[e][0] == self.vertices[self.ranks[e][0]]
    }

    /// The edges that end at a vertex leave the column, those that begin there enter it.
    fn pass(&mut self, rank: usize) -> Result<(), Fault> {
        let p = self.place(rank);
        let is_below = |e: usize| !self.ranks[e].contains(&rank) && self.side(e, p) > 0.0;
        let mut at = self.column.partition_point(|&e| is_below(e));
        let ends = |e: &usize| self.ranks[*e][1] == rank;
        let ending = self.column[at..].iter().take_while(|e| ends(e)).count();
        self.column.drain(at..at + ending);
        if ending < self.at[rank].iter().filter(|e| ends(e)).count() {
            // Another edge touches the vertex, which is near it.
            let ranks = &self.ranks;
            self.column.retain(|&e| ranks[e][1] != rank);
            at = self.column.partition_point(|&e| self.side(e, p) > 0.0);
        }
        let far = |e: usize| self.place(self.ranks[e][1]);
        // Sorted from below; few edges begin at a vertex.
        let mut beginning: Vec<usize> = Vec::new();
        for &e in self.at[rank].iter().filter(|&&e| self.ranks[e][0] == rank) {
            // Of two that lie on each other, the one with the body below comes first: a vertex that hangs there is no overlap.
            let is_below = |&f: &usize| {
                let turn = turn(p, far(f), far(e));
                turn > 0.0 || (turn == 0.0 && !self.is_body_above(f))
            };
            let below = beginning.partition_point(is_below);
            beginning.insert(below, e);
        }
        let mut chain = Vec::with_capacity(beginning.len() + 2);
        chain.push(at.checked_sub(1).map(|below| self.column[below]));
        chain.extend(beginning.iter().map(|&e| Some(e)));
        chain.push(self.column.get(at).copied());
        for pair in chain.windows(2) {
            let [Some(e), Some(f)] = [pair[0], pair[1]] else { continue };
            let [a, b] = [e, f].map(|e| self.ranks[e]);
            let is_apart = a.iter().all(|end| !b.contains(end));
            if is_apart && cross(a.map(|r| self.place(r)), b.map(|r| self.place(r))) {
                return Err(Fault::Crossing([e, f]));
            }
        }
        let mut below = chain[0];
        for &e in &beginning {
            let is_covered = below.is_some_and(|below| self.is_body_above(below));
            if is_covered == self.is_body_above(e) {
                return Err(Fault::Covered { edge: e, below });
            }
            below = Some(e);
        }
        self.column.splice(at..at, beginning);
        Ok(())
    }
}
