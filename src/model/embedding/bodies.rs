//! Bodies that are pairs: their boundaries may touch, and they may overlap where they press on each other. Each body is checked by
//! itself; where two come near, a place is exempt if it is within the reach of both boundaries of a pair of these bodies.
//!
//! The two boundaries of a pair on one body, as the faces of a slit, are taken for one curve where their vertices coincide; where
//! they don't, they are no nearer to each other than any others.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;

use super::{check, check_joints, closest, crossing};
use crate::model::boundary_normals::SmoothBoundary;
use crate::model::groups::groups;
use crate::model::mesh::{Mesh, MeshError, TOUCHING, length};
use crate::model::pairs::Pair;
use crate::model::pairs::search::Boundary;
use crate::model::plane_sweep::{cross, turn};
use crate::model::tree::{Bounds, Tree};

/// The vertices that may be in one place.
pub(super) struct Linked {
    /// The body of each vertex.
    body: Vec<usize>,
    /// The vertices and the bodies of the two boundaries of each pair.
    pairs: Vec<[(BTreeSet<usize>, BTreeSet<usize>); 2]>,
}

impl Linked {
    /// `named` has the edges of each boundary.
    pub(crate) fn new(
        count: usize,
        triangles: &[[usize; 3]],
        named: &[(String, Vec<[usize; 2]>)],
        pairs: &[Pair],
    ) -> Self {
        // A vertex that is not there is an error of its own.
        let joined = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [a, c]]);
        let body = groups(count, joined.filter(|pair| pair.iter().all(|&v| v < count)));
        let of = |name: &String| {
            let edges = named.iter().filter(|(of, _)| of == name).flat_map(|(_, edges)| edges);
            let vertices: BTreeSet<usize> =
                edges.flatten().copied().filter(|&v| v < count).collect();
            let bodies = vertices.iter().map(|&v| body[v]).collect();
            (vertices, bodies)
        };
        let pairs = pairs.iter().map(|pair| pair.boundaries.each_ref().map(of)).collect();
        Linked { body, pairs }
    }

    /// They are on the two boundaries of a pair, or in two bodies that are one.
    pub(crate) fn may_meet(&self, a: usize, b: usize) -> bool {
        let [p, q] = [a, b].map(|vertex| self.body[vertex]);
        self.pairs.iter().any(|[first, second]| {
            [(first, second), (second, first)].into_iter().any(|(first, second)| {
                let on_both = first.0.contains(&a) && second.0.contains(&b);
                on_both || (p != q && first.1.contains(&p) && second.1.contains(&q))
            })
        })
    }
}

/// A pair as a region in which its bodies may touch and overlap.
struct Zone<'p> {
    pair: &'p Pair,
    reach: f64,
    sides: [Boundary; 2],
    /// The parts of the body that each boundary belongs to.
    parts: [BTreeSet<usize>; 2],
}

impl<'p> Zone<'p> {
    /// `None` for a pair that is refused as such, when the problem is posed.
    fn new(mesh: &Mesh, smooth: &SmoothBoundary, parts: &[usize], pair: &'p Pair) -> Option<Self> {
        let reach = pair.reach_on(mesh, smooth).ok()?;
        let [first, second] = &pair.boundaries;
        let side = |name: &str| Boundary::new(mesh, smooth, name).ok();
        let sides = [side(first)?, side(second)?];
        let parts_of = |side: &Boundary| side.edges.iter().map(|e| parts[e.triangle]).collect();
        Some(Zone { pair, reach, parts: sides.each_ref().map(parts_of), sides })
    }

    fn links(&self, [p, q]: [usize; 2]) -> bool {
        let [first, second] = &self.parts;
        (first.contains(&p) && second.contains(&q)) || (first.contains(&q) && second.contains(&p))
    }

    fn contains(&self, place: Vector2<f64>) -> bool {
        self.sides.iter().all(|side| side.closest(place, self.reach).is_some())
    }
}

