//! A line of straight sides and arcs, its closest point to a place, and on which side of it the place is.
//!
//! An open line goes on straight beyond its two ends, so that it has two sides everywhere.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use thiserror::Error;

use super::boundary_normals::{SmoothEdge, left_of, smooth_normals, unit};
use super::mesh::{NO_ANGLE, ROUNDED, length};
use crate::quote::{number, short};

/// Errors of points that make no line.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
pub enum PathError {
    #[error("found {count} points; expected two or more, and three that differ for a closed line")]
    Points { count: usize },
    #[error("the point ({}, {}) follows itself; expected points that differ", number(place[0]), number(place[1]))]
    Same { place: [f64; 2] },
    #[error("found {count} radii; expected one, or one for each of the {corners} corners")]
    Radii { count: usize, corners: usize },
    #[error("the edges are not one line: at ({}, {}) another one begins, or several meet; expected a curve without branches", number(place[0]), number(place[1]))]
    NotOne { place: [f64; 2] },
    #[error("the line turns back at ({}, {}); expected a corner", number(place[0]), number(place[1]))]
    TurnsBack { place: [f64; 2] },
    #[error(
        "the arcs of radius {} at ({}, {}) and of its neighbour take {} of the side between them, which is {} long; expected smaller radii",
        number(*radius), number(place[0]), number(place[1]), short(*needed), short(*length)
    )]
    TooRound { radius: f64, place: [f64; 2], needed: f64, length: f64 },
}

/// A line of straight sides and arcs, with a left side and a right side.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    sides: Vec<Side>,
    closed: bool,
    /// The largest coordinate: a length that is small beside it is rounding.
    size: f64,
}

/// A straight side or an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    ends: [Vector2<f64>; 2],
    shape: Shape,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// From one share of the way between the ends to another: 0 to 1, or beyond.
    Line([f64; 2]),
    /// Around this centre; true: it turns left.
    Arc(Vector2<f64>, bool),
}

/// A line as seen from a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Beside {
    /// The distance, positive on the left of the line.
    pub(crate) left: f64,
    /// The unit vector in which it grows.
    pub(crate) growth: Vector2<f64>,
}

/// The closest point of a side.
struct Near {
    place: Vector2<f64>,
    distance: f64,
    /// The end of the side that the point is: start (0) or end (1).
    end: Option<usize>,
}

impl Path {
    /// The line through these points, closed if the last one is the first. Its corners (for an open line all points but two) are
    /// rounded with these radii; 0 leaves them sharp.
    ///
    /// # Errors
    /// As [`PathError`] says.
    pub fn new(points: &[[f64; 2]], radii: &[f64]) -> Result<Self, PathError> {
        let closed = points.len() > 1 && points.first() == points.last();
        let mut points: Vec<Vector2<f64>> = points.iter().map(|&p| p.into()).collect();
        if closed {
            points.pop();
        }
        let count = points.len();
        if count < if closed { 3 } else { 2 } {
            return Err(PathError::Points { count: count + usize::from(closed) });
        }
        let sides = if closed { count } else { count - 1 };
        let next = |k: usize| points[(k + 1) % count];
        if let Some(k) = (0..sides).find(|&k| points[k] == next(k)) {
            return Err(PathError::Same { place: points[k].into() });
        }
        let corners: Vec<usize> =
            if closed { (0..count).collect() } else { (1..count - 1).collect() };
        let mut radius = vec![0.0; count];
        match radii {
            [] => {}
            &[all] => corners.iter().for_each(|&k| radius[k] = all),
            each if each.len() == corners.len() => {
                corners.iter().zip(each).for_each(|(&k, &r)| radius[k] = r);
            }
            other => {
                return Err(PathError::Radii { count: other.len(), corners: corners.len() });
            }
        }
        let along: Vec<Vector2<f64>> = (0..sides).map(|k| unit(next(k) - points[k])).collect();
        // How much an arc takes of the sides before and after its corner, and by how much it turns left.
        let mut taken = vec![0.0; count];
        let mut turns = vec![0.0; count];
        for &k in &corners {
            let (before, after) = (along[(k + sides - 1) % sides], along[k % sides]);
            let turn = before.perp(&after).atan2(before.dot(&after));
            if std::f64::consts::PI - turn.abs() <= NO_ANGLE {
                return Err(PathError::TurnsBack { place: points[k].into() });
            }
            turns[k] = turn;
            taken[k] =
                if turn.abs() > NO_ANGLE { radius[k] * (turn.abs() / 2.0).tan() } else { 0.0 };
        }
        let mut made = Vec::new();
        for k in 0..sides {
            let (from, to) = (k, (k + 1) % count);
            let (whole, needed) = (length(points[to] - points[from]), taken[from] + taken[to]);
            // A side that is used up by its two arcs may be so to rounding.
            if needed > whole * (1.0 + ROUNDED) {
                let corner = if taken[from] > taken[to] { from } else { to };
                return Err(PathError::TooRound {
                    radius: radius[corner],
                    place: points[corner].into(),
                    needed,
                    length: whole,
                });
            }
            let ends = [points[from] + along[k] * taken[from], points[to] - along[k] * taken[to]];
            if needed < whole * (1.0 - ROUNDED) {
                made.push(Side { ends, shape: Shape::Line([0.0, 1.0]) });
            }
            if taken[to] > 0.0 {
                let (left, after) = (turns[to] > 0.0, along[(k + 1) % sides]);
                let inwards = if left { left_of(along[k]) } else { -left_of(along[k]) };
                let center = ends[1] + inwards * radius[to];
                let ends = [ends[1], points[to] + after * taken[to]];
                made.push(Side { ends, shape: Shape::Arc(center, left) });
            }
        }
        Ok(Path::of(made, closed))
    }

