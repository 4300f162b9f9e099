//! Newton's method of the solver ends at the solution (docs/theory.md, 4.2), also where full steps cycle (4.4), and the
//! verdict on what it ends with.
//!
//! `solve::newton` asks a body what a step does to it. Here the body is a small symmetric positive definite matrix B and P =
//! x, with springs of stiffness 1000: J(x) = 1/2 x^T B x - f^T x + 500 sum \[x_i\]+^2, the example of 4.4.

use std::borrow::Cow;

use proptest::prelude::*;
use signorini::fem::double_double::DoubleDouble;
use signorini::nalgebra::DMatrix;
use signorini::solve::accuracy::Outcome as Solved;
use signorini::solve::body::{self, Body as _, Derivatives, Edges, Residual, Start, Step};
use signorini::solve::newton::{self, Until};
use signorini::solve::{Method, Settings, SolveError, Status, solve};

use crate::claim::{Claim, Outcome, noticed, text};
use crate::claims::{honesty, passes};
use crate::verdict::Verdict;
use crate::{draws, ensure, sharpness};

type Vector = [f64; 3];
type Matrix = [Vector; 3];

/// Of the springs.
const STIFFNESS: f64 = 1000.0;

/// Three springs.
struct Springs;

impl Edges for Springs {
    fn count(&self) -> usize {
        3
    }

    fn nodes(&self) -> usize {
        1
    }

    fn derivatives(&self, _: usize, p: &[DoubleDouble]) -> (Vec<f64>, DMatrix<f64>) {
        let p = p[0].head();
        let stiffness = if p > 0.0 { STIFFNESS } else { 0.0 };
        (vec![stiffness * p], DMatrix::from_element(1, 1, stiffness))
    }

    fn bregman(&self, _: usize, p: &[DoubleDouble], q: &[DoubleDouble]) -> f64 {
        let (p, q) = (p[0].head(), q[0].head());
        let step = q.max(0.0) - p.max(0.0);
        STIFFNESS * (step * step / 2.0 + p.max(0.0) * (-q).max(0.0))
    }
}

/// B, f and x.
#[derive(Clone)]
struct Body {
    b: Matrix,
    f: Vector,
    x: Vector,
    /// Full steps only: the planted mistake.
    full: bool,
}