/// Checks each part of the body by itself, and that parts come near each other only where they may.
///
/// # Errors
/// As [`Mesh::new`](Mesh::new), and [`MeshError::Bodies`].
pub(super) fn check_pairs(mesh: &Mesh, pairs: &[Pair]) -> Result<(), MeshError> {
    let parts = mesh.parts();
    let smooth = SmoothBoundary::new(mesh);
    let zones: Vec<Zone> =
        pairs.iter().filter_map(|pair| Zone::new(mesh, &smooth, parts, pair)).collect();
    let closed = closed_slits(mesh, &zones);
    for part in 0..parts.iter().max().map_or(0, |last| last + 1) {
        check_part(mesh, parts, part, &closed)?;
    }
    check_joints(mesh)?;
    check_between(mesh, parts, &zones)
}

/// For each vertex on the second face of a slit, the vertex of the first face in the same place.
fn closed_slits(mesh: &Mesh, zones: &[Zone]) -> BTreeMap<usize, usize> {
    let mut closed = BTreeMap::new();
    let key = |v: usize| mesh.vertices()[v].map(|c| (c + 0.0).to_bits());
    for zone in zones.iter().filter(|zone| !zone.parts[0].is_disjoint(&zone.parts[1])) {
        let [first, second] = zone.sides.each_ref().map(|side| {
            let vertices = side.edges.iter().flat_map(|&edge| mesh.ends(edge));
            vertices.map(|v| (key(v), v)).collect::<BTreeMap<[u64; 2], usize>>()
        });
        let same = second.iter().filter_map(|(place, v)| Some((*v, *first.get(place)?)));
        closed.extend(same.filter(|(v, w)| v != w));
    }
    closed
}

/// Checks one part of the body, its slits closed.
fn check_part(
    mesh: &Mesh,
    parts: &[usize],
    part: usize,
    closed: &BTreeMap<usize, usize>,
) -> Result<(), MeshError> {
    let own: Vec<usize> = (0..parts.len()).filter(|&t| parts[t] == part).collect();
    let mut old_vertex = Vec::new();
    let mut number = BTreeMap::new();
    let triangles = own.iter().map(|&t| {
        mesh.triangles()[t].map(|v| {
            let v = closed.get(&v).copied().unwrap_or(v);
            *number.entry(v).or_insert_with(|| {
                old_vertex.push(v);
                old_vertex.len() - 1
            })
        })
    });
    let triangles: Vec<[usize; 3]> = triangles.collect();
    let vertices = old_vertex.iter().map(|&v| mesh.vertices()[v]).collect();
    let alone = Mesh::of_edges(vertices, triangles, vec![], &|_, _| false);
    let checked = alone.and_then(|alone| check(&alone));
    checked.map_err(|error| error.renumbered(|v| old_vertex[v], |t| own[t]))
}

/// Looks at the outline where two parts come near.
fn check_between(mesh: &Mesh, parts: &[usize], zones: &[Zone]) -> Result<(), MeshError> {
    let refused = |place: Vector2<f64>, triangles: [usize; 2], overlap: bool| {
        let between = triangles.map(|t| parts[t]);
        let mut linking = zones.iter().filter(|zone| zone.links(between));
        if linking.clone().any(|zone| zone.contains(place)) {
            return Ok(());
        }
        let pair = linking.next().map(|zone| (zone.pair.boundaries.clone(), zone.reach));
        let [x, y] = place.into();
        Err(MeshError::Bodies { triangles, x, y, overlap, pair })
    };
    let outline = mesh.outline();
    let places: Vec<[Vector2<f64>; 2]> =
        outline.iter().map(|&edge| mesh.places_of_ends(edge).map(Vector2::from)).collect();
    let around = |places: &[Vector2<f64>; 2]| Bounds::around(places.map(Into::into));
    let edges = Tree::new(places.iter().map(around).collect());
    for (e, ends) in places.iter().enumerate() {
        let own = length(ends[1] - ends[0]);
        let is_other = |f: &usize| parts[outline[*f].triangle] != parts[outline[e].triangle];
        let near = edges.meeting(around(ends).widened(TOUCHING * own)).into_iter();
        for f in near.filter(|f| *f > e && is_other(f)) {
            let triangles = [e, f].map(|e| outline[e].triangle);
            if cross(*ends, places[f]) {
                refused(crossing(*ends, places[f]).into(), triangles, true)?;
                continue;
            }
            let touching = TOUCHING * own.min(length(places[f][1] - places[f][0]));
            let (place, distance) = nearest(*ends, places[f]);
            if distance <= touching {
                refused(place, triangles, false)?;
            }
        }
    }
    // An outline that crosses none is inside another body as a whole.
    let corners = |t: usize| mesh.triangles()[t].map(|v| Vector2::from(mesh.vertices()[v]));
    let boxes = (0..parts.len()).map(|t| Bounds::around(corners(t).map(Into::into)));
    let inside = Tree::new(boxes.collect());
    for (edge, [a, b]) in outline.iter().zip(&places) {
        let middle = a / 2.0 + b / 2.0;
        let near = inside.meeting(Bounds::around([middle.into()])).into_iter();
        for t in near.filter(|&t| parts[t] != parts[edge.triangle]) {
            let corners = corners(t);
            if (0..3).all(|i| turn(corners[i], corners[(i + 1) % 3], middle) >= 0.0) {
                refused(middle, [edge.triangle, t], true)?;
            }
        }
    }
    Ok(())
}

