//! With Coulomb's friction the discrete equations may have several solutions. This file proves, around a computed solution,
//! that there is exactly one within a distance R, and bounds the distance to that solution: docs/theory.md, 13.6.
//!
//! With B the functionals, A = L L^T, Z = L^-1 B^T, G = Z^T Z and H0 the derivative of the terms of contact and friction where
//! the state (open, stick, slip) is certain, J0 = A + B^T H0 B. Newton's map v - J0^-1 F(v) moves u~ by at most `step`, and
//! brings two fields within R of u~ nearer to each other by a factor of at most
//!
//! q(R) = sum over the pieces of |E| / gamma times the integral of what J0^-1 makes of the forces by which the terms may differ from those
//! of H0 at a point, for P that changes by what a field of norm R does there.
//!
//! If step + q(R) R <= R and q(R) < 1, there is exactly one solution within R in the norm of A, and it is within step / (1 - q(R)).

use std::sync::Arc;

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::DMatrix;

use super::Unproved;
use super::balls::{Lines, field, free, root};
use super::columns::{AT_ONCE, Enclosed, Functional};
use super::pressed::{EdgePiece, Pressed, Row};
use crate::contact::{Discretization, Piece};
use crate::contact::{EdgeRule, Law};
use crate::kernel::Response;
use crate::kernel::ball::{PreciseBall, larger, up};
use crate::linear::dense::norm;
use crate::linear::factor::Factor;
use crate::linear::matrix::LowerTriangle;
use crate::linear::system::System;
use crate::memory;
use crate::model::Degree;
use crate::model::law::Bound;
use crate::solve::coulomb::coefficient;

/// The largest number of functionals, and the largest product of functionals and unknowns, for which a proof is tried: the time
/// grows with the cube of the first and with the second.
pub(super) const MOST_FUNCTIONALS: usize = 2_000;
pub(super) const MOST_ENTRIES: usize = 200_000_000;

/// Returns whether matrices of so many functionals, and their columns, are too large.
fn are_too_many(functionals: usize, unknowns: usize) -> bool {
    functionals > MOST_FUNCTIONALS || functionals * unknowns > MOST_ENTRIES
}

/// The shares of a column of the compliance that may be left: first so much that one correction does; where nothing is proved with that, a rounding error.
pub(super) const SHARES: [f64; 2] = [1e-7, f64::EPSILON];

/// The proved facts about the solution near a displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Isolated {
    /// |u~ - u^h|_A at most.
    pub(crate) rho: f64,
    /// There is no other solution within this distance, in the norm of A; `None` if that is known with springs only.
    pub(crate) within: Option<f64>,
    /// There is no other solution anywhere.
    pub(crate) everywhere: bool,
    /// Lower bounds of the coefficient below which that is so for all loads.
    pub(crate) limits: [f64; 2],
    /// The norm of gamma^{1/2} (lambda~ - lambda^h) at most.
    pub(crate) pressure: f64,
}

/// Bounds of A.
pub(super) struct Body<'a, 'd, 'p> {
    pub(crate) system: &'a System<'d, 'p>,
    /// Any factor, the better the nearer it is to that of A.
    pub(crate) factor: &'a Factor,
    /// Stretches that press, which A has springs on.
    pub(crate) pressed: &'a Pressed,
    /// |t|_A* <= the sum of these times |t_i|.
    pub(crate) crude: &'a [f64],
}

/// The data of bounds of A: neither loads nor gaps nor a displacement is among them.
#[derive(PartialEq)]
struct Data {
    /// A, with springs or without.
    matrix: LowerTriangle<PreciseBall>,
    /// B, row by row.
    functionals: Vec<Functional>,
    /// |t|_A* <= the sum of these times |t_i|.
    crude: Vec<f64>,
    /// The law of each piece, and the integrals of N_a N_b / gamma.
    friction: Vec<(Law, DMatrix<f64>)>,
}

/// The matrix G, enclosed.
struct Compliance {
    /// Its middle.
    g: Mat<f64>,
    /// A bound of the error of each entry.
    by: Mat<f64>,
    /// The largest of these, and the norm of what G is off.
    entry: f64,
    off: f64,
}

impl Compliance {
    /// The dual norms of the functionals, at most.
    fn norms(&self) -> Vec<f64> {
        let of = |i: usize| up(up(self.g[(i, i)].max(0.0) + self.by[(i, i)]).sqrt());
        (0..self.g.nrows()).map(of).collect()
    }
}

/// The sum of products of numbers that are not negative, rounded up.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    up(sum * (1.0 + f64::EPSILON * (a.len() + 16) as f64))
}

impl Body<'_, '_, '_> {
    /// A with the springs, and the functionals, in balls.
    fn data(&self, pieces: &Lines) -> Result<Data, Unproved> {
        let (system, count) = (self.system, self.system.functionals());
        let nodes = system.d.space.nodes().len();
        let mut functionals: Vec<Functional> = Vec::with_capacity(count);
        let zero = PreciseBall::from(0);
        for piece in pieces.iter() {
            for i in 0..piece.p0.len() {
                let mut unit = vec![zero; piece.p0.len()];
                unit[i] = PreciseBall::from(1);
                let mut forces = vec![[zero; 2]; nodes];
                piece.add_contact(&unit, &mut forces);
                let row = free(system, &forces).into_iter().enumerate();
                functionals.push(row.filter(|(_, b)| b.magnitude() != 0.0).collect());
            }
        }
        let (entries, n) = (system.matrix.values.len(), system.numbering.count);
        let bytes = size_of::<PreciseBall>() * entries + 64 * n * AT_ONCE.min(count);
        memory::check(bytes as u64).map_err(|_| Unproved::OutOfMemory)?;
        let springs = self.pressed.springs_in_balls(pieces);
        let matrix = system.tangent_in_balls(pieces.iter(), &springs);
        let matrix = matrix.map_err(|_| Unproved::OutOfMemory)?;
        let friction = |piece: &Piece<PreciseBall>| (piece.geometry.law, mass(system.d, piece));
        let friction = pieces.iter().map(friction).collect();
        Ok(Data { matrix, functionals, crude: self.crude.to_vec(), friction })
    }

    /// G = B A^-1 B^T: with z_j near A^-1 b_j and e_j = b_j - A z_j, the entry b_i . z_j is off by |b_i|_A* |e_j|_A* at most. The second
    /// is `share` of |b_j|_A*, or as small as it gets.
    fn compliance(&self, of: &Data, share: f64) -> Result<Compliance, Unproved> {
        let (rows, count) = (&of.functionals, of.functionals.len());
        let matrix = Enclosed::new(&of.matrix, &of.crude);
        let mut g = Mat::zeros(count, count);
        let mut radii: Mat<f64> = Mat::zeros(count, count);
        let (mut sizes, mut rests) = (vec![0.0; count], vec![0.0; count]);
        for (first, block) in (0..count).step_by(AT_ONCE).zip(rows.chunks(AT_ONCE)) {
            let z = matrix.columns(self.factor, block, share);
            for (column, own) in block.iter().enumerate() {
                let (j, rest) = (first + column, z.rests[column]);
                if !rest.is_finite() {
                    return Err(Unproved::OutOfRange);
                }
                rests[j] = rest;
                sizes[j] = up(rest + root(z.value(column, own)));
                for (i, row) in rows.iter().enumerate() {
                    let entry = z.value(column, row);
                    g[(i, j)] = entry.head();
                    radii[(i, j)] = up(entry.radius() + (entry.head() * f64::EPSILON).abs());
                }
            }
        }
        // The mean of an entry and its mirror is off by no more than the larger of their errors, as G is symmetric.
        let mean = mean_with_mirror(&g);
        let by = |i: usize, j: usize| up(radii[(i, j)] + sizes[i] * rests[j]);
        let by = Mat::from_fn(count, count, |i, j| {
            by(i, j).max(by(j, i)) + f64::EPSILON * mean[(i, j)].abs()
        });
        let (off, entry) = (row_sum(&by), largest(&by));
        Ok(Compliance { g: mean, by, entry, off })
    }
}

/// Bounds of linear combinations of P0_n(v) and P0_t(v) on a piece, for v of norm 1.
struct Reach {
    /// The bounds of P0_n and of P0_t; 0 where the piece does not feel that component.
    normal: f64,
    across: f64,
    /// Products of what the components at a node are, n with n, t with t, n with t; what these are off by, and what a component is.
    nodes: Vec<[f64; 3]>,
    entry: f64,
    slack: f64,
    /// The factor by which a polynomial exceeds its nodal values.
    between: f64,
}

