//! Strong contact: the pieces of Gamma_C that are surely pressed around the computed displacement, and the matrix A_S of (8)
//! there. Where contact alone stops a rigid motion of the body, A is singular; A_S = A + the springs of those pieces S is not,
//! and on a ball around the displacement in which they stay pressed (8) is strongly monotone in its norm. docs/theory.md, 7.5,
//! has the proofs.
//!
//! |v|_S^2 = A(v, v) + int over S of P0(v)^2 / gamma
//!
//! The exact integral has the stretches of an edge between the roots of P for pieces, a Gauss rule its points.

use nalgebra::DMatrix;

use crate::fem::friction::Bound;
use crate::fem::korn::Hold;
use crate::fem::law::Law;
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
pub(super) type Row = Vec<PreciseBall>;

/// A piece of an edge.
pub(super) struct EdgePiece {
    /// Where it starts and ends; a point does both at once.
    ends: [f64; 2],
    /// The coefficients on it, of a polynomial with given values at the nodes, that enclose the polynomial there (Bernstein's):
    /// first its values at the ends.
    coefficients: Vec<Row>,
    /// The most that the square of a polynomial is on it whose square has the integral 1 over it; attained at the ends.
    square: PreciseBall,
    /// The integrals of N_a N_b over it.
    pub(super) mass: Vec<Row>,
    /// Its share of the edge: its length, or the weight of the point.
    pub(super) share: PreciseBall,
}

/// The pieces of an edge of which one component of P is surely in the range where it is integrated itself: pressed, or stuck.
struct PressedEdge {
    /// Where they start and end.
    pieces: Vec<[f64; 2]>,
    /// For each piece the least that P is on it at the displacement, or is within the bound of friction, and the most that P0(v) is
    /// beside |v|_S.
    bounds: Vec<[f64; 2]>,
    /// The shape functions of the edge at the ends of the pieces, and the most that P0(v) is there, beside |v|_S.
    places: Vec<(Row, f64)>,
    /// The integrals of N_a N_b over them.
    mass: Vec<Row>,
}

/// S
pub struct Pressed {
    /// For each contact edge what of it is in S, of each component: pressed, and stuck.
    edges: Vec<[Option<PressedEdge>; 2]>,
}

impl EdgePiece {
    /// The pieces of an edge on which all of these polynomials are positive; `inset` is the share of a stretch that is left out at a
    /// root.
    pub(super) fn positive(degree: Degree, rule: &EdgeRule, all: &[Row], inset: f64) -> Vec<Self> {
        let EdgeRule::Gauss(points) = rule else {
            return Self::between_roots(degree, all, inset);
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
                share: weight,
            }
        };
        points.iter().map(at).filter(|piece| piece.least(all) > 0.0).collect()
    }

    /// Those in the stretches between their roots.
    fn between_roots(degree: Degree, all: &[Row], inset: f64) -> Vec<Self> {
        let roots = |p: &Row| degree.roots(&p.iter().map(|p| p.head()).collect::<Vec<_>>());
        let mut cuts: Vec<f64> = all.iter().flat_map(roots).collect();
        cuts.extend([0.0, 1.0]);
        cuts.sort_unstable_by(f64::total_cmp);
        let stretch = |cut: &[f64]| {
            let inset = inset * (cut[1] - cut[0]);
            let start = if cut[0] > 0.0 { cut[0] + inset } else { 0.0 };
            let end = if cut[1] < 1.0 { cut[1] - inset } else { 1.0 };
            Self::between(degree, [start, end])
        };
        let stretches = cuts.windows(2).filter(|cut| cut[0] < cut[1]);
        stretches.map(stretch).filter(|piece| piece.least(all) > 0.0).collect()
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
        EdgePiece { ends, coefficients, square, mass, share: length }
    }

    /// The least coefficient of these polynomials, or less.
    fn least(&self, all: &[Row]) -> f64 {
        let of = |p: &Row| {
            self.coefficients.iter().map(|c| dot(c, p).lower()).fold(f64::INFINITY, f64::min)
        };
        all.iter().map(of).fold(f64::INFINITY, f64::min)
    }
}

/// What must be positive where an edge is pressed, and where it sticks: P_n, and what P_t is within Tresca's bound on both sides. Nothing
/// is said of what never sticks; of Coulomb's bound, which moves with P_n, nothing either.
fn surely(line: &Piece<PreciseBall>, p: &[PreciseBall]) -> [Vec<Row>; 2] {
    let (along, across) = (line.along(p), line.across(p));
    let stuck = match line.geometry.law {
        Law::Friction(bound @ Bound::Tresca(_)) => {
            let bound = bound.at_nodes(line.gamma, along);
            let pairs = || bound.iter().zip(across);
            vec![pairs().map(|(&m, &p)| m - p).collect(), pairs().map(|(&m, &p)| m + p).collect()]
        }
        _ => Vec::new(),
    };
    [vec![along.to_vec()], stuck]
}

