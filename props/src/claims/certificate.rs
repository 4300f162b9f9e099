//! Existence and uniqueness of the discrete solution on a given mesh, by certificate: the solver's result u~ is taken for
//! the rational numbers that it is, the residual r of (8) at u~ and the matrices K and A are exact (`discrete`), and A is
//! found positive definite by elimination. Then J_h is strictly convex and coercive on a space of finite dimension: (8) has
//! exactly one solution u^h, and with e = u~ - u^h (docs/theory.md, section 7)
//!
//! ```text
//! A(e, e) + int ([P(u~)]+ - [P(u^h)]+)^2/gamma <= r(e)                        (C0)
//! |e|_a <= |r|_a*/(1 - kappa)                                                (C1)
//! |e|_A <= rho = |r|_A*,  int ([P(u~)]+ - [P(u^h)]+)^2/gamma <= rho^2/4       (C2)
//! ```
//!
//! with |r|_A*^2 = r.A^-1 r, |r|_a*^2 = r.K^-1 r: an enclosure of u^h. Where P has no root inside an edge, or the rule is one
//! of points, u^h itself is rational: Newton's steps in exact arithmetic end at a residual that is exactly zero, and (C0)
//! to (C2) are compared with the error itself. Where an edge is cut, u^h is irrational; one step makes a much better point
//! u', whose own enclosure is so small that |u~ - u'| stands for the error.

use std::sync::Arc;

use num_bigint::BigInt;
use num_rational::BigRational;
use proptest::prelude::*;
use signorini::fem::korn::Korn;
use signorini::fem::matrix::LowerTriangle;
use signorini::fem::{
    Condition, Diagonal, Discretization, Mesh, Obstacle, Problem, Rectangle, SharedFunction, Side,
};
use signorini::kernel::PreciseBall;
use signorini::kernel::{Material, Plane};
use signorini::solve::enclosure::{self, Enclosure, Unproved, Verifier};
use signorini::solve::factor::Factor;
use signorini::solve::intervals::Arithmetic;
use signorini::solve::system::System;
use signorini::solve::{
    ContactQuadrature, Degree, Gamma0, Method, Settings, SolveError, discretize, solve,
    solve_discrete,
};

use super::{answers, honesty, pressed};
use crate::claim::{Check, Outcome, noticed, text};
use crate::discrete::{CUT, Discrete, Nodal, exactly};
use crate::elimination::{Matrix, combined, dot, solve_definite, square};
use crate::numbers::Exact;
use crate::problems::{cells, constant, diagonals, floor, held, mapped, mesh, problem, unloaded};
use crate::proof::sampler::Random;
use crate::verdict::Verdict;
use crate::{draws, ensure, sharpness};

/// The class of solutions with an edge that P cuts at an irrational point.
const IRRATIONAL: &str = "an edge is cut, u^h irrational";

/// The enclosure of u^h around a point.
#[derive(Clone, Copy)]
struct Certificate {
    /// rho^2 = r . A^-1 r
    rho_squared: Exact,
    /// r . K^-1 r
    dual_squared: Exact,
}

/// A field with the residual of (8).
struct Point {
    u: Nodal,
    residual: Vec<Exact>,
}

impl Point {
    fn is_solution(&self) -> bool {
        self.residual.iter().all(|&r| r == Exact::from(0))
    }
}

/// A discrete problem with its matrices.
struct Certifier<'a> {
    problem: Discrete<'a>,
    k: Matrix,
    a: Matrix,
}

impl<'a> Certifier<'a> {
    fn new(d: &'a Discretization<'a>) -> Self {
        let problem = Discrete::new(d);
        let k = problem.stiffness();
        let one = Exact::from(1);
        let a = combined(one, &k, -one, &problem.stresses());
        Certifier { problem, k, a }
    }

    fn point(&self, u: Nodal) -> Point {
        Point { residual: self.problem.residual(&u), u }
    }

