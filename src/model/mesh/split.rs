//! A mesh split along the curve between two of its surfaces: each keeps vertices of its own there, and a boundary.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::{BoundaryEdge, Mesh, MeshError};
use crate::model::groups::groups;

/// A mesh after vertices have been copied, and the copies of each of them, the vertex itself first.
struct Copied {
    vertices: Vec<[f64; 2]>,
    triangles: Vec<[usize; 3]>,
    copies: BTreeMap<usize, Vec<usize>>,
}

impl Mesh {
    /// Splits the body along the edges that two named surfaces have in common. The boundary of the first towards the second is
    /// called `first|second`, the other one `second|first`. A vertex around which triangles go on from one surface to the other
    /// stays whole: the tip of a slit.
    ///
    /// # Errors
    /// [`MeshError::NoSuchName`], [`MeshError::NoCommonEdge`], and [`MeshError::NameOfSplit`] if there is such a boundary.
    pub fn split_between(&self, surfaces: &[String; 2]) -> Result<Mesh, MeshError> {
        let members = |name: &str| -> Result<BTreeSet<usize>, MeshError> {
            Ok(self.surface(name)?.iter().copied().collect())
        };
        let of = [members(&surfaces[0])?, members(&surfaces[1])?];
        let names = split_names(surfaces);
        if let Some(name) = names.iter().find(|name| self.edges_of(name).is_ok()) {
            return Err(MeshError::NameOfSplit { name: name.clone() });
        }
        let triangles = self.triangles();
        let beside = self.beside();
        let inner = || beside.iter().filter_map(|sides| Some([sides[0]?, sides[1]?]));
        let cut = |[a, b]: [BoundaryEdge; 2]| -> Option<[BoundaryEdge; 2]> {
            let is = |i: usize, edge: BoundaryEdge| of[i].contains(&edge.triangle);
            match (is(0, a) && is(1, b), is(0, b) && is(1, a)) {
                (true, false) => Some([a, b]),
                (false, true) => Some([b, a]),
                _ => None,
            }
        };
        let cuts: Vec<[BoundaryEdge; 2]> = inner().filter_map(cut).collect();
        if cuts.is_empty() {
            return Err(MeshError::NoCommonEdge { surfaces: surfaces.clone() });
        }
        let on_cut: BTreeSet<usize> = cuts.iter().flat_map(|[a, _]| self.ends(*a)).collect();
        // The corners at a vertex of the cut that are joined by whole edges.
        let corner = |t: usize, vertex: usize| {
            3 * t + triangles[t].iter().position(|&v| v == vertex).unwrap_or_default()
        };
        let joined = inner().filter(|&sides| cut(sides).is_none()).flat_map(|[a, b]| {
            self.ends(a).map(|vertex| [corner(a.triangle, vertex), corner(b.triangle, vertex)])
        });
        let group = groups(
            3 * triangles.len(),
            joined.filter(|[c, _]| on_cut.contains(&triangles[c / 3][c % 3])),
        );
        let Copied { vertices, triangles: split, copies } = self.copied(&on_cut, &group);
        let ends = |edge: &BoundaryEdge| [1, 2].map(|k| split[edge.triangle][(edge.local + k) % 3]);
        let topology = &self.topology;
        let mut named: Vec<(String, Vec<[usize; 2]>)> = topology
            .boundaries
            .iter()
            .map(|(name, edges)| (name.clone(), edges.iter().map(ends).collect()))
            .collect();
        let [first, second] = names;
        named.push((first, cuts.iter().map(|[a, _]| ends(a)).collect()));
        named.push((second, cuts.iter().map(|[_, b]| ends(b)).collect()));
        // The two sides of the cut lie on each other; all else lies where it did.
        let mut mesh = Mesh::of_edges(vertices, split, named, &|_, _| true)?;
        let made = Arc::make_mut(&mut mesh.topology);
        made.curves.clone_from(&topology.curves);
        made.faults.clone_from(&topology.faults);
        let places: Vec<[[f64; 2]; 2]> =
            cuts.iter().map(|[a, _]| self.places_of_ends(*a)).collect();
        made.faults.retain(|_, fault| match fault {
            MeshError::InnerEdge { ends: [a, b], .. } => {
                !places.contains(&[*a, *b]) && !places.contains(&[*b, *a])
            }
            _ => true,
        });
        // A point that has become several has no meaning; a condition on such a point is refused.
        let all = |members: &Vec<usize>| {
            let several = members.iter().flat_map(|v| copies.get(v).cloned().unwrap_or(vec![*v]));
            several.collect()
        };
        let points = topology.points.iter().map(|(name, members)| (name.clone(), all(members)));
        mesh.with_names(topology.surfaces.clone(), points.collect())
    }

