//! The rigid motions that the prescribed displacements leave free.
//!
//! A *part* is a set of triangles connected by edges: it deforms as one, and a(v, v) = 0 on it for its rigid motions
//! only,
//!
//! v(x) = t + w (-(y - c_y), x - c_x):  a translation t and a rotation w, three unknowns a part.
//!
//! Parts have no vertex in common (`Mesh` refuses that: in H^1 a point holds nothing), so each is free or not by itself.
//! A prescribed component of a node is one equation for the part that has the node. The motions that satisfy all these
//! equations with zero data are free: with them a(., .) is not definite.
//!
//! In a body of revolution the hoop strain of a motion of the meridian is zero only if v_r is zero on the mean of each triangle (P2:
//! everywhere): a translation along the axis is left, and a rotation of a single row of triangles.
//!
//! The system is scaled to be independent of units and place: c is the middle of the part's own box, w is measured by the
//! displacement that it makes at the distance of the box's half side. Coordinates enter as differences within one part
//! only. The rank of a part's equations is that of their singular values.

use std::collections::BTreeMap;
use std::fmt;

use crate::linear::dense::singular_vectors;
use crate::model::element::Degree;
use crate::model::mesh::Mesh;
use crate::model::space::Space;
use crate::model::tree::Bounds;

/// The parts of a body.
#[derive(Clone, Debug)]
pub struct Parts {
    of_triangle: Vec<usize>,
    frames: Vec<PartFrame>,
}

/// A part's own coordinates, and a place to name it by.
#[derive(Clone, Copy, Debug)]
struct PartFrame {
    centre: [f64; 2],
    half: f64,
    place: [f64; 2],
}

/// A rigid motion of one part that no prescribed displacement stops, v(x) = shift + turn (-(y - c_y), x - c_x), and of others that
/// move with it; the rest stands still.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeMotion {
    /// The number of the part.
    pub(crate) part: usize,
    /// c, the middle of the part's box.
    pub(crate) centre: [f64; 2],
    /// The displacement at c.
    pub(crate) shift: [f64; 2],
    /// The angle, in 1 / length for a displacement without unit.
    pub(crate) turn: f64,
    /// Half the longer side of the part's box.
    half: f64,
    /// Where the part is, if the body has several.
    place: Option<[f64; 2]>,
    /// The motions of other parts at the same time.
    pub(crate) others: Vec<FreeMotion>,
}

/// The share of the largest singular value below which a singular value stops no motion. The same share decides that a
/// component of a motion is zero beside its largest, and the work of the loads on a motion beside the largest work of single
/// loads. Rounding leaves some 1e-15; a part of
/// slenderness s held at its end alone makes 1/s, so that one of 1e9 is held. And the smallest eigenvalue of a material below this
/// share of the largest leaves no digits of what it does to the strains that belong to it. A
/// solve is done when its last correction is as small beside the displacement, and what its forces are out of balance beside them.
pub(crate) const NEGLIGIBLE: f64 = 1e-10;

impl FreeMotion {
    /// The displacement at `x`.
    pub fn at(&self, x: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = [x[0] - self.centre[0], x[1] - self.centre[1]];
        [self.shift[0] - self.turn * dy, self.shift[1] + self.turn * dx]
    }

    /// The motions of all parts that move.
    fn all(&self) -> impl Iterator<Item = &FreeMotion> {
        std::iter::once(self).chain(&self.others)
    }

    /// The displacement at `x` if that is a point of `part`.
    pub(crate) fn at_point_of(&self, part: usize, x: [f64; 2]) -> [f64; 2] {
        self.all().find(|motion| motion.part == part).map_or([0.0; 2], |motion| motion.at(x))
    }

    /// The motion as a field: its nodal values.
    pub(crate) fn field(&self, parts: &Parts, space: &Space) -> Vec<[f64; 2]> {
        let mut field = vec![[0.0; 2]; space.nodes().len()];
        for (nodes, &part) in space.elements().zip(&parts.of_triangle) {
            if self.all().any(|motion| motion.part == part) {
                for &node in nodes {
                    field[node] = self.at_point_of(part, space.nodes()[node]);
                }
            }
        }
        field
    }

    /// Returns whether all parts that move do so as one rigid body.
    fn is_of_one_body(&self) -> bool {
        self.others.iter().all(|other| {
            let size = other.half.max(self.half);
            let [there, here] = [other.at(other.centre), self.at(other.centre)];
            let shifted = (there[0] - here[0]).hypot(there[1] - here[1]);
            let turned = (other.turn - self.turn).abs() * size;
            shifted.max(turned) <= SAME_MOTION * (here[0].hypot(here[1]) + self.turn.abs() * size)
        })
    }

