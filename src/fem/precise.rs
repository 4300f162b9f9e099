//! The linear part of (8) at a displacement that is known to more than double precision, evaluated from the definitions in
//! [double-doubles](crate::fem::double_double): what is left of forces that cancel is then known to the last bit of a double; and
//! its forces from [stresses in doubles](add_forces_of_rounded_stresses), off by no more than a proved norm.

use nalgebra::{Vector2, Vector3};

use super::ball::{Ball, Sum};
use super::contact_line::ContactLineEdge;
use super::discretization::Discretization;
use crate::fem::double_double::DoubleDouble;
use crate::kernel::edge_integral::ExactEdge;
use crate::kernel::element::displacement_gradient;
use crate::kernel::{ContactEdge, Material, Scalar, Stress, Triangle};

/// A(u, v) - L(v) for every basis function v, and the values of P(u) at the nodes of each contact edge.
pub fn evaluate<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    u: &[[DoubleDouble; 2]],
) -> (Vec<[f64; 2]>, Vec<DoubleDouble>)
where
    E: ExactEdge<f64, N, M>,
{
    let edges: Vec<OnEdge<'_, DoubleDouble, N, M>> =
        d.contact.iter().map(|e| on_edge(d, e)).collect();
    let forces = linear_residual(d, &edges, u);
    let p = d.contact.iter().zip(&edges).flat_map(|(edge, line)| line.p(edge, u)).collect();
    (forces.into_iter().map(|f| f.map(DoubleDouble::head)).collect(), p)
}

/// A(u, v) - L(v) for every basis function v, with these contact edges.
pub fn linear_residual<S, E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    edges: &[OnEdge<S, N, M>],
    u: &[[S; 2]],
) -> Vec<[S; 2]>
where
    S: Scalar + From<f64>,
    E: ExactEdge<f64, N, M>,
{
    let minus = |l: f64| -<S as From<f64>>::from(l);
    let mut forces: Vec<[S; 2]> = d.load.iter().map(|l| l.map(minus)).collect();
    add_internal_forces(d, u, &mut forces);
    edges.iter().for_each(|edge| edge.add_stresses(u, &mut forces));
    forces
}

/// The values of P(u) at the nodes of each contact edge.
pub fn p<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    u: &[[DoubleDouble; 2]],
) -> impl Iterator<Item = DoubleDouble>
where
    E: ExactEdge<f64, N, M>,
{
    d.contact.iter().flat_map(move |edge| on_edge(d, edge).p(edge, u))
}

/// A contact edge with the doubles that it has.
pub fn on_edge<'d, S, E, const N: usize, const M: usize>(
    d: &'d Discretization<E, N, M>,
    edge: &ContactLineEdge<N, M>,
) -> OnEdge<'d, S, N, M>
where
    S: Scalar + From<f64>,
    E: ExactEdge<f64, N, M>,
{
    let exactly = <S as From<f64>>::from;
    let numbers = EdgeNumbers {
        normal: edge.normal.map(exactly),
        gamma: exactly(edge.gamma),
        length: exactly(edge.length),
    };
    OnEdge::new(d, edge, numbers)
}

/// A triangle of doubles in other numbers.
pub fn exactly<S: Scalar + From<f64>>(t: Triangle<f64>) -> Triangle<S> {
    Triangle { vertices: t.vertices.map(|x| x.map(S::from)) }
}

/// Adds a(u, v) for every basis function v. Triangles on which `u` is all zero are not looked at.
pub fn add_internal_forces<S, E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    u: &[[S; 2]],
    forces: &mut [[S; 2]],
) where
    S: Scalar + From<f64>,
    E: ExactEdge<f64, N, M>,
{
    let zero = <S as From<i32>>::from(0);
    let half = <S as From<f64>>::from(0.5);
    let mut points = Vec::new();
    E::at_stiffness_points(|l: [S; 3], weight| points.push((l, weight)));
    for (t, (triangle, nodes)) in d.space.triangles().enumerate() {
        if nodes.iter().all(|&node| u[node] == [zero; 2]) {
            continue;
        }
        let nodal = nodes.map(|node| Vector2::from(u[node]));
        let triangle = exactly(triangle);
        let material = d.problem.material.of(t).map(<S as From<f64>>::from);
        // As `Triangle::barycentric_gradients` has them, with one division: in these numbers they are dear.
        let double_area = triangle.double_area();
        let inverse = <S as From<i32>>::from(1) / double_area;
        let barycentric = [0, 1, 2].map(|i| -triangle.scaled_normal(i) * inverse);
        let area = double_area * half;
        for &(l, weight) in &points {
            let gradients = E::gradients(l, barycentric);
            let stress = material.stress(displacement_gradient(&nodal, &gradients));
            let factor = weight * area;
            for (&node, g) in nodes.iter().zip(gradients) {
                let force = stress.traction(g);
                for c in 0..2 {
                    forces[node][c] += factor * force[c];
                }
            }
        }
    }
}

