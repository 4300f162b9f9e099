//! The condensed route: the body is factored once, A = L L^T, and Newton's method works on the contact functionals alone.
//!
//! With a given u, contact forces w, r = A u + B^T w - l the residual of the linear part, and
//! v = -L^-1 r, the displacement u + L^-T (v - X dw) has the contact forces w + dw in equilibrium with the loads, and there
//! P has the values y = P(u) + X^T v - G dw. The residual of (8) is then B^T (Psi'(y) - w - dw). So Newton's method has w
//! for its unknown:
//!
//! - its step solves w + dw = Psi'(y) + H dy with dy = -G dw, where H = Psi''(y) = R R^T is block diagonal; with
//!   s = w - Psi'(y) this is dw = R t - s, (I + R^T G R) t = R^T G s: symmetric, with no eigenvalue below 1. From one step to the
//!   next few pieces change, so those that press most are eliminated first, and of L the columns before the first change stay,
//! - DJ d = -s . dy, d^T A d = dw . G dw.
//!
//! **Where contact alone holds the body** A has no factor. Factored is K = A + B^T D B, with the springs D of a few pieces
//! (`Shift`) that pull as well as push. With dw for the change of the contact forces and dy for that of y, the equation A d + B^T dw = -r is
//! K d + B^T (dw - D dy) = -r: what the factor and G see are the forces less those of the springs that are too many. A step solves with
//! H - D in place of H, of which the pieces with D <= H have nothing: H - D = R E R^T with E = diag(I, -I), dw - D dy = R t - s,
//! (E + R^T G R) t = R^T G s. That matrix has a Cholesky factor with the signs of E if the tangent is positive definite.
//!
//! A first pass starts from the lift of the prescribed data with w = 0. Digits are lost where the body bends far without
//! contact, as G w nearly cancels P(u) + X^T v. A second pass recovers them from the u and w of the first and their true
//! residual: all terms are small there, and nothing cancels.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Col, ColRef, Mat, Par};
use nalgebra::{DMatrix, DVector};

use super::SolveError;
use super::accuracy::{Pass, Route};
use super::body::{
    Body, ContactEnergy, Derivatives, Residual, Step, all_springs, blocks, derivatives,
    springs_beside_shear, supported,
};
use super::iterate::{Evaluation, Iterate, NOISE};
use super::newton::{self, Until};
use crate::contact::Discretization;
use crate::held::holding::holding;
use crate::kernel::DoubleDouble;
use crate::linear::cholesky::{self, quasidefinite};
use crate::linear::compliance::{Compliance, Reach};
use crate::linear::dense::norm;
use crate::linear::factor::Factor;
use crate::linear::system::{Factored, System};
use crate::model::mesh::ROUNDED;

/// The springs of some pieces of Gamma_C that hold the body while it is factored, by the number of the piece: none where it is held
/// without contact.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shift(BTreeMap<usize, DMatrix<f64>>);

impl Shift {
    /// The springs of as few pieces as hold the body.
    pub(crate) fn of(d: &Discretization) -> Self {
        if d.slides.is_none() {
            return Shift::default();
        }
        let all = all_springs(d, 1.0).hessian;
        let held = holding(d, |e, i| all[e][(i, i)] > 0.0);
        Shift(held.into_iter().map(|e| (e, all[e].clone())).collect())
    }

    fn is_none(&self) -> bool {
        self.0.is_empty()
    }

    /// A + B^T D B
    ///
    /// # Errors
    /// As [`Factor::with`].
    pub(crate) fn factor(&self, system: &System) -> Result<Factored, SolveError> {
        if self.is_none() {
            return Factor::with(&system.structure, &system.matrix).map(|l| Arc::new(l).into());
        }
        let of = |e: usize| self.0.get(&e).cloned().unwrap_or_else(|| DMatrix::zeros(0, 0));
        system.factor(None, (0..system.d.contact.len()).map(of).collect())
    }