    /// The certificate at a point, refused where A is not positive definite.
    fn certify(&self, point: &Point) -> Result<Certificate, &'static str> {
        let r = &point.residual;
        let riesz = solve_definite(&self.a, r).ok_or("A is not positive definite")?;
        let in_a = solve_definite(&self.k, r).ok_or("K is not positive definite")?;
        Ok(Certificate { rho_squared: dot(r, &riesz), dual_squared: dot(r, &in_a) })
    }

    /// u less the tangent's inverse times the residual: the solution, or where it is irrational a point near it.
    fn newton_step(&self, point: &Point) -> Result<Point, &'static str> {
        let step = solve_definite(&self.problem.tangent(&point.u), &point.residual);
        let u = self.problem.less(&point.u, &step.ok_or("the tangent is not positive definite")?);
        if !self.irrational(&u) {
            let next = self.point(u.clone());
            if next.is_solution() {
                return Ok(next);
            }
        }
        Ok(self.point(rounded(u)))
    }

    /// P has a root inside an edge, where the contact integrals have to be cut.
    fn irrational(&self, u: &[[Exact; 2]]) -> bool {
        self.problem.by_pieces() && self.problem.class(u) == CUT
    }

    /// The free components of u - v.
    fn difference(&self, u: &[[Exact; 2]], v: &[[Exact; 2]]) -> Vec<Exact> {
        let (u, v) = (self.problem.free(u), self.problem.free(v));
        u.iter().zip(&v).map(|(&u, &v)| u - v).collect()
    }
}

/// A problem and the method for it, as drawn.
#[derive(Clone, Debug)]
struct Draw {
    cells: [usize; 2],
    diagonal: Diagonal,
    moved: Option<u64>,
    lambda: f64,
    plane: Plane,
    load: [f64; 2],
    /// g0 + g1 x
    gap: [f64; 2],
    /// How far the top is moved down.
    push: f64,
    /// In twentieths.
    kappa: u8,
    /// Only guided at one side and pressed from the top by a traction of 1: contact alone stops it from falling.
    by_contact: bool,
}

/// The gap at x = 0 in sixty-fourths: so wide that there is no contact, so narrow that there is nothing else, or between.
type Gap = std::ops::RangeInclusive<i32>;
const WIDE: Gap = 256..=256;
const NARROW: Gap = -64..=-64;
const BETWEEN: Gap = -4..=8;

/// Problems on up to `most` cells along each side; data in sixty-fourths.
fn problems(most: [usize; 2], gap: Gap) -> impl Strategy<Value = Draw> {
    let mesh = (1..=most[0], 1..=most[1], diagonals(), prop::option::of(0_u64..1000));
    let lambda = prop::sample::select(&[-0.5, 0.0, 1.0, 4.0]);
    let plane = prop::sample::select(&[Plane::Strain, Plane::Stress]);
    let part = |range: Gap| range.prop_map(|k| f64::from(k) / 64.0);
    let load = (part(-64..=64), part(-64..=16));
    let line = (part(gap), part(-16..=16), part(-4..=8));
    (mesh, lambda, plane, load, line, 1_u8..=19).prop_map(
        |(mesh, lambda, plane, load, line, kappa)| Draw {
            cells: [mesh.0, mesh.1],
            diagonal: mesh.2,
            moved: mesh.3,
            lambda,
            plane,
            load: [load.0, load.1],
            gap: [line.0, line.1],
            push: line.2,
            kappa,
            by_contact: false,
        },
    )
}

/// Such problems of bodies that contact alone holds, on floors that are so many times as steep.
fn problems_by_contact(most: [usize; 2], steeper: f64) -> impl Strategy<Value = Draw> {
    problems(most, BETWEEN).prop_map(move |draw| {
        let gap = [draw.gap[0], steeper * draw.gap[1]];
        Draw { gap, by_contact: true, ..draw }
    })
}

impl Draw {
    fn mesh(&self) -> Result<Mesh, String> {
        if let Some(seed) = self.moved {
            return sharpness::moved(self.cells, seed);
        }
        cells(self.cells, self.diagonal).mesh().map_err(text)
    }

    /// Whether the whole problem is turned by a right angle, counter-clockwise: forces of contact are along x then.
    fn is_turned(&self) -> bool {
        self.kappa % 2 == 1
    }

    /// A vector of the problem as it is drawn.
    fn turned<S: Copy + std::ops::Neg<Output = S>>(&self, [x, y]: [S; 2]) -> [S; 2] {
        if self.is_turned() { [-y, x] } else { [x, y] }
    }