fn times(b: &Matrix, x: &Vector) -> Vector {
    b.map(|row| (0..3).map(|i| row[i] * x[i]).sum())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The solution of a system with a symmetric positive definite matrix, by elimination.
fn solved(mut b: Matrix, mut r: Vector) -> Vector {
    for k in 0..3 {
        for i in k + 1..3 {
            let factor = b[i][k] / b[k][k];
            for j in k..3 {
                b[i][j] -= factor * b[k][j];
            }
            r[i] -= factor * r[k];
        }
    }
    for i in (0..3).rev() {
        for j in i + 1..3 {
            r[i] -= b[i][j] * r[j];
        }
        r[i] /= b[i][i];
    }
    r
}

impl Body {
    /// At the minimiser without springs.
    fn free(b: Matrix, f: Vector, full: bool) -> Body {
        Body { b, f, x: solved(b, f), full }
    }

    fn gradient(&self, springs: &[f64]) -> Vector {
        let linear = times(&self.b, &self.x);
        [0, 1, 2].map(|i| linear[i] - self.f[i] + springs[i])
    }

    /// A start where it is, by springs that are softer by `contact`: they would have to press with f - B x.
    fn soft(&self, contact: f64) -> Start {
        let forces = self.gradient(&[0.0; 3]).map(|g| -g).to_vec();
        Start { forces, contact: Some(contact) }
    }

    fn energy(&self) -> f64 {
        let springs: f64 = self.x.iter().map(|x| x.max(0.0).powi(2)).sum();
        dot(&times(&self.b, &self.x), &self.x) / 2.0 - dot(&self.f, &self.x)
            + STIFFNESS / 2.0 * springs
    }
}

impl body::Body for Body {
    fn y(&self) -> Cow<'_, [DoubleDouble]> {
        self.x.iter().map(|&x| x.into()).collect()
    }

    fn residual(&self, at: &Derivatives) -> Residual {
        let r = self.gradient(&at.gradient);
        let terms = times(&self.b.map(|row| row.map(f64::abs)), &self.x.map(f64::abs));
        let sizes = [0, 1, 2].map(|i| terms[i] + self.f[i].abs() + at.gradient[i].abs());
        let reference = dot(&self.f, &self.f).sqrt();
        let noise = 16.0 * f64::EPSILON * dot(&sizes, &sizes).sqrt() / reference;
        Residual { norm: dot(&r, &r).sqrt() / reference, noise }
    }

    fn start(&mut self, _: &impl Edges) -> Result<Start, SolveError> {
        Ok(self.soft(1.0))
    }

    fn compliance(&self, e: usize) -> DMatrix<f64> {
        DMatrix::from_element(1, 1, 1.0 / self.b[e][e])
    }

    fn step(&mut self, at: &Derivatives) -> Result<Step, SolveError> {
        let mut tangent = self.b;
        for (i, hessian) in at.hessian.iter().enumerate() {
            tangent[i][i] += hessian[(0, 0)];
        }
        let gradient = self.gradient(&at.gradient);
        let d = solved(tangent, gradient).map(|c| -c);
        let curvature = dot(&times(&self.b, &d), &d);
        Ok(Step { dy: d.to_vec(), slope: dot(&gradient, &d), curvature })
    }

    fn advance(&mut self, t: f64, step: &Step) {
        let t = if self.full { 1.0 } else { t };
        self.x.iter_mut().zip(&step.dy).for_each(|(x, d)| *x += t * d);
    }
}

/// The example of docs/theory.md, 4.4, in whose cycle the minimiser without springs lies.
const CYCLE: (Matrix, Vector) =
    ([[22.0, -5.0, 19.0], [-5.0, 2.0, -5.0], [19.0, -5.0, 17.0]], [-1.0, 2.0, -3.0]);

/// More steps than it takes.
const MOST: usize = 60;

/// Newton's method from where the body is, for the `first` time or again: the residual relative to its noise at the end, and
/// the number of steps.
fn ends(body: &mut Body, first: bool) -> Result<(f64, usize), String> {
    let mut residuals = Vec::new();
    let until = Until { steps: MOST, residual: 0.0 };
    newton::minimise(&Springs, body, first, &mut residuals, until).map_err(text)?;
    let at = body::derivatives(&Springs, &body.y());
    let Residual { norm, noise } = body.residual(&at);
    Ok((norm / noise, residuals.len()))
}

/// A residual this many times its noise is no solution; the last step is left out where it would change nothing.
const NEAR: f64 = 1e3;

fn the_cycle(full: bool) -> Outcome {
    let (b, f) = CYCLE;
    let mut body = Body::free(b, f, full);
    let start = body.energy();
    let (residual, steps) = ends(&mut body, false)?;
    if !(residual <= NEAR && steps < MOST && body.energy() < start) {
        return Err(format!("after {steps} steps the residual is {residual:.1e} times its noise"));
    }
    Ok(format!("{steps} steps, J from {start:.4} to {:.4}", body.energy()))
}

/// Any symmetric positive definite B = R R^T + 1/10, f, and start.
fn bodies() -> impl Strategy<Value = Body> {
    let vector = || prop::array::uniform3(-5.0_f64..5.0);
    ([vector(), vector(), vector()], vector(), vector()).prop_map(|(r, f, x)| {
        let entry = |i: usize, j: usize| dot(&r[i], &r[j]) + if i == j { 0.1 } else { 0.0 };
        let b = [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)));
        Body { b, f: f.map(|c| if c.abs() < 0.1 { 1.0 } else { c }), x, full: false }
    })
}

