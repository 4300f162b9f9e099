//! Method (8) as the solver has it on a mesh, over rationals: places of the vertices, Lamé coefficients, gamma, |E|, n, g,
//! the loads and the points of a rule are the solver's doubles, taken for the rational numbers that they are. The solver's own
//! loops ([`residual`]) compute with them: forces, stresses and P are its code, and exact.

use signorini::contact::{Discretization, EdgeRule, Piece, residual};
use signorini::kernel::edge_integral::{self, ExactEdge};
use signorini::kernel::{EdgeIntegrals, P1, P2};
use signorini::model::Degree;

use crate::elimination::{Matrix, dot};
use crate::numbers::Exact;

/// The class of fields for which P has both signs on an edge.
pub const CUT: &str = "an edge is cut";

/// A vector per node.
pub type Nodal = Vec<[Exact; 2]>;

/// A field in doubles, exactly.
pub fn exactly(field: &[[f64; 2]]) -> Nodal {
    field.iter().map(|v| v.map(Exact::of_double)).collect()
}

/// The discrete problem.
pub struct Discrete<'a> {
    /// Of the solver.
    pub d: &'a Discretization<'a>,
    /// The number of each free component.
    numbers: Vec<[Option<usize>; 2]>,
    count: usize,
    /// Its contact edges.
    pub edges: Vec<Piece<Exact>>,
    /// Points and weights; none for exact integration.
    pub rule: Option<Vec<[Exact; 2]>>,
}

impl<'a> Discrete<'a> {
    /// The solver's discrete problem.
    pub fn new(d: &'a Discretization<'a>) -> Self {
        Discrete::on(d, d.contact.iter().map(|edge| residual::exact_piece(d, edge)).collect())
    }

    /// The same with these contact edges.
    pub fn on(d: &'a Discretization<'a>, edges: Vec<Piece<Exact>>) -> Self {
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
            edges,
            rule: match &d.rule {
                EdgeRule::Exact => None,
                EdgeRule::Gauss(points) => {
                    Some(points.iter().map(|&(s, w)| [s, w].map(Exact::of_double)).collect())
                }
            },
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

    /// The matrix over the free components with these images of the basis functions.
    fn columns(&self, image: impl Fn(&[[Exact; 2]]) -> Nodal) -> Matrix {
        let mut matrix = vec![vec![Exact::from(0); self.count]; self.count];
        let mut bump = vec![[Exact::from(0); 2]; self.numbers.len()];
        for (node, numbers) in self.numbers.iter().enumerate() {
            for c in 0..2 {
                let Some(column) = numbers[c] else { continue };
                bump[node][c] = Exact::from(1);
                for (row, value) in self.free(&image(&bump)).into_iter().enumerate() {
                    matrix[row][column] = value;
                }
                bump[node][c] = Exact::from(0);
            }
        }
        matrix
    }

    fn nowhere(&self) -> Nodal {
        vec![[Exact::from(0); 2]; self.numbers.len()]
    }

    /// a(u, v) for every basis function v.
    pub fn internal_forces(&self, u: &[[Exact; 2]]) -> Nodal {
        let mut forces = self.nowhere();
        residual::add_internal_forces(&self.d.space, &self.d.problem.material, u, &mut forces);
        forces
    }

    /// K, the matrix of a(.,.).
    pub fn stiffness(&self) -> Matrix {
        self.columns(|u| self.internal_forces(u))
    }

    /// The matrix of int gamma sigma_n(u) sigma_n(v): A is K less this one.
    pub fn stresses(&self) -> Matrix {
        self.columns(|u| {
            let mut forces = self.nowhere();
            self.edges.iter().for_each(|edge| edge.add_stresses(u, &mut forces));
            forces.into_iter().map(|f| f.map(|f| -f)).collect()
        })
    }

    /// P(u) at the nodes of edge e.
    pub fn p(&self, e: usize, u: &[[Exact; 2]]) -> Vec<Exact> {
        self.edges[e].p(u)
    }

    /// int \[P\]+ N_a and int_{P > 0} N_a N_b. Where there is no rule and P is quadratic they are no rational numbers.
    pub fn integrals(&self, p: &[Exact]) -> (Vec<Exact>, Matrix) {
        let points = self.rule.iter().flatten().map(|&[s, weight]| (s, weight));
        match self.d.space.degree() {
            Degree::One if self.rule.is_none() => lists(P1::exact([p[0], p[1]])),
            Degree::One => {
                lists(edge_integral::gauss::<P1, Exact, 3, 2>([p[0], p[1]], None, points))
            }
            Degree::Two => {
                assert!(self.rule.is_some(), "the roots of a quadratic P are no rational numbers");
                lists(edge_integral::gauss::<P2, Exact, 6, 3>([p[0], p[1], p[2]], None, points))
            }
        }
    }

    /// The residual of (8) at u over the free components.
    pub fn residual(&self, u: &[[Exact; 2]]) -> Vec<Exact> {
        self.free(&self.reactions(u))
    }

    /// The residual of (8) at u for every basis function: at the prescribed components the reactions.
    pub fn reactions(&self, u: &[[Exact; 2]]) -> Nodal {
        let mut residual = residual::linear_residual(self.d, &self.edges, u);
        for (e, edge) in self.edges.iter().enumerate() {
            let gradient = self.integrals(&self.p(e, u)).0.into_iter();
            let forces: Vec<Exact> = gradient.map(|g| edge.weight() * g).collect();
            edge.add_contact(&forces, &mut residual);
        }
        residual
    }

    /// The derivative of the residual at u that Newton's method uses.
    pub fn tangent(&self, u: &[[Exact; 2]]) -> Matrix {
        let edges = self.edges.iter().enumerate();
        let hessians: Vec<_> =
            edges.map(|(e, edge)| (edge, self.integrals(&self.p(e, u)).1)).collect();
        self.columns(|v| {
            let mut forces = self.internal_forces(v);
            for (edge, hessian) in &hessians {
                edge.add_stresses(v, &mut forces);
                let p0 = edge.p0(v);
                let slopes = hessian.iter().map(|row| edge.weight() * dot(row, &p0));
                edge.add_contact(&slopes.collect::<Vec<_>>(), &mut forces);
            }
            forces
        })
    }

    /// How the contact looks at u.
    pub fn class(&self, u: &[[Exact; 2]]) -> &'static str {
        let zero = Exact::from(0);
        let values: Vec<Vec<Exact>> = (0..self.edges.len()).map(|e| self.p(e, u)).collect();
        let pressed = values.iter().flatten().filter(|p| **p > zero).count();
        match (values.iter().any(|p| cut(p)), pressed) {
            (true, _) => CUT,
            (_, 0) => "open",
            (_, all) if all == values.iter().flatten().count() => "pressed",
            _ => "open and pressed edges",
        }
    }
}

fn lists<const M: usize>(of: EdgeIntegrals<Exact, M>) -> (Vec<Exact>, Matrix) {
    (of.gradient.into(), of.hessian.iter().map(|row| row.to_vec()).collect())
}

/// P has both signs among these values.
pub fn cut(p: &[Exact]) -> bool {
    let zero = Exact::from(0);
    p.iter().any(|&p| p > zero) && p.iter().any(|&p| p < zero)
}
