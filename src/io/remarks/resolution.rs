//! Remarks on whether the mesh resolves the contact: each stretch of it beside the edges that it lies on, and the gap between the nodes.

use std::ops::Range;

use super::{NO_LENGTH, Words, model, place, size};
use crate::contact::piece::PieceGeometry;
use crate::model::{Condition, Degree, Problem};
use crate::quote;
use crate::results::solution::{ContactEdge, ContactPoint};
use crate::results::{ContactBoundary, Solution};

/// A stretch of fewer edges than this gives a peak that is 2 % off Hertz's, of two edges 3 %, of less than one 20 % and more.
const FEWEST_EDGES: f64 = 4.0;

/// A stretch that begins where the boundary ends is half of one, as at a plane of symmetry.
const FEWEST_EDGES_OF_A_HALF: f64 = 2.0;

/// The share of its boundary's force below which a stretch does not matter.
const LITTLE_FORCE: f64 = 0.05;

/// A peak is below the mean pressure by more than what rounding makes of a pressure that is the same everywhere.
const BELOW_THE_MEAN: f64 = 0.99;

/// The share of the motion by which the interpolated gap may be off: on four edges across a contact of circles 1/16, on two 1/4.
const GAP_OFF: f64 = 0.2;

/// Places on an edge, from its start to its end.
const BETWEEN_NODES: [f64; 7] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875];

/// The distance, as a share of an edge, up to which two stretches count as one: the pressure of a mesh rises and falls by
/// edges.
const NEXT: f64 = 1.0;

/// The edges of one contact boundary, in the order of the boundary.
struct Line<'s> {
    edges: &'s [ContactEdge],
}

/// A stretch of contact on a line.
struct Stretch {
    /// From where to where, in edges from the start of the line.
    at: Range<f64>,
    /// The length on the undeformed boundary.
    length: f64,
    /// How many edges that is.
    edges: f64,
    /// Tells whether contact stops before the boundary does, at the start and at the end.
    free: [bool; 2],
    force: f64,
}

