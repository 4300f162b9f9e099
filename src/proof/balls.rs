//! The ingredients of (8) in balls: the pieces of Gamma_C, kappa, the components of fields and functionals in the frames of their
//! nodes, their products.

use std::cell::OnceCell;
use std::ops::Index;

use crate::contact::contact_line::{Share, by_triangle};
use crate::contact::piece::Stretch;
use crate::contact::{Discretization, Piece, residual};
use crate::kernel::ball::{PreciseBall, larger, up};
use crate::kernel::contact_edge::traction_stiffness;
use crate::linear::system::System;

/// The pieces of Gamma_C in balls, lengths and normals as the vertices have them; each is made where it is needed first.
pub struct Lines<'d> {
    d: &'d Discretization<'d>,
    made: Vec<OnceCell<Piece<PreciseBall>>>,
}

impl<'d> Lines<'d> {
    /// The pieces of a discretization.
    pub fn new(d: &'d Discretization<'d>) -> Self {
        Lines { d, made: vec![OnceCell::new(); d.contact.len()] }
    }

    /// Goes through all pieces, and makes each.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Piece<PreciseBall>> {
        (0..self.made.len()).map(|e| &self[e])
    }

    /// The pieces in doubles.
    pub(super) fn in_doubles(&self) -> &'d [Piece] {
        &self.d.contact
    }
}

impl Index<usize> for Lines<'_> {
    type Output = Piece<PreciseBall>;

    fn index(&self, e: usize) -> &Piece<PreciseBall> {
        self.made[e].get_or_init(|| {
            residual::piece_with(self.d, &self.d.contact[e], |side, stretch| {
                let (length, normal) = length_and_normal(self.d, stretch);
                (length, normal.into(), PreciseBall::from(side.gamma))
            })
        })
    }
}

/// |E| and n
fn length_and_normal(d: &Discretization, at: &Stretch) -> (PreciseBall, [PreciseBall; 2]) {
    let triangle = residual::exactly::<PreciseBall>(d.space.mesh().triangle(at.edge.triangle));
    let normal: [PreciseBall; 2] = triangle.scaled_normal(at.edge.local).into();
    let length = dot(normal, normal).sqrt();
    (length, normal.map(|c| c / length))
}

/// kappa of Theorem 2.3, rounded up. The directions of contact are doubles, unit vectors to a rounding error only.
pub(super) fn kappa(d: &Discretization) -> f64 {
    let degree = d.space.degree();
    let largest = |a: PreciseBall, b: PreciseBall| if a.upper() < b.upper() { b } else { a };
    let mut shares = Vec::new();
    for piece in &d.contact {
        let geometry = &piece.geometry;
        let along: Vec<[PreciseBall; 2]> =
            geometry.directions().map(|n| n.map(PreciseBall::from).into()).collect();
        let both = geometry.law.components() > 1;
        let sides: Vec<(PreciseBall, [PreciseBall; 2])> =
            geometry.stretches.iter().map(|stretch| length_and_normal(d, stretch)).collect();
        let lengths: Vec<PreciseBall> = sides.iter().map(|(length, _)| *length).collect();
        let chords = geometry.chords(&lengths);
        for (i, (side, stretch)) in piece.sides.iter().zip(&geometry.stretches).enumerate() {
            let (t, (length, normal)) = (stretch.edge.triangle, sides[i]);
            let direction = if geometry.along_normal {
                Some(normal.into())
            } else {
                (!geometry.turns()).then_some(along[0].into())
            };
            let (one, doubles) = (PreciseBall::from(1), d.space.mesh().triangle(t));
            let radii = geometry.radii(i, |edge| {
                let (t, exact) = (edge.triangle, PreciseBall::from);
                let triangle = d.space.mesh().triangle(t);
                d.problem.material.of(t).radii(&triangle).map(|radii| radii.map(exact))
            });
            let of_edge = radii.map(|radii| (radii.of_piece, radii.of_triangle));
            let counted = |turning| degree.counted_length(one, turning, of_edge, PreciseBall::sqrt);
            let factor = if geometry.along_normal {
                counted(None)
            } else {
                let off = along.iter().map(|&n| (dot(n, n) - PreciseBall::from(1)).magnitude());
                let off = PreciseBall::from(8.0 * off.fold(0.0, larger));
                let cosine = dot(along[0], along[1]);
                // The square root of the factor is steep where the direction turns little.
                let cosine = if both && geometry.turns() {
                    PreciseBall::from((cosine - off).lower())
                } else {
                    cosine
                };
                let turning = counted(Some((cosine, both && geometry.turns())));
                turning * (PreciseBall::from(1) + off) + off
            };
            let factor = chords.map_or(factor, |chords| factor * chords.share(i, radii, largest));
            let material = d.problem.material.of(t).map(PreciseBall::from);
            let direction = direction.filter(|_| !both);
            let stiffness =
                traction_stiffness(&material, normal.into(), direction, PreciseBall::sqrt);
            let area = residual::exactly::<PreciseBall>(doubles).double_area();
            let (length, area) = (factor * length, area / PreciseBall::from(2));
            let value = degree.coercivity_constant(stiffness, side.gamma.into(), length, area);
            shares.push(Share::new(geometry, i, value));
        }
    }
    by_triangle(shares, largest).values().map(|kappa| kappa.upper()).fold(0.0, larger)
}

