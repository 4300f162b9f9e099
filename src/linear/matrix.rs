//! The matrix of A(u, v) = a(u, v) - int gamma sigma_n(u) sigma_n(v) on the free degrees of freedom, in a given order of
//! elimination.
//!
//! Two numbers have an entry if their nodes share a triangle or a piece of Gamma_C. The places of all entries are read off the mesh first, node by
//! node; then the element matrices are added into them, so that all matrices over the same numbers have one pattern. A list of
//! all element entries, sorted by faer (`SymbolicSparseColMat::try_new_from_indices`), took two to four times as long.

use std::collections::BTreeMap;
use std::convert::identity;
use std::sync::Arc;

use nalgebra::{DMatrix, Matrix2, Vector2};
use thiserror::Error;

use crate::contact::discretization::Discretization;
use crate::contact::piece::Piece;
use crate::kernel::axial;
use crate::kernel::element::stiffness;
use crate::kernel::{Element, Scalar, Triangle};
use crate::model::constraints::{Constraints, from_frame, in_frame};
use crate::model::element::with_element;
use crate::model::material::Materials;
use crate::model::space::Space;

/// The numbers of the free degrees of freedom in an order of elimination: node by node, component by component.
#[derive(Clone, Debug)]
pub struct Numbering {
    /// The number of each node's components; `None` for a prescribed one.
    pub of: Vec<[Option<usize>; 2]>,
    /// The number of free ones.
    pub count: usize,
    /// The node to which each number belongs.
    nodes: Vec<usize>,
    /// The first axes of the frames that are not those of the coordinates, by node.
    frames: BTreeMap<usize, [f64; 2]>,
}

impl Numbering {
    /// Numbers the components that are not `prescribed`, the nodes taken in `order`, where each comes once; at nodes with a frame, those
    /// along its first axis and across it.
    pub fn new(
        order: &[usize],
        prescribed: &[[Option<f64>; 2]],
        frames: BTreeMap<usize, [f64; 2]>,
    ) -> Self {
        let mut of = vec![[None; 2]; prescribed.len()];
        let mut nodes = Vec::new();
        for &node in order {
            for c in 0..2 {
                if prescribed[node][c].is_none() {
                    of[node][c] = Some(nodes.len());
                    nodes.push(node);
                }
            }
        }
        let count = nodes.len();
        Numbering { of, count, nodes, frames }
    }

    /// Numbers the components that are free under `constraints`, in the frames of their nodes.
    pub fn under(order: &[usize], constraints: &Constraints) -> Self {
        Numbering::new(order, constraints.values(), constraints.frames().clone())
    }

    /// A vector over the free degrees of freedom, from a field.
    pub fn gather(&self, field: &[[f64; 2]]) -> Vec<f64> {
        let mut vector = vec![0.0; self.count];
        let mut put = |node: usize, value: [f64; 2]| {
            for c in 0..2 {
                if let Some(number) = self.of[node][c] {
                    vector[number] = value[c];
                }
            }
        };
        for (node, &value) in field.iter().enumerate() {
            put(node, value);
        }
        for (&node, &axis) in &self.frames {
            put(node, in_frame(axis, field[node]));
        }
        vector
    }

    /// Writes a vector over the free degrees of freedom into a field.
    pub fn scatter(&self, vector: &[f64], field: &mut [[f64; 2]]) {
        for (&node, &axis) in &self.frames {
            field[node] = in_frame(axis, field[node]);
        }
        for (numbers, value) in self.of.iter().zip(field.iter_mut()) {
            for c in 0..2 {
                if let Some(number) = numbers[c] {
                    value[c] = vector[number];
                }
            }
        }
        for (&node, &axis) in &self.frames {
            field[node] = from_frame(axis, field[node]);
        }
    }

    /// A vector at a node, a pair of entries of a functional, in the node's frame.
    pub fn in_frame<S: Scalar + From<f64>>(&self, node: usize, vector: [S; 2]) -> [S; 2] {
        self.frames.get(&node).map_or(vector, |&axis| in_frame(axis, vector))
    }

    /// The number of the first free component of a node.
    fn first(&self, node: usize) -> Option<usize> {
        self.of[node][0].or(self.of[node][1])
    }

