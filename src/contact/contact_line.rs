//! Gamma_C on the mesh: its pieces with their directions and gaps, gamma = gamma0 h_T of (7), the coercivity number kappa.
//!
//! The direction of contact is a field n~, given at the nodes: by the obstacle's closest point where there is an obstacle, else
//! by the normal of the smooth boundary (`boundary_normals`), from which the gap is measured. On a straight line without an
//! obstacle n~ = n, and the method is the paper's, to the bit.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::piece::{Piece, PieceGeometry, PieceNode, SideData, Stretch};
use crate::kernel::Scalar;
use crate::kernel::contact_edge::traction_stiffness;
use crate::model::boundary_normals::{SmoothBoundary, SmoothPoint};
use crate::model::data::{DataError, finite};
use crate::model::element::Degree;
use crate::model::function::SharedFunction;
use crate::model::law::{Bound, Friction, Law};
use crate::model::mesh::{BoundaryEdge, ROUNDED};
use crate::model::obstacle::Closest;
use crate::model::pairs::{self, Pair, PairPiece, PairSide};
use crate::model::problem::{Condition, Problem};
use crate::model::space::Space;
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
    /// As `ContactLine::new`.
    pub fn new(problem: &Problem, degree: Degree) -> Result<Self, DataError> {
        ContactLine::new(problem, &Space::new(&problem.mesh, degree))?.coercivity(problem)
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

/// Points by x, then by y.
fn order(a: &[f64; 2], b: &[f64; 2]) -> std::cmp::Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
}

/// The edges of all contact boundaries with the names of these, each boundary in chains along the boundary.
fn contact_edges(problem: &Problem) -> Result<Vec<(BoundaryEdge, &str)>, DataError> {
    let mut edges = Vec::new();
    for (name, condition) in &problem.conditions {
        if condition.is_contact() {
            let own = problem.mesh.edges_of(name)?.to_vec();
            let chained = chains(own, |&edge| problem.mesh.ends(edge));
            edges.extend(chained.into_iter().map(|edge| (edge, name.as_str())));
        }
    }
    if edges.is_empty() && problem.pairs.is_empty() { Err(DataError::NoContact) } else { Ok(edges) }
}

/// Sorts edges or pieces into chains, in which each item starts where the item before it ends.
fn chains<T, K: Ord + Copy>(items: Vec<T>, ends: impl Fn(&T) -> [K; 2]) -> Vec<T> {
    let follows = |before: &T, after: &T| ends(before)[1] == ends(after)[0];
    let is_closed = items.first().zip(items.last()).is_some_and(|(a, b)| follows(b, a));
    if !is_closed && items.is_sorted_by(follows) {
        return items;
    }
    let targets: BTreeSet<K> = items.iter().map(|item| ends(item)[1]).collect();
    let mut from: BTreeMap<K, T> = items.into_iter().map(|item| (ends(&item)[0], item)).collect();
    // First the chains that have a beginning, then the closed ones.
    let (closed, open): (Vec<K>, Vec<K>) = from.keys().partition(|start| targets.contains(start));
    let mut chained = Vec::with_capacity(from.len());
    for start in open.into_iter().chain(closed) {
        let mut next = from.remove(&start);
        while let Some(item) = next {
            next = from.remove(&ends(&item)[1]);
            chained.push(item);
        }
    }
    chained
}

/// Gamma_C without gamma: where its pieces lie, their directions and gaps.
#[derive(Clone, Debug)]
pub struct ContactLine {
    degree: Degree,
    pieces: Vec<Arc<PieceGeometry>>,
}

