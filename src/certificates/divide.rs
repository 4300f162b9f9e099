//! A triangle of a certificate that is cut in two where contact ends on one of its edges.

use nalgebra::Vector2;

use super::certificate::{Certificate, Cut, Edge, Role, Shape, place};
use crate::kernel::Enclosing;
use crate::kernel::composite::Affine;

/// A triangle of the mesh or a part of it.
pub(super) struct SubTriangle {
    pub vertices: [usize; 3],
    pub edges: [usize; 3],
    /// The barycentric coordinates of its vertices in the triangle of the mesh.
    pub places: [[f64; 3]; 3],
}

/// A triangle that was cut in two, from a place on the edge `base` to the opposite vertex. The edge's second part and the cut
/// are the next two edges of the certificate.
pub(super) struct Division {
    /// The ends of the edge, and the place between them.
    pub ends: [usize; 2],
    pub at: f64,
    /// The edge, whose first part keeps its number.
    pub base: usize,
    /// The edges from the opposite vertex to both ends.
    pub sides: [usize; 2],
}

/// Both halves of a part whose edge `base` is cut at a place, with the pressures before and after it.
pub(super) fn cut(
    part: SubTriangle,
    (base, at, pressures): (usize, f64, [[f64; 2]; 2]),
    gap_bulge: f64,
    stress: &Affine<f64>,
    (certificate, divisions): (&mut Certificate, &mut Vec<Division>),
) -> Vec<SubTriangle> {
    let local = part.edges.iter().position(|&e| e == base).unwrap_or_default();
    let [a, b, c] = [0, 1, 2].map(|k| part.vertices[(local + k) % 3]);
    let [at_a, at_b, at_c] = [0, 1, 2].map(|k| part.places[(local + k) % 3]);
    let [next, last] = [1, 2].map(|k| part.edges[(local + k) % 3]);
    let role = certificate.edges[base].role;
    let middle = certificate.vertices.len() + certificate.cuts.len();
    let (whole, at) = on_whole(certificate, [b, c], at);
    certificate.cuts.push(whole);
    let gap_bulge = if certificate.curved.is_some() { gap_bulge } else { 0.0 };
    let [first, second] = [0, 1].map(|half| match role {
        Role::Contact { gap, along, .. } => {
            let inside = gap[0] + at * (gap[1] - gap[0]) + 4.0 * at * (1.0 - at) * gap_bulge;
            let gap = if half == 0 { [gap[0], inside] } else { [inside, gap[1]] };
            let along = along.map(|[d, e]| {
                // One direction stays one: rounding must not make it turn.
                let inside = if d == e { d } else { [0, 1].map(|c| (1.0 - at) * d[c] + at * e[c]) };
                if half == 0 { [d, inside] } else { [inside, e] }
            });
            Role::Contact { pressure: pressures[half], gap, along }
        }
        // Without a traction.
        other => other,
    });
    // The first half keeps the number of the edge.
    certificate.edges[base] = Edge { ends: [b, middle], role: first };
    let other = certificate.edges.len();
    certificate.edges.push(Edge { ends: [middle, c], role: second });
    let [from, to] = [middle, a].map(|p| place(certificate, p));
    let normal = Vector2::new(to.y - from.y, from.x - to.x);
    let at_middle = [0, 1, 2].map(|i| at_b[i] + at * (at_c[i] - at_b[i]));
    let force = [at_middle, at_a].map(|l| stress.at(l).traction(normal).into());
    certificate.edges.push(Edge { ends: [middle, a], role: Role::Inner(force) });
    if let Some(curved) = &mut certificate.curved {
        curved.data[base] = [gap_bulge * at * at, 0.0];
        curved.data.push([gap_bulge * (1.0 - at) * (1.0 - at), 0.0]);
        curved.data.push([0.0; 2]);
    }
    divisions.push(Division { ends: [b, c], at, base, sides: [last, next] });
    vec![
        SubTriangle {
            vertices: [a, b, middle],
            edges: [base, other + 1, last],
            places: [at_a, at_b, at_middle],
        },
        SubTriangle {
            vertices: [a, middle, c],
            edges: [other, next, other + 1],
            places: [at_a, at_middle, at_c],
        },
    ]
}

/// A place on an edge between two vertices, or on a half of one, as a place on the whole; and the place that this is on the
/// half, exactly.
fn on_whole(certificate: &Certificate, ends: [usize; 2], at: f64) -> (Cut, f64) {
    let half =
        |p: usize| p.checked_sub(certificate.vertices.len()).map(|cut| certificate.cuts[cut]);
    match ends.map(half) {
        [None, Some(Cut { ends, .. })] => (Cut { ends, at: at / 2.0 }, at),
        [Some(Cut { ends, .. }), _] => {
            let on_whole = 0.5 + at / 2.0;
            (Cut { ends, at: on_whole }, 2.0 * on_whole - 1.0)
        }
        [None, None] => (Cut { ends, at }, at),
    }
}

/// Restates a displacement with values at the cuts, and bulges on their edges: on a part of length s of an edge, s^2 times
/// the bulge b of the whole; on the cut, the second difference of the quadratic along it.
pub(super) fn divided<S: Enclosing>(mut shape: Shape<S>, divisions: &[Division]) -> Shape<S> {
    for division in divisions {
        let s = S::exactly(division.at);
        let r = S::from(1) - s;
        let [a, b] = division.ends.map(|end| shape.points[end]);
        let mut there = a * r + b * s;
        if let Some(bulges) = &mut shape.bulges {
            let bulge = bulges[division.base];
            let [to_a, to_b] = division.sides.map(|e| bulges[e]);
            there += bulge * (S::from(4) * r * s);
            bulges[division.base] = bulge * (s * s);
            bulges.push(bulge * (r * r));
            bulges.push(to_a * r + to_b * s - bulge * (r * s));
        }
        shape.points.push(there);
    }
    shape
}
