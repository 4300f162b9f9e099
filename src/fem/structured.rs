//! Families of meshes: a structured mesh, finer ones of the same body, and what they become when their vertices are moved
//! at random.

use super::mesh::{Mesh, MeshError};
use super::rectangle::Rectangle;
use super::trapezoid::Trapezoid;

/// A body that is meshed by cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Structured {
    /// A rectangle.
    Rectangle(Rectangle),
    /// A trapezoid.
    Trapezoid(Trapezoid),
}

/// The distance by which vertices are moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbation {
    /// At most that many cells along each axis.
    pub amount: f64,
    /// The seed of the random numbers: equal seeds give equal meshes.
    pub seed: u64,
}

impl Structured {
    /// Multiplies the number of cells along each axis by `factor`.
    pub fn refined(&self, factor: usize) -> Self {
        match *self {
            Structured::Rectangle(r) => Structured::Rectangle(Rectangle {
                nx: r.nx.saturating_mul(factor),
                ny: r.ny.saturating_mul(factor),
                ..r
            }),
            Structured::Trapezoid(t) => {
                Structured::Trapezoid(Trapezoid { n: t.n.saturating_mul(factor), ..t })
            }
        }
    }

    /// The mesh.
    ///
    /// # Errors
    /// As [`Rectangle::mesh`] and [`Rectangle::perturbed`].
    pub fn mesh(&self, perturbation: Option<Perturbation>) -> Result<Mesh, MeshError> {
        match (self, perturbation) {
            (Structured::Rectangle(r), None) => r.mesh(),
            (Structured::Rectangle(r), Some(p)) => r.perturbed(p.amount, p.seed),
            (Structured::Trapezoid(t), None) => t.mesh(),
            (Structured::Trapezoid(t), Some(p)) => t.perturbed(p.amount, p.seed),
        }
    }
}
