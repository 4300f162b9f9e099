//! What contact holds: the edges of Gamma_C that are surely pressed around the computed displacement, and the matrix A_S of (8)
//! there. Where contact alone stops a rigid motion of the body, A is singular; A_S = A + the springs of those edges S is not,
//! and on a ball around the displacement in which they stay pressed (8) is strongly monotone in its norm. docs/theory.md, 7.5,
//! has the proofs.
//!
//! |v|_S^2 = A(v, v) + sum over S of the rule's integral of P0(v)^2 / gamma

use super::balls::Lines;
use crate::fem::Discretization;
use crate::fem::ball::{Ball, up};
use crate::fem::contact_line::EdgeRule;
use crate::fem::korn::Hold;
use crate::fem::moments::moments;
use crate::fem::precise::OnEdge;
use crate::kernel::Interval;
use crate::kernel::edge_integral::ExactEdge;

/// An edge is taken for pressed where P is at least this share of the most that it is all along some edge.
const SHARE: f64 = 1.0 / (1 << 20) as f64;

/// Points and weights of a Gauss rule may be off by rounding: its integrals of shape functions times each other are by less.
const ROUNDING: f64 = 1e-12;

/// max p^2 <= this times (k + 1)^2 times the rule's integral of p^2, for p of degree k: 1 but for [`ROUNDING`].
const SAFETY: f64 = 1.001;

/// The edges S.
pub struct Pressed<const M: usize> {
    /// For each contact edge in S, the least of P along it at the displacement, or less, and the most that P0(v) is along it
    /// beside |v|_S.
    edges: Vec<Option<[f64; 2]>>,
    /// The rule's integrals of N_a N_b.
    mass: [[Ball; M]; M],
}

impl<const M: usize> Pressed<M> {
    /// No edge: |v|_S = |v|_A.
    pub fn nowhere(count: usize) -> Self {
        Pressed { edges: vec![None; count], mass: [[Ball::from(0); M]; M] }
    }

    /// The edges that are surely pressed at the displacement `u`. None where the rule has too few points to see all of P0.
    pub fn at<E, const N: usize>(
        d: &Discretization<E, N, M>,
        lines: &Lines<N, M>,
        u: &[[Ball; 2]],
    ) -> Self
    where
        E: ExactEdge<f64, N, M>,
    {
        let [mass, exact] = [&d.rule, &EdgeRule::Exact].map(mass::<E, N, M>);
        let pairs = mass.iter().zip(&exact).flat_map(|(a, b)| a.iter().zip(b));
        if !pairs.into_iter().all(|(&a, &b)| (a - b).magnitude() <= ROUNDING) {
            return Pressed::nowhere(lines.len());
        }
        let edges = d.contact.iter().zip(lines);
        let least: Vec<f64> = edges.map(|(edge, line)| least(line.p(edge, u))).collect();
        let enough = SHARE * least.iter().copied().fold(0.0, f64::max);
        let of = |(line, least): (&OnEdge<Ball, N, M>, f64)| {
            let most = SAFETY * M as f64 * root_of(line);
            (least > 0.0 && least >= enough).then_some([least, most])
        };
        Pressed { edges: lines.iter().zip(least).map(of).collect(), mass }
    }

    /// For each contact edge whether it is one of them.
    pub fn edges(&self) -> impl Iterator<Item = bool> {
        self.edges.iter().map(Option::is_some)
    }

    /// Whether all of them stay pressed on a ball of radius `rho` and a little more.
    pub fn stay(&self, rho: f64) -> bool {
        self.edges.iter().flatten().all(|[least, most]| *least > SAFETY * most * rho)
    }