impl ContactLine {
    /// Gamma_C of a problem, with the nodes that a space has along it.
    ///
    /// # Errors
    /// [`DataError::NoContact`], a gap that is not finite, an obstacle on the other side of the body, and unknown boundary names.
    pub(crate) fn new(problem: &Problem, space: &Space) -> Result<Self, DataError> {
        let obstacles = Obstacles { problem, smooth: SmoothBoundary::new(&problem.mesh) };
        let mut pieces: Vec<PieceGeometry> = Vec::new();
        for (edge, name) in contact_edges(problem)? {
            let boundary = match pieces.last() {
                Some(last) if &*last.first().boundary == name => Arc::clone(&last.first().boundary),
                _ => Arc::from(name),
            };
            pieces.push(obstacles.piece(space, edge, boundary)?);
        }
        without_idle_friction(problem, &mut pieces)?;
        let mut pieces: Vec<Arc<PieceGeometry>> = pieces.into_iter().map(Arc::new).collect();
        check_sides(problem, &pieces)?;
        let degree = space.degree();
        let of_pairs = pairs::of_problem(problem, &obstacles.smooth, degree)?;
        for (pair, of_pair) in problem.pairs.iter().zip(of_pairs) {
            let names = pair.boundaries.each_ref().map(|name| Arc::from(name.as_str()));
            let between = |piece| obstacles.piece_between(&names, pair, piece);
            let mut of_pair: Vec<PieceGeometry> =
                of_pair.into_iter().map(between).collect::<Result<_, _>>()?;
            if pair.friction.is_some() {
                let has_contact = pair.law == Law::Contact;
                let what = || pairs::named(&pair.boundaries);
                check_friction(problem, has_contact, what, of_pair.iter_mut().collect())?;
            }
            let place = |piece: &PieceGeometry, a: usize| {
                piece.first().place(&problem.mesh, a).map(f64::to_bits)
            };
            let chained = chains(of_pair, |piece| [0, 1].map(|a| place(piece, a)));
            pieces.extend(chained.into_iter().map(Arc::new));
        }
        begin_at(&problem.slip, &mut pieces)?;
        Ok(ContactLine { degree, pieces })
    }

    /// Its pieces, each boundary in chains along the boundary.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = &PieceGeometry> {
        self.pieces.iter().map(|piece| &**piece)
    }

    /// C_h of kappa = gamma0 C_h.
    ///
    /// # Errors
    /// [`DataError::NoContact`].
    pub(crate) fn coercivity(&self, problem: &Problem) -> Result<Coercivity, DataError> {
        let mesh = &problem.mesh;
        let constants = self.constants(problem);
        let mut sorted: Vec<f64> = constants.values().copied().collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let typical = sorted.get(sorted.len() / 2).copied().ok_or(DataError::NoContact)?;
        let constant = sorted.last().copied().ok_or(DataError::NoContact)?;
        // Equal edges differ by rounding, which must not decide the choice.
        let stretches = self.pieces.iter().flat_map(|piece| &piece.stretches);
        let equal = stretches.filter(|s| constants[&s.edge.triangle] >= constant * (1.0 - ROUNDED));
        let ends = |stretch: &Stretch| {
            let mut ends = mesh.places_of_ends(stretch.edge);
            ends.sort_by(order);
            ends
        };
        let first = equal.map(ends).min_by(|[a, b], [c, d]| order(a, c).then(order(b, d)));
        let limiting_edge = first.ok_or(DataError::NoContact)?;
        Ok(Coercivity { constant, typical, limiting_edge })
    }

    /// kappa / gamma0 on each triangle with an edge on Gamma_C.
    fn constants(&self, problem: &Problem) -> BTreeMap<usize, f64> {
        let mesh = &problem.mesh;
        let mut shares = Vec::new();
        for piece in &self.pieces {
            let [start, end] = [0, 1].map(|a| piece.nodes[a].direction);
            let lengths = piece.stretches.iter().map(|s| mesh.length_and_normal(s.edge).0);
            let chords = piece.chords(&lengths.collect::<Vec<f64>>());
            for (i, &Stretch { edge, .. }) in piece.stretches.iter().enumerate() {
                let (length, normal) = mesh.length_and_normal(edge);
                let (both, cosine) = (piece.law.components() > 1, start.dot(&end));
                let t = edge.triangle;
                let (triangle, material) = (mesh.triangle(t), problem.material.of(t));
                let area = triangle.double_area() / 2.0;
                let radii = piece.radii(i, |edge| {
                    let triangle = edge.triangle;
                    problem.material.of(triangle).radii(&mesh.triangle(triangle))
                });
                let share = chords.map(|chords| chords.share(i, radii, f64::max));
                let ratio = share.map_or(length, |share| share * length);
                let turning = (start != end).then_some((cosine, both));
                let radii = radii.map(|radii| (radii.of_piece, radii.of_triangle));
                let counted = self.degree.counted_length(ratio, turning, radii, f64::sqrt);
                let direction = (start == end && !both).then_some(start);
                let stiffness = traction_stiffness(material, normal, direction, f64::sqrt);
                let value =
                    self.degree.coercivity_constant(stiffness, mesh.diameter(t), counted, area);
                shares.push(Share::new(piece, i, value));
            }
        }
        by_triangle(shares, f64::max)
    }

    /// The pieces of method (8).
    pub(crate) fn with_gamma(&self, problem: &Problem, space: &Space, gamma: Gamma) -> Vec<Piece> {
        let mesh = space.mesh();
        let gamma0: Box<dyn Fn(usize) -> f64> = match gamma {
            Gamma::Uniform(gamma0) => Box::new(move |_| gamma0),
            Gamma::Local(kappa) => {
                let constants = self.constants(problem);
                Box::new(move |t| kappa / constants[&t])
            }
        };
        let side = |stretch: &Stretch| {
            let t = stretch.edge.triangle;
            let (length, normal) = mesh.length_and_normal(stretch.edge);
            let gamma = gamma0(t) * mesh.diameter(t);
            let (triangle, material) = (mesh.triangle(t), *problem.material.of(t));
            let radii = material.radii(&triangle);
            SideData { triangle, material, length, normal, gamma, radii }
        };
        let mut start = 0;
        let piece = |geometry: &Arc<PieceGeometry>| {
            let sides: Vec<SideData<f64>> = geometry.stretches.iter().map(side).collect();
            let piece = Piece::new(geometry, space, start, &sides);
            start = piece.functionals().end;
            piece
        };
        self.pieces.iter().map(piece).collect()
    }
}

