//! Newton's method ends at the solution (docs/theory.md, 4.2), also where full steps cycle (4.4).
//!
//! It asks a body what a step does to it. Here the body is a small symmetric positive definite matrix B and P = x, with springs of
//! stiffness 1000: J(x) = 1/2 x^T B x - f^T x + 500 sum \[x_i\]+^2, the example of 4.4.

use std::borrow::Cow;
use std::cell::Cell;
use std::ops::Range;

use nalgebra::DMatrix;
use proptest::array::uniform3;
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};

use super::{Until, minimise};
use crate::kernel::DoubleDouble;
use crate::solve::SolveError;
use crate::solve::body::{self, Body as _, ContactEnergy, Derivatives, Residual, Step};

/// The reason why a property does not hold.
type Outcome = Result<(), String>;

/// Asks whether a property holds of as many bodies, the same in each run.
fn for_all(draws: u32, holds: impl Fn(Body) -> Outcome) -> Outcome {
    let config = Config { cases: draws, failure_persistence: None, ..Config::default() };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let found = TestRunner::new_with_rng(config, rng)
        .run(&any_body(), |body| holds(body).map_err(TestCaseError::fail));
    found.map_err(|error| error.to_string())
}

type Vector = [f64; 3];
type Matrix = [Vector; 3];

/// The stiffness of the springs.
const STIFFNESS: f64 = 1000.0;

/// Three springs.
struct Springs;

impl ContactEnergy for Springs {
    fn count(&self) -> usize {
        3
    }

    fn values(&self, e: usize) -> Range<usize> {
        e..e + 1
    }

    fn derivatives(&self, _: usize, s: f64, p: &[DoubleDouble]) -> (Vec<f64>, DMatrix<f64>) {
        let p = p[0].head();
        let stiffness = if p > 0.0 { s * STIFFNESS } else { 0.0 };
        (vec![stiffness * p], DMatrix::from_element(1, 1, stiffness))
    }

    fn bregman(&self, _: usize, s: f64, p: &[DoubleDouble], q: &[DoubleDouble]) -> f64 {
        let (p, q) = (p[0].head(), q[0].head());
        let step = q.max(0.0) - p.max(0.0);
        s * STIFFNESS * (step * step / 2.0 + p.max(0.0) * (-q).max(0.0))
    }
}

/// B, f and x.
#[derive(Clone, Debug)]
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

    fn start(&mut self, _: &impl ContactEnergy) -> Result<Option<f64>, SolveError> {
        Ok(Some(1.0))
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
    let until = Until { steps: MOST, residual: 0.0, near: 0.0 };
    minimise(&Springs, body, first, &mut residuals, until).map_err(|error| error.to_string())?;
    let at = body::derivatives(&Springs, 1.0, &body.y());
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
    if residual <= NEAR && steps < MOST && body.energy() < start {
        Ok(())
    } else {
        Err(format!("after {steps} steps the residual is {residual:.1e} times its noise"))
    }
}

/// A symmetric positive definite B = R R^T + 1/10, f, and start.
fn any_body() -> impl Strategy<Value = Body> {
    let vector = || uniform3(-5.0..5.0);
    (uniform3(vector()), vector(), vector()).prop_map(|(r, f, x)| {
        let entry = |i: usize, j: usize| dot(&r[i], &r[j]) + if i == j { 0.1 } else { 0.0 };
        let b = [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)));
        Body { b, f: f.map(|c: f64| if c.abs() < 0.1 { 1.0 } else { c }), x, full: false }
    })
}

