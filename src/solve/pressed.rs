//! Strong contact: the pieces of Gamma_C that are surely pressed around the computed displacement, and the matrix A_S of (8)
//! there. Where contact alone stops a rigid motion of the body, A is singular; A_S = A + the springs of those pieces S is not,
//! and on a ball around the displacement in which they stay pressed (8) is strongly monotone in its norm. docs/theory.md, 7.5,
//! has the proofs.
//!
//! |v|_S^2 = A(v, v) + int over S of P0(v)^2 / gamma
//!
//! The exact integral has the stretches of an edge between the roots of P for pieces, a Gauss rule its points.

use nalgebra::DMatrix;

use crate::fem::korn::Hold;
use crate::fem::{Degree, Discretization, EdgeRule, Piece};
use crate::kernel::ball::{PreciseBall, up};

/// A piece is taken for pressed where P is at least this share of the most that it is all along some piece; where that proves
/// nothing, the next one: with all pieces that are pressed more holds the body, with fewer these stay pressed on a larger ball. With
/// the first alone twelve of 2,000 bodies at random have no enclosure, with the first two nine, with all five.
pub const SHARES: [f64; 3] = [0.0, 1.0 / 256.0, 1.0 / 16.0];

/// This share of a stretch is left out at a root of P, where P is too small to stay positive: with none, stretches that end at a
/// root hold nothing.
const INSET: f64 = 1.0 / 64.0;

/// Covers the rounding of a few sums, products and roots of positive doubles.
const SAFETY: f64 = 1.001;

/// Values at the nodes of an edge, or what is multiplied by them.
type Row = Vec<PreciseBall>;

/// A piece of an edge.
struct EdgePiece {
    /// Where it starts and ends; a point does both at once.
    ends: [f64; 2],
    /// The coefficients on it, of a polynomial with given values at the nodes, that enclose the polynomial there (Bernstein's):
    /// first its values at the ends.
    coefficients: Vec<Row>,
    /// The most that the square of a polynomial is on it whose square has the integral 1 over it; attained at the ends.
    square: PreciseBall,
    /// The integrals of N_a N_b over it.
    mass: Vec<Row>,
}

/// The pressed pieces of an edge.
struct PressedEdge {
    /// Where they start and end.
    pieces: Vec<[f64; 2]>,
    /// For each piece the least that P is on it at the displacement, and the most that P0(v) is beside |v|_S.
    bounds: Vec<[f64; 2]>,
    /// The shape functions of the edge at the ends of the pieces, and the most that P0(v) is there, beside |v|_S.
    places: Vec<(Row, f64)>,
    /// The integrals of N_a N_b over them.
    mass: Vec<Row>,
}

/// S
pub struct Pressed {
    /// For each contact edge what of it is in S.
    edges: Vec<Option<PressedEdge>>,
}

impl EdgePiece {
    /// The pieces of an edge on which P is positive.
    fn pressed(degree: Degree, rule: &EdgeRule, p: &Row) -> Vec<Self> {
        let EdgeRule::Gauss(points) = rule else {
            return Self::between_roots(degree, p);
        };
        let at = |&(s, weight): &(f64, f64)| {
            let (shapes, weight) =
                (degree.edge_values(PreciseBall::from(s)), PreciseBall::from(weight));
            let mass = products(weight, &shapes);
            EdgePiece {
                ends: [s, s],
                coefficients: vec![shapes],
                square: PreciseBall::from(1) / weight,
                mass,
            }
        };
        points.iter().map(at).filter(|piece| piece.least(p) > 0.0).collect()
    }

    /// Those in the stretches between the roots of P.
    fn between_roots(degree: Degree, p: &Row) -> Vec<Self> {
        let mut cuts = degree.roots(&p.iter().map(|p| p.head()).collect::<Vec<_>>());
        cuts.extend([0.0, 1.0]);
        cuts.sort_unstable_by(f64::total_cmp);
        let stretch = |cut: &[f64]| {
            let inset = INSET * (cut[1] - cut[0]);
            let start = if cut[0] > 0.0 { cut[0] + inset } else { 0.0 };
            let end = if cut[1] < 1.0 { cut[1] - inset } else { 1.0 };
            Self::between(degree, [start, end])
        };
        cuts.windows(2).map(stretch).filter(|piece| piece.least(p) > 0.0).collect()
    }