    /// The line of edges, each given by its two ends, in any order; their direction is that of the first. Where it bends by little, it
    /// is taken for smooth, as the boundary of a mesh is (`boundary_normals`), and an edge for an arc.
    ///
    /// # Errors
    /// [`PathError::NotOne`] for edges that are no line, or several.
    pub fn through(edges: &[[[f64; 2]; 2]]) -> Result<Self, PathError> {
        let (points, closed) = chained(edges)?;
        let count = points.len();
        let ends: Vec<[usize; 2]> =
            (0..if closed { count } else { count - 1 }).map(|k| [k, (k + 1) % count]).collect();
        let normals = smooth_normals(&ends, |k| points[k], |_| 0.0);
        let sides = ends.iter().zip(normals).map(|(&[k, l], normals)| {
            let ends = [points[k], points[l]];
            let Some(normals) = normals else {
                return Side { ends, shape: Shape::Line([0.0, 1.0]) };
            };
            let curve = SmoothEdge { ends, normals, curved: true };
            let (middle, along) = (curve.at(0.5).0, unit(ends[1] - ends[0]));
            let half = length(ends[1] - ends[0]) / 2.0;
            // How far the arc is to the left of its chord; around a centre on the left it is to the right.
            let rise = (middle - (ends[0] + ends[1]) / 2.0).dot(&left_of(along));
            if rise.abs() <= ROUNDED * half {
                return Side { ends, shape: Shape::Line([0.0, 1.0]) };
            }
            let to_centre = (rise * rise - half * half) / (2.0 * rise);
            let center = (ends[0] + ends[1]) / 2.0 + left_of(along) * to_centre;
            Side { ends, shape: Shape::Arc(center, rise < 0.0) }
        });
        Ok(Path::of(sides.collect(), closed))
    }

    /// The line of these sides, which follow each other; an open one with straight sides beyond its ends.
    fn of(mut sides: Vec<Side>, closed: bool) -> Self {
        let largest = |p: Vector2<f64>| p.x.abs().max(p.y.abs());
        let size = sides.iter().flat_map(|side| side.ends.map(largest)).fold(0.0, f64::max);
        if let (false, Some(first), Some(last)) = (closed, sides.first(), sides.last()) {
            let beyond = |side: &Side, end: usize| {
                let [place, along] = [side.ends[end], -left_of(side.left_normal(side.ends[end]))];
                let along = along * length(side.ends[1] - side.ends[0]);
                match end {
                    0 => Side {
                        ends: [place - along, place],
                        shape: Shape::Line([f64::NEG_INFINITY, 1.0]),
                    },
                    _ => Side {
                        ends: [place, place + along],
                        shape: Shape::Line([0.0, f64::INFINITY]),
                    },
                }
            };
            let (before, after) = (beyond(first, 0), beyond(last, 1));
            sides.insert(0, before);
            sides.push(after);
        }
        Path { sides, closed, size }
    }

