//! Gamma_D: which degrees of freedom are prescribed, with what values, and whether they hold the body.
//!
//! Where boundaries meet at a node, displacement wins; two displacements that meet must agree. Prescribed values are
//! interpolated at the nodes.
//!
//! A demand at a node is u . d = value for a unit vector d: a coordinate direction, or the normal or tangent of a support.
//! Two that are not parallel fix the node. One alone in an oblique direction d turns the node's unknowns into the frame
//! (d, t), t being d turned to the left: u = u_d d + u_t t, with u_d prescribed. The blocks of the matrix at such a node are
//! R^T K R with R = (d, t), a rotation: symmetry, definiteness and norm of the matrix stay, and its pattern does, too.

use std::collections::BTreeMap;

use super::boundary_normals::SmoothBoundary;
use super::data::{DataError, finite};
use super::function::SharedFunction;
use super::mesh::{NO_ANGLE, ROUNDED};
use super::problem::{Condition, Problem};
use super::revolution::AXIS;
use super::space::Space;
use crate::kernel::Scalar;
use crate::model::rigid;
use crate::model::rigid::{FreeMotion, Parts, pins};
use crate::quote;

/// The prescribed components of the displacement.
#[derive(Clone, Debug)]
pub struct Constraints {
    values: Vec<[Option<f64>; 2]>,
    frames: BTreeMap<usize, [f64; 2]>,
    holders: BTreeMap<String, Vec<Held>>,
    /// Components that are held where they are, so that a motion that changes nothing is stopped.
    pins: Vec<(usize, usize)>,
    /// The amount by which the directions of supports may be off.
    rounding: f64,
    /// The hoop strain holds the body, too.
    of_revolution: bool,
}

/// A direction in which a node is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Held {
    /// The node.
    pub(crate) node: usize,
    /// d, in which the force on the node acts.
    pub(crate) direction: [f64; 2],
    /// The force of size `dual . r` along d is this holder's part of a force r on the node.
    pub(crate) dual: [f64; 2],
}

impl Held {
    /// This holder's part of the force `r` on its node.
    pub(crate) fn part_of(&self, r: [f64; 2]) -> [f64; 2] {
        let size = self.dual[0] * r[0] + self.dual[1] * r[1];
        self.direction.map(|c| size * c)
    }
}

/// u . direction = value, asked for by `name`.
struct Demand<'a> {
    name: &'a str,
    direction: [f64; 2],
    value: f64,
}

/// The demands at each node.
type Demands<'a> = Vec<Vec<Demand<'a>>>;

impl Constraints {
    /// The constraints of a problem.
    ///
    /// # Errors
    /// A value that is not finite, or two that disagree.
    pub fn new(problem: &Problem, space: &Space) -> Result<Self, DataError> {
        let mut demands = demands(problem, space)?;
        let all = demands.iter().flatten();
        let largest = all.fold(0.0, |max: f64, demand| max.max(demand.value.abs()));
        let mut constraints = Constraints {
            values: vec![[None; 2]; space.nodes().len()],
            frames: BTreeMap::new(),
            holders: BTreeMap::new(),
            pins: Vec::new(),
            rounding: rounding_of_supports(problem)?,
            of_revolution: problem.material.are_of_revolution(),
        };
        for (node, at_node) in demands.iter_mut().enumerate().filter(|(_, of)| !of.is_empty()) {
            // Coordinate directions first: a value that is given for a component is taken as it is.
            at_node.sort_by_key(|demand| demand.axis().is_none());
            let tolerances = [NO_ANGLE.max(constraints.rounding), ROUNDED * largest];
            let holding = independent(at_node, space.nodes()[node], tolerances)?;
            constraints.prescribe(node, &holding);
        }
        Ok(constraints)
    }

    /// The rigid motions that stay free, and the parts of the body that they are motions of.
    pub fn free_motions(&self, space: &Space) -> (Parts, Vec<FreeMotion>) {
        let parts = Parts::new(space.mesh());
        let held = |node| self.directions(node);
        let motions = rigid::free_motions(&parts, space, held, self.rounding, self.of_revolution);
        (parts, motions)
    }

    /// The amount by which the directions in which nodes are held may be off because vertices are rounded.
    pub(crate) fn rounding(&self) -> f64 {
        self.rounding
    }

    /// These constraints with one component of a node held where `u` has it for each of the `motions`, in place of what was held
    /// so before: motions that change nothing are stopped.
    #[must_use]
    pub(crate) fn pinned(mut self, motions: &[Vec<[f64; 2]>], u: &[[f64; 2]]) -> Self {
        for (node, c) in std::mem::take(&mut self.pins) {
            self.values[node][c] = None;
        }
        let free = |node: usize, c: usize| {
            self.values[node][c].is_none() && !self.frames.contains_key(&node)
        };
        self.pins = pins(motions, free);
        for &(node, c) in &self.pins {
            self.values[node][c] = Some(u[node][c]);
        }
        self
    }

