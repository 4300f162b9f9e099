//! The obstacle: its border, hatched.

use svg::node::element::Group;

use super::contact_line::ContactLine;
use super::page::{DARK, GREY, stroke};
use super::path::{Path, Point, between, direction, moved, places, thinned};

/// The obstacle's border, hatched on its side.
pub(super) fn obstacle(contact: &[ContactLine]) -> Option<Group> {
    let (mut border, mut hatching) = (Path::default(), Path::default());
    for line in contact {
        for run in line.wall.chunk_by(|a, b| a.is_some() == b.is_some()) {
            let run: Vec<Point> = run.iter().flatten().copied().collect();
            let run = thinned(&run);
            if run.len() > 1 {
                hatch(&run, &mut hatching);
                border.line(run);
            }
        }
    }
    (!border.is_empty())
        .then(|| Group::new().add(stroke(hatching, GREY, 0.9)).add(stroke(border, DARK, 1.6)))
}

pub(super) fn hatch(border: &[Point], hatching: &mut Path) {
    for (i, fraction) in places(border, 8.0) {
        let (a, b) = (border[i], border[i + 1]);
        if let Some([x, y]) = direction(a, b) {
            // The body is on the left, so the obstacle is on the right.
            let foot = between(a, b, fraction);
            hatching.line([foot, moved(foot, [-y - 0.8 * x, x - 0.8 * y], 10.0)]);
        }
    }
}
