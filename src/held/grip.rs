//! Motions that supports leave free and friction stops (docs/theory.md, 13.3).
//!
//! Let R be the rigid motions of a part of the body that the supports leave free, L the loads on R, c_i(r) = r_n at the nodes of
//! Gamma_C. With Tresca's friction J_h has a minimiser if L and all functionals near it are
//!
//! sum_i mu_i c_i(r) + sum_e nu_e int_e s r_t,   mu_i >= 0, |nu_e| <= 1:
//!
//! then along every r with r_n <= 0 friction takes more than the loads give. nu_e = 2 w_e - 1 with w_e + w'_e = 1, w_e, w'_e >= 0, makes that
//! non-negative least squares with one more equation for each e. With Coulomb's friction the cone of the c_i is that of
//! c_i + mu r_t and c_i - mu r_t: what friction can do at a node grows with what presses there.

use super::solvability::{Left, MARGIN, jumps, moves, nnls_residual, on_the_verge};
use crate::contact::Law;
use crate::contact::piece::Piece;
use crate::linear::dense::{dot, norm};
use crate::model::law::Bound;
use crate::model::rigid::{FreeMotion, NEGLIGIBLE, Parts};
use crate::model::space::Space;

/// The largest number of rows. Rows of a straight boundary are multiples of each other and count once; beyond this number
/// neighbours are taken together, as if they slid together, which is on the safe side.
const MOST_GRIPS: usize = 40;

/// The work of friction on the motions of a part.
pub(super) struct Grip {
    /// The rows int_e s r_t.
    bounded: Vec<Vec<f64>>,
    /// The rows of the edges of the Friction cones, in place of the c_i of their nodes.
    cones: Vec<Vec<f64>>,
    /// The pieces that have these.
    pub(super) with_cones: Vec<usize>,
}

/// r_t at the nodes of a piece with friction, for each of the motions.
pub(super) fn across(
    motions: &[FreeMotion],
    parts: &Parts,
    space: &Space,
    piece: &Piece,
) -> Vec<Vec<f64>> {
    let nodes = piece.degree.nodes_per_edge();
    (nodes..2 * nodes).map(|i| jumps(motions, parts, space, piece, i)).collect()
}

/// int s N_a of an affine bound s with these values at the ends of a piece, N_a of degree 1 or 2.
fn of_bound([s, t]: [f64; 2], length: f64, nodes: usize) -> Vec<f64> {
    let sixth = length / 6.0;
    match nodes {
        2 => vec![sixth * (2.0 * s + t), sixth * (s + 2.0 * t)],
        _ => vec![sixth * s, sixth * t, 2.0 * sixth * (s + t)],
    }
}

impl Grip {
    /// Friction on the part that has these motions; nothing where there is none. `normal` are the rows c_i of its pieces.
    pub(super) fn new(
        motions: &[FreeMotion],
        parts: &Parts,
        space: &Space,
        contact: &[Piece],
        normal: &[(usize, Vec<Vec<f64>>)],
    ) -> Option<Self> {
        let mut grip = Grip { bounded: Vec::new(), cones: Vec::new(), with_cones: Vec::new() };
        let mut is_rough = false;
        for (e, piece) in contact.iter().enumerate() {
            let Law::Friction(bound) = piece.geometry.law else { continue };
            if !moves(motions, parts, piece) {
                continue;
            }
            is_rough = true;
            let rows = across(motions, parts, space, piece);
            match bound {
                Bound::Tresca([s, t]) | Bound::Given([s, t, _]) => {
                    let weights = of_bound([s, t], piece.length, rows.len());
                    let sum = |k: usize| rows.iter().zip(&weights).map(|(r, w)| w * r[k]).sum();
                    grip.add((0..motions.len()).map(sum).collect());
                }
                Bound::Coulomb(mu) => {
                    grip.with_cones.push(e);
                    let of_piece = normal.iter().find(|(k, _)| *k == e).map_or(&[][..], |(_, c)| c);
                    for (c, t) in of_piece.iter().zip(&rows) {
                        for sign in [-mu, mu] {
                            grip.cones.push(c.iter().zip(t).map(|(c, t)| c + sign * t).collect());
                        }
                    }
                }
            }
        }
        if !is_rough {
            return None;
        }
        while grip.bounded.len() > MOST_GRIPS {
            let add = |pair: &[Vec<f64>]| {
                let mut sum = pair[0].clone();
                for other in &pair[1..] {
                    let sign = if dot(&sum, other) < 0.0 { -1.0 } else { 1.0 };
                    sum.iter_mut().zip(other).for_each(|(s, o)| *s += sign * o);
                }
                sum
            };
            grip.bounded = grip.bounded.chunks(2).map(add).collect();
        }
        Some(grip)
    }

