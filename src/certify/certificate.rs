//! What a certificate is made of: v, tau, and the problem that they belong to, as numbers and nothing else.

use nalgebra::Vector2;

use crate::kernel::composite::Affine;
use crate::kernel::{Enclosing, Material, Plane, Triangle};

/// v, tau and the problem that they belong to.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// The vertices of the mesh.
    pub vertices: Vec<[f64; 2]>,
    /// Further vertices, numbered after these: each lies on the straight line between two of them.
    pub cuts: Vec<Cut>,
    /// v at the vertices; if it is affine on the triangles of the mesh, at a cut it follows.
    pub displacement: Vec<[f64; 2]>,
    /// What makes v, u_D and g quadratic; `None` where they are affine.
    pub curved: Option<Curved>,
    /// u_D at the vertices of Gamma_D.
    pub prescribed: Vec<[Option<f64>; 2]>,
    /// The triangles.
    pub pieces: Vec<Piece>,
    /// Their edges.
    pub edges: Vec<Edge>,
}

/// v quadratic on the triangles, u_D and g quadratic along edges. A bulge is the value in the middle of an edge less the mean
/// of its ends: 4 s (1 - s) times it is what comes to the affine function.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curved {
    /// v at the cuts.
    pub at_cuts: Vec<[f64; 2]>,
    /// u_D at the cuts on Gamma_D.
    pub prescribed: Vec<[Option<f64>; 2]>,
    /// The bulge of v on each edge.
    pub bulges: Vec<[f64; 2]>,
    /// The bulges of the data on each edge: of u_D on Gamma_D in the components that are held, of g on Gamma_C as the first of two;
    /// all others are 0.
    pub data: Vec<[f64; 2]>,
}

/// The point (1 - at) x_a + at x_b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// a and b.
    pub ends: [usize; 2],
    /// In (0, 1).
    pub at: f64,
}

/// A triangle with what acts in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its vertices, counter-clockwise.
    pub vertices: [usize; 3],
    /// Its edges: edge i lies opposite vertex i.
    pub edges: [usize; 3],
    /// lambda (as it acts in the plane) and mu.
    pub material: [f64; 2],
    /// f at its vertices, affine between them.
    pub body: [[f64; 2]; 3],
    /// What the data of the problem differ from those above: to be added to |C eps(v) - tau|. Zero where nothing does.
    pub oscillation: f64,
}

/// An edge, from its start to its end; the triangle on its left has it in this direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Start and end.
    pub ends: [usize; 2],
    /// What it is, with the traction of tau on it.
    pub role: Role,
}

/// What an edge is. A force is tau N, N = |E| n, towards the right: per unit of the edge's parameter, at start and end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// Between two triangles.
    Inner([[f64; 2]; 2]),
    /// Gamma_D for the components that are held; on the others the force is zero.
    Held([bool; 2], [[f64; 2]; 2]),
    /// Gamma_N: the traction t that is given (a stress, not a force).
    Loaded([[f64; 2]; 2]),
    /// Gamma_N: the pressure p that is given, t = -p n.
    Pressed([f64; 2]),
    /// Gamma_C.
    Contact {
        /// tau_n at both ends.
        pressure: [f64; 2],
        /// g at both ends.
        gap: [f64; 2],
        /// The direction d of contact at both ends, affine between them; `None` is the edge's normal.
        along: Option<[[f64; 2]; 2]>,
    },
}

/// The vector with these components.
pub(super) fn exactly<S: Enclosing>(components: [f64; 2]) -> Vector2<S> {
    components.map(S::exactly).into()
}

impl Certificate {
    /// Values at the vertices, and at the cuts between them. Between equal numbers lies the same number: so the normal of an
    /// edge along an axis is known exactly.
    fn values<S: Enclosing>(&self, at: &[[f64; 2]]) -> Vec<Vector2<S>> {
        let mut all: Vec<Vector2<S>> = at.iter().map(|&x| exactly(x)).collect();
        for cut in &self.cuts {
            let ([a, b], s) = (cut.ends.map(|end| at[end]), S::exactly(cut.at));
            let between = [0, 1].map(|c| {
                let [a, b] = [a[c], b[c]];
                let mean = || S::exactly(a) * (S::from(1) - s) + S::exactly(b) * s;
                if a == b { S::exactly(a) } else { mean() }
            });
            all.push(between.into());
        }
        all
    }

    /// Vertices and cuts.
    pub(super) fn places<S: Enclosing>(&self) -> Vec<Vector2<S>> {
        self.values(&self.vertices)
    }

    /// v.
    pub(super) fn shape<S: Enclosing>(&self) -> Shape<S> {
        let Some(curved) = &self.curved else {
            return Shape { points: self.values(&self.displacement), bulges: None };
        };
        let all = |values: &[[f64; 2]]| values.iter().copied().map(exactly).collect::<Vec<_>>();
        let mut points = all(&self.displacement);
        points.extend(all(&curved.at_cuts));
        Shape { points, bulges: Some(all(&curved.bulges)) }
    }
}

/// A displacement on the triangles of a certificate.
#[derive(Clone)]
pub(super) struct Shape<S> {
    /// At vertices and cuts.
    pub points: Vec<Vector2<S>>,
    /// The bulge on each edge, if it is quadratic.
    pub bulges: Option<Vec<Vector2<S>>>,
}

impl<S: Enclosing> Shape<S> {
    pub(super) fn bulges_of(&self, piece: &Piece) -> Option<[Vector2<S>; 3]> {
        self.bulges.as_ref().map(|bulges| piece.edges.map(|e| bulges[e]))
    }

    /// C eps of it on a triangle.
    pub fn stress(&self, piece: &Piece, triangle: &Triangle<S>) -> Affine<S> {
        let nodal = piece.vertices.map(|vertex| self.points[vertex]);
        let bulges = self.bulges_of(piece);
        Affine::of_displacement(triangle, &nodal, bulges.as_ref(), &piece.material())
    }
}

/// A triangle at an edge, by the place of the edge in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Owner {
    /// The triangle.
    pub piece: usize,
    /// Which of its edges this is.
    pub local: usize,
}

impl Piece {
    /// f is not constant.
    pub(super) fn is_bent(&self) -> bool {
        self.body.iter().any(|&f| f != self.body[0])
    }

    /// The material. lambda is the one that acts in the plane, so plane strain is the formula to use.
    pub fn material<S: Enclosing>(&self) -> Material<S> {
        let [lambda, mu] = self.material;
        Material::lame(S::exactly(lambda), S::exactly(mu), Plane::Strain)
    }
}

/// Where point `p` of a certificate lies.
pub(super) fn place(certificate: &Certificate, p: usize) -> Vector2<f64> {
    at_point(&certificate.vertices, &certificate.cuts, p)
}

/// The value at point `p` of what has these values at the vertices and is affine between them.
pub(super) fn at_point(values: &[[f64; 2]], cuts: &[Cut], p: usize) -> Vector2<f64> {
    match values.get(p) {
        Some(&value) => value.into(),
        None => {
            let cut = cuts[p - values.len()];
            let [a, b] = cut.ends.map(|end| Vector2::from(values[end]));
            a + (b - a) * cut.at
        }
    }
}
