//! The problems: random small ones in doubles, as plain data and as the solver is given them.

use std::collections::BTreeMap;
use std::sync::Arc;

use proptest::prelude::*;
use signorini::contact::EdgeRule;
use signorini::kernel::{Material, Plane};
use signorini::model::{
    BoundaryEdge, Condition, Diagonal, Function, Mesh, Problem, Rectangle, SharedFunction,
};

use super::given::Given;
use crate::draws;

/// A polynomial of degree <= 2 in x and y: coefficients of 1, x, y, x^2, xy, y^2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polynomial {
    pub(crate) coefficients: [f64; 6],
    /// What it says of its degree; `None` if it keeps it to itself.
    pub(crate) degree: Option<u32>,
}

impl Polynomial {
    pub(crate) fn value<S: Given>(&self, [x, y]: [S; 2]) -> S {
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
pub(crate) struct Traction {
    pub(crate) polynomial: Polynomial,
    pub(crate) along_normal: f64,
    pub(crate) component: usize,
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
pub(crate) enum Contact {
    Open,
    Pressed,
    /// The gap rises steeply along the lower side.
    Cut,
    /// As the numbers fall.
    Any,
}

/// The plain data of a problem.
#[derive(Clone, Debug)]
pub(crate) struct Draw {
    pub(crate) cells: [usize; 2],
    pub(crate) diagonal: Diagonal,
    pub(crate) moves: Vec<[f64; 2]>,
    /// Angle, stretch, shear.
    pub(crate) map: [f64; 3],
    /// Coordinates are multiples of 2^-7, loads and fields of 2^-10, as in most draws: rationals with few digits.
    pub(crate) coarse: bool,
    /// The vertices are numbered, and the nodes are eliminated, in the order of these.
    pub(crate) keys: Vec<u32>,
    /// The corner that each triangle lists first.
    pub(crate) first: Vec<usize>,
    pub(crate) two_sides: bool,
    pub(crate) sliding: bool,
    pub(crate) stress: bool,
    pub(crate) lambda: f64,
    pub(crate) mu: f64,
    /// A in place of lambda and mu.
    pub(crate) tensor: Option<[f64; 6]>,
    pub(crate) kappa: f64,
    pub(crate) gauss: bool,
    /// Body force, traction, displacement, gap.
    pub(crate) data: Vec<Polynomial>,
    pub(crate) along_normal: f64,
    pub(crate) fields: Vec<[f64; 2]>,
}

/// More than a field on these meshes has nodes.
pub(crate) const MOST_NODES: usize = 32;

pub(crate) fn polynomial() -> impl Strategy<Value = Polynomial> {
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

pub(crate) fn problems(contact: Contact, two_sides: bool) -> impl Strategy<Value = Draw> {
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
        prop::option::of(draws::tensors()),
    );
    // Each kind of problem begins elsewhere in the same stream of random numbers.
    let skipped =
        prop::collection::vec(any::<u32>(), 2 * contact as usize + usize::from(two_sides));
    (skipped, mesh, physics, fields).prop_map(move |(_, mesh, physics, fields)| {
        let (cells, diagonal, moves, map, kind, keys, first) = mesh;
        let (sliding, stress, share, mu, kappa, gauss) = physics;
        let (mut data, along_normal, fields, tensor) = fields;
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
            tensor,
            kappa,
            gauss,
            data,
            along_normal,
            fields,
        }
    })
}

/// A side of the body.
pub(crate) type Edges = Vec<[usize; 2]>;

/// Vertices, triangles, and the sides by name.
pub(crate) type Parts = (Vec<[f64; 2]>, Vec<[usize; 3]>, BTreeMap<&'static str, Edges>);

impl Draw {
    pub(crate) fn order(&self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by_key(|&i| self.keys[i]);
        order
    }

    pub(crate) fn parts(&self) -> Parts {
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
    pub(crate) fn contact(&self) -> &'static [&'static str] {
        if self.two_sides { &["bottom", "left"] } else { &["bottom"] }
    }

    /// The names of the sides with a displacement, in alphabetical order, and which components they prescribe. The
    /// right and the upper side meet, and agree.
    pub(crate) fn displacement(&self) -> &'static [(&'static str, [bool; 2])] {
        if self.sliding {
            &[("right", [true, false]), ("top", [true, true])]
        } else {
            &[("top", [true, true])]
        }
    }

    /// The name of the side with a traction: one that is neither in contact nor prescribed, if there is one. The
    /// others are free.
    pub(crate) fn traction(&self) -> Option<&'static str> {
        match (self.two_sides, self.sliding) {
            (false, _) => Some("left"),
            (true, false) => Some("right"),
            (true, true) => None,
        }
    }

    pub(crate) fn tractions(&self) -> [Traction; 2] {
        [0, 1].map(|component| Traction {
            polynomial: self.data[2 + component],
            along_normal: self.along_normal,
            component,
        })
    }

    pub(crate) fn gap(&self) -> Polynomial {
        self.data[6]
    }

    /// The problem as the solver is given it.
    pub(crate) fn problem(&self) -> Problem {
        let (vertices, triangles, sides) = self.parts();
        let named = sides.into_iter().map(|(name, edges)| (name.to_owned(), edges));
        let mesh = Mesh::new(vertices, triangles, named).expect("moved a little, it is a mesh");
        let plane = if self.stress { Plane::Stress } else { Plane::Strain };
        let shared = |p: Polynomial| -> SharedFunction { Arc::new(p) };
        let mut conditions = BTreeMap::new();
        for &name in self.contact() {
            conditions.insert(name.to_owned(), Condition::Contact { gap: shared(self.gap()) });
        }
        for (name, components) in self.displacement() {
            let given = [0, 1].map(|c| components[c].then(|| shared(self.data[4 + c])));
            conditions.insert((*name).to_owned(), Condition::Displacement(given));
        }
        if let Some(name) = self.traction() {
            let traction = self.tractions().map(|t| -> SharedFunction { Arc::new(t) });
            conditions.insert(name.to_owned(), Condition::Traction(traction));
        }
        let material = match self.tensor {
            Some(c) => Material::tensor(c, None),
            None => Material::lame(self.lambda, self.mu, plane),
        };
        Problem::new(mesh, material, [shared(self.data[0]), shared(self.data[1])], conditions)
    }

    pub(crate) fn rule(&self) -> EdgeRule {
        if self.gauss { EdgeRule::gauss(3) } else { EdgeRule::Exact }
    }

    /// The first field, and a step to another one.
    pub(crate) fn fields(&self, nodes: usize) -> [Vec<[f64; 2]>; 2] {
        [0, 1].map(|k| self.fields[k * MOST_NODES..][..nodes].to_vec())
    }
}

/// The triangle that has this edge, and which of its edges it is.
pub(crate) fn owner(triangles: &[[usize; 3]], edge: [usize; 2]) -> BoundaryEdge {
    let opposite = |corners: &[usize; 3]| {
        let has = edge.iter().all(|v| corners.contains(v));
        corners.iter().position(|v| has && !edge.contains(v))
    };
    let mut all = triangles.iter().enumerate().filter_map(|(triangle, corners)| {
        opposite(corners).map(|local| BoundaryEdge { triangle, local })
    });
    all.next().expect("every side belongs to a triangle")
}
