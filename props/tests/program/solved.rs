//! Certificates of solutions. The checker is generic over its numbers, so the same source runs here over exact rationals: what it
//! says in balls of doubles is compared with that. Its tests of signs are looked at by certificates that are wrong in a sign only
//! (`refusals`); the theorem itself by solutions that are known.

use std::f64::consts::PI;
use std::sync::Arc;

use approx::abs_diff_eq;
use proptest::prelude::*;
use signorini::certificates::proof::{Piece, Role};
use signorini::certificates::{Certificate, Continuous, certify, certify_field};
use signorini::io::Expression;
use signorini::kernel::{Ball, Enclosing, Material, Plane};
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Problem, Rectangle, SharedFunction, quadrature};
use signorini::nalgebra::Matrix2;
use signorini::solve::{Method, Settings, solve};

use props::claim::text;
use props::ensure;
use props::naive::{Field, Hooke, integral_of_quadratics};
use props::numbers::Exact;
use props::problems::{cells, diagonals, problem};
use props::proof::sampler::Random;
use props::verdict::Verdict;

/// a + b x, as a function that knows its degree.
fn affine(a: f64, b: f64) -> SharedFunction {
    if b == 0.0 {
        return Arc::new(Expression::from(a));
    }
    let text = format!("{a:?} + {b:?}*x");
    Arc::new(text.parse::<Expression>().unwrap_or_else(|_| Expression::from(f64::NAN)))
}

/// A body of cells of size 1 that is held at the top and loaded, on a floor. Data in sixteenths.
#[derive(Clone, Debug)]
pub struct Draw {
    pub cells: [usize; 2],
    diagonal: Diagonal,
    lambda: f64,
    pub load: [f64; 2],
    /// By how much it grows with x.
    pub slope: [f64; 2],
    /// g = g0 + g1 x
    gap: [f64; 2],
    /// The displacement of the top.
    push: [f64; 2],
    pressure: f64,
}

pub fn bodies(most: usize) -> impl Strategy<Value = Draw> {
    let part = |range: std::ops::RangeInclusive<i32>| range.prop_map(|k| f64::from(k) / 16.0);
    let lambda = prop::sample::select(&[0.0, 1.0, 4.0]);
    let data = (part(-16..=16), part(-16..=4), part(-2..=4), part(-4..=4), part(-2..=2));
    let slope =
        prop_oneof![Just([0.0; 2]), (part(-16..=16), part(-4..=4)).prop_map(<[f64; 2]>::from)];
    (1..=most, 1..=most, diagonals(), lambda, data, part(-2..=2), part(0..=8), slope).prop_map(
        |(nx, ny, diagonal, lambda, (fx, fy, g0, g1, ux), uy, pressure, slope)| Draw {
            cells: [nx, ny],
            diagonal,
            lambda,
            load: [fx, fy],
            slope,
            gap: [g0, g1],
            push: [ux, uy],
            pressure,
        },
    )
}

impl Draw {
    fn problem(&self) -> Result<Problem, String> {
        self.problem_on(1)
    }

    /// The same body with each side of a cell divided into `finer` parts.
    fn problem_on(&self, finer: usize) -> Result<Problem, String> {
        let [width, height] = self.cells.map(|n| n as f64);
        let [nx, ny] = self.cells.map(|n| n * finer);
        let mesh = Rectangle { width, height, nx, ny, diagonal: self.diagonal }.mesh();
        let push = self.push.map(|u| Some(affine(u, 0.0)));
        let conditions = [
            ("top", Condition::Displacement(push)),
            ("left", Condition::Pressure(affine(self.pressure, 0.0))),
            ("bottom", Condition::Contact { gap: affine(self.gap[0], self.gap[1]) }),
        ];
        let load = [0, 1].map(|c| affine(self.load[c], self.slope[c]));
        let material = Material::lame(self.lambda, 1.0, Plane::Strain);
        Ok(problem(mesh.map_err(text)?, material, load, conditions))
    }

    pub fn certified_with(
        &self,
        degree: Degree,
    ) -> Result<(Problem, Vec<[f64; 2]>, Continuous), String> {
        certified(self.problem()?, degree)
    }

    /// By P1, with each side of a cell divided into `finer` parts.
    pub fn certified_on(
        &self,
        finer: usize,
    ) -> Result<(Problem, Vec<[f64; 2]>, Continuous), String> {
        certified(self.problem_on(finer)?, Degree::One)
    }
}

