//! A body of very many triangles, drawn by small square cells.
//!
//! A cell takes the mean of the triangles that have their centroid in it, weighted by area, and of the triangle that
//! covers its centre, if that is larger than a cell. So neither a triangle much larger nor one much smaller than a cell
//! is lost. Cells on the border, whose centre is outside, copy their neighbours; the picture is cut along the deformed
//! outline afterwards, so the border is as sharp as with triangles.

use super::draw::Point;

/// Cells in columns and rows, each with a value if it touches the body.
pub struct Cells {
    side: f64,
    /// The cell in column 0 and row 0 has its upper left corner at `side` times this.
    origin: [i64; 2],
    columns: usize,
    values: Vec<Option<f64>>,
}

impl Cells {
    /// Cells with sides of that length over triangles (at least one) with a value each.
    pub fn new(side: f64, triangles: &[[Point; 3]], values: &[f64]) -> Cells {
        let corners = || triangles.iter().flatten();
        let edge = |c: usize, pick: fn(f64, f64) -> f64, start: f64| {
            (corners().map(|p| p[c]).fold(start, pick) / side).floor() as i64
        };
        let first = [0, 1].map(|c| edge(c, f64::min, f64::INFINITY) - 1);
        let last = [0, 1].map(|c| edge(c, f64::max, f64::NEG_INFINITY) + 1);
        let [columns, rows] = [0, 1].map(|c| (last[c] - first[c] + 1).max(0) as usize);
        let mut cells = Cells { side, origin: first, columns, values: vec![None; columns * rows] };
        cells.average(triangles, values);
        // A border cell is at most one cell away from one that has a value, diagonally perhaps.
        cells.spread();
        cells.spread();
        cells
    }

    fn average(&mut self, triangles: &[[Point; 3]], values: &[f64]) {
        let mut sums = vec![[0.0; 2]; self.values.len()];
        let mut add = |cell: Option<usize>, weight: f64, value: f64| {
            if let Some(sum) = cell.and_then(|cell| sums.get_mut(cell)) {
                sum[0] += weight;
                sum[1] += weight * value;
            }
        };
        let whole = self.side * self.side;
        for (corners, &value) in triangles.iter().zip(values) {
            let area = area(corners).abs();
            let centroid = [0, 1].map(|c| corners.iter().map(|p| p[c]).sum::<f64>() / 3.0);
            add(self.at(centroid), area.min(whole), value);
            if area > whole {
                self.centres_inside(corners, |cell| add(Some(cell), whole, value));
            }
        }
        for (value, [weight, sum]) in self.values.iter_mut().zip(sums) {
            *value = (weight > 0.0).then(|| sum / weight);
        }
    }

    fn at(&self, [x, y]: Point) -> Option<usize> {
        let [column, row] = [x, y].map(|c| (c / self.side).floor() as i64);
        let column = usize::try_from(column - self.origin[0]).ok()?;
        let row = usize::try_from(row - self.origin[1]).ok()?;
        (column < self.columns).then_some(row * self.columns + column)
    }

    fn centres_inside(&self, corners: &[Point; 3], mut f: impl FnMut(usize)) {
        let range = |c: usize| {
            let low = corners.iter().map(|p| p[c]).fold(f64::INFINITY, f64::min);
            let high = corners.iter().map(|p| p[c]).fold(f64::NEG_INFINITY, f64::max);
            (low / self.side).floor() as i64..=(high / self.side).floor() as i64
        };
        let sign = area(corners).signum();
        for row in range(1) {
            for column in range(0) {
                let centre = [column, row].map(|i| (i as f64 + 0.5) * self.side);
                let [a, b, c] = *corners;
                let inside = [[a, b, centre], [b, c, centre], [c, a, centre]]
                    .iter()
                    .all(|part| sign * area(part) >= 0.0);
                if let (true, Some(cell)) = (inside, self.at(centre)) {
                    f(cell);
                }
            }
        }
    }

