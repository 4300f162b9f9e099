//! Two deformable bodies (theory.md, 12): the law of an interface as one equation, one weighted flux for both sides, and the pieces of
//! random pairs of bodies whose meshes do not match, by the loops of the solver over rationals.

use std::sync::Arc;

use proptest::prelude::*;
use signorini::contact::piece::PieceGeometry;
use signorini::contact::residual::{add_internal_forces, exact_piece};
use signorini::contact::{Discretization, Law, Pair, Piece};
use signorini::kernel::{Material, Plane, Response, positive_part};
use signorini::model::{Condition, Degree, Materials, Mesh, Problem};
use signorini::solve::{Gamma0, Method, discretize};

use crate::claim::{Claim, Outcome, text};
use crate::draws::{self, ratio};
use crate::numbers::Exact;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

const BOTH: [Response; 2] = [Response::Unilateral, Response::Bilateral];

/// The part of a stress that is not allowed: 0 if and only if psi*(-sigma) is finite.
fn forbidden_stress<S: Ordered>(law: Response, sigma: S) -> S {
    match law {
        Response::Unilateral => positive_part(sigma),
        Response::Bilateral => S::from(0),
    }
}

/// Fenchel's gap psi(y) + psi*(-sigma) + sigma y of an allowed jump and an allowed stress: never negative, and 0 if and only if
/// they satisfy the law.
fn fenchel_gap<S: Ordered>(y: S, sigma: S) -> S {
    sigma * y
}

/// y and -sigma satisfy the law, said by what is forbidden and by Fenchel's gap.
fn is_law<S: Ordered>(law: Response, y: S, sigma: S) -> bool {
    let zero = S::from(0);
    law.q(y) == zero && forbidden_stress(law, sigma) == zero && fenchel_gap(y, sigma) == zero
}

/// Whether gamma sigma = -q(y - gamma sigma), for a candidate of q.
fn is_equation<S: Ordered>([y, sigma, gamma]: [S; 3], q: impl Fn(S) -> S) -> bool {
    gamma * sigma == -q(y - gamma * sigma)
}

/// The law and the equation are the same.
pub fn a_law_is_one_equation<S: Ordered>([y, sigma, gamma]: [S; 3]) -> Verdict {
    given!(gamma > S::from(0));
    for law in BOTH {
        let equation = is_equation([y, sigma, gamma], |p| law.q(p));
        ensure!(is_law(law, y, sigma) == equation);
    }
    Verdict::Holds("always")
}

/// With q(p) = p for contact, a stress that pulls.
pub fn control_bodies_in_contact_pull<S: Ordered>([y, sigma, gamma]: [S; 3]) -> Verdict {
    given!(gamma > S::from(0) && is_equation([y, sigma, gamma], |p| p));
    ensure!(is_law(Response::Unilateral, y, sigma));
    Verdict::Holds("always")
}

/// (q(a) - q(b))^2 <= (q(a) - q(b)) (a - b): of q the theory of method (8) uses nothing else.
pub fn q_of_every_law_is_firmly_nonexpansive<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    for law in BOTH {
        let difference = law.q(a) - law.q(b);
        ensure!(difference * difference <= difference * (a - b));
    }
    Verdict::Holds("always")
}

/// \[C\] at a point: u with sigma satisfies the law; y and tau are allowed. G - A - B = (sigma - tau) (j(u) - j(v)), all three >= 0.
pub fn identity_c_holds_at_a_point<S: Ordered>([y_u, y_v, sigma, tau]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    for law in BOTH {
        let is_allowed = law.q(y_v) == zero && forbidden_stress(law, tau) == zero;
        if is_law(law, y_u, sigma) && is_allowed {
            let [g, a, b] = [fenchel_gap(y_v, tau), fenchel_gap(y_v, sigma), fenchel_gap(y_u, tau)];
            ensure!(g - a - b == (sigma - tau) * (y_u - y_v));
            ensure!(g >= zero && a >= zero && b >= zero);
        }
    }
    Verdict::Holds("always")
}

/// Without the law of u, the term sigma y(u) is left.
pub fn control_identity_c_without_the_law_of_the_solution<S: Ordered>(
    [y_u, y_v, sigma, tau]: [S; 4],
) -> Verdict {
    let [g, a, b] = [fenchel_gap(y_v, tau), fenchel_gap(y_v, sigma), fenchel_gap(y_u, tau)];
    ensure!(g - a - b == (sigma - tau) * (y_u - y_v));
    Verdict::Holds("always")
}

