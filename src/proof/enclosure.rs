//! The enclosure: bounds of the distance between the computed displacement u~ and the exact solution u^h of (8), and of all
//! quantities that are reported, whatever Newton's method, the factorisation and rounding did. docs/a-posteriori.md, 7.5, has
//! the proofs.
//!
//! The problem (8) that is meant has these data: the vertices, the Lame coefficients as they act in the plane, gamma on each
//! contact edge, the gap at the nodes, the prescribed components, the directions of contact where they are not the normal, the
//! points of a Gauss rule, and for the loads the forces that the quadrature has at its points, weight times value: all of them
//! doubles, which are real numbers. Lengths, normals, areas, stresses and integrals are the exact ones.
//!
//! 1. kappa < 1, rounded up: (8) has exactly one solution, and A(v, v) >= (1 - kappa) a(v, v).
//! 2. The residual r of (8) at u~, and any z that nearly solves A z = r, as the factor at hand gives it:
//!    |r|_A* <= (z.A z)^{1/2} + |r - A z|_A*, where the last residual is turned into a dual norm by
//!    [Korn's inequality](crate::proof::korn) at each node, crudely. Both residuals are evaluated in
//!    [doubles](crate::proof::rounded_stress) with a bound of their rounding, and where that proves too little in
//!    [balls](crate::kernel::ball).
//! 3. (C2): with rho = |r|_A*, |u~ - u^h|_a <= rho (1 - kappa)^{-1/2}, |gamma^{1/2}(lambda~ - lambda^h)| <= rho / 2.

use std::borrow::Cow;
use std::sync::Arc;
use std::time::Duration;

use nalgebra::DMatrix;
use thiserror::Error;

use super::balls::{Lines, field, free, kappa, length, root};
use super::intervals::{Arithmetic, EnclosedResidual, Intervals};
use super::isolated::{self, Isolated, MOST_ENTRIES, MOST_FUNCTIONALS};
use super::pressed::{self, Pressed};
use crate::contact::Discretization;
use crate::held::solvability::Slides;
use crate::kernel::ball::{PreciseBall, up};
use crate::kernel::{Ball, DoubleDouble};
use crate::linear::factor::Factor;
use crate::linear::system::{Factored, System};
use crate::model::rigid::NEGLIGIBLE;
use crate::proof::korn::Korn;
use crate::solve::SolveError;
use crate::solve::newton::SLIGHT;
use crate::solve::times::Stopwatch;

/// An enclosure of u^h and of its quantities.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Enclosure {
    /// kappa of (11), rounded up.
    pub kappa: f64,
    /// |u~ - u^h|_a at most.
    pub radius: f64,
    /// The radius over |u~|_a; `None` for a body that hardly strains.
    pub relative: Option<f64>,
    /// The strains are surely below 1e-10 of the displacement over the size of the body: what there is of them is rounding.
    pub hardly_strains: bool,
    /// The energy norm of the body if it strained by its displacement over its size, or by 1 where that is less.
    pub(crate) if_strained: f64,
    /// The norm of gamma^{1/2} (lambda~ - lambda^h) on Gamma_C at most.
    pub pressure: f64,
    /// The length of u~ - u^h at each node at most.
    pub nodes: Vec<f64>,
    /// Intervals of the reported quantities.
    pub intervals: Intervals,
    /// With Coulomb's friction: near which there is no other solution; without it there is exactly one anywhere.
    pub isolation: Option<Isolation>,
}

/// The distance within which the discrete equations with Coulomb's friction have exactly one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Isolation {
    /// There is exactly one whose difference from the displacement has no larger energy norm; `None` if that is known in another norm
    /// only, that of 13.6 with springs, as where friction alone holds the body.
    pub within: Option<f64>,
    /// That over |u~|_a; `None` for a body without strain, too.
    pub relative: Option<f64>,
    /// There is no other anywhere.
    pub everywhere: bool,
    /// Two lower bounds of the coefficient below which there is exactly one for all loads, by 13.3 and by 13.3a; 0 where none is known.
    pub limits: [f64; 2],
}

