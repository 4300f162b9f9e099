//! The rigid motions that the prescribed displacements leave free.
//!
//! A *part* is a set of triangles connected by edges: it deforms as one, and a(v, v) = 0 on it for its rigid motions
//! only,
//!
//! v(x) = t + w (-(y - c_y), x - c_x):  a translation t and a rotation w, three unknowns a part.
//!
//! Parts that share a vertex without an edge are hinged there: v is continuous, so their motions agree at the vertex (two
//! equations), but each may turn. A prescribed component of a node is one equation for each part that has the node. The
//! motions that satisfy all these equations with zero data are free: with them a(., .) is not definite.
//!
//! The system is scaled to be independent of units and place: c is the middle of the part's own box, w is measured by the
//! displacement that it makes at the distance of the box's half side. Coordinates enter as differences within one part
//! only. Parts are eliminated one after the other, those with the fewest neighbours first, by orthogonal
//! transformations of the equations in which they occur; a column that its equations leave at zero is a free parameter
//! (multifrontal QR with the rank found column by column, after Heath 1982). Its null vector follows by substitution back.

mod connected;
mod null_space;

use std::collections::BTreeMap;
use std::fmt;

use super::dense::singular_vectors;
use super::mesh::Mesh;
use super::space::Space;
use crate::kernel::Element;
use connected::{connected_by_edges, hinges};
use null_space::{Dense, null_space};

/// The parts of a body, and where they are hinged to each other.
#[derive(Clone, Debug)]
pub struct Parts {
    of_triangle: Vec<usize>,
    frames: Vec<Frame>,
    hinges: Vec<Hinge>,
}

/// A part's own coordinates, and a place to name it by.
#[derive(Clone, Copy, Debug)]
struct Frame {
    centre: [f64; 2],
    half: f64,
    place: [f64; 2],
}

/// A vertex in which several parts meet without an edge in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Hinge {
    /// The vertex.
    pub vertex: usize,
    /// The parts, each once, in increasing order.
    pub parts: Vec<usize>,
}

/// A rigid motion of one part: v(x) = shift + turn (-(y - c_y), x - c_x).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartMotion {
    /// The number of the part.
    pub part: usize,
    /// c, the middle of the part's box.
    pub centre: [f64; 2],
    /// The displacement at c.
    pub shift: [f64; 2],
    /// The angle, in 1 / length for a displacement without unit.
    pub turn: f64,
}

/// A motion of the whole body that is rigid on each part and stopped by no hinge and no prescribed displacement. Parts
/// that are not listed stand still. The largest of |shift| and |turn| times half the part's box is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeMotion {
    /// The parts that move, in increasing order.
    pub parts: Vec<PartMotion>,
    words: String,
}

/// Components of a motion below this share of the largest one are rounding errors.
const STILL: f64 = 1e-9;

impl PartMotion {
    /// The displacement at `x`.
    pub fn at(&self, x: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = [x[0] - self.centre[0], x[1] - self.centre[1]];
        [self.shift[0] - self.turn * dy, self.shift[1] + self.turn * dx]
    }
}

impl FreeMotion {
    /// The motion as a field: its nodal values.
    pub fn field<E: Element<N, M>, const N: usize, const M: usize>(
        &self,
        parts: &Parts,
        space: &Space<E, N, M>,
    ) -> Vec<[f64; 2]> {
        let mut field = vec![[0.0; 2]; space.nodes().len()];
        let moving: BTreeMap<usize, &PartMotion> = self.parts.iter().map(|m| (m.part, m)).collect();
        for (nodes, part) in space.elements().iter().zip(&parts.of_triangle) {
            if let Some(motion) = moving.get(part) {
                for &node in nodes {
                    field[node] = motion.at(space.nodes()[node]);
                }
            }
        }
        field
    }
}

/// The motion in words, with what would stop it.
impl fmt::Display for FreeMotion {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.words)
    }
}

impl Parts {
    /// The parts of the body that `mesh` covers.
    pub fn new(mesh: &Mesh) -> Self {
        let of_triangle = connected_by_edges(mesh);
        let count = of_triangle.iter().max().map_or(0, |last| last + 1);
        let mut boxes = vec![[[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]]; count];
        let mut places = vec![None; count];
        for (t, &part) in of_triangle.iter().enumerate() {
            let triangle = mesh.triangle(t);
            places[part].get_or_insert_with(|| triangle.point([1.0 / 3.0; 3]).into());
            let [low, high] = &mut boxes[part];
            for x in triangle.vertices {
                for c in 0..2 {
                    low[c] = low[c].min(x[c]);
                    high[c] = high[c].max(x[c]);
                }
            }
        }
        let frames = boxes.iter().zip(places).map(|([low, high], place)| {
            let halves = [0, 1].map(|c| high[c] / 2.0 - low[c] / 2.0);
            let centre = [0, 1].map(|c| low[c] + halves[c]);
            Frame { centre, half: halves[0].max(halves[1]), place: place.unwrap_or(centre) }
        });
        let (frames, hinges) = (frames.collect(), hinges(mesh, &of_triangle));
        Parts { of_triangle, frames, hinges }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.frames.len()
    }

