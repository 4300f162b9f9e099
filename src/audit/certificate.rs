//! A certificate: v, tau, and the problem that they belong to, as numbers and nothing else.

use std::collections::BTreeMap;
use std::fmt;

use nalgebra::Vector2;

use crate::kernel::composite::Affine;
use crate::kernel::contact_edge::integral_of_product;
use crate::kernel::{Ball, Enclosing, Material, Triangle};

/// v, tau and the problem that they belong to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Certificate {
    /// The vertices of the mesh.
    pub vertices: Vec<[f64; 2]>,
    /// Further vertices, numbered after these: each lies on the straight line between two of them.
    pub cuts: Vec<Cut>,
    /// v at the vertices; if it is affine on the triangles of the mesh, at a cut it follows.
    pub displacement: Vec<[f64; 2]>,
    /// The part that makes v, u_D and g quadratic; `None` where they are affine.
    pub curved: Option<Curved>,
    /// u_D at the vertices of Gamma_D.
    pub prescribed: Vec<[Option<f64>; 2]>,
    /// The points that are held along an oblique direction d only: what is prescribed there is u . d, as the first of the two.
    /// v is the nearest to the doubles above that has it: only along an axis can doubles themselves.
    pub frames: BTreeMap<usize, [f64; 2]>,
    /// The triangles.
    pub pieces: Vec<Piece>,
    /// Their edges.
    pub edges: Vec<Edge>,
    /// The parts of the prescribed displacements and gaps that those above leave out.
    pub lifts: Vec<Lift>,
    /// The edges that stand for a part of a curved boundary.
    pub polygon: Vec<usize>,
    /// The edges of two bodies that face each other, one of [`Role::Contact`] and one of [`Role::Facing`], each by the other.
    pub facing: BTreeMap<usize, usize>,
}

/// A displacement z that vanishes outside the triangle of the mesh between three vertices: with its traces there, the
/// prescribed displacements and gaps are those of the problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lift {
    /// The vertices.
    pub corners: [usize; 3],
    /// |z|_a is at most this.
    pub norm: f64,
}

/// Differences between the problem that a certificate was made for and the one that its arrays state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reservations {
    /// Triangles whose loads are measured by quadrature.
    pub measured: usize,
    /// Triangles in which prescribed displacements or gaps are.
    pub lifted: usize,
    /// Edges of Gamma_C along which the direction of contact turns.
    pub turning: usize,
}

impl Reservations {
    /// The bound is one of the problem itself.
    pub fn is_empty(&self) -> bool {
        *self == Reservations::default()
    }
}

impl fmt::Display for Reservations {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Reservations { measured, lifted, turning } = *self;
        let parts = [
            (measured, "triangles with loads that are measured by quadrature"),
            (lifted, "triangles with prescribed values or gaps that are measured by quadrature"),
            (turning, "edges with a direction of contact that is affine between their ends"),
        ];
        let parts = parts.iter().filter(|(count, _)| *count > 0);
        let words: Vec<String> = parts.map(|(count, what)| format!("{count} {what}")).collect();
        f.write_str(if words.is_empty() { "none" } else { "" })?;
        f.write_str(&words.join(", "))
    }
}

/// v quadratic on the triangles, u_D and g quadratic along edges. A bulge is the value in the middle of an edge less the mean
/// of its ends: 4 s (1 - s) times it is what comes to the affine function.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curved {
    /// v at the cuts.
    pub at_cuts: Vec<[f64; 2]>,
    /// u_D at the cuts on Gamma_D.
    pub prescribed: Vec<[Option<f64>; 2]>,
    /// The bulge of v on each edge.
    pub bulges: Vec<[f64; 2]>,
    /// The bulges of the data on each edge: of u_D on Gamma_D in the components that are held, of u . d where the direction d
    /// is, and of g on Gamma_C, as the first of two; all others are 0.
    pub data: Vec<[f64; 2]>,
}

/// The point (1 - at) x_a + at x_b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// a and b.
    pub ends: [usize; 2],
    /// In (0, 1).
    pub at: f64,
}

