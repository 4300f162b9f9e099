//! v from a displacement: it gets the prescribed values, and is pushed out of the obstacle.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::contact::Contact;
use super::field::Field;
use super::parts::{Free, ProblemParts, held_along};
use crate::fem::BoundaryEdge;

/// v: u with the prescribed values, and pushed out of the obstacle at the vertices of Gamma_C and, if it is quadratic, between
/// them; on the edge k of Gamma_C by `further[k]` more than doubles ask for.
pub(super) fn admissible(parts: &ProblemParts, u: &Field, further: &[f64]) -> Field {
    let mut field = u.clone();
    let v = &mut field.vertices;
    for (vertex, v) in v.iter_mut().enumerate() {
        *v = match (parts.held_alone(vertex), parts.prescribed[vertex]) {
            (Some((d, w)), _) => held_along(d, w, *v),
            (None, [Some(x), Some(y)]) => [x, y],
            (None, _) => *v,
        };
    }
    let size = u.vertices.iter().flatten().fold(0.0_f64, |max, u| max.max(u.abs()));
    let mut walls: BTreeMap<usize, Vec<Wall>> = BTreeMap::new();
    for (edge, further) in parts.contact.iter().zip(further) {
        for (k, vertex) in parts.mesh.ends(edge.edge).into_iter().enumerate() {
            let (n, gap) = (edge.directions[k], edge.gap[k]);
            // Balls must see it.
            let is_rounded = parts.frames.contains_key(&vertex) || is_tilted(n);
            let scale = gap.abs() + if is_rounded { size } else { 0.0 };
            let margin = 64.0 * f64::EPSILON * scale + further;
            let (most, further) = (gap - margin, *further);
            walls.entry(vertex).or_default().push(Wall { n, gap, further, most, margin });
        }
    }
    // On an edge along which the direction turns, both ends may have to give way.
    for _ in 0..8 {
        for (&vertex, walls) in &walls {
            let free = parts.free_at(vertex);
            let out = out_of(walls, v[vertex].into(), free);
            v[vertex] = match (parts.frames.get(&vertex), parts.held_alone(vertex)) {
                (Some(_), Some((d, w))) => held_along(d, w, out.into()),
                _ => out.into(),
            };
        }
        let mut moved = false;
        for (edge, further) in parts.contact.iter().zip(further) {
            if !edge.turns() || u.bulges.is_some() {
                continue;
            }
            // Between the ends it is at most the mean of the products of each with the other's direction.
            let (ends, [d, e]) = (parts.mesh.ends(edge.edge), edge.directions);
            let free = [0, 1].map(|k| match parts.free_at(ends[k]) {
                Free::All => edge.directions[k],
                Free::Along(t) => t * t.dot(&edge.directions[k]),
                Free::Nothing => Vector2::zeros(),
            });
            let along = free[0].dot(&e) + free[1].dot(&d);
            let at = ends.map(|vertex| Vector2::from(v[vertex]));
            let beyond = at[0].dot(&e) + at[1].dot(&d) - edge.gap[0] - edge.gap[1];
            let scale = edge.gap[0].abs() + edge.gap[1].abs() + 2.0 * size;
            let margin = 64.0 * f64::EPSILON * scale + 2.0 * further;
            if beyond > -margin && along > 0.0 {
                let step = (beyond + 2.0 * margin) / along;
                for k in 0..2 {
                    v[ends[k]] = (at[k] - free[k] * step).into();
                }
                moved = true;
            }
        }
        if !moved {
            break;
        }
    }
    for (&vertex, walls) in &mut walls {
        let all = walls.iter().all(|wall| wall.further == 0.0 && !is_tilted(wall.n));
        if all && matches!(parts.free_at(vertex), Free::All) {
            walls.sort_by(|a, b| b.gap.total_cmp(&a.gap));
            walls.iter().for_each(|wall| touch(wall.n, wall.gap, size, &mut v[vertex]));
        }
    }
    if let Some(bulges) = &mut field.bulges {
        parts.hold_between(bulges);
        for (edge, further) in parts.contact.iter().zip(further) {
            let BoundaryEdge { triangle, local } = edge.edge;
            let bulge = &mut bulges[parts.mesh.triangle_edges()[triangle][local]];
            let at_ends =
                parts.mesh.ends(edge.edge).map(|vertex| Vector2::from(field.vertices[vertex]));
            push_between(edge, at_ends, bulge, (size, *further));
            if *further == 0.0 && !edge.turns() {
                touch(edge.directions[0], edge.gap_bulge, size + edge.gap[0].abs(), bulge);
            }
        }
    }
    field
}

