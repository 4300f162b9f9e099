//! Displacements w for `certificates::forces`: of least energy among those that do on the boundary what is asked of them. Where
//! the body is far off the obstacle, w is free: it costs the square of the bound there, not its first power.
//!
//! One matrix serves all: that of a(.,.) with the body held on Gamma_D, and on Gamma_C along the direction of contact.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, Vector2};

use super::SWEEPS_FOR_FORCES;
use super::build::{Built, build};
use super::certificate::{Certificate, Cut, Role, Tied, is_oblique, turned};
use super::dual::Dual;
use super::field::Field;
use super::forces::{ForceTarget, Lifting, Motion};
use super::parts::{Boundary, OnLine, ProblemParts};
use super::sweeps::improve;
use crate::contact::Law;
use crate::contact::residual::add_internal_forces;
use crate::contact::{EdgeRule, Pair, Piece};
use crate::linear::dense::inner;
use crate::linear::factor::Factor;
use crate::linear::matrix::{LowerTriangle, Neighbours, Numbering};
use crate::linear::ordering::nested_dissection;
use crate::model::mesh::length;
use crate::model::rigid::{Parts, free_motions, pins};
use crate::model::{BoundaryEdge, Degree, Materials, Problem, Space};
use crate::solve::SolveError;

/// w . direction is prescribed at a node, because of an edge of this boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Prescription {
    direction: Vector2<f64>,
    boundary: usize,
    what: What,
}

/// The reason for a displacement; of contact the side, 1 on the second of two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    /// A support.
    Support,
    /// Contact, along its direction.
    Along(usize),
    /// Friction, across the direction of contact: it yields to all others, at a price.
    Across(usize),
}

impl What {
    fn side(self) -> Option<usize> {
        match self {
            What::Support => None,
            What::Along(side) | What::Across(side) => Some(side),
        }
    }

    fn yields(self) -> bool {
        matches!(self, What::Across(_))
    }
}

/// An edge of Gamma_C.
struct OnContact {
    edge: BoundaryEdge,
    boundary: usize,
    /// 1 on the second of two bodies.
    side: usize,
    /// Its first contact that is wanted.
    contact: usize,
    /// The direction of contact at its start, its end and in its middle.
    directions: [Vector2<f64>; 3],
}

/// The edges of Gamma_C that have a contact which is `wanted`.
fn on_contact(
    parts: &ProblemParts,
    names: &[String],
    wanted: impl Fn(usize) -> bool,
) -> Vec<OnContact> {
    let of_line = |line: &OnLine| {
        let wanted: OnLine = line.iter().copied().filter(|&(k, _)| wanted(k)).collect();
        let &(k, i) = wanted.first()?;
        let (contact, edge) = (&parts.contact[k], parts.contact[k].sides[i].edge);
        let boundary = names.iter().position(|name| **name == *contact.boundary)?;
        let direction = |x: f64| {
            let beyond = |&(k, i): &(usize, usize)| {
                let s = parts.contact[k].sides[i].within(x);
                (s - s.clamp(0.0, 1.0)).abs()
            };
            let nearest = wanted.iter().min_by(|a, b| beyond(a).total_cmp(&beyond(b)));
            let &(k, i) = nearest.unwrap_or(&(k, i));
            let (s, [d, e]) = (parts.contact[k].sides[i].within(x), parts.contact[k].directions);
            match s {
                s if s <= 0.0 || d == e => d,
                s if s >= 1.0 => e,
                s => d * (1.0 - s) + e * s,
            }
        };
        let directions = [0.0, 1.0, 0.5].map(direction);
        Some(OnContact { edge, boundary, side: i, contact: k, directions })
    };
    parts.lines.iter().filter_map(of_line).collect()
}

/// Makes displacements w.
pub(super) struct Lifter<'a> {
    parts: &'a ProblemParts<'a>,
    names: &'a [String],
    space: Space<'a>,
    /// At each node; those of Gamma_D first.
    demands: BTreeMap<usize, Vec<Prescription>>,
    numbering: Numbering,
    factor: Factor,
    /// The parts of the jump on each boundary that are the two bodies' own, with their signs.
    shares: Vec<[f64; 2]>,
}

/// Two directions with a sine below this are parallel.
const PARALLEL: f64 = 1e-8;

/// Two values at a node that differ by more, beside 1, contradict one another.
const AGREEMENT: f64 = 1e-9;

