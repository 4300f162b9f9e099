//! Strong contact: the pieces of Gamma_C that are surely pressed around the computed displacement, and the matrix A_S of (8)
//! there. Where contact alone stops a rigid motion of the body, A is singular; A_S = A + the springs of those pieces S is not,
//! and on a ball around the displacement in which they stay pressed (8) is strongly monotone in its norm. docs/a-posteriori.md, 7.5,
//! has the proofs.
//!
//! |v|_S^2 = A(v, v) + int over S of P0(v)^2 / gamma
//!
//! The exact integral has the stretches of an edge between the roots of P for pieces, a Gauss rule its points.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::contact::Law;
use crate::contact::piece::Stretch;
use crate::contact::{Discretization, EdgeRule, Piece};
use crate::kernel::ball::{PreciseBall, up};
use crate::kernel::{Response, Scalar, edge_integral};
use crate::model::Degree;
use crate::proof::balls::Lines;
use crate::proof::korn::{Hold, Term};

/// The share of a stretch that is left out at a root of P, where P is too small to stay positive: without this, stretches that
/// end at a root hold nothing.
const INSET: f64 = 1.0 / 64.0;

/// Covers the rounding of a few sums, products and roots of positive doubles.
const SAFETY: f64 = 1.001;

/// r at the start and at the end of an edge, in a body of revolution: the weight of its integrals.
type Radii = Option<[PreciseBall; 2]>;

/// A weight times r at a place of an edge.
fn weighted(radii: Radii, place: PreciseBall, weight: PreciseBall) -> PreciseBall {
    radii.map_or(weight, |radii| weight * edge_integral::radius(radii, place))
}

/// The maximum on \[0, 1\] of the square of a polynomial with `count` coefficients whose square has the integral 1 with the weight r:
/// count^2 over the smaller r; or, as r is at least its larger value times the distance from the other end, count^2 (count + 1)^2 / 2
/// over that (docs/theory.md, 11.5).
fn most_in_revolution(count: usize, radii: [PreciseBall; 2]) -> f64 {
    let [least, most] = [f64::min, f64::max].map(|of| of(radii[0].lower(), radii[1].lower()));
    let (square, next) = ((count * count) as f64, ((count + 1) * (count + 1)) as f64);
    let by_least = if least > 0.0 { square / least } else { f64::INFINITY };
    up(by_least.min(square * next / 2.0 / most))
}

/// Values at the nodes of an edge, or their coefficients.
pub(super) type Row = Vec<PreciseBall>;

/// A piece of an edge.
pub(super) struct EdgePiece {
    /// Where it starts and ends; a point does both at once.
    pub(super) ends: [f64; 2],
    /// The coefficients on it, of a polynomial with given values at the nodes, that enclose the polynomial there (Bernstein's):
    /// first its values at the ends.
    coefficients: Vec<Row>,
    /// The most that the square of a polynomial is on it whose square has the integral 1 over it; attained at the ends.
    square: PreciseBall,
    /// The integrals of N_a N_b over it.
    pub(super) mass: Vec<Row>,
}

/// Where a quadratic polynomial with these values at the nodes has its extremum within the edge: on either side of the extremum
/// a positive polynomial has positive Bernstein coefficients, across it the coefficients may be negative.
fn turning_point(values: &Row) -> Option<f64> {
    let [start, end, middle] = values[..] else { return None };
    let [start, end, middle] = [start, end, middle].map(PreciseBall::head);
    let (slope, bend) = (4.0 * middle - 3.0 * start - end, start + end - 2.0 * middle);
    let at = -slope / (4.0 * bend);
    (at > 0.0 && at < 1.0).then_some(at)
}

/// The shares of a stretch that are left out at a root, where nothing is certain: the first with which the rest is.
const INSETS: [f64; 8] = [1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7];

/// The pressed (or stuck) stretches of one component on a piece of Gamma_C, on which q(P) = P is certain.
struct PressedPart {
    /// The piece.
    edge: usize,
    /// The numbers of the component's values among those of the piece.
    values: Range<usize>,
    /// Where the stretches start and end.
    pieces: Vec<[f64; 2]>,
    /// For each stretch the least that P is on it at the displacement, or is within the bound of friction, and the most that P0(v) is
    /// beside |v|_S.
    bounds: Vec<[f64; 2]>,
    /// The shape functions of the piece at the ends of the stretches, and the most that P0(v) is there, beside |v|_S.
    places: Vec<(Row, f64)>,
    /// The integrals of N_a N_b over them.
    mass: Vec<Row>,
}

