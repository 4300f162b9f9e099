//! Errors of a mesh.

use thiserror::Error;

use crate::memory::OutOfMemory;
use crate::quote::{number, quoted};

/// The width of a void, beside the local edge, below which the void is a seam: coordinates with six digits leave 1e-6 beside
/// edges of 1e-3. A slot that is meant has shorter edges along it.
pub(crate) const TOUCHING: f64 = 1e-3;

/// Errors of a mesh. Vertices and triangles are counted from 0, or by the numbers of the file they came from.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
pub enum MeshError {
    #[error("the mesh has no triangle; expected at least one")]
    Empty,
    #[error("vertex {vertex} is at ({}, {}); expected finite coordinates", number(*x), number(*y))]
    NotFinite { vertex: usize, x: f64, y: f64 },
    #[error(
        "triangle {triangle} names vertex {vertex}; expected one of the {count} vertices of this mesh"
    )]
    NoSuchVertex { triangle: usize, vertex: usize, count: usize },
    #[error("triangle {triangle} (vertices {}, {}, {}) has area {}: list its vertices counter-clockwise", vertices[0], vertices[1], vertices[2], number(*area))]
    Clockwise { triangle: usize, vertices: [usize; 3], area: f64 },
    #[error("triangle {triangle} (vertices {}, {}, {}) is flat: its area {} is nothing beside its diameter {}", vertices[0], vertices[1], vertices[2], number(*area), number(*diameter))]
    Flat { triangle: usize, vertices: [usize; 3], area: f64, diameter: f64 },
    #[error("vertices {} and {} are both at ({}, {}); expected one vertex there (mesh.merge makes them one), or two bodies that are a [[pair]]", vertices[0], vertices[1], number(*x), number(*y))]
    Duplicate { vertices: [usize; 2], x: f64, y: f64 },
    #[error(
        "two bodies {} at ({}, {}), which belongs to triangles {} and {}{}",
        if *overlap { "overlap" } else { "touch" }, number(*x), number(*y), triangles[0], triangles[1], in_reach(pair.as_ref())
    )]
    Bodies {
        triangles: [usize; 2],
        x: f64,
        y: f64,
        overlap: bool,
        pair: Option<([String; 2], f64)>,
    },
    #[error(
        "the surfaces {} and {} have no edge in common; expected two that meet in a curve",
        quoted(&surfaces[0], '\''), quoted(&surfaces[1], '\'')
    )]
    NoCommonEdge { surfaces: [String; 2] },
    #[error("no {kind} {}; this mesh has: {known}", quoted(name, '\''))]
    NoSuchName { kind: &'static str, name: String, known: String },
    #[error(
        "a boundary named {} is made between two surfaces, and the mesh has one already; expected another name for that",
        quoted(name, '\'')
    )]
    NameOfSplit { name: String },
    #[error("vertex {vertex} at ({}, {}) belongs to no triangle", number(*x), number(*y))]
    Unused { vertex: usize, x: f64, y: f64 },
    #[error("triangles {} and {} overlap: both lie on the same side of the edge from vertex {} to vertex {}", triangles[0], triangles[1], vertices[0], vertices[1])]
    Overlap { triangles: [usize; 2], vertices: [usize; 2] },
    #[error("triangles {} and {} overlap at ({}, {}): expected triangles that cover no point twice", triangles[0], triangles[1], number(*x), number(*y))]
    Overlapping { triangles: [usize; 2], x: f64, y: f64 },
    #[error("vertices {} at ({}, {}) and {} at ({}, {}) are {:e} apart with no triangle between them, beside edges of length {}: the body would be torn there; expected one vertex, or a gap of more than {} times the edge (mesh.merge = {merge:e} makes them one; two bodies that touch each other are a [[pair]])", vertices[0], number(places[0][0]), number(places[0][1]), vertices[1], number(places[1][0]), number(places[1][1]), short(*distance), short(*local), TOUCHING)]
    Near { vertices: [usize; 2], places: [[f64; 2]; 2], distance: f64, local: f64, merge: f64 },
    #[error("vertex {vertex} at ({}, {}) hangs inside the edge between vertices {} and {} of triangle {triangle}{}: neighbours must share whole edges", number(*x), number(*y), edge[0], edge[1], beside(*off))]
    Hanging { vertex: usize, x: f64, y: f64, edge: [usize; 2], triangle: usize, off: f64 },
    #[error("vertex {vertex} at ({}, {}) alone joins two parts of the body: a point holds nothing, and they would move as if it were not there; expected parts that share an edge, or no vertex", number(*x), number(*y))]
    JoinedAtVertex { vertex: usize, x: f64, y: f64 },
    #[error("boundary {}: no triangle has an edge from ({}, {}) to ({}, {})", quoted(boundary, '\''), number(ends[0][0]), number(ends[0][1]), number(ends[1][0]), number(ends[1][1]))]
    NoSuchEdge { boundary: String, ends: [[f64; 2]; 2] },
    #[error("boundary {}: its edge from ({}, {}) to ({}, {}) lies inside the body, between two triangles; nothing can be prescribed there", quoted(boundary, '\''), number(ends[0][0]), number(ends[0][1]), number(ends[1][0]), number(ends[1][1]))]
    InnerEdge { boundary: String, ends: [[f64; 2]; 2] },
    #[error("{} {} names {} {number}; expected numbers from 0 on of the {count} {} of this mesh", of[0], quoted(name, '\''), of[1], of[2])]
    Beyond { of: [&'static str; 3], name: String, number: usize, count: usize },
    #[error("{count} points have the name {}; expected one", quoted(name, '\''))]
    NotOnePoint { name: String, count: usize },
    #[error(
        "the mesh has a boundary named {} already; expected another name beside where",
        quoted(name, '\'')
    )]
    NameTaken { name: String },
    #[error("no edge of the boundary has both ends where this holds; the body lies in {} <= x <= {}, {} <= y <= {}", number(low[0]), number(high[0]), number(low[1]), number(high[1]))]
    Nowhere { low: [f64; 2], high: [f64; 2] },
    #[error("the edge from ({}, {}) to ({}, {}) belongs to the boundaries {} and {}; expected a condition on one of them only", number(ends[0][0]), number(ends[0][1]), number(ends[1][0]), number(ends[1][1]), quoted(&names[0], '\''), quoted(&names[1], '\''))]
    NamedTwice { ends: [[f64; 2]; 2], names: [String; 2] },
    #[error("{0}; use a coarser mesh")]
    OutOfMemory(#[from] OutOfMemory),
    #[error("{name} = {}; expected a positive finite length", number(*value))]
    Size { name: &'static str, value: f64 },
    #[error("{name} = {value}; expected at least one cell")]
    NoCells { name: &'static str, value: usize },
    #[error("nx = {nx} and ny = {ny} make more than {most} cells; expected fewer")]
    TooManyCells { nx: usize, ny: usize, most: usize },
}

/// The expectation where two bodies meet, by the pair that they make.
fn in_reach(pair: Option<&([String; 2], f64)>) -> String {
    match pair {
        None => ": expected bodies that are apart, or a [[pair]] of the boundaries that touch each other".to_owned(),
        Some(([first, second], reach)) => format!(
            ", beyond the reach of {} of the pair of {} and {}: expected bodies that are apart there, or a larger reach",
            number(short(*reach)), quoted(first, '\''), quoted(second, '\'')
        ),
    }
}

fn beside(off: f64) -> String {
    if off == 0.0 { String::new() } else { format!(", {:e} beside it", short(off)) }
}

/// A length to three digits.
fn short(length: f64) -> f64 {
    format!("{length:.2e}").parse().unwrap_or(length)
}

impl MeshError {
    /// Restates the error in the numbers of the file that the mesh came from.
    #[must_use]
    pub(crate) fn renumbered(
        mut self,
        of_vertex: impl Fn(usize) -> usize,
        of_triangle: impl Fn(usize) -> usize,
    ) -> MeshError {
        use MeshError::*;
        let two = |pair: &mut [usize; 2]| *pair = pair.map(&of_vertex);
        match &mut self {
            OutOfMemory(_) => {}
            NotFinite { vertex, .. } | Unused { vertex, .. } | JoinedAtVertex { vertex, .. } => {
                *vertex = of_vertex(*vertex);
            }
            NoSuchVertex { triangle, .. } => *triangle = of_triangle(*triangle),
            Clockwise { triangle, vertices, .. } | Flat { triangle, vertices, .. } => {
                *triangle = of_triangle(*triangle);
                *vertices = vertices.map(&of_vertex);
            }
            Duplicate { vertices, .. } => two(vertices),
            Overlap { triangles, vertices } => {
                *triangles = triangles.map(&of_triangle);
                two(vertices);
            }
            Overlapping { triangles, .. } | Bodies { triangles, .. } => {
                *triangles = triangles.map(&of_triangle)
            }
            Near { vertices, .. } => two(vertices),
            Hanging { vertex, edge, triangle, .. } => {
                *vertex = of_vertex(*vertex);
                *triangle = of_triangle(*triangle);
                two(edge);
            }
            Empty
            | Beyond { .. }
            | NotOnePoint { .. }
            | NameTaken { .. }
            | Nowhere { .. }
            | NamedTwice { .. }
            | NoSuchEdge { .. }
            | InnerEdge { .. }
            | NoCommonEdge { .. }
            | NameOfSplit { .. }
            | NoSuchName { .. }
            | Size { .. }
            | NoCells { .. }
            | TooManyCells { .. } => {}
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_of_an_error_is_that_of_the_file_and_places_stay() {
        let (x, y) = (0.5, 0.25);
        // With numbers that no vertex has in common with a triangle, and what they are in the file.
        let all = |v: [usize; 3], t: [usize; 2]| {
            let ([vertex, w, _], [triangle, _]) = (v, t);
            let two = [vertex, w];
            let near = [[x, y], [y, x]];
            [
                MeshError::NotFinite { vertex, x, y },
                MeshError::Unused { vertex, x, y },
                MeshError::JoinedAtVertex { vertex, x, y },
                MeshError::NoSuchVertex { triangle, vertex: 99, count: 9 },
                MeshError::Clockwise { triangle, vertices: v, area: x },
                MeshError::Flat { triangle, vertices: v, area: x, diameter: y },
                MeshError::Duplicate { vertices: two, x, y },
                MeshError::Overlap { triangles: t, vertices: two },
                MeshError::Overlapping { triangles: t, x, y },
                MeshError::Bodies { triangles: t, x, y, overlap: true, pair: None },
                MeshError::Near { vertices: two, places: near, distance: x, local: y, merge: 1e-3 },
                MeshError::Hanging { vertex, x, y, edge: [v[1], v[2]], triangle, off: 0.0 },
                MeshError::NoCells { name: "nx", value: 0 },
            ]
        };
        let here = all([1, 2, 3], [7, 8]);
        let in_file = all([101, 102, 103], [1007, 1008]);
        for (here, in_file) in here.into_iter().zip(in_file) {
            let found = here.clone().renumbered(|v| v + 100, |t| t + 1000);
            assert_eq!(found, in_file);
            assert_eq!(found.to_string() == here.to_string(), found == here, "{found}");
        }
    }
}