    /// The centre of the rotation; `None` for a translation.
    pub(crate) fn about(&self) -> Option<[f64; 2]> {
        let ([sx, sy], turn) = (self.shift, self.turn);
        (turn != 0.0).then(|| [self.centre[0] - sy / turn, self.centre[1] + sx / turn])
    }

    /// The distance of a translation, or the angle of a rotation, counter-clockwise.
    pub(crate) fn size(&self) -> f64 {
        if self.turn == 0.0 { self.shift[0].hypot(self.shift[1]) } else { self.turn }
    }

    /// The body has several parts, of which one moves.
    pub(crate) fn is_of_one_of_several(&self) -> bool {
        self.place.is_some()
    }

    /// A support that would stop it.
    pub fn remedy(&self) -> String {
        match self.about() {
            Some(about) => {
                let [x, y] = about.map(|c| rounded(c, self.half));
                format!("u_x off the line y = {y} would stop it, or u_y off x = {x}")
            }
            None => {
                let norm = self.shift[0].hypot(self.shift[1]);
                let stopping = match self.shift.map(|c| c.abs() > NEGLIGIBLE * norm) {
                    [true, true] => "u_x or u_y",
                    [true, false] => "u_x",
                    _ => "u_y",
                };
                format!("{stopping} would stop it")
            }
        }
    }
}

/// Describes the motion in words.
impl fmt::Display for FreeMotion {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.about() {
            Some(about) => write!(f, "rotation about {}", point(about, self.half))?,
            None => {
                let norm = self.shift[0].hypot(self.shift[1]);
                write!(f, "translation along {}", point(self.shift.map(|c| c / norm), 1.0))?;
            }
        }
        let places: Vec<String> =
            self.all().filter_map(|m| m.place.map(|place| point(place, m.half))).collect();
        match &places[..] {
            [] => Ok(()),
            [place] => write!(f, " of the part of the body at {place}"),
            [first, rest @ ..] if !self.is_of_one_body() => {
                write!(f, " of the part of the body at {first}, with which others move, at ")?;
                write!(f, "{}", rest.join(" and "))
            }
            all => {
                let bodies = if all.len() == 2 { "both bodies" } else { "these bodies" };
                write!(f, " of the parts of the body at {}: ", all.join(" and "))?;
                write!(f, "{bodies} move together")
            }
        }
    }
}