impl PressedEdge {
    /// The part of the edge `line` in these pieces, on which `all` are positive. `None` where there are none.
    fn new(line: &Piece<PreciseBall>, all: &[Row], pieces: &[&EdgePiece]) -> Option<Self> {
        let count = line.degree.nodes_per_edge();
        let mut mass = vec![vec![PreciseBall::from(0); count]; count];
        pieces.iter().for_each(|piece| add(&mut mass, &piece.mass));
        let most = |piece: &EdgePiece| SAFETY * root_of(line) * piece.square.upper().sqrt();
        let bounds = pieces.iter().map(|piece| [piece.least(all), most(piece)]).collect();
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
        Pressed { edges: (0..count).map(|_| [None, None]).collect() }
    }

    /// Finds the pieces that are surely pressed at the displacement `u`, those that have their `share` of the pressure, and those that
    /// surely stick, of which the least distance to the bound has its share likewise.
    pub fn at(
        d: &Discretization,
        lines: &[Piece<PreciseBall>],
        u: &[[PreciseBall; 2]],
        share: f64,
    ) -> Self {
        type Found = (Vec<Row>, Vec<(f64, EdgePiece)>);
        let of = |all: Vec<Row>| -> Found {
            if all.is_empty() {
                return (all, Vec::new());
            }
            let pieces = EdgePiece::positive(d.space.degree(), &d.rule, &all, INSET).into_iter();
            let pieces = pieces.map(|piece| (piece.least(&all), piece)).collect();
            (all, pieces)
        };
        let edges: Vec<[Found; 2]> =
            lines.iter().map(|line| surely(line, &line.p(u)).map(of)).collect();
        let enough = [0, 1].map(|k| {
            let pieces = edges.iter().flat_map(|found| &found[k].1);
            share * pieces.fold(0.0, |most: f64, (least, _)| most.max(*least))
        });
        let part = |(line, found): (&Piece<PreciseBall>, &[Found; 2])| {
            [0, 1].map(|k| {
                let (all, pieces) = &found[k];
                let taken = pieces.iter().filter(|(least, _)| *least >= enough[k]);
                PressedEdge::new(line, all, &taken.map(|(_, piece)| piece).collect::<Vec<_>>())
            })
        };
        Pressed { edges: lines.iter().zip(&edges).map(part).collect() }
    }

    /// For each contact edge whether something of it is in S.
    pub fn edges(&self) -> impl Iterator<Item = bool> {
        self.edges.iter().map(|parts| parts.iter().any(Option::is_some))
    }

    /// The pieces of contact edge `e` that are pressed in S, where they start and end on \[0, 1\].
    pub fn pieces(&self, e: usize) -> &[[f64; 2]] {
        self.edges[e][0].as_ref().map_or(&[], |part| &part.pieces)
    }

    /// Returns whether all of S stays pressed on a ball of radius `rho` and a little more.
    pub fn stay(&self, rho: f64) -> bool {
        let mut all = self.edges.iter().flatten().flatten().flat_map(|part| &part.bounds);
        all.all(|[least, most]| *least > SAFETY * most * rho)
    }

    /// Each part of S with its edge, and the number of its first functional there.
    fn parts<'a>(
        &'a self,
        lines: &'a [Piece<PreciseBall>],
    ) -> impl Iterator<Item = (&'a Piece<PreciseBall>, usize, &'a PressedEdge)> {
        lines.iter().zip(&self.edges).flat_map(|(line, parts)| {
            let numbered = parts.iter().enumerate();
            numbered.filter_map(move |(k, part)| {
                Some((line, k * line.degree.nodes_per_edge(), part.as_ref()?))
            })
        })
    }

    /// The holds of S: sums of n~ . v, or across n~ where it sticks, at the nodes of its edges, each times its shape function at a place of the edge:
    /// n~ . v = P0(v) + gamma s(v), for |v|_S (1 - kappa)^{-1/2} <= 1: at most what P0(v) is beside |v|_S.
    pub fn holds(&self, d: &Discretization, lines: &[Piece<PreciseBall>]) -> Vec<Hold> {
        let mesh = d.space.mesh();
        let mut holds = Vec::new();
        for (line, first, part) in self.parts(lines) {
            let [start, end] =
                mesh.ends(line.edge()).map(|v| mesh.vertices()[v].map(PreciseBall::from));
            let middle = [0, 1].map(|c| (start[c] + end[c]) * PreciseBall::from(0.5));
            for (shapes, most) in &part.places {
                let nodes = [start, end, middle].into_iter().zip(shapes).enumerate();
                let terms = nodes.map(|(a, (at, &shape))| {
                    let direction: [PreciseBall; 2] = line.direction_of(first + a).into();
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
        let of = |(line, parts): (&Piece<PreciseBall>, &[Option<PressedEdge>; 2])| {
            let (weight, count) = (line.weight().head(), line.degree.nodes_per_edge());
            let mass = |i: usize, j: usize| match &parts[i / count] {
                Some(part) if i / count == j / count => part.mass[i % count][j % count].head(),
                _ => 0.0,
            };
            DMatrix::from_fn(line.p0.len(), line.p0.len(), |i, j| weight * mass(i, j))
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
        for (line, first, part) in self.parts(lines) {
            let weight = line.weight();
            let p0 = line.p0(v)[first..].to_vec();
            let mut springs = vec![PreciseBall::from(0); first];
            springs.extend(part.mass.iter().map(|row| weight * dot(row, &p0)));
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
