//! Compares a certificate with a problem: its triangles cut up those of the problem's mesh, and what is given on them,
//! materials, supports, loads and obstacles, is what the problem says there, to rounding; what is measured by quadrature is
//! measured again.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;
use thiserror::Error;

use super::certificate::{Certificate, Curved, Edge, Law, Lift, Role, is_oblique, place};
use super::data::{Data, length_and_normal};
use super::errors::CertifyError;
use super::forces::Evidence;
use super::oscillation::{self, Oscillation};
use super::parts::{Boundary, ProblemParts};
use super::{adapt, build};
use crate::contact::contact_line;
use crate::kernel::{Material, Triangle};
use crate::model::mesh::bisection::Refinement;
use crate::model::mesh::length;
use crate::model::rigid::Parts;
use crate::model::{BoundaryEdge, Degree, Mesh, MeshError, Problem, Space};

/// Numbers that differ by this, in units of the largest of their kind, are the same.
const ROUNDING: f64 = 1e-11;

/// Places on an edge that differ by this part of the edge are the same.
const PLACES: f64 = 1e-9;

/// Returns whether a stretch of an edge, from one place to another, lies in one.
fn is_in([s, t]: [f64; 2], [low, high]: [f64; 2]) -> bool {
    s >= low - PLACES && t <= high + PLACES
}

/// Returns whether a stretch of an edge has no more than an end in common with another.
fn is_off([s, t]: [f64; 2], [low, high]: [f64; 2]) -> bool {
    t <= low + PLACES || s >= high - PLACES
}

/// The part of a triangle by which places outside it lie in it: what is the same for other numbers, and the rounding of its own
/// coordinates.
fn room(mesh: &Mesh, t: usize) -> f64 {
    let triangle = mesh.triangle(t);
    let far = triangle.vertices.iter().fold(0.0, |far: f64, x| far.max(x.amax()));
    let longest = (0..3).map(|i| length(triangle.edge(i))).fold(0.0, f64::max);
    ROUNDING + 16.0 * f64::EPSILON * far * longest / triangle.double_area()
}

/// Between chord and curve of the round contact edges of a mesh, where `[adapt]` places vertices: for each triangle with such edges how far
/// the curve lies beside each of them, in heights of the triangle.
struct Round(BTreeMap<usize, [f64; 3]>);

impl Round {
    fn of(problem: &Problem) -> Round {
        let mesh = &problem.mesh;
        let mut beside: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        for (edge, middle) in adapt::round_contact(problem) {
            let [a, b] = mesh.places_of_ends(edge).map(Vector2::from);
            let height = mesh.triangle(edge.triangle).double_area() / length(b - a);
            let sagitta = length(Vector2::from(middle) - (a + b) / 2.0);
            // Curves through the vertices of a finer mesh differ from those of this one.
            let share = 1.25 * sagitta / height;
            if share < 0.5 {
                beside.entry(edge.triangle).or_default()[edge.local] = share;
            }
        }
        Round(beside)
    }

    fn beside(&self, triangle: usize) -> [f64; 3] {
        self.0.get(&triangle).copied().unwrap_or_default()
    }

    fn whole(&self, triangle: usize) -> f64 {
        self.beside(triangle).iter().sum()
    }
}

