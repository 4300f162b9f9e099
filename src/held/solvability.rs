//! Bodies that supports leave free to move, held by contact because the loads press them against their obstacles.
//!
//! Let R be the rigid motions of a part of the body that the supports leave free, or of parts that touch each other along Gamma_C,
//! and c_i(r) = r_n at the nodes of Gamma_C, the jump where two parts meet.
//! J_h has a minimiser if the loads on R are the work of a pressure, L(r) = sum over some edges of Gamma_C and their nodes of
//! mu_i c_i(r) with all mu_i > 0 (docs/theory.md, Proposition 5.5). That is decided by non-negative least squares (Lawson &
//! Hanson), whose residual is the motion that the loads drive. Motions with c = 0 on all of Gamma_C slide.
//!
//! If u is a solution, u + r with r of R is a solution, too, if and only if r_n = 0 where u presses and r_n <= -P(u) where it does not:
//! the solutions are u and a polyhedron, of which the displacement of least norm is taken.

use nalgebra::Vector2;
#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use super::grip::Grip;
use crate::contact::piece::Piece;
use crate::kernel::Response;
use crate::linear::dense::{dot, inner, least_squares, norm, singular_vectors};
use crate::model::groups::groups;
use crate::model::mesh::NO_ANGLE;
use crate::model::rigid::{FreeMotion, NEGLIGIBLE, Parts, null_space, subtract};
use crate::model::space::Space;

/// The change of the loads, as a share of the largest work of single loads, under which they must go on pressing: a body on the
/// verge of tipping is not held. Loads are never known more precisely, and the share is 10^4 times that of rounding.
pub(super) const MARGIN: f64 = 1e-6;

/// The motions that contact and loads do not hold.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NotHeld {
    /// A basis of them, or the one that the loads drive.
    pub(crate) motions: Vec<FreeMotion>,
    /// The force of the loads along that one, or their moment about its centre.
    pub(crate) drive: Option<f64>,
}

/// The solutions of a body that contact holds: with u those u + sum_j x_j b_j with row . (x + b . u) <= bound.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Slides {
    /// b_j, fields with orthonormal nodal values: the motions that contact does not stop.
    pub(crate) basis: Vec<Vec<[f64; 2]>>,
    /// Motions that span the same, each with its components along the basis.
    pub(super) motions: Vec<(FreeMotion, Vec<f64>)>,
    /// Where edges that do not press stop them.
    pub(super) bounds: Vec<(Vec<f64>, f64)>,
    /// The contact edges that do not press and stop one of the motions somewhere, in their order.
    pub(crate) stopping: Vec<usize>,
    /// For each contact edge whether it presses in no solution; empty if all may.
    pub(crate) idle: Vec<bool>,
}

/// The way that a body may go along a motion that neither supports nor pressed edges stop, from the given displacement, which
/// is one of several solutions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub struct Play {
    /// The centre of a rotation; left out for a translation.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub(crate) about: Option<[f64; 2]>,
    /// The direction of a translation, a unit vector; left out for a rotation.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub along: Option<[f64; 2]>,
    /// The distance, or the angle counter-clockwise, that it may go back, at most 0; left out where nothing ends it.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub least: Option<f64>,
    /// The distance or angle that it may go on; left out where nothing ends it.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub most: Option<f64>,
}

/// The motions of parts that pieces of Gamma_C join, part by part otherwise.
pub(super) fn joined(
    motions: &[FreeMotion],
    parts: &Parts,
    contact: &[Piece],
) -> Vec<Vec<FreeMotion>> {
    let moves = |part: &usize| motions.iter().any(|motion| motion.part == *part);
    let of_piece = |piece: &Piece| {
        let sides = piece.geometry.stretches.iter();
        let of_sides: Vec<usize> = sides.map(|s| parts.of_triangle()[s.edge.triangle]).collect();
        let [first, second] = of_sides[..] else { return None };
        (moves(&first) && moves(&second)).then_some([first, second])
    };
    let group = groups(parts.count(), contact.iter().filter_map(of_piece));
    let mut joined: Vec<Vec<FreeMotion>> = Vec::new();
    for motion in motions {
        let is_own = |of: &&mut Vec<FreeMotion>| group[of[0].part] == group[motion.part];
        match joined.iter_mut().find(is_own) {
            Some(of) => of.push(motion.clone()),
            None => joined.push(vec![motion.clone()]),
        }
    }
    joined
}