/// Adds int s:eps(v) for every basis function v, where s is the stress of `u` that doubles give. Returns a b with
/// |int (s - sigma(u)):eps(v)| <= b |v|_a for all v: docs/theory.md, 7.5. Infinite or NaN where there is none.
pub fn add_forces_of_rounded_stresses<S, E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    u: &[[Ball; 2]],
    forces: &mut [[S; 2]],
) -> f64
where
    S: Sum,
    E: ExactEdge<f64, N, M>,
{
    let mut points = Vec::new();
    E::at_stiffness_points(|l: [f64; 3], weight: f64| points.push((l, weight)));
    let terms = Term::all::<E, M>(&points);
    let mut stresses = [[0.0; 3]; N];
    let mut square = 0.0;
    for (t, (triangle, nodes)) in d.space.triangles().enumerate() {
        if moves_as_a_whole(nodes, u) {
            continue;
        }
        let rounded = RoundedStrain::new::<E, M>(&triangle, nodes.map(|node| u[node]));
        let material = d.problem.material.of(t);
        square += rounded.stress_error_squared(material);
        for (&(l, weight), at) in points.iter().zip(&mut stresses) {
            *at = rounded.stress::<E, M>(material, l).components().map(|s| weight * s);
        }
        if points.len() > 1 {
            make_sums_exact(&mut stresses);
        }
        // The area times the gradient of a barycentric coordinate is half a normal.
        let normals = [0, 1, 2].map(|i| {
            let [from, to] = [1, 2].map(|k| triangle.vertices[(i + k) % 3]);
            let half = |c: usize| S::Factor::from(DoubleDouble::sum(0.5 * to[c], -0.5 * from[c]));
            [-half(1), half(0)]
        });
        for Term { node, side, coefficients } in &terms {
            let mut sum = [0.0; 3];
            for (coefficient, stress) in coefficients.iter().zip(&stresses).take(points.len()) {
                for (sum, s) in sum.iter_mut().zip(stress) {
                    *sum += coefficient * s;
                }
            }
            let [xx, yy, xy] = sum.map(|s| S::Factor::from(DoubleDouble::from(s)));
            let [x, y] = normals[*side];
            let [along_x, along_y] = &mut forces[nodes[*node]];
            along_x.add_products([(xx, x), (xy, y)]);
            along_y.add_products([(xy, x), (yy, y)]);
        }
    }
    SAFETY * square.sqrt()
}

/// The part of the force at a node of a triangle that has the direction of one of its sides: the stresses at the points of the
/// rule, each times its coefficient, on half the normal there.
struct Term<const N: usize> {
    node: usize,
    side: usize,
    coefficients: [f64; N],
}

impl<const N: usize> Term<N> {
    /// Those that are not zero. At the points of the rules the gradients of the shape functions are sums of those of the
    /// barycentric coordinates, each once or twice, with either sign.
    fn all<E: ExactEdge<f64, N, M>, const M: usize>(points: &[([f64; 3], f64)]) -> Vec<Term<N>> {
        let unit = [Vector3::x(), Vector3::y(), Vector3::z()];
        let at: Vec<[Vector3<f64>; N]> =
            points.iter().map(|&(l, _)| E::gradients(l, unit)).collect();
        let term = |node: usize, side: usize| {
            let mut coefficients = [0.0; N];
            for (coefficient, gradients) in coefficients.iter_mut().zip(&at) {
                *coefficient = gradients[node][side];
            }
            Term { node, side, coefficients }
        };
        let all = (0..N).flat_map(|node| (0..3).map(move |side| term(node, side)));
        all.filter(|term| term.coefficients != [0.0; N]).collect()
    }
}

