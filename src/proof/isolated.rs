//! With Coulomb's friction the discrete equations may have several solutions. Around a computed one it is decided here whether there is
//! exactly one within a distance R, and how far that can be: docs/theory.md, 13.6.
//!
//! With B the functionals, A = L L^T, Z = L^-1 B^T, G = Z^T Z and H0 what the terms of contact and friction have for a derivative where it is
//! certain which of them is meant, J0 = A + B^T H0 B:
//!
//! - beta = |J0^-1| from the dual norm of A to the norm of A = 1 / min(1, sigma_min(1 + G^(1/2) H0 G^(1/2))),
//! - eta(R) = sum over the pieces of (1 + 2 mu) (|E| / gamma) g m(R): g is the largest eigenvalue of the block of G at a node, m(R) the
//!   measure of where a change of P by g^(1/2) R could change which term is meant.
//!
//! If beta (rho + eta(R) R) <= R and beta eta(R) < 1, rho being the dual norm of the residual, there is exactly one solution within R in the
//! norm of A, and it is within beta rho / (1 - beta eta(R)).

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::DMatrix;

use super::Unproved;
use super::balls::{free, root};
use super::pressed::{EdgePiece, Row};
use crate::contact::friction::Bound;
use crate::contact::law::Law;
use crate::contact::{Discretization, Piece};
use crate::kernel::Response;
use crate::kernel::ball::{PreciseBall, larger, up};
use crate::linear::dense::norm;
use crate::linear::factor::Factor;
use crate::linear::system::System;
use crate::model::Degree;
use crate::solve::coulomb::coefficient;

/// Beyond this number of functionals, and of products of their number and that of the unknowns, nothing is tried: the time grows with
/// the cube of the first and with the second.
const MOST_FUNCTIONALS: usize = 2_000;
const MOST_ENTRIES: usize = 40_000_000;

/// The share of a stretch that is left out at a root, where nothing is certain: so little that it bounds no radius.
const INSET: f64 = 1e-9;

/// The bounds of the smallest singular value that are tried, the largest first.
const SINGULAR_VALUES: [f64; 14] =
    [0.999, 0.99, 0.97, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.03];

/// What is proved of the solution near a displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Isolated {
    /// |u~ - u^h|_A at most.
    pub rho: f64,
    /// There is no other solution within this distance, in the norm of A; `None` if that is known with springs only.
    pub within: Option<f64>,
    /// There is no other solution anywhere.
    pub everywhere: bool,
    /// Lower bounds of the coefficient below which that is so for all loads.
    pub limits: [f64; 2],
    /// The norm of gamma^{1/2} (lambda~ - lambda^h) at most.
    pub pressure: f64,
}

/// A product with A in balls: of a vector, off by a functional of at most the number that comes with it, times |v|_a.
pub(super) type Product<'a> = &'a dyn Fn(&[PreciseBall]) -> (Vec<PreciseBall>, f64);

/// What is known of A.
pub(super) struct Body<'a, 'd, 'p> {
    pub system: &'a System<'d, 'p>,
    /// Any factor, the better the nearer it is to that of A.
    pub factor: &'a Factor,
    pub times: Product<'a>,
    /// |t|_A* <= the sum of these times |t_i|.
    pub crude: &'a [f64],
    /// |v|_A^2 is at least this times |v|_a^2.
    pub coercivity: f64,
}

/// The matrix G, enclosed.
struct Compliance {
    /// Its middle.
    g: Mat<f64>,
    /// The norm of what it is off, at most.
    off: f64,
    /// The largest entry that it is off by.
    entry: f64,
}