/// Gamma s^2 <= gamma_1 s_1^2 + gamma_2 s_2^2 for a mean s of s_1 and s_2, both sides times Gamma = gamma_1 + gamma_2; `flux` is Gamma s.
fn mean_flux<S: Ordered>([gamma_1, gamma_2, s_1, s_2]: [S; 4], flux: S) -> Verdict {
    let squares = gamma_1 * s_1 * s_1 + gamma_2 * s_2 * s_2;
    ensure!(flux * flux <= (gamma_1 + gamma_2) * squares);
    Verdict::Holds("always")
}

/// The mean with the weights gamma_i / Gamma: what is left is gamma_1 gamma_2 (s_1 - s_2)^2.
pub fn one_weighted_flux_costs_no_more_than_that_of_each_body<S: Ordered>(v: [S; 4]) -> Verdict {
    let ([gamma_1, gamma_2, s_1, s_2], zero) = (v, S::from(0));
    given!(gamma_1 > zero && gamma_2 > zero);
    let (both, apart) = (gamma_1 * gamma_2, s_1 - s_2);
    ensure!(both > zero);
    ensure!(apart * apart >= zero);
    ensure!(both * (apart * apart) >= zero);
    mean_flux(v, gamma_1 * s_1 + gamma_2 * s_2)
}

/// The mean with equal weights.
pub fn control_equal_weights_for_unequal_bodies<S: Ordered>(v: [S; 4]) -> Verdict {
    let [gamma_1, gamma_2, s_1, s_2] = v;
    given!(gamma_1 > S::from(0) && gamma_2 > S::from(0));
    mean_flux(v, (gamma_1 + gamma_2) * (s_1 + s_2) / S::from(2))
}

/// Two blocks, one above the other, each a row of cells; places are multiples of a power of 1/2, so that doubles have them exactly.
#[derive(Clone, Debug)]
struct Draw {
    /// For each body which of its intervals is halved next.
    halved: [Vec<usize>; 2],
    /// In 1/32: how far up the upper one is.
    gap: i8,
    /// lambda and mu of each.
    moduli: [[u8; 2]; 2],
    /// In 1/16: how the vertices at the far sides are moved along them.
    moved: Vec<i8>,
    law: Law,
    values: Vec<[(i64, i64); 2]>,
    factors: Vec<(i64, i64)>,
}

fn pairs() -> impl Strategy<Value = Draw> {
    let halved = || prop::collection::vec(0_usize..8, 0..4);
    (
        [halved(), halved()],
        0_i8..3,
        [[1_u8..5, 1_u8..5], [1_u8..60, 1_u8..60]],
        prop::collection::vec(-1_i8..=1, 16),
        prop::sample::select(&[Law::Contact, Law::Sliding, Law::Bonded]),
        prop::collection::vec([ratio(), ratio()], 64),
        prop::collection::vec(ratio(), 6),
    )
        .prop_map(|(halved, gap, moduli, moved, law, values, factors)| Draw {
            halved,
            gap,
            moduli,
            moved,
            law,
            values,
            factors,
        })
}

/// The places of the vertices along a body.
fn breaks(halved: &[usize]) -> Vec<f64> {
    let mut breaks = vec![0.0, 1.0];
    for &k in halved {
        let i = k % (breaks.len() - 1);
        breaks.insert(i + 1, f64::midpoint(breaks[i], breaks[i + 1]));
    }
    breaks
}

/// The heights of the two bodies.
const HEIGHT: f64 = 0.5;

