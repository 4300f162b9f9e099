//! Gamma_C on the mesh: its edges with their functionals and gamma = gamma0 h_T of (7), the coercivity number kappa.
//!
//! The direction of contact is a field n~, given at the nodes: by the obstacle's closest point where there is an obstacle, else
//! by the normal of the smooth boundary (`boundary_normals`), on which the nodes are placed when the gap is measured. On a
//! straight line without an obstacle n~ = n, and all is the paper's method to the bit.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::Vector2;

use super::boundary_normals::{SmoothBoundary, SmoothPoint};
use super::contact_face::{ContactFace, Functionals};
use super::data::{DataError, finite};
use super::element::Degree;
use super::mesh::{BoundaryEdge, ROUNDED};
use super::obstacle::Closest;
use super::problem::{Condition, Problem};
use super::space::Space;
use crate::kernel::contact_edge::traction_stiffness;
use crate::quote::key;

/// gamma along Gamma_C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gamma {
    /// gamma0 h_T with one gamma0: (7). The triangle with the smallest limit sets the limit for all.
    Uniform(f64),
    /// gamma0 h_T with the gamma0 for which kappa on the triangle itself is this number: gamma may be any function
    /// (Remark 2.2), and a sliver spoils only itself.
    Local(f64),
}

impl From<f64> for Gamma {
    fn from(gamma0: f64) -> Self {
        Gamma::Uniform(gamma0)
    }
}

/// C_h with kappa = gamma0 C_h, and the contact edge that sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coercivity {
    /// max_T c_p h_T sum_E c_E |E| / |T| over the edges E of T on Gamma_C, c_E = n~ . Q(n) n~ with the acoustic tensor Q(n)
    /// (A_nnnn where n~ = n), or its largest eigenvalue where n~ turns along E: lambda + 2 mu where A is isotropic.
    pub constant: f64,
    /// The median of the same over the triangles.
    pub typical: f64,
    /// The contact edge where the maximum is attained, by its two ends; of several, the first in the order of these.
    pub limiting_edge: [[f64; 2]; 2],
}

impl Coercivity {
    /// The constant of a problem for a degree of V^h.
    ///
    /// # Errors
    /// [`DataError::NoContact`], and unknown boundary names.
    pub fn new(problem: &Problem, degree: Degree) -> Result<Self, DataError> {
        let mesh = &problem.mesh;
        let edges = contact_edges(problem)?;
        let constants = constants(problem, degree, &edges, &ContactGeometry::new(problem))?;
        let mut sorted: Vec<f64> = constants.values().copied().collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let typical = sorted.get(sorted.len() / 2).copied().ok_or(DataError::NoContact)?;
        let constant = sorted.last().copied().ok_or(DataError::NoContact)?;
        // Equal edges differ by rounding: the choice must not.
        let equal =
            edges.iter().filter(|(e, _)| constants[&e.triangle] >= constant * (1.0 - ROUNDED));
        let ends = |(edge, _): &(BoundaryEdge, &str)| {
            let mut ends = mesh.places_of_ends(*edge);
            ends.sort_by(order);
            ends
        };
        let first = equal.map(ends).min_by(|[a, b], [c, d]| order(a, c).then(order(b, d)));
        let limiting_edge = first.ok_or(DataError::NoContact)?;
        Ok(Coercivity { constant, typical, limiting_edge })
    }

    /// The gamma0 at which kappa = 1: below it, J_h is strictly convex.
    pub fn limit(&self) -> f64 {
        1.0 / self.constant
    }

    /// The gamma0 of (7), or the smallest where each triangle has its own.
    pub fn gamma0(&self, gamma: Gamma) -> f64 {
        match gamma {
            Gamma::Uniform(gamma0) => gamma0,
            Gamma::Local(kappa) => kappa * self.limit(),
        }
    }
}

