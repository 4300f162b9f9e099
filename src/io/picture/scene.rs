//! The content of a picture as data; by how much it is magnified; and where it lies on the page.

use super::draw::{Point, distance, moved, short};
use crate::fem::tree::Bounds;
use crate::io::numbers::Round;
use crate::io::result::CertifiedZone;

/// The content of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The headline.
    pub title: &'a str,
    /// A line below it.
    pub subtitle: &'a str,
    /// The vertices of the undeformed body.
    pub points: &'a [[f64; 2]],
    /// The displacement of each.
    pub displacement: &'a [[f64; 2]],
    /// The triangles by their vertices. A P2 triangle is drawn as four, cut at the midpoints of its edges.
    pub triangles: &'a [[usize; 3]],
    /// The von Mises stress in each.
    pub von_mises: &'a [f64],
    /// The units of stress and of length, if the case has units.
    pub units: Option<[&'a str; 2]>,
    /// The amount by which displacement and gap are magnified; chosen here if it is not given.
    pub stretch: Option<f64>,
    /// The edges between triangles of different materials.
    pub interfaces: &'a [[usize; 2]],
    /// The edges of the whole boundary, from start to end, the body on their left.
    pub outline: &'a [[usize; 2]],
    /// The contact boundaries.
    pub contact: &'a [ContactSurface],
}

/// A contact boundary.
#[derive(Clone, Debug)]
pub struct ContactSurface {
    /// Its name.
    pub name: String,
    /// Its connected parts, each from start to end, the body on its left. Where the pressure jumps there are two samples at
    /// one place.
    pub parts: Vec<Vec<ContactSample>>,
    /// The proved zones of it; `None` without a certificate.
    pub zones: Option<Vec<CertifiedZone>>,
}

/// A point of a contact boundary.
#[derive(Clone, Copy, Debug)]
pub struct ContactSample {
    /// Arc length along the boundary.
    pub arc: f64,
    /// The place in the undeformed body.
    pub position: [f64; 2],
    /// The unit outward normal there.
    pub normal: [f64; 2],
    /// u
    pub displacement: [f64; 2],
    /// The gap g.
    pub gap: f64,
    /// The recovered pressure, >= 0.
    pub pressure: f64,
}

impl ContactSurface {
    /// The sample with the largest pressure, if that is positive.
    pub(super) fn peak(&self) -> Option<&ContactSample> {
        let largest = self.parts.iter().flatten().max_by(|a, b| a.pressure.total_cmp(&b.pressure));
        largest.filter(|sample| sample.pressure > 0.0)
    }
}

impl Scene<'_> {
    /// The larger of the body's extents along x and y.
    pub(super) fn size(&self) -> f64 {
        Bounds::around(self.points.iter().copied()).size()
    }

    pub(super) fn deformed(&self, factor: f64) -> Vec<Point> {
        self.points.iter().zip(self.displacement).map(|(&x, &u)| moved(x, u, factor)).collect()
    }

    /// The amount by which displacement and gap are magnified, and the words for it. True scale if the largest displacement is
    /// between 1% and 30% of the body, so that one sees it and the body keeps its shape, or if it is mere rounding; else the
    /// largest round factor that keeps it within 10%.
    pub(super) fn magnification(&self) -> (f64, String) {
        let words = |factor: &str| format!("deformation and gap × {factor}");
        let largest = self.displacement.iter().map(|&u| distance(u, [0.0; 2])).fold(0.0, f64::max);
        let part = largest / self.size();
        match self.stretch {
            Some(factor) if factor != 1.0 => (factor, words(&short(factor))),
            None if !(0.01..=0.3).contains(&part) && part > 1e-12 => {
                let round = Round::below(0.1 / part);
                (round.times(1), words(&round.text(1)))
            }
            _ => (1.0, "deformation at true scale".to_owned()),
        }
    }
}

/// The drawing of the body on the page: the map from the plane, and the room that it takes.
pub(super) struct PageMap {
    corner: Point,
    scale: f64,
    /// The point at the centre of the drawing.
    centre: Point,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// The room around the drawing, for the letters of the contact boundaries.
const AROUND: f64 = 34.0;

impl PageMap {
    /// Makes the map of a drawing around some points of the plane, its upper left corner on the page at `corner`.
    pub(super) fn around(points: impl IntoIterator<Item = Point>, corner: Point) -> PageMap {
        let Bounds { low, high } = Bounds::around(points);
        let extent = [0, 1].map(|c| high[c] - low[c]);
        let room = [800.0, 520.0].map(|most| most - 2.0 * AROUND);
        let scale = (room[0] / extent[0]).min(room[1] / extent[1]);
        let scale = if scale.is_finite() { scale } else { 1.0 };
        PageMap {
            corner,
            scale,
            centre: [0, 1].map(|c| low[c] + extent[c] / 2.0),
            width: (scale * extent[0] + 2.0 * AROUND).clamp(600.0, 800.0),
            height: (scale * extent[1] + 2.0 * AROUND).clamp(260.0, 520.0),
        }
    }

    pub(super) fn page(&self, [x, y]: Point) -> Point {
        [
            self.corner[0] + self.width / 2.0 + self.scale * (x - self.centre[0]),
            self.corner[1] + self.height / 2.0 - self.scale * (y - self.centre[1]),
        ]
    }

    /// Returns whether a circle lies within the frame.
    pub(super) fn holds(&self, [x, y]: Point, radius: f64) -> bool {
        let [left, top] = self.corner;
        (left + radius..=left + self.width - radius).contains(&x)
            && (top + radius..=top + self.height - radius).contains(&y)
    }
}
