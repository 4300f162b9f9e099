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

use super::element::{Degree, with_element};
use super::law::{EdgeRule, Integrals, Law};
use super::mesh::BoundaryEdge;
use super::space::Space;
use crate::kernel::contact_edge::integral_of_product;
use crate::kernel::friction::clip;
use crate::kernel::positive_part;
use crate::kernel::{ContactEdge, DoubleDouble, Element, Material, Scalar, Triangle};

/// A node of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceNode {
    /// The place on the smooth boundary of the first side, from which the gap is measured.
    pub place: [f64; 2],
    /// n~, the direction of contact.
    pub direction: Vector2<f64>,
    /// g: on the piece the gap is the Lagrange interpolant of these.
    pub gap: f64,
}

/// The part of an edge on which a side of a piece lies.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// The edge.
    pub edge: BoundaryEdge,
    /// The name of its boundary.
    pub boundary: Arc<str>,
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
    pub along_normal: bool,
    /// g in the middle less the mean of its values at the ends, where n~ does not turn; 0 where g is known to be affine.
    pub bulge: f64,
}

impl PieceGeometry {
    /// Returns whether the direction of contact turns along the piece.
    pub fn turns(&self) -> bool {
        self.nodes[0].direction != self.nodes[1].direction
    }

    /// The part of an edge of the first side, by which results name the piece.
    pub fn first(&self) -> &Stretch {
        &self.stretches[0]
    }

    /// g at the nodes.
    pub fn gaps(&self) -> impl Iterator<Item = f64> + '_ {
        self.nodes.iter().map(|node| node.gap)
    }

    /// n~ at the nodes.
    pub fn directions(&self) -> impl Iterator<Item = Vector2<f64>> + '_ {
        self.nodes.iter().map(|node| node.direction)
    }
}

/// What a side of a piece is made from, in any numbers.
#[derive(Clone, Copy, Debug)]
pub struct SideData<S> {
    /// The triangle.
    pub triangle: Triangle<S>,
    /// Its material.
    pub material: Material<S>,
    /// The length of its whole edge.
    pub length: S,
    /// n, the unit outward normal there.
    pub normal: Vector2<S>,
    /// gamma of the triangle: gamma0 h_T of (7).
    pub gamma: S,
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
    /// The share of its stress in that of the piece, its gamma over that of the piece.
    pub weight: S,
    /// The length of its part of the edge over that of the piece.
    pub ratio: S,
    /// Its entries among the nodes of the piece's triangles.
    pub entries: Range<usize>,
    /// For each node of the piece the entry of the edge's node that is next to it.
    pub nearest: Vec<usize>,
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
    /// The nodes of its triangles, the first side's and then the second's.
    pub nodes: Vec<usize>,
    /// P0 of each component at each node of the piece: a vector for each of `nodes`.
    pub p0: Vec<Vec<Vector2<S>>>,
    /// The stress of each component, sigma_n of the first, at the start and at the end.
    pub sigma_n: Vec<Vec<Vector2<S>>>,
}

/// What a piece adds to (8) and to J_h, with the weight |E| / gamma inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Contribution {
    /// Its share of J_h.
    pub energy: f64,
    /// The derivatives of the energy with respect to the nodal values of P: the force of the piece is minus the sum of these, each
    /// times its functional P0.
    pub force: Vec<f64>,
    /// The second derivatives that Newton's method uses.
    pub tangent: DMatrix<f64>,
    /// int -lambda^h of the first component.
    pub resultant: f64,
    /// The measure of {P > 0}.
    pub active: f64,
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

/// A vector turned left by a right angle.
fn across<S: Scalar>(d: Vector2<S>) -> Vector2<S> {
    Vector2::new(-d[1], d[0])
}