    /// sum <- sum + t D y
    fn add(&self, d: &Discretization, t: f64, y: &[f64], sum: &mut [f64]) {
        for (&e, springs) in &self.0 {
            let values = d.contact[e].functionals();
            for (a, i) in values.clone().enumerate() {
                let force = |(b, j): (usize, usize)| springs[(a, b)] * y[j];
                sum[i] += t * values.clone().enumerate().map(force).sum::<f64>();
            }
        }
    }
}

/// The body, factored, and the forces of contact on it.
pub(crate) struct Condensed<'a, 'd, 'p> {
    system: &'a System<'d, 'p>,
    shift: Shift,
    factored: Factored,
    compliance: Compliance<'a>,
    /// The entries of B^T: the functional, and the row among those that are not empty.
    forces: Vec<(usize, usize, f64)>,
    /// The number of these rows.
    rows: usize,
    /// The size that residuals are relative to.
    reference: f64,
    w: Vec<f64>,
    first: bool,
    /// The last tangent of all pieces.
    last: Option<Tangent>,
}

impl<'a, 'd, 'p> Condensed<'a, 'd, 'p> {
    /// With the factor of A and the shift, and without contact yet.
    ///
    /// # Errors
    /// As [`Compliance::new`].
    pub(crate) fn new(
        system: &'a System<'d, 'p>,
        (shift, factored): (Shift, Factored),
        reach: &'a Reach,
        reference: f64,
    ) -> Result<Self, SolveError> {
        let compliance = Compliance::new(&system.structure, &factored.factor, reach, |add| {
            system.each_functional(add)
        })?;
        let mut place: BTreeMap<usize, usize> = BTreeMap::new();
        let mut forces = Vec::new();
        system.each_functional(|row, functional, entry| {
            let next = place.len();
            forces.push((functional, *place.entry(row).or_insert(next), entry));
        });
        let w = vec![0.0; reach.functionals()];
        let rows = place.len();
        Ok(Condensed {
            system,
            shift,
            factored,
            compliance,
            forces,
            rows,
            reference,
            w,
            first: true,
            last: None,
        })
    }
}

impl Route for Condensed<'_, '_, '_> {
    fn factored(&self) -> Option<Factored> {
        Some(self.factored.clone())
    }

    fn factorizations(&self) -> usize {
        1
    }

    fn pass(
        &mut self,
        iterate: &mut Iterate,
        at: &mut Evaluation,
        residuals: &mut Vec<f64>,
        until: Until,
    ) -> Result<Pass, SolveError> {
        let mut v = at.linear.clone();
        self.system.add_forces(&self.w, &mut v);
        v.iter_mut().for_each(|v| *v = -*v);
        self.factored.factor.forward(&mut v);
        let mut y = at.p.clone();
        let dy = self.compliance.transpose_times(&v);
        for (y, change) in y.iter_mut().zip(&dy) {
            *y += (*change).into();
        }
        self.shift.add(self.system.d, 1.0, &dy, &mut self.w);
        let soft = self.first;
        let last = self.last.take();
        let (g, forces, w, shift) = (&self.compliance.g, &self.forces[..], &self.w, &self.shift);
        let all = Functionals { g, forces, w, shift };
        let p = soft.then(|| self.start(&y, until)).flatten();
        let mut body = Reduced { last, ..Reduced::new(self, all, y, p) };
        let left = newton::minimise(self.system.d, &mut body, soft, residuals, until)?;
        let Reduced { change, taken, last, .. } = body;
        self.last = last;
        self.compliance.subtract(&change, &mut v);
        let energy: f64 = v.iter().map(|v| v * v).sum();
        for (w, (change, taken)) in self.w.iter_mut().zip(change.iter().zip(&taken)) {
            *w += change + taken;
        }
        self.first = false;
        self.factored.factor.backward(&mut v);
        iterate.add(self.system, 1.0, &v);
        *at = iterate.evaluate(self.system, at.precisely);
        let square: f64 = v.iter().map(|v| v * v).sum();
        let softness = if energy > 0.0 { square / energy } else { 0.0 };
        Ok(Pass { energy, left, softness })
    }
}

