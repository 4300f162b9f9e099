//! Lemma 3.1 at a solution that is no polynomial anywhere: the end of contact, u = O(r^(3/2)), in H^s for s < 5/2 only.
//!
//! The residual of the discrete equations at the exact u,
//!
//! int sigma(u):eps(v) - int_N t . v - int_C gamma sigma_n(u) sigma_n(v) + int_C (1/gamma) \[P(u)\]+ P0(v),
//!
//! is enclosed for every basis function v of P1 and of P2 (f = 0): the formulas of `study::exact::Singular`, the same source
//! lines that the solver runs in doubles, are run over Taylor coefficients with intervals, so are the kernel's P and \[.\]+,
//! and the kernel's shape functions and functionals over intervals. The singular point lies inside a contact edge.

use std::sync::Arc;

use crate::numbers::Interval;
use proptest::prelude::*;
use signorini::fem::{
    BoundaryEdge, Degree, Diagonal, Mesh, Problem, Rectangle, Space, contact_line, loads,
};
use signorini::kernel::element::Element;
use signorini::kernel::{
    ContactEdge, ContactPoint, Enclosing, Material, P1, P2, Plane, Stress, Triangle, positive_part,
};
use signorini::nalgebra::{Matrix2, Vector2};
use signorini::study::exact::{self, ExactSolution, Kind, Place, Singular};

use crate::claim::Outcome;
use crate::draws;
use crate::enclosure::{Taylor, mean};
use crate::ensure;
use crate::verdict::Verdict;

/// How well the share of each piece in a mean is known, in units of the amplitude.
const SHARE: f64 = 5e-7;

/// The same for the controls, which wider enclosures reject already.
const COARSE_SHARE: f64 = 1e-4;

/// How many bodies are drawn: each takes thousands of pieces.
const CASES: u32 = 2;

/// The widest enclosure of a residual, relative to the largest term of any of them.
const NARROW: f64 = 1e-3;

/// The solver's quadrature error of L, relative to its largest entry: by its own rule, and by one with 40 points.
const LOAD: f64 = 1e-3;
const FINE_LOAD: f64 = 1e-12;

/// The plain data of a body with the singular solution.
#[derive(Clone, Debug)]
struct Draw {
    moduli: [f64; 2],
    plane_stress: bool,
    c: f64,
    amplitude: f64,
    gamma0: f64,
    diagonal: usize,
    seed: u64,
    share: f64,
}

fn draws() -> impl Strategy<Value = Draw> {
    ((-0.3..4.0, 0.5..3.0, any::<bool>()), 0.3..0.7, 0.2..5.0, 0.01..2.0, 0_usize..3, any::<u64>())
        .prop_map(|((lambda, mu, plane_stress), c, amplitude, gamma0, diagonal, seed)| Draw {
            moduli: [lambda, mu],
            plane_stress,
            c,
            amplitude,
            gamma0,
            diagonal,
            seed,
            share: SHARE,
        })
}

/// A planted mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    None,
    /// Without int (1/gamma) \[P(u)\]+ P0(v).
    NoContactTerm,
    /// Without - int gamma sigma_n(u) sigma_n(v).
    NoStressProduct,
    /// P0(v) with theta = -1, the rest of the method with theta = 1.
    ThetaInOnePlace,
    /// 1/gamma halved, the other gammas as they are.
    GammaInOnePlace,
    /// sigma_n of the wrong sign in P(u).
    SignOfStress,
    /// An obstacle that is nearer by a hundredth.
    ObstacleMoved,
    /// L with the tractions of the wrong sign.
    SignOfLoad,
    /// A tension where there should be pressure.
    Tension,
    /// The solver's L is off by a hundredth, the residual as it is.
    OtherLoad,
}

fn point(value: f64) -> Interval {
    Interval::point(value)
}

fn constant(value: f64) -> Taylor {
    Taylor::constant(point(value))
}

impl Draw {
    /// How well the share of each piece in a mean is known.
    fn tolerance(&self) -> f64 {
        self.share * self.amplitude.abs()
    }

