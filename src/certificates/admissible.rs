//! v from a displacement: it gets the prescribed values, and is pushed out of the obstacle, two bodies out of each other.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::certificate::{is_oblique, turned};
use super::contact::{Contact, Part, blossom};
use super::field::Field;
use super::parts::{Free, ProblemParts, held_along};
use crate::model::mesh::length;

/// v: u with the prescribed values, and pushed out of the obstacle at the vertices of Gamma_C and, if it is quadratic, between
/// them; on the edge k of Gamma_C by `further[k]` more than doubles ask for.
pub(super) fn admissible(parts: &ProblemParts, u: &Field, further: &[f64]) -> Field {
    let size = u.vertices.iter().flatten().fold(0.0_f64, |max, u| max.max(u.abs()));
    let out = Out { parts, further, size };
    let mut v = u.clone();
    hold(parts, &mut v.vertices);
    settle(parts, &mut v);
    out.push_vertices(&mut v.vertices);
    if let Some(bulges) = &mut v.bulges {
        parts.hold_between(bulges);
        out.push_ends(&mut v.vertices, bulges);
        out.push_between(&v.vertices, bulges);
    }
    out.part_bodies(&mut v);
    v
}

/// Gives v the values that are prescribed at vertices.
fn hold(parts: &ProblemParts, v: &mut [[f64; 2]]) {
    for (vertex, v) in v.iter_mut().enumerate() {
        *v = match (parts.held_alone(vertex), parts.prescribed[vertex]) {
            (Some((d, w)), _) => held_along(d, w, *v),
            (None, [Some(x), Some(y)]) => [x, y],
            (None, _) => *v,
        };
    }
}

/// The obstacles and bodies that v is pushed out of.
struct Out<'a> {
    parts: &'a ProblemParts<'a>,
    /// On each edge of Gamma_C, by how much more than doubles ask for.
    further: &'a [f64],
    /// The largest component of u.
    size: f64,
}

