//! The smooth boundary behind the facets of a mesh: a normal at each end of each boundary edge, and the cubic curve between
//! them.
//!
//! Facet normals jump at the vertices of a curved boundary, u_n jumps with them, and the jump, divided by gamma, does not
//! tend to 0 with h. So the normal belongs to the vertex:
//!
//! | at a vertex where | the normals of its two edges there are |
//! | --- | --- |
//! | the boundary is straight | those of the facets |
//! | it bends by less than 40 degrees | one: the mean of the facets' normals weighted by the inverse lengths, exact on circles |
//! | likewise, one of the two edges goes on straight | one: that of the straight edge, exact where an arc starts |
//! | two straight sides meet, or it bends by more: a corner | one for each side: the other end's, mirrored on the facet (exact on circles), or the facet's where that side is straight |
//!
//! The curve through the ends a, b with the tangents t there (the normals turned left) is the cubic Hermite curve with
//! derivatives m t, m = 2 |b - a| / (1 + cos(theta/2)), theta being the angle between the normals: its middle lies on the
//! circle if there is one. Only the middle is needed, (a + b)/2 + (m/8) (t_a - t_b), where P2 has a node.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::mesh::{BoundaryEdge, Mesh, NO_ANGLE, length};

/// A bend of more degrees is a corner: a circle of nine edges turns by as much at a vertex, a chamfer by 45.
pub(crate) const SMOOTH: f64 = 40.0;

/// The normals at the ends of all boundary edges.
#[derive(Clone, Debug)]
pub struct SmoothBoundary {
    /// By triangle and local edge; an edge that is not listed has its facet's normal all along.
    normals: BTreeMap<(usize, usize), [Vector2<f64>; 2]>,
}

/// A point of the smooth boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothPoint {
    /// The place.
    pub place: [f64; 2],
    /// The unit outward normal there.
    pub normal: Vector2<f64>,
}

/// A vertex of the outline: the edge before, the edge after, the angle by which the outline turns left, and whether this angle
/// is only the rounding of vertices, as on a straight side after many bisections.
struct Passage {
    before: usize,
    after: usize,
    bend: f64,
    straight: bool,
}

impl SmoothBoundary {
    /// The normals along the whole boundary of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let outline = mesh.outline();
        let ends: Vec<[usize; 2]> = outline.iter().map(|&edge| mesh.ends(edge)).collect();
        let place = |vertex: usize| mesh.vertices()[vertex].into();
        let rounding = |e: usize| mesh.turned_by_rounding([outline[e]]);
        let normals = smooth_normals(&ends, place, rounding);
        let listed = outline
            .iter()
            .zip(normals)
            .filter_map(|(edge, normals)| Some(((edge.triangle, edge.local), normals?)));
        SmoothBoundary { normals: listed.collect() }
    }

    /// The normals at the start and at the end of an edge, if they are not both its facet's.
    pub(crate) fn at_ends(&self, edge: BoundaryEdge) -> Option<[Vector2<f64>; 2]> {
        self.normals.get(&(edge.triangle, edge.local)).copied()
    }

    /// Start, end and middle of the smooth boundary along an edge, if it is not straight there.
    pub fn along(&self, mesh: &Mesh, edge: BoundaryEdge) -> Option<[SmoothPoint; 3]> {
        let normals = self.at_ends(edge)?;
        let ends = mesh.places_of_ends(edge).map(Vector2::from);
        let curve = SmoothEdge { ends, normals, curved: true };
        Some([curve.end(0), curve.end(1), curve.middle()])
    }

    /// The curve along an edge.
    pub(crate) fn edge(&self, mesh: &Mesh, edge: BoundaryEdge) -> SmoothEdge {
        let ends = mesh.places_of_ends(edge).map(Vector2::from);
        match self.at_ends(edge) {
            Some(normals) => SmoothEdge { ends, normals, curved: true },
            None => {
                SmoothEdge { ends, normals: [mesh.length_and_normal(edge).1; 2], curved: false }
            }
        }
    }
}

