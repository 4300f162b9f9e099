//! Method (8) as the solver has it on a mesh, over rationals: places of the vertices, Lamé coefficients, gamma, |E|, n, g,
//! the loads and the points of a rule are the solver's doubles, taken for the rational numbers that they are. Everything
//! computed from them is exact: stiffness and stress matrices, residual and tangent of (8), by the kernel's functions.

use signorini::fem::Discretization;
use signorini::fem::contact_line::{ContactLineEdge, EdgeRule};
use signorini::kernel::contact_edge::coercivity_constant;
use signorini::kernel::edge_integral::{self, ExactEdge};
use signorini::kernel::element::stiffness;
use signorini::kernel::{ContactEdge, EdgeIntegrals, Material, Plane, Triangle};
use signorini::nalgebra::{Matrix2, Vector2};

use crate::bodies::{MaybeExact, sum};
use crate::elimination::{Matrix, combined, dot};
use crate::numbers::Exact;

/// The class of fields for which P has both signs on an edge.
pub const CUT: &str = "an edge is cut";

/// A vector per node.
pub type Nodal = Vec<[Exact; 2]>;

/// A field in doubles, exactly.
pub fn exactly(field: &[[f64; 2]]) -> Nodal {
    field.iter().map(|v| v.map(Exact::of_double)).collect()
}

/// An edge of Gamma_C.
struct Edge<const N: usize, const M: usize> {
    triangle: usize,
    length: Exact,
    gamma: Exact,
    gap: [Exact; M],
    functionals: ContactEdge<Exact, N, M>,
}

/// The discrete problem.
pub struct Discrete<'a, E, const N: usize, const M: usize> {
    d: &'a Discretization<'a, E, N, M>,
    material: Material<Exact>,
    /// The number of each free component.
    numbers: Vec<[Option<usize>; 2]>,
    count: usize,
    stiffness: Vec<[[Matrix2<Exact>; N]; N]>,
    edges: Vec<Edge<N, M>>,
    /// Points and weights; none for exact integration.
    rule: Option<Vec<[Exact; 2]>>,
}

