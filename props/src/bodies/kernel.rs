//! Method (8) on a body by looping the kernel's functions.

use signorini::kernel::contact_edge::coercivity_constant;
use signorini::kernel::edge_integral::{ExactEdge, gauss};
use signorini::kernel::element::stiffness;
use signorini::kernel::{ContactEdge, EdgeIntegrals, Element};
use signorini::nalgebra::{Matrix2, Vector2};

use super::{Body, Rule, Side, sum};
use crate::elimination::Matrix;
use crate::numbers::Exact;

/// Method (8) on a body by the kernel's functions.
pub struct Kernel<'a, const N: usize, const M: usize> {
    body: &'a Body,
    edges: Vec<ContactEdge<Exact, N, M>>,
    stiffness: Vec<[[Matrix2<Exact>; N]; N]>,
}

impl<'a, const N: usize, const M: usize> Kernel<'a, N, M> {
    /// Element matrices and contact edges of a body.
    pub fn new<E: Element<N, M>>(body: &'a Body) -> Self {
        let edge = |side: &Side| {
            let triangle = body.triangle(side.triangle);
            let gamma = body.gamma(side);
            ContactEdge::new::<E>(&triangle, side.local, side.n.into(), &body.material, gamma)
        };
        let matrix = |t| stiffness::<E, Exact, N, M>(&body.triangle(t), &body.material);
        Kernel {
            body,
            edges: body.contact.iter().map(edge).collect(),
            stiffness: (0..body.triangles.len()).map(matrix).collect(),
        }
    }

    fn apply(functional: &[Vector2<Exact>; N], v: &[[Exact; 2]; N]) -> Exact {
        sum(functional.iter().zip(v), |(f, v)| f[0] * v[0] + f[1] * v[1])
    }

    /// sum v_i K_ij u_j on one triangle
    pub fn a_on(&self, t: usize, u: &[[Exact; 2]], v: &[[Exact; 2]]) -> Exact {
        let (u, v) = (self.body.local::<N>(t, u), self.body.local::<N>(t, v));
        Self::product(|i, j| self.stiffness[t][i][j], &u, &v)
    }

    fn product(
        block: impl Fn(usize, usize) -> Matrix2<Exact>,
        u: &[[Exact; 2]; N],
        v: &[[Exact; 2]; N],
    ) -> Exact {
        let mut total = Exact::from(0);
        for i in 0..N {
            for j in 0..N {
                let entry = block(i, j);
                for c in 0..2 {
                    for d in 0..2 {
                        total += v[i][c] * entry[(c, d)] * u[j][d];
                    }
                }
            }
        }
        total
    }

    /// a(u, v)
    pub fn a(&self, u: &[[Exact; 2]], v: &[[Exact; 2]]) -> Exact {
        sum(0..self.body.triangles.len(), |t| self.a_on(t, u, v))
    }

    /// int_E gamma sigma_n(u) sigma_n(v)
    pub fn stress_product(&self, e: usize, u: &[[Exact; 2]], v: &[[Exact; 2]]) -> Exact {
        let side = &self.body.contact[e];
        let weight = self.body.gamma(side) * side.length;
        let local = |field| self.body.local::<N>(side.triangle, field);
        Self::product(|i, j| self.edges[e].stress_product(weight, i, j), &local(u), &local(v))
    }

    /// On one triangle the matrices of a and of int gamma sigma_n(u) sigma_n(v), over the components of its nodes.
    pub fn matrices_on(&self, t: usize) -> [Matrix; 2] {
        let matrix = |block: &dyn Fn(usize, usize) -> Matrix2<Exact>| -> Matrix {
            let entry =
                |row: usize, column: usize| block(row / 2, column / 2)[(row % 2, column % 2)];
            (0..2 * N).map(|row| (0..2 * N).map(|column| entry(row, column)).collect()).collect()
        };
        let owned = |e: &usize| self.body.contact[*e].triangle == t;
        let stress = |i, j| {
            let mut block = Matrix2::zeros();
            for e in (0..self.edges.len()).filter(owned) {
                let weight = self.body.gamma(&self.body.contact[e]) * self.body.contact[e].length;
                block += self.edges[e].stress_product(weight, i, j);
            }
            block
        };
        [matrix(&|i, j| self.stiffness[t][i][j]), matrix(&stress)]
    }

    /// A(u, v)
    pub fn big_a(&self, u: &[[Exact; 2]], v: &[[Exact; 2]]) -> Exact {
        self.a(u, v) - sum(0..self.edges.len(), |e| self.stress_product(e, u, v))
    }

    /// P0(v) at the nodes of edge e
    pub fn p0(&self, e: usize, v: &[[Exact; 2]]) -> [Exact; M] {
        let local = self.body.local::<N>(self.body.contact[e].triangle, v);
        self.edges[e].p0.map(|row| Self::apply(&row, &local))
    }