/// The normals at both ends of each edge of a line, which runs from vertex to vertex, its normals on its right; `None` where
/// both normals are that of the facet. `rounding` is the angle by which rounded vertices may turn an edge.
pub(crate) fn smooth_normals(
    ends: &[[usize; 2]],
    place: impl Fn(usize) -> Vector2<f64>,
    rounding: impl Fn(usize) -> f64,
) -> Vec<Option<[Vector2<f64>; 2]>> {
    let facet = |&[a, b]: &[usize; 2]| {
        let along = place(b) - place(a);
        let length = length(along);
        (length, Vector2::new(along.y, -along.x) / length)
    };
    let facets: Vec<(f64, Vector2<f64>)> = ends.iter().map(facet).collect();
    // How many edges end and start at each vertex, and the last of these: one each, but where parts of the body touch in a point.
    let vertices = ends.as_flattened().iter().max().map_or(0, |last| last + 1);
    let mut around = vec![[(0, 0); 2]; vertices];
    for (e, ends) in ends.iter().enumerate() {
        for (&vertex, k) in ends.iter().zip([1, 0]) {
            let (count, last) = &mut around[vertex][k];
            (*count, *last) = (*count + 1, e);
        }
    }
    let passage = |vertex: usize| -> Option<Passage> {
        let [(1, before), (1, after)] = around[vertex] else { return None };
        let (n, m) = (facets[before].1, facets[after].1);
        let bend = n.perp(&m).atan2(n.dot(&m));
        let is_rounding = |e: usize| bend.abs() <= rounding(e);
        let straight = bend.abs() <= NO_ANGLE || is_rounding(before) || is_rounding(after);
        Some(Passage { before, after, bend, straight })
    };
    let bend_at = |vertex: usize| passage(vertex).map_or(f64::INFINITY, |p| p.bend);
    let straight = |vertex: usize| passage(vertex).is_some_and(|p| p.straight);

    // The normal that both edges share at a vertex, where they share one.
    let shared = |vertex: usize| -> Option<Vector2<f64>> {
        let passage =
            passage(vertex).filter(|p| !p.straight && p.bend.abs() <= SMOOTH.to_radians());
        let Passage { before, after, bend, .. } = passage?;
        let [previous, _] = ends[before];
        let [_, next] = ends[after];
        let (behind, ahead) = (bend_at(previous), bend_at(next));
        let arc_starts = |beyond: f64| beyond * bend > 0.0 && bend.abs() <= beyond.abs();
        let ((a, n), (b, m)) = (facets[before], facets[after]);
        match (straight(previous), straight(next)) {
            (true, true) => None,
            (true, false) => arc_starts(ahead).then_some(n),
            (false, true) => arc_starts(behind).then_some(m),
            (false, false) => Some(unit(n / a + m / b)),
        }
    };
    let shared: Vec<Option<Vector2<f64>>> = (0..vertices).map(shared).collect();

    let both = |(ends, &(_, facet)): (&[usize; 2], &(f64, Vector2<f64>))| {
        let own = ends.map(|vertex| shared[vertex]);
        Some(match own {
            [Some(start), Some(end)] => [start, end],
            [Some(start), None] if straight(ends[1]) => [start, facet],
            [None, Some(end)] if straight(ends[0]) => [facet, end],
            [Some(start), None] => [start, mirrored(start, facet)],
            [None, Some(end)] => [mirrored(end, facet), end],
            [None, None] => return None,
        })
    };
    ends.iter().zip(&facets).map(both).collect()
}

/// The smooth boundary between two of its points: the cubic curve of the head of this file, or a straight line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SmoothEdge {
    /// Start and end, the body on the left.
    pub(crate) ends: [Vector2<f64>; 2],
    /// The outward normals there.
    pub(crate) normals: [Vector2<f64>; 2],
    /// The boundary is not the chord.
    pub(crate) curved: bool,
}

impl SmoothEdge {
    fn end(&self, k: usize) -> SmoothPoint {
        SmoothPoint { place: self.ends[k].into(), normal: self.normals[k] }
    }