/// Reasons why nothing is proved.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum Unproved {
    #[error(
        "the body is held by contact alone, and the edges that are surely pressed hardly hold it"
    )]
    HeldByContact,
    #[error("Newton's method did not end")]
    NotReached,
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
    #[error(
        "Coulomb's friction: no distance is proved within which this solution is the only one; where a stretch is just at the limit of sliding or of pressing there need not be one"
    )]
    NotIsolated,
    #[error(
        "Coulomb's friction: the proof is for up to {MOST_FUNCTIONALS} contact functionals, whose product with the number of unknowns is at most {most:e}; there are {count} functionals and {unknowns} unknowns",
        most = MOST_ENTRIES as f64
    )]
    TooManyFunctionals { count: usize, unknowns: usize },
    #[error("the bound over- or underflows double precision")]
    OutOfRange,
    #[error("out of memory")]
    OutOfMemory,
}

impl Unproved {
    /// Returns whether a displacement that is nearer, or better arithmetic, may tell more.
    pub(crate) fn may_be_rounding(&self) -> bool {
        !matches!(
            self,
            Unproved::NotCoercive { .. }
                | Unproved::NoKappa
                | Unproved::NotHeld
                | Unproved::TooManyFunctionals { .. }
        )
    }

    /// Returns whether (8) is known to have exactly one solution all the same.
    pub(crate) fn is_unique(&self) -> bool {
        let by_friction =
            matches!(self, Unproved::NotIsolated | Unproved::TooManyFunctionals { .. });
        let by_contact = matches!(self, Unproved::HeldByContact | Unproved::NotCoercive { .. });
        !(by_friction || by_contact || *self == Unproved::NoKappa)
    }
}

/// The share of the radius that is asked for at which a bound is not sharpened: a further one takes a solve with the factor.
const ENOUGH: f64 = 0.1;

/// Where not all of S stays pressed on the ball of the bound, what would on one that is so many times larger is taken: less holds the
/// body less, and the bound grows.
const LESS_PRESSED: f64 = 2.0;

/// The energy norm below which a body is at rest. [`solve`](crate::solve::solve) refuses energies below 1e-270, and a slender
/// body may have as little as this.
pub(crate) const LEAST_NORM: f64 = 1e-150;

/// Encloses the solution of (8) around the displacement `u`, in balls throughout: as [`Verifier::enclose`]. A tangent with its factor
/// that is `at_hand` saves a factorisation, and need not be right.
///
/// # Errors
/// Why nothing can be proved.
pub fn enclose(
    system: &System,
    u: &[[f64; 2]],
    near: Option<&[[DoubleDouble; 2]]>,
    at_hand: Option<Factored>,
) -> Result<Enclosure, Unproved> {
    Verifier::new(system, at_hand).enclose(u, near, Arithmetic::Balls)
}

/// Encloses the solution of (8) around several displacements; work that does not depend on them is done once.
pub struct Verifier<'s, 'd, 'p> {
    system: &'s System<'d, 'p>,
    load: &'s [[PreciseBall; 2]],
    lines: Lines<'d>,
    kappa: f64,
    /// The relative radius that is asked for: a bound that is far below is not sharpened.
    proof: f64,
    /// A tangent with its factor, if one is at hand.
    at_hand: Option<Factored>,
    /// For what is pressed: the bounds at the nodes, and the factor, once it is needed.
    held: Option<HeldByContact>,
    /// Bounds of A for the proof with Coulomb's friction.
    known: Option<Arc<isolated::Known>>,
    /// The sum of the magnitudes of the residual where it was last evaluated.
    pub(crate) unbalanced: f64,
    /// The residual where it was last evaluated, rounded to doubles at last; empty if that was in other unknowns.
    pub(crate) residual: Vec<f64>,
    /// The time that it has taken.
    pub(crate) time: Duration,
}

/// The data of pressed edges with these springs.
struct HeldByContact {
    springs: Vec<DMatrix<f64>>,
    korn: Option<Korn>,
    factor: Option<Arc<Factor>>,
}