    fn material<S: Enclosing>(&self, of: fn(f64) -> S) -> Material<S> {
        let [lambda, mu] = self.moduli.map(of);
        let plane = if self.plane_stress { Plane::Stress } else { Plane::Strain };
        Material::lame(lambda, mu, plane)
    }

    fn solution<S: Enclosing>(&self, of: fn(f64) -> S) -> Singular<S> {
        Singular { material: self.material(of), c: of(self.c), amplitude: of(self.amplitude) }
    }

    /// The unit square on 2 x 1 cells, vertices moved along the sides; given displacement on top, tractions beside.
    fn problem(&self) -> Problem {
        let diagonal = [Diagonal::Left, Diagonal::Right, Diagonal::Crossed][self.diagonal];
        let square = Rectangle { width: 1.0, height: 1.0, nx: 2, ny: 1, diagonal };
        let mesh = square.perturbed(0.2, self.seed).expect("a mesh");
        let solution: exact::Exact = Arc::new(self.solution(|x| x));
        let kinds = [
            ("bottom", Kind::Contact),
            ("left", Kind::Traction),
            ("right", Kind::Traction),
            ("top", Kind::Displacement),
        ];
        exact::problem(&solution, mesh, &kinds.map(|(n, k)| (n.to_owned(), k)).into())
    }
}

/// The place of a point; where the singular point is not excluded, all that is known is 0 <= y <= r and |z^(1/2)|^2 = r.
fn place(solution: &Singular<Taylor>, [x, y]: [Taylor; 2]) -> Place<Taylor> {
    let x = x - solution.c;
    if x.value().contains(0.0) && y.value().contains(0.0) {
        let r = (x.value() * x.value() + y.value() * y.value()).sqrt();
        let root = Taylor::range(Interval::new(0.0, r.sqrt().hi()));
        let over_r = Taylor::range(Interval::new(0.0, 1.0));
        Place { x, y, over_r, cos: root, sin: root }
    } else {
        Place::new(x, y)
    }
}

/// sigma(u) with the displacement.
fn field(solution: &Singular<Taylor>, x: [Taylor; 2]) -> ([Taylor; 2], Stress<Taylor>) {
    let place = place(solution, x);
    let stress = solution.material.stress(solution.gradient_at(&place));
    (solution.displacement_at(&place), stress)
}

/// The corners of a triangle with their barycentric coordinates.
fn corners(mesh: &Mesh, t: usize) -> [[Interval; 5]; 3] {
    let unit = |k: usize, i: usize| Interval::from(i32::from(i == k));
    let vertices = mesh.triangle(t).vertices;
    [0, 1, 2].map(|k| {
        let [x, y] = vertices[k].map(point).into();
        [x, y, unit(k, 0), unit(k, 1), unit(k, 2)]
    })
}

/// The ends of an edge with s = 0 and 1.
fn ends(mesh: &Mesh, edge: BoundaryEdge) -> [[Interval; 3]; 2] {
    let vertices = mesh.ends(edge).map(|v| mesh.vertices()[v].map(point));
    [0, 1].map(|k| [vertices[k][0], vertices[k][1], Interval::from(k as i32)])
}

fn in_intervals(triangle: Triangle<f64>) -> Triangle<Interval> {
    Triangle { vertices: triangle.vertices.map(|x| x.map(point)) }
}

/// For each triangle the integrals of xx, yy, xy of sigma(u) times each barycentric coordinate.
fn stress_moments(mesh: &Mesh, solution: &Singular<Taylor>, tolerance: f64) -> Vec<[Interval; 9]> {
    let of_triangle = |t: usize| {
        let area = in_intervals(mesh.triangle(t)).double_area() / Interval::from(2);
        let means = mean(corners(mesh, t), tolerance, |[x, y, l0, l1, l2]| {
            let stress = field(solution, [x, y]).1.components();
            let l = [l0, l1, l2];
            std::array::from_fn(|i| stress[i % 3] * l[i / 3])
        });
        means.map(|m| area * m)
    };
    (0..mesh.triangles().len()).map(of_triangle).collect()
}

/// A functional at every basis function, with the magnitudes of its terms.
struct Enclosed {
    values: Vec<[Interval; 2]>,
    largest_term: f64,
}

