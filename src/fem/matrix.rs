//! The matrix of A(u, v) = a(u, v) - int gamma sigma_n(u) sigma_n(v) on the free degrees of freedom, in a given order of
//! elimination, and the right-hand side that goes with it.
//!
//! The pattern is read off the mesh, node by node, and the element matrices are added into it in one pass.

use super::discretization::Discretization;
use crate::kernel::edge_integral::ExactEdge;
use crate::kernel::element::stiffness;

/// The numbers of the free degrees of freedom in an order of elimination: node by node, component by component.
#[derive(Clone, Debug)]
pub struct Numbering {
    /// The number of each node's components; `None` for a prescribed one.
    pub of: Vec<[Option<usize>; 2]>,
    /// How many are free.
    pub count: usize,
    /// The place of each node in the order.
    place: Vec<usize>,
}

impl Numbering {
    /// Numbers the components that are not `prescribed`, the nodes taken in `order`.
    pub fn new(order: &[usize], prescribed: &[[Option<f64>; 2]]) -> Self {
        let mut of = vec![[None; 2]; order.len()];
        let mut place = vec![0; order.len()];
        let mut count = 0;
        for (k, &node) in order.iter().enumerate() {
            place[node] = k;
            for c in 0..2 {
                if prescribed[node][c].is_none() {
                    of[node][c] = Some(count);
                    count += 1;
                }
            }
        }
        Numbering { of, count, place }
    }

    /// A vector over the free degrees of freedom, from a field.
    pub fn gather(&self, field: &[[f64; 2]]) -> Vec<f64> {
        let mut vector = vec![0.0; self.count];
        for (numbers, values) in self.of.iter().zip(field) {
            for (number, value) in numbers.iter().zip(values) {
                if let Some(number) = number {
                    vector[*number] = *value;
                }
            }
        }
        vector
    }

    /// Writes a vector over the free degrees of freedom into a field.
    pub fn scatter(&self, vector: &[f64], field: &mut [[f64; 2]]) {
        for (numbers, values) in self.of.iter().zip(field) {
            for (number, value) in numbers.iter().zip(values) {
                if let Some(number) = number {
                    *value = vector[*number];
                }
            }
        }
    }
}

/// The lower triangle of a sparse symmetric matrix, column by column, rows in increasing order, the diagonal first.
#[derive(Clone, Debug)]
pub struct LowerTriangle {
    /// Where each column starts, and where the last one ends.
    pub starts: Vec<usize>,
    /// The row of each entry.
    pub rows: Vec<usize>,
    /// The entries.
    pub values: Vec<f64>,
}

/// For each node, the nodes that share a triangle with it, itself included.
pub fn neighbours<const N: usize>(nodes: usize, elements: &[[usize; N]]) -> Vec<Vec<usize>> {
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::with_capacity(2 * N); nodes];
    for element in elements {
        for &i in element {
            for &j in element {
                if !neighbours[i].contains(&j) {
                    neighbours[i].push(j);
                }
            }
        }
    }
    neighbours
}

/// The matrix of A over the free degrees of freedom in the order of `numbering`, given the [`neighbours`] of the nodes.
pub fn assemble<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    numbering: &Numbering,
    neighbours: &[Vec<usize>],
) -> LowerTriangle
where
    E: ExactEdge<f64, N, M>,
{
    let pattern = Pattern::new(numbering, neighbours);
    let mut matrix = pattern.zero_matrix();
    for (triangle, nodes) in d.space.triangles() {
        let k = stiffness::<E, f64, N, M>(&triangle, &d.problem.material);
        pattern.add(&mut matrix, nodes, |i, j| k[i][j]);
    }
    for edge in &d.contact {
        let weight = -edge.gamma * edge.length;
        let nodes = &d.space.elements()[edge.edge.triangle];
        pattern.add(&mut matrix, nodes, |i, j| edge.functionals.stress_product(weight, i, j));
    }
    matrix
}

/// Where the entries of the matrix stand.
struct Pattern<'a> {
    numbering: &'a Numbering,
    /// For each node, the nodes from its place on, in order, with the number of free components before each.
    later: Vec<Vec<(usize, usize)>>,
    starts: Vec<usize>,
    rows: Vec<usize>,
}

impl<'a> Pattern<'a> {
    fn new(numbering: &'a Numbering, neighbours: &[Vec<usize>]) -> Self {
        let free = |node: usize| numbering.of[node].iter().flatten();
        let mut later = Vec::with_capacity(neighbours.len());
        let mut columns = vec![(0, 0); numbering.count];
        for (node, around) in neighbours.iter().enumerate() {
            let mut around: Vec<usize> = around
                .iter()
                .copied()
                .filter(|&other| numbering.place[other] >= numbering.place[node])
                .collect();
            around.sort_unstable_by_key(|&other| numbering.place[other]);
            let mut before = 0;
            let list: Vec<(usize, usize)> = around
                .into_iter()
                .map(|other| {
                    let entry = (other, before);
                    before += free(other).count();
                    entry
                })
                .collect();
            for (k, &column) in free(node).enumerate() {
                columns[column] = (node, before - k);
            }
            later.push(list);
        }
        let mut starts = Vec::with_capacity(numbering.count + 1);
        let mut rows = Vec::new();
        for (column, (node, length)) in columns.into_iter().enumerate() {
            starts.push(rows.len());
            let all = later[node].iter().flat_map(|&(other, _)| free(other).copied());
            rows.extend(all.filter(|&row| row >= column));
            debug_assert_eq!(rows.len() - starts[column], length);
        }
        starts.push(rows.len());
        Pattern { numbering, later, starts, rows }
    }

    fn zero_matrix(&self) -> LowerTriangle {
        LowerTriangle {
            starts: self.starts.clone(),
            rows: self.rows.clone(),
            values: vec![0.0; self.rows.len()],
        }
    }

    /// Adds the blocks of an element matrix.
    fn add(
        &self,
        matrix: &mut LowerTriangle,
        nodes: &[usize],
        block: impl Fn(usize, usize) -> [[f64; 2]; 2],
    ) {
        let Numbering { of, place, .. } = self.numbering;
        for (j, &column_node) in nodes.iter().enumerate() {
            for (i, &row_node) in nodes.iter().enumerate() {
                if place[row_node] < place[column_node] {
                    continue;
                }
                let block = block(i, j);
                let Some(&(_, before)) =
                    self.later[column_node].iter().find(|(node, _)| *node == row_node)
                else {
                    continue;
                };
                for (d, column) in of[column_node].iter().enumerate() {
                    let Some(column) = *column else { continue };
                    // The second column of a node starts one row lower than its first.
                    let skipped = usize::from(d == 1 && of[column_node][0].is_some());
                    let free_rows =
                        of[row_node].iter().enumerate().filter(|(_, row)| row.is_some());
                    for (k, (c, row)) in free_rows.enumerate() {
                        if *row >= Some(column) {
                            matrix.values[self.starts[column] + before + k - skipped] +=
                                block[c][d];
                        }
                    }
                }
            }
        }
    }
}