impl Condensed<'_, '_, '_> {
    /// P where Newton's method is to start: that of a start that is given, or that of the solution with some pieces alone.
    fn start(&self, y: &[DoubleDouble], until: Until) -> Option<Vec<f64>> {
        let (d, g) = (self.system.d, &self.compliance.g);
        if let Some(p) = self.system.course.p(d) {
            return Some(p);
        }
        let some = SomePieces::of(d).filter(|_| self.shift.is_none())?;
        let chosen: Vec<usize> =
            some.pieces.iter().flat_map(|&e| d.contact[e].functionals()).collect();
        let mut place = vec![None; y.len()];
        chosen.iter().enumerate().for_each(|(k, &i)| place[i] = Some(k));
        let forces = self.forces.iter();
        let forces: Vec<_> =
            forces.filter_map(|&(i, row, entry)| Some((place[i]?, row, entry))).collect();
        let own = Mat::from_fn(chosen.len(), chosen.len(), |i, j| g[(chosen[i], chosen[j])]);
        let w: Vec<f64> = chosen.iter().map(|&i| self.w[i]).collect();
        let functionals = Functionals { g: &own, forces: &forces, w: &w, shift: &Shift::default() };
        let of_some = chosen.iter().map(|&i| y[i]).collect();
        let mut body = Reduced::new(self, functionals, of_some, None);
        let until = Until { residual: until.residual.max(ROUGHLY), ..until };
        newton::minimise(&some, &mut body, true, &mut Vec::new(), until).ok()?;
        let mut p: Vec<f64> = y.iter().map(|y| y.head()).collect();
        for (&i, w) in chosen.iter().zip(&body.change) {
            for (p, g) in p.iter_mut().zip(self.compliance.column(i)) {
                *p -= g * w;
            }
        }
        Some(p)
    }
}

/// The relative residual to which some pieces are solved for: they tell where contact is, not how hard it presses.
const ROUGHLY: f64 = 1e-3;

/// The number of pieces of which one is taken to start with: with a quarter of the functionals a dense factorisation takes a sixty-fourth.
const EVERY: usize = 4;

/// The number of functionals from which this pays: where they are fewer, the body takes most of the time.
const MANY: usize = 128;

/// Some of the pieces of Gamma_C, each with the springs of all those that it stands for.
struct SomePieces<'d, 'p> {
    d: &'d Discretization<'p>,
    pieces: Vec<usize>,
    /// The first value of each piece, and the number of all.
    starts: Vec<usize>,
}

impl<'d, 'p> SomePieces<'d, 'p> {
    /// Some pieces of a discretization with many.
    fn of(d: &'d Discretization<'p>) -> Option<Self> {
        if d.contact.last()?.functionals().end < MANY {
            return None;
        }
        let pieces: Vec<usize> = (EVERY / 2..d.contact.len()).step_by(EVERY).collect();
        let mut starts = vec![0];
        for &e in &pieces {
            starts.push(starts[starts.len() - 1] + d.contact[e].functionals().len());
        }
        Some(SomePieces { d, pieces, starts })
    }
}

impl ContactEnergy for SomePieces<'_, '_> {
    fn count(&self) -> usize {
        self.pieces.len()
    }

    fn values(&self, e: usize) -> Range<usize> {
        self.starts[e]..self.starts[e + 1]
    }

    fn derivatives(
        &self,
        e: usize,
        stiffness: f64,
        p: &[DoubleDouble],
    ) -> (Vec<f64>, DMatrix<f64>) {
        let (mut gradient, hessian) = self.d.derivatives(self.pieces[e], stiffness, p);
        gradient.iter_mut().for_each(|g| *g *= EVERY as f64);
        (gradient, hessian * EVERY as f64)
    }

    fn is_open(&self, e: usize, p: &[DoubleDouble]) -> bool {
        self.d.is_open(self.pieces[e], p)
    }

    fn bregman(&self, e: usize, stiffness: f64, p: &[DoubleDouble], q: &[DoubleDouble]) -> f64 {
        EVERY as f64 * self.d.bregman(self.pieces[e], stiffness, p, q)
    }
}

/// Functionals of contact with their compliance, the entries of their B^T, and the forces that act.
struct Functionals<'r> {
    g: &'r Mat<f64>,
    forces: &'r [(usize, usize, f64)],
    w: &'r [f64],
    shift: &'r Shift,
}