/// For each `taken` piece of Gamma_C on the parts that have these `motions`, its number and its rows c_i: the jump of r at its
/// nodes for each motion r, not P0(r), as the stress of a rigid motion is zero but for rounding. A piece that pulls as well as
/// it pushes has each row with both signs.
pub(super) fn rows(
    motions: &[FreeMotion],
    parts: &Parts,
    space: &Space,
    contact: &[Piece],
    taken: impl Fn(usize) -> bool,
) -> Vec<EdgeRows> {
    let of_parts = |(e, piece): &(usize, &Piece)| taken(*e) && moves(motions, parts, piece);
    let of_piece = |(e, piece): (usize, &Piece)| {
        let row = |i: usize| jumps(motions, parts, space, piece, i);
        let mut rows = Vec::with_capacity(piece.p0.len());
        for (response, values) in piece.responses() {
            for own in values.map(row) {
                if response == Response::Bilateral {
                    rows.push(own.iter().map(|c| -c).collect());
                }
                rows.push(own);
            }
        }
        (e, rows)
    };
    contact.iter().enumerate().filter(of_parts).map(of_piece).collect()
}

/// The jump of each of the motions in the component of functional `i` of a piece, at its node.
pub(super) fn jumps(
    motions: &[FreeMotion],
    parts: &Parts,
    space: &Space,
    piece: &Piece,
    i: usize,
) -> Vec<f64> {
    let compared = piece.compared(space.mesh(), i);
    let jump = |motion: &FreeMotion| {
        let at = |&(triangle, place, along): &(usize, [f64; 2], Vector2<f64>)| {
            let part = parts.of_triangle()[triangle];
            Vector2::from(motion.at_point_of(part, place)).dot(&along)
        };
        compared.iter().map(at).sum()
    };
    motions.iter().map(jump).collect()
}

/// Returns whether one of the motions moves a side of a piece.
pub(super) fn moves(motions: &[FreeMotion], parts: &Parts, piece: &Piece) -> bool {
    piece.geometry.stretches.iter().any(|stretch| {
        let part = parts.of_triangle()[stretch.edge.triangle];
        motions.iter().any(|motion| motion.part == part)
    })
}

/// The rows of all edges.
pub(super) fn all(edges: &[EdgeRows]) -> Vec<Vec<f64>> {
    edges.iter().flat_map(|(_, rows)| rows.clone()).collect()
}

/// The value of c_i below which c_i is zero but for rounding: more than [`NEGLIGIBLE`] where the body is far from the origin,
/// since its vertices are rounded.
pub(super) fn negligible(rows: &[Vec<f64>], count: usize, rounding: f64) -> f64 {
    let largest = singular_vectors(rows, count).first().map_or(0.0, |(value, _)| *value);
    NEGLIGIBLE.max(rounding * (rows.len() as f64).sqrt()) * largest.max(1.0)
}