/// Rounds numbers to multiples of one power of two, by no more than 2^-50 of the largest: their sums are then exact, while these
/// are less than eight times the largest.
fn make_sums_exact<const N: usize>(numbers: &mut [[f64; 3]; N]) {
    let largest = numbers.iter().flatten().fold(0.0, |m: f64, s| m.max(s.abs()));
    // The power of two just below.
    let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    let shift = 12.0 * power;
    numbers.iter_mut().flatten().for_each(|s| *s = (*s + shift) - shift);
}

/// |v|_a at most, to a hundredth: the norm of the stress in doubles, and what that is off by.
pub fn energy_norm_at_most<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    v: &[[Ball; 2]],
) -> f64
where
    E: ExactEdge<f64, N, M>,
{
    let (mut squares, mut errors) = (0.0, 0.0);
    for (t, (triangle, nodes)) in d.space.triangles().enumerate() {
        if moves_as_a_whole(nodes, v) {
            continue;
        }
        let rounded = RoundedStrain::new::<E, M>(&triangle, nodes.map(|node| v[node]));
        let material = d.problem.material.of(t);
        errors += rounded.stress_error_squared(material);
        let (lambda, mu) = (material.lambda(), material.mu());
        let [bulk, shear] = [lambda + mu, mu].map(|m| (rounded.area / (4.0 * m)).sqrt());
        E::at_stiffness_points(|l, weight| {
            let [xx, yy, xy] = rounded.stress::<E, M>(material, l).components();
            let parts = [bulk * (xx + yy), shear * (xx - yy), 2.0 * shear * xy];
            squares += weight * parts.map(|s| s * s).iter().sum::<f64>() + f64::MIN_POSITIVE;
        });
    }
    SAFETY * (squares.sqrt() + errors.sqrt())
}

/// Whether all nodes have the same value, and that is known.
#[inline]
fn moves_as_a_whole<const N: usize>(nodes: &[usize; N], u: &[[Ball; 2]]) -> bool {
    let first = u[nodes[0]];
    first.iter().all(|c| c.radius() == 0.0) && nodes[1..].iter().all(|&node| u[node] == first)
}

/// Covers the rounding of sums and products of positive numbers, some million of them, and areas that are off by a thousandth.
const SAFETY: f64 = 1.01;

/// A triangle is too flat for doubles where the products that its area is the difference of are larger beside it.
const FLAT: f64 = (1_u64 << 40) as f64;

/// The differences of nodal values on a triangle and the gradients of its barycentric coordinates, in doubles, with what
/// bounds their rounding.
struct RoundedStrain<const N: usize> {
    /// Nodal values less the first one.
    differences: [Vector2<f64>; N],
    barycentric: [Vector2<f64>; 3],
    area: f64,
    /// A bound of the error of the strain, the rounding of the stress beside it included; infinite for a flat triangle.
    error: f64,
}

impl<const N: usize> RoundedStrain<N> {
    fn new<E: ExactEdge<f64, N, M>, const M: usize>(
        triangle: &Triangle<f64>,
        nodal: [[Ball; 2]; N],
    ) -> Self {
        let first = nodal[0];
        let difference = |u: [Ball; 2], c: usize| {
            (u[c].head() - first[c].head()) + (u[c].tail() - first[c].tail())
        };
        let differences = nodal.map(|u| Vector2::new(difference(u, 0), difference(u, 1)));
        // What the differences are off by, beside what is relative to them.
        let off: f64 = nodal
            .iter()
            .flat_map(|u| u.iter().zip(&first))
            .map(|(u, first)| {
                let tails = u.tail().abs() + first.tail().abs();
                2.0 * f64::EPSILON * tails + u.radius() + first.radius()
            })
            .sum();
        let [a, b] = [1, 2].map(|i| triangle.edge(i));
        let double_area = triangle.double_area();
        let products = (a[0] * b[1]).abs() + (a[1] * b[0]).abs();
        let inverse = 1.0 / double_area;
        let skew = products * inverse;
        let barycentric = [0, 1, 2].map(|i| triangle.scaled_normal(i) * -inverse);
        let slope = E::DEGREE as f64 * barycentric.iter().flatten().map(|g| g.abs()).sum::<f64>();
        let sizes: f64 = differences.iter().flatten().map(|d| d.abs()).sum();
        let roundings = (N + 7 * E::DEGREE - 3) as f64 + 4.0 * skew;
        let sound = double_area > 1e-200 && skew <= FLAT;
        let error = slope * (f64::EPSILON * roundings * sizes + off + f64::MIN_POSITIVE);
        RoundedStrain {
            differences,
            barycentric,
            area: double_area / 2.0,
            error: if sound { error } else { f64::INFINITY },
        }
    }

