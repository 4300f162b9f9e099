//! A body of very many triangles, drawn by small square cells.
//!
//! A cell takes the level of the triangle at its centre; one on the border whose centre is outside takes that of a triangle
//! nearby. The picture is cut along the deformed outline afterwards, so the border is as sharp as with triangles.

use std::collections::BTreeMap;

use super::draw::{Point, distance};

/// A cell by its row and its column, in units of its side.
type Cell = [i64; 2];

/// Rectangles of neighbouring cells in a row with the same level, which the triangles have: that, and their corners.
pub(super) fn rectangles(
    side: f64,
    triangles: &[[Point; 3]],
    levels: &[usize],
) -> Vec<(usize, [Point; 4])> {
    let levels: Vec<(Cell, usize)> = cells(side, triangles, levels).into_iter().collect();
    let is_next = |a: Cell, b: Cell| a[0] == b[0] && a[1] + 1 == b[1];
    let runs = levels.chunk_by(|a, b| is_next(a.0, b.0) && a.1 == b.1);
    let rectangle = |run: &[(Cell, usize)]| {
        let ([row, start], level) = run[0];
        let end = start + run.len() as i64;
        let [x0, x1, y0, y1] = [start, end, row, row + 1].map(|i| i as f64 * side);
        (level, [[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    };
    runs.map(rectangle).collect()
}

/// The level of each cell that touches the body.
fn cells(side: f64, triangles: &[[Point; 3]], levels: &[usize]) -> BTreeMap<Cell, usize> {
    let mut cells = BTreeMap::new();
    for (triangle, &level) in triangles.iter().zip(levels) {
        let turn = area(triangle).signum();
        let range = |c: usize| {
            let [a, b, d] = triangle.map(|corner| corner[c] / side);
            (a.min(b).min(d).floor() as i64 - 1)..=(a.max(b).max(d).floor() as i64 + 1)
        };
        for row in range(1) {
            for column in range(0) {
                let centre = [column, row].map(|i| (i as f64 + 0.5) * side);
                // The least of the distances from the lines along the sides, negative outside.
                let depth = (0..3).map(|i| {
                    let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
                    2.0 * turn * area(&[a, b, centre]) / distance(a, b)
                });
                match depth.fold(f64::INFINITY, f64::min) {
                    depth if depth >= 0.0 => _ = cells.insert([row, column], level),
                    depth if depth > -side => _ = cells.entry([row, column]).or_insert(level),
                    _ => {}
                }
            }
        }
    }
    cells
}

/// Positive if the corners are in counter-clockwise order (with y upwards).
pub(super) fn area([a, b, c]: &[Point; 3]) -> f64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_has_the_level_of_the_triangle_at_its_centre() {
        let triangles =
            [[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0]], [[0.0, 0.0], [40.0, 40.0], [0.0, 40.0]]];
        let found = cells(4.0, &triangles, &[1, 2]);
        assert_eq!([found[&[2, 7]], found[&[7, 2]]], [1, 2]);
        // A row of one level is one rectangle.
        let rectangles = rectangles(4.0, &triangles, &[1, 1]);
        let rows = rectangles.iter().filter(|(_, corners)| (0.0..40.0).contains(&corners[0][1]));
        assert_eq!(rows.count(), 10);
        assert!(rectangles.iter().all(|&(level, _)| level == 1));
    }

    #[test]
    fn every_point_of_the_body_is_in_a_cell_with_a_level() {
        // A triangle that starts and ends just beyond cell borders.
        let cells = cells(4.0, &[[[3.9, 3.9], [20.1, 4.0], [4.0, 20.1]]], &[7]);
        for i in 0..=100 {
            for j in 0..=100 - i {
                let [s, t] = [i, j].map(|k| f64::from(k) / 100.0);
                let [x, y] = [3.9 + 16.2 * s + 0.1 * t, 3.9 + 0.1 * s + 16.2 * t];
                let cell = [y, x].map(|c| (c / 4.0).floor() as i64);
                assert!(cells.contains_key(&cell), "{x} {y}");
            }
        }
    }
}
