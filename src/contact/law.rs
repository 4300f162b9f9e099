//! The laws of the interfaces along Gamma_C, and the integrals over a piece that each of them has in method (8).

use nalgebra::DMatrix;

use super::friction;
use crate::kernel::edge_integral::{self, ExactEdge};
use crate::kernel::{DoubleDouble, EdgeIntegrals, Element, Response};
use crate::model::element::{Degree, with_element};
use crate::model::law::Law;
use crate::model::quadrature;

impl Law {
    /// The integrals of (8) and J_h over a piece with this gamma for P with the nodal values `p`, component after component; with the
    /// weight r where it has these `radii` at its ends. Friction is for plane bodies.
    pub(crate) fn integrals<T: Copy + Into<DoubleDouble>>(
        self,
        rule: &EdgeRule,
        (degree, gamma): (Degree, f64),
        radii: Option<[f64; 2]>,
        p: &[T],
    ) -> Integrals {
        let of = |(response, p): (&Response, &[T])| match response {
            Response::Unilateral => rule.integrals(degree, radii, p),
            Response::Bilateral => bilateral(degree, radii, p),
        };
        let mut each = self.responses().iter().zip(p.chunks(degree.nodes_per_edge())).map(of);
        // Every law has a component.
        let first = each.next().unwrap_or_default();
        match self {
            Law::Friction(bound) => {
                let (normal, across) = p.split_at(degree.nodes_per_edge().min(p.len()));
                first.with_friction(friction::integrals(
                    bound,
                    rule,
                    (degree, gamma),
                    normal,
                    across,
                ))
            }
            _ => each.fold(first, Integrals::beside),
        }
    }

    /// The integral of the Bregman distance of the energy from P to Q, given by their nodal values. Coulomb's law has no energy: its
    /// bound is taken where P is.
    pub(crate) fn bregman<T: Copy + Into<DoubleDouble>>(
        self,
        rule: &EdgeRule,
        (degree, gamma): (Degree, f64),
        radii: Option<[f64; 2]>,
        p: &[T],
        q: &[T],
    ) -> f64 {
        let nodes = degree.nodes_per_edge();
        let of = |((response, p), q): ((&Response, &[T]), &[T])| match response {
            Response::Unilateral => rule.bregman(degree, radii, p, q),
            Response::Bilateral => {
                let difference = |(&p, &q): (&T, &T)| q.into() - p.into();
                let step: Vec<DoubleDouble> = p.iter().zip(q).map(difference).collect();
                bilateral(degree, radii, &step).energy
            }
        };
        let own: f64 =
            self.responses().iter().zip(p.chunks(nodes)).zip(q.chunks(nodes)).map(of).sum();
        match self {
            Law::Friction(bound) => own + friction::bregman(bound, rule, (degree, gamma), p, q),
            _ => own,
        }
    }
}

/// The integrals where P itself is integrated, exactly whatever the rule.
fn bilateral<T: Copy + Into<DoubleDouble>>(
    degree: Degree,
    radii: Option<[f64; 2]>,
    p: &[T],
) -> Integrals {
    with_element!(degree, E => {
        let p = std::array::from_fn(|a| p[a].into().head());
        edge_integral::bilateral::<E, f64, _, _>(p, radii).into()
    })
}

/// The integrals of (8) and J_h over a piece, s in \[0, 1\]; multiply all but `active` by |E| / gamma, and `active` by |E|.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Integrals {
    /// 1/2 int \[P\]+^2
    pub(crate) energy: f64,
    /// int \[P\]+ N_a
    pub(crate) gradient: Vec<f64>,
    /// int_{P > 0} N_a N_b
    pub(crate) hessian: DMatrix<f64>,
    /// the measure of {P > 0}
    pub(crate) active: f64,
    /// The measures of where friction sticks and of where it slides.
    pub(crate) friction: [f64; 2],
}

impl Default for Integrals {
    fn default() -> Self {
        let (gradient, hessian) = (Vec::new(), DMatrix::zeros(0, 0));
        Integrals { energy: 0.0, gradient, hessian, active: 0.0, friction: [0.0; 2] }
    }
}

impl<const M: usize> From<EdgeIntegrals<f64, M>> for Integrals {
    fn from(of: EdgeIntegrals<f64, M>) -> Self {
        let hessian = DMatrix::from_row_slice(M, M, of.hessian.as_flattened());
        let (gradient, friction) = (of.gradient.into(), [0.0; 2]);
        Integrals { energy: of.energy, gradient, hessian, active: of.active, friction }
    }
}