impl Body<'_, '_, '_> {
    /// G = B A^-1 B^T: with z_j near A^-1 b_j and e_j = b_j - A z_j, the entry b_i . z_j is off by |b_i|_A* |e_j|_A* at most.
    fn compliance(&self, pieces: &[Piece<PreciseBall>]) -> Result<Compliance, Unproved> {
        let (system, count) = (self.system, self.system.functionals());
        let nodes = system.d.space.nodes().len();
        let mut rows: Vec<Vec<(usize, PreciseBall)>> = Vec::with_capacity(count);
        let zero = PreciseBall::from(0);
        for piece in pieces {
            for i in 0..piece.p0.len() {
                let mut unit = vec![zero; piece.p0.len()];
                unit[i] = PreciseBall::from(1);
                let mut forces = vec![[zero; 2]; nodes];
                piece.add_contact(&unit, &mut forces);
                let row = free(system, &forces).into_iter().enumerate();
                rows.push(row.filter(|(_, b)| b.magnitude() != 0.0).collect());
            }
        }
        let sparse = |row: &[(usize, PreciseBall)], z: &[PreciseBall]| {
            row.iter().fold(zero, |sum, &(k, b)| sum + b * z[k])
        };
        let mut g = Mat::zeros(count, count);
        let mut radii: Mat<f64> = Mat::zeros(count, count);
        let (mut sizes, mut rests) = (vec![0.0; count], vec![0.0; count]);
        for (j, row) in rows.iter().enumerate() {
            let mut z = vec![zero; system.numbering.count];
            let mut left = vec![zero; system.numbering.count];
            row.iter().for_each(|&(k, b)| left[k] = b);
            let mut rest = f64::INFINITY;
            // Once, and once more from what is left.
            for _ in 0..2 {
                let mut correction: Vec<f64> = left.iter().map(|t| t.head()).collect();
                self.factor.solve(&mut correction);
                for (z, c) in z.iter_mut().zip(&correction) {
                    *z = PreciseBall::point((*z + PreciseBall::from(*c)).centre());
                }
                let (az, off) = (self.times)(&z);
                left = az.into_iter().map(|az| zero - az).collect();
                row.iter().for_each(|&(k, b)| left[k] += b);
                let sum: f64 = left.iter().zip(self.crude).map(|(t, c)| t.magnitude() * c).sum();
                let rounding = 1.0 + f64::EPSILON * (left.len() + 16) as f64;
                rest = up(sum * rounding + off / self.coercivity.sqrt());
            }
            if !rest.is_finite() {
                return Err(Unproved::OutOfRange);
            }
            rests[j] = rest;
            sizes[j] = up(rest + root(sparse(row, &z)));
            for (i, row) in rows.iter().enumerate() {
                let entry = sparse(row, &z);
                g[(i, j)] = entry.head();
                radii[(i, j)] = up(entry.radius() + (entry.head() * f64::EPSILON).abs());
            }
        }
        // Symmetric as G is: the mean of two entries is off by no more than the larger one.
        let mean = Mat::from_fn(count, count, |i, j| (g[(i, j)] + g[(j, i)]) / 2.0);
        let by = |i: usize, j: usize| up(radii[(i, j)] + sizes[i] * rests[j]);
        let by = Mat::from_fn(count, count, |i, j| {
            by(i, j).max(by(j, i)) + f64::EPSILON * mean[(i, j)].abs()
        });
        let (off, entry) = (row_sum(&by), largest(&by));
        Ok(Compliance { g: mean, off, entry })
    }
}

/// Which terms are meant where some polynomials are positive: the factors of P_n in the normal force, and of P_n and P_t in the shear
/// force.
struct State {
    positive: Vec<Row>,
    factors: [f64; 3],
}

/// The states of a piece that a change of P by `d` in length does not end.
fn states(piece: &Piece<PreciseBall>, p: &[PreciseBall], d: f64) -> Vec<State> {
    let less =
        |row: Row, by: f64| -> Row { row.into_iter().map(|v| v - PreciseBall::from(by)).collect() };
    let [normal, across] = [piece.along(p), piece.across(p)].map(<[PreciseBall]>::to_vec);
    let minus = |row: &Row| -> Row { row.iter().map(|&v| -v).collect() };
    let sum = |a: &Row, b: &Row| -> Row { a.iter().zip(b).map(|(&a, &b)| a + b).collect() };
    let pressed = || less(normal.clone(), d);
    let open = || less(minus(&normal), d);
    let state = |positive: Vec<Row>, factors: [f64; 3]| State { positive, factors };
    match piece.geometry.law {
        Law::Friction(bound @ Bound::Coulomb(mu)) => {
            let m = bound.at_nodes(piece.gamma, &normal);
            let far = up((1.0 + mu) * d);
            let [below, above] = [sum(&m, &minus(&across)), sum(&m, &across)];
            vec![
                state(vec![open()], [0.0; 3]),
                state(
                    vec![pressed(), less(below.clone(), far), less(above.clone(), far)],
                    [1.0, 0.0, 1.0],
                ),
                state(vec![pressed(), less(minus(&below), far)], [1.0, mu, 0.0]),
                state(vec![pressed(), less(minus(&above), far)], [1.0, -mu, 0.0]),
            ]
        }
        Law::Friction(bound) => {
            let m = bound.at_nodes(piece.gamma, &normal);
            let [below, above] = [sum(&m, &minus(&across)), sum(&m, &across)];
            let across = [
                (vec![less(below.clone(), d), less(above.clone(), d)], 1.0),
                (vec![less(minus(&below), d)], 0.0),
                (vec![less(minus(&above), d)], 0.0),
            ];
            let mut all = Vec::new();
            for (normal, factor) in [(open(), 0.0), (pressed(), 1.0)] {
                for (rows, sticks) in &across {
                    let positive = [vec![normal.clone()], rows.clone()].concat();
                    all.push(state(positive, [factor, 0.0, *sticks]));
                }
            }
            all
        }
        law if law.responses().first() == Some(&Response::Unilateral) => {
            vec![state(vec![open()], [0.0; 3]), state(vec![pressed()], [1.0, 0.0, 0.0])]
        }
        // P itself, whatever it is.
        _ => vec![state(Vec::new(), [1.0, 0.0, 1.0])],
    }
}