    /// sigma_n(v) at the ends of edge e
    pub fn sigma_n(&self, e: usize, v: &[[Exact; 2]]) -> [Exact; 2] {
        let local = self.body.local::<N>(self.body.contact[e].triangle, v);
        self.edges[e].sigma_n.map(|row| Self::apply(&row, &local))
    }

    /// P(v) at the nodes of edge e
    pub fn p(&self, e: usize, v: &[[Exact; 2]]) -> [Exact; M] {
        let mut p = self.p0(e, v);
        for (p, gap) in p.iter_mut().zip(self.body.contact[e].gap) {
            *p -= gap;
        }
        p
    }

    /// The contact integrals of edge e at u.
    fn integrals<E>(&self, rule: Rule<'_>, e: usize, u: &[[Exact; 2]]) -> EdgeIntegrals<Exact, M>
    where
        E: MaybeExact<N, M>,
    {
        let p = self.p(e, u);
        match rule {
            Rule::Exact => E::without_error(p),
            Rule::Points(points) => gauss::<E, Exact, N, M>(p, points.iter().map(|&[s, w]| (s, w))),
        }
    }

    /// |E| / gamma
    fn weight(&self, e: usize) -> Exact {
        self.body.contact[e].length / self.body.gamma(&self.body.contact[e])
    }

    /// The left side of (8): A(u, v) + int (1/gamma) \[P(u)\]+ P0(v)
    pub fn b<E>(&self, rule: Rule<'_>, u: &[[Exact; 2]], v: &[[Exact; 2]]) -> Exact
    where
        E: MaybeExact<N, M>,
    {
        let contact = sum(0..self.edges.len(), |e| {
            let gradient = self.integrals::<E>(rule, e, u).gradient;
            self.weight(e) * sum(gradient.iter().zip(self.p0(e, v)), |(&g, p)| g * p)
        });
        self.big_a(u, v) + contact
    }

    /// J_h without L: 1/2 A(u, u) + 1/2 int (1/gamma) \[P(u)\]+^2
    pub fn j<E>(&self, rule: Rule<'_>, u: &[[Exact; 2]]) -> Exact
    where
        E: MaybeExact<N, M>,
    {
        let contact = |e| self.weight(e) * self.integrals::<E>(rule, e, u).energy;
        self.big_a(u, u) / Exact::from(2) + sum(0..self.edges.len(), contact)
    }

    /// The second derivative that Newton uses, at u, of v and w.
    pub fn hessian<E>(
        &self,
        rule: Rule<'_>,
        u: &[[Exact; 2]],
        v: &[[Exact; 2]],
        w: &[[Exact; 2]],
    ) -> Exact
    where
        E: MaybeExact<N, M>,
    {
        let contact = sum(0..self.edges.len(), |e| {
            let hessian = self.integrals::<E>(rule, e, u).hessian;
            let (v, w) = (self.p0(e, v), self.p0(e, w));
            let mut total = Exact::from(0);
            for a in 0..M {
                for b in 0..M {
                    total += v[a] * hessian[a][b] * w[b];
                }
            }
            self.weight(e) * total
        });
        self.big_a(v, w) + contact
    }

    /// kappa of the body: the largest kappa_T.
    pub fn kappa<E: Element<N, M>>(&self) -> Exact {
        let mut kappa = Exact::from(0);
        for t in 0..self.body.triangles.len() {
            let of_t = self.kappa_of::<E>(t);
            if of_t > kappa {
                kappa = of_t;
            }
        }
        kappa
    }

    /// kappa_T
    pub fn kappa_of<E: Element<N, M>>(&self, t: usize) -> Exact {
        let body = self.body;
        let (h, area) = (body.diameters[t], body.triangle(t).double_area() / Exact::from(2));
        let of_side = |side: &Side| {
            let stiffness = body.material.normal_stiffness(side.n.into());
            coercivity_constant::<E, Exact, N, M>(stiffness, h, side.length, area)
        };
        body.gamma0 * sum(body.contact.iter().filter(|side| side.triangle == t), of_side)
    }
}

/// An element whose contact integrals can be had without quadrature error over rationals, or not.
pub trait MaybeExact<const N: usize, const M: usize>: Element<N, M> {
    /// The integrals.
    fn without_error(p: [Exact; M]) -> EdgeIntegrals<Exact, M>;
}

impl MaybeExact<3, 2> for signorini::kernel::P1 {
    fn without_error(p: [Exact; 2]) -> EdgeIntegrals<Exact, 2> {
        <Self as ExactEdge<Exact, 3, 2>>::exact(p)
    }
}

impl MaybeExact<6, 3> for signorini::kernel::P2 {
    fn without_error(_: [Exact; 3]) -> EdgeIntegrals<Exact, 3> {
        unreachable!("the roots of a quadratic P are no rational numbers")
    }
}