    /// A body that is held and pushed down at the top, or pressed there and guided at a side, with a body force and a gap at
    /// the bottom.
    fn problem(&self) -> Result<Problem, String> {
        let ([g0, g1], turned) = (self.gap, self.is_turned());
        let along = move |[x, y]: [f64; 2]| if turned { y } else { x };
        let gap: SharedFunction = Arc::new(move |x: [f64; 2]| g0 + g1 * along(x));
        let floor = ("bottom", Condition::Contact { gap });
        let mesh = mapped(&self.mesh()?, |x| self.turned(x))?;
        let material = Material::lame(self.lambda, 1.0, self.plane);
        let load = self.turned(self.load).map(constant);
        Ok(if self.by_contact {
            let traction = [0.0; 2].map(constant);
            let guided = self.turned([1, 0]).map(|c| (c != 0).then(|| constant(0.0)));
            let guided = Condition::Mixed { displacement: guided, traction };
            let pressed = Condition::Traction(self.turned([0.0, -1.0]).map(constant));
            problem(mesh, material, load, [floor, ("left", guided), ("top", pressed)])
        } else {
            let pushed = held(self.turned([0.0, -self.push]));
            problem(mesh, material, load, [floor, ("top", pushed)])
        })
    }
}

/// The solver's result, and what it solved.
struct Solved {
    problem: Problem,
    method: Method,
    u: Vec<[f64; 2]>,
}

impl Solved {
    fn new(draw: &Draw, degree: Degree, quadrature: ContactQuadrature) -> Result<Solved, String> {
        let problem = draw.problem()?;
        let kappa = f64::from(draw.kappa) / 20.0;
        let method = sharpness::at_kappa(&problem, degree, kappa)?;
        let method = Method { quadrature, allow_noncoercive: false, ..method };
        let (solution, _) = solve(&problem, &method, &Settings::default()).map_err(text)?;
        Ok(Solved { problem, method, u: solution.displacement })
    }
}

/// 2^-n
fn power(n: i32) -> Exact {
    Exact::of_double(2.0_f64.powi(-n))
}

/// The same field to 2^-200: a refined point need not be known better.
fn rounded(u: Nodal) -> Nodal {
    let scale = BigRational::from_integer(BigInt::from(1) << 200);
    let round = |x: Exact| Exact::new((x.value() * &scale).round() / &scale);
    u.into_iter().map(|v| v.map(round)).collect()
}

/// The inequalities of Theorem 7.1.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Bound {
    /// (C0)
    Monotone,
    /// (C1)
    Energy,
    /// (C2)
    Displacement,
    /// (C2)
    Pressure,
}

/// What is asked of the enclosures around a point, and planted mistakes.
#[derive(Clone, Copy)]
struct Asked {
    /// The solver's result is moved at random by up to this.
    noise: f64,
    /// Radii are at most 2^-share |u~|_a.
    share: i32,
    /// A tenth of the right side of this bound.
    tenth: Option<Bound>,
    /// The radii that are reported are multiplied by this.
    factor: f64,
    /// So is the load that the residual is evaluated with.
    load: f64,
    /// And the matrix whose factor is at hand.
    matrix: f64,
}

/// Around the solver's result.
const RESULT: Asked =
    Asked { noise: 0.0, share: 40, tenth: None, factor: 1.0, load: 1.0, matrix: 1.0 };

/// Around any point: a perturbation raises the radius at least to what it moves u~ by.
const MOVED: Asked = Asked { noise: 1e-3, share: -40, ..RESULT };

/// With the factor of another matrix: the bound is a large one.
const ANOTHER_FACTOR: Asked = Asked { matrix: 1e3, share: -400, ..MOVED };

impl Asked {
    /// The factor of a right side.
    fn factor(self, bound: Bound) -> Exact {
        if self.tenth == Some(bound) { Exact::ratio(1, 10) } else { Exact::from(1) }
    }
}

/// The field moved at random.
fn moved(u: &[[f64; 2]], by: f64) -> Vec<[f64; 2]> {
    let steps = Random::new(1).field(u.len());
    u.iter().zip(steps).map(|(u, d)| [0, 1].map(|c| u[c] + by * d[c] / 2.0)).collect()
}

/// The factor of A times a number.
pub(super) fn factor_of(system: &System, times: f64) -> Result<Factor, SolveError> {
    let LowerTriangle { starts, rows, values } = &system.matrix;
    let values = values.iter().map(|a| times * a).collect();
    Factor::new(&LowerTriangle { starts: starts.clone(), rows: rows.clone(), values })
}