impl std::fmt::Debug for Body {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "B = {:?}, f = {:?}, x = {:?}", self.b, self.f, self.x)
    }
}

fn ends_from_any_start() -> Outcome {
    draws::hold(1000, bodies(), &["some contact", "none"], |body| {
        let (mut relaxed, mut body) = (body.clone(), body.clone());
        let start = body.energy();
        let Ok((residual, steps)) = ends(&mut body, false) else {
            return Verdict::Fails("it ends");
        };
        ensure!(residual <= NEAR && steps < MOST);
        // Linearised where each spring would go by itself, from soft ones on.
        let Ok((residual, steps)) = ends(&mut relaxed, true) else {
            return Verdict::Fails("it ends");
        };
        ensure!(residual <= NEAR && steps < MOST);
        ensure!(body.energy() <= start + 1e-9 * (1.0 + start.abs()));
        // From so near that the residual is small, but no noise: the first call makes its steps all the same.
        let mut near = Body { x: [0, 1, 2].map(|i| body.x[i] + 1e-8 * body.f[i]), ..body.clone() };
        let Ok((residual, _)) = ends(&mut near, true) else { return Verdict::Fails("it ends") };
        ensure!(residual <= NEAR);
        Verdict::Holds(if body.x.iter().any(|&x| x > 0.0) { "some contact" } else { "none" })
    })
}

/// A body that looks at each line search: what the derivative of J with soft springs is where it ends, beside that at its start.
struct Watched {
    body: Body,
    /// The springs' stiffness, if one of them is pressed.
    stiffness: Option<f64>,
    /// The largest share of the derivative that is left, and how many searches with soft springs were seen.
    left: f64,
    soft: usize,
}

impl Watched {
    /// The derivative of 1/2 x^T B x - f^T x + s Psi along d.
    fn along(&self, stiffness: f64, x: &Vector, d: &[f64]) -> f64 {
        let springs = x.map(|x| stiffness * STIFFNESS * x.max(0.0));
        dot(&Body { x: *x, ..self.body.clone() }.gradient(&springs), d)
    }
}

impl body::Body for Watched {
    fn y(&self) -> Cow<'_, [DoubleDouble]> {
        self.body.y()
    }

    fn residual(&self, at: &Derivatives) -> Residual {
        body::Body::residual(&self.body, at)
    }

    fn start(&mut self, _: &impl Edges) -> Result<Start, SolveError> {
        // The springs beside the softest that B may be.
        Ok(self.body.soft(STIFFNESS / 0.1))
    }

    fn compliance(&self, e: usize) -> DMatrix<f64> {
        body::Body::compliance(&self.body, e)
    }

    fn step(&mut self, at: &Derivatives) -> Result<Step, SolveError> {
        // Linearised here or where the springs would go by themselves: the stiffness is that of those that are pressed.
        let pressed = at.hessian.iter().map(|h| h[(0, 0)]).find(|&h| h > 0.0);
        self.stiffness = pressed.map(|h| h / STIFFNESS);
        self.body.step(at)
    }

    fn advance(&mut self, t: f64, step: &Step) {
        let before = self.body.x;
        self.body.advance(t, step);
        if let Some(s) = self.stiffness {
            let [start, end] = [before, self.body.x].map(|x| self.along(s, &x, &step.dy));
            // Where the step is rounding, so are the derivatives.
            let size = self.body.energy().abs().max(1.0);
            if start.abs() > 1e-9 * size {
                self.left = self.left.max((end / start).abs());
                self.soft += usize::from(s < 1.0);
            }
        }
    }
}

/// Newton's method from soft springs on, with each line search whose step was linearised where a spring is pressed.
fn watched(body: &Body) -> (Verdict, usize) {
    let mut watched = Watched { body: body.clone(), stiffness: None, left: 0.0, soft: 0 };
    let until = Until { steps: MOST, residual: 0.0 };
    let ended = newton::minimise(&Springs, &mut watched, true, &mut Vec::new(), until);
    let verdict = match ended {
        Err(_) => Verdict::Fails("it ends"),
        // A hundredth, and what rounding adds.
        Ok(_) if watched.left <= 0.0101 => Verdict::Holds("searched"),
        Ok(_) => Verdict::Fails("what is left of the derivative is a hundredth"),
    };
    (verdict, watched.soft)
}

