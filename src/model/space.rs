//! The space V^h on a mesh: its nodes, and the nodes of each triangle.
//!
//! A displacement is a vector per node; degree of freedom 2 i + c is component c at node i. The nodes of P1 are the
//! vertices of the mesh; P2 adds the midpoints of its edges.

use std::slice::ChunksExact;

use nalgebra::{Matrix2, Vector2};

use super::element::Degree;
use super::mesh::{BoundaryEdge, Mesh};
use crate::kernel::{Material, Triangle};

/// V^h of a degree on a mesh, no condition imposed.
#[derive(Clone, Debug)]
pub struct Space<'a> {
    mesh: &'a Mesh,
    degree: Degree,
    nodes: Vec<[f64; 2]>,
    /// The nodes of the triangles, one triangle after the other.
    elements: Vec<usize>,
}

impl<'a> Space<'a> {
    /// The space of a degree on `mesh`.
    pub fn new(mesh: &'a Mesh, degree: Degree) -> Self {
        let vertices = mesh.vertices().len();
        let mut nodes = mesh.vertices().to_vec();
        if degree == Degree::Two {
            nodes.resize(vertices + mesh.edge_count(), [0.0; 2]);
            for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
                for (i, edge) in edges.iter().enumerate() {
                    // The order of the two ends doesn't matter: x + y = y + x in floating point too.
                    let [a, b] = [1, 2].map(|k| nodes[corners[(i + k) % 3]]);
                    nodes[vertices + edge] = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
                }
            }
        }
        let mut elements = Vec::with_capacity(mesh.triangles().len() * degree.nodes_per_triangle());
        for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
            elements.extend(corners);
            if degree == Degree::Two {
                elements.extend(edges.iter().map(|edge| vertices + edge));
            }
        }
        Space { mesh, degree, nodes, elements }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// The polynomial degree.
    pub fn degree(&self) -> Degree {
        self.degree
    }

    /// The places of the nodes.
    pub fn nodes(&self) -> &[[f64; 2]] {
        &self.nodes
    }

    /// The nodes of all triangles, one triangle after the other, in the order of [`Element`](crate::kernel::Element).
    pub(crate) fn connectivity(&self) -> &[usize] {
        &self.elements
    }

    /// The nodes of each triangle.
    pub fn elements(&self) -> ChunksExact<'_, usize> {
        self.elements.chunks_exact(self.degree.nodes_per_triangle())
    }

    /// The nodes of triangle `t`.
    pub fn nodes_of(&self, t: usize) -> &[usize] {
        let count = self.degree.nodes_per_triangle();
        &self.elements[t * count..][..count]
    }

    /// The nodes on a boundary edge: start, end, then the midpoint if there is one.
    pub fn edge_nodes(&self, edge: BoundaryEdge) -> impl Iterator<Item = usize> {
        let nodes = self.nodes_of(edge.triangle);
        self.degree.edge_nodes(edge.local).map(|k| nodes[k])
    }

    /// The nodal values of `field` on triangle `t`.
    pub fn on_triangle(&self, t: usize, field: &[[f64; 2]]) -> Vec<Vector2<f64>> {
        self.nodes_of(t).iter().map(|&node| field[node].into()).collect()
    }

    /// All triangles with their coordinates and their nodes, of which there are `N`.
    pub fn triangles<const N: usize>(&self) -> impl Iterator<Item = (Triangle<f64>, &[usize; N])> {
        self.elements_of::<N>().iter().enumerate().map(|(t, nodes)| (self.mesh.triangle(t), nodes))
    }

    /// The nodes of the triangles, for N on each.
    pub(crate) fn elements_of<const N: usize>(&self) -> &[[usize; N]] {
        self.elements.as_chunks().0
    }

    /// The mean hoop strain of `field` on triangle `t`; 0 where the material is that of a plane body.
    pub(crate) fn mean_hoop_strain(
        &self,
        t: usize,
        material: &Material<f64>,
        field: &[[f64; 2]],
    ) -> f64 {
        let Some(radii) = material.radii(&self.mesh.triangle(t)) else { return 0.0 };
        let nodes = self.nodes_of(t);
        let strains = self.degree.hoop_strain(radii, |j| field[nodes[j]][0]);
        self.degree.value_from_points(strains, [1.0 / 3.0; 3])
    }

    /// The mean of the gradient of `field` on triangle `t`: its average over the points of the stiffness rule, which is exact for
    /// it.
    pub(crate) fn mean_gradient(&self, t: usize, field: &[[f64; 2]]) -> Matrix2<f64> {
        let barycentric = self.mesh.triangle(t).barycentric_gradients();
        let mut mean = Matrix2::zeros();
        let nodes = self.nodes_of(t);
        let nodal = |j: usize| Vector2::from(field[nodes[j]]);
        self.degree.at_stiffness_points(|l, weight: f64| {
            mean += self.degree.displacement_gradient(l, barycentric, nodal) * weight;
        });
        mean
    }
}