/// Why a certificate is not one of a problem.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum Difference {
    #[error("{what} {index} has {found}; the case says {expected}")]
    Data { what: &'static str, index: usize, found: String, expected: String },
    #[error("{what} {index} {problem}")]
    Place { what: &'static str, index: usize, problem: &'static str },
    #[error(transparent)]
    Certify(#[from] CertifyError),
    #[error("its triangles are no mesh: {0}")]
    Mesh(#[from] MeshError),
}

/// Compares a `certificate` that an audit has accepted, and the names of the boundaries of its `forces`, with a `problem`, on
/// its mesh or on one that refines it. Returns why the bound is not rigorous for that, if it is not: the numbers don't know
/// how the data of the problem were rounded.
///
/// # Errors
/// The first difference.
pub fn compare(
    problem: Problem,
    certificate: &Certificate,
    forces: &Evidence,
) -> Result<Option<String>, Difference> {
    let (refinement, origins) = refinement(&problem, certificate)?;
    let problem = problem.refined(refinement);
    // Between the middles of a triangle's edges lies the fourth of its quarters.
    let vertices = certificate.vertices.len();
    let quartered = certificate.pieces.iter().any(|t| t.vertices.iter().all(|&p| p >= vertices));
    let vertices = problem.mesh.vertices().len();
    let (degree, nodes) = if quartered {
        (Degree::Two, vertices + problem.mesh.edge_count())
    } else {
        (Degree::One, vertices)
    };
    // The data don't depend on gamma0.
    let space = Space::new(&problem.mesh, degree);
    let pieces = contact_line::assemble(&problem, &space, 1.0).map_err(CertifyError::Data)?;
    let at_rest = (&*vec![[0.0; 2]; nodes], false);
    let parts = ProblemParts::new(&problem, degree, &pieces, at_rest)?;
    let (lengths, loads) = sizes(certificate);
    let sides = sides(&problem.mesh);
    let comparison = Comparison { certificate, parts: &parts, sides, lengths, loads };
    comparison.points()?;
    for (e, edge) in certificate.edges.iter().enumerate() {
        if !matches!(edge.role, Role::Inner(_)) {
            comparison.edge(e, edge)?;
        }
    }
    comparison.names(forces)?;
    let lacking = build::polygon(&problem.mesh, certificate);
    if let Some(&e) = lacking.iter().find(|e| !certificate.polygon.contains(e)) {
        return Err(outside("edge", e, "does not say that it is part of a curved boundary"));
    }
    comparison.pieces(&origins)?;
    comparison.lifts()?;
    Ok(Oscillation::new(&parts, certificate.curved.is_some()).reason)
}

fn outside(what: &'static str, index: usize, problem: &'static str) -> Difference {
    Difference::Place { what, index, problem }
}

/// The vertices that points are or lie between.
fn corners(certificate: &Certificate, points: &[usize]) -> Vec<usize> {
    let vertices = certificate.vertices.len();
    let of = |&p: &usize| match p.checked_sub(vertices) {
        None => vec![p],
        Some(cut) => certificate.cuts[cut].ends.to_vec(),
    };
    let all: BTreeSet<usize> = points.iter().flat_map(of).collect();
    all.into_iter().collect()
}

pub(super) fn sorted([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// The triangles that the pieces of a certificate are parts of, as a refinement of the problem's mesh, and which of them each piece is a part
/// of. Each point of a piece is a corner of its triangle, or lies between two.
fn refinement(
    problem: &Problem,
    certificate: &Certificate,
) -> Result<(Refinement, Vec<usize>), Difference> {
    let mesh = &problem.mesh;
    let at = |k: usize| Vector2::from(certificate.vertices[k]);
    let mut numbers = BTreeMap::new();
    let mut wholes: Vec<[usize; 3]> = Vec::new();
    let mut origins = Vec::with_capacity(certificate.pieces.len());
    let mut first = Vec::new();
    for (i, piece) in certificate.pieces.iter().enumerate() {
        let Ok([a, b, c]) = <[usize; 3]>::try_from(corners(certificate, &piece.vertices)) else {
            return Err(outside("triangle", i, "is no part of one between three vertices"));
        };
        let number = *numbers.entry([a, b, c]).or_insert_with(|| {
            let [x, y, z] = [a, b, c].map(at);
            wholes.push(if (y - x).perp(&(z - x)) > 0.0 { [a, b, c] } else { [a, c, b] });
            first.push(i);
            wholes.len() - 1
        });
        origins.push(number);
    }
    let (parts, bodies) = bodies(mesh, certificate, &wholes)?;
    let round = Round::of(problem);
    let mut found: Vec<([usize; 3], usize)> = Vec::with_capacity(wholes.len());
    for ((whole, i), body) in wholes.into_iter().zip(first).zip(bodies) {
        let places = whole.map(at);
        let middle = places.iter().sum::<Vector2<f64>>() / 3.0;
        let is_of_body = |t: usize| parts.of_triangle()[t] == body;
        let within = |t: usize| {
            let room = room(mesh, t) + round.whole(t);
            let inside = |&x: &Vector2<f64>| coordinates(mesh, t, x).iter().all(|&l| l >= -room);
            places.iter().all(inside)
        };
        let located = mesh.locate_among(middle.into(), is_of_body).map(|(origin, _)| origin);
        // The middle of a triangle between chord and curve may lie in no triangle, or in the next one.
        let beside = round.0.keys().copied().filter(|&t| is_of_body(t));
        let origin = located.into_iter().chain(beside).find(|&t| within(t));
        let beyond = || outside("triangle", i, "lies in no triangle of the case's mesh");
        found.push((whole, origin.ok_or_else(beyond)?));
    }
    let mut areas = vec![0.0; mesh.triangles().len()];
    for (piece, &number) in certificate.pieces.iter().zip(&origins) {
        let triangle = Triangle { vertices: piece.vertices.map(|p| place(certificate, p)) };
        areas[found[number].1] += triangle.double_area();
    }
    for (t, area) in areas.iter().enumerate() {
        let whole = mesh.triangle(t).double_area();
        if !((area - whole).abs() <= (4.0 * room(mesh, t) + 2.0 * round.whole(t)) * whole) {
            return Err(outside("triangle", t, "of the case's mesh is not covered once"));
        }
    }
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by_key(|&k| found[k].1);
    let mut place_of = vec![0; order.len()];
    order.iter().enumerate().for_each(|(to, &from)| place_of[from] = to);
    origins.iter_mut().for_each(|number| *number = place_of[*number]);
    let (triangles, origin): (Vec<_>, Vec<_>) = order.iter().map(|&k| found[k]).unzip();
    let named = named((mesh, &round), certificate, &triangles, &origin)?;
    let vertices = certificate.vertices.clone();
    let fine = Mesh::with_pairs(vertices, triangles, named, &problem.pairs)?;
    Ok((Refinement { mesh: fine, parents: Vec::new(), origin }, origins))
}

/// The bodies of `mesh`, and the one that each of the triangles belongs to that are parts of its own: the one in which most of the
/// triangles lie that hang together with it. Places alone do not tell where bodies of a pair overlap.
fn bodies(
    mesh: &Mesh,
    certificate: &Certificate,
    triangles: &[[usize; 3]],
) -> Result<(Parts, Vec<usize>), Difference> {
    let parts = Parts::new(mesh);
    if parts.count() == 1 {
        return Ok((parts, vec![0; triangles.len()]));
    }
    let (vertices, fine) = (certificate.vertices.clone(), triangles.to_vec());
    let fine = Mesh::of_edges(vertices, fine, vec![], &|_, _| true)?;
    let of_fine = Parts::new(&fine);
    let mut areas = vec![vec![0.0; parts.count()]; of_fine.count()];
    for (t, &part) in of_fine.of_triangle().iter().enumerate() {
        let triangle = fine.triangle(t);
        if let Some((origin, _)) = mesh.locate(triangle.point([1.0 / 3.0; 3]).into()) {
            areas[part][parts.of_triangle()[origin]] += triangle.double_area();
        }
    }
    let largest = |areas: &Vec<f64>| {
        (0..areas.len()).max_by(|&i, &j| areas[i].total_cmp(&areas[j])).unwrap_or_default()
    };
    let body: Vec<usize> = areas.iter().map(largest).collect();
    let bodies = of_fine.of_triangle().iter().map(|&part| body[part]).collect();
    Ok((parts, bodies))
}

/// The barycentric coordinates of `x` in triangle `t`.
fn coordinates(mesh: &Mesh, t: usize, x: Vector2<f64>) -> [f64; 3] {
    let triangle = mesh.triangle(t);
    let gradients = triangle.barycentric_gradients();
    [0, 1, 2].map(|i| gradients[i].dot(&(x - triangle.vertices[(i + 1) % 3])))
}

/// The boundaries of `mesh` by the edges of triangles that are parts of its own.
fn named(
    (mesh, round): (&Mesh, &Round),
    certificate: &Certificate,
    triangles: &[[usize; 3]],
    origin: &[usize],
) -> Result<BTreeMap<String, Vec<[usize; 2]>>, Difference> {
    let mut alone: BTreeMap<[usize; 2], (usize, [usize; 2])> = BTreeMap::new();
    for (t, corners) in triangles.iter().enumerate() {
        for i in 0..3 {
            let ends = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
            if alone.remove(&sorted(ends)).is_none() {
                alone.insert(sorted(ends), (t, ends));
            }
        }
    }
    let mut names: BTreeMap<(usize, usize), Vec<&str>> = BTreeMap::new();
    names.extend(mesh.outline().iter().map(|edge| ((edge.triangle, edge.local), Vec::new())));
    for name in mesh.boundary_names() {
        // Curves inside the body are no boundaries.
        for &BoundaryEdge { triangle, local } in mesh.edges_of(name).unwrap_or_default() {
            names.entry((triangle, local)).or_default().push(name);
        }
    }
    let mut named: BTreeMap<String, Vec<[usize; 2]>> = BTreeMap::new();
    for (t, ends) in alone.into_values() {
        let l = ends.map(|k| coordinates(mesh, origin[t], certificate.vertices[k].into()));
        let (room, beside) = (room(mesh, origin[t]), round.beside(origin[t]));
        let off = |i: usize| l.iter().map(|l| l[i].abs()).fold(0.0, f64::max);
        let nearest = (0..3).min_by(|&i, &j| off(i).total_cmp(&off(j)));
        let side = nearest.filter(|&i| off(i) <= room + beside[i]);
        let names = side.and_then(|local| names.get(&(origin[t], local))).ok_or_else(|| {
            outside("vertex", ends[0], "begins an edge that is on no boundary of the case")
        })?;
        for name in names {
            named.entry((*name).to_owned()).or_default().push(ends);
        }
    }
    Ok(named)
}

/// The edges of the outline by their ends: their numbers, and the ends with the body on the left.
fn sides(mesh: &Mesh) -> BTreeMap<[usize; 2], (usize, [usize; 2])> {
    let side = |&edge: &BoundaryEdge| {
        let (ends, number) = (mesh.ends(edge), mesh.number_of(edge));
        (sorted(ends), (number, ends))
    };
    mesh.outline().iter().map(side).collect()
}

/// The largest prescribed displacement or gap, and the largest traction.
fn sizes(certificate: &Certificate) -> (f64, f64) {
    let largest =
        |size: f64, numbers: &[f64]| numbers.iter().fold(size, |size, x| size.max(x.abs()));
    let prescribed = certificate.prescribed.iter().flatten().flatten();
    let lengths = prescribed.fold(0.0, |size: f64, x| size.max(x.abs()));
    certificate.edges.iter().fold((lengths, 0.0), |(lengths, loads), edge| {
        let (length, _) = length_and_normal(edge.ends.map(|p| place(certificate, p).into()));
        match edge.role {
            Role::Contact { gap, pressure, .. } => {
                (largest(lengths, &gap), largest(loads, &pressure))
            }
            Role::Loaded(t) => (lengths, largest(loads, t.as_flattened())),
            Role::Pressed(p) | Role::Supported { traction: p, .. } => (lengths, largest(loads, &p)),
            Role::Facing => (lengths, loads),
            Role::Inner(force) | Role::Held(_, force) => {
                (lengths, largest(loads, force.map(|f| f.map(|f| f / length)).as_flattened()))
            }
        }
    })
}

struct Comparison<'a> {
    certificate: &'a Certificate,
    parts: &'a ProblemParts<'a>,
    sides: BTreeMap<[usize; 2], (usize, [usize; 2])>,
    /// As [`sizes`].
    lengths: f64,
    loads: f64,
}

impl Comparison<'_> {
    /// The edge of the case's outline that an edge of the certificate is or is a part of: its number, and its ends with the body
    /// on the left.
    fn side(&self, edge: &Edge) -> Option<(usize, [usize; 2])> {
        let ends = <[usize; 2]>::try_from(corners(self.certificate, &edge.ends)).ok()?;
        self.sides.get(&ends).copied()
    }

    /// Each edge whose boundary is named is on that boundary.
    fn names(&self, forces: &Evidence) -> Result<(), Difference> {
        let Comparison { certificate, parts: &ProblemParts { mesh, .. }, .. } = *self;
        let on = |name: &String| -> BTreeSet<usize> {
            let edges = mesh.edges_of(name).unwrap_or_default().iter();
            edges.map(|&edge| mesh.number_of(edge)).collect()
        };
        let on: Vec<BTreeSet<usize>> = forces.names.iter().map(on).collect();
        for (e, (edge, of)) in certificate.edges.iter().zip(&forces.of).enumerate() {
            let number = self.side(edge).map(|(number, _)| number);
            if of.is_some_and(|k| number.is_none_or(|number| !on[k].contains(&number))) {
                return Err(outside("edge", e, "is not on the boundary that it is said to be on"));
            }
        }
        Ok(())
    }

    /// Compares what is prescribed at the vertices, and along which directions.
    fn points(&self) -> Result<(), Difference> {
        let Certificate { prescribed, frames, .. } = self.certificate;
        for (k, (found, expected)) in prescribed.iter().zip(&self.parts.prescribed).enumerate() {
            for (found, expected) in found.iter().zip(expected) {
                let of = ("displacement", self.lengths);
                self.same("vertex", k, of, found.as_slice(), expected.as_slice())?;
            }
            let [found, expected] = [frames.get(&k), self.parts.frames.get(&k)]
                .map(|d| d.filter(|_| k < prescribed.len()).map_or(&[][..], |d| &d[..]));
            self.same("vertex", k, ("direction that is held", 1.0), found, expected)?;
        }
        Ok(())
    }

    /// Materials and body forces, and what the loads cost beyond those of the certificate.
    fn pieces(&self, origins: &[usize]) -> Result<(), Difference> {
        let Comparison { certificate, parts, .. } = *self;
        let data = Data::new(parts.problem);
        let whole =
            |e: usize| self.side(&certificate.edges[e]).map_or(usize::MAX, |(number, _)| number);
        for (i, (piece, &t)) in certificate.pieces.iter().zip(origins).enumerate() {
            let [found, expected] = [&piece.material, parts.material(t)].map(Material::stiffness);
            self.same("triangle", i, ("stiffness", 0.0), &found, &expected)?;
            let triangle = Triangle { vertices: piece.vertices.map(|p| place(certificate, p)) };
            let body = data.body_on(t, &triangle).map(<[f64; 2]>::from);
            let [found, expected] = [&piece.body, &body].map(|body| body.as_flattened());
            self.same("triangle", i, ("body force", 0.0), found, expected)?;
            let measured = oscillation::loads(parts, &data, certificate, (piece, &whole), t);
            self.at_least("triangle", i, "oscillation", piece.oscillation, measured)?;
        }
        Ok(())
    }

    /// Compares the role of boundary edge `e`, and its data.
    fn edge(&self, e: usize, edge: &Edge) -> Result<(), Difference> {
        let Comparison { certificate, parts, .. } = *self;
        let Some((number, [a, b])) = self.side(edge) else {
            return Err(outside("edge", e, "is on no boundary of the case"));
        };
        let s = self.places_on(edge, b);
        let same = |of: (&str, f64), found: &[f64], expected: &[f64]| {
            self.same("edge", e, of, found, expected)
        };
        let places = edge.ends.map(|p| <[f64; 2]>::from(place(certificate, p)));
        let quadratic = certificate.curved.is_some();
        let (expected, bulge) = parts.role_on(number, (s, places), quadratic);
        match (edge.role, expected) {
            (Role::Held(found, _), Role::Held(held, _)) if found == held => {}
            (
                Role::Supported { along: d, traction: t, .. },
                Role::Supported { along, traction, .. },
            ) => {
                same(("direction that is held", 1.0), &d, &along)?;
                same(("traction across its support", self.loads), &t, &traction)?;
            }
            (Role::Loaded(t), Role::Loaded(traction)) => {
                let [t, traction] = [&t, &traction].map(|t| t.as_flattened());
                same(("traction", self.loads), t, traction)?;
            }
            (Role::Pressed(p), Role::Pressed(pressure)) => {
                same(("pressure", self.loads), &p, &pressure)?;
            }
            (Role::Facing, Role::Facing) => {}
            (
                Role::Contact { gap: g, along: d, law: found, .. },
                Role::Contact { gap, along, law, .. },
            ) => {
                match (found, law) {
                    (Law::Contact, Law::Contact) | (Law::Sliding, Law::Sliding) => {}
                    (Law::Bonded { offset: h, .. }, Law::Bonded { offset, .. }) => {
                        same(("jump along y", self.lengths), &h, &offset)?;
                    }
                    (Law::Friction { bound: s, .. }, Law::Friction { bound, .. }) => {
                        same(("bound of friction", self.loads), &s, &bound)?;
                    }
                    _ => return Err(outside("edge", e, "has another law of contact in the case")),
                }
                same(("gap", self.lengths), &g, &gap)?;
                let [d, along] =
                    [&d, &along].map(|d| d.as_ref().map_or(&[][..], |d| d.as_flattened()));
                same(("direction of contact", 1.0), d, along)?;
            }
            (found, expected) => {
                let found = format!("the role of {}", kind(&found));
                let expected = kind(&expected).to_owned();
                return Err(Difference::Data { what: "edge", index: e, found, expected });
            }
        }
        if let Some(&Boundary::Contact(line)) = parts.boundary.get(&number) {
            self.facing(e, line, s)?;
        }
        match &certificate.curved {
            Some(curved) => {
                same(("bulge of data", self.lengths), &curved.data[e], &bulge)?;
                self.at_cuts(e, edge, (number, [a, b]), curved)
            }
            None => Ok(()),
        }
    }

    /// Compares what is prescribed at ends of edge `e` that are no vertices; the edge is a part of that with this number between these
    /// vertices.
    fn at_cuts(
        &self,
        e: usize,
        edge: &Edge,
        (number, [a, b]): (usize, [usize; 2]),
        curved: &Curved,
    ) -> Result<(), Difference> {
        let Comparison { certificate, parts, .. } = *self;
        let s = self.places_on(edge, b);
        let at_cuts = |c: usize, ends: [Option<f64>; 2], bulge: f64| {
            let [Some(p), Some(q)] = ends else { return Ok(()) };
            for (point, s) in edge.ends.into_iter().zip(s) {
                if let Some(cut) = point.checked_sub(certificate.vertices.len()) {
                    let expected = (1.0 - s) * p + s * q + 4.0 * s * (1.0 - s) * bulge;
                    let found = curved.prescribed[cut][c];
                    let of = ("displacement", self.lengths);
                    self.same("edge", e, of, found.as_slice(), &[expected])?;
                }
            }
            Ok(())
        };
        match parts.boundary.get(&number) {
            Some(Boundary::Held(held, bulges)) => (0..2)
                .filter(|&c| held[c])
                .try_for_each(|c| at_cuts(c, [a, b].map(|k| parts.prescribed[k][c]), bulges[c])),
            Some(Boundary::Supported(d, bulge, _)) => {
                let value = |k: usize| match (parts.frames.get(&k), parts.prescribed[k]) {
                    (Some(_), [w, _]) => w,
                    (None, u) => (0..2).filter(|&c| d[c] != 0.0).map(|c| Some(d[c] * u[c]?)).sum(),
                };
                let axis = if is_oblique(*d) { 0 } else { usize::from(d[0] == 0.0) };
                let sign = if is_oblique(*d) { 1.0 } else { d[axis] };
                at_cuts(axis, [a, b].map(|k| Some(sign * value(k)?)), sign * bulge)
            }
            _ => Ok(()),
        }
    }

    /// Where the ends of an edge lie on the side of the triangle that ends with vertex `b`.
    fn places_on(&self, edge: &Edge, b: usize) -> [f64; 2] {
        let Certificate { vertices, cuts, .. } = self.certificate;
        edge.ends.map(|p| match p.checked_sub(vertices.len()) {
            None => f64::from(u8::from(p == b)),
            Some(cut) if cuts[cut].ends[1] == b => cuts[cut].at,
            Some(cut) => 1.0 - cuts[cut].at,
        })
    }

    /// Edge `e`, from place `s` to `t` on an edge of Gamma_C, lies in one contact or in none, and what faces it on a pair is what does so
    /// in the case.
    fn facing(&self, e: usize, line: usize, [s, t]: [f64; 2]) -> Result<(), Difference> {
        let (certificate, parts) = (self.certificate, self.parts);
        let contact = parts.contact_at(line, (s + t) / 2.0);
        for &(k, i) in &parts.lines[line] {
            let [from, to] = parts.contact[k].sides[i].places;
            let of = [from.min(to), from.max(to)];
            if !(if contact == Some((k, i)) { is_in([s, t], of) } else { is_off([s, t], of) }) {
                return Err(outside("edge", e, "is in contact in part, or with several"));
            }
        }
        let Some((k, i)) = contact.filter(|&(k, _)| parts.contact[k].is_pair()) else {
            return Ok(());
        };
        let differs = || outside("edge", e, "does not face what it faces in the case");
        let sides = &parts.contact[k].sides;
        let (own, side) = (&sides[i], &sides[1 - i]);
        let other = certificate.facing.get(&e).map(|&other| &certificate.edges[other]);
        let other = other.ok_or_else(differs)?;
        let (number, [_, b]) = self.side(other).ok_or_else(differs)?;
        let mesh = parts.mesh;
        if number != mesh.number_of(side.edge) {
            return Err(differs());
        }
        let [u, v] = self.places_on(other, b);
        let near = |(x, y): (f64, f64)| (side.place(own.within(x)) - y).abs() <= PLACES;
        if near((s, v)) && near((t, u)) { Ok(()) } else { Err(differs()) }
    }

    /// Compares the parts of prescribed displacements and gaps that the certificate's own leave out.
    fn lifts(&self) -> Result<(), Difference> {
        let Comparison { certificate, parts, .. } = *self;
        let key = |mut corners: [usize; 3]| {
            corners.sort_unstable();
            corners
        };
        let found: BTreeMap<_, _> =
            certificate.lifts.iter().map(|Lift { corners, norm }| (key(*corners), *norm)).collect();
        for (t, norm) in oscillation::lifts(parts, certificate.curved.is_some()) {
            match found.get(&key(parts.mesh.triangles()[t])) {
                Some(&found) => self.at_least("triangle of the mesh", t, "lift", found, norm)?,
                None => return Err(outside("triangle of the mesh", t, "lacks its lift")),
            }
        }
        Ok(())
    }

    fn at_least(
        &self,
        what: &'static str,
        index: usize,
        of: &str,
        found: f64,
        expected: f64,
    ) -> Result<(), Difference> {
        if found >= expected * (1.0 - 1e-9) {
            return Ok(());
        }
        let found = format!("the {of} {found:?}");
        Err(Difference::Data { what, index, found, expected: format!("{expected:?}") })
    }

    /// Compares numbers, to the rounding of the largest of them and of their `size`.
    fn same(
        &self,
        what: &'static str,
        index: usize,
        (of, size): (&str, f64),
        found: &[f64],
        expected: &[f64],
    ) -> Result<(), Difference> {
        let size = found.iter().chain(expected).fold(size, |size, x| size.max(x.abs()));
        let near = |(a, b): (&f64, &f64)| a == b || (a - b).abs() <= ROUNDING * size;
        if found.len() == expected.len() && found.iter().zip(expected).all(near) {
            return Ok(());
        }
        let said = |numbers: &[f64]| {
            if numbers.is_empty() { "none".to_owned() } else { format!("{numbers:?}") }
        };
        let found = format!("the {of} {}", said(found));
        Err(Difference::Data { what, index, found, expected: said(expected) })
    }
}

fn kind(role: &Role) -> &'static str {
    match role {
        Role::Inner(_) => "an inner edge",
        Role::Held(..) => "one where components are held",
        Role::Supported { .. } => "one where a direction is held",
        Role::Loaded(t) if *t == [[0.0; 2]; 2] => "one where nothing acts",
        Role::Loaded(_) => "one where a traction acts",
        Role::Pressed(_) => "one where a pressure acts",
        Role::Contact { .. } => "one of contact",
        Role::Facing => "one that faces another of contact",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_is_in_contact_from_end_to_end_or_not_at_all() {
        let of = [0.25, 0.75];
        let cases = [
            ([0.25, 0.75], [true, false]),
            ([0.3, 0.5], [true, false]),
            ([0.25 - 0.9 * PLACES, 0.75 + 0.9 * PLACES], [true, false]),
            ([0.25 - 1.1 * PLACES, 0.5], [false, false]),
            ([0.5, 0.75 + 1.1 * PLACES], [false, false]),
            ([0.0, 0.25], [false, true]),
            ([0.75, 1.0], [false, true]),
            ([0.0, 0.25 + 0.9 * PLACES], [false, true]),
            ([0.75 - 0.9 * PLACES, 1.0], [false, true]),
            ([0.0, 0.25 + 1.1 * PLACES], [false, false]),
            ([0.75 - 1.1 * PLACES, 1.0], [false, false]),
            ([0.0, 1.0], [false, false]),
        ];
        for (stretch, expected) in cases {
            assert_eq!([is_in(stretch, of), is_off(stretch, of)], expected, "{stretch:?}");
        }
        assert_eq!(PLACES, 1e-9);
    }

    #[test]
    fn a_message_names_the_role_of_an_edge() {
        let (no, one) = ([[0.0; 2]; 2], [[0.0, 0.0], [0.0, 1.0]]);
        let contact =
            Role::Contact { pressure: [0.0; 2], gap: [0.0; 2], along: None, law: Law::Contact };
        let supported = Role::Supported { along: [0.6, 0.8], force: [0.0; 2], traction: [0.0; 2] };
        for (role, expected) in [
            (Role::Inner(no), "an inner edge"),
            (Role::Held([true, false], no), "one where components are held"),
            (supported, "one where a direction is held"),
            (Role::Loaded(no), "one where nothing acts"),
            (Role::Loaded(one), "one where a traction acts"),
            (Role::Pressed([0.0; 2]), "one where a pressure acts"),
            (contact, "one of contact"),
            (Role::Facing, "one that faces another of contact"),
        ] {
            assert_eq!(kind(&role), expected);
        }
    }
}