/// From random starts, from soft springs on and from 1e-8 away it ends at a residual of at most `near` times its noise.
fn from_any_start(near: f64) -> Outcome {
    let in_contact = Cell::new(0);
    for_all(1000, |mut body| {
        let (start, mut softened) = (body.energy(), body.clone());
        let plain = ends(&mut body, false)?;
        let soft = ends(&mut softened, true)?;
        let x = [0, 1, 2].map(|i| body.x[i] + 1e-8 * body.f[i]);
        let again = ends(&mut Body { x, ..body.clone() }, true)?;
        let ended = |(residual, steps): (f64, usize)| residual <= near && steps < MOST;
        let lower = body.energy() <= start + 1e-9 * (1.0 + start.abs());
        if !([plain, soft, again].into_iter().all(ended) && lower) {
            return Err(format!("{plain:?}, {soft:?}, {again:?}"));
        }
        in_contact.set(in_contact.get() + usize::from(body.x.iter().any(|&x| x > 0.0)));
        Ok(())
    })?;
    if (1..1000).contains(&in_contact.get()) {
        Ok(())
    } else {
        Err("no body with, or without".into())
    }
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

    fn start(&mut self, _: &impl ContactEnergy) -> Result<Option<f64>, SolveError> {
        // The springs beside the softest that B may be.
        Ok(Some(STIFFNESS / 0.1))
    }

    fn step(&mut self, at: &Derivatives) -> Result<Step, SolveError> {
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

/// Each line search from where a spring is pressed leaves a hundredth of the derivative, and what rounding
/// adds; with `full` steps it is not so.
fn line_searches(full: bool) -> Outcome {
    let soft = Cell::new(0);
    for_all(500, |body| {
        let body = Body { full, ..body };
        let mut watched = Watched { body, stiffness: None, left: 0.0, soft: 0 };
        let until = Until { steps: MOST, residual: 0.0, near: 0.0 };
        minimise(&Springs, &mut watched, true, &mut Vec::new(), until)
            .map_err(|error| error.to_string())?;
        if !(watched.left <= 0.0101) {
            return Err(format!("{} of the derivative is left", watched.left));
        }
        soft.set(soft.get() + watched.soft);
        Ok(())
    })?;
    if soft.get() > 0 { Ok(()) } else { Err("no search with soft springs".to_owned()) }
}

/// A body that remembers the slope of its last step, and how much of that it made.
struct Remembering {
    body: Body,
    slope: f64,
    made: f64,
}

impl body::Body for Remembering {
    fn y(&self) -> Cow<'_, [DoubleDouble]> {
        self.body.y()
    }

    fn residual(&self, at: &Derivatives) -> Residual {
        body::Body::residual(&self.body, at)
    }

    fn start(&mut self, edges: &impl ContactEnergy) -> Result<Option<f64>, SolveError> {
        self.body.start(edges)
    }

    fn step(&mut self, at: &Derivatives) -> Result<Step, SolveError> {
        let step = self.body.step(at)?;
        (self.slope, self.made) = (step.slope, 0.0);
        Ok(step)
    }

    fn advance(&mut self, t: f64, step: &Step) {
        self.made = t;
        self.body.advance(t, step);
    }
}

/// After each number of steps the decrement of the last one is left if that was cut short, and nothing if it was `whole`.
fn what_is_left(whole: f64) -> Outcome {
    let (cut, full) = (Cell::new(0), Cell::new(0));
    for_all(500, |body| {
        for steps in 0..8 {
            let mut body = Remembering { body: body.clone(), slope: 0.0, made: whole };
            let until = Until { steps, residual: 0.0, near: 0.0 };
            let mut residuals = Vec::new();
            let left = minimise(&Springs, &mut body, false, &mut residuals, until);
            let left = left.map_err(|error| error.to_string())?;
            let expected = if body.made < whole { -body.slope } else { 0.0 };
            if left != expected {
                return Err(format!("{left} is left after {steps} steps, not {expected}"));
            }
            let count = if left > 0.0 { &cut } else { &full };
            count.set(count.get() + 1);
        }
        Ok(())
    })?;
    if cut.get() > 0 && full.get() > 0 {
        Ok(())
    } else {
        Err("no step that is cut, or none that is not".to_owned())
    }
}

#[test]
fn newton_ends_at_the_minimiser_where_full_steps_cycle() {
    assert_eq!(the_cycle(false), Ok(()));
    assert!(the_cycle(true).is_err(), "the control");
}

#[test]
fn newton_ends_at_the_minimiser_from_any_start() {
    assert_eq!(from_any_start(NEAR), Ok(()));
    assert!(from_any_start(0.0).is_err(), "the control");
}

#[test]
fn the_line_search_ends_where_the_derivative_is_a_hundredth() {
    assert_eq!(line_searches(false), Ok(()));
    assert!(line_searches(true).is_err(), "the control");
}

#[test]
fn the_decrement_of_a_step_that_is_cut_short_is_left() {
    assert_eq!(what_is_left(1.0), Ok(()));
    assert!(what_is_left(0.0).is_err(), "the control");
}