/// The motions among the combinations of `motions`, which may be off by `rounding`, that slide along every obstacle.
///
/// # Errors
/// The motions that contact and `load` leave free.
pub(crate) fn slides(
    motions: &[FreeMotion],
    parts: &Parts,
    space: &Space,
    load: &[[f64; 2]],
    contact: &[Piece],
    rounding: f64,
) -> Result<Slides, NotHeld> {
    let mut sliding = Vec::new();
    let mut idle = vec![false; contact.len()];
    for of_part in &joined(motions, parts, contact) {
        let count = of_part.len();
        let edges = rows(of_part, parts, space, contact, |_| true);
        if edges.is_empty() {
            return Err(NotHeld { motions: of_part.clone(), drive: None });
        }
        let fields: Vec<_> = of_part.iter().map(|motion| motion.field(parts, space)).collect();
        let work = |of: fn(f64) -> f64, r: &Vec<[f64; 2]>| -> f64 {
            let pairs = load.as_flattened().iter().zip(r.as_flattened());
            pairs.map(|(l, r)| of(l * r)).sum()
        };
        let scale = fields.iter().map(|r| work(f64::abs, r)).fold(0.0, f64::max);
        let grip = Grip::new(of_part, parts, space, contact, &edges);
        // In units of the largest work of single loads, or of what friction can do.
        let strength = grip.as_ref().map_or(0.0, Grip::size);
        let unit = [scale, strength].into_iter().find(|&size| size > 0.0).unwrap_or(1.0);
        let loads: Vec<f64> = fields.iter().map(|r| work(|w| w, r) / unit).collect();
        let none = negligible(&all(&edges), count, rounding);
        let not_held = |(weights, driven): Left| {
            let motion = parts.combined(of_part, &weights);
            let drive = work(|w| w, &motion.field(parts, space)) / motion.size();
            NotHeld { drive: driven.then_some(drive), motions: vec![motion] }
        };
        if let Some(grip) = grip {
            let smooth = edges.iter().filter(|(e, _)| !grip.with_cones.contains(e));
            let normal: Vec<Vec<f64>> = smooth.flat_map(|(_, rows)| rows.clone()).collect();
            if let Some(left) = grip.driven(&normal, &loads, unit, none) {
                return Err(not_held(left));
            }
            let rows = [all(&edges), grip.rows()].concat();
            let free = null_space(&rows, count, |value, _| value > none);
            sliding.extend(free.iter().map(|weights| parts.combined(of_part, weights)));
            continue;
        }
        let kept = press(edges.clone(), &loads, none).map_err(|left| {
            left.map_or_else(|| NotHeld { motions: of_part.clone(), drive: None }, &not_held)
        })?;
        for (i, rows) in &edges {
            idle[*i] = rows.iter().any(|row| norm(row) > none) && kept.iter().all(|(k, _)| k != i);
        }
        let free = null_space(&all(&kept), count, |value, _| value > none);
        sliding.extend(free.iter().map(|weights| parts.combined(of_part, weights)));
    }
    Ok(Slides { idle, ..Slides::new(sliding, parts, space) })
}

/// The number of a contact edge and its rows c_i.
pub(super) type EdgeRows = (usize, Vec<Vec<f64>>);

/// A motion on which the body leaves, and whether the loads drive it: on the verge they do next to no work.
pub(super) type Left = (Vec<f64>, bool);

/// The motion on which the body leaves where the loads are changed a little within the span of these rows, of which those below `none`
/// are zero; `left` tells of changed loads.
pub(super) fn on_the_verge(
    rows: &[Vec<f64>],
    none: f64,
    loads: &[f64],
    left: impl Fn(&[f64]) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let directions = singular_vectors(rows, loads.len());
    directions.into_iter().filter(|(value, _)| *value > none).find_map(|(_, direction)| {
        let changed = |share: f64| -> Vec<f64> {
            loads.iter().zip(&direction).map(|(l, d)| l + share * d).collect()
        };
        [-MARGIN, MARGIN].into_iter().find_map(|share| left(&changed(share)))
    })
}

