//! Forces on the certificates of `by_hand`: what the checker finds, beside the integrals of docs/a-posteriori.md, 7.7, over rationals.
//!
//! w and w0 have random values, and are affine or quadratic on the triangles, whatever v is; rho of a dual pair is rho_yy = a + b
//! x, without a traction on Gamma_N. Loads may oscillate, and prescribed values may need a lift.

use approx::abs_diff_eq;
use proptest::prelude::*;
use signorini::certificates::dual::Dual;
use signorini::certificates::forces::{ForceTarget, Forces, Lifting, Mean, Motion};
use signorini::certificates::proof::{Certificate, Lift, Role};
use signorini::kernel::Ball;
use signorini::nalgebra::Vector2;

use super::by_hand::{self, draws_of, sixteenth, to_double};
use props::bodies::whole;
use props::naive::{Hooke, Line, Tensor, integral_of_affine};
use props::numbers::Exact;
use props::verdict::Verdict;
use props::{draws, ensure};

/// A certificate with what is to prove a force of it, in sixteenths.
#[derive(Clone, Debug)]
struct Draw {
    of: by_hand::Draw,
    motion: usize,
    /// w and w0 at the vertices and in the middles of the edges, in turn.
    w: Vec<[i32; 2]>,
    w0: Vec<[i32; 2]>,
    is_quadratic: bool,
    /// w does on Gamma_C what it should.
    is_exact: bool,
    rho: [i32; 2],
    /// |z|_a of the first two triangles.
    lifts: [i32; 2],
}

fn drawn() -> impl Strategy<Value = Draw> {
    let fields = (
        prop::collection::vec([-32..=32, -24..=24], 11),
        prop::collection::vec([-32..=32, -24..=20], 11),
        prop::bool::weighted(0.7),
        prop::bool::weighted(0.2),
        prop::bool::weighted(0.3),
    );
    let rho = prop_oneof![Just([0; 2]), [-8..=8, -8..=8]];
    let lifts = prop_oneof![Just([0; 2]), [1..=32, 1..=32]];
    (draws_of(false), 0..MOTIONS.len(), fields, rho, lifts).prop_map(
        |(mut of, motion, (w, w0, is_quadratic, is_exact, touches), rho, lifts)| {
            // tau presses at both ends of each edge.
            of.tau[3] -= 1;
            if touches {
                of.gap = [0; 2];
            }
            Draw { of, motion, w, w0, is_quadratic, is_exact, rho, lifts }
        },
    )
}

/// The boundaries' numbers.
const BOTTOM: usize = 0;
const TOP: usize = 1;

const MOTIONS: [(usize, Motion); 5] = [
    (BOTTOM, Motion::Along(None)),
    (BOTTOM, Motion::Axis(1)),
    (BOTTOM, Motion::Turn),
    (TOP, Motion::Axis(0)),
    (TOP, Motion::Turn),
];

/// What may be wrong with the definitions.
#[derive(Clone, Copy, PartialEq)]
enum Mistake {
    None,
    /// Nine tenths of |w|_a.
    ShortNorm,
    /// Nine tenths of the product with C eps(w) - rho.
    ShortProduct,
}

/// A displacement: at the vertices, and the bulges of the edges.
struct Shape {
    vertices: Vec<[f64; 2]>,
    bulges: Option<Vec<[f64; 2]>>,
}

impl Shape {
    fn lifting(&self) -> Lifting {
        let beyond = self.bulges.clone().map(|bulges| [Vec::new(), bulges]);
        Lifting { vertices: self.vertices.clone(), beyond }
    }

    /// A component along an edge.
    fn on_edge(&self, certificate: &Certificate, e: usize, c: usize) -> Line<Exact> {
        let [a, b] = certificate.edges[e].ends.map(|k| Exact::of_double(self.vertices[k][c]));
        let bulge = self.bulges.as_ref().map_or(0.0, |bulges| bulges[e][c]);
        Line::quadratic(a, (a + b) / Exact::from(2) + Exact::of_double(bulge), b)
    }
}