impl<'a, E, const N: usize, const M: usize> Discrete<'a, E, N, M>
where
    E: MaybeExact<N, M> + ExactEdge<f64, N, M>,
{
    /// The solver's discrete problem.
    pub fn new(d: &'a Discretization<'a, E, N, M>) -> Self {
        let exact = Exact::of_double;
        // The bodies of the claims have one material.
        let of = d.problem.material.of(0);
        // lambda is the coefficient that acts in the plane, also in plane stress.
        let material = Material::lame(exact(of.lambda()), exact(of.mu()), Plane::Strain);
        let triangle = |t| -> Triangle<Exact> {
            let vertices = d.space.mesh().triangle(t).vertices;
            Triangle { vertices: vertices.map(|x| x.map(exact)) }
        };
        let edge = |e: &ContactLineEdge<N, M>| {
            let (gamma, n) = (exact(e.gamma), e.normal.map(exact));
            let (t, local) = (e.edge.triangle, e.edge.local);
            Edge {
                triangle: t,
                length: exact(e.length),
                gamma,
                gap: e.gap.map(exact),
                functionals: ContactEdge::new::<E>(&triangle(t), local, n, &material, gamma),
            }
        };
        let mut count = 0;
        let mut number = |prescribed: &Option<f64>| {
            prescribed.is_none().then(|| {
                count += 1;
                count - 1
            })
        };
        let prescribed = d.constraints.values().iter();
        let numbers = prescribed.map(|[x, y]| [number(x), number(y)]).collect();
        Discrete {
            numbers,
            count,
            stiffness: (0..d.space.elements().len())
                .map(|t| stiffness::<E, Exact, N, M>(&triangle(t), &material))
                .collect(),
            edges: d.contact.iter().map(edge).collect(),
            rule: match &d.rule {
                EdgeRule::Exact => None,
                EdgeRule::Gauss(points) => {
                    Some(points.iter().map(|&(s, w)| [exact(s), exact(w)]).collect())
                }
            },
            material,
            d,
        }
    }

    /// The free components of a field.
    pub fn free(&self, field: &[[Exact; 2]]) -> Vec<Exact> {
        let pairs = self.numbers.iter().flatten().zip(field.iter().flatten());
        pairs.filter(|(number, _)| number.is_some()).map(|(_, &value)| value).collect()
    }

    /// The prescribed components of each node.
    pub fn prescribed(&self) -> &[[Option<f64>; 2]] {
        self.d.constraints.values()
    }

    /// Gives the prescribed components of a field their values.
    pub fn prescribe(&self, field: &mut [[Exact; 2]]) {
        for (values, prescribed) in field.iter_mut().zip(self.prescribed()) {
            for c in 0..2 {
                values[c] = prescribed[c].map_or(values[c], Exact::of_double);
            }
        }
    }

    /// The field with a vector over the free components subtracted.
    pub fn less(&self, field: &[[Exact; 2]], step: &[Exact]) -> Nodal {
        let component = |(number, &value): (&Option<usize>, &Exact)| match number {
            Some(number) => value - step[*number],
            None => value,
        };
        let node = |(numbers, values): (&[Option<usize>; 2], &[Exact; 2])| {
            [0, 1].map(|c| component((&numbers[c], &values[c])))
        };
        self.numbers.iter().zip(field).map(node).collect()
    }

    /// Adds the blocks of triangle t into a matrix over the free components.
    fn add(&self, matrix: &mut Matrix, t: usize, block: impl Fn(usize, usize) -> Matrix2<Exact>) {
        let nodes = self.d.space.elements()[t];
        for i in 0..N {
            for j in 0..N {
                let block = block(i, j);
                for c in 0..2 {
                    for d in 0..2 {
                        let [row, column] = [self.numbers[nodes[i]][c], self.numbers[nodes[j]][d]];
                        if let (Some(row), Some(column)) = (row, column) {
                            matrix[row][column] += block[(c, d)];
                        }
                    }
                }
            }
        }
    }

    fn zero(&self) -> Matrix {
        vec![vec![Exact::from(0); self.count]; self.count]
    }

    /// K, the matrix of a(.,.).
    pub fn stiffness(&self) -> Matrix {
        let mut matrix = self.zero();
        for (t, k) in self.stiffness.iter().enumerate() {
            self.add(&mut matrix, t, |i, j| k[i][j]);
        }
        matrix
    }

    /// The matrix of int gamma sigma_n(u) sigma_n(v): A is K less this one.
    pub fn stresses(&self) -> Matrix {
        let mut matrix = self.zero();
        for edge in &self.edges {
            let weight = edge.gamma * edge.length;
            let block = |i, j| edge.functionals.stress_product(weight, i, j);
            self.add(&mut matrix, edge.triangle, block);
        }
        matrix
    }

    /// The nodal values on triangle t.
    fn local(&self, t: usize, u: &[[Exact; 2]]) -> [Vector2<Exact>; N] {
        self.d.space.elements()[t].map(|node| u[node].into())
    }

    /// P(u) at the nodes of edge e.
    pub fn p(&self, e: usize, u: &[[Exact; 2]]) -> [Exact; M] {
        let edge = &self.edges[e];
        let u = self.local(edge.triangle, u);
        let mut p = edge.functionals.p0.map(|row| sum(row.iter().zip(&u), |(f, u)| f.dot(u)));
        for (p, &gap) in p.iter_mut().zip(&edge.gap) {
            *p -= gap;
        }
        p
    }

    fn integrals(&self, p: [Exact; M]) -> EdgeIntegrals<Exact, M> {
        match &self.rule {
            None => E::without_error(p),
            Some(points) => {
                let points = points.iter().map(|&[s, weight]| (s, weight));
                edge_integral::gauss::<E, Exact, N, M>(p, points)
            }
        }
    }

    /// The residual of (8) at u over the free components.
    pub fn residual(&self, u: &[[Exact; 2]]) -> Vec<Exact> {
        self.free(&self.reactions(u))
    }

    /// a(u, u)
    pub fn energy(&self, u: &[[Exact; 2]]) -> Exact {
        let mut energy = Exact::from(0);
        for (t, k) in self.stiffness.iter().enumerate() {
            let u = self.local(t, u);
            for i in 0..N {
                for j in 0..N {
                    energy += u[i].dot(&(k[i][j] * u[j]));
                }
            }
        }
        energy
    }

    /// int \[P(u)\]+/gamma: the force of contact.
    pub fn contact_force(&self, u: &[[Exact; 2]]) -> Exact {
        self.edges.iter().enumerate().fold(Exact::from(0), |force, (e, edge)| {
            let gradient = self.integrals(self.p(e, u)).gradient;
            force + edge.length / edge.gamma * sum(gradient, |g| g)
        })
    }

    /// The residual of (8) at u for every basis function: at the prescribed components the reactions.
    pub fn reactions(&self, u: &[[Exact; 2]]) -> Nodal {
        let load = |l: &[f64; 2]| l.map(|l| -Exact::of_double(l));
        let mut residual: Nodal = self.d.load.iter().map(load).collect();
        let mut add = |t: usize, i: usize, c: usize, value: Exact| {
            let node = self.d.space.elements()[t][i];
            residual[node][c] += value;
        };
        for (t, k) in self.stiffness.iter().enumerate() {
            let u = self.local(t, u);
            for i in 0..N {
                for j in 0..N {
                    let force = k[i][j] * u[j];
                    for c in 0..2 {
                        add(t, i, c, force[c]);
                    }
                }
            }
        }
        for (e, edge) in self.edges.iter().enumerate() {
            let t = edge.triangle;
            let nodal = self.local(t, u);
            let gradient = self.integrals(self.p(e, u)).gradient;
            for i in 0..N {
                for j in 0..N {
                    let stress = edge.functionals.stress_product(edge.gamma * edge.length, i, j);
                    let force = stress * nodal[j];
                    for c in 0..2 {
                        add(t, i, c, -force[c]);
                    }
                }
                for c in 0..2 {
                    let p0 = edge.functionals.p0.map(|row| row[i][c]);
                    add(t, i, c, edge.length / edge.gamma * dot(&gradient, &p0));
                }
            }
        }
        residual
    }

    /// The derivative of the residual at u that Newton's method uses.
    pub fn tangent(&self, u: &[[Exact; 2]]) -> Matrix {
        let stresses = self.stresses();
        let one = Exact::from(1);
        let mut matrix = combined(one, &self.stiffness(), -one, &stresses);
        for (e, edge) in self.edges.iter().enumerate() {
            let hessian = self.integrals(self.p(e, u)).hessian;
            let p0 = &edge.functionals.p0;
            self.add(&mut matrix, edge.triangle, |i, j| {
                Matrix2::from_fn(|c, d| {
                    let left = p0.map(|row| row[i][c]);
                    let right = p0.map(|row| row[j][d]);
                    let times = hessian.map(|row| dot(&row, &right));
                    edge.length / edge.gamma * dot(&left, &times)
                })
            });
        }
        matrix
    }

    /// int (1/gamma) (\[P(u)\]+ - \[P(v)\]+)^2, where that needs no root: by points, or with no edge cut at u and v.
    pub fn pressures_apart(&self, u: &[[Exact; 2]], v: &[[Exact; 2]]) -> Option<Exact> {
        let zero = Exact::from(0);
        let mut sum = zero;
        for (e, edge) in self.edges.iter().enumerate() {
            let (p, q) = (self.p(e, u), self.p(e, v));
            let part = |value: Exact| if value > zero { value } else { zero };
            let square = match &self.rule {
                Some(points) => points.iter().fold(zero, |sum, &[s, weight]| {
                    let [p, q] = [p, q].map(|p| edge_integral::value_at::<E, Exact, N, M>(p, s));
                    let d = part(p) - part(q);
                    sum + weight * d * d
                }),
                None if M == 2 && !cut(&p) && !cut(&q) => {
                    let [start, end] = [0, 1].map(|a| part(p[a]) - part(q[a]));
                    (start * start + start * end + end * end) / Exact::from(3)
                }
                None => return None,
            };
            sum += edge.length / edge.gamma * square;
        }
        Some(sum)
    }

    /// The contact terms are integrated without quadrature error, cut at the roots of P.
    pub fn by_pieces(&self) -> bool {
        self.rule.is_none()
    }

    /// How the contact looks at u.
    pub fn class(&self, u: &[[Exact; 2]]) -> &'static str {
        let zero = Exact::from(0);
        let values: Vec<[Exact; M]> = (0..self.edges.len()).map(|e| self.p(e, u)).collect();
        let pressed = values.iter().flatten().filter(|p| **p > zero).count();
        match (values.iter().any(|p| cut(p)), pressed) {
            (true, _) => CUT,
            (_, 0) => "open",
            (_, all) if all == M * values.len() => "pressed",
            _ => "open and pressed edges",
        }
    }

    /// kappa, for unit normals.
    pub fn kappa(&self) -> Exact {
        let mesh = self.d.space.mesh();
        self.edges.iter().fold(Exact::from(0), |kappa, edge| {
            let t = edge.triangle;
            let vertices = mesh.triangle(t).vertices.map(|x| x.map(Exact::of_double));
            let area = Triangle { vertices }.double_area() / Exact::from(2);
            let owned = self.edges.iter().filter(|other| other.triangle == t);
            let length = owned.fold(Exact::from(0), |sum, other| sum + other.length);
            let of_t =
                coercivity_constant::<E, Exact, N, M>(&self.material, edge.gamma, length, area);
            if of_t > kappa { of_t } else { kappa }
        })
    }
}

/// P has both signs among these values.
fn cut(p: &[Exact]) -> bool {
    let zero = Exact::from(0);
    p.iter().any(|&p| p > zero) && p.iter().any(|&p| p < zero)
}
