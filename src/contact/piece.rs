//! A piece of Gamma_C as method (8) sees it: the functionals P0 and sigma_n of the nodal values on the triangles that it belongs to,
//! the gap, the length and gamma, in any numbers; and what it adds to (8) by its law.
//!
//! A piece is the interval \[0, 1\]. It has one side, the whole edge of a triangle that faces a rigid obstacle, or two, parts of edges
//! of two bodies. The jump is the displacement of the first side less that of the second; on a piece with one component it is the
//! jump along the direction of contact, with two also that across, to the left. Values at the nodes of a piece have the order
//! start, end, and for P2 the middle, component after component.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{DMatrix, Matrix2, Vector2};

use super::hoop::HoopStress;
use super::law::{EdgeRule, Integrals, is_open};
use super::stress_points::Nodal;
use crate::kernel::contact_edge::integral_of_product;
use crate::kernel::edge_integral::{self, edge_mass, weighted_product};
use crate::kernel::friction::clip;
use crate::kernel::positive_part;
use crate::kernel::{ContactEdge, DoubleDouble, Element, Material, Response, Scalar, Triangle};
use crate::model::element::{Degree, with_element};
use crate::model::law::Law;
use crate::model::mesh::{BoundaryEdge, Mesh};
use crate::model::space::Space;

/// A node of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceNode {
    /// The place on the smooth boundary of the first side, from which the gap is measured.
    pub(crate) place: [f64; 2],
    /// n~, the direction of contact.
    pub direction: Vector2<f64>,
    /// g: on the piece the gap is the Lagrange interpolant of these.
    pub gap: f64,
    /// g_t: the jump across n~ at which friction begins, likewise; 0 but after another load step.
    pub(crate) slip: f64,
}

/// The part of an edge on which a side of a piece lies.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// The edge.
    pub edge: BoundaryEdge,
    /// The name of its boundary.
    pub(crate) boundary: Arc<str>,
    /// Where the nodes of the piece lie on it, from 0 to 1.
    pub positions: Vec<f64>,
}

/// A piece before gamma is known.
#[derive(Clone, Debug, PartialEq)]
pub struct PieceGeometry {
    /// One or two.
    pub stretches: Vec<Stretch>,
    /// The nodes: two, and for P2 three.
    pub nodes: Vec<PieceNode>,
    /// The law.
    pub law: Law,
    /// The smooth boundary is curved along the piece, which is a chord.
    pub curved: bool,
    /// n~ is the normal of the edge at all nodes.
    pub(crate) along_normal: bool,
    /// g in the middle less the mean of its values at the ends, where n~ does not turn; 0 where g is known to be affine.
    pub(crate) bulge: f64,
}

impl Stretch {
    /// The place of node `a` of the piece on the edge.
    pub fn place(&self, mesh: &Mesh, a: usize) -> [f64; 2] {
        let ([start, end], s) = (mesh.places_of_ends(self.edge), self.positions[a]);
        [0, 1].map(|c| (1.0 - s) * start[c] + s * end[c])
    }
}

impl PieceGeometry {
    /// Returns whether the direction of contact turns along the piece.
    pub(crate) fn turns(&self) -> bool {
        self.nodes[0].direction != self.nodes[1].direction
    }

    /// The part of an edge of the first side, by which results name the piece.
    pub(crate) fn first(&self) -> &Stretch {
        &self.stretches[0]
    }

    /// The lengths of the parts of edges on which the two sides lie, for the `lengths` of the edges; `None` where there is one side.
    pub(crate) fn chords<S: Scalar + From<f64>>(&self, lengths: &[S]) -> Option<Chords<S>> {
        let exact = <S as From<f64>>::from;
        let part = |(stretch, &length): (&Stretch, &S)| {
            let [from, to] = [stretch.positions[0], stretch.positions[1]];
            (if to < from { exact(from) - exact(to) } else { exact(to) - exact(from) }) * length
        };
        let parts: Vec<S> = self.stretches.iter().zip(lengths).map(part).collect();
        let [first, second] = parts[..] else { return None };
        let length = (first + second) / <S as From<i32>>::from(2);
        Some(Chords { length, ratios: [first / length, second / length] })
    }

    /// The radii of side `i`, given those at the corners of the triangle that has an edge; `None` in the plane.
    pub(crate) fn radii<S: Scalar + From<f64>>(
        &self,
        i: usize,
        corners: impl Fn(BoundaryEdge) -> Option<[S; 3]>,
    ) -> Option<PieceRadii<S>> {
        let at_ends = |stretch: &Stretch| {
            let [start, end, _] = stretch.edge.ends_first(corners(stretch.edge)?);
            let at = |a: usize| {
                let place = <S as From<f64>>::from(stretch.positions[a]);
                edge_integral::radius([start, end], place)
            };
            // On the whole edge a product with 1 is left out, since it is not exact in balls.
            Some(if self.stretches.len() == 1 { [start, end] } else { [at(0), at(1)] })
        };
        let each: Option<Vec<[S; 2]>> = self.stretches.iter().map(at_ends).collect();
        let (each, edge) = (each?, self.stretches[i].edge);
        let half = |a: usize| (each[0][a] + each[1][a]) / <S as From<i32>>::from(2);
        Some(PieceRadii {
            of_piece: if each.len() == 1 { each[0] } else { [half(0), half(1)] },
            of_side: each[i],
            of_triangle: edge.ends_first(corners(edge)?),
        })
    }