/// The edges that may press: `loads` are the work of a pressure on whole edges among them, given by their rows, of which
/// those below `none` are zero, and still so if they are changed a little within the span of these rows.
///
/// # Errors
/// The motion on which the body leaves. Nothing where no edge can press.
fn press(
    mut edges: Vec<EdgeRows>,
    loads: &[f64],
    none: f64,
) -> Result<Vec<EdgeRows>, Option<Left>> {
    for (_, edge) in &mut edges {
        edge.retain(|row| norm(row) > none);
    }
    edges.retain(|(_, edge)| !edge.is_empty());
    let stopped_at_first = !edges.is_empty();
    let mut verge: Option<Vec<f64>> = None;
    loop {
        let rows = all(&edges);
        if let Some(motion) = nnls_residual(&rows, loads, NEGLIGIBLE) {
            let driven = verge.is_none();
            return Err(Some((verge.unwrap_or(motion), driven)));
        }
        let left = |changed: &[f64]| nnls_residual(&rows, changed, NEGLIGIBLE);
        let Some(motion) = on_the_verge(&rows, none, loads, left) else { break };
        // No pressure that does the work of the loads acts where this motion leaves the obstacle.
        let before = edges.len();
        let stays = |row: &Vec<f64>| dot(row, &motion) >= -NO_ANGLE * norm(row) * norm(&motion);
        edges.retain(|(_, edge)| edge.iter().all(stays));
        if edges.len() == before {
            return Err(Some((motion, false)));
        }
        verge = Some(motion);
    }
    if stopped_at_first && edges.is_empty() { Err(None) } else { Ok(edges) }
}

impl Slides {
    pub(super) fn new(motions: Vec<FreeMotion>, parts: &Parts, space: &Space) -> Self {
        let fields: Vec<_> = motions.iter().map(|motion| motion.field(parts, space)).collect();
        let basis = orthonormal(fields.iter().cloned());
        let along = fields.iter().map(|field| basis.iter().map(|b| inner(b, field)).collect());
        Slides { motions: motions.into_iter().zip(along).collect(), basis, ..Slides::default() }
    }

    /// A motion that leads from u to a solution away from all obstacles that do not press it, if there is one.
    pub(crate) fn to_inside(&self, u: &[[f64; 2]]) -> Option<Vec<f64>> {
        let at = self.at(u);
        let size = self.bounds.iter().map(|(row, bound)| bound.abs() / norm(row));
        let size = size.fold(norm(&at), f64::max).max(f64::MIN_POSITIVE);
        let to = (1..12).find_map(|k| self.nearest(size * 0.1_f64.powi(k)))?;
        Some(to.iter().zip(at).map(|(to, at)| to - at).collect())
    }

    /// Moves u by the basis with these weights.
    pub(crate) fn move_by(&self, weights: &[f64], u: &mut [[f64; 2]]) {
        for (b, weight) in self.basis.iter().zip(weights) {
            subtract(u, b, -weight);
        }
    }

    /// u as the solution of least norm.
    pub(crate) fn least_norm(&self, u: &mut [[f64; 2]]) {
        let Some(to) = self.nearest(0.0) else { return };
        let way: Vec<f64> = to.iter().zip(self.at(u)).map(|(to, at)| to - at).collect();
        self.move_by(&way, u);
    }

    /// Returns whether contact edge `e` presses in no solution.
    pub(crate) fn is_idle(&self, e: usize) -> bool {
        self.idle.get(e).is_some_and(|idle| *idle)
    }

    pub(super) fn at(&self, u: &[[f64; 2]]) -> Vec<f64> {
        self.basis.iter().map(|b| inner(b, u)).collect()
    }