/// The components of a functional at the free unknowns, in the frames of their nodes.
pub(super) fn free(system: &System, forces: &[[PreciseBall; 2]]) -> Vec<PreciseBall> {
    let frames = system.d.constraints.frames();
    let mut all = vec![PreciseBall::from(0); system.numbering.count];
    for (node, numbers) in system.numbering.of.iter().enumerate() {
        let force = match frames.get(&node) {
            Some(&axis) => axes(axis).map(|axis| dot(axis, forces[node])),
            None => forces[node],
        };
        for (number, force) in numbers.iter().zip(force) {
            if let Some(number) = *number {
                all[number] = force;
            }
        }
    }
    all
}

/// A direction, and the direction turned left.
fn axes(axis: [f64; 2]) -> [[PreciseBall; 2]; 2] {
    [[axis[0], axis[1]], [-axis[1], axis[0]]].map(|axis| axis.map(PreciseBall::from))
}

/// The field with the components `known` at the free unknowns and `prescribed` at the others.
pub(super) fn field(
    system: &System,
    known: impl Fn(usize, usize, usize) -> PreciseBall,
    prescribed: impl Fn(usize, usize) -> f64,
) -> Vec<[PreciseBall; 2]> {
    let frames = system.d.constraints.frames();
    let at = |(node, numbers): (usize, &[Option<usize>; 2])| {
        let parts = [0, 1].map(|c| match numbers[c] {
            Some(number) => known(number, node, c),
            None => PreciseBall::from(prescribed(node, c)),
        });
        match frames.get(&node) {
            None => parts,
            Some(&axis) => {
                let [along, across] = axes(axis);
                [0, 1].map(|c| parts[0] * along[c] + parts[1] * across[c])
            }
        }
    };
    system.numbering.of.iter().enumerate().map(at).collect()
}

/// The sum of the products of two fields or functionals.
pub(super) fn product(f: &[[PreciseBall; 2]], u: &[[PreciseBall; 2]]) -> PreciseBall {
    f.iter().zip(u).fold(PreciseBall::from(0), |sum, (&f, &u)| sum + dot(f, u))
}

/// a(v, v)
pub(super) fn strain_energy(d: &Discretization, v: &[[PreciseBall; 2]]) -> PreciseBall {
    let mut forces = vec![[PreciseBall::from(0); 2]; v.len()];
    residual::add_internal_forces(&d.space, &d.problem.material, v, &mut forces);
    product(v, &forces)
}

/// a . b
pub(super) fn dot(a: [PreciseBall; 2], b: [PreciseBall; 2]) -> PreciseBall {
    a[0] * b[0] + a[1] * b[1]
}

/// An upper bound of the length of a vector.
pub(super) fn length(v: [PreciseBall; 2]) -> f64 {
    let [a, b] = v.map(PreciseBall::magnitude);
    if a == 0.0 && b == 0.0 {
        return 0.0;
    }
    // A square may underflow.
    up((a * a + b * b + f64::MIN_POSITIVE).sqrt())
}

/// The square root of a number that cannot be negative, rounded up; infinite where nothing is known.
pub(super) fn root(square: PreciseBall) -> f64 {
    let square = square.upper();
    if square.is_nan() { f64::INFINITY } else { up(square.max(0.0).sqrt()) }
}