    /// g at the nodes.
    pub(crate) fn gaps(&self) -> impl Iterator<Item = f64> + '_ {
        self.nodes.iter().map(|node| node.gap)
    }

    /// n~ at the nodes.
    pub(crate) fn directions(&self) -> impl Iterator<Item = Vector2<f64>> + '_ {
        self.nodes.iter().map(|node| node.direction)
    }
}

/// The lengths of the two sides of a piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chords<S> {
    /// Their mean, the length of the piece.
    pub(crate) length: S,
    /// Each over their mean.
    pub(crate) ratios: [S; 2],
}

/// r along a side of a piece of a body of revolution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PieceRadii<S> {
    /// At the two ends of the piece, the means over its sides: the weight of its integrals.
    pub(crate) of_piece: [S; 2],
    /// There on the side itself.
    pub(crate) of_side: [S; 2],
    /// At the start and the end of the side's edge, and at the corner opposite.
    pub(crate) of_triangle: [S; 3],
}

impl<S: Scalar> Chords<S> {
    /// The length of side `i` over that of the piece; in a body of revolution the area over that.
    pub(crate) fn ratio(&self, i: usize, radii: Option<PieceRadii<S>>) -> S {
        let ratio = self.ratios[i];
        radii.map_or(ratio, |PieceRadii { of_piece: [a, b], of_side: [c, d], .. }| {
            ratio * (c + d) / (a + b)
        })
    }

    /// The factor of the constant of side `i` in kappa: the square of its ratio times the length of the piece over its own, in a
    /// body of revolution times the largest quotient of the weight of the piece and its own r, which are affine.
    pub(crate) fn share(
        &self,
        i: usize,
        radii: Option<PieceRadii<S>>,
        largest: impl Fn(S, S) -> S,
    ) -> S {
        let Some(PieceRadii { of_piece, of_side, .. }) = radii else { return self.ratios[i] };
        let ratio = self.ratio(i, radii);
        // At an end on the axis both are 0, and the quotient is that of the other end.
        let on_axis = |a: usize| of_side[a] == S::from(0) && of_piece[a] == S::from(0);
        let quotient = |a: usize| of_piece[a] / of_side[a];
        let most = match [on_axis(0), on_axis(1)] {
            [true, _] => quotient(1),
            [_, true] => quotient(0),
            _ => largest(quotient(0), quotient(1)),
        };
        ratio * ratio / self.ratios[i] * most
    }
}

/// The data of a side of a piece, in any numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SideData<S> {
    /// The triangle.
    pub(crate) triangle: Triangle<S>,
    /// Its material.
    pub(crate) material: Material<S>,
    /// The length of its whole edge.
    pub(crate) length: S,
    /// n, the unit outward normal there.
    pub(crate) normal: Vector2<S>,
    /// gamma of the triangle: gamma0 h_T of (7).
    pub(crate) gamma: S,
    /// r at the corners of the triangle, in a body of revolution.
    pub(crate) radii: Option<[S; 3]>,
}

/// A side of a piece.
#[derive(Clone, Debug)]
pub struct Side<S = f64> {
    /// n
    pub normal: Vector2<S>,
    /// The length of the whole edge.
    pub length: S,
    /// gamma of its triangle.
    pub gamma: S,
    /// Its entries among the nodes of the piece's triangles.
    pub entries: Range<usize>,
    /// For each node of the piece the entry of the edge's node that is next to it.
    pub(crate) nearest: Vec<usize>,
    /// The functionals P0 and those of the stress of the displacement e_r, in a body of revolution, where it is no rigid motion.
    pub(crate) rings: Option<[Vec<S>; 2]>,
}

/// A piece of Gamma_C.
#[derive(Clone, Debug)]
pub struct Piece<S = f64> {
    /// Where it lies, and its gap.
    pub geometry: Arc<PieceGeometry>,
    /// The degree of P along it.
    pub degree: Degree,
    /// The number of its first functional among those of all pieces.
    pub start: usize,
    /// One or two.
    pub sides: Vec<Side<S>>,
    /// Its length: |E|, or the mean of its sides' parts.
    pub length: S,
    /// gamma, the sum over its sides.
    pub gamma: S,
    /// r at its start and its end, in a body of revolution: the weight of its integrals, elsewhere 1.
    pub radii: Option<[S; 2]>,
    /// The nodes of its triangles, the first side's and then the second's.
    pub nodes: Vec<usize>,
    /// P0 of each component at each node of the piece: a vector for each of `nodes`.
    pub p0: Vec<Vec<Vector2<S>>>,
    /// The stress of each component, sigma_n of the first, at the start and at the end.
    pub sigma_n: Vec<Vec<Vector2<S>>>,
}

