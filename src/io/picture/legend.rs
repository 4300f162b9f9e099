//! What the lines mean, in words.

use svg::Node;
use svg::node::element::Group;

use super::obstacle::hatch;
use super::page::{DARK, GREY, MARGIN, RED, shape, stroke, text, width_of};
use super::path::{Path, Point};
use super::stretch::Stretch;

pub(super) fn legend(stretch: &Stretch, with_obstacle: bool, peak: f64, y: f64) -> Group {
    let mut legend = Legend { group: Group::new(), place: [MARGIN, y] };
    legend.entry("undeformed", |line, _| {
        Group::new().add(stroke(line, GREY, 1.2).set("stroke-dasharray", "6 4"))
    });
    if with_obstacle {
        legend.entry("rigid obstacle", |line, ends| {
            let mut hatching = Path::default();
            hatch(&ends.map(|[x, y]| [x, y - 3.0]), &mut hatching);
            Group::new()
                .set("transform", "translate(0 -3)")
                .add(stroke(hatching, GREY, 0.9))
                .add(stroke(line, DARK, 1.6))
        });
    }
    if peak > 0.0 {
        legend.entry("contact pressure", |line, [[x0, y0], [x1, y1]]| {
            let mut area = Path::default();
            area.polygon([[x0, y0 - 5.0], [x1, y1 - 5.0], [x1, y1 + 5.0], [x0, y0 + 5.0]]);
            Group::new()
                .add(shape(area).set("fill", RED).set("fill-opacity", 0.25))
                .add(stroke(line, RED, 1.5).set("transform", "translate(0 5)"))
        });
    } else {
        legend.words("no contact pressure");
    }
    legend.words(&stretch.text());
    legend.group
}

/// Entries of the legend, one after the other.
struct Legend {
    pub(super) group: Group,
    /// Of the next entry.
    pub(super) place: Point,
}

impl Legend {
    /// What it means in words, and the mark: drawn with a short line, of which the ends are given too.
    fn entry(&mut self, words: &str, mark: impl FnOnce(Path, [Point; 2]) -> Group) {
        let [x, y] = self.place;
        let ends = [[x, y - 4.5], [x + 30.0, y - 4.5]];
        let mut line = Path::default();
        line.line(ends);
        self.group.append(mark(line, ends));
        self.place[0] += 38.0;
        self.words(words);
    }

    fn words(&mut self, words: &str) {
        self.group.append(text(words, self.place));
        self.place[0] += width_of(words, 13.0) + 28.0;
    }
}