impl Parts {
    /// The parts of the body that `mesh` covers.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let of_triangle = mesh.parts().to_vec();
        let count = of_triangle.iter().max().map_or(0, |last| last + 1);
        let mut boxes = vec![Bounds::around([]); count];
        let mut places = vec![None; count];
        for (t, &part) in of_triangle.iter().enumerate() {
            let triangle = mesh.triangle(t);
            places[part].get_or_insert_with(|| triangle.point([1.0 / 3.0; 3]).into());
            let corners = Bounds::around(triangle.vertices.map(Into::into));
            boxes[part] = boxes[part].with(corners);
        }
        let frames = boxes.iter().zip(places).map(|(Bounds { low, high }, place)| {
            let halves = [0, 1].map(|c| high[c] / 2.0 - low[c] / 2.0);
            let centre = [0, 1].map(|c| low[c] + halves[c]);
            PartFrame { centre, half: halves[0].max(halves[1]), place: place.unwrap_or(centre) }
        });
        Parts { frames: frames.collect(), of_triangle }
    }

    /// The number of them.
    pub(crate) fn count(&self) -> usize {
        self.frames.len()
    }

    /// The part of each triangle.
    pub(crate) fn of_triangle(&self) -> &[usize] {
        &self.of_triangle
    }

    /// The coefficients of the motion of `part` (t_x, t_y, w) in component `c` of the displacement at `x`.
    fn row(&self, part: usize, x: [f64; 2], c: usize) -> [f64; 3] {
        let PartFrame { centre, half, .. } = self.frames[part];
        match c {
            0 => [1.0, 0.0, -(x[1] - centre[1]) / half],
            _ => [0.0, 1.0, (x[0] - centre[0]) / half],
        }
    }

    /// The motion (t_x, t_y, w) of a part, the largest of its coefficients made 1.
    fn motion(&self, part: usize, values: [f64; 3]) -> FreeMotion {
        self.motion_beside(part, values, values.iter().fold(0.0, |max: f64, v| max.max(v.abs())))
    }

    /// The motion (t_x, t_y, w) of a part, divided by `largest`.
    fn motion_beside(&self, part: usize, values: [f64; 3], largest: f64) -> FreeMotion {
        let [x, y, w] =
            values.map(|v| if v.abs() <= NEGLIGIBLE * largest { 0.0 } else { v / largest });
        let PartFrame { centre, half, place } = self.frames[part];
        let place = (self.count() > 1).then_some(place);
        FreeMotion { part, centre, shift: [x, y], turn: w / half, half, place, others: Vec::new() }
    }

    /// The sum of these motions, each times its weight, with the largest coefficient made 1.
    pub(crate) fn combined(&self, motions: &[FreeMotion], weights: &[f64]) -> FreeMotion {
        let mut of_parts: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        for (motion, weight) in motions.iter().zip(weights) {
            for motion in motion.all() {
                let [x, y] = motion.shift;
                let values = of_parts.entry(motion.part).or_default();
                for (value, of) in values.iter_mut().zip([x, y, motion.turn * motion.half]) {
                    *value += weight * of;
                }
            }
        }
        let all = of_parts.values().flatten();
        let largest = all.fold(0.0, |max: f64, v| max.max(v.abs()));
        let moves = |values: &[f64; 3]| values.iter().any(|v| v.abs() > NEGLIGIBLE * largest);
        let mut moving = of_parts.iter().filter(|(_, values)| moves(values));
        let (part, values) = moving.next().map_or((0, [0.0; 3]), |(part, values)| (*part, *values));
        let others = moving.map(|(part, values)| self.motion_beside(*part, *values, largest));
        FreeMotion { others: others.collect(), ..self.motion_beside(part, values, largest) }
    }
}

/// A basis, part by part, of the rigid motions that are free when each node is held in its directions `held`, which may be off
/// by `rounding`; empty if the body is held. With `of_revolution` the hoop strain holds the body, too.
pub(crate) fn free_motions<I>(
    parts: &Parts,
    space: &Space,
    held: impl Fn(usize) -> I,
    rounding: f64,
    of_revolution: bool,
) -> Vec<FreeMotion>
where
    I: Iterator<Item = [f64; 2]>,
{
    let mut rows = vec![Vec::new(); parts.count()];
    let mut seen = vec![false; space.nodes().len()];
    for (nodes, &part) in space.elements().zip(&parts.of_triangle) {
        for &node in nodes {
            if std::mem::replace(&mut seen[node], true) {
                continue;
            }
            for d in held(node) {
                let [a, b] = [0, 1].map(|c| parts.row(part, space.nodes()[node], c));
                rows[part].push((0..3).map(|k| d[0] * a[k] + d[1] * b[k]).collect());
            }
        }
    }
    if of_revolution {
        // The rows of a part are affine in the height: those of the lowest and of the highest triangle span all.
        let mut ends: Vec<Option<[[f64; 2]; 2]>> = vec![None; parts.count()];
        for (t, &part) in parts.of_triangle.iter().enumerate() {
            let middle: [f64; 2] = space.mesh().triangle(t).point([1.0 / 3.0; 3]).into();
            let [low, high] = ends[part].get_or_insert([middle; 2]);
            *low = if middle[1] < low[1] { middle } else { *low };
            *high = if middle[1] > high[1] { middle } else { *high };
        }
        for (part, ends) in ends.iter().enumerate() {
            let ends = ends.iter().flatten();
            rows[part].extend(ends.map(|&middle| parts.row(part, middle, 0).to_vec()));
        }
        if space.degree() == Degree::Two {
            rows.iter_mut().for_each(|rows| rows.push(vec![0.0, 0.0, 1.0]));
        }
    }
    let mut motions = Vec::new();
    for (part, rows) in rows.iter().enumerate() {
        let stops = |value: f64, largest: f64| value > rounding.max(NEGLIGIBLE) * largest;
        let free = null_space(rows, 3, stops);
        motions.extend(free.iter().map(|v| parts.motion(part, [v[0], v[1], v[2]])));
    }
    motions
}

/// The relative difference below which motions of two parts are the same: singular vectors have some 1e-15 of rounding, rows of
/// rounded places more.
const SAME_MOTION: f64 = 1e-6;

