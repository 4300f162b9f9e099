//! What contact alone holds (`proof::pressed`, docs/a-posteriori.md, 7.5), on a square with one contact edge:
//!
//! - a piece that is taken for pressed is pressed all along, and stays so on the ball for which it is said to: moved to its
//!   border by the fields whose P0 is largest at an end of a pressed edge beside |v|_S;
//! - the bounds of n . v at the ends of the edge, or at the points of a Gauss rule, hold for all v, by the inverse of the matrix
//!   of |v|_S;
//! - its springs are those of P0(v)^2 / gamma;
//! - where nothing that is pressed stops a motion, all displacements up to the next obstacle are solutions, and no others.

use approx::abs_diff_eq;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use signorini::contact::contact_line::Coercivity;
use signorini::contact::{Discretization, EdgeRule, Piece};
use signorini::kernel::PreciseBall;
use signorini::kernel::contact_edge::integral_of_product;
use signorini::kernel::{self, Material, Plane};
use signorini::model::Degree;
use signorini::model::quadrature::gauss;
use signorini::model::{Diagonal, Problem, Rectangle};
use signorini::proof::balls::Lines;
use signorini::proof::korn::Term;
use signorini::proof::pressed::Pressed;
use signorini::solve::{Method, Settings, solve};

use props::claim::{Outcome, text};
use props::draws;
use props::problems::{cells, constant, floor, mapped, problem};
use props::proof::sampler::Random;

/// A square on its floor under its weight.
fn square() -> Result<Problem, String> {
    let mesh = cells([1, 1], Diagonal::Right).mesh().map_err(text)?;
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    Ok(problem(mesh, material, [0.0, -1.0].map(constant), [("bottom", floor(0.0))]))
}

/// A displacement, and what is known of it.
struct At<'a, 'p> {
    d: &'a Discretization<'p>,
    lines: Lines<'a>,
}

fn balls(u: &[[f64; 2]]) -> Vec<[PreciseBall; 2]> {
    u.iter().map(|u| u.map(PreciseBall::from)).collect()
}

impl<'a, 'p> At<'a, 'p> {
    fn new(d: &'a Discretization<'p>) -> Self {
        At { d, lines: Lines::new(d) }
    }

    fn edge(&self) -> &'a Piece {
        &self.d.contact[0]
    }

    fn pressed(&self, u: &[[f64; 2]]) -> Pressed {
        Pressed::at(self.d, &self.lines, &balls(u), 0.0)
    }

    /// P at the nodes of the edge. There is no gap: it is P0.
    fn p(&self, u: &[[f64; 2]]) -> Vec<f64> {
        self.edge().p(u)
    }

    /// Whether it is positive at fifty places of each piece that is taken for pressed.
    fn is_positive(p: &[f64], pressed: &Pressed) -> bool {
        let places = |[a, b]: [f64; 2]| (0..=50).map(move |k| a + (b - a) * f64::from(k) / 50.0);
        let mut places = pressed.pieces(0).iter().copied().flat_map(places);
        places.all(|s| degree(p).value_at(p, s) > 0.0)
    }

    /// The field that has these values of n . v at the nodes of the edge, and is 0 elsewhere.
    fn field(&self, values: Vec<f64>) -> Vec<[f64; 2]> {
        let mut v = vec![[0.0; 2]; self.d.space.nodes().len()];
        for (node, value) in self.d.space.edge_nodes(self.edge().edge()).zip(values) {
            v[node][1] = -value;
        }
        v
    }

    /// |E| / gamma int P0(v)^2, by the rule of the method; the exact one by three points.
    fn springs(&self, v: &[[f64; 2]]) -> f64 {
        let p = self.p(v);
        let rule = match &self.d.rule {
            EdgeRule::Exact => gauss(3),
            EdgeRule::Gauss(points) => points.clone(),
        };
        let rule = rule.into_iter();
        let square = |s| self.edge().degree.value_at(&p, s).powi(2);
        self.edge().weight() * rule.map(|(s, w)| w * square(s)).sum::<f64>()
    }

    /// |v|_S^2
    fn square(&self, v: &[[f64; 2]]) -> f64 {
        let sigma = self.edge().sigma_n(v);
        let stress = self.edge().gamma * self.edge().length * integral_of_product(sigma, sigma);
        self.d.strain_energy(v) - stress + self.springs(v)
    }

    /// The largest radius on which the edge is said to stay pressed.
    fn radius(pressed: &Pressed) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        while pressed.stay(high) && high < 1e300 {
            high *= 2.0;
        }
        for _ in 0..200 {
            let middle = (low + high) / 2.0;
            if pressed.stay(middle) { low = middle } else { high = middle }
        }
        low
    }
}