    /// The two triangles of each edge, each with its number of the edge.
    fn beside(&self) -> Vec<[Option<BoundaryEdge>; 2]> {
        let mut beside = vec![[None; 2]; self.edge_count()];
        for (t, edges) in self.triangle_edges().iter().enumerate() {
            for (local, &e) in edges.iter().enumerate() {
                let side = usize::from(beside[e][0].is_some());
                beside[e][side] = Some(BoundaryEdge { triangle: t, local });
            }
        }
        beside
    }

    /// Copies each vertex in `on_cut` once for every group of corners at it but the first.
    fn copied(&self, on_cut: &BTreeSet<usize>, group: &[usize]) -> Copied {
        let (mut vertices, mut triangles) = (self.vertices().to_vec(), self.triangles().to_vec());
        let mut vertex_of = BTreeMap::new();
        let mut copies: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (t, corners) in self.triangles().iter().enumerate() {
            for (k, vertex) in corners.iter().enumerate().filter(|(_, v)| on_cut.contains(v)) {
                triangles[t][k] = *vertex_of.entry(group[3 * t + k]).or_insert_with(|| {
                    let copies = copies.entry(*vertex).or_default();
                    let copy = if copies.is_empty() { *vertex } else { vertices.len() };
                    if copy == vertices.len() {
                        vertices.push(vertices[*vertex]);
                    }
                    copies.push(copy);
                    copy
                });
            }
        }
        Copied { vertices, triangles, copies }
    }
}