impl Enclosed {
    fn new(nodes: usize) -> Self {
        Enclosed { values: vec![[Interval::from(0); 2]; nodes], largest_term: 0.0 }
    }

    fn add(&mut self, node: usize, c: usize, term: Interval) {
        self.values[node][c] += term;
        self.largest_term = self.largest_term.max(term.lo().abs()).max(term.hi().abs());
    }

    /// The width of the widest, relative to the largest term.
    fn width(&self) -> f64 {
        let widths = self.values.as_flattened().iter().map(|i| i.hi() - i.lo());
        widths.fold(0.0, f64::max) / self.largest_term
    }
}

/// a(u, v) for every basis function, from the moments of the stress: grad v is affine, so its values at the vertices do.
fn internal_forces<E: Element<N, M>, const N: usize, const M: usize>(
    space: &Space,
    moments: &[[Interval; 9]],
    sum: &mut Enclosed,
) {
    for (t, (triangle, nodes)) in space.triangles::<N>().enumerate() {
        let barycentric = in_intervals(triangle).barycentric_gradients();
        for vertex in 0..3 {
            let l = [0, 1, 2].map(|i| Interval::from(i32::from(i == vertex)));
            let [xx, yy, xy] = [0, 1, 2].map(|i| moments[t][3 * vertex + i]);
            for (&node, g) in nodes.iter().zip(E::gradients(l, barycentric)) {
                sum.add(node, 0, xx * g.x + xy * g.y);
                sum.add(node, 1, xy * g.x + yy * g.y);
            }
        }
    }
}

/// L(v) for every basis function: the tractions beside.
fn load<E: Element<N, M>, const N: usize, const M: usize>(
    space: &Space,
    solution: &Singular<Taylor>,
    tolerance: f64,
) -> Enclosed {
    let mut sum = Enclosed::new(space.nodes().len());
    for (name, outward) in [("left", -1), ("right", 1)] {
        for &edge in space.mesh().edges_of(name).expect("a side") {
            let [start, end] = ends(space.mesh(), edge);
            let length = positive_part(end[1] - start[1]) + positive_part(start[1] - end[1]);
            let means: [Interval; 6] = mean([start, end], tolerance, |[x, y, s]| {
                let n = Vector2::new(Taylor::from(outward), Taylor::from(0));
                let traction = field(solution, [x, y]).1.traction(n);
                let shapes: [Taylor; M] = E::edge_values(s);
                std::array::from_fn(|i| match shapes.get(i / 2) {
                    Some(&shape) => traction[i % 2] * shape,
                    None => Taylor::from(0),
                })
            });
            for (a, node) in space.edge_nodes(edge).into_iter().enumerate() {
                for c in 0..2 {
                    sum.add(node, c, length * means[2 * a + c]);
                }
            }
        }
    }
    sum
}