/// The degree of a polynomial on an edge with so many nodes.
fn degree(p: &[f64]) -> Degree {
    if p.len() == 2 { Degree::One } else { Degree::Two }
}

/// The polynomials of degree 1 and 2 that are 1 at the start and have the least mean square: by their values at the nodes.
const STEEPEST: [f64; 3] = [1.0, -0.5, 0.0];
const STEEPEST_OF_2: [f64; 3] = [1.0, 1.0 / 3.0, -1.0 / 6.0];

fn stays_on(degree: Degree, rule: EdgeRule, times: f64) -> Result<[usize; 2], String> {
    let problem = square()?;
    // Springs beside which the body is soft: what moves P most is their own field.
    let d = Discretization::new(&problem, degree, |c| 1e-9 * c.limit(), rule).map_err(text)?;
    let at = At::new(&d);
    let nodes = degree.nodes_per_edge();
    let steepest = if degree == Degree::One { STEEPEST } else { STEEPEST_OF_2 };
    let mut random = Random::new(draws::seed());
    let mut seen = [0, 0];
    for draw in 0..400 {
        let mut value = || match draw {
            0 => 1.0,
            _ => (4.0 * super::share(&mut random) - 1.0).powi(3),
        };
        let u = at.field((0..nodes).map(|_| value()).collect());
        let p = at.p(&u);
        let pressed = at.pressed(&u);
        if !pressed.edges().any(|is| is) {
            seen[0] += 1;
            continue;
        }
        seen[1] += 1;
        let rho = times * At::radius(&pressed);
        for turned in [false, true] {
            let mut values: Vec<f64> = steepest[..nodes].iter().map(|v| -v).collect();
            if turned {
                values.swap(0, 1);
            }
            let v = at.field(values);
            let share = rho / at.square(&v).sqrt();
            let there: Vec<f64> = p.iter().zip(at.p(&v)).map(|(p, v)| p + share * v).collect();
            if ![&p, &there].into_iter().all(|p| At::is_positive(p, &pressed)) {
                return Err(format!("P = {p:?}, on the ball of radius {rho:e} P = {there:?}"));
            }
        }
    }
    Ok(seen)
}

/// On balls that are larger by a factor.
pub fn stays(times: f64) -> Outcome {
    let mut sum = [0, 0];
    for seen in [
        stays_on(Degree::One, EdgeRule::Exact, times)?,
        stays_on(Degree::One, EdgeRule::gauss(2), times)?,
        stays_on(Degree::Two, EdgeRule::Exact, times)?,
        stays_on(Degree::Two, EdgeRule::gauss(3), times)?,
    ] {
        sum = [sum[0] + seen[0], sum[1] + seen[1]];
    }
    if sum.contains(&0) {
        return Err(format!("{} fields that press, {} that don't", sum[1], sum[0]));
    }
    Ok(format!("{} fields that press, {} that don't, P1 and P2", sum[1], sum[0]))
}

