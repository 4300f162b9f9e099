//! The ingredients of (8) in balls: the contact edges, kappa, the components of fields and functionals in the frames of their
//! nodes, their products.

use std::collections::BTreeMap;

use super::system::System;
use crate::fem::ball::{Ball, larger, up};
use crate::fem::residual;
use crate::fem::{ContactFace, Discretization};
use crate::kernel::contact_edge::traction_stiffness;

/// The contact edges in balls: length and normal as the vertices have them.
pub fn lines(d: &Discretization) -> Vec<ContactFace<Ball>> {
    let in_balls = |edge: &ContactFace| {
        let triangle = residual::exactly::<Ball>(d.space.mesh().triangle(edge.edge.triangle));
        let normal: [Ball; 2] = triangle.scaled_normal(edge.edge.local).into();
        let length = dot(normal, normal).sqrt();
        let normal = normal.map(|c| c / length).into();
        residual::with_numbers(d, edge, (length, normal, Ball::from(edge.gamma)))
    };
    d.contact.iter().map(in_balls).collect()
}

/// kappa of Theorem 2.3, rounded up. The directions of contact are doubles, unit vectors to a rounding error only.
pub(super) fn kappa(d: &Discretization, lines: &[ContactFace<Ball>]) -> f64 {
    let degree = d.space.degree();
    let mut kappas: BTreeMap<usize, Ball> = BTreeMap::new();
    for line in lines {
        let t = line.edge.triangle;
        let [start, end] = [0, 1].map(|a| line.directions[a].map(Ball::from));
        let direction = if line.along_normal {
            Some(line.normal)
        } else {
            (line.directions[0] == line.directions[1]).then_some(start)
        };
        let factor = if line.along_normal {
            Ball::from(1)
        } else {
            let along: Vec<[Ball; 2]> =
                line.directions.iter().map(|n| n.map(Ball::from).into()).collect();
            let off = along.iter().map(|&n| (dot(n, n) - Ball::from(1)).magnitude());
            let off = Ball::from(8.0 * off.fold(0.0, larger));
            let turning = degree.turning_factor(start.dot(&end));
            turning * (Ball::from(1) + off) + off
        };
        let material = d.problem.material.of(t).map(Ball::from);
        let stiffness = traction_stiffness(&material, line.normal, direction, Ball::sqrt);
        let area = residual::exactly::<Ball>(d.space.mesh().triangle(t)).double_area();
        let (length, area) = (factor * line.length, area / Ball::from(2));
        *kappas.entry(t).or_insert(Ball::from(0)) +=
            degree.coercivity_constant(stiffness, line.gamma, length, area);
    }
    kappas.values().map(|kappa| kappa.upper()).fold(0.0, larger)
}

/// The components of a functional at the free unknowns, in the frames of their nodes.
pub(super) fn free(system: &System, forces: &[[Ball; 2]]) -> Vec<Ball> {
    let frames = system.d.constraints.frames();
    let mut all = vec![Ball::from(0); system.numbering.count];
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

/// A direction and the one across, to the left.
fn axes(axis: [f64; 2]) -> [[Ball; 2]; 2] {
    [[axis[0], axis[1]], [-axis[1], axis[0]]].map(|axis| axis.map(Ball::from))
}

/// The field with these components, `known` at the free ones and the prescribed ones as `prescribed` has them.
pub(super) fn field(
    system: &System,
    known: impl Fn(usize, usize, usize) -> Ball,
    prescribed: impl Fn(usize, usize) -> f64,
) -> Vec<[Ball; 2]> {
    let frames = system.d.constraints.frames();
    let at = |(node, numbers): (usize, &[Option<usize>; 2])| {
        let parts = [0, 1].map(|c| match numbers[c] {
            Some(number) => known(number, node, c),
            None => Ball::from(prescribed(node, c)),
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
pub(super) fn product(f: &[[Ball; 2]], u: &[[Ball; 2]]) -> Ball {
    f.iter().zip(u).fold(Ball::from(0), |sum, (&f, &u)| sum + dot(f, u))
}

/// a(v, v)
pub(super) fn strain_energy(d: &Discretization, v: &[[Ball; 2]]) -> Ball {
    let mut forces = vec![[Ball::from(0); 2]; v.len()];
    residual::add_internal_forces(&d.space, &d.problem.material, v, &mut forces);
    product(v, &forces)
}

/// a . b
pub(super) fn dot(a: [Ball; 2], b: [Ball; 2]) -> Ball {
    a[0] * b[0] + a[1] * b[1]
}

/// The length of a vector, at most.
pub(super) fn length(v: [Ball; 2]) -> f64 {
    let [a, b] = v.map(Ball::magnitude);
    if a == 0.0 && b == 0.0 {
        return 0.0;
    }
    // A square may underflow.
    up((a * a + b * b + f64::MIN_POSITIVE).sqrt())
}

/// The square root of what cannot be negative, rounded up; infinite where nothing is known.
pub(super) fn root(square: Ball) -> f64 {
    let square = square.upper();
    if square.is_nan() { f64::INFINITY } else { up(square.max(0.0).sqrt()) }
}