/// Newton's unknown, the change of w in this pass, with the values of P that belong to it. The change has digits of its own:
/// where contact is stiff, those of w are too few for it.
struct Reduced<'r, 'a, 'd, 'p> {
    route: &'r Condensed<'a, 'd, 'p>,
    of: Functionals<'r>,
    y: Vec<DoubleDouble>,
    /// P at a start, until it is used.
    p: Option<Vec<f64>>,
    /// The magnitudes that y was computed from.
    start: Vec<f64>,
    /// The part of the change that the factor sees.
    change: Vec<f64>,
    /// The rest, D dy.
    taken: Vec<f64>,
    dw: Vec<f64>,
    last: Option<Tangent>,
}

impl<'r, 'a, 'd, 'p> Reduced<'r, 'a, 'd, 'p> {
    fn new(
        route: &'r Condensed<'a, 'd, 'p>,
        of: Functionals<'r>,
        y: Vec<DoubleDouble>,
        p: Option<Vec<f64>>,
    ) -> Self {
        let start = y.iter().map(|y| y.head().abs()).collect();
        let (change, taken) = (vec![0.0; y.len()], vec![0.0; y.len()]);
        Reduced { route, of, y, p, start, change, taken, dw: Vec::new(), last: None }
    }

    /// All functionals take part.
    fn is_whole(&self) -> bool {
        self.y.len() == self.route.w.len()
    }

    fn times_compliance(&self, v: &[f64]) -> Vec<f64> {
        let product = self.of.g * ColRef::from_slice(v);
        product.iter().copied().collect()
    }

    /// The norm of B^T s, or of |B|^T |s|, relative to the reference.
    fn norm(&self, s: &[f64], of: impl Fn(f64) -> f64) -> f64 {
        let mut sum = vec![0.0; self.route.rows];
        for &(functional, row, entry) in self.of.forces {
            sum[row] += of(entry) * s[functional];
        }
        norm(&sum) / self.route.reference
    }

    /// The columns of R with the functionals of their pieces.
    fn roots(&self, hessian: &[DMatrix<f64>]) -> Roots {
        let (mut columns, mut negative) = (Vec::new(), Vec::new());
        for (e, (values, h)) in blocks(hessian).enumerate() {
            let springs = self.of.shift.0.get(&e);
            if springs.is_none() && h.iter().all(|h| *h == 0.0) {
                continue;
            }
            let (signed, rest, of) = match springs {
                Some(springs) => (&mut negative, springs - h, springs),
                None => (&mut columns, h.clone(), h),
            };
            let of_piece = root(rest, &of.diagonal()).into_iter();
            signed.extend(of_piece.map(|column| (values.clone(), column)));
        }
        let positive = columns.len();
        columns.append(&mut negative);
        Roots { columns, positive }
    }

    /// Puts the columns of R first that the `last` tangent begins with, and those of what presses most before the others. Returns how
    /// many are the same as there.
    fn reorder(&self, columns: &mut Vec<Root>, last: &[Root]) -> usize {
        let mut rest: Vec<Option<Root>> = columns.drain(..).map(Some).collect();
        // They are in the order of their functionals, with some taken away.
        let starts: Vec<usize> = rest.iter().flatten().map(|(values, _)| values.start).collect();
        for root in last {
            let first = starts.partition_point(|start| *start < root.0.start);
            let end = starts.partition_point(|start| *start <= root.0.start);
            match rest[first..end].iter_mut().find(|other| other.as_ref() == Some(root)) {
                Some(same) => columns.extend(same.take()),
                None => break,
            }
        }
        let kept = columns.len();
        let least = |(values, _): &Root| {
            let p = self.y[values.clone()].iter().map(|y| y.head());
            p.fold(f64::INFINITY, f64::min)
        };
        columns.extend(rest.into_iter().flatten());
        columns[kept..].sort_by(|a, b| least(b).total_cmp(&least(a)));
        kept
    }