/// The contribution of a piece to (8) and to J_h, the weight |E| / gamma included.
#[derive(Clone, Debug, PartialEq)]
pub struct Contribution {
    /// Its share of J_h.
    pub(crate) energy: f64,
    /// The derivatives of the energy with respect to the nodal values of P: the force of the piece is minus the sum of these, each
    /// times its functional P0.
    pub force: Vec<f64>,
    /// The second derivatives that Newton's method uses.
    pub(crate) tangent: DMatrix<f64>,
    /// int -lambda^h of the first component.
    pub resultant: f64,
    /// The measure of {P > 0}.
    pub(crate) active: f64,
    /// The measures of where friction sticks and of where it slides.
    pub friction: [f64; 2],
}

/// The functionals P0 and sigma_n of a side.
type Rows<S> = [Vec<Vec<Vector2<S>>>; 2];

/// The functionals of one component on a side: along `directions` where these are not the normal, on the part of the edge with
/// these `positions` where that is not the whole edge.
fn rows<E: Element<N, M>, const N: usize, const M: usize, S: Scalar>(
    side: &SideData<S>,
    (local, positions): (usize, Option<&[S]>),
    directions: Option<&[Vector2<S>]>,
    gamma: S,
) -> Rows<S> {
    let SideData { triangle, material, normal, .. } = side;
    let edge: ContactEdge<S, N, M> = match (directions, positions) {
        (None, _) => ContactEdge::new::<E>(triangle, local, *normal, material, gamma),
        (Some(along), None) => {
            let along = std::array::from_fn(|a| along[a]);
            ContactEdge::along::<E>(triangle, local, *normal, &along, material, gamma)
        }
        (Some(along), Some(at)) => {
            let along = std::array::from_fn(|a| along[a]);
            let at = std::array::from_fn(|a| at[a]);
            ContactEdge::between::<E>(triangle, local, at, *normal, &along, material, gamma)
        }
    };
    [edge.p0.map(|row| row.to_vec()).to_vec(), edge.sigma_n.map(|row| row.to_vec()).to_vec()]
}

/// The hoop strain in the stress of a side, at the start and at the end of the piece.
struct HoopRows<S> {
    /// For each end what each node's radial displacement adds.
    at_ends: [Vec<S>; 2],
    /// The sums of these.
    ring: [S; 2],
}

fn hoop<E: Element<N, M>, const N: usize, const M: usize, S: Scalar>(
    side: &SideData<S>,
    (local, positions): (usize, &[S]),
    directions: [Vector2<S>; 2],
) -> HoopRows<S> {
    let ends = [positions[0], positions[1]];
    let radii = side.radii.unwrap_or([S::from(1); 3]);
    let of: HoopStress<S, N> =
        HoopStress::new::<E, M>(radii, (local, ends), side.normal, directions, &side.material);
    HoopRows { at_ends: of.at_ends.map(|row| row.to_vec()), ring: of.ring }
}

impl<S: Scalar> HoopRows<S> {
    /// Adds it to the functionals P0 at the places `at` of the piece, with gamma, and to those of the stress; gives the functionals of
    /// e_r, those of the stress times the share of the side in it, if there are two.
    fn add_to(
        self,
        [p0, stress]: [&mut Vec<Vec<Vector2<S>>>; 2],
        at: &[S],
        (gamma, share): (S, Option<S>),
    ) -> [Vec<S>; 2] {
        let between =
            |[start, end]: [S; 2], s: S| -(edge_integral::radius([start, end], s) * gamma);
        for (row, &s) in p0.iter_mut().zip(at) {
            for (j, entry) in row.iter_mut().enumerate() {
                entry[0] += between([self.at_ends[0][j], self.at_ends[1][j]], s);
            }
        }
        for (row, hoop) in stress.iter_mut().zip(&self.at_ends) {
            row.iter_mut().zip(hoop).for_each(|(entry, &hoop)| entry[0] += hoop);
        }
        let of_p0 = at.iter().map(|&s| between(self.ring, s)).collect();
        [of_p0, self.ring.map(|ring| share.map_or(ring, |share| ring * share)).to_vec()]
    }
}

/// A vector turned left by a right angle.
fn across<S: Scalar>(d: Vector2<S>) -> Vector2<S> {
    Vector2::new(-d[1], d[0])
}

