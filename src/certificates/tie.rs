//! v where two bodies are tied: the jump between them is what it should be. Each body gives way to the other by what is stiff there; a
//! component that is prescribed on one of them stays.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::certificate::{Certificate, Edge, Law, Role, Tied, is_oblique, place};
use super::errors::CertifyError;

/// Ties the bodies of a certificate.
///
/// # Errors
/// A place where what is prescribed on both bodies is not the jump between them.
pub(super) fn tie(certificate: &mut Certificate) -> Result<(), CertifyError> {
    let mut moduli = vec![0.0; certificate.edges.len()];
    for piece in &certificate.pieces {
        piece.edges.iter().for_each(|&e| moduli[e] = piece.material.mu());
    }
    let mut known: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for e in 0..certificate.edges.len() {
        agree(certificate, e, &mut known);
    }
    let tied: Vec<Tied> = certificate.tied().collect();
    for &Tied { edge, other, law, d, gap } in &tied {
        let share = share(&moduli, edge, other);
        let offset = law.offset();
        for k in 0..2 {
            let points = [certificate.edges[edge].ends[k], certificate.edges[other].ends[1 - k]];
            let [own, there] = points.map(|p| certificate.at_own(p));
            let (Some((own, given)), Some((there, held))) = (own, there) else { continue };
            let both = [0, 1].map(|c| given[c].is_some() && held[c].is_some());
            let off = off(law, (own, there, both), d[k], [gap[k], offset[k]]);
            let mut moved = [Vector2::from(own), Vector2::from(there)];
            for c in 0..2 {
                let share = match (given[c], held[c]) {
                    (Some(_), Some(_))
                        if off[c].abs() > ROUNDING * (own[c].abs() + there[c].abs()) =>
                    {
                        let [x, y] = place(certificate, points[0]).into();
                        return Err(CertifyError::Unsupported(format!(
                            "at ({x}, {y}) two bodies that may not open have prescribed displacements that differ"
                        )));
                    }
                    (Some(_), Some(_)) => continue,
                    (Some(_), None) => 0.0,
                    (None, Some(_)) => 1.0,
                    (None, None) => share,
                };
                moved[0][c] -= share * off[c];
                moved[1][c] += (1.0 - share) * off[c];
            }
            for (p, v) in points.into_iter().zip(moved) {
                match (p.checked_sub(certificate.vertices.len()), &mut certificate.curved) {
                    (Some(cut), Some(curved)) => curved.at_cuts[cut] = v.into(),
                    (None, _) => certificate.displacement[p] = v.into(),
                    (Some(_), None) => {}
                }
            }
        }
    }
    // On the first bodies it is what that on the second ones makes it.
    let bulges = certificate.shape::<f64>().bulges;
    let (Some(bulges), Some(curved)) = (bulges, &mut certificate.curved) else { return Ok(()) };
    for Tied { edge, other, .. } in tied {
        let off = Vector2::from(curved.bulges[edge]) - bulges[edge];
        let share = share(&moduli, edge, other);
        let there = Vector2::from(curved.bulges[other]);
        curved.bulges[edge] = (bulges[edge] + off * (1.0 - share)).into();
        curved.bulges[other] = (there + off * (1.0 - share)).into();
    }
    Ok(())
}

/// The part of a jump between two edges that goes to the first body.
fn share(moduli: &[f64], edge: usize, other: usize) -> f64 {
    let [stiff, soft] = [moduli[edge], moduli[other]];
    soft / (stiff + soft)
}

/// Gives the jump at the ends of a tied edge the numbers that it has there on the edge before, from which it differs by rounding.
fn agree(certificate: &mut Certificate, e: usize, known: &mut BTreeMap<usize, [f64; 2]>) {
    let Edge { ends, role: Role::Contact { gap, law, .. } } = &mut certificate.edges[e] else {
        return;
    };
    if !law.is_tied() {
        return;
    }
    for k in 0..2 {
        let own = [gap[k], law.offset()[k]];
        let jump = *known.entry(ends[k]).or_insert(own);
        let size = own.iter().map(|x| x.abs()).fold(0.0, f64::max);
        if (0..2).all(|c| (jump[c] - own[c]).abs() <= ROUNDING * size) {
            gap[k] = jump[0];
            if let Law::Bonded { offset, .. } = law {
                offset[k] = jump[1];
            }
        }
    }
}

/// Prescribed displacements and jumps that differ by less do so by rounding.
const ROUNDING: f64 = 1e-12;

/// The part of the jump that is too much; none of it in a component that is prescribed on `both` bodies, if they slide along another, too.
fn off(
    law: Law,
    (own, there, both): ([f64; 2], [f64; 2], [bool; 2]),
    d: [f64; 2],
    [g, h]: [f64; 2],
) -> Vector2<f64> {
    let jump = Vector2::from(own) - Vector2::from(there);
    if law.is_bonded() {
        return jump - Vector2::new(g, h);
    }
    let along = match both {
        [true, false] if is_oblique(d) => Vector2::new(0.0, d[1]),
        [false, true] if is_oblique(d) => Vector2::new(d[0], 0.0),
        _ => Vector2::from(d),
    };
    along * ((jump.dot(&Vector2::from(d)) - g) / along.dot(&along))
}