    /// Prescribes one or two independent demands at a node.
    fn prescribe(&mut self, node: usize, demands: &[&Demand]) {
        let mut holder = |demand: &Demand, dual| {
            if demand.name == AXIS {
                return;
            }
            let held = Held { node, direction: demand.direction, dual };
            match self.holders.get_mut(demand.name) {
                Some(holders) => holders.push(held),
                None => drop(self.holders.insert(demand.name.to_owned(), vec![held])),
            }
        };
        match demands {
            [one] => {
                holder(one, one.direction);
                match one.axis() {
                    Some(c) => self.values[node][c] = Some(one.direction[c] * one.value),
                    None => {
                        self.values[node] = [Some(one.value), None];
                        self.frames.insert(node, one.direction);
                    }
                }
            }
            [one, other] => {
                // The dual basis: each vector is perpendicular to the other direction.
                let sine = cross(one.direction, other.direction);
                let [first, second] = [other.direction, one.direction].map(|[x, y]| [y, -x]);
                let duals = [first.map(|c| c / sine), second.map(|c| c / -sine)];
                holder(one, duals[0]);
                holder(other, duals[1]);
                self.values[node] = [0, 1].map(|c| {
                    match [one, other].into_iter().find(|demand| demand.axis() == Some(c)) {
                        Some(given) => Some(given.direction[c] * given.value),
                        None => Some(duals[0][c] * one.value + duals[1][c] * other.value),
                    }
                });
            }
            _ => {}
        }
    }

    /// The prescribed components at each node, in the node's frame.
    pub fn values(&self) -> &[[Option<f64>; 2]] {
        &self.values
    }

    /// The components that supports prescribe at a node, in the node's frame; not those that are held so that a motion that changes
    /// nothing is stopped.
    pub(crate) fn supported(&self, node: usize) -> [Option<f64>; 2] {
        let is_pinned = |c: usize| self.pins.contains(&(node, c));
        [0, 1].map(|c| self.values[node][c].filter(|_| !is_pinned(c)))
    }

    /// The first axes of the frames that are not those of the coordinates, by node; the second is the first turned left.
    pub(crate) fn frames(&self) -> &BTreeMap<usize, [f64; 2]> {
        &self.frames
    }

    /// The prescribed data as a field, zero where nothing is prescribed.
    pub fn lift(&self) -> Vec<[f64; 2]> {
        let mut lift: Vec<[f64; 2]> =
            self.values.iter().map(|v| v.map(Option::unwrap_or_default)).collect();
        for (&node, &axis) in &self.frames {
            lift[node] = from_frame(axis, lift[node]);
        }
        lift
    }

    /// The components held by each displacement boundary; a direction that two boundaries prescribe counts for the one that
    /// is first in alphabetical order.
    pub(crate) fn holders(&self) -> &BTreeMap<String, Vec<Held>> {
        &self.holders
    }

    /// The directions in which a node is held.
    pub(crate) fn directions(&self, node: usize) -> impl Iterator<Item = [f64; 2]> {
        let axes = match self.frames.get(&node) {
            Some(&axis) => [axis, [-axis[1], axis[0]]],
            None => [[1.0, 0.0], [0.0, 1.0]],
        };
        self.values[node].iter().zip(axes).filter(|(value, _)| value.is_some()).map(|(_, d)| d)
    }
}

impl Demand<'_> {
    /// The component that this is about, up to its sign, if it is about one.
    fn axis(&self) -> Option<usize> {
        let [x, y] = self.direction;
        if y == 0.0 {
            Some(0)
        } else if x == 0.0 {
            Some(1)
        } else {
            None
        }
    }
}

/// The components of a vector along `axis` and along `axis` turned left.
pub(crate) fn in_frame<S: Scalar + From<f64>>(axis: [f64; 2], [x, y]: [S; 2]) -> [S; 2] {
    let axis = axis.map(S::from);
    [axis[0] * x + axis[1] * y, axis[0] * y - axis[1] * x]
}