    /// R_i^T block R_j with the frames R of the nodes i and j.
    fn turned_block<S: Scalar + From<f64>>(
        &self,
        [i, j]: [usize; 2],
        block: Matrix2<S>,
    ) -> Matrix2<S> {
        let rows = [0, 1].map(|c| self.in_frame(j, [block[(c, 0)], block[(c, 1)]]));
        let columns = [0, 1].map(|d| self.in_frame(i, [rows[0][d], rows[1][d]]));
        Matrix2::from(columns)
    }
}

/// An entry that has no place in the pattern of its matrix, or a functional that the elimination does not reach: a mistake of the
/// program. The matrix would be wrong without the entry.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "this program made a mistake: entry ({row}, {column}) of a matrix has no place in its pattern; please report the case"
)]
pub struct OutsidePattern {
    /// The row.
    pub(crate) row: usize,
    /// The column.
    pub(crate) column: usize,
}

/// The nodes around each node: those that share a triangle or a piece of Gamma_C with it, itself included.
#[derive(Clone, Debug)]
pub struct Neighbours {
    /// Where the room for the neighbours of each node starts, and where the last one ends.
    starts: Vec<usize>,
    /// The number of neighbours of each node.
    counts: Vec<usize>,
    /// The neighbours, in rooms for all that there can be.
    all: Vec<usize>,
}

impl Neighbours {
    /// The neighbours in a space.
    pub fn new(space: &Space) -> Self {
        Neighbours::of_cliques(space.nodes().len(), space.elements())
    }

    /// The neighbours in a space with these pieces of Gamma_C.
    pub fn across(space: &Space, pieces: &[Piece]) -> Self {
        let pairs = pieces.iter().filter(|piece| piece.sides.len() > 1);
        let joined = pairs.map(|piece| &*piece.nodes);
        Neighbours::of_cliques(space.nodes().len(), space.elements().chain(joined))
    }

    /// The neighbours where the nodes of each of `cliques` are neighbours of each other.
    fn of_cliques<'a>(nodes: usize, cliques: impl Iterator<Item = &'a [usize]> + Clone) -> Self {
        let mut starts = vec![1; nodes + 1];
        starts[0] = 0;
        for clique in cliques.clone() {
            clique.iter().for_each(|&node| starts[node + 1] += clique.len() - 1);
        }
        (0..nodes).for_each(|node| starts[node + 1] += starts[node]);
        let (mut counts, mut all) = (vec![1; nodes], vec![0; starts[nodes]]);
        (0..nodes).for_each(|node| all[starts[node]] = node);
        for clique in cliques {
            for &node in clique {
                let (room, count) = (&mut all[starts[node]..], &mut counts[node]);
                for other in clique {
                    if !room[..*count].contains(other) {
                        room[*count] = *other;
                        *count += 1;
                    }
                }
            }
        }
        Neighbours { starts, counts, all }
    }

    /// The nodes around `node`, each once.
    pub(crate) fn of(&self, node: usize) -> &[usize] {
        &self.all[self.starts[node]..][..self.counts[node]]
    }
}

/// The lower triangle of a sparse symmetric matrix, column by column, rows in increasing order, the diagonal first.
#[derive(Clone, Debug, PartialEq)]
pub struct LowerTriangle<S = f64> {
    /// Where each column starts, and where the last one ends.
    pub starts: Arc<Vec<usize>>,
    /// The row of each entry.
    pub rows: Arc<Vec<usize>>,
    /// The entries.
    pub values: Vec<S>,
}

impl<S: Scalar + From<f64>> LowerTriangle<S> {
    /// All entries that a matrix over these unknowns can have, zero.
    pub(crate) fn zero(numbering: &Numbering, neighbours: &Neighbours) -> Self {
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for (column, &node) in numbering.nodes.iter().enumerate() {
            if column > 0 && numbering.nodes[column - 1] == node {
                // The second column of a node has the rows of the first one but the first.
                rows.extend_from_within(starts[column - 1] + 1..);
                starts.push(rows.len());
                continue;
            }
            let numbers = neighbours.of(node).iter().flat_map(|&other| numbering.of[other]);
            let start = rows.len();
            rows.extend(numbers.flatten().filter(|&row| row >= column));
            rows[start..].sort_unstable();
            starts.push(rows.len());
        }
        let values = vec![S::zero(); rows.len()];
        LowerTriangle { starts: starts.into(), rows: rows.into(), values }
    }