/// The first of the demands that are independent.
fn independent(demands: &[Prescription]) -> (Option<Prescription>, Option<Prescription>) {
    let Some(&first) = demands.first() else { return (None, None) };
    let across = |d: &&Prescription| first.direction.perp(&d.direction).abs() > PARALLEL;
    (Some(first), demands.iter().find(across).copied())
}

/// The vector with these components along two directions.
fn meeting([(d, along_d), (e, along_e)]: [(Vector2<f64>, f64); 2]) -> Vector2<f64> {
    if is_oblique(d.into()) || is_oblique(e.into()) {
        let right = |d: Vector2<f64>| Vector2::new(d[1], -d[0]);
        return (right(e) * along_d - right(d) * along_e) / d.perp(&e);
    }
    // d or e has component c alone.
    [0, 1].map(|c| if d[c] != 0.0 { d[c] * along_d } else { e[c] * along_e }).into()
}

/// How many times as stiff as those of the method springs are: of softer ones w opens, and what ties it costs energy; of ten times stiffer
/// ones the energy is the same to a thousandth.
const STIFFNESS: f64 = 30.0;

/// The springs between tied bodies by which the jump of w is nearly the motion: it is made so in the end.
fn springs(piece: &Piece) -> DMatrix<f64> {
    piece.contribution(&EdgeRule::Exact, &vec![0.0; piece.p0.len()]).tangent * STIFFNESS
}

/// The factor of a(.,.), with the springs between these bodies, for the components that are not prescribed, in their frames.
pub(super) fn factored(
    space: &Space,
    materials: &Materials,
    prescribed: &[[Option<f64>; 2]],
    frames: BTreeMap<usize, [f64; 2]>,
    tied: &[Piece],
) -> Result<(Numbering, Factor), SolveError> {
    let neighbours = Neighbours::across(space, tied);
    let order = nested_dissection(space.nodes(), &neighbours);
    let numbering = Numbering::new(&order, prescribed, frames);
    let mut matrix = LowerTriangle::zero(&numbering, &neighbours);
    matrix.add_stiffness(space, materials, &numbering)?;
    for piece in tied {
        matrix.add_contact_springs(&numbering, piece, &springs(piece))?;
    }
    let factor = Factor::new(&matrix)?;
    Ok((numbering, factor))
}

/// The demands of supports, closed contact and friction at each node; those of Gamma_D first.
fn demands(
    parts: &ProblemParts,
    space: &Space,
    names: &[String],
    open: &[bool],
) -> BTreeMap<usize, Vec<Prescription>> {
    let mut demands: BTreeMap<usize, Vec<Prescription>> = BTreeMap::new();
    // Along a direction at each node, or one for all.
    let mut add = |edge: BoundaryEdge, boundary: usize, what: What, of: [Vector2<f64>; 3]| {
        for (node, direction) in space.edge_nodes(edge).zip(of) {
            let (at_node, demand) =
                (demands.entry(node).or_default(), Prescription { direction, boundary, what });
            if !at_node.contains(&demand) {
                at_node.push(demand);
            }
        }
    };
    for (boundary, name) in names.iter().enumerate() {
        for &edge in parts.mesh.edges_of(name).unwrap_or_default() {
            let e = parts.mesh.number_of(edge);
            match parts.boundary.get(&e) {
                Some(&Boundary::Held(held, _)) => {
                    let axes = [Vector2::x(), Vector2::y()].into_iter().zip(held);
                    for (axis, _) in axes.filter(|(_, held)| *held) {
                        add(edge, boundary, What::Support, [axis; 3]);
                    }
                }
                Some(&Boundary::Supported(d, ..)) => {
                    add(edge, boundary, What::Support, [d.into(); 3]);
                }
                _ => {}
            }
        }
    }
    let is_closed = |k: usize| !parts.contact[k].is_tied() && !open[k];
    let has_friction = |k: usize| parts.contact[k].has_friction();
    for OnContact { edge, boundary, side, directions, .. } in on_contact(parts, names, is_closed) {
        add(edge, boundary, What::Along(side), directions);
    }
    // Open or not, as friction with a given bound acts across gaps.
    for OnContact { edge, boundary, side, directions, .. } in on_contact(parts, names, has_friction)
    {
        add(edge, boundary, What::Across(side), directions.map(turned));
    }
    demands
}