/// A triangle with what acts in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its vertices, counter-clockwise.
    pub vertices: [usize; 3],
    /// Its edges: edge i lies opposite vertex i.
    pub edges: [usize; 3],
    /// The material as it acts in the plane: [`Material::in_plane`].
    pub material: Material<f64>,
    /// f at its vertices, affine between them.
    pub body: [[f64; 2]; 3],
    /// The cost of the loads' parts that those above leave out: to be added to |C eps(v) - tau|. Positive where that is measured
    /// by quadrature.
    pub oscillation: f64,
}

/// An edge, from its start to its end; the triangle on its left has it in this direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Start and end.
    pub ends: [usize; 2],
    /// The role of the edge, with the traction of tau on it.
    pub role: Role,
}

/// The role of an edge. A force is tau N, N = |E| n, towards the right: per unit of the edge's parameter, at start and end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// Between two triangles.
    Inner([[f64; 2]; 2]),
    /// Gamma_D for the components that are held; on the others the force is zero.
    Held([bool; 2], [[f64; 2]; 2]),
    /// Gamma_D along the direction d alone: tau n = p d + q e, e being d turned to the left, where q is given.
    Supported {
        /// d
        along: [f64; 2],
        /// |E| p at both ends.
        force: [f64; 2],
        /// q at both ends.
        traction: [f64; 2],
    },
    /// Gamma_N: the traction t that is given (a stress, not a force).
    Loaded([[f64; 2]; 2]),
    /// Gamma_N: the pressure p that is given, t = -p n.
    Pressed([f64; 2]),
    /// Gamma_C. On a pair v is that on this edge less that on the edge that faces this one, which runs the other way.
    Contact {
        /// tau_n at both ends.
        pressure: [f64; 2],
        /// g at both ends.
        gap: [f64; 2],
        /// The direction d of contact at both ends, affine between them; `None` is the edge's normal.
        along: Option<[[f64; 2]; 2]>,
        /// The law of contact on the edge.
        law: Law,
    },
    /// The second body of a pair: the force is minus that on the edge of [`Role::Contact`] that faces this one.
    Facing,
}

/// The law of an edge of Gamma_C beside its direction d; with e, d turned to the left, tau N = |E| (p d + q e).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Law {
    /// p <= 0, v . d <= g, and q = 0.
    #[default]
    Contact,
    /// Two bodies that slide and do not open: v . d = g, and q = 0.
    Sliding,
    /// Two bodies that are glued, d along x: v . d = g and v . e is the offset.
    Bonded {
        /// q at both ends.
        shear: [f64; 2],
        /// v . e at both ends.
        offset: [f64; 2],
    },
    /// Contact, and |q| <= s.
    Friction {
        /// q at both ends.
        shear: [f64; 2],
        /// s at both ends.
        bound: [f64; 2],
    },
}

impl Law {
    /// q at both ends.
    pub(crate) fn shear(self) -> [f64; 2] {
        match self {
            Law::Contact | Law::Sliding => [0.0; 2],
            Law::Bonded { shear, .. } | Law::Friction { shear, .. } => shear,
        }
    }

    /// The jump v . e at both ends that is given.
    pub fn offset(self) -> [f64; 2] {
        if let Law::Bonded { offset, .. } = self { offset } else { [0.0; 2] }
    }

    /// The law is that of glue.
    pub fn is_bonded(self) -> bool {
        matches!(self, Law::Bonded { .. })
    }

    /// v may not open, and p has either sign.
    pub fn is_tied(self) -> bool {
        matches!(self, Law::Sliding | Law::Bonded { .. })
    }