/// The factor with these springs: the one that is there, or a new one, to which the one `at_hand` is near.
fn factored<'f>(
    factor: &'f mut Option<Arc<Factor>>,
    system: &System,
    at_hand: &Option<Factored>,
    springs: &[DMatrix<f64>],
) -> Result<&'f mut Arc<Factor>, Unproved> {
    match factor {
        Some(factor) => Ok(factor),
        None => {
            let factored = system.factor(at_hand.clone(), springs.to_vec());
            Ok(factor.insert(factored.map(|it| it.factor).map_err(|error| match error {
                SolveError::NotPositiveDefinite => Unproved::NoFactor,
                _ => Unproved::OutOfMemory,
            })?))
        }
    }
}

impl<'s, 'd, 'p> Verifier<'s, 'd, 'p> {
    /// The verifier of a system, with its own loads.
    pub fn new(system: &'s System<'d, 'p>, at_hand: Option<Factored>) -> Self {
        Verifier::with_load(system, at_hand, &system.d.enclosed_load)
    }

    /// The verifier of a system with a given load: L(v) for every basis function.
    pub fn with_load(
        system: &'s System<'d, 'p>,
        at_hand: Option<Factored>,
        load: &'s [[PreciseBall; 2]],
    ) -> Self {
        let mut watch = Stopwatch::start();
        let lines = Lines::new(system.d);
        let kappa = kappa(system.d);
        let time = watch.lap();
        let proof = 0.0;
        Verifier {
            system,
            load,
            lines,
            kappa,
            proof,
            at_hand,
            held: None,
            known: None,
            unbalanced: f64::INFINITY,
            residual: Vec::new(),
            time,
        }
    }

    /// A radius of a tenth of `proof`, relative, need not be smaller.
    #[must_use]
    pub(crate) fn for_proof(self, proof: f64) -> Self {
        Verifier { proof, ..self }
    }

    /// Takes the tangent that a route has factored, if it has.
    pub(crate) fn use_factor(&mut self, factored: Option<Factored>) {
        self.at_hand = factored.or(self.at_hand.take());
    }

    /// Encloses the solution around `u` by the residual there, or at a field `near` it that is known in double-doubles:
    /// rounding a displacement to doubles moves it little, its forces more. Of a body that may slide, with these motions
    /// still stopped at one component each, one of the solutions is enclosed around the displacement of least norm.
    ///
    /// # Errors
    /// Why nothing can be proved.
    pub fn enclose(
        &mut self,
        u: &[[f64; 2]],
        near: Option<&[[DoubleDouble; 2]]>,
        arithmetic: Arithmetic,
    ) -> Result<Enclosure, Unproved> {
        let mut watch = Stopwatch::start();
        self.residual.clear();
        let enclosure = self.enclosed(u, near, arithmetic);
        self.time += watch.lap();
        enclosure
    }

    fn enclosed(
        &mut self,
        u: &[[f64; 2]],
        near: Option<&[[DoubleDouble; 2]]>,
        arithmetic: Arithmetic,
    ) -> Result<Enclosure, Unproved> {
        let d = self.system.d;
        if d.slides.is_none() {
            return self.around(u, u, near, arithmetic);
        }
        let known = near.map(|near| self.system.fine_p(near));
        let Some(loose) = Slides::around(d, u, known.as_deref()) else {
            return self.around(u, u, near, arithmetic);
        };
        let mut reported = u.to_vec();
        loose.least_norm(&mut reported);
        let stopped = d.slides.as_ref().map_or(0, |slides| slides.basis.len());
        if loose.basis.len() <= stopped && loose.stopping.is_empty() {
            return self.around(u, &reported, near, arithmetic);
        }
        // Of all solutions take one that is away from edges that do not press but stop motions.
        let Some(inside) = loose.to_inside(u) else { return Err(Unproved::HeldByContact) };
        let mut u = u.to_vec();
        loose.move_by(&inside, &mut u);
        let d = d.sliding(loose, &u);
        let system = System::new(&d).map_err(|_| Unproved::OutOfMemory)?;
        let mut other = Verifier::with_load(&system, None, self.load).for_proof(self.proof);
        let enclosure = other.around(&u, &reported, None, arithmetic);
        self.unbalanced = other.unbalanced;
        enclosure
    }

