//! Korn's inequality on V^h with a number for its constant: a bound of |v| at each node by |v|_a, for all v that vanish at the
//! prescribed components. docs/a-posteriori.md, 7.6, has the proof; the bound is crude, a sum of magnitudes along a tree of
//! triangles, and multiplies only residuals that are far below rounding.
//!
//! On a triangle v is a rigid motion r_T up to c_T |v|_{a,T}. Motions of neighbours differ on their common edge by what both
//! leave; along the tree that adds up to |r_T - r_root| <= S_T^{1/2} |v|_a. The tree is that of the smallest S_T: next to the
//! short edges of a graded mesh it goes round by long ones. Each part of the body has a root, and
//! prescribed components hold its motion. Contact between two parts couples their motions: their roots have six unknowns
//! together.
//!
//! In a body of revolution the hoop strain holds the mean of v_r on each triangle, and c_T has the weight (docs/theory.md, 11.5).
//!
//! Everything but the areas, which are rounded down, and the matrix of those equations, which are balls, is a sum or product of positive
//! doubles of some million terms at most: rounding changes it by far less than the factor `SAFETY`.

use std::collections::BTreeMap;

use faer::Mat;
use faer::linalg::solvers::Solve;

use crate::kernel::ball::larger;
use crate::kernel::{Ball, Triangle};
use crate::linear::dense::dot;
use crate::model::constraints::Constraints;
use crate::model::groups::groups;
use crate::model::material::least_eigenvalue;
use crate::model::space::Space;
use crate::model::tree::Bounds;
use crate::model::{Degree, Materials, Mesh};

/// Covers the rounding of sums and products of positive numbers.
const SAFETY: f64 = 1.001;

/// The smallest area of a triangle for which there is a bound: below, squares underflow.
const SMALLEST: f64 = 1e-200;

/// A constraint beside the supports: a sum of components of v at nodes is at most `most` where |v|_a is at most 1.
#[derive(Clone, Debug)]
pub struct Hold {
    /// The terms of the sum, triangle by triangle.
    pub terms: Vec<Term>,
    /// The bound.
    pub most: f64,
}

/// A component of v at a point.
#[derive(Clone, Debug)]
pub struct Term {
    /// A triangle that has the point.
    pub triangle: usize,
    /// The point.
    pub at: [Ball; 2],
    /// The vector that v is multiplied by at the point.
    pub along: [Ball; 2],
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
        let stiffness: Vec<f64> = materials.distinct().iter().map(least_eigenvalue).collect();
        let of = |t: usize| {
            let stiffness = stiffness[materials.place_of(t)];
            squared_remainder(mesh, space.degree(), (materials, stiffness), t)
        };
        let left: Vec<f64> = (0..mesh.triangles().len()).map(of).collect::<Option<_>>()?;
        let Bounds { low, high } = Bounds::around(mesh.vertices().iter().copied());
        let size = (high[0] - low[0]).hypot(high[1] - low[1]);
        let mut paths = Paths {
            mesh,
            sides: &sides(mesh),
            left: &left,
            size,
            along: vec![f64::INFINITY; left.len()],
            part: vec![NONE; left.len()],
            passed: vec![f64::NAN; left.len()],
        };
        // The parts in the order in which they are held, each by the triangle where its paths begin.
        let mut roots: Vec<usize> = Vec::new();
        let all = supports(space, constraints).into_iter().chain(holds.iter().cloned());
        let mut all: Vec<Hold> = all.collect();
        let held = all.iter().flat_map(|hold| &hold.terms).map(|term| term.triangle);
        // The hoop strain holds every triangle.
        let by_hoops = if materials.are_of_revolution() { 0..left.len() } else { 0..0 };
        for triangle in held.chain(by_hoops) {
            if paths.part[triangle] == NONE {
                paths.explore(triangle, roots.len());
                roots.push(triangle);
            }
        }
        let Paths { along, part, .. } = paths;
        if part.contains(&NONE) {
            return None;
        }
        if materials.are_of_revolution() {
            all.extend(hoops(mesh, materials, &part, roots.len()));
        }
        let of = |t: usize| left[t].sqrt() + along[t].sqrt();
        // A constraint on several parts joins them.
        let together = all.iter().flat_map(|hold| {
            hold.terms.windows(2).map(|pair| [0, 1].map(|i| part[pair[i].triangle]))
        });
        let group = groups(roots.len(), together);
        let mut root_motion = vec![f64::INFINITY; roots.len()];
        for assembly in 0..group.iter().max().map_or(0, |last| last + 1) {
            let members: Vec<usize> = (0..roots.len()).filter(|&p| group[p] == assembly).collect();
            let own = |hold: &&Hold| group[part[hold.terms[0].triangle]] == assembly;
            let holds: Vec<&Hold> =
                all.iter().filter(|h| !h.terms.is_empty()).filter(own).collect();
            let place = |t: usize| members.iter().position(|&p| p == part[t]).unwrap_or(0);
            let origins: Vec<[f64; 2]> =
                members.iter().map(|&p| mesh.vertices()[mesh.triangles()[roots[p]][0]]).collect();
            let motions = motions_of_roots(&holds, place, &origins, size, of)?;
            for (&member, motion) in members.iter().zip(motions) {
                root_motion[member] = motion;
            }
        }
        let mut nodes = vec![f64::INFINITY; space.nodes().len()];
        for (t, members) in space.elements().enumerate() {
            let bound = SAFETY * (of(t) + root_motion[part[t]]);
            for &node in members {
                nodes[node] = nodes[node].min(bound);
            }
        }
        nodes.iter().all(|n| n.is_finite()).then_some(Korn { nodes })
    }
}