impl Draw {
    /// Its own certificate.
    fn certificate(&self) -> Certificate {
        let mut certificate = self.of.turned();
        for (piece, norm) in self.lifts.iter().enumerate().filter(|(_, norm)| **norm != 0) {
            let corners = certificate.pieces[piece].vertices;
            certificate.lifts.push(Lift { corners, norm: sixteenth(*norm) });
        }
        certificate
    }

    fn target(&self) -> ForceTarget {
        let (boundary, motion) = MOTIONS[self.motion];
        let all = motion == Motion::Along(None);
        ForceTarget { boundary: (!all).then_some(boundary), motion }
    }

    /// A displacement that is `on_top` there, with these numbers elsewhere; on Gamma_C they come to `on_bottom` along y.
    fn shape(
        &self,
        certificate: &Certificate,
        numbers: &[[i32; 2]],
        on_top: impl Fn([f64; 2]) -> [f64; 2],
        on_bottom: impl Fn([f64; 2]) -> f64,
    ) -> Shape {
        let (top, random) = (self.top(certificate), |k: usize| numbers[k % numbers.len()]);
        let vertices = certificate.vertices.iter().enumerate().map(|(k, &x)| match x[1] {
            y if y == top => on_top(x),
            0.0 => {
                let [along, missed] = random(k).map(sixteenth);
                [along, on_bottom(x) - if self.is_exact { 0.0 } else { missed }]
            }
            _ => random(k).map(sixteenth),
        });
        let vertices = vertices.collect();
        let bulges = certificate.edges.iter().enumerate().map(|(e, edge)| match edge.role {
            Role::Held(..) => [0.0; 2],
            Role::Contact { .. } if self.is_exact => [sixteenth(random(e + 5)[0]), 0.0],
            Role::Contact { .. } => random(e + 5).map(|k| -sixteenth(k) / 4.0),
            _ => random(e + 5).map(sixteenth),
        });
        Shape { vertices, bulges: self.is_quadratic.then(|| bulges.collect()) }
    }

    fn top(&self, certificate: &Certificate) -> f64 {
        certificate.vertices.iter().fold(0.0, |top, x| x[1].max(top))
    }

    fn w(&self, certificate: &Certificate) -> Shape {
        let (boundary, motion) = MOTIONS[self.motion];
        let at = |on: usize, x: [f64; 2]| -> [f64; 2] {
            if on != boundary {
                return [0.0; 2];
            }
            motion.at(Vector2::from(x)).map_or([0.0, -1.0], Into::into)
        };
        self.shape(certificate, &self.w, |x| at(TOP, x), |x| at(BOTTOM, x)[1])
    }

    /// The dual pair with this w, which is the same at the ends of the edges where rho acts and straight between them.
    fn pair(&self, certificate: &Certificate, w: &Shape) -> Dual {
        let rho = |x: [f64; 2]| self.rho([x[0], x[1]]);
        let roles = certificate.edges.iter().map(|edge| {
            let [p, q] = edge.ends.map(|k| certificate.vertices[k]);
            let force = [p, q].map(|x| [0.0, rho(x) * (p[0] - q[0])]);
            match edge.role {
                Role::Inner(_) => Role::Inner(force),
                Role::Contact { .. } if self.rho != [0; 2] => Role::Held([false, true], force),
                Role::Held(held, _) => Role::Held(held, force),
                _ => Role::Loaded([[0.0; 2]; 2]),
            }
        });
        Dual { w: w.lifting(), roles: roles.collect() }
    }

    /// rho_yy
    fn rho(&self, x: [f64; 2]) -> f64 {
        let [a, b] = self.rho.map(sixteenth);
        a + b * x[0]
    }
}