    /// A displacement on the first body, from the vector `own` and from that on the second one: its jump is [g, h] along d and across,
    /// or, where the bodies slide, nearest to its own with g along d; a component that is `given` stays, if d has another.
    pub(super) fn tie<S: Enclosing>(
        self,
        (own, given): (Vector2<S>, [bool; 2]),
        other: Vector2<S>,
        d: [f64; 2],
        [g, h]: [S; 2],
    ) -> Vector2<S> {
        let beyond = |c: usize, g: S| if g.ends() == [0.0; 2] { other[c] } else { other[c] + g };
        let along = |c: usize| if d[c] > 0.0 { g } else { -g };
        match (self, axis(d)) {
            (Law::Bonded { .. }, _) => Vector2::new(beyond(0, g), beyond(1, h)),
            (_, Some(0)) => Vector2::new(beyond(0, along(0)), own[1]),
            (_, Some(_)) => Vector2::new(own[0], beyond(1, along(1))),
            (_, None) => {
                let d = exactly::<S>(d);
                let off = (own - other).dot(&d) - g;
                match given {
                    [true, _] => Vector2::new(own[0], own[1] - off / d[1]),
                    [_, true] => Vector2::new(own[0] - off / d[0], own[1]),
                    _ => own - d * (off / d.dot(&d)),
                }
            }
        }
    }

    /// The bulge of a displacement on the first body along a whole edge, from `own` and that on the second one, where its `jump` at the
    /// ends is tied to the `gap` along the directions `d` and the bulges of the gap and of the offset are [g, h].
    pub(super) fn tie_between<S: Enclosing>(
        self,
        [own, other]: [Vector2<S>; 2],
        jump: [Vector2<S>; 2],
        d: [[f64; 2]; 2],
        (gap, [g, h]): ([S; 2], [S; 2]),
    ) -> Vector2<S> {
        if d[0] == d[1] {
            return self.tie((own, [false; 2]), other, d[0], [g, h]);
        }
        other + turning_bulge(jump, d.map(exactly), (gap, g))
    }
}

/// The bulge of a quadratic jump j with j . d = g along a whole edge on which d is affine and turns, for a g with these values at the ends
/// and this bulge, and a j with j . d = g at the ends.
///
/// With j = a d + t e at the ends, e being d turned to the left, and the middle Bernstein coefficients M of j and G of g, those of j . d - g
/// between the ends are 0 if 2 M . d_0 = g_0 + 2 G - j_0 . d_1 and 2 M . d_1 = g_1 + 2 G - j_1 . d_0. As j_0 . d_1 = a_0 d_0 . d_1 + t_0 S
/// and j_1 . d_0 = a_1 d_0 . d_1 - t_1 S, S = d_0 x d_1, only what the gap does is divided by S.
fn turning_bulge<S: Enclosing>(
    jump: [Vector2<S>; 2],
    d: [Vector2<S>; 2],
    (gap, bulge): ([S; 2], S),
) -> Vector2<S> {
    let (two, e) = (S::from(2), d.map(turned));
    let (sine, cosine) = (d[0].perp(&d[1]), d[0].dot(&d[1]));
    let slip = [0, 1].map(|k| jump[k].dot(&e[k]) / d[k].dot(&d[k]));
    let doubled = gap[0] + gap[1] + bulge * S::from(4);
    let [a, b] = [0, 1].map(|k| gap[k] + doubled - gap[k] / d[k].dot(&d[k]) * cosine);
    let middle = e[0] * slip[1] + e[1] * slip[0] + (e[0] * b - e[1] * a) / sine;
    (middle - jump[0] - jump[1]) / (two * two)
}

/// The axis along which d is a unit vector.
pub(super) fn axis(d: [f64; 2]) -> Option<usize> {
    (0..2).find(|&c| d[c].abs() == 1.0 && d[1 - c] == 0.0)
}

/// Turns values at both ends of an edge into those of the edge that faces it, which runs the other way, with the opposite sign.
pub(super) fn opposite<S: Enclosing>([a, b]: [Vector2<S>; 2]) -> [Vector2<S>; 2] {
    [-b, -a]
}

/// The vector with these components.
pub fn exactly<S: Enclosing>(components: [f64; 2]) -> Vector2<S> {
    components.map(S::exactly).into()
}

/// d turned to the left.
pub fn turned<S: Enclosing>(d: Vector2<S>) -> Vector2<S> {
    Vector2::new(-d[1], d[0])
}