/// The directions at each node along which tied bodies hold each other: where nothing holds both of them, there is no factor.
fn ties(
    parts: &ProblemParts,
    space: &Space,
    names: &[String],
) -> BTreeMap<usize, Vec<Vector2<f64>>> {
    let mut tied: BTreeMap<usize, Vec<Vector2<f64>>> = BTreeMap::new();
    let is_tied = |k: usize| parts.contact[k].is_tied();
    for OnContact { edge, directions, contact, .. } in on_contact(parts, names, is_tied) {
        let is_glued = parts.contact[contact].law == Law::Bonded;
        for (a, node) in space.edge_nodes(edge).enumerate() {
            let across = is_glued.then(|| turned(directions[a]));
            tied.entry(node).or_default().extend([directions[a]].into_iter().chain(across));
        }
    }
    tied
}

impl<'a> Lifter<'a> {
    /// For the boundaries with these `names`; `open` tells of the edges of Gamma_C, by their place in `parts.contact`, where
    /// w is free.
    pub(crate) fn new(
        parts: &'a ProblemParts<'a>,
        degree: Degree,
        names: &'a [String],
        open: &[bool],
    ) -> Result<Self, String> {
        let space = Space::new(parts.mesh, degree);
        let demands = demands(parts, &space, names, open);
        let mut prescribed = vec![[None; 2]; space.nodes().len()];
        let mut frames = BTreeMap::new();
        for (&node, demands) in &demands {
            prescribed[node] = match independent(demands) {
                (Some(_), Some(_)) => [Some(0.0); 2],
                (Some(one), None) => {
                    let d = one.direction;
                    if is_oblique(d.into()) {
                        frames.insert(node, (d / length(d)).into());
                        [Some(0.0), None]
                    } else {
                        [0, 1].map(|c| (d[c] != 0.0).then_some(0.0))
                    }
                }
                _ => [None; 2],
            };
        }
        // A motion that neither supports nor the directions of contact stop, as a part turns about its pin, changes no force.
        let bodies = Parts::new(parts.mesh);
        let tied = ties(parts, &space, names);
        let held = |node: usize| {
            let demanded = demands.get(&node).into_iter().flatten();
            let tied = tied.get(&node).into_iter().flatten();
            demanded.map(|demand| demand.direction.into()).chain(tied.map(|&d| d.into()))
        };
        let motions = free_motions(&bodies, &space, held, PARALLEL, false);
        let fields: Vec<_> = motions.iter().map(|motion| motion.field(&bodies, &space)).collect();
        for (node, c) in pins(&fields, |node, _| !demands.contains_key(&node)) {
            prescribed[node][c] = Some(0.0);
        }
        let materials = &parts.problem.material;
        let factored = factored(&space, materials, &prescribed, frames, &parts.tied);
        let (numbering, factor) = factored.map_err(|error| {
            format!("no displacement of least energy to prove forces with: {error}")
        })?;
        let shares = vec![[1.0, 0.0]; names.len()];
        let mut lifter = Lifter { parts, names, space, demands, numbering, factor, shares };
        for (boundary, name) in names.iter().enumerate() {
            let opens = |pair: &Pair| matches!(pair.law, Law::Contact | Law::Friction(_));
            if parts.problem.pairs.iter().any(|pair| pair.boundaries[0] == *name && opens(pair)) {
                lifter.shares[boundary] = lifter.least(boundary);
            }
        }
        Ok(lifter)
    }

    /// The shares of two bodies in the jump 1 between them with which both together have the least energy.
    fn least(&mut self, boundary: usize) -> [f64; 2] {
        let target = ForceTarget { boundary: Some(boundary), motion: Motion::Along(None) };
        let energies = [[1.0, 0.0], [0.0, -1.0]].map(|shares| {
            self.shares[boundary] = shares;
            let w = self.field(target).ok()?;
            let mut forces = vec![[0.0; 2]; w.len()];
            add_internal_forces(&self.space, &self.parts.problem.material, &w, &mut forces);
            Some(inner(&w, &forces))
        });
        let own = match energies {
            [Some(first), Some(second)] if first + second > 0.0 => second / (first + second),
            _ => 0.5,
        };
        [own, own - 1.0]
    }