/// The integrals over the body of a displacement w, by their definitions.
struct Integrals {
    /// L(w)
    load: Exact,
    /// a(v, w)
    with_v: Exact,
    /// int tau : eps(w)
    with_tau: Exact,
    /// a(w, w)
    square: Exact,
    /// int C^-1 (C eps(v) - tau) : (C eps(w) - rho), and the square of the second factor.
    with_rho: [Exact; 2],
}

/// A stress field that is affine on the body.
type Field<'a> = &'a dyn Fn([Exact; 2]) -> Tensor<Exact>;

fn integrals(draw: &Draw, certificate: &Certificate, w: &Shape) -> Integrals {
    let (zero, [lambda, mu]) =
        (Exact::from(0), draw.of.lame.map(|k| Exact::of_double(sixteenth(k))));
    let hooke = Hooke::Isotropic { lambda, mu };
    let tau: Field = &|x| draw.of.tau(x, Exact::of_double(sixteenth(1)));
    let rho: Field = &|x| {
        let [a, b] = draw.rho.map(|k| Exact::of_double(sixteenth(k)));
        [zero, a + b * x[0], zero]
    };
    let body = draw.of.body().map(Exact::of_double);
    let minus = |a: Tensor<Exact>, b: Tensor<Exact>| [0, 1, 2].map(|c| a[c] - b[c]);
    let mut sums =
        Integrals { load: zero, with_v: zero, with_tau: zero, square: zero, with_rho: [zero; 2] };
    let bulges_of_v = certificate.curved.as_ref().map(|curved| &curved.bulges[..]);
    for piece in &certificate.pieces {
        let v = by_hand::field(certificate, piece, &certificate.displacement, bulges_of_v);
        let w = by_hand::field(certificate, piece, &w.vertices, w.bulges.as_deref());
        let area = v.area();
        let strains = [0, 1, 2].map(|k| w.strain(k));
        let taus = v.vertices.map(tau);
        let rhos = v.vertices.map(rho);
        let apart = [0, 1, 2].map(|k| minus(hooke.stress(v.strain(k)), taus[k]));
        let missed = [0, 1, 2].map(|k| minus(hooke.stress(strains[k]), rhos[k]));
        let missed_strains = missed.map(|s| hooke.strain(s));
        sums.load += w.load(0, |_| body[0]) + w.load(1, |_| body[1]);
        sums.with_v += v.energy(&w, &hooke);
        sums.square += w.energy(&w, &hooke);
        sums.with_tau += integral_of_affine(area, taus, strains);
        sums.with_rho[0] += integral_of_affine(area, apart, missed_strains);
        sums.with_rho[1] += integral_of_affine(area, missed, missed_strains);
    }
    for (e, edge) in certificate.edges.iter().enumerate() {
        if !matches!(edge.role, Role::Loaded(_) | Role::Pressed(_)) {
            continue;
        }
        let [p, q] = edge.ends.map(|k| certificate.vertices[k].map(Exact::of_double));
        let normal = [q[1] - p[1], p[0] - q[0]];
        let [s, t] = [p, q].map(tau);
        let along = |[xx, yy, xy]: Tensor<Exact>| {
            [xx * normal[0] + xy * normal[1], xy * normal[0] + yy * normal[1]]
        };
        for c in 0..2 {
            let force = Line::affine(along(s)[c], along(t)[c]);
            sums.load += whole(&force.by(&w.on_edge(certificate, e, c)));
        }
    }
    sums
}

/// The Bernstein coefficients of degree 3, by values at thirds.
fn bernstein(line: &Line<Exact>) -> [Exact; 4] {
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| line.at(Exact::ratio(k, 3)));
    let by = |p: Exact, q: Exact, r: Exact, s: Exact| {
        let [two, five, nine, eighteen] = [2, 5, 9, 18].map(Exact::from);
        (eighteen * q - five * p - nine * r + two * s) / Exact::from(6)
    };
    [a, by(a, b, c, d), by(d, c, b, a), d]
}