/// Tells whether d is not along an axis.
pub fn is_oblique(d: [f64; 2]) -> bool {
    d[0] != 0.0 && d[1] != 0.0
}

/// The vector nearest to v with v . d = w.
fn nearest<S: Enclosing>(v: [f64; 2], d: [f64; 2], w: f64) -> Vector2<S> {
    let (v, d) = (exactly::<S>(v), exactly::<S>(d));
    v - d * ((v.dot(&d) - S::exactly(w)) / d.dot(&d))
}

/// tau N on an edge that is held along `d`, of the given `length`.
pub fn support<S: Enclosing>(
    d: [f64; 2],
    force: [f64; 2],
    traction: [f64; 2],
    length: impl Fn() -> S,
) -> [Vector2<S>; 2] {
    let d = exactly::<S>(d);
    let held = force.map(|p| d * S::exactly(p));
    if traction == [0.0; 2] {
        return held;
    }
    let across = turned(d) * length();
    [0, 1].map(|k| held[k] + across * S::exactly(traction[k]))
}

impl Certificate {
    /// Derives from the arrays how the problem differs from them.
    pub fn reservations(&self) -> Reservations {
        let turns =
            |edge: &&Edge| matches!(edge.role, Role::Contact { along: Some([d, e]), .. } if d != e);
        Reservations {
            measured: self.pieces.iter().filter(|piece| piece.oscillation != 0.0).count(),
            lifted: self.lifts.len(),
            turning: self.edges.iter().filter(turns).count(),
        }
    }

    /// An upper bound of |z|_a for the sum z of the lifts, which meet on edges only.
    pub fn lift(&self) -> f64 {
        self.with_lifts(0.0)
    }

    /// (bound^2 + |z|_a^2)^(1/2), rounded upwards: the bound of |u - v|_a that is left of one for the v that has z, too.
    pub fn with_lifts(&self, bound: f64) -> f64 {
        if self.lifts.is_empty() {
            return bound;
        }
        let square = |x: f64| Ball::exactly(x) * Ball::exactly(x);
        let sum = self.lifts.iter().fold(square(bound), |sum, lift| sum + square(lift.norm));
        sum.sqrt().upper()
    }

    /// Values at the vertices, and at the cuts between them. Between equal numbers lies the same number: so the normal of an
    /// edge along an axis is known exactly. `is_known` tells of a vertex whether its values are the doubles `at`.
    pub(super) fn with_cuts<S: Enclosing>(
        &self,
        mut all: Vec<Vector2<S>>,
        at: &[[f64; 2]],
        is_known: impl Fn(usize) -> bool,
    ) -> Vec<Vector2<S>> {
        for cut in &self.cuts {
            let s = S::exactly(cut.at);
            let ([v, w], [a, b]) = (cut.ends.map(|end| all[end]), cut.ends.map(|end| at[end]));
            let known = cut.ends.iter().all(|&end| is_known(end));
            let between = [0, 1].map(|c| {
                let mean = || v[c] * (S::from(1) - s) + w[c] * s;
                if known && a[c] == b[c] { v[c] } else { mean() }
            });
            all.push(between.into());
        }
        all
    }

    /// Vertices and cuts.
    pub fn places<S: Enclosing>(&self) -> Vec<Vector2<S>> {
        let vertices = self.vertices.iter().map(|&x| exactly(x)).collect();
        self.with_cuts(vertices, &self.vertices, |_| true)
    }

    /// v at a point that has its own, and what is prescribed there.
    pub fn at_own(&self, point: usize) -> Option<([f64; 2], [Option<f64>; 2])> {
        let of =
            |v: &[[f64; 2]], data: &[[Option<f64>; 2]], k: usize| Some((*v.get(k)?, *data.get(k)?));
        match (point.checked_sub(self.vertices.len()), &self.curved) {
            (None, _) => of(&self.displacement, &self.prescribed, point),
            (Some(cut), Some(curved)) => of(&curved.at_cuts, &curved.prescribed, cut),
            (Some(_), None) => None,
        }
    }