impl<S: Scalar + From<f64>> Piece<S> {
    /// The piece with this geometry and these sides, whose functionals follow `start` others.
    pub fn new(
        geometry: &Arc<PieceGeometry>,
        space: &Space,
        start: usize,
        data: &[SideData<S>],
    ) -> Self {
        let degree = space.degree();
        let exact = <S as From<f64>>::from;
        let (two, is_pair) = (<S as From<i32>>::from(2), data.len() > 1);
        let part = |(stretch, data): (&Stretch, &SideData<S>)| {
            let [from, to] = [stretch.positions[0], stretch.positions[1]];
            let share = if to < from { exact(from) - exact(to) } else { exact(to) - exact(from) };
            share * data.length
        };
        let parts: Vec<S> = geometry.stretches.iter().zip(data).map(part).collect();
        let (mut length, mut gamma) = (data[0].length, data[0].gamma);
        if is_pair {
            length = (parts[0] + parts[1]) / two;
            gamma += data[1].gamma;
        }
        let mut piece = Piece {
            geometry: Arc::clone(geometry),
            degree,
            start,
            sides: Vec::with_capacity(data.len()),
            length,
            gamma,
            nodes: Vec::new(),
            p0: vec![Vec::new(); geometry.law.components() * degree.nodes_per_edge()],
            sigma_n: vec![Vec::new(); 2 * geometry.law.components()],
        };
        for (i, (stretch, data)) in geometry.stretches.iter().zip(data).enumerate() {
            let one = <S as From<i32>>::from(1);
            let (weight, ratio) =
                if is_pair { (data.gamma / gamma, parts[i] / length) } else { (one, one) };
            let own_gamma = if is_pair { data.gamma * ratio } else { data.gamma };
            let first = piece.nodes.len();
            piece.nodes.extend(space.nodes_of(stretch.edge.triangle));
            let positions: Vec<S> = stretch.positions.iter().map(|&s| exact(s)).collect();
            let place = (stretch.edge.local, is_pair.then_some(&positions[..]));
            for k in 0..geometry.law.components() {
                let toward = |node: &PieceNode| {
                    let d = node.direction.map(exact);
                    let d = if k == 0 { d } else { across(d) };
                    if i == 0 { d } else { -d }
                };
                let along: Vec<Vector2<S>> = geometry.nodes.iter().map(toward).collect();
                let along = (k > 0 || !geometry.along_normal).then_some(&along[..]);
                let [p0, sigma_n] = with_element!(degree, E => {
                    rows::<E, _, _, _>(data, place, along, own_gamma)
                });
                let count = degree.nodes_per_edge();
                for (all, own) in piece.p0[k * count..].iter_mut().zip(p0) {
                    all.extend(own);
                }
                for (all, own) in piece.sigma_n[2 * k..].iter_mut().zip(sigma_n) {
                    let own = own.into_iter();
                    if is_pair {
                        all.extend(own.map(|row| row * (weight * ratio)));
                    } else {
                        all.extend(own);
                    }
                }
            }
            piece.sides.push(Side {
                normal: data.normal,
                length: data.length,
                gamma: data.gamma,
                weight,
                ratio,
                entries: first..piece.nodes.len(),
                nearest: nearest(degree, stretch).into_iter().map(|k| first + k).collect(),
            });
        }
        piece
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
    pub fn direction(&self, a: usize) -> Vector2<S> {
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
        let count = self.degree.nodes_per_edge();
        let value = |(i, row): (usize, &Vec<Vector2<S>>)| {
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
                sum + self.apply(side, row, difference)
            })
        };
        self.p0.iter().enumerate().map(value).collect()
    }

    /// g of functional `i`; across n~ there is none.
    pub(crate) fn gap_of(&self, i: usize) -> f64 {
        self.geometry.nodes.get(i).map_or(0.0, |node| node.gap)
    }

    /// P(u) = P0(u) - g there.
    pub fn p(&self, u: &[[S; 2]]) -> Vec<S> {
        let less = |(i, p0): (usize, S)| p0 - <S as From<f64>>::from(self.gap_of(i));
        self.p0(u).into_iter().enumerate().map(less).collect()
    }

    /// The stress of each component at the start and at the end, of a displacement given by its differences between two nodes: the
    /// first one's value less the second one's.
    pub fn stress(&self, difference: impl Fn(usize, usize) -> [S; 2]) -> Vec<S> {
        let value = |row: &Vec<Vector2<S>>| {
            let of = |side: &Side<S>| {
                let from = self.nodes[side.entries.start];
                self.apply(side, row, |node| difference(node, from))
            };
            let first = of(&self.sides[0]);
            self.sides[1..].iter().fold(first, |sum, side| sum + of(side))
        };
        self.sigma_n.iter().map(value).collect()
    }

    /// sigma_n(u) at the start and at the end.
    pub fn sigma_n(&self, u: &[[S; 2]]) -> [S; 2] {
        let stress = self.stress(|node, from| [0, 1].map(|c| u[node][c] - u[from][c]));
        [stress[0], stress[1]]
    }

    /// int gamma sigma_n(u)^2, summed over the components.
    pub fn squared_stress(&self, u: &[[S; 2]]) -> S {
        let stress = self.stress(|node, from| [0, 1].map(|c| u[node][c] - u[from][c]));
        let square = |ends: &[S]| integral_of_product([ends[0], ends[1]], [ends[0], ends[1]]);
        let rest = stress[2..].chunks_exact(2).map(square);
        self.gamma * self.length * rest.fold(square(&stress[..2]), |sum, more| sum + more)
    }

    /// The factors of the functionals of the stress in -int gamma sigma_n(u) sigma_n(.), for sigma_n(u) = `stress`.
    pub(crate) fn stress_factors(&self, stress: &[S]) -> Vec<S> {
        let [two, six] = [2, 6].map(<S as From<i32>>::from);
        let mass = -(self.gamma * self.length) / six;
        let of = |ends: &[S]| {
            let (start, end) = (ends[0], ends[1]);
            [mass * (two * start + end), mass * (start + two * end)]
        };
        stress.chunks_exact(2).flat_map(of).collect()
    }

    /// Adds -int gamma sigma_n(u) sigma_n(v) for every basis function v.
    pub fn add_stresses(&self, u: &[[S; 2]], forces: &mut [[S; 2]]) {
        let stress = self.stress(|node, from| [0, 1].map(|c| u[node][c] - u[from][c]));
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
    pub(super) fn each_force(
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
    pub fn stress_product(&self, weight: S, i: usize, j: usize) -> Matrix2<S> {
        let of = |rows: &[Vec<Vector2<S>>]| {
            let (start, end) = (&rows[0], &rows[1]);
            Matrix2::from_fn(|c, d| {
                weight * integral_of_product([start[i][c], end[i][c]], [start[j][d], end[j][d]])
            })
        };
        let first = of(&self.sigma_n[..2]);
        self.sigma_n[2..].chunks_exact(2).fold(first, |sum, rows| sum + of(rows))
    }
}

/// For each node of a piece the node of the triangle that is next to it on the edge.
fn nearest(degree: Degree, stretch: &Stretch) -> Vec<usize> {
    let (nodes, places) = (degree.edge_nodes(stretch.edge.local), degree.edge_positions());
    let next_to = |&s: &f64| {
        let distance = |a: &usize| (places[*a] - s).abs();
        let best = (0..nodes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        best.map_or(nodes[0], |a| nodes[a])
    };
    stretch.positions.iter().map(next_to).collect()
}

impl Piece {
    /// What the piece adds to (8) and J_h where P has these values at its nodes.
    pub fn contribution<T: Copy + Into<DoubleDouble>>(
        &self,
        rule: &EdgeRule,
        p: &[T],
    ) -> Contribution {
        self.softened(rule, 1.0, p)
    }

    /// [`Piece::contribution`] on springs that are `stiffness` times as stiff. The law is the same: what friction bears at most does not
    /// depend on them.
    pub fn softened<T: Copy + Into<DoubleDouble>>(
        &self,
        rule: &EdgeRule,
        stiffness: f64,
        p: &[T],
    ) -> Contribution {
        let of = (self.degree, self.gamma / stiffness);
        let Integrals { energy, gradient, hessian, active, friction } =
            self.geometry.law.integrals(rule, of, p);
        let weight = self.weight();
        let along = &gradient[..self.degree.nodes_per_edge()];
        Contribution {
            energy: stiffness * (weight * energy),
            // The shape functions add up to one.
            resultant: stiffness * (weight * along.iter().sum::<f64>()),
            force: gradient.iter().map(|g| stiffness * (weight * g)).collect(),
            tangent: stiffness * (weight * hessian),
            active: self.length * active,
            friction: friction.map(|measure| self.length * measure),
        }
    }

    /// The Bregman distance of the energy of [`Piece::softened`] from P to Q, given by their values at the nodes.
    pub fn bregman<T: Copy + Into<DoubleDouble>>(
        &self,
        rule: &EdgeRule,
        stiffness: f64,
        p: &[T],
        q: &[T],
    ) -> f64 {
        let of = (self.degree, self.gamma / stiffness);
        stiffness * (self.weight() * self.geometry.law.bregman(rule, of, p, q))
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
    pub(crate) fn p0_magnitudes(&self, u: &[[f64; 2]]) -> Vec<f64> {
        let count = self.degree.nodes_per_edge();
        let value = |(i, row): (usize, &Vec<Vector2<f64>>)| {
            let size = |f: Vector2<f64>, x: f64, y: f64| (f[0] * x).abs() + (f[1] * y).abs();
            let n = self.direction_of(i);
            let of = |side: &Side| {
                let [x, y] = u[self.nodes[side.nearest[i % count]]];
                let entries = side.entries.clone();
                let others = row[entries.clone()].iter().zip(&self.nodes[entries]);
                let differences = others.map(|(&f, &k)| size(f, u[k][0] - x, u[k][1] - y));
                size(n, x, y) + differences.sum::<f64>()
            };
            self.sides.iter().map(of).sum()
        };
        self.p0.iter().enumerate().map(value).collect()
    }
}