impl Integrals {
    /// The integrals of two components that know nothing of each other.
    fn beside(mut self, other: Integrals) -> Self {
        let (rows, more) = (self.hessian.nrows(), other.hessian.nrows());
        let mut hessian = DMatrix::zeros(rows + more, rows + more);
        hessian.view_mut((0, 0), (rows, rows)).copy_from(&self.hessian);
        hessian.view_mut((rows, rows), (more, more)).copy_from(&other.hessian);
        self.gradient.extend(other.gradient);
        let (energy, active) = (self.energy + other.energy, self.active.max(other.active));
        Integrals { energy, gradient: self.gradient, hessian, active, friction: [0.0; 2] }
    }

    /// These integrals of contact, and those of friction beside. Its forces change with P_n where the bound does.
    fn with_friction(self, friction: friction::Across) -> Integrals {
        let (rows, measures) = (self.hessian.nrows(), friction.measures);
        let mut both = self.beside(friction.itself);
        both.hessian.view_mut((rows, 0), friction.by_normal.shape()).copy_from(&friction.by_normal);
        Integrals { friction: measures, ..both }
    }
}

/// How \[P\]+ is integrated over a piece.
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

    /// The integrals of (8) and J_h over a piece, for P of this degree with the nodal values `p`. At the points of a Gauss rule P
    /// is evaluated in double-doubles: where gamma is small it is far smaller there than at the nodes.
    pub(crate) fn integrals<T: Copy + Into<DoubleDouble>>(
        &self,
        degree: Degree,
        radii: Option<[f64; 2]>,
        p: &[T],
    ) -> Integrals {
        with_element!(degree, E => {
            self.integrals_of::<E, _, _>(radii, std::array::from_fn(|a| p[a].into())).into()
        })
    }

    fn integrals_of<E, const N: usize, const M: usize>(
        &self,
        radii: Option<[f64; 2]>,
        p: [DoubleDouble; M],
    ) -> EdgeIntegrals<f64, M>
    where
        E: ExactEdge<f64, N, M>,
    {
        if is_open(&p) {
            let (gradient, hessian) = ([0.0; M], [[0.0; M]; M]);
            return EdgeIntegrals { energy: 0.0, gradient, hessian, active: 0.0 };
        }
        match (self, radii) {
            (EdgeRule::Exact, radii) => E::exact_with(p.map(DoubleDouble::head), radii),
            (EdgeRule::Gauss(rule), radii) => {
                let value = |s: f64| edge_integral::value_at::<E, _, _, _>(p, s.into()).head();
                let values = rule.iter().map(|&(s, weight)| (value(s), s, weight));
                edge_integral::gauss_of::<E, _, _, _>(values, radii)
            }
        }
    }

    /// The integral of the Bregman distance of 1/2 \[.\]+^2 from P to Q, of this degree, given by their nodal values.
    pub fn bregman<T: Copy + Into<DoubleDouble>>(
        &self,
        degree: Degree,
        radii: Option<[f64; 2]>,
        p: &[T],
        q: &[T],
    ) -> f64 {
        with_element!(degree, E => self.bregman_of::<E, _, _>(
            radii,
            std::array::from_fn(|a| p[a].into()),
            std::array::from_fn(|a| q[a].into()),
        ))
    }

    fn bregman_of<E, const N: usize, const M: usize>(
        &self,
        radii: Option<[f64; 2]>,
        p: [DoubleDouble; M],
        q: [DoubleDouble; M],
    ) -> f64
    where
        E: Element<N, M>,
    {
        if is_open(&p) && is_open(&q) {
            return 0.0;
        }
        match self {
            EdgeRule::Exact => {
                let [p, q] = [p, q].map(|values| values.map(DoubleDouble::head));
                edge_integral::exact_bregman::<E, _, _>(p, q, radii)
            }
            EdgeRule::Gauss(rule) => {
                let points = in_double_doubles(rule)
                    .map(|(s, weight)| (s, edge_integral::times_radius(weight, fine(radii), s)));
                edge_integral::gauss_bregman::<E, _, _, _>(p, q, points).head()
            }
        }
    }
}

/// Returns whether P with these values at the nodes is positive nowhere on an edge, certainly: none of its Bernstein coefficients is.
/// There every integral is zero, whatever the rule.
pub(super) fn is_open(p: &[DoubleDouble]) -> bool {
    let size: f64 = p.iter().map(|p| p.head().abs()).sum();
    let ends = p[0].head() + p[1].head();
    let middle = |p: &DoubleDouble| 2.0 * p.head() - ends / 2.0 + 4.0 * f64::EPSILON * size;
    p[..2].iter().all(|p| p.head() <= 0.0) && p[2..].iter().all(|p| middle(p) <= 0.0)
}