/// The part of kappa on a triangle that a side of a piece would cause if alone on its edge.
pub(crate) struct Share<S> {
    /// The triangle, its edge, and the boundary on the other side, if there is one.
    place: (usize, usize, Option<Arc<str>>),
    /// The part of the edge.
    part: [f64; 2],
    value: S,
}

impl<S> Share<S> {
    /// The share of side `i` of a piece.
    pub(crate) fn new(piece: &PieceGeometry, i: usize, value: S) -> Self {
        let Stretch { edge, positions, .. } = &piece.stretches[i];
        let other = piece.stretches.len() > 1;
        let partner = other.then(|| Arc::clone(&piece.stretches[1 - i].boundary));
        let part = [positions[0].min(positions[1]), positions[0].max(positions[1])];
        Share { place: (edge.triangle, edge.local, partner), part, value }
    }
}

/// kappa on each triangle: the sum over its edges and their partners. Of pieces on different parts of one edge the `largest`
/// counts, for their integrals add up to at most that over the edge.
pub(crate) fn by_triangle<S: Scalar>(
    mut shares: Vec<Share<S>>,
    largest: impl Fn(S, S) -> S,
) -> BTreeMap<usize, S> {
    shares.sort_by(|a, b| a.place.cmp(&b.place).then(a.part[0].total_cmp(&b.part[0])));
    let mut sums = BTreeMap::new();
    for group in shares.chunk_by(|a, b| a.place == b.place) {
        let apart = group.windows(2).all(|pair| pair[0].part[1] <= pair[1].part[0]);
        let values = group.iter().map(|share| share.value);
        let value = values.reduce(|a, b| if apart { largest(a, b) } else { a + b });
        if let Some(value) = value {
            *sums.entry(group[0].place.0).or_insert(S::from(0)) += value;
        }
    }
    sums
}

/// All pieces of Gamma_C.
///
/// # Errors
/// As `ContactLine::new`.
pub fn assemble(
    problem: &Problem,
    space: &Space,
    gamma: impl Into<Gamma>,
) -> Result<Vec<Piece>, DataError> {
    Ok(ContactLine::new(problem, space)?.with_gamma(problem, space, gamma.into()))
}