    /// The components that are prescribed at a point.
    pub(super) fn is_given(&self, point: usize) -> [bool; 2] {
        self.at_own(point).map_or([false; 2], |(_, given)| given.map(|value| value.is_some()))
    }

    /// A displacement at both ends of edge `e` of Gamma_C, and its bulge there: on a pair less that of the other body.
    pub(crate) fn jump<S: Enclosing>(&self, e: usize, w: &Shape<S>) -> Trace<S> {
        let ends = |e: usize| self.edges[e].ends.map(|p| w.points[p]);
        let bulge = |e: usize| w.bulges.as_ref().map_or(Vector2::zeros(), |bulges| bulges[e]);
        let Some(&other) = self.facing.get(&e) else { return (ends(e), bulge(e)) };
        let ([a, b], [c, d]) = (ends(e), opposite(ends(other)));
        ([a + c, b + d], bulge(e) - bulge(other))
    }

    /// The edges on which two bodies may not open.
    pub fn tied(&self) -> impl Iterator<Item = Tied> {
        self.edges.iter().enumerate().filter_map(|(edge, of)| match of.role {
            Role::Contact { gap, along: Some(d), law, .. } if law.is_tied() => {
                let other = *self.facing.get(&edge)?;
                Some(Tied { edge, other, law, d, gap })
            }
            _ => None,
        })
    }

    /// v.
    pub fn shape<S: Enclosing>(&self) -> Shape<S> {
        let all = |values: &[[f64; 2]]| values.iter().copied().map(exactly).collect::<Vec<_>>();
        let mut points = all(&self.displacement);
        points.extend(self.curved.iter().flat_map(|curved| all(&curved.at_cuts)));
        for (&point, &d) in &self.frames {
            if let Some((v, [Some(w), _])) = self.at_own(point) {
                points[point] = nearest(v, d, w);
            }
        }
        let Some(curved) = &self.curved else {
            // Two bodies are tied where v has values of its own at cuts.
            let is_known = |vertex: usize| !self.frames.contains_key(&vertex);
            return Shape {
                points: self.with_cuts(points, &self.displacement, is_known),
                bulges: None,
            };
        };
        let mut bulges = all(&curved.bulges);
        for (e, edge) in self.edges.iter().enumerate() {
            if let Role::Supported { along, .. } = edge.role
                && is_oblique(along)
            {
                bulges[e] = nearest(curved.bulges[e], along, curved.data[e][0]);
            }
        }
        for Tied { edge: e, other, law, d, gap } in self.tied() {
            let ends = self.edges[e].ends;
            let jump = [0, 1].map(|k| {
                let (p, there) = (ends[k], points[self.edges[other].ends[1 - k]]);
                let gap = [gap[k], law.offset()[k]].map(S::exactly);
                points[p] = law.tie((points[p], self.is_given(p)), there, d[k], gap);
                points[p] - there
            });
            let data = (gap.map(S::exactly), curved.data[e].map(S::exactly));
            bulges[e] = law.tie_between([bulges[e], bulges[other]], jump, d, data);
        }
        Shape { points, bulges: Some(bulges) }
    }
}

/// An edge on which two bodies may not open.
pub struct Tied {
    /// The edge of the first body, by its number.
    pub edge: usize,
    /// The edge of the second body.
    pub other: usize,
    /// How they are tied.
    pub law: Law,
    /// The direction d at both ends.
    pub d: [[f64; 2]; 2],
    /// v . d at both ends.
    pub gap: [f64; 2],
}

/// A displacement along an edge: at both ends, and its bulge.
pub(crate) type Trace<S> = ([Vector2<S>; 2], Vector2<S>);

/// A displacement on the triangles of a certificate.
#[derive(Clone)]
pub struct Shape<S> {
    /// At vertices and cuts.
    pub points: Vec<Vector2<S>>,
    /// The bulge on each edge, if it is quadratic.
    pub bulges: Option<Vec<Vector2<S>>>,
}

impl<S: Enclosing> Shape<S> {
    pub(crate) fn bulges_of(&self, piece: &Piece) -> Option<[Vector2<S>; 3]> {
        self.bulges.as_ref().map(|bulges| piece.edges.map(|e| bulges[e]))
    }

