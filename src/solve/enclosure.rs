//! How far the computed displacement u~ is from the exact solution u^h of (8), whatever Newton's method, the factorisation and
//! rounding did: an enclosure of u^h and of what is reported of it. docs/theory.md, 7.5, has the proofs.
//!
//! The problem (8) that is meant has these data: the vertices, the Lame coefficients as they act in the plane, gamma on each
//! contact edge, the gap at the nodes, the prescribed components, the directions of contact where they are not the normal, the
//! points of a Gauss rule, and for the loads the forces that the quadrature has at its points, weight times value: all of them
//! doubles, taken for the real numbers that they are. Lengths, normals, areas, stresses and integrals are the exact ones.
//!
//! 1. kappa < 1, rounded up: (8) has exactly one solution, and A(v, v) >= (1 - kappa) a(v, v).
//! 2. The residual r of (8) at u~ in [balls](crate::fem::ball), and any z that nearly solves A z = r, as the factor at hand
//!    gives it: |r|_A* <= (z.A z)^{1/2} + |r - A z|_A*, where the last residual is again one in balls, and is turned into a
//!    dual norm by [Korn's inequality](crate::fem::korn) at each node, crudely.
//! 3. (C2): with rho = |r|_A*, |u~ - u^h|_a <= rho (1 - kappa)^{-1/2}, |gamma^{1/2}(lambda~ - lambda^h)| <= rho / 2.

use thiserror::Error;

use super::assembled::{Assembled, Tangent};
use super::balls::{Lines, dot, field, free, kappa, lines, root};
use super::factor::{Factor, Indefinite};
use super::intervals::{Evaluation, Intervals};
use super::pressed::{self, Pressed};
use super::system::System;
use crate::fem::Discretization;
use crate::fem::ball::{Ball, up};
use crate::fem::held::Slides;
use crate::fem::korn::Korn;
use crate::fem::precise;
use crate::fem::twofold::Twofold;
use crate::kernel::edge_integral::ExactEdge;

/// Where u^h is, and what is known of it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Enclosure {
    /// kappa of (11), rounded up.
    pub kappa: f64,
    /// |u~ - u^h|_a at most.
    pub radius: f64,
    /// The same over |u~|_a; `None` for a body without strain.
    pub relative: Option<f64>,
    /// The norm of gamma^{1/2} (lambda~ - lambda^h) on Gamma_C at most.
    pub pressure: f64,
    /// The length of u~ - u^h at each node at most.
    pub nodes: Vec<f64>,
    /// What is reported of u^h.
    pub intervals: Intervals,
}

/// Why nothing is proved.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum Unproved {
    #[error(
        "the body is held by contact alone, and the edges that are surely pressed hardly hold it"
    )]
    HeldByContact,
    #[error("kappa = {kappa} is not below 1: (8) may have several solutions, or none")]
    NotCoercive { kappa: f64 },
    #[error("displacement boundaries hardly hold a part of the body")]
    NotHeld,
    #[error("A has no Cholesky factor in the precision of the solve")]
    NoFactor,
    #[error(
        "kappa is 1 or more when its rounding is counted: it over- or underflows double precision, or is next to 1"
    )]
    NoKappa,
    #[error("the bound over- or underflows double precision")]
    OutOfRange,
    #[error("out of memory")]
    OutOfMemory,
}

impl Unproved {
    /// Whether (8) is known to have exactly one solution all the same.
    pub fn is_unique(&self) -> bool {
        !matches!(self, Unproved::HeldByContact | Unproved::NotCoercive { .. } | Unproved::NoKappa)
    }
}

/// The residual of a correction that is this small a part of the bound needs no further one.
const SMALL: f64 = 1e-2;

/// Corrections of z, at most.
const CORRECTIONS: usize = 12;

/// Which factor of A nearly solves A z = r. Nothing depends on its being right.
pub enum FactorOfA {
    /// One that is there.
    AtHand(Factor),
    /// One to be made in doubles.
    Double,
    /// One to be made in twofold numbers, for bodies that need them.
    Twofold,
}

impl FactorOfA {
    fn of<E, const N: usize, const M: usize>(
        self,
        system: &System<E, N, M>,
        pressed: &Pressed<M>,
    ) -> Result<Tangent, Unproved>
    where
        E: ExactEdge<f64, N, M>,
    {
        let assembled = match self {
            FactorOfA::AtHand(factor) => return Ok(Tangent::Double(factor)),
            FactorOfA::Double => Assembled::new(system, 1.0),
            FactorOfA::Twofold => Assembled::twofold(system, 1.0),
        };
        match assembled.factor_where(pressed.edges()) {
            Ok(factor) => factor.map_err(|Indefinite| Unproved::NoFactor),
            Err(_) => Err(Unproved::OutOfMemory),
        }
    }
}