/// The solver's result on a drawn problem, certified in exact arithmetic, with the enclosures of the solver, in balls and in doubles:
/// all contain the exact u^h, or a point whose own radius is a thousand times smaller.
fn enclosed(degree: Degree, draw: &Draw, quadrature: ContactQuadrature, asked: Asked) -> Verdict {
    let Ok(solved) = Solved::new(draw, degree, quadrature) else {
        return Verdict::Fails("the solver has no solution");
    };
    let Ok(d) = discretize(&solved.problem, &solved.method) else {
        return Verdict::Fails("there is no discrete problem");
    };
    // Prescribed components too: the enclosure counts what they are off by.
    let u = moved(&solved.u, asked.noise);
    let reported = match reported(&d, &u, asked, draw) {
        Ok(reported) => reported,
        Err(verdict) => return verdict,
    };
    Certifier::new(&d).compared(exactly(&u), &reported, asked, draw).unwrap_or_else(Verdict::Fails)
}

/// The enclosures of the solver, with the binary digits that their radii have less than |u~|_a. None where vertices are moved: on
/// whole cells lengths and normals are doubles, so that both sides speak of the same problem.
fn reported(
    d: &Discretization<'_>,
    u: &[[f64; 2]],
    asked: Asked,
    draw: &Draw,
) -> Result<Vec<(Enclosure, i32)>, Verdict> {
    if draw.moved.is_some() {
        return Ok(Vec::new());
    }
    let system = System::new(d).map_err(|_| Verdict::Fails("there is a system"))?;
    let load: Vec<[PreciseBall; 2]> =
        d.load.iter().map(|l| l.map(|l| PreciseBall::from(l * asked.load))).collect();
    let factor = (asked.matrix != 1.0).then(|| factor_of(&system, asked.matrix).map(Arc::new));
    let factor = factor.transpose().map_err(|_| Verdict::Fails("there is a factor"))?;
    let mut verifier = Verifier::with_load(&system, factor, &load);
    // Arithmetic in doubles are off by some 1e-13, more where lambda is large.
    let kinds = [(Arithmetic::Balls, asked.share), (Arithmetic::Doubles, asked.share - 10)];
    let one = |(arithmetic, share)| match verifier.enclose(u, None, arithmetic) {
        Ok(enclosure) => Ok((enclosure, share)),
        // No edge may be pressed from end to end.
        Err(Unproved::HeldByContact) if draw.by_contact => Err(Verdict::Vacuous),
        Err(_) => Err(Verdict::Fails("there is an enclosure")),
    };
    kinds.into_iter().map(one).collect()
}

