//! The space V^h on a mesh: its nodes, and the nodes of each triangle.
//!
//! A displacement is a vector per node; degree of freedom 2 i + c is component c at node i. The nodes of P1 are the
//! vertices of the mesh; P2 adds the midpoints of its edges.

use std::marker::PhantomData;

use nalgebra::Vector2;

use super::mesh::{BoundaryEdge, Mesh};
use crate::kernel::{Element, Triangle};

/// V^h of the element `E` (with `N` nodes on a triangle and `M` on an edge) on a mesh, no condition imposed.
#[derive(Clone, Debug)]
pub struct Space<'a, E, const N: usize, const M: usize> {
    mesh: &'a Mesh,
    nodes: Vec<[f64; 2]>,
    elements: Vec<[usize; N]>,
    element: PhantomData<E>,
}

impl<'a, E: Element<N, M>, const N: usize, const M: usize> Space<'a, E, N, M> {
    /// The space on `mesh`.
    pub fn new(mesh: &'a Mesh) -> Self {
        let vertices = mesh.vertices().len();
        let mut nodes = mesh.vertices().to_vec();
        if N > 3 {
            nodes.resize(vertices + mesh.edge_count(), [0.0; 2]);
            for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
                for (i, edge) in edges.iter().enumerate() {
                    // The order of the two ends doesn't matter: x + y = y + x in floating point too.
                    let [a, b] = [1, 2].map(|k| nodes[corners[(i + k) % 3]]);
                    nodes[vertices + edge] = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
                }
            }
        }
        let mut elements = vec![[0; N]; mesh.triangles().len()];
        for (t, element) in elements.iter_mut().enumerate() {
            let corners = mesh.triangles()[t].into_iter();
            let middles = mesh.triangle_edges()[t].into_iter().map(|edge| vertices + edge);
            for (slot, node) in element.iter_mut().zip(corners.chain(middles)) {
                *slot = node;
            }
        }
        Space { mesh, nodes, elements, element: PhantomData }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// The places of the nodes.
    pub fn nodes(&self) -> &[[f64; 2]] {
        &self.nodes
    }

    /// The nodes of each triangle, in the order of [`Element`].
    pub fn elements(&self) -> &[[usize; N]] {
        &self.elements
    }

    /// The nodes on a boundary edge: start, end, then the midpoint if there is one.
    pub fn edge_nodes(&self, edge: BoundaryEdge) -> [usize; M] {
        E::edge_nodes(edge.local).map(|k| self.elements[edge.triangle][k])
    }

    /// The nodal values of `field` on triangle `t`.
    pub fn on_triangle(&self, t: usize, field: &[[f64; 2]]) -> [Vector2<f64>; N] {
        self.elements[t].map(|node| field[node].into())
    }

    /// All triangles with their coordinates and their nodes.
    pub fn triangles(&self) -> impl Iterator<Item = (Triangle<f64>, &[usize; N])> {
        self.elements.iter().enumerate().map(|(t, nodes)| (self.mesh.triangle(t), nodes))
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;
    use nalgebra::Vector2;

    use super::*;
    use crate::fem::{Diagonal, Rectangle};
    use crate::kernel::{P1, P2};

    fn mesh() -> Mesh {
        let diagonal = Diagonal::Crossed;
        Rectangle { width: 1.0, height: 2.0, nx: 3, ny: 2, diagonal }.mesh().unwrap()
    }

    /// Each triangle finds its own nodes where the element says they are.
    fn nodes_are_where_the_element_has_them<E: Element<N, M>, const N: usize, const M: usize>() {
        let mesh = mesh();
        let space = Space::<E, N, M>::new(&mesh);
        for t in 0..mesh.triangles().len() {
            for local in 0..3 {
                let edge = BoundaryEdge { triangle: t, local };
                for (node, s) in space.edge_nodes(edge).into_iter().zip(E::edge_positions()) {
                    let x = mesh.triangle(t).point(crate::kernel::triangle::on_edge(local, s));
                    let node = Vector2::from(space.nodes()[node]);
                    // Half a sum of two coordinates below 2.
                    assert_abs_diff_eq!(x, node, epsilon = 1e-15);
                }
            }
        }
    }

    #[test]
    fn nodes_lie_on_the_edges_of_their_triangles() {
        nodes_are_where_the_element_has_them::<P1, 3, 2>();
        nodes_are_where_the_element_has_them::<P2, 6, 3>();
    }

    #[test]
    fn euler_counts_the_nodes() {
        let mesh = mesh();
        let (v, t) = (mesh.vertices().len(), mesh.triangles().len());
        assert_eq!(Space::<P1, 3, 2>::new(&mesh).nodes().len(), v);
        assert_eq!(Space::<P2, 6, 3>::new(&mesh).nodes().len(), 2 * v + t - 1);
    }
}