    /// Encloses a solution around `u`, and what `reported` is, which differs from `u` by motions that slide.
    fn around(
        &mut self,
        u: &[[f64; 2]],
        reported: &[[f64; 2]],
        near: Option<&[[DoubleDouble; 2]]>,
        arithmetic: Arithmetic,
    ) -> Result<Enclosure, Unproved> {
        let (system, d, kappa) = (self.system, self.system.d, self.kappa);
        if !(kappa < 1.0) {
            let unknown = d.kappa() < 1.0 || !kappa.is_finite();
            return Err(if unknown { Unproved::NoKappa } else { Unproved::NotCoercive { kappa } });
        }
        let at = EnclosedResidual::new(
            system,
            &self.lines,
            (u, reported),
            near,
            (self.load, arithmetic),
        );
        let at = at.ok_or(Unproved::OutOfRange)?;
        let r = free(system, &at.residual);
        self.unbalanced = r.iter().map(|r| r.magnitude()).sum();
        self.residual = r.iter().map(|r| r.head()).collect();
        let fields = (u, reported);
        let coulomb = at.for_middles.as_ref();
        let r = coulomb.map_or(r, |for_middles| free(system, for_middles));
        let by_a = match d.slides {
            None => {
                let nowhere = Pressed::nowhere(d.contact.len());
                self.held_by(&nowhere, &at, fields, (&r, arithmetic))
            }
            Some(_) => Err(Unproved::HeldByContact),
        };
        // Of a slender body that lies on its obstacle A alone has no factor in doubles, or has one by luck.
        let is_enough = match &by_a {
            Ok(enclosure) => {
                enclosure.is_within(self.proof) || (self.proof == 0.0 && coulomb.is_none())
            }
            Err(Unproved::NotIsolated | Unproved::NoFactor | Unproved::HeldByContact) => false,
            Err(_) => true,
        };
        if is_enough {
            return by_a;
        }
        let pressed = Pressed::at(d, &self.lines, &at.u, 0.0);
        if pressed.is_nowhere() {
            return by_a;
        }
        let found = self.held_by(&pressed, &at, fields, (&r, arithmetic));
        if radius(&found) < radius(&by_a) || d.slides.is_some() { found } else { by_a }
    }

    /// |v|_A^2 is at least this times |v|_a^2.
    fn coercivity(&self) -> f64 {
        (1.0 - self.kappa) * (1.0 - 4.0 * f64::EPSILON)
    }

