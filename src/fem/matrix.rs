//! The matrix of A(u, v) = a(u, v) - int gamma sigma_n(u) sigma_n(v) on the free degrees of freedom, in a given order of
//! elimination.
//!
//! The pattern is read off the mesh, node by node, and the element matrices are added into it in one pass. Here is where
//! that is stored; how it is done is `kernel::pattern`. A list of all element entries, sorted by faer
//! (`SymbolicSparseColMat::try_new_from_indices`), takes 2.1 to 4.3 times as long, P1 with 64 to 256 cells a side.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, Matrix2};

use super::constraints::{Constraints, from_frame, in_frame};
use super::contact_face::ContactFace;
use super::discretization::Discretization;
use super::element::{Degree, with_element};
use super::material::Materials;
use super::space::Space;
use crate::kernel::element::stiffness;
use crate::kernel::pattern::{self, Lists, Numbers};
use crate::kernel::{Element, Scalar};

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
    /// Numbers the components that are not `prescribed`, the nodes taken in `order`.
    pub fn new(order: &[usize], prescribed: &[[Option<f64>; 2]]) -> Self {
        let mut of = vec![[None; 2]; prescribed.len()];
        let mut nodes = vec![0; 2 * prescribed.len()];
        let count = pattern::number(order, prescribed, &mut of, &mut nodes);
        nodes.truncate(count);
        Numbering { of, count, nodes, frames: BTreeMap::new() }
    }

    /// Numbers the components that are free under `constraints`, in the frames of their nodes.
    pub fn under(order: &[usize], constraints: &Constraints) -> Self {
        Numbering::in_frames(order, constraints.values(), constraints.frames().clone())
    }

    /// Numbers the components that are not `prescribed`, along the first axes in `frames` and across them at those nodes.
    pub fn in_frames(
        order: &[usize],
        prescribed: &[[Option<f64>; 2]],
        frames: BTreeMap<usize, [f64; 2]>,
    ) -> Self {
        Numbering { frames, ..Numbering::new(order, prescribed) }
    }

    fn numbers(&self) -> Numbers<'_> {
        Numbers { of: &self.of, nodes: &self.nodes }
    }

    /// A vector over the free degrees of freedom, from a field.
    pub fn gather(&self, field: &[[f64; 2]]) -> Vec<f64> {
        let mut vector = vec![0.0; self.count];
        if self.frames.is_empty() {
            pattern::gather(&self.of, field, &mut vector);
        } else {
            pattern::gather(&self.of, &self.turned(field), &mut vector);
        }
        vector
    }

    /// Writes a vector over the free degrees of freedom into a field.
    pub fn scatter(&self, vector: &[f64], field: &mut [[f64; 2]]) {
        for (&node, &axis) in &self.frames {
            field[node] = in_frame(axis, field[node]);
        }
        pattern::scatter(&self.of, vector, field);
        for (&node, &axis) in &self.frames {
            field[node] = from_frame(axis, field[node]);
        }
    }

    /// A vector at a node, a pair of entries of a functional, in the node's frame.
    pub fn in_frame<S: Scalar + From<f64>>(&self, node: usize, vector: [S; 2]) -> [S; 2] {
        self.frames.get(&node).map_or(vector, |&axis| in_frame(axis, vector))
    }

    fn turned(&self, field: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut turned = field.to_vec();
        for (&node, &axis) in &self.frames {
            turned[node] = in_frame(axis, turned[node]);
        }
        turned
    }

    /// R_i^T block R_j with the frames R of the nodes i and j.
    fn turned_block(&self, [i, j]: [usize; 2], block: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let rows = block.map(|row| self.in_frame(j, row));
        let columns = [0, 1].map(|d| self.in_frame(i, [rows[0][d], rows[1][d]]));
        [0, 1].map(|c| [0, 1].map(|d| columns[d][c]))
    }
}

/// The nodes around each node: those that share a triangle with it, itself included.
#[derive(Clone, Debug)]
pub struct Neighbours {
    starts: Vec<usize>,
    nodes: Vec<usize>,
}

