//! Partners on two boundaries, and the stretches between neighbouring ones.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::model::boundary_normals::{SmoothBoundary, SmoothEdge, unit};
use crate::model::mesh::{BoundaryEdge, Mesh, MeshError, NO_ANGLE, length};
use crate::model::tree::{Bounds, Tree};

/// A place on an edge of a boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The number of the edge in the boundary.
    pub(crate) edge: usize,
    /// Where on the curve along it, from 0 at its start to 1 at its end.
    pub(crate) s: f64,
}

/// A point of a boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(crate) place: Vector2<f64>,
    pub(crate) normal: Vector2<f64>,
    /// Where it lies: on two edges where a smooth boundary goes on from one to the next.
    at: [Option<Place>; 2],
}

impl Point {
    fn at(&self) -> impl Iterator<Item = Place> + use<> {
        self.at.into_iter().flatten()
    }

    fn on(&self, edge: usize) -> Option<f64> {
        self.at().find(|place| place.edge == edge).map(|place| place.s)
    }
}

/// Two points that face each other, of boundary 1 and of boundary 2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    pub(crate) points: [Vector2<f64>; 2],
    /// d
    pub(crate) direction: Vector2<f64>,
    at: [[Option<Place>; 2]; 2],
}

impl Facing {
    fn new([first, second]: [Point; 2]) -> Self {
        Facing {
            points: [first.place, second.place],
            direction: unit(first.normal - second.normal),
            at: [first.at, second.at],
        }
    }

    /// The points of two curves on the line through `from` along `direction`.
    pub(crate) fn along(
        from: Vector2<f64>,
        direction: Vector2<f64>,
        curves: &[SmoothEdge; 2],
    ) -> Self {
        let on = |curve: &SmoothEdge| {
            let off = |s: f64| (curve.at(s).0 - from).perp(&direction);
            // Boundary 1 crosses the line from the right to the left, boundary 2 the other way.
            let sign = if off(0.0) <= off(1.0) { 1.0 } else { -1.0 };
            curve.at(rising_zero(|s| sign * off(s), 0.0)
                .unwrap_or_else(|| if off(0.0).abs() <= off(1.0).abs() { 0.0 } else { 1.0 }))
        };
        Facing { points: [on(&curves[0]).0, on(&curves[1]).0], direction, at: [[None; 2]; 2] }
    }

    /// Where the point of boundary `i`, on the edge `e` of it, comes to lie on the chord of that edge.
    pub(crate) fn on_chord(&self, i: usize, e: usize, curve: &SmoothEdge) -> f64 {
        let s = self.at[i].iter().flatten().find(|place| place.edge == e).map(|place| place.s);
        match s {
            // The place of a node is exact.
            Some(s) if s <= 0.0 || s >= 1.0 => s.clamp(0.0, 1.0),
            // The line goes through the node of the other boundary or, without a node there, through the partners.
            _ => cut(self.node(), self.direction, curve).clamp(0.0, 1.0),
        }
    }

    /// The point of the two that is a node of its boundary, or the first.
    fn node(&self) -> Vector2<f64> {
        let is_node = |i: usize| self.at[i].iter().flatten().any(|p| p.s <= 0.0 || p.s >= 1.0);
        self.points[usize::from(!is_node(0) && is_node(1))]
    }
}

/// The place where the line through `from` along `direction` meets the chord of an edge, from 0 at its start to 1 at its end.
pub(super) fn cut(from: Vector2<f64>, direction: Vector2<f64>, curve: &SmoothEdge) -> f64 {
    let [a, b] = curve.ends;
    (from - a).perp(&direction) / (b - a).perp(&direction)
}

/// A boundary of a pair.
pub(crate) struct Boundary {
    pub(crate) edges: Vec<BoundaryEdge>,
    pub(crate) curves: Vec<SmoothEdge>,
    /// The vertices at start and end of each edge.
    ends: Vec<[usize; 2]>,
    /// The nodes, one for each side of a corner.
    nodes: Vec<Point>,
    /// The nodes at start and end of each edge.
    nodes_of: Vec<[usize; 2]>,
    /// By how much normals may be off by rounding.
    turned: Vec<f64>,
    tree: Tree,
}

/// The least cosine of the angle between a normal and the opposite of its partner's: the head of `pairs`.
const OPPOSITE: f64 = 0.5;

/// The relative difference below which two distances are equal: far above rounding, far below what can be seen.
const EQUAL: f64 = 1e-9;