    /// Encloses a solution by its evaluation at `u` and the residual there, where contact holds the body by what is `pressed`.
    fn held_by(
        &mut self,
        pressed: &Pressed,
        at: &EnclosedResidual,
        (u, reported): (&[[f64; 2]], &[[f64; 2]]),
        (r, arithmetic): (&[PreciseBall], Arithmetic),
    ) -> Result<Enclosure, Unproved> {
        let (system, d, kappa) = (self.system, self.system.d, self.kappa);
        let coercivity = self.coercivity();
        let springs = pressed.springs(&self.lines);
        if self.held.as_ref().is_none_or(|held| held.springs != springs) {
            let holds = pressed.holds(d, &self.lines);
            let korn = Korn::new(&d.space, &d.problem.material, &d.constraints, &holds);
            self.held = Some(HeldByContact { springs, korn, factor: None });
        }
        let Some(HeldByContact { korn: Some(korn), factor, springs }) = &mut self.held else {
            return Err(d.slides.as_ref().map_or(Unproved::NotHeld, |_| Unproved::HeldByContact));
        };
        let crude = crude_norms(system, korn, coercivity);
        let up_to = up(at.off / coercivity.sqrt());
        let norm = at.energy.lower().max(0.0).sqrt() * (1.0 - 2.0 * f64::EPSILON);
        let if_strained = system.norm_if_strained(u);
        let size = if norm > NEGLIGIBLE * if_strained { norm } else { if_strained };
        let known = (at.moved.max(self.proof * size) * coercivity.sqrt()).max(up_to);
        let negligible = ENOUGH * known;
        let first = weighted(r, &crude);
        let coulomb = d.has_coulomb();
        let mut dual = Dual { norm: first, z: Vec::new(), left: first };
        if !(first <= negligible) || coulomb {
            let factor = factored(factor, system, &self.at_hand, springs)?;
            let lines = &self.lines;
            let product = Product { system, lines, pressed, arithmetic };
            // With Coulomb's friction every further digit of the norm widens the ball without another solution.
            let negligible = if coulomb { 0.0 } else { negligible };
            dual = dual_norm(&product, factor, r, &crude, coercivity, negligible);
        }
        let rho = up(dual.norm + up_to);
        if !coulomb && !pressed.stay(rho) {
            let fewer = Pressed::at(d, &self.lines, &at.u, LESS_PRESSED * rho);
            return self.held_by(&fewer, at, (u, reported), (r, arithmetic));
        }
        let mut isolated = None;
        if let (true, Some(factor)) = (coulomb, factor) {
            let lines = &self.lines;
            let body = isolated::Body { system, factor, pressed, crude: &crude };
            let (left, spread) = (up(dual.left + up_to), at.spread());
            let rest = isolated::Rest { rho, z: &dual.z, left, spread: &spread, size };
            let springs = (!pressed.is_nowhere()).then_some(springs.as_slice());
            let known = &mut self.known;
            let mut isolate = |share| {
                let new = |kept| isolated::Known::new(&body, lines, springs, share, kept);
                let known = match (springs, &mut *known) {
                    (Some(_), without) => (new(None)?, without.as_deref()),
                    (None, Some(known)) if known.share <= share => (known.clone(), None),
                    (None, known) => {
                        let new = new(system.course.kept())?;
                        system.course.keep(&new);
                        (known.insert(new).clone(), None)
                    }
                };
                isolated::isolate((&known.0, known.1), lines, &at.u, system, &rest)
            };
            let [share, least] = isolated::SHARES;
            isolated = Some(match isolate(share) {
                Err(Unproved::NotIsolated) => isolate(least)?,
                found => found?,
            });
        }
        let found = Found {
            rho,
            isolated,
            norm,
            if_strained,
            kappa,
            coercivity,
            is_pressed: pressed.edges().any(|is| is),
        };
        found.enclosure(system, &self.lines, (at, reported), korn)
    }
}

/// A solution in the norm of A: how near it is, and what its enclosure is judged by.
struct Found {
    /// The radius of the ball that holds the solution, where there is no Coulomb's friction.
    rho: f64,
    /// The ball that holds one solution alone, with Coulomb's friction.
    isolated: Option<Isolated>,
    norm: f64,
    if_strained: f64,
    kappa: f64,
    coercivity: f64,
    /// Something of Gamma_C is pressed.
    is_pressed: bool,
}

impl Found {
    /// The bounds at the nodes and of all quantities, and whether they are finite and the rest of Gamma_C stays open.
    fn enclosure(
        self,
        system: &System,
        lines: &Lines,
        (at, reported): (&EnclosedResidual, &[[f64; 2]]),
        korn: &Korn,
    ) -> Result<Enclosure, Unproved> {
        let Found { isolated, norm, if_strained, .. } = self;
        let d = system.d;
        let rho = isolated.map_or(self.rho, |isolated| isolated.rho);
        let exact = up(rho / self.coercivity.sqrt());
        let radius = up(exact + at.moved);
        if !radius.is_finite() {
            return Err(Unproved::OutOfRange);
        }
        let mut nodes: Vec<f64> = korn.nodes.iter().map(|n| up(n * exact)).collect();
        if !stays_off(d, lines, &at.u, (&nodes, exact)) {
            return Err(Unproved::HeldByContact);
        }
        let exactly = match &d.slides {
            Some(slides) => Cow::Owned(slid(at.u.clone(), reported, slides)),
            None => Cow::Borrowed(&at.u),
        };
        widen(&mut nodes, &exactly, reported);
        let pressure = match isolated {
            Some(isolated) => isolated.pressure,
            None if self.is_pressed => rho,
            None => rho / 2.0,
        };
        let intervals = at.intervals(d, lines, (&exactly, &nodes), [rho, pressure], exact);
        if !intervals.are_finite() {
            return Err(Unproved::OutOfRange);
        }
        let hardly_strains = up(root(at.energy) + radius) <= NEGLIGIBLE * if_strained;
        let is_measured = !hardly_strains && norm > 0.0;
        let isolation = isolated.map(|isolated| isolation(isolated, at, radius, is_measured));
        let relative = is_measured.then(|| up(radius / norm));
        Ok(Enclosure {
            kappa: self.kappa,
            radius,
            relative,
            hardly_strains,
            if_strained,
            pressure,
            nodes,
            intervals,
            isolation,
        })
    }
}

