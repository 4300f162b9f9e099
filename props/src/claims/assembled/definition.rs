//! A problem as the definitions need it, over any ordered field, and the mistakes that are planted in it.

use std::collections::BTreeMap;

use signorini::contact::{Discretization, EdgeRule};
use signorini::model::BoundaryEdge;

use super::draw::{Draw, Polynomial, Traction, owner};
use super::given::Given;
use crate::bodies::{Body, Definition, Rule, Side, law, sum, whole};
use crate::naive::{Field, Hooke, Line};
use crate::verdict::Ordered;

/// A planted mistake, in the definitions.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Mistake {
    None,
    EdgeLengthForDiameter,
    GapWithTheWrongSign,
    GammaInverted,
    LameExchanged,
    Theta(i32),
    TractionOnAnotherSide,
    LoadWithTheWrongSign,
}

/// A problem as the definitions need it.
pub(crate) struct Setting<S> {
    pub(crate) body: Body<S>,
    /// Component c of the body force is this polynomial.
    pub(crate) force: [Polynomial; 2],
    pub(crate) traction: [Traction; 2],
    /// The sides on which it acts.
    pub(crate) pulled: Vec<Side<S>>,
    /// 1: the factor of sigma_n in P0(v).
    pub(crate) theta: S,
    /// 1: the sign of L.
    pub(crate) load_sign: S,
    /// What is prescribed: by node and component, value and name of the side.
    pub(crate) prescribed: BTreeMap<(usize, usize), (S, &'static str)>,
    /// The rule's points, if it has any.
    pub(crate) points: Option<Vec<[S; 2]>>,
}

impl<S: Given> Setting<S> {
    /// The data of the draw, with the solver's h_T, |E|, n and gamma0; `None` if the solver has not the nodes or not the
    /// contact edges that the problem has.
    pub(crate) fn new<const N: usize>(draw: &Draw, d: &Discretization<'_>) -> Option<Self> {
        let (vertices, triangles, sides) = draw.parts();
        let mesh = &d.problem.mesh;
        let middles = if N == 3 { BTreeMap::new() } else { middles(draw, d.space.nodes())? };
        let [lambda, mu] = [draw.lambda, draw.mu].map(S::given);
        let tensor = draw.tensor.map(|c| c.map(S::given));
        let (material, hooke) = law([lambda, mu], draw.stress, tensor);
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
    pub(crate) fn prescribe<const N: usize>(
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

    pub(crate) fn rule(&self) -> Rule<'_, S> {
        self.points.as_deref().map_or(Rule::Exact, Rule::Points)
    }

    pub(crate) fn plant(&mut self, mistake: Mistake) {
        let body = &mut self.body;
        match mistake {
            Mistake::None => {}
            Mistake::EdgeLengthForDiameter => {
                for side in &body.contact {
                    body.diameters[side.triangle] = side.length;
                }
            }
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
            Mistake::Theta(theta) => self.theta = S::from(theta),
            Mistake::TractionOnAnotherSide => self.pulled = body.contact[..1].to_vec(),
            Mistake::LoadWithTheWrongSign => self.load_sign = S::from(-1),
        }
    }

    /// L(v) of the basis function at `node`, component c.
    pub(crate) fn load<const N: usize>(&self, node: usize, c: usize) -> S {
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
    pub(crate) fn contact<const N: usize>(&self, u: &[[S; 2]], v: &[[S; 2]]) -> S {
        let definition = Definition::<N, S>(&self.body);
        sum(definition.sides(v), |side| {
            let traces = definition.traces(side, v);
            let p0 = traces.v_n.minus(&traces.sigma_n.times(self.theta * self.body.gamma(side)));
            definition.contact_on(self.rule(), side, u, &p0)
        })
    }
}

pub(crate) fn unit<S: Ordered>(c: usize) -> [S; 2] {
    [0, 1].map(|i| S::from(i32::from(i == c)))
}

/// The vertices and the middles of the edges of triangle t.
pub(crate) fn places<S: Given>(body: &Body<S>, t: usize) -> [[S; 2]; 6] {
    let vertices = body.triangles[t].map(|v| body.vertices[v]);
    Field { vertices, nodal: Vec::new() }.places()
}

/// The node in the middle of each edge, by its place; `None` if there is not exactly one.
pub(crate) fn middles(draw: &Draw, nodes: &[[f64; 2]]) -> Option<BTreeMap<[usize; 2], usize>> {
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
