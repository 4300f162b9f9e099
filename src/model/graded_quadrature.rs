//! Quadrature that follows a function which is smooth only piece by piece: triangles and edges are cut along the line x = c
//! where it has a kink, and around the point where it is singular.
//!
//! A triangle that holds the singular point is cut into triangles with that point as their first vertex. On them the
//! distance from it is rho = t^4, t in \[0, 1\]: then rho^(alpha-1), alpha > 1/2, squared and times rho d(rho), is a power of
//! t above 3 times dt, smooth enough for a Gauss rule. An edge that ends at the singular point is graded likewise. Pieces
//! near the singular point get more points, for the rules converge the more slowly the nearer it is.
//! Places are computed from the singular point outwards, so that their distance from it keeps its digits.

use nalgebra::Vector2;

use super::mesh::{ROUNDED, length};
use super::quadrature;
use crate::kernel::Triangle;

/// Where a function is less smooth than elsewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// c, if it has a kink along x = c.
    pub kink: Option<f64>,
    /// Where it is singular.
    pub singular: Option<Singularity>,
}

/// A singular point on the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Singularity {
    /// The place.
    pub point: [f64; 2],
    /// g, such that with the distance r = t^g along an edge the integrand is smooth in t.
    pub edge_grading: f64,
}

/// rho = t^GRADING on a triangle at the singular point.
const GRADING: i32 = 4;

/// The factor by which a piece that is graded or near the singular point gets more points in each direction.
const MORE: usize = 3;

/// A rule for functions with some [`Features`].
#[derive(Clone, Debug)]
pub struct Rule {
    features: Features,
    plain: Vec<([f64; 3], f64)>,
    near: Vec<([f64; 3], f64)>,
    graded: Vec<([f64; 3], f64)>,
    gauss: Vec<(f64, f64)>,
    more_gauss: Vec<(f64, f64)>,
}

/// A part of a triangle: its corners as places and as barycentric coordinates in the whole.
type Corners = [(Vector2<f64>, [f64; 3]); 3];

/// A point of a rule on an edge.
#[derive(Clone, Copy, Debug)]
pub struct EdgePoint {
    /// The parameter on the edge, from 0 at its start to 1 at its end.
    pub s: f64,
    /// The place.
    pub x: [f64; 2],
    /// The weight; over the whole edge they add up to 1.
    pub weight: f64,
}

impl Rule {
    /// With `n` points in each direction on a smooth piece.
    pub fn new(features: Features, n: usize) -> Self {
        Rule {
            features,
            plain: quadrature::collapsed(n, 1),
            near: quadrature::collapsed(MORE * n, 1),
            graded: quadrature::collapsed(MORE * n, GRADING),
            gauss: quadrature::gauss(n),
            more_gauss: quadrature::gauss(MORE * n),
        }
    }

    /// The barycentric coordinates of the points on a triangle without features, in the order of [`Rule::on_triangle`].
    pub(crate) fn plain(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.plain.iter().map(|(l, _)| *l)
    }

    /// Calls `f` with barycentric coordinates, place and weight of every point; the weights add up to the area.
    pub fn on_triangle(
        &self,
        triangle: &Triangle<f64>,
        mut f: impl FnMut([f64; 3], [f64; 2], f64),
    ) {
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let whole: Corners = [0, 1, 2].map(|i| (triangle.vertices[i], unit[i]));
        for piece in cut(whole, self.features.kink) {
            match self.features.singular.and_then(|singular| around(&piece, singular.point)) {
                Some(parts) => parts.iter().for_each(|part| apply(part, &self.graded, &mut f)),
                None if self.is_near(&piece.map(|(x, _)| x)) => apply(&piece, &self.near, &mut f),
                None => apply(&piece, &self.plain, &mut f),
            }
        }
    }

    /// A piece with these corners is near the singular point: no further from it than its own size. Beyond that n Gauss points
    /// leave some 6^(-2 n) (the singularity lies on an ellipse around the piece with semi-axes that add up to 3 + 8^(1/2) times
    /// its half); at a third of the size, which is what a point inside an edge may leave to the neighbours, it would be 3^(-2 n).
    fn is_near(&self, corners: &[Vector2<f64>]) -> bool {
        let distance = |a: Vector2<f64>, b: Vector2<f64>| length(a - b);
        self.features.singular.is_some_and(|singular| {
            let first = corners[0];
            let size = corners.iter().map(|&x| distance(x, first)).fold(0.0, f64::max);
            corners.iter().any(|&x| distance(x, singular.point.into()) <= size)
        })
    }