/// The radius of an enclosure, infinite where there is none.
fn radius(of: &Result<Enclosure, Unproved>) -> f64 {
    of.as_ref().map_or(f64::INFINITY, |of| of.radius)
}

/// Adds to each bound at a node what `exactly` and the reported displacement are apart.
fn widen(nodes: &mut [f64], exactly: &[[PreciseBall; 2]], reported: &[[f64; 2]]) {
    for (node, (exactly, reported)) in nodes.iter_mut().zip(exactly.iter().zip(reported)) {
        let off = [0, 1].map(|c| exactly[c] - PreciseBall::from(reported[c]));
        *node = up(*node + length(off));
    }
}

/// Says what is known of other solutions, from where the residual is known carried to the displacement that is reported.
fn isolation(
    Isolated { within, everywhere, limits, .. }: Isolated,
    at: &EnclosedResidual,
    radius: f64,
    is_measured: bool,
) -> Isolation {
    // The distance from the displacement whose residual is known to the one that is reported.
    let within = within.map(|within| (within - at.moved) * (1.0 - f64::EPSILON));
    let within = within.filter(|within| radius <= *within);
    let relative = |within: f64| within / up(root(at.energy)) * (1.0 - f64::EPSILON);
    let relative = within.filter(|_| is_measured).map(relative);
    Isolation { within, relative, everywhere, limits }
}

impl Enclosure {
    /// The radius over |u~|_a or, for a body that hardly strains, over what that would be if it did; infinite where neither is known. A
    /// body at rest has no energy to compare with: a radius of rounding alone is none.
    pub(crate) fn in_parts(&self) -> f64 {
        if self.radius < LEAST_NORM {
            0.0
        } else if self.hardly_strains {
            self.radius / self.if_strained
        } else {
            self.relative.unwrap_or(f64::INFINITY)
        }
    }

    /// Returns whether the radius is at most this part.
    pub(crate) fn is_within(&self, proof: f64) -> bool {
        self.in_parts() <= proof
    }
}

/// u moved along the sliding motions, as near to `reported` as they go.
fn slid(
    mut u: Vec<[PreciseBall; 2]>,
    reported: &[[f64; 2]],
    slides: &Slides,
) -> Vec<[PreciseBall; 2]> {
    for slide in &slides.basis {
        let off = u.iter().zip(reported).zip(slide);
        let weight: f64 =
            off.map(|((u, r), s)| (0..2).map(|c| (r[c] - u[c].head()) * s[c]).sum::<f64>()).sum();
        for (u, s) in u.iter_mut().zip(slide) {
            *u = [0, 1].map(|c| u[c] + PreciseBall::from(weight) * PreciseBall::from(s[c]));
        }
    }
    u
}

/// Returns whether the edges that could stop a motion that slides have P <= 0 for all fields that differ from u by as much as
/// `nodes` say, and by `radius` in the norm of A_S: then the motion changes nothing.
fn stays_off(
    d: &Discretization,
    lines: &Lines,
    u: &[[PreciseBall; 2]],
    (nodes, radius): (&[f64], f64),
) -> bool {
    let stopping = d.slides.as_ref().map_or(&[][..], |slides| &slides.stopping);
    stopping.iter().map(|&e| &lines[e]).all(|line| {
        let far = line.farthest(|node| nodes[node]);
        pressed::greatest(line.degree, line.along(&line.p(u))) + pressed::change(line, far, radius)
            <= 0.0
    })
}

/// A, with the springs of the pieces that are `pressed`.
struct Product<'a, 'd, 'p> {
    system: &'a System<'d, 'p>,
    lines: &'a Lines<'d>,
    pressed: &'a Pressed,
    arithmetic: Arithmetic,
}