impl Out<'_> {
    fn edges(&self) -> impl Iterator<Item = (&Contact, f64)> {
        self.parts.contact.iter().zip(self.further.iter().copied())
    }

    /// The edges in contact with obstacles.
    fn obstacles(&self) -> impl Iterator<Item = (&Contact, f64)> {
        self.edges().filter(|(edge, _)| !edge.is_pair())
    }

    fn push_vertices(&self, v: &mut [[f64; 2]]) {
        let parts = self.parts;
        for (&vertex, walls) in &mut self.walls() {
            let free = parts.free_at(vertex);
            let out = out_of(walls, v[vertex].into(), free);
            v[vertex] = match (parts.frames.get(&vertex), parts.held_alone(vertex)) {
                (Some(_), Some((d, w))) => held_along(d, w, out.into()),
                _ => out.into(),
            };
            let all = walls.iter().all(|wall| wall.further == 0.0 && !is_oblique(wall.n.into()));
            if all && matches!(free, Free::All) {
                walls.sort_by(|a, b| b.gap.total_cmp(&a.gap));
                walls.iter().for_each(|w| touch(w.n, w.gap, self.size, &mut v[vertex]));
            }
        }
    }

    /// The obstacles at each vertex.
    fn walls(&self) -> BTreeMap<usize, Vec<Wall>> {
        let mut walls: BTreeMap<usize, Vec<Wall>> = BTreeMap::new();
        for (edge, further) in self.obstacles() {
            for (k, vertex) in self.parts.mesh.ends(edge.edge).into_iter().enumerate() {
                let (n, gap) = (edge.directions[k], edge.gap[k]);
                // Balls must see it.
                let is_rounded = self.parts.frames.contains_key(&vertex) || is_oblique(n.into());
                let scale = gap.abs() + if is_rounded { self.size } else { 0.0 };
                let margin = 64.0 * f64::EPSILON * scale + further;
                walls.entry(vertex).or_default().push(Wall {
                    n,
                    gap,
                    further,
                    most: gap - margin,
                    margin,
                });
            }
        }
        walls
    }

    /// Moves the ends of edges, where that costs less than a bulge.
    fn push_ends(&self, v: &mut [[f64; 2]], bulges: &[[f64; 2]]) {
        for (edge, further) in self.obstacles() {
            let ends = self.parts.mesh.ends(edge.edge);
            let over = self.over(edge, further, v, bulges);
            let modulus = self.parts.material(edge.edge.triangle).mu();
            let free = ends.map(|vertex| matches!(self.parts.free_at(vertex), Free::All));
            if let Some((k, step)) = over.at_an_end(edge, modulus, free) {
                let v = &mut v[ends[k]];
                *v = (Vector2::from(*v) - edge.directions[k] * step).into();
            }
        }
    }

    fn push_between(&self, v: &[[f64; 2]], bulges: &mut [[f64; 2]]) {
        for (edge, further) in self.obstacles() {
            let over = self.over(edge, further, v, bulges);
            let bulge = &mut bulges[self.parts.mesh.number_of(edge.edge)];
            let mean = (edge.directions[0] + edge.directions[1]) / 2.0;
            *bulge = (Vector2::from(*bulge) - mean * over.between(edge)).into();
            if further == 0.0 && !edge.turns() {
                touch(edge.directions[0], edge.gap_bulge, self.size + edge.gap[0].abs(), bulge);
            }
        }
    }

    fn over(&self, edge: &Contact, further: f64, v: &[[f64; 2]], bulges: &[[f64; 2]]) -> Over {
        let mesh = self.parts.mesh;
        let at_ends = mesh.ends(edge.edge).map(|vertex| Vector2::from(v[vertex]));
        let bulge = Vector2::from(bulges[mesh.number_of(edge.edge)]);
        Over::new(edge, (at_ends, bulge), (self.size, further))
    }

    /// Moves bodies together that press each other, and apart where they go through each other.
    fn part_bodies(&self, v: &mut Field) {
        let (parts, size) = (self.parts, self.size);
        let pairs = || self.edges().filter(|(edge, _)| edge.is_pair() && !edge.is_tied());
        for _ in 0..SWEEPS_TOGETHER {
            let pressed = |contact: &Contact| contact.is_pressed() && !contact.is_sliver();
            for (contact, further) in pairs().filter(|(contact, _)| pressed(contact)) {
                move_apart(parts, contact, v, (size, further), true);
            }
        }
        for _ in 0..SWEEPS {
            let moved = pairs().fold(false, |moved, (contact, further)| {
                move_apart(parts, contact, v, (size, further), false) || moved
            });
            if !moved {
                break;
            }
        }
    }
}

/// Puts v on the obstacle where it is pressed on both sides, and to rest across where it sticks: the method gives way there a little, on
/// curved boundaries by as much as an edge is off its arc, and the bound counts the tractions times that. Where they would save less than the
/// move costs, v stays; so does a v of degree 1 without friction, on straight boundaries.
fn settle(parts: &ProblemParts, v: &mut Field) {
    let quadratic = v.bulges.is_some();
    let is_settled = |edge: &&Contact| !edge.is_pair() && (quadratic || edge.has_friction());
    let obstacles = || parts.contact.iter().filter(is_settled);
    // What a move of 1 saves: the tractions along and across, over the modulus.
    let saved = |edge: &Contact| {
        let scale = edge.length / (WORTH * parts.material(edge.edge.triangle).mu());
        edge.least_tractions().map(|traction| traction * scale)
    };
    // At each vertex the direction and the gap, and how far v may be moved along and across.
    let mut at_vertices: BTreeMap<usize, (Vector2<f64>, f64, [f64; 2])> = BTreeMap::new();
    for edge in obstacles() {
        let own = saved(edge);
        for (k, vertex) in parts.mesh.ends(edge.edge).into_iter().enumerate() {
            let here = (edge.directions[k], edge.gap[k], own);
            let (_, _, most) = at_vertices.entry(vertex).or_insert(here);
            *most = [0, 1].map(|c| most[c].min(own[c]));
        }
    }
    // The move that puts a point on the obstacle and to rest.
    let rest = |at: Vector2<f64>, d: Vector2<f64>, gap: f64, most: [f64; 2]| {
        let e = turned(d);
        let moves = [gap - at.dot(&d), -at.dot(&e)];
        let [along, across] =
            [0, 1].map(|c| if moves[c].abs() <= most[c] { moves[c] } else { 0.0 });
        (d * along + e * across) / d.dot(&d)
    };
    let vertices = &mut v.vertices;
    for (vertex, (d, gap, most)) in at_vertices {
        if matches!(parts.free_at(vertex), Free::All) {
            let at = Vector2::from(vertices[vertex]);
            vertices[vertex] = (at + rest(at, d, gap, most)).into();
        }
    }
    let Some(bulges) = &mut v.bulges else { return };
    for edge in obstacles() {
        let bulge = &mut bulges[parts.mesh.number_of(edge.edge)];
        let [a, b] = parts.mesh.ends(edge.edge).map(|vertex| Vector2::from(vertices[vertex]));
        let middle = (a + b) / 2.0 + Vector2::from(*bulge);
        let d = (edge.directions[0] + edge.directions[1]) / 2.0;
        let gap = (edge.gap[0] + edge.gap[1]) / 2.0 + edge.gap_bulge;
        *bulge = (Vector2::from(*bulge) + rest(middle, d, gap, saved(edge))).into();
    }
}