/// Removes friction whose bound is zero all along a boundary: the method there is that of contact alone, to the bit.
///
/// # Errors
/// Friction on a boundary without contact.
fn without_idle_friction(problem: &Problem, pieces: &mut [PieceGeometry]) -> Result<(), DataError> {
    for name in problem.friction.keys() {
        let has_contact = problem.conditions.get(name).is_some_and(Condition::is_contact);
        let what = || format!("[boundary.{}]", key(name));
        let on_it = pieces.iter_mut().filter(|piece| *piece.first().boundary == **name).collect();
        check_friction(problem, has_contact, what, on_it)?;
    }
    Ok(())
}

/// Checks that the friction of these pieces, on what is called `what`, can be computed, and removes friction whose bound is
/// zero.
///
/// # Errors
/// Friction without contact, and in a body of revolution.
fn check_friction(
    problem: &Problem,
    has_contact: bool,
    what: impl Fn() -> String,
    pieces: Vec<&mut PieceGeometry>,
) -> Result<(), DataError> {
    if !has_contact {
        return Err(DataError::FrictionWithoutContact { what: what() });
    }
    if problem.material.are_of_revolution() {
        return Err(DataError::FrictionInRevolution { what: what() });
    }
    let bears = |piece: &PieceGeometry| match piece.law {
        Law::Friction(Bound::Tresca(ends)) => ends.iter().any(|&s| s > 0.0),
        Law::Friction(Bound::Coulomb(mu)) => mu > 0.0,
        _ => false,
    };
    if !pieces.iter().any(|piece| bears(piece)) {
        pieces.into_iter().for_each(|piece| piece.law = Law::Contact);
    }
    Ok(())
}

/// The law of contact with friction on a piece with these ends; `what` names its slip bound.
fn law_of(
    friction: &Friction,
    ends: [[f64; 2]; 2],
    what: impl Fn() -> String,
) -> Result<Law, DataError> {
    match friction {
        &Friction::Coulomb(mu) if mu >= 0.0 && mu.is_finite() => {
            Ok(Law::Friction(Bound::Coulomb(mu)))
        }
        Friction::Coulomb(mu) => {
            let expected = "a number that is not negative";
            let (what, found) = ("the coefficient of friction", mu.to_string());
            Err(DataError::Value { what, found, expected })
        }
        Friction::Tresca(bound) => {
            let at = |place: [f64; 2]| match finite(&**bound, place, &what)? {
                value if value < 0.0 => {
                    let [x, y] = place;
                    Err(DataError::NegativeFriction { what: what(), value, x, y })
                }
                value => Ok(value),
            };
            Ok(Law::Friction(Bound::Tresca([at(ends[0])?, at(ends[1])?])))
        }
    }
}

/// Puts the slip of the load step before onto the pieces, if there was one.
fn begin_at(slip: &[Vec<f64>], pieces: &mut [Arc<PieceGeometry>]) -> Result<(), DataError> {
    if slip.is_empty() {
        return Ok(());
    }
    let count = |nodes: usize| nodes == 0 || slip.iter().all(|of| [0, nodes].contains(&of.len()));
    let nodes = pieces.first().map_or(0, |piece| piece.nodes.len());
    if slip.len() != pieces.len() || !count(nodes) {
        return Err(DataError::Value {
            what: "the slip that is carried over",
            found: format!(
                "that of {} pieces of the contact line, and there are {}",
                slip.len(),
                pieces.len()
            ),
            expected: "as many from step to step: a clearance that leaves the same points of a pair within reach",
        });
    }
    for (piece, slip) in pieces.iter_mut().zip(slip).filter(|(_, slip)| !slip.is_empty()) {
        let mut moved = (**piece).clone();
        moved.nodes.iter_mut().zip(slip).for_each(|(node, &slip)| node.slip = slip);
        *piece = Arc::new(moved);
    }
    Ok(())
}