/// The names of the boundaries that [`Mesh::split_between`] makes: of the first surface, and of the second.
pub(crate) fn split_names([first, second]: &[String; 2]) -> [String; 2] {
    [format!("{first}|{second}"), format!("{second}|{first}")]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Diagonal, Rectangle};

    /// A rectangle of 4 x 2 cells, of which those where `holds` are the surface "a", and the others "b".
    fn halves(holds: impl Fn([f64; 2]) -> bool) -> Mesh {
        let cells = Rectangle { width: 4.0, height: 2.0, nx: 4, ny: 2, diagonal: Diagonal::Right };
        let mesh = cells.mesh().unwrap();
        let middle = |t: usize| mesh.triangle(t).point([1.0 / 3.0; 3]).into();
        let (a, b) = (0..mesh.triangles().len()).partition(|&t| holds(middle(t)));
        let surfaces = BTreeMap::from([("a".to_owned(), a), ("b".to_owned(), b)]);
        mesh.clone().with_names(surfaces, BTreeMap::new()).unwrap()
    }

    fn parts(mesh: &Mesh) -> usize {
        mesh.parts().iter().max().unwrap() + 1
    }

    fn names(names: [&str; 2]) -> [String; 2] {
        names.map(str::to_owned)
    }

    #[test]
    fn surfaces_that_share_a_curve_become_two_bodies_with_a_boundary_each() {
        let glued = halves(|[x, _]| x < 2.0);
        let mesh = glued.split_between(&names(["b", "a"])).unwrap();
        assert_eq!((parts(&glued), parts(&mesh)), (1, 2));
        assert_eq!(mesh.vertices().len(), glued.vertices().len() + 3);
        for (name, normal) in [("a|b", [1.0, 0.0]), ("b|a", [-1.0, 0.0])] {
            let edges = mesh.edges_of(name).unwrap();
            assert_eq!(edges.len(), 2);
            for &edge in edges {
                assert_eq!(mesh.length_and_normal(edge), (1.0, normal.into()));
                assert!(mesh.places_of_ends(edge).iter().all(|[x, _]| *x == 2.0));
            }
        }
        for name in ["left", "right", "bottom", "top"] {
            let places = |mesh: &Mesh| -> Vec<_> {
                mesh.edges_of(name).unwrap().iter().map(|&e| mesh.places_of_ends(e)).collect()
            };
            assert_eq!(places(&mesh), places(&glued));
        }
        assert_eq!(mesh.surfaces(), glued.surfaces());
    }

    #[test]
    fn a_body_inside_another_is_cut_out_and_a_slit_keeps_its_tip() {
        let glued = halves(|[x, y]| x > 1.0 && x < 3.0 && y > 1.0);
        let mesh = glued.split_between(&names(["a", "b"])).unwrap();
        assert_eq!(parts(&mesh), 2);
        assert_eq!(mesh.vertices().len(), glued.vertices().len() + 5);
        // Three surfaces around (2, 1), of which two are split: there the third one joins them.
        let cells = Rectangle { width: 4.0, height: 2.0, nx: 4, ny: 2, diagonal: Diagonal::Right };
        let mesh = cells.mesh().unwrap();
        let middle = |t: usize| <[f64; 2]>::from(mesh.triangle(t).point([1.0 / 3.0; 3]));
        let mut surfaces: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for t in 0..mesh.triangles().len() {
            let [x, y] = middle(t);
            let name = if y < 1.0 {
                "c"
            } else if x < 2.0 {
                "a"
            } else {
                "b"
            };
            surfaces.entry(name.to_owned()).or_default().push(t);
        }
        let glued = mesh.with_names(surfaces, BTreeMap::new()).unwrap();
        let mesh = glued.split_between(&names(["a", "b"])).unwrap();
        assert_eq!((parts(&mesh), mesh.vertices().len()), (1, glued.vertices().len() + 1));
        assert_eq!(mesh.edges_of("a|b").unwrap().len(), 1);
        // Splitting further, all three come apart.
        let mesh = mesh.split_between(&names(["a", "c"])).unwrap();
        assert_eq!(parts(&mesh), 2);
        let mesh = mesh.split_between(&names(["b", "c"])).unwrap();
        assert_eq!((parts(&mesh), mesh.vertices().len()), (3, glued.vertices().len() + 7));
    }

    #[test]
    fn a_named_point_on_the_cut_is_one_of_both_bodies_and_a_point_beside_it_stays_one() {
        let glued = halves(|[x, _]| x < 2.0);
        let vertex = |place| glued.vertices().iter().position(|x| *x == place).unwrap();
        let points = [("on", [2.0, 1.0]), ("off", [1.0, 1.0])];
        let points = points.map(|(name, place)| (name.to_owned(), vec![vertex(place)]));
        let named = glued.clone().with_names(glued.surfaces().clone(), points.into()).unwrap();
        let mesh = named.split_between(&names(["a", "b"])).unwrap();
        assert!(named.point("on").is_ok());
        assert!(matches!(mesh.point("on"), Err(MeshError::NotOnePoint { count: 2, .. })));
        assert_eq!(mesh.point("off").unwrap(), named.point("off").unwrap());
    }

    #[test]
    fn surfaces_that_do_not_meet_are_named() {
        let glued = halves(|[x, _]| x < 2.0);
        let split = glued.split_between(&names(["a", "b"])).unwrap();
        let again = split.split_between(&names(["a", "b"])).unwrap_err();
        assert!(matches!(again, MeshError::NameOfSplit { .. }), "{again}");
        let none = glued.split_between(&names(["a", "a"])).unwrap_err();
        assert_eq!(
            none.to_string(),
            "the surfaces 'a' and 'a' have no edge in common; expected two that meet in a curve"
        );
        assert!(matches!(
            glued.split_between(&names(["a", "c"])),
            Err(MeshError::NoSuchName { .. })
        ));
    }
}