    /// |b - a|
    pub(crate) fn length(&self) -> f64 {
        length(self.ends[1] - self.ends[0])
    }

    /// The point of the chord at `s`, from 0 to 1.
    pub(crate) fn on_chord(&self, s: f64) -> Vector2<f64> {
        let [a, b] = self.ends;
        if s < 0.5 { a + (b - a) * s } else { b + (a - b) * (1.0 - s) }
    }

    /// m, the length of the derivative at both ends.
    fn speed(&self) -> f64 {
        let [n, m] = self.normals;
        let half = ((1.0 + n.x * m.x + n.y * m.y) / 2.0).max(0.0).sqrt();
        2.0 * self.length() / (1.0 + half)
    }

    fn middle(&self) -> SmoothPoint {
        let ([a, b], [t, s], speed) = (self.ends, self.normals.map(left_of), self.speed());
        let middle = (a + b) / 2.0 + (t - s) * (speed / 8.0);
        // The derivative of the curve there.
        let tangent = (b - a) * 1.5 - (t + s) * (speed / 4.0);
        SmoothPoint { place: middle.into(), normal: unit(-left_of(tangent)) }
    }

    /// The point of the curve at `s`, from 0 to 1.
    pub(crate) fn at(&self, s: f64) -> (Vector2<f64>, Vector2<f64>) {
        if s <= 0.0 || s >= 1.0 {
            let k = usize::from(s >= 1.0);
            return (self.ends[k], self.normals[k]);
        }
        let chord = self.on_chord(s);
        if !self.curved {
            return (chord, self.normals[0]);
        }
        let ([a, b], [t, u], speed) = (self.ends, self.normals.map(left_of), self.speed());
        let r = 1.0 - s;
        // Off the chord: s r ((r - s) (a - b) + m (r t - s u)).
        let place = chord + ((a - b) * (r - s) + (t * r - u * s) * speed) * (s * r);
        let tangent =
            (b - a) * (6.0 * s * r) + (t * (r * (r - 2.0 * s)) + u * (s * (s - 2.0 * r))) * speed;
        (place, unit(-left_of(tangent)))
    }

    /// The curvature of the circle through both ends with these normals.
    pub(crate) fn curvature(&self) -> f64 {
        let [n, m] = self.normals;
        length(m - n) / self.length()
    }
}

/// v / |v|
pub(crate) fn unit(v: Vector2<f64>) -> Vector2<f64> {
    v / length(v)
}