    /// Distance and direction at `x`. Of several points that are equally near, one counts.
    pub(crate) fn beside(&self, x: Vector2<f64>) -> Beside {
        let mut best = (0, self.sides[0].closest(x));
        for (k, side) in self.sides.iter().enumerate().skip(1) {
            let near = side.closest(x);
            if near.distance < best.1.distance {
                best = (k, near);
            }
        }
        let (k, Near { place, distance, end }) = best;
        let own = self.sides[k].left_normal(place);
        let next =
            end.and_then(|end| self.neighbour(k, end)).map(|l| self.sides[l].left_normal(place));
        let is_corner =
            |next: &Vector2<f64>| own.perp(next).abs() > NO_ANGLE || own.dot(next) <= 0.0;
        let away = x - place;
        let Some(next) = next.filter(is_corner) else {
            return Beside { left: away.dot(&own), growth: own };
        };
        let out = unit(own + next);
        let sign = if away.dot(&out) < 0.0 { -1.0 } else { 1.0 };
        let is_beside = distance > ROUNDED * self.size;
        let growth = if is_beside { away * (sign / distance) } else { out };
        Beside { left: sign * distance, growth }
    }

    /// The side that meets side `k` in its start (0) or end (1).
    fn neighbour(&self, k: usize, end: usize) -> Option<usize> {
        let count = self.sides.len();
        match end {
            0 if k > 0 => Some(k - 1),
            1 if k + 1 < count => Some(k + 1),
            0 if self.closed => Some(count - 1),
            1 if self.closed => Some(0),
            _ => None,
        }
    }
}

/// The points of edges in a row, along the first of them, and whether the last one joins the first.
fn chained(edges: &[[[f64; 2]; 2]]) -> Result<(Vec<Vector2<f64>>, bool), PathError> {
    let key = |place: [f64; 2]| place.map(|c| (c + 0.0).to_bits());
    let mut at: BTreeMap<[u64; 2], Vec<usize>> = BTreeMap::new();
    for (e, ends) in edges.iter().enumerate() {
        ends.iter().for_each(|&end| at.entry(key(end)).or_default().push(e));
    }
    let not_one = |place: [f64; 2]| PathError::NotOne { place };
    if let Some(&ends) = at.values().find(|of| of.len() > 2).and_then(|of| edges.get(of[0])) {
        return Err(not_one(ends[0]));
    }
    let &[start, second] = edges.first().ok_or(PathError::Points { count: 0 })?;
    let mut used = vec![false; edges.len()];
    used[0] = true;
    let mut go = |from: [f64; 2]| {
        let (mut at_end, mut places) = (from, Vec::new());
        while let Some(&e) = at.get(&key(at_end)).into_iter().flatten().find(|&&e| !used[e]) {
            used[e] = true;
            let [a, b] = edges[e];
            at_end = if key(a) == key(at_end) { b } else { a };
            places.push(at_end);
        }
        places
    };
    let (ahead, mut behind) = (go(second), go(start));
    if let Some(e) = used.iter().position(|used| !used) {
        return Err(not_one(edges[e][0]));
    }
    behind.reverse();
    let mut places: Vec<[f64; 2]> =
        behind.into_iter().chain([start, second]).chain(ahead).collect();
    let closed =
        places.len() > 2 && places.first().map(|p| key(*p)) == places.last().map(|p| key(*p));
    if closed {
        places.pop();
    }
    Ok((places.into_iter().map(Vector2::from).collect(), closed))
}

impl Side {
    /// The unit normal to the left at one of its points.
    fn left_normal(&self, place: Vector2<f64>) -> Vector2<f64> {
        match self.shape {
            Shape::Line(_) => left_of(unit(self.ends[1] - self.ends[0])),
            Shape::Arc(center, true) => unit(center - place),
            Shape::Arc(center, false) => unit(place - center),
        }
    }

