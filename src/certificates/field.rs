//! A displacement on the triangles of a mesh, affine or quadratic.

use super::errors::CertifyError;
use crate::kernel::composite::Affine;
use crate::kernel::{Material, Triangle};
use crate::model::Mesh;

/// A displacement on the mesh: affine on its triangles, or quadratic.
#[derive(Clone)]
pub(super) struct Field {
    /// At the vertices.
    pub(crate) vertices: Vec<[f64; 2]>,
    /// Its values in the middle of each edge less the mean of the ends.
    pub(crate) bulges: Option<Vec<[f64; 2]>>,
}

impl Field {
    /// The field with these values at the vertices, and at the middles of the edges if there are so many.
    pub(crate) fn new(mesh: &Mesh, nodal: &[[f64; 2]]) -> Result<Field, CertifyError> {
        let (vertices, nodes) = (mesh.vertices().len(), mesh.vertices().len() + mesh.edge_count());
        if nodal.len() != vertices && nodal.len() != nodes {
            let found = nodal.len();
            return Err(CertifyError::Field { found, vertices, nodes });
        }
        let (ends, middles) = nodal.split_at(vertices);
        let beyond = |([a, b], middle): ([usize; 2], &[f64; 2])| {
            [0, 1].map(|c| middle[c] - (ends[a][c] + ends[b][c]) / 2.0)
        };
        let bulges = (!middles.is_empty())
            .then(|| edge_ends(mesh).into_iter().zip(middles).map(beyond).collect());
        Ok(Field { vertices: ends.to_vec(), bulges })
    }

    /// The values at the vertices, and at the middles of the edges if it is quadratic.
    pub(crate) fn nodal(&self, mesh: &Mesh) -> Vec<[f64; 2]> {
        let middle = |([a, b], bulge): ([usize; 2], &[f64; 2])| {
            [0, 1].map(|c| (self.vertices[a][c] + self.vertices[b][c]) / 2.0 + bulge[c])
        };
        let mut nodal = self.vertices.clone();
        nodal.extend(edge_ends(mesh).into_iter().zip(self.bulges.iter().flatten()).map(middle));
        nodal
    }

    /// C eps of it on triangle `t`, which has this material.
    pub(crate) fn stress(
        &self,
        mesh: &Mesh,
        material: &Material<f64>,
        t: usize,
        triangle: &Triangle<f64>,
    ) -> Affine<f64> {
        let nodal = mesh.triangles()[t].map(|vertex| self.vertices[vertex].into());
        let bulges = self.bulges.as_ref();
        let bulges = bulges.map(|all| mesh.triangle_edges()[t].map(|e| all[e].into()));
        Affine::of_displacement(triangle, &nodal, bulges.as_ref(), material)
    }
}

/// The ends of the mesh's edges, each as the first triangle that has it sees it.
pub(super) fn edge_ends(mesh: &Mesh) -> Vec<[usize; 2]> {
    let mut ends = vec![None; mesh.edge_count()];
    for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
        for local in 0..3 {
            ends[edges[local]].get_or_insert([corners[(local + 1) % 3], corners[(local + 2) % 3]]);
        }
    }
    ends.into_iter().map(Option::unwrap_or_default).collect()
}