/// No triangle.
const NONE: usize = usize::MAX;

/// The triangles on the two sides of each edge.
fn sides(mesh: &Mesh) -> Vec<[usize; 2]> {
    let mut sides = vec![[NONE; 2]; mesh.edge_count()];
    for (t, edges) in mesh.triangle_edges().iter().enumerate() {
        for &edge in edges {
            let second = usize::from(sides[edge][0] != NONE);
            sides[edge][second] = t;
        }
    }
    sides
}

/// The shortest paths from triangle to triangle.
struct Paths<'a> {
    mesh: &'a Mesh,
    sides: &'a [[usize; 2]],
    /// c_T^2
    left: &'a [f64],
    /// The diagonal of a rectangle around the body.
    size: f64,
    /// S_T
    along: Vec<f64>,
    /// The part of the body in which each triangle is, as far as it has been reached.
    part: Vec<usize>,
    /// S_T with which each triangle last passed it on to its neighbours.
    passed: Vec<f64>,
}

/// Positive doubles have the order of their bits; the leading bits make eight classes an octave.
const CLASS: u32 = 49;

impl Paths<'_> {
    /// To all triangles of the part of the body that `root` is in. Triangles wait in classes of S_T, the smallest first; one that
    /// is reached again by a shorter path waits again, so the paths that are left are shortest ones.
    fn explore(&mut self, root: usize, part: usize) {
        (self.along[root], self.part[root]) = (0.0, part);
        let mut waiting = BTreeMap::from([(0, vec![root])]);
        while let Some((_, next)) = waiting.pop_first() {
            next.into_iter().for_each(|t| self.pass_on(t, part, &mut waiting));
        }
    }

    /// S_T of triangle `t` to its neighbours.
    fn pass_on(&mut self, t: usize, part: usize, waiting: &mut BTreeMap<u64, Vec<usize>>) {
        if self.passed[t] == self.along[t] {
            return;
        }
        self.passed[t] = self.along[t];
        for (i, &edge) in self.mesh.triangle_edges()[t].iter().enumerate() {
            let [first, second] = self.sides[edge];
            let other = if first == t { second } else { first };
            // Most neighbours have been reached by a path that ends nearer than this one begins.
            if other == NONE || self.along[other] <= self.along[t] {
                continue;
            }
            let edge = self.mesh.triangle(t).edge(i);
            let w = 1.0 + 2.0 * self.size / edge.dot(&edge).sqrt();
            let there = self.along[t] + 2.0 * w * w * (self.left[t] + self.left[other]);
            if there < self.along[other] {
                (self.along[other], self.part[other]) = (there, part);
                waiting.entry(there.to_bits() >> CLASS).or_default().push(other);
            }
        }
    }
}

