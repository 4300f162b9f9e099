//! A displacement on the triangles of a mesh, affine or quadratic.

use super::errors::CertifyError;
use super::parts::ProblemParts;
use crate::fem::Mesh;
use crate::kernel::Triangle;
use crate::kernel::composite::Affine;

/// A displacement on the mesh: affine on its triangles, or quadratic.
#[derive(Clone)]
pub(super) struct Field {
    /// At the vertices.
    pub vertices: Vec<[f64; 2]>,
    /// Its values in the middle of each edge less the mean of the ends.
    pub bulges: Option<Vec<[f64; 2]>>,
}

impl Field {
    /// The field with these values at the vertices, and at the middles of the edges if there are so many.
    pub fn new(mesh: &Mesh, nodal: &[[f64; 2]]) -> Result<Field, CertifyError> {
        let (vertices, nodes) = (mesh.vertices().len(), mesh.vertices().len() + mesh.edge_count());
        if nodal.len() != vertices && nodal.len() != nodes {
            let found = nodal.len();
            return Err(CertifyError::Field { found, vertices, nodes });
        }
        let (ends, middles) = nodal.split_at(vertices);
        let bulges = (!middles.is_empty()).then(|| {
            let mut bulges = vec![[0.0; 2]; middles.len()];
            for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
                for (local, &e) in edges.iter().enumerate() {
                    let [a, b] = [1, 2].map(|k| ends[corners[(local + k) % 3]]);
                    bulges[e] = [0, 1].map(|c| middles[e][c] - (a[c] + b[c]) / 2.0);
                }
            }
            bulges
        });
        Ok(Field { vertices: ends.to_vec(), bulges })
    }

    /// The values at the vertices, and at the middles of the edges if it is quadratic.
    pub fn nodal(&self, mesh: &Mesh) -> Vec<[f64; 2]> {
        let mut nodal = self.vertices.clone();
        if let Some(bulges) = &self.bulges {
            nodal.resize(nodal.len() + bulges.len(), [0.0; 2]);
            for (corners, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
                for (local, &e) in edges.iter().enumerate() {
                    let [a, b] = [1, 2].map(|k| self.vertices[corners[(local + k) % 3]]);
                    let middle = [0, 1].map(|c| (a[c] + b[c]) / 2.0 + bulges[e][c]);
                    nodal[self.vertices.len() + e] = middle;
                }
            }
        }
        nodal
    }

    /// C eps of it on triangle `t`.
    pub fn stress(&self, parts: &ProblemParts, t: usize, triangle: &Triangle<f64>) -> Affine<f64> {
        let mesh = parts.mesh;
        let nodal = mesh.triangles()[t].map(|vertex| self.vertices[vertex].into());
        let bulges = self.bulges.as_ref();
        let bulges = bulges.map(|all| mesh.triangle_edges()[t].map(|e| all[e].into()));
        Affine::of_displacement(triangle, &nodal, bulges.as_ref(), parts.material(t))
    }
}