fn line_searches_end_where_it_is_flat() -> Outcome {
    let soft = std::cell::Cell::new(0);
    let drawn = draws::hold(500, bodies(), &["searched"], |body| {
        let (verdict, count) = watched(body);
        soft.set(soft.get() + count);
        verdict
    })?;
    if soft.get() == 0 {
        return Err("no search with soft springs".to_owned());
    }
    Ok(format!("{drawn}; {} searches with soft springs", soft.get()))
}

/// The verdict: what is proved is a result, whatever else is said of it; without a proof a residual within the tolerance makes
/// one that is not proved, and anything else none. `proof` is the relative radius that is asked for.
fn verdict_is_honest(proof: f64) -> Outcome {
    let sizes = [0.0, 1e-14, 1e-10, 1.1e-10, 1e-6, 1.1e-6, 1.0, f64::INFINITY, f64::NAN];
    let problem = sharpness::small_bodies()?.swap_remove(0).problem;
    let (solution, _) = solve(&problem, &Method::default(), &Settings::default()).map_err(text)?;
    let enclosure = solution.enclosure.map_err(text)?;
    let settings = Settings { max_iterations: 50, ..Settings::default() };
    let mut results = 0;
    for residual in sizes {
        for relative in sizes {
            for steps in [1, 50] {
                let mut enclosure = enclosure.clone();
                (enclosure.radius, enclosure.relative) = (1.0, Some(relative));
                let solved = Solved {
                    u: Vec::new(),
                    forces: Vec::new(),
                    p: Vec::new(),
                    residuals: vec![1.0; steps + 1],
                    residual,
                    enclosure: Ok(enclosure),
                    forward_error: 0.0,
                    condition: 1.0,
                };
                let expected = match (residual <= 1e-10, relative <= proof) {
                    (true, true) => "converged, proved",
                    (true, false) => "converged, not proved",
                    (false, true) => "converged to rounding, proved",
                    (false, false) if steps == 50 => "not converged",
                    (false, false) => "ill conditioned",
                };
                let verdict = signorini::solve::Verdict::new(&solved.enclosure, settings.proof);
                let found = match solved.status(&settings) {
                    Ok(Status::Converged) => format!("converged, {}", verdict.name()),
                    Ok(Status::ConvergedToRounding) => {
                        format!("converged to rounding, {}", verdict.name())
                    }
                    Err(SolveError::NotConverged { .. }) => "not converged".to_owned(),
                    Err(SolveError::IllConditioned { .. }) => "ill conditioned".to_owned(),
                    Err(_) => "another error".to_owned(),
                };
                if found != expected {
                    return Err(format!(
                        "residual {residual:e}, relative radius {relative:e}, {steps} steps: {found}, expected {expected}"
                    ));
                }
                results += 1;
            }
        }
    }
    Ok(format!("{results} outcomes"))
}

fn verdict() -> Outcome {
    verdict_is_honest(Settings::default().proof)
}