    /// R in some order, and L of E + R^T G R = L E L^T. Of the `last` one the columns are kept that come before the first change, if all
    /// of E is positive.
    fn factored(&self, mut roots: Roots, last: Option<&Tangent>) -> Result<Tangent, SolveError> {
        let last = last.filter(|_| self.of.shift.is_none());
        let kept = match last {
            Some(last) => self.reorder(&mut roots.columns, &last.roots.columns),
            None if self.of.shift.is_none() => self.reorder(&mut roots.columns, &[]),
            None => 0,
        };
        let mut system = self.stiffened(&roots.columns, kept);
        let mut negative = roots.positive..system.nrows();
        for i in negative.clone() {
            system[(i, i)] -= 2.0;
        }
        match last {
            Some(last) => {
                cholesky::extend(system.as_mut(), last.factor.submatrix(0, 0, kept, kept))
            }
            None => quasidefinite(system.as_mut(), roots.positive),
        }
        .map_err(|_| SolveError::Singular)?;
        let is_loose = |i: usize| !(system[(i, i)] * system[(i, i)] > LOOSE);
        if negative.any(is_loose) {
            return Err(SolveError::Singular);
        }
        Ok(Tangent { roots, factor: system })
    }

    /// The tangent with the Hessian `at` an iterate. Where contact holds the body, and what is in contact does not, a little of the
    /// springs of all pieces is added.
    fn tangent(&self, at: &Derivatives, last: Option<&Tangent>) -> Result<Tangent, SolveError> {
        match self.factored(self.roots(&at.hessian), last) {
            Err(SolveError::Singular) if !self.of.shift.is_none() => self.factored(
                self.roots(&supported(self.route.system.d, at.stiffness, &at.hessian)),
                None,
            ),
            tangent => tangent,
        }
    }

    /// The lower triangle of I + R^T G R, but for that of its first `kept` columns.
    fn stiffened(&self, roots: &[Root], kept: usize) -> Mat<f64> {
        match roots.iter().map(|(values, _)| values.len()).max() {
            None => Mat::zeros(0, 0),
            Some(..=2) => self.stiffened_by::<2>(roots, kept),
            Some(3) => self.stiffened_by::<3>(roots, kept),
            Some(4) => self.stiffened_by::<4>(roots, kept),
            Some(_) => self.stiffened_by::<6>(roots, kept),
        }
    }

    /// [`Reduced::stiffened`] where a piece has up to W functionals, column by column: G R is added up from columns of G, which are
    /// contiguous.
    fn stiffened_by<const W: usize>(&self, roots: &[Root], kept: usize) -> Mat<f64> {
        let mut system = Mat::zeros(roots.len(), roots.len());
        // Entries beyond those of a piece are zero.
        let mut gr = vec![0.0; self.y.len() + W];
        let filled =
            |root: &DVector<f64>| std::array::from_fn(|k| root.get(k).copied().unwrap_or(0.0));
        let entries: Vec<(usize, [f64; W])> =
            roots.iter().map(|(values, root)| (values.start, filled(root))).collect();
        // Rows before those of this column and of all that follow are above the diagonal.
        let mut firsts: Vec<usize> = entries.iter().map(|(start, _)| *start).collect();
        for j in (1..firsts.len()).rev() {
            firsts[j - 1] = firsts[j - 1].min(firsts[j]);
        }
        let before = entries[..kept].iter().fold(usize::MAX, |least, (start, _)| least.min(*start));
        let entry = |(start, root): &(usize, [f64; W]), gr: &[f64]| {
            let gr = &gr[*start..*start + W];
            (0..W).fold(0.0, |sum, k| sum + root[k] * gr[k])
        };
        for ((j, (values, root)), first) in roots.iter().enumerate().zip(firsts).skip(kept) {
            let rows = first.min(before)..self.y.len();
            gr[rows.clone()].fill(0.0);
            for (functional, &factor) in values.clone().zip(root) {
                let g = &self.of.g.col_as_slice(functional)[rows.clone()];
                for (sum, g) in gr[rows.clone()].iter_mut().zip(g) {
                    *sum += factor * g;
                }
            }
            let column = &mut system.col_as_slice_mut(j)[j..];
            for (sum, of_row) in column.iter_mut().zip(&entries[j..]) {
                *sum = entry(of_row, &gr);
            }
            column[0] += 1.0;
            // The row of a new column in those that are kept.
            for (i, of_row) in entries[..kept].iter().enumerate() {
                system[(j, i)] = entry(of_row, &gr);
            }
        }
        system
    }