/// The largest value of x eta + k (M^2 - x^2) for 0 <= x <= M.
fn largest(eta: f64, k: f64, mean_squared: f64) -> f64 {
    let mean = mean_squared.sqrt();
    if eta >= 2.0 * k * mean { mean * eta } else { k * mean_squared + eta * eta / (4.0 * k) }
}

/// The least k with `of` <= k `by`, coefficient by coefficient.
fn least_factor(of: [Exact; 4], by: [Exact; 4]) -> f64 {
    let zero = Exact::from(0);
    let each = of.into_iter().zip(by).map(|(of, by)| match of {
        of if of <= zero => 0.0,
        of if by > zero => to_double(of / by),
        _ => f64::INFINITY,
    });
    each.fold(0.0, f64::max)
}

/// What is known of a certificate beside its liftings.
struct Known {
    /// M^2
    mean_squared: f64,
    /// The error of L(w) and a(v, w) for each unit of |w|_a.
    loose: f64,
    /// w0_n on the edges of Gamma_C, and R(w0) at most.
    cover: Option<f64>,
}

/// omega at most and at least, in units of g - v_n and of w0_n: the factors of the edges at which either is cheaper. `None` where
/// neither is enough.
fn missed(
    draw: &Draw,
    certificate: &Certificate,
    [w, w0]: [&Shape; 2],
    known: &Known,
) -> Option<[[f64; 2]; 2]> {
    let (boundary, motion) = MOTIONS[draw.motion];
    let mut factors = [[0.0_f64; 2]; 2];
    for (e, edge) in certificate.edges.iter().enumerate() {
        let Role::Contact { .. } = edge.role else { continue };
        let ends = edge.ends.map(|k| certificate.vertices[k].map(Exact::of_double));
        // n = (0, -1): phi is minus the motion along y.
        let [p, q] = ends.map(|x| match motion.at(Vector2::from(x)) {
            _ if boundary == TOP => Exact::from(0),
            Some(r) => -r[1],
            None => Exact::from(1),
        });
        let omega = Line::affine(p, q).plus(&w.on_edge(certificate, e, 1));
        let gap = bernstein(&gap(certificate, e));
        let cover = bernstein(&w0.on_edge(certificate, e, 1).times(Exact::from(-1)));
        for (side, sign) in [(0, -1), (1, 1)] {
            let off = bernstein(&omega.times(Exact::from(sign)));
            let by_gap = least_factor(off, gap);
            let by_cover = known.cover.map_or(f64::INFINITY, |_| least_factor(off, cover));
            let cost = by_cover * known.cover.unwrap_or_default();
            let chosen = match (by_gap.is_finite(), by_cover.is_finite()) {
                (true, true) if cost <= by_gap * known.mean_squared => [0.0, by_cover],
                (true, _) => [by_gap, 0.0],
                (false, true) => [0.0, by_cover],
                (false, false) => return None,
            };
            factors[side] = [0, 1].map(|k| factors[side][k].max(chosen[k]));
        }
    }
    Some(factors)
}

/// g - v_n on an edge of Gamma_C.
fn gap(certificate: &Certificate, e: usize) -> Line<Exact> {
    let Role::Contact { gap, .. } = certificate.edges[e].role else { return Line(Vec::new()) };
    let curved = certificate.curved.as_ref();
    let v = Shape {
        vertices: certificate.displacement.clone(),
        bulges: curved.map(|curved| curved.bulges.clone()),
    };
    let [a, b] = gap.map(Exact::of_double);
    let bulge = curved.map_or(0.0, |curved| curved.data[e][0]);
    let middle = (a + b) / Exact::from(2) + Exact::of_double(bulge);
    Line::quadratic(a, middle, b).plus(&v.on_edge(certificate, e, 1))
}

