//! Small random bodies with exact data: a grid of cells cut into triangles, nodes moved, turned by a rational rotation;
//! contact at the bottom, sometimes on the left side too (so that one triangle owns two contact edges). Lengths of
//! contact edges, normals and h_T are rational, so that nothing is rounded.
//!
//! On such a body the quantities of method (8) are those of their definitions ([`Definition`], by `naive`). h_T enters as given
//! data, for it is a square root: any positive number serves.

use std::collections::BTreeMap;

use proptest::prelude::*;
use signorini::kernel::{Material, Plane, Scalar, Triangle};

use crate::draws::{positive, ratio};
use crate::naive::{Field, Hooke};
use crate::numbers::Exact;

mod definition;

pub use definition::{Definition, Traces, contact_class, whole};

/// The plain data of a body, as drawn.
#[derive(Clone, Debug)]
pub struct Draw {
    cells: [usize; 2],
    diagonals: Vec<bool>,
    moves: Vec<[i8; 2]>,
    turn: usize,
    left_too: bool,
    lambda: (i64, i64),
    mu: (i64, i64),
    stress: bool,
    /// The rows of a triangular matrix L with positive diagonal: A is L L^T in place of lambda and mu.
    tensor: Option<[(i64, i64); 6]>,
    gamma0: (i64, i64),
    diameters: Vec<(i64, i64)>,
    values: Vec<[(i64, i64); 2]>,
    gaps: Vec<[(i64, i64); 3]>,
}

/// More values than any field on these bodies has nodes.
const MOST_NODES: usize = 24;

/// Bodies of one to four cells, with values for `fields` fields.
pub fn bodies(fields: usize) -> impl Strategy<Value = Draw> {
    let shape = (
        prop_oneof![Just([1, 1]), Just([2, 1]), Just([1, 2])],
        prop::collection::vec(any::<bool>(), 4),
        prop::collection::vec([-4_i8..=4, -4_i8..=4], 9),
        0..TURNS.len(),
        any::<bool>(),
    );
    let tensor = (positive(), ratio(), positive(), ratio(), ratio(), positive());
    let tensor = prop::option::of(tensor.prop_map(|(a, b, c, d, e, f)| [a, b, c, d, e, f]));
    let numbers = (ratio(), positive(), any::<bool>(), positive(), tensor);
    let more = (
        prop::collection::vec(positive(), 8),
        prop::collection::vec([ratio(), ratio()], fields * MOST_NODES),
        prop::collection::vec([ratio(), ratio(), ratio()], 4),
    );
    (shape, numbers, more).prop_map(|(shape, numbers, more)| Draw {
        cells: shape.0,
        diagonals: shape.1,
        moves: shape.2,
        turn: shape.3,
        left_too: shape.4,
        lambda: numbers.0,
        mu: numbers.1,
        stress: numbers.2,
        tensor: numbers.4,
        gamma0: numbers.3,
        diameters: more.0,
        values: more.1,
        gaps: more.2,
    })
}

/// Cosine and sine, in 1/65.
const TURNS: [[i64; 2]; 5] = [[65, 0], [39, 52], [-52, 39], [25, -60], [0, 65]];

/// A contact edge.
#[derive(Clone, Copy, Debug)]
pub struct Side<S = Exact> {
    /// Who owns it.
    pub triangle: usize,
    /// Which edge of the triangle.
    pub local: usize,
    /// |E|
    pub length: S,
    /// The unit outward normal.
    pub n: [S; 2],
    /// The gap at start, end and middle.
    pub gap: [S; 3],
}

/// A body with exact data.
pub struct Body<S = Exact> {
    /// The corners of the triangles.
    pub vertices: Vec<[S; 2]>,
    /// The places of the vertices before the body was turned.
    pub unturned: Vec<[S; 2]>,
    /// Counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
    /// Gamma_C
    pub contact: Vec<Side<S>>,
    /// Boundary edges that are neither contact nor at the top: triangle and local number.
    pub free: Vec<(usize, usize)>,
    /// The vertices at the top.
    pub top: Vec<usize>,
    /// h_T, as data.
    pub diameters: Vec<S>,
    /// For the kernel.
    pub material: Material<S>,
    /// For the transcription.
    pub hooke: Hooke<S>,
    /// gamma0
    pub gamma0: S,
    /// cos and sin of the turn.
    pub turn: [S; 2],
    /// The nodes in the middles of the edges, by the vertices of these, the smaller one first.
    pub middles: BTreeMap<[usize; 2], usize>,
    /// The values of the drawn fields.
    pub values: Vec<[S; 2]>,
}