impl Reach {
    /// The reach of P0: the products are the entries of G.
    fn new(piece: &Piece<PreciseBall>, of: &Compliance) -> Self {
        Reach::with(piece, [of.entry, 0.0], |i, j| of.g[(i, j)])
    }

    fn with(
        piece: &Piece<PreciseBall>,
        [entry, slack]: [f64; 2],
        product: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let count = piece.degree.nodes_per_edge();
        let first = piece.functionals().start;
        let is_rough = piece.p0.len() > count;
        let node = |i: usize| {
            let j = i + count;
            let normal = product(i, i);
            if is_rough { [normal, product(j, j), product(i, j)] } else { [normal, 0.0, 0.0] }
        };
        let between = match piece.degree {
            Degree::One => 1.0,
            Degree::Two => 1.25,
        };
        let nodes = (first..first + count).map(node).collect();
        let mut reach = Reach { normal: 0.0, across: 0.0, nodes, entry, slack, between };
        reach.normal = reach.of(1.0, 0.0);
        reach.across = if is_rough { reach.of(0.0, 1.0) } else { 0.0 };
        reach
    }

    /// The reach of a P0_n + b P0_t.
    fn of(&self, a: f64, b: f64) -> f64 {
        let size = a.abs() + b.abs();
        let square = |&[n, t, nt]: &[f64; 3]| {
            let magnitudes = a * a * n.abs() + b * b * t.abs() + 2.0 * (a * b * nt).abs();
            let value = a * a * n + b * b * t + 2.0 * a * b * nt;
            value.max(0.0) + 8.0 * f64::EPSILON * magnitudes + size * size * self.entry
        };
        let most = self.nodes.iter().map(square).fold(0.0, larger);
        up(self.between * (most.sqrt() + size * self.slack) * (1.0 + 1e-12))
    }

    /// Bounds what forces a P0_n(v) along and b P0_n(v) + c P0_t(v) across at a point do to a body whose answers to forces have this
    /// reach.
    fn through(&self, [a, b, c]: Terms, answer: &Reach) -> f64 {
        let by_forces = a.abs() * self.normal * answer.normal + self.of(b, c) * answer.across;
        let by_values = self.normal * answer.of(a, b) + c.abs() * self.across * answer.across;
        up(by_forces.min(by_values) * (1.0 + 1e-12))
    }
}

/// The derivative of the terms of a point: of the normal force by P_n, of the shear force by P_n and by P_t.
type Terms = [f64; 3];

/// The regions of a piece where, for all v within R, P_n(v) has one sign and P_t(v) lies within the bound or beyond on one side.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Region {
    Open,
    Pressed,
    Sticks,
    Right,
    Left,
}

/// The polynomials that are positive in each region of a piece, where P_n and P_t have the values `p` and change as for all v within
/// `r`.
fn regions(
    piece: &Piece<PreciseBall>,
    (p, reach): (&[PreciseBall], &Reach),
    r: f64,
) -> Vec<(Region, Vec<Row>)> {
    let less = |row: &Row, most: f64| -> Row {
        let by = PreciseBall::from(up(most * r * (1.0 + 1e-12)));
        row.iter().map(|&v| v - by).collect()
    };
    let minus = |row: &Row| -> Row { row.iter().map(|&v| -v).collect() };
    let sum = |a: &Row, b: &Row| -> Row { a.iter().zip(b).map(|(&a, &b)| a + b).collect() };
    let [normal, across] = [piece.along(p), piece.across(p)].map(<[PreciseBall]>::to_vec);
    let mut all = Vec::new();
    if piece.geometry.law.responses().first() == Some(&Response::Unilateral) {
        all.push((Region::Open, vec![less(&minus(&normal), reach.normal)]));
        all.push((Region::Pressed, vec![less(&normal, reach.normal)]));
    }
    if let Law::Friction(bound) = piece.geometry.law {
        let m = bound.at_nodes(piece.gamma, &normal);
        let mu = match bound {
            Bound::Coulomb(mu) => mu,
            _ => 0.0,
        };
        let [below, above] = [sum(&m, &minus(&across)), sum(&m, &across)];
        let [by_below, by_above] = [reach.of(mu, -1.0), reach.of(mu, 1.0)];
        all.push((Region::Sticks, vec![less(&below, by_below), less(&above, by_above)]));
        all.push((Region::Right, vec![less(&minus(&below), by_below)]));
        all.push((Region::Left, vec![less(&minus(&above), by_above)]));
    }
    all
}

/// The terms that may act at a point of these regions: each of P, and all between any two of them.
fn possible(law: Law, has: impl Fn(Region) -> bool) -> Vec<Terms> {
    let normal = match (has(Region::Open), has(Region::Pressed)) {
        (true, _) => vec![0.0],
        (_, true) => vec![1.0],
        _ => vec![0.0, 1.0],
    };
    let (sticks, right, left) = (has(Region::Sticks), has(Region::Right), has(Region::Left));
    let none_is_sure = !(sticks || right || left);
    match law {
        Law::Friction(Bound::Coulomb(mu)) => {
            let mut all = Vec::new();
            if normal.contains(&0.0) {
                all.push([0.0; 3]);
            }
            if normal.contains(&1.0) {
                let pressed =
                    [(sticks, [1.0, 0.0, 1.0]), (right, [1.0, mu, 0.0]), (left, [1.0, -mu, 0.0])];
                let found = pressed.into_iter().filter(|(is, _)| *is || none_is_sure);
                all.extend(found.map(|(_, terms)| terms));
            }
            all
        }
        Law::Friction(_) => {
            let across = [(sticks, 1.0), (right || left, 0.0)];
            let across = across.into_iter().filter(|(is, _)| *is || none_is_sure);
            across.flat_map(|(_, c)| normal.iter().map(move |&a| [a, 0.0, c])).collect()
        }
        _ if law.responses().first() == Some(&Response::Unilateral) => {
            normal.into_iter().map(|a| [a, 0.0, 0.0]).collect()
        }
        // P itself, whatever it is.
        _ => vec![[1.0, 0.0, 1.0]],
    }
}

/// The contributions of a piece to q and H0.
struct OnPiece<'a> {
    piece: &'a Piece<PreciseBall>,
    p: Row,
    reach: Reach,
    /// |E| / gamma
    weight: f64,
    /// The stretches on which H0 has these terms, which add up where they overlap.
    meant: Vec<([f64; 2], Terms)>,
    /// The block of H0, and the magnitudes that are added up in its entries.
    block: DMatrix<f64>,
    magnitudes: DMatrix<f64>,
}