/// The numbers that a force lies between: what [7.6] and [7.7] say of a lifting.
fn between(of_w: &Integrals, known: &Known, factors: [[f64; 2]; 2], mistake: Mistake) -> [f64; 2] {
    let half = |x: Exact| x / Exact::from(2);
    let middle = to_double(of_w.load - half(of_w.with_v) - half(of_w.with_tau));
    let short = if mistake == Mistake::ShortNorm { 0.9 } else { 1.0 };
    let norm = short * to_double(of_w.square).sqrt();
    let away = factors.map(|[open, covered]| {
        let covered = covered * known.cover.unwrap_or_default();
        largest(norm, open, known.mean_squared) + covered + known.loose * norm
    });
    [middle - away[0], middle + away[1]]
}

/// The same by a dual pair, [7.8]; an end may be infinite.
fn between_by_pair(
    draw: &Draw,
    certificate: &Certificate,
    of_w: &Integrals,
    known: &Known,
    factors: [[f64; 2]; 2],
    mistake: Mistake,
) -> [f64; 2] {
    let mut of_r = Exact::from(0);
    let mut of_tau = [0.0_f64; 2];
    for (e, edge) in certificate.edges.iter().enumerate() {
        let Role::Contact { pressure, .. } = edge.role else { continue };
        let ends = edge.ends.map(|k| certificate.vertices[k]);
        let r = ends.map(|x| draw.rho(x));
        let length = Exact::of_double((ends[1][0] - ends[0][0]).abs());
        let [a, b] = r.map(Exact::of_double);
        of_r -= length * whole(&Line::affine(a, b).by(&gap(certificate, e)));
        for k in 0..2 {
            of_tau[0] = of_tau[0].max(r[k] / pressure[k]);
            of_tau[1] = of_tau[1].max(-r[k] / pressure[k]);
        }
    }
    let [product, square] = of_w.with_rho;
    let short = Exact::ratio(if mistake == Mistake::ShortProduct { 9 } else { 10 }, 20);
    let middle = to_double(of_w.load - of_w.with_v + of_r + short * product);
    let [norm, eta] = [of_w.square, square].map(|square| to_double(square).sqrt());
    let away = [0, 1].map(|side| {
        let [open, covered] = factors[side];
        let covered = covered * known.cover.unwrap_or_default();
        largest(eta, of_tau[side].max(open), known.mean_squared)
            + covered
            + 2.0 * known.loose * (norm + eta / 2.0)
    });
    [middle - away[0], middle + away[1]]
}

/// What is left of an end by rounding.
const CLOSE: f64 = 1e-7;

fn near(found: [f64; 2], expected: [f64; 2]) -> bool {
    let size = 1.0 + expected[0].abs() + expected[1].abs();
    found.into_iter().zip(expected).all(|(f, e)| abs_diff_eq!(f, e, epsilon = CLOSE * size))
}