impl Draw {
    /// The body with these data; its material is one: A is elliptic, or mu > 0 and 3 lambda + 2 mu > 0.
    pub fn body(&self) -> Body {
        let [nx, ny] = self.cells;
        let unturned: Vec<[Exact; 2]> = (0..=ny)
            .flat_map(|j| (0..=nx).map(move |i| (i, j)))
            .map(|(i, j)| self.node(i, j))
            .collect();
        let turn = TURNS[self.turn].map(|c| Exact::ratio(c, 65));
        let vertices = unturned.iter().map(|&p| rotated(p, turn)).collect();
        let mut triangles = Vec::new();
        for j in 0..ny {
            for i in 0..nx {
                let a = j * (nx + 1) + i;
                let (b, d, c) = (a + 1, a + nx + 1, a + nx + 2);
                match self.diagonals[j * nx + i] {
                    true => triangles.extend([[a, b, c], [a, c, d]]),
                    false => triangles.extend([[a, b, d], [b, c, d]]),
                }
            }
        }
        let tensor = self.tensor.map(|rows| square(rows.map(Exact::from)));
        let (material, hooke) = law([self.lambda(), Exact::from(self.mu)], self.stress, tensor);
        let count = triangles.len();
        let mut body = Body {
            top: (0..=nx).map(|i| ny * (nx + 1) + i).collect(),
            vertices,
            unturned,
            triangles,
            contact: Vec::new(),
            free: Vec::new(),
            diameters: self.diameters[..count].iter().copied().map(Exact::from).collect(),
            material,
            hooke,
            gamma0: Exact::from(self.gamma0),
            turn,
            middles: BTreeMap::new(),
            values: self.values.iter().map(|v| v.map(Exact::from)).collect(),
        };
        body.sort_edges(self.left_too, &self.gaps);
        body
    }

    /// The same data without a turn, in contact at the bottom only.
    pub fn upright(&self) -> Draw {
        Draw { turn: 0, left_too: false, ..self.clone() }
    }

    /// The same data with lambda and mu.
    pub fn isotropic(&self) -> Draw {
        Draw { tensor: None, ..self.clone() }
    }

    /// lambda and mu as they act in the plane.
    pub fn lame(&self) -> [Exact; 2] {
        match self.isotropic().body().hooke {
            Hooke::Isotropic { lambda, mu } => [lambda, mu],
            Hooke::Tensor(_) => unreachable!("it is isotropic"),
        }
    }

    /// lambda, lifted where 3 lambda + 2 mu would not be positive.
    fn lambda(&self) -> Exact {
        let (lambda, mu) = (Exact::from(self.lambda), Exact::from(self.mu));
        let floor = -(mu / Exact::from(2));
        if lambda > floor { lambda } else { floor }
    }

    fn node(&self, i: usize, j: usize) -> [Exact; 2] {
        let [dx, dy] = self.moves[j * 3 + i].map(|m| Exact::ratio(i64::from(m), 20));
        let (x, y) = (Exact::from(i as i32), Exact::from(j as i32));
        // Contact sides stay straight.
        [if i == 0 && self.left_too { x } else { x + dx }, if j == 0 { y } else { y + dy }]
    }
}

/// A law for the kernel and for the transcription: this tensor, or lambda and mu in plane stress or strain.
pub fn law<S: Scalar>(
    [lambda, mu]: [S; 2],
    stress: bool,
    tensor: Option<[S; 6]>,
) -> (Material<S>, Hooke<S>) {
    let two = S::from(2);
    match (tensor, stress) {
        (Some(c), _) => (Material::tensor(c, None), Hooke::Tensor(c)),
        (None, false) => {
            (Material::lame(lambda, mu, Plane::Strain), Hooke::Isotropic { lambda, mu })
        }
        (None, true) => {
            let star = two * lambda * mu / (lambda + two * mu);
            (Material::lame(lambda, mu, Plane::Stress), Hooke::Isotropic { lambda: star, mu })
        }
    }
}