impl<'a> OnPiece<'a> {
    /// With the terms at `u`: the normal ones, and the others where it is pressed.
    fn new(
        d: &Discretization,
        (piece, of): (&'a Piece<PreciseBall>, &Compliance),
        u: &[[PreciseBall; 2]],
    ) -> Self {
        let (reach, p) = (Reach::new(piece, of), piece.p(u));
        let law = piece.geometry.law;
        let all = regions(piece, (&p, &reach), 0.0);
        let pressed = all.iter().find(|(region, _)| *region == Region::Pressed);
        let pressed = pressed.map_or_else(Vec::new, |(_, rows)| rows.clone());
        let mut found: Vec<(EdgePiece, Terms)> = Vec::new();
        let mut add = |positive: &[Row], terms: Terms| {
            let parts = EdgePiece::all_positive(d, piece, positive).into_iter();
            found.extend(parts.map(|part| (part, terms)));
        };
        match law {
            Law::Friction(bound) => {
                let (mu, needs) = match bound {
                    Bound::Coulomb(mu) => (mu, pressed.clone()),
                    _ => (0.0, Vec::new()),
                };
                add(&pressed, [1.0, 0.0, 0.0]);
                for (region, rows) in &all {
                    let terms = match region {
                        Region::Open | Region::Pressed => continue,
                        Region::Sticks => [0.0, 0.0, 1.0],
                        Region::Right => [0.0, mu, 0.0],
                        Region::Left => [0.0, -mu, 0.0],
                    };
                    add(&[needs.clone(), rows.clone()].concat(), terms);
                }
            }
            _ if !pressed.is_empty() => add(&pressed, [1.0, 0.0, 0.0]),
            _ => add(&[], [1.0, 0.0, 1.0]),
        }
        let (count, nodes) = (piece.p0.len(), piece.degree.nodes_per_edge());
        let mut block = DMatrix::zeros(count, count);
        let mut magnitudes = block.clone();
        for (part, [normal, by_normal, across]) in &found {
            for (a, b) in (0..nodes * nodes).map(|k| (k / nodes, k % nodes)) {
                let mass = piece.weight().head() * part.mass[a][b].head();
                let mut add = |at: (usize, usize), entry: f64| {
                    block[at] += entry;
                    magnitudes[at] += entry.abs();
                };
                add((a, b), normal * mass);
                if count > nodes {
                    add((nodes + a, b), by_normal * mass);
                    add((nodes + a, nodes + b), across * mass);
                }
            }
        }
        let meant = found.into_iter().map(|(part, terms)| (part.ends, terms)).collect();
        OnPiece { piece, p, reach, weight: piece.weight().upper(), meant, block, magnitudes }
    }

    /// Bounds what the body does under the forces by which the terms differ from those of H0, for P of any two fields within `r`: once
    /// with the reach of its `answer` to forces, once with that of P0.
    fn uncertain(&self, d: &Discretization, r: f64, answer: &Reach) -> [f64; 2] {
        let law = self.piece.geometry.law;
        if law.responses().first() != Some(&Response::Unilateral) {
            return [0.0; 2];
        }
        let all = regions(self.piece, (&self.p, &self.reach), r);
        let mut sure: Vec<([f64; 2], Region)> = Vec::new();
        for (region, positive) in &all {
            let parts = EdgePiece::all_positive(d, self.piece, positive);
            sure.extend(parts.into_iter().map(|part| (part.ends, *region)));
        }
        let most = |[a, b]: [f64; 2]| {
            let within = |ends: &[f64; 2]| ends[0] <= a && b <= ends[1];
            let meant = self.meant.iter().filter(|(ends, _)| within(ends));
            let meant = meant.fold([0.0; 3], |sum: Terms, (_, terms)| add(sum, *terms, 1.0));
            let has = |region| sure.iter().any(|(ends, of)| *of == region && within(ends));
            let off = possible(law, has).into_iter().map(|terms| add(terms, meant, -1.0));
            off.filter(|off| *off != [0.0; 3]).fold([0.0; 2], |most: [f64; 2], off| {
                let both = [answer, &self.reach].map(|answer| self.reach.through(off, answer));
                [larger(most[0], both[0]), larger(most[1], both[1])]
            })
        };
        let plus = |sum: [f64; 2], (share, most): (f64, [f64; 2])| {
            [sum[0] + share * most[0], sum[1] + share * most[1]]
        };
        let sum = match &d.rule {
            EdgeRule::Gauss(points) => {
                let radius = |s: f64| {
                    self.piece.radii.map_or(1.0, |radii| {
                        let [a, b] = radii.map(|r| r.upper());
                        (1.0 - s) * a + s * b
                    })
                };
                let of = |&(s, weight): &(f64, f64)| (weight * radius(s), most([s, s]));
                points.iter().map(of).fold([0.0; 2], plus)
            }
            EdgeRule::Exact => {
                let ends = self.meant.iter().map(|(ends, _)| ends);
                let ends = ends.chain(sure.iter().map(|(ends, _)| ends));
                let mut cuts: Vec<f64> = ends.flatten().copied().chain([0.0, 1.0]).collect();
                cuts.sort_unstable_by(f64::total_cmp);
                let radius = self.largest_radius();
                let stretches = cuts.windows(2).filter(|cut| cut[0] < cut[1]);
                let of = |cut: &[f64]| ((cut[1] - cut[0]) * radius, most([cut[0], cut[1]]));
                stretches.map(of).fold([0.0; 2], plus)
            }
        };
        sum.map(|sum| up(self.weight * sum * (1.0 + 1e-12)))
    }

    /// The largest weight r along the piece; 1 in the plane.
    fn largest_radius(&self) -> f64 {
        self.piece.radii.map_or(1.0, |radii| radii.iter().map(|r| r.upper()).fold(0.0, larger))
    }

    /// Bounds what the body does under the forces by which the block of H0, and these `springs`, are rounded: entries are rounded
    /// from balls, by some units in the last place. The functionals have the `norms`, and J0^-1 of them the norms `answers`.
    fn rounding(&self, springs: Option<&DMatrix<f64>>, [norms, answers]: [&[f64]; 2]) -> f64 {
        let [norms, answers] = [norms, answers].map(|of| &of[self.piece.functionals()]);
        let rounded = |i: usize, j: usize| {
            1e-14 * (self.magnitudes[(i, j)] + springs.map_or(0.0, |springs| springs[(i, j)].abs()))
        };
        let row = |i: usize| (0..norms.len()).map(|j| rounded(i, j) * norms[j]).sum::<f64>();
        up(answers.iter().enumerate().map(|(i, answer)| answer * row(i)).sum::<f64>()
            * (1.0 + 1e-12))
    }

    /// Bounds the square of gamma^{1/2} times the change of pressure and shear beside |v|.
    fn pressure(&self) -> f64 {
        let (n, t) = (self.reach.normal, self.reach.across);
        let mu = coefficient(self.piece).unwrap_or(0.0);
        let radius = self.largest_radius();
        up(self.weight * radius * (n * n + (mu * n + t) * (mu * n + t)) * (1.0 + 1e-12))
    }
}

/// a + s b
fn add(a: Terms, b: Terms, s: f64) -> Terms {
    std::array::from_fn(|i| a[i] + s * b[i])
}

/// g of a piece: the largest eigenvalue of the blocks of G at its nodes, times what a polynomial exceeds its nodal values by.
fn largest_eigenvalue(piece: &Piece<PreciseBall>, of: &Compliance) -> f64 {
    let Reach { nodes, entry, between, .. } = Reach::new(piece, of);
    let largest = |&[a, b, c]: &[f64; 3]| (a + b) / 2.0 + ((a - b) / 2.0).hypot(c) + 4.0 * entry;
    let most = nodes.iter().map(largest).fold(0.0, larger);
    up(most * between * between * (1.0 + 1e-12))
}

/// s M + t
fn combined(m: &Mat<f64>, s: f64, t: f64) -> Mat<f64> {
    Mat::from_fn(m.nrows(), m.ncols(), |i, j| s * m[(i, j)] + if i == j { t } else { 0.0 })
}

/// M x
fn times(m: &Mat<f64>, x: &[f64]) -> Vec<f64> {
    let row = |i: usize| x.iter().enumerate().map(|(j, x)| m[(i, j)] * x).sum();
    (0..m.nrows()).map(row).collect()
}

/// Returns whether a symmetric matrix is positive definite, proved in floating point: Cholesky's method runs to its end on the
/// matrix less a multiple of 1 that is larger than what rounding can do (Rump, BIT 46, 2006) and than `off`, what the matrix is off.
fn is_positive_definite(matrix: &Mat<f64>, off: f64) -> bool {
    let n = matrix.nrows();
    let trace: f64 = (0..n).map(|i| matrix[(i, i)]).sum();
    let shift = up(off + 2.0 * (n + 3) as f64 * f64::EPSILON * trace.abs());
    shift.is_finite() && combined(matrix, 1.0, -shift).llt(Side::Lower).is_ok()
}

/// The length of a column, to a rounding error.
fn length_of(matrix: &Mat<f64>, j: usize) -> f64 {
    (0..matrix.nrows()).map(|i| matrix[(i, j)] * matrix[(i, j)]).sum::<f64>().sqrt()
}

/// The largest row sum of magnitudes, which bounds the norm of a symmetric matrix.
fn row_sum(matrix: &Mat<f64>) -> f64 {
    let row = |i: usize| (0..matrix.ncols()).map(|j| matrix[(i, j)].abs()).sum::<f64>();
    up((0..matrix.nrows()).map(row).fold(0.0, larger) * (1.0 + 1e-9))
}

fn largest(matrix: &Mat<f64>) -> f64 {
    let entries = (0..matrix.ncols()).flat_map(|j| (0..matrix.nrows()).map(move |i| (i, j)));
    entries.map(|at| matrix[at].abs()).fold(0.0, larger)
}

fn frobenius(matrix: &Mat<f64>) -> f64 {
    let entries = (0..matrix.ncols()).flat_map(|j| (0..matrix.nrows()).map(move |i| (i, j)));
    up(entries.map(|at| matrix[at] * matrix[at]).sum::<f64>().sqrt() * (1.0 + 1e-9))
}

/// C with C C^T >= G, in scaled functionals: the diagonal of what it is a factor of is about 1.
///
/// With Z = V C^T, V is no longer than 1, and every 1 - V Y V^T no longer than 1 - Y or 1: it is what an isometry makes of it, cut off.
struct Root {
    /// Powers of two that the functionals are multiplied by.
    scale: Vec<f64>,
    /// G, scaled, and what it is off.
    g: Mat<f64>,
    by: Mat<f64>,
    c: Mat<f64>,
}

impl Root {
    fn new(of: &Compliance) -> Option<Self> {
        let n = of.g.nrows();
        let power = |i: usize| {
            let size = of.g[(i, i)].max(f64::MIN_POSITIVE);
            (-0.5 * size.log2()).round().clamp(-500.0, 500.0).exp2()
        };
        let scale: Vec<f64> = (0..n).map(power).collect();
        let scaled = |m: &Mat<f64>| Mat::from_fn(n, n, |i, j| scale[i] * m[(i, j)] * scale[j]);
        let (g, by) = (scaled(&of.g), scaled(&of.by));
        let off = row_sum(&by);
        let trace: f64 = (0..n).map(|i| g[(i, i)].abs()).sum();
        let mut shift = 4.0 * (off + (n + 8) as f64 * f64::EPSILON * trace);
        for _ in 0..6 {
            let shifted = combined(&g, 1.0, shift);
            if let Ok(llt) = shifted.llt(Side::Lower) {
                let c = llt.L().to_owned();
                let rest = &shifted - &c * c.transpose();
                let size = frobenius(&c);
                let rounding = 2.0 * (n + 8) as f64 * f64::EPSILON * size * size;
                if row_sum(&rest) + rounding + off <= shift * (1.0 - 1e-9) {
                    return Some(Root { scale, g, by, c });
                }
            }
            shift *= 16.0;
        }
        None
    }