    /// The value that a demand asks for at a node.
    fn value(&self, node: usize, demand: &Prescription, target: ForceTarget) -> f64 {
        let x = self.space.nodes()[node];
        if target.boundary.is_some_and(|boundary| boundary != demand.boundary) {
            return 0.0;
        }
        let whole = match (target.motion, demand.what) {
            (Motion::Along(ramp), What::Along(_)) => ramp.map_or(1.0, |ramp| ramp.at(x[ramp.axis])),
            (motion, _) => motion.at(Vector2::from(x)).map_or(0.0, |r| r.dot(&demand.direction)),
        };
        demand.what.side().map_or(whole, |side| whole * self.shares[demand.boundary][side])
    }

    /// The jump along functional `i` of a piece of tied bodies.
    fn jump(&self, piece: &Piece, i: usize, target: ForceTarget) -> f64 {
        let meant = target.boundary.is_some_and(|b| *self.names[b] == **piece.boundary());
        let a = i % piece.geometry.nodes.len();
        let place = piece.geometry.first().place(self.parts.mesh, a);
        match target.motion.at(Vector2::from(place)) {
            _ if !meant => 0.0,
            Some(motion) => motion.dot(&piece.direction_of(i)),
            None => 1.0,
        }
    }

    /// w at the nodes, of least energy.
    ///
    /// # Errors
    /// A place where two boundaries ask for what is not to be had together.
    pub(crate) fn field(&self, target: ForceTarget) -> Result<Vec<[f64; 2]>, String> {
        let prescribed = self.prescribed(target)?;
        let mut field = prescribed.clone();
        self.relax(&mut field, target);
        self.prescribe_again(&mut field, &prescribed);
        if target.boundary.is_none() {
            self.cover(&mut field);
        }
        Ok(field)
    }

    /// The values that are demanded of w, and 0 at all other nodes.
    fn prescribed(&self, target: ForceTarget) -> Result<Vec<[f64; 2]>, String> {
        let mut field = vec![[0.0; 2]; self.space.nodes().len()];
        for (&node, demands) in &self.demands {
            let value = |demand: &Prescription| self.value(node, demand, target);
            let w = match independent(demands) {
                (Some(a), Some(b)) => meeting([&a, &b].map(|of| (of.direction, value(of)))),
                (Some(a), None) => a.direction * (value(&a) / a.direction.dot(&a.direction)),
                _ => continue,
            };
            // All contact boundaries together yield to what holds.
            if target.boundary.is_some() {
                let off = |demand: &&Prescription| {
                    let by = w.dot(&demand.direction) - value(demand);
                    !demand.what.yields() && by.abs() > AGREEMENT * (1.0 + length(w))
                };
                if let Some(other) = demands.iter().find(off) {
                    return Err(self.contradiction(node, demands, other));
                }
            }
            field[node] = w.into();
        }
        Ok(field)
    }

    /// Gives the free unknowns the least energy beside what is prescribed: K x = -K w.
    fn relax(&self, field: &mut [[f64; 2]], target: ForceTarget) {
        let mut right = vec![[0.0; 2]; field.len()];
        add_internal_forces(&self.space, &self.parts.problem.material, field, &mut right);
        for piece in &self.parts.tied {
            let jumps = piece.jumps(field).into_iter().enumerate();
            let opens: Vec<f64> = jumps.map(|(i, w)| w - self.jump(piece, i, target)).collect();
            let forces = springs(piece) * DVector::from_vec(opens);
            piece.add_contact(forces.as_slice(), &mut right);
        }
        right.as_flattened_mut().iter_mut().for_each(|r| *r = -*r);
        let mut x = self.numbering.gather(&right);
        self.factor.forward(&mut x);
        self.factor.backward(&mut x);
        self.numbering.scatter(&x, field);
    }

    /// Turning a vector into a frame and back rounds what is prescribed.
    fn prescribe_again(&self, field: &mut [[f64; 2]], prescribed: &[[f64; 2]]) {
        for (&node, demands) in &self.demands {
            if demands.iter().all(|demand| !is_oblique(demand.direction.into())) {
                for c in (0..2).filter(|&c| demands.iter().any(|d| d.direction[c] != 0.0)) {
                    field[node][c] = prescribed[node][c];
                }
            }
        }
    }

