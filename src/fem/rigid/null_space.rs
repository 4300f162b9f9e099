//! The null space of the equations between the parts' motions: multifrontal QR with the rank found column by column (Heath
//! 1982).

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// A column of norm <= this, where coefficients are of order 1, is stopped by nothing. Rounding leaves some 1e-15; a part
/// of slenderness s held at its end alone makes 1/s.
const FREE: f64 = 1e-10;

/// Rows of coefficients, under orthogonal transformations.
pub(super) struct Dense {
    pub(super) columns: usize,
    pub(super) values: Vec<f64>,
}

impl Dense {
    pub(super) fn new(columns: usize) -> Self {
        Dense { columns, values: Vec::new() }
    }

    pub(super) fn count(&self) -> usize {
        self.values.len() / self.columns
    }

    pub(super) fn push(&mut self, row: [f64; 3]) {
        self.values.extend(row);
    }

    pub(super) fn at(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.values[row * self.columns + column]
    }

    /// Householder's reflection that gathers `column` of the rows from `top` on in row `top`; `false`, and the column zero
    /// there, if it is no longer than `negligible`.
    pub(super) fn reflect(&mut self, top: usize, column: usize, negligible: f64) -> bool {
        let count = self.count();
        let norm = (top..count).fold(0.0, |n: f64, r| n.hypot(*self.at(r, column)));
        if norm <= negligible {
            (top..count).for_each(|r| *self.at(r, column) = 0.0);
            return false;
        }
        let head = *self.at(top, column);
        let mut v: Vec<f64> = (top..count).map(|r| *self.at(r, column) / norm).collect();
        v[0] += head.signum();
        let half_square = 1.0 + head.abs() / norm;
        for c in column + 1..self.columns {
            let along: f64 = v.iter().enumerate().map(|(i, v)| v * *self.at(top + i, c)).sum();
            for (i, v) in v.iter().enumerate() {
                *self.at(top + i, c) -= along / half_square * v;
            }
        }
        (top..count).for_each(|r| *self.at(r, column) = 0.0);
        *self.at(top, column) = -head.signum() * norm;
        true
    }

    /// Replaces the rows by at most as many as there are columns, which ask the same. The columns before `first` are zero.
    pub(super) fn triangularise(&mut self, first: usize) {
        let mut top = 0;
        for column in first..self.columns {
            if top < self.count() && self.reflect(top, column, 0.0) {
                top += 1;
            }
        }
        self.values.truncate(top * self.columns);
    }
}

/// One eliminated part: the equations that give its unknowns, where there are any, from those of later parts.
pub(super) struct Eliminated {
    pub(super) part: usize,
    /// The other parts in the equations; the columns are those of `part`, then theirs.
    pub(super) others: Vec<usize>,
    pub(super) rows: Dense,
    /// The row that gives each unknown; `None` for a free one.
    pub(super) pivots: [Option<usize>; 3],
}

/// A basis of the solutions of homogeneous equations with three unknowns for each of `count` parts.
pub(super) fn null_space(
    count: usize,
    mut equations: Vec<Vec<(usize, [f64; 3])>>,
) -> Vec<Vec<(usize, [f64; 3])>> {
    let mut of_part: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); count];
    let mut neighbours: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); count];
    for (e, equation) in equations.iter().enumerate() {
        for &(part, _) in equation {
            of_part[part].insert(e);
            neighbours[part].extend(equation.iter().map(|term| term.0).filter(|&o| o != part));
        }
    }
    let mut queue: BinaryHeap<Reverse<(usize, usize)>> =
        (0..count).map(|part| Reverse((neighbours[part].len(), part))).collect();
    let mut done = vec![false; count];
    let mut steps: Vec<Eliminated> = Vec::with_capacity(count);
    while let Some(Reverse((degree, part))) = queue.pop() {
        // Each change of a degree has put the part into the queue again.
        if done[part] || degree != neighbours[part].len() {
            continue;
        }
        done[part] = true;
        let others: Vec<usize> = std::mem::take(&mut neighbours[part]).into_iter().collect();
        for &other in &others {
            neighbours[other].remove(&part);
            neighbours[other].extend(others.iter().filter(|&&o| o != other));
            queue.push(Reverse((neighbours[other].len(), other)));
        }
        let front = std::mem::take(&mut of_part[part]);
        let mut rows = Dense::new(3 * (1 + others.len()));
        for e in front {
            let row = rows.count();
            rows.values.resize(rows.values.len() + rows.columns, 0.0);
            for (other, coefficients) in std::mem::take(&mut equations[e]) {
                of_part[other].remove(&e);
                let block = others.binary_search(&other).map_or(0, |i| i + 1);
                for (k, coefficient) in coefficients.into_iter().enumerate() {
                    *rows.at(row, 3 * block + k) = coefficient;
                }
            }
        }
        let mut pivots = [None; 3];
        let mut top = 0;
        for (column, pivot) in pivots.iter_mut().enumerate() {
            if top < rows.count() && rows.reflect(top, column, FREE) {
                *pivot = Some(top);
                top += 1;
            }
        }
        let mut rest = Dense::new(rows.columns);
        rest.values = rows.values.split_off(top * rows.columns);
        if rest.count() + 3 > rest.columns {
            rest.triangularise(3);
        }
        for row in rest.values.chunks(rest.columns) {
            let equation: Vec<(usize, [f64; 3])> = others
                .iter()
                .zip(row[3..].chunks(3))
                .map(|(&other, c)| (other, [c[0], c[1], c[2]]))
                .filter(|(_, c)| *c != [0.0; 3])
                .collect();
            for (other, _) in &equation {
                of_part[*other].insert(equations.len());
            }
            equations.push(equation);
        }
        steps.push(Eliminated { part, others, rows, pivots });
    }
    substitute_back(count, &mut steps)
}

/// One null vector for each free unknown, the other free ones zero.
pub(super) fn substitute_back(
    count: usize,
    steps: &mut [Eliminated],
) -> Vec<Vec<(usize, [f64; 3])>> {
    // Which steps hear of a part: those that have it among the others.
    let mut hear: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (s, step) in steps.iter().enumerate() {
        step.others.iter().for_each(|&other| hear[other].push(s));
    }
    let free: Vec<(usize, usize)> = (0..steps.len())
        .flat_map(|s| [0, 1, 2].map(|column| (s, column)))
        .filter(|&(s, column)| steps[s].pivots[column].is_none())
        .collect();
    let mut basis = Vec::with_capacity(free.len());
    for (last, column) in free {
        let mut values: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        let mut waiting = BTreeSet::from([last]);
        while let Some(s) = waiting.pop_last() {
            let Eliminated { part, others, rows, pivots } = &mut steps[s];
            let mut own = [0.0; 3];
            if s == last {
                own[column] = 1.0;
            }
            for k in [2, 1, 0] {
                let Some(row) = pivots[k] else { continue };
                let mut sum: f64 = (k + 1..3).map(|j| *rows.at(row, j) * own[j]).sum();
                for (i, other) in others.iter().enumerate() {
                    if let Some(known) = values.get(other) {
                        sum +=
                            (0..3).map(|j| *rows.at(row, 3 * (i + 1) + j) * known[j]).sum::<f64>();
                    }
                }
                own[k] = -sum / *rows.at(row, k);
            }
            if own.iter().any(|v| v.abs() > f64::EPSILON) {
                values.insert(*part, own);
                waiting.extend(hear[*part].iter().copied());
            }
        }
        basis.push(values.into_iter().collect());
    }
    basis
}