    /// What they hold at their ends: n~ . v = P0(v) + gamma s(v), for |v|_S (1 - kappa)^{-1/2} <= 1. There |P0(v)| is at most
    /// what it is along the edge, and gamma |s(v)| at most 2 (gamma / |E|)^{1/2}, as s is affine and int gamma s^2 <= 1.
    pub fn holds<E, const N: usize>(
        &self,
        d: &Discretization<E, N, M>,
        lines: &Lines<N, M>,
    ) -> Vec<Hold>
    where
        E: ExactEdge<f64, N, M>,
    {
        let mesh = d.space.mesh();
        let mut holds = Vec::new();
        for ((edge, line), most) in d.contact.iter().zip(lines).zip(&self.edges) {
            let Some([_, most]) = most else { continue };
            for (end, vertex) in mesh.ends(edge.edge).into_iter().enumerate() {
                let direction: [Ball; 2] = if edge.directions == [edge.normal; M] {
                    line.numbers.normal.into()
                } else {
                    edge.directions[end].map(Ball::from).into()
                };
                holds.push(Hold {
                    triangle: edge.edge.triangle,
                    at: mesh.vertices()[vertex],
                    direction: direction.map(|n| Interval::new(n.lower(), n.upper())),
                    most: up(most + SAFETY * 2.0 * root_of(line)),
                });
            }
        }
        holds
    }

    /// Adds what their springs do against v, the rule's integral of P0(v) P0(w) / gamma for every basis function w.
    pub fn add_springs<const N: usize>(
        &self,
        lines: &Lines<N, M>,
        v: &[[Ball; 2]],
        forces: &mut [[Ball; 2]],
    ) {
        for (line, _) in lines.iter().zip(&self.edges).filter(|(_, pressed)| pressed.is_some()) {
            let weight = line.numbers.length / line.numbers.gamma;
            let p0 = line.p0(v);
            let moment = |row: &[Ball; M]| {
                row.iter().zip(p0).fold(Ball::from(0), |sum, (&m, p)| sum + m * p)
            };
            line.add_contact(&self.mass.each_ref().map(|row| weight * moment(row)), forces);
        }
    }
}

/// (gamma / |E|)^{1/2}
fn root_of<const N: usize, const M: usize>(line: &OnEdge<Ball, N, M>) -> f64 {
    up((line.numbers.gamma / line.numbers.length).upper().sqrt())
}

/// A lower bound of a polynomial on an edge by its Bernstein coefficients, from its values at the nodes.
fn least<const M: usize>(p: [Ball; M]) -> f64 {
    let ends = p[0].lower().min(p[1].lower());
    if M == 2 {
        return ends;
    }
    let [two, half] = [Ball::from(2), Ball::from(0.5)];
    ends.min((two * p[M - 1] - half * (p[0] + p[1])).lower())
}

/// An upper bound of it.
pub fn greatest<const M: usize>(p: [Ball; M]) -> f64 {
    -least(p.map(|p| -p))
}

/// How much P0(v) is along an edge at most where |v| is at most `far` at its nodes and `radius` in the energy norm a: n~ . v is at most
/// 5/4 of the largest nodal value, gamma |s(v)| at most 2 (gamma / |E|)^{1/2} |v|_a.
pub fn change<const N: usize, const M: usize>(
    line: &OnEdge<Ball, N, M>,
    far: f64,
    radius: f64,
) -> f64 {
    up(SAFETY * (1.25 * far + 2.0 * root_of(line) * radius))
}

/// The rule's integrals of N_a N_b, of which those of \[P\]+ N_a are made: p = \[p\]+ - \[-p\]+.
fn mass<E, const N: usize, const M: usize>(rule: &EdgeRule) -> [[Ball; M]; M]
where
    E: ExactEdge<f64, N, M>,
{
    std::array::from_fn(|b| {
        let unit = |sign: i32| std::array::from_fn(|a| Ball::from(if a == b { sign } else { 0 }));
        let [plus, minus] = [1, -1].map(|sign| moments::<E, N, M>(rule, unit(sign)));
        std::array::from_fn(|a| plus[a] - minus[a])
    })
}