/// L L^T as C11, C12, C16, C22, C26, C66, from the rows of L: a symmetric matrix without negative eigenvalues, and every
/// one of these is of this form.
pub fn square<S: Scalar>([a, b, c, d, e, f]: [S; 6]) -> [S; 6] {
    [a * a, a * b, a * d, b * b + c * c, b * d + c * e, d * d + e * e + f * f]
}

/// The point turned about the origin.
pub fn rotated([x, y]: [Exact; 2], [c, s]: [Exact; 2]) -> [Exact; 2] {
    [c * x - s * y, s * x + c * y]
}

impl Body {
    /// Finds contact edges and free edges, and numbers the middles.
    fn sort_edges(&mut self, left_too: bool, gaps: &[[(i64, i64); 3]]) {
        let mut owners: BTreeMap<[usize; 2], Vec<(usize, usize)>> = BTreeMap::new();
        for t in 0..self.triangles.len() {
            for i in 0..3 {
                let [a, b] = self.ends(t, i);
                owners.entry([a.min(b), a.max(b)]).or_default().push((t, i));
            }
        }
        for ([a, b], owners) in owners {
            let next = self.vertices.len() + self.middles.len();
            self.middles.insert([a, b], next);
            let [(triangle, local)] = owners[..] else { continue };
            let (p, q) = (self.unturned[a], self.unturned[b]);
            let (zero, outwards) = (Exact::from(0), Exact::from(-1));
            let bottom = p[1] == zero && q[1] == zero;
            if bottom || left_too && p[0] == zero && q[0] == zero {
                let along = if bottom { 0 } else { 1 };
                let length = (q[along] - p[along]).abs();
                let n = if bottom { [zero, outwards] } else { [outwards, zero] };
                let n = rotated(n, self.turn);
                let gap = gaps[self.contact.len()].map(Exact::from);
                self.contact.push(Side { triangle, local, length, n, gap });
            } else if !(self.top.contains(&a) && self.top.contains(&b)) {
                self.free.push((triangle, local));
            }
        }
    }

    /// The drawn field with this number.
    pub fn drawn(&self, field: usize) -> Vec<[Exact; 2]> {
        self.values[field * MOST_NODES..(field + 1) * MOST_NODES].to_vec()
    }

    /// The field with the values of `f` at its nodes.
    pub fn interpolated(&self, f: impl Fn([Exact; 2]) -> [Exact; 2]) -> Vec<[Exact; 2]> {
        let mut values: Vec<[Exact; 2]> = self.vertices.iter().map(|&x| f(x)).collect();
        values.resize(self.node_count(2), [Exact::from(0); 2]);
        for (&[a, b], &node) in &self.middles {
            let half = |c: usize| (self.vertices[a][c] + self.vertices[b][c]) / Exact::from(2);
            values[node] = f([half(0), half(1)]);
        }
        values
    }

    /// The basis of V^h: every v^h that is zero at the top is a sum of these.
    pub fn basis<const N: usize>(&self) -> Vec<Vec<[Exact; 2]>> {
        let zero = Exact::from(0);
        let directions = [[Exact::from(1), zero], [zero, Exact::from(1)]];
        let nodes = 0..self.node_count(N / 3);
        let all = nodes.flat_map(|node| directions.map(|d| self.clamped(self.bump(node, d))));
        all.filter(|v| v.iter().flatten().any(|&c| c != zero)).collect()
    }

    /// The field with zeros at the top: on Gamma_D.
    pub fn clamped(&self, mut field: Vec<[Exact; 2]>) -> Vec<[Exact; 2]> {
        for &v in &self.top {
            field[v] = [Exact::from(0); 2];
        }
        for (&[a, b], &node) in &self.middles {
            if self.top.contains(&a) && self.top.contains(&b) {
                field[node] = [Exact::from(0); 2];
            }
        }
        field
    }
}