    fn closest(&self, x: Vector2<f64>) -> Near {
        let at = |place: Vector2<f64>, end| Near { place, distance: length(x - place), end };
        let [start, stop] = self.ends;
        match self.shape {
            Shape::Line([from, to]) => {
                let along = stop - start;
                let share = (x - start).dot(&along) / along.dot(&along);
                if share <= from {
                    at(start, Some(0))
                } else if share >= to {
                    at(stop, Some(1))
                } else {
                    at(start + along * share, None)
                }
            }
            Shape::Arc(center, left) => {
                let out = x - center;
                let turn = if left { 1.0 } else { -1.0 };
                let angle = |v: Vector2<f64>| {
                    let first = start - center;
                    let angle = turn * first.perp(&v).atan2(first.dot(&v));
                    if angle < 0.0 { angle + std::f64::consts::TAU } else { angle }
                };
                // Seen from the centre all points of the arc are equally near.
                if length(out) > 0.0 && angle(out) < angle(stop - center) {
                    return at(center + unit(out) * length(start - center), None);
                }
                let ends = [at(start, Some(0)), at(stop, Some(1))];
                ends.into_iter()
                    .min_by(|a, b| a.distance.total_cmp(&b.distance))
                    .unwrap_or(at(start, Some(0)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_abs_diff_eq;

    use super::*;

    /// Some twenty operations on numbers of size 1 to 10.
    const ROUNDING: f64 = 1e-14;

    fn seen(path: &Path, x: [f64; 2]) -> (f64, [f64; 2]) {
        let Beside { left, growth } = path.beside(x.into());
        (left, growth.into())
    }

    #[test]
    fn a_straight_line_goes_on_beyond_its_ends() {
        let path = Path::new(&[[0.0, 1.0], [2.0, 1.0]], &[]).unwrap();
        for x in [-7.0, 0.0, 1.0, 2.0, 9.0] {
            assert_eq!(seen(&path, [x, 3.0]), (2.0, [0.0, 1.0]));
            assert_eq!(seen(&path, [x, 0.5]), (-0.5, [0.0, 1.0]));
            assert_eq!(seen(&path, [x, 1.0]), (0.0, [0.0, 1.0]));
        }
    }

    #[test]
    fn edges_that_meet_at_zero_with_either_sign_are_one_line() {
        let through =
            |zero: f64| Path::through(&[[[-1.0, 0.0], [zero, zero]], [[0.0, 0.0], [1.0, 1.0]]]);
        assert_eq!(through(-0.0), through(0.0));
        assert!(through(0.0).is_ok());
        assert!(matches!(through(1e-300), Err(PathError::NotOne { .. })));
    }

    #[test]
    fn a_rounded_corner_is_the_circle_that_touches_both_sides() {
        // To the right and then up: a corner to the left, around (2, 1). And its mirror image, to the right around (2, -1).
        let rounded =
            |up: f64| Path::new(&[[0.0, 0.0], [3.0, 0.0], [3.0, 5.0 * up]], &[1.0]).unwrap();
        let path = rounded(1.0);
        for (up, angle) in [1.0, -1.0]
            .into_iter()
            .flat_map(|up| [-PI / 2.0, -1.2, -0.4, 0.0].map(|angle: f64| (up, angle)))
        {
            for r in [0.2, 1.0, 1.7] {
                let x = [2.0 + r * angle.cos(), up * (1.0 + r * angle.sin())];
                let (left, growth) = seen(&rounded(up), x);
                assert_abs_diff_eq!(left, up * (1.0 - r), epsilon = ROUNDING);
                let inwards = [-angle.cos(), -up * angle.sin()].map(|c| up * c);
                assert_abs_diff_eq!(&growth[..], &inwards[..], epsilon = ROUNDING);
            }
        }
        assert_eq!(seen(&path, [1.0, 0.3]), (0.3, [0.0, 1.0]));
        assert_eq!(seen(&path, [2.7, 3.0]).1, [-1.0, 0.0]);
        assert_eq!(seen(&path, [2.0, 1.0]).0, 1.0, "the centre");
        // Control: the sharp corner is further away.
        let sharp = Path::new(&[[0.0, 0.0], [3.0, 0.0], [3.0, 5.0]], &[]).unwrap();
        let x = [2.9, 0.1];
        assert!(seen(&path, x).0 < 0.0 && seen(&sharp, x).0 > 0.0);
    }

    #[test]
    fn around_a_sharp_corner_the_distance_is_that_from_the_corner() {
        // Up over a ridge and down again: the body on the left, above it.
        let path = Path::new(&[[-1.0, 0.0], [0.0, 1.0], [1.0, 0.0]], &[]).unwrap();
        assert_eq!(seen(&path, [0.0, 3.0]), (2.0, [0.0, 1.0]));
        let (left, growth) = seen(&path, [0.3, 1.4]);
        assert_abs_diff_eq!(left, 0.5, epsilon = ROUNDING);
        assert_abs_diff_eq!(&growth[..], &[0.6, 0.8][..], epsilon = ROUNDING);
        assert_eq!(seen(&path, [0.0, 1.0]), (0.0, [0.0, 1.0]));
        let (left, _) = seen(&path, [0.0, 0.0]);
        assert_abs_diff_eq!(left, -0.5_f64.sqrt(), epsilon = ROUNDING);
    }

    #[test]
    fn a_closed_line_has_an_inside_and_an_outside() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let path = Path::new(&square, &[0.5]).unwrap();
        assert_eq!(seen(&path, [1.0, 2.0]).0, 1.0);
        assert_eq!(seen(&path, [-1.0, 2.0]), (-1.0, [1.0, 0.0]));
        let corner = 0.5 - 0.5_f64.sqrt();
        assert_abs_diff_eq!(seen(&path, [0.0, 0.0]).0, corner, epsilon = ROUNDING);
        // Radii of half the sides: a circle.
        let path = Path::new(&square, &[2.0]).unwrap();
        for angle in [0.1_f64, 1.5, 2.9, 4.4] {
            let x = [2.0 + 3.0 * angle.cos(), 2.0 + 3.0 * angle.sin()];
            assert_abs_diff_eq!(seen(&path, x).0, -1.0, epsilon = ROUNDING);
        }
    }

    #[test]
    fn edges_between_points_of_a_circle_are_arcs_of_it() {
        // Three quarters of a circle of radius 2 around (1, 0), to the left, in an order of their own.
        let at = |k: usize| {
            let angle = 1.5 * PI * k as f64 / 30.0;
            [1.0 + 2.0 * angle.cos(), 2.0 * angle.sin()]
        };
        let mut edges: Vec<[[f64; 2]; 2]> = (0..30).map(|k| [at(k), at(k + 1)]).collect();
        edges.swap(3, 17);
        edges[5].reverse();
        let path = Path::through(&edges).unwrap();
        for angle in [0.1_f64, 1.7, 3.3, 4.6] {
            for r in [0.7, 2.0, 2.5] {
                let (left, growth) = seen(&path, [1.0 + r * angle.cos(), r * angle.sin()]);
                assert_abs_diff_eq!(left, 2.0 - r, epsilon = 10.0 * ROUNDING);
                let inwards = [-angle.cos(), -angle.sin()];
                assert_abs_diff_eq!(&growth[..], &inwards[..], epsilon = 10.0 * ROUNDING);
            }
        }
        // Control: the polygon is inside by up to h^2 / 8 R.
        let points: Vec<[f64; 2]> = (0..=30).map(at).collect();
        let polygon = Path::new(&points, &[]).unwrap();
        let middle = 1.5 * PI / 60.0;
        let x = [1.0 + 2.0 * middle.cos(), 2.0 * middle.sin()];
        assert!(seen(&polygon, x).0 < -5e-3 && seen(&path, x).0.abs() < 1e-13);
        let error = Path::through(&[edges[0], edges[9]]).unwrap_err().to_string();
        assert!(error.starts_with("the edges are not one line: at ("), "{error}");
    }
}
