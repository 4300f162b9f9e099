//! Structured meshes of the rectangle (0, width) x (0, height), with the sides named left, right, bottom and top; of the
//! trapezoid (0,0), (1,0), (1,1), (cot omega, 1), whose angle at the origin is omega: the unit square in n x n cells, diagonals
//! right, under the map (s, t) -> (s + (1 - s) t cot omega, t); and families of both, refined and moved at random.
//!
//! ```text
//!     3 --- 4 --- 5      3 --- 4 --- 5      4 --- 5 --- 6
//!     |   / |   / |      | \   | \   |      | \ / | \ / |
//!     | /   | /   |      |   \ |   \ |      |  2  |  7  |   (numbers differ)
//!     0 --- 1 --- 2      0 --- 1 --- 2      | / \ | / \ |
//!         right              left               crossed
//! ```

use super::mesh::{Mesh, MeshError, bytes_to_make};
use crate::memory::{self, bytes_of};

/// The diagonals that cut the cells of a structured mesh into triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonal {
    /// From the upper left to the lower right.
    Left,
    /// From the lower left to the upper right.
    Right,
    /// Both, with a vertex in the middle of each cell.
    Crossed,
}

/// A rectangle cut into `nx` x `ny` equal cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// The extent along x.
    pub width: f64,
    /// The extent along y.
    pub height: f64,
    /// Cells along x.
    pub nx: usize,
    /// Cells along y.
    pub ny: usize,
    /// The diagonals that cut them.
    pub diagonal: Diagonal,
}

/// The most cells that a rectangle may have: beyond it the factorisation would not fit into the memory of one machine.
pub(crate) const MOST_CELLS: usize = 4_000_000;

impl Rectangle {
    /// The mesh of this rectangle.
    ///
    /// # Errors
    /// Sizes that are not positive and finite, no cells, or more than 4 million of them.
    pub fn mesh(&self) -> Result<Mesh, MeshError> {
        self.perturbed(0.0, 0)
    }

    /// The mesh with its vertices moved at random: by up to `amount` cells along each axis inside, along the sides on
    /// them, not at all in the corners. The same `seed` gives the same mesh.
    ///
    /// # Errors
    /// As [`Rectangle::mesh`]; moved too far, triangles turn over.
    pub fn perturbed(&self, amount: f64, seed: u64) -> Result<Mesh, MeshError> {
        self.mapped(amount, seed, |x| x)
    }

    fn moved_vertices(&self, amount: f64, seed: u64) -> Vec<[f64; 2]> {
        let cell = [self.width / self.nx as f64, self.height / self.ny as f64];
        let size = [self.width, self.height];
        let mut random = Random(seed);
        let mut vertices = self.vertices();
        for vertex in &mut vertices {
            for c in 0..2 {
                let shift = amount * cell[c] * random.next();
                if 0.0 < vertex[c] && vertex[c] < size[c] {
                    vertex[c] += shift;
                }
            }
        }
        vertices
    }

    /// The mesh with its vertices moved as in [`Rectangle::perturbed`] by `amount`, if any, and then by `map`.
    fn mapped(
        &self,
        amount: f64,
        seed: u64,
        map: impl Fn([f64; 2]) -> [f64; 2],
    ) -> Result<Mesh, MeshError> {
        self.check()?;
        let vertices = self.moved_vertices(amount, seed).into_iter().map(map).collect();
        Mesh::new(vertices, self.triangles(), self.sides())
    }

    fn check(&self) -> Result<(), MeshError> {
        self.check_numbers()?;
        let (cells, crossed) = (self.nx * self.ny, self.diagonal == Diagonal::Crossed);
        let middles = if crossed { cells } else { 0 };
        let vertices = (self.nx + 1) * (self.ny + 1) + middles;
        let triangles = if crossed { 4 * cells } else { 2 * cells };
        // The vertices are moved or mapped in a second list.
        let lists = bytes_of::<[[f64; 2]; 2]>(vertices) + bytes_of::<[usize; 3]>(triangles);
        Ok(memory::check(lists + bytes_to_make(vertices, triangles))?)
    }