/// n is not along an axis.
fn is_tilted(n: Vector2<f64>) -> bool {
    n[0] != 0.0 && n[1] != 0.0
}

/// Puts v, which may be `size` large, on the obstacle to the last bit, where it is there but for rounding, and n is along an
/// axis.
fn touch(n: Vector2<f64>, gap: f64, size: f64, v: &mut [f64; 2]) {
    let near = 512.0 * f64::EPSILON * (gap.abs() + size);
    for c in 0..2 {
        if n[c].abs() == 1.0 && (v[c] * n[c] - gap).abs() <= near {
            v[c] = n[c] * gap;
        }
    }
}

/// v . n is to be at most `most`, which is `margin` less than what is allowed.
struct Wall {
    n: Vector2<f64>,
    gap: f64,
    /// The amount by which it is pushed out beyond what doubles ask for.
    further: f64,
    most: f64,
    margin: f64,
}

/// The place nearest to v on the right side of all walls; where there is none, a place on that of one of them.
fn out_of(walls: &[Wall], v: Vector2<f64>, free: Free) -> Vector2<f64> {
    let is_out = |x: &Vector2<f64>| walls.iter().all(|w| x.dot(&w.n) <= w.most + w.margin / 2.0);
    if is_out(&v) {
        return v;
    }
    let (alone, n): (Vec<_>, Vec<_>) = walls
        .iter()
        .filter_map(|wall| {
            let n = match free {
                Free::All => wall.n,
                Free::Along(t) => t * t.dot(&wall.n),
                Free::Nothing => return None,
            };
            let along = n.dot(&wall.n);
            let step = (v.dot(&wall.n) - wall.most) / along;
            (along > 0.0).then(|| (v - n * step, wall))
        })
        .unzip();
    let mut places = alone.clone();
    if matches!(free, Free::All) {
        for (k, a) in n.iter().enumerate() {
            for b in &n[..k] {
                let sine = a.n.perp(&b.n);
                if sine.abs() > 1e-6 {
                    let turned = |n: Vector2<f64>| Vector2::new(-n.y, n.x);
                    places.push((turned(a.n) * b.most - turned(b.n) * a.most) / sine);
                }
            }
        }
    }
    let far = |x: &Vector2<f64>| (x - v).dot(&(x - v));
    let nearest = places.into_iter().filter(is_out).min_by(|a, b| far(a).total_cmp(&far(b)));
    let farthest = || alone.into_iter().max_by(|a, b| far(a).total_cmp(&far(b)));
    nearest.or_else(farthest).unwrap_or(v)
}

/// Makes the Bernstein coefficients of v . d - g between the ends of an edge of Gamma_C negative, by the bulge of v, which is at
/// most `size`, and `further` than that.
fn push_between(
    edge: &Contact,
    v: [Vector2<f64>; 2],
    bulge: &mut [f64; 2],
    (size, further): (f64, f64),
) {
    let ([d, e], [g, h]) = (edge.directions, edge.gap);
    let (mean, own) = ((d + e) / 2.0, Vector2::from(*bulge));
    let middle = (v[0] + v[1]) / 2.0 + own * 2.0;
    let between = (g + h) / 2.0 + 2.0 * edge.gap_bulge;
    let tilted = if is_tilted(d) { size } else { 0.0 };
    let largest = v[0].dot(&d).abs() + v[1].dot(&e).abs() + own.dot(&d).abs() + tilted;
    let scale = largest + g.abs() + h.abs() + edge.gap_bulge.abs();
    let margin = 64.0 * f64::EPSILON * scale + further;
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
