//! (7): gamma is a square root; its square is exact.

use signorini::kernel::Triangle;

use super::compare::{UNIT, discretized};
use super::draw::{Contact, Draw, problems};
use crate::claim::Outcome;
use crate::draws;
use crate::ensure;
use crate::numbers::Exact;
use crate::verdict::Verdict;

/// The square of a length, or of gamma, is within 8 units of roundoff of the exact one: two differences, hypot (2), a product,
/// squared.
pub(crate) fn close(length: f64, square: Exact) -> bool {
    let computed = Exact::of_double(length) * Exact::of_double(length);
    (computed - square).abs() <= square * Exact::of_double(8.0 * UNIT)
}

/// (7) for every contact edge of the solver: gamma^2 is gamma0^2 times `square`, the square of h_T or a planted mistake, of
/// the triangle and its edge.
pub(crate) fn gamma_is<const N: usize>(
    draw: &Draw,
    square: impl Fn([Exact; 3], usize) -> Exact,
) -> Verdict {
    let problem = draw.problem();
    let Some(d) = discretized::<N>(draw, &problem) else {
        return Verdict::Fails("the problem is refused");
    };
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

pub(crate) fn longest([a, b, c]: [Exact; 3]) -> Exact {
    let larger = |a: Exact, b: Exact| if b > a { b } else { a };
    larger(larger(a, b), c)
}

/// (7): gamma = gamma0 h_T, h_T the diameter of the triangle that owns the edge.
pub fn gamma_by_the_diameter() -> Outcome {
    let p1 = draws::hold(60, problems(Contact::Any, false), &["always"], |draw| {
        gamma_is::<3>(draw, |squares, _| longest(squares))
    })?;
    let p2 = draws::hold(20, problems(Contact::Any, true), &["always"], |draw| {
        gamma_is::<6>(draw, |squares, _| longest(squares))
    })?;
    Ok(format!("P1: {p1}; P2: {p2}"))
}

/// The control of [`gamma_by_the_diameter`]: |E| for h_T.
pub fn gamma_by_the_edge() -> Outcome {
    draws::reject(problems(Contact::Any, false), |draw| {
        gamma_is::<3>(draw, |squares, i| squares[i])
    })?;
    draws::reject(problems(Contact::Any, true), |draw| gamma_is::<6>(draw, |squares, i| squares[i]))
}