impl<S: Scalar> Body<S> {
    /// The nodes of a triangle for degree 1 (N = 3) or 2 (N = 6).
    pub fn nodes<const N: usize>(&self, t: usize) -> [usize; N] {
        let mut nodes = [0; N];
        nodes[..3].copy_from_slice(&self.triangles[t]);
        for i in 3..N {
            let [a, b] = self.ends(t, i % 3);
            nodes[i] = self.middles[&[a.min(b), a.max(b)]];
        }
        nodes
    }

    /// The vertices of edge i of a triangle, from start to end.
    pub fn ends(&self, t: usize, i: usize) -> [usize; 2] {
        [1, 2].map(|k| self.triangles[t][(i + k) % 3])
    }

    /// How many nodes there are.
    pub fn node_count(&self, degree: usize) -> usize {
        self.vertices.len() + if degree == 2 { self.middles.len() } else { 0 }
    }

    /// The field that is `value` at one node and zero at the others.
    pub fn bump(&self, node: usize, value: [S; 2]) -> Vec<[S; 2]> {
        let mut field = vec![[S::from(0); 2]; self.node_count(2)];
        field[node] = value;
        field
    }

    /// A triangle's share of a field.
    pub fn local<const N: usize>(&self, t: usize, field: &[[S; 2]]) -> [[S; 2]; N] {
        self.nodes::<N>(t).map(|node| field[node])
    }

    /// The triangle with its coordinates.
    pub fn triangle(&self, t: usize) -> Triangle<S> {
        Triangle { vertices: self.triangles[t].map(|v| self.vertices[v].into()) }
    }

    /// gamma on a side: (7).
    pub fn gamma(&self, side: &Side<S>) -> S {
        self.gamma0 * self.diameters[side.triangle]
    }

    /// The field on triangle t, for the transcription.
    pub fn field<const N: usize>(&self, t: usize, field: &[[S; 2]]) -> Field<S> {
        let vertices = self.triangles[t].map(|v| self.vertices[v]);
        Field { vertices, nodal: self.local::<N>(t, field).to_vec() }
    }
}

/// The sum of f over a list.
pub fn sum<T, S: Scalar>(items: impl IntoIterator<Item = T>, f: impl Fn(T) -> S) -> S {
    items.into_iter().fold(S::from(0), |sum, item| sum + f(item))
}

/// How the contact terms are integrated.
#[derive(Clone, Copy, Debug)]
pub enum Rule<'a, S = Exact> {
    /// Without quadrature error.
    Exact,
    /// By points in \[0, 1\] with weights.
    Points(&'a [[S; 2]]),
}

/// alpha u + beta v
pub fn combined(alpha: Exact, u: &[[Exact; 2]], beta: Exact, v: &[[Exact; 2]]) -> Vec<[Exact; 2]> {
    u.iter().zip(v).map(|(u, v)| [0, 1].map(|c| alpha * u[c] + beta * v[c])).collect()
}

#[cfg(test)]
mod tests {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    use signorini::nalgebra::Vector2;

    use super::*;

    #[test]
    fn drawn_bodies_are_bodies() {
        let mut runner = TestRunner::deterministic();
        let mut two_edges = 0;
        for _ in 0..100 {
            let draw = bodies(1).new_tree(&mut runner).unwrap().current();
            Exact::scope(|| {
                let body = draw.body();
                let zero = Exact::from(0);
                let (lambda, mu) = (draw.lambda(), Exact::from(draw.mu));
                assert!(mu > zero && Exact::from(3) * lambda + Exact::from(2) * mu > zero);
                for t in 0..body.triangles.len() {
                    assert!(body.triangle(t).double_area() > zero);
                    let owned = body.contact.iter().filter(|side| side.triangle == t).count();
                    two_edges += usize::from(owned == 2);
                }
                for side in &body.contact {
                    let scaled = body.triangle(side.triangle).scaled_normal(side.local);
                    assert_eq!(scaled, Vector2::from(side.n) * side.length);
                }
                assert!(body.node_count(2) <= MOST_NODES);
            });
        }
        assert!(two_edges > 5, "{two_edges}");
    }
}
