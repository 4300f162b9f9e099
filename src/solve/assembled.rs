//! The assembled route: Newton's method on the displacement itself, the tangent A + B^T Psi'' B factored in each step. It is
//! the cheaper one where contact edges are many beside the body (strips, graded meshes), and the only one where A alone is
//! singular, or as good as: contact then holds the body, and the tangent knows it.

use nalgebra::Matrix2;

use super::SolveError;
use super::accuracy::{Pass, Route};
use super::contact_edges::ContactEdges;
use super::factor::{Factor, Indefinite};
use super::iterate::{Evaluation, Iterate};
use super::newton::{self, Body, Derivatives, Edges, Residual, Step, Until, block};
use super::system::System;
use crate::fem::matrix::LowerTriangle;
use crate::kernel::edge_integral::ExactEdge;

/// The tangent last factored.
pub struct Assembled<'a, 'd, 'p, E, const N: usize, const M: usize> {
    system: &'a System<'d, 'p, E, N, M>,
    /// What residuals are relative to.
    reference: f64,
    /// The contact edges as they come.
    order: Vec<usize>,
    factored: Option<Factored<M>>,
    factorizations: usize,
    precisely: bool,
    first: bool,
}

/// A tangent is factored anew if an entry of Psi'' has changed by more than this share of the largest: one that has not is
/// as good a tangent, for the residual is the true one.
const CHANGED: f64 = 1e-3;

impl<'a, 'd, 'p, E, const N: usize, const M: usize> Assembled<'a, 'd, 'p, E, N, M>
where
    E: ExactEdge<f64, N, M>,
{
    /// Before anything is factored.
    pub fn new(system: &'a System<'d, 'p, E, N, M>, reference: f64) -> Self {
        let order = (0..system.d.contact.len()).collect();
        Assembled {
            system,
            reference,
            order,
            factored: None,
            factorizations: 0,
            precisely: false,
            first: true,
        }
    }

    /// How many tangents have been factored.
    pub fn factorizations(&self) -> usize {
        self.factorizations
    }

    /// A + B^T Psi'' B
    fn tangent(&self, at: &Derivatives<M>) -> LowerTriangle {
        let d = self.system.d;
        let mut matrix = self.system.matrix.clone();
        for (edge, h) in d.contact.iter().zip(&at.hessian) {
            let p0 = &edge.functionals.p0;
            let nodes = &d.space.elements()[edge.edge.triangle];
            matrix.add(&self.system.numbering, nodes, |i, j| {
                Matrix2::from_fn(|c, k| {
                    let mut sum = 0.0;
                    for a in 0..M {
                        for b in 0..M {
                            sum += p0[a][i][c] * h[a][b] * p0[b][j][k];
                        }
                    }
                    sum
                })
            });
        }
        matrix
    }

    /// The same with a little of the springs of all edges added.
    fn supported(&self, at: &Derivatives<M>) -> Derivatives<M> {
        let edges = ContactEdges { d: self.system.d, order: &self.order };
        let all = newton::derivatives(&edges, &vec![1.0; at.gradient.len()]);
        let sum = |(h, all): (&[[f64; M]; M], &[[f64; M]; M])| {
            std::array::from_fn(|a| std::array::from_fn(|b| h[a][b] + SUPPORT * all[a][b]))
        };
        let hessian = at.hessian.iter().zip(&all.hessian).map(sum).collect();
        Derivatives { gradient: at.gradient.clone(), hessian }
    }

    fn factor(&mut self, at: &Derivatives<M>) -> Result<&Factor, SolveError> {
        let largest =
            at.hessian.as_flattened().as_flattened().iter().fold(0.0, |m: f64, h| m.max(h.abs()));
        let close = |old: &[[[f64; M]; M]]| {
            let (old, new) =
                (old.as_flattened().as_flattened(), at.hessian.as_flattened().as_flattened());
            old.iter().zip(new).all(|(old, new)| (old - new).abs() <= CHANGED * largest)
        };
        let (factor, hessian) = match self.factored.take() {
            Some((factor, old)) if close(&old) => (factor, old),
            _ => {
                let mut factored = Factor::with(&self.system.structure, &self.tangent(at))?;
                self.factorizations += 1;
                if factored.is_err() && self.system.d.kappa() < 1.0 {
                    let supported = self.supported(at);
                    factored = Factor::with(&self.system.structure, &self.tangent(&supported))?;
                    self.factorizations += 1;
                }
                let coercive = self.system.d.kappa() < 1.0;
                let factor = factored.map_err(|Indefinite| match coercive {
                    true => SolveError::Singular,
                    false => SolveError::NotPositiveDefinite,
                })?;
                (factor, at.hessian.clone())
            }
        };
        Ok(&self.factored.insert((factor, hessian)).0)
    }
}

/// A factor with the Psi'' of its tangent.
type Factored<const M: usize> = (Factor, Vec<[[f64; M]; M]>);

impl<E, const N: usize, const M: usize> Route<E, N, M> for Assembled<'_, '_, '_, E, N, M>
where
    E: ExactEdge<f64, N, M>,
{
    fn pass(
        &mut self,
        iterate: &mut Iterate,
        at: Evaluation,
        residuals: &mut Vec<f64>,
        until: Until,
    ) -> Result<Pass, SolveError> {
        self.precisely = at.precisely;
        let soft = self.first;
        self.first = false;
        let order = self.order.clone();
        let edges = ContactEdges { d: self.system.d, order: &order };
        let mut body = Full { route: self, iterate, at, d: Vec::new(), energy: 0.0, softness: 0.0 };
        newton::minimise(&edges, &mut body, soft, residuals, until)?;
        Ok(Pass { energy: body.energy, softness: body.softness })
    }
}