/// kappa / gamma0 on each triangle with an edge on Gamma_C.
fn constants(
    problem: &Problem,
    degree: Degree,
    edges: &[(BoundaryEdge, &str)],
    geometry: &ContactGeometry,
) -> Result<BTreeMap<usize, f64>, DataError> {
    let mesh = &problem.mesh;
    let mut constants: BTreeMap<usize, f64> = BTreeMap::new();
    for &(edge, name) in edges {
        let [start, end] = [geometry.direction(edge, name, 0)?, geometry.direction(edge, name, 1)?];
        let (length, normal) = mesh.length_and_normal(edge);
        let counted =
            if start == end { length } else { degree.turning_factor(start.dot(&end)) * length };
        let t = edge.triangle;
        let (area, material) = (mesh.triangle(t).double_area() / 2.0, problem.material.of(t));
        let stiffness =
            traction_stiffness(material, normal, (start == end).then_some(start), f64::sqrt);
        *constants.entry(t).or_default() +=
            degree.coercivity_constant(stiffness, mesh.diameter(t), counted, area);
    }
    Ok(constants)
}

/// Points by x, then by y.
fn order(a: &[f64; 2], b: &[f64; 2]) -> std::cmp::Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
}

/// The edges of all contact boundaries with the names of these, each boundary in chains along the boundary.
fn contact_edges(problem: &Problem) -> Result<Vec<(BoundaryEdge, &str)>, DataError> {
    let mut edges = Vec::new();
    for (name, condition) in &problem.conditions {
        if condition.is_contact() {
            let chained = chains(problem, problem.mesh.edges_of(name)?);
            edges.extend(chained.into_iter().map(|edge| (edge, name.as_str())));
        }
    }
    if edges.is_empty() { Err(DataError::NoContact) } else { Ok(edges) }
}

/// Sorts edges into chains: each is followed by the one that starts where it ends, if there is one.
fn chains(problem: &Problem, edges: &[BoundaryEdge]) -> Vec<BoundaryEdge> {
    let ends = |edge: BoundaryEdge| problem.mesh.ends(edge);
    let mut from: BTreeMap<usize, BoundaryEdge> = edges.iter().map(|&e| (ends(e)[0], e)).collect();
    let targets: Vec<usize> = edges.iter().map(|&e| ends(e)[1]).collect();
    // First the chains that have a beginning, then the closed ones.
    let mut starts: Vec<usize> = from.keys().copied().collect();
    let is_target: std::collections::BTreeSet<usize> = targets.into_iter().collect();
    starts.sort_by_key(|start| is_target.contains(start));
    let mut chained = Vec::with_capacity(edges.len());
    for start in starts {
        let mut next = from.remove(&start);
        while let Some(edge) = next {
            chained.push(edge);
            next = from.remove(&ends(edge)[1]);
        }
    }
    chained
}

/// All edges of Gamma_C.
///
/// # Errors
/// [`DataError::NoContact`], a gap that is not finite, an obstacle on the other side of the body, and unknown boundary names.
pub fn assemble(
    problem: &Problem,
    space: &Space,
    gamma: impl Into<Gamma>,
) -> Result<Vec<ContactFace>, DataError> {
    let mesh = space.mesh();
    let geometry = ContactGeometry::new(problem);
    let edges = contact_edges(problem)?;
    let gamma0: Box<dyn Fn(usize) -> f64> = match gamma.into() {
        Gamma::Uniform(gamma0) => Box::new(move |_| gamma0),
        Gamma::Local(kappa) => {
            let constants = constants(problem, space.degree(), &edges, &geometry)?;
            Box::new(move |t| kappa / constants[&t])
        }
    };
    let (degree, count) = (space.degree(), space.degree().nodes_per_edge());
    let mut line: Vec<ContactFace> = Vec::new();
    for (edge, name) in edges {
        let (length, normal) = mesh.length_and_normal(edge);
        let gamma = gamma0(edge.triangle) * mesh.diameter(edge.triangle);
        let (mut gap, mut directions) = (vec![0.0; count], vec![normal; count]);
        let mut places = vec![[0.0; 2]; count];
        for (a, node) in space.edge_nodes(edge).into_iter().enumerate() {
            let on_facet = SmoothPoint { place: space.nodes()[node], normal };
            let point = geometry.point(edge, a).unwrap_or(on_facet);
            places[a] = point.place;
            Closest { gap: gap[a], direction: directions[a] } = geometry.closest(name, point)?;
        }
        let triangle = mesh.triangle(edge.triangle);
        let material = problem.material.of(edge.triangle);
        let along_normal = directions.iter().all(|direction| *direction == normal);
        let along = (!along_normal).then_some(&directions[..]);
        let functionals =
            Functionals::new(degree, (&triangle, edge.local), normal, along, material, gamma);
        let boundary = match line.last() {
            Some(last) if &*last.boundary == name => Arc::clone(&last.boundary),
            _ => Arc::from(name),
        };
        line.push(ContactFace {
            edge,
            boundary,
            nodes: space.nodes_of(edge.triangle).to_vec(),
            length,
            normal,
            gamma,
            directions,
            along_normal,
            places,
            curved: geometry.is_curved(edge),
            gap,
            functionals,
        });
    }
    check_sides(problem, &line)?;
    Ok(line)
}