fn certified(
    problem: Problem,
    degree: Degree,
) -> Result<(Problem, Vec<[f64; 2]>, Continuous), String> {
    let method = Method { degree, ..Method::default() };
    let solved = solve(&problem, &method, &Settings::default());
    let (solution, _) = solved.map_err(text)?;
    let certified = certify(&problem, &solution).map_err(text)?;
    if !certified.rigorous {
        return Err("data of the exact class are not known to be".to_owned());
    }
    Ok((problem, solution.displacement, certified))
}

/// How a certificate sees its contact line.
fn class(certificate: &Certificate) -> &'static str {
    let mut contact = certificate.edges.iter().filter_map(|edge| match edge.role {
        Role::Contact { pressure, .. } => Some(pressure),
        _ => None,
    });
    // Beside a quadratic v all edges are cut in the middle.
    if certificate.cuts.iter().any(|cut| certificate.curved.is_none() || cut.at != 0.5) {
        "an edge is cut"
    } else if contact.any(|pressure| pressure != [0.0; 2]) {
        "contact"
    } else {
        "no contact"
    }
}

/// u, the relative error of a rounded result.
const UNIT: f64 = f64::EPSILON / 2.0;

/// By how many u F a force may be unknown, F the largest: the bodies have at most 16 triangles, and certificates four times as
/// many beside a quadratic v; each adds its resultant to the sum that is carried along the tree, a hundred operations on moments
/// of terms up to 4 F, and the hold that takes what is left has the lever |E|/6: 64 * 100 * 4 * 6, rounded up.
const CARRIED: f64 = 262_144.0;

/// By how much balls may exceed the share q of triangle `t`: what rounding does to its forces, times what its shape makes of
/// that. With the longest edge h and J = 2 |T|, forces that are unknown by r leave N_k . G_i - N_i . G_k unknown by 4 h r, the
/// jump c by 36 h r / J^2 and the stress at corners and centre by D = 48 h^3 r / J^2 (`kernel::composite`): a triangle that was
/// cut off as a sliver loses the square of its slenderness. The square form of the energy of (D, D, D) is at most e = 7/4 J D^2 /
/// mu, as lambda >= 0, and |q(s + d) - q(s)| <= 2 (q e)^(1/2) + e.
fn lost(certificate: &Certificate, t: usize, q: f64) -> f64 {
    let at = |p: usize| {
        let known = certificate.vertices.get(p).copied();
        known.unwrap_or_else(|| {
            let cut = certificate.cuts[p - certificate.vertices.len()];
            let [a, b] = cut.ends.map(|end| certificate.vertices[end]);
            [0, 1].map(|c| a[c] + cut.at * (b[c] - a[c]))
        })
    };
    let apart = |[p, q]: [usize; 2]| {
        let (p, q) = (at(p), at(q));
        [q[0] - p[0], q[1] - p[1]]
    };
    let long = |ends: [usize; 2]| {
        let [x, y] = apart(ends);
        x.hypot(y)
    };
    let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let force = certificate.edges.iter().fold(0.0, |most: f64, edge| {
        most.max(match edge.role {
            Role::Inner(force) | Role::Held(_, force) => largest(force.as_flattened()),
            Role::Supported { force, traction, .. } => {
                largest(&force) + largest(&traction) * long(edge.ends)
            }
            Role::Loaded(traction) => largest(traction.as_flattened()) * long(edge.ends),
            Role::Pressed(p) | Role::Contact { pressure: p, .. } => largest(&p) * long(edge.ends),
            // That of the edge which it faces.
            Role::Facing => 0.0,
        })
    });
    let piece = &certificate.pieces[t];
    let [a, b, c] = piece.vertices;
    let (u, v) = (apart([a, b]), apart([a, c]));
    let double_area = u[0] * v[1] - u[1] * v[0];
    let h = long([a, b]).max(long([b, c])).max(long([c, a]));
    let stress = 48.0 * h.powi(3) * CARRIED * UNIT * force / (double_area * double_area);
    let energy = 1.75 * double_area * stress * stress / piece.material.mu();
    2.0 * (q * energy).sqrt() + energy
}

