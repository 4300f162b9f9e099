//! A displacement that another program computed, as a table in CSV: a first line with the names x, y, ux, uy (in any order, among
//! others), then a line for each point.
//!
//! Points are matched to the nodes of the mesh by their place. A field with points elsewhere, or with several values at one place, is
//! refused: a bound would be of another field.

use std::path::Path;

use super::input::{self, Failure, FileError, Position};
use crate::model::tree::{Bounds, Tree};
use crate::model::{Degree, Mesh, Space};
use crate::quote;

/// Places with the displacement there.
type Points = Vec<([f64; 2], [f64; 2])>;

/// The most bytes of a file: the text of some ten million points.
const MOST: u64 = 2 << 30;

/// A point is a vertex when it is this near, in units of the body's extent: coordinates written in single precision pass.
const NEAR: f64 = 1e-6;

/// The displacement in the file at the vertices of `mesh` or, if `degree` is 2 and points lie in the middles of edges, at these, too: at
/// the nodes of degree 1 or 2.
///
/// # Errors
/// A file that can't be read or understood, that lacks a node or has points that are none, or two values at one.
pub(crate) fn read_field(
    path: &Path,
    mesh: &Mesh,
    degree: Degree,
) -> Result<Vec<[f64; 2]>, FileError> {
    let read = |bytes: Vec<u8>| -> Result<Vec<[f64; 2]>, String> {
        if path.extension().and_then(|e| e.to_str()) != Some("csv") {
            return Err(OTHER.to_owned());
        }
        at_nodes(&from_csv(&String::from_utf8_lossy(&bytes))?, mesh, degree)
    };
    read(input::read(path, MOST)?)
        .map_err(|problem| Failure::from(problem).at(path, Position::File))
}

/// The message about other files.
const OTHER: &str = "expected a file that ends in .csv, with the columns x, y, ux and uy; \
                     docs/certificates.md has the lines of Python that write one from any file that meshio reads";

fn at_nodes(points: &Points, mesh: &Mesh, degree: Degree) -> Result<Vec<[f64; 2]>, String> {
    let vertices = mesh.vertices().len();
    let space = Space::new(mesh, degree);
    let nodes = space.nodes();
    let tree = Tree::new(nodes.iter().map(|&node| Bounds::around([node])).collect());
    let reach = NEAR * Bounds::around(nodes.iter().copied()).size();
    let distance = |k: usize, x: [f64; 2]| (nodes[k][0] - x[0]).hypot(nodes[k][1] - x[1]);
    let nearest = |x: [f64; 2]| {
        let near = tree.meeting(Bounds::around([x]).widened(reach)).into_iter();
        near.filter(|&k| distance(k, x) <= reach)
            .min_by(|&a, &b| distance(a, x).total_cmp(&distance(b, x)))
    };
    // A field of degree 1 has points at vertices alone.
    let quadratic = points.iter().any(|&(x, _)| nearest(x).is_some_and(|k| k >= vertices));
    let what = if quadratic { "vertex or middle of an edge" } else { "vertex" };
    let size = points.iter().flat_map(|(_, u)| u).fold(0.0_f64, |max, u| max.max(u.abs()));
    // The nearest point to each node.
    let mut found = vec![None; if quadratic { nodes.len() } else { vertices }];
    let mut elsewhere = Vec::new();
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
            "{} of its {count} points lie at no {what} of the case's mesh, the first at {}; expected a field on that mesh, as what it does elsewhere would not be seen{}",
            elsewhere.len(),
            pair(x),
            if degree == Degree::One {
                "; for a case of degree 2 also in the middles of edges"
            } else {
                ""
            }
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
    found.into_iter().enumerate().map(value).collect()
}