    /// H, scaled, of its blocks.
    fn scaled(&self, blocks: &[DMatrix<f64>]) -> Mat<f64> {
        let n = self.c.nrows();
        let mut h = Mat::<f64>::zeros(n, n);
        let mut first = 0;
        for block in blocks {
            for (i, k) in (0..block.ncols()).flat_map(|k| (0..block.nrows()).map(move |i| (i, k))) {
                let scale = self.scale[first + i] * self.scale[first + k];
                h[(first + i, first + k)] = block[(i, k)] / scale;
            }
            first += block.nrows();
        }
        h
    }

    /// C^T H C, and the norm of what rounding makes of it.
    fn around(&self, h: &Mat<f64>) -> (Mat<f64>, f64) {
        let n = self.c.nrows();
        let product = self.c.transpose() * (h * &self.c);
        let magnitudes = magnitudes(&self.c).transpose() * (magnitudes(h) * magnitudes(&self.c));
        let rounding = 4.0 * (n + 16) as f64 * f64::EPSILON;
        (product, up(rounding * frobenius(&magnitudes)))
    }

    /// About the inverse of 1 + Z H Z^T, for these blocks of H: with any K, 1 - Z K Z^T is nearly that,
    ///
    /// (1 + Z H Z^T) (1 - Z K Z^T) = 1 + Z (H - K - H G K) Z^T.
    fn inverse(&self, blocks: &[DMatrix<f64>]) -> Option<Inverse> {
        let n = self.c.nrows();
        let h = self.scaled(blocks);
        let hg = &h * &self.g;
        let k = combined(&hg, 1.0, 1.0).partial_piv_lu().solve(&h);
        let hgk = &hg * &k;
        let [c, size_h, size_g, size_k] = [&self.c, &h, &self.g, &k].map(magnitudes);
        let products = (&size_h * &size_g) * &size_k;
        let rounding = 4.0 * (n + 16) as f64 * f64::EPSILON;
        let most = Mat::from_fn(n, n, |i, j| {
            let rest = h[(i, j)] - k[(i, j)] - hgk[(i, j)];
            rest.abs() + rounding * (size_h[(i, j)] + size_k[(i, j)] + products[(i, j)])
        });
        // C^T H E K C, E being what G is off, entry by entry.
        let lengths = |m: &Mat<f64>| -> Vec<f64> { (0..n).map(|j| length_of(m, j)).collect() };
        let of_c = lengths(&c.transpose().to_owned());
        // The lengths of the columns of C^T M.
        let columns = |m: &Mat<f64>| -> Vec<f64> {
            let rounded = |j: usize| (0..n).map(|i| m[(i, j)].abs() * of_c[i]).sum::<f64>();
            let found = lengths(&(self.c.transpose() * m));
            found.iter().enumerate().map(|(j, length)| up(length + rounding * rounded(j))).collect()
        };
        let of_e = |j: usize, of: &[f64]| (0..n).map(|i| of[i] * self.by[(i, j)]).sum::<f64>();
        let (by_h, by_k) = (columns(&h), columns(&k.transpose().to_owned()));
        let by_g = (0..n).map(|j| of_e(j, &by_h) * by_k[j]).sum::<f64>() * (1.0 + 1e-9);
        let left = up(frobenius(&(c.transpose() * (&most * &c))) * (1.0 + rounding) + by_g);
        let (y, off) = self.around(&k);
        let norm = up(longest(&combined(&y, -1.0, 1.0))? + off).max(1.0);
        if !(left < 1.0) {
            return None;
        }
        // C^T (1 - K G)
        let answers = self.c.transpose() * combined(&(&k * &self.g), -1.0, 1.0);
        let sizes = c.transpose() * combined(&(&size_k * &size_g), 1.0, 1.0);
        let by_k = columns(&k);
        let slack = (0..n)
            .map(|j| {
                up((rounding * length_of(&sizes, j) + of_e(j, &by_k)) * (1.0 + 1e-9)
                    / self.scale[j])
            })
            .collect();
        let answers = Mat::from_fn(n, n, |i, j| answers[(i, j)] / self.scale[j]);
        let forces = Mat::from_fn(n, n, |i, j| k[(i, j)] * self.scale[j]);
        let forces = self.c.transpose() * forces;
        let size_of_forces = Mat::from_fn(n, n, |i, j| size_k[(i, j)] * self.scale[j]);
        let rounded = frobenius(&(c.transpose() * size_of_forces)) * rounding;
        Some(Inverse { forces, rounded, norm, left, answers, slack })
    }
}

/// Bounds of the inverse of 1 + Z H Z^T.
struct Inverse {
    /// |Z K w| is at most the length of this times w, and the second times |w|.
    forces: Mat<f64>,
    rounded: f64,
    /// The norm of 1 - Z K Z^T, at most, and that of what its product with 1 + Z H Z^T differs from 1 by.
    norm: f64,
    left: f64,
    /// (1 - Z K Z^T) Z is V times this, and what its columns are off by, in length.
    answers: Mat<f64>,
    slack: Vec<f64>,
}

impl Inverse {
    /// The norm of the inverse, at most.
    fn bound(&self) -> f64 {
        up(self.norm / (1.0 - self.left))
    }

    /// The reach of the answers to forces at points of a piece, but for `left`.
    fn reach(&self, piece: &Piece<PreciseBall>) -> Reach {
        let slack = piece.functionals().map(|j| self.slack[j]).fold(0.0, larger);
        let n = self.answers.nrows();
        let product = |i: usize, j: usize| -> f64 {
            (0..n).map(|row| self.answers[(row, i)] * self.answers[(row, j)]).sum()
        };
        let most = piece.functionals().map(|j| product(j, j)).fold(0.0, larger);
        let rounding = up(most * (n + 16) as f64 * f64::EPSILON);
        Reach::with(piece, [rounding, slack], product)
    }

    /// The norms of J0^-1 b for the functionals b, at most, which have these `norms` themselves.
    fn answers_of(&self, norms: &[f64]) -> Vec<f64> {
        let of = |(j, norm): (usize, &f64)| {
            let own = length_of(&self.answers, j) + self.slack[j];
            up(own * (1.0 + 1e-9) + self.bound() * (self.left * norm))
        };
        norms.iter().enumerate().map(of).collect()
    }