/// The contact terms. `false` where the solver's functionals are not inside those over intervals.
fn contact_terms<E: Element<N, M>, const N: usize, const M: usize>(
    space: &Space,
    problem: &Problem,
    draw: &Draw,
    solution: &Singular<Taylor>,
    mistake: Mistake,
    sum: &mut Enclosed,
) -> bool {
    let material = draw.material(point);
    let mut inside = true;
    let line = contact_line::assemble(problem, space, draw.gamma0).expect("a contact line");
    for side in &line {
        let mesh = space.mesh();
        let triangle = in_intervals(mesh.triangle(side.edge.triangle));
        let gamma = point(side.gamma);
        let new = |gamma: Interval| -> ContactEdge<Interval, N, M> {
            ContactEdge::new::<E>(
                &triangle,
                side.edge.local,
                side.normal.map(point),
                &material,
                gamma,
            )
        };
        let functionals = new(gamma);
        let contains = |over: &[Vector2<Interval>], double: &[Vector2<f64>]| {
            over.iter().flatten().zip(double.iter().flatten()).all(|(i, &x)| i.contains(x))
        };
        inside &= (0..M).all(|a| contains(&functionals.p0[a], side.functionals.p0()[a]));
        inside &= (0..2).all(|a| contains(&functionals.sigma_n[a], side.functionals.sigma_n()[a]));
        let p0 = if mistake == Mistake::ThetaInOnePlace { new(-gamma).p0 } else { functionals.p0 };
        let means: [Interval; 5] = mean(ends(mesh, side.edge), draw.tolerance(), |[x, y, s]| {
            let n = side.normal.map(constant);
            let (u, stress) = field(solution, [x, y]);
            let sigma_n = stress.normal(n);
            let here = ContactPoint {
                u_n: u[0] * n[0] + u[1] * n[1],
                gap: constant(if mistake == Mistake::ObstacleMoved { -0.01 } else { 0.0 }),
                sigma_n: if mistake == Mistake::SignOfStress { -sigma_n } else { sigma_n },
                gamma: Taylor::constant(gamma),
            };
            let positive = positive_part(here.p()) / here.gamma;
            let shapes: [Taylor; M] = E::edge_values(s);
            std::array::from_fn(|i| match i {
                0 => sigma_n * (Taylor::from(1) - s),
                1 => sigma_n * s,
                _ => shapes.get(i - 2).map_or(Taylor::from(0), |&shape| positive * shape),
            })
        });
        let [start, end] = ends(mesh, side.edge);
        let length = end[0] - start[0];
        let weight = match mistake {
            Mistake::GammaInOnePlace => point(0.5),
            _ => Interval::from(1),
        };
        for (j, &node) in space.nodes_of(side.edge.triangle).iter().enumerate() {
            for c in 0..2 {
                for (mean, sigma_n) in means.iter().zip(functionals.sigma_n) {
                    if mistake != Mistake::NoStressProduct {
                        sum.add(node, c, -(gamma * length * *mean * sigma_n[j][c]));
                    }
                }
                for (mean, p0) in means[2..].iter().zip(p0) {
                    if mistake != Mistake::NoContactTerm {
                        sum.add(node, c, weight * length * *mean * p0[j][c]);
                    }
                }
            }
        }
    }
    inside
}

/// The singular point lies inside a contact edge.
fn inside_an_edge(mesh: &Mesh, c: f64) -> bool {
    let edges = mesh.edges_of("bottom").unwrap_or_default();
    edges.iter().any(|&edge| {
        let [a, b] = mesh.ends(edge).map(|v| mesh.vertices()[v][0]);
        a < c && c < b
    })
}

/// Every v that is zero on Gamma_D.
fn vanishes_for<E: Element<N, M>, const N: usize, const M: usize>(
    draw: &Draw,
    problem: &Problem,
    moments: &[[Interval; 9]],
    solution: &Singular<Taylor>,
    mistake: Mistake,
) -> Verdict {
    let space = Space::new(&problem.mesh, if N == 3 { Degree::One } else { Degree::Two });
    let mut residual = Enclosed::new(space.nodes().len());
    internal_forces::<E, N, M>(&space, moments, &mut residual);
    ensure!(contact_terms::<E, N, M>(&space, problem, draw, solution, mistake, &mut residual));
    let load = load::<E, N, M>(&space, solution, draw.tolerance());
    for (node, values) in load.values.iter().enumerate() {
        for (c, &value) in values.iter().enumerate() {
            let term = if mistake == Mistake::SignOfLoad { value } else { -value };
            residual.add(node, c, term);
        }
    }
    let tops = problem.mesh.edges_of("top").unwrap_or_default();
    let fixed: Vec<usize> = tops.iter().flat_map(|&edge| space.edge_nodes(edge)).collect();
    let free = (0..space.nodes().len()).filter(|node| !fixed.contains(node));
    let narrow = NARROW * (draw.share / SHARE);
    ensure!(residual.width() <= narrow && load.width() <= narrow);
    for node in free {
        ensure!(residual.values[node].iter().all(|r| r.contains(0.0)));
    }
    // The solver's own load.
    for (assembled, error) in [
        (loads::assemble(problem, &space), LOAD),
        (loads::assemble_with(problem, &space, |_| 40), FINE_LOAD),
    ] {
        let mut assembled = assembled.expect("a load");
        if mistake == Mistake::OtherLoad {
            assembled.as_flattened_mut().iter_mut().for_each(|l| *l *= 1.01);
        }
        let size = assembled.as_flattened().iter().fold(0.0, |max: f64, l| max.max(l.abs()));
        let around = Interval::new(-error * size, error * size);
        for (&found, &enclosed) in assembled.as_flattened().iter().zip(load.values.as_flattened()) {
            ensure!((enclosed + around).contains(found));
        }
    }
    Verdict::Holds("contact and gap on one edge")
}