    /// Calls `f` with the points on the edge from `ends[0]` to `ends[1]`, cut at the features and at the parameters `cuts`
    /// inside (0, 1).
    pub fn on_edge(
        &self,
        ends: [[f64; 2]; 2],
        cuts: impl IntoIterator<Item = f64>,
        mut f: impl FnMut(EdgePoint),
    ) {
        let [a, b] = ends.map(Vector2::from);
        let direction = b - a;
        let squared = direction.dot(&direction);
        let at_kink = self.features.kink.map(|c| (c - a[0]) / direction[0]);
        let singular = self.features.singular.map(|singular| {
            let from_start = Vector2::from(singular.point) - a;
            let along = from_start.dot(&direction) / squared;
            let across = from_start.perp(&direction) / squared;
            // A point off the line of the edge is nowhere on the edge.
            (if across.abs() <= ROUNDED { along } else { f64::NAN }, singular)
        });
        let mut all = vec![0.0, 1.0];
        let at_point = singular.map(|(s, _)| s);
        let inside = |s: &f64| ROUNDED < *s && *s < 1.0 - ROUNDED;
        all.extend(cuts.into_iter().chain(at_kink).chain(at_point).filter(inside));
        all.sort_unstable_by(f64::total_cmp);
        for piece in all.windows(2) {
            let (low, high) = (piece[0], piece[1]);
            let place = |s: f64| a + s * direction;
            let near =
                |s: f64| singular.filter(|(at, _)| (s - at).abs() <= ROUNDED).map(|(_, p)| (s, p));
            let Some((from, Singularity { point, edge_grading })) =
                near(low).or_else(|| near(high))
            else {
                let near = self.is_near(&[place(low), place(high)]);
                for &(t, weight) in if near { &self.more_gauss } else { &self.gauss } {
                    let s = low + t * (high - low);
                    f(EdgePoint { s, x: place(s).into(), weight: weight * (high - low) });
                }
                continue;
            };
            let (sign, other) = if from == low { (1.0, high) } else { (-1.0, low) };
            let point = Vector2::from(point);
            let to_other = place(other) - point;
            for &(t, weight) in &self.more_gauss {
                let r = t.powf(edge_grading);
                f(EdgePoint {
                    s: from + sign * r * (high - low),
                    x: (point + r * to_other).into(),
                    weight: weight * edge_grading * t.powf(edge_grading - 1.0) * (high - low),
                });
            }
        }
    }
}

/// Twice the signed area of a triangle.
fn double_area(vertices: [Vector2<f64>; 3]) -> f64 {
    Triangle { vertices }.double_area()
}

fn apply(piece: &Corners, rule: &[([f64; 3], f64)], f: &mut impl FnMut([f64; 3], [f64; 2], f64)) {
    let places = Triangle { vertices: piece.map(|(x, _)| x) };
    let area = places.double_area().abs() / 2.0;
    for &(own, weight) in rule {
        let l = [0, 1, 2].map(|i| (0..3).map(|k| own[k] * piece[k].1[i]).sum());
        f(l, places.point(own).into(), weight * area);
    }
}

/// The parts of a triangle on the two sides of the line x = c.
fn cut(piece: Corners, kink: Option<f64>) -> Vec<Corners> {
    let side = |c: f64, k: usize| piece[k].0[0] - c;
    match kink {
        Some(c) if (0..3).any(|k| side(c, k) < 0.0) && (0..3).any(|k| side(c, k) > 0.0) => {
            [1.0, -1.0].into_iter().flat_map(|sign| half(&piece, c, sign)).collect()
        }
        _ => vec![piece],
    }
}

/// The part of a triangle where sign (x - c) >= 0: one triangle, or two that make a quadrilateral.
fn half(piece: &Corners, c: f64, sign: f64) -> Vec<Corners> {
    let mut polygon = Vec::with_capacity(4);
    for k in 0..3 {
        let (a, b) = (piece[k], piece[(k + 1) % 3]);
        let (da, db) = (a.0[0] - c, b.0[0] - c);
        if sign * da >= 0.0 {
            polygon.push(a);
        }
        if da * db < 0.0 {
            let s = da / (da - db);
            let l = [0, 1, 2].map(|i| a.1[i] + s * (b.1[i] - a.1[i]));
            polygon.push((Vector2::new(c, a.0.y + s * (b.0.y - a.0.y)), l));
        }
    }
    (1..polygon.len().saturating_sub(1)).map(|k| [polygon[0], polygon[k], polygon[k + 1]]).collect()
}

/// The triangle cut into triangles with `point` as their first vertex; `None` if it doesn't hold the point.
fn around(piece: &Corners, point: [f64; 2]) -> Option<Vec<Corners>> {
    let point = Vector2::from(point);
    let [a, b, c] = *piece;
    let whole = double_area(piece.map(|(x, _)| x));
    let sides = [[b, c], [c, a], [a, b]];
    let shares = sides.map(|[q, r]| double_area([point, q.0, r.0]) / whole);
    if shares.iter().any(|&share| share < -ROUNDED) {
        return None;
    }
    let l = [0, 1, 2].map(|i| (0..3).map(|k| shares[k] * piece[k].1[i]).sum());
    let parts = sides.into_iter().zip(shares).filter(|(_, share)| *share > ROUNDED);
    Some(parts.map(|([q, r], _)| [(point, l), q, r]).collect())
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn edges_are_graded_towards_a_singular_point_at_either_end_or_inside() {
        for c in [0.2, 0.4, 0.7] {
            // The singular point is the origin, where |x| keeps its digits.
            let ends = [[0.2 - c, 0.0], [0.7 - c, 0.0]];
            let singular = Some(Singularity { point: [0.0, 0.0], edge_grading: 5.0 });
            let mut sum = 0.0;
            let rule = Rule::new(Features { kink: None, singular }, 8);
            rule.on_edge(ends, [], |p| sum += 0.5 * p.weight * p.x[0].abs().powf(-0.8));
            let exact = 5.0 * ((c - 0.2_f64).powf(0.2) + (0.7 - c).powf(0.2));
            // With the grading 5 the integrand is constant; powers of 0.2 and -0.8 lose a few digits.
            assert_relative_eq!(sum, exact, max_relative = 1e-12);
        }
    }
}