impl Certifier<'_> {
    /// Compares the certificate of u~, and what is reported of it, with u^h, or with a point whose own enclosure is a thousand times
    /// smaller.
    fn compared(
        &self,
        found: Nodal,
        reported: &[(Enclosure, i32)],
        asked: Asked,
        draw: &Draw,
    ) -> Result<Verdict, &'static str> {
        let scale = square(&self.k, &self.problem.free(&found));
        let is_small = |squared: Exact, share: i32| squared <= power(share) * power(share) * scale;
        let radius = |of: &Enclosure| Exact::of_double(of.radius) * Exact::of_double(asked.factor);
        if !reported.iter().all(|(of, share)| is_small(radius(of) * radius(of), *share)) {
            return Err("the radius is at most 2^-share |u~|_a");
        }
        let mut start = found.clone();
        self.problem.prescribe(&mut start);
        let start = self.point(start);
        // Where contact alone holds the body A is not definite: only a rational solution will do.
        let certified = |point: &Point| (!draw.by_contact).then(|| self.certify(point)).transpose();
        let certificate = certified(&start)?;
        if certificate.is_some_and(|of| !is_small(of.rho_squared, asked.share)) {
            return Err("rho <= 2^-share |u~|_a");
        }
        let millionth = Exact::ratio(1, 1_000_000);
        let kept = Exact::from(1) - self.problem.kappa();
        let mut point = Point { u: start.u.clone(), residual: start.residual.clone() };
        for step in 0..=8 {
            let is_solution = point.is_solution();
            let refined = if is_solution { None } else { certified(&point)? };
            let is_better = step > 0
                && certificate.zip(refined).is_some_and(|(of, refined)| {
                    refined.rho_squared <= millionth * of.rho_squared
                        && refined.dual_squared <= millionth * of.dual_squared
                        && reported.iter().all(|(of, _)| {
                            refined.rho_squared <= kept * millionth * radius(of) * radius(of)
                        })
                });
            if !is_solution && !is_better {
                point = self.newton_step(&point)?;
                continue;
            }
            let slack = Exact::ratio(i64::from(is_better), 1000);
            if let Some(certificate) = &certificate {
                let verdict = self.inside(certificate, &start, &point, slack, asked);
                if verdict.fails() {
                    return Ok(verdict);
                }
            }
            for (of, _) in reported {
                let factors = [Exact::of_double(asked.factor), slack * radius(of)];
                let up = draw.turned([0, 1]).map(Exact::from);
                let verdict = self.within(&found, &point.u, of, factors, up);
                if verdict.fails() {
                    return Ok(verdict);
                }
            }
            let class = if is_solution { self.problem.class(&point.u) } else { IRRATIONAL };
            return Ok(Verdict::Holds(class));
        }
        if draw.by_contact {
            return Ok(Verdict::Vacuous);
        }
        Err("Newton's steps settle on no better point")
    }

    /// |e|_A <= rho and |e|_a <= |r|_a*/(1 - kappa), kappa < 1, where e is known up to `slack` times these; and all bounds where it
    /// is known exactly.
    fn inside(
        &self,
        certificate: &Certificate,
        found: &Point,
        point: &Point,
        slack: Exact,
        asked: Asked,
    ) -> Verdict {
        let error = self.difference(&found.u, &point.u);
        let kept = Exact::from(1) - self.problem.kappa();
        ensure!(kept > Exact::from(0));
        let factor = asked.factor(Bound::Displacement) + slack;
        ensure!(square(&self.a, &error) <= factor * factor * certificate.rho_squared);
        let factor = asked.factor(Bound::Energy) + slack;
        let in_energy = square(&self.k, &error);
        ensure!(kept * kept * in_energy <= factor * factor * certificate.dual_squared);
        if slack == Exact::from(0)
            && let Some(apart) = self.problem.pressures_apart(&found.u, &point.u)
        {
            let left = square(&self.a, &error) + apart;
            ensure!(left <= asked.factor(Bound::Monotone) * dot(&found.residual, &error));
            let half = asked.factor(Bound::Pressure) / Exact::from(2);
            ensure!(apart <= half * half * certificate.rho_squared);
        }
        Verdict::Holds("inside")
    }

    /// u~ is as near to `exact` as the enclosure says, its radii times a factor, where `exact` is u^h up to `slack`.
    fn within(
        &self,
        found: &[[Exact; 2]],
        exact: &[[Exact; 2]],
        enclosure: &Enclosure,
        [factor, slack]: [Exact; 2],
        up: [Exact; 2],
    ) -> Verdict {
        let most = |radius: f64| factor * Exact::of_double(radius) + slack;
        let error: Nodal =
            found.iter().zip(exact).map(|(u, v)| [u[0] - v[0], u[1] - v[1]]).collect();
        ensure!(self.problem.energy(&error) <= most(enclosure.radius) * most(enclosure.radius));
        // At the nodes from where the prescribed components should be.
        let mut found = found.to_vec();
        self.problem.prescribe(&mut found);
        let found = &found[..];
        for ((u, exact), &node) in found.iter().zip(exact).zip(&enclosure.nodes) {
            let off = [u[0] - exact[0], u[1] - exact[1]];
            ensure!(off[0] * off[0] + off[1] * off[1] <= most(node) * most(node));
        }
        if slack == Exact::from(0)
            && let Some(apart) = self.problem.pressures_apart(found, exact)
        {
            ensure!(apart <= most(enclosure.pressure) * most(enclosure.pressure));
        }
        if slack == Exact::from(0) {
            self.reported(exact, enclosure, factor, up)
        } else {
            Verdict::Holds("within")
        }
    }

    /// What is reported of u^h lies in its intervals, which are made narrower by `factor`.
    fn reported(
        &self,
        u: &[[Exact; 2]],
        enclosure: &Enclosure,
        factor: Exact,
        up: [Exact; 2],
    ) -> Verdict {
        let zero = Exact::from(0);
        let two = Exact::from(2);
        let inside = |[low, high]: [f64; 2], x: Exact| {
            let [low, high] = [low, high].map(Exact::of_double);
            let (middle, half) = ((low + high) / two, (high - low) / two * factor);
            middle - half <= x && x <= middle + half
        };
        let intervals = &enclosure.intervals;
        ensure!(inside(intervals.energy, self.problem.energy(u)));
        let largest = u.iter().map(|u| u[0] * u[0] + u[1] * u[1]);
        let largest = largest.fold(zero, |most, x| if x > most { x } else { most });
        let [low, high] = intervals.max_displacement.map(Exact::of_double);
        ensure!(low * low <= largest && largest <= high * high);
        // One boundary, the lower side, with the normal -`up`; and one that holds.
        let force = self.problem.contact_force(u);
        let [contact] = &intervals.contact[..] else { return Verdict::Fails("one boundary") };
        ensure!(inside(contact.force, force));
        ensure!((0..2).all(|c| inside(contact.resultant[c], force * up[c])));
        let held = self.problem.reactions(u).into_iter().zip(self.problem.prescribed());
        let reaction = held.fold([zero; 2], |sum, (r, p)| {
            [0, 1].map(|c| if p[c].is_some() { sum[c] + r[c] } else { sum[c] })
        });
        let Some(ranges) = intervals.reactions.values().next() else {
            return Verdict::Fails("a boundary holds");
        };
        ensure!((0..2).all(|c| inside(ranges[c], reaction[c])));
        Verdict::Holds("within")
    }
}