/// Newton's unknown u.
struct Full<'r, 'i, 'a, 'd, 'p, E, const N: usize, const M: usize> {
    route: &'r mut Assembled<'a, 'd, 'p, E, N, M>,
    iterate: &'i mut Iterate,
    at: Evaluation,
    /// The step.
    d: Vec<f64>,
    /// The largest energy of the steps of this pass, and the largest square of one beside its energy.
    energy: f64,
    softness: f64,
}

impl<E, const N: usize, const M: usize> Full<'_, '_, '_, '_, '_, E, N, M>
where
    E: ExactEdge<f64, N, M>,
{
    /// The residual of (8).
    fn gradient(&self, at: &Derivatives<M>) -> Vec<f64> {
        let mut r = self.at.linear.clone();
        for e in 0..self.route.order.len() {
            let g: [f64; M] = block(&at.gradient, e);
            self.route.system.functionals(e, |row, a, entry| r[row] += entry * g[a]);
        }
        r
    }

    /// How much stiffer contact is than the body, by the power method on A^-1 B^T Psi'' B; A is what was factored last.
    fn stiffness(&self, at: &Derivatives<M>) -> Result<f64, SolveError> {
        let Some((factor, _)) = &self.route.factored else { return Ok(SOFTEST) };
        Ok(newton::largest_eigenvalue(self.route.system.numbering.count, |x| {
            let p = self.values_of_p0(x);
            let mut force = vec![0.0; x.len()];
            for (e, h) in at.hessian.iter().enumerate() {
                let values: [f64; M] = block(&p, e);
                self.route.system.functionals(e, |row, a, entry| {
                    force[row] += entry * (0..M).map(|b| h[a][b] * values[b]).sum::<f64>();
                });
            }
            factor.forward(&mut force);
            factor.backward(&mut force);
            force
        }))
    }

    /// B x
    fn values_of_p0(&self, x: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.at.p.len()];
        for e in 0..self.route.order.len() {
            self.route.system.functionals(e, |row, a, entry| values[e * M + a] += entry * x[row]);
        }
        values
    }
}

impl<E, const N: usize, const M: usize> Body<M> for Full<'_, '_, '_, '_, '_, E, N, M>
where
    E: ExactEdge<f64, N, M>,
{
    fn y(&self) -> &[f64] {
        &self.at.p
    }

    fn residual(&self, at: &Derivatives<M>) -> Residual {
        let norm = self.gradient(at).iter().map(|r| r * r).sum::<f64>().sqrt();
        // The rounding of P, through the springs of contact.
        let mut contact = vec![0.0; self.route.system.numbering.count];
        for (e, h) in at.hessian.iter().enumerate() {
            let p: [f64; M] = block(&self.at.p_magnitudes, e);
            self.route.system.functionals(e, |row, a, entry| {
                contact[row] += entry.abs() * (0..M).map(|b| h[a][b].abs() * p[b]).sum::<f64>();
            });
        }
        let contact = contact.iter().map(|c| c * c).sum::<f64>().sqrt();
        let reference = self.route.reference;
        let noise = self.at.noise + f64::EPSILON * contact;
        Residual { norm: norm / reference, noise: noise / reference }
    }

    /// The body without contact, or, where it does not hold without, on springs of all edges, which pull as well as push.
    fn start(&mut self, edges: &impl Edges<M>) -> Result<f64, SolveError> {
        let none = newton::derivatives(edges, &vec![-1.0; self.at.p.len()]);
        if self.route.system.d.slides.is_none() {
            match self.step(&none) {
                Ok(step) => {
                    self.advance(1.0, &step);
                    let at = newton::derivatives(edges, self.y());
                    return self.stiffness(&at);
                }
                Err(SolveError::Singular) => {}
                Err(error) => return Err(error),
            }
        }
        let all = newton::derivatives(edges, &vec![1.0; self.at.p.len()]);
        let mut pulling = all.times(1.0 / SOFTEST);
        for e in 0..self.route.order.len() {
            let p: [f64; M] = block(&self.at.p, e);
            for a in 0..M {
                pulling.gradient[e * M + a] = (0..M).map(|b| pulling.hessian[e][a][b] * p[b]).sum();
            }
        }
        let step = self.step(&pulling)?;
        self.advance(1.0, &step);
        Ok(SOFTEST)
    }

    fn step(&mut self, at: &Derivatives<M>) -> Result<Step, SolveError> {
        let gradient = self.gradient(at);
        let mut d: Vec<f64> = gradient.iter().map(|r| -r).collect();
        let factor = self.route.factor(at)?;
        factor.forward(&mut d);
        factor.backward(&mut d);
        let dy = self.values_of_p0(&d);
        let slope = gradient.iter().zip(&d).map(|(r, d)| r * d).sum();
        let ad = self.route.system.times_matrix(&d);
        let curvature = ad.iter().zip(&d).map(|(a, d)| a * d).sum();
        self.d = d;
        Ok(Step { dy, slope, curvature })
    }

    fn advance(&mut self, t: f64, step: &Step) {
        self.iterate.add(self.route.system, t, &self.d);
        self.at = self.iterate.evaluate(self.route.system, self.route.precisely);
        self.energy = self.energy.max(-t * t * step.slope);
        if step.slope < 0.0 {
            let square: f64 = self.d.iter().map(|d| d * d).sum();
            self.softness = self.softness.max(square / -step.slope);
        }
    }
}

/// How much softer than contact the springs are that hold a body at the start which nothing else holds: about as soft as
/// the body.
const SOFTEST: f64 = 1e3;

/// The share of the springs of all edges that is added to a tangent which has no factor: the edges that are in contact at an
/// iterate need not hold the body that those of the solution hold. The step goes downhill all the same.
const SUPPORT: f64 = 1e-6;
