//! Korn's inequality on V^h with a number for its constant: a bound of |v| at each node by |v|_a, for all v that vanish at the
//! prescribed components. docs/theory.md, 7.6, has the proof; the bound is crude (it adds up magnitudes along a tree of
//! triangles), and it is used where that does no harm: times residuals that are far below rounding.
//!
//! On a triangle v is a rigid motion r_T up to c_T |v|_{a,T}. Motions of neighbours differ on their common edge by what both
//! leave; along the tree that adds up to |r_T - r_root| <= S_T^{1/2} |v|_a. The tree is that of the smallest S_T: next to the
//! short edges of a graded mesh it goes round by long ones. Each part of the body has a root, and
//! prescribed components hold its motion.
//!
//! Everything but the areas and the matrix of those equations, which are balls, is a sum or product of positive
//! doubles of some million terms at most: rounding changes it by far less than the factor `SAFETY`.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::ball::larger;
use super::constraints::Constraints;
use super::material::least_eigenvalue;
use super::space::Space;
use crate::fem::{Degree, Materials, Mesh};
use crate::kernel::{Ball, Triangle};

/// Covers the rounding of sums and products of positive numbers.
const SAFETY: f64 = 1.001;

/// The smallest area of a triangle for which there is a bound.
const SMALLEST: f64 = 1e-200;

/// A hold beside the supports: a sum of components of v at nodes of a triangle is at most `most` where |v|_a is at most 1.
#[derive(Clone, Debug)]
pub struct Hold {
    /// The triangle.
    pub triangle: usize,
    /// The nodes' places, each with what v there is multiplied by.
    pub terms: Vec<([Ball; 2], [Ball; 2])>,
    /// The bound.
    pub most: f64,
}

/// |v(x_i)| <= `nodes[i]` |v|_a for all v in V^h and all nodes i.
#[derive(Clone, Debug)]
pub struct Korn {
    /// The factors.
    pub nodes: Vec<f64>,
}

impl Korn {
    /// The bound for the fields that vanish at the prescribed components and do what `holds` say. `None` where these hardly hold
    /// a part of the body.
    pub fn new(
        space: &Space,
        materials: &Materials,
        constraints: &Constraints,
        holds: &[Hold],
    ) -> Option<Self> {
        let mesh = space.mesh();
        let left: Vec<f64> = (0..mesh.triangles().len())
            .map(|t| squared_remainder(mesh, space.degree(), materials, t))
            .collect::<Option<_>>()?;
        let neighbours = neighbours(mesh);
        let size = extent(mesh);
        let mut paths = Paths {
            mesh,
            neighbours: &neighbours,
            left: &left,
            size,
            along: vec![f64::INFINITY; left.len()],
            part: vec![usize::MAX; left.len()],
        };
        let mut parts: Vec<Vec<Hold>> = Vec::new();
        for hold in supports(space, constraints).into_iter().chain(holds.iter().cloned()) {
            if paths.part[hold.triangle] == usize::MAX {
                paths.explore(hold.triangle, parts.len());
                parts.push(Vec::new());
            }
            parts[paths.part[hold.triangle]].push(hold);
        }
        let Paths { along, part, .. } = paths;
        if part.contains(&usize::MAX) {
            return None;
        }
        let of = |t: usize| left[t].sqrt() + along[t].sqrt();
        let motion = |holds: &Vec<Hold>| {
            let origin = mesh.vertices()[mesh.triangles()[holds[0].triangle][0]];
            motion_of_root(holds, origin, size, of)
        };
        let root_motion: Vec<f64> = parts.iter().map(motion).collect::<Option<_>>()?;
        let mut nodes = vec![f64::INFINITY; space.nodes().len()];
        for (t, members) in space.elements().enumerate() {
            let bound = SAFETY * (of(t) + root_motion[part[t]]);
            for &node in members {
                nodes[node] = nodes[node].min(bound);
            }
        }
        nodes.iter().all(|n| n.is_finite()).then_some(Korn { nodes })
    }

    /// The largest of the factors.
    pub fn largest(&self) -> f64 {
        self.nodes.iter().fold(0.0, |m: f64, &n| m.max(n))
    }
}