impl Draw {
    fn problem(&self) -> Result<Problem, String> {
        let (mut vertices, mut triangles, mut named) = (Vec::new(), Vec::new(), Vec::new());
        let mut members: Vec<Vec<usize>> = Vec::new();
        let gap = f64::from(self.gap) / 32.0;
        for (i, halved) in self.halved.iter().enumerate() {
            let (breaks, first, own) = (breaks(halved), vertices.len(), triangles.len());
            let count = breaks.len();
            let (near, far) = if i == 0 { (0.0, -HEIGHT) } else { (gap, gap + HEIGHT) };
            let moved = |k: usize| {
                // Inside, by less than a quarter of the shortest cell.
                let is_end = k == 0 || k + 1 == count;
                if is_end { 0.0 } else { f64::from(self.moved[8 * i + k]) / 64.0 }
            };
            vertices.extend(breaks.iter().map(|&x| [x, near]));
            vertices.extend(breaks.iter().enumerate().map(|(k, &x)| [x + moved(k), far]));
            for k in first..first + count - 1 {
                let cell = [k, k + 1, k + 1 + count, k + count];
                let [a, b, c, d] = cell;
                if i == 0 {
                    triangles.extend([[a, d, c], [a, c, b]]);
                } else {
                    triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
            let side = |from: usize| (from..from + count - 1).map(|k| [k, k + 1]).collect();
            let edges: [Vec<[usize; 2]>; 2] = [side(first), side(first + count)];
            for (name, edges) in ["near", "far"].into_iter().zip(edges) {
                named.push((format!("{name}{i}"), edges));
            }
            members.push((own..triangles.len()).collect());
        }
        let pair = Pair::new("near0", "near1").with_law(self.law);
        let count = triangles.len();
        let mesh = Mesh::with_pairs(vertices, triangles, named, std::slice::from_ref(&pair))
            .map_err(text)?;
        let materials = self
            .moduli
            .map(|[lambda, mu]| Material::lame(f64::from(lambda), f64::from(mu), Plane::Strain));
        let parts = materials.into_iter().zip(members.iter().map(Vec::as_slice));
        let materials = Materials::in_parts(materials[0], count, parts);
        Ok(Problem::of(mesh, materials)
            .with_pair(pair)
            .with("far0", Condition::clamped())
            .with("far1", Condition::clamped()))
    }

    fn field(&self, nodes: usize) -> Vec<[Exact; 2]> {
        let value = |k: usize| self.values[k % self.values.len()].map(Exact::from);
        // Nodes beyond the list have other multiples of its values.
        (0..nodes)
            .map(|k| value(k).map(|v| v * Exact::from(1 + (k / self.values.len()) as i32)))
            .collect()
    }
}

/// A mistake that is planted in the pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    None,
    /// The second body's points are moved along its edge.
    NotCentral,
    /// Each piece counts three times.
    Thrice,
}

fn planted(d: &Discretization, mistake: Mistake) -> Vec<Piece<Exact>> {
    let one = |piece: &Piece| {
        let mut geometry: PieceGeometry = (*piece.geometry).clone();
        if mistake == Mistake::NotCentral {
            geometry.stretches[1].positions.iter_mut().for_each(|s| *s += 1.0 / 32.0);
        }
        exact_piece::<Exact>(d, &Piece { geometry: Arc::new(geometry), ..piece.clone() })
    };
    let times = if mistake == Mistake::Thrice { 3 } else { 1 };
    d.contact.iter().flat_map(|piece| vec![one(piece); times]).collect()
}

fn with_discretization(
    draw: &Draw,
    degree: Degree,
    work: impl FnOnce(&Discretization) -> Verdict,
) -> Verdict {
    let Ok(problem) = draw.problem() else { return Verdict::Fails("the mesh is refused") };
    let method = Method { degree, gamma0: Gamma0::Local(0.5), ..Method::default() };
    match discretize(&problem, &method) {
        Ok(d) => work(&d),
        Err(_) => Verdict::Fails("the problem is refused"),
    }
}

/// Whether nodes of one body are inside edges of the other.
fn class(draw: &Draw) -> &'static str {
    let [a, b] = [0, 1].map(|i| breaks(&draw.halved[i]));
    if a == b { "matching" } else { "not matching" }
}

const CLASSES: [&str; 2] = ["matching", "not matching"];

/// P0 of a motion of both bodies is 0 along the direction of contact, and forces through these functionals cancel.
fn balanced(draw: &Draw, degree: Degree, mistake: Mistake) -> Verdict {
    with_discretization(draw, degree, |d| {
        let (zero, one) = (Exact::from(0), Exact::from(1));
        let nodes: Vec<[Exact; 2]> =
            d.space.nodes().iter().map(|x| x.map(Exact::of_double)).collect();
        let motions: [&dyn Fn([Exact; 2]) -> [Exact; 2]; 3] =
            [&|_| [one, zero], &|_| [zero, one], &|[x, y]| [-y, x]];
        let along = degree.nodes_per_edge();
        for piece in planted(d, mistake) {
            for motion in motions {
                let field: Vec<[Exact; 2]> = nodes.iter().map(|&x| motion(x)).collect();
                ensure!(piece.p0(&field)[..along].iter().all(|&jump| jump == zero));
            }
            let mut factors = vec![zero; piece.p0.len()];
            for (factor, &(n, d)) in factors[..along].iter_mut().zip(&draw.factors) {
                *factor = Exact::ratio(n, d);
            }
            let mut forces = vec![[zero; 2]; nodes.len()];
            piece.add_contact(&factors, &mut forces);
            let sum = |of: &dyn Fn([Exact; 2], [Exact; 2]) -> Exact| {
                nodes.iter().zip(&forces).fold(zero, |sum, (&x, &f)| sum + of(x, f))
            };
            ensure!(sum(&|_, f| f[0]) == zero);
            ensure!(sum(&|_, f| f[1]) == zero);
            ensure!(sum(&|x, f| x[0] * f[1] - x[1] * f[0]) == zero);
        }
        Verdict::Holds(class(draw))
    })
}