/// The solutions of homogeneous equations in `count` unknowns, given by their rows: a basis in which as many unknowns as can be are
/// zero. A direction in which the equations have a singular value that `stops` is not free, beside the
/// largest value.
pub(crate) fn null_space(
    rows: &[Vec<f64>],
    count: usize,
    stops: impl Fn(f64, f64) -> bool,
) -> Vec<Vec<f64>> {
    let directions = singular_vectors(rows, count);
    let largest = directions.first().map_or(0.0, |(value, _)| *value);
    let stopped: Vec<Vec<f64>> =
        directions.into_iter().filter(|d| stops(d.0, largest)).map(|d| d.1).collect();
    let unit = |k: usize| (0..count).map(|j| f64::from(u8::from(j == k))).collect::<Vec<f64>>();
    match &stopped[..] {
        [] => (0..count).map(unit).collect(),
        [v] => {
            let pivot = (0..count).find(|&k| v[k].abs() > NEGLIGIBLE).unwrap_or(0);
            let motion = |k: usize| {
                let mut motion = unit(k);
                motion[pivot] = -v[k] / v[pivot];
                motion
            };
            (0..count).filter(|&k| k != pivot).map(motion).collect()
        }
        [a, b] if count == 3 => {
            let minor = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
            let [x, y, w] = [minor(1, 2), minor(2, 0), minor(0, 1)];
            let last = [w, y, x].into_iter().find(|c| c.abs() > NEGLIGIBLE).unwrap_or(1.0);
            vec![[x, y, w].map(|c| c / last).to_vec()]
        }
        _ => eliminated(stopped, count),
    }
}

/// The vectors that these independent rows multiply to zero, one for each unknown that is no pivot of an elimination.
fn eliminated(mut rows: Vec<Vec<f64>>, count: usize) -> Vec<Vec<f64>> {
    let mut pivots: Vec<usize> = Vec::new();
    for k in 0..rows.len() {
        let places = (k..rows.len()).flat_map(|i| (0..count).map(move |j| (i, j)));
        let size = |&(i, j): &(usize, usize)| rows[i][j].abs();
        let fresh = places.filter(|(_, j)| !pivots.contains(j));
        let Some((i, pivot)) = fresh.max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
        rows.swap(k, i);
        pivots.push(pivot);
        let divisor = rows[k][pivot];
        rows[k].iter_mut().for_each(|entry| *entry /= divisor);
        let row = rows[k].clone();
        for other in (0..rows.len()).filter(|&other| other != k) {
            let factor = rows[other][pivot];
            rows[other].iter_mut().zip(&row).for_each(|(entry, own)| *entry -= factor * own);
        }
    }
    let vector = |free: usize| {
        let mut vector = vec![0.0; count];
        vector[free] = 1.0;
        for (row, &pivot) in rows.iter().zip(&pivots) {
            vector[pivot] = if row[free].abs() > NEGLIGIBLE { -row[free] } else { 0.0 };
        }
        vector
    };
    (0..count).filter(|k| !pivots.contains(k)).map(vector).collect()
}

/// A place in a body of this size, to six digits of the size.
fn point(x: [f64; 2], size: f64) -> String {
    let [x, y] = x.map(|c| rounded(c, size));
    format!("({x}, {y})")
}

fn rounded(c: f64, size: f64) -> String {
    let decimals = (5.0 - size.log10().floor()).clamp(0.0, 400.0) as usize;
    // Reading the decimals back gives the shortest number; adding 0.0 avoids -0.
    let short = format!("{c:.decimals$}").parse().unwrap_or(c) + 0.0;
    if short == 0.0 || (1e-5..1e16).contains(&short.abs()) {
        format!("{short}")
    } else {
        format!("{short:e}")
    }
}

/// field <- field - weight * other
pub(crate) fn subtract(field: &mut [[f64; 2]], other: &[[f64; 2]], weight: f64) {
    for (f, o) in field.as_flattened_mut().iter_mut().zip(other.as_flattened()) {
        *f -= weight * o;
    }
}

