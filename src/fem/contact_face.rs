//! One edge E of Gamma_C as method (8) sees it: the functionals P0 and sigma_n of the nodal values on the triangle that owns
//! it, the gap, |E| and gamma, in any numbers; and the integrals of \[P\]+ over it by the rule of the method.
//!
//! Values at the nodes of the edge have the order start, end, and for P2 the midpoint.

use std::sync::Arc;

use nalgebra::{DMatrix, Matrix2, Vector2};

use super::element::Degree;
use super::mesh::BoundaryEdge;
use super::quadrature;
use crate::kernel::DoubleDouble;
use crate::kernel::edge_integral::{self, ExactEdge};
use crate::kernel::{ContactEdge, EdgeIntegrals, Element, Material, P1, P2, Scalar, Triangle};

/// An edge of Gamma_C.
#[derive(Clone, Debug)]
pub struct ContactFace<S = f64> {
    /// Where it lies in the mesh.
    pub edge: BoundaryEdge,
    /// The name of the boundary.
    pub boundary: Arc<str>,
    /// The nodes of its triangle.
    pub nodes: Vec<usize>,
    /// |E|
    pub length: S,
    /// n
    pub normal: Vector2<S>,
    /// gamma = gamma0 h_T
    pub gamma: S,
    /// n~ at the nodes of the edge.
    pub directions: Vec<Vector2<f64>>,
    /// n~ = n at all of them.
    pub along_normal: bool,
    /// Where the nodes lie on the smooth boundary, from which the gap is measured.
    pub places: Vec<[f64; 2]>,
    /// The smooth boundary is curved along it: the edge is a chord.
    pub curved: bool,
    /// g at the nodes of the edge: on it the gap is their Lagrange interpolant.
    pub gap: Vec<f64>,
    /// P0 and sigma_n.
    pub functionals: Functionals<S>,
}

/// P0 and sigma_n on a contact edge, of the element that V^h has.
#[derive(Clone, Copy, Debug)]
pub enum Functionals<S> {
    /// P0 and sigma_n of P1.
    One(ContactEdge<S, 3, 2>),
    /// P0 and sigma_n of P2.
    Two(ContactEdge<S, 6, 3>),
}

impl<S: Scalar> Functionals<S> {
    /// The functionals on edge `i` (mod 3) of `triangle`, with the unit outward normal `n`, along `directions` where they are
    /// given, at the nodes of the edge.
    pub fn new(
        degree: Degree,
        (triangle, i): (&Triangle<S>, usize),
        n: Vector2<S>,
        directions: Option<&[Vector2<S>]>,
        material: &Material<S>,
        gamma: S,
    ) -> Self {
        let given = (triangle, i, n, directions, material, gamma);
        match degree {
            Degree::One => Functionals::One(functionals::<P1, _, _, _>(given)),
            Degree::Two => Functionals::Two(functionals::<P2, _, _, _>(given)),
        }
    }

    /// The polynomial degree of V^h.
    pub fn degree(&self) -> Degree {
        match self {
            Functionals::One(_) => Degree::One,
            Functionals::Two(_) => Degree::Two,
        }
    }

    /// P0 at each node of the edge: a vector for each node of the triangle.
    pub fn p0(&self) -> Vec<&[Vector2<S>]> {
        match self {
            Functionals::One(edge) => edge.p0.iter().map(|row| &row[..]).collect(),
            Functionals::Two(edge) => edge.p0.iter().map(|row| &row[..]).collect(),
        }
    }

    /// sigma_n at the start and at the end of the edge.
    pub fn sigma_n(&self) -> [&[Vector2<S>]; 2] {
        match self {
            Functionals::One(edge) => edge.sigma_n.each_ref().map(|row| &row[..]),
            Functionals::Two(edge) => edge.sigma_n.each_ref().map(|row| &row[..]),
        }
    }

    /// int_E gamma sigma_n(u) sigma_n(v) for v = N_i e_c, u = N_j e_d in entry (c, d), with `weight` = gamma |E|.
    pub fn stress_product(&self, weight: S, i: usize, j: usize) -> Matrix2<S> {
        match self {
            Functionals::One(edge) => edge.stress_product(weight, i, j),
            Functionals::Two(edge) => edge.stress_product(weight, i, j),
        }
    }
}