const P1: (Degree, ContactQuadrature) = (Degree::One, ContactQuadrature::Exact);
const P1_BY_POINTS: (Degree, ContactQuadrature) = (Degree::One, ContactQuadrature::Gauss(3));
const P2_BY_POINTS: (Degree, ContactQuadrature) = (Degree::Two, ContactQuadrature::Gauss(3));

fn hold(asked: Asked) -> Outcome {
    let mut text = Vec::new();
    for (cases, (degree, quadrature), most, gap, class) in [
        (6, P1, [2, 2], WIDE, "open"),
        (6, P1, [2, 2], NARROW, "pressed"),
        (12, P1, [2, 2], BETWEEN, IRRATIONAL),
        (4, P1_BY_POINTS, [2, 1], BETWEEN, CUT),
        (4, P2_BY_POINTS, [1, 1], BETWEEN, CUT),
    ] {
        text.push(draws::hold(cases, problems(most, gap), &[class], |draw| {
            enclosed(degree, draw, quadrature, asked)
        })?);
    }
    Ok(text.join("; "))
}

/// Draws of bodies that contact alone holds, around the result and around any point near it. Where an edge is open in part,
/// u^h is rational by Gauss points only.
fn reported_of_what_contact_holds() -> Outcome {
    let mut text = Vec::new();
    for asked in [RESULT, Asked { noise: 1e-4, ..MOVED }] {
        for (cases, (degree, quadrature), most, steeper, classes) in [
            (3, P1, [2, 2], 6.0, &["pressed"][..]),
            (3, P1_BY_POINTS, [2, 2], 12.0, &["pressed", CUT]),
            (2, P2_BY_POINTS, [1, 1], 6.0, &["pressed"]),
        ] {
            text.push(draws::hold(cases, problems_by_contact(most, steeper), classes, |draw| {
                enclosed(degree, draw, quadrature, asked)
            })?);
        }
    }
    Ok(text.join("; "))
}

/// A third of the radii there.
fn a_third_of_what_contact_holds() -> Outcome {
    let asked = Asked { factor: 1.0 / 3.0, noise: 1e-4, ..MOVED };
    draws::reject(problems_by_contact([2, 2], 6.0), |draw| {
        enclosed(Degree::One, draw, ContactQuadrature::Exact, asked)
    })
}

/// A body on a round obstacle, so that directions of contact turn along each edge: the kappa that the enclosure proves is that
/// of the method, times `scale`, rounded up, and its bounds at the nodes are Korn's factors times the radius.
fn proved_kappa(scale: f64) -> Outcome {
    let mut turning: f64 = 0.0;
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    for radius in [1.0, 3.0, 20.0] {
        let cells = Rectangle { width: 2.0, height: 1.0, nx: 3, ny: 2, diagonal: Diagonal::Left };
        let center = [0.7, -0.05 - radius];
        let round = Obstacle::Circle { center, radius, side: Side::Outside };
        let round = Condition::Obstacle("round".into(), round);
        let conditions = [("top", held([0.0, -0.1])), ("bottom", round)];
        let problem = unloaded(cells.mesh().map_err(text)?, material, conditions);
        for gamma0 in [Gamma0::Auto, Gamma0::Local(0.5)] {
            turning = turning.max(proved_kappa_on(Degree::One, &problem, gamma0, scale)?);
            turning = turning.max(proved_kappa_on(Degree::Two, &problem, gamma0, scale)?);
        }
    }
    // At a corner a triangle may have two edges on Gamma_C.
    for diagonal in [Diagonal::Left, Diagonal::Right] {
        let mesh = cells([2, 1], diagonal).mesh().map_err(text)?;
        let conditions =
            [("top", held([0.1, -0.1])), ("bottom", floor(0.0)), ("right", floor(0.0))];
        let problem = unloaded(mesh, material, conditions);
        proved_kappa_on(Degree::One, &problem, Gamma0::Auto, scale)?;
        proved_kappa_on(Degree::Two, &problem, Gamma0::Auto, scale)?;
    }
    Ok(format!("3 obstacles and two corners, P1 and P2; directions turn by up to {turning:.2}"))
}