/// The checker in the numbers `S` against the checker in rationals: no share and no bound is smaller, the energies enclose,
/// and all that is lost is rounding.
pub fn above_the_rationals<S: Enclosing>(draw: &Draw, degree: Degree) -> Verdict {
    let Ok((_, _, certified)) = draw.certified_with(degree) else {
        return Verdict::Fails("there is a certificate");
    };
    let certificate = certified.certificate;
    let (Ok(exact), Ok(found)) =
        (Exact::scope(|| certificate.evaluate::<Exact>()), certificate.evaluate::<S>())
    else {
        return Verdict::Fails("both accept");
    };
    // Rationals come back as the nearest doubles outside.
    ensure!(found.bound >= exact.bound && found.norm <= exact.norm);
    ensure!(found.energy[0] <= exact.energy[0] && exact.energy[1] <= found.energy[1]);
    // A thousand operations on terms as large as the square of the bound or of the norm.
    let rounding = 1000.0 * UNIT * (exact.norm * exact.norm + exact.bound * exact.bound);
    let mut whole = rounding;
    for (t, (found, exact)) in found.shares.iter().zip(&exact.shares).enumerate() {
        let lost = lost(&certificate, t, *exact);
        ensure!(found >= exact);
        ensure!(found - exact <= lost + rounding);
        whole += lost;
    }
    ensure!(found.bound * found.bound - exact.bound * exact.bound <= whole);
    Verdict::Holds(class(&certificate))
}

/// J(u) lies in the intervals of a coarse and of a fine mesh; and so does L(u) where nothing but loads acts, where alone it
/// is bounded. The intervals are shortened from below to a `share` of their length.
pub fn energies_agree(draw: &Draw, share: f64) -> Verdict {
    // A third each: loads alone, loads and a gap, and displacements too.
    let draw = match draw.pressure {
        p if p < 0.1875 => Draw { gap: [0.0; 2], push: [0.0; 2], ..draw.clone() },
        p if p < 0.375 => Draw { push: [0.0; 2], ..draw.clone() },
        _ => draw.clone(),
    };
    let certified = |finer: usize| -> Result<_, String> {
        let problem = draw.problem_on(finer)?;
        let solved = solve(&problem, &Method::default(), &Settings::default());
        let (solution, _) = solved.map_err(text)?;
        Ok((solution.quantities.work, certify(&problem, &solution).map_err(text)?))
    };
    let (Ok((_, coarse)), Ok((work, fine))) = (certified(1), certified(4)) else {
        return Verdict::Fails("there are certificates");
    };
    let (Some(one), Some(other)) = (coarse.energy, fine.energy) else {
        return Verdict::Fails("J(u) is bounded");
    };
    let low = |[low, high]: [f64; 2]| high - share * (high - low);
    ensure!(low(one) <= other[1] && low(other) <= one[1]);
    let nothing_else = draw.gap == [0.0; 2] && draw.push == [0.0; 2];
    ensure!(coarse.compliance.is_some() == nothing_else);
    ensure!(fine.compliance.is_some() == nothing_else);
    let (Some([c_low, c_high]), Some([f_low, f_high])) = (coarse.compliance, fine.compliance)
    else {
        return Verdict::Holds(if draw.push == [0.0; 2] { "a gap" } else { "displacements" });
    };
    ensure!(c_low <= f_high && f_low <= c_high);
    // L(u^h) on the fine mesh is as near to L(u) as the interval there is long, and rounded.
    let off = (f_high - f_low) + 1e-12 * f_high.abs();
    ensure!(f_low - off <= work && work <= f_high + off);
    Verdict::Holds("loads only")
}

/// a(u - v, u - v)^(1/2) for two fields of P1.
fn distance(problem: &Problem, u: &[[f64; 2]], v: &[[f64; 2]]) -> f64 {
    let mesh = &problem.mesh;
    let squares = mesh.triangles().iter().enumerate().map(|(t, corners)| {
        let nodal = corners.map(|k| [0, 1].map(|c| u[k][c] - v[k][c])).to_vec();
        let off = Field { vertices: corners.map(|k| mesh.vertices()[k]), nodal };
        let [lambda, mu] = [problem.material.of(t).lambda(), problem.material.of(t).mu()];
        off.energy(&off, &Hooke::Isotropic { lambda, mu })
    });
    squares.sum::<f64>().max(0.0).sqrt()
}