    /// The size of (1 + Z H Z^T)^-1 t, at most, where Z^T t = w: |t| <= `rho`, and of w it is known to `rest` in the length of t.
    fn times(&self, w: &[PreciseBall], [rho, rest]: [f64; 2]) -> f64 {
        let n = self.forces.nrows();
        let heads: Vec<f64> = w.iter().map(|w| w.head()).collect();
        let image = norm(&times(&self.forces, &heads));
        let off: Vec<f64> =
            w.iter().map(|w| up(w.radius() + w.head().abs() * f64::EPSILON)).collect();
        let by_radius = frobenius(&self.forces) * norm(&off);
        let by_rounding = (self.rounded + frobenius(&self.forces) * (n + 16) as f64 * f64::EPSILON)
            * (norm(&heads) + norm(&off));
        let sum = rho + (image + by_radius + by_rounding) * (1.0 + 1e-9) + (1.0 + self.norm) * rest;
        up((sum + self.bound() * self.left * rho) * (1.0 + 1e-12))
    }
}

/// An upper bound of the norm of a matrix.
fn longest(matrix: &Mat<f64>) -> Option<f64> {
    let (n, size) = (matrix.ncols(), frobenius(matrix));
    let square = matrix.transpose() * matrix;
    let rounding = 2.0 * (n + 8) as f64 * f64::EPSILON * size * size;
    let near = power(n, |x| times(&square, x)).max(f64::MIN_POSITIVE);
    [1.01, 1.1, 1.5, 2.0, 4.0].into_iter().find_map(|more| {
        let most = up(near * more + rounding);
        is_positive_definite(&combined(&square, -1.0, most), rounding).then(|| up(most.sqrt()))
    })
}

fn mean_with_mirror(matrix: &Mat<f64>) -> Mat<f64> {
    let mean = |i: usize, j: usize| (matrix[(i, j)] + matrix[(j, i)]) / 2.0;
    Mat::from_fn(matrix.nrows(), matrix.ncols(), mean)
}

fn magnitudes(matrix: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)].abs())
}

/// The data that do not depend on the displacement.
pub(crate) struct Known {
    of: Data,
    compliance: Compliance,
    root: Root,
    /// The springs of A_S; none for A.
    springs: Option<Vec<DMatrix<f64>>>,
    /// The share of each column of the compliance that may be left.
    pub(super) share: f64,
    everywhere: bool,
    limits: [f64; 2],
}

impl Known {
    /// For these pieces of the body, with these springs or without, and with what may be left of the columns of the compliance: the
    /// one that is `at_hand`, without springs, if it is of the same.
    ///
    /// # Errors
    /// Why nothing is proved.
    pub(super) fn new(
        body: &Body,
        pieces: &Lines,
        springs: Option<&[DMatrix<f64>]>,
        share: f64,
        at_hand: Option<Arc<Known>>,
    ) -> Result<Arc<Self>, Unproved> {
        let (system, count) = (body.system, body.system.functionals());
        let unknowns = system.numbering.count;
        if are_too_many(count, unknowns) {
            return Err(Unproved::TooManyFunctionals { count, unknowns });
        }
        let of = body.data(pieces)?;
        let is_known = |known: &Arc<Known>| known.share <= share && known.of == of;
        if let Some(known) = at_hand.filter(is_known) {
            return Ok(known);
        }
        let compliance = body.compliance(&of, share)?;
        let root = Root::new(&compliance).ok_or(Unproved::NotIsolated)?;
        let springs = springs.map(<[_]>::to_vec);
        let (everywhere, limits) = match springs {
            Some(_) => (false, [0.0; 2]),
            None => {
                let limits = limits(system.d, pieces, &compliance, &root);
                let most = pieces.iter().filter_map(coefficient).fold(0.0, f64::max);
                let is_below = limits.iter().any(|&limit| most < limit);
                (is_below || is_unique(system.d, pieces, &root), limits)
            }
        };
        Ok(Arc::new(Known { of, compliance, root, springs, share, everywhere, limits }))
    }
}

/// The residual at a displacement, of which the forces of contact are known up to some numbers.
pub(super) struct Rest<'a> {
    /// Its dual norm for certain forces, at most.
    pub(crate) rho: f64,
    /// A z with this z is that residual, up to a functional of at most this dual norm.
    pub(crate) z: &'a [PreciseBall],
    pub(crate) left: f64,
    /// Bounds of what the force of each functional is off.
    pub(crate) spread: &'a [f64],
    /// The norm of the displacement.
    pub(crate) size: f64,
}

/// Returns whether a map that brings two points of a ball nearer by the factor `q` and moves its centre by `step` stays in the ball, whose
/// radius is `r`: then one point there, and no other, stays where it is.
fn contracts(step: f64, q: f64, r: f64) -> bool {
    up(step + up(q * r)) <= r && q < 1.0
}

/// Decides around the displacement `u` with the residual `of`. The norm is that of A, or of A with the springs that are
/// `known`; `by_a` then has the bounds without springs.
///
/// # Errors
/// Why nothing is proved.
pub(super) fn isolate(
    (known, by_a): (&Known, Option<&Known>),
    pieces: &Lines,
    u: &[[PreciseBall; 2]],
    system: &System,
    &Rest { rho, z, left, spread, size }: &Rest,
) -> Result<Isolated, Unproved> {
    let d = system.d;
    let Known { compliance, root, springs, .. } = known;
    // A displacement in double-doubles may be as near as that.
    let norms = compliance.norms();
    let start = (rho + product(spread, &norms)).max(f64::EPSILON * f64::EPSILON * size);
    let all: Vec<OnPiece> =
        pieces.iter().map(|piece| OnPiece::new(d, (piece, compliance), u)).collect();
    let blocks: Vec<DMatrix<f64>> = match springs {
        Some(springs) => all.iter().zip(springs).map(|(on, s)| &on.block - s).collect(),
        None => all.iter().map(|on| on.block.clone()).collect(),
    };
    let inverse = root.inverse(&blocks).ok_or(Unproved::NotIsolated)?;
    let sizes = inverse.answers_of(&norms);
    let spring = |e: usize| springs.as_ref().map(|all| &all[e]);
    let rounding = all.iter().enumerate().map(|(e, on)| on.rounding(spring(e), [&norms, &sizes]));
    let rounding: f64 = rounding.sum();
    let answers: Vec<Reach> = pieces.iter().map(|piece| inverse.reach(piece)).collect();
    // Bounds of the contraction of two fields within r by a step, and of the first step.
    let nearer = |r: f64| {
        let pairs = all.iter().zip(&answers);
        let [sum, crude] = pairs.fold([0.0; 2], |[sum, crude], (on, answer)| {
            let [by_answer, by_norm] = on.uncertain(d, r, answer);
            [sum + by_answer, crude + by_norm]
        });
        let rest = inverse.bound() * (inverse.left * crude) + rounding;
        up((sum + rest) * (1.0 + f64::EPSILON * (all.len() + 16) as f64))
    };
    let v = field(system, |number, _, _| z[number], |_, _| 0.0);
    let w: Vec<PreciseBall> = pieces.iter().flat_map(|piece| piece.p0(&v)).collect();
    let step = up(inverse.times(&w, [rho, left]) + product(spread, &sizes));
    let holds = |r: f64| {
        let q = nearer(r);
        contracts(step, q, r).then_some(q)
    };
    let radii =
        (0..160).map(|k| start * 2.0_f64.powi(k)).take_while(|&r| r <= 1e3 * size.max(start));
    let mut found: Option<(f64, f64)> = None;
    for r in radii {
        match (holds(r), &mut found) {
            (Some(q), None) => found = Some((q, r)),
            (Some(_), Some((_, within))) => *within = r,
            (None, Some(_)) => break,
            (None, None) => {}
        }
    }
    let (q, within) = found.ok_or(Unproved::NotIsolated)?;
    let radius = up(step / (1.0 - q) * (1.0 + 1e-12));
    let stiffness: f64 = all.iter().map(OnPiece::pressure).sum();
    let pressure = up((stiffness * (1.0 + 1e-9)).sqrt() * radius);
    let of_a = if springs.is_some() { by_a } else { Some(known) };
    let within = of_a.map(|of_a| match springs {
        None => within,
        // |v|_S^2 = |v|_A^2 + the springs' integral of P0(v)^2 / gamma, which is at most 1 / gamma times g of A on each piece.
        Some(_) => {
            let of = |piece: &Piece<PreciseBall>| {
                2.0 * piece.weight().upper() * largest_eigenvalue(piece, &of_a.compliance)
            };
            within / up((1.0 + pieces.iter().map(of).sum::<f64>()).sqrt() * (1.0 + 1e-9))
        }
    });
    let (everywhere, limits) = of_a.map_or((false, [0.0; 2]), |a| (a.everywhere, a.limits));
    Ok(Isolated { rho: radius, within, everywhere, limits, pressure })
}