    fn check_numbers(&self) -> Result<(), MeshError> {
        for (name, value) in [("width", self.width), ("height", self.height)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(MeshError::Size { name, value });
            }
        }
        for (name, value) in [("nx", self.nx), ("ny", self.ny)] {
            if value == 0 {
                return Err(MeshError::NoCells { name, value });
            }
        }
        match self.nx.checked_mul(self.ny) {
            Some(cells) if cells <= MOST_CELLS => Ok(()),
            _ => Err(MeshError::TooManyCells { nx: self.nx, ny: self.ny, most: MOST_CELLS }),
        }
    }

    /// Row by row from below; the middles of crossed cells follow.
    fn vertices(&self) -> Vec<[f64; 2]> {
        let x = |i: f64| self.width * (i / self.nx as f64);
        let y = |j: f64| self.height * (j / self.ny as f64);
        let mut vertices: Vec<[f64; 2]> = (0..=self.ny)
            .flat_map(|j| (0..=self.nx).map(move |i| [x(i as f64), y(j as f64)]))
            .collect();
        if self.diagonal == Diagonal::Crossed {
            vertices.extend(
                (0..self.ny).flat_map(|j| {
                    (0..self.nx).map(move |i| [x(i as f64 + 0.5), y(j as f64 + 0.5)])
                }),
            );
        }
        vertices
    }

    fn corner(&self, i: usize, j: usize) -> usize {
        j * (self.nx + 1) + i
    }

    fn triangles(&self) -> Vec<[usize; 3]> {
        let middles = (self.nx + 1) * (self.ny + 1);
        let mut triangles = Vec::with_capacity(4 * self.nx * self.ny);
        for j in 0..self.ny {
            for i in 0..self.nx {
                let [a, b] = [self.corner(i, j), self.corner(i + 1, j)];
                let [d, c] = [self.corner(i, j + 1), self.corner(i + 1, j + 1)];
                match self.diagonal {
                    Diagonal::Right => triangles.extend([[a, b, c], [a, c, d]]),
                    Diagonal::Left => triangles.extend([[a, b, d], [b, c, d]]),
                    Diagonal::Crossed => {
                        let m = middles + j * self.nx + i;
                        triangles.extend([[a, b, m], [b, c, m], [c, d, m], [d, a, m]]);
                    }
                }
            }
        }
        triangles
    }

    fn sides(&self) -> [(String, Vec<[usize; 2]>); 4] {
        let (nx, ny) = (self.nx, self.ny);
        let along = |j| (0..nx).map(|i| [self.corner(i, j), self.corner(i + 1, j)]).collect();
        let up = |i| (0..ny).map(|j| [self.corner(i, j), self.corner(i, j + 1)]).collect();
        [
            ("bottom".to_owned(), along(0)),
            ("left".to_owned(), up(0)),
            ("right".to_owned(), up(nx)),
            ("top".to_owned(), along(ny)),
        ]
    }
}

/// A trapezoid cut into `n` x `n` cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    /// The angle at the origin, between pi/2 and pi.
    pub omega: f64,
    /// Cells along each side.
    pub n: usize,
}

impl Trapezoid {
    /// The mesh.
    ///
    /// # Errors
    /// As [`Rectangle::mesh`]; for angles outside (0, pi) triangles turn over.
    pub fn mesh(&self) -> Result<Mesh, MeshError> {
        self.perturbed(0.0, 0)
    }

    /// The mesh with the vertices of the square moved as in [`Rectangle::perturbed`] before they are mapped.
    ///
    /// # Errors
    /// As [`Rectangle::perturbed`].
    pub(crate) fn perturbed(&self, amount: f64, seed: u64) -> Result<Mesh, MeshError> {
        let (nx, ny) = (self.n, self.n);
        let square = Rectangle { width: 1.0, height: 1.0, nx, ny, diagonal: Diagonal::Right };
        let tan = self.omega.tan();
        square.mapped(amount, seed, |[s, t]| [s + (1.0 - s) * t / tan, t])
    }
}

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
        let Perturbation { amount, seed } =
            perturbation.unwrap_or(Perturbation { amount: 0.0, seed: 0 });
        match self {
            Structured::Rectangle(r) => r.perturbed(amount, seed),
            Structured::Trapezoid(t) => t.perturbed(amount, seed),
        }
    }
}

/// Numbers in [-1, 1): the splitmix64 generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