fn proved_kappa_on(
    degree: Degree,
    problem: &Problem,
    gamma0: Gamma0,
    scale: f64,
) -> Result<f64, String> {
    let d = discretize(problem, &Method { degree, gamma0, ..Method::default() });
    let d = d.map_err(text)?;
    let (solved, ..) = solve_discrete(&d, &Settings::default()).map_err(text)?;
    let system = System::new(&d).map_err(text)?;
    let enclosure = enclosure::enclose(&system, &solved.u, None, None);
    let enclosure = enclosure.map_err(text)?;
    let korn = Korn::new(&d.space, &problem.material, &d.constraints, &[]).ok_or("not held")?;
    for (bound, factor) in enclosure.nodes.iter().zip(korn.nodes) {
        // What is prescribed is a double: rounding moves nothing, and all of the radius is that of the residual, each rounded up.
        let expected = factor * enclosure.radius;
        if !((bound - expected).abs() <= 1e-14 * expected) {
            return Err(format!("a bound of {bound:e} at a node, by Korn {expected:e}"));
        }
    }
    let (proved, kappa) = (scale * enclosure.kappa, d.kappa());
    // Some dozen roundings of doubles on the one side.
    if !((proved - kappa).abs() <= 1e-14 * kappa) {
        return Err(format!("kappa = {kappa}, and {proved} is proved"));
    }
    let turns = d.contact.iter().map(|piece| {
        let [start, end] = [0, 1].map(|a| piece.geometry.nodes[a].direction);
        (start - end).map(f64::abs).max()
    });
    Ok(turns.fold(0.0, f64::max))
}

/// In full contact, where u^h is rational and each of the bounds is looked at.
fn rejected(asked: Asked) -> Outcome {
    let mut text = Vec::new();
    for ((degree, quadrature), most) in [(P1, [2, 1]), (P2_BY_POINTS, [1, 1])] {
        text.push(draws::reject(problems(most, NARROW), |draw| {
            enclosed(degree, draw, quadrature, asked)
        })?);
    }
    Ok(text.join("; "))
}

/// A square of 4 x 4 cells that rolls off its floor: 40 unknowns.
fn on_a_finer_mesh() -> Outcome {
    let draw = Draw {
        cells: [4, 4],
        diagonal: Diagonal::Right,
        moved: None,
        lambda: 1.0,
        plane: Plane::Strain,
        load: [0.25, -0.125],
        gap: [-0.25, 0.125],
        push: 0.0,
        kappa: 10,
        by_contact: false,
    };
    Exact::scope(|| match enclosed(Degree::One, &draw, ContactQuadrature::Exact, RESULT) {
        Verdict::Holds(IRRATIONAL) => Ok(format!("40 unknowns: {IRRATIONAL}")),
        other => Err(format!("{other:?}")),
    })
}

/// A tenth of the right side of each bound in turn.
fn a_tenth() -> Outcome {
    let mut text = Vec::new();
    for bound in [Bound::Monotone, Bound::Energy, Bound::Displacement, Bound::Pressure] {
        text.push(rejected(Asked { tenth: Some(bound), ..RESULT })?);
    }
    Ok(text.join("; "))
}

/// The triangle (0, 0), (3, 0), (0, 4) in contact at y = 0, all but (3, 0) clamped, lambda = mu = 1, with the body force
/// (-1/2, 0), whose load is (-1, 0).
fn triangle() -> Result<Problem, String> {
    let named = [("bottom", [0, 1]), ("left", [2, 0])];
    let mesh = mesh(vec![[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]], vec![[0, 1, 2]], named)?;
    let mut problem = sharpness::clamped(mesh, Material::lame(1.0, 1.0, Plane::Strain), &["left"]);
    problem.body_force = [constant(-0.5), constant(0.0)];
    Ok(problem)
}