/// Checks that no edge that faces away from its obstacle lies inside the obstacle, and that no boundary faces away as a whole:
/// else the obstacle is on the other side of the body. Other edges may face away, as those of the upper half of a disk on a
/// floor.
fn check_sides(problem: &Problem, line: &[Arc<PieceGeometry>]) -> Result<(), DataError> {
    let is_away = |piece: &&Arc<PieceGeometry>| {
        let (_, normal) = problem.mesh.length_and_normal(piece.first().edge);
        piece.directions().all(|direction| direction.dot(&normal) <= 0.0)
    };
    let is_inside = |piece: &&Arc<PieceGeometry>| piece.gaps().all(|gap| gap <= 0.0);
    let faces = |piece: &&Arc<PieceGeometry>| !is_away(piece);
    let facing: BTreeSet<&str> =
        line.iter().filter(faces).map(|piece| &*piece.first().boundary).collect();
    let is_wrong = |piece: &&Arc<PieceGeometry>| {
        is_away(piece) && (is_inside(piece) || !facing.contains(&*piece.first().boundary))
    };
    match line.iter().find(is_wrong) {
        None => Ok(()),
        Some(piece) => {
            let PieceNode { place: [x, y], direction, .. } = piece.nodes[0];
            let boundary = &piece.first().boundary;
            Err(DataError::WrongSide {
                obstacle: problem.obstacle_of(boundary).unwrap_or_default().to_owned(),
                boundary: boundary.to_string(),
                x,
                y,
                direction: direction.into(),
            })
        }
    }
}

/// The obstacles as seen from the contact line.
struct Obstacles<'a> {
    problem: &'a Problem,
    smooth: SmoothBoundary,
}

impl Obstacles<'_> {
    /// The piece that a whole edge is.
    fn piece(
        &self,
        space: &Space,
        edge: BoundaryEdge,
        boundary: Arc<str>,
    ) -> Result<PieceGeometry, DataError> {
        let mesh = &self.problem.mesh;
        let (_, normal) = mesh.length_and_normal(edge);
        let curve = self.smooth.along(mesh, edge);
        let mut nodes = Vec::with_capacity(space.degree().nodes_per_edge());
        for (a, node) in space.edge_nodes(edge).enumerate() {
            let on_facet = SmoothPoint { place: space.nodes()[node], normal };
            let point = curve.map_or(on_facet, |points| points[a]);
            let Closest { gap, direction } = self.closest(&boundary, point)?;
            nodes.push(PieceNode { place: point.place, direction, gap, slip: 0.0 });
        }
        let along_normal = nodes.iter().all(|node| node.direction == normal);
        let bulge = match self.problem.conditions.get(&*boundary) {
            Some(Condition::Contact { gap }) if nodes[0].direction == nodes[1].direction => {
                bulge_of(gap, mesh.places_of_ends(edge))
            }
            // The distance to a plane.
            _ => 0.0,
        };
        let positions = space.degree().edge_positions().collect();
        let law = match self.problem.friction.get(&*boundary) {
            None => Law::Contact,
            Some(friction) => law_of(friction, [nodes[0].place, nodes[1].place], || {
                format!("[boundary.{}] contact.friction.tresca", key(&boundary))
            })?,
        };
        Ok(PieceGeometry {
            stretches: vec![Stretch { edge, boundary, positions }],
            nodes,
            law,
            curved: self.smooth.at_ends(edge).is_some(),
            along_normal,
            bulge,
        })
    }

    /// A piece between two bodies.
    fn piece_between(
        &self,
        names: &[Arc<str>; 2],
        pair: &Pair,
        piece: PairPiece,
    ) -> Result<PieceGeometry, DataError> {
        let PairPiece { sides, directions, gap, .. } = piece;
        let mesh = &self.problem.mesh;
        let curved = self.smooth.at_ends(sides[0].edge).is_some();
        let stretch = |(side, name): (PairSide, &Arc<str>)| Stretch {
            edge: side.edge,
            boundary: Arc::clone(name),
            positions: side.places,
        };
        let stretches: Vec<Stretch> = sides.into_iter().zip(names).map(stretch).collect();
        let place = |a: usize| stretches[0].place(mesh, a);
        let node = |(a, (direction, gap))| PieceNode { place: place(a), direction, gap, slip: 0.0 };
        let nodes = directions.into_iter().zip(gap).enumerate().map(node).collect();
        let law = match &pair.friction {
            Some(friction) if pair.law == Law::Contact => {
                let middle = |a: usize| {
                    let [p, q] = [0, 1].map(|i| stretches[i].place(mesh, a));
                    [0, 1].map(|c| (p[c] + q[c]) / 2.0)
                };
                law_of(friction, [middle(0), middle(1)], || {
                    format!("the slip bound of {}", pairs::named(&pair.boundaries))
                })?
            }
            _ => pair.law,
        };
        Ok(PieceGeometry { nodes, law, curved, along_normal: false, bulge: 0.0, stretches })
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
}

