//! Rows 5 and 6 for the solver itself: the discretization that `signorini solve` builds, its matrix, its load, its residual
//! and the numbers that it reports, against the definitions of method (8) over rationals.
//!
//! Random small problems in doubles: two to eight triangles, turned, stretched and sheared, vertices moved and numbered at
//! random, contact on one or two sides (one triangle may own two contact edges), displacements that slide or not, loads and
//! gaps of degree <= 2, tractions with a share of the normal. Every double of the data is a rational number; the definitions (`naive`, `Definition`)
//! are evaluated on these numbers without error, and each number of the solver must be as near to its definition as its
//! own roundings allow: |double - exact| <= c 2^-53 m. Here m is the sum of the magnitudes of the terms of the definition
//! ([`Magnitude`]: the definition once more, with differences that add), and c is the number of roundings on the longest
//! way from the data to the number, counted by hand for P2 and listed in `roundings`. This is the usual bound to first
//! order, with the terms of the definition in the place of the solver's, which are about as large. A bound that no draw
//! comes near to is no test: the largest ratios of error and bound are reported, and those of `BOUNDS` must exceed
//! `SHARP`.
//!
//! Square roots are given data: the solver's h_T, |E| and n are first compared with the exact squares and normals
//! (`geometry`), then both sides use them.

use std::cell::RefCell;
use std::collections::BTreeMap;

use num_traits::ToPrimitive;
use proptest::prelude::*;
use signorini::fem::contact_line::EdgeRule;
use signorini::fem::matrix::{self, LowerTriangle, Neighbours, Numbering};
use signorini::fem::{
    BoundaryEdge, BoxedFunction, Condition, Diagonal, Discretization, Function, Mesh, Problem,
    Rectangle,
};
use signorini::kernel::edge_integral::ExactEdge;
use signorini::kernel::{Material, P1, P2, Plane, Triangle};
use signorini::nalgebra::Vector2;
use signorini::solve::{
    MethodReport, NewtonReport, NoLimit, Report, RouteName, Solution, Status, Unproved,
};

use crate::bodies::{Body, Definition, Rule, Side, combined, contact_class, sum, whole};
use crate::claim::Outcome;
use crate::draws;
use crate::ensure;
use crate::naive::{Field, Hooke, Line};
use crate::numbers::{Exact, Magnitude};
use crate::verdict::{Ordered, Verdict};

/// 2^-53
const UNIT: f64 = f64::EPSILON / 2.0;

/// Some number under each of these names must use up this share of its bound. (One number that is a sum of many terms of
/// either sign, such as J_h, is better than its bound by chance.)
const SHARP: f64 = 1.0 / 1000.0;
const BOUNDS: [&str; 5] = ["A(., .)", "A(u, v) - L(v)", "L(v)", "P(u)", "residual"];

/// A number that a double can be read as.
trait Given: Ordered {
    /// The value of a double.
    fn given(value: f64) -> Self;

    /// The same of a coordinate of a vertex.
    fn coordinate(value: f64) -> Self {
        Self::given(value)
    }
}

impl Given for Exact {
    fn given(value: f64) -> Exact {
        Exact::of_double(value)
    }
}

impl Given for Magnitude {
    fn given(value: f64) -> Magnitude {
        Magnitude::of_double(value)
    }

    fn coordinate(value: f64) -> Magnitude {
        Magnitude::of_coordinate(value)
    }
}

fn read<S: Given>(field: &[[f64; 2]]) -> Vec<[S; 2]> {
    field.iter().map(|v| v.map(S::given)).collect()
}

/// A polynomial of degree <= 2 in x and y: coefficients of 1, x, y, x^2, xy, y^2.
#[derive(Clone, Copy, Debug)]
struct Polynomial {
    coefficients: [f64; 6],
    /// What it says of its degree; `None` if it keeps it to itself.
    degree: Option<u32>,
}

impl Polynomial {
    fn value<S: Given>(&self, [x, y]: [S; 2]) -> S {
        let c = self.coefficients.map(S::given);
        c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y
    }
}

impl Function for Polynomial {
    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let c = self.coefficients;
        c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y
    }

    fn degree(&self) -> Option<u32> {
        self.degree
    }
}

/// A component of a traction: a polynomial and a share of the normal, as a pressure has it.
#[derive(Clone, Copy, Debug)]
struct Traction {
    polynomial: Polynomial,
    along_normal: f64,
    component: usize,
}

impl Function for Traction {
    fn at(&self, x: [f64; 2]) -> f64 {
        self.polynomial.at(x)
    }

    fn on_boundary(&self, x: [f64; 2], n: [f64; 2]) -> f64 {
        self.at(x) + self.along_normal * n[self.component]
    }

    fn degree(&self) -> Option<u32> {
        self.polynomial.degree.filter(|_| self.along_normal == 0.0)
    }
}

/// How the body meets the obstacle: the gap is moved.
#[derive(Clone, Copy, Debug)]
enum Contact {
    Open,
    Pressed,
    /// The gap rises steeply along the lower side.
    Cut,
    /// As the numbers fall.
    Any,
}

