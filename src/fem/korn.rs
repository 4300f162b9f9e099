//! Korn's inequality on V^h with a number for its constant: a bound of |v| at each node by |v|_a, for all v that vanish at the
//! prescribed components. docs/theory.md, 7.6, has the proof; the bound is crude (it adds up magnitudes along a tree of
//! triangles), and it is used where that does no harm: times residuals that are far below rounding.
//!
//! On a triangle v is a rigid motion r_T up to c_T |v|_{a,T}. Motions of neighbours differ on their common edge by what both
//! leave; along the tree that adds up to |r_T - r_root| <= S_T^{1/2} |v|_a; and three prescribed components hold the root's.
//!
//! Everything but the areas and the inverse of a matrix of order 3, which are intervals, is a sum or product of positive
//! doubles of some million terms at most: rounding changes it by far less than the factor `SAFETY`.

use std::collections::VecDeque;

use super::constraints::Constraints;
use super::rigid::Parts;
use super::space::Space;
use crate::fem::Materials;
use crate::kernel::{Element, Interval, Triangle};

/// Covers the rounding of sums and products of positive numbers.
const SAFETY: f64 = 1.001;

/// |v(x_i)| <= `nodes[i]` |v|_a for all v in V^h and all nodes i.
#[derive(Clone, Debug)]
pub struct Korn {
    /// The factors.
    pub nodes: Vec<f64>,
}

impl Korn {
    /// The bound for the fields that vanish at the prescribed components. `None` where a part of the body is not held by
    /// itself, or hardly.
    pub fn new<E: Element<N, M>, const N: usize, const M: usize>(
        space: &Space<E, N, M>,
        materials: &Materials,
        constraints: &Constraints,
    ) -> Option<Self> {
        let mesh = space.mesh();
        let count = mesh.triangles().len();
        let left: Vec<f64> = (0..count)
            .map(|t| squared_remainder::<E, N, M>(space, materials, t))
            .collect::<Option<_>>()?;
        let parts = Parts::new(mesh);
        let mut of_edge = vec![[usize::MAX; 2]; mesh.edge_count()];
        for (t, edges) in mesh.triangle_edges().iter().enumerate() {
            for &edge in edges {
                let slot = usize::from(of_edge[edge][0] != usize::MAX);
                of_edge[edge][slot] = t;
            }
        }
        let (low, high) = mesh
            .vertices()
            .iter()
            .fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(low, high), x| {
                ([0, 1].map(|c| x[c].min(low[c])), [0, 1].map(|c| x[c].max(high[c])))
            });
        let size = (high[0] - low[0]).hypot(high[1] - low[1]);

        // The prescribed components, by the part of a triangle at their node.
        let mut holds: Vec<Vec<Hold>> = vec![Vec::new(); parts.count()];
        let mut seen = vec![usize::MAX; space.nodes().len()];
        for (t, nodes) in space.elements().iter().enumerate() {
            let part = parts.of_triangle()[t];
            // Vertices, whose places are exact. A node counts once for each part.
            for &node in &nodes[..3] {
                if seen[node] != part {
                    seen[node] = part;
                    let at = space.nodes()[node];
                    let directions = constraints.directions(node);
                    holds[part].extend(directions.map(|direction| Hold { t, at, direction }));
                }
            }
        }
        let mut along = vec![f64::INFINITY; count];
        let mut root_motion = vec![0.0; parts.count()];
        for (part, holds) in holds.iter().enumerate() {
            let root = holds.first()?.t;
            along[root] = 0.0;
            let mut queue = VecDeque::from([root]);
            while let Some(t) = queue.pop_front() {
                for (i, &edge) in mesh.triangle_edges()[t].iter().enumerate() {
                    let other = of_edge[edge].into_iter().find(|&o| o != t && o < count);
                    let Some(other) = other.filter(|&o| along[o].is_infinite()) else { continue };
                    let edge = mesh.triangle(t).edge(i);
                    let w = 1.0 + 2.0 * size / edge[0].hypot(edge[1]);
                    along[other] = along[t] + 2.0 * w * w * (left[t] + left[other]);
                    queue.push_back(other);
                }
            }
            let origin = mesh.vertices()[mesh.triangles()[root][0]];
            let of = |hold: &Hold| left[hold.t].sqrt() + along[hold.t].sqrt();
            root_motion[part] = held(holds, origin, size, of)?;
        }
        let mut nodes = vec![f64::INFINITY; space.nodes().len()];
        for (t, members) in space.elements().iter().enumerate() {
            let motion = root_motion[parts.of_triangle()[t]];
            let bound = SAFETY * (left[t].sqrt() + along[t].sqrt() + motion);
            for &node in members {
                nodes[node] = nodes[node].min(bound);
            }
        }
        nodes.iter().all(|n| n.is_finite()).then_some(Korn { nodes })
    }

    /// |x|_2^2 <= this times |v|_a^2 for the free components x of v.
    pub fn sum_of_squares(&self) -> f64 {
        SAFETY * self.nodes.iter().map(|n| n * n).sum::<f64>()
    }

    /// The largest of the factors.
    pub fn largest(&self) -> f64 {
        self.nodes.iter().fold(0.0, |m: f64, &n| m.max(n))
    }
}

