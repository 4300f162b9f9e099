//! The numbers of a problem by their definitions, over any ordered field: [`defined`], and the mistakes that are planted in
//! it.

use std::collections::BTreeMap;

use signorini::contact::{Discretization, EdgeRule};
use signorini::kernel::{Material, Plane};
use signorini::model::BoundaryEdge;

use super::draw::{Draw, Polynomial, Traction, owner};
use super::given::Given;
use crate::bodies::{Body, Definition, Rule, Side, sum, whole};
use crate::naive::{Field, Hooke, Line};
use crate::verdict::Ordered;

/// A planted mistake, in the definitions.
#[derive(Clone, Copy, Debug)]
pub(super) enum Mistake {
    None,
    EdgeLengthForDiameter,
    ShortestEdgeForDiameter,
    DiameterOfAnotherTriangle,
    GapWithTheWrongSign,
    GammaInverted,
    LameExchanged,
    ContactEdgeForgotten,
    Theta(i32),
    TractionOnAnotherSide,
    PlaneStrainForStress,
    LoadWithTheWrongSign,
    ReactionWithTheWrongSign,
}

/// A problem as the definitions need it.
pub(super) struct Setting<S> {
    pub(super) body: Body<S>,
    /// Component c of the body force is this polynomial.
    pub(super) force: [Polynomial; 2],
    pub(super) traction: [Traction; 2],
    /// The sides on which it acts.
    pub(super) pulled: Vec<Side<S>>,
    /// 1: the factor of sigma_n in P0(v).
    pub(super) theta: S,
    /// 1: the sign of L.
    pub(super) load_sign: S,
    /// 1: the sign of the reactions.
    pub(super) reaction_sign: S,
    /// What is prescribed: by node and component, value and name of the side.
    pub(super) prescribed: BTreeMap<(usize, usize), (S, &'static str)>,
    /// The rule's points, if it has any.
    pub(super) points: Option<Vec<[S; 2]>>,
}

impl<S: Given> Setting<S> {
    /// The data of the draw, with the solver's h_T, |E|, n and gamma0; `None` if the solver has not the nodes or not the
    /// contact edges that the problem has.
    pub(super) fn new<const N: usize>(draw: &Draw, d: &Discretization<'_>) -> Option<Self> {
        let (vertices, triangles, sides) = draw.parts();
        let mesh = &d.problem.mesh;
        let middles = if N == 3 { BTreeMap::new() } else { middles(draw, d.space.nodes())? };
        let (lambda, mu, two) = (S::given(draw.lambda), S::given(draw.mu), S::from(2));
        let star = if draw.stress { two * lambda * mu / (lambda + two * mu) } else { lambda };
        let (material, hooke) = match draw.tensor.map(|c| c.map(S::given)) {
            Some(c) => (Material::tensor(c, None), Hooke::Tensor(c)),
            None => {
                let material = Material::lame(lambda, mu, Plane::Strain);
                (material, Hooke::Isotropic { lambda: star, mu })
            }
        };
        let mut body = Body {
            vertices: vertices.iter().map(|x| x.map(S::coordinate)).collect(),
            unturned: Vec::new(),
            contact: Vec::new(),
            free: Vec::new(),
            top: Vec::new(),
            diameters: (0..triangles.len()).map(|t| S::given(mesh.diameter(t))).collect(),
            triangles,
            material,
            hooke,
            gamma0: S::given(d.gamma0),
            turn: [S::from(1), S::from(0)],
            middles,
            values: Vec::new(),
        };
        let side_at = |edge: BoundaryEdge, body: &Body<S>| {
            let (length, n) = mesh.length_and_normal(edge);
            let BoundaryEdge { triangle, local } = edge;
            let places = places(body, triangle);
            let at = [(local + 1) % 3, (local + 2) % 3, 3 + local];
            let gap = at.map(|k| draw.gap().value(places[k]));
            Side { triangle, local, length: S::given(length), n: n.map(S::given).into(), gap }
        };
        let all = |names: &[&str], body: &Body<S>| -> Vec<Side<S>> {
            let edges = names.iter().flat_map(|name| &sides[name]);
            edges.map(|&edge| side_at(owner(&body.triangles, edge), body)).collect()
        };
        body.contact = all(draw.contact(), &body);
        // The integrals are listed edge by edge in the solver's order.
        let place = |side: &Side<S>| {
            let edge = BoundaryEdge { triangle: side.triangle, local: side.local };
            d.contact.iter().position(|line| line.edge() == edge)
        };
        if d.contact.len() != body.contact.len()
            || body.contact.iter().any(|side| place(side).is_none())
        {
            return None;
        }
        body.contact.sort_by_key(place);
        let pulled = all(draw.traction().as_slice(), &body);
        let mut setting = Setting {
            body,
            force: [draw.data[0], draw.data[1]],
            traction: draw.tractions(),
            pulled,
            theta: S::from(1),
            load_sign: S::from(1),
            reaction_sign: S::from(1),
            prescribed: BTreeMap::new(),
            points: match &d.rule {
                EdgeRule::Exact => None,
                EdgeRule::Gauss(rule) => {
                    Some(rule.iter().map(|&(s, w)| [S::given(s), S::given(w)]).collect())
                }
            },
        };
        for (name, components) in draw.displacement() {
            for &edge in &sides[name] {
                setting.prescribe::<N>(draw, name, *components, edge);
            }
        }
        Some(setting)
    }