/// The value of `f` in the middle of an edge less the mean of its ends; 0 where `f` is known to be affine.
pub(crate) fn bulge_of(f: &SharedFunction, ends: [[f64; 2]; 2]) -> f64 {
    let [a, b] = ends;
    let middle = [0, 1].map(|c| (a[c] + b[c]) / 2.0);
    let is_affine = f.degree().is_some_and(|degree| degree <= 1);
    if is_affine { 0.0 } else { f.at(middle) - (f.at(a) + f.at(b)) / 2.0 }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn coefficients_and_slip_bounds_are_finite_and_not_negative() {
        let ends = [[0.0, 0.0], [1.0, 0.0]];
        let law = |friction: Friction| law_of(&friction, ends, || "it".to_owned());
        for mu in [0.0, 0.3, 1e300] {
            let bound = Law::Friction(Bound::Coulomb(mu));
            assert!(law(Friction::Coulomb(mu)).is_ok_and(|law| law == bound), "{mu}");
        }
        for mu in [-0.1, f64::INFINITY, f64::NAN, -f64::INFINITY] {
            let refused = law(Friction::Coulomb(mu));
            assert!(matches!(refused, Err(DataError::Value { .. })), "{mu}: {refused:?}");
        }
        let tresca = |at: [f64; 2]| {
            law(Friction::Tresca(Arc::new(move |[x, _]: [f64; 2]| at[0] + (at[1] - at[0]) * x)))
        };
        let bound = Law::Friction(Bound::Tresca([0.5, 0.25]));
        assert!(tresca([0.5, 0.25]).is_ok_and(|law| law == bound));
        let refused = tresca([0.5, -0.25]);
        let place = matches!(
            refused,
            Err(DataError::NegativeFriction { value: -0.25, x: 1.0, y: 0.0, .. })
        );
        assert!(place, "{refused:?}");
        assert!(matches!(tresca([f64::INFINITY, 0.0]), Err(DataError::NotFinite { .. })));
    }

    #[test]
    fn shares_of_one_edge_add_up_where_they_overlap_and_the_largest_counts_where_they_do_not() {
        let kappa = |shares: &[(usize, [f64; 2], f64)]| {
            let share = |&(edge, part, value): &(usize, [f64; 2], f64)| Share {
                place: (7, edge, Some("other".into())),
                part,
                value,
            };
            by_triangle(shares.iter().map(share).collect(), f64::max)[&7]
        };
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
            let of = |shares: [(usize, [f64; 2], f64); 3]| kappa(&order.map(|k| shares[k]));
            let [first, last] = [(1, [0.0, 0.25], 1.0), (1, [0.75, 1.0], 2.0)];
            assert_eq!(of([first, (1, [0.25, 0.75], 4.0), last]), 4.0);
            // With the last one, and with the first one.
            assert_eq!(of([first, (1, [0.5, 0.8], 4.0), last]), 7.0);
            assert_eq!(of([first, (1, [0.0, 0.5], 4.0), last]), 7.0);
            // On another edge of the triangle.
            assert_eq!(of([first, (2, [0.25, 0.75], 4.0), last]), 2.0 + 4.0);
        }
    }
}