/// Encloses the solution of (8) around `u` by the residual there, or at a field `near` it that is known in twofold numbers:
/// rounding a displacement to doubles moves it little, its forces more. Of a body that may slide, with these motions still stopped at
/// one component each, one of the solutions is enclosed around the displacement of least norm.
///
/// # Errors
/// Why nothing can be proved.
pub fn enclose<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    u: &[[f64; 2]],
    near: Option<&[[Twofold; 2]]>,
    factor: FactorOfA,
) -> Result<Enclosure, Unproved>
where
    E: ExactEdge<f64, N, M>,
{
    enclose_with(system, u, near, factor, &system.d.enclosed_load)
}

/// The same for a given load: L(v) for every basis function.
///
/// # Errors
/// As [`enclose`].
pub fn enclose_with<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    u: &[[f64; 2]],
    near: Option<&[[Twofold; 2]]>,
    factor: FactorOfA,
    load: &[[Ball; 2]],
) -> Result<Enclosure, Unproved>
where
    E: ExactEdge<f64, N, M>,
{
    let d = system.d;
    let slides = Slides::around(d, u);
    let mut reported = u.to_vec();
    slides.iter().for_each(|slides| slides.least_norm(&mut reported));
    let stopped = d.slides.as_ref().map_or(0, Slides::count);
    let ends = |slides: &Slides| slides.count() > stopped || slides.are_bounded();
    let Some(loose) = slides.filter(ends) else {
        return around(system, u, &reported, near, factor, load);
    };
    // Motions that only edges stop which do not press: of all solutions one that is away from these.
    let Some(inside) = loose.to_inside(u) else { return Err(Unproved::HeldByContact) };
    let mut u = u.to_vec();
    loose.move_by(&inside, &mut u);
    let d = d.sliding(loose, &u);
    let system = System::new(&d).map_err(|_| Unproved::OutOfMemory)?;
    let factor = match factor {
        FactorOfA::Twofold => FactorOfA::Twofold,
        _ => FactorOfA::Double,
    };
    around(&system, &u, &reported, None, factor, load)
}

/// Encloses a solution around `u`, and what `reported` is, which differs from `u` by motions that slide.
fn around<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    u: &[[f64; 2]],
    reported: &[[f64; 2]],
    near: Option<&[[Twofold; 2]]>,
    factor: FactorOfA,
    load: &[[Ball; 2]],
) -> Result<Enclosure, Unproved>
where
    E: ExactEdge<f64, N, M>,
{
    let d = system.d;
    let lines = lines(d);
    let kappa = kappa(d, &lines);
    if !(kappa < 1.0) {
        let unknown = d.kappa() < 1.0 || !kappa.is_finite();
        return Err(if unknown { Unproved::NoKappa } else { Unproved::NotCoercive { kappa } });
    }
    let coercivity = (1.0 - kappa) * (1.0 - 4.0 * f64::EPSILON);
    let at = Evaluation::new(system, &lines, (u, reported), near, load);
    let at = at.ok_or(Unproved::OutOfRange)?;
    // What holds the body, and what is not proved if that does not.
    let (pressed, loose) = match d.slides {
        None => (Pressed::nowhere(lines.len()), Unproved::NotHeld),
        Some(_) => (Pressed::at(d, &lines, &at.u), Unproved::HeldByContact),
    };
    let holds = pressed.holds(d, &lines);
    let korn = Korn::new(&d.space, &d.problem.material, &d.constraints, &holds);
    let korn = korn.ok_or(loose)?;
    let r = free(system, &at.residual);
    let crude = crude_norms(system, &korn, coercivity);
    let rho = if r.iter().all(|&r| r == Ball::from(0)) {
        0.0
    } else {
        let negligible = SMALL * at.moved * coercivity.sqrt();
        dual_norm(system, &lines, &pressed, &factor.of(system, &pressed)?, &r, &crude, negligible)
    };
    if !pressed.stay(rho) {
        return Err(Unproved::HeldByContact);
    }
    let exact = up(rho / coercivity.sqrt());
    let radius = up(exact + at.moved);
    if !radius.is_finite() {
        return Err(Unproved::OutOfRange);
    }
    let size = at.energy.upper().max(0.0).sqrt();
    let mut nodes: Vec<f64> = korn.nodes.iter().map(|n| up(n * exact)).collect();
    if !stays_off(d, &lines, &pressed, &at.u, (&nodes, exact)) {
        return Err(Unproved::HeldByContact);
    }
    let exactly = slid(at.u.clone(), reported, d.slides.as_ref());
    for (node, (exactly, reported)) in nodes.iter_mut().zip(exactly.iter().zip(reported)) {
        let off = [0, 1].map(|c| exactly[c] - Ball::from(reported[c]));
        *node = up(*node + root(dot(off, off)));
    }
    let pressure = if holds.is_empty() { rho / 2.0 } else { rho };
    let intervals = at.intervals(d, &lines, (&exactly, &nodes), [rho, pressure], exact);
    if !intervals.are_finite() {
        return Err(Unproved::OutOfRange);
    }
    Ok(Enclosure {
        kappa,
        radius,
        relative: (size > 0.0).then(|| radius / size),
        pressure,
        nodes,
        intervals,
    })
}

