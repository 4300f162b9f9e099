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

    /// The numbers of the free components of a node.
    fn free(&self, node: usize) -> impl Iterator<Item = usize> {
        self.of[node].into_iter().flatten()
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

/// The nodes around each node: those that share a triangle with it, itself included.
#[derive(Clone, Debug)]
pub struct Neighbours {
    starts: Vec<usize>,
    nodes: Vec<usize>,
}

impl Neighbours {
    /// In a mesh with these nodes on its triangles.
    pub fn new<const N: usize>(count: usize, elements: &[[usize; N]]) -> Self {
        let (first, owners) = triangles_of_nodes(count, elements);
        let mut starts = Vec::with_capacity(count + 1);
        let mut nodes = Vec::with_capacity(elements.len() * N * N / 2);
        let mut seen_by = vec![usize::MAX; count];
        for node in 0..count {
            starts.push(nodes.len());
            for &t in &owners[first[node]..first[node + 1]] {
                for &other in &elements[t] {
                    if seen_by[other] != node {
                        seen_by[other] = node;
                        nodes.push(other);
                    }
                }
            }
        }
        starts.push(nodes.len());
        Neighbours { starts, nodes }
    }

    /// Around `node`.
    pub fn of(&self, node: usize) -> &[usize] {
        &self.nodes[self.starts[node]..self.starts[node + 1]]
    }
}

/// The triangles of node i are `owners[first[i]..first[i + 1]]`.
fn triangles_of_nodes<const N: usize>(
    count: usize,
    elements: &[[usize; N]],
) -> (Vec<usize>, Vec<usize>) {
    let mut first = vec![0; count + 1];
    for &node in elements.as_flattened() {
        first[node + 1] += 1;
    }
    for node in 0..count {
        first[node + 1] += first[node];
    }
    let mut next = first.clone();
    let mut owners = vec![0; elements.len() * N];
    for (t, element) in elements.iter().enumerate() {
        for &node in element {
            owners[next[node]] = t;
            next[node] += 1;
        }
    }
    (first, owners)
}

/// The matrix of A over the free degrees of freedom in the order of `numbering`.
pub fn assemble<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    numbering: &Numbering,
    neighbours: &Neighbours,
) -> LowerTriangle
where
    E: ExactEdge<f64, N, M>,
{
    let pattern = Pattern::new(numbering, neighbours);
    let mut matrix = add_stiffness(d, &pattern);
    for edge in &d.contact {
        let weight = -edge.gamma * edge.length;
        let nodes = &d.space.elements()[edge.edge.triangle];
        pattern.add(&mut matrix, nodes, |i, j| edge.functionals.stress_product(weight, i, j));
    }
    matrix
}

/// The matrix of a(.,.) likewise.
pub fn assemble_stiffness<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    numbering: &Numbering,
    neighbours: &Neighbours,
) -> LowerTriangle
where
    E: ExactEdge<f64, N, M>,
{
    add_stiffness(d, &Pattern::new(numbering, neighbours))
}

fn add_stiffness<E, const N: usize, const M: usize>(
    d: &Discretization<E, N, M>,
    pattern: &Pattern,
) -> LowerTriangle
where
    E: ExactEdge<f64, N, M>,
{
    let mut matrix = pattern.zero_matrix();
    for (triangle, nodes) in d.space.triangles() {
        let k = stiffness::<E, f64, N, M>(&triangle, &d.problem.material);
        pattern.add(&mut matrix, nodes, |i, j| k[i][j]);
    }
    matrix
}

/// Where the entries of the matrix stand.
struct Pattern<'a> {
    numbering: &'a Numbering,
    /// For each node, the nodes from its place on, in order, are `later[first[node]..first[node + 1]]`.
    first: Vec<usize>,
    later: Vec<Later>,
    starts: Vec<usize>,
}

/// A node in the columns of another one.
struct Later {
    node: usize,
    /// How many free components come before its own.
    before: usize,
}

impl<'a> Pattern<'a> {
    fn new(numbering: &'a Numbering, neighbours: &Neighbours) -> Self {
        let count = numbering.of.len();
        let mut first = Vec::with_capacity(count + 1);
        let mut later: Vec<Later> = Vec::with_capacity(neighbours.nodes.len() / 2 + count);
        let mut lengths = vec![0; numbering.count];
        for node in 0..count {
            let start = later.len();
            first.push(start);
            let place = numbering.place[node];
            let around = neighbours.of(node).iter().copied();
            let after = around.filter(|&other| numbering.place[other] >= place);
            later.extend(after.map(|node| Later { node, before: 0 }));
            later[start..].sort_unstable_by_key(|entry| numbering.place[entry.node]);
            let mut before = 0;
            for entry in &mut later[start..] {
                entry.before = before;
                before += numbering.free(entry.node).count();
            }
            for (k, column) in numbering.free(node).enumerate() {
                lengths[column] = before - k;
            }
        }
        first.push(later.len());
        let mut starts = Vec::with_capacity(numbering.count + 1);
        let mut end = 0;
        for length in lengths {
            starts.push(end);
            end += length;
        }
        starts.push(end);
        Pattern { numbering, first, later, starts }
    }

    fn later(&self, node: usize) -> &[Later] {
        &self.later[self.first[node]..self.first[node + 1]]
    }

    fn zero_matrix(&self) -> LowerTriangle {
        let entries = self.starts.last().copied().unwrap_or(0);
        let mut rows = vec![0; entries];
        for node in 0..self.numbering.of.len() {
            for column in self.numbering.free(node) {
                let all = self.later(node).iter().flat_map(|l| self.numbering.free(l.node));
                let below = all.filter(|&row| row >= column);
                for (slot, row) in rows[self.starts[column]..].iter_mut().zip(below) {
                    *slot = row;
                }
            }
        }
        LowerTriangle { starts: self.starts.clone(), rows, values: vec![0.0; entries] }
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
            let later = self.later(column_node);
            for (i, &row_node) in nodes.iter().enumerate() {
                // A pair stands in the columns of the node that comes first.
                if place[row_node] < place[column_node] {
                    continue;
                }
                let Some(entry) = later.iter().find(|entry| entry.node == row_node) else {
                    continue;
                };
                let block = block(i, j);
                for (d, column) in of[column_node].iter().enumerate() {
                    let Some(column) = *column else { continue };
                    // The second column of a node starts one row lower than its first.
                    let skipped = usize::from(d == 1 && of[column_node][0].is_some());
                    let mut at = self.starts[column] + entry.before;
                    for (c, row) in of[row_node].iter().enumerate() {
                        let Some(row) = *row else { continue };
                        if row >= column {
                            matrix.values[at - skipped] += block[c][d];
                        }
                        at += 1;
                    }
                }
            }
        }
    }
}
