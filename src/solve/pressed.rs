//! Strong contact: the pieces of Gamma_C that are surely pressed around the computed displacement, and the matrix A_S of (8)
//! there. Where contact alone stops a rigid motion of the body, A is singular; A_S = A + the springs of those pieces S is not,
//! and on a ball around the displacement in which they stay pressed (8) is strongly monotone in its norm. docs/theory.md, 7.5,
//! has the proofs.
//!
//! |v|_S^2 = A(v, v) + int over S of P0(v)^2 / gamma
//!
//! The exact integral has halves of halves of an edge for pieces, a Gauss rule its points.

use super::balls::Lines;
use crate::fem::Discretization;
use crate::fem::ball::{Ball, up};
use crate::fem::contact_line::EdgeRule;
use crate::fem::korn::Hold;
use crate::fem::precise::OnEdge;
use crate::kernel::edge_integral::ExactEdge;

/// A piece is taken for pressed where P is at least this share of the most that it is all along some piece.
const SHARE: f64 = 1.0 / (1 << 20) as f64;

/// And at least this share of the most that it is all along some piece of its edge: where P falls to zero hardly anything holds.
const SHARE_OF_EDGE: f64 = 1.0 / 16.0;

/// An edge is halved so often where it is pressed in part.
const HALVINGS: u32 = 10;

/// Covers the rounding of a few sums, products and roots of positive doubles.
const SAFETY: f64 = 1.001;

/// Values at the nodes of an edge, or what is multiplied by them.
type Row<const M: usize> = [Ball; M];

/// A piece of an edge.
struct Piece<const M: usize> {
    /// Where it starts and ends; a point does both at once.
    ends: [f64; 2],
    /// The coefficients on it, of a polynomial with given values at the nodes, that enclose the polynomial there (Bernstein's).
    coefficients: [Row<M>; M],
    /// The integrals of N_a N_b over it.
    mass: [Row<M>; M],
}

/// The pressed pieces of an edge.
struct Part<const M: usize> {
    /// Where they start and end.
    pieces: Vec<[f64; 2]>,
    /// For each coefficient on each piece the least that it is of P at the displacement, and the most that it is of P0(v) beside
    /// |v|_S.
    coefficients: Vec<[f64; 2]>,
    /// The most that P0(v) is at the ends of the edge, beside |v|_S.
    ends: [f64; 2],
    /// The integrals of N_a N_b over them.
    mass: [Row<M>; M],
}

/// S
pub struct Pressed<const M: usize> {
    /// For each contact edge what of it is in S.
    edges: Vec<Option<Part<M>>>,
}

impl<const M: usize> Piece<M> {
    /// The pieces of an edge on which P is positive.
    fn pressed<E, const N: usize>(rule: &EdgeRule, p: &Row<M>) -> Vec<Self>
    where
        E: ExactEdge<f64, N, M>,
    {
        let EdgeRule::Gauss(points) = rule else {
            return Self::within::<E, N>(p, 0.0, HALVINGS);
        };
        let at = |&(s, weight): &(f64, f64)| {
            let shapes: Row<M> = E::edge_values(Ball::from(s));
            let mass = shapes.map(|a| shapes.map(|b| Ball::from(weight) * a * b));
            Piece { ends: [s, s], coefficients: [shapes; M], mass }
        };
        points.iter().map(at).filter(|piece| piece.least(p) > 0.0).collect()
    }

    /// Those that begin at `start` or later in a stretch that may be halved so many times more.
    fn within<E, const N: usize>(p: &Row<M>, start: f64, halvings: u32) -> Vec<Self>
    where
        E: ExactEdge<f64, N, M>,
    {
        let length = 0.5_f64.powi((HALVINGS - halvings) as i32);
        let piece = Self::between::<E, N>(start, length);
        if piece.least(p) > 0.0 {
            return vec![piece];
        }
        if halvings == 0 || piece.coefficients.iter().all(|c| dot(c, p).upper() <= 0.0) {
            return Vec::new();
        }
        let halves = [start, start + length / 2.0];
        halves.into_iter().flat_map(|s| Self::within::<E, N>(p, s, halvings - 1)).collect()
    }

    /// The piece of an edge from `start` on that is so long, both exactly doubles. Boole's rule is exact for the products.
    fn between<E, const N: usize>(start: f64, length: f64) -> Self
    where
        E: ExactEdge<f64, N, M>,
    {
        let at =
            |i: u32| -> Row<M> { E::edge_values(Ball::from(start + f64::from(i) / 4.0 * length)) };
        let ends = [at(0), at(4)];
        let mut coefficients = [ends[1]; M];
        coefficients[0] = ends[0];
        if M > 2 {
            let ([two, half], middle) = ([2.0, 0.5].map(Ball::from), at(2));
            coefficients[M - 1] =
                std::array::from_fn(|a| two * middle[a] - half * (ends[0][a] + ends[1][a]));
        }
        let mut mass = [[Ball::from(0); M]; M];
        for (i, weight) in [(0, 7), (1, 32), (2, 12), (3, 32), (4, 7)] {
            let weight = Ball::from(length) * Ball::from(weight) / Ball::from(90);
            add(&mut mass, &at(i).map(|a| at(i).map(|b| weight * a * b)));
        }
        Piece { ends: [start, start + length], coefficients, mass }
    }

