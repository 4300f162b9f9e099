//! A body of very many triangles, drawn by small square cells.
//!
//! A cell takes the level of the triangle at its centre; one on the border whose centre is outside takes that of a triangle
//! nearby. The picture is cut along the deformed outline afterwards, so the border is as sharp as with triangles.

use super::draw::{Point, distance};
use crate::model::tree::Bounds;

/// Cells in rows, from the one at `first` on, each with its level if it touches the body.
struct Cells {
    first: [i64; 2],
    columns: usize,
    levels: Vec<Option<usize>>,
}

/// Rectangles of neighbouring cells in a row with the same level, which the triangles have: that, and their corners.
pub(super) fn rectangles(
    side: f64,
    triangles: &[[Point; 3]],
    levels: &[usize],
) -> Vec<(usize, [Point; 4])> {
    let Cells { first, columns, levels } = Cells::of(side, triangles, levels);
    let mut rectangles = Vec::new();
    for (row, cells) in (first[0]..).zip(levels.chunks_exact(columns)) {
        let mut start = first[1];
        for run in cells.chunk_by(|a, b| a == b) {
            let end = start + run.len() as i64;
            if let Some(level) = run[0] {
                let [x0, x1, y0, y1] = [start, end, row, row + 1].map(|i| i as f64 * side);
                rectangles.push((level, [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]));
            }
            start = end;
        }
    }
    rectangles
}

/// No page is as wide or as high.
const FAR: f64 = 4000.0;

impl Cells {
    /// The level of each cell that touches the body.
    fn of(side: f64, triangles: &[[Point; 3]], levels: &[usize]) -> Cells {
        let Bounds { low, high } = Bounds::around(triangles.iter().flatten().copied());
        // The floor, which is a call of a function on processors that have no instruction for it.
        let cell = |x: f64| {
            let x = x.clamp(-FAR, FAR) / side;
            let towards_0 = x as i64;
            towards_0 - i64::from(towards_0 as f64 > x)
        };
        let first = [1, 0].map(|c| cell(low[c]) - 1);
        let last = [1, 0].map(|c| cell(high[c]) + 1);
        let [rows, columns] = [0, 1].map(|c| (last[c] - first[c] + 1) as usize);
        let mut cells = Cells { first, columns, levels: vec![None; rows * columns] };
        // From the cell of the lowest corner less `by` to that of the highest less `by`: rows, columns.
        let range = |triangle: &[Point; 3], by: f64| {
            [1, 0].map(|c| {
                let [a, b, d] = triangle.map(|corner| corner[c]);
                [cell(a.min(b).min(d) - by), cell(a.max(b).max(d) - by)]
            })
        };
        // The distance of the centre from the line along a side, positive inside, times the length of the side.
        let depth = |triangle: &[Point; 3], [row, column]: [i64; 2], i: usize| {
            let centre = [column, row].map(|i| (i as f64 + 0.5) * side);
            2.0 * area(triangle).signum() * area(&[triangle[i], triangle[(i + 1) % 3], centre])
        };
        for (triangle, &level) in triangles.iter().zip(levels) {
            // The centres above the lowest corner and not above the highest.
            let [[top, bottom], [left, right]] = range(triangle, side / 2.0);
            for row in top + 1..=bottom {
                for column in left + 1..=right {
                    let place = [row, column];
                    if (0..3).all(|i| depth(triangle, place, i) >= 0.0) {
                        *cells.at(place) = Some(level);
                    }
                }
            }
        }
        for (triangle, &level) in triangles.iter().zip(levels) {
            let [[top, bottom], [left, right]] = range(triangle, 0.0);
            for row in top..=bottom {
                for column in left..=right {
                    let place = [row, column];
                    let length = |i: usize| distance(triangle[i], triangle[(i + 1) % 3]);
                    let is_near = |i: usize| depth(triangle, place, i) > -side * length(i);
                    if cells.at(place).is_none() && (0..3).all(is_near) {
                        *cells.at(place) = Some(level);
                    }
                }
            }
        }
        cells
    }

    fn at(&mut self, [row, column]: [i64; 2]) -> &mut Option<usize> {
        let [row, column] = [row - self.first[0], column - self.first[1]].map(|i| i as usize);
        &mut self.levels[row * self.columns + column]
    }
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
        let mut found = Cells::of(4.0, &triangles, &[1, 2]);
        assert_eq!([*found.at([2, 7]), *found.at([7, 2])], [Some(1), Some(2)]);
        // A row of one level is one rectangle.
        let rectangles = rectangles(4.0, &triangles, &[1, 1]);
        let rows = rectangles.iter().filter(|(_, corners)| (0.0..40.0).contains(&corners[0][1]));
        assert_eq!(rows.count(), 10);
        assert!(rectangles.iter().all(|&(level, _)| level == 1));
    }

    #[test]
    fn every_point_of_the_body_is_in_a_cell_with_a_level() {
        // A triangle that starts and ends just beyond cell borders.
        let mut cells = Cells::of(4.0, &[[[3.9, 3.9], [20.1, 4.0], [4.0, 20.1]]], &[7]);
        for i in 0..=100 {
            for j in 0..=100 - i {
                let [s, t] = [i, j].map(|k| f64::from(k) / 100.0);
                let [x, y] = [3.9 + 16.2 * s + 0.1 * t, 3.9 + 0.1 * s + 16.2 * t];
                let cell = [y, x].map(|c| (c / 4.0).floor() as i64);
                assert!(cells.at(cell).is_some(), "{x} {y}");
            }
        }
    }
}
