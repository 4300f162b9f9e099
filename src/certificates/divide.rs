//! A triangle of a certificate that is cut where what acts on one of its edges changes: where contact ends, or where a node of the other
//! body of a pair lies.

use nalgebra::Vector2;

use super::certificate::{Certificate, Cut, Edge, Role, Shape, place};
use crate::kernel::Enclosing;
use crate::kernel::composite::Affine;

/// A triangle of the mesh or a part of it.
pub(super) struct SubTriangle {
    pub(crate) vertices: [usize; 3],
    pub(crate) edges: [usize; 3],
    /// The barycentric coordinates of its vertices in the triangle of the mesh.
    pub(crate) places: [[f64; 3]; 3],
}

/// A triangle that was cut in two, from a place on the edge `base` to the opposite vertex. The edge's second part and the cut
/// are the next two edges of the certificate.
pub(super) struct Division {
    /// The ends of the edge.
    pub(crate) ends: [usize; 2],
    /// Where on the edge of the mesh it begins, was cut and ends.
    pub(crate) places: [f64; 3],
    /// The edge, whose first part keeps its number.
    pub(crate) base: usize,
    /// The edges from the opposite vertex to both ends.
    pub(crate) sides: [usize; 2],
}

impl Division {
    /// The place where the edge was cut, in units of it.
    fn at<S: Enclosing>(&self) -> S {
        let [from, at, to] = self.places;
        // Of an edge of the mesh or a half of it, where doubles are exact.
        if (from == 0.0 || to == 1.0) && (to - from == 1.0 || to - from == 0.5) {
            return S::exactly((at - from) / (to - from));
        }
        (S::exactly(at) - S::exactly(from)) / (S::exactly(to) - S::exactly(from))
    }
}

/// Both parts of a triangle whose edge `base` begins, is cut and ends at these places of an edge of the mesh.
pub(super) fn cut(
    part: SubTriangle,
    (base, places): (usize, [f64; 3]),
    stress: &Affine<f64>,
    (certificate, divisions): (&mut Certificate, &mut Vec<Division>),
) -> Vec<SubTriangle> {
    let local = part.edges.iter().position(|&e| e == base).unwrap_or_default();
    let [a, b, c] = [0, 1, 2].map(|k| part.vertices[(local + k) % 3]);
    let [at_a, at_b, at_c] = [0, 1, 2].map(|k| part.places[(local + k) % 3]);
    let [next, last] = [1, 2].map(|k| part.edges[(local + k) % 3]);
    let division = Division { ends: [b, c], places, base, sides: [last, next] };
    let at: f64 = division.at();
    let role = certificate.edges[base].role;
    let middle = certificate.vertices.len() + certificate.cuts.len();
    let end = |p: usize, k: usize| match p.checked_sub(certificate.vertices.len()) {
        None => p,
        Some(cut) => certificate.cuts[cut].ends[k],
    };
    let ends = [end(b, 0), end(c, 1)];
    certificate.cuts.push(Cut { ends, at: places[1] });
    // The first part keeps the number of the edge.
    certificate.edges[base] = Edge { ends: [b, middle], role };
    let other = certificate.edges.len();
    certificate.edges.push(Edge { ends: [middle, c], role });
    let [from, to] = [middle, a].map(|p| place(certificate, p));
    let normal = Vector2::new(to.y - from.y, from.x - to.x);
    let at_middle = [0, 1, 2].map(|i| at_b[i] + at * (at_c[i] - at_b[i]));
    let force = [at_middle, at_a].map(|l| stress.at(l).traction(normal).into());
    certificate.edges.push(Edge { ends: [middle, a], role: Role::Inner(force) });
    if let Some(curved) = &mut certificate.curved {
        curved.data.extend([[0.0; 2]; 2]);
    }
    divisions.push(division);
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

/// Restates a displacement with values at the cuts, and bulges on their edges: on a part of length s of an edge, s^2 times
/// the bulge b of the whole; on the cut, the second difference of the quadratic along it.
pub(super) fn divided<S: Enclosing>(mut shape: Shape<S>, divisions: &[Division]) -> Shape<S> {
    for division in divisions {
        let s: S = division.at();
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
