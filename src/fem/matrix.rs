//! The matrix of A(u, v) = a(u, v) - int gamma sigma_n(u) sigma_n(v) on the free degrees of freedom, in a given order of
//! elimination.
//!
//! The pattern is read off the mesh, node by node, and the element matrices are added into it in one pass. Here is where
//! that is stored; how it is done is `kernel::pattern`.

use nalgebra::Matrix2;

use super::discretization::Discretization;
use crate::kernel::edge_integral::ExactEdge;
use crate::kernel::element::stiffness;
use crate::kernel::pattern::{self, Lists, Numbers};

/// The numbers of the free degrees of freedom in an order of elimination: node by node, component by component.
#[derive(Clone, Debug)]
pub struct Numbering {
    /// The number of each node's components; `None` for a prescribed one.
    pub of: Vec<[Option<usize>; 2]>,
    /// How many are free.
    pub count: usize,
    /// The node to which each number belongs.
    nodes: Vec<usize>,
}

impl Numbering {
    /// Numbers the components that are not `prescribed`, the nodes taken in `order`.
    pub fn new(order: &[usize], prescribed: &[[Option<f64>; 2]]) -> Self {
        let mut of = vec![[None; 2]; prescribed.len()];
        let mut nodes = vec![0; 2 * prescribed.len()];
        let count = pattern::number(order, prescribed, &mut of, &mut nodes);
        nodes.truncate(count);
        Numbering { of, count, nodes }
    }

    fn numbers(&self) -> Numbers<'_> {
        Numbers { of: &self.of, nodes: &self.nodes }
    }

    /// A vector over the free degrees of freedom, from a field.
    pub fn gather(&self, field: &[[f64; 2]]) -> Vec<f64> {
        let mut vector = vec![0.0; self.count];
        pattern::gather(&self.of, field, &mut vector);
        vector
    }

    /// Writes a vector over the free degrees of freedom into a field.
    pub fn scatter(&self, vector: &[f64], field: &mut [[f64; 2]]) {
        pattern::scatter(&self.of, vector, field);
    }
}

/// The nodes around each node: those that share a triangle with it, itself included.
#[derive(Clone, Debug)]
pub struct Neighbours {
    starts: Vec<usize>,
    nodes: Vec<usize>,
}

impl Neighbours {
    /// In a mesh of `count` nodes with these on its triangles.
    pub fn new<const N: usize>(count: usize, elements: &[[usize; N]]) -> Self {
        let mut first = vec![0; count + 1];
        let mut triangles = vec![0; elements.len() * N];
        pattern::triangles_of_nodes(elements, &mut first, &mut triangles);
        let triangles = Lists { starts: &first, members: &triangles };

        let mut seen_by = vec![0; count];
        let mut starts = vec![0; count + 1];
        let mut nodes = vec![0; count + elements.len() * N * N.saturating_sub(1)];
        pattern::neighbours(elements, triangles, &mut seen_by, &mut starts, &mut nodes);
        nodes.truncate(starts[count]);
        Neighbours { starts, nodes }
    }

    fn lists(&self) -> Lists<'_> {
        Lists { starts: &self.starts, members: &self.nodes }
    }

    /// Around `node`.
    pub fn of(&self, node: usize) -> &[usize] {
        self.lists().of(node)
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

impl LowerTriangle {
    /// All entries that a matrix over these unknowns can have, zero.
    pub fn zero(numbering: &Numbering, neighbours: &Neighbours) -> Self {
        let (numbers, neighbours) = (numbering.numbers(), neighbours.lists());
        let mut starts = vec![0; numbering.count + 1];
        pattern::column_ends(numbers, neighbours, &mut starts);
        let mut rows = vec![0; starts[numbering.count]];
        pattern::column_rows(numbers, neighbours, &mut starts, &mut rows);
        let values = vec![0.0; rows.len()];
        LowerTriangle { starts, rows, values }
    }

    /// Adds the blocks of an element matrix: `block(i, j)` has the rows of `nodes[i]` and the columns of `nodes[j]`.
    pub fn add<const N: usize>(
        &mut self,
        numbering: &Numbering,
        nodes: &[usize; N],
        block: impl Fn(usize, usize) -> Matrix2<f64>,
    ) {
        let columns = Lists { starts: &self.starts, members: &self.rows };
        // `pattern` knows no numbers but whole ones, and takes a block as the array of its rows.
        let rows = |i, j| block(i, j).transpose().into();
        pattern::add(&numbering.of, columns, &mut self.values, nodes, rows);
    }
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
    let mut matrix = assemble_stiffness(d, numbering, neighbours);
    for edge in &d.contact {
        let weight = -edge.gamma * edge.length;
        let nodes = &d.space.elements()[edge.edge.triangle];
        matrix.add(numbering, nodes, |i, j| edge.functionals.stress_product(weight, i, j));
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
    let mut matrix = LowerTriangle::zero(numbering, neighbours);
    for (triangle, nodes) in d.space.triangles() {
        let k = stiffness::<E, f64, N, M>(&triangle, &d.problem.material);
        matrix.add(numbering, nodes, |i, j| k[i][j]);
    }
    matrix
}
