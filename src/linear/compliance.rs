//! The compliance of the body as contact sees it: G = B A^-1 B^T = X^T X with X = L^-1 B^T, from the factor A = L L^T.
//!
//! A row of B belongs to a node of a piece of Gamma_C and touches the unknowns of its triangles, which are neighbours of each
//! other. These lie on one path of the elimination tree to its root, so the columns of X that belong to the piece are zero off that
//! path. Inside, pieces
//! are taken in the order in which a walk through the tree meets the supernodes where their paths begin; then the columns that
//! are not zero in the rows of a supernode are neighbours, and X is one dense block a supernode.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, Col, Mat, MatMut, Par};

use super::factor::{Factor, Structure};
use crate::linear::matrix::OutsidePattern;

/// The supernodes that contact functionals reach, and for each supernode its functionals.
pub(crate) struct Reach {
    /// The place of each functional in the order of the walk.
    places: Vec<usize>,
    /// The supernodes that are reached, in the order of elimination.
    supernodes: Vec<Reached>,
}

struct Reached {
    supernode: usize,
    /// The places of the functionals whose columns of X are not zero here.
    functionals: Range<usize>,
}

impl Reach {
    /// For pieces with their functionals and the unknowns that these touch, in the order of the functionals.
    pub(crate) fn new(structure: &Structure, pieces: &[(Range<usize>, Vec<usize>)]) -> Self {
        let count = structure.supernodes();
        let supernode_of = |row: usize| structure.supernode_of(row);
        let parent: Vec<Option<usize>> = (0..count)
            .map(|s| structure.rows_below(s).first().map(|&row| supernode_of(row)))
            .collect();
        let rank = postorder(&parent);
        let first = |e: usize| pieces[e].1.iter().min().map(|&row| supernode_of(row));
        let mut order: Vec<usize> = (0..pieces.len()).collect();
        order.sort_by_key(|&e| (first(e).map(|s| rank[s]), e));
        let mut ranges: Vec<Option<Range<usize>>> = vec![None; count];
        let mut places = vec![0; pieces.last().map_or(0, |(functionals, _)| functionals.end)];
        let mut start = 0;
        for e in order {
            let functionals = pieces[e].0.clone();
            let end = start + functionals.len();
            let mut at = first(e);
            while let Some(s) = at {
                match &mut ranges[s] {
                    Some(range) => range.end = end,
                    None => ranges[s] = Some(start..end),
                }
                at = parent[s];
            }
            for (place, functional) in (start..end).zip(functionals) {
                places[functional] = place;
            }
            start = end;
        }
        let supernodes = ranges
            .into_iter()
            .enumerate()
            .filter_map(|(supernode, range)| Some(Reached { supernode, functionals: range? }))
            .collect();
        Reach { places, supernodes }
    }

    /// The number of functionals.
    pub(crate) fn functionals(&self) -> usize {
        self.places.len()
    }

    /// Multiplications with an addition for X and G.
    pub(crate) fn operations(&self, structure: &Structure) -> f64 {
        let of = |reached: &Reached| {
            let w = structure.columns(reached.supernode).len() as f64;
            let below = structure.rows_below(reached.supernode).len() as f64;
            let c = reached.functionals.len() as f64;
            c * w * (w / 2.0 + below) + w * c * c / 2.0
        };
        self.supernodes.iter().map(of).sum()
    }

    /// The entries of X that are stored.
    pub(crate) fn stored_entries(&self, structure: &Structure) -> usize {
        let of = |r: &Reached| structure.columns(r.supernode).len() * r.functionals.len();
        self.supernodes.iter().map(of).sum()
    }
}

/// G in the order of the functionals from its lower triangle in that of the walk, column by column; `places` lead from one to the other.
fn in_order(walked: &[f64], places: &[usize]) -> Mat<f64> {
    let q = places.len();
    // Column by column: `Mat::from_fn` takes ten times the instructions.
    let mut g = Mat::zeros(q, q);
    for (j, &b) in places.iter().enumerate() {
        let below = &walked[b * q..(b + 1) * q];
        for (g, &a) in g.col_as_slice_mut(j).iter_mut().zip(places) {
            *g = if a >= b { below[a] } else { walked[a * q + b] };
        }
    }
    g
}