/// Our solution and the same moved at random, both with their bounds: their distance is at most the sum, times `factor`.
pub fn raised_by_a_perturbation(draw: &Draw, size: f64, factor: f64) -> Verdict {
    let moved = || -> Result<_, String> {
        let problem = draw.problem()?;
        let solved = solve(&problem, &Method::default(), &Settings::default());
        let (solution, _) = solved.map_err(text)?;
        let steps =
            super::random_field(&mut Random::new(7), solution.displacement.len()).into_iter();
        let field: Vec<[f64; 2]> = (solution.displacement.iter().zip(steps))
            .map(|(u, d)| [0, 1].map(|c| u[c] + size * d[c] / 2.0))
            .collect();
        let own = certify(&problem, &solution).map_err(text)?;
        let other = certify_field(&problem, &solution, &field).map_err(text)?;
        let apart = distance(&problem, &solution.displacement, &field);
        Ok((apart, own.of_field, other.of_field))
    };
    let Ok((apart, own, other)) = moved() else { return Verdict::Fails("there are bounds") };
    // The distance is a sum of doubles.
    ensure!(apart * (1.0 - 1e-12) <= own + factor * other);
    Verdict::Holds(if other > 2.0 * own { "far" } else { "near" })
}

/// A displacement of degree 2 that is a solution: it touches the floor everywhere, without friction, the top is held as it is,
/// and on the other sides its tractions act. Coefficients of 1, x, y, x^2, x y, y^2 in sixteenths.
#[derive(Clone, Debug)]
pub struct Patch {
    cells: [usize; 2],
    diagonal: Diagonal,
    lambda: f64,
    u: [[f64; 6]; 2],
}

pub fn patches() -> impl Strategy<Value = Patch> {
    let lambda = prop::sample::select(&[0.0, 1.0, 4.0]);
    let part = || (-8..=8_i32).prop_map(|k| f64::from(k) / 16.0);
    let all = prop::collection::vec(part(), 12);
    (1..=3_usize, 1..=3_usize, diagonals(), lambda, all).prop_map(
        |(nx, ny, diagonal, lambda, a)| {
            let mut u = [0, 1].map(|c| std::array::from_fn(|k| a[6 * c + k]));
            // sigma_xy = 0 and sigma_yy < 0 where y = 0.
            (u[1][1], u[0][4]) = (-u[0][2], -2.0 * u[1][3]);
            u[1][2] -= 16.0;
            Patch { cells: [nx, ny], diagonal, lambda, u }
        },
    )
}

impl Patch {
    /// sum of a_k x^i y^j
    fn function(a: [f64; 6]) -> Result<SharedFunction, String> {
        let [c, x, y, xx, xy, yy] = a;
        let text = format!("{c:?} + {x:?}*x + {y:?}*y + {xx:?}*x*x + {xy:?}*x*y + {yy:?}*y*y");
        Ok(Arc::new(text.parse::<Expression>().map_err(|e| e.to_string())?))
    }

    fn certified(&self, degree: Degree) -> Result<Continuous, String> {
        let cells = cells(self.cells, self.diagonal);
        let (mesh, width) = (cells.mesh(), cells.width);
        let [a, b] = self.u;
        // sigma_xx and sigma_xy of the sides, by their multiples of 1, x, y.
        let l = self.lambda;
        let trace = [a[1] + b[2], 2.0 * a[3] + b[4], a[4] + 2.0 * b[5]];
        let xx = [l * trace[0] + 2.0 * a[1], l * trace[1] + 4.0 * a[3], l * trace[2] + 2.0 * a[4]];
        let xy = [a[2] + b[1], a[4] + 2.0 * b[3], 2.0 * a[5] + b[4]];
        let side = |x: f64, n: f64| -> Result<Condition, String> {
            let along =
                |s: [f64; 3]| Self::function([n * (s[0] + s[1] * x), 0.0, n * s[2], 0.0, 0.0, 0.0]);
            Ok(Condition::Traction([along(xx)?, along(xy)?]))
        };
        let top = [Some(Self::function(a)?), Some(Self::function(b)?)];
        let gap = Self::function([-b[0], -b[1], 0.0, -b[3], 0.0, 0.0])?;
        let conditions = [
            ("left", side(0.0, -1.0)?),
            ("right", side(width, 1.0)?),
            ("top", Condition::Displacement(top)),
            ("bottom", Condition::Contact { gap }),
        ];
        // div sigma(u), mu = 1
        let laplacian = self.u.map(|u| 2.0 * (u[3] + u[5]));
        let of_divergence = [2.0 * a[3] + b[4], a[4] + 2.0 * b[5]];
        let force =
            |c: usize| affine(-(laplacian[c] + (self.lambda + 1.0) * of_divergence[c]), 0.0);
        let material = Material::lame(self.lambda, 1.0, Plane::Strain);
        let problem = problem(mesh.map_err(text)?, material, [0, 1].map(force), conditions);
        let method = Method { degree, ..Method::default() };
        let (solution, _) = solve(&problem, &method, &Settings::default()).map_err(text)?;
        certify(&problem, &solution).map_err(text)
    }
}