    /// The least coefficient of P, or less.
    fn least(&self, p: &Row<M>) -> f64 {
        self.coefficients.iter().map(|c| dot(c, p).lower()).fold(f64::INFINITY, f64::min)
    }
}

impl<const M: usize> Part<M> {
    /// The part of the edge `line` in these pieces, where P has the values `p`. `None` where they don't see all of P0.
    fn new<const N: usize>(
        line: &OnEdge<Ball, N, M>,
        p: &Row<M>,
        pieces: &[&Piece<M>],
    ) -> Option<Self> {
        let mut mass = [[Ball::from(0); M]; M];
        pieces.iter().for_each(|piece| add(&mut mass, &piece.mass));
        // q . M q <= 1 implies c . q <= (c . M^-1 c)^{1/2}
        let most = |c: &Row<M>| Some(SAFETY * root_of(line) * by_inverse(mass, *c)?.upper().sqrt());
        let all = pieces.iter().flat_map(|piece| &piece.coefficients);
        let coefficients = all.map(|c| Some([dot(c, p).lower(), most(c)?]));
        let unit = |end| std::array::from_fn(|a| Ball::from(i32::from(a == end)));
        let ends = [most(&unit(0))?, most(&unit(1))?];
        let coefficients = coefficients.collect::<Option<_>>()?;
        Some(Part { pieces: pieces.iter().map(|p| p.ends).collect(), coefficients, ends, mass })
    }
}

impl<const M: usize> Pressed<M> {
    /// Nothing: |v|_S = |v|_A.
    pub fn nowhere(count: usize) -> Self {
        Pressed { edges: (0..count).map(|_| None).collect() }
    }

    /// Finds the pieces that are surely pressed at the displacement `u`.
    pub fn at<E, const N: usize>(
        d: &Discretization<E, N, M>,
        lines: &Lines<N, M>,
        u: &[[Ball; 2]],
    ) -> Self
    where
        E: ExactEdge<f64, N, M>,
    {
        let p = d.contact.iter().zip(lines).map(|(edge, line)| line.p(edge, u));
        let edges = p.map(|p| {
            let least = |piece: Piece<M>| (piece.least(&p), piece);
            let pieces = Piece::pressed::<E, N>(&d.rule, &p).into_iter().map(least);
            (p, pieces.collect::<Vec<_>>())
        });
        let edges: Vec<(Row<M>, Vec<(f64, Piece<M>)>)> = edges.collect();
        let most = |pieces: &[(f64, Piece<M>)]| pieces.iter().fold(0.0, |m: f64, p| m.max(p.0));
        let enough = SHARE * edges.iter().map(|(_, pieces)| most(pieces)).fold(0.0, f64::max);
        let part = |(line, (p, pieces)): (&OnEdge<Ball, N, M>, &(Row<M>, Vec<_>))| {
            let enough = enough.max(SHARE_OF_EDGE * most(pieces));
            let taken = pieces.iter().filter(|(least, _)| *least >= enough);
            Part::new(line, p, &taken.map(|(_, piece)| piece).collect::<Vec<_>>())
        };
        Pressed { edges: lines.iter().zip(&edges).map(part).collect() }
    }

    /// For each contact edge whether something of it is in S.
    pub fn edges(&self) -> impl Iterator<Item = bool> {
        self.edges.iter().map(Option::is_some)
    }

    /// For each contact edge whether all that the rule sees of it is in S.
    pub fn whole<'a>(&'a self, rule: &'a EdgeRule) -> impl Iterator<Item = bool> + 'a {
        let is_whole = |part: &Part<M>| match rule {
            EdgeRule::Exact => part.pieces.iter().map(|[a, b]| b - a).sum::<f64>() == 1.0,
            EdgeRule::Gauss(points) => part.pieces.len() == points.len(),
        };
        self.edges.iter().map(move |part| part.as_ref().is_some_and(is_whole))
    }

    /// The pieces of contact edge `e` that are in S, where they start and end on \[0, 1\].
    pub fn pieces(&self, e: usize) -> &[[f64; 2]] {
        self.edges[e].as_ref().map_or(&[], |part| &part.pieces)
    }

    /// Whether all of S stays pressed on a ball of radius `rho` and a little more.
    pub fn stay(&self, rho: f64) -> bool {
        let mut all = self.edges.iter().flatten().flat_map(|part| &part.coefficients);
        all.all(|[least, most]| *least > SAFETY * most * rho)
    }