/// The triangle beyond each edge of each triangle; no triangle's number on the boundary.
fn neighbours(mesh: &Mesh) -> Vec<[usize; 3]> {
    let mut first = vec![usize::MAX; mesh.edge_count()];
    let mut neighbours = vec![[usize::MAX; 3]; mesh.triangles().len()];
    for (t, edges) in mesh.triangle_edges().iter().enumerate() {
        for (i, &edge) in edges.iter().enumerate() {
            let other = std::mem::replace(&mut first[edge], t);
            if other != usize::MAX {
                neighbours[t][i] = other;
                let back = mesh.triangle_edges()[other].iter().position(|&e| e == edge);
                back.into_iter().for_each(|j| neighbours[other][j] = t);
            }
        }
    }
    neighbours
}

/// The diagonal of a rectangle around the body.
fn extent(mesh: &Mesh) -> f64 {
    let (low, high) = mesh
        .vertices()
        .iter()
        .fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(low, high), x| {
            ([0, 1].map(|c| x[c].min(low[c])), [0, 1].map(|c| x[c].max(high[c])))
        });
    (high[0] - low[0]).hypot(high[1] - low[1])
}

/// The shortest paths from triangle to triangle.
struct Paths<'a> {
    mesh: &'a Mesh,
    neighbours: &'a [[usize; 3]],
    /// c_T^2
    left: &'a [f64],
    size: f64,
    /// S_T
    along: Vec<f64>,
    /// The part of the body in which each triangle is, as far as it has been reached.
    part: Vec<usize>,
}

impl Paths<'_> {
    /// To all triangles of the part of the body that `root` is in.
    fn explore(&mut self, root: usize, part: usize) {
        (self.along[root], self.part[root]) = (0.0, part);
        // Positive doubles are in the order of their bits.
        let mut queue = BinaryHeap::from([Reverse((0, root))]);
        while let Some(Reverse((reached, t))) = queue.pop() {
            if reached > self.along[t].to_bits() {
                continue;
            }
            for (i, &other) in self.neighbours[t].iter().enumerate() {
                if other == usize::MAX {
                    continue;
                }
                let edge = self.mesh.triangle(t).edge(i);
                let w = 1.0 + 2.0 * self.size / edge.dot(&edge).sqrt();
                let there = self.along[t] + 2.0 * w * w * (self.left[t] + self.left[other]);
                if there < self.along[other] {
                    (self.along[other], self.part[other]) = (there, part);
                    queue.push(Reverse((there.to_bits(), other)));
                }
            }
        }
    }
}

/// The prescribed components, with one triangle at each node. Vertices alone: their places are exact.
fn supports(space: &Space, constraints: &Constraints) -> Vec<Hold> {
    let mut holds = Vec::new();
    let mut seen = vec![false; space.nodes().len()];
    for (triangle, nodes) in space.elements().enumerate() {
        for &node in nodes {
            if !std::mem::replace(&mut seen[node], true) {
                let exactly = |x: [f64; 2]| x.map(Ball::point);
                let at = exactly(space.nodes()[node]);
                holds.extend(constraints.directions(node).map(|direction| Hold {
                    triangle,
                    terms: vec![(at, exactly(direction))],
                    most: 0.0,
                }));
            }
        }
    }
    holds
}

/// c_T^2
fn squared_remainder(mesh: &Mesh, degree: Degree, materials: &Materials, t: usize) -> Option<f64> {
    let doubles = mesh.triangle(t);
    let exact = Triangle { vertices: doubles.vertices.map(|x| x.map(Ball::point)) };
    let area = (exact.double_area() / Ball::from(2)).lower();
    let squares = [0, 1, 2].map(|i| doubles.edge(i)).map(|edge| edge.dot(&edge));
    let square = squares.into_iter().fold(0.0, f64::max);
    let material = materials.of(t);
    let stiffness = least_eigenvalue(material) / 2.0;
    // Below, squares underflow.
    if !(area > SMALLEST && stiffness > 0.0) {
        return None;
    }
    let affine = square / (2.0 * stiffness * area);
    Some(if degree == Degree::One {
        affine
    } else {
        let turning = 1.0 + 3.0 * square / area;
        12.0 * affine * turning * turning
    })
}

