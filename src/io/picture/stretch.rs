//! By how much displacements are stretched, so that one sees them.

use super::path::distance;
use super::scene::Scene;
use crate::io::numbers::Round;

/// By how much the displacements are stretched.
pub(super) struct Stretch(Option<Round>);

impl Stretch {
    /// True scale if the largest displacement is between 1% and 30% of the body: one sees it, and the body keeps its
    /// shape. True scale also if it is mere rounding, or if a stretched gap would bend the obstacle: a contact line that is
    /// curved, or along which the direction turns, would pull a flat floor out of shape. Otherwise the largest round factor that keeps the
    /// displacement within 10%.
    pub(super) fn of(scene: &Scene) -> Stretch {
        let largest = scene.displacement.iter().map(|&u| distance(u, [0.0; 2])).fold(0.0, f64::max);
        let part = largest / scene.size();
        let small = !(part > 0.3);
        if (0.01..=0.3).contains(&part) || !(part > 1e-12) || (small && scene.contact_turns()) {
            Stretch(None)
        } else {
            Stretch(Some(Round::below(0.1 / part)))
        }
    }

    pub(super) fn factor(&self) -> f64 {
        self.0.map_or(1.0, |round| round.times(1))
    }

    pub(super) fn text(&self) -> String {
        match self.0 {
            None => "deformation at true scale".to_owned(),
            Some(round) => format!("deformation and gap × {}", round.text(1)),
        }
    }
}