/// The plain data of a problem.
#[derive(Clone, Debug)]
struct Draw {
    cells: [usize; 2],
    diagonal: Diagonal,
    moves: Vec<[f64; 2]>,
    /// Angle, stretch, shear.
    map: [f64; 3],
    /// Coordinates are multiples of 2^-7, loads and fields of 2^-10, as in most draws: rationals with few digits.
    coarse: bool,
    /// The vertices are numbered, and the nodes are eliminated, in the order of these.
    keys: Vec<u32>,
    /// The corner that each triangle lists first.
    first: Vec<usize>,
    two_sides: bool,
    sliding: bool,
    stress: bool,
    lambda: f64,
    mu: f64,
    kappa: f64,
    gauss: bool,
    /// Body force, traction, displacement, gap.
    data: Vec<Polynomial>,
    along_normal: f64,
    fields: Vec<[f64; 2]>,
}

/// More than a field on these meshes has nodes.
const MOST_NODES: usize = 32;

fn polynomial() -> impl Strategy<Value = Polynomial> {
    let coefficients = prop::array::uniform6(-1.0_f64..1.0);
    (coefficients, 0_usize..6, any::<bool>()).prop_map(|(mut coefficients, kind, hidden)| {
        // Nothing, a constant, an affine function that is zero at the origin, a quadratic one.
        let (zeros, degree) = match kind {
            0 => (0..6, 0),
            1 => (1..6, 0),
            2 | 3 => (3..6, 1),
            _ => (0..0, 2),
        };
        coefficients[zeros].fill(0.0);
        if let 2 | 3 = kind {
            coefficients[0] = 0.0;
        }
        Polynomial { coefficients, degree: (!hidden).then_some(degree) }
    })
}

fn problems(contact: Contact, two_sides: bool) -> impl Strategy<Value = Draw> {
    let mesh = (
        prop_oneof![Just([1, 1]), Just([2, 1]), Just([1, 2])],
        prop::sample::select(&[Diagonal::Left, Diagonal::Right, Diagonal::Crossed]),
        prop::collection::vec([-0.15_f64..0.15, -0.15_f64..0.15], 8),
        [0.0_f64..6.3, 0.6_f64..1.6, -0.5_f64..0.5],
        0_u8..4,
        prop::collection::vec(any::<u32>(), MOST_NODES),
        prop::collection::vec(0_usize..3, 8),
    );
    let physics =
        (any::<bool>(), any::<bool>(), -0.6_f64..3.0, 0.5_f64..2.0, 0.05_f64..1.5, any::<bool>());
    let fields = (
        prop::collection::vec(polynomial(), 7),
        prop_oneof![Just(0.0), -1.0_f64..1.0],
        prop::collection::vec([-1.0_f64..1.0, -1.0_f64..1.0], 2 * MOST_NODES),
    );
    // Each kind of problem begins elsewhere in the same stream of random numbers.
    let skipped =
        prop::collection::vec(any::<u32>(), 2 * contact as usize + usize::from(two_sides));
    (skipped, mesh, physics, fields).prop_map(move |(_, mesh, physics, fields)| {
        let (cells, diagonal, moves, map, kind, keys, first) = mesh;
        let (sliding, stress, share, mu, kappa, gauss) = physics;
        let (mut data, along_normal, fields) = fields;
        data[6].coefficients[0] += match contact {
            Contact::Open => 32.0,
            Contact::Pressed => -32.0,
            Contact::Cut | Contact::Any => 0.0,
        };
        if let Contact::Cut = contact {
            data[6].coefficients[1] += 16.0 * map[0].cos();
            data[6].coefficients[2] += 16.0 * map[0].sin();
            data[6].degree = None;
        }
        let short = |c: f64| if kind == 0 { c } else { (c * 1024.0).round() / 1024.0 };
        let fields = fields.into_iter().map(|v| v.map(short)).collect();
        data.iter_mut().for_each(|p| p.coefficients = p.coefficients.map(short));
        // Two contact edges of one triangle: at the corner that the diagonal cuts off.
        let diagonal = if two_sides { Diagonal::Left } else { diagonal };
        Draw {
            cells,
            diagonal,
            moves,
            map,
            coarse: kind != 0,
            keys,
            first,
            two_sides,
            sliding,
            stress,
            lambda: share * mu,
            mu,
            kappa,
            gauss,
            data,
            along_normal,
            fields,
        }
    })
}

/// A side of the body.
type Edges = Vec<[usize; 2]>;

