//! Bodies that supports leave free to move, held by contact because the loads press them against their obstacles.
//!
//! Let R be the rigid motions that the supports leave free, and c_i(r) = r_n at the nodes of Gamma_C. J_h has a minimiser if
//! L(r) < 0 for every r of R that the obstacles admit (c_i(r) <= 0 for all i), but for those that slide along all of them
//! (c_i(r) = 0 for all i), which must have L(r) = 0 (Fichera; Lions & Stampacchia). In other words, L on R is a combination
//! of the c_i with weights >= 0, the contact forces, and stays one if it is changed a little within their span: that is
//! decided by non-negative least squares (Lawson & Hanson), whose residual is the motion on which the body leaves.
//!
//! The solution is unique up to motions that slide along all obstacles; the one of least norm is taken.

use nalgebra::Vector2;

use super::contact_line::ContactLineEdge;
use super::dense::{dot, inner, least_squares, singular_vectors};
use super::space::Space;
use crate::kernel::Element;

/// Work below this share of the largest work of single loads is rounding.
const BALANCED: f64 = 1e-9;

/// Loads must go on pressing when they are changed by this share: a body on the verge of tipping is not held.
const MARGIN: f64 = 1e-6;

/// Singular values of the c_i below this share of the largest, or of motions of size 1, belong to motions that slide; a c_i below
/// it is zero but for rounding. Where the body is far from the origin, rounding its vertices makes more than this.
const SLIDES: f64 = 1e-10;

/// The motions among the combinations of `motions` that slide along every obstacle, as fields with orthonormal nodal
/// values; `None` if contact and `load` do not hold the body. The motions may be off by `rounding`.
pub fn slides<E: Element<N, M>, const N: usize, const M: usize>(
    motions: &[Vec<[f64; 2]>],
    space: &Space<E, N, M>,
    load: &[[f64; 2]],
    contact: &[ContactLineEdge<N, M>],
    rounding: f64,
) -> Option<Vec<Vec<[f64; 2]>>> {
    let dimension = motions.len();
    // r_n, and not P0(r): the stress of a rigid motion is zero but for rounding.
    let mut rows: Vec<Vec<f64>> = contact
        .iter()
        .flat_map(|edge| {
            let nodes = space.edge_nodes(edge.edge).into_iter().zip(edge.directions);
            nodes.map(|(node, n)| motions.iter().map(|r| Vector2::from(r[node]).dot(&n)).collect())
        })
        .collect();
    let work = |r: &[[f64; 2]], of: fn(f64) -> f64| -> f64 {
        let pairs = load.as_flattened().iter().zip(r.as_flattened());
        pairs.map(|(l, r)| of(l * r)).sum()
    };
    let scale = motions.iter().map(|r| work(r, f64::abs)).fold(0.0, f64::max);
    if !(scale > 0.0) {
        return None;
    }
    // In units of the largest work of single loads.
    let loads: Vec<f64> = motions.iter().map(|r| work(r, |w| w) / scale).collect();
    let columns = (0..dimension).map(|j| rows.iter().map(|row| row[j]).collect()).collect();
    let directions = singular_vectors(columns);
    let largest = directions.first().map_or(0.0, |(value, _)| *value);
    let of_contact = space.mesh().turned_by_rounding(contact.iter().map(|edge| edge.edge));
    let of_all = rounding.max(of_contact) * (rows.len() as f64).sqrt();
    let none = SLIDES.max(of_all) * largest.max(1.0);
    rows.retain(|row| dot(row, row).sqrt() > none);
    let (stopped, sliding): (Vec<_>, Vec<_>) =
        directions.iter().partition(|(value, _)| *value > none);
    let holds = |loads: &[f64]| leaving(&rows, loads, BALANCED).is_none();
    let pressed = stopped.iter().all(|(_, direction)| {
        [-1.0, 1.0].iter().all(|sign| {
            let change = direction.iter().map(|d| sign * MARGIN * d);
            let changed: Vec<f64> = loads.iter().zip(change).map(|(l, c)| l + c).collect();
            holds(&changed)
        })
    });
    if rows.is_empty() || !(pressed && holds(&loads)) {
        return None;
    }
    let sliding = sliding.into_iter().map(|(_, weights)| {
        let mut field = vec![[0.0; 2]; space.nodes().len()];
        for (motion, weight) in motions.iter().zip(weights) {
            for (field, r) in field.iter_mut().zip(motion) {
                *field = [field[0] + weight * r[0], field[1] + weight * r[1]];
            }
        }
        field
    });
    Some(orthonormal(sliding))
}

