//! The integrals of friction over a piece of Gamma_C, in doubles and in balls.
//!
//! With the bound m, gamma s for Tresca's slip bound s and mu P_n for Coulomb's coefficient mu, the tangential P_t is cut off to
//! F = clip(P_t; \[m\]+): the shear stress on the body is -F / gamma (`kernel::friction`). s is affine on a piece, from its values at
//! the ends.

use nalgebra::DMatrix;

use super::law::{EdgeRule, Integrals, in_double_doubles};
use super::moments;
use crate::kernel::friction::{
    ExactFriction, FrictionIntegrals, exact_clip_bregman, gauss_clip_bregman, gauss_friction,
};
use crate::kernel::{DoubleDouble, Element, PreciseBall};
use crate::model::element::{Degree, with_element};
use crate::model::law::Bound;

/// The integrals across the direction of contact.
pub(crate) struct Across {
    /// Energy, gradient and Hessian with respect to P_t.
    pub(crate) itself: Integrals,
    /// The derivative of the gradient with respect to P_n: not zero for Coulomb's law, which has no energy.
    pub(crate) by_normal: DMatrix<f64>,
    /// The measures of where it sticks and of where it slides.
    pub(crate) measures: [f64; 2],
}

/// The integrals of friction over a piece where P_n and P_t have these values at its nodes.
pub(crate) fn integrals<T: Copy + Into<DoubleDouble>>(
    bound: Bound,
    rule: &EdgeRule,
    (degree, gamma): (Degree, f64),
    normal: &[T],
    across: &[T],
) -> Across {
    let fine = |v: &[T]| -> Vec<DoubleDouble> { v.iter().map(|&p| p.into()).collect() };
    let (normal, across) = (fine(normal), fine(across));
    with_element!(degree, E => across_of::<E, _, _>(bound, rule, gamma, &normal, &across))
}

fn across_of<E, const N: usize, const M: usize>(
    bound: Bound,
    rule: &EdgeRule,
    gamma: f64,
    normal: &[DoubleDouble],
    across: &[DoubleDouble],
) -> Across
where
    E: ExactFriction<f64, N, M>,
{
    let of = match rule {
        EdgeRule::Exact => {
            let heads = |v: &[DoubleDouble]| v.iter().map(|p| p.head()).collect::<Vec<f64>>();
            let m = bound.at_nodes(gamma, &heads(normal));
            let p = heads(across);
            E::exact_friction(std::array::from_fn(|a| p[a]), std::array::from_fn(|a| m[a]))
        }
        EdgeRule::Gauss(points) => {
            let m = bound.at_nodes(gamma.into(), normal);
            let (p, m) = (std::array::from_fn(|a| across[a]), std::array::from_fn(|a| m[a]));
            rounded(&gauss_friction::<E, _, _, _>(p, m, in_double_doubles(points)))
        }
    };
    let block = |entries: [[f64; M]; M]| DMatrix::from_fn(M, M, |a, b| entries[a][b]);
    let by_normal = match bound {
        Bound::Tresca(_) | Bound::Given(_) => DMatrix::zeros(M, M),
        Bound::Coulomb(mu) => mu * block(of.by_bound),
    };
    let itself = Integrals {
        energy: of.energy,
        gradient: of.gradient.into(),
        hessian: block(of.by_p),
        ..Integrals::default()
    };
    Across { itself, by_normal, measures: [of.sticks, of.slides] }
}

fn rounded<const M: usize>(fine: &FrictionIntegrals<DoubleDouble, M>) -> FrictionIntegrals<f64, M> {
    FrictionIntegrals {
        energy: fine.energy.head(),
        gradient: fine.gradient.map(DoubleDouble::head),
        by_p: fine.by_p.map(|row| row.map(DoubleDouble::head)),
        by_bound: fine.by_bound.map(|row| row.map(DoubleDouble::head)),
        sticks: fine.sticks.head(),
        slides: fine.slides.head(),
    }
}

/// The integral of the Bregman distance of the energy of friction from P to Q, given by the values of both components at the nodes;
/// the bound is that of P.
pub(crate) fn bregman<T: Copy + Into<DoubleDouble>>(
    bound: Bound,
    rule: &EdgeRule,
    (degree, gamma): (Degree, f64),
    p: &[T],
    q: &[T],
) -> f64 {
    let nodes = degree.nodes_per_edge();
    let fine = |v: &[T]| -> Vec<DoubleDouble> { v.iter().map(|&p| p.into()).collect() };
    let (normal, p, q) = (fine(&p[..nodes]), fine(&p[nodes..]), fine(&q[nodes..]));
    with_element!(degree, E => {
        bregman_of::<E, _, _>(rule, &bound.at_nodes(gamma.into(), &normal), &p, &q)
    })
}

fn bregman_of<E: Element<N, M>, const N: usize, const M: usize>(
    rule: &EdgeRule,
    m: &[DoubleDouble],
    p: &[DoubleDouble],
    q: &[DoubleDouble],
) -> f64 {
    let values = |v: &[DoubleDouble]| -> [DoubleDouble; M] { std::array::from_fn(|a| v[a]) };
    let (p, q) = (values(p), values(q));
    let m = values(m).map(crate::kernel::positive_part);
    match rule {
        EdgeRule::Exact => {
            let heads = |v: [DoubleDouble; M]| v.map(DoubleDouble::head);
            exact_clip_bregman::<E, _, _>(heads(p), heads(q), heads(m))
        }
        EdgeRule::Gauss(points) => {
            gauss_clip_bregman::<E, _, _, _>(p, q, m, in_double_doubles(points)).head()
        }
    }
}

/// int F N_a over a piece, enclosed.
pub(crate) fn enclosed(
    bound: Bound,
    rule: &EdgeRule,
    (degree, gamma): (Degree, PreciseBall),
    p: &[PreciseBall],
) -> Vec<PreciseBall> {
    let (normal, across) = p.split_at(degree.nodes_per_edge());
    moments::of_friction(rule, degree, across, &bound.at_nodes(gamma, normal))
}
