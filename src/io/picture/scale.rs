//! The scale that the pictures of a series have in common, so that two of them can be compared by eye: the magnification, the frame, the colours and
//! the pressures. A picture by itself is a series of one.

use super::body::Colours;
use super::contact::ContactLine;
use super::scene::{ContactSurface, Scene};
use crate::io::files::{NotFinite, check_finite};
use crate::model::tree::Bounds;

#[derive(Clone, Debug)]
pub(super) struct Scale {
    /// The amount by which displacement and gap are magnified.
    pub(super) factor: f64,
    /// The box around all that is drawn of the bodies and their obstacles.
    pub(super) frame: Bounds,
    pub(super) colours: Colours,
    /// The highest pressure that is drawn, and the peak, of the contact boundary of each name.
    pressures: Vec<(String, [f64; 2])>,
}

impl Scale {
    /// The smallest magnification of those that the scenes ask for, and the widest ranges.
    pub(super) fn of(scenes: &[Scene]) -> Result<Scale, NotFinite> {
        let moving = scenes.iter().filter(|scene| scene.moves());
        let factor = moving.map(Scene::magnification).reduce(f64::min).unwrap_or(1.0);
        let colours = scenes.iter().map(Colours::of).reduce(Colours::with).unwrap_or_default();
        let mut pressures: Vec<(String, [f64; 2])> = Vec::new();
        for surface in scenes.iter().flat_map(|scene| &scene.contact) {
            let peak = surface.peak().map_or(0.0, |peak| peak.pressure);
            match pressures.iter_mut().find(|(name, _)| *name == surface.name) {
                Some((_, [top, most])) => (*top, *most) = (top.max(surface.top()), most.max(peak)),
                None => pressures.push((surface.name.clone(), [surface.top(), peak])),
            }
        }
        let mut scale = Scale { factor, frame: Bounds::around([]), colours, pressures };
        let mut drawn = Vec::new();
        for scene in scenes {
            let deformed = scene.deformed(factor);
            check_finite("deformed points", deformed.iter().map(|point| point.as_slice()))?;
            let sides: &[f64] = if scene.of_revolution { &[1.0, -1.0] } else { &[1.0] };
            let around = ContactLine::all(scene, &scale);
            let tips =
                around.iter().flat_map(|line| line.tip.iter().chain(line.wall.iter().flatten()));
            let body = scene.points.iter().chain(&deformed);
            let halves = body.flat_map(|&[x, y]| sides.iter().map(move |side| [side * x, y]));
            let Bounds { low, high } = Bounds::around(halves.chain(tips.copied()));
            drawn.extend([low, high]);
        }
        scale.frame = Bounds::around(drawn);
        Ok(scale)
    }

    /// The highest pressure that is drawn of a boundary, and the peak, 0 if it is pressed in no picture.
    pub(super) fn pressures(&self, surface: &ContactSurface) -> [f64; 2] {
        let found = self.pressures.iter().find(|(name, _)| *name == surface.name);
        found.map_or([0.0; 2], |(_, pressures)| *pressures)
    }
}
