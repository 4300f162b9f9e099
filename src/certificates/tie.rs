//! v where two bodies are tied: the jump between them is what it should be. Each body gives way to the other by what is stiff there; a
//! component that is prescribed on one of them stays.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::certificate::{Certificate, Edge, Law, Role, place};
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
        let Role::Contact { gap, along: Some([d, _]), law, .. } = certificate.edges[e].role else {
            continue;
        };
        let Some(&other) = certificate.facing.get(&e).filter(|_| law.is_tied()) else { continue };
        let [stiff, soft] = [moduli[e], moduli[other]];
        // The part of a jump that goes to the first body.
        let share = soft / (stiff + soft);
        let jump = |k: usize| match law {
            Law::Bonded { offset, .. } => [gap[k], offset[k]],
            _ => [gap[k], 0.0],
        };
        for k in 0..2 {
            let points = [certificate.edges[e].ends[k], certificate.edges[other].ends[1 - k]];
            let [own, there] = points.map(|p| certificate.at_own(p));
            let (Some((own, given)), Some((there, held))) = (own, there) else { continue };
            let off = off(law, own, there, d, jump(k));
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
        if let Some(curved) = &mut certificate.curved {
            let [own, there] = [e, other].map(|e| curved.bulges[e]);
            let off = off(law, own, there, d, curved.data[e]);
            curved.bulges[e] = (Vector2::from(own) - off * share).into();
            curved.bulges[other] = (Vector2::from(there) + off * (1.0 - share)).into();
        }
    }
    Ok(())
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

/// The part of the jump that is too much.
fn off(law: Law, own: [f64; 2], there: [f64; 2], d: [f64; 2], [g, h]: [f64; 2]) -> Vector2<f64> {
    let jump = Vector2::from(own) - Vector2::from(there);
    match law {
        Law::Bonded { .. } => jump - Vector2::new(g, h),
        _ => {
            let d = Vector2::from(d);
            d * ((jump.dot(&d) - g) / d.dot(&d))
        }
    }
}