/// v turned left by a right angle.
pub(crate) fn left_of(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// The normal at the other end of an arc of a circle whose chord has the normal `facet`.
fn mirrored(normal: Vector2<f64>, facet: Vector2<f64>) -> Vector2<f64> {
    unit(facet * (2.0 * normal.dot(&facet)) - normal)
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    /// Some twenty operations on numbers of size 1 to 10, divided by facets of length 0.3 and more.
    const ROUNDING: f64 = 1e-14;

    /// A fan of triangles around the origin with these vertices in counter-clockwise order.
    fn fan(rim: &[[f64; 2]]) -> Mesh {
        let mut vertices = vec![[0.0, 0.0]];
        vertices.extend(rim);
        let triangles = (1..rim.len()).map(|i| [0, i, i + 1]).collect();
        Mesh::new(vertices, triangles, []).unwrap()
    }

    fn on_circle(angles: &[f64]) -> Vec<[f64; 2]> {
        angles.iter().map(|a| [2.0 * a.cos(), 2.0 * a.sin()]).collect()
    }

    #[test]
    fn the_curve_between_points_of_a_circle_lies_on_it_to_the_sixth_power_of_its_angle() {
        let normal = |angle: f64| Vector2::new(angle.cos(), angle.sin());
        let off = |angle: f64| {
            let normals = [normal(0.3), normal(0.3 + angle)];
            let curve = SmoothEdge { ends: normals.map(|n| n * 2.0), normals, curved: true };
            assert_abs_diff_eq!(curve.curvature(), 0.5, epsilon = ROUNDING);
            let SmoothPoint { place, normal } = curve.middle();
            let (at, n) = curve.at(0.5);
            assert_abs_diff_eq!(at, Vector2::from(place), epsilon = ROUNDING);
            assert_abs_diff_eq!(n, normal, epsilon = ROUNDING);
            let off = (1..20).map(|k| curve.at(f64::from(k) / 20.0)).map(|(x, n)| {
                // A normal of the curve is one of the circle, as far as the curve is the circle.
                assert!(length(n - unit(x)) < 2e-3 * angle.powi(5));
                (length(x) - 2.0).abs()
            });
            off.fold(0.0, f64::max)
        };
        let (coarse, fine) = (off(0.4), off(0.2));
        assert!(coarse < 1e-6 && (55.0..70.0).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
    }

    #[test]
    fn straight_sides_keep_the_normals_of_their_facets_and_so_do_shallow_corners_between_them() {
        // The side from (4, -1) to (4, 1) and on to (3.5, 3): a bend of 14 degrees.
        let rim = [[4.0, -1.0], [4.0, 0.0], [4.0, 1.0], [3.75, 2.0], [3.5, 3.0]];
        let mesh = fan(&rim);
        let smooth = SmoothBoundary::new(&mesh);
        assert!(mesh.outline().iter().all(|&e| smooth.at_ends(e).is_none()));
    }

    /// A triangle whose oblique side ends at `corner`, bisected there again and again.
    fn bisected(times: usize) -> Mesh {
        let corners = vec![[0.1, 0.2], [3.3, 0.7], [1.7, 2.9]];
        let mut mesh = Mesh::new(corners, vec![[0, 1, 2]], []).unwrap();
        let mut newest = mesh.opposite_longest();
        for _ in 0..times {
            let place = |t: usize| mesh.triangles()[t].contains(&1);
            let marked: Vec<usize> = (0..mesh.triangles().len()).filter(|&t| place(t)).collect();
            mesh = mesh.bisected(&newest, &marked).unwrap().mesh;
            newest = vec![0; mesh.triangles().len()];
        }
        mesh
    }

    #[test]
    fn a_straight_side_is_straight_after_many_bisections() {
        let mesh = bisected(30);
        let smooth = SmoothBoundary::new(&mesh);
        assert!(mesh.outline().iter().all(|&e| smooth.at_ends(e).is_none()));
        // Control: the normals of its edges differ by more than the tolerance for coarse meshes.
        let normals = mesh.outline().iter().map(|&edge| mesh.length_and_normal(edge).1);
        let sides: Vec<Vector2<f64>> = normals.collect();
        let differ = |n: &Vector2<f64>| {
            sides.iter().map(|m| n.perp(m).abs()).any(|sine| NO_ANGLE < sine && sine < 1e-3)
        };
        assert!(sides.iter().any(differ));
    }

    #[test]
    fn where_a_straight_side_goes_over_into_an_arc_its_normal_is_that_of_the_side() {
        // x = 2 up to y = 0, then the circle of radius 2 around the origin.
        let mut rim = vec![[2.0, -1.0], [2.0, -0.5]];
        rim.extend(on_circle(&[0.0, 0.2, 0.4, 0.6]));
        let mesh = fan(&rim);
        let smooth = SmoothBoundary::new(&mesh);
        let of = |start: usize| {
            let edge = mesh.outline().iter().find(|&&e| mesh.ends(e) == [start, start + 1]);
            smooth.at_ends(*edge.unwrap())
        };
        assert_eq!(of(1), None);
        let [start, end] = of(2).unwrap();
        assert!(start == Vector2::x() && end == Vector2::x(), "{start:?} {end:?}");
        let [start, end] = of(3).unwrap();
        assert_eq!(start, Vector2::x());
        let expected = Vector2::new(0.2_f64.cos(), 0.2_f64.sin());
        assert_abs_diff_eq!(end, expected, epsilon = ROUNDING);
    }
}
