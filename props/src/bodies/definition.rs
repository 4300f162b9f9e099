//! Method (8) on a body by its definitions, as `naive` transcribes them.

use signorini::kernel::Scalar;

use super::{Body, Rule, Side, sum};
use crate::Ordered;
use crate::naive::{Field, Line};
use crate::numbers::Exact;

/// A bilinear form of fields given by their values at the nodes.
type Form<'f, S> = dyn Fn(&[[S; 2]], &[[S; 2]]) -> S + 'f;

/// Method (8) on a body by its definitions.
pub struct Definition<'a, const N: usize, S = Exact>(pub &'a Body<S>);

/// What the definitions need on one contact edge.
pub struct Traces<S = Exact> {
    /// v_n
    pub v_n: Line<S>,
    /// sigma_n(v)
    pub sigma_n: Line<S>,
    /// P0(v)
    pub p0: Line<S>,
    /// P(v)
    pub p: Line<S>,
}

impl<const N: usize, S: Ordered> Definition<'_, N, S> {
    /// a(u, v)
    pub fn a(&self, u: &[[S; 2]], v: &[[S; 2]]) -> S {
        let both = |&t: &usize| self.acts(t, u) && self.acts(t, v);
        sum((0..self.0.triangles.len()).filter(both), |t| self.a_on(t, u, v))
    }

    /// v is not zero on triangle t: where it is, it takes part in no integral.
    fn acts(&self, t: usize, v: &[[S; 2]]) -> bool {
        self.0.local::<N>(t, v).iter().flatten().any(|&v| v != S::from(0))
    }

    /// The contact edges where v is not zero.
    pub(crate) fn sides<'b>(&'b self, v: &'b [[S; 2]]) -> impl Iterator<Item = &'b Side<S>> {
        self.0.contact.iter().filter(|side| self.acts(side.triangle, v))
    }

    /// a_T(u, v)
    pub fn a_on(&self, t: usize, u: &[[S; 2]], v: &[[S; 2]]) -> S {
        self.0.field::<N>(t, u).energy(&self.0.field::<N>(t, v), &self.0.hooke)
    }

    /// On one triangle the matrices of a and of int gamma sigma_n(u) sigma_n(v), over the components of its nodes.
    pub fn matrices_on(&self, t: usize) -> [Vec<Vec<S>>; 2] {
        let body = self.0;
        let unit = |c| [0, 1].map(|d| S::from(i32::from(c == d)));
        let fields = body.nodes::<N>(t).map(|node| [0, 1].map(|c| body.bump(node, unit(c))));
        let fields = fields.as_flattened();
        let matrix = |f: &Form<S>| -> Vec<Vec<S>> {
            fields.iter().map(|u| fields.iter().map(|v| f(u, v)).collect()).collect()
        };
        let sides = || body.contact.iter().filter(|side| side.triangle == t);
        [
            matrix(&|u, v| self.a_on(t, u, v)),
            matrix(&|u, v| sum(sides(), |side| self.stresses_on(side, u, v))),
        ]
    }

    /// v_n, sigma_n(v), P0(v) and P(v) on a contact edge.
    pub fn traces(&self, side: &Side<S>, v: &[[S; 2]]) -> Traces<S> {
        let field = self.0.field::<N>(side.triangle, v);
        let v_n = field.normal_trace(side.local, side.n);
        let sigma_n = field.normal_stress(side.local, side.n, &self.0.hooke);
        let p0 = v_n.minus(&sigma_n.times(self.0.gamma(side)));
        let [start, end, middle] = side.gap;
        let gap = match N {
            3 => Line::affine(start, end),
            _ => Line::quadratic(start, middle, end),
        };
        let p = p0.minus(&gap);
        Traces { v_n, sigma_n, p0, p }
    }

    /// A(u, v)
    pub fn big_a(&self, u: &[[S; 2]], v: &[[S; 2]]) -> S {
        self.a(u, v) - self.stress_product(u, v)
    }

    /// int gamma sigma_n(u) sigma_n(v)
    pub fn stress_product(&self, u: &[[S; 2]], v: &[[S; 2]]) -> S {
        let both = self.sides(u).filter(|side| self.acts(side.triangle, v));
        sum(both, |side| self.stresses_on(side, u, v))
    }

    /// int gamma sigma_n(u) sigma_n(v) over one side.
    fn stresses_on(&self, side: &Side<S>, u: &[[S; 2]], v: &[[S; 2]]) -> S {
        let (u, v) = (self.traces(side, u).sigma_n, self.traces(side, v).sigma_n);
        self.0.gamma(side) * side.length * whole(&u.by(&v))
    }

    /// int over {P(u) > 0} of P0(v) P0(w) / gamma: what contact adds to the second derivative of J_h that Newton uses.
    pub fn slope(&self, rule: Rule<'_, S>, u: &[[S; 2]], v: &[[S; 2]], w: &[[S; 2]]) -> S {
        sum(&self.0.contact, |side| {
            let p = self.traces(side, u).p;
            let product = self.traces(side, v).p0.by(&self.traces(side, w).p0);
            let integral = match rule {
                Rule::Exact => p.where_positive(&product),
                Rule::Points(points) => {
                    let pressed = points.iter().filter(|[s, _]| p.at(*s) > S::from(0));
                    sum(pressed, |&[s, weight]| weight * product.at(s))
                }
            };
            side.length / self.0.gamma(side) * integral
        })
    }

    /// int over Gamma_C of (1/gamma) \[P(u)\]+ q, for q given on each side.
    pub fn contact(&self, rule: Rule<'_, S>, u: &[[S; 2]], q: impl Fn(&Side<S>) -> Line<S>) -> S {
        sum(&self.0.contact, |side| self.contact_on(rule, side, u, &q(side)))
    }

    /// int over one side of (1/gamma) \[P(u)\]+ q
    pub fn contact_on(&self, rule: Rule<'_, S>, side: &Side<S>, u: &[[S; 2]], q: &Line<S>) -> S {
        let p = self.traces(side, u).p;
        let integral = match rule {
            Rule::Exact => p.positive_part_times(q),
            Rule::Points(points) => sum(points, |&[s, w]| {
                let zero = S::from(0);
                let value = p.at(s);
                w * (if value > zero { value } else { zero }) * q.at(s)
            }),
        };
        side.length / self.0.gamma(side) * integral
    }

    /// The left side of (8).
    pub fn b(&self, rule: Rule<'_, S>, u: &[[S; 2]], v: &[[S; 2]]) -> S {
        self.big_a(u, v) + self.contact(rule, u, |side| self.traces(side, v).p0)
    }

    /// int P0(v)^2 / gamma
    pub fn squares(&self, rule: Rule<'_, S>, v: &[[S; 2]]) -> S {
        sum(&self.0.contact, |side| {
            let p0 = self.traces(side, v).p0;
            let square = p0.by(&p0);
            let integral = match rule {
                Rule::Exact => whole(&square),
                Rule::Points(points) => sum(points, |&[s, weight]| weight * square.at(s)),
            };
            side.length / self.0.gamma(side) * integral
        })
    }

    /// C_h: the largest of its triangles.
    pub fn coercivity(&self) -> S {
        let all = (0..self.0.triangles.len()).map(|t| self.coercivity_of(t));
        all.fold(S::from(0), |most, constant| if constant > most { constant } else { most })
    }

    /// p (p + 1) / 2 h_T / |T| times the sum of A_nnnn |E| over T's edges on Gamma_C
    pub fn coercivity_of(&self, t: usize) -> S {
        let body = self.0;
        let trace = S::from(if N == 3 { 1 } else { 3 });
        let sides = body.contact.iter().filter(|side| side.triangle == t);
        let stiffness = sum(sides, |side| body.hooke.along(side.n) * side.length);
        let vertices = body.triangles[t].map(|v| body.vertices[v]);
        let area = Field { vertices, nodal: Vec::new() }.area();
        trace * stiffness * body.diameters[t] / area
    }
}

/// The integral over \[0, 1\].
pub fn whole<S: Scalar>(line: &Line<S>) -> S {
    line.integral([S::from(0), S::from(1)])
}

/// What a body's contact looks like at u, for the classes: all open, all pressed, or both.
pub fn contact_class<const N: usize>(body: &Body, u: &[[Exact; 2]]) -> &'static str {
    let definition = Definition::<N>(body);
    let (mut open, mut pressed, mut cut) = (false, false, false);
    for side in &body.contact {
        let p = definition.traces(side, u).p;
        let ends = [p.at(Exact::from(0)), p.at(Exact::from(1))].map(|v| v > Exact::from(0));
        open |= !ends[0] || !ends[1];
        pressed |= ends[0] || ends[1];
        cut |= ends[0] != ends[1];
    }
    match (cut, open, pressed) {
        (true, _, _) => "an edge is cut",
        (_, true, true) => "open and pressed edges",
        (_, true, false) => "open",
        _ => "pressed",
    }
}