    /// The part of each triangle.
    pub fn of_triangle(&self) -> &[usize] {
        &self.of_triangle
    }

    /// The vertices in which parts meet without an edge in common.
    pub fn hinges(&self) -> &[Hinge] {
        &self.hinges
    }

    /// The coefficients of the motion of `part` (t_x, t_y, w) in component `c` of the displacement at `x`.
    fn row(&self, part: usize, x: [f64; 2], c: usize) -> [f64; 3] {
        let Frame { centre, half, .. } = self.frames[part];
        match c {
            0 => [1.0, 0.0, -(x[1] - centre[1]) / half],
            _ => [0.0, 1.0, (x[0] - centre[0]) / half],
        }
    }

    /// A motion from (t_x, t_y, w) of each part that moves.
    fn motion(&self, mesh: &Mesh, values: &[(usize, [f64; 3])]) -> FreeMotion {
        let largest = values.iter().flat_map(|v| v.1).fold(0.0, |max: f64, v| max.max(v.abs()));
        let clean = |v: f64| if v.abs() <= STILL * largest { 0.0 } else { v / largest };
        let mut parts = Vec::new();
        for &(part, values) in values {
            let [x, y, w] = values.map(clean);
            if [x, y, w] != [0.0; 3] {
                let Frame { centre, half, .. } = self.frames[part];
                parts.push(PartMotion { part, centre, shift: [x, y], turn: w / half });
            }
        }
        let words = self.words(mesh, &parts);
        FreeMotion { parts, words }
    }

    fn words(&self, mesh: &Mesh, parts: &[PartMotion]) -> String {
        // A part that turns says more than the ones that it takes along.
        let Some(named) = parts.iter().find(|m| m.turn != 0.0).or(parts.first()) else {
            return "motion of nothing".to_owned();
        };
        let Frame { half, place, .. } = self.frames[named.part];
        let of = match (self.count(), parts.len()) {
            (1, _) => String::new(),
            (_, 1) => format!(" of the part of the body at {}", point(place, half)),
            (_, n) => format!(
                " of the part of the body at {} (and of {} more with it)",
                point(place, half),
                n - 1
            ),
        };
        if named.turn == 0.0 {
            let norm = named.shift[0].hypot(named.shift[1]);
            let along = named.shift.map(|c| c / norm);
            let stopping = match along.map(|c| c.abs() > STILL) {
                [true, true] => "u_x or u_y would stop it",
                [true, false] => "u_x would stop it",
                _ => "u_y would stop it",
            };
            return format!("translation along {}{of}: {stopping}", point(along, 1.0));
        }
        let [sx, sy] = named.shift;
        let about = [named.centre[0] - sy / named.turn, named.centre[1] + sx / named.turn];
        let [x, y] = about.map(|c| rounded(c, half));
        let hinge = self.hinges.iter().find(|h| {
            let v = mesh.vertices()[h.vertex];
            h.parts.contains(&named.part)
                && [0, 1].iter().all(|&c| (v[c] - about[c]).abs() <= STILL * half)
        });
        let joined = match hinge {
            Some(_) => {
                "; a vertex alone joins it to the rest there: parts hold each other along edges"
            }
            None => "",
        };
        format!(
            "rotation about ({x}, {y}){of}: u_x off the line y = {y} would stop it, or u_y off x = {x}{joined}"
        )
    }
}

/// All rigid motions that are free when each node is held in the directions `held` of it, which may be off by `rounding`: a basis,
/// empty if the body is held. Motions that turn a part come with as few other parts as the elimination gives.
pub fn free_motions<E, I, const N: usize, const M: usize>(
    parts: &Parts,
    space: &Space<E, N, M>,
    held: impl Fn(usize) -> I,
    rounding: f64,
) -> Vec<FreeMotion>
where
    E: Element<N, M>,
    I: Iterator<Item = [f64; 2]>,
{
    let mut equations = supports(parts, space, held, rounding);
    for hinge in &parts.hinges {
        let x = space.mesh().vertices()[hinge.vertex];
        for pair in hinge.parts.windows(2) {
            for c in 0..2 {
                let [a, b] = [pair[0], pair[1]].map(|part| parts.row(part, x, c));
                equations.push(vec![(pair[0], a), (pair[1], b.map(|v| -v))]);
            }
        }
    }
    let null = null_space(parts.count(), equations);
    null.iter().map(|values| parts.motion(space.mesh(), values)).collect()
}

