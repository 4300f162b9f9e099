//! Pairs of boundaries of elastic bodies that may touch: the points that face each other, and the pieces of contact between
//! them.
//!
//! The smooth boundaries are those of `boundary_normals`. x1 on boundary 1 and x2 on boundary 2, with the outward normals n1 and n2
//! there, are *partners* if
//!
//! ```text
//!     (x2 - x1) x (n1 - n2) = 0,    n1 . n2 <= -1/2,    |x2 - x1| <= reach.
//! ```
//!
//! This is symmetric in the bodies. The direction of contact at partners is d = (n1 - n2) / |n1 - n2|, from body 1 to body 2; the gap
//! is g = (x2 - x1) . d, negative where the bodies overlap. Along boundary 2 the first expression has the derivative
//! t2 x (n1 - n2) - (x2 - x1) x n2', of which the first term is at least 3/2 and the second at most reach times the curvature: with
//! reach times curvature below 3/2 a point has at most one partner on each smooth stretch. Of several, the nearest counts, seen
//! from either side.
//!
//! A piece of contact lies between two neighbouring nodes of either boundary that have partners. Displacements are those on the
//! chords, where the lines through the partners along d meet them, so that the two points of a node of a piece differ by a multiple
//! of d: a rigid motion of both bodies together has no jump, and forces and moments of the two sides cancel.

mod error;
pub(crate) mod search;

use std::collections::BTreeSet;
use std::sync::Arc;

use nalgebra::Vector2;

pub use self::error::PairError;
pub(crate) use self::error::named;
use self::search::{Boundary, Facing, Stretch};
use crate::model::boundary_normals::{SmoothBoundary, unit};
use crate::model::data::{DataError, finite};
use crate::model::element::Degree;
use crate::model::function::SharedFunction;
use crate::model::law::{Friction, Law};
use crate::model::mesh::{BoundaryEdge, Mesh, MeshError, length};
use crate::model::problem::Problem;
use crate::model::rigid::Parts;
use crate::model::tree::Bounds;
use crate::quote::quoted;

/// Two boundaries that touch each other.
#[derive(Clone)]
pub struct Pair {
    /// The names of the boundaries, of one body or of two.
    pub boundaries: [String; 2],
    /// The initial gap in place of the one between the boundaries of the mesh; negative: the bodies overlap (a press fit).
    pub clearance: Option<SharedFunction>,
    /// The largest distance at which points may face each other; `None`: a quarter of the smaller body, and at most the least
    /// radius of curvature.
    pub reach: Option<f64>,
    /// The law between the two boundaries.
    pub law: Law,
    /// Friction between them, beside contact; where there is none they are smooth.
    pub friction: Option<Friction>,
}

impl Pair {
    /// Contact between two boundaries, the gap being that of the mesh.
    pub fn new(first: impl Into<String>, second: impl Into<String>) -> Self {
        Pair {
            boundaries: [first.into(), second.into()],
            clearance: None,
            reach: None,
            law: Law::Contact,
            friction: None,
        }
    }

    /// Sets the initial gap, in place of the one between the boundaries of the mesh.
    #[must_use]
    pub fn with_clearance(
        self,
        clearance: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Pair { clearance: Some(Arc::new(clearance)), ..self }
    }

    /// Sets the largest distance at which points may face each other.
    #[must_use]
    pub fn with_reach(self, reach: f64) -> Self {
        Pair { reach: Some(reach), ..self }
    }

    /// Sets what holds between the boundaries.
    #[must_use]
    pub fn with_law(self, law: Law) -> Self {
        Pair { law, ..self }
    }

    /// Sets the friction between the boundaries.
    #[must_use]
    pub fn with_friction(self, friction: Friction) -> Self {
        Pair { friction: Some(friction), ..self }
    }

    /// The largest distance at which points of the two boundaries may face each other.
    ///
    /// # Errors
    /// A reach that is not positive, or beyond 3/2 of the least radius of curvature; unknown boundaries.
    pub(crate) fn reach_on(&self, mesh: &Mesh, smooth: &SmoothBoundary) -> Result<f64, DataError> {
        let (curvature, place) = self.largest_curvature(mesh, smooth)?;
        match self.reach {
            None => Ok((self.smaller_body(mesh)? / 4.0).min(1.0 / curvature)),
            Some(reach) if !(reach > 0.0 && reach.is_finite()) => {
                Err(PairError::Reach { pair: self.boundaries.clone(), reach }.into())
            }
            Some(reach) if reach * curvature >= MOST_TURN => {
                let most = MOST_TURN / curvature;
                let pair = self.boundaries.clone();
                Err(PairError::TooFar { pair, reach, most, radius: 1.0 / curvature, place }.into())
            }
            Some(reach) => Ok(reach),
        }
    }