/// int Gamma s(v)^2 <= kappa a(v, v), by the loops of the solver.
fn bounded(draw: &Draw, degree: Degree, mistake: Mistake) -> Verdict {
    with_discretization(draw, degree, |d| {
        let zero = Exact::from(0);
        let pieces = planted(d, mistake);
        // Any field; and the one with the same stress along the direction of contact in all triangles, and no strain across it.
        let uniform = || {
            let mut field = vec![[zero; 2]; d.space.nodes().len()];
            for (t, nodes) in d.space.elements().enumerate() {
                let material = d.problem.material.of(t);
                let stiffness = Exact::of_double(material.lambda() + 2.0 * material.mu());
                for &node in nodes {
                    field[node] = [zero, Exact::of_double(d.space.nodes()[node][1]) / stiffness];
                }
            }
            field
        };
        for u in [draw.field(d.space.nodes().len()), uniform()] {
            let mut forces = vec![[zero; 2]; u.len()];
            add_internal_forces(&d.space, &d.problem.material, &u, &mut forces);
            let energy =
                forces.iter().zip(&u).fold(zero, |sum, (f, u)| sum + f[0] * u[0] + f[1] * u[1]);
            let subtracted = pieces.iter().fold(zero, |sum, piece| sum + piece.squared_stress(&u));
            // kappa is a double, with some roundings.
            let kappa = Exact::of_double(d.kappa() * (1.0 + 1e-14));
            ensure!(subtracted <= kappa * energy);
        }
        Verdict::Holds(class(draw))
    })
}

type Predicate = fn(&Draw, Degree, Mistake) -> Verdict;

fn hold(predicate: Predicate) -> Outcome {
    let of = |cases: u32, degree: Degree| {
        draws::hold(cases, pairs(), &CLASSES, |draw| predicate(draw, degree, Mistake::None))
    };
    Ok(format!("{}; P2: {}", of(20, Degree::One)?, of(5, Degree::Two)?))
}

fn reject(predicate: Predicate, mistake: Mistake) -> Outcome {
    let of = |degree: Degree| {
        draws::reject(pairs(), |draw| {
            let without = predicate(draw, degree, Mistake::None);
            if without.fails() { Verdict::Vacuous } else { predicate(draw, degree, mistake) }
        })
    };
    Ok(format!("{}; P2: {}", of(Degree::One)?, of(Degree::Two)?))
}

/// The row of pairs.
pub fn claim() -> Claim {
    Claim {
        id: "17",
        title: "Two deformable bodies",
        paper: "\"The extension to two elastic bodies in contact can be easily made, at least for small strain models\": (8) with the jump of the displacements and one weighted stress (`docs/theory.md`, 12).",
        limits: "Pieces, directions and gaps on curved interfaces are taken as found; the search for partners is tested in the program.",
        checks: [
            statements! {
                proved + tested a_law_is_one_equation[y, sigma, gamma];
                proved + tested q_of_every_law_is_firmly_nonexpansive[a, b];
                proved + tested identity_c_holds_at_a_point[y_u, y_v, sigma, tau];
                proved + tested one_weighted_flux_costs_no_more_than_that_of_each_body[gamma_1, gamma_2, s_1, s_2];
                refuted control_bodies_in_contact_pull[y, sigma, gamma]
                    fails "is_law(Response::Unilateral, y, sigma)";
                refuted control_identity_c_without_the_law_of_the_solution[y_u, y_v, sigma, tau]
                    fails "g - a - b == (sigma - tau) * (y_u - y_v)";
                refuted control_equal_weights_for_unequal_bodies[gamma_1, gamma_2, s_1, s_2]
                    fails "flux * flux <= (gamma_1 + gamma_2) * squares";
            },
            vec![
                exact!("forces_and_moments_of_both_sides_cancel_on_meshes_that_do_not_match", in balanced, draws 25 => hold(balanced)),
                exact!("the_stress_that_a_pair_subtracts_is_at_most_kappa_times_the_energy", in bounded, draws 25 => hold(bounded)),
                exact!("control_points_that_do_not_face_each_other", at balanced => reject(balanced, Mistake::NotCentral)),
                exact!("control_pieces_of_a_pair_that_count_three_times", at bounded => reject(bounded, Mistake::Thrice)),
            ],
        ]
        .concat(),
    }
}