    /// A zero matrix of other numbers with the pattern of this one.
    pub(crate) fn zero_in<T: Scalar>(&self) -> LowerTriangle<T> {
        let LowerTriangle { starts, rows, values } = self;
        let values = vec![T::zero(); values.len()];
        LowerTriangle { starts: Arc::clone(starts), rows: Arc::clone(rows), values }
    }

    /// Adds the blocks of an element matrix: `block(i, j)` has the rows of `nodes[i]` and the columns of `nodes[j]`.
    ///
    /// # Errors
    /// Nodes that are no neighbours.
    pub(crate) fn add(
        &mut self,
        numbering: &Numbering,
        nodes: &[usize],
        block: impl Fn(usize, usize) -> Matrix2<S>,
    ) -> Result<(), OutsidePattern> {
        let turned = nodes.iter().any(|node| numbering.frames.contains_key(node));
        for (j, &column_node) in nodes.iter().enumerate() {
            for (i, &row_node) in nodes.iter().enumerate() {
                // The numbers of a node follow each other: the whole block is above the diagonal.
                if numbering.first(row_node) < numbering.first(column_node) {
                    continue;
                }
                let mut block = block(i, j);
                if turned {
                    block = numbering.turned_block([row_node, column_node], block);
                }
                self.add_block(numbering.of[row_node], numbering.of[column_node], block)?;
            }
        }
        Ok(())
    }

    /// Adds a block of a pair of nodes, whose components have these numbers; what is above the diagonal is left out.
    fn add_block(
        &mut self,
        rows: [Option<usize>; 2],
        columns: [Option<usize>; 2],
        block: Matrix2<S>,
    ) -> Result<(), OutsidePattern> {
        let (Some(row), Some(column)) = (rows[0].or(rows[1]), columns[0].or(columns[1])) else {
            return Ok(());
        };
        // A column has few rows: a linear search is faster than a binary one.
        let of_column = &self.rows[self.starts[column]..self.starts[column + 1]];
        let place = of_column.iter().position(|&other| other == row);
        let place = place.ok_or(OutsidePattern { row, column })?;
        // Both columns of a node have the same rows, each from its diagonal on, and the rows of a node follow each other.
        for (d, j) in columns.into_iter().enumerate() {
            for (c, i) in rows.into_iter().enumerate() {
                if let (Some(i), Some(j)) = (i, j)
                    && i >= j
                {
                    let at = self.starts[j] + place + (i - row) - (j - column);
                    self.values[at] += block[(c, d)];
                }
            }
        }
        Ok(())
    }
}

/// The matrix of A over the free degrees of freedom in the order of `numbering`.
///
/// # Errors
/// `neighbours` of another space, or without the pieces that join two bodies.
pub fn assemble(
    d: &Discretization,
    numbering: &Numbering,
    neighbours: &Neighbours,
) -> Result<LowerTriangle, OutsidePattern> {
    let mut matrix = assemble_stiffness(d, numbering, neighbours)?;
    for piece in &d.contact {
        matrix.add_contact_stress(numbering, piece)?;
    }
    Ok(matrix)
}

/// The matrix of a(.,.) over the free degrees of freedom in the order of `numbering`.
///
/// # Errors
/// `neighbours` of another space.
pub fn assemble_stiffness(
    d: &Discretization,
    numbering: &Numbering,
    neighbours: &Neighbours,
) -> Result<LowerTriangle, OutsidePattern> {
    let mut matrix = LowerTriangle::zero(numbering, neighbours);
    matrix.add_stiffness(&d.space, &d.problem.material, numbering)?;
    Ok(matrix)
}

fn add_stiffness<E: Element<N, M>, S: Scalar + From<f64>, const N: usize, const M: usize>(
    matrix: &mut LowerTriangle<S>,
    (space, materials): (&Space, &Materials),
    numbering: &Numbering,
    exactly: impl Fn(Triangle<f64>) -> Triangle<S>,
) -> Result<(), OutsidePattern> {
    let number = <S as From<f64>>::from;
    for (t, (doubles, nodes)) in space.triangles::<N>().enumerate() {
        let material = materials.of(t);
        let (radii, material) = (material.radii(&doubles), material.map(number));
        let triangle = exactly(doubles);
        let k = match radii {
            None => stiffness::<E, _, _, _>(&triangle, &material),
            Some(radii) => axial::stiffness::<E, _, _, _>(&triangle, radii.map(number), &material),
        };
        matrix.add(numbering, nodes, |i, j| k[i][j])?;
    }
    Ok(())
}