/// The checker against the definitions: by a lifting, and where the force is one of contact by a dual pair.
fn forces_by_definition(draw: &Draw, mistake: Mistake) -> Verdict {
    let certificate = draw.certificate();
    let (topology, proof) = (certificate.topology(), certificate.evaluate::<Ball>());
    let (Ok(topology), Ok(proof)) = (topology, proof) else {
        return Verdict::Fails("the certificate is accepted");
    };
    let Ok(state) = certificate.balanced::<Ball>(topology) else {
        return Verdict::Fails("the triangles are in equilibrium");
    };
    let boundaries = certificate.edges.iter().map(|edge| match edge.role {
        Role::Contact { .. } => Some(BOTTOM),
        Role::Held(..) => Some(TOP),
        _ => None,
    });
    let boundaries: Vec<Option<usize>> = boundaries.collect();
    let mean = Mean::new(&state, &proof, certificate.lift());
    let forces = Forces::new(&certificate, &state, &boundaries, mean);
    let w = draw.w(&certificate);
    let w0 = draw.shape(&certificate, &draw.w0, |_| [0.0; 2], |_| -1.0);
    let cover = forces.cover(&w0.lifting());
    let found = forces.between(&[(draw.target(), w.lifting())], cover.as_ref().ok());
    let pair = draw.pair(&certificate, &w);
    let by_pair = forces.by_pair(draw.target(), &pair, cover.as_ref().ok());
    Exact::scope(|| {
        let Some(known) = known(draw, &certificate, &w0) else { return Verdict::Vacuous };
        ensure!(abs_diff_eq!(
            mean.square,
            known.mean_squared,
            epsilon = CLOSE * (1.0 + known.mean_squared)
        ));
        ensure!(cover.is_ok() == known.cover.is_some());
        let of_w = integrals(draw, &certificate, &w);
        let factors = missed(draw, &certificate, [&w, &w0], &known);
        let (Ok(found), Some(factors)) = (&found[0], factors) else {
            ensure!(found[0].is_err() && factors.is_none() && by_pair.is_err());
            return Verdict::Holds("off where nothing covers it");
        };
        let expected = between(&of_w, &known, factors, mistake);
        ensure!(near(*found, expected));
        let [by_gap, by_cover] = [0, 1].map(|k| factors[0][k].max(factors[1][k]));
        // w of a pair is 0 on Gamma_D, and where rho acts it is straight.
        let is_straight = draw.rho == [0; 2] || draw.is_exact || !draw.is_quadratic;
        if MOTIONS[draw.motion].0 == BOTTOM && is_straight {
            let Ok(by_pair) = by_pair else { return Verdict::Fails("there is a dual pair") };
            let expected = between_by_pair(draw, &certificate, &of_w, &known, factors, mistake);
            ensure!(near(by_pair.between, expected));
        }
        let norm = to_double(of_w.square).sqrt();
        Verdict::Holds(match (by_gap, by_cover) {
            (0.0, 0.0) => "exact on contact",
            (_, covered) if covered > 0.0 => "covered",
            (open, _) if norm < 2.0 * open * known.mean_squared.sqrt() => "of second order",
            _ => "off where there is a gap",
        })
    })
}

/// `None` where rounding decides whether w0 covers.
fn known(draw: &Draw, certificate: &Certificate, w0: &Shape) -> Option<Known> {
    let definition = draw.of.by_definition(certificate);
    let oscillation = sixteenth(draw.of.oscillation);
    let lift = draw.lifts.iter().map(|&k| sixteenth(k).powi(2)).sum::<f64>().sqrt();
    let apart = definition.squares.iter().map(|s| (to_double(*s).sqrt() + oscillation).powi(2));
    let apart = apart.sum::<f64>().sqrt() + lift;
    let mean_squared = apart * apart / 4.0 + to_double(definition.contact) / 2.0;
    let loose = (oscillation * (certificate.pieces.len() as f64).sqrt() + lift) / 2.0;
    let mut known = Known { mean_squared, loose, cover: None };
    let on_contact = |e: &usize| matches!(certificate.edges[*e].role, Role::Contact { .. });
    let coefficients = (0..certificate.edges.len())
        .filter(on_contact)
        .flat_map(|e| bernstein(&w0.on_edge(certificate, e, 1).times(Exact::from(-1))));
    let least = coefficients.reduce(|a, b| if b < a { b } else { a });
    if least == Some(Exact::from(0)) {
        return None;
    }
    if least > Some(Exact::from(0)) {
        let of_w0 = integrals(draw, certificate, w0);
        known.cover = Some(between(&of_w0, &known, [[0.0; 2]; 2], Mistake::None)[1]);
    }
    Some(known)
}

const CLASSES: [&str; 5] = [
    "exact on contact",
    "covered",
    "of second order",
    "off where there is a gap",
    "off where nothing covers it",
];

checks! {
    forces_are_between_the_numbers_of_their_definitions => { draws::hold(200, drawn(), &CLASSES, |draw| forces_by_definition(draw, Mistake::None)) };
    control_forces_by_nine_tenths_of_the_norm => { draws::reject(drawn(), |draw| forces_by_definition(draw, Mistake::ShortNorm)) };
    control_nine_tenths_of_the_product_with_a_dual_pair => { draws::reject(drawn(), |draw| forces_by_definition(draw, Mistake::ShortProduct)) };
}