impl<S: Scalar + From<f64>> Piece<S> {
    /// The piece with this geometry and these sides, whose functionals follow `start` others.
    pub(crate) fn new(
        geometry: &Arc<PieceGeometry>,
        space: &Space,
        start: usize,
        data: &[SideData<S>],
    ) -> Self {
        let degree = space.degree();
        let exact = <S as From<f64>>::from;
        let lengths: Vec<S> = data.iter().map(|side| side.length).collect();
        let chords = geometry.chords(&lengths);
        let (mut length, mut gamma) = (data[0].length, data[0].gamma);
        if let Some(chords) = chords {
            length = chords.length;
            gamma += data[1].gamma;
        }
        let corners = |edge: BoundaryEdge| {
            data[geometry.stretches.iter().position(|s| s.edge == edge)?].radii
        };
        let radii = (0..data.len()).map(|i| geometry.radii(i, corners));
        let radii: Option<Vec<PieceRadii<S>>> = radii.collect();
        let radii_of = |i: usize| radii.as_ref().map(|radii| radii[i]);
        let mut piece = Piece {
            geometry: Arc::clone(geometry),
            degree,
            start,
            sides: Vec::with_capacity(data.len()),
            length,
            gamma,
            radii: radii_of(0).map(|radii| radii.of_piece),
            nodes: Vec::new(),
            p0: vec![Vec::new(); geometry.law.components() * degree.nodes_per_edge()],
            sigma_n: vec![Vec::new(); 2 * geometry.law.components()],
        };
        for (i, (stretch, data)) in geometry.stretches.iter().zip(data).enumerate() {
            // The stress of the only side is that of the piece; a product with 1 would not be exact in balls.
            let shares = chords.map(|chords| (data.gamma / gamma, chords.ratio(i, radii_of(i))));
            let own_gamma = shares.map_or(data.gamma, |(_, ratio)| data.gamma * ratio);
            let first = piece.nodes.len();
            piece.nodes.extend(space.nodes_of(stretch.edge.triangle));
            let positions: Vec<S> = stretch.positions.iter().map(|&s| exact(s)).collect();
            let place = (stretch.edge.local, shares.is_some().then_some(&positions[..]));
            let mut rings = data.radii.map(|_| [Vec::new(), Vec::new()]);
            for k in 0..geometry.law.components() {
                let toward = |node: &PieceNode| {
                    let d = node.direction.map(exact);
                    let d = if k == 0 { d } else { across(d) };
                    if i == 0 { d } else { -d }
                };
                let along: Option<Vec<Vector2<S>>> = (k > 0 || !geometry.along_normal)
                    .then(|| geometry.nodes.iter().map(toward).collect());
                let along = along.as_deref();
                let [mut p0, mut sigma_n] = with_element!(degree, E => {
                    rows::<E, _, _, _>(data, place, along, own_gamma)
                });
                if let Some(rings) = &mut rings {
                    let ends = [0, 1].map(|a| along.map_or(data.normal, |along| along[a]));
                    let of = with_element!(degree, E => {
                        hoop::<E, _, _, _>(data, (stretch.edge.local, &positions), ends)
                    });
                    let at: Vec<S> = degree.edge_positions().map(exact).collect();
                    let share = shares.map(|(weight, ratio)| weight * ratio);
                    let [own_p0, own_stress] =
                        of.add_to([&mut p0, &mut sigma_n], &at, (own_gamma, share));
                    rings[0].extend(own_p0);
                    rings[1].extend(own_stress);
                }
                piece.append(k, [p0, sigma_n], shares.map(|(weight, ratio)| weight * ratio));
            }
            piece.sides.push(Side {
                normal: data.normal,
                length: data.length,
                gamma: data.gamma,
                entries: first..piece.nodes.len(),
                nearest: nearest(degree, stretch).into_iter().map(|k| first + k).collect(),
                rings,
            });
        }
        piece
    }

    /// Appends the entries that a side has in the rows of component `k`; its stress has a share in that of the piece.
    fn append(&mut self, k: usize, [p0, mut sigma_n]: Rows<S>, share: Option<S>) {
        if let Some(share) = share {
            sigma_n.iter_mut().flatten().for_each(|f| *f *= share);
        }
        let count = self.degree.nodes_per_edge();
        let p0 = self.p0[k * count..].iter_mut().zip(p0);
        for (all, own) in p0.chain(self.sigma_n[2 * k..].iter_mut().zip(sigma_n)) {
            if all.is_empty() {
                *all = own;
            } else {
                all.extend(own);
            }
        }
    }

    /// The name of the boundary of the second side, if there is one.
    pub(crate) fn partner(&self) -> Option<&Arc<str>> {
        self.geometry.stretches.get(1).map(|stretch| &stretch.boundary)
    }

    /// Returns whether both lie on the same boundary with the same partner.
    pub(crate) fn is_of_same_boundary<T>(&self, other: &Piece<T>) -> bool {
        let [own, others] = [&self.geometry.stretches, &other.geometry.stretches];
        own.iter().map(|s| &s.boundary).eq(others.iter().map(|s| &s.boundary))
    }

    /// The responses of the law, component by component, each with the numbers of the component's values among those of the piece.
    pub(crate) fn responses(&self) -> impl Iterator<Item = (Response, Range<usize>)> + use<S> {
        let (count, law) = (self.degree.nodes_per_edge(), self.geometry.law);
        law.responses().iter().enumerate().map(move |(k, &r)| (r, k * count..(k + 1) * count))
    }