fn consistent(draw: &Draw, mistake: Mistake) -> Verdict {
    let mut draw = draw.clone();
    if mistake == Mistake::Tension {
        draw.amplitude = -draw.amplitude;
    }
    let problem = draw.problem();
    ensure!(inside_an_edge(&problem.mesh, draw.c));
    let solution = draw.solution(constant);
    let moments = stress_moments(&problem.mesh, &solution, draw.tolerance());
    match vanishes_for::<P1, 3, 2>(&draw, &problem, &moments, &solution, mistake) {
        Verdict::Holds(_) => {
            vanishes_for::<P2, 6, 3>(&draw, &problem, &moments, &solution, mistake)
        }
        other => other,
    }
}

/// The residual at the exact solution is enclosed around zero, and narrowly.
pub fn residual_contains_zero() -> Outcome {
    draws::hold(CASES, draws(), &["contact and gap on one edge"], |d| consistent(d, Mistake::None))
}

/// A mistake for which `conclusion` fails, and not another one.
fn rejected(mistake: Mistake, conclusion: &str) -> Outcome {
    let coarse = draws().prop_map(|draw| Draw { share: COARSE_SHARE, ..draw });
    draws::reject(coarse, |draw| match consistent(draw, mistake) {
        Verdict::Fails(why) if why.contains(conclusion) => Verdict::Fails(why),
        _ => Verdict::Vacuous,
    })
}

/// The solver's L is not inside the enclosure.
pub fn load_off_by_a_hundredth() -> Outcome {
    rejected(Mistake::OtherLoad, "contains(found)")
}