/// Where a quadratic polynomial with these values at the nodes has its extremum within the edge: on either side of it a positive one has
/// positive coefficients (Bernstein's), across it it need not.
fn turning_point(values: &Row) -> Option<f64> {
    let [start, end, middle] = values[..] else { return None };
    let [start, end, middle] = [start, end, middle].map(PreciseBall::head);
    let (slope, bend) = (4.0 * middle - 3.0 * start - end, start + end - 2.0 * middle);
    let at = -slope / (4.0 * bend);
    (at > 0.0 && at < 1.0).then_some(at)
}

/// The pieces of an edge on which one of its states is certain, with the factors of that state.
fn certain(
    d: &Discretization,
    piece: &Piece<PreciseBall>,
    p: &[PreciseBall],
    change: f64,
) -> Vec<(EdgePiece, [f64; 3])> {
    let of = |State { positive, factors }: State| {
        let cuts: Vec<f64> = positive.iter().filter_map(turning_point).collect();
        let edge = (d.space.degree(), &d.rule);
        let found = EdgePiece::positive(edge, piece.radii, &positive, (INSET, &cuts));
        found.into_iter().map(move |piece| (piece, factors))
    };
    states(piece, p, change).into_iter().flat_map(of).collect()
}

/// What eta and H0 take of a piece.
struct OnPiece<'a> {
    piece: &'a Piece<PreciseBall>,
    p: Row,
    /// The square root of g.
    reach: f64,
    /// (1 + 2 mu) (|E| / gamma) g
    weight: f64,
}

impl OnPiece<'_> {
    /// The measure of where no state is certain to stay within R, at most.
    fn uncertain(&self, d: &Discretization, r: f64) -> f64 {
        let change = up(self.reach * r * (1.0 + 1e-12));
        let all = certain(d, self.piece, &self.p, change);
        let sure: f64 = all.iter().map(|(piece, _)| piece.share.lower().max(0.0)).sum();
        let left = (1.0 - sure * (1.0 - 1e-14)).clamp(0.0, 1.0);
        // H0 leaves the insets of its own, longer stretches out: at fewer than these ends.
        if left > INSET { (left + 128.0 * INSET).min(1.0) } else { left }
    }

    /// The block of H0: the integrals over where a state is certain to stay within R.
    fn block(&self, d: &Discretization, r: f64) -> DMatrix<f64> {
        let (count, nodes) = (self.piece.p0.len(), self.piece.degree.nodes_per_edge());
        let mut block = DMatrix::zeros(count, count);
        let weight = self.piece.weight().head();
        for (part, [normal, by_normal, across]) in
            certain(d, self.piece, &self.p, up(self.reach * r))
        {
            for a in 0..nodes {
                for b in 0..nodes {
                    let mass = weight * part.mass[a][b].head();
                    block[(a, b)] += normal * mass;
                    if count > nodes {
                        block[(nodes + a, b)] += by_normal * mass;
                        block[(nodes + a, nodes + b)] += across * mass;
                    }
                }
            }
        }
        block
    }
}