    /// The nodes of the edges on which it lies.
    pub(crate) fn edge_nodes(&self) -> impl Iterator<Item = usize> + '_ {
        let of = |(side, stretch): (&Side<S>, &Stretch)| {
            let first = side.entries.start;
            let on_edge = self.degree.edge_nodes(stretch.edge.local);
            on_edge.map(|k| self.nodes[first + k]).collect::<Vec<_>>()
        };
        self.sides.iter().zip(&self.geometry.stretches).flat_map(of)
    }

    /// The largest of these numbers at the nodes of its edges, added up over its sides.
    pub(crate) fn farthest(&self, at: impl Fn(usize) -> f64) -> f64 {
        let count = self.degree.nodes_per_edge();
        let nodes: Vec<f64> = self.edge_nodes().map(at).collect();
        nodes.chunks(count).map(|side| side.iter().copied().fold(0.0, f64::max)).sum()
    }

    /// The numbers of its functionals among those of all pieces.
    pub fn functionals(&self) -> Range<usize> {
        self.start..self.start + self.p0.len()
    }

    /// The edge of the first side, by which results name the piece.
    pub fn edge(&self) -> BoundaryEdge {
        self.geometry.first().edge
    }

    /// The name of the boundary of the first side.
    pub fn boundary(&self) -> &Arc<str> {
        &self.geometry.first().boundary
    }

    /// n on the first side.
    pub fn normal(&self) -> Vector2<S> {
        self.sides[0].normal
    }

    /// n~ at node `a`.
    pub(crate) fn direction(&self, a: usize) -> Vector2<S> {
        if self.geometry.along_normal {
            self.normal()
        } else {
            self.geometry.nodes[a].direction.map(<S as From<f64>>::from)
        }
    }

    /// The direction of functional `i`, n~ or across it.
    pub(crate) fn direction_of(&self, i: usize) -> Vector2<S> {
        let count = self.degree.nodes_per_edge();
        let d = self.direction(i % count);
        if i < count { d } else { across(d) }
    }

    /// The values of P along the direction of contact, of those of all functionals.
    pub fn along<'v, T>(&self, p: &'v [T]) -> &'v [T] {
        &p[..self.degree.nodes_per_edge().min(p.len())]
    }

    /// The values of P across it; none where the law does not feel it.
    pub fn across<'v, T>(&self, p: &'v [T]) -> &'v [T] {
        &p[self.degree.nodes_per_edge().min(p.len())..]
    }

    /// |E| / gamma
    pub fn weight(&self) -> S {
        self.length / self.gamma
    }

    /// int 1 / gamma, in a body of revolution int r / gamma.
    pub(crate) fn whole_weight(&self) -> S {
        let weight = self.weight();
        self.radii.map_or(weight, |[start, end]| weight * (start + end) / <S as From<i32>>::from(2))
    }

    /// The value of a functional at the differences of nodal values from those at the node `from` of a side, of its entries: a body
    /// that moves far and strains little loses no digits.
    fn apply(
        &self,
        side: &Side<S>,
        functional: &[Vector2<S>],
        difference: impl Fn(usize) -> [S; 2],
    ) -> S {
        let zero = <S as From<i32>>::from(0);
        let entries = side.entries.clone();
        functional[entries.clone()].iter().zip(&self.nodes[entries]).fold(
            zero,
            |sum, (f, &node)| {
                let [x, y] = difference(node);
                sum + f[0] * x + f[1] * y
            },
        )
    }

    /// P0(u) at the nodes of the piece. P0 of a translation is its jump along n~.
    pub fn p0(&self, u: &[[S; 2]]) -> Vec<S> {
        self.each_p0(u).collect()
    }

    /// [`Piece::p0`], one after the other.
    pub(crate) fn each_p0<'u>(&'u self, u: &'u [[S; 2]]) -> impl Iterator<Item = S> + 'u {
        let count = self.degree.nodes_per_edge();
        let value = move |(i, row): (usize, &Vec<Vector2<S>>)| {
            let near = |side: &Side<S>| u[self.nodes[side.nearest[i % count]]];
            let mut jump = near(&self.sides[0]);
            for side in &self.sides[1..] {
                let other = near(side);
                jump = [0, 1].map(|c| jump[c] - other[c]);
            }
            let n = self.direction_of(i);
            self.sides.iter().fold(n[0] * jump[0] + n[1] * jump[1], |sum, side| {
                let from = near(side);
                let difference = |node: usize| [0, 1].map(|c| u[node][c] - from[c]);
                let sum = sum + self.apply(side, row, difference);
                side.rings.as_ref().map_or(sum, |[p0, _]| sum + p0[i] * from[0])
            })
        };
        self.p0.iter().enumerate().map(value)
    }

    /// g of functional `i`, or g_t across n~.
    pub(crate) fn gap_of(&self, i: usize) -> f64 {
        let nodes = &self.geometry.nodes;
        match i.checked_sub(nodes.len()) {
            None => nodes[i].gap,
            Some(a) => nodes.get(a).map_or(0.0, |node| node.slip),
        }
    }

    /// P(u) = P0(u) - g there.
    pub fn p(&self, u: &[[S; 2]]) -> Vec<S> {
        self.each_p(u).collect()
    }

    /// [`Piece::p`], one after the other.
    pub(crate) fn each_p<'u>(&'u self, u: &'u [[S; 2]]) -> impl Iterator<Item = S> + 'u {
        let less = |(i, p0): (usize, S)| p0 - <S as From<f64>>::from(self.gap_of(i));
        self.each_p0(u).enumerate().map(less)
    }

    /// The stress of each component at the start and at the end.
    pub(crate) fn stress(&self, u: &(impl Nodal<S> + ?Sized)) -> Vec<S> {
        let value = |(i, row): (usize, &Vec<Vector2<S>>)| {
            let of = |side: &Side<S>| {
                let from = self.nodes[side.entries.start];
                let sum = self.apply(side, row, |node| u.difference(node, from).into());
                side.rings.as_ref().map_or(sum, |[_, of]| sum + of[i] * u.radial(from))
            };
            let first = of(&self.sides[0]);
            self.sides[1..].iter().fold(first, |sum, side| sum + of(side))
        };
        self.sigma_n.iter().enumerate().map(value).collect()
    }

    /// sigma_n(u) at the start and at the end.
    pub fn sigma_n(&self, u: &[[S; 2]]) -> [S; 2] {
        let stress = self.stress(u);
        [stress[0], stress[1]]
    }

    /// The integral of the product of two affine functions over the piece, beside its length.
    fn product(&self, f: [S; 2], g: [S; 2]) -> S {
        match self.radii {
            None => integral_of_product(f, g),
            Some(radii) => weighted_product(radii, f, g),
        }
    }

    /// int gamma sigma_n(u)^2, summed over the components.
    pub fn squared_stress(&self, u: &[[S; 2]]) -> S {
        let stress = self.stress(u);
        let square = |ends: &[S]| self.product([ends[0], ends[1]], [ends[0], ends[1]]);
        let rest = stress[2..].chunks_exact(2).map(square);
        self.gamma * self.length * rest.fold(square(&stress[..2]), |sum, more| sum + more)
    }

    /// The factors of the functionals of the stress in -int gamma sigma_n(u) sigma_n(.), for sigma_n(u) = `stress`.
    pub(crate) fn stress_factors(&self, stress: &[S]) -> Vec<S> {
        let [two, six] = [2, 6].map(<S as From<i32>>::from);
        let mass = -(self.gamma * self.length) / six;
        let of = |ends: &[S]| {
            let (start, end) = (ends[0], ends[1]);
            let Some(radii) = self.radii else {
                return [mass * (two * start + end), mass * (start + two * end)];
            };
            edge_mass(radii).map(|[a, b]| six * mass * (a * start + b * end))
        };
        stress.chunks_exact(2).flat_map(of).collect()
    }

    /// Adds -int gamma sigma_n(u) sigma_n(v) for every basis function v.
    pub fn add_stresses(&self, u: &[[S; 2]], forces: &mut [[S; 2]]) {
        let stress = self.stress(u);
        self.each_force(&self.sigma_n, &self.stress_factors(&stress), |node, f| {
            forces[node] = [forces[node][0] + f[0], forces[node][1] + f[1]];
        });
    }

    /// Adds the values of P0 at the nodes, each times its factor, as forces on the bodies.
    pub fn add_contact(&self, factors: &[S], forces: &mut [[S; 2]]) {
        self.each_force(&self.p0, factors, |node, f| {
            forces[node] = [forces[node][0] + f[0], forces[node][1] + f[1]];
        });
    }

    /// Calls `add` with the forces that functionals are at the nodes of the triangles, each functional times its factor.
    pub(crate) fn each_force(
        &self,
        functionals: &[Vec<Vector2<S>>],
        factors: &[S],
        mut add: impl FnMut(usize, Vector2<S>),
    ) {
        for (functional, &factor) in functionals.iter().zip(factors) {
            for (&node, f) in self.nodes.iter().zip(functional) {
                add(node, *f * factor);
            }
        }
    }

    /// int gamma sigma_n(u) sigma_n(v) for v = N_i e_c, u = N_j e_d of the nodes i and j of its triangles in entry (c, d), with
    /// `weight` = gamma |E|.
    pub(crate) fn stress_product(&self, weight: S, i: usize, j: usize) -> Matrix2<S> {
        let of = |rows: &[Vec<Vector2<S>>]| {
            let (start, end) = (&rows[0], &rows[1]);
            Matrix2::from_fn(|c, d| {
                weight * self.product([start[i][c], end[i][c]], [start[j][d], end[j][d]])
            })
        };
        let first = of(&self.sigma_n[..2]);
        self.sigma_n[2..].chunks_exact(2).fold(first, |sum, rows| sum + of(rows))
    }
}

