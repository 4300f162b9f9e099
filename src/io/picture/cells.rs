//! A body of very many triangles, drawn by small square cells.
//!
//! A triangle longer than a cell is cut until its parts are not; a cell takes the mean of the parts that have their centroid
//! in it, weighted by area. So neither a triangle much larger nor one much smaller than a cell is lost. Cells on the border
//! copy their neighbours; the picture is cut along the deformed outline afterwards, so the border is as sharp as with triangles.

use std::collections::BTreeMap;

use super::draw::{Point, between, distance};

/// A cell by its row and its column, in units of its side.
type Cell = [i64; 2];

/// Rectangles of neighbouring cells in a row with the same level: the level of their mean value, and their corners.
pub(super) fn rectangles(
    side: f64,
    triangles: &[[Point; 3]],
    values: &[f64],
    level: impl Fn(f64) -> usize,
) -> Vec<(usize, [Point; 4])> {
    let levels: Vec<(Cell, usize)> = means(side, triangles, values)
        .into_iter()
        .map(|(cell, mean)| (cell, level(mean)))
        .collect();
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

/// The mean value in each cell that touches the body.
fn means(side: f64, triangles: &[[Point; 3]], values: &[f64]) -> BTreeMap<Cell, f64> {
    let mut sums: BTreeMap<Cell, [f64; 2]> = BTreeMap::new();
    let mut parts: Vec<([Point; 3], f64)> =
        triangles.iter().copied().zip(values.iter().copied()).collect();
    while let Some(([a, b, c], value)) = parts.pop() {
        // The first of three is its longest side.
        let sides = [[a, b, c], [b, c, a], [c, a, b]];
        let longest =
            sides.into_iter().max_by(|s, t| distance(s[0], s[1]).total_cmp(&distance(t[0], t[1])));
        if let Some([a, b, c]) = longest
            && distance(a, b) > side
        {
            let middle = between(a, b, 0.5);
            parts.extend([([a, middle, c], value), ([middle, b, c], value)]);
            continue;
        }
        let centroid = [1, 0].map(|i| (a[i] + b[i] + c[i]) / 3.0);
        let [weight, sum] = sums.entry(centroid.map(|x| (x / side).floor() as i64)).or_default();
        let area = area(&[a, b, c]).abs();
        *weight += area;
        *sum += area * value;
    }
    let mut means: BTreeMap<Cell, f64> =
        sums.into_iter().filter(|s| s.1[0] > 0.0).map(|(cell, [w, sum])| (cell, sum / w)).collect();
    // A border cell is at most one cell away from one that has a value, diagonally perhaps.
    for _ in 0..2 {
        let mut around: BTreeMap<Cell, [f64; 2]> = BTreeMap::new();
        for (&[row, column], mean) in &means {
            for [i, j] in [[-1, 0], [0, -1], [0, 1], [1, 0]] {
                let cell = [row + i, column + j];
                if !means.contains_key(&cell) {
                    let [count, sum] = around.entry(cell).or_default();
                    *count += 1.0;
                    *sum += mean;
                }
            }
        }
        means.extend(around.into_iter().map(|(cell, [count, sum])| (cell, sum / count)));
    }
    means
}

/// Positive if the corners are in counter-clockwise order (with y upwards).
pub(super) fn area([a, b, c]: &[Point; 3]) -> f64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_has_the_value_of_a_large_triangle_and_the_mean_of_small_ones() {
        let large =
            [[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0]], [[0.0, 0.0], [40.0, 40.0], [0.0, 40.0]]];
        let cells = means(4.0, &large, &[1.0, 2.0]);
        assert_eq!([cells[&[2, 7]], cells[&[7, 2]]], [1.0, 2.0]);
        let small = |x: f64| [[x, 1.0], [x + 0.5, 1.0], [x, 1.5]];
        let cells = means(4.0, &[small(1.0), small(1.5), small(2.0)], &[1.0, 2.0, 6.0]);
        assert_eq!(cells[&[0, 0]], 3.0);
        // A row of one level is one rectangle: ten rows, and two more around them on each side.
        let rectangles = rectangles(4.0, &large, &[1.0, 1.0], |value| value as usize);
        assert_eq!(rectangles.len(), 14);
        assert!(rectangles.iter().all(|&(level, _)| level == 1));
    }

    #[test]
    fn every_point_of_the_body_is_in_a_cell_with_a_value() {
        // A triangle that starts and ends just beyond cell borders.
        let cells = means(4.0, &[[[3.9, 3.9], [20.1, 4.0], [4.0, 20.1]]], &[7.0]);
        for i in 0..=100 {
            for j in 0..=100 - i {
                let [s, t] = [i, j].map(|k| f64::from(k) / 100.0);
                let [x, y] = [3.9 + 16.2 * s + 0.1 * t, 3.9 + 0.1 * s + 16.2 * t];
                let cell = [y, x].map(|c| (c / 4.0).floor() as i64);
                assert!((cells[&cell] - 7.0).abs() < 1e-12, "{x} {y}");
            }
        }
    }
}