impl Boundary {
    pub(crate) fn new(mesh: &Mesh, smooth: &SmoothBoundary, name: &str) -> Result<Self, MeshError> {
        let edges = mesh.edges_of(name)?.to_vec();
        let curves: Vec<SmoothEdge> = edges.iter().map(|&e| smooth.edge(mesh, e)).collect();
        let ends: Vec<[usize; 2]> = edges.iter().map(|&e| mesh.ends(e)).collect();
        let start_at: BTreeMap<usize, usize> =
            ends.iter().enumerate().map(|(e, ends)| (ends[0], e)).collect();
        let mut nodes = Vec::new();
        let mut nodes_of = vec![[usize::MAX; 2]; edges.len()];
        for (e, curve) in curves.iter().enumerate() {
            let end = Place { edge: e, s: 1.0 };
            let next = start_at.get(&ends[e][1]).copied();
            let goes_on =
                next.filter(|&f| length(curves[f].normals[0] - curve.normals[1]) <= NO_ANGLE);
            nodes_of[e][1] = nodes.len();
            if let Some(f) = goes_on {
                nodes_of[f][0] = nodes.len();
            }
            let start = goes_on.map(|edge| Place { edge, s: 0.0 });
            let (place, normal) = (curve.ends[1], curve.normals[1]);
            nodes.push(Point { place, normal, at: [Some(end), start] });
        }
        for (e, curve) in curves.iter().enumerate() {
            if nodes_of[e][0] == usize::MAX {
                nodes_of[e][0] = nodes.len();
                let at = [Some(Place { edge: e, s: 0.0 }), None];
                nodes.push(Point { place: curve.ends[0], normal: curve.normals[0], at });
            }
        }
        // A curve leaves its chord by less than a quarter of it.
        let around = |curve: &SmoothEdge| {
            Bounds::around(curve.ends.map(Into::into)).widened(curve.length() / 4.0)
        };
        let tree = Tree::new(curves.iter().map(around).collect());
        let turned = edges.iter().map(|&e| mesh.turned_by_rounding([e])).collect();
        Ok(Boundary { edges, curves, ends, nodes, nodes_of, turned, tree })
    }

    /// The share of edge `e` by which rounding may misplace a partner at this distance.
    pub(crate) fn rounding(&self, e: usize, distance: f64) -> f64 {
        self.turned[e] * (1.0 + distance / self.curves[e].length())
    }

    /// The point of edge `e` at `s`; at an end, the node there.
    fn point(&self, e: usize, s: f64) -> Point {
        if s <= 0.0 || s >= 1.0 {
            return self.nodes[self.nodes_of[e][usize::from(s >= 1.0)]];
        }
        let (place, normal) = self.curves[e].at(s);
        Point { place, normal, at: [Some(Place { edge: e, s }), None] }
    }

    /// The nearest partner of a point of the other boundary.
    fn partner(&self, of: &Point, reach: f64) -> Option<Point> {
        let on = |e: usize| {
            let point = self.partner_on(e, of)?;
            Some((length(point.place - of.place), point))
        };
        self.nearest(of.place, reach, on).map(|(_, point)| point)
    }

    /// The nearest of what the edges have for a place, each by its distance, of which there is `most`; of several equally near
    /// ones that of the first edge.
    fn nearest<T>(
        &self,
        from: Vector2<f64>,
        most: f64,
        on: impl Fn(usize) -> Option<(f64, T)>,
    ) -> Option<(f64, T)> {
        let mut radius = self.curves.first()?.length().min(most);
        loop {
            let edges = self.tree.meeting(Bounds::around([from.into()]).widened(radius));
            let near = edges.into_iter().filter_map(&on).filter(|(distance, _)| *distance <= most);
            let best = near.min_by(|a, b| a.0.total_cmp(&b.0));
            if radius >= most || best.as_ref().is_some_and(|(distance, _)| *distance <= radius) {
                return best;
            }
            radius = (2.0 * radius).min(most);
        }
    }

    /// The partner on edge `e`.
    fn partner_on(&self, e: usize, of: &Point) -> Option<Point> {
        let curve = &self.curves[e];
        let off = |s: f64| {
            let (place, normal) = curve.at(s);
            (place - of.place).perp(&(of.normal - normal))
        };
        let none = self.rounding(e, length(curve.ends[0] - of.place));
        let s = rising_zero(off, none)?;
        let s = if s <= none {
            0.0
        } else if s >= 1.0 - none {
            1.0
        } else {
            s
        };
        let point = self.point(e, s);
        (of.normal.dot(&point.normal) <= -OPPOSITE).then_some(point)
    }

    /// The least distance of a place from the chords, and where.
    pub(crate) fn closest(&self, from: Vector2<f64>, most: f64) -> Option<(f64, Vector2<f64>)> {
        self.nearest(from, most, |e| {
            let [a, b] = self.curves[e].ends;
            let chord = b - a;
            let s = ((from - a).dot(&chord) / chord.dot(&chord)).clamp(0.0, 1.0);
            let place = self.curves[e].on_chord(s);
            Some((length(place - from), place))
        })
    }
}