/// v is u and tau is sigma(u), but for rounding: v is kept off the floor by some 1e-9, 64 units of rounding of the gap over the
/// least part of an edge, 1e-3, and the bound has the root of what the pressure, below a thousand, does over that.
pub fn known_to_rounding(patch: &Patch, degree: Degree) -> Verdict {
    let Ok(certified) = patch.certified(degree) else {
        return Verdict::Fails("there is a certificate");
    };
    // |C eps(v) - tau| on the triangles away from the floor.
    let certificate = &certified.certificate;
    let floor = |piece: &Piece| {
        let touches = |&e: &usize| matches!(certificate.edges[e].role, Role::Contact { .. });
        piece.edges.iter().any(touches)
    };
    for (piece, share) in certificate.pieces.iter().zip(&certified.proof.shares) {
        let off = share.max(0.0).sqrt();
        ensure!(off <= certified.proof.norm * if floor(piece) { 1e-4 } else { 1e-9 });
    }
    let curved = patch.u.iter().flat_map(|u| &u[3..]).any(|&a| a != 0.0);
    Verdict::Holds(if curved { "quadratic" } else { "affine" })
}

/// c x (1 - x): 0 at both ends of a side of length 1.
fn bent(c: f64) -> SharedFunction {
    let text = format!("{c:?}*x*(1 - x)");
    Arc::new(text.parse::<Expression>().unwrap_or_else(|_| Expression::from(f64::NAN)))
}

/// The unit square over a floor that it does not reach, its top bent, a load that varies, all of it times `scale`.
fn bent_body(
    draw: &Draw,
    load: f64,
    scale: f64,
    finer: usize,
) -> Result<(Problem, Continuous), String> {
    let square = Draw { cells: [1, 1], ..draw.clone() };
    let mut problem = square.problem_on(finer)?;
    let top = draw.push.map(|u| Some(bent(scale * u)));
    let gap = Condition::Contact { gap: affine(64.0 * scale, 0.0) };
    problem.conditions = [("top", Condition::Displacement(top)), ("bottom", gap)]
        .map(|(name, condition)| (name.to_owned(), condition))
        .into();
    problem.body_force = draw.load.map(|f| bent(scale * load * f));
    let solved = solve(&problem, &Method::default(), &Settings::default());
    let (solution, _) = solved.map_err(text)?;
    let certified = certify(&problem, &solution).map_err(text)?;
    Ok((problem, certified))
}

/// Displacements that are 0 at the vertices of the coarse mesh, where v = 0: what they lack between the vertices is in its
/// bound, and in that of the fine mesh. `lacking` tells whether that is left in.
pub fn between_the_vertices(draw: &Draw, lacking: bool) -> Verdict {
    if draw.push == [0.0; 2] {
        return Verdict::Vacuous;
    }
    let (Ok((_, coarse)), Ok((problem, fine))) =
        (bent_body(draw, 0.0, 1.0, 1), bent_body(draw, 0.0, 1.0, 8))
    else {
        return Verdict::Fails("there are certificates");
    };
    let v = &fine.certificate.displacement;
    let size = distance(&problem, v, &vec![[0.0; 2]; v.len()]);
    let bound = |c: &Continuous| {
        let mut exact = c.certificate.clone();
        exact.pieces.iter_mut().for_each(|piece| piece.oscillation = 0.0);
        let without = || exact.evaluate::<Ball>().map_or(f64::INFINITY, |proof| proof.bound);
        if lacking { c.bound } else { without() }
    };
    ensure!(size * (1.0 - 1e-9) <= bound(&coarse) + bound(&fine));
    Verdict::Holds("always")
}

/// K of Korn's inequality on a right triangle with equal legs (docs/a-posteriori.md, 7.4): by the radius of its inner circle, (1 + 1 -
/// root 2)/2 beside the distance to the corner that is farthest from the centre of that.
fn korns_constant() -> f64 {
    let inner = 1.0 - 0.5_f64.sqrt();
    let ratio = inner / (1.0 - inner).hypot(inner);
    let beta = ratio / (2.0 + 2.0 * (1.0 - ratio * ratio).sqrt()).sqrt();
    (1.0 + 2.0 / (beta * beta)).sqrt()
}