fn holds_on(degree: Degree, rule: EdgeRule, kappa: f64, share: f64) -> Result<f64, String> {
    let problem = square()?;
    let places = match &rule {
        EdgeRule::Exact => vec![0.0, 1.0],
        EdgeRule::Gauss(points) => points.iter().map(|(s, _)| *s).collect(),
    };
    let d = Discretization::new(&problem, degree, |c| kappa * c.limit(), rule);
    let d = d.map_err(text)?;
    let at = At::new(&d);
    let pressed = at.pressed(&at.field(vec![1.0; degree.nodes_per_edge()]));
    // The matrix of |v|_S by the squares of unit fields and of their sums, without the first node's x, along which it slides.
    let count = 2 * d.space.nodes().len();
    let units = |columns: [usize; 2]| {
        let mut v = vec![[0.0; 2]; count / 2];
        columns.map(|c| c + 1).iter().for_each(|dof| v[dof / 2][dof % 2] += 1.0);
        v
    };
    let entry = |i: usize, j: usize| {
        let unit = |i| at.square(&units([i, i])) / 4.0;
        (at.square(&units([i, j])) - unit(i) - unit(j)) / 2.0
    };
    let matrix = Mat::from_fn(count - 1, count - 1, entry);
    let factor = matrix.llt(Side::Lower).map_err(|_| "|v|_S is no norm")?;
    let holds = pressed.holds(&d, &at.lines);
    if holds.len() != places.len() {
        return Err(format!("{} places are held", holds.len()));
    }
    let mut nearest: f64 = 0.0;
    for (s, hold) in places.into_iter().zip(&holds) {
        let mut component = Mat::zeros(count - 1, 1);
        let nodes = d.space.edge_nodes(at.edge().edge()).zip(degree.edge_values(s));
        for ((node, shape), Term { at: x, along: [_, y], .. }) in nodes.zip(&hold.terms) {
            let place = d.space.nodes()[node];
            let near = |ball: kernel::Ball, value: f64| {
                ball.lower() - 1e-15 <= value && value <= ball.upper() + 1e-15
            };
            if !(near(x[0], place[0]) && near(x[1], place[1]) && near(*y, -shape)) {
                return Err(format!("{x:?} and {y:?} for {shape} at {place:?}"));
            }
            component[(2 * node, 0)] = shape;
        }
        let attained = (component.transpose() * factor.solve(&component))[(0, 0)].sqrt();
        // |v|_S (1 - kappa)^(-1/2) <= 1
        let attained = attained * (1.0 - d.kappa()).sqrt();
        if !(attained <= share * hold.most) {
            return Err(format!("n . v = {attained} at {s}, at most {}", hold.most));
        }
        nearest = nearest.max(attained / hold.most);
    }
    Ok(nearest)
}

/// With a share of the bounds.
pub fn holds(share: f64) -> Outcome {
    let mut nearest: f64 = 0.0;
    for kappa in [1e-6, 0.1, 0.5, 0.9] {
        for degree in [Degree::One, Degree::Two] {
            for rule in [EdgeRule::Exact, EdgeRule::gauss(2), EdgeRule::gauss(3)] {
                nearest = nearest.max(holds_on(degree, rule, kappa, share)?);
            }
        }
    }
    Ok(format!("four gammas, three rules, P1 and P2; up to {nearest:.2} of the bound is attained"))
}

fn springs_on(degree: Degree, scale: f64) -> Result<(), String> {
    let problem = square()?;
    let (p, nodes) = (degree.number(), degree.nodes_per_edge());
    for points in [None, Some(1), Some(p), Some(nodes), Some(5)] {
        let rule = points.map_or(EdgeRule::Exact, EdgeRule::gauss);
        let d = Discretization::new(&problem, degree, |c| 0.3 * c.limit(), rule);
        let d = d.map_err(text)?;
        let at = At::new(&d);
        let pressed = at.pressed(&at.field(vec![1.0; degree.nodes_per_edge()]));
        if !pressed.edges().all(|is| is) {
            return Err(format!("{points:?} points, P{p}: not pressed"));
        }
        let mut random = Random::new(draws::seed());
        let v = super::random_field(&mut random, d.space.nodes().len());
        let mut forces = vec![[PreciseBall::from(0); 2]; v.len()];
        pressed.add_springs(&at.lines, &balls(&v), &mut forces);
        let pairs = forces.iter().flatten().zip(v.as_flattened());
        let found: f64 = pairs.map(|(f, v)| f.head() * v).sum();
        let expected = scale * at.springs(&v);
        if !abs_diff_eq!(found, expected, epsilon = 1e-12 * expected) {
            return Err(format!("{points:?} points: springs {found:e}, expected {expected:e}"));
        }
    }
    Ok(())
}