/// The energy of a move, over modulus and square of the move.
const WORTH: f64 = 2.0;

/// The number of times that two bodies are moved apart: what is moved at one contact moves its neighbours.
const SWEEPS: usize = 16;

/// The number of times that bodies which press each other are moved together before.
const SWEEPS_TOGETHER: usize = 8;

/// Moves two bodies apart where they go through each other, or `together` where they are open: for each Bernstein coefficient of v . d - g that
/// is positive, or not zero, with the least energy that some springs at the vertices and in the middles of both edges have, each as stiff as its body.
fn move_apart(
    parts: &ProblemParts,
    contact: &Contact,
    field: &mut Field,
    (size, further): (f64, f64),
    together: bool,
) -> bool {
    let mesh = parts.mesh;
    let (d, [g, h]) = (contact.directions, contact.gap);
    let mean = (d[0] + d[1]) / 2.0;
    let quadratic = field.bulges.is_some();
    let gap_bulge = if quadratic { contact.gap_bulge } else { 0.0 };
    let gap = [g, (g + h) / 2.0 + 2.0 * gap_bulge, h];
    let margin = 64.0 * f64::EPSILON * (size + g.abs() + h.abs() + gap_bulge.abs()) + further;
    // Each unknown: a vertex, or the number of an edge for its bulge; its direction; its coefficients; and how easily it moves.
    let mut unknowns = Vec::with_capacity(6);
    for (i, side) in contact.sides.iter().enumerate() {
        let ease = 1.0 / parts.material(side.edge.triangle).mu();
        let along = mean * Contact::sign(i);
        let mut add = |at: Result<usize, usize>, along: Vector2<f64>, [a, m, b]: [f64; 3]| {
            let change = side.blossom().map(|[p, q, r]| {
                let shape = a * p + m * q + b * r;
                along * (shape * Contact::sign(i))
            });
            unknowns.push((at, along, on_parts(contact, &change, &[0.0; 3]), ease));
        };
        for (vertex, shape) in
            mesh.ends(side.edge).into_iter().zip([[1.0, 0.5, 0.0], [0.0, 0.5, 1.0]])
        {
            match parts.free_at(vertex) {
                Free::All => add(Ok(vertex), along, shape),
                Free::Along(t) => add(Ok(vertex), t * t.dot(&along), shape),
                Free::Nothing => {}
            }
        }
        if quadratic {
            let number = mesh.number_of(side.edge);
            add(Err(number), along, [0.0, 2.0, 0.0]);
        }
    }
    let mut over = on_parts(contact, &contact.jump(mesh, field), &gap);
    let mut moved = false;
    for j in 0..over.len() {
        let beyond = over[j] + margin;
        let give: f64 =
            unknowns.iter().map(|(_, _, effects, ease)| ease * effects[j] * effects[j]).sum();
        if !((beyond > 0.0 || together) && give > 0.0) {
            continue;
        }
        // A little farther, so that rounding does not ask again.
        let step = (beyond + margin) / give;
        for (at, along, effects, ease) in &unknowns {
            let by = step * ease * effects[j];
            over.iter_mut().zip(effects).for_each(|(over, effect)| *over -= by * effect);
            let place = match (at, &mut field.bulges) {
                (Ok(vertex), _) => &mut field.vertices[*vertex],
                (Err(edge), Some(bulges)) => &mut bulges[*edge],
                (Err(_), None) => continue,
            };
            *place = (Vector2::from(*place) - *along * by).into();
        }
        moved = true;
    }
    moved
}