    /// The largest curvature of the two boundaries, and where it is.
    fn largest_curvature(
        &self,
        mesh: &Mesh,
        smooth: &SmoothBoundary,
    ) -> Result<(f64, [f64; 2]), DataError> {
        let (mut curvature, mut place) = (0.0, [0.0; 2]);
        for name in &self.boundaries {
            for &edge in self.edges(mesh, name)? {
                let curve = smooth.edge(mesh, edge);
                if curve.curvature() > curvature {
                    (curvature, place) = (curve.curvature(), curve.at(0.5).0.into());
                }
            }
        }
        Ok((curvature, place))
    }

    /// The length beside which an overlap of the two bodies is to be small: the least radius of curvature of the boundaries, or how wide
    /// the narrower body is, the shorter side of the box around it.
    ///
    /// # Errors
    /// Unknown boundaries.
    pub(crate) fn scale(&self, mesh: &Mesh, smooth: &SmoothBoundary) -> Result<f64, DataError> {
        let (curvature, _) = self.largest_curvature(mesh, smooth)?;
        let boxes = self.boxes(mesh)?;
        let width = |Bounds { low, high }: Bounds| (high[0] - low[0]).min(high[1] - low[1]);
        Ok(boxes.into_iter().map(width).fold(1.0 / curvature, f64::min))
    }

    /// The edges of a boundary of the pair.
    fn edges<'m>(&self, mesh: &'m Mesh, name: &str) -> Result<&'m [BoundaryEdge], DataError> {
        mesh.edges_of(name).map_err(|error| match error {
            MeshError::InnerEdge { boundary, ends } => {
                PairError::Inner { boundary, pair: self.boundaries.clone(), ends }.into()
            }
            other => other.into(),
        })
    }

    /// The size of the smaller body: the longer side of the box around it.
    fn smaller_body(&self, mesh: &Mesh) -> Result<f64, DataError> {
        Ok(self.boxes(mesh)?.into_iter().map(Bounds::size).fold(f64::INFINITY, f64::min))
    }

    /// The boxes around the bodies of the two boundaries.
    fn boxes(&self, mesh: &Mesh) -> Result<Vec<Bounds>, DataError> {
        let parts = Parts::new(mesh);
        let around = |name: &String| {
            let part = mesh.edges_of(name)?.first().map(|edge| parts.of_triangle()[edge.triangle]);
            let own = mesh.triangles().iter().zip(parts.of_triangle());
            let corners = own.filter(|(_, of)| Some(**of) == part).flat_map(|(corners, _)| corners);
            Ok(Bounds::around(corners.map(|&v| mesh.vertices()[v])))
        };
        self.boundaries.iter().map(around).collect()
    }

    /// g at partners.
    fn gap(&self, facing: &Facing) -> Result<f64, DataError> {
        let [x, y] = facing.points;
        match &self.clearance {
            None => Ok((y - x).dot(&facing.direction)),
            Some(clearance) => {
                let [first, second] = &self.boundaries;
                finite(&**clearance, ((x + y) / 2.0).into(), || {
                    let [first, second] = [first, second].map(|name| quoted(name, '\''));
                    format!("the clearance between {first} and {second}")
                })
            }
        }
    }
}

/// The pieces of contact of each pair of a problem.
///
/// # Errors
/// As `pieces`; a boundary of a pair that has a condition as well, and a pair that is given twice.
pub(crate) fn of_problem(
    problem: &Problem,
    smooth: &SmoothBoundary,
    degree: Degree,
) -> Result<Vec<Vec<PairPiece>>, DataError> {
    let mut known = BTreeSet::new();
    for Pair { boundaries, .. } in &problem.pairs {
        let mut sorted = boundaries.clone();
        sorted.sort();
        if !known.insert(sorted) {
            return Err(PairError::Twice { pair: boundaries.clone() }.into());
        }
        let occupied = boundaries.iter().find(|name| problem.conditions.contains_key(*name));
        if let Some(boundary) = occupied.cloned() {
            return Err(PairError::Occupied { boundary, pair: boundaries.clone() }.into());
        }
    }
    problem.pairs.iter().map(|pair| pieces(&problem.mesh, smooth, pair, degree)).collect()
}

/// The largest reach, in radii of curvature: the head of this file.
const MOST_TURN: f64 = 1.5;

/// A piece of contact between two boundaries. Values at its nodes have the order start, end, and for P2 the middle; it runs along
/// boundary 1 with the body on the left.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PairPiece {
    /// The two sides, of boundary 1 and of boundary 2.
    pub(crate) sides: [PairSide; 2],
    /// d at the nodes: unit vectors from body 1 to body 2.
    pub(crate) directions: Vec<Vector2<f64>>,
    /// g at the nodes.
    pub(crate) gap: Vec<f64>,
    /// The mean of the lengths of the two chords.
    pub(crate) length: f64,
}