/// For each node of a piece, the nearest node of the triangle on the edge.
fn nearest(degree: Degree, stretch: &Stretch) -> Vec<usize> {
    let next_to = |&s: &f64| {
        let distance = |(_, place): &(usize, f64)| (place - s).abs();
        let nodes = degree.edge_nodes(stretch.edge.local).zip(degree.edge_positions());
        nodes.min_by(|a, b| distance(a).total_cmp(&distance(b))).map_or(0, |(node, _)| node)
    };
    stretch.positions.iter().map(next_to).collect()
}

impl Piece {
    /// The jump of a field along the direction of each functional: P0 without the stress.
    pub(crate) fn jumps(&self, u: &[[f64; 2]]) -> Vec<f64> {
        let count = self.degree.nodes_per_edge();
        let displacement = |(side, stretch): (&Side, &Stretch), a: usize| {
            let nodes = self.degree.edge_nodes(stretch.edge.local);
            let shapes = self.degree.edge_values(stretch.positions[a]);
            nodes.zip(shapes).fold([0.0; 2], |sum, (k, shape)| {
                let u = u[self.nodes[side.entries.start + k]];
                [0, 1].map(|c| sum[c] + shape * u[c])
            })
        };
        let jump = |i: usize| {
            let mut sides = self.sides.iter().zip(&self.geometry.stretches);
            let first = sides.next().map_or([0.0; 2], |side| displacement(side, i % count));
            let [x, y] = sides.fold(first, |jump, side| {
                let other = displacement(side, i % count);
                [0, 1].map(|c| jump[c] - other[c])
            });
            let n = self.direction_of(i);
            x * n[0] + y * n[1]
        };
        (0..self.p0.len()).map(jump).collect()
    }