/// The place of each node of a forest in a walk that meets the children of a node before it, one subtree after the other.
fn postorder(parent: &[Option<usize>]) -> Vec<usize> {
    // Parents have larger numbers than their children. A subtree's size is known when its root is met; places are then
    // handed out from the roots down.
    let mut size = vec![1_usize; parent.len()];
    for (s, parent) in parent.iter().enumerate() {
        if let Some(p) = *parent {
            size[p] += size[s];
        }
    }
    let mut rank = vec![0; parent.len()];
    // The end of the part of a node's interval that is not handed out yet.
    let mut free = vec![0; parent.len()];
    let mut end = parent.len();
    for s in (0..parent.len()).rev() {
        let last = match parent[s] {
            Some(p) => {
                let last = free[p];
                free[p] -= size[s];
                last
            }
            None => {
                let last = end;
                end -= size[s];
                last
            }
        };
        rank[s] = last - 1;
        free[s] = last - 1;
    }
    rank
}

/// X = L^-1 B^T, block by block, and G = X^T X.
pub(crate) struct Compliance<'a> {
    structure: &'a Structure,
    reach: &'a Reach,
    x: Vec<Mat<f64>>,
    /// G, both triangles.
    pub(crate) g: Mat<f64>,
}

impl<'a> Compliance<'a> {
    /// From the factor, and the entries of B: `entries` calls its argument with the unknown, the functional and the entry.
    ///
    /// # Errors
    /// An entry, or one that the factor makes of it, in rows that `reach` does not reach with its functional.
    pub(crate) fn new(
        structure: &'a Structure,
        factor: &Factor,
        reach: &'a Reach,
        entries: impl FnOnce(&mut dyn FnMut(usize, usize, f64)),
    ) -> Result<Self, OutsidePattern> {
        let mut place_of_row = vec![None; structure.size()];
        for (place, r) in reach.supernodes.iter().enumerate() {
            place_of_row[structure.columns(r.supernode)].fill(Some(place));
        }
        let mut x: Vec<Mat<f64>> = reach
            .supernodes
            .iter()
            .map(|r| Mat::zeros(structure.columns(r.supernode).len(), r.functionals.len()))
            .collect();
        let start_of = |place: usize| {
            let r = &reach.supernodes[place];
            (structure.columns(r.supernode).start, r.functionals.start)
        };
        let mut outside = None;
        entries(&mut |row, functional, entry| {
            let column = reach.places[functional];
            match place_of_row[row] {
                Some(place) if reach.supernodes[place].functionals.contains(&column) => {
                    let (start, first) = start_of(place);
                    x[place][(row - start, column - first)] += entry;
                }
                _ => outside = Some(OutsidePattern { row, column: functional }),
            }
        });
        if let Some(outside) = outside {
            return Err(outside);
        }
        let q = reach.functionals();
        // Memory that is zero from the start: `Mat::zeros` writes entry by entry.
        let mut walked = vec![0.0; q * q];
        for (place, r) in reach.supernodes.iter().enumerate() {
            let block = factor.block(r.supernode);
            let (diagonal, below) = block.split_at_row(block.ncols());
            solve_lower_triangular_in_place(diagonal, x[place].as_mut(), Par::Seq);
            let c = r.functionals.len();
            let mut update = Mat::zeros(below.nrows(), c);
            matmul(update.as_mut(), Accum::Replace, below, x[place].as_ref(), 1.0, Par::Seq);
            let mut done = 0;
            let follow = |a: &usize, b: &usize| *b == a + 1 && place_of_row[*a] == place_of_row[*b];
            for rows in structure.rows_below(r.supernode).chunk_by(follow) {
                // An ancestor of a supernode that is reached is reached, by all of its functionals.
                let outside = OutsidePattern { row: rows[0], column: r.functionals.start };
                let target = place_of_row[rows[0]].ok_or(outside)?;
                let (start, first) = start_of(target);
                let offset = r.functionals.start.checked_sub(first).ok_or(outside)?;
                for j in 0..c {
                    let sums = &mut x[target].col_as_slice_mut(offset + j)[rows[0] - start..];
                    let update = &update.col_as_slice(j)[done..done + rows.len()];
                    sums.iter_mut().zip(update).for_each(|(sum, by)| *sum -= by);
                }
                done += rows.len();
            }
            let range = r.functionals.clone();
            let all = MatMut::from_column_major_slice_mut(&mut walked, q, q);
            triangular::matmul(
                all.submatrix_mut(range.start, range.start, c, c),
                BlockStructure::TriangularLower,
                Accum::Add,
                x[place].transpose(),
                BlockStructure::Rectangular,
                x[place].as_ref(),
                BlockStructure::Rectangular,
                1.0,
                Par::Seq,
            );
        }
        let g = in_order(&walked, &reach.places);
        Ok(Compliance { structure, reach, x, g })
    }