/// One component of a node for each slide, so that no slide is left free when these components are held: those among
/// `free` that move most.
pub(crate) fn pins(
    slides: &[Vec<[f64; 2]>],
    free: impl Fn(usize, usize) -> bool,
) -> Vec<(usize, usize)> {
    let mut left = slides.to_vec();
    let mut pins = Vec::with_capacity(left.len());
    while let Some(slide) = left.pop() {
        let components = (0..slide.len()).flat_map(|node| [(node, 0), (node, 1)]);
        let size = |&(node, c): &(usize, usize)| slide[node][c].abs();
        let most =
            components.filter(|&(n, c)| free(n, c)).max_by(|a, b| size(a).total_cmp(&size(b)));
        let Some((node, c)) = most else { continue };
        for other in &mut left {
            let weight = other[node][c] / slide[node][c];
            subtract(other, &slide, weight);
        }
        pins.push((node, c));
    }
    pins
}

#[cfg(test)]
mod tests {
    use approx::abs_diff_eq;

    use super::*;
    use crate::model::{Diagonal, Rectangle};

    /// The remainder of a motion of size 1 where it is stopped: components below [`NEGLIGIBLE`] are set to zero, and slender
    /// parts have coordinates of up to 10 times their half box.
    const STOPPED: f64 = 1e-8;

    /// How many motions of a block of cells are free with elements of a degree; in each of them what is held stands still.
    fn free(
        (width, [nx, ny]): (f64, [usize; 2]),
        degree: Degree,
        held: impl Fn([f64; 2]) -> [bool; 2],
    ) -> usize {
        let cells = Rectangle { width, height: ny as f64, nx, ny, diagonal: Diagonal::Right };
        let mesh = cells.mesh().unwrap();
        let space = Space::new(&mesh, degree);
        let directions = |node: usize| {
            let axes = held(space.nodes()[node]).into_iter().zip([[1.0, 0.0], [0.0, 1.0]]);
            axes.filter(|(held, _)| *held).map(|(_, axis)| axis)
        };
        let parts = Parts::new(&mesh);
        let motions = free_motions(&parts, &space, directions, 0.0, false);
        for motion in &motions {
            let field = motion.field(&parts, &space);
            for (x, u) in space.nodes().iter().zip(&field) {
                for c in 0..2 {
                    let still = abs_diff_eq!(u[c], 0.0, epsilon = STOPPED);
                    assert!(!held(*x)[c] || still, "{u:?} at {x:?}: {motion}");
                }
            }
            assert!(field.iter().any(|u| u[0].hypot(u[1]) > 1e-3), "{motion} moves");
        }
        motions.len()
    }

    #[test]
    fn a_point_that_one_component_holds_leaves_two_motions_in_which_it_stays() {
        for degree in [Degree::One, Degree::Two] {
            for held in [[true, false], [false, true]] {
                let at_corner = |x: [f64; 2]| held.map(|held| held && x == [3.0, 2.0]);
                assert_eq!(free((3.0, [3, 2]), degree, at_corner), 2);
            }
        }
    }

    #[test]
    fn slender_parts_held_at_one_end_are_held() {
        for degree in [Degree::One, Degree::Two] {
            for slenderness in [1e2, 1e4, 1e6] {
                let strip = (8.0 * slenderness, [8, 1]);
                assert_eq!(free(strip, degree, |[x, _]| [x == 0.0; 2]), 0);
                assert_eq!(free(strip, degree, |[x, y]| [x == 0.0 && y == 0.0; 2]), 1);
            }
        }
    }

    #[test]
    fn parts_move_as_one_body_if_they_shift_and_turn_alike() {
        let part = |part: usize, turn: f64, shift: [f64; 2]| FreeMotion {
            part,
            centre: [part as f64, 0.0],
            shift,
            turn,
            half: 0.5,
            place: None,
            others: Vec::new(),
        };
        let are_one = |own: FreeMotion, other: FreeMotion| {
            FreeMotion { others: vec![other], ..own }.is_of_one_body()
        };
        // About the centre of the first part, 1 away from that of the second.
        assert!(are_one(part(0, 0.5, [0.0; 2]), part(1, 0.5, [0.0, 0.5])));
        assert!(are_one(part(0, 0.0, [0.3, -0.4]), part(1, 0.0, [0.3, -0.4])));
        assert!(!are_one(part(0, 0.5, [0.0; 2]), part(1, -0.5, [0.0, 0.5])), "the other way");
        assert!(!are_one(part(0, 0.5, [0.0; 2]), part(1, 0.4, [0.0, 0.5])), "less");
        assert!(!are_one(part(0, 0.5, [0.0; 2]), part(1, 0.5, [0.0, -0.5])), "to the other side");
        assert!(!are_one(part(0, 0.0, [0.3, -0.4]), part(1, 0.0, [0.3, 0.4])));
    }
}