impl Line<'_> {
    fn ends(&self, e: usize) -> [&ContactPoint; 2] {
        let points = &self.edges[e].points;
        [0, points.len() - 1].map(|p| &points[p])
    }

    fn length(&self, e: usize) -> f64 {
        let [[a, b], [c, d]] = self.ends(e).map(|end| end.place);
        (c - a).hypot(d - b)
    }

    /// The place of a point in edges from the start of the line: of two edges that meet there that which starts there, or that which
    /// `ends` there.
    fn position(&self, [x, y]: [f64; 2], ends: bool) -> Option<f64> {
        let on = |e: usize| {
            let [[a, b], [c, d]] = self.ends(e).map(|end| end.place);
            let (along, length) = ([c - a, d - b], self.length(e));
            let s = ((x - a) * along[0] + (y - b) * along[1]) / (length * length);
            let s = match s {
                s if s < NO_LENGTH => 0.0,
                s if s > 1.0 - NO_LENGTH => 1.0,
                s => s,
            };
            let off = (x - a - s * along[0]).hypot(y - b - s * along[1]);
            (off <= NO_LENGTH * length && s != if ends { 0.0 } else { 1.0 }).then_some(e as f64 + s)
        };
        (0..self.edges.len()).find_map(on)
    }

    fn stretch(&self, from: [f64; 2], to: [f64; 2]) -> Option<Stretch> {
        let at = self.position(from, false)?..self.position(to, true)?;
        let (mut edges, mut length, mut force) = (0.0, 0.0, 0.0);
        for e in at.start as usize..self.edges.len().min(at.end.ceil() as usize) {
            let part = at.end.min(e as f64 + 1.0) - at.start.max(e as f64);
            let points = &self.edges[e].points;
            let mean = points.iter().map(|p| p.pressure).sum::<f64>() / points.len() as f64;
            edges += part;
            length += part * self.length(e);
            force += mean * self.length(e);
        }
        let goes_on =
            |node, end: usize| (0..self.edges.len()).any(|e| self.ends(e)[1 - end].node == node);
        let [first, last] = [at.start as usize, (at.end.ceil() as usize).saturating_sub(1)];
        let free = [
            at.start.fract() > 0.0 || goes_on(self.ends(first)[0].node, 0),
            at.end.fract() > 0.0 || goes_on(self.ends(last)[1].node, 1),
        ];
        (at.end > at.start).then_some(Stretch { at, length, edges, free, force })
    }

    /// The stretches of contact; those that meet, or nearly, are one.
    fn stretches(&self, part: &ContactBoundary) -> Vec<Stretch> {
        let found = part.stretches.iter().filter_map(|&[from, to]| self.stretch(from, to));
        let mut stretches: Vec<Stretch> = Vec::new();
        for next in found {
            match stretches.last_mut() {
                Some(last) if self.are_next(last.at.end, next.at.start) => last.join(next),
                _ => stretches.push(next),
            }
        }
        // A closed line goes on where it starts.
        let count = self.edges.len();
        let closed = self.ends(count - 1)[1].node == self.ends(0)[0].node;
        if let [first, .., last] = &stretches[..]
            && closed
            && last.at.end + NEXT >= count as f64 + first.at.start
        {
            let first = stretches.remove(0);
            if let Some(last) = stretches.last_mut() {
                last.join(first);
            }
        }
        stretches
    }

    /// Returns whether what ends at one place of a line goes on at another, in edges.
    fn are_next(&self, end: f64, start: f64) -> bool {
        let [last, first] = [(end.ceil() as usize).saturating_sub(1), start as usize];
        let joined = (last..first).all(|e| self.ends(e)[1].node == self.ends(e + 1)[0].node);
        joined && (0.0..=NEXT).contains(&(start - end))
    }

    fn middle(&self, stretch: &Stretch) -> [f64; 2] {
        let middle = (stretch.at.start + stretch.at.end) / 2.0;
        let e = middle as usize % self.edges.len();
        let [a, b] = self.ends(e).map(|end| end.place);
        [0, 1].map(|c| a[c] + middle.fract() * (b[c] - a[c]))
    }
}

impl Stretch {
    /// Adds a stretch that goes on where this one ends.
    fn join(&mut self, next: Stretch) {
        self.at.end += next.at.end - next.at.start;
        self.length += next.length;
        self.edges += next.edges;
        self.force += next.force;
        self.free[1] = next.free[1];
    }

    fn is_resolved(&self) -> bool {
        match self.free {
            [true, true] => self.edges >= FEWEST_EDGES,
            [false, false] => true,
            _ => self.edges >= FEWEST_EDGES_OF_A_HALF,
        }
    }
}

/// Says which boundaries are in contact along so few edges that force and pressure depend on the mesh.
pub(super) fn short_stretches(
    problem: &Problem,
    solution: &Solution,
    words: &Words,
) -> Vec<String> {
    let lines = solution.contact.chunk_by(|a, b| a.boundary == b.boundary);
    let lines = lines.filter(|edges| edges[0].partner.is_none());
    let is_plane = !problem.material.are_of_revolution();
    lines.filter_map(|edges| short_stretch(solution, words, edges, is_plane)).collect()
}