/// The vector with these components.
pub(crate) fn from_frame(axis: [f64; 2], [along, across]: [f64; 2]) -> [f64; 2] {
    [axis[0] * along - axis[1] * across, axis[1] * along + axis[0] * across]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The rounding error that the normals of all supports may have.
fn rounding_of_supports(problem: &Problem) -> Result<f64, DataError> {
    let mut rounding: f64 = 0.0;
    for (name, condition) in &problem.conditions {
        if matches!(condition, Condition::Support { .. }) {
            let edges = problem.mesh.edges_of(name)?.iter().copied();
            rounding = rounding.max(problem.mesh.turned_by_rounding(edges));
        }
    }
    Ok(rounding)
}

/// The first one or two demands at a node that are independent, whose directions have a sine above the first of the
/// tolerances; the others must agree with them to within the second.
fn independent<'d, 'a>(
    demands: &'d [Demand<'a>],
    [x, y]: [f64; 2],
    [parallel, tolerance]: [f64; 2],
) -> Result<Vec<&'d Demand<'a>>, DataError> {
    let mut chosen: Vec<&Demand> = Vec::new();
    for demand in demands {
        let d = demand.direction;
        let along = chosen.iter().find(|other| cross(other.direction, d).abs() <= parallel);
        let (first, value) = match (along, &chosen[..]) {
            (Some(one), _) => {
                let sign = one.direction[0] * d[0] + one.direction[1] * d[1];
                (one.name, one.value * sign.signum())
            }
            (None, [one, other]) => {
                let sine = cross(one.direction, other.direction);
                let along = cross(d, other.direction) / sine * one.value;
                (one.name, along - cross(d, one.direction) / sine * other.value)
            }
            (None, _) => {
                chosen.push(demand);
                continue;
            }
        };
        if !((demand.value - value).abs() <= tolerance) {
            let (first, second) = (first.to_owned(), demand.name.to_owned());
            // For a side along an axis the message has the component, not that along the outward normal.
            let sign = demand.axis().map_or(1.0, |c| d[c]);
            let direction = d.map(|c| sign * c + 0.0);
            let values = [value, demand.value].map(|value| sign * value);
            return Err(DataError::Disagree { first, second, x, y, direction, values });
        }
    }
    Ok(chosen)
}

/// All demands of a problem, in the alphabetical order of the boundaries, those of points last.
fn demands<'a>(problem: &'a Problem, space: &Space) -> Result<Demands<'a>, DataError> {
    let mesh = space.mesh();
    let mut demands: Demands = space.nodes().iter().map(|_| Vec::new()).collect();
    let mut ask = |node: usize,
                   name: &'a str,
                   direction: [f64; 2],
                   function: &SharedFunction,
                   key: &dyn Fn() -> String| {
        let at_node = &mut demands[node];
        // Both edges at a node ask.
        if at_node.iter().all(|d| d.name != name || d.direction != direction) {
            let value = finite(&**function, space.nodes()[node], key)?;
            at_node.push(Demand { name, direction, value });
        }
        Ok::<(), DataError>(())
    };
    const AXES: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];
    let mut smooth: Option<SmoothBoundary> = None;
    for (name, condition) in &problem.conditions {
        match condition {
            Condition::Displacement(displacement) | Condition::Mixed { displacement, .. } => {
                for node in mesh.edges_of(name)?.iter().flat_map(|&edge| space.edge_nodes(edge)) {
                    for (c, function) in displacement.iter().enumerate() {
                        let Some(function) = function else { continue };
                        let key = || format!("[boundary.{}] displacement[{c}]", quote::key(name));
                        ask(node, name, AXES[c], function, &key)?;
                    }
                }
            }
            Condition::Support { normal, tangential } => {
                let smooth = smooth.get_or_insert_with(|| SmoothBoundary::new(mesh));
                for &edge in mesh.edges_of(name)? {
                    let facet = mesh.length_and_normal(edge).1;
                    let normals = smooth.along(mesh, edge).map(|points| points.map(|p| p.normal));
                    for (a, node) in space.edge_nodes(edge).enumerate() {
                        let n: [f64; 2] = normals.map_or(facet, |normals| normals[a]).into();
                        let t = [-n[1], n[0]];
                        for (function, direction, key) in
                            [(normal, n, "normal"), (tangential, t, "tangential")]
                        {
                            let Some(function) = function else { continue };
                            let key = || format!("[boundary.{}] {key}", quote::key(name));
                            ask(node, name, direction, function, &key)?;
                        }
                    }
                }
            }
            _ => {}
        }
    }
    for point in &problem.points {
        for (c, function) in point.displacement.iter().enumerate() {
            let Some(function) = function else { continue };
            let key = || format!("[point.{}] displacement[{c}]", quote::key(&point.name));
            ask(point.vertex, &point.name, AXES[c], function, &key)?;
        }
    }
    if problem.material.are_of_revolution() {
        for (node, [x, _]) in space.nodes().iter().enumerate() {
            if *x == 0.0 {
                let demand = Demand { name: AXIS, direction: AXES[0], value: 0.0 };
                demands[node].push(demand);
            }
        }
    }
    Ok(demands)
}