/// One side of a piece.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PairSide {
    /// The edge that it is a part of.
    pub(crate) edge: BoundaryEdge,
    /// Where on the edge the nodes of the piece are: from 0 at the edge's start to 1 at its end.
    pub(crate) places: Vec<f64>,
    /// The length of its chord, divided by the length of the piece.
    pub(crate) ratio: f64,
}

/// The pieces of contact of a pair, along boundary 1.
///
/// # Errors
/// Unknown boundaries, a clearance without a value, and what [`PairError`] says.
pub(crate) fn pieces(
    mesh: &Mesh,
    smooth: &SmoothBoundary,
    pair: &Pair,
    degree: Degree,
) -> Result<Vec<PairPiece>, DataError> {
    let reach = pair.reach_on(mesh, smooth)?;
    let [first, second] = &pair.boundaries;
    if first == second {
        return Err(PairError::Same { boundary: first.clone() }.into());
    }
    let sides = [Boundary::new(mesh, smooth, first)?, Boundary::new(mesh, smooth, second)?];
    let named = || pair.boundaries.clone();
    if let Some(place) = search::shared(&sides) {
        return Err(PairError::Shared { pair: named(), place: place.into() }.into());
    }
    if let Some(corners) = search::corner_on_corner(&sides, reach) {
        return Err(PairError::Corners { pair: named(), places: corners.map(Into::into) }.into());
    }
    let mut pieces = Vec::new();
    for Stretch { on, ends } in search::stretches(&sides, reach) {
        pieces.extend(piece(&sides, pair, degree, on, ends)?);
    }
    if pieces.is_empty() {
        let (places, distance) = search::nearest(&sides);
        let places = places.map(Into::into);
        return Err(PairError::NoPartner { pair: named(), reach, places, distance }.into());
    }
    Ok(pieces)
}

/// The pairs of two bodies that face each other somewhere, no further apart than their edges are long.
pub(crate) fn touching(mesh: &Mesh, pairs: &[Pair]) -> Vec<Pair> {
    let (parts, smooth) = (Parts::new(mesh), SmoothBoundary::new(mesh));
    let bodies = |name: &String| -> BTreeSet<usize> {
        let edges = mesh.edges_of(name).unwrap_or_default();
        edges.iter().map(|edge| parts.of_triangle()[edge.triangle]).collect()
    };
    let is_near = |piece: &PairPiece| {
        let length = |side: &PairSide| mesh.length_and_normal(side.edge).0;
        let longest = piece.sides.iter().map(length).fold(0.0, f64::max);
        piece.gap.iter().all(|gap| gap.abs() <= longest)
    };
    let touches = |pair: &&Pair| {
        let [first, second] = pair.boundaries.each_ref().map(bodies);
        first.is_disjoint(&second)
            && pieces(mesh, &smooth, pair, Degree::One).is_ok_and(|all| all.iter().any(is_near))
    };
    pairs.iter().filter(touches).cloned().collect()
}

/// The piece between two pairs of partners that are on the edges `on` of the two boundaries. `None` if rounding leaves nothing of it.
fn piece(
    sides: &[Boundary; 2],
    pair: &Pair,
    degree: Degree,
    on: [usize; 2],
    ends: [Facing; 2],
) -> Result<Option<PairPiece>, DataError> {
    let curves = [0, 1].map(|i| sides[i].curves[on[i]]);
    let mut places = [0, 1].map(|i| ends.map(|end| end.on_chord(i, on[i], &curves[i])).to_vec());
    let distance = length(ends[0].points[1] - ends[0].points[0]);
    // Boundary 2 runs the other way.
    let is_left = |i: usize, share: f64| share > sides[i].rounding(on[i], distance);
    if !(is_left(0, places[0][1] - places[0][0]) && is_left(1, places[1][0] - places[1][1])) {
        return Ok(None);
    }
    let mut nodes = ends.to_vec();
    if degree == Degree::Two {
        let middle = |i: usize| curves[i].on_chord((places[i][0] + places[i][1]) / 2.0);
        let direction = unit(ends[0].direction + ends[1].direction);
        let from = (middle(0) + middle(1)) / 2.0;
        nodes.push(Facing::along(from, direction, &curves));
        for (places, curve) in places.iter_mut().zip(&curves) {
            places.push(search::cut(from, direction, curve));
        }
    }
    let lengths = [0, 1].map(|i| (places[i][1] - places[i][0]).abs() * curves[i].length());
    let length = (lengths[0] + lengths[1]) / 2.0;
    let [first, second] = places;
    let side = |i: usize, places: Vec<f64>| PairSide {
        edge: sides[i].edges[on[i]],
        places,
        ratio: lengths[i] / length,
    };
    Ok(Some(PairPiece {
        sides: [side(0, first), side(1, second)],
        directions: nodes.iter().map(|node| node.direction).collect(),
        gap: nodes.iter().map(|node| pair.gap(node)).collect::<Result<_, _>>()?,
        length,
    }))
}

#[cfg(test)]
mod tests;
