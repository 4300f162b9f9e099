//! v from a displacement: it gets the prescribed values, and is pushed out of the obstacle.

use nalgebra::Vector2;

use super::contact::{Contact, NEAR_THE_END};
use super::field::Field;
use super::parts::{Parts, held_along};
use crate::fem::BoundaryEdge;

/// v: u with the prescribed values, and pushed out of the obstacle at the vertices of Gamma_C and, if it is quadratic, between
/// them.
pub(super) fn admissible(parts: &Parts, u: &Field) -> Field {
    let mut field = u.clone();
    let v = &mut field.vertices;
    for (vertex, v) in v.iter_mut().enumerate() {
        *v = match (parts.held_alone(vertex), parts.prescribed[vertex]) {
            (Some((d, w)), _) => held_along(d, w, *v),
            (None, [Some(x), Some(y)]) => [x, y],
            (None, _) => *v,
        };
    }
    let reach = parts.mesh.vertices().iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
    let size = u.vertices.iter().flatten().fold(0.0_f64, |max, u| max.max(u.abs()));
    // At a corner two edges push; the second may push back into the first, so some rounds.
    for _ in 0..8 {
        let mut moved = false;
        for edge in &parts.contact {
            let ends = parts.mesh.ends(edge.edge);
            let free = [0, 1].map(|k| {
                let (n, data) = (edge.directions[k], parts.prescribed[ends[k]]);
                match parts.frames.get(&ends[k]) {
                    Some(&d) => {
                        let across = Vector2::new(-d[1], d[0]);
                        across * across.dot(&n)
                    }
                    None => [0, 1].map(|c| if data[c].is_none() { n[c] } else { 0.0 }).into(),
                }
            });
            let oblique = ends.map(|vertex| parts.frames.contains_key(&vertex));
            let margin = |k: usize| {
                let n = edge.directions[k];
                // Balls must see it, also on a part of the edge between places as far out as the body reaches.
                let is_rounded = oblique[k] || (n[0] != 0.0 && n[1] != 0.0);
                let scale = edge.gap[k].abs() + if is_rounded { size } else { 0.0 };
                64.0 * f64::EPSILON * scale * reach / edge.length / NEAR_THE_END
            };
            for (k, vertex) in ends.into_iter().enumerate() {
                let along = free[k].dot(&edge.directions[k]);
                let beyond = Vector2::from(v[vertex]).dot(&edge.directions[k]) - edge.gap[k];
                let margin = margin(k);
                if beyond > -margin && along > 0.0 && (beyond > 0.0 || margin > 0.0) {
                    let step = (beyond + 2.0 * margin) / along;
                    v[vertex] = (Vector2::from(v[vertex]) - free[k] * step).into();
                    moved = true;
                }
            }
            if edge.turns() && u.bulges.is_none() {
                // Between the ends it is at most the mean of the products of each with the other's direction.
                let [d, e] = edge.directions;
                let along = free[0].dot(&e) + free[1].dot(&d);
                let at = ends.map(|vertex| Vector2::from(v[vertex]));
                let beyond = at[0].dot(&e) + at[1].dot(&d) - edge.gap[0] - edge.gap[1];
                let margin = margin(0) + margin(1);
                if beyond > -margin && along > 0.0 {
                    let step = (beyond + 2.0 * margin) / along;
                    for k in 0..2 {
                        v[ends[k]] = (at[k] - free[k] * step).into();
                    }
                    moved = true;
                }
            }
        }
        if !moved {
            break;
        }
    }
    if let Some(bulges) = &mut field.bulges {
        parts.hold_between(bulges);
        for edge in &parts.contact {
            let BoundaryEdge { triangle, local } = edge.edge;
            let bulge = &mut bulges[parts.mesh.triangle_edges()[triangle][local]];
            let at_ends =
                parts.mesh.ends(edge.edge).map(|vertex| Vector2::from(field.vertices[vertex]));
            push_between(edge, at_ends, bulge, [reach, size]);
        }
    }
    field
}

/// Makes the Bernstein coefficients of v . d - g between the ends of an edge of Gamma_C negative, by the bulge of v. The body
/// reaches as far out as `reach` and v is at most `size`.
fn push_between(
    edge: &Contact,
    v: [Vector2<f64>; 2],
    bulge: &mut [f64; 2],
    [reach, size]: [f64; 2],
) {
    let ([d, e], [g, h]) = (edge.directions, edge.gap);
    let (mean, own) = ((d + e) / 2.0, Vector2::from(*bulge));
    let middle = (v[0] + v[1]) / 2.0 + own * 2.0;
    let between = (g + h) / 2.0 + 2.0 * edge.gap_bulge;
    let tilted = if d[0] != 0.0 && d[1] != 0.0 { size } else { 0.0 };
    let largest = v[0].dot(&d).abs() + v[1].dot(&e).abs() + own.dot(&d).abs() + tilted;
    let scale = largest + g.abs() + h.abs() + edge.gap_bulge.abs();
    let margin = 64.0 * f64::EPSILON * scale * reach / edge.length / NEAR_THE_END;
    let step = if edge.turns() {
        // v . d is a cubic: three times its coefficients.
        let one = 2.0 * (middle.dot(&d) - between) + v[0].dot(&e) - g;
        let other = 2.0 * (middle.dot(&e) - between) + v[1].dot(&d) - h;
        let step = |beyond: f64, along: f64| (beyond + 6.0 * margin) / (4.0 * along);
        step(one, mean.dot(&d)).max(step(other, mean.dot(&e)))
    } else {
        (middle.dot(&d) - between + 2.0 * margin) / (2.0 * d.dot(&d))
    };
    if step > 0.0 {
        *bulge = (own - mean * step).into();
    }
}