impl Product<'_, '_, '_> {
    /// A(v, .) at the free unknowns for the field v with the components `z`, off by a functional r with |r(w)| <= b |w|_a for
    /// the b that comes with it.
    fn times(&self, z: &[PreciseBall]) -> (Vec<PreciseBall>, f64) {
        let v = field(self.system, |number, _, _| z[number], |_, _| 0.0);
        let (mut forces, off) = self.arithmetic.small_forces(self.system.d, &v);
        let off = self.arithmetic.add_stresses(self.system.d, self.lines, &v, (&mut forces, off));
        self.pressed.add_springs(self.lines, &v, &mut forces);
        (free(self.system, &forces), off)
    }
}

/// |t|_A* <= sum of these times |t_i|: k_i (1 - kappa)^{-1/2} with the factor k_i of the node of unknown i.
fn crude_norms(system: &System, korn: &Korn, coercivity: f64) -> Vec<f64> {
    let mut crude = vec![0.0; system.numbering.count];
    for (numbers, factor) in system.numbering.of.iter().zip(&korn.nodes) {
        for number in numbers.iter().flatten() {
            crude[*number] = up(factor / coercivity.sqrt());
        }
    }
    crude
}

/// The share to which a correction must reduce a dual norm, or corrections end: a factor with hardly a digit still takes
/// something off with every correction.
const BETTER: f64 = 0.9;

/// A functional in the dual norm of A.
struct Dual {
    /// Its norm, at most.
    norm: f64,
    /// It is A z, up to a functional of at most this norm.
    z: Vec<PreciseBall>,
    left: f64,
}

/// A bound of |r|_A*, where |t|_A* <= sum of `crude`_i |t_i| for every t, and |v|_a^2 <= |v|_A^2 / `coercivity`. A rest of r whose
/// norm is below `negligible` is not corrected any further.
fn dual_norm(
    a: &Product,
    factor: &Factor,
    r: &[PreciseBall],
    crude: &[f64],
    coercivity: f64,
    negligible: f64,
) -> Dual {
    let mut z = vec![PreciseBall::from(0); r.len()];
    let mut left = Cow::Borrowed(r);
    let mut best = Dual { norm: f64::INFINITY, z: Vec::new(), left: f64::INFINITY };
    loop {
        let mut correction: Vec<f64> = left.iter().map(|t| t.head()).collect();
        factor.solve(&mut correction);
        for (z, c) in z.iter_mut().zip(&correction) {
            *z = PreciseBall::point((*z + PreciseBall::from(*c)).centre());
        }
        let (mut az, off) = a.times(&z);
        let off = up(off / coercivity.sqrt());
        let mut square = Ball::from(0);
        for (az, (&z, &r)) in az.iter_mut().zip(z.iter().zip(r)) {
            square += z.rounded() * az.rounded();
            *az = r - *az;
        }
        // x^2 = z . A z is off q = z . az by off x at most, so x <= off + q^(1/2).
        let energy = up(off + root(square.into()));
        left = Cow::Owned(az);
        let rest = up(weighted(&left, crude) + off);
        let norm = up(energy + rest);
        let (is_known, is_better) =
            (!(rest > (SLIGHT * energy).max(negligible)), norm < BETTER * best.norm);
        if norm < best.norm {
            best = Dual { norm, z: z.clone(), left: rest };
        }
        if is_known || !is_better {
            return best;
        }
    }
}