    fn add(&mut self, row: Vec<f64>) {
        let size = norm(&row);
        if size == 0.0 {
            return;
        }
        for other in &mut self.bounded {
            let product = dot(other, &row);
            if product.abs() >= (1.0 - 1e-14) * size * norm(other) {
                let sign = product.signum();
                other.iter_mut().zip(&row).for_each(|(o, r)| *o += sign * r);
                return;
            }
        }
        self.bounded.push(row);
    }

    /// All rows that stop a motion.
    pub(super) fn rows(&self) -> Vec<Vec<f64>> {
        self.bounded.iter().chain(&self.cones).cloned().collect()
    }

    /// The size of what friction can do.
    pub(super) fn size(&self) -> f64 {
        self.bounded.iter().map(|row| norm(row)).fold(0.0, f64::max)
    }

    /// The motion that the loads drive, or would if they were changed a little; `None` if friction and the rows `normal` hold the
    /// body. The loads and `bounded` are divided by `unit`.
    pub(super) fn driven(
        &self,
        normal: &[Vec<f64>],
        loads: &[f64],
        unit: f64,
        none: f64,
    ) -> Option<Left> {
        let (count, grips) = (loads.len(), self.bounded.len());
        let extended = |row: &[f64], k: Option<usize>| {
            let mut all = row.to_vec();
            all.extend((0..grips).map(|e| if k == Some(e) { 1.0 } else { 0.0 }));
            all
        };
        let bounded: Vec<Vec<f64>> =
            self.bounded.iter().map(|row| row.iter().map(|r| r / unit).collect()).collect();
        let cone = normal.iter().chain(&self.cones).filter(|row| norm(row) > none);
        let mut rows: Vec<Vec<f64>> = cone.map(|row| extended(row, None)).collect();
        for (e, row) in bounded.iter().enumerate() {
            let twice: Vec<f64> = row.iter().map(|r| 2.0 * r).collect();
            rows.push(extended(&twice, Some(e)));
            rows.push(extended(&vec![0.0; count], Some(e)));
        }
        let left = |loads: &[f64]| {
            let mut target: Vec<f64> = (0..count)
                .map(|k| loads[k] + bounded.iter().map(|row| row[k]).sum::<f64>())
                .collect();
            target.extend(vec![1.0; grips]);
            let mut motion = nnls_residual(&rows, &target, NEGLIGIBLE * norm(&target).max(1.0))?;
            motion.truncate(count);
            // What is left of a component beside the largest is rounding.
            let most = motion.iter().fold(0.0, |most: f64, w| most.max(w.abs()));
            motion.iter_mut().filter(|w| w.abs() < MARGIN * most).for_each(|w| *w = 0.0);
            Some(motion)
        };
        if let Some(motion) = left(loads) {
            return Some((motion, true));
        }
        let all: Vec<Vec<f64>> =
            normal.iter().chain(&self.cones).chain(&bounded).cloned().collect();
        on_the_verge(&all, none, loads, left).map(|motion| (motion, false))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Degree;
    use crate::model::quadrature::gauss;

    #[test]
    fn friction_grips_at_the_nodes_of_a_piece_by_the_integrals_of_its_bound() {
        for degree in [Degree::One, Degree::Two] {
            for [s, t] in [[1.0, 1.0], [3.0, 0.5], [0.0, 2.0], [0.25, 0.0]] {
                let nodes = degree.nodes_per_edge();
                // Three points are exact for a cubic.
                let integral = |a: usize| -> f64 {
                    let at = |&(x, weight): &(f64, f64)| {
                        weight * ((1.0 - x) * s + x * t) * degree.edge_values(x)[a]
                    };
                    0.75 * gauss(3).iter().map(at).sum::<f64>()
                };
                let found = of_bound([s, t], 0.75, nodes);
                assert_eq!(found.len(), nodes);
                for (a, found) in found.iter().enumerate() {
                    // A dozen roundings of numbers up to 3.
                    assert!((found - integral(a)).abs() <= 1e-14, "{degree:?} {s} {t}: {found}");
                }
                // Control: the bound of the other direction is noticed where it is another one.
                let turned = of_bound([t, s], 0.75, nodes);
                assert_eq!((turned[0] - integral(0)).abs() > 1e-3, s != t, "{turned:?}");
            }
        }
    }
}