    /// The nodes of a side: its data there, unless another side was first.
    pub(super) fn prescribe<const N: usize>(
        &mut self,
        draw: &Draw,
        name: &'static str,
        components: [bool; 2],
        [a, b]: [usize; 2],
    ) {
        let body = &self.body;
        let middle = (N == 6).then(|| body.middles[&[a.min(b), a.max(b)]]);
        let half = [0, 1].map(|c| (body.vertices[a][c] + body.vertices[b][c]) / S::from(2));
        let nodes = [(a, body.vertices[a]), (b, body.vertices[b])];
        for (node, place) in nodes.into_iter().chain(middle.map(|node| (node, half))) {
            for c in (0..2).filter(|&c| components[c]) {
                let value = draw.data[4 + c].value(place);
                self.prescribed.entry((node, c)).or_insert((value, name));
            }
        }
    }

    pub(super) fn rule(&self) -> Rule<'_, S> {
        self.points.as_deref().map_or(Rule::Exact, Rule::Points)
    }

    pub(super) fn plant(&mut self, mistake: Mistake, draw: &Draw) {
        let body = &mut self.body;
        let length = |body: &Body<S>, t: usize, i: usize| {
            let corners = body.triangles[t];
            let [a, b] = [1, 2].map(|k| draw.parts().0[corners[(i + k) % 3]]);
            (a[0] - b[0]).hypot(a[1] - b[1])
        };
        match mistake {
            Mistake::None => {}
            Mistake::EdgeLengthForDiameter => {
                for side in &body.contact {
                    body.diameters[side.triangle] = side.length;
                }
            }
            Mistake::ShortestEdgeForDiameter => {
                for t in 0..body.triangles.len() {
                    let lengths = [0, 1, 2].map(|i| length(body, t, i));
                    body.diameters[t] = S::given(lengths.into_iter().fold(f64::MAX, f64::min));
                }
            }
            Mistake::DiameterOfAnotherTriangle => body.diameters.rotate_left(1),
            Mistake::GapWithTheWrongSign => {
                for side in &mut body.contact {
                    side.gap = side.gap.map(|g| -g);
                }
            }
            Mistake::GammaInverted => body.gamma0 = S::from(1) / body.gamma0,
            Mistake::LameExchanged => {
                if let Hooke::Isotropic { lambda, mu } = &mut body.hooke {
                    std::mem::swap(lambda, mu);
                }
            }
            Mistake::ContactEdgeForgotten => {
                let owners: Vec<usize> = body.contact.iter().map(|side| side.triangle).collect();
                let twice = |t: usize| owners.iter().filter(|&&o| o == t).count() == 2;
                if let Some(at) = owners.iter().position(|&t| twice(t)) {
                    body.contact[at].length = S::from(0);
                }
            }
            Mistake::Theta(theta) => self.theta = S::from(theta),
            Mistake::TractionOnAnotherSide => self.pulled = body.contact[..1].to_vec(),
            Mistake::PlaneStrainForStress if draw.tensor.is_some() => {}
            Mistake::PlaneStrainForStress => {
                let (lambda, mu) = (S::given(draw.lambda), S::given(draw.mu));
                body.hooke = Hooke::Isotropic { lambda, mu };
            }
            Mistake::LoadWithTheWrongSign => self.load_sign = S::from(-1),
            Mistake::ReactionWithTheWrongSign => self.reaction_sign = S::from(-1),
        }
    }

    /// L(v) of the basis function at `node`, component c.
    pub(super) fn load<const N: usize>(&self, node: usize, c: usize) -> S {
        let body = &self.body;
        let v = body.bump(node, unit(c));
        let own = |t: usize| body.nodes::<N>(t).contains(&node);
        let inside = sum((0..body.triangles.len()).filter(|&t| own(t)), |t| {
            body.field::<N>(t, &v).load(c, |x| self.force[c].value(x))
        });
        let Traction { polynomial, along_normal, .. } = self.traction[c];
        let pulled = self.pulled.iter().filter(|side| own(side.triangle));
        let outside = sum(pulled, |side| {
            let places = places(body, side.triangle);
            let normal = S::given(along_normal) * side.n[c];
            let at = |k: usize| polynomial.value(places[k]) + normal;
            let i = side.local;
            let t = Line::quadratic(at((i + 1) % 3), at(3 + i), at((i + 2) % 3));
            let trace = body.field::<N>(side.triangle, &v).normal_trace(i, unit(c));
            side.length * whole(&t.by(&trace))
        });
        self.load_sign * (inside + outside)
    }

