//! The motions that nothing stops at a solution of (8), within the clearance of the contact edges that do not press.

use super::grip::across;
use super::solvability::{Slides, all, joined, moves, negligible, rows};
use crate::contact::Law;
use crate::contact::discretization::Discretization;
use crate::contact::piece::Piece;
use crate::kernel::{DoubleDouble, Response};
use crate::linear::dense::{dot, norm};
use crate::model::rigid::{FreeMotion, NEGLIGIBLE, Parts, null_space};

/// The share of the largest P above which an edge presses; smaller P may be left by the tolerance of Newton's method. At a
/// hundredth of this share, edges that touch without a force would count as holding the body.
const PRESSES: f64 = 1e-8;

impl Slides {
    /// All motions that nothing stops where `u` solves (8), within the clearance of the edges that do not press. `None` where
    /// supports hold the body. P is `known` where it belongs to a displacement that is known to more than doubles: P of that in
    /// doubles may have no digit.
    pub(crate) fn around(
        d: &Discretization,
        u: &[[f64; 2]],
        known: Option<&[DoubleDouble]>,
    ) -> Option<Slides> {
        let idle = &d.slides.as_ref()?.idle;
        let size = |v: &[f64]| v.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        // Newton's method takes P of an idle piece for negative, so the body is moved until P is.
        let of_piece = |(piece, is_idle): (&Piece, &bool)| match known {
            Some(p) if !is_idle => p[piece.functionals()].iter().map(|p| p.head()).collect(),
            _ => piece.p(u),
        };
        let all: Vec<Vec<f64>> = d.contact.iter().zip(idle).map(of_piece).collect();
        let p: Vec<&[f64]> = d.contact.iter().zip(&all).map(|(edge, p)| edge.along(p)).collect();
        // Tails are there if P is known to them.
        let is_fine = known.is_some_and(|p| p.iter().any(|p| p.tail() != 0.0));
        let unit = if is_fine { f64::EPSILON * f64::EPSILON } else { f64::EPSILON };
        let degree = d.space.degree();
        let most = |p: &[f64]| degree.bernstein(p).into_iter().fold(0.0, f64::max);
        let pushing = p.iter().zip(&d.contact).filter(|(_, piece)| !pulls(piece));
        let largest = pushing.map(|(p, _)| most(p)).fold(0.0, f64::max);
        let far = size(u.as_flattened());
        let presses = |((p, all), piece): ((&&[f64], &Vec<f64>), &Piece)| {
            let gap = piece.geometry.gaps().fold(0.0, |m: f64, g| m.max(g.abs()));
            let rounding = 8.0 * unit * (far + gap);
            let active = piece.contribution(&d.rule, all).active;
            pulls(piece) || (most(p) > rounding.max(PRESSES * largest) && active > 0.0)
        };
        let pressing = p.iter().zip(&all).zip(&d.contact).map(presses);
        let pressing: Vec<bool> = pressing.zip(idle).map(|(yes, idle)| yes && !idle).collect();
        let parts = Parts::new(d.space.mesh());
        // Friction stops motions unless the loads are on the verge of driving them.
        let rough = d.contact.iter().map(|piece| matches!(piece.geometry.law, Law::Friction(_)));
        let stops: Vec<[bool; 2]> = pressing.iter().zip(rough).map(|(&p, r)| [p, r]).collect();
        let slides = Slides::new(free_where(d, &parts, &stops), &parts, &d.space);
        let (at, basis) = (slides.at(u), &slides.basis);
        let rounding = NEGLIGIBLE.max(d.rounding_of_directions());
        let (mut bounds, mut stopping) = (Vec::new(), Vec::new());
        let edges = d.contact.iter().zip(&p).zip(pressing).zip(idle);
        for (e, (((edge, p), pressing), idle)) in edges.enumerate() {
            if pressing {
                continue;
            }
            let lengths = basis.iter().flat_map(|b| edge.edge_nodes().map(|node| b[node]));
            let none = rounding * lengths.fold(0.0, |m: f64, [x, y]| m.max(x.hypot(y)));
            let coefficients = degree.bernstein(p);
            // No step towards an edge with a positive coefficient where P itself is not positive.
            let is_clear = coefficients.iter().all(|p| *p <= 0.0);
            let open = is_clear || (*idle && degree.maximum(p) > 0.0);
            let jumps: Vec<Vec<f64>> =
                basis.iter().map(|b| degree.bernstein(&edge.jumps(b))).collect();
            for (a, coefficient) in coefficients.into_iter().enumerate() {
                let row: Vec<f64> = jumps.iter().map(|jump| jump[a]).collect();
                if norm(&row) > none {
                    let bound = if open { -coefficient } else { 0.0 } + dot(&row, &at);
                    bounds.push((row, bound));
                    stopping.push(e);
                }
            }
        }
        stopping.dedup();
        Some(Slides { bounds, stopping, idle: idle.clone(), ..slides })
    }
}

/// Returns whether a piece pulls as well as it pushes, and so never lets go.
fn pulls(piece: &Piece) -> bool {
    piece.responses().all(|(response, _)| response == Response::Bilateral)
}

/// The motions of `d` that are stopped neither by supports, nor by contact edges that press, nor by friction along these.
pub(crate) fn free_where(
    d: &Discretization,
    parts: &Parts,
    stops: &[[bool; 2]],
) -> Vec<FreeMotion> {
    let mut free = Vec::new();
    for of_part in &joined(&d.motions, parts, &d.contact) {
        let count = of_part.len();
        let mut rows = all(&rows(of_part, parts, &d.space, &d.contact, |e| stops[e][0]));
        let is_rough = |piece: &Piece| {
            matches!(piece.geometry.law, Law::Friction(_)) && moves(of_part, parts, piece)
        };
        for (piece, _) in d.contact.iter().zip(stops).filter(|(p, s)| s[1] && is_rough(p)) {
            rows.extend(across(of_part, parts, &d.space, piece));
        }
        let none = negligible(&rows, count, d.rounding_of_directions());
        let weights = null_space(&rows, count, |value, _| value > none);
        free.extend(weights.iter().map(|weights| parts.combined(of_part, weights)));
    }
    free
}