/// A prescribed component: v(at) . direction = 0, on triangle t.
#[derive(Clone, Copy, Debug)]
struct Hold {
    t: usize,
    at: [f64; 2],
    direction: [f64; 2],
}

/// c_T^2
fn squared_remainder<E: Element<N, M>, const N: usize, const M: usize>(
    space: &Space<E, N, M>,
    materials: &Materials,
    t: usize,
) -> Option<f64> {
    let doubles = space.mesh().triangle(t);
    let exact = Triangle { vertices: doubles.vertices.map(|x| x.map(Interval::point)) };
    let area = (exact.double_area() / Interval::from(2)).lo();
    let h = space.mesh().diameter(t);
    let material = materials.of(t);
    let mu = Interval::point(material.mu());
    let stiffness = mu.lo().min((mu + Interval::point(material.lambda())).lo());
    if !(area > 0.0 && stiffness > 0.0) {
        return None;
    }
    let affine = h * h / (2.0 * stiffness * area);
    Some(if E::DEGREE == 1 {
        affine
    } else {
        let turning = 1.0 + 3.0 * h * h / area;
        12.0 * affine * turning * turning
    })
}

/// |r| <= this times |v|_a for the rigid motion r of the root, where |r(at) . direction| <= `of` |direction| |v|_a.
fn held(holds: &[Hold], origin: [f64; 2], size: f64, of: impl Fn(&Hold) -> f64) -> Option<f64> {
    // r = (a, b) + c J (x - origin) / size
    let row = |hold: &Hold| -> [f64; 3] {
        let ([x, y], [p, q]) = (hold.at, hold.direction);
        [p, q, (q * (x - origin[0]) - p * (y - origin[1])) / size]
    };
    // Three rows that are far from dependent, one after the other.
    let mut rest: Vec<[f64; 3]> = holds.iter().map(row).collect();
    let mut chosen = Vec::with_capacity(3);
    for _ in 0..3 {
        let norm = |r: &[f64; 3]| r.iter().map(|c| c * c).sum::<f64>();
        let (best, largest) = rest
            .iter()
            .map(norm)
            .enumerate()
            .fold((0, 0.0), |best, (i, n)| if n > best.1 { (i, n) } else { best });
        if !(largest > 1e-20) {
            return None;
        }
        chosen.push(best);
        let axis = rest[best].map(|c| c / largest.sqrt());
        for r in &mut rest {
            let along: f64 = (0..3).map(|i| r[i] * axis[i]).sum();
            *r = std::array::from_fn(|i| r[i] - along * axis[i]);
        }
    }
    let exact = |hold: &Hold| -> [Interval; 3] {
        let (at, d) = (hold.at.map(Interval::point), hold.direction.map(Interval::point));
        let from = [0, 1].map(|c| at[c] - Interval::point(origin[c]));
        [d[0], d[1], (d[1] * from[0] - d[0] * from[1]) / Interval::point(size)]
    };
    let m: Vec<[Interval; 3]> = chosen.iter().map(|&i| exact(&holds[i])).collect();
    let minor = |i: usize, j: usize| {
        let [(a, b), (c, e)] = [i, j].map(|k| ((k + 1) % 3, (k + 2) % 3));
        m[a][c] * m[b][e] - m[a][e] * m[b][c]
    };
    let determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    if determinant.contains(0.0) || determinant.is_nan() {
        return None;
    }
    let mut inverse = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            let entry = minor(i, j) / determinant;
            inverse += entry.lo().abs().max(entry.hi().abs()).powi(2);
        }
    }
    let data = chosen.iter().map(|&i| {
        let [p, q] = holds[i].direction;
        (p * p + q * q) * of(&holds[i]).powi(2)
    });
    // |r| <= |(a, b)| + |c|
    let bound = (2.0 * inverse * data.sum::<f64>()).sqrt();
    bound.is_finite().then_some(SAFETY * bound)
}
