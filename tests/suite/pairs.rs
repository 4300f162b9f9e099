//! Two and more deformable bodies in contact: exact solutions, limits, balance, the coercivity number, curved boundaries, bodies that
//! only another body holds; and mistakes planted in the pieces, which the same checks notice.

use std::sync::Arc;

use signorini::contact::piece::PieceGeometry;
use signorini::contact::{Discretization, Law, Pair, Piece};
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Condition, Materials, Mesh, Problem};
use signorini::nalgebra::Vector2;
use signorini::results::Solution;
use signorini::solve::{Gamma0, Method, Settings, SolveError, discretize, solve, solve_discrete};

mod balance;
mod certified;
mod curved;
mod forces;
mod friction;
mod limits;
mod patch;
mod random;

/// A map of the unit square.
type Map<'a> = &'a dyn Fn([f64; 2]) -> [f64; 2];

/// A body of nx x ny cells, the image of the unit square; its sides are NAME.bottom, .right, .top and .left.
struct Block<'a> {
    name: &'static str,
    cells: [usize; 2],
    material: Material<f64>,
    map: Map<'a>,
}

/// The rectangle between two corners.
fn rectangle(low: [f64; 2], high: [f64; 2]) -> impl Fn([f64; 2]) -> [f64; 2] {
    move |x| [0, 1].map(|c| low[c] + (high[c] - low[c]) * x[c])
}

/// A part of a ring around `centre` between two radii: it runs clockwise from one angle to the other, the inner side first.
fn ring(centre: [f64; 2], radii: [f64; 2], [from, to]: [f64; 2]) -> impl Fn([f64; 2]) -> [f64; 2] {
    move |[s, t]| {
        let (angle, r) = (from + (to - from) * s, radii[0] + (radii[1] - radii[0]) * t);
        [centre[0] + r * angle.cos(), centre[1] + r * angle.sin()]
    }
}

fn young(modulus: f64, poisson: f64) -> Material<f64> {
    Material::young_poisson(modulus, poisson, Plane::Strain)
}

/// A problem of these bodies with these pairs; nothing acts on it yet. Maps may turn the square over.
fn bodies(blocks: &[Block], pairs: &[Pair]) -> Problem {
    let (mut vertices, mut triangles, mut named) = (Vec::new(), Vec::new(), Vec::new());
    let mut members: Vec<(Material<f64>, Vec<usize>)> = Vec::new();
    for &Block { name, cells: [nx, ny], material, map } in blocks {
        let (first, own) = (vertices.len(), triangles.len());
        let at = |i: usize, j: usize| first + j * (nx + 1) + i;
        for j in 0..=ny {
            vertices.extend((0..=nx).map(|i| map([i as f64 / nx as f64, j as f64 / ny as f64])));
        }
        let area = |[a, b, c]: [usize; 3]| {
            let [a, b, c] = [a, b, c].map(|v: usize| Vector2::from(vertices[v]));
            (b - a).perp(&(c - a))
        };
        let upright = |t: [usize; 3]| if area(t) > 0.0 { t } else { [t[0], t[2], t[1]] };
        for j in 0..ny {
            for i in 0..nx {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([upright([a, b, c]), upright([a, c, d])]);
            }
        }
        let side = |what: &str, edges: Vec<[usize; 2]>| (format!("{name}.{what}"), edges);
        named.push(side("bottom", (0..nx).map(|i| [at(i, 0), at(i + 1, 0)]).collect()));
        named.push(side("top", (0..nx).map(|i| [at(i, ny), at(i + 1, ny)]).collect()));
        named.push(side("left", (0..ny).map(|j| [at(0, j), at(0, j + 1)]).collect()));
        named.push(side("right", (0..ny).map(|j| [at(nx, j), at(nx, j + 1)]).collect()));
        members.push((material, (own..triangles.len()).collect()));
    }
    let count = triangles.len();
    let mesh = Mesh::with_pairs(vertices, triangles, named, pairs).unwrap();
    let parts = members.iter().map(|(material, own)| (*material, &own[..]));
    let materials = Materials::in_parts(blocks[0].material, count, parts);
    let problem = Problem::of(mesh, materials);
    pairs.iter().fold(problem, |problem, pair| problem.with_pair(pair.clone()))
}