/// The prescribed components at nodes, with one triangle at each.
fn supports(space: &Space, constraints: &Constraints) -> Vec<Hold> {
    let mut holds = Vec::new();
    let is_held = |values: &[Option<f64>; 2]| values.iter().any(Option::is_some);
    let mut waits: Vec<bool> = constraints.values().iter().map(is_held).collect();
    for (triangle, nodes) in space.elements().enumerate() {
        for (k, &node) in nodes.iter().enumerate() {
            if std::mem::take(&mut waits[node]) {
                let exactly = |x: [f64; 2]| x.map(Ball::point);
                let [from, to] = [1, 2].map(|i| exactly(space.nodes()[nodes[(k + i) % 3]]));
                let at = match k {
                    0..3 => exactly(space.nodes()[node]),
                    // The place of a middle is rounded.
                    _ => [0, 1].map(|c| (from[c] + to[c]) * Ball::point(0.5)),
                };
                holds.extend(constraints.directions(node).map(|direction| Hold {
                    terms: vec![Term { triangle, at, along: exactly(direction) }],
                    most: 0.0,
                }));
            }
        }
    }
    holds
}

/// The mean of the weight on triangle `t`: 1 in the plane, r in a body of revolution.
fn mean_weight(materials: &Materials, t: usize, triangle: &Triangle<f64>) -> f64 {
    materials.of(t).radii(triangle).map_or(1.0, |[a, b, c]| (a + b + c) / 3.0)
}

/// The constraints by the hoop strain of a body of revolution, on the mean of v_r on each triangle. Two of each part are
/// enough, one near either end along the axis, where the bound is least.
fn hoops(mesh: &Mesh, materials: &Materials, part: &[usize], count: usize) -> Vec<Hold> {
    let height = |t: usize| mesh.triangle(t).vertices.iter().map(|x| x[1]).sum::<f64>();
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; count];
    for (t, &of) in part.iter().enumerate() {
        let [low, high] = &mut ranges[of];
        (*low, *high) = (low.min(height(t)), high.max(height(t)));
    }
    let mut best = vec![[(f64::INFINITY, NONE); 2]; count];
    for (t, &of) in part.iter().enumerate() {
        let [low, high] = ranges[of];
        let quarter = (high - low) / 4.0;
        let triangle = mesh.triangle(t);
        let bound = mean_weight(materials, t, &triangle) / triangle.double_area();
        let is_at_end = [height(t) <= low + quarter, height(t) >= high - quarter];
        for (best, _) in best[of].iter_mut().zip(is_at_end).filter(|(_, is_at_end)| *is_at_end) {
            if bound < best.0 {
                *best = (bound, t);
            }
        }
    }
    let hold = |triangle: usize| {
        let at = mesh.triangle(triangle);
        let stiffness = least_eigenvalue(materials.of(triangle));
        let weight = mean_weight(materials, triangle, &at);
        let most = SAFETY * (weight * 2.0 / (stiffness * at.double_area())).sqrt();
        let exact = at.vertices.map(|x| x.map(Ball::point));
        let middle = (exact[0] + exact[1] + exact[2]) / Ball::from(3);
        let along = [Ball::from(1), Ball::from(0)];
        Hold { terms: vec![Term { triangle, at: middle.into(), along }], most }
    };
    best.iter().flatten().filter(|(_, t)| *t != NONE).map(|(_, t)| hold(*t)).collect()
}

/// The area of a triangle, rounded down: each of the products is off by three halves of EPSILON at most, their difference by half of it.
fn area(triangle: &Triangle<f64>) -> f64 {
    let [a, b] = [1, 2].map(|i| triangle.edge(i));
    let products = (a[0] * b[1]).abs() + (a[1] * b[0]).abs();
    (a.perp(&b) - 4.0 * f64::EPSILON * products) / 2.0
}

/// c_T^2, for the least eigenvalue of the law of the material.
fn squared_remainder(
    mesh: &Mesh,
    degree: Degree,
    (materials, least): (&Materials, f64),
    t: usize,
) -> Option<f64> {
    let doubles = mesh.triangle(t);
    let area = area(&doubles);
    let squares = [0, 1, 2].map(|i| doubles.edge(i)).map(|edge| edge.dot(&edge));
    let square = squares.into_iter().fold(0.0, f64::max);
    let stiffness = least / 2.0;
    // Below, squares underflow.
    if !(area > SMALLEST && stiffness > 0.0) {
        return None;
    }
    let affine = square / (2.0 * stiffness * area * mean_weight(materials, t, &doubles));
    Some(if degree == Degree::One {
        affine
    } else {
        let turning = 1.0 + 3.0 * square / area;
        let factor = at_corners(materials.are_of_revolution());
        factor * affine * turning * turning
    })
}