/// Triangle, number of the edge, n, n~ where it is not n, material and gamma.
type FaceData<'a, S> =
    (&'a Triangle<S>, usize, Vector2<S>, Option<&'a [Vector2<S>]>, &'a Material<S>, S);

fn functionals<E: Element<N, M>, const N: usize, const M: usize, S: Scalar>(
    (triangle, i, n, directions, material, gamma): FaceData<S>,
) -> ContactEdge<S, N, M> {
    match directions {
        None => ContactEdge::new::<E>(triangle, i, n, material, gamma),
        Some(along) => {
            let along = std::array::from_fn(|a| along[a]);
            ContactEdge::along::<E>(triangle, i, n, &along, material, gamma)
        }
    }
}

impl<S: Scalar + From<f64>> ContactFace<S> {
    /// n~ at node `a` of the edge.
    pub fn direction(&self, a: usize) -> Vector2<S> {
        if self.along_normal { self.normal } else { self.directions[a].map(<S as From<f64>>::from) }
    }

    /// The nodes of the edge.
    pub fn on_edge(&self) -> impl Iterator<Item = usize> + '_ {
        let on_edge = self.functionals.degree().edge_nodes(self.edge.local);
        on_edge.into_iter().map(|k| self.nodes[k])
    }

    /// The value of a functional at the differences of nodal values from `from`: a body that moves far and strains little loses
    /// no digits.
    fn apply(&self, functional: &[Vector2<S>], u: impl Fn(usize) -> [S; 2], from: [S; 2]) -> S {
        let zero = <S as From<i32>>::from(0);
        functional.iter().zip(&self.nodes).fold(zero, |sum, (f, &node)| {
            let [x, y] = u(node);
            sum + f[0] * (x - from[0]) + f[1] * (y - from[1])
        })
    }

    /// P0(u) at the nodes of the edge. P0 of a translation is its component along n~.
    pub fn p0(&self, u: &[[S; 2]]) -> Vec<S> {
        let rows = self.functionals.p0().into_iter().zip(self.on_edge()).enumerate();
        rows.map(|(a, (row, node))| {
            let (n, at) = (self.direction(a), u[node]);
            n[0] * at[0] + n[1] * at[1] + self.apply(row, |node| u[node], at)
        })
        .collect()
    }

    /// P(u) = P0(u) - g there.
    pub fn p(&self, u: &[[S; 2]]) -> Vec<S> {
        let gap = self.gap.iter().map(|&g| <S as From<f64>>::from(g));
        self.p0(u).into_iter().zip(gap).map(|(p0, g)| p0 - g).collect()
    }

    /// sigma_n(u) at the start and at the end of the edge.
    pub fn sigma_n(&self, u: impl Fn(usize) -> [S; 2]) -> [S; 2] {
        let first = u(self.nodes[0]);
        self.functionals.sigma_n().map(|row| self.apply(row, &u, first))
    }

    /// Returns -int gamma sigma_n(u) sigma_n(.) over the edge in terms of sigma_n at its two ends, for sigma_n(u) = `stress`.
    pub(crate) fn stress_factors(&self, [start, end]: [S; 2]) -> [S; 2] {
        let [two, six] = [2, 6].map(<S as From<i32>>::from);
        let mass = -(self.gamma * self.length) / six;
        [mass * (two * start + end), mass * (start + two * end)]
    }

    /// Adds -int gamma sigma_n(u) sigma_n(v) over the edge for every basis function v.
    pub fn add_stresses(&self, u: &[[S; 2]], forces: &mut [[S; 2]]) {
        let factors = self.stress_factors(self.sigma_n(|node| u[node]));
        self.each_force(&self.functionals.sigma_n(), &factors, |node, f| {
            forces[node] = [forces[node][0] + f[0], forces[node][1] + f[1]];
        });
    }

    /// Adds the values of P0 at the nodes, each times its factor, as forces on the body.
    pub fn add_contact(&self, factors: &[S], forces: &mut [[S; 2]]) {
        self.each_force(&self.functionals.p0(), factors, |node, f| {
            forces[node] = [forces[node][0] + f[0], forces[node][1] + f[1]];
        });
    }

    /// Calls `add` with the forces that functionals are at the nodes of the triangle, each functional times its factor.
    pub(super) fn each_force(
        &self,
        functionals: &[&[Vector2<S>]],
        factors: &[S],
        mut add: impl FnMut(usize, Vector2<S>),
    ) {
        for (functional, &factor) in functionals.iter().zip(factors) {
            for (&node, f) in self.nodes.iter().zip(*functional) {
                add(node, *f * factor);
            }
        }
    }

    /// The edge in other numbers, with these length, normal and gamma.
    pub(crate) fn in_numbers<T: Scalar + From<f64>>(
        &self,
        (triangle, material): (&Triangle<T>, &Material<T>),
        (length, normal, gamma): (T, Vector2<T>, T),
    ) -> ContactFace<T> {
        let turned: Vec<Vector2<T>> =
            self.directions.iter().map(|d| d.map(<T as From<f64>>::from)).collect();
        let along = (!self.along_normal).then_some(&turned[..]);
        let (degree, local) = (self.functionals.degree(), self.edge.local);
        let functionals =
            Functionals::new(degree, (triangle, local), normal, along, material, gamma);
        ContactFace {
            edge: self.edge,
            boundary: Arc::clone(&self.boundary),
            nodes: self.nodes.clone(),
            length,
            normal,
            gamma,
            directions: self.directions.clone(),
            along_normal: self.along_normal,
            places: self.places.clone(),
            curved: self.curved,
            gap: self.gap.clone(),
            functionals,
        }
    }
}