pub fn springs(scale: f64) -> Outcome {
    springs_on(Degree::One, scale)?;
    springs_on(Degree::Two, scale)?;
    Ok("five rules, P1 and P2".to_owned())
}

/// A block on a floor beside walls at these gaps, on the left and on the right, negative where they push it away at first.
fn between_walls(gaps: [Option<f64>; 2], angle: f64) -> Result<Problem, String> {
    let cells = Rectangle { width: 1.0, height: 1.0, nx: 3, ny: 2, diagonal: Diagonal::Crossed };
    let mesh = cells.mesh().map_err(text)?;
    let (sin, cos) = angle.sin_cos();
    let turned = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
    let mesh = mapped(&mesh, turned)?;
    let walls = [("bottom", Some(0.0)), ("left", gaps[0]), ("right", gaps[1])];
    let conditions =
        walls.into_iter().filter_map(|(side, gap)| Some((side.to_owned(), floor(gap?))));
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    Ok(Problem::new(mesh, material, turned([0.0, -0.1]).map(constant), conditions.collect()))
}

/// A displacement solves (8) at every node, prescribed or not.
fn solves(problem: &Problem, degree: Degree, u: &[[f64; 2]]) -> Result<bool, String> {
    let half = |c: &Coercivity| c.limit() / 2.0;
    let d = Discretization::new(problem, degree, half, EdgeRule::Exact).map_err(text)?;
    let r = d.residual(u).values;
    // The weight is 0.1.
    Ok(r.as_flattened().iter().all(|r| r.abs() <= 1e-12))
}

/// Where walls that a body does not press leave it room, the displacement that is given, and that moved by `share` of what it may
/// move, solve (8), and the former is enclosed.
pub fn room(share: f64) -> Outcome {
    let mut ends = 0;
    for angle in [0.0, 0.7] {
        for gaps in [
            [Some(0.02), Some(0.05)],
            [Some(-0.01), Some(0.03)],
            [Some(0.04), Some(-0.02)],
            [Some(0.02), None],
            [None, Some(-0.01)],
        ] {
            let problem = between_walls(gaps, angle)?;
            for degree in [Degree::One, Degree::Two] {
                let method = Method { degree, ..Method::default() };
                let settings = Settings { proof: 1e-11, ..Settings::default() };
                let (solution, _) = solve(&problem, &method, &settings).map_err(text)?;
                let said = || format!("gaps {gaps:?}, turned by {angle}, {degree:?}");
                let radius = solution.enclosure.as_ref().map_err(|e| format!("{}: {e}", said()))?;
                if !radius.relative.is_some_and(|relative| relative <= 1e-10) {
                    return Err(format!("{}: {:?}", said(), radius.relative));
                }
                let [play] = solution.plays[..] else {
                    return Err(format!("{}: {:?}", said(), solution.plays));
                };
                let along = play.along.ok_or_else(said)?;
                for way in [Some(0.0), play.least, play.most].into_iter().flatten() {
                    let moved: Vec<[f64; 2]> = (solution.displacement.iter())
                        .map(|u| [0, 1].map(|c| u[c] + share * way * along[c]))
                        .collect();
                    if !solves(&problem, degree, &moved)? {
                        return Err(format!("{}: no solution at {way}", said()));
                    }
                    ends += 1;
                }
            }
        }
    }
    Ok(format!("{ends} displacements of blocks beside walls, P1 and P2"))
}