macro_rules! rejections {
    ($($(#[$doc:meta])* $name:ident $mistake:ident),* $(,)?) => {
        $($(#[$doc])*
        pub fn $name() -> Outcome {
            rejected(Mistake::$mistake, "contains(0.0)")
        })*
    };
}

rejections! {
    /// Without the contact term.
    without_the_contact_term NoContactTerm,
    /// Without the product of the stresses.
    without_the_stress_product NoStressProduct,
    /// theta = -1 in P0(v) only.
    theta_in_one_place ThetaInOnePlace,
    /// gamma doubled before \[P(u)\]+ only.
    gamma_doubled_in_one_place GammaInOnePlace,
    /// P(u) = u_n + gamma sigma_n.
    wrong_sign_of_the_stress SignOfStress,
    /// An obstacle that is too near.
    obstacle_too_near ObstacleMoved,
    /// L of the wrong sign.
    wrong_sign_of_the_load SignOfLoad,
    /// A field with (1) but without (2).
    tension_on_the_contact_line Tension,
}

/// Which formula is checked with a planted mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Formula {
    AsItIs,
    /// The gradient transposed.
    Transposed,
    /// Stresses of a material with another lambda.
    OtherMaterial,
}

/// a - b is zero, as far as is known, and that is well known.
fn equal(a: Interval, b: Interval, size: f64) -> bool {
    let d = a - b;
    d.contains(0.0) && d.hi() - d.lo() <= 1e-9 * size
}

/// (1) at a point, the gradient there, and the doubles of the solver.
fn formulas(draw: &Draw, x: [f64; 2], formula: Formula) -> Verdict {
    let transposed = |g: Matrix2<Interval>| match formula {
        Formula::Transposed => g.transpose(),
        _ => g,
    };
    // The solver's doubles, by the same lines over intervals.
    let (doubles, over) = (draw.solution(|x| x), draw.solution(point));
    let place = Place::new(point(x[0]) - over.c, point(x[1]));
    let (u, gradient) = (over.displacement_at(&place), transposed(over.gradient_at(&place)));
    let stress = over.material.stress(gradient);
    let found = doubles.stress(x);
    ensure!(u.iter().zip(doubles.displacement(x)).all(|(u, d)| u.contains(d)));
    ensure!(stress.matrix().iter().zip(found.matrix()).all(|(s, d)| s.contains(*d)));
    ensure!(gradient.iter().zip(&doubles.gradient(x)).all(|(g, d)| g.contains(*d)));
    // Their derivatives.
    let solution = draw.solution(constant);
    let [x0, y0] = Taylor::variables(x.map(point));
    let here = Place::new(x0 - solution.c, y0);
    let r = (x[0] - draw.c).hypot(x[1]);
    let steep = draw.amplitude / (draw.moduli[1] * r.powf(1.5));
    let derivatives = solution.displacement_at(&here).map(Taylor::gradient);
    for (derived, given) in derivatives.iter().zip(gradient.row_iter()) {
        ensure!(equal(derived[0], given[0], steep) && equal(derived[1], given[1], steep));
    }
    let of = match formula {
        Formula::OtherMaterial => Material::lame(constant(5.0), constant(0.4), Plane::Strain),
        _ => solution.material,
    };
    let stress = of.stress(solution.gradient_at(&here));
    let [xx, yy, xy] = stress.components().map(Taylor::gradient);
    let stiff = steep * (1.0 + draw.moduli[0].abs() + draw.moduli[1]);
    ensure!(equal(xx[0], -xy[1], stiff) && equal(xy[0], -yy[1], stiff));
    Verdict::Holds(if x[0] < draw.c { "over the contact" } else { "over the gap" })
}

fn places() -> impl Strategy<Value = (Draw, [f64; 2])> {
    (draws(), [0.0_f64..1.0, 0.001..1.0])
}

/// (1), the gradient, and the doubles of the solver.
pub fn formulas_are_those_of_a_solution() -> Outcome {
    draws::hold(300, places(), &["over the contact", "over the gap"], |(draw, x)| {
        formulas(draw, *x, Formula::AsItIs)
    })
}

/// A transposed gradient is not that of the displacement.
pub fn transposed_gradient() -> Outcome {
    draws::reject(places(), |(draw, x)| formulas(draw, *x, Formula::Transposed))
}

/// With the stresses of another material (1) does not hold.
pub fn stresses_of_another_material() -> Outcome {
    draws::reject(places(), |(draw, x)| formulas(draw, *x, Formula::OtherMaterial))
}

/// (2) on y = 0: the signs at all places but those nearer to the singular point than 2^-40, the shear at one place.
fn conditions(draw: &Draw, x: f64) -> Verdict {
    let solution = draw.solution(point);
    let zero = Interval::from(0);
    let at = |x: Interval| {
        let place = Place::new(x, zero);
        let stress = solution.material.stress(solution.gradient_at(&place));
        let [_, yy, xy] = stress.components();
        (-solution.displacement_at(&place)[1], yy, xy)
    };
    // On pieces short enough to keep the signs for every material: an eighth of what lies between two powers of 2.
    for piece in 0..8 * 40 {
        let (k, eighths) = (piece / 8, f64::from(piece % 8));
        let start = 0.5_f64.powi(k + 1);
        let x = Interval::new(start * (1.0 + eighths / 8.0), start * (1.0 + (eighths + 1.0) / 8.0));
        let (u_n, sigma_n, _) = at(x);
        ensure!(u_n.hi() < 0.0 && sigma_n == zero);
        let (u_n, sigma_n, _) = at(-x);
        ensure!(u_n == zero && sigma_n.hi() < 0.0);
    }
    let (_, _, shear) = at(point(x) - point(draw.c));
    let stiffness = 1.0 + draw.moduli[0].abs() / draw.moduli[1];
    ensure!(equal(shear, zero, draw.amplitude.abs() * stiffness));
    Verdict::Holds("contact and gap")
}

/// Conditions (2) along the contact line.
pub fn conditions_2_hold() -> Outcome {
    let data = (draws(), 0.0_f64..1.0);
    draws::hold(50, data, &["contact and gap"], |(draw, x)| conditions(draw, *x))
}

/// A negative amplitude.
pub fn conditions_2_under_tension() -> Outcome {
    draws::reject((draws(), 0.0_f64..1.0), |(draw, x)| {
        conditions(&Draw { amplitude: -draw.amplitude, ..draw.clone() }, *x)
    })
}