/// Puts v, which may be `size` large, on the obstacle to the last bit, where it is there but for rounding, and n is along an
/// axis.
fn touch(n: Vector2<f64>, gap: f64, size: f64, v: &mut [f64; 2]) {
    let near = 512.0 * f64::EPSILON * (gap.abs() + size);
    for c in 0..2 {
        if n[c].abs() == 1.0 && (v[c] * n[c] - gap).abs() <= near {
            v[c] = n[c] * gap;
        }
    }
}

/// v . n is to be at most `most`, which is `margin` less than what is allowed.
struct Wall {
    n: Vector2<f64>,
    gap: f64,
    /// The amount by which it is pushed out beyond what doubles ask for.
    further: f64,
    most: f64,
    margin: f64,
}

/// The place nearest to v on the right side of all walls; where there is none, a place on that of one of them.
fn out_of(walls: &[Wall], v: Vector2<f64>, free: Free) -> Vector2<f64> {
    let is_out = |x: &Vector2<f64>| walls.iter().all(|w| x.dot(&w.n) <= w.most + w.margin / 2.0);
    if is_out(&v) {
        return v;
    }
    let (alone, n): (Vec<_>, Vec<_>) = walls
        .iter()
        .filter_map(|wall| {
            let n = match free {
                Free::All => wall.n,
                Free::Along(t) => t * t.dot(&wall.n),
                Free::Nothing => return None,
            };
            let along = n.dot(&wall.n);
            let step = (v.dot(&wall.n) - wall.most) / along;
            (along > 0.0).then(|| (v - n * step, wall))
        })
        .unzip();
    let mut places = alone.clone();
    if matches!(free, Free::All) {
        for (k, a) in n.iter().enumerate() {
            for b in &n[..k] {
                let sine = a.n.perp(&b.n);
                if sine.abs() > 1e-6 {
                    places.push((turned(a.n) * b.most - turned(b.n) * a.most) / sine);
                }
            }
        }
    }
    let far = |x: &Vector2<f64>| (x - v).dot(&(x - v));
    let nearest = places.into_iter().filter(is_out).min_by(|a, b| far(a).total_cmp(&far(b)));
    let farthest = || alone.into_iter().max_by(|a, b| far(a).total_cmp(&far(b)));
    nearest.or_else(farthest).unwrap_or(v)
}

/// The Bernstein coefficients of v . d - g on the parts of an edge of Gamma_C, where they are verified, and the margin by which they
/// are to be negative.
struct Over {
    coefficients: Vec<f64>,
    margin: f64,
}

/// The [`coefficients`] of v . d - g on all parts of an edge.
fn on_parts(edge: &Contact, v: &[Vector2<f64>; 3], g: &[f64; 3]) -> Vec<f64> {
    let of_part = |part: &Part| coefficients(v, &edge.directions, g, part.ends);
    edge.parts.iter().flat_map(of_part).collect()
}