/// A zero in [0, 1] of a function that rises there from below or at 0 to above or at 0, to the last bit; also one that is outside by
/// less than `none`. `None` if there is none.
fn rising_zero(f: impl Fn(f64) -> f64, none: f64) -> Option<f64> {
    let (mut low, mut high) = ((0.0, f(0.0)), (1.0, f(1.0)));
    let rise = high.1 - low.1;
    if !(rise > 0.0) {
        return None;
    }
    if low.1 >= 0.0 {
        return (low.1 <= none * rise).then_some(0.0);
    }
    if high.1 <= 0.0 {
        return (-high.1 <= none * rise).then_some(1.0);
    }
    // The secant, and every third time the middle: the former is fast, the latter halves whatever f does.
    for step in 0.. {
        let middle = f64::midpoint(low.0, high.0);
        if !(low.0 < middle && middle < high.0) {
            break;
        }
        let secant = low.0 - low.1 * ((high.0 - low.0) / (high.1 - low.1));
        let is_inside = low.0 < secant && secant < high.0;
        let s = if step % 3 == 2 || !is_inside { middle } else { secant };
        let value = f(s);
        if value == 0.0 {
            return Some(s);
        }
        if value < 0.0 {
            low = (s, value);
        } else {
            high = (s, value);
        }
    }
    Some(if -low.1 <= high.1 { low.0 } else { high.0 })
}

/// The nearest partner of a point of boundary `of`, if the point is as near to it as any other.
fn mutual(sides: &[Boundary; 2], of: usize, point: &Point, reach: f64) -> Option<[Point; 2]> {
    let [own, other] = [&sides[of], &sides[1 - of]];
    let partner = other.partner(point, reach)?;
    let back = own.partner(&partner, reach)?;
    let [there, here] = [point, &back].map(|point| length(point.place - partner.place));
    let edge = point.at().next()?.edge;
    let rounding = own.rounding(edge, there) * own.curves[edge].length();
    (there <= here + rounding).then_some(if of == 0 {
        [*point, partner]
    } else {
        [partner, *point]
    })
}

/// A stretch of two boundaries between neighbouring partners that are on one edge of each.
pub(super) struct Stretch {
    /// The edges.
    pub(crate) on: [usize; 2],
    /// Its ends, along boundary 1.
    pub(crate) ends: [Facing; 2],
}

/// All stretches, along the edges of boundary 1.
pub(super) fn stretches(sides: &[Boundary; 2], reach: f64) -> Vec<Stretch> {
    let mut breaks: Vec<Vec<(f64, [Point; 2])>> = vec![Vec::new(); sides[0].edges.len()];
    for of in [0, 1] {
        for node in &sides[of].nodes {
            let Some(points) = mutual(sides, of, node, reach) else { continue };
            points[0].at().for_each(|place| breaks[place.edge].push((place.s, points)));
        }
    }
    let mut stretches = Vec::new();
    for (e, mut breaks) in breaks.into_iter().enumerate() {
        // Along boundary 2 places fall where those along boundary 1 rise; on the same edge, where both are told apart by rounding.
        breaks.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let mut previous: Option<(f64, [Point; 2])> = None;
        for &(s, points) in &breaks {
            match previous {
                None => stretches.extend(towards(sides, reach, e, (s, points), 0.0)),
                Some((r, before)) => {
                    let common = before[1].at().find_map(|from| {
                        points[1].on(from.edge).filter(|to| *to <= from.s).map(|_| from.edge)
                    });
                    match common {
                        Some(f) => stretches
                            .push(Stretch { on: [e, f], ends: [before, points].map(Facing::new) }),
                        None => {
                            stretches.extend(towards(sides, reach, e, (r, before), s));
                            stretches.extend(towards(sides, reach, e, (s, points), r));
                        }
                    }
                }
            }
            previous = Some((s, points));
        }
        if let Some(last) = previous {
            stretches.extend(towards(sides, reach, e, last, 1.0));
        }
    }
    stretches
}