    /// Cells without a value take the mean of their neighbours that have one.
    fn spread(&mut self) {
        let (columns, old) = (self.columns, self.values.clone());
        for (i, value) in self.values.iter_mut().enumerate().filter(|(_, value)| value.is_none()) {
            let column = i % columns;
            let neighbours = [
                if column > 0 { old.get(i - 1) } else { None },
                if column + 1 < columns { old.get(i + 1) } else { None },
                i.checked_sub(columns).and_then(|above| old.get(above)),
                old.get(i + columns),
            ];
            let (mut count, mut sum) = (0.0, 0.0);
            for neighbour in neighbours.into_iter().flatten().flatten() {
                count += 1.0;
                sum += neighbour;
            }
            *value = (count > 0.0).then(|| sum / count);
        }
    }

    /// Rectangles of neighbouring cells in a row with the same level: the level and the corners.
    pub fn rectangles(&self, level: impl Fn(f64) -> usize) -> Vec<(usize, [Point; 4])> {
        let mut rectangles = Vec::new();
        let level = |value: &Option<f64>| value.map(&level);
        for (row, values) in self.values.chunks(self.columns.max(1)).enumerate() {
            let mut start = 0;
            for run in values.chunk_by(|a, b| level(a) == level(b)) {
                let end = start + run.len();
                if let Some(level) = run.first().and_then(level) {
                    let [x0, x1] = [start, end].map(|i| self.page(0, i));
                    let [y0, y1] = [row, row + 1].map(|i| self.page(1, i));
                    rectangles.push((level, [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]));
                }
                start = end;
            }
        }
        rectangles
    }

    fn page(&self, axis: usize, i: usize) -> f64 {
        (self.origin[axis] + i as i64) as f64 * self.side
    }
}

/// Positive if the corners are in counter-clockwise order (with y upwards).
pub fn area([a, b, c]: &[Point; 3]) -> f64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const LARGE: [[Point; 3]; 2] =
        [[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0]], [[0.0, 0.0], [40.0, 40.0], [0.0, 40.0]]];

    #[test]
    fn a_cell_inside_a_large_triangle_has_its_value() {
        let cells = Cells::new(4.0, &LARGE, &[1.0, 2.0]);
        assert_eq!(cells.at([30.0, 10.0]).and_then(|i| cells.values[i]), Some(1.0));
        assert_eq!(cells.at([10.0, 30.0]).and_then(|i| cells.values[i]), Some(2.0));
    }

    #[test]
    fn a_cell_of_many_small_triangles_has_their_mean() {
        let small = |x: f64| [[x, 1.0], [x + 0.5, 1.0], [x, 1.5]];
        let cells = Cells::new(4.0, &[small(1.0), small(1.5), small(2.0)], &[1.0, 2.0, 6.0]);
        assert_eq!(cells.at([2.0, 2.0]).and_then(|i| cells.values[i]), Some(3.0));
    }

    #[test]
    fn every_point_of_the_body_is_in_a_cell_with_a_value() {
        // A triangle that starts and ends just beyond cell borders.
        let cells = Cells::new(4.0, &[[[3.9, 3.9], [20.1, 4.0], [4.0, 20.1]]], &[7.0]);
        for i in 0..=100 {
            for j in 0..=100 - i {
                let [s, t] = [i, j].map(|k| f64::from(k) / 100.0);
                let point = [3.9 + 16.2 * s + 0.1 * t, 3.9 + 0.1 * s + 16.2 * t];
                assert_eq!(cells.at(point).and_then(|i| cells.values[i]), Some(7.0), "{point:?}");
            }
        }
    }

    #[test]
    fn a_row_of_one_level_is_one_rectangle() {
        let cells = Cells::new(4.0, &LARGE, &[1.0, 1.0]);
        let rectangles = cells.rectangles(|value| value as usize);
        let rows = cells.values.len() / cells.columns;
        assert_eq!(rectangles.len(), rows);
        assert!(rectangles.iter().all(|&(level, _)| level == 1));
    }
}
