//! The contact line with its pressure and its obstacle, as it is drawn.

use super::path::{Point, moved};
use super::scene::{ContactSample, Scene};

/// A part of the contact line as it is drawn: for each sample the deformed point, the end of its pressure, and the point
/// of the obstacle.
pub(super) struct ContactLine {
    pub(super) surface: usize,
    pub(super) base: Vec<Point>,
    pub(super) tip: Vec<Point>,
    pub(super) wall: Vec<Option<Point>>,
    pub(super) pressure: Vec<f64>,
}

/// The largest pressure is drawn as high as this part of the body's size.
const HIGHEST: f64 = 0.15;

/// Of a hollow line's radius, at most so much: arrows along its normals meet at the centre.
const OF_THE_RADIUS: f64 = 0.6;

/// An obstacle further from the undeformed body than this part of the body's size is left out.
const FURTHEST: f64 = 0.2;

impl ContactLine {
    pub(super) fn all(scene: &Scene, factor: f64) -> Vec<ContactLine> {
        let size = scene.size();
        let mut lines: Vec<(ContactLine, Vec<Point>)> = Vec::with_capacity(scene.contact.len());
        for (samples, &surface) in scene.contact.iter().zip(scene.surfaces) {
            let normals = smooth_normals(samples);
            let base: Vec<Point> =
                samples.iter().map(|s| moved(s.position, s.displacement, factor)).collect();
            let wall = |(s, &n): (&ContactSample, &Point)| {
                let gap = factor * s.gap;
                (gap.abs() <= FURTHEST * size).then(|| moved(s.position, n, gap))
            };
            let line = ContactLine {
                surface,
                tip: base.clone(),
                wall: samples.iter().zip(&normals).map(wall).collect(),
                pressure: samples.iter().map(|s| s.pressure).collect(),
                base,
            };
            lines.push((line, normals));
        }
        let heights: Vec<f64> = lines.iter().map(|(line, _)| height(&lines, line, size)).collect();
        for ((line, normals), height) in lines.iter_mut().zip(heights) {
            for (i, tip) in line.tip.iter_mut().enumerate() {
                *tip = moved(line.base[i], normals[i], height * line.pressure[i]);
            }
        }
        lines.into_iter().map(|(line, _)| line).collect()
    }

    pub(super) fn peak(&self) -> f64 {
        self.pressure.iter().copied().fold(0.0, f64::max)
    }

    /// The same line with its points on the page.
    pub(super) fn on(self, page: impl Fn(Point) -> Point) -> ContactLine {
        let all = |points: Vec<Point>| points.into_iter().map(&page).collect();
        ContactLine {
            surface: self.surface,
            base: all(self.base),
            tip: all(self.tip),
            wall: self.wall.into_iter().map(|p| p.map(&page)).collect(),
            pressure: self.pressure,
        }
    }

    /// The steps of the curve of the pressure.
    pub(super) fn pressed_tips(&self) -> impl Iterator<Item = [Point; 2]> {
        let step = |i: usize| [self.tip[i], self.tip[i + 1]];
        self.pressed().into_iter().flat_map(move |range| (*range.start()..*range.end()).map(step))
    }

    /// Where the pressure is positive, with the sample before and the one after.
    pub(super) fn pressed(&self) -> Vec<std::ops::RangeInclusive<usize>> {
        let mut ranges = Vec::new();
        let mut start = 0;
        for run in self.pressure.chunk_by(|&a, &b| (a > 0.0) == (b > 0.0)) {
            let end = start + run.len();
            if run.first().is_some_and(|&pressure| pressure > 0.0) {
                ranges.push(start.saturating_sub(1)..=end.min(self.pressure.len() - 1));
            }
            start = end;
        }
        ranges
    }
}

/// The height of a unit of pressure on the surface of a line.
fn height(lines: &[(ContactLine, Vec<Point>)], line: &ContactLine, size: f64) -> f64 {
    let (mut peak, mut highest) = (0.0_f64, HIGHEST * size);
    for (other, normals) in lines.iter().filter(|(other, _)| other.surface == line.surface) {
        peak = peak.max(other.peak());
        for (base, n) in other.base.windows(2).zip(normals.windows(2)) {
            let step = [base[1][0] - base[0][0], base[1][1] - base[0][1]];
            let turn = [n[1][0] - n[0][0], n[1][1] - n[0][1]];
            let closing = -(step[0] * turn[0] + step[1] * turn[1]);
            if closing > 0.0 {
                let radius = (step[0] * step[0] + step[1] * step[1]) / closing;
                highest = highest.min(OF_THE_RADIUS * radius);
            }
        }
    }
    if peak > 0.0 { highest / peak } else { 0.0 }
}

/// The normals, except that two samples at one place share the mean of theirs: the facets of a curved line would otherwise
/// show as steps. A true corner (more than 45 degrees) stays one.
fn smooth_normals(samples: &[ContactSample]) -> Vec<Point> {
    let mut normals: Vec<Point> = samples.iter().map(|s| s.normal).collect();
    for i in 1..samples.len() {
        let ([a, b], [c, d]) = (normals[i - 1], normals[i]);
        if samples[i - 1].position == samples[i].position && a * c + b * d > 0.7 {
            let length = (a + c).hypot(b + d);
            normals[i - 1] = [(a + c) / length, (b + d) / length];
            normals[i] = normals[i - 1];
        }
    }
    normals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_share_their_normal_and_corners_do_not() {
        let sample = |position, normal| ContactSample {
            position,
            normal,
            displacement: [0.0; 2],
            gap: 0.0,
            pressure: 0.0,
        };
        let line = [
            sample([0.0, 0.0], [0.6, -0.8]),
            sample([0.0, 0.0], [0.8, -0.6]),
            sample([1.0, 0.0], [0.8, -0.6]),
            sample([1.0, 0.0], [0.6, 0.8]),
        ];
        let [a, b, c, d] = smooth_normals(&line).try_into().unwrap();
        assert_eq!(a, b);
        assert!((a[0] + a[1]).abs() < 1e-15 && (a[0].hypot(a[1]) - 1.0).abs() < 1e-15);
        assert_eq!([c, d], [[0.8, -0.6], [0.6, 0.8]]);
    }
}