/// What the prescribed components ask of each part: at most three equations, equivalent to all of them but for what directions that
/// are off by `rounding` may ask.
fn supports<E, I, const N: usize, const M: usize>(
    parts: &Parts,
    space: &Space<E, N, M>,
    held: impl Fn(usize) -> I,
    rounding: f64,
) -> Vec<Vec<(usize, [f64; 3])>>
where
    E: Element<N, M>,
    I: Iterator<Item = [f64; 2]>,
{
    let mut by_part: BTreeMap<usize, Dense> = BTreeMap::new();
    for (nodes, &part) in space.elements().iter().zip(&parts.of_triangle) {
        for &node in nodes {
            for d in held(node) {
                let rows = by_part.entry(part).or_insert_with(|| Dense::new(3));
                let [a, b] = [0, 1].map(|c| parts.row(part, space.nodes()[node], c));
                rows.push([0, 1, 2].map(|i| d[0] * a[i] + d[1] * b[i]));
                if rows.count() == 12 {
                    rows.triangularise(0);
                }
            }
        }
    }
    let mut equations = Vec::new();
    for (part, mut rows) in by_part {
        rows.triangularise(0);
        let column = |c: usize| rows.values.chunks(3).map(|row| row[c]).collect();
        let directions = singular_vectors((0..3).map(column).collect());
        let largest = directions.first().map_or(0.0, |(value, _)| *value);
        for (value, v) in directions.iter().filter(|(value, _)| *value > rounding * largest) {
            let weight = value / largest;
            equations.push(vec![(part, [0, 1, 2].map(|k| weight * v[k]))]);
        }
    }
    equations
}

/// A place in a body of this size, to six digits of the size.
fn point(x: [f64; 2], size: f64) -> String {
    let [x, y] = x.map(|c| rounded(c, size));
    format!("({x}, {y})")
}

fn rounded(c: f64, size: f64) -> String {
    let decimals = (5.0 - size.log10().floor()).clamp(0.0, 400.0) as usize;
    // What the decimals read back to is the shortest number that says the same; adding 0.0 spares the reader a -0.
    let short = format!("{c:.decimals$}").parse().unwrap_or(c) + 0.0;
    if short == 0.0 || (1e-5..1e16).contains(&short.abs()) {
        format!("{short}")
    } else {
        format!("{short:e}")
    }
}

#[cfg(test)]
mod tests {
    use approx::abs_diff_eq;
    use faer::Mat;

    use super::*;
    use crate::kernel::{P1, P2};

    /// What is left of a motion of size 1 where it is stopped: components below [`STILL`] are set to zero, and slender
    /// parts have coordinates of up to 10 times their half box.
    const STOPPED: f64 = 1e-8;