/// Two unit squares, the one on the other, with so many cells along each side.
fn two_squares(cells: [usize; 2], materials: [Material<f64>; 2], pair: Pair) -> Problem {
    let (lower, upper) = (rectangle([0.0, 0.0], [1.0, 1.0]), rectangle([0.0, 1.0], [1.0, 2.0]));
    let block =
        |name, i: usize, map| Block { name, cells: [cells[i]; 2], material: materials[i], map };
    bodies(&[block("lower", 0, &lower), block("upper", 1, &upper)], &[pair])
}

/// Their pair, its sides in either order.
fn between(swapped: bool) -> Pair {
    let [first, second] = ["lower.top", "upper.bottom"];
    if swapped { Pair::new(second, first) } else { Pair::new(first, second) }
}

/// The lower one of modulus 1 by itself.
fn one_square(n: usize) -> Problem {
    let lower = rectangle([0.0, 0.0], [1.0, 1.0]);
    bodies(&[Block { name: "lower", cells: [n, n], material: young(1.0, 0.3), map: &lower }], &[])
}

fn method(degree: Degree) -> Method {
    Method { degree, ..Method::default() }
}

/// kappa on each triangle with an edge on Gamma_C.
fn with_kappa(degree: Degree, kappa: f64) -> Method {
    Method { degree, gamma0: Gamma0::Local(kappa), ..Method::default() }
}

/// A solution that is proved.
fn proved(problem: &Problem, method: &Method) -> Solution {
    let (solution, _) = solve(problem, method, &Settings::default()).unwrap();
    assert_eq!(solution.verdict.name(), "proved", "{:?}", solution.verdict);
    solution
}

/// The displacement that solves a discretization whose pieces `plant` has changed.
fn with_planted(
    problem: &Problem,
    method: &Method,
    plant: impl Fn(&Discretization) -> Vec<Piece>,
) -> Result<Vec<[f64; 2]>, SolveError> {
    let mut d = discretize(problem, method)?;
    d.contact = plant(&d);
    // A wrong problem need not be provable.
    let settings = Settings { proof: 0.99, ..Settings::default() };
    solve_discrete(&d, &settings).map(|(evaluated, ..)| evaluated.u)
}

/// The pieces with their geometry changed.
fn with_geometry(d: &Discretization, change: impl Fn(&mut PieceGeometry)) -> Vec<Piece> {
    let changed = |piece: &Piece| {
        let mut geometry = (*piece.geometry).clone();
        change(&mut geometry);
        let piece = Piece { geometry: Arc::new(geometry), ..piece.clone() };
        signorini::contact::residual::exact_piece(d, &piece)
    };
    d.contact.iter().map(changed).collect()
}

/// The pieces with the stress of each side (0 or 1) times a factor.
fn with_stress(d: &Discretization, factor: impl Fn(&Piece, usize) -> f64) -> Vec<Piece> {
    let changed = |piece: &Piece| {
        let mut changed = piece.clone();
        let positions: Vec<f64> = piece.degree.edge_positions().collect();
        for (i, side) in piece.sides.iter().enumerate() {
            let by = factor(piece, i);
            for j in side.entries.clone() {
                for (row, s) in changed.p0.iter_mut().zip(&positions) {
                    let stress = piece.sigma_n[0][j] * (1.0 - s) + piece.sigma_n[1][j] * *s;
                    row[j] += stress * (piece.gamma * (1.0 - by));
                }
                changed.sigma_n.iter_mut().for_each(|row| row[j] *= by);
            }
        }
        changed
    };
    d.contact.iter().map(changed).collect()
}

/// The largest distance between the values of two fields.
fn apart(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let off = a.iter().zip(b).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
    off.fold(0.0, f64::max)
}

fn size(v: Vector2<f64>) -> f64 {
    v[0].hypot(v[1])
}

fn largest(u: &[[f64; 2]]) -> f64 {
    u.iter().map(|u| u[0].hypot(u[1])).fold(0.0, f64::max)
}