    /// 12 / |T| times the work of the body force on it.
    pub(crate) fn work(&self, piece: &Piece) -> S {
        // int_T l_i v = |T| / 12 (v_0 + v_1 + v_2 + v_i)
        let nodal = piece.vertices.map(|vertex| self.points[vertex]);
        let total = nodal[0] + nodal[1] + nodal[2];
        let mut work = S::from(0);
        for i in 0..3 {
            work += exactly::<S>(piece.body[i]).dot(&(total + nodal[i]));
        }
        if let Some(bulges) = self.bulges_of(piece) {
            // int_T 4 l_j l_k l_i = |T| / 15, and twice that for l_j and l_k in place of l_i.
            let body = piece.body.map(exactly::<S>);
            let sum = body[0] + body[1] + body[2];
            let fifteenth = S::from(24) / S::from(30);
            for i in 0..3 {
                work += (sum * S::from(2) - body[i]).dot(&bulges[i]) * fifteenth;
            }
        }
        work
    }

    /// The work on it of a force on edge `e`, affine between its ends, per unit of the edge's parameter.
    pub(crate) fn work_of(&self, force: [Vector2<S>; 2], ends: [usize; 2], e: usize) -> S {
        let [a, b] = ends.map(|p| self.points[p]);
        let work = |c: usize| integral_of_product([force[0][c], force[1][c]], [a[c], b[c]]);
        let work = work(0) + work(1);
        match &self.bulges {
            Some(bulges) => work + (force[0] + force[1]).dot(&bulges[e]) / S::from(3),
            None => work,
        }
    }

    /// C eps of it on a triangle.
    pub fn stress(&self, piece: &Piece, triangle: &Triangle<S>) -> Affine<S> {
        let nodal = piece.vertices.map(|vertex| self.points[vertex]);
        let bulges = self.bulges_of(piece);
        Affine::of_displacement(triangle, &nodal, bulges.as_ref(), &piece.material())
    }
}

/// The triangles of each edge, the one on its left first: inner edges have two, the others one.
pub(crate) type Owners = Vec<[Option<usize>; 2]>;

impl Piece {
    /// f is not constant.
    pub(crate) fn is_bent(&self) -> bool {
        self.body.iter().any(|&f| f != self.body[0])
    }

    /// The material in another number type.
    pub fn material<S: Enclosing>(&self) -> Material<S> {
        self.material.map(S::exactly)
    }
}