/// The most that the squares of an affine function at the corners of a triangle add up to, beside its mean square: with the weight r over
/// the mean of r in a body of revolution.
fn at_corners(is_of_revolution: bool) -> f64 {
    if is_of_revolution { 20.0 } else { 12.0 }
}

/// |r_p| <= these times |v|_a on the parts p that `holds` hold together, for the motions r_p = (a, b) + c J (x - origin_p) / size of
/// their roots, where r_T - r_p and v - r_T are together at most `of`(T) |v|_a at the nodes of a triangle T of part `place`(T).
fn motions_of_roots(
    holds: &[&Hold],
    place: impl Fn(usize) -> usize,
    origins: &[[f64; 2]],
    size: f64,
    of: impl Fn(usize) -> f64,
) -> Option<Vec<f64>> {
    let unknowns = 3 * origins.len();
    let mut rows = vec![Ball::from(0); unknowns * holds.len()];
    for (row, hold) in rows.chunks_exact_mut(unknowns).zip(holds) {
        for Term { triangle, at, along: [p, q] } in &hold.terms {
            let part = place(*triangle);
            let from = [0, 1].map(|c| at[c] - Ball::point(origins[part][c]));
            let turn = (*q * from[0] - *p * from[1]) / Ball::point(size);
            for (entry, by) in row[3 * part..].iter_mut().zip([*p, *q, turn]) {
                *entry += by;
            }
        }
    }
    let magnitude = |d: Ball| larger(d.lower().abs(), d.upper().abs());
    // |row . q| at most
    let most = |hold: &&Hold| {
        let of_triangle = |terms: &[Term]| {
            let sizes = terms.iter().map(|t| magnitude(t.along[0]).hypot(magnitude(t.along[1])));
            sizes.sum::<f64>() * of(terms[0].triangle)
        };
        let terms = hold.terms.chunk_by(|a, b| a.triangle == b.triangle).map(of_triangle);
        terms.sum::<f64>() + hold.most
    };
    let most: Vec<f64> = holds.iter().map(most).collect();
    let middle = |c: &Ball| c.lower() / 2.0 + c.upper() / 2.0;
    let doubles: Vec<f64> = rows.iter().map(middle).collect();
    // The rows that restrict most.
    let weighted = doubles.iter().enumerate().map(|(k, c)| c / most[k / unknowns]);
    let chosen = independent(weighted.collect(), unknowns)?;
    // With M q = t and any R: q = R t + (1 - R M) q. R is the inverse of M in doubles.
    let matrix = Mat::from_fn(unknowns, unknowns, |i, j| doubles[unknowns * chosen[i] + j]);
    let one = Mat::<f64>::identity(unknowns, unknowns);
    let inverse = matrix.partial_piv_lu().solve(&one);
    let off = (0..unknowns).map(|i| {
        let entry = |j: usize| {
            let unit = Ball::from(i32::from(i == j));
            let product = chosen.iter().enumerate();
            magnitude(product.fold(unit, |sum, (k, &row)| {
                sum - Ball::point(inverse[(i, k)]) * rows[unknowns * row + j]
            }))
        };
        (0..unknowns).map(entry).sum::<f64>()
    });
    let off = SAFETY * off.fold(0.0, larger);
    if !(off < 0.5) {
        return None;
    }
    let image = |i: usize| -> f64 {
        chosen.iter().enumerate().map(|(k, &row)| inverse[(i, k)].abs() * most[row]).sum()
    };
    let image: Vec<f64> = (0..unknowns).map(image).collect();
    let rest = off / (1.0 - off) * image.iter().copied().fold(0.0, larger);
    let bound = |q: &[f64]| SAFETY * ((q[0] + rest).hypot(q[1] + rest) + q[2] + rest);
    let bounds: Vec<f64> = image.chunks_exact(3).map(bound).collect();
    bounds.iter().all(|bound| bound.is_finite()).then_some(bounds)
}