    /// An upper bound of the square of the stress error in the norm dual to |v|_a on the triangle: |sigma:eps| is at most
    /// |sigma| |eps|, and 2 min(mu, lambda + mu) |eps|^2 at most sigma(v):eps(v).
    fn stress_error_squared(&self, material: &Material<f64>) -> f64 {
        let (lambda, mu) = (material.lambda(), material.mu());
        let off = 2.0 * (lambda.abs() + mu) * self.error + f64::MIN_POSITIVE;
        let norm = off * (self.area / (2.0 * mu.min(lambda + mu))).sqrt();
        norm * norm + f64::MIN_POSITIVE
    }

    /// The stress at the point with the barycentric coordinates `l`.
    fn stress<E: ExactEdge<f64, N, M>, const M: usize>(
        &self,
        material: &Material<f64>,
        l: [f64; 3],
    ) -> Stress<f64> {
        let gradients = E::gradients(l, self.barycentric);
        material.stress(displacement_gradient(&self.differences, &gradients))
    }
}

/// The geometry and the parameter of a contact edge.
#[derive(Clone, Copy, Debug)]
pub struct EdgeNumbers<S> {
    /// n
    pub normal: Vector2<S>,
    /// gamma
    pub gamma: S,
    /// |E|
    pub length: S,
}

/// A contact edge with its functionals.
#[derive(Debug)]
pub struct OnEdge<'d, S, const N: usize, const M: usize> {
    /// P0 and sigma_n.
    pub functionals: ContactEdge<S, N, M>,
    /// Its numbers.
    pub numbers: EdgeNumbers<S>,
    nodes: &'d [usize; N],
}

impl<'d, S: Scalar + From<f64>, const N: usize, const M: usize> OnEdge<'d, S, N, M> {
    /// The functionals of an edge of a discretization.
    pub fn new<E: ExactEdge<f64, N, M>>(
        d: &'d Discretization<E, N, M>,
        edge: &ContactLineEdge<N, M>,
        numbers: EdgeNumbers<S>,
    ) -> Self {
        let EdgeNumbers { normal, gamma, .. } = numbers;
        let (t, local) = (edge.edge.triangle, edge.edge.local);
        let triangle = exactly(d.space.mesh().triangle(t));
        let material = d.problem.material.of(t).map(<S as From<f64>>::from);
        let functionals = if edge.directions == [edge.normal; M] {
            ContactEdge::new::<E>(&triangle, local, normal, &material, gamma)
        } else {
            let along = edge.directions.map(|d| d.map(<S as From<f64>>::from));
            ContactEdge::along::<E>(&triangle, local, normal, &along, &material, gamma)
        };
        OnEdge { functionals, numbers, nodes: &d.space.elements()[t] }
    }

    fn apply(&self, functional: &[Vector2<S>; N], u: &[[S; 2]]) -> S {
        let zero = <S as From<i32>>::from(0);
        let nodal = functional.iter().zip(self.nodes);
        nodal.fold(zero, |sum, (f, &node)| sum + f[0] * u[node][0] + f[1] * u[node][1])
    }

    /// P0(u) at the nodes of the edge.
    pub fn p0(&self, u: &[[S; 2]]) -> [S; M] {
        std::array::from_fn(|a| self.apply(&self.functionals.p0[a], u))
    }

    /// P(u) there.
    pub fn p(&self, edge: &ContactLineEdge<N, M>, u: &[[S; 2]]) -> [S; M] {
        let p0 = self.p0(u);
        std::array::from_fn(|a| p0[a] - <S as From<f64>>::from(edge.gap[a]))
    }