/// An upper bound of the weighted sum of the magnitudes.
fn weighted(v: &[PreciseBall], weights: &[f64]) -> f64 {
    let sum: f64 = v.iter().zip(weights).map(|(v, weight)| v.magnitude() * weight).sum();
    // As many roundings as terms; a product may underflow.
    let underflown = f64::MIN_POSITIVE * v.len() as f64;
    sum * (1.0 + f64::EPSILON * (v.len() + 16) as f64) + underflown
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::contact::EdgeRule;
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Degree, Diagonal, Problem, Rectangle};

    #[test]
    fn one_solution_is_known_of_where_the_reason_is_about_the_proof_alone() {
        let (kappa, count, unknowns) = (1.5, 3000, 1 << 20);
        for (why, is_unique) in [
            (Unproved::HeldByContact, false),
            (Unproved::NotReached, true),
            (Unproved::NotCoercive { kappa }, false),
            (Unproved::NotHeld, true),
            (Unproved::NoFactor, true),
            (Unproved::NoKappa, false),
            (Unproved::NotIsolated, false),
            (Unproved::TooManyFunctionals { count, unknowns }, false),
            (Unproved::OutOfRange, true),
            (Unproved::OutOfMemory, true),
        ] {
            assert_eq!(why.is_unique(), is_unique, "{why}");
        }
    }

    #[test]
    fn the_only_solution_near_the_reported_one_is_near_the_one_that_is_known_of_too() {
        let mesh = Rectangle { width: 1.0, height: 1.0, nx: 2, ny: 2, diagonal: Diagonal::Right };
        let problem = Problem::of(mesh.mesh().unwrap(), Material::lame(1.0, 1.0, Plane::Strain))
            .with("top", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.0));
        let rule = EdgeRule::Exact;
        let d = Discretization::new(&problem, Degree::One, |c| c.limit() / 2.0, rule).unwrap();
        let (system, lines) = (System::new(&d).unwrap(), Lines::new(&d));
        let nodes = d.space.nodes();
        let zero = vec![[PreciseBall::from(0); 2]; nodes.len()];
        for by in [0.0, 0.25, f64::EPSILON] {
            // Stretched by that: lambda + 2 mu is 3, and so is the square of the energy norm beside that of the stretch.
            let reported: Vec<[f64; 2]> =
                nodes.iter().map(|[_, y]| [0.0, by * (1.0 - y)]).collect();
            let apart = by * 3.0_f64.sqrt();
            let u = vec![[0.0; 2]; nodes.len()];
            let load = (&zero[..], Arithmetic::Balls);
            let at = EnclosedResidual::new(&system, &lines, (&u, &reported), None, load).unwrap();
            let of = |within: f64, radius: f64| {
                let limits = [0.0; 2];
                let within = Some(within);
                let isolated =
                    Isolated { rho: radius, within, everywhere: false, limits, pressure: 0.0 };
                isolation(isolated, &at, radius, false).within
            };
            for within in [1.0, 0.7, 16.0 * f64::EPSILON] {
                // A ball around one that lies in a ball around the other; negative where there is none.
                let found = of(within, f64::NEG_INFINITY).unwrap();
                let most = PreciseBall::from(within) - PreciseBall::from(apart);
                assert!((PreciseBall::from(found) - most).upper() <= f64::EPSILON * apart);
                // The controls: nothing much larger would be true, and none is said to be in a ball that is smaller than its radius.
                let least = (within - apart) - 8.0 * f64::EPSILON * (within + apart);
                assert!(found >= least, "{found:e} {least:e} {:e} {apart:e}", at.moved);
                assert_eq!(of(within, found.abs()).is_some(), found >= 0.0);
                assert_eq!(of(within, 1.01 * found.abs()), None);
            }
        }
    }

    #[test]
    fn a_radius_is_in_parts_of_what_strains_and_one_that_underflows_when_squared_is_none() {
        let intervals = Intervals {
            energy: [0.0; 2],
            max_displacement: [0.0; 2],
            contact: Vec::new(),
            reactions: BTreeMap::new(),
        };
        let of = |radius: f64, hardly_strains: bool, relative: Option<f64>| {
            let enclosure = Enclosure {
                kappa: 0.0,
                radius,
                relative,
                hardly_strains,
                if_strained: 4.0,
                pressure: 0.0,
                nodes: Vec::new(),
                intervals: intervals.clone(),
                isolation: None,
            };
            enclosure.in_parts()
        };
        assert_eq!(of(1.0, true, None), 0.25);
        assert_eq!(of(1.0, false, Some(0.5)), 0.5);
        assert_eq!(of(1.0, false, None), f64::INFINITY);
        assert_eq!(of(0.99e-150, false, None), 0.0);
        assert_eq!(of(1.01e-150, false, None), f64::INFINITY);
    }
}