/// g of a piece: the largest eigenvalue of the blocks of G at its nodes, times what a polynomial exceeds its nodal values by.
fn largest_eigenvalue(piece: &Piece<PreciseBall>, of: &Compliance) -> f64 {
    let nodes = piece.degree.nodes_per_edge();
    let first = piece.functionals().start;
    let mut most = 0.0_f64;
    for a in 0..nodes {
        let i = first + a;
        let value = if piece.p0.len() > nodes {
            let j = i + nodes;
            let (a, b, c) = (of.g[(i, i)], of.g[(j, j)], of.g[(i, j)]);
            (a + b) / 2.0 + ((a - b) / 2.0).hypot(c) + 4.0 * of.entry
        } else {
            of.g[(i, i)] + of.entry
        };
        most = most.max(value * (1.0 + 1e-12));
    }
    match piece.degree {
        Degree::One => up(most),
        Degree::Two => up(most * 25.0 / 16.0),
    }
}

/// Returns whether a symmetric matrix is positive definite, proved in floating point: Cholesky's method runs to its end on the
/// matrix less a multiple of 1 that is larger than what rounding can do (Rump, BIT 46, 2006) and than `off`, what the matrix is off.
fn is_positive_definite(matrix: &Mat<f64>, off: f64) -> bool {
    let n = matrix.nrows();
    let trace: f64 = (0..n).map(|i| matrix[(i, i)]).sum();
    let shift = up(off + 2.0 * (n + 3) as f64 * f64::EPSILON * trace.abs());
    let shifted = Mat::from_fn(n, n, |i, j| matrix[(i, j)] - if i == j { shift } else { 0.0 });
    shift.is_finite() && shifted.llt(Side::Lower).is_ok()
}

/// The largest sum of magnitudes in a row: for a symmetric matrix a bound of its norm.
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

/// A root of G: any C with C C^T near G, the norm of what it is off, and a bound of the norm of G^(1/2).
struct Root {
    c: Mat<f64>,
    /// |G^(1/2) - (C C^T)^(1/2)| at most: the root of |G - C C^T|.
    off: f64,
    norm: f64,
    /// The Frobenius norm of C.
    size: f64,
}

impl Root {
    fn new(of: &Compliance) -> Option<Self> {
        let n = of.g.nrows();
        let largest = (0..n).map(|i| of.g[(i, i)]).fold(0.0, f64::max);
        let mut shift = (1e-15 * largest * n as f64).max(f64::MIN_POSITIVE);
        for _ in 0..8 {
            let shifted =
                Mat::from_fn(n, n, |i, j| of.g[(i, j)] + if i == j { shift } else { 0.0 });
            if let Ok(llt) = shifted.llt(Side::Lower) {
                let c = llt.L().to_owned();
                let product = &c * c.transpose();
                let rest = Mat::from_fn(n, n, |i, j| of.g[(i, j)] - product[(i, j)]);
                let size = frobenius(&c);
                let rounding = 2.0 * n as f64 * f64::EPSILON * size * size;
                let off = up((row_sum(&rest) + rounding + of.off).sqrt());
                return Some(Root { c, off, norm: up((row_sum(&of.g) + of.off).sqrt()), size });
            }
            shift *= 100.0;
        }
        None
    }

    /// C^T H C for a block diagonal H, and the norm of what G^(1/2) H G^(1/2), turned, is off it.
    fn around(&self, blocks: &[DMatrix<f64>]) -> (Mat<f64>, f64) {
        let n = self.c.nrows();
        let mut hc = Mat::<f64>::zeros(n, n);
        let (mut first, mut most) = (0, 0.0_f64);
        for h in blocks {
            most = most.max(norm(h.as_slice()));
            for i in 0..h.nrows() {
                for k in 0..h.ncols() {
                    if h[(i, k)] != 0.0 {
                        for j in 0..n {
                            hc[(first + i, j)] += h[(i, k)] * self.c[(first + k, j)];
                        }
                    }
                }
            }
            first += h.nrows();
        }
        let product = self.c.transpose() * &hc;
        let rounding = 4.0 * (n + 16) as f64 * f64::EPSILON;
        let (turned, rounded) =
            (2.0 * self.off * (self.norm + self.off), rounding * self.size * self.size);
        let off = most * (1.0 + 1e-9) * (turned + rounded);
        (product, up(off))
    }
}

/// What does not depend on the displacement.
pub(super) struct Known {
    compliance: Compliance,
    root: Root,
    /// The springs of A_S; none for A.
    springs: Option<Vec<DMatrix<f64>>>,
    everywhere: bool,
    limits: [f64; 2],
}