impl ContactFace {
    /// The sums of the magnitudes of the products that P0(u) is added up from at the nodes of the edge.
    pub(crate) fn p0_magnitudes(&self, u: &[[f64; 2]]) -> Vec<f64> {
        let rows = self.functionals.p0().into_iter().zip(self.on_edge()).enumerate();
        rows.map(|(a, (row, node))| {
            let size = |f: Vector2<f64>, x: f64, y: f64| (f[0] * x).abs() + (f[1] * y).abs();
            let (n, [x, y]) = (self.direction(a), u[node]);
            let others = row.iter().zip(&self.nodes);
            size(n, x, y) + others.map(|(&f, &k)| size(f, u[k][0] - x, u[k][1] - y)).sum::<f64>()
        })
        .collect()
    }
}

/// The integrals of (8) and J_h over an edge, s in \[0, 1\]; multiply all but `active` by |E| / gamma, and `active` by |E|.
#[derive(Clone, Debug, PartialEq)]
pub struct Integrals {
    /// 1/2 int \[P\]+^2
    pub energy: f64,
    /// int \[P\]+ N_a
    pub gradient: Vec<f64>,
    /// int_{P > 0} N_a N_b
    pub hessian: DMatrix<f64>,
    /// the measure of {P > 0}
    pub active: f64,
}

impl<const M: usize> From<EdgeIntegrals<f64, M>> for Integrals {
    fn from(of: EdgeIntegrals<f64, M>) -> Self {
        let hessian = DMatrix::from_fn(M, M, |a, b| of.hessian[a][b]);
        Integrals { energy: of.energy, gradient: of.gradient.into(), hessian, active: of.active }
    }
}

/// How \[P\]+ is integrated over an edge.
#[derive(Clone, Debug, PartialEq)]
pub enum EdgeRule {
    /// Cut at the roots of P: no quadrature error.
    Exact,
    /// The points of a Gauss rule on \[0, 1\].
    Gauss(Vec<(f64, f64)>),
}

impl EdgeRule {
    /// The Gauss rule with `n` points.
    pub fn gauss(n: usize) -> Self {
        EdgeRule::Gauss(quadrature::gauss(n))
    }

    /// The integrals of (8) and J_h over an edge, for P with the nodal values `p`, two or three. At the points of a Gauss rule P
    /// is evaluated in double-doubles: where gamma is small it is far smaller there than at the nodes.
    pub fn integrals<T: Copy + Into<DoubleDouble>>(&self, p: &[T]) -> Integrals {
        match *p {
            [start, end] => self.integrals_of::<P1, _, _>([start, end].map(Into::into)).into(),
            _ => self.integrals_of::<P2, _, _>([p[0], p[1], p[2]].map(Into::into)).into(),
        }
    }

    fn integrals_of<E, const N: usize, const M: usize>(
        &self,
        p: [DoubleDouble; M],
    ) -> EdgeIntegrals<f64, M>
    where
        E: ExactEdge<f64, N, M>,
    {
        match self {
            EdgeRule::Exact => E::exact(p.map(DoubleDouble::head)),
            EdgeRule::Gauss(rule) => {
                let fine = edge_integral::gauss::<E, _, _, _>(p, in_double_doubles(rule));
                EdgeIntegrals {
                    energy: fine.energy.head(),
                    gradient: fine.gradient.map(DoubleDouble::head),
                    hessian: fine.hessian.map(|row| row.map(DoubleDouble::head)),
                    active: fine.active.head(),
                }
            }
        }
    }

    /// The integral of the Bregman distance of 1/2 \[.\]+^2 from P to Q, given by their nodal values.
    pub fn bregman<T: Copy + Into<DoubleDouble>>(&self, p: &[T], q: &[T]) -> f64 {
        match (p, q) {
            (&[p, r], &[q, s]) => self.bregman_of::<P1, _, _>([p, r], [q, s]),
            _ => self.bregman_of::<P2, _, _>([p[0], p[1], p[2]], [q[0], q[1], q[2]]),
        }
    }

    fn bregman_of<E, const N: usize, const M: usize>(
        &self,
        p: [impl Into<DoubleDouble>; M],
        q: [impl Into<DoubleDouble>; M],
    ) -> f64
    where
        E: ExactEdge<f64, N, M>,
    {
        let (p, q): ([DoubleDouble; M], [DoubleDouble; M]) = (p.map(Into::into), q.map(Into::into));
        match self {
            EdgeRule::Exact => {
                let [p, q] = [p, q].map(|values| values.map(DoubleDouble::head));
                edge_integral::exact_bregman::<E, _, _>(p, q)
            }
            EdgeRule::Gauss(rule) => {
                edge_integral::gauss_bregman::<E, _, _, _>(p, q, in_double_doubles(rule)).head()
            }
        }
    }
}

/// Points and weights, exactly.
fn in_double_doubles(rule: &[(f64, f64)]) -> impl Iterator<Item = (DoubleDouble, DoubleDouble)> {
    rule.iter().map(|&(s, weight)| (s.into(), weight.into()))
}