/// The place where one of two segments that do not cross comes closest to the other, and their distance.
fn nearest(first: [Vector2<f64>; 2], second: [Vector2<f64>; 2]) -> (Vector2<f64>, f64) {
    let mut best = (first[0], f64::INFINITY);
    for (ends, edge) in [(first, second), (second, first)] {
        for x in ends {
            let distance = length(closest(edge, x) - x);
            if distance < best.1 {
                best = (x, distance);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Diagonal, Rectangle};

    /// Blocks of 4 x 4 cells side by side in one mesh, with the boundaries NAME.bottom and NAME.top.
    fn blocks(blocks: &[(&str, [f64; 2], [f64; 2])], pairs: &[Pair]) -> Result<Mesh, MeshError> {
        let cells = Rectangle { width: 1.0, height: 1.0, nx: 4, ny: 4, diagonal: Diagonal::Right };
        let unit = cells.mesh().unwrap();
        let (mut vertices, mut triangles, mut named) = (Vec::new(), Vec::new(), Vec::new());
        for (name, low, high) in blocks {
            let first = vertices.len();
            let place = |x: &[f64; 2]| [0, 1].map(|c| low[c] + (high[c] - low[c]) * x[c]);
            vertices.extend(unit.vertices().iter().map(place));
            triangles.extend(unit.triangles().iter().map(|t| t.map(|v| v + first)));
            for side in ["bottom", "top"] {
                let ends = |&e| unit.ends(e).map(|v| v + first);
                let edges = unit.edges_of(side).unwrap().iter().map(ends).collect();
                named.push((format!("{name}.{side}"), edges));
            }
        }
        Mesh::with_pairs(vertices, triangles, named, pairs)
    }

    const LOWER: (&str, [f64; 2], [f64; 2]) = ("lower", [0.0, 0.0], [1.0, 1.0]);

    fn pair() -> Pair {
        Pair::new("lower.top", "upper.bottom")
    }

    #[test]
    fn bodies_of_a_pair_may_touch_and_overlap_within_its_reach_and_others_may_not() {
        // Touching in whole edges and in parts of edges, apart by a little, and overlapping, one as wide as the other and not.
        for (low, high) in [
            ([0.0, 1.0], [1.0, 2.0]),
            ([0.25, 1.0], [0.75, 2.0]),
            ([0.1, 1.0], [0.8, 2.0]),
            ([0.1, 1.0 + 1e-9], [0.8, 2.0]),
            ([0.0, 0.99], [1.0, 2.0]),
            ([0.1, 0.99], [0.8, 2.0]),
            ([0.0, 0.75], [1.0, 2.0]),
        ] {
            let two = [LOWER, ("upper", low, high)];
            let mesh = blocks(&two, &[pair().with_reach(0.3)]);
            assert!(mesh.is_ok(), "{low:?}: {mesh:?}");
            let turned = Pair::new("upper.bottom", "lower.top").with_reach(0.3);
            assert!(blocks(&two, &[turned]).is_ok());
            assert!(blocks(&two, &[]).is_err(), "{low:?}");
            let other = Pair::new("lower.bottom", "upper.top").with_reach(0.3);
            assert!(blocks(&two, &[other]).is_err(), "{low:?}");
        }
    }

    #[test]
    fn an_overlap_beyond_the_reach_is_refused_with_its_place() {
        let two = [LOWER, ("upper", [0.1, 0.6], [0.8, 2.0])];
        assert_eq!(
            blocks(&two, &[pair().with_reach(0.3)]).unwrap_err().to_string(),
            "two bodies overlap at (0.1, 1), which belongs to triangles 25 and 41, beyond the reach of 0.3 of the pair of 'lower.top' and 'upper.bottom': expected bodies that are apart there, or a larger reach"
        );
        assert!(blocks(&two, &[pair().with_reach(0.5)]).is_ok());
        // A third body, which is in no pair.
        let upper = ("upper", [0.1, 1.0], [0.8, 2.0]);
        for (third, what) in [
            (("third", [0.41, 0.41], [0.6, 0.6]), "two bodies overlap at "),
            (("third", [0.8, 1.05], [1.8, 2.03]), "two bodies touch at "),
        ] {
            let error = blocks(&[LOWER, upper, third], &[pair()]).unwrap_err().to_string();
            assert!(error.starts_with(what), "{error}");
            let remedy = "a [[pair]] of the boundaries that touch each other";
            assert!(error.ends_with(remedy), "{error}");
        }
    }

    #[test]
    fn each_body_of_a_pair_is_checked_by_itself() {
        // The upper body, with one of its triangles a second time on vertices of its own.
        let upper = ("upper", [0.1, 1.1], [0.8, 2.0]);
        let mesh = blocks(&[LOWER, upper], &[pair()]).unwrap();
        let mut vertices = mesh.vertices().to_vec();
        let mut triangles = mesh.triangles().to_vec();
        let edges = |name: &str| {
            let ends = mesh.edges_of(name).unwrap().iter().map(|&e| mesh.ends(e)).collect();
            (name.to_owned(), ends)
        };
        let named = || [edges("lower.top"), edges("upper.bottom")];
        let moved = triangles.len() - 1;
        let first = vertices.len();
        let corners = triangles[moved].map(|v| vertices[v]);
        vertices.extend(corners.map(|[x, y]| [x + 1e-3, y]));
        triangles.push([first, first + 1, first + 2]);
        let error = Mesh::with_pairs(vertices.clone(), triangles, named(), &[pair()]).unwrap_err();
        assert!(error.to_string().starts_with("two bodies "), "{error}");
        // Its last triangle moved onto another one.
        let mut triangles = mesh.triangles().to_vec();
        triangles[moved] = [first, first + 1, first + 2];
        let error = Mesh::with_pairs(vertices, triangles, named(), &[pair()]).unwrap_err();
        assert!(matches!(error, MeshError::Bodies { .. } | MeshError::Unused { .. }), "{error}");
    }

    #[test]
    fn the_faces_of_a_slit_may_touch_if_they_are_a_pair() {
        // Two columns of two cells, joined below and torn above.
        let vertices = vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [0.0, 1.0],
            [1.0, 1.0],
            [2.0, 1.0],
            [0.0, 2.0],
            [1.0, 2.0],
            [1.0, 2.0],
            [2.0, 2.0],
        ];
        let triangles = vec![
            [0, 1, 4],
            [0, 4, 3],
            [1, 2, 5],
            [1, 5, 4],
            [3, 4, 7],
            [3, 7, 6],
            [4, 5, 9],
            [4, 9, 8],
        ];
        let named = || [("a".to_owned(), vec![[4, 7]]), ("b".to_owned(), vec![[8, 4]])];
        let with =
            |pairs: &[Pair]| Mesh::with_pairs(vertices.clone(), triangles.clone(), named(), pairs);
        assert!(with(&[Pair::new("a", "b")]).is_ok());
        assert!(matches!(with(&[]), Err(MeshError::Duplicate { vertices: [7, 8], .. })));
    }
}