/// The stretch on edge `e` from a break towards `end`, as far as the partner stays on its edge: it ends where another one becomes
/// the nearest. `None` if that happens at once.
fn towards(
    sides: &[Boundary; 2],
    reach: f64,
    e: usize,
    (start, points): (f64, [Point; 2]),
    end: f64,
) -> Option<Stretch> {
    let none = sides[0].rounding(e, length(points[1].place - points[0].place));
    if (end - start).abs() <= none {
        return None;
    }
    let partner = |s: f64| mutual(sides, 0, &sides[0].point(e, s), reach);
    // Slightly beyond the break, to see which edge of the other boundary continues the stretch.
    let hair = start + (end - start) * (4.0 * none / (end - start).abs()).min(0.5);
    let f = partner(hair)?[1].at().find(|place| points[1].on(place.edge).is_some())?.edge;
    let on_it = |s: f64| partner(s).filter(|points| points[1].on(f).is_some());
    let (mut near, mut far) = (hair, end);
    let mut last = on_it(hair)?;
    loop {
        let middle = f64::midpoint(near, far);
        if middle == near || middle == far || (far - near).abs() <= none {
            break;
        }
        match on_it(middle) {
            Some(points) => (near, last) = (middle, points),
            None => far = middle,
        }
    }
    let ends = if start < end { [points, last] } else { [last, points] };
    Some(Stretch { on: [e, f], ends: ends.map(Facing::new) })
}

/// The place of a vertex that both boundaries have: there the bodies are joined. The tip of a slit or of a notch is none: a vertex in
/// which one boundary ends and the other starts, the outline turning right.
pub(super) fn shared(sides: &[Boundary; 2]) -> Option<Vector2<f64>> {
    let [first, second] = [0, 1].map(|i| {
        let mut at: BTreeMap<usize, [Option<usize>; 2]> = BTreeMap::new();
        for (e, &[start, end]) in sides[i].ends.iter().enumerate() {
            at.entry(start).or_default()[0] = Some(e);
            at.entry(end).or_default()[1] = Some(e);
        }
        at
    });
    let is_tip = |before: Vector2<f64>, after: Vector2<f64>| {
        let (sine, cosine) = (before.perp(&after), before.dot(&after));
        sine < -NO_ANGLE || (sine <= NO_ANGLE && cosine < 0.0)
    };
    let normal = |i: usize, e: usize, k: usize| sides[i].curves[e].normals[k];
    let is_joined = |ours: [Option<usize>; 2], theirs: [Option<usize>; 2]| match (ours, theirs) {
        ([None, Some(e)], [Some(f), None]) => !is_tip(normal(0, e, 1), normal(1, f, 0)),
        ([Some(e), None], [None, Some(f)]) => !is_tip(normal(1, f, 1), normal(0, e, 0)),
        _ => true,
    };
    let both = first.iter().filter_map(|(vertex, ours)| Some((*ours, *second.get(vertex)?)));
    let (ours, _) = both.into_iter().find(|(ours, theirs)| is_joined(*ours, *theirs))?;
    let start = ours[0].map(|e| sides[0].curves[e].ends[0]);
    start.or(ours[1].map(|e| sides[0].curves[e].ends[1]))
}

/// Two corners within `reach` of each other that face each other, while neither faces a side of the other boundary.
pub(super) fn corner_on_corner(sides: &[Boundary; 2], reach: f64) -> Option<[Vector2<f64>; 2]> {
    let alone = |of: usize| {
        let (own, other) = (&sides[of], &sides[1 - of]);
        let corners = own.nodes.iter().filter(|node| node.at().count() == 1);
        let mut faces: Vec<(Vector2<f64>, bool, Vector2<f64>)> = Vec::new();
        for node in corners {
            let faced = other.partner(node, reach).is_some();
            match faces.iter_mut().find(|(place, ..)| *place == node.place) {
                Some((_, any, normal)) => {
                    *any |= faced;
                    *normal += node.normal;
                }
                None => faces.push((node.place, faced, node.normal)),
            }
        }
        faces.retain(|(_, faced, _)| !faced);
        faces
    };
    let (first, second) = (alone(0), alone(1));
    for (x, _, n) in first {
        for (y, _, m) in &second {
            let (away, distance) = (*y - x, length(*y - x));
            if distance > reach || away.dot(&n) < 0.0 || away.dot(m) > 0.0 || n.dot(m) >= 0.0 {
                continue;
            }
            let is_nearest = |side: &Boundary, from| {
                let near = side.closest(from, reach);
                near.is_some_and(|(least, _)| distance <= least * (1.0 + EQUAL))
            };
            if is_nearest(&sides[1], x) && is_nearest(&sides[0], *y) {
                return Some([x, *y]);
            }
        }
    }
    None
}

/// Where two boundaries come closest, one of the places being a node, and their distance.
pub(super) fn nearest(sides: &[Boundary; 2]) -> ([Vector2<f64>; 2], f64) {
    let mut best = ([Vector2::zeros(); 2], f64::INFINITY);
    for of in [0, 1] {
        for node in &sides[of].nodes {
            if let Some((distance, place)) = sides[1 - of].closest(node.place, best.1)
                && distance < best.1
            {
                let places = [node.place, place];
                best = (if of == 0 { places } else { [places[1], places[0]] }, distance);
            }
        }
    }
    best
}