/// Where point `p` of a certificate lies.
pub fn place(certificate: &Certificate, p: usize) -> Vector2<f64> {
    let Certificate { vertices, cuts, .. } = certificate;
    let Some(cut) = p.checked_sub(vertices.len()) else { return vertices[p].into() };
    let [a, b] = cuts[cut].ends.map(|end| Vector2::from(vertices[end]));
    a + (b - a) * cuts[cut].at
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::kernel::Plane;

    /// A triangle without loads, of a material with lambda = mu = `modulus`.
    pub(crate) fn piece(vertices: [usize; 3], edges: [usize; 3], modulus: f64) -> Piece {
        let material = Material::lame(modulus, modulus, Plane::Strain);
        Piece { vertices, edges, material, body: [[0.0; 2]; 3], oscillation: 0.0 }
    }

    #[test]
    fn lifts_add_up_by_their_squares_and_so_does_a_bound_beside_them() {
        let of = |norms: &[f64]| {
            let lift = |&norm: &f64| Lift { corners: [0, 1, 2], norm };
            Certificate { lifts: norms.iter().map(lift).collect(), ..Certificate::default() }
        };
        let near = |found: f64, root: f64| (root..root * (1.0 + 1e-14)).contains(&found);
        assert!(near(of(&[3.0, 4.0]).lift(), 5.0) && near(of(&[3.0, 4.0]).with_lifts(12.0), 13.0));
        assert_eq!((of(&[]).lift(), of(&[]).with_lifts(12.0)), (0.0, 12.0));
    }

    #[test]
    fn triangles_with_lifts_and_those_that_are_measured_are_counted_apart() {
        let piece = |oscillation| Piece { oscillation, ..piece([0, 1, 2], [0, 1, 2], 1.0) };
        let lift = Lift { corners: [0, 1, 2], norm: 1.0 };
        let certificate = Certificate {
            pieces: [0.0, 1e-30, 2.0, 0.0, 1.0].map(piece).into(),
            lifts: vec![lift; 2],
            ..Certificate::default()
        };
        let found = certificate.reservations();
        assert_eq!(found, Reservations { measured: 3, lifted: 2, turning: 0 });
        assert!(Certificate::default().reservations().is_empty());
    }

    #[test]
    fn the_traction_across_an_oblique_support_is_a_force_for_each_length() {
        // d and its length of 5, the edge's of 3: d turned left is (-4, 3).
        let found = support([3.0, 4.0], [2.0, -1.0], [0.5, 7.0], || 3.0);
        let expected = [[6.0 - 6.0, 8.0 + 4.5], [-3.0 - 84.0, -4.0 + 63.0]];
        assert_eq!(found.map(<[f64; 2]>::from), expected);
        let alone = support::<f64>([3.0, 4.0], [2.0, -1.0], [0.0; 2], || f64::NAN);
        assert_eq!(alone.map(<[f64; 2]>::from), [[6.0, 8.0], [-3.0, -4.0]]);
    }

    #[test]
    fn a_number_between_equal_ones_is_known_where_both_are() {
        let certificate = Certificate {
            vertices: vec![[0.0; 2]; 2],
            cuts: vec![Cut { ends: [0, 1], at: 0.25 }],
            ..Certificate::default()
        };
        // The doubles are equal along x; what stands for them is not.
        let (all, doubles) = ([[1.0, 2.0], [3.0, 6.0]], [[7.0, 5.0], [7.0, 4.0]]);
        for known in [[true, true], [true, false], [false, true], [false, false]] {
            let all = all.map(Vector2::from).to_vec();
            let found = certificate.with_cuts::<f64>(all, &doubles, |end| known[end]);
            let x = if known == [true, true] { 1.0 } else { 1.5 };
            assert_eq!(found[2], Vector2::new(x, 3.0), "{known:?}");
        }
    }

    #[test]
    fn tied_displacements_jump_by_what_is_given_and_keep_what_is_held_or_lies_across() {
        let (own, other, gap) = (Vector2::new(2.0, -1.0), Vector2::new(0.5, 7.0), 0.25);
        for d in [[3.0, 4.0], [-4.0, 3.0], [0.5, -2.0], [1.0, 0.0], [-1.0, 0.0], [0.0, -1.0]] {
            let (along, is_along_axis) = (exactly::<f64>(d), axis(d).is_some());
            for given in [[false; 2], [true, false], [false, true]] {
                let tied = Law::Sliding.tie((own, given), other, d, [gap, 0.0]);
                let what = format!("{d:?} {given:?}: {tied}");
                assert!(((tied - other).dot(&along) - gap).abs() < 1e-14, "{what}");
                // Along an axis the other component is kept, whichever is held.
                let kept = if is_along_axis { [0, 1].map(|c| d[c] == 0.0) } else { given };
                for c in (0..2).filter(|&c| kept[c]) {
                    assert_eq!(tied[c], own[c], "{what}");
                }
                let moved = tied - own;
                let is_nearest = (along[0] * moved[1] - along[1] * moved[0]).abs() < 1e-14;
                assert_eq!(is_nearest, is_along_axis || given == [false; 2], "{what}");
            }
        }
        let bonded = Law::Bonded { shear: [0.0; 2], offset: [0.0; 2] };
        for (jump, expected) in [([gap, -3.0], [0.75, 4.0]), ([0.0, 0.0], [0.5, 7.0])] {
            let tied = bonded.tie((own, [false; 2]), other, [1.0, 0.0], jump);
            assert_eq!(<[f64; 2]>::from(tied), expected);
        }
    }
}