/// S
pub struct Pressed {
    /// The number of pieces of Gamma_C.
    count: usize,
    /// The parts of S.
    parts: Vec<PressedPart>,
}

/// A stretch with the least that P is on it, or is within the bound of friction.
type Measured = (f64, EdgePiece);

impl EdgePiece {
    /// The pieces of an edge on which all of these polynomials are positive; of a stretch the first of the `insets`, in parts of the
    /// stretch, is left out at a root or a further cut with which they are.
    pub(super) fn positive(
        (degree, rule): (Degree, &EdgeRule),
        radii: Radii,
        all: &[Row],
        (insets, cuts): (&[f64], &[f64]),
    ) -> Vec<Self> {
        let EdgeRule::Gauss(points) = rule else {
            return Self::between_roots(degree, radii, all, (insets, cuts));
        };
        let at = |&(s, weight): &(f64, f64)| {
            let shapes = degree.edge_values(PreciseBall::from(s));
            let weight = weighted(radii, s.into(), weight.into());
            let (mass, square) = (products(weight, &shapes), PreciseBall::from(1) / weight);
            EdgePiece { ends: [s, s], coefficients: vec![shapes], square, mass }
        };
        points.iter().map(at).filter(|piece| least(&piece.coefficients, all) > 0.0).collect()
    }

    /// Those on which all of these polynomials are positive, as much of the piece as they are.
    pub(super) fn all_positive(
        d: &Discretization,
        piece: &Piece<PreciseBall>,
        all: &[Row],
    ) -> Vec<Self> {
        let cuts: Vec<f64> = all.iter().filter_map(turning_point).collect();
        Self::positive((d.space.degree(), &d.rule), piece.radii, all, (&INSETS, &cuts))
    }

    /// Those in the stretches between their roots and the further `cuts`.
    fn between_roots(
        degree: Degree,
        radii: Radii,
        all: &[Row],
        (insets, cuts): (&[f64], &[f64]),
    ) -> Vec<Self> {
        let roots = |p: &Row| degree.roots(&p.iter().map(|p| p.head()).collect::<Vec<_>>());
        let mut cuts: Vec<f64> = all.iter().flat_map(roots).chain(cuts.iter().copied()).collect();
        cuts.extend([0.0, 1.0]);
        cuts.sort_unstable_by(f64::total_cmp);
        let stretch = |cut: &[f64]| {
            insets.iter().find_map(|inset| {
                let inset = inset * (cut[1] - cut[0]);
                let start = if cut[0] > 0.0 { cut[0] + inset } else { 0.0 };
                let end = if cut[1] < 1.0 { cut[1] - inset } else { 1.0 };
                let is_positive =
                    || least(&coefficients(degree, [start.into(), end.into()]), all) > 0.0;
                (start < end && is_positive()).then(|| Self::between(degree, radii, [start, end]))
            })
        };
        cuts.windows(2).filter(|cut| cut[0] < cut[1]).filter_map(stretch).collect()
    }

    /// The piece of an edge with these ends. Boole's rule is exact for the products. The square is at most the sum of 2 k + 1
    /// over the length, for k up to the degree p: that is (p + 1)^2, as Legendre's polynomials are at most 1.
    fn between(degree: Degree, radii: Radii, ends: [f64; 2]) -> Self {
        let start = PreciseBall::from(ends[0]);
        let length = PreciseBall::from(ends[1]) - start;
        let place = |i: i32| start + PreciseBall::from(i) / PreciseBall::from(4) * length;
        let at = |i: i32| degree.edge_values(place(i));
        let coefficients = coefficients(degree, [start, ends[1].into()]);
        let count = degree.nodes_per_edge();
        let square = match radii {
            None => PreciseBall::from((count * count) as i32) / length,
            Some(_) => {
                let radius = |i: i32| weighted(radii, place(i), PreciseBall::from(1));
                PreciseBall::from(most_in_revolution(count, [radius(0), radius(4)])) / length
            }
        };
        let mut mass = vec![vec![PreciseBall::from(0); count]; count];
        for (i, weight) in [(0, 7), (1, 32), (2, 12), (3, 32), (4, 7)] {
            let weight = length * PreciseBall::from(weight) / PreciseBall::from(90);
            add(&mut mass, &products(weighted(radii, place(i), weight), &at(i)));
        }
        EdgePiece { ends, coefficients, square, mass }
    }
}

