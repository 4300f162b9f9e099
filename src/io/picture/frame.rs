//! From the plane to the page.

use super::contact_line::ContactLine;
use super::page::{HEADER, MARGIN};
use super::path::Point;
use super::pressure::room_beside;
use super::scene::{Scene, bounds};

/// From the plane to the page.
pub(super) struct Frame {
    pub(super) scale: f64,
    /// What is at the centre of the drawing.
    pub(super) centre: Point,
    /// The size of the drawing on the page.
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Frame {
    /// Around all that is drawn, with space for the words at the highest pressure.
    pub(super) fn around(scene: &Scene, deformed: &[Point], contact: &[ContactLine]) -> Frame {
        let lines = contact
            .iter()
            .flat_map(|line| line.tip.iter().copied().chain(line.wall.iter().flatten().copied()));
        let [low, high] = bounds(scene.points.iter().chain(deformed).copied().chain(lines));
        let sideways = scene.contact.iter().flatten().any(|s| s.normal[0].abs() > 0.5);
        let beside = contact.iter().map(|line| room_beside(line, scene.unit)).fold(80.0, f64::max);
        let space = [2.0 * if sideways { beside } else { 20.0 }, 2.0 * 34.0];
        let extent = [0, 1].map(|c| high[c] - low[c]);
        let room = [800.0 - space[0], 560.0 - space[1]];
        let scale = (room[0] / extent[0]).min(room[1] / extent[1]);
        let scale = if scale.is_finite() { scale } else { 1.0 };
        Frame {
            scale,
            centre: [0, 1].map(|c| low[c] + extent[c] / 2.0),
            width: (scale * extent[0] + space[0]).clamp(600.0, 800.0),
            height: (scale * extent[1] + space[1]).clamp(260.0, 560.0),
        }
    }

    pub(super) fn page(&self, [x, y]: Point) -> Point {
        [
            MARGIN + self.width / 2.0 + self.scale * (x - self.centre[0]),
            HEADER + self.height / 2.0 - self.scale * (y - self.centre[1]),
        ]
    }
}