    /// Makes w0 1 along contact where w is free, too: w0 need not have the least energy.
    fn cover(&self, field: &mut [[f64; 2]]) {
        let may_open = |k: usize| !self.parts.contact[k].is_tied();
        for on in on_contact(self.parts, self.names, may_open) {
            let share = self.shares[on.boundary][on.side];
            for (node, d) in self.space.edge_nodes(on.edge).zip(on.directions) {
                let Some(along) = self.free_along(node, d, share) else { continue };
                let (moved, w) = (along.dot(&d), Vector2::from(field[node]));
                if moved.abs() > 0.5 {
                    field[node] = (w + along * ((share - w.dot(&d)) / moved)).into();
                }
            }
        }
    }

    /// The direction in which w0 can be moved at a node of contact along d. A body that another one holds may be held across
    /// contact there, and move the other way.
    fn free_along(&self, node: usize, d: Vector2<f64>, share: f64) -> Option<Vector2<f64>> {
        let Some(held) = self.demands.get(&node) else { return Some(d) };
        if held.iter().all(|demand| demand.what.yields()) {
            return Some(d);
        }
        match independent(held) {
            (Some(one), None)
                if share != 1.0 && held.iter().all(|demand| demand.what == What::Support) =>
            {
                Some(turned(one.direction))
            }
            _ => None,
        }
    }

    /// The dual pair of `certificates::dual`: a given w, and a stress rho in equilibrium near C eps of our own displacement for
    /// the target, on the triangles of `built`; `open` tells of the edges of Gamma_C where rho has no traction, those where
    /// our own displacement is free.
    ///
    /// # Errors
    /// A place where boundaries contradict one another; contact along a direction that is not an axis.
    pub(crate) fn pair(
        &self,
        (target, w): (ForceTarget, &[[f64; 2]]),
        built: &Built,
        open: &[bool],
    ) -> Result<Dual, String> {
        let (parts, mesh) = (self.parts, self.parts.mesh);
        if parts.contact.iter().any(|contact| contact.has_friction() || contact.is_tied()) {
            return Err("friction acts, or bodies are tied".to_owned());
        }
        let field = |w: &[[f64; 2]]| Field::new(mesh, w).map_err(|error| error.to_string());
        let (near, mut w) = (field(&self.field(target)?)?, field(w)?);
        let at_rest = |values: &[Option<f64>; 2]| values.map(|value| value.map(|_| 0.0));
        let mut prescribed: Vec<[Option<f64>; 2]> = parts.prescribed.iter().map(at_rest).collect();
        let mut boundary = BTreeMap::new();
        for (&edge, what) in &parts.boundary {
            let without_loads = match *what {
                Boundary::Held(held, _) => Boundary::Held(held, [0.0; 2]),
                Boundary::Supported(d, ..) => Boundary::Supported(d, 0.0, None),
                Boundary::Contact(line) if parts.lines[line].iter().any(|&(k, _)| !open[k]) => {
                    let contact = &parts.contact[parts.lines[line][0].0];
                    if contact.is_pair() {
                        return Err("the force is one between two bodies".to_owned());
                    }
                    let [d, e] = contact.directions;
                    if is_oblique(d.into()) || d != e {
                        return Err("contact does not act along an axis".to_owned());
                    }
                    let held = [d[0] != 0.0, d[1] != 0.0];
                    for vertex in mesh.ends(contact.edge) {
                        for c in (0..2).filter(|&c| held[c]) {
                            prescribed[vertex][c] = Some(w.vertices[vertex][c]);
                        }
                    }
                    Boundary::Held(held, [0.0; 2])
                }
                Boundary::Loaded(_) | Boundary::Free | Boundary::Contact(_) => Boundary::Free,
            };
            boundary.insert(edge, without_loads);
        }
        let problem = Problem::of(mesh.clone(), parts.problem.material.clone());
        let cuts =
            built.divisions.iter().map(|division| (division.base, division.places[1])).collect();
        let frames = parts.frames.clone();
        let dual = ProblemParts {
            problem: &problem,
            mesh,
            contact: Vec::new(),
            lines: Vec::new(),
            tied: Vec::new(),
            prescribed,
            frames,
            boundary,
            cuts,
        };
        if let Some(bulges) = &mut w.bulges {
            dual.hold_between(bulges);
        }
        let mut pair = build(&dual, &near, &w).certificate;
        // There is no load that could oscillate.
        pair.pieces.iter_mut().for_each(|piece| piece.oscillation = 0.0);
        improve(&mut pair, SWEEPS_FOR_FORCES, true).map_err(|error| error.to_string())?;
        let beyond = pair.curved.map(|curved| [curved.at_cuts, curved.bulges]);
        let w = Lifting { vertices: pair.displacement, beyond };
        Ok(Dual { w, roles: pair.edges.iter().map(|edge| edge.role).collect() })
    }