/// The row.
pub fn claim() -> Claim {
    Claim {
        id: "19",
        items: &["Newton's method"],
        title: "Newton's method and the verdict",
        paper: "Nothing: the paper leaves open how (8) is solved.",
        statement: "The solver's Newton method with its line search ends at the minimiser of J, up to 1000 times the noise of the residual: on the example of docs/theory.md, 4.4, where full steps from the same start cycle for ever (the control runs them), and on random strongly convex J with three springs, from random starts and from 1e-8 away, with an energy that is not larger than at the start. The verdict is the proof: nothing leaves as proved whose enclosure is wider than [solver] proof, or whose error is larger than its enclosure, on nine loaded bodies, P1 and P2, with passes whose error is known: where they take it down by factors of 100, 10 and 2.5, where they get no nearer, and where they stop at a distance and have nothing left to correct, which the last correction takes for the end (the control lets it decide). Without a proof a residual within the tolerance makes a result that is not proved, and anything else none; infinities and NaN are no proof. The residual is that of (8) over the free degrees of freedom, relative to |L| + |R(lift) + L|. The condensed route takes at most two steps more than the assembled one; each line search whose step was linearised where a spring is pressed ends where the derivative is a hundredth of that at its start. When a solve ends: where contact is 10,000 times as stiff as at the limit, passes go on until no more than 1e-10 of loads and contact is out of balance, though a loose tolerance was met long before. In which numbers: stresses are those of the differences of the displacement between nodes, exactly, and of what doubles can't hold of it; where doubles blur P (a body that is carried along by 2^30) and so fall short of a proof, residuals are evaluated in double-doubles. The condition number is told from below, in any units the same.",
        numbers: "doubles.",
        kernel: &[
            "solve::newton::minimise",
            "solve::body::derivatives",
            "solve::accuracy::Outcome::is_proved",
            "solve::accuracy::refine",
            "solve::accuracy::reference",
            "solve::route::by",
        ],
        preconditions: "The tangent is positive definite (kappa < 1).",
        limits: "Small J, of three unknowns; theory 4.2 has the proof for all. What the enclosure is right about is row 10. The condition number may be a thousandth of the true one.",
        single: Some(
            "An iteration until a tolerance has no finite tree of paths, and its result is a double.",
        ),
        checks: vec![
            doubles!("newton_ends_at_the_minimiser_where_full_steps_cycle" => the_cycle(false)),
            doubles!("newton_ends_at_the_minimiser_from_any_start" => ends_from_any_start()),
            doubles!("the_verdict_is_the_proof" => verdict()),
            doubles!("the_residual_of_the_verdict_is_that_of_8_relative_to_the_forces" => honesty::residual_is_told(1.0)),
            doubles!("nothing_is_proved_that_is_further_away_than_asked_for" => honesty::proved(false)),
            doubles!("loads_contact_and_reactions_balance" => passes::loads_contact_and_reactions_balance()),
            doubles!("what_doubles_blur_is_evaluated_in_double_doubles" => passes::carried_blocks(1e-9)),
            doubles!("control_what_doubles_blur_to_all_digits" => noticed(passes::carried_blocks(1e-18))),
            doubles!("the_routes_take_the_same_steps_or_fewer" => passes::steps(passes::MORE)),
            doubles!("the_line_search_ends_where_the_derivative_is_a_hundredth" => line_searches_end_where_it_is_flat()),
            doubles!("the_condition_number_is_told_from_below" => passes::condition_is_told(1.0)),
            doubles!("control_a_condensed_route_that_saves_four_steps" => noticed(passes::steps(-4))),
            doubles!("control_line_searches_of_full_steps" => draws::reject(bodies(), |body| watched(&Body { full: true, ..body.clone() }).0)),
            doubles!("control_the_condition_number_a_hundred_times_as_large" => noticed(passes::condition_is_told(100.0))),
            doubles!("stresses_are_those_of_differences_between_nodes" => passes::differences(1.0)),
            doubles!("control_forces_that_balance_to_all_digits" => noticed(passes::balanced(0.0, 0.0))),
            doubles!("control_differences_that_are_off_by_rounding" => noticed(passes::differences(1.0 + 16.0 * f64::EPSILON))),
            doubles!("control_a_residual_a_tenth_too_small" => noticed(honesty::residual_is_told(0.9))),
            doubles!("control_the_last_correction_decides" => noticed(honesty::proved(true))),
            doubles!("control_full_steps_cycle" => noticed(the_cycle(true))),
            doubles!("control_a_verdict_that_accepts_every_radius" => noticed(verdict_is_honest(f64::INFINITY))),
        ],
    }
}