/// Vertices, triangles, and the sides by name.
type Parts = (Vec<[f64; 2]>, Vec<[usize; 3]>, BTreeMap<&'static str, Edges>);

impl Draw {
    fn order(&self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by_key(|&i| self.keys[i]);
        order
    }

    fn parts(&self) -> Parts {
        let [nx, ny] = self.cells;
        let (width, height) = (nx as f64, ny as f64);
        let cells = Rectangle { width, height, nx, ny, diagonal: self.diagonal };
        let grid = cells.mesh().expect("a rectangle of a few cells is a mesh");
        let [angle, stretch, shear] = self.map;
        let [angle, shear] = if self.coarse { [0.0; 2] } else { [angle, shear] };
        let moved = |(&[x, y], &[dx, dy]): (&[f64; 2], &[f64; 2])| {
            // Lines of contact stay straight: where they bend, the direction of contact is a field of its own.
            let (dx, dy) = (if x == 0.0 { 0.0 } else { dx }, if y == 0.0 { 0.0 } else { dy });
            let (x, y) = (x + dx - width / 2.0, y + dy - height / 2.0);
            let (x, y) = (stretch * x + shear * y, y / stretch);
            let turned = [angle.cos() * x - angle.sin() * y, angle.sin() * x + angle.cos() * y];
            if self.coarse { turned.map(|c| (c * 128.0).round() / 128.0) } else { turned }
        };
        let places: Vec<[f64; 2]> = grid.vertices().iter().zip(&self.moves).map(moved).collect();
        let order = self.order(places.len());
        let mut number = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| number[old] = new);
        let triangles = grid.triangles().iter().zip(&self.first).map(|(corners, first)| {
            let mut corners = corners.map(|v| number[v]);
            corners.rotate_left(*first);
            corners
        });
        let mut sides: BTreeMap<&str, Edges> = BTreeMap::new();
        let lines = [("left", 0, 0.0), ("right", 0, width), ("bottom", 1, 0.0), ("top", 1, height)];
        for corners in grid.triangles() {
            for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|edge| edge.map(|i| corners[i])) {
                for (name, c, at) in lines {
                    if [a, b].iter().all(|&v| grid.vertices()[v][c] == at) {
                        sides.entry(name).or_default().push([number[a], number[b]]);
                    }
                }
            }
        }
        (order.iter().map(|&old| places[old]).collect(), triangles.collect(), sides)
    }

    /// The names of the sides in contact.
    fn contact(&self) -> &'static [&'static str] {
        if self.two_sides { &["bottom", "left"] } else { &["bottom"] }
    }

    /// The names of the sides with a displacement, in alphabetical order, and which components they prescribe. The
    /// right and the upper side meet, and agree.
    fn displacement(&self) -> &'static [(&'static str, [bool; 2])] {
        if self.sliding {
            &[("right", [true, false]), ("top", [true, true])]
        } else {
            &[("top", [true, true])]
        }
    }

    /// The name of the side with a traction: one that is neither in contact nor prescribed, if there is one. The
    /// others are free.
    fn traction(&self) -> Option<&'static str> {
        match (self.two_sides, self.sliding) {
            (false, _) => Some("left"),
            (true, false) => Some("right"),
            (true, true) => None,
        }
    }

    fn tractions(&self) -> [Traction; 2] {
        [0, 1].map(|component| Traction {
            polynomial: self.data[2 + component],
            along_normal: self.along_normal,
            component,
        })
    }

    fn gap(&self) -> Polynomial {
        self.data[6]
    }

    /// The problem as the solver is given it.
    fn problem(&self) -> Problem {
        let (vertices, triangles, sides) = self.parts();
        let named = sides.into_iter().map(|(name, edges)| (name.to_owned(), edges));
        let mesh = Mesh::new(vertices, triangles, named).expect("moved a little, it is a mesh");
        let plane = if self.stress { Plane::Stress } else { Plane::Strain };
        let boxed = |p: Polynomial| -> BoxedFunction { Box::new(p) };
        let mut conditions = BTreeMap::new();
        for &name in self.contact() {
            conditions.insert(name.to_owned(), Condition::Contact { gap: boxed(self.gap()) });
        }
        for (name, components) in self.displacement() {
            let given = [0, 1].map(|c| components[c].then(|| boxed(self.data[4 + c])));
            conditions.insert((*name).to_owned(), Condition::Displacement(given));
        }
        if let Some(name) = self.traction() {
            let traction = self.tractions().map(|t| -> BoxedFunction { Box::new(t) });
            conditions.insert(name.to_owned(), Condition::Traction(traction));
        }
        let material = Material::lame(self.lambda, self.mu, plane);
        Problem::new(mesh, material, [boxed(self.data[0]), boxed(self.data[1])], conditions)
    }

    fn rule(&self) -> EdgeRule {
        if self.gauss { EdgeRule::gauss(3) } else { EdgeRule::Exact }
    }

    /// The first field, and a step to another one.
    fn fields(&self, nodes: usize) -> [Vec<[f64; 2]>; 2] {
        [0, 1].map(|k| self.fields[k * MOST_NODES..][..nodes].to_vec())
    }
}

/// The triangle that has this edge, and which of its edges it is.
fn owner(triangles: &[[usize; 3]], edge: [usize; 2]) -> BoundaryEdge {
    let opposite = |corners: &[usize; 3]| {
        let has = edge.iter().all(|v| corners.contains(v));
        corners.iter().position(|v| has && !edge.contains(v))
    };
    let mut all = triangles.iter().enumerate().filter_map(|(triangle, corners)| {
        opposite(corners).map(|local| BoundaryEdge { triangle, local })
    });
    all.next().expect("every side belongs to a triangle")
}

/// A planted mistake, in the definitions.
#[derive(Clone, Copy, Debug)]
enum Mistake {
    None,
    EdgeLengthForDiameter,
    ShortestEdgeForDiameter,
    DiameterOfAnotherTriangle,
    GapWithTheWrongSign,
    GammaInverted,
    ContactEdgeForgotten,
    Theta(i32),
    TractionOnAnotherSide,
    PlaneStrainForStress,
    LoadWithTheWrongSign,
    ReactionWithTheWrongSign,
}