/// The Bernstein coefficients of v . d - g on the part of an edge from s to t, for v and g by their own on the whole edge; of degree 3,
/// or of degree 2 where d does not turn.
fn coefficients(
    v: &[Vector2<f64>; 3],
    d: &[Vector2<f64>; 2],
    g: &[f64; 3],
    [s, t]: [f64; 2],
) -> Vec<f64> {
    let v =
        |a: f64, b: f64| -> Vector2<f64> { v.iter().zip(blossom(a, b)).map(|(v, w)| *v * w).sum() };
    let g = |a: f64, b: f64| g.iter().zip(blossom(a, b)).map(|(g, w)| g * w).sum::<f64>();
    if d[0] == d[1] {
        return [(s, s), (s, t), (t, t)].map(|(a, b)| v(a, b).dot(&d[0]) - g(a, b)).to_vec();
    }
    let d = |a: f64| d[0] * (1.0 - a) + d[1] * a;
    let ends = |a: f64| v(a, a).dot(&d(a)) - g(a, a);
    let inner = |a: f64, b: f64| {
        (2.0 * v(a, b).dot(&d(a)) + v(a, a).dot(&d(b)) - g(a, a) - 2.0 * g(a, b)) / 3.0
    };
    vec![ends(s), inner(s, t), inner(t, s), ends(t)]
}

impl Over {
    fn new(
        edge: &Contact,
        (v, bulge): ([Vector2<f64>; 2], Vector2<f64>),
        (size, further): (f64, f64),
    ) -> Over {
        let (d, [g, h]) = (edge.directions, edge.gap);
        let middle = (v[0] + v[1]) / 2.0 + bulge * 2.0;
        let gap = [g, (g + h) / 2.0 + 2.0 * edge.gap_bulge, h];
        let tilted = if d.into_iter().any(|d| is_oblique(d.into())) { size } else { 0.0 };
        let largest = v[0].dot(&d[0]).abs() + v[1].dot(&d[1]).abs() + bulge.dot(&d[0]).abs();
        let scale = largest + tilted + g.abs() + h.abs() + edge.gap_bulge.abs();
        Over {
            coefficients: on_parts(edge, &[v[0], middle, v[1]], &gap),
            margin: 64.0 * f64::EPSILON * scale + further,
        }
    }

    /// The least multiple of a change of v with these coefficients that makes all negative where the change is not 0.
    fn step(&self, edge: &Contact, change: &[Vector2<f64>; 3]) -> f64 {
        let effects = on_parts(edge, change, &[0.0; 3]);
        let all = self.coefficients.iter().zip(effects);
        let steps = all.filter(|(_, effect)| *effect > 1e-6);
        steps.fold(0.0, |step: f64, (c, effect)| step.max((c + 2.0 * self.margin) / effect))
    }

    /// The change of the bulge, along the mean of the directions.
    fn between(&self, edge: &Contact) -> f64 {
        let mean = (edge.directions[0] + edge.directions[1]) / 2.0;
        self.step(edge, &[Vector2::zeros(), mean * 2.0, Vector2::zeros()])
    }

    /// The end of the edge at which v had better be pushed out, and how far: where contact ends near it, v goes through the obstacle
    /// behind it by far less than its slope is off, to which a bulge would have to answer. A bulge b costs an energy of some
    /// 16 mu b^2 / 3, a shift by b some mu b^2, and the work of the force there.
    fn at_an_end(&self, edge: &Contact, modulus: f64, free: [bool; 2]) -> Option<(usize, f64)> {
        let by_bulge = self.between(edge);
        let shift = |k: usize| {
            let d = edge.directions[k];
            let mut change = [Vector2::zeros(), d / 2.0, Vector2::zeros()];
            change[2 * k] = d;
            let step = self.step(edge, &change);
            let force = length(edge.on_edge(0)[k]);
            (k, step, modulus * step * step + 4.0 * force * step)
        };
        let most = 16.0 / 3.0 * modulus * by_bulge * by_bulge;
        let better = (0..2)
            .filter(|&k| free[k])
            .map(shift)
            .filter(|(_, step, cost)| *cost < most && *step > 0.0);
        better.min_by(|a, b| a.2.total_cmp(&b.2)).map(|(k, step, _)| (k, step))
    }
}