fn fine(radii: Option<[f64; 2]>) -> Option<[DoubleDouble; 2]> {
    radii.map(|radii| radii.map(DoubleDouble::from))
}

/// Points and weights, exactly.
pub(super) fn in_double_doubles(
    rule: &[(f64, f64)],
) -> impl Iterator<Item = (DoubleDouble, DoubleDouble)> {
    rule.iter().map(|&(s, weight)| (s.into(), weight.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::P2;
    use crate::model::law::Bound;

    const LAWS: [Law; 4] =
        [Law::Contact, Law::Sliding, Law::Bonded, Law::Friction(Bound::Tresca([0.4, 0.7]))];
    const DEGREES: [Degree; 2] = [Degree::One, Degree::Two];

    /// Values at the nodes of a piece, of both signs.
    fn values(law: Law, degree: Degree, turn: f64) -> Vec<f64> {
        let count = law.components() * degree.nodes_per_edge();
        (0..count).map(|i| (turn + 2.3 * i as f64).sin()).collect()
    }

    #[test]
    fn the_force_is_the_slope_of_the_energy_and_the_tangent_that_of_the_force() {
        for (law, degree) in LAWS.into_iter().flat_map(|law| DEGREES.map(|degree| (law, degree))) {
            let at = |p: &[f64]| law.integrals(&EdgeRule::Exact, (degree, 1.0), None, p);
            let p = values(law, degree, 0.4);
            let step = 1e-5;
            for i in 0..p.len() {
                let [low, high] = [-step, step].map(|by| {
                    let mut moved = p.clone();
                    moved[i] += by;
                    at(&moved)
                });
                // Central differences of piecewise polynomials are off by the square of the step.
                let near = |a: f64, b: f64| (a - b).abs() < 1e-8;
                let slope = |high: f64, low: f64| (high - low) / (2.0 * step);
                assert!(near(slope(high.energy, low.energy), at(&p).gradient[i]), "{law:?}");
                for j in 0..p.len() {
                    let found = slope(high.gradient[j], low.gradient[j]);
                    assert!(near(found, at(&p).hessian[(i, j)]), "{law:?} {degree:?}");
                }
            }
        }
    }

    #[test]
    fn an_edge_is_open_where_no_point_of_it_presses() {
        let of = |p: [f64; 3]| is_open(&p.map(DoubleDouble::from));
        assert!(of([-1.0, -1.0, -1.0]) && of([-1.0, 0.0, -0.5]) && of([-0.0, -2.0, -0.6]));
        // It presses at an end, in the middle, between the nodes, or may: 0.
        assert!(!of([1e-300, -1.0, -1.0]) && !of([-1.0, -1.0, 1e-9]) && !of([-2.0, 0.0, -0.2]));
        assert!(!of([f64::NAN, -1.0, -1.0]) && !of([-1.0, -1.0, f64::NAN]));
        let at = |s: f64| edge_integral::value_at::<P2, f64, _, _>([-2.0, 0.0, -0.2], s);
        assert!((1..100).any(|k| at(f64::from(k) / 100.0) > 0.0), "control");
    }

    #[test]
    fn the_bregman_distance_is_the_nonlinear_part_of_the_change_of_energy() {
        for (law, degree) in LAWS.into_iter().flat_map(|law| DEGREES.map(|degree| (law, degree))) {
            let at = |p: &[f64]| law.integrals(&EdgeRule::Exact, (degree, 1.0), None, p);
            let (p, q) = (values(law, degree, 0.4), values(law, degree, 2.9));
            let gradient = at(&p).gradient;
            let slope: f64 = (0..p.len()).map(|i| gradient[i] * (q[i] - p[i])).sum();
            let expected = at(&q).energy - at(&p).energy - slope;
            let found = law.bregman(&EdgeRule::Exact, (degree, 1.0), None, &p, &q);
            // Numbers of size 1.
            assert!((found - expected).abs() < 1e-14, "{law:?} {degree:?}: {found} {expected}");
            let other = LAWS[usize::from(law == Law::Contact)];
            assert!(
                (other.bregman(&EdgeRule::Exact, (degree, 1.0), None, &p, &q) - found).abs() > 1e-3
            );
        }
    }
}