/// |r| <= this times |v|_a on the part, for the motion r = (a, b) + c J (x - origin) / size of its root, where r_T - r and
/// v - r_T are together at most `of`(T) |v|_a at the nodes of T.
fn motion_of_root(
    holds: &[Hold],
    origin: [f64; 2],
    size: f64,
    of: impl Fn(usize) -> f64,
) -> Option<f64> {
    let row = |hold: &Hold| {
        hold.terms.iter().fold([Ball::from(0); 3], |[x, y, turn], &(at, [p, q])| {
            let from = [0, 1].map(|c| at[c] - Ball::point(origin[c]));
            [x + p, y + q, turn + (q * from[0] - p * from[1]) / Ball::point(size)]
        })
    };
    let rows: Vec<[Ball; 3]> = holds.iter().map(row).collect();
    let magnitude = |d: Ball| larger(d.lower().abs(), d.upper().abs());
    // |row . (a, b, c)| at most
    let most = |hold: &Hold| {
        let sizes = hold.terms.iter().map(|(_, [p, q])| magnitude(*p).hypot(magnitude(*q)));
        sizes.sum::<f64>() * of(hold.triangle) + hold.most
    };
    let most: Vec<f64> = holds.iter().map(most).collect();
    let middle = |row: &[Ball; 3]| row.map(|c| c.lower() / 2.0 + c.upper() / 2.0).to_vec();
    let doubles: Vec<Vec<f64>> = rows.iter().map(middle).collect();
    // Those that say most.
    let weighted = |(row, most): (&Vec<f64>, &f64)| row.iter().map(|c| c / most).collect();
    let chosen = independent(&doubles.iter().zip(&most).map(weighted).collect::<Vec<_>>(), 3)?;
    let inverse = inverse(chosen.iter().map(|&i| doubles[i].clone()).collect())?;
    // With M q = t and any R: q = R t + (1 - R M) q.
    let off = (0..3).map(|i| {
        let entry = |j: usize| {
            let product = chosen.iter().zip(&inverse[i]);
            let unit = Ball::from(i32::from(i == j));
            let left = product.fold(unit, |sum, (&k, &r)| sum - Ball::point(r) * rows[k][j]);
            magnitude(left)
        };
        (0..3).map(entry).sum::<f64>()
    });
    let off = SAFETY * off.fold(0.0, larger);
    let data: Vec<f64> = chosen.iter().map(|&i| most[i]).collect();
    let image: Vec<f64> = inverse
        .iter()
        .map(|row| row.iter().zip(&data).map(|(r, d)| r.abs() * d).sum::<f64>())
        .collect();
    if !(off < 0.5) {
        return None;
    }
    let rest = off / (1.0 - off) * image.iter().copied().fold(0.0, larger);
    let bound = SAFETY * ((image[0] + rest).hypot(image[1] + rest) + image[2] + rest);
    bound.is_finite().then_some(bound)
}

/// `count` rows that are far from dependent, one after the other.
fn independent(rows: &[Vec<f64>], count: usize) -> Option<Vec<usize>> {
    let mut rest = rows.to_vec();
    let mut chosen = Vec::with_capacity(count);
    for _ in 0..count {
        let norm = |r: &Vec<f64>| r.iter().map(|c| c * c).sum::<f64>();
        let (best, largest) = rest
            .iter()
            .map(norm)
            .enumerate()
            .fold((0, 0.0), |best, (i, n)| if n > best.1 { (i, n) } else { best });
        if !(largest > 0.0) {
            return None;
        }
        chosen.push(best);
        let axis: Vec<f64> = rest[best].iter().map(|c| c / largest.sqrt()).collect();
        for r in &mut rest {
            let along: f64 = r.iter().zip(&axis).map(|(r, a)| r * a).sum();
            for (r, a) in r.iter_mut().zip(&axis) {
                *r -= along * a;
            }
        }
    }
    Some(chosen)
}