    fn s(&self, at: &Derivatives) -> Vec<f64> {
        let w = self.of.w.iter().zip(self.change.iter().zip(&self.taken));
        w.zip(&at.gradient).map(|((w, (change, taken)), g)| (w - g) + (change + taken)).collect()
    }
}

impl Body for Reduced<'_, '_, '_, '_> {
    fn y(&self) -> Cow<'_, [DoubleDouble]> {
        Cow::Borrowed(&self.y)
    }

    fn residual(&self, at: &Derivatives) -> Residual {
        let mut magnitudes = Vec::with_capacity(self.y.len());
        for (values, hessian) in at.blocks() {
            let first = values.start;
            let size = |b: usize| self.y[first + b].head().abs() + self.start[first + b];
            for (a, i) in values.enumerate() {
                let spread: f64 =
                    (0..hessian.nrows()).map(|b| hessian[(a, b)].abs() * size(b)).sum();
                let forces = self.of.w[i].abs() + self.taken[i].abs() + at.gradient[i].abs();
                magnitudes.push(forces + spread);
            }
        }
        Residual {
            norm: self.norm(&self.s(at), |entry| entry),
            noise: NOISE * f64::EPSILON * self.norm(&magnitudes, f64::abs),
        }
    }

    /// The body without contact is where it is already; the stiffness is by the power method on R^T G R. Where contact alone holds the
    /// body, it goes to where soft springs of all pieces hold it, which pull as well as push.
    fn start(&mut self, edges: &impl ContactEnergy) -> Result<Option<f64>, SolveError> {
        if self.p.is_none() && !self.of.shift.is_none() {
            let springs = springs_beside_shear(self.route.system.d);
            let pulling = all_springs(edges, 1.0 / springs).pulling(&self.y);
            let step = self.step(&pulling)?;
            self.advance(1.0, &step);
            return Ok(Some(springs));
        }
        let at = derivatives(edges, 1.0, &self.y);
        let roots = self.roots(&at.hessian).columns;
        let values_of = |values: &[f64]| -> Vec<f64> {
            roots.iter().map(|(own, column)| product(column, &values[own.clone()])).collect()
        };
        let y: Vec<f64> = self.y.iter().map(|y| y.head()).collect();
        let stiffness = newton::largest_eigenvalue(values_of(&y), |x| {
            let mut rx = vec![0.0; self.y.len()];
            for ((values, column), x) in roots.iter().zip(x) {
                for (i, entry) in values.clone().zip(column) {
                    rx[i] += entry * x;
                }
            }
            values_of(&self.times_compliance(&rx))
        });
        // Without contact the body bends so far that condensing loses all digits: contact holds the body, and the tangent
        // must know it.
        if self.of.shift.is_none() && !(stiffness * ROUNDED <= 1.0) {
            return Err(SolveError::Singular);
        }
        let Some(p) = self.p.take() else {
            return Ok(Some(stiffness));
        };
        let frozen = derivatives(edges, 1.0, &p).pulling(&self.y);
        let step = self.step(&frozen)?;
        self.advance(1.0, &step);
        Ok(None)
    }

    fn step(&mut self, at: &Derivatives) -> Result<Step, SolveError> {
        if self.is_whole() {
            self.route.system.enters_step();
        }
        let s = self.s(at);
        let tangent = self.tangent(at, self.last.as_ref())?;
        let Tangent { roots: Roots { columns, positive }, factor } = &tangent;
        let gs = self.times_compliance(&s);
        let mut t =
            Col::from_fn(columns.len(), |i| product(&columns[i].1, &gs[columns[i].0.clone()]));
        let (l, mut column) = (factor.as_ref(), t.as_mat_mut());
        solve_lower_triangular_in_place(l, column.as_mut(), Par::Seq);
        for i in *positive..columns.len() {
            column[(i, 0)] = -column[(i, 0)];
        }
        solve_upper_triangular_in_place(l.transpose(), column.as_mut(), Par::Seq);
        let mut dw: Vec<f64> = s.iter().map(|s| -s).collect();
        for (i, (values, column)) in columns.iter().enumerate() {
            for (functional, entry) in values.clone().zip(column) {
                dw[functional] += entry * t[i];
            }
        }
        let dy: Vec<f64> = self.times_compliance(&dw).into_iter().map(|v| -v).collect();
        let slope = -s.iter().zip(&dy).map(|(s, dy)| s * dy).sum::<f64>();
        // d^T A d is that of K less dy . D dy.
        let mut taken = vec![0.0; dy.len()];
        self.of.shift.add(self.route.system.d, 1.0, &dy, &mut taken);
        let all = dw.iter().zip(&taken).map(|(dw, taken)| dw + taken);
        let curvature = -all.zip(&dy).map(|(dw, dy)| dw * dy).sum::<f64>();
        (self.dw, self.last) = (dw, Some(tangent));
        Ok(Step { dy, slope, curvature })
    }

    fn advance(&mut self, t: f64, step: &Step) {
        for (change, dw) in self.change.iter_mut().zip(&self.dw) {
            *change += t * dw;
        }
        self.of.shift.add(self.route.system.d, t, &step.dy, &mut self.taken);
        for (y, dy) in self.y.iter_mut().zip(&step.dy) {
            *y += (t * dy).into();
        }
    }
}