/// What the load costs on each triangle of the coarse mesh, and what the bent top does, by their definitions times `share`.
pub fn costs(draw: &Draw, share: f64) -> Verdict {
    if draw.push == [0.0; 2] {
        return Verdict::Vacuous;
    }
    let still = Draw { push: [0.0; 2], ..draw.clone() };
    let (Ok((_, loaded)), Ok((_, moved))) =
        (bent_body(&still, 1.0, 1.0, 1), bent_body(draw, 0.0, 1.0, 1))
    else {
        return Verdict::Fails("there are certificates");
    };
    let stiffness = 2.0 * f64::min(1.0, draw.lambda + 1.0);
    for piece in &loaded.certificate.pieces {
        let corners = piece.vertices.map(|k| loaded.certificate.vertices[k]);
        let triangle = Field { vertices: corners, nodal: Vec::new() };
        let [a, b, c] = corners;
        let h = [(a, b), (b, c), (c, a)]
            .iter()
            .fold(0.0, |h: f64, (p, q)| h.max((p[0] - q[0]).hypot(p[1] - q[1])));
        // The load is quadratic, and what is taken for it affine.
        let square: f64 = (0..2)
            .map(|d| {
                let affine = |k: usize| match k {
                    0..3 => piece.body[k][d],
                    _ => (piece.body[(k + 1) % 3][d] + piece.body[(k + 2) % 3][d]) / 2.0,
                };
                let places = triangle.places();
                let off = std::array::from_fn(|k| {
                    draw.load[d] * places[k][0] * (1.0 - places[k][0]) - affine(k)
                });
                integral_of_quadratics(triangle.area(), off, off)
            })
            .sum();
        let expected = share * korns_constant() * h / PI * (square / stiffness).sqrt();
        ensure!(abs_diff_eq!(piece.oscillation, expected, epsilon = 1e-9 * expected + 1e-12));
    }
    // z = (1 - l) d(s), l the coordinate of the corner opposite the top, s along rays from it.
    let material = Material::lame(draw.lambda, 1.0, Plane::Strain);
    let at_top = |k: &&usize| moved.certificate.vertices[**k][1] == 1.0;
    let of_top =
        moved.certificate.pieces.iter().find(|p| p.vertices.iter().filter(at_top).count() == 2);
    let Some(piece) = of_top else { return Verdict::Fails("a triangle at the top") };
    let Some(o) = (0..3).find(|&i| moved.certificate.vertices[piece.vertices[i]][1] < 1.0) else {
        return Verdict::Fails("a corner opposite the top");
    };
    let [o, p, q] = [0, 1, 2].map(|i| moved.certificate.vertices[piece.vertices[(o + i) % 3]]);
    let double_area = (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
    let opposite = [(p[1] - q[1]) / double_area, (q[0] - p[0]) / double_area];
    let end = [(o[1] - p[1]) / double_area, (p[0] - o[0]) / double_area];
    let mut square = 0.0;
    // A polynomial of degree 4 in s.
    for (s, weight) in quadrature::gauss(3) {
        let g = Matrix2::from_fn(|i, j| {
            let (value, slope) = (draw.push[i] * s * (1.0 - s), draw.push[i] * (1.0 - 2.0 * s));
            slope * (end[j] + s * opposite[j]) - value * opposite[j]
        });
        let [xx, yy, xy] = material.stress(g).components();
        let density = xx * g.m11 + yy * g.m22 + xy * (g.m12 + g.m21);
        square += weight * density * double_area / 2.0;
    }
    ensure!(abs_diff_eq!(
        moved.certificate.lift(),
        share * square.sqrt(),
        epsilon = 1e-9 * moved.certificate.lift()
    ));
    let together = moved.proof.bound.hypot(moved.certificate.lift());
    ensure!(abs_diff_eq!(moved.bound, together, epsilon = 1e-12 * together));
    Verdict::Holds("always")
}

/// All data times 2^-10: so is the bound. With `load` another one for the scaled body.
pub fn scaled(draw: &Draw, load: f64) -> Verdict {
    let scale = 2.0_f64.powi(-10);
    let (Ok((_, whole)), Ok((_, small))) =
        (bent_body(draw, 1.0, 1.0, 2), bent_body(draw, load, scale, 2))
    else {
        return Verdict::Fails("there are certificates");
    };
    // Both are sums of doubles.
    ensure!(abs_diff_eq!(small.bound, scale * whole.bound, epsilon = 1e-9 * small.bound));
    Verdict::Holds("always")
}