/// The inverse of a square matrix in doubles, by Gauss and Jordan. Nothing depends on its being right.
fn inverse(mut m: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let n = m.len();
    for (i, row) in m.iter_mut().enumerate() {
        row.extend((0..n).map(|j| f64::from(u8::from(i == j))));
    }
    for column in 0..n {
        let pivot =
            (column..n).max_by(|&i, &j| m[i][column].abs().total_cmp(&m[j][column].abs()))?;
        m.swap(column, pivot);
        let by = m[column][column];
        if by == 0.0 {
            return None;
        }
        m[column].iter_mut().for_each(|entry| *entry /= by);
        let from = m[column].clone();
        for (_, row) in m.iter_mut().enumerate().filter(|(i, _)| *i != column) {
            let factor = row[column];
            row.iter_mut().zip(&from).for_each(|(entry, from)| *entry -= factor * from);
        }
    }
    Some(m.into_iter().map(|row| row[n..].to_vec()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::{Condition, Discretization, EdgeRule, Mesh, Problem, SharedFunction, precise};
    use crate::kernel::{Material, Plane};
    use std::collections::BTreeMap;
    use std::sync::Arc;

    fn zero() -> SharedFunction {
        Arc::new(|_: [f64; 2]| 0.0)
    }

    /// A square, clamped above, and one beside it that a side and a corner hold, if its side is held along y.
    fn two_parts(left_is_held: bool) -> Problem {
        let vertices = vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [1.5, 1.0],
            [2.5, 1.0],
            [2.5, 2.0],
            [1.5, 2.0],
        ];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let named = [
            ("top".to_owned(), vec![[6, 7]]),
            ("left".to_owned(), vec![[3, 0]]),
            ("right".to_owned(), vec![[1, 2]]),
            ("bottom".to_owned(), vec![[0, 1]]),
        ];
        let left = left_is_held.then(|| Condition::Displacement([None, Some(zero())]));
        let mut conditions = BTreeMap::from([
            ("top".to_owned(), Condition::Displacement([Some(zero()), Some(zero())])),
            ("right".to_owned(), Condition::Displacement([Some(zero()), None])),
            ("bottom".to_owned(), Condition::Contact { gap: zero() }),
        ]);
        conditions.extend(left.map(|left| ("left".to_owned(), left)));
        Problem::new(
            Mesh::new(vertices, triangles, named).unwrap(),
            Material::lame(3.0, 0.7, Plane::Strain),
            [zero(), zero()],
            conditions,
        )
    }

    /// The largest |v_c(x_i)| over |v|_a for each node and component, from the inverse of the stiffness matrix.
    fn true_factors(d: &Discretization) -> BTreeMap<(usize, usize), f64> {
        let free: Vec<(usize, usize)> = (0..d.space.nodes().len())
            .flat_map(|node| [(node, 0), (node, 1)])
            .filter(|&(node, c)| d.constraints.values()[node][c].is_none())
            .collect();
        let column = |&(node, c): &(usize, usize)| -> Vec<f64> {
            let mut unit = vec![[0.0; 2]; d.space.nodes().len()];
            let mut forces = unit.clone();
            unit[node][c] = 1.0;
            precise::add_internal_forces(&d.space, &d.problem.material, &unit, &mut forces);
            free.iter().map(|&(node, c)| forces[node][c]).collect()
        };
        let inverse = inverse(free.iter().map(column).collect()).unwrap();
        free.iter().enumerate().map(|(i, &at)| (at, inverse[i][i].sqrt())).collect()
    }

    fn bounds(degree: Degree) {
        let problem = two_parts(true);
        let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact);
        let d = d.unwrap();
        let korn = Korn::new(&d.space, &problem.material, &d.constraints, &[]).unwrap();
        let mut tightest = f64::INFINITY;
        for ((node, c), factor) in true_factors(&d) {
            let bound = korn.nodes[node];
            assert!(factor <= bound, "node {node}, component {c}: {factor} > {bound}");
            tightest = tightest.min(bound / factor);
        }
        // It is crude, for P2 more so, but not without a meaning: ten thousand times smaller it would be wrong.
        assert!(tightest < 1e4, "{tightest}");
    }

    #[test]
    fn no_displacement_of_two_parts_is_larger_at_a_node_than_the_bound() {
        bounds(Degree::One);
        bounds(Degree::Two);
    }

    #[test]
    fn control_a_part_that_supports_leave_free_has_no_bound() {
        for held in [true, false] {
            let problem = two_parts(held);
            let space = Space::new(&problem.mesh, Degree::One);
            let constraints = Constraints::new(&problem, &space).unwrap();
            let korn = Korn::new(&space, &problem.material, &constraints, &[]);
            assert_eq!(korn.is_some(), held);
        }
    }

    #[test]
    fn an_inverse_times_its_matrix_is_one() {
        let m = vec![vec![0.0, 2.0, 1.0], vec![4.0, -1.0, 0.5], vec![1.0, 1.0, 1.0]];
        let r = inverse(m.clone()).unwrap();
        for i in 0..3 {
            for j in 0..3 {
                let entry: f64 = (0..3).map(|k| r[i][k] * m[k][j]).sum();
                approx::assert_abs_diff_eq!(entry, f64::from(u8::from(i == j)), epsilon = 1e-15);
            }
        }
        assert!(inverse(vec![vec![1.0, 2.0], vec![2.0, 4.0]]).is_none());
    }
}