/// Fields with orthonormal nodal values that span the same.
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

/// field <- field - weight * other
fn subtract(field: &mut [[f64; 2]], other: &[[f64; 2]], weight: f64) {
    for (f, o) in field.as_flattened_mut().iter_mut().zip(other.as_flattened()) {
        *f -= weight * o;
    }
}

/// u less its part along `slides`: of all solutions the one of least norm.
pub fn least_norm(u: &mut [[f64; 2]], slides: &[Vec<[f64; 2]>]) {
    for slide in slides {
        let along = inner(slide, u);
        subtract(u, slide, along);
    }
}

/// One component of a node for each slide, so that no slide is left free when these components are held: those among
/// `free` that move most.
pub fn pins(slides: &[Vec<[f64; 2]>], free: impl Fn(usize, usize) -> bool) -> Vec<(usize, usize)> {
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

/// The part of `target` that no combination of the rows with weights >= 0 reaches, if it is larger than `tolerance`.
fn leaving(rows: &[Vec<f64>], target: &[f64], tolerance: f64) -> Option<Vec<f64>> {
    // The rows in use and their weights.
    let mut used: Vec<(usize, f64)> = Vec::new();
    let mut rest = target.to_vec();
    for _ in 0..MOST_EXCHANGES {
        if dot(&rest, &rest).sqrt() <= tolerance {
            return None;
        }
        let norm = |c: &[f64]| dot(c, c).sqrt();
        let gain = |i: &usize| dot(&rows[*i], &rest) / norm(&rows[*i]);
        let fresh =
            (0..rows.len()).filter(|i| norm(&rows[*i]) > 0.0 && used.iter().all(|(u, _)| u != i));
        let best = fresh.max_by(|i, j| gain(i).total_cmp(&gain(j)));
        let Some(best) = best.filter(|i| gain(i) > tolerance * 1e-3) else { break };
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
            let step = used
                .iter()
                .enumerate()
                .filter(|(j, _)| weights[*j] <= 0.0)
                .map(|(j, (_, old))| old / (old - weights[j]))
                .fold(f64::INFINITY, f64::min);
            let t = step.min(1.0);
            for (j, (_, weight)) in used.iter_mut().enumerate() {
                *weight += t * (weights[j] - *weight);
            }
            if step > 1.0 {
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
    Some(rest).filter(|rest| dot(rest, rest).sqrt() > tolerance)
}

/// The method is finite; this bounds it against rounding.
const MOST_EXCHANGES: usize = 200;

#[cfg(test)]
mod tests {
    use super::*;

    /// (down, turn): a plate on supports at these places, pressed by a unit force at `at`.
    fn presses(supports: &[f64], at: f64) -> bool {
        let rows: Vec<Vec<f64>> = supports.iter().map(|x| vec![1.0, *x]).collect();
        leaving(&rows, &[1.0, at], 1e-9).is_none()
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
        let motion = leaving(&rows, &[1.0, 2.0], 1e-9).unwrap();
        assert!(rows.iter().all(|c| c[0] * motion[0] + c[1] * motion[1] <= 1e-12), "admitted");
        assert!(motion[0] + 2.0 * motion[1] > 0.0, "and the loads do work on it");
    }

    #[test]
    fn pins_stop_every_slide() {
        let slides = vec![vec![[0.6, 0.0], [0.8, 0.0]], vec![[0.8, 0.0], [-0.6, 0.0]]];
        let mut pins = pins(&slides, |_, _| true);
        pins.sort_unstable();
        assert_eq!(pins, [(0, 0), (1, 0)]);
    }
}