impl Neighbours {
    /// In a space.
    pub fn new(space: &Space) -> Self {
        let (count, nodes) = (space.nodes().len(), space.connectivity());
        match space.degree() {
            Degree::One => Neighbours::of_elements(count, nodes.as_chunks::<3>().0),
            Degree::Two => Neighbours::of_elements(count, nodes.as_chunks::<6>().0),
        }
    }

    /// In a mesh of `count` nodes with these on its triangles.
    pub fn of_elements<const N: usize>(count: usize, elements: &[[usize; N]]) -> Self {
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
        let rows = |block: Matrix2<f64>| block.transpose().into();
        if nodes.iter().any(|node| numbering.frames.contains_key(node)) {
            let block = |i, j| numbering.turned_block([nodes[i], nodes[j]], rows(block(i, j)));
            pattern::add(&numbering.of, columns, &mut self.values, nodes, block);
        } else {
            let block = |i, j| rows(block(i, j));
            pattern::add(&numbering.of, columns, &mut self.values, nodes, block);
        }
    }
}

/// The matrix of A over the free degrees of freedom in the order of `numbering`.
pub fn assemble(
    d: &Discretization,
    numbering: &Numbering,
    neighbours: &Neighbours,
) -> LowerTriangle {
    let mut matrix = assemble_stiffness(d, numbering, neighbours);
    for edge in &d.contact {
        matrix.add_contact_stress(numbering, edge);
    }
    matrix
}

/// The matrix of a(.,.) likewise.
pub fn assemble_stiffness(
    d: &Discretization,
    numbering: &Numbering,
    neighbours: &Neighbours,
) -> LowerTriangle {
    let mut matrix = LowerTriangle::zero(numbering, neighbours);
    matrix.add_stiffness(&d.space, &d.problem.material, numbering);
    matrix
}

fn add_stiffness<E: Element<N, M>, const N: usize, const M: usize>(
    matrix: &mut LowerTriangle,
    space: &Space,
    materials: &Materials,
    numbering: &Numbering,
) {
    for (t, (triangle, nodes)) in space.triangles::<N>().enumerate() {
        let k = stiffness::<E, f64, N, M>(&triangle, materials.of(t));
        matrix.add(numbering, nodes, |i, j| k[i][j]);
    }
}

impl LowerTriangle {
    /// Adds a(.,.).
    pub fn add_stiffness(&mut self, space: &Space, materials: &Materials, numbering: &Numbering) {
        with_element!(space.degree(), add_stiffness(self, space, materials, numbering));
    }

    /// Adds -int gamma sigma_n(.) sigma_n(.) on a contact edge.
    pub fn add_contact_stress(&mut self, numbering: &Numbering, edge: &ContactFace) {
        let weight = -(edge.gamma * edge.length);
        let block = |i, j| edge.functionals.stress_product(weight, i, j);
        self.add_on_face(numbering, edge, block);
    }

    /// Adds P0^T h P0 of a contact edge: what is in contact holds the body.
    pub fn add_contact_springs(
        &mut self,
        numbering: &Numbering,
        edge: &ContactFace,
        h: &DMatrix<f64>,
    ) {
        let p0 = edge.functionals.p0();
        self.add_on_face(numbering, edge, |i, j| {
            Matrix2::from_fn(|c, k| {
                let mut sum = 0.0;
                for a in 0..h.nrows() {
                    for b in 0..h.ncols() {
                        sum += p0[a][i][c] * h[(a, b)] * p0[b][j][k];
                    }
                }
                sum
            })
        });
    }

    /// Adds the blocks of a matrix over the nodes of a contact edge's triangle.
    fn add_on_face(
        &mut self,
        numbering: &Numbering,
        edge: &ContactFace,
        block: impl Fn(usize, usize) -> Matrix2<f64>,
    ) {
        if let Ok(nodes) = edge.nodes[..].try_into() {
            self.add::<3>(numbering, nodes, block);
        } else if let Ok(nodes) = edge.nodes[..].try_into() {
            self.add::<6>(numbering, nodes, block);
        }
    }
}