    /// int (1/gamma) \[P(u)\]+ P0(v), with theta in P0(v)
    pub(super) fn contact<const N: usize>(&self, u: &[[S; 2]], v: &[[S; 2]]) -> S {
        let definition = Definition::<N, S>(&self.body);
        let own = |side: &&Side<S>| {
            let zero = S::from(0);
            self.body.local::<N>(side.triangle, v).iter().flatten().any(|&v| v != zero)
        };
        sum(self.body.contact.iter().filter(own), |side| {
            let traces = definition.traces(side, v);
            let p0 = traces.v_n.minus(&traces.sigma_n.times(self.theta * self.body.gamma(side)));
            definition.contact_on(self.rule(), side, u, &p0)
        })
    }

    /// J_h(u), given L(u)
    pub(super) fn energy<const N: usize>(&self, u: &[[S; 2]], work: S) -> S {
        let definition = Definition::<N, S>(&self.body);
        let positive = definition.contact(self.rule(), u, |side| definition.traces(side, u).p);
        (definition.big_a(u, u) + positive) / S::from(2) - work
    }
}

/// A functional, given at the basis functions, at v.
pub(super) fn inner<S: Ordered>(functional: &[S], v: &[[S; 2]]) -> S {
    sum(functional.iter().zip(v.as_flattened()), |(&f, &v)| f * v)
}

pub(super) fn unit<S: Ordered>(c: usize) -> [S; 2] {
    [0, 1].map(|i| S::from(i32::from(i == c)))
}

/// The vertices and the middles of the edges of triangle t.
pub(super) fn places<S: Given>(body: &Body<S>, t: usize) -> [[S; 2]; 6] {
    let vertices = body.triangles[t].map(|v| body.vertices[v]);
    Field { vertices, nodal: Vec::new() }.places()
}

/// The node in the middle of each edge, by its place; `None` if there is not exactly one.
pub(super) fn middles(draw: &Draw, nodes: &[[f64; 2]]) -> Option<BTreeMap<[usize; 2], usize>> {
    let (vertices, triangles, _) = draw.parts();
    let mut middles = BTreeMap::new();
    for corners in triangles {
        for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|edge| edge.map(|i| corners[i])) {
            let place = [0, 1].map(|c| (vertices[a][c] + vertices[b][c]) / 2.0);
            let mut here = (vertices.len()..nodes.len()).filter(|&node| nodes[node] == place);
            middles.insert([a.min(b), a.max(b)], here.next()?);
            if here.next().is_some() {
                return None;
            }
        }
    }
    (vertices.len() + middles.len() == nodes.len()).then_some(middles)
}