    /// The cells of an nx x ny grid for which `solid` says so, two triangles each; corner (i, j) lies at `place`.
    fn sheet(
        [nx, ny]: [usize; 2],
        place: impl Fn([f64; 2]) -> [f64; 2],
        solid: impl Fn(usize, usize) -> bool,
    ) -> Mesh {
        let mut number = BTreeMap::new();
        let mut vertices = Vec::new();
        let mut corner = |i: usize, j: usize| {
            *number.entry((i, j)).or_insert_with(|| {
                vertices.push(place([i as f64, j as f64]));
                vertices.len() - 1
            })
        };
        let mut triangles = Vec::new();
        for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
            if solid(i, j) {
                let [a, b] = [corner(i, j), corner(i + 1, j)];
                let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        Mesh::new(vertices, triangles, []).unwrap()
    }

    type Held = dyn Fn([f64; 2]) -> [bool; 2];

    fn free<E: Element<N, M>, const N: usize, const M: usize>(
        mesh: &Mesh,
        held: &Held,
    ) -> Vec<FreeMotion> {
        let space = Space::<E, N, M>::new(mesh);
        let directions = |node: usize| {
            let axes = held(space.nodes()[node]).into_iter().zip([[1.0, 0.0], [0.0, 1.0]]);
            axes.filter(|(held, _)| *held).map(|(_, axis)| axis)
        };
        let parts = Parts::new(mesh);
        let motions = free_motions(&parts, &space, directions, 0.0);
        for motion in &motions {
            vanishes_where_held_and_agrees_at_hinges(motion, &parts, &space, held);
        }
        motions
    }

    fn vanishes_where_held_and_agrees_at_hinges<
        E: Element<N, M>,
        const N: usize,
        const M: usize,
    >(
        motion: &FreeMotion,
        parts: &Parts,
        space: &Space<E, N, M>,
        held: &Held,
    ) {
        let field = motion.field(parts, space);
        for (x, u) in space.nodes().iter().zip(&field) {
            for c in 0..2 {
                let still = abs_diff_eq!(u[c], 0.0, epsilon = STOPPED);
                assert!(!held(*x)[c] || still, "{u:?} at {x:?}: {motion}");
            }
        }
        let of = |part: usize, x| {
            let moving = motion.parts.iter().find(|m| m.part == part);
            moving.map_or([0.0; 2], |m| m.at(x))
        };
        for hinge in parts.hinges() {
            let x = space.mesh().vertices()[hinge.vertex];
            for pair in hinge.parts.windows(2) {
                let (a, b) = (of(pair[0], x), of(pair[1], x));
                let together = abs_diff_eq!(a[..], b[..], epsilon = STOPPED);
                assert!(together, "{a:?} {b:?}: {motion}");
            }
        }
        assert!(field.iter().any(|u| u[0].hypot(u[1]) > 1e-3), "{motion} moves");
    }

    fn said(mesh: &Mesh, held: &Held) -> Vec<String> {
        free::<P1, 3, 2>(mesh, held).iter().map(FreeMotion::to_string).collect()
    }

    fn solid(_: usize, _: usize) -> bool {
        true
    }

    #[test]
    fn each_free_motion_of_one_part_is_named_with_what_would_stop_it() {
        let square = sheet([2, 2], |x| x, solid);
        assert_eq!(
            said(&square, &|_| [false; 2]),
            [
                "translation along (1, 0): u_x would stop it",
                "translation along (0, 1): u_y would stop it",
                "rotation about (1, 1): u_x off the line y = 1 would stop it, or u_y off x = 1",
            ]
        );
        assert_eq!(
            said(&square, &|[_, y]| [false, y == 0.0]),
            ["translation along (1, 0): u_x would stop it"]
        );
        assert_eq!(
            said(&square, &|[x, y]| [x == 2.0 && y == 0.0; 2]),
            ["rotation about (2, 0): u_x off the line y = 0 would stop it, or u_y off x = 2"]
        );
        assert!(said(&square, &|[x, y]| [x == 0.0, x == 0.0 && y == 0.0]).is_empty());
    }

    #[test]
    fn a_part_hinged_at_a_vertex_may_turn_and_says_so() {
        // Two squares that meet in (1, 1).
        let hinged = |i, j| i == j;
        let mesh = sheet([2, 2], |x| x, hinged);
        assert_eq!(
            said(&mesh, &|[_, y]| [y == 0.0; 2]),
            [
                "rotation about (1, 1) of the part of the body at (1.666667, 1.333333): u_x off the line y = 1 would \
                 stop it, or u_y off x = 1; a vertex alone joins it to the rest there: parts hold each other along edges"
            ]
        );
        assert!(said(&mesh, &|[x, y]| [y == 0.0, y == 0.0 || x == 2.0]).is_empty());
        // Midpoints of P2 hold no more than vertices do.
        assert_eq!(free::<P2, 6, 3>(&mesh, &|[_, y]| [y == 0.0; 2]).len(), 1);
    }

    #[test]
    fn three_parts_hinged_in_a_triangle_hold_each_other_unless_the_hinges_are_in_line() {
        // A held base with the hinges (0, 0) and (4, 0) on either side of a notch, and two triangles that meet above it.
        let arch = |top: [f64; 2]| {
            let base = [[0.0, 0.0], [4.0, 0.0], [2.0, -3.0], [2.0, -1.0]];
            let v = [&base[..], &[top, [6.0, 5.0], [-2.0, 5.0]]].concat();
            Mesh::new(v, vec![[0, 2, 3], [2, 1, 3], [1, 5, 4], [4, 6, 0]], []).unwrap()
        };
        let held: &Held = &|[_, y]| [y < 0.0; 2];
        assert!(said(&arch([2.0, 2.0]), held).is_empty());
        assert!(said(&arch([2.0, 0.001]), held).is_empty());
        assert_eq!(said(&arch([2.0, 0.0]), held).len(), 1, "the middle hinge moves up and down");
    }

    #[test]
    fn place_and_size_of_the_body_do_not_matter() {
        // Two parts, hinged at (2, 1).
        let solid = |i, j| (i, j) == (2, 1) || (i < 2 && j == 0);
        let held: [(&Held, usize); 3] =
            [(&|_| [false; 2], 4), (&|_| [false, true], 1), (&|_| [true; 2], 0)];
        for scale in [1e-150, 1e-3, 1.0, 1e150] {
            for offset in [0.0, 1e10] {
                let mesh = sheet([3, 2], |x| x.map(|c| scale * (c + offset)), solid);
                for (held, count) in held {
                    let found = said(&mesh, held);
                    assert_eq!(found.len(), count, "{scale:e}, offset {offset:e}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn slender_parts_held_at_one_end_are_held() {
        for slenderness in [1e2, 1e4, 1e6] {
            let mesh = sheet([8, 1], |[x, y]| [x * slenderness, y], solid);
            assert!(said(&mesh, &|[x, _]| [x == 0.0; 2]).is_empty());
            assert_eq!(said(&mesh, &|[x, y]| [x == 0.0 && y == 0.0; 2]).len(), 1);
        }
    }

    /// 3 x parts less the rank of all equations, by the singular values of the whole matrix.
    fn nullity(mesh: &Mesh, held: &Held) -> usize {
        let parts = Parts::new(mesh);
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut row = |terms: &[(usize, [f64; 3], f64)]| {
            let mut row = vec![0.0; 3 * parts.count()];
            for (part, coefficients, sign) in terms {
                for k in 0..3 {
                    row[3 * part + k] += sign * coefficients[k];
                }
            }
            rows.push(row);
        };
        for (corners, &part) in mesh.triangles().iter().zip(parts.of_triangle()) {
            for x in corners.map(|v| mesh.vertices()[v]) {
                for c in [0, 1].into_iter().filter(|&c| held(x)[c]) {
                    row(&[(part, parts.row(part, x, c), 1.0)]);
                }
            }
        }
        for hinge in parts.hinges() {
            let x = mesh.vertices()[hinge.vertex];
            for &other in &hinge.parts[1..] {
                for c in 0..2 {
                    let first = hinge.parts[0];
                    let (a, b) = (parts.row(first, x, c), parts.row(other, x, c));
                    row(&[(first, a, 1.0), (other, b, -1.0)]);
                }
            }
        }
        let matrix = Mat::from_fn(rows.len().max(3 * parts.count()), 3 * parts.count(), |i, j| {
            rows.get(i).map_or(0.0, |row| row[j])
        });
        let values = matrix.singular_values().unwrap();
        values.iter().filter(|&&v| v < 1e-9).count()
    }

    #[test]
    fn random_perforated_sheets_have_as_many_free_motions_as_their_singular_values_say() {
        let mut seed = 1_u64;
        let mut random = move || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            seed >> 33
        };
        let (mut with, mut without) = (0, 0);
        for n in 0..120 {
            let solid: Vec<bool> = (0..100).map(|_| random() % 10 < 4 + n % 6).collect();
            if !solid.iter().any(|&s| s) {
                continue;
            }
            let skew = |[x, y]: [f64; 2]| [x + 0.1 * (3.0 * y).sin(), y + 0.1 * (2.0 * x).cos()];
            let mesh = sheet([10, 10], skew, |i, j| solid[10 * j + i]);
            let held: &Held = &|[x, y]| [y < 1.3, x < 0.3 || y > 8.7];
            let (found, expected) = (free::<P1, 3, 2>(&mesh, held).len(), nullity(&mesh, held));
            assert_eq!(found, expected, "sheet {n}");
            if found == 0 { without += 1 } else { with += 1 }
        }
        assert!(with > 20 && without > 5, "{with} with free motions, {without} without");
    }

    #[test]
    fn squares_hinged_at_all_their_corners_are_a_mechanism_of_one_motion() {
        // Found in a blink: 1,250 parts in a net, which a dense rank would take minutes for.
        let mesh = sheet([50, 50], |x| x, |i, j| (i + j) % 2 == 0);
        let frame: &Held = &|[x, y]| [x <= 1.0 && y <= 1.0; 2];
        let motions = free::<P1, 3, 2>(&mesh, frame);
        assert_eq!(motions.len(), 3, "all turn, and two corner squares on their own");
        assert!(motions.iter().any(|m| m.parts.len() > 1200));
    }
}