    /// The piece with the jumps alone for its functionals: P0 without the stress.
    pub(crate) fn of_jumps(&self) -> Piece {
        let places: Vec<f64> = self.degree.edge_positions().collect();
        let row = |(i, p0): (usize, &Vec<Vector2<f64>>)| {
            let (s, ends) = (places[i % places.len()], 2 * (i / places.len()));
            let stress = self.sigma_n[ends].iter().zip(&self.sigma_n[ends + 1]);
            let stress = stress.map(|(a, b)| a * (1.0 - s) + b * s);
            p0.iter().zip(stress).map(|(p0, stress)| p0 + stress * self.gamma).collect()
        };
        Piece { p0: self.p0.iter().enumerate().map(row).collect(), ..self.clone() }
    }

    /// The places on the edges of its sides that functional `i` compares, each with the triangle and the direction that its
    /// displacement is multiplied by.
    pub(crate) fn compared(&self, mesh: &Mesh, i: usize) -> Vec<(usize, [f64; 2], Vector2<f64>)> {
        let (n, a) = (self.direction_of(i), i % self.degree.nodes_per_edge());
        let of = |(side, stretch): (usize, &Stretch)| {
            let along = if side == 0 { n } else { -n };
            (stretch.edge.triangle, stretch.place(mesh, a), along)
        };
        self.geometry.stretches.iter().enumerate().map(of).collect()
    }

    /// Returns what the piece adds to (8) and J_h where P has these values at its nodes.
    pub fn contribution<T: Copy + Into<DoubleDouble>>(
        &self,
        rule: &EdgeRule,
        p: &[T],
    ) -> Contribution {
        self.softened(rule, 1.0, p)
    }

    /// Returns whether the piece adds nothing where P has these values at its nodes, as far as these tell.
    pub(crate) fn is_open(&self, p: &[DoubleDouble]) -> bool {
        self.geometry.law == Law::Contact && is_open(p)
    }

    /// [`Piece::contribution`] on springs that are `stiffness` times as stiff. The law is the same: what friction bears at most does not
    /// depend on them.
    pub(crate) fn softened<T: Copy + Into<DoubleDouble>>(
        &self,
        rule: &EdgeRule,
        stiffness: f64,
        p: &[T],
    ) -> Contribution {
        let of = (self.degree, self.gamma / stiffness);
        let Integrals { energy, mut gradient, mut hessian, active, friction } =
            self.geometry.law.integrals(rule, of, self.radii, p);
        let weight = self.weight();
        // The shape functions add up to one.
        let whole = gradient[..self.degree.nodes_per_edge()].iter().sum::<f64>();
        // In place: this is done for every piece in every step.
        for entry in gradient.iter_mut().chain(&mut hessian) {
            *entry = stiffness * (weight * *entry);
        }
        Contribution {
            energy: stiffness * (weight * energy),
            resultant: stiffness * (weight * whole),
            force: gradient,
            tangent: hessian,
            active: self.length * active,
            friction: friction.map(|measure| self.length * measure),
        }
    }

    /// The Bregman distance of the energy of [`Piece::softened`] from P to Q, given by their values at the nodes.
    pub(crate) fn bregman<T: Copy + Into<DoubleDouble>>(
        &self,
        rule: &EdgeRule,
        stiffness: f64,
        p: &[T],
        q: &[T],
    ) -> f64 {
        let of = (self.degree, self.gamma / stiffness);
        stiffness * (self.weight() * self.geometry.law.bregman(rule, of, self.radii, p, q))
    }

    /// The shear stress of friction at node `a` where P has these values; 0 without friction.
    pub(crate) fn shear_at(&self, p: &[DoubleDouble], a: usize) -> f64 {
        let Law::Friction(bound) = self.geometry.law else { return 0.0 };
        let [normal, across] = [self.along(p), self.across(p)]
            .map(|p| p.iter().map(|p| p.head()).collect::<Vec<f64>>());
        let bound = bound.at_nodes(self.gamma, &normal)[a];
        -clip(across[a], positive_part(bound)) / self.gamma
    }