impl LowerTriangle {
    /// Adds a(.,.).
    ///
    /// # Errors
    /// The pattern of another space.
    pub(crate) fn add_stiffness(
        &mut self,
        space: &Space,
        materials: &Materials,
        numbering: &Numbering,
    ) -> Result<(), OutsidePattern> {
        self.add_stiffness_of((space, materials), numbering, identity)
    }
}

impl<S: Scalar + From<f64>> LowerTriangle<S> {
    /// Adds a(.,.) of triangles as `exactly` has them.
    ///
    /// # Errors
    /// The pattern of another space.
    pub(crate) fn add_stiffness_of(
        &mut self,
        (space, materials): (&Space, &Materials),
        numbering: &Numbering,
        exactly: impl Fn(Triangle<f64>) -> Triangle<S>,
    ) -> Result<(), OutsidePattern> {
        with_element!(space.degree(), E => {
            add_stiffness::<E, S, _, _>(self, (space, materials), numbering, exactly)
        })
    }

    /// Adds -int gamma sigma_n(.) sigma_n(.) on a piece.
    ///
    /// # Errors
    /// A pattern that does not join the sides of the piece.
    pub fn add_contact_stress(
        &mut self,
        numbering: &Numbering,
        piece: &Piece<S>,
    ) -> Result<(), OutsidePattern> {
        let weight = -(piece.gamma * piece.length);
        self.add(numbering, &piece.nodes, |i, j| piece.stress_product(weight, i, j))
    }

    /// Adds P0^T h P0 of a piece: what is in contact holds the body.
    ///
    /// # Errors
    /// A pattern that does not join the sides of the piece.
    pub(crate) fn add_contact_springs(
        &mut self,
        numbering: &Numbering,
        piece: &Piece<S>,
        h: &DMatrix<S>,
    ) -> Result<(), OutsidePattern> {
        if h.iter().all(|h| *h == S::zero()) {
            return Ok(());
        }
        let (p0, nodes) = (&piece.p0, piece.nodes.len());
        let springs: Vec<Vector2<S>> = (0..h.nrows() * nodes)
            .map(|at| {
                let (a, j) = (at / nodes, at % nodes);
                (0..h.ncols()).fold(Vector2::zeros(), |sum, b| sum + p0[b][j] * h[(a, b)])
            })
            .collect();
        self.add(numbering, &piece.nodes, |i, j| {
            (0..h.nrows()).fold(Matrix2::zeros(), |sum, a| {
                sum + p0[a][i] * springs[a * nodes + j].transpose()
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Degree, Diagonal, Rectangle, Space};

    /// A spring between two nodes of a square, added to the matrix of the square.
    fn spring(between: [usize; 2], joined: bool) -> Result<Vec<f64>, OutsidePattern> {
        let square = Rectangle { width: 1.0, height: 1.0, nx: 4, ny: 4, diagonal: Diagonal::Right };
        let mesh = square.mesh().unwrap();
        let space = Space::new(&mesh, Degree::One);
        let nodes = space.nodes().len();
        let order: Vec<usize> = (0..nodes).collect();
        let numbering = Numbering::new(&order, &vec![[None; 2]; nodes], BTreeMap::new());
        let pair = joined.then_some(&between[..]);
        let neighbours = Neighbours::of_cliques(nodes, space.elements().chain(pair));
        let mut matrix = LowerTriangle::zero(&numbering, &neighbours);
        let block = |i: usize, j: usize| Matrix2::identity() * if i == j { 1.0 } else { -1.0 };
        matrix.add(&numbering, &between, block)?;
        Ok(matrix.values)
    }

    #[test]
    fn an_entry_without_a_place_is_an_error() {
        let whole = |values: Vec<f64>| values.iter().sum::<f64>();
        // The corners share no triangle; four ones on the diagonal, two -1 below.
        assert_eq!(spring([0, 24], false), Err(OutsidePattern { row: 48, column: 0 }));
        assert_eq!(spring([0, 24], true).map(whole), Ok(2.0));
        assert_eq!(spring([0, 1], false).map(whole), Ok(2.0));
    }
}