    /// Adds -int gamma sigma_n(u) sigma_n(v) over the edge for every basis function v.
    pub fn add_stresses(&self, u: &[[S; 2]], forces: &mut [[S; 2]]) {
        let [two, six] = [2, 6].map(<S as From<i32>>::from);
        let [start, end] = [0, 1].map(|a| self.apply(&self.functionals.sigma_n[a], u));
        let mass = -(self.numbers.gamma * self.numbers.length) / six;
        let factors = [mass * (two * start + end), mass * (start + two * end)];
        self.add(&self.functionals.sigma_n, &factors, forces);
    }

    /// Adds the values of P0 at the nodes, each times its factor, as forces on the body.
    pub fn add_contact(&self, factors: &[S; M], forces: &mut [[S; 2]]) {
        self.add(&self.functionals.p0, factors, forces);
    }

    fn add(&self, functionals: &[[Vector2<S>; N]], factors: &[S], forces: &mut [[S; 2]]) {
        for (functional, &factor) in functionals.iter().zip(factors) {
            for (&node, f) in self.nodes.iter().zip(functional) {
                for c in 0..2 {
                    forces[node][c] += factor * f[c];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;
    use crate::fem::contact_line::EdgeRule;
    use crate::fem::{Condition, Diagonal, Problem, Rectangle, SharedFunction};
    use crate::kernel::{Material, P1, P2, Plane};

    fn block() -> Problem {
        let zero = || -> SharedFunction { Arc::new(|_: [f64; 2]| 0.0) };
        Problem::new(
            Rectangle { width: 3.0, height: 1.0, nx: 3, ny: 2, diagonal: Diagonal::Left }
                .mesh()
                .unwrap(),
            Material::lame(3.0, 0.7, Plane::Strain),
            [zero(), Arc::new(|[x, _]: [f64; 2]| x - 1.0)],
            BTreeMap::from([
                ("top".to_owned(), Condition::Displacement([Some(zero()), Some(zero())])),
                (
                    "bottom".to_owned(),
                    Condition::Contact { gap: Arc::new(|[x, _]: [f64; 2]| x / 7.0) },
                ),
            ]),
        )
    }

    /// The residual in double-doubles is the one in doubles, to the rounding of the latter; a change of u far below its
    /// rounding shows in P as it should.
    fn agrees_and_sees_more<E: ExactEdge<f64, N, M>, const N: usize, const M: usize>() {
        let problem = block();
        let d =
            Discretization::<E, N, M>::new(&problem, |c| c.limit() / 2.0, EdgeRule::Exact).unwrap();
        let mut u: Vec<[f64; 2]> = vec![[0.0; 2]; d.space.nodes().len()];
        for (i, u) in u.iter_mut().enumerate() {
            *u = [(i as f64).sin(), (2.0 * i as f64).cos()];
        }
        let mut fine: Vec<[DoubleDouble; 2]> =
            u.iter().map(|u| u.map(DoubleDouble::from)).collect();
        let (forces, p) = evaluate(&d, &fine);
        let doubles = d.linear_residual(&u);
        for ((a, b), m) in forces.iter().zip(&doubles.values).zip(&doubles.magnitudes) {
            for c in 0..2 {
                assert!((a[c] - b[c]).abs() <= 8.0 * f64::EPSILON * m[c]);
            }
        }
        let shift = 2.0_f64.powi(-90);
        for u in &mut fine {
            u[1] += DoubleDouble::from(shift);
        }
        let (_, moved) = evaluate(&d, &fine);
        // A translation by shift along y changes u_n by -shift and no stress.
        let change: Vec<f64> =
            p.iter().zip(&moved).map(|(&p, &moved)| (moved - p).head()).collect();
        assert!(change.iter().all(|c| c.abs() <= f64::EPSILON), "{change:?}");
        let at = d.contact[0].edge.triangle;
        let node = d.space.edge_nodes(d.contact[0].edge)[0];
        let exactly = |u: &[[DoubleDouble; 2]]| u[node][1] - DoubleDouble::from(u[node][1].head());
        assert_eq!(exactly(&fine).head(), shift, "{at}");
    }

    #[test]
    fn residuals_in_double_doubles_agree_with_those_in_doubles_and_keep_more_of_u() {
        agrees_and_sees_more::<P1, 3, 2>();
        agrees_and_sees_more::<P2, 6, 3>();
    }
}