fn pair([x, y]: [f64; 2]) -> String {
    format!("({x}, {y})")
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

    #[test]
    fn a_field_of_degree_2_is_read_at_the_middles_of_the_edges_too_if_the_case_has_that_degree() {
        let mesh = mesh(Diagonal::Right);
        let space = Space::new(&mesh, Degree::Two);
        let mut points: Points =
            space.nodes().iter().map(|&[x, y]| ([x, y], [x * x, 0.3 * x * y])).collect();
        assert_eq!(at_nodes(&points, &mesh, Degree::Two), Ok(values(&points)));
        let linear = field(&mesh);
        assert_eq!(at_nodes(&linear, &mesh, Degree::Two), Ok(values(&linear)));
        let error = at_nodes(&points, &mesh, Degree::One).unwrap_err();
        let (middles, all) = (mesh.edge_count(), points.len());
        assert!(error.starts_with(&format!("{middles} of its {all} points")), "{error}");
        // Where the middle of one edge is missing, that is said.
        points.pop();
        let error = at_nodes(&points, &mesh, Degree::Two).unwrap_err();
        assert!(error.contains("at the middle of an edge of the mesh"), "{error}");
    }

    #[test]
    fn a_place_may_come_twice_with_one_value_only_and_must_come_once() {
        let mesh = mesh(Diagonal::Right);
        let mut points = field(&mesh);
        let u = values(&points);
        points.extend(points.clone());
        assert_eq!(at_nodes(&points, &mesh, Degree::One), Ok(u));
        let last = points.len() - 1;
        points[last].1[1] += 0.01;
        let error = at_nodes(&points, &mesh, Degree::One).unwrap_err();
        let pair = format!("points {} and {last} lie at one vertex", last / 2);
        assert!(error.starts_with(&pair), "{error}");
        points.truncate(points.len() / 2);
        points.remove(4);
        let error = at_nodes(&points, &mesh, Degree::One).unwrap_err();
        assert!(error.contains("at vertex 4 of the mesh, (0, 1)"), "{error}");
    }

    #[test]
    fn places_and_values_must_be_finite() {
        let mesh = mesh(Diagonal::Right);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (axis, at) in [(0, "place"), (1, "place"), (0, "value"), (1, "value")] {
                let mut points = field(&mesh);
                let (place, value) = &mut points[5];
                (if at == "place" { place } else { value })[axis] = bad;
                let error = at_nodes(&points, &mesh, Degree::One).unwrap_err();
                assert!(error.starts_with("point 5 has a number that is NaN or"), "{error}");
            }
        }
        // The control: where nothing is changed the field is read.
        assert!(at_nodes(&field(&mesh), &mesh, Degree::One).is_ok());
    }

    #[test]
    fn a_small_body_far_from_the_origin_finds_its_points() {
        let at = |x: f64| 1e5 + x * 2f64.powi(-33);
        let places = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|x| x.map(at));
        let none: [(String, Vec<[usize; 2]>); 0] = [];
        let mesh = Mesh::new(places.to_vec(), vec![[0, 1, 2], [0, 2, 3]], none).unwrap();
        let points: Points = places.iter().map(|&x| (x, [0.0, -1e-13])).collect();
        assert_eq!(at_nodes(&points, &mesh, Degree::One), Ok(vec![[0.0, -1e-13]; 4]));
    }

    #[test]
    fn csv_is_read_in_any_order_of_columns_and_points() {
        let mesh = mesh(Diagonal::Right);
        let points = field(&mesh);
        let mut text = "uy, x, y, ux\n".to_owned();
        for ([x, y], [a, b]) in points.iter().rev() {
            text.push_str(&format!("{b},{x},{y},{a}\n"));
        }
        assert_eq!(at_nodes(&from_csv(&text).unwrap(), &mesh, Degree::One), Ok(values(&points)));
        assert!(from_csv("x,y,u\n").unwrap_err().contains("no column 'ux'"));
        let error = from_csv("x,y,ux,uy\n1,2,a,4\n").unwrap_err();
        assert!(error.starts_with("line 2: 'a' is no number"), "{error}");
        let long = from_csv(&format!("x,y,ux,uy\n1,2,\u{7}{},4\n", "7x".repeat(99))).unwrap_err();
        assert!(long.len() < 120 && long.contains("'\\u{7}7x7x"), "{long}");
    }
}