/// On the triangle with gamma0 = 8/5, twelve times the limit, both u = (3/2, 0) and u = (-19/32, 3/8) are solutions, and
/// the certificate refuses both; with gamma0 = 1/15 it accepts any point.
fn refused_beyond_the_limit() -> Outcome {
    let problem = triangle()?;
    Exact::scope(|| {
        let zero = [0; 2].map(Exact::from);
        for (gamma0, unique) in [(1.6, false), (1.0 / 15.0, true)] {
            let gamma0 = Gamma0::Value(gamma0);
            let method = Method { gamma0, allow_noncoercive: true, ..Method::default() };
            let d = discretize(&problem, &method).map_err(text)?;
            let certifier = Certifier::new(&d);
            // The solver's load, -1 up to rounding; with it the solutions are scaled.
            let scale = -Exact::of_double(d.load[1][0]);
            for u in [[(3, 2), (0, 1)], [(-19, 32), (3, 8)]] {
                let field = vec![zero, u.map(|(n, d)| scale * Exact::ratio(n, d)), zero];
                let field = certifier.point(field);
                if !unique && !field.is_solution() {
                    return Err(format!("{u:?} is no solution"));
                }
                if certifier.certify(&field).is_ok() != unique {
                    return Err(format!("gamma0 = {gamma0:?}: the certificate is wrong"));
                }
            }
            let system = System::new(&d).map_err(text)?;
            let enclosure = enclosure::enclose(&system, &d.constraints.lift(), None, None);
            let refused = matches!(enclosure, Err(Unproved::NotCoercive { .. }));
            if refused == unique {
                return Err(format!("gamma0 = {gamma0:?}: the enclosure is {enclosure:?}"));
            }
        }
        Ok("gamma0 = 8/5: two solutions, refused; gamma0 = 1/15: accepted".to_owned())
    })
}

/// The checks, for the row of Theorem 3.3.
pub fn checks() -> [Check; 25] {
    [
        exact!("the_enclosure_that_is_reported_contains_the_solution_around_the_result" => hold(RESULT)).about(&["Theorem 3.3"]),
        exact!("the_enclosure_of_what_contact_alone_holds_contains_the_solution" => reported_of_what_contact_holds()),
        exact!("control_a_third_of_the_radius_where_contact_holds" => a_third_of_what_contact_holds()),
        doubles!("stresses_in_doubles_are_off_by_no_more_than_their_bound" => honesty::stresses_are_off(1.0)),
        doubles!("control_a_bound_of_rounding_that_is_too_small" => noticed(honesty::stresses_are_off(1e-3))),
        exact!("the_enclosure_contains_the_solution_whatever_the_factor" => hold(ANOTHER_FACTOR)),
        doubles!("errors_at_points_are_those_of_the_nodes" => answers::errors_at_points(1.0)),
        doubles!("control_half_the_error_at_a_point" => noticed(answers::errors_at_points(0.5))),
        doubles!("edges_that_are_taken_for_pressed_stay_so" => pressed::stays(1.0)),
        doubles!("control_edges_stay_pressed_on_a_larger_ball" => noticed(pressed::stays(1.01))),
        doubles!("pressed_edges_hold_their_ends" => pressed::holds(1.0)),
        doubles!("control_pressed_edges_hold_their_ends_by_a_hundredth_less" => noticed(pressed::holds(0.99))),
        doubles!("springs_of_pressed_edges_are_those_of_p0" => pressed::springs(1.0)),
        doubles!("control_springs_of_pressed_edges_are_stiffer" => noticed(pressed::springs(1.0 + 1e-9))),
        doubles!("all_that_is_within_the_clearance_is_a_solution" => pressed::room(1.0 - 1e-9)),
        doubles!("control_what_is_beyond_the_clearance_is_a_solution" => noticed(pressed::room(1.01))),
        doubles!("kappa_and_bounds_at_nodes_are_proved_where_directions_turn" => proved_kappa(1.0)),
        doubles!("control_a_kappa_that_is_a_millionth_smaller" => noticed(proved_kappa(1.0 - 1e-6))),
        exact!("the_enclosure_that_is_reported_contains_the_solution_around_any_point" => hold(MOVED)),
        exact!("control_a_third_of_the_radius_that_is_reported" => rejected(Asked { factor: 1.0 / 3.0, ..MOVED })),
        exact!("control_a_residual_from_a_wrong_load" => rejected(Asked { load: 1.0 + 1e-6, ..RESULT })),
        exact!("one_solution_is_enclosed_on_a_finer_mesh" => on_a_finer_mesh()),
        exact!("control_a_tenth_of_the_radius_encloses" => a_tenth()),
        exact!("control_a_moved_result_for_the_solvers" => rejected(Asked { noise: 1e-9, ..RESULT })),
        exact!("control_certificate_beyond_the_limit" => refused_beyond_the_limit()),
    ]
}