/// A column of R, with the functionals of its piece.
type Root = (Range<usize>, DVector<f64>);

/// R, where H - D = R E R^T: so many columns whose sign is positive, and those whose sign is not.
struct Roots {
    columns: Vec<Root>,
    positive: usize,
}

/// R, and L of E + R^T G R = L E L^T.
struct Tangent {
    roots: Roots,
    factor: Mat<f64>,
}

/// The stiffness, beside that of the body on the springs of the shift, below which a motion counts as free.
const LOOSE: f64 = 1e-10;

/// The product of a column with the values of its piece.
fn product(column: &DVector<f64>, values: &[f64]) -> f64 {
    column.iter().zip(values).map(|(a, b)| a * b).sum()
}

/// The columns of R with H = R R^T for a positive semidefinite H, by Cholesky; those of pivots that are zero to the rounding of this
/// `diagonal` are left out.
fn root(mut h: DMatrix<f64>, diagonal: &DVector<f64>) -> Vec<DVector<f64>> {
    let count = h.nrows();
    let mut columns = Vec::with_capacity(count);
    for k in 0..count {
        if h[(k, k)] <= f64::EPSILON * diagonal[k] {
            continue;
        }
        let pivot = h[(k, k)].sqrt();
        let column = DVector::from_fn(count, |i, _| if i < k { 0.0 } else { h[(i, k)] / pivot });
        h -= &column * column.transpose();
        columns.push(column);
    }
    columns
}

#[cfg(test)]
mod tests {
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Diagonal, Problem, Rectangle};
    use crate::solve::{self, Method, Settings};

    use super::*;

    /// A cantilever over a floor on which its end comes to lie, with so many contact edges: the steps of Newton's method.
    fn steps(edges: usize) -> usize {
        let beam =
            Rectangle { width: 20.0, height: 1.0, nx: edges, ny: 4, diagonal: Diagonal::Crossed };
        let material = Material::lame(1.0, 1.0, Plane::Strain);
        let problem = Problem::of(beam.mesh().unwrap(), material)
            .with_body_force(|_| 0.0, |_| -1e-4)
            .with("left", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.01));
        let (solution, _) =
            solve::solve(&problem, &Method::default(), &Settings::default()).unwrap();
        assert_eq!(solution.method.route, crate::results::RouteName::Condensed);
        solution.newton.iterations()
    }

    #[test]
    fn some_of_the_pieces_tell_where_a_beam_lies_and_save_half_of_the_steps() {
        let [few, many] = [MANY / 2 - 1, MANY / 2].map(steps);
        assert!(2 * many <= few, "{many} with them, {few} without");
    }
}