/// The integrals of N_a N_b / gamma over a piece, by the rule of the method.
fn mass(d: &Discretization, piece: &Piece<PreciseBall>) -> DMatrix<f64> {
    let nodes = piece.degree.nodes_per_edge();
    let mut mass = DMatrix::zeros(nodes, nodes);
    for part in EdgePiece::all_positive(d, piece, &[]) {
        let of_part = |a: usize, b: usize| piece.weight().head() * part.mass[a][b].head();
        mass += DMatrix::from_fn(nodes, nodes, of_part);
    }
    mass
}

/// C^T M C, and a bound of its error: M are the integrals of `weight`(mu) N_a N_b / gamma of the functionals that feel
/// Coulomb's friction. Its largest eigenvalue is at least that of G^(1/2) M G^(1/2).
fn of_friction(
    d: &Discretization,
    pieces: &Lines,
    root: &Root,
    weight: impl Fn(f64) -> f64,
) -> (Mat<f64>, f64) {
    let block = |piece: &Piece<PreciseBall>| {
        let (count, nodes) = (piece.p0.len(), piece.degree.nodes_per_edge());
        let mut block = DMatrix::zeros(count, count);
        if let Some(mu) = coefficient(piece) {
            let mut across = block.view_mut((nodes, nodes), (nodes, nodes));
            across.copy_from(&(weight(mu) * mass(d, piece)));
        }
        block
    };
    let blocks: Vec<DMatrix<f64>> = pieces.iter().map(block).collect();
    let (inner, off) = root.around(&root.scaled(&blocks));
    (mean_with_mirror(&inner), up(off * (1.0 + 1e-9)))
}

/// Returns whether 1 - `by` M is surely positive definite, where M is off by `off`.
fn is_below_one(m: &Mat<f64>, off: f64, by: f64) -> bool {
    let rounding = m.nrows() as f64 * f64::EPSILON;
    is_positive_definite(&combined(m, -by, 1.0), up(by * off * (1.0 + 1e-9) + rounding))
}

/// Returns whether there is exactly one solution, whatever the loads: 1 - (1/4) G^(1/2) M G^(1/2) is positive definite, M being the
/// integrals of mu^2 N_a N_b / gamma of the tangential functionals.
fn is_unique(d: &Discretization, pieces: &Lines, root: &Root) -> bool {
    let (inner, off) = of_friction(d, pieces, root, |mu| mu * mu / 4.0);
    is_below_one(&inner, off, 1.0)
}

/// Lower bounds of the largest coefficient below which there is exactly one solution for all loads: by Theorem 13.3 and by Theorem 13.3a;
/// 0 where none is proved.
fn limits(d: &Discretization, pieces: &Lines, compliance: &Compliance, root: &Root) -> [f64; 2] {
    let (inner, off) = of_friction(d, pieces, root, |_| 1.0);
    // The largest eigenvalue, and a little more: proved is what the factor says.
    let is_proved = |&most: &f64| most > 0.0 && is_below_one(&inner, off, 1.0 / most);
    let largest = enlarged(power(inner.nrows(), |x| times(&inner, x))).find(is_proved);
    let Some(largest) = largest else { return [0.0; 2] };
    let first = 2.0 / largest.sqrt() * (1.0 - 4.0 * f64::EPSILON);
    let second = coupling(d, pieces, compliance).map_or(0.0, |c| {
        let c = c.max(f64::EPSILON);
        (1.0 - c * c) / (2.0 * c * (1.0 + largest).sqrt()) * (1.0 - 1e-12)
    });
    [first, second.max(0.0)]
}

/// An estimate of an eigenvalue from below and a thousandth more, then twice as much more each time: an estimate may stop at the next
/// eigenvalue.
fn enlarged(estimate: f64) -> impl Iterator<Item = f64> {
    [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0]
        .into_iter()
        .map(move |more| estimate * (1.0 + 1e-3 * more))
}

/// An upper bound of c of Theorem 13.3a, if known and below 1.
fn coupling(d: &Discretization, pieces: &Lines, compliance: &Compliance) -> Option<f64> {
    let (mut normal, mut across, mut inverses) = (Vec::new(), Vec::new(), Vec::new());
    for piece in pieces.iter() {
        let (first, nodes) = (piece.functionals().start, piece.degree.nodes_per_edge());
        let is_covered = piece.geometry.law == Law::Contact || coefficient(piece).is_some();
        let mass = Some(mass(d, piece)).filter(|_| is_covered)?;
        let mass = Mat::from_fn(nodes, nodes, |a, b| mass[(a, b)]);
        let inverse = mass.llt(Side::Lower).ok()?.solve(Mat::<f64>::identity(nodes, nodes));
        normal.extend((0..nodes).map(|a| (first + a, inverses.len(), a)));
        if coefficient(piece).is_some() {
            across.extend((0..nodes).map(|a| (first + nodes + a, inverses.len(), a)));
        }
        inverses.push(inverse);
    }
    // The factor by which a mass matrix of order 3 enlarges rounding.
    let stiffest = inverses.iter().map(frobenius).fold(0.0, f64::max);
    let rounding = 64.0 * f64::EPSILON * 20.0 * stiffest;
    let all: Vec<(usize, usize, usize)> = normal.iter().chain(&across).copied().collect();
    let entry = |(i, e, a): (usize, usize, usize), (j, f, b): (usize, usize, usize)| {
        compliance.g[(i, j)] + if e == f { inverses[e][(a, b)] } else { 0.0 }
    };
    let block =
        |of: &[(usize, usize, usize)]| Mat::from_fn(of.len(), of.len(), |i, j| entry(of[i], of[j]));
    let factors = [block(&normal), block(&across)].map(|m| m.llt(Side::Lower));
    let [Ok(n), Ok(t)] = &factors else { return None };
    // (N^-1 G_nt T^-1 G_tn) x by columns.
    let between =
        Mat::from_fn(normal.len(), across.len(), |i, j| compliance.g[(normal[i].0, across[j].0)]);
    let times = |x: &[f64]| -> Vec<f64> {
        let x = Mat::from_fn(x.len(), 1, |i, _| x[i]);
        let y = n.solve(&between * t.solve(between.transpose() * x));
        (0..y.nrows()).map(|i| y[(i, 0)]).collect()
    };
    let count = normal.len();
    let off = up(2.0 * compliance.off + rounding);
    let is_proved = |&c: &f64| {
        let whole = Mat::from_fn(all.len(), all.len(), |i, j| {
            let same = (i < count) == (j < count);
            if same { c * entry(all[i], all[j]) } else { compliance.g[(all[i].0, all[j].0)] }
        });
        is_positive_definite(&whole, off)
    };
    let estimates = enlarged(power(count, times).sqrt()).map(|c| c.max(f64::EPSILON));
    estimates.take_while(|&c| c < 1.0).find(is_proved)
}