/// A list of numbers under one name.
pub(super) type Named<S> = (&'static str, Vec<S>);

/// Every number by its definition, at u; with the matrices if asked for (in the given order of the free degrees of freedom).
pub(super) fn defined<S: Given, const N: usize>(
    setting: &Setting<S>,
    nodes: usize,
    u: &[[S; 2]],
    order: &[(usize, usize)],
) -> Vec<Named<S>> {
    let body = &setting.body;
    let definition = Definition::<N, S>(body);
    let dofs: Vec<(usize, usize)> = (0..nodes).flat_map(|node| [(node, 0), (node, 1)]).collect();
    let each = |f: &dyn Fn(usize, usize) -> S| dofs.iter().map(|&(k, c)| f(k, c)).collect();
    let load: Vec<S> = each(&|k, c| setting.load::<N>(k, c));
    let bump = |(k, c): (usize, usize)| body.bump(k, unit(c));
    let internal: Vec<S> = each(&|k, c| definition.a(u, &bump((k, c))));
    let stress: Vec<S> = each(&|k, c| definition.stress_product(u, &bump((k, c))));
    let big: Vec<S> = internal.iter().zip(&stress).map(|(&a, &s)| a - s).collect();
    let contact: Vec<S> = each(&|k, c| setting.contact::<N>(u, &bump((k, c))));
    let linear: Vec<S> = big.iter().zip(&load).map(|(&a, &l)| a - l).collect();
    let residual: Vec<S> = linear.iter().zip(&contact).map(|(&a, &p)| a + p).collect();
    let work = inner(&load, u);
    let half = S::from(1) / S::from(2);
    let traces: Vec<_> = body.contact.iter().map(|side| definition.traces(side, u)).collect();
    let (zero, one) = (S::from(0), S::from(1));
    let along = if N == 3 { vec![zero, one] } else { vec![zero, half, one] };
    let on_edges = |f: &dyn Fn(usize, S) -> S| -> Vec<S> {
        (0..traces.len()).flat_map(|e| along.iter().map(move |&s| f(e, s))).collect()
    };
    let positive_part = |p: S| if p > zero { p } else { zero };
    let pressure = |e: usize, p: S| positive_part(p) / body.gamma(&body.contact[e]);
    let forces: Vec<S> = body
        .contact
        .iter()
        .map(|side| definition.contact_on(setting.rule(), side, u, &Line(vec![one])))
        .collect();
    let along_normals =
        [0, 1].map(|c| -sum(forces.iter().zip(&body.contact), |(&force, side)| force * side.n[c]));
    let peaks = traces.iter().enumerate().map(|(e, traces)| pressure(e, traces.p.maximum()));
    let peak = peaks.fold(zero, |most, p| if p > most { p } else { most });
    let mut reactions: BTreeMap<&str, [S; 2]> = BTreeMap::new();
    for (&(node, c), (_, name)) in &setting.prescribed {
        let reaction = reactions.entry(name).or_insert([zero; 2]);
        reaction[c] += setting.reaction_sign * residual[2 * node + c];
    }
    let mean = |t: usize| {
        let field = body.field::<N>(t, u);
        let at = [0, 1, 2].map(|k| body.hooke.stress(field.strain(k)));
        [0, 1, 2].map(|c| (at[0][c] + at[1][c] + at[2][c]) / S::from(3))
    };
    let prescribed = |k, c| setting.prescribed.get(&(k, c)).map_or(zero, |&(value, _)| value);
    let constant = definition.coercivity();
    let mut all = vec![
        ("prescribed data", each(&prescribed)),
        ("C_h", vec![constant]),
        ("kappa", vec![body.gamma0 * constant]),
        ("limit", vec![one / constant]),
        (
            "sigma_n(u)",
            traces.iter().flat_map(|t| [t.sigma_n.at(zero), t.sigma_n.at(one)]).collect(),
        ),
        ("P(u)", on_edges(&|e, s| traces[e].p.at(s))),
        ("u_n", on_edges(&|e, s| traces[e].v_n.at(s))),
        ("gap", on_edges(&|e, s| traces[e].p0.minus(&traces[e].p).at(s))),
        ("sigma_n(u^h)", on_edges(&|e, s| traces[e].sigma_n.at(s))),
        (
            "arc",
            on_edges(&|e, s| {
                // From zero on each boundary: where a side does not start where the one before it ends.
                let corner =
                    |side: &Side<S>, k| body.triangles[side.triangle][(side.local + k) % 3];
                let joined =
                    |i: usize| corner(&body.contact[i], 2) == corner(&body.contact[i + 1], 1);
                let first = (0..e).rev().find(|&i| !joined(i));
                let before = &body.contact[first.map_or(0, |i| i + 1)..e];
                sum(before, |side| side.length) + s * body.contact[e].length
            }),
        ),
        ("lambda^h", on_edges(&|e, s| -pressure(e, traces[e].p.at(s)))),
        ("peak pressure", vec![peak]),
        ("contact force", vec![sum(&forces, |&force| force)]),
        ("contact resultant", along_normals.to_vec()),
        ("mean stress", (0..body.triangles.len()).flat_map(mean).collect()),
        ("a(u, v)", internal),
        ("a(u, u)", vec![definition.a(u, u)]),
        ("L(v)", load),
        ("L(u)", vec![work]),
        ("A(u, v) - L(v)", linear),
        ("residual", residual),
        ("J_h", vec![setting.energy::<N>(u, work)]),
        ("reactions", reactions.into_values().flatten().collect()),
    ];
    // The entries of a symmetric matrix, now in this order, now in that.
    let bumps: Vec<_> = order.iter().map(|&dof| bump(dof)).collect();
    let pairs = (0..bumps.len()).flat_map(|j| (j..bumps.len()).map(move |i| (i, j)));
    let ordered = pairs.map(|(i, j)| if (i + j) % 2 == 0 { (i, j) } else { (j, i) });
    let entries: Vec<[S; 2]> = ordered
        .map(|(i, j)| {
            let a = definition.a(&bumps[i], &bumps[j]);
            [a, a - definition.stress_product(&bumps[i], &bumps[j])]
        })
        .collect();
    all.push(("a(., .)", entries.iter().map(|entry| entry[0]).collect()));
    all.push(("A(., .)", entries.iter().map(|entry| entry[1]).collect()));
    all
}
