//! A displacement that another program computed: VTU or CSV, read at the vertices of a mesh.
//!
//! - `.csv`: a first line with the names x, y, ux, uy (in any order, among others), then a line for each point.
//! - `.vtu`: the points, and on them the vectors called `displacement` or `u`, or the only ones there are. Numbers in text or
//!   base64, as they are or compressed by zlib: what this program, meshio, FEniCSx, GetFEM and scikit-fem write. Not the
//!   appended section that VTK itself prefers.
//!
//! Points are matched to vertices by their place. A field on quadratic triangles of VTU (with six points each, VTK's types 22 and
//! 69) is read at the middles of the edges, too. A field with points elsewhere, on other triangles, or with several values at one
//! place, is refused: a bound would be of another field.

use std::collections::BTreeSet;
use std::path::Path;

use super::input::{self, Failure, FileError, Position};
use super::vtu::reader::{Points, Triangles, from_vtu};
use crate::model::tree::{Bounds, Tree};
use crate::model::{Degree, Mesh, Space};
use crate::quote;

/// The most bytes of a file: the text of some ten million points.
const MOST: u64 = 2 << 30;

/// A point is a vertex when it is this near, in units of the body's extent: coordinates written in single precision pass.
const NEAR: f64 = 1e-6;

/// The displacement in the file at the vertices of `mesh` and, if it is quadratic, at the middles of its edges: at the nodes of
/// degree 1 or 2.
///
/// # Errors
/// A file that can't be read or understood, that lacks a node of the mesh or has points that are none, or two values at one, or
/// triangles that are not those of the mesh.
pub fn read_field(path: &Path, mesh: &Mesh) -> Result<Vec<[f64; 2]>, FileError> {
    let read = |bytes: Vec<u8>| -> Result<Vec<[f64; 2]>, String> {
        let text = String::from_utf8_lossy(&bytes);
        let (points, triangles) = match path.extension().and_then(|e| e.to_str()) {
            Some("csv") => (from_csv(&text)?, None),
            Some("vtu") => from_vtu(&text)?,
            _ => return Err("expected a file that ends in .vtu or .csv".to_owned()),
        };
        at_nodes(&points, mesh, triangles.as_ref())
    };
    read(input::read(path, MOST)?)
        .map_err(|problem| Failure::from(problem).at(path, Position::File))
}

fn at_nodes(
    points: &Points,
    mesh: &Mesh,
    triangles: Option<&Triangles>,
) -> Result<Vec<[f64; 2]>, String> {
    let quadratic = triangles.is_some_and(|triangles| triangles.quadratic);
    let vertices = mesh.vertices().len();
    let nodes: Vec<[f64; 2]> = if quadratic {
        Space::new(mesh, Degree::Two).nodes().to_vec()
    } else {
        mesh.vertices().to_vec()
    };
    let tree = Tree::new(nodes.iter().map(|&node| Bounds::around([node])).collect());
    let reach = NEAR * Bounds::around(nodes.iter().copied()).size();
    let distance = |k: usize, x: [f64; 2]| (nodes[k][0] - x[0]).hypot(nodes[k][1] - x[1]);
    let nearest = |x: [f64; 2]| {
        let mut near = Vec::new();
        tree.meeting(Bounds::around([x]).widened(reach), |k| near.push(k));
        near.retain(|&k| distance(k, x) <= reach);
        near.into_iter().min_by(|&a, &b| distance(a, x).total_cmp(&distance(b, x)))
    };
    let what = if quadratic { "vertex or middle of an edge" } else { "vertex" };
    let size = points.iter().flat_map(|(_, u)| u).fold(0.0_f64, |max, u| max.max(u.abs()));
    // The nearest point to each node.
    let mut found: Vec<Option<usize>> = vec![None; nodes.len()];
    let (mut elsewhere, mut node_of) = (Vec::new(), Vec::with_capacity(points.len()));
    for (i, &(x, u)) in points.iter().enumerate() {
        if !x.iter().chain(&u).all(|c| c.is_finite()) {
            return Err(format!(
                "point {i} has a number that is NaN or infinite; expected finite ones"
            ));
        }
        let Some(k) = nearest(x) else {
            elsewhere.push(x);
            continue;
        };
        node_of.push(k);
        let Some(other) = found[k].replace(i) else { continue };
        let (y, w) = points[other];
        if (0..2).any(|c| (u[c] - w[c]).abs() > NEAR * size) {
            let [x, w, u] = [x, w, u].map(pair);
            return Err(format!(
                "points {other} and {i} lie at one {what}, {x}, and have the displacements {w} and {u}; expected one"
            ));
        }
        if distance(k, y) < distance(k, x) {
            found[k] = Some(other);
        }
    }
    let count = points.len();
    if let Some(&x) = elsewhere.first() {
        return Err(format!(
            "{} of its {count} points lie at no {what} of the case's mesh, the first at {}; expected a field on that mesh, as what it does elsewhere would not be seen",
            elsewhere.len(),
            pair(x)
        ));
    }
    let value = |(k, found): (usize, Option<usize>)| match found {
        Some(i) => Ok(points[i].1),
        None => Err(format!(
            "none of its {count} points lies at {} of the mesh, {}; expected the displacement at every {}",
            if k < vertices { format!("vertex {k}") } else { "the middle of an edge".to_owned() },
            pair(nodes[k]),
            if quadratic { "vertex and every middle of an edge" } else { "vertex" }
        )),
    };
    let values = found.into_iter().enumerate().map(value).collect::<Result<_, _>>()?;
    if let Some(triangles) = triangles {
        check_triangles(triangles, &node_of, mesh)?;
    }
    Ok(values)
}