/// No edge that faces away from its obstacle lies inside it, and no boundary faces away as a whole: else the obstacle is on the
/// other side of the body. Other edges may face away, as those of the upper half of a disk on a floor.
fn check_sides(problem: &Problem, line: &[ContactFace]) -> Result<(), DataError> {
    let is_away = |edge: &&ContactFace| {
        edge.directions.iter().all(|direction| direction.dot(&edge.normal) <= 0.0)
    };
    let is_inside = |edge: &&ContactFace| edge.gap.iter().all(|&gap| gap <= 0.0);
    let faces = |edge: &&ContactFace| !is_away(edge);
    let facing: BTreeSet<&str> = line.iter().filter(faces).map(|edge| &*edge.boundary).collect();
    let is_wrong = |edge: &&ContactFace| {
        is_away(edge) && (is_inside(edge) || !facing.contains(&*edge.boundary))
    };
    match line.iter().find(is_wrong) {
        None => Ok(()),
        Some(edge) => {
            let [x, y] = edge.places[0];
            Err(DataError::WrongSide {
                obstacle: problem.obstacle_of(&edge.boundary).unwrap_or_default().to_owned(),
                boundary: edge.boundary.to_string(),
                x,
                y,
                direction: edge.directions[0].into(),
            })
        }
    }
}

/// The obstacles as seen from the contact line.
struct ContactGeometry<'a> {
    problem: &'a Problem,
    smooth: SmoothBoundary,
}

impl<'a> ContactGeometry<'a> {
    fn new(problem: &'a Problem) -> Self {
        ContactGeometry { problem, smooth: SmoothBoundary::new(&problem.mesh) }
    }

    /// Start (0), end (1) or middle (2) of the smooth boundary along an edge, if it is not straight there.
    fn point(&self, edge: BoundaryEdge, a: usize) -> Option<SmoothPoint> {
        self.smooth.along(&self.problem.mesh, edge).map(|points| points[a])
    }

    fn is_curved(&self, edge: BoundaryEdge) -> bool {
        self.smooth.at_ends(edge).is_some()
    }

    /// Gap and direction at a point of the boundary `name`.
    fn closest(&self, name: &str, point: SmoothPoint) -> Result<Closest, DataError> {
        match self.problem.conditions.get(name) {
            Some(Condition::Contact { gap }) => {
                let gap = finite(&**gap, point.place, || {
                    format!("[boundary.{}] contact.gap", key(name))
                })?;
                Ok(Closest { gap, direction: point.normal })
            }
            Some(Condition::Obstacle(obstacle, geometry)) => {
                geometry.closest(point.place, || format!("[obstacle.{}]", key(obstacle)))
            }
            _ => Err(DataError::NoContact),
        }
    }

    /// n~ at the start or at the end of an edge.
    fn direction(
        &self,
        edge: BoundaryEdge,
        name: &str,
        a: usize,
    ) -> Result<Vector2<f64>, DataError> {
        let mesh = &self.problem.mesh;
        let on_facet = SmoothPoint {
            place: mesh.vertices()[mesh.ends(edge)[a]],
            normal: mesh.length_and_normal(edge).1,
        };
        let point = self.point(edge, a).unwrap_or(on_facet);
        match self.problem.conditions.get(name) {
            Some(Condition::Obstacle(..)) => Ok(self.closest(name, point)?.direction),
            _ => Ok(point.normal),
        }
    }
}
