//! What is drawn, as data.

use super::path::{Point, direction, distance, moved};
use crate::io::data::{DataError, check_finite, check_length, check_points};

/// What is drawn.
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
    /// The unit of stress, if the case has units.
    pub unit: Option<&'a str>,
    /// The edges between triangles of different materials.
    pub interfaces: &'a [[usize; 2]],
    /// The edges of the whole boundary, from start to end, the body on their left.
    pub outline: &'a [[usize; 2]],
    /// The connected parts of the contact line, each from start to end, the body on its left. Where the pressure jumps
    /// there are two samples at one place.
    pub contact: &'a [Vec<ContactSample>],
    /// For each of these the number of its surface: parts of one surface share a scale.
    pub surfaces: &'a [usize],
}

/// A point of the contact line.
#[derive(Clone, Copy, Debug)]
pub struct ContactSample {
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

impl Scene<'_> {
    pub(super) fn check(&self) -> Result<(), DataError> {
        if self.triangles.is_empty() {
            return Err(DataError::Empty { name: "triangles".to_owned() });
        }
        let count = self.points.len();
        check_length("displacement", self.displacement.len(), count)?;
        check_length("von_mises", self.von_mises.len(), self.triangles.len())?;
        check_points("triangles", self.triangles.iter().flatten(), count)?;
        check_points("outline", self.outline.iter().flatten(), count)?;
        check_points("interfaces", self.interfaces.iter().flatten(), count)?;
        check_length("surfaces", self.surfaces.len(), self.contact.len())?;
        check_finite("points", self.points.iter().map(<[f64; 2]>::as_slice))?;
        check_finite("displacement", self.displacement.iter().map(<[f64; 2]>::as_slice))?;
        check_finite("von_mises", self.von_mises.chunks(1))?;
        let numbers = |sample: &ContactSample| {
            let ContactSample { position: [x, y], normal: [n, m], displacement: [u, v], .. } =
                *sample;
            [x, y, n, m, u, v, sample.gap, sample.pressure]
        };
        let samples: Vec<[f64; 8]> = self.contact.iter().flatten().map(numbers).collect();
        check_finite("contact", samples.iter().map(<[f64; 8]>::as_slice))
    }

    /// The larger of the body's extents along x and y.
    pub(super) fn size(&self) -> f64 {
        let [low, high] = bounds(self.points.iter().copied());
        (high[0] - low[0]).max(high[1] - low[1])
    }

    pub(super) fn deformed(&self, factor: f64) -> Vec<Point> {
        self.points.iter().zip(self.displacement).map(|(&x, &u)| moved(x, u, factor)).collect()
    }

    pub(super) fn peak(&self) -> f64 {
        self.contact.iter().flatten().map(|sample| sample.pressure).fold(0.0, f64::max)
    }
}

impl Scene<'_> {
    /// A part of the contact line is no straight line with one direction.
    pub(super) fn contact_turns(&self) -> bool {
        let turns = |a: Point, b: Point| distance(a, b) > 1e-6;
        self.contact.iter().any(|part| {
            let mut steps =
                part.windows(2).filter_map(|pair| direction(pair[0].position, pair[1].position));
            let first = steps.next();
            part.windows(2).any(|pair| turns(pair[0].normal, pair[1].normal))
                || steps.any(|step| first.is_some_and(|first| turns(first, step)))
        })
    }
}

/// The lower left and the upper right corner of the box around some points.
pub(super) fn bounds(points: impl IntoIterator<Item = Point>) -> [Point; 2] {
    let empty = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points.into_iter().fold(empty, |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}