/// u moved along the motions that slide, to where `reported` is.
fn slid(mut u: Vec<[Ball; 2]>, reported: &[[f64; 2]], slides: Option<&Slides>) -> Vec<[Ball; 2]> {
    for slide in slides.map_or(&[][..], |slides| &slides.basis) {
        let off = u.iter().zip(reported).zip(slide);
        let weight: f64 =
            off.map(|((u, r), s)| (0..2).map(|c| (r[c] - u[c].head()) * s[c]).sum::<f64>()).sum();
        for (u, s) in u.iter_mut().zip(slide) {
            *u = [0, 1].map(|c| u[c] + Ball::from(weight) * Ball::from(s[c]));
        }
    }
    u
}

/// Whether the edges that are not pressed and could end a motion that slides have P <= 0 for all fields that differ from u by as
/// much as `nodes` say, and by `radius` in the norm of A_S: then the motion changes nothing.
fn stays_off<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    lines: &Lines<N, M>,
    pressed: &Pressed<M>,
    u: &[[Ball; 2]],
    (nodes, radius): (&[f64], f64),
) -> bool
where
    E: ExactEdge<f64, N, M>,
{
    if d.slides.as_ref().is_none_or(|slides| !slides.are_bounded()) {
        return true;
    }
    let edges = d.contact.iter().zip(lines).zip(pressed.edges());
    edges.filter(|(_, pressed)| !pressed).all(|((edge, line), _)| {
        let far =
            d.space.edge_nodes(edge.edge).map(|node| nodes[node]).into_iter().fold(0.0, f64::max);
        pressed::greatest(line.p(edge, u)) + pressed::change(line, far, radius) <= 0.0
    })
}

/// A(v, .), and what the springs where it is `pressed` do, at the free unknowns for the field with the components `z`.
pub(super) fn times_matrix<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    lines: &Lines<N, M>,
    pressed: &Pressed<M>,
    z: &[Ball],
) -> Vec<Ball>
where
    E: ExactEdge<f64, N, M>,
{
    let v = field(system, |number, _, _| z[number], |_, _| 0.0);
    let mut forces = vec![[Ball::from(0); 2]; v.len()];
    precise::add_internal_forces(system.d, &v, &mut forces);
    for line in lines {
        line.add_stresses(&v, &mut forces);
    }
    pressed.add_springs(lines, &v, &mut forces);
    free(system, &forces)
}

/// |t|_A* <= sum of these times |t_i|: k_i (1 - kappa)^{-1/2} with the factor k_i of the node of unknown i.
fn crude_norms<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    korn: &Korn,
    coercivity: f64,
) -> Vec<f64>
where
    E: ExactEdge<f64, N, M>,
{
    let mut crude = vec![0.0; system.numbering.count];
    for (numbers, factor) in system.numbering.of.iter().zip(&korn.nodes) {
        for number in numbers.iter().flatten() {
            crude[*number] = up(factor / coercivity.sqrt());
        }
    }
    crude
}

/// |r|_A* at most, where |t|_A* <= sum of `crude`_i |t_i| for every t. What is `negligible` need not be known better.
fn dual_norm<E, const N: usize, const M: usize>(
    system: &System<E, N, M>,
    lines: &Lines<N, M>,
    pressed: &Pressed<M>,
    factor: &Tangent,
    r: &[Ball],
    crude: &[f64],
    negligible: f64,
) -> f64
where
    E: ExactEdge<f64, N, M>,
{
    let mut z = vec![Ball::from(0); r.len()];
    let mut left = r.to_vec();
    let mut best = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let mut correction: Vec<f64> = left.iter().map(|t| t.head()).collect();
        factor.solve(&mut correction);
        for (z, c) in z.iter_mut().zip(&correction) {
            *z = (*z + Ball::from(*c)).centre();
        }
        let az = times_matrix(system, lines, pressed, &z);
        let square = z.iter().zip(&az).fold(Ball::from(0), |sum, (&z, &az)| sum + z * az);
        let energy = root(square);
        left = r.iter().zip(&az).map(|(&r, &az)| r - az).collect();
        let rest = weighted(&left, crude);
        let bound = up(energy + rest);
        if !(rest > (SMALL * energy).max(negligible)) {
            return bound.min(best);
        }
        let stuck = !(bound < best / 2.0);
        best = bound.min(best);
        if stuck {
            break;
        }
    }
    best
}

/// The sum of the magnitudes, each times its weight, at most.
fn weighted(v: &[Ball], weights: &[f64]) -> f64 {
    let sum: f64 = v.iter().zip(weights).map(|(v, weight)| v.magnitude() * weight).sum();
    // As many roundings as terms; a product may underflow.
    let underflown = f64::MIN_POSITIVE * v.len() as f64;
    sum * (1.0 + f64::EPSILON * (v.len() + 16) as f64) + underflown
}

/// An enclosure, or why there is none.
pub type Certificate = Result<Enclosure, Unproved>;