/// An estimate of the largest eigenvalue of the matrix that `times` multiplies by, if real and not negative.
fn power(n: usize, times: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    // A start in no plane of symmetry.
    let mut x: Vec<f64> = (0..n).map(|i| 1.0 + 0.5 * (1.7 * i as f64).sin()).collect();
    let mut largest = 0.0;
    for _ in 0..300 {
        let size = norm(&x);
        if !(size > 0.0) {
            return largest;
        }
        x.iter_mut().for_each(|x| *x /= size);
        x = times(&x);
        let before = std::mem::replace(&mut largest, norm(&x));
        if (largest - before).abs() <= 1e-6 * largest {
            break;
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Friction;
    use crate::kernel::{Material, Plane};
    use crate::model::quadrature::gauss;
    use crate::model::{Condition, Diagonal, Problem, Rectangle};
    use crate::proof::intervals::tests::ring;

    /// Numbers between -1 and 1.
    fn draws(seed: f64) -> impl FnMut() -> f64 {
        let mut x = seed;
        move || {
            x = 3.99 * x * (1.0 - x);
            2.0 * x - 1.0
        }
    }

    /// G of some functionals, each of its own size.
    fn compliance(z: &Mat<f64>) -> Compliance {
        let g = z.transpose() * z;
        let n = g.nrows();
        let by = Mat::from_fn(n, n, |i, j| 1e-14 * (g[(i, i)] * g[(j, j)]).sqrt());
        Compliance { entry: largest(&by), off: row_sum(&by), g, by }
    }

    #[test]
    fn what_is_said_of_an_inverse_holds_and_is_close() {
        for seed in [0.1, 0.23, 0.37, 0.61] {
            let mut next = draws(seed);
            let (rows, n) = (9, 12);
            // More functionals than there are directions, of sizes from 1e-3 to 1e3.
            let sizes: Vec<f64> = (0..n).map(|_| 10.0_f64.powf(3.0 * next())).collect();
            let z = Mat::from_fn(rows, n, |_, j| sizes[j] * next());
            let blocks: Vec<DMatrix<f64>> = (0..n / 2)
                .map(|e| {
                    let (a, b) = (1.0 / sizes[2 * e], 1.0 / sizes[2 * e + 1]);
                    let sticks = f64::from(u8::from(e % 2 == 0));
                    let across = [0.8 * a * b * (1.0 - sticks), b * b * sticks];
                    DMatrix::from_row_slice(2, 2, &[a * a, 0.0, across[0], across[1]])
                })
                .collect();
            let mut h = Mat::<f64>::zeros(n, n);
            for (e, block) in blocks.iter().enumerate() {
                (0..4).for_each(|k| h[(2 * e + k / 2, 2 * e + k % 2)] = block[(k / 2, k % 2)]);
            }
            let one = Mat::<f64>::identity(rows, rows);
            let whole = &z * &h * z.transpose() + &one;
            let exact = whole.partial_piv_lu().solve(&one);
            let inverse = Root::new(&compliance(&z)).unwrap().inverse(&blocks).unwrap();
            let square = exact.transpose() * &exact;
            let found = power(rows, |x| times(&square, x)).sqrt();
            let close = |most: f64, found: f64| {
                // The control: nothing much smaller would be true.
                assert!(most >= found * (1.0 - 1e-6) && most <= 1.1 * found, "{most} {found}");
            };
            close(inverse.bound(), found.max(1.0));
            let answers = &exact * &z;
            for j in 0..n {
                let most = length_of(&inverse.answers, j) + inverse.slack[j];
                close(most, length_of(&answers, j));
            }
            let t: Vec<f64> = (0..rows).map(|_| next()).collect();
            let w = times(&z.transpose().to_owned(), &t).into_iter().map(PreciseBall::from);
            let most = inverse.times(&w.collect::<Vec<_>>(), [norm(&t), 1e-12]);
            let found = norm(&times(&exact, &t));
            assert!(most >= found && most <= 3.0 * (norm(&t) + found));
        }
    }

    #[test]
    fn a_root_is_above_what_is_off_and_a_smaller_one_is_none() {
        let mut next = draws(0.3);
        let z = Mat::from_fn(5, 8, |_, j| 10.0_f64.powi(j as i32 - 4) * next());
        let of = compliance(&z);
        let root = Root::new(&of).unwrap();
        let more = &root.c * root.c.transpose();
        let above = |share: f64| {
            is_positive_definite(&(&more - &combined(&root.g, share, 0.0)), row_sum(&root.by))
        };
        assert!(above(1.0) && !above(1.0 + 1e-9));
    }

    const MU: f64 = 0.6;

    #[test]
    fn two_thousand_functionals_of_a_hundred_thousand_unknowns_are_not_too_many() {
        assert!(!are_too_many(2_000, 100_000) && !are_too_many(1_000, 200_000));
        assert!(are_too_many(2_001, 10) && are_too_many(2_000, 100_001));
    }

    /// Pressed at one end of the edge for sure, and hardly at the other: there the radii are those of that half at points, and the largest
    /// one between them.
    #[test]
    fn what_is_uncertain_at_points_has_their_radii() {
        let problem = ring(1, Condition::clamped());
        let on_edge = |rule: EdgeRule, [inner, outer]: [f64; 2]| {
            let d = Discretization::new(&problem, Degree::One, |c| c.limit() / 2.0, rule).unwrap();
            let lines = Lines::new(&d);
            let piece = &lines[0];
            let at = |[x, y]: [f64; 2]| (1.0 - y) * (inner + (outer - inner) * (x - 0.1));
            let u: Vec<[PreciseBall; 2]> =
                d.space.nodes().iter().map(|&x| [0.0, at(x)].map(PreciseBall::from)).collect();
            let of = compliance(&Mat::from_fn(1, piece.p0.len(), |_, _| 1.0));
            let on = OnPiece::new(&d, (piece, &of), &u);
            let p = [0, 1].map(|k| on.p[k].head());
            let radii = piece.radii.unwrap().map(|r| r.upper());
            let most = larger(p[0], p[1]);
            let found = on.uncertain(&d, most / 2.0 / on.reach.normal, &on.reach)[0];
            let along = |[a, b]: [f64; 2], s: f64| a + s * (b - a);
            let places = (0..1000).map(|k| (f64::from(k) + 0.5) / 1000.0);
            let uncertain: Vec<f64> = places.filter(|s| along(p, *s).abs() < most / 2.0).collect();
            let mean = uncertain.iter().map(|s| along(radii, *s)).sum::<f64>();
            (found, mean / uncertain.len() as f64 / larger(radii[0], radii[1]))
        };
        let shares = [[-1.0, 0.1], [0.1, -1.0]].map(|pressed| {
            let (points, share) = on_edge(EdgeRule::Gauss(gauss(24)), pressed);
            let (between, _) = on_edge(EdgeRule::Exact, pressed);
            let found = points / between;
            assert!(found > 0.85 * share && found < 1.15 * share, "{found} {share}");
            share
        });
        assert!(shares[0] > 1.5 * shares[1], "control: {shares:?}");
    }

    /// A block on a floor as rough as `MU`.
    fn on_a_floor() -> Problem {
        let mesh = Rectangle { width: 1.0, height: 1.0, nx: 2, ny: 1, diagonal: Diagonal::Crossed };
        Problem::of(mesh.mesh().unwrap(), Material::lame(1.0, 1.0, Plane::Strain))
            .with("top", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.0))
            .with_friction("bottom", Friction::Coulomb(MU))
    }

    /// Calls `f` with each piece of that block, and the number of functionals.
    fn each_piece(mut f: impl FnMut(&Discretization, &Piece<PreciseBall>, usize)) {
        let problem = on_a_floor();
        for degree in [Degree::One, Degree::Two] {
            let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact);
            let d = d.unwrap();
            let count = d.contact.iter().map(|piece| piece.p0.len()).sum();
            Lines::new(&d).iter().for_each(|piece| f(&d, piece, count));
        }
    }

    /// a P0_n(v) + b P0_t(v) at the place `s` of a piece, where the components at the nodes are products of v and columns of `z`.
    fn at(s: f64, piece: &Piece<PreciseBall>, [a, b]: [f64; 2], z: &Mat<f64>) -> Vec<f64> {
        let (first, values) = (piece.functionals().start, piece.degree.edge_values(s));
        let across = first + values.len();
        let row = |row: usize| {
            let node = |i: usize| a * z[(row, first + i)] + b * z[(row, across + i)];
            values.iter().enumerate().map(|(i, value)| value * node(i)).sum()
        };
        (0..z.nrows()).map(row).collect()
    }

    /// Places of an edge that are an eighth apart: a polynomial of degree 2 whose values at the nodes are 1, 1 and -1 is largest at one
    /// of them.
    fn places() -> impl Iterator<Item = f64> {
        (0..=8).map(|k| f64::from(k) / 8.0)
    }

    #[test]
    fn no_field_reaches_farther_between_nodes_than_its_reach_and_one_of_each_degree_as_far() {
        let mut next = draws(0.41);
        each_piece(|_, piece, count| {
            for _ in 0..20 {
                let z = Mat::from_fn(3, count, |_, _| next());
                let reach = Reach::new(piece, &compliance(&z));
                let [a, b] = [next(), next()];
                for ((of, most), s) in [
                    ([a, b], reach.of(a, b)),
                    ([1.0, 0.0], reach.normal),
                    ([0.0, 1.0], reach.across),
                ]
                .into_iter()
                .flat_map(|found| places().map(move |s| (found, s)))
                {
                    let found = norm(&at(s, piece, of, &z));
                    assert!(found <= most, "{of:?} at {s}: {found} {most}");
                }
            }
            let first = piece.functionals().start;
            let z = Mat::from_fn(1, count, |_, j| if j == first + 1 { -1.0 } else { 1.0 });
            let most = Reach::new(piece, &compliance(&z)).normal;
            let along = |s: f64| norm(&at(s, piece, [1.0, 0.0], &z));
            let found = places().map(along).fold(0.0, larger);
            assert!(most >= found && most <= found * (1.0 + 1e-9), "{most} {found}");
            // The control: of degree 2, values at nodes say less.
            assert_eq!(found > 1.2, piece.degree == Degree::Two);
        });
    }

    /// The pressure and the shear of Coulomb's law, times gamma.
    fn stresses([p, t]: [f64; 2]) -> [f64; 2] {
        let most = MU * p.max(0.0);
        [p.max(0.0), t.clamp(-most, most)]
    }

    #[test]
    fn pressure_and_shear_change_no_more_than_is_said_and_with_the_bound_of_shear_by_nearly_as_much()
     {
        let mut next = draws(0.29);
        let mut least_control: f64 = f64::INFINITY;
        each_piece(|d, piece, count| {
            let (first, nodes) = (piece.functionals().start, piece.degree.nodes_per_edge());
            let u = vec![[PreciseBall::from(0); 2]; d.space.nodes().len()];
            let rule = gauss(24);
            // The integral of the squares of what a field changes, where P_n and P_t have these values at the nodes.
            let change = |p: &[[f64; 2]], z: &Mat<f64>, v: &[f64]| -> f64 {
                let of = |&(s, weight): &(f64, f64)| {
                    let values: Vec<f64> = piece.degree.edge_values(s);
                    let sum = |c: usize| values.iter().zip(p).map(|(n, p)| n * p[c]).sum::<f64>();
                    let before = [sum(0), sum(1)];
                    let by = [[1.0, 0.0], [0.0, 1.0]].map(|of| {
                        at(s, piece, of, z).iter().zip(v).map(|(z, v)| z * v).sum::<f64>()
                    });
                    let after = [before[0] + by[0], before[1] + by[1]];
                    let [before, after] = [before, after].map(stresses);
                    let square = (after[0] - before[0]).powi(2) + (after[1] - before[1]).powi(2);
                    weight * square
                };
                piece.weight().head() * rule.iter().map(of).sum::<f64>()
            };
            for k in 0..40 {
                let share = if k % 2 == 0 { 1.0 } else { 0.1 };
                let is_across = |j: usize| (first + nodes..first + 2 * nodes).contains(&j);
                let z =
                    Mat::from_fn(3, count, |_, j| next() * if is_across(j) { share } else { 1.0 });
                let most = OnPiece::new(d, (piece, &compliance(&z)), &u).pressure();
                let p: Vec<[f64; 2]> = (0..nodes).map(|_| [next(), next()]).collect();
                let v: Vec<f64> = (0..3).map(|_| next()).collect();
                let (found, size) = (change(&p, &z, &v), norm(&v));
                assert!(found <= most * size * size, "{found} {most}");
            }
            // All of the piece slides, and is pressed more: the shear grows by MU times as much, and hardly by P_t.
            let z = Mat::from_fn(1, count, |_, j| {
                if (first..first + nodes).contains(&j) { 1.0 } else { 1e-3 }
            });
            let on = OnPiece::new(d, (piece, &compliance(&z)), &u);
            let (most, found) = (on.pressure(), change(&vec![[5.0, 9.0]; nodes], &z, &[1.0]));
            let between = on.reach.between;
            assert!(found <= most && found >= 0.99 * most / (between * between));
            let Reach { normal: n, across: t, .. } = on.reach;
            least_control = least_control.min(on.weight * (n * n + t * t) / found);
        });
        assert!(least_control < 0.75, "control: less without what MU P_n does, {least_control}");
    }

    /// Lambda, the largest eigenvalue of `W_t G_tt`, and the square of c, that of `N^-1 G_nt T^-1 G_tn`, from the integrals of `N_a N_b`.
    fn of_the_theorems(d: &Discretization, pieces: &Lines, g: &Mat<f64>) -> [f64; 2] {
        let integral: &[[f64; 3]] = match d.space.degree() {
            Degree::One => &[[1.0 / 3.0, 1.0 / 6.0, 0.0], [1.0 / 6.0, 1.0 / 3.0, 0.0]],
            Degree::Two => &[[4.0, -1.0, 2.0], [-1.0, 4.0, 2.0], [2.0, 2.0, 16.0]]
                .map(|row| row.map(|x| x / 30.0)),
        };
        let nodes = integral.len();
        let n = nodes * d.contact.len();
        let of = |k: usize, i: usize| d.contact[i / nodes].start + k * nodes + i % nodes;
        let block = |k: usize, l: usize| Mat::from_fn(n, n, |i, j| g[(of(k, i), of(l, j))]);
        let w = Mat::from_fn(n, n, |i, j| match i / nodes == j / nodes {
            true => pieces[i / nodes].weight().head() * integral[i % nodes][j % nodes],
            false => 0.0,
        });
        let identity = Mat::<f64>::identity(n, n);
        let inverse = |m: &Mat<f64>| m.llt(Side::Lower).unwrap().solve(&identity);
        let [normal, across] = [0, 1].map(|k| inverse(&(block(k, k) + inverse(&w))));
        let largest = |m: Mat<f64>| power(n, |x| times(&m, x));
        [largest(&w * block(1, 1)), largest(normal * block(0, 1) * across * block(1, 0))]
    }

    #[test]
    fn the_limits_of_the_coefficient_are_those_of_both_theorems_and_no_larger() {
        let (problem, mut next) = (on_a_floor(), draws(0.37));
        for degree in [Degree::One, Degree::Two] {
            let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact);
            let d = d.unwrap();
            let (lines, count) = (Lines::new(&d), d.contact.iter().map(|e| e.p0.len()).sum());
            for size in [0.1, 0.3, 1.0] {
                let z = Mat::from_fn(count + 2, count, |_, _| size * next());
                let compliance = compliance(&z);
                let found = limits(&d, &lines, &compliance, &Root::new(&compliance).unwrap());
                let [lambda, square] = of_the_theorems(&d, &lines, &compliance.g);
                let second = (1.0 - square) / (2.0 * square.sqrt());
                let exact = [2.0 / lambda.sqrt(), second / (1.0 + lambda).sqrt()];
                // What is proved is a thousandth or two more of Lambda and c; near 1 that is twenty times as much of 1 - c^2.
                for (found, exact) in found.into_iter().zip(exact) {
                    assert!(found <= exact && found >= 0.95 * exact, "{degree:?}: {found} {exact}");
                }
                let control = second / lambda.sqrt();
                assert!(size > 0.1 || found[1] < 0.9 * control, "control: {} {control}", found[1]);
            }
        }
    }

    #[test]
    fn where_no_region_is_sure_all_terms_are_possible_and_where_one_is_its_own() {
        let contact = |is: &[Region]| possible(Law::Contact, |region| is.contains(&region));
        let (open, pressed) = ([0.0; 3], [1.0, 0.0, 0.0]);
        assert_eq!(contact(&[]), [open, pressed]);
        assert_eq!(contact(&[Region::Open]), [open]);
        assert_eq!(contact(&[Region::Pressed]), [pressed]);
        let coulomb = Law::Friction(Bound::Coulomb(0.5));
        let coulomb = |is: &[Region]| possible(coulomb, |region| is.contains(&region));
        let [sticks, right, left] = [[1.0, 0.0, 1.0], [1.0, 0.5, 0.0], [1.0, -0.5, 0.0]];
        assert_eq!(coulomb(&[]), [open, sticks, right, left]);
        assert_eq!(coulomb(&[Region::Left]), [open, left]);
        assert_eq!(coulomb(&[Region::Pressed]), [sticks, right, left]);
        assert_eq!(coulomb(&[Region::Pressed, Region::Right]), [right]);
        assert_eq!(coulomb(&[Region::Open]), [open]);
        let tresca = Law::Friction(Bound::Tresca([1.0; 2]));
        let tresca = |is: &[Region]| possible(tresca, |region| is.contains(&region));
        let [normal, shear, both] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0]];
        assert_eq!(tresca(&[]), [shear, both, open, normal]);
        assert_eq!(tresca(&[Region::Open, Region::Sticks]), [shear]);
        assert_eq!(tresca(&[Region::Pressed, Region::Left]), [normal]);
    }

    #[test]
    fn a_contraction_has_a_fixed_point_in_a_ball_that_it_does_not_leave() {
        // x -> q x + step has the fixed point step / (1 - q).
        for q in [0.0, 0.25, 0.5, 0.96875] {
            for step in [1.0, 1e-9, 1e9] {
                let r = step / (1.0 - q);
                assert!(contracts(step, q, r * (1.0 + 1e-12)), "{q} {step}");
                assert!(!contracts(step, q, r * (1.0 - 1e-12)), "{q} {step}");
            }
        }
        for q in [1.0, 1.5, f64::NAN] {
            assert!(!contracts(0.0, q, 1.0), "{q}");
        }
        assert!(!contracts(f64::NAN, 0.5, 1.0) && !contracts(0.1, 0.5, f64::NAN));
    }
}