    /// A column of G.
    pub(crate) fn column(&self, functional: usize) -> &[f64] {
        self.g.col_as_slice(functional)
    }

    /// X^T v
    pub(crate) fn transpose_times(&self, v: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.reach.functionals()];
        for (x, r) in self.x.iter().zip(&self.reach.supernodes) {
            let rows = &v[self.structure.columns(r.supernode)];
            let product = x.transpose() * Col::from_fn(rows.len(), |i| rows[i]);
            for (sum, p) in sum[r.functionals.clone()].iter_mut().zip(product.iter()) {
                *sum += p;
            }
        }
        self.reach.places.iter().map(|&place| sum[place]).collect()
    }

    /// v <- v - X w
    pub(crate) fn subtract(&self, w: &[f64], v: &mut [f64]) {
        let mut walked = vec![0.0; w.len()];
        for (&place, &w) in self.reach.places.iter().zip(w) {
            walked[place] = w;
        }
        for (x, r) in self.x.iter().zip(&self.reach.supernodes) {
            let w = &walked[r.functionals.clone()];
            let product = x * Col::from_fn(w.len(), |i| w[i]);
            for (v, p) in v[self.structure.columns(r.supernode)].iter_mut().zip(product.iter()) {
                *v -= p;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;
    use crate::contact::{Discretization, EdgeRule};
    use crate::kernel::{Material, Plane};
    use crate::linear::dense::dot;
    use crate::linear::system::System;
    use crate::model::{Condition, Degree, Diagonal, Problem, Rectangle, SharedFunction};

    /// Two sides of a crossed rectangle in contact, so that their paths in the elimination tree meet high up only.
    fn problem() -> Problem {
        let zero = || -> SharedFunction { Arc::new(|_: [f64; 2]| 0.0) };
        let contact = || Condition::Contact { gap: Arc::new(|_: [f64; 2]| 0.0) };
        let mesh = Rectangle { width: 2.0, height: 1.0, nx: 7, ny: 4, diagonal: Diagonal::Crossed };
        Problem::new(
            mesh.mesh().unwrap(),
            Material::lame(1.0, 1.0, Plane::Strain),
            [zero(), zero()],
            BTreeMap::from([
                ("left".to_owned(), Condition::Displacement([Some(zero()), Some(zero())])),
                ("bottom".to_owned(), contact()),
                ("right".to_owned(), contact()),
            ]),
        )
    }

    /// G, X^T v and v - X w against substitutions with one column of B^T after the other.
    fn is_what_substitutions_give(degree: Degree) {
        let problem = problem();
        let rule = EdgeRule::Exact;
        let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, rule).unwrap();
        let system = System::new(&d).unwrap();
        let reach = Reach::new(&system.structure, &system.pieces());
        let factor = Factor::with(&system.structure, &system.matrix).unwrap();
        let entries = |add: &mut dyn FnMut(usize, usize, f64)| system.each_functional(add);
        let compliance = Compliance::new(&system.structure, &factor, &reach, entries).unwrap();
        let mut columns = vec![vec![0.0; system.numbering.count]; reach.functionals()];
        system.each_functional(|row, i, entry| columns[i][row] += entry);
        columns.iter_mut().for_each(|column| factor.forward(column));
        let largest = columns.iter().map(|c| dot(c, c)).fold(0.0, f64::max);
        for i in 0..columns.len() {
            for j in 0..columns.len() {
                let g = dot(&columns[i], &columns[j]);
                assert!((compliance.g[(i, j)] - g).abs() <= 1e-13 * largest, "({i}, {j})");
            }
        }
        let v: Vec<f64> = (0..system.numbering.count).map(|i| (i as f64).sin()).collect();
        let products = compliance.transpose_times(&v);
        for (column, product) in columns.iter().zip(&products) {
            assert!((dot(column, &v) - product).abs() <= 1e-12 * largest.sqrt());
        }
        let mut rest = v.clone();
        compliance.subtract(&products, &mut rest);
        for (i, rest) in rest.iter().enumerate() {
            let xw: f64 = columns.iter().zip(&products).map(|(c, w)| c[i] * w).sum();
            assert!((v[i] - xw - rest).abs() <= 1e-12 * (1.0 + xw.abs()));
        }
    }

    #[test]
    fn x_and_g_are_what_substitutions_give() {
        is_what_substitutions_give(Degree::One);
        is_what_substitutions_give(Degree::Two);
    }

    /// The multiplications for X, by substitutions with the blocks of L in which a column is not zero, and for the lower half of G.
    fn counted(structure: &Structure, columns: &[Vec<f64>]) -> [f64; 2] {
        let (mut for_x, mut for_g) = (0, 0);
        for s in 0..structure.supernodes() {
            let rows = structure.columns(s);
            let is_there = |column: &&Vec<f64>| column[rows.clone()].iter().any(|x| *x != 0.0);
            let count = columns.iter().filter(is_there).count();
            let entries: usize =
                (0..rows.len()).map(|k| k + 1 + structure.rows_below(s).len()).sum();
            for_x += count * entries;
            for_g += rows.len() * count * (count + 1) / 2;
        }
        [for_x as f64, for_g as f64]
    }

    #[test]
    fn as_many_operations_are_predicted_as_substitutions_and_products_of_their_columns_take() {
        let problem = problem();
        for degree in [Degree::One, Degree::Two] {
            let rule = EdgeRule::Exact;
            let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, rule).unwrap();
            let system = System::new(&d).unwrap();
            let structure = &system.structure;
            let reach = Reach::new(structure, &system.pieces());
            let factor = Factor::with(structure, &system.matrix).unwrap();
            let mut columns = vec![vec![0.0; system.numbering.count]; reach.functionals()];
            system.each_functional(|row, i, entry| columns[i][row] += entry);
            columns.iter_mut().for_each(|column| factor.forward(column));
            let [x, g] = counted(structure, &columns);
            // Half of a square counts for n^2 / 2, which is n / 2 less than with the diagonal: for X and G together, 1 for each entry of X.
            let predicted = reach.operations(structure) + reach.stored_entries(structure) as f64;
            assert_eq!(predicted, x + g);
            // The control: the products for G are not few.
            assert!(g > 0.25 * predicted);
        }
    }

    #[test]
    fn a_functional_off_the_elimination_path_is_an_error() {
        let problem = problem();
        let degree = Degree::One;
        let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact);
        let d = d.unwrap();
        let system = System::new(&d).unwrap();
        let pieces = system.pieces();
        let reach = Reach::new(&system.structure, &pieces);
        let factor = Factor::with(&system.structure, &system.matrix).unwrap();
        let with = |row: usize, functional: usize| {
            Compliance::new(&system.structure, &factor, &reach, |add| add(row, functional, 1.0))
        };
        assert!(with(pieces[0].1[0], 0).is_ok());
        // The unknowns that are eliminated first of all are far from Gamma_C, or from one of the two sides.
        for (functionals, _) in [&pieces[0], &pieces[pieces.len() - 1]] {
            let functional = functionals.start;
            let errors = (0..system.numbering.count).filter_map(|row| with(row, functional).err());
            let errors: Vec<OutsidePattern> = errors.collect();
            assert!(!errors.is_empty());
            assert!(errors.iter().all(|error| error.column == functional));
        }
    }

    #[test]
    fn a_walk_meets_children_before_parents_and_subtrees_in_one_piece() {
        //      5        4 and 5 are roots; 0, 1 below 3 below 5, 2 below 4.
        let parent = [Some(3), Some(3), Some(4), Some(5), None, None];
        let rank = postorder(&parent);
        let mut sorted = rank.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3, 4, 5]);
        for (s, parent) in parent.iter().enumerate() {
            assert!(parent.is_none_or(|p| rank[s] < rank[p]));
        }
        let subtree = [rank[0], rank[1], rank[3], rank[5]];
        assert_eq!(subtree.iter().max().unwrap() - subtree.iter().min().unwrap(), 3);
    }
}