    /// The components that S holds at the ends of its edges: n~ . v = P0(v) + gamma s(v), for |v|_S (1 - kappa)^{-1/2} <= 1. There gamma |s(v)| is
    /// at most 2 (gamma / |E|)^{1/2}, as s is affine and int gamma s^2 <= 1.
    pub fn holds<E, const N: usize>(
        &self,
        d: &Discretization<E, N, M>,
        lines: &Lines<N, M>,
    ) -> Vec<Hold>
    where
        E: ExactEdge<f64, N, M>,
    {
        let mesh = d.space.mesh();
        let mut holds = Vec::new();
        for ((edge, line), part) in d.contact.iter().zip(lines).zip(&self.edges) {
            let Some(part) = part else { continue };
            for (end, (vertex, most)) in mesh.ends(edge.edge).into_iter().zip(part.ends).enumerate()
            {
                let direction: [Ball; 2] = if edge.directions == [edge.normal; M] {
                    line.numbers.normal.into()
                } else {
                    edge.directions[end].map(Ball::from).into()
                };
                holds.push(Hold {
                    triangle: edge.edge.triangle,
                    at: mesh.vertices()[vertex],
                    direction: direction.map(Ball::rounded),
                    most: up(most + SAFETY * 2.0 * root_of(line)),
                });
            }
        }
        holds
    }

    /// For each contact edge the matrix of its springs, in doubles.
    pub fn springs<const N: usize>(&self, lines: &Lines<N, M>) -> Vec<[[f64; M]; M]> {
        let of = |(line, part): (&OnEdge<Ball, N, M>, &Option<Part<M>>)| {
            let weight = (line.numbers.length / line.numbers.gamma).head();
            let mass = part.as_ref().map(|part| part.mass);
            mass.map_or([[0.0; M]; M], |mass| mass.map(|row| row.map(|m| weight * m.head())))
        };
        lines.iter().zip(&self.edges).map(of).collect()
    }

    /// Adds what the springs of S do against v, the integral over S of P0(v) P0(w) / gamma for every basis function w.
    pub fn add_springs<const N: usize>(
        &self,
        lines: &Lines<N, M>,
        v: &[[Ball; 2]],
        forces: &mut [[Ball; 2]],
    ) {
        for (line, part) in lines.iter().zip(&self.edges) {
            let Some(part) = part else { continue };
            let weight = line.numbers.length / line.numbers.gamma;
            let p0 = line.p0(v);
            line.add_contact(&part.mass.each_ref().map(|row| weight * dot(row, &p0)), forces);
        }
    }
}

fn dot<const M: usize>(a: &Row<M>, b: &Row<M>) -> Ball {
    a.iter().zip(b).fold(Ball::from(0), |sum, (&a, &b)| sum + a * b)
}

fn add<const M: usize>(sum: &mut [Row<M>; M], other: &[Row<M>; M]) {
    for (sum, &other) in sum.as_flattened_mut().iter_mut().zip(other.as_flattened()) {
        *sum += other;
    }
}

/// c . m^-1 c for a symmetric m, by elimination; `None` where it is not surely positive definite.
fn by_inverse<const M: usize>(mut m: [Row<M>; M], mut c: Row<M>) -> Option<Ball> {
    let mut sum = Ball::from(0);
    for k in 0..M {
        let (pivot, row) = (m[k][k], m[k]);
        if !(pivot.lower() > 0.0) {
            return None;
        }
        sum += c[k] * c[k] / pivot;
        for i in k + 1..M {
            let factor = m[i][k] / pivot;
            c[i] -= factor * c[k];
            for j in k + 1..M {
                m[i][j] -= factor * row[j];
            }
        }
    }
    Some(sum)
}

/// (gamma / |E|)^{1/2}
fn root_of<const N: usize, const M: usize>(line: &OnEdge<Ball, N, M>) -> f64 {
    up((line.numbers.gamma / line.numbers.length).upper().sqrt())
}

/// A lower bound of a polynomial on an edge by its Bernstein coefficients, from its values at the nodes.
fn least<const M: usize>(p: [Ball; M]) -> f64 {
    let ends = p[0].lower().min(p[1].lower());
    if M == 2 {
        return ends;
    }
    let [two, half] = [Ball::from(2), Ball::from(0.5)];
    ends.min((two * p[M - 1] - half * (p[0] + p[1])).lower())
}

/// An upper bound of it.
pub fn greatest<const M: usize>(p: [Ball; M]) -> f64 {
    -least(p.map(|p| -p))
}

/// How much P0(v) is along an edge at most where |v| is at most `far` at its nodes and `radius` in the energy norm a: n~ . v
/// is at most 5/4 of the largest nodal value, gamma |s(v)| at most 2 (gamma / |E|)^{1/2} |v|_a.
pub fn change<const N: usize, const M: usize>(
    line: &OnEdge<Ball, N, M>,
    far: f64,
    radius: f64,
) -> f64 {
    up(SAFETY * (1.25 * far + 2.0 * root_of(line) * radius))
}