fn pair([x, y]: [f64; 2]) -> String {
    format!("({x}, {y})")
}

/// The triangles of a file are those of the mesh: on others, such as those along the other diagonals of a grid, the same
/// values are another field. `node_of` tells the node of each point.
fn check_triangles(triangles: &Triangles, node_of: &[usize], mesh: &Mesh) -> Result<(), String> {
    let sorted = |mut corners: [usize; 3]| {
        corners.sort_unstable();
        corners
    };
    let mut rest: BTreeSet<[usize; 3]> = mesh.triangles().iter().copied().map(sorted).collect();
    for (k, corners) in triangles.corners.iter().enumerate() {
        let nodes = corners.map(|point| node_of[point]);
        if !rest.remove(&sorted(nodes)) {
            return Err(format!(
                "its triangle {k} is none of the case's mesh, or comes twice; expected a field on that mesh, as on other triangles the same values are another field"
            ));
        }
    }
    if rest.is_empty() {
        return Ok(());
    }
    let (lacking, all) = (rest.len(), mesh.triangles().len());
    Err(format!("it lacks {lacking} of the {all} triangles of the case's mesh; expected all"))
}

fn from_csv(text: &str) -> Result<Points, String> {
    let mut lines = text.lines().enumerate();
    let (_, head) = lines.next().ok_or("the file is empty; expected x,y,ux,uy")?;
    let names: Vec<&str> = head.split(',').map(str::trim).collect();
    let column = |name: &str| {
        names.iter().position(|n| *n == name).ok_or_else(|| {
            format!(
                "line 1 has no column '{name}' among {}; expected x, y, ux and uy, with commas between",
                quote::names(names.iter().copied())
            )
        })
    };
    let columns = [column("x")?, column("y")?, column("ux")?, column("uy")?];
    let mut points = Vec::new();
    for (i, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |c: usize| {
            let cell = cells.get(c).copied().unwrap_or_default();
            cell.parse::<f64>().map_err(|_| {
                let cell = quote::quoted(cell, '\'');
                format!("line {}: {cell} is no number; expected {}", i + 1, names[c])
            })
        };
        let [x, y, u, v] = columns.map(number);
        points.push(([x?, y?], [u?, v?]));
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::vtu::{CellKind, DataArray, Grid, vtu};
    use crate::model::{Diagonal, Rectangle};

    fn mesh(diagonal: Diagonal) -> Mesh {
        Rectangle { width: 1.0, height: 2.0, nx: 3, ny: 2, diagonal }.mesh().unwrap()
    }

    fn field(mesh: &Mesh) -> Points {
        mesh.vertices().iter().map(|&[x, y]| ([x, y], [x - y, 0.1 * x])).collect()
    }

    fn values(points: &Points) -> Vec<[f64; 2]> {
        points.iter().map(|&(_, u)| u).collect()
    }

    /// Reads what this program writes.
    fn written(
        degree: Degree,
        points: &Points,
        connectivity: &[usize],
    ) -> (Points, Option<Triangles>) {
        let places: Vec<[f64; 2]> = points.iter().map(|&(x, _)| x).collect();
        let file = vtu(&Grid {
            kind: CellKind::Triangle(degree),
            points: &places,
            connectivity,
            point_data: &[DataArray::vectors("displacement", &values(points))],
            cell_data: &[],
        });
        from_vtu(std::str::from_utf8(&file.unwrap()).unwrap()).unwrap()
    }

    #[test]
    fn a_field_is_read_back_to_the_bit_and_refused_on_other_triangles_with_the_same_points() {
        let mesh = mesh(Diagonal::Right);
        let read = |connectivity: &[usize], points: &Points| {
            let (points, triangles) = written(Degree::One, points, connectivity);
            at_nodes(&points, &mesh, triangles.as_ref())
        };
        let points = field(&mesh);
        let own = mesh.triangles().as_flattened();
        assert_eq!(read(own, &points), Ok(values(&points)));
        // Turned round, and each with points of its own.
        let turned: Vec<usize> = own.iter().rev().copied().collect();
        assert!(read(&turned, &points).is_ok());
        let apart: Points = own.iter().map(|&k| points[k]).collect();
        assert!(read(&(0..own.len()).collect::<Vec<_>>(), &apart).is_ok());
        let left = self::mesh(Diagonal::Left);
        assert_eq!(left.vertices(), mesh.vertices());
        let error = read(left.triangles().as_flattened(), &points).unwrap_err();
        assert!(error.starts_with("its triangle 0 is none of the case's mesh"), "{error}");
        let error = read(&own[3..], &points).unwrap_err();
        assert_eq!(error, "it lacks 1 of the 12 triangles of the case's mesh; expected all");
        let error = read(&[own, &own[..3]].concat(), &points).unwrap_err();
        assert!(error.starts_with("its triangle 12"), "{error}");
    }

    #[test]
    fn a_field_on_quadratic_triangles_is_read_at_the_middles_of_the_edges_too() {
        let mesh = mesh(Diagonal::Right);
        let space = Space::new(&mesh, Degree::Two);
        let u: Points =
            space.nodes().iter().map(|&[x, y]| ([x, y], [x * x, 0.3 * x * y])).collect();
        let (mut points, triangles) = written(Degree::Two, &u, space.connectivity());
        assert!(triangles.as_ref().unwrap().quadratic);
        assert_eq!(at_nodes(&points, &mesh, triangles.as_ref()), Ok(values(&u)));
        let error = at_nodes(&points, &mesh, None).unwrap_err();
        let middles = mesh.edge_count();
        assert!(error.starts_with(&format!("{middles} of its {} points", u.len())), "{error}");
        // Where the middle of one edge is missing, that is said.
        points.pop();
        let error = at_nodes(&points, &mesh, triangles.as_ref()).unwrap_err();
        assert!(error.contains("at the middle of an edge of the mesh"), "{error}");
    }

    #[test]
    fn a_place_may_come_twice_with_one_value_only_and_must_come_once() {
        let mesh = mesh(Diagonal::Right);
        let mut points = field(&mesh);
        let u = values(&points);
        points.extend(points.clone());
        assert_eq!(at_nodes(&points, &mesh, None), Ok(u));
        let last = points.len() - 1;
        points[last].1[1] += 0.01;
        let error = at_nodes(&points, &mesh, None).unwrap_err();
        let pair = format!("points {} and {last} lie at one vertex", last / 2);
        assert!(error.starts_with(&pair), "{error}");
        points.truncate(points.len() / 2);
        points.remove(4);
        let error = at_nodes(&points, &mesh, None).unwrap_err();
        assert!(error.contains("at vertex 4 of the mesh, (0, 1)"), "{error}");
    }

    #[test]
    fn a_small_body_far_from_the_origin_finds_its_points() {
        let at = |x: f64| 1e5 + x * 2f64.powi(-33);
        let places = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|x| x.map(at));
        let none: [(String, Vec<[usize; 2]>); 0] = [];
        let mesh = Mesh::new(places.to_vec(), vec![[0, 1, 2], [0, 2, 3]], none).unwrap();
        let points: Points = places.iter().map(|&x| (x, [0.0, -1e-13])).collect();
        assert_eq!(at_nodes(&points, &mesh, None), Ok(vec![[0.0, -1e-13]; 4]));
    }

    #[test]
    fn csv_is_read_in_any_order_of_columns_and_points() {
        let mesh = mesh(Diagonal::Right);
        let points = field(&mesh);
        let mut text = "uy, x, y, ux\n".to_owned();
        for ([x, y], [a, b]) in points.iter().rev() {
            text.push_str(&format!("{b},{x},{y},{a}\n"));
        }
        assert_eq!(at_nodes(&from_csv(&text).unwrap(), &mesh, None), Ok(values(&points)));
        assert!(from_csv("x,y,u\n").unwrap_err().contains("no column 'ux'"));
        let error = from_csv("x,y,ux,uy\n1,2,a,4\n").unwrap_err();
        assert!(error.starts_with("line 2: 'a' is no number"), "{error}");
        let long = from_csv(&format!("x,y,ux,uy\n1,2,\u{7}{},4\n", "7x".repeat(99))).unwrap_err();
        assert!(long.len() < 120 && long.contains("'\\u{7}7x7x"), "{long}");
    }
}