    /// Gives w on the second of two tied bodies what it must be where it is prescribed on the first one.
    fn meet(
        &self,
        w: &mut [[f64; 2]],
        target: ForceTarget,
        (certificate, of): (&Certificate, &[Option<usize>]),
    ) -> Result<(), String> {
        for Tied { edge, other, law, d, .. } in certificate.tied() {
            let meant = target.boundary.is_some() && of[edge] == target.boundary;
            for (k, p) in certificate.edges[edge].ends.into_iter().enumerate() {
                let q = certificate.edges[other].ends[1 - k];
                let (Some(&own), Some(&there)) = (w.get(p), w.get(q)) else { continue };
                let [own_data, data] =
                    [p, q].map(|p| certificate.at_own(p).map_or([None; 2], |(_, given)| given));
                let motion = target.motion.at(Vector2::from(certificate.vertices[p]));
                let motion = motion.unwrap_or(Vector2::from(d[k]));
                // Along an oblique direction the component that is not prescribed is moved.
                if !law.is_bonded() && is_oblique(d[k]) && own_data.contains(&None) {
                    continue;
                }
                let moves = |c: usize| law.is_bonded() || d[k][c] != 0.0;
                for c in (0..2).filter(|&c| own_data[c].is_some() && moves(c)) {
                    let value = if meant { own[c] - motion[c] } else { own[c] };
                    if data[c].is_some() && there[c] != value {
                        let [x, y] = certificate.vertices[p];
                        return Err(format!(
                            "at ({x}, {y}), where tied bodies and supports of both meet, the force of one alone has no bound in the energy norm"
                        ));
                    }
                    w[q][c] = value;
                }
            }
        }
        Ok(())
    }

    fn contradiction(&self, node: usize, demands: &[Prescription], other: &Prescription) -> String {
        let [x, y] = self.space.nodes()[node];
        let names = |demand: &Prescription| format!("'{}'", self.names[demand.boundary]);
        let with = demands.iter().find(|demand| demand.boundary != other.boundary);
        let with = with.map_or_else(String::new, |with| format!(" and {}", names(with)));
        format!(
            "at ({x}, {y}), where {}{with} meet, the force of one alone has no bound in the energy norm",
            names(other)
        )
    }

    /// w on the triangles of a certificate, what is exact on the boundary made so.
    pub(crate) fn lifting(
        &self,
        target: ForceTarget,
        built: &Built,
        of: &[Option<usize>],
    ) -> Result<Lifting, String> {
        let field = self.field(target)?;
        let certificate = &built.certificate;
        let mesh = self.parts.mesh;
        let shape = built.shape::<f64>(mesh, &field);
        let mut vertices: Vec<[f64; 2]> =
            shape.points[..mesh.vertices().len()].iter().map(|&w| w.into()).collect();
        self.meet(&mut vertices, target, (certificate, of))?;
        let Some(bulges) = shape.bulges else { return Ok(Lifting { vertices, beyond: None }) };
        let mean = |cut: &Cut| {
            let [a, b] = cut.ends.map(|end| Vector2::from(vertices[end]));
            a + (b - a) * cut.at
        };
        let at_cuts = shape.points[vertices.len()..].iter().zip(&certificate.cuts);
        let mut at_cuts: Vec<[f64; 2]> = at_cuts.map(|(w, cut)| (w - mean(cut)).into()).collect();
        let mut bulges: Vec<[f64; 2]> = bulges.into_iter().map(Into::into).collect();
        for (e, edge) in certificate.edges.iter().enumerate() {
            // w is affine along what holds.
            let across = match edge.role {
                Role::Held(held, _) => held,
                Role::Supported { along, .. } if is_oblique(along) => [true; 2],
                Role::Supported { along, .. } => along.map(|d| d != 0.0),
                _ => continue,
            };
            for c in (0..2).filter(|&c| across[c]) {
                bulges[e][c] = 0.0;
                for p in edge.ends {
                    if let Some(cut) = p.checked_sub(vertices.len()) {
                        at_cuts[cut][c] = 0.0;
                    }
                }
            }
        }
        Ok(Lifting { vertices, beyond: Some([at_cuts, bulges]) })
    }
}