impl Known {
    /// For these pieces of the body, with these springs or without.
    ///
    /// # Errors
    /// Why nothing is proved.
    pub fn new(
        body: &Body,
        pieces: &[Piece<PreciseBall>],
        springs: Option<&[DMatrix<f64>]>,
    ) -> Result<Self, Unproved> {
        let (system, count) = (body.system, body.system.functionals());
        if count > MOST_FUNCTIONALS || count * system.numbering.count > MOST_ENTRIES {
            return Err(Unproved::TooManyFunctionals { count });
        }
        let compliance = body.compliance(pieces)?;
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
        Ok(Known { compliance, root, springs, everywhere, limits })
    }
}

/// Decides around the displacement `u`, where the residual has the dual norm `rho`; `size` is that of the displacement. All of it is in
/// the norm of A, or of A with the springs that are `known`; `by_a` is then what is known without.
///
/// # Errors
/// Why nothing is proved.
pub(super) fn isolate(
    d: &Discretization,
    (known, by_a): (&Known, Option<&Known>),
    pieces: &[Piece<PreciseBall>],
    u: &[[PreciseBall; 2]],
    [rho, size]: [f64; 2],
) -> Result<Isolated, Unproved> {
    let count = known.compliance.g.nrows();
    let Known { compliance, root: root_of_g, springs, .. } = known;
    let on_piece = |piece| {
        let g = largest_eigenvalue(piece, compliance);
        let mu = coefficient(piece).unwrap_or(0.0);
        let weight = up((1.0 + 2.0 * mu) * piece.weight().upper() * g * (1.0 + 1e-12));
        OnPiece { piece, p: piece.p(u), reach: up(g.sqrt()), weight }
    };
    let all: Vec<OnPiece> = pieces.iter().map(on_piece).collect();
    // The blocks are rounded from balls: by some units in the last place.
    let eta = |r: f64, rounding: f64| {
        let sum: f64 = all.iter().map(|on| on.weight * on.uncertain(d, r)).sum();
        up(sum * (1.0 + f64::EPSILON * (all.len() + 16) as f64) + rounding)
    };
    let start = (8.0 * rho).max(f64::EPSILON * size);
    let blocks: Vec<DMatrix<f64>> = all.iter().map(|on| on.block(d, start)).collect();
    let stiffest = blocks.iter().map(|h| norm(h.as_slice())).fold(0.0, f64::max);
    let rounding = up(1e-14 * stiffest * root_of_g.norm * root_of_g.norm);
    let blocks = match springs {
        Some(springs) => blocks.into_iter().zip(springs).map(|(h, s)| h - s).collect(),
        None => blocks,
    };
    let (inner, off) = root_of_g.around(&blocks);
    let k = Mat::from_fn(count, count, |i, j| inner[(i, j)] + if i == j { 1.0 } else { 0.0 });
    let square = k.transpose() * &k;
    let length = frobenius(&k);
    let of_square = 2.0 * count as f64 * f64::EPSILON * length * length;
    let at_least = |s: f64| {
        let less =
            Mat::from_fn(count, count, |i, j| square[(i, j)] - if i == j { s * s } else { 0.0 });
        is_positive_definite(&less, of_square)
    };
    let smallest =
        SINGULAR_VALUES.into_iter().find(|&s| at_least(s)).ok_or(Unproved::NotIsolated)?;
    let smallest = (smallest - off).min(1.0) * (1.0 - 1e-12);
    if !(smallest > 0.0) {
        return Err(Unproved::NotIsolated);
    }
    let beta = up(1.0 / smallest);
    let holds = |r: f64| {
        let eta = eta(r, rounding);
        (up(beta * (rho + eta * r)) <= r && up(beta * eta) < 1.0).then_some(eta)
    };
    let radii =
        (0..80).map(|k| start * 2.0_f64.powi(k)).take_while(|&r| r <= 1e3 * size.max(start));
    let mut found: Option<(f64, f64)> = None;
    for r in radii {
        match (holds(r), &mut found) {
            (Some(eta), None) => found = Some((eta, r)),
            (Some(_), Some((_, within))) => *within = r,
            (None, Some(_)) => break,
            (None, None) => {}
        }
    }
    let (eta, within) = found.ok_or(Unproved::NotIsolated)?;
    let radius = up(beta * rho / (1.0 - up(beta * eta)) * (1.0 + 1e-12));
    let stiffness: f64 = all.iter().map(|on| on.weight).sum();
    let largest = pieces.iter().filter_map(coefficient).fold(0.0, f64::max);
    let pressure = up((1.0 + largest) * (stiffness * (1.0 + 1e-9)).sqrt() * radius);
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
    let whole = EdgePiece::positive((piece.degree, &d.rule), piece.radii, &[], (INSET, &[]));
    for (part, a, b) in
        whole.iter().flat_map(|part| (0..nodes * nodes).map(move |k| (part, k / nodes, k % nodes)))
    {
        mass[(a, b)] += piece.weight().head() * part.mass[a][b].head();
    }
    mass
}