fn short_stretch(
    solution: &Solution,
    words: &Words,
    edges: &[ContactEdge],
    is_plane: bool,
) -> Option<String> {
    let line = Line { edges };
    let name = &*edges.first()?.boundary;
    let part = solution.boundaries.iter().find(|part| part.boundary == *name)?;
    let stretches = line.stretches(part);
    let all: f64 = stretches.iter().map(|stretch| stretch.force).sum();
    let matters = |stretch: &&Stretch| stretch.force > LITTLE_FORCE * all && !stretch.is_resolved();
    let short: Vec<&Stretch> = stretches.iter().filter(matters).collect();
    let worst = short.iter().min_by(|a, b| a.edges.total_cmp(&b.edges))?;
    let others = match short.len() - 1 {
        0 => String::new(),
        1 => ", and likewise in one other place".to_owned(),
        more => format!(", and likewise in {more} other places"),
    };
    let mean = part.force / part.length;
    let [peak, shown_mean] = [part.peak_pressure, mean].map(|stress| words.stress(stress));
    let below = match part.peak_pressure < BELOW_THE_MEAN * mean {
        true => format!(" (the peak of {peak} is even below force / length, {shown_mean})"),
        false => String::new(),
    };
    let depends = if words.known_force.as_deref() == Some(name) {
        "the pressure depends on the mesh; make it finer there".to_owned()
    } else if !(is_plane && part.may_be_certified()) {
        "force and pressure depend on the mesh; make it finer there".to_owned()
    } else {
        format!(
            "force and pressure depend on the mesh; make it finer there, or ask for the force: --within \"force {} 5 %\"",
            quote::cut(name)
        )
    };
    Some(format!(
        "contact of {} around {} is {} long, the edges there {}{others}: {depends}{below}",
        quote::quoted(name, '\''),
        place(line.middle(worst)),
        words.length(worst.length),
        words.length(worst.length / worst.edges)
    ))
}

/// Says where between the nodes the gap is far from what the mesh makes of it, beside how far the body moves or, before it is
/// solved, overlaps its obstacle.
pub(super) fn gaps(
    problem: &Problem,
    degree: Degree,
    solution: Option<&Solution>,
    line: &[&PieceGeometry],
    words: &Words,
) -> Vec<String> {
    let to_obstacles: Vec<&PieceGeometry> = model::to_obstacles(line).collect();
    let by_boundary = to_obstacles.chunk_by(|a, b| a.first().boundary == b.first().boundary);
    by_boundary.filter_map(|pieces| gap(problem, degree, solution, words, pieces)).collect()
}

fn gap(
    problem: &Problem,
    degree: Degree,
    solution: Option<&Solution>,
    words: &Words,
    pieces: &[&PieceGeometry],
) -> Option<String> {
    let name = &*pieces[0].first().boundary;
    let gap_at = |x: [f64; 2]| match problem.conditions.get(name)? {
        Condition::Contact { gap } => Some(gap.at(x)).filter(|gap| gap.is_finite()),
        Condition::Obstacle(_, obstacle) => Some(obstacle.closest(x, String::new).ok()?.gap),
        _ => None,
    };
    let motion = match solution {
        None => pieces.iter().flat_map(|piece| piece.gaps()).fold(0.0, |most: f64, g| most.max(-g)),
        Some(solution) => {
            let of_line = solution.contact.iter().filter(|edge| &*edge.boundary == name);
            of_line.flat_map(|edge| &edge.points).fold(0.0, |most: f64, p| most.max(p.u_n.abs()))
        }
    };
    // By how much the interpolant is off, the place, the gap there and its interpolant.
    let mut worst: Option<(f64, [f64; 2], f64, f64)> = None;
    for piece in pieces.iter().filter(|piece| !piece.curved) {
        let [a, b] = problem.mesh.places_of_ends(piece.first().edge);
        let gaps: Vec<f64> = piece.gaps().collect();
        for s in BETWEEN_NODES {
            let at = [0, 1].map(|c| a[c] + s * (b[c] - a[c]));
            let Some(gap) = gap_at(at) else { continue };
            let interpolant = degree.value_at(&gaps, s);
            let off = (interpolant - gap).abs();
            // A gap that the motion does not close does not matter.
            if gap.min(interpolant) <= motion && worst.is_none_or(|worst| off > worst.0) {
                worst = Some((off, at, gap, interpolant));
            }
        }
    }
    let least = (GAP_OFF * motion).max(NO_LENGTH * size(problem));
    let (_, at, gap, interpolant) = worst.filter(|worst| worst.0 > least)?;
    Some(format!(
        "the gap of {} at {}, between two nodes, is {}; interpolated on the edge there it is {}: the mesh does not resolve it, make it finer there",
        quote::quoted(name, '\''),
        place(at),
        words.length(gap),
        words.length(interpolant)
    ))
}