    /// The sums of the magnitudes of the products that P0(u) is added up from at the nodes.
    pub(crate) fn p0_magnitudes<'u>(&'u self, u: &'u [[f64; 2]]) -> impl Iterator<Item = f64> + 'u {
        let count = self.degree.nodes_per_edge();
        let value = move |(i, row): (usize, &Vec<Vector2<f64>>)| {
            let size = |f: Vector2<f64>, x: f64, y: f64| (f[0] * x).abs() + (f[1] * y).abs();
            let n = self.direction_of(i);
            let of = |side: &Side| {
                let [x, y] = u[self.nodes[side.nearest[i % count]]];
                let entries = side.entries.clone();
                let others = row[entries.clone()].iter().zip(&self.nodes[entries]);
                let differences = others.map(|(&f, &k)| size(f, u[k][0] - x, u[k][1] - y));
                let ring = side.rings.as_ref().map_or(0.0, |[p0, _]| (p0[i] * x).abs());
                size(n, x, y) + differences.sum::<f64>() + ring
            };
            self.sides.iter().map(of).sum()
        };
        self.p0.iter().enumerate().map(value)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::contact::{Pair, contact_line};
    use crate::model::Problem;

    /// Two bodies of one cell each, with this r at the left and right sides of each; the right side of the first faces the left one
    /// of the second, and their far sides are the outer ones.
    pub(crate) fn beside(sides: [[f64; 2]; 2], material: Material<f64>, reach: f64) -> Problem {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for [left, right] in sides {
            let k = vertices.len();
            vertices.extend([[left, 0.0], [right, 0.0], [right, 1.0], [left, 1.0]]);
            triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
        }
        let pair = Pair::new("right", "left").with_reach(reach).with_clearance(|_| 0.0);
        let named =
            [("right", vec![[1, 2]]), ("left", vec![[7, 4]]), ("outer", vec![[3, 0], [5, 6]])];
        let named = named.map(|(name, edges)| (name.to_owned(), edges));
        let mesh = Mesh::with_pairs(vertices, triangles, named, std::slice::from_ref(&pair));
        Problem::of(mesh.unwrap(), material).with_pair(pair)
    }

    #[test]
    fn the_jump_of_two_bodies_moves_as_far_as_both_together() {
        let material = Material::lame(1.0, 1.0, crate::kernel::Plane::Strain);
        let problem = beside([[0.0, 1.0], [1.0, 2.0]], material, 0.1);
        let space = Space::new(&problem.mesh, Degree::One);
        let pieces = contact_line::assemble(&problem, &space, 1.0).unwrap();
        let [piece] = &pieces[..] else { panic!("one piece") };
        // The vertices 1 and 2 on one side, 4 and 7 on the other.
        assert_eq!(piece.farthest(|node| node as f64), 2.0 + 7.0);
    }

    #[test]
    fn what_p0_is_added_up_from_has_its_size_whatever_its_signs() {
        let material = Material::lame(1.0, 1.0, crate::kernel::Plane::Strain);
        let problem = beside([[0.0, 1.0], [1.0, 2.0]], material, 0.1);
        let space = Space::new(&problem.mesh, Degree::One);
        let pieces = contact_line::assemble(&problem, &space, 1.0).unwrap();
        let [piece] = &pieces[..] else { panic!("one piece") };
        let by = |sign: f64| -> Vec<[f64; 2]> {
            (0..8)
                .map(|k| [(1.7 * f64::from(k)).sin(), sign * (2.3 * f64::from(k)).cos()])
                .collect()
        };
        let [magnitudes, turned] =
            [1.0, -1.0].map(|sign| piece.p0_magnitudes(&by(sign)).collect::<Vec<f64>>());
        assert_eq!(magnitudes, turned);
        let [p, other] = [1.0, -1.0].map(|sign| piece.p0(&by(sign)));
        for ((p, other), size) in p.iter().zip(&other).zip(magnitudes) {
            assert!(p.abs() <= size && other.abs() <= size);
            assert!((p - other).abs() > 0.1, "control");
        }
    }

    #[test]
    fn the_slip_bound_of_a_pair_is_that_halfway_between_the_bodies() {
        let material = Material::lame(1.0, 1.0, crate::kernel::Plane::Strain);
        let mut problem = beside([[1.0, 2.0], [3.0, 4.0]], material, 1.5);
        problem.pairs[0].friction = Some(crate::contact::Friction::tresca(|[x, _]| x));
        let space = Space::new(&problem.mesh, Degree::One);
        let pieces = contact_line::assemble(&problem, &space, 1.0).unwrap();
        let [piece] = &pieces[..] else { panic!("one piece") };
        let halfway = crate::contact::Bound::Tresca([2.5, 2.5]);
        assert_eq!(piece.geometry.law, Law::Friction(halfway));
    }

    /// Rings with the radii 2 and 3 where they face each other: between them, at 5/2, a force per radian is spread over another length.
    #[test]
    fn the_stress_of_each_ring_counts_as_the_radii_are() {
        let material = Material::lame(1.0, 1.0, crate::kernel::Plane::Axisymmetric);
        let problem = beside([[1.0, 2.0], [3.0, 4.0]], material, 1.5);
        let (mesh, space) = (&problem.mesh, Space::new(&problem.mesh, Degree::One));
        let pieces = contact_line::assemble(&problem, &space, 1.0).unwrap();
        let [piece] = &pieces[..] else { panic!("one piece") };
        let chords = piece.geometry.chords(&[1.0, 1.0]).unwrap();
        let corners = |edge: BoundaryEdge| material.radii(&mesh.triangle(edge.triangle));
        for (i, radius) in [2.0, 3.0].into_iter().enumerate() {
            let radii = piece.geometry.radii(i, corners);
            let ratio = radius / 2.5;
            assert_relative_eq!(chords.ratio(i, radii), ratio, max_relative = 1e-15);
            // int_E (ratio sigma)^2 r over the piece, per int sigma^2 r over the side, for a constant sigma.
            let share = ratio * ratio * 2.5 / radius;
            assert_relative_eq!(chords.share(i, radii, f64::max), share, max_relative = 1e-15);
        }
    }
}