    /// The piece of an edge with these ends. Boole's rule is exact for the products. The square is at most the sum of 2 k + 1
    /// over the length, for k up to the degree p: that is (p + 1)^2, as Legendre's polynomials are at most 1.
    fn between(degree: Degree, ends: [f64; 2]) -> Self {
        let start = PreciseBall::from(ends[0]);
        let length = PreciseBall::from(ends[1]) - start;
        let at = |i: i32| {
            degree.edge_values(start + PreciseBall::from(i) / PreciseBall::from(4) * length)
        };
        let coefficients = match degree {
            Degree::One => vec![at(0), at(4)],
            Degree::Two => {
                let [two, half] = [2.0, 0.5].map(PreciseBall::from);
                let ends = at(0).into_iter().zip(at(4));
                let bend = at(2).into_iter().zip(ends).map(|(m, (a, b))| two * m - half * (a + b));
                vec![at(0), at(4), bend.collect()]
            }
        };
        let count = degree.nodes_per_edge();
        let square = PreciseBall::from((count * count) as i32) / length;
        let mut mass = vec![vec![PreciseBall::from(0); count]; count];
        for (i, weight) in [(0, 7), (1, 32), (2, 12), (3, 32), (4, 7)] {
            let weight = length * PreciseBall::from(weight) / PreciseBall::from(90);
            add(&mut mass, &products(weight, &at(i)));
        }
        EdgePiece { ends, coefficients, square, mass }
    }

    /// The least coefficient of P, or less.
    fn least(&self, p: &Row) -> f64 {
        self.coefficients.iter().map(|c| dot(c, p).lower()).fold(f64::INFINITY, f64::min)
    }
}

impl PressedEdge {
    /// The part of the edge `line` in these pieces, where P has the values `p`. `None` where there are none.
    fn new(line: &Piece<PreciseBall>, p: &Row, pieces: &[&EdgePiece]) -> Option<Self> {
        let mut mass = vec![vec![PreciseBall::from(0); p.len()]; p.len()];
        pieces.iter().for_each(|piece| add(&mut mass, &piece.mass));
        let most = |piece: &EdgePiece| SAFETY * root_of(line) * piece.square.upper().sqrt();
        let bounds = pieces.iter().map(|piece| [piece.least(p), most(piece)]).collect();
        let at_ends = |piece: &&EdgePiece| {
            let (ends, most) = (piece.coefficients.iter().take(2), most(piece));
            ends.map(|shapes| (shapes.clone(), most)).collect::<Vec<_>>()
        };
        let places = pieces.iter().flat_map(at_ends).collect();
        let pieces: Vec<[f64; 2]> = pieces.iter().map(|piece| piece.ends).collect();
        (!pieces.is_empty()).then_some(PressedEdge { pieces, bounds, places, mass })
    }
}

impl Pressed {
    /// Nothing: |v|_S = |v|_A.
    pub fn nowhere(count: usize) -> Self {
        Pressed { edges: (0..count).map(|_| None).collect() }
    }

    /// Finds the pieces that are surely pressed at the displacement `u`, those that have their `share` of the pressure.
    pub fn at(
        d: &Discretization,
        lines: &[Piece<PreciseBall>],
        u: &[[PreciseBall; 2]],
        share: f64,
    ) -> Self {
        let edges = lines.iter().map(|line| {
            let p = line.p(u);
            let least = |piece: EdgePiece| (piece.least(&p), piece);
            let pieces = EdgePiece::pressed(d.space.degree(), &d.rule, &p).into_iter().map(least);
            let pieces: Vec<(f64, EdgePiece)> = pieces.collect();
            (p, pieces)
        });
        let edges: Vec<(Row, Vec<(f64, EdgePiece)>)> = edges.collect();
        let all = edges.iter().flat_map(|(_, pieces)| pieces);
        let enough = share * all.fold(0.0, |most: f64, (least, _)| most.max(*least));
        let part = |(line, (p, pieces)): (&Piece<PreciseBall>, &(Row, Vec<_>))| {
            let taken = pieces.iter().filter(|(least, _)| *least >= enough);
            PressedEdge::new(line, p, &taken.map(|(_, piece)| piece).collect::<Vec<_>>())
        };
        Pressed { edges: lines.iter().zip(&edges).map(part).collect() }
    }

    /// For each contact edge whether something of it is in S.
    pub fn edges(&self) -> impl Iterator<Item = bool> {
        self.edges.iter().map(Option::is_some)
    }

    /// The pieces of contact edge `e` that are in S, where they start and end on \[0, 1\].
    pub fn pieces(&self, e: usize) -> &[[f64; 2]] {
        self.edges[e].as_ref().map_or(&[], |part| &part.pieces)
    }

