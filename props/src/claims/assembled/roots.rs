//! Square roots: the solver's h_T, |E|, n and gamma against the exact squares and normals.

use signorini::contact::Discretization;
use signorini::kernel::Triangle;
use signorini::model::{Degree, Mesh};
use signorini::nalgebra::Vector2;

use super::compare::UNIT;
use super::draw::{Contact, Draw, owner, problems};
use crate::claim::Outcome;
use crate::draws;
use crate::ensure;
use crate::numbers::Exact;
use crate::verdict::Verdict;

/// The square of a length, or of gamma, is within 8 units of roundoff of the exact one: two differences, hypot (2), a product,
/// squared.
pub(super) fn close(length: f64, square: Exact) -> bool {
    let computed = Exact::of_double(length) * Exact::of_double(length);
    (computed - square).abs() <= square * Exact::of_double(8.0 * UNIT)
}

/// The square roots of one mesh: h_T is the longest edge, |E| and n are those of the edge. `diameter` is h_T, or a planted
/// mistake.
pub(super) fn geometry(draw: &Draw, diameter: impl Fn(&Mesh, usize) -> f64) -> Verdict {
    let problem = draw.problem();
    let mesh = &problem.mesh;
    let (vertices, triangles, sides) = draw.parts();
    Exact::scope(|| {
        let exact = |t: usize| Triangle {
            vertices: triangles[t].map(|v| Vector2::from(vertices[v]).map(Exact::of_double)),
        };
        for t in 0..triangles.len() {
            let squares = [0, 1, 2].map(|i| {
                let [x, y] = exact(t).edge(i).into();
                x * x + y * y
            });
            ensure!(close(diameter(mesh, t), longest(squares)));
        }
        for edge in sides.into_values().flatten().map(|edge| owner(&triangles, edge)) {
            let [x, y] = exact(edge.triangle).scaled_normal(edge.local).into();
            let (length, n) = mesh.length_and_normal(edge);
            ensure!(close(length, x * x + y * y));
            for (c, exact) in [x, y].into_iter().enumerate() {
                // A difference and a quotient.
                let scaled = Exact::of_double(n[c]) * Exact::of_double(length);
                ensure!((scaled - exact).abs() <= exact.abs() * Exact::of_double(3.0 * UNIT));
            }
        }
        Verdict::Holds("always")
    })
}

/// The solver's square roots.
pub fn square_roots() -> Outcome {
    draws::hold(60, problems(Contact::Any, false), &["always"], |draw| {
        geometry(draw, |mesh, t| mesh.diameter(t))
    })
}

/// The control of [`square_roots`]: one edge for the longest one.
pub fn first_edge_for_the_longest() -> Outcome {
    draws::reject(problems(Contact::Any, false), |draw| {
        geometry(draw, |mesh, t| {
            let [x, y]: [f64; 2] = mesh.triangle(t).edge(0).into();
            x.hypot(y)
        })
    })
}

/// (7) for every contact edge of the solver: gamma^2 is gamma0^2 times `square`, the square of h_T or a planted mistake, of
/// the triangle and its edge.
pub(super) fn gamma_is(draw: &Draw, square: impl Fn([Exact; 3], usize) -> Exact) -> Verdict {
    let problem = draw.problem();
    let discretized =
        Discretization::new(&problem, Degree::One, |c| draw.kappa * c.limit(), draw.rule());
    let Ok(d) = discretized else { return Verdict::Fails("the problem is refused") };
    let (vertices, triangles, _) = draw.parts();
    Exact::scope(|| {
        let gamma0 = Exact::of_double(d.gamma0);
        for line in &d.contact {
            let vertices =
                triangles[line.edge().triangle].map(|v| vertices[v].map(Exact::of_double).into());
            let squares = [0, 1, 2].map(|i| {
                let edge = Triangle { vertices }.edge(i);
                edge.dot(&edge)
            });
            ensure!(close(line.gamma, gamma0 * gamma0 * square(squares, line.edge().local)));
        }
        Verdict::Holds("always")
    })
}

pub(super) fn longest([a, b, c]: [Exact; 3]) -> Exact {
    let larger = |a: Exact, b: Exact| if b > a { b } else { a };
    larger(larger(a, b), c)
}

/// (7): gamma = gamma0 h_T, h_T the diameter of the triangle that owns the edge.
pub fn gamma_by_the_diameter() -> Outcome {
    draws::hold(60, problems(Contact::Any, false), &["always"], |draw| {
        gamma_is(draw, |squares, _| longest(squares))
    })
}

/// The control of [`gamma_by_the_diameter`]: |E| for h_T.
pub fn gamma_by_the_edge() -> Outcome {
    draws::reject(problems(Contact::Any, false), |draw| gamma_is(draw, |squares, i| squares[i]))
}