    /// The x of least norm with row . x <= bound, and less than that by `margin`: as non-negative least squares (Lawson & Hanson,
    /// *Solving least squares problems*, 23.4). `None` if there is none.
    fn nearest(&self, margin: f64) -> Option<Vec<f64>> {
        let bound = |(row, bound): &(Vec<f64>, f64)| bound - margin * norm(row);
        let violated = |b: &(Vec<f64>, f64)| -bound(b) / norm(&b.0);
        let scale = self.bounds.iter().map(violated).fold(0.0, f64::max);
        if scale == 0.0 {
            return Some(vec![0.0; self.basis.len()]);
        }
        let row = |b: &(Vec<f64>, f64)| {
            let length = norm(&b.0);
            let negative = b.0.iter().map(|r| -r / length);
            negative.chain([-bound(b) / length / scale]).collect()
        };
        let rows: Vec<Vec<f64>> = self.bounds.iter().map(row).collect();
        let mut target = vec![0.0; self.basis.len() + 1];
        target[self.basis.len()] = 1.0;
        let mut rest = nnls_residual(&rows, &target, NEGLIGIBLE)?;
        let last = rest.pop()?;
        (last > NEGLIGIBLE).then(|| rest.iter().map(|r| -scale * r / last).collect())
    }

    /// How far each motion may go from u.
    pub(crate) fn plays(&self, u: &[[f64; 2]]) -> Vec<Play> {
        let at = self.at(u);
        let play = |(motion, along): &(FreeMotion, Vec<f64>)| {
            let mut range = [None::<f64>; 2];
            for (row, bound) in &self.bounds {
                let speed = dot(row, along);
                if speed.abs() > NEGLIGIBLE * norm(row) * norm(along) {
                    let way = ((bound - dot(row, &at)).max(0.0) / speed) * motion.size();
                    let end = &mut range[usize::from(way > 0.0 || (way == 0.0 && speed > 0.0))];
                    let nearer = end.is_none_or(|end| way.abs() < end.abs());
                    *end = if nearer { Some(way) } else { *end };
                }
            }
            let [least, most] = range;
            let about = motion.about();
            let along = motion.shift.map(|c| c / motion.size());
            Play { about, along: about.is_none().then_some(along), least, most }
        };
        self.motions.iter().map(play).collect()
    }
}

/// Fields with orthonormal nodal values that span the same space.
fn orthonormal(fields: impl Iterator<Item = Vec<[f64; 2]>>) -> Vec<Vec<[f64; 2]>> {
    let mut basis: Vec<Vec<[f64; 2]>> = Vec::new();
    for mut field in fields {
        for b in &basis {
            let along = inner(b, &field);
            subtract(&mut field, b, along);
        }
        let norm = inner(&field, &field).sqrt();
        basis.push(field.iter().map(|f| f.map(|f| f / norm)).collect());
    }
    basis
}

/// The part of `target` that no combination of the rows with weights >= 0 reaches, if it is larger than `tolerance`.
pub(super) fn nnls_residual(rows: &[Vec<f64>], target: &[f64], tolerance: f64) -> Option<Vec<f64>> {
    // The rows in use and their weights.
    let mut used: Vec<(usize, f64)> = Vec::new();
    let mut rest = target.to_vec();
    let rounding = 16.0 * f64::EPSILON * norm(target);
    for _ in 0..MOST_EXCHANGES {
        if norm(&rest) <= tolerance {
            return None;
        }
        let gain = |i: &usize| dot(&rows[*i], &rest) / norm(&rows[*i]);
        let fresh =
            (0..rows.len()).filter(|i| norm(&rows[*i]) > 0.0 && used.iter().all(|(u, _)| u != i));
        let best = fresh.max_by(|i, j| gain(i).total_cmp(&gain(j)));
        // The weight of a row that gains rounding only would be rounding, or not finite where the row depends on those in use.
        let Some(best) = best.filter(|i| gain(i) > rounding) else { break };
        used.push((best, 0.0));
        loop {
            // Rows that depend on each other have no unique weights: the last one adds nothing.
            if used.len() > target.len() {
                used.sort_by(|a, b| a.1.total_cmp(&b.1));
                used.remove(0);
                continue;
            }
            let columns = used.iter().map(|(i, _)| rows[*i].clone()).collect();
            let weights = least_squares(columns, target);
            // The weights go towards the new ones until one of them is 0; this weight is set to 0, whatever its rounding.
            let until = |j: usize| {
                let old = used[j].1;
                if old > 0.0 { old / (old - weights[j]) } else { 0.0 }
            };
            let negative = (0..used.len()).filter(|&j| weights[j] <= 0.0);
            let first = negative.min_by(|&i, &j| until(i).total_cmp(&until(j)));
            let t = first.map_or(1.0, until);
            for (j, (_, weight)) in used.iter_mut().enumerate() {
                let is_first = first == Some(j);
                *weight = if is_first { 0.0 } else { *weight + t * (weights[j] - *weight) };
            }
            if first.is_none() {
                break;
            }
            used.retain(|(_, weight)| *weight > 0.0);
            if used.is_empty() {
                break;
            }
        }
        rest = target.to_vec();
        for (i, weight) in &used {
            for (rest, c) in rest.iter_mut().zip(&rows[*i]) {
                *rest -= weight * c;
            }
        }
    }
    Some(rest).filter(|rest| !(norm(rest) <= tolerance))
}