    /// Returns whether all of S stays pressed on a ball of radius `rho` and a little more.
    pub fn stay(&self, rho: f64) -> bool {
        let mut all = self.edges.iter().flatten().flat_map(|part| &part.bounds);
        all.all(|[least, most]| *least > SAFETY * most * rho)
    }

    /// The holds of S: sums of n~ . v at the nodes of its edges, each times its shape function at a place of the edge:
    /// n~ . v = P0(v) + gamma s(v), for |v|_S (1 - kappa)^{-1/2} <= 1: at most what P0(v) is beside |v|_S.
    pub fn holds(&self, d: &Discretization, lines: &[Piece<PreciseBall>]) -> Vec<Hold> {
        let mesh = d.space.mesh();
        let mut holds = Vec::new();
        for (line, part) in lines.iter().zip(&self.edges) {
            let Some(part) = part else { continue };
            let [start, end] =
                mesh.ends(line.edge()).map(|v| mesh.vertices()[v].map(PreciseBall::from));
            let middle = [0, 1].map(|c| (start[c] + end[c]) * PreciseBall::from(0.5));
            for (shapes, most) in &part.places {
                let nodes = [start, end, middle].into_iter().zip(shapes).enumerate();
                let terms = nodes.map(|(a, (at, &shape))| {
                    let direction: [PreciseBall; 2] = line.direction(a).into();
                    (at.map(PreciseBall::rounded), direction.map(|n| (shape * n).rounded()))
                });
                let (triangle, terms) = (line.edge().triangle, terms.collect());
                holds.push(Hold { triangle, terms, most: *most });
            }
        }
        holds
    }

    /// For each contact edge the matrix of its springs, in doubles.
    pub fn springs(&self, lines: &[Piece<PreciseBall>]) -> Vec<DMatrix<f64>> {
        let of = |(line, part): (&Piece<PreciseBall>, &Option<PressedEdge>)| {
            let weight = line.weight().head();
            let nodes = line.p0.len();
            let mass =
                |a: usize, b: usize| part.as_ref().map_or(0.0, |part| part.mass[a][b].head());
            DMatrix::from_fn(nodes, nodes, |a, b| weight * mass(a, b))
        };
        lines.iter().zip(&self.edges).map(of).collect()
    }

    /// Adds what the springs of S do against v, the integral over S of P0(v) P0(w) / gamma for every basis function w.
    pub fn add_springs(
        &self,
        lines: &[Piece<PreciseBall>],
        v: &[[PreciseBall; 2]],
        forces: &mut [[PreciseBall; 2]],
    ) {
        for (line, part) in lines.iter().zip(&self.edges) {
            let Some(part) = part else { continue };
            let weight = line.weight();
            let p0 = line.p0(v);
            let springs: Row = part.mass.iter().map(|row| weight * dot(row, &p0)).collect();
            line.add_contact(&springs, forces);
        }
    }
}

fn dot(a: &Row, b: &Row) -> PreciseBall {
    a.iter().zip(b).fold(PreciseBall::from(0), |sum, (&a, &b)| sum + a * b)
}

fn add(sum: &mut [Row], other: &[Row]) {
    for (sum, &other) in sum.iter_mut().flatten().zip(other.iter().flatten()) {
        *sum += other;
    }
}

/// weight a b for all values a and b.
fn products(weight: PreciseBall, values: &[PreciseBall]) -> Vec<Row> {
    values.iter().map(|&a| values.iter().map(|&b| weight * a * b).collect()).collect()
}

/// (gamma / |E|)^{1/2}
fn root_of(line: &Piece<PreciseBall>) -> f64 {
    up((line.gamma / line.length).upper().sqrt())
}

/// An upper bound of a polynomial on an edge by its Bernstein coefficients, from its values at the nodes.
pub fn greatest(degree: Degree, p: &[PreciseBall]) -> f64 {
    degree.bernstein(p).iter().map(|p| p.upper()).fold(f64::NEG_INFINITY, f64::max)
}

/// How much P0(v) is along an edge at most where |v| is at most `far` at its nodes and `radius` in the energy norm a: n~ . v
/// is at most 5/4 of the largest nodal value, gamma |s(v)| at most 2 (gamma / |E|)^{1/2} |v|_a.
pub fn change(line: &Piece<PreciseBall>, far: f64, radius: f64) -> f64 {
    up(SAFETY * (1.25 * far + 2.0 * root_of(line) * radius))
}
