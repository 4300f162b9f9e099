//! Lines on the page: the `d` attribute of an SVG path, and what is placed along a line.

/// A point on the page, y downwards.
pub type Point = [f64; 2];

/// The `d` attribute of a path, in hundredths of the page's unit.
#[derive(Clone, Debug, Default)]
pub struct Path {
    d: String,
}

impl Path {
    /// Nothing was drawn.
    pub fn is_empty(&self) -> bool {
        self.d.is_empty()
    }

    /// A line through these points.
    pub fn line(&mut self, points: impl IntoIterator<Item = Point>) {
        let mut command = 'M';
        for [x, y] in points {
            self.d.push(command);
            self.number(x);
            self.d.push(' ');
            self.number(y);
            command = if command == 'M' { 'L' } else { ' ' };
        }
    }

    /// A line through these points and back to the first.
    pub fn polygon(&mut self, points: impl IntoIterator<Item = Point>) {
        self.line(points);
        self.d.push('Z');
    }

    /// The attribute.
    pub fn into_d(self) -> String {
        self.d
    }

    fn number(&mut self, x: f64) {
        let hundredths = (x * 100.0).round() as i64;
        let (whole, part) = (hundredths.abs() / 100, hundredths.abs() % 100);
        let sign = if hundredths < 0 { "-" } else { "" };
        self.d.push_str(&match (part / 10, part % 10) {
            (0, 0) => format!("{sign}{whole}"),
            (tenths, 0) => format!("{sign}{whole}.{tenths}"),
            _ => format!("{sign}{whole}.{part:02}"),
        });
    }
}

/// The points of a line without those that lie less than half a unit from the one before them; first and last stay.
/// Nobody sees the difference, and the size of the picture no longer depends on the fineness of the mesh.
pub fn thinned(points: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for (i, &p) in points.iter().enumerate() {
        let near = kept.last().is_some_and(|&last| distance(last, p) < 0.5);
        if near && i + 1 < points.len() {
            continue;
        }
        if near && kept.len() > 1 {
            kept.pop();
        }
        kept.push(p);
    }
    kept
}

/// Places along a line, `spacing` apart and as far from either end: the segment and the fraction of it.
pub fn places(points: &[Point], spacing: f64) -> Vec<(usize, f64)> {
    let length: f64 = points.windows(2).map(|w| distance(w[0], w[1])).sum();
    let count = (length / spacing).floor();
    let mut next = (length - (count - 1.0) * spacing) / 2.0;
    let mut start = 0.0;
    let mut places = Vec::new();
    for (i, segment) in points.windows(2).enumerate() {
        let end = start + distance(segment[0], segment[1]);
        while next < end && places.len() < count as usize {
            places.push((i, (next - start) / (end - start)));
            next += spacing;
        }
        start = end;
    }
    places
}

/// The point at a fraction of the way from `a` to `b`.
pub fn between(a: Point, b: Point, fraction: f64) -> Point {
    [a[0] + fraction * (b[0] - a[0]), a[1] + fraction * (b[1] - a[1])]
}

/// `a` + `factor` `d`
pub fn moved(a: Point, d: Point, factor: f64) -> Point {
    [a[0] + factor * d[0], a[1] + factor * d[1]]
}

/// |a - b|
pub fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The direction from `a` to `b`, or nothing if they are the same point.
pub fn direction(a: Point, b: Point) -> Option<Point> {
    let length = distance(a, b);
    (length > 0.0).then(|| [(b[0] - a[0]) / length, (b[1] - a[1]) / length])
}

/// The closed lines that the edges make up, each by its points. An edge goes on where another starts.
pub fn loops(edges: &[[usize; 2]], points: usize) -> Vec<Vec<usize>> {
    let mut from: Vec<Vec<usize>> = vec![Vec::new(); points];
    for &[start, end] in edges.iter().rev() {
        from[start].push(end);
    }
    let mut loops = Vec::new();
    for &[start, _] in edges {
        let mut points = Vec::new();
        let mut at = start;
        while let Some(next) = from[at].pop() {
            points.push(at);
            at = next;
        }
        if !points.is_empty() {
            loops.push(points);
        }
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_have_two_decimals_at_most() {
        let mut path = Path::default();
        path.polygon([[1.0, -2.5], [0.004, -0.006], [123.456, -0.001], [0.1, 100.99]]);
        path.line([[0.0, 0.0], [1.0, 1.0]]);
        assert_eq!(path.into_d(), "M1 -2.5L0 -0.01 123.46 0 0.1 100.99ZM0 0L1 1");
    }

    #[test]
    fn places_are_evenly_spaced_and_centred() {
        let line = [[0.0, 0.0], [4.0, 0.0], [4.0, 6.0]];
        assert_eq!(places(&line, 4.0), [(0, 0.75), (1, 0.5)]);
        assert_eq!(places(&line, 11.0), []);
        assert_eq!(places(&line[..1], 1.0), []);
    }

    #[test]
    fn thinning_keeps_the_ends() {
        let line: Vec<Point> = (0..=100).map(|i| [f64::from(i) * 0.1, 0.0]).collect();
        let kept = thinned(&line);
        assert_eq!(kept.len(), 21);
        assert_eq!((kept[0], kept[20]), (line[0], line[100]));
        assert_eq!(thinned(&[]), Vec::<Point>::new());
    }

    #[test]
    fn loops_use_every_edge_once() {
        // A square with a triangular hole that touches it in vertex 0.
        let edges =
            [[0, 1], [1, 2], [2, 3], [3, 0], [0, 5], [5, 4], [4, 0], [6, 7], [7, 8], [8, 6]];
        assert_eq!(loops(&edges, 9), [vec![0, 1, 2, 3, 0, 5, 4], vec![6, 7, 8]]);
    }
}