/// G^(1/2) M G^(1/2), turned, and what it is off: M are the integrals of `weight`(mu) N_a N_b / gamma of the functionals that feel
/// Coulomb's friction.
fn of_friction(
    d: &Discretization,
    pieces: &[Piece<PreciseBall>],
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
    let (inner, off) = root.around(&pieces.iter().map(block).collect::<Vec<_>>());
    let n = inner.nrows();
    let mean = Mat::from_fn(n, n, |i, j| (inner[(i, j)] + inner[(j, i)]) / 2.0);
    (mean, up(off * (1.0 + 1e-9)))
}

/// Returns whether 1 - `by` M is surely positive definite, where M is off by `off`.
fn is_below_one(m: &Mat<f64>, off: f64, by: f64) -> bool {
    let n = m.nrows();
    let less = Mat::from_fn(n, n, |i, j| {
        let entry = by * m[(i, j)];
        if i == j { 1.0 - entry } else { -entry }
    });
    is_positive_definite(&less, up(by * off * (1.0 + 1e-9) + n as f64 * f64::EPSILON))
}

/// Returns whether there is exactly one solution, whatever the loads: 1 - (1/4) G^(1/2) M G^(1/2) is positive definite, M being the
/// integrals of mu^2 N_a N_b / gamma of the tangential functionals.
fn is_unique(d: &Discretization, pieces: &[Piece<PreciseBall>], root: &Root) -> bool {
    let (inner, off) = of_friction(d, pieces, root, |mu| mu * mu / 4.0);
    is_below_one(&inner, off, 1.0)
}

/// Lower bounds of the largest coefficient below which there is exactly one solution for all loads: by Theorem 13.3 and by Theorem 13.3a;
/// 0 where none is proved.
fn limits(
    d: &Discretization,
    pieces: &[Piece<PreciseBall>],
    compliance: &Compliance,
    root: &Root,
) -> [f64; 2] {
    let (inner, off) = of_friction(d, pieces, root, |_| 1.0);
    let n = inner.nrows();
    let times = |x: &[f64]| -> Vec<f64> {
        (0..n).map(|i| (0..n).map(|j| inner[(i, j)] * x[j]).sum()).collect()
    };
    // The largest eigenvalue, and a little more: proved is what the factor says.
    let largest = power(n, times) * (1.0 + CLOSE);
    if !(largest > 0.0) || !is_below_one(&inner, off, 1.0 / largest) {
        return [0.0; 2];
    }
    let first = 2.0 / largest.sqrt() * (1.0 - 4.0 * f64::EPSILON);
    let second = coupling(d, pieces, compliance).map_or(0.0, |c| {
        let c = c.max(f64::EPSILON);
        (1.0 - c * c) / (2.0 * c * (1.0 + largest).sqrt()) * (1.0 - 1e-12)
    });
    [first, second.max(0.0)]
}

/// The limits are this much lower than they might be.
const CLOSE: f64 = 1e-3;

/// c of Theorem 13.3a at most, where it is known and below 1.
fn coupling(
    d: &Discretization,
    pieces: &[Piece<PreciseBall>],
    compliance: &Compliance,
) -> Option<f64> {
    let (mut normal, mut across, mut inverses) = (Vec::new(), Vec::new(), Vec::new());
    for piece in pieces {
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
    // What a mass matrix of order 3 makes of rounding.
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
    let c = power(normal.len(), times).sqrt() * (1.0 + CLOSE);
    let c = c.max(f64::EPSILON);
    if !(c < 1.0) {
        return None;
    }
    let count = normal.len();
    let whole = Mat::from_fn(all.len(), all.len(), |i, j| {
        let same = (i < count) == (j < count);
        if same { c * entry(all[i], all[j]) } else { compliance.g[(all[i].0, all[j].0)] }
    });
    let off = up(2.0 * compliance.off + rounding);
    is_positive_definite(&whole, off).then_some(c)
}

/// About the largest eigenvalue of what `times` multiplies by, if it is real and not negative.
fn power(n: usize, times: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    // In no plane of symmetry.
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