/// As many of these rows as they are long that are far from dependent, one after the other.
fn independent(mut rest: Vec<f64>, count: usize) -> Option<Vec<usize>> {
    let mut chosen = Vec::with_capacity(count);
    for _ in 0..count {
        let squares = rest.chunks_exact(count).map(|row| dot(row, row)).enumerate();
        let (best, largest) =
            squares.fold((0, 0.0), |best, (i, n)| if n > best.1 { (i, n) } else { best });
        if !(largest > 0.0) {
            return None;
        }
        chosen.push(best);
        let axis: Vec<f64> =
            rest[count * best..][..count].iter().map(|c| c / largest.sqrt()).collect();
        for row in rest.chunks_exact_mut(count) {
            let along = dot(&axis, row);
            row.iter_mut().zip(&axis).for_each(|(c, a)| *c -= a * along);
        }
    }
    Some(chosen)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::contact::residual::exactly;
    use crate::kernel::{Material, Plane, PreciseBall};
    use crate::model::{Condition, Problem};

    #[test]
    fn an_area_is_rounded_down_by_next_to_nothing() {
        let mut larger = 0;
        for k in 1..200 {
            let (s, c) = (0.37 * f64::from(k)).sin_cos();
            let vertices = [[s, c], [s + 0.3 * c, c + 0.1], [s - 0.2 / f64::from(k), c + 0.7 * s]];
            let doubles = Triangle { vertices: vertices.map(Vector2::from) };
            let exact = exactly::<PreciseBall>(doubles).double_area();
            // The order of the vertices decides the sign.
            let [found, near] =
                [2.0 * area(&doubles), doubles.double_area()].map(PreciseBall::from);
            assert!((found - exact).upper() <= 0.0 && (exact - found).upper() < 1e-14);
            larger += usize::from((near - exact).lower() > 0.0);
        }
        assert!(larger > 20, "control: as it is in doubles it may be too large, {larger}");
    }

    #[test]
    fn triangles_whose_squares_would_underflow_have_no_bound() {
        for (area, expected) in [(1.01e-200, true), (0.99e-200, false)] {
            let size = f64::sqrt(2.0 * area);
            let vertices = vec![[0.0, 0.0], [size, 0.0], [0.0, size]];
            let mesh = Mesh::new(vertices, vec![[0, 1, 2]], BTreeMap::new()).unwrap();
            let materials = Problem::of(mesh.clone(), Material::lame(1.0, 1.0, Plane::Strain));
            for degree in [Degree::One, Degree::Two] {
                let found = squared_remainder(&mesh, degree, (&materials.material, 2.0), 0);
                assert_eq!(found.is_some_and(|c| c > 0.0 && c.is_finite()), expected, "{found:?}");
            }
        }
    }

    #[test]
    fn a_body_with_a_part_that_supports_leave_free_has_no_bound() {
        let vertices = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [3.0, 0.0], [4.0, 0.0], [3.0, 1.0]];
        let named = [("first", [0, 1]), ("second", [3, 4])];
        let named = named.map(|(name, edge)| (name.to_owned(), vec![edge]));
        let mesh = Mesh::new(vertices.to_vec(), vec![[0, 1, 2], [3, 4, 5]], named).unwrap();
        let problem = Problem::of(mesh, Material::lame(3.0, 0.7, Plane::Strain))
            .with("first", Condition::clamped());
        for (second, held) in [
            (Condition::clamped(), true),
            (Condition::roller(), false),
            (Condition::pressure(|_| 0.0), false),
        ] {
            let problem = problem.clone().with("second", second);
            let space = Space::new(&problem.mesh, Degree::One);
            let constraints = Constraints::new(&problem, &space).unwrap();
            let korn = Korn::new(&space, &problem.material, &constraints, &[]);
            assert_eq!(korn.is_some(), held);
        }
    }

    #[test]
    fn the_places_of_supports_are_those_of_the_mesh_and_not_what_is_rounded() {
        let vertices = [[0.1, 0.0], [1.0, 0.3], [0.0, 1.0]];
        let named = [("first".to_owned(), vec![[0, 1]])];
        let mesh = Mesh::new(vertices.to_vec(), vec![[0, 1, 2]], named).unwrap();
        let problem = Problem::of(mesh, Material::lame(3.0, 0.7, Plane::Strain))
            .with("first", Condition::clamped());
        let space = Space::new(&problem.mesh, Degree::Two);
        let constraints = Constraints::new(&problem, &space).unwrap();
        let holds = supports(&space, &constraints);
        let [a, b] = [0, 1].map(|i| vertices[i].map(PreciseBall::from));
        let middle = [0, 1].map(|c| (a[c] + b[c]) / PreciseBall::from(2));
        // Two components at each node of the edge.
        for (k, place) in [a, a, b, b, middle, middle].into_iter().enumerate() {
            for (at, exact) in holds[k].terms[0].at.into_iter().zip(place) {
                let off = PreciseBall::from(at) - exact;
                assert!(off.lower() <= 0.0 && off.upper() >= 0.0 && off.magnitude() < 1e-15);
            }
        }
        assert_eq!(holds.len(), 6);
        let rounded = PreciseBall::from(space.nodes()[space.nodes_of(0)[5]][0]);
        assert!((rounded - middle[0]).least_magnitude() > 0.0, "control");
    }

    /// The mean over a triangle of the square of an affine function, with a weight: both have these values at the corners.
    fn mean_square(weight: [f64; 3], e: [f64; 3]) -> f64 {
        // The mean of a product of three barycentric coordinates, by how often each occurs.
        let mean = |all: [usize; 3]| {
            let mut counts = [0, 0, 0];
            all.into_iter().for_each(|i| counts[i] += 1);
            let factorial = |n: u8| (1..=n).map(f64::from).product::<f64>();
            2.0 * counts.map(factorial).iter().product::<f64>() / factorial(5)
        };
        let all = (0..27).map(|k| [k / 9, k / 3 % 3, k % 3]);
        all.map(|at| weight[at[0]] * e[at[1]] * e[at[2]] * mean(at)).sum()
    }

    #[test]
    fn strains_at_corners_are_no_more_than_said_of_their_mean_square_and_as_much_beside_the_axis() {
        let share = |radii: [f64; 3], e: [f64; 3]| {
            let squares = e.iter().map(|e| e * e).sum::<f64>();
            squares * radii.iter().sum::<f64>() / 3.0 / mean_square(radii, e)
        };
        let [plane, revolution] = [false, true].map(at_corners);
        for k in 1..2000 {
            let draw = |by: f64| (0.37 * by * f64::from(k)).sin();
            let e = [1.0, 2.3, 5.1].map(draw);
            assert!(share([1.0; 3], e) <= plane * (1.0 + 1e-12));
            assert!(share([0.7, 1.9, 3.3].map(|by| draw(by).abs()), e) <= revolution);
        }
        // The worst ones: a change along one edge, with nothing at the third corner, in a triangle that has that edge on the axis.
        let worst = [0.0, 1.0, -1.0];
        let attained = |found: f64, most: f64| (found - most).abs() <= 1e-12 * most;
        assert!(attained(share([1.0; 3], worst), plane));
        assert!(attained(share([1.0, 0.0, 0.0], worst), revolution));
        assert!(revolution > plane, "control: the one in the plane is no bound beside an axis");
    }

    #[test]
    fn the_mean_of_v_r_is_no_more_than_the_hoop_strain_allows_and_as_much_beside_the_axis_and_far_off()
     {
        for r in [1e-3, 1.0, 1e3] {
            let vertices = [[r, 0.0], [r + 0.3 * r, 0.0], [r, 0.5]];
            let none: [(String, Vec<[usize; 2]>); 0] = [];
            let mesh = Mesh::new(vertices.to_vec(), vec![[0, 1, 2]], none).unwrap();
            // sigma : eps = 2 eps : eps.
            let material = Material::lame(0.0, 1.0, Plane::Axisymmetric);
            let problem = Problem::of(mesh, material);
            let holds = hoops(&problem.mesh, &problem.material, &[0], 1);
            // v = (r, 0) has the strains 1 in its meridian and along its hoops, the mean radius for its mean.
            let (mean, area) = (1.1 * r, 0.5 * 0.3 * r * 0.5);
            let norm = (4.0 * mean * area).sqrt();
            assert!(!holds.is_empty());
            for hold in holds {
                let ratio = hold.most * norm / mean;
                // The strain in the meridian is as large: a root of 2.
                assert!(ratio >= 2.0_f64.sqrt() && ratio < 1.42, "{r}: {ratio}");
            }
        }
    }
}