/// A problem as the definitions need it.
struct Setting<S> {
    body: Body<S>,
    /// Component c of the body force is this polynomial.
    force: [Polynomial; 2],
    traction: [Traction; 2],
    /// The sides on which it acts.
    pulled: Vec<Side<S>>,
    /// 1: the factor of sigma_n in P0(v).
    theta: S,
    /// 1: the sign of L.
    load_sign: S,
    /// 1: the sign of the reactions.
    reaction_sign: S,
    /// What is prescribed: by node and component, value and name of the side.
    prescribed: BTreeMap<(usize, usize), (S, &'static str)>,
    /// The rule's points, if it has any.
    points: Option<Vec<[S; 2]>>,
}

impl<S: Given> Setting<S> {
    /// The data of the draw, with the solver's h_T, |E|, n and gamma0; `None` if the solver has not the nodes or not the
    /// contact edges that the problem has.
    fn new<E, const N: usize, const M: usize>(
        draw: &Draw,
        d: &Discretization<'_, E, N, M>,
    ) -> Option<Self>
    where
        E: ExactEdge<f64, N, M>,
    {
        let (vertices, triangles, sides) = draw.parts();
        let mesh = &d.problem.mesh;
        let middles = if N == 3 { BTreeMap::new() } else { middles(draw, d.space.nodes())? };
        let (lambda, mu, two) = (S::given(draw.lambda), S::given(draw.mu), S::from(2));
        let star = if draw.stress { two * lambda * mu / (lambda + two * mu) } else { lambda };
        let material = Material::lame(lambda, mu, Plane::Strain);
        let mut body = Body {
            vertices: vertices.iter().map(|x| x.map(S::coordinate)).collect(),
            unturned: Vec::new(),
            contact: Vec::new(),
            free: Vec::new(),
            top: Vec::new(),
            diameters: (0..triangles.len()).map(|t| S::given(mesh.diameter(t))).collect(),
            triangles,
            material,
            hooke: Hooke { lambda: star, mu },
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
            d.contact.iter().position(|line| line.edge == edge)
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
    fn prescribe<const N: usize>(
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

    fn rule(&self) -> Rule<'_, S> {
        self.points.as_deref().map_or(Rule::Exact, Rule::Points)
    }

    fn plant(&mut self, mistake: Mistake, draw: &Draw) {
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
            Mistake::ContactEdgeForgotten => {
                let owners: Vec<usize> = body.contact.iter().map(|side| side.triangle).collect();
                let twice = |t: usize| owners.iter().filter(|&&o| o == t).count() == 2;
                if let Some(at) = owners.iter().position(|&t| twice(t)) {
                    body.contact[at].length = S::from(0);
                }
            }
            Mistake::Theta(theta) => self.theta = S::from(theta),
            Mistake::TractionOnAnotherSide => self.pulled = body.contact[..1].to_vec(),
            Mistake::PlaneStrainForStress => body.hooke.lambda = S::given(draw.lambda),
            Mistake::LoadWithTheWrongSign => self.load_sign = S::from(-1),
            Mistake::ReactionWithTheWrongSign => self.reaction_sign = S::from(-1),
        }
    }

    /// L(v) of the basis function at `node`, component c.
    fn load<const N: usize>(&self, node: usize, c: usize) -> S {
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
    fn contact<const N: usize>(&self, u: &[[S; 2]], v: &[[S; 2]]) -> S {
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
    fn energy<const N: usize>(&self, u: &[[S; 2]], work: S) -> S {
        let definition = Definition::<N, S>(&self.body);
        let positive = definition.contact(self.rule(), u, |side| definition.traces(side, u).p);
        (definition.big_a(u, u) + positive) / S::from(2) - work
    }
}

/// A functional, given at the basis functions, at v.
fn inner<S: Ordered>(functional: &[S], v: &[[S; 2]]) -> S {
    sum(functional.iter().zip(v.as_flattened()), |(&f, &v)| f * v)
}

fn unit<S: Ordered>(c: usize) -> [S; 2] {
    [0, 1].map(|i| S::from(i32::from(i == c)))
}

/// The vertices and the middles of the edges of triangle t.
fn places<S: Given>(body: &Body<S>, t: usize) -> [[S; 2]; 6] {
    let vertices = body.triangles[t].map(|v| body.vertices[v]);
    Field { vertices, nodal: Vec::new() }.places()
}

/// The node in the middle of each edge, by its place; `None` if there is not exactly one.
fn middles(draw: &Draw, nodes: &[[f64; 2]]) -> Option<BTreeMap<[usize; 2], usize>> {
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
type Named<S> = (&'static str, Vec<S>);

/// The roundings on the longest way to these numbers, for P2: an edge takes 1, the double area 4, a barycentric gradient 6,
/// the gradient of a shape function 9, lambda of plane stress 4, a point of a Gauss rule or its weight some 4.
fn roundings(name: &str) -> f64 {
    f64::from(match name {
        "prescribed data" => 8,
        "u_n" => 3,
        "arc" => 5,
        // lambda + 2 mu, h_T, area.
        "C_h" | "kappa" | "limit" => 14,
        // Gradient, sigma_n of a shape function 11, gamma 2, sum over 12 products.
        "sigma_n(u)" | "sigma_n(u^h)" | "mean stress" => 36,
        "P(u)" | "gap" | "lambda^h" | "peak pressure" => 42,
        // Place 6, value 8, shape 8, weight 10, sum over 16 points of 8 triangles.
        "L(v)" | "L(u)" => 48,
        // Two gradients, the material, the area, sums.
        "a(., .)" | "A(., .)" | "a(u, v)" | "a(u, u)" | "A(u, v) - L(v)" => 64,
        // P, the integral over an edge, P0.
        _ => 96,
    })
}

/// Every number by its definition, at u; with the matrices if asked for (in the given order of the free degrees of freedom).
fn defined<S: Given, const N: usize>(
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
    let without: Vec<S> = big.iter().zip(&contact).map(|(&a, &p)| a + p).collect();
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
        ("residual without load", without),
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

/// The report that goes with a displacement that nothing was solved for.
fn unsolved() -> Report {
    let newton = NewtonReport {
        status: Status::Converged,
        residuals: Vec::new(),
        residual: 0.0,
        factorizations: 0,
    };
    let method = MethodReport {
        route: RouteName::Condensed,
        predicted_operations: 0.0,
        condition: 1.0,
        forward_error: 0.0,
        threads: 1,
        slides: 0,
    };
    Report { newton, method, enclosure: Err(Unproved::NotHeld), limit: Err(NoLimit::Assembled) }
}

/// The same numbers by the solver, in the same order.
fn assembled<E, const N: usize, const M: usize>(
    d: &Discretization<'_, E, N, M>,
    u: &[[f64; 2]],
    numbering: Option<&Numbering>,
) -> Vec<Named<f64>>
where
    E: ExactEdge<f64, N, M>,
{
    let flat = |field: &[[f64; 2]]| field.as_flattened().to_vec();
    let solution = Solution::new(d, u.to_vec(), unsolved());
    let q = &solution.quantities;
    let local = |triangle: usize| d.space.on_triangle(triangle, u);
    // In order along the edge.
    let sorted = |p: [f64; M]| [0, 2, 1].into_iter().filter(|&a| a < M).map(move |a| p[a]);
    let line = || d.contact.iter();
    let points = || solution.contact.iter().flat_map(|edge| &edge.points);
    let mut all = vec![
        ("prescribed data", flat(&d.constraints.lift())),
        ("C_h", vec![d.coercivity.constant]),
        ("kappa", vec![d.kappa()]),
        ("limit", vec![d.coercivity.limit()]),
        ("sigma_n(u)", line().flat_map(|e| e.sigma_n(&local(e.edge.triangle))).collect()),
        ("P(u)", line().flat_map(|e| sorted(e.p(&local(e.edge.triangle)))).collect()),
        ("u_n", points().map(|point| point.u_n).collect()),
        ("gap", points().map(|point| point.gap).collect()),
        ("sigma_n(u^h)", points().map(|point| point.sigma_n).collect()),
        ("arc", points().map(|point| point.arc).collect()),
        ("lambda^h", points().map(|point| point.lambda).collect()),
        ("peak pressure", vec![q.peak_pressure]),
        ("contact force", vec![q.contact_force]),
        ("contact resultant", q.contact_resultant.to_vec()),
        ("mean stress", solution.stress.iter().flat_map(|(s, _)| s.components()).collect()),
        ("a(u, v)", flat(&d.internal_forces(u).values)),
        ("a(u, u)", vec![q.energy]),
        ("L(v)", flat(&d.load)),
        ("L(u)", vec![q.work]),
        ("A(u, v) - L(v)", flat(&d.linear_residual(u).values)),
        ("residual", flat(&d.residual(u).values)),
        ("residual without load", flat(&d.residual_and_load(u))),
        ("J_h", vec![d.energy(u)]),
        ("reactions", q.reactions.values().flatten().copied().collect()),
    ];
    let matrices = numbering.map(|numbering| {
        let neighbours = Neighbours::new(d.space.nodes().len(), d.space.elements());
        [
            matrix::assemble_stiffness(d, numbering, &neighbours),
            matrix::assemble(d, numbering, &neighbours),
        ]
        .map(|matrix| entries(&matrix, numbering.count))
    });
    let [stiffness, matrix] = matrices.unwrap_or_default();
    all.extend([("a(., .)", stiffness), ("A(., .)", matrix)]);
    all
}

/// All entries of the lower triangle, column by column, zeros included; NaN if its rows are not in increasing order from
/// the diagonal on.
fn entries(matrix: &LowerTriangle, count: usize) -> Vec<f64> {
    let mut all = Vec::new();
    for column in 0..count {
        let range = matrix.starts[column]..matrix.starts[column + 1];
        let rows = &matrix.rows[range.clone()];
        let mut values = vec![0.0; count - column];
        for (row, value) in rows.iter().zip(&matrix.values[range]) {
            values[row - column] = *value;
        }
        if rows.first() != Some(&column) || rows.windows(2).any(|w| w[0] >= w[1]) {
            values.fill(f64::NAN);
        }
        all.extend(values);
    }
    all
}

/// The free degrees of freedom in the order of their numbers.
fn numbered(numbering: &Numbering) -> Vec<(usize, usize)> {
    let mut order = vec![(0, 0); numbering.count];
    for (node, numbers) in numbering.of.iter().enumerate() {
        for (c, number) in numbers.iter().enumerate() {
            if let Some(number) = number {
                order[*number] = (node, c);
            }
        }
    }
    order
}

/// The error of a double as a share of its bound; infinite where it is no number, or wrong where there is nothing to round.
fn share(double: f64, exact: Exact, bound: f64) -> f64 {
    if !double.is_finite() {
        return f64::INFINITY;
    }
    let error = (Exact::of_double(double) - exact).abs().value().to_f64();
    match error {
        Some(0.0) => 0.0,
        Some(error) => error / bound,
        None => f64::INFINITY,
    }
}

/// The largest share of its bound that an error used up, by name.
type Shares = RefCell<BTreeMap<&'static str, f64>>;

/// The whole comparison for one problem.
fn compared<E, const N: usize, const M: usize>(
    draw: &Draw,
    mistake: Mistake,
    matrices: bool,
    shares: &Shares,
) -> Verdict
where
    E: ExactEdge<f64, N, M>,
{
    let problem = draw.problem();
    let discretized =
        Discretization::<E, N, M>::new(&problem, |c| draw.kappa * c.limit(), draw.rule());
    let Ok(d) = discretized else { return Verdict::Fails("the problem is refused") };
    Exact::scope(|| {
        let settings = (Setting::<Exact>::new(draw, &d), Setting::<Magnitude>::new(draw, &d));
        let (Some(mut exact), Some(mut magnitude)) = settings else {
            return Verdict::Fails("nodes and contact edges are those of the mesh");
        };
        exact.plant(mistake, draw);
        magnitude.plant(mistake, draw);
        let nodes = d.space.nodes().len();
        ensure!(nodes == exact.body.node_count(N / 3));
        for (node, values) in d.constraints.values().iter().enumerate() {
            for c in 0..2 {
                ensure!(values[c].is_some() == exact.prescribed.contains_key(&(node, c)));
            }
        }
        let numbering = Numbering::new(&draw.order(nodes), d.constraints.values());
        ensure!(numbering.count == 2 * nodes - exact.prescribed.len());
        let order = if matrices { numbered(&numbering) } else { Vec::new() };
        let [u, step] = draw.fields(nodes);
        let doubles = assembled(&d, &u, matrices.then_some(&numbering));
        let exactly = defined::<_, N>(&exact, nodes, &read(&u), &order);
        let magnitudes = defined::<_, N>(&magnitude, nodes, &read(&u), &order);
        let near = all_near(&doubles, &exactly, &magnitudes, shares);
        if near.fails() {
            return near;
        }
        ensure!(contact_edges_follow_each_other(draw, &d));
        ensure!(limiting_edge_attains_the_constant::<E, N, M>(&d, &exact.body));
        ensure!(contact_length_is_the_measure_of_the_pressed_part(&d, &exact, &magnitude, &u));
        ensure!(residual_is_the_gradient_of_the_energy(&d, &exact, &magnitude, [&u, &step]));
        Verdict::Holds(contact_class::<N>(&exact.body, &read(&u)))
    })
}

/// Every double is within its bound. All names and lengths are the same on the three sides.
fn all_near(
    doubles: &[Named<f64>],
    exact: &[Named<Exact>],
    magnitudes: &[Named<Magnitude>],
    shares: &Shares,
) -> Verdict {
    ensure!(doubles.len() == exact.len());
    for (((name, doubles), (defined, exact)), (_, magnitudes)) in
        doubles.iter().zip(exact).zip(magnitudes)
    {
        ensure!(name == defined && doubles.len() == exact.len());
        for ((&double, &exact), magnitude) in doubles.iter().zip(exact).zip(magnitudes) {
            let share = share(double, exact, roundings(name) * UNIT * magnitude.sum());
            if !(share <= 1.0) {
                return Verdict::Fails(name);
            }
            let mut shares = shares.borrow_mut();
            let largest = shares.entry(name).or_insert(0.0);
            *largest = largest.max(share);
        }
    }
    Verdict::Holds("near")
}

/// On one side of the body, each contact edge starts where the one before it ends.
fn contact_edges_follow_each_other<E, const N: usize, const M: usize>(
    draw: &Draw,
    d: &Discretization<'_, E, N, M>,
) -> bool
where
    E: ExactEdge<f64, N, M>,
{
    let (_, triangles, sides) = draw.parts();
    let ends = |edge: BoundaryEdge| [1, 2].map(|k| triangles[edge.triangle][(edge.local + k) % 3]);
    let side = |edge: BoundaryEdge| {
        sides.values().position(|edges| edges.iter().any(|&e| owner(&triangles, e) == edge))
    };
    d.contact.windows(2).all(|pair| {
        let [a, b] = [pair[0].edge, pair[1].edge];
        side(a) != side(b) || ends(a)[1] == ends(b)[0]
    })
}

/// The edge that is said to limit gamma0 belongs to a triangle where the maximum C_h is attained, up to its bound.
fn limiting_edge_attains_the_constant<E, const N: usize, const M: usize>(
    d: &Discretization<'_, E, N, M>,
    body: &Body,
) -> bool
where
    E: ExactEdge<f64, N, M>,
{
    let definition = Definition::<N>(body);
    let most = definition.coercivity();
    let least = most * (Exact::from(1) - Exact::of_double(4.0 * roundings("C_h") * UNIT));
    let edge = d.coercivity.limiting_edge.map(|x| x.map(Exact::of_double));
    body.contact.iter().any(|side| {
        let corners = body.triangles[side.triangle];
        let ends = [1, 2].map(|k| body.vertices[corners[(side.local + k) % 3]]);
        ends == edge && definition.coercivity_of(side.triangle) >= least
    })
}

/// The contact length is monotone in P, and P is known to some delta: it lies between the measures of {P > delta} and of
/// {P > -delta}. (It is no continuous function of P where P touches zero.)
fn contact_length_is_the_measure_of_the_pressed_part<E, const N: usize, const M: usize>(
    d: &Discretization<'_, E, N, M>,
    exact: &Setting<Exact>,
    magnitude: &Setting<Magnitude>,
    u: &[[f64; 2]],
) -> bool
where
    E: ExactEdge<f64, N, M>,
{
    let (definition, sizes) =
        (Definition::<N>(&exact.body), Definition::<N, Magnitude>(&magnitude.body));
    let measure = |sign: f64| {
        sum(0..exact.body.contact.len(), |e| {
            let side = &exact.body.contact[e];
            let size = sizes.traces(&magnitude.body.contact[e], &read(u)).p.maximum().sum();
            let delta = Exact::of_double(sign * roundings("P(u)") * UNIT * size);
            let p = definition.traces(side, &read(u)).p.plus(&Line(vec![delta]));
            let zero = Exact::from(0);
            side.length
                * match exact.rule() {
                    Rule::Exact => sum(
                        p.pieces(),
                        |([start, end], positive)| {
                            if positive { end - start } else { zero }
                        },
                    ),
                    Rule::Points(points) => {
                        sum(points, |&[s, w]| if p.at(s) > zero { w } else { zero })
                    }
                }
        })
    };
    let lengths = sum(&exact.body.contact, |side| side.length);
    // Root, difference, product, sum.
    let slack = lengths * Exact::of_double(12.0 * UNIT);
    let length = Solution::new(d, u.to_vec(), unsolved()).quantities.contact_length;
    let length = Exact::of_double(length);
    measure(-1.0) - slack <= length && length <= measure(1.0) + slack
}

/// J_h(u + v) - J_h(u) - R(u; v) lies between 1/2 A(v, v) and 1/2 A(v, v) + 1/2 int P0(v)^2/gamma, up to the bounds of
/// the three: the residual is the derivative of the energy.
fn residual_is_the_gradient_of_the_energy<E, const N: usize, const M: usize>(
    d: &Discretization<'_, E, N, M>,
    exact: &Setting<Exact>,
    magnitude: &Setting<Magnitude>,
    [u, step]: [&[[f64; 2]]; 2],
) -> bool
where
    E: ExactEdge<f64, N, M>,
{
    let nodes = u.len();
    let moved: Vec<[f64; 2]> =
        u.iter().zip(step).map(|(u, v)| [u[0] + v[0], u[1] + v[1]]).collect();
    // The sum is rounded; the step is what it came to.
    let one = Exact::from(1);
    let v = combined(one, &read(&moved), -one, &read(u));
    let size: Vec<[Magnitude; 2]> = read(step);
    let residual = d.residual(u).values;
    let along = sum(0..nodes, |k| {
        let [x, y] = residual[k].map(Exact::of_double);
        x * v[k][0] + y * v[k][1]
    });
    let above = Exact::of_double(d.energy(&moved)) - Exact::of_double(d.energy(u)) - along;
    let sizes = Definition::<N, Magnitude>(&magnitude.body);
    let load: Vec<Magnitude> = (0..2 * nodes).map(|k| magnitude.load::<N>(k / 2, k % 2)).collect();
    let energy = |u: &[[f64; 2]]| {
        let u = read(u);
        magnitude.energy::<N>(&u, inner(&load, &u))
    };
    let terms = energy(&moved)
        + energy(u)
        + sizes.big_a(&read(u), &size)
        + magnitude.contact::<N>(&read(u), &size)
        + inner(&load, &size);
    let slack = Exact::of_double(roundings("residual") * UNIT * terms.sum());
    let definition = Definition::<N>(&exact.body);
    let half = Exact::ratio(1, 2);
    let least = half * definition.big_a(&v, &v);
    let most = least + half * definition.squares(exact.rule(), &v);
    least - slack <= above && above <= most + slack
}

/// A kind of problem, how many to draw, and the class that one of them must be of.
type Kind = (Contact, bool, u32, Option<&'static str>);

const P1_KINDS: [Kind; 6] = [
    (Contact::Any, false, 4, None),
    (Contact::Any, true, 4, None),
    (Contact::Cut, false, 4, Some("an edge is cut")),
    (Contact::Cut, true, 4, Some("an edge is cut")),
    (Contact::Open, false, 2, Some("open")),
    (Contact::Pressed, true, 2, Some("pressed")),
];

const P2_KINDS: [Kind; 5] = [
    (Contact::Any, false, 1, None),
    (Contact::Any, true, 1, None),
    (Contact::Cut, true, 3, Some("an edge is cut")),
    (Contact::Open, false, 1, Some("open")),
    (Contact::Pressed, true, 1, Some("pressed")),
];

fn all_of<E, const N: usize, const M: usize>(kinds: &[Kind]) -> Outcome
where
    E: ExactEdge<f64, N, M>,
{
    let shares = Shares::default();
    let mut found = Vec::new();
    for &(contact, two_sides, cases, class) in kinds {
        let problems = problems(contact, two_sides);
        found.push(draws::hold(cases, problems, class.as_slice(), |draw| {
            // The matrices do not know of the contact.
            compared::<E, N, M>(draw, Mistake::None, class.is_none(), &shares)
        })?);
    }
    let shares = shares.into_inner();
    let listed: Vec<String> = shares.iter().map(|(name, s)| format!("{name} {s:.4}")).collect();
    let found = format!("{}; error/bound at most: {}", found.join("; "), listed.join(", "));
    match BOUNDS.iter().find(|name| shares[*name] < SHARP) {
        None => Ok(found),
        Some(name) => Err(format!("no draw comes near to the bound of {name}: {found}")),
    }
}

/// P1: every number of the solver is near its definition.
pub fn p1() -> Outcome {
    all_of::<P1, 3, 2>(&P1_KINDS)
}

/// P2 likewise.
pub fn p2() -> Outcome {
    all_of::<P2, 6, 3>(&P2_KINDS)
}

fn rejected(mistake: Mistake) -> Outcome {
    draws::reject(12, problems(Contact::Any, true), |draw| {
        compared::<P1, 3, 2>(draw, mistake, false, &Shares::default())
    })
}

/// h_T taken wrong: the contact edge, the shortest edge, another triangle.
pub fn diameter_taken_wrong() -> Outcome {
    all_rejected(&[
        Mistake::EdgeLengthForDiameter,
        Mistake::ShortestEdgeForDiameter,
        Mistake::DiameterOfAnotherTriangle,
    ])
}

fn all_rejected(mistakes: &[Mistake]) -> Outcome {
    let each = mistakes.iter().map(|&mistake| Ok(format!("{mistake:?} {}", rejected(mistake)?)));
    each.collect::<Result<Vec<String>, String>>().map(|all| all.join("; "))
}

/// gamma inverted, one contact edge of a triangle with two forgotten, plane strain for plane stress.
pub fn form_taken_wrong() -> Outcome {
    all_rejected(&[
        Mistake::GammaInverted,
        Mistake::ContactEdgeForgotten,
        Mistake::PlaneStrainForStress,
    ])
}

/// theta = -1 and theta = 0, the sign of the gap.
pub fn contact_taken_wrong() -> Outcome {
    all_rejected(&[Mistake::Theta(-1), Mistake::Theta(0), Mistake::GapWithTheWrongSign])
}

/// A traction on another side, the sign of the load, the sign of the reactions.
pub fn load_taken_wrong() -> Outcome {
    all_rejected(&[
        Mistake::TractionOnAnotherSide,
        Mistake::LoadWithTheWrongSign,
        Mistake::ReactionWithTheWrongSign,
    ])
}

/// The square of a length, or of gamma, is within 8 units of roundoff of the exact one: two differences, hypot (2), a product,
/// squared.
fn close(length: f64, square: Exact) -> bool {
    let computed = Exact::of_double(length) * Exact::of_double(length);
    (computed - square).abs() <= square * Exact::of_double(8.0 * UNIT)
}

/// The square roots of one mesh: h_T is the longest edge, |E| and n are those of the edge. `diameter` is h_T, or a planted
/// mistake.
fn geometry(draw: &Draw, diameter: impl Fn(&Mesh, usize) -> f64) -> Verdict {
    let problem = draw.problem();
    let mesh = &problem.mesh;
    let (vertices, triangles, sides) = draw.parts();
    Exact::scope(|| {
        let exact = |t: usize| Triangle {
            vertices: triangles[t].map(|v| Vector2::from(vertices[v]).map(Exact::of_double)),
        };
        for t in 0..triangles.len() {
            let squares = [0, 1, 2].map(|i| {
                let [x, y] = exact(t).edge(i).into();
                x * x + y * y
            });
            ensure!(close(diameter(mesh, t), longest(squares)));
        }
        for edge in sides.into_values().flatten().map(|edge| owner(&triangles, edge)) {
            let [x, y] = exact(edge.triangle).scaled_normal(edge.local).into();
            let (length, n) = mesh.length_and_normal(edge);
            ensure!(close(length, x * x + y * y));
            for (c, exact) in [x, y].into_iter().enumerate() {
                // A difference and a quotient.
                let scaled = Exact::of_double(n[c]) * Exact::of_double(length);
                ensure!((scaled - exact).abs() <= exact.abs() * Exact::of_double(3.0 * UNIT));
            }
        }
        Verdict::Holds("always")
    })
}

/// The solver's square roots.
pub fn square_roots() -> Outcome {
    draws::hold(60, problems(Contact::Any, false), &["always"], |draw| {
        geometry(draw, |mesh, t| mesh.diameter(t))
    })
}

/// The control of [`square_roots`]: one edge for the longest one.
pub fn first_edge_for_the_longest() -> Outcome {
    draws::reject(10, problems(Contact::Any, false), |draw| {
        geometry(draw, |mesh, t| {
            let [x, y]: [f64; 2] = mesh.triangle(t).edge(0).into();
            x.hypot(y)
        })
    })
}

/// (7) for every contact edge of the solver: gamma^2 is gamma0^2 times `square`, the square of h_T or a planted mistake, of
/// the triangle and its edge.
fn gamma_is(draw: &Draw, square: impl Fn([Exact; 3], usize) -> Exact) -> Verdict {
    let problem = draw.problem();
    let discretized =
        Discretization::<P1, 3, 2>::new(&problem, |c| draw.kappa * c.limit(), draw.rule());
    let Ok(d) = discretized else { return Verdict::Fails("the problem is refused") };
    let (vertices, triangles, _) = draw.parts();
    Exact::scope(|| {
        let gamma0 = Exact::of_double(d.gamma0);
        for line in &d.contact {
            let vertices =
                triangles[line.edge.triangle].map(|v| vertices[v].map(Exact::of_double).into());
            let squares = [0, 1, 2].map(|i| {
                let edge = Triangle { vertices }.edge(i);
                edge.dot(&edge)
            });
            ensure!(close(line.gamma, gamma0 * gamma0 * square(squares, line.edge.local)));
        }
        Verdict::Holds("always")
    })
}

fn longest([a, b, c]: [Exact; 3]) -> Exact {
    let larger = |a: Exact, b: Exact| if b > a { b } else { a };
    larger(larger(a, b), c)
}

/// (7): gamma = gamma0 h_T, h_T the diameter of the triangle that owns the edge.
pub fn gamma_by_the_diameter() -> Outcome {
    draws::hold(60, problems(Contact::Any, false), &["always"], |draw| {
        gamma_is(draw, |squares, _| longest(squares))
    })
}

/// The control of [`gamma_by_the_diameter`]: |E| for h_T.
pub fn gamma_by_the_edge() -> Outcome {
    draws::reject(20, problems(Contact::Any, false), |draw| gamma_is(draw, |squares, i| squares[i]))
}