/// The coefficients between two places of a polynomial with given values at the nodes: see [`EdgePiece`].
fn coefficients(degree: Degree, [start, end]: [PreciseBall; 2]) -> Vec<Row> {
    let ends = [start, end].map(|place| degree.edge_values(place));
    if degree == Degree::One {
        return ends.into();
    }
    let [two, half] = [2.0, 0.5].map(PreciseBall::from);
    let middle = degree.edge_values(half * (start + end));
    let pairs = middle.iter().zip(ends[0].iter().zip(&ends[1]));
    let bend = pairs.map(|(&m, (&a, &b))| two * m - half * (a + b)).collect();
    let [first, last] = ends;
    vec![first, last, bend]
}

/// The least of these coefficients of some polynomials, or less.
fn least(coefficients: &[Row], all: &[Row]) -> f64 {
    let of = |p: &Row| coefficients.iter().map(|c| dot(c, p).lower()).fold(f64::INFINITY, f64::min);
    all.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// The distances of P_t from the bound on both sides, which must be positive where a piece sticks; `None` for pieces that never
/// stick.
fn stuck(line: &Piece<PreciseBall>, p: &[PreciseBall]) -> Option<[Row; 2]> {
    let Law::Friction(bound) = line.geometry.law else { return None };
    let bound = bound.at_nodes(line.gamma, line.along(p));
    let pairs = || bound.iter().zip(line.across(p));
    Some([pairs().map(|(&m, &p)| m - p).collect(), pairs().map(|(&m, &p)| m + p).collect()])
}

/// Returns whether P, at least `least`, stays positive on a ball of radius `rho` where P0 is `most` beside it.
fn stays(least: f64, most: f64, rho: f64) -> bool {
    least > SAFETY * most * rho
}

impl PressedPart {
    /// The part of the piece `line`, of number `edge`, in those of these stretches, each with the least that P is there, that stay so
    /// on a ball of radius `rho`. `None` where there are none.
    fn new(
        (edge, line): (usize, &Piece<PreciseBall>),
        values: Range<usize>,
        stretches: &[Measured],
        rho: f64,
    ) -> Option<Self> {
        let most = |piece: &EdgePiece| SAFETY * root_of(line) * piece.square.upper().sqrt();
        let stays = |(least, piece): &&Measured| stays(*least, most(piece), rho);
        let stretches: Vec<&Measured> = stretches.iter().filter(stays).collect();
        let mut mass = vec![vec![PreciseBall::from(0); values.len()]; values.len()];
        stretches.iter().for_each(|(_, piece)| add(&mut mass, &piece.mass));
        let bounds = stretches.iter().map(|(least, piece)| [*least, most(piece)]).collect();
        // In the plane the most of the square of P0 is above that of the stress, which is affine.
        let of_stress = SAFETY * root_of(line) * line.radii.map_or(0.0, |_| stress_factor(line));
        let at_ends = |(_, piece): &&Measured| {
            let (ends, most) = (piece.coefficients.iter().take(2), most(piece).max(of_stress));
            ends.map(|shapes| (shapes.clone(), most)).collect::<Vec<_>>()
        };
        let places = stretches.iter().flat_map(at_ends).collect();
        let pieces: Vec<[f64; 2]> = stretches.iter().map(|(_, piece)| piece.ends).collect();
        let part = PressedPart { edge, values, pieces, bounds, places, mass };
        (!part.pieces.is_empty()).then_some(part)
    }
}

impl Pressed {
    /// Nothing: |v|_S = |v|_A.
    pub(crate) fn nowhere(count: usize) -> Self {
        Pressed { count, parts: Vec::new() }
    }

    /// Finds the stretches that are pressed at the displacement `u` and stay so on a ball of radius `rho` around it; what pulls
    /// as well as it pushes is pressed whatever P is. And those that stick there likewise. Coulomb's bound moves with P_n: whether S
    /// stays so is then not for [`Pressed::stay`] to say.
    pub fn at(d: &Discretization, lines: &Lines, u: &[[PreciseBall; 2]], rho: f64) -> Self {
        let degree = d.space.degree();
        let positive = |line: &Piece<PreciseBall>, all: &[Row]| -> Vec<Measured> {
            let pieces = if d.has_coulomb() {
                EdgePiece::all_positive(d, line, all)
            } else {
                EdgePiece::positive((degree, &d.rule), line.radii, all, (&[INSET], &[]))
            };
            pieces.into_iter().map(|piece| (least(&piece.coefficients, all), piece)).collect()
        };
        let (mut parts, mut sticking) = (Vec::new(), Vec::new());
        for (edge, line) in lines.iter().enumerate() {
            let p = line.p(u);
            for (response, values) in line.responses() {
                let pieces = match response {
                    Response::Bilateral => {
                        vec![(f64::INFINITY, EdgePiece::between(degree, line.radii, [0.0, 1.0]))]
                    }
                    Response::Unilateral => positive(line, &[p[values.clone()].to_vec()]),
                };
                parts.extend(PressedPart::new((edge, line), values, &pieces, rho));
            }
            if let Some(within) = stuck(line, &p) {
                let (across, pieces) = (degree.nodes_per_edge()..p.len(), positive(line, &within));
                sticking.extend(PressedPart::new((edge, line), across, &pieces, rho));
            }
        }
        parts.append(&mut sticking);
        Pressed { count: d.contact.len(), parts }
    }

    /// For each piece of Gamma_C whether something of it is in S.
    pub fn edges(&self) -> impl Iterator<Item = bool> {
        (0..self.count).map(|e| self.parts.iter().any(|part| part.edge == e))
    }

    /// The stretches of piece `e` that are pressed in S, where they start and end on \[0, 1\].
    pub fn pieces(&self, e: usize) -> &[[f64; 2]] {
        let is_pressed = |part: &&PressedPart| part.edge == e && part.values.start == 0;
        self.parts.iter().find(is_pressed).map_or(&[], |part| &part.pieces)
    }

    /// Returns whether it is empty.
    pub(crate) fn is_nowhere(&self) -> bool {
        self.parts.is_empty()
    }

    /// Returns whether all of S stays pressed on a ball of radius `rho` and a little more.
    pub fn stay(&self, rho: f64) -> bool {
        let mut all = self.parts.iter().flat_map(|part| &part.bounds);
        all.all(|&[least, most]| stays(least, most, rho))
    }

    /// The holds of S: sums of n~ . v, or across n~ where it sticks, at the places of its nodes, less those on the other side, each
    /// times its shape function at a place of the piece: the jump is P0(v) + gamma s(v), for |v|_S (1 - kappa)^{-1/2} <= 1 at most what
    /// P0(v) is beside |v|_S.
    pub fn holds(&self, d: &Discretization, lines: &Lines) -> Vec<Hold> {
        let mut holds = Vec::new();
        for part in &self.parts {
            let line = &lines[part.edge];
            for (shapes, most) in &part.places {
                let mut terms = Vec::new();
                for (side, stretch) in line.geometry.stretches.iter().enumerate() {
                    for (i, &shape) in part.values.clone().zip(shapes) {
                        let at = place_in_balls(d, stretch, i % line.degree.nodes_per_edge());
                        let direction: [PreciseBall; 2] = line.direction_of(i).into();
                        let along = direction.map(|n| (shape * n).rounded());
                        let along = if side == 0 { along } else { along.map(|n| -n) };
                        let triangle = stretch.edge.triangle;
                        terms.push(Term { triangle, at: at.map(PreciseBall::rounded), along });
                    }
                }
                holds.push(Hold { terms, most: *most });
            }
        }
        holds
    }

    /// For each piece of Gamma_C the matrix of its springs, in doubles.
    pub(crate) fn springs(&self, lines: &Lines) -> Vec<DMatrix<f64>> {
        self.springs_of(lines, |weight, mass| weight.head() * mass.head())
    }

    /// For each piece of Gamma_C the matrix of its springs, in balls.
    pub(crate) fn springs_in_balls(&self, lines: &Lines) -> Vec<DMatrix<PreciseBall>> {
        self.springs_of(lines, |weight, mass| weight * mass)
    }

    fn springs_of<S: Scalar>(
        &self,
        lines: &Lines,
        spring: impl Fn(PreciseBall, PreciseBall) -> S,
    ) -> Vec<DMatrix<S>> {
        let nothing = |line: &Piece| DMatrix::from_element(line.p0.len(), line.p0.len(), S::zero());
        let mut springs: Vec<DMatrix<S>> = lines.in_doubles().iter().map(nothing).collect();
        for part in &self.parts {
            let weight = lines[part.edge].weight();
            for (i, row) in part.values.clone().zip(&part.mass) {
                for (j, mass) in part.values.clone().zip(row) {
                    springs[part.edge][(i, j)] = spring(weight, *mass);
                }
            }
        }
        springs
    }

    /// Adds what the springs of S do against v, the integral over S of P0(v) P0(w) / gamma for every basis function w.
    pub fn add_springs(
        &self,
        lines: &Lines,
        v: &[[PreciseBall; 2]],
        forces: &mut [[PreciseBall; 2]],
    ) {
        for part in &self.parts {
            let line = &lines[part.edge];
            let (weight, p0) = (line.weight(), line.p0(v)[part.values.clone()].to_vec());
            let springs: Row = part.mass.iter().map(|row| weight * dot(row, &p0)).collect();
            line.each_force(&line.p0[part.values.clone()], &springs, |node, f| {
                forces[node] = [forces[node][0] + f[0], forces[node][1] + f[1]];
            });
        }
    }
}

/// The place of a node of a piece on an edge: vertices are exact.
fn place_in_balls(d: &Discretization, stretch: &Stretch, a: usize) -> [PreciseBall; 2] {
    let mesh = d.space.mesh();
    let [start, end] = mesh.ends(stretch.edge).map(|v| mesh.vertices()[v].map(PreciseBall::from));
    let s = stretch.positions[a];
    match s {
        0.0 => start,
        1.0 => end,
        0.5 => [0, 1].map(|c| (start[c] + end[c]) * PreciseBall::from(0.5)),
        _ => [0, 1].map(|c| start[c] + (end[c] - start[c]) * PreciseBall::from(s)),
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
pub(crate) fn greatest(degree: Degree, p: &[PreciseBall]) -> f64 {
    degree.bernstein(p).iter().map(|p| p.upper()).fold(f64::NEG_INFINITY, f64::max)
}

/// An upper bound of P0(v) along a piece where |v| is at most `far` at the nodes of its edges, added up over its sides, and
/// `radius` in the energy norm a: gamma |s(v)| is at most 2 (gamma / |E|)^{1/2} |v|_a in the plane, and n~ . v at most 5/4 of the largest nodal
/// value; where the nodes of the piece are not those of the edge, that twice.
pub(crate) fn change(line: &Piece<PreciseBall>, far: f64, radius: f64) -> f64 {
    let spread = if line.sides.len() == 1 { 1.25 } else { 1.25 * 1.25 };
    up(SAFETY * (spread * far + stress_factor(line) * root_of(line) * radius))
}

/// The maximum on an edge of an affine function whose square has the integral 1 over \[0, 1\], with the weight.
fn stress_factor(line: &Piece<PreciseBall>) -> f64 {
    line.radii.map_or(2.0, |radii| up(most_in_revolution(2, radii).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Law;
    use crate::contact::piece::tests::beside;
    use crate::kernel::edge_integral::edge_mass;
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Diagonal, Problem, Rectangle};

    fn block(plane: Plane) -> Problem {
        let cells = Rectangle { width: 1.0, height: 1.0, nx: 1, ny: 1, diagonal: Diagonal::Right };
        Problem::of(cells.mesh().unwrap(), Material::lame(1.3, 0.7, plane))
            .with("top", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.0))
    }

    /// The sizes of the holds at the ends of a stretch of an edge on a floor, of degree 1, and what they are at least by the pressure on it
    /// and by the stress beside it.
    fn holds(plane: Plane, ends: [f64; 2]) -> (Vec<f64>, [f64; 2]) {
        let problem = block(plane);
        let rule = EdgeRule::Exact;
        let d = Discretization::new(&problem, Degree::One, |c| c.limit() / 2.0, rule).unwrap();
        let lines = Lines::new(&d);
        let line = &lines[0];
        let piece = EdgePiece::between(Degree::One, line.radii, ends);
        let least = [piece.square.lower().sqrt(), stress_factor(line)].map(|x| root_of(line) * x);
        let part = PressedPart::new((0, line), 0..2, &[(1.0, piece)], 0.0).unwrap();
        (part.places.iter().map(|(_, most)| *most).collect(), least)
    }

    #[test]
    fn a_hold_beside_the_axis_is_no_smaller_than_the_stress_of_the_whole_edge() {
        for ends in [[0.0, 1.0], [0.5, 1.0], [0.9, 1.0]] {
            for plane in [Plane::Strain, Plane::Axisymmetric] {
                let (found, [of_pressure, of_stress]) = holds(plane, ends);
                assert_eq!(found.len(), 2);
                let most = of_pressure.max(of_stress);
                assert!(found.iter().all(|size| *size >= most && *size < 1.01 * most));
            }
        }
        let (_, [of_pressure, of_stress]) = holds(Plane::Axisymmetric, [0.5, 1.0]);
        assert!(of_pressure < of_stress, "control: the pressure alone says less");
    }

    #[test]
    fn p0_changes_by_no_more_than_the_largest_stress_and_displacement_of_its_norms() {
        for plane in [Plane::Strain, Plane::Axisymmetric] {
            let (problem, rule) = (block(plane), EdgeRule::Exact);
            let d = Discretization::new(&problem, Degree::One, |c| c.limit() / 2.0, rule).unwrap();
            let lines = Lines::new(&d);
            let line = &lines[0];
            // The integrals of N_a N_b, with the weight r: an affine function of norm 1 is up to the root of an entry of the inverse.
            let [[a, b], [_, c]] = edge_mass(line.radii.map_or([1.0; 2], |r| r.map(|r| r.head())));
            let ends = [c, a].map(|other| (other / (a * c - b * b)).sqrt());
            let largest = ends[0].max(ends[1]) * (line.gamma / line.length).head().sqrt();
            let found = change(line, 0.0, 1.0);
            assert!(found >= largest && found <= 1.01 * SAFETY * largest, "{plane:?}: {found}");
            assert!(0.75 * found < largest, "control");
            // The sum of |N_a| of degree 2 is largest at a quarter of the edge.
            let shapes = Degree::Two.edge_values(0.25);
            let most: f64 = shapes.iter().map(|x: &f64| x.abs()).sum();
            assert_eq!(most, 1.25);
            assert!((most..1.01 * SAFETY * most).contains(&change(line, 1.0, 0.0)));
        }
    }

    #[test]
    fn a_node_of_a_piece_lies_on_its_edge_where_its_position_says() {
        let (problem, rule) = (block(Plane::Strain), EdgeRule::Exact);
        let d = Discretization::new(&problem, Degree::One, |c| c.limit() / 2.0, rule).unwrap();
        let mut stretch = d.contact[0].geometry.stretches[0].clone();
        let [start, end] = problem.mesh.ends(stretch.edge).map(|v| problem.mesh.vertices()[v]);
        for s in [0.0, 0.125, 1.0 / 3.0, 0.5, 0.9, 1.0] {
            stretch.positions = vec![s];
            let found = place_in_balls(&d, &stretch, 0).map(PreciseBall::head);
            for c in 0..2 {
                let expected = start[c] + (end[c] - start[c]) * s;
                assert!((found[c] - expected).abs() <= f64::EPSILON, "{s}: {found:?} {expected}");
            }
        }
    }

    /// The relative difference of the springs of a piece that is pressed all along, between two bodies with this r where they meet, from
    /// the second derivatives of its energy.
    fn off_the_energy((plane, r): (Plane, f64), law: Law, degree: Degree, radii: bool) -> f64 {
        let sides = [[r - 1.0, r], [r, r + 1.0]];
        let problem = beside(sides, Material::lame(1.3, 0.7, plane), 0.1);
        let mut problem = problem.with("outer", Condition::clamped());
        problem.pairs[0].law = law;
        let rule = EdgeRule::Exact;
        let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, rule).unwrap();
        let lines = Lines::new(&d);
        // Both are shortened towards where they meet.
        let u: Vec<[f64; 2]> = d.space.nodes().iter().map(|&[x, _]| [r - x, 0.0]).collect();
        let in_balls: Vec<[PreciseBall; 2]> = u.iter().map(|u| u.map(PreciseBall::from)).collect();
        let springs = Pressed::at(&d, &lines, &in_balls, 0.0).springs(&lines);
        let mut piece = d.contact[0].clone();
        piece.radii = piece.radii.filter(|_| radii);
        let energy = piece.contribution(&d.rule, &piece.p(&u)).tangent;
        let size = |of: &DMatrix<f64>| of.iter().map(|h| h * h).sum::<f64>().sqrt();
        size(&(&springs[0] - &energy)) / size(&energy)
    }

    #[test]
    fn springs_are_the_second_derivatives_of_the_energy() {
        for degree in [Degree::One, Degree::Two] {
            for law in [Law::Contact, Law::Sliding, Law::Bonded] {
                for at in [(Plane::Strain, 1.0), (Plane::Axisymmetric, 1.5)] {
                    let off = off_the_energy(at, law, degree, true);
                    assert!(off < 1e-9, "{at:?} {law:?} {degree:?}: {off}");
                }
                let off = off_the_energy((Plane::Axisymmetric, 1.5), law, degree, false);
                assert!(off > 0.1, "control: without the weight r {law:?} {degree:?}: {off}");
            }
        }
    }

    #[test]
    fn what_sticks_is_not_said_to_be_pressed() {
        let part = |edge: usize, values: Range<usize>, pieces: Vec<[f64; 2]>| {
            let (bounds, places, mass) = (Vec::new(), Vec::new(), Vec::new());
            PressedPart { edge, values, pieces, bounds, places, mass }
        };
        let (sticks, is_pressed) = (vec![[0.0, 1.0]], vec![[0.0, 0.5]]);
        let parts = vec![
            part(0, 2..4, sticks.clone()),
            part(1, 2..4, sticks),
            part(1, 0..2, is_pressed.clone()),
        ];
        let all = Pressed { count: 2, parts };
        assert!(all.pieces(0).is_empty());
        assert_eq!(all.pieces(1), is_pressed);
    }

    #[test]
    fn no_polynomial_is_larger_than_said_of_its_square_and_one_of_each_degree_is_as_large() {
        for degree in [Degree::One, Degree::Two] {
            for [start, end] in [[0.0, 1.0], [0.25, 0.75], [0.5, 0.625]] {
                let piece = EdgePiece::between(degree, None, [start, end]);
                // Legendre's polynomials times 2 k + 1 are the largest at the end, for their mean square.
                let largest = |x: f64| {
                    let t = (2.0 * x - start - end) / (end - start);
                    let bend = 2.5 * (3.0 * t * t - 1.0);
                    1.0 + 3.0 * t + if degree == Degree::Two { bend } else { 0.0 }
                };
                let square = |p: &dyn Fn(f64) -> f64| -> f64 {
                    let at: Vec<f64> =
                        [0.0, 1.0, 0.5][..degree.nodes_per_edge()].iter().map(|&x| p(x)).collect();
                    let rows = piece.mass.iter().zip(&at);
                    rows.map(|(row, p)| {
                        row.iter().zip(&at).map(|(m, q)| p * m.head() * q).sum::<f64>()
                    })
                    .sum()
                };
                let said = piece.square.head();
                let ratio = |p: &dyn Fn(f64) -> f64| p(end).powi(2) / (said * square(p));
                assert!((ratio(&largest) - 1.0).abs() < 1e-12, "{}", ratio(&largest));
                // The control: a polynomial that is not the largest.
                assert!(ratio(&|x| x) < 0.99);
            }
        }
    }
}