/// The largest number of steps. The method is finite, and few steps suffice for three unknowns; the bound ends cycles by
/// rounding, and decides nothing else.
const MOST_EXCHANGES: usize = 200;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::rigid::pins;

    /// (down, turn): a plate on supports at these places, pressed by a unit force at `at`.
    fn presses(supports: &[f64], at: f64) -> bool {
        let rows: Vec<Vec<f64>> = supports.iter().map(|x| vec![1.0, *x]).collect();
        nnls_residual(&rows, &[1.0, at], 1e-9).is_none()
    }

    #[test]
    fn a_force_between_the_supports_presses_and_one_beyond_tips() {
        let supports: Vec<f64> = (0..=100).map(|i| f64::from(i) / 100.0).collect();
        for at in [0.0, 0.3, 0.999, 1.0] {
            assert!(presses(&supports, at), "{at}");
        }
        for at in [-1e-6, 1.01, 5.0] {
            assert!(!presses(&supports, at), "{at}");
        }
        let rows = [vec![1.0, 0.0], vec![1.0, 1.0]];
        let motion = nnls_residual(&rows, &[1.0, 2.0], 1e-9).unwrap();
        assert!(rows.iter().all(|c| c[0] * motion[0] + c[1] * motion[1] <= 1e-12), "admitted");
        assert!(motion[0] + 2.0 * motion[1] > 0.0, "and the loads do work on it");
    }

    /// Rows (x, y, turn) of a floor and of a wall at the right, of so many edges; the load presses down. A row that depended on two in
    /// use made the rest no number, which passed for nothing.
    #[test]
    fn a_wall_that_loads_do_not_press_is_left_whatever_the_number_of_edges() {
        for n in 1..40 {
            let places = |e: usize| [e, e + 1].map(|i| 2.0 * i as f64 / n as f64 - 1.0);
            let floor = (0..n).map(|e| (e, places(e).map(|x| vec![0.0, -1.0, -x]).to_vec()));
            let wall = (0..n).map(|e| (n + e, places(e).map(|y| vec![1.0, 0.0, -y]).to_vec()));
            let edges: Vec<EdgeRows> = floor.chain(wall).collect();
            let off = 1.0 / 15.0;
            let kept = press(edges.clone(), &[0.0, -1.0, -off], 1e-10).unwrap();
            assert_eq!(kept, edges[..n], "{n} edges");
            // Control: what leans on the wall presses both.
            let kept = press(edges.clone(), &[0.3, -1.0, -off], 1e-10).unwrap();
            assert_eq!(kept, edges, "{n} edges");
        }
    }

    #[test]
    fn pins_stop_every_slide() {
        let slides = vec![vec![[0.6, 0.0], [0.8, 0.0]], vec![[0.8, 0.0], [-0.6, 0.0]]];
        let mut pins = pins(&slides, |_, _| true);
        pins.sort_unstable();
        assert_eq!(pins, [(0, 0), (1, 0)]);
    }
}
